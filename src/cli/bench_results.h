/* Results of `rheolog bench` and `rheolog run`, read from what this or another version printed with --json. */
#ifndef CLI_BENCH_RESULTS_H
#define CLI_BENCH_RESULTS_H

#include "cli/bench.h"

/* What tells cases apart. A version that does not print one of these cannot distinguish them. */
enum {
    CLI_BENCH_CASE,
    CLI_BENCH_WINDOW,
    CLI_BENCH_KIND,
    CLI_BENCH_SCHEME,
    CLI_BENCH_SETTING,
    CLI_BENCH_STUDY,
    CLI_BENCH_KEYS
};

/* A case. Times are in ns per particle and step; of the measurement error, per unit of simulated time if it is
   known. */
typedef struct cli_bench_result {
    char key[CLI_BENCH_KEYS][64];
    bool has[CLI_BENCH_KEYS];
    char hash[24], particles[24]; /* "": not printed */
    double total;                 /* NaN: not printed */
    uint32_t stages;
    char stage[CLI_BENCH_MAX_STAGES][32]; /* the last is "rest" */
    double ns[CLI_BENCH_MAX_STAGES];
} cli_bench_result;

typedef struct cli_bench_results {
    uint32_t count;
    cli_bench_result *item; /* allocated with malloc() */
} cli_bench_results;

/*
 * Reads the cases in a text and appends them. False if the text is no result or memory is short; `wrong`
 * then begins with which it is.
 */
bool cli_bench_read_results(const char *text, cli_bench_results *results, char wrong[64]);
/* The first case that cannot be told from another one; NULL: there is none. */
const cli_bench_result *cli_bench_find_result(const cli_bench_results *results, const cli_bench_result *like);
/* Time of a stage; NaN: the case does not have it. */
double cli_bench_result_stage(const cli_bench_result *result, const char *stage);

#endif
