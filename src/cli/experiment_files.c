/* Writes what an experiment measured: a CSV file of every step, and a plot. */
#include "cli/experiment.h"

#include <stdlib.h>
#include <string.h>

#include "cli/steps.h"

static void name_of(const cli_experiment *e, bool small, char name[CLI_FILE_NAME])
{
    snprintf(name, CLI_FILE_NAME, "%s%s", e->name, small ? "-small" : "");
}

static int path_of(const cli_result *r, const char *folder, const char *ending, char path[CLI_FILE_PATH])
{
    char name[CLI_FILE_NAME];
    name_of(r->experiment, r->small, name);
    return cli_results_path(folder, name, ending, path);
}

static void write_rows(FILE *file, const void *data)
{
    const cli_result *r = data;
    const cli_experiment *e = r->experiment;
    fputs("variant,seed,step,time", file);
    for (uint32_t c = 0; c < r->columns; c++)
        fprintf(file, ",%s", e->column[c].name);
    fputc('\n', file);
    for (size_t run = 0; run < (size_t)r->variants * r->seeds; run++) {
        const cli_series *s = &r->series[run];
        for (size_t row = 0; row < s->rows; row++) {
            char number[32];
            rheo__number_text(s->time[row], number, sizeof number);
            fprintf(file, "\"%s\",%u,%zu,%s", e->variant[run / r->seeds].name, (unsigned)(run % r->seeds + 1), row,
                    number);
            for (uint32_t c = 0; c < r->columns; c++) {
                rheo__number_text(s->value[row * r->columns + c], number, sizeof number);
                fprintf(file, ",%s", number);
            }
            fputc('\n', file);
        }
    }
}

static int write_csv(const cli_result *r, const char *folder)
{
    char path[CLI_FILE_PATH];
    const int status = path_of(r, folder, ".csv", path);
    return status == CLI_DONE ? cli_write_file(path, write_rows, r) : status;
}

/* The curves of a column: the variants, with the seeds of one in one colour. */
static rheo_plot_curve *curves_of(const cli_result *r, uint32_t column, double *values, size_t *count)
{
    rheo_plot_curve *curve = calloc((size_t)r->variants * r->seeds, sizeof *curve);
    for (*count = 0; curve && *count < (size_t)r->variants * r->seeds; ++*count) {
        const cli_series *s = &r->series[*count];
        const uint32_t variant = (uint32_t)(*count / r->seeds);
        const double *x = s->time;
        if (r->experiment->against_first) {
            for (size_t row = 0; row < s->rows; row++)
                values[row] = s->value[row * s->columns];
            x = values;
            values += s->rows;
        }
        for (size_t row = 0; row < s->rows; row++)
            values[row] = s->value[row * s->columns + column];
        curve[*count] =
            (rheo_plot_curve){r->experiment->variant[variant].name, s->rows, x, values, RHEO_PLOT_LINE, variant};
        values += s->rows;
    }
    return curve;
}

/* The curves of a figure against the first one: the middle values of the seeds. */
static rheo_plot_curve *curves_of_figure(const cli_result *r, uint32_t figure, double *values, size_t *count)
{
    const uint32_t points = r->experiment->curve_variants;
    rheo_plot_curve *curve = calloc(r->variants / points, sizeof *curve);
    for (*count = 0; curve && *count < r->variants / points; ++*count) {
        const uint32_t first = (uint32_t)*count * points;
        double *x = values + 2 * first, *y = x + points, range[3];
        for (uint32_t v = 0; v < points; v++) {
            cli_figure_range(r, first + v, 0, range);
            x[v] = range[1];
            cli_figure_range(r, first + v, figure, range);
            y[v] = range[1];
        }
        const char *name = strstr(r->experiment->variant[first].name, ", ");
        curve[*count] = (rheo_plot_curve){name ? name + 2 : NULL, points, x, y, RHEO_PLOT_POINTS, (uint32_t)*count};
    }
    return curve;
}

static int write_plot(const cli_result *r, const char *folder)
{
    const cli_experiment *e = r->experiment;
    char path[CLI_FILE_PATH], title[160], x_label[64], label[CLI_MOST_COLUMNS][64];
    int status = path_of(r, folder, ".svg", path);
    if (status != CLI_DONE)
        return status;
    snprintf(title, sizeof title, "%s (%s)", e->name, e->reference);
    rheo_plot_panel panel[CLI_MOST_COLUMNS] = {{0}};
    rheo_plot_curve *curve[CLI_MOST_COLUMNS] = {NULL};
    double *values[CLI_MOST_COLUMNS] = {NULL};
    bool enough = true;
    for (uint32_t c = 0; c < e->panels; c++) {
        const bool figures = e->curve_variants > 0;
        const cli_quantity *first = figures ? e->figure : e->column, time = {"time", "T", NULL},
                           *x = figures || e->against_first ? first : &time;
        const uint32_t shown = c + (x == first);
        values[c] = malloc((size_t)r->variants * r->seeds * 2 * ((size_t)r->steps + 2) * sizeof *values[c]);
        if (values[c])
            curve[c] = (figures ? curves_of_figure : curves_of)(r, shown, values[c], &panel[c].curve_count);
        enough = enough && curve[c];
        snprintf(label[c], sizeof label[c], "%s, %s", first[shown].name, first[shown].unit);
        snprintf(x_label, sizeof x_label, "%s, %s", x->name, x->unit);
        panel[c].x = (rheo_plot_axis){x_label, figures ? RHEO_PLOT_LOGARITHMIC : RHEO_PLOT_LINEAR, 0, 0};
        panel[c].y = (rheo_plot_axis){label[c], panel[c].x.scale, 0, 0};
        panel[c].curve = curve[c];
    }
    const uint32_t columns = e->panels > 3 ? (e->panels + 1) / 2 : e->panels; /* one row, or two */
    rheo_error error = {""};
    rheo_result result = RHEO_ERROR_MEMORY;
    if (enough)
        result = rheo_plot_write(&(rheo_plot){title, e->about, e->panels, panel, columns}, path, true, &error);
    else
        snprintf(error.message, sizeof error.message, "no memory for the plot of %s", e->name);
    for (uint32_t c = 0; c < e->panels; c++) {
        free(curve[c]);
        free(values[c]);
    }
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

int cli_experiment_check_files(const cli_experiment *e, bool small, const char *folder)
{
    char name[CLI_FILE_NAME];
    name_of(e, small, name);
    return cli_check_results(folder, name, e->panels > 0);
}

int cli_experiment_write(const cli_result *result, const char *folder)
{
    const int status = write_csv(result, folder);
    return status == CLI_DONE && result->experiment->panels ? write_plot(result, folder) : status;
}
