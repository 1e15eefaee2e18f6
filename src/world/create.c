/* Makes and destroys worlds: fields, memory, the first state, and the list of stages that the model fills. */
#include "world/model.h"

#include <assert.h>
#include <string.h>

#include "core/environment.h"
#include "solids/solids.h"
#include "world/command_queue.h"
#include "world/stage_runs.h"

/* ---- Features, fields and stages ---- */

uint32_t rheo__world_features(const rheo_world_def *def)
{
    return rheo__model(def->model)->features(def) | (def->emitters.count ? RHEO__FEATURE_EMITTERS : 0);
}

static rheo_result check_features(const rheo_world_def *def, uint32_t features, rheo_error *error)
{
    const rheo__model_type *type = rheo__model(def->model);
    const uint32_t needed = rheo__world_features(def);
    if ((needed & ~features) || ((needed ^ features) & (type->fixed_features | RHEO__FEATURE_EMITTERS)) ||
        (features & ~(type->possible_features | RHEO__FEATURE_EMITTERS)) ||
        (type->check_features && !type->check_features(def, features)))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the features %#x are not those of a world of this definition, %#x", (unsigned)features,
                          (unsigned)needed);
    if (def->particles.spring_count && !(features & RHEO__FEATURE_SPRINGS))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "springs are given, but springs.stiffness is 0");
    return RHEO_OK;
}

rheo__fields rheo__world_fields(const rheo_world_def *def, uint32_t features)
{
    const rheo__model_type *type = rheo__model(def->model);
    rheo__fields present =
        RHEO__BIT(step) | RHEO__BIT(step_origin) | RHEO__BIT(time_origin) | RHEO__BIT(position) | RHEO__BIT(velocity);
    if (features & RHEO__FEATURE_BALL)
        present |=
            RHEO__BIT(ball_position) | RHEO__BIT(ball_velocity) | RHEO__BIT(ball_spin) | RHEO__BIT(ball_orientation);
    if (features & RHEO__FEATURE_PUSH)
        present |= RHEO__BIT(ball_push_phase);
    if (features & RHEO__FEATURE_OBSTACLES)
        present |= RHEO__BIT(obstacle_position) | RHEO__BIT(obstacle_rotation) | RHEO__BIT(obstacle_phase);
    if (features & RHEO__FEATURE_VIBRATORS)
        present |= RHEO__BIT(vibrator_position) | RHEO__BIT(vibrator_phase) | RHEO__BIT(vibrator_frequency) |
                   RHEO__BIT(random);
    if (features & RHEO__FEATURE_EMITTERS)
        present |= RHEO__BIT(emitter_time) | RHEO__BIT(emitter_way) | RHEO__BIT(emitter_emitted) |
                   RHEO__BIT(emitter_blocked);
    return present | (type->fields ? type->fields(features, def) : 0);
}

void rheo__world_add_stage(rheo_world *w, rheo__stage stage)
{
    assert(w->stage_count < RHEO__MAX_STAGES);
    assert(!w->stage_count || !(w->stage[w->stage_count - 1].writes & RHEO__HISTORY));
    stage.writes &= w->state.present;
    w->stage[w->stage_count++] = stage;
}

void rheo__world_end_substeps(rheo_world *w)
{
    w->substeps_end = w->stage_count;
}

/* Stages after one called `substeps` run in every substep, until rheo__world_end_substeps(). */
static void list_stages(rheo_world *w)
{
    w->type->add_stages(w);
    assert(rheo__stages_first_premature(w->stage, w->stage_count) == w->stage_count);
    while (w->substeps_begin < w->stage_count && strcmp(w->stage[w->substeps_begin++].name, "substeps") != 0)
        continue;
    if (w->substeps_end < w->substeps_begin)
        w->substeps_end = w->stage_count;
    assert(w->substeps_begin == w->substeps_end || rheo__state_has(&w->state, RHEO__FIELD_substeps));
    assert(!(w->stage[w->stage_count - 1].writes & RHEO__HISTORY) ||
           rheo__world_phase(w, w->stage_count - 1) != RHEO__IN_SUBSTEPS);
}

/* ---- Memory ---- */

bool rheo__world_reserve(rheo_world *w, uint32_t particles)
{
    return !w->type->reserve || w->type->reserve(w, particles);
}

