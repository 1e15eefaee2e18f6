/*
 * Creates a world from a scene: fills the shapes, lets the fluid settle without ball, vibrators and history, puts the
 * ball above the settled surface, and starts at step 0 with the settled particles. A recording starts after the
 * settling, so a replay never repeats it.
 */
#include <string.h>

#include "core/strict.h"
#include "core/text.h"
#include "scenes/obstacles.h"
#include "scenes/parameters.h"
#include "world/model_list.h"

rheo_scene rheo_default_scene(void)
{
    return rheo_default_model_scene(RHEO__DEFAULT_MODEL);
}

rheo_scene rheo_default_model_scene(rheo_model model)
{
    rheo_scene scene;
    memset(&scene, 0, sizeof scene);
    scene.world = rheo_default_model_def(model);
    rheo__scene_set_defaults(&scene);
    return scene;
}

/* ---- Validation ---- */

/* The definition at the scene's resolution. */
static rheo_result refine(const rheo_scene *scene, rheo_world_def *def, rheo_error *error)
{
    *def = scene->world;
    if (scene->resolution == 1)
        return RHEO_OK;
    const rheo__model_type *type = rheo__model(def->model);
    if (!type->refine)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "resolution is %g; it must be 1, because the model %s cannot change its spacing",
                          scene->resolution, type->name);
    type->refine(def, scene->resolution);
    for (uint32_t k = 0; k < def->emitters.count; k++) { /* the same volume has more particles */
        const double limit =
            (double)def->emitters.list[k].limit * scene->resolution * scene->resolution * scene->resolution;
        def->emitters.list[k].limit = limit < 1 ? 1 : limit < 0x1p30 ? (uint64_t)(limit + 0.5) : UINT64_C(1) << 30;
    }
    rheo_error inner = {""};
    const rheo_result result = rheo_world_def_check(def, &inner);
    return result == RHEO_OK
               ? RHEO_OK
               : rheo__fail(error, result, "at resolution %g: %.470s", scene->resolution, inner.message);
}

rheo_result rheo__scene_check_parameters(const rheo_scene *scene, rheo_world_def *def, rheo_error *error)
{
    RHEO__TRY(rheo_world_def_check(&scene->world, error));
    RHEO__TRY(rheo__scene_parameters_check(scene, error));
    RHEO__TRY(refine(scene, def, error));
    const double steps = scene->settle.time / scene->world.step, most = 1e6;
    if (!(scene->settle.time > most * scene->world.step))
        return RHEO_OK;
    char time[32], number[32], longest[32], shortest[32];
    return rheo__fail(
        error, RHEO_ERROR_ARGUMENT,
        "settle.time is %s, or %s steps; settling has at most a million, so settle.time must be at most "
        "%s, or step at least %s",
        rheo__text_brief(scene->settle.time, 6, false, time), rheo__text_brief(steps, 3, false, number),
        rheo__text_brief(most * scene->world.step, 6, true, longest),
        rheo__text_brief(1.05 * scene->settle.time / most, 2, false, shortest));
}

rheo_result rheo_scene_check(const rheo_scene *scene, rheo_error *error)
{
    uint64_t count;
    rheo_world_def def;
    RHEO__TRY(rheo__scene_check_parameters(scene, &def, error));
    rheo__scene_obstacles obstacles;
    const rheo_result result = rheo__scene_obstacles_open(&obstacles, &scene->world.allocator, &def, error);
    rheo__scene_obstacles_close(&obstacles);
    return result == RHEO_OK ? rheo_scene_particle_count(scene, &count, error) : result;
}

/* ---- The world ---- */

typedef struct making {
    rheo_allocator allocator;
    rheo__filling filling;
    rheo_real *position, *velocity, *density, *temperature, *rest_length;
    uint32_t *ends, *material;
    rheo_world *settled;
    rheo__scene_obstacles obstacles;
} making;

/* Creates the particles. Fields that the model or the scene does not have stay NULL. */
static rheo_result fill(making *m, rheo_world_def *def, rheo_error *error)
{
    const size_t count = (size_t)m->filling.count;
    const rheo__model_type *type = rheo__model(def->model);
    const bool densities = type->density != NULL, temperatures = type->temperature && m->filling.has_temperatures,
               materials = def->materials.count > 0;
    m->position = rheo__allocate(&m->allocator, count, 3 * sizeof *m->position);
    m->velocity = rheo__allocate(&m->allocator, count, 3 * sizeof *m->velocity);
    if (densities)
        m->density = rheo__allocate(&m->allocator, count, sizeof *m->density);
    if (temperatures)
        m->temperature = rheo__allocate(&m->allocator, count, sizeof *m->temperature);
    if (materials)
        m->material = rheo__allocate(&m->allocator, count, sizeof *m->material);
    if (!m->position || !m->velocity || (materials && !m->material) || (densities && !m->density) ||
        (temperatures && !m->temperature))
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for %zu particles", count);
    RHEO__TRY(
        rheo__filling_make(&m->filling, m->position, m->velocity, m->density, m->temperature, m->material, error));
    def->particles.count = (uint32_t)count;
    def->particles.position = m->position;
    def->particles.velocity = m->velocity;
    def->particles.density = m->density;
    def->particles.temperature = m->temperature;
    def->particles.material = m->material;
    return RHEO_OK;
}

