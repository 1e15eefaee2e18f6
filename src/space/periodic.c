/*
 * Rows of neighbour lists in periodic space (space/period.h). Along a periodic axis a whole number of cells fits into the
 * period, and the last of them is next to the first. Partners across the border are images: particles with other
 * coordinates, which exist only as partners (core/springs.h).
 */
#include <string.h>

#include "space/pairs.h"
#include "space/period.h"

void rheo__period_make(rheo__period *period, const rheo_world_def *def)
{
    *period = (rheo__period){.axes = 0};
    for (int axis = 0; axis < 3; axis++) {
        const rheo_real length = (rheo_real)def->space.period[axis];
        if (!(length > 0))
            continue;
        rheo_real limit = 1;
        while (limit < length)
            limit *= 2;
        while (limit / 2 >= length)
            limit /= 2;
        period->limit[axis] = limit;
        period->length[axis] = (length + limit) - limit;
        period->axes++;
    }
}

void rheo__period_wrap(const rheo__period *period, rheo_real *position, size_t particles)
{
    for (size_t i = 0; i < 3 * particles; i++)
        if (period->length[i % 3] > 0)
            position[i] = rheo__period_wrapped(position[i], period->length[i % 3]);
}

/* ---- Cells ---- */

enum { NEAR = 27, NONE = -1 };

/* The cells around one, each once, by direction: along, across, layer. */
typedef struct around {
    int32_t cell[RHEO__DIRECTIONS][3];
    int count[RHEO__DIRECTIONS];
} around;

/* The coordinates of the cell with a key, and those next to it. */
static around cells_around(uint64_t key, const rheo__cell_layout *layout)
{
    around a;
    for (int d = 0; d < RHEO__DIRECTIONS; d++) {
        const int32_t own = (int32_t)(key & ((UINT64_C(1) << layout->bits[d]) - 1)) + layout->lowest[d],
                      count = layout->count[d];
        key >>= layout->bits[d];
        a.count[d] = 0;
        for (int32_t next = own - 1; next <= own + 1; next++) {
            const int32_t cell = !count ? next : (next + count) % count;
            bool known = false;
            for (int k = 0; k < a.count[d]; k++)
                known = known || a.cell[d][k] == cell;
            if (!known)
                a.cell[d][a.count[d]++] = cell;
        }
    }
    return a;
}

/* The number of the occupied cell with these coordinates; NONE if nothing is there. */
static int64_t find_cell(const rheo__neighbours *n, const rheo__cells *cells, const rheo__cell_layout *layout,
                         const int32_t at[RHEO__DIRECTIONS])
{
    uint64_t key = 0;
    for (int d = RHEO__DIRECTIONS - 1; d >= 0; d--) {
        const int64_t inside = (int64_t)at[d] - layout->lowest[d];
        if (inside < 0 || inside >> layout->bits[d])
            return NONE;
        key = key << layout->bits[d] | (uint64_t)inside;
    }
    uint32_t low = 0, high = cells->count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (n->cell_key[middle] < key)
            low = middle + 1;
        else
            high = middle;
    }
    return low < cells->count && n->cell_key[low] == key ? (int64_t)low : NONE;
}

/* The occupied cells around one, itself included, in the order layer, across, along. Returns their number. */
static int find_near(const rheo__neighbours *n, const rheo__cells *cells, const rheo__cell_layout *layout,
                     uint32_t own, uint32_t near[NEAR])
{
    const around a = cells_around(n->cell_key[own], layout);
    int count = 0;
    for (int layer = 0; layer < a.count[RHEO__LAYER]; layer++)
        for (int across = 0; across < a.count[RHEO__ACROSS]; across++)
            for (int along = 0; along < a.count[RHEO__ALONG]; along++) {
                const int32_t at[RHEO__DIRECTIONS] = {[RHEO__ALONG] = a.cell[RHEO__ALONG][along],
                                                      [RHEO__ACROSS] = a.cell[RHEO__ACROSS][across],
                                                      [RHEO__LAYER] = a.cell[RHEO__LAYER][layer]};
                const int64_t cell = find_cell(n, cells, layout, at);
                if (cell != NONE)
                    near[count++] = (uint32_t)cell;
            }
    return count;
}

/* ---- Images ---- */

/* The number of this image of a particle, which is made if it is new. UINT32_MAX: no memory. */
static uint32_t image_of(rheo__neighbours *n, const rheo_allocator *allocator, uint32_t rank, const int8_t shift[3])
{
    for (uint32_t k = n->first_image[rank]; k != UINT32_MAX; k = n->image[k].next)
        if (memcmp(n->image[k].at.shift, shift, sizeof n->image[k].at.shift) == 0)
            return k;
    void *image = n->image;
    const bool grown =
        rheo__grow(allocator, &image, &n->image_capacity, (size_t)n->images + 1, n->images, sizeof *n->image);
    n->image = image;
    if (!grown)
        return UINT32_MAX;
    n->image[n->images] = (rheo__list_image){{rank, {shift[0], shift[1], shift[2]}}, n->first_image[rank]};
    n->first_image[rank] = n->images;
    return n->images++;
}

/* ---- Rows ---- */

static bool reserve_row(rheo__neighbours *n, const rheo_allocator *allocator, size_t count, size_t more)
{
    void *row = n->row;
    if (count + more > UINT32_MAX / 2 ||
        !rheo__grow(allocator, &row, &n->row_capacity, count + more, count, sizeof *n->row))
        return false;
    n->row = row;
    return true;
}

