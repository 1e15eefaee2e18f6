/* Definitions: defaults, validation, derived numbers and warnings. */
#include "world/model.h"
#include "world/model_list.h"

#include <stdio.h>
#include <string.h>

#include "world/emitters.h"
#include "world/measure.h"

static const uint32_t COOKIE = 0x52484C47;

rheo_world_def rheo_default_model_def(rheo_model model)
{
    rheo_world_def def;
    memset(&def, 0, sizeof def);
    rheo__parameters_set_defaults(&def, model);
    def.cookie = COOKIE;
    return def;
}

rheo_world_def rheo_default_world_def(void)
{
    return rheo_default_model_def(RHEO__DEFAULT_MODEL);
}

/* ---- Arrays ---- */

static void *copy_of(const rheo_allocator *allocator, const void *items, size_t count, size_t size)
{
    void *copy = count ? rheo__allocate(allocator, count, size) : NULL;
    return copy ? memcpy(copy, items, count * size) : NULL;
}

bool rheo__def_copy_arrays(rheo_world_def *own, const rheo_world_def *def)
{
    own->walls.plane = copy_of(&own->allocator, def->walls.plane, def->walls.count, sizeof *def->walls.plane);
    own->vibrators.position =
        copy_of(&own->allocator, def->vibrators.position, def->vibrators.count, sizeof *def->vibrators.position);
    bool meshes = true;
    for (uint32_t k = 0; k < def->obstacles.count; k++) {
        const rheo_obstacle *from = &def->obstacles.list[k];
        rheo_obstacle *to = &own->obstacles.list[k];
        const uint32_t vertices = from->mesh.vertex_count, triangles = from->mesh.triangle_count;
        to->mesh.vertex = copy_of(&own->allocator, from->mesh.vertex, vertices, sizeof *to->mesh.vertex);
        to->mesh.triangle = copy_of(&own->allocator, from->mesh.triangle, triangles, sizeof *to->mesh.triangle);
        meshes = meshes && (to->mesh.vertex || !vertices) && (to->mesh.triangle || !triangles);
    }
    own->history.curve =
        copy_of(&own->allocator, def->history.curve, def->history.curve_count, sizeof *def->history.curve);
    return meshes && (own->walls.plane || !def->walls.count) && (own->vibrators.position || !def->vibrators.count) &&
           (own->history.curve || !def->history.curve_count);
}

void rheo__def_release_arrays(rheo_world_def *own)
{
    rheo__release(&own->allocator, (void *)(uintptr_t)own->walls.plane);
    rheo__release(&own->allocator, (void *)(uintptr_t)own->vibrators.position);
    rheo__release(&own->allocator, (void *)(uintptr_t)own->history.curve);
    for (uint32_t k = 0; k < own->obstacles.count; k++) {
        rheo__release(&own->allocator, (void *)(uintptr_t)own->obstacles.list[k].mesh.vertex);
        rheo__release(&own->allocator, (void *)(uintptr_t)own->obstacles.list[k].mesh.triangle);
    }
}

/* ---- Validation ---- */

/* A time is at least a step when rounded: one that became nothing would be lost unnoticed. */
static rheo_result to_steps(const char *path, double step, uint32_t *steps, double *seconds, rheo_error *error)
{
    const double exact = *seconds / step;
    if (!(*seconds > 0))
        return RHEO_OK;
    if (!(exact >= 0.5 && exact <= 1e6))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "%s is %g s, %g steps of %g; it must be from 1 to 1000000 steps", path, *seconds, exact,
                          step);
    *steps = (uint32_t)(exact + 0.5);
    *seconds = 0;
    return RHEO_OK;
}

rheo_result rheo__def_in_steps(rheo_world_def *def, rheo_error *error)
{
    if (def->history.curve_count) {
        def->history.window = rheo_history_curve_window(def->history.curve, def->history.curve_count, def->step);
        def->history.window_seconds = 0;
    }
    RHEO__TRY(to_steps("history.window", def->step, &def->history.window, &def->history.window_seconds, error));
    return to_steps("history.lag", def->step, &def->history.lag, &def->history.lag_seconds, error);
}

