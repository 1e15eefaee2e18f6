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
    RHEO_PARAMETER_VECTOR, /**< three reals, written [x, y, z] */
    RHEO_PARAMETER_CHOICE, /**< one of the words in `choices` */
    RHEO_PARAMETER_WINDOW, /**< steps, or seconds written "2.5 s" */
} rheo_parameter_type;

typedef struct rheo_parameter {
    const char *path;    /**< e.g. "fluid.support" */
    const char *unit;    /**< e.g. "L/T^2" */
    const char *about;   /**< one line */
    const char *choices; /**< RHEO_PARAMETER_CHOICE: words with a blank between, else NULL */
    double minimum, maximum;
    rheo_parameter_type type;
    bool above_minimum; /**< the minimum itself is not allowed */
    bool below_maximum; /**< the maximum itself is not allowed */
    bool live;          /**< a command may change it in a running world */
    uint32_t models;    /**< set of the models that have it: bit 1 << rheo_model */
} rheo_parameter;

RHEO_API size_t rheo_parameter_count(void);
/** NULL past the end. */
RHEO_API const rheo_parameter *rheo_parameter_at(size_t index);
/** The known path that is nearest to a misspelt one (never NULL). */
RHEO_API const char *rheo_parameter_nearest(const char *path);

/**
 * Sets one parameter from text: "0.5", "150", "2.5 s", "[0, -9.81, 0]", "implicit". Reads the same in every locale.
 * RHEO_ERROR_ARGUMENT for an unknown path (names the nearest) or a value that is no such thing or out of range.
 */
RHEO_API rheo_result rheo_world_def_set(rheo_world_def *def, const char *path, const char *value, rheo_error *error);
/** Writes a parameter as text that rheo_world_def_set() reads back to the same bits. `value` holds >= 96 bytes. */
RHEO_API rheo_result rheo_world_def_get(const rheo_world_def *def, const char *path, char *value, size_t size);

/* ---- Worlds ---- */

typedef struct rheo_world rheo_world;

/** What a field has an item for. */
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
 * A world at step 0. Builds the list of stages that the definition needs and nothing else: without history, springs,
 * viscosity, ball, walls or vibrators it has none of their stages, fields or bytes.
 * Refuses a floating-point environment in which the bits would differ (RHEO_ERROR_ENVIRONMENT).
 */
RHEO_API rheo_result rheo_world_create(const rheo_world_def *def, rheo_world **world, rheo_error *error);
RHEO_API void rheo_world_destroy(rheo_world *world); /* NULL is allowed */

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
 * One fixed step. If it goes bad (a NaN or an infinity in the state, no memory), the error names step, stage,
 * field and particle, and the world stays as it was before the step: the last good state. A step that was begun stage
 * by stage is finished. In a floating-point environment that would change the bits nothing is done
 * (RHEO_ERROR_ENVIRONMENT); it belongs to the calling thread, and once it is restored the world goes on.
 */
RHEO_API rheo_result rheo_world_step(rheo_world *world, rheo_error *error);
/**
 * The next stage of a step alone: *stage is its index, rheo_world_stage() its name. Between two stages a world can be
 * looked at; it takes no command and is not saved. If the stage goes bad, the world is as it was before the step.
 */
RHEO_API rheo_result rheo_world_step_stage(rheo_world *world, uint32_t *stage, rheo_error *error);
/** Stages made of a step that is not finished, those of each substep counted; 0 between steps. */
RHEO_API uint32_t rheo_world_stages_done(const rheo_world *world);
/** Stages that the step at hand has in all, as far as is known: its substeps are, once stage `substeps` is done. */
RHEO_API uint32_t rheo_world_stages_in_step(const rheo_world *world);
/** The stage that was made last of a step that is not finished, of a substep as "viscosity@3"; "" between steps. */
RHEO_API void rheo_world_last_stage(const rheo_world *world, char name[32]);
/** Whether the last step that was tried failed with RHEO_ERROR_STATE, and where. */
RHEO_API bool rheo_world_failure(const rheo_world *world, rheo_failure *failure);

