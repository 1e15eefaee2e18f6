/* Stage ball_motion: motion of the ball as a free body under gravity (docs/model.md, Motion). */
#include "solids/solids.h"

rheo_result rheo__stage_ball_motion(rheo__state *s, void *context)
{
    rheo__solids *solids = context;
    const rheo_world_def *def = solids->def;
    const rheo_real step = *solids->substep;
    rheo_real *orientation = s->ball_orientation;
    double w[3], q[4], speed2 = 0;
    for (int axis = 0; axis < 3; axis++) {
        s->ball_velocity[axis] += step * (rheo_real)def->gravity[axis];
        s->ball_position[axis] += step * s->ball_velocity[axis];
        speed2 += (double)s->ball_velocity[axis] * (double)s->ball_velocity[axis];
        w[axis] = 0.5 * (double)step * (double)s->ball_spin[axis];
    }
    const double speed = __builtin_sqrt(speed2);
    solids->ball_max_speed = speed > solids->ball_max_speed ? speed : solids->ball_max_speed;
    for (int i = 0; i < 4; i++)
        q[i] = (double)orientation[i];
    /* q += step/2 (0, spin) q, normalised again; in double, in which the square of any spin is finite. */
    const double turned[4] = {
        q[0] - (w[0] * q[1] + w[1] * q[2] + w[2] * q[3]), q[1] + (w[0] * q[0] + w[1] * q[3] - w[2] * q[2]),
        q[2] + (w[1] * q[0] + w[2] * q[1] - w[0] * q[3]), q[3] + (w[2] * q[0] + w[0] * q[2] - w[1] * q[1])};
    double length =
        __builtin_sqrt(turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2] + turned[3] * turned[3]);
    for (int i = 0; i < 4; i++)
        orientation[i] = (rheo_real)(turned[i] / length);
    return RHEO_OK;
}
