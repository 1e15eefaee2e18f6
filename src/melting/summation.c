/*
 * Stage summation: rho_i = sum m W, the particle itself and walls included. The paper rejects it: what lies at a free
 * surface lacks neighbours and so density. Kept for comparison.
 */
#include "melting/dispatch.h"
#include "melting/rows.h"

rheo_result RHEO__VARIANT(stage_summation)(rheo__state *s, void *context)
{
    rheo__melting *m = context;
    const rheo__rows *rows = &m->rows;
    const rheo_real mass = (rheo_real)m->mass, own = 66 * m->kernel_scale;
    rheo_real *density = m->density_rate;
    for (uint32_t block = 0; block < rows->blocks; block++)
        RHEO__EACH_VECTOR_OF_BLOCK (first) {
            rheo__lanes sum = rheo__lanes_all(own);
            for (uint32_t entry = rows->start[block]; entry < rows->start[block + 1]; entry++)
                sum += rheo__lanes_at(rows->weight, (size_t)entry * RHEO__BLOCK_ROWS + first);
            rheo__lanes_put(density, block * RHEO__BLOCK_ROWS + first, mass * sum);
        }
    /* Where walls meet, what is behind two of them counts once: 1 - (1 - a)(1 - b). */
    for (uint32_t k = 0; k < m->contacts;) {
        const uint32_t rank = m->contact[k].rank;
        rheo_real free = 1;
        for (; k < m->contacts && m->contact[k].rank == rank; k++)
            free *= 1 - m->contact[k].of.weight;
        density[rank] += (rheo_real)m->def->melting.rest_density * (1 - free);
    }
    for (uint32_t i = 0; i < s->particles; i++)
        s->density[m->pairs.id_of[i]] = density[i];
    return RHEO_OK;
}
