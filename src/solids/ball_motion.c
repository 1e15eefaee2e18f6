/* Stage ball_motion: motion of each ball as a free body under gravity (docs/model.md, Motion). */
#include "solids/solids.h"

static void move(rheo__state *s, rheo__solids *solids, uint32_t index)
{
    const rheo_world_def *def = solids->def;
    const rheo_real step = *solids->substep;
    rheo_real *x = s->ball_position + 3 * (size_t)index, *v = s->ball_velocity + 3 * (size_t)index,
              *spin = s->ball_spin + 3 * (size_t)index, *orientation = s->ball_orientation + 4 * (size_t)index;
    double w[3], q[4], speed2 = 0;
    for (int axis = 0; axis < 3; axis++) {
        v[axis] += step * (rheo_real)def->gravity[axis];
        x[axis] += step * v[axis];
        speed2 += (double)v[axis] * (double)v[axis];
        w[axis] = 0.5 * (double)step * (double)spin[axis];
    }
    const double speed = __builtin_sqrt(speed2);
    if (speed > solids->ball_max_speed[index])
        solids->ball_max_speed[index] = speed;
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
}

rheo_result rheo__stage_ball_motion(rheo__state *s, void *context)
{
    for (uint32_t index = 0; index < s->bodies; index++)
        move(s, context, index);
    return RHEO_OK;
}
