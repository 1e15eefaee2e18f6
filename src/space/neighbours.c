/*
 * Neighbour lists (space/neighbours.h): cells by sorting keys, rows by testing the particles of the cells around.
 *
 * Only half of the surrounding cells are searched, since a pair belongs to its lower rank; the other halves of the
 * rows follow from the pairs. Because cells are sorted, each line of three cells next to a cell is one range of
 * ranks, and the ranges move forward together with the cell: no hash table, no grid.
 */
#include "space/neighbours.h"

#include <string.h>

#include "space/pairs.h"

enum { RADIX_BITS = 12 };

#define LARGEST_CELL ((1 << 20) - 2)

void rheo__neighbours_release(rheo__neighbours *n, const rheo_allocator *allocator)
{
    void *arrays[] = {n->line,      n->line_other, n->line_colour, n->line_group, n->group_start,
                      n->distance2, n->row_start,  n->row,         n->key,        n->key_other,
                      n->id_other,  n->cell_key,   n->cell_start,  n->x,          n->y,
                      n->z,         n->reach,      n->block_rank,  n->image,      n->first_image};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        rheo__release(allocator, arrays[i]);
    memset(n, 0, sizeof *n);
}

static bool reserve(rheo__neighbours *n, const rheo_allocator *allocator, uint32_t rows)
{
    if (rows <= n->particle_capacity && n->row_start)
        return true;
    /* A multiple of the padding, so that the candidates of a cell begin with a cache line. */
    const size_t more = n->row_start ? (size_t)rows / 4 : 0,
                 wanted = (rows + more) / RHEO__PADDING * RHEO__PADDING + RHEO__PADDING;
    rheo__neighbours_release(n, allocator); /* nothing in it outlives a step */
    n->row_start = rheo__allocate(allocator, wanted + 1, sizeof *n->row_start);
    n->key = rheo__allocate(allocator, wanted, sizeof *n->key);
    n->key_other = rheo__allocate(allocator, wanted, sizeof *n->key_other);
    n->id_other = rheo__allocate(allocator, wanted + RHEO__PADDING, sizeof *n->id_other);
    n->block_rank = rheo__allocate(allocator, wanted, sizeof *n->block_rank);
    n->first_image = rheo__allocate(allocator, wanted, sizeof *n->first_image);
    n->cell_key = rheo__allocate(allocator, wanted, sizeof *n->cell_key);
    n->cell_start = rheo__allocate(allocator, wanted + 1, sizeof *n->cell_start);
    n->x = rheo__allocate(allocator, 2 * (wanted + RHEO__PADDING), sizeof *n->x);
    n->y = rheo__allocate(allocator, 2 * (wanted + RHEO__PADDING), sizeof *n->y);
    n->z = rheo__allocate(allocator, 2 * (wanted + RHEO__PADDING), sizeof *n->z);
    n->reach = rheo__allocate(allocator, 2 * (wanted + RHEO__PADDING), sizeof *n->reach);
    if (!n->row_start || !n->key || !n->key_other || !n->id_other || !n->cell_key || !n->cell_start || !n->x ||
        !n->y || !n->z || !n->reach || !n->block_rank || !n->first_image) {
        rheo__neighbours_release(n, allocator);
        return false;
    }
    n->particle_capacity = n->block_rank_capacity = wanted;
    return true;
}

/* Lists of whole rows have no lines. */
static bool reserve_lines(rheo__neighbours *n, const rheo_allocator *allocator)
{
    const size_t wanted = n->particle_capacity;
    if (n->line)
        return true;
    n->line = rheo__allocate(allocator, wanted, sizeof *n->line);
    n->line_other = rheo__allocate(allocator, wanted, sizeof *n->line_other);
    n->line_colour = rheo__allocate(allocator, wanted, sizeof *n->line_colour);
    n->line_group = rheo__allocate(allocator, wanted, sizeof *n->line_group);
    n->group_start = rheo__allocate(allocator, wanted + 4 * RHEO__COLOURS, sizeof *n->group_start);
    if (n->line && n->line_other && n->line_colour && n->line_group && n->group_start)
        return true;
    rheo__neighbours_release(n, allocator);
    return false;
}

/* floor(x * cells_per_length), clamped to the outermost cells; NaN counts as the lowest. */
static int32_t cell_of(rheo_real x, double cells_per_length)
{
    double cell = (double)x * cells_per_length;
    if (!(cell > -LARGEST_CELL))
        return -LARGEST_CELL;
    if (cell >= LARGEST_CELL)
        return LARGEST_CELL;
    int32_t whole = (int32_t)cell;
    return whole - (cell < whole);
}

