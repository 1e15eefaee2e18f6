/* Stage prediction: x += step v; the positions before are those that the step began with (docs/model.md, 3). */
#include "thickening/thickening.h"

rheo_result rheo__stage_prediction(rheo__state *s, void *context)
{
    const rheo__thickening *t = context;
    for (size_t i = 0; i < 3 * (size_t)s->particles; i++)
        s->position[i] += t->step * s->velocity[i];
    return RHEO_OK;
}
