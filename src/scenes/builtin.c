/* The built-in scenes. Defaults of the thickening model are parameter set P of docs/model.md. */
#include <stdio.h>
#include <string.h>

#include "core/error.h"
#include "core/strict.h"
#include "rheolog/scene.h"
#include "scenes/arrays.h"

/* Room of the arrays in every built-in scene. */
enum { MOST_FILLS = 16, MOST_WALLS = 8, MOST_VIBRATORS = 32 };

/* A pool of nx x ny x nz particles, in a box without a lid. */
static void pool(rheo_scene *scene, int nx, int ny, int nz)
{
    rheo_world_def *def = &scene->world;
    double spacing = def->fluid.spacing;
    double size[3] = {nx * spacing, ny * spacing, nz * spacing};
    rheo_fill *fill = &scene->owned.fill[scene->fill_count++];
    fill->kind = RHEO_FILL_BLOCK;
    memcpy(fill->max, size, sizeof size);
    fill->jitter = 0.1;
    /* floor, -x, +x, -z, +z */
    const rheo_wall walls[] = {{{0, 0, 0}, {0, 1, 0}},
                               {{0, 0, 0}, {1, 0, 0}},
                               {{size[0], 0, 0}, {-1, 0, 0}},
                               {{0, 0, 0}, {0, 0, 1}},
                               {{0, 0, size[2]}, {0, 0, -1}}};
    for (size_t w = 0; w < sizeof walls / sizeof *walls; w++)
        scene->owned.plane[def->walls.count++] = walls[w];
    scene->settle.time = 9;
}

static void bowling_ball(rheo_scene *scene)
{
    pool(scene, 50, 10, 40);
    scene->world.ball.radius = 8;
    scene->world.ball.density_ratio = 2.6;
    scene->world.ball.position[0] = 14;
    scene->world.ball.position[2] = 40;
    scene->world.ball.velocity[0] = 16;
    scene->ball.clearance = 4;
    scene->steps = 660; /* 21.8 s: it has sunk to 2 R */
}

static void bowling_ball_small(rheo_scene *scene)
{
    pool(scene, 24, 10, 24);
    scene->world.ball.radius = 8;
    scene->world.ball.density_ratio = 2.6;
    scene->world.ball.position[0] = 24;
    scene->world.ball.position[2] = 24;
    scene->ball.clearance = 16;
    scene->steps = 600;
}

static void vibration(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    pool(scene, 50, 8, 50);
    def->vibrators.kind = RHEO_VIBRATOR_FLOOR;
    def->vibrators.amplitude = 0.5;
    def->vibrators.frequency = 4;
    def->vibrators.radius = 6;
    for (int i = 0; i < 25; i++) {
        scene->owned.position[i][0] = 10 + 20 * (i % 5);
        scene->owned.position[i][1] = 10 + 20 * (i / 5);
    }
    def->vibrators.count = 25;
    scene->steps = 300;
}

/* Two drops of radius 5 h fall on a floor from 4 h: Fig. 10 of the paper. The main material has no history stiffness. */
static void drop_pair(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    rheo_material cornstarch = rheo_default_material("cornstarch");
    cornstarch.history.stiffness = 3000;
    def->materials.list[def->materials.count++] = cornstarch;
    def->step = 0.0165;
    def->fluid.support = 1;
    def->fluid.spacing = 0.5;
    def->fluid.linear_viscosity = 1;
    def->fluid.quadratic_viscosity = 0.3;
    def->springs.stiffness = 150;
    def->springs.plasticity = 3;
    def->springs.yield_ratio = 0.03;
    def->history.stiffness = 0;
    def->history.onset = 0.0125;
    def->walls.sticking = 120;
    scene->owned.plane[def->walls.count++] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    for (int i = 0; i < 2; i++) {
        rheo_fill *fill = &scene->owned.fill[scene->fill_count++];
        fill->kind = RHEO_FILL_SPHERE;
        fill->centre[0] = i ? 10 : -10;
        fill->centre[1] = 9;
        fill->radius = 5;
        fill->jitter = 0.1;
        if (i)
            memcpy(fill->material, cornstarch.name, sizeof fill->material);
    }
    scene->steps = 180; /* 3 s: the one has bounced, the other has spread */
}

/* ---- Melting: objects have the height H = 1 and gravity g is 1, so the unit of time is sqrt(H/g) ---- */

static void add_floor(rheo_scene *scene)
{
    scene->owned.plane[scene->world.walls.count++] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    scene->steps = 250;
}

static rheo_fill *add_fill(rheo_scene *scene, rheo_fill_kind kind, double low, double high)
{
    rheo_fill *fill = &scene->owned.fill[scene->fill_count++];
    fill->kind = kind;
    fill->has_temperature = true;
    fill->temperature[0] = low;
    fill->temperature[1] = high;
    return fill;
}

static rheo_fill *add_bunny(rheo_scene *scene, uint64_t particles)
{
    rheo_fill *fill = add_fill(scene, RHEO_FILL_MESH, 0, 1);
    snprintf(fill->name, sizeof fill->name, "bunny");
    fill->height = 1;
    scene->particles = particles;
    add_floor(scene);
    return fill;
}

static void melting_bunny(rheo_scene *scene)
{
    add_bunny(scene, 9800);
}

static void melting_bunny_small(rheo_scene *scene)
{
    add_bunny(scene, 2400);
}

/* Isothermal: no shape has a temperature. */
static void melting_all(rheo_scene *scene)
{
    rheo_fill *fill = add_bunny(scene, 7000);
    fill->has_temperature = false;
    fill->temperature[1] = 0;
    scene->world.melting.temperature = 1;
}

