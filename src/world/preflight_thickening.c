/*
 * What a run of the thickening model is expected to be like (rheolog/scene.h). When a ball of radius R and speed V enters
 * the fluid, neighbours at a distance s move apart with s V/R for about the time R/V, so that their difference of D^q x is
 * about n = s (V/R)^q.
 */
#include "core/math.h"
#include "rheolog/scene.h"
#include "world/model_thickening.h"

static double limit_of(const rheo_world_def *def, const char *measure)
{
    const rheo__measures *measures = rheo__measures_of(def);
    const uint32_t index = rheo__measure_index(measures, measure);
    return index < measures->count ? measures->row[index].limit : __builtin_nan("");
}

/* Largest K of any material for a difference n of D^q x. */
static double stiffness_for(const rheo_world_def *def, double n)
{
    const rheo_material m = rheo__largest_of_materials(def);
    const double onset = def->history.onset;
    return m.springs.stiffness + (n > 0 ? m.history.stiffness * n * n / (n + onset) : 0);
}

static double substeps_for(const rheo_world_def *def, double stiffness, double speed)
{
    const double most = rheo__largest_of_materials(def).springs.stiffness;
    if (def->scheme != RHEO_SCHEME_SUMMED)
        return 1;
    if (def->substeps)
        return (double)def->substeps;
    const double sum = most > 0 ? rheo__stiffness_sum_at_rest(def, 1) * (stiffness / most) : 0;
    return (double)rheo__substeps_for(def, sum, speed * speed);
}

double rheo__thickening_substeps_at_rest(const rheo_world_def *def)
{
    return substeps_for(def, rheo__largest_of_materials(def).springs.stiffness, 0);
}

static void foresee_ball(const rheo_world_def *def, const rheo__start *start, bool history, rheo_preflight *p)
{
    const double *g = def->gravity, radius = def->ball.radius,
                 gravity = __builtin_sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    p->ball_resolution = radius / def->fluid.spacing;
    p->ball_speed = start->ball_speed;
    p->ball_way = p->ball_speed * def->step / def->fluid.support;
    if (def->scheme == RHEO_SCHEME_POSITIONS)
        return;
    /* A ball that is laid on the fluid gets its speed by sinking in. */
    const double speed = rheo__larger(p->ball_speed, __builtin_sqrt(gravity * radius));
    const bool counts = history && !def->history.curve_count;
    p->history_difference =
        counts ? def->fluid.spacing * rheo__pow(speed / radius, def->history.order) : __builtin_nan("");
    const double stiffness = stiffness_for(def, counts ? p->history_difference : 0);
    p->substeps_impact = substeps_for(def, stiffness, speed);
    const double substep = def->step / p->substeps_impact;
    p->kappa_impact = stiffness * substep * substep;
}

void rheo__thickening_foresee(const rheo_world_def *def, const rheo__start *start, rheo_preflight *p)
{
    const bool history = (rheo__world_features(def) & RHEO__FEATURE_HISTORY) != 0;
    const double h = def->fluid.support;
    p->substeps = substeps_for(def, rheo__largest_of_materials(def).springs.stiffness, start->speed);
    p->substep = def->step / p->substeps;
    if (def->scheme != RHEO_SCHEME_POSITIONS) {
        const double square = p->substep * p->substep;
        p->kappa = rheo__largest_of_materials(def).springs.stiffness * square;
        p->pressure_number = def->fluid.stiffness * square / h;
        p->near_pressure_number = def->fluid.near_stiffness * square / h;
        p->pressure_limit = limit_of(def, "pressure_number");
        p->near_pressure_limit = limit_of(def, "near_pressure_number");
    }
    if (def->scheme == RHEO_SCHEME_SEQUENTIAL && def->springs.solver == RHEO_SOLVER_EXPLICIT)
        p->kappa_limit = limit_of(def, "stiffness_number");
    if (history && def->history.kind != RHEO_HISTORY_FULL) {
        p->memory_steps = def->history.window_seconds > 0
                              ? rheo__larger(1, (double)(uint64_t)(def->history.window_seconds / def->step + 0.5))
                              : (double)def->history.window;
        if (def->history.curve_count)
            p->memory_steps = rheo_history_curve_window(def->history.curve, def->history.curve_count, def->step);
        p->memory_seconds = p->memory_steps * def->step;
    }
    if (def->ball.radius > 0)
        foresee_ball(def, start, history, p);
}
