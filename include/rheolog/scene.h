/*
 * Scenes: a world definition, the shapes that are filled with particles, and how the fluid settles.
 */
#ifndef RHEOLOG_SCENE_H
#define RHEOLOG_SCENE_H

#include "rheolog/world.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Most shapes of a scene. */
#define RHEO_MAX_FILLS 64

/* ---- Shapes ---- */

/** All shapes, X(enumerator, name). src/scenes/shape_NAME.c defines a shape; rheo_shape_at() describes it. */
#define RHEO__SHAPES(X) \
    X(BLOCK, block)     \
    X(SPHERE, sphere)   \
    X(MESH, mesh)       \
    X(LETTERS, letters)

/**
 * Kind of a shape: RHEO_FILL_BLOCK, RHEO_FILL_SPHERE, RHEO_FILL_MESH, RHEO_FILL_LETTERS. Index in rheo_shape_at().
 */
typedef enum rheo_fill_kind {
#define RHEO__FILL_KIND(KIND, name) RHEO_FILL_##KIND,
    RHEO__SHAPES(RHEO__FILL_KIND)
#undef RHEO__FILL_KIND
} rheo_fill_kind;

/**
 * A shape that is filled with particles on a cubic lattice of distance fluid.spacing. All zero is the default of
 * every member; a kind ignores the members that it does not have. The lattice of a mesh or text begins half a spacing
 * above its underside and is central in it along x and z.
 */
typedef struct rheo_fill {
    /** Kind of the shape. */
    rheo_fill_kind kind;
    /** Block: lowest corner. Unit L. Finite. */
    double min[3];
    /**
     * Block: highest corner. Unit L. Finite, at least min. The block holds round((max - min) / spacing) particles
     * along each axis, the first half a spacing inside.
     */
    double max[3];
    /** Sphere: centre, which is a lattice point. Unit L. Finite. */
    double centre[3];
    /** Sphere: radius. Unit L. Range >= 0. */
    double radius;
    /**
     * Mesh: "bunny", which is built in, or the path of an .obj or .ply file with a closed mesh: two triangles at
     * every edge, oriented alike. Letters: the text, of A-Z, 0-9, blanks and . , ! ? - + = : / in 5 x 7 dots.
     */
    char name[256];
    /** Mesh: height (y) that it is scaled to; 0: as in the file. Letters: height of a letter, > 0. Unit L. */
    double height;
    /** Letters: depth along z. Unit L. Range > 0. */
    double depth;
    /** Mesh, letters: middle of the underside of the bounding box. Unit L. Finite. */
    double position[3];
    /** Velocity of the particles. Unit L/T. Finite. */
    double velocity[3];
    /** Largest random displacement of each coordinate. Unit: the spacing. Range 0 to 0.5. */
    double jitter;
    /** Thickening only: name of their material in world.materials; "": the main one. */
    char material[sizeof(((rheo_material *)0)->name)];
    /**
     * Melting only: `temperature` counts. Otherwise the particles have melting.temperature; the world is isothermal
     * if no shape has temperatures.
     */
    bool has_temperature;
    /** Melting only: temperature of the lowest and of the highest particle, linear in between. Unit K. Finite. */
    double temperature[2];
    /** Melting only: particles begin at the rest density instead of that of a fluid at rest under gravity. */
    bool not_hydrostatic;
} rheo_fill;

/** C type of a member of a shape, and its form in a scene file. */
typedef enum rheo_shape_member_type {
    /** double; a number in the file. */
    RHEO_SHAPE_NUMBER,
    /** double[2]; a list of two numbers, or one number for both. */
    RHEO_SHAPE_PAIR,
    /** double[3]; a list of three numbers. */
    RHEO_SHAPE_VECTOR,
    /** char[]; a string. */
    RHEO_SHAPE_TEXT,
    /** char[]; a string with a dot is a file, relative to the folder of the scene file; others are built in. */
    RHEO_SHAPE_FILE,
    /** bool, the opposite of the value in the file; true or false there, default true. */
    RHEO_SHAPE_NEGATED_FLAG,
} rheo_shape_member_type;

/** A quantity of particles that only some models have. */
typedef enum rheo_shape_needs {
    /** All models have the member. */
    RHEO_SHAPE_NEEDS_NOTHING,
    /** A density that is part of the state. */
    RHEO_SHAPE_NEEDS_DENSITY,
    /** A temperature. */
    RHEO_SHAPE_NEEDS_TEMPERATURE,
    /** A material. */
    RHEO_SHAPE_NEEDS_MATERIALS
} rheo_shape_needs;

