/*
 * The thickening model as the world sees it (world/model.h): parameters, features and fields, memory, stages, metrics, commands.
 */
#include "world/model_thickening.h"

#include <stdio.h>
#include <string.h>

#include "core/text.h"
#include "solids/solids.h"
#include "thickening/continuum.h"
#include "world/ball_rows.h"

/* ---- Parameters ---- */

#define OWNER rheo_world_def
#define SCENE_ONLY false
#define MODELS (UINT32_C(1) << RHEO_MODEL_THICKENING)
static const rheo__parameter_row ROWS[] = {
#include "thickening/parameters.def"
};

#undef REAL
#undef FIRST_BALL_REAL
#undef FIRST_BALL_VECTOR
#undef INTEGER
#undef VECTOR
#undef WINDOW
#undef CHOICE
#undef OLD_NAME
#define REAL(...)
#define FIRST_BALL_REAL(...)
#define FIRST_BALL_VECTOR(...)
#define INTEGER(...)
#define VECTOR(...)
#define WINDOW(...)
#define CHOICE(...)
#define OLD_NAME(old, now) {#old, #now},
static const rheo__old_name OLD_NAMES[] = {
#include "thickening/parameters.def"
};

static const rheo__parameter_rows PARAMETERS = {
    .row = ROWS,
    .count = sizeof ROWS / sizeof *ROWS,
    .old_name = OLD_NAMES,
    .old_name_count = sizeof OLD_NAMES / sizeof *OLD_NAMES,
};

/* ---- Definitions ---- */

static double support(const rheo_world_def *def)
{
    return def->fluid.support;
}

/* Sum of kappa over the springs of a particle at rest. */
double rheo__stiffness_sum_at_rest(const rheo_world_def *def, double substep)
{
    const double reach = def->fluid.support / def->fluid.spacing;
    return substep * substep * rheo__largest_of_materials(def).springs.stiffness * 4 / 3 * 3.14159265358979323846 *
           reach * reach * reach;
}

/* Particles stand for the fluid around them, so a wall keeps their centres half a spacing away. */
static double wall_distance(const rheo_world_def *def)
{
    return def->fluid.spacing / 2;
}

/* The forces between fluid and ball keep particles off the ball (thickening/wetting.c); only scheme summed has them. */
static double ball_distance(const rheo_world_def *def)
{
    return def->scheme == RHEO_SCHEME_SUMMED ? 0 : def->fluid.spacing / 2;
}

/* The first layer of particles along the ball. */
static double friction_distance(const rheo_world_def *def)
{
    return 0.75 * def->fluid.spacing;
}

/* ---- Features and fields ---- */

static bool pushes(const rheo_world_def *def)
{
    for (uint32_t i = 0; i <= def->balls.count; i++) {
        const double *push = rheo__ball_of(def, i)->push;
        if (push[0] != 0 || push[1] != 0 || push[2] != 0)
            return true;
    }
    return false;
}

/* In scheme positions k_min is only the unit of the history's stiffness. */
static uint32_t features(const rheo_world_def *def)
{
    const rheo_material most = rheo__largest_of_materials(def);
    const bool k_min = most.springs.stiffness > 0, history = k_min && most.history.stiffness > 0,
               walls = def->walls.count > 0 || def->obstacles.count > 0,
               positions = def->scheme == RHEO_SCHEME_POSITIONS;
    uint32_t needed = 0;
    if (positions ? def->positions.viscosity > 0
                  : def->fluid.linear_viscosity > 0 || def->fluid.quadratic_viscosity > 0)
        needed |= RHEO__FEATURE_VISCOSITY;
    if (k_min && !positions)
        needed |= RHEO__FEATURE_SPRINGS;
    if (history)
        needed |= RHEO__FEATURE_HISTORY;
    if (positions || def->fluid.stiffness > 0 || def->fluid.near_stiffness > 0)
        needed |= RHEO__FEATURE_DENSITY;
    if (def->ball.radius > 0)
        needed |= RHEO__FEATURE_BALL | (pushes(def) ? RHEO__FEATURE_PUSH : 0) |
                  (def->balls.count ? RHEO__FEATURE_BALLS : 0);
    if (def->walls.count > 0)
        needed |= RHEO__FEATURE_WALLS;
    if (def->obstacles.count > 0)
        needed |= RHEO__FEATURE_OBSTACLES;
    if (def->vibrators.count > 0)
        needed |= RHEO__FEATURE_VIBRATORS;
    if (walls && history && def->walls.sticking > 0)
        needed |= RHEO__FEATURE_STICKING;
    if (rheo__thickening_has_plates(def))
        needed |= RHEO__FEATURE_PLATES;
    return needed;
}

