/*
 * Commands: all changes of a world between steps. They take effect at once and stay in the queue until the next step
 * is done, so that a recorder can write them before it.
 */
#include "world/model.h"

#include <stdio.h>
#include <string.h>

#include "core/environment.h"
#include "solids/solids.h"
#include "world/command_queue.h"

static rheo_result no_memory(rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the command; nothing was changed");
}

/* Values that enter the state must fit any number type. */
static bool in_range(const double *values, int count)
{
    for (int i = 0; i < count; i++)
        if (!(values[i] >= -1e30 && values[i] <= 1e30))
            return false;
    return true;
}

/* ---- One function for each kind: it checks everything before it changes anything ---- */

/* Refuses a parameter of a feature that the world was made without: its stages are missing. */
static rheo_result check_feature(const rheo_world *w, const char *path, rheo_error *error)
{
    const struct {
        const char *group, *name;
        uint32_t feature;
    } groups[] = {{"springs.", "springs", RHEO__FEATURE_SPRINGS},
                  {"history.", "history", RHEO__FEATURE_HISTORY},
                  {"walls.", "walls", RHEO__FEATURE_WALLS | RHEO__FEATURE_OBSTACLES},
                  {"ball.", "a ball", RHEO__FEATURE_BALL},
                  {"ball.push", "pushes of the ball", RHEO__FEATURE_PUSH},
                  {"vibrators.", "vibrators", RHEO__FEATURE_VIBRATORS},
                  {"plates.", "plates", RHEO__FEATURE_PLATES}};
    if (w->def.scheme == RHEO_SCHEME_POSITIONS && strncmp(path, "springs.", 8) == 0) {
        if (strcmp(path, "springs.stiffness") == 0 && (w->features & RHEO__FEATURE_HISTORY))
            return RHEO_OK; /* the unit of history.stiffness */
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s: scheme positions has no springs", path);
    }
    for (size_t i = 0; i < sizeof groups / sizeof *groups; i++)
        if (!(w->features & groups[i].feature) && strncmp(path, groups[i].group, strlen(groups[i].group)) == 0)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                              "%s: this world was made without %s; make one that has them", path, groups[i].name);
    return RHEO_OK;
}

/* Position and motion of balls are state. */
static void set_ball(rheo_world *w, const char *path)
{
    const char *member = path + strlen("ball.");
    const uint32_t number = rheo__ball_in(path, &member), index = number ? number - 1 : 0;
    if (!number && strncmp(path, "ball.", strlen("ball.")) != 0)
        return;
    const rheo_ball *given = rheo__ball_of(&w->def, index);
    const struct {
        const char *member;
        rheo_real *state;
        const double *value;
    } ball[] = {{"position", w->state.ball_position, given->position},
                {"velocity", w->state.ball_velocity, given->velocity},
                {"spin", w->state.ball_spin, given->spin}};
    for (size_t i = 0; i < sizeof ball / sizeof *ball; i++)
        for (size_t axis = 0; axis < 3 && strcmp(member, ball[i].member) == 0; axis++)
            ball[i].state[3 * (size_t)index + axis] = (rheo_real)ball[i].value[axis];
}

static void set_obstacle(rheo_world *w, const char *path)
{
    const int number = rheo__obstacle_number(path);
    const char *member = number >= 0 ? strchr(path + strlen("obstacles."), '.') : "";
    if (number >= 0 && strcmp(member, ".position") == 0)
        rheo__obstacle_put(w, (uint32_t)number);
    if (number >= 0 && strcmp(member, ".rotation") == 0)
        rheo__obstacle_turn(w, (uint32_t)number);
}

