/* Rank tests against published tables, against all choices counted one by one, and the limit for many tests by hand. */
#include "support.h"

#include "record/rank_test.h"

static double probability(const double *values, uint32_t first, uint32_t all)
{
    rheo__ranks_of ranks;
    rheo__rank_sums sums = {0};
    uint32_t sum = 0;
    rheo__rank(&ranks, values, first, all);
    assert_true(rheo__rank_sums_take(&sums, &ranks));
    for (uint32_t i = 0; i < first; i++)
        sum += ranks.rank[i];
    const double p = rheo__rank_probability(&sums, sum);
    rheo__rank_sums_release(&sums);
    return p;
}

/* Two samples of n, of which `u` pairs have the larger value in the first: its largest values pass the second's, in turn. */
static double probability_of_u(uint32_t n, uint32_t u)
{
    double values[2 * RHEO__RANK_MOST];
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t passed = u < n ? u : n, at = n - 1 - i;
        values[at] = (double)passed - 0.5 + (double)at / (2 * n); /* those of the second are 0, 1, 2 ... */
        values[n + i] = i;
        u -= passed;
    }
    return probability(values, n, 2 * n);
}

static void small_samples_have_the_probabilities_that_one_can_count(void **state)
{
    (void)state;
    NEAR(probability((double[]){1, 2, 3, 4, 5, 6}, 3, 6), 2.0 / 20, 1e-15);
    NEAR(probability((double[]){6, 5, 4, 3, 2, 1}, 3, 6), 2.0 / 20, 1e-15);
    NEAR(probability((double[]){1, 2, 3, 4, 5, 6, 7, 8}, 4, 8), 2.0 / 70, 1e-15);
    NEAR(probability((double[]){1, 2, 3, 5, 4, 6, 7, 8}, 4, 8), 4.0 / 70, 1e-15);
    NEAR(probability((double[]){1, 1, 1, 1, 1, 1}, 3, 6), 1, 1e-15);
    rheo__ranks_of ranks; /* twice the ranks from 1 on */
    rheo__rank(&ranks, (double[]){5, 3, 4, 3}, 2, 4);
    assert_true(ranks.rank[0] == 8 && ranks.rank[1] == 3 && ranks.rank[2] == 6 && ranks.rank[3] == 3);
}

/* Largest U that rejects at 5 % and at 1 %, two-sided, in the tables of Mann and Whitney's test. */
static void the_limits_are_those_of_the_tables(void **state)
{
    (void)state;
    static const uint32_t TABLE[][3] = {{5, 2, 0},    {8, 13, 7},   {10, 23, 16},
                                        {12, 37, 27}, {15, 64, 51}, {20, 127, 105}};
    for (size_t i = 0; i < sizeof TABLE / sizeof *TABLE; i++)
        for (int level = 0; level < 2; level++) {
            const double rate = level ? 0.01 : 0.05;
            const uint32_t n = TABLE[i][0], u = TABLE[i][1 + level];
            if (probability_of_u(n, u) > rate || probability_of_u(n, u + 1) <= rate)
                fail_msg("n = %u: p(U = %u) = %g, p(U = %u) = %g", n, u, probability_of_u(n, u), u + 1,
                         probability_of_u(n, u + 1));
        }
}

/* With ties: every choice of the first sample, one by one. */
static void ties_have_the_probabilities_of_all_choices(void **state)
{
    (void)state;
    enum { ALL = 9, FIRST = 4 };
    static const double VALUES[ALL] = {3, 1, 2, 2, 3, 3, 5, 2, 7};
    rheo__ranks_of ranks;
    uint32_t sum = 0, choices = 0, below = 0, above = 0;
    rheo__rank(&ranks, VALUES, FIRST, ALL);
    assert_true(ranks.ties);
    for (uint32_t i = 0; i < FIRST; i++)
        sum += ranks.rank[i];
    for (uint32_t chosen = 0; chosen < 1 << ALL; chosen++) {
        uint32_t other = 0;
        if (__builtin_popcount(chosen) != FIRST)
            continue;
        for (uint32_t i = 0; i < ALL; i++)
            other += chosen >> i & 1 ? ranks.rank[i] : 0;
        choices++;
        below += other <= sum;
        above += other >= sum;
    }
    assert_int_equal(choices, 126);
    const uint32_t fewer = below < above ? below : above;
    NEAR(probability(VALUES, FIRST, ALL), 2.0 * fewer / choices < 1 ? 2.0 * fewer / choices : 1, 1e-14);
}

