/*
 * Fills the shapes of a scene with particles at lattice points. Each particle is displaced a little at random, so
 * that a settling fluid loses the symmetry of the lattice. Particles are numbered shape by shape, z slowest, x
 * fastest. The engine knows no shape by name; shape.h defines the interface of a shape.
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
    void **data;           /* result of open() for each fill; fills with the same kind and name share it */
    double spacing;        /* distance of the particles, rheo_scene_spacing(), L */
    uint64_t count;        /* number of particles in all fills */
    bool has_temperatures; /* at least one fill has a temperature */
    /* Number of particles in each fill and those before it; set by rheo__filling_make(). */
    uint64_t end[RHEO_MAX_FILLS];
} rheo__filling;

/*
 * Checks the shapes, opens them, chooses the spacing and counts. The scene must live as long as the filling.
 * Call rheo__filling_close() at the end, also after a failure.
 */
rheo_result rheo__filling_open(rheo__filling *filling, const rheo_scene *scene, rheo_error *error);
/*
 * Writes the particles of all fills in order: count x 3 positions and velocities, count densities,
 * temperatures and materials. The last three may be NULL.
 */
rheo_result rheo__filling_make(rheo__filling *filling, rheo_real *position, rheo_real *velocity, rheo_real *density,
                               rheo_real *temperature, uint32_t *material, rheo_error *error);
void rheo__filling_close(rheo__filling *filling);

/* ---- Shared by the files of the engine ---- */

/* Computes the size of fill f in spacings. False: it would have more points along an axis than its shape allows. */
bool rheo__fill_size(const rheo__filling *filling, uint32_t f, double spacing, double size[3]);
/* Sets *lattice to the lattice of fill f. False: it has too many points along an axis. */
bool rheo__fill_lattice(const rheo__filling *filling, uint32_t f, double spacing, rheo__lattice *lattice);
/* Passes on the points of fill f. */
rheo_result rheo__fill_run(const rheo__filling *filling, uint32_t f, double spacing, const rheo__lattice *lattice,
                           rheo__run *run, void *user, rheo_error *error);
/* Counts the particles of all fills. A count above RHEO__MAX_PARTICLES means too many and is not exact. */
rheo_result rheo__fill_count(const rheo__filling *filling, double spacing, uint64_t *count, rheo_error *error);
/*
 * Sets filling->spacing and ->count so that the count is as near as possible to scene->particles, at resolution 1.
 */
rheo_result rheo__fill_choose_spacing(rheo__filling *filling, rheo_error *error);

#endif
