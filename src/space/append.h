/*
 * Appends the ranks of the lanes that are close enough to a list of partners: the inner loop of every search. Every
 * lane is written but only hits are counted, so there is no branch to mispredict.
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

/*
 * Appends the ranks with r2 < limit2, and on request their r2. Returns the new count. The arrays must have room for
 * RHEO__LANES more. r2 is not negative; NaN is never close. Lane `but` is left out; RHEO__LANES leaves out none.
 */
static inline uint32_t rheo__append_hits(const rheo__hit_order *order, const uint32_t *rank, rheo__lanes r2,
                                         rheo__lanes limit2, uint32_t but, uint32_t *partner, rheo_real *distance2,
                                         uint32_t count, bool with_distance)
{
#if defined(RHEO__COMPRESS_AVX512)
    (void)order;
    const __mmask16 hits =
        _mm512_cmp_ps_mask((__m512)r2, (__m512)limit2, _CMP_LT_OQ) & (__mmask16) ~(UINT32_C(1) << but);
    const __m512i ranks = _mm512_loadu_si512(rank);
    _mm512_storeu_si512(partner + count, _mm512_maskz_compress_epi32(hits, ranks));
    if (with_distance)
        _mm512_storeu_ps(distance2 + count, _mm512_maskz_compress_ps(hits, (__m512)r2));
    count += (uint32_t)__builtin_popcount(hits);
#elif defined(RHEO__COMPRESS_AVX2)
    const uint32_t hits = (uint32_t)_mm256_movemask_ps((__m256)(r2 < limit2)) & ~(UINT32_C(1) << but);
    const __m256i place = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((int64_t)order->of[hits]));
    const __m256i ranks = _mm256_loadu_si256((const __m256i *)(const void *)rank);
    _mm256_storeu_si256((__m256i *)(void *)(partner + count), _mm256_permutevar8x32_epi32(ranks, place));
    if (with_distance)
        _mm256_storeu_ps(distance2 + count, _mm256_permutevar8x32_ps((__m256)r2, place));
    count += (uint32_t)__builtin_popcount(hits);
#else
    (void)order;
    /* Squared distances are not negative, so their bits have the order of their values; NaN is the largest. */
    rheo_real value[RHEO__LANES];
    rheo__real_bits bits[RHEO__LANES], limit[RHEO__LANES];
    memcpy(value, &r2, sizeof value);
    memcpy(bits, &r2, sizeof bits);
    memcpy(limit, &limit2, sizeof limit);
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
        partner[count] = rank[lane];
        if (with_distance)
            distance2[count] = value[lane];
        count += (bits[lane] < limit[lane]) & (lane != but);
    }
#endif
    return count;
}

#endif
