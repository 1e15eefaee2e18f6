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
    for (size_t i = 0; i < 3 * particles; i++) {
        const rheo_real length = period->length[i % 3];
        if (length > 0)
            position[i] =
                (rheo_real)((double)position[i] - rheo__periods_away((double)position[i], length) * (double)length);
    }
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

/*
 * Whether the image of b that is nearest to a is b itself, or the one across a border. Returns the squared distance. Queries
 * may find particles further than a period apart; they do not need the shift.
 */
static rheo_real nearest(const rheo__neighbours *n, const rheo__period *period, uint32_t a, uint32_t b,
                         int8_t shift[3])
{
    rheo_real d[3] = {n->x[b] - n->x[a], n->y[b] - n->y[a], n->z[b] - n->z[a]};
    for (int axis = 0; axis < 3; axis++) {
        const rheo_real length = period->length[axis], moved = rheo__period_nearest(d[axis], length);
        shift[axis] = (int8_t)(moved == d[axis] ? 0 : moved > d[axis] ? 1 : -1);
        d[axis] = moved;
    }
    return rheo__length2(d[0], d[1], d[2]);
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

/* Appends the partners of rank i that are in some cells. False: no memory. */
static bool append(rheo__neighbours *n, const rheo__period *period, const rheo_allocator *allocator, uint32_t rows,
                   uint32_t i, const uint32_t *near, int count, rheo_real support, bool with_reach, size_t *end)
{
    for (int c = 0; c < count; c++) {
        const uint32_t first = n->cell_start[near[c]], last = n->cell_start[near[c] + 1];
        if (!reserve_row(n, allocator, *end, (size_t)(last - first) + RHEO__PADDING))
            return false;
        for (uint32_t j = first; j < last; j++) {
            int8_t shift[3];
            const rheo_real reach = with_reach ? n->reach[i] + n->reach[j] : support;
            if (j == i || !(nearest(n, period, i, j, shift) < reach * reach))
                continue;
            uint32_t partner = j;
            if (shift[0] || shift[1] || shift[2]) {
                const uint32_t image = image_of(n, allocator, j, shift);
                if (image == UINT32_MAX)
                    return false;
                partner = rows + image;
            }
            n->row[(*end)++] = partner;
        }
    }
    return true;
}

bool rheo__find_periodic_rows(rheo__neighbours *n, const rheo__cells *cells, const rheo__cell_layout *layout,
                              const rheo__period *period, uint32_t rows, const rheo_allocator *allocator,
                              rheo_real support, bool with_reach)
{
    size_t end = 0;
    n->longest_row = 0;
    n->images = 0;
    memset(n->first_image, 0xff, rows * sizeof *n->first_image);
    for (uint32_t c = 0; c < cells->count; c++) {
        uint32_t near[NEAR];
        const int count = find_near(n, cells, layout, c, near);
        for (uint32_t i = n->cell_start[c]; i < n->cell_start[c + 1]; i++) {
            const size_t begin = end;
            n->row_start[i] = (uint32_t)begin;
            if (!append(n, period, allocator, rows, i, near, count, support, with_reach, &end))
                return false;
            n->longest_row = (uint32_t)(end - begin) > n->longest_row ? (uint32_t)(end - begin) : n->longest_row;
        }
    }
    n->row_start[rows] = (uint32_t)end;
    n->row[end] = rows;
    return true;
}
