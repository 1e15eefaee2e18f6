/*
 * Worlds: a definition, fixed steps, read-only access to the state, and commands that change it between steps.
 *
 * Units: any consistent set. L is the unit of length, T of time, M of mass, K of temperature. Y is up. Particles keep
 * the id that they were created with (0, 1, ...), and every array seen from outside is in the order of ids.
 *
 * A world has one of two models:
 *
 *   thickening   Ozgen, Kallmann, Brown, "An SPH model to simulate the dynamic behavior of shear thickening fluids"
 *                ("the paper" below), based on Clavet, Beaudoin, Poulin, "Particle-based viscoelastic fluid
 *                simulation" (2005). docs/model.md has every equation. A particle has the mass 1.
 *   melting      Paiva, Petronetto, Lewiner, Tavares, "Particle-based non-Newtonian fluid animation for melting
 *                objects" (2006): viscoplastic solids that melt. docs/melting.md has every equation. A particle has
 *                the mass melting.rest_density x fluid.spacing^3.
 */
#ifndef RHEOLOG_WORLD_H
#define RHEOLOG_WORLD_H

#include "rheolog/base.h"
#include "rheolog/history.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Most walls of a world. */
#define RHEO_MAX_WALLS 64
/** Most vibrators of a world. */
#define RHEO_MAX_VIBRATORS 1024
/** Most obstacles of a world. */
#define RHEO_MAX_OBSTACLES 16
/** Most vertices that all meshes of obstacles have together. */
#define RHEO_MAX_OBSTACLE_VERTICES 200000
/** Most triangles that all meshes of obstacles have together. */
#define RHEO_MAX_OBSTACLE_TRIANGLES 200000
/** Most balls of a world. */
#define RHEO_MAX_BALLS 16
/** Most emitters of a world. */
#define RHEO_MAX_EMITTERS 8
/** Most materials of a world beside the main one. */
#define RHEO_MAX_MATERIALS 16

/** Models. docs/parameters.md lists the parameters of each. */
typedef enum rheo_model {
    /** Shear thickening fluids. */
    RHEO_MODEL_THICKENING = 0,
    /** Viscoplastic solids that melt. */
    RHEO_MODEL_MELTING = 1
} rheo_model;

/* ---- Choices of the thickening model ---- */

/** Order in which forces act. */
typedef enum rheo_scheme {
    /**
     * All forces are computed at one set of positions, summed, and then applied, in several substeps of a step.
     * Results do not depend on an order of the particles.
     */
    RHEO_SCHEME_SUMMED = 0,
    /** Pair after pair: each sees the results of the pairs before it, as in Algorithm 1 of the paper. No substeps. */
    RHEO_SCHEME_SEQUENTIAL = 1,
    /**
     * Position based fluids: a constraint on the density is solved at the predicted positions. No springs and no
     * substeps; the history multiplies the gradient of the constraint, and the viscosity.
     */
    RHEO_SCHEME_POSITIONS = 2,
} rheo_scheme;

/** What the history multiplies in scheme positions. */
typedef enum rheo_positions_history {
    /** The gradient of the density constraint, and the viscosity. */
    RHEO_POSITIONS_BOTH = 0,
    /** The gradient of the density constraint. */
    RHEO_POSITIONS_CONSTRAINT = 1,
    /** The viscosity. */
    RHEO_POSITIONS_VISCOSITY = 2,
} rheo_positions_history;

/** Force of a spring while its stiffness grows. */
typedef enum rheo_hardening {
    /** The force grows with the stiffness, as in the paper. */
    RHEO_HARDENING_ACTIVE = 0,
    /** The force stays the same: the rest length follows. Stiffening does no work; springs lose tension faster. */
    RHEO_HARDENING_PASSIVE = 1,
} rheo_hardening;

/** Rest length of a new spring. */
typedef enum rheo_rest_length {
    /** The distance at which the pair meets. */
    RHEO_REST_DISTANCE = 0,
    /** The support, as in Clavet et al. */
    RHEO_REST_SUPPORT = 1,
} rheo_rest_length;

/**
 * Displacement of the ends of a spring in scheme sequential; kappa = step^2 (k_min + k_hist |D^q|), L is the rest
 * length.
 */
typedef enum rheo_spring_solver {
    /** kappa (r - L), as in the paper. Unstable for large kappa. */
    RHEO_SOLVER_EXPLICIT = 0,
    /** kappa/(1 + kappa) (r - L). Softer, stable at any stiffness. */
    RHEO_SOLVER_IMPLICIT = 1,
} rheo_spring_solver;

/** Effect of a vibrator; rho is the horizontal distance from its centre divided by its radius, f its frequency. */
typedef enum rheo_vibrator_kind {
    /** Raises the floor by amplitude (1 - rho^2)^2 sin(phase). */
    RHEO_VIBRATOR_FLOOR = 0,
    /**
     * Accelerates the particles below vibrators.height: dv_y = substep amplitude (2 pi f)^2 (1 - rho^2) sin(phase).
     */
    RHEO_VIBRATOR_FORCE = 1,
} rheo_vibrator_kind;

/** What moves the upper plate. */
typedef enum rheo_plates_control {
    /** plates.velocity, plates.amplitude and plates.frequency. */
    RHEO_PLATES_VELOCITY = 0,
    /** plates.stress and the force of the fluid, along x. */
    RHEO_PLATES_STRESS = 1,
} rheo_plates_control;

/* ---- Choices of the melting model ---- */

/** Apparent viscosity. */
typedef enum rheo_rheology {
    /** Depends on the shear rate and the jump number, Eq. 3 of Paiva et al. */
    RHEO_RHEOLOGY_JUMP = 0,
    /** Constant: melting.viscosity. */
    RHEO_RHEOLOGY_NEWTONIAN = 1,
} rheo_rheology;

/** Discretisation of the viscous stress. */
typedef enum rheo_stress {
    /** Forces between pairs, along their line. Conserves angular momentum. */
    RHEO_STRESS_PAIRWISE = 0,
    /** D, then S = eta D, then div S, as in Paiva et al. */
    RHEO_STRESS_NESTED = 1,
} rheo_stress;

/** Time integration of the viscosity. */
typedef enum rheo_viscosity_solver {
    /** Implicit, by conjugate gradients. Stable at any viscosity. */
    RHEO_VISCOSITY_IMPLICIT = 0,
    /** Explicit. The largest viscosity bounds the length of substeps. */
    RHEO_VISCOSITY_EXPLICIT = 1,
} rheo_viscosity_solver;

/** Density. */
typedef enum rheo_density_scheme {
    /** Integrates the continuity equation, Eq. 6. */
    RHEO_DENSITY_CONTINUITY = 0,
    /** Sums m W over the neighbours. Too small at free surfaces. */
    RHEO_DENSITY_SUMMATION = 1,
} rheo_density_scheme;

/** Laplacian of the temperature. */
typedef enum rheo_laplacian {
    /** First derivatives of the kernel W. */
    RHEO_LAPLACIAN_FIRST = 0,
    /** Second derivatives of the kernel W, which change sign. */
    RHEO_LAPLACIAN_SECOND = 1,
} rheo_laplacian;

/** Motion. */
typedef enum rheo_flow {
    /** Particles move. */
    RHEO_FLOW_ON = 0,
    /** Particles do not move and only heat flows. There are no stages of motion. */
    RHEO_FLOW_FROZEN = 1
} rheo_flow;

/** Velocity of the fluid along walls. */
typedef enum rheo_wall_slip {
    /** Zero. */
    RHEO_WALL_NO_SLIP = 0,
    /** Free. */
    RHEO_WALL_FREE_SLIP = 1
} rheo_wall_slip;

/** Whether an equation is used as Paiva et al. print it, misprint included. */
typedef enum rheo_as_printed {
    /** Corrected. */
    RHEO_AS_PRINTED_OFF = 0,
    /** As printed. */
    RHEO_AS_PRINTED_ON = 1
} rheo_as_printed;

/* ---- Definitions ---- */

/** A plane wall. The fluid is on the side that the normal points to. */
typedef struct rheo_wall {
    /** Any point of the plane. Unit L. Finite. */
    double point[3];
    /** Normal. Must not be zero; a world normalises it on creation. */
    double normal[3];
} rheo_wall;

/** A rigid ball of the thickening model. Start from rheo_default_ball(). */
typedef struct rheo_ball {
    /** Radius R. Unit L. Range >= 0, default 0. Zero: no ball; else at least 1e-12. */
    double radius;
    /**
     * Density of the ball divided by that of the fluid. Range >= 1e-06, default 2. Mass = ratio x volume x
     * particles per volume.
     */
    double density_ratio;
    /** Centre at step 0. Unit L. Any finite value, default [0, 0, 0]. */
    double position[3];
    /** Velocity at step 0. Unit L/T. Any finite value, default [0, 0, 0]. */
    double velocity[3];
    /** Angular velocity at step 0. Unit 1/T. Any finite value, default [0, 0, 0]. */
    double spin[3];
    /** Rate mu at which contact stops sliding. Unit 1/T. Range >= 0, default 25. */
    double friction;
    /**
     * Periodic push, as by the leg of a runner: its acceleration, mean over a period. Unit L/T^2. Any finite
     * value, default [0, 0, 0]. Zero when a world is made: there is none.
     */
    double push[3];
    /** Pushes in a unit of time; the first begins at step 0. Unit 1/T. Range >= 1e-12, default 1. */
    double push_frequency;
    /**
     * Share of a period, from its start on, in which the ball is pushed, as half a sine. Range 1e-06 to 1, default
     * 0.5.
     */
    double push_duty;
} rheo_ball;

