/* Filling shapes with particles. */
#ifndef RHEO_SCENES_FILL_H
#define RHEO_SCENES_FILL_H

#include "rheolog/scene.h"
#include "scenes/mesh.h"

/* A scene's shapes with what filling needs to know of them: meshes are read once. */
typedef struct rheo_filling {
    const rheo_scene *scene;
    rheo_allocator allocator;
    rheo_mesh mesh[RHEO_MAX_FILLS]; /* of the fills of this kind; fills of the same name share one */
    uint32_t mesh_of[RHEO_MAX_FILLS];
    double spacing;        /* the scene's, or as its number of particles wants it */
    uint64_t count;        /* particles of all fills */
    bool has_temperatures; /* some fill has one */
} rheo_filling;

/*
 * Checks the shapes, reads the meshes, chooses the spacing and counts. The scene must live as long. Whatever comes
 * back, rheo_filling_close() ends it.
 */
rheo_result rheo_filling_open(rheo_filling *filling, const rheo_scene *scene, rheo_error *error);
/*
 * Writes the particles of all fills, in their order: `count` x 3 positions and velocities, and `count` densities and
 * temperatures (either may be NULL).
 */
rheo_result rheo_filling_make(const rheo_filling *filling, rheo_real *position, rheo_real *velocity,
                              rheo_real *density, rheo_real *temperature, rheo_error *error);
void rheo_filling_close(rheo_filling *filling);

#endif
