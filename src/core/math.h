/*
 * Elementary functions with the same bits on every machine and at every optimisation level.
 *
 * They use IEEE double + - * /, comparisons and bit operations only, and assume rounding to nearest and no
 * flushing of subnormals. The errors given are the largest found against MPFR with 200 bits over 2e6 random points
 * (gamma: 2e5) of each of several ranges, in units of the last place: 0.5 means that every result was correctly
 * rounded. A call takes 20 to 330 ns, two to thirty times as long as in a C library. They are used for
 * coefficients, which are computed once, and for the sines of vibrators. bench/functions.c measures both;
 * bench/functions-x86_64.csv has its results.
 */
#ifndef RHEOLOG_CORE_MATH_H
#define RHEOLOG_CORE_MATH_H

#include <stdint.h>

#include "core/strict.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The least integer that is not below x, for x >= 0; x itself for infinity and NaN. */
static inline double rheo__ceil(double x)
{
    if (!(x < 0x1p53)) /* an integer; a conversion is not defined for large ones */
        return x;
    const double whole = (double)(uint64_t)x;
    return whole + (whole < x);
}

/* e^x: 0.5 ulp. Infinity above 709.78; gradual underflow, zero below -745.13; NaN for NaN. */
double rheo__exp(double x);

/* e^x - 1: 0.501 ulp. Infinity above 709.78, -1 below -38; x itself for tiny x; NaN for NaN. */
double rheo__expm1(double x);

/*
 * Natural logarithm, x >= 0: 0.5 ulp, subnormal x included. -infinity for +-0, NaN for x < 0 and for NaN.
 * (Not rheo_log, which is a public type.)
 */
double rheo__ln(double x);

/*
 * x^y for x >= 0 and any y: 0.5 ulp, subnormal results included. 1 if y = 0 or x = 1, for any other
 * argument, as in C. 0^y is 0 for y > 0 and infinity for y < 0. NaN for x < 0 (even with an integer y) and for NaN
 * otherwise.
 */
double rheo__pow(double x, double y);

/*
 * Gamma function, 0 < x <= 170: 0.5 ulp; factorials up to 22! are exact. Infinity above 171.62, for +0
 * and for x < 2^-1024; NaN for x < 0, -0 and NaN.
 */
double rheo__gamma(double x);

/*
 * sin(2 pi t) and cos(2 pi t), |t| < 2^30: 0.5 ulp, 0.75 where the sine is subnormal. Exact at multiples
 * of 1/4, where every zero is +0. Defined for |t| < 2^48; NaN beyond, and for NaN.
 */
double rheo__sin_turns(double t);
double rheo__cos_turns(double t);

#ifdef __cplusplus
}
#endif

#endif
