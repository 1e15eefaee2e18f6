/*
 * Appends the lanes that are close enough to lists: the inner loop of every search. Every lane is written but only hits
 * are counted, so there is no branch to mispredict.
 */
#ifndef RHEO__SPACE_APPEND_H
#define RHEO__SPACE_APPEND_H

#include "core/lanes.h"

/* This variant can move the hits to the front of a vector and write them at once. */
#if !RHEO_DOUBLE && RHEO__LANES == 16 && defined(__AVX512F__)
#define RHEO__COMPRESS_AVX512
#elif !RHEO_DOUBLE && RHEO__LANES == 8 && defined(__AVX2__)
#define RHEO__COMPRESS_AVX2
#endif

/* Sets of lanes, as bits. */
#define RHEO__ALL_LANES ((UINT32_C(1) << RHEO__LANES) - 1)
static inline uint32_t rheo__lanes_but(uint32_t lane)
{
    return lane < RHEO__LANES ? RHEO__ALL_LANES & ~(UINT32_C(1) << lane) : RHEO__ALL_LANES;
}
/* The lanes whose rank is another one; `lane`: number of the lane that has it, if any. */
static inline uint32_t rheo__lanes_unlike(const uint32_t *rank, uint32_t own, uint32_t lane)
{
#if defined(RHEO__COMPRESS_AVX512)
    (void)lane;
    return _mm512_cmpneq_epi32_mask(_mm512_loadu_si512(rank), _mm512_set1_epi32((int)own));
#else
    (void)rank;
    (void)own;
    return rheo__lanes_but(lane);
#endif
}
static inline uint32_t rheo__lanes_before(uint32_t lane)
{
    return lane < RHEO__LANES ? (UINT32_C(1) << lane) - 1 : RHEO__ALL_LANES;
}

typedef struct rheo__hit_order {
#ifdef RHEO__COMPRESS_AVX2
    uint64_t of[1 << RHEO__LANES]; /* the lane numbers in each set of lanes, ascending, one byte each */
#else
    char unused;
#endif
} rheo__hit_order;

static inline void rheo__make_hit_order(rheo__hit_order *order)
{
#ifdef RHEO__COMPRESS_AVX2
    order->of[0] = 0;
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
        for (uint32_t set = 0; set < UINT32_C(1) << lane; set++)
            order->of[set | UINT32_C(1) << lane] = order->of[set] | (uint64_t)lane << 8 * __builtin_popcount(set);
#else
    order->unused = 0;
#endif
}

typedef struct rheo__hits {
#if defined(RHEO__COMPRESS_AVX512)
    __mmask16 lanes;
    __m512i place; /* numbers of these lanes, ascending; unused if only ranks are written */
#elif defined(RHEO__COMPRESS_AVX2)
    __m256i place;
#else
    uint32_t hit[RHEO__LANES];
#endif
    uint32_t count;
} rheo__hits;

/* Those of a set of lanes that have r2 < limit2. r2 is not negative; NaN is never close. */
static inline rheo__hits rheo__find_hits(const rheo__hit_order *order, rheo__lanes r2, rheo__lanes limit2,
                                         uint32_t set)
{
    rheo__hits hits;
#if defined(RHEO__COMPRESS_AVX512)
    (void)order;
    hits.lanes = _mm512_cmp_ps_mask((__m512)r2, (__m512)limit2, _CMP_LT_OQ) & (__mmask16)set;
    hits.count = (uint32_t)__builtin_popcount(hits.lanes);
    hits.place = _mm512_maskz_compress_epi32(hits.lanes,
                                             _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
#elif defined(RHEO__COMPRESS_AVX2)
    const uint32_t lanes = (uint32_t)_mm256_movemask_ps((__m256)(r2 < limit2)) & set;
    hits.place = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((int64_t)order->of[lanes]));
    hits.count = (uint32_t)__builtin_popcount(lanes);
#else
    (void)order;
    /* Squared distances are not negative, so their bits have the order of their values; NaN is the largest. */
    rheo__real_bits bits[RHEO__LANES], limit[RHEO__LANES];
    memcpy(bits, &r2, sizeof bits);
    memcpy(limit, &limit2, sizeof limit);
    hits.count = 0;
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
        hits.hit[lane] = (bits[lane] < limit[lane]) & (set >> lane);
        hits.count += hits.hit[lane];
    }
#endif
    return hits;
}

/* Write the ranks and the values of the hits, in the order of lanes. There must be room for RHEO__LANES. */
static inline void rheo__write_ranks(const rheo__hits *hits, const uint32_t *rank, uint32_t *to)
{
#if defined(RHEO__COMPRESS_AVX512)
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(hits->lanes, _mm512_loadu_si512(rank)));
#elif defined(RHEO__COMPRESS_AVX2)
    const __m256i ranks = _mm256_loadu_si256((const __m256i *)(const void *)rank);
    _mm256_storeu_si256((__m256i *)(void *)to, _mm256_permutevar8x32_epi32(ranks, hits->place));
#else
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
        *to = rank[lane];
        to += hits->hit[lane];
    }
#endif
}
/* Writes the numbers of the lanes that are hits, counted from `first`. */
static inline void rheo__write_numbers(const rheo__hits *hits, uint32_t first, uint32_t *to)
{
#if defined(RHEO__COMPRESS_AVX512)
    _mm512_storeu_si512(to, _mm512_add_epi32(hits->place, _mm512_set1_epi32((int)first)));
#elif defined(RHEO__COMPRESS_AVX2)
    _mm256_storeu_si256((__m256i *)(void *)to, _mm256_add_epi32(hits->place, _mm256_set1_epi32((int)first)));
#else
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
        *to = first + lane;
        to += hits->hit[lane];
    }
#endif
}
static inline void rheo__write_values(const rheo__hits *hits, rheo__lanes value, rheo_real *to)
{
#if defined(RHEO__COMPRESS_AVX512)
    _mm512_storeu_ps(to, _mm512_permutexvar_ps(hits->place, (__m512)value)); /* half as long as to compress it */
#elif defined(RHEO__COMPRESS_AVX2)
    _mm256_storeu_ps(to, _mm256_permutevar8x32_ps((__m256)value, hits->place));
#else
    rheo_real values[RHEO__LANES];
    memcpy(values, &value, sizeof values);
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
        *to = values[lane];
        to += hits->hit[lane];
    }
#endif
}

#endif
