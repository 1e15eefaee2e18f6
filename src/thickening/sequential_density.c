/*
 * Stage density of scheme sequential (double density relaxation of Clavet et al.; docs/model.md): particle by particle,
 * with w = 1 - r/h,
 *
 *     rho = sum w^2,  rho_near = sum w^3,  P = k (rho - rho0),  P_near = k_near rho_near
 *     D = step^2 (P w + P_near w^2) r_ij;   x_j += D/2;   x_i -= sum D/2
 *
 * Sequential: a particle reads the positions written by the particles before it; its own position is fixed within its
 * row. Pairs are those of the predicted positions; neighbours that have left the support since have w = 0.
 */
#include <assert.h>

#include "core/account_lanes.h"
#include "space/walk.h"
#include "thickening/densities.h"

/* A neighbour in each lane of the rows of a round. */
typedef struct row_entry {
    rheo__lanes3 to; /* unit vector to the neighbour */
    rheo__lanes w;   /* weight, 0 outside the support */
    rheo__mask active;
    uint32_t partner[RHEO__LANES];
} row_entry;

typedef struct constants {
    rheo_real inverse_support, half_step2, stiffness, near_stiffness, rest_density;
} constants;

/* The rows of a round in one vector. */
typedef struct rows {
    rheo__lanes3 x;
    rheo__lanes density, near_density;
    rheo__mask coinciding;
} rows;

static inline void weigh(rows *own, row_entry *entry, const rheo__walk_pairs *pairs, bool all, const rheo__point *x,
                         rheo_real inverse_support)
{
    rheo__lanes3 xj = rheo__lanes_load(x, pairs->partner);
    rheo__lanes dx = xj.x - own->x.x, dy = xj.y - own->x.y, dz = xj.z - own->x.z;
    rheo__lanes r2 = dx * dx + dy * dy + dz * dz;
    rheo__lanes r = rheo__lanes_sqrt(r2);
    rheo__lanes w = 1 - r * inverse_support;
    rheo__mask coinciding = r2 == 0;
    w = rheo__lanes_keep(w > 0, w);
    if (!all) {
        w = rheo__lanes_keep(pairs->active, w);
        coinciding &= pairs->active;
        entry->active = pairs->active;
    }
    rheo__lanes inverse = 1 / r;
    entry->to = (rheo__lanes3){dx * inverse, dy * inverse, dz * inverse};
    entry->w = w;
    memcpy(entry->partner, pairs->partner, sizeof entry->partner);
    own->density += w * w;
    own->near_density += w * w * w;
    own->coinciding |= coinciding;
}

/* Notes what rank i loses to its partner. Only coinciding pairs have the direction of part(). */
static void keep_move(const rheo__state *s, const rheo__pairs *pairs, uint32_t i, const row_entry *entry,
                      rheo__lanes3 loses)
{
    const uint32_t j = entry->partner[0];
    if (!rheo__keeps_account(s, pairs, i) && !rheo__keeps_account(s, pairs, j))
        return;
    rheo_real direction[3];
    rheo__part_direction(pairs->id_of[i], pairs->id_of[j], direction);
    const bool parted = RHEO__LANE(entry->to.x, 0) == direction[0] && RHEO__LANE(entry->to.y, 0) == direction[1] &&
                        RHEO__LANE(entry->to.z, 0) == direction[2];
    rheo__keep_exchange(s, pairs, RHEO__FIELD_position, parted ? RHEO_SOURCE_PARTING : RHEO_SOURCE_PRESSURE, i, j,
                        loses);
}

/* `i` has the ranks of the rows, for the account. */
static inline void move(const rheo__state *s, const rheo__thickening *t, const uint32_t *i, rows *own, rheo__point *x,
                        const row_entry *entry, bool all, rheo__lanes pressure, rheo__lanes near_pressure)
{
    rheo__lanes3 xj = rheo__lanes_load(x, entry->partner);
    rheo__lanes by = entry->w * (pressure + near_pressure * entry->w);
    rheo__lanes3 i_loses = {by * entry->to.x, by * entry->to.y, by * entry->to.z},
                 j_loses = {-i_loses.x, -i_loses.y, -i_loses.z};
    if (!all) {
        i_loses = rheo__lanes3_keep(entry->active, i_loses);
        j_loses = rheo__lanes3_keep(entry->active, j_loses);
    }
    if (rheo__keeps_any(s))
        keep_move(s, t->pairs, i[0], entry, i_loses);
    own->x = rheo__lanes3_minus(own->x, i_loses);
    rheo__lanes_store(x, entry->partner, rheo__lanes3_minus(xj, j_loses));
}

