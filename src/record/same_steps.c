/*
 * Rungs rounding and step (record/same.h). From every recorded state, this build makes one step with the recorded commands;
 * its difference from the next recorded state is held against a yardstick: the difference that the same step has when it
 * begins with every number moved by 1 ulp (rounding), or when it is made in two halves (step). Since each step begins
 * with a recorded state, no difference can grow.
 *
 * The world of the recorded states follows the recording; the trial steps are undone. Its history and its modes are those
 * that this build makes of the recorded states.
 */
#include <string.h>

#include "core/progress.h"
#include "record/same.h"

/* Recorded states from which a step is made in halves, at most. */
enum { HALVED_STATES = 64 };

typedef struct trial {
    rheo_recording *r;
    const rheo_same_options *options;
    rheo__same_judge judge;
    bool halved;
    rheo_world *world;
    rheo__values own, other; /* states after trial steps */
    char stage[32];          /* of the step of `own`: the first whose hashes are not the recorded ones */
} trial;

/* ---- A trial step ---- */

typedef struct catcher {
    rheo_world *world;
    rheo__values *values;
    const uint64_t *expected; /* NULL: hashes are not compared */
    size_t expected_count;
    char *stage;
    bool caught;
} catcher;

/* Takes the state at the end of a step, which is then undone. */
static rheo_result catch_state(void *user, rheo_error *error)
{
    catcher *c = user;
    rheo_world *w = c->world;
    rheo__field_id field;
    RHEO__TRY(rheo__values_take(c->values, &w->state, false, error));
    for (size_t i = 0; c->expected && i < w->trace.count; i++)
        if (i >= c->expected_count || w->trace.hash[i] != c->expected[i]) {
            rheo__world_trace_entry(w, rheo__world_substeps(w), i, c->stage, &field);
            break;
        }
    c->caught = true;
    return rheo__fail(error, RHEO_ERROR_STOPPED, "a trial step");
}

/* Makes a step and undoes it. *failed: a stage failed, whose name is in `stage`. */
static rheo_result try_step(trial *t, rheo__values *values, char *stage, bool *failed, rheo_error *error)
{
    catcher c = {.world = t->world, .values = values, .stage = stage};
    if (stage) {
        c.expected = t->r->expected;
        c.expected_count = t->r->expected_count;
    }
    const rheo__step_check check = {catch_state, &c};
    const rheo_result result = rheo__world_step_checked(t->world, &check, error);
    *failed = result == RHEO_ERROR_STATE;
    if (*failed && stage)
        snprintf(stage, 32, "%s", t->world->failure.stage);
    return c.caught || *failed ? RHEO_OK : result;
}

/* The same step, moved by rounding or made in halves: into t->other. */
static rheo_result try_other(trial *t, uint64_t step, bool *failed, rheo_error *error)
{
    if (t->halved)
        return rheo__same_halves(t->world, &t->other, failed, error);
    const uint64_t seed = t->options->seed * UINT64_C(0x9e3779b97f4a7c15) + step;
    RHEO__TRY(rheo__same_move_state(t->world, seed, error));
    RHEO__TRY(try_step(t, &t->other, NULL, failed, error));
    return rheo__same_move_state(t->world, seed, error);
}

/* ---- The recording ---- */

static rheo_result compare_step(trial *t, size_t index, rheo_error *error)
{
    rheo_recording *r = t->r;
    rheo_world *w = t->world;
    const uint64_t step = r->first_step + 1 + index;
    bool failed, other_failed = false;
    RHEO__TRY(rheo__values_take(&r->before, &w->state, false, error));
    RHEO__TRY(rheo__same_command(r, index, t->options, w, error));
    RHEO__TRY(rheo__recording_read_step(r, index, error));
    RHEO__TRY(rheo__recording_read_state(r, index, w->state.present, &r->before, &r->now, error));
    const size_t stride = r->step_count / HALVED_STATES + 1;
    if (!t->halved || index % stride == stride / 2) {
        t->stage[0] = '\0';
        RHEO__TRY(try_step(t, &t->own, t->stage, &failed, error));
        if (failed) {
            rheo__same_refuse(&t->judge, step, t->stage, w->failure.field);
        } else if (t->stage[0]) {
            RHEO__TRY(try_other(t, step, &other_failed, error));
            const rheo__same_states states = {w, &r->now, &t->own, &t->other};
            if (!other_failed)
                rheo__same_judge_states(&t->judge, &states, step, t->stage);
        } else {
            t->judge.result->compared++;
        }
    }
    const rheo__fields own = RHEO__RING_FIELDS | RHEO__BIT(history_modes);
    return rheo__full_restore(r, step, &r->now, own, w, error);
}

/* The step that failed must fail again, in the same stage and for the same reason. */
static rheo_result compare_failure(trial *t, rheo_error *error)
{
    const rheo_failure *was = &t->r->failure, *is = &t->world->failure;
    bool failed;
    RHEO__TRY(rheo__same_command_of(t->r, &t->r->failed, was->step, t->options, t->world, error));
    RHEO__TRY(try_step(t, &t->own, NULL, &failed, error));
    if (!failed || strcmp(is->stage, was->stage) != 0 || strcmp(is->field, was->field) != 0 ||
        is->reason != was->reason)
        rheo__same_refuse(&t->judge, was->step, was->stage, was->field);
    return RHEO_OK;
}

static rheo_result compare_all(trial *t, rheo_error *error)
{
    rheo_recording *r = t->r;
    rheo_same_steps *result = t->judge.result;
    RHEO__TRY(rheo__keyframe_world(r, &r->keyframes[0], NULL, &t->world, error));
    RHEO__TRY(rheo__same_set(t->options, t->world, error));
    result->tried = result->passed = !t->halved || rheo__same_can_halve(t->world);
    for (size_t i = 0; i < r->step_count && result->passed; i++) {
        RHEO__TRY(compare_step(t, i, error));
        RHEO__TRY(rheo__progress("comparing", i + 1, r->step_count, error));
    }
    return result->passed && !t->halved && r->has_failure ? compare_failure(t, error) : RHEO_OK;
}

rheo_result rheo__same_steps(rheo_recording *golden, const rheo_same_options *options, bool halved,
                             rheo_same_steps *result, rheo_error *error)
{
    *result = (rheo_same_steps){.interval = 1};
    if (!golden->head.full)
        return halved ? RHEO_OK : rheo__same_intervals(golden, options, result, error);
    result->available = golden->step_count;
    trial t = {.r = golden,
               .options = options,
               .judge = {.result = result, .limit = halved ? 1 : options->limit, .whole = halved},
               .halved = halved};
    const rheo_result done = compare_all(&t, error);
    rheo__same_judge_end(&t.judge);
    rheo__values_release(&t.own);
    rheo__values_release(&t.other);
    rheo_world_destroy(t.world);
    return done;
}
