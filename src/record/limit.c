/*
 * The limit of a recording's bytes. Before something is written that does not fit, keyframes are left out: the distance
 * from one to the next is doubled until it fits. The first keyframe, with which the file begins, and the newest one
 * always remain, and so do all steps.
 *
 * The choice depends only on the bytes in the file and those to be written. So a run that was interrupted and continued
 * with the same limit has the bytes of one that was not.
 *
 * The thinned file is written beside the old one and renamed. A program that is killed leaves the old file or the new
 * one, and a reader that has the old one open keeps it.
 */
#define _XOPEN_SOURCE 700 /* realpath() */
#define _FILE_OFFSET_BITS 64

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "record/lock.h"
#include "record/recorder.h"

enum { ENTRY = 24, MEMBER_BYTES = 36, DONE_BYTES = MEMBER_BYTES + 28, SPACING_IN_HEAD = 12, PORTION = 1 << 20 };

/* ---- Sizes ---- */

/* Bytes of FAIL, INDX and DONE, which must fit at any time. */
static uint64_t end_bytes(const rheo_recorder *r, uint64_t keyframes)
{
    const uint64_t failure = MEMBER_BYTES + 40 + sizeof r->failure.stage + sizeof r->failure.field +
                             8 * (uint64_t)rheo_world_metric_count(r->world),
                   most = RHEO__PIECE / ENTRY;
    return failure + (keyframes + most - 1) / most * MEMBER_BYTES + keyframes * ENTRY + DONE_BYTES;
}

static size_t keyframe_count(const rheo_recorder *r)
{
    return r->index.size / ENTRY;
}

static void keyframe_at(const rheo_recorder *r, size_t i, uint64_t *step, uint64_t *start, uint64_t *end)
{
    rheo__cursor cursor = {r->index.data, r->index.size, i * ENTRY, false};
    *step = rheo__get_u64(&cursor);
    *start = rheo__get_u64(&cursor);
    *end = rheo__get_u64(&cursor);
}

/* Whether a keyframe remains at this spacing. `newer`: the present step gets one. */
static bool remains(const rheo_recorder *r, size_t i, uint64_t spacing, bool newer)
{
    uint64_t step, start, end;
    keyframe_at(r, i, &step, &start, &end);
    return i == 0 || (i + 1 == keyframe_count(r) && !newer) || (step - r->first_step) % spacing == 0;
}

/* Bytes of the whole file at this spacing; *removable: keyframes that a larger spacing would leave out. */
static uint64_t bytes_at(const rheo_recorder *r, uint64_t spacing, bool newer, uint64_t *removable)
{
    uint64_t bytes = r->writer.written, remaining = newer, step, start, end;
    for (size_t i = 0; i < keyframe_count(r); i++) {
        keyframe_at(r, i, &step, &start, &end);
        const bool kept = remains(r, i, spacing, newer);
        remaining += kept;
        bytes -= kept ? 0 : end - start;
    }
    *removable = remaining - (keyframe_count(r) + newer > 1 ? 2 : 1);
    return bytes + end_bytes(r, remaining);
}

/* Whether so many bytes fit if no keyframe is left out. */
static bool fits(const rheo_recorder *r, uint64_t bytes, bool newer)
{
    const uint64_t all = r->writer.written + end_bytes(r, keyframe_count(r) + newer);
    return bytes <= r->limit && all <= r->limit - bytes;
}

/* The smallest spacing at which so many more bytes fit; false: none. *whole: size with the fewest keyframes. */
static bool find_spacing(const rheo_recorder *r, uint64_t bytes, bool newer, uint64_t *spacing, uint64_t *whole)
{
    for (*spacing = r->spacing;; *spacing *= 2) {
        uint64_t removable;
        *whole = bytes_at(r, *spacing, newer, &removable) + bytes;
        if (*whole <= r->limit)
            return true;
        if (removable == 0 || *spacing > UINT64_MAX / 2)
            return false;
    }
}

