/*
 * The memory of a shear thickening fluid: weights of the fractional derivative of a motion, and the
 * derivative of a whole signal.
 *
 * The derivative of order q, 0 < q < 1, of a position x sampled every `step` (in Caputo's sense, from rest at
 * n = 0) is a weighted sum of the past velocities v_p,
 *
 *     D^q x_n = C0 (a_{n,n} v_n + ... + a_{0,n} v_0),    C0 = step^(1-q) / Gamma(3-q),
 *
 * Eq. 3 of O. Ozgen, M. Kallmann, E. Brown, "An SPH model to simulate the dynamic behavior of shear
 * thickening fluids", after C. M. Soon, C. F. M. Coimbra, M. H. Kobayashi, "The variable viscoelasticity
 * oscillator", Annalen der Physik 14 (2005) 378-389. The weight of a sample depends on its lag m = n - p
 * only, c_m, but for the first sample of all, p = 0, whose weight is a_{0,n}.
 *
 * All results are the same bits on every machine. Units are free but must agree: with x in L and `step` in T,
 * velocities are in L/T and D^q x in L/T^q. The weights themselves have no unit.
 */
#ifndef RHEOLOG_HISTORY_H
#define RHEOLOG_HISTORY_H

#include <stddef.h>

#include "rheolog/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Which velocities the weights are meant for. */
typedef enum rheo_weights {
    /**
     * The paper's weights, and the default: the product trapezoidal rule, for velocities at the samples,
     * v_n = x'(n step). Exact for quadratic x, order 2 otherwise; only order 1 with backward differences.
     */
    RHEO_WEIGHTS_PAPER = 0,
    /**
     * The L1 rule, for velocities that are backward differences, v_n = (x_n - x_{n-1}) / step, as particle
     * positions give them: order 2-q.
     */
    RHEO_WEIGHTS_L1 = 1
} rheo_weights;

/**
 * Interior weights of the paper's rule: weights[m], 0 <= m < count, becomes
 *
 *     c_0 = 1,    c_m = (m-1)^(2-q) - 2 m^(2-q) + (m+1)^(2-q).
 *
 * That difference loses all digits at large lags, so a series of positive terms takes its place: relative
 * error below 7e-16 at any lag. They fall like (2-q)(1-q) m^(-q).
 *
 * weights: room for `count` doubles; may be NULL only if count = 0.
 * q outside (0, 1), or NaN, makes every weight NaN.
 */
RHEO_API void rheo_history_weights(double q, size_t count, double *weights);

/**
 * Weights of the L1 rule: weights[m], 0 <= m < count, becomes b_m = (m+1)^(1-q) - m^(1-q); b_0 = 1. Relative
 * error below 5e-16 at any lag. Arguments as for rheo_history_weights.
 */
RHEO_API void rheo_history_weights_l1(double q, size_t count, double *weights);

/**
 * Weight a_{0,n} = (n-1)^(2-q) - n^(1-q) (n+q-2) of the paper's rule for the very first sample, p = 0, seen
 * from step n >= 1; relative error below 7e-16. 1 for n = 0, where the first sample is also the latest. NaN
 * if q is outside (0, 1).
 */
RHEO_API double rheo_history_first_weight(double q, size_t n);

/**
 * Factor of the sum: C0 = step^(1-q) / Gamma(3-q) for RHEO_WEIGHTS_PAPER, step^(1-q) / Gamma(2-q) for
 * RHEO_WEIGHTS_L1, in units of time^(1-q). NaN if q is outside (0, 1), `step` is not finite and positive, or
 * `kind` is neither.
 */
RHEO_API double rheo_history_scale(double q, double step, rheo_weights kind);

/**
 * D^q x at every step n = 0 .. count-1 from the velocities of one component of a motion.
 *
 * velocity  v_0 .. v_{count-1}, `step` apart, of the sort that `kind` is meant for
 * count     number of samples; with 0 nothing is written
 * q         order of the derivative, 0 < q < 1
 * step      time between samples, finite and positive
 * window    0: the whole history counts. d > 0: lags 0..d only, that is d+1 samples; another material, not an
 *           approximation of the whole history.
 * kind      RHEO_WEIGHTS_PAPER: as long as the first sample is in sight and n < window (or window = 0), it
 *           has the weight a_{0,n}; from n = window on the oldest sample in the window has the interior
 *           weight c_window. RHEO_WEIGHTS_L1: lags 0..n-1, or 0..min(n-1, window); v_0 does not count and
 *           result[0] = 0.
 * result    room for `count` doubles; must not overlap `velocity`
 *
 * The products are summed from the oldest to the latest with a compensated (Neumaier) sum; the cost is that
 * of count * min(count, window + 1) products. A velocity that is not finite makes the results that see it not
 * finite.
 *
 * Returns RHEO_OK; RHEO_ERROR_ARGUMENT if q, step or kind is out of range or a pointer is NULL;
 * RHEO_ERROR_MEMORY if the weights, 8 bytes times min(count, window + 1), could not be allocated. After an
 * error `result` is untouched.
 */
RHEO_API rheo_result rheo_fractional_derivative(const double *velocity, size_t count, double q, double step,
                                                size_t window, rheo_weights kind, double *result);

#ifdef __cplusplus
}
#endif

#endif
