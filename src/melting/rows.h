/* Going through the rows of blocks (melting/melting.h) with the lanes of a target. */
#ifndef RHEO__MELTING_ROWS_H
#define RHEO__MELTING_ROWS_H

#include "core/lanes.h"
#include "melting/melting.h"

_Static_assert(RHEO__BLOCK_ROWS % RHEO__LANES == 0, "a block is a whole number of vectors");

/* Each vector of rows of a block: `first` is its first lane in the block. */
#define RHEO__EACH_VECTOR_OF_BLOCK(first) for (uint32_t first = 0; first < RHEO__BLOCK_ROWS; first += RHEO__LANES)

/* What stands at a place of an array: lanes of an entry, or rows of a block. */
static inline rheo__lanes rheo__lanes_at(const rheo_real *values, size_t place)
{
    rheo__lanes lanes;
    memcpy(&lanes, values + place, sizeof lanes);
    return lanes;
}
static inline void rheo__lanes_put(rheo_real *values, size_t place, rheo__lanes lanes)
{
    memcpy(values + place, &lanes, sizeof lanes);
}

/* Numbers of the rows from `rank` on. */
static inline void rheo__own_ranks(uint32_t rank, uint32_t own[RHEO__LANES])
{
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
        own[lane] = rank + lane;
}

/* The offsets of an entry's lanes. */
static inline rheo__lanes3 rheo__offsets(const rheo__rows *rows, size_t place)
{
    return (rheo__lanes3){rheo__lanes_at(rows->x, place), rheo__lanes_at(rows->y, place),
                          rheo__lanes_at(rows->z, place)};
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

/* The six different components of a symmetric tensor: xx, yy, zz, xy, xz, yz. */
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

#endif
