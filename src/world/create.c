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
    uint32_t parts = RHEO_PART_MELTING;
    if (def->melting.flow == RHEO_FLOW_ON) {
        parts |= RHEO_PART_FLOW;
        if (def->melting.viscosity > 0)
            parts |= RHEO_PART_VISCOSITY;
        if (def->walls.count > 0)
            parts |= RHEO_PART_WALLS;
    }
    if (def->particles.temperature)
        parts |= RHEO_PART_TEMPERATURE | (def->melting.diffusivity > 0 ? RHEO_PART_HEAT : 0);
    return parts;
}

uint32_t rheo_world_parts(const rheo_world_def *def)
{
    if (def->model == RHEO_MODEL_MELTING)
        return melting_parts(def);
    bool springs = def->springs.stiffness > 0, history = springs && def->history.stiffness > 0;
    bool walls = def->walls.count > 0;
    uint32_t parts = 0;
    if (def->fluid.linear_viscosity > 0 || def->fluid.quadratic_viscosity > 0)
        parts |= RHEO_PART_VISCOSITY;
    if (springs)
        parts |= RHEO_PART_SPRINGS;
    if (history)
        parts |= RHEO_PART_HISTORY;
    if (def->fluid.stiffness > 0 || def->fluid.near_stiffness > 0)
        parts |= RHEO_PART_DENSITY;
    if (def->ball.radius > 0)
        parts |= RHEO_PART_BALL;
    if (walls)
        parts |= RHEO_PART_WALLS;
    if (def->sources.count > 0)
        parts |= RHEO_PART_SOURCES;
    if (walls && history && def->walls.sticking > 0)
        parts |= RHEO_PART_STICKING;
    return parts;
}

static rheo_result check_parts(const rheo_world_def *def, uint32_t parts, rheo_error *error)
{
    const bool melting = def->model == RHEO_MODEL_MELTING;
    const uint32_t fixed = RHEO_PART_BALL | RHEO_PART_WALLS | RHEO_PART_SOURCES | RHEO_PART_MELTING | RHEO_PART_FLOW;
    const uint32_t of_melting = RHEO_PART_MELTING | RHEO_PART_FLOW | RHEO_PART_TEMPERATURE | RHEO_PART_HEAT;
    const uint32_t all = melting ? of_melting | RHEO_PART_VISCOSITY | RHEO_PART_WALLS : 2 * RHEO_PART_STICKING - 1;
    uint32_t needed = rheo_world_parts(def);
    bool history = parts & RHEO_PART_HISTORY, springs = parts & RHEO_PART_SPRINGS, walls = parts & RHEO_PART_WALLS;
    if ((needed & ~parts) || ((needed ^ parts) & fixed) || (parts & ~all) || (history && !springs) ||
        ((parts & RHEO_PART_STICKING) && !(walls && history)) ||
        ((parts & RHEO_PART_HEAT) && !(parts & RHEO_PART_TEMPERATURE)) ||
        (melting && !(parts & RHEO_PART_FLOW) && (parts & RHEO_PART_VISCOSITY)))
        return rheo_fail(error, RHEO_ERROR_ARGUMENT, "the parts %#x are not those of a world of this definition, %#x",
                         (unsigned)parts, (unsigned)needed);
    if (def->particles.spring_count && !springs)
        return rheo_fail(error, RHEO_ERROR_ARGUMENT, "springs are given, but springs.stiffness is 0");
    return RHEO_OK;
}

static uint32_t fields_for(uint32_t parts, rheo_history_kind kind)
{
    uint32_t present =
        RHEO_BIT(step) | RHEO_BIT(step_origin) | RHEO_BIT(time_origin) | RHEO_BIT(position) | RHEO_BIT(velocity);
    if (parts & RHEO_PART_MELTING)
        present |= RHEO_BIT(density) | RHEO_BIT(start_position) | RHEO_BIT(substeps) | RHEO_BIT(iterations);
    if (parts & RHEO_PART_TEMPERATURE)
        present |= RHEO_BIT(temperature);
    if (parts & RHEO_PART_SPRINGS)
        present |= RHEO_BIT(spring_ends) | RHEO_BIT(spring_rest_length);
    if (parts & RHEO_PART_BALL)
        present |=
            RHEO_BIT(ball_position) | RHEO_BIT(ball_velocity) | RHEO_BIT(ball_spin) | RHEO_BIT(ball_orientation);
    if (parts & RHEO_PART_SOURCES)
        present |= RHEO_BIT(source_position) | RHEO_BIT(source_phase) | RHEO_BIT(source_frequency) | RHEO_BIT(random);
    if (parts & RHEO_PART_HISTORY) {
        present |= RHEO_BIT(history_rows);
        if (kind == RHEO_HISTORY_WINDOW || kind == RHEO_HISTORY_WINDOW_FAST)
            present |= RHEO_BIT(history_velocity);
        if (kind != RHEO_HISTORY_WINDOW)
            present |= RHEO_BIT(history_modes);
    }
    return present;
}

