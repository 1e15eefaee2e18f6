/*
 * Lanes: RHEO__LANES numbers side by side, in GCC and Clang vector types, or plain numbers if there is one lane.
 * Every operation acts on each lane separately, in IEEE arithmetic. So a lane has the bits of the same scalar code on
 * any machine, for any number of lanes. Where numbers of several lanes are added, the
 * stage defines the order.
 *
 * Only the square root uses intrinsics, since no compiler generates it from a loop; it also has a portable form.
 */
#ifndef RHEO__CORE_LANES_H
#define RHEO__CORE_LANES_H

#include <string.h>

#include "core/real.h"

#ifndef RHEO__LANES
#error "RHEO__LANES is set for each SIMD variant"
#endif
#define RHEO__VECTOR_BYTES (RHEO__LANES * (RHEO_DOUBLE ? 8 : 4))

#if RHEO_DOUBLE
typedef int64_t rheo__lane_index;
#else
typedef int32_t rheo__lane_index;
#endif

#if RHEO__LANES == 1

typedef rheo_real rheo__lanes;
typedef rheo__lane_index rheo__mask; /* 1 where true */
#define RHEO__LANE(vector, lane) (*((void)(lane), &(vector)))

typedef uint32_t rheo__ranks;

static inline rheo__ranks rheo__ranks_min(rheo__ranks a, uint32_t b)
{
    return a < b ? a : b;
}
static inline rheo__lanes rheo__lanes_select(rheo__mask mask, rheo__lanes where_true, rheo__lanes where_false)
{
    return mask ? where_true : where_false;
}
static inline rheo__lanes rheo__lanes_keep(rheo__mask mask, rheo__lanes value)
{
    return mask ? value : 0;
}
static inline bool rheo__lanes_any(rheo__mask mask)
{
    return mask;
}
static inline rheo__lanes rheo__lanes_sqrt(rheo__lanes a)
{
    return rheo__sqrt(a);
}

#else

typedef rheo_real rheo__lanes __attribute__((vector_size(RHEO__VECTOR_BYTES)));
typedef rheo__lane_index rheo__mask __attribute__((vector_size(RHEO__VECTOR_BYTES))); /* -1 where true */
#define RHEO__LANE(vector, lane) ((vector)[lane])

typedef uint32_t rheo__ranks __attribute__((vector_size(RHEO__LANES * sizeof(uint32_t))));

/* Minimum. The numbers must be below 2^31, which all machines can compare. */
static inline rheo__ranks rheo__ranks_min(rheo__ranks a, uint32_t b)
{
    typedef int32_t whole __attribute__((vector_size(RHEO__LANES * sizeof(int32_t))));
    whole less = (whole)a < (int32_t)b;
    return (a & (rheo__ranks)less) | (b & ~(rheo__ranks)less);
}
/* Comparisons give -1 where true, 0 where false. */
static inline rheo__lanes rheo__lanes_select(rheo__mask mask, rheo__lanes where_true, rheo__lanes where_false)
{
    return (rheo__lanes)(((rheo__mask)where_true & mask) | ((rheo__mask)where_false & ~mask));
}
/* `value` where the mask is true, else 0. */
static inline rheo__lanes rheo__lanes_keep(rheo__mask mask, rheo__lanes value)
{
    return (rheo__lanes)((rheo__mask)value & mask);
}
static inline bool rheo__lanes_any(rheo__mask mask)
{
    uint64_t word[RHEO__VECTOR_BYTES / 8], any = 0;
    memcpy(word, &mask, sizeof word);
    for (int i = 0; i < RHEO__VECTOR_BYTES / 8; i++)
        any |= word[i];
    return any != 0;
}

#if defined(__AVX512F__) && RHEO__VECTOR_BYTES == 64
#include <immintrin.h>
#if RHEO_DOUBLE
#define RHEO__SQRT(a) _mm512_sqrt_pd((__m512d)(a))
#else
#define RHEO__SQRT(a) _mm512_sqrt_ps((__m512)(a))
#endif
#elif defined(__AVX__) && RHEO__VECTOR_BYTES == 32
#include <immintrin.h>
#if RHEO_DOUBLE
#define RHEO__SQRT(a) _mm256_sqrt_pd((__m256d)(a))
#else
#define RHEO__SQRT(a) _mm256_sqrt_ps((__m256)(a))
#endif
#elif defined(__SSE2__) && RHEO__VECTOR_BYTES == 16
#include <emmintrin.h>
#define RHEO__SQRT(a) _mm_sqrt_ps((__m128)(a))
#elif defined(__aarch64__) && RHEO__VECTOR_BYTES == 16
#include <arm_neon.h>
#define RHEO__SQRT(a) vsqrtq_f32((float32x4_t)(a))
#endif

static inline rheo__lanes rheo__lanes_sqrt(rheo__lanes a)
{
#ifdef RHEO__SQRT
    return (rheo__lanes)RHEO__SQRT(a);
#else
    for (int lane = 0; lane < RHEO__LANES; lane++)
        a[lane] = rheo__sqrt(a[lane]);
    return a;
#endif
}

