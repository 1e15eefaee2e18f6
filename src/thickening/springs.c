/*
 * Stage springs (Clavet et al.; docs/model.md, 4): springs are made between new neighbours and dropped from pairs
 * that have left the support, so the springs are the pairs; then rest lengths flow. With d = gamma L:
 *
 *     r > L + d:  L += step alpha (r - L - d);      r < L - d:  L -= step alpha (L - d - r)
 *
 * A rest length is carried over by looking the pair up among the springs of the last step. Rows change little from
 * one step to the next, so the place after the last hit is tried first.
 */
#include "thickening/thickening.h"

/* The place of rank j in row i at or after `hint`, wrapping round; UINT32_MAX if it is not there. */
static uint32_t find(const rheo_pairs *p, uint32_t i, uint32_t j, uint32_t hint)
{
    for (uint32_t k = hint; k < p->start[i + 1]; k++)
        if (p->partner[k] == j)
            return k;
    for (uint32_t k = p->start[i]; k < hint; k++)
        if (p->partner[k] == j)
            return k;
    return UINT32_MAX;
}

static void carry_over(const rheo_springs *old, const rheo_pairs *pairs, rheo_real *rest_length)
{
    const rheo_pairs *op = &old->pairs;
    for (uint32_t i = 0; i < pairs->rows; i++) {
        uint32_t id = pairs->id_of[i];
        if (id >= op->rows) { /* a new particle had no springs */
            for (uint32_t k = pairs->start[i]; k < pairs->start[i + 1]; k++)
                rest_length[k] = -1;
            continue;
        }
        uint32_t old_i = op->rank_of[id], hint = op->start[old_i];
        for (uint32_t k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
            uint32_t partner = pairs->id_of[pairs->partner[k]], place = UINT32_MAX;
            if (partner < op->rows) {
                uint32_t old_j = op->rank_of[partner];
                if (old_i < old_j) {
                    place = find(op, old_i, old_j, hint);
                    hint = place != UINT32_MAX ? place + 1 : hint;
                } else {
                    place = find(op, old_j, old_i, op->start[old_j]);
                }
            }
            rest_length[k] = place != UINT32_MAX ? old->rest_length[place] : -1;
        }
    }
}

rheo_result rheo_stage_springs(rheo_state *s, void *context)
{
    const rheo_thickening *t = context;
    rheo_springs *now = &s->springs_other;
    size_t count = rheo_pairs_count(&now->pairs);
    if (!rheo_springs_reserve(now, &t->allocator, count + 1))
        return RHEO_ERROR_MEMORY;
    rheo_real *rest_length = now->rest_length;
    carry_over(&s->springs, &now->pairs, rest_length);

    rheo_real rate = t->step * t->plasticity, yield = t->yield_ratio, support = (rheo_real)t->support;
    bool at_distance = t->rest_length == RHEO_REST_DISTANCE;
    for (size_t k = 0; k < count; k++) {
        rheo_real r = rheo_sqrt(now->pairs.distance2[k]);
        rheo_real fresh = at_distance ? r : support;
        rheo_real length = rest_length[k] < 0 ? fresh : rest_length[k];
        rheo_real tolerated = yield * length;
        rheo_real stretched = rheo_max(r - length - tolerated, 0);
        rheo_real squeezed = rheo_max(length - tolerated - r, 0);
        /* A rate above 1/(1 + gamma) a step would overshoot; a length is never negative. */
        rest_length[k] = rheo_max(length + rate * (stretched - squeezed), 0);
    }
    rheo_springs swap = s->springs;
    s->springs = *now;
    *now = swap;
    s->springs_stepped = true;
    return RHEO_OK;
}
