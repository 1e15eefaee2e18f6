/* The functions of the model that are kernels, in their forms for each target (core/simd.h). */
#ifndef RHEO__THICKENING_KERNELS_H
#define RHEO__THICKENING_KERNELS_H

#include "core/simd.h"
#include "thickening/thickening.h"

typedef rheo_result rheo__stage_function(rheo__state *s, void *context);
typedef void rheo__remember_function(rheo__state *s, const rheo__thickening *t, uint64_t rows);

#define X(target)                                                          \
    rheo__stage_function rheo__stage_viscosity_##target;                   \
    rheo__stage_function rheo__stage_springs_##target;                     \
    rheo__stage_function rheo__stage_fractional_derivative_##target;       \
    rheo__stage_function rheo__stage_fractional_derivative_modes_##target; \
    rheo__stage_function rheo__stage_spring_displacement_##target;         \
    rheo__stage_function rheo__stage_density_##target;                     \
    rheo__remember_function rheo__remember_##target;
RHEO__SIMD_VARIANTS(X)
#undef X

#endif
