/*
 * Random scenes of `rheolog bench predictor`: a block of fluid that begins as a lattice in a box without lid, and maybe
 * a ball or vibrators. Each parameter has its usual value, or is drawn from a wide range around the limit of stability
 * that concerns it, so that scenes near one limit with the others at ease are as frequent as scenes beyond several.
 */
#include "cli/bench_predictor.h"

#include <math.h>
#include <string.h>

const char *const cli_predictor_group_name[CLI_PREDICTOR_GROUPS] = {"summed", "sequential", "melting"};

uint32_t cli_predictor_group(uint64_t seed)
{
    return (uint32_t)((seed + CLI_PREDICTOR_GROUPS - 1) % CLI_PREDICTOR_GROUPS);
}

static const char *const PARAMETERS[] = {"step",
                                         "gravity",
                                         "fluid.spacing",
                                         "substeps",
                                         "fluid.stiffness",
                                         "fluid.near_stiffness",
                                         "springs.stiffness",
                                         "springs.plasticity",
                                         "springs.yield_ratio",
                                         "springs.solver",
                                         "history.stiffness",
                                         "history.onset",
                                         "history.order",
                                         "history.window",
                                         "fluid.linear_viscosity",
                                         "fluid.quadratic_viscosity",
                                         "ball.radius",
                                         "ball.density_ratio",
                                         "ball.velocity",
                                         "vibrators.kind",
                                         "vibrators.amplitude",
                                         "vibrators.frequency",
                                         "melting.sound_speed",
                                         "melting.substeps",
                                         "melting.viscosity",
                                         "melting.jump_number_max",
                                         "melting.solver",
                                         "melting.stress",
                                         "melting.tolerance",
                                         "melting.diffusivity"};

const char *cli_predictor_parameter(size_t index)
{
    return index < sizeof PARAMETERS / sizeof *PARAMETERS ? PARAMETERS[index] : NULL;
}

/* ---- Drawing ---- */

typedef struct drawing {
    uint64_t random;
    rheo_scene *scene;
    rheo_result result;
    rheo_error *error;
} drawing;

