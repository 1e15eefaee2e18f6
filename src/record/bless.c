/*
 * Blessing: the one way in which a golden recording changes. This build must reproduce the new
 * recording; the reason is written into it, after the reasons that the old recording had.
 */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "record/recording.h"

typedef struct blessing_files {
    const char *old_path, *new_path, *because;
    rheo_recording *old, *new; /* old: NULL if none can be read */
} blessing_files;

static rheo_result check_new(const char *path, rheo_error *error)
{
    rheo_verification v;
    RHEO__TRY(rheo_verify(path, &v, error));
    if (v.verdict == RHEO_SAME)
        return RHEO_OK;
    return rheo__fail(error, v.verdict == RHEO_DIFFERS ? RHEO_ERROR_DIFFERS : RHEO_ERROR_FORMAT,
                      "'%.200s' cannot be blessed, since this build does not verify it: %.280s", path, v.message);
}

static rheo_result check_because(const char *because, rheo_error *error)
{
    const char *c = because;
    while (*c == ' ' || *c == '\t' || *c == '\n')
        c++;
    if (!*c || strlen(because) > 4096)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "a blessing needs a reason of 1 to 4096 bytes: what changed, and why that is right");
    return RHEO_OK;
}

/* Whether the new recording adds nothing to the old one. */
static bool is_unchanged(const blessing_files *f, const rheo_verification *difference)
{
    const rheo_recording *a = f->old, *b = f->new;
    return a && difference->verdict == RHEO_SAME && a->head.full == b->head.full && a->blessing_count > 0;
}

static rheo_result copy(rheo_recording *from, rheo__writer *to, rheo_error *error)
{
    for (uint64_t offset = 0; offset < from->end;) {
        size_t size = from->end - offset < RHEO__PIECE ? (size_t)(from->end - offset) : RHEO__PIECE;
        if (!rheo__bytes_resize(&from->payload, size))
            return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to copy '%.300s'", from->head.scene);
        RHEO__TRY(rheo__reader_read(&from->reader, offset, from->payload.data, size, error));
        RHEO__TRY(rheo__writer_write(to, from->payload.data, size, error));
        offset += size;
    }
    return RHEO_OK;
}

static rheo_result write_blessed(const blessing_files *f, rheo__writer *to, rheo_error *error)
{
    rheo_recording *r = f->new;
    RHEO__TRY(copy(r, to, error));
    for (uint32_t i = 0; f->old && i < f->old->blessing_count; i++)
        RHEO__TRY(rheo__blessing_write(to, r->last_step, &f->old->blessings[i], error));
    RHEO__TRY(rheo__blessing_write(to, r->last_step, &(rheo_blessing){f->because, rheo_build()}, error));
    rheo__bytes index = {0};
    for (size_t i = 0; i < r->keyframe_count; i++)
        rheo__index_put(&index, r->keyframes[i].step, r->keyframes[i].start, r->keyframes[i].end);
    rheo_result result = index.failed
                             ? rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the index of the recording")
                             : rheo__recording_write_end(to, &index, r->first_step, r->last_step,
                                                         r->has_last_hash ? &r->last_hash : NULL, error);
    rheo__bytes_release(&index);
    return result;
}

static rheo_result replace(const blessing_files *f, rheo_error *error)
{
    char *name = malloc(strlen(f->old_path) + 16);
    if (!name)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to bless '%.300s'", f->old_path);
    rheo__writer to = {.file = rheo__open_beside(f->old_path, name)};
    rheo_result result = RHEO_OK;
    if (!to.file) {
        result = rheo__fail(error, RHEO_ERROR_FILE, "cannot write '%.300s': %s", name, strerror(errno));
    } else {
        result = write_blessed(f, &to, error);
        rheo_result closed = rheo__writer_close(&to, result == RHEO_OK ? error : NULL);
        result = result == RHEO_OK ? closed : result;
        if (result == RHEO_OK)
            result = rheo__replace_by(f->old_path, name, error);
        else
            remove(name);
    }
    free(name);
    return result;
}

static rheo_result bless(blessing_files *f, rheo_verification *difference, rheo_error *error)
{
    RHEO__TRY(check_because(f->because, error));
    RHEO__TRY(check_new(f->new_path, error));
    RHEO__TRY(rheo_recording_open(f->new_path, &f->new, error));
    if (rheo__file_exists(f->old_path)) {
        rheo_error unreadable; /* an old format or damage may be the reason for the blessing */
        RHEO__TRY(rheo_diff(f->old_path, f->new_path, difference, error));
        rheo_recording_open(f->old_path, &f->old, &unreadable);
    } else {
        snprintf(difference->message, sizeof difference->message, "not compared: there is no '%.300s' yet",
                 f->old_path);
    }
    return is_unchanged(f, difference) ? RHEO_OK : replace(f, error);
}

rheo_result rheo_bless(const char *old_path, const char *new_path, const char *because, rheo_verification *difference,
                       rheo_error *error)
{
    memset(difference, 0, sizeof *difference);
    blessing_files f = {.old_path = old_path, .new_path = new_path, .because = because};
    rheo_result result = bless(&f, difference, error);
    rheo_recording_close(f.old);
    rheo_recording_close(f.new);
    return result;
}
