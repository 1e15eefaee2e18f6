/*
 * rheolog/history.h: weights and fractional derivatives against values computed without this library.
 *
 * Numbers with few digits are compared to half a unit of their last digit.
 */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rheolog/history.h"

#define STEP 0.033
#define PI 3.14159265358979323846

/* Orders q of the table columns. */
static const double orders[3] = {0.2, 0.5, 0.8};

/* Slightly more than half a unit, for numbers that end close to a half. */
#define HALF_UNIT(digit) (0.5001 * (digit))

#define DONE(call) assert_int_equal((call), RHEO_OK)

#define CHECK_NEAR(got, want, tolerance)                                                       \
    do {                                                                                       \
        const double got_ = (got), want_ = (want), tolerance_ = (tolerance);                   \
        if (!(fabs(got_ - want_) <= tolerance_))                                               \
            fail_msg("%s is %.17g instead of %.17g (+- %.2g)", #got, got_, want_, tolerance_); \
    } while (0)

static double *derivative(const double *velocity, size_t count, double q, double step, size_t window,
                          rheo_weights kind)
{
    double *result = malloc(count * sizeof(double));
    assert_non_null(result);
    assert_int_equal(rheo_fractional_derivative(velocity, count, q, step, window, kind, result), RHEO_OK);
    return result;
}

/* --- weights --- */

static void weights_of_the_table(void **state)
{
    (void)state;
    static const struct {
        size_t lag;
        double weight[3];
    } rows[] = {
        {1, {1.482202253, .828427125, .297396710}},  {2, {1.260269549, .539298173, .142399399}},
        {5, {1.044525624, .336258682, .066549515}},  {10, {.908760720, .237319491, .038083244}},
        {50, {.658524543, .106068669, .010496780}},  {150, {.528621261, .061237414, .004358535}},
        {250, {.477281531, .047434212, .002896410}}, {500, {.415497606, .033541028, .001663548}},
    };
    double weights[501];
    for (int j = 0; j < 3; j++) {
        rheo_history_weights(orders[j], 501, weights);
        assert_true(weights[0] == 1.0);
        for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
            CHECK_NEAR(weights[rows[i].lag], rows[i].weight[j], HALF_UNIT(1e-9));
    }
    static const double first_50[3] = {.329701308, .053211125, .005276383};
    static const double first_500[3] = {.207776503, .016776104, .000832218};
    for (int j = 0; j < 3; j++) {
        CHECK_NEAR(rheo_history_first_weight(orders[j], 50), first_50[j], HALF_UNIT(1e-9));
        CHECK_NEAR(rheo_history_first_weight(orders[j], 500), first_500[j], HALF_UNIT(1e-9));
    }
}

/* c_m, a_{0,m} and b_m from their definitions with 60 digits; q is the nearest double. */
static const struct {
    double q;
    size_t m;
    double interior, first, l1;
} precise[] = {
    {0.01, 1, 1.9723699817481436056, 0.98999999999999999979, 0.98618499087407180278},
    {0.01, 2, 1.9569260740532492047, 0.98013815009125928156, 0.98103702164244033583},
    {0.01, 3, 1.9487611785428175359, 0.97547574910646634495, 0.97770880545692455188},
    {0.01, 5, 1.9387120588295884214, 0.9700048992737098436, 0.97327960903416561818},
    {0.01, 6, 1.9351604052918317077, 0.96811926242211100214, 0.9716512072089513998},
    {0.01, 10, 1.9252712860318976172, 0.96295684550242901852, 0.96699662981745403188},
    {0.01, 50, 1.8945179183526402836, 0.94732211231667063555, 0.95192416669651936132},
    {0.01, 1000, 1.8386042995476443145, 0.91930521411462987016, 0.92391713973471942659},
    {0.01, 1000000, 1.7158853685724759027, 0.85794268714604689897, 0.86225394974525150965},
    {0.2, 1, 1.4822022531844965297, 0.7999999999999999889, 0.74110112659224826487},
    {0.2, 2, 1.2602695494730829912, 0.6517797746815503277, 0.66712355868844375204},
    {0.2, 3, 1.1585866735835289004, 0.59233263084766608272, 0.62320844774010410113},
    {0.2, 5, 1.0445256239752608741, 0.5292579132400561356, 0.56906439424099779539},
    {0.2, 6, 1.006873797012249099, 0.50904819889859128689, 0.55031368117389115371},
    {0.2, 10, 0.90876071986425868213, 0.45741296578174781687, 0.49990968272036878742},
    {0.2, 50, 0.65852454342412933183, 0.32970130774476092728, 0.36511814338769453358},
    {0.2, 1000, 0.36171165337161412139, 0.18086788374226983843, 0.20093082746293280217},
    {0.2, 1000000, 0.090857857605149629318, 0.045428931831170068164, 0.050476582510758714733},
    {0.5, 1, 0.8284271247461900976, 0.5, 0.4142135623730950488},
    {0.5, 2, 0.53929817321425168538, 0.2928932188134524756, 0.31783724519578224473},
    {0.5, 3, 0.43612227933292633644, 0.23035091339287415731, 0.26794919243112270647},
    {0.5, 5, 0.33625868170117162509, 0.17376207875073606257, 0.21342176528338840179},
    {0.5, 6, 0.30672215155294543719, 0.15763604497464704016, 0.1962615682814124923},
    {0.5, 10, 0.23731949054181170029, 0.12063988856877567801, 0.15434713018702051712},
    {0.5, 50, 0.10606866913782549713, 0.05321112452445066559, 0.070360616677374753991},
    {0.5, 1000, 0.023717083933580930537, 0.011860518390698650058, 0.015807437428955823117},
    {0.5, 1000000, 0.000750000000000046875, 0.00037500006250002343751, 0.00049999987500006249996},
    {0.8, 1, 0.29739670999406994288, 0.19999999999999995559, 0.14869835499703497144},
    {0.8, 2, 0.14239939885841190981, 0.081041316002371971836, 0.09703258461848229375},
    {0.8, 3, 0.1010427153925430643, 0.055081018686138810216, 0.07377697115737691295},
    {0.8, 5, 0.066549515110961697896, 0.035058929538960662939, 0.051239419644040653407},
    {0.8, 6, 0.057431465204872614914, 0.029996718000847746855, 0.044804080489296554564},
    {0.8, 10, 0.038083244239925367252, 0.019550071580438391648, 0.03050107374106450635},
    {0.8, 50, 0.01049677980258879505, 0.0052763827922765347246, 0.0086777495409337903879},
    {0.8, 1000, 0.00095545732398329864492, 0.00047785605631832981769, 0.0007958960463283307186},
    {0.8, 1000000, 3.8037436619071254946e-6, 1.901872338119384335e-6, 3.1697851170084311011e-6},
    {0.99, 1, 0.013911100113437630064, 0.010000000000000008882, 0.0069555500567188150319},
    {0.99, 2, 0.0053178755866855414356, 0.003114005443848382062, 0.0040911418811347854892},
    {0.99, 3, 0.0034688676464326316365, 0.0019281831571089740067, 0.0029127878521755506537},
    {0.99, 5, 0.0020664733667039519093, 0.0011018000034872688546, 0.0018544865459816580973},
    {0.99, 6, 0.0017216695721545615845, 0.00090835804822479164009, 0.0015705860431518360102},
    {0.99, 10, 0.0010352294972564586882, 0.00053471890231355056743, 0.00097576731979549624803},
    {0.99, 50, 0.00021007268833325256468, 0.00010572962101596970199, 0.00020594702148214847445},
    {0.99, 1000, 0.000010822346759659029319, 5.4129590672829441717e-6, 0.000010709892547520929504},
    {0.99, 1000000, 1.1596351577120431446e-8, 5.7981777019582259482e-9, 1.1481530531612182672e-8},
};

/* One rounding of the constant above and 7e-16 of the function. */
#define WEIGHT_ERROR 8e-16

static void weights_to_the_last_digits(void **state)
{
    (void)state;
    const size_t count = 1000001;
    double *weights = malloc(count * sizeof(double));
    assert_non_null(weights);
    double filled = -1.0;
    for (size_t i = 0; i < sizeof precise / sizeof precise[0]; i++) {
        const double q = precise[i].q;
        if (q != filled)
            rheo_history_weights(q, count, weights);
        filled = q;
        CHECK_NEAR(weights[precise[i].m], precise[i].interior, WEIGHT_ERROR * precise[i].interior);
        if (q == 0.5)
            CHECK_NEAR(weights[1000000], 7.500000e-4, HALF_UNIT(1e-10));
        CHECK_NEAR(rheo_history_first_weight(q, precise[i].m), precise[i].first, WEIGHT_ERROR * precise[i].first);
    }
    filled = -1.0;
    for (size_t i = 0; i < sizeof precise / sizeof precise[0]; i++) {
        const double q = precise[i].q;
        if (q != filled)
            rheo_history_weights_l1(q, count, weights);
        filled = q;
        assert_true(weights[0] == 1.0);
        CHECK_NEAR(weights[precise[i].m], precise[i].l1, WEIGHT_ERROR * precise[i].l1);
    }
    free(weights);
}

/* The sum of the weights telescopes for any number of lags, so it tests every weight a little. */
static void sums_of_weights(void **state)
{
    (void)state;
    const size_t count = 2000;
    double *c = malloc(count * sizeof(double)), *b = malloc(count * sizeof(double));
    assert_non_null(c);
    assert_non_null(b);
    for (double q = 0.05; q < 1.0; q += 0.05) {
        rheo_history_weights(q, count, c);
        rheo_history_weights_l1(q, count, b);
        double sum_c = 0.0, sum_b = 0.0;
        for (size_t m = 0; m < count; m++) {
            const double n = (double)m;
            assert_true(c[m] > 0.0 && b[m] > 0.0);
            assert_true(m < 2 || (c[m] < c[m - 1] && b[m] < b[m - 1]));
            sum_c += c[m];
            sum_b += b[m];
            const double whole_c = pow(n + 1.0, 2.0 - q) - pow(n, 2.0 - q);
            const double whole_b = pow(n + 1.0, 1.0 - q);
            CHECK_NEAR(sum_c, whole_c, 1e-12 * pow(n + 1.0, 2.0 - q));
            CHECK_NEAR(sum_b, whole_b, 1e-12 * whole_b);
            /* D^q t = t^(1-q) / Gamma(2-q) exactly, from lags 0..m-1 and the first sample */
            if (m > 0) {
                const double whole = (2.0 - q) * pow(n, 1.0 - q);
                CHECK_NEAR(sum_c - c[m] + rheo_history_first_weight(q, m), whole, 1e-12 * whole);
            }
        }
    }
    free(c);
    free(b);
}

static void few_weights(void **state)
{
    (void)state;
    double weights[3] = {-1.0, -1.0, -1.0};
    rheo_history_weights(0.5, 0, weights);
    rheo_history_weights_l1(0.5, 0, weights);
    rheo_history_weights(0.5, 0, NULL);
    rheo_history_weights_l1(0.5, 0, NULL);
    assert_true(weights[0] == -1.0);
    rheo_history_weights(0.5, 2, weights);
    assert_true(weights[0] == 1.0 && weights[1] > 0.0 && weights[2] == -1.0);
    weights[1] = -1.0;
    rheo_history_weights_l1(0.5, 2, weights);
    assert_true(weights[0] == 1.0 && weights[1] > 0.0 && weights[2] == -1.0);
    assert_true(rheo_history_first_weight(0.25, 0) == 1.0);
    assert_true(rheo_history_first_weight(0.25, 1) == 0.75);
}

static void orders_out_of_range(void **state)
{
    (void)state;
    const double bad[] = {0.0, -0.0, 1.0, -0.5, 1.5, (double)NAN, (double)INFINITY, -(double)INFINITY};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        double weights[5] = {0.0}, l1[5] = {0.0};
        rheo_history_weights(bad[i], 5, weights);
        rheo_history_weights_l1(bad[i], 5, l1);
        for (int m = 0; m < 5; m++)
            assert_true(weights[m] != weights[m] && l1[m] != l1[m]);
        for (size_t n = 0; n < 5; n++) {
            const double first = rheo_history_first_weight(bad[i], n);
            assert_true(first != first);
        }
        const double scale = rheo_history_scale(bad[i], STEP, RHEO_WEIGHTS_PAPER);
        assert_true(scale != scale);
    }
}

