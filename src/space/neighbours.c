/*
 * Neighbour lists (space/neighbours.h): cells by sorting keys, rows by testing the particles of the cells around.
 *
 * Only half of the surrounding cells are searched, since a pair belongs to its lower rank; the other halves of the
 * rows follow from the pairs. Because cells are sorted, each line of three cells next to a cell is one range of
 * ranks, and the ranges move forward together with the cell: no hash table, no grid.
 */
#include "space/neighbours.h"

#include <string.h>

#include "core/target.h"

#ifdef RHEO_AVX2
#include <immintrin.h>
#endif

enum {
    LANES = 8,
    PADDING = LANES,
    RADIX_BITS = 12,
    NEXT_LINES = 4, /* lines ahead of a cell's own: (y+1, z), (y-1, z+1), (y, z+1), (y+1, z+1) */
};

#define LARGEST_CELL ((1 << 20) - 2)

typedef rheo_real lanes __attribute__((vector_size(LANES * sizeof(rheo_real))));
typedef uint32_t rank_lanes __attribute__((vector_size(LANES * sizeof(uint32_t))));

void rheo_neighbours_release(rheo_neighbours *n, const rheo_allocator *allocator)
{
    void *arrays[] = {n->line,     n->line_other, n->line_colour, n->row_start, n->row, n->key, n->key_other,
                      n->id_other, n->cell_key,   n->cell_start,  n->x,         n->y,   n->z};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        rheo_release(allocator, arrays[i]);
    memset(n, 0, sizeof *n);
}

static bool reserve(rheo_neighbours *n, const rheo_allocator *allocator, uint32_t rows)
{
    if (rows <= n->particle_capacity && n->line)
        return true;
    rheo_neighbours_release(n, allocator); /* nothing in it outlives a step */
    size_t wanted = rows + (size_t)rows / 4 + 1;
    n->line = rheo_allocate(allocator, wanted, sizeof *n->line);
    n->line_other = rheo_allocate(allocator, wanted, sizeof *n->line_other);
    n->line_colour = rheo_allocate(allocator, wanted, sizeof *n->line_colour);
    n->row_start = rheo_allocate(allocator, wanted + 1, sizeof *n->row_start);
    n->key = rheo_allocate(allocator, wanted, sizeof *n->key);
    n->key_other = rheo_allocate(allocator, wanted, sizeof *n->key_other);
    n->id_other = rheo_allocate(allocator, wanted + PADDING, sizeof *n->id_other);
    n->cell_key = rheo_allocate(allocator, wanted, sizeof *n->cell_key);
    n->cell_start = rheo_allocate(allocator, wanted + 1, sizeof *n->cell_start);
    n->x = rheo_allocate(allocator, 2 * (wanted + PADDING), sizeof *n->x);
    n->y = rheo_allocate(allocator, 2 * (wanted + PADDING), sizeof *n->y);
    n->z = rheo_allocate(allocator, 2 * (wanted + PADDING), sizeof *n->z);
    if (!n->line || !n->line_other || !n->line_colour || !n->row_start || !n->key || !n->key_other || !n->id_other ||
        !n->cell_key || !n->cell_start || !n->x || !n->y || !n->z) {
        rheo_neighbours_release(n, allocator);
        return false;
    }
    n->particle_capacity = wanted;
    return true;
}

/* floor(x * cells_per_length) held inside the outermost cells; a NaN goes to the lowest. */
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
 * Stable sort of (key, id) by key, the ids ascending at the start: least digit first, only as many digits as the
 * occupied space needs. Returns with the sorted keys in n->key and the ids in *id.
 */
static void sort_by_key(rheo_neighbours *n, uint32_t *id, uint32_t count, uint32_t bits)
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

/* Where the bits of a cell's coordinates lie in its key: x lowest. Each has a free place below and above. */
typedef struct key_layout {
    int32_t lowest[3];
    uint32_t bits[3];
} key_layout;

