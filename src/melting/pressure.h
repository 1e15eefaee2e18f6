/*
 * The acceleration that a pair of particles adds in stage momentum (momentum.c), within one SIMD variant. The two
 * terms of a pair are opposite to the last bit.
 */
#ifndef RHEO__MELTING_PRESSURE_H
#define RHEO__MELTING_PRESSURE_H

#include "melting/rows.h"

typedef struct rheo__pressure {
    rheo_real mass, sound_speed, c2, rest_density, h;
    rheo_real alpha_c, beta, repulsion, inverse_range, range2;
    rheo_real gravity[3];
    bool artificial, printed; /* with artificial viscosity; Eq. 8 as printed in the paper */
} rheo__pressure;

/* p/rho^2 */
static inline rheo__lanes rheo__pressure_term(rheo__lanes density, const rheo__pressure *c)
{
    const rheo__lanes inverse = 1 / density;
    return c->c2 * (density - c->rest_density) * (inverse * inverse);
}

/* Repulsion over r of close pairs; 0 for coinciding ones, which have no direction. */
static inline rheo__lanes rheo__repulsion(rheo__lanes r2, const rheo__pressure *c)
{
    const rheo__lanes r = rheo__lanes_sqrt(r2), push = c->repulsion * (1 - r * c->inverse_range) / r;
    return rheo__lanes_keep((r2 < c->range2) & (r2 > 0), push);
}

/*
 * A pair: x_ij, r^2, 1/((r^2 + 0.01 h^2) (rho_i + rho_j)), v_ij.x_ij, slope, rho_i + rho_j, and
 * p_i/rho_i^2 + p_j/rho_j^2.
 */
typedef struct rheo__pair_state {
    rheo__lanes3 x;
    rheo__lanes r2, inverse, approach, slope, sum_of_densities, terms;
} rheo__pair_state;

/* Acceleration over x_ij. density: rho_i. */
static inline rheo__lanes rheo__pair_push(const rheo__pair_state *pair, rheo__lanes density, const rheo__pressure *c,
                                          bool artificial)
{
    rheo__lanes push = pair->terms;
    if (artificial) {
        /* mu (rho_i + rho_j), mu/(rho_i + rho_j) */
        const rheo__lanes sum = pair->sum_of_densities,
                          by_sum = c->h * rheo__lanes_min(pair->approach, rheo__lanes_all(0)) * pair->inverse;
        rheo__lanes viscous = (c->beta * (by_sum * sum) - c->alpha_c) * by_sum * 2;
        if (c->printed)
            viscous /= density;
        push += viscous;
    }
    push *= c->mass * -pair->slope;
    const rheo__mask close = (pair->r2 < c->range2) & (pair->r2 > 0);
    if (rheo__lanes_any(close))
        push += rheo__repulsion(pair->r2, c);
    return push;
}

#endif
