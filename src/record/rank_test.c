/*
 * The rank sum R of the first of two samples, of n and m values, against all C(n + m, n) ways to choose it. With f(k, s) the
 * number of ways to choose k values whose ranks have the sum s, value after value,
 *
 *     f(k, s) += f(k - 1, s - rank),      P(R <= s) = (f(n, 0) + ... + f(n, s)) / C(n + m, n)
 *
 * Ties share the mean of their ranks, and the same sum is then exact for them. The limit for many tests: with probabilities
 * p_1 <= ... <= p_M, those up to the largest k with p_k <= k rate / (M (1 + 1/2 + ... + 1/M)) reject.
 */
#include "record/rank_test.h"

#include <stdlib.h>
#include <string.h>

void rheo__rank(rheo__ranks_of *ranks, const double *values, uint32_t first, uint32_t all)
{
    *ranks = (rheo__ranks_of){.first = first, .all = all};
    for (uint32_t i = 0; i < all; i++) {
        uint32_t below = 0, equal = 0;
        for (uint32_t j = 0; j < all; j++) {
            below += values[j] < values[i];
            equal += values[j] == values[i];
        }
        ranks->rank[i] = 2 * below + equal + 1;
        ranks->ties = ranks->ties || equal > 1;
    }
}

/* Sums that the first sample can reach: those of its largest ranks, and all below. */
static uint32_t sums_of(const rheo__ranks_of *r)
{
    uint32_t total = 0;
    for (uint32_t i = 0; i < r->all; i++)
        total += r->rank[i];
    return total + 1;
}

bool rheo__rank_sums_take(rheo__rank_sums *sums, const rheo__ranks_of *r)
{
    if (sums->least && !sums->ties && !r->ties && sums->first == r->first && sums->all == r->all)
        return true;
    const uint32_t count = sums_of(r);
    double *ways = calloc((r->first + (size_t)1) * count, sizeof *ways), *least = malloc(count * sizeof *least);
    if (!ways || !least) {
        free(ways);
        free(least);
        return false;
    }
    ways[0] = 1;
    uint32_t reached = 0; /* the largest sum so far */
    for (uint32_t i = 0; i < r->all; i++) {
        reached += r->rank[i];
        for (uint32_t k = i < r->first ? i + 1 : r->first; k >= 1; k--) {
            double *to = ways + (size_t)k * count, *from = to - count;
            for (uint32_t s = reached; s >= r->rank[i]; s--)
                to[s] += from[s - r->rank[i]];
        }
    }
    double all = 0, below = 0;
    const double *chosen = ways + (size_t)r->first * count;
    for (uint32_t s = 0; s < count; s++)
        all += chosen[s];
    for (uint32_t s = 0; s < count; s++) {
        below += chosen[s];
        least[s] = below / all;
    }
    free(ways);
    free(sums->least);
    *sums = (rheo__rank_sums){r->first, r->all, count, r->ties, least};
    return true;
}

void rheo__rank_sums_release(rheo__rank_sums *sums)
{
    free(sums->least);
    *sums = (rheo__rank_sums){0};
}

/* The sums are symmetric about their mean without ties only; with ties the farther half is not the mirror of the nearer. */
double rheo__rank_probability(const rheo__rank_sums *sums, uint32_t sum)
{
    const double low = sums->least[sum], high = 1 - (sum ? sums->least[sum - 1] : 0);
    const double two = 2 * (low < high ? low : high);
    return two < 1 ? two : 1;
}

uint32_t rheo__reject(const double *probability, uint32_t *order, uint32_t count, double rate)
{
    double harmonic = 0;
    uint32_t rejected = 0;
    for (uint32_t i = 0; i < count; i++) {
        harmonic += 1 / (double)(i + 1);
        uint32_t at = i;
        for (; at > 0 && probability[order[at - 1]] > probability[i]; at--)
            order[at] = order[at - 1];
        order[at] = i;
    }
    for (uint32_t k = 1; k <= count; k++)
        if (probability[order[k - 1]] * (double)count * harmonic <= (double)k * rate)
            rejected = k;
    return rejected;
}
