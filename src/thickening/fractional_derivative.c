/*
 * Stage fractional_derivative (docs/model.md, 5): D^q x of every particle from its remembered velocities,
 *
 *     D^q x = C0 sum_m c_m v_m,   m = 0 the newest,
 *
 * summed from the oldest to the newest. The sum is linear, so a spring takes the difference of its two ends.
 */
#include "core/lanes.h"
#include "core/target.h"
#include "thickening/thickening.h"

/* A kernel sums a part of a block at once: as much as fits into eight registers. */
enum {
    VECTORS = 8,
    CACHE_LINE = 64,
    PREFETCH_ROWS = 256, /* at most: what is fetched early must stay in the cache until it is used */
};

/*
 * Adds to the sums of a part the rows of lags oldest..newest, which lie one after another in slots. The time
 * goes to waiting for memory, and no processor foresees a ring that is summed from its middle: what is needed
 * `ahead` values later (in the same slot of the next block) is asked for now.
 */
typedef void add_rows(rheo_real *sum, const rheo_real *row, const rheo_real *weight, uint32_t oldest, uint32_t newest,
                      size_t ahead);

/* The same sums in vectors of any width: a value's sum is that of its lane alone. */
#define ADD_ROWS(name, vector)                                                                         \
    static void name(rheo_real *sum, const rheo_real *row, const rheo_real *weight, uint32_t oldest,   \
                     uint32_t newest, size_t ahead)                                                    \
    {                                                                                                  \
        vector *s = (vector *)(void *)sum;                                                             \
        vector s0 = s[0], s1 = s[1], s2 = s[2], s3 = s[3], s4 = s[4], s5 = s[5], s6 = s[6], s7 = s[7]; \
        for (uint32_t lag = oldest + 1; lag-- > newest; row += RHEO_RING_BLOCK) {                      \
            const vector *value = (const vector *)(const void *)row;                                   \
            for (size_t line = 0; line < VECTORS * sizeof(vector); line += CACHE_LINE)                 \
                __builtin_prefetch((const char *)(row + ahead) + line);                                \
            vector w = weight[lag] - (vector){0};                                                      \
            s0 += w * value[0];                                                                        \
            s1 += w * value[1];                                                                        \
            s2 += w * value[2];                                                                        \
            s3 += w * value[3];                                                                        \
            s4 += w * value[4];                                                                        \
            s5 += w * value[5];                                                                        \
            s6 += w * value[6];                                                                        \
            s7 += w * value[7];                                                                        \
        }                                                                                              \
        s[0] = s0;                                                                                     \
        s[1] = s1;                                                                                     \
        s[2] = s2;                                                                                     \
        s[3] = s3;                                                                                     \
        s[4] = s4;                                                                                     \
        s[5] = s5;                                                                                     \
        s[6] = s6;                                                                                     \
        s[7] = s7;                                                                                     \
    }

ADD_ROWS(add_rows_plain, rheo_lanes)
#ifdef RHEO_AVX2
typedef rheo_real wide_lanes __attribute__((vector_size(2 * sizeof(rheo_lanes))));
RHEO_AVX2 ADD_ROWS(add_rows_avx2, wide_lanes)
#endif

void rheo_derivatives(const rheo_state *s, const rheo_thickening *t, rheo_real *derivative)
{
    const rheo_ring *ring = &s->ring;
    add_rows *add = add_rows_plain;
    size_t part = VECTORS * RHEO_LANES;
#ifdef RHEO_AVX2
    if (rheo_has_avx2()) {
        add = add_rows_avx2;
        part *= 2;
    }
#endif
    uint32_t rows_ahead = ring->rows < PREFETCH_ROWS ? ring->rows : PREFETCH_ROWS;
    uint32_t rows = (uint32_t)*s->history_rows;
    size_t values = 3 * (size_t)s->particles;
    for (size_t first = 0; first < values; first += part) {
        _Alignas(CACHE_LINE) rheo_real sum[RHEO_RING_BLOCK] = {0};
        if (rows) {
            size_t block = first / RHEO_RING_BLOCK, inside = first % RHEO_RING_BLOCK;
            size_t ahead = block + 1 < ring->blocks ? (size_t)rows_ahead * RHEO_RING_BLOCK : 0;
            uint32_t oldest = rheo_ring_slot(ring, rows - 1);
            const rheo_real *row = rheo_ring_block(ring, block, oldest) + inside;
            add(sum, row, t->first_weight, rows - 1, rows - 1, ahead);
            /* The other rows: behind the oldest up to the end of the ring, then from its start. */
            uint32_t left = rows - 1, behind = ring->length - oldest - 1;
            uint32_t straight = left < behind ? left : behind;
            if (straight)
                add(sum, row + RHEO_RING_BLOCK, t->weight, left - 1, left - straight, ahead);
            if (left > straight)
                add(sum, rheo_ring_block(ring, block, 0) + inside, t->weight, left - straight - 1, 0, ahead);
        }
        for (size_t i = first; i < first + part && i < values; i++)
            derivative[i] = t->derivative_scale * sum[i - first];
    }
}

rheo_result rheo_stage_fractional_derivative(rheo_state *s, void *context)
{
    rheo_thickening *t = context;
    rheo_derivatives(s, t, t->derivative);
    return RHEO_OK;
}

void rheo_particle_derivative(const rheo_state *s, const rheo_thickening *t, uint32_t id, rheo_real d[3])
{
    uint32_t rows = (uint32_t)*s->history_rows;
    for (size_t axis = 0; axis < 3; axis++) {
        rheo_real sum = 0;
        for (uint32_t lag = rows; lag-- > 0;)
            sum += (lag == rows - 1 ? t->first_weight : t->weight)[lag] *
                   rheo_ring_value(&s->ring, lag, 3 * (size_t)id + axis);
        d[axis] = t->derivative_scale * sum;
    }
}

void rheo_pair_derivative(const rheo_state *s, const rheo_thickening *t, uint32_t a, uint32_t b, rheo_real d[3])
{
    rheo_real other[3];
    rheo_particle_derivative(s, t, a, d);
    rheo_particle_derivative(s, t, b, other);
    for (int axis = 0; axis < 3; axis++)
        d[axis] -= other[axis];
}
