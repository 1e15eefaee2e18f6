/*
 * Stage density (double density relaxation of Clavet et al.; docs/model.md, 7): particle by particle, with w = 1 - r/h,
 *
 *     rho = sum w^2,  rho_near = sum w^3,  P = k (rho - rho0),  P_near = k_near rho_near
 *     D = step^2 (P w + P_near w^2) r_ij;   x_j += D/2;   x_i -= sum D/2
 *
 * Sequential: a particle sees the positions that the particles before it left; within its row its own position rests.
 * Pairs are those of the predicted positions; whatever has left the support since is passed over.
 */
#include "thickening/thickening.h"

/* A neighbour in the row that is being relaxed. */
typedef struct row_entry {
    rheo_real x, y, z, w; /* unit vector to the neighbour; weight, 0 outside the support */
} row_entry;

/* Coinciding particles are parted along a direction of their own: three bits each of the two ids. */
static void part_direction(uint32_t a, uint32_t b, row_entry *entry)
{
    uint32_t mixed = (a < b ? a : b) * UINT32_C(0x9E3779B1) ^ (a < b ? b : a) * UINT32_C(0x85EBCA77);
    rheo_real x = (rheo_real)(mixed >> 29 & 7) - RHEO_R(3.5);
    rheo_real y = (rheo_real)(mixed >> 26 & 7) - RHEO_R(3.5);
    rheo_real z = (rheo_real)(mixed >> 23 & 7) - RHEO_R(3.5);
    rheo_real scale = (a < b ? 1 : -1) / rheo_sqrt(rheo_length2(x, y, z));
    entry->x = x * scale;
    entry->y = y * scale;
    entry->z = z * scale;
}

rheo_result rheo_stage_density(rheo_state *s, void *context)
{
    rheo_thickening *t = context;
    const rheo_pairs *pairs = rheo_step_pairs(s);
    const uint32_t *lower = t->list.lower, *lower_start = t->list.lower_start;
    size_t longest = 0;
    for (uint32_t i = 0; i < pairs->rows; i++) {
        size_t length = lower_start[i + 1] - lower_start[i] + pairs->start[i + 1] - pairs->start[i];
        longest = length > longest ? length : longest;
    }
    void *room = t->row;
    if (!rheo_grow(&t->allocator, &room, &t->row_capacity, 4 * longest + 4, 0, sizeof *t->row))
        return RHEO_ERROR_MEMORY;
    t->row = room;
    row_entry *row = (row_entry *)room;

    rheo_point *x = t->position;
    rheo_gather(x, s->position, pairs->id_of, pairs->rows);
    rheo_real inverse_support = t->inverse_support, half_step2 = RHEO_R(0.5) * (t->step * t->step);
    for (uint32_t l = 0; l < t->list.line_count; l++)
        for (uint32_t i = t->list.line[l].first; i < t->list.line[l].end; i++) {
            rheo_point xi = x[i];
            /* The row: partners of lower, then of higher rank, ascending. */
            const uint32_t *part[2] = {lower + lower_start[i], pairs->partner + pairs->start[i]};
            uint32_t length[2] = {lower_start[i + 1] - lower_start[i], pairs->start[i + 1] - pairs->start[i]};
            rheo_real density = 0, near_density = 0;
            row_entry *entry = row;
            for (int p = 0; p < 2; p++)
                for (uint32_t k = 0; k < length[p]; k++, entry++) {
                    uint32_t j = part[p][k];
                    rheo_real dx = x[j].x - xi.x, dy = x[j].y - xi.y, dz = x[j].z - xi.z;
                    rheo_real r2 = rheo_length2(dx, dy, dz);
                    rheo_real r = rheo_sqrt(r2);
                    rheo_real w = rheo_max(1 - r * inverse_support, 0);
                    rheo_real inverse = 1 / r;
                    *entry = (row_entry){dx * inverse, dy * inverse, dz * inverse, w};
                    if (r2 == 0)
                        part_direction(pairs->id_of[i], pairs->id_of[j], entry);
                    density += w * w;
                    near_density += w * w * w;
                }
            rheo_real pressure = half_step2 * (t->stiffness * (density - t->rest_density));
            rheo_real near_pressure = half_step2 * (t->near_stiffness * near_density);
            entry = row;
            for (int p = 0; p < 2; p++)
                for (uint32_t k = 0; k < length[p]; k++, entry++) {
                    uint32_t j = part[p][k];
                    rheo_real move = entry->w * (pressure + near_pressure * entry->w);
                    rheo_real dx = move * entry->x, dy = move * entry->y, dz = move * entry->z;
                    x[j].x += dx;
                    x[j].y += dy;
                    x[j].z += dz;
                    xi.x -= dx;
                    xi.y -= dy;
                    xi.z -= dz;
                }
            x[i] = xi;
        }
    rheo_scatter(s->position, x, pairs->id_of, pairs->rows);
    return RHEO_OK;
}
