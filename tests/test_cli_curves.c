/*
 * `rheolog curves` from outside. The digits below were computed with independent code, from Eq. 3 of the paper and the
 * signals of its Figs. 3 and 4, before this library existed; the plateaus also with 40 digits. They are compared to half
 * a unit of the last one.
 */
#define _POSIX_C_SOURCE 200809L
#include "cli_support.h"

#include <math.h>
#include <sys/stat.h>

/* Moves to the JSON object of a curve: the k-th line of the output. */
static const char *line_of(int k)
{
    const char *line = out;
    for (; k > 0; k--) {
        line = strchr(line, '\n');
        assert_non_null(line);
        line++;
    }
    return line;
}

static void assert_digits(double value, double digits, double unit, const char *what)
{
    if (!(fabs(value - digits) <= .5001 * unit))
        fail_msg("%s is %.17g, not %.9f", what, value, digits);
}

static int lines(const char *text)
{
    int count = 0;
    for (; *text; text++)
        count += *text == '\n';
    return count;
}

/* ---- The digits ---- */

enum { LAGS = 8 };

static void weights_have_the_known_digits(void **state)
{
    (void)state;
    static const double weight[3][LAGS] = {
        {1.482202253, 1.260269549, 1.044525624, .908760720, .658524543, .528621261, .477281531, .415497606},
        {.828427125, .539298173, .336258682, .237319491, .106068669, .061237414, .047434212, .033541028},
        {.297396710, .142399399, .066549515, .038083244, .010496780, .004358535, .002896410, .001663548}};
    static const double first_50[3] = {.329701308, .053211125, .005276383};
    static const double first_500[3] = {.207776503, .016776104, .000832218};
    /* D^q x at constant speed 1 with the windows 50, 150, 250 and 500 */
    static const double plateau[3][4] = {{1.615527864, 3.870005282, 5.817396, 10.120587862},
                                         {1.456652452, 2.514664666, 3.244261272, 4.585788830},
                                         {1.206250272, 1.500677794, 1.661659, 1.908363445}};
    assert_code(0, run("curves weights --json"));
    assert_int_equal(lines(out), 3);
    for (int q = 0; q < 3; q++) {
        const char *at = line_of(q);
        for (int k = 0; k < LAGS; k++) {
            assert_digits(number_after(&at, "value"), weight[q][k], 1e-9, "a weight");
            const double first = number_after(&at, "first_weight"), sum = number_after(&at, "sum");
            if (k == 4 || k == 7)
                assert_digits(first, k == 4 ? first_50[q] : first_500[q], 1e-9, "a first weight");
            if (k >= 4) /* two of them are known to six digits */
                assert_digits(sum, plateau[q][k - 4], k == 6 && q != 1 ? 1e-6 : 1e-9, "a plateau");
        }
    }
}

/* Checks the curves of the whole history, which are the last of each order. */
static void check_signal(const char *name, const double peak[3], const double peak_at[3], const double values[3][2])
{
    assert_code(0, run("curves %s --json", name));
    assert_int_equal(lines(out), 15);
    for (int q = 0; q < 3; q++) {
        const char *at = line_of(5 * q + 4);
        assert_in("\"window\": null", at);
        const double found = number_after(&at, "peak");
        if (peak) {
            assert_digits(found, peak[q], 1e-9, "a peak");
            assert_true(number_after(&at, "peak_at") == peak_at[q]);
        }
        for (int k = 0; k < 2; k++)
            assert_digits(number_after(&at, "value"), values[q][k], 1e-9, name);
    }
}

static void stiffness_after_an_impact_has_the_known_digits(void **state)
{
    (void)state;
    static const double peak[3] = {1.109634582, 1.875784809, 3.321230936}, peak_at[3] = {38, 37, 36};
    static const double values[3][2] = {
        {.608940399, .394774894}, {.318643149, .107823892}, {.098013346, .017310100}}; /* n = 100, 600 */
    check_signal("impact", peak, peak_at, values);
}

