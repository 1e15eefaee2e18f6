/* Settled states, and runs of several settings from them; see error_trials.h. */
#include "cli/error_trials.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/error_start.h"

/* ---- Settled states ---- */

void cli_settled_release(cli_settled *s)
{
    free(s->position);
    free(s->velocity);
    free(s->rest_length);
    free(s->ends);
    free(s->wall);
    *s = (cli_settled){.surface = NAN};
}

rheo_result cli_settle(cli_settled *s, rheo_scene *scene, const cli_bench_arguments *a, rheo_error *error)
{
    rheo_world *world;
    if (a->settle.given)
        scene->settle.time = (double)a->settle.value * scene->world.step;
    *s = (cli_settled){.def = scene->world};
    rheo_result result = rheo_scene_create_world(scene, &world, error);
    if (result != RHEO_OK)
        return result;
    const rheo_world_def *def = rheo_world_definition(world);
    const size_t bytes = 3 * (size_t)rheo_world_particle_count(world) * sizeof *s->position;
    s->def.fluid.number_density = def->fluid.number_density;
    memcpy(s->def.ball.position, def->ball.position, sizeof s->def.ball.position);
    s->surface = def->ball.position[1] - def->ball.radius - scene->ball.clearance;
    s->def.history.window_seconds = (double)scene->world.history.window * scene->world.step;
    s->position = malloc(bytes + 1);
    s->velocity = malloc(bytes + 1);
    s->wall = malloc((def->walls.count + 1) * sizeof *s->wall);
    s->def.walls.plane = s->wall;
    if (s->position && s->velocity && s->wall) {
        for (uint32_t w = 0; w < def->walls.count; w++)
            s->wall[w] = scene->world.walls.plane[w];
        memcpy(s->position, rheo_world_positions(world), bytes);
        memcpy(s->velocity, rheo_world_velocities(world), bytes);
        result = cli_start_springs(&s->def, &s->ends, &s->rest_length, world, error);
    } else {
        result = RHEO_ERROR_MEMORY;
        snprintf(error->message, sizeof error->message, "no memory for the settled particles");
    }
    s->def.particles.count = rheo_world_particle_count(world);
    s->def.particles.position = s->position;
    s->def.particles.velocity = s->velocity;
    rheo_world_destroy(world);
    return result;
}

rheo_result cli_pool_scene(rheo_scene *scene, int nx, int ny, int nz, rheo_error *error)
{
    const rheo_result result = rheo_scene_builtin("bowling-ball-small", scene, error);
    if (result != RHEO_OK)
        return result;
    const double spacing = scene->world.fluid.spacing;
    rheo_fill *block = scene->owned.fill;
    rheo_wall *wall = scene->owned.plane;
    block->max[0] = wall[2].point[0] = nx * spacing;
    block->max[1] = ny * spacing;
    block->max[2] = wall[4].point[2] = nz * spacing;
    scene->world.ball.position[0] = 0.5 * nx * spacing;
    scene->world.ball.position[2] = 0.5 * nz * spacing;
    return RHEO_OK;
}

void cli_drop_scene(rheo_scene *scene, rheo_fill *sphere, double radius)
{
    *scene = rheo_default_scene();
    *sphere = (rheo_fill){.kind = RHEO_FILL_SPHERE, .radius = radius, .centre = {0, 9, 0}, .jitter = 0.1};
    rheo_world_def *def = &scene->world;
    def->step = 0.0165;
    def->fluid.support = 1;
    def->fluid.spacing = 0.5;
    def->fluid.linear_viscosity = 1;
    def->fluid.quadratic_viscosity = 0.3;
    def->springs.stiffness = 150;
    def->springs.plasticity = 3;
    def->springs.yield_ratio = 0.03;
    def->history.stiffness = 1500;
    def->history.onset = 0.0125;
    def->gravity[1] = 0;
    scene->fill = sphere;
    scene->fill_count = 1;
    scene->settle.time = 2;
}

/* ---- Runs ---- */