static rheo_result check_walls(const rheo_world_def *def, rheo_error *error)
{
    if (def->walls.count > RHEO_MAX_WALLS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there are %u walls; at most %d are possible", def->walls.count,
                          RHEO_MAX_WALLS);
    if (def->walls.count && !def->walls.plane)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "walls.plane is NULL; it must hold %u walls", def->walls.count);
    for (uint32_t w = 0; w < def->walls.count; w++) {
        const double *n = def->walls.plane[w].normal, *p = def->walls.plane[w].point;
        double length2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        if (!(length2 > 1e-100 && length2 < 1e100))
            return rheo__fail(
                error, RHEO_ERROR_ARGUMENT,
                "walls: the normal of wall %u is [%g, %g, %g]; it must be a finite vector other than zero", w, n[0],
                n[1], n[2]);
        for (int axis = 0; axis < 3; axis++)
            if (!(p[axis] > -1e30 && p[axis] < 1e30))
                return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                                  "walls: the point of wall %u is [%g, %g, %g]; it must be finite", w, p[0], p[1],
                                  p[2]);
    }
    return RHEO_OK;
}

static rheo_result check_vibrators(const rheo_world_def *def, rheo_error *error)
{
    if (def->vibrators.count > RHEO_MAX_VIBRATORS)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there are %u vibrators; at most %d are possible",
                          def->vibrators.count, RHEO_MAX_VIBRATORS);
    if (def->vibrators.count && !def->vibrators.position)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "vibrators.position is NULL; it must hold %u x 2 values",
                          def->vibrators.count);
    for (uint32_t i = 0; i < def->vibrators.count; i++)
        for (int axis = 0; axis < 2; axis++)
            if (!(def->vibrators.position[i][axis] > -1e30 && def->vibrators.position[i][axis] < 1e30))
                return rheo__fail(error, RHEO_ERROR_ARGUMENT, "vibrators: position %u is not finite", i);
    if (def->vibrators.count && def->vibrators.kind == RHEO_VIBRATOR_FLOOR) {
        bool floor = false;
        for (uint32_t w = 0; w < def->walls.count; w++) {
            const double *n = def->walls.plane[w].normal;
            floor = floor || (n[0] == 0 && n[1] > 0 && n[2] == 0);
        }
        if (!floor)
            return rheo__fail(
                error, RHEO_ERROR_ARGUMENT,
                "vibrators.kind is floor, but no wall is a level floor; give one with the normal [0, 1, 0], "
                "or set vibrators.kind to force");
    }
    return RHEO_OK;
}

rheo_result rheo__def_check_particles(const rheo_world_def *def, rheo_error *error)
{
    uint32_t count = def->particles.count;
    if (count > (1u << 30))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there are %u particles; at most 2^30 are possible", count);
    if (count && !def->particles.position)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "particles.position is NULL; it must hold %u x 3 values",
                          count);
    for (size_t i = 0; i < 3 * (size_t)count; i++) {
        rheo_real x = def->particles.position[i], v = def->particles.velocity ? def->particles.velocity[i] : 0;
        if (x - x != 0 || v - v != 0)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the %s of particle %zu is not finite",
                              x - x != 0 ? "position" : "velocity", i / 3);
    }
    const rheo_real *density = def->particles.density, *temperature = def->particles.temperature;
    for (size_t i = 0; i < count; i++) {
        if (density && !(density[i] > 0 && density[i] - density[i] == 0))
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the density of particle %zu is not above 0 and finite", i);
        if (temperature && temperature[i] - temperature[i] != 0)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the temperature of particle %zu is not finite", i);
    }
    RHEO__TRY(rheo__materials_check_particles(def, error));
    uint32_t springs = def->particles.spring_count;
    const uint32_t *ends = def->particles.spring_ends;
    if (springs && (!ends || !def->particles.spring_rest_length))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "particles.spring_ends or spring_rest_length is NULL");
    for (size_t k = 0; k < springs; k++) {
        uint32_t a = ends[2 * k], b = ends[2 * k + 1];
        rheo_real length = def->particles.spring_rest_length[k];
        if (a >= b || b >= count)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                              "spring %zu connects %u and %u; ends are two particles, the smaller id first", k, a, b);
        if (k && (a < ends[2 * k - 2] || (a == ends[2 * k - 2] && b <= ends[2 * k - 1])))
            return rheo__fail(
                error, RHEO_ERROR_ARGUMENT,
                "spring %zu is out of order; springs ascend by smaller, then by larger id, without repeats", k);
        if (!(length >= 0) || length - length != 0)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the rest length of spring %zu is not a finite length", k);
    }
    return RHEO_OK;
}

