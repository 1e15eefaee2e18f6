/*
 * Stage substeps, docs/melting.md (9): divides the step into equal substeps. Their number follows from the state at
 * the start of the step: Eq. 10 of the paper without its misprints, and with the limit of explicit heat conduction,
 *
 *     dt = min(C h/(c + |v|max),  C h^2 rho0/(6 eta_max) if viscosity is explicit,  0.1 h^2/k)
 *
 * with the Courant number C; or as printed in the paper, dt = 0.1 min(h/(|v|max + c^2), h^2/(6 eta_max)).
 */
#include "core/math.h"
#include "melting/melting.h"
#include "melting/rheology.h"

static double fastest(const rheo__state *s, uint32_t *id)
{
    rheo_real most = 0;
    *id = 0;
    for (uint32_t i = 0; i < s->particles; i++) {
        const rheo_real *v = s->velocity + 3 * (size_t)i, speed2 = rheo__length2(v[0], v[1], v[2]);
        if (speed2 > most) {
            most = speed2;
            *id = i;
        }
    }
    return __builtin_sqrt((double)most);
}

/* Upper bound of the viscosities of all particles. */
static double max_viscosity(const rheo__state *s, const rheo_world_def *def)
{
    double jump = 0;
    if (!rheo__state_has(s, RHEO__FIELD_temperature))
        jump = rheo__melting_jump(def, def->melting.temperature);
    for (uint32_t i = 0; i < s->particles && rheo__state_has(s, RHEO__FIELD_temperature); i++) {
        const double own = rheo__melting_jump(def, (double)s->temperature[i]);
        jump = own > jump ? own : jump;
    }
    return rheo__melting_max_viscosity(def, jump);
}

/* The longest substep that the state allows, and which limit sets it. */
typedef struct limit {
    double substep;
    rheo_failure_reason reason; /* RHEO_FAILURE_SUBSTEPS_FOR_..., or RHEO_FAILURE_NONE for the whole step */
} limit;

static void tighten(limit *l, double substep, rheo_failure_reason reason)
{
    if (substep < l->substep)
        *l = (limit){substep, reason};
}

double rheo__melting_longest_substep(const rheo_world_def *def, double speed, double eta, bool heat,
                                     rheo_failure_reason *reason)
{
    const double h = rheo__melting_smoothing_length(def), c = def->melting.sound_speed;
    const bool moves = def->melting.flow == RHEO_FLOW_ON;
    limit longest = {def->step, RHEO_FAILURE_NONE};
    if (moves && def->paper.courant) {
        tighten(&longest, 0.1 * h / (speed + c * c), RHEO_FAILURE_SUBSTEPS_FOR_SOUND);
        if (eta > 0)
            tighten(&longest, 0.1 * h * h / (6 * eta), RHEO_FAILURE_SUBSTEPS_FOR_PRINTED_VISCOSITY);
    } else if (moves) {
        tighten(&longest, def->melting.courant_number * h / (c + speed), RHEO_FAILURE_SUBSTEPS_FOR_SOUND);
        if (eta > 0 && def->melting.solver == RHEO_VISCOSITY_EXPLICIT)
            tighten(&longest, def->melting.courant_number * h * h * def->melting.rest_density / (6 * eta),
                    RHEO_FAILURE_SUBSTEPS_FOR_VISCOSITY);
    }
    if (heat && def->melting.diffusivity > 0)
        tighten(&longest, 0.1 * h * h / def->melting.diffusivity, RHEO_FAILURE_SUBSTEPS_FOR_HEAT);
    *reason = longest.reason;
    return longest.substep;
}

static limit longest_substep(const rheo__state *s, const rheo__melting *m, uint32_t *id)
{
    const rheo_world_def *def = m->def;
    const double speed = fastest(s, id);
    const bool viscous =
        def->melting.flow == RHEO_FLOW_ON && (def->paper.courant || def->melting.solver == RHEO_VISCOSITY_EXPLICIT);
    limit longest;
    longest.substep =
        rheo__melting_longest_substep(def, speed, viscous ? max_viscosity(s, def) : 0, m->heat, &longest.reason);
    return longest;
}

rheo_result rheo__stage_substeps(rheo__state *s, void *context)
{
    rheo__melting *m = context;
    const rheo_world_def *def = m->def;
    uint64_t count = def->melting.substeps;
    if (count == 0) {
        uint32_t id;
        const limit longest = longest_substep(s, m, &id);
        const double exact = def->step / longest.substep;
        if (!(exact <= (double)def->melting.max_substeps)) {
            const bool of_speed = longest.reason == RHEO_FAILURE_SUBSTEPS_FOR_SOUND;
            s->refusal = (rheo__refusal){of_speed ? RHEO__FIELD_velocity : RHEO__FIELD_substeps, of_speed ? id : 0,
                                         longest.reason, rheo__ceil(exact), (double)def->melting.max_substeps};
            return RHEO_ERROR_STATE;
        }
        count = (uint64_t)exact;
        count += (double)count < exact;
        count += count == 0;
    }
    *s->substeps = count;
    *s->iterations = 0;
    m->searched = false;
    m->substep = (rheo_real)(def->step / (double)count);
    return RHEO_OK;
}
