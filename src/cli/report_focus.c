/* Reads the recordings of a page, and finds what to look at: steps, particles and marks. */
#include "cli/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "json/file_name.h"

enum { MOST_MARKS = 300 };

/* ---- Recordings ---- */

/* All metrics, step by step. */
static rheo_result read_metrics(cli_page_recording *r, rheo_error *error)
{
    r->metrics = rheo_recording_metric_count(r->recording);
    r->steps = r->info.last_step - r->info.first_step + 1;
    if (r->steps > SIZE_MAX / sizeof *r->metric / (r->metrics + 1) ||
        !(r->metric = malloc((size_t)r->steps * (r->metrics + 1) * sizeof *r->metric)))
        return RHEO_ERROR_MEMORY;
    rheo_result result = RHEO_OK;
    for (uint64_t i = 0; i < r->steps && result == RHEO_OK; i++)
        result =
            rheo_recording_metrics(r->recording, r->info.first_step + i, r->metric + (size_t)i * r->metrics, error);
    return result;
}

int cli_page_read(cli_page_recording *r)
{
    rheo_error error = {"no memory"};
    int status = cli_open_recording(r->path, &r->recording);
    if (status != CLI_DONE)
        return status;
    r->info = rheo_recording_get_info(r->recording);
    r->name = rheo__json_file_name(r->path);
    rheo_result result = rheo_recording_check(r->recording, &error);
    if (result == RHEO_OK)
        result = rheo_diagnose(r->recording, &r->diagnosis, &error);
    if (result == RHEO_OK)
        result = read_metrics(r, &error);
    if (result == RHEO_OK)
        result = rheo_player_open(r->recording, NULL, &r->player, &error);
    return result == RHEO_OK ? CLI_DONE : cli_file_error(r->path, result, &error);
}

void cli_page_recording_release(cli_page_recording *r)
{
    rheo_player_close(r->player);
    rheo_recording_close(r->recording);
    free(r->metric);
}

double cli_page_metric(const cli_page_recording *r, uint64_t step, const char *name)
{
    const uint32_t index = rheo_recording_metric_by_name(r->recording, name);
    const uint64_t first = r->info.first_step;
    return index < r->metrics && step >= first && step - first < r->steps
               ? r->metric[(size_t)(step - first) * r->metrics + index]
               : NAN;
}

/* ---- What to look at ---- */

/* The step that failed can be looked into, but has no end. */
static void add_focus(cli_page *page, uint64_t step, const char *reason)
{
    const cli_page_recording *f = &page->f;
    if (step < f->info.first_step || step > f->info.last_step + f->diagnosis.failed)
        return;
    for (uint32_t i = 0; i < page->focuses; i++)
        if (page->focus[i] == step)
            return;
    if (page->focuses == 0)
        page->focus_reason = reason;
    if (page->focuses < CLI_PAGE_FOCUSES)
        page->focus[page->focuses++] = step;
}

static void add_particle(cli_page *page, int64_t id)
{
    if (id < 0 || id > UINT32_MAX)
        return;
    for (uint32_t i = 0; i < page->particles; i++)
        if (page->particle[i] == (uint32_t)id)
            return;
    if (page->particles < CLI_PAGE_PARTICLES)
        page->particle[page->particles++] = (uint32_t)id;
}

static int add_mark(cli_page *page, uint64_t step, const char *kind, const char *stage, int64_t particle,
                    const char *text)
{
    if (page->marks == page->mark_room) {
        const size_t room = 2 * page->mark_room + 32;
        cli_page_mark *mark = realloc(page->mark, room * sizeof *mark);
        if (!mark)
            return cli_page_no_memory();
        page->mark = mark;
        page->mark_room = room;
    }
    cli_page_mark *m = &page->mark[page->marks++];
    *m = (cli_page_mark){.step = step, .kind = kind, .particle = particle};
    snprintf(m->stage, sizeof m->stage, "%s", stage);
    snprintf(m->text, sizeof m->text, "%s", text);
    return CLI_DONE;
}

static int mark_finding(cli_page *page, const rheo_finding *f, bool cause)
{
    char values[256], text[400];
    rheo_finding_text(f, values, sizeof values);
    snprintf(text, sizeof text, "%s %s", f->measure, values);
    return add_mark(page, f->step, cause ? "sign" : "event", "", f->id, text);
}

static int look_at_difference(cli_page *page)
{
    const rheo_verification *d = &page->difference;
    if (!page->g.path || d->verdict != RHEO_DIFFERS || d->lengths_differ)
        return CLI_DONE;
    char text[400];
    add_focus(page, d->first.step, "which has the first difference");
    const bool particle = d->first.origin != RHEO_VALUES_NONE && d->first.location == RHEO_LOCATION_PARTICLE;
    const bool spring = d->first.origin != RHEO_VALUES_NONE && d->first.location == RHEO_LOCATION_SPRING;
    if (particle || spring)
        add_particle(page, (int64_t)d->first.id);
    if (spring)
        add_particle(page, (int64_t)d->first.other_id);
    snprintf(text, sizeof text, "first difference: %s%s%s", d->first.field, d->first.stage[0] ? " after stage " : "",
             d->first.stage);
    return add_mark(page, d->first.step, "difference", d->first.stage, particle || spring ? (int64_t)d->first.id : -1,
                    text);
}

