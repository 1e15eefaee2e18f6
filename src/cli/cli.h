/* What the commands share: exit codes, messages, options and their help, files. */
#ifndef CLI_CLI_H
#define CLI_CLI_H

#include <stdio.h>

#include "cli/json_writer.h"
#include "rheolog/rheolog.h"

/* ---- Exit codes and messages ---- */

enum {
    CLI_DONE = 0,
    CLI_DIFFERS = 1, /* differs, unhealthy, interrupted */
    CLI_BAD = 2,     /* bad usage, bad input */
    CLI_SYSTEM = 3,  /* the system failed: disk, memory */
};

/* "rheolog: ..." on standard error; returns `code`, so that a caller can `return cli_fail(...)`. */
int cli_fail(int code, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* The same without an exit code. */
void cli_warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* The exit code for what the library returned. */
int cli_code(rheo_result result);
/* Says the library's error and returns its exit code. */
int cli_error(rheo_result result, const rheo_error *error);

/* ---- Options ---- */

typedef enum cli_kind {
    CLI_FLAG,   /* bool */
    CLI_TEXT,   /* const char * */
    CLI_NUMBER, /* cli_number */
    CLI_LIST,   /* cli_list; the option may be repeated */
} cli_kind;

typedef struct cli_number {
    bool given;
    uint64_t value;
} cli_number;

#define CLI_MAX_LIST 256

typedef struct cli_list {
    size_t count;
    const char *item[CLI_MAX_LIST];
} cli_list;

typedef struct cli_option {
    const char *name;     /* "--steps"; NULL ends a table */
    const char *letter;   /* "-o" or NULL */
    const char *argument; /* as in the help; NULL for a flag */
    cli_kind kind;
    void *target;
} cli_option;

typedef struct cli_command {
    const char *name;
    const char *help; /* help/NAME.txt */
    int (*run)(int argc, char **argv);
} cli_command;

#define CLI_COMMAND(name, purpose) extern const cli_command cli_##name;
#include "cli/commands.def"
#undef CLI_COMMAND

/* Goes on: what cli_parse() returns when there is something to do. */
enum { CLI_GO_ON = -1 };

/*
 * Reads the options; what is left, the operands, is moved to argv[0 .. *argc-1]. Returns CLI_GO_ON, or an
 * exit code: CLI_DONE after --help, CLI_BAD after a message.
 */
int cli_parse(const cli_command *command, const cli_option *options, int *argc, char **argv);
/* "rheolog COMMAND: message" and where help is; returns CLI_BAD. */
int cli_usage(const cli_command *command, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A whole number, 0 and more, without sign, blanks or fraction. */
bool cli_number_from(const char *text, uint64_t *value);

/* Splits KEY=VALUE of --set; the key is copied. CLI_DONE, or CLI_BAD after a message. */
int cli_split_setting(const cli_command *command, const char *text, char *key, size_t size, const char **value);

/* For the option --simd; NULL keeps the fastest variant. */
int cli_use_simd(const char *name);

/* ---- Files ---- */

bool cli_exists(const char *path);
bool cli_same_file(const char *a, const char *b);
/* Refuses, before any work is done, an output that exists (without force) or has no folder. CLI_DONE: go on.
 */
int cli_check_output(const char *path, bool force);
/* Refuses the name of a file to be written whose folder is not there or cannot be written to. */
int cli_check_folder(const char *path);
/* Refuses what cannot be opened for reading, and folders: bad input, where later failures are the system's.
 */
int cli_check_input(const char *path);
/* And that it is a file, as a recording must be. */
int cli_check_recording(const char *path);
/* Opens a recording and warns if it is truncated. CLI_DONE: it is open. */
int cli_open_recording(const char *path, rheo_recording **recording);

/* ---- Differences: what verify, diff and bless print ---- */

const char *cli_verdict_name(rheo_verdict verdict);
int cli_verdict_code(rheo_verdict verdict);
void cli_difference_json(cli_json *json, const char *key, const rheo_difference *difference);
/* Its members, into an object that has been begun. */
void cli_verification_json(cli_json *json, const rheo_verification *verification);
void cli_growth_text(const rheo_verification *verification);

/* A metric of the last step; 0 if the model does not have it. */
double cli_metric(const rheo_world *world, const char *name);
bool cli_has_metric(const rheo_world *world, const char *name);

/* ---- Time and progress ---- */

/* Seconds of a clock that only goes forward. */
double cli_now(void);

/* Messages that follow each other on one line of a terminal, or every few seconds on a line each elsewhere. */
typedef struct cli_progress {
    bool quiet, terminal, shown;
    double last; /* when something was said last */
} cli_progress;

bool cli_progress_due(const cli_progress *progress, double time);
void cli_progress_say(cli_progress *progress, double time, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* A terminal's line is cleared, so that what follows begins on an empty one. */
void cli_progress_end(cli_progress *progress);

/* ---- Numbers for people ---- */

/* "3 h 20 min", "4.2 s". */
void cli_duration(double seconds, char *text, size_t size);
/* "12.3 MB". */
void cli_bytes(double bytes, char *text, size_t size);

#endif
