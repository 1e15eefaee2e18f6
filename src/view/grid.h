/*
 * Chi at the corners of cubic cells, in blocks of 8 x 8 x 8 corners. A block exists only where enough fluid is near
 * for a surface. Corner (x, y, z) is the point (x, y, z) x cell, so the grid does not move with the fluid.
 */
#ifndef RHEO__VIEW_GRID_H
#define RHEO__VIEW_GRID_H

#include "core/memory.h"
#include "rheolog/view.h"

enum {
    RHEO__BLOCK = 8, /* corners along an edge of a block */
    RHEO__BLOCK_CORNERS = 512,
    RHEO__MAX_BLOCK = 1 << 20, /* coordinates of blocks are >= -RHEO__MAX_BLOCK */
    RHEO__BLOCK_BITS = 21,     /* bits per coordinate in the key of a block */
};

typedef struct rheo__grid {
    double cell;       /* edge of a cell, L */
    uint32_t count;    /* number of blocks */
    uint64_t *key;     /* ascending keys of the blocks: coordinates + RHEO__MAX_BLOCK, x in the lowest bits */
    double *chi;       /* count x RHEO__BLOCK_CORNERS, x fastest */
    double *value;     /* sum of value x volume x W, in the same order; NULL without values */
    uint32_t left_out; /* number of particles too far from the origin */
} rheo__grid;

/*
 * Sums over all particles, in the order of their ids at every corner. A corner whose block does not exist is below
 * the isovalue, and so are the next two corners in every direction.
 */
rheo_result rheo__grid_make(rheo__grid *grid, const rheo_surface_particles *particles,
                            const rheo_surface_options *options, const rheo_allocator *allocator, rheo_error *error);
void rheo__grid_release(rheo__grid *grid, const rheo_allocator *allocator);

#define RHEO__NO_BLOCK UINT32_MAX
/* Index of the block with this key, or RHEO__NO_BLOCK. */
uint32_t rheo__grid_block(const rheo__grid *grid, uint64_t key);
/* Key of the block at an offset of (x, y, z) blocks. The outermost blocks never exist, so keys do not wrap. */
static inline uint64_t rheo__grid_key_beside(uint64_t key, int x, int y, int z)
{
    return key + (uint64_t)(int64_t)x + ((uint64_t)(int64_t)y << RHEO__BLOCK_BITS) +
           ((uint64_t)(int64_t)z << 2 * RHEO__BLOCK_BITS);
}
/* Coordinate of the first corner of a block along an axis (0 is x). */
static inline int32_t rheo__grid_first_corner(uint64_t key, int axis)
{
    const uint64_t mask = (UINT64_C(1) << RHEO__BLOCK_BITS) - 1;
    return ((int32_t)(key >> axis * RHEO__BLOCK_BITS & mask) - RHEO__MAX_BLOCK) * RHEO__BLOCK;
}

#endif
