/*
 * Rung rounding for a recording without the state of every step (record/same.h): this build goes from each keyframe to the
 * next. The yardstick is the same way with every number moved by 1 ulp before each step, so that it has rounding as often.
 *
 * Differences grow on the way. Where those of the yardstick are no longer small, any two programs would be as far apart,
 * and nothing can be said: such an interval is not compared.
 */
#include <string.h>

#include "core/progress.h"
#include "record/same.h"

/* Largest root mean square of the yardstick's positions, in supports. */
#define LARGEST_GROWTH 1e-3

typedef struct way {
    rheo_recording *r;
    const rheo_same_options *options;
    rheo__same_judge judge;
    rheo_world *world, *moved;
    rheo__values recorded, own, other;
    char stage[32]; /* the first with another hash */
} way;

static rheo_result load(way *w, size_t keyframe, rheo_error *error)
{
    rheo_world **worlds[] = {&w->world, &w->moved};
    for (int i = 0; i < 2; i++) {
        rheo_world_destroy(*worlds[i]);
        RHEO__TRY(rheo__keyframe_world(w->r, &w->r->keyframes[keyframe], NULL, worlds[i], error));
        RHEO__TRY(rheo__same_set(w->options, *worlds[i], error));
    }
    w->stage[0] = '\0';
    return RHEO_OK;
}

/* A step of this build; notes the first other stage of the way. */
static rheo_result step_own(way *w, size_t index, rheo_error *error)
{
    rheo_recording *r = w->r;
    rheo__field_id field;
    RHEO__TRY(rheo__same_command(r, index, w->options, w->world, error));
    if (w->stage[0])
        return rheo_world_step(w->world, error);
    RHEO__TRY(rheo__recording_read_step(r, index, error));
    RHEO__TRY(rheo__world_step_traced(w->world, r->expected, r->expected_count, error));
    for (size_t i = 0; i < w->world->trace.count && !w->stage[0]; i++)
        if (i >= r->expected_count || w->world->trace.hash[i] != r->expected[i])
            rheo__world_trace_entry(w->world, rheo__world_substeps(w->world), i, w->stage, &field);
    return w->world->stage_runs_done ? rheo_world_step(w->world, error) : RHEO_OK;
}

/* A step from a moved state. Moving it again would not undo it after the step. */
static rheo_result step_moved(way *w, size_t index, rheo_error *error)
{
    const uint64_t step = w->r->first_step + 1 + index;
    RHEO__TRY(rheo__same_move_state(w->moved, w->options->seed * UINT64_C(0x9e3779b97f4a7c15) + step, error));
    RHEO__TRY(rheo__same_command(w->r, index, w->options, w->moved, error));
    return rheo_world_step(w->moved, error);
}

/* Whether the yardstick is still small. */
static bool is_small(const way *w)
{
    const rheo__field_id f = RHEO__FIELD_position;
    const double support = rheo__def_support(&w->world->def);
    const rheo_real *own = w->own.data[f], *other = w->other.data[f];
    const size_t count = 3 * w->own.items[f];
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        const double d = (double)own[i] - (double)other[i], period = (double)w->world->period.length[i % 3];
        const double near = period > 0 && (d > period / 2 || d < -period / 2) ? 0 : d;
        sum += near * near;
    }
    return sum <= (double)count * LARGEST_GROWTH * LARGEST_GROWTH * support * support;
}

static rheo_result go(way *w, size_t keyframe, rheo_error *error)
{
    rheo_recording *r = w->r;
    const rheo__keyframe *from = &r->keyframes[keyframe], *to = from + 1;
    bool moved = true;
    RHEO__TRY(load(w, keyframe, error));
    for (uint64_t step = from->step + 1; step <= to->step; step++) {
        const size_t index = (size_t)(step - r->first_step - 1);
        const rheo_result result = step_own(w, index, error);
        if (result == RHEO_ERROR_STATE) {
            rheo__same_refuse(&w->judge, step, w->world->failure.stage, w->world->failure.field);
            return RHEO_OK;
        }
        RHEO__TRY(result);
        if (moved) {
            const rheo_result other = step_moved(w, index, error);
            moved = other == RHEO_OK;
            RHEO__TRY(other == RHEO_ERROR_STATE ? RHEO_OK : other);
        }
        RHEO__TRY(rheo__progress("comparing", step - r->first_step, r->step_count, error));
    }
    if (!w->stage[0]) {
        w->judge.result->compared++;
        return RHEO_OK;
    }
    if (!moved)
        return RHEO_OK;
    RHEO__TRY(rheo__keyframe_values(r, to, w->world, &w->recorded, error));
    RHEO__TRY(rheo__values_take(&w->own, &w->world->state, false, error));
    RHEO__TRY(rheo__values_take(&w->other, &w->moved->state, false, error));
    const rheo__same_states states = {w->world, &w->recorded, &w->own, &w->other};
    if (is_small(w))
        rheo__same_judge_states(&w->judge, &states, to->step, w->stage);
    return RHEO_OK;
}

rheo_result rheo__same_intervals(rheo_recording *golden, const rheo_same_options *options, rheo_same_steps *result,
                                 rheo_error *error)
{
    way w = {.r = golden, .options = options, .judge = {.result = result, .limit = options->limit}};
    rheo_result done = RHEO_OK;
    result->interval = golden->head.keyframe_spacing;
    result->available = golden->keyframe_count - 1;
    result->passed = result->available > 0;
    for (size_t i = 0; i + 1 < golden->keyframe_count && result->passed && done == RHEO_OK; i++)
        done = go(&w, i, error);
    rheo__same_judge_end(&w.judge);
    result->tried = result->compared > 0 || result->first.field[0];
    /* An interval that says nothing may hide a difference. */
    result->passed = result->passed && result->compared == result->available;
    rheo__values_release(&w.recorded);
    rheo__values_release(&w.own);
    rheo__values_release(&w.other);
    rheo_world_destroy(w.world);
    rheo_world_destroy(w.moved);
    return done;
}
