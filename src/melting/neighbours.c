/*
 * Stage neighbours: at the positions of the start of the substep, the neighbours within the support, their rows in
 * blocks, and the contacts of particles with walls. Positions, velocities, densities and temperatures are copied in
 * rank order; stages that change the last three keep the copies up to date.
 */
#include <assert.h>

#include "melting/melting.h"

static bool reserve_rows(rheo__melting *m, size_t entries, uint32_t blocks)
{
    rheo__rows *r = &m->rows;
    const rheo_allocator *allocator = &m->allocator;
    void *start = r->start;
    if (!rheo__grow(allocator, &start, &r->block_capacity, (size_t)blocks + 1, 0, sizeof *r->start))
        return false;
    r->start = start;
    if (entries <= r->capacity)
        return true;
    const size_t wanted = entries + entries / 8;
    uint32_t *partner = rheo__allocate(allocator, wanted, RHEO__BLOCK_ROWS * sizeof *partner);
    rheo_real **arrays[] = {&r->x, &r->y, &r->z, &r->slope, &r->weight, &r->viscous_x, &r->viscous_y, &r->viscous_z};
    enum { ARRAYS = sizeof arrays / sizeof *arrays };
    rheo_real *larger[ARRAYS];
    bool enough = partner != NULL;
    for (int i = 0; i < ARRAYS; i++) {
        larger[i] = enough ? rheo__allocate(allocator, wanted, RHEO__BLOCK_ROWS * sizeof **larger) : NULL;
        enough = enough && larger[i];
    }
    for (int i = 0; i < ARRAYS; i++) {
        rheo__release(allocator, enough ? *arrays[i] : larger[i]);
        if (enough)
            *arrays[i] = larger[i];
    }
    rheo__release(allocator, enough ? r->partner : partner);
    if (!enough)
        return false;
    r->partner = partner;
    r->capacity = wanted;
    return true;
}

/* Finds the first entry of each block. False: no memory. */
static bool lay_out(rheo__melting *m)
{
    const uint32_t rows = m->pairs.rows, *start = m->list.row_start;
    const uint32_t blocks = rows / RHEO__BLOCK_ROWS + (rows % RHEO__BLOCK_ROWS != 0);
    if (!reserve_rows(m, m->rows.capacity, blocks))
        return false;
    size_t entries = 0;
    for (uint32_t b = 0; b < blocks; b++) {
        uint32_t longest = 0;
        for (uint32_t i = b * RHEO__BLOCK_ROWS; i < rows && i < (b + 1) * RHEO__BLOCK_ROWS; i++)
            longest = start[i + 1] - start[i] > longest ? start[i + 1] - start[i] : longest;
        m->rows.start[b] = (uint32_t)entries;
        entries += longest;
    }
    m->rows.start[blocks] = (uint32_t)entries;
    assert((size_t)blocks * RHEO__BLOCK_ROWS <= m->particle_capacity);
    m->rows.blocks = blocks;
    return entries <= UINT32_MAX && reserve_rows(m, entries, blocks);
}

/* Lists contacts by rank, then by wall. False: no memory. */
static bool find_contacts(rheo__melting *m)
{
    const rheo_real support = (rheo_real)m->support;
    m->contacts = 0;
    for (uint32_t i = 0; m->planes->count && i < m->pairs.rows; i++) {
        const rheo__point *x = &m->position[i];
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
    const uint32_t *id_of = m->pairs.id_of;
    rheo__gather(m->position, s->position, id_of, s->particles);
    rheo__gather(m->velocity, s->velocity, id_of, s->particles);
    for (uint32_t i = 0; i < s->particles; i++)
        m->velocity[i].w = s->density[id_of[i]];
    m->velocity[s->particles].w = 1;
    for (uint32_t i = 0; i < s->particles && rheo__state_has(s, RHEO__FIELD_temperature); i++)
        m->temperature[i] = s->temperature[id_of[i]];
}

rheo_result rheo__stage_melting_neighbours(rheo__state *s, void *context)
{
    rheo__melting *m = context;
    if (!rheo__neighbours_build_rows(&m->list, &m->pairs, &m->allocator, s->particles, s->position, m->support, NULL))
        return RHEO_ERROR_MEMORY;
    copy_in_rank_order(s, m);
    if (!lay_out(m) || !find_contacts(m))
        return RHEO_ERROR_MEMORY;
    rheo__fill_rows(m);
    m->diagnostics.mean_neighbours = s->particles ? (double)m->list.row_start[s->particles] / s->particles : 0;
    return RHEO_OK;
}
