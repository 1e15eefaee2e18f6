/*
 * Stage walls (Ozgen et al., 3.3; docs/model.md, 8). A particle within half a spacing of a wall is at it: its
 * velocity into the wall is cancelled (against the wall's own velocity, where vibrators move the floor), and its
 * tangential velocity is multiplied by max(0, 1 - c_b wall_friction), so that stiff fluid sticks. A particle past the wall is
 * put onto it, and a tiny length further in that depends on its id, so that no sheet of particles is exactly plane.
 *
 * The ball stops at walls too, without bouncing; friction at the contact turns it.
 */
#include "solids/solids.h"

/* How far vibrators raise the floor at (x, z), and how fast. */
static void floor_bump(const rheo__state *s, const rheo__solids *solids, rheo_real x, rheo_real z, rheo_real *height,
                       rheo_real *rate)
{
    rheo_real radius2 = solids->vibrator_radius * solids->vibrator_radius;
    *height = *rate = 0;
    for (uint32_t i = 0; i < s->vibrators; i++) {
        rheo_real dx = x - s->vibrator_position[2 * i], dz = z - s->vibrator_position[2 * i + 1];
        rheo_real distance2 = dx * dx + dz * dz;
        if (distance2 < radius2) {
            rheo_real shape = 1 - distance2 / radius2;
            shape *= shape * solids->amplitude;
            *height += shape * solids->wave[i];
            *rate += shape * solids->wave_rate[i];
        }
    }
}

static void stop_particle(rheo__state *s, const rheo__solids *solids, const rheo__plane *plane, uint32_t id)
{
    rheo_real *x = s->position + 3 * (size_t)id, *v = s->velocity + 3 * (size_t)id;
    const rheo_real *n = plane->normal;
    rheo_real distance = rheo__dot(n, x) - plane->offset, rate = 0;
    if (plane->vibrates) {
        if (distance >= solids->reach + solids->largest_bump)
            return;
        rheo_real height;
        floor_bump(s, solids, x[0], x[2], &height, &rate);
        distance -= height;
    }
    if (!(distance < solids->reach))
        return;
    if (distance < 0) {
        /* 10 mixed bits of the id: 0 .. 1023 tiny lengths. */
        rheo_real inside = solids->tiny * (rheo_real)(id * UINT32_C(0x9E3779B1) >> 22) - distance;
        for (int axis = 0; axis < 3; axis++)
            x[axis] += inside * n[axis];
    }
    rheo_real normal = rheo__dot(n, v);
    rheo_real kept = rheo__max(normal, rate);
    rheo_real slip =
        s->wall_friction && solids->sticking > 0 ? rheo__max(1 - solids->sticking * s->wall_friction[id], 0) : 1;
    for (int axis = 0; axis < 3; axis++)
        v[axis] = slip * (v[axis] - normal * n[axis]) + kept * n[axis];
}

static void stop_ball(rheo__state *s, const rheo__solids *solids, const rheo__plane *plane)
{
    rheo_real *x = s->ball_position, *v = s->ball_velocity, *spin = s->ball_spin;
    const rheo_real *n = plane->normal;
    rheo_real distance = rheo__dot(n, x) - plane->offset - solids->radius, rate = 0;
    if (plane->vibrates) {
        rheo_real height;
        floor_bump(s, solids, x[0], x[2], &height, &rate);
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
        arm[axis] = -solids->radius * n[axis];
    }
    rheo__cross(spin, arm, surface);
    for (int axis = 0; axis < 3; axis++)
        slide[axis] = v[axis] + surface[axis];
    rheo_real into = rheo__dot(n, slide), share = solids->friction / RHEO__R(3.5);
    for (int axis = 0; axis < 3; axis++)
        slide[axis] = -share * (slide[axis] - into * n[axis]);
    rheo__cross(arm, slide, turn);
    for (int axis = 0; axis < 3; axis++) {
        v[axis] += slide[axis];
        spin[axis] += RHEO__R(2.5) * turn[axis] / (solids->radius * solids->radius);
    }
}

rheo_result rheo__stage_walls(rheo__state *s, void *context)
{
    const rheo__solids *solids = context;
    for (uint32_t id = 0; id < s->particles; id++)
        for (uint32_t w = 0; w < solids->planes; w++)
            stop_particle(s, solids, &solids->plane[w], id);
    for (uint32_t w = 0; w < solids->planes && s->bodies; w++)
        stop_ball(s, solids, &solids->plane[w]);
    return RHEO_OK;
}