/** A member of a shape, by which scene files are read, written and checked. */
typedef struct rheo_shape_member {
    /** Key in scene files. */
    const char *name;
    /** Unit, such as "L/T"; "" for texts and flags. */
    const char *unit;
    /** Meaning, one line. */
    const char *meaning;
    /** C type, and form in scene files. */
    rheo_shape_member_type type;
    /** Offset in rheo_fill. Unit: bytes. */
    size_t offset;
    /** Size in rheo_fill. Unit: bytes. */
    size_t size;
    /** Offset in rheo_fill of the bool that says whether the file sets the member; 0: none. Unit: bytes. */
    size_t given;
    /** Least value of each number of the member; -1e30: no bound. */
    double minimum;
    /** Largest value of each number of the member; 1e30: no bound. */
    double maximum;
    /** The minimum itself is not allowed. */
    bool above_minimum;
    /** A scene file must give the member. */
    bool required;
    /** The member exists only in models whose particles have this quantity. */
    rheo_shape_needs needs;
} rheo_shape_member;

/** A shape. */
typedef struct rheo_shape {
    /** Key in scene files. */
    const char *name;
    /** Meaning, one line. */
    const char *meaning;
    /** Members in the order in which scene files are written. */
    const rheo_shape_member *member;
    /** Number of members. */
    size_t member_count;
} rheo_shape;

/** Number of shapes. */
RHEO_API size_t rheo_shape_count(void);
/** Shape of the kind `index`; NULL past the end. */
RHEO_API const rheo_shape *rheo_shape_at(size_t index);
/** Whether shapes have this member in worlds of this model. */
RHEO_API bool rheo_shape_member_has_model(const rheo_shape_member *member, rheo_model model);
/**
 * Checks the members of a shape in a scene of this model, without the spacing and without reading a mesh.
 * RHEO_ERROR_ARGUMENT names the member and its range.
 */
RHEO_API rheo_result rheo_fill_check(const rheo_fill *fill, rheo_model model, rheo_error *error);

/* ---- Scenes ---- */

/**
 * A scene: a world definition, the shapes that make its particles, and how the fluid settles before step 0. Start
 * from rheo_default_scene(), rheo_default_model_scene() or rheo_scene_builtin(). The definition's particles are
 * ignored.
 */
typedef struct rheo_scene {
    /** Name; UTF-8. */
    char name[64];
    /** One line about the scene; UTF-8. */
    char about[160];
    /** Definition of the world. */
    rheo_world_def world;
    /** Number of shapes. Range 0 to RHEO_MAX_FILLS, default 0. */
    uint32_t fill_count;
    /** Shapes; particles are numbered in their order. */
    const rheo_fill *fill;
    /** Seed of the jitter, below 2^53. Range >= 0, default 1. */
    uint64_t seed;
    /**
     * If > 0: the spacing is chosen so that the shapes hold about this many particles at resolution 1. Range 0 to
     * 1073741824, default 0.
     */
    uint64_t particles;
    /**
     * The same material with particles `resolution` times as close: the spacing is divided by it, and the parameters
     * of the world that depend on the spacing follow the rule in docs/model.md, Spacing. Applied when the world is
     * created; the scene keeps its definition. 2 makes 8 times as many particles. Range 0.1 to 10, default 1.
     */
    double resolution;
    /** Number of steps that a run of the scene makes by default, below 2^53. Range >= 1, default 600. */
    uint64_t steps;
    /** Place of the ball. Thickening only. */
    struct {
        /**
         * Height of the ball's lowest point above the settled surface at step 0. Unit L. Any finite value, default -1.
         * Below 0: world.ball.position is used.
         */
        double clearance;
    } ball;
    /** Further balls. */
    struct {
        /** The same of further balls: of ball 2, 3, ... */
        double clearance[RHEO_MAX_BALLS - 1];
    } balls;
    /** Settling before step 0, without ball, vibrators and history. Thickening only. */
    struct {
        /** Time that the fluid settles, at most a million steps. Unit T. Range >= 0, default 0. */
        double time;
        /** Rate at which velocities decay in the damped part. Unit 1/T. Range >= 0, default 2. */
        double damping;
        /** First part of the time, in which velocities are damped. Range 0 to 1, default 1. */
        double fraction;
    } settle;
    /**
     * Arrays made by the library (rheo_scene_add_fill(), rheo_scene_builtin(), ...); rheo_scene_release() frees them.
     */
    struct {
        /** Shapes. */
        rheo_fill *fill;
        /** Walls. */
        rheo_wall *plane;
        /** Vibrators: x and z of each. */
        double (*position)[2];
        /** Points of the curve. */
        rheo_curve_point *curve;
    } owned;
} rheo_scene;

