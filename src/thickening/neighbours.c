/*
 * Stage neighbours of the schemes summed and positions (docs/model.md, 1): the pairs that may come within the support during the step.
 * They are found with margins, and kept for the next steps as long as no particle can have used up its own. What the
 * list depends on, the positions at which it was made and the margins, is state: a loaded world makes the same list
 * again, with the same order of all sums. The springs take over the layout of the list.
 */
#include <assert.h>
#include <string.h>

#include "core/account.h"
#include "thickening/margins.h"
#include "thickening/thickening.h"

/*
 * Margins in supports. Slow particles may be pushed, and vibrators hit them at once. Wide margins make cells wide, and
 * all particles test more candidates.
 */
static const double LEAST_MARGIN = 0.025, LEAST_WITH_VIBRATORS = 0.04;
/*
 * Needs of a step that margins hold, at most. With fewer than SHORTEST a list would not last for a second step; then
 * margins hold SINGLE, since a push may come in the step.
 */
static const double LIFE = 8, SHORTEST = 3, SINGLE = 2;
/* Two particles that approach each other move as far as both, but rarely both straight on. */
static const double STRAIGHT = 0.75;
enum {
    SAMPLES = 1024
}; /* particles whose mean stands for that of all; any value is right, a common one saves most */

static void mean_of(const rheo_real *values, const rheo_real *less, uint32_t particles, rheo_real mean[3])
{
    double sum[3] = {0, 0, 0};
    uint32_t count = 0;
    for (uint32_t i = 0; i < particles; i += 1 + particles / SAMPLES, count++)
        for (size_t axis = 0; axis < 3; axis++)
            sum[axis] += (double)(values[3 * (size_t)i + axis] - (less ? less[3 * (size_t)i + axis] : 0));
    for (int axis = 0; axis < 3; axis++)
        mean[axis] = (rheo_real)(count ? sum[axis] / count : 0);
}

static rheo__motion find_motion(const rheo__state *s, const rheo__thickening *t)
{
    const rheo_world_def *def = t->def;
    const double *g = def->gravity, h = def->fluid.support;
    rheo__motion m = {.fall = (rheo_real)(def->step * __builtin_sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2])),
                      .step = (rheo_real)(STRAIGHT * def->step),
                      .most = (rheo_real)(RHEO__MOST_MARGIN * h),
                      .balls = s->bodies};
    mean_of(s->velocity, NULL, s->particles, m.velocity);
    mean_of(s->position, s->list_position, s->particles, m.displacement);
    if (s->obstacles) /* any particle may be pushed by one */
        m.fall += (rheo_real)t->obstacle_speed;
    for (uint32_t i = 0; i < s->bodies; i++) {
        const rheo_real *v = s->ball_velocity + 3 * (size_t)i;
        m.ball2[i] = rheo__length2(v[0] - m.velocity[0], v[1] - m.velocity[1], v[2] - m.velocity[2]);
        const rheo_real near =
            (rheo_real)(rheo__ball_of(def, i)->radius + h) + (rheo_real)def->step * rheo__sqrt(m.ball2[i]);
        m.near2[i] = near * near;
        memcpy(m.ball[i], s->ball_position + 3 * (size_t)i, sizeof m.ball[i]);
    }
    return m;
}

/*
 * A list lasts until the first particle has used up its margin. So all margins hold the same number of steps, as many
 * as the widest margin gives to the particle that needs most; if these are too few, only the coming step.
 */
static void set_margins(rheo__state *s, const rheo__motion *m, const rheo_world_def *def)
{
    const rheo_real least = (rheo_real)((s->vibrators ? LEAST_WITH_VIBRATORS : LEAST_MARGIN) * def->fluid.support);
    static rheo__needs_of_step_function *const needs_of_step[] = RHEO__ALL_VARIANTS(needs_of_step);
    rheo__state_renew(s, RHEO__FIELD_list_position);
    rheo__state_renew(s, RHEO__FIELD_list_margin);
    const rheo_real largest = needs_of_step[rheo__simd_in_use()](s, m);
    rheo_real life = (rheo_real)LIFE;
    if (largest * life > m->most)
        life = largest * (rheo_real)SHORTEST > m->most ? (rheo_real)SINGLE : m->most / largest;
    for (uint32_t i = 0; i < s->particles; i++)
        s->list_margin[i] = rheo__min(rheo__max(life * s->list_margin[i], least), m->most);
    memcpy(s->list_position, s->position, 3 * (size_t)s->particles * sizeof *s->position);
}

/* Sets what stages read of idle rows and of the partner of idle entries. */
static void set_idle(rheo__thickening *t)
{
    for (uint32_t i = t->pairs->rows; i <= rheo__pairs_idle(t->pairs); i++) {
        t->spring_acceleration[i] = (rheo__point){0, 0, 0, 0};
        t->point[i] = (rheo__wide_point){{0, 0, 0, 0}, {0, 0, 0, 0}};
        t->density[i] = 0;
        if (t->derivative)
            t->derivative[i] = (rheo__point){0, 0, 0, 0};
        if (t->stiffness_sum)
            t->stiffness_sum[i] = 0;
    }
    t->point[rheo__pairs_idle(t->pairs)].at = RHEO__NOWHERE;
}

