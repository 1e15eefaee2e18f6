/*
 * `rheolog bench error`: observed orders and fronts of points that are made up, derivatives of signals against closed forms, and
 * small versions of its studies.
 */
#define _POSIX_C_SOURCE 200809L
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "cli/error.h"
#include "cli/error_signals.h"
#include "cli/error_trials.h"

static void close_to(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance))
        fail_msg("%.17g instead of %.17g", value, expected);
}

static void near_to(double value, double expected, double tolerance)
{
    close_to(value, expected, tolerance * fabs(expected));
}

/* ---- The framework ---- */

static cli_error_point *add(cli_error_points *points, const char *series, double refinement, double error,
                            double cost)
{
    cli_error_point p = cli_error_no_point();
    snprintf(p.scene, sizeof p.scene, "drop");
    snprintf(p.quantity, sizeof p.quantity, "height");
    snprintf(p.series, sizeof p.series, "%s", series);
    p.refinement = refinement;
    p.error = error;
    p.us_time = cost;
    return cli_error_add(points, &p);
}

static void orders_are_those_of_neighbours_in_a_series(void **state)
{
    (void)state;
    cli_error_points p = {0};
    assert_non_null(add(&p, "summed", .01, 1e-4, 1));
    assert_non_null(add(&p, "summed", .04, -1.6e-3, 1)); /* the order in the list does not matter, nor do signs */
    assert_non_null(add(&p, "summed", .02, 2e-4, 1));
    assert_non_null(add(&p, "sequential", .02, 1, 1)); /* another series */
    assert_non_null(add(&p, "summed", 0, 1, 1));       /* not part of it */
    snprintf(add(&p, "summed", .02, 7, 1)->quantity, sizeof p.item->quantity, "dip");
    cli_error_judge(&p);
    close_to(p.item[0].order, 1, 1e-12);
    assert_true(isnan(p.item[1].order));
    close_to(p.item[2].order, 3, 1e-12);
    assert_true(isnan(p.item[3].order) && isnan(p.item[4].order) && isnan(p.item[5].order));
    /* Where an error is missing or 0, there is no order. */
    p.item[2].error = NAN;
    p.item[1].error = 0;
    cli_error_judge(&p);
    assert_true(isnan(p.item[0].order) && isnan(p.item[2].order));
    free(p.item);
}

static void fronts_hold_what_nothing_beats(void **state)
{
    (void)state;
    cli_error_points p = {0};
    static const struct {
        double error, cost;
        bool front;
    } POINT[] = {{-.1, 1, true},  {.1, 2, false},  {.05, 3, true},  {-.05, 3, true},
                 {.06, 3, false}, {.01, 10, true}, {NAN, 1, false}, {.001, NAN, false}};
    for (size_t i = 0; i < sizeof POINT / sizeof *POINT; i++)
        assert_non_null(add(&p, "", 0, POINT[i].error, POINT[i].cost));
    cli_error_point *other = add(&p, "", 0, 9, 9); /* alone in its scene; its cost is that of a step */
    snprintf(other->scene, sizeof other->scene, "ball");
    other->us_time = NAN;
    other->ns_step = 5;
    cli_error_judge(&p);
    for (size_t i = 0; i < sizeof POINT / sizeof *POINT; i++)
        if (p.item[i].front != POINT[i].front)
            fail_msg("point %zu", i);
    assert_true(p.item[p.count - 1].front);
    assert_true(cli_error_cost(&p.item[p.count - 1]) == 5);
    free(p.item);
}

/* The text of a file, to be freed. */
static char *read_all(const char *path)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    char *text = calloc(1, 1 << 17);
    assert_non_null(text);
    assert_true(fread(text, 1, (1 << 17) - 1, file) > 0);
    fclose(file);
    remove(path);
    return text;
}

