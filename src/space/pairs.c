/*
 * The pairs closer than the support (space/pairs.h): the particles of a cell are tested against those in it and in
 * half of the cells around it, since a pair belongs to its lower rank. Because cells are sorted, the three cells of a
 * line that are next to a cell are one range of ranks, and the ranges move forward together with the cell: no hash
 * table, no grid.
 */
#include "space/pairs.h"

#include <string.h>

#include "space/append.h"

enum {
    NEXT_LINES = 4, /* after a cell's own: the next line, and three adjacent ones in the next layer */
    LINES = 9,      /* around a cell, its own included */
};

/*
 * Candidates for the neighbours of the particles of a cell: copies of the particles in and around it, ascending, so
 * that a row is one loop over adjacent memory. A box around the cell's particles leaves out half of those around: a
 * particle is at least as far from each particle of the cell as from the box, also after rounding, which keeps the
 * order of numbers. Copying and testing use whole vectors; lanes after the last candidate are far from every particle.
 */
typedef struct candidates {
    rheo_real *x, *y, *z, *reach;
    uint32_t *rank;
    uint32_t count;
    rheo__hit_order order;
    rheo__ranks lanes;                  /* 0, 1, 2 ... */
    rheo_real low[3], high[3], longest; /* the box, and the largest reach of the particles in it */
} candidates;

/*
 * Places the candidates in the second half of the arrays of positions, and in the array of ids that the sort no
 * longer needs.
 */
static void prepare_candidates(candidates *near, const rheo__neighbours *n)
{
    size_t behind = n->particle_capacity + RHEO__PADDING;
    near->x = n->x + behind;
    near->y = n->y + behind;
    near->z = n->z + behind;
    near->reach = n->reach + behind;
    near->rank = n->id_other;
    rheo__make_hit_order(&near->order);
    uint32_t lane[RHEO__LANES];
    for (uint32_t k = 0; k < RHEO__LANES; k++)
        lane[k] = k;
    memcpy(&near->lanes, lane, sizeof lane);
}

/* Puts the box around the particles of a cell. Comparisons leave out NaN, which has no neighbours. */
static inline void set_box(candidates *near, const rheo__neighbours *n, uint32_t first, uint32_t end, bool with_reach)
{
    const rheo_real infinity = (rheo_real)__builtin_inf();
    rheo_real low[3] = {infinity, infinity, infinity}, high[3] = {-infinity, -infinity, -infinity}, longest = 0;
    for (uint32_t i = first; i < end; i++) {
        const rheo_real position[3] = {n->x[i], n->y[i], n->z[i]};
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = rheo__min(position[axis], low[axis]);
            high[axis] = rheo__max(position[axis], high[axis]);
        }
        if (with_reach)
            longest = rheo__max(n->reach[i], longest);
    }
    memcpy(near->low, low, sizeof low);
    memcpy(near->high, high, sizeof high);
    near->longest = longest;
}

/* Adds the particles of the cell itself. */
static inline void add_own(candidates *near, const rheo__neighbours *n, uint32_t first, uint32_t end, bool with_reach)
{
    for (uint32_t j = first, to = near->count; j < end; j += RHEO__LANES, to += RHEO__LANES) {
        const rheo__ranks ranks = near->lanes + j;
        memcpy(near->x + to, n->x + j, sizeof(rheo__lanes));
        memcpy(near->y + to, n->y + j, sizeof(rheo__lanes));
        memcpy(near->z + to, n->z + j, sizeof(rheo__lanes));
        memcpy(near->rank + to, &ranks, sizeof ranks);
        if (with_reach)
            memcpy(near->reach + to, n->reach + j, sizeof(rheo__lanes));
    }
    near->count += end - first;
}

/* Distances from an interval; 0 inside. */
static inline rheo__lanes outside(rheo__lanes x, rheo_real low, rheo_real high)
{
    return rheo__lanes_max(rheo__lanes_max(low - x, x - high), rheo__lanes_all(0));
}

/* Squares of the distances below which particles are neighbours of one with this reach. */
static inline rheo__lanes squared_reaches(const rheo_real *reaches, rheo_real support, rheo_real own, bool with_reach)
{
    rheo__lanes reach;
    if (!with_reach)
        return rheo__lanes_all(support * support);
    memcpy(&reach, reaches, sizeof reach);
    reach += own;
    return reach * reach;
}

