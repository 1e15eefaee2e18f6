/* Prints the points of `rheolog bench error`, and writes them as CSV files and plots. */
#include "cli/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/steps.h"

/* ---- Rows ---- */

/* Six digits, in the units of the member. */
static void cell(cli_bench_table *table, const char *name, double value)
{
    cli_bench_cell_number(table, name, -5, value);
}

static const char *model_of(const cli_error_study *study)
{
    return study->model ? study->model : "both";
}

void cli_error_rows(const cli_error_study *study, const cli_error_points *points, cli_bench_table *table)
{
    for (size_t i = 0; i < points->count; i++) {
        const cli_error_point *p = &points->item[i];
        char hash[17];
        snprintf(hash, sizeof hash, "%016llx", (unsigned long long)p->hash);
        cli_bench_cell_text(table, "study", study->name);
        cli_bench_cell_text(table, "model", model_of(study));
        cli_bench_cell_text(table, "scene", p->scene);
        cli_bench_cell_text(table, "setting", p->setting);
        cli_bench_cell_text(table, "series", p->series);
        cell(table, "refinement", p->refinement);
        cli_bench_cell_text(table, "quantity", p->quantity);
        cell(table, "value", p->value);
        cell(table, "reference", p->reference);
        cell(table, "error", p->error);
        cli_bench_cell_number(table, "ns_step", 3, p->ns_step);
        cli_bench_cell_number(table, "us_time", 4, p->us_time);
        cli_bench_cell_number(table, "bytes", 1, p->bytes);
        cli_bench_cell_number(table, "substeps", 0, p->substeps);
        cli_bench_cell_number(table, "iterations", 2, p->iterations);
        cli_bench_cell_whole(table, "particles", p->particles);
        cli_bench_cell_whole(table, "steps", p->steps);
        cli_bench_cell_text(table, "hash", p->hash ? hash : "");
        cli_bench_cell_number(table, "order", 2, p->order);
        cli_bench_cell_whole(table, "front", p->front);
        cli_bench_cell_build(table);
        cli_bench_end_row(table);
    }
}

/* ---- Groups: the points of one scene and quantity ---- */

typedef struct group {
    const cli_error_point **point;
    size_t count;
} group;

/* Whether an earlier point has the same scene and quantity. */
static bool is_repeated(const cli_error_points *points, size_t i)
{
    for (size_t k = 0; k < i; k++)
        if (strcmp(points->item[k].scene, points->item[i].scene) == 0 &&
            strcmp(points->item[k].quantity, points->item[i].quantity) == 0)
            return true;
    return false;
}

/* Finds the group whose first point is number i. `g->point` has room for all points. */
static void find_group(const cli_error_points *points, size_t i, group *g)
{
    g->count = 0;
    for (size_t k = i; k < points->count; k++)
        if (strcmp(points->item[k].scene, points->item[i].scene) == 0 &&
            strcmp(points->item[k].quantity, points->item[i].quantity) == 0)
            g->point[g->count++] = &points->item[k];
}

/* ---- Text ---- */

typedef struct column {
    const char *head, *format;
    size_t at; /* of a double in the point */
} column;

static double number_of(const cli_error_point *p, const column *c)
{
    double value;
    memcpy(&value, (const char *)p + c->at, sizeof value);
    return value;
}