static key_layout make_keys(rheo_neighbours *n, uint32_t count, const rheo_real *position, double cells_per_length)
{
    enum { BITS = 21, MASK = (1 << BITS) - 1 };
    _Static_assert(2 * LARGEST_CELL < MASK, "three coordinates of a cell fit into one key");
    int32_t low[3] = {LARGEST_CELL, LARGEST_CELL, LARGEST_CELL};
    int32_t high[3] = {-LARGEST_CELL, -LARGEST_CELL, -LARGEST_CELL};
    for (uint32_t i = 0; i < count; i++) {
        uint64_t key = 0;
        for (int axis = 2; axis >= 0; axis--) {
            int32_t cell = cell_of(position[3 * (size_t)i + (size_t)axis], cells_per_length);
            low[axis] = cell < low[axis] ? cell : low[axis];
            high[axis] = cell > high[axis] ? cell : high[axis];
            key = key << BITS | (uint32_t)(cell + LARGEST_CELL);
        }
        n->key[i] = key;
    }
    key_layout layout;
    uint64_t base[3];
    for (int axis = 0; axis < 3; axis++) {
        layout.lowest[axis] = low[axis] - 1;
        layout.bits[axis] = bits_for((uint32_t)(high[axis] - low[axis]) + 2);
        base[axis] = (uint64_t)(layout.lowest[axis] + LARGEST_CELL);
    }
    uint32_t to_y = layout.bits[0], to_z = layout.bits[0] + layout.bits[1];
    for (uint32_t i = 0; i < count; i++) {
        uint64_t key = n->key[i];
        n->key[i] = ((key & MASK) - base[0]) | ((key >> BITS & MASK) - base[1]) << to_y |
                    ((key >> 2 * BITS) - base[2]) << to_z;
    }
    return layout;
}

static uint32_t modulo3(int32_t value)
{
    int32_t rest = value % 3;
    return (uint32_t)(rest < 0 ? rest + 3 : rest);
}

/* Occupied cells, and the lines by colour (a stable counting sort, so by place within a colour). */
static uint32_t make_cells(rheo_neighbours *n, uint32_t count, const key_layout *layout)
{
    uint32_t cells = 0, lines = 0, *colour_start = n->colour_start;
    memset(n->colour_start, 0, sizeof n->colour_start);
    for (uint32_t i = 0; i < count; i++) {
        if (i && n->key[i] == n->key[i - 1])
            continue;
        uint64_t line = n->key[i] >> layout->bits[0];
        if (i == 0 || line != n->key[i - 1] >> layout->bits[0]) {
            if (lines)
                n->line_other[lines - 1].end = i;
            uint32_t y = (uint32_t)(line & ((UINT64_C(1) << layout->bits[1]) - 1));
            uint32_t z = (uint32_t)(line >> layout->bits[1]);
            uint32_t colour = modulo3((int32_t)y + layout->lowest[1]) + 3 * modulo3((int32_t)z + layout->lowest[2]);
            n->line_other[lines].first = i;
            n->line_colour[lines++] = (uint8_t)colour;
            colour_start[colour + 1]++;
        }
        n->cell_key[cells] = n->key[i];
        n->cell_start[cells++] = i;
    }
    if (lines)
        n->line_other[lines - 1].end = count;
    n->cell_start[cells] = count;
    for (int colour = 0; colour < RHEO_COLOURS; colour++)
        colour_start[colour + 1] += colour_start[colour];
    uint32_t place[RHEO_COLOURS];
    memcpy(place, colour_start, sizeof place);
    for (uint32_t l = 0; l < lines; l++)
        n->line[place[n->line_colour[l]]++] = n->line_other[l];
    n->line_count = lines;
    return cells;
}

/*
 * What the particles of a cell are tested against: copies of the ranks in and around it, ascending, so that a
 * row is one loop over adjacent memory. Copying and testing go by whole vectors; behind the last candidate
 * lie lanes that nothing is close to.
 */
typedef struct candidates {
    rheo_real *x, *y, *z;
    uint32_t *rank;
    uint32_t count;
#ifdef RHEO_AVX2
    uint64_t order[1 << LANES]; /* the lane numbers in each set of lanes, ascending, a byte each */
#endif
} candidates;

/* Their memory is the second half of the positions' arrays, and the ids that the sort has done with. */
static void prepare_candidates(candidates *near, const rheo_neighbours *n)
{
    size_t behind = n->particle_capacity + PADDING;
    near->x = n->x + behind;
    near->y = n->y + behind;
    near->z = n->z + behind;
    near->rank = n->id_other;
#ifdef RHEO_AVX2
    near->order[0] = 0;
    for (uint32_t lane = 0; lane < LANES; lane++)
        for (uint32_t set = 0; set < UINT32_C(1) << lane; set++)
            near->order[set | UINT32_C(1) << lane] = near->order[set] | (uint64_t)lane << 8 * __builtin_popcount(set);
#endif
}

