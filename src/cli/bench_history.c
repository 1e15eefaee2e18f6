/* rheolog bench history: cost, bytes and error of D^q for every kind of history with several windows. */
#include "cli/bench.h"

static void print_history(const cli_bench_cases *cases, const cli_bench_arguments *a)
{
    cli_bench_print_head(a, cli_bench_per_step);
    printf("%-13s %6s %8s %8s %13s %9s %8s %12s %10s\n", "kind", "d", "n", "all", "least-most", "D^q", "storing",
           "bytes/part.", "error");
    for (uint32_t i = 0; i < cases->count; i++) {
        const cli_bench_case *c = &cases->item[i];
        printf("%-13s %6u %8u", c->kind, c->window, c->particles);
        cli_bench_print_spread(c, 1);
        printf(" %9.2f %8.2f %12.0f", cli_bench_stage(c, "fractional_derivative"), cli_bench_stage(c, "history"),
               cli_bench_per_particle(c, c->history_bytes));
        if (c->error == c->error)
            printf(" %10.1e", c->error);
        else
            printf(" %10s", "-");
        putchar('\n');
    }
    puts(
        "\nD^q: stage fractional_derivative; storing: stage history. error: largest difference between D^q and the\n"
        "plain sum in double over the same velocities, as a fraction of the largest D^q, for 32 particles after the\n"
        "steps that fill the window (kinds full and tempered: sum over all steps; -: no such sum is known).");
}

static void own_cells(cli_bench_table *table, const cli_bench_cases *cases, const cli_bench_case *c)
{
    (void)cases;
    cli_bench_cell_number(table, "error", -3, c->error);
}

int cli_bench_run_history(cli_bench_arguments *a)
{
    cli_bench_cases cases = {0};
    const rheo_parameter *kind = rheo_scene_parameter_find("history.kind");
    int status = CLI_DONE;
    for (uint32_t k = 0; k < kind->choice_count && status == CLI_DONE; k++)
        for (uint32_t w = 0; w < a->windows && status == CLI_DONE; w++) {
            cli_bench_case *c = cli_bench_add(&cases, "bowling-ball", a->particles);
            if (!c) {
                status = cli_bench_no_memory(&cases);
                break;
            }
            cli_bench_set_window(c, a->window[w]);
            c->with_error = a->window[w] > 0;
            c->scene.world.history.kind = (rheo_history_kind)k;
        }
    if (status == CLI_DONE)
        return cli_bench_report(&cases, a, print_history, own_cells);
    cli_bench_release(&cases);
    return status;
}