/* Points without a cost, which are not drawn, spoiled the order of the others. */
static void plots_do_not_depend_on_points_without_cost(void **state)
{
    (void)state;
    static const double ORDERS[2][4] = {{1, 2, 3, NAN}, {3, 2, NAN, 1}};
    static const cli_error_study study = {"plots", NULL, "costs in any order", NULL};
    char *plot[2];
    for (int i = 0; i < 2; i++) {
        cli_error_points p = {0};
        for (int k = 0; k < 4; k++)
            assert_non_null(add(&p, "", 0, isnan(ORDERS[i][k]) ? .5 : .1 / ORDERS[i][k], ORDERS[i][k]));
        cli_error_judge(&p);
        assert_int_equal(cli_error_write(&study, &p, "."), CLI_DONE);
        free(p.item);
        free(read_all("./error-plots.csv"));
        plot[i] = read_all("./error-plots-drop-height.svg");
    }
    assert_non_null(strstr(plot[0], "front"));
    assert_string_equal(plot[0], plot[1]);
    free(plot[0]);
    free(plot[1]);
}

/* Three points of two groups, all of whose numbers are known. */
static cli_error_points known_points(void)
{
    cli_error_points p = {0};
    for (int i = 0; i < 3; i++) {
        cli_error_point point = cli_error_no_point();
        snprintf(point.scene, sizeof point.scene, "a/b:c@d[e`f{gAZz09.");
        snprintf(point.setting, sizeof point.setting, i ? "long, with a comma" : "x");
        snprintf(point.series, sizeof point.series, "s");
        snprintf(point.quantity, sizeof point.quantity, i < 2 ? "h_9 (x)" : "other");
        point.refinement = i == 0 ? .25 : .5;
        point.value = i < 2 ? 1.25 : NAN;
        point.reference = i < 2 ? 1 : NAN;
        point.error = i == 0 ? .125 : i == 1 ? -.25 : NAN;
        point.ns_step = 10 + i;
        point.us_time = i < 2 ? 100.125 * (2 - i) : NAN;
        point.bytes = i == 0 ? 48 : NAN;
        point.substeps = 4 * i;
        point.iterations = i == 1 ? 2.5 : NAN;
        point.particles = i < 2 ? 700 : 0;
        point.steps = 8;
        point.hash = i == 2 ? 0 : 0xabc;
        assert_non_null(cli_error_add(&p, &point));
    }
    cli_error_judge(&p);
    return p;
}

/* The text behind two lines about study and machine. */
static void tables_have_a_column_for_each_known_number(void **state)
{
    (void)state;
    static const cli_error_study study = {"names", "melting", "all characters", NULL};
    cli_error_points p = known_points();
    fflush(stdout);
    const int kept = dup(STDOUT_FILENO);
    assert_true(kept >= 0);
    FILE *file = freopen("error-table.txt", "w", stdout);
    if (file)
        cli_error_print(&study, &p);
    fflush(stdout);
    const bool back = dup2(kept, STDOUT_FILENO) >= 0;
    close(kept);
    assert_true(file && back);
    char *text = read_all("error-table.txt");
    assert_int_equal(strncmp(text, "names (melting): all characters\n", 32), 0);
    assert_string_equal(
        strchr(strchr(text, '\n') + 1, '\n') + 1,
        "\n"
        "a/b:c@d[e`f{gAZz09., h_9 (x); 700 particles; reference 1\n"
        "  setting                  value       error       order     ns/step     us/time       bytes    substeps  iterations\n"
        "* x                         1.25   +1.25e-01        1.00        10.0      200.25          48           0           -\n"
        "* long, with a comma        1.25   -2.50e-01           -        11.0      100.12           -           4        2.50\n"
        "\n"
        "a/b:c@d[e`f{gAZz09., other\n"
        "  setting                ns/step    substeps\n"
        "  long, with a comma        12.0           8\n");
    free(text);
    free(p.item);
}

