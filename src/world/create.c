/* Making a world: the one place that decides which stages and fields a scene needs. */
#include "world/world.h"

#include <stdio.h>
#include <string.h>

#include "core/environment.h"
#include "melting/melting.h"
#include "solids/solids.h"
#include "thickening/thickening.h"

/* ---- What a scene needs ---- */

static uint32_t melting_parts(const rheo_world_def *def)
{
    uint32_t parts = RHEO__FEATURE_MELTING;
    if (def->melting.flow == RHEO_FLOW_ON) {
        parts |= RHEO__FEATURE_FLOW;
        if (def->melting.viscosity > 0)
            parts |= RHEO__FEATURE_VISCOSITY;
        if (def->walls.count > 0)
            parts |= RHEO__FEATURE_WALLS;
    }
    if (def->particles.temperature)
        parts |= RHEO__FEATURE_TEMPERATURE | (def->melting.diffusivity > 0 ? RHEO__FEATURE_HEAT : 0);
    return parts;
}

uint32_t rheo__world_features(const rheo_world_def *def)
{
    if (def->model == RHEO_MODEL_MELTING)
        return melting_parts(def);
    bool springs = def->springs.stiffness > 0, history = springs && def->history.stiffness > 0;
    bool walls = def->walls.count > 0;
    uint32_t parts = 0;
    if (def->fluid.linear_viscosity > 0 || def->fluid.quadratic_viscosity > 0)
        parts |= RHEO__FEATURE_VISCOSITY;
    if (springs)
        parts |= RHEO__FEATURE_SPRINGS;
    if (history)
        parts |= RHEO__FEATURE_HISTORY;
    if (def->fluid.stiffness > 0 || def->fluid.near_stiffness > 0)
        parts |= RHEO__FEATURE_DENSITY;
    if (def->ball.radius > 0)
        parts |= RHEO__FEATURE_BALL;
    if (walls)
        parts |= RHEO__FEATURE_WALLS;
    if (def->vibrators.count > 0)
        parts |= RHEO__FEATURE_VIBRATORS;
    if (walls && history && def->walls.sticking > 0)
        parts |= RHEO__FEATURE_STICKING;
    return parts;
}

static rheo_result check_parts(const rheo_world_def *def, uint32_t parts, rheo_error *error)
{
    const bool melting = def->model == RHEO_MODEL_MELTING;
    const uint32_t fixed = RHEO__FEATURE_BALL | RHEO__FEATURE_WALLS | RHEO__FEATURE_VIBRATORS |
                           RHEO__FEATURE_MELTING | RHEO__FEATURE_FLOW;
    const uint32_t of_melting =
        RHEO__FEATURE_MELTING | RHEO__FEATURE_FLOW | RHEO__FEATURE_TEMPERATURE | RHEO__FEATURE_HEAT;
    const uint32_t all =
        melting ? of_melting | RHEO__FEATURE_VISCOSITY | RHEO__FEATURE_WALLS : 2 * RHEO__FEATURE_STICKING - 1;
    uint32_t needed = rheo__world_features(def);
    bool history = parts & RHEO__FEATURE_HISTORY, springs = parts & RHEO__FEATURE_SPRINGS,
         walls = parts & RHEO__FEATURE_WALLS;
    if ((needed & ~parts) || ((needed ^ parts) & fixed) || (parts & ~all) || (history && !springs) ||
        ((parts & RHEO__FEATURE_STICKING) && !(walls && history)) ||
        ((parts & RHEO__FEATURE_HEAT) && !(parts & RHEO__FEATURE_TEMPERATURE)) ||
        (melting && !(parts & RHEO__FEATURE_FLOW) && (parts & RHEO__FEATURE_VISCOSITY)))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the parts %#x are not those of a world of this definition, %#x", (unsigned)parts,
                          (unsigned)needed);
    if (def->particles.spring_count && !springs)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "springs are given, but springs.stiffness is 0");
    return RHEO_OK;
}