/**
 * A material of the thickening model beside the main one, whose parameters are in springs and history of the
 * definition. A member below 0 is that of the main material, also when that changes. All else, the pressure and the
 * viscosity of the fluid and kind, order, window and weights of the history, is common to all materials. Start from
 * rheo_default_material().
 */
typedef struct rheo_material {
    /** Name in scene files: a letter, then letters, digits, - and _. Not "main"; no two materials have the same. */
    char name[16];
    /** Its springs. */
    struct {
        /** k_min. Unit 1/T^2. Range >= -1, default -1. */
        double stiffness;
        /** Rate alpha. Unit 1/T. Range >= -1, default -1. */
        double plasticity;
        /** Strain gamma. Range >= -1, default -1. */
        double yield_ratio;
    } springs;
    /** Its history. */
    struct {
        /** k_hist. Unit T^(q-2)/L. Range >= -1, default -1. */
        double stiffness;
        /** Onset n0. Unit L/T^q. Range >= -1, default -1. */
        double onset;
    } history;
} rheo_material;

/** Shape of an obstacle. Words sphere, box, cylinder, mesh. */
typedef enum rheo_obstacle_shape {
    /** A sphere: radius. */
    RHEO_OBSTACLE_SPHERE = 0,
    /** A box: size. */
    RHEO_OBSTACLE_BOX = 1,
    /** A cylinder: axis, radius, length. */
    RHEO_OBSTACLE_CYLINDER = 2,
    /** A closed mesh: file or mesh, height. */
    RHEO_OBSTACLE_MESH = 3,
} rheo_obstacle_shape;

/** Where the fluid is: outside of an obstacle, or inside, as in a drum. Words false, true. */
typedef enum rheo_obstacle_side {
    /** The fluid is outside. */
    RHEO_OBSTACLE_OUTSIDE = 0,
    /** The fluid is inside. */
    RHEO_OBSTACLE_INSIDE = 1
} rheo_obstacle_side;

/**
 * An obstacle: a rigid solid whose motion is given, and which stops fluid and ball as a wall does (docs/model.md,
 * Obstacles). Its centre moves with the velocity
 *
 *     velocity + amplitude 2 pi frequency cos(2 pi phase),   d phase/dt = frequency,
 *
 * phase 0 at step 0, and it turns about its centre with the angular velocity `spin`. Start from
 * rheo_default_obstacle().
 */
typedef struct rheo_obstacle {
    /** Shape. Words sphere, box, cylinder, mesh; default sphere. */
    rheo_obstacle_shape shape;
    /** Where the fluid is. Words false (outside), true (inside); default false. */
    rheo_obstacle_side inside;
    /** Centre at step 0; of a mesh: middle of the underside of its bounding box. Unit L. Any finite value, default [0, 0, 0]. */
    double position[3];
    /** Rotation about the centre at step 0: along its axis, as long as its angle in degrees. Any finite value, default [0, 0, 0]. */
    double rotation[3];
    /** Sphere, cylinder: radius. Unit L. Range >= 0, default 1. Zero is refused. */
    double radius;
    /** Box: lengths of its edges. Unit L. Range >= 0, default [1, 1, 1]. Zero is refused. */
    double size[3];
    /** Cylinder: direction of its axis. Any finite value, default [0, 1, 0]. Zero is refused. */
    double axis[3];
    /** Cylinder: length along its axis. Unit L. Range >= 0, default 1. Zero is refused. */
    double length;
    /** Mesh: height (y) that it is scaled to; 0: as it is. Unit L. Range >= 0, default 0. */
    double height;
    /** Velocity. Unit L/T. Any finite value, default [0, 0, 0]. */
    double velocity[3];
    /** Angular velocity. Unit 1/T. Any finite value, default [0, 0, 0]. */
    double spin[3];
    /** Amplitude of an oscillation, which begins in the middle. Unit L. Any finite value, default [0, 0, 0]. */
    double amplitude[3];
    /** Its frequency. Unit 1/T. Range >= 0, default 0. */
    double frequency;
    /** Scenes only, mesh: "bunny" or the path of an .obj or .ply file, as in rheo_fill. */
    char file[256];
    /**
     * Mesh: a closed surface, two triangles at every edge, oriented alike; the vertices of a triangle are anticlockwise
     * seen from outside. A world copies both arrays.
     */
    struct {
        /** Number of vertices. */
        uint32_t vertex_count;
        /** Number of triangles. */
        uint32_t triangle_count;
        /** Vertices. Unit L. Within 1e30. */
        const double (*vertex)[3];
        /** Triangles: numbers of vertices. No triangle has an area of 0. */
        const uint32_t (*triangle)[3];
    } mesh;
} rheo_obstacle;

/** Opening of an emitter: a disc, or a rectangle. */
typedef enum rheo_emitter_shape {
    /** A disc: radius. */
    RHEO_EMITTER_DISC = 0,
    /** A rectangle: width, height. */
    RHEO_EMITTER_RECTANGLE = 1
} rheo_emitter_shape;

/** Whether fluid flows from an emitter. */
typedef enum rheo_emitter_flow {
    /** Nothing flows. */
    RHEO_EMITTER_OFF = 0,
    /** Fluid flows between the times start and end. */
    RHEO_EMITTER_ON = 1
} rheo_emitter_flow;

/**
 * An emitter: a nozzle that adds particles while a world runs. It emits layers, plane square lattices of distance
 * fluid.spacing, each as soon as the one before has moved on by fluid.spacing; a layer that left in the middle of a step
 * begins where it has come to since. So the volume that flows out is speed x area x time, where a particle stands for
 * spacing^3. Layers are emitted at the beginning of a step, after commands. A particle that would be nearer than half a
 * spacing to another, to a ball or to an obstacle is left out. Start from rheo_default_emitter().
 */
typedef struct rheo_emitter {
    /** Name in scene files: a letter, then letters, digits, - and _. Not "main"; no two emitters have the same. */
    char name[16];
    /** Opening. Words disc, rectangle; default disc. */
    rheo_emitter_shape shape;
    /** Whether it flows. Words off, on; default on. A pause does not change where the next layer is due. */
    rheo_emitter_flow flow;
    /** Centre of the opening. Unit L. In front of all walls; default [0, 0, 0]. */
    double position[3];
    /** Direction of the flow, and normal of the opening. Any length but 0; default [0, -1, 0]. */
    double direction[3];
    /** Disc: radius. Unit L. Range >= 0, at most 1000 spacings; default 0: a thread of single particles. */
    double radius;
    /**
     * Rectangle: width, along the horizontal axis in the opening (along x if the flow is vertical).
     * A layer has round(width/spacing) x round(height/spacing) particles, at least one each. Unit L. Range >= 0, at most
     * 1000 spacings; default 0.
     */
    double width;
    /** The same along the other axis. */
    double height;
    /** Speed of the particles. Unit L/T. Range > 0, at most a support in a step; default 1. */
    double speed;
    /** Time at which it begins to flow. Unit T. Range >= 0, default 0. */
    double start;
    /** Time at which it ends to flow. Unit T. Range >= 0, default 1e30. */
    double end;
    /** Most particles that it emits. Range 1 to 2^30, default 10000. */
    uint64_t limit;
    /** Thickening only: number of their material (rheo_world_def_material()). Fixed. Default 0, the main one. */
    uint64_t material;
    /** Melting only: their temperature. Unit K. Fixed. Default -1e30: melting.temperature. */
    double temperature;
} rheo_emitter;

/**
 * Definition of a world. Start from rheo_default_world_def() or rheo_default_model_def() and change members.
 *
 * Parameters have their member as a name, for example "springs.stiffness", in rheo_world_def_set(), scene files and
 * `--set`. "Range >= a" includes an upper limit of at least 1e12, and "any finite value" limits of +-1e12 or more
 * (rheo_parameter_at() has the numbers). "Words" are the names of the enumerators, in their order. A model ignores
 * the parameters that it does not have.
 */