/** Defaults of the thickening model: nothing to fill, no settling. */
RHEO_API rheo_scene rheo_default_scene(void);
/** Defaults of a model, which must exist. */
RHEO_API rheo_scene rheo_default_model_scene(rheo_model model);

/* ---- Arrays ---- */

/**
 * Adds a shape. The first call copies an array that the caller made. A copy of a scene shares its arrays.
 * RHEO_ERROR_ARGUMENT if the scene is full (RHEO_MAX_FILLS); RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_scene_add_fill(rheo_scene *scene, const rheo_fill *fill, rheo_error *error);
/** Adds a wall, as rheo_scene_add_fill() adds a shape. RHEO_ERROR_ARGUMENT beyond RHEO_MAX_WALLS; RHEO_ERROR_MEMORY. */
RHEO_API rheo_result rheo_scene_add_wall(rheo_scene *scene, const rheo_wall *wall, rheo_error *error);
/**
 * Adds a vibrator at x, z, unit L, as rheo_scene_add_fill() adds a shape. RHEO_ERROR_ARGUMENT beyond RHEO_MAX_VIBRATORS;
 * RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_scene_add_vibrator(rheo_scene *scene, double x, double z, rheo_error *error);
/**
 * Adds a point of history.curve, as rheo_scene_add_fill() adds a shape. RHEO_ERROR_ARGUMENT for an age that is not above that of
 * the point before, and beyond RHEO_MAX_CURVE_POINTS; RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_scene_add_curve_point(rheo_scene *scene, double age, double weight, rheo_error *error);
/** Frees the arrays that the functions above and rheo_scene_builtin() made. Worlds of the scene keep their copies. */
RHEO_API void rheo_scene_release(rheo_scene *scene);

/* ---- Parameters by name: those of the world, then those that only scenes have (seed, settle.time, ...) ---- */

/** Number of parameters of a scene. */
RHEO_API size_t rheo_scene_parameter_count(void);
/** Parameter by index; NULL past the last. */
RHEO_API const rheo_parameter *rheo_scene_parameter_at(size_t index);
/** Parameter by path; NULL if there is none. */
RHEO_API const rheo_parameter *rheo_scene_parameter_find(const char *path);
/** The path that is nearest to a misspelt one; never NULL. */
RHEO_API const char *rheo_scene_parameter_nearest(const char *path);
/**
 * Sets a parameter from text, as rheo_world_def_set() does. RHEO_ERROR_ARGUMENT for an unknown path (the message
 * names the nearest, or the present name of an old one), a parameter of another model, a bad value, or the model
 * itself.
 */
RHEO_API rheo_result rheo_scene_set(rheo_scene *scene, const char *path, const char *value, rheo_error *error);
/**
 * Writes a parameter as text that rheo_scene_set() reads back to the same bits. `value` holds >= 96 bytes.
 * RHEO_ERROR_ARGUMENT for an unknown path.
 */
RHEO_API rheo_result rheo_scene_get(const rheo_scene *scene, const char *path, char *value, size_t size);

/* ---- Scenes ---- */

/** Number of built-in scenes. */
RHEO_API size_t rheo_scene_builtin_count(void);
/** Built-in scene by index, to be released. RHEO_ERROR_ARGUMENT past the last, RHEO_ERROR_MEMORY. */
RHEO_API rheo_result rheo_scene_builtin_at(size_t index, rheo_scene *scene);
/** Built-in scene by name, to be released. RHEO_ERROR_ARGUMENT names the scenes that exist; RHEO_ERROR_MEMORY. */
RHEO_API rheo_result rheo_scene_builtin(const char *name, rheo_scene *scene, rheo_error *error);

/**
 * Checks a scene, as rheo_scene_create_world() does before it makes the particles, and reads its meshes.
 * RHEO_ERROR_ARGUMENT names the first value that is wrong and its range, or a mesh file that does not exist;
 * RHEO_ERROR_FORMAT: a mesh is damaged or not closed; RHEO_ERROR_FILE: a file cannot be read to its end;
 * RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_scene_check(const rheo_scene *scene, rheo_error *error);
/** Number of particles that the shapes hold, at most 2^30. Reads meshes; errors as in rheo_scene_check(). */
RHEO_API rheo_result rheo_scene_particle_count(const rheo_scene *scene, uint64_t *count, rheo_error *error);
/** Memory that a scene needs, in bytes: all, and its two parts that grow with other parameters. */
typedef struct rheo_memory {
    /** Number of particles. */
    uint64_t particles;
    /** All memory of the world and its making. Unit: bytes. */
    double all;
    /** Of the history: grows with history.window. */
    double history;
    /** Of pairs of neighbours: grows with the third power of the support divided by the spacing. */
    double neighbours;
    /** Particles that emitters add in these steps, at most. The memory is that of all. */
    uint64_t emitted;
} rheo_memory;
/**
 * Estimates the memory that rheo_scene_create_world() and this many steps need, within about 40 %, without making any
 * particle. Errors as in rheo_scene_particle_count().
 */
