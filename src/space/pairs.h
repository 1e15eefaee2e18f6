/* The search for the pairs of a neighbour list, once the particles are sorted by cell (space/pairs.c). */
#ifndef RHEO__SPACE_PAIRS_H
#define RHEO__SPACE_PAIRS_H

#include "core/simd.h"
#include "space/neighbours.h"

/* The occupied cells of a list, and how far the keys of cells next to each other are apart. */
typedef struct rheo__cells {
    uint32_t count;
    uint64_t to_next_line, to_next_layer; /* from a cell to that in the next line of its layer; in the next layer */
} rheo__cells;

/* Fills in pairs->start and ->partner, and if asked n->distance2. False: no memory. */
typedef bool rheo__find_pairs_function(rheo__neighbours *n, const rheo__cells *cells, rheo__pairs *pairs,
                                       const rheo_allocator *allocator, rheo_real support, bool with_distance);
/* Fills in n->row_start and ->row. False: no memory. */
typedef bool rheo__find_rows_function(rheo__neighbours *n, const rheo__cells *cells, uint32_t count,
                                      const rheo_allocator *allocator, rheo_real support);
#define X(target)                                        \
    rheo__find_pairs_function rheo__find_pairs_##target; \
    rheo__find_rows_function rheo__find_rows_##target;
RHEO__SIMD_VARIANTS(X)
#undef X

static inline bool rheo__find_pairs(rheo__neighbours *n, const rheo__cells *cells, rheo__pairs *pairs,
                                    const rheo_allocator *allocator, rheo_real support, bool with_distance)
{
    static rheo__find_pairs_function *const FOR[] = {
#define X(target) rheo__find_pairs_##target,
        RHEO__SIMD_VARIANTS(X)
#undef X
    };
    return FOR[rheo__simd_in_use()](n, cells, pairs, allocator, support, with_distance);
}

static inline bool rheo__find_rows(rheo__neighbours *n, const rheo__cells *cells, uint32_t count,
                                   const rheo_allocator *allocator, rheo_real support)
{
    static rheo__find_rows_function *const FOR[] = {
#define X(target) rheo__find_rows_##target,
        RHEO__SIMD_VARIANTS(X)
#undef X
    };
    return FOR[rheo__simd_in_use()](n, cells, count, allocator, support);
}

#endif
