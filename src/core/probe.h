/* Probes of the floating-point environment (core/probe.c), one for each target that kernels are built for. */
#ifndef RHEO__CORE_PROBE_H
#define RHEO__CORE_PROBE_H

#include "core/simd.h"

/* What is unfit: a set. */
typedef enum rheo__trouble {
    RHEO__TROUBLE_ROUNDING = 1,
    RHEO__TROUBLE_DENORMALS = 2,
    RHEO__TROUBLE_CONTRACTED = 4,
    RHEO__TROUBLE_REORDERED = 8,
    RHEO__TROUBLE_RECIPROCALS = 16,
    RHEO__TROUBLE_ROOTS = 32,
    RHEO__TROUBLE_ZEROS = 64,
    RHEO__TROUBLE_INFINITIES = 128,
    RHEO__TROUBLE_VECTORS = 256 /* denormals are flushed in vectors alone */
} rheo__trouble;

#define X(target) unsigned rheo__probe_##target(void);
RHEO__SIMD_VARIANTS(X)
#undef X

#endif
