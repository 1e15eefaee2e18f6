/* Private declarations of a world, for this folder and for recordings. */
#ifndef RHEO__WORLD_WORLD_H
#define RHEO__WORLD_WORLD_H

#include "rheolog/world.h"
#include "core/error.h"
#include "core/stage.h"
#include "core/step_hashes.h"
#include "space/period.h"
#include "space/planes.h"
#include "world/parameters.h"

enum { RHEO__MAX_STAGES = 24 };

/* ---- Definitions (world/definition.c) ---- */

/* The part of rheo_world_def_check() that concerns particles. */
rheo_result rheo__def_check_particles(const rheo_world_def *def, rheo_error *error);
/*
 * Converts window and lag of the history to steps; a curve sets the window. RHEO_ERROR_ARGUMENT if one is given in
 * seconds that are not in the range of its steps; it is then left as it is.
 */
rheo_result rheo__def_in_steps(rheo_world_def *def, rheo_error *error);
/* Distance below which particles are neighbours, L. */
double rheo__def_support(const rheo_world_def *def);
/* Mass of a particle, M. */
double rheo__def_mass(const rheo_world_def *def);
/* Logs a warning for settings that are allowed but do not work. */
void rheo__def_warn(const rheo_world_def *def);

/*
 * Gives `own`, a copy of `def` with an allocator, its own arrays of walls and vibrators. False: no memory; the arrays
 * that were copied must still be released.
 */
bool rheo__def_copy_arrays(rheo_world_def *own, const rheo_world_def *def);
void rheo__def_release_arrays(rheo_world_def *own);

/* ---- Queries (world/query.c) ---- */

/* RHEO_ERROR_ARGUMENT in the middle of a step: "in the middle of step 7 a world <cannot>". */
rheo_result rheo__world_check_between_steps(const rheo_world *world, const char *cannot, rheo_error *error);

/* ---- Commands (world/commands.c) ---- */

typedef struct rheo__command {
    rheo_command_kind kind;
    uint32_t index;      /* PUSH_BODY: body; ADD_PARTICLES: material; MOVE_VIBRATOR: vibrator */
    bool has_point;      /* PUSH_BODY */
    double vector[3];    /* PUSH_BODY: impulse; MOVE_VIBRATOR: x, z */
    double point[3];     /* PUSH_BODY */
    char path[48];       /* SET */
    char value[96];      /* SET */
    uint32_t count;      /* ADD_PARTICLES */
    rheo_real *position; /* ADD_PARTICLES: count x 3 */
    rheo_real *velocity; /* ADD_PARTICLES: count x 3, never NULL */
} rheo__command;

/* Applies a command and keeps it until the next step is done. On failure nothing has changed. */
rheo_result rheo__world_command(rheo_world *world, const rheo__command *command, rheo_error *error);
/* The commands since the last step (world/command_queue.c). */
const rheo__command *rheo__world_commands(const rheo_world *world, size_t *count);
/* Removes them, as if the next step were done. */
void rheo__world_forget_commands(rheo_world *world);

/* ---- Steps (world/step.c) ---- */

/* Hashes taken in a step, in the order of world/stage_runs.h. */
typedef struct rheo__trace {
    uint64_t *hash;
    size_t count, capacity;
    rheo__step_hashes known;
} rheo__trace;

/*
 * rheo_world_step() that also puts the hashes into world->trace. With `expected` hashes the step stops, in the middle
 * or at its end, after the first stage run that gives another hash or one more than expected.
 */
rheo_result rheo__world_step_traced(rheo_world *world, const uint64_t *expected, size_t count, rheo_error *error);
/*
 * Is called when all of a step is known but the history, which cannot be undone. With any other result than RHEO_OK,
 * which must not be RHEO_ERROR_STATE, the step is undone and the commands before it remain.
 */
