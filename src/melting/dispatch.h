/* The functions of the model that are kernels, in their forms for each target (core/simd.h). */
#ifndef RHEO__MELTING_KERNELS_H
#define RHEO__MELTING_KERNELS_H

#include "core/simd.h"
#include "melting/melting.h"

typedef rheo_result rheo__melting_stage(rheo__state *s, void *context);
typedef void rheo__fill_rows_function(rheo__melting *m);

#define X(target)                                       \
    rheo__fill_rows_function rheo__fill_rows_##target;  \
    rheo__melting_stage rheo__stage_summation_##target; \
    rheo__melting_stage rheo__stage_momentum_##target;  \
    rheo__melting_stage rheo__stage_viscous_##target;   \
    rheo__melting_stage rheo__stage_rates_##target;
RHEO__SIMD_VARIANTS(X)
#undef X

/* Fills m->rows, which have room, from m->list and m->position. */
void rheo__fill_rows(rheo__melting *m);

#endif
