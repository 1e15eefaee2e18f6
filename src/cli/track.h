/* Shared by the files of `rheolog track`: the columns of the thing that is followed. */
#ifndef CLI_TRACK_H
#define CLI_TRACK_H

#include "cli/steps.h"

enum { CLI_TRACK_NAME = 64 };
typedef enum cli_track_kind { CLI_TRACK_PARTICLE, CLI_TRACK_SPRING, CLI_TRACK_BALL, CLI_TRACK_PROBE } cli_track_kind;

typedef struct cli_followed {
    cli_track_kind kind;
    uint32_t id, other; /* particle; ends of a spring; index of a ball */
    double point[3];    /* of a probe */
    bool history;
    /* The columns, and their values at one place; NaN: none. Both from malloc. */
    char (*name)[CLI_TRACK_NAME];
    double *value;
    size_t count;
} cli_followed;

/* Sets the names of the columns. False: no memory. */
bool cli_track_columns(cli_followed *t, const rheo_world *world);
/* Sets the values. */
rheo_result cli_track_values(cli_followed *t, const rheo_world *world, rheo_error *error);
void cli_track_release(cli_followed *t);

#endif
