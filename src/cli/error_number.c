/*
 * Study number: float against double. A program has one number type, so it measures its own; bench/error.sh joins the results
 * of two programs.
 *
 * Each built-in scene runs twice: as it is, and with every coordinate of its particles moved by one ulp up or down (seeded).
 * The difference, as a root mean square over the particles, grows from that ulp and from the roundings of every step, which
 * differ from then on. So it has the size of the error that roundings make. While it is small it grows like exp(t / T),
 * T is the Lyapunov time; in the end it saturates: particles are elsewhere, and only means can be compared. With double, a
 * third run starts with an ulp of float, but without the roundings of float: what float adds is the rest.
 */
#include "cli/error_trials.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/error_start.h"

enum { STEPS = 300, MELTING_STEPS = 100, PARTICLES = 2000, NAMES = 64 };
static const double CHAOS = 1e-2; /* spacings: growth is no longer exponential */

/* ---- Perturbations ---- */

/* The next number above or below, of rheo_real or of float. */
static rheo_real neighbour(rheo_real x, bool up, bool of_float)
{
    const double to = up ? INFINITY : -INFINITY;
    if (sizeof x == sizeof(float))
        return (rheo_real)nextafterf((float)x, (float)to);
    const float near = (float)x;
    return of_float ? (rheo_real)((double)x + ((double)nextafterf(near, (float)to) - (double)near))
                    : (rheo_real)nextafter((double)x, to);
}

static void perturb(cli_start *s, bool of_float)
{
    uint64_t random = 0x9e3779b97f4a7c15; /* the seed; xorshift */
    for (size_t i = 0; i < 3 * (size_t)s->def.particles.count; i++) {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        s->position[i] = neighbour(s->position[i], random >> 63, of_float);
    }
}

/* ---- Runs ---- */

/* Differences in spacings: of the state at step 0, 1, ... */
typedef struct growth {
    double *difference;
    uint64_t steps;
    double step, seconds; /* length of a step; computing time of all steps of both runs */
    uint32_t particles;
    uint64_t hash;
} growth;

static double difference_of(const rheo_world *a, const rheo_world *b)
{
    const size_t n = rheo_world_particle_count(a);
    const rheo_real *x = rheo_world_positions(a), *y = rheo_world_positions(b);
    double sum = 0;
    for (size_t i = 0; i < 3 * n; i++) {
        const double d = (double)x[i] - (double)y[i];
        sum += d * d;
    }
    return n ? sqrt(sum / (double)n) / rheo_world_definition(a)->fluid.spacing : 0;
}

/* Steps both worlds in turn. */
static rheo_result run_pair(growth *g, rheo_world *a, rheo_world *b, uint64_t steps, rheo_error *error)
{
    rheo_result result = RHEO_OK;
    g->difference[0] = difference_of(a, b);
    g->seconds = 0;
    for (g->steps = 0; g->steps < steps && result == RHEO_OK;) {
        const double begin = cli_processor_time();
        result = rheo_world_step(a, error);
        if (result == RHEO_OK)
            result = rheo_world_step(b, error);
        g->seconds += cli_processor_time() - begin;
        if (result == RHEO_OK)
            g->difference[++g->steps] = difference_of(a, b);
    }
    g->step = rheo_world_definition(a)->step;
    g->particles = rheo_world_particle_count(a);
    g->hash = rheo_world_hash(a);
    return result;
}

/* Runs a scene and its perturbed copy. */
static rheo_result run_scene(growth *g, const rheo_scene *scene, bool of_float, uint64_t steps, rheo_error *error)
{
    rheo_world *a = NULL, *b = NULL;
    cli_start s = {.position = NULL};
    rheo_result result = rheo_scene_create_world(scene, &a, error);
    if (result == RHEO_OK)
        result = cli_start_copy(&s, a, error);
    if (result == RHEO_OK) {
        perturb(&s, of_float);
        result = rheo_world_create(&s.def, &b, error);
    }
    if (result == RHEO_OK)
        result = run_pair(g, a, b, steps, error);
    rheo_world_destroy(b);
    cli_start_release(&s);
    rheo_world_destroy(a);
    return result;
}

/* ---- Growth ---- */

/* The first step from which a difference is larger than a bound; UINT64_MAX: none. */
static uint64_t first_above(const growth *g, double bound)
{
    for (uint64_t i = 1; i <= g->steps; i++)
        if (g->difference[i] > bound)
            return i;
    return UINT64_MAX;
}

/*
 * The Lyapunov time: of the line through log(difference) by least squares, from the step at which the difference has grown
 * threefold until it is no longer small. NaN: from there it does not grow tenfold.
 */
static double lyapunov_time(const growth *g)
{
    const uint64_t begin = first_above(g, 3 * g->difference[1]), chaos = first_above(g, CHAOS),
                   end = chaos < g->steps ? chaos : g->steps;
    double n = 0, t = 0, y = 0, tt = 0, ty = 0;
    for (uint64_t i = begin; i <= end; i++) {
        const double time = (double)i * g->step, logarithm = log(g->difference[i]);
        n += 1;
        t += time;
        y += logarithm;
        tt += time * time;
        ty += time * logarithm;
    }
    const double rate = (n * ty - t * y) / (n * tt - t * t);
    return n > 2 && rate * (double)(end - begin) * g->step > log(10.) ? 1 / rate : (double)NAN;
}

