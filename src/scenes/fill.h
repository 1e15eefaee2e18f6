/*
 * Filling the shapes of a scene with particles: lattice points, each displaced a little at random, so that a settling
 * fluid does not keep the symmetry of the lattice. Particles come shape by shape, z slowest, x fastest. The engine
 * knows no shape by name; shape.h says what it asks of one.
 */
#ifndef RHEO__SCENES_FILL_H
#define RHEO__SCENES_FILL_H

#include "core/memory.h"
#include "scenes/shape.h"

#define RHEO__MAX_PARTICLES (UINT64_C(1) << 30)

/* The shapes of a scene with the data that filling needs. */
typedef struct rheo__filling {
    const rheo_scene *scene;
    rheo_allocator allocator;
    void **data;           /* of each fill, from open() of its shape; fills of one kind and name share it */
    double spacing;        /* fluid.spacing, or the one that gives the scene's number of particles, L */
    uint64_t count;        /* particles of all fills */
    bool has_temperatures; /* some fill has one */
} rheo__filling;

/*
 * Checks the shapes, opens them, chooses the spacing and counts. The scene must live as long as the filling.
 * rheo__filling_close() ends a filling, after a failure too.
 */
rheo_result rheo__filling_open(rheo__filling *filling, const rheo_scene *scene, rheo_error *error);
/*
 * Writes the particles of all fills in their order: count x 3 positions and velocities, count densities and count
 * temperatures (either of the two may be NULL).
 */
rheo_result rheo__filling_make(const rheo__filling *filling, rheo_real *position, rheo_real *velocity,
                               rheo_real *density, rheo_real *temperature, rheo_error *error);
void rheo__filling_close(rheo__filling *filling);

/* ---- Between the files of the engine ---- */

/* Whether the points of fill f along each axis can be counted; *lattice is set if so. */
bool rheo__fill_lattice(const rheo__filling *filling, uint32_t f, double spacing, rheo__lattice *lattice);
/* Passes on the points of fill f. */
rheo_result rheo__fill_run(const rheo__filling *filling, uint32_t f, double spacing, const rheo__lattice *lattice,
                           rheo__run *run, void *user, rheo_error *error);
/* Counts the particles of all fills. More than RHEO__MAX_PARTICLES: too many, not exactly how many. */
rheo_result rheo__fill_count(const rheo__filling *filling, double spacing, uint64_t *count, rheo_error *error);
/* Sets filling->spacing and ->count such that the count is nearest to scene->particles. */
rheo_result rheo__fill_choose_spacing(rheo__filling *filling, rheo_error *error);

#endif
