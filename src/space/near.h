/* Which particles are near a point: a test of many at a time, since most are not. */
#ifndef RHEO__SPACE_NEAR_H
#define RHEO__SPACE_NEAR_H

#include "core/real.h"
#include "core/simd.h"

enum { RHEO__NEAR_AT_ONCE = 64 };

/*
 * Set of the particles (bit i: particle i) whose squared distance from `centre` is less than reach2. position: 3 values
 * each; count: at most RHEO__NEAR_AT_ONCE.
 */
typedef uint64_t rheo__near_function(const rheo_real *position, uint32_t count, const rheo_real centre[3],
                                     rheo_real reach2);
RHEO__DECLARE_VARIANTS(rheo__near_function, near)

#endif