static void scale(void **state)
{
    (void)state;
    /* step^(1-q) / Gamma(3-q) and / Gamma(2-q) for a step of 0.033 */
    static const struct {
        double q, paper, l1;
    } rows[] = {
        {0.01, 0.017230497582950359161, 0.034288690190071214727},
        {0.2, 0.038941258290021845754, 0.070094264922039321925},
        {0.5, 0.13665350339251845763, 0.20498025508877768645},
        {0.8, 0.45877425444151282861, 0.55052910532981537396},
        {0.99, 0.96235439702448533974, 0.97197794099473020168},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const double paper = rheo_history_scale(rows[i].q, STEP, RHEO_WEIGHTS_PAPER);
        const double l1 = rheo_history_scale(rows[i].q, STEP, RHEO_WEIGHTS_L1);
        CHECK_NEAR(paper, rows[i].paper, 6e-16 * rows[i].paper);
        CHECK_NEAR(l1, rows[i].l1, 6e-16 * rows[i].l1);
    }
    const double bad_steps[] = {0.0, -1.0, (double)NAN, (double)INFINITY};
    for (size_t i = 0; i < sizeof bad_steps / sizeof bad_steps[0]; i++) {
        const double paper = rheo_history_scale(0.5, bad_steps[i], RHEO_WEIGHTS_PAPER);
        const double l1 = rheo_history_scale(0.5, bad_steps[i], RHEO_WEIGHTS_L1);
        assert_true(paper != paper && l1 != l1);
    }
    const double neither = rheo_history_scale(0.5, STEP, (rheo_weights)2);
    assert_true(neither != neither);
}

