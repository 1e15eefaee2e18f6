/*
 * Writing recordings: checkpoints, and the recorder of a run. A step is written only after it has succeeded. Its
 * last chunk is STEP, which commits it, so a run that is killed leaves complete steps.
 *
 * The bytes depend on the run, the build and the given texts only: no dates, no names of files or machines.
 */
#define _POSIX_C_SOURCE 200809L
#include <sys/stat.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "record/lock.h"
#include "record/recorder.h"
#include "record/replace.h"

enum { INDEX_ENTRY = 24, INDEX_MOST = RHEO__PIECE / INDEX_ENTRY };

/* ---- Start and end of every recording ---- */

static rheo_result write_start(rheo__writer *writer, const rheo_world *world, const char *scene, uint64_t spacing,
                               bool full, rheo_error *error)
{
    rheo__bytes head = {0};
    rheo_result result = rheo__head_put(&head, world, scene, spacing, full, error);
    if (result == RHEO_OK)
        result = rheo__writer_write(writer, rheo__magic, RHEO__MAGIC_SIZE, error);
    if (result == RHEO_OK)
        result = rheo__chunk_write(writer, RHEO__HEAD, 0, &head, false, error);
    rheo__bytes_release(&head);
    return result;
}

void rheo__index_put(rheo__bytes *index, uint64_t step, uint64_t start, uint64_t end)
{
    rheo__put_u64(index, step);
    rheo__put_u64(index, start);
    rheo__put_u64(index, end);
}

static rheo_result write_keyframe(rheo__writer *writer, const rheo_world *world, rheo__bytes *index,
                                  rheo_error *error)
{
    uint64_t start = writer->written;
    RHEO__TRY(rheo__keyframe_write(writer, world, error));
    rheo__index_put(index, rheo_world_step_count(world), start, writer->written);
    return index->failed ? rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the index of the recording") : RHEO_OK;
}

rheo_result rheo__recording_write_end(rheo__writer *writer, const rheo__bytes *index, uint64_t first_step,
                                      uint64_t last_step, const uint64_t *hash, rheo_error *error)
{
    for (size_t offset = 0; offset < index->size; offset += (size_t)INDEX_MOST * INDEX_ENTRY) {
        size_t left = index->size - offset, most = (size_t)INDEX_MOST * INDEX_ENTRY;
        rheo__bytes part = {index->data + offset, left < most ? left : most, 0, false};
        RHEO__TRY(rheo__chunk_write(writer, RHEO__INDX, last_step, &part, false, error));
    }
    rheo__bytes end = {0};
    rheo__put_u64(&end, first_step);
    rheo__put_u64(&end, last_step);
    rheo__put_u64(&end, hash ? *hash : 0);
    rheo__put_u32(&end, hash != NULL);
    rheo_result result = rheo__chunk_write(writer, RHEO__DONE, last_step, &end, false, error);
    rheo__bytes_release(&end);
    return result;
}

/* ---- Checkpoints ---- */

static rheo_result write_checkpoint(rheo__writer *writer, const rheo_world *world, const char *scene,
                                    rheo_error *error)
{
    RHEO__TRY(rheo__world_check_between_steps(world, "cannot be saved", error));
    rheo__bytes index = {0};
    uint64_t step = rheo_world_step_count(world), hash = rheo_world_hash(world);
    rheo_result result = write_start(writer, world, scene, 0, false, error);
    if (result == RHEO_OK)
        result = write_keyframe(writer, world, &index, error);
    if (result == RHEO_OK)
        result = rheo__recording_write_end(writer, &index, step, step, &hash, error);
    rheo__bytes_release(&index);
    return result;
}

rheo_result rheo_world_save_memory(const rheo_world *world, const char *scene, void **bytes, size_t *size,
                                   rheo_error *error)
{
    rheo__bytes memory = {0};
    rheo__writer writer = {.memory = &memory};
    rheo_result result = write_checkpoint(&writer, world, scene, error);
    rheo__writer_close(&writer, NULL);
    if (result != RHEO_OK) {
        rheo__bytes_release(&memory);
        return result;
    }
    *bytes = memory.data;
    *size = memory.size;
    return RHEO_OK;
}

typedef struct saved {
    const rheo_world *world;
    const char *scene;
} saved;

static rheo_result write_saved(rheo__writer *to, const void *user, rheo_error *error)
{
    const saved *s = user;
    return write_checkpoint(to, s->world, s->scene, error);
}

rheo_result rheo_world_save(const rheo_world *world, const char *scene, const char *path, bool force,
                            rheo_error *error)
{
    RHEO__TRY(rheo_output_check(path, force ? RHEO_OUTPUT_REPLACE : RHEO_OUTPUT_NEW, error));
    return rheo__write_beside(path, NULL, write_saved, &(saved){world, scene}, error);
}

