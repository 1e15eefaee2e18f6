/* Each call of a stage that is a kernel goes to its form for the target in use (core/simd.h). */
#include "thickening/dispatch.h"

static const struct {
    rheo__stage_function *viscosity, *springs, *fractional_derivative, *fractional_derivative_modes,
        *spring_displacement, *density;
    rheo__remember_function *remember;
} FOR[] = {
#define X(target)                                      \
    {rheo__stage_viscosity_##target,                   \
     rheo__stage_springs_##target,                     \
     rheo__stage_fractional_derivative_##target,       \
     rheo__stage_fractional_derivative_modes_##target, \
     rheo__stage_spring_displacement_##target,         \
     rheo__stage_density_##target,                     \
     rheo__remember_##target},
    RHEO__SIMD_VARIANTS(X)
#undef X
};

rheo_result rheo__stage_viscosity(rheo__state *s, void *context)
{
    return FOR[rheo__simd_in_use()].viscosity(s, context);
}

rheo_result rheo__stage_springs(rheo__state *s, void *context)
{
    return FOR[rheo__simd_in_use()].springs(s, context);
}

rheo_result rheo__stage_fractional_derivative(rheo__state *s, void *context)
{
    return FOR[rheo__simd_in_use()].fractional_derivative(s, context);
}

rheo_result rheo__stage_fractional_derivative_modes(rheo__state *s, void *context)
{
    return FOR[rheo__simd_in_use()].fractional_derivative_modes(s, context);
}

rheo_result rheo__stage_spring_displacement(rheo__state *s, void *context)
{
    return FOR[rheo__simd_in_use()].spring_displacement(s, context);
}

rheo_result rheo__stage_density(rheo__state *s, void *context)
{
    return FOR[rheo__simd_in_use()].density(s, context);
}

void rheo__remember(rheo__state *s, const rheo__thickening *t, uint64_t rows)
{
    if (t->kind != RHEO_HISTORY_WINDOW)
        FOR[rheo__simd_in_use()].remember(s, t, rows);
    if (s->ring.length)
        rheo__ring_push(&s->ring, s->particles, s->velocity);
    else
        rheo__ring_write(&s->modes, s->particles, 0, s->velocity);
}
