/* Writing a recording again with other chunks before its first keyframe or after its last step. */
#define _POSIX_C_SOURCE 200809L
#include <sys/stat.h>

#include "record/recording.h"

rheo_result rheo__recording_copy(rheo_recording *from, uint64_t offset, uint64_t end, rheo__writer *to,
                                 rheo_error *error)
{
    while (offset < end) {
        size_t size = end - offset < RHEO__PIECE ? (size_t)(end - offset) : RHEO__PIECE;
        if (!rheo__bytes_resize(&from->payload, size))
            return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to copy %.300s", from->head.scene);
        RHEO__TRY(rheo__reader_read(&from->reader, offset, from->payload.data, size, error));
        RHEO__TRY(rheo__writer_write(to, from->payload.data, size, error));
        offset += size;
    }
    return RHEO_OK;
}

rheo_result rheo__recording_copy_end(const rheo_recording *r, uint64_t moved, rheo__writer *to, rheo_error *error)
{
    rheo__bytes index = {0};
    for (size_t i = 0; i < r->keyframe_count; i++)
        rheo__index_put(&index, r->keyframes[i].step, r->keyframes[i].start + moved, r->keyframes[i].end + moved);
    rheo_result result = index.failed
                             ? rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the index of the recording")
                             : rheo__recording_write_end(to, &index, r->first_step, r->last_step,
                                                         r->has_last_hash ? &r->last_hash : NULL, error);
    rheo__bytes_release(&index);
    return result;
}

void rheo__keep_mode(const char *path, rheo__writer *to)
{
#ifndef __wasi__ /* it has no modes */
    struct stat status = {0};
    if (stat(path, &status) == 0)
        (void)fchmod(fileno(to->file), status.st_mode & 07777);
#else
    (void)path, (void)to;
#endif
}
