/*
 * SIMD variants. The loops that take most of a step's time are compiled once for each variant: the same sources, with
 * another number of lanes and for another instruction set. A suffix tells their functions apart. Each result comes
 * from the same IEEE operations in the same order, so all variants give the same bits. core/simd.c chooses the
 * variant when the program runs.
 *
 *     scalar     1 lane: plain arithmetic, no vector types; the reference for the others
 *     portable   4 lanes in the vector types of GCC and Clang: SSE2, NEON, WebAssembly SIMD or plain code
 *     avx2       8 lanes (4 of double)
 *     avx512     16 lanes (8 of double)
 *
 * A build with the option lanes=scalar has the variant scalar only. One further variant, `account`, is compiled as
 * scalar and also notes what it adds to one particle (core/account.h); it is in use only while that is asked for.
 */
#ifndef RHEO__CORE_SIMD_H
#define RHEO__CORE_SIMD_H

#include "rheolog/base.h"

/* X(variant, further arguments), slowest variant first. */
#if defined(RHEO__SCALAR_ALONE)
#define RHEO__SIMD_VARIANTS(X, ...) X(scalar, __VA_ARGS__)
#elif defined(RHEO__X86_VARIANTS)
#define RHEO__SIMD_VARIANTS(X, ...) \
    X(scalar, __VA_ARGS__) X(portable, __VA_ARGS__) X(avx2, __VA_ARGS__) X(avx512, __VA_ARGS__)
#else
#define RHEO__SIMD_VARIANTS(X, ...) X(scalar, __VA_ARGS__) X(portable, __VA_ARGS__)
#endif

typedef enum rheo__simd_variant {
#define X(variant, prefix) prefix##variant,
    RHEO__SIMD_VARIANTS(X, RHEO__SIMD_)
#undef X
        RHEO__SIMD_COUNT
} rheo__simd_variant;

/* The variant in use: the fastest that this machine can run, until rheo_use_simd() chooses another. */
rheo__simd_variant rheo__simd_in_use(void);

/*
 * Name of a function of the variant that is being compiled: RHEO__VARIANT(stage_density) is rheo__stage_density_avx2
 * in sources compiled for avx2.
 */
#define RHEO__JOIN_(name, variant) rheo__##name##_##variant
#define RHEO__JOIN(name, variant) RHEO__JOIN_(name, variant)
#define RHEO__VARIANT(name) RHEO__JOIN(name, RHEO__SIMD_VARIANT)

#define RHEO__DECLARE_VARIANT(variant, type, name) type rheo__##name##_##variant;
#define RHEO__ADDRESS_OF_VARIANT(variant, name) rheo__##name##_##variant,
/* Of functions that take constants: each call is compiled for its case, however long the function is. */
#define RHEO__FOR_EACH_CASE static inline __attribute__((always_inline))
/* Declares the variants of a function of this function type; the variant `account` keeps accounts (core/account.h). */
#define RHEO__DECLARE_VARIANTS(type, name)                 \
    RHEO__SIMD_VARIANTS(RHEO__DECLARE_VARIANT, type, name) \
    RHEO__DECLARE_VARIANT(account, type, name)
/* Initialises an array of pointers to them, whose index is rheo__simd_in_use(). */
#define RHEO__ALL_VARIANTS(name)                            \
    {                                                       \
        RHEO__SIMD_VARIANTS(RHEO__ADDRESS_OF_VARIANT, name) \
    }

#endif
