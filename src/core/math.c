/*
 * Elementary functions with reproducible bits.
 *
 * C libraries round exp, log and pow differently, so coefficients computed with them would make the same scene
 * diverge between two machines. These functions use only operations whose results IEEE 754 defines.
 *
 * Numbers are represented as an unevaluated sum of two doubles (about 106 bits): T. J. Dekker, "A floating-point
 * technique for extending the available precision", Numer. Math. 18 (1971), with Knuth's two-sum and
 * Veltkamp's splitting. No fused multiply-add is used, since not every machine has one. The first
 * terms of a series have this form; its tail, which is smaller by 2^-18 or more, is in double. Relative errors before
 * the last rounding are below 2^-64, so nearly all results are correctly rounded.
 *
 *   log x    x = m 2^e, sqrt(1/2) <= m < sqrt(2), s = (m-1)/(m+1), log m = 2 (s + s^3/3 + s^5/5 + ...)
 *   exp x    x = k log 2 + r, Taylor series of e^u - 1 at u = r/16, four times p <- 2p + p^2
 *   e^x - 1  the same, with 1 subtracted before rounding; near 0 the series
 *   x^y      exp(y log x), without rounding the logarithm to double
 *   gamma    Gamma(x) = Gamma(z) / (x (x+1) ... (z-1)), z >= 20, and Stirling's series (DLMF 5.11.1) for z
 *   sin, cos t = n/4 + r exactly, |r| <= 1/8, Taylor series at 2 pi r
 *
 * A constant {hi, lo} consists of the double nearest to the number in its comment, and the double nearest to the
 * remainder.
 */
#include "core/math.h"

#include <float.h>
#include <stdint.h>
#include <string.h>

#ifdef __clang__
#pragma STDC FP_CONTRACT OFF
#endif

/* hi + lo, |lo| <= half a unit in the last place of hi. */
typedef struct dd {
    double hi, lo;
} dd;

static const dd dd_log2 = {0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};
static const dd dd_two_pi = {0x1.921fb54442d18p+2, 0x1.1a62633145c07p-52};
static const dd dd_half_log_two_pi = {0x1.d67f1c864beb5p-1, -0x1.65b5a1b7ff5dfp-55};

static uint64_t bits_of(double x)
{
    uint64_t u;
    memcpy(&u, &x, sizeof u);
    return u;
}

static double from_bits(uint64_t u)
{
    double x;
    memcpy(&x, &u, sizeof x);
    return x;
}

/* Positive quiet NaN and infinity as bits: 0.0/0.0 has a sign that differs between machines. */
static double not_a_number(void)
{
    return from_bits(UINT64_C(0x7ff8000000000000));
}

static double plus_infinity(void)
{
    return from_bits(UINT64_C(0x7ff0000000000000));
}

/* 2^k, -1022 <= k <= 1023. */
static double power_of_two(int k)
{
    return from_bits((uint64_t)(k + 1023) << 52);
}

/* a + b exactly, |a| >= |b| or a = 0. */
static inline dd quick_two_sum(double a, double b)
{
    const double s = a + b;
    return (dd){s, b - (s - a)};
}

/* a + b exactly. */
static inline dd two_sum(double a, double b)
{
    const double s = a + b;
    const double t = s - a;
    return (dd){s, (a - (s - t)) + (b - t)};
}

