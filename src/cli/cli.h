/* Shared by the commands: exit codes, messages, options, files, progress. */
#ifndef CLI_CLI_H
#define CLI_CLI_H

#include <stdarg.h>
#include <stdio.h>

#include "json/json_writer.h"
#include "rheolog/rheolog.h"

/* ---- Exit codes and messages ---- */

enum {
    CLI_DONE = 0,
    CLI_DIFFERS = 1,     /* differs, unhealthy, went bad */
    CLI_BAD = 2,         /* bad usage, bad input */
    CLI_SYSTEM = 3,      /* the system failed: disk, memory */
    CLI_INTERRUPTED = 4, /* ended by a signal; a run can be continued */
};

/* Prints "rheolog: ..." on standard error. Returns `code`, for `return cli_fail(...)`. */
int cli_fail(int code, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Prints the same without an exit code. */
void cli_warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* Puts a place in front of these messages, such as "look.txt, line 3: "; "": none. */
void cli_say_where(const char *place);
/* The last of these messages, without "rheolog: ". */
const char *cli_said(void);
/* What an exit code other than CLI_DIFFERS is called in JSON: "done", "refused", "interrupted" or "failed". */
const char *cli_status_name(int status);
/* The exit code for a result of the library. */
int cli_code(rheo_result result);
/* Prints the library's error message and returns the exit code. */
int cli_error(rheo_result result, const rheo_error *error);

/* Does the same for an error in a file that the library does not name. */
int cli_file_error(const char *path, rheo_result result, const rheo_error *error);

/* ---- Options ---- */

typedef enum cli_kind {
    CLI_FLAG,     /* bool */
    CLI_TEXT,     /* const char * */
    CLI_NUMBER,   /* cli_number */
    CLI_OPTIONAL, /* cli_number; 1 if no number follows */
    CLI_SIZE,     /* cli_number, bytes; with K, M, G or T */
    CLI_LIST,     /* cli_list; the option may be repeated */
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
    const char *argument; /* name in the help, such as "N"; NULL for a flag */
    cli_kind kind;
    void *target;
} cli_option;

typedef struct cli_command {
    const char *name;
    const char *help; /* text of help/NAME.txt */
    int (*run)(int argc, char **argv);
} cli_command;

#define CLI_COMMAND(name, purpose) extern const cli_command cli_##name;
#include "cli/commands.def"
#undef CLI_COMMAND

/* The compiler of this build, as "gcc 12.2.0", and its number type, "float" or "double". */
const char *cli_compiler(void);
const char *cli_real(void);
/* `rheolog --version`, with the arguments behind it. Returns an exit code. */
int cli_version(int argc, char **argv);

/* Result of cli_parse() when the command is to run. */
enum { CLI_GO_ON = -1 };

/*
 * Reads the options and moves the operands to argv[0 .. *argc-1]. Returns CLI_GO_ON, CLI_DONE after --help, or
 * CLI_BAD after a message.
 */
int cli_parse(const cli_command *command, const cli_option *options, int *argc, char **argv);
/* For the option --cost: what has been done so far. */
typedef struct cli_cost {
    rheo_work work;
    double seconds; /* of CPU time */
} cli_cost;
cli_cost cli_cost_now(void);
/* Says what has been done since then: "cost: 669 steps simulated, 2 states read, 4.1 s of CPU time". */
void cli_say_cost(cli_cost since);
/* Whether the option --quiet, which every command has, was given: no progress. */
bool cli_quiet(void);
/* Prints "rheolog COMMAND: message" and a reference to --help. Returns CLI_BAD. */
int cli_usage(const cli_command *command, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Writes `; did you mean "run"?`, or "" if the word is no misspelt form of `nearest`; returns `text`. */
enum { CLI_SUGGESTION = 128 };
const char *cli_did_you_mean(const char *word, const char *nearest, char text[CLI_SUGGESTION]);
/* Reads an integer >= 0 without sign, blanks or fraction. */
bool cli_number_from(const char *text, uint64_t *value);

/* Splits KEY=VALUE of --set and copies the key. Returns CLI_DONE, or CLI_BAD after a message. */
int cli_split_setting(const cli_command *command, const char *text, char *key, size_t size, const char **value);

/* Reads the rung of --at-least. Returns CLI_DONE, or CLI_BAD after a message. */
int cli_read_sameness(const cli_command *command, const char *text, rheo_sameness *sameness);

/* Selects the SIMD variant of the option --simd; NULL keeps the fastest one. */
int cli_use_simd(const char *name);

/* ---- Files ---- */

bool cli_exists(const char *path);
double cli_file_bytes(const char *path);
bool cli_same_file(const char *a, const char *b);
/* Refuses what rheo_output_check() refuses, and an output that has no folder or is a pipe. Call it before any work. */
int cli_check_output(const char *path, rheo_output_use use);
/* Refuses an output whose folder does not exist or is not writable. */
int cli_check_folder(const char *path);
/*
 * Writes a text file with a function, as rheo_export_bytes() does: beside it and renamed; a link stays. Returns an exit
 * code.
 */
int cli_write_file(const char *path, void (*put)(FILE *file, const void *data), const void *data);
/* Refuses a text file that exists, without --force, and one that is no regular file. Call it before any work. */
int cli_check_replaced(const char *path, bool force);
/* Writes a cell of CSV: in quotes if it has a comma, a quote or a line break. */
void cli_put_csv(FILE *file, const char *text);
/* Refuses an input that is a folder or cannot be opened, as bad input. A later read error is a system failure. */
int cli_check_input(const char *path);
/* Whether `path` is a file that can be read; pipes and devices are none. Writes the reason if not, as bad input. */
bool cli_is_file(const char *path, rheo_error *why);
/* Does the same, prints the reason and returns CLI_BAD. */
int cli_check_recording(const char *path);
/* Opens a recording, and warns if it is truncated or being written. CLI_DONE: it is open. */
int cli_open_recording(const char *path, rheo_recording **recording);
/* Refuses a step that the recording does not hold. `what` is the option, as "--step". */
int cli_check_step(const char *path, const rheo_recording *recording, const char *what, uint64_t step);
/* That warning. */
void cli_warn_incomplete(const char *path, const rheo_recording *recording);
/* How a recording ends: "complete", "failed", "being_written" or "truncated". */
const char *cli_ending(const rheo_recording *recording);
/* What there is of a recording without an end, and how to go on with it; "complete" of one with an end. */
void cli_completeness(const rheo_recording *recording, char *text, size_t size);
/* Whether `rheolog run --continue` goes on with a truncated recording, and what messages then add. */
bool cli_can_continue(const rheo_recording *recording);
#define CLI_CONTINUE "; the command that made it, with --continue, goes on from there"

/* ---- Differences: output of verify, diff and bless ---- */

const char *cli_verdict_name(rheo_verdict verdict);
void cli_difference_json(rheo__json *json, const char *key, const rheo_difference *difference);
/* Writes the members of a verification into the current object. */
void cli_verification_json(rheo__json *json, const rheo_verification *verification);
/* Writes which steps two recordings have. */
void cli_lengths_json(rheo__json *json, const rheo_verification *verification);
/* Makes the verdict "same" if two recordings differ in length only. */
void cli_accept_lengths(rheo_verification *verification);
void cli_growth_text(const rheo_verification *verification);
/* Prints the option of `inspect` for the particle of a difference, or for one of its spring, if both sides have it. */
void cli_print_particle(const rheo_difference *difference);

/* ---- Failures: output of info, inspect and doctor ---- */

/*
 * Writes a failure, or null if `failed` is false. `location_key` is the key of the kind of object. The message is
 * left out if it is NULL.
 */
void cli_failure_json(rheo__json *json, bool failed, const rheo_failure *failure, const char *location_key,
                      const char *message);

/* A metric of the last step; 0 if the model does not have it. */
double cli_metric(const rheo_world *world, const char *name);
bool cli_has_metric(const rheo_world *world, const char *name);

/* ---- Time and progress ---- */

/* Reads a monotonic clock, in seconds. */
double cli_now(void);
/* Processor time of the process, s: other processes on the machine change it less than the time on a clock. */
double cli_processor_time(void);

/*
 * Progress messages. They replace each other on one line of a terminal; elsewhere, a line is printed every few
 * seconds.
 */
typedef struct cli_progress {
    bool quiet, terminal, shown;
    double last; /* time of the last message */
} cli_progress;

/* On standard error, unless --quiet; `last` as if a message had come then, 0: the first one is due at once. */
cli_progress cli_progress_begin(double last);
bool cli_progress_due(const cli_progress *progress, double time);
void cli_progress_say(cli_progress *progress, double time, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Clears the line of the terminal. */
void cli_progress_end(cli_progress *progress);

/*
 * Shows the progress of the library's tasks that take longer than a second, unless --quiet is given; cli_parse() calls
 * it.
 */
void cli_watch(void);
/* Puts a name in front of these messages, such as that of the file; NULL: none. */
void cli_watch_name(const char *name);
/* Clears the line of the terminal. Call it before printing results of a task that may have ended early. */
void cli_watch_end(void);
/*
 * From now on, the first Ctrl-C, SIGTERM or SIGHUP makes the library's tasks end with RHEO_ERROR_STOPPED; the second
 * one, at least a second later, ends the program.
 */
void cli_watch_signals(void);
/*
 * For a prompt, before a line is read and before a command is run: forgets an earlier Ctrl-C, and watches for one only.
 * While a line is read, it ends the reading with EINTR; SIGTERM ends the program.
 */
void cli_watch_keyboard(bool reading);
/* From now on, a closed pipe on standard output or error does not end the program. */
void cli_outlive_readers(void);
/* From now on, a file that becomes larger than the limit of the process is an error of the disk and not a signal. */
void cli_refuse_large_files(void);
/* Whether one of these signals has come since then. */
bool cli_interrupted(void);

/* ---- Lines for people ---- */

/*
 * Width of the lines of a terminal: COLUMNS, else what the terminal says, else 80. 0 if `file` is no terminal: a
 * script reads whole lines.
 */
unsigned cli_width(FILE *file);
/* Prints like fprintf(), wrapped at that width. Lines that continue another begin with `indent` blanks. */
void cli_print(FILE *file, size_t indent, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* Does the same; the line already has `column` characters. */
void cli_vprint(FILE *file, size_t indent, size_t column, const char *format, va_list arguments);
/* Prints text wrapped at a width; 0: not at all. */
void cli_wrap(FILE *file, const char *text, size_t width, size_t indent, size_t column);

/* ---- Readable numbers ---- */

/* Writes a duration such as "3 h 20 min" or "4.2 s". */
void cli_duration(double seconds, char *text, size_t size);
/* Writes a size such as "12.3 MB". */
void cli_bytes(double bytes, char *text, size_t size);
/* The ending of a noun after a number: "%llu step%s". */
const char *cli_plural(uint64_t count);

#endif
