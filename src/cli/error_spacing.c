/*
 * Study spacing: the same material with particles closer together, by the parameter `resolution`. A ball falls into a pool, and
 * a drop on a floor. Lattices are jittered, so seeds differ: values are means over seeds, and the quantities "... by seed" say
 * how far a seed is from its mean, half the range as a fraction of it.
 *
 * A finer spacing needs more particles, so the cost of a unit of time is per particle of the coarsest one.
 *
 * Layers along walls, ball and surfaces are proportional to the spacing, so the error is taken to be of order 1. The reference
 * is the limit 2 f(s/2) - f(s) from the coarsest and the finest spacing; the one between them tests it.
 */
#include "cli/error_trials.h"

#include <math.h>
#include <stdlib.h>

#include "cli/error_start.h"

static const double RESOLUTION[] = {1, 4. / 3, 2};
static const char *const NAME[] = {"resolution 1", "resolution 4/3", "resolution 2"};
enum { RESOLUTIONS = 3, SEEDS = 2 };

/* What the seeds of a resolution gave. */
typedef struct spaced {
    double quantity[SEEDS][CLI_QUANTITIES], ns[SEEDS];
    double spacing, step, substeps;
    uint32_t particles;
    uint64_t steps, hash; /* of the last seed */
} spaced;

static cli_case ball_case(const cli_settled *from)
{
    return cli_ball_case(from, "ball");
}

static cli_case drop_case(const cli_settled *from)
{
    return cli_drop_case(&from->def);
}

static const struct {
    const char *name, *scene;
    cli_case (*make)(const cli_settled *from);
} CASE[] = {{"ball", "bowling-ball-small", ball_case}, {"drop", "drop", drop_case}};
enum { CASES = sizeof CASE / sizeof *CASE };

static rheo_result run(spaced *s, size_t which, int seed, const rheo_scene *scene, const cli_bench_arguments *a,
                       rheo_error *error)
{
    rheo_world *world;
    cli_start start = {.position = NULL};
    rheo_result result = rheo_scene_create_world(scene, &world, error);
    if (result != RHEO_OK)
        return result;
    if ((result = cli_start_copy(&start, world, error)) == RHEO_OK) {
        const rheo_world_def *def = &start.def;
        const cli_settled from = {.def = *def,
                                  .surface = def->ball.position[1] - def->ball.radius - scene->ball.clearance};
        const cli_case c = CASE[which].make(&from);
        cli_trial t = {.of = &c, .def = *def, .error = error, .memory = malloc(c.bytes + 1)};
        if (t.memory) {
            result = cli_trial_run(&t, a->steps ? a->steps : (uint64_t)ceil(c.longest / def->step), error);
        } else {
            snprintf(error->message, sizeof error->message, "no memory for a run of %s", CASE[which].name);
            result = RHEO_ERROR_MEMORY;
        }
        for (int q = 0; q < CLI_QUANTITIES; q++)
            s->quantity[seed][q] = t.quantity[q];
        s->ns[seed] = t.ns;
        s->spacing = def->fluid.spacing;
        s->step = def->step;
        s->substeps = t.substeps;
        s->particles = t.particles;
        s->steps = t.steps;
        s->hash = t.hash;
        free(t.memory);
    }
    cli_start_release(&start);
    rheo_world_destroy(world);
    return result;
}

static int run_all(spaced s[RESOLUTIONS], size_t which, cli_bench_arguments *a)
{
    rheo_error error = {""};
    rheo_result result = RHEO_OK;
    for (int seed = 0; seed < SEEDS && result == RHEO_OK; seed++)
        for (int r = 0; r < RESOLUTIONS && result == RHEO_OK; r++) {
            rheo_scene scene;
            uint64_t particles = 0;
            if ((result = rheo_scene_builtin(CASE[which].scene, &scene, &error)) != RHEO_OK)
                break;
            scene.seed = (uint64_t)seed + 1;
            if (a->settle.given)
                scene.settle.time = (double)a->settle.value * scene.world.step;
            result = rheo_scene_particle_count(&scene, &particles, &error);
            /* --particles: of the coarsest, for quick runs */
            scene.resolution = RESOLUTION[r] * (a->particles ? cbrt((double)a->particles / (double)particles) : 1);
            if (result == RHEO_OK)
                result = run(&s[r], which, seed, &scene, a, &error);
            rheo_scene_release(&scene);
            if (cli_progress_due(&a->progress, cli_now()))
                cli_progress_say(&a->progress, cli_now(), "%s, seed %d of %d, %s", CASE[which].name, seed + 1, SEEDS,
                                 NAME[r]);
        }
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

/* The mean over the seeds; NaN if one of them did not reach the quantity. */
static double mean_of(const spaced *s, int q)
{
    double sum = 0;
    for (int seed = 0; seed < SEEDS; seed++)
        sum += s->quantity[seed][q];
    return sum / SEEDS;
}

static double spread_of(const spaced *s, int q)
{
    double least = INFINITY, most = -INFINITY;
    for (int seed = 0; seed < SEEDS; seed++) {
        least = fmin(least, s->quantity[seed][q]);
        most = fmax(most, s->quantity[seed][q]);
    }
    return (most - least) / 2;
}

static int add_points(const spaced s[RESOLUTIONS], size_t which, cli_error_points *points)
{
    const cli_settled none = {.surface = NAN};
    const cli_case c = CASE[which].make(&none);
    for (int q = 0; q < CLI_QUANTITIES && c.quantity[q]; q++)
        for (int r = 0; r < RESOLUTIONS; r++) {
            cli_error_point p = cli_error_no_point();
            snprintf(p.scene, sizeof p.scene, "%s", c.name);
            snprintf(p.setting, sizeof p.setting, "%s", NAME[r]);
            snprintf(p.series, sizeof p.series, "resolution");
            snprintf(p.quantity, sizeof p.quantity, "%s", c.quantity[q]);
            p.refinement = s[r].spacing;
            p.value = mean_of(&s[r], q);
            p.reference = 2 * mean_of(&s[RESOLUTIONS - 1], q) - mean_of(&s[0], q);
            p.error = p.value / p.reference - 1;
            p.ns_step = cli_bench_median(s[r].ns, SEEDS);
            p.us_time = 1e-3 * p.ns_step / s[r].step * s[r].particles / s[0].particles;
            p.substeps = s[r].substeps;
            p.particles = s[r].particles;
            p.steps = s[r].steps;
            p.hash = s[r].hash;
            if (!cli_error_add(points, &p))
                return CLI_SYSTEM;
            snprintf(p.quantity, sizeof p.quantity, "%s by seed", c.quantity[q]);
            p.refinement = 0;
            p.value = p.error = spread_of(&s[r], q) / fabs(mean_of(&s[r], q));
            p.reference = NAN;
            p.ns_step = p.us_time = NAN; /* chance, not a choice */
            if (!cli_error_add(points, &p))
                return CLI_SYSTEM;
        }
    return CLI_DONE;
}

int cli_error_spacing(cli_bench_arguments *a, cli_error_points *points)
{
    int status = CLI_DONE;
    for (size_t which = 0; which < CASES && status == CLI_DONE; which++) {
        spaced s[RESOLUTIONS] = {{.spacing = 0}};
        if (!cli_case_wanted(a, CASE[which].name))
            continue;
        status = run_all(s, which, a);
        if (status == CLI_DONE)
            status = add_points(s, which, points);
    }
    return status;
}
