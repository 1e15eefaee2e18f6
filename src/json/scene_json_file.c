/* Reads and writes scene files. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "json/json_error.h"
#include "json/scene_json_write.h"
#include "rheolog/scene_json.h"

/* Reads a file to its end, or one block past the limit. */
static rheo_result read_text(FILE *file, const char *path, char **text, size_t *size, rheo_error *error)
{
    size_t room = 0;
    while (*size <= RHEO_MAX_SCENE_BYTES) {
        if (*size == room) {
            room = room ? 2 * room : 65536;
            char *larger = realloc(*text, room);
            if (!larger)
                return rheo__json_fail(error, RHEO_ERROR_MEMORY, "no memory to read %s", path);
            *text = larger;
        }
        const size_t got = fread(*text + *size, 1, room - *size, file);
        if (got == 0)
            break;
        *size += got;
    }
    if (ferror(file))
        return rheo__json_fail(error, RHEO_ERROR_FILE, "cannot read %s to its end: %s", path, strerror(errno));
    if (*size > RHEO_MAX_SCENE_BYTES)
        return rheo__json_fail(error, RHEO_ERROR_ARGUMENT, "%s is no scene file: it has more than %zu MiB", path,
                               RHEO_MAX_SCENE_BYTES >> 20);
    return RHEO_OK;
}

rheo_result rheo_scene_read_json(const char *path, rheo_scene *scene, rheo_error *error)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return rheo__json_fail(error, RHEO_ERROR_FILE, "cannot read %s: %s", path, strerror(errno));
    char *text = NULL;
    size_t size = 0;
    rheo_result result = read_text(file, path, &text, &size, error);
    fclose(file);
    if (result == RHEO_OK)
        result = rheo_scene_from_json(text, size, path, scene, error);
    free(text);
    return result;
}

/* Creates a new file beside `path`. `name` holds 16 bytes more than the path. */
static FILE *open_beside(const char *path, char *name)
{
    FILE *file = NULL;
    errno = EEXIST;
    for (int n = 0; n < 1000 && !file && errno == EEXIST; n++) {
        snprintf(name, strlen(path) + 16, "%s.tmp-%d", path, n);
        file = fopen(name, "wbx");
    }
    return file;
}

static rheo_result write_text(const char *text, const char *path, char *name, rheo_error *error)
{
    FILE *file = open_beside(path, name);
    if (!file)
        return rheo__json_fail(error, RHEO_ERROR_FILE, "cannot write %s: %s", path, strerror(errno));
    const bool written = fputs(text, file) != EOF;
    if (fclose(file) == 0 && written && rename(name, path) == 0)
        return RHEO_OK;
    rheo__json_fail(error, RHEO_ERROR_FILE, "cannot write %s: %s", path, strerror(errno));
    remove(name);
    return RHEO_ERROR_FILE;
}

static bool exists(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (file)
        fclose(file);
    return file || errno != ENOENT; /* a file that cannot be read exists, too */
}

rheo_result rheo_scene_write_json(const rheo_scene *scene, const char *path, bool force, rheo_error *error)
{
    if (!force && exists(path))
        return rheo__json_fail(error, RHEO_ERROR_ARGUMENT, "%s exists already; replacing it needs force", path);
    char *text = NULL, *name = malloc(strlen(path) + 16);
    rheo_result result = name ? rheo__scene_to_json_beside(scene, path, &text, error)
                              : rheo__json_fail(error, RHEO_ERROR_MEMORY, "no memory to write %s", path);
    if (result == RHEO_OK)
        result = write_text(text, path, name, error);
    free(name);
    free(text);
    return result;
}