#endif

static inline rheo__lanes rheo__lanes_all(rheo_real value)
{
    return value - (rheo__lanes){0}; /* (x + 0 would lose a -0) */
}
static inline rheo__lanes rheo__lanes_max(rheo__lanes a, rheo__lanes b)
{
    return rheo__lanes_select(a > b, a, b);
}
static inline rheo__lanes rheo__lanes_min(rheo__lanes a, rheo__lanes b)
{
    return rheo__lanes_select(a < b, a, b);
}

/* Loads one value for each lane. */
static inline rheo__lanes rheo__lanes_values(const rheo_real *v, const uint32_t at[RHEO__LANES])
{
#if RHEO__LANES == 1
    return v[at[0]];
#elif RHEO__LANES == 4
    return (rheo__lanes){v[at[0]], v[at[1]], v[at[2]], v[at[3]]};
#elif RHEO__LANES == 8
    return (rheo__lanes){v[at[0]], v[at[1]], v[at[2]], v[at[3]], v[at[4]], v[at[5]], v[at[6]], v[at[7]]};
#else
    return (rheo__lanes){v[at[0]], v[at[1]], v[at[2]],  v[at[3]],  v[at[4]],  v[at[5]],  v[at[6]],  v[at[7]],
                         v[at[8]], v[at[9]], v[at[10]], v[at[11]], v[at[12]], v[at[13]], v[at[14]], v[at[15]]};
#endif
}

/* ---- Points, one in each lane ---- */

typedef struct rheo__lanes3 {
    rheo__lanes x, y, z;
} rheo__lanes3;

static inline rheo__lanes3 rheo__lanes3_minus(rheo__lanes3 to, rheo__lanes3 by)
{
    return (rheo__lanes3){to.x - by.x, to.y - by.y, to.z - by.z};
}
/* `value` where the mask is true, else 0. Subtracting the 0 changes no bit, not even of -0. */
static inline rheo__lanes3 rheo__lanes3_keep(rheo__mask mask, rheo__lanes3 value)
{
    return (rheo__lanes3){rheo__lanes_keep(mask, value.x), rheo__lanes_keep(mask, value.y),
                          rheo__lanes_keep(mask, value.z)};
}

/*
 * Points are loaded whole and transposed, like the rows of a matrix, in groups of four lanes; wide vectors hold
 * several groups. SHUFFLE takes lane numbers of one group; those of the second vector start at 4.
 */
#if (defined(__clang__) || __GNUC__ >= 12) && (RHEO__LANES == 4 || RHEO__LANES == 8 || RHEO__LANES == 16)
typedef rheo_real rheo__quad __attribute__((vector_size(4 * sizeof(rheo_real))));

static inline rheo__quad rheo__quad_load(const rheo__point *point)
{
    rheo__quad quad;
    memcpy(&quad, point, sizeof quad);
    return quad;
}
static inline void rheo__quad_store(rheo__point *point, rheo__quad quad)
{
    memcpy(point, &quad, sizeof quad);
}

#if RHEO__LANES == 4
#define RHEO__SHUFFLE(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, k, l)
#elif RHEO__LANES == 8
#define RHEO__GROUP(n, of) ((n) % 4 + ((n) < 4 ? 0 : 8) + 4 * (of))
#define RHEO__SHUFFLE(a, b, i, j, k, l)                                                                       \
    __builtin_shufflevector(a, b, RHEO__GROUP(i, 0), RHEO__GROUP(j, 0), RHEO__GROUP(k, 0), RHEO__GROUP(l, 0), \
                            RHEO__GROUP(i, 1), RHEO__GROUP(j, 1), RHEO__GROUP(k, 1), RHEO__GROUP(l, 1))
#else
#define RHEO__GROUP(n, of) ((n) % 4 + ((n) < 4 ? 0 : 16) + 4 * (of))
#define RHEO__SHUFFLE(a, b, i, j, k, l)                                                                       \
    __builtin_shufflevector(a, b, RHEO__GROUP(i, 0), RHEO__GROUP(j, 0), RHEO__GROUP(k, 0), RHEO__GROUP(l, 0), \
                            RHEO__GROUP(i, 1), RHEO__GROUP(j, 1), RHEO__GROUP(k, 1), RHEO__GROUP(l, 1),       \
                            RHEO__GROUP(i, 2), RHEO__GROUP(j, 2), RHEO__GROUP(k, 2), RHEO__GROUP(l, 2),       \
                            RHEO__GROUP(i, 3), RHEO__GROUP(j, 3), RHEO__GROUP(k, 3), RHEO__GROUP(l, 3))
#endif

/* Loads the points of the lanes n, n + 4, n + 8, ... one after another. */
static inline rheo__lanes rheo__lanes_collect(const rheo__point *point, const uint32_t index[RHEO__LANES], int n)
{
#if RHEO__LANES == 4
    return rheo__quad_load(point + index[n]);
#else
    rheo__quad a = rheo__quad_load(point + index[n]), b = rheo__quad_load(point + index[n + 4]);
    __typeof__(__builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7)) ab =
        __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