/* Names of files keep letters, digits and dots. The plot has a group with errors; the CSV file has all points. */
static void files_are_named_after_scene_and_quantity(void **state)
{
    (void)state;
    static const cli_error_study study = {"names", NULL, "all characters", NULL};
    cli_error_points p = known_points();
    assert_int_equal(cli_error_write(&study, &p, "."), CLI_DONE);
    char *plot = read_all("./error-names-a-b-c-d-e-f-gAZz09.-h-9-x-.svg");
    assert_non_null(strstr(plot, ">names: a/b:c@d[e`f{gAZz09., h_9 (x)<"));
    free(plot);
    assert_null(fopen("./error-names-a-b-c-d-e-f-gAZz09.-other.svg", "r"));
    char *csv = read_all("./error-names.csv"), *line = strchr(csv, '\n') + 1;
    static const char *const rows[3] = {
        "names,both,a/b:c@d[e`f{gAZz09.,x,s,2.50000e-01,h_9 (x),1.25000e+00,1.00000e+00,1.25000e-01,10.000,200.2500,48.0,0,,700,8,"
        "0000000000000abc,1.00,1,",
        "names,both,a/b:c@d[e`f{gAZz09.,\"long, with a comma\",s,5.00000e-01,h_9 (x),1.25000e+00,1.00000e+00,-2.50000e-01,11.000,"
        "100.1250,,4,2.50,700,8,0000000000000abc,,1,",
        "names,both,a/b:c@d[e`f{gAZz09.,\"long, with a comma\",s,5.00000e-01,other,,,,12.000,,,8,,0,8,,,0,"};
    for (int i = 0; i < 3; i++, line = strchr(line, '\n') + 1)
        if (strncmp(line, rows[i], strlen(rows[i])) != 0)
            fail_msg("%.300s", line);
    assert_true(!*line);
    free(csv);
    free(p.item);
}

static bool goes_bad_beside(cli_trial *t, rheo_world *world)
{
    (void)world;
    for (int q = 0; q < CLI_QUANTITIES; q++)
        t->quantity[q] = 1;
    t->result = RHEO_ERROR_STATE;
    return false;
}

/* An image that blew up ended the whole study. */
static void a_world_that_goes_bad_beside_a_trial_is_no_error(void **state)
{
    (void)state;
    static const rheo_real place[3] = {0, 0, 0};
    rheo_error error = {""};
    cli_case c = {.name = "beside", .quantity = {"one"}, .def = rheo_default_world_def(), .measure = goes_bad_beside};
    c.def.particles.count = 1;
    c.def.particles.position = place;
    char memory[1];
    cli_trial t = {.of = &c, .def = c.def, .memory = memory, .error = &error};
    assert_int_equal(cli_trial_run(&t, 1, &error), RHEO_OK);
    for (int q = 0; q < CLI_QUANTITIES; q++)
        assert_true(isnan(t.quantity[q]));
    assert_false(isnan(t.ns)); /* which is stored behind them */
}

/* An octahedron that turns about an axis which is none of its own, while it flies. */
static void the_spin_of_a_rigid_body_is_its_angular_velocity(void **state)
{
    (void)state;
    static const double centre[3] = {3, -2, 7}, flight[3] = {-4, 1, 2}, turn[3] = {.25, .5, -.5};
    rheo_real position[18] = {0}, velocity[18];
    for (int i = 0; i < 18; i++)
        position[i] = (rheo_real)(i / 6 == i % 3 ? (i / 3 % 2 ? 2 : -2) : 0);
    for (int i = 0; i < 18; i += 3)
        for (int a = 0; a < 3; a++) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            velocity[i + a] =
                (rheo_real)(flight[a] + turn[b] * (double)position[i + c] - turn[c] * (double)position[i + b]);
        }
    for (int i = 0; i < 18; i++)
        position[i] += (rheo_real)centre[i % 3];
    rheo_world_def def = rheo_default_world_def();
    def.particles.count = 6;
    def.particles.position = position;
    def.particles.velocity = velocity;
    rheo_world *world;
    assert_int_equal(rheo_world_create(&def, &world, NULL), RHEO_OK);
    close_to(cli_spin(world), .75, 1e-12);
    rheo_world_destroy(world);
}

/* ---- Signals ---- */

/* D^q of a power t^p. */
static double of_power(double q, double t, double p)
{
    return tgamma(p + 1) / tgamma(p + 1 - q) * pow(t, p - q);
}

