/*
 * The loop over the list of stages: the only place that knows about timing, hashing stage by stage, and failing.
 *
 * A step is atomic. Flat fields are copied before a stage first writes them, springs are built beside the old ones,
 * and the history, which cannot be undone, is written last, after the state has been checked for NaN and infinity.
 * A check after every stage would cost too much; a step that fails is made again to find the stage.
 */
#define _POSIX_C_SOURCE 199309L
#include "world/world.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "core/account.h"
#include "core/environment.h"
#include "core/work.h"
#include "world/command_queue.h"
#include "world/emit.h"
#include "world/stage_runs.h"

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#ifdef RHEO__CHECK_WRITES
/* The checking build: a stage that writes a field it does not declare is a bug of the library. */
static rheo_result check_writes(const rheo_world *w, uint32_t stage, uint64_t before[RHEO__FIELD_COUNT],
                                rheo_error *error)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        if (!rheo__state_has(&w->state, f))
            continue;
        uint64_t hash = rheo__state_hash_field(&w->state, f);
        if (stage < w->stage_count && hash != before[f] && !((w->stage[stage].writes & ~w->state.unchanged) >> f & 1))
            return rheo__fail(error, RHEO_ERROR_STATE, "stage %s wrote the field %s, which it does not declare",
                              w->stage[stage].name, rheo__field_table[f].name);
        before[f] = hash;
    }
    return RHEO_OK;
}
#endif

/* Looks for NaN or infinity in these fields; *failure says where it is, without the stage. */
static bool is_finite(const rheo_world *w, rheo__fields fields, rheo_failure *failure)
{
    rheo__field_id field;
    uint64_t id;
    uint32_t component;
    if (rheo__state_finite(&w->state, fields, &field, &id, &component))
        return true;
    *failure = (rheo_failure){.step = *w->state.step + 1,
                              .model = w->def.model,
                              .location = rheo__field_table[field].location,
                              .id = id,
                              .component = component,
                              .reason = RHEO_FAILURE_NOT_FINITE};
    snprintf(failure->field, sizeof failure->field, "%s", rheo__field_table[field].name);
    return false;
}

#ifdef RHEO__SABOTAGE
void (*rheo__sabotage)(rheo_world *world, uint32_t stage);
#endif

/* Makes the refusal of a stage the failure of the step. */
static void note_refusal(rheo_world *w, uint64_t stage_run)
{
    const rheo__refusal *r = &w->state.refusal;
    w->failure = (rheo_failure){.step = *w->state.step + 1,
                                .model = w->def.model,
                                .location = rheo__field_table[r->field].location,
                                .id = r->item,
                                .reason = r->reason,
                                .required = r->required,
                                .limit = r->limit};
    rheo__world_stage_run_name(w, stage_run, w->failure.stage);
    snprintf(w->failure.field, sizeof w->failure.field, "%s", rheo__field_table[r->field].name);
}

static void open_account(const rheo_world *w, uint64_t stage_run)
{
    char name[32];
    rheo__world_stage_run_name(w, stage_run, name);
    rheo__account_open(&w->state, name);
}

static rheo_result run_stage(rheo_world *w, uint64_t stage_run, rheo_error *error)
{
    const uint32_t index = rheo__world_stage_of(w, stage_run);
    const rheo__stage *stage = &w->stage[index];
    rheo__state_remember(&w->state, stage->writes & ~RHEO__REMEMBERED_BY_STAGES);
    w->state.unchanged = 0;
    if (w->state.account)
        open_account(w, stage_run);
    const rheo_result result = stage->run(&w->state, stage->context);
    if (w->state.account)
        rheo__account_close(&w->state);
    if (result == RHEO_ERROR_STATE)
        note_refusal(w, stage_run);
    else if (result != RHEO_OK)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory in stage %s of step %llu; the world stays as it was",
                          stage->name, (unsigned long long)*w->state.step + 1);
#ifdef RHEO__SABOTAGE
    if (rheo__sabotage)
        rheo__sabotage(w, index);
    w->state.unchanged = 0; /* the sabotage is a part of the stage */
    w->state.spring_sums.made = false;
