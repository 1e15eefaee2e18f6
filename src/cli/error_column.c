/*
 * Study column: fluid in a box without a lid. At rest its pressure is rho g (H - y), which it must keep, and it must not
 * move. A column that fills half of the box collapses; its centre is compared with that of a finer run.
 */
#include "cli/error_melting.h"

#include <math.h>
#include <stdlib.h>

typedef struct column {
    double width, height, depth, box, time;
    double viscosity;
} column;

static double fastest(const rheo_world *world)
{
    const rheo_real *v = rheo_world_velocities(world);
    double most = 0;
    for (uint32_t i = 0; i < rheo_world_particle_count(world); i++)
        most = fmax(most, sqrt((double)v[3 * i] * (double)v[3 * i] + (double)v[3 * i + 1] * (double)v[3 * i + 1] +
                               (double)v[3 * i + 2] * (double)v[3 * i + 2]));
    return most;
}

/* Root mean square error of the pressure, in rho g H. */
static double pressure_error(const rheo_world *world, const column *of, rheo_real *density)
{
    const double c = rheo_world_definition(world)->melting.sound_speed;
    const uint32_t count = rheo_world_particle_count(world);
    double square = 0;
    if (!cli_melt_read(world, "density", density, count * sizeof *density))
        return NAN;
    for (uint32_t i = 0; i < count; i++) {
        const double y = (double)rheo_world_positions(world)[3 * i + 1];
        const double wrong = (c * c * ((double)density[i] - 1) - (of->height - y)) / of->height;
        square += wrong * wrong;
    }
    return sqrt(square / count);
}

static void measure(cli_melt_run *r, const rheo_world *world, const column *of, rheo_real *density)
{
    if (r->failed)
        return;
    if (of->box > of->width) {
        r->value[0] = cli_metric(world, "centre_y");
        r->value[1] = cli_metric(world, "centre_x");
    } else {
        r->error[0] = pressure_error(world, of, density);
        r->error[1] = fastest(world) / sqrt(of->height);
    }
}

static int run(const cli_melt_case *c, const cli_melt_setting *s, const cli_bench_arguments *a, cli_melt_run *r)
{
    const column *of = c->of;
    const rheo_wall wall[] = {{{0, 0, 0}, {0, 1, 0}},
                              {{0, 0, 0}, {1, 0, 0}},
                              {{of->box, 0, 0}, {-1, 0, 0}},
                              {{0, 0, 0}, {0, 0, 1}},
                              {{0, 0, of->depth}, {0, 0, -1}}};
    const double n = cli_melt_layers(c, s);
    const uint32_t size[3] = {(uint32_t)(n * of->width + .5), (uint32_t)(n * of->height + .5),
                              (uint32_t)(n * of->depth + .5)};
    rheo_world_def def = rheo_default_model_def(RHEO_MODEL_MELTING);
    cli_melt_body b;
    rheo_world *world;
    rheo_error error = {""};
    def.fluid.spacing = 1 / n;
    def.melting.rheology = RHEO_RHEOLOGY_NEWTONIAN;
    def.melting.viscosity = of->viscosity;
    def.walls.plane = wall;
    def.walls.count = sizeof wall / sizeof *wall;
    int status = cli_melt_set(s, &def);
    if (status != CLI_DONE)
        return status;
    if (!cli_melt_block(&b, def.fluid.spacing, size, 0, 1))
        return cli_fail(CLI_SYSTEM, "no memory for a column");
    const double sound = def.melting.sound_speed;
    for (uint32_t i = 0; i < b.count; i++)
        b.density[i] = (rheo_real)(1 + (of->height - (double)b.position[3 * i + 1]) / (sound * sound));
    cli_melt_use(&b, &def);
    const rheo_result result = rheo_world_create(&def, &world, &error);
    if (result != RHEO_OK) {
        cli_melt_release(&b);
        return cli_error(result, &error);
    }
    status = cli_melt_step(r, world, cli_melt_steps_until(a, of->time, def.step));
    cli_melt_finish(r, world);
    measure(r, world, of, b.density);
    rheo_world_destroy(world);
    cli_melt_release(&b);
    return status;
}

static void compare(cli_melt_run *r, const cli_melt_run *first)
{
    for (int q = 0; q < CLI_MELT_QUANTITIES; q++)
        cli_melt_value(r, q, r->value[q], first->value[q]);
}

