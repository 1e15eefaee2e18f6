/* The origin and the commands of a recording: output of log, info and diff. */
#ifndef CLI_PROVENANCE_H
#define CLI_PROVENANCE_H

#include "cli/cli.h"

enum { CLI_PARAMETER_VALUE = 96 };
/* The next parameter of the definition's model that differs from its default, from *index on, with both. NULL: none. */
const rheo_parameter *cli_next_differing(const rheo_world_def *def, size_t *index, char value[CLI_PARAMETER_VALUE],
                                         char usual[CLI_PARAMETER_VALUE]);
/* Writes, as an object, the values in `values` of the parameters that differ between `def` and the defaults. */
void cli_differing_parameters_json(rheo__json *json, const char *key, const rheo_world_def *def,
                                   const rheo_world_def *values);
/* Prints those parameters of `def`, one a line, with their defaults. */
void cli_differing_parameters_text(const rheo_world_def *def);

/* Prints the emitters of `def`, one a line: they add particles, which no command tells of. */
void cli_emitters_text(const rheo_world_def *def);

/* How the recording was made, or why that is not shown. */
const char *cli_made_text(const rheo_recording_info *info);

/* Says how the recording ends; returns cli_ending(). */
const char *cli_ending_text(const rheo_recording *recording, char *text, size_t size);

void cli_blessings_json(rheo__json *json, const rheo_recording *recording);
void cli_blessings_text(const rheo_recording *recording);

/*
 * The commands before a step of the recording in this file, in words: printed one a line, or as a list. Nothing if it
 * cannot be read.
 */
void cli_commands_text(const char *path, uint64_t step, const char *which);
void cli_commands_json(rheo__json *json, const char *key, const char *path, uint64_t step);

/* The output of `info` and of `log`. cli_log_print() returns an exit code. */
void cli_info_print(const char *file, rheo_recording *recording, bool json);
int cli_log_print(const char *file, rheo_recording *recording, bool json);

#endif
