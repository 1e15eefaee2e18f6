/*
 * Continuing a recording in place. Every step and keyframe is committed by its last chunk, so what follows the last of
 * them is cut off: an end mark, or the torn rest of a step. What is written from there on depends on the state alone,
 * so the file becomes the one that an uninterrupted run would have written.
 */
#define _POSIX_C_SOURCE 200809L
#define _FILE_OFFSET_BITS 64
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

#include "record/lock.h"
#include "record/recorder.h"
#include "record/replace.h"

static rheo_result cut_to(FILE *file, const char *path, uint64_t size, rheo_error *error)
{
    if (fflush(file) == 0 && ftruncate(fileno(file), (off_t)size) == 0 && fseeko(file, (off_t)size, SEEK_SET) == 0)
        return RHEO_OK;
    return rheo__fail(error, RHEO_ERROR_FILE, "cannot cut off the end of %s: %s", path, strerror(errno));
}

rheo_result rheo__recorder_resume(rheo_recorder *r, rheo_error *error)
{
    if (!r->unresumed)
        return RHEO_OK;
    rheo_result result = cut_to(r->writer.file, r->writer.path, r->resume, error);
    r->unresumed = false;
    if (result == RHEO_OK && r->limit)
        result = rheo__limit_make_room(r, 0, error);
    if (result == RHEO_OK)
        result = rheo__recorder_keyframe(r, error);
    r->broken = result;
    return result;
}

/* ---- Whether the file is of this run ---- */

static rheo_result compare_geometry(const rheo_world_def *a, const rheo_world_def *b, bool *same, rheo_error *error)
{
    rheo__bytes of_a = {0}, of_b = {0};
    rheo__geometry_put(&of_a, a);
    rheo__geometry_put(&of_b, b);
    rheo__meshes_put(&of_a, a);
    rheo__meshes_put(&of_b, b);
    const bool enough = !of_a.failed && !of_b.failed;
    *same = enough && of_a.size == of_b.size && memcmp(of_a.data, of_b.data, of_a.size) == 0;
    rheo__bytes_release(&of_a);
    rheo__bytes_release(&of_b);
    return enough ? RHEO_OK : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to compare walls and vibrators");
}

static rheo_result check_parameters(const rheo_world_def *recorded, const rheo_world_def *now, rheo_error *error)
{
    char was[96], is[96];
    size_t index = 0;
    const uint32_t points = now->history.curve_count;
    if (recorded->history.curve_count != points ||
        (points && memcmp(recorded->history.curve, now->history.curve, points * sizeof *now->history.curve) != 0))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "it has another history.curve than this run");
    const rheo_parameter *p = rheo_world_def_differing(recorded, now, &index, was, is);
    return p ? rheo__fail(error, RHEO_ERROR_ARGUMENT, "it has %s = %s, this run %s", p->path, was, is) : RHEO_OK;
}

/* What the head of the file says against what this run would write there. */
static rheo_result check_head(const rheo_recording *r, const rheo_recorder *now, const char *scene, rheo_error *error)
{
    const rheo__head *head = &r->head;
    const rheo_world *world = now->world;
    RHEO__TRY(rheo__head_check_numbers(head, error));
    if (strcmp(head->scene, scene) != 0)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "it is of the scene \"%.100s\", this run of \"%.100s\"",
                          head->scene, scene);
    if (head->full != now->full)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "it %s the state of every step, this run %s",
                          head->full ? "holds" : "does not hold", now->full ? "does" : "does not");
    if (!rheo__limit_allows_spacing(now, head->keyframe_spacing))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "it has a keyframe every %llu steps, this run every %llu%s",
                          (unsigned long long)head->keyframe_spacing, (unsigned long long)now->spacing,
                          now->limit ? "" : "; if its keyframes were thinned, this run needs a limit, too");
    if (r->first_step != now->first_step)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "it begins with step %llu, this run with step %llu",
                          (unsigned long long)r->first_step, (unsigned long long)now->first_step);
    RHEO__TRY(check_parameters(&r->def, &world->def, error));
    bool same_geometry;
    RHEO__TRY(compare_geometry(&r->def, &world->def, &same_geometry, error));
    if (head->features != world->features || !same_geometry)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "it has other walls, vibrators or features than this run");
    RHEO__TRY(rheo__head_check_world(head, world, error));
    if (strcmp(head->build, rheo_build()) != 0)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "it was begun by another build, %.120s; this one is %.120s",
                          head->build, rheo_build());
    return RHEO_OK;
}