static rheo_result define(cli_trial *t, const cli_case *c, const cli_setting *setting, rheo_error *error)
{
    rheo_result result = RHEO_OK;
    *t = (cli_trial){.of = c, .def = c->def, .error = error};
    t->def.step /= setting->divisor;
    for (int i = 0; i < CLI_SETS && setting->set[i][0] && result == RHEO_OK; i++)
        result = rheo_world_def_set(&t->def, setting->set[i][0], setting->set[i][1], error);
    if (t->def.scheme == RHEO_SCHEME_POSITIONS) /* it refuses springs */
        t->def.particles.spring_count = 0;
    return result;
}

rheo_result cli_trial_run(cli_trial *t, uint64_t most, rheo_error *error)
{
    const cli_case *c = t->of;
    rheo_world *world;
    rheo_result result = rheo_world_create(&t->def, &world, error);
    if (result != RHEO_OK)
        return result;
    for (int q = 0; q < CLI_QUANTITIES; q++)
        t->quantity[q] = NAN;
    memset(t->memory, 0, c->bytes);
    t->steps = 0;
    t->substeps = 0;
    t->result = RHEO_OK;
    double seconds = 0;
    for (bool more = c->measure(t, world); more && t->steps < most; t->steps++) {
        const double start = cli_processor_time();
        result = rheo_world_step(world, error);
        seconds += cli_processor_time() - start;
        if (result != RHEO_OK)
            break;
        t->substeps += fmax(1, cli_bench_substeps(world));
        more = c->measure(t, world);
    }
    if (c->finish)
        c->finish(t);
    t->particles = rheo_world_particle_count(world);
    t->hash = rheo_world_hash(world);
    t->ns = 1e9 * seconds / (fmax(1, (double)t->steps) * t->particles);
    rheo_world_destroy(world);
    if (result == RHEO_OK)
        result = t->result;
    if (result == RHEO_ERROR_STATE) { /* of this world, or of one that measure() runs beside it */
        for (int q = 0; q < CLI_QUANTITIES; q++)
            t->quantity[q] = NAN;
        result = RHEO_OK;
    }
    return result;
}

/* ---- Errors ---- */

/* The limit step -> 0 of the law of a setting: 2 f(finest) - f(next), as the error is of order 1. NaN: none. */
static double limit_of(const cli_trial *trials, const cli_setting *settings, size_t count, const char *law, int q)
{
    size_t finest = count, next = count;
    for (size_t s = 0; s < count; s++)
        if (strcmp(settings[s].law, law) == 0 && settings[s].limit)
            finest = s;
    for (size_t s = 0; s < count && finest < count; s++)
        if (strcmp(settings[s].law, law) == 0 && settings[s].divisor == settings[finest].divisor / 2 &&
            strcmp(settings[s].series, law) == 0)
            next = s;
    return next < count ? 2 * trials[finest].quantity[q] - trials[next].quantity[q] : (double)NAN;
}

static int add_points(const cli_trial *trials, const double *ns, const cli_setting *settings, const bool *runs,
                      size_t count, cli_error_points *points)
{
    const cli_case *c = trials->of;
    for (int q = 0; q < CLI_QUANTITIES && c->quantity[q]; q++)
        for (size_t s = 0; s < count; s++) {
            if (!runs[s])
                continue;
            const cli_trial *t = &trials[s];
            cli_error_point p = cli_error_no_point();
            snprintf(p.scene, sizeof p.scene, "%s", c->name);
            snprintf(p.setting, sizeof p.setting, "%s", settings[s].name);
            snprintf(p.quantity, sizeof p.quantity, "%s", c->quantity[q]);
            if (settings[s].series[0]) {
                snprintf(p.series, sizeof p.series, "%s", settings[s].series);
                p.refinement = t->def.step / fmax(1, (double)t->def.substeps);
            }
            p.value = t->quantity[q];
            p.reference =
                isnan(c->reference[q]) ? limit_of(trials, settings, count, settings[s].law, q) : c->reference[q];
            p.error = c->absolute[q] || p.reference == 0 ? p.value - p.reference : p.value / p.reference - 1;
            p.ns_step = ns[s];
            p.us_time = 1e-3 * ns[s] / t->def.step;
            p.substeps = t->substeps;
            p.particles = t->particles;
            p.steps = t->steps;
            p.hash = t->hash;
            if (!cli_error_add(points, &p))
                return CLI_SYSTEM;
        }
    return CLI_DONE;
}

