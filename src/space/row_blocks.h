/*
 * Rows side by side in blocks: the k-th partners of the rows of a block are adjacent, so that each lane of a vector
 * sums one row. Sums read values that no row of the loop writes, so rows may be summed in any order; each sum takes
 * its partners in the order of cells.
 *
 * The macros take any struct with members `blocks` and `start` (blocks + 1 values: first entry of each block).
 */
#ifndef RHEO__SPACE_ROW_BLOCKS_H
#define RHEO__SPACE_ROW_BLOCKS_H

#include "core/lane_points.h"
#include "core/springs.h"

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

#endif
