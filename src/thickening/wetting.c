/*
 * Fluid along the ball (docs/model.md, Wetting). The sums over neighbours of a particle near the ball lack the share
 * of the space that the ball takes. Left out, the surface of the ball would act as a free surface: it would have a
 * tension that lifts the ball, and particles would press against the ball with less than the pressure of the fluid.
 * So the ball counts as fluid at rest of number density n, with the pressures of the particle itself:
 *
 *     rho += n A_2,  rho_near += n A_3,  A_m = integral of w^m
 *     a += n (P B_1 + P_near B_2) n_out, B_m = integral of w^m cos(angle with the normal)
 *
 * over the ball, with w = 1 - r/h. The ball takes the opposite forces; they are its buoyancy. A particle near several
 * balls has the shares of all of them.
 */
#include "core/account.h"
#include "thickening/continuum.h"
#include "thickening/thickening.h"

/* Integrals over the ball for a particle outside it at `distance` from its surface. */
static rheo__wetting_integrals integrate(double distance, double radius, double h)
{
    enum { INTERVALS = 64 };
    const double pi = 3.14159265358979323846;
    const double to_centre = radius + distance, from = distance, step = (h - from) / INTERVALS;
    double density = 0, near_density = 0, push = 0, near_push = 0;
    for (int i = 0; i <= INTERVALS; i++) {
        /* A sphere of radius r around the particle has the part 1 - c of its solid angle (over 2 pi) in the ball. */
        const double r = from + i * step, w = 1 - r / h,
                     simpson = (i == 0 || i == INTERVALS ? 1
                                : i % 2                  ? 4
                                                         : 2) *
                               step / 3;
        const double exact = r > 0 ? (to_centre * to_centre + r * r - radius * radius) / (2 * to_centre * r) : 0;
        const double c = exact > 1 ? 1 : exact < -1 ? -1 : exact;
        const double cap = simpson * 2 * pi * r * r * (1 - c), along = simpson * pi * r * r * (1 - c * c);
        density += w * w * cap;
        near_density += w * w * w * cap;
        push += w * along;
        near_push += w * w * along;
    }
    return (rheo__wetting_integrals){(rheo_real)density, (rheo_real)near_density, (rheo_real)push,
                                     (rheo_real)near_push};
}

void rheo__wetting_make(rheo__thickening *t)
{
    const double h = t->def->fluid.support, n = rheo__number_density(t->def);
    const uint32_t nodes = (t->def->ball.radius > 0 ? 1 + t->def->balls.count : 0) * RHEO__WETTING_NODES;
    for (uint32_t k = 0; k < nodes; k++) {
        const uint32_t index = k / RHEO__WETTING_NODES, node = k % RHEO__WETTING_NODES;
        const rheo__wetting_integrals of =
            integrate(node * h / (RHEO__WETTING_NODES - 1), rheo__ball_of(t->def, index)->radius, h);
        t->wetting[index][node] = (rheo__wetting_integrals){(rheo_real)n * of.density, (rheo_real)n * of.near_density,
                                                            (rheo_real)n * of.push, (rheo_real)n * of.near_push};
    }
}

static rheo__wetting_integrals look_up(const rheo__thickening *t, uint32_t ball, rheo_real distance)
{
    const rheo_real at = rheo__max(distance, 0) * (rheo_real)((RHEO__WETTING_NODES - 1) / t->def->fluid.support);
    const int node = (int)at < RHEO__WETTING_NODES - 1 ? (int)at : RHEO__WETTING_NODES - 2;
    const rheo_real b = at - (rheo_real)node, a = 1 - b;
    const rheo__wetting_integrals *low = &t->wetting[ball][node], *high = low + 1;
    return (rheo__wetting_integrals){a * low->density + b * high->density,
                                     a * low->near_density + b * high->near_density, a * low->push + b * high->push,
                                     a * low->near_push + b * high->near_push};
}

rheo_real rheo__wetting_reach(const rheo__thickening *t, uint32_t ball)
{
    return (rheo_real)rheo__ball_of(t->def, ball)->radius + (rheo_real)t->def->fluid.support;
}

bool rheo__wetting_find(const rheo__state *s, rheo__thickening *t, uint32_t ball, uint32_t rank, uint32_t count)
{
    const rheo_real *centre = s->ball_position + 3 * (size_t)ball,
                    radius = (rheo_real)rheo__ball_of(t->def, ball)->radius, reach = rheo__wetting_reach(t, ball),
                    reach2 = reach * reach;
    for (uint32_t i = rank; i < rank + count && i < t->pairs->rows; i++) {
        const rheo__point *x = &t->point[i].at;
        const rheo_real d[3] = {x->x - centre[0], x->y - centre[1], x->z - centre[2]},
                        r2 = rheo__length2(d[0], d[1], d[2]);
        if (!(r2 < reach2 && r2 > 0))
            continue;
        void *wet = t->wet;
        if (!rheo__grow(&t->allocator, &wet, &t->wet_capacity, (size_t)t->wet_count + 1, t->wet_count,
                        sizeof *t->wet))
            return false;
        t->wet = wet;
        const rheo_real r = rheo__sqrt(r2);
        t->wet[t->wet_count++] = (rheo__wet){i, ball, {d[0] / r, d[1] / r, d[2] / r}, look_up(t, ball, r - radius)};
    }
    return true;
}

void rheo__wetting_push(rheo__state *s, rheo__thickening *t)
{
    double sums[RHEO_MAX_BALLS][3] = {{0, 0, 0}};
    for (uint32_t k = 0; k < t->wet_count; k++) {
        const rheo__wet *wet = &t->wet[k];
        const rheo_real push = 2 * (t->point[wet->rank].at.w * wet->integrals.push +
                                    t->point[wet->rank].more.x * wet->integrals.near_push);
        rheo__point *a = &t->pressure_acceleration[wet->rank];
        if (rheo__has_account(s) && t->pairs->id_of[wet->rank] == s->account->id)
            rheo__account_add(s, RHEO__SUM_pressure, RHEO_SOURCE_BALL, wet->ball, push * wet->normal[0],
                              push * wet->normal[1], push * wet->normal[2]);
        a->x += push * wet->normal[0];
        a->y += push * wet->normal[1];
        a->z += push * wet->normal[2];
        for (int axis = 0; axis < 3; axis++)
            sums[wet->ball][axis] += (double)(push * wet->normal[axis]);
    }
    for (uint32_t ball = 0; ball < s->bodies; ball++) {
        const double step = (double)t->substep, by = step / (double)t->ball_mass[ball], *sum = sums[ball];
        rheo_real *x = s->ball_position + 3 * (size_t)ball, *v = s->ball_velocity + 3 * (size_t)ball;
        for (int axis = 0; axis < 3; axis++) {
            v[axis] -= (rheo_real)(by * sum[axis]);
            x[axis] -= (rheo_real)(step * by * sum[axis]);
        }
    }
}
