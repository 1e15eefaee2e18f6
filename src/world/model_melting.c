/*
 * The melting model as the world sees it (world/model.h): parameters, features and fields, memory, stages, metrics, commands.
 */
#include "world/model_melting.h"

#include <stdio.h>

#include "core/text.h"
#include "solids/solids.h"
#include "world/emitters.h"
#include "world/row_macros.h"

/* ---- Parameters ---- */

#define OWNER rheo_world_def
#define SCENE_ONLY false
#define MODELS (UINT32_C(1) << RHEO_MODEL_MELTING)
static const rheo__parameter_row ROWS[] = {
#include "melting/parameters.def"
};

#undef REAL
#undef INTEGER
#undef CHOICE
#undef DEFAULT
#define REAL(...)
#define INTEGER(...)
#define CHOICE(...)
#define DEFAULT(member, ...) {#member, {__VA_ARGS__}},
static const rheo__parameter_default DEFAULTS[] = {
#include "melting/parameters.def"
};

#undef DEFAULT
#undef OLD_NAME
#define DEFAULT(...)
#define OLD_NAME(old, now) {#old, #now},
static const rheo__old_name OLD_NAMES[] = {
#include "melting/parameters.def"
};

static const rheo__parameter_rows PARAMETERS = {
    .row = ROWS,
    .count = sizeof ROWS / sizeof *ROWS,
    .other_default = DEFAULTS,
    .other_default_count = sizeof DEFAULTS / sizeof *DEFAULTS,
    .old_name = OLD_NAMES,
    .old_name_count = sizeof OLD_NAMES / sizeof *OLD_NAMES,
};

/* ---- Definitions ---- */

static rheo_result check(const rheo_world_def *def, rheo_error *error)
{
    if (!(def->melting.temperature_min < def->melting.temperature_max))
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "melting.temperature_min is %g and melting.temperature_max %g; melting must end above where it "
            "begins",
            def->melting.temperature_min, def->melting.temperature_max);
    /* The slope of the kernel over r^2 + 0.01 h^2 is a number of the state's type: it is from 0 to 32/h^7 (gradients.c). */
    const double h = rheo__melting_smoothing_length(def), shortest = RHEO_DOUBLE ? 1e-12 : 1e-5,
                 longest = RHEO_DOUBLE ? 1e12 : 1e5;
    if (!(h >= shortest && h <= longest))
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "the smoothing length of melting is %g; it must be from %g to %g, or its kernel is out of the "
            "range of numbers: choose another unit of length",
            h, shortest, longest);
    return RHEO_OK;
}

/* Relative compression of the fluid by its own weight. */
static double compression(const rheo_world_def *def)
{
    double low = 0, high = 0;
    for (size_t i = 0; i < def->particles.count; i++) {
        double depth = 0;
        for (size_t axis = 0; axis < 3; axis++)
            depth += def->gravity[axis] * (double)def->particles.position[3 * i + axis];
        low = i == 0 || depth < low ? depth : low;
        high = i == 0 || depth > high ? depth : high;
    }
    return (high - low) / (def->melting.sound_speed * def->melting.sound_speed);
}

static void warn(const rheo_world_def *def)
{
    const double percent = 100 * compression(def), limit = 3;
    if (!(percent > limit && def->melting.flow == RHEO_FLOW_ON))
        return;
    char text[320], own[32], most[32];
    rheo__text_two(percent, limit, own, most);
    snprintf(
        text, sizeof text,
        "melting.sound_speed is too small for the depth of this fluid: its own weight compresses it by %s %%, more "
        "than %s %%; ten times the speed of a fall from its top keeps that below 1 %%",
        own, most);
    def->log.message(text, def->log.user);
}

static double most_substeps(const rheo_world_def *def)
{
    return (double)(def->melting.substeps ? def->melting.substeps : def->melting.max_substeps);
}

static double support(const rheo_world_def *def)
{
    return 3 * rheo__melting_smoothing_length(def);
}

static double density(const rheo_world_def *def, double potential)
{
    const double c = def->melting.sound_speed, rest = def->melting.rest_density;
    return rest + rest * potential / (c * c);
}

