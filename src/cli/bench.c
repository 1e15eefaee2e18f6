/*
 * rheolog bench: measures the cost of a step. Each measurement has its own file, which lists its cases
 * (bench_cases.c) and prints them as text. bench_report.c prints them as CSV or JSON, one line per case.
 * bench_compare.c compares the measurements of two programs.
 */
#define _POSIX_C_SOURCE 200809L
#include "cli/bench.h"

#include <string.h>
#include <unistd.h>

enum { POOL = 20000, FEWEST = 200, MOST = 100000000, ROUNDS = 5, SCENES = 300, SMALL_POOL = 1536 };

/* Options that only some measurements take. */
enum {
    WINDOWS = 1,
    PARTICLES = 2,
    SCHEME = 4,
    NAMES = 8, /* --scenes */
    OUTPUT = 16,
    BASELINE = 32,
    REPETITIONS = 64,
    ERROR = 128,     /* --model and --study */
    PREDICTOR = 256, /* --count and --seed */
    TRACE = 1024,    /* --trace */
    STABILITY = 512, /* --solvers, --step-sizes, --ratios, --stiffness */
    TIMES = PARTICLES | SCHEME | BASELINE | REPETITIONS,
};

typedef struct measurement {
    const char *name;
    uint64_t steps, particles; /* defaults */
    uint64_t repetitions;      /* default */
    const char *windows;       /* default of --windows; NULL: the measurement has none */
    unsigned options;
    int (*run)(cli_bench_arguments *a);
} measurement;

static const measurement MEASUREMENTS[] = {
    {"table1", 300, POOL, 5, "0,50,150,500", TIMES | TRACE | WINDOWS, cli_bench_run_table1},
    {"history", 96, POOL, 5, "50,150,500,1000", TIMES | TRACE | WINDOWS, cli_bench_run_history},
    {"scaling", 30, 2000000, 5, NULL, TIMES | TRACE, cli_bench_run_scaling},
    {"features", 96, POOL, 5, NULL, TIMES | TRACE, cli_bench_run_features},
    {"limits", 300, POOL, 5, NULL, TIMES | TRACE, cli_bench_run_limits},
    {"table2", 10, 0, 5, NULL, (TIMES & ~SCHEME) | TRACE, cli_bench_run_table2},
    {"error", 0, 0, 1, NULL, (TIMES & ~SCHEME) | NAMES | OUTPUT | ERROR, cli_bench_run_error},
    {"scenes", 0, 0, 5, NULL, (TIMES & ~PARTICLES) | NAMES | TRACE, cli_bench_run_scenes},
    {"stability", 150, SMALL_POOL, 1, NULL, PARTICLES | OUTPUT | STABILITY, cli_bench_run_stability},
    {"predictor", 0, 0, 1, NULL, OUTPUT | PREDICTOR, cli_bench_run_predictor},
};
enum { COUNT = sizeof MEASUREMENTS / sizeof *MEASUREMENTS };

static const measurement *find(const char *name)
{
    for (size_t i = 0; i < COUNT; i++)
        if (strcmp(MEASUREMENTS[i].name, name) == 0)
            return &MEASUREMENTS[i];
    return NULL;
}

/* "0,50,150" */
static int read_windows(const char *text, cli_bench_arguments *a)
{
    enum { MOST_WINDOWS = sizeof a->window / sizeof *a->window, LARGEST = 1000000 };
    a->windows = 0;
    for (const char *at = text;; at++) {
        char word[16];
        const size_t length = strcspn(at, ",");
        uint64_t value = 0;
        snprintf(word, sizeof word, "%.*s", (int)(length < sizeof word ? length : sizeof word - 1), at);
        if (length >= sizeof word || !cli_number_from(word, &value) || value > LARGEST)
            return cli_usage(&cli_bench,
                             "--windows needs numbers of steps up to %d with commas between, e.g. 0,50; got \"%s\"",
                             LARGEST, text);
        if (a->windows == MOST_WINDOWS)
            return cli_usage(&cli_bench, "--windows has more than %d windows", MOST_WINDOWS);
        a->window[a->windows++] = (uint32_t)value;
        at += length;
        if (!*at)
            return CLI_DONE;
    }
}

