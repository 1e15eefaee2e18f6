/* Shared by the files of `rheolog inspect`: the question and everything that answers it. */
#ifndef CLI_INSPECT_H
#define CLI_INSPECT_H

#include "cli/cli.h"

/* A row of a history: the velocity of a particle, or the velocity difference of the ends of a spring. */
typedef struct cli_lag {
    uint64_t step; /* the value is that at the end of this step */
    double time, weight, value[3];
} cli_lag;

enum { CLI_SPRING_VALUES = 6 };

/* A spring of a particle: the particle at its other end, and its values (CLI_SPRING_QUANTITIES). */
typedef struct cli_spring {
    uint32_t partner;
    double value[CLI_SPRING_VALUES];
} cli_spring;

/* The quantities of springs: their names are keys of JSON. */
extern const struct cli_spring_quantity {
    const char *name, *unit, *meaning;
} CLI_SPRING_QUANTITIES[CLI_SPRING_VALUES];

/* A ranking with its entries. */
typedef struct cli_ranking {
    const rheo_ranking *ranking;
    rheo_top_entry *entry;
    size_t count;
} cli_ranking;

enum { CLI_MAX_RANKINGS = 16 };

typedef struct cli_view {
    /* The question. */
    const char *file, *stage; /* stage: NULL for the end of the step */
    uint64_t step, particle, end[2];
    bool has_particle, has_spring, has_rankings;
    size_t top;

    /* The place. */
    rheo_recording *recording;
    rheo_recording_info info;
    bool failed; /* the run ended with a step that went bad */
    rheo_failure failure;
    char why[512]; /* message of the failure */
    const rheo_world *world;
    uint64_t complete;    /* the last step that the world has finished */
    const char *done;     /* the last stage of the next step that has run, "viscosity@3"; NULL between steps */
    char stage_run[32];   /* its text */
    uint32_t runs, all;   /* stage runs of the next step: done, and in all */
    uint32_t rows, modes; /* of histories */
    bool model_has_springs;

    /* The answer. */
    double *metric; /* of the last complete step, as recorded */
    cli_ranking ranking[CLI_MAX_RANKINGS];
    uint32_t rankings;
    rheo_particle_state state;
    uint32_t *neighbour;
    double *distance;
    size_t neighbours, springs;
    cli_spring *spring_of_particle;
    cli_lag *velocity;
    rheo_mode_state particle_mode[RHEO_HISTORY_MAX_MODES];
    uint32_t ends[2];
    double spring[CLI_SPRING_VALUES];
    cli_lag *difference;
    rheo_mode_state spring_mode[RHEO_HISTORY_MAX_MODES];
} cli_view;

/* Reads from the world whatever the question asks for. Returns an exit code; release in any case. */
int cli_inspect_gather(cli_view *v);
void cli_inspect_release(cli_view *v);
/* The first component of a quantity of the particle. */
const double *cli_quantity_value(const cli_view *v, const rheo_quantity *quantity);

/* A recorded metric of the step; NaN if the recording does not have it. */
double cli_view_metric(const cli_view *v, const char *name);

void cli_inspect_json(const cli_view *v);
void cli_inspect_text(const cli_view *v);

#endif