/** The definition in force: as given at creation, with what commands have changed. No particles in it. */
RHEO_API const rheo_world_def *rheo_world_definition(const rheo_world *world);

RHEO_API uint64_t rheo_world_step_count(const rheo_world *world);
RHEO_API double rheo_world_time(const rheo_world *world);

/** One number for the whole state: every field, ring and spring. Equal states have equal hashes on any machine. */
RHEO_API uint64_t rheo_world_hash(const rheo_world *world);

/*
 * ---- Commands: change a world between steps; a recorder records them, a replay applies them. Like steps, they
 * refuse an unfit floating-point environment (RHEO_ERROR_ENVIRONMENT) and change nothing then ----
 */

/** An impulse (mass x L/T; a particle has mass 1) on the ball, at a point in space or, with NULL, at its centre. */
RHEO_API rheo_result rheo_world_push_body(rheo_world *world, uint32_t body, const double impulse[3],
                                          const double point[3], rheo_error *error);
/**
 * Changes a live parameter. One whose stages the world was made without (say history.stiffness of a world without
 * history) cannot be brought in: RHEO_ERROR_ARGUMENT says so; nor can history.weights change in kinds full and
 * tempered, or history.order in tempered. ball.position, .velocity and .spin set the state.
 */
RHEO_API rheo_result rheo_world_set(rheo_world *world, const char *path, const char *value, rheo_error *error);
/** New particles, ids following on; count x 3 values each; velocity NULL: at rest. They count as at rest before. */
RHEO_API rheo_result rheo_world_add_particles(rheo_world *world, uint32_t count, const rheo_real *position,
                                              const rheo_real *velocity, rheo_error *error);
RHEO_API rheo_result rheo_world_move_vibrator(rheo_world *world, uint32_t vibrator, double x, double z,
                                              rheo_error *error);

/* ---- Particles ---- */

RHEO_API uint32_t rheo_world_particle_count(const rheo_world *world);
/** particle_count x 3 values by id; valid until the next step or command. */
RHEO_API const rheo_real *rheo_world_positions(const rheo_world *world);
RHEO_API const rheo_real *rheo_world_velocities(const rheo_world *world);

/* ---- Springs ---- */

typedef struct rheo_spring {
    uint32_t a, b; /**< ids, a < b */
    rheo_real rest_length;
} rheo_spring;

RHEO_API size_t rheo_world_spring_count(const rheo_world *world);
/** Copies up to `capacity` springs, by a, then b. RHEO_ERROR_MEMORY if the ordering found none. */
RHEO_API rheo_result rheo_world_springs(const rheo_world *world, rheo_spring *springs, size_t capacity);

typedef struct rheo_spring_state {
    rheo_spring spring;
    double length;       /**< |x_a - x_b|, L */
    double history_rate; /**< |D^q (x_a - x_b)| from the velocities remembered now, L/T^q; 0 without history */
    double stiffness;    /**< K = k_min + k_hist x history_rate, 1/T^2 */
    double kappa;        /**< step^2 K: what part of its stretch the explicit solver takes back in a step */
} rheo_spring_state;

/** One spring as the next step finds it; RHEO_ERROR_ARGUMENT if a and b are not connected. */
RHEO_API rheo_result rheo_world_spring(const rheo_world *world, uint32_t a, uint32_t b, rheo_spring_state *state,
                                       rheo_error *error);

/* ---- History ---- */

/** d in steps; 0 for a world without history, and for the whole history (kind full). */
RHEO_API uint32_t rheo_world_history_window(const rheo_world *world);
/** Velocities remembered as such so far, at most d + 1; of kinds full and tempered the newest alone. */
RHEO_API uint32_t rheo_world_history_rows(const rheo_world *world);
/** Bytes of the whole memory: 12 (float) x particles x (d + 1) of a window, the same for each row of modes. */
RHEO_API size_t rheo_world_history_bytes(const rheo_world *world);
/** Remembered velocities of a particle: history_rows x 3 values, lag 0 (newest) first. */
RHEO_API rheo_result rheo_world_particle_history(const rheo_world *world, uint32_t id, rheo_real *velocity);
/** The history ring of a pair: v_a - v_b, lag by lag, history_rows x 3 values, lag 0 first. */
RHEO_API rheo_result rheo_world_spring_history(const rheo_world *world, uint32_t a, uint32_t b,
                                               rheo_real *difference);

