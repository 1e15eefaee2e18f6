/*
 * Stages neighbours_start and neighbours: the pairs within the support at the start of the step, which viscosity
 * needs, and at the predicted positions, which springs and densities need. Two lists, since a list kept from the last
 * step would be state that no file holds.
 */
#include "thickening/thickening.h"

static rheo_result build(rheo_state *s, rheo_thickening *t, bool with_rows)
{
    const rheo_pairs *pairs = &s->springs_other.pairs;
    if (!rheo_neighbours_build(&t->list, &s->springs_other.pairs, &t->allocator, s->particles, s->position,
                               t->support, with_rows))
        return RHEO_ERROR_MEMORY;
    t->found.mean_neighbours = s->particles ? 2 * (double)rheo_pairs_count(pairs) / s->particles : 0;
    return RHEO_OK;
}

rheo_result rheo_stage_neighbours_start(rheo_state *s, void *context)
{
    return build(s, context, false);
}

rheo_result rheo_stage_neighbours(rheo_state *s, void *context)
{
    return build(s, context, true);
}
