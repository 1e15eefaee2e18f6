/* Each call of a stage that is a kernel goes to its form for the target in use (core/target.h). */
#include "thickening/kernels.h"

static const struct {
    rheo_stage_function *viscosity, *springs, *fractional_derivative, *fractional_derivative_modes,
        *spring_displacement, *density;
    rheo_remember_function *remember;
} FOR[] = {
#define X(target)                                     \
    {rheo_stage_viscosity_##target,                   \
     rheo_stage_springs_##target,                     \
     rheo_stage_fractional_derivative_##target,       \
     rheo_stage_fractional_derivative_modes_##target, \
     rheo_stage_spring_displacement_##target,         \
     rheo_stage_density_##target,                     \
     rheo_remember_##target},
    RHEO_TARGETS(X)
#undef X
};

rheo_result rheo_stage_viscosity(rheo_state *s, void *context)
{
    return FOR[rheo_target_in_use()].viscosity(s, context);
}

rheo_result rheo_stage_springs(rheo_state *s, void *context)
{
    return FOR[rheo_target_in_use()].springs(s, context);
}

rheo_result rheo_stage_fractional_derivative(rheo_state *s, void *context)
{
    return FOR[rheo_target_in_use()].fractional_derivative(s, context);
}

rheo_result rheo_stage_fractional_derivative_modes(rheo_state *s, void *context)
{
    return FOR[rheo_target_in_use()].fractional_derivative_modes(s, context);
}

rheo_result rheo_stage_spring_displacement(rheo_state *s, void *context)
{
    return FOR[rheo_target_in_use()].spring_displacement(s, context);
}

rheo_result rheo_stage_density(rheo_state *s, void *context)
{
    return FOR[rheo_target_in_use()].density(s, context);
}

void rheo_remember(rheo_state *s, const rheo_thickening *t, uint64_t rows)
{
    if (t->kind != RHEO_HISTORY_WINDOW)
        FOR[rheo_target_in_use()].remember(s, t, rows);
    if (s->ring.length)
        rheo_ring_push(&s->ring, s->particles, s->velocity);
    else
        rheo_ring_write(&s->modes, s->particles, 0, s->velocity);
}