/** A decaying sum over the velocities before the newest: y <- y - decay y + v, and what leaves a window is taken out.
 */
typedef struct rheo_mode_state {
    double decay;  /**< g, what a step takes of the sum */
    double weight; /**< w of D^q x = C0 (v + sum of w y) */
    double sum[3]; /**< y, L/T */
} rheo_mode_state;

/** Modes of a memory of kind window-fast, full or tempered, at most RHEO_HISTORY_MAX_MODES; else 0. */
RHEO_API uint32_t rheo_world_history_modes(const rheo_world *world);
/** The modes of a particle, the slowest first; RHEO_ERROR_ARGUMENT if there is no such particle, or no modes. */
RHEO_API rheo_result rheo_world_particle_modes(const rheo_world *world, uint32_t id, rheo_mode_state *modes);
/** The modes of a pair: those of the velocities v_a - v_b. */
RHEO_API rheo_result rheo_world_spring_modes(const rheo_world *world, uint32_t a, uint32_t b, rheo_mode_state *modes);

/* ---- Looking closer: computed from the state as it is, between steps or stages; the world stays the same ---- */

/** What a model does not have is 0. */
typedef struct rheo_particle_state {
    double position[3], velocity[3];
    double speed;   /**< |velocity|, L/T */
    double density; /**< thickening: rho, sum over the neighbours of (1 - r/h)^2; melting: that of the state, M/L^3 */
    double pressure;     /**< thickening: k (rho - rho0), L/T^2; melting: c^2 (rho - rho0), M/(L T^2) */
    uint32_t neighbours; /**< particles closer than the support */

    /* Of thickening alone. */
    double near_density;  /**< rho_near, sum over the neighbours of (1 - r/h)^3 */
    double near_pressure; /**< k_near rho_near, L/T^2 */
    double derivative[3]; /**< D^q x from the velocities remembered now, L/T^q; 0 without history */
    uint32_t springs;     /**< of which it is an end */

    /* Of melting alone. */
    double summed_density;    /**< sum of m W, the particle itself and walls included: what positions say, M/L^3 */
    double temperature;       /**< its own, or melting.temperature in an isothermal world, K */
    double jump_number;       /**< J of that temperature */
    double shear_rate;        /**< intensity of D, from the velocities as they are, 1/T */
    double viscosity;         /**< apparent, at that shear rate, M/(L T) */
    double start_position[3]; /**< where it was when it was made */
    double displacement;      /**< |position - start_position|, L */
} rheo_particle_state;

/** One particle; RHEO_ERROR_ARGUMENT if there is none of this id. */
RHEO_API rheo_result rheo_world_particle(const rheo_world *world, uint32_t id, rheo_particle_state *state,
                                         rheo_error *error);

/**
 * The particles closer than the support to one, ids ascending, and how far they are. *count becomes their number; the
 * first `capacity` of them are written. Either array may be NULL, so that one can ask first how many there are.
 */
RHEO_API rheo_result rheo_world_neighbours(const rheo_world *world, uint32_t id, uint32_t *ids, double *distances,
                                           size_t capacity, size_t *count, rheo_error *error);

/**
 * What the model makes of two particles at a distance >= 0: 1 - r/h of thickening; the kernel W(r) of melting, 1/L^3.
 * 0 beyond the support.
 */
RHEO_API double rheo_world_weight(const rheo_world *world, double distance);

