/* Reads shapes of scenes. */
#ifndef RHEOLOG_SCENE_JSON_SHAPE_H
#define RHEOLOG_SCENE_JSON_SHAPE_H

#include "json/json_reader.h"
#include "rheolog/scene.h"

/* Reads a shape such as {"block": {...}}, and adds it to the scene r->user. */
rheo_result rheo__scene_read_shape(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value);

/* Reads an obstacle such as {"sphere": {...}}, and adds it to the scene r->user. */
rheo_result rheo__scene_read_obstacle(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value);

/* The only member of an object, and its place; NULL if it has none or several. */
const json_t *rheo__scene_only_member(const json_t *value, rheo__json_place *place);
/*
 * Puts the folder of the scene file in front of a relative path. A name without a dot is a built-in mesh, not a path.
 */
rheo_result rheo__scene_complete_path(const rheo__json_reader *r, const rheo__json_place *at, char *path,
                                      size_t size);

/* Converts the result of adding an item to the scene. Refuses the value if the scene has too many items. */
rheo_result rheo__scene_added(const rheo__json_reader *r, const rheo__json_place *at, rheo_result result,
                              const rheo_error *error);

#endif
