/*
 * Stage fractional_derivative (docs/model.md, 2): D^q x of every particle from its remembered velocities,
 *
 *     D^q x = C0 sum_m c_m v_m,   m = 0 the newest that counts (its lag in the ring is history.lag),
 *
 * summed from the oldest to the newest. The sum is linear, so a spring takes the difference of its two ends.
 *
 * Reading the ring takes most of the time. A sum begins with the old rows, which exist several steps before the sum
 * is needed. So one pass over a block of the ring adds its rows to the sums of this step and the next ones; the
 * following steps only add the few rows that have begun to count. The terms of each sum and their order, hence its bits,
 * are those of rheo__particle_derivative(). Blocks take their passes in turn, so that each step does an equal share
 * of the work. A ring of few rows is read as a whole in every step.
 */
#include "core/account_lanes.h"
#include "core/lanes.h"
#include "thickening/thickening.h"

enum {
    AHEAD = RHEO__STEPS_AHEAD,
    TOGETHER = 4, /* rows added between loading and storing a sum */
    VECTORS = 4,  /* of one sum at a time, while rows are added to it */
};

_Static_assert(RHEO__RING_BLOCK % (VECTORS * RHEO__LANES) == 0, "the stage sums whole groups of vectors");

static inline rheo__lanes load(const rheo_real *values)
{
    rheo__lanes lanes;
    memcpy(&lanes, values, sizeof lanes);
    return lanes;
}

/*
 * Adds `count` rows of a block that lie one after another to the sums of AHEAD steps: a row's lag grows by one with each
 * step. *weight is that of the first row in the first step. The rows behind them are prefetched, since hardware does not
 * predict a ring that is summed from its middle.
 */
static inline void add_rows(rheo_real sums[AHEAD][RHEO__RING_BLOCK], const rheo_real *row, const rheo_real *weight,
                            int count)
{
    for (size_t i = 0; i < RHEO__RING_BLOCK; i += RHEO__LANES) {
        rheo__lanes value[TOGETHER];
#pragma GCC unroll 4
        for (int k = 0; k < count; k++) {
            value[k] = load(row + k * RHEO__RING_BLOCK + i);
            __builtin_prefetch(row + (count + k) * RHEO__RING_BLOCK + i);
        }
        for (int step = 0; step < AHEAD; step++) {
            rheo__lanes sum = load(sums[step] + i);
#pragma GCC unroll 4
            for (int k = 0; k < count; k++)
                sum += weight[step - k] * value[k];
            memcpy(sums[step] + i, &sum, sizeof sum);
        }
    }
}

/* Slot of row m of those that count. */
static inline uint32_t slot_of(const rheo__thickening *t, const rheo__ring *ring, uint32_t m)
{
    return rheo__ring_slot(ring, t->def->history.lag + m);
}

