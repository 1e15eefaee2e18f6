/*
 * Lays the whole rows of a neighbour list out in blocks (space/neighbours.h). Entries after the last partner of a row
 * cost as much as partners, so rows of about the same length are put together: within windows of WINDOW rows, ranks
 * are dealt again by descending length. Windows are small enough for the partners of a block to stay close.
 */
#include <string.h>

#include "space/neighbours.h"

enum {
    WIDTH = RHEO__BLOCK_ROWS,
    WINDOW = 16 * WIDTH,
    LENGTHS = 256, /* lengths from the last one on are sorted as if equal */
};

static uint32_t length_of(const rheo__neighbours *list, uint32_t cell_rank)
{
    return list->row_start[cell_rank + 1] - list->row_start[cell_rank];
}

/* Sorts the rows of the window that begins at a rank by descending length, then by rank in the order of cells. */
static void sort_window(const rheo__neighbours *list, uint32_t first, uint32_t end, uint32_t *cell_rank)
{
    uint32_t place[LENGTHS + 1] = {0};
    for (uint32_t c = first; c < end; c++) {
        const uint32_t length = length_of(list, c);
        place[LENGTHS - (length < LENGTHS ? length : LENGTHS - 1)]++;
    }
    for (uint32_t k = 1; k <= LENGTHS; k++)
        place[k] += place[k - 1];
    for (uint32_t c = first; c < end; c++) {
        const uint32_t length = length_of(list, c);
        cell_rank[place[LENGTHS - (length < LENGTHS ? length : LENGTHS - 1) - 1]++] = c;
    }
}

/* Images get the ranks after that of idle entries. False: no memory. */
static bool place_images(rheo__neighbours *list, rheo__pairs *pairs, const rheo_allocator *allocator)
{
    if (!rheo__pairs_reserve_images(pairs, allocator, list->images))
        return false;
    for (uint32_t k = 0; k < list->images; k++) {
        pairs->image[k] = list->image[k].at;
        pairs->image[k].home = list->block_rank[pairs->image[k].home];
        list->block_rank[pairs->rows + k] = rheo__pairs_idle(pairs) + 1 + k;
    }
    return true;
}

bool rheo__neighbours_lay_out(rheo__neighbours *list, rheo__pairs *pairs, const rheo_allocator *allocator)
{
    const uint32_t rows = pairs->rows;
    void *block_rank = list->block_rank;
    if (list->images && !rheo__grow(allocator, &block_rank, &list->block_rank_capacity, (size_t)rows + list->images,
                                    0, sizeof *list->block_rank))
        return false;
    list->block_rank = block_rank;
    rheo__pairs_shape(pairs, rows, WIDTH);
    size_t entries = 0;
    for (uint32_t first = 0; first < rows; first += WINDOW) {
        const uint32_t end = rows - first < WINDOW ? rows : first + WINDOW;
        uint32_t cell_rank[WINDOW], id[WINDOW];
        sort_window(list, first, end, cell_rank);
        memcpy(id, pairs->id_of + first, (end - first) * sizeof *id);
        uint32_t longest = 0;
        for (uint32_t i = first; i < end; i++) {
            const uint32_t c = cell_rank[i - first], length = length_of(list, c);
            pairs->id_of[i] = id[c - first];
            pairs->rank_of[pairs->id_of[i]] = i;
            list->block_rank[c] = i;
            longest = length > longest ? length : longest;
            if (i % WIDTH == 0)
                pairs->start[i / WIDTH] = (uint32_t)entries;
            if (i % WIDTH == WIDTH - 1 || i == end - 1) {
                entries += longest;
                longest = 0;
            }
        }
    }
    pairs->start[pairs->blocks] = (uint32_t)entries;
    return rheo__pairs_reserve(pairs, allocator, entries * WIDTH + 1, 0) && place_images(list, pairs, allocator);
}

/* Rows in blocks, with their rest lengths if they have springs. */
typedef struct block_rows {
    uint32_t rows;
    const uint32_t *start;
    uint32_t *partner;
    rheo_real *rest_length;
    uint32_t idle; /* partner of idle entries */
} block_rows;

static block_rows rows_of(const rheo__pairs *pairs, rheo_real *rest_length)
{
    return (block_rows){pairs->rows, pairs->start, pairs->partner, rest_length,
                        RHEO__POINT_VALUES * pairs->blocks * WIDTH};
}

/* Index of the first entry of a row. */
static inline size_t first_entry(const block_rows *rows, uint32_t i)
{
    return (size_t)rows->start[i / WIDTH] * WIDTH + i % WIDTH;
}

/* What the rows of a list are written from. */
typedef struct sources {
    const rheo__neighbours *list;
    /* With springs. */
    block_rows old;
    const rheo__place *place;
    rheo_real *carried; /* by old rank: the rest length that this particle has in the row at hand; else -1 */
} sources;

