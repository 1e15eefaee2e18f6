/*
 * Measures of scheme sequential of the thickening model. A stage that moves a particle by half a support or more in
 * one step throws it past its neighbours: no run that was observed recovered from that unharmed, and no healthy run
 * did it. A spring that is too stiff for the step does no harm while it is not stretched, so stiffness is a precursor
 * only. Where pressure is too stiff for the step, springs tear first; hence its numbers are conditions.
 */
#include <stdio.h>
#include <string.h>

#include "world/model_thickening.h"

/* ---- Values ---- */

static double per_step(const rheo_world_def *def)
{
    return def->step / def->fluid.support;
}

static bool pressure_number(const rheo__observation *o, double *value)
{
    *value = o->def->fluid.stiffness * o->def->step * per_step(o->def);
    return true;
}

static bool near_pressure_number(const rheo__observation *o, double *value)
{
    *value = o->def->fluid.near_stiffness * o->def->step * per_step(o->def);
    return true;
}

static bool plasticity_number(const rheo__observation *o, double *value)
{
    *value = o->def->springs.plasticity * o->def->step * (1 + o->def->springs.yield_ratio);
    return o->def->springs.stiffness > 0;
}

/* The second limit of near_pressure_number. */
static const double UNSTABLE_NEAR_PRESSURE = 0.44;

static bool start_speed(const rheo__observation *o, double *value)
{
    double pressure, near;
    pressure_number(o, &pressure);
    near_pressure_number(o, &near);
    return o->begins && (pressure > RHEO__SEQUENTIAL_UNSTABLE_PRESSURE || near > UNSTABLE_NEAR_PRESSURE) &&
           rheo__observed(o, "courant_number", value);
}

bool rheo__measure_vibrator_step(const rheo__observation *o, double *value)
{
    const rheo_world_def *def = o->def;
    const double a = def->vibrators.amplitude, angular = 2 * 3.14159265358979323846 * def->vibrators.frequency,
                 step = def->step;
    const double length =
        def->vibrators.kind == RHEO_VIBRATOR_FLOOR ? a * angular * step : a * angular * angular * step * step;
    *value = length / def->fluid.support;
    return def->vibrators.count > 0;
}

/* A metric of a ball. */
static bool ball_observed(const rheo__observation *o, uint32_t index, const char *metric, double *value)
{
    char name[32];
    snprintf(name, sizeof name, "%s_%s", RHEO__BALL_NAME(index), metric);
    return rheo__observed(o, name, value);
}

/* Speed of a ball after the step, in supports per step. */
static bool last_ball_speed(const rheo__observation *o, uint32_t index, double *value)
{
    double x, y, z;
    if (!ball_observed(o, index, "vx", &x) || !ball_observed(o, index, "vy", &y) ||
        !ball_observed(o, index, "vz", &z))
        return false;
    *value = __builtin_sqrt(x * x + y * y + z * z) * per_step(o->def);
    return true;
}

/* Before the first step, and in older recordings, the speed after the step is all that is known. Of the fastest ball. */
bool rheo__measure_ball_speed(const rheo__observation *o, double *value)
{
    bool any = false;
    for (uint32_t i = 0; i <= o->def->balls.count; i++) {
        double fastest, speed;
        if (!last_ball_speed(o, i, &speed))
            continue;
        if (ball_observed(o, i, "max_speed", &fastest))
            speed = rheo__larger(fastest * per_step(o->def), speed);
        *value = any ? rheo__larger(speed, *value) : speed;
        any = true;
    }
    return any;
}

bool rheo__measure_ball_stop(const rheo__observation *o, double *value)
{
    bool any = false;
    for (uint32_t i = 0; i <= o->def->balls.count && !o->unfinished; i++) {
        double fastest, last;
        if (!ball_observed(o, i, "max_speed", &fastest) || !last_ball_speed(o, i, &last))
            continue;
        const double lost = fastest * per_step(o->def) - last;
        *value = any ? rheo__larger(lost, *value) : lost;
        any = true;
    }
    return any;
}

/* Implicit springs bear any stiffness. */
static bool stiffness_number(const rheo__observation *o, double *value)
{
    return o->def->springs.solver == RHEO_SOLVER_EXPLICIT && rheo__observed(o, "stiffness_number", value);
}

static bool stiffness_sum(const rheo__observation *o, double *value)
{
    return o->def->springs.solver == RHEO_SOLVER_EXPLICIT && rheo__observed(o, "stiffness_sum", value);
}

/* Below a Courant number of 0.1 the kinetic energy is too small for its changes to mean anything. */
bool rheo__measure_energy_jump(const rheo__observation *o, double *value)
{
    double courant_number;
    return o->def->vibrators.count == 0 && o->def->obstacles.count == 0 &&
           rheo__observed(o, "courant_number", &courant_number) && !(courant_number < 0.1) &&
           rheo__observed(o, "energy_jump", value);
}

/* ---- Advice ---- */

