/*
 * Lanes: RHEO_LANES numbers side by side, in GCC and Clang vector types or, where there is one lane, plain numbers.
 * Every operation acts on each lane alone, in IEEE arithmetic, so a lane's result has the bits of the same scalar
 * code on any machine; how many lanes there are makes no difference. Where numbers of several lanes are added, the
 * kernel says in which order.
 *
 * Intrinsics stand only for the square root, which neither compiler makes of a loop, beside its portable twin.
 */
#ifndef RHEO_CORE_LANES_H
#define RHEO_CORE_LANES_H

#include <string.h>

#include "core/real.h"

#ifndef RHEO_LANES
#error "RHEO_LANES is set for each target that kernels are built for"
#endif
#define RHEO_VECTOR_BYTES (RHEO_LANES * (RHEO_DOUBLE ? 8 : 4))

#if RHEO_DOUBLE
typedef int64_t rheo_lane_index;
#else
typedef int32_t rheo_lane_index;
#endif

#if RHEO_LANES == 1

typedef rheo_real rheo_lanes;
typedef rheo_lane_index rheo_mask; /* 1 where true */
#define RHEO_LANE(vector, lane) (*((void)(lane), &(vector)))

typedef uint32_t rheo_ranks;

static inline rheo_ranks rheo_ranks_min(rheo_ranks a, uint32_t b)
{
    return a < b ? a : b;
}
static inline rheo_lanes rheo_lanes_select(rheo_mask mask, rheo_lanes where_true, rheo_lanes where_false)
{
    return mask ? where_true : where_false;
}
static inline rheo_lanes rheo_lanes_keep(rheo_mask mask, rheo_lanes value)
{
    return mask ? value : 0;
}
static inline bool rheo_lanes_any(rheo_mask mask)
{
    return mask;
}
static inline rheo_lanes rheo_lanes_sqrt(rheo_lanes a)
{
    return rheo_sqrt(a);
}

#else

typedef rheo_real rheo_lanes __attribute__((vector_size(RHEO_VECTOR_BYTES)));
typedef rheo_lane_index rheo_mask __attribute__((vector_size(RHEO_VECTOR_BYTES))); /* -1 where true */
#define RHEO_LANE(vector, lane) ((vector)[lane])

typedef uint32_t rheo_ranks __attribute__((vector_size(RHEO_LANES * sizeof(uint32_t))));

/* Of numbers below 2^31, which all machines can compare. */
static inline rheo_ranks rheo_ranks_min(rheo_ranks a, uint32_t b)
{
    typedef int32_t whole __attribute__((vector_size(RHEO_LANES * sizeof(int32_t))));
    whole less = (whole)a < (int32_t)b;
    return (a & (rheo_ranks)less) | (b & ~(rheo_ranks)less);
}
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
static inline bool rheo_lanes_any(rheo_mask mask)
{
    uint64_t word[RHEO_VECTOR_BYTES / 8], any = 0;
    memcpy(word, &mask, sizeof word);
    for (int i = 0; i < RHEO_VECTOR_BYTES / 8; i++)
        any |= word[i];
    return any != 0;
}

#if defined(__AVX512F__) && RHEO_VECTOR_BYTES == 64
#include <immintrin.h>
#if RHEO_DOUBLE
#define RHEO_SQRT(a) _mm512_sqrt_pd((__m512d)(a))
#else
#define RHEO_SQRT(a) _mm512_sqrt_ps((__m512)(a))
#endif
#elif defined(__AVX__) && RHEO_VECTOR_BYTES == 32
#include <immintrin.h>
#if RHEO_DOUBLE
#define RHEO_SQRT(a) _mm256_sqrt_pd((__m256d)(a))
#else
#define RHEO_SQRT(a) _mm256_sqrt_ps((__m256)(a))
#endif
#elif defined(__SSE2__) && RHEO_VECTOR_BYTES == 16
#include <emmintrin.h>
#define RHEO_SQRT(a) _mm_sqrt_ps((__m128)(a))
#elif defined(__aarch64__) && RHEO_VECTOR_BYTES == 16
#include <arm_neon.h>
#define RHEO_SQRT(a) vsqrtq_f32((float32x4_t)(a))
#endif

static inline rheo_lanes rheo_lanes_sqrt(rheo_lanes a)
{
#ifdef RHEO_SQRT
    return (rheo_lanes)RHEO_SQRT(a);
#else
    for (int lane = 0; lane < RHEO_LANES; lane++)
        a[lane] = rheo_sqrt(a[lane]);
    return a;
#endif
}

#endif

static inline rheo_lanes rheo_lanes_all(rheo_real value)
{
    return value - (rheo_lanes){0}; /* (x + 0 would lose a -0) */
}
static inline rheo_lanes rheo_lanes_max(rheo_lanes a, rheo_lanes b)
{
    return rheo_lanes_select(a > b, a, b);
}
static inline rheo_lanes rheo_lanes_min(rheo_lanes a, rheo_lanes b)
{
    return rheo_lanes_select(a < b, a, b);
}

