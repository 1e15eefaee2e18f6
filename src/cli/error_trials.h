/*
 * Trials of the thickening model: several settings run the same case from the same state. `rheolog bench error` has
 * studies that differ in their cases and settings.
 */
#ifndef CLI_ERROR_TRIALS_H
#define CLI_ERROR_TRIALS_H

#include "cli/error.h"

/* ---- Settled states ---- */

/* Particles, springs and the place of the ball, from which worlds of any setting start. */
typedef struct cli_settled {
    rheo_world_def def;
    double surface; /* level of the fluid, if there is a ball */
    rheo_real *position, *velocity, *rest_length;
    uint32_t *ends;
    rheo_wall *wall;
} cli_settled;

/* Makes a scene once. --settle replaces settle.time. The state must be released even if this fails. */
rheo_result cli_settle(cli_settled *s, rheo_scene *scene, const cli_bench_arguments *a, rheo_error *error);
void cli_settled_release(cli_settled *s);
/* A pool of nx x ny x nz particles between walls, with the ball of `bowling-ball-small` above it. To be released. */
rheo_result cli_pool_scene(rheo_scene *scene, int nx, int ny, int nz, rheo_error *error);
/* Parameter set S of docs/model.md at rest: a drop of this radius, 9 above the floor. */
void cli_drop_scene(rheo_scene *scene, rheo_fill *sphere, double radius);

/* ---- Settings ---- */

enum { CLI_SETS = 4 };

typedef struct cli_setting {
    const char *name;
    const char *series;           /* "": none */
    const char *law;              /* settings of one law have one limit step -> 0 */
    double divisor;               /* of the step */
    bool limit;                   /* the finest step of its law, from which the limit is extrapolated */
    const char *set[CLI_SETS][2]; /* path, value */
} cli_setting;

/* ---- Cases ---- */

enum { CLI_QUANTITIES = 8 };

/* A run of a case with a setting. */
typedef struct cli_trial {
    const struct cli_case *of;
    rheo_world_def def; /* with the setting */
    void *memory;       /* cli_case.bytes, zeroed */
    rheo_error *error;
    rheo_result result; /* measure() may set it to end the run; it then describes the error */
    double quantity[CLI_QUANTITIES];
    double ns; /* CPU time per particle and step */
    double substeps;
    uint32_t particles;
    uint64_t steps, hash;
} cli_trial;

/* What is measured. Functions that a case does not need are NULL. */
typedef struct cli_case {
    const char *name;
    const char *quantity[CLI_QUANTITIES]; /* names, up to the first NULL */
    double reference[CLI_QUANTITIES];     /* closed forms; NaN: the limit step -> 0 of the law */
    bool absolute[CLI_QUANTITIES];        /* whether errors are differences, as they are against a reference of 0 */
    rheo_world_def def;
    double longest;                                   /* time after which a run ends */
    const void *data;                                 /* for the functions */
    size_t bytes;                                     /* of the memory of a run */
    bool (*has)(const rheo_world_def *def);           /* whether the case can run with a setting */
    bool (*measure)(cli_trial *t, rheo_world *world); /* at the start and after each step; false: all is measured */
    void (*finish)(cli_trial *t); /* after the last step: quantities, and frees what measure() made */
} cli_case;

/*
 * Runs all settings in turn, `repetitions` times, and adds a point for each setting and quantity. Without a closed form a law needs a setting with `limit`, whose step is half of
 * the next coarser one with the same law and no other difference: the limit is 2 f(finest) - f(next).
 */
int cli_try(const cli_case *c, const cli_setting *settings, size_t count, cli_bench_arguments *a,
            cli_error_points *points);

/* The cases of a study. */
typedef struct cli_named_case {
    const char *name;
    int (*run)(cli_bench_arguments *a, cli_error_points *points);
} cli_named_case;

/* Whether --scenes, if it was given, names the case. */
/* Room for the names of all cases. */
enum { CLI_CASE_NAMES = 2048 };
bool cli_case_wanted(const cli_bench_arguments *a, const char *name);
/* Runs the cases that --scenes names, or all. */
int cli_try_cases(const cli_named_case *cases, size_t count, cli_bench_arguments *a, cli_error_points *points);

/*
 * Makes a world from t->def and steps it to the end of the case t->of, or `most` steps; t->memory has room. A step that fails
 * ends the run: what was not reached is NaN.
 */
rheo_result cli_trial_run(cli_trial *t, uint64_t most, rheo_error *error);
/* Angular velocity of a rigid body with the particles' places and angular momentum, about their centre of mass. */
double cli_spin(const rheo_world *world);

/* ---- Cases that several studies have ---- */

/* A drop that falls on a floor: lowest point of its centre, rebound after it, height at time 9. */
cli_case cli_drop_case(const rheo_world_def *def);

/* A ball that falls on a pool: dip, rise, depths 5 and 10 units of time after contact, time to 1.5 radii. */
cli_case cli_ball_case(const cli_settled *from, const char *name);
/* The share of the weight above that pressures carry in a pool at rest, at the height where the share is worst. */
int cli_hydrostatics(const cli_setting *settings, size_t count, cli_bench_arguments *a, cli_error_points *points);

/* Waves on lattices, whose closed forms are sums over a lattice. `lattice` is released by cli_settled_release(). */
typedef struct cli_wave {
    double rate;      /* of the closed form: angular frequency, or rate of decay */
    double amplitude; /* of position or velocity at the start */
    bool decays;
    const double *mode; /* [particle]: shape of the mode, displacement along x; allocated with malloc() */
} cli_wave;

/* A free block of springs, stretched along x in its first mode. */
rheo_result cli_block_case(cli_case *c, cli_wave *wave, cli_settled *lattice, rheo_error *error);
/* A shear wave in periodic springs, and one in viscous fluid without them. */
rheo_result cli_elastic_wave_case(cli_case *c, cli_wave *wave, cli_settled *lattice, rheo_error *error);
rheo_result cli_viscous_wave_case(cli_case *c, cli_wave *wave, cli_settled *lattice, rheo_error *error);

#endif
