/*
 * Stage viscosity (Clavet et al.; docs/model.md, 2): an impulse along the line between two neighbours that approach
 * each other, never more than stops them. With u = (v_i - v_j).r_ij > 0 and w = 1 - r/h:
 *
 *     I = min(step w (sigma u + beta u^2), u) r_ij;   v_i -= I/2;   v_j += I/2
 *
 * Sequential: each pair sees the velocities that the pairs before it left. Coinciding particles have no direction and
 * are left alone.
 */
#include "space/walk.h"
#include "thickening/thickening.h"

typedef struct constants {
    rheo_real sigma, beta, inverse_support;
} constants;

/* One pair in each lane. */
static inline void push(rheo_lanes3 *vi, rheo_lanes3 xi, rheo_point *v, const rheo_point *x, const uint32_t *partner,
                        rheo_mask active, constants c)
{
    rheo_lanes3 xj = rheo_lanes_load(x, partner), vj = rheo_lanes_load(v, partner);
    rheo_lanes dx = xj.x - xi.x, dy = xj.y - xi.y, dz = xj.z - xi.z;
    rheo_lanes r2 = dx * dx + dy * dy + dz * dz;
    rheo_lanes r = rheo_lanes_sqrt(r2);
    rheo_lanes inverse = rheo_lanes_keep(r2 > 0, 1 / r);
    rheo_lanes w = 1 - r * c.inverse_support;
    dx *= inverse;
    dy *= inverse;
    dz *= inverse;
    rheo_lanes u = (vi->x - vj.x) * dx + (vi->y - vj.y) * dy + (vi->z - vj.z) * dz;
    u = rheo_lanes_keep(u > 0, u);
    rheo_lanes half = rheo_lanes_min(w * u * (c.sigma + c.beta * u), u) * RHEO_R(0.5);
    dx *= half;
    dy *= half;
    dz *= half;
    vi->x = rheo_lanes_select(active, vi->x - dx, vi->x);
    vi->y = rheo_lanes_select(active, vi->y - dy, vi->y);
    vi->z = rheo_lanes_select(active, vi->z - dz, vi->z);
    rheo_lanes_store(v, partner, (rheo_lanes3){vj.x + dx, vj.y + dy, vj.z + dz});
}

rheo_result rheo_stage_viscosity(rheo_state *s, void *context)
{
    const rheo_thickening *t = context;
    const rheo_pairs *pairs = &s->springs_other.pairs;
    rheo_point *x = t->position, *v = t->velocity;
    rheo_gather(x, s->position, pairs->id_of, s->particles);
    rheo_gather(v, s->velocity, pairs->id_of, s->particles);
    constants c = {t->step * t->linear_viscosity, t->step * t->quadratic_viscosity, t->inverse_support};

    for (int colour = 0; colour < RHEO_COLOURS; colour++) {
        rheo_walk walk = rheo_walk_colour(&t->list, colour, pairs->rows);
        while (rheo_walk_on(&walk, pairs->start)) {
            rheo_lanes3 xi = rheo_lanes_load(x, walk.row), vi = rheo_lanes_load(v, walk.row);
            for (uint32_t k = 0; k < walk.longest; k++) {
                uint32_t place[RHEO_LANES], partner[RHEO_LANES];
                rheo_walk_places(&walk, k, place);
                rheo_walk_partners(&walk, pairs->partner, k, place, partner);
                push(&vi, xi, v, x, partner, rheo_walk_active(&walk, k), c);
            }
            rheo_lanes_store(v, walk.row, vi);
        }
    }
    rheo_scatter(s->velocity, v, pairs->id_of, s->particles);
    return RHEO_OK;
}
