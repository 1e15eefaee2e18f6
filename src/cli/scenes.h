/* Shared by the files of `rheolog scenes`. */
#ifndef CLI_SCENES_H
#define CLI_SCENES_H

#include "rheolog/scene.h"

/* Whether a model has a parameter. */
bool cli_has_parameter(rheo_model model, const rheo_parameter *p);
/* Writes the default of a parameter in scenes of a model as text. `value` holds >= 128 bytes. Returns `value`. */
const char *cli_parameter_default(rheo_model model, const rheo_parameter *p, char *value);
/* Default of a parameter of rheo_obstacle_parameter_at(), for a shape that has it. Returns `value`, which holds 128 bytes. */
const char *cli_obstacle_default(rheo_obstacle_shape shape, const rheo_parameter *p, char *value);
/* First model that has the parameter. */
rheo_model cli_first_model(const rheo_parameter *p);

/* Number of parameters whose paths begin with one of the prefixes; all if there are none. */
size_t cli_parameters_wanted(size_t count, char **prefix);
/* Prints these. */
void cli_parameters_text(size_t count, char **prefix);
/* Prints one JSON object for each of these, one per line. */
void cli_parameters_json(size_t count, char **prefix);
/* Prints the page docs/parameters.md. */
void cli_parameters_markdown(void);

#endif
