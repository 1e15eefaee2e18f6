/*
 * Chi on a grid (view/grid.h): chi(x) = sum_j V_j W(|x - x_j|, h) with the quintic spline (core/quintic.h).
 *
 * Blocks are found from the keys of the blocks that contain particles. These keys are sorted and copied along x, y
 * and z in turn, as far as the support of the kernel and two more corners, which edges and gradients need. Each key
 * carries the volume around its block. Volume x W(0) is an upper bound of chi in the block; a block with a bound
 * below the isovalue is dropped. So a spray of single particles, or a particle far away, costs almost nothing.
 *
 * Particles add to the corners in the order of their ids, so the order of every sum is fixed. Each addition covers a
 * row of eight corners; terms beyond the support are zero. Only +, -, x and the square root are used.
 */
#include "view/grid.h"

#include <string.h>

#include "core/error.h"
#include "core/quintic.h"
#include "core/real.h"

/* A block, and the volume of particles in it. After spread(), the volume includes the blocks around it. */
typedef struct filled {
    uint64_t key;
    double volume;
} filled;

typedef struct filled_list {
    filled *item, *other; /* other: workspace of the same size */
    size_t count;
} filled_list;

static void release_list(filled_list *list, const rheo_allocator *allocator)
{
    rheo__release(allocator, list->item);
    rheo__release(allocator, list->other);
    *list = (filled_list){NULL, NULL, 0};
}

static bool make_list(filled_list *list, const rheo_allocator *allocator, size_t count)
{
    list->item = rheo__allocate(allocator, count + 1, sizeof *list->item);
    list->other = rheo__allocate(allocator, count + 1, sizeof *list->other);
    list->count = count;
    if (list->item && list->other)
        return true;
    release_list(list, allocator);
    return false;
}

/*
 * Sorts by key with a stable radix sort, least digit first. Skips digits that all keys share. Then merges equal keys
 * and adds their volumes.
 */
static void sort_and_merge(filled_list *list)
{
    enum { DIGIT = 11, DIGITS = 1 << DIGIT };
    for (uint32_t shift = 0; shift < 3 * RHEO__BLOCK_BITS; shift += DIGIT) {
        size_t offset[DIGITS + 1] = {0};
        for (size_t i = 0; i < list->count; i++)
            offset[(list->item[i].key >> shift & (DIGITS - 1)) + 1]++;
        if (list->count && offset[(list->item[0].key >> shift & (DIGITS - 1)) + 1] == list->count)
            continue;
        for (size_t d = 0; d < DIGITS; d++)
            offset[d + 1] += offset[d];
        for (size_t i = 0; i < list->count; i++)
            list->other[offset[list->item[i].key >> shift & (DIGITS - 1)]++] = list->item[i];
        filled *swap = list->item;
        list->item = list->other;
        list->other = swap;
    }
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++) {
        if (kept && list->item[kept - 1].key == list->item[i].key)
            list->item[kept - 1].volume += list->item[i].volume;
        else
            list->item[kept++] = list->item[i];
    }
    list->count = kept;
}

/* Copies every block to the blocks up to `reach` away along an axis. */
static bool spread(filled_list *list, const rheo_allocator *allocator, int axis, int reach)
{
    filled_list wide;
    const size_t copies = 2 * (size_t)reach + 1;
    if (list->count > SIZE_MAX / copies - 1 || !make_list(&wide, allocator, list->count * copies))
        return false;
    size_t k = 0;
    for (int by = -reach; by <= reach; by++)
        for (size_t i = 0; i < list->count; i++)
            wide.item[k++] = (filled){
                rheo__grid_key_beside(list->item[i].key, axis == 0 ? by : 0, axis == 1 ? by : 0, axis == 2 ? by : 0),
                list->item[i].volume};
    release_list(list, allocator);
    *list = wide;
    sort_and_merge(list);
    return true;
}

/* ---- Particles ---- */

/* The kernel on the grid. */
typedef struct kernel {
    double cell, reach, inverse_h;
    double scale;    /* a particle adds volume x scale x w(q) to chi */
    int32_t corners; /* number of corners in the support, in each direction from the cell of a particle */
} kernel;

