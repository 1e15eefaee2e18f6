/*
 * The ring of remembered velocities: d + 1 rows of 3 values a particle, kept in blocks of 64 values by id,
 * [block][slot][64], so that a weighted sum over all rows reads memory once and in order. Rows never move, but for a
 * long window, whose ring grows with the rows that it is filled with: how long a window is costs a file that asks for
 * it nothing.
 */
#ifndef RHEO__CORE_RING_H
#define RHEO__CORE_RING_H

#include "core/memory.h"
#include "core/strict.h"

enum {
    RHEO__RING_BLOCK = 64,
    RHEO__RING_ROWS = 256, /* rows that there is room for from the start */
};

typedef struct rheo__ring {
    rheo_real *values;
    size_t blocks;   /* allocated */
    uint32_t length; /* rows, d + 1; 0: no history */
    uint32_t rows;   /* slots allocated: length, or as long as no slot has been used twice, more than are filled */
    uint32_t newest; /* slot of lag 0 */
    /* For sums made ahead from rows: number of rows pushed, and of changes of others. Not state. */
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
/* Room for so many filled rows, at most length. False: no memory, nothing changed. */
bool rheo__ring_reserve_rows(rheo__ring *ring, const rheo_allocator *allocator, uint32_t rows);
/* Takes so many rows, for which there is room, as filled; they are to be written. */
void rheo__ring_fill(rheo__ring *ring, uint32_t rows);
/* Room for more particles; new ones have zeros in every row. False: no memory, nothing changed. */
bool rheo__ring_reserve(rheo__ring *ring, const rheo_allocator *allocator, uint32_t particles);
/* Turns the ring by one: the oldest row, or one not filled yet, becomes lag 0 and holds `values` (3 a particle). */
void rheo__ring_push(rheo__ring *ring, uint32_t particles, const rheo_real *values);
void rheo__ring_read(const rheo__ring *ring, uint32_t particles, uint32_t lag, rheo_real *values);
/* Rows first .. first + rows - 1, one after the other: memory is read in order, where a single row is strewn over it.
 */
void rheo__ring_read_rows(const rheo__ring *ring, uint32_t particles, uint32_t first, uint32_t rows,
                          rheo_real *values);
void rheo__ring_write(rheo__ring *ring, uint32_t particles, uint32_t lag, const rheo_real *values);

static inline rheo_real rheo__ring_value(const rheo__ring *ring, uint32_t lag, size_t value)
{
    return rheo__ring_block(ring, value / RHEO__RING_BLOCK, rheo__ring_slot(ring, lag))[value % RHEO__RING_BLOCK];
}

#endif