static void stiffness_of_steady_motion_has_the_known_digits(void **state)
{
    (void)state;
    static const double values[3][2] = {
        {2.085785913, 2.971418971}, {1.708848238, 1.133682319}, {1.285809546, .255515452}}; /* n = 100, 300 */
    check_signal("steady", NULL, NULL, values);
    /* A window that the motion fills has its plateau. */
    static const double plateau[3][2] = {
        {1.615527864, 3.870005282}, {1.456652452, 2.514664666}, {1.206250272, 1.500677794}}; /* d = 50, 150 */
    for (int q = 0; q < 3; q++)
        for (int d = 0; d < 2; d++) {
            const char *at = line_of(5 * q + d);
            assert_digits(number_after(&at, "peak"), plateau[q][d], 1e-9, "a plateau");
        }
}

/* ---- Windows and kinds ---- */

/* Reads column k of a line of CSV as text. */
static const char *cell(const char *line, int k, char text[32])
{
    for (; k > 0; k--)
        line += strcspn(line, ",\n") + 1;
    snprintf(text, 32, "%.*s", (int)strcspn(line, ",\n"), line);
    return text;
}

static void a_window_is_exact_until_it_cuts(void **state)
{
    (void)state;
    assert_code(0, run("curves steady --order 0.5 --window 50,full --csv"));
    assert_in("step,time,velocity,window_50_q0.5,window_full_q0.5\n0,0,0,0,0\n", out);
    assert_int_equal(lines(out), 1501);
    const char *line = out;
    for (int n = 0; n < 1500; n++) {
        char windowed[32], whole[32];
        line = strchr(line, '\n') + 1;
        const bool same = strcmp(cell(line, 3, windowed), cell(line, 4, whole)) == 0;
        assert_int_equal(same, n - 31 <= 50);
        if (n > 181 + 50)
            assert_string_equal(windowed, "0");
    }
    /* Each step as the text table has it. */
    assert_code(0, run("curves steady --order 0.5 --window 50"));
    assert_in("\n  0.5 window         50  1.456652452    81   195   231  1.456652452  0.000000000\n", out);
    assert_code(0, run("curves steady --order 0.5 --window 50 --json"));
    const char *at = out;
    assert_true(number_after(&at, "half_at") == 195 && number_after(&at, "hundredth_at") == 231);
}

static void other_kinds_are_compared_with_the_window(void **state)
{
    (void)state;
    for (int steady = 0; steady < 2; steady++) {
        assert_code(0, run("curves %s --kind window,window-fast,full,tempered --window 150 --json",
                           steady ? "steady" : "impact"));
        assert_int_equal(lines(out), 12);
        for (int q = 0; q < 3; q++) {
            const char *at = line_of(4 * q);
            assert_in("\"kind\": \"window\"", at);
            assert_in("\"difference\": null, \"difference_at\": null, \"fit_error\": null", at);
            for (int k = 1; k < 4; k++) {
                at = line_of(4 * q + k);
                const double difference = number_after(&at, "difference"), error = number_after(&at, "fit_error");
                assert_true(error > 1e-6 && error < 2e-3);
                if (k < 3)
                    assert_true(difference > 1e-7 && difference < 1e-4);
                else
                    assert_true(difference > 5e-3 && difference < .5);
            }
        }
    }
    assert_code(0, run("curves impact --kind full --order 0.5"));
    assert_in("\n  0.5 full            -  1.875784", out);
    assert_in("to window, at: largest difference", out);
    /* Weights of fits are near the exact ones; beyond the window there are none. */
    assert_code(0, run("curves weights --kind window,window-fast --window 100 --order 0.5 --at 100,101 --json"));
    const char *exact = out, *fast = line_of(1);
    const double c_100 = number_after(&exact, "value"), fitted = number_after(&fast, "value");
    assert_true(fabs(fitted / c_100 - 1) < 5e-4 && fitted != c_100);
    assert_true(number_after(&exact, "value") == 0 && number_after(&fast, "value") == 0);
    assert_code(0, run("curves weights --kind tempered --order 0.5 --at 150"));
    assert_in("\n  0.5 tempered      150    150  0.0279", out); /* c_150 exp(-Gamma(1.5)^2) = .06124 * .4559 */
    assert_null(strstr(out, "to window"));
}

