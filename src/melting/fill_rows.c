/*
 * Rows in blocks (melting/melting.h): the candidates of each row that are closer than the support, transposed so that
 * the k-th partners of the rows of a block lie side by side, with weight and slope of each pair. All sums of a substep
 * use them.
 */
#include "core/quintic.h"
#include "melting/rows.h"
#include "space/append.h"

static rheo__mask lanes_below(uint32_t count)
{
    rheo__lane_index index[RHEO__LANES];
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
        index[lane] = (rheo__lane_index)lane;
    rheo__mask lanes;
    memcpy(&lanes, index, sizeof lanes);
    return lanes < (rheo__lane_index)(count < RHEO__LANES ? count : RHEO__LANES);
}

/* Writes the close candidates of a row, in their order. Returns their number. */
static inline uint32_t close_partners(const rheo__melting *m, const rheo__hit_order *order, uint32_t rank,
                                      uint32_t *partner)
{
    const uint32_t row = m->rows.row_of[rank], end = m->list.row_start[row + 1];
    const rheo_real support = (rheo_real)m->support;
    const rheo__lanes limit2 = rheo__lanes_all(support * support),
                      nowhere = rheo__lanes_all((rheo_real)__builtin_nan(""));
    const rheo__point own = m->position[rank];
    const rheo__lanes3 x = {rheo__lanes_all(own.x), rheo__lanes_all(own.y), rheo__lanes_all(own.z)};
    uint32_t count = 0;
    for (uint32_t k = m->list.row_start[row]; k < end; k += RHEO__LANES) {
        const uint32_t *candidate = m->list.row + k;
        const rheo__lanes3 offset = rheo__lanes3_minus(x, rheo__lanes_load(m->position, candidate));
        rheo__lanes r2 = rheo__lanes3_dot(offset, offset);
        if (end - k < RHEO__LANES)
            r2 = rheo__lanes_select(lanes_below(end - k), r2, nowhere);
        count = rheo__append_hits(order, candidate, r2, limit2, RHEO__LANES, partner, NULL, count, false);
    }
    return count;
}

void RHEO__VARIANT(measure_rows)(rheo__melting *m)
{
    rheo__hit_order order;
    rheo__make_hit_order(&order);
    for (uint32_t rank = 0; rank < m->pairs.rows; rank++)
        m->rows.length[rank] = close_partners(m, &order, rank, m->rows.scratch);
}

/* Finds the partners of a block. */
static void fill_block(rheo__melting *m, const rheo__hit_order *order, uint32_t block)
{
    rheo__rows *rows = &m->rows;
    const size_t stride = rows->stride;
    uint32_t longest = 0, length[RHEO__BLOCK_ROWS];
    for (uint32_t row = 0; row < RHEO__BLOCK_ROWS; row++) {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + row;
        length[row] = rank < m->pairs.rows ? close_partners(m, order, rank, rows->scratch + row * stride) : 0;
        rows->length[rank] = length[row];
        rows->partners += length[row];
        longest = length[row] > longest ? length[row] : longest;
    }
    rows->start[block + 1] = rows->start[block] + longest;
    for (uint32_t row = 0; row < RHEO__BLOCK_ROWS; row++) {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + row;
        for (uint32_t k = length[row]; k < longest + 4; k++)
            rows->scratch[row * stride + k] = rank < m->pairs.rows ? rank : m->pairs.rows;
    }
    uint32_t *to = rows->partner + (size_t)rows->start[block] * RHEO__BLOCK_ROWS;
#if !RHEO_DOUBLE
    /* Four partners of a row are loaded as the four numbers of a point. No rank has the bits of a NaN. */
    RHEO__EACH_VECTOR_OF_BLOCK (first) {
        for (uint32_t k = 0; k < longest; k += 4) {
            uint32_t at[RHEO__LANES];
            for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
                at[lane] = (uint32_t)(((first + lane) * stride + k) / 4);
            rheo__lanes entry[4];
            const rheo__lanes3 three =
                rheo__lanes_load_w((const rheo__point *)(const void *)rows->scratch, at, &entry[3]);
            entry[0] = three.x;
            entry[1] = three.y;
            entry[2] = three.z;
            for (uint32_t i = 0; i < 4 && k + i < longest; i++)
                memcpy(to + (size_t)(k + i) * RHEO__BLOCK_ROWS + first, &entry[i], sizeof entry[i]);
        }
    }
#else
    for (uint32_t k = 0; k < longest; k++)
        for (uint32_t row = 0; row < RHEO__BLOCK_ROWS; row++)
            to[(size_t)k * RHEO__BLOCK_ROWS + row] = rows->scratch[row * stride + k];
#endif
}

/* Finds slopes and weights of a vector of rows. Returns the rows that coincide with a partner. */
static rheo__mask fill_vector(const rheo__melting *m, rheo__rows *rows, uint32_t block, uint32_t first)
{
    const rheo_real inverse_h = (rheo_real)(1 / m->smoothing_length), scale = m->kernel_scale,
                    slope_scale = scale * inverse_h * inverse_h;
    uint32_t own[RHEO__LANES];
    rheo__own_ranks(block * RHEO__BLOCK_ROWS + first, own);
    rheo__lane_index lengths[RHEO__LANES];
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
        lengths[lane] = (rheo__lane_index)rows->length[own[lane]];
    rheo__mask row_length;
    memcpy(&row_length, lengths, sizeof row_length);
    const rheo__lanes3 x = rheo__lanes_load(m->position, own);
    rheo__mask coinciding = {0};
    rheo__lane_index k = 0;
    RHEO__EACH_ENTRY(rows, block, first, entry)
    {
        const rheo__lanes3 offset = rheo__offsets(m, x, entry);
        const rheo__lanes q = rheo__lanes_sqrt(rheo__lanes3_dot(offset, offset)) * inverse_h;
        const rheo__mask active = row_length > k;
        coinciding |= active & (q == 0);
        rheo__lanes slope;
        const rheo__lanes weight = rheo__lanes_quintic(q, &slope);
        rheo__lanes_put(rows->slope, entry, rheo__lanes_keep(active, slope * slope_scale));
        rheo__lanes_put(rows->weight, entry, rheo__lanes_keep(active, weight * scale));
        k++;
    }
    return coinciding;
}

void RHEO__VARIANT(fill_rows)(rheo__melting *m)
{
    rheo__rows *rows = &m->rows;
    rheo__hit_order order;
    rheo__make_hit_order(&order);
    rheo__mask coinciding = {0};
    rows->partners = 0;
    rows->start[0] = 0;
    for (uint32_t block = 0; block < rows->blocks; block++) {
        fill_block(m, &order, block);
        RHEO__EACH_VECTOR_OF_BLOCK (first)
            coinciding |= fill_vector(m, rows, block, first);
    }
    m->coinciding = rheo__lanes_any(coinciding);
}