/* 1 - cos u, u = 2 pi t / 3.3, as the series of its powers. */
static double of_sine(double q, double t)
{
    const double w = 2 * 3.14159265358979323846 / 3.3;
    double sum = 0, factor = 1;
    for (int k = 1; k < 40; k++) {
        factor *= -w * w / ((2. * k - 1) * 2 * k);
        sum -= factor * of_power(q, t, 2. * k);
    }
    return sum;
}

static double of_exponential(double q, double t)
{
    double sum = 0, factor = 1;
    for (int k = 1; k < 60; k++) {
        factor /= 3.3 * k;
        sum += k > 1 ? factor * of_power(q, t, k) : 0;
    }
    return sum;
}

static const cli_signal *signal_of(const char *name)
{
    for (size_t i = 0; i < CLI_SIGNALS; i++)
        if (strcmp(cli_signal_list[i].name, name) == 0)
            return &cli_signal_list[i];
    fail_msg("no signal %s", name);
    return NULL;
}

static void derivatives_of_signals_are_known(void **state)
{
    (void)state;
    static const double ORDER[] = {.05, .2, .5, .8, .95}, TIME[] = {.033, .5, 1.7, 5};
    for (size_t i = 0; i < sizeof ORDER / sizeof *ORDER; i++)
        for (size_t k = 0; k < sizeof TIME / sizeof *TIME; k++) {
            const double q = ORDER[i], t = TIME[k];
            near_to(cli_caputo(signal_of("t^2"), q, t), of_power(q, t, 2), 1e-12);
            near_to(cli_caputo(signal_of("t^3"), q, t), of_power(q, t, 3), 1e-12);
            near_to(signal_of("t^2")->derivative(q, t), of_power(q, t, 2), 1e-14);
            near_to(signal_of("t^3")->derivative(q, t), of_power(q, t, 3), 1e-14);
            near_to(signal_of("exp")->derivative(q, t), of_exponential(q, t), 1e-12);
            near_to(cli_caputo(signal_of("exp"), q, t), of_exponential(q, t), 1e-12);
            near_to(cli_caputo(signal_of("sine"), q, t), of_sine(q, t), 1e-9);
            near_to(cli_caputo(signal_of("steady"), q, t + 1.01),
                    of_power(q, t + .01, 1) - (t == 5 ? of_power(q, .01, 1) : 0), 1e-12);
            near_to(signal_of("steady")->derivative(q, t + 1.01), cli_caputo(signal_of("steady"), q, t + 1.01),
                    1e-12);
        }
    assert_true(cli_caputo(signal_of("impact"), .5, .9) == 0);
}

/* The impact and the steady motion are those of the paper; positions are integrals of velocities. */
static void signals_are_those_of_the_paper(void **state)
{
    (void)state;
    enum { COUNT = 400 };
    static const rheo_signal OF[] = {RHEO_SIGNAL_IMPACT, RHEO_SIGNAL_STEADY};
    static const char *const NAME[] = {"impact", "steady"};
    double velocity[COUNT];
    for (size_t i = 0; i < 2; i++) {
        assert_int_equal(rheo_signal_velocities(OF[i], .02, COUNT, velocity), RHEO_OK);
        for (size_t n = 0; n < COUNT; n++)
            close_to(signal_of(NAME[i])->velocity((double)n * .02), velocity[n], 1e-12);
    }
    for (size_t i = 0; i < CLI_SIGNALS; i++) {
        const cli_signal *s = &cli_signal_list[i];
        double x = s->position(0);
        for (int n = 0; n < 3000; n++)
            x += 1e-3 * s->velocity(1e-3 * (n + .5));
        close_to(x, s->position(3), 1e-3);
    }
}

/* ---- Studies ---- */

static cli_error_points run(int (*study)(cli_bench_arguments *a, cli_error_points *points), cli_bench_arguments *a)
{
    cli_error_points points = {0};
    a->repetitions = 1;
    a->progress.quiet = true;
    assert_int_equal(study(a, &points), CLI_DONE);
    cli_error_judge(&points);
    return points;
}

