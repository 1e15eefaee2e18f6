/* Each call of a kernel goes to its form for the target in use (core/simd.h). */
#include "melting/dispatch.h"

static const struct {
    rheo__fill_rows_function *fill_rows;
    rheo__melting_stage *summation, *momentum, *viscous, *rates;
} FOR[] = {
#define X(target)                                                                             \
    {rheo__fill_rows_##target, rheo__stage_summation_##target, rheo__stage_momentum_##target, \
     rheo__stage_viscous_##target, rheo__stage_rates_##target},
    RHEO__SIMD_VARIANTS(X)
#undef X
};

void rheo__fill_rows(rheo__melting *m)
{
    FOR[rheo__simd_in_use()].fill_rows(m);
}

rheo_result rheo__stage_summation(rheo__state *s, void *context)
{
    return FOR[rheo__simd_in_use()].summation(s, context);
}

rheo_result rheo__stage_momentum(rheo__state *s, void *context)
{
    return FOR[rheo__simd_in_use()].momentum(s, context);
}

rheo_result rheo__stage_viscous(rheo__state *s, void *context)
{
    return FOR[rheo__simd_in_use()].viscous(s, context);
}

rheo_result rheo__stage_rates(rheo__state *s, void *context)
{
    return FOR[rheo__simd_in_use()].rates(s, context);
}