/* ---- The recorder ---- */

rheo_recorder *rheo__recorder_new(rheo_world *world, const rheo_record_options *options)
{
    rheo_recorder *r = calloc(1, sizeof *r);
    double *metrics = calloc(rheo_world_metric_count(world), sizeof *metrics);
    if (!r || !metrics) {
        free(r);
        free(metrics);
        return NULL;
    }
    r->world = world;
    r->writer.memory = &r->memory;
    r->failure_metrics = metrics;
    r->first_step = r->step = r->last_keyframe = rheo_world_step_count(world);
    r->spacing = options->keyframe_spacing ? options->keyframe_spacing : rheo__recorder_spacing(world);
    r->asked_spacing = r->spacing;
    r->limit = options->max_bytes;
    r->full = options->full;
    rheo__world_commands(world, &r->commands_before);
    return r;
}

rheo_result rheo__recorder_begin(rheo_recorder *r, const rheo_record_options *options, rheo_error *error)
{
    if (r->full)
        RHEO__TRY(rheo__values_take(&r->before, &r->world->state, false, error));
    RHEO__TRY(write_start(&r->writer, r->world, options->scene, r->spacing, r->full, error));
    RHEO__TRY(rheo__made_write(&r->writer, options->made_by, options->scene_text, error));
    return write_keyframe(&r->writer, r->world, &r->index, error);
}

/* Begins a file beside the one that it replaces. The lock goes with the file when that is renamed. */
static rheo_result begin_beside(rheo_recorder *r, const char *path, const rheo_record_options *options,
                                rheo_error *error)
{
    char *target;
    RHEO__TRY(rheo__output_target(path, &target, error));
    char *name = malloc(strlen(target) + 16);
    rheo_result result = RHEO_OK;
    r->writer.file = name ? rheo__open_beside(target, name) : NULL;
    if (!name) {
        result = rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to record %.300s", path);
    } else if (!r->writer.file) {
        result = rheo__fail(error, RHEO_ERROR_FILE, "cannot write %.300s: %s", name, strerror(errno));
    } else {
        result = rheo__lock_file(r->writer.file, name, error);
        if (result == RHEO_OK)
            result = rheo__recorder_begin(r, options, error);
        if (result == RHEO_OK)
            result = rheo__replace_by(target, NULL, name, error);
        else
            remove(name);
    }
    free(name);
    free(target);
    return result;
}

/* Begins a new file, or writes to a device. */
static rheo_result begin_there(rheo_recorder *r, const char *path, bool device, const rheo_record_options *options,
                               rheo_error *error)
{
    r->writer.file = fopen(path, device ? "wb" : "wbx");
    if (!r->writer.file && errno == EEXIST && options->force) /* another writer made it just now */
        return begin_beside(r, path, options, error);
    if (!r->writer.file && errno == EEXIST)
        return rheo__exists(path, error);
    if (!r->writer.file)
        return rheo__fail(error, RHEO_ERROR_FILE, "cannot write %.300s: %s", path, strerror(errno));
    if (!device)
        RHEO__TRY(rheo__lock_file(r->writer.file, path, error));
    const rheo_result result = rheo__recorder_begin(r, options, error);
    if (result != RHEO_OK && !device)
        remove(path);
    return result;
}

/* Begins the file, or the recording in memory if there is no path. */
static rheo_result begin_somewhere(rheo_recorder *r, const char *path, const rheo_record_options *options,
                                   rheo_error *error)
{
    struct stat status = {0};
    if (!path)
        return rheo__recorder_begin(r, options, error);
    rheo__writer_name(&r->writer, path);
    const bool exists = options->force && lstat(path, &status) == 0,
               device = exists && !S_ISREG(status.st_mode) && !S_ISLNK(status.st_mode);
    if (device && r->limit)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "%.300s is no regular file, so a recording there cannot have a limit of bytes", path);
    return exists && !device ? begin_beside(r, path, options, error) : begin_there(r, path, device, options, error);
}

/* `path` is NULL for a recording in memory. */
static rheo_result open_recorder(rheo_world *world, const char *path, const rheo_record_options *options,
                                 rheo_recorder **recorder, rheo_error *error)
{
    static const rheo_record_options defaults;
    options = options ? options : &defaults;
    *recorder = NULL;
    RHEO__TRY(rheo__world_check_between_steps(world, "cannot begin a recording", error));
    if (path)
        RHEO__TRY(rheo_output_check(path, options->force ? RHEO_OUTPUT_REPLACE : RHEO_OUTPUT_NEW, error));
    RHEO__TRY(rheo__limit_check_options(world, path, options, error));
    rheo_recorder *r = rheo__recorder_new(world, options);
    if (!r)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a recorder");
    rheo_result result = begin_somewhere(r, path, options, error);
    if (result == RHEO_OK)
        result = rheo__limit_keep_path(r, path, error);
    if (result != RHEO_OK) {
        r->broken = result;
        rheo_recorder_close(r, NULL);
        return result;
    }
    *recorder = r;
    return RHEO_OK;
}