static uint32_t fields_for(uint32_t parts, rheo_history_kind kind)
{
    uint32_t present =
        RHEO__BIT(step) | RHEO__BIT(step_origin) | RHEO__BIT(time_origin) | RHEO__BIT(position) | RHEO__BIT(velocity);
    if (parts & RHEO__FEATURE_MELTING)
        present |= RHEO__BIT(density) | RHEO__BIT(start_position) | RHEO__BIT(substeps) | RHEO__BIT(iterations);
    if (parts & RHEO__FEATURE_TEMPERATURE)
        present |= RHEO__BIT(temperature);
    if (parts & RHEO__FEATURE_SPRINGS)
        present |= RHEO__BIT(spring_ends) | RHEO__BIT(spring_rest_length);
    if (parts & RHEO__FEATURE_BALL)
        present |=
            RHEO__BIT(ball_position) | RHEO__BIT(ball_velocity) | RHEO__BIT(ball_spin) | RHEO__BIT(ball_orientation);
    if (parts & RHEO__FEATURE_VIBRATORS)
        present |= RHEO__BIT(vibrator_position) | RHEO__BIT(vibrator_phase) | RHEO__BIT(vibrator_frequency) |
                   RHEO__BIT(random);
    if (parts & RHEO__FEATURE_HISTORY) {
        present |= RHEO__BIT(history_rows);
        if (kind == RHEO_HISTORY_WINDOW || kind == RHEO_HISTORY_WINDOW_FAST)
            present |= RHEO__BIT(history_velocity);
        if (kind != RHEO_HISTORY_WINDOW)
            present |= RHEO__BIT(history_modes);
    }
    return present;
}

static void add_stage(rheo_world *w, const char *name, rheo_result (*run)(rheo__state *, void *), void *context,
                      uint32_t writes)
{
    w->stage[w->stage_count++] = (rheo__stage){name, run, context, writes & w->state.present};
}

/* The stages behind `substeps` are made in every substep. In a frozen world the neighbours stay the same. */
static void list_melting_stages(rheo_world *w)
{
    const bool flow = w->features & RHEO__FEATURE_FLOW, heat = w->features & RHEO__FEATURE_HEAT;
    const uint32_t velocity = RHEO__BIT(velocity), position = RHEO__BIT(position), density = RHEO__BIT(density);
    const bool summation = w->def.melting.density == RHEO_DENSITY_SUMMATION, leapfrog = w->def.paper.leapfrog;
    void *m = w->melting;
    if (!flow && heat)
        add_stage(w, "neighbours", rheo__stage_melting_neighbours, m, 0);
    add_stage(w, "substeps", rheo__stage_substeps, m, RHEO__BIT(substeps) | RHEO__BIT(iterations));
    w->stages_before_substeps = w->stage_count;
    if (flow) {
        add_stage(w, "neighbours", rheo__stage_melting_neighbours, m, 0);
        if (summation)
            add_stage(w, "summation", rheo__stage_summation, m, density);
        if (leapfrog)
            add_stage(w, "rates", rheo__stage_rates, m, 0);
        add_stage(w, "momentum", rheo__stage_momentum, m, velocity);
        if (w->features & RHEO__FEATURE_VISCOSITY)
            add_stage(w, "viscosity", rheo__stage_viscous, m, velocity | RHEO__BIT(iterations));
    }
    if ((flow && !leapfrog) || (!flow && heat))
        add_stage(w, "rates", rheo__stage_rates, m, 0);
    if (flow || heat)
        add_stage(w, "integration", rheo__stage_integration, m,
                  (flow ? position | (summation ? 0 : density) | (w->def.paper.xsph ? velocity : 0) : 0) |
                      (heat ? RHEO__BIT(temperature) : 0));
    if (w->features & RHEO__FEATURE_WALLS)
        add_stage(w, "walls", rheo__stage_walls, w->solids, position | velocity);
}