rheo_result rheo_recorder_least_bytes(rheo_world *world, const rheo_record_options *options, uint64_t *bytes,
                                      rheo_error *error)
{
    static const rheo_record_options defaults;
    options = options ? options : &defaults;
    RHEO__TRY(rheo__world_check_between_steps(world, "cannot begin a recording", error));
    rheo_recorder *r = rheo__recorder_new(world, options);
    if (!r)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a recorder");
    const rheo_result result = rheo__recorder_begin(r, options, error);
    if (result == RHEO_OK)
        *bytes = r->writer.written + end_bytes(r, keyframe_count(r));
    r->broken = true;
    rheo_recorder_close(r, NULL);
    return result;
}

static char *name_beside(const char *path)
{
    static const char end[] = ".thinning";
    const size_t length = strlen(path);
    char *name = malloc(length + sizeof end);
    if (name) {
        memcpy(name, path, length);
        memcpy(name + length, end, sizeof end);
    }
    return name;
}

/* Removes a thinned file that a killed run has left, and nothing else. */
static rheo_result remove_left(const char *beside, rheo_error *error)
{
    struct stat status = {0};
    uint8_t begin[RHEO__MAGIC_SIZE];
    int lock = RHEO__NO_LOCK;
    if (lstat(beside, &status) != 0)
        return RHEO_OK;
    FILE *file = S_ISREG(status.st_mode) ? fopen(beside, "rb") : NULL;
    const size_t got = file ? fread(begin, 1, sizeof begin, file) : 1;
    const bool left = file && memcmp(begin, rheo__magic, got) == 0;
    if (file)
        fclose(file);
    if (!left)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "%.300s is no recording; a recording with a limit needs this name while it is thinned",
                          beside);
    RHEO__TRY(rheo__lock_path(beside, &lock, error));
    remove(beside);
    rheo__lock_release(lock);
    return RHEO_OK;
}

rheo_result rheo__limit_check_options(rheo_world *world, const char *path, const rheo_record_options *options,
                                      rheo_error *error)
{
    uint64_t least;
    if (options->max_bytes == 0)
        return RHEO_OK;
    char *beside = path ? name_beside(path) : NULL;
    const rheo_result result = beside ? remove_left(beside, error) : RHEO_OK;
    free(beside);
    if (result != RHEO_OK)
        return result;
    RHEO__TRY(rheo_recorder_least_bytes(world, options, &least, error));
    if (least <= options->max_bytes)
        return RHEO_OK;
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "the recording is limited to %llu bytes, but its first keyframe needs a limit of %llu or more",
                      (unsigned long long)options->max_bytes, (unsigned long long)least);
}

rheo_result rheo__limit_check_continued(const rheo_recorder *r, rheo_error *error)
{
    uint64_t spacing, least;
    if (!r->limit || fits(r, 0, false) || find_spacing(r, 0, false, &spacing, &least))
        return RHEO_OK;
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "it is limited to %llu bytes, but has %llu even with the fewest keyframes",
                      (unsigned long long)r->limit, (unsigned long long)least);
}

bool rheo__limit_allows_spacing(const rheo_recorder *r, uint64_t recorded)
{
    uint64_t spacing = r->spacing;
    while (r->limit && spacing < recorded && spacing <= UINT64_MAX / 2)
        spacing *= 2;
    return spacing == recorded;
}

uint64_t rheo_recorder_keyframe_spacing(const rheo_recorder *r)
{
    return r->spacing;
}

uint64_t rheo_recorder_keyframes_left_out(const rheo_recorder *r)
{
    uint64_t left_out = (r->step - r->first_step) / r->asked_spacing + 1, step, start, end;
    for (size_t i = 0; i < keyframe_count(r); i++) {
        keyframe_at(r, i, &step, &start, &end);
        left_out -= (step - r->first_step) % r->asked_spacing == 0;
    }
    return left_out;
}

uint64_t rheo__limit_removable_bytes(const rheo_recorder *r)
{
    uint64_t step, start, end, bytes = 0;
    for (size_t i = 1; i < keyframe_count(r); i++) {
        keyframe_at(r, i, &step, &start, &end);
        bytes += end - start;
    }
    return bytes;
}

/* ---- Thinning ---- */

