/* A program that `rheolog bench --baseline` runs: its output, its messages, how it ended. */
#ifndef CLI_BENCH_CHILD_H
#define CLI_BENCH_CHILD_H

#include <stdbool.h>
#include <stddef.h>

typedef struct cli_child {
    const char *program;   /* searched in PATH if it has no slash */
    char *out;             /* all of standard output, ends with 0; allocated with malloc() */
    char first_error[256]; /* first line of standard error; "" if there is none */
    int code;              /* exit code, if it ended well */
    char problem[320];     /* "": it ran and exit code is 0. Otherwise what happened, as the end of a sentence */
} cli_child;

/*
 * Runs a program with arguments (argv[0] is ignored, NULL ends them) and waits until it ends, `timeout` seconds at
 * most; 0: as long as it takes. Its standard input is empty. A program that takes longer is killed with all the
 * programs that it started, also if this program is interrupted. False: see `problem`. Free `out` in both cases.
 */
bool cli_child_run(cli_child *child, const char *program, char *const *argv, double timeout);

/* A path of the program that runs now, also after its file was replaced; NULL: unknown. */
const char *cli_child_self(void);

#endif
