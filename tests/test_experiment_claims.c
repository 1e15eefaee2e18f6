/* The judgement of experiments: claims that hold, claims that fail, and events that never come. */
#include "support.h"

#include <math.h>

#include "cli/experiment.h"

enum { A, B, FIGURES };

/* Two variants with two seeds; figures a and b. */
static double figure[2][2][FIGURES];

static const cli_experiment *with(cli_claim claim)
{
    static cli_experiment e;
    e = (cli_experiment){.variant = {{"one", {NULL}, NULL}, {"two", {NULL}, NULL}},
                         .figure = {{"a", "", ""}, {"b", "", ""}}};
    e.claim[0] = claim;
    return &e;
}

static bool judged(cli_claim claim, bool small)
{
    cli_result r = {
        .experiment = with(claim), .variants = 2, .figures = FIGURES, .claims = 1, .seeds = 2, .finished = 4};
    r.figure = &figure[0][0][0];
    r.small = small;
    const bool all = cli_experiment_judge(&r);
    assert_true(all == r.holds[0]);
    return all;
}

static void set(double one_a, double one_b, double two_a, double two_b)
{
    for (int seed = 0; seed < 2; seed++) {
        figure[0][seed][A] = one_a;
        figure[0][seed][B] = one_b;
        figure[1][seed][A] = two_a;
        figure[1][seed][B] = two_b;
    }
}

static void a_bound_holds_or_fails(void **unused)
{
    (void)unused;
    set(1, 2, 3, 4);
    assert_true(judged((cli_claim){"b", "one", CLI_AT_LEAST, .plus = 2}, false));
    assert_false(judged((cli_claim){"b", "one", CLI_AT_LEAST, .plus = 2.001}, false));
    assert_true(judged((cli_claim){"a", "two", CLI_AT_MOST, .plus = 3}, false));
    assert_false(judged((cli_claim){"a", "two", CLI_AT_MOST, .plus = 2.999}, false));
}

static void figures_are_compared(void **unused)
{
    (void)unused;
    set(1, 2, 3, 4);
    assert_true(judged((cli_claim){"a", "two", CLI_AT_LEAST, .factor = 3, .of = "a", .of_variant = "one"}, false));
    assert_false(judged(
        (cli_claim){"a", "two", CLI_AT_LEAST, .plus = 0.01, .factor = 3, .of = "a", .of_variant = "one"}, false));
    assert_false(judged(
        (cli_claim){"a", "two", CLI_AT_MOST, .plus = -0.01, .factor = 3, .of = "a", .of_variant = "one"}, false));
}

static void every_seed_must_show_it(void **unused)
{
    (void)unused;
    const cli_claim claim = {"a", "one", CLI_AT_LEAST, .plus = 1};
    set(1, 2, 3, 4);
    assert_true(judged(claim, false));
    figure[0][1][A] = 0.9;
    assert_false(judged(claim, false));
    figure[0][1][A] = NAN;
    assert_false(judged(claim, false));
}

static void an_event_that_never_comes_is_late_only_where_that_is_meant(void **unused)
{
    (void)unused;
    set(INFINITY, 2, INFINITY, 4);
    assert_false(judged((cli_claim){"a", "one", CLI_AT_LEAST, .factor = 1, .of = "b", .of_variant = "one"}, false));
    assert_true(judged(
        (cli_claim){"a", "one", CLI_AT_LEAST, .factor = 1, .of = "b", .of_variant = "one", .or_never = true}, false));
    assert_false(judged(
        (cli_claim){"a", "one", CLI_AT_MOST, .factor = 1, .of = "b", .of_variant = "one", .or_never = true}, false));
    assert_false(judged(
        (cli_claim){"a", "one", CLI_AT_LEAST, .factor = 1, .of = "a", .of_variant = "two", .or_never = true}, false));
    assert_false(judged(
        (cli_claim){"a", "one", CLI_AT_MOST, .factor = 1, .of = "a", .of_variant = "two", .or_never = true}, false));
    assert_true(judged((cli_claim){"b", "one", CLI_AT_MOST, .factor = 0.2, .of = "a", .of_variant = "two"}, false));
}

static void a_small_version_need_not_show_all(void **unused)
{
    (void)unused;
    const cli_claim claim = {"a", "one", CLI_AT_LEAST, .plus = 5, .not_small = true};
    set(1, 2, 3, 4);
    assert_false(judged(claim, false));
    assert_true(judged(claim, true));
}

static void claims_are_told_in_words(void **unused)
{
    (void)unused;
    char text[256];
    cli_claim_text(&(cli_claim){"rise", "d = 50", CLI_AT_LEAST, .plus = 0.5}, text, sizeof text);
    assert_string_equal(text, "rise of d = 50 >= 0.5");
    cli_claim_text(&(cli_claim){"t", "none", CLI_AT_MOST, .factor = 0.2, .of = "t", .of_variant = "d = 50"}, text,
                   sizeof text);
    assert_string_equal(text, "t of none <= 0.2 x t of d = 50");
    cli_claim_text(&(cli_claim){"t", "none", CLI_AT_MOST, .plus = 2, .factor = 1, .of = "s", .of_variant = "d = 50"},
                   text, sizeof text);
    assert_string_equal(text, "t of none <= s of d = 50 + 2");
}

static void the_middle_of_the_seeds_is_told(void **unused)
{
    (void)unused;
    double values[3] = {3, INFINITY, 1}, range[3];
    cli_result r = {.variants = 1, .figures = 1, .seeds = 3, .finished = 3, .figure = values};
    cli_figure_range(&r, 0, 0, range);
    assert_true(range[0] == 1 && range[1] == 3 && isinf(range[2]));
    /* Of an interrupted experiment, those that are finished. */
    r.finished = 1;
    cli_figure_range(&r, 0, 0, range);
    assert_true(range[0] == 3 && range[1] == 3 && range[2] == 3);
    r.finished = 0;
    cli_figure_range(&r, 0, 0, range);
    assert_true(isnan(range[0]) && isnan(range[1]) && isnan(range[2]));
}

/* All variants run with the first seed, then with the second: what is interrupted lacks seeds of the last variants. */
static void each_variant_counts_the_seeds_that_are_finished(void **unused)
{
    (void)unused;
    for (size_t finished = 0; finished <= 9; finished++) {
        const cli_result r = {.variants = 3, .seeds = 3, .finished = finished};
        uint32_t seeds[3] = {0, 0, 0};
        for (size_t k = 0; k < finished; k++)
            seeds[k % 3]++;
        for (uint32_t variant = 0; variant < 3; variant++)
            assert_int_equal(cli_finished_seeds(&r, variant), seeds[variant]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bound_holds_or_fails),
        cmocka_unit_test(figures_are_compared),
        cmocka_unit_test(every_seed_must_show_it),
        cmocka_unit_test(an_event_that_never_comes_is_late_only_where_that_is_meant),
        cmocka_unit_test(a_small_version_need_not_show_all),
        cmocka_unit_test(claims_are_told_in_words),
        cmocka_unit_test(the_middle_of_the_seeds_is_told),
        cmocka_unit_test(each_variant_counts_the_seeds_that_are_finished),
    };
    return cmocka_run_group_tests_name("experiment_claims", tests, NULL, NULL);
}
