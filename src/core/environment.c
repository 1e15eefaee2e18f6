/*
 * The floating-point environment (core/environment.h). Rounding and denormals belong to the thread and may be changed
 * by anyone at any time (a library built with -ffast-math does so when it is loaded), so they are looked at in every
 * step; the tests are a handful of operations on volatile values that a compiler cannot work out beforehand.
 */
#include "core/environment.h"

#include <float.h>

#include "core/error.h"

#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0
#error "rheolog needs FLT_EVAL_METHOD 0: on 32-bit x86 compile with -msse2 -mfpmath=sse"
#endif
#ifdef __FAST_MATH__
#error "rheolog cannot be compiled with -ffast-math: results would differ from machine to machine"
#endif

rheo_result rheo_check_environment(rheo_error *error)
{
    volatile float one = 1, half_ulp = FLT_EPSILON / 2, smallest = FLT_MIN, half = 0.5F;
    volatile double one_d = 1, half_ulp_d = DBL_EPSILON / 2, smallest_d = DBL_MIN;
    /* To nearest even: 1 + ulp/2 = 1 and (1 + ulp) + ulp/2 = 1 + 2 ulp; other roundings fail one of the two, or its
     * mirror. */
    volatile float up = one + half_ulp, odd = (one + FLT_EPSILON) + half_ulp, down = -one - half_ulp;
    volatile double up_d = one_d + half_ulp_d, odd_d = (one_d + DBL_EPSILON) + half_ulp_d,
                    down_d = -one_d - half_ulp_d;
    if (up != 1 || odd != 1 + 2 * FLT_EPSILON || down != -1 || up_d != 1 || odd_d != 1 + 2 * DBL_EPSILON ||
        down_d != -1)
        return rheo_fail(
            error, RHEO_ERROR_ENVIRONMENT,
            "the floating-point rounding mode is not to nearest; restore it with fesetround(FE_TONEAREST)");
    volatile float denormal = smallest * half, restored = denormal + denormal;
    volatile double denormal_d = smallest_d * (double)half, restored_d = denormal_d + denormal_d;
    if (denormal == 0 || restored != FLT_MIN || denormal_d == 0 || restored_d != DBL_MIN)
        return rheo_fail(error, RHEO_ERROR_ENVIRONMENT,
                         "denormal numbers are flushed to zero in this thread (a library built with -ffast-math does "
                         "that when it is loaded); clear the FTZ and DAZ bits");
    /* (1 + e)^2 - (1 + 2e) is 0 when the product is rounded, e^2 when it is contracted into a fused multiply-add. */
    float a = one + FLT_EPSILON, b = one + 2 * FLT_EPSILON;
    double c = one_d + DBL_EPSILON, d = one_d + 2 * DBL_EPSILON;
    volatile float contracted = a * a - b;
    volatile double contracted_d = c * c - d;
    if (contracted != 0 || contracted_d != 0)
        return rheo_fail(error, RHEO_ERROR_ENVIRONMENT,
                         "this build contracts a * b + c into one operation; compile rheolog with -ffp-contract=off");
    return RHEO_OK;
}
