/* A frame of a page: positions and quantities of all particles, and the balls. */
#include "cli/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 256 }; /* of a frame, for the ranges of the colours */

/* ---- Quantities ---- */

static void add_quantity(cli_page *page, const char *name, const char *component, const char *unit,
                         const char *meaning, cli_page_source source, size_t offset, int rank)
{
    if (page->quantities == CLI_PAGE_QUANTITIES)
        return;
    cli_page_quantity *q = &page->quantity[page->quantities++];
    *q = (cli_page_quantity){.unit = unit, .meaning = meaning, .source = source, .offset = offset, .rank = rank};
    snprintf(q->name, sizeof q->name, "%s%s", name, component);
}

/* The speed, and what stiffens or melts the fluid, are in each frame. */
static bool is_important(const rheo_world *world, const char *name)
{
    const rheo_ranking *r;
    for (uint32_t i = 0; (r = rheo_world_ranking(world, i)) != NULL; i++)
        if ((r->top == RHEO_TOP_STIFFEST || r->top == RHEO_TOP_HOTTEST) && strcmp(r->value, name) == 0)
            return true;
    return strcmp(name, "speed") == 0;
}

static void add_vector(cli_page *page, const rheo_quantity *q)
{
    static const char *const component[] = {".x", ".y", ".z"};
    /* The speed is the length of the velocity; places are no colours. */
    if (strcmp(q->name, "velocity") == 0)
        for (uint32_t axis = 0; axis < 3; axis++)
            add_quantity(page, q->name, component[axis], q->unit, q->meaning, CLI_PAGE_MEMBER,
                         q->offset + axis * sizeof(double), 2);
    else if (!strstr(q->name, "position"))
        add_quantity(page, q->name, "", q->unit, q->meaning, CLI_PAGE_LENGTH, q->offset, 1);
}

void cli_page_quantities_of(cli_page *page, const rheo_world *world)
{
    const rheo_quantity *q;
    const rheo_world_def *def = rheo_world_definition(world);
    if (page->g.path)
        add_quantity(page, "divergence", "", "L", "distance between the particle in both recordings",
                     CLI_PAGE_DIVERGENCE, 0, 0);
    for (int scalars = 1; scalars >= 0; scalars--) /* vectors last */
        for (uint32_t i = 0; (q = rheo_world_quantity(world, i)) != NULL; i++)
            if (scalars && q->components == 1)
                add_quantity(page, q->name, "", q->unit, q->meaning, CLI_PAGE_MEMBER, q->offset,
                             is_important(world, q->name) ? 0 : 1);
            else if (!scalars && q->components == 3)
                add_vector(page, q);
    add_quantity(page, "neighbours", "", "1", "particles closer than the support", CLI_PAGE_NEIGHBOURS, 0, 1);
    if (def->model == RHEO_MODEL_THICKENING && def->springs.stiffness > 0)
        add_quantity(page, "springs", "", "1", "springs that end here", CLI_PAGE_SPRINGS, 0, 1);
    if (def->materials.count)
        add_quantity(page, "material", "", "1", "number of the material; 0 is the main one", CLI_PAGE_MATERIAL, 0, 0);
}

/* ---- Values ---- */

