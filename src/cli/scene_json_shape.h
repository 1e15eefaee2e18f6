/* Reads shapes of scenes. */
#ifndef CLI_SCENE_JSON_SHAPE_H
#define CLI_SCENE_JSON_SHAPE_H

#include "cli/json_reader.h"
#include "rheolog/scene.h"

/* Reads a shape such as {"block": {...}}, and adds it to the scene r->user. */
rheo_result cli_scene_read_shape(const cli_json_reader *r, const cli_json_place *at, const json_t *value);

/* Converts the result of adding an item to the scene. Refuses the value if the scene has too many items. */
rheo_result cli_scene_added(const cli_json_reader *r, const cli_json_place *at, rheo_result result,
                            const rheo_error *error);

#endif