static bool check_features(const rheo_world_def *def, uint32_t features)
{
    const bool positions = def->scheme == RHEO_SCHEME_POSITIONS;
    const bool history = features & RHEO__FEATURE_HISTORY, springs = features & RHEO__FEATURE_SPRINGS,
               walls = features & (RHEO__FEATURE_WALLS | RHEO__FEATURE_OBSTACLES),
               sticking = features & RHEO__FEATURE_STICKING, ball = features & RHEO__FEATURE_BALL,
               push = features & RHEO__FEATURE_PUSH;
    return (positions ? !springs : springs || !history) && ((walls && history) || !sticking) && (ball || !push);
}

static rheo__fields fields(uint32_t features, const rheo_world_def *def)
{
    const rheo_history_kind kind = def->history.kind;
    const uint32_t pairs = RHEO__FEATURE_SPRINGS | RHEO__FEATURE_DENSITY | RHEO__FEATURE_VISCOSITY;
    rheo__fields present = 0;
    if (def->scheme == RHEO_SCHEME_SUMMED)
        present |= RHEO__BIT(substeps);
    if (def->scheme != RHEO_SCHEME_SEQUENTIAL && (features & pairs))
        present |= RHEO__BIT(list_position) | RHEO__BIT(list_margin);
    if (features & RHEO__FEATURE_SPRINGS)
        present |= RHEO__BIT(spring_ends) | RHEO__BIT(spring_rest_length);
    if (def->materials.count > 0)
        present |= RHEO__BIT(material);
    if (features & RHEO__FEATURE_PLATES)
        present |= RHEO__BIT(start_position) | RHEO__BIT(plate) | RHEO__BIT(plate_displacement) |
                   RHEO__BIT(plate_velocity) | RHEO__BIT(plate_phase);
    if (features & RHEO__FEATURE_HISTORY) {
        const bool lengths = rheo__history_of_lengths(def);
        present |= RHEO__BIT(history_rows) | (lengths ? RHEO__BIT(history_position) : RHEO__BIT(derivative));
        if (lengths)
            return present;
        if (kind == RHEO_HISTORY_WINDOW || kind == RHEO_HISTORY_WINDOW_FAST || def->history.lag)
            present |= RHEO__BIT(history_velocity);
        if (kind != RHEO_HISTORY_WINDOW)
            present |= RHEO__BIT(history_modes);
    }
    return present;
}

/* ---- Memory ---- */

static bool create(rheo_world *w)
{
    rheo__thickening *t = w->model;
    t->allocator = w->def.allocator;
    t->diagnostics = (rheo__diagnostics){.substeps = w->def.scheme != RHEO_SCHEME_SUMMED,
                                         .stiffest = {-1, -1},
                                         .stiffest_particle = -1,
                                         .densest_particle = -1,
                                         .max_spring_displacement.id = -1,
                                         .max_pressure_displacement.id = -1};
    for (int plate = 0; plate < RHEO__PLATES; plate++)
        for (int axis = 0; axis < 3; axis++)
            t->diagnostics.plate_force[plate][axis] = __builtin_nan("");
    t->springs = w->features & RHEO__FEATURE_SPRINGS;
    t->history = w->features & RHEO__FEATURE_HISTORY;
    t->sticking = w->features & RHEO__FEATURE_STICKING;
    t->period = &w->period;
    return true;
}

