/* The figures of experiments with a ball, measured from series made by hand. */
#include "support.h"

#include <math.h>

#include "cli/experiment.h"

/* A figure by its name. */
static double figure_of(const cli_experiment *e, const cli_series *s, const char *name)
{
    double figure[CLI_MOST_FIGURES];
    e->measure(s, figure);
    for (size_t f = 0; f < CLI_MOST_FIGURES && e->figure[f].name; f++)
        if (!strcmp(e->figure[f].name, name))
            return figure[f];
    fail_msg("no figure %s", name);
    return NAN;
}

#define FIGURE(experiment, series, name, expected) NEAR(figure_of(&(experiment), &(series), name), expected, 1e-12)

/* Depth, position, velocity and rolling speed; the times are the rows, half a unit later. */
static double ball_that_bounces[][4] = {
    {-1, 5, 10, 0},     {-0.5, 7, 10, 0},    {0.5, 9, 10, 0}, /* in contact in the middle between these */
    {1, 12, 8, 4},                                            /* the dip */
    {0.6, 15, 6, 5.5},                                        /* rolls: its spin is within a tenth */
    {0.4, 18, 4, 4.3},                                        /* the top, and the last row that rolls */
    {0.45, 21, 2, 1.5}, {0.5, 25, 0.4, 0.4},                  /* too slow to count */
    {1.25, 30, 0, 0},                                         /* stands still */
    {1.75, 29, 1, 1},                                         /* drifts: it no longer rolls */
    {2.25, 28, 0, 0},
};
static double time_of_row[40];

static cli_series series_of(double *value, size_t rows, uint32_t columns)
{
    for (size_t row = 0; row < 40; row++)
        time_of_row[row] = (double)row + 0.5;
    return (cli_series){.rows = rows, .columns = columns, .value = value, .time = time_of_row};
}

static void a_ball_that_bounces_rolls_and_sinks_has_its_figures(void **unused)
{
    (void)unused;
    const cli_experiment e = cli_experiment_ball;
    const cli_series s = series_of(ball_that_bounces[0], 11, 4);
    const double contact = 2; /* half way between the times of rows 1 and 2 */
    FIGURE(e, s, "contact", contact);
    FIGURE(e, s, "dip_at", 3.5 - contact);
    FIGURE(e, s, "dip", 1);
    FIGURE(e, s, "top_at", 5.5 - contact);
    FIGURE(e, s, "rise", 0.6);
    FIGURE(e, s, "rolls_at", 4.5 - contact);
    FIGURE(e, s, "rolls_until", 5.5 - contact);
    FIGURE(e, s, "stops_at", 8.5 - contact);
    FIGURE(e, s, "stops_depth", 1.25);
    FIGURE(e, s, "way", 25);
    FIGURE(e, s, "t_1.5R", 9 - contact);
    FIGURE(e, s, "t_2R", 10 - contact);
    FIGURE(e, s, "depth", 2.25);
}

static void scheme_positions_shows_four_of_these_figures(void **unused)
{
    (void)unused;
    const cli_series s = series_of(ball_that_bounces[0], 11, 4);
    static const char *const name[] = {"dip", "rise", "t_1.5R", "t_2R"};
    for (size_t f = 0; f < 4; f++)
        FIGURE(cli_experiment_positions, s, name[f], figure_of(&cli_experiment_ball, &s, name[f]));
}

static void a_ball_that_only_sinks_never_turns_rolls_or_stops(void **unused)
{
    (void)unused;
    double value[][4] = {{-1, 0, 10, 0}, {1, 3, 10, 0}, {1.25, 6, 10, 0}, {1.75, 9, 10, 0}};
    const cli_series s = series_of(value[0], 4, 4);
    static const char *const never[] = {"dip_at", "top_at", "rolls_at", "rolls_until", "stops_at", "t_2R"};
    for (size_t f = 0; f < sizeof never / sizeof never[0]; f++)
        assert_true(figure_of(&cli_experiment_ball, &s, never[f]) == INFINITY);
    assert_true(isnan(figure_of(&cli_experiment_ball, &s, "stops_depth")));
    FIGURE(cli_experiment_ball, s, "rise", 0);
    FIGURE(cli_experiment_ball, s, "dip", 1.75);
    FIGURE(cli_experiment_ball, s, "way", 9);
    FIGURE(cli_experiment_ball, s, "t_1.5R", 3 - 1);
}

