/* Stage gravity: v += substep g (docs/model.md, Motion). */
#include "core/account.h"
#include "thickening/thickening.h"

rheo_result rheo__stage_gravity(rheo__state *s, void *context)
{
    const rheo__thickening *t = context;
    const rheo_real step = t->substep;
    /* Four particles at a time: the compiler makes whole vectors of 12 values, but not of 3. */
    enum { AT_ONCE = 12 };
    rheo_real change[AT_ONCE];
    for (size_t k = 0; k < AT_ONCE; k++)
        change[k] = step * (rheo_real)t->def->gravity[k % 3];
    if (rheo__has_account(s))
        rheo__account_add(s, RHEO__FIELD_velocity, RHEO_SOURCE_GRAVITY, 0, change[0], change[1], change[2]);
    const size_t values = 3 * (size_t)s->particles;
    size_t i = 0;
    for (; i + AT_ONCE <= values; i += AT_ONCE)
        for (size_t k = 0; k < AT_ONCE; k++)
            s->velocity[i + k] += change[k];
    for (; i < values; i++)
        s->velocity[i] += change[i % 3];
    return RHEO_OK;
}
