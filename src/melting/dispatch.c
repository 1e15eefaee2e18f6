/* Calls of SIMD functions, passed on to the variant in use (core/stage.h). */
#include "melting/melting.h"

#define STAGE(...)
#define SIMD_STAGE(name, function, ...) RHEO__DEFINE_SIMD_STAGE(function)
#define SOLIDS_STAGE(...)
#define END_SUBSTEPS()
#include "melting/stages.def"

void rheo__find_kernels(rheo__melting *m)
{
    static rheo__find_kernels_function *const variants[] = RHEO__ALL_VARIANTS(find_kernels);
    variants[rheo__simd_in_use()](m);
}

void rheo__fill_rows(rheo__melting *m)
{
    static rheo__fill_rows_function *const variants[] = RHEO__ALL_VARIANTS(fill_rows);
    variants[rheo__simd_in_use()](m);
}
