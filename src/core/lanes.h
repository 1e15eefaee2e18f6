/*
 * Lanes: RHEO__LANES numbers side by side, in GCC and Clang vector types, or plain numbers if there is one lane.
 * Every operation acts on each lane separately, in IEEE arithmetic. So a lane has the bits of the same scalar code on
 * any machine, for any number of lanes. Where numbers of several lanes are added, the
 * stage defines the order.
 *
 * Intrinsics stand where compilers generate worse code from a loop or a vector expression; each also has a
 * portable form.
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
typedef rheo__real_bits rheo__bits;
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
/* One bit for each lane that is true. */
static inline uint32_t rheo__lanes_true(rheo__mask mask)
{
    return (uint32_t)(mask & 1);
}
/* All bits set where true. */
static inline rheo__mask rheo__mask_filled(rheo__mask mask)
{
    return -mask;
}
static inline rheo__lanes rheo__lanes_sqrt(rheo__lanes a)
{
    return rheo__sqrt(a);
}
static inline rheo__mask rheo__lanes_whole(rheo__lanes a)
{
    return (rheo__mask)a;
}

#else

typedef rheo_real rheo__lanes __attribute__((vector_size(RHEO__VECTOR_BYTES)));
typedef rheo__lane_index rheo__mask __attribute__((vector_size(RHEO__VECTOR_BYTES))); /* -1 where true */
typedef rheo__real_bits rheo__bits __attribute__((vector_size(RHEO__VECTOR_BYTES)));
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
static inline rheo__mask rheo__mask_filled(rheo__mask mask)
{
    return mask;
}
/* Whole numbers of lanes, as integers. */
static inline rheo__mask rheo__lanes_whole(rheo__lanes a)
{
    return __builtin_convertvector(a, rheo__mask);
}

/*
 * Instructions that compilers do not make of vector expressions: no loop becomes a square root, GCC compares, selects and
 * tests masks with more of them than it takes. Each does what the portable form does, also where a number is NaN.
 */
#if defined(__AVX512DQ__) && RHEO__VECTOR_BYTES == 64
#include <immintrin.h>
#if RHEO_DOUBLE
#define RHEO__SQRT(a) _mm512_sqrt_pd((__m512d)(a))
#else
#define RHEO__SQRT(a) _mm512_sqrt_ps((__m512)(a))
#define RHEO__MAX(a, b) _mm512_max_ps((__m512)(a), (__m512)(b))
#define RHEO__MIN(a, b) _mm512_min_ps((__m512)(a), (__m512)(b))
#define RHEO__LESS(a, b) _mm512_cmp_ps_mask((__m512)(a), (__m512)(b), _CMP_LT_OQ)
#define RHEO__IF_LESS(a, b, value, otherwise) \
    _mm512_mask_blend_ps(RHEO__LESS(a, b), (__m512)(otherwise), (__m512)(value))
#define RHEO__KEEP_LESS(a, b, value) _mm512_maskz_mov_ps(RHEO__LESS(a, b), (__m512)(value))
#define RHEO__ADD_IF_LESS(a, b, sum, value) \
    _mm512_mask_add_ps((__m512)(sum), RHEO__LESS(a, b), (__m512)(sum), (__m512)(value))
#define RHEO__MAX_IF_LESS(a, b, most, value) \
    _mm512_mask_max_ps((__m512)(most), RHEO__LESS(a, b), (__m512)(value), (__m512)(most))
#define RHEO__COUNT_IF_LESS(a, b, count) \
    _mm512_mask_add_epi32((__m512i)(count), RHEO__LESS(a, b), (__m512i)(count), _mm512_set1_epi32(1))
#endif
#elif defined(__AVX__) && RHEO__VECTOR_BYTES == 32
#include <immintrin.h>
#if RHEO_DOUBLE
#define RHEO__SQRT(a) _mm256_sqrt_pd((__m256d)(a))
#else
#define RHEO__SQRT(a) _mm256_sqrt_ps((__m256)(a))
#define RHEO__MAX(a, b) _mm256_max_ps((__m256)(a), (__m256)(b))
#define RHEO__MIN(a, b) _mm256_min_ps((__m256)(a), (__m256)(b))
#define RHEO__LESS(a, b) _mm256_cmp_ps((__m256)(a), (__m256)(b), _CMP_LT_OQ)
#define RHEO__IF_LESS(a, b, value, otherwise) _mm256_blendv_ps((__m256)(otherwise), (__m256)(value), RHEO__LESS(a, b))
#define RHEO__KEEP_LESS(a, b, value) _mm256_and_ps(RHEO__LESS(a, b), (__m256)(value))
#endif
#elif defined(__SSE2__) && RHEO__VECTOR_BYTES == 16
#include <emmintrin.h>
#define RHEO__SQRT(a) _mm_sqrt_ps((__m128)(a))
#define RHEO__MAX(a, b) _mm_max_ps((__m128)(a), (__m128)(b))
#define RHEO__MIN(a, b) _mm_min_ps((__m128)(a), (__m128)(b))
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