static int add_points(const growth *g, const char *scene, const char *setting, cli_error_points *points)
{
    static const uint64_t AFTER[] = {1, 10, 30, 100, 300, 1000};
    const uint64_t chaos = first_above(g, CHAOS);
    cli_error_point p = cli_error_no_point();
    snprintf(p.scene, sizeof p.scene, "%.47s", scene);
    snprintf(p.setting, sizeof p.setting, "%s", setting);
    snprintf(p.series, sizeof p.series, "%s", setting);
    p.ns_step = 1e9 * g->seconds / (2. * (double)g->steps * g->particles);
    p.us_time = 1e-3 * p.ns_step / g->step;
    p.particles = g->particles;
    p.hash = g->hash;
    for (size_t i = 0; i < sizeof AFTER / sizeof *AFTER && AFTER[i] <= g->steps; i++) {
        snprintf(p.quantity, sizeof p.quantity, "difference at step %u", (unsigned)AFTER[i]);
        p.steps = AFTER[i];
        p.value = p.error = g->difference[AFTER[i]];
        p.reference = 0;
        if (!cli_error_add(points, &p))
            return CLI_SYSTEM;
    }
    p.steps = g->steps;
    p.error = p.reference = NAN;
    snprintf(p.quantity, sizeof p.quantity, "Lyapunov time");
    p.value = lyapunov_time(g);
    if (!cli_error_add(points, &p))
        return CLI_SYSTEM;
    snprintf(p.quantity, sizeof p.quantity, "steps to .01 spacings");
    p.value = chaos == UINT64_MAX ? (double)NAN : (double)chaos;
    return cli_error_add(points, &p) ? CLI_DONE : CLI_SYSTEM;
}

/* ---- The study ---- */

/* Makes a scene coarser if it has many particles: the same material at another spacing. */
static rheo_result make_small(rheo_scene *scene, uint64_t most, rheo_error *error)
{
    uint64_t particles = 0;
    char value[32];
    rheo_result result = rheo_scene_particle_count(scene, &particles, error);
    if (result != RHEO_OK || particles <= most)
        return result;
    rheo__number_text(cbrt((double)most / (double)particles), value, sizeof value);
    return rheo_scene_set(scene, "resolution", value, error);
}

static int try_scene(const char *name, rheo_model model, cli_bench_arguments *a, cli_error_points *points)
{
    uint64_t steps = a->steps ? a->steps : STEPS;
    const bool is_double = sizeof(rheo_real) > sizeof(float);
    static const char *const SETTING[2][2] = {{"float"}, {"double", "double, an ulp of float"}};
    rheo_error error = {""};
    if (!a->steps && model == RHEO_MODEL_MELTING)
        steps = MELTING_STEPS; /* each takes some twenty substeps */
    growth g = {.difference = malloc((size_t)(steps + 1) * sizeof *g.difference)};
    int status =
        g.difference ? CLI_DONE : cli_fail(CLI_SYSTEM, "no memory for %llu steps", (unsigned long long)steps);
    for (int of_float = 0; of_float <= is_double && status == CLI_DONE; of_float++) {
        rheo_scene scene;
        rheo_result result = rheo_scene_builtin(name, &scene, &error);
        if (result != RHEO_OK) {
            status = cli_error(result, &error);
            break;
        }
        if (a->settle.given && scene.world.model == RHEO_MODEL_THICKENING)
            scene.settle.time = (double)a->settle.value * scene.world.step;
        result = make_small(&scene, a->particles ? a->particles : PARTICLES, &error);
        if (result == RHEO_OK)
            result = run_scene(&g, &scene, of_float, steps, &error);
        rheo_scene_release(&scene);
        status = result == RHEO_OK ? add_points(&g, name, SETTING[is_double][of_float], points)
                                   : cli_error(result, &error);
    }
    free(g.difference);
    return status;
}

int cli_error_number(cli_bench_arguments *a, cli_error_points *points)
{
    int status = CLI_DONE;
    for (size_t i = 0; i < rheo_scene_builtin_count() && status == CLI_DONE; i++) {
        rheo_scene scene;
        char name[NAMES];
        if (rheo_scene_builtin_at(i, &scene) != RHEO_OK)
            continue;
        snprintf(name, sizeof name, "%s", scene.name);
        const rheo_model model = scene.world.model;
        const bool wanted = !a->model || strcmp(a->model, rheo_model_name(model)) == 0;
        rheo_scene_release(&scene);
        if (!wanted || !cli_case_wanted(a, name))
            continue;
        status = try_scene(name, model, a, points);
        if (cli_progress_due(&a->progress, cli_now()))
            cli_progress_say(&a->progress, cli_now(), "%s (%zu of %zu)", name, i + 1, rheo_scene_builtin_count());
    }
    return status;
}
