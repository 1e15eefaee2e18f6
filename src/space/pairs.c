/*
 * The pairs closer than the support (space/pairs.h): the particles of a cell are tested against those in it and in
 * half of the cells around it, since a pair belongs to its lower rank. Because cells are sorted, the three cells of a
 * line that are next to a cell are one range of ranks, and the ranges move forward together with the cell: no hash
 * table, no grid.
 */
#include "space/pairs.h"

#include <string.h>

#include "core/lanes.h"

/* This variant can move the hits to the front of a vector and write them at once. */
#if !RHEO_DOUBLE && RHEO__LANES == 16 && defined(__AVX512F__)
#define COMPRESS_AVX512
#elif !RHEO_DOUBLE && RHEO__LANES == 8 && defined(__AVX2__)
#define COMPRESS_AVX2
#endif

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
    rheo_real *x, *y, *z, *margin;
    uint32_t *rank;
    uint32_t count;
#ifdef COMPRESS_AVX2
    uint64_t order[1 << RHEO__LANES]; /* the lane numbers in each set of lanes, ascending, one byte each */
#endif
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
    near->margin = n->margin + behind;
    near->rank = n->id_other;
#ifdef COMPRESS_AVX2
    near->order[0] = 0;
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
        for (uint32_t set = 0; set < UINT32_C(1) << lane; set++)
            near->order[set | UINT32_C(1) << lane] = near->order[set] | (uint64_t)lane << 8 * __builtin_popcount(set);
#endif
}

static inline void add_candidates(candidates *near, const rheo__neighbours *n, uint32_t first, uint32_t end,
                                  bool with_margins)
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
        if (with_margins)
            memcpy(near->margin + to, n->margin + j, sizeof(rheo__lanes));
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

/*
 * Squares of the distances below which these candidates are neighbours of a particle with this margin. Margins are
 * added first, so that both particles of a pair compute the same bits.
 */
static inline rheo__lanes squared_reaches(const candidates *near, uint32_t first, rheo_real support, rheo_real own,
                                          bool with_margins)
{
    rheo__lanes reach;
    if (!with_margins)
        return rheo__lanes_all(support * support);
    memcpy(&reach, near->margin + first, sizeof reach);
    reach = support + (reach + own);
    return reach * reach;
}

/*
 * Appends to the partners the candidates from first to end - 1 that are closer to `own` than the support (and
 * the margins of both). Returns the
 * new count. The array must have room for RHEO__LANES more. Every candidate is written but only hits are counted, so
 * there is no branch to mispredict. Candidates after the end, which fill the last vector, must not be hits.
 */
static inline uint32_t append_close(const candidates *near, uint32_t own, uint32_t first, uint32_t end,
                                    rheo_real support, uint32_t *partner, rheo_real *distance2, uint32_t count,
                                    bool with_distance, bool with_margins)
{
    rheo_real x = near->x[own], y = near->y[own], z = near->z[own];
    const rheo_real margin = with_margins ? near->margin[own] : 0;
    for (uint32_t j = first; j < end; j += RHEO__LANES) {
        const rheo__lanes r2 = squared_distances(near, j, x, y, z),
                          limit2 = squared_reaches(near, j, support, margin, with_margins);
#if defined(COMPRESS_AVX512)
        __mmask16 hits = _mm512_cmp_ps_mask((__m512)r2, (__m512)limit2, _CMP_LT_OQ);
        __m512i rank = _mm512_loadu_si512(near->rank + j);
        _mm512_storeu_si512(partner + count, _mm512_maskz_compress_epi32(hits, rank));
        if (with_distance)
            _mm512_storeu_ps(distance2 + count, _mm512_maskz_compress_ps(hits, (__m512)r2));
        count += (uint32_t)__builtin_popcount(hits);
#elif defined(COMPRESS_AVX2)
        uint32_t hits = (uint32_t)_mm256_movemask_ps((__m256)(r2 < limit2));
        __m256i order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((int64_t)near->order[hits]));
        __m256i rank = _mm256_loadu_si256((const __m256i *)(const void *)(near->rank + j));
        _mm256_storeu_si256((__m256i *)(void *)(partner + count), _mm256_permutevar8x32_epi32(rank, order));
        if (with_distance)
            _mm256_storeu_ps(distance2 + count, _mm256_permutevar8x32_ps((__m256)r2, order));
        count += (uint32_t)__builtin_popcount(hits);
#else
        /* Squared distances are not negative, so their bits have the order of their values; NaN is the largest. */
        rheo_real value[RHEO__LANES];
        rheo__real_bits bits[RHEO__LANES], limit[RHEO__LANES];
        memcpy(value, &r2, sizeof value);
        memcpy(bits, &r2, sizeof bits);
        memcpy(limit, &limit2, sizeof limit);
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
            partner[count] = near->rank[j + lane];
            if (with_distance)
                distance2[count] = value[lane];
            count += bits[lane] < limit[lane];
        }
