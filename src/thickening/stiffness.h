/*
 * Stiffness of pairs in scheme summed (Ozgen et al., Eq. 6; docs/model.md, 3), from the history at the start of the
 * step:
 *
 *     n = |D^q x_i - D^q x_j|,  K = k_min + k_hist n^2/(n + n0)
 *
 * its sum over the springs of a particle, and the friction of the particle at walls. The onset n0 keeps the noise of
 * D^q in fluid at rest from changing K: changes of K do work on stretched springs, and the motion that they cause is
 * noise again. If hardening is passive, a spring whose stiffness has grown since the last step keeps its force:
 *
 *     L = r - (K of the last step/K) (r - L)
 *
 * With history.of length, n is |D^q| of the length of the spring (fractional_derivative_lengths.c).
 *
 * Between two materials k_min, k_hist and n0 are means.
 *
 * Stage viscosity calls these functions, since it visits the pairs at the same positions.
 */
#ifndef RHEO__THICKENING_STIFFNESS_H
#define RHEO__THICKENING_STIFFNESS_H

#include "space/row_blocks.h"
#include "thickening/thickening.h"

typedef struct rheo__hardening {
    rheo_real k_min, k_hist, onset, support; /* of the only material */
    bool history, passive, materials, lengths;
} rheo__hardening;

/* k_min and k_hist of the particles in the lanes; only with several materials. */
typedef struct rheo__stiffness_of {
    rheo__lanes k_min, k_hist;
} rheo__stiffness_of;

/* Sums of a vector of rows, over springs; `total` also over pairs that will get a spring in the step. */
typedef struct rheo__stiffness_sums {
    rheo__lanes springs, history, total; /* number of springs; sums of k_hist n^2/(n + n0) and of K */
    rheo__lanes most; /* the largest k_hist n^2/(n + n0) of a spring, with several materials K; -1 without springs */
} rheo__stiffness_sums;

/* D^q x of the particles of a vector of rows, in this step and the one before; the onset of their materials. */
typedef struct rheo__derivatives_of_rows {
    rheo__lanes3 now, before;
    rheo__lanes onset;
} rheo__derivatives_of_rows;

/* What the pass over the pairs reads and writes: copies, so that no store makes the compiler load them again. */
typedef struct rheo__stiffness_arrays {
    const rheo__point *derivative, *derivative_before;
    const uint32_t *partner;
    const rheo_real *pair_derivative;       /* |D^q| of pairs, if the history is that of lengths */
    const rheo_real *rest_length;           /* before the stage */
    rheo_real *new_rest_length, *stiffness; /* the former only if hardening is passive */
} rheo__stiffness_arrays;

static inline rheo__stiffness_sums rheo__no_stiffness(void)
{
    const rheo__lanes zero = rheo__lanes_all(0);
    return (rheo__stiffness_sums){zero, zero, zero, rheo__lanes_all(-1)};
}

static inline rheo__lanes rheo__lanes_mean(rheo__lanes a, rheo__lanes b)
{
    return RHEO__R(0.5) * (a + b);
}

/* k_hist n^2/(n + n0); n: NULL, or that of the pairs. */
static inline rheo__lanes rheo__history_stiffness(rheo__lanes3 di, rheo__lanes onset_i, const rheo__point *derivative,
                                                  const uint32_t *partner, const rheo_real *n_of_pairs,
                                                  rheo__lanes k_hist, const rheo__hardening *c)
{
    rheo__lanes onset_j;
    const rheo__lanes3 d = rheo__lanes3_minus(di, rheo__lanes_load_w_at(derivative, partner, &onset_j));
    const rheo__lanes n = n_of_pairs ? rheo__lanes_at(n_of_pairs, 0)
                                     : rheo__lanes_sqrt(d.x * d.x + d.y * d.y + d.z * d.z),
                      onset = c->materials ? rheo__lanes_mean(onset_i, onset_j) : rheo__lanes_all(c->onset);
    /* Without onset, n/(n + n0) is 0/0 where n is 0. */
    return k_hist * (n * rheo__lanes_keep_less(rheo__lanes_all(0), n, n / (n + onset)));
}

