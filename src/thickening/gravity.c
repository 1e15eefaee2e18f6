/* Stage gravity: v += substep g (docs/model.md, Motion). */
#include "thickening/thickening.h"

rheo_result rheo__stage_gravity(rheo__state *s, void *context)
{
    const rheo__thickening *t = context;
    const rheo_real step = t->substep;
    const rheo_real gx = step * (rheo_real)t->def->gravity[0], gy = step * (rheo_real)t->def->gravity[1],
                    gz = step * (rheo_real)t->def->gravity[2];
    rheo_real *v = s->velocity;
    for (uint32_t i = 0; i < s->particles; i++, v += 3) {
        v[0] += gx;
        v[1] += gy;
        v[2] += gz;
    }
    return RHEO_OK;
}
