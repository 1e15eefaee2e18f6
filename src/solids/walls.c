/*
 * Stage walls (Ozgen et al., 3.3; docs/model.md, 8). A particle closer to a wall than wall_distance touches it. Its
 * velocity into the wall, relative to a vibrating floor, is set to 0. Its tangential velocity is multiplied by max(0,
 * 1 - c_b wall_friction), so that stiff fluid sticks. A particle behind the wall is moved onto it, plus a jitter that
 * depends on its id, so that no sheet of particles is exactly plane.
 *
 * The ball stops at walls without bouncing; friction at the contact turns it.
 */
#include "solids/solids.h"

typedef struct constants {
    rheo_real wall_jitter, sticking;
    rheo_real vibrator_radius2, amplitude;
    rheo_real ball_radius, ball_friction;
} constants;

/* Height of the raised floor at (x, z), and its rate. */
static void floor_bump(const rheo__state *s, const rheo__solids *solids, const constants *c, rheo_real x, rheo_real z,
                       rheo_real *height, rheo_real *rate)
{
    const rheo_real radius2 = c->vibrator_radius2;
    *height = *rate = 0;
    for (uint32_t i = 0; i < s->vibrators; i++) {
        rheo_real dx = x - s->vibrator_position[2 * i], dz = z - s->vibrator_position[2 * i + 1];
        rheo_real distance2 = dx * dx + dz * dz;
        if (distance2 < radius2) {
            rheo_real shape = 1 - distance2 / radius2;
            shape *= shape * c->amplitude;
            *height += shape * solids->wave[i];
            *rate += shape * solids->wave_rate[i];
        }
    }
}

static void stop_particle(rheo__state *s, const rheo__solids *solids, const constants *c, uint32_t wall, uint32_t id)
{
    const rheo__plane *plane = &solids->planes->plane[wall];
    rheo_real *x = s->position + 3 * (size_t)id, *v = s->velocity + 3 * (size_t)id;
    const rheo_real *n = plane->normal;
    rheo_real distance = rheo__plane_distance(plane, x[0], x[1], x[2]), rate = 0;
    if (wall == solids->vibrating_wall) {
        if (distance >= solids->wall_distance + solids->max_bump)
            return;
        rheo_real height;
        floor_bump(s, solids, c, x[0], x[2], &height, &rate);
        distance -= height;
    }
    if (!(distance < solids->wall_distance))
        return;
    if (distance < 0) {
        /* 0 to 1023 jitters, by 10 mixed bits of the id. */
        rheo_real inside = c->wall_jitter * (rheo_real)(id * UINT32_C(0x9E3779B1) >> 22) - distance;
        for (int axis = 0; axis < 3; axis++)
            x[axis] += inside * n[axis];
    }
    rheo_real normal = rheo__dot(n, v);
    rheo_real kept = rheo__max(normal, rate);
    rheo_real slip =
        solids->wall_friction && c->sticking > 0 ? rheo__max(1 - c->sticking * solids->wall_friction[id], 0) : 1;
    for (int axis = 0; axis < 3; axis++)
        v[axis] = slip * (v[axis] - normal * n[axis]) + kept * n[axis];
}

static void stop_ball(rheo__state *s, const rheo__solids *solids, const constants *c, uint32_t wall)
{
    const rheo__plane *plane = &solids->planes->plane[wall];
    rheo_real *x = s->ball_position, *v = s->ball_velocity, *spin = s->ball_spin;
    const rheo_real *n = plane->normal;
    rheo_real distance = rheo__plane_distance(plane, x[0], x[1], x[2]) - c->ball_radius, rate = 0;
    if (wall == solids->vibrating_wall) {
        rheo_real height;
        floor_bump(s, solids, c, x[0], x[2], &height, &rate);
        distance -= height;
    }
    if (!(distance < 0))
        return;
    rheo_real approach = rheo__dot(n, v) - rate;
    for (int axis = 0; axis < 3; axis++)
        x[axis] -= distance * n[axis];
    if (!(approach < 0))
        return;
    rheo_real arm[3], surface[3], slide[3], turn[3];
    for (int axis = 0; axis < 3; axis++) {
        v[axis] -= approach * n[axis];
        arm[axis] = -c->ball_radius * n[axis];
    }
    rheo__cross(spin, arm, surface);
    for (int axis = 0; axis < 3; axis++)
        slide[axis] = v[axis] + surface[axis];
    rheo_real into = rheo__dot(n, slide), share = c->ball_friction / RHEO__R(3.5);
    for (int axis = 0; axis < 3; axis++)
        slide[axis] = -share * (slide[axis] - into * n[axis]);
    rheo__cross(arm, slide, turn);
    for (int axis = 0; axis < 3; axis++) {
        v[axis] += slide[axis];
        spin[axis] += RHEO__R(2.5) * turn[axis] / (c->ball_radius * c->ball_radius);
    }
}

rheo_result rheo__stage_walls(rheo__state *s, void *context)
{
    const rheo__solids *solids = context;
    const rheo_world_def *def = solids->def;
    const rheo_real vibrator_radius = (rheo_real)def->vibrators.radius;
    const constants c = {.wall_jitter = (rheo_real)(def->fluid.spacing / (1 << 20)),
                         .sticking = (rheo_real)def->walls.sticking,
                         .vibrator_radius2 = vibrator_radius * vibrator_radius,
                         .amplitude = (rheo_real)def->vibrators.amplitude,
                         .ball_radius = (rheo_real)def->ball.radius,
                         .ball_friction = (rheo_real)def->ball.friction};
    for (uint32_t id = 0; id < s->particles; id++)
        for (uint32_t w = 0; w < solids->planes->count; w++)
            stop_particle(s, solids, &c, w, id);
    for (uint32_t w = 0; w < solids->planes->count && s->bodies; w++)
        stop_ball(s, solids, &c, w);
    return RHEO_OK;
}
