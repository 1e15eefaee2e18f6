/*
 * rheolog bench: what a step costs. Each measurement is a list of cases (bench_cases.c has how they are made and
 * timed) and a way to print what came of them: for people, or a line of CSV or JSON for each case.
 */
#define _POSIX_C_SOURCE 200809L
#include "cli/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { POOL = 20000, FEWEST = 1000, MOST = 100000000 };

/* What of the arguments a measurement takes, and what it does. */
typedef struct measurement {
    const char *name;
    uint64_t steps, particles; /* defaults */
    const char *windows;       /* default of --windows; NULL: it takes none */
    int (*run)(bench_arguments *a);
} measurement;

/* ---- What all print ---- */

static double total_of(const bench_case *c)
{
    return bench_median(c->total, c->repetitions);
}

/* What remembering costs a step: summing and storing. */
static double history_of(const bench_case *c)
{
    return bench_stage(c, "fractional_derivative") + bench_stage(c, "history");
}

static void begin_row(bench_table *table, const bench_case *c)
{
    bench_cell_text(table, "case", c->name);
    bench_cell_whole(table, "particles", c->particles);
    bench_cell_whole(table, "window", c->window);
    bench_cell_text(table, "kind", c->kind);
    bench_cell_number(table, "neighbours", 2, c->neighbours);
    bench_cell_number(table, "ns_median", 2, total_of(c));
    bench_cell_number(table, "ns_least", 2, bench_least(c->total, c->repetitions));
    bench_cell_number(table, "ns_largest", 2, bench_largest(c->total, c->repetitions));
}

static double per_particle(const bench_case *c, size_t bytes)
{
    return c->particles ? (double)bytes / c->particles : 0;
}

/* Stages, bytes, hash, and by what it was measured. */
static void end_row(bench_table *table, const bench_cases *cases, const bench_case *c, const bench_arguments *a)
{
    char stage[BENCH_MAX_STAGES][32], name[48], hash[17];
    const uint32_t stages = bench_all_stages(cases, stage);
    for (uint32_t s = 0; s < stages; s++) {
        snprintf(name, sizeof name, "ns_%.31s", stage[s]);
        bench_cell_number(table, name, 3, bench_has_stage(c, stage[s]) ? bench_stage(c, stage[s]) : NAN);
    }
    bench_cell_number(table, "ns_rest", 3, bench_median(c->rest, c->repetitions));
    bench_cell_number(table, "bytes_history", 1, per_particle(c, c->history_bytes));
    bench_cell_number(table, "bytes_state", 1, per_particle(c, c->field_bytes));
    bench_cell_number(table, "bytes_world", 1, per_particle(c, c->world_bytes));
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)c->hash);
    bench_cell_text(table, "hash", hash);
    bench_cell_whole(table, "steps", a->steps);
    bench_cell_whole(table, "repetitions", a->repetitions);
    bench_cell_text(table, "machine", bench_machine());
    bench_cell_text(table, "compiler", bench_compiler());
    bench_cell_text(table, "real", sizeof(rheo_real) == 8 ? "double" : "float");
    bench_cell_text(table, "simd", rheo_simd());
    bench_end_row(table);
}

static void print_head(const bench_arguments *a)
{
    printf("%s, %s, %s, simd %s; %u repetition%s of %llu steps, medians; ns a particle and step\n\n", bench_machine(),
           bench_compiler(), sizeof(rheo_real) == 8 ? "double" : "float", rheo_simd(), a->repetitions,
           a->repetitions == 1 ? "" : "s", (unsigned long long)a->steps);
}

static void print_spread(const bench_case *c)
{
    char spread[48];
    snprintf(spread, sizeof spread, "%.0f-%.0f", bench_least(c->total, c->repetitions),
             bench_largest(c->total, c->repetitions));
    printf(" %8.1f %13s", total_of(c), spread);
}

static int no_memory(bench_cases *cases)
{
    bench_release(cases);
    return cli_fail(CLI_SYSTEM, "no memory for the cases");
}

/* ---- table1 ---- */

/*
 * Table 1 of O. Ozgen, M. Kallmann, E. Brown, "An SPH model to simulate the dynamic behavior of shear thickening
 * fluids": average time of a step without the history terms (s) and of the history terms (ms), and their memory (MB),
 * for 20 000 particles.
 */
