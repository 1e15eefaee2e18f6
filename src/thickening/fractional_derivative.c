/*
 * Stage fractional_derivative (docs/model.md, 2): D^q x of every particle from its remembered velocities,
 *
 *     D^q x = C0 sum_m c_m v_m,   m = 0 the newest,
 *
 * summed from the oldest to the newest. The sum is linear, so a spring takes the difference of its two ends.
 *
 * Reading the ring takes most of the time. A sum begins with the old rows, which exist several steps before the sum
 * is needed. So one pass over a block of the ring adds its rows to the sums of this step and the next ones; the
 * following steps only add the few rows that are new since. The terms of each sum and their order, hence its bits,
 * are those of rheo__particle_derivative(). Blocks take their passes in turn, so that each step does an equal share
 * of the work.
 */
#include "core/lanes.h"
#include "thickening/thickening.h"

enum {
    AHEAD = RHEO__STEPS_AHEAD,
    CACHE_LINE = 64,
    PREFETCH_ROWS = 256, /* at most, so that prefetched rows stay in the cache until they are used */
};

_Static_assert(AHEAD == 8, "add_rows() has a variable for each sum, since arrays would not stay in registers");

/*
 * Adds rows that lie one after another, from lag `oldest` to lag `newest` of this step, to the sums of this step and
 * the next ones: a row's lag grows by one with each step. Hardware does not predict a ring that is summed from its
 * middle, so the values needed `ahead` values later (in the same slot of the next block) are prefetched.
 */
static inline void add_rows(rheo__lanes sum[AHEAD], const rheo_real *row, const rheo_real *weight, uint32_t oldest,
                            uint32_t newest, size_t ahead)
{
    rheo__lanes s0 = sum[0], s1 = sum[1], s2 = sum[2], s3 = sum[3], s4 = sum[4], s5 = sum[5], s6 = sum[6],
                s7 = sum[7];
    for (uint32_t lag = oldest + 1; lag-- > newest; row += RHEO__RING_BLOCK) {
        __builtin_prefetch(row + ahead);
        const rheo_real *w = weight + lag;
        rheo__lanes value;
        memcpy(&value, row, sizeof value);
        s0 += w[0] * value;
        s1 += w[1] * value;
        s2 += w[2] * value;
        s3 += w[3] * value;
        s4 += w[4] * value;
        s5 += w[5] * value;
        s6 += w[6] * value;
        s7 += w[7] * value;
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

/* One pass over a block, which has rows: the sums of this step and the next ones. */
static void sum_ahead(const rheo__thickening *t, const rheo__ring *ring, size_t block, uint32_t rows,
                      rheo_real sums[AHEAD][RHEO__RING_BLOCK])
{
    uint32_t rows_ahead = ring->rows < PREFETCH_ROWS ? ring->rows : PREFETCH_ROWS;
    size_t ahead = block + 1 < ring->blocks ? (size_t)rows_ahead * RHEO__RING_BLOCK : 0;
    uint32_t oldest = rheo__ring_slot(ring, rows - 1);
    /* All rows except the oldest: from it to the end of the ring, then from the start. */
    uint32_t left = rows - 1, behind = ring->length - oldest - 1, straight = left < behind ? left : behind;
    for (size_t part = 0; part < RHEO__RING_BLOCK; part += RHEO__LANES) {
        rheo__lanes sum[AHEAD] = {0};
        const rheo_real *row = rheo__ring_block(ring, block, oldest) + part;
        add_rows(sum, row, t->first_weight, rows - 1, rows - 1, ahead);
        if (straight)
            add_rows(sum, row + RHEO__RING_BLOCK, t->weight, left - 1, left - straight, ahead);
        if (left > straight)
            add_rows(sum, rheo__ring_block(ring, block, 0) + part, t->weight, left - straight - 1, 0, ahead);
        for (int step = 0; step < AHEAD; step++)
            memcpy(sums[step] + part, &sum[step], sizeof sum[step]);
    }
}

static bool prepare(rheo__ahead *a, const rheo_allocator *allocator, const rheo__ring *ring, size_t blocks)
{
    size_t values = blocks * AHEAD * RHEO__RING_BLOCK, before = a->capacity;
    void *sum = a->sum, *pushed = a->pushed;
    bool enough = rheo__grow(allocator, &sum, &a->capacity, values, 0, sizeof *a->sum);
    a->sum = sum;
    enough = enough && rheo__grow(allocator, &pushed, &a->pushed_capacity, blocks, 0, sizeof *a->pushed);
    a->pushed = pushed;
    if (!a->valid || a->capacity != before || a->rewritten != ring->rewritten || a->blocks != blocks) {
        for (size_t block = 0; enough && block < blocks; block++)
            a->pushed[block] = UINT64_MAX; /* no sums yet */
        a->valid = enough;
        a->rewritten = ring->rewritten;
        a->blocks = blocks;
    }
    return enough;
}

rheo_result RHEO__VARIANT(stage_fractional_derivative)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo__ring *ring = &s->ring;
    rheo__ahead *a = &t->ahead;
    size_t values = 3 * (size_t)s->particles, blocks = rheo__ring_blocks(s->particles);
    uint32_t rows = (uint32_t)*s->history_rows;
    if (rows == 0) {
        memset(s->derivative, 0, values * sizeof *s->derivative);
        return RHEO_OK;
    }
    if (!prepare(a, &t->allocator, ring, blocks))
        return RHEO_ERROR_MEMORY;
    const size_t share = (blocks + AHEAD - 1) / AHEAD, to_next = (size_t)ring->rows * RHEO__RING_BLOCK;
    for (size_t block = 0; block < blocks; block++) {
        size_t turn = (size_t)((ring->pushed + block / share) % AHEAD); /* number of this step within a pass */
        if (turn == 0 || a->pushed[block] == UINT64_MAX) {
            rheo_real made[AHEAD][RHEO__RING_BLOCK];
            sum_ahead(t, ring, block, rows, made);
            for (size_t step = turn; step < AHEAD; step++)
                memcpy(a->sum + (step * blocks + block) * RHEO__RING_BLOCK, made[step - turn], sizeof made[0]);
            a->pushed[block] = ring->pushed;
        }
        rheo_real sum[RHEO__RING_BLOCK];
        memcpy(sum, a->sum + (turn * blocks + block) * RHEO__RING_BLOCK, sizeof sum);
        uint32_t since = (uint32_t)(ring->pushed - a->pushed[block]);
        for (uint32_t lag = since < rows ? since : rows; lag-- > 0;) {
            const rheo_real *row = rheo__ring_block(ring, block, rheo__ring_slot(ring, lag));
            for (size_t i = 0; i < RHEO__RING_BLOCK; i += CACHE_LINE / sizeof *row)
                __builtin_prefetch(row + to_next + i);
            for (size_t i = 0; i < RHEO__RING_BLOCK; i++)
                sum[i] += t->weight[lag] * row[i];
        }
        size_t first = block * RHEO__RING_BLOCK, count = values - first;
        for (size_t i = 0; i < RHEO__RING_BLOCK && i < count; i++)
            s->derivative[first + i] = t->derivative_scale * sum[i];
    }
    return RHEO_OK;
}