/* Settings of columns with 20 layers in the unit of length, beside the default. */
#define OTHER_SETTINGS                                                                                            \
    {"courant 0.1", "courant", 0.1, 0, {"melting.courant_number=0.1"}},                                           \
        {"courant 0.2", "courant", 0.2, 0, {"melting.courant_number=0.2"}},                                       \
        {"courant 0.8", "courant", 0.8, 0, {"melting.courant_number=0.8"}},                                       \
        {"courant 1.6", "courant", 1.6, 0, {"melting.courant_number=1.6"}},                                       \
        {"tolerance 1e-1", "tolerance", 1e-1, 0, {"melting.tolerance=1e-1"}},                                     \
        {"tolerance 1e-2", "tolerance", 1e-2, 0, {"melting.tolerance=1e-2"}},                                     \
        {"tolerance 1e-4", "tolerance", 1e-4, 0, {"melting.tolerance=1e-4"}},                                     \
        {"sound speed 5", NULL, 0, 0, {"melting.sound_speed=5"}},                                                 \
        {"sound speed 20", NULL, 0, 0, {"melting.sound_speed=20"}},                                               \
        {"nested", NULL, 0, 0, {"melting.stress=nested"}},                                                        \
        {"free-slip walls", NULL, 0, 0, {"melting.wall=free-slip"}}, {"no XSPH", NULL, 0, 0, {"melting.xsph=0"}}, \
        {"no repulsion", NULL, 0, 0, {"melting.repulsion=0"}},                                                    \
    {                                                                                                             \
        "h 1.2 spacings", NULL, 0, 0,                                                                             \
        {                                                                                                         \
            "melting.smoothing_length=0.06"                                                                       \
        }                                                                                                         \
    }

int cli_error_column(cli_bench_arguments *a, cli_error_points *points)
{
    static const cli_melt_setting REST[] = {
        {"10 layers", "spacing", 0.1, 10, {NULL}},
        {"15 layers", "spacing", 1. / 15, 15, {NULL}},
        {"20 layers (default)", "spacing", 0.05, 0, {NULL}},
        {"30 layers", "spacing", 1. / 30, 30, {NULL}},
        OTHER_SETTINGS,
    };
    static const cli_melt_setting COLLAPSE[] = {
        {"reference", NULL, 0, 0, {"melting.courant_number=0.05", "melting.tolerance=1e-5"}},
        {"default", "courant", 0.4, 0, {NULL}},
        OTHER_SETTINGS,
    };
    static const cli_melt_setting SPACING[] = {
        {"reference, 40 layers", NULL, 0, 40, {NULL}},
        {"10 layers", "spacing", 0.1, 10, {NULL}},
        {"15 layers", "spacing", 1. / 15, 15, {NULL}},
        {"20 layers (default)", "spacing", 0.05, 0, {NULL}},
        {"30 layers", "spacing", 1. / 30, 30, {NULL}},
        {"courant 1.6", NULL, 0, 0, {"melting.courant_number=1.6"}},
        {"sound speed 5", NULL, 0, 0, {"melting.sound_speed=5"}},
        {"nested", NULL, 0, 0, {"melting.stress=nested"}},
        {"no XSPH", NULL, 0, 0, {"melting.xsph=0"}},
    };
    static const column rest = {0.4, 1, 0.4, 0.4, 1, 0.05}, collapse = {0.4, 0.8, 0.4, 0.8, 1, 0.05};
    cli_melt_case c = {.scene = "rest",
                       .quantity = {"pressure", "speed"},
                       .layers = 20,
                       .of = &rest,
                       .setting = REST,
                       .settings = sizeof REST / sizeof *REST,
                       .run = run};
    int status = cli_melt_measure(&c, a, points);
    if (status != CLI_DONE)
        return status;
    c.scene = "collapse";
    c.quantity[0] = "centre_y";
    c.quantity[1] = "centre_x";
    c.of = &collapse;
    c.setting = COLLAPSE;
    c.settings = sizeof COLLAPSE / sizeof *COLLAPSE;
    c.compare = compare;
    status = cli_melt_measure(&c, a, points);
    c.scene = "collapse-spacing";
    c.setting = SPACING;
    c.settings = sizeof SPACING / sizeof *SPACING;
    return status == CLI_DONE ? cli_melt_measure(&c, a, points) : status;
}