/* Sets the directions of coinciding pairs in the rows of one vector. */
static void part(const rheo__walk *walk, int vector, const rheo__pairs *pairs, const rheo__point *x, row_entry *entry)
{
    for (int lane = 0; lane < RHEO__LANES; lane++)
        for (uint32_t k = 0; k < (uint32_t)walk->length[vector * RHEO__LANES + lane]; k++) {
            row_entry *e = &entry[k * RHEO__VECTORS + (uint32_t)vector];
            uint32_t i = rheo__walk_rows(walk, vector)[lane], j = e->partner[lane];
            if (rheo__length2(x[j].x - x[i].x, x[j].y - x[i].y, x[j].z - x[i].z) != 0)
                continue;
            rheo_real direction[3];
            rheo__part_direction(pairs->id_of[i], pairs->id_of[j], direction);
            RHEO__LANE(e->to.x, lane) = direction[0];
            RHEO__LANE(e->to.y, lane) = direction[1];
            RHEO__LANE(e->to.z, lane) = direction[2];
        }
}

static void relax_rows(const rheo__state *s, const rheo__thickening *t, const rheo__walk *walk, constants c,
                       rheo__point *x)
{
    row_entry *entry = t->round;
    rows own[RHEO__VECTORS] = {0};
    rheo__walk_prefetch(walk, t->list.row, sizeof *t->list.row);
    RHEO__EACH_VECTOR (n)
        own[n].x = rheo__lanes_load(x, rheo__walk_rows(walk, n));
    rheo__walk_pairs taken;
    uint32_t k = 0;
    for (; k < walk->shortest; k++)
        RHEO__EACH_VECTOR (n) {
            rheo__walk_take(walk, n, k, t->list.row, true, &taken);
            weigh(&own[n], &entry[k * RHEO__VECTORS + (uint32_t)n], &taken, true, x, c.inverse_support);
        }
    for (uint32_t longest = rheo__walk_longest(walk); k < longest; k++)
        RHEO__EACH_VECTOR (n)
            if (k < walk->longest[n]) {
                rheo__walk_take(walk, n, k, t->list.row, false, &taken);
                weigh(&own[n], &entry[k * RHEO__VECTORS + (uint32_t)n], &taken, false, x, c.inverse_support);
            }

    rheo__lanes pressure[RHEO__VECTORS], near_pressure[RHEO__VECTORS];
    RHEO__EACH_VECTOR (n) {
        if (rheo__lanes_any(own[n].coinciding))
            part(walk, n, t->pairs, x, entry);
        pressure[n] = c.half_step2 * (c.stiffness * (own[n].density - c.rest_density));
        near_pressure[n] = c.half_step2 * (c.near_stiffness * own[n].near_density);
        for (int lane = 0; lane < RHEO__LANES; lane++)
            t->density[rheo__walk_rows(walk, n)[lane]] = RHEO__LANE(own[n].density, lane);
    }
    for (k = 0; k < walk->shortest; k++)
        RHEO__EACH_VECTOR (n)
            move(s, t, rheo__walk_rows(walk, n), &own[n], x, &entry[k * RHEO__VECTORS + (uint32_t)n], true,
                 pressure[n], near_pressure[n]);
    for (uint32_t longest = rheo__walk_longest(walk); k < longest; k++)
        RHEO__EACH_VECTOR (n)
            if (k < walk->longest[n])
                move(s, t, rheo__walk_rows(walk, n), &own[n], x, &entry[k * RHEO__VECTORS + (uint32_t)n], false,
                     pressure[n], near_pressure[n]);
    RHEO__EACH_VECTOR (n)
        rheo__lanes_store(x, rheo__walk_rows(walk, n), own[n].x);
}

rheo_result RHEO__VARIANT(stage_density)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo__pairs *pairs = t->pairs;
    const rheo_world_def *def = t->def;
    const rheo_real step = (rheo_real)def->step;
    const constants c = {.inverse_support = (rheo_real)(1 / def->fluid.support),
                         .half_step2 = RHEO__R(0.5) * (step * step),
                         .stiffness = (rheo_real)def->fluid.stiffness,
                         .near_stiffness = (rheo_real)def->fluid.near_stiffness,
                         .rest_density = (rheo_real)def->fluid.rest_density};
    size_t entries = ((size_t)t->list.longest_row + 1) * RHEO__VECTORS;
    if (!rheo__grow(&t->allocator, &t->round, &t->round_bytes, entries * sizeof(row_entry), 0, 1))
        return RHEO_ERROR_MEMORY;
    rheo__point *x = t->position;
    assert(pairs->rows == s->particles && pairs->rows < t->particle_capacity);
    rheo__gather(x, s->position, pairs->id_of, pairs->rows);
    for (uint32_t group = 0; group < t->list.group_count; group++) {
        rheo__walk walk = rheo__walk_group(&t->list, group, pairs->rows);
        while (rheo__walk_on(&walk, t->list.row_start))
            relax_rows(s, t, &walk, c, x);
    }
    rheo__note_densities(t);
    t->diagnostics.max_pressure_displacement = rheo__scatter_moved(s->position, x, pairs->id_of, pairs->rows);
    return RHEO_OK;
}