/* Whether a comparison is true in any lane. */
static inline bool rheo__lanes_any(rheo__mask mask)
{
#if defined(__AVX512F__) && RHEO__VECTOR_BYTES == 64
    return _mm512_test_epi32_mask((__m512i)mask, (__m512i)mask) != 0;
#elif defined(__AVX__) && RHEO__VECTOR_BYTES == 32
    return !_mm256_testz_si256((__m256i)mask, (__m256i)mask);
#else
    uint64_t word[RHEO__VECTOR_BYTES / 8], any = 0;
    memcpy(word, &mask, sizeof word);
    for (int i = 0; i < RHEO__VECTOR_BYTES / 8; i++)
        any |= word[i];
    return any != 0;
#endif
}

/* One bit for each lane that is true. */
static inline uint32_t rheo__lanes_true(rheo__mask mask)
{
#if defined(__AVX512F__) && RHEO__VECTOR_BYTES == 64 && !RHEO_DOUBLE
    return _mm512_test_epi32_mask((__m512i)mask, (__m512i)mask);
#elif defined(__AVX__) && RHEO__VECTOR_BYTES == 32 && !RHEO_DOUBLE
    return (uint32_t)_mm256_movemask_ps((__m256)mask);
#else
    uint32_t lanes = 0;
    for (int lane = 0; lane < RHEO__LANES; lane++)
        lanes |= (uint32_t)(mask[lane] & 1) << lane;
    return lanes;
#endif
}

/* The bytes of a vector as 64-bit words, and the square of the lower half of each. */
typedef uint64_t rheo__words __attribute__((vector_size(RHEO__VECTOR_BYTES)));

static inline rheo__words rheo__words_square(rheo__words a)
{
#if defined(__AVX512F__) && RHEO__VECTOR_BYTES == 64
    return (rheo__words)_mm512_mul_epu32((__m512i)a, (__m512i)a);
#elif defined(__AVX2__) && RHEO__VECTOR_BYTES == 32
    return (rheo__words)_mm256_mul_epu32((__m256i)a, (__m256i)a);
#elif defined(__SSE2__) && RHEO__VECTOR_BYTES == 16
    return (rheo__words)_mm_mul_epu32((__m128i)a, (__m128i)a);
#else
    a &= UINT32_MAX;
    return a * a;
#endif
}

#endif

static inline rheo__lanes rheo__lanes_all(rheo_real value)
{
    return value - (rheo__lanes){0}; /* (x + 0 would lose a -0) */
}

/* a > b ? a : b */
static inline rheo__lanes rheo__lanes_max(rheo__lanes a, rheo__lanes b)
{
#ifdef RHEO__MAX
    return (rheo__lanes)RHEO__MAX(a, b);
#else
    return rheo__lanes_select(a > b, a, b);
#endif
}
/* a < b ? a : b */
static inline rheo__lanes rheo__lanes_min(rheo__lanes a, rheo__lanes b)
{
#ifdef RHEO__MIN
    return (rheo__lanes)RHEO__MIN(a, b);
#else
    return rheo__lanes_select(a < b, a, b);
#endif
}
/* a < b ? value : otherwise */
static inline rheo__lanes rheo__lanes_if_less(rheo__lanes a, rheo__lanes b, rheo__lanes value, rheo__lanes otherwise)
{
#ifdef RHEO__IF_LESS
    return (rheo__lanes)RHEO__IF_LESS(a, b, value, otherwise);
#else
    return rheo__lanes_select(a < b, value, otherwise);
#endif
}
/* a < b ? value : 0 */
static inline rheo__lanes rheo__lanes_keep_less(rheo__lanes a, rheo__lanes b, rheo__lanes value)
{
#ifdef RHEO__KEEP_LESS
    return (rheo__lanes)RHEO__KEEP_LESS(a, b, value);
#else
    return rheo__lanes_keep(a < b, value);
#endif
}

/* a < b ? sum + value : sum. The sum must not be -0. */
static inline rheo__lanes rheo__lanes_add_if_less(rheo__lanes a, rheo__lanes b, rheo__lanes sum, rheo__lanes value)
{
#ifdef RHEO__ADD_IF_LESS
    return (rheo__lanes)RHEO__ADD_IF_LESS(a, b, sum, value);
#else
    return sum + rheo__lanes_keep_less(a, b, value);
#endif
}
/* a < b ? count + 1 : count */
static inline rheo__mask rheo__lanes_count_if_less(rheo__lanes a, rheo__lanes b, rheo__mask count)
{
#ifdef RHEO__COUNT_IF_LESS
    return (rheo__mask)RHEO__COUNT_IF_LESS(a, b, count);
#else
    return count - rheo__mask_filled(a < b);
#endif
}
/* a < b && value > most ? value : most */
static inline rheo__lanes rheo__lanes_max_if_less(rheo__lanes a, rheo__lanes b, rheo__lanes most, rheo__lanes value)
{
#ifdef RHEO__MAX_IF_LESS
    return (rheo__lanes)RHEO__MAX_IF_LESS(a, b, most, value);
#else
    return rheo__lanes_max(rheo__lanes_if_less(a, b, value, most), most);
#endif
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

#endif
