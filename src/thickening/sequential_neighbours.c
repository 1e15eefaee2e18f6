/*
 * Stages neighbours_start and neighbours: the pairs within the support at the start of the step, for viscosity, and
 * at the predicted positions, for springs and densities. Reusing last step's list for viscosity would be hidden state
 * that no checkpoint contains.
 */
#include "thickening/thickening.h"

static rheo_result build(rheo__state *s, rheo__thickening *t, bool with_rows)
{
    if (!rheo__neighbours_build(&t->list, &t->found_pairs, &t->allocator, s->particles, s->position,
                                t->def->fluid.support, with_rows))
        return RHEO_ERROR_MEMORY;
    t->pairs = &t->found_pairs;
    t->diagnostics.mean_neighbours = s->particles ? 2 * (double)rheo__pairs_count(t->pairs) / s->particles : 0;
    return RHEO_OK;
}

rheo_result rheo__stage_neighbours_start(rheo__state *s, void *context)
{
    return build(s, context, false);
}

rheo_result rheo__stage_sequential_neighbours(rheo__state *s, void *context)
{
    return build(s, context, true);
}
