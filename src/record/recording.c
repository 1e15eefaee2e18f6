/*
 * Reading recordings. Opening walks over the headers of all chunks and remembers where keyframes and steps
 * are; only small chunks are read then, all others when they are used, and each with its check sum. A step
 * counts when its STEP is there, a keyframe when its KEYF is: both stand behind what belongs to them, so that
 * a truncated file ends with the last whole one.
 */
#include "record/recording.h"

#include <stdlib.h>
#include <string.h>

/* ---- The walk over all chunks ---- */

/* Chunks seen since the last STEP or KEYF, which are to be claimed by the next one. */
typedef struct pending {
    uint64_t start, raw;
    uint64_t fields;
    uint32_t inputs, states;
} pending;

typedef struct walk {
    rheo_recording *r;
    bool thorough;
    bool damaged; /* by a fault, not by the end of the file */
    pending pending;
    uint64_t indexed; /* keyframes that the index has named */
    bool ending;      /* the failure or a blessing has been seen: no step can follow */
    bool done;
} walk;

static rheo_result damage(const rheo__chunk *chunk, const char *what, rheo_error *error)
{
    char name[5];
    rheo__chunk_name(chunk->type, name);
    return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the chunk %s at byte %llu %s", name,
                      (unsigned long long)chunk->at, what);
}

static rheo_result grow(void **memory, size_t *capacity, size_t count, size_t size, rheo_error *error)
{
    if (count < *capacity)
        return RHEO_OK;
    size_t wanted = count + count / 2 + 16;
    void *larger = wanted <= SIZE_MAX / size ? realloc(*memory, wanted * size) : NULL;
    if (!larger)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the index of the recording");
    *memory = larger;
    *capacity = wanted;
    return RHEO_OK;
}

static bool nothing_pending(const pending *p)
{
    return p->fields == 0 && p->inputs == 0 && p->states == 0;
}

static rheo_result see_head(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    RHEO__TRY(rheo__head_get(&cursor, &r->head, error));
    r->metrics = calloc(r->head.metric_count + (size_t)1, sizeof *r->metrics);
    if (!r->metrics)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to open the recording");
    return RHEO_OK;
}

static rheo_result see_keyframe(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    rheo__keyframe k = {.step = chunk->step, .start = w->pending.start, .at = chunk->at, .end = chunk->end};
    k.raw = w->pending.raw;
    bool first = r->keyframe_count == 0;
    RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    rheo__keyframe_get(&cursor, &k);
    if (cursor.failed || k.chunks != w->pending.fields || w->pending.inputs || w->pending.states)
        return damage(chunk, "does not belong to what is before it", error);
    if (first && k.step > INT64_MAX) /* the steps that follow can be counted */
        return damage(chunk, "has a step that no run comes to", error);
    if (w->ending ||
        (!first && (chunk->step != r->last_step || r->keyframes[r->keyframe_count - 1].step == chunk->step)))
        return damage(chunk, "is not the keyframe of the step before it", error);
    RHEO__TRY(rheo__keyframe_read(r, &k, NULL, NULL, first ? &r->def : NULL, error));
    void *keyframes = r->keyframes;
    RHEO__TRY(grow(&keyframes, &r->keyframe_capacity, r->keyframe_count, sizeof k, error));
    r->keyframes = keyframes;
    r->keyframes[r->keyframe_count++] = k;
    r->keyframe_bytes += k.end - k.start;
    r->end = k.end;
    if (first)
        r->first_step = r->last_step = k.step;
    return RHEO_OK;
}

static rheo_result see_step(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    if (r->keyframe_count == 0 || chunk->step != r->last_step + 1 || w->pending.fields || w->ending)
        return damage(chunk, "is not the next step; one is missing", error);
    rheo__step_place place = {w->pending.start, chunk->at, w->pending.raw, w->pending.inputs, w->pending.states};
    void *steps = r->steps;
    RHEO__TRY(grow(&steps, &r->step_capacity, r->step_count, sizeof place, error));
    r->steps = steps;
    r->steps[r->step_count] = place;
    if (w->thorough)
        RHEO__TRY(rheo__recording_read_step(r, r->step_count, error));
    r->step_count++;
    r->step_bytes += chunk->end - place.start;
    r->last_step++;
    r->end = chunk->end;
    return RHEO_OK;
}

