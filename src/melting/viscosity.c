/*
 * Stage viscosity, docs/melting.md (4, 5): the apparent viscosity of every particle (rheology.h), and its effect on
 * velocities,
 *
 *     implicit   v + dt K v = v*   by conjugate gradients (conjugate_gradient.c)
 *     explicit   v = v* - dt K v0
 *
 * v0 and v* are the velocities before and after stage momentum; K is in viscous_operator.c.
 */
#include "core/account.h"
#include "melting/rheology.h"
#include "melting/rows.h"
#include "melting/viscous_operator.h"

static void find_viscosities(const rheo__state *s, rheo__melting *m)
{
    const rheo_world_def *def = m->def;
    const bool heat = rheo__state_has(s, RHEO__FIELD_temperature), jump = def->melting.rheology == RHEO_RHEOLOGY_JUMP;
    for (uint32_t i = 0; i < s->particles; i += RHEO__LANES) {
        rheo__lanes eta = rheo__lanes_all((rheo_real)def->melting.viscosity);
        if (jump) {
            const rheo__lanes temperature =
                heat ? rheo__lanes_at(m->temperature, i) : rheo__lanes_all((rheo_real)def->melting.temperature);
            eta = rheo__lanes_viscosity(def, rheo__lanes_jump(def, temperature), rheo__lanes_at(m->shear_rate, i));
        }
        rheo__lanes_put(m->viscosity, i, eta);
    }
    for (uint32_t i = 0; i < s->particles; i++)
        m->point[i].more =
            (rheo__point){m->viscosity[i], m->viscosity[i] / m->velocity[i].w, m->viscous_factor[i], 0};
    m->point[s->particles].more = (rheo__point){1, 1, 1, 0};
}

/*
 * Handles a failure of the solver. If velocities were not finite before it, the step finds them in the state;
 * otherwise the viscosity is too large.
 */
static rheo_result give_up(rheo__state *s, const rheo__melting *m)
{
    uint32_t worst = 0;
    for (uint32_t i = 0; i < s->particles; i++) {
        const rheo_real sum = m->velocity[i].x + m->velocity[i].y + m->velocity[i].z;
        if (!(sum - sum == 0))
            return RHEO_OK;
        worst = m->viscosity[i] > m->viscosity[worst] ? i : worst;
    }
    s->refusal = (rheo__refusal){RHEO__FIELD_velocity, s->particles ? m->pairs.id_of[worst] : 0,
                                 RHEO_FAILURE_VISCOSITY_OUT_OF_RANGE, 0, 0};
    return RHEO_ERROR_STATE;
}

static void solve_explicitly(rheo__melting *m)
{
    const uint32_t count = m->pairs.rows;
    rheo__point *v0 = m->cg.p, *Av0 = m->cg.Ap;
    for (uint32_t i = 0; i <= count; i++)
        v0[i] = rheo__point_add((rheo__point){0, 0, 0, 0}, 1, m->velocity_before[i]);
    if (m->def->melting.stress == RHEO_STRESS_PAIRWISE)
        RHEO__VARIANT(make_viscous_operator)(m, v0, Av0);
    else
        RHEO__VARIANT(apply_viscous_operator)(m, v0, Av0, true);
    for (uint32_t i = 0; i < count; i++)
        m->cg.x[i] = rheo__point_add(rheo__point_add(m->velocity[i], -1, Av0[i]), 1, v0[i]);
}

rheo_result RHEO__VARIANT(stage_viscous)(rheo__state *s, void *context)
{
    rheo__melting *m = context;
    const bool implicit = m->def->melting.solver == RHEO_VISCOSITY_IMPLICIT;
    find_viscosities(s, m);
    if (implicit) {
        const int64_t iterations = RHEO__VARIANT(conjugate_gradient)(s, m);
        if (iterations == RHEO__UNSOLVABLE)
            return give_up(s, m);
        *s->iterations += (uint64_t)iterations;
    } else {
        solve_explicitly(m);
    }
    if (RHEO__ACCOUNTS_HERE && rheo__has_account(s)) {
        if (implicit) /* for m->stress of the solution */
            RHEO__VARIANT(apply_viscous_operator)(m, m->cg.x, m->cg.Ap, true);
        rheo__account_viscosity(s, m, implicit ? m->cg.x : m->cg.p);
    }
    for (uint32_t i = 0; i < s->particles; i++)
        m->velocity[i] = (rheo__point){m->cg.x[i].x, m->cg.x[i].y, m->cg.x[i].z, m->velocity[i].w};
    rheo__scatter(s->velocity, m->velocity, m->pairs.id_of, s->particles);
    return RHEO_OK;
}