static const cli_error_point *find(const cli_error_points *points, const char *scene, const char *setting,
                                   const char *quantity)
{
    for (size_t i = 0; i < points->count; i++)
        if (strcmp(points->item[i].scene, scene) == 0 && strcmp(points->item[i].setting, setting) == 0 &&
            strcmp(points->item[i].quantity, quantity) == 0)
            return &points->item[i];
    fail_msg("no point %s, %s, %s", scene, setting, quantity);
    return NULL;
}

/* 200 steps: longer than a window of 150, shorter than one of 500. */
static void memories_are_compared_with_closed_forms(void **state)
{
    (void)state;
    cli_error_points p =
        run(cli_error_history, &(cli_bench_arguments){.steps = 200, .particles = 300, .settle = {true, 2}});
    static const char ALL[] = "D^q, all steps";
    assert_true(find(&p, "t^2, q = .5", "paper, velocities of the signal, step", ALL)->error < 1e-14);
    close_to(find(&p, "t^3, q = .2", "paper, velocities of the signal, step/2", ALL)->order, 2, .05);
    close_to(find(&p, "t^3, q = .5", "paper, 1 substep, step/4", ALL)->order, 1, .02);
    close_to(find(&p, "t^3, q = .5", "l1, 1 substep, step/4", ALL)->order, 1.5, .03);
    close_to(find(&p, "t^3, q = .8", "l1, 1 substep, step/4", ALL)->order, 1.2, .03);
    close_to(find(&p, "t^3, q = .5", "l1, 2 substeps, step/4", ALL)->order, 1, .05);
    assert_true(find(&p, "t^2, q = .5", "l1, 1 substep, step", ALL)->error < 2e-4);
    /* A window that is too short forgets; kind full does not. */
    const cli_error_point *forgets = find(&p, "t^2, q = .5", "window, d = 50, paper", "D^q"),
                          *knows = find(&p, "t^2, q = .5", "window, d = 500, paper", "D^q"),
                          *full = find(&p, "t^2, q = .5", "full, paper", "D^q");
    assert_true(forgets->error > .2 && knows->error < 3e-3 && full->error < 3e-3);
    assert_true(forgets->ns_step > 0 && full->ns_step > 0);
    assert_true(full->bytes < forgets->bytes && forgets->bytes < knows->bytes);
    const double fast = find(&p, "steady, q = .8", "window-fast, d = 150, paper", "D^q of kind window")->error;
    assert_true(fast > 0 && fast < 1.4e-3);
    const cli_error_point *few = find(&p, "fit, q = .5", "4 lags", "exponentials"),
                          *many = find(&p, "fit, q = .5", "500 lags", "exponentials");
    assert_true(few->value == 4 && few->error < 1e-12 && many->value == 10 && many->error > 1e-5 &&
                many->error < 5e-4);
    free(p.item);
}

/* The vibrated layer of `fingers` is thrown about. */
static void roundings_grow(void **state)
{
    (void)state;
    cli_error_points p =
        run(cli_error_number,
            &(cli_bench_arguments){.model = "thickening", .steps = 100, .particles = 300, .settle = {true, 2}});
    const bool is_double = sizeof(rheo_real) > sizeof(float);
    const char *type = is_double ? "double" : "float";
    const double ulp = is_double ? DBL_EPSILON : FLT_EPSILON;
    const double first = find(&p, "fingers", type, "difference at step 1")->value,
                 later = find(&p, "fingers", type, "difference at step 100")->value;
    assert_true(first > .5 * ulp && first < 100 * ulp && later > 3 * first && later < 10);
    const cli_error_point *growth = find(&p, "fingers", type, "Lyapunov time");
    assert_true(growth->ns_step > 0);
    if (!is_double) /* differences of an ulp of double meet too few springs that break */
        assert_true(growth->value > .01 && growth->value < 3.3);
    for (size_t i = 0; i < p.count; i++)
        assert_true(isnan(p.item[i].error) || (p.item[i].error >= 0 && p.item[i].error < 100));
    if (is_double) {
        const double of_float = find(&p, "fingers", "double, an ulp of float", "difference at step 1")->value;
        assert_true(of_float > .5 * (double)FLT_EPSILON && of_float < 100 * (double)FLT_EPSILON);
    }
    free(p.item);
}

