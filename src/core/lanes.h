/*
 * Lanes: four numbers side by side, in GCC and Clang vector types. Every operation acts on each lane alone, in IEEE
 * arithmetic, so a lane's result has the bits of the same scalar code on any machine; how many lanes a machine has
 * makes no difference. Intrinsics stand only for the square root, which neither compiler makes of a loop, beside its
 * portable twin (RHEO_PLAIN_LANES builds with the twin alone).
 */
#ifndef RHEO_CORE_LANES_H
#define RHEO_CORE_LANES_H

#include <string.h>

#include "core/real.h"

#if defined(__SSE2__) && !RHEO_DOUBLE && !defined(RHEO_PLAIN_LANES)
#include <emmintrin.h>
#define RHEO_SQRT_SSE2 1
#endif

enum { RHEO_LANES = 4 };

typedef rheo_real rheo_lanes __attribute__((vector_size(RHEO_LANES * sizeof(rheo_real))));
#if RHEO_DOUBLE
typedef int64_t rheo_mask __attribute__((vector_size(RHEO_LANES * sizeof(rheo_real))));
typedef int64_t rheo_lane_index;
#else
typedef int32_t rheo_mask __attribute__((vector_size(RHEO_LANES * sizeof(rheo_real))));
typedef int32_t rheo_lane_index;
#endif

/* Comparisons give -1 where true, 0 where false. */
static inline rheo_lanes rheo_lanes_select(rheo_mask mask, rheo_lanes where_true, rheo_lanes where_false)
{
    return (rheo_lanes)(((rheo_mask)where_true & mask) | ((rheo_mask)where_false & ~mask));
}
/* 0 where the mask is false. */
static inline rheo_lanes rheo_lanes_keep(rheo_mask mask, rheo_lanes value)
{
    return (rheo_lanes)((rheo_mask)value & mask);
}
static inline rheo_lanes rheo_lanes_max(rheo_lanes a, rheo_lanes b)
{
    return rheo_lanes_select(a > b, a, b);
}
static inline rheo_lanes rheo_lanes_min(rheo_lanes a, rheo_lanes b)
{
    return rheo_lanes_select(a < b, a, b);
}

static inline rheo_lanes rheo_lanes_sqrt(rheo_lanes a)
{
#ifdef RHEO_SQRT_SSE2
    return (rheo_lanes)_mm_sqrt_ps((__m128)a);
#else
    return (rheo_lanes){rheo_sqrt(a[0]), rheo_sqrt(a[1]), rheo_sqrt(a[2]), rheo_sqrt(a[3])};
#endif
}

/* Three coordinates, each in four lanes. */
typedef struct rheo_lanes3 {
    rheo_lanes x, y, z;
} rheo_lanes3;

#if defined(__clang__) || __GNUC__ >= 12
#define RHEO_SHUFFLE(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#else
#define RHEO_SHUFFLE(a, b, i, j, k, l) __builtin_shuffle(a, b, (rheo_mask){i, j, k, l})
#endif

/* Four points, one a lane. */
static inline rheo_lanes3 rheo_lanes_load(const rheo_point *point, const uint32_t index[RHEO_LANES])
{
    rheo_lanes a, b, c, d;
    memcpy(&a, point + index[0], sizeof a);
    memcpy(&b, point + index[1], sizeof b);
    memcpy(&c, point + index[2], sizeof c);
    memcpy(&d, point + index[3], sizeof d);
    rheo_lanes ab = RHEO_SHUFFLE(a, b, 0, 4, 1, 5), cd = RHEO_SHUFFLE(c, d, 0, 4, 1, 5);
    rheo_lanes ab_z = RHEO_SHUFFLE(a, b, 2, 6, 3, 7), cd_z = RHEO_SHUFFLE(c, d, 2, 6, 3, 7);
    return (rheo_lanes3){RHEO_SHUFFLE(ab, cd, 0, 1, 4, 5), RHEO_SHUFFLE(ab, cd, 2, 3, 6, 7),
                         RHEO_SHUFFLE(ab_z, cd_z, 0, 1, 4, 5)};
}
/* Two lanes may name the same point only where it does not matter which of them wins. */
static inline void rheo_lanes_store(rheo_point *point, const uint32_t index[RHEO_LANES], rheo_lanes3 value)
{
    rheo_lanes zero = {0};
    rheo_lanes xy01 = RHEO_SHUFFLE(value.x, value.y, 0, 4, 1, 5), xy23 = RHEO_SHUFFLE(value.x, value.y, 2, 6, 3, 7);
    rheo_lanes z01 = RHEO_SHUFFLE(value.z, zero, 0, 4, 1, 5), z23 = RHEO_SHUFFLE(value.z, zero, 2, 6, 3, 7);
    rheo_lanes a = RHEO_SHUFFLE(xy01, z01, 0, 1, 4, 5), b = RHEO_SHUFFLE(xy01, z01, 2, 3, 6, 7);
    rheo_lanes c = RHEO_SHUFFLE(xy23, z23, 0, 1, 4, 5), d = RHEO_SHUFFLE(xy23, z23, 2, 3, 6, 7);
    memcpy(point + index[0], &a, sizeof a);
    memcpy(point + index[1], &b, sizeof b);
    memcpy(point + index[2], &c, sizeof c);
    memcpy(point + index[3], &d, sizeof d);
}

#endif
