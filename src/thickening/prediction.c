/* Stage prediction: x += substep v (docs/model.md, Motion). */
#include "core/account.h"
#include "thickening/thickening.h"

rheo_result rheo__stage_prediction(rheo__state *s, void *context)
{
    const rheo__thickening *t = context;
    const rheo_real step = t->substep;
    if (rheo__has_account(s))
        rheo__account_apply(s, RHEO__FIELD_position, RHEO_SOURCE_VELOCITY, step, RHEO__FIELD_velocity);
    for (size_t i = 0; i < 3 * (size_t)s->particles; i++)
        s->position[i] += step * s->velocity[i];
    return RHEO_OK;
}
