/* Each call of a kernel goes to its form for the target in use (core/target.h). */
#include "melting/kernels.h"

static const struct {
    rheo_fill_rows_function *fill_rows;
    rheo_melting_stage *summation, *momentum, *viscous, *rates;
} FOR[] = {
#define X(target)                                                                          \
    {rheo_fill_rows_##target, rheo_stage_summation_##target, rheo_stage_momentum_##target, \
     rheo_stage_viscous_##target, rheo_stage_rates_##target},
    RHEO_TARGETS(X)
#undef X
};

void rheo_fill_rows(rheo_melting *m)
{
    FOR[rheo_target_in_use()].fill_rows(m);
}

rheo_result rheo_stage_summation(rheo_state *s, void *context)
{
    return FOR[rheo_target_in_use()].summation(s, context);
}

rheo_result rheo_stage_momentum(rheo_state *s, void *context)
{
    return FOR[rheo_target_in_use()].momentum(s, context);
}

rheo_result rheo_stage_viscous(rheo_state *s, void *context)
{
    return FOR[rheo_target_in_use()].viscous(s, context);
}

rheo_result rheo_stage_rates(rheo_state *s, void *context)
{
    return FOR[rheo_target_in_use()].rates(s, context);
}
