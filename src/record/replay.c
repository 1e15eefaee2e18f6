/* Replaying a recording: the commands of a step, the step itself, and the world at any step. */
#include "core/progress.h"
#include "record/recording.h"

rheo_result rheo__recording_next_command(rheo_recording *r, const rheo__step_chunks *chunks, uint64_t step,
                                         uint64_t *offset, bool *more, rheo_error *error)
{
    *more = false;
    while (*offset < chunks->offset && !*more) {
        rheo__chunk chunk;
        bool truncated;
        RHEO__TRY(rheo__chunk_at(&r->reader, *offset, &chunk, &truncated, error));
        *offset = chunk.end;
        if (chunk.type != RHEO__INPT)
            continue;
        if (chunk.step != step)
            return rheo__chunk_damaged(&chunk, "belongs to another step", error);
        RHEO__TRY(rheo__chunk_read(&r->reader, &chunk, &r->payload, error));
        *more = true;
    }
    return RHEO_OK;
}

rheo_result rheo__recording_command(rheo_recording *r, const rheo__step_chunks *chunks, uint64_t step,
                                    rheo_world *world, rheo_error *error)
{
    bool more = true;
    for (uint64_t offset = chunks->start; more;) {
        RHEO__TRY(rheo__recording_next_command(r, chunks, step, &offset, &more, error));
        rheo__cursor cursor = rheo__cursor_over(&r->payload);
        if (more)
            RHEO__TRY(rheo__command_apply(&cursor, world, error));
    }
    return RHEO_OK;
}

rheo_result rheo__recording_read_state(rheo_recording *r, size_t index, rheo__fields present,
                                       const rheo__values *before, rheo__values *now, rheo_error *error)
{
    const rheo__step_chunks *chunks = &r->steps[index];
    rheo__pieces_reader pieces = {.reader = &r->reader,
                                  .type = RHEO__STAT,
                                  .step = r->first_step + 1 + index,
                                  .offset = chunks->start,
                                  .end = chunks->offset};
    rheo_result result = rheo__full_read(&pieces, present, chunks->raw, before, now, error);
    rheo__bytes_release(&pieces.bytes);
    return result;
}

rheo_result rheo__recording_replay(rheo_recording *r, size_t index, rheo_world *world, size_t *different,
                                   rheo_error *error)
{
    *different = RHEO__NO_HASH;
    RHEO__TRY(rheo__recording_command(r, &r->steps[index], r->first_step + 1 + index, world, error));
    RHEO__TRY(rheo__recording_read_step(r, index, error));
    rheo_result result = rheo__world_step_traced(world, r->expected, r->expected_count, error);
    /* A stage run that is not reached has no hash that differs. */
    for (size_t i = 0; i < world->trace.count && *different == RHEO__NO_HASH; i++)
        if (i >= r->expected_count || world->trace.hash[i] != r->expected[i])
            *different = i;
    if (result == RHEO_OK && *different == RHEO__NO_HASH && world->trace.count != r->expected_count)
        return rheo__recording_too_many(r, r->first_step + 1 + index, error);
    return result;
}

rheo_result rheo__recording_too_many(const rheo_recording *r, uint64_t step, rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_FORMAT,
                      "damaged: step %llu has %zu hashes, those of more substeps than it says to have had",
                      (unsigned long long)step, r->expected_count);
}

rheo_result rheo__recording_differs(const rheo_world *world, uint64_t step, size_t different, rheo_error *error)
{
    char name[32];
    rheo__field_id field;
    rheo__world_trace_entry(world, rheo__world_substeps(world), different, name, &field);
    return rheo__fail(error, RHEO_ERROR_DIFFERS, "step %llu is not as it was recorded: stage %s gives another %s",
                      (unsigned long long)step, name, rheo__field_table[field].name);
}

rheo_result rheo__recording_forward(rheo_recording *r, size_t index, rheo_world *world, rheo_error *error)
{
    uint64_t step = r->first_step + 1 + index;
    if (r->head.full) {
        RHEO__TRY(rheo__values_take(&r->before, &world->state, false, error));
        RHEO__TRY(rheo__recording_command(r, &r->steps[index], step, world, error));
        RHEO__TRY(rheo__recording_read_step(r, index, error));
        RHEO__TRY(rheo__recording_read_state(r, index, world->state.present, &r->before, &r->now, error));
        return rheo__full_restore(r, step, &r->now, 0, world, error);
    }
    size_t different;
    RHEO__TRY(rheo__recording_replay(r, index, world, &different, error));
    return different != RHEO__NO_HASH ? rheo__recording_differs(world, step, different, error) : RHEO_OK;
}

size_t rheo__recording_nearest(const rheo_recording *r, uint64_t step)
{
    size_t nearest = r->keyframe_count - 1;
    while (nearest > 0 && r->keyframes[nearest].step > step)
        nearest--;
    return nearest;
}

rheo_result rheo_recording_world(rheo_recording *r, uint64_t step, const rheo_allocator *allocator,
                                 rheo_world **world, rheo_error *error)
{
    *world = NULL;
    RHEO__TRY(rheo__recording_check_step(r, step, error));
    rheo_world *w;
    RHEO__TRY(rheo__keyframe_world(r, &r->keyframes[rheo__recording_nearest(r, step)], allocator, &w, error));
    rheo_result result = RHEO_OK;
    const uint64_t from = rheo_world_step_count(w);
    while (result == RHEO_OK && rheo_world_step_count(w) < step) {
        result = rheo__recording_forward(r, (size_t)(rheo_world_step_count(w) - r->first_step), w, error);
        if (result == RHEO_OK)
            result = rheo__progress("simulating", rheo_world_step_count(w) - from, step - from, error);
    }
    if (result == RHEO_OK)
        *world = w;
    else
        rheo_world_destroy(w);
    return result;
}
