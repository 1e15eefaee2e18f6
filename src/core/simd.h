/*
 * Kernels, the loops that a step spends its time in, are built once for each target that a build can have: the same
 * sources compiled with other numbers of lanes and for other instruction sets, the names told apart by their ends.
 * Each result comes from the same IEEE operations in the same order, so the targets give the same bits; which one
 * runs is chosen when the program runs (core/simd.c).
 *
 *     scalar     one lane: plain arithmetic, no vector types; what the others are tested against
 *     portable   four lanes in the vector types of GCC and Clang: SSE2, NEON, wasm SIMD, or what the compiler makes
 * of it avx2       eight lanes (four of double) avx512     sixteen lanes (eight of double)
 *
 * A build with the option lanes=scalar has the scalar target alone.
 */
#ifndef RHEO__CORE_TARGET_H
#define RHEO__CORE_TARGET_H

#include "rheolog/base.h"

/* name, whether this machine can run it. */
#if defined(RHEO__SCALAR_ALONE)
#define RHEO__SIMD_VARIANTS(X) X(scalar)
#elif defined(RHEO__X86_VARIANTS)
#define RHEO__SIMD_VARIANTS(X) X(scalar) X(portable) X(avx2) X(avx512)
#else
#define RHEO__SIMD_VARIANTS(X) X(scalar) X(portable)
#endif

typedef enum rheo__simd_variant {
#define X(name) RHEO__SIMD_##name,
    RHEO__SIMD_VARIANTS(X)
#undef X
        RHEO__SIMD_COUNT
} rheo__simd_variant;

/* The one in use: the best that this machine can run, until another is chosen. */
rheo__simd_variant rheo__simd_in_use(void);

/* The name of a function of this target: RHEO__VARIANT(stage_density) is rheo__stage_density_avx2 in sources built for
 * avx2. */
#define RHEO__JOIN_(name, target) rheo__##name##_##target
#define RHEO__JOIN(name, target) RHEO__JOIN_(name, target)
#define RHEO__VARIANT(name) RHEO__JOIN(name, RHEO__SIMD_VARIANT)

#endif
