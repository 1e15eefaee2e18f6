/*
 * Kernels, the loops that a step spends its time in, are built once for each target that a build can have: the same
 * sources compiled with other numbers of lanes and for other instruction sets, the names told apart by their ends.
 * Each result comes from the same IEEE operations in the same order, so the targets give the same bits; which one
 * runs is chosen when the program runs (core/target.c).
 *
 *     scalar     one lane: plain arithmetic, no vector types; what the others are tested against
 *     portable   four lanes in the vector types of GCC and Clang: SSE2, NEON, wasm SIMD, or what the compiler makes
 * of it avx2       eight lanes (four of double) avx512     sixteen lanes (eight of double)
 *
 * A build with the option lanes=scalar has the scalar target alone.
 */
#ifndef RHEO_CORE_TARGET_H
#define RHEO_CORE_TARGET_H

#include "rheolog/base.h"

/* name, whether this machine can run it. */
#if defined(RHEO_SCALAR_ALONE)
#define RHEO_TARGETS(X) X(scalar)
#elif defined(RHEO_X86_TARGETS)
#define RHEO_TARGETS(X) X(scalar) X(portable) X(avx2) X(avx512)
#else
#define RHEO_TARGETS(X) X(scalar) X(portable)
#endif

typedef enum rheo_target {
#define X(name) RHEO_TARGET_##name,
    RHEO_TARGETS(X)
#undef X
        RHEO_TARGET_COUNT
} rheo_target;

/* The one in use: the best that this machine can run, until another is chosen. */
rheo_target rheo_target_in_use(void);

/* The name of a function of this target: RHEO_KERNEL(stage_density) is rheo_stage_density_avx2 in sources built for
 * avx2. */
#define RHEO_JOIN_(name, target) rheo_##name##_##target
#define RHEO_JOIN(name, target) RHEO_JOIN_(name, target)
#define RHEO_KERNEL(name) RHEO_JOIN(name, RHEO_BUILT_FOR)

#endif
