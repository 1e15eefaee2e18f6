/* Looking at a world: particles, springs, history, bodies, vibrators, fields, stages. Nothing here changes it. */
#include "world/world.h"

#include <string.h>

#include "solids/solids.h"
#include "world/model_melting.h"
#include "world/model_thickening.h"

const rheo_world_def *rheo_world_definition(const rheo_world *w)
{
    return &w->def;
}

uint64_t rheo_world_step_count(const rheo_world *w)
{
    return *w->state.step;
}

double rheo_world_time(const rheo_world *w)
{
    /* Counted from the last change of the time step, so that rounding does not pile up. */
    return *w->state.time_origin + (double)(*w->state.step - *w->state.step_origin) * w->def.step;
}

uint64_t rheo_world_hash(const rheo_world *w)
{
    return rheo__state_hash(&w->state);
}

uint32_t rheo_world_particle_count(const rheo_world *w)
{
    return w->state.particles;
}

const rheo_real *rheo_world_positions(const rheo_world *w)
{
    return w->state.position;
}

const rheo_real *rheo_world_velocities(const rheo_world *w)
{
    return w->state.velocity;
}

/* ---- Springs ---- */

size_t rheo_world_spring_count(const rheo_world *w)
{
    return rheo__pairs_count(&w->state.springs.pairs);
}

rheo_result rheo_world_springs(const rheo_world *w, rheo_spring *springs, size_t capacity)
{
    size_t count = rheo_world_spring_count(w);
    const rheo_allocator *allocator = &w->def.allocator;
    uint32_t *ends = rheo__allocate(allocator, count + 1, 2 * sizeof *ends);
    rheo_real *rest_length = rheo__allocate(allocator, count + 1, sizeof *rest_length);
    bool enough = ends && rest_length && rheo__springs_read(&w->state.springs, allocator, ends, rest_length);
    for (size_t k = 0; enough && k < count && k < capacity; k++)
        springs[k] = (rheo_spring){ends[2 * k], ends[2 * k + 1], rest_length[k]};
    rheo__release(allocator, ends);
    rheo__release(allocator, rest_length);
    return enough ? RHEO_OK : RHEO_ERROR_MEMORY;
}

rheo_result rheo_world_spring(const rheo_world *w, uint32_t a, uint32_t b, rheo_spring_state *state,
                              rheo_error *error)
{
    size_t place = rheo__springs_find(&w->state.springs, a, b);
    if (place == SIZE_MAX)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "particles %u and %u are not connected by a spring", a, b);
    const rheo_real *xa = w->state.position + 3 * (size_t)a, *xb = w->state.position + 3 * (size_t)b;
    rheo_real d[3] = {0, 0, 0};
    if ((w->features & RHEO__FEATURE_HISTORY))
        rheo__pair_derivative(&w->state, rheo__thickening_of(w), a, b, d);
    state->spring = (rheo_spring){a < b ? a : b, a < b ? b : a, w->state.springs.rest_length[place]};
    state->length = (double)rheo__sqrt(rheo__length2(xb[0] - xa[0], xb[1] - xa[1], xb[2] - xa[2]));
    state->history_rate = (double)rheo__sqrt(rheo__length2(d[0], d[1], d[2]));
    state->stiffness = (double)rheo__spring_stiffness(rheo__thickening_of(w), d);
    state->kappa = (double)rheo__spring_kappa(rheo__thickening_of(w), d);
    return RHEO_OK;
}

/* ---- History ---- */

uint32_t rheo_world_history_window(const rheo_world *w)
{
    return (w->features & RHEO__FEATURE_HISTORY) && w->def.history.kind != RHEO_HISTORY_FULL ? w->def.history.window
                                                                                             : 0;
}

uint32_t rheo_world_history_rows(const rheo_world *w)
{
    if (!(w->features & RHEO__FEATURE_HISTORY))
        return 0;
    return w->state.ring.length ? (uint32_t)*w->state.history_rows : *w->state.history_rows > 0;
}

size_t rheo_world_history_bytes(const rheo_world *w)
{
    return (size_t)w->state.particles * ((size_t)w->state.ring.length + w->state.modes.length) * 3 *
           sizeof(rheo_real);
}

/* A remembered velocity: of the ring or, without one, the newest. */
static rheo_real remembered(const rheo_world *w, uint32_t lag, size_t value)
{
    return rheo__ring_value(w->state.ring.length ? &w->state.ring : &w->state.modes, lag, value);
}

rheo_result rheo_world_particle_history(const rheo_world *w, uint32_t id, rheo_real *velocity)
{
    if (id >= w->state.particles || !(w->features & RHEO__FEATURE_HISTORY))
        return RHEO_ERROR_ARGUMENT;
    for (uint32_t lag = 0; lag < rheo_world_history_rows(w); lag++)
        for (size_t axis = 0; axis < 3; axis++)
            velocity[3 * (size_t)lag + axis] = remembered(w, lag, 3 * (size_t)id + axis);
    return RHEO_OK;
}