rheo_result rheo_recorder_open(rheo_world *world, const char *path, const rheo_record_options *options,
                               rheo_recorder **recorder, rheo_error *error)
{
    return open_recorder(world, path, options, recorder, error);
}

rheo_result rheo_recorder_open_memory(rheo_world *world, const rheo_record_options *options, rheo_recorder **recorder,
                                      rheo_error *error)
{
    return open_recorder(world, NULL, options, recorder, error);
}

/* The world forgets the commands with the step; they are kept here until it succeeds. */
static rheo_result keep_commands(rheo_recorder *r, uint32_t *chunks, rheo_error *error)
{
    size_t count;
    const rheo__command *commands = rheo__world_commands(r->world, &count);
    r->step_chunks.size = 0;
    r->step_chunks.failed = false;
    rheo__writer writer = {.memory = &r->step_chunks};
    rheo_result result = RHEO_OK;
    for (size_t i = r->commands_before; i < count && result == RHEO_OK; i++)
        result = rheo__command_write(&writer, r->step + 1, &commands[i], chunks, error);
    rheo__writer_close(&writer, NULL);
    return result;
}

static rheo_result write_state(rheo_recorder *r, uint64_t *chunks, rheo_error *error)
{
    rheo__pieces_writer pieces = {.writer = &r->writer, .type = RHEO__STAT, .step = r->step};
    RHEO__TRY(rheo__values_follow(&r->now, &r->world->state, &r->order, error));
    rheo_result result = rheo__full_write(&pieces, r->world->state.present, &r->before, &r->now,
                                          rheo_world_definition(r->world)->step, error);
    rheo__bytes_release(&pieces.bytes);
    rheo__values_swap(&r->before, &r->now);
    *chunks = pieces.chunks;
    return result;
}

rheo_result rheo__recorder_keyframe(rheo_recorder *r, rheo_error *error)
{
    if ((r->step - r->first_step) % r->spacing != 0 || r->last_keyframe == r->step)
        return RHEO_OK;
    if (r->limit)
        return rheo__limit_keyframe(r, true, error);
    r->last_keyframe = r->step;
    return write_keyframe(&r->writer, r->world, &r->index, error);
}

static rheo_result write_step(rheo_recorder *r, uint32_t commands, rheo_error *error)
{
    const rheo_world *world = r->world;
    const uint64_t start = r->writer.written;
    uint64_t states = 0;
    if (r->step_chunks.size)
        RHEO__TRY(rheo__writer_write(&r->writer, r->step_chunks.data, r->step_chunks.size, error));
    if (r->full)
        RHEO__TRY(write_state(r, &states, error));
    rheo__bytes step = {0};
    rheo__put_u32(&step, commands);
    rheo__put_u32(&step, (uint32_t)states);
    for (size_t i = 0; i < world->trace.count; i++)
        rheo__put_u64(&step, world->trace.hash[i]);
    for (uint32_t i = 0; i < rheo_world_metric_count(world); i++)
        rheo__put_f64(&step, rheo_world_metric(world, i));
    rheo_result result = rheo__chunk_write(&r->writer, RHEO__STEP, r->step, &step, false, error);
    rheo__bytes_release(&step);
    RHEO__TRY(result);
    r->step_bytes += r->writer.written - start;
    r->steps++;
    return rheo__recorder_keyframe(r, error);
}

/* Writes the failed step, after a keyframe of the last good state, so that this state is quickly reached. */
static rheo_result write_failure(rheo_recorder *r, rheo_error *error)
{
    size_t commands;
    rheo__world_commands(r->world, &commands);
    /* No keyframe if commands have already changed the state. */
    if (commands == r->commands_before && r->last_keyframe != r->step)
        RHEO__TRY(r->limit ? rheo__limit_keyframe(r, false, error)
                           : write_keyframe(&r->writer, r->world, &r->index, error));
    if (r->step_chunks.size)
        RHEO__TRY(rheo__writer_write(&r->writer, r->step_chunks.data, r->step_chunks.size, error));
    return rheo__failure_write(&r->writer, &r->failure, r->failure_commands, r->failure_metrics,
                               rheo_world_metric_count(r->world), error);
}