rheo_result rheo__limit_keep_path(rheo_recorder *r, const char *path, rheo_error *error)
{
    if (!r->limit || !path)
        return RHEO_OK;
#ifdef __wasi__ /* it cannot resolve links */
    r->path = malloc(strlen(path) + 1);
    if (r->path)
        memcpy(r->path, path, strlen(path) + 1);
#else
    r->path = realpath(path, NULL);
#endif
    r->beside = r->path ? name_beside(r->path) : NULL;
    if (!r->beside)
        return rheo__fail(error, RHEO_ERROR_FILE, "cannot find out where %.300s is: %s", path, strerror(errno));
    return remove_left(r->beside, error);
}

static rheo_result copy(rheo__reader *from, uint64_t start, uint64_t end, rheo__writer *to, rheo__bytes *portion,
                        rheo_error *error)
{
    while (start < end) {
        const size_t count = end - start < PORTION ? (size_t)(end - start) : PORTION;
        if (!rheo__bytes_resize(portion, count))
            return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to thin the keyframes of the recording");
        RHEO__TRY(rheo__reader_read(from, start, portion->data, count, error));
        RHEO__TRY(rheo__writer_write(to, portion->data, count, error));
        start += count;
    }
    return RHEO_OK;
}

/* Writes the start of the file with another spacing. *offset: where its other chunks begin. */
static rheo_result copy_head(rheo__reader *from, uint64_t spacing, rheo__writer *to, uint64_t *offset,
                             rheo_error *error)
{
    rheo__chunk chunk;
    bool truncated;
    rheo__bytes head = {0};
    RHEO__TRY(rheo__chunk_at(from, RHEO__MAGIC_SIZE, &chunk, &truncated, error));
    rheo_result result = rheo__chunk_read(from, &chunk, &head, error);
    if (result == RHEO_OK && (chunk.type != RHEO__HEAD || head.size < SPACING_IN_HEAD + 8))
        result = rheo__chunk_damaged(&chunk, "is in the place of HEAD", error);
    if (result == RHEO_OK) {
        for (size_t i = 0; i < 8; i++)
            head.data[SPACING_IN_HEAD + i] = (uint8_t)(spacing >> (8 * i));
        result = rheo__writer_write(to, rheo__magic, RHEO__MAGIC_SIZE, error);
    }
    if (result == RHEO_OK)
        result = rheo__chunk_write(to, RHEO__HEAD, 0, &head, false, error);
    rheo__bytes_release(&head);
    *offset = chunk.end;
    return result;
}

/* Writes the thinned recording, with `keyframe` of the present step at its end unless it is NULL. */
static rheo_result write_thinned(const rheo_recorder *r, rheo__reader *from, uint64_t spacing,
                                 const rheo__bytes *keyframe, rheo__writer *to, rheo__bytes *index, rheo_error *error)
{
    rheo__bytes portion = {0};
    uint64_t copied = 0, step, start, end;
    rheo_result result = copy_head(from, spacing, to, &copied, error);
    for (size_t i = 0; i < keyframe_count(r) && result == RHEO_OK; i++) {
        keyframe_at(r, i, &step, &start, &end);
        result = copy(from, copied, start, to, &portion, error);
        copied = start;
        if (remains(r, i, spacing, keyframe != NULL))
            rheo__index_put(index, step, to->written, to->written + (end - start));
        else
            copied = end;
    }
    if (result == RHEO_OK)
        result = copy(from, copied, r->writer.written, to, &portion, error);
    if (result == RHEO_OK && keyframe) {
        rheo__index_put(index, r->step, to->written, to->written + keyframe->size);
        result = rheo__writer_write(to, keyframe->data, keyframe->size, error);
    }
    rheo__bytes_release(&portion);
    if (result == RHEO_OK && index->failed)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the index of the recording");
    return result;
}