static rheo_result set_parameter(rheo_world *w, const rheo__command *c, rheo_error *error)
{
    const rheo_parameter *p = rheo_world_def_parameter_find(&w->def, c->path);
    rheo_world_def def = w->def, old = w->def;
    RHEO__TRY(rheo_world_def_set(&def, c->path, c->value, error));
    if (def.balls.count != w->def.balls.count)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%s: there is no ball %u; this world has %u", c->path,
                          def.balls.count + 1, w->state.bodies);
    if (!p->live)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "%s is fixed when a world is made; a running one cannot change it", c->path);
    RHEO__TRY(check_feature(w, rheo__in_item(c->path), error));
    if (rheo__world_features(&def) & ~w->features)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "%s was 0 when this world was made, so it has no stage for it; make one that has", c->path);
    if (w->type->check_set)
        RHEO__TRY(w->type->check_set(w, c->path, &def, error));
    RHEO__TRY(rheo_world_def_check(&def, error)); /* or a recording of it could not be loaded */
    double time = rheo_world_time(w);
    w->def = def;
    if (!rheo__world_configure(w)) {
        w->def = old;
        return no_memory(error);
    }
    if (w->type->after_set)
        w->type->after_set(w, &old);
    if (def.step != old.step) {
        *w->state.step_origin = *w->state.step;
        *w->state.time_origin = time;
    }
    set_ball(w, c->path);
    set_obstacle(w, c->path);
    return RHEO_OK;
}

static rheo_result push_body(rheo_world *w, const rheo__command *c, rheo_error *error)
{
    rheo__state *s = &w->state;
    if (c->index >= s->bodies)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no body %u; this world has %u", c->index, s->bodies);
    const double mass = (double)w->solids->ball_mass[c->index],
                 radius = (double)(rheo_real)rheo__ball_of(&w->def, c->index)->radius;
    rheo_real *v = s->ball_velocity + 3 * (size_t)c->index, *turning = s->ball_spin + 3 * (size_t)c->index;
    const double *j = c->vector;
    double arm[3] = {0, 0, 0};
    for (int axis = 0; axis < 3 && c->has_point; axis++)
        arm[axis] = c->point[axis] - (double)s->ball_position[3 * (size_t)c->index + (size_t)axis];
    const double torque[3] = {arm[1] * j[2] - arm[2] * j[1], arm[2] * j[0] - arm[0] * j[2],
                              arm[0] * j[1] - arm[1] * j[0]};
    double velocity[3], spin[3];
    for (int axis = 0; axis < 3; axis++) {
        velocity[axis] = (double)v[axis] + j[axis] / mass;
        spin[axis] = (double)turning[axis] + 2.5 * torque[axis] / (mass * radius * radius);
    }
    if (!in_range(velocity, 3) || !in_range(spin, 3))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the impulse and its point must be finite, and the speed they give at most 1e30");
    for (int axis = 0; axis < 3; axis++) {
        v[axis] = (rheo_real)velocity[axis];
        turning[axis] = (rheo_real)spin[axis];
    }
    return RHEO_OK;
}

static rheo_result add_particles(rheo_world *w, const rheo__command *c, rheo_error *error)
{
    rheo__state *s = &w->state;
    for (size_t i = 0; i < 3 * (size_t)c->count; i++)
        if (c->position[i] - c->position[i] != 0 || c->velocity[i] - c->velocity[i] != 0)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "added particle %zu is not finite", i / 3);
    if (c->index > w->def.materials.count)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no material %u; the last one is %u", c->index,
                          w->def.materials.count);
    uint32_t before = s->particles;
    if (!rheo__world_reserve(w, before + c->count) ||
        !rheo__state_resize(s, before + c->count, s->bodies, s->vibrators))
        return no_memory(error);
    if (c->count) {
        memcpy(s->position + 3 * (size_t)before, c->position, 3 * (size_t)c->count * sizeof *c->position);
        memcpy(s->velocity + 3 * (size_t)before, c->velocity, 3 * (size_t)c->count * sizeof *c->velocity);
    }
    for (uint32_t i = before; i < s->particles && s->material; i++)
        s->material[i] = c->index;
    rheo__world_begin_particles(w, before, NULL, NULL);
    return RHEO_OK;
}

