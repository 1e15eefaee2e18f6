/* Shows the progress of the library's tasks on standard error, and stops them on Ctrl-C. */
#define _POSIX_C_SOURCE 200809L
#include <string.h>
#include <time.h>
#include <unistd.h>
#ifndef __wasi__
#include <signal.h>
#endif

#include "cli/cli.h"

static struct {
    cli_progress progress;
    double begun;      /* time at which the command began */
    const char *name;  /* in front of messages; NULL: none */
    const char *task;  /* NULL: none yet */
    uint64_t total;    /* of the task */
    uint64_t done;     /* last report */
    double start;      /* time of its first report */
    uint64_t at_start; /* steps that were done then */
} watch;

#ifdef __wasi__
/* WebAssembly has no signals. */
enum { interrupted = 0 };

void cli_watch_signals(void)
{
}

void cli_watch_keyboard(bool reading)
{
    (void)reading;
}

void cli_outlive_readers(void)
{
}

void cli_refuse_large_files(void)
{
}
#else
static volatile sig_atomic_t interrupted;
static struct timespec first_signal;

/*
 * The second signal ends the program. One that comes within a second is the same request: timeout(1) sends its signal to
 * the program and again to its group.
 */
static void on_signal(int number)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (!interrupted) {
        first_signal = now;
        interrupted = 1;
    } else if ((double)(now.tv_sec - first_signal.tv_sec) + 1e-9 * (double)(now.tv_nsec - first_signal.tv_nsec) >=
               1) {
        signal(number, SIG_DFL);
        raise(number);
    }
}

void cli_outlive_readers(void)
{
    signal(SIGPIPE, SIG_IGN);
}

void cli_refuse_large_files(void)
{
#ifdef SIGXFSZ
    signal(SIGXFSZ, SIG_IGN);
#endif
}

static void watch_signal(int number, int flags)
{
    struct sigaction action, before;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    sigaddset(&action.sa_mask, SIGINT); /* so that a handler finds the time of the first signal */
    sigaddset(&action.sa_mask, SIGTERM);
    sigaddset(&action.sa_mask, SIGHUP);
    action.sa_flags = flags;
    /* A background job may have been started with these signals ignored; they stay ignored then. */
    if (sigaction(number, NULL, &before) == 0 && before.sa_handler != SIG_IGN)
        sigaction(number, &action, NULL);
}

void cli_watch_signals(void)
{
    const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        watch_signal(signals[i], SA_RESTART); /* stdio would lose what it writes to a full pipe */
}

void cli_watch_keyboard(bool reading)
{
    interrupted = 0;
    watch_signal(SIGINT, reading ? 0 : SA_RESTART);
}
#endif

bool cli_interrupted(void)
{
    return interrupted;
}

static void show(const char *task, uint64_t done, uint64_t total, double time)
{
    char left[64] = "";
    if (done > watch.at_start) {
        strcpy(left, ", ");
        cli_duration((time - watch.start) / (double)(done - watch.at_start) * (double)(total - done), left + 2, 32);
        strcat(left, " left");
    }
    cli_progress_say(&watch.progress, time, "%s%s%s, step %llu of %llu%s", watch.name ? watch.name : "",
                     watch.name ? ": " : "", task, (unsigned long long)done, (unsigned long long)total, left);
}

static bool report(const char *task, uint64_t done, uint64_t total, void *user)
{
    (void)user;
    const double time = cli_now();
    if (!watch.task || strcmp(task, watch.task) != 0 || total != watch.total || done <= watch.done) {
        watch.start = time;
        watch.at_start = done;
    }
    watch.task = task;
    watch.total = total;
    watch.done = done;
    if (done == total || interrupted)
        cli_progress_end(&watch.progress);
    else if (time - watch.begun > 1 && cli_progress_due(&watch.progress, time))
        show(task, done, total, time);
    return !interrupted;
}

void cli_watch(void)
{
    watch.begun = cli_now();
    watch.progress = cli_progress_begin(watch.begun);
    rheo_use_progress((rheo_progress){report, NULL});
}

void cli_watch_name(const char *name)
{
    watch.name = name;
}

void cli_watch_end(void)
{
    cli_progress_end(&watch.progress);
}

cli_cost cli_cost_now(void)
{
    return (cli_cost){rheo_work_done(), cli_processor_time()};
}

void cli_say_cost(cli_cost since)
{
    const cli_cost now = cli_cost_now();
    const unsigned long long steps = now.work.steps - since.work.steps, states = now.work.states - since.work.states;
    char seconds[32];
    rheo_number_brief(now.seconds - since.seconds, 2, seconds);
    fflush(stdout);
    fprintf(stderr, "cost: %llu step%s simulated, %llu state%s read, %s s of CPU time\n", steps, cli_plural(steps),
            states, cli_plural(states), seconds);
}
