/*
 * Stage viscosity of scheme positions: XSPH (Macklin and Mueller, "Position based fluids", Eq. 17; docs/model.md,
 * Scheme positions), at the positions at the end of the step. With w = 1 - r/h and m of stage multiplier,
 *
 *     f = step c (m_i + m_j)/2 w^2/rho0,  v_i += sum f/max(1, 2 F_i, 2 F_j) (v_j - v_i)
 *
 * where F is the sum of f over the neighbours of a particle. With the divisor any viscosity is stable: a particle takes
 * at most half of its velocity from its neighbours. All velocities follow from those before the stage, and the changes of
 * a pair are opposite to the last bit.
 */
#include "core/account_lanes.h"
#include "space/row_blocks.h"
#include "thickening/thickening.h"

typedef struct constants {
    rheo_real inverse_support, half_rate; /* step c/(2 rho0) */
} constants;

/* Sums of all rows: 2 F into density, or the new velocities into pressure_acceleration. */
RHEO__FOR_EACH_CASE void sum_all(const rheo__state *s, rheo__thickening *t, const constants *c, bool shares)
{
    const rheo__lanes zero = rheo__lanes_all(0);
    RHEO__EACH_VECTOR_OF_ROWS(t->pairs, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        const rheo__wide_lanes row = rheo__lanes_load_wide_row(t->point + rank);
        rheo__lanes share = zero;
        rheo__lanes3 gain = {zero, zero, zero};
        const rheo__keeper keeper = rheo__keeper_of(s, t->pairs, rank);
        if (!shares)
            rheo__keep_begin(&keeper, RHEO__SUM_viscosity);
        RHEO__EACH_ENTRY(t->pairs, block, first, entry)
        {
            const rheo__wide_lanes other = rheo__lanes_load_wide_at(t->point, t->pairs->partner + entry);
            const rheo__lanes3 d = rheo__lanes3_minus(other.at, row.at), v = rheo__lanes3_minus(other.more, row.more);
            const rheo__lanes r = rheo__lanes_sqrt(d.x * d.x + d.y * d.y + d.z * d.z),
                              w = rheo__lanes_max(1 - r * c->inverse_support, zero),
                              f = c->half_rate * (row.w + other.w) * (w * w);
            if (shares) {
                share += f;
                continue;
            }
            const rheo__lanes by = f / rheo__lanes_max(rheo__lanes_max(row.more_w, other.more_w), rheo__lanes_all(1));
            rheo__keep_pair(&keeper, RHEO__SUM_viscosity, RHEO_SOURCE_VISCOSITY, entry, by, v);
            gain.x += by * v.x;
            gain.y += by * v.y;
            gain.z += by * v.z;
        }
        if (!shares) {
            rheo__lanes_store_row(t->pressure_acceleration + rank,
                                  (rheo__lanes3){row.more.x + gain.x, row.more.y + gain.y, row.more.z + gain.z});
            continue;
        }
        rheo__lanes_put(t->density, rank, 2 * share);
    }
}

rheo_result RHEO__VARIANT(stage_positions_viscosity)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo__pairs *p = t->pairs;
    const rheo_world_def *def = t->def;
    const bool history =
        rheo__state_has(s, RHEO__FIELD_derivative) && def->positions.history != RHEO_POSITIONS_CONSTRAINT;
    const constants c = {(rheo_real)(1 / def->fluid.support),
                         t->substep * (rheo_real)(def->positions.viscosity / (2 * def->fluid.rest_density))};
    for (uint32_t i = 0; i < p->rows; i++) {
        const rheo_real *x = s->position + 3 * (size_t)p->id_of[i], *v = s->velocity + 3 * (size_t)p->id_of[i];
        t->point[i] = (rheo__wide_point){{x[0], x[1], x[2], history ? t->multiplier[i] : 1}, {v[0], v[1], v[2], 0}};
    }
    sum_all(s, t, &c, true);
    for (uint32_t i = 0; i < p->rows; i++)
        t->point[i].more.w = t->density[i];
    sum_all(s, t, &c, false);
    if (rheo__keeps_any(s))
        rheo__account_apply(s, RHEO__FIELD_velocity, RHEO_SOURCE_SUM, 1, RHEO__SUM_viscosity);
    rheo__scatter(s->velocity, t->pressure_acceleration, p->id_of, s->particles);
    return RHEO_OK;
}