static double temperature(const rheo_world_def *def)
{
    return def->melting.temperature;
}

/* All parameters but these are of the fluid, whatever its particles; alpha and xsph act over a smoothing length. */
static void refine(rheo_world_def *def, double resolution)
{
    def->fluid.spacing /= resolution;
    def->melting.smoothing_length /= resolution;
}

/* ---- Features and fields ---- */

static uint32_t features(const rheo_world_def *def)
{
    uint32_t needed = RHEO__FEATURE_MELTING;
    if (def->melting.flow == RHEO_FLOW_ON) {
        needed |= RHEO__FEATURE_FLOW;
        if (def->melting.viscosity > 0)
            needed |= RHEO__FEATURE_VISCOSITY;
        if (def->walls.count > 0)
            needed |= RHEO__FEATURE_WALLS;
    }
    bool temperatures = def->particles.temperature != NULL;
    for (uint32_t k = 0; k < def->emitters.count; k++)
        temperatures = temperatures || rheo__emitter_has_temperature(&def->emitters.list[k]);
    if (temperatures)
        needed |= RHEO__FEATURE_TEMPERATURE | (def->melting.diffusivity > 0 ? RHEO__FEATURE_HEAT : 0);
    return needed;
}

static bool check_features(const rheo_world_def *def, uint32_t features)
{
    (void)def;
    const bool flow = features & RHEO__FEATURE_FLOW, viscosity = features & RHEO__FEATURE_VISCOSITY,
               temperature = features & RHEO__FEATURE_TEMPERATURE, heat = features & RHEO__FEATURE_HEAT;
    return (temperature || !heat) && (flow || !viscosity);
}

static rheo__fields fields(uint32_t features, const rheo_world_def *def)
{
    (void)def;
    return RHEO__BIT(density) | RHEO__BIT(start_position) | RHEO__BIT(substeps) | RHEO__BIT(iterations) |
           (features & RHEO__FEATURE_TEMPERATURE ? RHEO__BIT(temperature) : 0) |
           (features & RHEO__FEATURE_VISCOSITY ? RHEO__BIT(predicted_acceleration) : 0);
}

/* ---- Memory ---- */

static bool create(rheo_world *w)
{
    rheo__melting *m = w->model;
    m->allocator = w->def.allocator;
    m->heat = w->features & RHEO__FEATURE_HEAT;
    m->flow = w->features & RHEO__FEATURE_FLOW;
    m->viscous = w->features & RHEO__FEATURE_VISCOSITY;
    m->warm = w->features & RHEO__FEATURE_TEMPERATURE;
    m->diagnostics.max_density_id = -1;
    return true;
}

static bool configure(rheo_world *w)
{
    rheo__melting_configure(w->model, &w->def, &w->planes);
    return true;
}

static void working_memory(const rheo_world_def *def, double *particle, double *neighbour)
{
    const double real = sizeof(rheo_real);
    const bool viscous = def->melting.flow == RHEO_FLOW_ON && def->melting.viscosity > 0;
    *particle = 100 + (viscous ? 120 : 72) * real;
    *neighbour = viscous ? 8 + 5 * real : 4 + 2 * real;
}

static bool reserve(rheo_world *w, uint32_t particles)
{
    rheo__melting *m = w->model;
    w->solids->substep = &m->substep;
    return rheo__melting_reserve(m, particles);
}

static void release(rheo_world *w)
{
    rheo__melting_release(w->model);
}

static void begin_particles(rheo_world *w, uint32_t first, const rheo_real *densities, const rheo_real *temperatures)
{
    rheo__state *s = &w->state;
    for (uint32_t i = first; i < s->particles; i++) {
        s->density[i] = densities ? densities[i - first] : (rheo_real)w->def.melting.rest_density;
        if (rheo__state_has(s, RHEO__FIELD_temperature))
            s->temperature[i] = temperatures ? temperatures[i - first] : (rheo_real)w->def.melting.temperature;
        for (size_t axis = 0; axis < 3; axis++)
            s->start_position[3 * (size_t)i + axis] = s->position[3 * (size_t)i + axis];
    }
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
    const bool flow = has(FLOW), heat = has(HEAT), leapfrog = w->def.paper.leapfrog, drifts = w->def.paper.xsph,
               summed = w->def.melting.density == RHEO_DENSITY_SUMMATION;
    const uint32_t ranked = DERIVED(ranked_velocity) | DERIVED(ranked_temperature),
                   lists = DERIVED(rows) | DERIVED(contacts) | ranked, gradients = heat ? DERIVED(gradients) : 0;
#include "melting/stages.def"
}

