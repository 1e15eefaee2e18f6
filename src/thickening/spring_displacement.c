/*
 * Stage spring_displacement (Ozgen et al., Eq. 6; docs/model.md, 6): with K = k_min + k_hist |D^q x_i - D^q x_j| and
 * kappa = step^2 K, a spring moves its ends by
 *
 *     kappa (r - L) r_ij / 2        (explicit; implicit: kappa/(1 + kappa) in place of kappa)
 *
 * towards each other. Sequential: each spring sees the positions that the springs before it left. K does not depend
 * on that order; it is computed on the way, where waiting for square roots leaves time for it.
 */
#include "space/walk.h"
#include "thickening/kernels.h"

typedef struct constants {
    rheo_real step2, k_min, k_hist;
} constants;

/* What a sweep works on, all in rank order. */
typedef struct sweep {
    const rheo_neighbours *list;
    const rheo_pairs *pairs;
    const rheo_real *rest_length;
    const rheo_point *derivative;
    rheo_point *position; /* w: sum over a particle's springs of k_hist |D^q| */
    constants c;
    rheo_real most;        /* the largest k_hist |D^q|, */
    uint32_t stiffest_row; /* and the lowest row that has it; no particle's rank if none is above 0 */
} sweep;

/* The rows of a round in one vector. */
typedef struct rows {
    rheo_lanes3 x, d;
    rheo_lanes sum, most; /* of k_hist |D^q|; the sum begins with what lower rows gave */
} rows;

/* One spring in each lane. Coinciding ends have no direction; the near pressure parts them. */
static inline void displace(sweep *w, rows *own, const rheo_walk_pairs *pairs, bool all, bool history, bool implicit)
{
    rheo_lanes stiffness = {0};
    if (history) {
        rheo_lanes3 dj = rheo_lanes_load(w->derivative, pairs->partner);
        rheo_lanes x = own->d.x - dj.x, y = own->d.y - dj.y, z = own->d.z - dj.z;
        stiffness = w->c.k_hist * rheo_lanes_sqrt(x * x + y * y + z * z);
        if (!all)
            stiffness = rheo_lanes_keep(pairs->active, stiffness);
        own->sum += stiffness;
        own->most = rheo_lanes_max(stiffness, own->most);
    }
    rheo_lanes kappa = w->c.step2 * (w->c.k_min + stiffness);
    rheo_lanes half = RHEO_R(0.5) * (implicit ? kappa / (1 + kappa) : kappa);

    rheo_lanes sum;
    rheo_lanes3 xj = rheo_lanes_load_w(w->position, pairs->partner, &sum);
    rheo_lanes dx = xj.x - own->x.x, dy = xj.y - own->x.y, dz = xj.z - own->x.z;
    rheo_lanes r2 = dx * dx + dy * dy + dz * dz;
    rheo_lanes r = rheo_lanes_sqrt(r2);
    rheo_lanes rest_length = rheo_lanes_values(w->rest_length, pairs->place);
    rheo_lanes part = rheo_lanes_keep(r2 > 0, half * (r - rest_length) / r);
    rheo_lanes3 j_loses = {dx * part, dy * part, dz * part}, i_loses = {-j_loses.x, -j_loses.y, -j_loses.z};
    if (!all) {
        i_loses = rheo_lanes3_keep(pairs->active, i_loses);
        j_loses = rheo_lanes3_keep(pairs->active, j_loses);
    }
    own->x = rheo_lanes3_minus(own->x, i_loses);
    rheo_lanes_store_w(w->position, pairs->partner, rheo_lanes3_minus(xj, j_loses), sum + stiffness);
}

static inline void note_rows(sweep *w, const uint32_t *row, const rows *own)
{
    if (!rheo_lanes_any((own->most >= w->most) & (own->most > 0)))
        return;
    for (int lane = 0; lane < RHEO_LANES; lane++) {
        rheo_real most = RHEO_LANE(own->most, lane);
        if (most > w->most || (most == w->most && most > 0 && row[lane] < w->stiffest_row)) {
            w->most = most;
            w->stiffest_row = row[lane];
        }
    }
}

