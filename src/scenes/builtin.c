/* The built-in scenes. Parameter set P of docs/model.md is the default of a definition. */
#include <stdio.h>
#include <string.h>

#include "core/error.h"
#include "rheolog/scene.h"

/* A pool of nx x ny x nz particles in a box that is open at the top, at rest on its floor. */
static void pool(rheo_scene *scene, int nx, int ny, int nz)
{
    rheo_world_def *def = &scene->world;
    double spacing = def->fluid.spacing;
    double size[3] = {nx * spacing, ny * spacing, nz * spacing};
    rheo_fill *fill = &scene->fill[scene->fill_count++];
    fill->kind = RHEO_FILL_BLOCK;
    memcpy(fill->max, size, sizeof size);
    fill->jitter = 0.1;
    /* floor, -x, +x, -z, +z */
    const rheo_wall walls[] = {{{0, 0, 0}, {0, 1, 0}},
                               {{0, 0, 0}, {1, 0, 0}},
                               {{size[0], 0, 0}, {-1, 0, 0}},
                               {{0, 0, 0}, {0, 0, 1}},
                               {{0, 0, size[2]}, {0, 0, -1}}};
    def->walls.count = sizeof walls / sizeof *walls;
    memcpy(def->walls.plane, walls, sizeof walls);
    scene->settle.time = 3;
}

static void bowling_ball(rheo_scene *scene)
{
    pool(scene, 50, 10, 40);
    scene->world.ball.radius = 8;
    scene->world.ball.position[0] = 14;
    scene->world.ball.position[2] = 40;
    scene->world.ball.velocity[0] = 16;
    scene->clearance = 4;
    scene->steps = 600;
}

static void bowling_ball_small(rheo_scene *scene)
{
    pool(scene, 24, 10, 24);
    scene->world.ball.radius = 8;
    scene->world.ball.position[0] = 24;
    scene->world.ball.position[2] = 24;
    scene->clearance = 16;
    scene->steps = 600;
}

static void vibration(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    pool(scene, 50, 8, 50);
    def->springs.solver = RHEO_SOLVER_IMPLICIT; /* kappa passes 2 over the sources */
    def->sources.kind = RHEO_SOURCES_FLOOR;
    def->sources.amplitude = 0.5;
    def->sources.frequency = 4;
    def->sources.radius = 6;
    for (int i = 0; i < 25; i++) {
        def->sources.position[i][0] = 10 + 20 * (i % 5);
        def->sources.position[i][1] = 10 + 20 * (i / 5);
    }
    def->sources.count = 25;
    scene->steps = 300;
}

static const struct {
    const char *name, *about;
    void (*make)(rheo_scene *);
} BUILTIN[] = {
    {"bowling-ball", "a bowling ball rolls over a pool of cornstarch and water, stops and sinks", bowling_ball},
    {"bowling-ball-small", "a bowling ball dropped on a small pool: carried, then sinking", bowling_ball_small},
    {"vibration", "a layer over 25 vibrating sources whose frequencies wander at random", vibration},
};

size_t rheo_scene_builtin_count(void)
{
    return sizeof BUILTIN / sizeof *BUILTIN;
}

rheo_result rheo_scene_builtin_at(size_t index, rheo_scene *scene)
{
    if (index >= rheo_scene_builtin_count())
        return RHEO_ERROR_ARGUMENT;
    *scene = rheo_default_scene();
    snprintf(scene->name, sizeof scene->name, "%s", BUILTIN[index].name);
    snprintf(scene->about, sizeof scene->about, "%s", BUILTIN[index].about);
    BUILTIN[index].make(scene);
    return RHEO_OK;
}

rheo_result rheo_scene_builtin(const char *name, rheo_scene *scene, rheo_error *error)
{
    char known[256] = "";
    for (size_t i = 0; i < rheo_scene_builtin_count(); i++) {
        if (strcmp(BUILTIN[i].name, name) == 0)
            return rheo_scene_builtin_at(i, scene);
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", BUILTIN[i].name);
    }
    return rheo_fail(error, RHEO_ERROR_ARGUMENT, "there is no built-in scene \"%.60s\"; there are: %s", name, known);
}
