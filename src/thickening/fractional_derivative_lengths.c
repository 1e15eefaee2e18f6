/*
 * Stage fractional_derivative of history.of length (docs/model.md, Vector or length): for each pair, from its length l at sampled
 * lags m_k of the past positions,
 *
 *     D^q l = sum_k u_k (l(m_k) - l(m_(k+1))),
 *
 * summed from the oldest difference to the newest. Stages viscosity and stiffness read |D^q l|. A length follows from
 * two positions of one time, so a body that only turns has none, however fast it turns. Both rows of a pair compute the
 * same bits.
 */
#include "space/row_blocks.h"
#include "thickening/thickening.h"

/* The sampled positions that are in use, by rank. */
typedef struct sampled {
    const rheo__point *point;
    const rheo_real *weight;
    uint32_t count;
} sampled;

/* Reads the ring in the order of ids, in which it is stored. */
static void gather(const rheo__state *s, rheo__thickening *t, uint32_t rates, uint32_t count)
{
    const rheo__ring *ring = &s->ring;
    const rheo__pairs *p = t->pairs;
    const rheo_real *row[RHEO__MOST_SAMPLES]; /* of the first block */
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t lag = t->samples.lag[k] < rates ? t->samples.lag[k] : rates;
        row[k] = rheo__ring_block(ring, 0, rheo__ring_slot(ring, t->def->history.lag + lag));
    }
    for (uint32_t id = 0; id < p->rows; id++) {
        rheo__point *to = t->samples.point + (size_t)p->rank_of[id] * count;
        size_t at[3];
        for (size_t axis = 0; axis < 3; axis++) {
            const size_t value = 3 * (size_t)id + axis;
            at[axis] = value / RHEO__RING_BLOCK * ring->rows * RHEO__RING_BLOCK + value % RHEO__RING_BLOCK;
        }
        for (uint32_t k = 0; k < count; k++)
            to[k] = (rheo__point){row[k][at[0]], row[k][at[1]], row[k][at[2]], 0};
    }
    for (size_t k = (size_t)p->rows * count; k < ((size_t)rheo__pairs_idle(p) + 1) * count; k++)
        t->samples.point[k] = (rheo__point){0, 0, 0, 0};
}

/* |D^q l| of one partner of each row. */
static inline rheo__lanes pair_derivative(const sampled *from, const rheo__lanes3 *own, const uint32_t *partner)
{
    uint32_t at[RHEO__LANES];
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
        at[lane] = partner[lane] * from->count;
    rheo__lanes before = rheo__lanes_all(0), sum = before;
    for (uint32_t k = from->count; k-- > 0;) {
        const rheo__lanes3 d = rheo__lanes3_minus(rheo__lanes_load_at(from->point + k, at), own[k]);
        const rheo__lanes now = rheo__lanes_sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
        if (k + 1 < from->count)
            sum += rheo__lanes_all(from->weight[k]) * (now - before);
        before = now;
    }
    return rheo__lanes_max(sum, -sum);
}

static bool make_room(rheo__thickening *t, uint32_t count)
{
    const size_t ranks = (size_t)rheo__pairs_idle(t->pairs) + 1;
    if (ranks > UINT32_MAX / RHEO__POINT_VALUES / count) /* indices of values have 32 bits */
        return false;
    void *point = t->samples.point, *derivative = t->pair_derivative;
    const bool points =
        rheo__grow(&t->allocator, &point, &t->samples.capacity, ranks * count, 0, sizeof *t->samples.point);
    t->samples.point = point;
    const bool pairs = rheo__grow(&t->allocator, &derivative, &t->pair_derivative_capacity,
                                  rheo__pairs_entries(t->pairs) + 1, 0, sizeof *t->pair_derivative);
    t->pair_derivative = derivative;
    return points && pairs;
}

rheo_result RHEO__VARIANT(stage_fractional_derivative_lengths)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const uint32_t rates = (uint32_t)rheo__old_rows(t, *s->history_rows),
                   used = rheo__samples_used(&t->samples, rates);
    if (!make_room(t, used))
        return RHEO_ERROR_MEMORY;
    if (rates == 0 || s->particles == 0) {
        memset(t->pair_derivative, 0, rheo__pairs_entries(t->pairs) * sizeof *t->pair_derivative);
        return RHEO_OK;
    }
    gather(s, t, rates, used);
    const sampled from = {t->samples.point, t->samples.weight, used};
    RHEO__EACH_VECTOR_OF_ROWS(t->pairs, block, first)
    {
        const size_t rank = (size_t)block * RHEO__BLOCK_ROWS + first;
        rheo__lanes3 own[RHEO__MOST_SAMPLES];
        for (uint32_t k = 0; k < used; k++) {
            rheo__lanes w;
            own[k] = rheo__lanes_load_values(&from.point[rank * used + k].x, rheo__lane_point, used, &w);
        }
        RHEO__EACH_ENTRY(t->pairs, block, first, entry)
        rheo__lanes_put(t->pair_derivative, entry, pair_derivative(&from, own, t->pairs->partner + entry));
    }
    return RHEO_OK;
}