typedef struct rheo_world_def {
    /** Model. Words thickening, melting; default thickening. */
    rheo_model model;
    /** Time step, fixed. Unit T. Range 1e-12 to 1000000, default 0.033 (melting: 0.02). */
    double step;
    /** Acceleration of gravity. Unit L/T^2. Any finite value, default [0, -9.81, 0] (melting: [0, -1, 0]). */
    double gravity[3];

    /** Order in which forces act. Words summed, sequential, positions; default summed. Thickening only. */
    rheo_scheme scheme;
    /**
     * Substeps in a step of scheme summed. Range 0 to 1000, default 0. Zero: as many as the state needs. Thickening
     * only.
     */
    uint64_t substeps;
    /**
     * Most substeps of a step if `substeps` is 0. Springs that need more are softened for the step. Range 1 to 1000,
     * default 16. With 1, even a gentle impact blows up. Thickening only.
     */
    uint64_t max_substeps;

    /** Fluid. All but spacing: thickening only. */
    struct {
        /** Support: radius h within which particles are neighbours. Unit L. Range >= 1e-12, default 4. */
        double support;
        /** Distance of particles at rest. Unit L. Range >= 1e-12, default 2 (melting: 0.045). */
        double spacing;
        /** Stiffness k of the pressure k (rho - rho0). Unit L/T^2. Range >= 0, default 300. */
        double stiffness;
        /** Stiffness k_near of the near pressure. Unit L/T^2. Range >= 0, default 500. */
        double near_stiffness;
        /** Rest density rho0: sum of (1 - r/h)^2 over the neighbours at rest. Range >= 0, default 2.6. */
        double rest_density;
        /**
         * Largest tension in units of k: pressures are at least -cohesion k. Range >= 0, default 0.45. The
         * default lowers the tension of free surfaces by a third. In scheme positions the constraint is at least
         * -cohesion/rho0. Not in scheme sequential.
         */
        double cohesion;
        /** Factor sigma of the viscosity impulse. Unit 1/T. Range >= 0, default 4. */
        double linear_viscosity;
        /** Factor beta of the viscosity impulse. Unit 1/L. Range >= 0, default 0.1. */
        double quadratic_viscosity;
        /**
         * Particles per volume, which set the mass of the ball. Unit 1/L^3. Range >= 0, default 0. Zero: in scenes
         * the settled density; otherwise that of fluid at rest (docs/model.md, Spacing), or 1/spacing^3 if stiffness,
         * near_stiffness or rest_density do not let fluid rest.
         */
        double number_density;
    } fluid;

    /** Scheme positions. Thickening only. */
    struct {
        /** Iterations of the density constraint in a step. Range 1 to 1000, default 4. */
        uint64_t iterations;
        /**
         * Relaxation epsilon, the compliance of the density constraint. Unit 1/support^2. Range >= 0, default 10. Zero:
         * as hard as the iterations make it; then a multiplier of the constraint has no effect.
         */
        double relaxation;
        /** Rate c of the XSPH viscosity. Unit 1/T. Range >= 0, default 1. Zero: no viscosity. */
        double viscosity;
        /** What the history multiplies. Words both, constraint, viscosity; default both. */
        rheo_positions_history history;
    } positions;

    /** Springs between particles. Thickening only. */
    struct {
        /** Stiffness k_min without history. Unit 1/T^2. Range >= 0, default 15. Zero: no springs, and no history. */
        double stiffness;
        /** Rate alpha at which rest lengths flow. Unit 1/T. Range >= 0, default 4. */
        double plasticity;
        /** Strain gamma below which rest lengths do not flow. Range >= 0, default 0.02. */
        double yield_ratio;
        /** Rest length of a new spring. Words distance, support; default distance. */
        rheo_rest_length rest_length;
        /**
         * Displacement of the ends in scheme sequential; scheme summed softens springs that are too stiff instead.
         * Words explicit, implicit; default explicit.
         */
        rheo_spring_solver solver;
    } springs;

    /** History of the springs: fractional derivative D^q of the positions. Thickening only. */
    struct {
        /** Kind of memory. Words window, window-fast, full, tempered; default window. */
        rheo_history_kind kind;
        /**
         * Whose D^q stiffens a spring: the vector between its ends, as in the paper, or its length, which a body that
         * turns does not change. Words vector, length; default vector. Length: scheme summed, kind window and active
         * hardening only.
         */
        rheo_history_of of;
        /**
         * Stiffness k_hist of Eq. 6. Unit T^(q-2)/L. Range >= 0, default 150. Zero: no history, and no memory for it.
         */
        double stiffness;
        /**
         * Onset n0: K = k_min + k_hist n^2/(n + n0) with the difference n of D^q x between the ends. The noise of a
         * fluid at rest then does not stiffen it. Unit L/T^q. Range >= 0, default 0.05. Zero: none, as in the paper.
         */
        double onset;
        /** Force of a spring that stiffens. Words active, passive; default active. Scheme summed only. */
        rheo_hardening hardening;
        /** Order q of the fractional derivative. Range 0 < x < 1, default 0.5. */
        double order;
        /** Window d in steps: lags 0 to d count. Range 1 to 1000000, default 150. Ignored for kind full. */
        uint32_t window;
        /** Window in seconds, rounded to steps on creation. Unit T. Used instead of `window` if > 0; default 0. */
        double window_seconds;
        /**
         * Lag in steps, the time to solidify: only velocities that are at least so old count, and the window begins
         * there. Range 0 to 1000000, default 0.
         */
        uint32_t lag;
        /** Lag in seconds, rounded to steps on creation, at least half a step. Unit T. Used instead of `lag` if > 0; default 0. */
        double lag_seconds;
        /** Weights of D^q: as in the paper, or of the L1 scheme. Words paper, l1; default paper. */
        rheo_weights weights;
        /**
         * Number of points of a curve of weights that replaces the power law; then order, window and weights do not
         * apply, and the window ends with the curve. Range 0 (none) or 2 to RHEO_MAX_CURVE_POINTS, default 0. Kind
         * window only.
         */
        uint32_t curve_count;
        /** The curve: weight by age, the age counted from the lag. Fixed. A world copies it. */
        const rheo_curve_point *curve;
    } history;

    /** Walls. `sticking`: thickening only. */
    struct {
        /** Rate c_b at which walls stop the sliding of stiff fluid. Unit 1/T. Range >= 0, default 30. */
        double sticking;
        /** Number of walls. Range 0 to RHEO_MAX_WALLS, default 0. */
        uint32_t count;
        /** Walls, in the order in which they act. A world copies them. */
        const rheo_wall *plane;
    } walls;

    /** Obstacles. Thickening only; not in periodic space. */
    struct {
        /** Number of obstacles. Range 0 to RHEO_MAX_OBSTACLES, default 0. */
        uint32_t count;
        /** Obstacle 0, 1, ..., in the order in which they act. */
        rheo_obstacle list[RHEO_MAX_OBSTACLES];
    } obstacles;

    /** A rigid ball. Thickening only. */
    /** A rigid ball, the first one. Thickening only. */
    rheo_ball ball;
    /** Further balls: ball2, ball3, ... Needs a first ball. Thickening only. */
    struct {
        /** Number of further balls. Range 0 to RHEO_MAX_BALLS - 1, default 0. */
        uint32_t count;
        /** Ball 2, 3, ...; each has a radius of at least 1e-12. */
        rheo_ball list[RHEO_MAX_BALLS - 1];
    } balls;

    /** Vibrators at fixed positions. Thickening only. */
    struct {
        /** Effect of the vibrators. Words floor, force; default floor. */
        rheo_vibrator_kind kind;
        /** Amplitude a. Unit L. Range >= 0, default 0.3. */
        double amplitude;
        /** Mean frequency f0. Unit 1/T. Range >= 1e-12, default 5. */
        double frequency;
        /**
         * Half width of the range f0 (1 +- spread) in which each frequency walks at random. Range 0 to 1, default
         * 0.5.
         */
        double spread;
        /**
         * Random walk of each frequency: in a substep tau it changes by at most wander f0 sqrt(tau), in a time t by
         * wander f0 sqrt(t/3) rms. Unit 1/T^(1/2). Range 0 to 1000000, default 0.275.
         */
        double wander;
        /** Radius of a vibrator. Unit L. Range >= 1e-12, default 2. */
        double radius;
        /** RHEO_VIBRATOR_FORCE only: particles with y below this are pushed. Unit L. Any finite value, default 0. */
        double height;
        /** Seed of the first frequencies and of their random walk, below 2^53. Range >= 0, default 1. */
        uint64_t seed;
        /** Number of vibrators. Range 0 to RHEO_MAX_VIBRATORS, default 0. */
        uint32_t count;
        /** x and z of each vibrator. Unit L. Finite. A world copies them. */
        const double (*position)[2];
    } vibrators;

    /** Space. Thickening only, scheme summed; without a ball and vibrators. */
    struct {
        /**
         * Period of space along x, y, z: the point x + period is the point x. At least 2.5 supports. Walls must not
         * cross periodic axes. Unit L. Range >= 0, default [0, 0, 0]. Zero: space is open along this axis.
         * A world rounds it to one part in 2^23 (float).
         */
        double period[3];
    } space;

    /**
     * Two plates of particles, which move as rigid bodies and hold their particles in place: a rheometer. They need
     * periods along x and z, and open space along y. Thickening only, scheme summed.
     */
    struct {
        /**
         * Particles that start below this height are the lower plate, which rests. Particles that are added later belong
         * to no plate, unless the world had none. Unit L. Any finite value, default 0.
         */
        double lower;
        /**
         * Particles that start above this height are the upper plate. Unit L. Any finite value, default 0. Both heights
         * 0: no plates; else lower < upper.
         */
        double upper;
        /** What moves the upper plate. Words velocity, stress; default velocity. */
        rheo_plates_control control;
        /** Control velocity: velocity of the upper plate. Unit L/T. Any finite value, default [0, 0, 0]. */
        double velocity[3];
        /**
         * Control velocity: the upper plate also oscillates along x; its displacement adds amplitude sin(2 pi phase).
         * Unit L. Range >= 0, default 0.
         */
        double amplitude;
        /** Control velocity: rate of the phase, in turns. Unit 1/T. Range >= 0, default 0. */
        double frequency;
        /**
         * Control stress: shear stress along x on the upper plate, divided by the number density (docs/model.md, The
         * fluid as a continuum). Unit L^2/T^2. Any finite value, default 0.
         */
        double stress;
    } plates;

    /**
     * Materials beside the main one (rheo_material). A spring between two materials has the means of their parameters.
     * Thickening only, scheme summed.
     */
    struct {
        /** Number of materials. Range 0 to RHEO_MAX_MATERIALS, default 0. */
        uint32_t count;
        /** Material 1, 2, ...; material 0 is the main one. */
        rheo_material list[RHEO_MAX_MATERIALS];
    } materials;

    /** Emitters. */
    struct {
        /** Number of emitters. Range 0 to RHEO_MAX_EMITTERS, default 0. */
        uint32_t count;
        /** Emitter 0, 1, ... */
        rheo_emitter list[RHEO_MAX_EMITTERS];
    } emitters;

    /** The melting model, in the terms of its paper. */
    struct {
        /**
         * Smoothing length h; the support of the kernel W is 3 h. Unit L. Range >= 0, default 0. Zero: the spacing.
         */
        double smoothing_length;
        /** Rest density rho0. Unit M/L^3. Range >= 1e-12, default 1. */
        double rest_density;
        /**
         * Speed of sound c in p = c^2 (rho - rho0). Unit L/T. Range >= 1e-12, default 10. Choose about ten times the
         * largest flow speed.
         */
        double sound_speed;
        /** Apparent viscosity. Words jump, newtonian; default jump. */
        rheo_rheology rheology;
        /** Dynamic viscosity mu; eta = mu eta*(D t0). Unit M/(L T). Range >= 0, default 0.05. */
        double viscosity;
        /** Time scale t0; the yield stress is mu/t0. Unit T. Range >= 1e-12, default 0.05. */
        double time_scale;
        /** Index n of the power law. Range 0 to 2, default 0.5. Below 1: shear thinning. */
        double power_law_index;
        /** Jump number J of molten particles. Range 0 to 1000000000, default 0. */
        double jump_number_min;
        /**
         * Jump number J of solid particles. Below the yield stress they creep as a fluid of viscosity mu (J + 1). Range
         * 0 to 1000000000, default 100000.
         */
        double jump_number_max;
        /**
         * Temperature at which melting begins. Unit K. Any finite value, default 0.45. Must be below temperature_max.
         */
        double temperature_min;
        /** Temperature at which melting ends. Unit K. Any finite value, default 0.55. */
        double temperature_max;
        /** Temperature of particles that have none of their own. Unit K. Any finite value, default 0. */
        double temperature;
        /** Thermal diffusivity k of dT/dt = k lap T. Unit L^2/T. Range >= 0, default 0.001. Zero: no heat flows. */
        double diffusivity;
        /** Artificial viscosity, bulk term. Range 0 to 1000000, default 0.1. */
        double alpha;
        /** Artificial viscosity, von Neumann-Richtmyer term. Range 0 to 1000000, default 0.1. */
        double beta;
        /**
         * Factor epsilon of XSPH: share of the neighbours' mean velocity in the motion. Range 0 to 1, default 0.5.
         */
        double xsph;
        /**
         * Repulsion of pairs closer than 0.7 spacings, which prevents clumping, in c^2/spacing. Range 0 to 1000000,
         * default 0.05.
         */
        double repulsion;
        /** Length of a substep in h/(c + |v|max). Range 1e-06 to 10, default 0.4. */
        double courant_number;
        /** Substeps in a step. Range 0 to 200000, default 0. Zero: as many as the state needs. */
        uint64_t substeps;
        /** A step that needs more substeps fails. Range 1 to 200000, default 20000. */
        uint64_t max_substeps;
        /** Discretisation of the viscous stress. Words pairwise, nested; default pairwise. */
        rheo_stress stress;
        /** Time integration of the viscosity. Words implicit, explicit; default implicit. */
        rheo_viscosity_solver solver;
        /**
         * Conjugate gradients: error of the velocities relative to their change in a substep (docs/melting.md, 5).
         * Range 1e-12 to 1, default 0.003.
         */
        double tolerance;
        /** Conjugate gradients: most iterations in a substep. Range 1 to 1000000, default 100. */
        uint64_t max_iterations;
        /** Density. Words continuity, summation; default continuity. */
        rheo_density_scheme density;
        /** Laplacian of the temperature. Words first, second; default first. */
        rheo_laplacian laplacian;
        /** Motion. Words on, frozen; default on. */
        rheo_flow flow;
        /** Velocity along walls. Words no-slip, free-slip; default no-slip. */
        rheo_wall_slip wall;
    } melting;

    /** Equations as printed by Paiva et al. Melting only. docs/melting.md has the measured differences. */
    struct {
        /** Kernel: 3/(359 pi h^3) instead of 1/(120 pi h^3). Words off, on; default off. */
        rheo_as_printed kernel;
        /** Jump number: J(T) = (1 - u) Jmax - u Jmin, u not clamped to 0..1. Words off, on; default off. */
        rheo_as_printed jump;
        /** Eq. 8: another 1/rho_i, and sums that begin at j = i. Words off, on; default off. */
        rheo_as_printed artificial_viscosity;
        /** Eq. 10: 0.1 min(h/(|v| + c^2), h^2/(6 eta)). Words off, on; default off. */
        rheo_as_printed courant;
        /** Eq. 9: changes the velocities themselves. Words off, on; default off. */
        rheo_as_printed xsph;
        /** Heat equation: the weight 4 m_j rho_i/(rho_j (rho_i + rho_j)). Words off, on; default off. */
        rheo_as_printed heat;
        /** Algorithm 1: all rates from the state at the start of a substep. Words off, on; default off. */
        rheo_as_printed leapfrog;
    } paper;

    /** Particles at step 0; a world copies the arrays. Their order sets the ids: another order is another scene. */
    struct {
        /** Number of particles. Range 0 to 2^30. */
        uint32_t count;
        /** Positions, count x 3. Unit L. Finite. */
        const rheo_real *position;
        /** Velocities, count x 3. Unit L/T. Finite. NULL: at rest. */
        const rheo_real *velocity;
        /** Melting only: densities, count. Unit M/L^3. Range > 0. NULL: the rest density. */
        const rheo_real *density;
        /** Melting only: temperatures, count. Unit K. Finite. NULL: an isothermal world. */
        const rheo_real *temperature;
        /** Materials, count: 0 is the main one, k is materials.list[k - 1]. NULL: all 0. */
        const uint32_t *material;
        /** Thickening only: number of springs. */
        uint32_t spring_count;
        /** Ends of the springs, spring_count x 2 ids: the smaller id first, ascending, without repeats. */
        const uint32_t *spring_ends;
        /** Rest lengths, spring_count. Unit L. Range >= 0. */
        const rheo_real *spring_rest_length;
    } particles;

    /** Memory of the world; all NULL: malloc and free. */
    rheo_allocator allocator;
    /** Receives messages that are not errors; NULL: none. */
    rheo_log log;
    /** Set by rheo_default_world_def(): the definition has its defaults. */
    uint32_t cookie;
} rheo_world_def;

