/*
 * Study steps: several settings of the thickening model. A ball falls into a pool, and a
 * drop on a floor. All settings of a scene start from the same settled state. Errors are relative to the limit
 * step -> 0, which is extrapolated from two fine steps of the default scheme: the error is of order 1.
 */
#include "cli/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/fall.h"

enum { DIP, RISE, DEPTH_5, DEPTH_10, TIME_1_5, REBOUND, HEIGHT_9, QUANTITIES };
static const char *const QUANTITY[QUANTITIES] = {"dip",      "rise",    "depth_5", "depth_10",
                                                 "time_1_5", "rebound", "height_9"};

/* Settings that exchange speed for accuracy. The first two determine the limit. */
static const struct {
    const char *name;
    double divisor;     /* of the step */
    const char *set[2]; /* path, value */
} SETTINGS[] = {
    {"step/8", 8, {NULL}},
    {"step/4", 4, {NULL}},
    {"step/2", 2, {NULL}},
    {"step", 1, {NULL}},
    {"substeps 2", 1, {"substeps", "2"}},
    {"substeps 3", 1, {"substeps", "3"}},
    {"substeps 4", 1, {"substeps", "4"}},
    {"sequential, step/8", 8, {"scheme", "sequential"}},
    {"sequential, step/4", 4, {"scheme", "sequential"}},
    {"sequential, step/2", 2, {"scheme", "sequential"}},
    {"sequential, step", 1, {"scheme", "sequential"}},
};
enum { TRIALS = sizeof SETTINGS / sizeof *SETTINGS };

/* ---- Settled states ---- */

typedef struct settled {
    rheo_world_def def;
    double surface, memory; /* level of the fluid; window of the history as a time */
    rheo_real *position, *velocity, *rest_length;
    uint32_t *ends;
} settled;

static void release(settled *s)
{
    free(s->position);
    free(s->velocity);
    free(s->rest_length);
    free(s->ends);
}

static rheo_result copy_springs(settled *s, const rheo_world *world, rheo_error *error)
{
    const size_t count = rheo_world_spring_count(world);
    rheo_spring *spring = malloc((count + 1) * sizeof *spring);
    s->ends = malloc((2 * count + 1) * sizeof *s->ends);
    s->rest_length = malloc((count + 1) * sizeof *s->rest_length);
    rheo_result result = RHEO_ERROR_MEMORY;
    if (spring && s->ends && s->rest_length)
        result = rheo_world_springs(world, spring, count);
    for (size_t k = 0; k < count && result == RHEO_OK; k++) {
        s->ends[2 * k] = spring[k].a;
        s->ends[2 * k + 1] = spring[k].b;
        s->rest_length[k] = spring[k].rest_length;
    }
    free(spring);
    if (result != RHEO_OK)
        snprintf(error->message, sizeof error->message, "no memory for %zu springs", count);
    s->def.particles.spring_count = (uint32_t)count;
    s->def.particles.spring_ends = s->ends;
    s->def.particles.spring_rest_length = s->rest_length;
    return result;
}

