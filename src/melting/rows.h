/* Loops over the rows of blocks (melting/melting.h) in the lanes of a SIMD variant. */
#ifndef RHEO__MELTING_ROWS_H
#define RHEO__MELTING_ROWS_H

#include "melting/accounts.h"
#include "space/row_blocks.h"

enum { RHEO__AHEAD = 16 * RHEO__BLOCK_ROWS };
/*
 * Ask for the values of a later entry, so that a loop over entries does not wait for memory. It may be beyond the end
 * of the array. Short vectors read too little at a time to wait.
 */
static inline void rheo__fetch_partners(const uint32_t *partner, size_t entry)
{
    if (RHEO__VECTOR_BYTES >= 32)
        __builtin_prefetch((const void *)((uintptr_t)partner + (entry + RHEO__AHEAD) * sizeof *partner));
}
static inline void rheo__fetch_values(const rheo_real *values, size_t entry)
{
    if (RHEO__VECTOR_BYTES >= 32)
        __builtin_prefetch((const void *)((uintptr_t)values + (entry + RHEO__AHEAD) * sizeof *values));
}

/* Offsets x_i - x_j of an entry. Loading partners again costs less than memory for the offsets. */
static inline rheo__lanes3 rheo__offsets(const rheo__melting *m, rheo__lanes3 own, size_t entry)
{
    return rheo__lanes3_minus(own, rheo__lanes_load_narrow_at(m->point, m->rows.partner + entry));
}
static inline rheo__lanes3 rheo__lanes3_zero(void)
{
    const rheo__lanes zero = rheo__lanes_all(0);
    return (rheo__lanes3){zero, zero, zero};
}
static inline rheo__lanes rheo__lanes3_dot(rheo__lanes3 a, rheo__lanes3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline rheo__lanes3 rheo__lanes3_times(rheo__lanes by, rheo__lanes3 v)
{
    return (rheo__lanes3){by * v.x, by * v.y, by * v.z};
}
/* sum += by v */
static inline void rheo__lanes3_add(rheo__lanes3 *sum, rheo__lanes by, rheo__lanes3 v)
{
    sum->x += by * v.x;
    sum->y += by * v.y;
    sum->z += by * v.z;
}

/* A symmetric tensor: xx, yy, zz, xy, xz, yz. */
typedef struct rheo__lanes6 {
    rheo__lanes of[6];
} rheo__lanes6;

static inline rheo__lanes6 rheo__lanes6_zero(void)
{
    rheo__lanes6 tensor;
    for (int i = 0; i < 6; i++)
        tensor.of[i] = rheo__lanes_all(0);
    return tensor;
}

/* t v */
static inline rheo__lanes3 rheo__lanes6_times(const rheo__lanes6 *t, rheo__lanes3 v)
{
    return (rheo__lanes3){t->of[0] * v.x + t->of[3] * v.y + t->of[4] * v.z,
                          t->of[3] * v.x + t->of[1] * v.y + t->of[5] * v.z,
                          t->of[4] * v.x + t->of[5] * v.y + t->of[2] * v.z};
}

#endif