/** Defaults of the thickening model: parameter set P of docs/model.md, no particles, walls, ball or vibrators. */
RHEO_API rheo_world_def rheo_default_world_def(void);
/** Defaults of a model, which must exist. */
RHEO_API rheo_world_def rheo_default_model_def(rheo_model model);
/** A ball with the defaults of def.ball; it has no radius. */
RHEO_API rheo_ball rheo_default_ball(void);
/** Adds a further ball to a definition. RHEO_ERROR_ARGUMENT if there are RHEO_MAX_BALLS. */
RHEO_API rheo_result rheo_world_def_add_ball(rheo_world_def *def, const rheo_ball *ball, rheo_error *error);
/** Number of balls. */
RHEO_API uint32_t rheo_world_def_ball_count(const rheo_world_def *def);
/** Ball by index, 0 for def.ball; NULL past the last. */
RHEO_API const rheo_ball *rheo_world_def_ball(const rheo_world_def *def, uint32_t index);
/** A material with this name that has all parameters of the main one. A name that is too long is cut. */
RHEO_API rheo_material rheo_default_material(const char *name);
/**
 * Adds a material to a definition. RHEO_ERROR_ARGUMENT for a bad name, one that another material has, or too many.
 */
RHEO_API rheo_result rheo_world_def_add_material(rheo_world_def *def, const rheo_material *material,
                                                 rheo_error *error);
/** Number of the material with a name; 0 for "" and "main". False: there is none. */
RHEO_API bool rheo_world_def_material(const rheo_world_def *def, const char *name, uint32_t *number);
/** Name of a material; "main" for 0, "" if there is no such material. */
RHEO_API const char *rheo_world_def_material_name(const rheo_world_def *def, uint32_t number);
/** An obstacle of this shape with all its defaults: a sphere of radius 1, a cube with edges of 1, ... */
RHEO_API rheo_obstacle rheo_default_obstacle(rheo_obstacle_shape shape);
/** Adds an obstacle to a definition. RHEO_ERROR_ARGUMENT if it has too many. */
RHEO_API rheo_result rheo_world_def_add_obstacle(rheo_world_def *def, const rheo_obstacle *obstacle,
                                                 rheo_error *error);