static inline void add_candidates(candidates *near, const rheo_neighbours *n, uint32_t first, uint32_t end)
{
    uint32_t to = near->count;
    for (uint32_t j = first; j < end; j += LANES, to += LANES) {
        rank_lanes rank = j + (rank_lanes){0, 1, 2, 3, 4, 5, 6, 7};
        memcpy(near->x + to, n->x + j, sizeof(lanes));
        memcpy(near->y + to, n->y + j, sizeof(lanes));
        memcpy(near->z + to, n->z + j, sizeof(lanes));
        memcpy(near->rank + to, &rank, sizeof rank);
    }
    near->count += end - first;
}

static inline void close_candidates(candidates *near)
{
    lanes nowhere = (rheo_real)__builtin_nan("") + (lanes){0};
    memcpy(near->x + near->count, &nowhere, sizeof nowhere);
}

/*
 * Squared distances of a point from eight candidates; to memory, since how lanes are returned depends on the
 * target.
 */
static inline void squared_distances(lanes *r2, const candidates *near, uint32_t first, rheo_real x, rheo_real y,
                                     rheo_real z)
{
    lanes dx, dy, dz;
    memcpy(&dx, near->x + first, sizeof dx);
    memcpy(&dy, near->y + first, sizeof dy);
    memcpy(&dz, near->z + first, sizeof dz);
    dx -= x;
    dy -= y;
    dz -= z;
    *r2 = dx * dx + dy * dy + dz * dz;
}

/*
 * Appends the candidates after `own` that are closer to it than the support to the pairs, which have room
 * for LANES more than that; returns the new count. Squared distances are not negative, so their bits compare
 * as they do; a NaN is larger than anything. Every candidate is written and only a hit moves on: no branch to
 * mispredict.
 */
static inline uint32_t append_close(const candidates *near, uint32_t own, rheo_real support2, rheo_pairs *pairs,
                                    uint32_t count, bool with_distance)
{
    uint32_t *partner = pairs->partner;
    rheo_real *distance2 = pairs->distance2;
    rheo_real x = near->x[own], y = near->y[own], z = near->z[own];
    rheo_real_bits limit;
    memcpy(&limit, &support2, sizeof limit);
    for (uint32_t j = own + 1, end = near->count; j < end; j += LANES) {
        lanes r2;
        squared_distances(&r2, near, j, x, y, z);
        uint32_t rank[LANES];
        rheo_real value[LANES];
        rheo_real_bits bits[LANES];
        memcpy(rank, near->rank + j, sizeof rank);
        memcpy(value, &r2, sizeof value);
        memcpy(bits, &r2, sizeof bits);
        for (uint32_t lane = 0; lane < LANES; lane++) {
            partner[count] = rank[lane];
            if (with_distance)
                distance2[count] = value[lane];
            count += bits[lane] < limit;
        }
    }
    return count;
}

#ifdef RHEO_AVX2
/* The same: the hits of eight candidates are moved to the front and written at once. */
RHEO_AVX2 static uint32_t append_close_avx2(const candidates *near, uint32_t own, rheo_real support2,
                                            rheo_pairs *pairs, uint32_t count, bool with_distance)
{
    rheo_real x = near->x[own], y = near->y[own], z = near->z[own];
    for (uint32_t j = own + 1, end = near->count; j < end; j += LANES) {
        lanes r2;
        squared_distances(&r2, near, j, x, y, z);
        uint32_t hits = (uint32_t)_mm256_movemask_ps((__m256)(r2 < support2));
        __m256i order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((int64_t)near->order[hits]));
        __m256i rank = _mm256_loadu_si256((const __m256i *)(const void *)(near->rank + j));
        rank = _mm256_permutevar8x32_epi32(rank, order);
        _mm256_storeu_si256((__m256i *)(void *)(pairs->partner + count), rank);
        if (with_distance)
            _mm256_storeu_ps(pairs->distance2 + count, _mm256_permutevar8x32_ps((__m256)r2, order));
        count += (uint32_t)__builtin_popcount(hits);
    }
    return count;
}
#endif

