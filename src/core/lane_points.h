/*
 * Points in lanes: loading and storing points of an array, one in each lane, and triples that lie one after another.
 * Intrinsics stand where GCC generates worse code from the portable form.
 */
#ifndef RHEO__CORE_LANE_POINTS_H
#define RHEO__CORE_LANE_POINTS_H

#include "core/lanes.h"
#include "core/simd.h"
#include "core/springs.h"

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
 * several groups. SHUFFLE takes lane numbers of one group; those of the second vector start at 4. Loads shuffle pairs of
 * values, of which x86 does two a cycle; it interleaves one.
 *
 * `at` is the index of a point's first value: the processor adds it to an address without further instructions.
 */
#if (defined(__clang__) || __GNUC__ >= 12) && (RHEO__LANES == 4 || RHEO__LANES == 8 || RHEO__LANES == 16)
typedef rheo_real rheo__quad __attribute__((vector_size(4 * sizeof(rheo_real))));

static inline rheo__quad rheo__quad_load(const rheo_real *values)
{
    rheo__quad quad;
    memcpy(&quad, values, sizeof quad);
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

/*
 * Loads the four values of the lanes n, n + 4, n + 8, ... one after another, at `times` the index. Intrinsics, since GCC
 * joins vectors with two instructions where one that reads memory will do.
 */
RHEO__FOR_EACH_CASE rheo__lanes rheo__lanes_collect(const rheo_real *values, const uint32_t at[RHEO__LANES], int n,
                                                    size_t times)
{
#if RHEO__LANES == 4
    return rheo__quad_load(values + times * at[n]);
#elif defined(__AVX512F__) && RHEO__LANES == 16
    __m512 all = _mm512_castps128_ps512(_mm_loadu_ps(values + times * at[n]));
    all = _mm512_insertf32x4(all, _mm_loadu_ps(values + times * at[n + 4]), 1);
    all = _mm512_insertf32x4(all, _mm_loadu_ps(values + times * at[n + 8]), 2);
    return (rheo__lanes)_mm512_insertf32x4(all, _mm_loadu_ps(values + times * at[n + 12]), 3);
#elif defined(__AVX__) && !RHEO_DOUBLE
    __m256 all = _mm256_castps128_ps256(_mm_loadu_ps(values + times * at[n]));
    return (rheo__lanes)_mm256_insertf128_ps(all, _mm_loadu_ps(values + times * at[n + 4]), 1);
#else
    rheo__quad a = rheo__quad_load(values + times * at[n]), b = rheo__quad_load(values + times * at[n + 4]);
    __typeof__(__builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7)) ab =
        __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
#if RHEO__LANES == 8
    return ab;
#else
    rheo__quad c = rheo__quad_load(values + times * at[n + 8]), d = rheo__quad_load(values + times * at[n + 12]);
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

RHEO__FOR_EACH_CASE rheo__lanes3 rheo__lanes_load_values(const rheo_real *values, const uint32_t at[RHEO__LANES],
                                                         size_t times, rheo__lanes *w)
{
    rheo__lanes a = rheo__lanes_collect(values, at, 0, times), b = rheo__lanes_collect(values, at, 1, times),
                c = rheo__lanes_collect(values, at, 2, times), d = rheo__lanes_collect(values, at, 3, times);
    rheo__lanes ab = RHEO__SHUFFLE(a, b, 0, 1, 4, 5), cd = RHEO__SHUFFLE(c, d, 0, 1, 4, 5);
    rheo__lanes ab_z = RHEO__SHUFFLE(a, b, 2, 3, 6, 7), cd_z = RHEO__SHUFFLE(c, d, 2, 3, 6, 7);
    *w = RHEO__SHUFFLE(ab_z, cd_z, 1, 3, 5, 7);
    return (rheo__lanes3){RHEO__SHUFFLE(ab, cd, 0, 2, 4, 6), RHEO__SHUFFLE(ab, cd, 1, 3, 5, 7),
                          RHEO__SHUFFLE(ab_z, cd_z, 0, 2, 4, 6)};
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
RHEO__FOR_EACH_CASE rheo__lanes3 rheo__lanes_load_values(const rheo_real *values, const uint32_t at[RHEO__LANES],
                                                         size_t times, rheo__lanes *w)
{
    rheo__lanes3 value;
    for (int lane = 0; lane < RHEO__LANES; lane++) {
        const rheo_real *of_lane = values + times * at[lane];
        RHEO__LANE(value.x, lane) = of_lane[0];
        RHEO__LANE(value.y, lane) = of_lane[1];
        RHEO__LANE(value.z, lane) = of_lane[2];
        RHEO__LANE(*w, lane) = of_lane[3];
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

/* Points by number; w is their fourth value. */
static inline rheo__lanes3 rheo__lanes_load_w(const rheo__point *point, const uint32_t index[RHEO__LANES],
                                              rheo__lanes *w)
{
    return rheo__lanes_load_values(&point->x, index, RHEO__POINT_VALUES, w);
}
static inline rheo__lanes3 rheo__lanes_load(const rheo__point *point, const uint32_t index[RHEO__LANES])
{
    rheo__lanes w;
    return rheo__lanes_load_w(point, index, &w);
}
/* Points by the index of their first value. */
static inline rheo__lanes3 rheo__lanes_load_w_at(const rheo__point *point, const uint32_t at[RHEO__LANES],
                                                 rheo__lanes *w)
{
    return rheo__lanes_load_values(&point->x, at, 1, w);
}
static inline rheo__lanes3 rheo__lanes_load_at(const rheo__point *point, const uint32_t at[RHEO__LANES])
{
    rheo__lanes w;
    return rheo__lanes_load_w_at(point, at, &w);
}
/* Stores points; w becomes 0. Two lanes may store to the same point only if either value is right. */
static inline void rheo__lanes_store(rheo__point *point, const uint32_t index[RHEO__LANES], rheo__lanes3 value)
{
    rheo__lanes_store_w(point, index, value, (rheo__lanes){0});
}

/* ---- Points that lie one after another ---- */

static const uint32_t rheo__lane_number[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
                      rheo__lane_point[16] = {0, 4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 44, 48, 52, 56, 60};

static inline rheo__lanes3 rheo__lanes_load_row_w(const rheo__point *first, rheo__lanes *w)
{
    return rheo__lanes_load_w(first, rheo__lane_number, w);
}
static inline rheo__lanes3 rheo__lanes_load_row(const rheo__point *first)
{
    return rheo__lanes_load(first, rheo__lane_number);
}
static inline void rheo__lanes_store_row(rheo__point *first, rheo__lanes3 value)
{
    rheo__lanes_store(first, rheo__lane_number, value);
}

/* ---- Wide points ---- */

typedef struct rheo__wide_lanes {
    rheo__lanes3 at, more;
    rheo__lanes w, more_w; /* fourth values of both */
} rheo__wide_lanes;

/* `at` is the index of the first value of the same point in an array of points that are not wide. */
RHEO__FOR_EACH_CASE rheo__wide_lanes rheo__lanes_load_wide_at(const rheo__wide_point *point,
                                                              const uint32_t at[RHEO__LANES])
{
    const rheo_real *values = &point->at.x;
    rheo__wide_lanes wide;
#if defined(__AVX512F__) && RHEO__LANES == 16
    /* A register takes the eight values of two points. Its groups of four lanes are transposed, then put in order. */
    __m512 x[2], y[2], z[2], w[2];
    for (int half = 0; half < 2; half++) {
        __m512 row[4];
        for (int k = 0; k < 4; k++) {
            const int n = 8 * half + k;
            row[k] = _mm512_castps256_ps512(_mm256_loadu_ps(values + (size_t)2 * at[n]));
            row[k] = _mm512_insertf32x8(row[k], _mm256_loadu_ps(values + (size_t)2 * at[n + 4]), 1);
        }
        const __m512 ab = _mm512_unpacklo_ps(row[0], row[1]), cd = _mm512_unpacklo_ps(row[2], row[3]),
                     ab_z = _mm512_unpackhi_ps(row[0], row[1]), cd_z = _mm512_unpackhi_ps(row[2], row[3]);
        x[half] = _mm512_shuffle_ps(ab, cd, 0x44); /* those of `more` are in the odd groups */
        y[half] = _mm512_shuffle_ps(ab, cd, 0xee);
        z[half] = _mm512_shuffle_ps(ab_z, cd_z, 0x44);
        w[half] = _mm512_shuffle_ps(ab_z, cd_z, 0xee);
    }
    enum { EVEN = 0x88, ODD = 0xdd };
    wide.at = (rheo__lanes3){(rheo__lanes)_mm512_shuffle_f32x4(x[0], x[1], EVEN),
                             (rheo__lanes)_mm512_shuffle_f32x4(y[0], y[1], EVEN),
                             (rheo__lanes)_mm512_shuffle_f32x4(z[0], z[1], EVEN)};
    wide.more = (rheo__lanes3){(rheo__lanes)_mm512_shuffle_f32x4(x[0], x[1], ODD),
                               (rheo__lanes)_mm512_shuffle_f32x4(y[0], y[1], ODD),
                               (rheo__lanes)_mm512_shuffle_f32x4(z[0], z[1], ODD)};
    wide.w = (rheo__lanes)_mm512_shuffle_f32x4(w[0], w[1], EVEN);
    wide.more_w = (rheo__lanes)_mm512_shuffle_f32x4(w[0], w[1], ODD);
#else
    wide.at = rheo__lanes_load_values(values, at, 2, &wide.w);
    wide.more = rheo__lanes_load_values(values + RHEO__POINT_VALUES, at, 2, &wide.more_w);
#endif
    return wide;
}
/* The points of a row minus those at the indices, except for w and more_w, which are those at the indices. */
RHEO__FOR_EACH_CASE rheo__wide_lanes rheo__lanes_minus_wide_at(const rheo__wide_lanes *row,
                                                               const rheo__wide_point *point,
                                                               const uint32_t at[RHEO__LANES])
{
    rheo__wide_lanes wide;
#if defined(__AVX512F__) && RHEO__LANES == 16
    wide = rheo__lanes_load_wide_at(point, at);
    wide.at = rheo__lanes3_minus(row->at, wide.at);
    wide.more = rheo__lanes3_minus(row->more, wide.more);
#else
    /* One after the other, since few registers are left in the loops over pairs. */
    wide.at = rheo__lanes3_minus(row->at, rheo__lanes_load_values(&point->at.x, at, 2, &wide.w));
    wide.more = rheo__lanes3_minus(row->more, rheo__lanes_load_values(&point->more.x, at, 2, &wide.more_w));
#endif
    return wide;
}
/* `at` alone. */
static inline rheo__lanes3 rheo__lanes_load_narrow_at(const rheo__wide_point *point, const uint32_t at[RHEO__LANES])
{
    rheo__lanes w;
    return rheo__lanes_load_values(&point->at.x, at, 2, &w);
}
/* Wide points that lie one after another. */
static inline rheo__wide_lanes rheo__lanes_load_wide_row(const rheo__wide_point *first)
{
    return rheo__lanes_load_wide_at(first, rheo__lane_point);
}

/* ---- Triples: the particle fields of three values, in the order of ids ---- */

/*
 * Loads RHEO__LANES triples that lie one after another, and stores them. Each vector of memory has values of all three
 * axes; two shuffles collect those of one axis, and two put them back.
 */
#if (defined(__clang__) || __GNUC__ >= 12) && (RHEO__LANES == 4 || RHEO__LANES == 8 || RHEO__LANES == 16)
#if RHEO__LANES == 4
#define RHEO__EACH_LANE(X, a) X(0, a), X(1, a), X(2, a), X(3, a)
#elif RHEO__LANES == 8
#define RHEO__EACH_LANE(X, a) X(0, a), X(1, a), X(2, a), X(3, a), X(4, a), X(5, a), X(6, a), X(7, a)
#else
#define RHEO__EACH_LANE(X, a)                                                                                     \
    X(0, a), X(1, a), X(2, a), X(3, a), X(4, a), X(5, a), X(6, a), X(7, a), X(8, a), X(9, a), X(10, a), X(11, a), \
        X(12, a), X(13, a), X(14, a), X(15, a)
#endif
/* Lane -> place among the first two vectors (-1: any); then in their shuffle, or in the third vector. */
#define RHEO__FROM_TWO(lane, axis) (3 * (lane) + (axis) < 2 * RHEO__LANES ? 3 * (lane) + (axis) : -1)
#define RHEO__FROM_THIRD(lane, axis) \
    (3 * (lane) + (axis) < 2 * RHEO__LANES ? (lane) : 3 * (lane) + (axis)-RHEO__LANES)
/* Place in a vector of memory -> lane of x or y; then z. `before`: values in the vectors before. */
#define RHEO__FROM_XY(place, before) (((place) + (before)) / 3 + (((place) + (before)) % 3 == 1 ? RHEO__LANES : 0))
#define RHEO__FROM_Z(place, before) (((place) + (before)) % 3 == 2 ? RHEO__LANES + ((place) + (before)) / 3 : (place))

static inline rheo__lanes3 rheo__lanes_load_triples(const rheo_real *triple)
{
    rheo__lanes a, b, c;
    memcpy(&a, triple, sizeof a);
    memcpy(&b, triple + RHEO__LANES, sizeof b);
    memcpy(&c, triple + 2 * RHEO__LANES, sizeof c);
#define RHEO__AXIS(axis)                                                                             \
    __builtin_shufflevector(__builtin_shufflevector(a, b, RHEO__EACH_LANE(RHEO__FROM_TWO, axis)), c, \
                            RHEO__EACH_LANE(RHEO__FROM_THIRD, axis))
    return (rheo__lanes3){RHEO__AXIS(0), RHEO__AXIS(1), RHEO__AXIS(2)};
#undef RHEO__AXIS
}
static inline void rheo__lanes_store_triples(rheo_real *triple, rheo__lanes3 value)
{
#define RHEO__PART(before)                                                                                     \
    __builtin_shufflevector(__builtin_shufflevector(value.x, value.y, RHEO__EACH_LANE(RHEO__FROM_XY, before)), \
                            value.z, RHEO__EACH_LANE(RHEO__FROM_Z, before))
    const rheo__lanes a = RHEO__PART(0), b = RHEO__PART(RHEO__LANES), c = RHEO__PART(2 * RHEO__LANES);
#undef RHEO__PART
    memcpy(triple, &a, sizeof a);
    memcpy(triple + RHEO__LANES, &b, sizeof b);
    memcpy(triple + 2 * RHEO__LANES, &c, sizeof c);
}
#else
static inline rheo__lanes3 rheo__lanes_load_triples(const rheo_real *triple)
{
    rheo__lanes3 value;
    for (int lane = 0; lane < RHEO__LANES; lane++, triple += 3) {
        RHEO__LANE(value.x, lane) = triple[0];
        RHEO__LANE(value.y, lane) = triple[1];
        RHEO__LANE(value.z, lane) = triple[2];
    }
    return value;
}
static inline void rheo__lanes_store_triples(rheo_real *triple, rheo__lanes3 value)
{
    for (int lane = 0; lane < RHEO__LANES; lane++, triple += 3) {
        triple[0] = RHEO__LANE(value.x, lane);
        triple[1] = RHEO__LANE(value.y, lane);
        triple[2] = RHEO__LANE(value.z, lane);
    }
}
#endif

#endif