static uint32_t bits_for(uint32_t largest)
{
    uint32_t bits = 0;
    while (largest >> bits)
        bits++;
    return bits;
}

/*
 * Stable radix sort of (key, id) by key, least significant digit first, over the digits that the occupied space
 * needs. The ids must be ascending at the start. Leaves the sorted keys in n->key and the ids in *id.
 */
static void sort_by_key(rheo__neighbours *n, uint32_t *id, uint32_t count, uint32_t bits)
{
    uint32_t passes = (bits + RADIX_BITS - 1) / RADIX_BITS;
    uint32_t digit_bits = passes ? (bits + passes - 1) / passes : 0;
    uint64_t *key = n->key, *key_to = n->key_other;
    uint32_t *from = id, *to = n->id_other;
    for (uint32_t pass = 0; pass < passes; pass++) {
        uint32_t place[(1 << RADIX_BITS) + 1] = {0};
        uint32_t shift = pass * digit_bits, mask = (UINT32_C(1) << digit_bits) - 1;
        for (uint32_t i = 0; i < count; i++)
            place[((uint32_t)(key[i] >> shift) & mask) + 1]++;
        for (uint32_t d = 0; d < mask; d++)
            place[d + 1] += place[d];
        for (uint32_t i = 0; i < count; i++) {
            uint32_t p = place[(uint32_t)(key[i] >> shift) & mask]++;
            key_to[p] = key[i];
            to[p] = from[i];
        }
        uint64_t *key_swap = key;
        key = key_to;
        key_to = key_swap;
        uint32_t *swap = from;
        from = to;
        to = swap;
    }
    if (from != id)
        memcpy(id, from, count * sizeof *id);
    n->key = key;
    n->key_other = key_to;
}

enum { ALONG = RHEO__ALONG, ACROSS = RHEO__ACROSS, LAYER = RHEO__LAYER, DIRECTIONS = RHEO__DIRECTIONS };
static const size_t AXIS[DIRECTIONS] = {[ALONG] = 1, [ACROSS] = 0, [LAYER] = 2}; /* y is up: lines are columns */

/* The cells of a direction: how many a length has; a period has a whole number of them, at least `width` wide. */
static double cells_of(const rheo__period *period, size_t axis, double width, int32_t *cells)
{
    *cells = 0;
    if (!period || !(period->length[axis] > 0))
        return 1 / width;
    const double length = (double)period->length[axis], fit = length / width;
    *cells = fit < 1 ? 1 : fit > LARGEST_CELL ? LARGEST_CELL : (int32_t)fit;
    return *cells / length;
}

static rheo__cell_layout make_keys(rheo__neighbours *n, uint32_t count, const rheo_real *position, double width,
                                   const rheo__period *period)
{
    enum { BITS = 21, MASK = (1 << BITS) - 1 };
    _Static_assert(2 * LARGEST_CELL < MASK, "three coordinates of a cell fit into one key");
    int32_t low[DIRECTIONS] = {LARGEST_CELL, LARGEST_CELL, LARGEST_CELL};
    int32_t high[DIRECTIONS] = {-LARGEST_CELL, -LARGEST_CELL, -LARGEST_CELL};
    double cells_per_length[DIRECTIONS];
    rheo__cell_layout layout;
    for (int d = 0; d < DIRECTIONS; d++)
        cells_per_length[d] = cells_of(period, AXIS[d], width, &layout.count[d]);
    for (uint32_t i = 0; i < count; i++) {
        uint64_t key = 0;
        for (int d = DIRECTIONS - 1; d >= 0; d--) {
            int32_t cell = cell_of(position[3 * (size_t)i + AXIS[d]], cells_per_length[d]);
            if (period && layout.count[d])
                cell = (cell % layout.count[d] + layout.count[d]) % layout.count[d];
            low[d] = cell < low[d] ? cell : low[d];
            high[d] = cell > high[d] ? cell : high[d];
            key = key << BITS | (uint32_t)(cell + LARGEST_CELL);
        }
        n->key[i] = key;
    }
    uint64_t base[DIRECTIONS];
    for (int d = 0; d < DIRECTIONS; d++) {
        layout.lowest[d] = low[d] - 1;
        layout.bits[d] = bits_for((uint32_t)(high[d] - low[d]) + 2);
        base[d] = (uint64_t)(layout.lowest[d] + LARGEST_CELL);
    }
    uint32_t across = layout.bits[ALONG], layer = layout.bits[ALONG] + layout.bits[ACROSS];
    for (uint32_t i = 0; i < count; i++) {
        uint64_t key = n->key[i];
        n->key[i] = ((key & MASK) - base[ALONG]) | ((key >> BITS & MASK) - base[ACROSS]) << across |
                    ((key >> 2 * BITS) - base[LAYER]) << layer;
    }
    return layout;
}

