/*
 * Stage multiplier of scheme positions (Ozgen et al., Eq. 6 and 4.5; docs/model.md, Scheme positions): how much the
 * history stiffens the fluid around a particle. Over its N neighbours at the start of the step,
 *
 *     n = |D^q x_i - D^q x_j|,  F = sum k_hist n^2/(n + n0)/(10 k_min N),  m = 1 + 10 F
 *
 * So m is the mean of K/k_min over the springs that the particle would have in scheme summed, and F is the friction at
 * walls, as there.
 */
#include "thickening/stiffness.h"

/* Of one partner of each row. */
static inline void add_pair(const rheo__thickening *t, const rheo__wide_lanes *row, rheo__lanes3 derivative,
                            size_t entry, const rheo__hardening *c, rheo__lanes *history, rheo__lanes *count)
{
    const uint32_t *partner = t->pairs->partner + entry;
    const rheo__lanes3 d = rheo__lanes3_minus(rheo__lanes_load_narrow_at(t->point, partner), row->at);
    const rheo__lanes r2 = d.x * d.x + d.y * d.y + d.z * d.z, support2 = rheo__lanes_all(c->support * c->support),
                      k = rheo__history_stiffness(derivative, rheo__lanes_all(0), t->derivative, partner, NULL,
                                                  rheo__lanes_all(c->k_hist), c);
    *history = rheo__lanes_add_if_less(r2, support2, *history, k);
    *count = rheo__lanes_add_if_less(r2, support2, *count, rheo__lanes_all(1));
}

rheo_result RHEO__VARIANT(stage_positions_multiplier)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo__pairs *p = t->pairs;
    const rheo_world_def *def = t->def;
    const rheo__hardening c = {.k_hist = (rheo_real)def->history.stiffness,
                               .onset = (rheo_real)def->history.onset,
                               .support = (rheo_real)def->fluid.support,
                               .history = true};
    const rheo__lanes zero = rheo__lanes_all(0), ten_k_min = rheo__lanes_all(10 * (rheo_real)def->springs.stiffness),
                      most = rheo__lanes_all(
                          RHEO__R(1e30)); /* where k_min is far below the history, F would be infinite */
    rheo__gather(t->derivative, s->derivative, p->id_of, p->rows);
    rheo__positions_gather(s, t);
    RHEO__EACH_VECTOR_OF_ROWS(p, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        const rheo__wide_lanes row = rheo__lanes_load_wide_row(t->point + rank);
        const rheo__lanes3 derivative = rheo__lanes_load_row(t->derivative + rank);
        rheo__lanes history = zero, count = zero;
        RHEO__EACH_ENTRY(p, block, first, entry)
        add_pair(t, &row, derivative, entry, &c, &history, &count);
        const rheo__lanes scale = count * ten_k_min,
                          f = rheo__lanes_keep_less(zero, scale, rheo__lanes_min(history / scale, most));
        rheo__lanes_put(t->multiplier, rank, 1 + 10 * f);
        rheo_real friction[RHEO__LANES];
        rheo__lanes_put(friction, 0, f);
        for (uint32_t lane = 0; t->wall_friction && lane < RHEO__LANES && rank + lane < p->rows; lane++)
            t->wall_friction[p->id_of[rank + lane]] = friction[lane];
    }
    return RHEO_OK;
}
