/* Reads a world: particles, springs, history, bodies, vibrators, fields, stages. */
#include "world/model.h"

#include <string.h>

#include "solids/solids.h"
#include "world/stage_runs.h"

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
    /* Counting from the last change of the time step keeps rounding errors from adding up. */
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
    return w->state.springs.count;
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
    const size_t index = w->type->query_spring ? rheo__springs_find(&w->state.springs, a, b) : SIZE_MAX;
    if (index == SIZE_MAX)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "particles %u and %u are not connected by a spring", a, b);
    const rheo_real *xa = w->state.position + 3 * (size_t)a, *xb = w->state.position + 3 * (size_t)b;
    state->spring = (rheo_spring){a < b ? a : b, a < b ? b : a, w->state.springs.rest_length[index]};
    state->length = (double)rheo__sqrt(rheo__length2(xb[0] - xa[0], xb[1] - xa[1], xb[2] - xa[2]));
    w->type->query_spring(w, a, b, state);
    return RHEO_OK;
}

/* ---- History ---- */

static bool has_history(const rheo_world *w)
{
    return rheo__state_has(&w->state, RHEO__FIELD_history_rows);
}

/* Memories of positions always have that of the start, and a mean velocity between any two. */
static bool has_lengths(const rheo_world *w)
{
    return rheo__state_has(&w->state, RHEO__FIELD_history_position);
}

uint32_t rheo_world_history_window(const rheo_world *w)
{
    return has_history(w) && w->def.history.kind != RHEO_HISTORY_FULL ? w->def.history.window : 0;
}

uint32_t rheo_world_history_lag(const rheo_world *w)
{
    return has_history(w) ? w->def.history.lag : 0;
}

uint32_t rheo_world_history_rows(const rheo_world *w)
{
    if (!has_history(w))
        return 0;
    const bool window = w->def.history.kind == RHEO_HISTORY_WINDOW || w->def.history.kind == RHEO_HISTORY_WINDOW_FAST;
    const uint64_t rows = *w->state.history_rows - has_lengths(w), waiting = (uint64_t)w->def.history.lag + 1;
    return (uint32_t)(window || rows < waiting ? rows : waiting); /* the others have entered the modes */
}

size_t rheo_world_history_bytes(const rheo_world *w)
{
    return (size_t)w->state.particles * ((size_t)w->state.ring.rows + w->state.modes.rows) * 3 * sizeof(rheo_real);
}

/* A stored velocity, or the mean one between two stored positions. Without a ring only the newest is stored, as the first row of the modes. */
static rheo_real remembered(const rheo_world *w, uint32_t lag, size_t value)
{
    if (has_lengths(w))
        return (rheo__ring_value(&w->state.ring, lag, value) - rheo__ring_value(&w->state.ring, lag + 1, value)) /
               (rheo_real)w->def.step;
    return rheo__ring_value(w->state.ring.length ? &w->state.ring : &w->state.modes, lag, value);
}

rheo_result rheo_world_particle_history(const rheo_world *w, uint32_t id, rheo_real *velocity)
{
    if (id >= w->state.particles || !has_history(w))
        return RHEO_ERROR_ARGUMENT;
    for (uint32_t lag = 0; lag < rheo_world_history_rows(w); lag++)
        for (size_t axis = 0; axis < 3; axis++)
            velocity[3 * (size_t)lag + axis] = remembered(w, lag, 3 * (size_t)id + axis);
    return RHEO_OK;
}

rheo_result rheo_world_spring_history(const rheo_world *w, uint32_t a, uint32_t b, rheo_real *difference)
{
    if (a >= w->state.particles || b >= w->state.particles || !has_history(w))
        return RHEO_ERROR_ARGUMENT;
    for (uint32_t lag = 0; lag < rheo_world_history_rows(w); lag++)
        for (size_t axis = 0; axis < 3; axis++)
            difference[3 * (size_t)lag + axis] =
                remembered(w, lag, 3 * (size_t)a + axis) - remembered(w, lag, 3 * (size_t)b + axis);
    return RHEO_OK;
}

uint32_t rheo_world_history_modes(const rheo_world *w)
{
    return w->type->query_modes ? w->type->query_modes(w, 0, NULL) : 0;
}

rheo_result rheo_world_particle_modes(const rheo_world *w, uint32_t id, rheo_mode_state *modes)
{
    if (id >= w->state.particles || rheo_world_history_modes(w) == 0)
        return RHEO_ERROR_ARGUMENT;
    w->type->query_modes(w, id, modes);
    return RHEO_OK;
}

rheo_result rheo_world_spring_modes(const rheo_world *w, uint32_t a, uint32_t b, rheo_mode_state *modes)
{
    rheo_mode_state other[RHEO_HISTORY_MAX_MODES];
    if (rheo_world_particle_modes(w, b, other) != RHEO_OK || rheo_world_particle_modes(w, a, modes) != RHEO_OK)
        return RHEO_ERROR_ARGUMENT;
    for (uint32_t k = 0; k < rheo_world_history_modes(w); k++)
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
        body->position[axis] = (double)w->state.ball_position[3 * (size_t)index + axis];
        body->velocity[axis] = (double)w->state.ball_velocity[3 * (size_t)index + axis];
        body->spin[axis] = (double)w->state.ball_spin[3 * (size_t)index + axis];
    }
    for (int i = 0; i < 4; i++)
        body->orientation[i] = (double)w->state.ball_orientation[4 * (size_t)index + i];
    body->radius = (double)(rheo_real)rheo__ball_of(&w->def, index)->radius;
    body->mass = (double)w->solids->ball_mass[index];
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

bool rheo_world_plate(const rheo_world *w, uint32_t plate, rheo_plate *values)
{
    return w->type->query_plate && w->type->query_plate(w, plate, values);
}

/* Field by index among those that the world has; RHEO__FIELD_COUNT past the last. */
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

/* ---- Stages ---- */

uint32_t rheo_world_stage_count(const rheo_world *w)
{
    return w->stage_count;
}

rheo_result rheo_world_stage(const rheo_world *w, uint32_t index, rheo_stage_info *info)
{
    if (index >= w->stage_count)
        return RHEO_ERROR_ARGUMENT;
    const bool in_substeps = rheo__world_phase(w, index) == RHEO__IN_SUBSTEPS;
    *info = (rheo_stage_info){w->stage[index].name, in_substeps ? w->substeps_timed : w->steps_timed,
                              w->stage_seconds[index], in_substeps};
    return RHEO_OK;
}

uint32_t rheo_world_stages_done(const rheo_world *w)
{
    return (uint32_t)w->stage_runs_done;
}

uint32_t rheo_world_stages_in_step(const rheo_world *w)
{
    return (uint32_t)rheo__world_stage_runs_in_step(w);
}

void rheo_world_last_stage(const rheo_world *w, char name[32])
{
    name[0] = 0;
    if (w->stage_runs_done > 0)
        rheo__world_stage_run_name(w, w->stage_runs_done - 1, name);
}

rheo_result rheo__world_check_between_steps(const rheo_world *w, const char *cannot, rheo_error *error)
{
    if (w->stage_runs_done == 0)
        return RHEO_OK;
    char name[32];
    rheo__world_stage_run_name(w, w->stage_runs_done - 1, name);
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "in the middle of step %llu, after stage %s, a world %s; finish the step",
                      (unsigned long long)*w->state.step + 1, name, cannot);
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