bool rheo__world_configure(rheo_world *w)
{
    rheo__planes_make(&w->planes, &w->def);
    rheo__period_make(&w->period, &w->def);
    if (w->type->configure && !w->type->configure(w))
        return false;
    w->solids->wall_distance = (rheo_real)(w->type->wall_distance ? w->type->wall_distance(&w->def) : 0);
    for (uint32_t i = 0; i <= w->def.balls.count; i++)
        w->solids->ball_mass[i] = (rheo_real)(w->type->ball_mass ? w->type->ball_mass(&w->def, i) : 0);
    w->solids->ball_distance = w->type->ball_distance ? w->type->ball_distance(&w->def) : 0;
    w->solids->friction_distance = w->type->friction_distance ? w->type->friction_distance(&w->def) : 0;
    rheo__solids_configure(w->solids, &w->def, &w->planes);
    if (w->state.vibrators)
        rheo__solids_vibrators_moved(w->solids, &w->state);
    return true;
}

/* Rows of the ring, if there is one, and of modes. The definition is in steps. */
static uint32_t ring_rows(const rheo_world_def *def)
{
    const rheo__model_type *type = rheo__model(def->model);
    return type->ring_rows ? type->ring_rows(def) : def->history.window + 1;
}

static uint32_t mode_rows(const rheo_world_def *def)
{
    const rheo__model_type *type = rheo__model(def->model);
    return type->mode_rows ? type->mode_rows(def) : 0;
}

uint32_t rheo__world_ring_rows(const rheo_world_def *def, uint32_t features)
{
    rheo_world_def in_steps = *def;
    rheo__def_in_steps(&in_steps, NULL);
    return rheo__world_fields(&in_steps, features) & RHEO__RING_FIELDS ? ring_rows(&in_steps) : 0;
}

uint64_t rheo__world_memory_rows(const rheo_world_def *def, uint32_t features)
{
    rheo_world_def in_steps = *def;
    rheo__def_in_steps(&in_steps, NULL);
    const bool modes = rheo__world_fields(&in_steps, features) & RHEO__BIT(history_modes);
    return (uint64_t)(modes ? mode_rows(&in_steps) : 0) + rheo__world_ring_rows(&in_steps, features);
}

bool rheo__world_reserve_history(rheo_world *w, uint64_t rows)
{
    return !w->type->reserve_history || w->type->reserve_history(w, rows);
}

void rheo__world_push_history(rheo_world *w, uint64_t rows)
{
    assert(rheo__state_has(&w->state, RHEO__FIELD_history_rows));
    w->type->push_history(w, rows);
}

/* ---- The first state ---- */

void rheo__world_begin_particles(rheo_world *w, uint32_t first, const rheo_real *density,
                                 const rheo_real *temperature)
{
    if (w->type->begin_particles)
        w->type->begin_particles(w, first, density, temperature);
}

static void place_balls(rheo_world *w)
{
    for (uint32_t i = 0; i < w->state.bodies; i++) {
        const rheo_ball *ball = rheo__ball_of(&w->def, i);
        for (size_t axis = 0; axis < 3; axis++) {
            w->state.ball_position[3 * (size_t)i + axis] = (rheo_real)ball->position[axis];
            w->state.ball_velocity[3 * (size_t)i + axis] = (rheo_real)ball->velocity[axis];
            w->state.ball_spin[3 * (size_t)i + axis] = (rheo_real)ball->spin[axis];
        }
        w->state.ball_orientation[4 * (size_t)i] = 1;
    }
}

static void place_obstacles(rheo_world *w)
{
    for (uint32_t i = 0; i < w->state.obstacles; i++) {
        rheo__obstacle_put(w, i);
        rheo__obstacle_turn(w, i);
    }
}

static bool fill_state(rheo_world *w, const rheo_world_def *def)
{
    rheo__state *s = &w->state;
    size_t bytes = 3 * (size_t)def->particles.count * sizeof(rheo_real);
    if (bytes) {
        memcpy(s->position, def->particles.position, bytes);
        if (def->particles.velocity)
            memcpy(s->velocity, def->particles.velocity, bytes);
    }
    if (bytes && s->material && def->particles.material)
        memcpy(s->material, def->particles.material, def->particles.count * sizeof *s->material);
    rheo__world_begin_particles(w, 0, def->particles.density, def->particles.temperature);
    if ((w->features & RHEO__FEATURE_SPRINGS) &&
        !rheo__springs_set(&s->springs, &s->allocator, s->particles, def->particles.spring_count,
                           def->particles.spring_ends, def->particles.spring_rest_length))
        return false;
    place_balls(w);
    place_obstacles(w);
    if (s->vibrators) {
        *s->random = def->vibrators.seed;
        for (uint32_t i = 0; i < s->vibrators; i++) {
            s->vibrator_position[2 * i] = (rheo_real)def->vibrators.position[i][0];
            s->vibrator_position[2 * i + 1] = (rheo_real)def->vibrators.position[i][1];
        }
    }
    return true;
}

