/*
 * Stage spring_displacement (Ozgen et al., Eq. 6; docs/model.md, 6): with K = k_min + k_hist |D^q x_i - D^q x_j| and
 * kappa = step^2 K, a spring moves its ends by
 *
 *     kappa (r - L) r_ij / 2        (explicit; implicit: kappa/(1 + kappa) in place of kappa)
 *
 * towards each other. Sequential: each spring sees the positions that the springs before it left. K does not depend on
 * that order, so it is computed first.
 */
#include "thickening/thickening.h"

/* kappa of every spring, and for every particle the sum of k_hist |D^q| over its springs. */
static void spring_constants(rheo_state *s, rheo_thickening *t)
{
    const rheo_pairs *pairs = &s->springs.pairs;
    rheo_real step2 = t->step * t->step, k_min = t->spring_stiffness, k_hist = t->history_stiffness;
    rheo_point *d = t->velocity; /* free in this stage */
    rheo_real *sum = t->stiffness_sum;
    rheo_gather(d, t->derivative, pairs->id_of, pairs->rows);
    for (uint32_t i = 0; i < pairs->rows; i++)
        sum[i] = 0;
    rheo_real largest = 0;
    for (uint32_t i = 0; i < pairs->rows; i++) {
        rheo_point di = d[i];
        rheo_real row_sum = sum[i];
        for (uint32_t k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
            uint32_t j = pairs->partner[k];
            rheo_real rate2 = rheo_length2(di.x - d[j].x, di.y - d[j].y, di.z - d[j].z);
            rheo_real stiffness = k_hist * rheo_sqrt(rate2);
            t->kappa[k] = step2 * (k_min + stiffness);
            largest = rheo_max(largest, stiffness);
            row_sum += stiffness;
            sum[j] += stiffness;
        }
        sum[i] = row_sum;
    }
    t->stiffness_number = rheo_pairs_count(pairs) ? (double)(step2 * (k_min + largest)) : 0;
}

/* The largest sum of kappa over a particle's springs, and how much each particle holds to walls. */
static void particle_sums(rheo_state *s, rheo_thickening *t)
{
    const rheo_pairs *pairs = &s->springs.pairs;
    rheo_real step2 = t->step * t->step, k_min = t->spring_stiffness, largest = 0;
    bool history = rheo_state_has(s, RHEO_FIELD_history_velocity);
    for (uint32_t i = 0; i < pairs->rows; i++) {
        uint32_t springs = pairs->start[i + 1] - pairs->start[i] + t->list.lower_start[i + 1] - t->list.lower_start[i];
        rheo_real stiffness = history ? t->stiffness_sum[i] : 0;
        largest = rheo_max(largest, step2 * ((rheo_real)springs * k_min + stiffness));
        if (s->grip)
            s->grip[pairs->id_of[i]] = springs ? stiffness / ((rheo_real)springs * (10 * k_min)) : 0;
    }
    t->largest_stiffness_sum = (double)largest;
}

rheo_result rheo_stage_spring_displacement(rheo_state *s, void *context)
{
    rheo_thickening *t = context;
    const rheo_springs *springs = &s->springs;
    const rheo_pairs *pairs = &springs->pairs;
    size_t count = rheo_pairs_count(pairs);
    void *room = t->kappa;
    if (!rheo_grow(&t->allocator, &room, &t->kappa_capacity, count + 1, 0, sizeof *t->kappa))
        return RHEO_ERROR_MEMORY;
    t->kappa = room;
    rheo_real *kappa = t->kappa;
    if (rheo_state_has(s, RHEO_FIELD_history_velocity)) {
        spring_constants(s, t);
    } else {
        rheo_real constant = t->step * t->step * t->spring_stiffness;
        for (size_t k = 0; k < count; k++)
            kappa[k] = constant;
        t->stiffness_number = count ? (double)constant : 0;
    }
    particle_sums(s, t);
    /* Half to each end, so the factor of a spring is kappa/2. */
    if (t->solver == RHEO_SOLVER_IMPLICIT) {
        for (size_t k = 0; k < count; k++)
            kappa[k] = RHEO_R(0.5) * (kappa[k] / (1 + kappa[k]));
    } else {
        for (size_t k = 0; k < count; k++)
            kappa[k] *= RHEO_R(0.5);
    }

    rheo_point *x = t->position;
    rheo_gather(x, s->position, pairs->id_of, pairs->rows);
    for (uint32_t l = 0; l < t->list.line_count; l++)
        for (uint32_t i = t->list.line[l].first; i < t->list.line[l].end; i++) {
            rheo_point xi = x[i];
            for (uint32_t k = pairs->start[i]; k < pairs->start[i + 1]; k++) {
                uint32_t j = pairs->partner[k];
                rheo_real dx = x[j].x - xi.x, dy = x[j].y - xi.y, dz = x[j].z - xi.z;
                rheo_real r2 = rheo_length2(dx, dy, dz);
                rheo_real r = rheo_sqrt(r2);
                /* Coinciding ends have no direction; the near pressure parts them. */
                rheo_real part = r2 > 0 ? kappa[k] * (r - springs->rest_length[k]) / r : 0;
                dx *= part;
                dy *= part;
                dz *= part;
                xi.x += dx;
                xi.y += dy;
                xi.z += dz;
                x[j].x -= dx;
                x[j].y -= dy;
                x[j].z -= dz;
            }
            x[i] = xi;
        }
    rheo_scatter(s->position, x, pairs->id_of, pairs->rows);
    return RHEO_OK;
}
