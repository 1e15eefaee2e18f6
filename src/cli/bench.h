/* Shared by the files of `rheolog bench`: cases, statistics, tables, the limits of a machine. */
#ifndef CLI_BENCH_H
#define CLI_BENCH_H

#include "cli/cli.h"

/* ---- Arguments ---- */

typedef struct cli_bench_arguments {
    uint32_t repetitions;
    uint64_t steps, particles;
    const char *model;   /* error: the only model to be measured; NULL: all */
    const char *studies; /* error: their names with commas between; NULL: all */
    const char *folder;  /* error, stability, predictor: for files of the results; NULL: none */
    const char *trace;   /* file for the stages of some steps of every case; NULL: none */
    const char *scheme;  /* value of `scheme`; NULL: that of the measurement */
    const char *scenes;  /* scenes, error: names of scenes or cases with commas between; NULL: all */
    char *
        cases; /* error: takes the names of the cases, with commas between, instead of measuring them; NULL: measure */
    /* stability: k_min, and lists with commas between; NULL: the default */
    const char *stiffness, *ratios, *step_sizes, *solvers;
    cli_number settle; /* steps for which a fluid settles, instead of settle.time */
    uint32_t window[16], windows;
    const char *simd;
    bool csv, json;
    uint64_t scene_count, seed; /* predictor: random scenes, and the seed of the first */
    /* Comparison with another program. */
    const char *measurement, *window_list; /* name; text of --windows */
    const char *baseline;                  /* program; NULL: no comparison */
    uint32_t rounds;
    uint64_t timeout; /* seconds for a measurement of the baseline; 0: as many as this program suggests */
    cli_progress progress;
} cli_bench_arguments;

/* Each measurement has its own file. The functions return an exit code. */
int cli_bench_run_table1(cli_bench_arguments *a);
int cli_bench_run_table2(cli_bench_arguments *a);
int cli_bench_run_history(cli_bench_arguments *a);
int cli_bench_run_scaling(cli_bench_arguments *a);
int cli_bench_run_features(cli_bench_arguments *a);
int cli_bench_run_limits(cli_bench_arguments *a);
int cli_bench_run_error(cli_bench_arguments *a);
int cli_bench_run_scenes(cli_bench_arguments *a);
int cli_bench_run_predictor(cli_bench_arguments *a);
int cli_bench_run_stability(cli_bench_arguments *a);
/* Makes the measurement with this program and with the baseline in turn, and compares them. */
int cli_bench_compare(cli_bench_arguments *a);

/* A scene of the measurement scenes, and its steps. False: there is no further one. */
bool cli_bench_next_scene(const cli_bench_arguments *a, uint32_t index, char name[48], uint64_t *steps);

/* ---- Cases ---- */

enum {
    CLI_BENCH_MAX_CASES = 256,
    CLI_BENCH_MAX_STAGES = 32,
    CLI_BENCH_MAX_FIELDS = 48,
    CLI_BENCH_MAX_REPETITIONS = 1000
};

/* A scene and its measured costs. Times are in ns per particle and step, one value per repetition. */
typedef struct cli_bench_case {
    char name[48];
    char kind[32];   /* history.kind; "" without history */
    char scheme[16]; /* "" if the model has none */
    rheo_scene scene;
    uint64_t lead;    /* untimed steps, which lead to the initial state of all repetitions */
    uint64_t warm_up; /* untimed steps of every repetition */
    uint64_t steps;   /* timed steps of a repetition; 0: those of the arguments */
    bool with_error;
    bool recorded; /* in memory, in all timed steps */

    void *state; /* initial state of all repetitions, as a checkpoint */
    size_t state_size;
    uint32_t particles, window;
    size_t history_bytes, field_bytes; /* bytes of the history, and of all fields of the state */
    size_t world_bytes;                /* all memory that the library holds for the world between two steps */
    size_t process_bytes;              /* largest growth of the process while the scene was created; 0: unknown */
    double recorded_bytes;             /* of the recording, for every step; 0: not recorded */
    double error;                      /* result of cli_bench_derivative_error() */

    uint32_t stages, fields;
    char stage[CLI_BENCH_MAX_STAGES][32], field[CLI_BENCH_MAX_FIELDS][32];
    uint32_t repetitions;
    double *total, *stage_ns[CLI_BENCH_MAX_STAGES], *rest; /* rest: time of a step outside its stages */
    double neighbours;
    double substeps, iterations; /* substeps per step, solver iterations per substep; 0: none */
    uint64_t hash;
} cli_bench_case;

