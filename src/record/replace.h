/* Which files a new one may replace, and how it takes their place. All files of the library are written like this. */
#ifndef RHEO__RECORD_REPLACE_H
#define RHEO__RECORD_REPLACE_H

#include "record/stream.h"

/* Whether something has this name: a link that leads to no file, too. */
bool rheo__file_exists(const char *path);
/*
 * The file that is written: the one that a link at `path` leads to, so that the link stays. Release *target with free().
 * RHEO_ERROR_ARGUMENT if the link leads to no file, or if that is no regular one.
 */
rheo_result rheo__output_target(const char *path, char **target, rheo_error *error);
/* "F exists; give --force ...": RHEO_ERROR_ARGUMENT. */
rheo_result rheo__exists(const char *path, rheo_error *error);
/* RHEO_ERROR_ARGUMENT if what is at `path`, which exists, is being written or is no recording. */
rheo_result rheo__is_replaceable(const char *path, rheo_error *error);
/* Opens a new file beside `path`; `name`, of strlen(path) + 16 bytes, receives its name. */
FILE *rheo__open_beside(const char *path, char *name);
/* What was at a path when the work on its new contents began: an open file, or NULL for nothing. */
typedef struct rheo__found {
    FILE *file;
} rheo__found;
/*
 * Renames that file to `path`. Removes it if that fails, or if the old file is being written. RHEO_ERROR_ARGUMENT, too, if
 * `found` is given and something else is there now: what it says would be lost unread.
 */
rheo_result rheo__replace_by(const char *path, const rheo__found *found, const char *name, rheo_error *error);
/* Writes the contents of a file. */
typedef rheo_result rheo__write_file(rheo__writer *to, const void *user, rheo_error *error);
/*
 * Writes a new file beside `path` and renames it; `found` as above. After an error there is no such file, and the old one is
 * as it was.
 */
rheo_result rheo__write_beside(const char *path, const rheo__found *found, rheo__write_file *write, const void *user,
                               rheo_error *error);

#endif