/* --- derivatives with known values --- */

static double square(double t)
{
    return 2.0 * t;
}
static double cube(double t)
{
    return 3.0 * t * t;
}
static double wave(double t)
{
    return 2.0 * PI * cos(2.0 * PI * t);
}
static double decay(double t)
{
    return -exp(-t);
}

/* D^q x at t = 1 after `steps` steps, from sampled velocities. */
static double at_one(double (*velocity)(double), size_t steps, double q)
{
    double v[257];
    assert_true(steps < 257);
    for (size_t n = 0; n <= steps; n++)
        v[n] = velocity((double)n / (double)steps);
    double *result = derivative(v, steps + 1, q, 1.0 / (double)steps, 0, RHEO_WEIGHTS_PAPER);
    const double last = result[steps];
    free(result);
    return last;
}

static void quadratic_is_exact(void **state)
{
    (void)state;
    static const double exact[3] = {1.192968082256, 1.504505556127, 1.815207368431};
    static const size_t steps[] = {1, 2, 7, 30, 64, 256};
    for (int j = 0; j < 3; j++)
        for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
            const double d = at_one(square, steps[i], orders[j]);
            CHECK_NEAR(d, exact[j], HALF_UNIT(1e-12));
            CHECK_NEAR(d, 2.0 / tgamma(3.0 - orders[j]), 2e-15);
        }
}