/** An emitter with this name and the defaults. A name that is too long is cut. */
RHEO_API rheo_emitter rheo_default_emitter(const char *name);
/**
 * Adds an emitter to a definition. RHEO_ERROR_ARGUMENT for a bad name, one that another emitter has, or too many; the rest
 * is checked by rheo_world_def_check().
 */
RHEO_API rheo_result rheo_world_def_add_emitter(rheo_world_def *def, const rheo_emitter *emitter, rheo_error *error);
/** Number of particles in a layer of emitter 0, 1, ... of a valid definition; 0 if there is no such emitter. */
RHEO_API uint64_t rheo_world_def_emitter_sites(const rheo_world_def *def, uint32_t emitter);
/** Number of models; a rheo_model is below it. */
RHEO_API uint32_t rheo_model_count(void);
/** Name of a model, as in scene files: "thickening", "melting". NULL past the last model. */
RHEO_API const char *rheo_model_name(rheo_model model);

/**
 * Checks a definition, as rheo_world_create() does. RHEO_ERROR_ARGUMENT names the first value that is wrong and its
 * range.
 */
RHEO_API rheo_result rheo_world_def_check(const rheo_world_def *def, rheo_error *error);

/* ---- Parameters by name: the table behind --set, scene files, recordings and commands ---- */

/** What a parameter is, and how it is written. */
typedef enum rheo_parameter_type {
    /** A real number. */
    RHEO_PARAMETER_REAL,
    /** A whole number. */
    RHEO_PARAMETER_INTEGER,
    /** Three reals, written [x, y, z]. */
    RHEO_PARAMETER_VECTOR,
    /** One of the words in `choices`. */
    RHEO_PARAMETER_CHOICE,
    /** Steps, or seconds written "2.5 s". */
    RHEO_PARAMETER_WINDOW,
    /** Name of a material or an emitter. */
    RHEO_PARAMETER_NAME,
} rheo_parameter_type;

/** A parameter of a definition or scene. */
typedef struct rheo_parameter {
    /** Name, e.g. "fluid.support". */
    const char *path;
    /** Unit, e.g. "L/T^2"; "1" for a pure number. */
    const char *unit;
    /** Meaning, one line. */
    const char *about;
    /** RHEO_PARAMETER_CHOICE: choice_count words, indexed by their enumerators; else NULL. */
    const char *const *choices;
    /** Number of words. */
    uint32_t choice_count;
    /** Least value; -1e30: no bound. */
    double minimum;
    /** Largest value; 1e30: no bound. */
    double maximum;
    /** What it is. */
    rheo_parameter_type type;
    /** The minimum itself is not allowed. */
    bool above_minimum;
    /** The maximum itself is not allowed. */
    bool below_maximum;
    /** A command may change it in a running world. */
    bool live;
    /** Used only when a scene is made (scene.h); a world does not have it. */
    bool scene_only;
    /** Set of the models that have it: bit 1 << rheo_model. */
    uint32_t models;
} rheo_parameter;

/** Number of parameters of a world definition. */
RHEO_API size_t rheo_parameter_count(void);
/** Parameter by index; NULL past the last. */
RHEO_API const rheo_parameter *rheo_parameter_at(size_t index);
/**
 * Parameters of a definition with its items: those of rheo_parameter_at(), then six of each material, such as
 * materials.1.name and materials.1.springs.stiffness, those of each emitter, such as emitters.1.speed, those of each
 * further ball, such as ball2.radius, and those of each obstacle that its shape has, such as obstacles.0.velocity.
 */
RHEO_API size_t rheo_world_def_parameter_count(const rheo_world_def *def);
/** Parameter by index; NULL past the last. */
RHEO_API const rheo_parameter *rheo_world_def_parameter_at(const rheo_world_def *def, size_t index);
/**
 * Parameter by path, in which a material or an emitter has its number, from 1 on, or its name: materials.1.springs.stiffness
 * or materials.cornstarch.springs.stiffness, emitters.jet.speed. Those
 * of further balls are found up to RHEO_MAX_BALLS, whether the definition has these balls or not: ball2.radius. NULL if
 * there is none.
 */
RHEO_API const rheo_parameter *rheo_world_def_parameter_find(const rheo_world_def *def, const char *path);
/** Parameter of any further ball by index, with a path such as "ballN.radius"; NULL past the last. */
RHEO_API const rheo_parameter *rheo_ball_parameter_at(size_t index);
/** Parameter of any material by index, with a path such as "materials.NAME.springs.stiffness"; NULL past the last. */
RHEO_API const rheo_parameter *rheo_material_parameter_at(size_t index);
/** Parameter of any obstacle by index, with a path such as "obstacles.0.velocity"; NULL past the last. */
RHEO_API const rheo_parameter *rheo_obstacle_parameter_at(size_t index);
/** Whether obstacles of a shape have this parameter of rheo_obstacle_parameter_at(). */
RHEO_API bool rheo_obstacle_has_parameter(rheo_obstacle_shape shape, const rheo_parameter *parameter);
/** Parameter of any emitter by index, with a path such as "emitters.NAME.speed"; NULL past the last. */
RHEO_API const rheo_parameter *rheo_emitter_parameter_at(size_t index);
/** Writes the default of such a parameter as text; `value` holds >= 96 bytes. RHEO_ERROR_ARGUMENT if it is no such parameter. */
RHEO_API rheo_result rheo_emitter_default(const rheo_parameter *parameter, char *value, size_t size);
/** The path that is nearest to a misspelt one; never NULL. */
RHEO_API const char *rheo_parameter_nearest(const char *path);
/**
 * Writes the words of a choice, separated by blanks, or "" for other types. Returns `text`, which must hold 256
 * bytes.
 */
RHEO_API const char *rheo_parameter_words(const rheo_parameter *parameter, char *text, size_t size);
/**
 * Present name of a parameter, or of a group in scene files, that earlier versions called `path`; NULL for any other.
 */
RHEO_API const char *rheo_parameter_new_name(const char *path);

/**
 * Sets one parameter from text: "0.5", "150", "2.5 s", "[0, -9.81, 0]", "implicit". The locale does not matter.
 * RHEO_ERROR_ARGUMENT if the path is unknown (the message names the nearest), or the value is malformed or out of
 * range. The first parameter of ball N sets adds this ball, if the definition has N - 1 balls.
 */
RHEO_API rheo_result rheo_world_def_set(rheo_world_def *def, const char *path, const char *value, rheo_error *error);
/**
 * Writes a parameter as text that rheo_world_def_set() reads back to the same bits. `value` holds >= 96 bytes.
 * RHEO_ERROR_ARGUMENT for an unknown path.
 */
RHEO_API rheo_result rheo_world_def_get(const rheo_world_def *def, const char *path, char *value, size_t size);
/**
 * Finds the first parameter from *index on, which begins with 0, that two definitions have with other values, and writes
 * them; those of a material or emitter that one definition lacks are "" there. *index becomes that of the next one. NULL: no more
 * differ.
 */
RHEO_API const rheo_parameter *rheo_world_def_differing(const rheo_world_def *a, const rheo_world_def *b,
                                                        size_t *index, char of_a[96], char of_b[96]);

/* ---- Worlds ---- */

/** A world: a state, the definition in force and the list of stages that make a step. */
typedef struct rheo_world rheo_world;

/** The kind of object that a field has one value for. */
typedef enum rheo_location {
    /** The world itself. */
    RHEO_LOCATION_WORLD,
    /** A particle. */
    RHEO_LOCATION_PARTICLE,
    /** A spring between two particles. */
    RHEO_LOCATION_SPRING,
    /** A body, such as the ball. */
    RHEO_LOCATION_BODY,
    /** A vibrator. */
    RHEO_LOCATION_VIBRATOR,
    /** An obstacle. */
    RHEO_LOCATION_OBSTACLE
} rheo_location;

/** "world", "particle", "spring", "body", "vibrator" or "obstacle"; "item" for any other value. */
RHEO_API const char *rheo_item_name(rheo_location location);

/**
 * Makes a world at step 0 from a definition, whose arrays it copies. The world gets only the stages, fields and
 * memory that the definition needs: those of history, springs, viscosity, ball, walls, obstacles, vibrators or plates only
 * if present.
 * Errors: RHEO_ERROR_ARGUMENT (rheo_world_def_check()), RHEO_ERROR_MEMORY, and RHEO_ERROR_ENVIRONMENT in a
 * floating-point environment in which the bits would differ. *world is then NULL.
 */
RHEO_API rheo_result rheo_world_create(const rheo_world_def *def, rheo_world **world, rheo_error *error);
/** Frees a world. NULL is allowed. */
RHEO_API void rheo_world_destroy(rheo_world *world);

