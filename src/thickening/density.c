/*
 * Stage density (double density relaxation of Clavet et al.; docs/model.md, 7): particle by particle, with w = 1 -
 * r/h,
 *
 *     rho = sum w^2,  rho_near = sum w^3,  P = k (rho - rho0),  P_near = k_near rho_near
 *     D = step^2 (P w + P_near w^2) r_ij;   x_j += D/2;   x_i -= sum D/2
 *
 * Sequential: a particle sees the positions that the particles before it left; within its row its own position rests.
 * Pairs are those of the predicted positions; whatever has left the support since is passed over.
 */
#include "space/walk.h"
#include "thickening/thickening.h"

/* A neighbour in each lane of the rows that are being relaxed. */
typedef struct row_entry {
    rheo_lanes3 to; /* unit vector to the neighbour */
    rheo_lanes w;   /* weight, 0 outside the support */
    rheo_mask active;
    uint32_t partner[RHEO_LANES];
} row_entry;

typedef struct sums {
    rheo_lanes density, near_density;
    rheo_mask coinciding;
} sums;

static inline void weigh(sums *sum, row_entry *entry, rheo_lanes3 xi, const rheo_point *x, rheo_real inverse_support)
{
    rheo_lanes3 xj = rheo_lanes_load(x, entry->partner);
    rheo_lanes dx = xj.x - xi.x, dy = xj.y - xi.y, dz = xj.z - xi.z;
    rheo_lanes r2 = dx * dx + dy * dy + dz * dz;
    rheo_lanes r = rheo_lanes_sqrt(r2);
    rheo_lanes w = 1 - r * inverse_support;
    w = rheo_lanes_keep((w > 0) & entry->active, w);
    rheo_lanes inverse = 1 / r;
    entry->to = (rheo_lanes3){dx * inverse, dy * inverse, dz * inverse};
    entry->w = w;
    sum->density += w * w;
    sum->near_density += w * w * w;
    sum->coinciding |= (r2 == 0) & entry->active;
}

static inline void move(rheo_lanes3 *xi, rheo_point *x, const row_entry *entry, rheo_lanes pressure,
                        rheo_lanes near_pressure)
{
    rheo_lanes3 xj = rheo_lanes_load(x, entry->partner);
    rheo_lanes by = entry->w * (pressure + near_pressure * entry->w);
    rheo_lanes dx = by * entry->to.x, dy = by * entry->to.y, dz = by * entry->to.z;
    xi->x = rheo_lanes_select(entry->active, xi->x - dx, xi->x);
    xi->y = rheo_lanes_select(entry->active, xi->y - dy, xi->y);
    xi->z = rheo_lanes_select(entry->active, xi->z - dz, xi->z);
    rheo_lanes_store(x, entry->partner, (rheo_lanes3){xj.x + dx, xj.y + dy, xj.z + dz});
}

/* Coinciding particles are parted along a direction of their own, from three bits for each axis of their mixed ids.
 */
static void part_direction(uint32_t a, uint32_t b, rheo_real direction[3])
{
    uint32_t mixed = (a < b ? a : b) * UINT32_C(0x9E3779B1) ^ (a < b ? b : a) * UINT32_C(0x85EBCA77);
    for (int axis = 0; axis < 3; axis++)
        direction[axis] = (rheo_real)(mixed >> (29 - 3 * axis) & 7) - RHEO_R(3.5);
    rheo_real scale = (a < b ? 1 : -1) / rheo_sqrt(rheo_length2(direction[0], direction[1], direction[2]));
    for (int axis = 0; axis < 3; axis++)
        direction[axis] *= scale;
}

