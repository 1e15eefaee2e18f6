/* The origin of a recording: output of log and info. */
#ifndef CLI_PROVENANCE_H
#define CLI_PROVENANCE_H

#include "cli/cli.h"

/* Writes, as an object, the values in `values` of the parameters that differ between `def` and the defaults. */
void cli_differing_parameters_json(cli_json *json, const char *key, const rheo_world_def *def,
                                   const rheo_world_def *values);
/* Prints those parameters of `def`, one a line, with their defaults. */
void cli_differing_parameters_text(const rheo_world_def *def);

void cli_blessings_json(cli_json *json, const rheo_recording *recording);
void cli_blessings_text(const rheo_recording *recording);

#endif