static rheo_result check_run(rheo_recording *r, const rheo_recorder *now, const char *scene, rheo_error *error)
{
    RHEO__TRY(check_head(r, now, scene, error));
    rheo__field_id field;
    RHEO__TRY(rheo__keyframe_compare(r, &r->keyframes[0], now->world, &field, error));
    if (field != RHEO__FIELD_COUNT)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "its first state has another %s than this run",
                          rheo__field_table[field].name);
    return RHEO_OK;
}

/* ---- Continuing ---- */

/* The file ends before its first keyframe is complete. It is begun again if this run would have written it so far. */
static rheo_result begin_again(rheo_recorder *r, rheo_recording *there, const rheo_record_options *options,
                               rheo_error *error)
{
    rheo__bytes image = {0};
    FILE *file = r->writer.file;
    r->writer.file = NULL;
    r->writer.memory = &image;
    rheo_result result = rheo__recorder_begin(r, options, error);
    size_t size = (size_t)there->reader.size;
    bool same = result == RHEO_OK && there->reader.size <= image.size && rheo__bytes_resize(&there->payload, size);
    if (same) {
        result = rheo__reader_read(&there->reader, 0, there->payload.data, size, error);
        while (size > 0 && there->payload.data[size - 1] == 0) /* that were never written, or are as they should be */
            size--;
        same = result == RHEO_OK && (size == 0 || memcmp(there->payload.data, image.data, size) == 0);
    }
    r->writer.file = file;
    r->writer.memory = &r->memory;
    r->writer.written = 0;
    if (result == RHEO_OK && !same)
        result =
            rheo__fail(error, RHEO_ERROR_FORMAT,
                       "it has no whole keyframe, so it would be begun again, but it does not begin as this run");
    if (result == RHEO_OK)
        result = cut_to(file, r->writer.path, 0, error);
    if (result == RHEO_OK)
        result = rheo__writer_write(&r->writer, image.data, image.size, error);
    rheo__bytes_release(&image);
    return result;
}

/*
 * The world after the last step, which is simulated again even where the file holds its state: this shows that the
 * build goes on with the same bits, and a failure of the next step tells what the stages of this one measured.
 */
static rheo_result make_last_step(rheo_recording *there, const rheo_allocator *allocator, rheo_world **world,
                                  rheo_error *error)
{
    size_t different;
    RHEO__TRY(rheo_recording_world(there, there->last_step - 1, allocator, world, error));
    rheo_result result = rheo__recording_replay(there, there->step_count - 1, *world, &different, error);
    if (result == RHEO_OK && different != RHEO__NO_HASH)
        result = rheo__recording_differs(*world, there->last_step, different, error);
    if (result != RHEO_OK)
        rheo_world_destroy(*world);
    return result;
}

