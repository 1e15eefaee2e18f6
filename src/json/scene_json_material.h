/* Reads the materials of scenes. */
#ifndef RHEOLOG_SCENE_JSON_MATERIAL_H
#define RHEOLOG_SCENE_JSON_MATERIAL_H

#include "json/json_reader.h"
#include "rheolog/scene.h"

/* Reads a material such as {"name": "cornstarch", "springs": {...}}, and adds it to the scene r->user. */
rheo_result rheo__scene_read_material(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value);

#endif
