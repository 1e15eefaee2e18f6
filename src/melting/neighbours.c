/*
 * Stage neighbours: at the positions of the start of the substep, the neighbours within the support, their rows in
 * blocks, and the contacts of particles with walls. Positions, velocities, densities and temperatures are copied in
 * rank order; stages that change the last three keep the copies up to date.
 *
 * Every particle has a margin. A search finds the pairs that are closer than the support and both margins. They serve
 * the following substeps of the step, until a particle has used up its margin. The first substep always searches, so a
 * step depends only on the state that it begins with.
 */
#include <string.h>

#include "melting/melting.h"

/*
 * Margins in supports. That of a particle is LIFE times its displacement in a substep, at its speed when the search is
 * made, within bounds: every sum takes the pairs that the margins add.
 */
static const double LEAST_MARGIN = 0.002, MOST_MARGIN = 0.1, LIFE = 10;
/* Rows are ordered by length within groups of this many ranks, so that those of a block are about equally long. */
enum { GROUP = 128 };

/* ---- Margins ---- */

/* Mean of `values`, or of their differences to `less`. Motion common to all particles brings no pair together. */
static void mean_of(const rheo_real *values, const rheo__point *less, const uint32_t *rank_of, uint32_t particles,
                    rheo_real mean[3])
{
    double sum[3] = {0, 0, 0};
    for (uint32_t id = 0; id < particles; id++) {
        const rheo_real *v = values + 3 * (size_t)id;
        const rheo__point from = less ? less[rank_of[id]] : (rheo__point){0, 0, 0, 0};
        sum[0] += (double)(v[0] - from.x);
        sum[1] += (double)(v[1] - from.y);
        sum[2] += (double)(v[2] - from.z);
    }
    for (int axis = 0; axis < 3; axis++)
        mean[axis] = (rheo_real)(particles ? sum[axis] / particles : 0);
}

static void set_margins(const rheo__state *s, rheo__melting *m)
{
    const bool flow = m->def->melting.flow == RHEO_FLOW_ON;
    const rheo_real by = (rheo_real)LIFE * m->substep, least = (rheo_real)(flow ? LEAST_MARGIN * m->support : 0),
                    most = (rheo_real)(flow ? MOST_MARGIN * m->support : 0);
    rheo_real mean[3];
    mean_of(s->velocity, NULL, NULL, s->particles, mean);
    for (uint32_t id = 0; id < s->particles; id++) {
        const rheo_real *v = s->velocity + 3 * (size_t)id;
        const rheo_real speed = rheo__sqrt(rheo__length2(v[0] - mean[0], v[1] - mean[1], v[2] - mean[2]));
        m->margin[id] = rheo__min(rheo__max(by * speed, least), most);
    }
}

/* Whether no particle has used up its margin since the search. */
static bool pairs_last(const rheo__state *s, const rheo__melting *m)
{
    const uint32_t *rank_of = m->pairs.rank_of;
    rheo_real mean[3];
    mean_of(s->position, m->searched_at, rank_of, s->particles, mean);
    for (uint32_t id = 0; id < s->particles; id++) {
        const rheo_real *x = s->position + 3 * (size_t)id;
        const rheo__point from = m->searched_at[rank_of[id]];
        const rheo_real moved2 =
            rheo__length2(x[0] - from.x - mean[0], x[1] - from.y - mean[1], x[2] - from.z - mean[2]);
        if (!(moved2 < m->margin[id] * m->margin[id]))
            return false;
    }
    return true;
}

/* ---- Rows ---- */

static uint32_t length_of(const rheo__melting *m, uint32_t row)
{
    return m->list.row_start[row + 1] - m->list.row_start[row];
}

/* Makes the ranks follow the lengths of rows within each group: stable, longest first. */
static void sort_by_length(rheo__melting *m)
{
    const uint32_t rows = m->pairs.rows;
    uint32_t *id_of = m->pairs.id_of, *rank_of = m->pairs.rank_of, *row_of = m->rows.row_of;
    for (uint32_t first = 0; first < rows; first += GROUP) {
        const uint32_t count = rows - first < GROUP ? rows - first : GROUP;
        for (uint32_t row = first; row < first + count; row++) {
            uint32_t at = row;
            for (; at > first && length_of(m, row_of[at - 1]) < length_of(m, row); at--)
                row_of[at] = row_of[at - 1];
            row_of[at] = row;
        }
        uint32_t id[GROUP];
        memcpy(id, id_of + first, count * sizeof *id);
        for (uint32_t rank = first; rank < first + count; rank++) {
            id_of[rank] = id[row_of[rank] - first];
            rank_of[id_of[rank]] = rank;
            m->list.block_rank[row_of[rank]] = rank;
        }
    }
}

static bool reserve_rows(rheo__melting *m, size_t entries)
{
    rheo__rows *r = &m->rows;
    const rheo_allocator *allocator = &m->allocator;
    if (entries <= r->capacity)
        return true;
    const size_t wanted = entries + entries / 16;
    uint32_t *partner = rheo__allocate(allocator, wanted, (m->viscous ? 2 : 1) * RHEO__BLOCK_ROWS * sizeof *partner);
    rheo_real **arrays[] = {&r->slope, &r->weight, &m->bonds.x, &m->bonds.y, &m->bonds.z};
    enum { ARRAYS = sizeof arrays / sizeof *arrays, OF_ROWS = 2 };
    const int count = m->viscous ? ARRAYS : OF_ROWS;
    rheo_real *larger[ARRAYS];
    bool enough = partner != NULL;
    for (int i = 0; i < count; i++) {
        larger[i] = enough ? rheo__allocate(allocator, wanted, RHEO__BLOCK_ROWS * sizeof **larger) : NULL;
        enough = enough && larger[i];
    }
    for (int i = 0; i < count; i++) {
        rheo__release(allocator, enough ? *arrays[i] : larger[i]);
        if (enough)
            *arrays[i] = larger[i];
    }
    rheo__release(allocator, enough ? r->partner : partner);
    if (!enough)
        return false;
    r->partner = partner;
    m->bonds.partner = m->viscous ? partner + wanted * RHEO__BLOCK_ROWS : NULL;
    r->capacity = wanted;
    return true;
}