typedef struct cli_bench_cases {
    uint32_t count;
    cli_bench_case *item; /* room for CLI_BENCH_MAX_CASES */
} cli_bench_cases;

/*
 * Adds a built-in scene. Resizes its pool so that it holds about `particles` particles; 0: the pool is not changed.
 */
cli_bench_case *cli_bench_add(cli_bench_cases *cases, const char *scene, uint64_t particles);
/* Sets the history window, and a lead that is just long enough to fill it. 0: no history. */
void cli_bench_set_window(cli_bench_case *c, uint32_t window);
void cli_bench_release(cli_bench_cases *cases);
/* Releases the cases, prints that there is no memory, and returns the exit code. */
int cli_bench_no_memory(cli_bench_cases *cases);

/*
 * Creates the initial state of every case, checks that all SIMD variants of this machine agree, and times the cases
 * in turn. Returns an exit code: CLI_DIFFERS if a repetition or a variant ends with a different hash.
 */
int cli_bench_measure(cli_bench_cases *cases, cli_bench_arguments *a);

/* A world that a case is measured with. */
typedef struct cli_bench_run {
    rheo_recording *recording;
    rheo_world *world;
    rheo_recorder *recorder; /* NULL: the run is not recorded */
} cli_bench_run;

/* Opens the world of a case, `steps` steps after its initial state. */
int cli_bench_begin_run(const cli_bench_case *c, uint64_t steps, cli_bench_run *run);
void cli_bench_end_run(cli_bench_run *run);

/* Makes some more steps of every case and writes when each of their stages began and ended (bench_trace.c). */
int cli_bench_trace(const cli_bench_cases *cases, const cli_bench_arguments *a);

/* Number of substeps of the last step; 0: the model, or the scheme, has none. */
double cli_bench_substeps(const rheo_world *world);

/* Velocities of some particles at every step, which are used to compare D^q with a plain sum. */
typedef struct cli_bench_signals {
    uint32_t particles;
    size_t steps, room;
    double *velocity; /* [particle][axis][step], allocated with malloc() */
} cli_bench_signals;

bool cli_bench_begin_signals(cli_bench_signals *signals, const rheo_world *world, size_t steps);
void cli_bench_take_signals(cli_bench_signals *signals, const rheo_world *world);
/* Largest error of D^q as a fraction of the largest D^q; NaN if no plain sum is known for the history kind. */
double cli_bench_derivative_error(const cli_bench_signals *signals, const rheo_world *world, const char *kind);

/* ---- Statistics ---- */

/* The middle value, or the mean of the two middle values if their number is even. */
double cli_bench_median(const double *values, uint32_t count);
double cli_bench_least(const double *values, uint32_t count);
double cli_bench_largest(const double *values, uint32_t count);
/*
 * The 95 % confidence interval of the median of a sample. Its ends are two of the values, equally far from the least and
 * the largest. Up to 8 values they are the least and the largest; with 5 values the probability is 94 %.
 */
void cli_bench_median_range(const double *values, uint32_t count, double range[2]);
/* Median of a stage; 0 if the case does not have it. */
double cli_bench_stage(const cli_bench_case *c, const char *stage);
bool cli_bench_has_stage(const cli_bench_case *c, const char *stage);
/* Medians of the time of a step, and of its part outside the stages. */
double cli_bench_total(const cli_bench_case *c);
double cli_bench_rest(const cli_bench_case *c);
double cli_bench_per_particle(const cli_bench_case *c, size_t bytes);
/* Lists the stages of all cases in the order of a step. Returns their number. */
uint32_t cli_bench_all_stages(const cli_bench_cases *cases, char stage[CLI_BENCH_MAX_STAGES][32]);

/* ---- The process ---- */

/* Keeps the process, and those that it starts, on its current core. Returns the core; -1: unknown. */
int cli_bench_pin(void);
/* Name of the processor. */
const char *cli_bench_machine(void);
/* Resets the peak memory of the process. Returns its current memory, bytes. */
size_t cli_bench_reset_peak_memory(void);
/* Peak memory of the process since the reset, bytes; 0: unknown. */
size_t cli_bench_peak_memory(void);
/* An allocator that counts, and the number of bytes that are allocated now. */
rheo_allocator cli_bench_allocator(void);
size_t cli_bench_allocated(void);

