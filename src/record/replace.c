/*
 * Which files a recording may replace, and how a new file takes the place of an old one. It is written beside the old
 * one and renamed, so that the name always has a whole file. A link stays: the file that it leads to is replaced.
 */
#define _XOPEN_SOURCE 700 /* realpath() */
#define _FILE_OFFSET_BITS 64
#include "record/replace.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "record/lock.h"
#include "record/recording.h"

#define LEADS_NOWHERE "%.300s is a link that leads to no file: %s"

/* ---- What there is ---- */

bool rheo__file_exists(const char *path)
{
    struct stat status = {0};
    return lstat(path, &status) == 0 || (errno != ENOENT && errno != ENOTDIR);
}

static rheo_result not_regular(const char *path, rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.300s is no regular file, so it cannot be replaced", path);
}

static rheo_result check_regular(const char *target, const char *path, rheo_error *error)
{
    struct stat status = {0};
    if (lstat(target, &status) != 0 || S_ISREG(status.st_mode))
        return RHEO_OK;
    return not_regular(path, error);
}

/* The name of the file that is written, whatever it is. */
static rheo_result resolve(const char *path, char **target, rheo_error *error)
{
#ifndef __wasi__ /* it cannot resolve links */
    struct stat status = {0};
    if (lstat(path, &status) == 0 && S_ISLNK(status.st_mode)) {
        *target = realpath(path, NULL);
        return *target ? RHEO_OK : rheo__fail(error, RHEO_ERROR_ARGUMENT, LEADS_NOWHERE, path, strerror(errno));
    }
#endif
    *target = malloc(strlen(path) + 1);
    if (!*target)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to write %.300s", path);
    memcpy(*target, path, strlen(path) + 1);
    return RHEO_OK;
}

rheo_result rheo__output_target(const char *path, char **target, rheo_error *error)
{
    RHEO__TRY(resolve(path, target, error));
    const rheo_result result = check_regular(*target, path, error);
    if (result != RHEO_OK)
        free(*target);
    return result;
}

rheo_result rheo__exists(const char *path, rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.300s exists; give --force to replace it, or another name", path);
}

/* A recording of any version, however little of it there is: a full disk may have left an empty file. */
static bool begins_as_recording(rheo__reader *reader)
{
    enum { LETTERS = 5 }; /* of the magic, before its line end, which a transfer may have converted */
    uint8_t begin[LETTERS];
    const size_t there = reader->size < LETTERS ? (size_t)reader->size : LETTERS;
    return rheo__reader_read(reader, 0, begin, there, NULL) == RHEO_OK && memcmp(begin, rheo__magic, there) == 0;
}

/* *status is that of `path`, links followed; st_mode is 0 if there is nothing. */
static rheo_result check_kind(const char *path, struct stat *status, rheo_error *error)
{
    *status = (struct stat){0};
    if (!rheo__file_exists(path))
        return RHEO_OK;
    if (stat(path, status) != 0)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, LEADS_NOWHERE, path, strerror(errno));
    if (S_ISDIR(status->st_mode))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.300s is a folder; a recording needs the name of a file",
                          path);
    return RHEO_OK;
}

/*
 * Opens what is at `path` and looks at its first bytes, and whether it is blessed. A power failure may have left nothing
 * but zeros of a recording. Zeros may also be somebody's disk image, so they are only gone on with, where the run must
 * agree, and not replaced.
 */
static rheo_result look_into(const char *path, bool zeros_do, bool *recording, bool *blessed, rheo_error *error)
{
    int lock;
    rheo__reader reader;
    rheo_error why;
    RHEO__TRY(rheo__lock_path(path, &lock, error));
    rheo__lock_release(lock);
    if (rheo__reader_open(&reader, path, &why) != RHEO_OK)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.200s %.250s; what cannot be read is not replaced", path,
                          why.message);
    *recording = begins_as_recording(&reader) && (zeros_do || reader.size > 0 || !reader.zeros);
    *blessed = *recording && rheo__reader_is_blessed(&reader);
    rheo__reader_close(&reader);
    return RHEO_OK;
}

rheo_result rheo__is_replaceable(const char *path, rheo_error *error)
{
    struct stat status;
    bool recording, blessed;
    RHEO__TRY(check_kind(path, &status, error));
    if (!S_ISREG(status.st_mode))
        return not_regular(path, error);
    RHEO__TRY(look_into(path, false, &recording, &blessed, error));
    return recording
               ? RHEO_OK
               : rheo__fail(error, RHEO_ERROR_ARGUMENT,
                            "%.300s is not a recording, and only a recording is replaced; give another name", path);
}

