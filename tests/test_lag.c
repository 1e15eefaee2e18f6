/*
 * A lag of the history (history.lag). D^q x with a lag has the bits of D^q x without one, so many steps earlier; it is
 * the fractional derivative of the velocities that are old enough; and no step or file depends on how it is stored.
 */
#include "resume.h"

#include <math.h>

#include "record/head.h"
#include "thickening/thickening.h"
#include "world/model_thickening.h"

#define STEP 0.033
#define PATH "test_lag.rlog"

static const uint32_t LAGS[] = {1, 2, 7, 8, 9, 30};
enum { LAG_COUNT = sizeof LAGS / sizeof *LAGS };

static bool has_window(int kind)
{
    return kind == RHEO_HISTORY_WINDOW || kind == RHEO_HISTORY_WINDOW_FAST;
}

/* ---- Memories fed with a signal ---- */

/* Many particles, so that several blocks are summed ahead in turn; only their history is used. */
enum { PARTICLES = 400 };

static rheo_world *memory_of(int kind, double q, uint32_t window, int weights, uint32_t lag)
{
    static rheo_real position[3 * PARTICLES];
    for (int i = 0; i < PARTICLES; i++)
        position[3 * i] = (rheo_real)(9 * i);
    rheo_world_def def = rheo_default_world_def();
    def.step = STEP;
    def.history.kind = (rheo_history_kind)kind;
    def.history.order = q;
    def.history.window = window;
    def.history.weights = (rheo_weights)weights;
    def.history.lag = lag;
    return world_of(def, PARTICLES, position, NULL);
}

/* Velocity n of particle i: smooth, and another for each. */
static double signal_of(int n, int i)
{
    const double u = (n - 4) / 12.0;
    return (u > 0 && u < 1 ? 5 * sin(3.141592653589793 * u) : 0) + 0.3 * cos(0.21 * n + i);
}

static void feed(rheo_world *world, int n)
{
    for (int i = 0; i < PARTICLES; i++)
        for (int axis = 0; axis < 3; axis++)
            world->state.velocity[3 * i + axis] = (rheo_real)((axis + 1) * signal_of(n, i));
    OK(rheo__stage_history(&world->state, rheo__thickening_of(world)));
}

/* D^q x of all particles by the stage; a query has the same bits. */
static const rheo_real *derivatives(rheo_world *world)
{
    rheo__thickening *t = rheo__thickening_of(world);
    rheo_real *queried = malloc(3 * PARTICLES * sizeof *queried);
    assert_non_null(queried);
    OK(t->def->history.kind == RHEO_HISTORY_WINDOW ? rheo__stage_fractional_derivative(&world->state, t)
                                                   : rheo__stage_fractional_derivative_modes(&world->state, t));
    rheo__derivatives(&world->state, t, queried);
    assert_memory_equal(queried, world->state.derivative, 3 * PARTICLES * sizeof *queried);
    free(queried);
    return world->state.derivative;
}

/* What a world without a lag had at every step, and one with a lag has later. */
static void compare_late(int kind, double q, uint32_t window, int weights, uint32_t lag, bool change)
{
    enum { STEPS = 70 };
    const size_t bytes = 3 * PARTICLES * sizeof(rheo_real);
    rheo_world *late = memory_of(kind, q, window, weights, lag), *world = memory_of(kind, q, window, weights, 0);
    for (int n = 0; n < (int)lag; n++) {
        feed(late, n);
        const rheo_real *d = derivatives(late);
        for (size_t i = 0; i < 3 * PARTICLES; i++)
            assert_true(d[i] == 0); /* no velocity is old enough */
    }
    for (int n = 0; n < STEPS; n++) {
        feed(world, n);
        feed(late, n + (int)lag);
        if (memcmp(derivatives(late), derivatives(world), bytes) != 0)
            fail_msg("kind %d, q = %g, window %u, weights %d, lag %u: other bits at step %d", kind, q, window,
                     weights, lag, n);
        if (change && (n == 5 || n == 40)) {
            OK(rheo_world_set(world, "history.weights", n == 5 ? "l1" : "paper", &error));
            OK(rheo_world_set(late, "history.weights", n == 5 ? "l1" : "paper", &error));
        }
        if (change && n == 50) {
            OK(rheo_world_set(world, "history.order", "0.7", &error));
            OK(rheo_world_set(late, "history.order", "0.7", &error));
        }
    }
    rheo_world_destroy(world);
    rheo_world_destroy(late);
}

