/*
 * Stage ball_push: a periodic push of each ball, as by the leg of a runner (docs/model.md, Push). In each period 1/f the
 * ball is accelerated by half a sine during the share `duty` of the period, and not in the rest. With p the phase in
 * turns and a (ball.push) the mean over a period:
 *
 *     acceleration = a pi/(2 duty) sin(pi p/duty)  for p < duty, else 0
 *
 * The change of velocity is its exact integral over the step, a/f times the change of floor(p) + I(p - floor(p)):
 *
 *     I(p) = (1 - cos(pi min(p/duty, 1)))/2
 *
 * so that a whole period gives a/f. It comes at the start of the step, before the margins of neighbours and the number of
 * substeps are chosen, since they depend on the speed of the ball.
 */
#include "core/math.h"
#include "solids/solids.h"

/* I(p) for 0 <= p < 1. */
static double given_until(double phase, double duty)
{
    const double share = phase / duty;
    return 0.5 - 0.5 * rheo__cos_turns(0.5 * (share < 1 ? share : 1));
}

static void push(rheo__state *s, const rheo_world_def *def, uint32_t index)
{
    rheo_real *v = s->ball_velocity + 3 * (size_t)index;
    const rheo_ball *ball = rheo__ball_of(def, index);
    const double frequency = ball->push_frequency, duty = ball->push_duty, start = s->ball_push_phase[index],
                 end = start + frequency * def->step, whole = (double)(uint64_t)end; /* at most 1e18 */
    const double periods = whole + given_until(end - whole, duty) - given_until(start, duty);
    for (int axis = 0; axis < 3; axis++)
        v[axis] += (rheo_real)(ball->push[axis] / frequency * periods);
    s->ball_push_phase[index] = end - whole;
}

rheo_result rheo__stage_ball_push(rheo__state *s, void *context)
{
    for (uint32_t index = 0; index < s->bodies; index++)
        push(s, ((rheo__solids *)context)->def, index);
    return RHEO_OK;
}
