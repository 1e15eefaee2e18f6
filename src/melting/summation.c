/*
 * Stage summation: rho_i = sum m W, with the particle itself and walls. The paper rejects it, because particles at a
 * free surface lack neighbours and therefore density. It is there for comparison.
 */
#include "core/quintic.h"
#include "melting/rows.h"

rheo_result RHEO__VARIANT(stage_summation)(rheo__state *s, void *context)
{
    rheo__melting *m = context;
    const rheo__rows *rows = &m->rows;
    const rheo_real mass = (rheo_real)rheo__melting_mass(m->def), own = RHEO__QUINTIC_AT_0 * m->kernel_scale;
    RHEO__EACH_VECTOR_OF_ROWS(rows, block, first)
    {
        const uint32_t rank = block * RHEO__BLOCK_ROWS + first;
        rheo__lane_index length[RHEO__LANES], k = 0;
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
            length[lane] = (rheo__lane_index)rows->length[rank + lane];
        rheo__mask lengths;
        memcpy(&lengths, length, sizeof lengths);
        const rheo__keeper keeper = rheo__row_keeper(s, m, rank);
        rheo__row_begins_with(&keeper, RHEO__SUM_number_density, RHEO_SOURCE_SHARE, own);
        rheo__lanes sum = rheo__lanes_all(own);
        RHEO__EACH_ENTRY(rows, block, first, entry)
        {
            rheo__row_adds_number(&keeper, RHEO__SUM_number_density, RHEO_SOURCE_SHARE, rows->partner + entry,
                                  rheo__lanes_keep(lengths > k, rheo__lanes_at(rows->weight, entry)));
            sum += rheo__lanes_keep(lengths > k, rheo__lanes_at(rows->weight, entry)); /* without idle entries */
            k++;
        }
        rheo__row_begins(&keeper, RHEO__FIELD_density);
        rheo__row_applies(&keeper, RHEO__FIELD_density, mass, RHEO__SUM_number_density);
        rheo__lanes_put(m->density, rank, mass * sum);
    }
    /* Union of the half spaces behind walls: 1 - (1 - a)(1 - b). */
    for (uint32_t k = 0; k < m->contacts;) {
        const uint32_t rank = m->contact[k].rank;
        rheo_real free = 1;
        for (; k < m->contacts && m->contact[k].rank == rank; k++)
            free *= 1 - m->contact[k].integral.weight;
        rheo__rank_adds(s, m, rank, RHEO__FIELD_density, RHEO_SOURCE_WALL, rheo__nearest_wall(m, k - 1),
                        (rheo_real)m->def->melting.rest_density * (1 - free), 0, 0);
        m->density[rank] += (rheo_real)m->def->melting.rest_density * (1 - free);
    }
    for (uint32_t i = 0; i < s->particles; i++)
        s->density[m->pairs.id_of[i]] = m->velocity[i].w = m->density[i];
    return RHEO_OK;
}
