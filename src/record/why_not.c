/*
 * Why two particles have no spring, or did not meet (rheolog/why.h): their distance through a keyframe interval, after the stages
 * that decide. All schemes make a spring of each pair that is closer than the support when the stage that writes the springs
 * looks, and of no other; so distance is all that decides, for all materials.
 */
#include <math.h>
#include <string.h>

#include "core/progress.h"
#include "core/text.h"
#include "record/recording.h"
#include "rheolog/why.h"
#include "world/query_particles.h"
#include "world/world.h"

typedef struct question {
    rheo_player *player;
    uint64_t step;
    uint32_t a, b;
    bool spring;
    rheo_pair_receiver *receiver;
    void *data;
    rheo_why_not *answer;
} question;

static const rheo_world *world_of(const question *q)
{
    return rheo_player_world(q->player);
}

static bool exist(const question *q)
{
    const uint32_t particles = world_of(q)->state.particles;
    return q->a < particles && q->b < particles;
}

/* Whether a stage decides: of springs, the one that makes them. Stage neighbours only sorts them anew. */
static bool decides(const question *q, uint32_t index)
{
    const rheo__stage *stage = &world_of(q)->stage[index];
    return !q->spring || ((stage->writes & RHEO__BIT(spring_ends)) && strcmp(stage->name, "neighbours") != 0);
}

/* ---- A step ---- */

/* The end of a step. */
static void look_at_end(const question *q, rheo_pair_step *s)
{
    rheo_spring_state spring;
    rheo_error ignored;
    const rheo_world *world = world_of(q);
    s->exists = exist(q);
    s->distance = s->exists ? rheo__query_distance(world, q->a, q->b) : NAN;
    s->spring = s->exists && q->spring && rheo_world_spring(world, q->a, q->b, &spring, &ignored) == RHEO_OK;
}

/* The player must be at the end of the step before. */
static rheo_result look_into(const question *q, rheo_pair_step *s, rheo_error *error)
{
    const rheo_world *world = world_of(q);
    s->nearest = NAN;
    do {
        uint32_t stage;
        const uint64_t run = world->stage_runs_done;
        RHEO__TRY(rheo_player_stage(q->player, &stage, error));
        world = world_of(q);
        if (!exist(q) || !decides(q, stage))
            continue;
        const double distance = rheo__query_distance(world, q->a, q->b);
        if (!(distance >= s->nearest)) {
            s->nearest = distance;
            rheo__world_stage_run_name(world, run, s->stage);
        }
    } while (world->stage_runs_done > 0);
    return RHEO_OK;
}

/* Whether the positions differ by more than the distance: the nearest image is another one. */
static bool is_across(const question *q, double distance)
{
    const rheo_real *x = world_of(q)->state.position + 3 * (size_t)q->a,
                    *y = world_of(q)->state.position + 3 * (size_t)q->b;
    double r2 = 0;
    for (int axis = 0; axis < 3; axis++)
        r2 += ((double)y[axis] - (double)x[axis]) * ((double)y[axis] - (double)x[axis]);
    return world_of(q)->period.axes && r2 > distance * distance * 1.0001;
}

static bool holds(const question *q, const rheo_pair_step *s)
{
    return q->spring ? s->spring : s->exists && s->distance < q->answer->support;
}

/* Takes a step into the answer. */
static void take(const question *q, const rheo_pair_step *s)
{
    rheo_why_not *answer = q->answer;
    if (s->step == q->step) {
        answer->at = *s;
        answer->holds = holds(q, s);
        answer->across = s->exists && is_across(q, s->distance);
    }
    if (*s->stage && (!*answer->nearest.stage || s->nearest < answer->nearest.nearest))
        answer->nearest = *s;
    if (!holds(q, s))
        return;
    if (!answer->held)
        answer->held_first = s->step;
    answer->held = true;
    answer->held_last = s->step;
}

/* ---- In words ---- */