static const struct paper_line {
    const char *scene;
    uint32_t window;
    double step, history, memory;
} PAPER[] = {
    {"bowling-ball", 0, 1.226, 0, 0},      {"bowling-ball", 50, 1.335, 4, 12}, {"bowling-ball", 150, 1.494, 12, 36},
    {"bowling-ball", 500, 1.627, 40, 120}, {"vibration", 0, 1.192, 0, 0},      {"vibration", 50, 1.245, 4, 12},
    {"vibration", 150, 1.388, 12, 36},     {"vibration", 500, 1.539, 40, 120},
};
#define PAPER_PARTICLES 20000.

static const struct paper_line *paper_line(const bench_case *c)
{
    for (size_t i = 0; i < sizeof PAPER / sizeof *PAPER; i++)
        if (strcmp(PAPER[i].scene, c->name) == 0 && PAPER[i].window == c->window)
            return &PAPER[i];
    return NULL;
}

/* Times of the paper are a step of all its particles. */
static double paper_ns(double seconds)
{
    return 1e9 * seconds / PAPER_PARTICLES;
}

static void print_table1(const bench_cases *cases, const bench_arguments *a)
{
    print_head(a);
    printf("%-13s %5s %8s %8s %13s %8s %8s %9s | %8s %8s %9s %6s\n", "", "", "", "", "", "", "", "", "paper:", "", "",
           "times");
    printf("%-13s %5s %8s %8s %13s %8s %8s %9s | %8s %8s %9s %6s\n", "scene", "d", "n", "all", "least-most", "step",
           "history", "memory", "step", "history", "memory", "faster");
    for (uint32_t i = 0; i < cases->count; i++) {
        const bench_case *c = &cases->at[i];
        const struct paper_line *paper = paper_line(c);
        char memory[32];
        cli_bytes((double)c->history_bytes, memory, sizeof memory);
        printf("%-13s %5u %8u", c->name, c->window, c->particles);
        print_spread(c);
        printf(" %8.1f %8.1f %9s |", total_of(c) - history_of(c), history_of(c), memory);
        if (paper)
            printf(" %8.0f %8.0f %6.0f MB %6.0f", paper_ns(paper->step), paper_ns(1e-3 * paper->history),
                   paper->memory, paper_ns(paper->step + 1e-3 * paper->history) / total_of(c));
        putchar('\n');
    }
    puts("\nstep: without the stages fractional_derivative and history, which are the history's part (what stiffness "
         "they\n"
         "make of it is in spring_displacement). The paper: Ozgen, Kallmann, Brown, \"An SPH model to simulate the\n"
         "dynamic behavior of shear thickening fluids\", Table 1, its times of a step divided by its 20 000 "
         "particles.");
}

static void list_table1(const bench_cases *cases, const bench_arguments *a)
{
    bench_table table = {.json = a->json};
    for (uint32_t i = 0; i < cases->count; i++) {
        const bench_case *c = &cases->at[i];
        const struct paper_line *paper = paper_line(c);
        begin_row(&table, c);
        bench_cell_number(&table, "ns_without_history", 2, total_of(c) - history_of(c));
        bench_cell_number(&table, "ns_history_part", 2, history_of(c));
        bench_cell_number(&table, "paper_ns_step", 0, paper ? paper_ns(paper->step) : NAN);
        bench_cell_number(&table, "paper_ns_history", 0, paper ? paper_ns(1e-3 * paper->history) : NAN);
        bench_cell_number(&table, "paper_bytes_history", 0, paper ? 1e6 * paper->memory / PAPER_PARTICLES : NAN);
        end_row(&table, cases, c, a);
    }
}

/* ---- limits ---- */

static void print_limits(const bench_limits *l)
{
    char memory[32], cache[32];
    cli_bytes(l->memory_bytes, memory, sizeof memory);
    cli_bytes(l->cache_bytes, cache, sizeof cache);
    printf(
        "this machine at best, one core, simd %s: %.1f G/s additions and multiplications, %.2f G/s square "
        "roots,\n%.2f G/s divisions; memory %.1f GB/s read, %.1f copied (arrays of %s); caches %.1f, %.1f (%s)\n\n",
        rheo_simd(), l->arithmetic, l->root, l->division, l->memory_read, l->memory_copy, memory, l->cache_read,
        l->cache_copy, cache);
}

