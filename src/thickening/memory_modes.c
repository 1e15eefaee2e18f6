/*
 * The weights of the history term as a sum of decaying exponentials, c_m = sum_k w_k exp(-l_k (m - 1)), so that a
 * memory need not store the past (docs/model.md, History).
 *
 * The rates l_k are a geometric series from SLOWEST / lags to FASTEST a step, neighbours at most RATIO apart. The
 * weights minimise the squares of the relative errors at lags that are dense at first and then RATIO_OF_LAGS apart.
 * Givens rotations reduce the system row by row to a triangle. This is backward stable, needs memory only for the
 * triangle, and uses only + - * / and the square root, in one fixed order. SLOWEST and FASTEST were found by
 * experiment: slower modes differ only at lags that are not fitted, and cost digits; faster modes affect only lag 1.
 * For 0.001 <= q <= 0.999 the condition of the triangle, its columns scaled, is below 60.
 *
 * The very first sample has only half of its hat function, since no sample precedes it. Weighted by
 * exp(-l t), the integral of that half divided by that of a whole hat function is
 *
 *     first = 1/2 + (sinh l - l) / (2 (cosh l - 1))
 */
#include "rheolog/history.h"

#include <float.h>

#include "core/math.h"
#include "thickening/weights.h"

#define SLOWEST 0.2
#define FASTEST 4.0
#define RATIO 3.0
enum {
    MOST = RHEO_HISTORY_MAX_MODES,
    MOST_LAGS = 1 << 30,
    MOST_WINDOW = 1 << 24, /* tau is at most 3 windows, so 12 tau + 1 stays below MOST_LAGS */
    FULL_LAGS = 16384,     /* range of the fit for kind full */
    TEMPERED_TIMES = 12,   /* range of the fit for kind tempered, in tau: weights have fallen by e^-12 there */
};

/* Next lag of the fit: consecutive lags at first, later 1/50 apart. */
static uint32_t next_lag(uint32_t lag, uint32_t lags)
{
    uint32_t next = lag + 1 + lag / 50;
    return lag < lags && next > lags ? lags : next;
}

static double whole_weight(const rheo_history_modes *modes, size_t lag)
{
    double sum = 0;
    for (uint32_t k = 0; k < modes->count; k++)
        sum += modes->weight[k] * rheo__exp(-modes->rate[k] * (double)(lag - 1));
    return sum;
}

static void choose_rates(rheo_history_modes *modes)
{
    const double slowest = SLOWEST / modes->lags, range = FASTEST / slowest;
    modes->count = 2;
    for (double reach = RATIO; reach < range; reach *= RATIO)
        modes->count++;
    if (modes->count > modes->lags)
        modes->count = modes->lags;
    const double ratio = modes->count > 1 ? rheo__pow(range, 1.0 / (modes->count - 1)) : 1;
    modes->rate[0] = slowest;
    for (uint32_t k = 1; k < modes->count; k++)
        modes->rate[k] = modes->rate[k - 1] * ratio;
}

/* Rotates a row of the system into the triangle, whose last column is the right-hand side. */
static void add_row(double triangle[MOST][MOST + 1], double row[MOST + 1], uint32_t count)
{
    for (uint32_t k = 0; k < count; k++) {
        if (row[k] == 0)
            continue;
        double length = __builtin_sqrt(triangle[k][k] * triangle[k][k] + row[k] * row[k]);
        double c = triangle[k][k] / length, s = row[k] / length;
        for (uint32_t j = k; j <= count; j++) {
            double above = triangle[k][j];
            triangle[k][j] = c * above + s * row[j];
            row[j] = c * row[j] - s * above;
        }
    }
}

static void fit_weights(rheo_history_modes *modes, double q, rheo_weights kind)
{
    double triangle[MOST][MOST + 1] = {{0}};
    for (uint32_t lag = 1; lag <= modes->lags; lag = next_lag(lag, modes->lags)) {
        double row[MOST + 1] = {0}, inverse = 1 / rheo__memory_weight(q, lag, kind);
        for (uint32_t k = 0; k < modes->count; k++)
            row[k] = rheo__exp(-modes->rate[k] * (lag - 1)) * inverse;
        row[modes->count] = 1;
        add_row(triangle, row, modes->count);
    }
    for (uint32_t k = modes->count; k-- > 0;) {
        double sum = triangle[k][modes->count];
        for (uint32_t j = k + 1; j < modes->count; j++)
            sum -= triangle[k][j] * modes->weight[j];
        modes->weight[k] = sum / triangle[k][k];
    }
    modes->error = 0;
    for (uint32_t lag = 1; lag <= modes->lags; lag = next_lag(lag, modes->lags)) {
        double error = whole_weight(modes, lag) / rheo__memory_weight(q, lag, kind) - 1;
        error = error < 0 ? -error : error;
        modes->error = error > modes->error ? error : modes->error;
    }
}