rheo_result rheo_output_check(const char *path, rheo_output_use use, rheo_error *error)
{
    struct stat status;
    bool recording, blessed;
    RHEO__TRY(check_kind(path, &status, error));
    if (status.st_mode == 0)
        return RHEO_OK;
    if (!S_ISREG(status.st_mode)) { /* a device, which is written to */
        if (use == RHEO_OUTPUT_CONTINUE)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.300s is no regular file, so it cannot be continued",
                              path);
        return use == RHEO_OUTPUT_REPLACE
                   ? RHEO_OK
                   : rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.300s is no regular file; writing to it needs --force",
                                path);
    }
    RHEO__TRY(look_into(path, use == RHEO_OUTPUT_CONTINUE, &recording, &blessed, error));
    if (blessed)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "%.300s is a blessed golden recording; record under another name, and replace it with "
                          "`rheolog bless`",
                          path);
    if (!recording && use == RHEO_OUTPUT_CONTINUE)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "cannot continue %.300s: this is not a recording", path);
    if (!recording)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%.300s exists and is not a recording; give another name",
                          path);
    return use != RHEO_OUTPUT_NEW ? RHEO_OK
                                  : rheo__fail(error, RHEO_ERROR_ARGUMENT,
                                               "%.300s exists; give --force to replace it, or another name", path);
}

/* ---- Replacing it ---- */

FILE *rheo__open_beside(const char *path, char *name)
{
    FILE *file = NULL;
    errno = EEXIST;
    for (int n = 0; n < 1000 && !file && errno == EEXIST; n++) {
        snprintf(name, strlen(path) + 16, "%s.tmp-%d", path, n);
        file = fopen(name, "wbx");
    }
    return file;
}

static rheo_result changed_meanwhile(const char *path, rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "another program has written %.300s meanwhile; look at that file, and begin again", path);
}

/* Renames, but never over a file. A file system without links leaves an instant in which one can be made. */
static bool rename_to_new(const char *name, const char *path)
{
#ifndef __wasi__
    if (link(name, path) == 0) {
        remove(name);
        return true;
    }
    if (errno == EEXIST)
        return false;
#endif
    if (!rheo__file_exists(path))
        return rename(name, path) == 0;
    errno = EEXIST;
    return false;
}

rheo_result rheo__replace_by(const char *path, const rheo__found *found, const char *name, rheo_error *error)
{
    int lock = RHEO__NO_LOCK; /* of the old file: of two that replace it at once, the second finds the first one's */
    rheo_result result = check_regular(path, path, error); /* another program may have made it */
    if (result == RHEO_OK)
        result = rheo__lock_path(path, &lock, error);
    if (result == RHEO_OK && found && found->file && !rheo__lock_is_named(found->file, path))
        result = changed_meanwhile(path, error);
    const bool renamed =
        result == RHEO_OK && (found && !found->file ? rename_to_new(name, path) : rename(name, path) == 0);
    if (result == RHEO_OK && !renamed)
        result = errno == EEXIST ? changed_meanwhile(path, error)
                                 : rheo__fail(error, RHEO_ERROR_FILE, "cannot rename %.200s to %.200s: %s", name,
                                              path, strerror(errno));
    rheo__lock_release(lock);
    if (result != RHEO_OK)
        remove(name);
    return result;
}

static rheo_result write_beside(const char *target, const rheo__found *found, rheo__write_file *write,
                                const void *user, rheo_error *error)
{
    char *name = malloc(strlen(target) + 16);
    if (!name)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to write %.300s", target);
    rheo__writer to = {.file = rheo__open_beside(target, name)};
    rheo__writer_name(&to, target);
    rheo_result result = to.file
                             ? write(&to, user, error)
                             : rheo__fail(error, RHEO_ERROR_FILE, "cannot write %.300s: %s", name, strerror(errno));
    if (to.file) {
        const rheo_result closed = rheo__writer_close(&to, result == RHEO_OK ? error : NULL);
        result = result == RHEO_OK ? closed : result;
        if (result == RHEO_OK)
            result = rheo__replace_by(target, found, name, error);
        else
            remove(name);
    }
    free(name);
    return result;
}

rheo_result rheo__write_beside(const char *path, const rheo__found *found, rheo__write_file *write, const void *user,
                               rheo_error *error)
{
    char *target;
    RHEO__TRY(rheo__output_target(path, &target, error));
    const rheo_result result = write_beside(target, found, write, user, error);
    free(target);
    return result;
}
