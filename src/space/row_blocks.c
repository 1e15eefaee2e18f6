/* Lays the whole rows of a neighbour list out in blocks (space/neighbours.h). */
#include "space/neighbours.h"

static uint32_t length_of(const rheo__neighbours *list, uint32_t rows, uint32_t i)
{
    return i < rows ? list->row_start[i + 1] - list->row_start[i] : 0;
}

bool rheo__neighbours_lay_out(const rheo__neighbours *list, rheo__pairs *pairs, const rheo_allocator *allocator)
{
    enum { WIDTH = RHEO__BLOCK_ROWS };
    const uint32_t rows = pairs->rows;
    rheo__pairs_shape(pairs, rows, WIDTH);
    const uint32_t blocks = pairs->blocks;
    size_t entries = 0;
    for (uint32_t b = 0; b < blocks; b++) {
        uint32_t longest = 0;
        for (uint32_t i = b * WIDTH; i < (b + 1) * WIDTH; i++)
            longest = length_of(list, rows, i) > longest ? length_of(list, rows, i) : longest;
        pairs->start[b] = (uint32_t)entries;
        entries += longest;
    }
    pairs->start[blocks] = (uint32_t)entries;
    if (!rheo__pairs_reserve(pairs, allocator, entries * WIDTH + 1, 0))
        return false;
    for (uint32_t b = 0; b < blocks; b++)
        for (uint32_t lane = 0; lane < WIDTH; lane++) {
            const uint32_t i = b * WIDTH + lane, length = length_of(list, rows, i);
            uint32_t *partner = pairs->partner + (size_t)pairs->start[b] * WIDTH + lane;
            const uint32_t *row = length ? list->row + list->row_start[i] : NULL;
            const uint32_t longest = pairs->start[b + 1] - pairs->start[b];
            for (uint32_t k = 0; k < longest; k++)
                partner[(size_t)k * WIDTH] = k < length ? row[k] : i;
        }
    return true;
}
