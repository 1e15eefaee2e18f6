/*
 * Stages neighbours_start and neighbours: the pairs within the support at the start of the step, which viscosity
 * needs, and at the predicted positions, which springs and densities need. Two lists, since a list kept from the last
 * step would be state that no file holds.
 */
#include "thickening/thickening.h"

static rheo_result build(rheo__state *s, rheo__thickening *t, bool with_rows)
{
    const rheo__pairs *pairs = &s->springs_next.pairs;
    if (!rheo__neighbours_build(&t->list, &s->springs_next.pairs, &t->allocator, s->particles, s->position,
                                t->support, with_rows))
        return RHEO_ERROR_MEMORY;
    t->diagnostics.mean_neighbours = s->particles ? 2 * (double)rheo__pairs_count(pairs) / s->particles : 0;
    return RHEO_OK;
}

rheo_result rheo__stage_neighbours_start(rheo__state *s, void *context)
{
    return build(s, context, false);
}

rheo_result rheo__stage_neighbours(rheo__state *s, void *context)
{
    return build(s, context, true);
}
