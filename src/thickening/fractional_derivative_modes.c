/*
 * Stage fractional_derivative of memories of modes (docs/model.md, 5 and History): with the newest velocity v and the
 * sums y_k over the others,
 *
 *     D^q x = C0 (v + sum_k w_k y_k),
 *
 * summed from the slowest mode to the fastest.
 */
#include "core/lanes.h"
#include "thickening/kernels.h"

/* A part of a block is summed at once: as much as fits into eight registers. */
enum {
    VECTORS = RHEO_RING_BLOCK / RHEO_LANES < 8 ? RHEO_RING_BLOCK / RHEO_LANES : 8,
    PART = VECTORS * RHEO_LANES,
};

static const rheo_lanes *lanes_of(const rheo_real *values)
{
    return (const rheo_lanes *)(const void *)values;
}

rheo_result RHEO_KERNEL(stage_fractional_derivative_modes)(rheo_state *s, void *context)
{
    const rheo_thickening *t = context;
    rheo_real *derivative = t->derivative;
    const size_t values = 3 * (size_t)s->particles;
    const rheo_ring *modes = &s->modes;
    if (*s->history_rows == 0) {
        memset(derivative, 0, values * sizeof *derivative);
        return RHEO_OK;
    }
    for (size_t first = 0; first < values; first += PART) {
        const size_t block = first / RHEO_RING_BLOCK, inside = first % RHEO_RING_BLOCK;
        rheo_lanes sum[VECTORS] = {0};
        for (uint32_t k = 0; k < t->modes.count; k++) {
            const rheo_lanes *y = lanes_of(rheo_ring_block(modes, block, rheo_mode_slot(s, k)) + inside);
            const rheo_lanes w = rheo_lanes_all(t->modes.weight[k]);
#pragma GCC unroll 8
            for (int v = 0; v < VECTORS; v++)
                sum[v] += w * y[v];
        }
        const rheo_lanes *newest = lanes_of(rheo_newest_velocities(s, block) + inside);
        rheo_lanes d[VECTORS];
#pragma GCC unroll 8
        for (int v = 0; v < VECTORS; v++)
            d[v] = rheo_lanes_all(t->derivative_scale) * (newest[v] + sum[v]);
        memcpy(derivative + first, d, (values - first < PART ? values - first : PART) * sizeof *derivative);
    }
    return RHEO_OK;
}
