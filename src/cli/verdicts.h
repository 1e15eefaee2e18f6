/*
 * Reports of `verify` and `diff` for continuous integration: a line with totals, TAP, JUnit XML, and annotations of
 * GitHub. Every file that the user named is in every report; a file that could not be read is an error there.
 */
#ifndef CLI_VERDICTS_H
#define CLI_VERDICTS_H

#include "cli/cli.h"

typedef enum cli_outcome {
    CLI_OUTCOME_SAME,
    CLI_OUTCOME_DIFFERS,
    CLI_OUTCOME_UNREADABLE, /* damaged, missing, or of another kind */
    CLI_OUTCOME_FAILED,     /* the system failed */
    CLI_OUTCOME_INTERRUPTED,
    CLI_OUTCOMES,
} cli_outcome;

typedef struct cli_case {
    char *name;    /* the file, or the two files */
    char *file;    /* the file that an annotation belongs to */
    char *message; /* the verdict in one line */
    char *details; /* further lines; NULL: none */
    cli_outcome outcome;
    double seconds;
} cli_case;

typedef struct cli_verdicts {
    const char *command; /* "verify" */
    const char *items;   /* what the totals count: "recordings" */
    const char *junit;   /* file to write; NULL: none */
    bool json, tap, github;
    cli_case *cases;
    size_t count, room, of[CLI_OUTCOMES];
} cli_verdicts;

/* Whether `path` can become a JUnit file: a new file, or one that holds XML. Prints a message and returns CLI_BAD. */
int cli_check_junit(const char *path);

/*
 * Begins a report of `room` cases; the options are set. Removes an old JUnit file, so that it is not taken for the new
 * one if the program is killed.
 */
int cli_verdicts_begin(cli_verdicts *report, size_t room);
/*
 * Adds a case, and prints it at once in TAP and as an annotation if these are asked for. At most `room` times. `file`:
 * see cli_case. `v` has the message.
 */
int cli_verdicts_add(cli_verdicts *report, const char *name, const char *file, cli_outcome outcome,
                     const rheo_verification *v, double seconds);
/* Sets outcome and message for a task of the library that returned an error. */
cli_outcome cli_outcome_of_error(rheo_result result, const rheo_error *error, rheo_verification *v);
/* Prints the totals, writes the JUnit file and releases the report. Returns the exit code of the command. */
int cli_verdicts_end(cli_verdicts *report);

/* The outcome for a verdict. */
cli_outcome cli_outcome_of(rheo_verdict verdict);
/* "same", "differs", "unreadable", "failed", "interrupted" */
const char *cli_outcome_name(cli_outcome outcome);

/* Writes the cases as JUnit XML, beside `path` and renamed. */
int cli_junit_write(const cli_verdicts *report, const char *path);

#endif
