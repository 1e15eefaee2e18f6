/*
 * The memory of particles that have always moved with their present velocity v, as fluid in the pipe before an emitter: every
 * velocity of the past is v, every position x - v t. A sum of modes (history_modes.c) that took in v m times is
 *
 *     y = v (f a^(m-1) + 1 + a + ... + a^(m-2)),   a = 1 - decay,
 *
 * f being the share of the very first velocity, and 1 where a full window has cut it off.
 */
#include "core/strict.h"
#include "thickening/thickening.h"

static double power(double base, uint64_t exponent)
{
    double result = 1;
    for (; exponent; exponent >>= 1, base *= base)
        result *= exponent & 1 ? base : 1;
    return result;
}

static double sum_of_mode(const rheo__modes *modes, uint32_t k, uint64_t taken)
{
    const double decay = (double)modes->decay[k], a = 1 - decay;
    if (taken == 0)
        return 0;
    const double last = power(a, taken - 1),
                 first = modes->window && taken >= modes->window ? 1 : (double)modes->first[k];
    return first * last + (1 - last) / decay;
}

static void set(rheo__ring *ring, uint32_t slot, size_t value, rheo_real number)
{
    rheo__ring_block(ring, value / RHEO__RING_BLOCK, slot)[value % RHEO__RING_BLOCK] = number;
}

static void remember_modes(rheo__state *s, const rheo__thickening *t, uint32_t first)
{
    const rheo__modes *modes = &t->modes;
    uint64_t rows = *s->history_rows;
    if (s->ring.length && !modes->window && rows == s->ring.length && *s->step > rows)
        rows = *s->step; /* the ring has only those that are younger than the lag */
    const uint64_t old = rheo__old_rows(t, rows), taken = old ? old - 1 : 0;
    for (uint32_t k = 0; k < modes->count; k++) {
        const double share = sum_of_mode(modes, k, taken);
        for (size_t value = 3 * (size_t)first; value < 3 * (size_t)s->particles; value++) {
            const double y = share * (double)s->velocity[value];
            const rheo_real sum = (rheo_real)y;
            set(&s->modes, rheo__mode_slot(s, k), value, sum);
            if (k < modes->slow)
                set(&s->modes, rheo__mode_slot(s, modes->count + k), value, (rheo_real)(y - (double)sum));
        }
    }
    for (size_t value = 3 * (size_t)first; !s->ring.length && rows && value < 3 * (size_t)s->particles; value++)
        set(&s->modes, rheo__ring_slot(&s->modes, 0), value, s->velocity[value]);
    s->modes.rewritten++;
}

void rheo__remember_motion(rheo__state *s, const rheo__thickening *t, uint32_t first)
{
    const bool lengths = rheo__history_of_lengths(t->def);
    for (uint32_t lag = 0; s->ring.length && lag < *s->history_rows && lag < s->ring.length; lag++)
        for (size_t value = 3 * (size_t)first; value < 3 * (size_t)s->particles; value++) {
            const rheo_real v = s->velocity[value], ago = (rheo_real)(t->def->step * lag);
            set(&s->ring, rheo__ring_slot(&s->ring, lag), value, lengths ? s->position[value] - v * ago : v);
        }
    s->ring.rewritten++;
    if (rheo__state_has(s, RHEO__FIELD_history_modes))
        remember_modes(s, t, first);
}