static void options_choose_the_sum(void **state)
{
    (void)state;
    assert_code(0, run("curves weights --weights l1 --order 0.5 --at 0,1 --json"));
    const char *at = out;
    assert_true(number_after(&at, "value") == 1);
    assert_digits(number_after(&at, "value"), .414213562, 1e-9, "b_1 = sqrt 2 - 1");
    assert_in("\"first_weight\": null", out);
    /* Another step has the same signal, with as many steps as it needs. */
    assert_code(0, run("curves steady --step 0.5 --order 0.25 --window full --at 2,3 --json"));
    assert_in("\"step\": 0.5, \"count\": 99, ", out);
    assert_in("\"at\": [{\"step\": 2, \"value\": 0}, {\"step\": 3, \"value\": ", out);
    at = strstr(out, "\"step\": 3");
    assert_digits(number_after(&at, "value"), pow(.5, .75) / tgamma(2.75), 1e-12, "C0");
    assert_code(0, run("curves impact --count 20 --order 0.5 --window 3 --json"));
    assert_in("\"peak\": 0, \"peak_at\": 0, \"half_at\": 0, \"hundredth_at\": 0", out);
    assert_in("\"at\": []", out);
    assert_code(0, run("curves impact --count 40 --order 0.5 --window 3"));
    assert_in("     -     -            -            -\n", out);
}

/* ---- Files ---- */

static void curves_are_written_to_files(void **state)
{
    (void)state;
    assert_code(0, run("curves impact --csv --order 0.5 --window 50,full"));
    char *printed = strdup(out);
    assert_non_null(printed);
    assert_code(0, run("curves impact --order 0.5 --window 50,full -o curves.csv"));
    assert_in("|D^q x|, history stiffness over k_hist, L/T^q, after an impact (Fig. 3)\n", out);
    size_t size;
    char *written = read_bytes("curves.csv", &size);
    assert_int_equal(size, strlen(printed));
    assert_memory_equal(written, printed, size);
    free(printed);
    assert_code(2, run("curves impact -o curves.csv"));
    assert_one_message("curves.csv exists; give --force");
    assert_code(0, run("curves weights -o curves.csv --force --json"));
    written = read_bytes("curves.csv", &size);
    assert_int_equal(
        strncmp(written, "lag,window_full_q0.2,window_full_q0.5,window_full_q0.8\n0,1,1,1\n1,1.48220225318449", 76),
        0);
    for (int k = 0; k < 3; k++) {
        static const char *const names[] = {"weights", "impact", "steady"};
        assert_code(0, run("curves %s -o curves.svg --force", names[k]));
        written = read_bytes("curves.svg", &size);
        assert_in("<svg xmlns=\"http://www.w3.org/2000/svg\" ", written);
        assert_in(k ? ">full history</text>" : ">q = 0.8</text>", written);
        assert_true(size < 20000);
    }
    /* Kinds are in the names of curves; none is called like another. */
    assert_code(0, run("curves impact --kind window,full,tempered --window 50,full -o curves.svg --force"));
    written = read_bytes("curves.svg", &size);
    static const char *const entries[] = {">window, d = 50</text>", ">window, full history</text>", ">full</text>",
                                          ">tempered, d = 50</text>"};
    for (int k = 0; k < 4; k++)
        assert_in(entries[k], written);
    remove("curves.csv");
    remove("curves.svg");
    assert_int_equal(mkdir("curves.svg", 0700), 0);
    assert_code(2, run("curves impact -o curves.svg --force"));
    assert_one_message("curves.svg is no regular file");
    remove("curves.svg");
}

/* From step d on, the oldest sample in the window is an interior one, as all are with weights l1 and in fits. */
static void a_first_weight_is_that_of_a_sample_in_the_window(void **state)
{
    (void)state;
    static const struct {
        const char *options;
        bool known[4];
    } sums[] = {{"--window full", {true, true, true, true}},
                {"--window 20", {true, false, false, false}},
                {"--window 21", {true, true, false, false}},
                {"--window full --weights l1", {false, false, false, false}},
                {"--window 20 --kind window-fast", {false, false, false, false}},
                {"--kind full", {false, false, false, false}}};
    double first[4];
    for (size_t k = 0; k < sizeof sums / sizeof *sums; k++) {
        assert_code(0, run("curves weights --order 0.5 --at 19,20,21,40 %s --json", sums[k].options));
        const char *at = out;
        for (int i = 0; i < 4; i++) {
            at = strstr(at, "\"first_weight\": ");
            assert_non_null(at);
            at += strlen("\"first_weight\": ");
            if ((strncmp(at, "null", 4) != 0) != sums[k].known[i])
                fail_msg("%s: first weight %d is %.12s", sums[k].options, i, at);
            const double value = strncmp(at, "null", 4) == 0 ? first[i] : number_at(&at);
            if (k == 0)
                first[i] = value;
            assert_true(value > 0 && value == first[i]);
        }
    }
}

