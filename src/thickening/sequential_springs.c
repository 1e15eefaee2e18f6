/*
 * Stage springs of scheme sequential (Clavet et al.; docs/model.md): new neighbours get springs, and pairs that have
 * left the support lose theirs, so that the springs are the pairs; then rest lengths flow. With d = gamma L:
 *
 *     r > L + d:  L += step alpha (r - L - d);      r < L - d:  L -= step alpha (L - d - r)
 *
 * A rest length is carried over by finding the pair among the springs of the previous step. Rows change little
 * between steps, so the search starts after the last hit.
 */
#include <assert.h>

#include "core/lanes.h"
#include "thickening/thickening.h"

/* Index of rank j in row i, searched from `hint` on and then from the start; SIZE_MAX if it is not there. */
static size_t find(const rheo__pairs *p, uint32_t i, uint32_t j, size_t hint)
{
    const size_t first = rheo__pairs_first(p, i), end = rheo__pairs_end(p, i);
    for (size_t k = hint; k < end; k += p->width)
        if (rheo__pairs_partner(p, k) == j)
            return k;
    for (size_t k = first; k < hint; k += p->width)
        if (rheo__pairs_partner(p, k) == j)
            return k;
    return SIZE_MAX;
}

/*
 * Sets the rest length of every pair that had a spring, and -1 for the others. was: the previous rank of each rank.
 */
static void carry_over(const rheo__springs *old, const rheo__pairs *pairs, uint32_t *was, rheo_real *rest_length)
{
    const rheo__pairs *op = &old->pairs;
    const uint32_t none = UINT32_MAX;
    for (uint32_t i = 0; i < pairs->rows; i++) {
        uint32_t id = pairs->id_of[i];
        was[i] = id < op->rows ? op->rank_of[id] : none; /* a new particle had no springs */
    }
    for (uint32_t i = 0; i < pairs->rows; i++) {
        const uint32_t old_i = was[i];
        size_t hint = old_i != none ? rheo__pairs_first(op, old_i) : 0;
        const size_t end = old_i != none ? rheo__pairs_end(op, old_i) : 0;
        for (uint32_t k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
            const uint32_t old_j = was[pairs->partner[k]];
            size_t place = SIZE_MAX;
            if (hint < end && rheo__pairs_partner(op, hint) == old_j) {
                place = hint;
                hint += op->width;
            } else if (old_i != none && old_j != none) {
                if (old_i < old_j) {
                    place = find(op, old_i, old_j, hint);
                    hint = place != SIZE_MAX ? place + op->width : hint;
                } else {
                    place = find(op, old_j, old_i, rheo__pairs_first(op, old_j));
                }
            }
            rest_length[k] = place != SIZE_MAX ? old->rest_length[place] : -1;
        }
    }
}

/*
 * Sets the rest lengths of new springs, then flows all. Works on whole vectors, so the arrays have room for one more.
 */
static void flow(const rheo__thickening *t, rheo_real *rest_length, const rheo_real *distance2, size_t count)
{
    const rheo_world_def *def = t->def;
    const rheo_real rate = (rheo_real)def->step * (rheo_real)def->springs.plasticity,
                    yield = (rheo_real)def->springs.yield_ratio;
    rheo__lanes support = rheo__lanes_all((rheo_real)def->fluid.support), zero = rheo__lanes_all(0);
    const bool at_distance = def->springs.rest_length == RHEO_REST_DISTANCE;
    for (size_t k = 0; k < count; k += RHEO__LANES) {
        rheo__lanes length, r;
        memcpy(&length, rest_length + k, sizeof length);
        memcpy(&r, distance2 + k, sizeof r);
        r = rheo__lanes_sqrt(r);
        length = rheo__lanes_select(length < 0, at_distance ? r : support, length);
        rheo__lanes tolerated = yield * length;
        rheo__lanes stretched = rheo__lanes_max(r - length - tolerated, zero);
        rheo__lanes squeezed = rheo__lanes_max(length - tolerated - r, zero);
        /* A rate above 1/(1 + gamma) per step would overshoot; a length is never negative. */
        length = rheo__lanes_max(length + rate * (stretched - squeezed), zero);
        memcpy(rest_length + k, &length, sizeof length);
    }
}

rheo_result RHEO__VARIANT(stage_springs)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    rheo__springs *now = &s->springs_next;
    const size_t count = rheo__pairs_count(&t->found_pairs);
    assert(t->pairs == &t->found_pairs && s->springs_backup == RHEO__NO_BACKUP &&
           t->found_pairs.rows == s->particles);
    if (!rheo__springs_reserve(now, &t->allocator, count + RHEO__LANES))
        return RHEO_ERROR_MEMORY;
    /* Exchanged instead of copied, which would cost 1.5 % of a step. */
    const rheo__pairs swap_pairs = now->pairs;
    now->pairs = t->found_pairs;
    now->count = count;
    t->found_pairs = swap_pairs;
    carry_over(&s->springs, &now->pairs, t->rank_before, now->rest_length);
    if (!rheo__springs_make_keys(now, &t->allocator))
        return RHEO_ERROR_MEMORY;
    flow(t, now->rest_length, t->list.distance2, count);
    rheo__state_exchange_springs(s);
    t->pairs = &s->springs.pairs;
    return RHEO_OK;
}
