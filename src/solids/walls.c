/*
 * Stage walls (Ozgen et al., 3.3; docs/model.md, Contact). A particle closer to a wall than wall_distance touches it;
 * `overlap` is by how much. With v_n its velocity out of the wall, relative to a vibrating floor, and tau the substep:
 *
 *     normal, if v_n < 0:  v_n' = min(v_n + overlap/tau, 0)
 *     tangential:          v_t' = v_t/(1 + tau c_b wall_friction), so that stiff fluid sticks
 *
 * Changes of velocity displace, too: by tau times the change. Overlap that is left is removed without velocity. The
 * balls stop at walls without bouncing; friction at the contact turns them.
 */
#include "core/account_lanes.h"
#include "solids/solids.h"

/* Bounds wall_friction and its product, which would be infinite for springs far softer than their history, and then NaN. */
static const rheo_real MOST_STICK = RHEO__R(1e30);

typedef struct constants {
    rheo_real substep, sticking;
    rheo_real vibrator_radius2, amplitude;
} constants;

/* Height of the raised floor at points (x, z), and its rate. */
static void floor_bump(const rheo__state *s, const rheo__solids *solids, const constants *c, rheo__lanes x,
                       rheo__lanes z, rheo__lanes *height, rheo__lanes *rate)
{
    const rheo__lanes radius2 = rheo__lanes_all(c->vibrator_radius2);
    *height = *rate = rheo__lanes_all(0);
    for (uint32_t i = 0; i < s->vibrators; i++) {
        const rheo__lanes dx = x - s->vibrator_position[2 * i], dz = z - s->vibrator_position[2 * i + 1],
                          distance2 = dx * dx + dz * dz;
        const rheo__mask inside = distance2 < radius2;
        if (rheo__lanes_any(inside)) {
            rheo__lanes shape = 1 - distance2 / radius2;
            shape *= shape * c->amplitude;
            *height += rheo__lanes_keep(inside, shape * solids->wave[i]);
            *rate += rheo__lanes_keep(inside, shape * solids->wave_rate[i]);
        }
    }
}

/* Change of normal velocities by a contact: at most the velocity, and at most what removes the overlap. */
static rheo__lanes slowed(rheo__lanes normal, rheo__lanes overlap, rheo_real substep)
{
    return rheo__lanes_keep(normal < 0, rheo__lanes_min(overlap / substep, -normal));
}

static rheo__lanes distance_of(const rheo__plane *plane, rheo__lanes3 x)
{
    const rheo_real *n = plane->normal;
    return n[0] * x.x + n[1] * x.y + n[2] * x.z - plane->offset;
}

/* Stops those particles that touch the wall. False: none does. */
static bool stop_at_wall(const rheo__state *s, const rheo__solids *solids, const constants *c, uint32_t wall,
                         rheo__lanes wall_friction, uint32_t id, rheo__lanes3 *x, rheo__lanes3 *v)
{
    const rheo__plane *plane = &solids->planes->plane[wall];
    const rheo_real *n = plane->normal;
    const bool vibrates = wall == solids->vibrating_wall;
    rheo__lanes distance = distance_of(plane, *x), rate = rheo__lanes_all(0);
    const rheo__mask near = distance < solids->wall_distance + (vibrates ? solids->max_bump : 0);
    if (!rheo__lanes_any(near))
        return false;
    if (vibrates) {
        rheo__lanes height;
        floor_bump(s, solids, c, x->x, x->z, &height, &rate);
        distance -= height;
    }
    const rheo__lanes overlap = solids->wall_distance - distance;
    const rheo__mask touches = near & (overlap > 0);
    const rheo__lanes normal = n[0] * v->x + n[1] * v->y + n[2] * v->z,
                      change = slowed(normal - rate, overlap, c->substep);
    const rheo__lanes stick = rheo__lanes_min(c->substep * c->sticking * wall_friction, rheo__lanes_all(MOST_STICK)),
                      lost = stick / (1 + stick),
                      left = rheo__lanes_max(overlap - c->substep * change, rheo__lanes_all(0));
    rheo__lanes *const position[] = {&x->x, &x->y, &x->z}, *const velocity[] = {&v->x, &v->y, &v->z};
    rheo__lanes3 gain, shift;
    rheo__lanes *const by[] = {&gain.x, &gain.y, &gain.z}, *const moves[] = {&shift.x, &shift.y, &shift.z};
    for (int axis = 0; axis < 3; axis++) {
        const rheo__lanes own = *velocity[axis];
        *by[axis] = change * n[axis] - lost * (own - normal * n[axis]);
        *moves[axis] = c->substep * *by[axis] + left * n[axis];
        *velocity[axis] = rheo__lanes_select(touches, own + *by[axis], own);
        *position[axis] = rheo__lanes_select(touches, *position[axis] + *moves[axis], *position[axis]);
    }
    if (RHEO__ACCOUNTS_HERE && rheo__has_account(s) && s->account->id == id && rheo__lanes_any(touches)) {
        rheo__account_add_lanes(s, RHEO__FIELD_velocity, RHEO_SOURCE_WALL, wall, gain);
        rheo__account_add_lanes(s, RHEO__FIELD_position, RHEO_SOURCE_WALL, wall, shift);
    }
    return true;
}

