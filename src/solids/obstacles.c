/*
 * Stage obstacles: solids whose motion is given (docs/model.md, Obstacles). In a substep tau the centre c of an obstacle
 * moves by
 *
 *     tau V + A (sin(2 pi phase') - sin(2 pi phase)),   phase' = phase + tau f,
 *
 * which is tau times its velocity U, and the obstacle turns about c by the angle tau |spin|. Then it stops particles as a
 * wall does (solids/walls.c), whose normal n is that of the nearest point of its surface and which moves, at the particle,
 * with the velocity U + spin x (x - c). `overlap` is the part of wall_distance that is missing:
 *
 *     normal, if u_n < 0:  u_n' = min(u_n + overlap/tau, 0),  u relative to the surface
 *     tangential:          u_t' = u_t/(1 + tau c_b wall_friction)
 *
 * Changes of velocity displace, too, and overlap that is left is removed without velocity. A particle in a corner touches
 * several faces, one after another. The ball stops without bouncing; friction at the contact turns it. All is computed in
 * double.
 */
#include "core/account.h"
#include "core/math.h"
#include "solids/solids.h"
#include "space/near.h"

static const double TWO_PI = 6.28318530717958647692;
static const double MOST_STICK = 1e30; /* as in stage walls */
static const double SAME_FACE = 0.9;   /* normals with a larger product belong to one contact */
static const double ROUNDING = 1e-5;   /* overlap of this part of the distance may be rounding of the position */
enum { MOST_CONTACTS = 3 }; /* of a particle with an obstacle: as many faces as meet at a corner of a box */

/* An obstacle in a substep. */
typedef struct moving {
    const rheo__rigid *solid;
    uint32_t index;
    double centre[3], velocity[3], spin[3];
    rheo__matrix matrix;
    double substep, distance, sticking;
} moving;

/* ---- Motion ---- */

/* q' = (cos h, w/|w| sin h) q, h half the angle; normalised again, since rounding adds up. */
static void turn(double q[4], const double spin[3], double step)
{
    const double rate = __builtin_sqrt(rheo__dot_double(spin, spin)), turns = rate * step / (2 * TWO_PI);
    if (!(rate > 0))
        return;
    const double c = rheo__cos_turns(turns), sine = rheo__sin_turns(turns) / rate;
    const double x = sine * spin[0], y = sine * spin[1], z = sine * spin[2];
    const double turned[4] = {
        c * q[0] - (x * q[1] + y * q[2] + z * q[3]), c * q[1] + (x * q[0] + y * q[3] - z * q[2]),
        c * q[2] + (y * q[0] + z * q[1] - x * q[3]), c * q[3] + (z * q[0] + x * q[2] - y * q[1])};
    const double length =
        __builtin_sqrt(turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2] + turned[3] * turned[3]);
    for (int i = 0; i < 4; i++)
        q[i] = turned[i] / length;
}

static moving move(rheo__state *s, const rheo__solids *solids, uint32_t index)
{
    const rheo_obstacle *obstacle = &solids->def->obstacles.list[index];
    moving m = {.solid = &solids->obstacle[index],
                .index = index,
                .substep = (double)*solids->substep,
                .distance = (double)solids->wall_distance,
                .sticking = solids->def->walls.sticking};
    double *centre = s->obstacle_position + 3 * (size_t)index, *q = s->obstacle_rotation + 4 * (size_t)index;
    const double before = s->obstacle_phase[index], after = before + m.substep * obstacle->frequency,
                 phase = after < 0x1p50 ? after - (double)(int64_t)after : 0,
                 swing = rheo__sin_turns(phase) - rheo__sin_turns(before);
    s->obstacle_phase[index] = phase;
    for (int axis = 0; axis < 3; axis++) {
        m.velocity[axis] = obstacle->velocity[axis] + obstacle->amplitude[axis] * swing / m.substep;
        m.spin[axis] = obstacle->spin[axis];
        centre[axis] += m.substep * m.velocity[axis];
        m.centre[axis] = centre[axis];
    }
    turn(q, m.spin, m.substep);
    m.matrix = rheo__rotation_matrix(q);
    return m;
}