static void list_stages(rheo_world *w)
{
    if (w->melting) {
        list_melting_stages(w);
        return;
    }
    const uint32_t parts = w->features, springs = parts & RHEO__FEATURE_SPRINGS,
                   history = parts & RHEO__FEATURE_HISTORY, density = parts & RHEO__FEATURE_DENSITY;
    const uint32_t velocity = RHEO__BIT(velocity), position = RHEO__BIT(position);
    const uint32_t ball = RHEO__BIT(ball_position) | RHEO__BIT(ball_velocity) | RHEO__BIT(ball_spin);
    void *t = w->thickening, *solids = w->solids;
    if (parts & RHEO__FEATURE_VIBRATORS)
        add_stage(w, "vibrators", rheo__stage_vibrators, solids,
                  RHEO__BIT(vibrator_phase) | RHEO__BIT(vibrator_frequency) | RHEO__BIT(random) |
                      (w->def.vibrators.kind == RHEO_VIBRATOR_FORCE ? velocity : 0));
    add_stage(w, "gravity", rheo__stage_gravity, t, velocity);
    if (parts & RHEO__FEATURE_VISCOSITY) {
        add_stage(w, "neighbours_start", rheo__stage_neighbours_start, t, 0);
        add_stage(w, "viscosity", rheo__stage_viscosity, t, velocity);
    }
    add_stage(w, "prediction", rheo__stage_prediction, t, position);
    if (parts & RHEO__FEATURE_BALL)
        add_stage(w, "ball_motion", rheo__stage_ball_motion, solids,
                  RHEO__BIT(ball_position) | RHEO__BIT(ball_velocity) | RHEO__BIT(ball_orientation));
    if (springs || density)
        add_stage(w, "neighbours", rheo__stage_neighbours, t, 0);
    if (springs)
        add_stage(w, "springs", rheo__stage_springs, t, RHEO__BIT(spring_ends) | RHEO__BIT(spring_rest_length));
    if (history)
        add_stage(w, "fractional_derivative",
                  w->def.history.kind == RHEO_HISTORY_WINDOW ? rheo__stage_fractional_derivative
                                                             : rheo__stage_fractional_derivative_modes,
                  t, 0);
    if (springs)
        add_stage(w, "spring_displacement", rheo__stage_spring_displacement, t, position);
    if (density)
        add_stage(w, "density", rheo__stage_density, t, position);
    add_stage(w, "velocity", rheo__stage_velocity, t, velocity);
    if (parts & RHEO__FEATURE_BALL)
        add_stage(w, "ball", rheo__stage_ball, solids,
                  position | velocity | RHEO__BIT(ball_velocity) | RHEO__BIT(ball_spin));
    if (parts & RHEO__FEATURE_WALLS)
        add_stage(w, "walls", rheo__stage_walls, solids, position | velocity | ball);
    if (history)
        add_stage(w, "history", rheo__stage_history, t,
                  RHEO__BIT(history_rows) | RHEO__BIT(history_velocity) | RHEO__BIT(history_modes));
    w->stages_before_substeps = w->stage_count;
}

/* ---- Making it ---- */

bool rheo__world_reserve(rheo_world *w, uint32_t particles)
{
    return (!w->thickening || rheo__thickening_reserve(w->thickening, particles)) &&
           (!w->melting || rheo__melting_reserve(w->melting, particles)) &&
           rheo__solids_reserve(w->solids, particles);
}

bool rheo__world_configure(rheo_world *w)
{
    uint32_t window = w->features & RHEO__FEATURE_HISTORY ? w->def.history.window : 0;
    if (w->melting)
        rheo__melting_configure(w->melting, &w->def);
    if (w->thickening && !rheo__thickening_configure(w->thickening, &w->def, window, w->state.ring.rows))
        return false;
    rheo__solids_configure(w->solids, &w->def);
    if (w->state.vibrators)
        rheo__solids_vibrators_moved(w->solids, &w->state);
    return true;
}

uint64_t rheo__world_memory_rows(const rheo_world_def *def, uint32_t parts)
{
    uint32_t window = 1;
    if (!(parts & RHEO__FEATURE_HISTORY))
        return 0;
    rheo__def_window(def, &window, NULL);
    bool ring = def->history.kind == RHEO_HISTORY_WINDOW || def->history.kind == RHEO_HISTORY_WINDOW_FAST;
    return rheo__mode_rows(def, window) + (ring ? (uint64_t)window + 1 : 0);
}

bool rheo__world_remember(rheo_world *w, uint64_t rows)
{
    return !w->thickening || rheo__thickening_remember(w->thickening, &w->state, rows);
}

/* What melting particles from `first` on have, beside positions and velocities, when they are added. */
void rheo__world_begin_particles(rheo_world *w, uint32_t first, const rheo_real *density,
                                 const rheo_real *temperature)
{
    rheo__state *s = &w->state;
    for (uint32_t i = first; i < s->particles && w->melting; i++) {
        s->density[i] = density ? density[i - first] : (rheo_real)w->def.melting.rest_density;
        if (rheo__state_has(s, RHEO__FIELD_temperature))
            s->temperature[i] = temperature ? temperature[i - first] : (rheo_real)w->def.melting.temperature;
        for (size_t axis = 0; axis < 3; axis++)
            s->start_position[3 * (size_t)i + axis] = s->position[3 * (size_t)i + axis];
    }
}

