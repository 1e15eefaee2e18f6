/*
 * Verifying: simulates a recording again and finds the first difference.
 *
 * Every stage is compared with the recorded hashes. A step stops after the first stage that differs: the world then
 * has this build's values right after that stage. If a single component differs, the recorded value is solved from
 * the hash; else a full recording has the values at the end of the step. Then the replay continues, to report how
 * the difference grows in every state that the recording holds.
 */
#include <stdlib.h>
#include <string.h>

#include "core/progress.h"
#include "core/text.h"
#include "record/recording.h"

static const char *const NAMES[] = {"the recording", "this build"};

typedef struct verifier {
    rheo_recording *r;
    rheo_world *world;
    rheo_verification *v;
    rheo__values before, stored,
        own;              /* full only: recorded states before and after the step; simulated state after it */
    size_t keyframe;      /* index of the next keyframe */
    rheo__field_id field; /* whose hash differs */
    uint64_t agreed;      /* last step at whose end stored values agree in spite of the difference; 0: none */
} verifier;

/* ---- Growth ---- */

/*
 * Compares the state that the recording holds at the end of steps[index], if any, with the world. Takes the values of
 * the difference from there, if they are not known yet; adds to the growth if it is due.
 */
static rheo_result compare_stored(verifier *w, size_t index, bool due, rheo_error *error)
{
    rheo_recording *r = w->r;
    rheo_difference *d = &w->v->first;
    uint64_t step = r->first_step + 1 + index;
    const rheo__keyframe *k = w->keyframe < r->keyframe_count ? &r->keyframes[w->keyframe] : NULL;
    if (k && k->step == step)
        w->keyframe++;
    else
        k = NULL;
    if (!r->head.full && !k)
        return RHEO_OK;
    if (!r->head.full)
        RHEO__TRY(rheo__keyframe_values(r, k, w->world, &w->stored, error));
    RHEO__TRY(rheo__values_take(&w->own, &w->world->state, false, error));
    if (d->origin == RHEO_VALUES_NONE) {
        if (rheo__compare_values(w->field, &w->stored, &w->own, RHEO_VALUES_STORED, d))
            d->value_step = step;
        else
            w->agreed = step;
    }
    if (due)
        rheo__compare_growth(w->v, step, &w->stored, &w->own);
    return RHEO_OK;
}

/* Continues after a difference without comparing hashes, as long as the replay can. */
static rheo_result follow_growth(verifier *w, size_t index, rheo_error *error)
{
    rheo_recording *r = w->r;
    enum { LAST = 128, KEYFRAMES = 2 };
    size_t first = index, due = 1, keyframes = w->keyframe;
    for (size_t i = index + 1; i < r->step_count; i++) {
        rheo_error ignored;
        if (rheo__progress("simulating", i - index, r->step_count - index, &ignored) != RHEO_OK)
            break; /* the difference is known, only its growth is not */
        bool far = r->head.full ? i - first > LAST : w->keyframe - keyframes >= KEYFRAMES;
        if (far || rheo__recording_command(r, &r->steps[i], r->first_step + 1 + i, w->world, &ignored) != RHEO_OK ||
            rheo_world_step(w->world, &ignored) != RHEO_OK)
            break;
        bool is_due = !r->head.full || i - first == due;
        if (r->head.full)
            RHEO__TRY(rheo__recording_read_state(r, i, w->world->state.present, &w->before, &w->stored, error));
        if (is_due || w->v->first.origin == RHEO_VALUES_NONE)
            RHEO__TRY(compare_stored(w, i, is_due, error));
        if (is_due)
            due *= 2;
        if (r->head.full)
            rheo__values_swap(&w->before, &w->stored);
    }
    return RHEO_OK;
}

/* ---- Steps ---- */

/* Notes the hash of the world, which is at the end of the last step that is compared. */
static void note_hash(verifier *w)
{
    w->v->has_hash = true;
    w->v->hash = rheo_world_hash(w->world);
}

/* Describes a difference. The world is right after the stage that differs; the step is finished here. */
static rheo_result differs(verifier *w, size_t index, size_t different, rheo_error *error)
{
    rheo_recording *r = w->r;
    rheo_difference *d = &w->v->first;
    char name[32];
    w->v->verdict = RHEO_DIFFERS;
    rheo__world_trace_entry(w->world, rheo__world_substeps(w->world), different, name, &w->field);
    rheo__difference_locate(d, r->first_step + 1 + index, name, w->field);
    if (different < r->expected_count)
        rheo__difference_solve(d, &w->world->state, w->field, r->expected[different], true);
    rheo_error ignored;
    bool finished = w->world->stage_runs_done == 0 || rheo_world_step(w->world, &ignored) == RHEO_OK;
    if (finished) {
        note_hash(w);
        if (r->head.full)
            RHEO__TRY(rheo__recording_read_state(r, index, w->world->state.present, &w->before, &w->stored, error));
        RHEO__TRY(compare_stored(w, index, true, error));
        rheo__values_swap(&w->before, &w->stored);
        RHEO__TRY(follow_growth(w, index, error));
    }
    rheo__difference_describe(w->v, NAMES, w->agreed, r->head.full);
    return RHEO_OK;
}

