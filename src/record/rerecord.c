/*
 * Recording a run again from its recording: the first state, the commands before each step, and the options are those
 * of the old file, the steps are those of this build.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/progress.h"
#include "record/recorder.h"
#include "record/replace.h"

/* Makes the steps of the old recording, and tries the one that failed. */
static rheo_result make_steps(rheo_recording *old, rheo_world *world, rheo_recorder *recorder, rheo_error *error)
{
    const size_t steps = old->step_count + old->has_failure;
    for (size_t i = 0; i < steps; i++) {
        const rheo__step_chunks *chunks = i < old->step_count ? &old->steps[i] : &old->failed;
        RHEO__TRY(rheo__recording_command(old, chunks, old->first_step + 1 + i, world, error));
        const rheo_result result = rheo_recorder_step(recorder, error);
        if (result == RHEO_ERROR_STATE) /* the recorder keeps the failure */
            return RHEO_OK;
        RHEO__TRY(result);
        RHEO__TRY(rheo__progress("recording", i + 1, steps, error));
    }
    return RHEO_OK;
}

static rheo_result record(rheo_recording *old, rheo_world *world, const char *path, bool full, rheo_error *error)
{
    const rheo_record_options options = {.scene = old->head.scene,
                                         .keyframe_spacing = old->head.keyframe_spacing,
                                         .full = full || old->head.full,
                                         .force = true,
                                         .made_by = old->made.by,
                                         .scene_text = old->made.scene};
    if (old->head.keyframe_spacing == 0) /* a checkpoint */
        return rheo_world_save(world, old->head.scene, path, true, error);
    rheo_recorder *recorder;
    RHEO__TRY(rheo_recorder_open(world, path, &options, &recorder, error));
    const rheo_result result = make_steps(old, world, recorder, error),
                      closed = rheo_recorder_close(recorder, result == RHEO_OK ? error : NULL);
    return result == RHEO_OK ? closed : result;
}

/* Records into a file of the name `beside`, compares it, and puts it in its place. */
static rheo_result rerecord(const char *old_path, const char *new_path, const char *beside, bool full,
                            rheo_output_use use, rheo_verification *difference, rheo_error *error)
{
    rheo_recording *old;
    rheo_world *world = NULL;
    RHEO__TRY(rheo_recording_open(old_path, &old, error));
    rheo_result result = RHEO_OK;
    if (!old->complete)
        result = rheo__in_file(old_path, old->fault_result, &old->fault, error);
    if (result == RHEO_OK)
        result = rheo_recording_world(old, old->first_step, NULL, &world, error);
    if (result == RHEO_OK)
        result = record(old, world, beside, full, error);
    rheo_world_destroy(world);
    rheo_recording_close(old);
    if (result == RHEO_OK)
        result = rheo_diff(old_path, beside, difference, error);
    if (result == RHEO_OK && difference->verdict == RHEO_UNREADABLE)
        result = rheo__fail(error, RHEO_ERROR_FORMAT, "%.500s", difference->message);
    if (result == RHEO_OK) /* rheo_diff() may have left out values instead of stopping */
        result = rheo__progress("comparing", 1, 1, error);
    if (result == RHEO_OK) /* a file may have appeared meanwhile */
        result = rheo_output_check(new_path, use, error);
    if (result == RHEO_OK)
        return rheo__replace_by(new_path, NULL, beside, error);
    remove(beside);
    return result;
}

rheo_result rheo_rerecord(const char *old_path, const char *new_path, bool full, bool force,
                          rheo_verification *difference, rheo_error *error)
{
    char *target;
    memset(difference, 0, sizeof *difference);
    const rheo_output_use use = force ? RHEO_OUTPUT_REPLACE : RHEO_OUTPUT_NEW;
    RHEO__TRY(rheo_output_check(new_path, use, error));
    RHEO__TRY(rheo__output_target(new_path, &target, error));
    char *beside = malloc(strlen(target) + 16);
    FILE *reserved = beside ? rheo__open_beside(target, beside) : NULL;
    rheo_result result = RHEO_OK;
    if (!beside) {
        result = rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to record %.300s again", old_path);
    } else if (reserved) {
        fclose(reserved);
        result = rerecord(old_path, target, beside, full, use, difference, error);
        if (result != RHEO_OK)
            remove(beside);
    } else {
        result = rheo__fail(error, RHEO_ERROR_FILE, "cannot write %.300s: %s", beside, strerror(errno));
    }
    free(beside);
    free(target);
    return result;
}