static uint32_t modulo3(int32_t value)
{
    int32_t rest = value % 3;
    return (uint32_t)(rest < 0 ? rest + 3 : rest);
}

/* Lists the occupied cells. */
static uint32_t make_cells(rheo__neighbours *n, uint32_t count)
{
    uint32_t cells = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (i && n->key[i] == n->key[i - 1])
            continue;
        n->cell_key[cells] = n->key[i];
        n->cell_start[cells++] = i;
    }
    n->cell_start[cells] = count;
    return cells;
}

/* Lists the lines in rank order with their colours. */
static void make_lines(rheo__neighbours *n, uint32_t count, const rheo__cell_layout *layout)
{
    uint32_t lines = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint64_t line = n->key[i] >> layout->bits[ALONG];
        if (i == 0 || line != n->key[i - 1] >> layout->bits[ALONG]) {
            if (lines)
                n->line_other[lines - 1].end = i;
            uint32_t across = (uint32_t)(line & ((UINT64_C(1) << layout->bits[ACROSS]) - 1));
            uint32_t layer = (uint32_t)(line >> layout->bits[ACROSS]);
            n->line_colour[lines] = (uint8_t)(modulo3((int32_t)across + layout->lowest[ACROSS]) +
                                              3 * modulo3((int32_t)layer + layout->lowest[LAYER]));
            n->line_group[lines] = layer;
            n->line_other[lines++].first = i;
        }
    }
    if (lines)
        n->line_other[lines - 1].end = count;
    n->line_count = lines;
}

/*
 * Groups the lines. Two lines conflict if they are at most two cells apart in both directions; only conflicting lines
 * need the order of their colours. One group for each colour would do, but in a large space every colour would then
 * read all memory. So layers are processed in blocks of triples, as a wave: block b takes the first third of the
 * colours, one triple later the second third, and two triples later the last third. Every conflicting line of a lower
 * colour is then in an earlier group. The width of a block changes no result; it is the smallest that fills the lanes
 * with the lines of a group.
 */
static void make_groups(rheo__neighbours *n)
{
    enum { THIRDS = 3, LINES_FOR_ALL_LANES = 64 };
    uint32_t lines = n->line_count, *triple = n->line_group, place = 0, before = triple[0];
    /* Number the layers without the empty ones of a gap, except those that keep colours and distances distinct. */
    for (uint32_t l = 0; l < lines; l++) {
        uint32_t layer = triple[l], gap = layer - before;
        place += gap <= 3 ? gap : 3 + gap % 3;
        before = layer;
        triple[l] = place;
    }
    /* Each triple begins with the first third of the colours. */
    uint32_t first = n->line_colour[0] / THIRDS;
    for (uint32_t l = 0; l < lines; l++)
        triple[l] = (triple[l] + first) / THIRDS;
    uint32_t triples = triple[lines - 1] + 1, wanted = LINES_FOR_ALL_LANES * RHEO__COLOURS;
    uint32_t block = (uint32_t)((uint64_t)wanted * triples / lines) + 1;
    if (triples < 4 * block)
        block = triples + THIRDS;
    /* At most lines/64 + 2 x 9: see reserve(). */
    uint32_t groups = RHEO__COLOURS * ((triples + THIRDS - 1) / block + 1);

    uint32_t *start = n->group_start;
    memset(start, 0, ((size_t)groups + 1) * sizeof *start);
    for (uint32_t l = 0; l < lines; l++) {
        n->line_group[l] = RHEO__COLOURS * ((triple[l] + n->line_colour[l] / THIRDS) / block) + n->line_colour[l];
        start[n->line_group[l] + 1]++;
    }
    for (uint32_t g = 0; g < groups; g++)
        start[g + 1] += start[g];
    for (uint32_t l = 0; l < lines; l++)
        n->line[start[n->line_group[l]]++] = n->line_other[l];
    memmove(start + 1, start, groups * sizeof *start); /* filling has advanced each start to the next one */
    start[0] = 0;
    n->group_count = groups;
}

