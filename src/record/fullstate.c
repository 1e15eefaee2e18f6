/*
 * The state after every step, as STAT chunks: lossless differences from the state before.
 *
 * A particle's velocity is near the velocity before; its position is near position + step x velocity. Both are
 * stored as differences of ordered integers (rheo__order()) with the sign in the lowest bit, so that most bits are
 * 0. Springs are stored as those removed, those added, and differences of rest lengths. Other fields are small and
 * stored unchanged.
 *
 * The state before is the recorded one at the end of the step before. Changes by commands are not applied to it
 * (particles that they add count as zeros), so that states can be read without simulating.
 */
#include "record/recording.h"

#include <stdlib.h>
#include <string.h>

#include "core/work.h"
#include "world/emit.h"

enum {
    BLOCK = 16384,    /* values */
    COUNTS = 0x10000, /* "field" of the counts: particles, bodies, vibrators, springs removed and added;
                         step */
    COUNT_VALUES = 6,
};
/* Parts of spring_ends: springs that were removed and added. */
enum { WENT = 0, CAME = 1 };

/* Maps the numbers 0, -1, 1, -2, 2, ... to 0, 1, 2, 3, 4, ..., and back. */
static rheo__real_bits fold(rheo__real_bits difference)
{
    rheo__real_bits sign = difference >> (8 * sizeof difference - 1);
    return (rheo__real_bits)(difference << 1) ^ (rheo__real_bits)(0 - sign);
}
static rheo__real_bits unfold(rheo__real_bits folded)
{
    return (folded >> 1) ^ (rheo__real_bits)(0 - (folded & 1));
}

/* Fields that are stored as differences: reals of particles, most of which change little in a step. */
static bool is_particle(rheo__field_id field)
{
    const rheo__field *f = &rheo__field_table[field];
    return f->location == RHEO_LOCATION_PARTICLE && f->storage == RHEO__FLAT && f->element == RHEO__ELEMENT_REAL;
}

/* Their order: velocities first, since positions are predicted from them. */
static rheo__field_id nth_particle_field(rheo__fields present, uint32_t n)
{
    if (n < 2)
        return n == 0 ? RHEO__FIELD_velocity : RHEO__FIELD_position;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if ((present >> f & 1) && is_particle(f) && f != RHEO__FIELD_velocity && f != RHEO__FIELD_position &&
            n-- == 2)
            return f;
    return RHEO__FIELD_COUNT;
}

/* The predicted values from `first` on of a particle field. */
static void expect(const rheo__values *before, const rheo__values *now, rheo__field_id field, size_t first,
                   size_t count, rheo_real step, rheo_real *expected)
{
    const size_t all = rheo__field_table[field].components * before->items[field];
    const size_t known = all <= first ? 0 : all - first < count ? all - first : count;
    if (known)
        memcpy(expected, (const rheo_real *)before->data[field] + first, known * sizeof *expected);
    for (size_t i = known; i < count; i++)
        expected[i] = 0;
    if (field != RHEO__FIELD_position)
        return;
    const rheo_real *velocity = (const rheo_real *)now->data[RHEO__FIELD_velocity] + first;
    for (size_t i = 0; i < count; i++)
        expected[i] += step * velocity[i];
}

/* ---- Springs ---- */

typedef struct spring_changes {
    uint32_t *went, *came; /* went: indices into the old list; came: ends */
    rheo__real_bits *rest; /* folded differences, of all springs now */
    size_t went_count, came_count;
} spring_changes;

static void release_changes(spring_changes *c)
{
    free(c->went);
    free(c->came);
    free(c->rest);
}

static rheo_result allocate_changes(spring_changes *c, size_t went, size_t came, size_t rest, rheo_error *error)
{
    const size_t most = SIZE_MAX / 16; /* no size below overflows */
    if (went < most && came < most && rest < most) {
        c->went = malloc(went * sizeof *c->went + 1);
        c->came = malloc(came * 2 * sizeof *c->came + 1);
        c->rest = malloc(rest * sizeof *c->rest + 1);
    }
    return c->went && c->came && c->rest ? RHEO_OK : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for springs");
}

static uint64_t spring_at(const uint32_t *ends, size_t k)
{
    return (uint64_t)ends[2 * k] << 32 | ends[2 * k + 1];
}

static rheo__real_bits rest_residual(rheo_real now, rheo_real before)
{
    return fold((rheo__real_bits)(rheo__order(now) - rheo__order(before)));
}

