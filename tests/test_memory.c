/*
 * The history kinds other than the exact window: exponential fits of the weights, derivatives of whole signals, and
 * worlds of each kind. Exact values are sums over the exact weights in double.
 */
#include "support.h"

#include <math.h>

#include "record/recording.h"
#include "world/model_thickening.h"

static const double ORDER[] = {.2, .5, .8};
enum { ORDERS = 3, PULSE = 0, PLATEAU, SINE, SQUARE, DECAY, SIGNALS };
#define STEP 0.033
#define PI 3.14159265358979323846

/* Velocities of Figures 3 and 4 of the paper, and of x = sin 2 pi t, t^2, e^-t with t = 1 at n = 1000. */
static double signal(int which, size_t n)
{
    const double u = ((double)n * STEP - 1) / .33, t = (double)n / 1000;
    switch (which) {
    case PULSE:
        return u > 0 && u < 1 ? 5 * sin(PI * u) * sin(PI * u) : 0;
    case PLATEAU:
        return n >= 31 && n <= 181;
    case SINE:
        return 2 * PI * cos(2 * PI * t);
    case SQUARE:
        return 2 * t;
    default:
        return -exp(-t);
    }
}

static double *weights_of(double q, size_t count, rheo_weights kind)
{
    double *weight = malloc(count * sizeof *weight);
    assert_non_null(weight);
    if (kind == RHEO_WEIGHTS_PAPER)
        rheo_history_weights(q, count, weight);
    else
        rheo_history_weights_l1(q, count, weight);
    return weight;
}

/* ---- Fits ---- */

static double largest_error(double q, uint32_t lags, rheo_weights kind, const rheo_history_modes *modes, double tau)
{
    double *weight = weights_of(q, lags + 1, kind), largest = 0;
    for (uint32_t lag = 1; lag <= lags; lag++) {
        double exact = weight[lag] * (tau > 0 ? exp(-(double)lag / tau) : 1);
        largest = fmax(largest, fabs(rheo_history_modes_weight(modes, lag) / exact - 1));
    }
    free(weight);
    return largest;
}

static void fits_are_as_near_as_declared(void **unused)
{
    (void)unused;
    const double order[] = {1e-6, .01, .05, .2, .5, .6, .8, .95, .99, .999999};
    const double bound[] = {5e-4, 5e-4, 5e-4, 5e-4, 5e-4, 7e-4, 1.4e-3, 2.5e-3, 2.5e-3, 2.5e-3};
    const uint32_t lags[] = {1, 2, 3, 5, 7, 20, 50, 150, 250, 500, 1500, 16384};
    const uint32_t counts[] = {1, 2, 3, 5, 6, 7, 8, 9, 9, 10, 11, 13};
    const size_t stride = every() > 1 ? 3 : 1; /* which leaves every order and every number of lags */
    for (int kind = 0; kind < 2; kind++)
        for (size_t i = 0; i < sizeof order / sizeof *order; i++)
            for (size_t j = i % stride; j < sizeof lags / sizeof *lags; j += stride) {
                rheo_history_modes modes;
                OK(rheo_history_fit(order[i], lags[j], (rheo_weights)kind, &modes));
                assert_int_equal(modes.count, counts[j]);
                assert_int_equal(modes.lags, lags[j]);
                const double largest = largest_error(order[i], lags[j], (rheo_weights)kind, &modes, 0);
                if (!(largest <= (lags[j] <= 5 ? 1e-14 : bound[i])))
                    fail_msg("q = %g, %u lags: error %g", order[i], lags[j], largest);
                /* The error reported for some lags is nearly the error over all lags. */
                assert_true(modes.error <= largest * 1.0001 + 1e-15 && modes.error >= largest * .97 - 1e-15);
                for (uint32_t k = 1; k < modes.count; k++)
                    assert_true(modes.rate[k] > modes.rate[k - 1]);
                assert_true(modes.rate[0] > 0 && rheo_history_modes_weight(&modes, 0) == 1);
            }
}

/* The first sample's weight fits a_{0,n} as accurately as the other weights fit c_m. */
static void the_first_sample_has_its_own_weight(void **unused)
{
    (void)unused;
    for (int o = 0; o < ORDERS; o++) {
        rheo_history_modes modes;
        OK(rheo_history_fit(ORDER[o], 16384, RHEO_WEIGHTS_PAPER, &modes));
        double largest = 0;
        for (size_t n = 1; n <= 16384; n++) {
            double sum = 0;
            for (uint32_t k = 0; k < modes.count; k++)
                sum += modes.weight[k] * modes.first[k] * exp(-modes.rate[k] * (double)(n - 1));
            largest = fmax(largest, fabs(sum / rheo_history_first_weight(ORDER[o], n) - 1));
        }
        if (!(largest < 4e-3))
            fail_msg("q = %g: %g", ORDER[o], largest);
        print_message("q = %g: first weights to %.2g\n", ORDER[o], largest);
    }
}

