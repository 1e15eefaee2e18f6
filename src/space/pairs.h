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

/* Directions of the rank order: along a line of cells, from line to line of a layer, from layer to layer. */
enum { RHEO__ALONG, RHEO__ACROSS, RHEO__LAYER, RHEO__DIRECTIONS };

/*
 * Position of the bits of a cell's coordinates in its key, by direction. Each coordinate has a spare value below and
 * above.
 */
typedef struct rheo__cell_layout {
    int32_t lowest[RHEO__DIRECTIONS];
    uint32_t bits[RHEO__DIRECTIONS];
    int32_t count[RHEO__DIRECTIONS]; /* cells of a period, whose coordinates begin with 0; 0 in open space */
} rheo__cell_layout;

/* Fills pairs->start and ->partner, and on request n->distance2. False: no memory. */
typedef bool rheo__find_pairs_function(rheo__neighbours *n, const rheo__cells *cells, rheo__pairs *pairs,
                                       const rheo_allocator *allocator, rheo_real support, bool with_distance);
/* Fills n->row_start and ->row; with_reach: from n->reach instead of the support. False: no memory. */
typedef bool rheo__find_rows_function(rheo__neighbours *n, const rheo__cells *cells, uint32_t count,
                                      const rheo_allocator *allocator, rheo_real support, bool with_reach);
RHEO__DECLARE_VARIANTS(rheo__find_pairs_function, find_pairs)
RHEO__DECLARE_VARIANTS(rheo__find_rows_function, find_rows)

/* rheo__find_rows() in periodic space (space/periodic.c). */
bool rheo__find_periodic_rows(rheo__neighbours *n, const rheo__cells *cells, const rheo__cell_layout *layout,
                              const rheo__period *period, uint32_t rows, const rheo_allocator *allocator,
                              rheo_real support, bool with_reach);

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