#endif
    return result;
}

static rheo_result begin(rheo_world *w, rheo_error *error)
{
    const uint32_t particles = w->state.particles;
    RHEO__TRY(rheo__emit(w, error));
    rheo__work_step();
    if (w->command_count || w->state.particles != particles)
        rheo__world_measure_commands(w);
    w->failed = false;
    w->failure = (rheo_failure){0};
    w->state.refusal = (rheo__refusal){0};
    rheo__world_keep_diagnostics(w);
    rheo__state_begin(&w->state);
    return RHEO_OK;
}

static void undo(rheo_world *w)
{
    rheo__state_undo(&w->state);
    rheo__take_emission_back(w);
    w->stage_runs_done = 0;
}

static void finish(rheo_world *w)
{
    ++*w->state.step;
    w->emission.made = false;
    w->stage_runs_done = 0;
    w->steps_timed++;
    w->substeps_timed += rheo__state_has(&w->state, RHEO__FIELD_substeps) ? *w->state.substeps : 0;
    rheo__world_measure_step(w);
    rheo__world_forget_commands(w);
}

/* Gives up the step, which failed as w->failure says. */
static rheo_result fail(rheo_world *w, rheo_error *error)
{
    char message[512], signs[256] = "";
    undo(w);
    w->failed = true;
    rheo__world_measure_failure(w);
    rheo_failure_message(&w->failure, message, sizeof message);
    if (w->failure.reason == RHEO_FAILURE_NOT_FINITE)
        rheo__world_describe_failure(w, signs, sizeof signs);
    return rheo__fail(error, RHEO_ERROR_STATE, "%s; the world stays at step %llu%s%s", message,
                      (unsigned long long)*w->state.step, signs[0] ? "." : "", signs);
}

/* Makes a failed step again and checks the state after every stage, to find the stage that failed. */
static void find_bad_stage(rheo_world *w)
{
    w->state.account = NULL; /* it has the stages already */
    rheo__state_undo(&w->state);
    rheo__state_begin(&w->state);
    rheo__world_restore_diagnostics(w); /* stages that are not reached keep their old results */
    rheo_failure failure;
    bool finite = is_finite(w, w->state.present, &failure);
    w->stage_runs_done = 0;
    for (; finite && w->stage_runs_done < rheo__world_stage_runs_in_step(w); w->stage_runs_done++) {
        if (run_stage(w, w->stage_runs_done, NULL) != RHEO_OK)
            return;
        finite = is_finite(w, w->state.changed, &failure);
        if (!finite)
            rheo__world_stage_run_name(w, w->stage_runs_done, failure.stage);
    }
    if (!finite)
        w->failure = failure;
}

/* Takes the hashes after a stage run that writes these fields. False: no memory. */
static bool trace(rheo_world *w, rheo__fields writes)
{
    rheo__trace *t = &w->trace;
    void *hash = t->hash;
    const size_t count = (size_t)__builtin_popcountll(writes);
    if (!rheo__grow(&w->def.allocator, &hash, &t->capacity, t->count + count, t->count, sizeof *t->hash))
        return false;
    t->hash = hash;
    if (!rheo__step_hashes_take(&t->known, &w->state, writes, t->hash + t->count))
        return false;
    t->count += count;
    return true;
}

/*
 * Runs the remaining stages. traced: takes their hashes and, if there are `expected` hashes, stops after the first
 * stage run with an unexpected one. Checks the state after every substep, since all later ones would compute with
 * NaN.
 */
