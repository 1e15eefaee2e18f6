/*
 * Stage fractional_derivative (docs/model.md, 5): D^q x of every particle from its remembered velocities,
 *
 *     D^q x = C0 sum_m c_m v_m,   m = 0 the newest,
 *
 * summed from the oldest to the newest. The sum is linear, so a spring takes the difference of its two ends.
 */
#include "core/lanes.h"
#include "thickening/kernels.h"

/* A part of a block is summed at once: as much as fits into eight registers. */
enum {
    VECTORS = RHEO_RING_BLOCK / RHEO_LANES < 8 ? RHEO_RING_BLOCK / RHEO_LANES : 8,
    PART = VECTORS * RHEO_LANES,
    CACHE_LINE = 64,
    PREFETCH_ROWS = 256, /* at most: what is fetched early must stay in the cache until it is used */
};

/*
 * Adds to the sums of a part the rows of lags oldest..newest, which lie one after another in slots. The time goes to
 * waiting for memory, and no processor foresees a ring that is summed from its middle: what is needed `ahead` values
 * later (in the same slot of the next block) is asked for now.
 */
static void add_rows(rheo_real *sum, const rheo_real *row, const rheo_real *weight, uint32_t oldest, uint32_t newest,
                     size_t ahead)
{
    rheo_lanes s[VECTORS];
    memcpy(s, sum, sizeof s);
    for (uint32_t lag = oldest + 1; lag-- > newest; row += RHEO_RING_BLOCK) {
        for (size_t line = 0; line < PART * sizeof *row; line += CACHE_LINE)
            __builtin_prefetch((const char *)(row + ahead) + line);
        rheo_lanes w = rheo_lanes_all(weight[lag]);
#pragma GCC unroll 8
        for (int v = 0; v < VECTORS; v++)
            s[v] += w * ((const rheo_lanes *)(const void *)row)[v];
    }
    memcpy(sum, s, sizeof s);
}

void RHEO_KERNEL(derivatives)(const rheo_state *s, const rheo_thickening *t, rheo_real *derivative)
{
    const rheo_ring *ring = &s->ring;
    uint32_t rows_ahead = ring->rows < PREFETCH_ROWS ? ring->rows : PREFETCH_ROWS;
    uint32_t rows = (uint32_t)*s->history_rows;
    size_t values = 3 * (size_t)s->particles;
    for (size_t first = 0; first < values; first += PART) {
        rheo_real sum[PART] = {0};
        if (rows) {
            size_t block = first / RHEO_RING_BLOCK, inside = first % RHEO_RING_BLOCK;
            size_t ahead = block + 1 < ring->blocks ? (size_t)rows_ahead * RHEO_RING_BLOCK : 0;
            uint32_t oldest = rheo_ring_slot(ring, rows - 1);
            const rheo_real *row = rheo_ring_block(ring, block, oldest) + inside;
            add_rows(sum, row, t->first_weight, rows - 1, rows - 1, ahead);
            /* The other rows: behind the oldest up to the end of the ring, then from its start. */
            uint32_t left = rows - 1, behind = ring->length - oldest - 1;
            uint32_t straight = left < behind ? left : behind;
            if (straight)
                add_rows(sum, row + RHEO_RING_BLOCK, t->weight, left - 1, left - straight, ahead);
            if (left > straight)
                add_rows(sum, rheo_ring_block(ring, block, 0) + inside, t->weight, left - straight - 1, 0, ahead);
        }
        for (size_t i = first; i < first + PART && i < values; i++)
            derivative[i] = t->derivative_scale * sum[i - first];
    }
}