/** Why a step failed. The numbers are those of a recording. */
typedef enum rheo_failure_reason {
    /** No step failed. */
    RHEO_FAILURE_NONE = 0,
    /** A value is NaN or infinite, or is a velocity too large for the sums of a history. */
    RHEO_FAILURE_NOT_FINITE = 1,
    /** The density of a particle is not above 0. */
    RHEO_FAILURE_DENSITY_NOT_POSITIVE = 2,
    /** The speed of sound or of the fluid requires more substeps than melting.max_substeps. */
    RHEO_FAILURE_SUBSTEPS_FOR_SOUND = 3,
    /** Explicit viscosity requires more substeps than melting.max_substeps. */
    RHEO_FAILURE_SUBSTEPS_FOR_VISCOSITY = 4,
    /** The printed viscous limit (paper.courant) requires more substeps than melting.max_substeps. */
    RHEO_FAILURE_SUBSTEPS_FOR_PRINTED_VISCOSITY = 5,
    /** Heat conduction requires more substeps than melting.max_substeps. */
    RHEO_FAILURE_SUBSTEPS_FOR_HEAT = 6,
    /** The viscous solver meets numbers outside the range of rheo_real; the particle is the most viscous one. */
    RHEO_FAILURE_VISCOSITY_OUT_OF_RANGE = 7
} rheo_failure_reason;

/** Where and why a step failed: the first bad value, and the stage that made it or refused it. */
typedef struct rheo_failure {
    /** The step that failed; the world stays at the step before. */
    uint64_t step;
    /** Model of the world. */
    rheo_model model;
    /** Stage, in a substep with its number from 1: "viscosity@3". "" if the state was bad before the first stage. */
    char stage[32];
    /** Name of the field with the bad value. */
    char field[32];
    /** Kind of object that the field belongs to. */
    rheo_location location;
    /** Id of the particle, body or vibrator; 0 for RHEO_LOCATION_WORLD. */
    uint64_t id;
    /** Component of the field, from 0. RHEO_FAILURE_NOT_FINITE only, else 0. */
    uint32_t component;
    /** Why the step failed. */
    rheo_failure_reason reason;
    /** RHEO_FAILURE_SUBSTEPS_...: substeps that the step requires; may be infinite. Else 0. */
    double required;
    /** RHEO_FAILURE_SUBSTEPS_...: melting.max_substeps. Else 0. */
    double limit;
} rheo_failure;

/** Word for a reason, such as "not-finite" or "substeps-for-heat"; "unknown" if this version does not know it. */
RHEO_API const char *rheo_failure_reason_name(rheo_failure_reason reason);

/**
 * Writes one line that says where and why a step failed and what may help, at most `size` bytes with the final 0.
 * 512 bytes are enough.
 */
RHEO_API void rheo_failure_message(const rheo_failure *failure, char *text, size_t size);

/**
 * Makes one step, or finishes the one that rheo_world_step_stage() began. On any error the world stays as it was
 * before the step. Errors: RHEO_ERROR_STATE if a value of the state became NaN or infinite, or a stage refused to go
 * on (the error names step, stage, field and particle; see rheo_world_failure()), RHEO_ERROR_MEMORY, and
 * RHEO_ERROR_ENVIRONMENT, after which the world can go on once the calling thread has restored its floating-point
 * environment.
 */
RHEO_API rheo_result rheo_world_step(rheo_world *world, rheo_error *error);
/**
 * Makes the next stage of a step. *stage becomes its index, for rheo_world_stage(). In the middle of a step a world
 * can be read; it takes no commands and cannot be recorded. Errors: those of rheo_world_step(); the world is then as
 * it was before the step.
 */
RHEO_API rheo_result rheo_world_step_stage(rheo_world *world, uint32_t *stage, rheo_error *error);
/** Stage runs made of an unfinished step, in all substeps; 0 between steps. */
RHEO_API uint32_t rheo_world_stages_done(const rheo_world *world);
/** Stage runs in the current step; exact only after stage `substeps` has run. */
RHEO_API uint32_t rheo_world_stages_in_step(const rheo_world *world);
/** Name of the last stage run of an unfinished step, with its substep as in "viscosity@3"; "" between steps. */
RHEO_API void rheo_world_last_stage(const rheo_world *world, char name[32]);
/** Whether the last attempt at a step failed with RHEO_ERROR_STATE; *failure then says where. */
RHEO_API bool rheo_world_failure(const rheo_world *world, rheo_failure *failure);

/** The definition in force, with all changes by commands. Its particles are empty; window and lag are in steps. */
RHEO_API const rheo_world_def *rheo_world_definition(const rheo_world *world);

/** Number of steps made. */
RHEO_API uint64_t rheo_world_step_count(const rheo_world *world);
/** Time of the state. Unit T. */
RHEO_API double rheo_world_time(const rheo_world *world);

/** Hash of the whole state: all fields, rings and springs. Equal states have equal hashes on any machine. */
RHEO_API uint64_t rheo_world_hash(const rheo_world *world);

/* ---- Commands: change a world between steps; a recorder records them, a replay applies them ---- */

/**
 * Kind of a command. On any error of a command the world is unchanged. All commands return RHEO_ERROR_ARGUMENT in the
 * middle of a step, RHEO_ERROR_ENVIRONMENT like rheo_world_step(), or RHEO_ERROR_MEMORY.
 */
typedef enum rheo_command_kind {
    /** A parameter is changed: rheo_world_set(). */
    RHEO_COMMAND_SET = 1,
    /** The ball gets an impulse: rheo_world_push_body(). */
    RHEO_COMMAND_PUSH_BODY = 2,
    /** Particles are added: rheo_world_add_particles(). */
    RHEO_COMMAND_ADD_PARTICLES = 3,
    /** A vibrator is moved: rheo_world_move_vibrator(). */
    RHEO_COMMAND_MOVE_VIBRATOR = 4,
} rheo_command_kind;

/**
 * Applies an impulse to a ball, 0 for the first. impulse: unit M L/T, where a particle has mass 1. point: where it acts, unit L;
 * NULL: at the centre. RHEO_ERROR_ARGUMENT if there is no such body or the resulting speed exceeds 1e30.
 */
RHEO_API rheo_result rheo_world_push_body(rheo_world *world, uint32_t body, const double impulse[3],
                                          const double point[3], rheo_error *error);
/**
 * Changes a live parameter; those of a material or an emitter are found by its name or number
 * (rheo_world_def_parameter_find()). "emitters.jet.flow" with "off" and "on" switches the emitter jet. ball.position,
 * ball.velocity and ball.spin, and those of further balls, set the state, as position and rotation of an obstacle do
 * (obstacles.0.position). RHEO_ERROR_ARGUMENT if the parameter is unknown, not live,
 * or out of range; if its stages are missing because it was 0 at creation (say history.stiffness); or if it is
 * history.weights (kinds full and tempered), history.order (kind tempered), or with history.of length the step.
 */
RHEO_API rheo_result rheo_world_set(rheo_world *world, const char *path, const char *value, rheo_error *error);
/**
 * Adds particles, whose ids follow the existing ones. position: count x 3, unit L. velocity: count x 3, unit L/T;
 * NULL: at rest. History assumes that they have been at rest. RHEO_ERROR_ARGUMENT if a value is not finite.
 */
RHEO_API rheo_result rheo_world_add_particles(rheo_world *world, uint32_t count, const rheo_real *position,
                                              const rheo_real *velocity, rheo_error *error);
/** rheo_world_add_particles() of a material (rheo_world_def_material()). RHEO_ERROR_ARGUMENT if there is none. */
RHEO_API rheo_result rheo_world_add_particles_of(rheo_world *world, uint32_t material, uint32_t count,
                                                 const rheo_real *position, const rheo_real *velocity,
                                                 rheo_error *error);
/** Moves a vibrator. x, z: unit L, within 1e30. RHEO_ERROR_ARGUMENT if there is no such vibrator. */
RHEO_API rheo_result rheo_world_move_vibrator(rheo_world *world, uint32_t vibrator, double x, double z,
                                              rheo_error *error);

/* ---- Particles ---- */

/** Number of particles. */
RHEO_API uint32_t rheo_world_particle_count(const rheo_world *world);
/** Positions: particle_count x 3 values in the order of ids, unit L. Valid until the next step or command. */
RHEO_API const rheo_real *rheo_world_positions(const rheo_world *world);
/** Velocities: the same, unit L/T. */
RHEO_API const rheo_real *rheo_world_velocities(const rheo_world *world);

/* ---- Emitters ---- */

/** What an emitter has done. */
typedef struct rheo_emitter_state {
    /** Particles that it has emitted. */
    uint64_t emitted;
    /** Particles that it left out because there was no room. */
    uint64_t blocked;
    /** Particles in a layer. */
    uint64_t sites;
    /** Way of the newest layer until the next one is due. Unit L. */
    double way;
} rheo_emitter_state;

/** State of emitter 0, 1, ... False: there is no such emitter. */
RHEO_API bool rheo_world_emitter(const rheo_world *world, uint32_t emitter, rheo_emitter_state *state);

/* ---- Springs ---- */

/** A spring between two particles. */
typedef struct rheo_spring {
    /** Smaller id of its ends. */
    uint32_t a;
    /** Larger id of its ends. */
    uint32_t b;
    /** Rest length. Unit L. */
    rheo_real rest_length;
} rheo_spring;

