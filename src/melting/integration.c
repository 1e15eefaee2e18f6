/* Stage integration, docs/melting.md (9): integrates the rates to densities, temperatures and positions. */
#include "core/account.h"
#include "melting/melting.h"

static void integrate_heat(rheo__state *s, rheo__melting *m)
{
    const rheo_real by = m->substep * (rheo_real)m->def->melting.diffusivity;
    if (rheo__has_account(s))
        rheo__account_apply(s, RHEO__FIELD_temperature, RHEO_SOURCE_SUM, by, RHEO__SUM_heat_rate);
    for (uint32_t i = 0; i < m->pairs.rows; i++)
        m->temperature[i] = s->temperature[m->pairs.id_of[i]] += by * m->heat_rate[i];
}

/* The account of the motion of a particle that moves with velocity v. */
static void keep_motion(const rheo__state *s, const rheo__melting *m, const rheo_real v[3], bool in_place,
                        bool continuity)
{
    rheo__account_set(s, RHEO__SUM_motion, RHEO_SOURCE_VELOCITY, 0, v[0], v[1], v[2]);
    rheo__account_apply(s, RHEO__SUM_motion, RHEO_SOURCE_SUM, 1, RHEO__SUM_drift);
    rheo__account_apply(s, RHEO__FIELD_position, RHEO_SOURCE_SUM, m->substep, RHEO__SUM_motion);
    if (in_place)
        rheo__account_apply(s, RHEO__FIELD_velocity, RHEO_SOURCE_SUM, 1, RHEO__SUM_drift);
    if (continuity)
        rheo__account_apply(s, RHEO__FIELD_density, RHEO_SOURCE_SUM, m->substep, RHEO__SUM_density_rate);
}

static void integrate_motion(rheo__state *s, rheo__melting *m)
{
    const bool in_place = m->def->paper.xsph, continuity = m->def->melting.density == RHEO_DENSITY_CONTINUITY;
    if (rheo__has_account(s) && s->account->id < s->particles)
        keep_motion(s, m, s->velocity + 3 * (size_t)s->account->id, in_place, continuity);
    for (uint32_t i = 0; i < m->pairs.rows; i++) {
        const uint32_t id = m->pairs.id_of[i];
        rheo_real *x = s->position + 3 * (size_t)id, *v = s->velocity + 3 * (size_t)id;
        const rheo__point drift = m->drift[i];
        const rheo_real moved[3] = {v[0] + drift.x, v[1] + drift.y, v[2] + drift.z};
        for (int axis = 0; axis < 3; axis++) {
            x[axis] += m->substep * moved[axis];
            if (in_place)
                v[axis] = moved[axis];
        }
        if (continuity)
            s->density[id] += m->substep * m->density_rate[i];
    }
}

/* Diagnostics of density. Four sums, so that additions do not wait for each other. */
static void note_densities(const rheo__state *s, rheo__melting *m)
{
    enum { SUMS = 4 };
    const rheo_real rest = (rheo_real)m->def->melting.rest_density;
    double error[SUMS] = {0};
    rheo_real largest = 0;
    m->diagnostics.max_density_id = -1;
    for (uint32_t id = 0; id < s->particles; id++) {
        const rheo_real difference = s->density[id] - rest, size = difference < 0 ? -difference : difference;
        error[id % SUMS] += (double)size;
        if (size > largest) {
            largest = size;
            m->diagnostics.max_density_id = id;
        }
    }
    const double scale = 1 / (double)rest;
    m->diagnostics.max_density_error = (double)largest * scale;
    m->diagnostics.density_error =
        s->particles ? ((error[0] + error[1]) + (error[2] + error[3])) * scale / s->particles : 0;
}

/* Fluid that is torn apart in one substep gets a density of 0 or less; then the step fails. */
static bool has_density(rheo__state *s)
{
    for (uint32_t id = 0; id < s->particles; id++)
        if (s->density[id] <= 0) { /* false for NaN, which the step finds */
            s->refusal = (rheo__refusal){RHEO__FIELD_density, id, RHEO_FAILURE_DENSITY_NOT_POSITIVE, 0, 0};
            return false;
        }
    return true;
}

rheo_result rheo__stage_integration(rheo__state *s, void *context)
{
    rheo__melting *m = context;
    if (m->heat)
        integrate_heat(s, m);
    if (m->def->melting.flow == RHEO_FLOW_ON) {
        integrate_motion(s, m);
        note_densities(s, m);
    }
    return has_density(s) ? RHEO_OK : RHEO_ERROR_STATE;
}
