/*
 * Checks, at run time, the properties of a build that no macro shows (core/strict.h) and the settings of the thread.
 *
 * Each probe is an expression that comes out differently in an unfit environment. It is made of numbers that the
 * compiler must load (volatile), so that it cannot evaluate the expression itself, and the result is compared as
 * bits, so that the comparison cannot become a part of it. It is evaluated in every kind of number that stages use,
 * since compilers may treat them differently (NEON flushes denormals in vectors only), and compiled for each SIMD
 * variant with its options. A probe checks the options of this file only; files compiled with others are not seen.
 */
#include "core/probe.h"

#include <string.h>

#include "core/lanes.h"
#include "core/strict.h"

#define IN_ONE(x) (x)
#define IN_FOUR(x)         \
    {                      \
        (x), (x), (x), (x) \
    }
#define IN_EIGHT(x)                            \
    {                                          \
        (x), (x), (x), (x), (x), (x), (x), (x) \
    }
#define IN_SIXTEEN(x)                                                                  \
    {                                                                                  \
        (x), (x), (x), (x), (x), (x), (x), (x), (x), (x), (x), (x), (x), (x), (x), (x) \
    }
#if RHEO__LANES == 16
#define IN_LANES IN_SIXTEEN
#elif RHEO__LANES == 8
#define IN_LANES IN_EIGHT
#else
#define IN_LANES IN_FOUR
#endif

/* A number that the compiler does not know. */
#define LOADED(number, name, value)                     \
    static const volatile number loaded_##name = value; \
    const number name = loaded_##name
/* The expression must have these bits. */
#define EXPECT(number, what, expression, value)                           \
    do {                                                                  \
        static const number expected = value;                             \
        const number actual = (expression);                               \
        found |= memcmp(&actual, &expected, sizeof actual) ? (what) : 0U; \
    } while (0)

/*
 * Rounding to nearest even: 1 + ulp/2 = 1 and (1 + ulp) + ulp/2 = 1 + 2 ulp; other roundings fail one of the two, or
 * its mirror. Denormals: half the smallest normal number is lost if results are flushed, twice that if operands are.
 */
#define PROBE_THREAD(name, number, real, IN, ulp, least)                                   \
    static unsigned name(void)                                                             \
    {                                                                                      \
        unsigned found = 0;                                                                \
        LOADED(number, one, IN(1));                                                        \
        LOADED(number, small, IN(ulp));                                                    \
        LOADED(number, half, IN((real)0.5));                                               \
        LOADED(number, smallest, IN(least));                                               \
        const number half_ulp = small * half, denormal = smallest * half;                  \
        EXPECT(number, RHEO__TROUBLE_ROUNDING, one + half_ulp, IN(1));                     \
        EXPECT(number, RHEO__TROUBLE_ROUNDING, -one - half_ulp, IN(-1));                   \
        EXPECT(number, RHEO__TROUBLE_ROUNDING, (one + small) + half_ulp, IN(1 + 2 * ulp)); \
        EXPECT(number, RHEO__TROUBLE_DENORMALS, denormal, IN(least / 2));                  \
        EXPECT(number, RHEO__TROUBLE_DENORMALS, denormal + denormal, IN(least));           \
        return found;                                                                      \
    }

/*
 * (1 + e)^2 - (1 + 2e) is 0 when the product is rounded, e^2 when it is contracted into a fused multiply-add. Without
 * optimisation, clang contracts only where its fast instruction selection gives up, for example at returned pairs and
 * at single lanes.
 */
typedef struct pair_float {
    float residual, other;
} pair_float;
typedef struct pair_double {
    double residual, other;
} pair_double;

static pair_float residual_float(float root, float square)
{
    return (pair_float){root * root - square, root};
}
static pair_double residual_double(double root, double square)
{
    return (pair_double){root * root - square, root};
}
#if RHEO__LANES > 1
static rheo__lanes residual_lanes(rheo__lanes root, rheo__lanes square)
{
    rheo__lanes residual = root * root - square;
    residual[0] = residual[1];
    return residual;
}
#endif

#define PROBE_CONTRACTION(name, number, IN, ulp, residual)                    \
    static unsigned name(void)                                                \
    {                                                                         \
        unsigned found = 0;                                                   \
        LOADED(number, root, IN(1 + ulp));                                    \
        LOADED(number, square, IN(1 + 2 * ulp));                              \
        EXPECT(number, RHEO__TROUBLE_CONTRACTED, root *root - square, IN(0)); \
        EXPECT(number, RHEO__TROUBLE_CONTRACTED, residual, IN(0));            \
        return found;                                                         \
    }

