/* The map of `rheolog bench stability`: which runs of a ball scene stay well, by step, stiffness and solver. */
#ifndef CLI_BENCH_STABILITY_H
#define CLI_BENCH_STABILITY_H

#include "cli/bench.h"

enum { CLI_STABILITY_MOST = 32 }; /* steps, ratios */

/* A solver: parameters that choose it. */
typedef struct cli_stability_solver {
    const char *name;
    const char *set[3][2]; /* path, value */
} cli_stability_solver;

/* A run. Numbers that a scheme does not have are NaN. */
typedef struct cli_stability_cell {
    const cli_stability_solver *solver;
    double step, ratio;
    bool stable;
    uint64_t bad_step;       /* of an unstable run: in which its first sign came */
    char sign[64];           /* the measure that left its range, "failed step", or "ball_height" */
    double kappa, kappa_sum; /* largest stiffness_number and stiffness_sum, before any softening */
    double substeps;         /* mean */
    double softened;         /* most springs softened in a step */
    double dip, rise;        /* in radii; dip NaN: the ball sinks. Only of a stable run */
    double ns;               /* processor time per particle and step */
    uint64_t steps, hash;
} cli_stability_cell;

typedef struct cli_stability_map {
    double stiffness; /* k_min */
    double time;      /* length of a run */
    uint32_t particles;
    const cli_stability_solver *solver[CLI_STABILITY_MOST];
    double step[CLI_STABILITY_MOST], ratio[CLI_STABILITY_MOST];
    uint32_t solvers, steps, ratios;
    cli_stability_cell *cell; /* [solver][step][ratio] */
} cli_stability_map;

static inline const cli_stability_cell *cli_stability_at(const cli_stability_map *map, uint32_t solver, uint32_t step,
                                                         uint32_t ratio)
{
    return &map->cell[((size_t)solver * map->steps + step) * map->ratios + ratio];
}

/* The settings of a solver, as "scheme=summed substeps=2". */
void cli_stability_settings(const cli_stability_solver *solver, char *text, size_t size);

void cli_stability_print(const cli_stability_map *map);
void cli_stability_rows(const cli_stability_map *map, cli_bench_table *table);
/* Refuses files in FOLDER that cannot be written, before any run. */
int cli_stability_check_files(const char *folder);
/* Writes stability.csv and stability.svg. */
int cli_stability_write(const cli_stability_map *map, const char *folder);

#endif