typedef struct rheo__step_check {
    rheo_result (*call)(void *user, rheo_error *error);
    void *user;
} rheo__step_check;
/* rheo__world_step_traced() without expected hashes. `check` may be NULL. */
rheo_result rheo__world_step_checked(rheo_world *world, const rheo__step_check *check, rheo_error *error);

#ifdef RHEO__SABOTAGE
/* Called after every stage in a library built for tests, which use it to cause faults. */
extern void (*rheo__sabotage)(rheo_world *world, uint32_t stage);
#endif

/* ---- The world (world/create.c) ---- */

struct rheo__model_type;
struct rheo__solids;

/*
 * Features of a world. A world has no stage, no field and no byte for a feature that it lacks. Recordings store the
 * bits. Bits from 256 on mark models; they are in world/model_NAME.h.
 */
enum {
    RHEO__FEATURE_VISCOSITY = 1,
    RHEO__FEATURE_SPRINGS = 2,
    RHEO__FEATURE_HISTORY = 4,
    RHEO__FEATURE_DENSITY = 8,
    RHEO__FEATURE_BALL = 16,
    RHEO__FEATURE_WALLS = 32,
    RHEO__FEATURE_VIBRATORS = 64,
    RHEO__FEATURE_STICKING = 128,
    RHEO__FEATURE_FLOW = 512,         /* particles move */
    RHEO__FEATURE_TEMPERATURE = 1024, /* particles have temperatures of their own */
    RHEO__FEATURE_HEAT = 2048,        /* heat flows */
    RHEO__FEATURE_PUSH = 4096,        /* the ball is pushed periodically */
    RHEO__FEATURE_PLATES = 8192,
    RHEO__FEATURE_OBSTACLES = 16384,
    RHEO__FEATURE_BALLS = 32768, /* more than one ball */
    RHEO__FEATURE_EMITTERS = 65536,
};
/* Features that a valid definition needs. */
uint32_t rheo__world_features(const rheo_world_def *def);
/*
 * Makes a world with these features, which must include those that the definition needs. There may be more: a command
 * may have set the parameter of a feature to 0.
 */
rheo_result rheo__world_make(const rheo_world_def *def, uint32_t features, rheo_world **world, rheo_error *error);

/* Metrics that any model may have, with unit and meaning; ids are -1 where there is no particle. */
#define RHEO__COMMON_METRICS(X)                                                                              \
    X(step, "1", "number of the step")                                                                       \
    X(time, "T", "time of the state")                                                                        \
    X(kinetic_energy, "M L^2/T^2", "kinetic energy of all particles")                                        \
    X(max_speed, "L/T", "largest speed of a particle")                                                       \
    X(courant_number, "1", "max_speed step/support")                                                         \
    X(energy, "M L^2/T^2", "kinetic energy and energy in the field of gravity, of particles and ball")       \
    X(energy_jump, "1", "change of energy in the step, relative to kinetic energy + total weight x spacing") \
    X(centre_x, "L", "mean position of the particles, x")                                                    \
    X(centre_y, "L", "mean position of the particles, y")                                                    \
    X(centre_z, "L", "mean position of the particles, z")                                                    \
    X(neighbours, "1", "mean number of neighbours within the support")                                       \
    X(max_speed_id, "1", "particle of max_speed")

enum { RHEO__MAX_OWN_METRICS = 24 };

typedef struct rheo__metrics {
#define X(name, unit, meaning) double name;
    RHEO__COMMON_METRICS(X)
#undef X
    double own[RHEO__MAX_OWN_METRICS];     /* metrics of the model, in its own order */
    double ball_max_speed[RHEO_MAX_BALLS]; /* 0 without a ball */
} rheo__metrics;

/* The particles that emitters added at the beginning of the step, and what takes them back. */
typedef struct rheo__emission {
    bool made; /* in the current step */
    uint32_t particles;
    double time, way[RHEO_MAX_EMITTERS];
    uint64_t emitted[RHEO_MAX_EMITTERS], blocked[RHEO_MAX_EMITTERS];
} rheo__emission;

