/* Reads the lists of named items of scenes. */
#ifndef RHEOLOG_SCENE_JSON_LISTED_H
#define RHEOLOG_SCENE_JSON_LISTED_H

#include "json/json_reader.h"
#include "rheolog/scene.h"

/* Read a material or an emitter, and add it to the scene r->user. */
rheo_result rheo__scene_read_material(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value);
rheo_result rheo__scene_read_emitter(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value);

/* Reads the value of a parameter of the scene r->user (scene_json_read.c). */
rheo_result rheo__scene_read_parameter(const rheo__json_reader *r, const rheo__json_place *at, const json_t *value,
                                       const rheo_parameter *p);

#endif
