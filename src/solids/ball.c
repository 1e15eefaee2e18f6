/*
 * Stage ball: contact of the ball with the particles (docs/model.md, Contact). A particle (mass 1) closer to the
 * surface than friction_distance rubs against it; closer than ball_distance by `overlap` it is pushed out. With n the
 * normal out of the ball, u the velocity of the particle relative to the surface of the ball at the contact, and tau
 * the substep:
 *
 *     normal, if overlapping and approaching:  u_n' = min(u_n + overlap/tau, 0)
 *     tangential:                              J_t = -s u_t',  s = friction tau/(1 + friction tau)
 *
 * so that only overlap that the approach explains becomes velocity. u' is relative to the ball after the contact:
 * velocity V and spin W of the ball follow from the conservation of momentum and angular momentum, six linear
 * equations for all contacts at once. The arm of an impulse is the distance of the particle from the centre, in which
 * the ball reaches to the particle; with an arm of one radius, friction would lose a tenth of the angular momentum. Their matrix is symmetric and positive definite. No contact comes before
 * another; sums are in the order of ids. Impulses J displace, too: by tau J. Overlap that is left is removed without
 * velocity.
 */
#include "core/account.h"
#include "solids/solids.h"
#include "space/near.h"

enum { ROUNDS = 4 }; /* contacts that pull are dropped, and the equations are solved again, at most so often */

typedef struct constants {
    uint32_t index; /* of the ball */
    rheo_real *position, *velocity, *spin;
    double radius, surface, reach, mass, inertia, share, substep; /* surface: radius at which particles are stopped */
} constants;

/* Matrix, and right-hand side as its last column, for V and W. Lower triangle. */
typedef struct equations {
    double a[6][6], b[6];
} equations;

/* Unit vector from the centre of the ball to a particle; upwards for a particle in the centre. Returns the distance. */
static double outward(const rheo__state *s, uint32_t id, const constants *c, double n[3])
{
    const rheo_real *x = s->position + 3 * (size_t)id;
    for (int axis = 0; axis < 3; axis++)
        n[axis] = (double)x[axis] - (double)c->position[axis];
    const double length = __builtin_sqrt(rheo__dot_double(n, n));
    for (int axis = 0; axis < 3; axis++)
        n[axis] = length > 0 ? n[axis] / length : axis == 1;
    return length;
}

/* Contact with a particle in reach of the ball, and its target of u_n. */
static rheo__touch contact(const rheo__state *s, uint32_t id, const constants *c)
{
    const rheo_real *v = s->velocity + 3 * (size_t)id;
    rheo__touch touch = {.id = id};
    touch.distance = outward(s, id, c, touch.normal);
    const double overlap = c->surface - touch.distance;
    double approach = 0;
    for (int axis = 0; axis < 3; axis++) {
        touch.velocity += touch.normal[axis] * (double)v[axis];
        approach += touch.normal[axis] * ((double)v[axis] - (double)c->velocity[axis]);
    }
    const double slowed = approach + overlap / c->substep;
    touch.target = slowed < 0 ? slowed : 0;
    touch.overlaps = overlap > 0;
    touch.active = touch.overlaps && approach < 0;
    return touch;
}

/* Finds the contacts. False: no memory. */
static bool find(const rheo__state *s, rheo__solids *solids, const constants *c, uint32_t *found)
{
    static rheo__near_function *const variants[] = RHEO__ALL_VARIANTS(near);
    rheo__near_function *const near_of = variants[rheo__simd_in_use()];
    const rheo_real reach2 = (rheo_real)(c->reach * c->reach);
    uint32_t count = 0;
    for (uint32_t first = 0; first < s->particles; first += RHEO__NEAR_AT_ONCE) {
        const uint32_t left = s->particles - first, tested = left < RHEO__NEAR_AT_ONCE ? left : RHEO__NEAR_AT_ONCE;
        uint64_t near = near_of(s->position + 3 * (size_t)first, tested, c->position, reach2);
        for (; near; near &= near - 1) {
            void *more = solids->touch;
            if (!rheo__grow(&solids->allocator, &more, &solids->touch_capacity, (size_t)count + 1, count,
                            sizeof *solids->touch))
                return false;
            solids->touch = more;
            solids->touch[count++] = contact(s, first + (uint32_t)__builtin_ctzll(near), c);
        }
    }
    *found = count;
    return true;
}

/* Tangential part of the velocity of a particle. */
static void sliding(const rheo__state *s, const rheo__touch *touch, double v[3])
{
    for (size_t axis = 0; axis < 3; axis++)
        v[axis] = (double)s->velocity[3 * (size_t)touch->id + axis] - touch->velocity * touch->normal[axis];
}

static void add_contact(equations *e, const rheo__state *s, const rheo__touch *touch, const constants *c)
{
    const double *n = touch->normal, share = c->share, radius = touch->distance;
    const double arm[3][3] = {{0, -radius * n[2], radius * n[1]}, /* matrix of (radius n) x */
                              {radius * n[2], 0, -radius * n[0]},
                              {-radius * n[1], radius * n[0], 0}};
    double tangential[3], turn[3];
    const double pushes = touch->active ? 1 : 0, normal = pushes * (touch->velocity - touch->target);
    sliding(s, touch, tangential);
    for (int i = 0; i < 3; i++)
        turn[i] = rheo__dot_double(arm[i], tangential);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const double along = (i == j) - n[i] * n[j];
            if (j <= i) {
                e->a[i][j] += pushes * n[i] * n[j] + share * along;
                e->a[3 + i][3 + j] += share * radius * radius * along;
            }
            e->a[3 + i][j] += share * arm[i][j];
        }
        e->b[i] += normal * n[i] + share * tangential[i];
        e->b[3 + i] += share * turn[i];
    }
}