/* The new file takes the name only when it is on the disk and has the mode of the old one. */
static rheo_result put_in_place(rheo_recorder *r, FILE *file, rheo_error *error)
{
    RHEO__TRY(rheo__lock_file(r->writer.file, r->path, error)); /* it still has its name */
#ifndef __wasi__                                                /* it has no modes */
    struct stat status = {0};
    if (fstat(fileno(r->writer.file), &status) == 0)
        (void)fchmod(fileno(file), status.st_mode & 07777);
#endif
    if (fsync(fileno(file)) != 0 && errno != EINVAL && errno != ENOSYS)
        return rheo__fail(error, RHEO_ERROR_FILE, "cannot write %.300s: %s", r->beside, strerror(errno));
    if (rename(r->beside, r->path) != 0)
        return rheo__fail(error, RHEO_ERROR_FILE, "cannot rename %.200s to %.200s: %s", r->beside, r->path,
                          strerror(errno));
    return RHEO_OK;
}

static rheo_result thin_into(rheo_recorder *r, uint64_t spacing, const rheo__bytes *keyframe, rheo__writer *to,
                             rheo__bytes *index, rheo_error *error)
{
    rheo__reader from;
    RHEO__TRY(rheo__lock_file(to->file, r->beside, error));
    if (!rheo__lock_is_named(r->writer.file, r->path))
        return rheo__fail(error, RHEO_ERROR_FILE, "%.300s was renamed, removed or replaced during the run", r->path);
    RHEO__TRY(rheo__reader_open(&from, r->path, error));
    const rheo_result result = write_thinned(r, &from, spacing, keyframe, to, index, error);
    rheo__reader_close(&from);
    return result == RHEO_OK ? put_in_place(r, to->file, error) : result;
}

static rheo_result thin_file(rheo_recorder *r, uint64_t spacing, const rheo__bytes *keyframe, rheo__writer *to,
                             rheo__bytes *index, rheo_error *error)
{
    rheo_error why;
    rheo_result result = remove_left(r->beside, &why) == RHEO_OK ? RHEO_OK : RHEO_ERROR_FILE;
    to->file = result == RHEO_OK ? fopen(r->beside, "wbx") : NULL;
    if (to->file)
        result = thin_into(r, spacing, keyframe, to, index, &why);
    else if (result == RHEO_OK)
        result = rheo__fail(&why, RHEO_ERROR_FILE, "cannot write %.300s: %s", r->beside, strerror(errno));
    if (result == RHEO_OK)
        return RHEO_OK;
    if (to->file) {
        rheo__writer_close(to, NULL);
        remove(r->beside);
    }
    return rheo__fail(error, result, "the keyframes of the recording cannot be thinned: %.400s", why.message);
}

static rheo_result thin(rheo_recorder *r, uint64_t spacing, const rheo__bytes *keyframe, rheo_error *error)
{
    rheo__bytes index = {0}, memory = {0};
    rheo__writer to = {.memory = &memory};
    rheo_result result;
    memcpy(to.path, r->writer.path, sizeof to.path);
    if (r->writer.file) {
        result = thin_file(r, spacing, keyframe, &to, &index, error);
    } else {
        rheo__reader from = {.memory = r->memory.data, .size = r->memory.size};
        result = write_thinned(r, &from, spacing, keyframe, &to, &index, error);
        rheo__bytes_release(&from.frame);
    }
    if (result != RHEO_OK) {
        rheo__bytes_release(&to.frame);
        rheo__bytes_release(&memory);
        rheo__bytes_release(&index);
        r->unthinned = true;
        return result;
    }
    rheo__writer_close(&r->writer, NULL);
    rheo__bytes_release(&r->memory);
    rheo__bytes_release(&r->index);
    r->memory = memory;
    r->index = index;
    r->writer = to;
    r->writer.memory = &r->memory;
    r->spacing = spacing;
    return RHEO_OK;
}

/* ---- Before something is written ---- */

rheo_result rheo__limit_make_room(rheo_recorder *r, uint64_t bytes, rheo_error *error)
{
    uint64_t spacing, whole;
    if (fits(r, bytes, false))
        return RHEO_OK;
    if (find_spacing(r, bytes, false, &spacing, &whole))
        return thin(r, spacing, NULL, error);
    return rheo__fail(
        error, RHEO_ERROR_LIMIT,
        "the recording ends with step %llu: the next one needs a limit of %llu bytes or more, even with the "
        "fewest keyframes, and the limit is %llu",
        (unsigned long long)r->step, (unsigned long long)whole, (unsigned long long)r->limit);
}

