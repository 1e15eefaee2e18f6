/* The functions of the model that are kernels, in their forms for each target (core/target.h). */
#ifndef RHEO_THICKENING_KERNELS_H
#define RHEO_THICKENING_KERNELS_H

#include "core/target.h"
#include "thickening/thickening.h"

typedef rheo_result rheo_stage_function(rheo_state *s, void *context);
typedef void rheo_remember_function(rheo_state *s, const rheo_thickening *t, uint64_t rows);

#define X(target)                                                        \
    rheo_stage_function rheo_stage_viscosity_##target;                   \
    rheo_stage_function rheo_stage_springs_##target;                     \
    rheo_stage_function rheo_stage_fractional_derivative_##target;       \
    rheo_stage_function rheo_stage_fractional_derivative_modes_##target; \
    rheo_stage_function rheo_stage_spring_displacement_##target;         \
    rheo_stage_function rheo_stage_density_##target;                     \
    rheo_remember_function rheo_remember_##target;
RHEO_TARGETS(X)
#undef X

#endif
