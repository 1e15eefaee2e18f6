/*
 * Stage ball: contact of the ball with the particles inside it (docs/model.md, 8). Three sweeps of impulses between a
 * particle of mass 1 and the ball of mass M, in the order of ids. With u the velocity of the particle relative to the
 * surface of the ball at the contact and n the normal out of the ball:
 *
 *     normal, if approaching:        J = -u_n / (1 + 1/M)
 *     tangential, first sweep only:  J = -mu u_t / (1 + 3.5/M), which also turns the ball (inertia 2/5 M R^2)
 *
 * Then the particles are moved to the surface; their velocities do not change.
 */
#include <assert.h>

#include "solids/solids.h"

enum { SWEEPS = 3 };

typedef struct constants {
    rheo_real radius, mass, friction;
} constants;

/* Unit vector from the centre of the ball to a particle; upwards for a particle in the centre. */
static void outward(const rheo__state *s, uint32_t id, rheo_real n[3])
{
    const rheo_real *x = s->position + 3 * (size_t)id;
    for (int axis = 0; axis < 3; axis++)
        n[axis] = x[axis] - s->ball_position[axis];
    rheo_real length = rheo__sqrt(rheo__dot(n, n));
    if (length > 0) {
        for (int axis = 0; axis < 3; axis++)
            n[axis] /= length;
    } else {
        n[0] = n[2] = 0;
        n[1] = 1;
    }
}

static void collide(rheo__state *s, const constants *c, uint32_t id, bool with_friction)
{
    rheo_real *v = s->velocity + 3 * (size_t)id, *ball = s->ball_velocity, *spin = s->ball_spin;
    rheo_real n[3], arm[3], surface[3], u[3];
    outward(s, id, n);
    for (int axis = 0; axis < 3; axis++)
        arm[axis] = c->radius * n[axis];
    rheo__cross(spin, arm, surface);
    for (int axis = 0; axis < 3; axis++)
        u[axis] = v[axis] - (ball[axis] + surface[axis]);
    rheo_real approach = rheo__dot(u, n), inverse_mass = 1 / c->mass;
    rheo_real impulse[3] = {0, 0, 0};
    if (approach < 0) {
        rheo_real normal = -approach / (1 + inverse_mass);
        for (int axis = 0; axis < 3; axis++)
            impulse[axis] = normal * n[axis];
    }
    if (with_friction) {
        rheo_real tangential[3], torque[3], share = c->friction / (1 + RHEO__R(3.5) * inverse_mass);
        for (int axis = 0; axis < 3; axis++) {
            tangential[axis] = -share * (u[axis] - approach * n[axis]);
            impulse[axis] += tangential[axis];
        }
        /* The ball takes the opposite impulse at the contact; its moment of inertia is 2/5 M R^2. */
        rheo__cross(arm, tangential, torque);
        rheo_real turn = RHEO__R(2.5) * inverse_mass / (c->radius * c->radius);
        for (int axis = 0; axis < 3; axis++)
            spin[axis] -= turn * torque[axis];
    }
    for (int axis = 0; axis < 3; axis++) {
        v[axis] += impulse[axis];
        ball[axis] -= impulse[axis] * inverse_mass;
    }
}

rheo_result rheo__stage_ball(rheo__state *s, void *context)
{
    rheo__solids *solids = context;
    const rheo_world_def *def = solids->def;
    const constants c = {(rheo_real)def->ball.radius, rheo__ball_mass(def), (rheo_real)def->ball.friction};
    const rheo_real *centre = s->ball_position;
    const rheo_real radius2 = c.radius * c.radius;
    uint32_t touching = 0;
    const rheo_real *x = s->position;
    for (uint32_t i = 0; i < s->particles; i++, x += 3) {
        solids->touching[touching] = i;
        touching += rheo__length2(x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]) < radius2;
    }
    assert(touching <= solids->touching_capacity);
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (uint32_t k = 0; k < touching; k++)
            collide(s, &c, solids->touching[k], sweep == 0);
    for (uint32_t k = 0; k < touching; k++) {
        uint32_t id = solids->touching[k];
        rheo_real n[3];
        outward(s, id, n);
        for (size_t axis = 0; axis < 3; axis++)
            s->position[3 * (size_t)id + axis] = centre[axis] + c.radius * n[axis];
    }
    return RHEO_OK;
}
