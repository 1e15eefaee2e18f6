/* Members of a recording: what they measure, and how they are run (record/members.h). */
#include "record/members.h"

#include <stdlib.h>
#include <string.h>

#include "core/progress.h"
#include "record/same.h"

/*
 * Two runs that began one unit in the last place apart end this far apart, in spacings, if rounding is amplified; else
 * coordinates are moved by up to MOVED spacings.
 */
#define AMPLIFIED 0.01
#define MOVED 0.05
/* Differences of means up to this part of a metric's largest size are rounding; so are times this close, in steps. */
#define PART_THAT_COUNTS 1e-5
#define TIME_THAT_COUNTS 0.01

enum { LEAST_STEPS = 16 };

void rheo__members_release(rheo__members *m)
{
    free(m->value);
    free(m->result);
    *m = (rheo__members){0};
}

static rheo_result no_memory(rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the members of the recording");
}

/* ---- Which values ---- */

/* A metric over the recording itself. */
typedef struct course {
    double first, last, least, largest, size;
    uint64_t least_step, largest_step;
} course;

static bool begins(const char *name, const char *with)
{
    return strncmp(name, with, strlen(with)) == 0;
}

/* What the fluid does. Other metrics say how well it is computed, or are the largest of many values, and so chance. */
static bool is_physics(const char *name)
{
    static const char *const NOT[] = {"step", "time", "courant_number", "density_error", "energy_jump"};
    static const char *const NOT_BEGIN[] = {"max_", "stiffness_", "substeps", "iterations", "softened_springs"};
    for (size_t i = 0; i < sizeof NOT / sizeof *NOT; i++)
        if (strcmp(name, NOT[i]) == 0)
            return false;
    if (begins(name, "ball") && strstr(name, "_max_speed"))
        return false;
    for (size_t i = 0; i < sizeof NOT_BEGIN / sizeof *NOT_BEGIN; i++)
        if (begins(name, NOT_BEGIN[i]))
            return false;
    return true;
}

static void add(rheo__members *m, const char *metric, rheo__member_value value)
{
    if (m->values == RHEO__MEMBER_VALUES)
        return;
    snprintf(value.metric, sizeof value.metric, "%s", metric);
    m->value[m->values++] = value;
}

static bool is_inside(uint64_t step, uint64_t from, uint64_t to)
{
    const uint64_t edge = (to - from) / 20 + 1;
    return step > from + edge && step + edge < to;
}

static void add_metric(rheo__members *m, const char *name, const course *c, uint64_t from, uint64_t to)
{
    const uint64_t steps = to - from;
    const double range = c->largest - c->least;
    for (uint64_t part = 0; part < RHEO__MEMBER_PARTS; part++)
        add(m, name,
            (rheo__member_value){.kind = RHEO__MEMBER_MEAN,
                                 .from = from + steps * part / RHEO__MEMBER_PARTS,
                                 .to = from + steps * (part + 1) / RHEO__MEMBER_PARTS,
                                 .counts = PART_THAT_COUNTS * c->size});
    if (!(range > 0))
        return;
    rheo__member_value event = {.from = from, .to = to, .counts = TIME_THAT_COUNTS};
    if (__builtin_fabs(c->last - c->first) >= range / 2) {
        event.kind = RHEO__MEMBER_PASSES;
        event.level = (c->first + c->last) / 2;
        add(m, name, event);
    }
    event.level = 0;
    event.kind = RHEO__MEMBER_LEAST;
    if (is_inside(c->least_step, from, to))
        add(m, name, event);
    event.kind = RHEO__MEMBER_LARGEST;
    if (is_inside(c->largest_step, from, to))
        add(m, name, event);
}

static rheo_result read_courses(rheo_recording *r, course *courses, double *metrics, rheo_error *error)
{
    const uint32_t count = r->head.metric_count;
    for (uint64_t step = r->first_step; step <= r->last_step; step++) {
        RHEO__TRY(rheo_recording_metrics(r, step, metrics, error));
        for (uint32_t i = 0; i < count; i++) {
            course *c = &courses[i];
            const double size = __builtin_fabs(metrics[i]);
            if (step == r->first_step)
                *c = (course){metrics[i], metrics[i], metrics[i], metrics[i], 0, step, step};
            if (metrics[i] < c->least)
                c->least = metrics[i], c->least_step = step;
            if (metrics[i] > c->largest)
                c->largest = metrics[i], c->largest_step = step;
            c->size = size > c->size ? size : c->size;
            c->last = metrics[i];
        }
    }
    return RHEO_OK;
}

static rheo_result make_room(rheo__members *m, rheo_error *error)
{
    m->result = calloc(m->values * (size_t)m->count + 1, sizeof *m->result);
    return m->result ? RHEO_OK : no_memory(error);
}

