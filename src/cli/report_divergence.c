/* The part of a page about two recordings: where they first differ, and how the difference grows. */
#define _POSIX_C_SOURCE 200809L /* open_memstream() */
#include "cli/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Texts ---- */

static void put_first(FILE *file, const rheo_verification *d)
{
    const rheo_difference *f = &d->first;
    const bool known = f->origin != RHEO_VALUES_NONE;
    const bool particle = known && (f->location == RHEO_LOCATION_PARTICLE || f->location == RHEO_LOCATION_SPRING);
    fputs("<p>The first difference: ", file);
    cli_page_put_link(file, f->step, f->stage, particle ? (int64_t)f->id : -1);
    fprintf(file, "step %llu", (unsigned long long)f->step);
    if (f->stage[0]) {
        fputs(", after stage ", file);
        cli_page_put(file, f->stage);
    }
    if (particle)
        fprintf(file, ", particle %llu", (unsigned long long)f->id);
    fputs("</a>.</p>\n", file);
}

static void put_parameters(FILE *file, const cli_page *page)
{
    const rheo_verification *d = &page->difference;
    if (!d->parameter_count)
        return;
    fputs("<h3>Parameters at the start that differ</h3>\n<table>\n<thead><tr><th scope=\"col\">parameter</th>"
          "<th scope=\"col\">",
          file);
    cli_page_put(file, page->f.name);
    fputs("</th><th scope=\"col\">", file);
    cli_page_put(file, page->g.name);
    fputs("</th></tr></thead>\n<tbody>\n", file);
    for (uint32_t i = 0; i < d->parameter_count && i < RHEO_MAX_PARAMETER_DIFFERENCES; i++) {
        const rheo_parameter_difference *p = &d->parameters[i];
        fputs("<tr><th scope=\"row\">", file);
        cli_page_put(file, p->parameter->path);
        fputs("</th><td>", file);
        cli_page_put(file, p->a[0] ? p->a : "none");
        fputs("</td><td>", file);
        cli_page_put(file, p->b[0] ? p->b : "none");
        fputs("</td></tr>\n", file);
    }
    fputs("</tbody>\n</table>\n", file);
    if (d->has_cause) {
        fputs("<p>If both start from the state of the first, they show first in ", file);
        cli_page_put_link(file, d->cause.step, d->cause.stage, -1);
        fprintf(file, "step %llu</a>: ", (unsigned long long)d->cause.step);
        cli_page_put(file, d->cause.field);
        fputs(d->cause.stage[0] ? " after stage " : "", file);
        cli_page_put(file, d->cause.stage);
        fputs(".</p>\n", file);
    }
}

static rheo_result put_commands(FILE *file, const cli_page_recording *r, uint64_t step, rheo_error *error)
{
    const uint64_t count = rheo_recording_command_count(r->recording);
    rheo_result result = RHEO_OK;
    bool any = false;
    for (uint64_t i = 0; i < count && result == RHEO_OK; i++) {
        rheo_command c;
        result = rheo_recording_command(r->recording, i, &c, error);
        if (result != RHEO_OK || c.step != step)
            continue;
        fputs(any ? "; " : "", file);
        cli_page_put(file, c.text);
        any = true;
    }
    fputs(any ? "" : "none", file);
    return result;
}

static rheo_result put_different_commands(FILE *file, const cli_page *page, rheo_error *error)
{
    const rheo_verification *d = &page->difference;
    if (!d->commands_differ)
        return RHEO_OK;
    fputs("<p>Commands differ before ", file);
    cli_page_put_link(file, d->commands_step, "", -1);
    fprintf(file, "step %llu</a>. In the first: ", (unsigned long long)d->commands_step);
    rheo_result result = put_commands(file, &page->f, d->commands_step, error);
    fputs(". In the second: ", file);
    if (result == RHEO_OK)
        result = put_commands(file, &page->g, d->commands_step, error);
    fputs(".</p>\n", file);
    return result;
}

/* ---- Growth ---- */

