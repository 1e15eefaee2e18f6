/*
 * rheolog bench --baseline: makes a measurement with this program and with another build of rheolog in turn, each as
 * a process of its own on the same core, and compares them. Other load on a machine changes within minutes, so only
 * times that are measured side by side can be compared; each round has one measurement of each program, and the
 * programs take turns to be first.
 *
 * The baseline may be older: it may have other stages, cases and names of options. What both have is compared, and
 * what only one has is listed.
 */
#include "cli/bench_child.h"
#include "cli/bench_compare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_WORDS = 32, LEAST_TIMEOUT = 60, TIMES_LONGER = 20 };

/* ---- The baseline ---- */

/* Runs the baseline with up to two words, and returns what it prints; NULL after a message. */
static char *ask(const cli_bench_comparison *c, const char *first, const char *second)
{
    cli_child child;
    char words[3][16] = {"rheolog"};
    snprintf(words[1], sizeof words[1], "%s", first);
    snprintf(words[2], sizeof words[2], "%s", second ? second : "");
    char *argv[] = {words[0], words[1], second ? words[2] : NULL, NULL};
    if (cli_child_run(&child, c->baseline.program, argv, LEAST_TIMEOUT))
        return child.out;
    cli_fail(CLI_BAD, "the baseline %s %s%s%s %s", child.program, first, second ? " " : "", second ? second : "",
             child.problem);
    free(child.out);
    return NULL;
}

static int identify(cli_bench_comparison *c)
{
    const char *simd = c->a->simd;
    snprintf(c->here.version, sizeof c->here.version, "%s, simd %s", rheo_build(), rheo_simd());
    char *text = ask(c, "--version", NULL);
    if (!text)
        return CLI_BAD;
    int status = CLI_DONE;
    if (strncmp(text, "rheolog ", 8) == 0) {
        /* The version, the build, the SIMD variants. */
        const char *build = strstr(text, "\nrheolog "), *in_use = strstr(text, "(in use: ");
        build = build ? build + 1 : text;
        in_use = simd ? simd : in_use ? in_use + strlen("(in use: ") : "unknown";
        snprintf(c->baseline.version, sizeof c->baseline.version, "%.*s, simd %.*s", (int)strcspn(build, "\n"), build,
                 (int)strcspn(in_use, ")\n"), in_use);
    } else {
        status = cli_fail(CLI_BAD, "the baseline %s is not rheolog: its --version prints \"%.*s\"",
                          c->baseline.program, (int)strcspn(text, "\n") < 60 ? (int)strcspn(text, "\n") : 60, text);
    }
    free(text);
    if (status == CLI_DONE &&
        (!(c->bench_help = ask(c, "bench", "--help")) || !(c->parameters = ask(c, "scenes", "--parameters"))))
        status = CLI_BAD;
    return status;
}

/* ---- Command lines ---- */

typedef struct command {
    char *word[MOST_WORDS + 1];
    char text[MOST_WORDS][320];
    int words;
} command;

static void add(command *line, const char *word)
{
    snprintf(line->text[line->words], sizeof line->text[0], "%s", word);
    line->word[line->words] = line->text[line->words];
    line->word[++line->words] = NULL;
}

static void add_number(command *line, const char *option, uint64_t value)
{
    char number[24];
    snprintf(number, sizeof number, "%llu", (unsigned long long)value);
    add(line, option);
    add(line, number);
}

static void add_setting(command *line, const char *path, const char *value)
{
    char setting[64];
    snprintf(setting, sizeof setting, "%s=%s", path, value);
    add(line, "--set");
    add(line, setting);
}

static bool measures_scenes(const cli_bench_comparison *c)
{
    return strcmp(c->a->measurement, "scenes") == 0;
}

/* True: the program has an option. This one has them all. */
static bool offers(const cli_bench_comparison *c, bool baseline, const char *option)
{
    return !baseline || strstr(c->bench_help, option);
}