/* One pass over a block, `rows` of which count: the sums of this step and the next ones. */
static void sum_ahead(const rheo__thickening *t, const rheo__ring *ring, size_t block, uint32_t rows,
                      rheo_real sums[AHEAD][RHEO__RING_BLOCK])
{
    memset(sums, 0, AHEAD * sizeof *sums);
    add_rows(sums, rheo__ring_block(ring, block, slot_of(t, ring, rows - 1)), t->first_weight + rows - 1, 1);
    for (uint32_t left = rows - 1; left > 0;) {
        const uint32_t slot = slot_of(t, ring, left - 1);
        const rheo_real *row = rheo__ring_block(ring, block, slot), *weight = t->weight + left - 1;
        if (left >= TOGETHER && ring->length - slot >= TOGETHER) {
            add_rows(sums, row, weight, TOGETHER);
            left -= TOGETHER;
        } else {
            add_rows(sums, row, weight, 1);
            left--;
        }
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

/* Adds the newest rows of a block to its sums so far, and stores D^q x. */
static inline void finish_block(rheo__state *s, const rheo__thickening *t, size_t block, const rheo_real *so_far,
                                const rheo_real *const *row, uint32_t newest)
{
    const size_t first = block * RHEO__RING_BLOCK, values = 3 * (size_t)s->particles;
    for (size_t i = 0; i < RHEO__RING_BLOCK && first + i < values; i += VECTORS * RHEO__LANES) {
        rheo__lanes sum[VECTORS];
        memcpy(sum, so_far + i, sizeof sum);
        for (uint32_t lag = newest; lag-- > 0;)
            for (int n = 0; n < VECTORS; n++)
                sum[n] += t->weight[lag] * load(row[lag] + i + n * RHEO__LANES);
        for (int n = 0; n < VECTORS; n++)
            sum[n] *= t->derivative_scale;
        const size_t count = values - first - i;
        memcpy(s->derivative + first + i, sum,
               (count < VECTORS * RHEO__LANES ? count : VECTORS * RHEO__LANES) * sizeof *s->derivative);
    }
}

/* The sums of a ring, at most AHEAD rows of which count. */
static void sum_all(rheo__state *s, const rheo__thickening *t, uint32_t rows)
{
    for (size_t block = 0; block < rheo__ring_blocks(s->particles); block++) {
        const rheo_real *row[AHEAD];
        for (uint32_t lag = 0; lag < rows; lag++)
            row[lag] = rheo__ring_block(&s->ring, block, slot_of(t, &s->ring, lag));
        rheo_real oldest[RHEO__RING_BLOCK] = {0};
        for (size_t i = 0; i < RHEO__RING_BLOCK; i++)
            oldest[i] += t->first_weight[rows - 1] * row[rows - 1][i];
        finish_block(s, t, block, oldest, row, rows - 1);
    }
}

/* The terms of the sum of one particle, in the order in which all passes together add them. */
static void keep_account(const rheo__state *s, const rheo__thickening *t, uint32_t rows)
{
    const uint32_t first = t->def->history.lag;
    rheo__account_begin(s, RHEO__SUM_past);
    for (uint32_t m = rows; m-- > 0;) {
        const rheo_real weight = (m == rows - 1 ? t->first_weight : t->weight)[m];
        rheo_real term[3];
        for (size_t axis = 0; axis < 3; axis++)
            term[axis] = weight * rheo__ring_value(&s->ring, first + m, 3 * (size_t)s->account->id + axis);
        rheo__account_add(s, RHEO__SUM_past, RHEO_SOURCE_PAST, first + m, term[0], term[1], term[2]);
    }
    rheo__account_renew(s, RHEO__FIELD_derivative, RHEO_SOURCE_SUM, t->derivative_scale, RHEO__SUM_past);
}

rheo_result RHEO__VARIANT(stage_fractional_derivative)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo__ring *ring = &s->ring;
    rheo__ahead *a = &t->ahead;
    size_t values = 3 * (size_t)s->particles, blocks = rheo__ring_blocks(s->particles);
    const uint32_t rows = (uint32_t)rheo__old_rows(t, *s->history_rows);
    rheo__state_renew(s, RHEO__FIELD_derivative);
    if (rheo__keeps_any(s))
        keep_account(s, t, rows);
    if (rows == 0) {
        memset(s->derivative, 0, values * sizeof *s->derivative);
        return RHEO_OK;
    }
    if (t->window + 1 <= AHEAD) {
        sum_all(s, t, rows);
        return RHEO_OK;
    }
    if (!prepare(a, &t->allocator, ring, blocks))
        return RHEO_ERROR_MEMORY;
    for (size_t block = 0; block < blocks; block++) {
        /* Number of this step within a pass. */
        const size_t turn = (size_t)((ring->pushed + block * AHEAD / blocks) % AHEAD);
        rheo_real(*ahead)[RHEO__RING_BLOCK] = (void *)(a->sum + block * AHEAD * RHEO__RING_BLOCK);
        /* Steps may have been taken from a recording since, without this stage: then the sums are of an earlier pass. */
        if (turn == 0 || a->pushed[block] == UINT64_MAX || ring->pushed - a->pushed[block] > turn) {
            sum_ahead(t, ring, block, rows, ahead);
            if (turn)
                memmove(ahead[turn], ahead[0], (AHEAD - turn) * sizeof *ahead);
            a->pushed[block] = ring->pushed;
        }
        const uint32_t since = (uint32_t)(ring->pushed - a->pushed[block]), newer = since < rows ? since : rows;
        const rheo_real *row[AHEAD];
        for (uint32_t lag = 0; lag < newer; lag++)
            row[lag] = rheo__ring_block(ring, block, slot_of(t, ring, lag));
        finish_block(s, t, block, ahead[turn], row, newer);
    }
    return RHEO_OK;
}
