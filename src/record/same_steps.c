/*
 * Rungs rounding and step (record/same.h). From every recorded state, this build makes one step with the recorded commands;
 * its difference from the next recorded state is held against a yardstick: the difference that the same step has when it
 * begins with every number moved by 1 ulp (rounding), or when it is made in two halves (step). Since each step begins
 * with a recorded state, no difference can grow.
 *
 * The world of the recorded states follows the recording; the trial steps are undone. Its history and its modes are those
 * that this build makes of the recorded states.
 */
#include <math.h>
#include <string.h>

#include "core/progress.h"
#include "record/same.h"

/* One step of so many in which a decision falls otherwise may still be rounding. */
enum { STEPS_PER_DECISION = 50 };
/* Recorded states from which a step is made in halves, at most. */
enum { HALVED_STATES = 64 };

typedef struct trial {
    rheo_recording *r;
    const rheo_same_options *options;
    rheo_same_steps *result;
    bool halved;
    rheo_world *world;
    rheo__values own, other; /* states after trial steps */
    char stage[32];          /* of the step of `own`: the first whose hashes are not the recorded ones */
    uint64_t decisions;      /* those of the yardstick */
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

/* ---- Judging a step ---- */

static void note(trial *t, const rheo_same_ratio *ratio, double limit)
{
    if (ratio->ratio > t->result->worst.ratio || !t->result->worst.field[0])
        t->result->worst = *ratio;
    if (ratio->ratio > limit && t->result->passed) {
        t->result->passed = false;
        t->result->first = *ratio;
    }
}

/* Whether integers differ. */
static bool other_integer(const rheo__values *a, const rheo__values *b)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        const rheo__field *field = &rheo__field_table[f];
        if (!(a->present >> f & 1) || field->storage != RHEO__FLAT || f == RHEO__FIELD_step ||
            f == RHEO__FIELD_history_rows ||
            (field->element != RHEO_ELEMENT_U64 && field->element != RHEO_ELEMENT_U32))
            continue;
        if (a->items[f] != b->items[f] ||
            memcmp(a->data[f], b->data[f], a->items[f] * field->components * rheo__element_size(field->element)) != 0)
            return true;
    }
    return false;
}

static bool has_springs(const rheo__values *v)
{
    return v->present >> RHEO__FIELD_spring_ends & 1;
}

/* Springs that only one side has, as a ratio of their numbers. */
static void compare_springs(const rheo__same_states *s, rheo_same_ratio *ratio)
{
    const double d = (double)rheo__same_springs(s->recorded, s->own),
                 y = (double)rheo__same_springs(s->other, s->own);
    *ratio = (rheo_same_ratio){.rms = d, .largest = d, .rms_yardstick = y, .largest_yardstick = y};
    snprintf(ratio->field, sizeof ratio->field, "%s", rheo__field_table[RHEO__FIELD_spring_ends].name);
    ratio->ratio = d == 0 ? 0 : d / (y > 0 ? y : 1);
}

/* Whether a decision fell otherwise: a spring was made or broke, or a number of substeps or iterations differs. */
static bool other_decision(const rheo__values *a, const rheo__values *b)
{
    return other_integer(a, b) || (has_springs(a) && rheo__same_springs(a, b));
}

static void judge(trial *t, uint64_t step, const rheo__values *recorded)
{
    const double limit = t->halved ? 1 : t->options->limit;
    const rheo__same_states s = {t->world, recorded, &t->own, &t->other};
    rheo_same_ratio ratio;
    const bool decided = !t->halved && other_decision(recorded, &t->own);
    t->decisions += !t->halved && other_decision(&t->other, &t->own);
    t->result->compared++;
    t->result->decisions += decided;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT && !decided; f++) {
        if (!(recorded->present >> f & 1) || !rheo__same_is_compared(f))
            continue;
        rheo__same_compare(f, &s, &ratio);
        ratio.step = step;
        snprintf(ratio.stage, sizeof ratio.stage, "%s", t->stage);
        note(t, &ratio, limit);
    }
    if (t->halved && has_springs(recorded)) {
        compare_springs(&s, &ratio);
        ratio.step = step;
        note(t, &ratio, limit);
    }
}

/* A step that this build cannot make, or makes although the recorded one failed. */
static void refuse(trial *t, uint64_t step, const char *field)
{
    rheo_same_ratio ratio = {.step = step, .ratio = INFINITY};
    snprintf(ratio.field, sizeof ratio.field, "%s", field);
    snprintf(ratio.stage, sizeof ratio.stage, "%s", t->stage);
    note(t, &ratio, 0);
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
            refuse(t, step, w->failure.field);
        } else if (t->stage[0]) {
            RHEO__TRY(try_other(t, step, &other_failed, error));
            if (!other_failed)
                judge(t, step, &r->now);
        } else {
            t->result->compared++;
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
        is->reason != was->reason) {
        snprintf(t->stage, sizeof t->stage, "%s", was->stage);
        refuse(t, was->step, was->field);
    }
    return RHEO_OK;
}

static rheo_result compare_all(trial *t, rheo_error *error)
{
    rheo_recording *r = t->r;
    RHEO__TRY(rheo__keyframe_world(r, &r->keyframes[0], NULL, &t->world, error));
    RHEO__TRY(rheo__same_set(t->options, t->world, error));
    t->result->tried = t->result->passed = !t->halved || rheo__same_can_halve(t->world);
    for (size_t i = 0; i < r->step_count && t->result->passed; i++) {
        RHEO__TRY(compare_step(t, i, error));
        RHEO__TRY(rheo__progress("comparing", i + 1, r->step_count, error));
    }
    return t->result->passed && !t->halved && r->has_failure ? compare_failure(t, error) : RHEO_OK;
}

rheo_result rheo__same_steps(rheo_recording *golden, const rheo_same_options *options, bool halved,
                             rheo_same_steps *result, rheo_error *error)
{
    *result = (rheo_same_steps){.available = golden->head.full ? golden->step_count : 0};
    if (result->available == 0)
        return RHEO_OK;
    trial t = {.r = golden, .options = options, .result = result, .halved = halved};
    const rheo_result done = compare_all(&t, error);
    if (result->decisions > result->compared / STEPS_PER_DECISION + t.decisions)
        result->passed = false;
    if (done != RHEO_OK)
        result->passed = false;
    rheo__values_release(&t.own);
    rheo__values_release(&t.other);
    rheo_world_destroy(t.world);
    return done;
}