/* Makes whole rows. Visiting the pairs by lower rank fills every row in ascending order. */
static bool make_whole_rows(rheo__neighbours *n, const rheo__pairs *pairs, const rheo_allocator *allocator)
{
    uint32_t rows = pairs->rows, *start = n->row_start;
    size_t count = rheo__pairs_count(pairs);
    if (count > UINT32_MAX / 2)
        return false;
    void *row = n->row;
    if (!rheo__grow(allocator, &row, &n->row_capacity, 2 * count + 1, 0, sizeof *n->row))
        return false;
    n->row = row;
    memset(start, 0, ((size_t)rows + 1) * sizeof *start);
    for (size_t k = 0; k < count; k++)
        start[pairs->partner[k] + 1]++;
    n->longest_row = 0;
    for (uint32_t i = 0; i < rows; i++) {
        uint32_t length = start[i + 1] + pairs->start[i + 1] - pairs->start[i];
        n->longest_row = length > n->longest_row ? length : n->longest_row;
        start[i + 1] = start[i] + length;
    }
    for (uint32_t i = 0; i < rows; i++) {
        uint32_t own = start[i];
        for (uint32_t k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
            uint32_t j = pairs->partner[k];
            n->row[own++] = j;
            n->row[start[j]++] = i;
        }
        start[i] = own;
    }
    /* Filling has advanced each start to that of the next row. */
    memmove(start + 1, start, rows * sizeof *start);
    start[0] = 0;
    n->row[2 * count] = rows;
    return true;
}

/* Ranks the particles by cell. False: no memory. */
static bool sort_into_cells(rheo__neighbours *n, rheo__pairs *pairs, const rheo_allocator *allocator, uint32_t count,
                            const rheo_real *position, double support, const rheo__period *period, rheo__cells *cells,
                            rheo__cell_layout *layout)
{
    if (!reserve(n, allocator, count) || !rheo__pairs_reserve_rows(pairs, allocator, count) ||
        !rheo__pairs_reserve(pairs, allocator, 1, 0))
        return false;
    rheo__pairs_shape(pairs, count, 1);
    n->line_count = n->group_count = n->images = 0;
    *cells = (rheo__cells){0};
    if (count == 0) {
        pairs->start[0] = n->row_start[0] = 0;
        return true;
    }
    /*
     * Cells are wider than the support by more than the rounding of x * cells_per_length, so the particles of a pair
     * are in the same or in adjacent cells.
     */
    *layout = make_keys(n, count, position, support * (1 + 1.0 / (1 << 20)), period);
    for (uint32_t i = 0; i < count; i++)
        pairs->id_of[i] = i;
    sort_by_key(n, pairs->id_of, count, layout->bits[ALONG] + layout->bits[ACROSS] + layout->bits[LAYER]);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t id = pairs->id_of[i];
        pairs->rank_of[id] = i;
        n->x[i] = position[3 * (size_t)id];
        n->y[i] = position[3 * (size_t)id + 1];
        n->z[i] = position[3 * (size_t)id + 2];
    }
    *cells = (rheo__cells){make_cells(n, count), UINT64_C(1) << layout->bits[ALONG],
                           UINT64_C(1) << (layout->bits[ALONG] + layout->bits[ACROSS])};
    return true;
}

bool rheo__neighbours_build(rheo__neighbours *n, rheo__pairs *pairs, const rheo_allocator *allocator, uint32_t count,
                            const rheo_real *position, double support, bool with_rows)
{
    rheo__cells cells;
    rheo__cell_layout layout;
    if (!sort_into_cells(n, pairs, allocator, count, position, support, NULL, &cells, &layout))
        return false;
    if (count == 0)
        return true;
    if (!reserve_lines(n, allocator))
        return false;
    make_lines(n, count, &layout);
    make_groups(n);
    return rheo__find_pairs(n, &cells, pairs, allocator, (rheo_real)support, with_rows) &&
           (!with_rows || make_whole_rows(n, pairs, allocator));
}

bool rheo__neighbours_build_rows(rheo__neighbours *n, rheo__pairs *ranks, const rheo_allocator *allocator,
                                 uint32_t count, const rheo_real *position, double support, const rheo_real *margin,
                                 const rheo__period *period)
{
    rheo__cells cells;
    rheo__cell_layout layout;
    rheo_real largest = 0;
    for (uint32_t i = 0; margin && i < count; i++)
        largest = rheo__max(largest, margin[i]);
    if (!sort_into_cells(n, ranks, allocator, count, position, support + 2 * (double)largest, period, &cells,
                         &layout))
        return false;
    for (uint32_t i = 0; margin && i < count; i++)
        n->reach[i] = (rheo_real)(support / 2) + margin[ranks->id_of[i]];
    if (count && period)
        return rheo__find_periodic_rows(n, &cells, &layout, period, count, allocator, (rheo_real)support,
                                        margin != NULL);
    return count == 0 || rheo__find_rows(n, &cells, count, allocator, (rheo_real)support, margin != NULL);
}
