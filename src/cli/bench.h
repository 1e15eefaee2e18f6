/* Shared by the files of `rheolog bench`: cases, statistics, tables, the limits of a machine. */
#ifndef CLI_BENCH_H
#define CLI_BENCH_H

#include "cli/cli.h"

/* ---- Arguments ---- */

typedef struct cli_bench_arguments {
    uint32_t repetitions;
    uint64_t steps, particles;
    uint32_t window[16], windows;
    bool csv, json;
    cli_progress progress;
} cli_bench_arguments;

/* The measurements, a file each. They return an exit code. */
int cli_bench_run_table1(cli_bench_arguments *a);
int cli_bench_run_table2(cli_bench_arguments *a);
int cli_bench_run_history(cli_bench_arguments *a);
int cli_bench_run_scaling(cli_bench_arguments *a);
int cli_bench_run_features(cli_bench_arguments *a);
int cli_bench_run_limits(cli_bench_arguments *a);
int cli_bench_run_error(cli_bench_arguments *a);

/* ---- Cases ---- */

enum { CLI_BENCH_MAX_CASES = 256, CLI_BENCH_MAX_STAGES = 32, CLI_BENCH_MAX_REPETITIONS = 1000 };

/* A scene and its measured costs. Times are ns per particle and step, one for each repetition. */
typedef struct cli_bench_case {
    char name[48];
    char kind[32]; /* history.kind; "" without history */
    rheo_scene scene;
    uint64_t lead; /* untimed steps before the state that every repetition starts from */
    bool with_error;

    void *state; /* that state, as a checkpoint */
    size_t state_size;
    uint32_t particles, window;
    size_t history_bytes, field_bytes; /* of the history; of all fields of the state */
    size_t world_bytes;                /* all memory that the library holds for the world between two steps */
    size_t process_bytes;              /* largest growth of the process while the scene was created; 0: unknown */
    double error; /* largest error of D^q, as a fraction of the largest D^q; NaN: no plain sum to compare with */

    uint32_t stages;
    char stage[CLI_BENCH_MAX_STAGES][32];
    uint32_t repetitions;
    double *total, *stage_ns[CLI_BENCH_MAX_STAGES], *rest; /* rest: time of a step outside all stages */
    double neighbours;
    double substeps, iterations; /* substeps of a step; solver iterations of a substep. 0 if the model has none */
    uint64_t hash;
} cli_bench_case;

typedef struct cli_bench_cases {
    uint32_t count;
    cli_bench_case *item; /* CLI_BENCH_MAX_CASES */
} cli_bench_cases;

/* Adds a built-in scene with about `particles` particles in a wider or narrower pool; 0: as in the scene. */
cli_bench_case *cli_bench_add(cli_bench_cases *cases, const char *scene, uint64_t particles);
/* Sets the history window; 0: no history. The lead becomes just long enough to fill it. */
void cli_bench_set_window(cli_bench_case *c, uint32_t window);
void cli_bench_release(cli_bench_cases *cases);
/* Releases the cases and says that memory is short. */
int cli_bench_no_memory(cli_bench_cases *cases);

/*
 * Creates the state of every case, checks that all SIMD variants of this machine agree, and times the cases in turn.
 * Returns an exit code; CLI_DIFFERS if a repetition or a variant ends with a different hash.
 */
int cli_bench_measure(cli_bench_cases *cases, cli_bench_arguments *a);

/* The velocities of some particles at every step, to compare D^q with a plain sum. */
typedef struct cli_bench_signals {
    uint32_t particles;
    size_t steps, room;
    double *velocity; /* [particle][axis][step]; from malloc */
} cli_bench_signals;

bool cli_bench_begin_signals(cli_bench_signals *signals, const rheo_world *world, size_t steps);
void cli_bench_take_signals(cli_bench_signals *signals, const rheo_world *world);
/* Largest error of D^q as a fraction of the largest D^q; NaN if no plain sum is known for the history kind. */
double cli_bench_derivative_error(const cli_bench_signals *signals, const rheo_world *world, const char *kind);

/* ---- Statistics ---- */

/* The middle value; for an even number the mean of the two middle ones. */
double cli_bench_median(const double *values, uint32_t count);
double cli_bench_least(const double *values, uint32_t count);
double cli_bench_largest(const double *values, uint32_t count);
/* Median of a stage; 0 if the case does not have it. */
double cli_bench_stage(const cli_bench_case *c, const char *stage);
bool cli_bench_has_stage(const cli_bench_case *c, const char *stage);
/* Medians of the whole step, and of the time outside all stages. */
double cli_bench_total(const cli_bench_case *c);
double cli_bench_rest(const cli_bench_case *c);
double cli_bench_per_particle(const cli_bench_case *c, size_t bytes);
/* The names of all stages of all cases, in the order of a step. Returns how many. */
uint32_t cli_bench_all_stages(const cli_bench_cases *cases, char stage[CLI_BENCH_MAX_STAGES][32]);