/* Fills the shapes and examines them. The definition is complete up to settling. */
static rheo_result make_particles(const rheo_scene *scene, rheo_world_def *def, making *m, rheo__warnings *warnings,
                                  rheo_error *error)
{
    RHEO__TRY(rheo__scene_obstacles_open(&m->obstacles, &m->allocator, def, error));
    RHEO__TRY(rheo__filling_open(&m->filling, scene, error));
    def->fluid.spacing = m->filling.spacing;
    if (scene->particles) /* the spacing is another */
        RHEO__TRY(rheo_world_def_check(def, error));
    RHEO__TRY(fill(m, def, error));
    rheo_world_def placed = *def;
    RHEO__TRY(rheo__place_balls(scene, &m->allocator, &placed, error));
    if (def->obstacles.count)
        rheo__check_obstacles(&m->obstacles, &m->filling, def, warnings);
    return rheo__check_filled(&m->filling, &placed, warnings, error);
}

static rheo_result settle(const rheo_scene *scene, rheo_world_def *def, making *m, rheo__warnings *warnings,
                          rheo_error *error)
{
    RHEO__TRY(rheo__settle(scene, def, warnings, &m->settled, error));
    rheo__state *settled = &m->settled->state;
    const size_t springs = settled->springs.count, bytes = 3 * (size_t)def->particles.count * sizeof *m->position;
    memcpy(m->position, settled->position, bytes);
    memcpy(m->velocity, settled->velocity, bytes);
    if (springs) {
        /* Sorting springs takes memory; what the last step leaves behind is no longer needed. */
        rheo__springs_release(&settled->springs_next, &settled->allocator);
        m->ends = rheo__allocate(&m->allocator, springs, 2 * sizeof *m->ends);
        m->rest_length = rheo__allocate(&m->allocator, springs, sizeof *m->rest_length);
        if (!m->ends || !m->rest_length ||
            !rheo__springs_read(&settled->springs, &m->allocator, m->ends, m->rest_length))
            return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for %zu springs", springs);
        def->particles.spring_count = (uint32_t)springs;
        def->particles.spring_ends = m->ends;
        def->particles.spring_rest_length = m->rest_length;
    }
    /* A large scene should not be in memory twice. */
    rheo_world_destroy(m->settled);
    m->settled = NULL;
    return RHEO_OK;
}

static rheo_result make(const rheo_scene *scene, rheo_world_def def, making *m, rheo_world **world, rheo_error *error)
{
    rheo__warnings warnings = {.log = def.log, .refusals_only = !def.log.message};
    RHEO__TRY(make_particles(scene, &def, m, &warnings, error));
    RHEO__TRY(rheo__refuse(&warnings, error));
    if (scene->settle.time > 0)
        RHEO__TRY(settle(scene, &def, m, &warnings, error));
    RHEO__TRY(rheo__place_balls(scene, &m->allocator, &def, error));
    rheo__check_balls(&m->filling, &def, &warnings);
    RHEO__TRY(rheo_world_def_check(&def, error));
    return rheo__world_make(&def, rheo__world_features(&def), world, error); /* its warnings have been given */
}

static void release(making *m)
{
    rheo_world_destroy(m->settled);
    rheo__scene_obstacles_close(&m->obstacles);
    rheo__filling_close(&m->filling);
    rheo__release(&m->allocator, m->position);
    rheo__release(&m->allocator, m->velocity);
    rheo__release(&m->allocator, m->density);
    rheo__release(&m->allocator, m->temperature);
    rheo__release(&m->allocator, m->rest_length);
    rheo__release(&m->allocator, m->ends);
    rheo__release(&m->allocator, m->material);
}

rheo_result rheo_scene_create_world(const rheo_scene *scene, rheo_world **world, rheo_error *error)
{
    rheo_world_def def;
    *world = NULL;
    RHEO__TRY(rheo__scene_check_parameters(scene, &def, error));
    making m = {.allocator = rheo__allocator_or_default(scene->world.allocator)};
    const rheo_result result = make(scene, def, &m, world, error);
    release(&m);
    return result;
}

rheo_result rheo_scene_warnings(const rheo_scene *scene, rheo_warning *warnings, size_t capacity, size_t *count,
                                rheo_error *error)
{
    rheo_world_def def;
    *count = 0;
    RHEO__TRY(rheo__scene_check_parameters(scene, &def, error));
    making m = {.allocator = rheo__allocator_or_default(scene->world.allocator)};
    rheo__warnings found = {.list = warnings, .capacity = capacity};
    rheo_result result = make_particles(scene, &def, &m, &found, error);
    if (result == RHEO_OK)
        result = rheo__place_balls(scene, &m.allocator, &def, error);
    if (result == RHEO_OK)
        rheo__check_balls(&m.filling, &def, &found);
    release(&m);
    *count = found.count;
    return result;
}
