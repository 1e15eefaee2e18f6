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
#include "thickening/kernels.h"

/* A neighbour in each lane of the rows that are being relaxed. */
typedef struct row_entry {
    rheo_lanes3 to; /* unit vector to the neighbour */
    rheo_lanes w;   /* weight, 0 outside the support */
    rheo_mask active;
    uint32_t partner[RHEO_LANES];
} row_entry;

/* The rows of a round in one vector. */
typedef struct rows {
    rheo_lanes3 x;
    rheo_lanes density, near_density;
    rheo_mask coinciding;
} rows;

static inline void weigh(rows *own, row_entry *entry, const rheo_walk_pairs *pairs, bool all, const rheo_point *x,
                         rheo_real inverse_support)
{
    rheo_lanes3 xj = rheo_lanes_load(x, pairs->partner);
    rheo_lanes dx = xj.x - own->x.x, dy = xj.y - own->x.y, dz = xj.z - own->x.z;
    rheo_lanes r2 = dx * dx + dy * dy + dz * dz;
    rheo_lanes r = rheo_lanes_sqrt(r2);
    rheo_lanes w = 1 - r * inverse_support;
    rheo_mask coinciding = r2 == 0;
    w = rheo_lanes_keep(w > 0, w);
    if (!all) {
        w = rheo_lanes_keep(pairs->active, w);
        coinciding &= pairs->active;
        entry->active = pairs->active;
    }
    rheo_lanes inverse = 1 / r;
    entry->to = (rheo_lanes3){dx * inverse, dy * inverse, dz * inverse};
    entry->w = w;
    memcpy(entry->partner, pairs->partner, sizeof entry->partner);
    own->density += w * w;
    own->near_density += w * w * w;
    own->coinciding |= coinciding;
}

static inline void move(rows *own, rheo_point *x, const row_entry *entry, bool all, rheo_lanes pressure,
                        rheo_lanes near_pressure)
{
    rheo_lanes3 xj = rheo_lanes_load(x, entry->partner);
    rheo_lanes by = entry->w * (pressure + near_pressure * entry->w);
    rheo_lanes3 i_loses = {by * entry->to.x, by * entry->to.y, by * entry->to.z},
                j_loses = {-i_loses.x, -i_loses.y, -i_loses.z};
    if (!all) {
        i_loses = rheo_lanes3_keep(entry->active, i_loses);
        j_loses = rheo_lanes3_keep(entry->active, j_loses);
    }
    own->x = rheo_lanes3_minus(own->x, i_loses);
    rheo_lanes_store(x, entry->partner, rheo_lanes3_minus(xj, j_loses));
}

/* Gives the coinciding pairs among the rows of one vector their directions. */
static void part(const rheo_walk *walk, int vector, const rheo_pairs *pairs, const rheo_point *x, row_entry *entry)
{
    for (int lane = 0; lane < RHEO_LANES; lane++)
        for (uint32_t k = 0; k < (uint32_t)walk->length[vector * RHEO_LANES + lane]; k++) {
            row_entry *e = &entry[k * RHEO_VECTORS + (uint32_t)vector];
            uint32_t i = rheo_walk_rows(walk, vector)[lane], j = e->partner[lane];
            if (rheo_length2(x[j].x - x[i].x, x[j].y - x[i].y, x[j].z - x[i].z) != 0)
                continue;
            rheo_real direction[3];
            rheo_part_direction(pairs->id_of[i], pairs->id_of[j], direction);
            RHEO_LANE(e->to.x, lane) = direction[0];
            RHEO_LANE(e->to.y, lane) = direction[1];
            RHEO_LANE(e->to.z, lane) = direction[2];
        }
}

