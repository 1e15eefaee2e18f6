/* Filling shapes with particles. */
#ifndef RHEO_SCENES_FILL_H
#define RHEO_SCENES_FILL_H

#include "rheolog/scene.h"

/* Writes the particles of all fills, in their order; velocity and position hold rheo_scene_particle_count() x 3
 * values. */
void rheo_scene_fill(const rheo_scene *scene, rheo_real *position, rheo_real *velocity);

#endif
