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
#include "thickening/kernels.h"

typedef struct constants {
    rheo_real sigma, beta, inverse_support;
} constants;

/* One pair in each lane. */
static inline void push(rheo_lanes3 *vi, rheo_lanes3 xi, rheo_point *v, const rheo_point *x,
                        const rheo_walk_pairs *pairs, bool all, constants c)
{
    rheo_lanes3 xj = rheo_lanes_load(x, pairs->partner), vj = rheo_lanes_load(v, pairs->partner);
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
    rheo_lanes3 i_loses = {dx * half, dy * half, dz * half}, j_loses = {-i_loses.x, -i_loses.y, -i_loses.z};
    if (!all) {
        i_loses = rheo_lanes3_keep(pairs->active, i_loses);
        j_loses = rheo_lanes3_keep(pairs->active, j_loses);
    }
    *vi = rheo_lanes3_minus(*vi, i_loses);
    rheo_lanes_store(v, pairs->partner, rheo_lanes3_minus(vj, j_loses));
}

static void push_rows(const rheo_walk *walk, const uint32_t *partner, const rheo_point *x, rheo_point *v, constants c)
{
    rheo_lanes3 xi[RHEO_VECTORS], vi[RHEO_VECTORS];
    rheo_walk_prefetch(walk, partner, sizeof *partner);
    RHEO_EACH_VECTOR (n) {
        xi[n] = rheo_lanes_load(x, rheo_walk_rows(walk, n));
        vi[n] = rheo_lanes_load(v, rheo_walk_rows(walk, n));
    }
    rheo_walk_pairs pairs;
    uint32_t k = 0;
    for (; k < walk->shortest; k++)
        RHEO_EACH_VECTOR (n) {
            rheo_walk_take(walk, n, k, partner, true, &pairs);
            push(&vi[n], xi[n], v, x, &pairs, true, c);
        }
    for (uint32_t longest = rheo_walk_longest(walk); k < longest; k++)
        RHEO_EACH_VECTOR (n)
            if (k < walk->longest[n]) {
                rheo_walk_take(walk, n, k, partner, false, &pairs);
                push(&vi[n], xi[n], v, x, &pairs, false, c);
            }
    RHEO_EACH_VECTOR (n)
        rheo_lanes_store(v, rheo_walk_rows(walk, n), vi[n]);
}

rheo_result RHEO_KERNEL(stage_viscosity)(rheo_state *s, void *context)
{
    const rheo_thickening *t = context;
    const rheo_pairs *pairs = &s->springs_other.pairs;
    rheo_point *x = t->position, *v = t->velocity;
    rheo_gather(x, s->position, pairs->id_of, s->particles);
    rheo_gather(v, s->velocity, pairs->id_of, s->particles);
    constants c = {t->step * t->linear_viscosity, t->step * t->quadratic_viscosity, t->inverse_support};
    for (uint32_t group = 0; group < t->list.group_count; group++) {
        rheo_walk walk = rheo_walk_group(&t->list, group, pairs->rows);
        while (rheo_walk_on(&walk, pairs->start))
            push_rows(&walk, pairs->partner, x, v, c);
    }
    rheo_scatter(s->velocity, v, pairs->id_of, s->particles);
    return RHEO_OK;
}