static void fading_keeps_the_relative_errors(void **unused)
{
    (void)unused;
    for (int o = 0; o < ORDERS; o++) {
        rheo_history_modes modes;
        OK(rheo_history_fit(ORDER[o], 2000, RHEO_WEIGHTS_PAPER, &modes));
        const double before = largest_error(ORDER[o], 2000, RHEO_WEIGHTS_PAPER, &modes, 0);
        const double tau = rheo_history_tempering(ORDER[o], 150);
        NEAR(tau, 150 / pow(tgamma(2 - ORDER[o]), 1 / (1 - ORDER[o])), 1e-10);
        rheo_history_temper(&modes, tau);
        NEAR(largest_error(ORDER[o], 2000, RHEO_WEIGHTS_PAPER, &modes, tau), before, 1e-9);
        /* Constant speed has the result of the window, apart from the difference between a sum and an integral. */
        double fading = 1, window = 1, *weight = weights_of(ORDER[o], 100000, RHEO_WEIGHTS_PAPER);
        for (size_t lag = 1; lag < 100000; lag++) {
            fading += weight[lag] * exp(-(double)lag / tau);
            window += lag <= 150 ? weight[lag] : 0;
        }
        NEAR(fading / window, 1, .01);
        free(weight);
    }
    assert_true(rheo_history_tempering(0, 5) != rheo_history_tempering(0, 5));
    assert_true(rheo_history_tempering(.5, 0) != rheo_history_tempering(.5, 0));
}

