/*
 * The quintic kernel of the paper in lanes, docs/melting.md (1): W(r) = scale w(q), q = r/h, with
 *
 *     w(q) = (3-q)^5 - 6 (2-q)^5 + 15 (1-q)^5,   each term only where its base is positive
 *
 * Its slope over q has no 0/0: for q < 1 the powers multiplied out give w'(q)/q = -120 + 120 q^2 - 50 q^3.
 */
#ifndef RHEO__MELTING_QUINTIC_H
#define RHEO__MELTING_QUINTIC_H

#include "core/lanes.h"

static inline rheo__lanes rheo__positive(rheo__lanes x)
{
    return rheo__lanes_keep(x > 0, x);
}

/* w(q), and w'(q)/q. */
static inline rheo__lanes rheo__quintic(rheo__lanes q, rheo__lanes *slope)
{
    const rheo__lanes a = rheo__positive(3 - q), b = rheo__positive(2 - q), c = rheo__positive(1 - q);
    const rheo__lanes a2 = a * a, b2 = b * b, c2 = c * c, a4 = a2 * a2, b4 = b2 * b2, c4 = c2 * c2, q2 = q * q;
    const rheo__lanes inner = 120 * q2 - 50 * q2 * q - 120, outer = (30 * b4 - 5 * a4) / q;
    *slope = rheo__lanes_select(q < 1, inner, outer);
    return a4 * a - 6 * (b4 * b) + 15 * (c4 * c);
}

/* The second derivative w''(q) = 20 (3-q)^3 - 120 (2-q)^3 + 300 (1-q)^3. */
static inline rheo__lanes rheo__quintic_second(rheo__lanes q)
{
    const rheo__lanes a = rheo__positive(3 - q), b = rheo__positive(2 - q), c = rheo__positive(1 - q);
    return 20 * (a * a * a) - 120 * (b * b * b) + 300 * (c * c * c);
}

#endif