static rheo_result see_failure(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    uint32_t inputs;
    bool right = rheo__failure_get(&cursor, &r->failure, &inputs, r->metrics, r->head.metric_count);
    if (!right || r->keyframe_count == 0 || chunk->step != r->last_step + 1 || inputs != w->pending.inputs ||
        w->pending.fields || w->pending.states || w->ending)
        return damage(chunk, "is not the failure of the step after the last", error);
    r->failure.step = chunk->step;
    r->failed = (rheo__step_place){w->pending.start, chunk->at, 0, inputs, 0};
    r->has_failure = w->ending = true;
    r->end = chunk->end;
    return RHEO_OK;
}

static rheo_result see_blessing(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));
    if (!nothing_pending(&w->pending) || r->keyframe_count == 0 || chunk->step != r->last_step)
        return damage(chunk, "does not stand at the end of the recording", error);
    w->ending = true;
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    return rheo__blessing_get(&cursor, r, error);
}

static rheo_result see_index(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    bool right = nothing_pending(&w->pending) && chunk->step == r->last_step;
    while (right && rheo__cursor_left(&cursor)) {
        if (w->indexed >= r->keyframe_count)
            return damage(chunk, "names more keyframes than there are", error);
        const rheo__keyframe *k = &r->keyframes[w->indexed++];
        right = rheo__get_u64(&cursor) == k->step;
        right = rheo__get_u64(&cursor) == k->start && right;
        right = rheo__get_u64(&cursor) == k->end && right;
    }
    return right ? RHEO_OK : damage(chunk, "is not the index of this recording", error);
}

static rheo_result see_done(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    bool right = rheo__get_u64(&cursor) == r->first_step;
    right = rheo__get_u64(&cursor) == r->last_step && right;
    r->last_hash = rheo__get_u64(&cursor);
    r->has_last_hash = rheo__get_u32(&cursor) == 1;
    if (!right || cursor.failed || rheo__cursor_left(&cursor) || chunk->step != r->last_step ||
        r->keyframe_count == 0 || w->indexed != r->keyframe_count || !nothing_pending(&w->pending))
        return damage(chunk, "does not fit the recording that it ends", error);
    if (chunk->end != r->reader.size)
        return damage(chunk, "is the end mark, but more bytes follow", error);
    w->done = true;
    return RHEO_OK;
}

static rheo_result see(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    bool first = chunk->at == RHEO__MAGIC_SIZE;
    bool pieces = chunk->type == RHEO__FILD || chunk->type == RHEO__STAT || chunk->type == RHEO__INPT;
    if (first != (chunk->type == RHEO__HEAD))
        return damage(chunk, first ? "stands where HEAD should" : "is there twice", error);
    if (w->indexed && chunk->type != RHEO__INDX && chunk->type != RHEO__DONE && rheo__chunk_known(chunk->type))
        return damage(chunk, "follows the index", error);
    if (pieces) {
        if (nothing_pending(&w->pending))
            w->pending = (pending){.start = chunk->at};
        w->pending.raw += chunk->raw;
        w->pending.fields += chunk->type == RHEO__FILD;
        w->pending.states += chunk->type == RHEO__STAT;
        w->pending.inputs += chunk->type == RHEO__INPT;
    } else if (nothing_pending(&w->pending)) {
        w->pending = (pending){.start = chunk->at};
    }
    /* Check sums of what is not read anyway. An unknown type may be known, but damaged. */
    if ((w->thorough && pieces) || !rheo__chunk_known(chunk->type))
        RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));

    switch (chunk->type) {
    case RHEO__HEAD:
        return see_head(w, chunk, error);
    case RHEO__KEYF:
        RHEO__TRY(see_keyframe(w, chunk, error));
        break;
    case RHEO__STEP:
        RHEO__TRY(see_step(w, chunk, error));
        break;
    case RHEO__FAIL:
        RHEO__TRY(see_failure(w, chunk, error));
        break;
    case RHEO__BLES:
        return see_blessing(w, chunk, error);
    case RHEO__INDX:
        return see_index(w, chunk, error);
    case RHEO__DONE:
        return see_done(w, chunk, error);
    case RHEO__FILD:
    case RHEO__STAT:
    case RHEO__INPT:
        return RHEO_OK;
    default:
        if (chunk->flags & RHEO__CHUNK_OPTIONAL)
            return RHEO_OK;
        char name[5];
        rheo__chunk_name(chunk->type, name);
        return rheo__fail(error, RHEO_ERROR_FORMAT,
                          "the chunk %s at byte %llu is not known to rheolog " RHEO_VERSION
                          " and must not be skipped; a newer one can read it",
                          name, (unsigned long long)chunk->at);
    }
    w->pending = (pending){0};
    return RHEO_OK;
}

