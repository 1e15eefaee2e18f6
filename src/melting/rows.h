/* Going through the rows of blocks (melting/melting.h) with the lanes of a target. */
#ifndef RHEO_MELTING_ROWS_H
#define RHEO_MELTING_ROWS_H

#include "core/lanes.h"
#include "melting/melting.h"

_Static_assert(RHEO_BLOCK_ROWS % RHEO_LANES == 0, "a block is a whole number of vectors");

/* Each vector of rows of a block: `first` is its first lane in the block. */
#define RHEO_EACH_PART(first) for (uint32_t first = 0; first < RHEO_BLOCK_ROWS; first += RHEO_LANES)

/* What stands at a place of an array: lanes of an entry, or rows of a block. */
static inline rheo_lanes rheo_lanes_at(const rheo_real *values, size_t place)
{
    rheo_lanes lanes;
    memcpy(&lanes, values + place, sizeof lanes);
    return lanes;
}
static inline void rheo_lanes_put(rheo_real *values, size_t place, rheo_lanes lanes)
{
    memcpy(values + place, &lanes, sizeof lanes);
}

/* Numbers of the rows from `rank` on. */
static inline void rheo_own_ranks(uint32_t rank, uint32_t own[RHEO_LANES])
{
    for (uint32_t lane = 0; lane < RHEO_LANES; lane++)
        own[lane] = rank + lane;
}

/* The offsets of an entry's lanes. */
static inline rheo_lanes3 rheo_offsets(const rheo_rows *rows, size_t place)
{
    return (rheo_lanes3){rheo_lanes_at(rows->x, place), rheo_lanes_at(rows->y, place), rheo_lanes_at(rows->z, place)};
}
static inline rheo_lanes3 rheo_lanes3_zero(void)
{
    const rheo_lanes zero = rheo_lanes_all(0);
    return (rheo_lanes3){zero, zero, zero};
}
static inline rheo_lanes rheo_lanes3_dot(rheo_lanes3 a, rheo_lanes3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* The six different components of a symmetric tensor: xx, yy, zz, xy, xz, yz. */
typedef struct rheo_lanes6 {
    rheo_lanes of[6];
} rheo_lanes6;

static inline rheo_lanes6 rheo_lanes6_zero(void)
{
    rheo_lanes6 tensor;
    for (int i = 0; i < 6; i++)
        tensor.of[i] = rheo_lanes_all(0);
    return tensor;
}

#endif