static void add_stage(rheo_world *w, const char *name, rheo_result (*run)(rheo_state *, void *), void *context,
                      uint32_t writes)
{
    w->stage[w->stage_count++] = (rheo_stage){name, run, context, writes & w->state.present};
}

/* The stages behind `substeps` are made in every substep. In a frozen world the neighbours stay the same. */
static void list_melting_stages(rheo_world *w)
{
    const bool flow = w->parts & RHEO_PART_FLOW, heat = w->parts & RHEO_PART_HEAT;
    const uint32_t velocity = RHEO_BIT(velocity), position = RHEO_BIT(position), density = RHEO_BIT(density);
    const bool summation = w->def.melting.density == RHEO_DENSITY_SUMMATION, leapfrog = w->def.paper.leapfrog;
    void *m = w->melting;
    if (!flow && heat)
        add_stage(w, "neighbours", rheo_stage_melting_neighbours, m, 0);
    add_stage(w, "substeps", rheo_stage_substeps, m, RHEO_BIT(substeps) | RHEO_BIT(iterations));
    w->once = w->stage_count;
    if (flow) {
        add_stage(w, "neighbours", rheo_stage_melting_neighbours, m, 0);
        if (summation)
            add_stage(w, "summation", rheo_stage_summation, m, density);
        if (leapfrog)
            add_stage(w, "rates", rheo_stage_rates, m, 0);
        add_stage(w, "momentum", rheo_stage_momentum, m, velocity);
        if (w->parts & RHEO_PART_VISCOSITY)
            add_stage(w, "viscosity", rheo_stage_viscous, m, velocity | RHEO_BIT(iterations));
    }
    if ((flow && !leapfrog) || (!flow && heat))
        add_stage(w, "rates", rheo_stage_rates, m, 0);
    if (flow || heat)
        add_stage(w, "integration", rheo_stage_integration, m,
                  (flow ? position | (summation ? 0 : density) | (w->def.paper.xsph ? velocity : 0) : 0) |
                      (heat ? RHEO_BIT(temperature) : 0));
    if (w->parts & RHEO_PART_WALLS)
        add_stage(w, "walls", rheo_stage_walls, w->solids, position | velocity);
}