/* Velocity and height above the floor in radii: the velocity rises, falls and rises again; 18 rows are above .5 R. */
static void the_turns_of_a_ball_that_settles_are_counted(void **unused)
{
    (void)unused;
    double value[30][3];
    for (int row = 0; row < 30; row++) {
        const double rising = 0.1 * row, falling = 1 - 0.05 * (row - 10), again = 0.7 + 0.1 * (row - 16);
        value[row][0] = row <= 10 ? rising : row <= 16 ? falling : again;
        value[row][1] = 5 - 0.25 * row;
        value[row][2] = 0;
    }
    cli_series s = series_of(value[0], 30, 3);
    FIGURE(cli_experiment_settling, s, "turns", 2);
    /* The mean of the five rows about row 11. */
    FIGURE(cli_experiment_settling, s, "fastest", (0.9 + 1 + 0.95 + 0.9 + 0.85) / 5);
    FIGURE(cli_experiment_settling, s, "floor_at", 18.5);
    /* It stays above the floor; the velocity turns back by less than counts. */
    for (int row = 0; row < 30; row++) {
        value[row][0] = 0.1 * row - (row > 12 ? 0.1 : 0);
        value[row][1] = 0.75;
    }
    FIGURE(cli_experiment_settling, s, "turns", 0);
    FIGURE(cli_experiment_settling, s, "fastest", 2.6);
    assert_true(figure_of(&cli_experiment_settling, &s, "floor_at") == INFINITY);
    s.rows = 4; /* no mean of five rows */
    FIGURE(cli_experiment_settling, s, "turns", 0);
    FIGURE(cli_experiment_settling, s, "fastest", 0);
}

static void the_deepest_point_of_a_foot_and_its_time_are_found(void **unused)
{
    (void)unused;
    double value[][2] = {{0, 0.25}, {1.5, 0.25}, {1.25, 0.25}, {2.5, 0.25}, {2, 0.25}};
    const cli_series s = series_of(value[0], 5, 2);
    FIGURE(cli_experiment_runner, s, "cadence", 0.25);
    FIGURE(cli_experiment_runner, s, "deepest", 2.5);
    FIGURE(cli_experiment_runner, s, "t_1.5R", 3.5);
    const cli_series cut = series_of(value[0], 3, 2);
    assert_true(figure_of(&cli_experiment_runner, &cut, "t_1.5R") == INFINITY);
}

static void turns_of_a_series_are_found(void **unused)
{
    (void)unused;
    double value[][2] = {{0, 3}, {0, 2}, {0, 2}, {0, 1}, {0, 4}, {0, 4}, {0, 3}};
    const cli_series s = series_of(value[0], 7, 2);
    assert_int_equal(cli_first_minimum(&s, 1, 0), 3);
    assert_int_equal(cli_first_maximum(&s, 1, 0), 0);
    assert_int_equal(cli_first_maximum(&s, 1, 3), 5); /* the last of equal values */
    assert_int_equal(cli_first_minimum(&s, 1, 5), 6); /* it falls to the end */
    assert_int_equal(cli_first_above(&s, 1, 3, 0), 4);
    assert_int_equal(cli_first_above(&s, 1, 3, 5), 5);
    assert_int_equal(cli_first_above(&s, 1, 4, 0), 7);
    assert_true(cli_time_of(&s, 6) == 6.5 && cli_time_of(&s, 7) == INFINITY);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_that_bounces_rolls_and_sinks_has_its_figures),
        cmocka_unit_test(scheme_positions_shows_four_of_these_figures),
        cmocka_unit_test(a_ball_that_only_sinks_never_turns_rolls_or_stops),
        cmocka_unit_test(the_turns_of_a_ball_that_settles_are_counted),
        cmocka_unit_test(the_deepest_point_of_a_foot_and_its_time_are_found),
        cmocka_unit_test(turns_of_a_series_are_found),
    };
    return cmocka_run_group_tests_name("experiment_figures", tests, NULL, NULL);
}
