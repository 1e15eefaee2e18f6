/*
 * The ring of remembered velocities, or of positions: d + 1 rows of 3 values per particle, kept in blocks of values by id,
 * [block][slot][RHEO__RING_BLOCK]. A weighted sum over all rows reads a block after the other, and its own sums stay in
 * the cache. A block is wide enough to read and write a single row in long pieces, too: memory is slow where pieces
 * are short. Rows never move, except in a long window, whose ring grows as rows are filled. So a file cannot cause a
 * large allocation by naming a long window.
 */
#ifndef RHEO__CORE_RING_H
#define RHEO__CORE_RING_H

#include "core/memory.h"
#include "core/strict.h"

enum {
    RHEO__RING_BLOCK = 512,
    RHEO__RING_ROWS = 256, /* rows allocated at first */
};

typedef struct rheo__ring {
    rheo_real *values;
    size_t blocks;   /* allocated */
    uint32_t length; /* rows, d + 1; 0: no history */
    uint32_t rows;   /* slots allocated: at least the filled rows; `length` before any slot is reused */
    uint32_t newest; /* slot of lag 0 */
    /* Counters for sums that are made ahead: rows pushed, and changes of other rows. Not state. */
    uint64_t pushed, rewritten;
} rheo__ring;

static inline size_t rheo__ring_blocks(uint32_t particles)
{
    return ((size_t)particles * 3 + RHEO__RING_BLOCK - 1) / RHEO__RING_BLOCK;
}
static inline uint32_t rheo__ring_slot(const rheo__ring *ring, uint32_t lag)
{
    return lag <= ring->newest ? ring->newest - lag : ring->newest + ring->length - lag;
}
static inline rheo_real *rheo__ring_block(const rheo__ring *ring, size_t block, uint32_t slot)
{
    return ring->values + (block * ring->rows + slot) * RHEO__RING_BLOCK;
}

void rheo__ring_init(rheo__ring *ring, uint32_t length);
/* Makes room for this many filled rows, at most `length`. False: no memory, nothing changed. */
bool rheo__ring_reserve_rows(rheo__ring *ring, const rheo_allocator *allocator, uint32_t rows);
/* Marks this many rows as filled; there must be room, and the caller writes their values. */
void rheo__ring_fill(rheo__ring *ring, uint32_t rows);
/* Makes room for more particles, with zeros in every row. False: no memory, nothing changed. */
bool rheo__ring_reserve(rheo__ring *ring, const rheo_allocator *allocator, uint32_t particles);
/* Stores `values` (3 per particle) as lag 0, over the oldest row or in the next free slot. */
void rheo__ring_push(rheo__ring *ring, uint32_t particles, const rheo_real *values);
void rheo__ring_read(const rheo__ring *ring, uint32_t particles, uint32_t lag, rheo_real *values);
/* Reads the rows first to first + rows - 1 in the order of memory, where the values of one row are scattered. */
void rheo__ring_read_rows(const rheo__ring *ring, uint32_t particles, uint32_t first, uint32_t rows,
                          rheo_real *values);
void rheo__ring_write(rheo__ring *ring, uint32_t particles, uint32_t lag, const rheo_real *values);

static inline rheo_real rheo__ring_value(const rheo__ring *ring, uint32_t lag, size_t value)
{
    return rheo__ring_block(ring, value / RHEO__RING_BLOCK, rheo__ring_slot(ring, lag))[value % RHEO__RING_BLOCK];
}

#endif
