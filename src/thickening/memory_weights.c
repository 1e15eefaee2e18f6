/*
 * Weights of the history term, and the fractional derivative of a whole signal.
 *
 * Eq. 3 of Ozgen, Kallmann and Brown, "An SPH model to simulate the dynamic behavior of shear thickening
 * fluids" (after Soon, Coimbra, Kobayashi 2005), is the product trapezoidal rule: the velocity is assumed to be
 * linear between samples, and its product with t^(-q) / Gamma(1-q) is integrated exactly. The L1 rule assumes a
 * constant velocity.
 *
 * Both rules have weights that are differences of neighbouring powers, which cancel: in double the paper's formula is
 * wrong in the 11th digit at m = 500 and has no correct digit at m = 1e8. In the binomial series of the powers the
 * large terms cancel exactly. For 0 < q < 1 all remaining terms are positive, so no digits are lost:
 *
 *   c_m     = 2 sum_{k>=1} C(2-q, 2k) m^(2-q-2k)                       powers about m
 *   a_{0,n} = sum_{k>=2} (-1)^k C(2-q, k) n^(2-q-k)                    powers about n
 *   b_m     = 2 sum_{k odd} C(1-q, k) (m+1/2)^(1-q-k) 2^(-k)           powers about m + 1/2
 *
 * Each series is summed from its smallest term, as s = 1 + r_1 (1 + r_2 (1 + ...)), r_k the ratio of successive
 * terms.
 */
#include "rheolog/history.h"

#include <float.h>
#include <stdint.h>
#include <stdlib.h>

#include "core/math.h"
#include "thickening/weights.h"

static int order_is_valid(double q)
{
    return q > 0.0 && q < 1.0; /* false for NaN */
}

static int step_is_valid(double step)
{
    return step > 0.0 && step <= DBL_MAX;
}

/* NaN with the same bits on every machine. */
static double invalid(void)
{
    return rheo__ln(-1.0);
}

/* c_m */
static double interior_weight(double q, size_t lag)
{
    if (lag == 0)
        return 1.0;
    if (lag == 1) {
        /* 2^(2-q) - 2 = 2 (e^y - 1), y = (1-q) log 2: cancels as q nears 1, so the series of e^y - 1 */
        const double y = (1.0 - q) * 0x1.62e42fefa39efp-1;
        double sum = 1.0;
        for (int k = 20; k >= 2; k--)
            sum = 1.0 + y / k * sum;
        return 2.0 * (y * sum);
    }
    const double m = (double)lag;
    const double x = 1.0 / (m * m);
    double sum = 1.0;
    for (int k = lag < 6 ? 39 : 11; k >= 1; k--)
        sum = 1.0 + (2 * k - 2 + q) * (2 * k - 1 + q) / ((2 * k + 1) * (2 * k + 2)) * x * sum;
    return (2.0 - q) * (1.0 - q) * rheo__pow(m, -q) * sum;
}

/* b_m */
static double l1_weight(double q, size_t lag)
{
    if (lag == 0)
        return 1.0;
    const double m = (double)lag;
    const double x = 1.0 / ((2.0 * m + 1.0) * (2.0 * m + 1.0));
    double sum = 1.0;
    for (int k = lag < 6 ? 39 : 17; k >= 1; k -= 2)
        sum = 1.0 + (k - 1 + q) * (k + q) / ((k + 1) * (k + 2)) * x * sum;
    return (1.0 - q) * rheo__pow(m + 0.5, -q) * sum;
}

double rheo__memory_weight(double q, size_t lag, rheo_weights kind)
{
    return kind == RHEO_WEIGHTS_PAPER ? interior_weight(q, lag) : l1_weight(q, lag);
}

void rheo_history_weights(double q, size_t count, double *weights)
{
    const int valid = order_is_valid(q);
    for (size_t m = 0; m < count; m++)
        weights[m] = valid ? interior_weight(q, m) : invalid();
}

void rheo_history_weights_l1(double q, size_t count, double *weights)
{
    const int valid = order_is_valid(q);
    for (size_t m = 0; m < count; m++)
        weights[m] = valid ? l1_weight(q, m) : invalid();
}

double rheo_history_first_weight(double q, size_t n)
{
    if (!order_is_valid(q))
        return invalid();
    if (n == 0)
        return 1.0;
    if (n == 1)
        return 1.0 - q;
    const double x = 1.0 / (double)n;
    double sum = 1.0;
    for (int k = n < 4 ? 57 : n < 16 ? 29 : 17; k >= 2; k--)
        sum = 1.0 + (k - 2 + q) / (k + 1) * x * sum;
    return 0.5 * (2.0 - q) * (1.0 - q) * rheo__pow((double)n, -q) * sum;
}

double rheo_history_scale(double q, double step, rheo_weights kind)
{
    if (!order_is_valid(q) || !step_is_valid(step))
        return invalid();
    if (kind == RHEO_WEIGHTS_PAPER)
        return rheo__pow(step, 1.0 - q) / rheo__gamma(3.0 - q);
    if (kind == RHEO_WEIGHTS_L1)
        return rheo__pow(step, 1.0 - q) / rheo__gamma(2.0 - q);
    return invalid();
}

/* Running sum, and the sum of the exact rounding errors of its additions (Neumaier 1974). */
typedef struct compensated {
    double sum, error;
} compensated;

static inline compensated add(compensated c, double x)
{
    /* Knuth's two-sum finds the same error as Neumaier's comparison of magnitudes, without a branch. */
    const double s = c.sum + x;
    const double t = s - c.sum;
    return (compensated){s, c.error + ((c.sum - (s - t)) + (x - t))};
}

rheo_result rheo_fractional_derivative(const double *velocity, size_t count, double q, double step, size_t window,
                                       rheo_weights kind, double *result)
{
    if (!velocity || !result || !order_is_valid(q) || !step_is_valid(step))
        return RHEO_ERROR_ARGUMENT;
    if (kind != RHEO_WEIGHTS_PAPER && kind != RHEO_WEIGHTS_L1)
        return RHEO_ERROR_ARGUMENT;
    if (count == 0)
        return RHEO_OK;

    /* A window that never fills has no effect. */
    const size_t last_lag = window > 0 && window < count ? window : count - 1;
    const int windowed = window > 0 && window < count;
    if (last_lag >= SIZE_MAX / sizeof(double))
        return RHEO_ERROR_MEMORY;
    double *const weights = malloc((last_lag + 1) * sizeof(double));
    if (!weights)
        return RHEO_ERROR_MEMORY;
    if (kind == RHEO_WEIGHTS_PAPER)
        rheo_history_weights(q, last_lag + 1, weights);
    else
        rheo_history_weights_l1(q, last_lag + 1, weights);
    const double scale = rheo_history_scale(q, step, kind);

    for (size_t n = 0; n < count; n++) {
        compensated c = {0.0, 0.0};
        size_t lag; /* next lag to add, plus 1 */
        if (windowed && n >= window + (kind == RHEO_WEIGHTS_L1)) {
            lag = window + 1;
        } else {
            lag = n;
            if (kind == RHEO_WEIGHTS_PAPER) /* the very first sample; the L1 rule omits it */
                c = add(c, rheo_history_first_weight(q, n) * velocity[0]);
        }
        for (; lag > 0; lag--)
            c = add(c, weights[lag - 1] * velocity[n - (lag - 1)]);
        result[n] = scale * (c.sum + c.error);
    }
    free(weights);
    return RHEO_OK;
}
