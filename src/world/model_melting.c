/* The melting model as the world sees it (world/model.h): what a definition needs, memory, and the list of stages. */
#include "world/model_melting.h"

#include <stdio.h>

#include "core/text.h"
#include "solids/solids.h"

/* ---- Definitions ---- */

static rheo_result check(const rheo_world_def *def, rheo_error *error)
{
    if (!(def->melting.temperature_min < def->melting.temperature_max))
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "melting.temperature_min is %g and melting.temperature_max %g; melting must end above where it "
            "begins",
            def->melting.temperature_min, def->melting.temperature_max);
    /* The slope of the kernel, 1/(120 pi h^5), is kept in the number type of the state. */
    const double h = rheo__melting_smoothing_length(def), shortest = RHEO_DOUBLE ? 1e-12 : 3e-8,
                 longest = RHEO_DOUBLE ? 1e12 : 4e5;
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
    const double compressed = compression(def);
    if (!(compressed > 0.03 && def->melting.flow == RHEO_FLOW_ON))
        return;
    char text[256], percent[32];
    rheo__text_from_double(100 * compressed, percent);
    snprintf(text, sizeof text,
             "melting.sound_speed is too small for the depth of this fluid: its own weight compresses it by %.6s %%; "
             "ten times the speed of a fall from its top keeps that below 1 %%",
             percent);
    def->log.message(text, def->log.user);
}

static double support(const rheo_world_def *def)
{
    return 3 * rheo__melting_smoothing_length(def);
}

static double mass(const rheo_world_def *def)
{
    const double spacing = def->fluid.spacing;
    return def->melting.rest_density * spacing * spacing * spacing;
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
    if (def->particles.temperature)
        needed |= RHEO__FEATURE_TEMPERATURE | (def->melting.diffusivity > 0 ? RHEO__FEATURE_HEAT : 0);
    return needed;
}

static bool check_features(uint32_t features)
{
    const bool flow = features & RHEO__FEATURE_FLOW, viscosity = features & RHEO__FEATURE_VISCOSITY,
               temperature = features & RHEO__FEATURE_TEMPERATURE, heat = features & RHEO__FEATURE_HEAT;
    return (temperature || !heat) && (flow || !viscosity);
}

static uint32_t fields(uint32_t features, const rheo_world_def *def)
{
    (void)def;
    return RHEO__BIT(density) | RHEO__BIT(start_position) | RHEO__BIT(substeps) | RHEO__BIT(iterations) |
           (features & RHEO__FEATURE_TEMPERATURE ? RHEO__BIT(temperature) : 0);
}

/* ---- Memory ---- */

static bool create(rheo_world *w)
{
    rheo__melting *m = w->model;
    m->allocator = w->def.allocator;
    m->heat = w->features & RHEO__FEATURE_HEAT;
    m->diagnostics.max_density_id = -1;
    return true;
}

static bool configure(rheo_world *w)
{
    rheo__melting_configure(w->model, &w->def);
    return true;
}

static bool reserve(rheo_world *w, uint32_t particles)
{
    return rheo__melting_reserve(w->model, particles);
}

static void release(rheo_world *w)
{
    rheo__melting_release(w->model);
}

static void begin_particles(rheo_world *w, uint32_t first, const rheo_real *density, const rheo_real *temperature)
{
    rheo__state *s = &w->state;
    for (uint32_t i = first; i < s->particles; i++) {
        s->density[i] = density ? density[i - first] : (rheo_real)w->def.melting.rest_density;
        if (rheo__state_has(s, RHEO__FIELD_temperature))
            s->temperature[i] = temperature ? temperature[i - first] : (rheo_real)w->def.melting.temperature;
        for (size_t axis = 0; axis < 3; axis++)
            s->start_position[3 * (size_t)i + axis] = s->position[3 * (size_t)i + axis];
    }
}

/* ---- Stages ---- */

/* Stages after `substeps` run in every substep. In a frozen world the neighbours stay the same. */
static void add_stages(rheo_world *w)
{
    const bool flow = w->features & RHEO__FEATURE_FLOW, heat = w->features & RHEO__FEATURE_HEAT;
    const uint32_t velocity = RHEO__BIT(velocity), position = RHEO__BIT(position), density = RHEO__BIT(density);
    const bool summation = w->def.melting.density == RHEO_DENSITY_SUMMATION, leapfrog = w->def.paper.leapfrog;
    void *m = w->model;
    if (!flow && heat)
        rheo__world_add_stage(w, "neighbours", rheo__stage_melting_neighbours, m, 0);
    rheo__world_add_stage(w, "substeps", rheo__stage_substeps, m, RHEO__BIT(substeps) | RHEO__BIT(iterations));
    if (flow) {
        rheo__world_add_stage(w, "neighbours", rheo__stage_melting_neighbours, m, 0);
        if (summation)
            rheo__world_add_stage(w, "summation", rheo__stage_summation, m, density);
        if (leapfrog)
            rheo__world_add_stage(w, "rates", rheo__stage_rates, m, 0);
        rheo__world_add_stage(w, "momentum", rheo__stage_momentum, m, velocity);
        if (w->features & RHEO__FEATURE_VISCOSITY)
            rheo__world_add_stage(w, "viscosity", rheo__stage_viscous, m, velocity | RHEO__BIT(iterations));
    }
    if ((flow && !leapfrog) || (!flow && heat))
        rheo__world_add_stage(w, "rates", rheo__stage_rates, m, 0);
    if (flow || heat)
        rheo__world_add_stage(w, "integration", rheo__stage_integration, m,
                              (flow ? position | (summation ? 0 : density) | (w->def.paper.xsph ? velocity : 0) : 0) |
                                  (heat ? RHEO__BIT(temperature) : 0));
    if (w->features & RHEO__FEATURE_WALLS)
        rheo__world_add_stage(w, "walls", rheo__stage_walls, w->solids, position | velocity);
}

const rheo__model_type rheo__model_melting = {
    .name = "melting",
    .check = check,
    .warn = warn,
    .support = support,
    .mass = mass,
    .has_density = true,
    .has_temperature = true,
    .possible_features = RHEO__FEATURE_MELTING | RHEO__FEATURE_FLOW | RHEO__FEATURE_TEMPERATURE | RHEO__FEATURE_HEAT |
                         RHEO__FEATURE_VISCOSITY | RHEO__FEATURE_WALLS,
    .fixed_features = RHEO__FEATURE_MELTING | RHEO__FEATURE_FLOW | RHEO__FEATURE_WALLS,
    .features = features,
    .check_features = check_features,
    .fields = fields,
    .size = sizeof(rheo__melting),
    .create = create,
    .configure = configure,
    .reserve = reserve,
    .release = release,
    .begin_particles = begin_particles,
    .add_stages = add_stages,
};
