/*
 * The studies steps, sweeps and springs of `rheolog bench error` from outside: closed forms, orders, and what the order of
 * pairs does. Closed forms are compared with the limit step -> 0 that follows from two steps, so a wrong form fails.
 */
#include "cli_support.h"

#include <math.h>

/* ---- CSV ---- */

static size_t cells_of(const char *line, char cell[][64], size_t most)
{
    for (size_t n = 1;; n++) {
        assert_true(n <= most);
        const bool quoted = *line == '"';
        line += quoted;
        const size_t length = strcspn(line, quoted ? "\"" : ",\n");
        snprintf(cell[n - 1], 64, "%.*s", (int)length, line);
        line += length + quoted;
        if (*line != ',')
            return n;
        line++;
    }
}

/* A number of a point in `out`; NaN: an empty cell. The point must exist. */
static double number_of(const char *at_scene, const char *setting, const char *quantity, const char *column)
{
    static char names[32][64], cells[32][64];
    const size_t count = cells_of(out, names, 32);
    for (const char *line = strchr(out, '\n') + 1; *line; line = strchr(line, '\n') + 1) {
        const char *number = NULL;
        bool same = true;
        assert_int_equal(cells_of(line, cells, 32), count);
        for (size_t i = 0; i < count; i++) {
            same = same && (strcmp(names[i], "scene") != 0 || strcmp(cells[i], at_scene) == 0) &&
                   (strcmp(names[i], "setting") != 0 || strcmp(cells[i], setting) == 0) &&
                   (strcmp(names[i], "quantity") != 0 || strcmp(cells[i], quantity) == 0);
            number = strcmp(names[i], column) == 0 ? cells[i] : number;
        }
        assert_non_null(number);
        if (same)
            return *number ? strtod(number, NULL) : (double)NAN;
    }
    fail_msg("no point %s, %s, %s", at_scene, setting, quantity);
    return NAN;
}

/* ---- Closed forms ---- */

/* The limit step -> 0 of a scheme whose error is of this order, from two steps. */
static double limit_of(const char *at_scene, const char *scheme, const char *quantity, int order)
{
    char fine[64], coarse[64];
    snprintf(fine, sizeof fine, "%s, step/2", scheme);
    snprintf(coarse, sizeof coarse, "%s, step", scheme);
    const double f = number_of(at_scene, fine, quantity, "value"), c = number_of(at_scene, coarse, quantity, "value");
    return order == 1 ? 2 * f - c : (4 * f - c) / 3;
}