static void bad_arguments_are_refused(void **unused)
{
    (void)unused;
    rheo_history_modes modes = {.count = 77};
    const double nan = NAN, v[2] = {1, 2};
    double d[2] = {5, 5};
    const struct {
        double q;
        uint32_t lags;
        int kind;
    } bad[] = {{0, 5, 0}, {1, 5, 0}, {-1, 5, 0}, {nan, 5, 0}, {.5, 0, 0}, {.5, (1u << 30) + 1, 0}, {.5, 5, 2}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(rheo_history_fit(bad[i].q, bad[i].lags, (rheo_weights)bad[i].kind, &modes),
                         RHEO_ERROR_ARGUMENT);
    assert_int_equal(rheo_history_fit(.5, 5, RHEO_WEIGHTS_PAPER, NULL), RHEO_ERROR_ARGUMENT);
    assert_int_equal(modes.count, 77);
    assert_int_equal(rheo_fractional_derivative_by_modes(v, 2, &modes, .5, 1, 0, RHEO_WEIGHTS_PAPER, d),
                     RHEO_ERROR_ARGUMENT);
    OK(rheo_history_fit(.5, 1 << 30, RHEO_WEIGHTS_PAPER, &modes));
    assert_true(modes.count <= RHEO_HISTORY_MAX_MODES && modes.error < 4e-4);
    assert_int_equal(rheo_fractional_derivative_by_modes(NULL, 2, &modes, .5, 1, 0, RHEO_WEIGHTS_PAPER, d),
                     RHEO_ERROR_ARGUMENT);
    assert_int_equal(rheo_fractional_derivative_by_modes(v, 2, NULL, .5, 1, 0, RHEO_WEIGHTS_PAPER, d),
                     RHEO_ERROR_ARGUMENT);
    assert_int_equal(rheo_fractional_derivative_by_modes(v, 2, &modes, 1, 1, 0, RHEO_WEIGHTS_PAPER, d),
                     RHEO_ERROR_ARGUMENT);
    assert_int_equal(rheo_fractional_derivative_by_modes(v, 2, &modes, .5, nan, 0, RHEO_WEIGHTS_PAPER, d),
                     RHEO_ERROR_ARGUMENT);
    assert_int_equal(rheo_fractional_derivative_by_modes(v, 2, &modes, .5, 1, 0, (rheo_weights)2, d),
                     RHEO_ERROR_ARGUMENT);
    assert_true(d[0] == 5 && d[1] == 5);
}

/* ---- Whole signals, in double ---- */

/* Largest error, relative to the largest derivative so far. */
static double error_of(const double *actual, const double *exact, size_t count)
{
    double largest = 0, error = 0;
    for (size_t n = 0; n < count; n++) {
        largest = fmax(largest, fabs(exact[n]));
        if (largest > 0)
            error = fmax(error, fabs(actual[n] - exact[n]) / largest);
    }
    return error;
}

static void signals_are_near_the_exact_sums(void **unused)
{
    (void)unused;
    enum { COUNT = 1500 };
    static double v[COUNT], exact[COUNT], actual[COUNT];
    const size_t windows[] = {0, 1, 2, 50, 150, 500};
    const double bound[] = {1.6e-4, 4.5e-4, 6e-4};
    for (int kind = 0; kind < 2; kind++)
        for (int o = 0; o < ORDERS; o++)
            for (size_t w = 0; w < sizeof windows / sizeof *windows; w++)
                for (int s = 0; s < SIGNALS; s++) {
                    for (size_t n = 0; n < COUNT; n++)
                        v[n] = signal(s, n);
                    rheo_history_modes modes;
                    OK(rheo_history_fit(ORDER[o], windows[w] ? (uint32_t)windows[w] : COUNT, (rheo_weights)kind,
                                        &modes));
                    OK(rheo_fractional_derivative(v, COUNT, ORDER[o], STEP, windows[w], (rheo_weights)kind, exact));
                    OK(rheo_fractional_derivative_by_modes(v, COUNT, &modes, ORDER[o], STEP, windows[w],
                                                           (rheo_weights)kind, actual));
                    const double error = error_of(actual, exact, COUNT);
                    /* One or two lags are fitted exactly, but the first sample's weight is one more condition. */
                    if (!(error <= bound[o]) && !(windows[w] && windows[w] <= 2 && error < .02))
                        fail_msg("kind %d, q = %g, window %zu, signal %d: error %g", kind, ORDER[o], windows[w], s,
                                 error);
                }
}

/* The tables of Figures 3 and 4, and closed forms at t = 1, where the rule's own error is far smaller. */
static void signals_have_their_known_derivatives(void **unused)
{
    (void)unused;
    enum { COUNT = 1500 };
    static double v[COUNT], d[COUNT];
    const double pulse[ORDERS][3] = {{1.109634582, .608940399, .394774894},
                                     {1.875784809, .318643149, .107823892},
                                     {3.321230936, .098013346, .017310100}};
    const size_t peak[ORDERS] = {38, 37, 36};
    const double plateau[ORDERS][2] = {
        {2.085785913, 2.971418971}, {1.708848238, 1.133682319}, {1.285809546, .255515452}};
    const double closed[SIGNALS][ORDERS] = {[SINE] = {.420394683944, 1.730813259632, 4.112491665247},
                                            [SQUARE] = {1.192968082256, 1.504505556127, 1.815207368431},
                                            [DECAY] = {-.644084400234, -.607157705841, -.490773772623}};
    for (int o = 0; o < ORDERS; o++) {
        rheo_history_modes modes;
        OK(rheo_history_fit(ORDER[o], COUNT, RHEO_WEIGHTS_PAPER, &modes));
        for (int s = 0; s < SIGNALS; s++) {
            for (size_t n = 0; n < COUNT; n++)
                v[n] = signal(s, n);
            OK(rheo_fractional_derivative_by_modes(v, COUNT, &modes, ORDER[o], s < SINE ? STEP : 1e-3, 0,
                                                   RHEO_WEIGHTS_PAPER, d));
            if (s == PULSE) {
                NEAR(d[peak[o]] / pulse[o][0], 1, 2e-4);
                NEAR(d[100] / pulse[o][1], 1, 1e-3);
                NEAR(d[600] / pulse[o][2], 1, 1e-3);
            } else if (s == PLATEAU) {
                NEAR(d[100] / plateau[o][0], 1, 2e-4);
                NEAR(d[300] / plateau[o][1], 1, 1e-3);
            } else {
                NEAR(d[1000] / closed[s][o], 1, 1e-3);
            }
        }
    }
}

/* ---- Worlds fed with a signal ---- */

/* One particle; only its history is used. */
static rheo_world *memory_of(rheo_history_kind kind, double q, uint32_t window, rheo_weights weights)
{
    const rheo_real nowhere[3] = {0, 0, 0};
    rheo_world_def def = rheo_default_world_def();
    def.step = STEP;
    def.history.kind = kind;
    def.history.order = q;
    def.history.window = window;
    def.history.weights = weights;
    return world_of(def, 1, nowhere, NULL);
}

static void feed(rheo_world *world, double v)
{
    world->state.velocity[0] = (rheo_real)v;
    world->state.velocity[1] = (rheo_real)(-2 * v);
    OK(rheo__stage_history(&world->state, rheo__thickening_of(world)));
}

static double derivative(const rheo_world *world)
{
    rheo_real d[3];
    rheo__derivatives(&world->state, rheo__thickening_of(world), d);
    NEAR((double)d[1] / -2, (double)d[0], 1e-5 * fabs((double)d[0]) + 1e-30);
    assert_true(d[2] == 0);
    return (double)d[0];
}

/* D^q after the velocities v_0 .. v_n. A world counts the first row in both rules. */
static double exact(const double *v, size_t n, const double *weight, double q, size_t window, rheo_weights kind,
                    double tau)
{
    double sum = 0;
    for (size_t lag = window && n > window ? window + 1 : n + 1; lag-- > 0;) {
        bool first = lag == n && kind == RHEO_WEIGHTS_PAPER && (!window || n < window);
        double w = first ? rheo_history_first_weight(q, n) : weight[lag];
        sum += w * (tau > 0 ? exp(-(double)lag / tau) : 1) * (double)(rheo_real)v[n - lag];
    }
    return rheo_history_scale(q, STEP, kind) * sum;
}

/* Feeds a signal to a world and compares at every step, later every n/32 steps. Returns the relative error. */
static double fed_error(rheo_history_kind kind, double q, uint32_t window, rheo_weights weights, int which,
                        size_t count)
{
    rheo_world *world = memory_of(kind, q, window, weights);
    double *weight = weights_of(q, count, weights), *v = malloc(count * sizeof *v), largest = 0, error = 0;
    assert_non_null(v);
    const double tau = kind == RHEO_HISTORY_TEMPERED ? rheo_history_tempering(q, window) : 0;
    const size_t cut = kind == RHEO_HISTORY_WINDOW || kind == RHEO_HISTORY_WINDOW_FAST ? window : 0;
    assert_true(derivative(world) == 0);
    for (size_t n = 0, next = 0; n < count; n++) {
        v[n] = signal(which, n);
        feed(world, v[n]);
        if (n < next && n + 1 < count)
            continue;
        next = n + 1 + n / 32;
        const double right = exact(v, n, weight, q, cut, weights, tau);
        largest = fmax(largest, fabs(right));
        if (largest > 0)
            error = fmax(error, fabs(derivative(world) - right) / largest);
    }
    free(weight);
    free(v);
    rheo_world_destroy(world);
    return error;
}

static void memories_are_near_the_exact_sums(void **unused)
{
    (void)unused;
    const struct {
        rheo_history_kind kind;
        uint32_t window;
        size_t count;
        double bound[ORDERS];
    } cases[] = {
        {RHEO_HISTORY_WINDOW, 150, 1500, {3e-6, 3e-6, 3e-6}},
        {RHEO_HISTORY_WINDOW_FAST, 50, 1500, {1.6e-4, 4.5e-4, 6e-4}},
        {RHEO_HISTORY_WINDOW_FAST, 500, 1500, {1.6e-4, 4.5e-4, 6e-4}},
        {RHEO_HISTORY_WINDOW_FAST, 5000, 16000, {1.6e-4, 4.5e-4, 6e-4}},
        {RHEO_HISTORY_FULL, 1, 1500, {1.6e-4, 4.5e-4, 6e-4}},
        {RHEO_HISTORY_FULL, 1, 16000, {1.6e-4, 4.5e-4, 6e-4}},
        {RHEO_HISTORY_TEMPERED, 150, 1500, {1.6e-4, 4.5e-4, 6e-4}},
        {RHEO_HISTORY_TEMPERED, 2000, 16000, {1.6e-4, 4.5e-4, 6e-4}},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++)
        for (int o = 0; o < ORDERS; o++)
            for (int weights = 0; weights < 2; weights++)
                for (int s = 0; s < SIGNALS; s++) {
                    const double error =
                        fed_error(cases[c].kind, ORDER[o], cases[c].window, (rheo_weights)weights, s, cases[c].count);
                    if (getenv("SHOW"))
                        print_message("%zu q=%g w%d s%d %.2g\n", c, ORDER[o], weights, s, error);
                    if (!(error <= cases[c].bound[o]))
                        fail_msg("kind %d, window %u, %zu steps, q = %g, weights %d, signal %d: error %g",
                                 cases[c].kind, cases[c].window, cases[c].count, ORDER[o], weights, s, error);
                }
}

/* Errors do not accumulate: they are equal after many steps of noise and bursts, and rest is exact. */
static void a_window_does_not_drift(void **unused)
{
    (void)unused;
    enum { COUNT = 400000 };
    double *v = malloc(COUNT * sizeof *v);
    assert_non_null(v);
    uint64_t seed = 1;
    for (size_t n = 0; n < COUNT; n++) {
        seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        v[n] = (double)(seed >> 11) / 9007199254740992.0 - .4 + (n % 7000 < 300 ? 20 : 0);
    }
    const uint32_t windows[] = {50, 150, 500};
    for (int i = 0; i < 3; i++) {
        const uint32_t d = windows[i];
        rheo_world *world = memory_of(RHEO_HISTORY_WINDOW_FAST, .5, d, RHEO_WEIGHTS_PAPER);
        double *weight = weights_of(.5, d + 1, RHEO_WEIGHTS_PAPER), largest = 0, error = 0;
        for (size_t n = 0; n < COUNT; n++) {
            feed(world, v[n]);
            if (n % 1201 && n < COUNT - 100)
                continue;
            const double right = exact(v, n, weight, .5, d, RHEO_WEIGHTS_PAPER, 0);
            largest = fmax(largest, fabs(right));
            error = fmax(error, fabs(derivative(world) - right));
        }
        if (!(error <= 2e-4 * largest))
            fail_msg("window %u: %g of %g", d, error, largest);
        for (uint32_t n = 0; n <= d; n++)
            feed(world, 0);
        if (!(fabs(derivative(world)) <= 1e-6 * largest))
            fail_msg("window %u, at rest: %g of %g", d, derivative(world), largest);
        free(weight);
        rheo_world_destroy(world);
    }
    free(v);
}

/* Kind full does not drift. Beyond its lags it underestimates constant speed by a known fraction. */
static void the_full_history_is_exact_and_then_fades(void **unused)
{
    (void)unused;
    const struct {
        size_t steps;
        double low, high;
    } at[] = {{1000, -4e-5, 4e-5}, {16384, -4e-5, 4e-5}, {30000, -2e-3, -1e-4}, {100000, -.1, -.02}};
    rheo_world *world = memory_of(RHEO_HISTORY_FULL, .5, 1, RHEO_WEIGHTS_PAPER);
    size_t n = 0;
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        for (; n < at[i].steps; n++)
            feed(world, .7);
        /* The sum of all weights telescopes: D^q x = t^(1-q) / Gamma(2-q) at constant speed. */
        const double right = pow((double)(n - 1) * STEP, .5) / tgamma(1.5),
                     error = derivative(world) / (double)(rheo_real).7 / right - 1;
        print_message("full, q = 0.5, constant speed for %zu steps: %.2g\n", n, error);
        if (!(error > at[i].low && error < at[i].high))
            fail_msg("%zu steps: %g", n, error);
    }
    rheo_world_destroy(world);
}