/* The distribution is kept for samples of the same sizes without ties, and made again for others. */
static void a_kept_distribution_serves_only_its_own_samples(void **state)
{
    (void)state;
    static const struct {
        double values[8];
        uint32_t first, all;
        bool kept;
    } samples[] = {
        {{1, 2, 3, 4, 5, 6}, 3, 6, false},       {{6, 1, 2, 5, 3, 4}, 3, 6, true},
        {{1, 2, 3, 4, 5, 6}, 2, 6, false},       {{1, 2, 3, 4, 5, 6, 7, 8}, 2, 8, false},
        {{1, 2, 2, 4, 5, 6, 7, 8}, 2, 8, false}, {{1, 2, 2, 4, 4, 6, 7, 8}, 2, 8, false},
        {{1, 2, 3, 4, 5, 6, 7, 8}, 2, 8, false}, {{8, 2, 3, 4, 5, 6, 7, 1}, 2, 8, true},
    };
    rheo__rank_sums sums = {0};
    for (size_t i = 0; i < sizeof samples / sizeof *samples; i++) {
        rheo__ranks_of ranks;
        uint32_t sum = 0;
        double before[256] = {0};
        const double *was = sums.least;
        if (was)
            memcpy(before, was, sums.sums * sizeof *before);
        rheo__rank(&ranks, samples[i].values, samples[i].first, samples[i].all);
        if (samples[i].kept)
            sums.least[0] = 7; /* is read again, if it is made again */
        assert_true(rheo__rank_sums_take(&sums, &ranks));
        assert_int_equal(sums.least[0] == 7, samples[i].kept);
        if (samples[i].kept)
            sums.least[0] = before[0];
        for (uint32_t k = 0; k < samples[i].first; k++)
            sum += ranks.rank[k];
        NEAR(rheo__rank_probability(&sums, sum), probability(samples[i].values, samples[i].first, samples[i].all), 0);
        NEAR(sums.least[sums.sums - 1], 1, 0);
    }
    rheo__rank_sums_release(&sums);
    assert_true(!sums.least && !sums.sums);
}

static void the_largest_samples_are_exact_too(void **state)
{
    (void)state;
    enum { N = RHEO__RANK_MOST };
    double apart[2 * N];
    for (uint32_t i = 0; i < 2 * N; i++)
        apart[i] = i;
    const double p = probability(apart, N, 2 * N); /* 2/C(128, 64) = 8e-38 */
    assert_true(p >= 0 && p < 1e-30);
    double mixed[2 * N];
    for (uint32_t i = 0; i < 2 * N; i++)
        mixed[i] = (double)(i < N ? 2 * i : 2 * (i - N) + 1);
    /* U is 64 x 63/2, 32 below its mean, whose standard deviation is 209.8: with the correction, z = .150. */
    NEAR(probability(mixed, N, 2 * N), 0.8807, 0.001);
}

static void benjamini_and_yekutieli_by_hand(void **state)
{
    (void)state;
    uint32_t order[4];
    /* Four tests at .05: 1 + 1/2 + 1/3 + 1/4 = 25/12, so the limits are .006, .012, .018, .024. */
    assert_int_equal(rheo__reject((double[]){.02, .001, .6, .008}, order, 4, .05), 2);
    assert_int_equal(order[0], 1);
    assert_int_equal(order[1], 3);
    assert_int_equal(order[2], 0);
    assert_int_equal(order[3], 2);
    /* The third is below its limit, so the second, which is not, rejects too. */
    assert_int_equal(rheo__reject((double[]){.005, .013, .0175, .5}, order, 4, .05), 3);
    assert_int_equal(rheo__reject((double[]){.0061, .0121, .0181, .0241}, order, 4, .05), 0);
    assert_int_equal(rheo__reject((double[]){.0239, .0239, .0239, .0239}, order, 4, .05), 4);
    for (uint32_t i = 0; i < 4; i++) /* equal ones keep their order */
        assert_int_equal(order[i], i);
    assert_int_equal(rheo__reject((double[]){.5}, order, 1, .5), 1); /* at the limit */
    assert_int_equal(rheo__reject(NULL, order, 0, .05), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_samples_have_the_probabilities_that_one_can_count),
        cmocka_unit_test(the_limits_are_those_of_the_tables),
        cmocka_unit_test(ties_have_the_probabilities_of_all_choices),
        cmocka_unit_test(a_kept_distribution_serves_only_its_own_samples),
        cmocka_unit_test(the_largest_samples_are_exact_too),
        cmocka_unit_test(benjamini_and_yekutieli_by_hand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