static kernel make_kernel(const rheo_surface_particles *p, const rheo_surface_options *options)
{
    const double pi = 3.14159265358979323846, h = p->smoothing_length;
    kernel k = {.cell = h / options->resolution, .reach = 3 * h, .inverse_h = 1 / h};
    k.scale = 1 / (120 * pi) / h / h / h;
    k.corners = (int32_t)(3 * options->resolution);
    k.corners += k.corners < 3 * options->resolution;
    return k;
}

static double volume_of(const rheo_surface_particles *p, uint32_t i)
{
    return p->volume ? (double)p->volume[i] : p->spacing * p->spacing * p->spacing;
}

/* Largest coordinate of a corner, with a margin for the support and for gradients. */
#define MAX_CORNER ((RHEO__MAX_BLOCK - 64) * (double)RHEO__BLOCK)

/* Finds the corner at or below a coordinate. False: too far from the origin. */
static bool corner_below(double x, double cell, int32_t *corner)
{
    const double at = x / cell;
    if (!(at > -MAX_CORNER && at < MAX_CORNER))
        return false;
    const int32_t whole = (int32_t)at;
    *corner = whole - (at < whole);
    return true;
}

static bool corner_of(const rheo_surface_particles *p, uint32_t i, double cell, int32_t corner[3])
{
    for (int a = 0; a < 3; a++)
        if (!corner_below((double)p->position[3 * (size_t)i + a], cell, &corner[a]))
            return false;
    return true;
}

static int32_t block_of(int32_t corner)
{
    return (corner + RHEO__MAX_BLOCK * RHEO__BLOCK) / RHEO__BLOCK; /* the dividend is never negative */
}

static uint64_t key_of(int32_t x, int32_t y, int32_t z)
{
    return (uint64_t)x | (uint64_t)y << RHEO__BLOCK_BITS | (uint64_t)z << 2 * RHEO__BLOCK_BITS;
}

/* ---- Blocks ---- */

static rheo_result make_blocks(rheo__grid *grid, const rheo_surface_particles *p, const kernel *k, double isovalue,
                               const rheo_allocator *allocator)
{
    filled_list list;
    if (!make_list(&list, allocator, p->count))
        return RHEO_ERROR_MEMORY;
    list.count = 0;
    for (uint32_t i = 0; i < p->count; i++) {
        int32_t corner[3];
        if (corner_of(p, i, k->cell, corner))
            list.item[list.count++] =
                (filled){key_of(block_of(corner[0]), block_of(corner[1]), block_of(corner[2])), volume_of(p, i)};
        else
            grid->left_out++;
    }
    sort_and_merge(&list);
    const int reach = (k->corners + 2 + RHEO__BLOCK - 1) / RHEO__BLOCK;
    for (int axis = 0; axis < 3; axis++) {
        if (!spread(&list, allocator, axis, reach)) {
            release_list(&list, allocator);
            return RHEO_ERROR_MEMORY;
        }
    }
    const double most = 66 * k->scale * (1 + 1e-6); /* w(0) = 243 - 192 + 15, with a margin for rounding */
    size_t kept = 0;
    for (size_t i = 0; i < list.count; i++)
        if (list.item[i].volume * most >= isovalue)
            list.item[kept++] = list.item[i];
    rheo_result result = RHEO_ERROR_MEMORY;
    if (kept < UINT32_MAX) {
        grid->count = (uint32_t)kept;
        grid->key = rheo__allocate(allocator, kept + 1, sizeof *grid->key);
        grid->chi = rheo__allocate(allocator, kept + 1, RHEO__BLOCK_CORNERS * sizeof *grid->chi);
        grid->value = p->value ? rheo__allocate(allocator, kept + 1, RHEO__BLOCK_CORNERS * sizeof *grid->chi) : NULL;
        if (grid->key && grid->chi && (grid->value || !p->value))
            result = RHEO_OK;
    }
    for (size_t i = 0; result == RHEO_OK && i < kept; i++)
        grid->key[i] = list.item[i].key;
    release_list(&list, allocator);
    return result;
}