/*
 * A long window. Modes that decay by 1e-5 per step compensate rounding; otherwise the error in float would be 1e-4.
 */
static void a_long_window_has_its_plateau(void **unused)
{
    (void)unused;
    enum { WINDOW = 20000 };
    rheo_world *world = memory_of(RHEO_HISTORY_WINDOW_FAST, .2, WINDOW, RHEO_WEIGHTS_PAPER);
    assert_true(rheo__thickening_of(world)->modes.slow == (sizeof(rheo_real) == 4 ? 3 : 0));
    for (int n = 0; n < WINDOW + 2000; n++)
        feed(world, .7);
    const double plateau = rheo_history_scale(.2, STEP, RHEO_WEIGHTS_PAPER) * (double)(rheo_real).7 *
                           (pow(WINDOW + 1, 1.8) - pow(WINDOW, 1.8));
    print_message("window of %d: %.2g off its plateau\n", WINDOW, derivative(world) / plateau - 1);
    NEAR(derivative(world) / plateau, 1, 3e-5);
    rheo_world_destroy(world);
}

/* Decaying sums reach 0 without denormal numbers. */
static void decaying_sums_reach_zero(void **unused)
{
    (void)unused;
    for (int kind = RHEO_HISTORY_WINDOW_FAST; kind <= RHEO_HISTORY_TEMPERED; kind++) {
        rheo_world *world = memory_of((rheo_history_kind)kind, .5, 20, RHEO_WEIGHTS_PAPER);
        feed(world, 1e-20);
        for (int n = 0; n < 100000; n++) {
            feed(world, 0);
            if (kind != RHEO_HISTORY_FULL || n < 10000)
                continue;
            for (size_t i = 0; i < world->state.modes.length; i++) {
                rheo_real y = rheo__ring_value(&world->state.modes, (uint32_t)i, 0);
                assert_true(y == 0 || fabs((double)y) >= 1e-30);
            }
        }
        if (kind != RHEO_HISTORY_FULL)
            assert_true(derivative(world) == 0);
        rheo_world_destroy(world);
    }
}