/* ---- Metrics and failures ---- */

/*
 * How far an object has melted. Lengths are in heights of the object at the start. Hot particles began in its upper
 * three tenths, cold ones below 0.35 of its height.
 */
typedef struct progress {
    double heat;
    double hot_height, cold_height, hot_spread, cold_displacement;
} progress;

/* Sum over particles, and their number. */
typedef struct mean {
    double sum[3];
    uint32_t count;
} mean;

/* Height of the object at the start; *base is its underside, half a spacing below its lowest particles. */
static double object_height(const rheo_world *w, double *base)
{
    const rheo__state *s = &w->state;
    double low = 0, high = 0;
    for (uint32_t i = 0; i < s->particles; i++) {
        const double y = (double)s->start_position[3 * (size_t)i + 1];
        low = i == 0 || y < low ? y : low;
        high = i == 0 || y > high ? y : high;
    }
    *base = low - w->def.fluid.spacing / 2;
    return high - low + w->def.fluid.spacing;
}

static progress progress_of(const rheo_world *w)
{
    const rheo__state *s = &w->state;
    double base, height = object_height(w, &base), displaced = 0, heat = 0;
    mean hot = {{0, 0, 0}, 0}, cold = {{0, 0, 0}, 0};
    for (uint32_t i = 0; i < s->particles; i++) {
        const rheo_real *x = s->position + 3 * (size_t)i, *start = s->start_position + 3 * (size_t)i;
        const double from = ((double)start[1] - base) / height;
        heat += s->temperature ? (double)s->temperature[i] : w->def.melting.temperature;
        mean *part = from > 0.7 ? &hot : from < 0.35 ? &cold : NULL;
        if (!part)
            continue;
        part->count++;
        double moved[3];
        for (int axis = 0; axis < 3; axis++) {
            part->sum[axis] += (double)x[axis];
            moved[axis] = (double)x[axis] - (double)start[axis];
        }
        displaced +=
            part == &cold ? __builtin_sqrt(moved[0] * moved[0] + moved[1] * moved[1] + moved[2] * moved[2]) : 0;
    }
    double spread = 0, centre[3] = {0, 0, 0};
    for (int axis = 0; axis < 3 && hot.count; axis++)
        centre[axis] = hot.sum[axis] / hot.count;
    for (uint32_t i = 0; i < s->particles && hot.count; i++) {
        if (!(((double)s->start_position[3 * (size_t)i + 1] - base) / height > 0.7))
            continue;
        const double x = (double)s->position[3 * (size_t)i] - centre[0],
                     z = (double)s->position[3 * (size_t)i + 2] - centre[2];
        spread += x * x + z * z;
    }
    return (progress){
        .heat = rheo__melting_mass(&w->def) * heat,
        .hot_height = hot.count ? (centre[1] - base) / height : 0,
        .cold_height = cold.count ? (cold.sum[1] / cold.count - base) / height : 0,
        .hot_spread = hot.count ? __builtin_sqrt(spread / hot.count) / height : 0,
        .cold_displacement = cold.count ? displaced / cold.count / height : 0,
    };
}

