/*
 * Periodic space (docs/model.md, Periodic space): along some axes the point x + period is the point x. Coordinates lie
 * about the origin, from -period/2 to period/2 whenever a neighbour list is made, and may leave that range until the next.
 *
 * Both rows of a pair must find the same distance to the last bit, but one of them sees x_j + period - x_i, the other
 * x_i - period - x_j. So stages take coordinates of periodic axes as multiples of one unit, as coarse as the numbers
 * near 2 periods are: all these sums are then exact.
 */
#ifndef RHEO__SPACE_PERIOD_H
#define RHEO__SPACE_PERIOD_H

#include "core/real.h"
#include "rheolog/world.h"

typedef struct rheo__period {
    rheo_real length[3]; /* a multiple of the unit; 0: space is open along this axis */
    rheo_real limit[3];  /* the least power of two that is not below the length; coordinates stay below it */
    uint32_t axes;       /* number of periodic axes */
} rheo__period;

void rheo__period_make(rheo__period *period, const rheo_world_def *def);

/* A coordinate of a periodic axis as a multiple of the unit; NaN if a particle has come too far since the last list. */
static inline rheo_real rheo__period_round(rheo_real x, rheo_real limit)
{
    if (!(x < limit && x > -limit))
        return (rheo_real)__builtin_nan("");
    return x < 0 ? (x - limit) + limit : (x + limit) - limit;
}

/* Number of periods by which x is away from the range about the origin; 0 for NaN and for what is very far. */
static inline double rheo__periods_away(double x, rheo_real length)
{
    const double turns = x / (double)length + 0.5;
    if (!(turns > -0x1p30 && turns < 0x1p30))
        return 0;
    const int64_t whole = (int64_t)turns;
    return (double)(whole - ((double)whole > turns));
}

/* The difference of two coordinates to the nearest image. Opposite for opposite differences, except at half a period. */
static inline rheo_real rheo__period_nearest(rheo_real difference, rheo_real length)
{
    const rheo_real half = length / 2;
    if (!(length > 0) || (difference <= half && difference >= -half))
        return difference;
    return (rheo_real)((double)difference - rheo__periods_away((double)difference, length) * (double)length);
}

/* The squared distance of b from a or its nearest image. Periods may be NULL. */
static inline rheo_real rheo__period_distance2(const rheo__period *period, const rheo_real *a, const rheo_real *b)
{
    rheo_real d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    for (int axis = 0; period && axis < 3; axis++)
        d[axis] = rheo__period_nearest(d[axis], period->length[axis]);
    return rheo__length2(d[0], d[1], d[2]);
}

/* Puts positions, 3 values each, into the range about the origin. */
void rheo__period_wrap(const rheo__period *period, rheo_real *position, size_t particles);

#endif
