/* The parts of a page that say what happened: the summary and the diagnosis, with links to steps and particles. */
#define _POSIX_C_SOURCE 200809L /* open_memstream() */
#include "cli/report.h"

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
    cli_completeness(page->f.recording, text, sizeof text);
    put_row(file, "end", text);
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

int cli_page_write_story(cli_page *page)
{
    const rheo_diagnosis *d = &page->f.diagnosis;
    const int status = write_summary(page);
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
    put_advice(file, page);
    return cli_page_end(&page->story) ? CLI_DONE : cli_page_no_memory();
}

int cli_page_write_budget(cli_page *page)
{
    char text[32];
    size_t frames = 0, stages = 0, details = 0;
    for (size_t i = 0; i < page->frames; i++) {
        frames += !page->frame[i].left_out;
        stages += !page->frame[i].left_out && page->frame[i].stage[0];
    }
    for (size_t i = 0; i < page->details; i++)
        details += !page->detail[i].left_out;
    page->budget = (cli_page_text){0};
    if (!cli_page_begin(&page->budget))
        return cli_page_no_memory();
    FILE *file = page->budget.file;
    cli_bytes((double)page->max_bytes, text, sizeof text);
    fprintf(
        file,
        "<p>This file may have %s (<code>--max-size</code>). It holds %zu ends of steps of %llu, %zu states within steps, "
        "and exact values of %zu particles. Numbers are %s.</p>\n<p>The rest: ",
        text, frames - stages, (unsigned long long)page->f.steps, stages, details,
        page->exact ? "exact (float32)" : "rounded to 16 bits");
    cli_page_put_command(file, "rheolog inspect", page->f.name, " --step N --particle P");
    fputs("</p>\n", file);
    return cli_page_end(&page->budget) ? CLI_DONE : cli_page_no_memory();
}