rheo_result rheo_recorder_step(rheo_recorder *r, rheo_error *error)
{
    if (r->broken)
        return rheo__fail(error, r->broken, "the recording ended at step %llu, when writing failed",
                          (unsigned long long)r->step);
    if (rheo_world_step_count(r->world) != r->step)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the world is at step %llu, its recording at %llu; step a world only by its recorder",
                          (unsigned long long)rheo_world_step_count(r->world), (unsigned long long)r->step);
    uint32_t commands = 0;
    RHEO__TRY(rheo__world_check_between_steps(r->world, "cannot be recorded", error));
    RHEO__TRY(keep_commands(r, &commands, error));
    RHEO__TRY(rheo__recorder_resume(r, error));
    r->failed = false;
    if (r->limit) /* for the commands of a step that fails */
        RHEO__TRY(rheo__limit_make_room(r, r->step_chunks.size, error));
    rheo_error why;
    const rheo__step_check check = {rheo__limit_check_step, r};
    rheo_result result = rheo__world_step_checked(r->world, r->limit ? &check : NULL, &why);
    r->failed = rheo_world_failure(r->world, &r->failure);
    if (r->failed) {
        r->failure_commands = commands;
        for (uint32_t i = 0; i < rheo_world_metric_count(r->world); i++)
            r->failure_metrics[i] = rheo__world_failed_metric(r->world, i);
    }
    if (result != RHEO_OK)
        return rheo__fail(error, result, "%s", why.message);
    r->commands_before = 0;
    r->step++;
    r->unthinned = false;
    result = write_step(r, commands, error);
    r->broken = r->unthinned ? RHEO_OK : result;
    return result;
}

/* Writes what follows the last step. */
static rheo_result write_end(rheo_recorder *r, rheo_error *error)
{
    /* Commands or steps that are not recorded have changed the state: its hash is then not that of the last step. */
    size_t commands;
    rheo__world_commands(r->world, &commands);
    const uint64_t hash = rheo_world_hash(r->world);
    const bool known = rheo_world_step_count(r->world) == r->step && commands == r->commands_before;
    if (r->failed)
        RHEO__TRY(write_failure(r, error));
    return rheo__recording_write_end(&r->writer, &r->index, r->first_step, r->step, known ? &hash : NULL, error);
}

rheo_result rheo_recorder_copy_memory(rheo_recorder *r, void **bytes, size_t *size, rheo_error *error)
{
    rheo__bytes copy = {0};
    const uint64_t written = r->writer.written, last_keyframe = r->last_keyframe;
    const size_t index = r->index.size;
    *bytes = NULL;
    *size = 0;
    if (r->writer.file)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the recording is in its file; only one in memory can be copied");
    if (r->broken)
        return rheo__fail(error, r->broken, "the recording is not complete: writing failed at step %llu",
                          (unsigned long long)r->step);
    rheo__put_raw(&copy, r->memory.data, r->memory.size);
    r->writer.memory = &copy;
    const rheo_result result =
        copy.failed ? rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to copy a recording") : write_end(r, error);
    r->writer.memory = &r->memory;
    r->writer.written = written;
    r->last_keyframe = last_keyframe;
    r->index.size = index;
    if (result != RHEO_OK) {
        rheo__bytes_release(&copy);
        return result;
    }
    *bytes = copy.data;
    *size = copy.size;
    return RHEO_OK;
}

rheo_result rheo_recorder_close(rheo_recorder *r, rheo_error *error)
{
    if (!r)
        return RHEO_OK;
    rheo_result result = RHEO_OK;
    if (r->unresumed) {
        /* The file was complete and stays as it is. */
    } else if (r->broken) {
        result = rheo__fail(error, r->broken, "the recording is not complete: writing failed at step %llu",
                            (unsigned long long)r->step);
    } else {
        result = write_end(r, error);
    }
    rheo_result closed = rheo__writer_close(&r->writer, result == RHEO_OK ? error : NULL);
    if (r->keep && result == RHEO_OK)
        *r->keep = r->memory;
    else
        rheo__bytes_release(&r->memory);
    rheo__bytes_release(&r->step_chunks);
    rheo__bytes_release(&r->index);
    rheo__values_release(&r->before);
    rheo__values_release(&r->now);
    rheo__spring_order_release(&r->order.order, &r->world->state.allocator);
    free(r->failure_metrics);
    free(r->path);
    free(r->beside);
    free(r);
    return result == RHEO_OK ? closed : result;
}

rheo_result rheo_recorder_close_memory(rheo_recorder *r, void **bytes, size_t *size, rheo_error *error)
{
    rheo__bytes memory = {0};
    *bytes = NULL;
    *size = 0;
    if (!r)
        return RHEO_OK;
    const bool in_memory = !r->writer.file;
    r->keep = in_memory ? &memory : NULL;
    const rheo_result result = rheo_recorder_close(r, error);
    *bytes = memory.data;
    *size = memory.size;
    if (result == RHEO_OK && !in_memory)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the recording is in its file; only one in memory has bytes");
    return result;
}
