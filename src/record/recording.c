/* An open recording and its contents. Nothing here simulates. */
#include "record/recording.h"

#include <stdlib.h>
#include <string.h>

/* ---- Opening ---- */

rheo_result rheo__in_file(const char *path, rheo_result result, const rheo_error *why, rheo_error *error)
{
    return result == RHEO_OK ? RHEO_OK : rheo__fail(error, result, "%.200s: %.300s", path, why->message);
}

/* Takes over r, whose reader is open. */
static rheo_result scan_opened(rheo_recording *r, rheo_recording **recording, rheo_error *error)
{
    bool damaged;
    rheo_result result = rheo__recording_scan(r, false, &damaged, error);
    if (result == RHEO_OK && damaged)
        result = rheo__fail(error, r->fault_result, "%s", r->fault.message);
    if (result != RHEO_OK)
        rheo_recording_close(r);
    else
        *recording = r;
    return result;
}

rheo_result rheo_recording_open(const char *path, rheo_recording **recording, rheo_error *error)
{
    *recording = NULL;
    rheo_error why;
    rheo_recording *r = calloc(1, sizeof *r);
    if (!r)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to open %.300s", path);
    rheo_result result = rheo__reader_open(&r->reader, path, &why);
    if (result == RHEO_OK)
        result = scan_opened(r, recording, &why);
    else
        free(r);
    return rheo__in_file(path, result, &why, error);
}

rheo_result rheo_recording_open_memory(const void *bytes, size_t size, rheo_recording **recording, rheo_error *error)
{
    *recording = NULL;
    rheo_recording *r = calloc(1, sizeof *r);
    if (!r)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to open a recording");
    r->reader = (rheo__reader){.memory = bytes, .size = size};
    return scan_opened(r, recording, error);
}

void rheo_recording_close(rheo_recording *r)
{
    if (!r)
        return;
    rheo__reader_close(&r->reader);
    rheo__head_release(&r->head);
    rheo__made_release(&r->made);
    rheo__members_destroy(r->members);
    rheo__bytes_release(&r->payload);
    rheo__blessings_release(r);
    rheo__values_release(&r->before);
    rheo__values_release(&r->now);
    free(r->keyframes);
    free(r->steps);
    free(r->commanded);
    free(r->expected);
    free(r->metrics);
    free(r);
}

rheo_result rheo_recording_check(rheo_recording *r, rheo_error *error)
{
    const uint64_t end = r->complete ? r->reader.size : r->end;
    for (uint64_t offset = RHEO__MAGIC_SIZE; offset < end;) {
        rheo__chunk chunk;
        bool truncated;
        RHEO__TRY(rheo__chunk_at(&r->reader, offset, &chunk, &truncated, error));
        RHEO__TRY(rheo__chunk_read(&r->reader, &chunk, &r->payload, error));
        offset = chunk.end;
    }
    return RHEO_OK;
}

/* ---- Contents ---- */

static double keyframe_share(const rheo_recording *r)
{
    uint64_t rows = rheo__world_memory_rows(&r->def, r->head.features);
    double cost = (double)rheo__keyframe_cost(r->head.real_bytes, rows, r->head.features & RHEO__FEATURE_SPRINGS);
    double steps = (double)RHEO__STEP_COST * (double)r->head.keyframe_spacing;
    return steps > 0 ? cost / (cost + steps) : 0;
}

rheo_recording_info rheo_recording_get_info(const rheo_recording *r)
{
    return (rheo_recording_info){
        .scene = r->head.scene,
        .build = r->head.build,
        .made_by = r->made.by ? r->made.by : "",
        .scene_text = r->made.scene ? r->made.scene : "",
        .format = r->head.format,
        .real_bytes = r->head.real_bytes,
        .first_step = r->first_step,
        .last_step = r->last_step,
        .particles = r->keyframes[0].particles,
        .keyframes = r->keyframe_count,
        .keyframe_spacing = r->head.keyframe_spacing,
        .keyframe_share = keyframe_share(r),
        .keyframe_bytes = r->keyframe_bytes,
        .step_bytes = r->step_bytes,
        .bytes = r->reader.size,
        .full = r->head.full,
        .complete = r->complete,
        .made_refused = r->made.refused,
        .history = r->head.features & RHEO__FEATURE_HISTORY,
        .being_written = !r->complete && r->reader.growing,
        .blessed = r->golden || r->blessing_count > 0,
    };
}

const rheo_world_def *rheo_recording_definition(const rheo_recording *r)
{
    return &r->def;
}

uint64_t rheo_recording_keyframe_step(const rheo_recording *r, uint64_t index)
{
    return r->keyframes[index < r->keyframe_count ? index : r->keyframe_count - 1].step;
}

uint32_t rheo_recording_metric_count(const rheo_recording *r)
{
    return r->head.metric_count;
}

uint32_t rheo_recording_metric_by_name(const rheo_recording *r, const char *name)
{
    const int index = rheo__metric_index(r->head.metrics, r->head.metric_count, name);
    return index < 0 ? r->head.metric_count : (uint32_t)index;
}

const char *rheo_recording_metric_name(const rheo_recording *r, uint32_t index)
{
    return index < r->head.metric_count ? r->head.metrics[index].text : NULL;
}

rheo_result rheo__recording_check_step(const rheo_recording *r, uint64_t step, rheo_error *error)
{
    if (step >= r->first_step && step <= r->last_step)
        return RHEO_OK;
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no step %llu in the recording; it has %llu to %llu%s",
                      (unsigned long long)step, (unsigned long long)r->first_step, (unsigned long long)r->last_step,
                      r->complete         ? ""
                      : r->reader.growing ? " so far"
                                          : ", then it is truncated");
}

static rheo_result read_failure_metrics(rheo_recording *r, double *values, rheo_error *error)
{
    rheo__chunk chunk;
    bool truncated;
    rheo_failure failure;
    uint32_t inputs;
    RHEO__TRY(rheo__chunk_at(&r->reader, r->failed.offset, &chunk, &truncated, error));
    RHEO__TRY(rheo__chunk_read(&r->reader, &chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    if (!rheo__failure_get(&cursor, &failure, &inputs, values, r->head.metric_count))
        return rheo__chunk_damaged(&chunk, "cannot be read", error);
    return RHEO_OK;
}

rheo_result rheo_recording_metrics(rheo_recording *r, uint64_t step, double *values, rheo_error *error)
{
    if (r->has_failure && step == r->failure.step)
        return read_failure_metrics(r, values, error);
    RHEO__TRY(rheo__recording_check_step(r, step, error));
    if (step == r->first_step)
        return rheo__keyframe_read(r, &r->keyframes[0], NULL, values, NULL, error);
    RHEO__TRY(rheo__recording_read_step(r, (size_t)(step - r->first_step - 1), error));
    memcpy(values, r->metrics, r->head.metric_count * sizeof *values);
    return RHEO_OK;
}