static void put_growth_table(FILE *file, const rheo_verification *d)
{
    fputs(
        "<details>\n<summary>Table of the growth</summary>\n<table>\n<thead><tr><th scope=\"col\">step</th>"
        "<th scope=\"col\">field</th><th scope=\"col\">items that differ</th><th scope=\"col\">largest difference</th>"
        "<th scope=\"col\">of the field's largest value</th></tr></thead>\n<tbody>\n",
        file);
    for (uint32_t i = 0; i < d->growth_count && i < RHEO_MAX_GROWTH; i++) {
        const rheo_growth *g = &d->growth[i];
        fputs("<tr><th scope=\"row\">", file);
        cli_page_put_link(file, g->step, "", -1);
        fprintf(file, "%llu</a></th><td>", (unsigned long long)g->step);
        cli_page_put(file, g->field);
        fprintf(file, "</td><td>%llu</td><td>", (unsigned long long)g->count);
        cli_page_put_number(file, g->largest, 4);
        fputs("</td><td>", file);
        if (g->scale > 0)
            cli_page_put_number(file, g->largest / g->scale, 3);
        fputs("</td></tr>\n", file);
    }
    fputs("</tbody>\n</table>\n</details>\n", file);
}

/* A curve of each field, of at most as many as there are looks. */
static rheo_result put_growth(FILE *file, const rheo_verification *d, rheo_error *error)
{
    static double x[RHEO_PLOT_LOOKS][RHEO_MAX_GROWTH], y[RHEO_PLOT_LOOKS][RHEO_MAX_GROWTH];
    rheo_plot_curve curve[RHEO_PLOT_LOOKS];
    size_t count = 0;
    if (!d->growth_count)
        return RHEO_OK;
    for (uint32_t i = 0; i < d->growth_count && i < RHEO_MAX_GROWTH; i++) {
        size_t c = 0;
        while (c < count && strcmp(curve[c].name, d->growth[i].field) != 0)
            c++;
        if (c == RHEO_PLOT_LOOKS)
            continue;
        if (c == count) {
            curve[c] = (rheo_plot_curve){d->growth[i].field, 0, x[c], y[c], RHEO_PLOT_LINE, (uint32_t)c};
            count++;
        }
        x[c][curve[c].count] = (double)d->growth[i].step;
        y[c][curve[c].count++] = d->growth[i].largest;
    }
    const rheo_plot_panel panel = {
        NULL, {"step", RHEO_PLOT_LINEAR, 0, 0}, {"largest difference", RHEO_PLOT_LOGARITHMIC, 0, 0}, count, curve};
    char *text = NULL;
    size_t size;
    const rheo_plot plot = {"growth of the difference", "largest difference of each field", 1, &panel, 1};
    const rheo_result result = rheo_plot_text(&plot, &text, &size, error);
    if (result == RHEO_OK) {
        fputs("<figure>\n", file);
        fwrite(text, 1, size, file);
        fputs("<figcaption>Growth: the largest difference of each field, in its unit, in the step of the first "
              "difference and 1, 2, 4, 8 ... steps later.</figcaption>\n</figure>\n",
              file);
        put_growth_table(file, d);
    }
    free(text);
    return result;
}

int cli_page_write_divergence(cli_page *page)
{
    const rheo_verification *d = &page->difference;
    rheo_error error = {"no memory"};
    rheo_result result = RHEO_OK;
    if (!page->g.path)
        return CLI_DONE;
    if (!cli_page_begin(&page->divergence))
        return cli_page_no_memory();
    FILE *file = page->divergence.file;
    fputs("<p>Compared with ", file);
    cli_page_put(file, page->g.name);
    fputs(": ", file);
    cli_page_put(file, d->message);
    fputs("</p>\n<p>The second recording: ", file);
    cli_page_put(file, page->g.diagnosis.why);
    fputs("</p>\n", file);
    put_parameters(file, page);
    result = put_different_commands(file, page, &error);
    if (d->verdict == RHEO_DIFFERS && !d->lengths_differ) {
        put_first(file, d);
        if (result == RHEO_OK)
            result = put_growth(file, d, &error);
    }
    const bool ended = cli_page_end(&page->divergence);
    return result != RHEO_OK ? cli_error(result, &error) : ended ? CLI_DONE : cli_page_no_memory();
}