static void place_ball(rheo_world *w)
{
    for (int axis = 0; axis < 3 && w->state.bodies; axis++) {
        w->state.ball_position[axis] = (rheo_real)w->def.ball.position[axis];
        w->state.ball_velocity[axis] = (rheo_real)w->def.ball.velocity[axis];
        w->state.ball_spin[axis] = (rheo_real)w->def.ball.spin[axis];
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
    rheo__world_begin_particles(w, 0, def->particles.density, def->particles.temperature);
    if ((w->features & RHEO__FEATURE_SPRINGS) &&
        !rheo__springs_set(&s->springs, &s->allocator, s->particles, def->particles.spring_count,
                           def->particles.spring_ends, def->particles.spring_rest_length))
        return false;
    place_ball(w);
    if (s->bodies)
        s->ball_orientation[0] = 1;
    if (s->vibrators) {
        *s->random = def->vibrators.seed;
        for (uint32_t i = 0; i < s->vibrators; i++) {
            s->vibrator_position[2 * i] = (rheo_real)def->vibrators.position[i][0];
            s->vibrator_position[2 * i + 1] = (rheo_real)def->vibrators.position[i][1];
        }
    }
    return true;
}

rheo_result rheo_world_create(const rheo_world_def *def, rheo_world **world, rheo_error *error)
{
    *world = NULL;
    RHEO__TRY(rheo_world_def_check(def, error)); /* what is not valid has no parts */
    return rheo__world_make(def, rheo__world_features(def), world, error);
}

rheo_result rheo__world_make(const rheo_world_def *def, uint32_t parts, rheo_world **world, rheo_error *error)
{
    *world = NULL;
    RHEO__TRY(rheo_world_def_check(def, error));
    RHEO__TRY(check_parts(def, parts, error));
    RHEO__TRY(rheo__check_environment(error));
    rheo__def_warn(def);
    rheo_allocator allocator = rheo__allocator_or_default(def->allocator);
    rheo_world *w = rheo__allocate(&allocator, 1, sizeof *w);
    if (!w)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a world of %u particles", def->particles.count);
    w->def = *def;
    w->def.allocator = allocator;
    memset(&w->def.particles, 0, sizeof w->def.particles);
    rheo__def_window(def, &w->def.history.window, NULL);
    w->def.history.window_seconds = 0;
    w->features = parts;
    rheo__state_init(&w->state, &allocator, fields_for(parts, def->history.kind), w->def.history.window,
                     rheo__mode_rows(&w->def, w->def.history.window));
    if (def->model == RHEO_MODEL_MELTING)
        w->melting = rheo__allocate(&allocator, 1, sizeof *w->melting);
    else
        w->thickening = rheo__allocate(&allocator, 1, sizeof *w->thickening);
    w->solids = rheo__allocate(&allocator, 1, sizeof *w->solids);
    bool enough = (w->thickening || w->melting) && w->solids;
    if (enough)
        w->solids->allocator = allocator;
    if (enough && w->melting) {
        w->melting->allocator = allocator;
        w->melting->heat = parts & RHEO__FEATURE_HEAT;
        w->melting->diagnostics.max_density_id = -1;
    }
    if (enough && w->thickening) {
        w->thickening->allocator = allocator;
        w->thickening->diagnostics = (rheo__diagnostics){.stiffest = {-1, -1},
                                                         .stiffest_particle = -1,
                                                         .densest_particle = -1,
                                                         .max_spring_displacement.id = -1,
                                                         .max_pressure_displacement.id = -1};
        if (parts & RHEO__FEATURE_STICKING) {
            w->state.wall_friction = rheo__allocate(&allocator, 1, sizeof *w->state.wall_friction);
            enough = w->state.wall_friction != NULL;
        }
    }
    enough = enough &&
             rheo__state_resize(&w->state, def->particles.count, def->ball.radius > 0, def->vibrators.count) &&
             fill_state(w, def) && rheo__world_configure(w) && rheo__world_reserve(w, def->particles.count);
    if (!enough) {
        rheo_world_destroy(w);
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a world of %u particles", def->particles.count);
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
    if (w->thickening)
        rheo__thickening_release(w->thickening);
    if (w->melting)
        rheo__melting_release(w->melting);
    if (w->solids)
        rheo__solids_release(w->solids);
    rheo__release(&allocator, w->thickening);
    rheo__release(&allocator, w->melting);
    rheo__release(&allocator, w->solids);
    rheo__state_release(&w->state);
    rheo__world_forget_commands(w);
    rheo__release(&allocator, w->command);
    rheo__release(&allocator, w->trace.hash);
    rheo__release(&allocator, w);
}