/* A drop of a few hundred particles. The settled pool of the ball would take seconds. */
static void spacings_are_compared_with_their_limit(void **state)
{
    (void)state;
    cli_error_points p = run(cli_error_spacing, &(cli_bench_arguments){.scenes = "drop", .particles = 100});
    assert_int_equal(p.count, 3 * 2 * 3); /* quantities, with their chance, and resolutions */
    const cli_error_point *coarse = find(&p, "drop", "resolution 1", "height_9"),
                          *middle = find(&p, "drop", "resolution 4/3", "height_9"),
                          *fine = find(&p, "drop", "resolution 2", "height_9");
    close_to(fine->reference, 2 * fine->value - coarse->value, 1e-12);
    close_to(coarse->error, 2 * fine->error, 1e-9); /* order 1 by construction */
    close_to(coarse->refinement, 2 * fine->refinement, 1e-9);
    assert_true(coarse->value > 1 && coarse->value < 3 && middle->particles > coarse->particles);
    close_to(fine->us_time / fine->ns_step, coarse->us_time / coarse->ns_step * fine->particles / coarse->particles,
             1e-9);
    const cli_error_point *chance = find(&p, "drop", "resolution 1", "height_9 by seed");
    assert_true(chance->error > 0 && chance->error < .2 && !chance->front);
    free(p.item);
}

/* Few steps of the studies of melting, against closed forms. */
static void melting_is_compared_with_closed_forms(void **state)
{
    (void)state;
    cli_error_points heat = run(cli_error_heat, &(cli_bench_arguments){.steps = 40, .scenes = "lattice"});
    assert_true(fabs(find(&heat, "lattice", "20 layers (default step)", "decay")->error) < 2e-3);
    assert_float_equal(find(&heat, "lattice", "20 layers (default step)", "decay")->order, 3.4, .5);
    assert_true(find(&heat, "lattice", "10 layers", "step")->error >
                2 * find(&heat, "lattice", "40 layers", "step")->error);
    assert_true(isnan(find(&heat, "lattice", "substep 0.64 h2/k", "decay")->error)); /* unstable */
    free(heat.item);
    cli_error_points flow = run(cli_error_channel, &(cli_bench_arguments){.steps = 8});
    const double couette = find(&flow, "couette", "12 layers (default)", "profile")->error,
                 poiseuille = find(&flow, "poiseuille", "12 layers (default)", "flow")->error;
    assert_true(couette > 0 && couette < .02 && fabs(poiseuille) < .03);
    assert_true(find(&flow, "couette", "free-slip walls", "profile")->error > 5 * couette);
    assert_true(find(&flow, "couette", "tolerance 1e-6", "profile")->iterations >
                find(&flow, "couette", "tolerance 1e-2", "profile")->iterations);
    free(flow.item);
    cli_error_points rest = run(cli_error_column, &(cli_bench_arguments){.steps = 5, .scenes = "rest"});
    assert_true(find(&rest, "rest", "20 layers (default)", "pressure")->error < .02);
    assert_true(find(&rest, "rest", "20 layers (default)", "speed")->us_time > 0);
    free(rest.item);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(orders_are_those_of_neighbours_in_a_series),
        cmocka_unit_test(fronts_hold_what_nothing_beats),
        cmocka_unit_test(plots_do_not_depend_on_points_without_cost),
        cmocka_unit_test(tables_have_a_column_for_each_known_number),
        cmocka_unit_test(files_are_named_after_scene_and_quantity),
        cmocka_unit_test(a_world_that_goes_bad_beside_a_trial_is_no_error),
        cmocka_unit_test(the_spin_of_a_rigid_body_is_its_angular_velocity),
        cmocka_unit_test(derivatives_of_signals_are_known),
        cmocka_unit_test(signals_are_those_of_the_paper),
        cmocka_unit_test(memories_are_compared_with_closed_forms),
        cmocka_unit_test(roundings_grow),
        cmocka_unit_test(spacings_are_compared_with_their_limit),
        cmocka_unit_test(melting_is_compared_with_closed_forms),
    };
    return cmocka_run_group_tests_name("error", tests, NULL, NULL);
}
