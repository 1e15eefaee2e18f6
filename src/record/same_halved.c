/*
 * A step made in two halves (record/same.h): a world of half the step takes over the state and makes two steps. A window
 * and a lag of the memory keep their times, so that they have twice the steps; the past between two recorded rows is
 * their mean.
 */
#include <stdlib.h>

#include "record/same.h"

bool rheo__same_can_halve(const rheo_world *world)
{
    return !rheo__state_has(&world->state, RHEO__FIELD_history_modes) && world->def.history.window <= 500000 &&
           world->def.history.lag <= 500000;
}

static rheo_result no_memory(rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to make a step in two halves");
}

static rheo_result make(const rheo_world *w, const rheo__values *v, rheo_world **half, rheo_error *error)
{
    rheo_world_def def = w->def;
    def.step = w->def.step / 2;
    def.history.window = 2 * w->def.history.window;
    def.history.lag = 2 * w->def.history.lag;
    def.particles.count = w->state.particles;
    def.particles.position = v->data[RHEO__FIELD_position];
    def.particles.velocity = v->data[RHEO__FIELD_velocity];
    if (rheo__state_has(&w->state, RHEO__FIELD_material))
        def.particles.material = v->data[RHEO__FIELD_material];
    if (rheo__state_has(&w->state, RHEO__FIELD_spring_ends)) {
        def.particles.spring_count = (uint32_t)v->items[RHEO__FIELD_spring_ends];
        def.particles.spring_ends = v->data[RHEO__FIELD_spring_ends];
        def.particles.spring_rest_length = v->data[RHEO__FIELD_spring_rest_length];
    }
    return rheo__world_make(&def, w->features, half, error);
}

/* The past of `w` at twice as many times. */
static rheo_result fill_ring(const rheo_world *w, rheo__field_id f, rheo_world *half, rheo_error *error)
{
    const rheo__state *from = &w->state;
    rheo__state *to = &half->state;
    const uint64_t rows = rheo__state_rows(from, f);
    const uint64_t fitting = rows ? 2 * rows - 1 : 0, filled = fitting < to->ring.length ? fitting : to->ring.length;
    const size_t values = (size_t)rheo__state_items(from, f) * rheo__field_table[f].components;
    *to->history_rows = filled;
    if (filled == 0)
        return RHEO_OK;
    rheo_real *row = malloc(2 * values * sizeof *row + 1);
    if (!row || !rheo__world_reserve_history(half, filled)) {
        free(row);
        return no_memory(error);
    }
    rheo__ring_fill(&to->ring, (uint32_t)filled);
    for (uint64_t lag = 0; lag < filled; lag++) {
        rheo__state_read_row(from, f, lag / 2, row);
        if (lag % 2) {
            rheo__state_read_row(from, f, lag / 2 + 1, row + values);
            for (size_t i = 0; i < values; i++)
                row[i] = row[i] / 2 + row[values + i] / 2;
        }
        rheo__state_write_row(to, f, lag, row);
    }
    free(row);
    return RHEO_OK;
}

static rheo_result fill(const rheo_world *w, const rheo__values *v, rheo_world *half, rheo_error *error)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if ((v->present >> f & 1) && rheo__field_table[f].storage == RHEO__FLAT)
            rheo__state_write_row(&half->state, f, 0, v->data[f]);
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (rheo__state_has(&w->state, f) && rheo__field_table[f].storage == RHEO__RING)
            RHEO__TRY(fill_ring(w, f, half, error));
    if (w->features & RHEO__FEATURE_EMITTERS) { /* the first half emits what the whole step does */
        *half->state.step_origin = *half->state.step;
        *half->state.time_origin = rheo_world_time(w);
    }
    return rheo__world_configure(half) ? RHEO_OK : no_memory(error);
}

rheo_result rheo__same_halves(const rheo_world *world, rheo__values *values, bool *failed, rheo_error *error)
{
    rheo_world *half = NULL;
    *failed = false;
    RHEO__TRY(rheo__values_take(values, &world->state, false, error));
    rheo_result result = make(world, values, &half, error);
    if (result == RHEO_OK)
        result = fill(world, values, half, error);
    for (int i = 0; i < 2 && result == RHEO_OK; i++) {
        result = rheo_world_step(half, error);
        for (uint32_t k = 0; k < half->def.emitters.count; k++)
            half->def.emitters.list[k].flow = RHEO_EMITTER_OFF; /* the second half emits nothing */
    }
    *failed = result == RHEO_ERROR_STATE;
    if (result == RHEO_OK)
        result = rheo__values_take(values, &half->state, false, error);
    rheo_world_destroy(half);
    return *failed ? RHEO_OK : result;
}
