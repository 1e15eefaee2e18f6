/* rheolog bench error: speed against error of the models. */
#include "cli/bench.h"

#include <string.h>

const char *const cli_bench_quantity[CLI_BENCH_QUANTITIES] = {"dip",      "rise",    "depth_5", "depth_10",
                                                              "time_1_5", "rebound", "height_9"};

void cli_bench_print_error_row(cli_bench_table *table, const cli_bench_error_row *row)
{
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)row->hash);
    cli_bench_cell_text(table, "case", row->scene);
    cli_bench_cell_text(table, "setting", row->setting);
    cli_bench_cell_whole(table, "particles", row->particles);
    cli_bench_cell_whole(table, "steps", row->steps);
    cli_bench_cell_number(table, "substeps", 0, row->substeps);
    cli_bench_cell_number(table, "iterations", 2, row->iterations);
    cli_bench_cell_number(table, "ns_particle_step", 0, row->ns_step);
    cli_bench_cell_number(table, "ns_particle_time", 0, row->ns_time);
    cli_bench_cell_number(table, "error", -3, row->error);
    cli_bench_cell_number(table, "hot_height_error", -3, row->hot_height_error);
    for (int q = 0; q < CLI_BENCH_QUANTITIES; q++) {
        char name[32];
        snprintf(name, sizeof name, "%s_error", cli_bench_quantity[q]);
        cli_bench_cell_number(table, cli_bench_quantity[q], 4, row->quantity[q]);
        cli_bench_cell_number(table, name, -3, row->quantity_error[q]);
    }
    cli_bench_cell_text(table, "hash", hash);
    cli_bench_cell_build(table);
    cli_bench_end_row(table);
}

int cli_bench_run_error(cli_bench_arguments *a)
{
    static const struct {
        const char *model;
        int (*run)(cli_bench_arguments *a, cli_bench_table *table);
    } models[] = {{"thickening", cli_bench_error_thickening}, {"melting", cli_bench_error_melting}};
    cli_bench_table table = {.json = a->json};
    int status = CLI_BAD;
    for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
        if (a->model && strcmp(a->model, models[i].model) != 0)
            continue;
        if (i > 0 && !a->model && !a->csv && !a->json)
            puts("");
        if ((status = models[i].run(a, &table)) != CLI_DONE)
            return status;
    }
    return status != CLI_BAD ? status
                             : cli_usage(&cli_bench, "--model is thickening or melting; got \"%s\"", a->model);
}
