/* The plot of `rheolog bench predictor`: the largest value of a measure in each scene against what became of it. */
#include "cli/bench_predictor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PANELS = 9, OUTCOMES = 2 };

static const struct {
    uint32_t group;
    const char *measure;
} SHOWN[PANELS] = {{CLI_PREDICTOR_SUMMED, "pressure_number"},
                   {CLI_PREDICTOR_SUMMED, "near_pressure_number"},
                   {CLI_PREDICTOR_SUMMED, "kappa_sum"},
                   {CLI_PREDICTOR_SEQUENTIAL, "pressure_number"},
                   {CLI_PREDICTOR_SEQUENTIAL, "near_pressure_number"},
                   {CLI_PREDICTOR_SEQUENTIAL, "kappa"},
                   {CLI_PREDICTOR_MELTING, "substep_courant_number"},
                   {CLI_PREDICTOR_MELTING, "viscous_number"},
                   {CLI_PREDICTOR_MELTING, "heat_number"}};

/* Numbers beyond these are drawn at the edge, so that one scene does not hide the others. */
static double within(double value, double low, double high)
{
    return value != value ? high : fmin(fmax(value, low), high);
}

/* How far the fluid is beyond what anything could give it: the larger of the two fractions of the verdict. */
static double excess(const cli_predictor_run *run)
{
    return within(fmax(run->energy, run->speed), 1e-3, 1e3);
}

/* Splits the scenes of a panel into two curves, of scenes that stayed well and that blew up. */
static void fill(const cli_predictor_results *r, uint32_t panel, uint32_t m, double *x[OUTCOMES], double *y[OUTCOMES],
                 size_t count[OUTCOMES])
{
    const double limit = r->group[SHOWN[panel].group].item[m].limit;
    for (uint32_t i = 0; i < r->count; i++) {
        const cli_predictor_run *run = &r->run[i];
        if (run->group != SHOWN[panel].group || !run->measure[m].measured)
            continue;
        const uint32_t bad = run->reason != CLI_PREDICTOR_WELL;
        x[bad][count[bad]] = within(run->measure[m].most / limit, 1e-3, 1e3);
        y[bad][count[bad]++] = run->reason == CLI_PREDICTOR_FAILED ? 1e3 : excess(run);
    }
}

int cli_predictor_plot(const cli_predictor_results *r, const char *path)
{
    static const char *const NAMES[OUTCOMES] = {"stayed well", "blew up"};
    rheo_plot_panel panel[PANELS] = {{0}};
    rheo_plot_curve curve[PANELS][OUTCOMES];
    char title[PANELS][80];
    rheo_error error = {""};
    double *values = calloc((size_t)PANELS * OUTCOMES * 2 * (r->count + 1), sizeof *values), *free_part = values;
    if (!values)
        return cli_fail(CLI_SYSTEM, "no memory for the plot of the predictor");
    for (uint32_t p = 0; p < PANELS; p++) {
        const cli_predictor_group_measures *g = &r->group[SHOWN[p].group];
        double *x[OUTCOMES], *y[OUTCOMES];
        size_t count[OUTCOMES] = {0, 0};
        uint32_t m = 0;
        for (int o = 0; o < OUTCOMES; o++) {
            x[o] = free_part;
            y[o] = free_part + r->count;
            free_part += 2 * (size_t)r->count;
        }
        while (m < g->count && strcmp(g->item[m].name, SHOWN[p].measure) != 0)
            m++;
        if (m < g->count)
            fill(r, p, m, x, y, count);
        for (uint32_t o = 0; o < OUTCOMES; o++)
            curve[p][o] = (rheo_plot_curve){NAMES[o], count[o], x[o], y[o], RHEO_PLOT_POINTS, o};
        snprintf(title[p], sizeof title[p], "%s: %s", cli_predictor_group_name[SHOWN[p].group], SHOWN[p].measure);
        for (char *at = title[p]; *at; at++) /* "_" would begin a subscript */
            if (*at == '_')
                *at = ' ';
        panel[p] = (rheo_plot_panel){title[p],
                                     {"largest value, in bounds", RHEO_PLOT_LOGARITHMIC, 1e-3, 1e3},
                                     {"energy or speed, in parts of those put in", RHEO_PLOT_LOGARITHMIC, 1e-3, 1e3},
                                     OUTCOMES,
                                     curve[p]};
    }
    const rheo_plot plot = {"Measures of random scenes, and what became of them",
                            "The largest value of a measure up to the blow-up, divided by its bound, against the "
                            "largest energy or speed, divided by what was put in. Each point is a scene.",
                            PANELS, panel, 3};
    const rheo_result result = rheo_plot_write(&plot, path, true, &error);
    free(values);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}