static bool configure(rheo_world *w)
{
    const uint32_t window = w->features & RHEO__FEATURE_HISTORY ? w->def.history.window : 0;
    rheo__thickening *t = w->model;
    t->obstacle_speed = rheo__obstacles_speed(w->solids, &w->def);
    return rheo__thickening_configure(w->model, &w->def, window, w->state.ring.rows);
}

/* Springs are there twice, before and after a step. Rows of scheme sequential have only half of the pairs. */
static void working_memory(const rheo_world_def *def, double *particle, double *neighbour)
{
    const bool has_springs =
        def->scheme != RHEO_SCHEME_POSITIONS && rheo__largest_of_materials(def).springs.stiffness > 0;
    const double real = sizeof(rheo_real), pair = 4;
    double springs = has_springs ? 2 * (pair + real) : pair;
    *particle = (has_springs ? 144 : 130) + (has_springs ? 32 : 22) * real;
    if (rheo__history_of_lengths(def)) {
        *particle += 4 * real * rheo__sample_count(def->history.window);
        springs += real;
    }
    *neighbour = def->scheme == RHEO_SCHEME_SEQUENTIAL ? springs / 2 + pair + real / 2 : springs + real;
}

static bool reserve(rheo_world *w, uint32_t particles)
{
    rheo__thickening *t = w->model;
    if (!rheo__thickening_reserve(t, particles))
        return false;
    w->solids->wall_friction = t->wall_friction;
    w->solids->substep = &t->substep;
    return true;
}

/* The past of a new particle is that of one at rest. */
static void begin_particles(rheo_world *w, uint32_t first, const rheo_real *density, const rheo_real *temperature)
{
    (void)density;
    (void)temperature;
    if (rheo__state_has(&w->state, RHEO__FIELD_history_position))
        rheo__remember_rest(&w->state, first);
    if (w->features & RHEO__FEATURE_PLATES)
        rheo__plates_begin(&w->state, &w->def, first);
}

static void begin_moving(rheo_world *w, uint32_t first)
{
    if (w->features & RHEO__FEATURE_HISTORY)
        rheo__remember_motion(&w->state, w->model, first);
}

static bool reserve_history(rheo_world *w, uint64_t rows)
{
    return rheo__thickening_remember(w->model, &w->state, rows);
}

static void push_history(rheo_world *w, uint64_t rows)
{
    rheo__remember(&w->state, w->model, rows);
}

static void release(rheo_world *w)
{
    rheo__thickening_release(w->model);
}

/* ---- Stages ---- */