/* Velocity of the surface, at x. */
static void surface_velocity(const moving *m, const double x[3], double velocity[3])
{
    const double arm[3] = {x[0] - m->centre[0], x[1] - m->centre[1], x[2] - m->centre[2]};
    rheo__cross_double(m->spin, arm, velocity);
    for (int axis = 0; axis < 3; axis++)
        velocity[axis] += m->velocity[axis];
}

/* Distance of x from the surface, as far as it is below `within`, and the normal. */
static double distance_of(const moving *m, const double x[3], double within, double normal[3])
{
    double local[3], of_frame[3];
    rheo__into_frame(&m->matrix, m->centre, x, local);
    const double distance = rheo__rigid_distance(m->solid, local, within, of_frame);
    rheo__out_of_frame(&m->matrix, of_frame, normal);
    return distance;
}

/* ---- Particles ---- */

/* Adds to velocity and position of a particle. */
static void add(const rheo__state *s, const moving *m, uint32_t id, const rheo_real gain[3], const rheo_real shift[3])
{
    rheo_real *x = s->position + 3 * (size_t)id, *v = s->velocity + 3 * (size_t)id;
    for (int axis = 0; axis < 3; axis++) {
        v[axis] += gain[axis];
        x[axis] += shift[axis];
    }
    if (rheo__has_account(s) && s->account->id == id) {
        rheo__account_add(s, RHEO__FIELD_velocity, RHEO_SOURCE_OBSTACLE, m->index, gain[0], gain[1], gain[2]);
        rheo__account_add(s, RHEO__FIELD_position, RHEO_SOURCE_OBSTACLE, m->index, shift[0], shift[1], shift[2]);
    }
}

/* Stops the particle at the nearest point of the surface. */
static void stop_at(const rheo__state *s, const moving *m, uint32_t id, double overlap, const double n[3],
                    double friction)
{
    const rheo_real *x = s->position + 3 * (size_t)id, *v = s->velocity + 3 * (size_t)id;
    const double at[3] = {(double)x[0], (double)x[1], (double)x[2]};
    double relative[3];
    rheo_real gain[3], shift[3];
    surface_velocity(m, at, relative);
    for (int axis = 0; axis < 3; axis++)
        relative[axis] = (double)v[axis] - relative[axis];
    const double normal = rheo__dot_double(n, relative), most = overlap / m->substep,
                 change = normal < 0 ? (most < -normal ? most : -normal) : 0, left = overlap - m->substep * change;
    double stick = friction < MOST_STICK ? friction : MOST_STICK;
    stick *= m->substep * m->sticking;
    stick = stick < MOST_STICK ? stick : MOST_STICK;
    const double lost = stick / (1 + stick);
    for (int axis = 0; axis < 3; axis++) {
        const double by = change * n[axis] - lost * (relative[axis] - normal * n[axis]);
        gain[axis] = (rheo_real)by;
        shift[axis] = (rheo_real)(m->substep * by + (left > 0 ? left * n[axis] : 0));
    }
    add(s, m, id, gain, shift);
}

/* Removes overlap that a contact with this face has left where the surface is curved. */
static void put_off(const rheo__state *s, const moving *m, uint32_t id, double overlap, const double n[3])
{
    const rheo_real none = -RHEO__R(0.0), gain[3] = {none, none, none}, /* adding -0 changes nothing */
        shift[3] = {(rheo_real)(overlap * n[0]), (rheo_real)(overlap * n[1]), (rheo_real)(overlap * n[2])};
    if (overlap > ROUNDING * m->distance)
        add(s, m, id, gain, shift);
}

static void stop_particle(const rheo__state *s, const moving *m, uint32_t id, double friction)
{
    double normal[MOST_CONTACTS][3];
    for (int k = 0; k < MOST_CONTACTS; k++) {
        const rheo_real *x = s->position + 3 * (size_t)id;
        const double at[3] = {(double)x[0], (double)x[1], (double)x[2]},
                     overlap = m->distance - distance_of(m, at, m->distance, normal[k]);
        if (!(overlap > 0))
            return;
        for (int before = 0; before < k; before++)
            if (rheo__dot_double(normal[k], normal[before]) > SAME_FACE) {
                put_off(s, m, id, overlap, normal[k]);
                return;
            }
        stop_at(s, m, id, overlap, normal[k], friction);
    }
}

