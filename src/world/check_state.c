/* Checks of a state that was loaded from a file. */
#include "thickening/margins.h"
#include "world/world.h"

static rheo_result check_modes(const rheo__state *s, rheo_error *error)
{
    for (uint32_t row = 0; row < s->modes.length; row++)
        for (size_t value = 0; value < 3 * (size_t)s->particles; value++) {
            const rheo_real v = rheo__ring_value(&s->modes, row, value);
            if (!(v <= RHEO__LARGEST_MODE && v >= -RHEO__LARGEST_MODE))
                return rheo__fail(error, RHEO_ERROR_FORMAT, "history_modes of particle %zu, row %u, is not finite",
                                  value / 3, row);
        }
    return RHEO_OK;
}

static rheo_result check_ring(const rheo__state *s, uint32_t rows, rheo_error *error)
{
    const rheo__field_id f = rheo__state_has(s, RHEO__FIELD_history_position) ? RHEO__FIELD_history_position
                                                                              : RHEO__FIELD_history_velocity;
    for (uint32_t lag = 0; lag < rows && s->ring.length; lag++)
        for (size_t value = 0; value < 3 * (size_t)s->particles; value++) {
            const rheo_real v = rheo__ring_value(&s->ring, lag, value);
            if (v - v != 0 || (s->modes.length && !(v <= RHEO__LARGEST_SPEED && v >= -RHEO__LARGEST_SPEED)))
                return rheo__fail(error, RHEO_ERROR_FORMAT, "%s of particle %zu at lag %u is not finite",
                                  rheo__field_table[f].name, value / 3, lag);
        }
    return RHEO_OK;
}

static rheo_result check_history(const rheo_world *w, bool rings, rheo_error *error)
{
    const rheo__state *s = &w->state;
    if (!rheo__state_has(s, RHEO__FIELD_history_rows))
        return RHEO_OK;
    if (rings)
        RHEO__TRY(check_modes(s, error));
    if (!s->ring.length && *s->history_rows >> 63)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "%llu velocities are more than a history can have had",
                          (unsigned long long)*s->history_rows);
    if (s->ring.length && *s->history_rows > s->ring.length)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "%llu rows of history are more than the %u of the window",
                          (unsigned long long)*s->history_rows, s->ring.length);
    if (rheo__state_has(s, RHEO__FIELD_history_position) && *s->history_rows == 0)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "the history has no position, and must begin with one");
    return rings ? check_ring(s, (uint32_t)*s->history_rows, error) : RHEO_OK;
}

/*
 * The list of periodic space has room for the images of particles that are near one border of an axis at most: those inside
 * of the period, with margins as stage neighbours sets them.
 */
static rheo_result check_list(const rheo_world *w, rheo_error *error)
{
    const rheo__state *s = &w->state;
    const double rounding = 1 + 1e-6, most = RHEO__MOST_MARGIN * w->def.fluid.support * rounding;
    for (size_t i = 0; i < 3 * (size_t)s->particles && w->period.axes && s->list_position; i++) {
        const double half = (double)w->period.length[i % 3] / 2 * rounding, x = (double)s->list_position[i];
        if (half > 0 && !(x <= half && x >= -half))
            return rheo__fail(error, RHEO_ERROR_FORMAT, "the list has particle %zu outside of the period of space",
                              i / 3);
        if (!((double)s->list_margin[i / 3] <= most))
            return rheo__fail(error, RHEO_ERROR_FORMAT, "the margin of particle %zu in the list is too wide", i / 3);
    }
    return RHEO_OK;
}

rheo_result rheo__world_check_state(const rheo_world *w, bool rings, rheo_error *error)
{
    const rheo__state *s = &w->state;
    rheo__field_id field;
    uint64_t item;
    uint32_t component;
    if (!rheo__state_finite(s, s->present, &field, &item, &component))
        return rheo__fail(error, RHEO_ERROR_FORMAT, "%s of item %llu is not finite", rheo__field_table[field].name,
                          (unsigned long long)item);
    for (uint32_t i = 0; i < s->particles && s->density; i++)
        if (!(s->density[i] > 0))
            return rheo__fail(error, RHEO_ERROR_FORMAT, "the density of particle %u is not above 0", i);
    for (uint32_t i = 0; i < s->particles && s->material; i++)
        if (s->material[i] > w->def.materials.count)
            return rheo__fail(error, RHEO_ERROR_FORMAT, "particle %u is of material %u; the last material is %u", i,
                              s->material[i], w->def.materials.count);
    for (uint32_t i = 0; i < s->particles && s->plate; i++)
        if (s->plate[i] > 2)
            return rheo__fail(error, RHEO_ERROR_FORMAT, "particle %u is of plate %u; there are two plates", i,
                              s->plate[i]);
    if (s->plate_phase && !(*s->plate_phase >= 0 && *s->plate_phase < 1))
        return rheo__fail(error, RHEO_ERROR_FORMAT, "the phase of the upper plate is not from 0 to 1");
    for (uint32_t i = 0; i < s->vibrators; i++)
        if (!(s->vibrator_phase[i] >= 0 && s->vibrator_phase[i] < 1 && s->vibrator_frequency[i] >= 0))
            return rheo__fail(error, RHEO_ERROR_FORMAT, "vibrator %u has no phase from 0 to 1, or no frequency", i);
    for (uint32_t i = 0; i < s->bodies && s->ball_push_phase; i++)
        if (!(s->ball_push_phase[i] >= 0 && s->ball_push_phase[i] < 1))
            return rheo__fail(error, RHEO_ERROR_FORMAT, "the push of ball %u has no phase from 0 to 1", i);
    for (uint32_t i = 0; i < s->obstacles && s->obstacle_phase; i++) {
        const double *q = s->obstacle_rotation + 4 * (size_t)i,
                     length2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        if (!(s->obstacle_phase[i] >= 0 && s->obstacle_phase[i] < 1 && length2 > 0.999 && length2 < 1.001))
            return rheo__fail(error, RHEO_ERROR_FORMAT,
                              "obstacle %u has no phase from 0 to 1, or no unit quaternion as its rotation", i);
    }
    for (uint32_t k = 0; k < RHEO_MAX_EMITTERS && s->emitter_way; k++)
        if (!(s->emitter_way[k] >= 0))
            return rheo__fail(error, RHEO_ERROR_FORMAT, "the way of emitter %u to its next layer is below 0", k);
    RHEO__TRY(check_list(w, error));
    return check_history(w, rings, error);
}