#define has(feature) ((w->features & RHEO__FEATURE_##feature) != 0)
#define BIT(field) RHEO__BIT(field)
#define DERIVED(array) RHEO__DERIVED(array)
#define ADD(name, function, owner, when, writes, reads, derives) \
    if (when)                                                    \
        rheo__world_add_stage(w, (rheo__stage){name, rheo__stage_##function, owner, writes, reads, derives});
#define STAGE(name, function, ...) ADD(name, function, w->model, __VA_ARGS__)
#define SIMD_STAGE(name, function, ...) ADD(name, function, w->model, __VA_ARGS__)
#define SOLIDS_STAGE(name, function, ...) ADD(name, function, w->solids, __VA_ARGS__)
#define END_SUBSTEPS() rheo__world_end_substeps(w);

static void add_stages(rheo_world *w)
{
    const bool summed = w->def.scheme == RHEO_SCHEME_SUMMED, sequential = w->def.scheme == RHEO_SCHEME_SEQUENTIAL,
               positions = w->def.scheme == RHEO_SCHEME_POSITIONS, modes = w->def.history.kind != RHEO_HISTORY_WINDOW,
               lengths = rheo__history_of_lengths(&w->def), passive = has(HISTORY) && !lengths,
               periodic = w->period.axes > 0, pushes = w->def.vibrators.kind == RHEO_VIBRATOR_FORCE;
    const uint32_t multiplier = has(HISTORY) ? DERIVED(multiplier) : 0;
    const rheo__fields vibrated =
                           BIT(vibrator_phase) | BIT(vibrator_frequency) | BIT(random) | (pushes ? BIT(velocity) : 0),
                       ball_moved = BIT(ball_position) | BIT(ball_velocity) | BIT(ball_orientation);
#include "thickening/stages.def"
}

/* ---- Measures, metrics and failures ---- */

static const rheo__measures *measures(const rheo_world_def *def)
{
    static const rheo__measures *const of_scheme[] = {[RHEO_SCHEME_SUMMED] = &rheo__measures_summed,
                                                      [RHEO_SCHEME_SEQUENTIAL] = &rheo__measures_sequential,
                                                      [RHEO_SCHEME_POSITIONS] = &rheo__measures_positions};
    return of_scheme[def->scheme];
}

/* COMMON(name); STATE and STAGES(name, unit, meaning, value): measured in the state, or found by the stages. */
#define METRICS(COMMON, STATE, STAGES)                                                                            \
    COMMON(step)                                                                                                  \
    COMMON(time)                                                                                                  \
    COMMON(kinetic_energy)                                                                                        \
    COMMON(max_speed)                                                                                             \
    STAGES(stiffness_number, "1", "largest kappa = substep^2 K of a spring", d->stiffness_number)                 \
    STAGES(stiffness_sum, "1", "largest sum of kappa over the springs of a particle", d->largest_stiffness_sum)   \
    COMMON(courant_number)                                                                                        \
    STAGES(max_spring_displacement, "support", "largest displacement of a particle by springs in a substep",      \
           d->max_spring_displacement.length / w->def.fluid.support)                                              \
    STAGES(max_pressure_displacement, "support", "largest displacement of a particle by pressure in a substep",   \
           d->max_pressure_displacement.length / w->def.fluid.support)                                            \
    STAGES(density_error, "rest density", "mean of the particles' densities above the rest density",              \
           d->density_error)                                                                                      \
    STAGES(max_density, "rest density", "largest density of a particle", d->largest_density)                      \
    COMMON(energy)                                                                                                \
    COMMON(energy_jump)                                                                                           \
    COMMON(centre_x)                                                                                              \
    COMMON(centre_y)                                                                                              \
    COMMON(centre_z)                                                                                              \
    COMMON(neighbours)                                                                                            \
    STATE(springs, "1", "number of springs", (double)rheo_world_spring_count(w))                                  \
    COMMON(max_speed_id)                                                                                          \
    STAGES(stiffness_a, "1", "first end of the spring of stiffness_number", d->stiffest[0])                       \
    STAGES(stiffness_b, "1", "second end of the spring of stiffness_number", d->stiffest[1])                      \
    STAGES(stiffness_sum_id, "1", "particle of stiffness_sum", d->stiffest_particle)                              \
    STAGES(max_spring_displacement_id, "1", "particle of max_spring_displacement", d->max_spring_displacement.id) \
    STAGES(max_pressure_displacement_id, "1", "particle of max_pressure_displacement",                            \
           d->max_pressure_displacement.id)                                                                       \
    STAGES(max_density_id, "1", "particle of max_density", d->densest_particle)                                   \
    STAGES(substeps, "1", "substeps of the step; 1 in scheme sequential", d->substeps)                            \
    STAGES(softened_springs, "1", "springs whose kappa the stage substeps lowered", d->softened_springs)

enum { METRICS(RHEO__NO_METRIC, RHEO__METRIC_NUMBER, RHEO__METRIC_NUMBER) OWN_COUNT };
_Static_assert((int)OWN_COUNT <= (int)RHEO__MAX_OWN_METRICS, "metrics of the model");
static const rheo__metric METRIC_ROWS[] = {METRICS(RHEO__COMMON_METRIC, RHEO__OWN_METRIC, RHEO__OWN_METRIC)};
#define MEASURE(name, unit, meaning, value) m->own[OWN_##name] = value;

static void measure_state(const rheo_world *w, rheo__metrics *m)
{
    METRICS(RHEO__NO_METRIC, MEASURE, RHEO__NO_METRIC)
}

static void measure_stages(const rheo_world *w, rheo__metrics *m)
{
    const rheo__diagnostics *d = &rheo__thickening_of(w)->diagnostics;
    m->neighbours = d->mean_neighbours;
    METRICS(RHEO__NO_METRIC, RHEO__NO_METRIC, MEASURE)
}

static void keep_diagnostics(rheo_world *w)
{
    rheo__thickening *t = w->model;
    t->diagnostics_before = t->diagnostics;
}

static void restore_diagnostics(rheo_world *w)
{
    rheo__thickening *t = w->model;
    t->diagnostics = t->diagnostics_before;
}

static void describe_failure(const rheo_world *w, char *text, size_t size)
{
    const double *own = w->failed_metrics.own;
    int length = 0;
    char number[32];
    if (own[OWN_stiffness_a] >= 0)
        length = rheo__text_print(text, size, " The stiffness number was %s (spring %.0f:%.0f).",
                                  rheo__text_brief(own[OWN_stiffness_number], 3, false, number), own[OWN_stiffness_a],
                                  own[OWN_stiffness_b]);
    if (own[OWN_max_density_id] >= 0)
        length += rheo__text_print(text + length, size - (size_t)length,
                                   " The largest density was %s times that at rest (particle %.0f).",
                                   rheo__text_brief(own[OWN_max_density], 3, false, number), own[OWN_max_density_id]);
    const char *help = " A smaller step may help";
    if (w->def.scheme == RHEO_SCHEME_SUMMED && w->def.substeps)
        help = " More substeps may help, or substeps 0: as many as the state needs";
    else if (w->def.scheme == RHEO_SCHEME_SUMMED && own[OWN_substeps] >= (double)w->def.max_substeps)
        help = " A smaller step may help, or a larger max_substeps";
    else if (w->def.scheme == RHEO_SCHEME_SEQUENTIAL && own[OWN_stiffness_number] > 1)
        help = " A smaller step may help, or softer springs, or springs.solver implicit";
    snprintf(text + length, size - (size_t)length, "%s", help);
}

static bool query_plate(const rheo_world *w, uint32_t plate, rheo_plate *values)
{
    return rheo__plates_query(&w->state, w->model, plate, values);
}

/* ---- Commands ---- */

/* A curve has weights by age, so it has no order, and remembered velocities keep the ages that they have. */
static rheo_result check_set_of_curve(const rheo_world *w, const rheo_world_def *def, rheo_error *error)
{
    if (def->step != w->def.step)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "step: this world has a history.curve, whose ages are those of the velocities that are "
                          "remembered at the present step; make a new world");
    if (def->history.order != w->def.history.order || def->history.weights != w->def.history.weights)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s: this world has a history.curve, which gives all weights",
                          def->history.order != w->def.history.order ? "history.order" : "history.weights");
    return RHEO_OK;
}

