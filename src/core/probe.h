/* Probes of the floating-point environment (core/probe.c), one for each target that kernels are built for. */
#ifndef RHEO_CORE_PROBE_H
#define RHEO_CORE_PROBE_H

#include "core/target.h"

/* What is unfit: a set. */
typedef enum rheo_trouble {
    RHEO_TROUBLE_ROUNDING = 1,
    RHEO_TROUBLE_DENORMALS = 2,
    RHEO_TROUBLE_CONTRACTED = 4,
    RHEO_TROUBLE_REORDERED = 8,
    RHEO_TROUBLE_RECIPROCALS = 16,
    RHEO_TROUBLE_ROOTS = 32,
    RHEO_TROUBLE_ZEROS = 64,
    RHEO_TROUBLE_INFINITIES = 128,
    RHEO_TROUBLE_VECTORS = 256 /* denormals are flushed in vectors alone */
} rheo_trouble;

#define X(target) unsigned rheo_probe_##target(void);
RHEO_TARGETS(X)
#undef X

#endif
