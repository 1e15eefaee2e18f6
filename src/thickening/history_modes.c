/*
 * Stage history of memories of modes: v, the newest velocity that counted, enters the sums (docs/model.md, 9 and History),
 *
 *     y_k <- (y_k - g_k y_k) + (a_k v + b_k u),
 *
 * a_k = 1, but smaller for the very first velocity. u is a velocity at the far end of the window, if there is one: it
 * leaves, or it has just become the oldest of a full window and has its full weight from now on.
 *
 * A sum that decays slowly takes in v and loses g y every step, both far below its last digits. In float that error
 * accumulates to 2^-25/g of the sum, so slow modes store their rounding errors in a second row (by Knuth's two-sum).
 * Sums below 1e-30 are set to 0; otherwise decaying sums would stay denormal forever.
 */
#include "core/lanes.h"
#include "thickening/thickening.h"

enum { VECTORS = RHEO__RING_BLOCK / RHEO__LANES };

static inline rheo__lanes settle(rheo__lanes y)
{
    const rheo_real tiny = RHEO__R(1e-30);
    return rheo__lanes_keep((y >= tiny) | (y <= -tiny), y);
}

/* Updates a row of a block for one mode. */
static void update(rheo_real *sums, const rheo_real *newest, const rheo_real *far, rheo__mode mode)
{
    rheo__lanes *y = (rheo__lanes *)(void *)sums;
    const rheo__lanes *v = (const rheo__lanes *)(const void *)newest, *u = (const rheo__lanes *)(const void *)far;
    const rheo__lanes g = rheo__lanes_all(mode.decay), a = rheo__lanes_all(mode.enters),
                      b = rheo__lanes_all(mode.far);
    if (far)
        for (int n = 0; n < VECTORS; n++)
            y[n] = settle((y[n] - g * y[n]) + (a * v[n] + b * u[n]));
    else
        for (int n = 0; n < VECTORS; n++)
            y[n] = settle((y[n] - g * y[n]) + a * v[n]);
}

/* Updates a row of a block for one mode, and its rounding errors. */
static void update_slow(rheo_real *sums, rheo_real *rests, const rheo_real *newest, const rheo_real *far,
                        rheo__mode mode)
{
    rheo__lanes *y = (rheo__lanes *)(void *)sums, *rest = (rheo__lanes *)(void *)rests;
    const rheo__lanes *v = (const rheo__lanes *)(const void *)newest, *u = (const rheo__lanes *)(const void *)far;
    const rheo__lanes g = rheo__lanes_all(mode.decay), a = rheo__lanes_all(mode.enters),
                      b = rheo__lanes_all(mode.far);
    for (int n = 0; n < VECTORS; n++) {
        rheo__lanes change = a * v[n];
        if (far)
            change += b * u[n];
        change = rest[n] + (change - g * y[n]);
        const rheo__lanes sum = y[n] + change, taken = sum - y[n];
        rest[n] = settle((y[n] - (sum - taken)) + (change - taken));
        y[n] = settle(sum);
    }
}

void RHEO__VARIANT(remember_modes)(rheo__state *s, const rheo__thickening *t, uint64_t rows)
{
    const rheo__modes *modes = &t->modes;
    const uint32_t window = modes->window, lag = t->def->history.lag;
    const uint64_t old = rheo__old_rows(t, rows);
    if (old == 0)
        return;
    rheo__mode mode[RHEO_HISTORY_MAX_MODES];
    const bool leaves = window && old > window, fills = window && old == window;
    for (uint32_t k = 0; k < modes->count; k++)
        mode[k] = (rheo__mode){modes->decay[k], old == 1 ? modes->first[k] : 1,
                               leaves  ? modes->leaving[k]
                               : fills ? modes->filling[k]
                                       : 0};
    const size_t blocks = rheo__ring_blocks(s->particles);
    for (size_t block = 0; block < blocks; block++) {
        const rheo_real *newest = rheo__newest_velocities(s, t, block), *far = NULL;
        if (leaves || fills)
            far = rheo__ring_block(&s->ring, block, rheo__ring_slot(&s->ring, lag + (leaves ? window : window - 1)));
        for (uint32_t k = 0; k < modes->slow; k++)
            update_slow(rheo__ring_block(&s->modes, block, rheo__mode_slot(s, k)),
                        rheo__ring_block(&s->modes, block, rheo__mode_slot(s, modes->count + k)), newest, far,
                        mode[k]);
        for (uint32_t k = modes->slow; k < modes->count; k++)
            update(rheo__ring_block(&s->modes, block, rheo__mode_slot(s, k)), newest, far, mode[k]);
    }
}