/* a * b exactly, |a|, |b| < 2^995 and no partial product below 2^-1074. */
static inline dd two_prod(double a, double b)
{
    const double splitter = 0x1p27 + 1.0;
    const double p = a * b;
    const double ta = splitter * a, tb = splitter * b;
    const double ah = ta - (ta - a), bh = tb - (tb - b);
    const double al = a - ah, bl = b - bh;
    return (dd){p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}

static inline dd dd_add(dd a, dd b)
{
    const dd s = two_sum(a.hi, b.hi);
    return quick_two_sum(s.hi, s.lo + (a.lo + b.lo));
}

static inline dd dd_add_double(dd a, double b)
{
    const dd s = two_sum(a.hi, b);
    return quick_two_sum(s.hi, s.lo + a.lo);
}

static inline dd dd_mul(dd a, dd b)
{
    const dd p = two_prod(a.hi, b.hi);
    return quick_two_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

static inline dd dd_mul_double(dd a, double b)
{
    const dd p = two_prod(a.hi, b);
    return quick_two_sum(p.hi, p.lo + a.lo * b);
}

static inline dd dd_div(dd a, dd b)
{
    const double q = a.hi / b.hi;
    const dd p = dd_mul_double(b, q);
    const double rest = ((a.hi - p.hi) - p.lo) + a.lo;
    return quick_two_sum(q, rest / b.hi);
}

/* Nearest integer, |x| < 2^51. */
static inline double nearest(double x)
{
    const double big = 0x1.8p52;
    return (x + big) - big;
}

/* Logarithm of a finite x > 0; relative error < 2^-75. */
static dd log_dd(double x)
{
    int exponent = 0;
    if (x < 0x1p-1022) {
        x *= 0x1p54;
        exponent = -54;
    }
    /* Offset the bits so that the exponent field changes at sqrt(1/2) instead of at a power of two. */
    const uint64_t low = bits_of(0x1.6a09e667f3bcdp-1), one = bits_of(1.0);
    const uint64_t u = bits_of(x) + (one - low);
    exponent += (int)(u >> 52) - 1023;
    const double m = from_bits((u & UINT64_C(0xfffffffffffff)) + low);

    const dd s = dd_div((dd){m - 1.0, 0.0}, two_sum(m, 1.0));
    const dd z = dd_mul(s, s); /* <= 0.0295 */
    double tail = 1.0 / 33.0;
    tail = tail * z.hi + 1.0 / 31.0;
    tail = tail * z.hi + 1.0 / 29.0;
    tail = tail * z.hi + 1.0 / 27.0;
    tail = tail * z.hi + 1.0 / 25.0;
    tail = tail * z.hi + 1.0 / 23.0;
    tail = tail * z.hi + 1.0 / 21.0;
    tail = tail * z.hi + 1.0 / 19.0;
    tail = tail * z.hi + 1.0 / 17.0;
    tail = tail * z.hi + 1.0 / 15.0;
    tail = tail * z.hi + 1.0 / 13.0;
    tail = tail * z.hi + 1.0 / 11.0;
    dd sum = dd_add_double((dd){0x1.c71c71c71c71cp-4, 0x1.c71c71c71c71cp-58}, tail * z.hi); /* 1/9 */
    sum = dd_add(dd_mul(sum, z), (dd){0x1.2492492492492p-3, 0x1.2492492492492p-57});        /* 1/7 */
    sum = dd_add(dd_mul(sum, z), (dd){0x1.999999999999ap-3, -0x1.999999999999ap-57});       /* 1/5 */
    sum = dd_add(dd_mul(sum, z), (dd){0x1.5555555555555p-2, 0x1.5555555555555p-56});        /* 1/3 */
    const dd twice_s = {2.0 * s.hi, 2.0 * s.lo};
    const dd log_m = dd_add(twice_s, dd_mul(twice_s, dd_mul(sum, z)));
    if (exponent == 0)
        return log_m;
    return dd_add(dd_mul_double(dd_log2, (double)exponent), log_m);
}

/* e^x = value 2^k, value within [0.70, 1.42], |x.hi| <= 1000; relative error < 2^-75 for an exact x. */
static dd exp_dd(dd x, int *k)
{
    const double n = nearest(x.hi * 0x1.71547652b82fep+0); /* 1 / log 2 */
    *k = (int)n;
    /* log 2 in three parts, the first two of 32 bits, so that their products with n are exact. */
    const dd a = two_sum(x.hi, -(n * 0x1.62e42feep-1));
    const dd b = two_sum(a.hi, -(n * 0x1.a39ef356p-33));
    const dd r = quick_two_sum(b.hi, (b.lo + (a.lo + x.lo)) - n * 0x1.93c7673007e5fp-65);

    const dd u = {0.0625 * r.hi, 0.0625 * r.lo}; /* |u| < 0.0217 */
    double tail = 1.0 / 39916800.0;
    tail = tail * u.hi + 1.0 / 3628800.0;
    tail = tail * u.hi + 1.0 / 362880.0;
    tail = tail * u.hi + 1.0 / 40320.0;
    tail = tail * u.hi + 1.0 / 5040.0;
    tail = tail * u.hi + 1.0 / 720.0;
    tail = tail * u.hi + 1.0 / 120.0;
    dd sum = dd_add_double((dd){0x1.5555555555555p-5, 0x1.5555555555555p-59}, tail * u.hi); /* 1/24 */
    sum = dd_add(dd_mul(sum, u), (dd){0x1.5555555555555p-3, 0x1.5555555555555p-57});        /* 1/6 */
    sum = dd_add_double(dd_mul(sum, u), 0.5);
    sum = dd_add_double(dd_mul(sum, u), 1.0);
    dd p = dd_mul(sum, u);
    for (int i = 0; i < 4; i++)
        p = dd_add((dd){2.0 * p.hi, 2.0 * p.lo}, dd_mul(p, p));
    return dd_add_double(p, 1.0);
}

/* v 2^k rounded once, v within [0.5, 2]. */
static double scale_dd(dd v, int k)
{
    if (k > 1100)
        return plus_infinity();
    if (k > 1000)
        return v.hi * power_of_two(1000) * power_of_two(k - 1000);
    if (k > -1022 || (k == -1022 && v.hi >= 1.0))
        return v.hi * power_of_two(k);
    /*
     * Subnormal: v.hi is rounded already, and rounding it again would be wrong. One unit in the last place of 1 + v
     * 2^(k+1022) is the smallest subnormal, so this sum is rounded once. Its bits after the leading 1 are those of
     * the result, including a carry into the exponent field.
     */
    const int shift = k + 1022;
    if (shift < -60)
        return 0.0;
    const double f = power_of_two(shift);
    const dd s = quick_two_sum(1.0, v.hi * f);
    return from_bits(bits_of(s.hi + (s.lo + v.lo * f)) - bits_of(1.0));
}

double rheo__exp(double x)
{
    if (x != x)
        return not_a_number();
    if (x > 710.0)
        return plus_infinity();
    if (x < -746.0)
        return 0.0;
    int k;
    const dd v = exp_dd((dd){x, 0.0}, &k);
    return scale_dd(v, k);
}

double rheo__expm1(double x)
{
    if (x != x)
        return not_a_number();
    if (x > 710.0)
        return plus_infinity();
    if (x < -40.0)
        return -1.0;
    if (x > -0x1p-10 && x < 0x1p-10) {
        /* The series without its first term, which is exact. */
        double tail = 1.0 / 5040.0;
        tail = tail * x + 1.0 / 720.0;
        tail = tail * x + 1.0 / 120.0;
        tail = tail * x + 1.0 / 24.0;
        tail = tail * x + 1.0 / 6.0;
        tail = tail * x + 0.5;
        return x == 0.0 ? x : x + tail * x * x; /* -0 stays */
    }
    int k;
    const dd v = exp_dd((dd){x, 0.0}, &k);
    if (k > 900) /* 1 is below its last bit */
        return scale_dd(v, k);
    const double scale = power_of_two(k < -60 ? -60 : k);
    return dd_add_double((dd){v.hi * scale, v.lo * scale}, -1.0).hi;
}

double rheo__ln(double x)
{
    if (x == 0.0)
        return -plus_infinity();
    if (!(x > 0.0))
        return not_a_number();
    if (x > DBL_MAX)
        return plus_infinity();
    return log_dd(x).hi;
}

double rheo__pow(double x, double y)
{
    if (y == 0.0 || x == 1.0)
        return 1.0;
    if (!(x >= 0.0) || y != y)
        return not_a_number();
    if (x == 0.0 || x > DBL_MAX)
        return (x == 0.0) == (y > 0.0) ? 0.0 : plus_infinity();
    /* |log x| lies between 2^-54 and 745: beyond these the result has overflowed, underflowed or is 1. */
    if (y > 0x1p70 || y < -0x1p70)
        return (x > 1.0) == (y > 0.0) ? plus_infinity() : 0.0;
    if (y > -0x1p-70 && y < 0x1p-70)
        return 1.0;
    const dd e = dd_mul_double(log_dd(x), y);
    if (e.hi > 710.0)
        return plus_infinity();
    if (e.hi < -746.0)
        return 0.0;
    int k;
    const dd v = exp_dd(e, &k);
    return scale_dd(v, k);
}

double rheo__gamma(double x)
{
    if (x != x || bits_of(x) >> 63)
        return not_a_number();
    if (x > 172.0)
        return plus_infinity();
    if (x < 0x1p-70) /* 1/x - 0.577..., the second term far below half a unit of the first */
        return x == 0.0 ? plus_infinity() : 1.0 / x;

    dd z = {x, 0.0};
    dd product = {1.0, 0.0};
    while (z.hi < 20.0) {
        product = dd_mul(product, z);
        z = dd_add_double(z, 1.0);
    }

    /*
     * log Gamma(z) = (z - 1/2) log z - z + log(2 pi)/2 + 1/(12 z) - 1/(360 z^3) + ..., with the terms
     * B_2k / (2k (2k-1) z^(2k-1)). Ten terms suffice: the next is below 1e-26 at z = 20.
     */
    const dd inverse = dd_div((dd){1.0, 0.0}, z);
    const dd w = dd_mul(inverse, inverse);
    double tail = -174611.0 / 125400.0;
    tail = tail * w.hi + 43867.0 / 244188.0;
    tail = tail * w.hi - 3617.0 / 122400.0;
    tail = tail * w.hi + 1.0 / 156.0;
    tail = tail * w.hi - 691.0 / 360360.0;
    tail = tail * w.hi + 1.0 / 1188.0;
    tail = tail * w.hi - 1.0 / 1680.0;
    tail = tail * w.hi + 1.0 / 1260.0;
    dd sum = dd_add_double((dd){-0x1.6c16c16c16c17p-9, 0x1.f49f49f49f49fp-64}, tail * w.hi); /* -1/360 */
    sum = dd_add(dd_mul(sum, w), (dd){0x1.5555555555555p-4, 0x1.5555555555555p-58});         /* 1/12 */
    sum = dd_mul(sum, inverse);

    dd log_z = log_dd(z.hi);
    log_z = dd_add_double(log_z, z.lo / z.hi); /* the next term of log(1 + lo/hi) is below 2^-107 */
    dd e = dd_mul(dd_add_double(z, -0.5), log_z);
    e = dd_add(e, (dd){-z.hi, -z.lo});
    e = dd_add(dd_add(e, dd_half_log_two_pi), sum);

    int k;
    dd v = exp_dd(e, &k);
    /* The product lies between 2^-14 and 2^62: bring the quotient near 1 before scaling. */
    v = dd_div(v, product);
    const int shift = (int)(bits_of(v.hi) >> 52) - 1023;
    const double f = power_of_two(-shift);
    return scale_dd((dd){v.hi * f, v.lo * f}, k + shift);
}

/* sin a and cos a, |a| <= pi/4. */
static dd sin_octant(dd a)
{
    const dd z = dd_mul(a, a);                        /* <= 0.617 */
    double tail = 1.0 / 15511210043330985984000000.0; /* 1/25! */
    tail = tail * z.hi - 1.0 / 25852016738884976640000.0;
    tail = tail * z.hi + 1.0 / 51090942171709440000.0;
    tail = tail * z.hi - 1.0 / 121645100408832000.0;
    tail = tail * z.hi + 1.0 / 355687428096000.0;
    tail = tail * z.hi - 1.0 / 1307674368000.0;
    tail = tail * z.hi + 1.0 / 6227020800.0;
    tail = tail * z.hi - 1.0 / 39916800.0;
    tail = tail * z.hi + 1.0 / 362880.0;
    dd sum = dd_add_double((dd){-0x1.a01a01a01a01ap-13, -0x1.a01a01a01a01ap-73}, tail * z.hi); /* -1/7! */
    sum = dd_add(dd_mul(sum, z), (dd){0x1.1111111111111p-7, 0x1.1111111111111p-63});           /* 1/5! */
    sum = dd_add(dd_mul(sum, z), (dd){-0x1.5555555555555p-3, -0x1.5555555555555p-57});         /* -1/3! */
    return dd_add(a, dd_mul(a, dd_mul(sum, z)));
}

static dd cos_octant(dd a)
{
    const dd z = dd_mul(a, a);
    double tail = 1.0 / 620448401733239439360000.0; /* 1/24! */
    tail = tail * z.hi - 1.0 / 1124000727777607680000.0;
    tail = tail * z.hi + 1.0 / 2432902008176640000.0;
    tail = tail * z.hi - 1.0 / 6402373705728000.0;
    tail = tail * z.hi + 1.0 / 20922789888000.0;
    tail = tail * z.hi - 1.0 / 87178291200.0;
    tail = tail * z.hi + 1.0 / 479001600.0;
    tail = tail * z.hi - 1.0 / 3628800.0;
    tail = tail * z.hi + 1.0 / 40320.0;
    dd sum = dd_add_double((dd){-0x1.6c16c16c16c17p-10, 0x1.f49f49f49f49fp-65}, tail * z.hi); /* -1/6! */
    sum = dd_add(dd_mul(sum, z), (dd){0x1.5555555555555p-5, 0x1.5555555555555p-59});          /* 1/4! */
    sum = dd_add_double(dd_mul(sum, z), -0.5);
    return dd_add_double(dd_mul(sum, z), 1.0);
}

/* sin(2 pi t) advanced by `quarters` quarter turns. */
static double sine(double t, unsigned quarters)
{
    if (!(t > -0x1p48 && t < 0x1p48))
        return not_a_number();
    const double n = nearest(4.0 * t);
    const double r = t - 0.25 * n; /* exact */
    quarters += (unsigned)((int64_t)n & 3);
    double result;
    if (quarters & 1)
        result = cos_octant(dd_mul_double(dd_two_pi, r)).hi;
    else if (r > -0x1p-300 && r < 0x1p-300) /* sin a = a; scaled, as the low parts would underflow */
        result = dd_mul_double(dd_two_pi, r * 0x1p600).hi * 0x1p-600;
    else
        result = sin_octant(dd_mul_double(dd_two_pi, r)).hi;
    if (quarters & 2)
        result = -result;
    return result + 0.0; /* -0 becomes +0 */
}

double rheo__sin_turns(double t)
{
    return sine(t, 0);
}

double rheo__cos_turns(double t)
{
    return sine(t, 1);
}
