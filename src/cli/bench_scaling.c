/* rheolog bench scaling: time and memory per particle in pools of 20 000 to 2 million particles. */
#include "cli/bench.h"

#include <math.h>

static void print_scaling(const cli_bench_cases *cases, const cli_bench_arguments *a)
{
    cli_bench_print_head(a, cli_bench_per_step);
    printf("%9s %8s %13s %7s %11s %11s %9s %9s %9s\n", "particles", "all", "least-most", "ratio", "neighbours",
           "step", "state", "world", "process");
    for (uint32_t i = 0; i < cases->count; i++) {
        const cli_bench_case *c = &cases->item[i];
        printf("%9u", c->particles);
        cli_bench_print_spread(c, 1);
        printf(" %7.2f %11.1f %9.1f ms %9.0f %9.0f", cli_bench_total(c) / cli_bench_total(&cases->item[0]),
               c->neighbours, 1e-6 * cli_bench_total(c) * c->particles, cli_bench_per_particle(c, c->field_bytes),
               cli_bench_per_particle(c, c->world_bytes));
        if (c->process_bytes)
            printf(" %9.0f\n", cli_bench_per_particle(c, c->process_bytes));
        else
            printf(" %9s\n", "-");
    }
    printf("\nA pool as deep as that of bowling-ball, with its ball, d = %u. Bytes per particle: state: hashed and\n"
           "saved; world: all memory of the library between two steps; process: largest growth of the process while\n"
           "the scene was filled, settled and stepped.\n",
           cases->item[0].window);
}

static void own_cells(cli_bench_table *table, const cli_bench_cases *cases, const cli_bench_case *c)
{
    cli_bench_cell_number(table, "bytes_process", 1,
                          c->process_bytes ? cli_bench_per_particle(c, c->process_bytes) : NAN);
    cli_bench_cell_number(table, "ratio", 3, cli_bench_total(c) / cli_bench_total(&cases->item[0]));
}

int cli_bench_run_scaling(cli_bench_arguments *a)
{
    static const uint64_t sizes[] = {20000, 100000, 500000, 2000000};
    enum { SMALL_WINDOW = 4 }; /* saves memory */
    cli_bench_cases cases = {0};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        if (s > 0 && sizes[s] > a->particles)
            break;
        cli_bench_case *c = cli_bench_add(&cases, "bowling-ball", sizes[s] < a->particles ? sizes[s] : a->particles);
        if (!c)
            return cli_bench_no_memory(&cases);
        cli_bench_set_window(c, SMALL_WINDOW);
        c->scene.settle.time = .5;
    }
    return cli_bench_report(&cases, a, print_scaling, own_cells);
}
