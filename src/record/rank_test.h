/*
 * Tests of two samples by ranks, and the limit for many tests at once. Only sums, products and quotients, in a fixed
 * order: the verdict is the same on every machine.
 */
#ifndef RHEO__RECORD_RANK_TEST_H
#define RHEO__RECORD_RANK_TEST_H

#include "rheolog/base.h"

/* Most values of each sample. */
enum { RHEO__RANK_MOST = 64 };

/*
 * The test of Mann and Whitney for the values of two samples: their ranks among all values, and how the sum of the ranks of
 * the first sample is distributed if any of the values may be in it. Exact, also with equal values, which share the mean of
 * their ranks. Ranks and sums are doubled, so that they are whole numbers.
 */
typedef struct rheo__ranks_of {
    uint32_t first, all;                /* values of the first sample, and of both */
    uint32_t rank[2 * RHEO__RANK_MOST]; /* doubled, of the values in their order */
    bool ties;                          /* some values are equal */
} rheo__ranks_of;

/* From malloc: least[s] is the probability of a doubled sum <= s, for s below `sums`. */
typedef struct rheo__rank_sums {
    uint32_t first, all, sums;
    bool ties;
    double *least;
} rheo__rank_sums;

/* Ranks of `all` numbers that are finite, `first` of which are in the first sample. */
void rheo__rank(rheo__ranks_of *ranks, const double *values, uint32_t first, uint32_t all);
/*
 * The distribution of the sums of these ranks, unless *sums has it: without ties it depends only on the sizes. Begin with
 * zeros. False: no memory; *sums is as before.
 */
bool rheo__rank_sums_take(rheo__rank_sums *sums, const rheo__ranks_of *ranks);
void rheo__rank_sums_release(rheo__rank_sums *sums);
/* Two-sided probability of this doubled sum of ranks, or one farther from the mean. */
double rheo__rank_probability(const rheo__rank_sums *sums, uint32_t sum);

/*
 * Benjamini and Yekutieli: which of the tests, whatever their dependence, reject so that the expected share of false
 * rejections is at most `rate`. Orders `order`, the numbers of the tests, by their probability, and returns how many reject:
 * the first ones.
 */
uint32_t rheo__reject(const double *probability, uint32_t *order, uint32_t count, double rate);

#endif