#endif
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

/* Gathers the particles of all cells around a cell, in ascending order. */
static inline void gather_around(candidates *near, windows *w, const rheo__neighbours *n, const rheo__cells *cells,
                                 uint32_t cell, bool with_margins)
{
    near->count = 0;
    for (int l = 0; l < LINES; l++) {
        const uint64_t middle = n->cell_key[cell] + (uint64_t)(l / 3 - 1) * cells->to_next_layer +
                                (uint64_t)(l % 3 - 1) * cells->to_next_line;
        while (w->low[l] < cells->count && n->cell_key[w->low[l]] < middle - 1)
            w->low[l]++;
        w->high[l] = w->high[l] < w->low[l] ? w->low[l] : w->high[l];
        while (w->high[l] < cells->count && n->cell_key[w->high[l]] <= middle + 1)
            w->high[l]++;
        add_candidates(near, n, n->cell_start[w->low[l]], n->cell_start[w->high[l]], with_margins);
    }
    close_candidates(near);
}

static inline bool find_rows(rheo__neighbours *n, const rheo__cells *cells, uint32_t rows,
                             const rheo_allocator *allocator, rheo_real support, bool with_margins)
{
    windows w = {{0}, {0}};
    candidates near;
    prepare_candidates(&near, n);

    size_t count = 0;
    n->longest_row = 0;
    for (uint32_t c = 0; c < cells->count; c++) {
        const uint32_t cell_start = n->cell_start[c], cell_end = n->cell_start[c + 1];
        gather_around(&near, &w, n, cells, c, with_margins);
        /* Index of the cell's own particles among the candidates. */
        uint32_t own = 0;
        while (near.rank[own] != cell_start)
            own++;
        for (uint32_t i = cell_start; i < cell_end; i++, own++) {
            void *row = n->row;
            if (count > UINT32_MAX / 2 || !rheo__grow(allocator, &row, &n->row_capacity,
                                                      count + near.count + RHEO__PADDING, count, sizeof *n->row))
                return false;
            n->row = row;
            n->row_start[i] = (uint32_t)count;
            /*
             * Two runs: candidates before and after the particle itself. Hits of the first run beyond it are dropped.
             */
            uint32_t end =
                append_close(&near, own, 0, own, support, n->row, NULL, (uint32_t)count, false, with_margins);
            while (end > count && n->row[end - 1] >= i)
                end--;
            end = append_close(&near, own, own + 1, near.count, support, n->row, NULL, end, false, with_margins);
            n->longest_row = end - (uint32_t)count > n->longest_row ? end - (uint32_t)count : n->longest_row;
            count = end;
        }
    }
    n->row_start[rows] = (uint32_t)count;
    n->row[count] = rows;
    return true;
}

bool RHEO__VARIANT(find_rows)(rheo__neighbours *n, const rheo__cells *cells, uint32_t rows,
                              const rheo_allocator *allocator, rheo_real support, bool with_margins)
{
    /* Two calls, so that each is compiled for its own case. */
    return with_margins ? find_rows(n, cells, rows, allocator, support, true)
                        : find_rows(n, cells, rows, allocator, support, false);
}