/* The whole sum is black; the other curves have the other colours in turn. */
static void neighbouring_curves_have_different_colours(void **state)
{
    (void)state;
    static const char *const colour[] = {"#0072b2", "#d55e00", "#009e73", "#000000", "#cc79a7", "#e69f00", "#56b4e9",
                                         "#666666", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00"};
    size_t size;
    assert_code(0, run("curves impact --order 0.5 --kind window,tempered --window 50,60,70,full,80,90,99 --count 120 "
                       "-o colours.svg --force"));
    char *svg = read_bytes("colours.svg", &size);
    const char *at = svg;
    svg[size] = 0;
    for (size_t i = 0; i < sizeof colour / sizeof *colour; i++) {
        at = strstr(at, "stroke-width=\"1.8\" stroke=\"");
        assert_non_null(at);
        at += strlen("stroke-width=\"1.8\" stroke=\"");
        assert_memory_equal(at, colour[i], 7);
    }
    assert_null(strstr(at, "stroke-width=\"1.8\" stroke=\""));
    remove("colours.svg");
}

static void bad_usage_is_refused(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"", "needs one of weights, impact and steady"},
        {"impact steady", "got 2 operands"},
        {"impakt", "did you mean \"impact\"?"},
        {"springs", "there are weights, impact and steady"},
        {"impact --order 1", "--order needs numbers between 0 and 1"},
        {"impact --order 0.5,", "got \"\""},
        {"impact --order 0,5", "got \"0\""},
        {"impact --order nan", "got \"nan\""},
        {"impact --order 0.5,.3,.50", "--order names .50 twice"},
        {"impact --window 50,full,050", "--window names 050 twice"},
        {"impact --window full,full", "--window names full twice"},
        {"impact --at 1,2,1", "--at names 1 twice"},
        {"impact --order .1,.2,.3,.4,.5,.6,.7,.8,.9", "--order takes at most 8 values"},
        {"impact --window 0", "--window needs whole numbers"},
        {"impact --window 50,ful", "got \"ful\""},
        {"impact --window 1000001", "1 to 1000000"},
        {"impact --kind windows", "did you mean \"window\"?"},
        {"impact --kind x", "there are window, window-fast, full and tempered"},
        {"impact --kind full,full", "names full twice"},
        {"impact --kind full --window 50", "does not go with --window"},
        {"impact --kind tempered --window full", "kind tempered needs a window"},
        {"impact --weights l2", "paper or l1"},
        {"impact --step 0", "--step needs a number"},
        {"impact --step 1e-7", "too many steps"},
        {"impact --step 1000", "too few steps"},
        {"impact --count 0", "--count needs 1 to 100000"},
        {"impact --at 1500", "beyond the last step, 1499"},
        {"weights --at 501", "beyond the last lag, 500"},
        {"impact --at 1,x", "--at needs whole numbers"},
        {"impact --csv --json", "one of --csv and --json"},
        {"impact --force", "--force goes with -o"},
        {"impact -o x.png", "ends in .csv or .svg"},
        {"impact -o no/such/x.svg", "no/such"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const int code = run("curves %s", cases[i][0]);
        if (code != 2)
            fail_msg("exit code %d: curves %s", code, cases[i][0]);
        assert_one_message(cases[i][1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_have_the_known_digits),
        cmocka_unit_test(stiffness_after_an_impact_has_the_known_digits),
        cmocka_unit_test(stiffness_of_steady_motion_has_the_known_digits),
        cmocka_unit_test(a_window_is_exact_until_it_cuts),
        cmocka_unit_test(other_kinds_are_compared_with_the_window),
        cmocka_unit_test(options_choose_the_sum),
        cmocka_unit_test(curves_are_written_to_files),
        cmocka_unit_test(a_first_weight_is_that_of_a_sample_in_the_window),
        cmocka_unit_test(neighbouring_curves_have_different_colours),
        cmocka_unit_test(bad_usage_is_refused),
    };
    return cmocka_run_group_tests_name("cli_curves", tests, set_up, tear_down);
}
