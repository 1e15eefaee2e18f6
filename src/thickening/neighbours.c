/*
 * Stage neighbours of scheme summed (docs/model.md, 1): the pairs that may come within the support during the step.
 * They are found with margins, and kept for the next steps as long as no particle can have used up its own. What the
 * list depends on, the positions at which it was made and the margins, is state: a loaded world makes the same list
 * again, with the same order of all sums. The springs take over the layout of the list.
 */
#include <assert.h>
#include <string.h>

#include "thickening/thickening.h"

/*
 * Margins in supports. That of a particle is LIFE times its displacement in a step, at the speed when the list is made,
 * within bounds: below, a list would be short-lived in calm flow; above, it would cost more than it finds is worth.
 */
static const double LEAST_MARGIN = 0.05, MOST_MARGIN = 0.125, LIFE = 3;
/* Two particles that approach each other move as far as both, but rarely both straight on. */
static const double STRAIGHT = 0.75;

static void mean_of(const rheo_real *values, const rheo_real *less, uint32_t particles, rheo_real mean[3])
{
    double sum[3] = {0, 0, 0};
    for (uint32_t i = 0; i < particles; i++)
        for (size_t axis = 0; axis < 3; axis++)
            sum[axis] += (double)(values[3 * (size_t)i + axis] - (less ? less[3 * (size_t)i + axis] : 0));
    for (int axis = 0; axis < 3; axis++)
        mean[axis] = (rheo_real)(particles ? sum[axis] / particles : 0);
}

/* Quantities of a step that all particles need. Motion common to all of them brings no pair together. */
typedef struct motion {
    rheo_real velocity[3], displacement[3]; /* mean velocity, and mean displacement since the list was made */
    rheo_real fall, step, most;             /* g step, STRAIGHT step, and the most that a step may need */
    rheo_real ball2, near2; /* squared speed of the ball; particles within this squared distance may be hit by it */
} motion;

static motion find_motion(const rheo__state *s, const rheo_world_def *def)
{
    const double *g = def->gravity, h = def->fluid.support;
    motion m = {.fall = (rheo_real)(def->step * __builtin_sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2])),
                .step = (rheo_real)(STRAIGHT * def->step),
                .most = (rheo_real)(MOST_MARGIN * h)};
    mean_of(s->velocity, NULL, s->particles, m.velocity);
    mean_of(s->position, s->list_position, s->particles, m.displacement);
    if (s->bodies) {
        const rheo_real *v = s->ball_velocity;
        m.ball2 = rheo__length2(v[0] - m.velocity[0], v[1] - m.velocity[1], v[2] - m.velocity[2]);
        const rheo_real near = (rheo_real)(def->ball.radius + h) + (rheo_real)def->step * rheo__sqrt(m.ball2);
        m.near2 = near * near;
    }
    return m;
}

/* Margin that a particle needs for the coming step. */
static inline rheo_real margin_of_step(const rheo__state *s, const motion *m, uint32_t i)
{
    const rheo_real *v = s->velocity + 3 * (size_t)i;
    rheo_real speed2 = rheo__length2(v[0] - m->velocity[0], v[1] - m->velocity[1], v[2] - m->velocity[2]);
    if (s->bodies && m->ball2 > speed2) {
        const rheo_real *x = s->position + 3 * (size_t)i, *ball = s->ball_position;
        const rheo_real distance2 = rheo__length2(x[0] - ball[0], x[1] - ball[1], x[2] - ball[2]);
        speed2 = distance2 < m->near2 ? m->ball2 : speed2;
    }
    return rheo__min(m->step * (rheo__sqrt(speed2) + m->fall), m->most);
}

/* Whether no particle can use up its margin in the coming step. A margin of 0 asks for another list. */
static bool list_lasts(const rheo__state *s, const motion *m)
{
    for (uint32_t i = 0; i < s->particles; i++) {
        const rheo_real *x = s->position + 3 * (size_t)i, *from = s->list_position + 3 * (size_t)i;
        const rheo_real moved2 =
            rheo__length2(x[0] - from[0] - m->displacement[0], x[1] - from[1] - m->displacement[1],
                          x[2] - from[2] - m->displacement[2]);
        if (!(rheo__sqrt(moved2) + margin_of_step(s, m, i) < s->list_margin[i]))
            return false;
    }
    return true;
}

static void set_margins(rheo__state *s, const motion *m, const rheo_world_def *def)
{
    const rheo_real least = (rheo_real)(LEAST_MARGIN * def->fluid.support);
    for (uint32_t i = 0; i < s->particles; i++)
        s->list_margin[i] = rheo__min(rheo__max((rheo_real)LIFE * margin_of_step(s, m, i), least), m->most);
    memcpy(s->list_position, s->position, 3 * (size_t)s->particles * sizeof *s->position);
}