RHEO_API rheo_result rheo_scene_memory(const rheo_scene *scene, uint64_t steps, rheo_memory *memory,
                                       rheo_error *error);
/**
 * Distance of the particles, L: fluid.spacing, or if `particles` is not 0 the distance whose number of particles is
 * nearest to it; divided by `resolution`. RHEO_ERROR_ARGUMENT if the shapes are empty; else errors as in
 * rheo_scene_check().
 */
RHEO_API rheo_result rheo_scene_spacing(const rheo_scene *scene, double *spacing, rheo_error *error);

/* ---- Preflight: what a run of a scene is expected to be like ---- */

/** Numbers that follow from a scene before anything is made. A number that the scene does not have is NaN. */
typedef struct rheo_preflight {
    /** Thickening: kappa of a spring at rest, substep^2 k_min. A pure number. */
    double kappa;
    /** Thickening: kappa when the ball arrives, substep^2 K. A pure number. */
    double kappa_impact;
    /** Limit of kappa: the doctor's stiffness_number, for explicit springs of scheme sequential. */
    double kappa_limit;
    /** Thickening: difference n of D^q x between neighbours when the ball arrives, spacing (speed/radius)^q. Unit L/T^q. */
    double history_difference;
    /** Thickening: k substep^2/h with the substeps at rest. A pure number. */
    double pressure_number;
    /** Thickening: first limit of pressure_number. */
    double pressure_limit;
    /** Thickening: k_near substep^2/h with the substeps at rest. A pure number. */
    double near_pressure_number;
    /** Thickening: first limit of near_pressure_number. */
    double near_pressure_limit;
    /** Substeps of the first steps, or of fluid at rest. */
    double substeps;
    /** With a ball: substeps when it arrives. */
    double substeps_impact;
    /** Duration of a substep of the first steps. Unit T. */
    double substep;
    /** Radius of the ball in spacings. */
    double ball_resolution;
    /** Speed of the ball when it arrives. Unit L/T. */
    double ball_speed;
    /** Way of the ball in a step when it arrives, in supports. */
    double ball_way;
    /** How long the history is. Unit steps. */
    double memory_steps;
    /** How long the history is. Unit T. */
    double memory_seconds;
    /** Melting: speed of sound. Unit L/T. */
    double sound_speed;
    /** Melting: jump number of the hottest particle at the start. */
    double jump_least;
    /** Melting: jump number of the coldest particle at the start. */
    double jump_most;
    /** Melting: word of melting.solver; NULL for other models. */
    const char *solver;
    /** Largest speed of a point of an obstacle. Unit L/T. */
    double obstacle_speed;
    /** Way of that point in a step, in supports. */
    double obstacle_way;
} rheo_preflight;

/** Estimates these numbers from the parameters and shapes. Nothing is filled or simulated. Errors as in rheo_scene_check(). */
RHEO_API rheo_result rheo_scene_preflight(const rheo_scene *scene, rheo_preflight *preflight, rheo_error *error);

/* ---- Warnings: likely mistakes ---- */

/** All kinds of warnings, X(enumerator, name). */
#define RHEO__WARNINGS(X)               \
    X(EMPTY, "empty")                   \
    X(BEHIND_WALL, "behind-wall")       \
    X(TURNED_NORMAL, "turned-normal")   \
    X(OVERLAP, "overlap")               \
    X(BALL_IN_WALL, "ball-in-wall")     \
    X(BALL_TOO_LARGE, "ball-too-large") \
    X(BALL_IN_FLUID, "ball-in-fluid")   \
    X(SPEED, "speed")                   \
    X(PARAMETER, "parameter")           \
    X(NO_FLOOR, "no-floor")             \
    X(SETTLING, "settling")             \
    X(COMPRESSED, "compressed")         \
    X(FAR, "far")                       \
    X(BALL_TOO_SMALL, "ball-too-small") \
    X(IN_OBSTACLE, "in-obstacle")       \
    X(BALLS_OVERLAP, "balls-overlap")   \
    X(EMITTER, "emitter")