static void tell(const question *q)
{
    rheo_why_not *w = q->answer;
    char text[32];
    const unsigned long long a = q->a, b = q->b, step = q->step, first = w->held_first, last = w->held_last;
    rheo__text_print(w->why, sizeof w->why, "%llu and %llu are %s supports apart at the end of step %llu%s", a, b,
                     rheo_number_brief(w->at.distance / w->support, 4, text), step,
                     w->across ? ", across a border of periodic space" : "");
    if (w->holds) {
        rheo__text_add(w->why, sizeof w->why, q->spring ? ", and have a spring" : ", and so are neighbours");
        return;
    }
    if (*w->nearest.stage)
        rheo__text_add(w->why, sizeof w->why, ", nearest in step %llu with %s, after %s",
                       (unsigned long long)w->nearest.step,
                       rheo_number_brief(w->nearest.nearest / w->support, 4, text), w->nearest.stage);
    if (!w->held && w->nearest.nearest < w->support)
        rheo__text_add(w->why, sizeof w->why,
                       q->spring ? "; the spring that was made there vanished before the step ended"
                                 : "; so they met, but at the end of no step");
    else if (!w->held)
        rheo__text_add(w->why, sizeof w->why,
                       q->spring ? "; springs form below 1" : "; particles are neighbours below 1");
    else if (last < step)
        rheo__text_add(w->why, sizeof w->why, "; %s until step %llu, and %s at 1 support",
                       q->spring ? "they had a spring" : "they were neighbours", last,
                       q->spring ? "springs vanish" : "that ends");
    else if (first > step)
        rheo__text_add(w->why, sizeof w->why, "; %s from step %llu on",
                       q->spring ? "they have a spring" : "they are neighbours", first);
    else
        rheo__text_add(w->why, sizeof w->why, "; %s before and after, first in step %llu, last in %llu",
                       q->spring ? "they had a spring" : "they were neighbours", first, last);
}

/* ---- The search ---- */

/* The steps from the keyframe before the step to the one after it. */
static void set_range(const question *q)
{
    const rheo_recording *r = rheo__player_recording(q->player);
    const uint64_t before = q->step > r->first_step ? q->step - 1 : q->step;
    const size_t k = rheo__recording_nearest(r, before);
    q->answer->first = r->keyframes[k].step;
    q->answer->last = k + 1 < r->keyframe_count ? r->keyframes[k + 1].step : r->last_step;
    if (q->answer->last > r->last_step)
        q->answer->last = r->last_step;
}

static rheo_result look(const question *q, rheo_error *error)
{
    rheo_why_not *w = q->answer;
    RHEO__TRY(rheo_player_seek(q->player, w->first, error));
    for (uint64_t step = w->first; step <= w->last; step++) {
        rheo_pair_step s = {.step = step, .nearest = NAN};
        if (step > w->first)
            RHEO__TRY(look_into(q, &s, error));
        look_at_end(q, &s);
        take(q, &s);
        if (step == q->step && !s.exists)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no particle %u in step %llu; it has %u, from 0",
                              (unsigned)(q->a > q->b ? q->a : q->b), (unsigned long long)step,
                              (unsigned)world_of(q)->state.particles);
        if (q->receiver && !q->receiver(q->data, &s))
            return rheo__fail(error, RHEO_ERROR_STOPPED, "the receiver wanted no more");
        RHEO__TRY(rheo__progress("looking", step - w->first, w->last - w->first, error));
    }
    return RHEO_OK;
}

rheo_result rheo_player_why_not(rheo_player *player, uint64_t step, uint64_t a, uint64_t b, bool spring,
                                rheo_pair_receiver *receiver, void *data, rheo_why_not *answer, rheo_error *error)
{
    *answer = (rheo_why_not){.support = rheo__def_support(&rheo_player_world(player)->def)};
    RHEO__TRY(rheo__recording_check_step(rheo__player_recording(player), step, error));
    if (a == b || a >= UINT32_MAX || b >= UINT32_MAX)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "a pair has two different particles, with ids below %u",
                          (unsigned)UINT32_MAX);
    if (spring && !rheo__state_has(&rheo_player_world(player)->state, RHEO__FIELD_spring_ends))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the recording has no springs");
    const question q = {player, step, (uint32_t)a, (uint32_t)b, spring, receiver, data, answer};
    set_range(&q);
    RHEO__TRY(look(&q, error));
    tell(&q);
    return RHEO_OK;
}