/* The particles of the cells around one: copies, which lie one after another. */
typedef struct candidates {
    rheo_real *x, *y, *z, *reach;
    uint32_t *rank;
    uint32_t count;
} candidates;

static candidates gather(const rheo__neighbours *n, const uint32_t *near, int cells)
{
    const size_t behind = n->particle_capacity + RHEO__PADDING;
    candidates c = {n->x + behind, n->y + behind, n->z + behind, n->reach + behind, n->id_other, 0};
    for (int k = 0; k < cells; k++)
        for (uint32_t j = n->cell_start[near[k]]; j < n->cell_start[near[k] + 1]; j++, c.count++) {
            c.x[c.count] = n->x[j];
            c.y[c.count] = n->y[j];
            c.z[c.count] = n->z[j];
            c.reach[c.count] = n->reach[j];
            c.rank[c.count] = j;
        }
    return c;
}

/* Lengths and half lengths of the periods; of open axes, half of it is infinite. */
typedef struct borders {
    rheo_real length[3], half[3];
} borders;

/* The difference of two coordinates in range, to the nearest image. */
static inline rheo_real nearest(rheo_real d, rheo_real length, rheo_real half)
{
    return d > half ? d - length : d < -half ? d + length : d;
}

/* Squared distances of all candidates from the particle of rank i. */
static void measure(const rheo__neighbours *n, const candidates *near, uint32_t i, const borders *b,
                    rheo_real *distance2)
{
    const rheo_real x = n->x[i], y = n->y[i], z = n->z[i];
    for (uint32_t k = 0; k < near->count; k++)
        distance2[k] = rheo__length2(nearest(near->x[k] - x, b->length[0], b->half[0]),
                                     nearest(near->y[k] - y, b->length[1], b->half[1]),
                                     nearest(near->z[k] - z, b->length[2], b->half[2]));
}

/* The partner of rank i that is the nearest image of rank j: j itself, or an image. UINT32_MAX: no memory. */
static uint32_t partner_of(rheo__neighbours *n, const rheo_allocator *allocator, uint32_t rows, uint32_t i,
                           uint32_t j, const borders *b)
{
    const rheo_real d[3] = {n->x[j] - n->x[i], n->y[j] - n->y[i], n->z[j] - n->z[i]};
    int8_t shift[3];
    for (int axis = 0; axis < 3; axis++)
        shift[axis] = (int8_t)(d[axis] > b->half[axis] ? -1 : d[axis] < -b->half[axis]);
    if (!shift[0] && !shift[1] && !shift[2])
        return j;
    const uint32_t image = image_of(n, allocator, j, shift);
    return image == UINT32_MAX ? image : rows + image;
}

/* Appends the partners of rank i. False: no memory. */
static bool append(rheo__neighbours *n, const rheo_allocator *allocator, uint32_t rows, uint32_t i,
                   const candidates *near, const borders *b, rheo_real support, bool with_reach, size_t *end)
{
    if (!reserve_row(n, allocator, *end, (size_t)near->count + RHEO__PADDING))
        return false;
    measure(n, near, i, b, n->distance2);
    for (uint32_t k = 0; k < near->count; k++) {
        const rheo_real reach = with_reach ? n->reach[i] + near->reach[k] : support;
        if (!(n->distance2[k] < reach * reach) || near->rank[k] == i)
            continue;
        const uint32_t partner = partner_of(n, allocator, rows, i, near->rank[k], b);
        if (partner == UINT32_MAX)
            return false;
        n->row[(*end)++] = partner;
    }
    return true;
}

/* Puts the positions into range. Those that a list is made of are there; those of a query may not be. */
static void wrap(rheo__neighbours *n, const rheo__period *period, uint32_t rows)
{
    rheo_real *const x[3] = {n->x, n->y, n->z};
    for (int axis = 0; axis < 3; axis++)
        for (uint32_t i = 0; i < rows && period->length[axis] > 0; i++)
            x[axis][i] = rheo__period_wrapped(x[axis][i], period->length[axis]);
}

bool rheo__find_periodic_rows(rheo__neighbours *n, const rheo__cells *cells, const rheo__cell_layout *layout,
                              const rheo__period *period, uint32_t rows, const rheo_allocator *allocator,
                              rheo_real support, bool with_reach)
{
    size_t end = 0;
    borders b;
    void *distance2 = n->distance2;
    const bool grown = rheo__grow(allocator, &distance2, &n->distance_capacity, rows, 0, sizeof *n->distance2);
    n->distance2 = distance2;
    if (!grown)
        return false;
    for (int axis = 0; axis < 3; axis++) {
        b.length[axis] = period->length[axis];
        b.half[axis] = b.length[axis] > 0 ? b.length[axis] / 2 : (rheo_real)__builtin_inf();
    }
    wrap(n, period, rows);
    n->longest_row = 0;
    n->images = 0;
    memset(n->first_image, 0xff, rows * sizeof *n->first_image);
    for (uint32_t c = 0; c < cells->count; c++) {
        uint32_t near[NEAR];
        const candidates nearby = gather(n, near, find_near(n, cells, layout, c, near));
        for (uint32_t i = n->cell_start[c]; i < n->cell_start[c + 1]; i++) {
            const size_t begin = end;
            n->row_start[i] = (uint32_t)begin;
            if (!append(n, allocator, rows, i, &nearby, &b, support, with_reach, &end))
                return false;
            n->longest_row = (uint32_t)(end - begin) > n->longest_row ? (uint32_t)(end - begin) : n->longest_row;
        }
    }
    n->row_start[rows] = (uint32_t)end;
    n->row[end] = rows;
    return true;
}
