/* Shared by `rheolog why`, `doctor` and `debug`: what changed a particle, and the chain of causes. */
#ifndef CLI_WHY_H
#define CLI_WHY_H

#include "cli/cli.h"

enum { CLI_WHY_TOP = 8, CLI_WHY_TEXT = 320 };

typedef struct cli_why_request {
    const char *file;
    uint64_t step, id;
    const char *stage; /* NULL: all */
    const char *field;
    uint64_t top; /* contributions that are shown of a stage, largest first; UINT64_MAX: all, in their order */
    uint32_t depth;
    bool json;
} cli_why_request;

/* Prints the changes, and with a depth above 1 the chain. *changes: how many there were. */
rheo_result cli_why_print(const cli_why_request *request, rheo_player *player, uint64_t *changes, rheo_error *error);

/* "spring 12:17", "pressure of 12", "wall 2": what a contribution to particle `id` comes from. */
const char *cli_why_source(const rheo_contribution *c, uint64_t id, char text[CLI_WHY_TEXT]);
/* A link of a chain in words. */
const char *cli_why_link_text(const rheo_link *link, char text[CLI_WHY_TEXT]);
/* Why a chain ended: "ends: the ball acts ...". */
void cli_why_print_end(const rheo_chain *chain);
void cli_why_link_json(rheo__json *json, const rheo_link *link);
void cli_why_change_text(const cli_why_request *request, const rheo_change *change);
void cli_why_change_json(const cli_why_request *request, const rheo_change *change);
/* "depth", "command", ... of the end of a chain. */
const char *cli_why_end_name(rheo_chain_end end);

/* The unit of a field of a particle; "1" for a pure number or an unknown one. */
const char *cli_why_unit(const rheo_world *world, const char *field);

#endif
