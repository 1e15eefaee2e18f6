/* Stage prediction: x += step v (docs/model.md, 3). The positions at the start of the step are in state->before. */
#include "thickening/thickening.h"

rheo_result rheo__stage_prediction(rheo__state *s, void *context)
{
    const rheo__thickening *t = context;
    const rheo_real step = (rheo_real)t->def->step;
    for (size_t i = 0; i < 3 * (size_t)s->particles; i++)
        s->position[i] += step * s->velocity[i];
    return RHEO_OK;
}
