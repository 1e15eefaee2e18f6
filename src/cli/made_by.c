/*
 * What a recording of `rheolog run` says about how it was made: the command and the scene. Equal runs have equal
 * recordings, so it has no folders, and nothing that changes neither the bits nor what is stored: no -o, --steps,
 * --force, --simd, --json, --quiet.
 */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <string.h>

#include "cli/run.h"
#include "cli/shell.h"
#include "rheolog/scene_json.h"

static const char *without_folders(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

char *cli_made_by(const cli_run_request *request)
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    if (!file)
        return NULL;
    fputs("rheolog run", file);
    if (request->from)
        fputs(" --from", file);
    cli_put_word(file, without_folders(request->from ? request->from : request->scene));
    for (size_t i = 0; i < request->set->count; i++) {
        fputs(" --set", file);
        cli_put_word(file, request->set->item[i]);
    }
    if (request->keyframes)
        fprintf(file, " --keyframes %llu", (unsigned long long)request->keyframes);
    if (request->full)
        fputs(" --full", file);
    const bool failed = ferror(file) != 0;
    if (fclose(file) != 0 || failed) {
        free(text);
        return NULL;
    }
    return text;
}

/* Takes the folder of the scene file away from the paths of its meshes, which its reader had put there. */
static void strip_folder(rheo_scene *scene, const char *name)
{
    const char *slash = strrchr(name, '/');
    const size_t length = slash ? (size_t)(slash - name) + 1 : 0;
    for (size_t i = 0; i < scene->fill_count && length; i++) {
        const rheo_shape *shape = rheo_shape_at(scene->fill[i].kind);
        for (size_t m = 0; m < shape->member_count; m++) {
            char *path = (char *)&scene->fill[i] + shape->member[m].offset;
            if (shape->member[m].type == RHEO_SHAPE_FILE && strncmp(path, name, length) == 0)
                memmove(path, path + length, strlen(path + length) + 1);
        }
    }
}

char *cli_scene_text(const rheo_scene *scene, const char *name)
{
    rheo_scene told = *scene;
    const size_t bytes = scene->fill_count * sizeof *scene->fill;
    rheo_fill *fill = malloc(bytes + 1);
    if (!fill)
        return NULL;
    if (bytes)
        memcpy(fill, scene->fill, bytes);
    told.fill = fill;
    if (cli_is_scene_file(name))
        strip_folder(&told, name);
    char *text = rheo_scene_to_json(&told);
    free(fill);
    return text;
}
