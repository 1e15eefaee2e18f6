/*
 * Measures of scheme summed of the thickening model. Its substeps adapt to the state, and springs that are too stiff
 * for them are softened, so springs make no run unhealthy. Pressure does, where the number of substeps is given or
 * limited; so do impacts that a step cannot resolve, because the list of neighbours is made once a step.
 */
#include <stdio.h>

#include "core/math.h"
#include "world/model_thickening.h"

/* ---- Values ---- */

/* Duration of a substep. Of a first state, which made none, the shortest that the definition allows. */
static double substep_of(const rheo__observation *o)
{
    double count;
    if (o->begins || !rheo__observed(o, "substeps", &count) || !(count > 0))
        count = (double)(o->def->substeps ? o->def->substeps : o->def->max_substeps);
    return o->def->step / count;
}

static bool pressure_number(const rheo__observation *o, double *value)
{
    const double substep = substep_of(o);
    *value = o->def->fluid.stiffness * substep * substep / o->def->fluid.support;
    return true;
}

static bool near_pressure_number(const rheo__observation *o, double *value)
{
    const double substep = substep_of(o);
    *value = o->def->fluid.near_stiffness * substep * substep / o->def->fluid.support;
    return true;
}

static bool plasticity_number(const rheo__observation *o, double *value)
{
    const rheo_world_def *def = o->def;
    *value = 0;
    for (uint32_t a = 0; a <= def->materials.count; a++)
        for (uint32_t b = a; b <= def->materials.count; b++) { /* a spring has the means of its ends */
            const rheo_material m = rheo__material_of(def, a), n = rheo__material_of(def, b);
            const double rate = (m.springs.plasticity + n.springs.plasticity) / 2,
                         yield = (m.springs.yield_ratio + n.springs.yield_ratio) / 2;
            const double number = rate * substep_of(o) * (1 + yield);
            *value = number > *value ? number : *value;
        }
    return rheo__largest_of_materials(def).springs.stiffness > 0;
}

static bool start_speed(const rheo__observation *o, double *value)
{
    double pressure, near;
    pressure_number(o, &pressure);
    near_pressure_number(o, &near);
    return o->begins && (pressure > RHEO__UNSTABLE_PRESSURE || near > RHEO__UNSTABLE_NEAR_PRESSURE) &&
           rheo__observed(o, "courant_number", value);
}

/* How far vibrators move the fluid in a substep, in supports. */
static bool vibrator_speed(const rheo__observation *o, double *value)
{
    const rheo_world_def *def = o->def;
    const double substep = substep_of(o), angular = 2 * 3.14159265358979323846 * def->vibrators.frequency,
                 rate = def->vibrators.kind == RHEO_VIBRATOR_FLOOR ? 1 : angular * substep;
    *value = def->vibrators.amplitude * angular * rate * substep / def->fluid.support;
    return def->vibrators.count > 0;
}

/* How far a plate with a given velocity moves in a step, in supports, at most. */
static bool plate_speed(const rheo__observation *o, double *value)
{
    const rheo_world_def *def = o->def;
    *value = rheo__thickening_plate_speed(def) * def->step / def->fluid.support;
    return rheo__thickening_has_plates(def) && def->plates.control == RHEO_PLATES_VELOCITY;
}

/* ---- Advice ---- */

/* A pressure, for advice. */
typedef struct pressure {
    const char *path;
    double stiffness;
    double target; /* its number with substeps that are short enough */
    double most;   /* its number with one substep, up to which substeps help: neighbours are listed once a step */
} pressure;

static pressure pressure_of(const rheo_world_def *def)
{
    return (pressure){"fluid.stiffness", def->fluid.stiffness, 0.75 * RHEO__STABLE_PRESSURE, 2};
}

static pressure near_pressure_of(const rheo_world_def *def)
{
    return (pressure){"fluid.near_stiffness", def->fluid.near_stiffness, 0.75 * RHEO__STABLE_NEAR_PRESSURE, 40};
}

/* Its number with one substep. */
static double whole_number(const rheo_world_def *def, const pressure *p)
{
    return p->stiffness * def->step * def->step / def->fluid.support;
}

