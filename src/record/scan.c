/*
 * Scanning a recording: walks over the headers of all chunks and notes where keyframes and steps are. Only small
 * chunks are read then; all others are read when they are used, each with its check sum. A step counts when its STEP
 * is there, a keyframe when its KEYF is. Both follow their data, so a truncated file ends with the last complete one.
 */
#include "record/recording.h"

#include <stdlib.h>
#include <string.h>

#include "core/text.h"

/* ---- The walk over all chunks ---- */

/* Chunks since the last STEP or KEYF; the next one claims them. */
typedef struct pending {
    uint64_t start, raw;
    uint64_t fields;
    uint32_t inputs, states;
} pending;

typedef struct walk {
    rheo_recording *r;
    bool thorough;
    bool damaged; /* there is a fault other than a missing end */
    pending pending;
    uint64_t indexed; /* keyframes that the index has listed */
    bool ending;      /* the failure or a blessing was read: no step can follow */
    bool done;
} walk;

rheo_result rheo__chunk_damaged(const rheo__chunk *chunk, const char *fault, rheo_error *error)
{
    char name[5];
    rheo__chunk_name(chunk->type, name);
    return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: the chunk %s at byte %llu %s", name,
                      (unsigned long long)chunk->offset, fault);
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

rheo_result rheo__recording_read_step(rheo_recording *r, size_t index, rheo_error *error)
{
    const rheo__step_chunks *chunks = &r->steps[index];
    rheo__chunk chunk;
    bool truncated;
    RHEO__TRY(rheo__chunk_at(&r->reader, chunks->offset, &chunk, &truncated, error));
    RHEO__TRY(rheo__chunk_read(&r->reader, &chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    uint32_t inputs = rheo__get_u32(&cursor), states = rheo__get_u32(&cursor);
    /* The data before the metrics are hashes; all substeps have the same number of them. */
    const size_t hashes = rheo__cursor_left(&cursor) / 8 - r->head.metric_count, once = r->head.trace_once,
                 repeated = r->head.trace_repeated;
    if (rheo__cursor_left(&cursor) / 8 < r->head.metric_count + once + repeated ||
        (repeated ? (hashes - once) % repeated != 0 : hashes != once))
        return rheo__chunk_damaged(&chunk, "does not have the hashes of its stages", error);
    void *expected = r->expected;
    RHEO__TRY(grow(&expected, &r->expected_capacity, hashes, sizeof *r->expected, error));
    r->expected = expected;
    r->expected_count = hashes;
    for (size_t i = 0; i < hashes; i++)
        r->expected[i] = rheo__get_u64(&cursor);
    for (uint32_t i = 0; i < r->head.metric_count; i++)
        r->metrics[i] = rheo__get_f64(&cursor);
    if (cursor.failed || rheo__cursor_left(&cursor) || inputs != chunks->inputs || states != chunks->states)
        return rheo__chunk_damaged(&chunk, "does not match the chunks before it", error);
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
    r->head_end = chunk->end;
    return RHEO_OK;
}

static rheo_result see_golden(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    if (r->keyframe_count || !nothing_pending(&w->pending) || r->golden)
        return rheo__chunk_damaged(chunk, "does not follow HEAD", error);
    RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));
    r->golden = true;
    return RHEO_OK;
}

static rheo_result see_made(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    if (r->keyframe_count || !nothing_pending(&w->pending) || r->made.by)
        return rheo__chunk_damaged(chunk, "does not follow HEAD", error);
    RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    return rheo__made_get(&cursor, &r->made, error);
}

static rheo_result see_members(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    if (r->keyframe_count || !nothing_pending(&w->pending) || r->members)
        return rheo__chunk_damaged(chunk, "does not follow HEAD", error);
    RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    r->members_start = chunk->offset;
    r->members_end = chunk->end;
    return rheo__members_get(&cursor, &r->members, error);
}

