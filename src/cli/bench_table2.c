/*
 * rheolog bench table2: repeats the measurements of Table 2 in the paper of the melting model. An iteration of the
 * paper is a substep here.
 */
#include "cli/bench.h"

/*
 * Table 2 of A. Paiva, F. Petronetto, T. Lewiner, G. Tavares, "Particle-based non-Newtonian fluid animation for
 * melting objects": average time per iteration on a Pentium 4 with 2.4 GHz. The gargoyle of the paper is all fluid;
 * the scene here is a bunny with the same number of particles.
 */
static const struct {
    const char *scene, *paper;
    uint32_t particles;
    double seconds;
} PAPER[] = {{"melting-bunny", "bunny", 9727, 0.94},
             {"chair", "chair", 10000, 0.75},
             {"melting-all", "gargoyle", 6976, 1.06},
             {"melting-logo", "Sibgrapi", 12900, 0.92}};
enum { SCENES = sizeof PAPER / sizeof *PAPER, LEAD = 25 };

static double paper_ns(size_t scene)
{
    return 1e9 * PAPER[scene].seconds / PAPER[scene].particles;
}

/* Factor from times per step to times per substep. */
static double per_substep(const cli_bench_case *c)
{
    return c->substeps > 0 ? 1 / c->substeps : 0;
}

static void print_table2(const cli_bench_cases *cases, const cli_bench_arguments *a)
{
    char stage[CLI_BENCH_MAX_STAGES][32];
    const uint32_t stages = cli_bench_all_stages(cases, stage);
    cli_bench_print_head(a, " from step 25 on, medians; ns per particle and substep");
    printf("%-15s %6s %6s %8s %8s %8s %13s %9s | %-9s %7s %9s %8s\n", "scene", "n", "neigh.", "substeps", "solver",
           "ns", "least-most", "substep", "paper", "n", "iteration", "times");
    for (uint32_t i = 0; i < cases->count; i++) {
        const cli_bench_case *c = &cases->item[i];
        const double scale = per_substep(c), ns = scale * cli_bench_total(c);
        printf("%-15s %6u %6.1f %8.1f %8.2f", c->name, c->particles, c->neighbours, c->substeps, c->iterations);
        cli_bench_print_spread(c, scale);
        printf(" %6.2f ms | %-9s %7u %7.0f ms %8.0f\n", 1e-6 * ns * c->particles, PAPER[i].paper, PAPER[i].particles,
               1e3 * PAPER[i].seconds, paper_ns(i) / ns);
    }
    printf("\n%-15s", "stage");
    for (uint32_t i = 0; i < cases->count; i++)
        printf(" %15s", cases->item[i].name);
    putchar('\n');
    for (uint32_t s = 0; s < stages; s++) {
        printf("%-15s", stage[s]);
        for (uint32_t i = 0; i < cases->count; i++)
            printf(" %15.1f", per_substep(&cases->item[i]) * cli_bench_stage(&cases->item[i], stage[s]));
        putchar('\n');
    }
    puts(
        "\nsubsteps: per step; solver: iterations of conjugate gradients per substep. The paper: Paiva, Petronetto,\n"
        "Lewiner, Tavares, \"Particle-based non-Newtonian fluid animation for melting objects\", Table 2, on a\n"
        "Pentium 4 of 2.4 GHz; times: how many times longer its iteration took per particle.");
}

static void list_table2(const cli_bench_cases *cases, const cli_bench_arguments *a)
{
    cli_bench_table table = {.json = a->json};
    for (uint32_t i = 0; i < cases->count; i++) {
        const cli_bench_case *c = &cases->item[i];
        const double scale = per_substep(c);
        cli_bench_cell_text(&table, "case", c->name);
        cli_bench_cell_whole(&table, "particles", c->particles);
        cli_bench_cell_number(&table, "neighbours", 2, c->neighbours);
        cli_bench_cell_number(&table, "substeps", 2, c->substeps);
        cli_bench_cell_number(&table, "iterations", 2, c->iterations);
        cli_bench_cell_number(&table, "ns_substep_median", 2, scale * cli_bench_total(c));
        cli_bench_cell_number(&table, "ns_substep_least", 2, scale * cli_bench_least(c->total, c->repetitions));
        cli_bench_cell_number(&table, "ns_substep_largest", 2, scale * cli_bench_largest(c->total, c->repetitions));
        cli_bench_cell_number(&table, "paper_ns_iteration", 0, paper_ns(i));
        cli_bench_cell_stages(&table, cases, c, 2, scale);
        cli_bench_cell_run(&table, c, a);
        cli_bench_end_row(&table);
    }
}

int cli_bench_run_table2(cli_bench_arguments *a)
{
    cli_bench_cases cases = {0};
    for (size_t s = 0; s < SCENES; s++) {
        cli_bench_case *c = cli_bench_add(&cases, PAPER[s].scene, 0);
        if (!c)
            return cli_bench_no_memory(&cases);
        c->window = 0;
        c->lead = LEAD;
        if (a->particles)
            c->scene.particles = a->particles;
    }
    const int status = cli_bench_measure(&cases, a);
    if (status == CLI_DONE)
        (a->csv || a->json ? list_table2 : print_table2)(&cases, a);
    cli_bench_release(&cases);
    return status;
}
