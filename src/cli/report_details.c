/* The exact values of particles that a page's story names: their quantities, springs and past. */
#define _POSIX_C_SOURCE 200809L /* open_memstream() */
#include "cli/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rows of a past: the newest ones, and of the older ones so many that are evenly apart. */
enum { NEWEST = 120, OLDER = 80 };

/* The number with the fewest digits that reads back to the same float, if it is one: it is shorter in JSON. */
static double shortened(double value)
{
    char text[32];
    const char *end;
    if (!isfinite(value) || (double)(float)value != value)
        return value;
    for (int digits = 6; digits <= 9; digits++) {
        const double shorter = rheo_text_number(rheo_number_brief(value, digits, text), &end);
        if ((float)shorter == (float)value)
            return shorter;
    }
    return value;
}

/* ---- Values ---- */

static void write_values(rheo__json *json, const rheo_world *world, const rheo_particle_state *state)
{
    static const char *const component[] = {".x", ".y", ".z"};
    const rheo_quantity *q;
    const rheo_world_def *def = rheo_world_definition(world);
    rheo__json_begin_object(json, "values");
    for (uint32_t i = 0; (q = rheo_world_quantity(world, i)) != NULL; i++)
        for (uint32_t c = 0; c < q->components; c++) {
            char name[64];
            double value;
            snprintf(name, sizeof name, "%s%s", q->name, q->components > 1 ? component[c] : "");
            memcpy(&value, (const char *)state + q->offset + c * sizeof value, sizeof value);
            rheo__json_number(json, name, shortened(value));
        }
    rheo__json_integer(json, "neighbours", state->neighbours);
    if (def->model == RHEO_MODEL_THICKENING && def->springs.stiffness > 0)
        rheo__json_integer(json, "springs", state->springs);
    if (def->materials.count)
        rheo__json_integer(json, "material", state->material);
    rheo__json_end_object(json);
}

/* ---- Springs ---- */

static void write_spring(rheo__json *json, const rheo_spring_state *s, uint32_t id)
{
    const double rest = (double)s->spring.rest_length;
    rheo__json_begin_object(json, NULL);
    rheo__json_integer(json, "other", s->spring.a == id ? s->spring.b : s->spring.a);
    rheo__json_number(json, "length", shortened(s->length));
    rheo__json_number(json, "rest_length", shortened(rest));
    rheo__json_number(json, "stretch", rest > 0 ? s->length / rest - 1 : NAN);
    rheo__json_number(json, "history_rate", shortened(s->history_rate));
    rheo__json_number(json, "stiffness", shortened(s->stiffness));
    rheo__json_number(json, "kappa", shortened(s->kappa));
    rheo__json_end_object(json);
}

static void write_springs(rheo__json *json, const rheo_world *world, uint32_t id, const rheo_spring *spring,
                          size_t count)
{
    rheo__json_begin_list(json, "springs");
    for (size_t i = 0; i < count; i++) {
        rheo_spring_state state;
        if ((spring[i].a == id || spring[i].b == id) &&
            rheo_world_spring(world, spring[i].a, spring[i].b, &state, NULL) == RHEO_OK)
            write_spring(json, &state, id);
    }
    rheo__json_end_list(json);
}

/* ---- The past ---- */

/* The row after `row` that is shown, of so many. */
static uint32_t next_row(uint32_t row, uint32_t rows)
{
    const uint32_t apart = rows > NEWEST + OLDER ? (rows - NEWEST - 1) / OLDER + 1 : 1;
    return row < NEWEST ? row + 1 : row + apart;
}

/* Steps before the first recorded one were made with its time step. */
static double time_of(const cli_page_recording *r, int64_t step)
{
    const int64_t first = (int64_t)r->info.first_step;
    const double dt = rheo_recording_definition(r->recording)->step;
    return step >= first ? cli_page_metric(r, (uint64_t)step, "time")
                         : cli_page_metric(r, (uint64_t)first, "time") - (double)(first - step) * dt;
}

