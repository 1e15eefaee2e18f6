/* The metrics of a page as plots, with a table behind them. */
#define _POSIX_C_SOURCE 200809L /* open_memstream() */
#include "cli/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "json/file_name.h"

enum { BINS = 300, TABLE_ROWS = 40, MOST_CURVES = 4 };

typedef struct curve {
    double *x, *y;
    size_t count;
} curve;

/* ---- Curves ---- */

static double value_at(const cli_page_recording *r, uint64_t index, uint32_t metric)
{
    return r->metric[(size_t)index * r->metrics + metric];
}

static void add_point(const cli_page_recording *r, uint32_t metric, uint64_t index, curve *c)
{
    c->x[c->count] = (double)(r->info.first_step + index);
    c->y[c->count++] = value_at(r, index, metric);
}

/* All steps; of many steps in each of some ranges the least and the largest value, in their order. False: no memory. */
static bool take_curve(const cli_page_recording *r, uint32_t metric, curve *c)
{
    const uint64_t bins = r->steps <= 2 * (uint64_t)BINS ? r->steps : (uint64_t)BINS;
    *c = (curve){malloc((2 * (size_t)bins + 1) * sizeof *c->x), malloc((2 * (size_t)bins + 1) * sizeof *c->y), 0};
    for (uint64_t b = 0; c->x && c->y && b < bins; b++) {
        const uint64_t from = b * r->steps / bins, to = (b + 1) * r->steps / bins;
        uint64_t least = from, most = from;
        for (uint64_t i = from + 1; i < to; i++) {
            least = value_at(r, i, metric) < value_at(r, least, metric) ? i : least;
            most = value_at(r, i, metric) > value_at(r, most, metric) ? i : most;
        }
        add_point(r, metric, least < most ? least : most, c);
        if (least != most)
            add_point(r, metric, least < most ? most : least, c);
    }
    return c->x && c->y;
}

static void release(curve *c)
{
    free(c->x);
    free(c->y);
}

/* A logarithmic axis if most values are positive and they have different sizes. */
static rheo_plot_scale scale_of(const curve *c)
{
    double least = INFINITY, most = 0;
    size_t positive = 0;
    for (size_t i = 0; i < c->count; i++)
        if (c->y[i] > 0 && isfinite(c->y[i])) {
            least = c->y[i] < least ? c->y[i] : least;
            most = c->y[i] > most ? c->y[i] : most;
            positive++;
        } else if (c->y[i] < 0) {
            return RHEO_PLOT_LINEAR;
        }
    return positive * 10 >= c->count * 9 && most > 300 * least ? RHEO_PLOT_LOGARITHMIC : RHEO_PLOT_LINEAR;
}

/* ---- Metrics ---- */

/* Steps, times and ids are no curves, and neither are values that never change. */
static bool is_plotted(const cli_page_recording *r, uint32_t metric)
{
    static const char *const ENDINGS[] = {"_id", "_a", "_b"};
    const char *name = rheo_recording_metric_name(r->recording, metric);
    for (size_t i = 0; i < sizeof ENDINGS / sizeof *ENDINGS; i++)
        if (rheo__json_ends_with(name, ENDINGS[i]))
            return false;
    if (strcmp(name, "step") == 0 || strcmp(name, "time") == 0)
        return false;
    for (uint64_t i = 1; i < r->steps; i++)
        if (value_at(r, i, metric) != value_at(r, 0, metric))
            return true;
    return false;
}

static const rheo_finding *finding_of(const cli_page *page, const char *metric)
{
    const rheo_diagnosis *d = &page->f.diagnosis;
    for (uint32_t i = 0; i < d->finding_count; i++)
        if (strcmp(d->findings[i].measure, metric) == 0)
            return &d->findings[i];
    return NULL;
}

static const rheo_metric_info *info_of(const cli_page *page, const char *name)
{
    const rheo_metric_info *info;
    for (uint32_t i = 0; (info = rheo_world_metric_info(rheo_player_world(page->f.player), i)) != NULL; i++)
        if (strcmp(info->name, name) == 0)
            return info;
    return NULL;
}

