/*
 * The memory of history.of length (docs/model.md, Vector or length): past positions of particles, and the weights of the
 * lengths of springs at some of them.
 */
#include <assert.h>
#include <string.h>

#include "core/math.h"
#include "thickening/thickening.h"
#include "thickening/weights.h"

uint32_t rheo_history_next_sample(uint32_t lag, uint32_t last)
{
    return lag < last && lag / 4 < last - lag ? lag + 1 + lag / 4 : last;
}

uint32_t rheo__sample_count(uint32_t window)
{
    uint32_t count = 1;
    for (uint32_t lag = 0; lag < window + 1; lag = rheo_history_next_sample(lag, window + 1))
        count++;
    return count;
}

bool rheo__samples_make(rheo__samples *samples, const rheo_allocator *allocator, const rheo_world_def *def,
                        uint32_t window)
{
    const bool curve = def->history.curve_count > 0;
    if (samples->count && samples->order == def->history.order && samples->kind == def->history.weights)
        return true; /* step, window and curve are fixed */
    assert(rheo__sample_count(window) <= RHEO__MOST_SAMPLES);
    const size_t rates = (size_t)window + 1;
    double *weight = rheo__allocate(allocator, rates, sizeof *weight);
    const bool enough = weight;
    if (enough && curve)
        rheo_history_curve_weights(def->history.curve, def->history.curve_count, def->step, rates, weight, NULL);
    for (size_t lag = 0; lag < rates && enough && !curve; lag++)
        weight[lag] = rheo__memory_weight(def->history.order, lag, def->history.weights);
    const double scale = curve ? 1 : rheo_history_scale(def->history.order, def->step, def->history.weights);
    if (enough) {
        samples->order = def->history.order;
        samples->kind = def->history.weights;
        samples->count = 1;
        samples->lag[0] = 0;
    }
    for (uint32_t lag = 0, next; lag < rates && enough; lag = next) {
        double sum = 0;
        next = rheo_history_next_sample(lag, window + 1);
        for (uint32_t k = lag; k < next; k++)
            sum += weight[k];
        samples->weight[samples->count - 1] = (rheo_real)(scale * (sum / (next - lag)) / def->step);
        samples->lag[samples->count++] = next;
    }
    rheo__release(allocator, weight);
    return enough;
}

void rheo__remember_rest(rheo__state *s, uint32_t first)
{
    rheo__ring *ring = &s->ring;
    if (*s->history_rows == 0) {
        rheo__ring_push(ring, s->particles, s->position);
        *s->history_rows = 1;
        return;
    }
    for (uint32_t lag = 0; lag < *s->history_rows; lag++)
        for (size_t value = 3 * (size_t)first; value < 3 * (size_t)s->particles; value++)
            rheo__ring_block(ring, value / RHEO__RING_BLOCK, rheo__ring_slot(ring, lag))[value % RHEO__RING_BLOCK] =
                s->position[value];
    ring->rewritten++;
}

/* Length of the line between two particles at this lag. */
static rheo_real length_at(const rheo__state *s, uint32_t lag, uint32_t a, uint32_t b)
{
    rheo_real d[3];
    for (size_t axis = 0; axis < 3; axis++)
        d[axis] = rheo__ring_value(&s->ring, lag, 3 * (size_t)b + axis) -
                  rheo__ring_value(&s->ring, lag, 3 * (size_t)a + axis);
    return rheo__sqrt(rheo__length2(d[0], d[1], d[2]));
}

rheo_real rheo__length_derivative(const rheo__state *s, const rheo__thickening *t, uint32_t a, uint32_t b)
{
    const rheo__samples *samples = &t->samples;
    const uint32_t rates = (uint32_t)rheo__old_rows(t, *s->history_rows), lag = t->def->history.lag;
    if (rates == 0)
        return 0;
    uint32_t k = rheo__samples_used(samples, rates) - 1;
    rheo_real before = length_at(s, lag + rates, a, b), sum = 0;
    while (k-- > 0) {
        const rheo_real now = length_at(s, lag + samples->lag[k], a, b);
        sum += samples->weight[k] * (now - before);
        before = now;
    }
    return rheo__max(sum, -sum);
}
