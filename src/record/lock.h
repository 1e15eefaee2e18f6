/* Locks that keep a second writer away from a recording, and tell one that is being written from a truncated one. */
#ifndef RHEO__RECORD_LOCK_H
#define RHEO__RECORD_LOCK_H

#include <stdio.h>

#include "rheolog/base.h"

enum { RHEO__NO_LOCK = -1 };

/*
 * Locks a file that is open for writing, until it is closed. `path` names it. RHEO_ERROR_ARGUMENT if another writer
 * has it, or has put another file in its place.
 */
rheo_result rheo__lock_file(FILE *file, const char *path, rheo_error *error);
/* Ends the lock of a file before it is closed. All has been written. */
void rheo__lock_end(FILE *file);
/*
 * Locks the file that `path` names at present, so that nobody begins to write it. *lock is RHEO__NO_LOCK if there is
 * no regular file or it cannot be locked. RHEO_ERROR_ARGUMENT if it is being written.
 */
rheo_result rheo__lock_path(const char *path, int *lock, rheo_error *error);
void rheo__lock_release(int lock);
/* Whether `path` names the file, and not another one that was put in its place. */
bool rheo__lock_is_named(FILE *file, const char *path);
/* Whether a writer has the file locked. */
bool rheo__lock_is_held(FILE *file);

#endif