/**
 * Kind of a warning: RHEO_WARNING_EMPTY (the shapes or a plate hold no particle), RHEO_WARNING_BEHIND_WALL (particles of a
 * shape), RHEO_WARNING_TURNED_NORMAL (all particles are behind a wall), RHEO_WARNING_OVERLAP (particles are closer
 * than half the spacing), RHEO_WARNING_BALL_IN_WALL, RHEO_WARNING_BALL_TOO_LARGE (two walls are closer than its
 * diameter), RHEO_WARNING_BALL_IN_FLUID, RHEO_WARNING_SPEED (a shape, or the fluid of an emitter, moves more than a support in a step),
 * RHEO_WARNING_PARAMETER (a measure of docs/debugging.md that follows from the parameters is out of range),
 * RHEO_WARNING_NO_FLOOR (no wall stops the fall), RHEO_WARNING_SETTLING (settling blew up, or did not end),
 * RHEO_WARNING_COMPRESSED (two shapes in the same place make the fluid denser than at rest; or a shape is so, because
 * the spacing does not fit the support), RHEO_WARNING_FAR (positions are so large that what they lose by rounding counts),
 * RHEO_WARNING_BALL_TOO_SMALL (the ball falls between the particles), RHEO_WARNING_IN_OBSTACLE (particles of a shape are
 * where an obstacle has no fluid), RHEO_WARNING_BALLS_OVERLAP (two balls), RHEO_WARNING_EMITTER (an emitter is in
 * the fluid, or flows into a wall at once). SPEED: also of an obstacle.
 */
typedef enum rheo_warning_kind {
#define RHEO__WARNING_KIND(KIND, name) RHEO_WARNING_##KIND,
    RHEO__WARNINGS(RHEO__WARNING_KIND)
#undef RHEO__WARNING_KIND
} rheo_warning_kind;

/** A likely mistake in a scene. */
typedef struct rheo_warning {
    /** Kind of the warning. */
    rheo_warning_kind kind;
    /** Nothing useful can be meant: rheo_scene_create_world() refuses the scene. */
    bool refused;
    /** Index of the shape that it is about; -1: none. */
    int32_t shape;
    /** Index of a second shape; -1: none. The same as `shape` if that overlaps itself, or is compressed by itself. */
    int32_t other_shape;
    /** Index of the wall that it is about; -1: none. */
    int32_t wall;
    /** Index of the obstacle that it is about; -1: none. */
    int32_t obstacle;
    /** Particles, or pairs of particles if kind is RHEO_WARNING_OVERLAP, that it is about; 0: none. */
    uint64_t count;
    /**
     * The number that is out of range; NaN: none. Unit L: depth behind a wall, least distance of particles, depth of a
     * ball in wall, fluid or ball, its diameter and the distance of two walls. SPEED and SETTLING: way in a step, in supports.
     * PARAMETER: the measure that the text names. COMPRESSED: density, in those at rest.
     */
    double value;
    /** Its limit; NaN: none. */
    double limit;
    /** What is wrong, where, and what would be right; one line. */
    char text[512];
} rheo_warning;

/** Name of a kind, such as "behind-wall"; "unknown" for any other value. */
RHEO_API const char *rheo_warning_name(rheo_warning_kind kind);

/**
 * Examines a scene and its particles before they settle. Writes at most `capacity` warnings, and sets *count to the
 * number of all. What makes a scene refused is among them, so RHEO_OK does not mean that the scene can be created.
 * Takes as long as filling the shapes does. Errors as in rheo_scene_check().
 */
RHEO_API rheo_result rheo_scene_warnings(const rheo_scene *scene, rheo_warning *warnings, size_t capacity,
                                         size_t *count, rheo_error *error);

/**
 * Checks and fills a scene, lets it settle and creates its world at step 0. Takes as long as settling does. Passes
 * warnings on to world.log, as messages that begin with "warning: "; those about settling only here. Without a log,
 * particles that are too close are not looked for. Errors as in rheo_scene_check() and rheo_world_create(), and
 * RHEO_ERROR_ARGUMENT for a scene that a warning refuses, RHEO_ERROR_STATE if a step of settling fails, and
 * RHEO_ERROR_STOPPED (rheo_use_progress()).
 */
RHEO_API rheo_result rheo_scene_create_world(const rheo_scene *scene, rheo_world **world, rheo_error *error);

#ifdef __cplusplus
}
#endif
#endif
