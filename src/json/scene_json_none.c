/* Refuses scene files in a program that was built without jansson. */
#include "json/json_error.h"
#include "rheolog/scene_json.h"

rheo_result rheo_scene_from_json(const char *text, size_t size, const char *file_name, rheo_scene *scene,
                                 rheo_error *error)
{
    (void)text, (void)size, (void)scene;
    return rheo__json_fail(
        error, RHEO_ERROR_UNSUPPORTED,
        "%s: this program was built without JSON scenes; build it with jansson, or run a built-in scene", file_name);
}
