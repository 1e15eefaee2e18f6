/* `rheolog rheometer` from outside: the block, the pair, the law of the melting model, output and refusals. */
#define _XOPEN_SOURCE 700 /* kill(), nanosleep() */
#include "cli_support.h"

#include <sys/stat.h>

#include <math.h>
#include <unistd.h>

static void assert_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance))
        fail_msg("%.12g is not %.12g +- %g", value, expected, tolerance);
}

static double figure(const char *name)
{
    const char *at = out;
    return number_after(&at, name);
}

/* ---- The pair ---- */

static void the_pair_has_its_closed_forms(void **state)
{
    (void)state;
    static const char *const kinds[] = {"window", "window-fast", "full", "tempered"};
    for (int i = 0; i < 4; i++) {
        assert_code(0, run("rheometer bowling-ball-small --pair amplitude --json --set history.kind=%s", kinds[i]));
        assert_true(figure("difference_below") <= 1e-6);
    }
    assert_code(0, run("rheometer bowling-ball-small --pair response stop --json"));
    const char *at = out;
    assert_true(number_after(&at, "difference_below") <= 1e-9); /* of the response */
    assert_true(number_after(&at, "time_to_1_e") > 0);
    /* The whole history answers like the springpot, the window does not. */
    at = strstr(out, "\"kind\": \"full\"");
    assert_non_null(at);
    assert_near(number_after(&at, "ratio"), 1, 2e-3);
}

/* L_k = L + (L0 - L)(1 - alpha step (1 + gamma))^k, L = r/(1 + gamma): r = 1.5, L0 = 1, k = 300 and 0.033 T. */
static void a_held_spring_relaxes_as_known(void **state)
{
    (void)state;
    assert_code(
        0, run("rheometer bowling-ball-small --pair stop -o held --set fluid.spacing=1 --set substeps=1 "
               "--set springs.plasticity=0.3 --set springs.yield_ratio=0.1 --gamma 0.5 --set scheme=sequential"));
    size_t size;
    const char *line = read_bytes("held/pair-stop.csv", &size);
    for (int row = 0; row < 301; row++)
        line = strchr(line, '\n') + 1;
    for (int column = 0; column < 3; column++)
        line = strchr(line, ',') + 1;
    assert_near(strtod(line, NULL), 1.350020503, 1e-8);
    assert_in("maxwell_time: 3.03 T", out);
    assert_code(0, run("rheometer bowling-ball-small --pair stop --set springs.plasticity=0"));
    assert_in("springs.plasticity is 0: the stress stays.", out);
}

static void the_fit_finds_the_parameters_of_the_scene(void **state)
{
    (void)state;
    static const double order[] = {.2, .5, .8};
    for (int i = 0; i < 3; i++) {
        assert_code(0, run("rheometer bowling-ball-small --pair amplitude --fit --json --set history.order=%g "
                           "--set history.stiffness=80 --set springs.stiffness=20",
                           order[i]));
        assert_near(figure("fit_q") / order[i], 1, .001);
        assert_near(figure("fit_q_by_omega") / order[i], 1, .01);
        assert_near(figure("fit_q_by_loss") / order[i], 1, .01);
        assert_near(figure("fit_k_hist"), 80, .1);
        assert_near(figure("fit_k_min"), 20, .02);
    }
    assert_code(0, run("rheometer bowling-ball-small --pair amplitude --fit --omega 1"));
    assert_in("No fit: it needs two frequencies or more", out);
    assert_in("fit_q: -\n", out);
}

static void a_fluid_without_history_is_linear(void **state)
{
    (void)state;
    assert_code(
        0, run("rheometer bowling-ball-small --pair amplitude --set history.stiffness=0 --omega 1 --gamma 0.01"));
    assert_in("elastic: tan delta is 0\n", out); /* it was -1.48e-17 */
    assert_in("linear: no history at these strains\n", out);
}

/* ---- The block ---- */