/* Whether the file ends with a valid end mark: then it is not truncated, whatever a length before it says. */
static bool ends_with_mark(rheo_recording *r)
{
    enum { MARK = 64 }; /* bytes of DONE */
    rheo__chunk chunk;
    bool truncated;
    uint64_t size = r->reader.size;
    return size > MARK && rheo__chunk_at(&r->reader, size - MARK, &chunk, &truncated, NULL) == RHEO_OK &&
           chunk.type == RHEO__DONE && chunk.end == size &&
           rheo__chunk_read(&r->reader, &chunk, &r->payload, NULL) == RHEO_OK;
}

static rheo_result walk_chunks(walk *w, rheo_error *error)
{
    rheo__reader *reader = &w->r->reader;
    uint8_t magic[RHEO__MAGIC_SIZE];
    size_t there = reader->size < sizeof magic ? (size_t)reader->size : sizeof magic;
    w->damaged = true;
    RHEO__TRY(rheo__reader_read(reader, 0, magic, there, error));
    if (memcmp(magic, rheo__magic, there) != 0 || there == 0)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "this is not a recording: it does not begin as one");
    for (uint64_t at = there; !w->done;) {
        rheo__chunk chunk;
        bool truncated;
        rheo_result result = rheo__chunk_at(reader, at, &chunk, &truncated, error);
        w->damaged = !truncated;
        if (truncated && ends_with_mark(w->r)) {
            w->damaged = true;
            return rheo__fail(error, RHEO_ERROR_FORMAT,
                              "damaged: the chunk at byte %llu would reach past the end mark",
                              (unsigned long long)at);
        }
        RHEO__TRY(result);
        w->damaged = true;
        RHEO__TRY(see(w, &chunk, error));
        at = chunk.end;
    }
    w->damaged = false;
    return RHEO_OK;
}

rheo_result rheo__recording_scan(rheo_recording *r, bool thorough, bool *damaged, rheo_error *error)
{
    walk w = {.r = r, .thorough = thorough};
    rheo_result result = walk_chunks(&w, &r->fault);
    *damaged = w.damaged;
    r->complete = result == RHEO_OK;
    if (r->complete)
        return RHEO_OK;
    bool system = result != RHEO_ERROR_FORMAT && result != RHEO_ERROR_UNSUPPORTED;
    if (system || r->keyframe_count == 0)
        return rheo__fail(error, result, "%s", r->fault.message);
    return RHEO_OK;
}

/* ---- Opening ---- */

static rheo_result scan_new(rheo_recording *r, rheo_recording **recording, rheo_error *error)
{
    bool damaged;
    rheo_result result = rheo__recording_scan(r, false, &damaged, error);
    if (result == RHEO_OK && damaged)
        result = rheo__fail(error, RHEO_ERROR_FORMAT, "%s", r->fault.message);
    if (result != RHEO_OK)
        rheo_recording_close(r);
    else
        *recording = r;
    return result;
}

rheo_result rheo_recording_open(const char *path, rheo_recording **recording, rheo_error *error)
{
    *recording = NULL;
    rheo_recording *r = calloc(1, sizeof *r);
    if (!r)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to open '%.300s'", path);
    rheo_result result = rheo__reader_open(&r->reader, path, error);
    if (result != RHEO_OK) {
        free(r);
        return result;
    }
    return scan_new(r, recording, error);
}

rheo_result rheo_recording_open_memory(const void *bytes, size_t size, rheo_recording **recording, rheo_error *error)
{
    *recording = NULL;
    rheo_recording *r = calloc(1, sizeof *r);
    if (!r)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to open a recording");
    r->reader = (rheo__reader){.memory = bytes, .size = size};
    return scan_new(r, recording, error);
}

void rheo_recording_close(rheo_recording *r)
{
    if (!r)
        return;
    rheo__reader_close(&r->reader);
    rheo__head_release(&r->head);
    rheo__bytes_release(&r->payload);
    rheo__blessings_release(r);
    rheo__values_release(&r->before);
    rheo__values_release(&r->now);
    free(r->keyframes);
    free(r->steps);
    free(r->expected);
    free(r->metrics);
    free(r);
}

/* ---- What is in it ---- */

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
                      r->complete ? "" : ", then it is truncated");
}

