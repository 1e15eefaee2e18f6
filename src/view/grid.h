/*
 * Chi on a grid (internal): the corners of cubic cells, in blocks of 8 x 8 x 8 corners, of which only those are there
 * that fluid is in. Corner (x, y, z) is the point (x, y, z) x cell: the grid lies still, whatever moves through it.
 */
#ifndef RHEO__VIEW_GRID_H
#define RHEO__VIEW_GRID_H

#include "core/memory.h"
#include "rheolog/view.h"

enum {
    RHEO__BLOCK = 8, /* corners along an edge of a block */
    RHEO__BLOCK_CORNERS = 512,
    RHEO__MAX_BLOCK = 1 << 20, /* blocks are counted from -RHEO__MAX_BLOCK on */
    RHEO__BLOCK_BITS = 21,     /* of one coordinate of a block in its key */
};

typedef struct rheo__grid {
    double cell;    /* its edge, L */
    uint32_t count; /* blocks */
    uint64_t *key;  /* of each, ascending: coordinates of the block + RHEO__MAX_BLOCK, x in the lowest bits */
    double *chi;    /* count x RHEO__BLOCK_CORNERS, x fastest */
    double *value;  /* the same for the sum of value x volume x W; NULL without values */
    uint32_t left_out;
} rheo__grid;

/*
 * Sums over all particles, at every corner in the order of ids. A corner of a block that is not there, and the two
 * next to it in every direction, are below the isovalue.
 */
rheo_result rheo__grid_make(rheo__grid *grid, const rheo_surface_particles *particles,
                            const rheo_surface_options *options, const rheo_allocator *allocator, rheo_error *error);
void rheo__grid_release(rheo__grid *grid, const rheo_allocator *allocator);

#define RHEO__NO_BLOCK UINT32_MAX
/* The block of a key, or RHEO__NO_BLOCK. */
uint32_t rheo__grid_block(const rheo__grid *grid, uint64_t key);
/* The key of the block that lies so many blocks away; the outermost blocks are never there, so that none wraps. */
static inline uint64_t rheo__grid_key_beside(uint64_t key, int x, int y, int z)
{
    return key + (uint64_t)(int64_t)x + ((uint64_t)(int64_t)y << RHEO__BLOCK_BITS) +
           ((uint64_t)(int64_t)z << 2 * RHEO__BLOCK_BITS);
}
/* The coordinate (0: x) of a block's first corner. */
static inline int32_t rheo__grid_first_corner(uint64_t key, int axis)
{
    const uint64_t mask = (UINT64_C(1) << RHEO__BLOCK_BITS) - 1;
    return ((int32_t)(key >> axis * RHEO__BLOCK_BITS & mask) - RHEO__MAX_BLOCK) * RHEO__BLOCK;
}

#endif
