/*
 * Measures of scheme positions of the thickening model. It has no springs, and its pressure follows from a constraint
 * that is stable at any step. What is left are motions that a step cannot resolve, because the list of neighbours is
 * made once a step.
 */
#include "world/model_thickening.h"

static void advise_vibrators(rheo__case *c)
{
    rheo__advise(c, "vibrators.amplitude", c->def->vibrators.amplitude * 0.1 / c->diagnosis->cause.value,
                 "moves the fluid by a tenth of a support a step");
}

static void advise_ball(rheo__case *c)
{
    rheo__advise(c, "step", c->def->step * 0.25 / c->diagnosis->cause.value,
                 "the ball then moves a quarter of a support a step; or let it be slower");
}

/* Advice for a step in which the constraint moves particles too far: they began, or came, too close to each other. */
static void advise_constraint(rheo__case *c)
{
    const rheo_diagnosis *d = c->diagnosis;
    if (d->cause.step <= d->first_step + 1)
        rheo__advise_words(c, "", "the particles began too close to each other: leave a spacing between them");
    rheo__advise_half_step(c);
}

static const rheo__measure ROWS[] = {
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
     .certain = 1,
     .stage = "ball",
     .seen = "courant_number",
     .meaning = "how far the ball moves in a step, in supports",
     .value = rheo__measure_ball_speed,
     .advise = advise_ball},
    {.name = "max_pressure_displacement",
     .kind = RHEO__SEVERE,
     .limit = 0.5,
     .stage = "density_constraint",
     .id = "max_pressure_displacement_id",
     .meaning = "how far the density constraint moved a particle in a step, in supports",
     .advise = advise_constraint},
    {.name = "ball_stop",
     .kind = RHEO__SEVERE,
     .limit = 1,
     .stage = "ball",
     .meaning = "speed that the ball lost in a step, in supports per step",
     .value = rheo__measure_ball_stop,
     .advise = advise_ball},
    RHEO__MEASURE_SPEED_JUMP("density_constraint"),
    RHEO__MEASURE_RUNAWAY_SPEED("density_constraint"),
    RHEO__MEASURE_COURANT_NUMBER("density_constraint"),
    {.name = "max_density",
     .kind = RHEO__NOTICE,
     .limit = 2,
     .stage = "density_constraint",
     .id = "max_density_id",
     .meaning = "density of the densest particle, in rest densities"},
    {.name = "energy_jump",
     .kind = RHEO__NOTICE,
     .limit = 0.5,
     .stage = "density_constraint",
     .seen = "courant_number",
     .meaning = "energy gained in a step, as a part of what there was",
     .value = rheo__measure_energy_jump},
};
_Static_assert(sizeof ROWS / sizeof *ROWS <= RHEO_MAX_FINDINGS, "a diagnosis has room for every measure");

const rheo__measures rheo__measures_positions = {ROWS, sizeof ROWS / sizeof *ROWS, rheo__advise_half_step};