/**
 * rho and rho_near of every particle, particle_count values each by id; either may be NULL. Of melting worlds these
 * are the summation density and 0. Or RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_world_densities(const rheo_world *world, double *density, double *near_density,
                                          rheo_error *error);

/** What a list is headed by. */
typedef enum rheo_top {
    RHEO_TOP_FASTEST,  /**< particles by speed, L/T */
    RHEO_TOP_DENSEST,  /**< particles by density, as rheo_world_particle() has it */
    RHEO_TOP_STIFFEST, /**< springs by kappa, from the velocities remembered now */
    RHEO_TOP_HOTTEST,  /**< particles by temperature, K; none in a world without temperatures of particles */
    RHEO_TOP_FURTHEST, /**< particles by how far they are from where they began, L; melting alone */
} rheo_top;

typedef struct rheo_top_entry {
    uint32_t id;
    uint32_t other_id; /**< larger id of a spring, else 0 */
    double value;
} rheo_top_entry;

/**
 * The `capacity` largest, descending; of equal ones the smaller ids first, a NaN before all. *count is how many were
 * written, fewer than capacity if there are no more. RHEO_ERROR_ARGUMENT for an unknown list, RHEO_ERROR_MEMORY.
 */
RHEO_API rheo_result rheo_world_top(const rheo_world *world, rheo_top what, size_t capacity, rheo_top_entry *entries,
                                    size_t *count, rheo_error *error);

/* ---- Bodies and vibrators ---- */

typedef struct rheo_body {
    double position[3], velocity[3];
    double spin[3];        /**< angular velocity, 1/T */
    double orientation[4]; /**< unit quaternion w, x, y, z */
    double radius, mass;   /**< mass in particles */
} rheo_body;

RHEO_API uint32_t rheo_world_body_count(const rheo_world *world);
RHEO_API rheo_result rheo_world_body(const rheo_world *world, uint32_t index, rheo_body *body);

typedef struct rheo_vibrator {
    double x, z;
    double phase;     /**< in turns, 0..1 */
    double frequency; /**< 1/T */
} rheo_vibrator;

RHEO_API uint32_t rheo_world_vibrator_count(const rheo_world *world);
RHEO_API rheo_result rheo_world_vibrator(const rheo_world *world, uint32_t index, rheo_vibrator *vibrator);

/* ---- Fields: the state, as it is hashed and saved ---- */

typedef enum rheo_element { RHEO_ELEMENT_F32, RHEO_ELEMENT_F64, RHEO_ELEMENT_U32, RHEO_ELEMENT_U64 } rheo_element;

typedef struct rheo_field_info {
    const char *name;
    rheo_element element;
    rheo_location location;
    uint32_t components; /**< values an item */
    bool ring;           /**< rows x items: lag 0 first, or the modes of a memory */
    uint64_t rows;       /**< 1, or the filled rows of a ring, or those of the modes */
    uint64_t items;      /**< particles, springs, ... */
    uint64_t bytes;      /**< rows x items x components x size of an element */
} rheo_field_info;

RHEO_API uint32_t rheo_world_field_count(const rheo_world *world);
RHEO_API rheo_result rheo_world_field(const rheo_world *world, uint32_t index, rheo_field_info *info);
/** Copies a whole field, in the order of ids (springs by a, then b), in the machine's own byte order. */
RHEO_API rheo_result rheo_world_field_read(const rheo_world *world, uint32_t index, void *values, size_t bytes);

/* ---- Stages, times, metrics ---- */

typedef struct rheo_stage_info {
    const char *name;
    uint64_t calls;
    double seconds; /**< wall time since creation or rheo_world_reset_times() */
} rheo_stage_info;

RHEO_API uint32_t rheo_world_stage_count(const rheo_world *world);
RHEO_API rheo_result rheo_world_stage(const rheo_world *world, uint32_t index, rheo_stage_info *info);
RHEO_API void rheo_world_reset_times(rheo_world *world);

/** Mean number of neighbours within the support in the last step; 0 before the first. */
RHEO_API double rheo_world_mean_neighbours(const rheo_world *world);

/** A metric: a number about the state or the last step, measured at every step. */
typedef struct rheo_metric_info {
    /** Name of its column in recordings. */
    const char *name;
    /** Unit in L, T, M, K; "1" for pure numbers and ids; "support", "rest density", "height" for multiples of these. */
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