/* Returns RHEO_OK for a difference too: it is the verdict. */
static rheo_result verify_step(verifier *w, size_t index, rheo_error *error)
{
    rheo_recording *r = w->r;
    rheo_verification *v = w->v;
    uint64_t step = r->first_step + 1 + index;
    size_t different;
    rheo_error why;
    rheo_result result = rheo__recording_replay(r, index, w->world, &different, &why);
    if (result == RHEO_ERROR_STATE) {
        v->verdict = RHEO_DIFFERS;
        rheo__difference_locate(&v->first, step, w->world->failure.stage, RHEO__FIELD_COUNT);
        snprintf(v->first.field, sizeof v->first.field, "%s", w->world->failure.field);
        snprintf(v->message, sizeof v->message, "differs at step %llu: it was recorded, but fails here: %.400s",
                 (unsigned long long)step, why.message);
        return RHEO_OK;
    }
    if (result != RHEO_OK)
        return rheo__fail(error, result, "%s", why.message);
    if (different != RHEO__NO_HASH)
        return differs(w, index, different, error);
    if (!r->head.full)
        return RHEO_OK;
    RHEO__TRY(rheo__recording_read_state(r, index, w->world->state.present, &w->before, &w->stored, error));
    RHEO__TRY(rheo__values_take(&w->own, &w->world->state, false, error));
    rheo_difference ignored;
    if (rheo__compare_values(RHEO__FIELD_COUNT, &w->stored, &w->own, RHEO_VALUES_STORED, &ignored))
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the stored state of step %llu does not have its hashes",
                          (unsigned long long)step);
    rheo__values_swap(&w->before, &w->stored);
    return RHEO_OK;
}

/* The parameters of a keyframe must be those of the run, or it would go on otherwise from there. */
static rheo_result verify_parameters(verifier *w, const rheo__keyframe *k, rheo_error *error)
{
    rheo_world_def def;
    char stored[96], own[96];
    RHEO__TRY(rheo__keyframe_read(w->r, k, NULL, NULL, &def, error));
    const rheo_parameter *p = rheo_world_def_differing(&def, &w->world->def, &(size_t){0}, stored, own);
    if (!p)
        return RHEO_OK;
    w->v->verdict = RHEO_DIFFERS;
    note_hash(w);
    rheo__difference_locate(&w->v->first, k->step, "", RHEO__FIELD_COUNT);
    snprintf(w->v->first.field, sizeof w->v->first.field, "%s", p->path);
    snprintf(w->v->message, sizeof w->v->message,
             "differs at step %llu: %s is %s in the keyframe of the recording, and %s in the run up to there",
             (unsigned long long)k->step, p->path, *stored ? stored : "missing", *own ? own : "missing");
    return RHEO_OK;
}

static rheo_result verify_keyframe(verifier *w, rheo_error *error)
{
    rheo__field_id field;
    const rheo__keyframe *k = &w->r->keyframes[w->keyframe++];
    RHEO__TRY(rheo__keyframe_compare(w->r, k, w->world, &field, error));
    if (field == RHEO__FIELD_COUNT) /* the world was made from the first keyframe */
        return w->keyframe > 1 ? verify_parameters(w, k, error) : RHEO_OK;
    w->v->verdict = RHEO_DIFFERS;
    note_hash(w);
    rheo__difference_locate(&w->v->first, k->step, "", field);
    RHEO__TRY(rheo__keyframe_values(w->r, k, w->world, &w->stored, error));
    RHEO__TRY(rheo__values_take(&w->own, &w->world->state, false, error));
    rheo__compare_values(field, &w->stored, &w->own, RHEO_VALUES_STORED, &w->v->first);
    rheo__difference_describe(w->v, NAMES, 0, w->r->head.full);
    return RHEO_OK;
}

bool rheo__same_failure(const rheo_failure *a, const rheo_failure *b)
{
    return strcmp(a->stage, b->stage) == 0 && strcmp(a->field, b->field) == 0 && a->id == b->id &&
           a->component == b->component && a->reason == b->reason && a->required == b->required &&
           a->limit == b->limit;
}

/* The step that failed must fail again, at the same place for the same reason. */
static rheo_result verify_failure(verifier *w, rheo_error *error)
{
    const rheo_recording *r = w->r;
    const rheo_failure *was = &r->failure;
    rheo_error why;
    RHEO__TRY(rheo__recording_command(w->r, &r->failed, was->step, w->world, error));
    rheo_result result = rheo_world_step(w->world, &why);
    if (result != RHEO_OK && result != RHEO_ERROR_STATE)
        return rheo__fail(error, result, "%s", why.message);
    if (result == RHEO_ERROR_STATE && rheo__same_failure(&w->world->failure, was))
        return RHEO_OK;
    char message[512];
    rheo_failure_message(was, message, sizeof message);
    w->v->verdict = RHEO_DIFFERS;
    rheo__difference_locate(&w->v->first, was->step, was->stage, RHEO__FIELD_COUNT);
    snprintf(w->v->first.field, sizeof w->v->first.field, "%s", was->field);
    snprintf(w->v->message, sizeof w->v->message, "differs at step %llu: the run ended there: %.300s; here %.300s",
             (unsigned long long)was->step, message, result == RHEO_OK ? "it does not fail" : why.message);
    return RHEO_OK;
}