static rheo_result see_keyframe(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    rheo__keyframe k = {.step = chunk->step, .start = w->pending.start, .offset = chunk->offset, .end = chunk->end};
    k.raw = w->pending.raw;
    bool first = r->keyframe_count == 0;
    RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    rheo__keyframe_get(&cursor, &k);
    if (cursor.failed || k.chunks != w->pending.fields || w->pending.inputs || w->pending.states)
        return rheo__chunk_damaged(chunk, "does not match the chunks before it", error);
    if (first && k.step > INT64_MAX) /* numbers of later steps must not overflow */
        return rheo__chunk_damaged(chunk, "has a step that no run reaches", error);
    if (w->ending ||
        (!first && (chunk->step != r->last_step || r->keyframes[r->keyframe_count - 1].step == chunk->step)))
        return rheo__chunk_damaged(chunk, "is not the keyframe of the step before it", error);
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
        return rheo__chunk_damaged(chunk, "is not the next step; one is missing", error);
    rheo__step_chunks chunks = {w->pending.start, chunk->offset, w->pending.raw, w->pending.inputs,
                                w->pending.states};
    void *steps = r->steps;
    RHEO__TRY(grow(&steps, &r->step_capacity, r->step_count, sizeof chunks, error));
    r->steps = steps;
    r->steps[r->step_count] = chunks;
    if (w->thorough)
        RHEO__TRY(rheo__recording_read_step(r, r->step_count, error));
    if (chunks.inputs) {
        void *commanded = r->commanded;
        RHEO__TRY(grow(&commanded, &r->commanded_capacity, r->commanded_count, sizeof *r->commanded, error));
        r->commanded = commanded;
        r->commanded[r->commanded_count++] = (rheo__commanded){r->step_count, r->command_count};
        r->command_count += chunks.inputs;
    }
    r->step_count++;
    r->step_bytes += chunk->end - chunks.start;
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
        return rheo__chunk_damaged(chunk, "is not the failure of the step after the last", error);
    r->failure.step = chunk->step;
    r->failure.model = r->def.model;
    r->failed = (rheo__step_chunks){w->pending.start, chunk->offset, 0, inputs, 0};
    r->has_failure = w->ending = true;
    r->end = chunk->end;
    return RHEO_OK;
}

static rheo_result see_blessing(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));
    if (!nothing_pending(&w->pending) || r->keyframe_count == 0 || chunk->step != r->last_step)
        return rheo__chunk_damaged(chunk, "is not at the end of the recording", error);
    w->ending = true;
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    return rheo__blessing_get(&cursor, r, error);
}

static rheo_result see_same(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    RHEO__TRY(rheo__chunk_read(&w->r->reader, chunk, &w->r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&w->r->payload);
    return rheo__same_get(&cursor, w->r, error);
}

static rheo_result see_index(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));
    rheo__cursor cursor = rheo__cursor_over(&r->payload);
    bool right = nothing_pending(&w->pending) && chunk->step == r->last_step;
    while (right && rheo__cursor_left(&cursor)) {
        if (w->indexed >= r->keyframe_count)
            return rheo__chunk_damaged(chunk, "names more keyframes than there are", error);
        const rheo__keyframe *k = &r->keyframes[w->indexed++];
        right = rheo__get_u64(&cursor) == k->step;
        right = rheo__get_u64(&cursor) == k->start && right;
        right = rheo__get_u64(&cursor) == k->end && right;
    }
    return right ? RHEO_OK : rheo__chunk_damaged(chunk, "is not the index of this recording", error);
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
        return rheo__chunk_damaged(chunk, "does not fit the recording that it ends", error);
    if (chunk->end != r->reader.size || r->reader.zeros)
        return rheo__chunk_damaged(chunk, "is the end mark, but more bytes follow", error);
    w->done = true;
    return RHEO_OK;
}

static rheo_result see(walk *w, const rheo__chunk *chunk, rheo_error *error)
{
    rheo_recording *r = w->r;
    bool first = chunk->offset == RHEO__MAGIC_SIZE;
    bool pieces = chunk->type == RHEO__FILD || chunk->type == RHEO__STAT || chunk->type == RHEO__INPT;
    if (first != (chunk->type == RHEO__HEAD))
        return rheo__chunk_damaged(chunk, first ? "is in the place of HEAD" : "is there twice", error);
    if (w->indexed && chunk->type != RHEO__INDX && chunk->type != RHEO__DONE && rheo__chunk_known(chunk->type))
        return rheo__chunk_damaged(chunk, "follows the index", error);
    if (pieces) {
        if (nothing_pending(&w->pending))
            w->pending = (pending){.start = chunk->offset};
        w->pending.raw += chunk->raw;
        w->pending.fields += chunk->type == RHEO__FILD;
        w->pending.states += chunk->type == RHEO__STAT;
        w->pending.inputs += chunk->type == RHEO__INPT;
    } else if (nothing_pending(&w->pending)) {
        w->pending = (pending){.start = chunk->offset};
    }
    /* Checks the sums of chunks that are not read otherwise. An unknown type may be a known one that is damaged. */
    if ((w->thorough && pieces) || !rheo__chunk_known(chunk->type))
        RHEO__TRY(rheo__chunk_read(&r->reader, chunk, &r->payload, error));

    switch (chunk->type) {
    case RHEO__HEAD:
        return see_head(w, chunk, error);
    case RHEO__GOLD:
        return see_golden(w, chunk, error);
    case RHEO__MADE:
        return see_made(w, chunk, error);
    case RHEO__MEMB:
        return see_members(w, chunk, error);
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
    case RHEO__SAME:
        return see_same(w, chunk, error);
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
        return rheo__fail(error, RHEO_ERROR_UNSUPPORTED,
                          "the chunk %s at byte %llu is not known to rheolog " RHEO_VERSION
                          " and must not be skipped; a newer one can read it",
                          name, (unsigned long long)chunk->offset);
    }
    w->pending = (pending){0};
    return RHEO_OK;
}