/* Writes the figure of a metric, of both recordings and with the limit of a finding. */
static rheo_result put_figure(FILE *file, const cli_page *page, uint32_t metric, rheo_error *error)
{
    const char *name = rheo_recording_metric_name(page->f.recording, metric);
    const rheo_metric_info *info = info_of(page, name);
    const rheo_finding *finding = finding_of(page, name);
    const uint32_t other = page->g.path ? rheo_recording_metric_by_name(page->g.recording, name) : 0;
    const double ends[2] = {(double)page->f.info.first_step, (double)page->f.info.last_step};
    double limit[2], place[2];
    curve own = {0}, others = {0};
    rheo_plot_curve shown[MOST_CURVES];
    size_t count = 0;
    bool good = take_curve(&page->f, metric, &own);
    if (good && page->g.path && other < page->g.metrics)
        good = take_curve(&page->g, other, &others);
    if (others.count)
        shown[count++] = (rheo_plot_curve){page->g.name, others.count, others.x, others.y, RHEO_PLOT_LINE, 1};
    shown[count++] =
        (rheo_plot_curve){page->g.path ? page->f.name : NULL, own.count, own.x, own.y, RHEO_PLOT_LINE, 0};
    if (finding) {
        limit[0] = limit[1] = finding->limit;
        place[0] = (double)finding->step;
        place[1] = finding->value;
        shown[count++] = (rheo_plot_curve){"limit", 2, ends, limit, RHEO_PLOT_LINE, 7};
        shown[count++] = (rheo_plot_curve){"first step out of range", 1, &place[0], &place[1], RHEO_PLOT_POINTS, 4};
    }
    const bool unit = info && strcmp(info->unit, "1") != 0;
    const rheo_plot_panel panel = {
        NULL, {"step", RHEO_PLOT_LINEAR, 0, 0}, {unit ? info->unit : NULL, scale_of(&own), 0, 0}, count, shown};
    char *text = NULL;
    size_t size;
    rheo_result result = RHEO_ERROR_MEMORY;
    if (good)
        result = rheo_plot_text(&(rheo_plot){name, info ? info->meaning : NULL, 1, &panel, 1}, &text, &size, error);
    if (result == RHEO_OK) {
        fputs("<figure>\n", file);
        fwrite(text, 1, size, file);
        fputs("<figcaption>", file);
        cli_page_put(file, name);
        if (info) {
            fputs(": ", file);
            cli_page_put(file, info->meaning);
        }
        fputs("</figcaption>\n</figure>\n", file);
    }
    free(text);
    release(&own);
    release(&others);
    return result;
}

/* ---- Table ---- */

/* Rows are evenly apart, but all marks have one. */
static bool has_row(const cli_page *page, uint64_t index)
{
    const uint64_t steps = page->f.steps, apart = (steps - 1) / TABLE_ROWS + 1;
    if (index % apart == 0 || index == steps - 1)
        return true;
    for (uint32_t i = 0; i < page->focuses; i++)
        if (page->focus[i] == page->f.info.first_step + index)
            return true;
    return false;
}

static void put_table(FILE *file, const cli_page *page)
{
    const cli_page_recording *f = &page->f;
    fputs("<details>\n<summary>Table of all metrics</summary>\n<div class=\"scroll\">\n<table class=\"metrics\">\n"
          "<thead><tr>",
          file);
    for (uint32_t m = 0; m < f->metrics; m++) {
        fputs("<th scope=\"col\">", file);
        cli_page_put(file, rheo_recording_metric_name(f->recording, m));
        fputs("</th>", file);
    }
    fputs("</tr></thead>\n<tbody>\n", file);
    for (uint64_t i = 0; i < f->steps; i++) {
        if (!has_row(page, i))
            continue;
        fputs("<tr>", file);
        for (uint32_t m = 0; m < f->metrics; m++) {
            const bool step = strcmp(rheo_recording_metric_name(f->recording, m), "step") == 0;
            fputs(step ? "<th scope=\"row\">" : "<td>", file);
            if (step) {
                cli_page_put_link(file, f->info.first_step + i, "", -1);
                fprintf(file, "%llu</a></th>", (unsigned long long)(f->info.first_step + i));
                continue;
            }
            cli_page_put_number(file, value_at(f, i, m), 6);
            fputs("</td>", file);
        }
        fputs("</tr>\n", file);
    }
    fputs("</tbody>\n</table>\n</div>\n<p>All steps: ", file);
    cli_page_put_command(file, "rheolog metrics", f->name, "");
    fputs("</p>\n</details>\n", file);
}

/* ---- All ---- */

/* Those out of range come first, then those in the order of the recording, as long as there is room. */
int cli_page_write_metrics(cli_page *page)
{
    cli_page_text *part = &page->metrics_part;
    rheo_error error = {"no memory"};
    rheo_result result = RHEO_OK;
    uint32_t left_out = 0;
    if (!cli_page_begin(part))
        return cli_page_no_memory();
    fputs("<div class=\"figures\">\n", part->file);
    for (int wanted = 1; wanted >= 0; wanted--)
        for (uint32_t m = 0; m < page->f.metrics && result == RHEO_OK; m++) {
            const char *name = rheo_recording_metric_name(page->f.recording, m);
            if (!is_plotted(&page->f, m) || (finding_of(page, name) != NULL) != wanted)
                continue;
            fflush(part->file);
            if (part->size > page->max_bytes / 8)
                left_out++;
            else
                result = put_figure(part->file, page, m, &error);
        }
    fputs("</div>\n", part->file);
    if (left_out)
        fprintf(part->file, "<p>There is no room for %u more.</p>\n", (unsigned)left_out);
    put_table(part->file, page);
    const bool ended = cli_page_end(part);
    return result != RHEO_OK ? cli_error(result, &error) : ended ? CLI_DONE : cli_page_no_memory();
}