static void relax_rows(const rheo_thickening *t, const rheo_walk *walk, const rheo_pairs *pairs, rheo_point *x)
{
    row_entry *entry = t->round;
    rows own[RHEO_VECTORS] = {0};
    rheo_walk_prefetch(walk, t->list.row, sizeof *t->list.row);
    RHEO_EACH_VECTOR (n)
        own[n].x = rheo_lanes_load(x, rheo_walk_rows(walk, n));
    rheo_walk_pairs taken;
    uint32_t k = 0;
    for (; k < walk->shortest; k++)
        RHEO_EACH_VECTOR (n) {
            rheo_walk_take(walk, n, k, t->list.row, true, &taken);
            weigh(&own[n], &entry[k * RHEO_VECTORS + (uint32_t)n], &taken, true, x, t->inverse_support);
        }
    for (uint32_t longest = rheo_walk_longest(walk); k < longest; k++)
        RHEO_EACH_VECTOR (n)
            if (k < walk->longest[n]) {
                rheo_walk_take(walk, n, k, t->list.row, false, &taken);
                weigh(&own[n], &entry[k * RHEO_VECTORS + (uint32_t)n], &taken, false, x, t->inverse_support);
            }

    rheo_real half_step2 = RHEO_R(0.5) * (t->step * t->step);
    rheo_lanes pressure[RHEO_VECTORS], near_pressure[RHEO_VECTORS];
    RHEO_EACH_VECTOR (n) {
        if (rheo_lanes_any(own[n].coinciding))
            part(walk, n, pairs, x, entry);
        pressure[n] = half_step2 * (t->stiffness * (own[n].density - t->rest_density));
        near_pressure[n] = half_step2 * (t->near_stiffness * own[n].near_density);
        for (int lane = 0; lane < RHEO_LANES; lane++)
            t->density[rheo_walk_rows(walk, n)[lane]] = RHEO_LANE(own[n].density, lane);
    }
    for (k = 0; k < walk->shortest; k++)
        RHEO_EACH_VECTOR (n)
            move(&own[n], x, &entry[k * RHEO_VECTORS + (uint32_t)n], true, pressure[n], near_pressure[n]);
    for (uint32_t longest = rheo_walk_longest(walk); k < longest; k++)
        RHEO_EACH_VECTOR (n)
            if (k < walk->longest[n])
                move(&own[n], x, &entry[k * RHEO_VECTORS + (uint32_t)n], false, pressure[n], near_pressure[n]);
    RHEO_EACH_VECTOR (n)
        rheo_lanes_store(x, rheo_walk_rows(walk, n), own[n].x);
}

/* What the health of a run is told by: how dense it is, and where. Four sums, so that none waits for the one before.
 */
static void note_densities(rheo_thickening *t, const rheo_pairs *pairs)
{
    enum { SUMS = 4 };
    double above[SUMS] = {0};
    rheo_real largest = 0;
    uint32_t densest = pairs->rows;
    for (uint32_t i = 0; i < pairs->rows; i++) {
        above[i % SUMS] += (double)rheo_max(t->density[i] - t->rest_density, 0);
        if (t->density[i] > largest) {
            largest = t->density[i];
            densest = i;
        }
    }
    double scale = t->rest_density > 0 ? 1 / (double)t->rest_density : 0;
    t->found.density_error = pairs->rows ? ((above[0] + above[1]) + (above[2] + above[3])) * scale / pairs->rows : 0;
    t->found.largest_density = (double)largest * scale;
    t->found.densest_particle = densest < pairs->rows ? (double)pairs->id_of[densest] : -1;
}

rheo_result RHEO_KERNEL(stage_density)(rheo_state *s, void *context)
{
    rheo_thickening *t = context;
    const rheo_pairs *pairs = rheo_step_pairs(s);
    size_t entries = ((size_t)t->list.longest_row + 1) * RHEO_VECTORS;
    if (!rheo_grow(&t->allocator, &t->round, &t->round_bytes, entries * sizeof(row_entry), 0, 1))
        return RHEO_ERROR_MEMORY;
    rheo_point *x = t->position;
    rheo_gather(x, s->position, pairs->id_of, pairs->rows);
    for (uint32_t group = 0; group < t->list.group_count; group++) {
        rheo_walk walk = rheo_walk_group(&t->list, group, pairs->rows);
        while (rheo_walk_on(&walk, t->list.row_start))
            relax_rows(t, &walk, pairs, x);
    }
    note_densities(t, pairs);
    t->found.pressure_push = rheo_scatter_moved(s->position, x, pairs->id_of, pairs->rows);
    return RHEO_OK;
}