static bool make_pairs(rheo_neighbours *n, rheo_pairs *pairs, const rheo_allocator *allocator, uint32_t cells,
                       const key_layout *layout, rheo_real support, bool with_distance)
{
    uint64_t to_y = UINT64_C(1) << layout->bits[0], to_z = to_y << layout->bits[1];
    uint64_t offset[NEXT_LINES] = {to_y, to_z - to_y, to_z, to_z + to_y};
    /* Cells from low[l] to high[l] - 1 are those beside the present cell in line l. */
    uint32_t low[NEXT_LINES] = {0}, high[NEXT_LINES] = {0};
    rheo_real support2 = support * support;
    candidates near;
    prepare_candidates(&near, n);
#ifdef RHEO_AVX2
    bool avx2 = rheo_has_avx2();
#endif

    size_t count = 0;
    for (uint32_t c = 0; c < cells; c++) {
        uint32_t cell_start = n->cell_start[c], cell_end = n->cell_start[c + 1];
        bool beside = c + 1 < cells && n->cell_key[c + 1] == n->cell_key[c] + 1;
        near.count = 0;
        add_candidates(&near, n, cell_start, beside ? n->cell_start[c + 2] : cell_end);
        for (int l = 0; l < NEXT_LINES; l++) {
            uint64_t middle = n->cell_key[c] + offset[l];
            while (low[l] < cells && n->cell_key[low[l]] < middle - 1)
                low[l]++;
            high[l] = high[l] < low[l] ? low[l] : high[l];
            while (high[l] < cells && n->cell_key[high[l]] <= middle + 1)
                high[l]++;
            add_candidates(&near, n, n->cell_start[low[l]], n->cell_start[high[l]]);
        }
        close_candidates(&near);
        for (uint32_t i = cell_start; i < cell_end; i++) {
            if (!rheo_pairs_reserve(pairs, allocator, count + near.count + LANES, count))
                return false;
            pairs->start[i] = (uint32_t)count;
            uint32_t own = i - cell_start, now = (uint32_t)count;
#ifdef RHEO_AVX2
            if (avx2) {
                count = append_close_avx2(&near, own, support2, pairs, now, with_distance);
                continue;
            }
#endif
            /* Two calls, so that each is compiled for its own case. */
            count = with_distance ? append_close(&near, own, support2, pairs, now, true)
                                  : append_close(&near, own, support2, pairs, now, false);
        }
    }
    pairs->start[pairs->rows] = (uint32_t)count;
    return true;
}

/* Whole rows: visiting pairs by their lower rank appends to every row in ascending order, the own half last. */
static bool make_whole_rows(rheo_neighbours *n, const rheo_pairs *pairs, const rheo_allocator *allocator)
{
    uint32_t rows = pairs->rows, *start = n->row_start;
    size_t count = rheo_pairs_count(pairs);
    if (count > UINT32_MAX / 2)
        return false;
    void *row = n->row;
    if (!rheo_grow(allocator, &row, &n->row_capacity, 2 * count + 1, 0, sizeof *n->row))
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
    /* Filling has moved each start to the next row's. */
    memmove(start + 1, start, rows * sizeof *start);
    start[0] = 0;
    return true;
}

bool rheo_neighbours_build(rheo_neighbours *n, rheo_pairs *pairs, const rheo_allocator *allocator, uint32_t count,
                           const rheo_real *position, double support, bool with_rows)
{
    if (!reserve(n, allocator, count) || !rheo_pairs_reserve_rows(pairs, allocator, count) ||
        !rheo_pairs_reserve(pairs, allocator, 1, 0))
        return false;
    pairs->rows = count;
    if (count == 0) {
        pairs->start[0] = n->row_start[0] = n->line_count = 0;
        memset(n->colour_start, 0, sizeof n->colour_start);
        return true;
    }
    /* Wider than the support by more than the rounding of x * cells_per_length, so that a pair is never two cells
     * apart. */
    double cells_per_length = 1 / (support * (1 + 1.0 / (1 << 20)));
    key_layout layout = make_keys(n, count, position, cells_per_length);
    for (uint32_t i = 0; i < count; i++)
        pairs->id_of[i] = i;
    sort_by_key(n, pairs->id_of, count, layout.bits[0] + layout.bits[1] + layout.bits[2]);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t id = pairs->id_of[i];
        pairs->rank_of[id] = i;
        n->x[i] = position[3 * (size_t)id];
        n->y[i] = position[3 * (size_t)id + 1];
        n->z[i] = position[3 * (size_t)id + 2];
    }
    uint32_t cells = make_cells(n, count, &layout);
    return make_pairs(n, pairs, allocator, cells, &layout, (rheo_real)support, with_rows) &&
           (!with_rows || make_whole_rows(n, pairs, allocator));
}
