/* Probes of the floating-point environment (core/probe.c), one for each SIMD variant. */
#ifndef RHEO__CORE_PROBE_H
#define RHEO__CORE_PROBE_H

#include "core/simd.h"

/* Faults of the environment: a set. */
typedef enum rheo__trouble {
    RHEO__TROUBLE_ROUNDING = 1,
    RHEO__TROUBLE_DENORMALS = 2,
    RHEO__TROUBLE_CONTRACTED = 4,
    RHEO__TROUBLE_REORDERED = 8,
    RHEO__TROUBLE_RECIPROCALS = 16,
    RHEO__TROUBLE_ROOTS = 32,
    RHEO__TROUBLE_ZEROS = 64,
    RHEO__TROUBLE_INFINITIES = 128,
    RHEO__TROUBLE_VECTORS = 256 /* denormals are flushed in vectors only */
} rheo__trouble;

typedef unsigned rheo__probe_function(void);
RHEO__DECLARE_VARIANTS(rheo__probe_function, probe)

#endif