static void melting_logo(rheo_scene *scene)
{
    rheo_fill *fill = add_fill(scene, RHEO_FILL_LETTERS, 0, 1);
    snprintf(fill->name, sizeof fill->name, "RHEOLOG");
    fill->height = 1;
    fill->depth = 0.3;
    scene->world.melting.time_scale =
        0.02; /* yield stress 2.5 rho g H: legs of letters carry more than their own weight */
    scene->particles = 12900;
    add_floor(scene);
}

static rheo_fill *add_block(rheo_scene *scene, double low_x, double low_y, double low_z, double high_x, double high_y,
                            double high_z)
{
    /* Sets the temperature to the height in all blocks of an object. */
    rheo_fill *fill = add_fill(scene, RHEO_FILL_BLOCK, low_y, high_y);
    memcpy(fill->min, (const double[]){low_x, low_y, low_z}, sizeof fill->min);
    memcpy(fill->max, (const double[]){high_x, high_y, high_z}, sizeof fill->max);
    return fill;
}

static void melting_box(rheo_scene *scene)
{
    add_block(scene, -0.25, 0, -0.25, 0.25, 1, 0.25);
    scene->world.fluid.spacing = 0.05;
    add_floor(scene);
}

/* Four legs, a seat, and a back with two posts and three rails. The gaps of the back close when it melts. */
static void chair(rheo_scene *scene)
{
    const double half = 0.32, thick = 0.1, seat = 0.44,
                 top = seat + thick; /* multiples of the spacing, so that pieces fit */
    for (int leg = 0; leg < 4; leg++) {
        const double x = leg & 1 ? half - thick : -half, z = leg & 2 ? half - thick : -half;
        add_block(scene, x, 0, z, x + thick, seat, z + thick);
    }
    add_block(scene, -half, seat, -half, half, top, half);
    for (int side = 0; side < 2; side++) {
        const double x = side ? half - thick : -half;
        add_block(scene, x, top, -half, x + thick, 1, thick - half);
    }
    for (int rail = 0; rail < 3; rail++) {
        const double y = 0.62 + 0.14 * rail;
        add_block(scene, thick - half, y, -half, half - thick, y + thick, thick - half);
    }
    scene->world.fluid.spacing = 0.02;
    add_floor(scene);
}

/* Hot fluid solidifies where it touches the cold block. */
static void melting_drop(rheo_scene *scene)
{
    add_block(scene, -0.4, 0, -0.4, 0.4, 0.3, 0.4)->temperature[1] = 0;
    rheo_fill *drop = add_fill(scene, RHEO_FILL_SPHERE, 0.7, 0.7);
    drop->radius = 0.15;
    drop->centre[1] = 0.7;
    drop->not_hydrostatic = true;
    scene->world.fluid.spacing = 0.04;
    scene->world.melting.diffusivity = 0.01;
    add_floor(scene);
}

static const struct {
    const char *name, *about;
    rheo_model model;
    void (*make)(rheo_scene *);
} BUILTIN[] = {
    {"bowling-ball", "a bowling ball rolls over a pool of cornstarch and water, stops and sinks",
     RHEO_MODEL_THICKENING, bowling_ball},
    {"bowling-ball-small", "a bowling ball dropped on a small pool: carried, then sinking", RHEO_MODEL_THICKENING,
     bowling_ball_small},
    {"vibration", "a layer over 25 vibrators whose frequencies change at random", RHEO_MODEL_THICKENING, vibration},
    {"drop-pair", "a viscoelastic drop and one of cornstarch fall on a floor: only the latter bounces",
     RHEO_MODEL_THICKENING, drop_pair},
    {"melting-bunny", "the Stanford bunny, hot at the top: its ears melt and flow down the solid body",
     RHEO_MODEL_MELTING, melting_bunny},
    {"melting-bunny-small", "the same with a quarter of the particles", RHEO_MODEL_MELTING, melting_bunny_small},
    {"melting-logo", "letters, hot at the top and cold at the bottom", RHEO_MODEL_MELTING, melting_logo},
    {"melting-all", "the bunny, molten throughout at one temperature", RHEO_MODEL_MELTING, melting_all},
    {"melting-box", "a box, hot at the top", RHEO_MODEL_MELTING, melting_box},
    {"melting-drop", "a hot drop falls on a cold block, cools and solidifies", RHEO_MODEL_MELTING, melting_drop},
    {"chair", "a chair whose back melts: holes close, pieces join", RHEO_MODEL_MELTING, chair},
};

size_t rheo_scene_builtin_count(void)
{
    return sizeof BUILTIN / sizeof *BUILTIN;
}

rheo_result rheo_scene_builtin_at(size_t index, rheo_scene *scene)
{
    if (index >= rheo_scene_builtin_count())
        return RHEO_ERROR_ARGUMENT;
    *scene = rheo_default_model_scene(BUILTIN[index].model);
    if (!rheo__scene_reserve(scene, MOST_FILLS, MOST_WALLS, MOST_VIBRATORS)) {
        rheo_scene_release(scene);
        return RHEO_ERROR_MEMORY;
    }
    snprintf(scene->name, sizeof scene->name, "%s", BUILTIN[index].name);
    snprintf(scene->about, sizeof scene->about, "%s", BUILTIN[index].about);
    BUILTIN[index].make(scene);
    return RHEO_OK;
}

rheo_result rheo_scene_builtin(const char *name, rheo_scene *scene, rheo_error *error)
{
    char known[512] = "";
    for (size_t i = 0; i < rheo_scene_builtin_count(); i++) {
        if (strcmp(BUILTIN[i].name, name) == 0)
            return rheo_scene_builtin_at(i, scene) == RHEO_OK
                       ? RHEO_OK
                       : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the scene \"%s\"", name);
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", BUILTIN[i].name);
    }
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no built-in scene \"%.60s\"; there are: %s", name, known);
}