static rheo_result go_on(rheo_recorder *r, rheo_recording *there, rheo_world **world, rheo_error *error)
{
    rheo_world *last = NULL;
    const rheo_allocator allocator = (*world)->def.allocator;
    /* The step that failed is made again, and fails again. */
    r->resume = there->has_failure ? there->failed.start : there->end;
    for (size_t i = 0; i < there->keyframe_count; i++)
        rheo__index_put(&r->index, there->keyframes[i].step, there->keyframes[i].start, there->keyframes[i].end);
    if (r->index.failed)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the index of the recording");
    r->writer.written = r->resume;
    r->spacing = there->head.keyframe_spacing;
    RHEO__TRY(rheo__limit_check_continued(r, error));
    if (there->last_step > there->first_step) {
        RHEO__TRY(make_last_step(there, &allocator, &last, error));
        last->def.log = (*world)->def.log;
    }
    if (r->full) {
        const rheo_result taken = rheo__values_take(&r->before, last ? &last->state : &(*world)->state, false, error);
        if (taken != RHEO_OK) {
            rheo_world_destroy(last);
            return taken;
        }
    }
    r->step = there->last_step;
    r->last_keyframe = there->keyframes[there->keyframe_count - 1].step;
    r->unresumed = true;
    if (last) { /* commands that the other world was given are not those of this one */
        r->world = last;
        rheo__world_commands(last, &r->commands_before);
    }
    const rheo_result result = there->complete ? RHEO_OK : rheo__recorder_resume(r, error);
    if (last && result == RHEO_OK) {
        rheo_world_destroy(*world);
        *world = last;
    } else if (last) {
        r->world = *world;
        rheo_world_destroy(last);
    }
    return result;
}

static rheo_result continue_opened(rheo_recorder *r, rheo_recording *there, rheo_world **world,
                                   const rheo_record_options *options, rheo_error *error)
{
    bool damaged = false;
    const rheo_result result = rheo__recording_scan(there, false, &damaged, error);
    if (result == RHEO_OK && damaged)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "%s", there->fault.message);
    if (result == RHEO_OK) {
        RHEO__TRY(check_run(there, r, options->scene ? options->scene : "", error));
        return go_on(r, there, world, error);
    }
    return result == RHEO_ERROR_FORMAT && (!damaged || there->reader.size == 0)
               ? begin_again(r, there, options, error)
               : result;
}

static rheo_result continue_file(rheo_recorder *r, rheo_recording *there, rheo_world **world, const char *path,
                                 const rheo_record_options *options, rheo_error *error)
{
    rheo_error why;
    r->writer.file = fopen(path, "r+b");
    rheo__writer_name(&r->writer, path);
    if (!r->writer.file)
        return rheo__fail(error, RHEO_ERROR_FILE, "cannot write %.300s: %s", path, strerror(errno));
    RHEO__TRY(rheo__lock_file(r->writer.file, path, error));
    RHEO__TRY(rheo__limit_keep_path(r, path, error));
    rheo_result result = rheo__reader_open(&there->reader, path, &why);
    there->reader.growing = false; /* that is this recorder */
    if (result == RHEO_OK)
        result = continue_opened(r, there, world, options, &why);
    if (result == RHEO_OK)
        return RHEO_OK;
    return rheo__fail(error, result, "cannot continue %.200s: %.260s%s", path, why.message,
                      result == RHEO_ERROR_STOPPED ? "; the file is unchanged" : "");
}

rheo_result rheo_recorder_continue(rheo_world **world, const char *path, const rheo_record_options *options,
                                   rheo_recorder **recorder, rheo_error *error)
{
    rheo_record_options own = options ? *options : (rheo_record_options){0};
    own.force = false;
    *recorder = NULL;
    if (!rheo__file_exists(path))
        return rheo_recorder_open(*world, path, &own, recorder, error);
    RHEO__TRY(rheo_output_check(path, RHEO_OUTPUT_CONTINUE, error));
    RHEO__TRY(rheo__world_check_between_steps(*world, "cannot continue a recording", error));
    RHEO__TRY(rheo__limit_check_options(*world, path, &own, error));
    rheo_recorder *r = rheo__recorder_new(*world, &own);
    rheo_recording *there = calloc(1, sizeof *there);
    rheo_result result = r && there ? continue_file(r, there, world, path, &own, error)
                                    : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a recorder");
    rheo_recording_close(there);
    if (result == RHEO_OK) {
        *recorder = r;
    } else if (r) {
        r->unresumed = true; /* writes no end */
        rheo_recorder_close(r, NULL);
    }
    return result;
}
