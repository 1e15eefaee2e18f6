/*
 * The quintic spline (Morris, Fox, Zhu, 1997), the smoothing kernel of the melting model and of surfaces:
 * W(r) = w(q)/(120 pi h^3), q = r/h, with
 *
 *     w(q)    = (3-q)^5 - 6 (2-q)^5 + 15 (1-q)^5,   each term only where its base is positive
 *     w''(q)  = 20 (3-q)^3 - 120 (2-q)^3 + 300 (1-q)^3
 *     w'(q)/q = -120 + 120 q^2 - 50 q^3             for q < 1, so that there is no 0/0
 *
 * Files that define RHEO__LANES also get the forms in lanes. Those multiply in another order than the forms in
 * double; results depend on both orders.
 */
#ifndef RHEO__CORE_QUINTIC_H
#define RHEO__CORE_QUINTIC_H

#include "core/strict.h"

#define RHEO__QUINTIC_AT_0 66 /* w(0) */

static inline double rheo__fourth_power_of_positive(double x)
{
    x = x > 0 ? x : 0;
    return x * x * x * x;
}
static inline double rheo__fifth_power_of_positive(double x)
{
    x = x > 0 ? x : 0;
    return x * x * x * x * x;
}

/* w(q) */
static inline double rheo__quintic(double q)
{
    return rheo__fifth_power_of_positive(3 - q) - 6 * rheo__fifth_power_of_positive(2 - q) +
           15 * rheo__fifth_power_of_positive(1 - q);
}

/* w(q) by squaring, in the order of the form in lanes: faster in loops that compilers turn into vectors. */
static inline double rheo__quintic_by_squares(double q)
{
    const double a = q < 3 ? 3 - q : 0, b = q < 2 ? 2 - q : 0, c = q < 1 ? 1 - q : 0;
    return a * a * (a * a) * a - 6 * (b * b * (b * b) * b) + 15 * (c * c * (c * c) * c);
}

/* w'(q)/q */
static inline double rheo__quintic_slope(double q)
{
    if (q < 1)
        return -120 + 120 * q * q - 50 * q * q * q;
    return -5 * (rheo__fourth_power_of_positive(3 - q) - 6 * rheo__fourth_power_of_positive(2 - q)) / q;
}

#ifdef RHEO__LANES

#include "core/lanes.h"

static inline rheo__lanes rheo__lanes_positive(rheo__lanes x)
{
    return rheo__lanes_max(x, rheo__lanes_all(0));
}

/* Returns w(q); *slope becomes w'(q)/q. */
static inline rheo__lanes rheo__lanes_quintic(rheo__lanes q, rheo__lanes *slope)
{
    const rheo__lanes a = rheo__lanes_positive(3 - q), b = rheo__lanes_positive(2 - q),
                      c = rheo__lanes_positive(1 - q);
    const rheo__lanes a2 = a * a, b2 = b * b, c2 = c * c, a4 = a2 * a2, b4 = b2 * b2, c4 = c2 * c2, q2 = q * q;
    const rheo__lanes inner = 120 * q2 - 50 * q2 * q - 120, outer = (30 * b4 - 5 * a4) / q;
    *slope = rheo__lanes_if_less(q, rheo__lanes_all(1), inner, outer);
    return a4 * a - 6 * (b4 * b) + 15 * (c4 * c);
}

/* w''(q) */
static inline rheo__lanes rheo__lanes_quintic_second(rheo__lanes q)
{
    const rheo__lanes a = rheo__lanes_positive(3 - q), b = rheo__lanes_positive(2 - q),
                      c = rheo__lanes_positive(1 - q);
    return 20 * (a * a * a) - 120 * (b * b * b) + 300 * (c * c * c);
}

#endif
#endif
