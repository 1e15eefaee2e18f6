/*
 * What `rheolog rheometer` computes: the analysis of signals with known harmonics, loops, means and laws, also bad ones; the
 * response of every kind of memory and the moduli of a spring in closed form; and the fit that gets the parameters back.
 */
#include "support.h"

#include <math.h>

#include "cli/rheometry.h"

static const double PI = 3.14159265358979323846;

enum { SAMPLES = 2003, PERIODS = 7, MOST = 4 * SAMPLES };

static double signal_of[MOST];

/* ---- Harmonics ---- */

/* mean + a sin + b cos + c sin(3 .) + d cos(3 .) of the phase of sample i, which grows by 1 + growth in a window. */
static void make_signal(size_t count, const cli_oscillation *o, const double part[5], double growth)
{
    for (size_t i = 0; i < count; i++) {
        const double angle = 2 * PI * ((double)(o->periods * i) / (double)o->samples + o->first);
        signal_of[i] = part[0] +
                       (part[1] * sin(angle) + part[2] * cos(angle)) * (1 + growth * (double)i / (double)o->samples) +
                       part[3] * sin(3 * angle) + part[4] * cos(3 * angle);
    }
}

static void harmonics_of_a_known_signal_are_exact(void **unused)
{
    (void)unused;
    const cli_oscillation o = {.02, SAMPLES, PERIODS, .13};
    cli_harmonics h;
    make_signal(2 * SAMPLES, &o, (double[]){5, .3, .04, .003, -.004}, 0);
    assert_null(cli_harmonics_of(signal_of, 2 * SAMPLES, &o, 1e-9, &h));
    NEAR(h.storage, 15, 1e-11);
    NEAR(h.loss, 2, 1e-11);
    NEAR(h.first, hypot(.3, .04), 1e-13);
    NEAR(h.third, .005, 1e-13);
    NEAR(h.area, PI * .02 * .02 * 2, 1e-15); /* pi gamma0^2 G'' */
    /* The loop itself has this area, too. */
    double x[SAMPLES];
    const cli_oscillation one = {.02, SAMPLES, 1, 0};
    make_signal(SAMPLES, &one, (double[]){5, .3, .04, .003, -.004}, 0);
    for (size_t i = 0; i < SAMPLES; i++)
        x[i] = .02 * sin(2 * PI * (double)i / SAMPLES);
    NEAR(cli_loop_area(x, signal_of, SAMPLES), h.area, 1e-5 * h.area);
}

static void bad_oscillations_give_a_reason_and_no_number(void **unused)
{
    (void)unused;
    cli_oscillation o = {.02, SAMPLES, PERIODS, 0};
    cli_harmonics h;
    make_signal(MOST, &o, (double[]){0, 1, 1, 0, 0}, 0);
    const char *why = cli_harmonics_of(signal_of, 2 * SAMPLES - 1, &o, 1e-3, &h);
    assert_non_null(why);
    assert_true(says(why, "too few periods"));
    assert_true(isnan(h.storage) && isnan(h.loss) && isnan(h.third));
    o.samples = 7 * PERIODS;
    why = cli_harmonics_of(signal_of, 2 * SAMPLES, &o, 1e-3, &h);
    assert_true(why && says(why, "too few samples"));
    o.samples = SAMPLES;
    make_signal(MOST, &o, (double[]){0, 1, 1, 0, 0}, .01);
    why = cli_harmonics_of(signal_of, 2 * SAMPLES, &o, .005, &h);
    assert_true(why && says(why, "not steady"));
    NEAR(h.drift, .01 / 1.015, 1e-3);
    assert_null(cli_harmonics_of(signal_of, 2 * SAMPLES, &o, .02, &h));
    signal_of[2 * SAMPLES - 3] = NAN;
    why = cli_harmonics_of(signal_of, 2 * SAMPLES, &o, 1, &h);
    assert_true(why && says(why, "not finite"));
}

static void windows_have_every_phase_once(void **unused)
{
    (void)unused;
    assert_int_equal(cli_coprime(3808, 6), 3809);
    assert_int_equal(cli_coprime(4000, 21), 4000);
    assert_int_equal(cli_coprime(0, 1), 1);
}

/* ---- Steady values, curves, laws ---- */