static void print_group(const group *g)
{
    static const column COLUMNS[] = {{"value", "%11.4g", offsetof(cli_error_point, value)},
                                     {"error", "%+11.2e", offsetof(cli_error_point, error)},
                                     {"order", "%11.2f", offsetof(cli_error_point, order)},
                                     {"ns/step", "%11.1f", offsetof(cli_error_point, ns_step)},
                                     {"us/time", "%11.2f", offsetof(cli_error_point, us_time)},
                                     {"bytes", "%11.0f", offsetof(cli_error_point, bytes)},
                                     {"substeps", "%11.0f", offsetof(cli_error_point, substeps)},
                                     {"iterations", "%11.2f", offsetof(cli_error_point, iterations)}};
    enum { MOST = sizeof COLUMNS / sizeof *COLUMNS };
    bool has[MOST] = {false};
    int width = (int)strlen("setting");
    for (size_t i = 0; i < g->count; i++) {
        width = (int)strlen(g->point[i]->setting) > width ? (int)strlen(g->point[i]->setting) : width;
        for (int c = 0; c < MOST; c++)
            has[c] = has[c] || !isnan(number_of(g->point[i], &COLUMNS[c]));
    }
    const cli_error_point *first = g->point[0];
    printf("\n%s, %s", first->scene, first->quantity);
    if (first->particles)
        printf("; %u particles", first->particles);
    if (!isnan(first->reference))
        printf("; reference %.5g", first->reference);
    printf("\n  %-*s", width, "setting");
    for (int c = 0; c < MOST; c++)
        if (has[c])
            printf(" %11s", COLUMNS[c].head);
    putchar('\n');
    for (size_t i = 0; i < g->count; i++) {
        printf("%c %-*s", g->point[i]->front ? '*' : ' ', width, g->point[i]->setting);
        for (int c = 0; c < MOST; c++) {
            const double value = number_of(g->point[i], &COLUMNS[c]);
            if (!has[c])
                continue;
            putchar(' ');
            if (isnan(value))
                printf("%11s", "-");
            else
                printf(COLUMNS[c].format, value);
        }
        putchar('\n');
    }
}

void cli_error_print(const cli_error_study *study, const cli_error_points *points)
{
    group g = {malloc((points->count + 1) * sizeof *g.point), 0};
    printf("%s (%s): %s\n%s, %s, %s, simd %s\n", study->name, model_of(study), study->title, cli_bench_machine(),
           cli_compiler(), cli_real(), rheo_simd());
    for (size_t i = 0; g.point && i < points->count; i++) {
        if (is_repeated(points, i))
            continue;
        find_group(points, i, &g);
        print_group(&g);
    }
    free(g.point);
}

/* ---- Files ---- */

enum { PATH = 4096 + 300 };

/* Appends a name with other characters than letters, digits, dots and hyphens replaced. */
static void append_name(char *path, const char *name)
{
    size_t n = strlen(path);
    for (; *name && n + 1 < PATH; name++) {
        const char c = *name;
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.';
        if (plain)
            path[n++] = c;
        else if (path[n - 1] != '-')
            path[n++] = '-';
    }
    path[n] = 0;
}

static void path_of(const cli_error_study *study, const cli_error_point *first, const char *folder, char path[PATH])
{
    snprintf(path, PATH, "%.4096s/error-%s", folder, study->name);
    if (first) {
        append_name(path, "-");
        append_name(path, first->scene);
        append_name(path, "-");
        append_name(path, first->quantity);
    }
    const size_t n = strlen(path);
    snprintf(path + n, PATH - n, first ? ".svg" : ".csv");
}

int cli_error_check_files(const cli_error_study *study, const char *folder)
{
    char path[PATH];
    if (strlen(folder) > 4096)
        return cli_fail(CLI_BAD, "the name after -o is too long: %zu bytes", strlen(folder));
    path_of(study, NULL, folder, path);
    const int status = cli_refuse_existing(path, true);
    return status == CLI_DONE ? cli_check_folder(path) : status;
}

typedef struct rows {
    const cli_error_study *study;
    const cli_error_points *points;
} rows;

static void put_rows(FILE *file, const void *data)
{
    const rows *r = data;
    cli_bench_table table = {.file = file};
    cli_error_rows(r->study, r->points, &table);
}

/* Unknown costs come last: qsort() needs an order. */
static int by_cost(const void *a, const void *b)
{
    const cli_error_point *const *p = a, *const *q = b;
    const double x = cli_error_cost(*p), y = cli_error_cost(*q);
    return isnan(x) || isnan(y) ? isnan(x) - isnan(y) : (x > y) - (x < y);
}

