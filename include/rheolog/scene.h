/* Scenes: a world definition together with what fills it and how it settles. */
#ifndef RHEOLOG_SCENE_H
#define RHEOLOG_SCENE_H

#include "rheolog/world.h"

#ifdef __cplusplus
extern "C" {
#endif

#define RHEO_MAX_FILLS 64

typedef enum rheo_fill_kind {
    RHEO_FILL_BLOCK,
    RHEO_FILL_SPHERE,
    RHEO_FILL_MESH,    /**< the inside of a closed triangle mesh */
    RHEO_FILL_LETTERS, /**< a text in block letters, extruded along z */
} rheo_fill_kind;

/**
 * Particles on a cubic lattice of distance fluid.spacing. The lattice of a mesh or text begins half a spacing above
 * its underside and is central in it along x and z. A mesh must be closed: two triangles at every edge, oriented
 * alike. Of letters there are A-Z, 0-9, blanks and . , ! ? - + = : / in 5 x 7 dots.
 */
typedef struct rheo_fill {
    rheo_fill_kind kind;
    double min[3],
        max[3];         /**< block, L: round((max - min)/spacing) particles along each axis, half a spacing inside */
    double centre[3];   /**< sphere, L: a lattice point */
    double radius;      /**< sphere, L */
    char name[256];     /**< mesh: "bunny", which is built in, or an .obj or .ply file; letters: the text */
    double height;      /**< mesh: made so high (y), L, 0: as it is; letters: height of a letter, L */
    double depth;       /**< letters: along z, L */
    double position[3]; /**< mesh, letters: the middle of the underside of what bounds it, L */
    double velocity[3]; /**< L/T */
    double jitter;      /**< each coordinate is displaced at random by up to this part of the spacing; 0..0.5 */
    bool
        has_temperature; /**< melting: else it is melting.temperature; if no shape has one, the world is isothermal */
    double temperature[2]; /**< melting: at the lowest and at the highest particle of the shape, K; linear between */
    bool not_hydrostatic; /**< melting: begins at the rest density instead of that of a fluid at rest under gravity */
} rheo_fill;

/**
 * A scene. Fill it by rheo_default_scene() or rheo_scene_builtin(). The world definition's particles are left empty:
 * the fills make them.
 */
typedef struct rheo_scene {
    char name[64];
    char about[160];
    rheo_world_def world;
    uint32_t fill_count;
    rheo_fill fill[RHEO_MAX_FILLS];
    uint64_t seed;      /**< of the jitter; below 2^53; 1 */
    uint64_t particles; /**< > 0: fluid.spacing is chosen so that the shapes hold about so many; default 0 */
    uint64_t steps;     /**< how many steps show what the scene is for; 1 and more */
    double
        clearance; /**< >= 0: the ball starts with its lowest point so far above the settled surface; < 0: not used */
    struct {
        double time;     /**< the fluid settles so long before step 0, without ball, vibrators and history, T; >= 0 */
        double damping;  /**< velocities are multiplied by this after each step ...; 0..1; 0.97 */
        double fraction; /**< ... for this first part of the time; 0..1; 0.7 */
    } settle;
} rheo_scene;

/** Defaults of rheo_default_world_def(), nothing to fill, no settling, 600 steps. */
RHEO_API rheo_scene rheo_default_scene(void);
/** The same for a model. */
RHEO_API rheo_scene rheo_default_model_scene(rheo_model model);

RHEO_API size_t rheo_scene_builtin_count(void);
/** A built-in scene by number; RHEO_ERROR_ARGUMENT past the end. */
RHEO_API rheo_result rheo_scene_builtin_at(size_t index, rheo_scene *scene);
/** A built-in scene by name; the error names the known ones. */
RHEO_API rheo_result rheo_scene_builtin(const char *name, rheo_scene *scene, rheo_error *error);

/**
 * Says what is wrong with a scene and what would be right; RHEO_OK if nothing is. Reads the meshes that it fills:
 * RHEO_ERROR_ARGUMENT for a file that is not there, RHEO_ERROR_FORMAT for one that is damaged or no closed mesh,
 * RHEO_ERROR_FILE for one that cannot be read to its end.
 */
RHEO_API rheo_result rheo_scene_check(const rheo_scene *scene, rheo_error *error);
/** How many particles the fills make; at most 2^30, more is an error. Reads meshes and fails as the check does. */
RHEO_API rheo_result rheo_scene_particle_count(const rheo_scene *scene, uint64_t *count, rheo_error *error);
/**
 * The distance of the particles, L: fluid.spacing, or if `particles` is not 0 the one that gives the number nearest
 * to it that was found. RHEO_ERROR_ARGUMENT if there is none, since the shapes are empty.
 */
RHEO_API rheo_result rheo_scene_spacing(const rheo_scene *scene, double *spacing, rheo_error *error);

/** Fills, settles and creates the world at step 0. Takes as long as settling does. */
RHEO_API rheo_result rheo_scene_create_world(const rheo_scene *scene, rheo_world **world, rheo_error *error);

#ifdef __cplusplus
}
#endif
#endif
