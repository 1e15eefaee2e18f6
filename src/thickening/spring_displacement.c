/*
 * Stage spring_displacement (Ozgen et al., Eq. 6; docs/model.md, 6): with K = k_min + k_hist |D^q x_i - D^q x_j| and
 * kappa = step^2 K, a spring moves its ends by
 *
 *     kappa (r - L) r_ij / 2        (explicit; implicit: kappa/(1 + kappa) in place of kappa)
 *
 * towards each other. Sequential: each spring sees the positions that the springs before it left. K does not depend
 * on that order, so it is computed first.
 */
#include "space/walk.h"
#include "thickening/thickening.h"

/* Remembers the spring of a row that has this kappa; if none has (they may all be soft, in rows before), any one. */
static void note_stiffest(rheo_thickening *t, const rheo_pairs *pairs, uint32_t row, rheo_real kappa)
{
    t->found.stiffness_number = 0;
    t->found.stiffest[0] = t->found.stiffest[1] = -1;
    if (rheo_pairs_count(pairs) == 0)
        return;
    while (pairs->start[row] == pairs->start[row + 1])
        row++;
    uint32_t k = pairs->start[row];
    while (k + 1 < pairs->start[row + 1] && t->kappa[k] != kappa)
        k++;
    uint32_t a = pairs->id_of[row], b = pairs->id_of[pairs->partner[k]];
    t->found.stiffness_number = (double)kappa;
    t->found.stiffest[0] = a < b ? a : b;
    t->found.stiffest[1] = a < b ? b : a;
}

/*
 * kappa of every spring, and for every particle the sum of k_hist |D^q| over its springs: those of its own row in
 * lanes, added as (0 + 1) + (2 + 3), after those of lower ranks. The last lanes of a row reach into the next row,
 * which then sets them right.
 */
static void spring_constants(rheo_state *s, rheo_thickening *t)
{
    const rheo_pairs *pairs = &s->springs.pairs;
    rheo_real step2 = t->step * t->step, k_min = t->spring_stiffness, k_hist = t->history_stiffness;
    rheo_point *d = t->velocity; /* free in this stage */
    rheo_real *sum = t->stiffness_sum;
    rheo_gather(d, t->derivative, pairs->id_of, pairs->rows);
    for (uint32_t i = 0; i < pairs->rows; i++)
        sum[i] = 0;
    rheo_real most = 0;
    uint32_t stiffest_row = 0;
    for (uint32_t i = 0; i < pairs->rows; i++) {
        rheo_lanes row_sum = {0}, largest = {0};
        const uint32_t end = pairs->start[i + 1];
        for (uint32_t k = pairs->start[i]; k < end; k += RHEO_LANES) {
            uint32_t partner[RHEO_LANES], left = end - k;
            for (uint32_t lane = 0; lane < RHEO_LANES; lane++)
                partner[lane] = lane < left ? pairs->partner[k + lane] : i; /* itself: no difference, no stiffness */
            rheo_lanes3 dj = rheo_lanes_load(d, partner);
            rheo_lanes x = d[i].x - dj.x, y = d[i].y - dj.y, z = d[i].z - dj.z;
            rheo_lanes stiffness = k_hist * rheo_lanes_sqrt(x * x + y * y + z * z);
            rheo_lanes kappa = step2 * (k_min + stiffness);
            memcpy(t->kappa + k, &kappa, sizeof kappa);
            largest = rheo_lanes_max(largest, stiffness);
            row_sum += stiffness;
            for (uint32_t lane = 0; lane < RHEO_LANES && lane < left; lane++)
                sum[partner[lane]] += stiffness[lane];
        }
        sum[i] += (row_sum[0] + row_sum[1]) + (row_sum[2] + row_sum[3]);
        rheo_real row_most = rheo_max(rheo_max(largest[0], largest[1]), rheo_max(largest[2], largest[3]));
        if (row_most > most) {
            most = row_most;
            stiffest_row = i;
        }
    }
    note_stiffest(t, pairs, stiffest_row, step2 * (k_min + most));
}

