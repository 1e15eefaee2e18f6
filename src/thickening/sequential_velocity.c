/* Stage velocity of scheme sequential: v = (x - xprev)/step (docs/model.md). */
#include "thickening/thickening.h"

rheo_result rheo__stage_velocity(rheo__state *s, void *context)
{
    const rheo__thickening *t = context;
    const rheo_real *previous = s->before[RHEO__FIELD_position];
    const rheo_real rate = 1 / (rheo_real)t->def->step;
    for (size_t i = 0; i < 3 * (size_t)s->particles; i++)
        s->velocity[i] = (s->position[i] - previous[i]) * rate;
    return RHEO_OK;
}
