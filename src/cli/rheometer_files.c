/* Files of `rheolog rheometer`: a CSV file and a plot of each table. */
#include "cli/rheometer.h"

#include <stdlib.h>
#include <string.h>

#include "cli/steps.h"

enum { MOST_CURVES = 32 };

/* PROTOCOL of the block; others are named after their instrument, too. */
static void name_of(const cli_measurement *m, const char *protocol, char name[CLI_FILE_NAME])
{
    snprintf(name, CLI_FILE_NAME, "%s%s%s", m->prefix, protocol, m->small ? "-small" : "");
}

static int path_of(const cli_measurement *m, const char *protocol, const char *folder, const char *ending,
                   char path[CLI_FILE_PATH])
{
    char name[CLI_FILE_NAME];
    name_of(m, protocol, name);
    return cli_results_path(folder, name, ending, path);
}

int cli_rheometer_check_files(const cli_measurement *m, const char *protocol, const char *folder)
{
    char name[CLI_FILE_NAME];
    name_of(m, protocol, name);
    return cli_check_results(folder, name, true);
}

static void put_rows(FILE *file, const void *data)
{
    const cli_protocol_table *t = data;
    char text[32];
    for (uint32_t c = 0; c < t->columns; c++)
        fprintf(file, "%s%s", c ? "," : "", t->column[c].name);
    for (size_t row = 0; row < t->rows; row++) {
        putc('\n', file);
        for (uint32_t c = 0; c < t->columns; c++) {
            const double value = t->value[row * t->columns + c];
            rheo_number_text(value, text);
            fprintf(file, "%s%s", c ? "," : "", t->column[c].words ? t->column[c].words[(size_t)value] : text);
        }
    }
    putc('\n', file);
}

/* ---- Plots ---- */

/* A panel with its texts and the coordinates of its curves. */
typedef struct drawing {
    char x_label[64], y_label[64], name[MOST_CURVES][64];
    rheo_plot_curve curve[MOST_CURVES];
    double *values;
} drawing;

static void label_of(const cli_table_column *column, char text[64])
{
    const bool pure = !*column->unit || strcmp(column->unit, "1") == 0;
    snprintf(text, 64, "%s%s%s", column->name, pure ? "" : ", ", pure ? "" : column->unit);
    for (char *at = text; *at; at++) /* "_" would begin a subscript */
        if (*at == '_')
            *at = ' ';
}

/* Splits the rows into curves of equal values of a column. False: no memory. */
static bool draw(const cli_protocol_table *t, const struct cli_table_panel *of, drawing *d, rheo_plot_panel *panel)
{
    const uint32_t x = cli_table_column_of(t, of->x), y = cli_table_column_of(t, of->y);
    const uint32_t by = of->by ? cli_table_column_of(t, of->by) : t->columns;
    d->values = malloc((2 * t->rows + 1) * sizeof *d->values);
    if (!d->values)
        return false;
    double *next = d->values;
    size_t curves = 0;
    for (size_t first = 0; first < t->rows && curves < MOST_CURVES; first++) {
        bool seen = false;
        for (size_t row = 0; row < first && by < t->columns; row++)
            seen = seen || t->value[row * t->columns + by] == t->value[first * t->columns + by];
        if (seen || (by == t->columns && first > 0))
            continue;
        size_t count = 0;
        double *const xs = next, *const ys = next + t->rows;
        for (size_t row = first; row < t->rows; row++)
            if (by == t->columns || t->value[row * t->columns + by] == t->value[first * t->columns + by]) {
                xs[count] = t->value[row * t->columns + x];
                ys[count++] = t->value[row * t->columns + y];
            }
        next += count;
        if (by < t->columns) {
            char text[32];
            const double value = t->value[first * t->columns + by];
            label_of(&t->column[by], d->name[curves]);
            d->name[curves][strcspn(d->name[curves], ",")] = 0;
            if (t->column[by].words)
                snprintf(d->name[curves], 64, "%s", t->column[by].words[(size_t)value]);
            else
                snprintf(d->name[curves] + strlen(d->name[curves]), 64 - strlen(d->name[curves]), " = %s",
                         rheo_number_brief(value, 3, text));
        }
        d->curve[curves] = (rheo_plot_curve){by < t->columns ? d->name[curves] : NULL,       count,           xs, ys,
                                             of->points ? RHEO_PLOT_POINTS : RHEO_PLOT_LINE, (uint32_t)curves};
        curves++;
    }
    const rheo_plot_scale scale = of->logarithmic ? RHEO_PLOT_LOGARITHMIC : RHEO_PLOT_LINEAR;
    label_of(&t->column[x], d->x_label);
    label_of(&t->column[y], d->y_label);
    *panel = (rheo_plot_panel){NULL, {d->x_label, scale, 0, 0}, {d->y_label, scale, 0, 0}, curves, d->curve};
    return true;
}

static int write_plot(const cli_measurement *r, const cli_protocol_table *t, const char *folder)
{
    char path[CLI_FILE_PATH], title[160];
    int status = path_of(r, t->name, folder, ".svg", path);
    if (status != CLI_DONE)
        return status;
    snprintf(title, sizeof title, "rheometer: %s of %s", t->name, r->scene_name);
    drawing *d = calloc(t->panels, sizeof *d);
    rheo_plot_panel panel[CLI_TABLE_PANELS];
    bool enough = d != NULL;
    for (uint32_t i = 0; i < t->panels && enough; i++)
        enough = draw(t, &t->panel[i], &d[i], &panel[i]);
    rheo_error error = {"no memory for a plot"};
    rheo_result result = RHEO_ERROR_MEMORY;
    if (enough)
        result = rheo_plot_write(&(rheo_plot){title, t->about, t->panels, panel, t->panels}, path, true, &error);
    for (uint32_t i = 0; i < t->panels && d; i++)
        free(d[i].values);
    free(d);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

int cli_rheometer_write(const cli_measurement *r, const char *folder)
{
    int status = CLI_DONE;
    for (uint32_t i = 0; i < r->tables && status == CLI_DONE; i++) {
        char path[CLI_FILE_PATH];
        const cli_protocol_table *t = &r->table[i];
        status = path_of(r, t->name, folder, ".csv", path);
        if (status == CLI_DONE)
            status = cli_write_file(path, put_rows, t);
        if (status == CLI_DONE && t->panels && t->rows)
            status = write_plot(r, t, folder);
    }
    return status;
}
