/*
 * Stage balls: contact of balls with each other (docs/model.md, Balls), for two or more. Pairs act one after another: 1 with 2, 1 with
 * 3, ..., 2 with 3, and so on. Two balls of masses M, radii R and inertia 2/5 M R^2 overlap by o = R_1 + R_2 - d, d the distance of
 * their centres. With N the unit vector from the first to the second, u the velocity of the second relative to the first, at the point
 * of contact, m = 1/(1/M_1 + 1/M_2), and tau the substep:
 *
 *     normal, if u_n < 0:  u_n' = min(u_n + o/tau, 0)
 *     tangential, then:    J_t = -s u_t/(1/m + 5/2 (f^2/M_1 + f^2/M_2)),  f = d/(R_1 + R_2),  s = friction tau/(1 + friction tau)
 *
 * as at walls; friction is the mean of both. The point of contact divides the distance by the ratio of the radii, so that both arms end
 * there. Impulses are equal and opposite, and displace, too: by tau J/M. Overlap that is left is removed without velocity, and leaves
 * the centre of mass where it is. No contact adds kinetic energy.
 */
#include "solids/solids.h"

/* A ball in double, and what the contact adds. */
typedef struct partner {
    rheo_real *position, *velocity, *spin;
    double radius, inverse_mass, side; /* side: -1 of the first, +1 of the second; impulses on it have this sign */
    double arm;                        /* of the contact: from the centre, against `side` along the normal */
} partner;

static partner partner_at(rheo__state *s, const rheo__solids *solids, uint32_t index, double side)
{
    return (partner){.position = s->ball_position + 3 * (size_t)index,
                     .velocity = s->ball_velocity + 3 * (size_t)index,
                     .spin = s->ball_spin + 3 * (size_t)index,
                     .radius = rheo__ball_of(solids->def, index)->radius,
                     .inverse_mass = 1 / (double)solids->ball_mass[index],
                     .side = side};
}

/* Velocity at the point of contact. n: normal from the first to the second. */
static void surface_velocity(const partner *ball, const double n[3], double out[3])
{
    double arm[3], spin[3];
    for (int axis = 0; axis < 3; axis++) {
        arm[axis] = -ball->side * ball->arm * n[axis];
        spin[axis] = (double)ball->spin[axis];
    }
    rheo__cross_double(spin, arm, out);
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (double)ball->velocity[axis] + out[axis];
}

/* Impulse J on the second ball, its opposite on the first; `apart` moves them without velocity, by this times 1/M. */
static void push(const partner *ball, const double n[3], const double impulse[3], double apart, double substep)
{
    double turn[3];
    rheo__cross_double(n, impulse, turn);
    const double by = 2.5 * ball->arm / (ball->radius * ball->radius) * ball->inverse_mass;
    for (int axis = 0; axis < 3; axis++) {
        const double change = ball->side * ball->inverse_mass * impulse[axis];
        ball->velocity[axis] = (rheo_real)((double)ball->velocity[axis] + change);
        ball->position[axis] = (rheo_real)((double)ball->position[axis] + substep * change +
                                           ball->side * ball->inverse_mass * apart * n[axis]);
        ball->spin[axis] = (rheo_real)((double)ball->spin[axis] - by * turn[axis]);
    }
}

static void collide(const rheo__solids *solids, partner *first, partner *second, double friction)
{
    const double substep = (double)*solids->substep, rubbing = friction * substep,
                 reach = first->radius + second->radius;
    double n[3], u[3], other[3], impulse[3];
    for (int axis = 0; axis < 3; axis++)
        n[axis] = (double)second->position[axis] - (double)first->position[axis];
    const double distance = __builtin_sqrt(rheo__dot_double(n, n)), overlap = reach - distance;
    if (!(overlap > 0))
        return;
    for (int axis = 0; axis < 3; axis++) /* balls in one place: the second goes up */
        n[axis] = distance > 0 ? n[axis] / distance : axis == 1;
    const double share = distance / reach, mass = 1 / (first->inverse_mass + second->inverse_mass);
    first->arm = share * first->radius;
    second->arm = share * second->radius;
    surface_velocity(second, n, u);
    surface_velocity(first, n, other);
    for (int axis = 0; axis < 3; axis++)
        u[axis] -= other[axis];
    const double approach = rheo__dot_double(n, u), explained = approach + overlap / substep,
                 after = explained < 0 ? explained : 0, change = approach < 0 ? after - approach : 0,
                 left = overlap - substep * change,
                 slows = change > 0 ? rubbing / (1 + rubbing) * mass / (1 + 2.5 * share * share) : 0;
    for (int axis = 0; axis < 3; axis++)
        impulse[axis] = mass * change * n[axis] - slows * (u[axis] - approach * n[axis]);
    const double apart = left > 0 ? mass * left : 0;
    push(first, n, impulse, apart, substep);
    push(second, n, impulse, apart, substep);
}

rheo_result rheo__stage_balls(rheo__state *s, void *context)
{
    const rheo__solids *solids = context;
    for (uint32_t a = 0; a < s->bodies; a++)
        for (uint32_t b = a + 1; b < s->bodies; b++) {
            partner first = partner_at(s, solids, a, -1), second = partner_at(s, solids, b, 1);
            const double friction =
                0.5 * (rheo__ball_of(solids->def, a)->friction + rheo__ball_of(solids->def, b)->friction);
            collide(solids, &first, &second, friction);
        }
    return RHEO_OK;
}
