/* Messages, exit codes, files, metrics, progress, and readable numbers. */
#define _XOPEN_SOURCE 700 /* realpath() */
#define _FILE_OFFSET_BITS 64
#include "cli/cli.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static char said[1024];
static const char *where = "";

void cli_say_where(const char *place)
{
    where = place;
}

const char *cli_said(void)
{
    return said;
}

static void say(const char *format, va_list arguments)
{
    cli_watch_end();
    vsnprintf(said, sizeof said, format, arguments);
    const int column = fprintf(stderr, "rheolog: %s", where);
    cli_wrap(stderr, said, cli_width(stderr), 4, (size_t)column);
    fputc('\n', stderr);
}

int cli_usage(const cli_command *command, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(said, sizeof said, format, arguments);
    va_end(arguments);
    cli_print(stderr, 4, "rheolog %s: %s (see `rheolog %s --help`)\n", command->name, said, command->name);
    return CLI_BAD;
}

int cli_fail(int code, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    say(format, arguments);
    va_end(arguments);
    return code;
}

void cli_warn(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    say(format, arguments);
    va_end(arguments);
}

const char *cli_status_name(int status)
{
    return status == CLI_DONE          ? "done"
           : status == CLI_BAD         ? "refused"
           : status == CLI_INTERRUPTED ? "interrupted"
                                       : "failed";
}

int cli_code(rheo_result result)
{
    switch (result) {
    case RHEO_OK:
        return CLI_DONE;
    case RHEO_ERROR_STATE:
    case RHEO_ERROR_DIFFERS:
    case RHEO_ERROR_LIMIT:
        return CLI_DIFFERS;
    case RHEO_ERROR_ARGUMENT:
    case RHEO_ERROR_FORMAT:
    case RHEO_ERROR_UNSUPPORTED:
        return CLI_BAD;
    case RHEO_ERROR_MEMORY:
    case RHEO_ERROR_FILE:
    case RHEO_ERROR_ENVIRONMENT:
        return CLI_SYSTEM;
    case RHEO_ERROR_STOPPED:
        return CLI_INTERRUPTED;
    }
    return CLI_SYSTEM;
}

int cli_error(rheo_result result, const rheo_error *error)
{
    return cli_fail(cli_code(result), "%s", error->message[0] ? error->message : rheo_result_name(result));
}

int cli_file_error(const char *path, rheo_result result, const rheo_error *error)
{
    return cli_fail(cli_code(result), "%s: %s", path, error->message[0] ? error->message : rheo_result_name(result));
}