/* Stops RHEO__LANES particles from `id` on, one after another in the arrays; wall_friction may be NULL. */
static void stop_particles(const rheo__state *s, const rheo__solids *solids, const constants *c, uint32_t id,
                           rheo_real *position, rheo_real *velocity, const rheo_real *wall_friction)
{
    rheo__lanes3 x = rheo__lanes_load_triples(position), v = rheo__lanes_load_triples(velocity);
    rheo__lanes friction = rheo__lanes_all(0);
    if (wall_friction)
        memcpy(&friction, wall_friction, sizeof friction);
    friction = rheo__lanes_min(friction, rheo__lanes_all(MOST_STICK));
    bool any = false;
    for (uint32_t wall = 0; wall < solids->planes->count; wall++)
        any |= stop_at_wall(s, solids, c, wall, friction, id, &x, &v);
    if (!any)
        return;
    rheo__lanes_store_triples(position, x);
    rheo__lanes_store_triples(velocity, v);
}

static void stop_ball(rheo__state *s, const rheo__solids *solids, const constants *c, uint32_t wall, uint32_t index)
{
    const rheo_ball *ball = rheo__ball_of(solids->def, index);
    const rheo_real radius = (rheo_real)ball->radius, rubbing = (rheo_real)ball->friction * c->substep,
                    ball_share = rubbing / (1 + rubbing); /* of the ball's sliding that a substep stops */
    const rheo__plane *plane = &solids->planes->plane[wall];
    rheo_real *x = s->ball_position + 3 * (size_t)index, *v = s->ball_velocity + 3 * (size_t)index,
              *spin = s->ball_spin + 3 * (size_t)index;
    const rheo_real *n = plane->normal;
    rheo_real distance = rheo__plane_distance(plane, x[0], x[1], x[2]) - radius, rate = 0;
    if (wall == solids->vibrating_wall) {
        rheo__lanes height, rates;
        floor_bump(s, solids, c, rheo__lanes_all(x[0]), rheo__lanes_all(x[2]), &height, &rates);
        distance -= RHEO__LANE(height, 0);
        rate = RHEO__LANE(rates, 0);
    }
    if (!(distance < 0))
        return;
    const rheo__lanes all = slowed(rheo__lanes_all(rheo__dot(n, v) - rate), rheo__lanes_all(-distance), c->substep);
    const rheo_real change = RHEO__LANE(all, 0);
    const rheo_real left = rheo__max(-distance - c->substep * change, 0);
    rheo_real arm[3], surface[3], slide[3], turn[3];
    for (int axis = 0; axis < 3; axis++) {
        v[axis] += change * n[axis];
        x[axis] += (c->substep * change + left) * n[axis];
        arm[axis] = -radius * n[axis];
    }
    if (!(change > 0))
        return;
    rheo__cross(spin, arm, surface);
    for (int axis = 0; axis < 3; axis++)
        slide[axis] = v[axis] + surface[axis];
    /* A ball that slides reacts at its contact like a mass of 2/7 of its own. */
    const rheo_real into = rheo__dot(n, slide), share = ball_share / RHEO__R(3.5);
    for (int axis = 0; axis < 3; axis++)
        slide[axis] = -share * (slide[axis] - into * n[axis]);
    rheo__cross(arm, slide, turn);
    for (int axis = 0; axis < 3; axis++) {
        v[axis] += slide[axis];
        x[axis] += c->substep * slide[axis];
        spin[axis] += RHEO__R(2.5) * turn[axis] / (radius * radius);
    }
}

rheo_result RHEO__VARIANT(stage_walls)(rheo__state *s, void *context)
{
    const rheo__solids *solids = context;
    const rheo_world_def *def = solids->def;
    const rheo_real vibrator_radius = (rheo_real)def->vibrators.radius;
    const rheo_real substep = *solids->substep;
    const constants c = {.substep = substep,
                         .sticking = (rheo_real)def->walls.sticking,
                         .vibrator_radius2 = vibrator_radius * vibrator_radius,
                         .amplitude = (rheo_real)def->vibrators.amplitude};
    const uint32_t left = s->particles % RHEO__LANES, whole = s->particles - left;
    for (uint32_t id = 0; id < whole; id += RHEO__LANES)
        stop_particles(s, solids, &c, id, s->position + 3 * (size_t)id, s->velocity + 3 * (size_t)id,
                       solids->wall_friction ? solids->wall_friction + id : NULL);
    if (left) {
        rheo_real x[3 * RHEO__LANES] = {0}, v[3 * RHEO__LANES] = {0}, friction[RHEO__LANES] = {0};
        const size_t bytes = 3 * left * sizeof *x;
        memcpy(x, s->position + 3 * (size_t)whole, bytes);
        memcpy(v, s->velocity + 3 * (size_t)whole, bytes);
        if (solids->wall_friction)
            memcpy(friction, solids->wall_friction + whole, left * sizeof *friction);
        stop_particles(s, solids, &c, whole, x, v, friction);
        memcpy(s->position + 3 * (size_t)whole, x, bytes);
        memcpy(s->velocity + 3 * (size_t)whole, v, bytes);
    }
    for (uint32_t index = 0; index < s->bodies; index++)
        for (uint32_t w = 0; w < solids->planes->count; w++)
            stop_ball(s, solids, &c, w, index);
    return RHEO_OK;
}
