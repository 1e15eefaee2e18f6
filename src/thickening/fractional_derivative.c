/*
 * Stage fractional_derivative (docs/model.md, 5): D^q x of every particle from its remembered velocities,
 *
 *     D^q x = C0 sum_m c_m v_m,   m = 0 the newest,
 *
 * summed from the oldest to the newest. The sum is linear, so a spring takes the difference of its two ends.
 */
#include "core/lanes.h"
#include "thickening/thickening.h"

/* A part of a block: as many sums as fit into the registers of every machine. */
enum { VECTORS = 8, PART = VECTORS * RHEO_LANES };
_Static_assert(RHEO_RING_BLOCK % PART == 0, "a block is summed in whole parts");

/* Adds the rows of lags oldest..newest, which lie one after another in slots. */
static void add_rows(rheo_lanes sum[VECTORS], const rheo_real *row, const rheo_real *weight, uint32_t oldest,
                     uint32_t newest)
{
    rheo_lanes s0 = sum[0], s1 = sum[1], s2 = sum[2], s3 = sum[3], s4 = sum[4], s5 = sum[5], s6 = sum[6], s7 = sum[7];
    for (uint32_t lag = oldest + 1; lag-- > newest; row += RHEO_RING_BLOCK) {
        const rheo_lanes *value = (const rheo_lanes *)(const void *)row;
        rheo_lanes w = rheo_lanes_all(weight[lag]);
        s0 += w * value[0];
        s1 += w * value[1];
        s2 += w * value[2];
        s3 += w * value[3];
        s4 += w * value[4];
        s5 += w * value[5];
        s6 += w * value[6];
        s7 += w * value[7];
    }
    sum[0] = s0;
    sum[1] = s1;
    sum[2] = s2;
    sum[3] = s3;
    sum[4] = s4;
    sum[5] = s5;
    sum[6] = s6;
    sum[7] = s7;
}

rheo_result rheo_stage_fractional_derivative(rheo_state *s, void *context)
{
    const rheo_thickening *t = context;
    const rheo_ring *ring = &s->ring;
    uint32_t rows = (uint32_t)*s->history_rows;
    size_t values = 3 * (size_t)s->particles;
    for (size_t first = 0; first < values; first += PART) {
        rheo_lanes sum[VECTORS] = {{0}};
        if (rows) {
            size_t block = first / RHEO_RING_BLOCK, inside = first % RHEO_RING_BLOCK;
            uint32_t oldest = rheo_ring_slot(ring, rows - 1);
            const rheo_real *row = rheo_ring_block(ring, block, oldest) + inside;
            add_rows(sum, row, t->first_weight, rows - 1, rows - 1);
            /* The other rows: behind the oldest up to the end of the ring, then from its start. */
            uint32_t left = rows - 1, behind = ring->length - oldest - 1;
            uint32_t part = left < behind ? left : behind;
            if (part)
                add_rows(sum, row + RHEO_RING_BLOCK, t->weight, left - 1, left - part);
            if (left > part)
                add_rows(sum, rheo_ring_block(ring, block, 0) + inside, t->weight, left - part - 1, 0);
        }
        const rheo_real *total = (const rheo_real *)sum;
        for (size_t i = first; i < first + PART && i < values; i++)
            t->derivative[i] = t->derivative_scale * total[i - first];
    }
    return RHEO_OK;
}

void rheo_pair_derivative(const rheo_state *s, const rheo_thickening *t, uint32_t a, uint32_t b, rheo_real d[3])
{
    uint32_t rows = (uint32_t)*s->history_rows;
    for (size_t axis = 0; axis < 3; axis++) {
        rheo_real end[2];
        for (int e = 0; e < 2; e++) {
            size_t value = 3 * (size_t)(e ? b : a) + axis;
            rheo_real sum = 0;
            for (uint32_t lag = rows; lag-- > 0;)
                sum += (lag == rows - 1 ? t->first_weight : t->weight)[lag] * rheo_ring_value(&s->ring, lag, value);
            end[e] = t->derivative_scale * sum;
        }
        d[axis] = end[0] - end[1];
    }
}
