/*
 * Stage history of memories of modes: what was the newest velocity v enters the sums (docs/model.md, 9 and History),
 *
 *     y_k <- (y_k - g_k y_k) + (a_k v + b_k u),
 *
 * a_k = 1, but of the first velocity of all the part that its weight gives it. u is a velocity at the far end of a
 * window, if there is one: it leaves, or it has just become the oldest of a full window and counts whole from now on.
 *
 * A sum that decays slowly takes in v and loses g y every step, both far below its last digits. In float that error
 * piles up to the share 2^-25/g of the sum, so slow modes keep what rounding cut off in a second row (by
 * Knuth's two-sum). Sums below 1e-30 are set to 0, since what decays would stay among the denormal numbers for ever.
 */
#include "core/lanes.h"
#include "thickening/kernels.h"

enum { VECTORS = RHEO_RING_BLOCK / RHEO_LANES };

static inline rheo_lanes settle(rheo_lanes y)
{
    const rheo_real tiny = RHEO_R(1e-30);
    return rheo_lanes_keep((y >= tiny) | (y <= -tiny), y);
}

/* A row of a block of one mode. */
static void update(rheo_real *sums, const rheo_real *newest, const rheo_real *far, rheo_mode mode)
{
    rheo_lanes *y = (rheo_lanes *)(void *)sums;
    const rheo_lanes *v = (const rheo_lanes *)(const void *)newest, *u = (const rheo_lanes *)(const void *)far;
    const rheo_lanes g = rheo_lanes_all(mode.decay), a = rheo_lanes_all(mode.enters), b = rheo_lanes_all(mode.far);
    if (far)
        for (int n = 0; n < VECTORS; n++)
            y[n] = settle((y[n] - g * y[n]) + (a * v[n] + b * u[n]));
    else
        for (int n = 0; n < VECTORS; n++)
            y[n] = settle((y[n] - g * y[n]) + a * v[n]);
}

/* The same with what is left of the last rounding. */
static void update_slow(rheo_real *sums, rheo_real *rests, const rheo_real *newest, const rheo_real *far,
                        rheo_mode mode)
{
    rheo_lanes *y = (rheo_lanes *)(void *)sums, *rest = (rheo_lanes *)(void *)rests;
    const rheo_lanes *v = (const rheo_lanes *)(const void *)newest, *u = (const rheo_lanes *)(const void *)far;
    const rheo_lanes g = rheo_lanes_all(mode.decay), a = rheo_lanes_all(mode.enters), b = rheo_lanes_all(mode.far);
    for (int n = 0; n < VECTORS; n++) {
        rheo_lanes change = a * v[n];
        if (far)
            change += b * u[n];
        change = rest[n] + (change - g * y[n]);
        const rheo_lanes sum = y[n] + change, taken = sum - y[n];
        rest[n] = settle((y[n] - (sum - taken)) + (change - taken));
        y[n] = settle(sum);
    }
}

void RHEO_KERNEL(remember)(rheo_state *s, const rheo_thickening *t, uint64_t rows)
{
    const rheo_modes *modes = &t->modes;
    const uint32_t window = s->ring.length ? s->ring.length - 1 : 0;
    if (rows == 0)
        return;
    rheo_mode mode[RHEO_HISTORY_MOST_MODES];
    const bool leaves = window && rows > window, fills = window && rows == window;
    for (uint32_t k = 0; k < modes->count; k++)
        mode[k] = (rheo_mode){modes->decay[k], rows == 1 ? modes->first[k] : 1,
                              leaves  ? modes->leaving[k]
                              : fills ? modes->filling[k]
                                      : 0};
    const size_t blocks = rheo_ring_blocks(s->particles);
    for (size_t block = 0; block < blocks; block++) {
        const rheo_real *newest = rheo_newest_velocities(s, block), *far = NULL;
        if (leaves || fills)
            far = rheo_ring_block(&s->ring, block, rheo_ring_slot(&s->ring, leaves ? window : window - 1));
        for (uint32_t k = 0; k < modes->slow; k++)
            update_slow(rheo_ring_block(&s->modes, block, rheo_mode_slot(s, k)),
                        rheo_ring_block(&s->modes, block, rheo_mode_slot(s, modes->count + k)), newest, far, mode[k]);
        for (uint32_t k = modes->slow; k < modes->count; k++)
            update(rheo_ring_block(&s->modes, block, rheo_mode_slot(s, k)), newest, far, mode[k]);
    }
}