/* Limits of stiffness_number, of stiffness_sum, and of both displacements. */
static const double KAPPA = 2.4, KAPPA_SUM = 45, DISPLACEMENT = 0.5;

static double largest_displacement(const rheo__case *c)
{
    return rheo__larger(rheo__case_measure(c, "max_spring_displacement"),
                        rheo__case_measure(c, "max_pressure_displacement"));
}

/* Pressure numbers of the default parameters, which leave room for the springs. */
static const double SAFE_PRESSURE = 0.08, SAFE_NEAR_PRESSURE = 0.135;

/* Advises a step that both pressures bear, and a stiffness if only this one is too large. */
static void advise_pressures(rheo__case *c, const char *path, double number, double safe, double other,
                             double other_safe)
{
    const double step = c->def->step, share = rheo__smaller(safe / number, other_safe / other);
    rheo__advise(c, "step", step * __builtin_sqrt(share),
                 "brings both pressure numbers down to those of the defaults");
    if (other <= 2 * other_safe)
        rheo__advise(c, path, safe * c->def->fluid.support / (step * step),
                     "brings its pressure number down the same");
    rheo__advise_making(c);
}

static double number_of(const rheo__case *c, double stiffness)
{
    return stiffness * c->def->step * per_step(c->def);
}

static void advise_pressure_number(rheo__case *c)
{
    const rheo_world_def *def = c->def;
    advise_pressures(c, "fluid.stiffness", number_of(c, def->fluid.stiffness), SAFE_PRESSURE,
                     number_of(c, def->fluid.near_stiffness), SAFE_NEAR_PRESSURE);
}

static void advise_near_pressure_number(rheo__case *c)
{
    const rheo_world_def *def = c->def;
    advise_pressures(c, "fluid.near_stiffness", number_of(c, def->fluid.near_stiffness), SAFE_NEAR_PRESSURE,
                     number_of(c, def->fluid.stiffness), SAFE_PRESSURE);
}

static void advise_plasticity(rheo__case *c)
{
    const double step = c->def->step;
    rheo__advise(c, "springs.plasticity", 1 / (step * (1 + c->def->springs.yield_ratio)),
                 "rest lengths no longer overshoot");
    rheo__advise(c, "step", step / c->diagnosis->cause.value, "the same");
    rheo__advise_making(c);
}

static void advise_vibrators(rheo__case *c)
{
    rheo__advise(c, "vibrators.amplitude", c->def->vibrators.amplitude * 0.1 / c->diagnosis->cause.value,
                 "moves the fluid by a tenth of a support a step");
}

static void advise_ball(rheo__case *c)
{
    rheo__advise(c, "step", c->def->step * 0.5 / c->diagnosis->cause.value,
                 "the ball then moves half a support a step; or let it be slower");
}

/* Whether a measure was more than twice its limit when it first left its range. */
static bool jumped(const rheo_diagnosis *d, const char *measure)
{
    for (uint32_t i = 0; i < d->finding_count; i++)
        if (strcmp(d->findings[i].measure, measure) == 0)
            return d->findings[i].value > 2 * d->findings[i].limit;
    return false;
}

/*
 * A run breaks before an impact reaches its largest stiffness, so the measured value is too small. Half of the
 * stiffness at which a pair at rest is stable is a safe target.
 */
static void advise_springs(rheo__case *c)
{
    const rheo_world_def *def = c->def;
    const double target = 0.5, kappa = rheo__larger(rheo__case_measure(c, "stiffness_number"), 2 * target),
                 least = def->springs.stiffness * def->step * def->step;
    /* Springs that are not too stiff for the step, or not they alone: the fluid moves too far in it. */
    const bool stiff =
        rheo__case_measure(c, "stiffness_number") > KAPPA || rheo__case_measure(c, "stiffness_sum") > KAPPA_SUM;
    if (def->springs.solver == RHEO_SOLVER_IMPLICIT || !stiff ||
        rheo__case_measure(c, "max_pressure_displacement") > DISPLACEMENT) {
        rheo__advise(c, "step", def->step * rheo__smaller(0.25 / largest_displacement(c), 0.5),
                     "a smaller step, so that the fluid moves less far in one");
        return;
    }
    rheo__advise_words(c, "springs.solver=implicit", "bears any stiffness; springs act more softly within a step");
    /* It broke while the fluid hardly moved: no number is known for the motion that would follow. */
    if (jumped(c->diagnosis, "stiffness_number"))
        return;
    rheo__advise(c, "step", def->step * __builtin_sqrt(target / kappa), "brings kappa down to 0.5, by step^2");
    if (least < target)
        rheo__advise(c, "history.stiffness", def->history.stiffness * (target - least) / (kappa - least),
                     "brings kappa down to 0.5, if the fluid moves as it did");
    else
        rheo__advise(c, "springs.stiffness", target / (def->step * def->step),
                     "brings kappa of springs at rest down to 0.5");
}

