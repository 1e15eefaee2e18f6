/*
 * Worlds: a definition, fixed steps, read-only access to the state, and commands that change it between steps.
 *
 * Any consistent set of units serves; SI names are given for orientation. L is the unit of length, T of time. Every
 * fluid particle has mass 1. Y is up. Particles keep the id they were made with (0, 1, ...); everything that is seen
 * from outside stands in the order of ids.
 *
 * Two models, which a world has one of:
 *
 *   thickening   Ozgen, Kallmann, Brown, "An SPH model to simulate the dynamic behavior of shear thickening fluids",
 *                on top of Clavet, Beaudoin, Poulin, "Particle-based viscoelastic fluid simulation" (2005). "The
 *                paper" where nothing else is said. docs/model.md gives every equation.
 *   melting      Paiva, Petronetto, Lewiner, Tavares, "Particle-based non-Newtonian fluid animation for melting
 *                objects" (2006): viscoplastic solids that melt. docs/melting.md gives every equation. A particle's
 *                mass is rest density x spacing^3 there.
 */
#ifndef RHEOLOG_WORLD_H
#define RHEOLOG_WORLD_H

#include "rheolog/base.h"
#include "rheolog/history.h"

#ifdef __cplusplus
extern "C" {
#endif

#define RHEO_MAX_WALLS 64
#define RHEO_MAX_VIBRATORS 1024

typedef enum rheo_model { RHEO_MODEL_THICKENING = 0, RHEO_MODEL_MELTING = 1 } rheo_model;

/** The rest length of a spring when it is made. */
typedef enum rheo_rest_length {
    RHEO_REST_DISTANCE = 0, /**< the distance at which the pair met; the default */
    RHEO_REST_SUPPORT = 1,  /**< the support, as Clavet et al. have it */
} rheo_rest_length;

/** How a spring's force becomes a displacement; kappa = step^2 (k_min + k_hist |D^q|). */
typedef enum rheo_spring_solver {
    RHEO_SOLVER_EXPLICIT = 0, /**< kappa (r - L), the paper's; unstable for large kappa; the default */
    RHEO_SOLVER_IMPLICIT = 1, /**< kappa/(1 + kappa) (r - L): softer per step, stable at any stiffness */
} rheo_spring_solver;

/** What a vibrating vibrator does. */
typedef enum rheo_vibrator_kind {
    RHEO_VIBRATOR_FLOOR = 0, /**< raises the floor by amplitude (1 - rho^2)^2 sin(phase), rho = distance/radius */
    RHEO_VIBRATOR_FORCE = 1, /**< pushes what is below `height`: dv_y = step a (2 pi f)^2 (1 - rho^2) sin(phase) */
} rheo_vibrator_kind;

/* ---- Choices of the melting model ---- */

/** What the apparent viscosity depends on. */
typedef enum rheo_rheology {
    RHEO_RHEOLOGY_JUMP = 0,      /**< on the shear rate and the jump number, Eq. 3 of Paiva et al.; the default */
    RHEO_RHEOLOGY_NEWTONIAN = 1, /**< on nothing: it is melting.viscosity */
} rheo_rheology;

typedef enum rheo_stress {
    RHEO_STRESS_PAIRWISE = 0, /**< between pairs, along their line: keeps angular momentum; the default */
    RHEO_STRESS_NESTED = 1,   /**< D, S = eta D, div S one after the other, as Paiva et al. have it */
} rheo_stress;

typedef enum rheo_viscosity_solver {
    RHEO_VISCOSITY_IMPLICIT = 0, /**< conjugate gradients: stable at any viscosity; the default */
    RHEO_VISCOSITY_EXPLICIT = 1, /**< substeps are then as small as the largest viscosity asks for */
} rheo_viscosity_solver;

typedef enum rheo_density_scheme {
    RHEO_DENSITY_CONTINUITY = 0, /**< density is integrated, Eq. 6; the default */
    RHEO_DENSITY_SUMMATION = 1,  /**< density is the sum of m W: wrong at free surfaces */
} rheo_density_scheme;

typedef enum rheo_laplacian {
    RHEO_LAPLACIAN_FIRST = 0,  /**< of the temperature, from first derivatives of the kernel; the default */
    RHEO_LAPLACIAN_SECOND = 1, /**< from second derivatives, which change sign */
} rheo_laplacian;

/** Frozen: positions and velocities stay, heat alone flows; none of the stages of motion is there. */
typedef enum rheo_flow { RHEO_FLOW_ON = 0, RHEO_FLOW_FROZEN = 1 } rheo_flow;

/** What fluid does along a wall. */
typedef enum rheo_wall_slip { RHEO_WALL_NO_SLIP = 0, RHEO_WALL_FREE_SLIP = 1 } rheo_wall_slip;

/** Whether something is done as the paper of the melting model prints it, slip and all; off is the default. */
typedef enum rheo_as_printed { RHEO_AS_PRINTED_OFF = 0, RHEO_AS_PRINTED_ON = 1 } rheo_as_printed;

/** A plane wall; the fluid is on the side that the normal points to. */
typedef struct rheo_wall {
    double point[3];  /**< any point of the plane, L */
    double normal[3]; /**< made a unit vector; not zero */
} rheo_wall;

/**
 * Everything a world is made from. Fill it by rheo_default_world_def() and change what differs. The paths in
 * brackets are the names that rheo_world_def_set(), scene files and --set use.
 */
typedef struct rheo_world_def {
    rheo_model model;  /**< fluid (but for spacing), springs, history, ball and vibrators are of thickening alone */
    double step;       /**< fixed time step, T; >= 1e-12; default 0.033, of melting 0.02 [step] */
    double gravity[3]; /**< L/T^2; default 0, -9.81, 0, of melting 0, -1, 0 [gravity] */

    struct {
        double support;             /**< radius h within which particles are neighbours, L; >= 1e-12; 4 */
        double spacing;             /**< distance of particles at rest, L; >= 1e-12; 2, of melting 0.045 */
        double stiffness;           /**< k of the pressure k (rho - rho0), L/T^2; >= 0; 300 */
        double near_stiffness;      /**< k_near of the near pressure, L/T^2; >= 0; 500 */
        double rest_density;        /**< rho0, the sum of (1 - r/h)^2 over neighbours at rest; >= 0; 2.6 */
        double linear_viscosity;    /**< sigma, 1/T; >= 0; 0.5 */
        double quadratic_viscosity; /**< beta, 1/L; >= 0; 0.1 */
        double number_density;      /**< particles per volume, gives the ball its mass, 1/L^3; 0: 1/spacing^3 */
    } fluid;

    struct {
        double stiffness;   /**< k_min, 1/T^2; >= 0; 15. 0: a fluid without springs */
        double plasticity;  /**< alpha, rate at which rest lengths flow, 1/T; >= 0; 4 */
        double yield_ratio; /**< gamma: strain below which they do not; >= 0; 0.03 */
        rheo_rest_length rest_length;
        rheo_spring_solver solver;
    } springs;

    struct {
        rheo_history_kind kind; /**< what is remembered, and how; the exact window [history.kind] */
        double stiffness;       /**< k_hist of Eq. 6, 1/(T^2 L/T^q); >= 0; 150. 0: no history, no byte of it */
        double order;           /**< q, order of the fractional derivative; 0 < q < 1; 0.5 */
        uint32_t window;        /**< d: lags 0..d count, steps; 1..1000000; 150. Of no account for kind full */
        double window_seconds;  /**< > 0: the window in time instead, rounded to steps at creation; default 0 */
        rheo_weights weights;   /**< the paper's, or those of the L1 scheme */
    } history;

    struct {
        double sticking;                 /**< c_b, how strongly stiff fluid sticks to walls; >= 0; 1 */
        uint32_t count;                  /**< walls given; default 0 */
        rheo_wall plane[RHEO_MAX_WALLS]; /**< treated in this order */
    } walls;

    struct {
        double radius;        /**< R, L; 0 or >= 1e-12; default 0: no ball */
        double density_ratio; /**< mass = ratio x volume x particles per volume; >= 1e-6; 2 */
        double position[3];   /**< centre at step 0, L */
        double velocity[3];   /**< at step 0, L/T */
        double spin[3];       /**< angular velocity at step 0, 1/T */
        double friction;      /**< mu, share of the sliding that a contact stops, 0..1; 0.5 */
    } ball;

    struct {
        rheo_vibrator_kind kind;
        double amplitude; /**< a, a length, L; >= 0; 0.3 */
        double frequency; /**< f0, 1/T; >= 1e-12; 5 */
        double spread;    /**< f walks at random inside f0 (1 +- spread); 0..1; 0.5 */
        double wander;    /**< largest change of f in a step, as a part of f0; 0..1; 0.05 */
        double radius;    /**< L; >= 1e-12; 2 */
        double height;    /**< RHEO_VIBRATOR_FORCE: what is lower than this is pushed, y, L; 0 */
        uint64_t seed;    /**< of the random walk and the first phases; below 2^53; 1 */
        uint32_t count;   /**< vibrators given; default 0: none */
        double position[RHEO_MAX_VIBRATORS][2]; /**< x and z, L */
    } vibrators;

    /** The melting model, in the terms of its paper. M is the unit of mass, K of temperature. */
    struct {
        double smoothing_length; /**< h; the support of the kernel is 3 h, L; >= 0; default 0: the spacing */
        double rest_density;     /**< rho0, M/L^3; >= 1e-12; 1 */
        double sound_speed; /**< c of p = c^2 (rho - rho0), L/T; >= 1e-12; 10: ten times what anything moves at */
        rheo_rheology rheology;
        double viscosity;       /**< mu, dynamic viscosity, M/(L T); >= 0; 0.05 */
        double time_scale;      /**< t0: eta = mu eta*(D t0), yield stress mu/t0, T; >= 1e-12; 0.05 */
        double power_law_index; /**< n of the power law; 0..2; 0.5 */
        double jump_number_min, jump_number_max; /**< J of what is molten, of what is solid; 0..1e9; 0 and 2000 */
        double temperature_min, temperature_max; /**< where melting begins and ends, K; 0.45 and 0.55 */
        double temperature;                      /**< of particles that are given none, K; 0 */
        double diffusivity;                      /**< k of dT/dt = k lap T, L^2/T; >= 0; 0.001. 0: no heat flows */
        double alpha, beta;                      /**< artificial viscosity: bulk, von Neumann-Richtmyer; >= 0; 0.1 */
        double xsph;           /**< epsilon, how far particles move with their neighbours; 0..1; 0.5 */
        double repulsion;      /**< against clumping, in c^2/spacing; >= 0; 0.05 */
        double courant_number; /**< substep in h/(c + |v|max); 1e-6..10; 0.4 */
        uint64_t substeps;     /**< in a step; 0: as many as the state asks for; 0 */
        uint64_t max_substeps; /**< a step that asks for more is refused; 1..200000; 20000 */
        rheo_stress stress;
        rheo_viscosity_solver solver;
        double tolerance;        /**< of the solver: residual against what a substep changes; 1e-12..1; 0.001 */
        uint64_t max_iterations; /**< of the solver in a substep; 1..1e6; 100 */
        rheo_density_scheme density;
        rheo_laplacian laplacian;
        rheo_flow flow;
        rheo_wall_slip wall;
    } melting;

    /** What is as printed by Paiva et al. (docs/melting.md has the measured differences) [paper.kernel, ...]. */
    struct {
        rheo_as_printed kernel;               /**< 3/(359 pi h^3) for 1/(120 pi h^3) */
        rheo_as_printed jump;                 /**< J(T) = (1-u) Jmax - u Jmin, u not held in 0..1 */
        rheo_as_printed artificial_viscosity; /**< Eq. 8 with another 1/rho_i, sums from j = i on */
        rheo_as_printed courant;              /**< Eq. 10: 0.1 min(h/(|v| + c^2), h^2/(6 eta)) */
        rheo_as_printed xsph;                 /**< Eq. 9 changes the velocities themselves */
        rheo_as_printed heat;                 /**< the weight 4 m_j rho_i/(rho_j (rho_i + rho_j)) */
        rheo_as_printed leapfrog;             /**< Algorithm 1: all rates from the state that a substep begins with */
    } paper;

    /** Their order gives the ids and is a part of the definition: in another order it is another scene. */
    struct {
        uint32_t count;                      /**< particles; 0 is a valid world */
        const rheo_real *position;           /**< count x 3, L, finite; copied */
        const rheo_real *velocity;           /**< count x 3, L/T, finite; NULL: at rest; copied */
        const rheo_real *density;            /**< melting: count, M/L^3, > 0; NULL: the rest density; copied */
        const rheo_real *temperature;        /**< melting: count, K, finite; NULL: an isothermal world; copied */
        uint32_t spring_count;               /**< springs that exist at step 0 */
        const uint32_t *spring_ends;         /**< spring_count x 2 ids, smaller first, ascending */
        const rheo_real *spring_rest_length; /**< spring_count, L, >= 0 */
    } particles;

    rheo_allocator allocator;
    rheo_log log;
    uint32_t cookie; /**< set by rheo_default_world_def(); says that the defaults are in place */
} rheo_world_def;

/** Parameter set P of docs/model.md, no particles, no walls, no ball, no vibrators. */
RHEO_API rheo_world_def rheo_default_world_def(void);
/** The same for a model. */
RHEO_API rheo_world_def rheo_default_model_def(rheo_model model);
/** Number of models; a rheo_model is below it. */
RHEO_API uint32_t rheo_model_count(void);
/** Name of a model, as in scene files: "thickening", "melting". NULL past the last model. */
RHEO_API const char *rheo_model_name(rheo_model model);

/** Says what is wrong with a definition and what would be right; RHEO_OK if nothing is. */
RHEO_API rheo_result rheo_world_def_check(const rheo_world_def *def, rheo_error *error);

/* ---- Parameters by name: one table serves --set, scene files, recordings and commands ---- */

typedef enum rheo_parameter_type {
    RHEO_PARAMETER_REAL,
    RHEO_PARAMETER_INTEGER,
    /** Three reals, written [x, y, z]. */
    RHEO_PARAMETER_VECTOR,
    /** One of the words in `choices`. */
    RHEO_PARAMETER_CHOICE,
    /** Steps, or seconds written "2.5 s". */
    RHEO_PARAMETER_WINDOW,
} rheo_parameter_type;

typedef struct rheo_parameter {
    /** Name, e.g. "fluid.support". */
    const char *path;
    /** Unit, e.g. "L/T^2"; "1" for a pure number. */
    const char *unit;
    /** Meaning, one line. */
    const char *about;
    /** RHEO_PARAMETER_CHOICE: choice_count words, indexed by their enumerators; else NULL. */
    const char *const *choices;
    uint32_t choice_count;
    /** Range; -1e30 and 1e30 mean that there is no bound. */
    double minimum, maximum;
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
/** The path that is nearest to a misspelt one; never NULL. */
RHEO_API const char *rheo_parameter_nearest(const char *path);
/** Writes the words of a choice with a blank between, "" for other types. Returns `text`, which holds >= 256 bytes. */
RHEO_API const char *rheo_parameter_words(const rheo_parameter *parameter, char *text, size_t size);
/** The present name of a parameter, or of a group of a scene file, that an earlier version called `path`; else NULL. */
RHEO_API const char *rheo_parameter_new_name(const char *path);

/**
 * Sets one parameter from text: "0.5", "150", "2.5 s", "[0, -9.81, 0]", "implicit". Reads the same in every locale.
 * RHEO_ERROR_ARGUMENT for an unknown path (names the nearest) or a value that is no such thing or out of range.
 */
RHEO_API rheo_result rheo_world_def_set(rheo_world_def *def, const char *path, const char *value, rheo_error *error);
/** Writes a parameter as text that rheo_world_def_set() reads back to the same bits. `value` holds >= 96 bytes. */
RHEO_API rheo_result rheo_world_def_get(const rheo_world_def *def, const char *path, char *value, size_t size);

/* ---- Worlds ---- */

typedef struct rheo_world rheo_world;

/** The kind of object that a field has one value for. */
typedef enum rheo_location {
    RHEO_LOCATION_WORLD,
    RHEO_LOCATION_PARTICLE,
    RHEO_LOCATION_SPRING,
    RHEO_LOCATION_BODY,
    RHEO_LOCATION_VIBRATOR
} rheo_location;

/** "world", "particle", "spring", "body" or "vibrator"; "item" for any other value. */
RHEO_API const char *rheo_item_name(rheo_location location);

/**
 * Makes a world at step 0 from a definition, whose arrays it copies. The world gets only the stages, fields and
 * memory that the definition needs: those of history, springs, viscosity, ball, walls or vibrators only if present.
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
    rheo_failure_reason reason;
    /** RHEO_FAILURE_SUBSTEPS_...: substeps that the step requires; may be infinite. Else 0. */
    double required;
    /** RHEO_FAILURE_SUBSTEPS_...: melting.max_substeps. Else 0. */
    double limit;
} rheo_failure;

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

/** The definition in force, with all changes by commands. Its particles are empty; its window is in steps. */
RHEO_API const rheo_world_def *rheo_world_definition(const rheo_world *world);

/** Number of steps made. */
RHEO_API uint64_t rheo_world_step_count(const rheo_world *world);
/** Time of the state. Unit T. */
RHEO_API double rheo_world_time(const rheo_world *world);

/** Hash of the whole state: all fields, rings and springs. Equal states have equal hashes on any machine. */
RHEO_API uint64_t rheo_world_hash(const rheo_world *world);

/*
 * ---- Commands: change a world between steps; a recorder records them, a replay applies them ----
 *
 * On any error the world is unchanged. All return RHEO_ERROR_ARGUMENT in the middle of a step, RHEO_ERROR_ENVIRONMENT
 * like rheo_world_step(), or RHEO_ERROR_MEMORY.
 */

/**
 * Applies an impulse to the ball. impulse: unit M L/T, where a particle has mass 1. point: where it acts, unit L;
 * NULL: at the centre. RHEO_ERROR_ARGUMENT if there is no such body or the resulting speed exceeds 1e30.
 */
RHEO_API rheo_result rheo_world_push_body(rheo_world *world, uint32_t body, const double impulse[3],
                                          const double point[3], rheo_error *error);
/**
 * Changes a live parameter. ball.position, ball.velocity and ball.spin set the state. RHEO_ERROR_ARGUMENT if the
 * parameter is unknown, not live, or out of range; if its stages are missing because it was 0 at creation (say
 * history.stiffness); or if it is history.weights (kinds full and tempered) or history.order (kind tempered).
 */
RHEO_API rheo_result rheo_world_set(rheo_world *world, const char *path, const char *value, rheo_error *error);
/**
 * Adds particles, whose ids follow the existing ones. position: count x 3, unit L. velocity: count x 3, unit L/T;
 * NULL: at rest. History assumes that they have been at rest. RHEO_ERROR_ARGUMENT if a value is not finite.
 */
RHEO_API rheo_result rheo_world_add_particles(rheo_world *world, uint32_t count, const rheo_real *position,
                                              const rheo_real *velocity, rheo_error *error);
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

/* ---- Springs ---- */

typedef struct rheo_spring {
    /** Ids of the ends, a < b. */
    uint32_t a, b;
    /** Rest length. Unit L. */
    rheo_real rest_length;
} rheo_spring;

/** Number of springs. */
RHEO_API size_t rheo_world_spring_count(const rheo_world *world);
/** Copies up to `capacity` springs, ascending by a, then b. RHEO_ERROR_MEMORY if there is none to sort them. */
RHEO_API rheo_result rheo_world_springs(const rheo_world *world, rheo_spring *springs, size_t capacity);

typedef struct rheo_spring_state {
    rheo_spring spring;
    /** Distance of the ends. Unit L. */
    double length;
    /** |D^q (x_a - x_b)| from the present history. Unit L/T^q; 0 without history. */
    double history_rate;
    /** K = k_min + k_hist history_rate. Unit 1/T^2. */
    double stiffness;
    /** step^2 K: fraction of its extension that the explicit solver removes per step. */
    double kappa;
} rheo_spring_state;

/** Reads one spring as the next step finds it. RHEO_ERROR_ARGUMENT if a and b are not connected. */
RHEO_API rheo_result rheo_world_spring(const rheo_world *world, uint32_t a, uint32_t b, rheo_spring_state *state,
                                       rheo_error *error);

/* ---- History ---- */

/** Window d in steps; 0 without history and for kind full, which has no window. */
RHEO_API uint32_t rheo_world_history_window(const rheo_world *world);
/** Number of stored past velocities, at most d + 1. Kinds full and tempered store only the newest. */
RHEO_API uint32_t rheo_world_history_rows(const rheo_world *world);
/** Bytes of the history: 12 (float) x particles for each row of the ring, d + 1, and of the modes. */
RHEO_API size_t rheo_world_history_bytes(const rheo_world *world);
/**
 * Reads the stored velocities of a particle: history_rows x 3 values, newest first, unit L/T. RHEO_ERROR_ARGUMENT if
 * there is no such particle or no history.
 */
RHEO_API rheo_result rheo_world_particle_history(const rheo_world *world, uint32_t id, rheo_real *velocity);
/** Reads the velocity differences v_a - v_b of a pair, as rheo_world_particle_history() does. */
RHEO_API rheo_result rheo_world_spring_history(const rheo_world *world, uint32_t a, uint32_t b,
                                               rheo_real *difference);

/**
 * A mode: a decaying sum y over the velocities before the newest, y <- y - decay y + v. Velocities that leave a
 * window are subtracted.
 */
typedef struct rheo_mode_state {
    /** Fraction of the sum that a step removes. */
    double decay;
    /** Weight w in D^q x = C0 (v + sum of w y). */
    double weight;
    /** The sum y. Unit L/T. */
    double sum[3];
} rheo_mode_state;

/** Number of modes (history.kind window-fast, full or tempered), at most RHEO_HISTORY_MAX_MODES; else 0. */
RHEO_API uint32_t rheo_world_history_modes(const rheo_world *world);
/** Reads the modes of a particle, slowest first. RHEO_ERROR_ARGUMENT if there is no such particle or no modes. */
RHEO_API rheo_result rheo_world_particle_modes(const rheo_world *world, uint32_t id, rheo_mode_state *modes);
/** Reads the modes of a pair: those of the velocity differences v_a - v_b. */
RHEO_API rheo_result rheo_world_spring_modes(const rheo_world *world, uint32_t a, uint32_t b, rheo_mode_state *modes);

/* ---- Computed from the present state, between steps or stages; the world does not change ---- */

/** State of a particle. Members that the model does not have are 0; rheo_world_quantity() lists those that it has. */
typedef struct rheo_particle_state {
    /** Unit L and L/T. */
    double position[3], velocity[3];
    /** |velocity|. Unit L/T. */
    double speed;
    /** Thickening: rho, sum over the neighbours of (1 - r/h)^2. Melting: rho of the state, unit M/L^3. */
    double density;
    /** Thickening: k (rho - rho0), unit L/T^2. Melting: c^2 (rho - rho0), unit M/(L T^2). */
    double pressure;
    /** Number of particles closer than the support. */
    uint32_t neighbours;

    /** Thickening only: rho_near, sum over the neighbours of (1 - r/h)^3. */
    double near_density;
    /** Thickening only: k_near rho_near. Unit L/T^2. */
    double near_pressure;
    /** Thickening only: D^q x from the present history. Unit L/T^q; 0 without history. */
    double derivative[3];
    /** Thickening only: number of springs that end here. */
    uint32_t springs;

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

/** Reads one particle. RHEO_ERROR_ARGUMENT if there is no such particle. */
RHEO_API rheo_result rheo_world_particle(const rheo_world *world, uint32_t id, rheo_particle_state *state,
                                         rheo_error *error);

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

/** Quantity by index of the particles of a world, as its model has them; NULL past the last. */
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

/** Ranking by index, as the world's model has them; NULL past the last. */
RHEO_API const rheo_ranking *rheo_world_ranking(const rheo_world *world, uint32_t index);

typedef struct rheo_top_entry {
    /** Particle, or smaller id of a spring. */
    uint32_t id;
    /** Larger id of a spring; else 0. */
    uint32_t other_id;
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

/** A number that says how a definition behaves. */
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

/** Derived number by index of a valid definition, as its model has them. False past the last. */
RHEO_API bool rheo_world_def_derived(const rheo_world_def *def, uint32_t index, rheo_derived *derived);

/* ---- Bodies and vibrators ---- */

typedef struct rheo_body {
    /** Unit L and L/T. */
    double position[3], velocity[3];
    /** Angular velocity. Unit 1/T. */
    double spin[3];
    /** Unit quaternion w, x, y, z. */
    double orientation[4];
    /** Unit L. */
    double radius;
    /** In masses of a particle. */
    double mass;
} rheo_body;

/** Number of bodies: 1 with a ball, else 0. */
RHEO_API uint32_t rheo_world_body_count(const rheo_world *world);
/** Reads a body. RHEO_ERROR_ARGUMENT if there is no such body. */
RHEO_API rheo_result rheo_world_body(const rheo_world *world, uint32_t index, rheo_body *body);

typedef struct rheo_vibrator {
    /** Unit L. */
    double x, z;
    /** In turns, 0 to 1. */
    double phase;
    /** Unit 1/T. */
    double frequency;
} rheo_vibrator;

/** Number of vibrators. */
RHEO_API uint32_t rheo_world_vibrator_count(const rheo_world *world);
/** Reads a vibrator. RHEO_ERROR_ARGUMENT if there is no such vibrator. */
RHEO_API rheo_result rheo_world_vibrator(const rheo_world *world, uint32_t index, rheo_vibrator *vibrator);

/* ---- Fields: the state, as it is hashed and saved ---- */

typedef enum rheo_element { RHEO_ELEMENT_F32, RHEO_ELEMENT_F64, RHEO_ELEMENT_U32, RHEO_ELEMENT_U64 } rheo_element;

typedef struct rheo_field_info {
    const char *name;
    rheo_element element;
    /** Kind of its items. */
    rheo_location location;
    /** Values an item. */
    uint32_t components;
    /** Several rows of items: lags of a history, newest first, or modes. */
    bool ring;
    /** Filled rows; 1 for fields without rows. */
    uint64_t rows;
    /** Items a row: particles, springs, ... */
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

typedef struct rheo_stage_info {
    const char *name;
    /** Runs since creation or rheo_world_reset_times(). */
    uint64_t calls;
    /** Wall time of these runs. Unit s. */
    double seconds;
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
