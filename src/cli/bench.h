/* What the parts of `rheolog bench` share: cases, what was measured of them, tables of results, limits of a machine.
 */
#ifndef CLI_BENCH_H
#define CLI_BENCH_H

#include "cli/cli.h"

/* ---- Cases ---- */

enum { BENCH_MAX_CASES = 256, BENCH_MAX_STAGES = 32, BENCH_MAX_REPETITIONS = 1000 };

typedef struct bench_arguments {
    uint32_t repetitions;
    uint64_t steps, particles;
    uint32_t window[16], windows;
    bool csv, json;
    cli_progress progress;
} bench_arguments;

/* A scene to be timed, and what came of it. Times are ns a particle and step, an item for each repetition. */
typedef struct bench_case {
    char name[48];
    char kind[32]; /* history.kind; "" without history */
    rheo_scene scene;
    uint64_t lead; /* steps made, untimed, before the state that every repetition starts from */
    bool with_error;

    void *state; /* that state, as a checkpoint */
    size_t state_size;
    uint32_t particles, window;
    size_t history_bytes, field_bytes; /* of the remembered velocities; of all fields of the state */
    size_t world_bytes;                /* all that the library holds for the world between two steps */
    size_t process_bytes; /* by how much the process grew at most while the scene was made; 0: not known */
    double error; /* of D^q, the largest as a part of the largest D^q; NaN: there is no sum to hold it against */

    uint32_t stages;
    char stage[BENCH_MAX_STAGES][32];
    uint32_t repetitions;
    double *total, *stage_ns[BENCH_MAX_STAGES], *rest; /* rest: of the step, in no stage */
    double neighbours;
    double substeps, iterations; /* of a step; of the solver in a substep. 0 of models that have none */
    uint64_t hash;
} bench_case;

typedef struct bench_cases {
    uint32_t count;
    bench_case *at; /* BENCH_MAX_CASES */
} bench_cases;

/* The next case: a built-in scene with about so many particles (0: as many as it has), a wider or narrower pool. */
bench_case *bench_add(bench_cases *cases, const char *scene, uint64_t particles);
/* The window, 0: no history. The lead becomes as long as fills it. */
void bench_set_window(bench_case *c, uint32_t window);
void bench_release(bench_cases *cases);

/*
 * Makes the state of every case, sees that all kernels of this machine agree, and times the cases in turn. Returns an
 * exit code: CLI_DIFFERS if the hash of a repetition, or of kernels, is another.
 */
int bench_measure(bench_cases *cases, bench_arguments *a);

/* The middle one; of an even number the mean of both. */
double bench_median(const double *values, uint32_t count);
double bench_least(const double *values, uint32_t count);
double bench_largest(const double *values, uint32_t count);
/* Median of a stage; 0 for one that the case does not have. */
double bench_stage(const bench_case *c, const char *stage);
bool bench_has_stage(const bench_case *c, const char *stage);

/* The names of all stages of all cases, in the order of a step. Returns how many. */
uint32_t bench_all_stages(const bench_cases *cases, char stage[BENCH_MAX_STAGES][32]);

/* Measurements of the melting model (bench_melting.c). */
int bench_run_table2(bench_arguments *a);
int bench_run_error(bench_arguments *a);

/* The processor by name, and the compiler as rheo_build() has it. */
const char *bench_machine(void);
const char *bench_compiler(void);

/* ---- Tables: CSV with a line of names, or a JSON object a line ---- */

enum { BENCH_MAX_CELLS = 96 };

typedef struct bench_cell {
    char name[48];
    enum { BENCH_TEXT, BENCH_NUMBER, BENCH_WHOLE } kind;
    char text[96];
    double number;
    int decimals;
    uint64_t whole;
} bench_cell;

typedef struct bench_table {
    bool json, begun;
    uint32_t cells;
    bench_cell cell[BENCH_MAX_CELLS];
} bench_table;

void bench_cell_text(bench_table *table, const char *name, const char *value);
/* decimals < 0: so many with a power of ten. NaN: an empty cell, or null. */
void bench_cell_number(bench_table *table, const char *name, int decimals, double value);
void bench_cell_whole(bench_table *table, const char *name, uint64_t value);
void bench_end_row(bench_table *table);

/* ---- What the machine can do at best ---- */

typedef struct bench_limits {
    double arithmetic, root, division; /* additions and multiplications, ..., G/s, in vectors of the kernels in use */
    double memory_read, memory_copy;   /* GB/s; a copied byte is read and written and counts twice */
    double cache_read, cache_copy;     /* the same of arrays that stay in the caches */
    double memory, cache;              /* the better of the two */
    double memory_bytes, cache_bytes;  /* size of the arrays */
} bench_limits;

/* False: no memory. */
bool bench_measure_limits(bench_limits *limits);

/* What a stage needs at least, a particle and step. */
typedef struct bench_needs {
    double operations, roots, divisions, bytes;
    bool memory; /* its bytes come from memory, not from the caches */
} bench_needs;

/* False: no model of this stage ("": the rest of a step). */
bool bench_stage_needs(const bench_case *c, const char *stage, bench_needs *needs);
/* The time that no loop of the same work can be faster than, ns, and what sets it. */
double bench_limit(const bench_limits *limits, const bench_needs *needs, const char **bound);

#endif
