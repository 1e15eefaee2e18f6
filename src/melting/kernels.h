/*
 * The kernel of pairs, within one SIMD variant: in the first loop over pairs that needs it. That loop also counts the
 * pairs closer than the support, since rows hold more of them.
 */
#ifndef RHEO__MELTING_KERNELS_H
#define RHEO__MELTING_KERNELS_H

#include "core/quintic.h"
#include "melting/rows.h"

typedef struct rheo__kernels {
    rheo_real inverse_h, scale, slope_scale, support2;
    /* Numbers of entries closer than the support, idle ones among them, and of those not at distance 0. */
    uint64_t close, apart;
} rheo__kernels;

static inline rheo__kernels rheo__kernels_begin(const rheo__melting *m)
{
    const rheo_real inverse_h = (rheo_real)(1 / m->smoothing_length), support = (rheo_real)m->support;
    return (rheo__kernels){.inverse_h = inverse_h,
                           .scale = m->kernel_scale,
                           .slope_scale = m->kernel_scale * inverse_h * inverse_h,
                           .support2 = support * support};
}

/* Puts the kernel of an entry whose squared distances are r2. Returns its slope. */
static inline rheo__lanes rheo__put_kernel(const rheo__rows *rows, const rheo__kernels *of, size_t entry,
                                           rheo__lanes r2)
{
    const rheo__lanes q = rheo__lanes_sqrt(r2) * of->inverse_h;
    rheo__lanes slope;
    const rheo__lanes weight = rheo__lanes_quintic(q, &slope);
    slope *= of->slope_scale;
    rheo__lanes_put(rows->slope, entry, slope);
    rheo__lanes_put(rows->weight, entry, weight * of->scale);
    return slope;
}

/* Counts of one vector of rows. */
typedef struct rheo__pair_counts {
    rheo__mask close, apart;
} rheo__pair_counts;

static inline void rheo__count_pairs(rheo__pair_counts *counts, const rheo__kernels *of, rheo__lanes r2)
{
    counts->close = rheo__lanes_count_if_less(r2, rheo__lanes_all(of->support2), counts->close);
    counts->apart = rheo__lanes_count_if_less(rheo__lanes_all(0), r2, counts->apart);
}
static inline void rheo__add_counts(rheo__kernels *of, rheo__pair_counts counts)
{
    for (int lane = 0; lane < RHEO__LANES; lane++) {
        of->close += (uint64_t)RHEO__LANE(counts.close, lane);
        of->apart += (uint64_t)RHEO__LANE(counts.apart, lane);
    }
}
static inline void rheo__kernels_end(rheo__melting *m, const rheo__kernels *of)
{
    m->rows.partners = of->close - m->rows.idle;
    m->coinciding = of->apart != (uint64_t)m->rows.start[m->rows.blocks] * RHEO__BLOCK_ROWS - m->rows.idle;
    m->diagnostics.mean_neighbours = m->pairs.rows ? (double)m->rows.partners / m->pairs.rows : 0;
}

#endif
