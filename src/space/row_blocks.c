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

bool rheo__neighbours_lay_out(rheo__neighbours *list, rheo__pairs *pairs, const rheo_allocator *allocator)
{
    const uint32_t rows = pairs->rows;
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
    return rheo__pairs_reserve(pairs, allocator, entries * WIDTH + 1, 0);
}

/* What a row of the old springs leaves to the new one, in the order of the new ranks. */
typedef struct inheritance {
    const rheo__springs *old;
    const uint32_t *rank_now; /* by old rank */
    rheo__carried *carried;   /* by new rank */
} inheritance;

/* Writes the row of rank i: its partners in the order of cells; `from`: also their rest lengths. Returns springs. */
static inline uint32_t write_row(const rheo__neighbours *list, const rheo__pairs *pairs, uint32_t i,
                                 uint32_t cell_rank, const inheritance *from, rheo_real *rest_length)
{
    const uint32_t length = length_of(list, cell_rank), *row = list->row + list->row_start[cell_rank];
    size_t to = rheo__pairs_first(pairs, i);
    const size_t end = rheo__pairs_end(pairs, i);
    uint32_t springs = 0;
    if (from) {
        const rheo__pairs *op = &from->old->pairs;
        const uint32_t id = pairs->id_of[i];
        if (id < op->rows) /* a new particle had no springs */
            for (size_t k = rheo__pairs_first(op, op->rank_of[id]), last = rheo__pairs_end(op, op->rank_of[id]);
                 k < last; k += WIDTH)
                from->carried[from->rank_now[rheo__pairs_partner(op, k)]] =
                    (rheo__carried){from->old->rest_length[k], i};
    }
    for (uint32_t k = 0; k < length; k++, to += WIDTH) {
        const uint32_t j = list->block_rank[row[k]];
        pairs->partner[to] = RHEO__POINT_VALUES * j;
        if (from) {
            const rheo__carried carried = from->carried[j];
            rest_length[to] = carried.row == i ? carried.rest_length : -1;
            springs += rest_length[to] >= 0;
        }
    }
    for (; to < end; to += WIDTH) {
        pairs->partner[to] = RHEO__POINT_VALUES * rheo__pairs_idle(pairs);
        if (from)
            rest_length[to] = -1;
    }
    return springs;
}

static inline size_t write_rows(const rheo__neighbours *list, const rheo__pairs *pairs, const inheritance *from,
                                rheo_real *rest_length)
{
    size_t ends = 0;
    for (uint32_t first = 0; first < pairs->rows; first += WINDOW) {
        const uint32_t end = pairs->rows - first < WINDOW ? pairs->rows : first + WINDOW;
        uint32_t cell_rank[WINDOW];
        for (uint32_t c = first; c < end; c++)
            cell_rank[list->block_rank[c] - first] = c;
        for (uint32_t i = first; i < end; i++)
            ends += write_row(list, pairs, i, cell_rank[i - first], from, rest_length);
    }
    /* Idle rows of the last block. */
    for (uint32_t i = pairs->rows; i < pairs->blocks * WIDTH; i++)
        for (size_t to = rheo__pairs_first(pairs, i); to < rheo__pairs_end(pairs, i); to += WIDTH) {
            pairs->partner[to] = RHEO__POINT_VALUES * rheo__pairs_idle(pairs);
            if (from)
                rest_length[to] = -1;
        }
    return ends;
}

void rheo__neighbours_write_rows(const rheo__neighbours *list, rheo__pairs *pairs)
{
    write_rows(list, pairs, NULL, NULL);
}

void rheo__neighbours_write_springs(const rheo__neighbours *list, rheo__springs *now, const rheo__springs *old,
                                    uint32_t *rank_now, rheo__carried *carried)
{
    const inheritance from = {old, rank_now, carried};
    for (uint32_t i = 0; i < old->pairs.rows; i++)
        rank_now[i] = now->pairs.rank_of[old->pairs.id_of[i]];
    rank_now[rheo__pairs_idle(&old->pairs)] = rheo__pairs_idle(&now->pairs);
    for (uint32_t i = 0; i < now->pairs.rows; i++)
        carried[i].row = UINT32_MAX;
    now->count = write_rows(list, &now->pairs, &from, now->rest_length) / 2;
}