static rheo_result choose(rheo_recording *r, uint32_t count, uint64_t seed, rheo__members *m, rheo_error *error)
{
    const uint32_t metrics = r->head.metric_count;
    *m = (rheo__members){.seed = seed, .count = count};
    if (r->last_step - r->first_step < LEAST_STEPS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the recording has %llu steps, too few for statistics; at least %d are needed",
                          (unsigned long long)(r->last_step - r->first_step), LEAST_STEPS);
    course *courses = calloc(metrics + (size_t)1, sizeof *courses);
    double *values = calloc(metrics + (size_t)1, sizeof *values);
    m->value = calloc(RHEO__MEMBER_VALUES, sizeof *m->value);
    rheo_result result = courses && values && m->value ? read_courses(r, courses, values, error) : no_memory(error);
    for (uint32_t i = 0; result == RHEO_OK && i < metrics; i++)
        if (is_physics(r->head.metrics[i].text))
            add_metric(m, r->head.metrics[i].text, &courses[i], r->first_step, r->last_step);
    free(courses);
    free(values);
    if (result == RHEO_OK)
        result = make_room(m, error);
    snprintf(m->build, sizeof m->build, "%s", rheo_build());
    if (result != RHEO_OK)
        rheo__members_release(m);
    return result;
}

rheo_result rheo__members_like(const rheo__members *from, uint32_t count, uint64_t seed, rheo__members *m,
                               rheo_error *error)
{
    *m = (rheo__members){.seed = seed, .moved = from->moved, .count = count, .values = from->values};
    snprintf(m->build, sizeof m->build, "%s", rheo_build());
    m->value = malloc((m->values + (size_t)1) * sizeof *m->value);
    rheo_result result = m->value ? make_room(m, error) : no_memory(error);
    if (result == RHEO_OK && m->values)
        memcpy(m->value, from->value, m->values * sizeof *m->value);
    if (result != RHEO_OK)
        rheo__members_release(m);
    return result;
}

/* ---- Running them ---- */

/* Moves the positions of a world as a member of this seed. */
static void move(rheo_world *world, double moved, uint64_t seed)
{
    rheo_real *x = world->state.position;
    const size_t count = 3 * (size_t)world->state.particles;
    if (moved > 0) {
        const double most = moved * world->def.fluid.spacing;
        uint64_t random = (seed + 1) * UINT64_C(0x9e3779b97f4a7c15) | 1; /* xorshift64, which is never 0 */
        for (size_t i = 0; i < count; i++) {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            x[i] += (rheo_real)(most * ((double)(random >> 11) * 0x1p-52 - 1));
        }
    } else {
        rheo__same_move(x, count, seed, RHEO__FIELD_position);
    }
    world->state.rewritten++;
}

/* How far a value of a member is known. */
typedef struct reading {
    double before, first, extreme, result;
    bool decided;
    uint32_t metric; /* of the world */
} reading;

static void begin(reading *reads, const rheo__members *m, const rheo_world *world)
{
    for (uint32_t i = 0; i < m->values; i++) {
        const double now = rheo_world_metric(world, reads[i].metric);
        const rheo__member_kind kind = m->value[i].kind;
        reads[i].before = reads[i].first = reads[i].extreme = now;
        reads[i].decided = false;
        reads[i].result = kind == RHEO__MEMBER_MEAN     ? 0
                          : kind == RHEO__MEMBER_PASSES ? (double)(m->value[i].to + 1) /* it may not pass */
                                                        : (double)m->value[i].from;
    }
}

static void read_value(reading *read, const rheo__member_value *value, uint64_t step, double now)
{
    const double level = value->level;
    if (step <= value->from || step > value->to)
        return;
    switch (value->kind) {
    case RHEO__MEMBER_MEAN:
        read->result += now / (double)(value->to - value->from);
        break;
    case RHEO__MEMBER_PASSES:
        if (!read->decided && (read->first < level ? now >= level : now <= level)) {
            read->decided = true;
            read->result =
                (double)(step - 1) + (now != read->before ? (level - read->before) / (now - read->before) : 1);
        }
        break;
    case RHEO__MEMBER_LEAST:
    case RHEO__MEMBER_LARGEST:
    default:
        if (value->kind == RHEO__MEMBER_LEAST ? now < read->extreme : now > read->extreme) {
            read->extreme = now;
            read->result = (double)step;
        }
    }
    read->before = now;
}

