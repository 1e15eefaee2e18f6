/* A few steps of a scene, to measure what a run costs. */
#include "cli/bench.h"
#include "cli/preflight.h"

#include <math.h>
#include <string.h>

/* A probe takes about this long, and a scene with more particles is made at a lower resolution. */
static const double LENGTH = 0.3;
enum { MOST_PARTICLES = 6000, MOST_STEPS = 2000, FEWEST_STEPS = 3 };

/* Mean number of rows of a history that holds at most `most` of them, in so many steps. */
static double mean_rows(double most, double steps)
{
    const double filling = fmin(most, steps);
    return ((filling + 1) / 2 * filling + (steps - filling) * most) / steps;
}

/* Part of the time of the steps that was spent in the sums over the history, which grow with its rows. */
static double history_part(const rheo_world *world)
{
    double all = 0, history = 0;
    rheo_stage_info stage;
    if (rheo_world_history_modes(world) || !rheo_world_history_rows(world))
        return 0;
    for (uint32_t i = 0; i < rheo_world_stage_count(world); i++)
        if (rheo_world_stage(world, i, &stage) == RHEO_OK) {
            all += stage.seconds;
            history += strcmp(stage.name, "fractional_derivative") == 0 ? stage.seconds : 0;
        }
    return all > 0 ? history / all : 0;
}

static void make_steps(rheo_world *world, uint64_t steps, bool settled, uint64_t particles, cli_probe *p)
{
    const double start = cli_now(), processor = cli_processor_time();
    double seconds = 0, substeps = 0;
    while (p->steps < steps && p->steps < MOST_STEPS && (p->steps < FEWEST_STEPS || cli_now() - start < LENGTH)) {
        rheo_error error = {""};
        if (rheo_world_step(world, &error) != RHEO_OK) {
            snprintf(p->failed, sizeof p->failed, "%s", error.message);
            break;
        }
        p->steps++;
        substeps += cli_metric(world, "substeps");
        seconds = cli_processor_time() - processor;
    }
    if (!p->steps || !p->particles)
        return;
    const double made = (double)p->steps,
                 rows = rheo_world_history_window(world) + rheo_world_history_lag(world) + 1.,
                 part = history_part(world), growth = mean_rows(rows, (double)steps) / mean_rows(rows, made);
    p->ns = 1e9 * seconds / (made * p->particles) * (1 - part + part * growth);
    p->seconds = 1e-9 * p->ns * (double)particles * (double)steps;
    p->substeps = cli_has_metric(world, "substeps") ? substeps / made : NAN;
    p->bytes = rheo_recording_expected_bytes(world, steps, settled, (double)particles, p->substeps);
}

void cli_probe_scene(const rheo_scene *scene, uint64_t steps, uint64_t particles, cli_probe *probe)
{
    rheo_scene few = *scene; /* shares its arrays */
    rheo_world *world = NULL;
    *probe = (cli_probe){0, 0, NAN, NAN, NAN, NAN, ""};
    few.settle.time = 0;
    few.world.log = (rheo_log){NULL, NULL};
    if (particles > MOST_PARTICLES)
        few.resolution = fmax(0.1, scene->resolution * cbrt(MOST_PARTICLES / (double)particles));
    if (rheo_scene_create_world(&few, &world, NULL) != RHEO_OK)
        return;
    probe->particles = rheo_world_particle_count(world);
    make_steps(world, steps, scene->settle.time > 0, particles, probe);
    rheo_world_destroy(world);
}
