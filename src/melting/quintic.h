/*
 * The quintic kernel of the paper in lanes, docs/melting.md (1): W(r) = scale w(q), q = r/h, with
 *
 *     w(q) = (3-q)^5 - 6 (2-q)^5 + 15 (1-q)^5,   each term only where its base is positive
 *
 * Its slope over q has no 0/0: for q < 1 the powers multiplied out give w'(q)/q = -120 + 120 q^2 - 50 q^3.
 */
#ifndef RHEO_MELTING_QUINTIC_H
#define RHEO_MELTING_QUINTIC_H

#include "core/lanes.h"

static inline rheo_lanes rheo_positive(rheo_lanes x)
{
    return rheo_lanes_keep(x > 0, x);
}

/* w(q), and w'(q)/q. */
static inline rheo_lanes rheo_quintic(rheo_lanes q, rheo_lanes *slope)
{
    const rheo_lanes a = rheo_positive(3 - q), b = rheo_positive(2 - q), c = rheo_positive(1 - q);
    const rheo_lanes a2 = a * a, b2 = b * b, c2 = c * c, a4 = a2 * a2, b4 = b2 * b2, c4 = c2 * c2, q2 = q * q;
    const rheo_lanes inner = 120 * q2 - 50 * q2 * q - 120, outer = (30 * b4 - 5 * a4) / q;
    *slope = rheo_lanes_select(q < 1, inner, outer);
    return a4 * a - 6 * (b4 * b) + 15 * (c4 * c);
}

/* The second derivative w''(q) = 20 (3-q)^3 - 120 (2-q)^3 + 300 (1-q)^3. */
static inline rheo_lanes rheo_quintic_second(rheo_lanes q)
{
    const rheo_lanes a = rheo_positive(3 - q), b = rheo_positive(2 - q), c = rheo_positive(1 - q);
    return 20 * (a * a * a) - 120 * (b * b * b) + 300 * (c * c * c);
}

#endif
