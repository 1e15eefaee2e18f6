/*
 * Locks of recordings. flock() is used because its lock belongs to the open file: it excludes two recorders of one
 * process too, it ends with the process, and closing another handle of the file does not release it, as it would a
 * lock of POSIX. Linux extends it to NFS. WebAssembly has no locks, and some file systems refuse them; files are
 * then written without one.
 */
#define _POSIX_C_SOURCE 200809L
#define _FILE_OFFSET_BITS 64
#include "record/lock.h"

#include "core/error.h"

#ifdef __wasi__

rheo_result rheo__lock_file(FILE *file, const char *path, rheo_error *error)
{
    (void)file, (void)path, (void)error;
    return RHEO_OK;
}

rheo_result rheo__lock_path(const char *path, int *lock, rheo_error *error)
{
    (void)path, (void)error;
    *lock = RHEO__NO_LOCK;
    return RHEO_OK;
}

void rheo__lock_end(FILE *file)
{
    (void)file;
}

void rheo__lock_release(int lock)
{
    (void)lock;
}

bool rheo__lock_is_named(FILE *file, const char *path)
{
    (void)file, (void)path;
    return true;
}

bool rheo__lock_is_held(FILE *file)
{
    (void)file;
    return false;
}

#else

#include <sys/file.h>
#include <sys/stat.h>
#include <errno.h>
#include <fcntl.h>
#include <time.h>
#include <unistd.h>

/* A reader holds a lock for an instant, to see whether there is a writer. A writer waits as long for it. */
enum { TRIES = 20, PAUSE_NS = 10000000 };

typedef enum outcome { LOCKED, HELD, NOT_POSSIBLE } outcome;

static outcome try_lock(int descriptor, int operation)
{
    for (;;) {
        if (flock(descriptor, operation | LOCK_NB) == 0)
            return LOCKED;
        if (errno != EINTR)
            return errno == EWOULDBLOCK ? HELD : NOT_POSSIBLE;
    }
}

static bool is_named(int descriptor, const char *path)
{
    struct stat file = {0}, named = {0};
    return fstat(descriptor, &file) == 0 && stat(path, &named) == 0 && file.st_dev == named.st_dev &&
           file.st_ino == named.st_ino;
}

bool rheo__lock_is_named(FILE *file, const char *path)
{
    return is_named(fileno(file), path);
}

static void pause_once(void)
{
    nanosleep(&(struct timespec){0, PAUSE_NS}, NULL);
}

static rheo_result refuse(const char *path, rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "%.300s is being written by another program; end that one, or take another name", path);
}

rheo_result rheo__lock_file(FILE *file, const char *path, rheo_error *error)
{
    outcome got = HELD;
    fcntl(fileno(file), F_SETFD, FD_CLOEXEC); /* a program that is started meanwhile would keep the lock */
    for (int n = 0; n < TRIES && got == HELD; n++) {
        if (n > 0)
            pause_once();
        got = try_lock(fileno(file), LOCK_EX);
    }
    return got == HELD || !is_named(fileno(file), path) ? refuse(path, error) : RHEO_OK;
}

/* A network file system locks only what is open for writing. */
static int open_to_lock(const char *path)
{
    const int flags = O_NONBLOCK | O_NOCTTY | O_CLOEXEC, descriptor = open(path, O_RDWR | flags);
    return descriptor >= 0 ? descriptor : open(path, O_RDONLY | flags);
}

rheo_result rheo__lock_path(const char *path, int *lock, rheo_error *error)
{
    *lock = RHEO__NO_LOCK;
    for (int n = 0; n < TRIES; n++) {
        if (n > 0)
            pause_once();
        struct stat status = {0};
        if (stat(path, &status) != 0 || !S_ISREG(status.st_mode))
            return RHEO_OK;
        const int descriptor = open_to_lock(path);
        if (descriptor < 0)
            return RHEO_OK;
        const outcome got = try_lock(descriptor, LOCK_EX);
        if (got == LOCKED && is_named(descriptor, path)) {
            *lock = descriptor;
            return RHEO_OK;
        }
        close(descriptor);
        if (got == NOT_POSSIBLE)
            return RHEO_OK;
    }
    return refuse(path, error);
}

void rheo__lock_end(FILE *file)
{
    flock(fileno(file), LOCK_UN);
}

void rheo__lock_release(int lock)
{
    if (lock != RHEO__NO_LOCK)
        close(lock);
}

bool rheo__lock_is_held(FILE *file)
{
    const outcome got = try_lock(fileno(file), LOCK_SH);
    if (got == LOCKED)
        flock(fileno(file), LOCK_UN);
    return got == HELD;
}

#endif