/* ---- Tables: CSV with a header line, or one JSON object per line ---- */

enum { CLI_BENCH_MAX_CELLS = 96 };

typedef struct cli_bench_cell {
    char name[48];
    enum { CLI_BENCH_TEXT, CLI_BENCH_NUMBER, CLI_BENCH_WHOLE } kind;
    char text[256];
    double number;
    int decimals;
    uint64_t whole;
} cli_bench_cell;

typedef struct cli_bench_table {
    FILE *file; /* NULL: standard output */
    bool json, begun;
    uint32_t cells;
    cli_bench_cell cell[CLI_BENCH_MAX_CELLS];
} cli_bench_table;

void cli_bench_cell_text(cli_bench_table *table, const char *name, const char *value);
/* Adds a number with `decimals` decimals; if negative, -decimals in exponential form. NaN: an empty cell, or null. */
void cli_bench_cell_number(cli_bench_table *table, const char *name, int decimals, double value);
void cli_bench_cell_whole(cli_bench_table *table, const char *name, uint64_t value);
/* Adds ns_STAGE for all stages of all cases: the medians times `scale`. */
void cli_bench_cell_stages(cli_bench_table *table, const cli_bench_cases *cases, const cli_bench_case *c,
                           int decimals, double scale);
/* Adds bytes_state, bytes_world, hash, steps, repetitions, and the cells of the build. */
void cli_bench_cell_run(cli_bench_table *table, const cli_bench_case *c, const cli_bench_arguments *a);
/* Adds machine, compiler, real and simd. */
void cli_bench_cell_build(cli_bench_table *table);
void cli_bench_end_row(cli_bench_table *table);

/* ---- Reports ---- */

/* Adds the cells that only one measurement has. */
typedef void cli_bench_own_cells(cli_bench_table *table, const cli_bench_cases *cases, const cli_bench_case *c);
typedef void cli_bench_print(const cli_bench_cases *cases, const cli_bench_arguments *a);

/* Measures and releases the cases. Prints them with `text`, or with `own` as rows of a table. */
int cli_bench_report(cli_bench_cases *cases, cli_bench_arguments *a, cli_bench_print *text, cli_bench_own_cells *own);
/* Prints one row per case: the cells of all measurements, with the cells of `own` between them. */
void cli_bench_rows(const cli_bench_cases *cases, const cli_bench_arguments *a, cli_bench_own_cells *own);
/* Prints machine, build and repetitions, followed by `rest`. */
void cli_bench_print_head(const cli_bench_arguments *a, const char *rest);
/* Prints the median and, as one column, the least and the largest time, all times `scale`. */
void cli_bench_print_spread(const cli_bench_case *c, double scale);
extern const char cli_bench_per_step[]; /* `rest` of most measurements */

/* ---- Limits of the machine ---- */

typedef struct cli_bench_limits {
    double arithmetic, root, division; /* rates in vectors of the SIMD variant, 1e9/s */
    double memory_read, memory_copy;   /* GB/s; a copied byte counts twice, because it is read and written */
    double cache_read, cache_copy;     /* the same for arrays that stay in the caches */
    double memory, cache;              /* the larger of read and copy */
    double memory_bytes, cache_bytes;  /* sizes of the arrays */
} cli_bench_limits;

/* False: no memory. */
bool cli_bench_measure_limits(cli_bench_limits *limits);

/* Least work of a stage, per particle and step. */
typedef struct cli_bench_needs {
    double operations, roots, divisions, bytes;
    bool memory; /* its data are in memory, not in the caches */
} cli_bench_needs;

/* Computes the needs of a stage; "": the rest of a step. False: they are not known. */
bool cli_bench_stage_needs(const cli_bench_case *c, const char *stage, cli_bench_needs *needs);
/* Shortest time for this work, ns. Names the resource that limits it in *bound. */
double cli_bench_limit(const cli_bench_limits *limits, const cli_bench_needs *needs, const char **bound);
/* Measures the limits of the machine and compares the stages of a case with them. Returns an exit code. */
int cli_bench_print_limits(const cli_bench_case *c);

#endif
