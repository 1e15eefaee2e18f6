/*
 * Rows in blocks (melting/melting.h), from the rows of a search: partners that may come near enough for viscosity go
 * first, each part in the order of cells. Rows are then transposed, so that the k-th partners of the rows of a block lie
 * side by side.
 */
#include "melting/rows.h"
#include "space/append.h"

/* Writes the partners of a row, near ones first. Returns the number of near ones. far: workspace. */
static inline uint32_t split_row(const rheo__melting *m, const rheo__hit_order *order, uint32_t rank,
                                 uint32_t *partner, uint32_t *far)
{
    const uint32_t *row = m->list.row + m->list.row_start[m->rows.row_of[rank]], length = m->rows.length[rank];
    const rheo__lanes zero = rheo__lanes_all(0), one = rheo__lanes_all(1);
    const rheo__point own = m->searched_at[rank];
    const rheo__lanes3 x = {rheo__lanes_all(own.x), rheo__lanes_all(own.y), rheo__lanes_all(own.z)};
    uint32_t near_count = 0, far_count = 0;
    for (uint32_t k = 0; k < length; k += RHEO__LANES) {
        uint32_t candidate[RHEO__LANES];
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
            candidate[lane] = RHEO__POINT_VALUES * m->list.block_rank[row[k + lane < length ? k + lane : length - 1]];
        rheo__lanes reach;
        const rheo__lanes3 offset =
            rheo__lanes3_minus(x, rheo__lanes_load_values(&m->searched_at->x, candidate, 1, &reach));
        reach += own.w;
        const rheo__lanes r2 = rheo__lanes3_dot(offset, offset), near2 = reach * reach;
        const uint32_t set = rheo__lanes_before(length - k);
        const rheo__hits near = rheo__find_hits(order, r2, near2, set),
                         others = rheo__find_hits(order, rheo__lanes_if_less(r2, near2, one, zero), one, set);
        rheo__write_ranks(&near, candidate, partner + near_count);
        rheo__write_ranks(&others, candidate, far + far_count);
        near_count += near.count;
        far_count += others.count;
    }
    memcpy(partner + near_count, far, far_count * sizeof *far);
    return near_count;
}

/* Writes columns of the rows of a block, from rows that lie `stride` apart. */
static void transpose(const uint32_t *from, size_t stride, uint32_t columns, uint32_t *to)
{
#if !RHEO_DOUBLE
    /* Four partners of a row are loaded as the four numbers of a point. No index has the bits of a NaN. */
    RHEO__EACH_VECTOR_OF_BLOCK (first) {
        for (uint32_t k = 0; k < columns; k += 4) {
            uint32_t at[RHEO__LANES];
            for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
                at[lane] = (uint32_t)(((first + lane) * stride + k) / 4);
            rheo__lanes entry[4];
            const rheo__lanes3 three = rheo__lanes_load_w((const rheo__point *)(const void *)from, at, &entry[3]);
            entry[0] = three.x;
            entry[1] = three.y;
            entry[2] = three.z;
            for (uint32_t i = 0; i < 4 && k + i < columns; i++)
                memcpy(to + (size_t)(k + i) * RHEO__BLOCK_ROWS + first, &entry[i], sizeof entry[i]);
        }
    }
#else
    for (uint32_t k = 0; k < columns; k++)
        for (uint32_t row = 0; row < RHEO__BLOCK_ROWS; row++)
            to[(size_t)k * RHEO__BLOCK_ROWS + row] = from[row * stride + k];
#endif
}

static void fill_block(rheo__melting *m, const rheo__hit_order *order, uint32_t block)
{
    rheo__rows *rows = &m->rows;
    const size_t stride = rows->stride;
    const uint32_t entries = rows->start[block + 1] - rows->start[block];
    uint32_t *far = rows->scratch + RHEO__BLOCK_ROWS * stride, most = 0;
    for (uint32_t row = 0; row < RHEO__BLOCK_ROWS; row++) {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + row;
        uint32_t *partner = rows->scratch + row * stride;
        const uint32_t near = rank < m->pairs.rows ? split_row(m, order, rank, partner, far) : 0;
        most = near > most ? near : most;
        for (uint32_t k = rows->length[rank]; k < entries + 4; k++)
            partner[k] = RHEO__POINT_VALUES * (rank < m->pairs.rows ? rank : m->pairs.rows);
    }
    uint32_t *to = rows->partner + (size_t)rows->start[block] * RHEO__BLOCK_ROWS;
    transpose(rows->scratch, stride, entries, to);
    if (!m->viscous)
        return;
    m->bonds.start[block + 1] = m->bonds.start[block] + most;
    if (most) /* particles without partners have no arrays */
        memcpy(m->bonds.partner + (size_t)m->bonds.start[block] * RHEO__BLOCK_ROWS, to,
               (size_t)most * RHEO__BLOCK_ROWS * sizeof *to);
}

void RHEO__VARIANT(fill_rows)(rheo__melting *m)
{
    rheo__hit_order order;
    rheo__make_hit_order(&order);
    m->bonds.blocks = m->rows.blocks;
    if (m->viscous)
        m->bonds.start[0] = 0;
    for (uint32_t block = 0; block < m->rows.blocks; block++)
        fill_block(m, &order, block);
}