static void a_block_has_all_protocols(void **state)
{
    (void)state;
    static const char *const files[][2] = {{"flow", "shear_rate,stress,viscosity,"},
                                           {"startup", "time,strain,stress\n"},
                                           {"stop", "time,stress\n"},
                                           {"amplitude", "omega,gamma0,G_prime,G_double_prime,tan_delta,I3_I1,"},
                                           {"creep", "time,strain,stress,"}};
    size_t size;
    assert_code(0, run("rheometer bowling-ball-small --small --quiet -o block"));
    assert_in("\nflow: shear thickening, stress up to rate^1.", out); /* the history stiffens */
    assert_in("\noscillation at ", out);
    assert_in("elastic, tan delta 0.0", out);
    assert_in("\nmemory: hysteresis, loop ", out);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char name[64];
        snprintf(name, sizeof name, "block/%s-small.csv", files[i][0]);
        assert_memory_equal(read_bytes(name, &size), files[i][1], strlen(files[i][1]));
        snprintf(name, sizeof name, "block/%s-small.svg", files[i][0]);
        assert_memory_equal(read_bytes(name, &size), "<svg ", 5);
    }
}

static void a_block_without_history_has_a_yield_stress_and_no_loop(void **state)
{
    (void)state;
    assert_code(0, run("rheometer bowling-ball-small flow --small --quiet --json --set history.stiffness=0 --rate "
                       "0.015,0.03,0.06,0.12,0.25,0.5"));
    assert_true(figure("yield_stress") > 2 && figure("yield_stress") < 8); /* docs/model.md: springs 3.2, fluid 4 */
    assert_true(fabs(figure("loop_share")) < .1);
    assert_in("\"flow: yield stress ", out);
}

/* Springs with the moduli of the block: docs/model.md, times 1.46 of its network_factor. It printed the modulus of the block. */
static void the_fit_of_a_block_is_of_springs(void **state)
{
    (void)state;
    assert_code(0, run("rheometer bowling-ball-small amplitude --small --quiet --json --fit --gamma .01,.03 "
                       "--omega .4,.2"));
    assert_near(figure("fit_k_min"), 15 * 1.46, 2);
    assert_near(figure("fit_k_hist"), 150 * 1.46, 40);
}

/* --rate 0.5,0.25 went down first, and --rate 3 printed "not a number". */
static void values_are_sorted_and_unknown_ones_are_not_told(void **state)
{
    (void)state;
    assert_code(0, run("rheometer bowling-ball-small flow --small --quiet --rate 0.5,0.25,0.5 -o sorted"));
    size_t size;
    const char *const bytes = (const char *)read_bytes("sorted/flow-small.csv", &size), *at = bytes;
    static const double rates[] = {.25, .5, .5, .25};
    for (int i = 0; i < 4; i++) {
        at = strchr(at, '\n') + 1;
        assert_near(strtod(at, NULL), rates[i], 1e-12);
    }
    assert_ptr_equal(strchr(at, '\n') + 1, bytes + size); /* no row of the second 0.5 */
    assert_code(0, run("rheometer bowling-ball-small flow --small --quiet --rate 3"));
    assert_in("\nflow: stress ", out);
    assert_in(" at 3 1/T; its law needs more rates\n\n", out);
    assert_null(strstr(out, "not a number"));
}

/* Rows with steady = 0 were part of the loop and the fit, and a stop said nothing of a flow that was not steady. */
static void unsteady_rows_are_left_out(void **state)
{
    (void)state;
    assert_code(0, run("rheometer bowling-ball-small flow --small --quiet --rate .25,.5"));
    assert_in("   up       0 ", out);
    assert_in("\nloop_area: - L^2/T^3\nloop_share: -\n", out);
    assert_in("The fit (yield_stress, exponent, consistency) leaves them out, ", out);
    assert_code(0, run("rheometer bowling-ball-small stop --small --quiet --rate .5"));
    assert_in("\nnote: The last stress of the flow is no steady one: ", out);
}

static void creep_tells_what_it_leaves_out(void **state)
{
    (void)state;
    assert_code(0, run("rheometer bowling-ball-small creep --small --quiet --stress 1,2,3,4,5,13"));
    assert_in("\nstress_5: 5 L^2/T^2\n", out);
    assert_in("\nnote: The figures are of the first 5 stresses; ", out);
    assert_code(0, run("rheometer bowling-ball-small creep --small --quiet --stress 13"));
    assert_in("\ncreep: under 13 L^2/T^2 it creeps on, at no steady rate (", out);
}

