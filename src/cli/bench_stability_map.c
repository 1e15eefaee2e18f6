/* The map of `rheolog bench stability` as text, rows of CSV and JSON, and a plot. */
#include "cli/bench_stability.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/steps.h"

/* ---- Rows ---- */

void cli_stability_rows(const cli_stability_map *map, cli_bench_table *table)
{
    for (size_t i = 0; i < (size_t)map->solvers * map->steps * map->ratios; i++) {
        const cli_stability_cell *c = &map->cell[i];
        char hash[17], settings[96], bad[24] = "";
        cli_stability_settings(c->solver, settings, sizeof settings);
        snprintf(hash, sizeof hash, "%016llx", (unsigned long long)c->hash);
        if (!c->stable)
            snprintf(bad, sizeof bad, "%llu", (unsigned long long)c->bad_step);
        cli_bench_cell_text(table, "solver", c->solver->name);
        cli_bench_cell_text(table, "settings", settings);
        cli_bench_cell_number(table, "step", 5, c->step);
        cli_bench_cell_number(table, "k_min", 3, map->stiffness);
        cli_bench_cell_number(table, "ratio", 3, c->ratio);
        cli_bench_cell_text(table, "stable", c->stable ? "yes" : "no");
        cli_bench_cell_text(table, "bad_step", bad);
        cli_bench_cell_text(table, "sign", c->sign);
        cli_bench_cell_number(table, "kappa", 4, c->kappa);
        cli_bench_cell_number(table, "kappa_sum", 4, c->kappa_sum);
        cli_bench_cell_number(table, "substeps", 2, c->substeps);
        cli_bench_cell_number(table, "softened_springs", 0, c->softened);
        cli_bench_cell_number(table, "dip", 4, c->dip);
        cli_bench_cell_number(table, "rise", 4, c->rise);
        cli_bench_cell_number(table, "ns_step", 1, c->ns);
        cli_bench_cell_whole(table, "particles", map->particles);
        cli_bench_cell_whole(table, "steps", c->steps);
        cli_bench_cell_text(table, "hash", hash);
        cli_bench_cell_build(table);
        cli_bench_end_row(table);
    }
}

/* ---- Text ---- */

static void print_cell(const cli_stability_cell *c)
{
    char text[32];
    if (!c->stable)
        snprintf(text, sizeof text, "x %llu", (unsigned long long)c->bad_step);
    else if (isnan(c->dip))
        snprintf(text, sizeof text, "sinks");
    else
        snprintf(text, sizeof text, "%s%.2f", c->softened > 0 ? "~" : "", c->dip);
    printf(" %9s", text);
}

void cli_stability_print(const cli_stability_map *map)
{
    printf("a ball falls into a pool of %u particles: k_min = %g, %g units of time; %s, simd %s\n", map->particles,
           map->stiffness, map->time, cli_real(), rheo_simd());
    for (uint32_t s = 0; s < map->solvers; s++) {
        char settings[96];
        cli_stability_settings(map->solver[s], settings, sizeof settings);
        printf("\n%s (%s)\n%10s", map->solver[s]->name, settings, "ratio");
        for (uint32_t r = 0; r < map->ratios; r++)
            printf(" %9g", map->ratio[r]);
        putchar('\n');
        for (uint32_t t = 0; t < map->steps; t++) {
            printf("step %5g", map->step[t]);
            for (uint32_t r = 0; r < map->ratios; r++)
                print_cell(cli_stability_at(map, s, t, r));
            putchar('\n');
        }
    }
    puts(
        "\nratio: k_hist/k_min. A number is the depth of the first dip of a stable run, in radii; ~: springs were softened;\n"
        "sinks: the ball does not turn; x N: unstable since step N. A run is unstable if a step fails, a severe measure of\n"
        "the doctor leaves its range, or the ball rises above the height from which it fell.");
}

/* ---- Files ---- */

enum { KINDS = 3 };