/* A stage against the limit; the last one, "", is the rest of the step. */
static void print_stage_limits(const bench_case *c, const bench_limits *limits)
{
    printf("%s, d = %u, %u particles, %.1f neighbours\n", c->name, c->window, c->particles, c->neighbours);
    printf("  %-22s %8s %7s %8s %6s %6s %7s %7s %7s  %s\n", "stage", "ns", "share", "operat.", "roots", "div.",
           "bytes", "limit", "reached", "set by");
    double sum = 0;
    const double total = total_of(c);
    for (uint32_t s = 0; s <= c->stages; s++) {
        const char *stage = s < c->stages ? c->stage[s] : "";
        const double ns = s < c->stages ? bench_stage(c, stage) : bench_median(c->rest, c->repetitions);
        bench_needs needs;
        printf("  %-22s %8.2f %5.1f %%", *stage ? stage : "the rest", ns, total > 0 ? 100 * ns / total : 0);
        if (bench_stage_needs(c, stage, &needs)) {
            const char *bound;
            const double limit = bench_limit(limits, &needs, &bound);
            sum += limit;
            printf(" %8.0f %6.1f %6.1f %7.0f %7.2f %5.0f %%  %s", needs.operations, needs.roots, needs.divisions,
                   needs.bytes, limit, ns > 0 ? 100 * limit / ns : 0, bound);
        }
        putchar('\n');
    }
    printf("  %-22s %8.2f %5.1f %% %8s %6s %6s %7s %7.2f %5.0f %%\n", "all", total, 100., "", "", "", "", sum,
           total > 0 ? 100 * sum / total : 0);
}

static void list_stage_limits(const bench_case *c, const bench_limits *limits, const bench_arguments *a)
{
    bench_table table = {.json = a->json};
    for (uint32_t s = 0; s <= c->stages; s++) {
        const char *stage = s < c->stages ? c->stage[s] : "";
        const double ns = s < c->stages ? bench_stage(c, stage) : bench_median(c->rest, c->repetitions);
        bench_needs needs;
        const char *bound = "";
        const bool known = bench_stage_needs(c, stage, &needs);
        const double limit = known ? bench_limit(limits, &needs, &bound) : NAN;
        bench_cell_text(&table, "case", c->name);
        bench_cell_text(&table, "stage", *stage ? stage : "rest");
        bench_cell_number(&table, "ns_median", 3, ns);
        bench_cell_number(&table, "operations", 1, known ? needs.operations : NAN);
        bench_cell_number(&table, "roots", 1, known ? needs.roots : NAN);
        bench_cell_number(&table, "divisions", 1, known ? needs.divisions : NAN);
        bench_cell_number(&table, "bytes", 1, known ? needs.bytes : NAN);
        bench_cell_number(&table, "ns_limit", 3, limit);
        bench_cell_number(&table, "reached", 3, known && ns > 0 ? limit / ns : NAN);
        bench_cell_text(&table, "set_by", bound);
        bench_cell_number(&table, "machine_operations", 2, limits->arithmetic);
        bench_cell_number(&table, "machine_roots", 2, limits->root);
        bench_cell_number(&table, "machine_divisions", 2, limits->division);
        bench_cell_number(&table, "machine_memory_read", 2, limits->memory_read);
        bench_cell_number(&table, "machine_memory_copy", 2, limits->memory_copy);
        bench_cell_number(&table, "machine_cache_read", 2, limits->cache_read);
        bench_cell_number(&table, "machine_cache_copy", 2, limits->cache_copy);
        bench_cell_text(&table, "machine", bench_machine());
        bench_cell_text(&table, "compiler", bench_compiler());
        bench_cell_text(&table, "real", sizeof(rheo_real) == 8 ? "double" : "float");
        bench_cell_text(&table, "simd", rheo_simd());
        bench_end_row(&table);
    }
}

static int limits_of(bench_limits *limits)
{
    return bench_measure_limits(limits) ? CLI_DONE
                                        : cli_fail(CLI_SYSTEM, "no memory to measure the machine's limits");
}

