/*
 * Fractional derivatives, which model the memory of a shear thickening fluid: weights of past velocities, and the
 * derivative of a sampled motion.
 *
 * The position x is sampled every `step`, from rest at n = 0. Its Caputo derivative of order q, 0 < q < 1, is a
 * weighted sum of the past velocities v_p,
 *
 *     D^q x_n = C0 (a_{n,n} v_n + ... + a_{0,n} v_0),    C0 = step^(1-q) / Gamma(3-q),
 *
 * Eq. 3 of O. Ozgen, M. Kallmann, E. Brown, "An SPH model to simulate the dynamic behavior of shear
 * thickening fluids" ("the paper" below), based on C. M. Soon, C. F. M. Coimbra, M. H. Kobayashi, "The variable
 * viscoelasticity oscillator", Annalen der Physik 14 (2005) 378-389. The weight of a sample depends only on its lag
 * m = n - p and is called c_m. The very first sample, p = 0, is an exception: its weight is a_{0,n}.
 *
 * A Prony series (sum of decaying exponentials, rheo_history_fit()) approximates the weights. With it a few sums
 * replace the stored velocities.
 *
 * All machines compute the same bits. Any consistent units can be used: with x in L and `step` in T, velocities are
 * in L/T and D^q x is in L/T^q. Weights have no unit.
 */
#ifndef RHEOLOG_HISTORY_H
#define RHEOLOG_HISTORY_H

#include <stddef.h>

#include "rheolog/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Quadrature rule, which fixes the weights and the velocities that they apply to. */
typedef enum rheo_weights {
    /**
     * Product trapezoidal rule, as in the paper, for velocities at the samples, v_n = x'(n step). Exact for
     * quadratic x, else of order 2; of order 1 if velocities are backward differences. The default of worlds.
     */
    RHEO_WEIGHTS_PAPER = 0,
    /** L1 rule, for backward differences of positions, v_n = (x_n - x_{n-1}) / step. Of order 2-q. */
    RHEO_WEIGHTS_L1 = 1
} rheo_weights;

/**
 * Computes the interior weights of RHEO_WEIGHTS_PAPER for lags 0 to count - 1:
 *
 *     c_0 = 1,    c_m = (m-1)^(2-q) - 2 m^(2-q) + (m+1)^(2-q).
 *
 * At large lags this difference would lose all digits, so a series of positive terms is summed instead. The relative
 * error is below 7e-16 at any lag. For large m, c_m tends to (2-q)(1-q) m^(-q).
 *
 * @param q        order of the derivative, 0 < q < 1; all weights are NaN for any other q
 * @param count    number of weights
 * @param weights  output: `count` doubles without unit; may be NULL if count is 0
 */
RHEO_API void rheo_history_weights(double q, size_t count, double *weights);

/**
 * Computes the weights of RHEO_WEIGHTS_L1 for lags 0 to count - 1: b_m = (m+1)^(1-q) - m^(1-q). The relative error is
 * below 5e-16 at any lag. Arguments are those of rheo_history_weights().
 */
RHEO_API void rheo_history_weights_l1(double q, size_t count, double *weights);

/**
 * Weight of the very first sample, p = 0, at step n, by RHEO_WEIGHTS_PAPER:
 *
 *     a_{0,0} = 1,    a_{0,n} = (n-1)^(2-q) - n^(1-q) (n+q-2).
 *
 * The relative error is below 7e-16. NaN if q is outside (0, 1).
 */
RHEO_API double rheo_history_first_weight(double q, size_t n);

/**
 * Factor C0 of the sum: step^(1-q) / Gamma(3-q) for RHEO_WEIGHTS_PAPER, step^(1-q) / Gamma(2-q) for RHEO_WEIGHTS_L1.
 * Unit T^(1-q). NaN if q is outside (0, 1), `step` is not positive and finite, or `kind` is unknown.
 */
RHEO_API double rheo_history_scale(double q, double step, rheo_weights kind);

/**
 * Computes D^q x at the steps 0 to count - 1 from one component of the velocities.
 *
 * @param velocity  v_0 .. v_{count-1}, one each `step`, as `kind` expects them; unit L/T
 * @param count     number of samples; 0 is allowed
 * @param q         order of the derivative, 0 < q < 1
 * @param step      time between samples, positive and finite; unit T
 * @param window    d > 0: only the d + 1 samples of lags 0 to d count, which models another material; it does not
 *                  approximate the whole history. 0: the whole history counts
 * @param kind      RHEO_WEIGHTS_PAPER: the first sample has the weight a_{0,n} while n < window, or always if window is
 *                  0; from step n = window on, the oldest sample of the window has the interior weight c_window.
 *                  RHEO_WEIGHTS_L1: lags 0 to min(n - 1, window); v_0 does not count, and result[0] is 0
 * @param result    output: `count` doubles, unit L/T^q; must not overlap `velocity`
 *
 * Sums from the oldest sample to the newest, with compensation (Neumaier). The cost is count min(count, window + 1)
 * products. A velocity that is not finite affects only the results whose window contains it.
 *
 * RHEO_ERROR_ARGUMENT if q, step or kind is out of range or a pointer is NULL. RHEO_ERROR_MEMORY if there is no
 * memory for min(count, window + 1) weights of 8 bytes. `result` is then unchanged.
 */