static rheo_result move_vibrator(rheo_world *w, const rheo__command *c, rheo_error *error)
{
    rheo__state *s = &w->state;
    if (c->index >= s->vibrators)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no vibrator %u; this world has %u", c->index,
                          s->vibrators);
    if (!in_range(c->vector, 2))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the place of vibrator %u must be within 1e30 of the origin",
                          c->index);
    s->vibrator_position[2 * c->index] = (rheo_real)c->vector[0];
    s->vibrator_position[2 * c->index + 1] = (rheo_real)c->vector[1];
    rheo__solids_vibrators_moved(w->solids, s);
    return RHEO_OK;
}

/* ---- Applying ---- */

static rheo_result apply(rheo_world *w, const rheo__command *c, rheo_error *error)
{
    switch (c->kind) {
    case RHEO_COMMAND_SET:
        return set_parameter(w, c, error);
    case RHEO_COMMAND_PUSH_BODY:
        return push_body(w, c, error);
    case RHEO_COMMAND_ADD_PARTICLES:
        return add_particles(w, c, error);
    case RHEO_COMMAND_MOVE_VIBRATOR:
        return move_vibrator(w, c, error);
    }
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no command of kind %d", (int)c->kind);
}

rheo_result rheo__world_command(rheo_world *w, const rheo__command *command, rheo_error *error)
{
    RHEO__TRY(rheo__world_check_between_steps(w, "takes no command", error));
    RHEO__TRY(rheo__check_environment(error)); /* impulses and weights are computed and stay in the state */
    if (command->kind == RHEO_COMMAND_ADD_PARTICLES && command->count > (1u << 30) - w->state.particles)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "%u more particles would be more than 2^30", command->count);
    const rheo__command *copy = rheo__command_queue_prepare(w, command);
    if (!copy)
        return no_memory(error);
    const rheo_result result = apply(w, copy, error);
    if (result == RHEO_OK)
        rheo__command_queue_commit(w);
    else
        rheo__command_queue_drop(w);
    return result;
}

/* ---- The public calls ---- */

rheo_result rheo_world_set(rheo_world *world, const char *path, const char *value, rheo_error *error)
{
    rheo__command c = {.kind = RHEO_COMMAND_SET};
    if (strlen(path) >= sizeof c.path || strlen(value) >= sizeof c.value)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "\"%.60s\" or its value is too long", path);
    snprintf(c.path, sizeof c.path, "%s", path);
    snprintf(c.value, sizeof c.value, "%s", value);
    return rheo__world_command(world, &c, error);
}

rheo_result rheo_world_push_body(rheo_world *world, uint32_t body, const double impulse[3], const double point[3],
                                 rheo_error *error)
{
    rheo__command c = {.kind = RHEO_COMMAND_PUSH_BODY, .index = body, .has_point = point != NULL};
    memcpy(c.vector, impulse, sizeof c.vector);
    if (point)
        memcpy(c.point, point, sizeof c.point);
    return rheo__world_command(world, &c, error);
}

rheo_result rheo_world_add_particles(rheo_world *world, uint32_t count, const rheo_real *position,
                                     const rheo_real *velocity, rheo_error *error)
{
    return rheo_world_add_particles_of(world, 0, count, position, velocity, error);
}

rheo_result rheo_world_add_particles_of(rheo_world *world, uint32_t material, uint32_t count,
                                        const rheo_real *position, const rheo_real *velocity, rheo_error *error)
{
    if (count && !position)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "position is NULL; it must hold %u x 3 values", count);
    /* rheo__world_command() copies and does not write. */
    rheo__command c = {.kind = RHEO_COMMAND_ADD_PARTICLES,
                       .index = material,
                       .count = count,
                       .position = (rheo_real *)(uintptr_t)position,
                       .velocity = (rheo_real *)(uintptr_t)velocity};
    return rheo__world_command(world, &c, error);
}

rheo_result rheo_world_move_vibrator(rheo_world *world, uint32_t vibrator, double x, double z, rheo_error *error)
{
    rheo__command c = {.kind = RHEO_COMMAND_MOVE_VIBRATOR, .index = vibrator, .vector = {x, z, 0}};
    return rheo__world_command(world, &c, error);
}