/* splitmix64 */
static uint64_t next(drawing *d)
{
    uint64_t x = d->random += 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

/* Uniform in [0, 1). */
static double part(drawing *d)
{
    return (double)(next(d) >> 11) * 0x1p-53;
}

static bool chance(drawing *d, double probability)
{
    return part(d) < probability;
}

static uint64_t whole(drawing *d, uint64_t low, uint64_t high)
{
    return low + next(d) % (high - low + 1);
}

/* Logarithmically uniform. */
static double wide(drawing *d, double low, double high)
{
    return low * pow(high / low, part(d));
}

/* Whether a parameter is drawn; otherwise it keeps its usual value. */
static bool drawn(drawing *d)
{
    return chance(d, 0.3);
}

static void set(drawing *d, const char *path, const char *value)
{
    if (d->result == RHEO_OK)
        d->result = rheo_scene_set(d->scene, path, value, d->error);
}

/* Sets a number to three digits, so that the last bits of pow() do not matter. */
static double set_number(drawing *d, const char *path, double value)
{
    char text[48];
    const int decade = value > 0 ? (int)floor(log10(value)) - 2 : 0;
    const long digits = lround(value * pow(10, -decade));
    snprintf(text, sizeof text, "%lde%d", digits, decade);
    set(d, path, text);
    return (double)digits * pow(10, decade);
}

static void set_whole(drawing *d, const char *path, uint64_t value)
{
    char text[32];
    snprintf(text, sizeof text, "%llu", (unsigned long long)value);
    set(d, path, text);
}

static void set_down(drawing *d, const char *path, double value)
{
    char text[64];
    snprintf(text, sizeof text, "[0, -%lde-2, 0]", lround(100 * value));
    set(d, path, text);
}

static void add_wall(drawing *d, int axis, double at, double normal)
{
    rheo_wall wall = {{0, 0, 0}, {0, 0, 0}};
    wall.point[axis] = at;
    wall.normal[axis] = normal;
    if (d->result == RHEO_OK)
        d->result = rheo_scene_add_wall(d->scene, &wall, d->error);
}

/* A floor and four sides. */
static void add_box(drawing *d, double width, double depth)
{
    add_wall(d, 1, 0, 1);
    add_wall(d, 0, 0, 1);
    add_wall(d, 0, width, -1);
    add_wall(d, 2, 0, 1);
    add_wall(d, 2, depth, -1);
}

static void add_block(drawing *d, const rheo_fill *block)
{
    if (d->result == RHEO_OK)
        d->result = rheo_scene_add_fill(d->scene, block, d->error);
}

/* ---- Thickening ---- */

static void draw_ball(drawing *d, double width, double top, double depth)
{
    const double radius = set_number(d, "ball.radius", 3 + 2 * part(d));
    rheo_scene *s = d->scene;
    s->world.ball.position[0] = width / 2;
    s->world.ball.position[1] = top + radius + 1;
    s->world.ball.position[2] = depth / 2;
    set_down(d, "ball.velocity", chance(d, 0.5) ? wide(d, 5, 400) : 5);
    if (drawn(d))
        set_number(d, "ball.density_ratio", wide(d, 0.05, 100));
}

static void draw_vibrators(drawing *d, double width, double depth)
{
    set(d, "vibrators.kind", chance(d, 0.7) ? "floor" : "force");
    set_number(d, "vibrators.amplitude", wide(d, 0.03, 8));
    set_number(d, "vibrators.frequency", wide(d, 1, 20));
    set_number(d, "vibrators.height", 4);
    for (int i = 0; i < 4 && d->result == RHEO_OK; i++)
        d->result =
            rheo_scene_add_vibrator(d->scene, width * (i & 1 ? 0.75 : 0.25), depth * (i & 2 ? 0.75 : 0.25), d->error);
}

static void draw_thickening(drawing *d, uint32_t group)
{
    const bool summed = group == CLI_PREDICTOR_SUMMED;
    rheo_scene *s = d->scene;
    set(d, "scheme", cli_predictor_group_name[group]);
    const double spacing = s->world.fluid.spacing, h = s->world.fluid.support,
                 width = spacing * (double)whole(d, 5, 11), depth = spacing * (double)whole(d, 5, 11),
                 height = spacing * (double)whole(d, 3, 12);
    const double step = drawn(d) ? set_number(d, "step", wide(d, 0.004, summed ? 0.2 : 0.08)) : s->world.step;
    const double most = summed ? 4 : 1; /* substeps bear more */
    if (summed && chance(d, 0.6))
        set_whole(d, "substeps", whole(d, 1, 4));
    else if (summed && chance(d, 0.3))
        set_whole(d, "max_substeps", whole(d, 1, 16));
    if (drawn(d))
        set_number(d, "fluid.stiffness", wide(d, 0.02, 0.6 * most) * h / (step * step));
    if (drawn(d))
        set_number(d, "fluid.near_stiffness", wide(d, 0.03, 1.5 * most) * h / (step * step));
    if (drawn(d))
        set_number(d, "springs.stiffness", wide(d, 0.002, 5 * most) / (step * step));
    if (drawn(d))
        set_number(d, "history.stiffness", wide(d, 0.1, 1000) * s->world.springs.stiffness);
    if (drawn(d))
        set_number(d, "history.onset", wide(d, 0.003, 3));
    else if (chance(d, 0.15))
        set(d, "history.onset", "0");
    if (drawn(d))
        set_number(d, "history.order", 0.1 + 0.8 * part(d));
    set_whole(d, "history.window", drawn(d) ? whole(d, 1, 150) : 40);
    if (drawn(d))
        set_number(d, "springs.plasticity", wide(d, 0.05, 4) / step);
    if (drawn(d))
        set_number(d, "springs.yield_ratio", wide(d, 0.001, 1));
    if (!summed && chance(d, 0.25))
        set(d, "springs.solver", "implicit");
    if (drawn(d))
        set_number(d, "fluid.linear_viscosity", wide(d, 0.1, 500));
    if (drawn(d))
        set_number(d, "fluid.quadratic_viscosity", wide(d, 0.01, 500));
    if (drawn(d))
        set_down(d, "gravity", wide(d, 1, 500));
    const rheo_fill block = {.kind = RHEO_FILL_BLOCK, .max = {width, height, depth}, .jitter = 0.1};
    add_block(d, &block);
    add_box(d, width, depth);
    if (chance(d, 0.5))
        draw_ball(d, width, height, depth);
    else if (chance(d, 0.3))
        draw_vibrators(d, width, depth);
    s->steps = whole(d, 60, 200);
}

/* ---- Melting ---- */

static void draw_melting(drawing *d)
{
    rheo_scene *s = d->scene;
    const double spacing = set_number(d, "fluid.spacing", wide(d, 0.03, 0.1)),
                 width = spacing * (double)whole(d, 5, 9), depth = spacing * (double)whole(d, 5, 9),
                 height = spacing * (double)whole(d, 3, 10);
    const double sound =
        drawn(d) ? set_number(d, "melting.sound_speed", wide(d, 1, 60)) : s->world.melting.sound_speed;
    const bool given = chance(d, 0.6);
    const uint64_t substeps = given ? whole(d, 1, 8) : 0;
    set_whole(d, "melting.substeps", substeps);
    /* The number of the substeps that it is drawn for: of sound, unless another is. */
    const double courant = given ? chance(d, 0.5) ? wide(d, 0.3, 5) : 0.4 : wide(d, 0.4, 6),
                 step = set_number(d, "step", courant * (given ? (double)substeps : 1) * spacing / sound);
    const double substep = given ? step / (double)substeps : 0.4 * spacing / sound, area = spacing * spacing;
    if (chance(d, 0.4))
        set(d, "melting.solver", "explicit");
    if (chance(d, 0.4))
        set(d, "melting.stress", "nested");
    const bool is_explicit = s->world.melting.solver == RHEO_VISCOSITY_EXPLICIT;
    /* Without given substeps an explicit solver makes as many as the viscosity needs. */
    const double stiff = is_explicit && given ? wide(d, 0.01, 3) : wide(d, 0.01, is_explicit ? 3 : 1000);
    const double jump = chance(d, 0.5) ? wide(d, 1, is_explicit ? 1000 : 1e6) : 0;
    set_number(d, "melting.jump_number_max", jump);
    set_number(d, "melting.viscosity", stiff * area / substep / (1 + jump));
    if (drawn(d))
        set_number(d, "melting.tolerance", wide(d, 1e-5, 0.5));
    if (chance(d, 0.5))
        set_number(d, "melting.diffusivity", wide(d, 0.01, 3) * area / substep);
    if (drawn(d))
        set_down(d, "gravity", wide(d, 0.1, 100));
    rheo_fill block = {.kind = RHEO_FILL_BLOCK, .max = {width, height, depth}, .has_temperature = chance(d, 0.7)};
    block.temperature[1] = part(d);
    block.temperature[0] = part(d);
    add_block(d, &block);
    add_wall(d, 1, 0, 1);
    if (chance(d, 0.5)) {
        add_wall(d, 0, 0, 1);
        add_wall(d, 0, width, -1);
        add_wall(d, 2, 0, 1);
        add_wall(d, 2, depth, -1);
    }
    s->steps = whole(d, 60, 120);
}

rheo_result cli_predictor_scene(uint32_t group, uint64_t seed, rheo_scene *scene, rheo_error *error)
{
    *scene = rheo_default_model_scene(group == CLI_PREDICTOR_MELTING ? RHEO_MODEL_MELTING : RHEO_MODEL_THICKENING);
    drawing d = {.random = seed, .scene = scene, .error = error};
    snprintf(scene->name, sizeof scene->name, "%s-%llu", cli_predictor_group_name[group], (unsigned long long)seed);
    if (group == CLI_PREDICTOR_MELTING)
        draw_melting(&d);
    else
        draw_thickening(&d, group);
    if (d.result != RHEO_OK)
        rheo_scene_release(scene);
    return d.result;
}