static void a_lag_only_delays(void **unused)
{
    (void)unused;
    const uint32_t windows[] = {1, 6, 7, 8, 9, 20, 60};
    const size_t stride = every() > 1 ? 3 : 1;
    size_t number = 0;
    for (int kind = RHEO_HISTORY_WINDOW; kind <= RHEO_HISTORY_TEMPERED; kind++)
        for (size_t w = 0; w < sizeof windows / sizeof *windows; w++)
            for (size_t l = 0; l < LAG_COUNT; l++)
                for (int weights = 0; weights < 2; weights++, number++)
                    if (number % stride == 0)
                        compare_late(kind, number % 2 ? .5 : .2, windows[w], weights, LAGS[l], false);
}

/* Sums of modes are made again from the rows that count. */
static void a_change_of_the_weights_is_delayed_too(void **unused)
{
    (void)unused;
    for (int kind = RHEO_HISTORY_WINDOW; kind <= RHEO_HISTORY_WINDOW_FAST; kind++)
        for (size_t l = 0; l < LAG_COUNT; l++)
            compare_late(kind, .5, 20, 0, LAGS[l], true);
}

/* The sums of the same velocities by the library's function for whole signals. */
static void a_lagging_derivative_is_that_of_the_older_velocities(void **unused)
{
    (void)unused;
    enum { STEPS = 120, WINDOW = 25, ID = 170 };
    for (int kind = RHEO_HISTORY_WINDOW; kind <= RHEO_HISTORY_FULL; kind++)
        for (size_t l = 0; l < LAG_COUNT; l++) {
            rheo_world *world = memory_of(kind, .5, WINDOW, RHEO_WEIGHTS_PAPER, LAGS[l]);
            double v[STEPS], exact[STEPS], largest = 0;
            for (int n = 0; n < STEPS; n++)
                v[n] = (double)(rheo_real)signal_of(n, ID);
            OK(rheo_fractional_derivative(v, STEPS, .5, STEP, kind == RHEO_HISTORY_FULL ? 0 : WINDOW,
                                          RHEO_WEIGHTS_PAPER, exact));
            for (int n = 0; n < STEPS; n++) {
                feed(world, n);
                const double expected = n < (int)LAGS[l] ? 0 : exact[n - (int)LAGS[l]];
                largest = fmax(largest, fabs(expected));
                NEAR((double)derivatives(world)[3 * ID], expected,
                     (kind == RHEO_HISTORY_WINDOW ? 3e-6 : 1e-3) * largest);
            }
            rheo_world_destroy(world);
        }
}

/* ---- Running worlds ---- */

/* A pair that moves freely: the rate of its spring is the derivative of its older differences of velocity. */
static void a_spring_lags_behind_its_ends(void **unused)
{
    (void)unused;
    enum { STEPS = 40, WINDOW = 12, LAG = 5 };
    const rheo_real position[] = {0, 0, 0, 1, 0.25F, 0}, velocity[] = {0, 2, 1, 0, -2, 0};
    for (int run = 0; run < 4; run++) {
        rheo_world_def def = inert_def();
        def.fluid.stiffness = 20;
        def.fluid.near_stiffness = 30;
        def.springs.stiffness = 30;
        def.history.stiffness = 100;
        def.history.window = WINDOW;
        def.history.lag = LAG;
        def.scheme = run % 2 ? RHEO_SCHEME_SEQUENTIAL : RHEO_SCHEME_SUMMED;
        def.history.kind = run / 2 ? RHEO_HISTORY_WINDOW_FAST : RHEO_HISTORY_WINDOW;
        rheo_world *world = world_of(def, 2, position, velocity);
        double v[3][STEPS], exact[STEPS];
        bool moved = false;
        for (int n = 0; n < STEPS; n++) {
            step(world, 1);
            double rate = 0;
            for (int axis = 0; axis < 3; axis++) {
                v[axis][n] = (double)(rheo_world_velocities(world)[axis] - rheo_world_velocities(world)[3 + axis]);
                OK(rheo_fractional_derivative(v[axis], (size_t)n + 1, .5, .033, WINDOW, RHEO_WEIGHTS_PAPER, exact));
                rate += n < LAG ? 0 : exact[n - LAG] * exact[n - LAG];
            }
            rheo_spring_state spring;
            OK(rheo_world_spring(world, 0, 1, &spring, &error));
            NEAR(spring.history_rate, sqrt(rate), (run / 2 ? 1e-3 : 2e-5) * 10);
            if (n < LAG)
                assert_true(spring.stiffness == 30);
            moved = moved || spring.history_rate > 1;
        }
        assert_true(moved);
        rheo_world_destroy(world);
    }
}

