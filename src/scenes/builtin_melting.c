/* The built-in scenes of the melting model. Objects have the height H = 1 and gravity g is 1, so the unit of time is sqrt(H/g). */
#include <stdio.h>
#include <string.h>

#include "core/strict.h"
#include "scenes/builtin.h"

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

static const rheo__builtin SCENE[] = {
    {"melting-bunny", "the Stanford bunny, hot at the top: its ears melt and flow down the solid body",
     melting_bunny},
    {"melting-bunny-small", "the same with a quarter of the particles", melting_bunny_small},
    {"melting-logo", "letters, hot at the top and cold at the bottom", melting_logo},
    {"melting-all", "the bunny, molten throughout at one temperature", melting_all},
    {"melting-box", "a box, hot at the top", melting_box},
    {"melting-drop", "a hot drop falls on a cold block, cools and solidifies", melting_drop},
    {"chair", "a chair whose back melts: holes close, pieces join", chair},
};

const rheo__builtins rheo__builtin_melting = {RHEO_MODEL_MELTING, SCENE, sizeof SCENE / sizeof *SCENE};
