/* Cases of `rheolog bench error` in a pool: a ball falls on it, and it rests. See error_trials.h. */
#include "cli/error_trials.h"

#include <math.h>
#include <stdlib.h>

#include "cli/fall.h"

/* ---- A ball ---- */

enum { DIP, RISE, DEPTH_5, DEPTH_10, TIME_1_5 };

/* Depths in all states so far. */
typedef struct fall {
    double deepest, below_since; /* depth and time; below_since: 0 until then */
    double *depth, *time;
    size_t rows, room;
} fall;

static bool make_room(fall *f)
{
    if (f->rows < f->room)
        return true;
    const size_t room = 2 * f->room + 1024;
    double *depth = realloc(f->depth, room * sizeof *depth);
    f->depth = depth ? depth : f->depth;
    double *time = realloc(f->time, room * sizeof *time);
    f->time = time ? time : f->time;
    f->room = depth && time ? room : f->room;
    return depth && time;
}

/* False: the ball has been below the surface for 10 units of time, and deep. */
static bool measure_ball(cli_trial *t, rheo_world *world)
{
    const cli_settled *from = t->of->data;
    fall *f = t->memory;
    rheo_body ball;
    rheo_world_body(world, 0, &ball);
    if (!make_room(f)) {
        t->result = RHEO_ERROR_MEMORY;
        snprintf(t->error->message, sizeof t->error->message, "no memory for the depths of %zu steps", f->rows);
        return false;
    }
    const double depth = (from->surface - ball.position[1] + ball.radius) / ball.radius,
                 time = rheo_world_time(world);
    f->depth[f->rows] = depth;
    f->time[f->rows++] = time;
    f->deepest = fmax(f->deepest, depth);
    if (depth > 0 && f->below_since == 0)
        f->below_since = time;
    return !(f->below_since > 0 && time >= f->below_since + 10 && f->deepest > 1.5);
}

/* Depth at a time; NaN if the run ends before. */
static double depth_at(const cli_depths *d, double time)
{
    size_t row = 1;
    while (row < d->rows && d->time[row] < time)
        row++;
    if (row >= d->rows)
        return NAN;
    const double share = (d->time[row] - time) / (d->time[row] - d->time[row - 1]);
    return d->depth[row] + (d->depth[row - 1] - d->depth[row]) * share;
}

static void finish_ball(cli_trial *t)
{
    fall *f = t->memory;
    if (f->rows) {
        const cli_depths d = {f->rows, 1, f->depth, f->time};
        const cli_fall of = cli_fall_of(&d);
        const double deep = cli_depth_reached(&d, 1.5, 0);
        t->quantity[DIP] = of.sinks ? (double)NAN : f->depth[of.dip];
        t->quantity[RISE] = of.again ? of.rise : (double)NAN;
        /* A ball that has not turned lies on the floor. */
        t->quantity[DEPTH_5] = of.sinks ? (double)NAN : depth_at(&d, of.contact_at + 5);
        t->quantity[DEPTH_10] = of.sinks ? (double)NAN : depth_at(&d, of.contact_at + 10);
        t->quantity[TIME_1_5] = isinf(deep) ? (double)NAN : deep - of.contact_at;
    }
    free(f->depth);
    free(f->time);
}

cli_case cli_ball_case(const cli_settled *from, const char *name)
{
    return (cli_case){.name = name,
                      .quantity = {"dip", "rise", "depth_5", "depth_10", "time_1_5"},
                      .reference = {NAN, NAN, NAN, NAN, NAN},
                      .def = from->def,
                      .longest = 20,
                      .data = from,
                      .bytes = sizeof(fall),
                      .measure = measure_ball,
                      .finish = finish_ball};
}

/* ---- Rest ---- */

/*
 * The force of the pressures across the plane y = height by the law of docs/model.md at the present positions, divided by
 * the weight above the plane. There are no springs. Densities are those of the whole fluid. NaN: nothing above.
 */
