/*
 * Measures of the melting model. A substep that is too long for sound, explicit viscosity or heat is a condition: it
 * is the cause wherever the error shows first. Errors of density and speeds near that of sound are precursors: the
 * fluid is too soft for its load.
 */
#include <stdio.h>

#include "core/math.h"
#include "melting/rheology.h"
#include "world/model_melting.h"

/* ---- Values ---- */

/* Duration of a substep. False: it is not known. */
static bool substep_of(const rheo__observation *o, double *substep)
{
    double count = 0;
    if (o->begins || o->unfinished || !rheo__observed(o, "substeps", &count))
        count = (double)o->def->melting.substeps;
    *substep = o->def->step / count;
    return count > 0;
}

static bool flows(const rheo__observation *o)
{
    return o->def->melting.flow == RHEO_FLOW_ON;
}

static bool substep_courant_number(const rheo__observation *o, double *value)
{
    double substep, speed;
    if (!flows(o) || !rheo__observed(o, "max_speed", &speed))
        return false;
    if (o->unfinished &&
        !o->def->melting.substeps) { /* the step chose its substeps by this number, or smaller ones */
        *value = o->def->melting.courant_number;
        return true;
    }
    if (!substep_of(o, &substep))
        return false;
    *value = substep * (o->def->melting.sound_speed + speed) / rheo__melting_smoothing_length(o->def);
    return true;
}

/* The largest apparent viscosity that a particle can have. */
static double largest_viscosity(const rheo__observation *o)
{
    const rheo_world_def *def = o->def;
    const double jump = o->features & RHEO__FEATURE_TEMPERATURE
                            ? rheo__larger(def->melting.jump_number_min, def->melting.jump_number_max)
                            : rheo__melting_jump(def, def->melting.temperature);
    return rheo__melting_max_viscosity(def, jump);
}

static bool viscous_number(const rheo__observation *o, double *value)
{
    const rheo_world_def *def = o->def;
    const double h = rheo__melting_smoothing_length(def);
    /* Largest stable substep in rho0 h^2 / eta, measured: docs/debugging.md. */
    const double stable = def->melting.stress == RHEO_STRESS_NESTED ? 0.4 : 0.16;
    double substep;
    if (!flows(o) || def->melting.solver == RHEO_VISCOSITY_IMPLICIT || !substep_of(o, &substep))
        return false;
    *value = substep * largest_viscosity(o) / (def->melting.rest_density * h * h * stable);
    return true;
}

static bool heat_number(const rheo__observation *o, double *value)
{
    const double h = rheo__melting_smoothing_length(o->def);
    double substep;
    if (!(o->features & RHEO__FEATURE_HEAT) || !substep_of(o, &substep))
        return false;
    *value = substep * o->def->melting.diffusivity / (h * h);
    return true;
}

/* A first state has made no substeps: it is not ill because those that follow are too long. */
static bool heat_growth(const rheo__observation *o, double *value)
{
    return !o->begins && heat_number(o, value);
}

static bool mach_number(const rheo__observation *o, double *value)
{
    double speed;
    if (!rheo__observed(o, "max_speed", &speed))
        return false;
    *value = speed / o->def->melting.sound_speed;
    return true;
}

static bool speed_rise(const rheo__observation *o, double *value)
{
    double rise;
    if (!rheo__observed_speed_rise(o, &rise))
        return false;
    *value = rise / o->def->melting.sound_speed;
    return true;
}

static bool solver_share(const rheo__observation *o, double *value)
{
    double iterations, substeps;
    if (o->unfinished || !rheo__observed(o, "iterations", &iterations) || !rheo__observed(o, "substeps", &substeps) ||
        !(substeps > 0))
        return false;
    *value = iterations / substeps / (double)o->def->melting.max_iterations;
    return true;
}

/* ---- Advice ---- */

/* Advises as many substeps as a step requires, or a shorter step if it may not have as many. */
static void advise_more_substeps(rheo__case *c, double required)
{
    const rheo_world_def *def = c->def;
    const double needed = rheo__ceil(required * 1.25);
    char set[64];
    if (!(needed > 0))
        return;
    if (needed <= rheo__parameter_find("melting.max_substeps")->maximum) {
        snprintf(set, sizeof set, "melting.max_substeps=%.0f", needed);
        rheo__advise_words(c, set, "takes the time that the step asks for");
    } else {
        rheo__advise(c, "step", def->step * (double)def->melting.max_substeps / needed,
                     "no more substeps than it may have");
    }
}

/* Advises substeps that bring a number, which is proportional to their duration, down to a target. */
static void advise_substeps(rheo__case *c, double number, double target)
{
    const rheo_world_def *def = c->def;
    char set[64];
    if (!def->melting.substeps && rheo__case_metric(c, "substeps") >= (double)def->melting.max_substeps) {
        advise_more_substeps(c, (double)def->melting.max_substeps * number /
                                    rheo__smaller(target, def->melting.courant_number));
        return;
    }
    if (!def->melting.substeps) {
        rheo__advise(c, "melting.courant_number", def->melting.courant_number * rheo__smaller(target / number, 0.5),
                     "shorter substeps");
        return;
    }
    rheo__advise_words(c, "melting.substeps=0", "as many substeps as the state asks for");
    const double substeps = rheo__ceil((double)def->melting.substeps * rheo__larger(number / target, 2));
    if (!(substeps <= 1e9))
        return;
    snprintf(set, sizeof set, "melting.substeps=%.0f", substeps);
    rheo__advise_words(c, set, "shorter substeps");
}