static void a_mean_is_steady_or_not(void **unused)
{
    (void)unused;
    double mean;
    for (int i = 0; i < 400; i++) /* relaxes with the time 50 to 3 */
        signal_of[i] = 3 + exp(-i / 50.);
    const char *why = cli_steady_mean(signal_of, 400, 50, .001, 0, &mean);
    assert_null(why);
    NEAR(mean, 3, 2e-3);
    why = cli_steady_mean(signal_of, 100, 50, .001, 0, &mean);
    assert_true(why && says(why, "not steady"));
    assert_null(cli_steady_mean(signal_of, 100, 50, .001, 1000, &mean));
    why = cli_steady_mean(signal_of, 99, 50, .1, 0, &mean);
    assert_true(why && says(why, "too short"));
    why = cli_steady_mean(signal_of, 49, 50, .1, 0, &mean);
    assert_true(why && says(why, "too short") && isnan(mean));
}

static void loops_lines_and_decays_are_exact(void **unused)
{
    (void)unused;
    /* Up along y = 3, down along y = 1: 2 x 5. */
    const double x[] = {0, 1, 5, 5, 2, 0}, y[] = {3, 3, 3, 1, 1, 1};
    NEAR(cli_loop_area(x, y, 6), 10, 1e-14);
    NEAR(cli_loop_area(x, x, 6), 0, 1e-14);
    double slope, intercept;
    assert_true(cli_line_fit(x, (double[]){2, 5, 17, 17, 8, 2}, 6, &slope, &intercept));
    NEAR(slope, 3, 1e-13);
    NEAR(intercept, 2, 1e-13);
    assert_false(cli_line_fit((double[]){2, 2}, y, 2, &slope, &intercept));
    assert_true(isnan(slope));
    assert_false(cli_line_fit(x, y, 1, &slope, &intercept));
    double time[200];
    for (int i = 0; i < 200; i++) {
        time[i] = 1 + i * .05;
        signal_of[i] = 4 + 7 * exp(-(time[i] - 1) / 1.7);
    }
    NEAR(cli_decay_time(time, signal_of, 200, 4, exp(-1)), 1.7, 1e-3);
    assert_true(isnan(cli_decay_time(time, signal_of, 30, 4, exp(-1))));
}

static void flow_laws_are_found_again(void **unused)
{
    (void)unused;
    double rate[12], stress[12];
    static const cli_flow_law LAW[] = {{3, 2, .5, 0}, {0, 5, 1, 0}, {0, .2, 1.6, 0}, {40, 1e-3, 2, 0}, {0, 7, .3, 0}};
    for (size_t k = 0; k < sizeof LAW / sizeof *LAW; k++) {
        cli_flow_law law;
        for (int i = 0; i < 12; i++) {
            rate[i] = pow(10, -2 + i * .4);
            stress[i] = LAW[k].yield + LAW[k].consistency * pow(rate[i], LAW[k].exponent);
        }
        assert_true(cli_flow_fit(rate, stress, 12, &law));
        NEAR(law.exponent, LAW[k].exponent, 1e-4);
        NEAR(law.yield, LAW[k].yield, 1e-4 * (LAW[k].yield + LAW[k].consistency * .01));
        NEAR(law.consistency, LAW[k].consistency, 1e-3 * LAW[k].consistency);
        assert_true(law.error < 1e-5);
        assert_false(cli_flow_fit(rate, stress, 3, &law));
        stress[4] = 0;
        assert_false(cli_flow_fit(rate, stress, 12, &law));
    }
}

/* Stresses below a power law would need a negative yield stress. */
static void no_yield_stress_is_negative(void **unused)
{
    (void)unused;
    double rate[12], stress[12];
    cli_flow_law law;
    for (int i = 0; i < 12; i++) {
        rate[i] = 1 + i;
        stress[i] = 3 * rate[i] - 2;
    }
    assert_true(cli_flow_fit(rate, stress, 12, &law));
    assert_true(law.yield == 0 && law.consistency > 0 && law.error > 1e-3);
}

/* ---- Memory ---- */

static const rheo_history_kind KIND[] = {RHEO_HISTORY_WINDOW, RHEO_HISTORY_WINDOW_FAST, RHEO_HISTORY_FULL,
                                         RHEO_HISTORY_TEMPERED};

static rheo_world_def def_with(double q, uint32_t window)
{
    rheo_world_def def = rheo_default_world_def();
    def.history.order = q;
    def.history.window = window;
    return def;
}

