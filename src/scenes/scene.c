/*
 * Creates a world from a scene: fills the shapes, lets the fluid settle without ball, vibrators and history, puts the
 * ball above the settled surface, and starts at step 0 with the settled particles. A recording starts after the
 * settling, so a replay never repeats it.
 */
#include <stdio.h>
#include <string.h>

#include "core/strict.h"
#include "scenes/fill.h"
#include "scenes/parameters.h"
#include "world/model.h"
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
    rheo_error inner = {""};
    const rheo_result result = rheo_world_def_check(def, &inner);
    return result == RHEO_OK
               ? RHEO_OK
               : rheo__fail(error, result, "at resolution %g: %.470s", scene->resolution, inner.message);
}

static rheo_result check(const rheo_scene *scene, rheo_world_def *def, rheo_error *error)
{
    RHEO__TRY(rheo_world_def_check(&scene->world, error));
    RHEO__TRY(rheo__scene_parameters_check(scene, error));
    RHEO__TRY(refine(scene, def, error));
    if (scene->settle.time > 1e6 * scene->world.step)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "settle.time is %g; it must be from 0 to a million steps",
                          scene->settle.time);
    return RHEO_OK;
}

rheo_result rheo_scene_check(const rheo_scene *scene, rheo_error *error)
{
    uint64_t count;
    rheo_world_def def;
    RHEO__TRY(check(scene, &def, error));
    return rheo_scene_particle_count(scene, &count, error);
}

/* ---- Settling ---- */

static rheo_result settle(const rheo_scene *scene, const rheo_world_def *def, rheo_world **settled, rheo_error *error)
{
    rheo_world_def still = *def;
    still.ball.radius = 0;
    still.vibrators.count = 0;
    still.history.stiffness = 0;
    still.springs.yield_ratio = 0; /* springs at rest carry no stress */
    still.log = (rheo_log){NULL, NULL};
    rheo_world *world;
    RHEO__TRY(rheo__def_check_particles(&still, error)); /* all else was checked earlier, before filling */
    RHEO__TRY(rheo__world_make(&still, rheo__world_features(&still), &world, error));
    uint64_t steps = (uint64_t)(scene->settle.time / def->step + 0.5);
    uint64_t damped = (uint64_t)(scene->settle.fraction * (double)steps + 0.5);
    const rheo_real damping = 1 / (1 + (rheo_real)(scene->settle.damping * def->step));
    if (def->log.message && steps) {
        char text[96];
        snprintf(text, sizeof text, "settling %u particles for %llu steps", def->particles.count,
                 (unsigned long long)steps);
        def->log.message(text, def->log.user);
    }
    for (uint64_t i = 0; i < steps; i++) {
        rheo_error inner;
        rheo_result result = rheo_world_step(world, &inner);
        if (result != RHEO_OK) {
            rheo_world_destroy(world);
            return rheo__fail(error, result, "while settling: %.480s", inner.message);
        }
        for (size_t k = 0; i < damped && k < 3 * (size_t)def->particles.count; k++)
            world->state.velocity[k] *= damping;
    }
    *settled = world;
    return RHEO_OK;
}

/* ---- Surface of the fluid ---- */

typedef struct bounds {
    double low[3], high[3];
} bounds;

static bounds bounds_of(const rheo_real *position, uint32_t count)
{
    bounds b;
    for (int axis = 0; axis < 3; axis++) {
        b.low[axis] = (double)position[axis];
        b.high[axis] = (double)position[axis];
        for (size_t i = 0; i < count; i++) {
            double x = (double)position[3 * i + (size_t)axis];
            b.low[axis] = x < b.low[axis] ? x : b.low[axis];
            b.high[axis] = x > b.high[axis] ? x : b.high[axis];
        }
    }
    return b;
}

/* The settled fluid below a ball. */
typedef struct surface {
    double height;         /* of the surface */
    double number_density; /* inside the fluid; 0: there is no inside */
} surface;

/*
 * A window of an axis: 0 outside, 1 inside, and a ramp as wide as the support at both ends. The ramp evens out the
 * layers that particles form along walls.
 */
typedef struct window {
    double low, high, ramp; /* middles of the ramps */
} window;

static double rise(double from_middle, double ramp)
{
    const double share = 0.5 + from_middle / ramp;
    return share < 0 ? 0 : share > 1 ? 1 : share;
}

static double weight(const window *w, double x)
{
    const double up = rise(x - w->low, w->ramp), down = rise(w->high - x, w->ramp);
    return up < down ? up : down;
}

/*
 * The level at which the fluid would end if its density were everywhere that of the upper half: below a surface of
 * particles, a mean height of the topmost ones would depend on how rough it is. False: too shallow or too narrow.
 */
static bool find_level(const rheo_real *position, uint32_t count, const bounds *b, double support, surface *found)
{
    enum { FEW = 64 };
    const double middle = 0.5 * (b->low[1] + b->high[1]);
    window inner[3];
    double area = 1, inside = 0, above = 0;
    for (int axis = 0; axis < 3; axis++) {
        inner[axis] =
            (window){axis == 1 ? middle : b->low[axis] + 1.5 * support, b->high[axis] - 1.5 * support, support};
        if (!(inner[axis].high - inner[axis].low >= support))
            return false;
        area *= axis == 1 ? 1 : inner[axis].high - inner[axis].low;
    }
    for (size_t i = 0; i < count; i++) {
        const double y = (double)position[3 * i + 1];
        const double column =
            weight(&inner[0], (double)position[3 * i]) * weight(&inner[2], (double)position[3 * i + 2]);
        inside += column * weight(&inner[1], y);
        above += column * rise(y - middle, support);
    }
    if (!(inside >= FEW))
        return false;
    found->number_density = inside / (area * (inner[1].high - inner[1].low));
    found->height = middle + above / (area * found->number_density);
    return true;
}

