/* Scans of whole fields, many values at a time. Their results do not depend on the order of the values. */
#ifndef RHEO__CORE_SCANS_H
#define RHEO__CORE_SCANS_H

#include <stddef.h>

#include "core/real.h"
#include "core/simd.h"

/* Whether one of the values is NaN or infinite. */
typedef bool rheo__any_not_finite_function(const rheo_real *value, size_t count);
RHEO__DECLARE_VARIANTS(rheo__any_not_finite_function, any_not_finite)

/* The square of the largest length among `count` triples; 0 if there is none. Lengths that are NaN do not count. */
typedef rheo_real rheo__largest_length2_function(const rheo_real *triple, size_t count);
RHEO__DECLARE_VARIANTS(rheo__largest_length2_function, largest_length2)

#endif