/* Its overshoot was one of "memory". */
static void fluid_without_springs_has_no_memory(void **state)
{
    (void)state;
    assert_code(0, run("rheometer bowling-ball-small startup --small --quiet --set springs.stiffness=0 --rate 1"));
    assert_in("\na start overshoots by ", out);
}

/* A block whose plates move too fast for its inertia was "elastic". */
static void inertia_is_not_called_elastic(void **state)
{
    (void)state;
    assert_code(0, run("rheometer bowling-ball-small amplitude --small --quiet --omega 20 --gamma .01"));
    assert_in("\noscillation: inertia or unsteadiness hides ", out);
}

static void a_viscous_block_is_newtonian(void **state)
{
    (void)state;
    assert_code(
        0, run("rheometer bowling-ball-small flow --small --quiet --json --set springs.stiffness=0 --set step=0.001 "
               "--set fluid.linear_viscosity=100 --set fluid.quadratic_viscosity=0 --rate 1,1.2,1.4,1.7,2,2.8"));
    assert_near(figure("exponent"), 1, .06);
    assert_near(figure("consistency"), 34, 4); /* its pairs have 30 to 38, by their directions */
    assert_true(fabs(figure("loop_share")) < .08);
}

static void stress_below_the_yield_stress_does_not_creep(void **state)
{
    (void)state;
    assert_code(0, run("rheometer bowling-ball-small creep --small --quiet --json --stress 1,30 --seeds 2"));
    assert_true(fabs(figure("creep_rate_1")) < .003);
    assert_true(figure("creep_rate_2") > .05);
    assert_true(figure("strain_1") < .05);
    assert_in("\"seed\": 1", out);
    assert_in("\"seed\": 2", out);
    assert_in("\"spreads\": {\"stress_1\": 0, ", out);
    assert_in("\"creep: comes to rest under 1 L^2/T^2; under 30 it flows at ", out);
}

/* ---- The law of the melting model ---- */

static void the_melting_law_is_found_again(void **state)
{
    (void)state;
    assert_code(0, run("rheometer melting-bunny --json"));
    assert_near(figure("solid_yield_stress"), 1, .01); /* mu/t0 */
    assert_near(figure("solid_exponent"), .5, .005);
    assert_near(figure("solid_consistency"), .05 / sqrt(.05), .003); /* mu t0^(n-1) */
    assert_true(figure("difference_below") <= 1e-4);
    assert_code(0, run("rheometer melting-bunny"));
    assert_in("solid: yield stress 1 M/(L T^2)", out);
    assert_in("\nmolten_yield_stress: - M/(L T^2)\n", out); /* it was off by half, and printed */
    assert_in("\nnote: No flow law of the molten fluid: yield stress + consistency x rate^n is off by 52 %.\n", out);
    assert_in("beyond it shear thinning: stress grows as rate^0.5", out);
    assert_code(0, run("rheometer melting-bunny --set melting.power_law_index=1.5 --set melting.viscosity=0.2"));
    assert_in("solid: yield stress 4 M/(L T^2)", out);
    assert_in("beyond it shear thickening: stress grows as rate^1.5", out);
    assert_code(0, run("rheometer melting-bunny --rate 1"));
    assert_null(strstr(out, "not a number"));
    assert_code(0, run("rheometer melting-bunny --set melting.rheology=newtonian"));
    assert_in("Newtonian: viscosity 0.05 M/(L T)", out);
}

/* ---- Output, recordings, refusals ---- */

static void it_writes_tables_and_plots(void **state)
{
    (void)state;
    size_t size;
    assert_code(0, run("rheometer bowling-ball-small --pair --quiet -o curves"));
    const char begin[] = "omega,gamma0,G_prime,G_double_prime,tan_delta,I3_I1,";
    assert_memory_equal(read_bytes("curves/pair-amplitude.csv", &size), begin, strlen(begin));
    assert_memory_equal(read_bytes("curves/pair-amplitude.svg", &size), "<svg ", 5);
    assert_memory_equal(read_bytes("curves/pair-response.csv", &size), "kind,omega,size,phase,", 22);
    assert_memory_equal(read_bytes("curves/pair-stop.csv", &size), "time,stress,", 12);
    assert_code(0, run("rheometer melting-box --quiet -o curves"));
    assert_memory_equal(read_bytes("curves/law-flow.csv", &size),
                        "temperature,jump_number,shear_rate,stress,viscosity,", 52);
}