/* Finds where the rows of each block lie, and makes room for them. False: no memory. */
static bool place_rows(rheo__melting *m)
{
    const uint32_t rows = m->pairs.rows;
    rheo__rows *r = &m->rows;
    r->blocks = rows / RHEO__BLOCK_ROWS + (rows % RHEO__BLOCK_ROWS != 0);
    size_t entries = 0, longest_row = 0;
    for (uint32_t b = 0; b < r->blocks; b++) {
        size_t longest = 0;
        for (uint32_t i = b * RHEO__BLOCK_ROWS; i < (b + 1) * RHEO__BLOCK_ROWS; i++) {
            r->length[i] = i < rows ? length_of(m, r->row_of[i]) : 0;
            longest = r->length[i] > longest ? r->length[i] : longest;
        }
        r->start[b] = (uint32_t)entries;
        entries += longest;
        longest_row = longest > longest_row ? longest : longest_row;
    }
    r->start[r->blocks] = (uint32_t)entries;
    r->idle = entries * RHEO__BLOCK_ROWS - m->list.row_start[rows];
    /* Rows are written in whole vectors, and read in groups of four. */
    r->stride = (uint32_t)(longest_row + 2 * RHEO__BLOCK_ROWS) / 4 * 4;
    void *scratch = r->scratch;
    const bool enough = rheo__grow(&m->allocator, &scratch, &r->scratch_capacity,
                                   4 * (size_t)RHEO__BLOCK_ROWS * r->stride, 0, sizeof(rheo_real));
    r->scratch = scratch;
    return enough && entries <= UINT32_MAX && reserve_rows(m, entries);
}

/* Makes the rows at the present positions. False: no memory. */
static bool search(const rheo__state *s, rheo__melting *m)
{
    m->searched = false;
    set_margins(s, m);
    if (!rheo__neighbours_build_rows(&m->list, &m->pairs, &m->allocator, s->particles, s->position, m->support,
                                     m->margin, NULL))
        return false;
    sort_by_length(m);
    if (!place_rows(m))
        return false;
    rheo__gather(m->searched_at, s->position, m->pairs.id_of, s->particles);
    for (uint32_t i = 0; i < s->particles; i++)
        m->searched_at[i].w = (rheo_real)(m->viscous_support / 2) + m->margin[m->pairs.id_of[i]];
    rheo__fill_rows(m);
    m->searched = true;
    return true;
}

/* ---- The stage ---- */

/* Lists contacts by rank, then by wall. False: no memory. */
static bool find_contacts(rheo__melting *m)
{
    const rheo_real support = (rheo_real)m->support;
    m->contacts = 0;
    for (uint32_t i = 0; m->planes->count && i < m->pairs.rows; i++) {
        const rheo__point *x = &m->point[i].at;
        for (uint32_t w = 0; w < m->planes->count; w++) {
            const rheo_real distance = rheo__plane_distance(&m->planes->plane[w], x->x, x->y, x->z);
            if (!(distance < support))
                continue;
            void *contact = m->contact;
            if (!rheo__grow(&m->allocator, &contact, &m->contact_capacity, (size_t)m->contacts + 1, m->contacts,
                            sizeof *m->contact))
                return false;
            m->contact = contact;
            m->contact[m->contacts++] = (rheo__contact){i, w, distance, rheo__wall_look_up(m, distance), 0, false};
        }
    }
    return true;
}

static void copy_in_rank_order(const rheo__state *s, rheo__melting *m)
{
    const uint32_t *id_of = m->pairs.id_of, count = s->particles;
    rheo__gather(m->velocity, s->velocity, id_of, count);
    for (uint32_t i = 0; i < count; i++) {
        const rheo_real *x = s->position + 3 * (size_t)id_of[i];
        m->point[i].at = (rheo__point){x[0], x[1], x[2], 0};
        m->velocity[i].w = s->density[id_of[i]];
    }
    for (uint32_t i = count; i < m->rows.blocks * RHEO__BLOCK_ROWS + 1; i++) {
        m->velocity[i] = (rheo__point){0, 0, 0, 1};
        m->point[i] = (rheo__wide_point){{0, 0, 0, 0}, {0, 0, 0, 0}};
    }
    for (uint32_t i = 0; i < count && m->warm; i++)
        m->temperature[i] = s->temperature[id_of[i]];
}

rheo_result rheo__stage_melting_neighbours(rheo__state *s, void *context)
{
    rheo__melting *m = context;
    const bool kept = m->def->melting.flow == RHEO_FLOW_ON && m->searched && pairs_last(s, m);
    if (!kept && !search(s, m))
        return RHEO_ERROR_MEMORY;
    copy_in_rank_order(s, m);
    if (!find_contacts(m))
        return RHEO_ERROR_MEMORY;
    if (rheo__needs_kernels_early(m->def))
        rheo__find_kernels(m);
    return RHEO_OK;
}