/* The names of the scenes must exist. */
static int check_scenes(const cli_bench_arguments *a)
{
    char name[48];
    uint64_t steps;
    if (!cli_bench_next_scene(a, 0, name, &steps))
        return cli_usage(&cli_bench, "--scenes needs names of scenes with commas between, e.g. vibration,chair");
    for (uint32_t i = 0; cli_bench_next_scene(a, i, name, &steps); i++) {
        rheo_error error = {""};
        rheo_scene scene;
        const rheo_result result = rheo_scene_builtin(name, &scene, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
        rheo_scene_release(&scene);
    }
    return CLI_DONE;
}

static int check(const cli_bench_arguments *a, const measurement *m, bool steps_given)
{
    if (a->repetitions < 1 || a->repetitions > CLI_BENCH_MAX_REPETITIONS)
        return cli_usage(&cli_bench, "--repetitions must be from 1 to %d", CLI_BENCH_MAX_REPETITIONS);
    if (a->steps < 1 && (steps_given || m->steps))
        return cli_usage(&cli_bench, "--steps must be at least 1: nothing would be timed");
    if (a->particles && (a->particles < FEWEST || a->particles > MOST))
        return cli_usage(&cli_bench, "--particles must be from %d to %d; the ball needs a pool", FEWEST, MOST);
    rheo_world_def def = rheo_default_world_def();
    rheo_error error = {""};
    if (a->scheme && rheo_world_def_set(&def, "scheme", a->scheme, &error) != RHEO_OK)
        return cli_error(RHEO_ERROR_ARGUMENT, &error);
    if (a->rounds < 1 || a->rounds > CLI_BENCH_MAX_REPETITIONS)
        return cli_usage(&cli_bench, "--rounds must be from 1 to %d", CLI_BENCH_MAX_REPETITIONS);
    return m->run == cli_bench_run_scenes ? check_scenes(a) : CLI_DONE;
}

/* The measurements that take an option, as "table1, history and error"; all: those that there are. */
static const char *takers(unsigned option, bool all, char text[256])
{
    size_t left = 0;
    *text = 0;
    for (size_t i = 0; i < COUNT; i++)
        left += all || MEASUREMENTS[i].options & option;
    for (size_t i = 0; i < COUNT; i++)
        if (all || MEASUREMENTS[i].options & option) {
            const size_t length = strlen(text);
            snprintf(text + length, 256 - length, "%s%s", MEASUREMENTS[i].name,
                     --left > 1  ? ", "
                     : left == 1 ? " and "
                                 : "");
        }
    return text;
}

/* Refuses an option that the measurement does not take. */
static int check_option(const measurement *m, const char *option, unsigned group, bool given)
{
    char names[256];
    takers(group, false, names);
    return !given || m->options & group ? CLI_DONE
                                        : cli_usage(&cli_bench, "%s takes no %s; %s %s", m->name, option, names,
                                                    strchr(names, ' ') ? "do" : "does");
}

typedef struct given_option {
    unsigned group;
    const char *name;
    bool given;
} given_option;

static int check_options(const cli_bench_arguments *a, const measurement *m, const given_option *option, size_t count)
{
    int status = CLI_DONE;
    if (a->csv && a->json)
        return cli_usage(&cli_bench, "prints --csv or --json, not both");
    for (size_t i = 0; i < count && status == CLI_DONE; i++)
        status = check_option(m, option[i].name, option[i].group, option[i].given);
    if (status == CLI_DONE && a->trace && a->baseline)
        status = cli_usage(&cli_bench, "--trace shows the steps of this program; it does not go with --baseline");
    if (status == CLI_DONE && a->trace && !*a->trace)
        status = cli_usage(&cli_bench, "--trace needs the name of a file");
    if (status == CLI_DONE && a->trace && (status = cli_check_replaced(a->trace, true)) == CLI_DONE)
        status = cli_check_folder(a->trace);
    if (status == CLI_DONE && a->folder && a->baseline)
        status = cli_usage(&cli_bench, "--output writes no comparison; print it with --csv");
    return status;
}

static int run(int argc, char **argv)
{
    cli_bench_arguments a = {0};
    cli_number repetitions = {false, 0}, steps = {false, 0}, particles = {false, 0}, rounds = {false, ROUNDS};
    cli_number timeout = {false, 0}, seed = {false, 1}, scenes = {false, SCENES};
    const char *windows = NULL;
    const cli_option options[] = {
        {"--repetitions", NULL, "N", CLI_NUMBER, &repetitions},
        {"--steps", NULL, "N", CLI_NUMBER, &steps},
        {"--particles", NULL, "N", CLI_NUMBER, &particles},
        {"--windows", NULL, "D,D,...", CLI_TEXT, &windows},
        {"--model", NULL, "NAME", CLI_TEXT, &a.model},
        {"--study", NULL, "NAME,NAME,...", CLI_TEXT, &a.studies},
        {"--output", "-o", "FOLDER", CLI_TEXT, &a.folder},
        {"--trace", NULL, "FILE", CLI_TEXT, &a.trace},
        {"--scheme", NULL, "NAME", CLI_TEXT, &a.scheme},
        {"--scenes", NULL, "NAME,NAME,...", CLI_TEXT, &a.scenes},
        {"--count", NULL, "N", CLI_NUMBER, &scenes},
        {"--seed", NULL, "N", CLI_NUMBER, &seed},
        {"--solvers", NULL, "NAME,NAME,...", CLI_TEXT, &a.solvers},
        {"--step-sizes", NULL, "S,S,...", CLI_TEXT, &a.step_sizes},
        {"--ratios", NULL, "R,R,...", CLI_TEXT, &a.ratios},
        {"--stiffness", NULL, "K", CLI_TEXT, &a.stiffness},
        {"--settle", NULL, "N", CLI_NUMBER, &a.settle},
        {"--simd", NULL, "NAME", CLI_TEXT, &a.simd},
        {"--baseline", NULL, "PROGRAM", CLI_TEXT, &a.baseline},
        {"--rounds", NULL, "N", CLI_NUMBER, &rounds},
        {"--timeout", NULL, "SECONDS", CLI_NUMBER, &timeout},
        {"--csv", NULL, NULL, CLI_FLAG, &a.csv},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},
        {0},
    };
    int status = cli_parse(&cli_bench, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    char names[256];
    takers(0, true, names);
    if (argc == 0)
        return cli_usage(&cli_bench, "needs a measurement: %s", names);
    const measurement *m = find(argv[0]);
    if (!m)
        return cli_usage(&cli_bench, "there is no measurement \"%s\"; there are %s", argv[0], names);
    if (argc > 1)
        return cli_usage(&cli_bench, "makes one measurement at a time; got \"%s\" as well", argv[1]);
    if ((rounds.given || timeout.given) && !a.baseline)
        return cli_usage(&cli_bench, "%s needs --baseline PROGRAM", rounds.given ? "--rounds" : "--timeout");
    if (a.baseline && repetitions.given && m->run == cli_bench_run_scenes)
        return cli_usage(&cli_bench, "scenes has one repetition per round with --baseline; use --rounds");
    if (timeout.given && !timeout.value)
        return cli_usage(&cli_bench, "--timeout must be at least 1");
    const given_option given[] = {
        {WINDOWS, "--windows", windows != NULL},      {ERROR, "--model", a.model != NULL},
        {ERROR, "--study", a.studies != NULL},        {OUTPUT, "--output", a.folder != NULL},
        {TRACE, "--trace", a.trace != NULL},          {SCHEME, "--scheme", a.scheme != NULL},
        {NAMES, "--scenes", a.scenes != NULL},        {PARTICLES, "--particles", particles.given},
        {BASELINE, "--baseline", a.baseline != NULL}, {REPETITIONS, "--repetitions", repetitions.given},
        {PREDICTOR, "--count", scenes.given},         {PREDICTOR, "--seed", seed.given},
        {STABILITY, "--solvers", a.solvers != NULL},  {STABILITY, "--step-sizes", a.step_sizes != NULL},
        {STABILITY, "--ratios", a.ratios != NULL},    {STABILITY, "--stiffness", a.stiffness != NULL}};
    if ((status = check_options(&a, m, given, sizeof given / sizeof *given)) != CLI_DONE)
        return status;
    a.seed = seed.value;
    a.scene_count = scenes.value;
    a.steps = steps.given ? steps.value : m->steps;
    a.particles = particles.given ? particles.value : m->particles;
    const uint64_t times = repetitions.given ? repetitions.value : a.baseline ? 1 : m->repetitions;
    a.repetitions = times < UINT32_MAX ? (uint32_t)times : UINT32_MAX;
    a.rounds = rounds.value < UINT32_MAX ? (uint32_t)rounds.value : UINT32_MAX;
    a.timeout = timeout.value;
    a.measurement = m->name;
    a.window_list = windows ? windows : m->windows;
    if ((status = check(&a, m, steps.given)) != CLI_DONE)
        return status;
    if (m->windows && (status = read_windows(a.window_list, &a)) != CLI_DONE)
        return status;
    if ((status = cli_use_simd(a.simd)) != CLI_DONE)
        return status;
    a.progress = cli_progress_begin(0);
    return a.baseline ? cli_bench_compare(&a) : m->run(&a);
}

static const char help[] = {
#include "cli/help/bench.txt.inc"
    0};

const cli_command cli_bench = {"bench", help, run};
