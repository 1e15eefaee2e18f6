/* Shared by the files of `rheolog scenes`. */
#ifndef CLI_SCENES_H
#define CLI_SCENES_H

#include "rheolog/scene.h"

/* Whether a model has a parameter. */
bool cli_has_parameter(rheo_model model, const rheo_parameter *p);
/* Writes the default of a parameter in scenes of a model as text. `value` holds >= 128 bytes. Returns `value`. */
const char *cli_parameter_default(rheo_model model, const rheo_parameter *p, char *value);
/* First model that has the parameter. */
rheo_model cli_first_model(const rheo_parameter *p);

void cli_parameters_text(void);
/* Prints one JSON object per parameter, one per line. */
void cli_parameters_json(void);
/* Prints the page docs/parameters.md. */
void cli_parameters_markdown(void);
/* Prints the JSON schema of scene files (scenes_schema.c). */
void cli_scene_schema(void);

#endif