/*
 * Entries are handled in rounds. The last round of a row handles its last entry again for those that are missing, which
 * changes nothing: rows of somewhat different lengths then take the same branches.
 */
enum { ROUND = 4 };
#define EACH_OF_ROUND(k, count) _Pragma("GCC unroll 4") for (uint32_t k = 0; k < (count); k++)
static inline size_t entry_of_round(uint32_t k, uint32_t last)
{
    return (size_t)(k < last ? k : last) * WIDTH;
}

/* The value of a partner among values by rank. */
static inline rheo_real *value_of(rheo_real *values, uint32_t partner)
{
    _Static_assert(sizeof *values % RHEO__POINT_VALUES == 0, "partners are multiples of RHEO__POINT_VALUES");
    return (rheo_real *)(void *)((char *)values + (size_t)partner * (sizeof *values / RHEO__POINT_VALUES));
}

/* Sets the values of the partners of a row: to its rest lengths, or without these to -1. */
static inline void carry_round(rheo_real *restrict values, const uint32_t *restrict partner,
                               const rheo_real *restrict rest_length, uint32_t count, uint32_t last)
{
    EACH_OF_ROUND(k, count)
    {
        const size_t entry = entry_of_round(k, last);
        *value_of(values, partner[entry]) = rest_length ? rest_length[entry] : -1;
    }
}
static inline void carry(rheo_real *restrict values, const uint32_t *restrict partner,
                         const rheo_real *restrict rest_length, uint32_t length)
{
    for (; length >= ROUND; length -= ROUND, partner += ROUND * WIDTH) {
        carry_round(values, partner, rest_length, ROUND, ROUND - 1);
        if (rest_length)
            rest_length += ROUND * WIDTH;
    }
    if (length)
        carry_round(values, partner, rest_length, ROUND - 1, length - 1);
}

/* Writes the partners of a row and, if there are any, their rest lengths. */
static inline void write_round(uint32_t *restrict partner, rheo_real *restrict rest_length, const sources *from,
                               const uint32_t *restrict row, uint32_t count, uint32_t last)
{
    EACH_OF_ROUND(k, count)
    {
        const size_t entry = entry_of_round(k, last);
        const uint32_t cell_rank = row[entry / WIDTH];
        if (rest_length) {
            const rheo__place place = from->place[cell_rank];
            partner[entry] = (uint32_t)place;
            rest_length[entry] = *value_of(from->carried, (uint32_t)(place >> 32));
        } else {
            partner[entry] = RHEO__POINT_VALUES * from->list->block_rank[cell_rank];
        }
    }
}
static inline void write_row(uint32_t *restrict partner, rheo_real *restrict rest_length, const sources *from,
                             const uint32_t *restrict row, uint32_t length)
{
    for (; length >= ROUND; length -= ROUND, row += ROUND, partner += ROUND * WIDTH) {
        write_round(partner, rest_length, from, row, ROUND, ROUND - 1);
        if (rest_length)
            rest_length += ROUND * WIDTH;
    }
    if (length)
        write_round(partner, rest_length, from, row, ROUND - 1, length - 1);
}

/* An address that may be beyond the end of an array, to fetch from. */
static inline const void *ahead(const void *array, size_t bytes)
{
    return (const void *)((uintptr_t)array + bytes);
}

/*
 * Fetches a part of what rows some way ahead need. A processor does not look far enough ahead by itself, because blocks
 * are written row by row, and read in another order: a rank may move by hundreds.
 */
static inline void fetch_ahead(const block_rows *to, const sources *from, uint32_t i)
{
    enum { INTO_L2 = 2, WRITTEN_AHEAD = 64, READ_AHEAD = 1024 };
    const size_t end = to->start[i / WIDTH + 1];
    for (size_t k = to->start[i / WIDTH] + i % WIDTH; k < end; k += WIDTH) {
        const size_t written = (k + WRITTEN_AHEAD) * WIDTH, read = (k + READ_AHEAD) * WIDTH;
        __builtin_prefetch(ahead(to->partner, written * sizeof *to->partner), 1, INTO_L2);
        __builtin_prefetch(ahead(to->rest_length, written * sizeof *to->rest_length), 1, INTO_L2);
        __builtin_prefetch(ahead(from->old.partner, read * sizeof *to->partner), 0, INTO_L2);
        __builtin_prefetch(ahead(from->old.rest_length, read * sizeof *to->rest_length), 0, INTO_L2);
    }
    const uint32_t cell_rank = to->rows - i > WINDOW ? i + WINDOW : i,
                   *row = from->list->row + from->list->row_start[cell_rank];
    __builtin_prefetch(row, 0, INTO_L2);
    __builtin_prefetch(ahead(row, 64), 0, INTO_L2);
}

