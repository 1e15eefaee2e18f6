/*
 * Rows in blocks (melting/melting.h): the whole rows of the neighbour list turned over, so that the k-th partners of
 * the rows of a block lie side by side, with offset, kernel and slope of each pair. What the sums of a substep need
 * of the geometry is made here once.
 */
#include "melting/dispatch.h"
#include "melting/quintic.h"
#include "melting/rows.h"

/* One vector of rows: its first row has this rank. Entries are those of the block. Which rows coincide with others.
 */
static rheo__mask fill_part(const rheo__melting *m, rheo__rows *rows, size_t place, uint32_t entries, uint32_t rank)
{
    const rheo__neighbours *list = &m->list;
    const rheo_real inverse_h = (rheo_real)(1 / m->smoothing_length), scale = m->kernel_scale,
                    slope_scale = scale * inverse_h * inverse_h;
    uint32_t own[RHEO__LANES], first[RHEO__LANES], length[RHEO__LANES];
    rheo__own_ranks(rank, own);
    rheo__lane_index lengths[RHEO__LANES];
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
        const bool there = own[lane] < m->pairs.rows;
        first[lane] = there ? list->row_start[own[lane]] : 0;
        length[lane] = there ? list->row_start[own[lane] + 1] - first[lane] : 0;
        own[lane] = there ? own[lane] : m->pairs.rows;
        lengths[lane] = (rheo__lane_index)length[lane];
    }
    rheo__mask reach;
    memcpy(&reach, lengths, sizeof reach);
    const rheo__lanes3 x = rheo__lanes_load(m->position, own);
    rheo__mask coinciding = {0};
    for (uint32_t k = 0; k < entries; k++, place += RHEO__BLOCK_ROWS) {
        uint32_t *partner = rows->partner + place;
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
            partner[lane] = k < length[lane] ? list->row[first[lane] + k] : own[lane];
        const rheo__lanes3 offset = rheo__lanes3_minus(x, rheo__lanes_load(m->position, partner));
        const rheo__lanes q = rheo__lanes_sqrt(rheo__lanes3_dot(offset, offset)) * inverse_h;
        const rheo__mask active = reach > (rheo__lane_index)k;
        coinciding |= active & (q == 0);
        rheo__lanes slope;
        const rheo__lanes weight = rheo__quintic(q, &slope);
        rheo__lanes_put(rows->x, place, offset.x);
        rheo__lanes_put(rows->y, place, offset.y);
        rheo__lanes_put(rows->z, place, offset.z);
        rheo__lanes_put(rows->slope, place, rheo__lanes_keep(active, slope * slope_scale));
        rheo__lanes_put(rows->weight, place, rheo__lanes_keep(active, weight * scale));
    }
    return coinciding;
}

void RHEO__VARIANT(fill_rows)(rheo__melting *m)
{
    rheo__rows *rows = &m->rows;
    rheo__mask coinciding = {0};
    for (uint32_t b = 0; b < rows->blocks; b++)
        RHEO__EACH_VECTOR_OF_BLOCK (first)
            coinciding |= fill_part(m, rows, (size_t)rows->start[b] * RHEO__BLOCK_ROWS + first,
                                    rows->start[b + 1] - rows->start[b], b * RHEO__BLOCK_ROWS + first);
    m->coinciding = rheo__lanes_any(coinciding);
}
