/*
 * Stage stiffness of scheme summed (Ozgen et al., Eq. 6; docs/model.md, 3): the stiffness of every pair, from the
 * history at the start of the step,
 *
 *     n = |D^q x_i - D^q x_j|,  K = k_min + k_hist n^2/(n + n0)
 *
 * its sum over the springs of a particle, and the friction of the particle at walls. The onset n0 keeps the noise of
 * D^q in fluid at rest from changing K: changes of K do work on stretched springs, and the motion that they cause is
 * noise again. If hardening is passive, a spring whose stiffness has grown since the last step keeps its force:
 *
 *     L = r - (K of the last step/K) (r - L)
 */
#include "space/row_blocks.h"
#include "thickening/thickening.h"

typedef struct constants {
    rheo_real k_min, k_hist, onset, support2;
} constants;

/* Sums of a vector of rows, over springs; `stiffness` also over pairs that will get a spring in the step. */
typedef struct sums {
    rheo__lanes springs, history, most; /* number; sum and largest of k_hist |D^q x_i - D^q x_j| */
    rheo__lanes stiffness;
} sums;

/* The particles of a vector of rows. */
typedef struct rows {
    rheo__lanes3 x, derivative, derivative_before;
} rows;

/* k_hist |D^q x_i - D^q x_j|. */
static inline rheo__lanes history_stiffness(rheo__lanes3 di, const rheo__point *derivative, const uint32_t *partner,
                                            const constants *c)
{
    const rheo__lanes3 d = rheo__lanes3_minus(di, rheo__lanes_load(derivative, partner));
    const rheo__lanes n = rheo__lanes_sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    return c->k_hist * rheo__lanes_keep(n > 0, n * (n / (n + c->onset)));
}

static inline void add_pair(sums *own, rheo__thickening *t, rheo_real *rest_length, size_t entry, const rows *row,
                            bool passive, const constants *c)
{
    const uint32_t *partner = t->pairs->partner + entry;
    const rheo__lanes history = history_stiffness(row->derivative, t->derivative, partner, c), k = c->k_min + history;
    const rheo__lanes3 d = rheo__lanes3_minus(row->x, rheo__lanes_load(t->position, partner));
    const rheo__lanes r2 = d.x * d.x + d.y * d.y + d.z * d.z;
    if (passive) {
        const rheo__lanes before =
            c->k_min + history_stiffness(row->derivative_before, t->derivative_before, partner, c);
        const rheo__lanes r = rheo__lanes_sqrt(r2), length = rheo__lanes_at(rest_length, entry);
        const rheo__lanes moved = rheo__lanes_max(r - before / k * (r - length), rheo__lanes_all(0));
        rheo__lanes_put(rest_length, entry, rheo__lanes_select((length >= 0) & (k > before), moved, length));
    }
    const rheo__mask spring = rheo__lanes_at(rest_length, entry) >= 0;
    rheo__lanes_put(t->pair_stiffness, entry, k);
    const rheo__lanes of_spring = rheo__lanes_keep(spring, history);
    own->springs += rheo__lanes_keep(spring, rheo__lanes_all(1));
    own->history += of_spring;
    own->stiffness += rheo__lanes_keep(spring | ((r2 > 0) & (r2 < c->support2)), k);
    own->most = rheo__lanes_max(of_spring, own->most);
}

/* Notes the ends of the first spring with the largest stiffness. */
static void note_stiffest(rheo__thickening *t, const rheo__springs *springs, uint32_t row, rheo_real most)
{
    const rheo__pairs *p = &springs->pairs;
    t->diagnostics.stiffest[0] = t->diagnostics.stiffest[1] = -1;
    for (; row < p->rows; row++)
        for (size_t k = rheo__pairs_first(p, row); k < rheo__pairs_end(p, row); k += p->width)
            if (springs->rest_length[k] >= 0 && t->pair_stiffness[k] == most) {
                const uint32_t a = p->id_of[row], b = p->id_of[p->partner[k]];
                t->diagnostics.stiffest[0] = a < b ? a : b;
                t->diagnostics.stiffest[1] = a < b ? b : a;
                return;
            }
}

rheo_result RHEO__VARIANT(stage_stiffness)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo__springs *springs = &s->springs;
    const rheo__pairs *pairs = &springs->pairs;
    const constants c = {(rheo_real)t->def->springs.stiffness, (rheo_real)t->def->history.stiffness,
                         (rheo_real)t->def->history.onset,
                         (rheo_real)(t->def->fluid.support * t->def->fluid.support)};
    const bool history = rheo__state_has(s, RHEO__FIELD_history_rows),
               passive = history && t->def->history.hardening == RHEO_HARDENING_PASSIVE;
    if (history) {
        rheo__gather(t->derivative, s->derivative, pairs->id_of, pairs->rows);
        if (passive)
            rheo__gather(t->derivative_before, s->before[RHEO__FIELD_derivative], pairs->id_of, pairs->rows);
    }
    rheo_real most = -1, largest_sum = 0;
    uint32_t stiffest_row = pairs->rows;
    t->diagnostics.stiffest_particle = -1;
    RHEO__EACH_VECTOR_OF_ROWS(pairs, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        uint32_t own_rank[RHEO__LANES];
        rheo__own_ranks(rank, own_rank);
        const rows row = {rheo__lanes_load(t->position, own_rank), rheo__lanes_load(t->derivative, own_rank),
                          rheo__lanes_load(t->derivative_before, own_rank)};
        sums own = {rheo__lanes_all(0), rheo__lanes_all(0), rheo__lanes_all(0), rheo__lanes_all(0)};
        RHEO__EACH_ENTRY(pairs, block, first, entry)
        add_pair(&own, t, springs->rest_length, entry, &row, passive, &c);
        const rheo__lanes sum = own.stiffness;
        rheo__lanes_put(t->stiffness_sum, rank, sum);
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
            const rheo_real count = RHEO__LANE(own.springs, lane), stiff = RHEO__LANE(own.history, lane);
            if (rank + lane >= pairs->rows)
                break;
            if (count > 0 && RHEO__LANE(own.most, lane) > most) {
                most = RHEO__LANE(own.most, lane);
                stiffest_row = rank + lane;
            }
            if (RHEO__LANE(sum, lane) > largest_sum) {
                largest_sum = RHEO__LANE(sum, lane);
                t->diagnostics.stiffest_particle = pairs->id_of[rank + lane];
            }
            if (t->wall_friction)
                t->wall_friction[pairs->id_of[rank + lane]] =
                    count > 0 && c.k_min > 0 ? stiff / (count * (10 * c.k_min)) : 0;
        }
    }
    t->max_stiffness = most >= 0 ? c.k_min + most : 0;
    t->max_stiffness_sum = largest_sum;
    note_stiffest(t, springs, stiffest_row, t->max_stiffness);
    return RHEO_OK;
}
