/* The functions of the model that are kernels, in their forms for each target (core/target.h). */
#ifndef RHEO_THICKENING_KERNELS_H
#define RHEO_THICKENING_KERNELS_H

#include "core/target.h"
#include "thickening/thickening.h"

typedef rheo_result rheo_stage_function(rheo_state *s, void *context);
typedef void rheo_derivatives_function(const rheo_state *s, const rheo_thickening *t, rheo_real *derivative);
typedef void rheo_remember_function(rheo_state *s, const rheo_thickening *t, uint64_t rows);

#define X(target)                                                 \
    rheo_stage_function rheo_stage_viscosity_##target;            \
    rheo_stage_function rheo_stage_spring_displacement_##target;  \
    rheo_stage_function rheo_stage_density_##target;              \
    rheo_derivatives_function rheo_derivatives_##target;          \
    rheo_derivatives_function rheo_derivatives_of_modes_##target; \
    rheo_remember_function rheo_remember_##target;
RHEO_TARGETS(X)
#undef X

#endif