/*
 * Collects the curves of a group: the front as a line, and each series as points. `curve` has room for one more than the
 * points, `number` for four numbers per point. Returns the number of curves; 0: nothing can be drawn.
 */
static size_t curves_of(group *g, rheo_plot_curve *curve, double *number)
{
    qsort(g->point, g->count, sizeof *g->point, by_cost);
    size_t curves = 1, drawn = 0;
    double *x = number, *y = number + g->count;
    curve[0] = (rheo_plot_curve){"front", 0, x, y, RHEO_PLOT_LINE, 0};
    for (size_t i = 0; i < g->count; i++)
        if (g->point[i]->front && g->point[i]->error != 0) {
            x[curve[0].count] = cli_error_cost(g->point[i]);
            y[curve[0].count++] = fabs(g->point[i]->error);
        }
    x = number + 2 * g->count;
    y = number + 3 * g->count;
    for (size_t i = 0; i < g->count; i++) {
        bool seen = false;
        for (size_t k = 0; k < i; k++)
            seen = seen || strcmp(g->point[k]->series, g->point[i]->series) == 0;
        if (seen)
            continue;
        rheo_plot_curve *c = &curve[curves];
        const char *series = g->point[i]->series;
        *c = (rheo_plot_curve){*series ? series : "others", 0, x, y, RHEO_PLOT_POINTS, (uint32_t)curves};
        for (size_t k = i; k < g->count; k++) {
            const cli_error_point *p = g->point[k];
            if (strcmp(p->series, series) != 0 || !(cli_error_cost(p) > 0) || !(fabs(p->error) > 0))
                continue;
            x[c->count] = cli_error_cost(p);
            y[c->count++] = fabs(p->error);
        }
        drawn += c->count;
        x += c->count;
        y += c->count;
        curves++;
    }
    return drawn ? curves : 0;
}

static int write_plot(const cli_error_study *study, group *g, const char *folder)
{
    char path[PATH], title[160];
    rheo_plot_curve *curve = calloc(g->count + 1, sizeof *curve);
    double *number = malloc(4 * g->count * sizeof *number);
    rheo_error error = {"no memory for the plots"};
    rheo_result result = RHEO_ERROR_MEMORY;
    const cli_error_point *first = g->point[0];
    const bool timed = !isnan(first->us_time);
    snprintf(title, sizeof title, "%s: %s, %s", study->name, first->scene, first->quantity);
    path_of(study, first, folder, path);
    const size_t curves = curve && number ? curves_of(g, curve, number) : 0;
    if (curves) {
        const rheo_plot_panel panel = {
            .x = {timed ? "cost, µs per particle and unit of time" : "cost, ns per particle and step",
                  RHEO_PLOT_LOGARITHMIC, 0, 0},
            .y = {"error", RHEO_PLOT_LOGARITHMIC, 0, 0},
            .curve_count = curves,
            .curve = curve};
        result = rheo_plot_write(&(rheo_plot){title, study->title, 1, &panel, 1}, path, true, &error);
    } else if (curve && number) {
        result = RHEO_OK;
    }
    free(curve);
    free(number);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

int cli_error_write(const cli_error_study *study, const cli_error_points *points, const char *folder)
{
    char path[PATH];
    path_of(study, NULL, folder, path);
    int status = cli_write_file(path, put_rows, &(rows){study, points});
    group g = {malloc((points->count + 1) * sizeof *g.point), 0};
    if (!g.point)
        return cli_fail(CLI_SYSTEM, "no memory for the plots of %s", study->name);
    for (size_t i = 0; status == CLI_DONE && i < points->count; i++) {
        if (is_repeated(points, i))
            continue;
        find_group(points, i, &g);
        status = write_plot(study, &g, folder);
    }
    free(g.point);
    return status;
}