/** Number of springs. */
RHEO_API size_t rheo_world_spring_count(const rheo_world *world);
/** Copies up to `capacity` springs, ascending by a, then b. RHEO_ERROR_MEMORY if there is no memory for sorting. */
RHEO_API rheo_result rheo_world_springs(const rheo_world *world, rheo_spring *springs, size_t capacity);

/** State of a spring. */
typedef struct rheo_spring_state {
    /** Its ends and rest length. */
    rheo_spring spring;
    /** Distance of the ends. Unit L. */
    double length;
    /** |D^q (x_a - x_b)|, with history.of length |D^q |x_a - x_b||, from the present history. Unit L/T^q; 0 without. */
    double history_rate;
    /** K = k_min + k_hist history_rate^2/(history_rate + history.onset). Unit 1/T^2. */
    double stiffness;
    /** Stiffness number substep^2 K, with the substep of the last step; softening is not included. */
    double kappa;
} rheo_spring_state;

/** Reads one spring as the next step finds it. RHEO_ERROR_ARGUMENT if a and b are not connected. */
RHEO_API rheo_result rheo_world_spring(const rheo_world *world, uint32_t a, uint32_t b, rheo_spring_state *state,
                                       rheo_error *error);

/* ---- History ---- */

/** Window d in steps; 0 without history and for kind full, which has no window. */
RHEO_API uint32_t rheo_world_history_window(const rheo_world *world);
/** Lag in steps: the newest velocities that do not count yet; 0 without history. */
RHEO_API uint32_t rheo_world_history_lag(const rheo_world *world);
/** Number of stored past velocities, at most lag + d + 1. Kinds full and tempered: at most lag + 1. */
RHEO_API uint32_t rheo_world_history_rows(const rheo_world *world);
/**
 * Bytes of the history: 12 (float) x particles for each row of the ring and of the modes that is allocated. The ring has
 * lag + d + 1 rows, with history.of length one more; for kinds full and tempered lag + 2, and none without a lag. If
 * these are more than 256, it begins with as many and grows as they are filled.
 */
RHEO_API size_t rheo_world_history_bytes(const rheo_world *world);
/**
 * Reads the stored velocities of a particle: history_rows x 3 values, newest first, unit L/T. With history.of length
 * they are mean velocities between stored positions. RHEO_ERROR_ARGUMENT if there is no such particle or no history.
 */
RHEO_API rheo_result rheo_world_particle_history(const rheo_world *world, uint32_t id, rheo_real *velocity);
/** Reads the velocity differences v_a - v_b of a pair, as rheo_world_particle_history() does. */
RHEO_API rheo_result rheo_world_spring_history(const rheo_world *world, uint32_t a, uint32_t b,
                                               rheo_real *difference);

/**
 * A mode: a decaying sum y over the velocities before the newest that counts, y <- y - decay y + v. Velocities that
 * leave a window are subtracted.
 */
typedef struct rheo_mode_state {
    /** Fraction of the sum that a step removes. */
    double decay;
    /** Weight w in D^q x = C0 (v + sum of w y), v the newest velocity that counts. */
    double weight;
    /** The sum y. Unit L/T. */
    double sum[3];
} rheo_mode_state;

/** Number of modes (history.kind window-fast, full or tempered), at most RHEO_HISTORY_MAX_MODES; else 0. */
RHEO_API uint32_t rheo_world_history_modes(const rheo_world *world);
/** Reads the modes of a particle, slowest first. RHEO_ERROR_ARGUMENT if there is no such particle or no modes. */
RHEO_API rheo_result rheo_world_particle_modes(const rheo_world *world, uint32_t id, rheo_mode_state *modes);
/** Reads the modes of a pair, those of the velocity differences v_a - v_b, as rheo_world_particle_modes() does. */
RHEO_API rheo_result rheo_world_spring_modes(const rheo_world *world, uint32_t a, uint32_t b, rheo_mode_state *modes);

/* ---- Computed from the present state, between steps or stages; the world does not change ---- */

/** State of a particle. Members that the model does not have are 0; rheo_world_quantity() lists those that it has. */
typedef struct rheo_particle_state {
    /** Position. Unit L. */
    double position[3];
    /** Velocity. Unit L/T. */
    double velocity[3];
    /** |velocity|. Unit L/T. */
    double speed;
    /** Thickening: rho, sum over the neighbours of (1 - r/h)^2. Melting: rho of the state, unit M/L^3. */
    double density;
    /**
     * Thickening: k (rho - rho0), unit L/T^2, without the limit of fluid.cohesion and the share of the ball; 0 in
     * scheme positions. Melting: c^2 (rho - rho0), unit M/(L T^2).
     */
    double pressure;
    /** Number of particles closer than the support. */
    uint32_t neighbours;
    /** Thickening only: its material, 0 for the main one. */
    uint32_t material;

    /** Thickening only: rho_near, sum over the neighbours of (1 - r/h)^3. */
    double near_density;
    /** Thickening only: k_near rho_near. Unit L/T^2; 0 in scheme positions. */
    double near_pressure;
    /** Thickening only: D^q x from the present history. Unit L/T^q; 0 without history, and with history.of length. */
    double derivative[3];
    /** Thickening only: number of springs that end here. */
    uint32_t springs;
    /** Thickening only: largest K of these springs, from the present history. Unit 1/T^2; 0 without springs. */
    double stiffness;
    /** Thickening only: largest kappa of these springs, as in rheo_spring_state. */
    double kappa;

    /** Melting only: sum of m W over neighbours, the particle itself and walls. Unit M/L^3. */
    double summed_density;
    /** Melting only: temperature, or melting.temperature in an isothermal world. Unit K. */
    double temperature;
    /** Melting only: jump number J of that temperature. */
    double jump_number;
    /** Melting only: intensity of D, from the present velocities. Unit 1/T. */
    double shear_rate;
    /** Melting only: apparent viscosity at that shear rate. Unit M/(L T). */
    double viscosity;
    /** Melting only: position at which the particle began. Unit L. */
    double start_position[3];
    /** Melting only: |position - start_position|. Unit L. */
    double displacement;
} rheo_particle_state;

/** Reads one particle. RHEO_ERROR_ARGUMENT if there is no such particle, RHEO_ERROR_MEMORY. */
RHEO_API rheo_result rheo_world_particle(const rheo_world *world, uint32_t id, rheo_particle_state *state,
                                         rheo_error *error);

/**
 * Reads all particles, in the order of ids: rheo_world_particle_count() states with the bits of rheo_world_particle().
 * RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_world_particles(const rheo_world *world, rheo_particle_state *states, rheo_error *error);

/** A quantity of particles: a member of rheo_particle_state of type double or double[3]. */
typedef struct rheo_quantity {
    /** Name of the member. */
    const char *name;
    /** Unit in L, T, M, K; "1" for a pure number. */
    const char *unit;
    /** Meaning, one line. */
    const char *meaning;
    /** Number of doubles: 1 or 3. */
    uint32_t components;
    /** Offset of the first in rheo_particle_state. Unit bytes. */
    size_t offset;
} rheo_quantity;

/** Quantity of the particles of a world, by index; NULL past the last. The model decides which there are. */
RHEO_API const rheo_quantity *rheo_world_quantity(const rheo_world *world, uint32_t index);

/**
 * Lists the particles closer than the support to one, in ascending order of ids, with their distances. Writes at most
 * `capacity` of them to ids and distances, either of which may be NULL, and sets *count to the number of all.
 * RHEO_ERROR_ARGUMENT if there is no such particle.
 */
RHEO_API rheo_result rheo_world_neighbours(const rheo_world *world, uint32_t id, uint32_t *ids, double *distances,
                                           size_t capacity, size_t *count, rheo_error *error);

/** Weight of a neighbour at a distance >= 0, unit L: 1 - r/h (thickening) or W(r), unit 1/L^3 (melting). */
RHEO_API double rheo_world_weight(const rheo_world *world, double distance);
/** Symbol and unit of that weight: "1 - r/h", "W, 1/L^3"; NULL if the model has no weight. */
RHEO_API const char *rheo_world_weight_name(const rheo_world *world);

/**
 * Computes the sums over neighbours of all particles, in the order of ids: rho and rho_near (thickening), or the
 * summed density and 0 (melting). Either array may be NULL. RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_world_densities(const rheo_world *world, double *density, double *near_density,
                                          rheo_error *error);

/** Ranking criterion of rheo_world_top(). */
typedef enum rheo_top {
    /** Particles by speed. Unit L/T. */
    RHEO_TOP_FASTEST,
    /** Particles by rheo_particle_state.density. */
    RHEO_TOP_DENSEST,
    /** Springs by kappa; thickening only. */
    RHEO_TOP_STIFFEST,
    /** Particles by temperature, unit K; none in a world without a field of temperature. */
    RHEO_TOP_HOTTEST,
    /** Particles by distance from where they began, unit L; melting only. */
    RHEO_TOP_FURTHEST,
} rheo_top;

/** A ranking that a model has. */
typedef struct rheo_ranking {
    /** The criterion. */
    rheo_top top;
    /** Name, e.g. "densest". */
    const char *name;
    /** Name of the value, e.g. "density". */
    const char *value;
    /** Unit of the value. */
    const char *unit;
    /** Meaning of the value, one line. */
    const char *meaning;
} rheo_ranking;

