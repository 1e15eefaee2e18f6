/* Scenes as the text of a file whose place is known. */
#ifndef RHEOLOG_JSON_SCENE_JSON_WRITE_H
#define RHEOLOG_JSON_SCENE_JSON_WRITE_H

#include "rheolog/scene.h"

/*
 * Writes a scene as text for a file with this path: the paths of its meshes count from the folder of the file. Release
 * *text with free().
 */
rheo_result rheo__scene_to_json_beside(const rheo_scene *scene, const char *path, char **text, rheo_error *error);

#endif