#define NEAR(actual, expected, tolerance)                                     \
    do {                                                                      \
        const double near_ = (actual);                                        \
        if (!(fabs(near_ - (expected)) <= (tolerance)))                       \
            fail_msg("%s is %g, not %g", #actual, near_, (double)(expected)); \
    } while (0)

/* Measures waves once, for all tests. */
static void measure_waves(void)
{
    static char waves[sizeof out];
    if (*waves) {
        memcpy(out, waves, sizeof out);
        return;
    }
    assert_code(0, run("bench error --study steps --scenes block,elastic-shear-wave,shear-wave --csv --quiet"));
    memcpy(waves, out, sizeof out);
}

static void closed_forms_are_the_limits_of_the_schemes(void **state)
{
    (void)state;
    measure_waves();
    static const char *const schemes[] = {"summed", "sequential", "implicit"};
    for (size_t i = 0; i < 3; i++) {
        const double period = number_of("block", "summed, step", "period", "reference");
        NEAR(limit_of("block", schemes[i], "period", 2) / period, 1, 5e-4);
        NEAR(limit_of("block", schemes[i], "damping", 1), 0, 5e-4);
    }
    const double period = number_of("elastic-shear-wave", "summed, step", "period", "reference");
    NEAR(limit_of("elastic-shear-wave", "summed", "period", 2) / period, 1, 1e-4);
    NEAR(limit_of("elastic-shear-wave", "summed", "damping", 1), 0, 5e-4);
    const double decay = number_of("shear-wave", "summed, step", "decay", "reference");
    NEAR(limit_of("shear-wave", "summed", "decay", 1) / decay, 1, 1e-3);
    /* By hand: 8 masses in a row, and the sums over a cubic lattice of half the support. */
    NEAR(number_of("block", "summed, step", "period", "reference"), 3.14159265 / (sqrt(7.5) * sin(3.14159265 / 16)),
         1e-5);
    NEAR(period, 2 * 3.14159265 / sqrt(7.5 * (4. / 2 + 8. / 3) * (1 - cos(3.14159265 / 8))), 1e-4);
    NEAR(decay, 2 * (4 * (1 - sqrt(2) / 2) / 2 + 8 * (1 - sqrt(3) / 2) / 3), 1e-4);
    /* A substep damps a wave by half of the product of substep and angular frequency. */
    NEAR(number_of("block", "summed, step", "damping", "value"), .0165 / 2 * 2 * 3.14159265 / 5.8801, 1e-4);
    NEAR(number_of("block", "summed, substeps 8", "damping", "value"), .033 / 8 / 2 * 2 * 3.14159265 / 5.8801, 2e-4);
}

static void the_default_scheme_is_of_order_1(void **state)
{
    (void)state;
    measure_waves();
    static const char *const finer[] = {"summed, step/4", "summed, step/2"};
    for (size_t i = 0; i < 2; i++) {
        NEAR(number_of("block", finer[i], "damping", "order"), 1, .1);
        NEAR(number_of("elastic-shear-wave", finer[i], "damping", "order"), 1, .1);
        NEAR(number_of("shear-wave", finer[i], "decay", "order"), 1, .1);
        assert_true(number_of("block", finer[i], "damping", "error") > 0);
    }
    /* Viscosity acts once a step, so substeps do not change it. */
    NEAR(number_of("shear-wave", "summed, substeps 8", "decay", "value") /
             number_of("shear-wave", "summed, step", "decay", "value"),
         1, 1e-4);
    assert_true(isnan(number_of("block", "summed, step x 2", "damping", "order")));
}

static void pressures_carry_the_weight_where_no_pair_is_first(void **state)
{
    (void)state;
    assert_code(0, run("bench error --study sweeps --scenes hydrostatics --csv --quiet"));
    assert_true(fabs(number_of("hydrostatics", "summed, step", "pressure", "error")) < .003);
    assert_true(fabs(number_of("hydrostatics", "sequential, step", "pressure", "error")) > .1);
    const double order = number_of("hydrostatics", "sequential, step/2", "pressure", "order");
    assert_true(order > 1.5 && order < 3);
}

/* ---- Order of pairs ---- */

static void images_agree_where_no_pair_is_first(void **state)
{
    (void)state;
    assert_code(0, run("bench error --study sweeps --scenes image --steps 2 --csv --quiet"));
    static const char *const quantities[] = {"mirrored_1", "rotated_1", "renumbered_1"};
    for (size_t i = 0; i < 3; i++) {
        assert_true(number_of("image", "summed, step", quantities[i], "value") < 3e-6);
        assert_true(number_of("image", "sequential, step", quantities[i], "value") > 1e-3);
        assert_true(number_of("image", "sequential, step/2", quantities[i], "order") > 3);
    }
    assert_true(isnan(number_of("image", "summed, step", "mirrored", "value"))); /* not reached */
}

static void unknown_scenes_are_refused_with_those_that_there_are(void **state)
{
    (void)state;
    assert_code(2, run("bench error --study sweeps --scenes images"));
    assert_one_message("no study that was chosen has a scene \"images\"; there are image, free-drop, hydrostatics");
    assert_code(2, run("bench error --scenes ball,dorp"));
    assert_one_message("has a scene \"dorp\"; there are t^2, t^3, sine, ");
    assert_in(", ball, drop, block, ", err);
    assert_in(", bowling-ball-small, ", err);
    assert_code(2, run("bench error --scenes ball,"));
    assert_one_message("has a scene \"\"; there are ");
    assert_code(2, run("bench error --model melting --scenes image"));
    assert_one_message("has a scene \"image\"; there are ");
    assert_code(0, run("bench error --study history,sweeps --scenes image --steps 2 --csv --quiet"));
    assert_null(strstr(out, "history,")); /* a study without a chosen scene is left out */
}

/* ---- Stiff springs ---- */

/* k_hist = 100 k_min: explicit springs blow up, implicit ones are too soft, summed forces have neither fault. */
static void stiff_springs_are_held_and_right(void **state)
{
    (void)state;
    static const char at[] = "ball-100";
    assert_code(0, run("bench error --study springs --scenes %s --csv --quiet", at));
    const double limit = number_of(at, "summed, step", "dip", "reference");
    NEAR(2 * number_of(at, "summed, step/8", "dip", "value") - number_of(at, "summed, step/4", "dip", "value"), limit,
         1e-5);
    NEAR(number_of(at, "summed, step", "dip", "value") / limit - 1, number_of(at, "summed, step", "dip", "error"),
         1e-5);
    NEAR(number_of(at, "summed, step", "dip", "error"), 0, .03);
    assert_true(number_of(at, "softened, up to 2 substeps", "dip", "error") > .2);
    assert_true(isnan(number_of(at, "explicit, step", "dip", "error")));
    assert_true(number_of(at, "explicit, step/4", "dip", "error") < .1);
    assert_true(number_of(at, "implicit, step", "dip", "error") > .5);
    /* A depth near 0 has an absolute error. */
    NEAR(number_of(at, "summed, step", "depth_3", "value") - number_of(at, "summed, step", "depth_3", "reference"),
         number_of(at, "summed, step", "depth_3", "error"), 1e-5);
}

static void stiff_springs_have_their_points(void **state)
{
    (void)state;
    assert_code(0, run("bench error --study springs --settle 5 --steps 2 --csv --quiet"));
    assert_true(isnan(number_of("ball-10", "summed, step", "dip", "value")));
    assert_true(isnan(number_of("ball-10000", "implicit, step", "depth_3", "value")));
    assert_true(isnan(number_of("ball", "explicit, step", "ratio_reached", "value")));
    assert_true(number_of("ball-10", "summed, step/8", "dip", "steps") == 16);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms_are_the_limits_of_the_schemes),
        cmocka_unit_test(the_default_scheme_is_of_order_1),
        cmocka_unit_test(pressures_carry_the_weight_where_no_pair_is_first),
        cmocka_unit_test(images_agree_where_no_pair_is_first),
        cmocka_unit_test(unknown_scenes_are_refused_with_those_that_there_are),
        cmocka_unit_test(stiff_springs_are_held_and_right),
        cmocka_unit_test(stiff_springs_have_their_points),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