/* ---- The process ---- */

/* Keeps the process on its current core, if the system allows it. */
void cli_bench_pin(void);
/* The name of the processor, and the compiler as in rheo_build(). */
const char *cli_bench_machine(void);
const char *cli_bench_compiler(void);
const char *cli_bench_real(void);
/* Starts a new peak; returns the present memory of the process, bytes. */
size_t cli_bench_reset_peak_memory(void);
/* The largest memory of the process since then; 0: the system does not say. */
size_t cli_bench_peak_memory(void);
/* An allocator that counts, and the bytes that it has handed out. */
rheo_allocator cli_bench_allocator(void);
size_t cli_bench_allocated(void);

/* ---- Tables: CSV with a line of names, or one JSON object per line ---- */

enum { CLI_BENCH_MAX_CELLS = 96 };

typedef struct cli_bench_cell {
    char name[48];
    enum { CLI_BENCH_TEXT, CLI_BENCH_NUMBER, CLI_BENCH_WHOLE } kind;
    char text[96];
    double number;
    int decimals;
    uint64_t whole;
} cli_bench_cell;

typedef struct cli_bench_table {
    bool json, begun;
    uint32_t cells;
    cli_bench_cell cell[CLI_BENCH_MAX_CELLS];
} cli_bench_table;

void cli_bench_cell_text(cli_bench_table *table, const char *name, const char *value);
/* decimals < 0: so many, with a power of ten. NaN: an empty cell, or null. */
void cli_bench_cell_number(cli_bench_table *table, const char *name, int decimals, double value);
void cli_bench_cell_whole(cli_bench_table *table, const char *name, uint64_t value);
/* ns_STAGE for all stages of all cases: the medians times `scale`. */
void cli_bench_cell_stages(cli_bench_table *table, const cli_bench_cases *cases, const cli_bench_case *c,
                           int decimals, double scale);
/* bytes_state, bytes_world, hash, steps, repetitions, and the build. */
void cli_bench_cell_run(cli_bench_table *table, const cli_bench_case *c, const cli_bench_arguments *a);
/* machine, compiler, real, simd. */
void cli_bench_cell_build(cli_bench_table *table);
void cli_bench_end_row(cli_bench_table *table);

/* ---- Reports ---- */

/* Adds the cells that only one measurement has. */
typedef void cli_bench_own_cells(cli_bench_table *table, const cli_bench_cases *cases, const cli_bench_case *c);
typedef void cli_bench_print(const cli_bench_cases *cases, const cli_bench_arguments *a);

/* Measures the cases, prints them with `text`, or as rows of a table with `own` cells, and releases them. */
int cli_bench_report(cli_bench_cases *cases, cli_bench_arguments *a, cli_bench_print *text, cli_bench_own_cells *own);
/* A row for each case: cells that all measurements have, with `own` between them. */
void cli_bench_rows(const cli_bench_cases *cases, const cli_bench_arguments *a, cli_bench_own_cells *own);
/* Machine, build and repetitions, and after them `rest`. */
void cli_bench_print_head(const cli_bench_arguments *a, const char *rest);
/* Median, least and largest time, 8 and 13 columns wide, times `scale`. */
void cli_bench_print_spread(const cli_bench_case *c, double scale);
extern const char cli_bench_per_step[]; /* the rest of most heads */

/* ---- Limits of the machine ---- */

typedef struct cli_bench_limits {
    double arithmetic, root, division; /* additions and multiplications, ..., G/s, in vectors of the SIMD variant */
    double memory_read, memory_copy;   /* GB/s; a copied byte is read and written, so it counts twice */
    double cache_read, cache_copy;     /* the same for arrays that stay in the caches */
    double memory, cache;              /* the better of the two */
    double memory_bytes, cache_bytes;  /* size of the arrays */
} cli_bench_limits;

/* False: no memory. */
bool cli_bench_measure_limits(cli_bench_limits *limits);

/* The least work of a stage, per particle and step. */
typedef struct cli_bench_needs {
    double operations, roots, divisions, bytes;
    bool memory; /* its bytes come from memory, not from the caches */
} cli_bench_needs;

/* False: the needs of this stage are not known ("": the rest of a step). */
bool cli_bench_stage_needs(const cli_bench_case *c, const char *stage, cli_bench_needs *needs);
/* The shortest time for that work, ns, and the resource that sets it. */
double cli_bench_limit(const cli_bench_limits *limits, const cli_bench_needs *needs, const char **bound);
/* Measures the limits of the machine, and prints the stages of a case beside them. Returns an exit code. */
int cli_bench_print_limits(const cli_bench_case *c);

#endif