/* ---- All settings of a case ---- */

/* Settings that only make a limit do not run where all references are closed forms. */
static bool is_run(const cli_case *c, const cli_setting *setting, const rheo_world_def *def)
{
    bool closed = true;
    for (int q = 0; q < CLI_QUANTITIES && c->quantity[q]; q++)
        closed = closed && !isnan(c->reference[q]);
    return !(closed && setting->limit) && (!c->has || c->has(def));
}

static rheo_result run_all(cli_trial *trials, double *ns, void *memory, const cli_setting *settings, const bool *runs,
                           size_t count, cli_bench_arguments *a, rheo_error *error)
{
    const cli_case *c = trials->of;
    rheo_result result = RHEO_OK;
    for (uint32_t r = 0; r < a->repetitions; r++)
        for (size_t s = 0; s < count && result == RHEO_OK; s++) {
            if (!runs[s])
                continue;
            const double most =
                a->steps ? ceil((double)a->steps * settings[s].divisor) : ceil(c->longest / trials[s].def.step);
            trials[s].memory = memory;
            result = cli_trial_run(&trials[s], (uint64_t)most, error);
            ns[s * a->repetitions + r] = trials[s].ns;
            if (cli_progress_due(&a->progress, cli_now()))
                cli_progress_say(&a->progress, cli_now(), "%s, %s (%zu of %zu)", c->name, settings[s].name, s + 1,
                                 count);
        }
    for (size_t s = 0; s < count && result == RHEO_OK; s++)
        ns[s] = runs[s] ? cli_bench_median(ns + s * a->repetitions, a->repetitions) : (double)NAN;
    return result;
}

int cli_try(const cli_case *c, const cli_setting *settings, size_t count, cli_bench_arguments *a,
            cli_error_points *points)
{
    rheo_error error = {""};
    cli_trial *trials = calloc(count, sizeof *trials);
    double *ns = malloc(count * a->repetitions * sizeof *ns);
    bool *runs = malloc(count * sizeof *runs);
    void *memory = malloc(c->bytes + 1);
    int status = CLI_DONE;
    if (trials && ns && runs && memory) {
        rheo_result result = RHEO_OK;
        for (size_t s = 0; s < count && result == RHEO_OK; s++) {
            result = define(&trials[s], c, &settings[s], &error);
            runs[s] = is_run(c, &settings[s], &trials[s].def);
        }
        if (result == RHEO_OK)
            result = run_all(trials, ns, memory, settings, runs, count, a, &error);
        status =
            result == RHEO_OK ? add_points(trials, ns, settings, runs, count, points) : cli_error(result, &error);
    } else {
        status = cli_fail(CLI_SYSTEM, "no memory for %zu settings of %s", count, c->name);
    }
    free(trials);
    free(ns);
    free(runs);
    free(memory);
    return status;
}

bool cli_case_wanted(const cli_bench_arguments *a, const char *name)
{
    if (!a->cases)
        return !a->scenes || cli_error_list_has(a->scenes, name);
    const size_t length = strlen(a->cases);
    if (!cli_error_list_has(a->cases, name))
        snprintf(a->cases + length, CLI_CASE_NAMES - length, "%s%s", length ? "," : "", name);
    return false;
}

int cli_try_cases(const cli_named_case *cases, size_t count, cli_bench_arguments *a, cli_error_points *points)
{
    int status = CLI_DONE;
    for (size_t i = 0; i < count && status == CLI_DONE; i++)
        if (cli_case_wanted(a, cases[i].name))
            status = cases[i].run(a, points);
    return status;
}