RHEO_API rheo_result rheo_fractional_derivative(const double *velocity, size_t count, double q, double step,
                                                size_t window, rheo_weights kind, double *result);

/* ---- Weights from a curve ---- */

/** Largest number of points of a curve. */
#define RHEO_MAX_CURVE_POINTS 1000

/**
 * A point of a curve that gives the weight w of a past velocity by its age. The curve is linear between its points and
 * 0 outside of them.
 *
 * The derivative is then
 *
 *     D x = integral of w(age) v(age) d(age).
 *
 * The weights of rheo_history_weights() belong to w = age^(-q) / Gamma(1-q).
 */
typedef struct rheo_curve_point {
    /** Age. Unit T. At least 0; ascending from point to point. */
    double age;
    /** Weight. Unit T^-q for a derivative like that of order q. Finite, at most 1e12 in size. */
    double weight;
} rheo_curve_point;

/**
 * Window d of a curve with 2 to RHEO_MAX_CURVE_POINTS points: the age of the last one in steps, rounded up. 0 if that
 * is not from 1 to 1000000 or an argument is bad.
 */
RHEO_API uint32_t rheo_history_curve_window(const rheo_curve_point *curve, size_t points, double step);

/**
 * Computes the weights of lags 0 to count - 1 from a curve, by the product trapezoidal rule, as RHEO_WEIGHTS_PAPER: the
 * velocity is linear between samples, and its product with the curve is integrated exactly. So a curve is the same
 * material for any step.
 *
 * @param curve    the curve
 * @param points   number of its points, 2 to RHEO_MAX_CURVE_POINTS
 * @param step     time between samples, positive and finite; unit T
 * @param count    number of weights
 * @param weights  output: `count` doubles, unit T times that of the curve. The factor of the sum is 1
 * @param first    output: the weights of the very first sample at steps 0 to count - 1; may be NULL
 *
 * RHEO_ERROR_ARGUMENT for a bad curve or step; the arrays are then unchanged.
 */
RHEO_API rheo_result rheo_history_curve_weights(const rheo_curve_point *curve, size_t points, double step,
                                                size_t count, double *weights, double *first);

/* ---- Memory as a Prony series ---- */

/** What the history of a spring is of: the words of the parameter history.of. */
typedef enum rheo_history_of {
    /** The vector between its ends. The memory has the past velocities of particles. */
    RHEO_HISTORY_OF_VECTOR,
    /** Its length. The memory has the past positions of particles. */
    RHEO_HISTORY_OF_LENGTH,
} rheo_history_of;

/**
 * Lags of the past positions between which history.of length takes the length of a spring as linear: 0, 1, 2, 3, 4, 6, 8,
 * 11, ..., each a quarter larger than the one before. Returns the lag after `lag`, at most `last`.
 */
RHEO_API uint32_t rheo_history_next_sample(uint32_t lag, uint32_t last);

/** Storage of past velocities: the words of the parameter history.kind. docs/model.md compares them. */
typedef enum rheo_history_kind {
    /** Stores the velocities of lags 0 to d and sums them. Exact; the default. */
    RHEO_HISTORY_WINDOW = 0,
    /** Sums the same window by modes and subtracts velocities that leave it. The time does not depend on d. */
    RHEO_HISTORY_WINDOW_FAST = 1,
    /** Sums the whole history by modes. Stores only the newest velocity, and those that a lag keeps waiting. */
    RHEO_HISTORY_FULL = 2,
    /** Sums the weights c_m exp(-m/tau), which fade, by modes. Stores what kind full stores. */
    RHEO_HISTORY_TEMPERED = 3,
} rheo_history_kind;

/** Largest number of modes of a memory. */
enum { RHEO_HISTORY_MAX_MODES = 24 };

/** Prony series of the weights: c_m is approximately sum_k weight[k] exp(-rate[k] (m - 1)) for lags m >= 1. */
typedef struct rheo_history_modes {
    /** Number of modes, at most RHEO_HISTORY_MAX_MODES. */
    uint32_t count;
    /** Largest fitted lag, in steps. Beyond it the series decays too fast. */
    uint32_t lags;
    /** Decay rates, ascending. Unit 1/step. Above 0. */
    double rate[RHEO_HISTORY_MAX_MODES];
    /** Weights, without unit. Some may be negative. */
    double weight[RHEO_HISTORY_MAX_MODES];
    /** Factors of the very first sample when it enters a mode; the factor of all later samples is 1. */
    double first[RHEO_HISTORY_MAX_MODES];
    /** Largest relative error of a weight, measured at some hundred lags. */
    double error;
} rheo_history_modes;