/* Solves the equations by Cholesky's method; the solution is in e->b. */
static void solve(equations *e)
{
    for (int i = 0; i < 6; i++)
        for (int j = 0; j <= i; j++) {
            double sum = e->a[i][j];
            for (int k = 0; k < j; k++)
                sum -= e->a[i][k] * e->a[j][k];
            e->a[i][j] = i == j ? __builtin_sqrt(sum) : sum / e->a[j][j];
        }
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < i; k++)
            e->b[i] -= e->a[i][k] * e->b[k];
        e->b[i] /= e->a[i][i];
    }
    for (int i = 6; i-- > 0;) {
        for (int k = i + 1; k < 6; k++)
            e->b[i] -= e->a[k][i] * e->b[k];
        e->b[i] /= e->a[i][i];
    }
}

/* Velocity V and spin W after the contact, in result[0..2] and [3..5]. Drops contacts that would pull. */
static void collide(const rheo__state *s, rheo__solids *solids, uint32_t count, const constants *c, double result[6])
{
    for (int round = 0; round < ROUNDS; round++) {
        equations e = {{{0}}, {0}};
        for (int axis = 0; axis < 3; axis++) {
            e.a[axis][axis] = c->mass;
            e.b[axis] = c->mass * (double)c->velocity[axis];
            e.a[3 + axis][3 + axis] = c->inertia;
            e.b[3 + axis] = c->inertia * (double)c->spin[axis];
        }
        for (uint32_t k = 0; k < count; k++)
            add_contact(&e, s, &solids->touch[k], c);
        solve(&e);
        for (int i = 0; i < 6; i++)
            result[i] = e.b[i];
        bool changed = false;
        for (uint32_t k = 0; k < count; k++) {
            rheo__touch *touch = &solids->touch[k];
            const bool pushes =
                touch->overlaps && touch->target + rheo__dot_double(touch->normal, result) > touch->velocity;
            if (round + 1 < ROUNDS && pushes != touch->active) {
                touch->active = pushes;
                changed = true;
            }
        }
        if (!changed)
            return;
    }
}

/* Applies the impulse of a contact, and removes the overlap that is left. */
static void push(rheo__state *s, const rheo__touch *touch, const constants *c, const double result[6])
{
    const double *n = touch->normal;
    rheo_real *x = s->position + 3 * (size_t)touch->id, *v = s->velocity + 3 * (size_t)touch->id;
    const double arm[3] = {touch->distance * n[0], touch->distance * n[1], touch->distance * n[2]};
    const double ball = rheo__dot_double(n, result),
                 impulse = touch->active ? touch->target + ball - touch->velocity : 0;
    const bool accounts = rheo__has_account(s) && s->account->id == touch->id;
    double tangential[3], surface[3], direction[3];
    rheo_real gain[3], shift[3];
    sliding(s, touch, tangential);
    rheo__cross_double(result + 3, arm, surface);
    for (int axis = 0; axis < 3; axis++) {
        const double slide = tangential[axis] - (result[axis] - ball * n[axis]) - surface[axis];
        const double change = impulse * n[axis] - c->share * slide;
        gain[axis] = (rheo_real)change;
        shift[axis] = (rheo_real)(c->substep * change);
        v[axis] += gain[axis];
        x[axis] += shift[axis];
    }
    if (accounts) {
        rheo__account_add(s, RHEO__FIELD_velocity, RHEO_SOURCE_BALL, c->index, gain[0], gain[1], gain[2]);
        rheo__account_add(s, RHEO__FIELD_position, RHEO_SOURCE_BALL, c->index, shift[0], shift[1], shift[2]);
    }
    if (!(outward(s, touch->id, c, direction) < c->surface))
        return;
    for (int axis = 0; axis < 3; axis++)
        x[axis] = (rheo_real)((double)c->position[axis] + c->surface * direction[axis]);
    if (accounts)
        rheo__account_set(s, RHEO__FIELD_position, RHEO_SOURCE_BALL, c->index, x[0], x[1], x[2]);
}

/* False: no memory. */
static bool touch(rheo__state *s, rheo__solids *solids, uint32_t index)
{
    const rheo_ball *ball = rheo__ball_of(solids->def, index);
    const double radius = ball->radius, mass = (double)solids->ball_mass[index], substep = (double)*solids->substep;
    const double friction = ball->friction * substep;
    const constants c = {.index = index,
                         .position = s->ball_position + 3 * (size_t)index,
                         .velocity = s->ball_velocity + 3 * (size_t)index,
                         .spin = s->ball_spin + 3 * (size_t)index,
                         .radius = radius,
                         .surface = radius + solids->ball_distance,
                         .reach = radius + solids->friction_distance,
                         .mass = mass,
                         .inertia = 0.4 * mass * radius * radius,
                         .share = friction / (1 + friction),
                         .substep = substep};
    uint32_t count;
    if (!find(s, solids, &c, &count))
        return false;
    if (count == 0)
        return true;
    double result[6];
    collide(s, solids, count, &c, result);
    for (int axis = 0; axis < 3; axis++) {
        c.position[axis] += (rheo_real)(c.substep * (result[axis] - (double)c.velocity[axis]));
        c.velocity[axis] = (rheo_real)result[axis];
        c.spin[axis] = (rheo_real)result[3 + axis];
    }
    for (uint32_t k = 0; k < count; k++)
        push(s, &solids->touch[k], &c, result);
    return true;
}

rheo_result rheo__stage_ball(rheo__state *s, void *context)
{
    for (uint32_t index = 0; index < s->bodies; index++)
        if (!touch(s, context, index))
            return RHEO_ERROR_MEMORY;
    return RHEO_OK;
}
