/* Stage ball_motion: the ball falls, moves and turns as a free body (docs/model.md, 3). */
#include "solids/solids.h"

rheo_result rheo_stage_ball_motion(rheo_state *s, void *context)
{
    const rheo_solids *solids = context;
    rheo_real *q = s->ball_orientation;
    const rheo_real *w = s->ball_spin;
    for (int axis = 0; axis < 3; axis++) {
        s->ball_velocity[axis] += solids->step * solids->gravity[axis];
        s->ball_position[axis] += solids->step * s->ball_velocity[axis];
    }
    /* q += step/2 (0, w) q, made a unit quaternion again. */
    rheo_real half = RHEO_R(0.5) * solids->step;
    rheo_real turned[4] = {q[0] - half * (w[0] * q[1] + w[1] * q[2] + w[2] * q[3]),
                           q[1] + half * (w[0] * q[0] + w[1] * q[3] - w[2] * q[2]),
                           q[2] + half * (w[1] * q[0] + w[2] * q[1] - w[0] * q[3]),
                           q[3] + half * (w[2] * q[0] + w[0] * q[2] - w[1] * q[1])};
    rheo_real length =
        rheo_sqrt(turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2] + turned[3] * turned[3]);
    for (int i = 0; i < 4; i++)
        q[i] = turned[i] / length;
    return RHEO_OK;
}
