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

/* A coordinate in the range about the origin. */
static inline rheo_real rheo__period_wrapped(rheo_real x, rheo_real length)
{
    return (rheo_real)((double)x - rheo__periods_away((double)x, length) * (double)length);
}

/* The squared distance of b from a or its nearest image. */
static inline rheo_real rheo__period_distance2(const rheo__period *period, const rheo_real *a, const rheo_real *b)
{
    rheo_real d[3];
    for (int axis = 0; axis < 3; axis++) {
        const rheo_real length = period->length[axis], half = length / 2;
        if (!(length > 0)) {
            d[axis] = b[axis] - a[axis];
            continue;
        }
        d[axis] = rheo__period_wrapped(b[axis], length) - rheo__period_wrapped(a[axis], length);
        d[axis] = d[axis] > half ? d[axis] - length : d[axis] < -half ? d[axis] + length : d[axis];
    }
    return rheo__length2(d[0], d[1], d[2]);
}

/* Puts positions, 3 values each, into the range about the origin. */
void rheo__period_wrap(const rheo__period *period, rheo_real *position, size_t particles);

#endif
