/* Copies of worlds at their start, from which changed ones can be created: for studies of `rheolog bench error`. */
#ifndef CLI_ERROR_START_H
#define CLI_ERROR_START_H

#include "cli/cli.h"

typedef struct cli_start {
    rheo_world_def def; /* of the world, with its particles and springs */
    rheo_real *position, *velocity, *density, *temperature, *rest_length;
    uint32_t *material, *ends;
} cli_start;

/* Copies a world that has made no step and lives longer than the copy. Release the copy even if this fails. */
rheo_result cli_start_copy(cli_start *start, const rheo_world *world, rheo_error *error);
void cli_start_release(cli_start *start);

/* Copies the springs of a world for a definition. The caller frees *ends and *rest_length, also if this fails. */
rheo_result cli_start_springs(rheo_world_def *def, uint32_t **ends, rheo_real **rest_length, const rheo_world *world,
                              rheo_error *error);

#endif
