/*
 * Stage viscosity (Clavet et al.; docs/model.md, 2): an impulse along the line between two neighbours that approach
 * each other, never more than stops them. With u = (v_i - v_j).r_ij > 0 and w = 1 - r/h:
 *
 *     I = min(step w (sigma u + beta u^2), u) r_ij;   v_i -= I/2;   v_j += I/2
 *
 * Sequential: each pair sees the velocities that the pairs before it left. Coinciding particles have no direction and
 * are left alone.
 */
#include "thickening/thickening.h"

rheo_result rheo_stage_viscosity(rheo_state *s, void *context)
{
    const rheo_thickening *t = context;
    const rheo_pairs *pairs = &s->springs_other.pairs;
    rheo_point *x = t->position, *v = t->velocity;
    rheo_gather(x, s->position, pairs->id_of, s->particles);
    rheo_gather(v, s->velocity, pairs->id_of, s->particles);
    rheo_real sigma = t->step * t->linear_viscosity, beta = t->step * t->quadratic_viscosity;
    rheo_real inverse_support = t->inverse_support;

    for (uint32_t l = 0; l < t->list.line_count; l++)
        for (uint32_t i = t->list.line[l].first; i < t->list.line[l].end; i++) {
            rheo_point xi = x[i], vi = v[i];
            for (uint32_t k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
                uint32_t j = pairs->partner[k];
                rheo_real dx = x[j].x - xi.x, dy = x[j].y - xi.y, dz = x[j].z - xi.z;
                rheo_real r2 = pairs->distance2[k];
                rheo_real r = rheo_sqrt(r2);
                rheo_real inverse = r2 > 0 ? 1 / r : 0;
                rheo_real w = 1 - r * inverse_support;
                dx *= inverse;
                dy *= inverse;
                dz *= inverse;
                rheo_real u = (vi.x - v[j].x) * dx + (vi.y - v[j].y) * dy + (vi.z - v[j].z) * dz;
                u = rheo_max(u, 0);
                rheo_real impulse = rheo_min(w * u * (sigma + beta * u), u) * RHEO_R(0.5);
                dx *= impulse;
                dy *= impulse;
                dz *= impulse;
                vi.x -= dx;
                vi.y -= dy;
                vi.z -= dz;
                v[j].x += dx;
                v[j].y += dy;
                v[j].z += dz;
            }
            v[i] = vi;
        }
    rheo_scatter(s->velocity, v, pairs->id_of, s->particles);
    return RHEO_OK;
}
