/* Reads and writes scene files. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "json/json_error.h"
#include "json/scene_json_write.h"
#include "rheolog/scene_json.h"
#include "rheolog/view.h"

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

rheo_result rheo_scene_write_json(const rheo_scene *scene, const char *path, bool force, rheo_error *error)
{
    char *text = NULL;
    rheo_result result = rheo__scene_to_json_beside(scene, path, &text, error);
    if (result == RHEO_OK)
        result = rheo_export_bytes(path, text, strlen(text), force, error);
    free(text);
    return result;
}