/*
 * Sums of a memory without a ring were made with weights that cannot change: no past velocities are left to make
 * others from. The rates of kind full are the same for any order.
 */
static rheo_result check_set(const rheo_world *w, const char *path, const rheo_world_def *def, rheo_error *error)
{
    (void)path;
    const rheo_history_kind kind = w->def.history.kind;
    if (rheo__state_has(&w->state, RHEO__FIELD_history_position) && def->step != w->def.step)
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "step: with history.of length this world remembers positions that are the present step apart; "
            "make a new world");
    if ((w->features & RHEO__FEATURE_HISTORY) && w->def.history.curve_count)
        return check_set_of_curve(w, def, error);
    const bool order = kind == RHEO_HISTORY_TEMPERED && def->history.order != w->def.history.order;
    const bool weights = (kind == RHEO_HISTORY_TEMPERED || kind == RHEO_HISTORY_FULL) &&
                         def->history.weights != w->def.history.weights;
    if ((w->features & RHEO__FEATURE_HISTORY) && (order || weights))
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "%s: this world's memory (history.kind %s) keeps sums that were gathered for the present one "
            "and no velocities to gather others from; kinds window and window-fast can change it",
            order ? "history.order" : "history.weights", kind == RHEO_HISTORY_FULL ? "full" : "tempered");
    return RHEO_OK;
}