static rheo_result verify_all(verifier *w, rheo_error *error)
{
    rheo_recording *r = w->r;
    rheo_verification *v = w->v;
    RHEO__TRY(rheo__head_check_numbers(&r->head, error));
    RHEO__TRY(rheo__head_check_world(&r->head, w->world, error));
    if (r->head.full)
        RHEO__TRY(rheo__values_take(&w->before, &w->world->state, false, error));
    RHEO__TRY(verify_keyframe(w, error));
    for (size_t i = 0; i < r->step_count && v->verdict == RHEO_SAME; i++) {
        RHEO__TRY(verify_step(w, i, error));
        if (v->verdict == RHEO_SAME && w->keyframe < r->keyframe_count &&
            r->keyframes[w->keyframe].step == r->first_step + 1 + i)
            RHEO__TRY(verify_keyframe(w, error));
        v->steps += v->verdict == RHEO_SAME;
        RHEO__TRY(rheo__progress("verifying", i + 1, r->step_count, error));
    }
    if (v->verdict == RHEO_SAME)
        note_hash(w);
    if (v->verdict == RHEO_SAME && r->complete && r->has_last_hash && v->hash != r->last_hash) {
        v->verdict = RHEO_DIFFERS;
        rheo__difference_locate(&v->first, r->last_step, "", RHEO__FIELD_COUNT);
        snprintf(v->message, sizeof v->message, "differs at step %llu: the hash of the whole state at the end",
                 (unsigned long long)r->last_step);
    }
    if (v->verdict == RHEO_SAME && r->has_failure)
        RHEO__TRY(verify_failure(w, error));
    return RHEO_OK;
}

rheo_result rheo__verify_world(rheo_recording *r, rheo_world *world, rheo_verification *v, rheo_error *error)
{
    memset(v, 0, sizeof *v);
    v->verdict = RHEO_SAME;
    verifier w = {.r = r, .world = world, .v = v};
    rheo_error why;
    rheo_result result = verify_all(&w, &why);
    rheo__name_builds(v, NAMES, r->head.build, rheo_build());
    rheo__values_release(&w.before);
    rheo__values_release(&w.stored);
    rheo__values_release(&w.own);
    if (result == RHEO_OK && v->verdict == RHEO_SAME && r->complete)
        snprintf(v->message, sizeof v->message, "same: %llu step%s from step %llu on%s", (unsigned long long)v->steps,
                 rheo__plural(v->steps), (unsigned long long)r->first_step,
                 r->has_failure ? ", and the failure of the next" : "");
    /* A fault later in the file outweighs an earlier difference. */
    if (result == RHEO_OK && !r->complete)
        return rheo__unreadable(v, r->fault_result, &r->fault, error);
    return result == RHEO_OK ? RHEO_OK : rheo__unreadable(v, result, &why, error);
}

static rheo_result verify_opened(rheo_recording *r, rheo_verification *v, rheo_error *error)
{
    memset(v, 0, sizeof *v);
    bool damaged;
    rheo_error why;
    rheo_world *world = NULL;
    rheo_result result = rheo__recording_scan(r, true, &damaged, &why);
    if (result == RHEO_OK)
        result = rheo__keyframe_world(r, &r->keyframes[0], NULL, &world, &why);
    result = result == RHEO_OK ? rheo__verify_world(r, world, v, error) : rheo__unreadable(v, result, &why, error);
    rheo_world_destroy(world);
    return result;
}

rheo_result rheo_verify(const char *path, rheo_verification *v, rheo_error *error)
{
    rheo_error why, named;
    rheo_recording *r = calloc(1, sizeof *r);
    rheo_result result = r ? rheo__reader_open(&r->reader, path, &why)
                           : rheo__fail(&why, RHEO_ERROR_MEMORY, "no memory to verify a recording");
    if (result == RHEO_OK)
        result = verify_opened(r, v, &why);
    rheo_recording_close(r);
    return rheo__not_compared(v, rheo__in_file(path, result, &why, &named), &named, error);
}

rheo_result rheo_verify_memory(const void *bytes, size_t size, rheo_verification *v, rheo_error *error)
{
    rheo_error why;
    rheo_recording *r = calloc(1, sizeof *r);
    rheo_result result = r ? RHEO_OK : rheo__fail(&why, RHEO_ERROR_MEMORY, "no memory to verify a recording");
    if (result == RHEO_OK) {
        r->reader = (rheo__reader){.memory = bytes, .size = size};
        result = verify_opened(r, v, &why);
    }
    rheo_recording_close(r);
    return rheo__not_compared(v, result, &why, error);
}