static void list_stages(rheo_world *w)
{
    if (w->melting) {
        list_melting_stages(w);
        return;
    }
    const uint32_t parts = w->parts, springs = parts & RHEO_PART_SPRINGS, history = parts & RHEO_PART_HISTORY,
                   density = parts & RHEO_PART_DENSITY;
    const uint32_t velocity = RHEO_BIT(velocity), position = RHEO_BIT(position);
    const uint32_t ball = RHEO_BIT(ball_position) | RHEO_BIT(ball_velocity) | RHEO_BIT(ball_spin);
    void *t = w->thickening, *solids = w->solids;
    if (parts & RHEO_PART_SOURCES)
        add_stage(w, "sources", rheo_stage_sources, solids,
                  RHEO_BIT(source_phase) | RHEO_BIT(source_frequency) | RHEO_BIT(random) |
                      (w->def.sources.kind == RHEO_SOURCES_FORCE ? velocity : 0));
    add_stage(w, "gravity", rheo_stage_gravity, t, velocity);
    if (parts & RHEO_PART_VISCOSITY) {
        add_stage(w, "neighbours_start", rheo_stage_neighbours_start, t, 0);
        add_stage(w, "viscosity", rheo_stage_viscosity, t, velocity);
    }
    add_stage(w, "prediction", rheo_stage_prediction, t, position);
    if (parts & RHEO_PART_BALL)
        add_stage(w, "ball_motion", rheo_stage_ball_motion, solids,
                  RHEO_BIT(ball_position) | RHEO_BIT(ball_velocity) | RHEO_BIT(ball_orientation));
    if (springs || density)
        add_stage(w, "neighbours", rheo_stage_neighbours, t, 0);
    if (springs)
        add_stage(w, "springs", rheo_stage_springs, t, RHEO_BIT(spring_ends) | RHEO_BIT(spring_rest_length));
    if (history)
        add_stage(w, "fractional_derivative",
                  w->def.history.kind == RHEO_HISTORY_WINDOW ? rheo_stage_fractional_derivative
                                                             : rheo_stage_fractional_derivative_modes,
                  t, 0);
    if (springs)
        add_stage(w, "spring_displacement", rheo_stage_spring_displacement, t, position);
    if (density)
        add_stage(w, "density", rheo_stage_density, t, position);
    add_stage(w, "velocity", rheo_stage_velocity, t, velocity);
    if (parts & RHEO_PART_BALL)
        add_stage(w, "ball", rheo_stage_ball, solids,
                  position | velocity | RHEO_BIT(ball_velocity) | RHEO_BIT(ball_spin));
    if (parts & RHEO_PART_WALLS)
        add_stage(w, "walls", rheo_stage_walls, solids, position | velocity | ball);
    if (history)
        add_stage(w, "history", rheo_stage_history, t,
                  RHEO_BIT(history_rows) | RHEO_BIT(history_velocity) | RHEO_BIT(history_modes));
    w->once = w->stage_count;
}

/* ---- Making it ---- */

bool rheo_world_reserve(rheo_world *w, uint32_t particles)
{
    return (!w->thickening || rheo_thickening_reserve(w->thickening, particles)) &&
           (!w->melting || rheo_melting_reserve(w->melting, particles)) && rheo_solids_reserve(w->solids, particles);
}

bool rheo_world_configure(rheo_world *w)
{
    uint32_t window = w->parts & RHEO_PART_HISTORY ? w->def.history.window : 0;
    if (w->melting)
        rheo_melting_configure(w->melting, &w->def);
    if (w->thickening && !rheo_thickening_configure(w->thickening, &w->def, window, w->state.ring.rows))
        return false;
    rheo_solids_configure(w->solids, &w->def);
    if (w->state.sources)
        rheo_solids_sources_moved(w->solids, &w->state);
    return true;
}

uint64_t rheo_world_memory_rows(const rheo_world_def *def, uint32_t parts)
{
    uint32_t window = 1;
    if (!(parts & RHEO_PART_HISTORY))
        return 0;
    rheo_def_window(def, &window, NULL);
    bool ring = def->history.kind == RHEO_HISTORY_WINDOW || def->history.kind == RHEO_HISTORY_WINDOW_FAST;
    return rheo_mode_rows(def, window) + (ring ? (uint64_t)window + 1 : 0);
}

bool rheo_world_remember(rheo_world *w, uint64_t rows)
{
    return !w->thickening || rheo_thickening_remember(w->thickening, &w->state, rows);
}

