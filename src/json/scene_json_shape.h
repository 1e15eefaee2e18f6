/* Reads shapes of scenes. */
#ifndef RHEOLOG_SCENE_JSON_SHAPE_H
#define RHEOLOG_SCENE_JSON_SHAPE_H

#include "json/json_reader.h"
#include "rheolog/scene.h"

/* Reads a shape such as {"block": {...}}, and adds it to the scene r->user. */
rheo_result rheo__scene_read_shape(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value);

/* Converts the result of adding an item to the scene. Refuses the value if the scene has too many items. */
rheo_result rheo__scene_added(const rheo__json_reader *r, const rheo__json_place *at, rheo_result result,
                              const rheo_error *error);

#endif