struct rheo_world {
    rheo_world_def def; /* definition in force; its particles are empty, its window and lag are in steps */
    uint32_t features;  /* fixed at creation */
    rheo__state state;
    rheo__planes planes; /* the walls */
    rheo__period period;
    const struct rheo__model_type *type;
    void *model; /* type->size bytes */
    struct rheo__solids *solids;

    uint64_t stage_runs_done; /* in the current step; 0 between steps */
    rheo_failure failure;     /* failure of the last attempt at a step */
    bool failed;              /* the last attempt failed */

    rheo__stage stage[RHEO__MAX_STAGES];
    double stage_seconds[RHEO__MAX_STAGES];
    uint32_t stage_count;
    uint32_t substeps_begin, substeps_end; /* the stages [begin, end) run in every substep; see world/stage_runs.h */
    uint64_t steps_timed, substeps_timed;
    rheo__trace trace; /* of the last traced step */

    rheo__command *command;
    size_t command_count, command_capacity;
    rheo__emission emission;

    rheo__metrics metrics, failed_metrics;
};

/* Gives particles from `first` on the model's own fields; either array may be NULL. */
void rheo__world_begin_particles(rheo_world *world, uint32_t first, const rheo_real *density,
                                 const rheo_real *temperature);
/* Set the state of an obstacle to its position and its rotation in the definition (world/obstacles.c). */
void rheo__obstacle_put(rheo_world *world, uint32_t index);
void rheo__obstacle_turn(rheo_world *world, uint32_t index);
/* Passes the definition in force on to model and solids. False: no memory. */
bool rheo__world_configure(rheo_world *world);
/* Makes room for this many particles. False: no memory. */
bool rheo__world_reserve(rheo_world *world, uint32_t particles);
/* Makes room for this many filled rows of history, at most the length of a ring. False: no memory. */
bool rheo__world_reserve_history(rheo_world *world, uint64_t rows);
/* Stores the velocities as the newest of a history that already has `rows` of them. The world must have history. */
void rheo__world_push_history(rheo_world *world, uint64_t rows);
/* Set of fields that a world has. */
rheo__fields rheo__world_fields(const rheo_world_def *def, uint32_t features);
/* Rows of a world's ring when it is full; 0 without a ring. */
uint32_t rheo__world_ring_rows(const rheo_world_def *def, uint32_t features);
/* Rows of a world's whole history: those of a full ring and those of modes. */
uint64_t rheo__world_memory_rows(const rheo_world_def *def, uint32_t features);
/* Measures the metrics of the present state (world/metrics.c). */
void rheo__world_measure(rheo_world *world);
/* Measures the state after a step; compares the energy with that before. */
void rheo__world_measure_step(rheo_world *world);
/* Measures the state again after commands, whose changes do not count as changes of the step. */
void rheo__world_measure_commands(rheo_world *world);
/* Sets failed_metrics: the metrics before the failed step, with the diagnostics of its stages. */
void rheo__world_measure_failure(rheo_world *world);
/* A metric of failed_metrics. */
double rheo__world_failed_metric(const rheo_world *world, uint32_t index);
/* Sets a metric of a loaded world. Does nothing if the world has no metric of this name. */
void rheo__world_restore_metric(rheo_world *world, const char *name, double value);
/* Keep the diagnostics of the stages when a step begins, and restore them before it is made again. */
void rheo__world_keep_diagnostics(rheo_world *world);
void rheo__world_restore_diagnostics(rheo_world *world);
/* Explains a failure by failed_metrics, with advice. The text begins with a blank. */
void rheo__world_describe_failure(const rheo_world *world, char *text, size_t size);

/*
 * Checks a loaded state (world/check_state.c). A state is loaded by rheo__world_make() with positions, velocities and
 * springs, then by rheo__state_write_row() for the other fields. rings: checks histories, too.
 */
rheo_result rheo__world_check_state(const rheo_world *world, bool rings, rheo_error *error);

#endif