static rheo_result run_stages(rheo_world *w, bool traced, const uint64_t *expected, size_t expected_count,
                              const rheo__step_check *check, rheo_error *error)
{
    bool checked = false, differs = false;
#ifdef RHEO__CHECK_WRITES
    uint64_t before[RHEO__FIELD_COUNT];
    check_writes(w, w->stage_count, before, NULL);
#endif
    w->trace.count = 0;
    rheo__step_hashes_begin(&w->trace.known, &w->state,
                            traced && w->stage_runs_done == 0 && w->command_count == 0 && !w->emission.made);
    double start = now();
    for (; w->stage_runs_done < rheo__world_stage_runs_in_step(w) && !differs; w->stage_runs_done++) {
        const uint32_t index = rheo__world_stage_of(w, w->stage_runs_done);
        const rheo__stage *stage = &w->stage[index];
        const bool history = stage->writes & RHEO__HISTORY;
        if (history || rheo__world_begins_later_substep(w, w->stage_runs_done)) {
            if (!is_finite(w, w->state.changed, &w->failure))
                return RHEO_ERROR_STATE;
            checked = history; /* the last stage of the step */
            if (history && check)
                RHEO__TRY(check->call(check->user, error));
        }
        if (traced)
            rheo__step_hashes_prepare(&w->trace.known, &w->state, stage->writes);
        else /* a step that began with hashes may go on without them */
            w->state.spring_sums.wanted = false;
        RHEO__TRY(run_stage(w, w->stage_runs_done, error));
        double end = now();
        w->stage_seconds[index] += end - start;
        if (traced) {
            const size_t first = w->trace.count;
            if (!trace(w, stage->writes))
                return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the hashes of step %llu",
                                  (unsigned long long)*w->state.step + 1);
            const size_t count = w->trace.count - first;
            if (expected)
                differs = w->trace.count > expected_count ||
                          memcmp(w->trace.hash + first, expected + first, count * sizeof *expected) != 0;
        }
#ifdef RHEO__CHECK_WRITES
        RHEO__TRY(check_writes(w, index, before, error));
#endif
        start = traced ? now() : end;
    }
    if (checked || differs)
        return RHEO_OK;
    if (!is_finite(w, w->state.changed, &w->failure))
        return RHEO_ERROR_STATE;
    return check ? check->call(check->user, error) : RHEO_OK;
}

static rheo_result step(rheo_world *w, bool traced, const uint64_t *expected, size_t count,
                        const rheo__step_check *check, rheo_error *error)
{
    RHEO__TRY(rheo__check_environment(error));
    const bool whole = w->stage_runs_done == 0;
    if (whole)
        RHEO__TRY(begin(w, error));
    rheo_result result = run_stages(w, traced, expected, count, check, error);
    if (result == RHEO_OK) {
        assert(!traced || !whole || w->trace.count == rheo__world_trace_start(w, w->stage_runs_done));
        if (w->stage_runs_done == rheo__world_stage_runs_in_step(w))
            finish(w);
    } else if (result == RHEO_ERROR_STATE && w->failure.step) {
        if (!w->state.refusal.reason)
            find_bad_stage(w);
        return fail(w, error);
    } else {
        undo(w);
    }
    return result;
}

rheo_result rheo__world_step_traced(rheo_world *world, const uint64_t *expected, size_t count, rheo_error *error)
{
    return step(world, true, expected, count, NULL, error);
}

rheo_result rheo__world_step_checked(rheo_world *world, const rheo__step_check *check, rheo_error *error)
{
    return step(world, true, NULL, 0, check, error);
}

rheo_result rheo_world_step(rheo_world *world, rheo_error *error)
{
    return step(world, false, NULL, 0, NULL, error);
}

rheo_result rheo_world_step_stage(rheo_world *w, uint32_t *stage, rheo_error *error)
{
    RHEO__TRY(rheo__check_environment(error));
    if (w->stage_runs_done == 0)
        RHEO__TRY(begin(w, error));
    rheo__step_hashes_forget(&w->trace.known);
    const uint64_t stage_run = w->stage_runs_done;
    *stage = rheo__world_stage_of(w, stage_run);
    const double start = now();
    rheo_result result = run_stage(w, stage_run, error);
    w->stage_seconds[*stage] += now() - start;
    if (result == RHEO_ERROR_STATE)
        return fail(w, error);
    if (result != RHEO_OK) {
        undo(w);
        return result;
    }
    if (!is_finite(w, w->state.changed, &w->failure)) {
        rheo__world_stage_run_name(w, stage_run, w->failure.stage);
        return fail(w, error);
    }
    w->stage_runs_done++;
    if (w->stage_runs_done == rheo__world_stage_runs_in_step(w))
        finish(w);
    return RHEO_OK;
}