static rheo_result read_failure_metrics(rheo_recording *r, double *values, rheo_error *error)
{
    rheo__chunk chunk;
    bool truncated;
    rheo_failure failure;
    uint32_t inputs;
    RHEO__TRY(rheo__chunk_at(&r->reader, r->failed.at, &chunk, &truncated, error));
    RHEO__TRY(rheo__chunk_read(&r->reader, &chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    if (!rheo__failure_get(&cursor, &failure, &inputs, values, r->head.metric_count))
        return damage(&chunk, "cannot be read", error);
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

/* ---- Steps ---- */

rheo_result rheo__recording_read_step(rheo_recording *r, size_t index, rheo_error *error)
{
    const rheo__step_place *place = &r->steps[index];
    rheo__chunk chunk;
    bool truncated;
    RHEO__TRY(rheo__chunk_at(&r->reader, place->at, &chunk, &truncated, error));
    RHEO__TRY(rheo__chunk_read(&r->reader, &chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    uint32_t inputs = rheo__get_u32(&cursor), states = rheo__get_u32(&cursor);
    /* What lies before the metrics is hashes, those of each substep as many as of another. */
    const size_t hashes = rheo__cursor_left(&cursor) / 8 - r->head.metric_count, once = r->head.trace_once,
                 repeated = r->head.trace_repeated;
    if (rheo__cursor_left(&cursor) / 8 < r->head.metric_count + once + repeated ||
        (repeated ? (hashes - once) % repeated != 0 : hashes != once))
        return damage(&chunk, "does not have the hashes of its stages", error);
    void *expected = r->expected;
    RHEO__TRY(grow(&expected, &r->expected_capacity, hashes, sizeof *r->expected, error));
    r->expected = expected;
    r->expected_count = hashes;
    for (size_t i = 0; i < hashes; i++)
        r->expected[i] = rheo__get_u64(&cursor);
    for (uint32_t i = 0; i < r->head.metric_count; i++)
        r->metrics[i] = rheo__get_f64(&cursor);
    if (cursor.failed || rheo__cursor_left(&cursor) || inputs != place->inputs || states != place->states)
        return damage(&chunk, "does not belong to what is before it", error);
    return RHEO_OK;
}

/* The next command of a step at or after *at, in r->payload; *more says whether there is one. */
static rheo_result next_command(rheo_recording *r, const rheo__step_place *place, uint64_t step, uint64_t *at,
                                bool *more, rheo_error *error)
{
    *more = false;
    while (*at < place->at && !*more) {
        rheo__chunk chunk;
        bool truncated;
        RHEO__TRY(rheo__chunk_at(&r->reader, *at, &chunk, &truncated, error));
        *at = chunk.end;
        if (chunk.type != RHEO__INPT)
            continue;
        if (chunk.step != step)
            return damage(&chunk, "belongs to another step", error);
        RHEO__TRY(rheo__chunk_read(&r->reader, &chunk, &r->payload, error));
        *more = true;
    }
    return RHEO_OK;
}

rheo_result rheo__recording_command(rheo_recording *r, const rheo__step_place *place, uint64_t step,
                                    rheo_world *world, rheo_error *error)
{
    bool more = true;
    for (uint64_t at = place->start; more;) {
        RHEO__TRY(next_command(r, place, step, &at, &more, error));
        rheo__cursor cursor = rheo__cursor_over(&r->payload);
        if (more)
            RHEO__TRY(rheo__command_apply(&cursor, world, error));
    }
    return RHEO_OK;
}

rheo_result rheo__recording_define(rheo_recording *r, const rheo__step_place *place, uint64_t step,
                                   rheo_world_def *def, bool *moves, rheo_error *error)
{
    bool more = place->inputs > 0;
    *moves = false;
    for (uint64_t at = place->start; more;) {
        RHEO__TRY(next_command(r, place, step, &at, &more, error));
        rheo__cursor cursor = rheo__cursor_over(&r->payload);
        if (more)
            RHEO__TRY(rheo__command_define(&cursor, step, def, moves, error));
    }
    return RHEO_OK;
}

rheo_result rheo__recording_read_state(rheo_recording *r, size_t index, uint32_t present, const rheo__values *before,
                                       rheo__values *now, rheo_error *error)
{
    const rheo__step_place *place = &r->steps[index];
    rheo__pieces_reader pieces = {.reader = &r->reader,
                                  .type = RHEO__STAT,
                                  .step = r->first_step + 1 + index,
                                  .at = place->start,
                                  .end = place->at};
    rheo_result result = rheo__full_read(&pieces, present, place->raw, before, now, error);
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
    /* An stage_run that is not reached has no hash that differs. */
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
    uint64_t stage_run;
    rheo__field_id field;
    rheo__world_trace_entry(world, different, &stage_run, &field);
    rheo__world_stage_run_name(world, stage_run, name);
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
        return rheo__full_restore(r, step, &r->now, world, error);
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
    while (result == RHEO_OK && rheo_world_step_count(w) < step)
        result = rheo__recording_forward(r, (size_t)(rheo_world_step_count(w) - r->first_step), w, error);
    if (result == RHEO_OK)
        *world = w;
    else
        rheo_world_destroy(w);
    return result;
}
