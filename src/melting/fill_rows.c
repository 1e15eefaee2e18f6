/*
 * Rows in blocks (melting/melting.h): the whole rows of the neighbour list turned over, so that the k-th partners of
 * the rows of a block lie side by side, with offset, kernel and slope of each pair. What the sums of a substep need
 * of the geometry is made here once.
 */
#include "melting/kernels.h"
#include "melting/quintic.h"
#include "melting/rows.h"

/* One vector of rows: its first row has this rank. Entries are those of the block. Which rows coincide with others.
 */
static rheo_mask fill_part(const rheo_melting *m, rheo_rows *rows, size_t place, uint32_t entries, uint32_t rank)
{
    const rheo_neighbours *list = &m->list;
    const rheo_real inverse_h = (rheo_real)(1 / m->smoothing_length), scale = m->kernel_scale,
                    slope_scale = scale * inverse_h * inverse_h;
    uint32_t own[RHEO_LANES], first[RHEO_LANES], length[RHEO_LANES];
    rheo_own_ranks(rank, own);
    rheo_lane_index lengths[RHEO_LANES];
    for (uint32_t lane = 0; lane < RHEO_LANES; lane++) {
        const bool there = own[lane] < m->pairs.rows;
        first[lane] = there ? list->row_start[own[lane]] : 0;
        length[lane] = there ? list->row_start[own[lane] + 1] - first[lane] : 0;
        own[lane] = there ? own[lane] : m->pairs.rows;
        lengths[lane] = (rheo_lane_index)length[lane];
    }
    rheo_mask reach;
    memcpy(&reach, lengths, sizeof reach);
    const rheo_lanes3 x = rheo_lanes_load(m->position, own);
    rheo_mask coinciding = {0};
    for (uint32_t k = 0; k < entries; k++, place += RHEO_BLOCK_ROWS) {
        uint32_t *partner = rows->partner + place;
        for (uint32_t lane = 0; lane < RHEO_LANES; lane++)
            partner[lane] = k < length[lane] ? list->row[first[lane] + k] : own[lane];
        const rheo_lanes3 offset = rheo_lanes3_minus(x, rheo_lanes_load(m->position, partner));
        const rheo_lanes q = rheo_lanes_sqrt(rheo_lanes3_dot(offset, offset)) * inverse_h;
        const rheo_mask active = reach > (rheo_lane_index)k;
        coinciding |= active & (q == 0);
        rheo_lanes slope;
        const rheo_lanes weight = rheo_quintic(q, &slope);
        rheo_lanes_put(rows->x, place, offset.x);
        rheo_lanes_put(rows->y, place, offset.y);
        rheo_lanes_put(rows->z, place, offset.z);
        rheo_lanes_put(rows->slope, place, rheo_lanes_keep(active, slope * slope_scale));
        rheo_lanes_put(rows->weight, place, rheo_lanes_keep(active, weight * scale));
    }
    return coinciding;
}

void RHEO_KERNEL(fill_rows)(rheo_melting *m)
{
    rheo_rows *rows = &m->rows;
    rheo_mask coinciding = {0};
    for (uint32_t b = 0; b < rows->blocks; b++)
        RHEO_EACH_PART (first)
            coinciding |= fill_part(m, rows, (size_t)rows->start[b] * RHEO_BLOCK_ROWS + first,
                                    rows->start[b + 1] - rows->start[b], b * RHEO_BLOCK_ROWS + first);
    m->coinciding = rheo_lanes_any(coinciding);
}