/* Makes the scene once. */
static rheo_result settle(settled *s, rheo_scene *scene, const cli_bench_arguments *a, rheo_error *error)
{
    rheo_world *world;
    if (a->settle.given)
        scene->settle.time = (double)a->settle.value * scene->world.step;
    *s = (settled){.def = scene->world};
    rheo_result result = rheo_scene_create_world(scene, &world, error);
    if (result != RHEO_OK)
        return result;
    const rheo_world_def *def = rheo_world_definition(world);
    const size_t bytes = 3 * (size_t)rheo_world_particle_count(world) * sizeof *s->position;
    s->def.fluid.number_density = def->fluid.number_density;
    memcpy(s->def.ball.position, def->ball.position, sizeof s->def.ball.position);
    s->surface = def->ball.position[1] - def->ball.radius - scene->ball.clearance;
    s->memory = (double)scene->world.history.window * scene->world.step;
    s->position = malloc(bytes + 1);
    s->velocity = malloc(bytes + 1);
    if (s->position && s->velocity) {
        memcpy(s->position, rheo_world_positions(world), bytes);
        memcpy(s->velocity, rheo_world_velocities(world), bytes);
        result = copy_springs(s, world, error);
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

/* ---- Runs ---- */

/* Result of a setting. */
typedef struct trial {
    uint32_t particles;
    uint64_t steps, hash;
    double step, substeps, ns; /* ns: least of the repetitions, per particle and step */
    double quantity[QUANTITIES];
} trial;

/* A run whose quantities are measured at the start and after each step. */
typedef struct run {
    const settled *from;
    double *quantity;
    double before, highest;      /* of a drop */
    int phase;                   /* of a drop. 0: falling, 1: rising after the first minimum, 2: over */
    double deepest, below_since; /* of a ball; depth and time, NaN until then */
    double *depth, *time;        /* of a ball, in each state so far */
    size_t rows, room;
    bool no_memory;
} run;

static double between(double a, double b, double share)
{
    return a + (b - a) * share;
}

static bool make_room(run *r)
{
    if (r->rows < r->room)
        return true;
    const size_t room = 2 * r->room + 1024;
    double *depth = realloc(r->depth, room * sizeof *depth);
    r->depth = depth ? depth : r->depth;
    double *time = realloc(r->time, room * sizeof *time);
    r->time = time ? time : r->time;
    r->no_memory = !depth || !time;
    r->room = r->no_memory ? r->room : room;
    return !r->no_memory;
}

/* Depth at a time; NaN if the run ends before. */
static double depth_at(const cli_depths *d, double time)
{
    size_t row = 1;
    while (row < d->rows && d->time[row] < time)
        row++;
    return row < d->rows
               ? between(d->depth[row], d->depth[row - 1], (d->time[row] - time) / (d->time[row] - d->time[row - 1]))
               : (double)NAN;
}

/* False: the ball has been below the surface for 10 units of time, and deep. */
static bool measure_ball(run *r, const rheo_world *world)
{
    rheo_body ball;
    rheo_world_body(world, 0, &ball);
    if (!make_room(r))
        return false;
    const double depth = (r->from->surface - ball.position[1] + ball.radius) / ball.radius,
                 time = rheo_world_time(world);
    r->depth[r->rows] = depth;
    r->time[r->rows++] = time;
    r->deepest = fmax(r->deepest, depth);
    if (depth > 0 && isnan(r->below_since))
        r->below_since = time;
    return !(time >= r->below_since + 10 && r->deepest > 1.5);
}

static void quantities_of_ball(const run *r)
{
    const cli_depths d = {r->rows, 1, r->depth, r->time};
    const cli_fall f = cli_fall_of(&d);
    const double deep = cli_depth_reached(&d, 1.5, 0);
    r->quantity[DIP] = f.sinks ? (double)NAN : r->depth[f.dip];
    r->quantity[RISE] = f.again ? f.rise : (double)NAN;
    r->quantity[DEPTH_5] = depth_at(&d, f.contact_at + 5);
    r->quantity[DEPTH_10] = depth_at(&d, f.contact_at + 10);
    r->quantity[TIME_1_5] = isinf(deep) ? (double)NAN : deep - f.contact_at;
}

/* Heights are those of the centre of mass. */
static bool measure_drop(run *r, const rheo_world *world)
{
    const uint32_t n = rheo_world_particle_count(world);
    const double time = rheo_world_time(world), length = rheo_world_definition(world)->step;
    double y = 0;
    for (uint32_t i = 0; i < n; i++)
        y += (double)rheo_world_positions(world)[3 * (size_t)i + 1] / n;
    if (r->phase == 0 && y > r->before) {
        r->phase = 1;
        r->highest = r->before;
    }
    if (r->phase == 1 && y < r->before) {
        r->phase = 2;
        r->quantity[REBOUND] = r->before - r->highest;
    }
    if (time >= 9 && isnan(r->quantity[HEIGHT_9]))
        r->quantity[HEIGHT_9] = between(y, r->before, (time - 9) / length);
    r->before = y;
    return isnan(r->quantity[HEIGHT_9]);
}

typedef struct experiment {
    const char *name;
    bool (*measure)(run *r, const rheo_world *world); /* false: all is measured */
    double longest;                                   /* time after which a run ends */
    int first, last;                                  /* quantities */
} experiment;

static rheo_result run_once(trial *t, const experiment *e, const settled *from, const rheo_world_def *def,
                            uint64_t most, rheo_error *error)
{
    rheo_world *world;
    rheo_result result = rheo_world_create(def, &world, error);
    if (result != RHEO_OK)
        return result;
    run r = {.from = from, .quantity = t->quantity, .before = NAN, .below_since = NAN};
    for (int q = 0; q < QUANTITIES; q++)
        t->quantity[q] = NAN;
    e->measure(&r, world);
    double seconds = 0;
    t->steps = 0;
    t->substeps = 0;
    for (bool more = true; more && t->steps < most && result == RHEO_OK; t->steps++) {
        const double start = cli_now();
        result = rheo_world_step(world, error);
        seconds += cli_now() - start;
        t->substeps += fmax(1, cli_bench_substeps(world));
        more = e->measure(&r, world);
    }
    if (r.rows && !r.no_memory)
        quantities_of_ball(&r);
    free(r.depth);
    free(r.time);
    if (result == RHEO_OK && r.no_memory) {
        snprintf(error->message, sizeof error->message, "no memory for the depths of %llu steps",
                 (unsigned long long)t->steps);
        result = RHEO_ERROR_MEMORY;
    }
    t->particles = rheo_world_particle_count(world);
    t->hash = rheo_world_hash(world);
    t->step = def->step;
    t->ns = fmin(t->ns, 1e9 * seconds / ((double)t->steps * t->particles));
    rheo_world_destroy(world);
    return result;
}

static int try_setting(trial *t, size_t setting, const experiment *e, const settled *from, cli_bench_arguments *a)
{
    rheo_error error = {""};
    rheo_world_def def = from->def;
    def.step /= SETTINGS[setting].divisor;
    def.history.window_seconds = from->memory;
    rheo_result result = RHEO_OK;
    if (SETTINGS[setting].set[0])
        result = rheo_world_def_set(&def, SETTINGS[setting].set[0], SETTINGS[setting].set[1], &error);
    const double most = a->steps ? (double)a->steps * SETTINGS[setting].divisor : ceil(e->longest / def.step);
    t->ns = INFINITY;
    for (uint32_t r = 0; r < a->repetitions && result == RHEO_OK; r++) {
        result = run_once(t, e, from, &def, (uint64_t)most, &error);
        if (cli_progress_due(&a->progress, cli_now()))
            cli_progress_say(&a->progress, cli_now(), "%s, %s (%zu of %d)", e->name, SETTINGS[setting].name,
                             setting + 1, TRIALS);
    }
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

/* ---- Errors ---- */

static int add_points(const experiment *e, const trial trials[TRIALS], cli_error_points *points)
{
    for (size_t i = 0; i < TRIALS; i++) {
        const trial *t = &trials[i];
        cli_error_point p = cli_error_no_point();
        snprintf(p.scene, sizeof p.scene, "%s", e->name);
        snprintf(p.setting, sizeof p.setting, "%s", SETTINGS[i].name);
        const char *const *set = SETTINGS[i].set;
        const bool same = set[0] && strcmp(set[0], "substeps") == 0; /* the same step, divided */
        snprintf(p.series, sizeof p.series, "%s", !set[0] ? "summed" : same ? "substeps" : set[1]);
        p.refinement = same ? 0 : t->step;
        p.particles = t->particles;
        p.steps = t->steps;
        p.hash = t->hash;
        p.substeps = t->substeps;
        p.ns_step = t->ns;
        p.us_time = 1e-3 * t->ns / t->step;
        for (int q = e->first; q <= e->last; q++) {
            snprintf(p.quantity, sizeof p.quantity, "%s", QUANTITY[q]);
            p.value = t->quantity[q];
            p.reference = 2 * trials[0].quantity[q] - trials[1].quantity[q];
            p.error = p.value / p.reference - 1;
            if (!cli_error_add(points, &p))
                return CLI_SYSTEM;
        }
    }
    return CLI_DONE;
}

static int try_all(const experiment *e, const settled *from, cli_bench_arguments *a, cli_error_points *points)
{
    trial trials[TRIALS] = {{0}};
    for (size_t i = 0; i < TRIALS; i++) {
        const int status = try_setting(&trials[i], i, e, from, a);
        if (status != CLI_DONE)
            return status;
    }
    return add_points(e, trials, points);
}

/* ---- Scenes ---- */

static int drop_ball(cli_bench_arguments *a, cli_error_points *points)
{
    static const experiment ball = {"bowling-ball-small", measure_ball, 20, DIP, TIME_1_5};
    rheo_scene scene;
    settled from = {0};
    rheo_error error = {""};
    rheo_result result = rheo_scene_builtin("bowling-ball-small", &scene, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    result = settle(&from, &scene, a, &error);
    const int status = result == RHEO_OK ? try_all(&ball, &from, a, points) : cli_error(result, &error);
    release(&from);
    rheo_scene_release(&scene);
    return status;
}

/* Parameter set S of docs/model.md: a drop of radius 5 h falls from 4 h. It settles without gravity. */
static int drop_drop(cli_bench_arguments *a, cli_error_points *points)
{
    static const experiment drop = {"drop", measure_drop, 9.1, REBOUND, HEIGHT_9};
    static const rheo_fill sphere = {.kind = RHEO_FILL_SPHERE, .radius = 5, .centre = {0, 9, 0}, .jitter = 0.1};
    static const rheo_wall floor = {{0, 0, 0}, {0, 1, 0}};
    rheo_scene scene = rheo_default_scene();
    rheo_world_def *def = &scene.world;
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
    const double gravity = def->gravity[1];
    def->gravity[1] = 0;
    scene.fill = &sphere;
    scene.fill_count = 1;
    scene.settle.time = 2;
    settled from = {0};
    rheo_error error = {""};
    const rheo_result result = settle(&from, &scene, a, &error);
    from.def.gravity[1] = gravity;
    from.def.walls.plane = &floor;
    from.def.walls.count = 1;
    const int status = result == RHEO_OK ? try_all(&drop, &from, a, points) : cli_error(result, &error);
    release(&from);
    return status;
}

int cli_error_steps(cli_bench_arguments *a, cli_error_points *points)
{
    const int status = drop_ball(a, points);
    return status == CLI_DONE ? drop_drop(a, points) : status;
}