static void advise_sound_number(rheo__case *c)
{
    advise_substeps(c, c->diagnosis->cause.value, 1);
}

static void advise_viscous_number(rheo__case *c)
{
    rheo__advise_words(c, "melting.solver=implicit", "bears any viscosity");
    advise_substeps(c, c->diagnosis->cause.value, 0.8);
}

static void advise_heat_number(rheo__case *c)
{
    advise_substeps(c, c->diagnosis->cause.value, 0.1);
}

/*
 * Advice for fluid that is compressed or moves nearly as fast as sound: errors of density are proportional to 1/c^2.
 */
static void advise_sound_speed(rheo__case *c)
{
    const double sound = c->def->melting.sound_speed, target = 0.02,
                 error = rheo__larger(rheo__case_metric(c, "density_error"), 4 * target);
    rheo__advise(c, "melting.sound_speed",
                 rheo__larger(10 * rheo__case_metric(c, "max_speed"), sound * __builtin_sqrt(error / target)),
                 "stiffer against pressure; ten times what anything moves at is usual. Substeps are as many more");
    rheo__advise_making(c); /* densities of a first state follow from the speed of sound */
}

/* Advice for a step that needs more substeps than are allowed, and for any failure that no measure announced. */
static void advise_failure(rheo__case *c)
{
    const rheo_failure *f = &c->diagnosis->failure;
    if (f->reason == RHEO_FAILURE_SUBSTEPS_FOR_VISCOSITY)
        rheo__advise_words(c, "melting.solver=implicit", "bears any viscosity with the substeps that sound asks for");
    if (f->reason == RHEO_FAILURE_SUBSTEPS_FOR_PRINTED_VISCOSITY)
        rheo__advise_words(c, "paper.courant=off", "bears any viscosity, if it is solved implicitly");
    if (f->limit > 0)
        advise_more_substeps(c, f->required);
    else
        advise_substeps(c, 2, 1);
}

/* ---- The table ---- */

static const rheo__measure ROWS[] = {
    {.name = "substep_courant_number",
     .kind = RHEO__CONDITION,
     .limit = 2,
     .certain = 2.35,
     .stage = "integration",
     .seen = "max_density_error",
     .meaning = "substep (melting.sound_speed + max_speed) / smoothing length",
     .value = substep_courant_number,
     .advise = advise_sound_number},
    {.name = "viscous_number",
     .kind = RHEO__CONDITION,
     .limit = 1,
     .certain = 1.3,
     .stage = "viscosity",
     .seen = "max_density_error",
     .meaning = "substep of the explicit solver, in those that the largest viscosity allows",
     .value = viscous_number,
     .advise = advise_viscous_number},
    {.name = "heat_number",
     .kind = RHEO__CONDITION,
     .limit = 0.4,
     .certain = 0.5,
     .stage = "integration",
     .seen = "max_density_error",
     .meaning = "substep melting.diffusivity / smoothing length^2",
     .value = heat_number,
     .advise = advise_heat_number},
    {.name = "heat_growth",
     .kind = RHEO__SEVERE,
     .limit = 0.5,
     .stage = "integration",
     .meaning =
         "the same; beyond its limit differences of temperature grow in every substep, and no other measure shows it",
     .value = heat_growth,
     .advise = advise_heat_number},
    {.name = "mach_number",
     .kind = RHEO__PRECURSOR,
     .limit = 0.3,
     .stage = "momentum",
     .id = "max_speed_id",
     .meaning = "largest speed, in melting.sound_speed",
     .value = mach_number,
     .advise = advise_sound_speed},
    {.name = "max_density_error",
     .kind = RHEO__PRECURSOR,
     .limit = 0.2,
     .stage = "integration",
     .id = "max_density_id",
     .meaning = "how far a particle's density is from that at rest, in rest densities",
     .advise = advise_sound_speed},
    {.name = "density_error",
     .kind = RHEO__SEVERE,
     .limit = 0.2,
     .stage = "integration",
     .seen = "max_density_error",
     .meaning = "the same, mean over the particles",
     .advise = advise_sound_speed},
    {.name = "speed_rise",
     .kind = RHEO__SEVERE,
     .limit = 0.5,
     .stage = "momentum",
     .id = "max_speed_id",
     .meaning = "rise of the largest speed in a step, in melting.sound_speed",
     .value = speed_rise},
    {.name = "energy_jump",
     .kind = RHEO__SEVERE,
     .limit = 0.5,
     .stage = "momentum",
     .seen = "mach_number",
     .meaning = "energy gained in a step, as a part of what there was"},
    {.name = "solver_share",
     .kind = RHEO__NOTICE,
     .limit = 0.99,
     .stage = "viscosity",
     .meaning = "mean iterations of the solver of viscosity in a substep, in melting.max_iterations",
     .value = solver_share},
};
_Static_assert(sizeof ROWS / sizeof *ROWS <= RHEO_MAX_FINDINGS, "a diagnosis has room for every measure");

static const rheo__measures MEASURES = {ROWS, sizeof ROWS / sizeof *ROWS, advise_failure};

const rheo__measures *rheo__measures_melting(const rheo_world_def *def)
{
    (void)def;
    return &MEASURES;
}