static rheo_result run_steps(rheo_recording *r, const rheo_same_options *options, const rheo__members *m,
                             reading *reads, rheo_world *world, rheo_error *error)
{
    if (options)
        RHEO__TRY(rheo__same_set(options, world, error));
    begin(reads, m, world);
    uint64_t last = r->first_step;
    for (uint32_t i = 0; i < m->values; i++)
        last = m->value[i].to > last ? m->value[i].to : last;
    for (size_t index = 0; index < r->step_count && r->first_step + index < last; index++) {
        const uint64_t step = r->first_step + 1 + index;
        RHEO__TRY(options ? rheo__same_command(r, index, options, world, error)
                          : rheo__recording_command(r, &r->steps[index], step, world, error));
        RHEO__TRY(rheo_world_step(world, error));
        for (uint32_t i = 0; i < m->values; i++)
            read_value(&reads[i], &m->value[i], step, rheo_world_metric(world, reads[i].metric));
    }
    return RHEO_OK;
}

static rheo_result find_metrics(const rheo__members *m, const rheo_world *world, reading *reads, rheo_error *error)
{
    const uint32_t count = rheo_world_metric_count(world);
    for (uint32_t i = 0; i < m->values; i++) {
        uint32_t metric = 0;
        while (metric < count && strcmp(rheo_world_metric_name(world, metric), m->value[i].metric) != 0)
            metric++;
        if (metric == count)
            return rheo__fail(error, RHEO_ERROR_UNSUPPORTED, "the members have a metric that this build has not: %s",
                              m->value[i].metric);
        reads[i].metric = metric;
    }
    return RHEO_OK;
}

/* One member: `seed` moves it. */
static rheo_result run_member(rheo_recording *r, const rheo_same_options *options, rheo__members *m, uint32_t member,
                              reading *reads, rheo_error *error)
{
    rheo_world *world;
    RHEO__TRY(rheo__keyframe_world(r, &r->keyframes[0], NULL, &world, error));
    rheo_result result = find_metrics(m, world, reads, error);
    move(world, m->moved, m->seed + member);
    if (result == RHEO_OK)
        result = run_steps(r, options, m, reads, world, error);
    for (uint32_t i = 0; result == RHEO_OK && i < m->values; i++)
        m->result[i * (size_t)m->count + member] = reads[i].result;
    rheo_world_destroy(world);
    return result;
}

rheo_result rheo__members_run(rheo_recording *r, const rheo_same_options *options, rheo__members *m,
                              rheo_error *error)
{
    reading *reads = calloc(m->values + (size_t)1, sizeof *reads);
    rheo_result result = reads ? RHEO_OK : no_memory(error);
    for (uint32_t member = 0; result == RHEO_OK && member < m->count; member++) {
        rheo_error why;
        result = run_member(r, options, m, member, reads, &why);
        if (result != RHEO_OK)
            rheo__fail(error, result, "member %u of %u: %.400s", member + 1, m->count, why.message);
        else
            result = rheo__progress("running members", member + 1, m->count, error);
    }
    free(reads);
    return result;
}

/* ---- Making them ---- */

static double distance_between(const rheo_world *a, const rheo_world *b)
{
    const size_t count = 3 * (size_t)a->state.particles;
    double squares = 0;
    for (size_t i = 0; i < count; i++) {
        const double d = (double)a->state.position[i] - (double)b->state.position[i];
        squares += d * d;
    }
    return count ? __builtin_sqrt(squares / (double)count * 3) / a->def.fluid.spacing : 0;
}

/* How far apart two runs end that began one unit in the last place apart: root mean square, in spacings. */
static rheo_result amplify(rheo_recording *r, uint64_t seed, rheo_world *world[2], double *apart, rheo_error *error)
{
    for (int side = 0; side < 2; side++)
        RHEO__TRY(rheo__keyframe_world(r, &r->keyframes[0], NULL, &world[side], error));
    move(world[1], 0, seed);
    for (size_t index = 0; index < r->step_count; index++)
        for (int side = 0; side < 2; side++) {
            RHEO__TRY(rheo__recording_command(r, &r->steps[index], r->first_step + 1 + index, world[side], error));
            RHEO__TRY(rheo_world_step(world[side], error));
        }
    *apart = distance_between(world[0], world[1]);
    return RHEO_OK;
}

rheo_result rheo__members_make(rheo_recording *r, uint32_t count, uint64_t seed, rheo__members *m, rheo_error *error)
{
    rheo_world *world[2] = {NULL, NULL};
    double apart = 0;
    RHEO__TRY(choose(r, count, seed, m, error));
    rheo_result result = amplify(r, seed, world, &apart, error);
    for (int side = 0; side < 2; side++)
        rheo_world_destroy(world[side]);
    m->moved = apart >= AMPLIFIED ? 0 : MOVED;
    if (result == RHEO_OK)
        result = rheo__members_run(r, NULL, m, error);
    if (result != RHEO_OK)
        rheo__members_release(m);
    return result;
}