/* ---- Running worlds ---- */

static rheo_world *lively(rheo_history_kind kind)
{
    rheo_scene scene = lively_scene();
    scene.world.history.kind = kind;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    return world;
}

/* D^q x of every particle against sums over its recorded velocities, relative to the largest sum of absolute values. */
static void check_derivatives(const rheo_world *world, const rheo_real *past, size_t rows, uint32_t particles)
{
    const rheo_world_def *def = rheo_world_definition(world);
    const double q = def->history.order;
    const bool full = def->history.kind == RHEO_HISTORY_FULL, fading = def->history.kind == RHEO_HISTORY_TEMPERED;
    const double tau = fading ? rheo_history_tempering(q, def->history.window) : 0;
    const size_t d = full || fading ? rows : def->history.window;
    double *weight = weights_of(q, rows + 1, def->history.weights), largest = 0, worst = 0;
    const double scale = rheo_history_scale(q, def->step, def->history.weights);
    for (uint32_t id = 0; id < particles; id++) {
        rheo_particle_state p;
        OK(rheo_world_particle(world, id, &p, &error));
        for (size_t axis = 0; axis < 3; axis++) {
            double sum = 0, size = 0;
            for (size_t lag = 0; lag < rows && lag <= d; lag++) {
                const bool first = lag == rows - 1 && lag < d && def->history.weights == RHEO_WEIGHTS_PAPER;
                const double w = first ? rheo_history_first_weight(q, lag) : weight[lag];
                const double term = w * (fading ? exp(-(double)lag / tau) : 1) *
                                    (double)past[((rows - 1 - lag) * particles + id) * 3 + axis];
                sum += term;
                size += fabs(term);
            }
            largest = fmax(largest, scale * size);
            worst = fmax(worst, fabs(p.derivative[axis] - scale * sum));
        }
    }
    /* Modes fit the weight of the first velocity worst, in the first steps. */
    if (!(worst <= (rows < 4 ? 1e-3 : 2e-4) * largest && largest > 0))
        fail_msg("kind %d, row %zu: %g of %g", def->history.kind, rows, worst, largest);
    free(weight);
}

