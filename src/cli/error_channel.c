/*
 * Study channel: fluid between two walls at rest, at y = 0 and 1, periodic along x and z. From rest it is driven by a force
 * along x (Poiseuille), or it begins with the profile y, as when the upper wall of a Couette flow stops. Both have closed
 * forms as sine series; the flow that stops is the mirror image of one that starts.
 *
 * The model has no periodic space. So eight copies of a cell surround it, and are renewed after every step of one substep:
 * a world is made, stepped and read. Costs are measured apart, in a world that makes steps without renewing.
 */
#include "cli/error_melting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

enum { CELL = 6, COPIES = 9, TIMED = 10 };
static const double VISCOSITY = 0.5;

/* Velocity at height y and time t. */
typedef struct flow {
    double force, time;
    double (*exact)(double y, double t, double force);
} flow;

static double stopping(double y, double t, double force)
{
    (void)force;
    if (t == 0)
        return y;
    double sum = 0;
    for (int n = 1; n < 80; n++)
        sum += (n % 2 ? 2 : -2) / (n * PI) * sin(n * PI * y) * exp(-n * n * PI * PI * VISCOSITY * t);
    return sum;
}

static double driven(double y, double t, double force)
{
    double sum = y * (1 - y) / 2;
    for (int n = 1; n < 80; n += 2)
        sum -= 4 / (n * PI * n * PI * n * PI) * sin(n * PI * y) * exp(-n * n * PI * PI * VISCOSITY * t);
    return force / VISCOSITY * sum;
}

/* ---- The cell and its copies ---- */

static void renew_copies(cli_melt_body *b, uint32_t own, double width)
{
    for (uint32_t i = 0; i < own; i++)
        for (uint32_t axis = 0; axis < 3; axis += 2)
            b->position[3 * i + axis] -= (rheo_real)(width * floor((double)b->position[3 * i + axis] / width));
    for (uint32_t copy = 1; copy < COPIES; copy++) {
        const uint32_t place = copy <= 4 ? copy - 1 : copy; /* of 3 x 3; the cell itself is in the middle */
        const rheo_real along = (rheo_real)(width * (place % 3 - 1.0)),
                        across = (rheo_real)(width * (place / 3 - 1.0));
        for (uint32_t i = 0; i < own; i++) {
            const size_t image = copy * (size_t)own + i;
            b->position[3 * image] = b->position[3 * i] + along;
            b->position[3 * image + 1] = b->position[3 * i + 1];
            b->position[3 * image + 2] = b->position[3 * i + 2] + across;
            memcpy(b->velocity + 3 * image, b->velocity + 3 * (size_t)i, 3 * sizeof *b->velocity);
            b->density[image] = b->density[i];
        }
    }
}