rheo_result rheo_world_spring_history(const rheo_world *w, uint32_t a, uint32_t b, rheo_real *difference)
{
    if (a >= w->state.particles || b >= w->state.particles || !(w->features & RHEO__FEATURE_HISTORY))
        return RHEO_ERROR_ARGUMENT;
    for (uint32_t lag = 0; lag < rheo_world_history_rows(w); lag++)
        for (size_t axis = 0; axis < 3; axis++)
            difference[3 * (size_t)lag + axis] =
                remembered(w, lag, 3 * (size_t)a + axis) - remembered(w, lag, 3 * (size_t)b + axis);
    return RHEO_OK;
}

uint32_t rheo_world_history_modes(const rheo_world *w)
{
    return rheo__state_has(&w->state, RHEO__FIELD_history_modes) ? rheo__thickening_of(w)->modes.count : 0;
}

rheo_result rheo_world_particle_modes(const rheo_world *w, uint32_t id, rheo_mode_state *modes)
{
    const rheo__modes *of = &rheo__thickening_of(w)->modes;
    const rheo__state *s = &w->state;
    if (id >= s->particles || !rheo__state_has(s, RHEO__FIELD_history_modes))
        return RHEO_ERROR_ARGUMENT;
    const uint32_t first = s->ring.length == 0; /* row of the first mode */
    for (uint32_t k = 0; k < of->count; k++) {
        modes[k] = (rheo_mode_state){.decay = (double)of->decay[k], .weight = (double)of->weight[k]};
        for (size_t axis = 0; axis < 3; axis++) {
            const size_t value = 3 * (size_t)id + axis;
            modes[k].sum[axis] = (double)rheo__ring_value(&s->modes, first + k, value);
            if (k < of->slow)
                modes[k].sum[axis] += (double)rheo__ring_value(&s->modes, first + of->count + k, value);
        }
    }
    return RHEO_OK;
}

rheo_result rheo_world_spring_modes(const rheo_world *w, uint32_t a, uint32_t b, rheo_mode_state *modes)
{
    rheo_mode_state other[RHEO_HISTORY_MAX_MODES];
    if (rheo_world_particle_modes(w, b, other) != RHEO_OK || rheo_world_particle_modes(w, a, modes) != RHEO_OK)
        return RHEO_ERROR_ARGUMENT;
    for (uint32_t k = 0; k < rheo__thickening_of(w)->modes.count; k++)
        for (int axis = 0; axis < 3; axis++)
            modes[k].sum[axis] -= other[k].sum[axis];
    return RHEO_OK;
}

/* ---- Bodies and vibrators ---- */

uint32_t rheo_world_body_count(const rheo_world *w)
{
    return w->state.bodies;
}

rheo_result rheo_world_body(const rheo_world *w, uint32_t index, rheo_body *body)
{
    if (index >= w->state.bodies)
        return RHEO_ERROR_ARGUMENT;
    for (int axis = 0; axis < 3; axis++) {
        body->position[axis] = (double)w->state.ball_position[axis];
        body->velocity[axis] = (double)w->state.ball_velocity[axis];
        body->spin[axis] = (double)w->state.ball_spin[axis];
    }
    for (int i = 0; i < 4; i++)
        body->orientation[i] = (double)w->state.ball_orientation[i];
    body->radius = (double)w->solids->radius;
    body->mass = (double)w->solids->mass;
    return RHEO_OK;
}

uint32_t rheo_world_vibrator_count(const rheo_world *w)
{
    return w->state.vibrators;
}

rheo_result rheo_world_vibrator(const rheo_world *w, uint32_t index, rheo_vibrator *vibrator)
{
    if (index >= w->state.vibrators)
        return RHEO_ERROR_ARGUMENT;
    *vibrator = (rheo_vibrator){(double)w->state.vibrator_position[2 * index],
                                (double)w->state.vibrator_position[2 * index + 1],
                                (double)w->state.vibrator_phase[index], (double)w->state.vibrator_frequency[index]};
    return RHEO_OK;
}

/* ---- Fields ---- */

/* The index-th field that this world has, or RHEO__FIELD_COUNT. */
static rheo__field_id nth_field(const rheo_world *w, uint32_t index)
{
    rheo__field_id f = 0;
    for (; f < RHEO__FIELD_COUNT; f++)
        if (rheo__state_has(&w->state, f) && index-- == 0)
            break;
    return f;
}

uint32_t rheo_world_field_count(const rheo_world *w)
{
    uint32_t count = 0;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        count += rheo__state_has(&w->state, f);
    return count;
}