/* Unit of the fourth digit. */
static double fourth_digit(double x)
{
    return pow(10.0, floor(log10(fabs(x))) - 3.0);
}

static void smooth_motions_have_the_known_errors(void **state)
{
    (void)state;
    static const struct {
        double (*velocity)(double);
        double exact[3], error_64[3], error_256[3];
    } rows[] = {
        {cube,
         {1.278180088132, 1.805406667353, 2.475282775133},
         {1.308e-4, 1.342e-4, 1.012e-4},
         {8.187e-6, 8.499e-6, 6.808e-6}},
        {wave,
         {.420394683944, 1.730813259632, 4.112491665247},
         {-3.278e-4, -1.245e-3, -1.992e-3},
         {-2.090e-5, -8.235e-5, -1.444e-4}},
        {decay,
         {-.644084400234, -.607157705841, -.490773772623},
         {-1.309e-5, -1.214e-5, -8.044e-6},
         {-8.187e-7, -7.653e-7, -5.320e-7}},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        for (int j = 0; j < 3; j++) {
            const double error_64 = at_one(rows[i].velocity, 64, orders[j]) - rows[i].exact[j];
            const double error_256 = at_one(rows[i].velocity, 256, orders[j]) - rows[i].exact[j];
            CHECK_NEAR(error_64, rows[i].error_64[j], HALF_UNIT(fourth_digit(rows[i].error_64[j])));
            CHECK_NEAR(error_256, rows[i].error_256[j], HALF_UNIT(fourth_digit(rows[i].error_256[j])));
        }
}

/* t^3 from velocities that are backward differences, as in a particle system. */
static void backward_differences_need_l1(void **state)
{
    (void)state;
    double v[257];
    v[0] = 0.0;
    for (size_t n = 1; n < 257; n++) {
        const double now = (double)n / 256.0, before = (double)(n - 1) / 256.0;
        v[n] = (now * now * now - before * before * before) * 256.0;
    }
    const double exact = 1.80540666735282; /* 6 / Gamma(3.5) */
    double *l1 = derivative(v, 257, 0.5, 1.0 / 256.0, 0, RHEO_WEIGHTS_L1);
    double *paper = derivative(v, 257, 0.5, 1.0 / 256.0, 0, RHEO_WEIGHTS_PAPER);
    CHECK_NEAR(l1[256] - exact, -3.3484157e-4, HALF_UNIT(1e-11));
    CHECK_NEAR(paper[256] - exact, -8.7897622e-3, HALF_UNIT(1e-10));
    free(l1);
    free(paper);
}

static void plateau_of_a_window(void **state)
{
    (void)state;
    static const struct {
        size_t window;
        double level[3], digit[3];
    } rows[] = {
        {50, {1.615527864, 1.456652452, 1.206250272}, {1e-9, 1e-9, 1e-9}},
        {150, {3.870005282, 2.514664666, 1.500677794}, {1e-9, 1e-9, 1e-9}},
        {250, {5.817396, 3.244261272, 1.661659}, {1e-6, 1e-9, 1e-6}},
        {500, {10.120587862, 4.585788830, 1.908363445}, {1e-9, 1e-9, 1e-9}},
    };
    double v[700];
    for (size_t n = 0; n < 700; n++)
        v[n] = 1.0;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        for (int j = 0; j < 3; j++) {
            const size_t window = rows[i].window;
            double *d = derivative(v, 700, orders[j], STEP, window, RHEO_WEIGHTS_PAPER);
            /*
             * The window is full from n = window on; one step earlier the whole history still counts, including the
             * first weight.
             */
            for (size_t n = window; n < 700; n++)
                CHECK_NEAR(d[n], rows[i].level[j], HALF_UNIT(rows[i].digit[j]));
            const double t = (double)(window - 1) * STEP;
            CHECK_NEAR(d[window - 1], pow(t, 1.0 - orders[j]) / tgamma(2.0 - orders[j]), 1e-13);
            free(d);
        }
}

#define SIGNAL 1500

/* A smooth pulse of a third of a second at t = 1 s. */
static void pulse(double *v)
{
    for (size_t n = 0; n < SIGNAL; n++) {
        const double u = ((double)n * STEP - 1.0) / 0.33;
        const double s = u > 0.0 && u < 1.0 ? sin(PI * u) : 0.0;
        v[n] = 5.0 * s * s;
    }
}

/* Constant speed for 151 steps. */
static void stroke(double *v)
{
    for (size_t n = 0; n < SIGNAL; n++)
        v[n] = n >= 31 && n <= 181 ? 1.0 : 0.0;
}

static void a_kind_has_the_modes_of_its_lags(void **state)
{
    (void)state;
    const double tau = rheo_history_tempering(.5, 150);
    rheo_history_modes modes, fitted;
    for (int kind = RHEO_WEIGHTS_PAPER; kind <= RHEO_WEIGHTS_L1; kind++) {
        const rheo_weights weights = (rheo_weights)kind;
        DONE(rheo_history_fit_kind(RHEO_HISTORY_WINDOW_FAST, .5, 150, weights, &modes));
        DONE(rheo_history_fit(.5, 150, weights, &fitted));
        assert_memory_equal(&modes, &fitted, sizeof modes);
        DONE(rheo_history_fit_kind(RHEO_HISTORY_FULL, .5, 0, weights, &modes));
        DONE(rheo_history_fit(.5, 16384, weights, &fitted));
        assert_memory_equal(&modes, &fitted, sizeof modes);
        DONE(rheo_history_fit_kind(RHEO_HISTORY_TEMPERED, .5, 150, weights, &modes));
        DONE(rheo_history_fit(.5, (uint32_t)(12 * tau) + 1, weights, &fitted));
        rheo_history_temper(&fitted, tau);
        assert_memory_equal(&modes, &fitted, sizeof modes);
    }
    const struct {
        rheo_history_kind kind;
        double q;
        uint32_t window;
    } bad[] = {{RHEO_HISTORY_WINDOW, .5, 150},           {(rheo_history_kind)4, .5, 150},
               {RHEO_HISTORY_WINDOW_FAST, .5, 0},        {RHEO_HISTORY_TEMPERED, .5, 0},
               {RHEO_HISTORY_TEMPERED, 1, 150},          {RHEO_HISTORY_TEMPERED, .5, (1u << 24) + 1},
               {RHEO_HISTORY_WINDOW_FAST, .5, 1u << 31}, {RHEO_HISTORY_FULL, 0, 150}};
    fitted = modes;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(rheo_history_fit_kind(bad[i].kind, bad[i].q, bad[i].window, RHEO_WEIGHTS_PAPER, &modes),
                         RHEO_ERROR_ARGUMENT);
    assert_memory_equal(&modes, &fitted, sizeof modes);
    /* The longest tempered window fits for every order. */
    for (double q = .001; q < 1; q += .0499)
        DONE(rheo_history_fit_kind(RHEO_HISTORY_TEMPERED, q, 1u << 24, RHEO_WEIGHTS_PAPER, &modes));
}

static void signals_are_those_of_the_paper(void **state)
{
    (void)state;
    double v[SIGNAL], own[SIGNAL];
    for (int which = 0; which < 2; which++) {
        (which == RHEO_SIGNAL_IMPACT ? pulse : stroke)(own);
        DONE(rheo_signal_velocities((rheo_signal)which, STEP, SIGNAL, v));
        for (size_t n = 0; n < SIGNAL; n++)
            CHECK_NEAR(v[n], own[n], 1e-14);
    }
    /* Another step samples the same motion; both ends are outside. */
    DONE(rheo_signal_velocities(RHEO_SIGNAL_STEADY, .5, 13, v));
    for (size_t n = 0; n < 13; n++)
        assert_true(v[n] == (n > 2 && n < 12));
    DONE(rheo_signal_velocities(RHEO_SIGNAL_IMPACT, 1.165, 2, v));
    assert_true(v[0] == 0);
    CHECK_NEAR(v[1], 5, 1e-14);
    const double bad[] = {0, -1, NAN, INFINITY};
    for (int i = 0; i < 4; i++)
        assert_int_equal(rheo_signal_velocities(RHEO_SIGNAL_IMPACT, bad[i], 1, v), RHEO_ERROR_ARGUMENT);
    assert_int_equal(rheo_signal_velocities((rheo_signal)2, 1, 1, v), RHEO_ERROR_ARGUMENT);
    assert_int_equal(rheo_signal_velocities(RHEO_SIGNAL_IMPACT, 1, 1, NULL), RHEO_ERROR_ARGUMENT);
    assert_true(v[0] == 0);
}

static void memory_of_a_pulse(void **state)
{
    (void)state;
    static const double peak[3] = {1.109634582, 1.875784809, 3.321230936};
    static const size_t peak_at[3] = {38, 37, 36};
    static const double at_100[3] = {.608940399, .318643149, .098013346};
    static const double at_600[3] = {.394774894, .107823892, .017310100};
    double v[SIGNAL];
    pulse(v);
    for (int j = 0; j < 3; j++) {
        double *d = derivative(v, SIGNAL, orders[j], STEP, 0, RHEO_WEIGHTS_PAPER);
        size_t largest = 0;
        for (size_t n = 0; n < SIGNAL; n++) {
            if (d[n] > d[largest])
                largest = n;
            assert_true(n <= 30 ? d[n] == 0.0 : d[n] > 0.0);
        }
        assert_int_equal(largest, peak_at[j]);
        CHECK_NEAR(d[largest], peak[j], HALF_UNIT(1e-9));
        CHECK_NEAR(d[100], at_100[j], HALF_UNIT(1e-9));
        CHECK_NEAR(d[600], at_600[j], HALF_UNIT(1e-9));
        free(d);
    }
}

static void memory_of_a_stroke(void **state)
{
    (void)state;
    static const double at_100[3] = {2.085785913, 1.708848238, 1.285809546};
    static const double at_300[3] = {2.971418971, 1.133682319, .255515452};
    static const double level_50[3] = {1.615527864, 1.456652452, 1.206250272};
    static const double level_150[3] = {3.870005282, 2.514664666, 1.500677794};
    double v[SIGNAL];
    stroke(v);
    for (int j = 0; j < 3; j++) {
        double *d = derivative(v, SIGNAL, orders[j], STEP, 0, RHEO_WEIGHTS_PAPER);
        CHECK_NEAR(d[100], at_100[j], HALF_UNIT(1e-9));
        CHECK_NEAR(d[300], at_300[j], HALF_UNIT(1e-9));
        static const size_t windows[4] = {50, 150, 250, 500};
        for (int k = 0; k < 4; k++) {
            const size_t window = windows[k];
            double *w = derivative(v, SIGNAL, orders[j], STEP, window, RHEO_WEIGHTS_PAPER);
            for (size_t n = 0; n < SIGNAL; n++) {
                if (n <= 31 + window) /* no sample has left the window yet */
                    assert_true(w[n] == d[n]);
                else if (n <= 181 + window)
                    assert_true(w[n] > 0.0 && w[n] < d[n]);
                else /* the whole stroke has left the window */
                    assert_true(w[n] == 0.0);
            }
            if (window == 50)
                for (size_t n = 81; n <= 181; n++)
                    CHECK_NEAR(w[n], level_50[j], HALF_UNIT(1e-9));
            if (window == 150)
                CHECK_NEAR(w[181], level_150[j], HALF_UNIT(1e-9));
            free(w);
        }
        free(d);
    }
}

/* --- conventions --- */

/* The definitions in long double, accurate to 1e-13 for the few samples used here. */
static long double interior_by_formula(long double q, size_t m)
{
    const long double e = 2.0L - q, x = (long double)m;
    if (m == 0)
        return 1.0L;
    return (m > 1 ? powl(x - 1.0L, e) : 0.0L) - 2.0L * powl(x, e) + powl(x + 1.0L, e);
}

static long double first_by_formula(long double q, size_t n)
{
    const long double x = (long double)n;
    if (n == 0)
        return 1.0L;
    return (n > 1 ? powl(x - 1.0L, 2.0L - q) : 0.0L) - powl(x, 1.0L - q) * (x + q - 2.0L);
}

static long double by_formula(const double *v, size_t n, double q, size_t window, rheo_weights kind)
{
    long double sum = 0.0L;
    const long double p = (long double)q, h = (long double)STEP;
    for (size_t lag = 0; lag <= n && (window == 0 || lag <= window); lag++) {
        const long double x = (long double)lag;
        long double weight;
        if (kind == RHEO_WEIGHTS_PAPER)
            weight = lag == n && (window == 0 || n < window) ? first_by_formula(p, n) : interior_by_formula(p, lag);
        else
            weight = lag == n ? 0.0L : powl(x + 1.0L, 1.0L - p) - (lag ? powl(x, 1.0L - p) : 0.0L);
        sum += weight * (long double)v[n - lag];
    }
    return sum * powl(h, 1.0L - p) / tgammal((kind == RHEO_WEIGHTS_PAPER ? 3.0L : 2.0L) - p);
}

static void windows_and_first_samples(void **state)
{
    (void)state;
    /* v_0 is large, so that a wrong weight of it shows. */
    double v[40];
    for (size_t n = 0; n < 40; n++)
        v[n] = n == 0 ? 7.0 : sin(0.7 * (double)n) + 0.3 * (double)(n % 3);
    static const size_t windows[] = {0, 1, 2, 7, 38, 39, 40, 41, SIZE_MAX};
    static const size_t counts[] = {1, 2, 3, 8, 9, 40};
    for (int kind = 0; kind < 2; kind++)
        for (size_t w = 0; w < sizeof windows / sizeof windows[0]; w++)
            for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++)
                for (int j = 0; j < 3; j++) {
                    double *d = derivative(v, counts[c], orders[j], STEP, windows[w], (rheo_weights)kind);
                    for (size_t n = 0; n < counts[c]; n++) {
                        const long double want = by_formula(v, n, orders[j], windows[w], (rheo_weights)kind);
                        CHECK_NEAR(d[n], (double)want, 1e-13);
                    }
                    if (kind == RHEO_WEIGHTS_L1)
                        assert_true(d[0] == 0.0);
                    free(d);
                }
}