/**
 * Fits a Prony series to the weights of the lags 1 to `lags`. The relative error of each weight is below 5e-4 for
 * q <= 0.5, 1.4e-3 for q <= 0.8 and 2.5e-3 for any q. It takes 8 modes for 50 lags, 9 for 150, 10 for 500 and 13 for
 * 16384. For very few lags there is one mode per lag, and the fit is exact.
 *
 * The rates form a geometric series that depends only on `lags`, so q can change while the sums are kept. The weights
 * minimise the squares of the relative errors. Beyond `lags` the series decays exponentially but the weights decay
 * like a power: for q = 0.5 the series is 1.3 % too small at 2 lags, 12 % at 4 lags and 45 % at 8 lags.
 *
 * @param q      order of the derivative, 0 < q < 1
 * @param lags   largest lag to fit, 1 to 2^30
 * @param kind   rule whose weights are fitted
 * @param modes  output
 *
 * RHEO_ERROR_ARGUMENT if q, lags or kind is out of range; *modes is then unchanged.
 */
RHEO_API rheo_result rheo_history_fit(double q, uint32_t lags, rheo_weights kind, rheo_history_modes *modes);

/** Weight of a lag according to a Prony series. Lag 0 has the weight 1, without modes. */
RHEO_API double rheo_history_modes_weight(const rheo_history_modes *modes, size_t lag);

/**
 * Time constant tau = window / Gamma(2-q)^(1/(1-q)) of tempered weights c_m exp(-m/tau), in steps. At constant
 * velocity their derivative tends to that of a window of this length. NaN if q is outside (0, 1) or the window is not
 * positive.
 */
RHEO_API double rheo_history_tempering(double q, double window);

/** Multiplies the weights of a series by exp(-lag/tau); relative errors do not change. tau: in steps, above 0. */
RHEO_API void rheo_history_temper(rheo_history_modes *modes, double tau);

/**
 * Fits the modes that a world of this kind has: for window-fast the lags 1 to window, for full 1 to 16384, for tempered
 * 1 to 12 tau + 1, where a weight has fallen by e^-12; those of tempered are multiplied by exp(-lag/tau).
 *
 * @param kind     any kind but RHEO_HISTORY_WINDOW, which has no modes
 * @param q        order of the derivative, 0 < q < 1
 * @param window   history window d in steps, 1 to 2^24; kind full ignores it
 * @param weights  rule whose weights are fitted
 * @param modes    output
 *
 * Errors are as in rheo_history_fit().
 */
RHEO_API rheo_result rheo_history_fit_kind(rheo_history_kind kind, double q, uint32_t window, rheo_weights weights,
                                           rheo_history_modes *modes);

/**
 * Computes rheo_fractional_derivative() by modes. With S = sum_k weight[k] y_k,
 *
 *     D^q x_n = C0 (v_n + S_n),   y_k <- (y_k - (1 - exp(-rate[k])) y_k) + v_n - exp(-rate[k] window) v_{n-window}.
 *
 * The last term exists only if window > 0. The cost is count x modes->count products for any window. The relative
 * error is that of the weights if the history or window has at most modes->lags steps. Other arguments, the weight of
 * the first sample and errors are as in rheo_fractional_derivative(). RHEO_ERROR_ARGUMENT also if there are no modes.
 */
RHEO_API rheo_result rheo_fractional_derivative_by_modes(const double *velocity, size_t count,
                                                         const rheo_history_modes *modes, double q, double step,
                                                         size_t window, rheo_weights kind, double *result);

/* ---- Signals ---- */

/** Velocities of a particle, with which the paper shows what a memory does. They need not be sampled at its step. */
typedef enum rheo_signal {
    /** Fig. 3, an impact: v = 5 sin^2(pi u), u = (t - 1)/0.33, for 0 < u < 1; else 0. */
    RHEO_SIGNAL_IMPACT = 0,
    /** Fig. 4, steady motion: v = 1 for 1 < t < 6; else 0. */
    RHEO_SIGNAL_STEADY = 1
} rheo_signal;

/**
 * Computes the velocities of a signal at the times t = n step, n = 0 to count - 1. Times are in T, velocities in L/T.
 * RHEO_ERROR_ARGUMENT if the signal is unknown, `step` is not positive and finite, or `velocity` is NULL.
 */
RHEO_API rheo_result rheo_signal_velocities(rheo_signal signal, double step, size_t count, double *velocity);

#ifdef __cplusplus
}
#endif

#endif