/* |ratio| and phase to (i w)^(q-1) of Eq. 3 with windows of 150 and 4000, q = .5, and of 150 with q = .2 and .8. */
static void the_response_of_a_window_has_the_known_ratios(void **unused)
{
    (void)unused;
    static const struct {
        double q, omega, ratio, degrees;
        uint32_t window;
    } KNOWN[] = {{.5, .3, 1.246, 17.1, 150}, {.5, 1, .812, -10.3, 150},  {.5, 3, 1.145, .4, 150},
                 {.5, 10, .913, .9, 150},    {.5, .3, 1.081, 2.1, 4000}, {.5, 1, .968, 2.2, 4000},
                 {.5, 3, .984, 1.4, 4000},   {.5, 10, .991, .9, 4000},   {.2, .3, 1.34, 34, 150},
                 {.2, 1, .87, -38, 150},     {.8, .3, 1.10, 4.6, 150},   {.8, 1, .94, -.7, 150}};
    for (size_t k = 0; k < sizeof KNOWN / sizeof *KNOWN; k++) {
        const rheo_world_def def = def_with(KNOWN[k].q, KNOWN[k].window);
        cli_memory memory;
        double h[2];
        OK(cli_memory_make(&def, RHEO_HISTORY_WINDOW, KNOWN[k].q, &memory));
        cli_memory_response(&memory, KNOWN[k].omega, h);
        const bool coarse = KNOWN[k].q != .5;
        NEAR(hypot(h[0], h[1]) * pow(KNOWN[k].omega, 1 - KNOWN[k].q), KNOWN[k].ratio, coarse ? 6e-3 : 6e-4);
        NEAR(atan2(h[1], h[0]) * 180 / PI + 90 * (1 - KNOWN[k].q), KNOWN[k].degrees, coarse ? .51 : .06);
        cli_memory_release(&memory);
    }
}

static double velocity_of[1 << 21], derivative_of[1 << 21];

/* Drives a memory, and compares its derivative with H(w) times the velocity once the start is forgotten. */
static void assert_response(const cli_memory *memory, double omega)
{
    const size_t reach = cli_memory_reach(memory), count = reach + 200;
    const double angle = omega * memory->step;
    double h[2];
    assert_true(count < 1 << 21);
    for (size_t n = 0; n < count; n++)
        velocity_of[n] = cos(angle * (double)n);
    OK(cli_memory_apply(memory, velocity_of, count, derivative_of));
    cli_memory_response(memory, omega, h);
    for (size_t n = reach; n < count; n++) {
        const double at = angle * ((double)n - 1 - memory->lag);
        NEAR(derivative_of[n], h[0] * cos(at) - h[1] * sin(at), 1e-9 * hypot(h[0], h[1]));
    }
}

static void the_response_of_every_memory_is_that_of_its_derivative(void **unused)
{
    (void)unused;
    for (size_t k = 0; k < 4; k++)
        for (int rule = 0; rule < 2; rule++) {
            rheo_world_def def = def_with(rule ? .8 : .3, 60);
            def.history.weights = (rheo_weights)rule;
            def.history.lag = rule ? 9 : 0;
            cli_memory memory;
            OK(cli_memory_make(&def, KIND[k], def.history.order, &memory));
            assert_response(&memory, 2.17);
            assert_response(&memory, .41);
            cli_memory_release(&memory);
        }
    const rheo_curve_point curve[] = {{0, 1}, {.3, .4}, {1.5, .1}};
    rheo_world_def def = def_with(.5, 150);
    def.history.curve = curve;
    def.history.curve_count = 3;
    cli_memory memory;
    OK(cli_memory_make(&def, RHEO_HISTORY_WINDOW, .5, &memory));
    assert_response(&memory, 2.17);
    cli_memory_release(&memory);
}

/* A window and a lag in seconds are rounded to steps as a world rounds them. */
static void a_memory_in_seconds_is_that_of_the_world(void **unused)
{
    (void)unused;
    rheo_world_def def = def_with(.5, 150);
    def.history.window_seconds = 2.5;
    def.history.lag_seconds = .31;
    const rheo_real position[] = {0, 0, 0, 2, 0, 0};
    rheo_world *world = world_of(def, 2, position, NULL);
    cli_memory memory;
    OK(cli_memory_make(&def, RHEO_HISTORY_WINDOW, .5, &memory));
    assert_int_equal(memory.window, rheo_world_history_window(world));
    assert_int_equal(memory.lag, rheo_world_history_lag(world));
    cli_memory_release(&memory);
    rheo_world_destroy(world);
}

/* ---- The spring ---- */

