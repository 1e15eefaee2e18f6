/*
 * What a recording of `rheolog run` says about how it was made: the command and the scene. Equal runs have equal
 * recordings, so it has no folders but those that the scene file itself names, and nothing that changes neither the
 * bits nor what is stored: no -o, --steps, --force, --continue, --until-unhealthy, --simd, --json, --quiet.
 */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <string.h>

#include "cli/run.h"
#include "cli/shell.h"
#include "json/file_name.h"
#include "json/scene_json_write.h"
#include "rheolog/scene_json.h"

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
    cli_put_word(file, rheo__json_file_name(request->from ? request->from : request->scene));
    for (size_t i = 0; i < request->set->count; i++) {
        fputs(" --set", file);
        cli_put_word(file, request->set->item[i]);
    }
    if (request->keyframes)
        fprintf(file, " --keyframes %llu", (unsigned long long)request->keyframes);
    if (request->max_bytes)
        fprintf(file, " --max-size %llu", (unsigned long long)request->max_bytes);
    if (request->full)
        fputs(" --full", file);
    const bool failed = ferror(file) != 0;
    if (fclose(file) != 0 || failed) {
        free(text);
        return NULL;
    }
    return text;
}

char *cli_scene_text(const rheo_scene *scene, const char *name)
{
    char *text = NULL;
    if (!cli_is_scene_file(name))
        return rheo_scene_to_json(scene);
    rheo__scene_to_json_beside(scene, name, &text, NULL);
    return text;
}