/* Each panel has a curve for each value of a column, and the legend has these values in order. */
static void a_plot_has_a_curve_for_each_value(void **state)
{
    (void)state;
    static const struct {
        const char *options, *file;
        int panels, curves;
        const char *words[7]; /* in order; those behind the second one are names of curves */
    } plots[] = {{"bowling-ball-small --pair response --omega 1,2,4",
                  "curves/pair-response.svg",
                  2,
                  4,
                  {"omega, 1/T", "phase, degrees", "window", "window-fast", "full", "tempered"}},
                 {"bowling-ball-small --pair amplitude --omega 1,2 --gamma 0.01,0.02,0.04",
                  "curves/pair-amplitude.svg",
                  3,
                  2,
                  {"gamma0", "I3 I1", "omega = 1", "omega = 2"}},
                 {"bowling-ball-small --pair stop", "curves/pair-stop.svg", 1, 1, {"time, T", "stress, 1/T^2"}}};
    for (size_t i = 0; i < sizeof plots / sizeof *plots; i++) {
        size_t size;
        assert_code(0, run("rheometer %s --quiet -o curves", plots[i].options));
        char *svg = read_bytes(plots[i].file, &size);
        svg[size] = 0;
        const char *at = svg;
        for (int k = 0; plots[i].words[k]; k++) {
            char text[64];
            snprintf(text, sizeof text, ">%s</text>", plots[i].words[k]);
            assert_in(text, at);
            at = strstr(at, text) + 1;
            if (k > 1)
                assert_null(strstr(at, text)); /* once */
        }
        int curves = 0;
        for (at = svg; (at = strstr(at, "<path stroke=\"#")) != NULL; at++)
            curves += strcspn(at + 15, "\"") == 6; /* a grid has short names of colours */
        assert_int_equal(curves, plots[i].panels * plots[i].curves);
    }
}

static void it_has_its_keys(void **state)
{
    (void)state;
    static const char *const keys[] = {"scene", "instrument", "protocol", "small",   "seeds",
                                       "about", "figures",    "spreads",  "units",   "rows",
                                       "note",  "outcome",    "reason",   "summary", NULL};
    assert_code(0, run("rheometer bowling-ball-small --pair stop --json"));
    assert_keys(out, keys);
    assert_in("{\"scene\": \"bowling-ball-small\", \"instrument\": \"pair\", \"protocol\": \"stop\", ", out);
}

/* Each column of the CSV file is in the rows of the JSON object, and has a unit there if its values are numbers. */
static void json_has_all_columns_and_their_units(void **state)
{
    (void)state;
    static const char *const protocols[] = {"amplitude", "response", "stop"};
    for (int i = 0; i < 3; i++) {
        char path[64], header[512];
        size_t size;
        snprintf(path, sizeof path, "columns/pair-%s.csv", protocols[i]);
        assert_code(0, run("rheometer bowling-ball-small --pair %s --json --quiet -o columns", protocols[i]));
        const char *csv = read_bytes(path, &size);
        snprintf(header, sizeof header, "%.*s", (int)strcspn(csv, "\n"), csv);
        const char *units = strstr(out, "\"units\": {"), *rows = strstr(out, "\"rows\": [{");
        assert_true(units && rows && units < rows);
        int columns = 0;
        for (char *name = strtok(header, ","); name; name = strtok(NULL, ","), columns++) {
            char key[64];
            snprintf(key, sizeof key, "\"%s\": ", name);
            assert_in(key, rows);
            const char *unit = strstr(units, key);
            assert_true((unit && unit < rows) == (strcmp(name, "kind") != 0));
        }
        assert_true(columns >= 2);
    }
}