static void sum_is_compensated(void **state)
{
    (void)state;
    /*
     * Velocities whose products at lags 2 and 1 cancel exactly. They are so large that a plain sum from the oldest
     * sample on would lose that sample.
     */
    double c[3];
    rheo_history_weights(0.5, 3, c);
    double v[4] = {1.0, 0.0, 0.0, 0.0};
    int found = 0;
    for (double x = 0x1p60; !found && x < 0x1p61; x += 0x1p20) {
        v[2] = x;
        v[1] = -(c[1] * x / c[2]);
        found = c[2] * v[1] == -(c[1] * v[2]);
    }
    assert_true(found);
    const double first = rheo_history_first_weight(0.5, 3);
    const volatile double older = first + c[2] * v[1]; /* volatile forces rounding */
    assert_true(older + c[1] * v[2] != first);         /* a plain sum fails */
    double *d = derivative(v, 4, 0.5, STEP, 0, RHEO_WEIGHTS_PAPER);
    assert_true(d[3] == rheo_history_scale(0.5, STEP, RHEO_WEIGHTS_PAPER) * first);
    free(d);
}

static void bad_arguments(void **state)
{
    (void)state;
    const double v[4] = {1.0, 1.0, 1.0, 1.0};
    double d[4] = {-9.0, -9.0, -9.0, -9.0};
    const double nan = (double)NAN, inf = (double)INFINITY;
#define REFUSED(...) assert_int_equal(rheo_fractional_derivative(__VA_ARGS__), RHEO_ERROR_ARGUMENT)
    REFUSED(NULL, 4, 0.5, STEP, 0, RHEO_WEIGHTS_PAPER, d);
    REFUSED(v, 4, 0.5, STEP, 0, RHEO_WEIGHTS_PAPER, NULL);
    REFUSED(v, 4, 0.0, STEP, 0, RHEO_WEIGHTS_PAPER, d);
    REFUSED(v, 4, 1.0, STEP, 0, RHEO_WEIGHTS_PAPER, d);
    REFUSED(v, 4, -0.5, STEP, 0, RHEO_WEIGHTS_L1, d);
    REFUSED(v, 4, nan, STEP, 0, RHEO_WEIGHTS_PAPER, d);
    REFUSED(v, 4, 0.5, 0.0, 0, RHEO_WEIGHTS_PAPER, d);
    REFUSED(v, 4, 0.5, -STEP, 0, RHEO_WEIGHTS_L1, d);
    REFUSED(v, 4, 0.5, inf, 0, RHEO_WEIGHTS_PAPER, d);
    REFUSED(v, 4, 0.5, nan, 0, RHEO_WEIGHTS_PAPER, d);
    REFUSED(v, 4, 0.5, STEP, 0, (rheo_weights)2, d);
#undef REFUSED
    /* The byte count of so many weights overflows to a small number. The velocities are not read before the check. */
    const size_t too_many = SIZE_MAX / sizeof(double) + 3;
    assert_int_equal(rheo_fractional_derivative(v, too_many, 0.5, STEP, 0, RHEO_WEIGHTS_PAPER, d), RHEO_ERROR_MEMORY);
    assert_int_equal(rheo_fractional_derivative(v, 0, 0.5, STEP, 0, RHEO_WEIGHTS_PAPER, d), RHEO_OK);
    for (int i = 0; i < 4; i++)
        assert_true(d[i] == -9.0);
    assert_int_equal(rheo_fractional_derivative(v, 4, 0.5, STEP, 0, RHEO_WEIGHTS_PAPER, d), RHEO_OK);
    assert_true(d[3] > 0.0);
}

