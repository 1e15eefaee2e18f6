/*
 * Stage spring_displacement of scheme sequential (Ozgen et al., Eq. 6; docs/model.md): with n = |D^q x_i - D^q x_j|,
 * K = k_min + k_hist n^2/(n + n0) and kappa = step^2 K, a spring moves its ends by
 *
 *     kappa (r - L) r_ij / 2        (explicit; implicit: kappa/(1 + kappa) in place of kappa)
 *
 * towards each other. Sequential: each spring reads the positions written by the springs before it. K does not depend
 * on that order; it is computed in the same loop, which waits for square roots anyway.
 */
#include <assert.h>

#include "core/account_lanes.h"
#include "space/walk.h"
#include "thickening/thickening.h"

typedef struct constants {
    rheo_real step2, k_min, k_hist, onset;
} constants;

/* Arguments of a sweep over the springs; arrays are in rank order. */
typedef struct sweep {
    const rheo__state *state; /* for its account */
    const rheo__neighbours *list;
    const rheo__pairs *pairs;
    const rheo_real *rest_length;
    const rheo__point *derivative;
    rheo__point *position; /* w: sum of k_hist |D^q| over the springs of a particle */
    constants c;
    rheo_real most;        /* largest k_hist |D^q| */
    uint32_t stiffest_row; /* lowest row with it; the number of rows if it is 0 */
} sweep;

/* The rows of a round in one vector. */
typedef struct rows {
    rheo__lanes3 x, d;
    rheo__lanes sum, most; /* of k_hist |D^q|; the sum starts with the shares of lower rows */
} rows;

/*
 * One spring in each lane; `row` has the ranks of the rows, for the account. Coinciding ends have no direction; near
 * pressure separates them.
 */
static inline void displace(sweep *w, rows *own, const uint32_t *row, const rheo__walk_pairs *pairs, bool all,
                            bool history, bool implicit)
{
    rheo__lanes stiffness = {0};
    if (history) {
        rheo__lanes3 dj = rheo__lanes_load(w->derivative, pairs->partner);
        rheo__lanes x = own->d.x - dj.x, y = own->d.y - dj.y, z = own->d.z - dj.z;
        const rheo__lanes n = rheo__lanes_sqrt(x * x + y * y + z * z);
        stiffness = w->c.k_hist * rheo__lanes_keep(n > 0, n * (n / (n + w->c.onset)));
        if (!all)
            stiffness = rheo__lanes_keep(pairs->active, stiffness);
        own->sum += stiffness;
        own->most = rheo__lanes_max(stiffness, own->most);
    }
    rheo__lanes kappa = w->c.step2 * (w->c.k_min + stiffness);
    rheo__lanes half = RHEO__R(0.5) * (implicit ? kappa / (1 + kappa) : kappa);

    rheo__lanes sum;
    rheo__lanes3 xj = rheo__lanes_load_w(w->position, pairs->partner, &sum);
    rheo__lanes dx = xj.x - own->x.x, dy = xj.y - own->x.y, dz = xj.z - own->x.z;
    rheo__lanes r2 = dx * dx + dy * dy + dz * dz;
    rheo__lanes r = rheo__lanes_sqrt(r2);
    rheo__lanes rest_length = rheo__lanes_values(w->rest_length, pairs->place);
    rheo__lanes part = rheo__lanes_keep(r2 > 0, half * (r - rest_length) / r);
    rheo__lanes3 j_loses = {dx * part, dy * part, dz * part}, i_loses = {-j_loses.x, -j_loses.y, -j_loses.z};
    if (!all) {
        i_loses = rheo__lanes3_keep(pairs->active, i_loses);
        j_loses = rheo__lanes3_keep(pairs->active, j_loses);
    }
    rheo__keep_exchange(w->state, w->pairs, RHEO__FIELD_position, RHEO_SOURCE_SPRING, row[0], pairs->partner[0],
                        i_loses);
    own->x = rheo__lanes3_minus(own->x, i_loses);
    rheo__lanes_store_w(w->position, pairs->partner, rheo__lanes3_minus(xj, j_loses), sum + stiffness);
}

static inline void note_rows(sweep *w, const uint32_t *row, const rows *own)
{
    if (!rheo__lanes_any((own->most >= w->most) & (own->most > 0)))
        return;
    for (int lane = 0; lane < RHEO__LANES; lane++) {
        rheo_real most = RHEO__LANE(own->most, lane);
        if (most > w->most || (most == w->most && most > 0 && row[lane] < w->stiffest_row)) {
            w->most = most;
            w->stiffest_row = row[lane];
        }
    }
}