/* Uses the series of sinh l - l and cosh l - 1, whose terms are all positive; 24 terms suffice for l up to 4. */
static double first_share(double rate)
{
    const double x = rate * rate;
    double sinh_sum = 1, cosh_sum = 1;
    for (int k = 24; k >= 1; k--) {
        sinh_sum = 1 + x / ((2 * k + 2) * (2 * k + 3)) * sinh_sum;
        cosh_sum = 1 + x / ((2 * k + 1) * (2 * k + 2)) * cosh_sum;
    }
    return 0.5 + rate * sinh_sum / (6 * cosh_sum);
}

rheo_result rheo_history_fit(double q, uint32_t lags, rheo_weights kind, rheo_history_modes *result)
{
    if (!(q > 0 && q < 1) || lags < 1 || lags > MOST_LAGS || !result ||
        (kind != RHEO_WEIGHTS_PAPER && kind != RHEO_WEIGHTS_L1))
        return RHEO_ERROR_ARGUMENT;
    rheo_history_modes modes = {.lags = lags};
    choose_rates(&modes);
    fit_weights(&modes, q, kind);
    for (uint32_t k = 0; k < modes.count; k++)
        modes.first[k] = kind == RHEO_WEIGHTS_PAPER ? first_share(modes.rate[k]) : 1;
    *result = modes;
    return RHEO_OK;
}

double rheo_history_modes_weight(const rheo_history_modes *modes, size_t lag)
{
    return lag ? whole_weight(modes, lag) : 1;
}

double rheo_history_tempering(double q, double window)
{
    if (!(q > 0 && q < 1) || !(window > 0))
        return rheo__ln(-1.0);
    return window / rheo__pow(rheo__gamma(2 - q), 1 / (1 - q));
}

void rheo_history_temper(rheo_history_modes *modes, double tau)
{
    const double more = 1 / tau, share = rheo__exp(-more);
    for (uint32_t k = 0; k < modes->count; k++) {
        modes->rate[k] += more;
        modes->weight[k] *= share; /* at lag 1 the exponent of the decay is 0 */
    }
}

rheo_result rheo_history_fit_kind(rheo_history_kind kind, double q, uint32_t window, rheo_weights weights,
                                  rheo_history_modes *modes)
{
    const double tau = kind == RHEO_HISTORY_TEMPERED ? rheo_history_tempering(q, window) : 0;
    uint32_t lags = window;
    if (kind == RHEO_HISTORY_FULL)
        lags = FULL_LAGS;
    else if (window > MOST_WINDOW || (kind != RHEO_HISTORY_WINDOW_FAST && kind != RHEO_HISTORY_TEMPERED))
        return RHEO_ERROR_ARGUMENT;
    else if (tau > 0) /* false if q or the window is out of range, which rheo_history_fit() refuses */
        lags = (uint32_t)(TEMPERED_TIMES * tau) + 1;
    const rheo_result result = rheo_history_fit(q, lags, weights, modes);
    if (result == RHEO_OK && kind == RHEO_HISTORY_TEMPERED)
        rheo_history_temper(modes, tau);
    return result;
}

rheo_result rheo_fractional_derivative_by_modes(const double *velocity, size_t count, const rheo_history_modes *modes,
                                                double q, double step, size_t window, rheo_weights kind,
                                                double *result)
{
    if (!velocity || !result || !modes || modes->count < 1 || modes->count > MOST || !(q > 0 && q < 1) ||
        !(step > 0 && step <= DBL_MAX) || (kind != RHEO_WEIGHTS_PAPER && kind != RHEO_WEIGHTS_L1))
        return RHEO_ERROR_ARGUMENT;
    const double scale = rheo_history_scale(q, step, kind);
    const size_t start = kind == RHEO_WEIGHTS_L1; /* this rule omits the first sample */
    double y[MOST] = {0}, decay[MOST], leaving[MOST], filling[MOST];
    for (uint32_t k = 0; k < modes->count; k++) {
        decay[k] = 1 - rheo__exp(-modes->rate[k]);
        leaving[k] = -rheo__exp(-modes->rate[k] * (double)window);
        /* A full window has cut off its past, so its oldest sample has its full weight from then on. */
        filling[k] = window ? (1 - modes->first[k]) * rheo__exp(-modes->rate[k] * (double)(window - 1)) : 0;
    }
    for (size_t n = 0; n < count; n++) {
        if (n < start) {
            result[n] = 0;
            continue;
        }
        const double v = velocity[n], oldest = window && n >= start + window ? velocity[n - window] : 0;
        const double at_start = window && n + 1 == window + start ? velocity[start] : 0;
        double sum = 0;
        for (uint32_t k = 0; k < modes->count; k++) {
            sum += modes->weight[k] * y[k];
            const double enters = n == start ? modes->first[k] * v : v;
            y[k] = (y[k] - decay[k] * y[k]) + (enters + (leaving[k] * oldest + filling[k] * at_start));
        }
        result[n] = scale * (v + sum);
    }
    return RHEO_OK;
}