/* Within a step it is that of the end of the step before. */
static bool write_past(rheo__json *json, const cli_page *page, const rheo_world *world, uint32_t id)
{
    const uint32_t rows = rheo_world_history_rows(world);
    rheo_real *velocity = malloc(((size_t)rows + 1) * 3 * sizeof *velocity);
    if (!velocity)
        return false;
    if (rows == 0 || rheo_world_stages_done(world) > 0 ||
        rheo_world_particle_history(world, id, velocity) != RHEO_OK) {
        rheo__json_null(json, "past");
        free(velocity);
        return true;
    }
    const int64_t now = (int64_t)rheo_world_step_count(world);
    rheo__json_begin_object(json, "past");
    rheo__json_begin_list(json, "age");
    for (uint32_t m = 0; m < rows; m = next_row(m, rows)) {
        char text[32];
        const char *end;
        const double age = time_of(&page->f, now) - time_of(&page->f, now - (int64_t)m);
        rheo__json_number(json, NULL, rheo_text_number(rheo_number_brief(age, 6, text), &end));
    }
    rheo__json_end_list(json);
    rheo__json_begin_list(json, "velocity");
    for (uint32_t m = 0; m < rows; m = next_row(m, rows)) {
        double v[3];
        for (size_t axis = 0; axis < 3; axis++)
            v[axis] = shortened((double)velocity[3 * (size_t)m + axis]);
        rheo__json_vector(json, NULL, v, 3);
    }
    rheo__json_end_list(json);
    rheo__json_integer(json, "rows", rows);
    rheo__json_end_object(json);
    free(velocity);
    return true;
}

/* ---- All ---- */

static cli_page_detail *new_detail(cli_page *page)
{
    if (page->details == page->detail_room) {
        const size_t room = 2 * page->detail_room + 64;
        cli_page_detail *detail = realloc(page->detail, room * sizeof *detail);
        if (!detail)
            return NULL;
        page->detail = detail;
        page->detail_room = room;
    }
    return &page->detail[page->details];
}

/* False: no memory. */
static bool add_detail(cli_page *page, const rheo_world *world, uint32_t id, const rheo_spring *spring,
                       size_t springs, cli_page_detail start)
{
    rheo_particle_state state;
    cli_page_text text = {0};
    cli_page_detail *detail = new_detail(page);
    if (!detail || rheo_world_particle(world, id, &state, NULL) != RHEO_OK || !cli_page_begin(&text))
        return false;
    rheo__json json = {.file = text.file};
    rheo__json_begin_object(&json, NULL);
    write_values(&json, world, &state);
    write_springs(&json, world, id, spring, springs);
    const bool good = write_past(&json, page, world, id);
    rheo__json_end_object(&json);
    const bool ended = cli_page_end(&text);
    *detail = start;
    detail->particle = id;
    detail->json = text.at;
    detail->size = text.size;
    page->details++;
    return good && ended;
}

int cli_page_add_details(cli_page *page, const rheo_world *world, uint64_t step, uint32_t run, uint64_t priority,
                         bool all)
{
    const uint32_t particles = rheo_world_particle_count(world), count = all ? particles : page->particles;
    const size_t springs = rheo_world_spring_count(world);
    rheo_spring *spring = malloc((springs + 1) * sizeof *spring);
    bool good = spring && rheo_world_springs(world, spring, springs) == RHEO_OK;
    for (uint32_t i = 0; i < count && good; i++) {
        const uint32_t id = all ? i : page->particle[i];
        const cli_page_detail detail = {.step = step, .run = run, .priority = priority * CLI_PAGE_PARTICLES + i};
        if (id < particles)
            good = add_detail(page, world, id, spring, springs, detail);
    }
    free(spring);
    return good ? CLI_DONE : cli_page_no_memory();
}

uint64_t cli_page_detail_size(const rheo_world *world)
{
    enum { VALUES = 600, SPRING = 170, ROW = 44 };
    const uint64_t rows = rheo_world_history_rows(world), most = NEWEST + OLDER;
    const uint64_t particles = rheo_world_particle_count(world);
    return VALUES + SPRING * (particles ? 2 * (uint64_t)rheo_world_spring_count(world) / particles : 0) +
           ROW * (rows < most ? rows : most);
}