static void derivatives_in_a_running_world_are_right_every_step(void **unused)
{
    (void)unused;
    enum { STEPS = 40 };
    for (int kind = RHEO_HISTORY_WINDOW; kind <= RHEO_HISTORY_TEMPERED; kind++) {
        rheo_world *world = lively((rheo_history_kind)kind);
        const uint32_t n = rheo_world_particle_count(world);
        rheo_real *past = malloc(STEPS * (size_t)n * 3 * sizeof *past);
        assert_non_null(past);
        for (size_t s = 0; s < STEPS; s++) {
            step(world, 1);
            memcpy(past + s * n * 3, rheo_world_velocities(world), (size_t)n * 3 * sizeof *past);
            check_derivatives(world, past, s + 1, n);
        }
        free(past);
        rheo_world_destroy(world);
    }
}

/* The weights change while the window fills and when it is full. */
static void the_order_and_the_weights_may_change(void **unused)
{
    (void)unused;
    enum { STEPS = 24 };
    for (int kind = RHEO_HISTORY_WINDOW; kind <= RHEO_HISTORY_FULL; kind++) {
        rheo_world *world = lively((rheo_history_kind)kind);
        const uint32_t n = rheo_world_particle_count(world);
        rheo_real *past = malloc(STEPS * (size_t)n * 3 * sizeof *past);
        assert_non_null(past);
        for (size_t s = 0; s < STEPS; s++) {
            if (s == 4)
                OK(rheo_world_set(world, "history.order", "0.2", &error));
            if (kind != RHEO_HISTORY_FULL && (s == 5 || s == 16))
                OK(rheo_world_set(world, "history.weights", "l1", &error));
            if (kind != RHEO_HISTORY_FULL && (s == 7 || s == 20))
                OK(rheo_world_set(world, "history.weights", "paper", &error));
            if (s == 13)
                OK(rheo_world_set(world, "history.order", "0.7", &error));
            if (s)
                check_derivatives(world, past, s, n);
            step(world, 1);
            memcpy(past + s * n * 3, rheo_world_velocities(world), (size_t)n * 3 * sizeof *past);
            check_derivatives(world, past, s + 1, n);
        }
        free(past);
        rheo_world_destroy(world);
    }
}

