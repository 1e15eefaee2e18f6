/* The parts of a page that say what happened: the summary and the diagnosis, with links to steps and particles. */
#define _POSIX_C_SOURCE 200809L /* open_memstream() */
#include "cli/report.h"

#include <stdlib.h>
#include <string.h>

#include "cli/cure.h"
#include "cli/provenance.h"
#include "cli/shell.h"

static void put_row(FILE *file, const char *name, const char *value)
{
    fprintf(file, "<dt>%s</dt><dd>", name);
    cli_page_put(file, value);
    fputs("</dd>\n", file);
}

static int write_summary(cli_page *page)
{
    const rheo_recording_info *info = &page->f.info;
    char text[512];
    if (!cli_page_begin(&page->summary))
        return cli_page_no_memory();
    FILE *file = page->summary.file;
    fputs("<h1>", file);
    cli_page_put(file, page->f.name);
    if (page->g.path) {
        fputs(" and ", file);
        cli_page_put(file, page->g.name);
    }
    fprintf(file, "</h1>\n<p class=\"verdict %s\">", page->f.diagnosis.healthy ? "healthy" : "unhealthy");
    cli_page_put(file, page->f.diagnosis.why);
    fputs("</p>\n<dl>\n", file);
    put_row(file, "scene", info->scene[0] ? info->scene : "without a name");
    put_row(file, "model", rheo_model_name(rheo_recording_definition(page->f.recording)->model));
    snprintf(text, sizeof text, "%llu", (unsigned long long)info->particles);
    put_row(file, "particles", text);
    snprintf(text, sizeof text, "%llu to %llu", (unsigned long long)info->first_step,
             (unsigned long long)info->last_step);
    put_row(file, "steps", text);
    put_row(file, "made by", cli_made_text(info));
    put_row(file, "build", info->build);
    cli_ending_text(page->f.recording, text, sizeof text);
    put_row(file, "ends", text);
    fputs("</dl>\n", file);
    return cli_page_end(&page->summary) ? CLI_DONE : cli_page_no_memory();
}

static void put_finding(FILE *file, const rheo_finding *f)
{
    char text[256];
    rheo_finding_text(f, text, sizeof text);
    fputs("<li>", file);
    cli_page_put_link(file, f->step, "", f->id);
    fprintf(file, "step %llu</a>: ", (unsigned long long)f->step);
    cli_page_put(file, f->measure);
    fputs(" ", file);
    cli_page_put(file, text);
    if (f->steps > 1) {
        fprintf(file, " (%llu steps, up to ", (unsigned long long)f->steps);
        cli_page_put_number(file, f->peak, 3);
        fputs(" in ", file);
        cli_page_put_link(file, f->peak_step, "", -1);
        fprintf(file, "step %llu</a>)", (unsigned long long)f->peak_step);
    }
    fprintf(file, "<br><small>");
    cli_page_put(file, f->meaning);
    fputs("</small></li>\n", file);
}

static void put_chain(FILE *file, const cli_doctor_chain *c)
{
    char text[CLI_WHY_TEXT];
    if (!c->told)
        return;
    fputs("<h3>Causes, each from the largest contribution to the one before</h3>\n<ol class=\"chain\">\n", file);
    for (uint32_t i = 0; i < c->count; i++) {
        const rheo_link *link = &c->link[i];
        fputs("<li>", file);
        cli_page_put_link(file, link->step, link->stage, (int64_t)link->id);
        cli_page_put(file, cli_why_link_text(link, text));
        fputs("</a></li>\n", file);
    }
    fputs("</ol>\n<p>It ends: ", file);
    cli_page_put(file, c->chain.why);
    fputs("</p>\n", file);
}

static void put_advice(FILE *file, const cli_page *page)
{
    const rheo_diagnosis *d = &page->f.diagnosis;
    const cli_doctor_case c = {page->f.name, page->f.recording, d};
    bool any = false;
    for (uint32_t i = 0; i < d->advice_count; i++) {
        char command[CLI_COMMAND_LINE];
        const rheo_advice *a = &d->advice[i];
        if (!cli_cure_possible(&c, a))
            continue;
        fputs(any ? "" : "<h3>What helps</h3>\n<ul>\n", file);
        any = true;
        fputs("<li>", file);
        cli_page_put(file, a->set);
        fputs(a->set[0] ? ": " : "", file);
        cli_page_put(file, a->text);
        if (cli_cure(&c, a, command, sizeof command)) {
            fputs("<br><code>", file);
            cli_page_put(file, command);
            fputs("</code>", file);
        }
        fputs("</li>\n", file);
    }
    fputs(any ? "</ul>\n" : "", file);
}