/* They were lost, and the folder stayed empty. */
static void an_interrupt_leaves_finished_protocols(void **state)
{
    (void)state;
    size_t size;
    /* The creeps take twenty times as long as the stop, so a wait that doubles ends in between on any machine. */
    assert_code(
        4, interrupt_until("rheometer bowling-ball-small stop creep --quiet --json -o half --stress "
                           "1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25,26,27,28,29,30,31,32",
                           "\"protocol\": \"stop\""));
    /* The reason is where the signal came: in a step, before a protocol, or while a block settles. */
    assert_in("\"outcome\": \"interrupted\", \"reason\": \"", out);
    assert_null(strstr(out, "\"reason\": \"\""));
    assert_string_not_equal(err, "");
    assert_null(strstr(out, "\"protocol\": \"creep\""));
    assert_memory_equal(read_bytes("half/stop.csv", &size), "time,stress\n", 12);
    assert_int_equal(file_size("half/creep.csv"), -1);
}

/* Regression: they were lost, and with --json nothing said why. */
static void a_state_that_goes_bad_leaves_finished_protocols(void **state)
{
    (void)state;
    assert_code(1, run("rheometer bowling-ball-small stop creep --small --stress 1e9 --set history.stiffness=1e30 "
                       "--quiet --json -o bad"));
    assert_in("\"protocol\": \"stop\"", out);
    assert_null(strstr(out, "\"protocol\": \"creep\""));
    assert_in("\"outcome\": \"failed\", \"reason\": \"creep of bowling-ball-small: step 1 went bad", out);
    assert_in("rheolog: creep of bowling-ball-small: step 1 went bad", err);
    assert_true(file_size("bad/stop-small.csv") > 0);
    assert_int_equal(file_size("bad/creep-small.csv"), -1);
    assert_code(1, run("rheometer bowling-ball-small stop --small --set fluid.stiffness=1e30 --quiet --json"));
    assert_in("\"outcome\": \"failed\", \"reason\": \"the block of bowling-ball-small: while settling", out);
    assert_code(1, run("rheometer bowling-ball-small stop --small --set fluid.stiffness=1e30 --quiet"));
    assert_string_equal(out, "");
    assert_code(2, run("rheometer bowling-ball-small wrong --json"));
    assert_in("\"outcome\": \"refused\", \"reason\": \"", out);
}

/* It went on to the end. */
static void a_pair_is_interrupted(void **state)
{
    (void)state;
    assert_code(
        4, interrupt_until(
               "rheometer bowling-ball-small --pair response --json --set history.window=30000 --omega 1,2,3,4,5",
               "\"outcome\": \"interrupted\""));
    assert_in(" response of bowling-ball-small", err);
    assert_null(strstr(out, "\"protocol\""));
}

static void a_recording_has_the_parameters(void **state)
{
    (void)state;
    record("r.rlog");
    assert_code(0, run("rheometer r.rlog --pair amplitude --omega 1,3 --fit --json"));
    assert_in("\"scene\": \"r.rlog\"", out);
    assert_true(figure("difference_below") <= 1e-6);
}