/* Makes all entries of a block idle from the end of its shortest row on. */
static inline void write_idle(const block_rows *to, uint32_t block, uint32_t shortest)
{
    const size_t end = (size_t)to->start[block + 1] * WIDTH;
    for (size_t k = ((size_t)to->start[block] + shortest) * WIDTH; k < end; k++) {
        to->partner[k] = to->idle;
        if (to->rest_length)
            to->rest_length[k] = -1;
    }
}

/* Each spring has two ends: its rest length is in the rows of both particles. */
static inline uint32_t count_ends(const block_rows *rows, uint32_t block)
{
    uint32_t ends = 0;
    const size_t end = (size_t)rows->start[block + 1] * WIDTH;
    for (size_t k = (size_t)rows->start[block] * WIDTH; k < end; k++)
        ends += rows->rest_length[k] >= 0;
    return ends;
}

/* Writes the rows of a block, which have the ranks from `first` to end - 1. Returns the ends of springs. */
static inline uint32_t write_block(const block_rows *to, uint32_t first, uint32_t end, const sources *from,
                                   const uint32_t *cell_rank, bool springs)
{
    const rheo__neighbours *list = from->list;
    uint32_t shortest = end - first < WIDTH ? 0 : UINT32_MAX; /* 0: idle rows */
    for (uint32_t n = 0; n < end - first; n++) {
        const uint32_t length = length_of(list, cell_rank[n]);
        shortest = length < shortest ? length : shortest;
    }
    write_idle(to, first / WIDTH, shortest);
    for (uint32_t i = first; i < end; i++, cell_rank++) {
        const uint32_t *row = list->row + list->row_start[*cell_rank], length = length_of(list, *cell_rank);
        const size_t at = first_entry(to, i);
        if (!springs) {
            write_row(to->partner + at, NULL, from, row, length);
            continue;
        }
        fetch_ahead(to, from, i);
        const block_rows *old = &from->old;
        const uint32_t partner = (uint32_t)(from->place[*cell_rank] >> 32), old_i = partner / RHEO__POINT_VALUES;
        if (partner == old->idle) { /* a new particle had no springs */
            write_row(to->partner + at, to->rest_length + at, from, row, length);
            continue;
        }
        const size_t old_at = first_entry(old, old_i);
        const uint32_t old_length = old->start[old_i / WIDTH + 1] - old->start[old_i / WIDTH];
        carry(from->carried, old->partner + old_at, old->rest_length + old_at, old_length);
        write_row(to->partner + at, to->rest_length + at, from, row, length);
        carry(from->carried, old->partner + old_at, NULL, old_length);
    }
    return springs ? count_ends(to, first / WIDTH) : 0;
}

static inline size_t write_rows(const block_rows to, const sources from, bool springs)
{
    size_t ends = 0;
    for (uint32_t first = 0; first < to.rows; first += WINDOW) {
        const uint32_t end = to.rows - first < WINDOW ? to.rows : first + WINDOW;
        uint32_t cell_rank[WINDOW];
        for (uint32_t c = first; c < end; c++)
            cell_rank[from.list->block_rank[c] - first] = c;
        for (uint32_t i = first; i < end; i += WIDTH)
            ends += write_block(&to, i, end - i < WIDTH ? end : i + WIDTH, &from, cell_rank + (i - first), springs);
    }
    return ends;
}

void rheo__neighbours_write_rows(const rheo__neighbours *list, rheo__pairs *pairs)
{
    write_rows(rows_of(pairs, NULL), (sources){.list = list}, false);
}

void rheo__neighbours_write_springs(const rheo__neighbours *list, rheo__springs *now, const rheo__springs *old,
                                    rheo__place *place, rheo_real *carried)
{
    const rheo__pairs *p = &now->pairs, *op = &old->pairs;
    const uint32_t idle = rheo__pairs_idle(op);
    for (uint32_t c = 0; c < p->rows; c++) {
        const uint32_t i = list->block_rank[c], id = p->id_of[i], before = id < op->rows ? op->rank_of[id] : idle;
        place[c] = (uint64_t)(RHEO__POINT_VALUES * before) << 32 | RHEO__POINT_VALUES * i;
    }
    for (uint32_t k = 0; k < list->images; k++) {
        const rheo__place home = place[list->image[k].at.home];
        place[p->rows + k] = home >> 32 << 32 | RHEO__POINT_VALUES * list->block_rank[p->rows + k];
    }
    for (uint32_t i = 0; i <= idle; i++)
        carried[i] = -1;
    const sources from = {list, rows_of(op, old->rest_length), place, carried};
    now->count = write_rows(rows_of(p, now->rest_length), from, true) / 2;
}
