/* Loops over the rows of blocks (melting/melting.h) in the lanes of a SIMD variant. */
#ifndef RHEO__MELTING_ROWS_H
#define RHEO__MELTING_ROWS_H

#include "core/lanes.h"
#include "melting/melting.h"

_Static_assert(RHEO__BLOCK_ROWS % RHEO__LANES == 0, "a block is a whole number of vectors");

/* Loop over the vectors of rows of a block: `first` is the row of its first lane. */
#define RHEO__EACH_VECTOR_OF_BLOCK(first) for (uint32_t first = 0; first < RHEO__BLOCK_ROWS; first += RHEO__LANES)
/* Loop over the vectors of rows of all blocks. Its first lane has the rank block x RHEO__BLOCK_ROWS + first. */
#define RHEO__EACH_VECTOR_OF_ROWS(rows, block, first)         \
    for (uint32_t block = 0; block < (rows)->blocks; block++) \
        RHEO__EACH_VECTOR_OF_BLOCK (first)
/* Loop over the partners of such a vector: `entry` is the index of its first lane in the arrays of the rows. */
#define RHEO__EACH_ENTRY(rows, block, first, entry)                                  \
    for (size_t entry = (size_t)(rows)->start[block] * RHEO__BLOCK_ROWS + (first),   \
                entry##_end = (size_t)(rows)->start[(block) + 1] * RHEO__BLOCK_ROWS; \
         entry < entry##_end; entry += RHEO__BLOCK_ROWS)

/* Values from `index` on: lanes of an entry, or rows of a block. */
static inline rheo__lanes rheo__lanes_at(const rheo_real *values, size_t index)
{
    rheo__lanes lanes;
    memcpy(&lanes, values + index, sizeof lanes);
    return lanes;
}
static inline void rheo__lanes_put(rheo_real *values, size_t index, rheo__lanes lanes)
{
    memcpy(values + index, &lanes, sizeof lanes);
}

/* Ranks of the rows of a vector whose first row has this rank. */
static inline void rheo__own_ranks(uint32_t rank, uint32_t own[RHEO__LANES])
{
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
        own[lane] = rank + lane;
}

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