static void bad_usage_is_refused(void **state)
{
    (void)state;
    static const char *const refused[][2] = {
        {"", "needs a scene or a recording"},
        {"no-such-scene --pair", "unknown scene"},
        {"bowling-ball-small --pair amplitud", "the pair has no protocol \"amplitud\"; did you mean \"amplitude\"?"},
        {"melting-bunny creep", "the law has no protocol \"creep\"; it has flow"},
        {"melting-bunny --pair", "the melting model has none"},
        {"bowling-ball-small --pair --omega 0", "--omega needs numbers above 0"},
        {"bowling-ball-small --pair --gamma 1,x", "--gamma needs numbers above 0"},
        {"bowling-ball-small --pair --rate 1e99", "--rate needs numbers above 0 and at most 1e9"},
        {"bowling-ball-small --pair --rate 1", "--rate has no effect on the pair"},
        {"bowling-ball-small flow --small --rate 1e6", "moves the plate by more than a support in a step"},
        /* They said nothing. */
        {"bowling-ball-small flow --fit", "--fit has no effect on flow; name a protocol that uses it: amplitude"},
        {"bowling-ball-small flow creep --small --omega 1", "--omega has no effect on these protocols; "},
        {"bowling-ball-small creep --small --rate 1", "on creep; name a protocol that uses it: flow, startup, stop"},
        {"bowling-ball-small --pair response --fit", "--fit has no effect on response; "},
        /* It ran for hours. */
        {"bowling-ball-small flow --small --rate 1e-6,1", "--rate 1e-06 takes up to "},
        {"bowling-ball-small amplitude --small --omega 1e-6 --set step=0.01", "it must be at least 0.00758 1/T"},
        {"bowling-ball-small --pair amplitude --omega 1e-6", "--omega 1e-06 takes up to "},
        {"bowling-ball-small --set scheme=sequential -o never",
         "summed and history.of vector; bowling-ball-small has "},
        {"bowling-ball-small --set scheme=positions", "bowling-ball-small has scheme positions"},
        {"bowling-ball-small --set history.of=length", "bowling-ball-small has history.of length"},
        {"bowling-ball-small --pair --set scheme=positions", "no pair to drive: scheme is positions"},
        {"bowling-ball-small --pair --set history.of=length", "the pair needs history.of vector"},
        {"bowling-ball-small --pair creep", "the pair has no protocol \"creep\""},
        {"melting-bunny --fit", "--fit has no effect on the law"},
        {"bowling-ball-small --pair amplitude --omega 100", "less than 8 steps in a period"},
        {"bowling-ball-small --pair --seeds 2", "--seeds has no effect on the pair"},
        {"bowling-ball-small --seeds 0 --pair", "--seeds is 1 to 99; got 0"},
        {"bowling-ball-small --pair --set springs.stiffness=0", "has no springs"},
        {"bowling-ball-small --pair --set history.window=900000", "takes too long to sum"},
        {"bowling-ball-small --pair response --set history.window=900000 --set history.kind=window-fast",
         "response compares every kind with this sum: name amplitude and stop instead"}, /* it named window-fast */
        {"bowling-ball-small --pair --set history.no=1", "unknown parameter"},
        {"melting-bunny --set melting.viscosity=0", "melting.viscosity is 0"},
        {"bowling-ball-small --pair -o no/such/folder", "cannot make the folder"},
        {"bowling-ball-small --pair stop -o taken", "taken/pair-stop.svg exists and leads to no regular file"},
    };
    mkdir("taken", 0777);
    mkdir("taken/pair-stop.svg", 0777);
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        assert_code(2, run("rheometer %s", refused[i][0]));
        assert_in(refused[i][1], err);
        assert_string_equal(out, "");
    }
    remove("taken/pair-stop.svg");
    remove("taken");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_pair_has_its_closed_forms),
        cmocka_unit_test(a_held_spring_relaxes_as_known),
        cmocka_unit_test(the_fit_finds_the_parameters_of_the_scene),
        cmocka_unit_test(a_fluid_without_history_is_linear),
        cmocka_unit_test(a_block_has_all_protocols),
        cmocka_unit_test(a_block_without_history_has_a_yield_stress_and_no_loop),
        cmocka_unit_test(the_fit_of_a_block_is_of_springs),
        cmocka_unit_test(values_are_sorted_and_unknown_ones_are_not_told),
        cmocka_unit_test(unsteady_rows_are_left_out),
        cmocka_unit_test(creep_tells_what_it_leaves_out),
        cmocka_unit_test(fluid_without_springs_has_no_memory),
        cmocka_unit_test(inertia_is_not_called_elastic),
        cmocka_unit_test(a_viscous_block_is_newtonian),
        cmocka_unit_test(stress_below_the_yield_stress_does_not_creep),
        cmocka_unit_test(the_melting_law_is_found_again),
        cmocka_unit_test(it_writes_tables_and_plots),
        cmocka_unit_test(a_plot_has_a_curve_for_each_value),
        cmocka_unit_test(it_has_its_keys),
        cmocka_unit_test(json_has_all_columns_and_their_units),
        cmocka_unit_test(an_interrupt_leaves_finished_protocols),
        cmocka_unit_test(a_state_that_goes_bad_leaves_finished_protocols),
        cmocka_unit_test(a_pair_is_interrupted),
        cmocka_unit_test(a_recording_has_the_parameters),
        cmocka_unit_test(bad_usage_is_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
