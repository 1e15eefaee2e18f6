/*
 * Stage viscosity of scheme sequential (Clavet et al.; docs/model.md): an impulse along the line between two
 * neighbours that approach each other, limited to the one that stops them. With u = (v_i - v_j).r_ij > 0 and w = 1 - r/h:
 *
 *     I = min(step w (sigma u + beta u^2), u) r_ij;   v_i -= I/2;   v_j += I/2
 *
 * Sequential: each pair reads the velocities written by the pairs before it. Coinciding particles have no direction;
 * they get no impulse.
 */
#include "core/account_lanes.h"
#include "space/walk.h"
#include "thickening/thickening.h"

typedef struct constants {
    rheo_real sigma, beta, inverse_support;
} constants;

/* One pair in each lane. `row` has the ranks of the rows, for the account. */
static inline void push(rheo__lanes3 *vi, rheo__lanes3 xi, rheo__point *v, const rheo__point *x,
                        const rheo__walk_pairs *pairs, bool all, constants c, const rheo__state *s,
                        const rheo__pairs *list, const uint32_t *row)
{
    rheo__lanes3 xj = rheo__lanes_load(x, pairs->partner), vj = rheo__lanes_load(v, pairs->partner);
    rheo__lanes dx = xj.x - xi.x, dy = xj.y - xi.y, dz = xj.z - xi.z;
    rheo__lanes r2 = dx * dx + dy * dy + dz * dz;
    rheo__lanes r = rheo__lanes_sqrt(r2);
    rheo__lanes inverse = rheo__lanes_keep(r2 > 0, 1 / r);
    rheo__lanes w = 1 - r * c.inverse_support;
    dx *= inverse;
    dy *= inverse;
    dz *= inverse;
    rheo__lanes u = (vi->x - vj.x) * dx + (vi->y - vj.y) * dy + (vi->z - vj.z) * dz;
    u = rheo__lanes_keep(u > 0, u);
    rheo__lanes half = rheo__lanes_min(w * u * (c.sigma + c.beta * u), u) * RHEO__R(0.5);
    rheo__lanes3 i_loses = {dx * half, dy * half, dz * half}, j_loses = {-i_loses.x, -i_loses.y, -i_loses.z};
    if (!all) {
        i_loses = rheo__lanes3_keep(pairs->active, i_loses);
        j_loses = rheo__lanes3_keep(pairs->active, j_loses);
    }
    rheo__keep_exchange(s, list, RHEO__FIELD_velocity, RHEO_SOURCE_VISCOSITY, row[0], pairs->partner[0], i_loses);
    *vi = rheo__lanes3_minus(*vi, i_loses);
    rheo__lanes_store(v, pairs->partner, rheo__lanes3_minus(vj, j_loses));
}

static void push_rows(const rheo__state *s, const rheo__walk *walk, const rheo__pairs *list, const rheo__point *x,
                      rheo__point *v, constants c)
{
    const uint32_t *partner = list->partner;
    rheo__lanes3 xi[RHEO__VECTORS], vi[RHEO__VECTORS];
    rheo__walk_prefetch(walk, partner, sizeof *partner);
    RHEO__EACH_VECTOR (n) {
        xi[n] = rheo__lanes_load(x, rheo__walk_rows(walk, n));
        vi[n] = rheo__lanes_load(v, rheo__walk_rows(walk, n));
    }
    rheo__walk_pairs pairs;
    uint32_t k = 0;
    for (; k < walk->shortest; k++)
        RHEO__EACH_VECTOR (n) {
            rheo__walk_take(walk, n, k, partner, true, &pairs);
            push(&vi[n], xi[n], v, x, &pairs, true, c, s, list, rheo__walk_rows(walk, n));
        }
    for (uint32_t longest = rheo__walk_longest(walk); k < longest; k++)
        RHEO__EACH_VECTOR (n)
            if (k < walk->longest[n]) {
                rheo__walk_take(walk, n, k, partner, false, &pairs);
                push(&vi[n], xi[n], v, x, &pairs, false, c, s, list, rheo__walk_rows(walk, n));
            }
    RHEO__EACH_VECTOR (n)
        rheo__lanes_store(v, rheo__walk_rows(walk, n), vi[n]);
}

rheo_result RHEO__VARIANT(stage_sequential_viscosity)(rheo__state *s, void *context)
{
    const rheo__thickening *t = context;
    const rheo__pairs *pairs = t->pairs;
    const rheo_world_def *def = t->def;
    rheo__point *x = t->position, *v = t->velocity;
    rheo__gather(x, s->position, pairs->id_of, s->particles);
    rheo__gather(v, s->velocity, pairs->id_of, s->particles);
    const rheo_real step = (rheo_real)def->step;
    const constants c = {step * (rheo_real)def->fluid.linear_viscosity,
                         step * (rheo_real)def->fluid.quadratic_viscosity, (rheo_real)(1 / def->fluid.support)};
    for (uint32_t group = 0; group < t->list.group_count; group++) {
        rheo__walk walk = rheo__walk_group(&t->list, group, pairs->rows);
        while (rheo__walk_on(&walk, pairs->start))
            push_rows(s, &walk, pairs, x, v, c);
    }
    rheo__scatter(s->velocity, v, pairs->id_of, s->particles);
    return RHEO_OK;
}
