/* Runs another program, collects what it prints, and ends it if it takes too long. */
#define _POSIX_C_SOURCE 200809L
#include "cli/bench_child.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"

#ifdef __wasi__
bool cli_child_run(cli_child *child, const char *program, char *const *argv, double timeout)
{
    (void)argv;
    (void)timeout;
    *child = (cli_child){.program = program};
    snprintf(child->problem, sizeof child->problem, "cannot be run: WebAssembly has no processes");
    return false;
}

const char *cli_child_self(void)
{
    return NULL;
}
#else

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { MOST_OUTPUT = 1 << 24 };

/* ---- Interruption ---- */

static volatile sig_atomic_t running; /* process group of the child; 0: none */

/* The child has its own process group, which does not get the signals of the terminal. */
static void on_signal(int number)
{
    if (running)
        kill(-(pid_t)running, SIGKILL);
    signal(number, SIG_DFL);
    raise(number);
}

static void catch_signals(void)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction action, before;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        if (sigaction(signals[i], NULL, &before) == 0 && before.sa_handler == SIG_DFL)
            sigaction(signals[i], &action, NULL);
}

/* ---- Start ---- */

typedef struct pipes {
    int out[2], err[2];
} pipes;

static bool open_pipes(pipes *p)
{
    if (pipe(p->out) != 0)
        return false;
    if (pipe(p->err) != 0) {
        close(p->out[0]);
        close(p->out[1]);
        return false;
    }
    /* A second child must not hold the ends of the first one open. */
    const int ends[] = {p->out[0], p->out[1], p->err[0], p->err[1]};
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        fcntl(ends[i], F_SETFD, FD_CLOEXEC);
    return true;
}

static int start(const char *program, char *const *argv, const pipes *p, pid_t *pid)
{
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, p->out[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&files, p->err[1], STDERR_FILENO);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    const int result = posix_spawnp(pid, program, &files, &attributes, argv, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    return result;
}

/* ---- Output ---- */

/* Text read from a pipe. If it is too long, the rest is read but not kept. */
typedef struct text {
    char *bytes; /* ends with 0 */
    size_t size, room, most;
    bool ended, too_long;
} text;

static bool take(text *t, int pipe)
{
    char piece[1 << 12];
    const ssize_t got = read(pipe, piece, sizeof piece);
    if (got <= 0) {
        t->ended = got == 0 || errno != EINTR;
        return true;
    }
    size_t keep = (size_t)got;
    if (keep > t->most - t->size) {
        keep = t->most - t->size;
        t->too_long = true;
    }
    if (t->size + keep + 1 > t->room) {
        const size_t room = 2 * (t->size + keep + 1);
        char *bytes = realloc(t->bytes, room);
        if (!bytes)
            return false;
        t->bytes = bytes;
        t->room = room;
    }
    memcpy(t->bytes + t->size, piece, keep);
    t->size += keep;
    t->bytes[t->size] = 0;
    return true;
}

/* Reads both pipes until they end. Returns NULL, or what went wrong. */
static const char *listen_to(const pipes *p, text *out, text *err, double deadline)
{
    while (!out->ended || !err->ended) {
        const double left = deadline - cli_now();
        if (left <= 0)
            return "late";
        struct pollfd ends[2] = {{out->ended ? -1 : p->out[0], POLLIN, 0}, {err->ended ? -1 : p->err[0], POLLIN, 0}};
        const int ready = poll(ends, 2, left > 1e5 ? -1 : (int)ceil(1e3 * left));
        if (ready < 0 && errno != EINTR)
            return strerror(errno);
        if ((ready > 0 && ends[0].revents && !take(out, p->out[0])) ||
            (ready > 0 && ends[1].revents && !take(err, p->err[0])))
            return "there is no memory for what it prints";
    }
    return NULL;
}

/* ---- End ---- */

/* A program may close its output and go on; it has the rest of its time to end. */
static bool wait_for(pid_t pid, int *status, double deadline)
{
    for (;;) {
        const pid_t ended = waitpid(pid, status, isinf(deadline) ? 0 : WNOHANG);
        if (ended == pid)
            return true;
        if (ended < 0 && errno != EINTR)
            return false;
        if (ended == 0 && cli_now() >= deadline)
            return false;
        if (ended == 0)
            poll(NULL, 0, 1);
    }
}

static void describe_end(cli_child *child, int status)
{
    if (WIFSIGNALED(status)) {
        snprintf(child->problem, sizeof child->problem, "was ended by signal %d (%s)", WTERMSIG(status),
                 strsignal(WTERMSIG(status)));
        return;
    }
    child->code = WEXITSTATUS(status);
    if (child->code)
        snprintf(child->problem, sizeof child->problem, "ended with exit code %d%s%s", child->code,
                 child->first_error[0] ? ": " : " and no message", child->first_error);
}

bool cli_child_run(cli_child *child, const char *program, char *const *argv, double timeout)
{
    *child = (cli_child){.program = program, .code = -1};
    pipes p;
    pid_t pid;
    catch_signals();
    if (!open_pipes(&p)) {
        snprintf(child->problem, sizeof child->problem, "cannot be run: %s", strerror(errno));
        return false;
    }
    const int failure = start(program, argv, &p, &pid);
    running = failure ? 0 : (sig_atomic_t)pid;
    close(p.out[1]);
    close(p.err[1]);
    if (failure)
        snprintf(child->problem, sizeof child->problem, "cannot be run: %s", strerror(failure));
    text out = {.most = MOST_OUTPUT}, err = {.most = sizeof child->first_error - 1};
    if (!failure) {
        const double deadline = timeout > 0 ? cli_now() + timeout : INFINITY;
        const char *problem = listen_to(&p, &out, &err, deadline);
        int status = 0;
        if (err.bytes)
            snprintf(child->first_error, sizeof child->first_error, "%.*s", (int)strcspn(err.bytes, "\n"), err.bytes);
        bool ended = !problem && wait_for(pid, &status, deadline);
        if (!ended) {
            kill(-pid, SIGKILL);
            (void)wait_for(pid, &status, INFINITY);
        }
        running = 0;
        if (!ended && (!problem || strcmp(problem, "late") == 0))
            snprintf(child->problem, sizeof child->problem, "did not end within %g s", timeout);
        else if (problem)
            snprintf(child->problem, sizeof child->problem, "could not be read: %s", problem);
        else if (out.too_long)
            snprintf(child->problem, sizeof child->problem, "prints more than %d bytes", MOST_OUTPUT);
        else
            describe_end(child, status);
    }
    close(p.out[0]);
    close(p.err[0]);
    free(err.bytes);
    child->out = out.bytes ? out.bytes : calloc(1, 1);
    if (!child->out && !child->problem[0])
        snprintf(child->problem, sizeof child->problem, "could not be read: there is no memory");
    return !child->problem[0];
}

const char *cli_child_self(void)
{
    static char path[48];
    snprintf(path, sizeof path, "/proc/%ld/exe", (long)getpid());
    return access(path, X_OK) == 0 ? path : NULL;
}

#endif