static double weight_carried(const rheo_world *world, double height, const double *density,
                             const double *near_density)
{
    const rheo_world_def *def = rheo_world_definition(world);
    const rheo_real *x = rheo_world_positions(world);
    const uint32_t n = rheo_world_particle_count(world);
    const double h = def->fluid.support, k = def->fluid.stiffness, rest = def->fluid.rest_density,
                 least = def->scheme == RHEO_SCHEME_SEQUENTIAL ? -INFINITY : -def->fluid.cohesion * k;
    double force = 0, weight = 0;
    for (size_t i = 0; i < n; i++) {
        const double y = (double)x[3 * i + 1];
        weight += y > height ? -def->gravity[1] : 0;
        if (y <= height || y > height + h)
            continue;
        for (size_t j = 0; j < n; j++) {
            const double dy = y - (double)x[3 * j + 1];
            if (!(dy < h) || (double)x[3 * j + 1] > height)
                continue;
            const double dx = (double)(x[3 * i] - x[3 * j]), dz = (double)(x[3 * i + 2] - x[3 * j + 2]),
                         r = sqrt(dx * dx + dy * dy + dz * dz), w = 1 - r / h;
            if (w > 0)
                force += 0.5 * dy / r *
                         (w * (fmax(k * (density[i] - rest), least) + fmax(k * (density[j] - rest), least)) +
                          w * w * def->fluid.near_stiffness * (near_density[i] + near_density[j]));
        }
    }
    return weight > 0 ? force / weight : (double)NAN;
}

/* Planes are whole spacings above the floor, the first one spacing. */
enum { PLANES = 6, LAYERS = 8, SAMPLES = 24 };
/* Pressures are averaged from this time on, between samples. */
static const double CALM = 3, SAMPLE = 0.165;

typedef struct shares {
    double sum[PLANES];
    uint32_t samples;
} shares;

static bool measure_hydrostatics(cli_trial *t, rheo_world *world)
{
    shares *s = t->memory;
    const uint32_t n = rheo_world_particle_count(world);
    if (rheo_world_time(world) + 1e-9 < CALM + SAMPLE * s->samples)
        return true;
    double *density = malloc(2 * (size_t)n * sizeof *density);
    if (density)
        t->result = rheo_world_densities(world, density, density + n, t->error);
    else
        t->result = RHEO_ERROR_MEMORY;
    for (int p = 0; p < PLANES && t->result == RHEO_OK; p++)
        s->sum[p] += weight_carried(world, (p + 1) * t->def.fluid.spacing, density, density + n);
    free(density);
    s->samples++;
    return t->result == RHEO_OK && s->samples < SAMPLES;
}

static void finish_hydrostatics(cli_trial *t)
{
    const shares *s = t->memory;
    if (s->samples < SAMPLES)
        return;
    double worst = 1;
    for (int p = 0; p < PLANES; p++) {
        const double share = s->sum[p] / SAMPLES;
        worst = fabs(share - 1) > fabs(worst - 1) ? share : worst;
    }
    t->quantity[0] = worst;
}

/* Scheme positions has no pressures. Without springs neither their solver nor an onset changes anything. */
static bool has_pressure(const rheo_world_def *def)
{
    return def->scheme != RHEO_SCHEME_POSITIONS && def->springs.solver == RHEO_SOLVER_EXPLICIT &&
           def->history.onset > 0;
}

int cli_hydrostatics(const cli_setting *settings, size_t count, cli_bench_arguments *a, cli_error_points *points)
{
    rheo_scene scene;
    cli_settled from = {0};
    rheo_error error = {""};
    rheo_result result = cli_pool_scene(&scene, 10, LAYERS, 10, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    scene.world.ball.radius = 0;
    scene.world.springs.stiffness = 0;
    scene.world.history.stiffness = 0;
    result = cli_settle(&from, &scene, a, &error);
    rheo_scene_release(&scene);
    const cli_case c = {.name = "hydrostatics",
                        .quantity = {"pressure"},
                        .reference = {1},
                        .def = from.def,
                        .longest = CALM + SAMPLE * (SAMPLES + 1),
                        .bytes = sizeof(shares),
                        .has = has_pressure,
                        .measure = measure_hydrostatics,
                        .finish = finish_hydrostatics};
    const int status = result == RHEO_OK ? cli_try(&c, settings, count, a, points) : cli_error(result, &error);
    cli_settled_release(&from);
    return status;
}
