/* Filling shapes with particles. */
#ifndef RHEO__SCENES_FILL_H
#define RHEO__SCENES_FILL_H

#include "rheolog/scene.h"
#include "scenes/mesh.h"

/* A scene's shapes with what filling needs to know of them: meshes are read once. */
typedef struct rheo__filling {
    const rheo_scene *scene;
    rheo_allocator allocator;
    rheo__mesh mesh[RHEO_MAX_FILLS]; /* of the fills of this kind; fills of the same name share one */
    uint32_t mesh_of[RHEO_MAX_FILLS];
    double spacing;        /* the scene's, or as its number of particles wants it */
    uint64_t count;        /* particles of all fills */
    bool has_temperatures; /* some fill has one */
} rheo__filling;

/*
 * Checks the shapes, reads the meshes, chooses the spacing and counts. The scene must live as long. Whatever comes
 * back, rheo__filling_close() ends it.
 */
rheo_result rheo__filling_open(rheo__filling *filling, const rheo_scene *scene, rheo_error *error);
/*
 * Writes the particles of all fills, in their order: `count` x 3 positions and velocities, and `count` densities and
 * temperatures (either may be NULL).
 */
rheo_result rheo__filling_make(const rheo__filling *filling, rheo_real *position, rheo_real *velocity,
                               rheo_real *density, rheo_real *temperature, rheo_error *error);
void rheo__filling_close(rheo__filling *filling);

#endif
