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
 * The same weights as a sum of decaying exponentials (rheo_history_fit()) need no past to be kept: a few numbers
 * stand for all of it.
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

/* ---- The memory as decaying exponentials ---- */

/** What a memory is. Of a world: which parameter `history.kind` it has; docs/model.md compares them. */
typedef enum rheo_history_kind {
    RHEO_HISTORY_WINDOW = 0,      /**< the velocities of lags 0..d, kept and summed: exact; the default */
    RHEO_HISTORY_WINDOW_FAST = 1, /**< the same window, by exponentials that forget what leaves it: cost without d */
    RHEO_HISTORY_FULL = 2,        /**< the whole history, by exponentials alone: nothing is kept */
    RHEO_HISTORY_TEMPERED = 3,    /**< c_m e^(-m/tau), by exponentials alone: a window that fades */
} rheo_history_kind;

enum { RHEO_HISTORY_MAX_MODES = 24 };

/** Weights as a sum of decaying exponentials: c_m = sum_k weight[k] exp(-rate[k] (m - 1)) for m >= 1, nearly. */
typedef struct rheo_history_modes {
    uint32_t count;                        /**< of modes */
    uint32_t lags;                         /**< lags 1..lags were fitted; beyond them the sum falls too fast */
    double rate[RHEO_HISTORY_MAX_MODES];   /**< per step, above 0, ascending */
    double weight[RHEO_HISTORY_MAX_MODES]; /**< some may be negative */
    double first[RHEO_HISTORY_MAX_MODES];  /**< what the first sample of all enters a mode times, in place of 1 */
    double error;                          /**< the largest relative error of a weight, of some hundred lags */
} rheo_history_modes;

/**
 * Fits the weights of lags 1..lags, those of the paper's rule or of the L1 rule, by as few exponentials as keep the
 * relative error of each weight below 5e-4 for q <= 0.5, 1.4e-3 for q <= 0.8, 2.5e-3 for all q, however many lags:
 * 8 modes for 50 lags, 9 for 150, 10 for 500, 13 for 16384; one for each lag where that is exact.
 *
 * The rates are a geometric series that depends on `lags` alone, so that sums once gathered serve any q. Weights are
 * the least squares of the relative error. Beyond `lags` the sum decays exponentially where the weights follow a
 * power: at twice as many lags it is 1.3 % too small, at 4 times 12 %, at 8 times 45 % (q = 0.5).
 *
 * q      order of the derivative, 0 < q < 1
 * lags   1 .. 2^30
 *
 * Returns RHEO_OK, or RHEO_ERROR_ARGUMENT if q, lags or kind is out of range; *modes is then untouched.
 */
RHEO_API rheo_result rheo_history_fit(double q, uint32_t lags, rheo_weights kind, rheo_history_modes *modes);

/** The weight of a lag that the modes stand for: 1 for lag 0, where no mode counts. */
RHEO_API double rheo_history_modes_weight(const rheo_history_modes *modes, size_t lag);

/**
 * tau = window / Gamma(2-q)^(1/(1-q)), in steps: with weights c_m exp(-m/tau) a constant speed gives in the end the
 * same derivative as in a window of that length. NaN if q is outside (0, 1) or the window is not positive.
 */
RHEO_API double rheo_history_tempering(double q, double window);

/** Makes modes fade: their weights become those times exp(-lag/tau), with the same relative errors. tau > 0. */
RHEO_API void rheo_history_temper(rheo_history_modes *modes, double tau);

/**
 * rheo_fractional_derivative() by modes: with S = sum_k weight[k] y_k,
 *
 *     D^q x_n = C0 (v_n + S_n),   y_k <- (y_k - (1 - exp(-rate[k])) y_k) + v_n - exp(-rate[k] window) v_{n-window},
 *
 * the last term only if window > 0. The cost is that of count * modes products, whatever the window is. Errors are
 * those of the modes' weights, for histories and windows of at most modes->lags steps. Arguments, the weight of the
 * first sample and results as there; also RHEO_ERROR_ARGUMENT without modes.
 */
RHEO_API rheo_result rheo_fractional_derivative_by_modes(const double *velocity, size_t count,
                                                         const rheo_history_modes *modes, double q, double step,
                                                         size_t window, rheo_weights kind, double *result);

#ifdef __cplusplus
}
#endif

#endif
