/* Finds built-in scenes. */
#include "scenes/builtin.h"

#include <stdio.h>
#include <string.h>

#include "core/error.h"
#include "core/strict.h"
#include "scenes/arrays.h"

/* Room of the arrays in every built-in scene. */
enum { MOST_FILLS = 16, MOST_WALLS = 8, MOST_VIBRATORS = 32 };

static const rheo__builtins *const OF_MODEL[] = {&rheo__builtin_thickening, &rheo__builtin_melting};
enum { MODELS = sizeof OF_MODEL / sizeof *OF_MODEL };

size_t rheo_scene_builtin_count(void)
{
    size_t count = 0;
    for (size_t m = 0; m < MODELS; m++)
        count += OF_MODEL[m]->count;
    return count;
}

/* A scene by number, and its model. */
static const rheo__builtin *builtin_at(size_t index, rheo_model *model)
{
    for (size_t m = 0; m < MODELS; index -= OF_MODEL[m++]->count)
        if (index < OF_MODEL[m]->count) {
            *model = OF_MODEL[m]->model;
            return &OF_MODEL[m]->scene[index];
        }
    return NULL;
}

rheo_result rheo_scene_builtin_at(size_t index, rheo_scene *scene)
{
    rheo_model model;
    const rheo__builtin *builtin = builtin_at(index, &model);
    if (!builtin)
        return RHEO_ERROR_ARGUMENT;
    *scene = rheo_default_model_scene(model);
    if (!rheo__scene_reserve(scene, MOST_FILLS, MOST_WALLS, MOST_VIBRATORS)) {
        rheo_scene_release(scene);
        return RHEO_ERROR_MEMORY;
    }
    snprintf(scene->name, sizeof scene->name, "%s", builtin->name);
    snprintf(scene->about, sizeof scene->about, "%s", builtin->about);
    builtin->make(scene);
    return RHEO_OK;
}

rheo_result rheo_scene_builtin(const char *name, rheo_scene *scene, rheo_error *error)
{
    char known[512] = "";
    rheo_model model;
    const rheo__builtin *builtin;
    for (size_t i = 0; (builtin = builtin_at(i, &model)) != NULL; i++) {
        if (strcmp(builtin->name, name) == 0)
            return rheo_scene_builtin_at(i, scene) == RHEO_OK
                       ? RHEO_OK
                       : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the scene \"%s\"", name);
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", builtin->name);
    }
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no built-in scene \"%.60s\"; there are: %s", name, known);
}