static int run_limits(bench_arguments *a)
{
    bench_cases cases = {0};
    bench_limits limits;
    if (!bench_add(&cases, "bowling-ball", a->particles))
        return no_memory(&cases);
    int status = bench_measure(&cases, a);
    if (status == CLI_DONE)
        status = limits_of(&limits);
    if (status == CLI_DONE && (a->csv || a->json)) {
        list_stage_limits(&cases.at[0], &limits, a);
    } else if (status == CLI_DONE) {
        print_head(a);
        print_limits(&limits);
        print_stage_limits(&cases.at[0], &limits);
    }
    bench_release(&cases);
    return status;
}

static uint32_t largest_window(const bench_arguments *a)
{
    uint32_t largest = 0;
    for (uint32_t w = 0; w < a->windows; w++)
        largest = a->window[w] > largest ? a->window[w] : largest;
    return largest;
}

static int run_table1(bench_arguments *a)
{
    static const char *const scenes[] = {"bowling-ball", "vibration"};
    bench_cases cases = {0};
    for (size_t s = 0; s < sizeof scenes / sizeof *scenes; s++)
        for (uint32_t w = 0; w < a->windows; w++) {
            bench_case *c = bench_add(&cases, scenes[s], a->particles);
            if (!c)
                return no_memory(&cases);
            bench_set_window(c, a->window[w]);
            c->lead = largest_window(a) + UINT64_C(1); /* all at one time, so that the window is the difference */
        }
    int status = bench_measure(&cases, a);
    if (status == CLI_DONE && (a->csv || a->json)) {
        list_table1(&cases, a);
    } else if (status == CLI_DONE) {
        print_table1(&cases, a);
        const bench_case *shown = &cases.at[a->windows - 1];
        for (uint32_t i = 0; i < a->windows; i++)
            if (cases.at[i].window == 150)
                shown = &cases.at[i];
        bench_limits limits;
        if ((status = limits_of(&limits)) == CLI_DONE) {
            putchar('\n');
            print_limits(&limits);
            print_stage_limits(shown, &limits);
        }
    }
    bench_release(&cases);
    return status;
}

/* ---- history ---- */

/* The words that history.kind can be, if this build has that parameter. */
static const char *kinds(void)
{
    const rheo_parameter *p;
    for (size_t i = 0; (p = rheo_parameter_at(i)) != NULL; i++)
        if (strcmp(p->path, "history.kind") == 0 && p->choices)
            return p->choices;
    return "window";
}

static void print_history(const bench_cases *cases, const bench_arguments *a)
{
    print_head(a);
    printf("%-13s %6s %8s %8s %13s %9s %8s %12s %10s\n", "kind", "d", "n", "all", "least-most", "D^q", "storing",
           "bytes/part.", "error");
    for (uint32_t i = 0; i < cases->count; i++) {
        const bench_case *c = &cases->at[i];
        printf("%-13s %6u %8u", c->kind, c->window, c->particles);
        print_spread(c);
        printf(" %9.2f %8.2f %12.0f", bench_stage(c, "fractional_derivative"), bench_stage(c, "history"),
               per_particle(c, c->history_bytes));
        if (c->error == c->error)
            printf(" %10.1e", c->error);
        else
            printf(" %10s", "-");
        putchar('\n');
    }
    puts(
        "\nD^q: stage fractional_derivative; storing: stage history. error: the largest difference of D^q from the\n"
        "plain sum in double over the same velocities, as a part of the largest D^q; of 32 particles, as many steps\n"
        "as fill the window (kinds full and tempered: the sum over all steps; -: no such sum is known).");
}

static void list_history(const bench_cases *cases, const bench_arguments *a)
{
    bench_table table = {.json = a->json};
    for (uint32_t i = 0; i < cases->count; i++) {
        const bench_case *c = &cases->at[i];
        begin_row(&table, c);
        bench_cell_number(&table, "error", -3, c->error);
        end_row(&table, cases, c, a);
    }
}