/* The largest sum of kappa over a particle's springs, and how much each particle holds to walls. */
static void particle_sums(rheo_state *s, rheo_thickening *t)
{
    const rheo_pairs *pairs = &s->springs.pairs;
    rheo_real step2 = t->step * t->step, k_min = t->spring_stiffness, largest = 0;
    t->found.stiffest_particle = -1;
    bool history = rheo_state_has(s, RHEO_FIELD_history_velocity);
    for (uint32_t i = 0; i < pairs->rows; i++) {
        uint32_t springs = t->list.row_start[i + 1] - t->list.row_start[i];
        rheo_real stiffness = history ? t->stiffness_sum[i] : 0;
        rheo_real kappa_sum = step2 * ((rheo_real)springs * k_min + stiffness);
        if (kappa_sum > largest) {
            largest = kappa_sum;
            t->found.stiffest_particle = pairs->id_of[i];
        }
        if (s->grip)
            s->grip[pairs->id_of[i]] = springs && k_min > 0 ? stiffness / ((rheo_real)springs * (10 * k_min)) : 0;
    }
    t->found.largest_stiffness_sum = (double)largest;
}

/* One spring in each lane; kappa is half of it, for each end. */
static inline void displace(rheo_lanes3 *xi, rheo_point *x, const uint32_t *partner, rheo_lanes half_kappa,
                            rheo_lanes rest_length, rheo_mask active)
{
    rheo_lanes3 xj = rheo_lanes_load(x, partner);
    rheo_lanes dx = xj.x - xi->x, dy = xj.y - xi->y, dz = xj.z - xi->z;
    rheo_lanes r2 = dx * dx + dy * dy + dz * dz;
    rheo_lanes r = rheo_lanes_sqrt(r2);
    /* Coinciding ends have no direction; the near pressure parts them. */
    rheo_lanes part = rheo_lanes_keep(r2 > 0, half_kappa * (r - rest_length) / r);
    dx *= part;
    dy *= part;
    dz *= part;
    xi->x = rheo_lanes_select(active, xi->x + dx, xi->x);
    xi->y = rheo_lanes_select(active, xi->y + dy, xi->y);
    xi->z = rheo_lanes_select(active, xi->z + dz, xi->z);
    rheo_lanes_store(x, partner, (rheo_lanes3){xj.x - dx, xj.y - dy, xj.z - dz});
}

/* kappa of every spring as the sweep needs it: half of it, explicit or implicit. */
static bool sweep_constants(rheo_state *s, rheo_thickening *t)
{
    size_t count = rheo_pairs_count(&s->springs.pairs);
    void *room = t->kappa;
    if (!rheo_grow(&t->allocator, &room, &t->kappa_capacity, count + RHEO_LANES, 0, sizeof *t->kappa))
        return false;
    t->kappa = room;
    rheo_real *kappa = t->kappa;
    if (rheo_state_has(s, RHEO_FIELD_history_velocity)) {
        spring_constants(s, t);
    } else {
        rheo_real constant = t->step * t->step * t->spring_stiffness;
        for (size_t k = 0; k < count; k++)
            kappa[k] = constant;
        note_stiffest(t, &s->springs.pairs, 0, constant);
    }
    if (t->solver == RHEO_SOLVER_IMPLICIT) {
        for (size_t k = 0; k < count; k++)
            kappa[k] = RHEO_R(0.5) * (kappa[k] / (1 + kappa[k]));
    } else {
        for (size_t k = 0; k < count; k++)
            kappa[k] *= RHEO_R(0.5);
    }
    return true;
}

rheo_result rheo_stage_spring_displacement(rheo_state *s, void *context)
{
    rheo_thickening *t = context;
    const rheo_springs *springs = &s->springs;
    const rheo_pairs *pairs = &springs->pairs;
    if (!sweep_constants(s, t))
        return RHEO_ERROR_MEMORY;
    particle_sums(s, t);

    rheo_point *x = t->position;
    rheo_gather(x, s->position, pairs->id_of, pairs->rows);
    for (int colour = 0; colour < RHEO_COLOURS; colour++) {
        rheo_walk walk = rheo_walk_colour(&t->list, colour, pairs->rows);
        while (rheo_walk_on(&walk, pairs->start)) {
            rheo_lanes3 xi = rheo_lanes_load(x, walk.row);
            for (uint32_t k = 0; k < walk.longest; k++) {
                uint32_t place[RHEO_LANES], partner[RHEO_LANES];
                rheo_walk_places(&walk, k, place);
                rheo_walk_partners(&walk, pairs->partner, k, place, partner);
                displace(&xi, x, partner, rheo_walk_values(t->kappa, place),
                         rheo_walk_values(springs->rest_length, place), rheo_walk_active(&walk, k));
            }
            rheo_lanes_store(x, walk.row, xi);
        }
    }
    rheo_scatter(s->position, x, pairs->id_of, pairs->rows);
    return RHEO_OK;
}
