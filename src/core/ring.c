/* The ring of remembered velocities or positions (core/ring.h). */
#include "core/ring.h"

#include <string.h>

void rheo__ring_init(rheo__ring *ring, uint32_t length)
{
    *ring = (rheo__ring){.length = length, .rows = length < RHEO__RING_ROWS ? length : RHEO__RING_ROWS};
    rheo__ring_fill(ring, 0);
}

bool rheo__ring_reserve_rows(rheo__ring *ring, const rheo_allocator *allocator, uint32_t rows)
{
    if (rows <= ring->rows)
        return true;
    uint32_t wanted = ring->rows > ring->length / 2 ? ring->length : 2 * ring->rows;
    wanted = wanted < rows ? rows : wanted;
    if (ring->blocks) {
        if (ring->blocks > SIZE_MAX / RHEO__RING_BLOCK / wanted)
            return false;
        rheo_real *values = rheo__allocate(allocator, ring->blocks * wanted * RHEO__RING_BLOCK, sizeof *values);
        if (!values)
            return false;
        for (size_t block = 0; block < ring->blocks; block++)
            memcpy(values + block * wanted * RHEO__RING_BLOCK, rheo__ring_block(ring, block, 0),
                   (size_t)ring->rows * RHEO__RING_BLOCK * sizeof *values);
        rheo__release(allocator, ring->values);
        ring->values = values;
    }
    ring->rows = wanted;
    return true;
}

/* Starts at slot 0, so that a ring that is not full stays within its slots. */
void rheo__ring_fill(rheo__ring *ring, uint32_t rows)
{
    ring->newest = (rows ? rows : ring->length) - (ring->length > 0);
    ring->rewritten++;
}

bool rheo__ring_reserve(rheo__ring *ring, const rheo_allocator *allocator, uint32_t particles)
{
    size_t blocks = rheo__ring_blocks(particles);
    if (ring->length == 0 || blocks <= ring->blocks)
        return true;
    size_t block_values = (size_t)ring->rows * RHEO__RING_BLOCK;
    if (blocks > SIZE_MAX / block_values)
        return false;
    size_t capacity = ring->blocks * block_values;
    void *values = ring->values;
    /* Blocks lie one after another, so growing keeps them where they are. */
    if (!rheo__grow(allocator, &values, &capacity, blocks * block_values, capacity, sizeof(rheo_real)))
        return false;
    ring->values = values;
    ring->blocks = capacity / block_values;
    ring->rewritten++;
    return true;
}

static void copy_row(const rheo__ring *ring, uint32_t particles, uint32_t slot, rheo_real *out, const rheo_real *in)
{
    size_t values = (size_t)particles * 3;
    for (size_t first = 0, block = 0; first < values; first += RHEO__RING_BLOCK, block++) {
        size_t count = values - first < RHEO__RING_BLOCK ? values - first : RHEO__RING_BLOCK;
        rheo_real *row = rheo__ring_block(ring, block, slot);
        if (in)
            memcpy(row, in + first, count * sizeof *row);
        else
            memcpy(out + first, row, count * sizeof *row);
    }
}

void rheo__ring_push(rheo__ring *ring, uint32_t particles, const rheo_real *values)
{
    ring->newest = ring->newest + 1 < ring->length ? ring->newest + 1 : 0;
    copy_row(ring, particles, ring->newest, NULL, values);
    ring->pushed++;
}

void rheo__ring_read(const rheo__ring *ring, uint32_t particles, uint32_t lag, rheo_real *values)
{
    copy_row(ring, particles, rheo__ring_slot(ring, lag), values, NULL);
}

void rheo__ring_read_rows(const rheo__ring *ring, uint32_t particles, uint32_t first, uint32_t rows,
                          rheo_real *values)
{
    size_t row_values = (size_t)particles * 3;
    for (size_t at = 0, block = 0; at < row_values; at += RHEO__RING_BLOCK, block++) {
        size_t count = row_values - at < RHEO__RING_BLOCK ? row_values - at : RHEO__RING_BLOCK;
        for (uint32_t row = rows; row-- > 0;) /* slots ascend with time */
            memcpy(values + row * row_values + at, rheo__ring_block(ring, block, rheo__ring_slot(ring, first + row)),
                   count * sizeof *values);
    }
}

void rheo__ring_write(rheo__ring *ring, uint32_t particles, uint32_t lag, const rheo_real *values)
{
    copy_row(ring, particles, rheo__ring_slot(ring, lag), NULL, values);
    ring->rewritten++;
}
