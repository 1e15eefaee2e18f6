/* Loops over the rows of blocks (melting/melting.h) in the lanes of a SIMD variant. */
#ifndef RHEO__MELTING_ROWS_H
#define RHEO__MELTING_ROWS_H

#include "melting/melting.h"
#include "space/row_blocks.h"

/* Offsets x_i - x_j of an entry. */
static inline rheo__lanes3 rheo__offsets(const rheo__rows *rows, size_t entry)
{
    return (rheo__lanes3){rheo__lanes_at(rows->x, entry), rheo__lanes_at(rows->y, entry),
                          rheo__lanes_at(rows->z, entry)};
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
