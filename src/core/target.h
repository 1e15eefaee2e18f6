/*
 * Kernels for processors that have AVX2, chosen at run time: the default build asks for no more than SSE2.
 * Such a kernel has wider vectors, and moves numbers between lanes as SSE2 cannot; each result comes from the
 * same IEEE operations in the same order as in the portable twin beside it, which all other machines run (and
 * all machines if RHEO_PLAIN_LANES is defined).
 */
#ifndef RHEO_CORE_TARGET_H
#define RHEO_CORE_TARGET_H

#include "rheolog/base.h"

#if defined(__x86_64__) && defined(__GNUC__) && !RHEO_DOUBLE && !defined(RHEO_PLAIN_LANES)
#define RHEO_AVX2 __attribute__((target("avx2,popcnt")))

static inline bool rheo_has_avx2(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt");
}
#endif

#endif