/* What melting particles from `first` on have, beside positions and velocities, when they are added. */
void rheo_world_begin_particles(rheo_world *w, uint32_t first, const rheo_real *density, const rheo_real *temperature)
{
    rheo_state *s = &w->state;
    for (uint32_t i = first; i < s->particles && w->melting; i++) {
        s->density[i] = density ? density[i - first] : (rheo_real)w->def.melting.rest_density;
        if (rheo_state_has(s, RHEO_FIELD_temperature))
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
    rheo_state *s = &w->state;
    size_t bytes = 3 * (size_t)def->particles.count * sizeof(rheo_real);
    if (bytes) {
        memcpy(s->position, def->particles.position, bytes);
        if (def->particles.velocity)
            memcpy(s->velocity, def->particles.velocity, bytes);
    }
    rheo_world_begin_particles(w, 0, def->particles.density, def->particles.temperature);
    if ((w->parts & RHEO_PART_SPRINGS) &&
        !rheo_springs_set(&s->springs, &s->allocator, s->particles, def->particles.spring_count,
                          def->particles.spring_ends, def->particles.spring_rest_length))
        return false;
    place_ball(w);
    if (s->bodies)
        s->ball_orientation[0] = 1;
    if (s->sources) {
        *s->random = def->sources.seed;
        for (uint32_t i = 0; i < s->sources; i++) {
            s->source_position[2 * i] = (rheo_real)def->sources.position[i][0];
            s->source_position[2 * i + 1] = (rheo_real)def->sources.position[i][1];
        }
    }
    return true;
}

rheo_result rheo_world_create(const rheo_world_def *def, rheo_world **world, rheo_error *error)
{
    *world = NULL;
    RHEO_TRY(rheo_world_def_check(def, error)); /* what is not valid has no parts */
    return rheo_world_make(def, rheo_world_parts(def), world, error);
}

rheo_result rheo_world_make(const rheo_world_def *def, uint32_t parts, rheo_world **world, rheo_error *error)
{
    *world = NULL;
    RHEO_TRY(rheo_world_def_check(def, error));
    RHEO_TRY(check_parts(def, parts, error));
    RHEO_TRY(rheo_check_environment(error));
    rheo_def_warn(def);
    rheo_allocator allocator = rheo_allocator_or_default(def->allocator);
    rheo_world *w = rheo_allocate(&allocator, 1, sizeof *w);
    if (!w)
        return rheo_fail(error, RHEO_ERROR_MEMORY, "no memory for a world of %u particles", def->particles.count);
    w->def = *def;
    w->def.allocator = allocator;
    memset(&w->def.particles, 0, sizeof w->def.particles);
    rheo_def_window(def, &w->def.history.window, NULL);
    w->def.history.window_seconds = 0;
    w->parts = parts;
    rheo_state_init(&w->state, &allocator, fields_for(parts, def->history.kind), w->def.history.window,
                    rheo_mode_rows(&w->def, w->def.history.window));
    if (def->model == RHEO_MODEL_MELTING)
        w->melting = rheo_allocate(&allocator, 1, sizeof *w->melting);
    else
        w->thickening = rheo_allocate(&allocator, 1, sizeof *w->thickening);
    w->solids = rheo_allocate(&allocator, 1, sizeof *w->solids);
    bool enough = (w->thickening || w->melting) && w->solids;
    if (enough)
        w->solids->allocator = allocator;
    if (enough && w->melting) {
        w->melting->allocator = allocator;
        w->melting->heat = parts & RHEO_PART_HEAT;
        w->melting->found.max_density_id = -1;
    }
    if (enough && w->thickening) {
        w->thickening->allocator = allocator;
        w->thickening->found = (rheo_findings){.stiffest = {-1, -1},
                                               .stiffest_particle = -1,
                                               .densest_particle = -1,
                                               .spring_push.id = -1,
                                               .pressure_push.id = -1};
        if (parts & RHEO_PART_STICKING) {
            w->state.grip = rheo_allocate(&allocator, 1, sizeof *w->state.grip);
            enough = w->state.grip != NULL;
        }
    }
    enough = enough && rheo_state_resize(&w->state, def->particles.count, def->ball.radius > 0, def->sources.count) &&
             fill_state(w, def) && rheo_world_configure(w) && rheo_world_reserve(w, def->particles.count);
    if (!enough) {
        rheo_world_destroy(w);
        return rheo_fail(error, RHEO_ERROR_MEMORY, "no memory for a world of %u particles", def->particles.count);
    }
    if (w->state.sources)
        rheo_sources_begin(w->solids, &w->state);
    list_stages(w);
    rheo_world_measure(w);
    *world = w;
    return RHEO_OK;
}

void rheo_world_destroy(rheo_world *w)
{
    if (!w)
        return;
    rheo_allocator allocator = w->def.allocator;
    if (w->thickening)
        rheo_thickening_release(w->thickening);
    if (w->melting)
        rheo_melting_release(w->melting);
    if (w->solids)
        rheo_solids_release(w->solids);
    rheo_release(&allocator, w->thickening);
    rheo_release(&allocator, w->melting);
    rheo_release(&allocator, w->solids);
    rheo_state_release(&w->state);
    rheo_world_forget_commands(w);
    rheo_release(&allocator, w->command);
    rheo_release(&allocator, w->trace.hash);
    rheo_release(&allocator, w);
}