static void stop_particles(const rheo__state *s, const rheo__solids *solids, const moving *m)
{
    static rheo__near_function *const variants[] = RHEO__ALL_VARIANTS(near);
    rheo__near_function *const near_of = variants[rheo__simd_in_use()];
    const rheo_real centre[3] = {(rheo_real)m->centre[0], (rheo_real)m->centre[1], (rheo_real)m->centre[2]};
    double size = m->solid->reach + m->distance;
    for (int axis = 0; axis < 3; axis++) /* rounding of positions and centre */
        size += 1e-6 * (m->centre[axis] < 0 ? -m->centre[axis] : m->centre[axis]);
    const rheo_real reach2 = (rheo_real)(size * size * (1 + 1e-5));
    for (uint32_t first = 0; first < s->particles; first += RHEO__NEAR_AT_ONCE) {
        const uint32_t left = s->particles - first, tested = left < RHEO__NEAR_AT_ONCE ? left : RHEO__NEAR_AT_ONCE;
        uint64_t near = ~UINT64_C(0) >> (RHEO__NEAR_AT_ONCE - tested);
        if (!m->solid->inside)
            near = near_of(s->position + 3 * (size_t)first, tested, centre, reach2);
        for (; near; near &= near - 1) {
            const uint32_t id = first + (uint32_t)__builtin_ctzll(near);
            stop_particle(s, m, id, solids->wall_friction ? (double)solids->wall_friction[id] : 0);
        }
    }
}

/* ---- The ball ---- */

static void stop_ball(const rheo__state *s, const moving *m, uint32_t body, double radius, double friction)
{
    rheo_real *x = s->ball_position + 3 * (size_t)body, *v = s->ball_velocity + 3 * (size_t)body,
              *spin = s->ball_spin + 3 * (size_t)body;
    const double at[3] = {(double)x[0], (double)x[1], (double)x[2]},
                 w[3] = {(double)spin[0], (double)spin[1], (double)spin[2]};
    double n[3], surface[3], own[3], torque[3];
    const double overlap = radius - distance_of(m, at, radius, n);
    if (!(overlap > 0))
        return;
    const double arm[3] = {-radius * n[0], -radius * n[1], -radius * n[2]},
                 contact[3] = {at[0] + arm[0], at[1] + arm[1], at[2] + arm[2]};
    surface_velocity(m, contact, surface);
    rheo__cross_double(w, arm, own);
    double relative[3];
    for (int axis = 0; axis < 3; axis++)
        relative[axis] = (double)v[axis] + own[axis] - surface[axis];
    const double normal = rheo__dot_double(n, relative), most = overlap / m->substep,
                 change = normal < 0 ? (most < -normal ? most : -normal) : 0, left = overlap - m->substep * change;
    /* A ball that slides reacts at its contact like a mass of 2/7 of its own. */
    const double rubbing = friction * m->substep, share = change > 0 ? rubbing / (1 + rubbing) / 3.5 : 0;
    double slide[3];
    for (int axis = 0; axis < 3; axis++)
        slide[axis] = -share * (relative[axis] - normal * n[axis]);
    rheo__cross_double(arm, slide, torque);
    for (int axis = 0; axis < 3; axis++) {
        const double by = change * n[axis] + slide[axis];
        v[axis] += (rheo_real)by;
        x[axis] += (rheo_real)(m->substep * by + (left > 0 ? left * n[axis] : 0));
        spin[axis] += (rheo_real)(2.5 * torque[axis] / (radius * radius));
    }
}

/* ---- The stage ---- */

rheo_result rheo__stage_obstacles(rheo__state *s, void *context)
{
    const rheo__solids *solids = context;
    const rheo_world_def *def = solids->def;
    for (uint32_t i = 0; i < s->obstacles; i++) {
        const moving m = move(s, solids, i);
        stop_particles(s, solids, &m);
        for (uint32_t body = 0; body < s->bodies; body++)
            stop_ball(s, &m, body, rheo__ball_of(def, body)->radius, rheo__ball_of(def, body)->friction);
    }
    return RHEO_OK;
}

double rheo__obstacles_speed(const rheo__solids *solids, const rheo_world_def *def)
{
    double fastest = 0;
    for (uint32_t i = 0; i < def->obstacles.count && solids->obstacle; i++) {
        const rheo_obstacle *o = &def->obstacles.list[i];
        const double speed = rheo__obstacle_speed(o, solids->obstacle[i].reach);
        fastest = speed > fastest ? speed : fastest;
    }
    return fastest;
}
