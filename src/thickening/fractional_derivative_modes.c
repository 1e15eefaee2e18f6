/*
 * Stage fractional_derivative of memories of modes (docs/model.md, 2 and History): with the newest velocity v that
 * counts and the sums y_k over the others,
 *
 *     D^q x = C0 (v + sum_k w_k y_k),
 *
 * summed from the slowest mode to the fastest.
 */
#include "core/account_lanes.h"
#include "thickening/thickening.h"

/* A part of a block is summed at once: as much as fits into eight registers. */
enum {
    VECTORS = RHEO__RING_BLOCK / RHEO__LANES < 8 ? RHEO__RING_BLOCK / RHEO__LANES : 8,
    PART = VECTORS * RHEO__LANES,
};

static const rheo__lanes *lanes_of(const rheo_real *values)
{
    return (const rheo__lanes *)(const void *)values;
}

/* The terms of one particle, in the order of the sums below. */
static void keep_account(const rheo__state *s, const rheo__thickening *t)
{
    rheo__account_begin(s, RHEO__SUM_past);
    const size_t value = 3 * (size_t)s->account->id;
    rheo_real term[3];
    for (uint32_t k = 0; k <= t->modes.count && rheo__old_rows(t, *s->history_rows) > 0; k++) {
        const bool newest = k == t->modes.count;
        for (size_t axis = 0; axis < 3; axis++) {
            const size_t block = (value + axis) / RHEO__RING_BLOCK, inside = (value + axis) % RHEO__RING_BLOCK;
            term[axis] = newest
                             ? rheo__newest_velocities(s, t, block)[inside]
                             : t->modes.weight[k] * rheo__ring_block(&s->modes, block, rheo__mode_slot(s, k))[inside];
        }
        rheo__account_add(s, RHEO__SUM_past, newest ? RHEO_SOURCE_PAST : RHEO_SOURCE_MODE,
                          newest ? t->def->history.lag : k, term[0], term[1], term[2]);
    }
    rheo__account_renew(s, RHEO__FIELD_derivative, RHEO_SOURCE_SUM, t->derivative_scale, RHEO__SUM_past);
}

rheo_result RHEO__VARIANT(stage_fractional_derivative_modes)(rheo__state *s, void *context)
{
    const rheo__thickening *t = context;
    rheo__state_renew(s, RHEO__FIELD_derivative);
    rheo_real *derivative = s->derivative;
    const size_t values = 3 * (size_t)s->particles;
    const rheo__ring *modes = &s->modes;
    if (rheo__keeps_any(s))
        keep_account(s, t);
    if (rheo__old_rows(t, *s->history_rows) == 0) {
        memset(derivative, 0, values * sizeof *derivative);
        return RHEO_OK;
    }
    for (size_t first = 0; first < values; first += PART) {
        const size_t block = first / RHEO__RING_BLOCK, inside = first % RHEO__RING_BLOCK;
        rheo__lanes sum[VECTORS] = {0};
        for (uint32_t k = 0; k < t->modes.count; k++) {
            const rheo__lanes *y = lanes_of(rheo__ring_block(modes, block, rheo__mode_slot(s, k)) + inside);
            const rheo__lanes w = rheo__lanes_all(t->modes.weight[k]);
#pragma GCC unroll 8
            for (int v = 0; v < VECTORS; v++)
                sum[v] += w * y[v];
        }
        const rheo__lanes *newest = lanes_of(rheo__newest_velocities(s, t, block) + inside);
        rheo__lanes d[VECTORS];
#pragma GCC unroll 8
        for (int v = 0; v < VECTORS; v++)
            d[v] = rheo__lanes_all(t->derivative_scale) * (newest[v] + sum[v]);
        memcpy(derivative + first, d, (values - first < PART ? values - first : PART) * sizeof *derivative);
    }
    return RHEO_OK;
}
