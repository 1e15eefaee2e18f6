/* Shared by the experiments with the melting model: what is measured in every object. Objects have the height 1. */
#ifndef CLI_EXPERIMENT_MELTING_H
#define CLI_EXPERIMENT_MELTING_H

#include "cli/experiment.h"

/* The particles of a world in one step. */
typedef struct cli_melting {
    uint32_t count;
    double spacing, melts_at; /* the middle of the melting band */
    double common;            /* temperature of all particles, if they have none of their own */
    const rheo_real *position;
    rheo_real *start, *temperature;
} cli_melting;

void cli_melting_release(cli_melting *melting);
double cli_melting_began_at(const cli_melting *melting, uint32_t id, int axis);
double cli_melting_is_at(const cli_melting *melting, uint32_t id, int axis);
double cli_melting_temperature(const cli_melting *melting, uint32_t id);

/* The first columns of the experiments with objects. */
enum { CLI_ITERATIONS, CLI_MELTED, CLI_TOP, CLI_BASE, CLI_MELTING_COLUMNS };

#define CLI_MELTING_COLUMN                                                                             \
    {"iterations", "1", "substeps since the start"},                                                   \
        {"melted", "1", "share of the particles that are hotter than the middle of the melting band"}, \
        {"top", "L", "mean height of what began above 0.7"},                                           \
    {                                                                                                  \
        "base", "L", "mean distance of what began below 0.35 from where it began"                      \
    }

/*
 * Reads a step and sets the common columns. cli_trial.memory[0] keeps the iterations. False: no memory; the columns are NaN,
 * and so no claim holds. Release it in any case.
 */
bool cli_melting_observe(const rheo_world *world, const cli_trial *run, cli_melting *melting, double *column);

/* Value of a column at an iteration of the paper, at the end of its step. NaN: the run is shorter. */
double cli_at_iteration(const cli_series *series, double iteration, uint32_t column);
/* The last value of a column. */
double cli_at_end(const cli_series *series, uint32_t column);

#endif