static inline void sweep_lines(sweep *w, bool history, bool implicit)
{
    for (uint32_t group = 0; group < w->list->group_count; group++) {
        rheo_walk walk = rheo_walk_group(w->list, group, w->pairs->rows);
        while (rheo_walk_on(&walk, w->pairs->start)) {
            rows own[RHEO_VECTORS] = {0};
            rheo_walk_prefetch(&walk, w->pairs->partner, sizeof *w->pairs->partner);
            rheo_walk_prefetch(&walk, w->rest_length, sizeof *w->rest_length);
            RHEO_EACH_VECTOR (n) {
                own[n].x = rheo_lanes_load_w(w->position, rheo_walk_rows(&walk, n), &own[n].sum);
                if (history)
                    own[n].d = rheo_lanes_load(w->derivative, rheo_walk_rows(&walk, n));
            }
            rheo_walk_pairs pairs;
            uint32_t k = 0;
            for (; k < walk.shortest; k++)
                RHEO_EACH_VECTOR (n) {
                    rheo_walk_take(&walk, n, k, w->pairs->partner, true, &pairs);
                    displace(w, &own[n], &pairs, true, history, implicit);
                }
            for (uint32_t longest = rheo_walk_longest(&walk); k < longest; k++)
                RHEO_EACH_VECTOR (n)
                    if (k < walk.longest[n]) {
                        rheo_walk_take(&walk, n, k, w->pairs->partner, false, &pairs);
                        displace(w, &own[n], &pairs, false, history, implicit);
                    }
            RHEO_EACH_VECTOR (n) {
                rheo_lanes_store_w(w->position, rheo_walk_rows(&walk, n), own[n].x, own[n].sum);
                if (history)
                    note_rows(w, rheo_walk_rows(&walk, n), &own[n]);
            }
        }
    }
}

/* One function for each case, so that each is compiled for its own. */
static void sweep_history_explicit(sweep *w)
{
    sweep_lines(w, true, false);
}
static void sweep_history_implicit(sweep *w)
{
    sweep_lines(w, true, true);
}
static void sweep_explicit(sweep *w)
{
    sweep_lines(w, false, false);
}
static void sweep_implicit(sweep *w)
{
    sweep_lines(w, false, true);
}

/* Remembers the stiffest spring: the first of its row that has the largest stiffness. */
static void note_stiffest(rheo_thickening *t, const sweep *w)
{
    const rheo_pairs *p = w->pairs;
    t->found.stiffness_number = 0;
    t->found.stiffest[0] = t->found.stiffest[1] = -1;
    if (rheo_pairs_count(p) == 0)
        return;
    uint32_t row = w->stiffest_row;
    if (row == p->rows) /* all alike */
        for (row = 0; p->start[row] == p->start[row + 1];)
            row++;
    uint32_t k = p->start[row];
    if (w->most > 0)
        for (; k + 1 < p->start[row + 1]; k++) {
            const rheo_point *a = &w->derivative[row], *b = &w->derivative[p->partner[k]];
            if (w->c.k_hist * rheo_sqrt(rheo_length2(a->x - b->x, a->y - b->y, a->z - b->z)) == w->most)
                break;
        }
    uint32_t a = p->id_of[row], b = p->id_of[p->partner[k]];
    t->found.stiffness_number = (double)(w->c.step2 * (w->c.k_min + w->most));
    t->found.stiffest[0] = a < b ? a : b;
    t->found.stiffest[1] = a < b ? b : a;
}

/* The largest sum of kappa over a particle's springs, and how much each particle holds to walls. */
static void particle_sums(rheo_state *s, rheo_thickening *t, const sweep *w, bool history)
{
    rheo_real largest = 0;
    t->found.stiffest_particle = -1;
    for (uint32_t i = 0; i < w->pairs->rows; i++) {
        uint32_t springs = t->list.row_start[i + 1] - t->list.row_start[i];
        rheo_real stiffness = history ? w->position[i].w : 0;
        rheo_real kappa_sum = w->c.step2 * ((rheo_real)springs * w->c.k_min + stiffness);
        if (kappa_sum > largest) {
            largest = kappa_sum;
            t->found.stiffest_particle = w->pairs->id_of[i];
        }
        if (s->grip)
            s->grip[w->pairs->id_of[i]] =
                springs && w->c.k_min > 0 ? stiffness / ((rheo_real)springs * (10 * w->c.k_min)) : 0;
    }
    t->found.largest_stiffness_sum = (double)largest;
}

rheo_result RHEO_KERNEL(stage_spring_displacement)(rheo_state *s, void *context)
{
    rheo_thickening *t = context;
    const rheo_pairs *pairs = &s->springs.pairs;
    bool history = rheo_state_has(s, RHEO_FIELD_history_rows), implicit = t->solver == RHEO_SOLVER_IMPLICIT;
    sweep w = {.list = &t->list,
               .pairs = pairs,
               .rest_length = s->springs.rest_length,
               .derivative = t->velocity, /* free in this stage */
               .position = t->position,
               .c = {t->step * t->step, t->spring_stiffness, t->history_stiffness},
               .stiffest_row = pairs->rows};
    rheo_gather(t->position, s->position, pairs->id_of, pairs->rows);
    if (history) {
        rheo_gather(t->velocity, t->derivative, pairs->id_of, pairs->rows);
        (implicit ? sweep_history_implicit : sweep_history_explicit)(&w);
    } else {
        (implicit ? sweep_implicit : sweep_explicit)(&w);
    }
    note_stiffest(t, &w);
    particle_sums(s, t, &w, history);
    t->found.spring_push = rheo_scatter_moved(s->position, t->position, pairs->id_of, pairs->rows);
    return RHEO_OK;
}
