/* Comparison of two programs by `rheolog bench --baseline`. */
#ifndef CLI_BENCH_COMPARE_H
#define CLI_BENCH_COMPARE_H

#include "cli/bench_results.h"

typedef struct cli_bench_side {
    const char *program;
    char version[192];
    cli_bench_results *round; /* the results of each round; all rounds have the same cases */
} cli_bench_side;

typedef struct cli_bench_comparison {
    cli_bench_arguments *a;
    cli_bench_side here, baseline;
    char *bench_help, *parameters; /* what the baseline offers */
    int core;                      /* -1: unknown */
    double longest;                /* time of this program's longest measurement, s */
} cli_bench_comparison;

/* Prints all cases that both programs have. Returns an exit code: CLI_BAD if there is none. */
int cli_bench_print_comparison(const cli_bench_comparison *c);

#endif
