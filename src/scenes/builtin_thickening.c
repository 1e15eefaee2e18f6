/* The built-in scenes of the thickening model. Its defaults are parameter set P of docs/model.md. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/strict.h"
#include "scenes/builtin.h"

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

/* Fig. 8 of Ozgen et al.: a memory of all the past. The unit of the stiffness depends on the order; (g/R)^((.5 - q)/2). */
static void bowling_ball_long(rheo_scene *scene)
{
    bowling_ball(scene);
    scene->world.history.kind = RHEO_HISTORY_FULL;
    scene->world.history.order = 0.2;
    scene->world.history.stiffness = 154.7;
}

/*
 * The same in metres and seconds, with a ball of R = .11 m: lengths x s = .11/8, times x f = sqrt(s), so that gravity is
 * the same.
 */
static void bowling_ball_si(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    bowling_ball(scene);
    const double s = 0.11 / 8, f = sqrt(s), f_q = sqrt(f); /* f^q, q = .5 */
    def->step *= f;
    def->fluid.spacing *= s;
    def->fluid.support *= s;
    def->fluid.linear_viscosity /= f;
    def->fluid.quadratic_viscosity /= s;
    def->springs.stiffness /= s;
    def->springs.plasticity /= f;
    def->history.stiffness /= s * (s / f_q); /* T^(q-2)/L, and s = f^2 */
    def->history.onset *= s / f_q;
    def->walls.sticking /= f;
    def->ball.radius *= s;
    def->ball.friction /= f;
    scene->ball.clearance *= s;
    scene->settle.time *= f;
    scene->settle.damping /= f;
    for (int axis = 0; axis < 3; axis++) {
        scene->owned.fill[0].max[axis] *= s;
        def->ball.position[axis] *= s;
        def->ball.velocity[axis] *= f; /* s/f */
    }
    for (uint32_t w = 0; w < def->walls.count; w++)
        for (int axis = 0; axis < 3; axis++)
            scene->owned.plane[w].point[axis] *= s;
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

/* A heavy ball rolls into a light one that floats. */
static void bowling_balls(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    pool(scene, 24, 8, 16);
    def->ball.radius = 6;
    def->ball.density_ratio = 2.6;
    def->ball.position[0] = 10;
    def->ball.position[2] = 16;
    def->ball.velocity[0] = 14;
    scene->ball.clearance = 1;
    rheo_ball *light = &def->balls.list[def->balls.count++];
    *light = rheo_default_ball();
    light->radius = 5;
    light->density_ratio = 0.3;
    light->position[0] = 31;
    light->position[2] = 16;
    scene->balls.clearance[0] = 0;
    scene->steps = 400;
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

/*
 * A layer with a square hole over vibrators that push it (Deegan, "Stress hysteresis as the cause of persistent holes in
 * particulate suspensions", 2010).
 */
static void hole(rheo_scene *scene)
{
    const double width = 64, layer = 10, low = 22, high = 42;
    const double block[][4] = {
        {0, 0, low, width}, {high, 0, width, width}, {low, 0, high, low}, {low, high, high, width}};
    rheo_world_def *def = &scene->world;
    pool(scene, 32, 5, 32);
    scene->fill_count = 0;
    for (size_t i = 0; i < sizeof block / sizeof *block; i++) {
        rheo_fill *fill = &scene->owned.fill[scene->fill_count++];
        fill->kind = RHEO_FILL_BLOCK;
        fill->jitter = 0.1;
        memcpy(fill->min, (const double[]){block[i][0], 0, block[i][1]}, sizeof fill->min);
        memcpy(fill->max, (const double[]){block[i][2], layer, block[i][3]}, sizeof fill->max);
    }
    scene->settle.time = 0; /* the hole would fill */
    def->springs.stiffness = 5;
    def->springs.plasticity = 1.5;
    def->springs.yield_ratio = 0.06;
    def->history.window = 75;
    def->vibrators.kind = RHEO_VIBRATOR_FORCE;
    def->vibrators.amplitude = 0.8;
    def->vibrators.frequency = 2.5;
    def->vibrators.radius = 8;
    def->vibrators.height = 2.4;
    for (int i = 0; i < 16; i++) {
        scene->owned.position[i][0] = 8 + 16 * (i % 4);
        scene->owned.position[i][1] = 8 + 16 * (i / 4);
    }
    def->vibrators.count = 16;
    scene->steps = 303; /* 10 s */
}

/* A ball touches a pool and has the speed of the impact. The fluid is so stiff that the ball stays above it. */
static void hit(rheo_scene *scene, int layers)
{
    rheo_world_def *def = &scene->world;
    pool(scene, 24, layers, 24);
    def->step = 0.00825;
    def->history.stiffness = 1500;
    def->history.window = 600;
    def->ball.radius = 8;
    def->ball.density_ratio = 2.6;
    def->ball.position[0] = def->ball.position[2] = 24;
    def->ball.velocity[1] = -15.5;
    scene->ball.clearance = 0;
    scene->settle.time = 3;
    scene->settle.damping = 4;
    scene->steps = 145;
}

static void impact(rheo_scene *scene)
{
    hit(scene, 6);
}

static void impact_deep(rheo_scene *scene)
{
    hit(scene, 12);
}

/* The middle of the floor rises slowly, and sinks again. */
static void gentle(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    pool(scene, 24, 6, 24);
    def->vibrators.kind = RHEO_VIBRATOR_FLOOR;
    def->vibrators.amplitude = 4;
    def->vibrators.frequency = 0.02;
    def->vibrators.spread = 0;
    def->vibrators.wander = 0;
    def->vibrators.radius = 20;
    scene->owned.position[0][0] = scene->owned.position[0][1] = 24;
    def->vibrators.count = 1;
    scene->steps = 758; /* half a period */
}

/* A heavy ball is set down on a deep pool. The fluid stops it again and again. */
static void settling(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    pool(scene, 18, 20, 18);
    def->springs.stiffness = 5;
    def->springs.plasticity = 1.5;
    def->history.window = 60;
    def->ball.radius = 6;
    def->ball.density_ratio = 8;
    def->ball.position[0] = def->ball.position[2] = 18;
    scene->ball.clearance = 0;
    scene->steps = 400;
}

/*
 * A light foot that is pushed down again and again, as of somebody who runs over the pool (Mukhopadhyay, Allen, Brown,
 * "Testing constitutive relations by running and walking on cornstarch and water suspensions", 2018). The fluid lifts it
 * between two pushes.
 */
static void runner(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    pool(scene, 24, 10, 24);
    def->springs.plasticity = 0.8;
    def->ball.radius = 8;
    def->ball.density_ratio = 0.2;
    def->ball.position[0] = def->ball.position[2] = 24;
    def->ball.push[1] = -196.2; /* in the mean four times the weight of the fluid that the foot can displace */
    def->ball.push_frequency = 1;
    def->ball.push_duty = 0.3;
    scene->ball.clearance = 0;
    scene->settle.time = 5;
    scene->steps = 303; /* 10 s */
}

/* ---- Lengths in units of the support (docs/model.md, Accuracy) ---- */

static void use_supports(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    def->step = 0.0165;
    def->fluid.support = 1;
    def->fluid.spacing = 0.5;
    def->fluid.linear_viscosity = 1;
    def->fluid.quadratic_viscosity = 0.3;
    def->history.onset = 0.0125;
}

/* A thin layer, over vibrators that throw up whole columns of it. */
static void lumps(rheo_scene *scene)
{
    const double apart = 25 / 3.0;
    rheo_world_def *def = &scene->world;
    use_supports(scene);
    pool(scene, 50, 4, 50);
    scene->settle.time = 3;
    scene->settle.damping = 4;
    def->springs.stiffness = 20;
    def->springs.plasticity = 15;
    def->springs.yield_ratio = 0.2;
    def->history.stiffness = 1500;
    def->vibrators.kind = RHEO_VIBRATOR_FORCE;
    def->vibrators.amplitude = 2.3;
    def->vibrators.frequency = 2;
    def->vibrators.spread = 0.3;
    def->vibrators.radius = 2.5;
    def->vibrators.height = 100; /* all that is above it */
    for (int i = 0; i < 9; i++) {
        scene->owned.position[i][0] = apart * (i % 3 + 0.5);
        scene->owned.position[i][1] = apart * (i / 3 + 0.5);
    }
    def->vibrators.count = 9;
    scene->steps = 424; /* 7 T */
}

/*
 * A layer that is pushed like that of `lumps`, but only while it is in its place, and solidifies late: columns have formed
 * when they become stiff. The lattice is not settled.
 */
static void fingers(rheo_scene *scene)
{
    const double at[3] = {3.5, 10, 16.5};
    rheo_world_def *def = &scene->world;
    use_supports(scene);
    pool(scene, 40, 6, 40);
    scene->settle.time = 0;
    def->fluid.rest_density = 2.4;
    def->springs.stiffness = 5;
    def->springs.plasticity = 15;
    def->springs.yield_ratio = 0.05;
    def->history.kind = RHEO_HISTORY_FULL;
    def->history.stiffness = 4000;
    def->history.order = 0.2;
    def->history.lag_seconds = 0.8;
    def->vibrators.kind = RHEO_VIBRATOR_FORCE;
    def->vibrators.amplitude = 0.3; /* 15 g */
    def->vibrators.frequency = 3.5;
    def->vibrators.spread = 0.3;
    def->vibrators.radius = 2;
    def->vibrators.height = 3; /* the thickness */
    for (int i = 0; i < 9; i++) {
        scene->owned.position[i][0] = at[i % 3];
        scene->owned.position[i][1] = at[i / 3];
    }
    def->vibrators.count = 9;
    scene->steps = 424; /* 7 T */
}

static rheo_fill *drop_of_fluid(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    use_supports(scene);
    def->springs.stiffness = 150;
    def->springs.plasticity = 3;
    def->springs.yield_ratio = 0.03;
    def->history.stiffness = 1500;
    rheo_fill *fill = &scene->owned.fill[scene->fill_count++];
    fill->kind = RHEO_FILL_SPHERE;
    fill->radius = 5;
    fill->jitter = 0.1;
    scene->settle.time = 0; /* it falls at once */
    return fill;
}

static void drop(rheo_scene *scene)
{
    drop_of_fluid(scene)->centre[1] = 9;
    scene->owned.plane[scene->world.walls.count++] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    scene->steps = 600;
}

/* Two drops side by side: Fig. 10 of the paper. The main material has no history stiffness. */
static void drop_pair(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    rheo_material cornstarch = rheo_default_material("cornstarch");
    cornstarch.history.stiffness = 3000;
    def->materials.list[def->materials.count++] = cornstarch;
    for (int i = 0; i < 2; i++) {
        rheo_fill *fill = drop_of_fluid(scene);
        fill->centre[0] = i ? 10 : -10;
        fill->centre[1] = 9;
        if (i)
            memcpy(fill->material, cornstarch.name, sizeof fill->material);
    }
    def->history.stiffness = 0;
    def->walls.sticking = 120;
    scene->owned.plane[def->walls.count++] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    scene->steps = 180; /* 3 s: the one has bounced, the other has spread */
}

/* A slope of 20 degrees down x. The fluid is softer and flows more easily than that of the drop. */
static void incline(rheo_scene *scene)
{
    const double sine = 0.3420201433256687, cosine = 0.9396926207859084;
    rheo_fill *fill = drop_of_fluid(scene);
    fill->centre[0] = 9 * sine;
    fill->centre[1] = 9 * cosine;
    scene->world.springs.stiffness = 50;
    scene->world.springs.plasticity = 15;
    scene->owned.plane[scene->world.walls.count++] = (rheo_wall){{0, 0, 0}, {sine, cosine, 0}};
    scene->steps = 485;
}

/* A jet from a nozzle, of a fluid that flows more easily than that of the drop. */
static void jet(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    rheo_emitter nozzle = rheo_default_emitter("nozzle");
    use_supports(scene);
    def->springs.stiffness = 80;
    def->springs.plasticity = 20;
    def->springs.yield_ratio = 0.03;
    def->history.stiffness = 800;
    def->walls.sticking = 30;
    nozzle.position[1] = 14;
    nozzle.radius = 1.5;
    nozzle.speed = 5;
    nozzle.limit = 4000;
    def->emitters.list[def->emitters.count++] = nozzle;
    scene->owned.plane[def->walls.count++] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    scene->settle.time = 0;
    scene->steps = 600;
}

/* Ten layers between plates of two; the spacing is that of fluid at rest. */
static void plates(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    const double d = def->fluid.spacing = 2.115;
    pool(scene, 14, 14, 14);
    def->walls.count = 0;
    def->space.period[0] = def->space.period[2] = 14 * d;
    def->gravity[1] = 0;
    def->plates.lower = 2 * d;
    def->plates.upper = 12 * d;
    def->plates.velocity[0] = 2;
}

/* A paddle turns in a tray of fluid. The fluid begins on both sides of it. */
static void stirrer(rheo_scene *scene)
{
    rheo_world_def *def = &scene->world;
    pool(scene, 24, 6, 24);
    rheo_fill *fill = scene->owned.fill;
    fill[1] = fill[0];
    fill[0].max[2] = 22;
    fill[1].min[2] = 26;
    scene->fill_count = 2;
    rheo_obstacle paddle = rheo_default_obstacle(RHEO_OBSTACLE_BOX);
    paddle.position[0] = paddle.position[2] = 24;
    paddle.position[1] = 8;
    paddle.size[0] = 34;
    paddle.size[1] = 11;
    paddle.size[2] = 2;
    paddle.spin[1] = 1;
    def->obstacles.list[def->obstacles.count++] = paddle;
    scene->steps = 300;
}

/* A drum about z, a quarter full. With this sticking it carries the fluid over the top; with much less the fluid slips. */
static void drum(rheo_scene *scene)
{
    rheo_fill *fill = &scene->owned.fill[scene->fill_count++];
    const double low[3] = {-20, -20, -12}, high[3] = {20, -4, 12};
    fill->kind = RHEO_FILL_BLOCK;
    memcpy(fill->min, low, sizeof low);
    memcpy(fill->max, high, sizeof high);
    fill->jitter = 0.1;
    scene->settle.time = 9;
    rheo_obstacle drum = rheo_default_obstacle(RHEO_OBSTACLE_CYLINDER);
    drum.inside = RHEO_OBSTACLE_INSIDE;
    drum.radius = 30;
    drum.length = 24;
    drum.axis[1] = 0;
    drum.axis[2] = 1;
    drum.spin[2] = 0.4;
    scene->world.walls.sticking = 10;
    scene->world.obstacles.list[scene->world.obstacles.count++] = drum;
    scene->steps = 300;
}

static const rheo__builtin SCENE[] = {
    {"bowling-ball", "a bowling ball rolls over a pool of cornstarch and water, stops and sinks", bowling_ball},
    {"bowling-ball-small", "a bowling ball dropped on a small pool: carried, then sinking", bowling_ball_small},
    {"bowling-ball-long", "the same with q = .2 and a memory of all the past: the ball stays up", bowling_ball_long},
    {"bowling-ball-si", "the same in SI units, with a ball of 11 cm radius", bowling_ball_si},
    {"bowling-balls", "a heavy ball rolls over cornstarch into a light one, and sinks; the light one floats",
     bowling_balls},
    {"vibration", "a layer over 25 vibrators whose frequencies change at random", vibration},
    {"impact", "a ball hits a shallow pool of a stiff fluid", impact},
    {"impact-deep", "the same in a pool twice as deep", impact_deep},
    {"gentle", "the floor of a pool rises slowly: the history hardly counts", gentle},
    {"settling", "a heavy ball sinks in a deep pool by fits and starts", settling},
    {"runner", "a foot is pushed down again and again, and stays up if that is often enough", runner},
    {"lumps", "lumps stand up from a thin layer over vibrators", lumps},
    {"fingers", "columns rise from a layer over vibrators and stand, since it solidifies late", fingers},
    {"hole", "a vibrated layer keeps a hole open; at rest the hole fills", hole},
    {"drop", "a drop of cornstarch and water falls on a floor and bounces", drop},
    {"drop-pair", "a viscoelastic drop and one of cornstarch fall on a floor: only the latter bounces", drop_pair},
    {"incline", "the drop falls on a slope and flows down it", incline},
    {"jet", "a jet of cornstarch and water from a nozzle heaps up on a floor", jet},
    {"plates", "fluid between two plates, the upper one moves", plates},
    {"stirrer", "a paddle turns in a tray of cornstarch and water", stirrer},
    {"drum", "a drum turns and carries its fluid up the wall until it falls", drum},
};

const rheo__builtins rheo__builtin_thickening = {RHEO_MODEL_THICKENING, SCENE, sizeof SCENE / sizeof *SCENE};
