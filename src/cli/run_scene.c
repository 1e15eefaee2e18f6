/* Makes the scene of `rheolog run` and `rheolog check` from a built-in scene or a JSON file, and applies --set. */
#include "cli/run.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "cli/shell.h"
#include "json/file_name.h"
#include "rheolog/scene_json.h"

bool cli_is_builtin(const char *name)
{
    rheo_scene scene;
    if (rheo_scene_builtin(name, &scene, NULL) != RHEO_OK)
        return false;
    rheo_scene_release(&scene);
    return true;
}

bool cli_is_scene_file(const char *name)
{
    return strchr(name, '/') || rheo__json_ends_with(name, ".json") || (!cli_is_builtin(name) && cli_exists(name));
}

static int unknown_scene(const cli_command *command, const char *name)
{
    rheo_scene scene;
    char nearest[sizeof scene.name] = "", all[512] = "", suggestion[CLI_SUGGESTION];
    for (size_t i = 0; rheo_scene_builtin_at(i, &scene) == RHEO_OK; i++) {
        const size_t length = strlen(all);
        snprintf(all + length, sizeof all - length, "%s%s", i ? ", " : "", scene.name);
        if (i == 0 || rheo_nearest_word(name, (const char *const[]){nearest, scene.name}, 2) == scene.name)
            memcpy(nearest, scene.name, sizeof nearest);
        rheo_scene_release(&scene);
    }
    return cli_usage(command, "unknown scene \"%s\"%s The built-in ones: %s; a scene file's name ends in .json", name,
                     *cli_did_you_mean(name, nearest, suggestion) ? suggestion : ".", all);
}

static int read_scene_file(const char *path, rheo_scene *scene)
{
    const int status = cli_check_input(path);
    if (status != CLI_DONE)
        return status;
    rheo_error error = {""};
    const rheo_result result = rheo_scene_read_json(path, scene, &error);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

int cli_find_scene(const cli_command *command, const char *name, rheo_scene *scene)
{
    char word[CLI_FILE_WORD];
    if (rheo__json_ends_with(name, ".rlog"))
        return cli_usage(command, "%s is a recording, not a scene; to go on from it: `rheolog run --from %s`", name,
                         cli_file_word(name, word));
    if (cli_is_scene_file(name))
        return read_scene_file(name, scene);
    return rheo_scene_builtin(name, scene, NULL) == RHEO_OK ? CLI_DONE : unknown_scene(command, name);
}

int cli_change_scene(const cli_command *command, rheo_scene *scene, const cli_list *set)
{
    for (size_t i = 0; i < set->count; i++) {
        char key[128];
        const char *value = NULL;
        rheo_error error = {""};
        const int status = cli_split_setting(command, set->item[i], key, sizeof key, &value);
        if (status != CLI_DONE)
            return status;
        const rheo_result result = rheo_scene_set(scene, key, value, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
        char *member = strchr(key, '.');
        if (strncmp(key, "ball", 4) == 0 && member && strcmp(member, ".position") == 0) {
            snprintf(member, sizeof key - (size_t)(member - key), ".clearance");
            rheo_scene_set(scene, key, "-1", NULL); /* a clearance would override the position */
        }
    }
    return CLI_DONE;
}

int cli_scene_error(const char *name, bool changed, rheo_result result, const rheo_error *error)
{
    rheo_error named = *error;
    if (cli_is_scene_file(name) && !changed && result != RHEO_ERROR_MEMORY)
        snprintf(named.message, sizeof named.message, "%.160s: %.340s", name, error->message);
    return cli_error(result, &named);
}

int cli_write_scene(const char *name, bool changed, const rheo_scene *scene)
{
    rheo_error error = {""};
    const rheo_result result = rheo_scene_check(scene, &error);
    if (result != RHEO_OK)
        return cli_scene_error(name, changed, result, &error);
    char *text = rheo_scene_to_json(scene);
    if (!text)
        return cli_fail(CLI_SYSTEM, "no memory to write the scene");
    fputs(text, stdout);
    free(text);
    return CLI_DONE;
}
