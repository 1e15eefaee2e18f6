/* Shared by the files of `rheolog bench predictor`: random scenes, their verdicts, and what the measures said. */
#ifndef CLI_BENCH_PREDICTOR_H
#define CLI_BENCH_PREDICTOR_H

#include "cli/bench.h"

/* ---- Random scenes (bench_predictor_scene.c) ---- */

/* The kinds of scenes; measures and limits differ between them. */
enum { CLI_PREDICTOR_SUMMED, CLI_PREDICTOR_SEQUENTIAL, CLI_PREDICTOR_MELTING, CLI_PREDICTOR_GROUPS };
extern const char *const cli_predictor_group_name[CLI_PREDICTOR_GROUPS];

/* The group of a scene: a third each, and the same in any series of seeds. */
uint32_t cli_predictor_group(uint64_t seed);
/* Draws the scene of a seed; release it. */
rheo_result cli_predictor_scene(uint32_t group, uint64_t seed, rheo_scene *scene, rheo_error *error);
/* The path of a parameter that is drawn in some scenes; NULL past the last. */
const char *cli_predictor_parameter(size_t index);

/* ---- Runs (bench_predictor_run.c) ---- */

/*
 * Why a run is said to have blown up. None of these reads a measure of the doctor, but the step that failed, which is
 * the end of any run.
 */
typedef enum cli_predictor_reason {
    CLI_PREDICTOR_WELL,
    CLI_PREDICTOR_FAILED,      /* a step failed: the state was not finite, or was refused */
    CLI_PREDICTOR_ENERGY,      /* more kinetic energy than ten times all that was put in */
    CLI_PREDICTOR_SPEED,       /* a particle, or the ball, three times as fast as anything could make it */
    CLI_PREDICTOR_LEFT,        /* a particle behind a wall, by more than a support */
    CLI_PREDICTOR_TEMPERATURE, /* beyond the temperatures of the start by more than a tenth of their difference */
    CLI_PREDICTOR_REASONS
} cli_predictor_reason;
extern const char *const cli_predictor_reason_name[CLI_PREDICTOR_REASONS];

enum { CLI_PREDICTOR_MEASURES = RHEO_MAX_FINDINGS + 2 };

/* A measure in the steps of a run up to the one in which it blew up. */
typedef struct cli_predictor_value {
    bool measured;
    double most;    /* largest value; NaN if one was */
    uint64_t first; /* first step out of range; UINT64_MAX: none */
} cli_predictor_value;

typedef struct cli_predictor_run {
    uint32_t group;
    uint64_t seed, steps, hash;
    uint32_t particles;
    char about[160];
    char value[32][32]; /* of the parameters, as text; "": not of its model */
    cli_predictor_reason reason;
    uint64_t bad;             /* the step in which it blew up */
    uint64_t unhealthy, sign; /* first severe measure, and first sign of any but a notice; UINT64_MAX: none */
    double energy, speed;     /* largest energy/energy put in, and largest speed/largest possible speed */
    cli_predictor_value measure[CLI_PREDICTOR_MEASURES]; /* those of the group */
} cli_predictor_run;

/* A measure of a group. */
typedef struct cli_predictor_measure {
    const char *name, *meaning, *kind;
    double limit, certain;
} cli_predictor_measure;

typedef struct cli_predictor_group_measures {
    uint32_t count;
    cli_predictor_measure item[CLI_PREDICTOR_MEASURES];
} cli_predictor_group_measures;

/* Runs the scene and examines every step. Returns an exit code. */
int cli_predictor_examine(const rheo_scene *scene, cli_predictor_run *run, cli_predictor_group_measures *measures);
/* Whether the measure was in range in every step up to the blow-up. */
bool cli_predictor_in_range(const cli_predictor_value *value, const cli_predictor_measure *measure);

/* ---- Results (bench_predictor_report.c) ---- */

typedef struct cli_predictor_results {
    uint32_t count;
    cli_predictor_run *run;
    cli_predictor_group_measures group[CLI_PREDICTOR_GROUPS];
} cli_predictor_results;

/* What a measure is worth as a predictor. */
typedef struct cli_predictor_row {
    const cli_predictor_measure *measure;
    uint32_t group;
    uint32_t below, below_bad; /* scenes in which it stayed in range, and those of them that blew up */
    uint32_t alone, alone_bad; /* the same where all other conditions and precursors stayed in range, too */
    uint32_t above, above_bad;
    double least_bad; /* least of the largest values of scenes that blew up with the others in range; NaN: none */
    double most_well; /* largest value in scenes that stayed well */
    double lead, least_lead; /* steps from the first step out of range to the blow-up: median and least */
} cli_predictor_row;

void cli_predictor_judge(const cli_predictor_results *results, uint32_t group, uint32_t measure,
                         cli_predictor_row *row);
/*
 * CLI_DIFFERS, with a message, if scenes blew up below a stated bound while all conditions were in range; CLI_DONE
 * otherwise.
 */
int cli_predictor_check(const cli_predictor_results *results);
/* Prints what the arguments ask for, and writes the files of -o. Returns an exit code. */
/* Refuses a folder in which the files cannot be written. */
int cli_predictor_check_files(const char *folder);
int cli_predictor_report(const cli_predictor_results *results, const cli_bench_arguments *a);
/* FOLDER/predictor.svg. */
int cli_predictor_plot(const cli_predictor_results *results, const char *path);

#endif