/* Makes a step in a world of its own, and reads the particles again. */
static int step_once(cli_melt_run *r, rheo_world_def *def, cli_melt_body *b)
{
    rheo_error error = {""};
    rheo_world *world;
    const rheo_result result = rheo_world_create(def, &world, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    const int status = cli_melt_step(r, world, 1);
    cli_melt_finish(r, world);
    memcpy(b->position, rheo_world_positions(world), 3 * (size_t)b->count * sizeof *b->position);
    memcpy(b->velocity, rheo_world_velocities(world), 3 * (size_t)b->count * sizeof *b->velocity);
    cli_melt_read(world, "density", b->density, b->count * sizeof *b->density);
    rheo_world_destroy(world);
    return status;
}

/* The longest substep that melting.courant_number allows. */
static double longest_substep(const rheo_world_def *def)
{
    const double h = def->melting.smoothing_length > 0 ? def->melting.smoothing_length : def->fluid.spacing;
    const double sound = def->melting.courant_number * h / (def->melting.sound_speed + 1),
                 viscous = def->melting.courant_number * h * h / (6 * VISCOSITY);
    return def->melting.solver == RHEO_VISCOSITY_EXPLICIT && viscous < sound ? viscous : sound;
}

/* ---- Runs ---- */

static void compare(cli_melt_run *r, const flow *f, const cli_melt_body *b, uint32_t own, double time)
{
    double sum = 0, exact_sum = 0, square = 0, largest = 0;
    for (double y = 0; y < 1; y += 0.01)
        largest = fmax(largest, fabs(f->exact(y, f->force > 0 ? 1e9 : 0, f->force))); /* of the steady flow */
    for (uint32_t i = 0; i < own; i++) {
        const double u = (double)b->velocity[3 * i], exact = f->exact((double)b->position[3 * i + 1], time, f->force);
        sum += u;
        exact_sum += exact;
        square += (u - exact) * (u - exact);
    }
    cli_melt_value(r, 0, sum / own, exact_sum / own);
    r->error[1] = sqrt(square / own) / largest;
}

/* Measures the cost of some steps that begin with the last state. */
static int measure_cost(cli_melt_run *r, const cli_bench_arguments *a, const rheo_world_def *def)
{
    rheo_error error = {""};
    rheo_world *world;
    const rheo_result result = rheo_world_create(def, &world, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    r->seconds = r->time = r->substeps = r->iterations = 0;
    r->timed = 0;
    const int status = cli_melt_step(r, world, cli_melt_steps_until(a, TIMED * def->step, def->step));
    rheo_world_destroy(world);
    return status;
}

static int flow_in(cli_melt_run *r, const flow *f, const cli_bench_arguments *a, rheo_world_def *def,
                   cli_melt_body *b)
{
    const uint32_t own = b->count / COPIES;
    const uint64_t steps = cli_melt_steps_until(a, f->time, def->step);
    int status = CLI_DONE;
    for (uint64_t step = 0; step < steps && status == CLI_DONE && !r->failed; step++) {
        renew_copies(b, own, CELL * def->fluid.spacing);
        status = step_once(r, def, b);
    }
    if (status == CLI_DONE && !r->failed) {
        compare(r, f, b, own, (double)steps * def->step);
        renew_copies(b, own, CELL * def->fluid.spacing);
        status = measure_cost(r, a, def);
    }
    r->steps = steps;
    return status;
}

static int run(const cli_melt_case *c, const cli_melt_setting *s, const cli_bench_arguments *a, cli_melt_run *r)
{
    static const rheo_wall wall[] = {{{0, 0, 0}, {0, 1, 0}}, {{0, 1, 0}, {0, -1, 0}}};
    const flow *f = c->of;
    const uint32_t layers = cli_melt_layers(c, s), size[3] = {CELL, layers, CELL}, own = CELL * CELL * layers;
    rheo_world_def def = rheo_default_model_def(RHEO_MODEL_MELTING);
    cli_melt_body b;
    def.fluid.spacing = 1.0 / layers;
    def.melting.rheology = RHEO_RHEOLOGY_NEWTONIAN;
    def.melting.viscosity = VISCOSITY;
    def.gravity[0] = f->force;
    def.gravity[1] = 0;
    def.walls.plane = wall;
    def.walls.count = 2;
    def.melting.substeps = 1;
    int status = cli_melt_set(s, &def);
    if (status != CLI_DONE)
        return status;
    def.step = f->time / ceil(f->time / longest_substep(&def));
    if (!cli_melt_block(&b, def.fluid.spacing, size, 0, COPIES))
        return cli_fail(CLI_SYSTEM, "no memory for a channel of %u layers", layers);
    for (uint32_t i = 0; i < own; i++)
        b.velocity[3 * i] = (rheo_real)f->exact((double)b.position[3 * i + 1], 0, f->force);
    b.count = COPIES * own;
    cli_melt_use(&b, &def);
    status = flow_in(r, f, a, &def, &b);
    cli_melt_release(&b);
    return status;
}

int cli_error_channel(cli_bench_arguments *a, cli_error_points *points)
{
    static const cli_melt_setting SETTING[] = {
        {"6 layers", "spacing", 1. / 6, 6, {NULL}},
        {"8 layers", "spacing", 1. / 8, 8, {NULL}},
        {"12 layers (default)", "spacing", 1. / 12, 0, {NULL}},
        {"18 layers", "spacing", 1. / 18, 18, {NULL}},
        {"courant 0.1", "courant", 0.1, 0, {"melting.courant_number=0.1"}},
        {"courant 0.2", "courant", 0.2, 0, {"melting.courant_number=0.2"}},
        {"courant 0.8", "courant", 0.8, 0, {"melting.courant_number=0.8"}},
        {"courant 1.6", "courant", 1.6, 0, {"melting.courant_number=1.6"}},
        {"courant 3.2", "courant", 3.2, 0, {"melting.courant_number=3.2"}},
        {"sound speed 5", NULL, 0, 0, {"melting.sound_speed=5"}},
        {"sound speed 20", NULL, 0, 0, {"melting.sound_speed=20"}},
        {"tolerance 1e-1", "tolerance", 1e-1, 0, {"melting.tolerance=1e-1"}},
        {"tolerance 1e-2", "tolerance", 1e-2, 0, {"melting.tolerance=1e-2"}},
        {"tolerance 1e-4", "tolerance", 1e-4, 0, {"melting.tolerance=1e-4"}},
        {"tolerance 1e-6", "tolerance", 1e-6, 0, {"melting.tolerance=1e-6"}},
        {"explicit", NULL, 0, 0, {"melting.solver=explicit"}},
        {"nested, 6 layers", "nested", 1. / 6, 6, {"melting.stress=nested"}},
        {"nested, 8 layers", "nested", 1. / 8, 8, {"melting.stress=nested"}},
        {"nested, 12 layers", "nested", 1. / 12, 0, {"melting.stress=nested"}},
        {"h 1.2 spacings", NULL, 0, 0, {"melting.smoothing_length=0.1"}},
        {"no XSPH", NULL, 0, 0, {"melting.xsph=0"}},
        {"free-slip walls", NULL, 0, 0, {"melting.wall=free-slip"}},
    };
    static const flow couette = {0, 0.1, stopping}, poiseuille = {4, 0.25, driven};
    cli_melt_case c = {.scene = "couette",
                       .quantity = {"flow", "profile"},
                       .layers = 12,
                       .of = &couette,
                       .setting = SETTING,
                       .settings = sizeof SETTING / sizeof *SETTING,
                       .run = run};
    const int status = cli_melt_measure(&c, a, points);
    c.scene = "poiseuille";
    c.of = &poiseuille;
    return status == CLI_DONE ? cli_melt_measure(&c, a, points) : status;
}
