/* Writes values of parameters as JSON. */
#ifndef RHEOLOG_JSON_PARAMETER_H
#define RHEOLOG_JSON_PARAMETER_H

#include "json/json_writer.h"
#include "rheolog/world.h"

/* Writes the value of a parameter. The value is a text from rheo_scene_get(). */
void rheo__json_parameter(rheo__json *json, const char *key, const rheo_parameter *parameter, const char *value);

#endif