/* The largest of these that this many substeps help. */
static double most_with(const pressure *p, double substeps)
{
    return rheo__smaller(p->target * substeps * substeps, p->most);
}

/* The part of the step that both pressures bear with this many substeps; 1 at most. */
static double bearable_step(const rheo_world_def *def, double substeps)
{
    const pressure both[2] = {pressure_of(def), near_pressure_of(def)};
    double part = 1;
    for (int i = 0; i < 2; i++)
        part = rheo__smaller(part, __builtin_sqrt(most_with(&both[i], substeps) / whole_number(def, &both[i])));
    return part;
}

/* Advises a stiffness that substeps help, if they do not help this one, and the other is not too large as well. */
static void advise_softer(rheo__case *c, const pressure *p, const pressure *other, double substeps)
{
    const rheo_world_def *def = c->def;
    if (whole_number(def, p) > p->most && whole_number(def, other) <= most_with(other, substeps))
        rheo__advise(c, p->path, most_with(p, substeps) * def->fluid.support / (def->step * def->step),
                     "soft enough for the step");
}

/* Advises enough substeps, or where they do not help, a shorter step or a softer fluid. */
static void advise_substeps(rheo__case *c, pressure p, pressure other)
{
    const rheo_world_def *def = c->def;
    const double substeps = (double)(def->substeps ? def->substeps : def->max_substeps),
                 whole = whole_number(def, &p), needed = rheo__ceil(__builtin_sqrt(whole / p.target));
    char set[64];
    if (def->substeps && whole <= most_with(&p, (double)def->max_substeps)) {
        rheo__advise_words(c, "substeps=0", "as many as the state needs"); /* springs might need more than pressure */
        rheo__advise_making(c);
        return;
    }
    if (!def->substeps && whole <= p.most && needed <= rheo__parameter_find("max_substeps")->maximum) {
        snprintf(set, sizeof set, "max_substeps=%.0f", needed);
        rheo__advise_words(c, set, "as many as the state needs");
    }
    rheo__advise(c, "step", def->step * bearable_step(def, substeps), "shorter substeps");
    advise_softer(c, &p, &other, substeps);
    rheo__advise_making(c);
}

static void advise_pressure_number(rheo__case *c)
{
    advise_substeps(c, pressure_of(c->def), near_pressure_of(c->def));
}

static void advise_near_pressure_number(rheo__case *c)
{
    advise_substeps(c, near_pressure_of(c->def), pressure_of(c->def));
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

static void advise_plates(rheo__case *c)
{
    rheo__advise(c, "step", c->def->step * 0.25 / c->diagnosis->cause.value,
                 "the plate then moves a quarter of a support a step; or let it be slower");
}

/* Advice for a step that moves particles too far. */
static void advise_motion(rheo__case *c)
{
    const rheo_diagnosis *d = c->diagnosis;
    if (d->cause.step <= d->first_step + 1)
        rheo__advise_words(
            c, "", "the particles began too close to each other, or moving apart: leave a spacing between them");
    if (c->def->substeps && c->def->substeps < c->def->max_substeps)
        rheo__advise_words(c, "substeps=0", "as many as the state needs");
    const double moved = rheo__larger(rheo__case_measure(c, "max_spring_displacement"),
                                      rheo__case_measure(c, "max_pressure_displacement")),
                 jump = rheo__case_measure(c, "speed_jump");
    const double part =
        rheo__smaller(rheo__smaller(0.1 / moved, 0.25 / jump), bearable_step(c->def, (double)c->def->max_substeps));
    rheo__advise(c, "step", c->def->step * rheo__smaller(part, 0.5),
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
    {.name = "plate_speed",
     .kind = RHEO__CONDITION,
     .limit = 0.5,
     .certain = 1,
     .stage = "plates",
     .seen = "courant_number",
     .meaning = "how far the upper plate moves in a step, in supports",
     .value = plate_speed,
     .advise = advise_plates},
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
    RHEO__MEASURE_RUNAWAY_SPEED("forces"),
    RHEO__MEASURE_START_SPEED("forces"),
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