int cli_use_simd(const char *name)
{
    rheo_error error = {""};
    const rheo_result result = name ? rheo_use_simd(name, &error) : RHEO_OK;
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

/* `status` is zeroed because the memory sanitizer of clang does not know that stat64() writes it. */
bool cli_exists(const char *path)
{
    struct stat status = {0};
    return stat(path, &status) == 0;
}

double cli_file_bytes(const char *path)
{
    struct stat status = {0};
    return stat(path, &status) == 0 ? (double)status.st_size : 0;
}

bool cli_same_file(const char *a, const char *b)
{
    struct stat of_a = {0}, of_b = {0};
    return stat(a, &of_a) == 0 && stat(b, &of_b) == 0 && of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
}

int cli_check_output(const char *path, rheo_output_use use)
{
    struct stat file = {0};
    rheo_error error = {""};
    if (!*path)
        return cli_fail(CLI_BAD, "-o needs the name of a file; got an empty one");
    if (strcmp(path, "-") == 0)
        return cli_fail(CLI_BAD, "-o writes a file and not to standard output; got \"-\"");
    if (stat(path, &file) == 0 && (S_ISFIFO(file.st_mode) || S_ISSOCK(file.st_mode)))
        return cli_fail(CLI_BAD, "%s is a pipe; -o needs the name of a file", path);
    const rheo_result result = rheo_output_check(path, use, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    return file.st_mode == 0 || S_ISREG(file.st_mode) ? cli_check_folder(path) : CLI_DONE; /* a device is there */
}

static int check_folder_of(const char *path)
{
    struct stat status = {0};
    const char *slash = strrchr(path, '/');
    char folder[4096] = ".";
    const size_t length = slash && slash > path ? (size_t)(slash - path) : 1, name = strlen(slash ? slash + 1 : path);
    if (length >= sizeof folder || name > 200) /* the name of the temporary file is longer */
        return cli_fail(CLI_BAD, "the name after -o is too long: %zu bytes", strlen(path));
    if (slash)
        memcpy(folder, path, length);
    folder[length] = 0;
    if (stat(folder, &status) != 0 || !S_ISDIR(status.st_mode))
        return cli_fail(CLI_BAD, "cannot write %s: there is no folder %s", path, folder);
    if (access(folder, W_OK) != 0)
        return cli_fail(CLI_BAD, "cannot write %s: %s: %s", path, folder, strerror(errno));
    return CLI_DONE;
}

int cli_check_folder(const char *path)
{
#ifdef __wasi__ /* it cannot resolve links */
    char *target = NULL;
#else
    char *target = realpath(path, NULL); /* of a link, the folder that is written to */
#endif
    const int status = check_folder_of(target ? target : path);
    free(target);
    return status;
}

int cli_write_file(const char *path, void (*put)(FILE *file, const void *data), const void *data)
{
    char *text = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&text, &size);
    if (memory)
        put(memory, data);
    if (!memory || ferror(memory) || fclose(memory) != 0)
        return cli_fail(CLI_SYSTEM, "no memory to write %s", path);
    rheo_error error = {""};
    const rheo_result result = rheo_export_bytes(path, text, size, true, &error);
    free(text);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

int cli_check_replaced(const char *path, bool force)
{
    struct stat status = {0};
    const bool exists = lstat(path, &status) == 0;
    if (exists && !S_ISREG(status.st_mode))
        return cli_fail(CLI_BAD, "%s is no regular file, so it cannot be replaced; give another name", path);
    if (exists && !force)
        return cli_fail(CLI_BAD, "%s exists; give --force to replace it, or another name", path);
    return cli_check_folder(path);
}

void cli_put_csv(FILE *file, const char *text)
{
    if (!text[strcspn(text, ",\"\r\n")]) {
        fputs(text, file);
        return;
    }
    fputc('"', file);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', file);
        fputc(*text, file);
    }
    fputc('"', file);
}

/* Whether `path` can be read as a file of any kind. */
static bool is_readable(const char *path, struct stat *status, rheo_error *why)
{
    const char *reason = NULL;
    if (stat(path, status) != 0 || access(path, R_OK) != 0)
        reason = strerror(errno);
    else if (S_ISDIR(status->st_mode))
        reason = "it is a folder, not a file";
    if (reason)
        snprintf(why->message, sizeof why->message, "cannot read %.400s: %s", path, reason);
    return !reason;
}

int cli_check_input(const char *path)
{
    struct stat status = {0};
    rheo_error why;
    return is_readable(path, &status, &why) ? CLI_DONE : cli_fail(CLI_BAD, "%s", why.message);
}

bool cli_is_file(const char *path, rheo_error *why)
{
    struct stat status = {0};
    if (!is_readable(path, &status, why))
        return false;
    if (!S_ISREG(status.st_mode))
        snprintf(why->message, sizeof why->message,
                 "cannot read %.400s: a recording is read from a file, not from a pipe or device", path);
    return S_ISREG(status.st_mode);
}

int cli_check_recording(const char *path)
{
    rheo_error why;
    return cli_is_file(path, &why) ? CLI_DONE : cli_fail(CLI_BAD, "%s", why.message);
}

int cli_open_recording(const char *path, rheo_recording **recording)
{
    const int status = cli_check_recording(path);
    if (status != CLI_DONE)
        return status;
    rheo_error error = {""};
    const rheo_result result = rheo_recording_open(path, recording, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    if (!rheo_recording_get_info(*recording).complete)
        cli_warn_incomplete(path, *recording);
    return CLI_DONE;
}

int cli_check_step(const char *path, const rheo_recording *recording, const char *what, uint64_t step)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    if (step >= info.first_step && step <= info.last_step)
        return CLI_DONE;
    return cli_fail(CLI_BAD, "%s holds steps %llu to %llu; %s %llu is none of them", path,
                    (unsigned long long)info.first_step, (unsigned long long)info.last_step, what,
                    (unsigned long long)step);
}

bool cli_can_continue(const rheo_recording *recording)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    return !info.complete && !info.being_written && info.made_by[0] && !info.blessed;
}