static void find_changes(const rheo__values *before, const rheo__values *now, spring_changes *c)
{
    const uint32_t *old = before->data[RHEO__FIELD_spring_ends], *ends = now->data[RHEO__FIELD_spring_ends];
    const rheo_real *old_rest = before->data[RHEO__FIELD_spring_rest_length];
    const rheo_real *rest = now->data[RHEO__FIELD_spring_rest_length];
    size_t olds = before->items[RHEO__FIELD_spring_ends], count = now->items[RHEO__FIELD_spring_ends], i = 0;
    for (size_t k = 0; k < count; k++) {
        while (i < olds && spring_at(old, i) < spring_at(ends, k))
            c->went[c->went_count++] = (uint32_t)i++;
        if (i < olds && spring_at(old, i) == spring_at(ends, k)) {
            c->rest[k] = rest_residual(rest[k], old_rest[i++]);
            continue;
        }
        c->came[2 * c->came_count] = ends[2 * k];
        c->came[2 * c->came_count++ + 1] = ends[2 * k + 1];
        c->rest[k] = rest_residual(rest[k], 0);
    }
    while (i < olds)
        c->went[c->went_count++] = (uint32_t)i++;
}

/* Applies changes to the old springs. False: they do not fit. */
static bool apply_changes(const rheo__values *before, rheo__values *now, const spring_changes *c)
{
    const uint32_t *old = before->data[RHEO__FIELD_spring_ends];
    const rheo_real *old_rest = before->data[RHEO__FIELD_spring_rest_length];
    uint32_t *ends = now->data[RHEO__FIELD_spring_ends];
    rheo_real *rest = now->data[RHEO__FIELD_spring_rest_length];
    size_t olds = before->items[RHEO__FIELD_spring_ends], i = 0, went = 0, came = 0;
    for (size_t k = 0; k < now->items[RHEO__FIELD_spring_ends]; k++) {
        while (i < olds && went < c->went_count && c->went[went] == i) {
            went++;
            i++;
        }
        bool is_new = came < c->came_count && (i >= olds || spring_at(c->came, came) < spring_at(old, i));
        if (!is_new && i >= olds)
            return false;
        const uint32_t *from = is_new ? c->came + 2 * came++ : old + 2 * i;
        ends[2 * k] = from[0];
        ends[2 * k + 1] = from[1];
        rest[k] = rheo__unorder((rheo__real_bits)(rheo__order(is_new ? 0 : old_rest[i++]) + unfold(c->rest[k])));
    }
    return true;
}

/* ---- Writing ---- */

static rheo_result write_particles(rheo__pieces_writer *pieces, uint32_t index, const rheo__values *before,
                                   const rheo__values *now, rheo__field_id field, rheo_real step, rheo_error *error)
{
    rheo__real_bits block[BLOCK];
    rheo_real expected[BLOCK];
    const rheo_real *values = now->data[field];
    size_t count = rheo__field_table[field].components * now->items[field];
    for (size_t first = 0; first < count; first += BLOCK) {
        size_t n = count - first < BLOCK ? count - first : BLOCK;
        expect(before, now, field, first, n, step, expected);
        for (size_t i = 0; i < n; i++)
            block[i] = fold((rheo__real_bits)(rheo__order(values[first + i]) - rheo__order(expected[i])));
        RHEO__TRY(rheo__pieces_put(pieces, index, 0, first, block, n, sizeof *block, error));
    }
    return RHEO_OK;
}

static rheo_result write_all(rheo__pieces_writer *pieces, rheo__fields present, const rheo__values *before,
                             const rheo__values *now, double step, const spring_changes *springs, rheo_error *error)
{
    uint64_t counts[COUNT_VALUES] = {now->items[RHEO__FIELD_position], now->items[RHEO__FIELD_ball_position],
                                     now->items[RHEO__FIELD_vibrator_position], springs->went_count,
                                     springs->came_count};
    memcpy(&counts[5], &step, sizeof step);
    RHEO__TRY(rheo__pieces_put(pieces, COUNTS, 0, 0, counts, COUNT_VALUES, sizeof *counts, error));
    rheo__field_id particles;
    for (uint32_t n = 0; (particles = nth_particle_field(present, n)) != RHEO__FIELD_COUNT; n++)
        RHEO__TRY(write_particles(pieces, rheo__field_index(present, particles), before, now, particles,
                                  (rheo_real)step, error));
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        const rheo__field *field = &rheo__field_table[f];
        if (now->present >> f & 1 && field->storage == RHEO__FLAT && !is_particle(f))
            RHEO__TRY(rheo__pieces_put(pieces, rheo__field_index(present, f), 0, 0, now->data[f],
                                       now->items[f] * field->components, rheo__element_size(field->element), error));
    }
    uint32_t ends = rheo__field_index(present, RHEO__FIELD_spring_ends);
    RHEO__TRY(rheo__pieces_put(pieces, ends, WENT, 0, springs->went, springs->went_count, 4, error));
    RHEO__TRY(rheo__pieces_put(pieces, ends, CAME, 0, springs->came, 2 * springs->came_count, 4, error));
    RHEO__TRY(rheo__pieces_put(pieces, rheo__field_index(present, RHEO__FIELD_spring_rest_length), 0, 0,
                               springs->rest, now->items[RHEO__FIELD_spring_ends], sizeof *springs->rest, error));
    return rheo__pieces_flush(pieces, error);
}