/*
 * Rows are used only while a list is made, and the stiffness of its pairs only after that. Both have a value of a pair,
 * so they share memory.
 */
static void lend_stiffness_to_rows(rheo__thickening *t)
{
    if (!t->pair_stiffness)
        return;
    rheo__release(&t->allocator, t->list.row);
    t->list.row = (void *)t->pair_stiffness;
    t->list.row_capacity = t->pair_capacity * (sizeof *t->pair_stiffness / sizeof *t->list.row);
    t->pair_stiffness = NULL;
    t->pair_capacity = 0;
}
static bool give_rows_to_stiffness(rheo__thickening *t, size_t pairs)
{
    void *stiffness = t->list.row;
    t->pair_capacity = t->list.row_capacity / (sizeof *t->pair_stiffness / sizeof *t->list.row);
    t->list.row = NULL;
    t->list.row_capacity = 0;
    const bool grown = rheo__grow(&t->allocator, &stiffness, &t->pair_capacity, pairs, 0, sizeof *t->pair_stiffness);
    t->pair_stiffness = stiffness;
    return grown;
}

/* Makes the list at s->list_position: the next springs, or without springs t->found_pairs. */
static rheo_result make_list(rheo__state *s, rheo__thickening *t)
{
    const bool springs = rheo__state_has(s, RHEO__FIELD_spring_ends);
    rheo__springs *now = &s->springs_next;
    rheo__pairs *pairs = springs ? &now->pairs : &t->found_pairs;
    assert(s->springs_backup == RHEO__NO_BACKUP);
    t->list_made_for = 0;
    lend_stiffness_to_rows(t);
    if (!rheo__neighbours_build_rows(&t->list, pairs, &t->allocator, s->particles, s->list_position,
                                     t->def->fluid.support, s->list_margin, t->period->axes ? t->period : NULL) ||
        !rheo__neighbours_lay_out(&t->list, pairs, &t->allocator))
        return RHEO_ERROR_MEMORY;
    if (springs) {
        const size_t room = rheo__pairs_entries(pairs) + 1;
        if (!rheo__springs_reserve(now, &t->allocator, room))
            return RHEO_ERROR_MEMORY;
        rheo__pairs_forget_images(&s->springs.pairs);
        rheo__neighbours_write_springs(&t->list, now, &s->springs, t->place, t->carried);
        if (!give_rows_to_stiffness(t, room))
            return RHEO_ERROR_MEMORY;
        if (now->count == s->springs.count)
            s->unchanged |= RHEO__BIT(spring_ends);
        if (!rheo__springs_make_keys(now, &t->allocator))
            return RHEO_ERROR_MEMORY;
        rheo__state_exchange_springs(s);
        pairs = &s->springs.pairs;
    } else {
        rheo__neighbours_write_rows(&t->list, pairs);
    }
    t->pairs = pairs;
    set_idle(t);
    t->diagnostics.mean_neighbours = s->particles ? (double)t->list.row_start[s->particles] / s->particles : 0;
    t->list_made_for = s->rewritten + 1;
    return RHEO_OK;
}

/* Whether the particles have moved so far together that their coordinates must be put into range again. */
static bool have_drifted(const rheo__thickening *t, const rheo__motion *m)
{
    bool drifted = false;
    for (int axis = 0; axis < 3; axis++) {
        const rheo_real length = t->period->length[axis], moved = m->displacement[axis];
        drifted = drifted || (length > 0 && !(moved < length / 4 && moved > -length / 4));
    }
    return drifted;
}

/* Puts the coordinates into the range about the origin. */
static void wrap(rheo__state *s, const rheo__period *period)
{
    const rheo_real *x = rheo__has_account(s) ? s->position + 3 * (size_t)s->account->id : NULL;
    rheo_real before[3];
    if (x)
        memcpy(before, x, sizeof before);
    rheo__period_wrap(period, s->position, s->particles);
    if (x && memcmp(before, x, sizeof before) != 0)
        rheo__account_set(s, RHEO__FIELD_position, RHEO_SOURCE_PERIOD, 0, x[0], x[1], x[2]);
}

rheo_result rheo__stage_neighbours(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo__motion m = find_motion(s, t);
    static rheo__list_lasts_function *const list_lasts[] = RHEO__ALL_VARIANTS(list_lasts);
    const bool lasts = list_lasts[rheo__simd_in_use()](s, &m) && !have_drifted(t, &m);
    if (lasts) {
        s->unchanged = RHEO__BIT(list_position) | RHEO__BIT(list_margin) | RHEO__BIT(position);
    } else {
        if (t->period->axes)
            wrap(s, t->period);
        set_margins(s, &m, t->def);
    }
    if (!lasts || t->list_made_for != s->rewritten + 1)
        return make_list(s, t);
    s->unchanged |= RHEO__BIT(spring_ends) | RHEO__BIT(spring_rest_length);
    return RHEO_OK;
}