/*
 * (b + 1) - b is 0 for a b whose neighbours are 2 apart; it is 1 if the sum is reordered or kept in a wider type. 5/3
 * and 7/3 differ from 5 and 7 times the rounded 1/3; a compiler may multiply by the reciprocal of a constant or of a
 * common divisor. A root of infinity made from an estimate of 1/root is 0 times infinity. -0 + 0 is +0 only if the
 * compiler respects signs of zeros; NaN + 0 is NaN only if it respects NaN.
 */
#define PROBE_BUILD(name, number, real, IN, ulp, root)                                                               \
    static unsigned name(void)                                                                                       \
    {                                                                                                                \
        unsigned found = 0;                                                                                          \
        LOADED(number, one, IN(1));                                                                                  \
        LOADED(number, big, IN(2 / ulp));                                                                            \
        LOADED(number, two, IN(2));                                                                                  \
        LOADED(number, three, IN(3));                                                                                \
        LOADED(number, five, IN(5));                                                                                 \
        LOADED(number, seven, IN(7));                                                                                \
        LOADED(number, minus_zero, IN((real)-0.0));                                                                  \
        LOADED(number, infinity, IN((real)__builtin_inff()));                                                        \
        EXPECT(number, RHEO__TROUBLE_REORDERED, (big + one) - big, IN(0));                                           \
        EXPECT(number, RHEO__TROUBLE_RECIPROCALS, five / (real)3, IN((real)0x1.aaaaaaaaaaaabp+0));                   \
        EXPECT(number, RHEO__TROUBLE_RECIPROCALS, five / three, IN((real)0x1.aaaaaaaaaaaabp+0));                     \
        EXPECT(number, RHEO__TROUBLE_RECIPROCALS, seven / three, IN((real)0x1.2aaaaaaaaaaabp+1));                    \
        EXPECT(number, RHEO__TROUBLE_RECIPROCALS, two / three, IN((real)0x1.5555555555555p-1));                      \
        EXPECT(number, RHEO__TROUBLE_ROOTS, root(three), IN((real)0x1.bb67ae8584caap+0));                            \
        EXPECT(number, RHEO__TROUBLE_ROOTS, root(infinity), IN((real)__builtin_inff()));                             \
        EXPECT(number, RHEO__TROUBLE_ZEROS, minus_zero + (real)0, IN(0));                                            \
        EXPECT(number, RHEO__TROUBLE_INFINITIES, (real)__builtin_nan("") + minus_zero, IN((real)__builtin_nan(""))); \
        return found;                                                                                                \
    }

#if RHEO_DOUBLE
#define REAL_ULP DBL_EPSILON
#define REAL_LEAST DBL_MIN
#else
#define REAL_ULP FLT_EPSILON
#define REAL_LEAST FLT_MIN
#endif

PROBE_THREAD(thread_float, float, float, IN_ONE, FLT_EPSILON, FLT_MIN)
PROBE_THREAD(thread_double, double, double, IN_ONE, DBL_EPSILON, DBL_MIN)
PROBE_CONTRACTION(contraction_float, float, IN_ONE, FLT_EPSILON, residual_float(root, square).residual)
PROBE_CONTRACTION(contraction_double, double, IN_ONE, DBL_EPSILON, residual_double(root, square).residual)
PROBE_BUILD(build_float, float, float, IN_ONE, FLT_EPSILON, __builtin_sqrtf)
PROBE_BUILD(build_double, double, double, IN_ONE, DBL_EPSILON, __builtin_sqrt)
#if RHEO__LANES > 1
PROBE_THREAD(thread_lanes, rheo__lanes, rheo_real, IN_LANES, REAL_ULP, REAL_LEAST)
PROBE_CONTRACTION(contraction_lanes, rheo__lanes, IN_LANES, REAL_ULP, residual_lanes(root, square))
PROBE_BUILD(build_lanes, rheo__lanes, rheo_real, IN_LANES, REAL_ULP, rheo__lanes_sqrt)
#endif

/* NaN and infinity must be detectable, since every step searches the state for them. */
static unsigned build_infinities(void)
{
    static const volatile float loaded_nan = __builtin_nanf(""), loaded_infinity = __builtin_inff();
    const float nan = loaded_nan, infinity = loaded_infinity;
    const bool seen = nan != nan && nan - nan != 0 && infinity > FLT_MAX; /* none of which raises a flag */
    return seen ? 0 : RHEO__TROUBLE_INFINITIES;
}

unsigned RHEO__VARIANT(probe)(void)
{
    unsigned found = thread_float() | thread_double();
#if RHEO__LANES > 1
    const unsigned in_lanes = thread_lanes();
    found |= in_lanes & RHEO__TROUBLE_DENORMALS & ~found ? RHEO__TROUBLE_VECTORS : in_lanes;
    found |= contraction_lanes() | build_lanes();
#endif
    return found | contraction_float() | contraction_double() | build_float() | build_double() | build_infinities();
}