/* ---- What to look at first ---- */

/* The particle or spring that has a metric, by its metrics NAME_id, or of some others. -1: none. */
static int64_t id_of(const cli_page_recording *f, uint64_t step, const char *name, bool second)
{
    static const char *const OTHERS[][3] = {
        {"stiffness_number", "stiffness_a", "stiffness_b"},
        {"max_density_error", "max_density_id", ""},
    };
    char own[64];
    snprintf(own, sizeof own, "%s_id", name);
    double id = second ? -1 : cli_page_metric(f, step, own);
    for (size_t i = 0; i < sizeof OTHERS / sizeof *OTHERS; i++)
        if (strcmp(OTHERS[i][0], name) == 0)
            id = cli_page_metric(f, step, OTHERS[i][1 + second]);
    return id >= 0 && id < UINT32_MAX ? (int64_t)id : -1;
}

/* The largest values in the step that the page looks at first, with their particles. */
static void put_extremes(FILE *file, const cli_page *page)
{
    const cli_page_recording *f = &page->f;
    const bool whole = page->focus[0] <= f->info.last_step;
    const uint64_t step = whole ? page->focus[0] : f->info.last_step;
    fputs("<h3>Look first</h3>\n<p>The view begins at ", file);
    cli_page_put_link(file, page->focus[0], "", -1);
    fprintf(file, "step %llu</a>, %s. ", (unsigned long long)page->focus[0], page->focus_reason);
    fprintf(file, "The largest values %s step %llu:</p>\n<ul class=\"extremes\">\n", whole ? "in" : "before it, in",
            (unsigned long long)step);
    for (uint32_t i = 0; i < f->metrics; i++) {
        const char *name = rheo_recording_metric_name(f->recording, i);
        const int64_t id = id_of(f, step, name, false), other = id_of(f, step, name, true);
        if (id < 0)
            continue;
        fprintf(file, "<li>%s ", name);
        cli_page_put_number(file, cli_page_metric(f, step, name), 4);
        fputs(other < 0 ? ", particle " : ", spring ", file);
        cli_page_put_link(file, step, "", id);
        fprintf(file, "%lld</a>", (long long)id);
        if (other >= 0) {
            fputs(":", file);
            cli_page_put_link(file, step, "", other);
            fprintf(file, "%lld</a>", (long long)other);
        }
        fputs("</li>\n", file);
    }
    fputs("</ul>\n", file);
}

/* What `rheolog check` says of the scene, if it can be made again. */
static int put_warnings(FILE *file, const cli_page *page)
{
    enum { MOST = 32 };
    rheo_scene scene;
    rheo_error error = {""};
    size_t count = 0;
    if (page->f.info.first_step > 0 || !cli_recorded_scene(page->f.recording, &scene))
        return CLI_DONE;
    rheo_warning *warning = calloc(MOST, sizeof *warning);
    const rheo_result result =
        warning ? rheo_scene_warnings(&scene, warning, MOST, &count, &error) : RHEO_ERROR_MEMORY;
    rheo_scene_release(&scene);
    count = result != RHEO_OK ? 0 : count < MOST ? count : MOST;
    if (count)
        fputs("<h3>Likely mistakes in the scene</h3>\n<ul class=\"warnings\">\n", file);
    for (size_t i = 0; i < count; i++) {
        fputs("<li>", file);
        cli_page_put(file, warning[i].text);
        fputs("</li>\n", file);
    }
    if (count)
        fputs("</ul>\n", file);
    free(warning);
    return result == RHEO_ERROR_MEMORY ? cli_page_no_memory() : CLI_DONE;
}

int cli_page_write_story(cli_page *page)
{
    const rheo_diagnosis *d = &page->f.diagnosis;
    int status = write_summary(page);
    if (status != CLI_DONE)
        return status;
    if (!cli_page_begin(&page->story))
        return cli_page_no_memory();
    FILE *file = page->story.file;
    fputs("<p>", file);
    cli_page_put(file, d->why);
    fputs("</p>\n", file);
    if (d->finding_count) {
        fputs(d->healthy ? "<h3>Notices</h3>\n<ol class=\"findings\">\n"
                         : "<h3>Measures out of range, first step first</h3>\n<ol class=\"findings\">\n",
              file);
        for (uint32_t i = 0; i < d->finding_count; i++)
            put_finding(file, &d->findings[i]);
        fputs("</ol>\n", file);
    }
    put_chain(file, &page->chain);
    status = put_warnings(file, page);
    put_advice(file, page);
    put_extremes(file, page);
    return cli_page_end(&page->story) ? status : cli_page_no_memory();
}