static rheo_world *lively(int kind, int scheme, uint32_t lag)
{
    rheo_scene scene = lively_scene();
    scene.settle.time = 0;
    scene.world.scheme = scheme ? RHEO_SCHEME_SEQUENTIAL : RHEO_SCHEME_SUMMED;
    scene.world.springs.solver = RHEO_SOLVER_IMPLICIT;
    scene.world.history.kind = (rheo_history_kind)kind;
    scene.world.history.window = 4;
    scene.world.history.lag = lag;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    return world;
}

/* A state goes on from a checkpoint of any step, and from the stored state of any step of a recording. */
static void any_step_is_resumed(void **unused)
{
    (void)unused;
    for (int kind = RHEO_HISTORY_WINDOW; kind <= RHEO_HISTORY_TEMPERED; kind++) {
        char what[16];
        snprintf(what, sizeof what, "kind %d", kind);
        resume_every_step(lively(kind, kind % 2, 3), 12, PATH, what);
        remove(PATH);
    }
}

/* ---- What is stored ---- */

static bool has_field(const rheo_world *world, const char *name, uint64_t *rows)
{
    rheo_field_info info;
    for (uint32_t i = 0; rheo_world_field(world, i, &info) == RHEO_OK; i++)
        if (strcmp(info.name, name) == 0) {
            *rows = info.rows;
            return true;
        }
    return false;
}

/* The ring is longer by the lag. Memories without a window get a ring of the velocities that wait, and one more. */
static void the_ring_holds_what_waits(void **unused)
{
    (void)unused;
    for (uint32_t lag = 0; lag <= 3; lag += 3)
        for (int kind = RHEO_HISTORY_WINDOW; kind <= RHEO_HISTORY_TEMPERED; kind++) {
            rheo_world *world = lively(kind, 0, lag);
            const uint32_t n = rheo_world_particle_count(world);
            const uint64_t ring = has_window(kind) ? lag + 5 : lag ? lag + 2 : 0;
            uint64_t rows = 0, modes = 0;
            assert_int_equal(rheo_world_history_lag(world), lag);
            assert_int_equal(rheo_world_history_rows(world), 0);
            for (uint32_t s = 1; s <= 10; s++) {
                step(world, 1);
                const uint32_t shown = has_window(kind) ? lag + 5 : lag + 1;
                assert_int_equal(rheo_world_history_rows(world), s < shown ? s : shown);
                assert_true(has_field(world, "history_velocity", &rows) == (ring > 0));
                assert_int_equal(rows, s < ring ? s : ring);
            }
            assert_true(has_field(world, "history_modes", &modes) == (kind != RHEO_HISTORY_WINDOW));
            assert_int_equal(rheo_world_history_bytes(world), (ring + modes) * n * 3 * sizeof(rheo_real));
            rheo_real past[3 * 8];
            OK(rheo_world_particle_history(world, n - 1, past));
            assert_memory_equal(past, rheo_world_velocities(world) + 3 * (size_t)(n - 1), 3 * sizeof *past);
            rheo_world_destroy(world);
        }
}

static bool names_the_lag(const rheo_world_def *def)
{
    rheo__bytes bytes = {0};
    bool found = false;
    rheo__parameters_put(&bytes, def);
    assert_true(!bytes.failed);
    for (size_t i = 0; i + 11 <= bytes.size; i++)
        found = found || memcmp((const char *)bytes.data + i, "history.lag", 11) == 0;
    rheo__bytes_release(&bytes);
    return found;
}

/* Programs that do not know the lag read a file without one. */
static void a_file_names_only_a_lag_that_there_is(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def();
    assert_true(!names_the_lag(&def));
    def.history.lag = 1;
    assert_true(names_the_lag(&def));
    def.history.lag = 0;
    def.history.lag_seconds = 0.5;
    assert_true(names_the_lag(&def));
}

/* Loading refuses a velocity of the one row that is not shown. */
static void all_rows_of_a_file_are_checked(void **unused)
{
    (void)unused;
    rheo_world *world = lively(RHEO_HISTORY_FULL, 0, 2);
    step(world, 6);
    assert_int_equal(rheo_world_history_rows(world), 3);
    OK(rheo__world_check_state(world, true, &error));
    rheo__ring_block(&world->state.ring, 0, rheo__ring_slot(&world->state.ring, 3))[4] = (rheo_real)INFINITY;
    REFUSED(RHEO_ERROR_FORMAT, "history_velocity of particle 1 at lag 3 is not finite",
            rheo__world_check_state(world, true, &error));
    rheo_world_destroy(world);
}

