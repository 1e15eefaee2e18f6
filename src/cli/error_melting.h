/* Shared by the studies of the melting model: settings of a case, which run in turn and become points. */
#ifndef CLI_ERROR_MELTING_H
#define CLI_ERROR_MELTING_H

#include "cli/error_trials.h"

enum { CLI_MELT_QUANTITIES = 2, CLI_MELT_SETS = 2 };

typedef struct cli_melt_setting {
    const char *name;
    const char *series; /* NULL: in none */
    double refinement;
    uint32_t layers;                /* particles in the unit of length; 0: those of the case */
    const char *set[CLI_MELT_SETS]; /* KEY=VALUE */
} cli_melt_setting;

/* A run of a setting. */
typedef struct cli_melt_run {
    bool failed; /* a step was refused, or its numbers were not finite: there are no values */
    double value[CLI_MELT_QUANTITIES], reference[CLI_MELT_QUANTITIES], error[CLI_MELT_QUANTITIES]; /* NaN: none */
    double seconds, time;        /* of computing and simulated, of the steps that were timed */
    double substeps, iterations; /* of these steps */
    uint64_t timed, steps;       /* how many these are; steps of the run */
    uint32_t particles;
    uint64_t hash;
    rheo_real *position; /* at the end; NULL unless the case compares them */
} cli_melt_run;

typedef struct cli_melt_case cli_melt_case;
struct cli_melt_case {
    const char *scene;
    const char *quantity[CLI_MELT_QUANTITIES]; /* NULL: the case has one */
    uint32_t layers;
    const void *of; /* what `run` needs to know */
    const cli_melt_setting *setting;
    size_t settings;
    /* Runs a setting. `steps`: not more than so many; 0: all. Returns an exit code. */
    int (*run)(const cli_melt_case *c, const cli_melt_setting *s, const cli_bench_arguments *a, cli_melt_run *r);
    /* Sets the errors of a run from the first one, which is the reference; NULL: `run` has set them. */
    void (*compare)(cli_melt_run *r, const cli_melt_run *first);
};

/*
 * Runs all settings of a case that is wanted (--scenes) in turn, as often as there are repetitions, and adds their points. The cost is the median of
 * the processor times. us_time is that of the whole case, divided by the number of particles of the default spacing, so
 * that settings with other spacings compare.
 */
int cli_melt_measure(const cli_melt_case *c, cli_bench_arguments *a, cli_error_points *points);

/* ---- For `run` ---- */

uint32_t cli_melt_layers(const cli_melt_case *c, const cli_melt_setting *s);
/* Applies what is set. */
int cli_melt_set(const cli_melt_setting *s, rheo_world_def *def);
/* Steps until a time, but not more than the arguments allow. */
uint64_t cli_melt_steps_until(const cli_bench_arguments *a, double time, double step);
/* Makes steps and adds their cost, unless the run has failed. */
int cli_melt_step(cli_melt_run *r, rheo_world *world, uint64_t steps);
/* Takes particles, steps and hash from a world, unless the run has failed. */
void cli_melt_finish(cli_melt_run *r, const rheo_world *world);
/* Sets a quantity and its relative error. */
void cli_melt_value(cli_melt_run *r, int quantity, double value, double reference);

/* Particles: a block of a lattice with a corner at the origin, at rest, cold, with the density 1. */
typedef struct cli_melt_body {
    uint32_t count;
    rheo_real *position, *velocity, *density, *temperature;
} cli_melt_body;

/* Room for `copies` times as many particles. False: no memory. `jitter` in spacings. */
bool cli_melt_block(cli_melt_body *b, double spacing, const uint32_t size[3], double jitter, uint32_t copies);
void cli_melt_release(cli_melt_body *b);
/* Makes the particles those of a definition, without temperatures. */
void cli_melt_use(const cli_melt_body *b, rheo_world_def *def);
/* Reads a field with one value per particle, or three. False: there is none. */
bool cli_melt_read(const rheo_world *world, const char *field, rheo_real *values, size_t bytes);

#endif