/* Adds those of some particles that are close enough to the box. */
RHEO__FOR_EACH_CASE void add_near_box(candidates *near, const rheo__neighbours *n, uint32_t first, uint32_t end,
                                      rheo_real support, bool with_reach)
{
    const rheo_real *const px = n->x, *const py = n->y, *const pz = n->z, *const reaches = n->reach;
    uint32_t count = near->count;
    for (uint32_t j = first; j < end; j += RHEO__LANES) {
        rheo__lanes x, y, z, reach;
        memcpy(&x, px + j, sizeof x);
        memcpy(&y, py + j, sizeof y);
        memcpy(&z, pz + j, sizeof z);
        const rheo__lanes dx = outside(x, near->low[0], near->high[0]), dy = outside(y, near->low[1], near->high[1]),
                          dz = outside(z, near->low[2], near->high[2]),
                          limit2 = squared_reaches(reaches + j, support, near->longest, with_reach);
        const rheo__hits hits =
            rheo__find_hits(&near->order, dx * dx + dy * dy + dz * dz, limit2, rheo__lanes_before(end - j));
        rheo__write_values(&hits, x, near->x + count);
        rheo__write_values(&hits, y, near->y + count);
        rheo__write_values(&hits, z, near->z + count);
        rheo__write_numbers(&hits, j, near->rank + count);
        if (with_reach) {
            memcpy(&reach, reaches + j, sizeof reach);
            rheo__write_values(&hits, reach, near->reach + count);
        }
        count += hits.count;
    }
    near->count = count;
}

static inline void close_candidates(candidates *near)
{
    rheo__lanes nowhere = rheo__lanes_all((rheo_real)__builtin_nan(""));
    memcpy(near->x + near->count, &nowhere, sizeof nowhere);
}

/* Squared distances of a point from the candidates of one vector. */
static inline rheo__lanes squared_distances(const candidates *near, uint32_t first, rheo_real x, rheo_real y,
                                            rheo_real z)
{
    rheo__lanes dx, dy, dz;
    memcpy(&dx, near->x + first, sizeof dx);
    memcpy(&dy, near->y + first, sizeof dy);
    memcpy(&dz, near->z + first, sizeof dz);
    dx -= x;
    dy -= y;
    dz -= z;
    return dx * dx + dy * dy + dz * dz;
}

/*
 * Appends to the partners the candidates from `first` on that are closer to `own` than the support, or the reach of
 * both. Returns the new count. The array must have room for RHEO__LANES more. A particle is no hit of its own.
 */
static inline uint32_t append_close(const candidates *near, uint32_t own, uint32_t first, rheo_real support,
                                    uint32_t *partner, rheo_real *distance2, uint32_t count, bool with_distance,
                                    bool with_reach)
{
    const rheo_real x = near->x[own], y = near->y[own], z = near->z[own], reach = with_reach ? near->reach[own] : 0;
    const uint32_t own_rank = near->rank[own];
    for (uint32_t j = first; j < near->count; j += RHEO__LANES) {
        const rheo__lanes r2 = squared_distances(near, j, x, y, z),
                          limit2 = squared_reaches(near->reach + j, support, reach, with_reach);
        const rheo__hits hits =
            rheo__find_hits(&near->order, r2, limit2, rheo__lanes_unlike(near->rank + j, own_rank, own - j));
        rheo__write_ranks(&hits, near->rank + j, partner + count);
        if (with_distance)
            rheo__write_values(&hits, r2, distance2 + count);
        count += hits.count;
    }
    return count;
}

/* Makes room for `count` pairs and keeps the first `kept`. False: no memory. */
static inline bool reserve(rheo__neighbours *n, rheo__pairs *pairs, const rheo_allocator *allocator, size_t count,
                           size_t kept, bool with_distance)
{
    if (!rheo__pairs_reserve(pairs, allocator, count, kept))
        return false;
    if (!with_distance || count <= n->distance_capacity)
        return true;
    void *distance2 = n->distance2;
    bool grown =
        rheo__grow(allocator, &distance2, &n->distance_capacity, pairs->capacity, kept, sizeof *n->distance2);
    n->distance2 = distance2;
    return grown;
}

