/*
 * Rows in blocks (melting/melting.h): the whole rows of the neighbour list, transposed so that the k-th partners of
 * the rows of a block lie side by side, with offset, weight and slope of each pair. All sums of a substep use this
 * geometry.
 */
#include "core/quintic.h"
#include "melting/rows.h"

/* Fills a vector of rows of a block. Returns the rows that coincide with a partner. */
static rheo__mask fill_vector(const rheo__melting *m, rheo__rows *rows, uint32_t block, uint32_t first_row)
{
    const rheo__neighbours *list = &m->list;
    const rheo_real inverse_h = (rheo_real)(1 / m->smoothing_length), scale = m->kernel_scale,
                    slope_scale = scale * inverse_h * inverse_h;
    uint32_t own[RHEO__LANES], first[RHEO__LANES], length[RHEO__LANES];
    rheo__own_ranks(block * RHEO__BLOCK_ROWS + first_row, own);
    rheo__lane_index lengths[RHEO__LANES];
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
        const bool used = own[lane] < m->pairs.rows;
        first[lane] = used ? list->row_start[own[lane]] : 0;
        length[lane] = used ? list->row_start[own[lane] + 1] - first[lane] : 0;
        own[lane] = used ? own[lane] : m->pairs.rows;
        lengths[lane] = (rheo__lane_index)length[lane];
    }
    rheo__mask row_length;
    memcpy(&row_length, lengths, sizeof row_length);
    const rheo__lanes3 x = rheo__lanes_load(m->position, own);
    rheo__mask coinciding = {0};
    uint32_t k = 0;
    RHEO__EACH_ENTRY(rows, block, first_row, entry)
    {
        uint32_t *partner = rows->partner + entry;
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
            partner[lane] = k < length[lane] ? list->row[first[lane] + k] : own[lane];
        const rheo__lanes3 offset = rheo__lanes3_minus(x, rheo__lanes_load(m->position, partner));
        const rheo__lanes q = rheo__lanes_sqrt(rheo__lanes3_dot(offset, offset)) * inverse_h;
        const rheo__mask active = row_length > (rheo__lane_index)k;
        coinciding |= active & (q == 0);
        rheo__lanes slope;
        const rheo__lanes weight = rheo__lanes_quintic(q, &slope);
        rheo__lanes_put(rows->x, entry, offset.x);
        rheo__lanes_put(rows->y, entry, offset.y);
        rheo__lanes_put(rows->z, entry, offset.z);
        rheo__lanes_put(rows->slope, entry, rheo__lanes_keep(active, slope * slope_scale));
        rheo__lanes_put(rows->weight, entry, rheo__lanes_keep(active, weight * scale));
        k++;
    }
    return coinciding;
}

void RHEO__VARIANT(fill_rows)(rheo__melting *m)
{
    rheo__rows *rows = &m->rows;
    rheo__mask coinciding = {0};
    RHEO__EACH_VECTOR_OF_ROWS(rows, block, first)
    coinciding |= fill_vector(m, rows, block, first);
    m->coinciding = rheo__lanes_any(coinciding);
}
