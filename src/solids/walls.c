/*
 * Stage walls (Ozgen et al., 3.3; docs/model.md, Contact). A particle closer to a wall than wall_distance touches it;
 * `overlap` is by how much. With v_n its velocity out of the wall, relative to a vibrating floor, and tau the substep:
 *
 *     normal, if v_n < 0:  v_n' = min(v_n + overlap/tau, 0)
 *     tangential:          v_t' = v_t/(1 + tau c_b wall_friction), so that stiff fluid sticks
 *
 * Changes of velocity displace, too: by tau times the change. Overlap that is left is removed without velocity. The
 * ball stops at walls without bouncing; friction at the contact turns it.
 */
#include "solids/solids.h"

typedef struct constants {
    rheo_real substep, sticking;
    rheo_real vibrator_radius2, amplitude;
    rheo_real ball_radius, ball_share; /* share of the ball's sliding that a substep stops */
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

/* Change of a normal velocity by a contact: at most the velocity, and at most what removes the overlap. */
static rheo_real slowed(rheo_real normal, rheo_real overlap, rheo_real substep)
{
    return normal < 0 ? rheo__min(overlap / substep, -normal) : 0;
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
    const rheo_real overlap = solids->wall_distance - distance;
    if (!(overlap > 0))
        return;
    const rheo_real normal = rheo__dot(n, v), change = slowed(normal - rate, overlap, c->substep);
    const rheo_real stick = solids->wall_friction ? c->substep * c->sticking * solids->wall_friction[id] : 0;
    const rheo_real lost = stick / (1 + stick), left = rheo__max(overlap - c->substep * change, 0);
    for (int axis = 0; axis < 3; axis++) {
        const rheo_real by = change * n[axis] - lost * (v[axis] - normal * n[axis]);
        v[axis] += by;
        x[axis] += c->substep * by + left * n[axis];
    }
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
    const rheo_real change = slowed(rheo__dot(n, v) - rate, -distance, c->substep);
    const rheo_real left = rheo__max(-distance - c->substep * change, 0);
    rheo_real arm[3], surface[3], slide[3], turn[3];
    for (int axis = 0; axis < 3; axis++) {
        v[axis] += change * n[axis];
        x[axis] += (c->substep * change + left) * n[axis];
        arm[axis] = -c->ball_radius * n[axis];
    }
    if (!(change > 0))
        return;
    rheo__cross(spin, arm, surface);
    for (int axis = 0; axis < 3; axis++)
        slide[axis] = v[axis] + surface[axis];
    /* A ball that slides reacts at its contact like a mass of 2/7 of its own. */
    const rheo_real into = rheo__dot(n, slide), share = c->ball_share / RHEO__R(3.5);
    for (int axis = 0; axis < 3; axis++)
        slide[axis] = -share * (slide[axis] - into * n[axis]);
    rheo__cross(arm, slide, turn);
    for (int axis = 0; axis < 3; axis++) {
        v[axis] += slide[axis];
        x[axis] += c->substep * slide[axis];
        spin[axis] += RHEO__R(2.5) * turn[axis] / (c->ball_radius * c->ball_radius);
    }
}

rheo_result rheo__stage_walls(rheo__state *s, void *context)
{
    const rheo__solids *solids = context;
    const rheo_world_def *def = solids->def;
    const rheo_real vibrator_radius = (rheo_real)def->vibrators.radius;
    const rheo_real substep = *solids->substep, friction = (rheo_real)def->ball.friction * substep;
    const constants c = {.substep = substep,
                         .sticking = (rheo_real)def->walls.sticking,
                         .vibrator_radius2 = vibrator_radius * vibrator_radius,
                         .amplitude = (rheo_real)def->vibrators.amplitude,
                         .ball_radius = (rheo_real)def->ball.radius,
                         .ball_share = friction / (1 + friction)};
    for (uint32_t id = 0; id < s->particles; id++)
        for (uint32_t w = 0; w < solids->planes->count; w++)
            stop_particle(s, solids, &c, w, id);
    for (uint32_t w = 0; w < solids->planes->count && s->bodies; w++)
        stop_ball(s, solids, &c, w);
    return RHEO_OK;
}
