/*
 * Measures of scheme summed of the thickening model. Its substeps adapt to the state, and springs that are too stiff
 * for them are softened, so springs make no run unhealthy. Pressure does, where the number of substeps is given or
 * limited; so do impacts that a step cannot resolve, because the list of neighbours is made once a step.
 */
#include <stdio.h>

#include "core/math.h"
#include "world/model_thickening.h"

/* ---- Values ---- */

/* Duration of a substep. False: it is not known. */
static bool substep_of(const rheo__observation *o, double *substep)
{
    double count = 0;
    if (o->begins || !rheo__observed(o, "substeps", &count))
        count = (double)o->def->substeps;
    *substep = o->def->step / count;
    return count > 0;
}

static bool pressure_number(const rheo__observation *o, double *value)
{
    double substep;
    const bool known = substep_of(o, &substep);
    *value = o->def->fluid.stiffness * substep * substep / o->def->fluid.support;
    return known;
}

static bool near_pressure_number(const rheo__observation *o, double *value)
{
    double substep;
    const bool known = substep_of(o, &substep);
    *value = o->def->fluid.near_stiffness * substep * substep / o->def->fluid.support;
    return known;
}

static bool plasticity_number(const rheo__observation *o, double *value)
{
    double substep;
    const bool known = substep_of(o, &substep);
    *value = o->def->springs.plasticity * substep * (1 + o->def->springs.yield_ratio);
    return known && o->def->springs.stiffness > 0;
}

/* How far vibrators move the fluid in a substep, in supports. */
static bool vibrator_speed(const rheo__observation *o, double *value)
{
    const rheo_world_def *def = o->def;
    double substep;
    const bool known = substep_of(o, &substep);
    const double angular = 2 * 3.14159265358979323846 * def->vibrators.frequency,
                 rate = def->vibrators.kind == RHEO_VIBRATOR_FLOOR ? 1 : angular * substep;
    *value = def->vibrators.amplitude * angular * rate * substep / def->fluid.support;
    return known && def->vibrators.count > 0;
}

/* ---- Advice ---- */

/*
 * Advises substeps that bring a number, which is proportional to the square of their duration, down to a target. A
 * given number of them might still be too small for springs.
 */
static void advise_substeps(rheo__case *c, double target)
{
    const rheo_world_def *def = c->def;
    const double number = c->diagnosis->cause.value,
                 needed = rheo__ceil((double)def->max_substeps * __builtin_sqrt(number / target));
    char set[64];
    if (def->substeps) {
        rheo__advise_words(c, "substeps=0", "as many as the state needs");
        rheo__advise_making(c);
        return;
    }
    if (needed <= rheo__parameter_find("max_substeps")->maximum) {
        snprintf(set, sizeof set, "max_substeps=%.0f", needed);
        rheo__advise_words(c, set, "as many as the state needs");
    }
    rheo__advise(c, "step", def->step * __builtin_sqrt(target / number), "shorter substeps");
    rheo__advise_making(c);
}

static void advise_pressure_number(rheo__case *c)
{
    advise_substeps(c, 0.75 * RHEO__STABLE_PRESSURE);
}

static void advise_near_pressure_number(rheo__case *c)
{
    advise_substeps(c, 0.75 * RHEO__STABLE_NEAR_PRESSURE);
}

static void advise_vibrators(rheo__case *c)
{
    rheo__advise(c, "vibrators.amplitude", c->def->vibrators.amplitude * 0.25 / c->diagnosis->cause.value,
                 "moves the fluid by a quarter of a support a substep");
}

static void advise_ball(rheo__case *c)
{
    rheo__advise(c, "step", c->def->step * 0.25 / c->diagnosis->cause.value,
                 "the ball then moves a quarter of a support a step; or let it be slower");
}

/* Advice for a step that moves particles too far. */
static void advise_motion(rheo__case *c)
{
    const rheo_diagnosis *d = c->diagnosis;
    if (d->cause.step <= d->first_step + 1)
        rheo__advise_words(
            c, "", "the particles began too close to each other, or moving apart: leave a spacing between them");
    if (c->def->substeps)
        rheo__advise_words(c, "substeps=0", "as many as the state needs");
    const double moved = rheo__larger(rheo__case_measure(c, "max_spring_displacement"),
                                      rheo__case_measure(c, "max_pressure_displacement")),
                 jump = rheo__case_measure(c, "speed_jump");
    rheo__advise(c, "step", c->def->step * rheo__smaller(rheo__smaller(0.1 / moved, 0.25 / jump), 0.5),
                 "a smaller step, so that particles move less far in one");
}