/*
 * Sets the rest lengths of the pairs in *now. The lengths of one old row at a time are spread over an array by old
 * rank, where the new row finds them.
 */
static void carry_over(rheo__thickening *t, const rheo__springs *old, rheo__springs *now)
{
    enum { WIDTH = RHEO__BLOCK_ROWS };
    const rheo__pairs *pairs = &now->pairs, *op = &old->pairs;
    const uint32_t none = UINT32_MAX;
    uint32_t *was = t->rank_before;
    rheo__carried *carried = t->carried;
    size_t ends = 0;
    for (uint32_t i = 0; i < pairs->rows; i++) {
        const uint32_t id = pairs->id_of[i];
        was[i] = id < op->rows ? op->rank_of[id] : none; /* a new particle had no springs */
        carried[i].row = none;
    }
    for (uint32_t i = 0; i < pairs->blocks * WIDTH; i++) {
        const uint32_t old_i = i < pairs->rows ? was[i] : none;
        if (old_i != none)
            for (size_t k = rheo__pairs_first(op, old_i), end = rheo__pairs_end(op, old_i); k < end; k += WIDTH)
                carried[op->partner[k]] = (rheo__carried){old->rest_length[k], i};
        for (size_t k = rheo__pairs_first(pairs, i), end = rheo__pairs_end(pairs, i); k < end; k += WIDTH) {
            const uint32_t j = pairs->partner[k];
            const bool had = j != i && was[j] != none && carried[was[j]].row == i;
            now->rest_length[k] = had ? carried[was[j]].rest_length : -1;
            ends += now->rest_length[k] >= 0;
        }
    }
    now->count = ends / 2; /* a spring whose ends have moved too far apart is lost */
}

/* Makes the list at s->list_position. */
static rheo_result make_list(rheo__state *s, rheo__thickening *t)
{
    const bool springs = rheo__state_has(s, RHEO__FIELD_spring_ends);
    t->list_made_for = 0;
    if (!rheo__neighbours_build_rows(&t->list, &t->found_pairs, &t->allocator, s->particles, s->list_position,
                                     t->def->fluid.support, s->list_margin) ||
        !rheo__neighbours_lay_out(&t->list, &t->found_pairs, &t->allocator))
        return RHEO_ERROR_MEMORY;
    const rheo__pairs *found = &t->found_pairs;
    const uint32_t *start = t->list.row_start;
    const size_t entries = rheo__pairs_entries(found);
    rheo__gather(t->position, s->position, found->id_of, s->particles);
    for (uint32_t i = 0; i < found->blocks * RHEO__BLOCK_ROWS; i++) {
        const uint32_t block = i / RHEO__BLOCK_ROWS, length = i < s->particles ? start[i + 1] - start[i] : 0;
        t->idle_entries[i] = (rheo_real)(found->start[block + 1] - found->start[block] - length);
        if (i >= s->particles)
            t->position[i] = t->velocity[i] = t->derivative[i] = t->derivative_before[i] = (rheo__point){0, 0, 0, 0};
    }
    t->pairs = found;
    t->diagnostics.mean_neighbours = s->particles ? (double)start[s->particles] / s->particles : 0;
    if (springs) {
        rheo__springs *now = &s->springs_next;
        void *stiffness = t->pair_stiffness;
        assert(s->springs_backup == RHEO__NO_BACKUP);
        if (!rheo__springs_reserve(now, &t->allocator, entries + 1) ||
            !rheo__grow(&t->allocator, &stiffness, &t->pair_capacity, entries + 1, 0, sizeof *t->pair_stiffness))
            return RHEO_ERROR_MEMORY;
        t->pair_stiffness = stiffness;
        const rheo__pairs swap = now->pairs;
        now->pairs = t->found_pairs;
        t->found_pairs = swap;
        carry_over(t, &s->springs, now);
        if (!rheo__springs_make_keys(now, &t->allocator))
            return RHEO_ERROR_MEMORY;
        rheo__state_exchange_springs(s);
        t->pairs = &s->springs.pairs;
    }
    t->list_made_for = s->rewritten + 1;
    return RHEO_OK;
}

rheo_result rheo__stage_neighbours(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const motion m = find_motion(s, t->def);
    const bool lasts = list_lasts(s, &m);
    if (!lasts)
        set_margins(s, &m, t->def);
    if (!lasts || t->list_made_for != s->rewritten + 1)
        return make_list(s, t);
    rheo__gather(t->position, s->position, t->pairs->id_of, s->particles);
    return !rheo__state_has(s, RHEO__FIELD_spring_ends) || rheo__state_keep_rest_lengths(s) ? RHEO_OK
                                                                                            : RHEO_ERROR_MEMORY;
}