int cli_stability_check_files(const char *folder)
{
    return cli_check_results(folder, "stability", true);
}

static void put_rows(FILE *file, const void *data)
{
    cli_stability_rows(data, &(cli_bench_table){.file = file});
}

/* Stable; stable with springs softened; unstable. */
static uint32_t kind_of(const cli_stability_cell *c)
{
    return !c->stable ? 2 : c->softened > 0;
}

/* The points of a solver. `number` has room for two numbers per cell; returns what is left of it. */
static double *points_of(const cli_stability_map *map, uint32_t solver, rheo_plot_curve curve[KINDS], double *number)
{
    static const char *const NAMES[KINDS] = {"stable", "stable, springs softened", "unstable"};
    static const uint32_t LOOKS[KINDS] = {0, 2, 1};
    for (uint32_t kind = 0; kind < KINDS; kind++) {
        double *x = number, *y = number + (size_t)map->steps * map->ratios;
        curve[kind] = (rheo_plot_curve){NAMES[kind], 0, x, y, RHEO_PLOT_POINTS, LOOKS[kind]};
        for (uint32_t t = 0; t < map->steps; t++)
            for (uint32_t r = 0; r < map->ratios; r++) {
                const cli_stability_cell *c = cli_stability_at(map, solver, t, r);
                if (kind_of(c) != kind)
                    continue;
                x[curve[kind].count] = c->ratio;
                y[curve[kind].count++] = c->step;
            }
        number += 2 * (size_t)map->steps * map->ratios;
    }
    return number;
}

/* A little more than the range of values, so that no point is on the border. */
static rheo_plot_axis axis_of(const char *label, const double *value, uint32_t count)
{
    double least = value[0], most = value[0];
    for (uint32_t i = 1; i < count; i++) {
        least = fmin(least, value[i]);
        most = fmax(most, value[i]);
    }
    return (rheo_plot_axis){label, RHEO_PLOT_LOGARITHMIC, least / 1.5, most * 1.5};
}

static int write_plot(const cli_stability_map *map, const char *path)
{
    rheo_plot_panel panel[CLI_STABILITY_MOST] = {{0}};
    rheo_plot_curve *curve = malloc((size_t)map->solvers * KINDS * sizeof *curve);
    double *numbers = malloc((size_t)map->solvers * map->steps * map->ratios * 2 * KINDS * sizeof *numbers),
           *rest = numbers;
    rheo_error error = {"no memory for the plot"};
    rheo_result result = RHEO_ERROR_MEMORY;
    char title[96];
    snprintf(title, sizeof title, "Stable and unstable runs of a ball scene, k_{min} = %g", map->stiffness);
    for (uint32_t s = 0; curve && numbers && s < map->solvers; s++) {
        rest = points_of(map, s, &curve[s * KINDS], rest);
        panel[s] = (rheo_plot_panel){.title = map->solver[s]->name,
                                     .x = axis_of("k_{hist}/k_{min}", map->ratio, map->ratios),
                                     .y = axis_of("step, T", map->step, map->steps),
                                     .curve_count = KINDS,
                                     .curve = &curve[s * KINDS]};
    }
    if (curve && numbers)
        result =
            rheo_plot_write(&(rheo_plot){title,
                                         "A ball falls into a pool. Each point is a run with a step and a ratio of "
                                         "stiffnesses; each panel is a solver.",
                                         map->solvers, panel, map->solvers < 4 ? map->solvers : 4},
                            path, true, &error);
    free(curve);
    free(numbers);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

int cli_stability_write(const cli_stability_map *map, const char *folder)
{
    char path[CLI_FILE_PATH];
    int status = cli_results_path(folder, "stability", ".csv", path);
    if (status == CLI_DONE)
        status = cli_write_file(path, put_rows, map);
    if (status == CLI_DONE && (status = cli_results_path(folder, "stability", ".svg", path)) == CLI_DONE)
        status = write_plot(map, path);
    return status;
}