static int run_history(bench_arguments *a)
{
    bench_cases cases = {0};
    static char words[256];
    snprintf(words, sizeof words, "%s", kinds());
    const bool parameter = kinds() != NULL && strchr(words, ' ') != NULL;
    int status = CLI_DONE;
    for (char *kind = strtok(words, " "); kind && status == CLI_DONE; kind = strtok(NULL, " "))
        for (uint32_t w = 0; w < a->windows && status == CLI_DONE; w++) {
            bench_case *c = bench_add(&cases, "bowling-ball", a->particles);
            rheo_error error = {""};
            if (!c) {
                status = no_memory(&cases);
                break;
            }
            bench_set_window(c, a->window[w]);
            c->with_error = a->window[w] > 0;
            if (parameter && rheo_world_def_set(&c->scene.world, "history.kind", kind, &error) != RHEO_OK)
                status = cli_fail(CLI_BAD, "%s", error.message);
        }
    if (status == CLI_DONE)
        status = bench_measure(&cases, a);
    if (status == CLI_DONE)
        (a->csv || a->json ? list_history : print_history)(&cases, a);
    bench_release(&cases);
    return status;
}

/* ---- scaling ---- */

static void print_scaling(const bench_cases *cases, const bench_arguments *a)
{
    print_head(a);
    printf("%9s %8s %13s %7s %11s %11s %9s %9s %9s\n", "particles", "all", "least-most", "ratio", "neighbours",
           "step", "state", "world", "process");
    for (uint32_t i = 0; i < cases->count; i++) {
        const bench_case *c = &cases->at[i];
        printf("%9u", c->particles);
        print_spread(c);
        printf(" %7.2f %11.1f %9.1f ms %9.0f %9.0f", total_of(c) / total_of(&cases->at[0]), c->neighbours,
               1e-6 * total_of(c) * c->particles, per_particle(c, c->field_bytes), per_particle(c, c->world_bytes));
        if (c->process_bytes)
            printf(" %9.0f\n", per_particle(c, c->process_bytes));
        else
            printf(" %9s\n", "-");
    }
    printf("\nA pool as deep as that of bowling-ball, with its ball, d = %u. Bytes a particle: state, what is hashed "
           "and\nsaved; world, all that the library holds between two steps; process, by how much it grew at most "
           "while\nthe scene was filled, settled and stepped.\n",
           cases->at[0].window);
}

static void list_scaling(const bench_cases *cases, const bench_arguments *a)
{
    bench_table table = {.json = a->json};
    for (uint32_t i = 0; i < cases->count; i++) {
        const bench_case *c = &cases->at[i];
        begin_row(&table, c);
        bench_cell_number(&table, "bytes_process", 1, c->process_bytes ? per_particle(c, c->process_bytes) : NAN);
        bench_cell_number(&table, "ratio", 3, total_of(c) / total_of(&cases->at[0]));
        end_row(&table, cases, c, a);
    }
}

static int run_scaling(bench_arguments *a)
{
    static const uint64_t sizes[] = {20000, 100000, 500000, 2000000};
    enum { SMALL_WINDOW = 4 }; /* so that memory suffices */
    bench_cases cases = {0};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        if (s > 0 && sizes[s] > a->particles)
            break;
        bench_case *c = bench_add(&cases, "bowling-ball", sizes[s] < a->particles ? sizes[s] : a->particles);
        if (!c)
            return no_memory(&cases);
        bench_set_window(c, SMALL_WINDOW);
        c->scene.settle.time = .5;
    }
    const int status = bench_measure(&cases, a);
    if (status == CLI_DONE)
        (a->csv || a->json ? list_scaling : print_scaling)(&cases, a);
    bench_release(&cases);
    return status;
}

/* ---- features ---- */

enum { SPRINGS = 1, HISTORY = 2, BALL = 4, WALLS = 8, VIBRATORS = 16 };

/* Without walls there is no gravity, or the fluid would fall apart and be another one. */
static const struct {
    const char *name;
    unsigned has;
} FEATURES[] = {
    {"fluid", 0},
    {"walls", WALLS},
    {"springs", SPRINGS},
    {"springs, walls", SPRINGS | WALLS},
    {"history", SPRINGS | HISTORY},
    {"ball", BALL},
    {"ball, walls", BALL | WALLS},
    {"vibrators, walls", VIBRATORS | WALLS},
    {"all but vibrators", SPRINGS | HISTORY | BALL | WALLS},
    {"all", SPRINGS | HISTORY | BALL | WALLS | VIBRATORS},
};