/* Values at places of their own, one in each lane. */
static inline rheo_lanes rheo_lanes_values(const rheo_real *v, const uint32_t at[RHEO_LANES])
{
#if RHEO_LANES == 1
    return v[at[0]];
#elif RHEO_LANES == 4
    return (rheo_lanes){v[at[0]], v[at[1]], v[at[2]], v[at[3]]};
#elif RHEO_LANES == 8
    return (rheo_lanes){v[at[0]], v[at[1]], v[at[2]], v[at[3]], v[at[4]], v[at[5]], v[at[6]], v[at[7]]};
#else
    return (rheo_lanes){v[at[0]], v[at[1]], v[at[2]],  v[at[3]],  v[at[4]],  v[at[5]],  v[at[6]],  v[at[7]],
                        v[at[8]], v[at[9]], v[at[10]], v[at[11]], v[at[12]], v[at[13]], v[at[14]], v[at[15]]};
#endif
}

/* ---- Points, one in each lane ---- */

typedef struct rheo_lanes3 {
    rheo_lanes x, y, z;
} rheo_lanes3;

static inline rheo_lanes3 rheo_lanes3_minus(rheo_lanes3 to, rheo_lanes3 by)
{
    return (rheo_lanes3){to.x - by.x, to.y - by.y, to.z - by.z};
}
/* 0 where the mask is false: taking it away leaves every bit, -0 too, as it is. */
static inline rheo_lanes3 rheo_lanes3_keep(rheo_mask mask, rheo_lanes3 value)
{
    return (rheo_lanes3){rheo_lanes_keep(mask, value.x), rheo_lanes_keep(mask, value.y),
                         rheo_lanes_keep(mask, value.z)};
}

/*
 * Points are loaded whole and turned over, as rows of a matrix into columns: groups of four lanes side by side in
 * wide vectors. SHUFFLE takes lane numbers of one group; those of the second vector start at 4.
 */
#if (defined(__clang__) || __GNUC__ >= 12) && (RHEO_LANES == 4 || RHEO_LANES == 8 || RHEO_LANES == 16)
typedef rheo_real rheo_quad __attribute__((vector_size(4 * sizeof(rheo_real))));

static inline rheo_quad rheo_quad_load(const rheo_point *point)
{
    rheo_quad quad;
    memcpy(&quad, point, sizeof quad);
    return quad;
}
static inline void rheo_quad_store(rheo_point *point, rheo_quad quad)
{
    memcpy(point, &quad, sizeof quad);
}

#if RHEO_LANES == 4
#define RHEO_SHUFFLE(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#elif RHEO_LANES == 8
#define RHEO_GROUP(n, of) ((n) % 4 + ((n) < 4 ? 0 : 8) + 4 * (of))
#define RHEO_SHUFFLE(a, b, i, j, k, l)                                                                    \
    __builtin_shufflevector(a, b, RHEO_GROUP(i, 0), RHEO_GROUP(j, 0), RHEO_GROUP(k, 0), RHEO_GROUP(l, 0), \
                            RHEO_GROUP(i, 1), RHEO_GROUP(j, 1), RHEO_GROUP(k, 1), RHEO_GROUP(l, 1))
#else
#define RHEO_GROUP(n, of) ((n) % 4 + ((n) < 4 ? 0 : 16) + 4 * (of))
#define RHEO_SHUFFLE(a, b, i, j, k, l)                                                                    \
    __builtin_shufflevector(a, b, RHEO_GROUP(i, 0), RHEO_GROUP(j, 0), RHEO_GROUP(k, 0), RHEO_GROUP(l, 0), \
                            RHEO_GROUP(i, 1), RHEO_GROUP(j, 1), RHEO_GROUP(k, 1), RHEO_GROUP(l, 1),       \
                            RHEO_GROUP(i, 2), RHEO_GROUP(j, 2), RHEO_GROUP(k, 2), RHEO_GROUP(l, 2),       \
                            RHEO_GROUP(i, 3), RHEO_GROUP(j, 3), RHEO_GROUP(k, 3), RHEO_GROUP(l, 3))
#endif

/* The points of the lanes n, n + 4, n + 8, ..., one behind the other. */
static inline rheo_lanes rheo_lanes_collect(const rheo_point *point, const uint32_t index[RHEO_LANES], int n)
{
#if RHEO_LANES == 4
    return rheo_quad_load(point + index[n]);
#else
    rheo_quad a = rheo_quad_load(point + index[n]), b = rheo_quad_load(point + index[n + 4]);
    __typeof__(__builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7)) ab =
        __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
#if RHEO_LANES == 8
    return ab;
