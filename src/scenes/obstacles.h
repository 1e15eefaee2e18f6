/* The obstacles of a scene while a world is made. */
#ifndef RHEO__SCENES_OBSTACLES_H
#define RHEO__SCENES_OBSTACLES_H

#include "scenes/making.h"
#include "scenes/mesh.h"
#include "space/rigid_shapes.h"

typedef struct rheo__scene_obstacles {
    rheo_allocator allocator;
    rheo__mesh mesh[RHEO_MAX_OBSTACLES]; /* those that were read */
    rheo__rigid solid[RHEO_MAX_OBSTACLES];
} rheo__scene_obstacles;

/*
 * Reads the meshes, which *def then uses until they are closed, and makes the shapes. To be closed after a failure, too.
 * RHEO_ERROR_ARGUMENT, RHEO_ERROR_FORMAT, RHEO_ERROR_FILE: a bad mesh; RHEO_ERROR_MEMORY.
 */
rheo_result rheo__scene_obstacles_open(rheo__scene_obstacles *obstacles, const rheo_allocator *allocator,
                                       rheo_world_def *def, rheo_error *error);
/* Does nothing for a zeroed struct. */
void rheo__scene_obstacles_close(rheo__scene_obstacles *obstacles);
/* Largest speed of a point of their surfaces, L/T. */
double rheo__scene_obstacles_speed(const rheo__scene_obstacles *obstacles, const rheo_world_def *def);
/* Warns of particles of *def that are in obstacles, and of obstacles that are too fast. */
void rheo__check_obstacles(const rheo__scene_obstacles *obstacles, const rheo__filling *filling,
                           const rheo_world_def *def, rheo__warnings *warnings);

#endif