static void advise_pressure(rheo__case *c)
{
    const rheo_diagnosis *d = c->diagnosis;
    const double displacement = largest_displacement(c);
    if (d->cause.step <= d->first_step + 1)
        rheo__advise_words(
            c, "", "the particles began too close to each other, or moving apart: leave a spacing between them");
    if (displacement > 0)
        rheo__advise(c, "step", c->def->step * rheo__smaller(0.25 / displacement, 0.5),
                     "a smaller step, so that particles enter each other less");
}

/* ---- The table ---- */

static const rheo__measure ROWS[] = {
    {.name = "pressure_number",
     .kind = RHEO__CONDITION,
     .limit = RHEO__SEQUENTIAL_STABLE_PRESSURE,
     .certain = RHEO__SEQUENTIAL_UNSTABLE_PRESSURE,
     .stage = "density",
     .seen = "max_pressure_displacement",
     .meaning = "fluid.stiffness step^2 / support",
     .value = pressure_number,
     .advise = advise_pressure_number},
    {.name = "near_pressure_number",
     .kind = RHEO__CONDITION,
     .limit = 0.4,
     .certain = UNSTABLE_NEAR_PRESSURE,
     .stage = "density",
     .seen = "max_pressure_displacement",
     .meaning = "fluid.near_stiffness step^2 / support",
     .value = near_pressure_number,
     .advise = advise_near_pressure_number},
    {.name = "plasticity_number",
     .kind = RHEO__CONDITION,
     .limit = 1,
     .certain = 1.9,
     .stage = "springs",
     .seen = "stiffness_number",
     .meaning = "springs.plasticity step (1 + springs.yield_ratio): how far rest lengths flow in a step",
     .value = plasticity_number,
     .advise = advise_plasticity},
    {.name = "vibrator_speed",
     .kind = RHEO__CONDITION,
     .limit = 0.5,
     .certain = 1,
     .stage = "vibrators",
     .seen = "courant_number",
     .meaning = "how far vibrators move the fluid in a step, in supports",
     .value = rheo__measure_vibrator_step,
     .advise = advise_vibrators},
    {.name = "ball_speed",
     .kind = RHEO__CONDITION,
     .limit = 0.5,
     .certain = 0.75,
     .stage = "ball",
     .seen = "courant_number",
     .meaning = "how far the ball moves in a step, in supports",
     .value = rheo__measure_ball_speed,
     .advise = advise_ball},
    {.name = "stiffness_number",
     .kind = RHEO__PRECURSOR,
     .limit = 2.4,
     .stage = "spring_displacement",
     .id = "stiffness_a",
     .other_id = "stiffness_b",
     .meaning = "kappa of the stiffest spring, step^2 (k_min + k_hist |D^q|)",
     .value = stiffness_number,
     .advise = advise_springs},
    {.name = "stiffness_sum",
     .kind = RHEO__PRECURSOR,
     .limit = 45,
     .stage = "spring_displacement",
     .id = "stiffness_sum_id",
     .meaning = "sum of kappa over the springs of a particle",
     .value = stiffness_sum,
     .advise = advise_springs},
    {.name = "max_spring_displacement",
     .kind = RHEO__SEVERE,
     .limit = 0.5,
     .stage = "spring_displacement",
     .id = "max_spring_displacement_id",
     .meaning = "how far springs moved a particle in a step, in supports",
     .advise = advise_springs},
    {.name = "max_pressure_displacement",
     .kind = RHEO__SEVERE,
     .limit = 0.5,
     .stage = "density",
     .id = "max_pressure_displacement_id",
     .meaning = "how far pressure moved a particle in a step, in supports",
     .advise = advise_pressure},
    {.name = "ball_stop",
     .kind = RHEO__SEVERE,
     .limit = 0.75,
     .stage = "ball",
     .meaning = "speed that the ball lost in a step, in supports per step",
     .value = rheo__measure_ball_stop,
     .advise = advise_ball},
    RHEO__MEASURE_SPEED_JUMP("velocity"),
    RHEO__MEASURE_RUNAWAY_SPEED("velocity"),
    RHEO__MEASURE_START_SPEED("velocity"),
    RHEO__MEASURE_COURANT_NUMBER("velocity"),
    {.name = "max_density",
     .kind = RHEO__NOTICE,
     .limit = 2,
     .stage = "density",
     .id = "max_density_id",
     .meaning = "density of the densest particle, in rest densities"},
    {.name = "energy_jump",
     .kind = RHEO__NOTICE,
     .limit = 2,
     .stage = "velocity",
     .seen = "courant_number",
     .meaning = "energy gained in a step, as a part of what there was",
     .value = rheo__measure_energy_jump},
};
_Static_assert(sizeof ROWS / sizeof *ROWS <= RHEO_MAX_FINDINGS, "a diagnosis has room for every measure");

const rheo__measures rheo__measures_sequential = {ROWS, sizeof ROWS / sizeof *ROWS, rheo__advise_half_step};