static void parameters_of_sums_are_fixed(void **unused)
{
    (void)unused;
    rheo_world *full = lively(RHEO_HISTORY_FULL), *fading = lively(RHEO_HISTORY_TEMPERED);
    step(full, 2);
    step(fading, 2);
    const uint64_t hash = rheo_world_hash(full);
    REFUSED(RHEO_ERROR_ARGUMENT, "history.weights: this world's memory (history.kind full) keeps sums",
            rheo_world_set(full, "history.weights", "l1", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "history.weights: this world's memory (history.kind tempered)",
            rheo_world_set(fading, "history.weights", "l1", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "history.order: this world's memory (history.kind tempered)",
            rheo_world_set(fading, "history.order", "0.4", &error));
    OK(rheo_world_set(fading, "history.order", "0.5", &error)); /* no change */
    OK(rheo_world_set(fading, "history.stiffness", "100", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "history.kind is fixed", rheo_world_set(full, "history.kind", "window", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "history.window is fixed", rheo_world_set(fading, "history.window", "9", &error));
    assert_true(rheo_world_hash(full) == hash);
    rheo_world_def def = rheo_default_world_def();
    assert_int_equal(def.history.kind, RHEO_HISTORY_WINDOW);
    REFUSED(RHEO_ERROR_ARGUMENT, "it is one of: window window-fast full tempered",
            rheo_world_def_set(&def, "history.kind", "windows", &error));
    rheo_world_destroy(full);
    rheo_world_destroy(fading);
}

/* Particles added later are assumed to have been at rest, for every history kind. */
static void added_particles_were_at_rest(void **unused)
{
    (void)unused;
    const rheo_real above[3] = {6, 100, 6}, falling[3] = {3, -2, 1};
    for (int kind = RHEO_HISTORY_WINDOW; kind <= RHEO_HISTORY_TEMPERED; kind++) {
        rheo_world *world = lively((rheo_history_kind)kind);
        const uint32_t id = rheo_world_particle_count(world);
        rheo_particle_state p;
        step(world, 14);
        OK(rheo_world_add_particles(world, 1, above, falling, &error));
        OK(rheo_world_particle(world, id, &p, &error));
        assert_true(p.derivative[0] == 0);
        step(world, 1);
        OK(rheo_world_particle(world, id, &p, &error));
        const double scale = rheo_history_scale(.5, rheo_world_definition(world)->step, RHEO_WEIGHTS_PAPER);
        NEAR(p.derivative[0], 3 * scale, 1e-5);
        step(world, 1);
        OK(rheo_world_particle(world, id, &p, &error));
        const double fades = kind == RHEO_HISTORY_TEMPERED ? exp(-1 / rheo_history_tempering(.5, 10)) : 1;
        NEAR(p.derivative[0], 3 * scale * (1 + (sqrt(8) - 2) * fades), 1e-3 * scale); /* an interior weight */
        rheo_world_destroy(world);
    }
}

static bool has_field(const rheo_world *world, const char *name, uint64_t rows)
{
    rheo_field_info info;
    for (uint32_t i = 0; rheo_world_field(world, i, &info) == RHEO_OK; i++)
        if (strcmp(info.name, name) == 0) {
            assert_int_equal(info.rows, rows);
            assert_true(info.ring && info.components == 3 && info.bytes == rows * info.items * 3 * sizeof(rheo_real));
            return true;
        }
    return false;
}

/* A history kind has its own fields, stores no others, and shows its contents. */
static void a_history_kind_has_only_its_fields(void **unused)
{
    (void)unused;
    const uint32_t modes[] = {0, 6, 13, 9}, slow[] = {0, 0, sizeof(rheo_real) == 4 ? 3 : 0, 0};
    for (int kind = RHEO_HISTORY_WINDOW; kind <= RHEO_HISTORY_TEMPERED; kind++) {
        const bool ring = kind <= RHEO_HISTORY_WINDOW_FAST;
        rheo_world *world = lively((rheo_history_kind)kind);
        const uint32_t n = rheo_world_particle_count(world), count = rheo_world_history_modes(world);
        const uint32_t rows = count ? count + slow[kind] + !ring : 0;
        assert_int_equal(count, modes[kind]);
        assert_int_equal(rheo_world_history_rows(world), 0);
        step(world, 4);
        assert_int_equal(rheo_world_history_window(world), kind == RHEO_HISTORY_FULL ? 0 : 10);
        assert_int_equal(rheo_world_history_rows(world), ring ? 4 : 1);
        assert_int_equal(rheo_world_history_bytes(world),
                         (size_t)n * 3 * sizeof(rheo_real) * (rows + (ring ? 11 : 0)));
        assert_true(has_field(world, "history_velocity", 4) == ring);
        assert_true(has_field(world, "history_modes", rows) == (count > 0));
        if (!ring)
            assert_true(!world->state.ring.values && !rheo__thickening_of(world)->weight);

        rheo_mode_state mode[RHEO_HISTORY_MAX_MODES], other[RHEO_HISTORY_MAX_MODES], pair[RHEO_HISTORY_MAX_MODES];
        rheo_real newest[3 * 4];
        if (count == 0) {
            assert_int_equal(rheo_world_particle_modes(world, 3, mode), RHEO_ERROR_ARGUMENT);
            assert_int_equal(rheo_world_spring_modes(world, 3, 4, mode), RHEO_ERROR_ARGUMENT);
            rheo_world_destroy(world);
            continue;
        }
        rheo_particle_state p;
        OK(rheo_world_particle(world, n - 1, &p, &error));
        OK(rheo_world_particle_history(world, n - 1, newest));
        assert_memory_equal(newest, rheo_world_velocities(world) + 3 * (size_t)(n - 1), 3 * sizeof *newest);
        OK(rheo_world_particle_modes(world, n - 1, mode));
        OK(rheo_world_particle_modes(world, 4, other));
        OK(rheo_world_spring_modes(world, n - 1, 4, pair));
        assert_int_equal(rheo_world_particle_modes(world, n, mode), RHEO_ERROR_ARGUMENT);
        assert_int_equal(rheo_world_spring_modes(world, n, 4, pair), RHEO_ERROR_ARGUMENT);
        assert_int_equal(rheo_world_spring_modes(world, 4, n, pair), RHEO_ERROR_ARGUMENT);
        const double scale = rheo_history_scale(.5, rheo_world_definition(world)->step, RHEO_WEIGHTS_PAPER);
        for (int axis = 0; axis < 3; axis++) {
            double sum = (double)newest[axis];
            for (uint32_t k = 0; k < count; k++) {
                sum += mode[k].weight * mode[k].sum[axis];
                assert_true(k == 0 || mode[k].decay > mode[k - 1].decay);
                assert_true(pair[k].sum[axis] == mode[k].sum[axis] - other[k].sum[axis]);
            }
            NEAR(p.derivative[axis], scale * sum, 1e-5 * fabs(scale * sum) + 1e-6);
        }
        rheo_world_destroy(world);
    }
}

/* A sum cannot be reversed, so a speed that makes it infinite fails the step. */
static void a_speed_that_overflows_a_sum_is_a_failure(void **unused)
{
    (void)unused;
    if (sizeof(rheo_real) != 4)
        skip();
    rheo_world *world = memory_of(RHEO_HISTORY_FULL, .5, 1, RHEO_WEIGHTS_PAPER);
    rheo_failure failure;
    step(world, 2);
    world->state.velocity[2] = (rheo_real)1e28;
    const uint64_t hash = rheo_world_hash(world);
    REFUSED(RHEO_ERROR_STATE, "velocity of particle 0 is not finite", rheo_world_step(world, &error));
    assert_true(rheo_world_hash(world) == hash && rheo_world_failure(world, &failure));
    assert_int_equal(failure.component, 2);
    rheo_world_destroy(world);
    /* The largest speed that a sum can hold, for the whole history. */
    world = memory_of(RHEO_HISTORY_FULL, .5, 1, RHEO_WEIGHTS_PAPER);
    for (int n = 0; n < 300000; n++)
        feed(world, 0x1p89);
    assert_true(rheo__world_check_state(world, true, NULL) == RHEO_OK && isfinite(derivative(world)));
    rheo_world_destroy(world);
}

/* Loading refuses sums that are not finite. */
static void sums_of_a_file_are_checked(void **unused)
{
    (void)unused;
    rheo_world *world = lively(RHEO_HISTORY_FULL);
    step(world, 1);
    OK(rheo__world_check_state(world, true, &error));
    *world->state.history_rows += UINT64_C(1) << 63;
    REFUSED(RHEO_ERROR_FORMAT, "9223372036854775809 velocities are more than a history can have had",
            rheo__world_check_state(world, true, &error));
    *world->state.history_rows = 1;
    rheo__ring_block(&world->state.modes, 0, 2)[5] = (rheo_real)INFINITY;
    char expected[80];
    snprintf(expected, sizeof expected, "history_modes of particle 1, row %u, is not finite",
             world->state.modes.length - 3);
    REFUSED(RHEO_ERROR_FORMAT, expected, rheo__world_check_state(world, true, &error));
    rheo_world_destroy(world);
    /* Loading refuses a velocity that would make a sum infinite when it leaves the window. */
    world = lively(RHEO_HISTORY_WINDOW_FAST);
    step(world, 2);
    OK(rheo__world_check_state(world, true, &error));
    rheo__ring_block(&world->state.ring, 0, rheo__ring_slot(&world->state.ring, 1))[4] = 2 * RHEO__LARGEST_SPEED;
    REFUSED(RHEO_ERROR_FORMAT, "history_velocity of particle 1 at lag 1 is not finite",
            rheo__world_check_state(world, true, &error));
    rheo_world_destroy(world);
}

/* Several modes differ. The report names the particle and row of the first. */
static void modes_are_compared_row_by_row(void **unused)
{
    (void)unused;
    rheo_world *world = lively(RHEO_HISTORY_FULL);
    rheo__values a = {0}, b = {0};
    rheo_difference first;
    const uint32_t n = rheo_world_particle_count(world);
    step(world, 3);
    OK(rheo__values_take(&a, &world->state, true, &error));
    assert_int_equal(a.items[RHEO__FIELD_history_modes], (uint64_t)n * world->state.modes.length);
    rheo__ring_block(&world->state.modes, 1, rheo__ring_slot(&world->state.modes, 2))[6] += 1;
    rheo__ring_block(&world->state.modes, 0, rheo__ring_slot(&world->state.modes, 5))[9] += 2;
    OK(rheo__values_take(&b, &world->state, true, &error));
    assert_int_equal(rheo__compare_field(RHEO__FIELD_history_modes, &a, &b, RHEO_VALUES_STORED, &first, NULL), 2);
    assert_true(first.id == (RHEO__RING_BLOCK + 6) / 3 && first.component == 2 * 3 + (RHEO__RING_BLOCK + 6) % 3 &&
                first.count == 2);
    assert_int_equal(rheo__compare_field(RHEO__FIELD_velocity, &a, &b, RHEO_VALUES_STORED, &first, NULL), 0);
    rheo__values_release(&a);
    rheo__values_release(&b);
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fits_are_as_near_as_declared),
        cmocka_unit_test(the_first_sample_has_its_own_weight),
        cmocka_unit_test(fading_keeps_the_relative_errors),
        cmocka_unit_test(bad_arguments_are_refused),
        cmocka_unit_test(signals_are_near_the_exact_sums),
        cmocka_unit_test(signals_have_their_known_derivatives),
        cmocka_unit_test(memories_are_near_the_exact_sums),
        cmocka_unit_test(a_window_does_not_drift),
        cmocka_unit_test(the_full_history_is_exact_and_then_fades),
        cmocka_unit_test(a_long_window_has_its_plateau),
        cmocka_unit_test(decaying_sums_reach_zero),
        cmocka_unit_test(derivatives_in_a_running_world_are_right_every_step),
        cmocka_unit_test(the_order_and_the_weights_may_change),
        cmocka_unit_test(parameters_of_sums_are_fixed),
        cmocka_unit_test(added_particles_were_at_rest),
        cmocka_unit_test(a_history_kind_has_only_its_fields),
        cmocka_unit_test(a_speed_that_overflows_a_sum_is_a_failure),
        cmocka_unit_test(sums_of_a_file_are_checked),
        cmocka_unit_test(modes_are_compared_row_by_row),
    };
    return cmocka_run_group_tests_name("memory", tests, NULL, NULL);
}
