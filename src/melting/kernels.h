/* The functions of the model that are kernels, in their forms for each target (core/target.h). */
#ifndef RHEO_MELTING_KERNELS_H
#define RHEO_MELTING_KERNELS_H

#include "core/target.h"
#include "melting/melting.h"

typedef rheo_result rheo_melting_stage(rheo_state *s, void *context);
typedef void rheo_fill_rows_function(rheo_melting *m);

#define X(target)                                     \
    rheo_fill_rows_function rheo_fill_rows_##target;  \
    rheo_melting_stage rheo_stage_summation_##target; \
    rheo_melting_stage rheo_stage_momentum_##target;  \
    rheo_melting_stage rheo_stage_viscous_##target;   \
    rheo_melting_stage rheo_stage_rates_##target;
RHEO_TARGETS(X)
#undef X

/* Fills m->rows, which have room, from m->list and m->position. */
void rheo_fill_rows(rheo_melting *m);

#endif
