/*
 * A model as an object: everything that the world, recordings, scenes and views ask of a model is a member of
 * rheo__model_type. world/models.c has the list of models; world/model_NAME.c fills in the type of model NAME.
 *
 * Functions marked "may be NULL" are left out by a model that has no use for them.
 */
#ifndef RHEO__WORLD_MODEL_H
#define RHEO__WORLD_MODEL_H

#include "world/parameters.h"
#include "world/world.h"

/* A metric of a model, in the order of the columns of recordings. */
typedef struct rheo__metric {
    rheo_metric_info info; /* empty for common metrics, whose row is in RHEO__COMMON_METRICS */
    size_t offset;         /* of its value in rheo__metrics */
} rheo__metric;

/*
 * For the list of a model's metrics, an X-macro: nothing, the number OWN_name of an own metric in rheo__metrics.own,
 * and the rows of common and own metrics.
 */
#define RHEO__NO_METRIC(...)
#define RHEO__METRIC_NUMBER(name, unit, meaning, value) OWN_##name,
#define RHEO__COMMON_METRIC(name) {{NULL, NULL, NULL}, offsetof(rheo__metrics, name)},
#define RHEO__OWN_METRIC(name, unit, meaning, value) \
    {{#name, unit, meaning}, offsetof(rheo__metrics, own) + OWN_##name * sizeof(double)},

/* A row of a table of quantities, which ends with {NULL, NULL, NULL, 0, 0}. */
#define RHEO__QUANTITY(member, components, unit, meaning)                         \
    {                                                                             \
#member, unit, meaning, components, offsetof(rheo_particle_state, member) \
    }

/* A number that follows from a definition; members as in rheo_derived. */
typedef struct rheo__derived_number {
    const char *name, *unit, *meaning;
    double (*value)(const rheo_world_def *def);
} rheo__derived_number;

/* How a stage of this model explains that it refused to go on. */
typedef struct rheo__refusal_text {
    rheo_failure_reason reason;
    const char *required; /* unit of the number that the step requires, such as "substeps"; NULL: no numbers */
    const char *limit;    /* path of the parameter that limits this number */
    const char *text;     /* the fault, or a cure */
} rheo__refusal_text;

struct rheo__query_list;
struct rheo_preflight;

/* What a model needs to know of the first state of a scene to foresee its run. */
typedef struct rheo__start {
    double speed;            /* of the fastest particle, L/T */
    double ball_speed;       /* of the ball when it arrives at the fluid, L/T */
    bool has_temperatures;   /* particles have their own */
    double coldest, hottest; /* of them, K */
} rheo__start;

typedef struct rheo__model_type {
    const char *name; /* as in scene files */

    /* ---- Definitions ---- */

    /* The model's own parameters, and its defaults of common ones. */
    const rheo__parameter_rows *parameters;
    /* Checks what only this model asks of a definition whose parameters are in range. May be NULL. */
    rheo_result (*check)(const rheo_world_def *def, rheo_error *error);
    /* Warns through def->log, which is set, about values that are allowed but do not work. May be NULL. */
    void (*warn)(const rheo_world_def *def);
    /* Most substeps that a step may have. NULL: 1. */
    double (*most_substeps)(const rheo_world_def *def);
    /* Sets the numbers of the model; the others are set, or NaN. May be NULL. */
    void (*foresee)(const rheo_world_def *def, const rheo__start *start, struct rheo_preflight *preflight);
    /* Distance below which particles are neighbours, L. */
    double (*support)(const rheo_world_def *def);
    /* Mass of a particle, M. NULL: 1. */
    double (*mass)(const rheo_world_def *def);
    /* Distance at which walls stop a particle, L. NULL: 0, particles are held off by other means. */
    double (*wall_distance)(const rheo_world_def *def);
    /* Mass of a ball, in masses of particles. NULL: there is no ball. */
    double (*ball_mass)(const rheo_world_def *def, uint32_t index);
    /* Distances from a ball's surface at which it stops and slows a particle, L. NULL: there is no ball. */
    double (*ball_distance)(const rheo_world_def *def);
    double (*friction_distance)(const rheo_world_def *def);
    /* Changes a definition to the same material with particles `resolution` times as close. NULL: impossible. */
    void (*refine)(rheo_world_def *def, double resolution);
    /* Length by which views smooth the surface, L. NULL: the spacing. */
    double (*smoothing_length)(const rheo_world_def *def);
    /*
     * Density of fluid at rest at a depth, given as a potential |gravity| x depth; 0: the rest density. NULL:
     * particles have no densities of their own.
     */
    double (*density)(const rheo_world_def *def, double potential);
    bool materials; /* particles may be of several materials */
    /* Temperature of particles that are given none. NULL: particles have no temperatures. */
    double (*temperature)(const rheo_world_def *def);

    /* ---- Features and fields ---- */

    uint32_t possible_features; /* a world of this model has no others */
    uint32_t fixed_features;    /* a world has exactly those that its definition needs */
    /* Features that a definition needs. */
    uint32_t (*features)(const rheo_world_def *def);
    /* Whether features may be combined like this. May be NULL. */
    bool (*check_features)(const rheo_world_def *def, uint32_t features);
    /* Set of fields beside step, position, velocity and those of solids. May be NULL. */
    rheo__fields (*fields)(uint32_t features, const rheo_world_def *def);
    /* Rows of the ring of a definition in steps, if it has one. NULL: as many as the window, and one more. */
    uint32_t (*ring_rows)(const rheo_world_def *def);
    /* Rows of modes of a definition in steps. May be NULL. */
    uint32_t (*mode_rows)(const rheo_world_def *def);

    /* ---- Memory of the model: world->model ---- */

    size_t size; /* bytes of world->model, which is zero before create() */
    /* About how many bytes the stages need for a particle, and for each of its neighbours. May be NULL. */
    void (*working_memory)(const rheo_world_def *def, double *particle, double *neighbour);
    /* First values. False: no memory. May be NULL. */
    bool (*create)(rheo_world *world);
    /* Takes over the definition in force. False: no memory, nothing changed. May be NULL. */
    bool (*configure)(rheo_world *world);
    /* Room for this many particles. False: no memory, nothing changed. May be NULL. */
    bool (*reserve)(rheo_world *world, uint32_t particles);
    /* Room for this many filled rows of history. False: no memory. May be NULL. */
    bool (*reserve_history)(rheo_world *world, uint64_t rows);
    /* Stores the velocities in the history, which has had `rows` of them so far. Not NULL in a model with history. */
    void (*push_history)(rheo_world *world, uint64_t rows);
    /* May be NULL. */
    void (*release)(rheo_world *world);
    /* First values of the model's fields for particles from `first` on; either array may be NULL. May be NULL. */
    void (*begin_particles)(rheo_world *world, uint32_t first, const rheo_real *density,
                            const rheo_real *temperature);
    /* Gives particles from `first` on the past of a steady motion with their velocity. May be NULL: there is no past. */
    void (*begin_moving)(rheo_world *world, uint32_t first);

    /* ---- Health ---- */

    /* The measures of a world (world/measure.h), which must not change in a run. NULL: those that have a meaning in any model. */
    const struct rheo__measures *(*measures)(const rheo_world_def *def);

    /* ---- Stages ---- */

    /*
     * Adds the stages of a step in their order, those of solids among them, by rheo__world_add_stage(). Stages between
     * `substeps` and rheo__world_end_substeps() run in every substep. A stage that writes history is the last of all
     * and runs once.
     */
    void (*add_stages)(rheo_world *world);

    /* ---- Metrics and failures ---- */

    const rheo__metric *metrics;
    uint32_t metric_count;
    /* Sets the own metrics that a state has by itself. May be NULL. */
    void (*measure_state)(const rheo_world *world, rheo__metrics *metrics);
    /* Sets the metrics that the stages of the last step found. May be NULL. */
    void (*measure_stages)(const rheo_world *world, rheo__metrics *metrics);
    /* Keep what the stages have found when a step begins, and go back to it. Both may be NULL. */
    void (*keep_diagnostics)(rheo_world *world);
    void (*restore_diagnostics)(rheo_world *world);
    /* Explains the refusals of stages; the last row has no text. May be NULL: no stage refuses. */
    const rheo__refusal_text *refusals;
    /* Writes what world->failed_metrics say about a failure, and what may help; begins with a blank. May be NULL. */
    void (*describe_failure)(const rheo_world *world, char *text, size_t size);

    /* ---- Commands ---- */

    /* Refuses a change of the definition to *def that worlds of this model cannot follow. May be NULL. */
    rheo_result (*check_set)(const rheo_world *world, const char *path, const rheo_world_def *def, rheo_error *error);
    /* Adapts the state to a changed definition. May be NULL. */
    void (*after_set)(rheo_world *world, const rheo_world_def *before);

    /* ---- Queries ---- */

    /* Weight of a neighbour at a distance. May be NULL, with weight_name. */
    double (*weight)(const rheo_world *world, double distance);
    const char *weight_name; /* rheo_world_weight_name() */
    /* Contributions of a neighbour to the two sums of rheo_world_densities(). May be NULL: there are no sums. */
    double (*density_share)(const rheo_world *world, double distance, double *near_share);
    bool counts_itself; /* the first sum includes the particle itself */
    /* Contribution of the walls to the first sum. May be NULL. */
    double (*wall_density)(const rheo_world *world, uint32_t id);
    /*
     * Sets the members of the model, but those of springs; position, velocity, speed and neighbours are set already.
     * neighbour: ids of the neighbours, ascending. May be NULL.
     */
    void (*query_particle)(const rheo_world *world, uint32_t id, const uint32_t *neighbour, size_t count,
                           rheo_particle_state *state);
    /* Sets the members of springs of one particle, or of all; the others are set already. Both may be NULL. */
    void (*query_springs)(const rheo_world *world, uint32_t id, rheo_particle_state *state);
    void (*query_all_springs)(const rheo_world *world, rheo_particle_state *states);
    /* Offers all springs with their kappa. May be NULL. */
    rheo_result (*offer_springs)(const rheo_world *world, struct rheo__query_list *list, rheo_error *error);
    /* Sets the members of the model for the spring a:b; ends and lengths are set already. NULL: no springs. */
    void (*query_spring)(const rheo_world *world, uint32_t a, uint32_t b, rheo_spring_state *state);
    /* Modes of the memory: their number; sets those of a particle unless `modes` is NULL. NULL: no modes. */
    uint32_t (*query_modes)(const rheo_world *world, uint32_t id, rheo_mode_state *modes);
    /* rheo_world_plate(). NULL: no plates. */
    bool (*query_plate)(const rheo_world *world, uint32_t plate, rheo_plate *values);
    /* The last rows have no name. */
    const rheo_quantity *quantities;
    const rheo_ranking *rankings;

    /* ---- Numbers that follow from a definition ---- */

    const rheo__derived_number *derived;
    uint32_t derived_count;
} rheo__model_type;

/* The type of a model; NULL if there is none with this number. */
const rheo__model_type *rheo__model(rheo_model model);

/* Adds a stage at the end of the list; `writes` may name fields that the world does not have. */
void rheo__world_add_stage(rheo_world *world, rheo__stage stage);
/*
 * Ends the part of the list that runs in every substep, which begins after stage `substeps`. Stages that are added
 * later run once, after the last substep. Has no effect in a world without stage `substeps`.
 */
void rheo__world_end_substeps(rheo_world *world);

#endif