const char *cli_ending(const rheo_recording *recording)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    rheo_failure failure;
    return rheo_recording_failure(recording, &failure) ? "failed"
           : info.complete                             ? "complete"
           : info.being_written                        ? "being_written"
                                                       : "truncated";
}

void cli_completeness(const rheo_recording *recording, char *text, size_t size)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    const uint64_t steps = info.last_step - info.first_step;
    if (info.complete)
        snprintf(text, size, "complete");
    else if (info.being_written)
        snprintf(text, size, "being written: %llu step%s so far", (unsigned long long)steps, cli_plural(steps));
    else
        snprintf(text, size, "truncated after step %llu: it has no end mark%s", (unsigned long long)info.last_step,
                 cli_can_continue(recording) ? CLI_CONTINUE : "");
}

void cli_warn_incomplete(const char *path, const rheo_recording *recording)
{
    char text[256];
    cli_completeness(recording, text, sizeof text);
    cli_warn("%s is %s", path, text);
}

static uint32_t metric_index(const rheo_world *world, const char *name)
{
    uint32_t i = 0;
    while (i < rheo_world_metric_count(world) && strcmp(rheo_world_metric_name(world, i), name) != 0)
        i++;
    return i;
}

bool cli_has_metric(const rheo_world *world, const char *name)
{
    return metric_index(world, name) < rheo_world_metric_count(world);
}

double cli_metric(const rheo_world *world, const char *name)
{
    return rheo_world_metric(world, metric_index(world, name));
}

double cli_now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

double cli_processor_time(void)
{
#ifdef CLOCK_PROCESS_CPUTIME_ID
    struct timespec time;
    if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time) == 0)
        return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
#endif
    return cli_now();
}

cli_progress cli_progress_begin(double last)
{
    return (cli_progress){.quiet = cli_quiet(), .terminal = isatty(STDERR_FILENO) == 1, .last = last};
}

bool cli_progress_due(const cli_progress *p, double time)
{
    return !p->quiet && time - p->last >= (p->terminal ? .2 : 5);
}

void cli_progress_say(cli_progress *p, double time, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs(p->terminal ? "\r\033[K" : "", stderr);
    vfprintf(stderr, format, arguments);
    fputs(p->terminal ? "" : "\n", stderr);
    fflush(stderr);
    va_end(arguments);
    p->last = time;
    p->shown = true;
}

void cli_progress_end(cli_progress *p)
{
    if (p->terminal && p->shown)
        fputs("\r\033[K", stderr);
    p->shown = false;
}

void cli_duration(double seconds, char *text, size_t size)
{
    if (seconds < 60) {
        snprintf(text, size, "%.1f s", seconds);
        return;
    }
    const double capped = seconds < 1e15 ? seconds : 1e15;
    const unsigned long long whole = (unsigned long long)(capped + .5);
    if (whole < 3600)
        snprintf(text, size, "%llu min %llu s", whole / 60, whole % 60);
    else
        snprintf(text, size, "%llu h %llu min", whole / 3600, whole % 3600 / 60);
}

void cli_bytes(double bytes, char *text, size_t size)
{
    static const char *const units[] = {"bytes", "kB", "MB", "GB", "TB"};
    size_t unit = 0;
    for (; bytes >= 1000 && unit < 4; unit++)
        bytes /= 1000;
    snprintf(text, size, unit ? "%.1f %s" : "%.0f %s", bytes, units[unit]);
}

const char *cli_plural(uint64_t count)
{
    return count == 1 ? "" : "s";
}

const char *cli_compiler(void)
{
    static char name[96];
    const char *build = strchr(rheo_build(), ',') + 2;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(build, ","), build);
    return name;
}

const char *cli_real(void)
{
    return sizeof(rheo_real) == 8 ? "double" : "float";
}
