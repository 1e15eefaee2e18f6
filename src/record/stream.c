/*
 * Reading and writing files. Every write is flushed, so that a program that is killed leaves complete writes.
 */
#ifndef _FILE_OFFSET_BITS
#define _FILE_OFFSET_BITS 64
#endif
#ifndef _POSIX_C_SOURCE
#define _POSIX_C_SOURCE 200809L /* fseeko(): recordings may exceed a 32-bit long */
#endif
#include "record/stream.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>

#include "core/error.h"
#include "record/lock.h"

void rheo__writer_name(rheo__writer *writer, const char *path)
{
    snprintf(writer->path, sizeof writer->path, "%s", path);
}

rheo_result rheo__writer_write(rheo__writer *writer, const void *data, size_t size, rheo_error *error)
{
    if (!writer->file) {
        rheo__put_raw(writer->memory, data, size);
        if (writer->memory->failed)
            return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for %zu bytes of a recording", size);
    } else if (fwrite(data, 1, size, writer->file) != size || fflush(writer->file) != 0) {
        return rheo__fail(error, RHEO_ERROR_FILE, "cannot write %s: %s", writer->path, strerror(errno));
    }
    writer->written += size;
    return RHEO_OK;
}

rheo_result rheo__writer_close(rheo__writer *writer, rheo_error *error)
{
    FILE *file = writer->file;
    rheo__bytes_release(&writer->frame);
    writer->file = NULL;
    if (file)
        rheo__lock_end(file); /* a process that was forked meanwhile has the file, too */
    if (file && fclose(file) != 0)
        return rheo__fail(error, RHEO_ERROR_FILE, "cannot close %s: %s", writer->path, strerror(errno));
    return RHEO_OK;
}

/* After a power failure a file may end with zeros, whose bytes never reached the disk. No recording has so many. */
static rheo_result drop_zeros(rheo__reader *reader, rheo_error *error)
{
    enum { BLOCK = 4096, MOST = 15, FARTHEST = 1 << 28 };
    uint8_t block[BLOCK];
    uint64_t end = reader->size;
    size_t left = 0; /* bytes of the block up to its last one that is not zero */
    while (end > 0 && left == 0 && reader->size - end < FARTHEST) {
        const size_t count = end < BLOCK ? (size_t)end : BLOCK;
        RHEO__TRY(rheo__reader_read(reader, end - count, block, count, error));
        for (left = count; left > 0 && block[left - 1] == 0; left--)
            ;
        end -= count - left;
    }
    if (reader->size - end > MOST) {
        reader->zeros = true;
        reader->size = end;
    }
    return RHEO_OK;
}

rheo_result rheo__reader_open(rheo__reader *reader, const char *path, rheo_error *error)
{
    enum { TRIES = 20 };
    for (int n = 0;; n++) {
        *reader = (rheo__reader){.file = fopen(path, "rb")};
        if (!reader->file)
            return rheo__fail(error, RHEO_ERROR_FILE, "cannot be opened: %s", strerror(errno));
        /* Asked before the size is read: a file that is complete by then is not taken for a truncated one. */
        reader->growing = rheo__lock_is_held(reader->file);
        /* A writer may have put a thinned file in its place, and has the lock of that one. */
        if (reader->growing || n == TRIES || rheo__lock_is_named(reader->file, path))
            break;
        fclose(reader->file);
    }
    struct stat status = {0};
    if (fstat(fileno(reader->file), &status) == 0 && S_ISDIR(status.st_mode)) {
        rheo__reader_close(reader);
        return rheo__fail(error, RHEO_ERROR_FILE, "is a folder, not a recording");
    }
    off_t size = -1;
    if (fseeko(reader->file, 0, SEEK_END) != 0 || (size = ftello(reader->file)) < 0 ||
        fseeko(reader->file, 0, SEEK_SET) != 0) {
        rheo__fail(error, RHEO_ERROR_FILE, "cannot be read: %s; a regular file can", strerror(errno));
        rheo__reader_close(reader);
        return RHEO_ERROR_FILE;
    }
    reader->size = (uint64_t)size;
    const rheo_result result = drop_zeros(reader, error);
    if (result != RHEO_OK)
        rheo__reader_close(reader);
    return result;
}

void rheo__reader_close(rheo__reader *reader)
{
    if (reader->file)
        fclose(reader->file);
    rheo__bytes_release(&reader->frame);
    *reader = (rheo__reader){0};
}

rheo_result rheo__reader_read(rheo__reader *reader, uint64_t offset, void *to, size_t size, rheo_error *error)
{
    if (!reader->file) {
        if (size)
            memcpy(to, reader->memory + offset, size);
        return RHEO_OK;
    }
    if (offset != reader->offset && fseeko(reader->file, (off_t)offset, SEEK_SET) != 0)
        return rheo__fail(error, RHEO_ERROR_FILE, "cannot read the recording: %s", strerror(errno));
    size_t got = fread(to, 1, size, reader->file);
    reader->offset = offset + got;
    if (got == size)
        return RHEO_OK;
    if (ferror(reader->file)) {
        clearerr(reader->file);
        return rheo__fail(error, RHEO_ERROR_FILE, "cannot read the recording: %s", strerror(errno));
    }
    clearerr(reader->file);
    return rheo__fail(error, RHEO_ERROR_FILE, "the recording has become shorter while it was read");
}