/* Index of the first block whose key is not smaller than this key. */
static uint32_t first_from(const rheo__grid *grid, uint64_t key)
{
    uint32_t low = 0, high = grid->count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (grid->key[middle] < key)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

uint32_t rheo__grid_block(const rheo__grid *grid, uint64_t key)
{
    const uint32_t at = first_from(grid, key);
    return at < grid->count && grid->key[at] == key ? at : RHEO__NO_BLOCK;
}

/* ---- Adding a particle ---- */

static void add_to_row(double *chi, double *values, const double dx2[RHEO__BLOCK], double rest, double inverse_h,
                       double part, double value)
{
    double w[RHEO__BLOCK];
    for (int i = 0; i < RHEO__BLOCK; i++)
        w[i] = part * rheo__quintic_by_squares(__builtin_sqrt(dx2[i] + rest) * inverse_h);
    for (int i = 0; i < RHEO__BLOCK; i++)
        chi[i] += w[i];
    for (int i = 0; values && i < RHEO__BLOCK; i++)
        values[i] += value * w[i];
}

static int32_t at_least(int32_t a, int32_t b)
{
    return a > b ? a : b;
}
static int32_t at_most(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

/* Adds a particle to the corners low .. high of one block. */
static void add_to_block(rheo__grid *grid, uint32_t block, const rheo_surface_particles *p, const kernel *k,
                         uint32_t i, const int32_t low[3], const int32_t high[3])
{
    const rheo_real *at = p->position + 3 * (size_t)i;
    const double part = k->scale * volume_of(p, i), value = p->value ? (double)p->value[i] : 0;
    const int32_t first[3] = {rheo__grid_first_corner(grid->key[block], 0),
                              rheo__grid_first_corner(grid->key[block], 1),
                              rheo__grid_first_corner(grid->key[block], 2)};
    double dx2[RHEO__BLOCK];
    for (int x = 0; x < RHEO__BLOCK; x++) {
        const double d = (double)(first[0] + x) * k->cell - (double)at[0];
        dx2[x] = d * d;
    }
    const int32_t y0 = at_least(first[1], low[1]), y1 = at_most(first[1] + RHEO__BLOCK - 1, high[1]);
    const int32_t z0 = at_least(first[2], low[2]), z1 = at_most(first[2] + RHEO__BLOCK - 1, high[2]);
    for (int32_t z = z0; z <= z1; z++) {
        const double dz = (double)z * k->cell - (double)at[2];
        for (int32_t y = y0; y <= y1; y++) {
            const double dy = (double)y * k->cell - (double)at[1], rest = dy * dy + dz * dz;
            const size_t row = (size_t)block * RHEO__BLOCK_CORNERS +
                               (size_t)((z - first[2]) * RHEO__BLOCK + y - first[1]) * RHEO__BLOCK;
            if (rest < k->reach * k->reach)
                add_to_row(grid->chi + row, grid->value ? grid->value + row : NULL, dx2, rest, k->inverse_h, part,
                           value);
        }
    }
}

static void add_particle(rheo__grid *grid, const rheo_surface_particles *p, const kernel *k, uint32_t i)
{
    int32_t corner[3], low[3], high[3];
    if (!corner_of(p, i, k->cell, corner))
        return;
    for (int a = 0; a < 3; a++) {
        low[a] = corner[a] - k->corners;
        high[a] = corner[a] + k->corners;
    }
    for (int32_t z = block_of(low[2]); z <= block_of(high[2]); z++) {
        for (int32_t y = block_of(low[1]); y <= block_of(high[1]); y++) {
            const uint64_t last = key_of(block_of(high[0]), y, z);
            uint32_t block = first_from(grid, key_of(block_of(low[0]), y, z));
            for (; block < grid->count && grid->key[block] <= last; block++)
                add_to_block(grid, block, p, k, i, low, high);
        }
    }
}

void rheo__grid_release(rheo__grid *grid, const rheo_allocator *allocator)
{
    rheo__release(allocator, grid->key);
    rheo__release(allocator, grid->chi);
    rheo__release(allocator, grid->value);
}

rheo_result rheo__grid_make(rheo__grid *grid, const rheo_surface_particles *particles,
                            const rheo_surface_options *options, const rheo_allocator *allocator, rheo_error *error)
{
    const kernel k = make_kernel(particles, options);
    *grid = (rheo__grid){.cell = k.cell};
    if (make_blocks(grid, particles, &k, options->isovalue, allocator) != RHEO_OK) {
        rheo__grid_release(grid, allocator);
        return rheo__fail(error, RHEO_ERROR_MEMORY,
                          "no memory for the surface of %u particles, %g cells in a length h", particles->count,
                          options->resolution);
    }
    for (uint32_t i = 0; i < particles->count; i++)
        add_particle(grid, particles, &k, i);
    return RHEO_OK;
}
