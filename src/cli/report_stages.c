/*
 * What each stage of the step that a page looks at first did to the particles. A recording has no times, so these are the costs
 * that it can tell: runs, and what they changed.
 */
#define _POSIX_C_SOURCE 200809L /* open_memstream() */
#include "cli/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Changes ---- */

static double change_of(const rheo_real *before, const rheo_real *after, const double period[3])
{
    double sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        double way = (double)after[axis] - (double)before[axis];
        if (period && period[axis] > 0)
            way -= period[axis] * floor(way / period[axis] + 0.5);
        sum += way * way;
    }
    return sqrt(sum);
}

/* The largest change, which NaN is, and its particle; and how many change. */
static void find_largest(const rheo_real *before, const rheo_real *after, size_t count, const double period[3],
                         cli_page_change *largest)
{
    *largest = (cli_page_change){.particle = -1};
    for (size_t i = 0; i < count; i++) {
        const double change = change_of(before + 3 * i, after + 3 * i, period);
        largest->particles += change != 0;
        if (change != 0 && !(change <= largest->size) && !isnan(largest->size)) {
            largest->size = change;
            largest->particle = (int64_t)i;
        }
    }
}

bool cli_page_profile_begin(cli_page_profile *p, const rheo_world *world)
{
    const size_t bytes = 3 * (size_t)rheo_world_particle_count(world) * sizeof(rheo_real);
    free(p->position);
    free(p->velocity);
    p->position = malloc(bytes + 1);
    p->velocity = malloc(bytes + 1);
    p->count = rheo_world_particle_count(world);
    if (!p->position || !p->velocity)
        return false;
    memcpy(p->position, rheo_world_positions(world), bytes);
    memcpy(p->velocity, rheo_world_velocities(world), bytes);
    return true;
}

/* Commands may add particles before the first run, which then has no changes. */
bool cli_page_profile_add(cli_page_profile *p, const rheo_world *world, const char *stage)
{
    if (p->runs == p->room) {
        const size_t room = 2 * p->room + 32;
        cli_page_run *run = realloc(p->run, room * sizeof *run);
        if (!run)
            return false;
        p->run = run;
        p->room = room;
    }
    cli_page_run *run = &p->run[p->runs++];
    *run = (cli_page_run){.position = {.particle = -1}, .velocity = {.particle = -1}};
    snprintf(run->stage, sizeof run->stage, "%s", stage);
    const size_t count = p->count;
    if (count == rheo_world_particle_count(world)) {
        const double *period = rheo_world_definition(world)->space.period;
        find_largest(p->position, rheo_world_positions(world), count, period, &run->position);
        find_largest(p->velocity, rheo_world_velocities(world), count, NULL, &run->velocity);
    }
    return cli_page_profile_begin(p, world);
}

void cli_page_profile_release(cli_page_profile *p)
{
    free(p->position);
    free(p->velocity);
    free(p->run);
}

/* ---- The part of the page ---- */

static void put_change(FILE *file, const cli_page_profile *p, const cli_page_run *run, const cli_page_change *c)
{
    if (c->particle < 0) {
        fputs("<td>0</td><td></td>", file);
        return;
    }
    fputs("<td>", file);
    cli_page_put_number(file, c->size, 4);
    fputs("</td><td>", file);
    cli_page_put_link(file, p->step, run->stage, c->particle);
    fprintf(file, "%lld</a>", (long long)c->particle);
    if (c->particles > 1)
        fprintf(file, " of %zu", c->particles);
    fputs("</td>", file);
}

/* How often a stage ran in the recording: in a substep as often as there were substeps. NAN: not known. */
static double runs_of(const cli_page *page, const char *stage)
{
    double runs = 0;
    for (uint64_t i = 1; i < page->f.steps; i++)
        runs += strchr(stage, '@') ? cli_page_metric(&page->f, page->f.info.first_step + i, "substeps") : 1;
    return runs;
}