/* --- bits --- */

static uint64_t mix(uint64_t hash, double x)
{
    uint64_t u;
    memcpy(&u, &x, sizeof u);
    return (hash ^ u) * UINT64_C(0x100000001b3); /* FNV-1a over 64-bit words */
}

/* Equal on every machine, compiler and optimisation level. */
static void bits(void **state)
{
    (void)state;
    uint64_t weights_hash = UINT64_C(0xcbf29ce484222325), derivative_hash = weights_hash;
    double w[2000], v[600];
    for (size_t n = 0; n < 600; n++)
        v[n] = (double)((n * 7919 + 13) % 1009) / 64.0 - 7.0;
    static const double q[5] = {0.01, 0.2, 0.5, 0.8, 0.99};
    for (int j = 0; j < 5; j++) {
        rheo_history_weights(q[j], 2000, w);
        for (size_t m = 0; m < 2000; m++)
            weights_hash = mix(weights_hash, w[m]);
        rheo_history_weights_l1(q[j], 2000, w);
        for (size_t m = 0; m < 2000; m++)
            weights_hash = mix(mix(weights_hash, w[m]), rheo_history_first_weight(q[j], m));
        for (size_t window = 0; window <= 150; window += 50)
            for (int kind = 0; kind < 2; kind++) {
                double *d = derivative(v, 600, q[j], STEP, window, (rheo_weights)kind);
                for (size_t n = 0; n < 600; n++)
                    derivative_hash = mix(derivative_hash, d[n]);
                free(d);
            }
    }
    if (weights_hash != UINT64_C(0x2c683e0172a8f90b))
        fail_msg("hash of the weights: 0x%016llx", (unsigned long long)weights_hash);
    if (derivative_hash != UINT64_C(0xd4a2333c458d4ff9))
        fail_msg("hash of the derivatives: 0x%016llx", (unsigned long long)derivative_hash);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_of_the_table),
        cmocka_unit_test(weights_to_the_last_digits),
        cmocka_unit_test(sums_of_weights),
        cmocka_unit_test(few_weights),
        cmocka_unit_test(orders_out_of_range),
        cmocka_unit_test(scale),
        cmocka_unit_test(quadratic_is_exact),
        cmocka_unit_test(smooth_motions_have_the_known_errors),
        cmocka_unit_test(backward_differences_need_l1),
        cmocka_unit_test(plateau_of_a_window),
        cmocka_unit_test(a_kind_has_the_modes_of_its_lags),
        cmocka_unit_test(signals_are_those_of_the_paper),
        cmocka_unit_test(memory_of_a_pulse),
        cmocka_unit_test(memory_of_a_stroke),
        cmocka_unit_test(windows_and_first_samples),
        cmocka_unit_test(sum_is_compensated),
        cmocka_unit_test(bad_arguments),
        cmocka_unit_test(bits),
    };
    return cmocka_run_group_tests_name("history", tests, NULL, NULL);
}
