/* What a run of the melting model is expected to be like (rheolog/scene.h). */
#include "core/math.h"
#include "melting/melting.h"
#include "melting/rheology.h"
#include "rheolog/scene.h"
#include "world/model_melting.h"

void rheo__melting_foresee(const rheo_world_def *def, const rheo__start *start, rheo_preflight *p)
{
    const bool own = start->has_temperatures;
    const double cold = rheo__melting_jump(def, own ? start->coldest : def->melting.temperature),
                 hot = rheo__melting_jump(def, own ? start->hottest : def->melting.temperature);
    p->jump_least = rheo__smaller(cold, hot);
    p->jump_most = rheo__larger(cold, hot);
    p->sound_speed = def->melting.flow == RHEO_FLOW_ON ? def->melting.sound_speed : __builtin_nan("");
    p->solver = def->melting.solver == RHEO_VISCOSITY_IMPLICIT ? "implicit" : "explicit";
    rheo_failure_reason reason;
    const double longest =
        rheo__melting_longest_substep(def, start->speed, rheo__melting_max_viscosity(def, p->jump_most),
                                      own && def->melting.diffusivity > 0, &reason);
    p->substeps =
        def->melting.substeps ? (double)def->melting.substeps : rheo__larger(1, rheo__ceil(def->step / longest));
    p->substep = def->step / p->substeps;
}
