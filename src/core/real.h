/*
 * Arithmetic on rheo_real: points of four values (16 bytes in float, loaded at once) and the square root, the only
 * function of libm that gives the same bits everywhere.
 */
#ifndef RHEO__CORE_REAL_H
#define RHEO__CORE_REAL_H

#include "core/strict.h"
#include "rheolog/base.h"

#if RHEO_DOUBLE
#define rheo__sqrt(x) __builtin_sqrt(x)
typedef uint64_t rheo__real_bits;
#else
#define rheo__sqrt(x) __builtin_sqrtf(x)
typedef uint32_t rheo__real_bits;
#endif

/* Converts a constant to rheo_real. */
#define RHEO__R(x) ((rheo_real)(x))

typedef struct rheo__point {
    rheo_real x, y, z, w;
} rheo__point;

/* Two points side by side, so that both can be loaded at once. */
typedef struct rheo__wide_point {
    rheo__point at, more;
} rheo__wide_point;

static inline rheo_real rheo__max(rheo_real a, rheo_real b)
{
    return a > b ? a : b;
}
static inline rheo_real rheo__min(rheo_real a, rheo_real b)
{
    return a < b ? a : b;
}
static inline rheo_real rheo__length2(rheo_real x, rheo_real y, rheo_real z)
{
    return x * x + y * y + z * z;
}

/*
 * Particle vectors into rank order and back into the order of ids. The point after the last one is set to 0,
 * as the operand of idle lanes.
 */
static inline void rheo__gather(rheo__point *to, const rheo_real *from, const uint32_t *id_of, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const rheo_real *v = from + 3 * (size_t)id_of[i];
        to[i] = (rheo__point){v[0], v[1], v[2], 0};
    }
    to[count] = (rheo__point){0, 0, 0, 0};
}
static inline void rheo__scatter(rheo_real *to, const rheo__point *from, const uint32_t *id_of, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        rheo_real *v = to + 3 * (size_t)id_of[i];
        v[0] = from[i].x;
        v[1] = from[i].y;
        v[2] = from[i].z;
    }
}

/* The point that a stage moved furthest. */
typedef struct rheo__moved {
    double length;
    double id; /* -1: nothing moved */
} rheo__moved;

/* Scatters points and finds the one that the stage moved furthest; `to` still has the old positions. */
static inline rheo__moved rheo__scatter_moved(rheo_real *to, const rheo__point *from, const uint32_t *id_of,
                                              uint32_t count)
{
    rheo_real most = 0;
    uint32_t furthest = count;
    for (uint32_t i = 0; i < count; i++) {
        rheo_real *v = to + 3 * (size_t)id_of[i];
        rheo_real length2 = rheo__length2(from[i].x - v[0], from[i].y - v[1], from[i].z - v[2]);
        if (length2 > most) {
            most = length2;
            furthest = i;
        }
        v[0] = from[i].x;
        v[1] = from[i].y;
        v[2] = from[i].z;
    }
    return (rheo__moved){rheo__sqrt(most), furthest < count ? (double)id_of[furthest] : -1};
}

/* Direction in which coinciding particles are separated: each axis takes three bits of the mixed ids. */
static inline void rheo__part_direction(uint32_t a, uint32_t b, rheo_real direction[3])
{
    uint32_t mixed = (a < b ? a : b) * UINT32_C(0x9E3779B1) ^ (a < b ? b : a) * UINT32_C(0x85EBCA77);
    for (int axis = 0; axis < 3; axis++)
        direction[axis] = (rheo_real)(mixed >> (29 - 3 * axis) & 7) - RHEO__R(3.5);
    rheo_real scale = (a < b ? 1 : -1) / rheo__sqrt(rheo__length2(direction[0], direction[1], direction[2]));
    for (int axis = 0; axis < 3; axis++)
        direction[axis] *= scale;
}

#endif