/* The ideal springpot: D^q of the strain has the size w^q and is ahead by a quarter turn times q. */
static void ideal(double q, double omega, double h[2])
{
    h[0] = pow(omega, q - 1) * cos((q - 1) * PI / 2);
    h[1] = pow(omega, q - 1) * sin((q - 1) * PI / 2);
}

static void moduli_of_a_spring_have_the_closed_form(void **unused)
{
    (void)unused;
    static const double Q[] = {.2, .5, .8}, STORAGE[] = {.80830, .63662, .46494}, LOSS[] = {.12473, .21221, .12473},
                        THIRD[] = {.17961, .21641, .24780};
    for (int k = 0; k < 3; k++) {
        const double gamma = .07, omega = 2.3, by = 150 * 2 * gamma * pow(omega, Q[k]);
        const cli_spring_law law = {15, 150, 0, 2};
        double h[2];
        cli_harmonics found, summed;
        ideal(Q[k], omega, h);
        cli_spring_moduli(&law, gamma, omega, h, 0, &found);
        NEAR((found.storage - 15) / by, STORAGE[k], 6e-6);
        NEAR(found.loss / by, LOSS[k], 6e-6);
        NEAR(found.third / (by * gamma), THIRD[k], 6e-6);
        cli_spring_moduli_by_quadrature(&law, gamma, omega, h, .033, &summed);
        cli_spring_moduli(&law, gamma, omega, h, .033, &found);
        NEAR(summed.storage, found.storage, 1e-9 * found.storage);
        NEAR(summed.loss, found.loss, 1e-9 * found.storage);
        NEAR(summed.third, found.third, 1e-9 * found.storage);
    }
}

/* A sampled oscillation of the whole spring: memory, onset and stress, step by step. */
static void an_oscillating_spring_has_these_moduli(void **unused)
{
    (void)unused;
    for (size_t k = 0; k < 4; k++)
        for (int onset = 0; onset < 2; onset++) {
            const rheo_world_def def = def_with(.5, 150);
            const cli_spring_law law = {15, 150, onset ? .05 : 0, 2};
            const cli_oscillation o = {.05, SAMPLES, PERIODS, 0};
            const double omega = 2 * PI * PERIODS / (SAMPLES * def.step);
            double response[2];
            cli_memory memory;
            cli_harmonics found, exact;
            OK(cli_memory_make(&def, KIND[k], .5, &memory));
            const size_t count = (cli_memory_reach(&memory) / SAMPLES + 3) * SAMPLES;
            assert_true(count < 1 << 21);
            for (size_t n = 0; n < count; n++)
                velocity_of[n] = law.length * o.amplitude * omega * cos(omega * def.step * (double)n);
            OK(cli_memory_apply(&memory, velocity_of, count, derivative_of));
            for (size_t i = 0; i < 2 * SAMPLES; i++) {
                const size_t n = count - 2 * SAMPLES + i;
                const double d = fabs(derivative_of[n]);
                signal_of[i] = (law.k_min + law.k_hist * d * d / (d + law.onset)) * o.amplitude *
                               sin(omega * def.step * (double)n);
            }
            assert_null(cli_harmonics_of(signal_of, 2 * SAMPLES, &o, 1e-7, &found));
            cli_memory_response(&memory, omega, response);
            cli_spring_moduli(&law, o.amplitude, omega, response, def.step, &exact);
            NEAR(found.storage, exact.storage, 1e-6 * exact.storage);
            NEAR(found.loss, exact.loss, 1e-6 * exact.storage);
            NEAR(found.third, exact.third, 1e-6 * exact.first);
            cli_memory_release(&memory);
        }
}

/* ---- The fit ---- */

enum { AMPLITUDES = 3, OMEGAS = 3 };

/* Moduli of a known fluid, with relative errors of this size. */
static void sweep(const rheo_world_def *def, double length, double noise, cli_sweep_point point[AMPLITUDES * OMEGAS])
{
    static const double AMPLITUDE[] = {.02, .05, .12}, OMEGA[] = {.7, 2, 6};
    const cli_spring_law law = {def->springs.stiffness, def->history.stiffness, def->history.onset, length};
    cli_memory memory;
    OK(cli_memory_make(def, def->history.kind, def->history.order, &memory));
    uint32_t random = 1;
    for (int i = 0; i < AMPLITUDES * OMEGAS; i++) {
        cli_sweep_point *p = &point[i];
        double response[2];
        cli_harmonics h;
        p->amplitude = AMPLITUDE[i % AMPLITUDES];
        p->omega = OMEGA[i / AMPLITUDES];
        cli_memory_response(&memory, p->omega, response);
        cli_spring_moduli(&law, p->amplitude, p->omega, response, (memory.lag + 1) * memory.step, &h);
        random = random * 1664525u + 1013904223u;
        p->storage = h.storage * (1 + noise * (random / 2147483648. - 1));
        random = random * 1664525u + 1013904223u;
        p->loss = h.loss * (1 + noise * (random / 2147483648. - 1));
    }
    cli_memory_release(&memory);
}