static inline void sweep_lines(sweep *w, bool history, bool implicit)
{
    for (uint32_t group = 0; group < w->list->group_count; group++) {
        rheo__walk walk = rheo__walk_group(w->list, group, w->pairs->rows);
        while (rheo__walk_on(&walk, w->pairs->start)) {
            rows own[RHEO__VECTORS] = {0};
            rheo__walk_prefetch(&walk, w->pairs->partner, sizeof *w->pairs->partner);
            rheo__walk_prefetch(&walk, w->rest_length, sizeof *w->rest_length);
            RHEO__EACH_VECTOR (n) {
                own[n].x = rheo__lanes_load_w(w->position, rheo__walk_rows(&walk, n), &own[n].sum);
                if (history)
                    own[n].d = rheo__lanes_load(w->derivative, rheo__walk_rows(&walk, n));
            }
            rheo__walk_pairs pairs;
            uint32_t k = 0;
            for (; k < walk.shortest; k++)
                RHEO__EACH_VECTOR (n) {
                    rheo__walk_take(&walk, n, k, w->pairs->partner, true, &pairs);
                    displace(w, &own[n], rheo__walk_rows(&walk, n), &pairs, true, history, implicit);
                }
            for (uint32_t longest = rheo__walk_longest(&walk); k < longest; k++)
                RHEO__EACH_VECTOR (n)
                    if (k < walk.longest[n]) {
                        rheo__walk_take(&walk, n, k, w->pairs->partner, false, &pairs);
                        displace(w, &own[n], rheo__walk_rows(&walk, n), &pairs, false, history, implicit);
                    }
            RHEO__EACH_VECTOR (n) {
                rheo__lanes_store_w(w->position, rheo__walk_rows(&walk, n), own[n].x, own[n].sum);
                if (history)
                    note_rows(w, rheo__walk_rows(&walk, n), &own[n]);
            }
        }
    }
}

/* One function for each case, so that the compiler specialises them. */
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

/* Notes the stiffest spring: the first of its row with the largest stiffness. */
static void note_stiffest(rheo__thickening *t, const sweep *w)
{
    const rheo__pairs *p = w->pairs;
    t->diagnostics.stiffness_number = 0;
    t->diagnostics.stiffest[0] = t->diagnostics.stiffest[1] = -1;
    if (rheo__pairs_count(p) == 0)
        return;
    uint32_t row = w->stiffest_row;
    if (row == p->rows) /* all have the same stiffness */
        for (row = 0; p->start[row] == p->start[row + 1];)
            row++;
    uint32_t k = p->start[row];
    if (w->most > 0)
        for (; k + 1 < p->start[row + 1]; k++) {
            const rheo__point *a = &w->derivative[row], *b = &w->derivative[rheo__pairs_partner(p, k)];
            const rheo_real n = rheo__sqrt(rheo__length2(a->x - b->x, a->y - b->y, a->z - b->z));
            if (w->c.k_hist * (n > 0 ? n * (n / (n + w->c.onset)) : 0) == w->most)
                break;
        }
    uint32_t a = p->id_of[row], b = p->id_of[rheo__pairs_partner(p, k)];
    t->diagnostics.stiffness_number = (double)(w->c.step2 * (w->c.k_min + w->most));
    t->diagnostics.stiffest[0] = a < b ? a : b;
    t->diagnostics.stiffest[1] = a < b ? b : a;
}

/* Largest sum of kappa over the springs of a particle, and the friction of each particle at walls. */
static void particle_sums(rheo__thickening *t, const sweep *w, bool history)
{
    rheo_real largest = 0;
    t->diagnostics.stiffest_particle = -1;
    for (uint32_t i = 0; i < w->pairs->rows; i++) {
        uint32_t springs = t->list.row_start[i + 1] - t->list.row_start[i];
        rheo_real stiffness = history ? w->position[i].w : 0;
        rheo_real kappa_sum = w->c.step2 * ((rheo_real)springs * w->c.k_min + stiffness);
        if (kappa_sum > largest) {
            largest = kappa_sum;
            t->diagnostics.stiffest_particle = w->pairs->id_of[i];
        }
        if (t->wall_friction)
            t->wall_friction[w->pairs->id_of[i]] =
                springs && w->c.k_min > 0 ? stiffness / ((rheo_real)springs * (10 * w->c.k_min)) : 0;
    }
    t->diagnostics.largest_stiffness_sum = (double)largest;
}

rheo_result RHEO__VARIANT(stage_spring_displacement)(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo__pairs *pairs = t->pairs;
    const rheo_world_def *def = t->def;
    const bool history = rheo__state_has(s, RHEO__FIELD_history_rows),
               implicit = def->springs.solver == RHEO_SOLVER_IMPLICIT;
    const rheo_real step = (rheo_real)def->step;
    sweep w = {.state = s,
               .list = &t->list,
               .pairs = pairs,
               .rest_length = s->springs.rest_length,
               .derivative = t->derivative,
               .position = t->position,
               .c = {step * step, (rheo_real)def->springs.stiffness, (rheo_real)def->history.stiffness,
                     (rheo_real)def->history.onset},
               .stiffest_row = pairs->rows};
    assert(pairs->rows == s->particles && pairs->rows < t->particle_capacity);
    rheo__gather(t->position, s->position, pairs->id_of, pairs->rows);
    if (history) {
        rheo__gather(t->derivative, s->derivative, pairs->id_of, pairs->rows);
        (implicit ? sweep_history_implicit : sweep_history_explicit)(&w);
    } else {
        (implicit ? sweep_implicit : sweep_explicit)(&w);
    }
    note_stiffest(t, &w);
    particle_sums(t, &w, history);
    t->diagnostics.max_spring_displacement = rheo__scatter_moved(s->position, t->position, pairs->id_of, pairs->rows);
    return RHEO_OK;
}
