/* Refuses scene files in a program that was built without jansson. */
#include <stdio.h>

#include "cli/scene_json.h"

rheo_result cli_scene_from_json(const char *text, size_t size, const char *file_name, rheo_scene *scene,
                                rheo_error *error)
{
    (void)text, (void)size, (void)scene;
    if (error)
        snprintf(error->message, sizeof error->message,
                 "%s: this program was built without JSON scenes; build it with jansson, or run a built-in scene",
                 file_name);
    return RHEO_ERROR_UNSUPPORTED;
}
