/* Which of the targets that the kernels are built for is in use (core/target.h). */
#include "core/target.h"

#include <stdio.h>
#include <string.h>

#include "core/error.h"

static const char *const NAME[] = {
#define X(name) #name,
    RHEO_TARGETS(X)
#undef X
};

static bool machine_runs(rheo_target target)
{
#ifdef RHEO_X86_TARGETS
    if (target == RHEO_TARGET_avx2)
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt");
    if (target == RHEO_TARGET_avx512)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
               __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
               __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt");
#endif
    (void)target;
    return true;
}

/* Chosen by nobody yet. Several threads that find the best one at once find the same. */
static int in_use = -1;

rheo_target rheo_target_in_use(void)
{
    if (in_use < 0) {
        int best = RHEO_TARGET_COUNT - 1;
        while (best > 0 && !machine_runs((rheo_target)best))
            best--;
        in_use = best;
    }
    return (rheo_target)in_use;
}

const char *rheo_kernels(void)
{
    return NAME[rheo_target_in_use()];
}

const char *rheo_kernels_available(uint32_t index)
{
    for (int target = 0; target < RHEO_TARGET_COUNT; target++)
        if (machine_runs((rheo_target)target) && index-- == 0)
            return NAME[target];
    return NULL;
}

rheo_result rheo_use_kernels(const char *name, rheo_error *error)
{
    char available[128] = "";
    for (int target = 0; target < RHEO_TARGET_COUNT; target++) {
        if (!machine_runs((rheo_target)target))
            continue;
        if (strcmp(name, NAME[target]) == 0) {
            in_use = target;
            return RHEO_OK;
        }
        size_t length = strlen(available);
        snprintf(available + length, sizeof available - length, "%s%s", length ? ", " : "", NAME[target]);
    }
    return rheo_fail(error, RHEO_ERROR_ARGUMENT, "no kernels called '%s' on this machine: there are %s", name,
                     available);
}