rheo_result rheo_world_field(const rheo_world *w, uint32_t index, rheo_field_info *info)
{
    rheo__field_id f = nth_field(w, index);
    if (f == RHEO__FIELD_COUNT)
        return RHEO_ERROR_ARGUMENT;
    const rheo__field *field = &rheo__field_table[f];
    uint64_t rows = rheo__state_rows(&w->state, f);
    *info = (rheo_field_info){field->name,
                              field->element,
                              field->location,
                              field->components,
                              rheo__in_rows(f),
                              rows,
                              rheo__state_items(&w->state, f),
                              rows * rheo__state_row_bytes(&w->state, f)};
    return RHEO_OK;
}

rheo_result rheo_world_field_read(const rheo_world *w, uint32_t index, void *values, size_t bytes)
{
    rheo__field_id f = nth_field(w, index);
    if (f == RHEO__FIELD_COUNT)
        return RHEO_ERROR_ARGUMENT;
    size_t row_bytes = rheo__state_row_bytes(&w->state, f);
    uint64_t rows = rheo__state_rows(&w->state, f);
    if (bytes < rows * row_bytes)
        return RHEO_ERROR_ARGUMENT;
    for (uint64_t row = 0; row < rows; row++)
        if (!rheo__state_read_row(&w->state, f, row, (char *)values + row * row_bytes))
            return RHEO_ERROR_MEMORY;
    return RHEO_OK;
}

rheo_result rheo__world_check_state(const rheo_world *w, bool rings, rheo_error *error)
{
    const rheo__state *s = &w->state;
    rheo__field_id field;
    uint64_t item;
    uint32_t component;
    if (!rheo__state_finite(s, &field, &item, &component))
        return rheo__fail(error, RHEO_ERROR_FORMAT, "%s of item %llu is not finite", rheo__field_table[field].name,
                          (unsigned long long)item);
    for (uint32_t i = 0; i < s->particles && rheo__melting_of(w); i++)
        if (!(s->density[i] > 0))
            return rheo__fail(error, RHEO_ERROR_FORMAT, "the density of particle %u is not above 0", i);
    for (uint32_t i = 0; i < s->vibrators; i++)
        if (!(s->vibrator_phase[i] >= 0 && s->vibrator_phase[i] < 1 && s->vibrator_frequency[i] >= 0))
            return rheo__fail(error, RHEO_ERROR_FORMAT, "vibrator %u has no phase from 0 to 1, or no frequency", i);
    if (!(w->features & RHEO__FEATURE_HISTORY))
        return RHEO_OK;
    for (uint32_t row = 0; rings && row < s->modes.length; row++)
        for (size_t value = 0; value < 3 * (size_t)s->particles; value++) {
            const rheo_real v = rheo__ring_value(&s->modes, row, value);
            if (!(v <= RHEO__LARGEST_MODE && v >= -RHEO__LARGEST_MODE))
                return rheo__fail(error, RHEO_ERROR_FORMAT, "history_modes of particle %zu, row %u, is not finite",
                                  value / 3, row);
        }
    if (!s->ring.length && *s->history_rows >> 63)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "%llu velocities are more than a history can have had",
                          (unsigned long long)*s->history_rows);
    if (s->ring.length && *s->history_rows > s->ring.length)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "%llu rows of history are more than the %u of the window",
                          (unsigned long long)*s->history_rows, s->ring.length);
    for (uint32_t lag = 0; rings && lag < rheo_world_history_rows(w) && s->ring.length; lag++)
        for (size_t value = 0; value < 3 * (size_t)s->particles; value++) {
            rheo_real v = rheo__ring_value(&s->ring, lag, value);
            if (v - v != 0 || (s->modes.length && !(v <= RHEO__LARGEST_SPEED && v >= -RHEO__LARGEST_SPEED)))
                return rheo__fail(error, RHEO_ERROR_FORMAT,
                                  "history_velocity of particle %zu at lag %u is not finite", value / 3, lag);
        }
    return RHEO_OK;
}

/* ---- Stages ---- */

uint32_t rheo_world_stage_count(const rheo_world *w)
{
    return w->stage_count;
}

rheo_result rheo_world_stage(const rheo_world *w, uint32_t index, rheo_stage_info *info)
{
    if (index >= w->stage_count)
        return RHEO_ERROR_ARGUMENT;
    *info = (rheo_stage_info){w->stage[index].name,
                              index < w->stages_before_substeps ? w->steps_timed : w->substeps_timed,
                              w->stage_seconds[index]};
    return RHEO_OK;
}

uint32_t rheo_world_stages_done(const rheo_world *w)
{
    return (uint32_t)w->stage_runs_done;
}

bool rheo_world_failure(const rheo_world *w, rheo_failure *failure)
{
    *failure = w->failure;
    return w->failed;
}

void rheo_world_reset_times(rheo_world *w)
{
    memset(w->stage_seconds, 0, sizeof w->stage_seconds);
    w->steps_timed = w->substeps_timed = 0;
}