/* Of fluid that is no pool: the mean height of the highest particles of columns one support wide. False: no memory. */
static bool find_surface(const rheo_allocator *allocator, const rheo_real *position, uint32_t count, double support,
                         surface *found)
{
    *found = (surface){0, 0};
    if (count == 0)
        return true;
    bounds b = bounds_of(position, count);
    double wide = (b.high[0] - b.low[0]) / support, deep = (b.high[2] - b.low[2]) / support;
    if (!((wide + 1) * (deep + 1) <= 1024 + 16.0 * count)) { /* scattered particles have no surface */
        found->height = b.high[1];
        return true;
    }
    size_t columns_x = (size_t)wide + 1, columns = columns_x * ((size_t)deep + 1);
    double *top = rheo__allocate(allocator, columns, sizeof *top);
    uint8_t *filled = rheo__allocate(allocator, columns, 1);
    bool enough = top && filled;
    for (size_t i = 0; enough && i < count; i++) {
        size_t x = (size_t)(((double)position[3 * i] - b.low[0]) / support);
        size_t z = (size_t)(((double)position[3 * i + 2] - b.low[2]) / support);
        size_t column = z * columns_x + x;
        double y = (double)position[3 * i + 1];
        if (!filled[column] || y > top[column])
            top[column] = y;
        filled[column] = 1;
    }
    double sum = 0;
    size_t used = 0;
    for (size_t c = 0; enough && c < columns; c++)
        if (filled[c]) {
            sum += top[c];
            used++;
        }
    if (used)
        found->height = sum / (double)used;
    if (enough && used == columns)
        find_level(position, count, &b, support, found);
    rheo__release(allocator, top);
    rheo__release(allocator, filled);
    return enough;
}

/* ---- The world ---- */

typedef struct making {
    rheo_allocator allocator;
    rheo__filling filling;
    rheo_real *position, *velocity, *density, *temperature, *rest_length;
    uint32_t *ends;
    rheo_world *settled;
} making;

/* Creates the particles. Fields that the model or the scene does not have stay NULL. */
static rheo_result fill(making *m, rheo_world_def *def, rheo_error *error)
{
    const size_t count = (size_t)m->filling.count;
    const rheo__model_type *type = rheo__model(def->model);
    const bool densities = type->density != NULL, temperatures = type->temperature && m->filling.has_temperatures;
    if (count == 0 && m->filling.scene->fill_count > 0 && def->log.message)
        def->log.message("the shapes are too small to hold a particle at this spacing", def->log.user);
    m->position = rheo__allocate(&m->allocator, count + 1, 3 * sizeof *m->position);
    m->velocity = rheo__allocate(&m->allocator, count + 1, 3 * sizeof *m->velocity);
    if (densities)
        m->density = rheo__allocate(&m->allocator, count + 1, sizeof *m->density);
    if (temperatures)
        m->temperature = rheo__allocate(&m->allocator, count + 1, sizeof *m->temperature);
    if (!m->position || !m->velocity || (densities && !m->density) || (temperatures && !m->temperature))
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for %zu particles", count);
    RHEO__TRY(rheo__filling_make(&m->filling, m->position, m->velocity, m->density, m->temperature, error));
    def->particles.count = (uint32_t)count;
    def->particles.position = m->position;
    def->particles.velocity = m->velocity;
    def->particles.density = m->density;
    def->particles.temperature = m->temperature;
    return RHEO_OK;
}

static rheo_result make(const rheo_scene *scene, rheo_world_def def, making *m, rheo_world **world, rheo_error *error)
{
    RHEO__TRY(rheo__filling_open(&m->filling, scene, error));
    def.fluid.spacing = m->filling.spacing;
    if (scene->particles) /* the spacing is another */
        RHEO__TRY(rheo_world_def_check(&def, error));
    RHEO__TRY(fill(m, &def, error));
    const uint32_t count = def.particles.count;
    if (scene->settle.time > 0) {
        RHEO__TRY(settle(scene, &def, &m->settled, error));
        rheo__state *settled = &m->settled->state;
        const size_t springs = settled->springs.count, bytes = 3 * (size_t)count * sizeof *m->position;
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
            def.particles.spring_count = (uint32_t)springs;
            def.particles.spring_ends = m->ends;
            def.particles.spring_rest_length = m->rest_length;
        }
        /* A large scene should not be in memory twice. */
        rheo_world_destroy(m->settled);
        m->settled = NULL;
    }
    if (def.ball.radius > 0) {
        surface found;
        if (!find_surface(&m->allocator, def.particles.position, count, def.fluid.support, &found))
            return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to find the surface of %u particles", count);
        if (def.fluid.number_density == 0)
            def.fluid.number_density = found.number_density;
        if (scene->ball.clearance >= 0)
            def.ball.position[1] = found.height + scene->ball.clearance + def.ball.radius;
    }
    return rheo_world_create(&def, world, error);
}

rheo_result rheo_scene_create_world(const rheo_scene *scene, rheo_world **world, rheo_error *error)
{
    rheo_world_def def;
    *world = NULL;
    RHEO__TRY(check(scene, &def, error));
    making m = {.allocator = rheo__allocator_or_default(scene->world.allocator)};
    rheo_result result = make(scene, def, &m, world, error);
    rheo_world_destroy(m.settled);
    rheo__filling_close(&m.filling);
    rheo__release(&m.allocator, m.position);
    rheo__release(&m.allocator, m.velocity);
    rheo__release(&m.allocator, m.density);
    rheo__release(&m.allocator, m.temperature);
    rheo__release(&m.allocator, m.rest_length);
    rheo__release(&m.allocator, m.ends);
    return result;
}