static double length_of(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* What a frame is made from. */
typedef struct source {
    uint32_t count;
    rheo_particle_state *state;
    const rheo_world *other; /* NULL: not known */
    double period[3];
    double *value; /* 3 numbers of each particle */
} source;

/* To the nearest image in periodic space. */
static double divergence_of(const source *s, uint32_t i)
{
    double way[3];
    if (i >= rheo_world_particle_count(s->other))
        return NAN;
    const rheo_real *at = rheo_world_positions(s->other) + 3 * (size_t)i;
    for (int axis = 0; axis < 3; axis++) {
        way[axis] = (double)at[axis] - s->state[i].position[axis];
        if (s->period[axis] > 0)
            way[axis] -= s->period[axis] * floor(way[axis] / s->period[axis] + 0.5);
    }
    return length_of(way);
}

static double value_of(const source *s, const cli_page_quantity *q, uint32_t i)
{
    const rheo_particle_state *state = &s->state[i];
    double v[3];
    switch (q->source) {
    case CLI_PAGE_MEMBER:
        memcpy(v, (const char *)state + q->offset, sizeof *v);
        return v[0];
    case CLI_PAGE_LENGTH:
        memcpy(v, (const char *)state + q->offset, sizeof v);
        return length_of(v);
    case CLI_PAGE_NEIGHBOURS:
        return state->neighbours;
    case CLI_PAGE_SPRINGS:
        return state->springs;
    case CLI_PAGE_MATERIAL:
        return state->material;
    case CLI_PAGE_DIVERGENCE:
        return divergence_of(s, i);
    }
    return NAN;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Keeps some of the values in their order of size. Sorts them. */
static bool take_samples(cli_page_quantity *q, double *value, uint32_t count)
{
    size_t finite = 0;
    for (uint32_t i = 0; i < count; i++)
        if (isfinite(value[i]))
            value[finite++] = value[i] + 0.; /* no -0 */
    qsort(value, finite, sizeof *value, compare);
    if (q->samples + SAMPLES > q->room) {
        const size_t room = 2 * q->room + 16 * SAMPLES;
        double *sample = realloc(q->sample, room * sizeof *sample);
        if (!sample)
            return false;
        q->sample = sample;
        q->room = room;
    }
    const size_t most = finite < SAMPLES ? finite : SAMPLES;
    for (size_t i = 0; i < most; i++)
        q->sample[q->samples++] = value[(size_t)((uint64_t)i * finite / most)];
    return true;
}

void cli_page_find_ranges(cli_page *page)
{
    for (uint32_t i = 0; i < page->quantities; i++) {
        cli_page_quantity *q = &page->quantity[i];
        q->range[0] = 0;
        q->range[1] = 1;
        if (q->samples == 0)
            continue;
        qsort(q->sample, q->samples, sizeof *q->sample, compare);
        const size_t outside = q->samples / 100;
        q->range[0] = q->sample[outside];
        q->range[1] = q->sample[q->samples - 1 - outside];
        if (q->range[0] == q->range[1]) { /* all but a few are equal */
            q->range[0] = q->sample[0];
            q->range[1] = q->sample[q->samples - 1];
        }
    }
}

/* ---- The frame ---- */

static bool take_values(cli_page *page, source *s, cli_page_frame *frame, int ranks)
{
    for (uint32_t i = 0; i < s->count; i++)
        for (int axis = 0; axis < 3; axis++)
            s->value[3 * (size_t)i + (size_t)axis] = s->state[i].position[axis];
    bool good = cli_page_encode(&page->blocks, s->value, s->count, 3, 3, page->exact, &frame->position);
    for (uint32_t k = 0; k < page->quantities && good; k++) {
        cli_page_quantity *q = &page->quantity[k];
        if (q->rank > ranks || (q->source == CLI_PAGE_DIVERGENCE && !s->other))
            continue;
        for (uint32_t i = 0; i < s->count; i++)
            s->value[i] = value_of(s, q, i);
        good = cli_page_encode(&page->blocks, s->value, s->count, 1, 1, page->exact, &frame->value[k]);
        if (good && !frame->stage[0])
            good = take_samples(q, s->value, s->count);
    }
    return good;
}

static bool take_bodies(const rheo_world *world, cli_page_frame *frame)
{
    const uint32_t count = rheo_world_body_count(world);
    if (!(frame->body = calloc((size_t)count + 1, sizeof *frame->body)))
        return false;
    while (frame->body_count < count &&
           rheo_world_body(world, frame->body_count, &frame->body[frame->body_count]) == RHEO_OK)
        frame->body_count++;
    return true;
}

int cli_page_add_frame(cli_page *page, const rheo_world *world, const rheo_world *other, uint64_t step,
                       const char *stage, uint32_t run, int ranks, uint32_t priority)
{
    if (page->frames == page->frame_room) {
        const size_t room = 2 * page->frame_room + 64;
        cli_page_frame *frame = realloc(page->frame, room * sizeof *frame);
        if (!frame)
            return cli_page_no_memory();
        page->frame = frame;
        page->frame_room = room;
    }
    cli_page_frame *frame = &page->frame[page->frames++];
    source s = {.count = rheo_world_particle_count(world), .other = other};
    memcpy(s.period, rheo_world_definition(world)->space.period, sizeof s.period);
    *frame = (cli_page_frame){
        .step = step, .run = run, .particles = s.count, .time = rheo_world_time(world), .priority = priority};
    snprintf(frame->stage, sizeof frame->stage, "%s", stage);
    s.state = malloc(((size_t)s.count + 1) * sizeof *s.state);
    s.value = malloc(((size_t)s.count + 1) * 3 * sizeof *s.value);
    rheo_error error = {"no memory"};
    rheo_result result = RHEO_ERROR_MEMORY;
    if (s.state && s.value)
        result = rheo_world_particles(world, s.state, &error);
    if (result == RHEO_OK && !(take_values(page, &s, frame, ranks) && take_bodies(world, frame)))
        result = RHEO_ERROR_MEMORY;
    free(s.state);
    free(s.value);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}
