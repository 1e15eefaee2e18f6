/* What a run of a scene is expected to be like and to cost: for `rheolog check` and the start of `rheolog run`. */
#ifndef CLI_PREFLIGHT_H
#define CLI_PREFLIGHT_H

#include "cli/cli.h"

/* A few steps of the scene, or of one like it with fewer particles, that does not settle. */
typedef struct cli_probe {
    uint64_t steps; /* 0: none could be made; the other numbers are then NaN */
    uint32_t particles;
    double ns;        /* processor time per particle and step, in the mean of the whole run */
    double substeps;  /* mean; NaN: the model or the scheme has none */
    double seconds;   /* processor time of the whole run */
    double bytes;     /* of its recording */
    char failed[512]; /* why a step could not be made, or "" */
} cli_probe;

typedef struct cli_preflight {
    rheo_preflight numbers;
    rheo_memory memory;
    uint64_t steps;
    cli_probe probe;
} cli_preflight;

/* Estimates what a run of so many steps is like. Returns an exit code. */
int cli_preflight_find(const rheo_scene *scene, uint64_t steps, bool probe, cli_preflight *preflight);
/* Makes the steps of the probe, for about 0.3 s (cli/preflight_probe.c). */
void cli_probe_scene(const rheo_scene *scene, uint64_t steps, uint64_t particles, cli_probe *probe);

/* The object `preflight`; NULL: null. */
void cli_preflight_json(rheo__json *json, const cli_preflight *preflight);
/* A line for each number, on standard output. */
void cli_preflight_print(const cli_preflight *preflight);
/* The essential ones in two lines, on standard error. */
void cli_preflight_brief(const cli_preflight *preflight);

#endif
