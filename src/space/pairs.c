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
 * Candidates for the neighbours of the particles of a cell: copies of the ranks in and around it, ascending, so that
 * a row is one loop over adjacent memory. Copying and testing use whole vectors; lanes after the last candidate are
 * far from every particle.
 */
typedef struct candidates {
    rheo_real *x, *y, *z, *reach;
    uint32_t *rank;
    uint32_t count;
    rheo__hit_order order;
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
}

static inline void add_candidates(candidates *near, const rheo__neighbours *n, uint32_t first, uint32_t end,
                                  bool with_reach)
{
    uint32_t rank[RHEO__LANES];
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
        rank[lane] = first + lane;
    rheo__ranks ranks;
    memcpy(&ranks, rank, sizeof ranks);
    uint32_t to = near->count;
    for (uint32_t j = first; j < end; j += RHEO__LANES, to += RHEO__LANES) {
        memcpy(near->x + to, n->x + j, sizeof(rheo__lanes));
        memcpy(near->y + to, n->y + j, sizeof(rheo__lanes));
        memcpy(near->z + to, n->z + j, sizeof(rheo__lanes));
        memcpy(near->rank + to, &ranks, sizeof ranks);
        if (with_reach)
            memcpy(near->reach + to, n->reach + j, sizeof(rheo__lanes));
        ranks += RHEO__LANES;
    }
    near->count += end - first;
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

/* Squares of the distances below which these candidates are neighbours of a particle with this reach. */
static inline rheo__lanes squared_reaches(const candidates *near, uint32_t first, rheo_real support, rheo_real own,
                                          bool with_reach)
{
    rheo__lanes reach;
    if (!with_reach)
        return rheo__lanes_all(support * support);
    memcpy(&reach, near->reach + first, sizeof reach);
    reach += own;
    return reach * reach;
}

/*
 * Appends to the partners the candidates from first to end - 1 that are closer to `own` than the support, or the reach
 * of both. Returns the new count. The array must have room for RHEO__LANES more. Every candidate is written but only
 * hits are counted, so there is no branch to mispredict. Candidates after the end, which fill the last vector, must
 * not be hits. A particle is no hit of its own.
 */
static inline uint32_t append_close(const candidates *near, uint32_t own, uint32_t first, uint32_t end,
                                    rheo_real support, uint32_t *partner, rheo_real *distance2, uint32_t count,
                                    bool with_distance, bool with_reach)
{
    rheo_real x = near->x[own], y = near->y[own], z = near->z[own];
    const rheo_real reach = with_reach ? near->reach[own] : 0;
    for (uint32_t j = first; j < end; j += RHEO__LANES) {
        const rheo__lanes r2 = squared_distances(near, j, x, y, z),
                          limit2 = squared_reaches(near, j, support, reach, with_reach);
        const uint32_t own_lane = own - j < RHEO__LANES ? own - j : RHEO__LANES; /* or none */
        count = rheo__append_hits(&near->order, near->rank + j, r2, limit2, own_lane, partner, distance2, count,
                                  with_distance);
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
        add_candidates(&near, n, cell_start, beside ? n->cell_start[c + 2] : cell_end, false);
        for (int l = 0; l < NEXT_LINES; l++) {
            uint64_t middle = n->cell_key[c] + offset[l];
            while (low[l] < cells->count && n->cell_key[low[l]] < middle - 1)
                low[l]++;
            high[l] = high[l] < low[l] ? low[l] : high[l];
            while (high[l] < cells->count && n->cell_key[high[l]] <= middle + 1)
                high[l]++;
            add_candidates(&near, n, n->cell_start[low[l]], n->cell_start[high[l]], false);
        }
        close_candidates(&near);
        for (uint32_t i = cell_start; i < cell_end; i++) {
            if (!reserve(n, pairs, allocator, count + near.count + RHEO__PADDING, count, with_distance))
                return false;
            pairs->start[i] = (uint32_t)count;
            uint32_t own = i - cell_start, now = (uint32_t)count;
            /* Two calls, so that each is compiled for its own case. */
            count = with_distance ? append_close(&near, own, own + 1, near.count, support, pairs->partner,
                                                 n->distance2, now, true, false)
                                  : append_close(&near, own, own + 1, near.count, support, pairs->partner, NULL, now,
                                                 false, false);
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
static inline uint32_t gather_around(candidates *near, windows *w, const rheo__neighbours *n,
                                     const rheo__cells *cells, uint32_t cell, bool with_reach)
{
    uint32_t own = 0;
    near->count = 0;
    for (int l = 0; l < LINES; l++) {
        const uint64_t middle = n->cell_key[cell] + (uint64_t)(l / 3 - 1) * cells->to_next_layer +
                                (uint64_t)(l % 3 - 1) * cells->to_next_line;
        while (w->low[l] < cells->count && n->cell_key[w->low[l]] < middle - 1)
            w->low[l]++;
        w->high[l] = w->high[l] < w->low[l] ? w->low[l] : w->high[l];
        while (w->high[l] < cells->count && n->cell_key[w->high[l]] <= middle + 1)
            w->high[l]++;
        if (l == LINES / 2)
            own = near->count + n->cell_start[cell] - n->cell_start[w->low[l]];
        add_candidates(near, n, n->cell_start[w->low[l]], n->cell_start[w->high[l]], with_reach);
    }
    close_candidates(near);
    return own;
}

static inline bool find_rows(rheo__neighbours *n, const rheo__cells *cells, uint32_t rows,
                             const rheo_allocator *allocator, rheo_real support, bool with_reach)
{
    windows w = {{0}, {0}};
    candidates near;
    prepare_candidates(&near, n);

    size_t count = 0;
    n->longest_row = 0;
    for (uint32_t c = 0; c < cells->count; c++) {
        const uint32_t cell_start = n->cell_start[c], cell_end = n->cell_start[c + 1];
        uint32_t own = gather_around(&near, &w, n, cells, c, with_reach);
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
                append_close(&near, own, 0, near.count, support, n->row, NULL, (uint32_t)count, false, with_reach);
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