rheo_result rheo__full_write(rheo__pieces_writer *pieces, rheo__fields present, const rheo__values *before,
                             const rheo__values *now, double step, rheo_error *error)
{
    spring_changes springs = {0};
    size_t count = now->items[RHEO__FIELD_spring_ends];
    rheo_result result = allocate_changes(&springs, before->items[RHEO__FIELD_spring_ends], count, count, error);
    if (result == RHEO_OK) {
        find_changes(before, now, &springs);
        result = write_all(pieces, present, before, now, step, &springs, error);
    }
    release_changes(&springs);
    return result;
}

/* ---- Reading ---- */

static rheo_result damaged(const rheo__pieces_reader *pieces, rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the stored state of step %llu contradicts itself",
                      (unsigned long long)pieces->step);
}

static rheo_result read_particles(rheo__pieces_reader *pieces, uint32_t index, const rheo__values *before,
                                  rheo__values *now, rheo__field_id field, rheo_real step, rheo_error *error)
{
    rheo_real *values = now->data[field];
    size_t count = rheo__field_table[field].components * now->items[field];
    for (size_t first = 0; first < count; first += BLOCK) {
        rheo__real_bits block[BLOCK];
        rheo_real expected[BLOCK];
        size_t n = count - first < BLOCK ? count - first : BLOCK;
        expect(before, now, field, first, n, step, expected);
        RHEO__TRY(rheo__pieces_get(pieces, index, 0, first, block, n, sizeof *block, error));
        for (size_t i = 0; i < n; i++)
            values[first + i] = rheo__unorder((rheo__real_bits)(rheo__order(expected[i]) + unfold(block[i])));
    }
    return RHEO_OK;
}

static rheo_result read_springs(rheo__pieces_reader *pieces, rheo__fields present, const rheo__values *before,
                                rheo__values *now, spring_changes *springs, rheo_error *error)
{
    size_t olds = before->items[RHEO__FIELD_spring_ends];
    size_t count = olds - springs->went_count + springs->came_count;
    RHEO__TRY(allocate_changes(springs, springs->went_count, springs->came_count, count, error));
    RHEO__TRY(rheo__values_resize(now, RHEO__FIELD_spring_ends, count, error));
    RHEO__TRY(rheo__values_resize(now, RHEO__FIELD_spring_rest_length, count, error));
    uint32_t ends = rheo__field_index(present, RHEO__FIELD_spring_ends);
    RHEO__TRY(rheo__pieces_get(pieces, ends, WENT, 0, springs->went, springs->went_count, 4, error));
    RHEO__TRY(rheo__pieces_get(pieces, ends, CAME, 0, springs->came, 2 * springs->came_count, 4, error));
    RHEO__TRY(rheo__pieces_get(pieces, rheo__field_index(present, RHEO__FIELD_spring_rest_length), 0, 0,
                               springs->rest, count, sizeof *springs->rest, error));
    return apply_changes(before, now, springs) ? RHEO_OK : damaged(pieces, error);
}

/* The number in a field of the world; 0 if the stored state does not have the field. */
static uint64_t stored_number(const rheo__values *now, rheo__field_id field)
{
    uint64_t number = 0;
    if ((now->present >> field & 1) && now->items[field])
        memcpy(&number, now->data[field], sizeof number);
    return number;
}