static bench_case *add_features(bench_cases *cases, uint64_t particles, const char *name, unsigned has)
{
    bench_case *c = bench_add(cases, "bowling-ball", particles);
    if (!c)
        return NULL;
    rheo_world_def *def = &c->scene.world;
    snprintf(c->name, sizeof c->name, "%s", name);
    if (!(has & SPRINGS))
        def->springs.stiffness = 0;
    if (!(has & HISTORY))
        bench_set_window(c, 0);
    if (!(has & BALL)) {
        def->ball.radius = 0;
        c->scene.clearance = -1;
    }
    if (!(has & WALLS)) {
        def->walls.count = 0;
        memset(def->gravity, 0, sizeof def->gravity);
    }
    if (has & VIBRATORS) {
        rheo_scene vibration;
        rheo_scene_builtin("vibration", &vibration, NULL);
        const double *size = c->scene.fill[0].max, *its = vibration.fill[0].max;
        def->vibrators = vibration.world.vibrators;
        for (uint32_t i = 0; i < def->vibrators.count; i++) {
            def->vibrators.position[i][0] *= size[0] / its[0];
            def->vibrators.position[i][1] *= size[2] / its[2];
        }
        def->springs.solver = vibration.world.springs.solver; /* it would not bear the vibrators otherwise */
    }
    return c;
}

/* The stages that every case has. */
static double common_of(const bench_cases *cases, const bench_case *c)
{
    double sum = 0;
    for (uint32_t s = 0; s < c->stages; s++) {
        bool common = true;
        for (uint32_t i = 0; i < cases->count; i++)
            common = common && bench_has_stage(&cases->at[i], c->stage[s]);
        sum += common ? bench_stage(c, c->stage[s]) : 0;
    }
    return sum;
}

static double stages_of(const bench_case *c)
{
    double sum = 0;
    for (uint32_t s = 0; s < c->stages; s++)
        sum += bench_stage(c, c->stage[s]);
    return sum;
}

static void print_features(const bench_cases *cases, const bench_arguments *a)
{
    print_head(a);
    printf("%-16s %6s %8s %13s %8s %8s %7s %7s %7s  %s\n", "scene with", "neigh.", "all", "least-most", "common",
           "own", "rest", "state", "world", "own stages");
    for (uint32_t i = 0; i < cases->count; i++) {
        const bench_case *c = &cases->at[i];
        const double common = common_of(cases, c);
        printf("%-16s %6.1f", c->name, c->neighbours);
        print_spread(c);
        printf(" %8.1f %8.1f %7.1f %7.0f %7.0f ", common, stages_of(c) - common,
               bench_median(c->rest, c->repetitions), per_particle(c, c->field_bytes),
               per_particle(c, c->world_bytes));
        for (uint32_t s = 0; s < c->stages; s++) {
            bool everywhere = true;
            for (uint32_t other = 0; other < cases->count; other++)
                everywhere = everywhere && bench_has_stage(&cases->at[other], c->stage[s]);
            if (!everywhere)
                printf(" %s %.1f", c->stage[s], bench_stage(c, c->stage[s]));
        }
        putchar('\n');
    }
    fputs("\ncommon: the stages that every scene has:", stdout);
    const bench_case *first = &cases->at[0];
    for (uint32_t s = 0; s < first->stages; s++) {
        bool everywhere = true;
        for (uint32_t i = 1; i < cases->count; i++)
            everywhere = everywhere && bench_has_stage(&cases->at[i], first->stage[s]);
        if (everywhere)
            printf(" %s", first->stage[s]);
    }
    puts(".\nown: the others; rest: of a step, in no stage. all = common + own + rest: what a scene lacks has no "
         "stage\n"
         "and costs nothing. common changes with the neighbours, and where a ball or vibrators stir the fluid.\n"
         "state, world: bytes a particle, of what is saved and of all that the library holds. Without walls there is "
         "no\n"
         "gravity either, or the fluid would fall apart.");
}

static void list_features(const bench_cases *cases, const bench_arguments *a)
{
    bench_table table = {.json = a->json};
    for (uint32_t i = 0; i < cases->count; i++) {
        const bench_case *c = &cases->at[i];
        const double common = common_of(cases, c);
        begin_row(&table, c);
        bench_cell_number(&table, "ns_common", 2, common);
        bench_cell_number(&table, "ns_own", 2, stages_of(c) - common);
        end_row(&table, cases, c, a);
    }
}