static int look_at_health(cli_page *page)
{
    const rheo_diagnosis *d = &page->f.diagnosis;
    int status = CLI_DONE;
    if (!d->healthy) {
        if (page->chain.known)
            add_focus(page, page->chain.step, "in which the first sign shows at a particle");
        add_focus(page, d->cause.measure[0] ? d->cause.seen[0] ? d->cause.seen_step : d->cause.step : d->sign_step,
                  "which has the first sign");
        add_focus(page, d->sign_step, "which has the first sign");
        add_focus(page, d->unhealthy_step, "which is unhealthy");
        add_particle(page, d->cause.id);
        add_particle(page, d->cause.other_id);
        for (uint32_t i = 0; i < page->chain.count; i++)
            add_particle(page, (int64_t)page->chain.link[i].id);
        if (d->cause.measure[0])
            status = mark_finding(page, &d->cause, true);
    }
    if (d->failed && status == CLI_DONE) {
        char text[400];
        rheo_failure_message(&d->failure, text, sizeof text);
        add_focus(page, d->failure.step, "which failed");
        if (d->failure.location == RHEO_LOCATION_PARTICLE)
            add_particle(page, (int64_t)d->failure.id);
        status = add_mark(page, d->failure.step, "failure", d->failure.stage,
                          d->failure.location == RHEO_LOCATION_PARTICLE ? (int64_t)d->failure.id : -1, text);
    }
    for (uint32_t i = 0; i < d->finding_count && status == CLI_DONE; i++) {
        const rheo_finding *f = &d->findings[i];
        add_focus(page, f->step, "in which a measure leaves its range");
        add_particle(page, f->id);
        add_particle(page, f->other_id);
        if (d->healthy || f->step != d->cause.step || strcmp(f->measure, d->cause.measure) != 0)
            status = mark_finding(page, f, false);
    }
    return status;
}

static int look_at_commands(cli_page *page)
{
    const uint64_t count = rheo_recording_command_count(page->f.recording);
    int status = CLI_DONE;
    for (uint64_t i = 0; i < count && status == CLI_DONE; i++) {
        rheo_command c;
        rheo_error error = {""};
        const rheo_result result = rheo_recording_command(page->f.recording, i, &c, &error);
        if (result != RHEO_OK)
            return cli_file_error(page->f.path, result, &error);
        add_focus(page, c.step, "before which a command was given");
        if (page->marks < MOST_MARKS)
            status = add_mark(page, c.step, "command", "", -1, c.text);
    }
    return status;
}

/* The step in which something moves fastest. */
static uint64_t fastest_step(const cli_page_recording *r)
{
    uint64_t fastest = r->info.last_step;
    double most = -1;
    for (uint64_t i = 0; i < r->steps; i++) {
        const double speed = cli_page_metric(r, r->info.first_step + i, "max_speed");
        if (speed > most) {
            most = speed;
            fastest = r->info.first_step + i;
        }
    }
    return fastest;
}

/* The particles that metrics name in a step, such as the densest. */
static void add_extremes(cli_page *page, uint64_t step)
{
    static const char *const ENDINGS[] = {"_id", "_a", "_b"};
    const cli_page_recording *f = &page->f;
    for (uint32_t i = 0; i < f->metrics; i++) {
        const char *name = rheo_recording_metric_name(f->recording, i);
        for (size_t k = 0; k < sizeof ENDINGS / sizeof *ENDINGS; k++) {
            const double id = cli_page_metric(f, step, name);
            if (rheo__json_ends_with(name, ENDINGS[k]) && id >= 0 && id < UINT32_MAX)
                add_particle(page, (int64_t)id);
        }
    }
}

static int compare_marks(const void *a, const void *b)
{
    const cli_page_mark *x = a, *y = b;
    const int kinds = strcmp(x->kind, y->kind), texts = strcmp(x->text, y->text);
    return x->step != y->step ? x->step < y->step ? -1 : 1 : kinds ? kinds : texts;
}

int cli_page_find_focus(cli_page *page)
{
    int status = look_at_difference(page);
    if (status == CLI_DONE)
        status = look_at_health(page);
    if (status == CLI_DONE)
        status = look_at_commands(page);
    const uint64_t fastest = fastest_step(&page->f);
    add_focus(page, fastest, "in which particles move fastest");
    add_extremes(page, page->focus[0] <= page->f.info.last_step ? page->focus[0] : page->f.info.last_step);
    add_extremes(page, fastest);
    if (page->marks)
        qsort(page->mark, page->marks, sizeof *page->mark, compare_marks);
    return status;
}