rheo_result rheo__full_restore(rheo_recording *r, uint64_t step, const rheo__values *now, rheo__fields own,
                               rheo_world *world, rheo_error *error)
{
    rheo__work_state();
    rheo__state *s = &world->state;
    bool history = rheo__state_has(s, RHEO__FIELD_history_rows),
         springs = rheo__state_has(s, RHEO__FIELD_spring_ends);
    uint64_t before = history ? *s->history_rows : 0, rows = rheo__rows_after(s, before);
    RHEO__TRY(rheo__emit(world, error)); /* new particles bring their past with them, which is not stored */
    const size_t spring_count = springs ? now->items[RHEO__FIELD_spring_ends] : 0;
    const uint32_t *ends = springs ? now->data[RHEO__FIELD_spring_ends] : NULL;
    const rheo_real *rest_length = springs ? now->data[RHEO__FIELD_spring_rest_length] : NULL;
    /* Check everything before writing anything: no world may be left with half a state. */
    bool fits = stored_number(now, RHEO__FIELD_step) == step &&
                (!history || stored_number(now, RHEO__FIELD_history_rows) == rows);
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT && fits; f++)
        if ((now->present >> f & 1) && rheo__field_table[f].storage == RHEO__FLAT)
            fits = now->items[f] == rheo__state_items(s, f);
    if (fits && springs)
        fits = rheo__springs_ordered(s->particles, spring_count, ends);
    for (size_t k = 0; k < spring_count && fits; k++)
        fits = rest_length[k] >= 0 && rest_length[k] - rest_length[k] == 0;
    if (!fits) {
        rheo__take_emission_back(world);
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the stored state of step %llu contradicts itself",
                          (unsigned long long)step);
    }
    world->emission.made = false;
    if (springs && !rheo__springs_set(&s->springs, &s->allocator, s->particles, spring_count, ends, rest_length))
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the springs of step %llu",
                          (unsigned long long)step);
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if ((now->present >> f & 1) && rheo__field_table[f].storage == RHEO__FLAT)
            rheo__state_write_row(s, f, 0, now->data[f]);
    if (history && !rheo__world_reserve_history(world, rows))
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the history of step %llu",
                          (unsigned long long)step);
    if (history)
        rheo__world_push_history(world, before);
    RHEO__TRY(rheo__world_check_state(world, false, error));
    uint64_t expected_hash;
    rheo__field_id wrong = rheo__recording_wrong_field(r, world, own, &expected_hash);
    if (wrong != RHEO__FIELD_COUNT)
        return rheo__fail(error, RHEO_ERROR_FORMAT,
                          "damaged: in the stored state of step %llu %s does not have its hash",
                          (unsigned long long)step, rheo__field_table[wrong].name);
    rheo__world_forget_commands(world);
    for (uint32_t i = 0; i < r->head.metric_count; i++)
        rheo__world_restore_metric(world, r->head.metrics[i].text, r->metrics[i]);
    return RHEO_OK;
}

rheo_result rheo__full_read(rheo__pieces_reader *pieces, rheo__fields present, uint64_t raw,
                            const rheo__values *before, rheo__values *now, rheo_error *error)
{
    uint64_t counts[COUNT_VALUES];
    double step;
    RHEO__TRY(rheo__pieces_get(pieces, COUNTS, 0, 0, counts, COUNT_VALUES, sizeof *counts, error));
    memcpy(&step, &counts[5], sizeof step);
    for (int i = 0; i < 5; i++) {
        if (counts[i] / 8 > raw) /* a byte of a piece packs at most eight values */
            return damaged(pieces, error);
        if (counts[i] > SIZE_MAX / 64) /* no product of it overflows where size_t has 32 bits */
            return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the stored state of step %llu",
                              (unsigned long long)pieces->step);
    }
    rheo__field_id particles;
    for (uint32_t n = 0; (particles = nth_particle_field(present, n)) != RHEO__FIELD_COUNT; n++) {
        RHEO__TRY(rheo__values_resize(now, particles, counts[0], error));
        RHEO__TRY(read_particles(pieces, rheo__field_index(present, particles), before, now, particles,
                                 (rheo_real)step, error));
    }
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        const rheo__field *field = &rheo__field_table[f];
        if (!(present >> f & 1) || field->storage != RHEO__FLAT || is_particle(f))
            continue;
        const uint64_t items = field->location == RHEO_LOCATION_WORLD      ? 1
                               : field->location == RHEO_LOCATION_PARTICLE ? counts[0]
                               : field->location == RHEO_LOCATION_BODY     ? counts[1]
                               : field->location == RHEO_LOCATION_OBSTACLE ? before->items[f]
                                                                           : counts[2];
        RHEO__TRY(rheo__values_resize(now, f, items, error));
        RHEO__TRY(rheo__pieces_get(pieces, rheo__field_index(present, f), 0, 0, now->data[f],
                                   (size_t)items * field->components, rheo__element_size(field->element), error));
    }
    if (present >> RHEO__FIELD_spring_ends & 1) {
        spring_changes springs = {.went_count = (size_t)counts[3], .came_count = (size_t)counts[4]};
        if (counts[3] > before->items[RHEO__FIELD_spring_ends])
            return damaged(pieces, error);
        rheo_result result = read_springs(pieces, present, before, now, &springs, error);
        release_changes(&springs);
        RHEO__TRY(result);
    }
    return rheo__pieces_end(pieces, error);
}
