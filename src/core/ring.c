/* The ring of remembered velocities (core/ring.h). */
#include "core/ring.h"

#include <string.h>

void rheo_ring_init(rheo_ring *ring, uint32_t length)
{
    *ring = (rheo_ring){.length = length, .rows = length < RHEO_RING_ROWS ? length : RHEO_RING_ROWS};
    rheo_ring_fill(ring, 0);
}

bool rheo_ring_reserve_rows(rheo_ring *ring, const rheo_allocator *allocator, uint32_t rows)
{
    if (rows <= ring->rows)
        return true;
    uint32_t wanted = ring->rows > ring->length / 2 ? ring->length : 2 * ring->rows;
    wanted = wanted < rows ? rows : wanted;
    if (ring->blocks) {
        if (ring->blocks > SIZE_MAX / RHEO_RING_BLOCK / wanted)
            return false;
        rheo_real *values = rheo_allocate(allocator, ring->blocks * wanted * RHEO_RING_BLOCK, sizeof *values);
        if (!values)
            return false;
        for (size_t block = 0; block < ring->blocks; block++)
            memcpy(values + block * wanted * RHEO_RING_BLOCK, rheo_ring_block(ring, block, 0),
                   (size_t)ring->rows * RHEO_RING_BLOCK * sizeof *values);
        rheo_release(allocator, ring->values);
        ring->values = values;
    }
    ring->rows = wanted;
    return true;
}

/* From slot 0 on, so that a ring that is not full never reaches behind the slots that it has. */
void rheo_ring_fill(rheo_ring *ring, uint32_t rows)
{
    ring->newest = (rows ? rows : ring->length) - (ring->length > 0);
}

bool rheo_ring_reserve(rheo_ring *ring, const rheo_allocator *allocator, uint32_t particles)
{
    size_t blocks = rheo_ring_blocks(particles);
    if (ring->length == 0 || blocks <= ring->blocks)
        return true;
    size_t block_values = (size_t)ring->rows * RHEO_RING_BLOCK;
    if (blocks > SIZE_MAX / block_values)
        return false;
    size_t capacity = ring->blocks * block_values;
    void *values = ring->values;
    /* Blocks lie one after another, so growing keeps them where they are. */
    if (!rheo_grow(allocator, &values, &capacity, blocks * block_values, capacity, sizeof(rheo_real)))
        return false;
    ring->values = values;
    ring->blocks = capacity / block_values;
    return true;
}

static void copy_row(const rheo_ring *ring, uint32_t particles, uint32_t slot, rheo_real *out, const rheo_real *in)
{
    size_t values = (size_t)particles * 3;
    for (size_t first = 0, block = 0; first < values; first += RHEO_RING_BLOCK, block++) {
        size_t count = values - first < RHEO_RING_BLOCK ? values - first : RHEO_RING_BLOCK;
        rheo_real *row = rheo_ring_block(ring, block, slot);
        if (in)
            memcpy(row, in + first, count * sizeof *row);
        else
            memcpy(out + first, row, count * sizeof *row);
    }
}

void rheo_ring_push(rheo_ring *ring, uint32_t particles, const rheo_real *values)
{
    ring->newest = ring->newest + 1 < ring->length ? ring->newest + 1 : 0;
    copy_row(ring, particles, ring->newest, NULL, values);
}

void rheo_ring_read(const rheo_ring *ring, uint32_t particles, uint32_t lag, rheo_real *values)
{
    copy_row(ring, particles, rheo_ring_slot(ring, lag), values, NULL);
}

void rheo_ring_read_rows(const rheo_ring *ring, uint32_t particles, uint32_t first, uint32_t rows, rheo_real *values)
{
    size_t row_values = (size_t)particles * 3;
    for (size_t at = 0, block = 0; at < row_values; at += RHEO_RING_BLOCK, block++) {
        size_t count = row_values - at < RHEO_RING_BLOCK ? row_values - at : RHEO_RING_BLOCK;
        for (uint32_t row = rows; row-- > 0;) /* slots ascend with time */
            memcpy(values + row * row_values + at, rheo_ring_block(ring, block, rheo_ring_slot(ring, first + row)),
                   count * sizeof *values);
    }
}

void rheo_ring_write(const rheo_ring *ring, uint32_t particles, uint32_t lag, const rheo_real *values)
{
    copy_row(ring, particles, rheo_ring_slot(ring, lag), NULL, values);
}
