/* rheolog bench table1: repeats the measurements of Table 1 in the paper of the thickening model. */
#include "cli/bench.h"

#include <math.h>
#include <string.h>

/* Cost of the history in a step: the sum D^q, and storing the velocities. */
static double history_of(const cli_bench_case *c)
{
    return cli_bench_stage(c, "fractional_derivative") + cli_bench_stage(c, "history");
}

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

static const struct paper_line *paper_line(const cli_bench_case *c)
{
    for (size_t i = 0; i < sizeof PAPER / sizeof *PAPER; i++)
        if (strcmp(PAPER[i].scene, c->name) == 0 && PAPER[i].window == c->window)
            return &PAPER[i];
    return NULL;
}

/* The paper's times are for a step of all particles. */
static double paper_ns(double seconds)
{
    return 1e9 * seconds / PAPER_PARTICLES;
}

static void print_table1(const cli_bench_cases *cases, const cli_bench_arguments *a)
{
    cli_bench_print_head(a, cli_bench_per_step);
    printf("%-13s %-10s %5s %8s %8s %13s %8s %8s %9s | %8s %8s %9s %6s\n", "", "", "", "", "", "", "", "", "",
           "paper:", "", "", "times");
    printf("%-13s %-10s %5s %8s %8s %13s %8s %8s %9s | %8s %8s %9s %6s\n", "scene", "scheme", "d", "n", "all",
           "least-most", "step", "history", "memory", "step", "history", "memory", "faster");
    for (uint32_t i = 0; i < cases->count; i++) {
        const cli_bench_case *c = &cases->item[i];
        const struct paper_line *paper = paper_line(c);
        char memory[32];
        cli_bytes((double)c->history_bytes, memory, sizeof memory);
        printf("%-13s %-10s %5u %8u", c->name, c->scheme, c->window, c->particles);
        cli_bench_print_spread(c, 1);
        printf(" %8.1f %8.1f %9s |", cli_bench_total(c) - history_of(c), history_of(c), memory);
        if (paper)
            printf(" %8.0f %8.0f %6.0f MB %6.0f", paper_ns(paper->step), paper_ns(1e-3 * paper->history),
                   paper->memory, paper_ns(paper->step + 1e-3 * paper->history) / cli_bench_total(c));
        putchar('\n');
    }
    puts(
        "\nscheme sequential is Algorithm 1 of the paper, summed the default. history: the stages fractional_derivative\n"
        "and history; step: all others, also those that use the derivative. The paper: Ozgen, Kallmann, Brown, \"An\n"
        "SPH model to simulate the dynamic behavior of shear thickening fluids\", Table 1; its times of a step divided\n"
        "by its 20 000 particles.");
}

static void own_cells(cli_bench_table *table, const cli_bench_cases *cases, const cli_bench_case *c)
{
    (void)cases;
    const struct paper_line *paper = paper_line(c);
    cli_bench_cell_number(table, "ns_without_history", 2, cli_bench_total(c) - history_of(c));
    cli_bench_cell_number(table, "ns_history_part", 2, history_of(c));
    cli_bench_cell_number(table, "paper_ns_step", 0, paper ? paper_ns(paper->step) : NAN);
    cli_bench_cell_number(table, "paper_ns_history", 0, paper ? paper_ns(1e-3 * paper->history) : NAN);
    cli_bench_cell_number(table, "paper_bytes_history", 0, paper ? 1e6 * paper->memory / PAPER_PARTICLES : NAN);
}

static uint32_t largest_window(const cli_bench_arguments *a)
{
    uint32_t largest = 0;
    for (uint32_t w = 0; w < a->windows; w++)
        largest = a->window[w] > largest ? a->window[w] : largest;
    return largest;
}

static cli_bench_case *add(cli_bench_cases *cases, const cli_bench_arguments *a, const char *scene, uint32_t window,
                           rheo_scheme scheme)
{
    cli_bench_case *c = cli_bench_add(cases, scene, a->particles);
    if (!c)
        return NULL;
    cli_bench_set_window(c, window);
    c->scene.world.scheme = scheme;
    c->lead = largest_window(a) + UINT64_C(1); /* all cases have the same state, so only the window differs */
    return c;
}

int cli_bench_run_table1(cli_bench_arguments *a)
{
    static const char *const scenes[] = {"bowling-ball", "vibration"};
    static const rheo_scheme schemes[] = {RHEO_SCHEME_SUMMED, RHEO_SCHEME_SEQUENTIAL};
    const size_t scheme_count = a->scheme ? 1 : sizeof schemes / sizeof *schemes; /* measuring sets a->scheme */
    cli_bench_cases cases = {0};
    for (size_t s = 0; s < sizeof scenes / sizeof *scenes; s++)
        for (size_t k = 0; k < scheme_count; k++)
            for (uint32_t w = 0; w < a->windows; w++)
                if (!add(&cases, a, scenes[s], a->window[w], schemes[k]))
                    return cli_bench_no_memory(&cases);
    int status = cli_bench_measure(&cases, a);
    if (status == CLI_DONE && (a->csv || a->json)) {
        cli_bench_rows(&cases, a, own_cells);
    } else if (status == CLI_DONE) {
        print_table1(&cases, a);
        const cli_bench_case *shown = &cases.item[a->windows - 1];
        for (uint32_t i = 0; i < a->windows; i++)
            if (cases.item[i].window == 150)
                shown = &cases.item[i];
        putchar('\n');
        status = cli_bench_print_limits(shown);
    }
    cli_bench_release(&cases);
    return status;
}