/* One partner of each row, at distance r. */
RHEO__FOR_EACH_CASE void rheo__add_stiffness(rheo__stiffness_sums *own, const rheo__stiffness_arrays *a, size_t entry,
                                             const rheo__derivatives_of_rows *row, rheo__stiffness_of of_i,
                                             rheo__stiffness_of of_j, rheo__lanes r, const rheo__hardening *c)
{
    const uint32_t *partner = a->partner + entry;
    const rheo__lanes none = rheo__lanes_all(-1), support = rheo__lanes_all(c->support);
    const rheo__lanes k_min = c->materials ? rheo__lanes_mean(of_i.k_min, of_j.k_min) : rheo__lanes_all(c->k_min),
                      k_hist = c->materials ? rheo__lanes_mean(of_i.k_hist, of_j.k_hist) : rheo__lanes_all(c->k_hist);
    const rheo__lanes history =
        c->history ? rheo__history_stiffness(row->now, row->onset, a->derivative, partner,
                                             c->lengths ? a->pair_derivative + entry : NULL, k_hist, c)
                   : rheo__lanes_all(0);
    const rheo__lanes k = k_min + history;
    rheo__lanes length = rheo__lanes_at(a->rest_length, entry);
    if (c->passive) {
        const rheo__lanes before =
            k_min + rheo__history_stiffness(row->before, row->onset, a->derivative_before, partner, NULL, k_hist, c);
        const rheo__lanes kept = rheo__lanes_max(r - before / k * (r - length), rheo__lanes_all(0));
        length = rheo__lanes_if_less(none, length, rheo__lanes_if_less(before, k, kept, length), length);
        rheo__lanes_put(a->new_rest_length, entry, length);
    }
    rheo__lanes_put(a->stiffness, entry, k);
    own->springs = rheo__lanes_add_if_less(none, length, own->springs, rheo__lanes_all(1));
    own->history = rheo__lanes_add_if_less(none, length, own->history, history);
    own->total += rheo__lanes_if_less(none, length, k, rheo__lanes_keep_less(r, support, k));
    own->most = rheo__lanes_max_if_less(none, length, own->most, c->materials ? k : history);
}

/* The stiffest spring and the largest sum so far, for diagnostics and the number of substeps. */
typedef struct rheo__stiffest {
    rheo_real most, sum;
    uint32_t spring_row, sum_row;
} rheo__stiffest;

/* Keeps the sums of a vector of rows, whose first has this rank. */
static inline void rheo__keep_stiffness(rheo__thickening *t, rheo__stiffest *stiffest, uint32_t rank,
                                        const rheo__stiffness_sums *own, rheo__stiffness_of of_rows,
                                        const rheo__hardening *c)
{
    const rheo__pairs *pairs = t->pairs;
    rheo__lanes_put(t->stiffness_sum, rank, own->total);
    if (rheo__lanes_any((own->most > stiffest->most) | (own->total > stiffest->sum)))
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
            if (RHEO__LANE(own->most, lane) > stiffest->most) {
                stiffest->most = RHEO__LANE(own->most, lane);
                stiffest->spring_row = rank + lane;
            }
            if (RHEO__LANE(own->total, lane) > stiffest->sum) {
                stiffest->sum = RHEO__LANE(own->total, lane);
                stiffest->sum_row = rank + lane;
            }
        }
    if (!t->wall_friction)
        return;
    const rheo__lanes zero = rheo__lanes_all(0),
                      scale = own->springs * (10 * (c->materials ? of_rows.k_min : rheo__lanes_all(c->k_min)));
    rheo_real friction[RHEO__LANES];
    rheo__lanes_put(friction, 0, rheo__lanes_keep_less(zero, scale, own->history / scale));
    for (uint32_t lane = 0; lane < RHEO__LANES && rank + lane < pairs->rows; lane++)
        t->wall_friction[pairs->id_of[rank + lane]] = friction[lane];
}

/* Notes the largest sum, and the ends of the first spring with the largest stiffness. */
static inline void rheo__note_stiffest(rheo__thickening *t, const rheo__springs *springs,
                                       const rheo__stiffest *stiffest, const rheo__hardening *c)
{
    const rheo__pairs *p = &springs->pairs;
    const bool any = stiffest->spring_row < p->rows;
    t->max_stiffness = any ? (c->materials ? 0 : c->k_min) + stiffest->most : 0;
    t->max_stiffness_sum = stiffest->sum;
    t->diagnostics.stiffest[0] = t->diagnostics.stiffest[1] = -1;
    t->diagnostics.stiffest_particle = stiffest->sum_row < p->rows ? (double)p->id_of[stiffest->sum_row] : -1;
    const uint32_t row = any ? stiffest->spring_row : 0;
    for (size_t k = rheo__pairs_first(p, row); any && k < rheo__pairs_end(p, row); k += p->width)
        if (springs->rest_length[k] >= 0 && t->pair_stiffness[k] == t->max_stiffness) {
            const uint32_t a = p->id_of[row], b = p->id_of[rheo__pairs_partner(p, k)];
            t->diagnostics.stiffest[0] = a < b ? a : b;
            t->diagnostics.stiffest[1] = a < b ? b : a;
            return;
        }
}

#endif
