/* Search for the pairs of a neighbour list, after the particles are sorted by cell (space/pairs.c). */
#ifndef RHEO__SPACE_PAIRS_H
#define RHEO__SPACE_PAIRS_H

#include "core/simd.h"
#include "space/neighbours.h"

/* The occupied cells of a list, and the differences of key between adjacent cells. */
typedef struct rheo__cells {
    uint32_t count;
    uint64_t to_next_line, to_next_layer; /* from a cell to the one in the next line; in the next layer */
} rheo__cells;

/* Fills pairs->start and ->partner, and on request n->distance2. False: no memory. */
typedef bool rheo__find_pairs_function(rheo__neighbours *n, const rheo__cells *cells, rheo__pairs *pairs,
                                       const rheo_allocator *allocator, rheo_real support, bool with_distance);
/* Fills n->row_start and ->row; with_reach: from n->reach instead of the support. False: no memory. */
typedef bool rheo__find_rows_function(rheo__neighbours *n, const rheo__cells *cells, uint32_t count,
                                      const rheo_allocator *allocator, rheo_real support, bool with_reach);
RHEO__DECLARE_VARIANTS(rheo__find_pairs_function, find_pairs)
RHEO__DECLARE_VARIANTS(rheo__find_rows_function, find_rows)

static inline bool rheo__find_pairs(rheo__neighbours *n, const rheo__cells *cells, rheo__pairs *pairs,
                                    const rheo_allocator *allocator, rheo_real support, bool with_distance)
{
    static rheo__find_pairs_function *const variants[] = RHEO__ALL_VARIANTS(find_pairs);
    return variants[rheo__simd_in_use()](n, cells, pairs, allocator, support, with_distance);
}

static inline bool rheo__find_rows(rheo__neighbours *n, const rheo__cells *cells, uint32_t count,
                                   const rheo_allocator *allocator, rheo_real support, bool with_reach)
{
    static rheo__find_rows_function *const variants[] = RHEO__ALL_VARIANTS(find_rows);
    return variants[rheo__simd_in_use()](n, cells, count, allocator, support, with_reach);
}

#endif