#if RHEO__LANES == 8
    return ab;
#else
    rheo__quad c = rheo__quad_load(point + index[n + 8]), d = rheo__quad_load(point + index[n + 12]);
    __typeof__(ab) cd = __builtin_shufflevector(c, d, 0, 1, 2, 3, 4, 5, 6, 7);
    return __builtin_shufflevector(ab, cd, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#endif
#endif
}
static inline void rheo__lanes_spread(rheo__point *point, const uint32_t index[RHEO__LANES], int n,
                                      rheo__lanes points)
{
#if RHEO__LANES == 4
    rheo__quad_store(point + index[n], points);
#else
    rheo__quad_store(point + index[n], __builtin_shufflevector(points, points, 0, 1, 2, 3));
    rheo__quad_store(point + index[n + 4], __builtin_shufflevector(points, points, 4, 5, 6, 7));
#if RHEO__LANES == 16
    rheo__quad_store(point + index[n + 8], __builtin_shufflevector(points, points, 8, 9, 10, 11));
    rheo__quad_store(point + index[n + 12], __builtin_shufflevector(points, points, 12, 13, 14, 15));
#endif
#endif
}

static inline rheo__lanes3 rheo__lanes_load_w(const rheo__point *point, const uint32_t index[RHEO__LANES],
                                              rheo__lanes *w)
{
    rheo__lanes a = rheo__lanes_collect(point, index, 0), b = rheo__lanes_collect(point, index, 1),
                c = rheo__lanes_collect(point, index, 2), d = rheo__lanes_collect(point, index, 3);
    rheo__lanes ab = RHEO__SHUFFLE(a, b, 0, 4, 1, 5), cd = RHEO__SHUFFLE(c, d, 0, 4, 1, 5);
    rheo__lanes ab_z = RHEO__SHUFFLE(a, b, 2, 6, 3, 7), cd_z = RHEO__SHUFFLE(c, d, 2, 6, 3, 7);
    *w = RHEO__SHUFFLE(ab_z, cd_z, 2, 3, 6, 7);
    return (rheo__lanes3){RHEO__SHUFFLE(ab, cd, 0, 1, 4, 5), RHEO__SHUFFLE(ab, cd, 2, 3, 6, 7),
                          RHEO__SHUFFLE(ab_z, cd_z, 0, 1, 4, 5)};
}
static inline void rheo__lanes_store_w(rheo__point *point, const uint32_t index[RHEO__LANES], rheo__lanes3 value,
                                       rheo__lanes w)
{
    rheo__lanes xy01 = RHEO__SHUFFLE(value.x, value.y, 0, 4, 1, 5),
                xy23 = RHEO__SHUFFLE(value.x, value.y, 2, 6, 3, 7);
    rheo__lanes z01 = RHEO__SHUFFLE(value.z, w, 0, 4, 1, 5), z23 = RHEO__SHUFFLE(value.z, w, 2, 6, 3, 7);
    rheo__lanes_spread(point, index, 0, RHEO__SHUFFLE(xy01, z01, 0, 1, 4, 5));
    rheo__lanes_spread(point, index, 1, RHEO__SHUFFLE(xy01, z01, 2, 3, 6, 7));
    rheo__lanes_spread(point, index, 2, RHEO__SHUFFLE(xy23, z23, 0, 1, 4, 5));
    rheo__lanes_spread(point, index, 3, RHEO__SHUFFLE(xy23, z23, 2, 3, 6, 7));
}
#else
static inline rheo__lanes3 rheo__lanes_load_w(const rheo__point *point, const uint32_t index[RHEO__LANES],
                                              rheo__lanes *w)
{
    rheo__lanes3 value;
    for (int lane = 0; lane < RHEO__LANES; lane++) {
        RHEO__LANE(value.x, lane) = point[index[lane]].x;
        RHEO__LANE(value.y, lane) = point[index[lane]].y;
        RHEO__LANE(value.z, lane) = point[index[lane]].z;
        RHEO__LANE(*w, lane) = point[index[lane]].w;
    }
    return value;
}
static inline void rheo__lanes_store_w(rheo__point *point, const uint32_t index[RHEO__LANES], rheo__lanes3 value,
                                       rheo__lanes w)
{
    for (int lane = 0; lane < RHEO__LANES; lane++)
        point[index[lane]] = (rheo__point){RHEO__LANE(value.x, lane), RHEO__LANE(value.y, lane),
                                           RHEO__LANE(value.z, lane), RHEO__LANE(w, lane)};
}
#endif
static inline rheo__lanes3 rheo__lanes_load(const rheo__point *point, const uint32_t index[RHEO__LANES])
{
    rheo__lanes w;
    return rheo__lanes_load_w(point, index, &w);
}
/* Stores points; w becomes 0. Two lanes may store to the same point only if either value is right. */
static inline void rheo__lanes_store(rheo__point *point, const uint32_t index[RHEO__LANES], rheo__lanes3 value)
{
    rheo__lanes_store_w(point, index, value, (rheo__lanes){0});
}

#endif