static int run_features(bench_arguments *a)
{
    bench_cases cases = {0};
    for (size_t f = 0; f < sizeof FEATURES / sizeof *FEATURES; f++)
        if (!add_features(&cases, a->particles, FEATURES[f].name, FEATURES[f].has))
            return no_memory(&cases);
    const int status = bench_measure(&cases, a);
    if (status == CLI_DONE)
        (a->csv || a->json ? list_features : print_features)(&cases, a);
    bench_release(&cases);
    return status;
}

/* ---- Arguments ---- */

static const measurement MEASUREMENTS[] = {
    {"table1", 300, POOL, "0,50,150,500", run_table1}, {"history", 96, POOL, "50,150,500,1000", run_history},
    {"scaling", 30, 2000000, NULL, run_scaling},       {"features", 96, POOL, NULL, run_features},
    {"limits", 300, POOL, NULL, run_limits},           {"table2", 10, 0, NULL, bench_run_table2},
    {"error", 60, 0, NULL, bench_run_error},
};

static const measurement *find(const char *name)
{
    for (size_t i = 0; i < sizeof MEASUREMENTS / sizeof *MEASUREMENTS; i++)
        if (strcmp(MEASUREMENTS[i].name, name) == 0)
            return &MEASUREMENTS[i];
    return NULL;
}

/* "0,50,150" */
static int read_windows(const char *text, bench_arguments *a)
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

static int bench_command(int argc, char **argv)
{
    bench_arguments a = {0};
    cli_number repetitions = {false, 5}, steps = {false, 0}, particles = {false, 0};
    const char *windows = NULL, *simd = NULL;
    bool quiet = false;
    const cli_option options[] = {
        {"--repetitions", NULL, "N", CLI_NUMBER, &repetitions},
        {"--steps", NULL, "N", CLI_NUMBER, &steps},
        {"--particles", NULL, "N", CLI_NUMBER, &particles},
        {"--windows", NULL, "D,D,...", CLI_TEXT, &windows},
        {"--simd", NULL, "NAME", CLI_TEXT, &simd},
        {"--csv", NULL, NULL, CLI_FLAG, &a.csv},
        {"--json", NULL, NULL, CLI_FLAG, &a.json},
        {"--quiet", NULL, NULL, CLI_FLAG, &quiet},
        {0},
    };
    int status = cli_parse(&cli_bench, options, &argc, argv);
    if (status != CLI_GO_ON)
        return status;
    if (argc == 0)
        return cli_usage(&cli_bench,
                         "needs a measurement: table1, table2, history, error, scaling, features or limits");
    const measurement *m = find(argv[0]);
    if (!m)
        return cli_usage(
            &cli_bench,
            "there is no measurement \"%s\"; there are table1, table2, history, error, scaling, features and limits",
            argv[0]);
    if (argc > 1)
        return cli_usage(&cli_bench, "makes one measurement at a time; got \"%s\" as well", argv[1]);
    if (a.csv && a.json)
        return cli_usage(&cli_bench, "prints --csv or --json, not both");
    if (windows && !m->windows)
        return cli_usage(&cli_bench, "%s takes no --windows; table1 and history do", m->name);
    a.steps = steps.given ? steps.value : m->steps;
    a.particles = particles.given ? particles.value : m->particles;
    if (repetitions.value < 1 || repetitions.value > BENCH_MAX_REPETITIONS)
        return cli_usage(&cli_bench, "--repetitions must be from 1 to %d", BENCH_MAX_REPETITIONS);
    a.repetitions = (uint32_t)repetitions.value;
    if (a.steps < 1)
        return cli_usage(&cli_bench, "--steps must be at least 1: nothing would be timed");
    if (a.particles && (a.particles < FEWEST || a.particles > MOST))
        return cli_usage(&cli_bench, "--particles must be from %d to %d; the ball needs a pool", FEWEST, MOST);
    if (m->windows && (status = read_windows(windows ? windows : m->windows, &a)) != CLI_DONE)
        return status;
    if ((status = cli_use_simd(simd)) != CLI_DONE)
        return status;
    a.progress = (cli_progress){.quiet = quiet, .terminal = isatty(STDERR_FILENO) == 1};
    return m->run(&a);
}

static const char help[] = {
#include "cli/help/bench.txt.inc"
    0};

const cli_command cli_bench = {"bench", help, bench_command};
