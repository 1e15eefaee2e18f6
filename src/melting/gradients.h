/*
 * Corrected gradients and pair factors (gradients.c), within one SIMD variant. Used by stage momentum, and by stage
 * gradients where no stage momentum precedes the rates. Stage momentum has its own sum made in the same loop.
 */
#ifndef RHEO__MELTING_GRADIENTS_H
#define RHEO__MELTING_GRADIENTS_H

#include "melting/kernels.h"
#include "melting/pressure.h"

/* The sums that a stage needs, and its position in the list of contacts. */
typedef struct rheo__gradients {
    bool velocity, temperature;
    const rheo__pressure *pressure; /* NULL: no accelerations */
    rheo_real mass, softening;      /* softening: 0.01 h^2 */
    rheo__lanes viscous_support2;
    bool finds_kernels; /* also in the loop over pairs */
    rheo__kernels kernels;
    uint32_t contact; /* first contact of the next block */
    RHEO__IN_ACCOUNT(const rheo__state *state; rheo__keeper keeper;)
} rheo__gradients;

/* Copies densities, velocities and temperatures to m->point. */
rheo__gradients RHEO__VARIANT(begin_gradients)(rheo__melting *m, bool velocity, bool temperature,
                                               const rheo__pressure *pressure);
/*
 * Finds, for the rows of a block, m->shear_rate and m->viscous_factor from m->velocity, m->heat_points from
 * m->temperature, and m->acceleration. Blocks in ascending order.
 */
void RHEO__VARIANT(find_gradients)(rheo__melting *m, rheo__gradients *of, uint32_t block);

#endif