static void put_table(FILE *file, const cli_page *page, const cli_page_profile *p)
{
    fputs("<div class=\"scroll\">\n<table class=\"stages\">\n<thead><tr><th scope=\"col\">stage</th>"
          "<th scope=\"col\">runs in the recording</th><th scope=\"col\">largest displacement, L</th>"
          "<th scope=\"col\">particle</th><th scope=\"col\">largest change of velocity, L/T</th>"
          "<th scope=\"col\">particle</th></tr></thead>\n<tbody>\n",
          file);
    for (size_t i = 0; i < p->runs && i < CLI_PAGE_STAGE_ROWS; i++) {
        const cli_page_run *run = &p->run[i];
        const char *at = strchr(run->stage, '@');
        fputs("<tr><th scope=\"row\">", file);
        cli_page_put_link(file, p->step, run->stage, -1);
        cli_page_put(file, run->stage);
        fputs("</a></th><td>", file);
        if (!at || strcmp(at, "@1") == 0)
            cli_page_put_number(file, runs_of(page, run->stage), 9);
        fputs("</td>", file);
        put_change(file, p, run, &run->position);
        put_change(file, p, run, &run->velocity);
        fputs("</tr>\n", file);
    }
    fputs("</tbody>\n</table>\n</div>\n", file);
    if (p->runs > CLI_PAGE_STAGE_ROWS)
        fprintf(file, "<p>And %zu more runs.</p>\n", p->runs - CLI_PAGE_STAGE_ROWS);
}

static rheo_result put_figure(FILE *file, const cli_page_profile *p, rheo_error *error)
{
    double *x = malloc(3 * p->runs * sizeof *x);
    rheo_result result = x ? RHEO_OK : RHEO_ERROR_MEMORY;
    if (x) {
        char title[64];
        double *position = x + p->runs, *velocity = position + p->runs;
        for (size_t i = 0; i < p->runs; i++) {
            x[i] = (double)(i + 1);
            position[i] = p->run[i].position.size;
            velocity[i] = p->run[i].velocity.size;
        }
        snprintf(title, sizeof title, "changes by the stages of step %llu", (unsigned long long)p->step);
        const rheo_plot_curve curve[] = {
            {"largest displacement, L", p->runs, x, position, RHEO_PLOT_POINTS, 0},
            {"largest change of velocity, L/T", p->runs, x, velocity, RHEO_PLOT_POINTS, 1}};
        const rheo_plot_panel panel = {
            NULL, {"number of the run", RHEO_PLOT_LINEAR, 0, 0}, {NULL, RHEO_PLOT_LOGARITHMIC, 0, 0}, 2, curve};
        char *text = NULL;
        size_t size;
        result = rheo_plot_text(&(rheo_plot){title, NULL, 1, &panel, 1}, &text, &size, error);
        if (result == RHEO_OK) {
            fputs("<figure>\n", file);
            fwrite(text, 1, size, file);
            fputs("<figcaption>What each stage run changed most; stages that change nothing have no point."
                  "</figcaption>\n</figure>\n",
                  file);
        }
        free(text);
    }
    free(x);
    return result;
}

int cli_page_write_stages(cli_page *page)
{
    const cli_page_profile *p = &page->profile;
    rheo_error error = {"no memory"};
    rheo_result result = RHEO_OK;
    if (!cli_page_begin(&page->stages_part))
        return cli_page_no_memory();
    FILE *file = page->stages_part.file;
    if (p->runs) {
        fputs("<p>The stages of ", file);
        cli_page_put_link(file, p->step, "", -1);
        fprintf(file,
                "step %llu</a>, in their order. A recording has no times, so their costs are numbers of runs; "
                "<code>rheolog bench</code> measures times.</p>\n",
                (unsigned long long)p->step);
        result = put_figure(file, p, &error);
        put_table(file, page, p);
    } else {
        fputs("<p>The recording has no step, so no stage ran.</p>\n", file);
    }
    const bool ended = cli_page_end(&page->stages_part);
    return result != RHEO_OK ? cli_error(result, &error) : ended ? CLI_DONE : cli_page_no_memory();
}