/*
 * Whether the file ends with a valid end mark. Then it is not truncated, even if an earlier length exceeds the file.
 */
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

/* Tells what has probably happened to a file that does not begin as a recording. */
static rheo_result no_recording(rheo__reader *reader, const uint8_t *magic, rheo_error *error)
{
    enum { LETTERS = 5 }; /* of the magic, before its line end */
    static const char POINTER[] = "version https://git-lfs";
    char begin[sizeof POINTER - 1];
    if (reader->size == 0)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "this is not a recording: the file %s",
                          reader->zeros ? "has nothing but zeros" : "is empty");
    if (reader->size >= LETTERS && memcmp(magic, rheo__magic, LETTERS) == 0)
        return rheo__fail(error, RHEO_ERROR_FORMAT,
                          "damaged: its line ends were converted, as in a text; mark it as binary (.gitattributes: "
                          "*.rlog binary)");
    if (reader->size >= sizeof begin) {
        RHEO__TRY(rheo__reader_read(reader, 0, begin, sizeof begin, error));
        if (memcmp(begin, POINTER, sizeof begin) == 0)
            return rheo__fail(error, RHEO_ERROR_UNSUPPORTED, /* nothing is wrong with the file */
                              "this is not a recording but a pointer of git-lfs to one; `git lfs pull` fetches it");
    }
    return rheo__fail(error, RHEO_ERROR_FORMAT, "this is not a recording: it does not begin as one");
}

/* Whether the last chunk of the file has lost its last bytes: they are zeros, and its sum is not right. */
static bool has_lost_its_end(rheo_recording *r, const rheo__chunk *chunk)
{
    uint8_t last = 1;
    return chunk->end == r->reader.size && rheo__reader_read(&r->reader, chunk->end - 1, &last, 1, NULL) == RHEO_OK &&
           last == 0 && rheo__chunk_read(&r->reader, chunk, &r->payload, NULL) == RHEO_ERROR_FORMAT;
}

static rheo_result walk_chunks(walk *w, rheo_error *error)
{
    rheo__reader *reader = &w->r->reader;
    uint8_t magic[RHEO__MAGIC_SIZE];
    size_t there = reader->size < sizeof magic ? (size_t)reader->size : sizeof magic;
    w->damaged = true;
    RHEO__TRY(rheo__reader_read(reader, 0, magic, there, error));
    if (memcmp(magic, rheo__magic, there) != 0 || there == 0)
        return no_recording(reader, magic, error);
    for (uint64_t offset = there; !w->done;) {
        rheo__chunk chunk;
        bool truncated;
        rheo_result result = rheo__chunk_at(reader, offset, &chunk, &truncated, error);
        w->damaged = !truncated;
        if (truncated && ends_with_mark(w->r)) {
            w->damaged = true;
            return rheo__fail(error, RHEO_ERROR_FORMAT,
                              "damaged: the chunk at byte %llu would reach past the end mark",
                              (unsigned long long)offset);
        }
        RHEO__TRY(result);
        w->damaged = !has_lost_its_end(w->r, &chunk);
        if (!w->damaged)
            return rheo__fail(error, RHEO_ERROR_FORMAT, "truncated: the last chunk, at byte %llu, ends with zeros",
                              (unsigned long long)offset);
        RHEO__TRY(see(w, &chunk, error));
        offset = chunk.end;
    }
    w->damaged = false;
    return RHEO_OK;
}

rheo_result rheo__recording_scan(rheo_recording *r, bool thorough, bool *damaged, rheo_error *error)
{
    walk w = {.r = r, .thorough = thorough};
    rheo_result result = walk_chunks(&w, &r->fault);
    *damaged = w.damaged;
    r->fault_result = result;
    r->complete = result == RHEO_OK;
    if (r->complete)
        return RHEO_OK;
    if (result == RHEO_ERROR_FORMAT && !w.damaged && r->reader.growing)
        r->fault_result = rheo__fail(&r->fault, RHEO_ERROR_ARGUMENT, "still being written: %llu step%s so far",
                                     (unsigned long long)(r->last_step - r->first_step),
                                     rheo__plural(r->last_step - r->first_step));
    bool system = result != RHEO_ERROR_FORMAT && result != RHEO_ERROR_UNSUPPORTED;
    if (system || r->keyframe_count == 0)
        return rheo__fail(error, r->fault_result, "%s", r->fault.message);
    return RHEO_OK;
}
