/* Chooses the SIMD variant (core/simd.h). */
#include "core/simd.h"

#include <stdio.h>
#include <string.h>

#include "core/error.h"

static const char *const NAME[] = {
#define X(variant, suffix) #variant suffix,
    RHEO__SIMD_VARIANTS(X, "")
#undef X
};

static bool machine_runs(rheo__simd_variant variant)
{
#ifdef RHEO__X86_VARIANTS
    if (variant == RHEO__SIMD_avx2)
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt");
    if (variant == RHEO__SIMD_avx512)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
               __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
               __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt");
#endif
    (void)variant;
    return true;
}

/* -1: not chosen yet. Threads that choose at the same time choose the same variant. */
static int in_use = -1;

rheo__simd_variant rheo__simd_in_use(void)
{
    if (in_use < 0) {
        int best = RHEO__SIMD_COUNT - 1;
        while (best > 0 && !machine_runs((rheo__simd_variant)best))
            best--;
        in_use = best;
    }
    return (rheo__simd_variant)in_use;
}

const char *rheo_simd(void)
{
    return NAME[rheo__simd_in_use()];
}

const char *rheo_simd_available(uint32_t index)
{
    for (int variant = 0; variant < RHEO__SIMD_COUNT; variant++)
        if (machine_runs((rheo__simd_variant)variant) && index-- == 0)
            return NAME[variant];
    return NULL;
}

rheo_result rheo_use_simd(const char *name, rheo_error *error)
{
    char available[128] = "";
    for (int variant = 0; variant < RHEO__SIMD_COUNT; variant++) {
        if (!machine_runs((rheo__simd_variant)variant))
            continue;
        if (strcmp(name, NAME[variant]) == 0) {
            in_use = variant;
            return RHEO_OK;
        }
        size_t length = strlen(available);
        snprintf(available + length, sizeof available - length, "%s%s", length ? ", " : "", NAME[variant]);
    }
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "there is no SIMD variant \"%s\" on this machine; choose one of: %s", name, available);
}