/* ---- The table ---- */

static const rheo__measure ROWS[] = {
    {.name = "pressure_number",
     .kind = RHEO__CONDITION,
     .limit = RHEO__STABLE_PRESSURE,
     .certain = RHEO__UNSTABLE_PRESSURE,
     .stage = "forces",
     .seen = "max_pressure_displacement",
     .meaning = "fluid.stiffness substep^2 / support",
     .value = pressure_number,
     .advise = advise_pressure_number},
    {.name = "near_pressure_number",
     .kind = RHEO__CONDITION,
     .limit = RHEO__STABLE_NEAR_PRESSURE,
     .certain = RHEO__UNSTABLE_NEAR_PRESSURE,
     .stage = "forces",
     .seen = "max_pressure_displacement",
     .meaning = "fluid.near_stiffness substep^2 / support",
     .value = near_pressure_number,
     .advise = advise_near_pressure_number},
    {.name = "vibrator_speed",
     .kind = RHEO__CONDITION,
     .limit = 0.5,
     .certain = 1,
     .stage = "vibrators",
     .seen = "courant_number",
     .meaning = "how far vibrators move the fluid in a substep, in supports",
     .value = vibrator_speed,
     .advise = advise_vibrators},
    {.name = "ball_speed",
     .kind = RHEO__CONDITION,
     .limit = 0.5,
     .certain = 1,
     .stage = "ball",
     .seen = "courant_number",
     .meaning = "how far the ball moves in a step, in supports",
     .value = rheo__measure_ball_speed,
     .advise = advise_ball},
    {.name = "max_spring_displacement",
     .kind = RHEO__SEVERE,
     .limit = 0.4,
     .stage = "forces",
     .id = "max_spring_displacement_id",
     .meaning = "how far springs moved a particle in a substep, in supports",
     .advise = advise_motion},
    {.name = "max_pressure_displacement",
     .kind = RHEO__SEVERE,
     .limit = 0.4,
     .stage = "forces",
     .id = "max_pressure_displacement_id",
     .meaning = "how far pressure moved a particle in a substep, in supports",
     .advise = advise_motion},
    {.name = "ball_stop",
     .kind = RHEO__SEVERE,
     .limit = 1,
     .stage = "ball",
     .meaning = "speed that the ball lost in a step, in supports per step",
     .value = rheo__measure_ball_stop,
     .advise = advise_ball},
    RHEO__MEASURE_SPEED_JUMP("forces"),
    RHEO__MEASURE_COURANT_NUMBER("forces"),
    {.name = "softened_springs",
     .kind = RHEO__NOTICE,
     .limit = 0,
     .stage = "substeps",
     .id = "stiffness_sum_id",
     .seen = "stiffness_sum",
     .meaning = "number of springs made softer than K, because the step has too few substeps for them"},
    {.name = "plasticity_number",
     .kind = RHEO__NOTICE,
     .limit = 1,
     .stage = "densities",
     .meaning = "springs.plasticity substep (1 + springs.yield_ratio): how far rest lengths flow in a substep",
     .value = plasticity_number},
    {.name = "max_density",
     .kind = RHEO__NOTICE,
     .limit = 2,
     .stage = "densities",
     .id = "max_density_id",
     .meaning = "density of the densest particle, in rest densities"},
    {.name = "energy_jump",
     .kind = RHEO__NOTICE,
     .limit = 0.5,
     .stage = "forces",
     .seen = "courant_number",
     .meaning = "energy gained in a step, as a part of what there was",
     .value = rheo__measure_energy_jump},
};
_Static_assert(sizeof ROWS / sizeof *ROWS <= RHEO_MAX_FINDINGS, "a diagnosis has room for every measure");

const rheo__measures rheo__measures_summed = {ROWS, sizeof ROWS / sizeof *ROWS, advise_motion};
