/*
 * Refuses compiler options that would change the bits of results. Every file that computes includes this. Not every
 * option is visible here (clang shows few of them); core/environment.c checks the others at run time.
 */
#ifndef RHEO__CORE_STRICT_H
#define RHEO__CORE_STRICT_H

#include <float.h>

#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0
#error "rheolog needs FLT_EVAL_METHOD 0: use -msse2 -mfpmath=sse on 32-bit x86, else -fexcess-precision=fast"
#endif
#if FLT_RADIX != 2 || FLT_MANT_DIG != 24 || DBL_MANT_DIG != 53
#error "rheolog needs float and double of IEEE 754"
#endif
#ifdef __FAST_MATH__
#error "rheolog cannot be compiled with -ffast-math or -Ofast: results would differ from machine to machine"
#endif
#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "rheolog cannot be compiled with -ffinite-math-only: it would not see the NaN that a bad step makes"
#endif
#ifdef __ASSOCIATIVE_MATH__
#error \
    "rheolog cannot be compiled with -fassociative-math (-funsafe-math-optimizations): sums would have no fixed order"
#endif
#ifdef __RECIPROCAL_MATH__
#error "rheolog cannot be compiled with -freciprocal-math or -funsafe-math-optimizations: it rounds quotients twice"
#endif
#ifdef __NO_SIGNED_ZEROS__
#error "rheolog cannot be compiled with -fno-signed-zeros (-funsafe-math-optimizations): the sign of a zero is state"
#endif
_Static_assert(sizeof 0.1 == sizeof(double), "rheolog cannot be compiled with -fsingle-precision-constant");

#endif