bool RHEO__VARIANT(find_pairs)(rheo__neighbours *n, const rheo__cells *cells, rheo__pairs *pairs,
                               const rheo_allocator *allocator, rheo_real support, bool with_distance)
{
    const uint64_t line = cells->to_next_line, layer = cells->to_next_layer;
    const uint64_t offset[NEXT_LINES] = {line, layer - line, layer, layer + line};
    /* The cells low[l] to high[l] - 1 of line l are next to the present cell. */
    uint32_t low[NEXT_LINES] = {0}, high[NEXT_LINES] = {0};
    candidates near;
    prepare_candidates(&near, n);

    size_t count = 0;
    for (uint32_t c = 0; c < cells->count; c++) {
        uint32_t cell_start = n->cell_start[c], cell_end = n->cell_start[c + 1];
        bool beside = c + 1 < cells->count && n->cell_key[c + 1] == n->cell_key[c] + 1;
        near.count = 0;
        set_box(&near, n, cell_start, cell_end, false);
        add_own(&near, n, cell_start, cell_end, false);
        add_near_box(&near, n, cell_end, beside ? n->cell_start[c + 2] : cell_end, support, false);
        for (int l = 0; l < NEXT_LINES; l++) {
            uint64_t middle = n->cell_key[c] + offset[l];
            while (low[l] < cells->count && n->cell_key[low[l]] < middle - 1)
                low[l]++;
            high[l] = high[l] < low[l] ? low[l] : high[l];
            while (high[l] < cells->count && n->cell_key[high[l]] <= middle + 1)
                high[l]++;
            add_near_box(&near, n, n->cell_start[low[l]], n->cell_start[high[l]], support, false);
        }
        close_candidates(&near);
        for (uint32_t i = cell_start; i < cell_end; i++) {
            if (!reserve(n, pairs, allocator, count + near.count + RHEO__PADDING, count, with_distance))
                return false;
            pairs->start[i] = (uint32_t)count;
            uint32_t own = i - cell_start, now = (uint32_t)count;
            /* Two calls, so that each is compiled for its own case. */
            count = with_distance
                        ? append_close(&near, own, own + 1, support, pairs->partner, n->distance2, now, true, false)
                        : append_close(&near, own, own + 1, support, pairs->partner, NULL, now, false, false);
        }
    }
    pairs->start[pairs->rows] = (uint32_t)count;
    pairs->partner[count] = pairs->rows; /* read by rows without partners: see space/walk.h */
    return true;
}

/* Cells next to the present one, in each of the nine lines around it: windows that move forward with it. */
typedef struct windows {
    uint32_t low[LINES], high[LINES]; /* cells from low to high - 1 */
} windows;

/* Gathers the particles of all cells around a cell, in ascending order. Returns the index of the cell's first one. */
RHEO__FOR_EACH_CASE uint32_t gather_around(candidates *near, windows *w, const rheo__neighbours *n,
                                           const rheo__cells *cells, uint32_t cell, rheo_real support,
                                           bool with_reach)
{
    const uint32_t first = n->cell_start[cell], end = n->cell_start[cell + 1];
    uint32_t own = 0;
    near->count = 0;
    set_box(near, n, first, end, with_reach);
    for (int l = 0; l < LINES; l++) {
        const uint64_t middle = n->cell_key[cell] + (uint64_t)(l / 3 - 1) * cells->to_next_layer +
                                (uint64_t)(l % 3 - 1) * cells->to_next_line;
        while (w->low[l] < cells->count && n->cell_key[w->low[l]] < middle - 1)
            w->low[l]++;
        w->high[l] = w->high[l] < w->low[l] ? w->low[l] : w->high[l];
        while (w->high[l] < cells->count && n->cell_key[w->high[l]] <= middle + 1)
            w->high[l]++;
        uint32_t from = n->cell_start[w->low[l]];
        if (l == LINES / 2) {
            add_near_box(near, n, from, first, support, with_reach);
            own = near->count;
            add_own(near, n, first, end, with_reach);
            from = end;
        }
        add_near_box(near, n, from, n->cell_start[w->high[l]], support, with_reach);
    }
    close_candidates(near);
    return own;
}

RHEO__FOR_EACH_CASE bool find_rows(rheo__neighbours *n, const rheo__cells *cells, uint32_t rows,
                                   const rheo_allocator *allocator, rheo_real support, bool with_reach)
{
    windows w = {{0}, {0}};
    candidates near;
    prepare_candidates(&near, n);

    size_t count = 0;
    n->longest_row = 0;
    for (uint32_t c = 0; c < cells->count; c++) {
        const uint32_t cell_start = n->cell_start[c], cell_end = n->cell_start[c + 1];
        uint32_t own = gather_around(&near, &w, n, cells, c, support, with_reach);
        for (uint32_t i = cell_start; i < cell_end; i++, own++) {
            const size_t wanted = count + near.count + RHEO__PADDING;
            if (wanted > n->row_capacity) {
                void *row = n->row;
                if (count > UINT32_MAX / 2 ||
                    !rheo__grow(allocator, &row, &n->row_capacity, wanted, count, sizeof *n->row))
                    return false;
                n->row = row;
            }
            n->row_start[i] = (uint32_t)count;
            const uint32_t end =
                append_close(&near, own, 0, support, n->row, NULL, (uint32_t)count, false, with_reach);
            n->longest_row = end - (uint32_t)count > n->longest_row ? end - (uint32_t)count : n->longest_row;
            count = end;
        }
    }
    n->row_start[rows] = (uint32_t)count;
    n->row[count] = rows;
    return true;
}

bool RHEO__VARIANT(find_rows)(rheo__neighbours *n, const rheo__cells *cells, uint32_t rows,
                              const rheo_allocator *allocator, rheo_real support, bool with_reach)
{
    /* Two calls, so that each is compiled for its own case. */
    return with_reach ? find_rows(n, cells, rows, allocator, support, true)
                      : find_rows(n, cells, rows, allocator, support, false);
}
