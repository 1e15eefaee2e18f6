/*
 * Study bunny: melting-bunny-small with half of its particles, hot at the top, until its ears and head have run down. The particles are compared with
 * those of a run with fine settings, and the mean height of the hot ones also with that of a run with many more particles.
 */
#include "cli/error_melting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 60 };

static int run(const cli_melt_case *c, const cli_melt_setting *s, const cli_bench_arguments *a, cli_melt_run *r)
{
    rheo_scene scene;
    rheo_world *world;
    rheo_error error = {""};
    rheo_result result = rheo_scene_builtin("melting-bunny-small", &scene, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    scene.particles = cli_melt_layers(c, s);
    int status = cli_melt_set(s, &scene.world);
    result = status == CLI_DONE ? rheo_scene_create_world(&scene, &world, &error) : RHEO_OK;
    rheo_scene_release(&scene);
    if (status != CLI_DONE || result != RHEO_OK)
        return status != CLI_DONE ? status : cli_error(result, &error);
    status = cli_melt_step(r, world, a->steps ? a->steps : STEPS);
    cli_melt_finish(r, world);
    r->value[0] = cli_metric(world, "hot_height");
    if (c->quantity[1]) {
        const size_t bytes = 3 * (size_t)r->particles * sizeof *r->position;
        r->position = malloc(bytes + 1);
        if (!r->position)
            status = cli_fail(CLI_SYSTEM, "no memory for the positions of %u particles", r->particles);
        else
            memcpy(r->position, rheo_world_positions(world), bytes);
    }
    rheo_world_destroy(world);
    return status;
}

/* Heights are in those of the object already. The distance is the root mean square of all particles. */
static void compare(cli_melt_run *r, const cli_melt_run *first)
{
    r->reference[0] = first->value[0];
    r->error[0] = r->value[0] - first->value[0];
    if (!r->position)
        return;
    double sum = 0;
    for (size_t i = 0; i < 3 * (size_t)r->particles; i++) {
        const double d = (double)r->position[i] - (double)first->position[i];
        sum += d * d;
    }
    r->error[1] = r->particles ? sqrt(sum / r->particles) : 0;
}

int cli_error_bunny(cli_bench_arguments *a, cli_error_points *points)
{
    /* Layers are particles here. */
    static const cli_melt_setting SETTING[] = {
        {"reference", NULL, 0, 0, {"melting.courant_number=0.05", "melting.tolerance=1e-6"}},
        {"default", "courant", 0.4, 0, {NULL}},
        {"courant 0.1", "courant", 0.1, 0, {"melting.courant_number=0.1"}},
        {"courant 0.2", "courant", 0.2, 0, {"melting.courant_number=0.2"}},
        {"courant 0.8", "courant", 0.8, 0, {"melting.courant_number=0.8"}},
        {"courant 1.6", "courant", 1.6, 0, {"melting.courant_number=1.6"}},
        {"courant 3.2", "courant", 3.2, 0, {"melting.courant_number=3.2"}},
        {"tolerance 1e-1", "tolerance", 1e-1, 0, {"melting.tolerance=1e-1"}},
        {"tolerance 1e-2", "tolerance", 1e-2, 0, {"melting.tolerance=1e-2"}},
        {"tolerance 1e-4", "tolerance", 1e-4, 0, {"melting.tolerance=1e-4"}},
        {"sound speed 5", NULL, 0, 0, {"melting.sound_speed=5"}},
        {"sound speed 20", NULL, 0, 0, {"melting.sound_speed=20"}},
        {"nested", NULL, 0, 0, {"melting.stress=nested"}},
        {"free-slip walls", NULL, 0, 0, {"melting.wall=free-slip"}},
    };
    static const cli_melt_setting SPACING[] = {
        {"reference, 8000 particles", NULL, 0, 8000, {NULL}},
        {"300 particles", "spacing", 1.587, 300, {NULL}},
        {"600 particles", "spacing", 1.26, 600, {NULL}},
        {"1200 particles", "spacing", 1, 0, {NULL}},
        {"2400 particles", "spacing", 0.794, 2400, {NULL}},
        {"4800 particles", "spacing", 0.63, 4800, {NULL}},
        {"courant 1.6", NULL, 0, 0, {"melting.courant_number=1.6"}},
        {"nested", NULL, 0, 0, {"melting.stress=nested"}},
        {"no XSPH", NULL, 0, 0, {"melting.xsph=0"}},
    };
    cli_melt_case c = {.scene = "bunny",
                       .quantity = {"hot height", "distance"},
                       .layers = a->particles ? (uint32_t)a->particles : 1200,
                       .setting = SETTING,
                       .settings = sizeof SETTING / sizeof *SETTING,
                       .run = run,
                       .compare = compare};
    const int status = cli_melt_measure(&c, a, points);
    c.scene = "bunny-spacing";
    c.quantity[1] = NULL;
    c.setting = SPACING;
    c.settings = sizeof SPACING / sizeof *SPACING;
    return status == CLI_DONE && !a->particles ? cli_melt_measure(&c, a, points) : status;
}