/* The very first velocity enters the modes with a factor that depends on the weights. */
static void after_set(rheo_world *w, const rheo_world_def *before)
{
    if (rheo__state_has(&w->state, RHEO__FIELD_list_margin) && w->def.fluid.support != before->fluid.support)
        memset(w->state.list_margin, 0, w->state.particles * sizeof *w->state.list_margin); /* makes another list */
    if ((w->features & RHEO__FEATURE_HISTORY) && w->def.history.kind == RHEO_HISTORY_WINDOW_FAST &&
        w->def.history.weights != before->history.weights)
        rheo__modes_remake(&w->state, w->model);
}

const rheo__model_type rheo__model_thickening = {
    .name = "thickening",
    .parameters = &PARAMETERS,
    .check = rheo__thickening_check,
    .warn = rheo__thickening_warn,
    .foresee = rheo__thickening_foresee,
    .most_substeps = rheo__thickening_most_substeps,
    .support = support,
    .wall_distance = wall_distance,
    .ball_mass = rheo__ball_mass,
    .ball_distance = ball_distance,
    .friction_distance = friction_distance,
    .refine = rheo__thickening_refine,
    .materials = true,
    .possible_features = (2 * RHEO__FEATURE_STICKING - 1) | RHEO__FEATURE_PUSH | RHEO__FEATURE_PLATES |
                         RHEO__FEATURE_OBSTACLES | RHEO__FEATURE_BALLS,
    .fixed_features = RHEO__FEATURE_BALL | RHEO__FEATURE_BALLS | RHEO__FEATURE_WALLS | RHEO__FEATURE_VIBRATORS |
                      RHEO__FEATURE_PLATES | RHEO__FEATURE_OBSTACLES,
    .features = features,
    .check_features = check_features,
    .fields = fields,
    .ring_rows = rheo__ring_rows,
    .mode_rows = rheo__mode_rows,
    .size = sizeof(rheo__thickening),
    .create = create,
    .configure = configure,
    .working_memory = working_memory,
    .reserve = reserve,
    .begin_particles = begin_particles,
    .begin_moving = begin_moving,
    .reserve_history = reserve_history,
    .push_history = push_history,
    .release = release,
    .measures = measures,
    .add_stages = add_stages,
    .metrics = METRIC_ROWS,
    .metric_count = sizeof METRIC_ROWS / sizeof *METRIC_ROWS,
    .measure_state = measure_state,
    .measure_stages = measure_stages,
    .keep_diagnostics = keep_diagnostics,
    .restore_diagnostics = restore_diagnostics,
    .describe_failure = describe_failure,
    .check_set = check_set,
    .after_set = after_set,
    .weight = rheo__thickening_weight,
    .weight_name = "1 - r/h",
    .density_share = rheo__thickening_density_share,
    .query_particle = rheo__thickening_query_particle,
    .query_springs = rheo__thickening_query_springs,
    .query_all_springs = rheo__thickening_query_all_springs,
    .offer_springs = rheo__thickening_offer_springs,
    .query_spring = rheo__thickening_query_spring,
    .query_plate = query_plate,
    .query_modes = rheo__thickening_query_modes,
    .quantities = rheo__thickening_quantities,
    .rankings = rheo__thickening_rankings,
    .derived = rheo__thickening_derived,
    .derived_count = RHEO__THICKENING_DERIVED,
};