/* ---- Creation ---- */

rheo_result rheo_world_create(const rheo_world_def *def, rheo_world **world, rheo_error *error)
{
    *world = NULL;
    RHEO__TRY(rheo_world_def_check(def, error)); /* an invalid definition has no features */
    rheo__def_warn(def);
    return rheo__world_make(def, rheo__world_features(def), world, error);
}

/* Takes over a valid definition except its particles. False: no memory. */
static bool take_definition(rheo_world *w, const rheo_world_def *def, uint32_t features)
{
    w->def = *def;
    w->def.allocator = rheo__allocator_or_default(def->allocator);
    rheo__def_in_steps(&w->def, NULL);
    const rheo__fields fields = rheo__world_fields(&w->def, features);
    memset(&w->def.particles, 0, sizeof w->def.particles);
    w->features = features;
    w->type = rheo__model(def->model);
    rheo__state_init(&w->state, &w->def.allocator, fields, ring_rows(&w->def), mode_rows(&w->def));
    return rheo__def_copy_arrays(&w->def, def);
}

static rheo_result no_memory(const rheo_world_def *def, rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a world of %u particles", def->particles.count);
}

static bool make_state(rheo_world *w, const rheo_world_def *def)
{
    w->state.obstacles = w->solids->obstacles;
    return (!w->type->create || w->type->create(w)) &&
           rheo__state_resize(&w->state, def->particles.count, rheo_world_def_ball_count(def),
                              def->vibrators.count) &&
           fill_state(w, def) && rheo__world_configure(w) && rheo__world_reserve(w, def->particles.count);
}

/* Makes the memory of model and solids, and the first state. */
static rheo_result fill_world(rheo_world *w, const rheo_world_def *def, rheo_error *error)
{
    const rheo_allocator *allocator = &w->def.allocator;
    w->model = rheo__allocate(allocator, 1, w->type->size);
    w->solids = rheo__allocate(allocator, 1, sizeof *w->solids);
    if (w->solids) {
        w->solids->allocator = *allocator;
        RHEO__TRY(rheo__solids_make_obstacles(w->solids, &w->def, error));
    }
    return w->model && w->solids && make_state(w, def) ? RHEO_OK : no_memory(def, error);
}

rheo_result rheo__world_make(const rheo_world_def *def, uint32_t features, rheo_world **world, rheo_error *error)
{
    *world = NULL;
    RHEO__TRY(check_features(def, features, error));
    RHEO__TRY(rheo__check_environment(error));
    rheo_allocator allocator = rheo__allocator_or_default(def->allocator);
    rheo_world *w = rheo__allocate(&allocator, 1, sizeof *w);
    if (!w)
        return no_memory(def, error);
    const rheo_result result = take_definition(w, def, features) ? fill_world(w, def, error) : no_memory(def, error);
    if (result != RHEO_OK) {
        rheo_world_destroy(w);
        return result;
    }
    if (w->state.vibrators)
        rheo__vibrators_begin(w->solids, &w->state);
    list_stages(w);
    rheo__world_measure(w);
    *world = w;
    return RHEO_OK;
}

void rheo_world_destroy(rheo_world *w)
{
    if (!w)
        return;
    rheo_allocator allocator = w->def.allocator;
    if (w->model && w->type->release)
        w->type->release(w);
    if (w->solids)
        rheo__solids_release(w->solids);
    rheo__release(&allocator, w->model);
    rheo__release(&allocator, w->solids);
    rheo__state_release(&w->state);
    rheo__command_queue_release(w);
    rheo__release(&allocator, w->trace.hash);
    rheo__release(&allocator, w->trace.known.marks);
    rheo__def_release_arrays(&w->def);
    rheo__release(&allocator, w);
}
