/* Reading shapes of scenes. */
#ifndef CLI_SCENE_JSON_SHAPE_H
#define CLI_SCENE_JSON_SHAPE_H

#include "cli/json_reader.h"
#include "rheolog/scene.h"

/* Reads {"block": {...}} and the like, and adds the shape to the scene r->user. */
rheo_result cli_scene_read_shape(const cli_json_reader *r, const cli_json_place *at, const json_t *value);

/* Result of adding an item to the scene; a scene that has too many is refused. */
rheo_result cli_scene_added(const cli_json_reader *r, const cli_json_place *at, rheo_result result,
                            const rheo_error *error);

#endif