/* Bytes of the STAT chunks of the step that is being made. */
static rheo_result state_bytes(const rheo_recorder *r, uint64_t *bytes, rheo_error *error)
{
    const rheo__state *s = &r->world->state;
    rheo__values now = {0};
    rheo__bytes memory = {0};
    rheo__writer writer = {.memory = &memory};
    rheo__pieces_writer pieces = {.writer = &writer, .type = RHEO__STAT, .step = r->step + 1};
    rheo_result result = rheo__values_take(&now, s, false, error);
    if (result == RHEO_OK) {
        /* What the end of the step is going to write. */
        ++*(uint64_t *)now.data[RHEO__FIELD_step];
        if (rheo__state_has(s, RHEO__FIELD_history_rows))
            *(uint64_t *)now.data[RHEO__FIELD_history_rows] = rheo__rows_after(s, *s->history_rows);
        result =
            rheo__full_write(&pieces, s->present, &r->before, &now, rheo_world_definition(r->world)->step, error);
    }
    *bytes = writer.written;
    rheo__bytes_release(&pieces.bytes);
    rheo__bytes_release(&writer.frame);
    rheo__bytes_release(&memory);
    rheo__values_release(&now);
    return result;
}

/* A number that state_bytes() never exceeds, without writing: packed values need at most 1/32 more than they have. */
static uint64_t most_state_bytes(const rheo_recorder *r)
{
    const rheo__state *s = &r->world->state;
    uint64_t bytes = 4096 + 8 * (uint64_t)r->before.items[RHEO__FIELD_spring_ends];
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (rheo__state_has(s, f) && !rheo__in_rows(f))
            bytes += 256 + 2 * (uint64_t)rheo__state_row_bytes(s, f);
    return bytes;
}

rheo_result rheo__limit_check_step(void *recorder, rheo_error *error)
{
    rheo_recorder *r = recorder;
    const rheo_world *w = r->world;
    const uint64_t hashes = rheo__world_trace_start(w, rheo__world_stage_runs_in_step(w)),
                   step = r->step_chunks.size + MEMBER_BYTES + 8 * (1 + hashes + rheo_world_metric_count(w));
    uint64_t state = 0;
    if (r->full && !fits(r, step + most_state_bytes(r), false))
        RHEO__TRY(state_bytes(r, &state, error));
    return rheo__limit_make_room(r, step + state, error);
}

/* Writes the keyframe whose bytes these are, or leaves it out. */
static rheo_result place(rheo_recorder *r, const rheo__bytes *keyframe, bool due, rheo_error *error)
{
    uint64_t spacing, fewest;
    if (fits(r, keyframe->size + (due ? 0 : r->step_chunks.size), true)) { /* a failure has commands after it */
        const uint64_t start = r->writer.written;
        RHEO__TRY(rheo__writer_write(&r->writer, keyframe->data, keyframe->size, error));
        rheo__index_put(&r->index, r->step, start, r->writer.written);
        r->last_keyframe = r->step;
        return r->index.failed ? rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the index of the recording")
                               : RHEO_OK;
    }
    if (!due || !find_spacing(r, keyframe->size, true, &spacing, &fewest))
        return RHEO_OK;
    /* At the first spacing with which the present step has no keyframe, there is room without it. */
    uint64_t wider = r->spacing;
    while (wider < spacing && (r->step - r->first_step) % wider == 0)
        wider *= 2;
    if ((r->step - r->first_step) % wider != 0)
        return thin(r, wider, NULL, error);
    RHEO__TRY(thin(r, spacing, keyframe, error));
    r->last_keyframe = r->step;
    return RHEO_OK;
}

rheo_result rheo__limit_keyframe(rheo_recorder *r, bool due, rheo_error *error)
{
    rheo__bytes image = {0};
    rheo__writer writer = {.memory = &image};
    rheo_result result = rheo__keyframe_write(&writer, r->world, error);
    if (result == RHEO_OK)
        result = place(r, &image, due, error);
    rheo__bytes_release(&writer.frame);
    rheo__bytes_release(&image);
    return result;
}