/* ---- The parameter ---- */

static uint32_t lag_from(const char *text)
{
    rheo_world_def def = rheo_default_world_def();
    OK(rheo_world_def_set(&def, "history.lag", text, &error));
    rheo_world *world = world_of(def, 0, NULL, NULL);
    const uint32_t lag = rheo_world_history_lag(world);
    assert_true(rheo_world_definition(world)->history.lag == lag &&
                rheo_world_definition(world)->history.lag_seconds == 0);
    rheo_world_destroy(world);
    return lag;
}

static void a_lag_is_in_steps_or_seconds(void **unused)
{
    (void)unused;
    assert_int_equal(lag_from("0"), 0);
    assert_int_equal(lag_from("7"), 7);
    assert_int_equal(lag_from("1000000"), 1000000);
    assert_int_equal(lag_from("0 s"), 0);
    assert_int_equal(lag_from("0.5 s"), 15); /* 0.5/0.033 = 15.15 */
    assert_int_equal(lag_from("0.51 s"), 15);
    assert_int_equal(lag_from("0.52 s"), 16);
    rheo_world_def def = rheo_default_world_def();
    char text[32];
    OK(rheo_world_def_set(&def, "history.lag", "0.5 s", &error));
    OK(rheo_world_def_get(&def, "history.lag", text, sizeof text));
    assert_string_equal(text, "0.5 s");
    assert_true(def.history.lag_seconds == .5 && def.history.window == 150 && def.history.window_seconds == 0);
    const rheo_scene built_in = builtin_scene("bowling-ball-small");
    assert_true(built_in.world.history.lag == 0 && built_in.world.history.lag_seconds == 0);
}

static void a_bad_lag_is_refused(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def();
    rheo_world *world;
    static const char *const bad[][2] = {
        {"-1", "steps from 0 to 1e+06"},          {"1000001", "steps from 0 to 1e+06"},
        {"1.5", "whole number of steps"},         {"-1 s", "a number of steps"},
        {"nan", "or seconds, as in \"2.5 s\""},   {"1 d", "or seconds, as in \"2.5 s\""},
        {"inf s", "or seconds, as in \"2.5 s\""},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        rheo_error error = {""};
        const rheo_result result = rheo_world_def_set(&def, "history.lag", bad[i][0], &error);
        if (result != RHEO_ERROR_ARGUMENT || !says(error.message, "history.lag") || !says(error.message, bad[i][1]))
            fail_msg("%s: \"%s\" does not say \"%s\"", bad[i][0], error.message, bad[i][1]);
        assert_true(def.history.lag == 0 && def.history.lag_seconds == 0);
    }
    def.history.lag_seconds = 40000;
    REFUSED(RHEO_ERROR_ARGUMENT,
            "history.lag is 40000 s, 1.21212e+06 steps of 0.033; it must be from 1 to 1000000 steps",
            rheo_world_create(&def, &world, &error));
    def.history.lag_seconds = 0.0001; /* it would round to no lag */
    REFUSED(RHEO_ERROR_ARGUMENT, "it must be from 1 to 1000000 steps", rheo_world_create(&def, &world, &error));
    def.history.lag_seconds = 0;
    def.history.lag = 1000001;
    REFUSED(RHEO_ERROR_ARGUMENT, "history.lag is 1000001", rheo_world_create(&def, &world, &error));
    world = lively(RHEO_HISTORY_WINDOW, 0, 2);
    REFUSED(RHEO_ERROR_ARGUMENT, "history.lag is fixed", rheo_world_set(world, "history.lag", "3", &error));
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lag_only_delays),
        cmocka_unit_test(a_change_of_the_weights_is_delayed_too),
        cmocka_unit_test(a_lagging_derivative_is_that_of_the_older_velocities),
        cmocka_unit_test(a_spring_lags_behind_its_ends),
        cmocka_unit_test(any_step_is_resumed),
        cmocka_unit_test(the_ring_holds_what_waits),
        cmocka_unit_test(a_file_names_only_a_lag_that_there_is),
        cmocka_unit_test(all_rows_of_a_file_are_checked),
        cmocka_unit_test(a_lag_is_in_steps_or_seconds),
        cmocka_unit_test(a_bad_lag_is_refused),
    };
    return cmocka_run_group_tests_name("lag", tests, NULL, NULL);
}
