/* Advice for a scene: only what the scene can be made with, and what brings a measure into its range. */
#include <stdio.h>
#include <string.h>

#include "core/strict.h"
#include "scenes/making.h"

/* Whether the scene can be made with `set` as well. *def: its definition then. */
static bool bears(const rheo_scene *scene, const char *set, rheo_world_def *def)
{
    rheo_scene changed = *scene;
    const char *value = strchr(set, '=');
    char path[sizeof((rheo_advice *)NULL)->set];
    if (!value)
        return false;
    snprintf(path, sizeof path, "%.*s", (int)(value - set), set);
    return rheo_scene_set(&changed, path, value + 1, NULL) == RHEO_OK &&
           rheo__scene_check_parameters(&changed, def, NULL) == RHEO_OK;
}

bool rheo__condition_of_scene(const rheo_scene *scene, const rheo_world_def *def, rheo__known_speeds speeds,
                              uint32_t row, rheo__condition *condition)
{
    if (!rheo__condition_of(def, speeds, row, condition))
        return false;
    const uint32_t count = condition->advice_count;
    condition->advice_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        rheo_world_def changed;
        rheo__condition still;
        if (!bears(scene, condition->advice[i].set, &changed))
            continue;
        changed.fluid.spacing = def->fluid.spacing; /* that of the filling */
        if (!rheo__condition_of(&changed, speeds, row, &still))
            condition->advice[condition->advice_count++] = condition->advice[i];
    }
    return true;
}

bool rheo__scene_bears(const rheo_scene *scene, const char *set)
{
    rheo_world_def def;
    return bears(scene, set, &def);
}