#else
    rheo_quad c = rheo_quad_load(point + index[n + 8]), d = rheo_quad_load(point + index[n + 12]);
    __typeof__(ab) cd = __builtin_shufflevector(c, d, 0, 1, 2, 3, 4, 5, 6, 7);
    return __builtin_shufflevector(ab, cd, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#endif
#endif
}
static inline void rheo_lanes_spread(rheo_point *point, const uint32_t index[RHEO_LANES], int n, rheo_lanes points)
{
#if RHEO_LANES == 4
    rheo_quad_store(point + index[n], points);
#else
    rheo_quad_store(point + index[n], __builtin_shufflevector(points, points, 0, 1, 2, 3));
    rheo_quad_store(point + index[n + 4], __builtin_shufflevector(points, points, 4, 5, 6, 7));
#if RHEO_LANES == 16
    rheo_quad_store(point + index[n + 8], __builtin_shufflevector(points, points, 8, 9, 10, 11));
    rheo_quad_store(point + index[n + 12], __builtin_shufflevector(points, points, 12, 13, 14, 15));
#endif
#endif
}

static inline rheo_lanes3 rheo_lanes_load_w(const rheo_point *point, const uint32_t index[RHEO_LANES], rheo_lanes *w)
{
    rheo_lanes a = rheo_lanes_collect(point, index, 0), b = rheo_lanes_collect(point, index, 1),
               c = rheo_lanes_collect(point, index, 2), d = rheo_lanes_collect(point, index, 3);
    rheo_lanes ab = RHEO_SHUFFLE(a, b, 0, 4, 1, 5), cd = RHEO_SHUFFLE(c, d, 0, 4, 1, 5);
    rheo_lanes ab_z = RHEO_SHUFFLE(a, b, 2, 6, 3, 7), cd_z = RHEO_SHUFFLE(c, d, 2, 6, 3, 7);
    *w = RHEO_SHUFFLE(ab_z, cd_z, 2, 3, 6, 7);
    return (rheo_lanes3){RHEO_SHUFFLE(ab, cd, 0, 1, 4, 5), RHEO_SHUFFLE(ab, cd, 2, 3, 6, 7),
                         RHEO_SHUFFLE(ab_z, cd_z, 0, 1, 4, 5)};
}
static inline void rheo_lanes_store_w(rheo_point *point, const uint32_t index[RHEO_LANES], rheo_lanes3 value,
                                      rheo_lanes w)
{
    rheo_lanes xy01 = RHEO_SHUFFLE(value.x, value.y, 0, 4, 1, 5), xy23 = RHEO_SHUFFLE(value.x, value.y, 2, 6, 3, 7);
    rheo_lanes z01 = RHEO_SHUFFLE(value.z, w, 0, 4, 1, 5), z23 = RHEO_SHUFFLE(value.z, w, 2, 6, 3, 7);
    rheo_lanes_spread(point, index, 0, RHEO_SHUFFLE(xy01, z01, 0, 1, 4, 5));
    rheo_lanes_spread(point, index, 1, RHEO_SHUFFLE(xy01, z01, 2, 3, 6, 7));
    rheo_lanes_spread(point, index, 2, RHEO_SHUFFLE(xy23, z23, 0, 1, 4, 5));
    rheo_lanes_spread(point, index, 3, RHEO_SHUFFLE(xy23, z23, 2, 3, 6, 7));
}
#else
static inline rheo_lanes3 rheo_lanes_load_w(const rheo_point *point, const uint32_t index[RHEO_LANES], rheo_lanes *w)
{
    rheo_lanes3 value;
    for (int lane = 0; lane < RHEO_LANES; lane++) {
        RHEO_LANE(value.x, lane) = point[index[lane]].x;
        RHEO_LANE(value.y, lane) = point[index[lane]].y;
        RHEO_LANE(value.z, lane) = point[index[lane]].z;
        RHEO_LANE(*w, lane) = point[index[lane]].w;
    }
    return value;
}
static inline void rheo_lanes_store_w(rheo_point *point, const uint32_t index[RHEO_LANES], rheo_lanes3 value,
                                      rheo_lanes w)
{
    for (int lane = 0; lane < RHEO_LANES; lane++)
        point[index[lane]] = (rheo_point){RHEO_LANE(value.x, lane), RHEO_LANE(value.y, lane),
                                          RHEO_LANE(value.z, lane), RHEO_LANE(w, lane)};
}
#endif
static inline rheo_lanes3 rheo_lanes_load(const rheo_point *point, const uint32_t index[RHEO_LANES])
{
    rheo_lanes w;
    return rheo_lanes_load_w(point, index, &w);
}
/* Two lanes may store to the same point only where it does not matter which of them wins. w becomes 0. */
static inline void rheo_lanes_store(rheo_point *point, const uint32_t index[RHEO_LANES], rheo_lanes3 value)
{
    rheo_lanes_store_w(point, index, value, (rheo_lanes){0});
}

#endif