/* `rheolog run`, which all versions have, for a scene from step 0. */
static bool add_run(const cli_bench_comparison *c, command *line, bool baseline, uint32_t call)
{
    const cli_bench_arguments *a = c->a;
    char name[48], time[32];
    uint64_t steps;
    rheo_scene scene;
    if (!cli_bench_next_scene(a, call, name, &steps) || rheo_scene_builtin(name, &scene, NULL) != RHEO_OK)
        return false;
    const bool thickening = scene.world.model == RHEO_MODEL_THICKENING;
    rheo__number_text((double)a->settle.value * scene.world.step, time, sizeof time);
    rheo_scene_release(&scene);
    add(line, "run");
    add(line, name);
    add_number(line, "--steps", steps);
    if (thickening && a->settle.given)
        add_setting(line, "settle.time", time);
    if (thickening && a->scheme && (!baseline || strstr(c->parameters, "\nscheme = ")))
        add_setting(line, "scheme", a->scheme);
    return true;
}

static bool add_bench(const cli_bench_comparison *c, command *line, bool baseline, uint32_t call)
{
    const cli_bench_arguments *a = c->a;
    if (call > 0)
        return false;
    add(line, "bench");
    add(line, a->measurement);
    add_number(line, "--repetitions", a->repetitions);
    if (a->steps)
        add_number(line, "--steps", a->steps);
    if (a->particles)
        add_number(line, "--particles", a->particles);
    if (a->settle.given)
        add_number(line, "--settle", a->settle.value);
    if (a->window_list) {
        add(line, "--windows");
        add(line, a->window_list);
    }
    if (a->model && offers(c, baseline, "--model")) {
        add(line, "--model");
        add(line, a->model);
    }
    if (a->studies && offers(c, baseline, "--study")) {
        add(line, "--study");
        add(line, a->studies);
    }
    if (a->scheme && offers(c, baseline, "--scheme")) {
        add(line, "--scheme");
        add(line, a->scheme);
    }
    return true;
}

/* An option that the baseline needs for this comparison, and does not have; NULL: it has all. */
static const char *missing_option(const cli_bench_comparison *c)
{
    const cli_bench_arguments *a = c->a;
    if (a->settle.given && !measures_scenes(c) && !offers(c, true, "--settle"))
        return "--settle";
    return a->simd && !offers(c, true, "--simd") && !offers(c, true, "--kernels") ? "--simd" : NULL;
}

/* Writes the command line of a call. False: a round has no further call. */
static bool command_of(const cli_bench_comparison *c, command *line, bool baseline, uint32_t call)
{
    *line = (command){.words = 0};
    add(line, "rheolog");
    if (!(measures_scenes(c) ? add_run : add_bench)(c, line, baseline, call))
        return false;
    if (c->a->simd) {
        add(line, offers(c, baseline, "--simd") ? "--simd" : "--kernels");
        add(line, c->a->simd);
    }
    add(line, "--json");
    add(line, "--quiet");
    return true;
}

/* ---- Measurements ---- */

static void name_call(const command *line, char *name, size_t size)
{
    size_t n = 0;
    name[0] = 0;
    for (int w = 1; w < line->words && n < size; w++)
        n += (size_t)snprintf(name + n, size - n, w > 1 ? " %s" : "%s", line->word[w]);
}

static int fail(const cli_bench_side *s, bool baseline, int code, const char *call, const char *problem)
{
    return cli_fail(baseline ? CLI_BAD : code, "%s%s %s %s", baseline ? "the baseline " : "this program",
                    baseline ? s->program : ":", call, problem);
}

