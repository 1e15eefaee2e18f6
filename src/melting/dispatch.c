/* Calls of SIMD functions, passed on to the variant in use (core/stage.h). */
#include "melting/melting.h"

RHEO__MELTING_SIMD_STAGES(RHEO__DEFINE_SIMD_STAGE)

void rheo__fill_rows(rheo__melting *m)
{
    static rheo__fill_rows_function *const variants[] = RHEO__ALL_VARIANTS(fill_rows);
    variants[rheo__simd_in_use()](m);
}