/* Gives the coinciding pairs among the rows of a round their directions. */
static void part(const rheo_walk *walk, const rheo_pairs *pairs, const rheo_point *x, row_entry *entry)
{
    for (int lane = 0; lane < RHEO_LANES; lane++)
        for (uint32_t k = 0; k < (uint32_t)walk->length[lane]; k++) {
            uint32_t i = walk->row[lane], j = entry[k].partner[lane];
            if (rheo_length2(x[j].x - x[i].x, x[j].y - x[i].y, x[j].z - x[i].z) != 0)
                continue;
            rheo_real direction[3];
            part_direction(pairs->id_of[i], pairs->id_of[j], direction);
            entry[k].to.x[lane] = direction[0];
            entry[k].to.y[lane] = direction[1];
            entry[k].to.z[lane] = direction[2];
        }
}

/* What the health of a run is told by: how dense it is, and where. */
typedef struct densities {
    rheo_lanes above;  /* sum over rows of what a density is above that at rest */
    rheo_real largest; /* and the rank that has it */
    uint32_t densest;
} densities;

static inline void note_densities(densities *found, const rheo_walk *walk, rheo_lanes density, rheo_real at_rest)
{
    rheo_lanes above = density - at_rest;
    found->above += rheo_lanes_keep(above > 0, above);
    rheo_mask more = density > found->largest;
    if (more[0] | more[1] | more[2] | more[3])
        for (int lane = 0; lane < RHEO_LANES; lane++)
            if (density[lane] > found->largest) {
                found->largest = density[lane];
                found->densest = walk->row[lane];
            }
}

static void relax_rows(const rheo_thickening *t, const rheo_walk *walk, const rheo_pairs *pairs, rheo_point *x,
                       densities *found)
{
    row_entry *entry = t->round;
    rheo_lanes3 xi = rheo_lanes_load(x, walk->row);
    sums sum = {{0}, {0}, {0}};
    for (uint32_t k = 0; k < walk->longest; k++) {
        uint32_t place[RHEO_LANES];
        rheo_walk_places(walk, k, place);
        rheo_walk_partners(walk, t->list.row, k, place, entry[k].partner);
        entry[k].active = rheo_walk_active(walk, k);
        weigh(&sum, &entry[k], xi, x, t->inverse_support);
    }
    if (sum.coinciding[0] | sum.coinciding[1] | sum.coinciding[2] | sum.coinciding[3])
        part(walk, pairs, x, entry);

    note_densities(found, walk, sum.density, t->rest_density);
    rheo_real half_step2 = RHEO_R(0.5) * (t->step * t->step);
    rheo_lanes pressure = half_step2 * (t->stiffness * (sum.density - t->rest_density));
    rheo_lanes near_pressure = half_step2 * (t->near_stiffness * sum.near_density);
    for (uint32_t k = 0; k < walk->longest; k++)
        move(&xi, x, &entry[k], pressure, near_pressure);
    rheo_lanes_store(x, walk->row, xi);
}

rheo_result rheo_stage_density(rheo_state *s, void *context)
{
    rheo_thickening *t = context;
    const rheo_pairs *pairs = rheo_step_pairs(s);
    if (!rheo_grow(&t->allocator, &t->round, &t->round_capacity, (size_t)t->list.longest_row + 1, 0,
                   sizeof(row_entry)))
        return RHEO_ERROR_MEMORY;
    rheo_point *x = t->position;
    rheo_gather(x, s->position, pairs->id_of, pairs->rows);
    densities found = {{0}, 0, UINT32_MAX};
    for (int colour = 0; colour < RHEO_COLOURS; colour++) {
        rheo_walk walk = rheo_walk_colour(&t->list, colour, pairs->rows);
        while (rheo_walk_on(&walk, t->list.row_start))
            relax_rows(t, &walk, pairs, x, &found);
    }
    double scale = t->rest_density > 0 ? 1 / (double)t->rest_density : 0;
    rheo_lanes above = found.above;
    t->found.density_error =
        pairs->rows ? (double)((above[0] + above[1]) + (above[2] + above[3])) * scale / pairs->rows : 0;
    t->found.largest_density = (double)found.largest * scale;
    t->found.densest_particle = found.densest < pairs->rows ? (double)pairs->id_of[found.densest] : -1;
    rheo_scatter(s->position, x, pairs->id_of, pairs->rows);
    return RHEO_OK;
}
