/*
 * Comparing a run with a golden recording while it goes on. The run is recorded in memory and its hashes are compared
 * with those of the golden recording. At the first difference, or at the end, the two recordings are compared as by
 * rheo_diff(), which knows the values and the commands.
 */
#include <stdlib.h>
#include <string.h>

#include "record/recording.h"

struct rheo_golden {
    rheo_world *world;
    rheo_recording *recording;
    rheo_recorder *recorder; /* NULL once the two recordings have been compared */
    rheo_verification v;
};

static void release(rheo_golden *g)
{
    rheo_recording_close(g->recording);
    rheo_recorder_close(g->recorder, NULL);
    free(g);
}

/* Ends the run and compares its recording with the golden one. After an error the two are not compared. */
static rheo_result compare(rheo_golden *g, rheo_error *error)
{
    static const char *const NAMES[] = {"the golden recording", "this run"};
    void *bytes;
    size_t size;
    rheo_error why;
    rheo_recording *run;
    rheo_recorder *recorder = g->recorder;
    g->recorder = NULL;
    rheo_result result = rheo_recorder_close_memory(recorder, &bytes, &size, &why);
    if (result == RHEO_OK)
        result = rheo_recording_open_memory(bytes, size, &run, &why);
    if (result == RHEO_OK) {
        result = rheo__diff_recordings(g->recording, run, NAMES, &g->v, &why);
        rheo_recording_close(run);
    }
    free(bytes);
    return rheo__not_compared(&g->v, result, &why, error);
}

static rheo_result differs(const rheo_golden *g, rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_DIFFERS, "%s", g->v.message);
}

/* A hash of the run is another one than that of the golden recording: finds the values. */
static rheo_result explain(rheo_golden *g, rheo_error *error)
{
    RHEO__TRY(compare(g, error));
    if (g->v.verdict != RHEO_SAME)
        return differs(g, error);
    /* The hashes are those of the same step, so this build does not hash or record as it runs. */
    g->v.verdict = RHEO_DIFFERS;
    snprintf(g->v.message, sizeof g->v.message, "differs at step %llu: its hashes are not those of its recording",
             (unsigned long long)rheo_world_step_count(g->world));
    return differs(g, error);
}

static rheo_result begin(rheo_golden *g, rheo_error *error)
{
    rheo_recording *r = g->recording;
    if (!r->complete)
        return rheo__fail(error, r->fault_result, "%s", r->fault.message);
    RHEO__TRY(rheo__head_check_numbers(&r->head, error));
    RHEO__TRY(rheo__head_check_world(&r->head, g->world, error));
    const rheo_record_options options = {
        .scene = r->head.scene, .keyframe_spacing = r->head.keyframe_spacing, .full = r->head.full};
    RHEO__TRY(rheo_recorder_open_memory(g->world, &options, &g->recorder, error));
    const uint64_t step = rheo_world_step_count(g->world);
    if (step != r->first_step)
        return rheo__fail(error, RHEO_ERROR_DIFFERS, "it begins at step %llu, but the world is at step %llu",
                          (unsigned long long)r->first_step, (unsigned long long)step);
    rheo__field_id field;
    RHEO__TRY(rheo__keyframe_compare(r, &r->keyframes[0], g->world, &field, error));
    return field == RHEO__FIELD_COUNT ? RHEO_OK : explain(g, error);
}

rheo_result rheo_golden_open(rheo_world *world, const char *path, rheo_golden **golden, rheo_error *error)
{
    rheo_error why;
    *golden = NULL;
    RHEO__TRY(rheo__world_check_between_steps(world, "cannot be compared", error));
    rheo_golden *g = calloc(1, sizeof *g);
    if (!g)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to compare a run with %.300s", path);
    g->world = world;
    rheo_result result = rheo_recording_open(path, &g->recording, error);
    if (result == RHEO_OK)
        result = rheo__in_file(path, begin(g, &why), &why, error);
    if (result == RHEO_OK)
        *golden = g;
    else
        release(g);
    return result;
}

rheo_result rheo_golden_step(rheo_golden *g, rheo_error *error)
{
    if (!g->recorder)
        return differs(g, error);
    rheo_recording *r = g->recording;
    RHEO__TRY(rheo_recorder_step(g->recorder, error));
    const uint64_t step = rheo_world_step_count(g->world);
    if (step > r->last_step)
        return explain(g, error);
    RHEO__TRY(rheo__recording_read_step(r, (size_t)(step - r->first_step - 1), error));
    const bool same = g->world->trace.count == r->expected_count &&
                      memcmp(g->world->trace.hash, r->expected, r->expected_count * sizeof *r->expected) == 0;
    return same ? RHEO_OK : explain(g, error);
}

rheo_result rheo_golden_close(rheo_golden *g, rheo_verification *v, rheo_error *error)
{
    rheo_error why;
    rheo_verification ignored;
    v = v ? v : &ignored;
    if (!g)
        return rheo__not_compared(
            v, rheo__fail(&why, RHEO_ERROR_ARGUMENT, "there is no golden recording to compare with"), &why, error);
    rheo_result result = g->recorder ? compare(g, &why) : RHEO_OK;
    if (result == RHEO_OK) {
        *v = g->v;
        result = v->verdict == RHEO_SAME ? RHEO_OK : differs(g, error);
    } else {
        rheo__not_compared(v, result, &why, error);
    }
    release(g);
    return result;
}