/*
 * Checks the definition by the rules of its model. It must not have objects or arrays that the model does not have.
 */
static rheo_result check_model(const rheo_world_def *def, rheo_error *error)
{
    const rheo__model_type *type = rheo__model(def->model);
    const uint32_t possible = type->possible_features;
    const char *missing = def->ball.radius > 0 && !(possible & RHEO__FEATURE_BALL)                 ? "ball"
                          : def->vibrators.count > 0 && !(possible & RHEO__FEATURE_VIBRATORS)      ? "vibrators"
                          : def->particles.spring_count > 0 && !(possible & RHEO__FEATURE_SPRINGS) ? "springs"
                          : def->obstacles.count > 0 && !(possible & RHEO__FEATURE_OBSTACLES)      ? "obstacles"
                          : def->history.curve_count > 0 && !(possible & RHEO__FEATURE_HISTORY)    ? "history.curve"
                          : def->particles.density && !type->density         ? "densities of particles"
                          : def->particles.temperature && !type->temperature ? "temperatures of particles"
                          : def->materials.count > 0 && !type->materials     ? "materials"
                                                                             : NULL;
    if (missing)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the model %s has no %s; the definition gives some", type->name,
                          missing);
    return type->check ? type->check(def, error) : RHEO_OK;
}

rheo_result rheo_world_def_check(const rheo_world_def *def, rheo_error *error)
{
    if (!def || def->cookie != COOKIE)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the definition has not been initialised; start from rheo_default_world_def()");
    RHEO__TRY(rheo__parameters_check(def, error));
    rheo_world_def in_steps = *def;
    RHEO__TRY(rheo__def_in_steps(&in_steps, error));
    RHEO__TRY(check_walls(def, error));
    RHEO__TRY(check_vibrators(def, error));
    RHEO__TRY(check_model(def, error));
    RHEO__TRY(rheo__emitters_check(def, error));
    return rheo__def_check_particles(def, error);
}

/* ---- Derived numbers ---- */

double rheo__def_support(const rheo_world_def *def)
{
    return rheo__model(def->model)->support(def);
}

double rheo__def_mass(const rheo_world_def *def)
{
    const rheo__model_type *type = rheo__model(def->model);
    return type->mass ? type->mass(def) : 1;
}

bool rheo_world_def_derived(const rheo_world_def *def, uint32_t index, rheo_derived *derived)
{
    const rheo__model_type *type = rheo__model(def->model);
    if (index >= type->derived_count)
        return false;
    const rheo__derived_number *row = &type->derived[index];
    *derived = (rheo_derived){row->name, row->unit, row->meaning, row->value(def)};
    return true;
}

/* ---- Warnings ---- */

/* Passes a message on as a warning. user: the log. */
static void say_warning(const char *message, void *user)
{
    const rheo_log *log = user;
    char text[640];
    snprintf(text, sizeof text, "warning: %s", message);
    log->message(text, log->user);
}

static double max_speed(const rheo_world_def *def)
{
    double fastest = 0;
    for (size_t i = 0; def->particles.velocity && i < def->particles.count; i++) {
        const rheo_real *v = def->particles.velocity + 3 * i;
        const double x = (double)v[0], y = (double)v[1], z = (double)v[2], speed2 = x * x + y * y + z * z;
        fastest = speed2 > fastest ? speed2 : fastest;
    }
    return __builtin_sqrt(fastest);
}

void rheo__def_warn(const rheo_world_def *def)
{
    const rheo__model_type *type = rheo__model(def->model);
    const rheo__measures *measures = rheo__measures_of(def);
    if (!def->log.message)
        return;
    rheo_log log = def->log;
    rheo_world_def warned = *def;
    warned.log = (rheo_log){say_warning, &log};
    const double fastest = max_speed(def);
    for (uint32_t row = 0; row < measures->count; row++) {
        rheo__condition condition;
        char text[512];
        if (!rheo__condition_of(def, (rheo__known_speeds){.fluid = fastest}, row, &condition))
            continue;
        rheo__condition_tell(&condition, text, sizeof text);
        say_warning(text, &log);
    }
    if (type->warn)
        type->warn(&warned);
}
