/* Stage velocity of scheme sequential: v = (x - xprev)/step (docs/model.md). */
#include "core/account.h"
#include "thickening/thickening.h"

rheo_result rheo__stage_velocity(rheo__state *s, void *context)
{
    const rheo__thickening *t = context;
    const rheo_real *previous = s->before[RHEO__FIELD_position];
    const rheo_real rate = 1 / (rheo_real)t->def->step;
    for (size_t i = 0; i < 3 * (size_t)s->particles; i++)
        s->velocity[i] = (s->position[i] - previous[i]) * rate;
    if (rheo__has_account(s)) {
        const rheo_real *v = s->velocity + 3 * (size_t)s->account->id;
        rheo__account_set(s, RHEO__FIELD_velocity, RHEO_SOURCE_DISPLACEMENT, 0, v[0], v[1], v[2]);
    }
    return RHEO_OK;
}