/* COMMON(name); STATE and STAGES(name, unit, meaning, value): measured in the state, or found by the stages. */
#define METRICS(COMMON, STATE, STAGES)                                                                               \
    COMMON(step)                                                                                                     \
    COMMON(time)                                                                                                     \
    COMMON(kinetic_energy)                                                                                           \
    COMMON(max_speed)                                                                                                \
    COMMON(courant_number)                                                                                           \
    STAGES(density_error, "rest density", "mean over the particles of |rho/rho0 - 1| after the last substep",        \
           d->density_error)                                                                                         \
    COMMON(energy)                                                                                                   \
    COMMON(energy_jump)                                                                                              \
    COMMON(centre_x)                                                                                                 \
    COMMON(centre_y)                                                                                                 \
    COMMON(centre_z)                                                                                                 \
    COMMON(neighbours)                                                                                               \
    COMMON(max_speed_id)                                                                                             \
    STAGES(max_density_id, "1", "particle of max_density_error", d->max_density_id)                                  \
    STAGES(max_density_error, "rest density", "largest |rho/rho0 - 1| of a particle after the last substep",         \
           d->max_density_error)                                                                                     \
    STATE(heat, "M K", "mass x temperature of all particles", p.heat)                                                \
    STATE(hot_height, "height", "mean height above the base of the particles that began in the upper 0.3",           \
          p.hot_height)                                                                                              \
    STATE(cold_height, "height", "mean height above the base of the particles that began below 0.35", p.cold_height) \
    STATE(hot_spread, "height", "rms horizontal distance of the particles of hot_height from their centre",          \
          p.hot_spread)                                                                                              \
    STATE(cold_displacement, "height", "mean distance of the particles of cold_height from where they began",        \
          p.cold_displacement)                                                                                       \
    STATE(substeps, "1", "substeps of the step", (double)*w->state.substeps)                                         \
    STATE(iterations, "1", "iterations of the viscosity solver in all substeps", (double)*w->state.iterations)

enum { METRICS(RHEO__NO_METRIC, RHEO__METRIC_NUMBER, RHEO__METRIC_NUMBER) OWN_COUNT };
_Static_assert((int)OWN_COUNT <= (int)RHEO__MAX_OWN_METRICS, "metrics of the model");
static const rheo__metric METRIC_ROWS[] = {METRICS(RHEO__COMMON_METRIC, RHEO__OWN_METRIC, RHEO__OWN_METRIC)};
#define MEASURE(name, unit, meaning, value) m->own[OWN_##name] = value;

static void measure_state(const rheo_world *w, rheo__metrics *m)
{
    const progress p = progress_of(w);
    METRICS(RHEO__NO_METRIC, MEASURE, RHEO__NO_METRIC)
}

static void measure_stages(const rheo_world *w, rheo__metrics *m)
{
    const rheo__melting_diagnostics *d = &rheo__melting_of(w)->diagnostics;
    m->neighbours = d->mean_neighbours;
    METRICS(RHEO__NO_METRIC, RHEO__NO_METRIC, MEASURE)
}

static void keep_diagnostics(rheo_world *w)
{
    rheo__melting *m = w->model;
    m->diagnostics_before = m->diagnostics;
}

static void restore_diagnostics(rheo_world *w)
{
    rheo__melting *m = w->model;
    m->diagnostics = m->diagnostics_before;
}

static const rheo__refusal_text REFUSALS[] = {
    {.reason = RHEO_FAILURE_DENSITY_NOT_POSITIVE,
     .text = "it is not above 0; a smaller melting.courant_number, or more melting.substeps, may help"},
#define MAX_SUBSTEPS .required = "substeps", .limit = "melting.max_substeps"
    {RHEO_FAILURE_SUBSTEPS_FOR_SOUND, MAX_SUBSTEPS,
     .text = "a slower fluid, or a smaller melting.sound_speed, needs fewer"},
    {RHEO_FAILURE_SUBSTEPS_FOR_VISCOSITY, MAX_SUBSTEPS,
     .text = "melting.solver implicit, or a less viscous fluid, needs fewer"},
    {RHEO_FAILURE_SUBSTEPS_FOR_PRINTED_VISCOSITY, MAX_SUBSTEPS,
     .text = "paper.courant off, or a less viscous fluid, needs fewer"},
    {RHEO_FAILURE_SUBSTEPS_FOR_HEAT, MAX_SUBSTEPS, .text = "a smaller melting.diffusivity needs fewer"},
    {.reason = RHEO_FAILURE_VISCOSITY_OUT_OF_RANGE,
     .text = "viscosity takes the velocities beyond the range of numbers, and it is largest here; a smaller "
             "melting.viscosity or melting.jump_number_max is needed"},
    {.text = NULL},
};