/** Ranking by index; NULL past the last. The model decides which there are. */
RHEO_API const rheo_ranking *rheo_world_ranking(const rheo_world *world, uint32_t index);

/** An entry of a ranking. */
typedef struct rheo_top_entry {
    /** Particle, or smaller id of a spring. */
    uint32_t id;
    /** Larger id of a spring; else 0. */
    uint32_t other_id;
    /** Its value, in the unit of the ranking. */
    double value;
} rheo_top_entry;

/**
 * Writes the `capacity` largest values, in descending order; NaN first, equal values by ascending id. *count becomes
 * the number written. Rankings that the model does not have are empty. RHEO_ERROR_ARGUMENT for an unknown ranking,
 * RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_world_top(const rheo_world *world, rheo_top top, size_t capacity, rheo_top_entry *entries,
                                    size_t *count, rheo_error *error);

/* ---- Numbers that follow from a definition ---- */

/** A number that characterises a definition, such as the stiffness number kappa. */
typedef struct rheo_derived {
    /** Name, e.g. "kappa". */
    const char *name;
    /** Unit in L, T, M; "1" for a pure number. */
    const char *unit;
    /** Formula and, where known, the useful range; one line. */
    const char *meaning;
    /** NaN if it is not defined for these parameters. */
    double value;
} rheo_derived;

/**
 * Computes a derived number of a valid definition, by index. False past the last. The model decides which there are.
 */
RHEO_API bool rheo_world_def_derived(const rheo_world_def *def, uint32_t index, rheo_derived *derived);

/* ---- Bodies and vibrators ---- */

/** A rigid body: the ball. */
typedef struct rheo_body {
    /** Position of the centre. Unit L. */
    double position[3];
    /** Velocity. Unit L/T. */
    double velocity[3];
    /** Angular velocity. Unit 1/T. */
    double spin[3];
    /** Orientation, a unit quaternion w, x, y, z. */
    double orientation[4];
    /** Radius. Unit L. */
    double radius;
    /** Mass. Unit: the mass of a particle. */
    double mass;
} rheo_body;

/** Number of bodies, which are the balls. */
RHEO_API uint32_t rheo_world_body_count(const rheo_world *world);
/** Reads a body. RHEO_ERROR_ARGUMENT if there is no such body. */
RHEO_API rheo_result rheo_world_body(const rheo_world *world, uint32_t index, rheo_body *body);

/** A vibrator. */
typedef struct rheo_vibrator {
    /** Horizontal position along x. Unit L. */
    double x;
    /** Horizontal position along z. Unit L. */
    double z;
    /** Phase of the oscillation. Unit: turns. Range 0 to 1. */
    double phase;
    /** Present frequency. Unit 1/T. */
    double frequency;
} rheo_vibrator;

/** Number of vibrators. */
RHEO_API uint32_t rheo_world_vibrator_count(const rheo_world *world);
/** Reads a vibrator. RHEO_ERROR_ARGUMENT if there is no such vibrator. */
RHEO_API rheo_result rheo_world_vibrator(const rheo_world *world, uint32_t index, rheo_vibrator *vibrator);

/* ---- Obstacles ---- */

/** Where an obstacle is, and how it moves. */
typedef struct rheo_obstacle_state {
    /** Shape. */
    rheo_obstacle_shape shape;
    /** Whether the fluid is inside. */
    bool inside;
    /** Centre. Unit L. */
    double position[3];
    /** Orientation, a unit quaternion w, x, y, z: turns the shape as the definition gives it. */
    double rotation[4];
    /** Phase of the oscillation. Unit: turns. Range 0 to 1. */
    double phase;
    /** Velocity of the centre, with that of the oscillation. Unit L/T. */
    double velocity[3];
    /** Angular velocity. Unit 1/T. */
    double spin[3];
} rheo_obstacle_state;

/** Number of obstacles. */
RHEO_API uint32_t rheo_world_obstacle_count(const rheo_world *world);
/** Reads an obstacle. RHEO_ERROR_ARGUMENT if there is no such obstacle. */
RHEO_API rheo_result rheo_world_obstacle(const rheo_world *world, uint32_t index, rheo_obstacle_state *state);
/**
 * Distance of a point from the surface of an obstacle, unit L: above 0 where the fluid is. normal: unit vector along which
 * it grows, out of the solid; may be NULL. NaN if there is no such obstacle.
 */
RHEO_API double rheo_world_obstacle_distance(const rheo_world *world, uint32_t index, const double point[3],
                                             double normal[3]);

/* ---- Plates ---- */

/** The plates of a world that has plates. */
enum {
    /** The lower plate, which rests. */
    RHEO_PLATE_LOWER = 0,
    /** The upper plate, which moves. */
    RHEO_PLATE_UPPER = 1
};

/** State of a plate. */
typedef struct rheo_plate {
    /** Number of its particles, each of mass 1. */
    uint32_t particles;
    /** Displacement since the world was made. Unit L. 0 for the lower plate. */
    double displacement[3];
    /** Velocity. Unit L/T. */
    double velocity[3];
    /**
     * Mean force on the plate in the last step, by the fluid and by gravity: the momentum that the step gave to its
     * particles before the plate took it, divided by the step. Unit M L/T^2. NaN before the first step that this
     * world has made.
     */
    double force[3];
} rheo_plate;

/** Reads a plate. False: the world has no such plate. */
RHEO_API bool rheo_world_plate(const rheo_world *world, uint32_t plate, rheo_plate *values);

/* ---- Fields: the state, as it is hashed and saved ---- */

/** Type of the values of a field. */
typedef enum rheo_element {
    /** float */
    RHEO_ELEMENT_F32,
    /** double */
    RHEO_ELEMENT_F64,
    /** uint32_t */
    RHEO_ELEMENT_U32,
    /** uint64_t */
    RHEO_ELEMENT_U64
} rheo_element;

/** A field of the state. */
typedef struct rheo_field_info {
    /** Name. */
    const char *name;
    /** Type of the values. */
    rheo_element element;
    /** Kind of object that an item belongs to. */
    rheo_location location;
    /** Values per item. */
    uint32_t components;
    /** Several rows of items: lags of a history, newest first, or modes. */
    bool ring;
    /** Filled rows; 1 for fields without rows. */
    uint64_t rows;
    /** Items per row: particles, springs, ... */
    uint64_t items;
    /** rows x items x components x size of an element. */
    uint64_t bytes;
} rheo_field_info;

/** Number of fields of a world. */
RHEO_API uint32_t rheo_world_field_count(const rheo_world *world);
/** Describes a field. RHEO_ERROR_ARGUMENT if there is no such field. */
RHEO_API rheo_result rheo_world_field(const rheo_world *world, uint32_t index, rheo_field_info *info);
/**
 * Copies all values of a field, in the order of ids (springs by a, then b) and in the byte order of the machine.
 * bytes: size of `values`. RHEO_ERROR_ARGUMENT if it is too small or there is no such field, RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_world_field_read(const rheo_world *world, uint32_t index, void *values, size_t bytes);

/* ---- Stages, times, metrics ---- */

/** A stage of the step. */
typedef struct rheo_stage_info {
    /** Name. */
    const char *name;
    /** Runs since creation or rheo_world_reset_times(). */
    uint64_t calls;
    /** Wall time of these runs. Unit s. */
    double seconds;
    /** Runs in every substep of a step, so that its runs have numbers: "forces@2". */
    bool in_substeps;
} rheo_stage_info;

/** Number of stages in the list of a world. */
RHEO_API uint32_t rheo_world_stage_count(const rheo_world *world);
/** Describes a stage. RHEO_ERROR_ARGUMENT if there is no such stage. */
RHEO_API rheo_result rheo_world_stage(const rheo_world *world, uint32_t index, rheo_stage_info *info);
/** Sets runs and wall times of all stages to 0. */
RHEO_API void rheo_world_reset_times(rheo_world *world);

/** Mean number of neighbours within the support in the last step; 0 before the first. */
RHEO_API double rheo_world_mean_neighbours(const rheo_world *world);

/** A metric: a number about the state or the last step, measured at every step. */
typedef struct rheo_metric_info {
    /** Name of its column in recordings. */
    const char *name;
    /** Unit in L, T, M, K; "1" for pure numbers and ids; or the length or density that it is a multiple of. */
    const char *unit;
    /** Meaning in one line. Ids of particles are -1 where there is none. */
    const char *meaning;
} rheo_metric_info;

/** Number of metrics of a world. The model, and whether there is a ball, decide which they are. */
RHEO_API uint32_t rheo_world_metric_count(const rheo_world *world);
/** Describes a metric; NULL past the last. */
RHEO_API const rheo_metric_info *rheo_world_metric_info(const rheo_world *world, uint32_t index);
/** Name of a metric; NULL past the last. */
RHEO_API const char *rheo_world_metric_name(const rheo_world *world, uint32_t index);
/** Value of a metric in the last step; 0 past the last metric. */
RHEO_API double rheo_world_metric(const rheo_world *world, uint32_t index);

#ifdef __cplusplus
}
#endif
#endif
