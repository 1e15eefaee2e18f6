/* Shared by the files of `rheolog inspect`: the request and all values that are printed. */
#ifndef CLI_INSPECT_H
#define CLI_INSPECT_H

#include "cli/cli.h"

/* A row of a history: the velocity of a particle, or the velocity difference between the ends of a spring. */
typedef struct cli_lag {
    uint64_t step; /* step at whose end the value was stored */
    double time, weight, value[3];
} cli_lag;

enum { CLI_SPRING_VALUES = 6 };

/* A spring of a particle: the particle at its other end, and its values (CLI_SPRING_QUANTITIES). */
typedef struct cli_spring {
    uint32_t partner;
    double value[CLI_SPRING_VALUES];
} cli_spring;

/* Quantities of springs. Their names are the keys in JSON. */
extern const struct cli_spring_quantity {
    const char *name, *unit, *meaning;
} CLI_SPRING_QUANTITIES[CLI_SPRING_VALUES];

/* A ranking and its entries. */
typedef struct cli_ranking {
    const rheo_ranking *ranking;
    rheo_top_entry *entry;
    size_t count;
} cli_ranking;

enum { CLI_MAX_RANKINGS = 16 };

typedef struct cli_view {
    /* Request. */
    const char *file, *stage;              /* stage: NULL is the end of the step */
    uint64_t step, particle, end[2], ball; /* ball: only this one, from 1 on; 0: all */
    bool has_particle, has_spring, has_rankings;
    size_t top;

    /* State. */
    rheo_recording *recording;
    rheo_recording_info info;
    bool failed; /* the run ended with a step that failed */
    rheo_failure failure;
    char why[512]; /* message of the failure */
    const rheo_world *world;
    uint64_t complete;    /* last step that the world has finished */
    const char *done;     /* last stage that has run in the next step, such as "viscosity@3"; NULL between steps */
    char stage_run[32];   /* text of `done` */
    uint32_t runs, all;   /* stage runs of the next step: number done, total number */
    uint32_t rows, modes; /* size of each history */
    bool model_has_springs;

    /* Result. */
    double *metric; /* recorded metrics of the last complete step */
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

/* Takes the world to be read, and where it is. */
void cli_inspect_at(cli_view *v, const rheo_world *world);
/* Reads two different ids, separated by a colon. */
bool cli_ends_from(const char *text, uint64_t end[2]);
/* Refuses the name of a stage that the world does not have; v->stage, in which @ and the number may be wrong. */
int cli_inspect_check_stage(const cli_view *v, const rheo_world *world);
/* Reads the requested values from the world. Returns an exit code. Call cli_inspect_release() after a failure too. */
int cli_inspect_gather(cli_view *v);
void cli_inspect_release(cli_view *v);
/* Points to the first component of a quantity of the particle. */
const double *cli_quantity_value(const cli_view *v, const rheo_quantity *quantity);

/* A recorded metric of the step; NaN if the recording does not have it. */
double cli_view_metric(const cli_view *v, const char *name);
/* Names of the plates, by RHEO_PLATE_LOWER and RHEO_PLATE_UPPER. */
extern const char *const cli_plate_name[2];

void cli_inspect_json(const cli_view *v);
void cli_inspect_text(const cli_view *v);
/* Parts of that text: the ball; a metric; the rankings, the particle and the spring that were asked for. */
void cli_inspect_text_ball(const cli_view *v);
void cli_inspect_text_metric(const cli_view *v, const rheo_metric_info *info);
void cli_inspect_text_things(const cli_view *v);

#endif