static void describe_failure(const rheo_world *w, char *text, size_t size)
{
    const double *own = w->failed_metrics.own;
    int used = 0;
    char error[32];
    if (own[OWN_max_density_id] >= 0)
        used =
            rheo__text_print(text, size, " The largest error of density was %s (particle %.0f).",
                             rheo__text_brief(own[OWN_max_density_error], 3, false, error), own[OWN_max_density_id]);
    snprintf(text + used, size - (size_t)used, " %s may help",
             w->def.melting.substeps ? "More melting.substeps" : "A smaller melting.courant_number");
}

/* ---- Commands ---- */

static rheo_result check_set(const rheo_world *w, const char *path, const rheo_world_def *def, rheo_error *error)
{
    if (def->melting.diffusivity != w->def.melting.diffusivity && !(w->features & RHEO__FEATURE_HEAT))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "%s: no heat flows in this world, which was made %s; make one in which it does", path,
                          w->features & RHEO__FEATURE_TEMPERATURE ? "with a melting.diffusivity of 0"
                                                                  : "without temperatures of particles");
    return RHEO_OK;
}

/* ---- Derived numbers ---- */

static double yield_stress(const rheo_world_def *def)
{
    return def->melting.viscosity / def->melting.time_scale;
}

static double substeps_at_rest(const rheo_world_def *def)
{
    return def->step * def->melting.sound_speed / (def->melting.courant_number * rheo__melting_smoothing_length(def));
}

static const rheo__derived_number DERIVED[] = {
    {"support", "L", "3 melting.smoothing_length", support},
    {"mass", "M", "mass of a particle: melting.rest_density fluid.spacing^3", rheo__melting_mass},
    {"yield", "M/(L T^2)", "melting.viscosity/melting.time_scale, the stress that solid bears", yield_stress},
    {"substeps", "1", "substeps of fluid at rest: step melting.sound_speed/(melting.courant_number h)",
     substeps_at_rest},
};

const rheo__model_type rheo__model_melting = {
    .name = "melting",
    .parameters = &PARAMETERS,
    .check = check,
    .warn = warn,
    .foresee = rheo__melting_foresee,
    .most_substeps = most_substeps,
    .support = support,
    .mass = rheo__melting_mass,
    .refine = refine,
    .smoothing_length = rheo__melting_smoothing_length,
    .density = density,
    .temperature = temperature,
    .possible_features = RHEO__FEATURE_MELTING | RHEO__FEATURE_FLOW | RHEO__FEATURE_TEMPERATURE | RHEO__FEATURE_HEAT |
                         RHEO__FEATURE_VISCOSITY | RHEO__FEATURE_WALLS,
    .fixed_features = RHEO__FEATURE_MELTING | RHEO__FEATURE_FLOW | RHEO__FEATURE_WALLS,
    .features = features,
    .check_features = check_features,
    .fields = fields,
    .size = sizeof(rheo__melting),
    .create = create,
    .configure = configure,
    .working_memory = working_memory,
    .reserve = reserve,
    .release = release,
    .begin_particles = begin_particles,
    .measures = rheo__measures_melting,
    .add_stages = add_stages,
    .metrics = METRIC_ROWS,
    .metric_count = sizeof METRIC_ROWS / sizeof *METRIC_ROWS,
    .measure_state = measure_state,
    .measure_stages = measure_stages,
    .keep_diagnostics = keep_diagnostics,
    .restore_diagnostics = restore_diagnostics,
    .refusals = REFUSALS,
    .describe_failure = describe_failure,
    .check_set = check_set,
    .weight = rheo__melting_weight,
    .weight_name = "W, 1/L^3",
    .density_share = rheo__melting_density_share,
    .counts_itself = true,
    .wall_density = rheo__melting_wall_density,
    .query_particle = rheo__melting_query_particle,
    .quantities = rheo__melting_quantities,
    .rankings = rheo__melting_rankings,
    .derived = DERIVED,
    .derived_count = sizeof DERIVED / sizeof *DERIVED,
};
