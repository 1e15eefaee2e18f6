/* The search for the pairs of a neighbour list, once the particles are sorted by cell (space/pairs.c). */
#ifndef RHEO_SPACE_PAIRS_H
#define RHEO_SPACE_PAIRS_H

#include "core/target.h"
#include "space/neighbours.h"

/* The occupied cells of a list, and how far the keys of cells next to each other are apart. */
typedef struct rheo_cells {
    uint32_t count;
    uint64_t to_next_line, to_next_layer; /* from a cell to that in the next line of its layer; in the next layer */
} rheo_cells;

/* Fills in pairs->start and ->partner, and if asked n->distance2. False: no memory. */
typedef bool rheo_find_pairs_function(rheo_neighbours *n, const rheo_cells *cells, rheo_pairs *pairs,
                                      const rheo_allocator *allocator, rheo_real support, bool with_distance);
/* Fills in n->row_start and ->row. False: no memory. */
typedef bool rheo_find_rows_function(rheo_neighbours *n, const rheo_cells *cells, uint32_t count,
                                     const rheo_allocator *allocator, rheo_real support);
#define X(target)                                      \
    rheo_find_pairs_function rheo_find_pairs_##target; \
    rheo_find_rows_function rheo_find_rows_##target;
RHEO_TARGETS(X)
#undef X

static inline bool rheo_find_pairs(rheo_neighbours *n, const rheo_cells *cells, rheo_pairs *pairs,
                                   const rheo_allocator *allocator, rheo_real support, bool with_distance)
{
    static rheo_find_pairs_function *const FOR[] = {
#define X(target) rheo_find_pairs_##target,
        RHEO_TARGETS(X)
#undef X
    };
    return FOR[rheo_target_in_use()](n, cells, pairs, allocator, support, with_distance);
}

static inline bool rheo_find_rows(rheo_neighbours *n, const rheo_cells *cells, uint32_t count,
                                  const rheo_allocator *allocator, rheo_real support)
{
    static rheo_find_rows_function *const FOR[] = {
#define X(target) rheo_find_rows_##target,
        RHEO_TARGETS(X)
#undef X
    };
    return FOR[rheo_target_in_use()](n, cells, count, allocator, support);
}

#endif