static void the_fit_finds_the_parameters_again(void **unused)
{
    (void)unused;
    static const double Q[] = {.2, .5, .8};
    for (int k = 0; k < 3; k++)
        for (size_t kind = 0; kind < 4; kind++)
            for (int noisy = 0; noisy < 2; noisy++) {
                rheo_world_def def = def_with(Q[k], 150);
                cli_sweep_point point[AMPLITUDES * OMEGAS];
                cli_model_fit fit;
                def.history.kind = KIND[kind];
                if (!noisy && kind > 0)
                    continue; /* the quadrature of the onset takes long */
                def.history.onset = noisy ? 0 : .05;
                sweep(&def, 1.9, noisy ? 2e-3 : 0, point);
                def.history.order = .1; /* not read */
                assert_null(cli_fit_model(&def, 1.9, point, AMPLITUDES * OMEGAS, NULL, &fit));
                NEAR(fit.order / Q[k], 1, noisy ? .03 : 1e-5);
                NEAR(fit.k_hist / def.history.stiffness, 1, noisy ? .03 : 1e-5);
                NEAR(fit.k_min / def.springs.stiffness, 1, noisy ? .03 : 1e-5);
                NEAR(fit.order_by_omega / Q[k], 1, noisy ? .1 : 1e-4);
                NEAR(fit.order_by_loss / Q[k], 1, noisy ? .1 : 1e-4);
                if (noisy)
                    NEAR(fit.amplitude_slope, 1, .03); /* without onset */
            }
}

static void a_sweep_that_tells_too_little_is_refused(void **unused)
{
    (void)unused;
    const rheo_world_def def = def_with(.5, 150);
    cli_sweep_point point[AMPLITUDES * OMEGAS], few[AMPLITUDES];
    cli_model_fit fit;
    sweep(&def, 2, 0, point);
    const char *why = cli_fit_model(&def, 2, point, AMPLITUDES, NULL, &fit); /* one frequency */
    assert_true(why && says(why, "two frequencies") && isnan(fit.order));
    for (int i = 0; i < OMEGAS; i++)
        few[i] = point[i * AMPLITUDES];
    why = cli_fit_model(&def, 2, few, OMEGAS, NULL, &fit);
    assert_true(why && says(why, "two amplitudes"));
    for (int i = 0; i < AMPLITUDES * OMEGAS; i++)
        point[i].storage = 15, point[i].loss = 0;
    why = cli_fit_model(&def, 2, point, AMPLITUDES * OMEGAS, NULL, &fit);
    assert_true(why && says(why, "no history"));
    point[2].storage = NAN;
    why = cli_fit_model(&def, 2, point, AMPLITUDES * OMEGAS, NULL, &fit);
    assert_true(why && says(why, "not known"));
    assert_non_null(cli_fit_model(&def, 2, point, 0, NULL, &fit));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(harmonics_of_a_known_signal_are_exact),
        cmocka_unit_test(bad_oscillations_give_a_reason_and_no_number),
        cmocka_unit_test(windows_have_every_phase_once),
        cmocka_unit_test(a_mean_is_steady_or_not),
        cmocka_unit_test(loops_lines_and_decays_are_exact),
        cmocka_unit_test(flow_laws_are_found_again),
        cmocka_unit_test(no_yield_stress_is_negative),
        cmocka_unit_test(the_response_of_a_window_has_the_known_ratios),
        cmocka_unit_test(the_response_of_every_memory_is_that_of_its_derivative),
        cmocka_unit_test(a_memory_in_seconds_is_that_of_the_world),
        cmocka_unit_test(moduli_of_a_spring_have_the_closed_form),
        cmocka_unit_test(an_oscillating_spring_has_these_moduli),
        cmocka_unit_test(the_fit_finds_the_parameters_again),
        cmocka_unit_test(a_sweep_that_tells_too_little_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