static int measure(cli_bench_comparison *c, bool baseline, uint32_t round, uint32_t call)
{
    cli_bench_side *s = baseline ? &c->baseline : &c->here;
    command line;
    char name[1024], wrong[64], problem[128];
    cli_child child;
    command_of(c, &line, baseline, call);
    name_call(&line, name, sizeof name);
    if (cli_progress_due(&c->a->progress, cli_now()))
        cli_progress_say(&c->a->progress, cli_now(), "round %u of %u, %s: %s", round + 1, c->a->rounds,
                         baseline ? "baseline" : "this program", name);
    const double start = cli_now();
    const double timeout = c->a->timeout ? (double)c->a->timeout : fmax(LEAST_TIMEOUT, TIMES_LONGER * c->longest);
    const bool ran = cli_child_run(&child, s->program, line.word, baseline ? timeout : 0);
    if (!baseline)
        c->longest = fmax(c->longest, cli_now() - start);
    int status = CLI_DONE;
    if (!ran) {
        status = fail(s, baseline, child.code > 0 ? child.code : CLI_SYSTEM, name, child.problem);
    } else if (!cli_bench_read_results(child.out, &s->round[round], wrong)) {
        snprintf(problem, sizeof problem, "prints \"%s\", which is no result", wrong);
        status = fail(s, baseline, CLI_SYSTEM, name, problem);
    }
    free(child.out);
    return status;
}

/* All rounds of a program must have the same cases and results. */
static int check_rounds(const cli_bench_comparison *c, bool baseline)
{
    const cli_bench_side *s = baseline ? &c->baseline : &c->here;
    const char *name = baseline ? s->program : "this program";
    for (uint32_t round = 1; round < c->a->rounds; round++)
        for (uint32_t i = 0; i < s->round[0].count; i++) {
            const cli_bench_result *first = &s->round[0].item[i], *other = &s->round[round].item[i];
            if (s->round[round].count != s->round[0].count ||
                !cli_bench_find_result(&(cli_bench_results){1, &s->round[round].item[i]}, first))
                return cli_fail(baseline ? CLI_BAD : CLI_SYSTEM,
                                "%s measured other cases in round %u than in round 1", name, round + 1);
            if (strcmp(first->hash, other->hash) != 0)
                return cli_fail(baseline ? CLI_BAD : CLI_DIFFERS,
                                "%s: %s ended with hash %s in round 1, %s in round %u; a build whose results change "
                                "cannot be measured",
                                name, first->key[CLI_BENCH_CASE], first->hash, other->hash, round + 1);
        }
    return CLI_DONE;
}

static int measure_all(cli_bench_comparison *c)
{
    command line;
    for (uint32_t round = 0; round < c->a->rounds; round++)
        for (uint32_t call = 0; command_of(c, &line, false, call); call++)
            for (int turn = 0; turn < 2; turn++) {
                const int status = measure(c, (round + (uint32_t)turn) % 2 == 1, round, call);
                if (status != CLI_DONE)
                    return status;
            }
    const int status = check_rounds(c, false);
    return status == CLI_DONE ? check_rounds(c, true) : status;
}

/* ---- The command ---- */

static void release(cli_bench_comparison *c)
{
    cli_bench_side *const sides[] = {&c->here, &c->baseline};
    for (int s = 0; s < 2; s++) {
        for (uint32_t r = 0; sides[s]->round && r < c->a->rounds; r++)
            free(sides[s]->round[r].item);
        free(sides[s]->round);
    }
    free(c->bench_help);
    free(c->parameters);
}

int cli_bench_compare(cli_bench_arguments *a)
{
    cli_bench_comparison c = {.a = a, .here.program = cli_child_self(), .baseline.program = a->baseline};
    if (!c.here.program)
        return cli_fail(CLI_BAD, "--baseline needs /proc to run this program again; this system has none");
    c.here.round = calloc(a->rounds, sizeof *c.here.round);
    c.baseline.round = calloc(a->rounds, sizeof *c.baseline.round);
    a->progress.last = cli_now();
    c.core = cli_bench_pin(); /* both programs inherit it */
    int status = c.here.round && c.baseline.round ? identify(&c) : cli_fail(CLI_SYSTEM, "no memory for the rounds");
    const char *missing = status == CLI_DONE ? missing_option(&c) : NULL;
    if (missing)
        status = cli_fail(CLI_BAD, "the baseline %s has no option %s", a->baseline, missing);
    if (status == CLI_DONE)
        status = measure_all(&c);
    cli_progress_end(&a->progress);
    if (status == CLI_DONE)
        status = cli_bench_print_comparison(&c);
    release(&c);
    return status;
}
