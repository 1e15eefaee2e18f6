/*
 * Experiments of which the results of the thickening model are measured: a settled state from which worlds of any step
 * start, and a falling ball, a falling drop and the balance of forces in them.
 */
#ifndef RHEO__TESTS_TRUTH_H
#define RHEO__TESTS_TRUTH_H

#include "support.h"

#include <math.h>

/* Settled particles with their springs. All worlds that start from one differ only in their parameters. */
typedef struct settled {
    rheo_world_def def; /* with the settled number density and the place of the ball */
    double surface;     /* level of the fluid, if there is a ball */
    rheo_real *position, *velocity, *rest_length;
    uint32_t *ends;
} settled;

static inline settled settle(const rheo_scene *scene)
{
    rheo_world *world;
    OK(rheo_scene_create_world(scene, &world, &error));
    settled s = {.def = scene->world};
    const rheo_world_def *def = rheo_world_definition(world);
    const uint32_t n = rheo_world_particle_count(world);
    const size_t springs = rheo_world_spring_count(world);
    s.def.fluid.spacing = def->fluid.spacing;
    s.def.fluid.number_density = def->fluid.number_density;
    memcpy(s.def.ball.position, def->ball.position, sizeof s.def.ball.position);
    s.surface = def->ball.position[1] - def->ball.radius - scene->ball.clearance;
    s.position = malloc(3 * (size_t)n * sizeof *s.position);
    s.velocity = malloc(3 * (size_t)n * sizeof *s.velocity);
    s.ends = malloc((2 * springs + 1) * sizeof *s.ends);
    s.rest_length = malloc((springs + 1) * sizeof *s.rest_length);
    rheo_spring *spring = malloc((springs + 1) * sizeof *spring);
    assert_true(s.position && s.velocity && s.ends && s.rest_length && spring);
    memcpy(s.position, rheo_world_positions(world), 3 * (size_t)n * sizeof *s.position);
    memcpy(s.velocity, rheo_world_velocities(world), 3 * (size_t)n * sizeof *s.velocity);
    OK(rheo_world_springs(world, spring, springs));
    for (size_t k = 0; k < springs; k++) {
        s.ends[2 * k] = spring[k].a;
        s.ends[2 * k + 1] = spring[k].b;
        s.rest_length[k] = spring[k].rest_length;
    }
    free(spring);
    rheo_world_destroy(world);
    s.def.particles.count = n;
    s.def.particles.position = s.position;
    s.def.particles.velocity = s.velocity;
    s.def.particles.spring_count = (uint32_t)springs;
    s.def.particles.spring_ends = s.ends;
    s.def.particles.spring_rest_length = s.rest_length;
    return s;
}

static inline void release(settled *s)
{
    free(s->position);
    free(s->velocity);
    free(s->ends);
    free(s->rest_length);
}

static inline rheo_world *start(const rheo_world_def *def)
{
    rheo_world *world;
    OK(rheo_world_create(def, &world, &error));
    return world;
}

/* ---- A ball that falls into a pool ---- */

/* Depths of the lowest point of the ball below the surface, in radii; times from contact. NaN: not reached. */
typedef struct fall {
    double dip, rise;     /* first minimum, and rise after it */
    double five, ten;     /* depths after 5 and 10 units of time */
    double one_half, two; /* times to 1.5 and 2 radii */
    double contact_speed,
        max_speed;     /* of the ball at contact; of the fastest particle, from then on; infinite if the run fails */
    double last_speed; /* of the fastest particle at the end */
} fall;

/* Time at which a quantity that was `before` one step ago and is `now` was `level`. */
static inline double crossing(double level, double before, double now, double time, double length)
{
    return time - length * (now - level) / (now - before);
}

static inline fall drop_ball(const rheo_world_def *def, double surface, double time_after_contact)
{
    rheo_world *world = start(def);
    fall f = {NAN, 0, NAN, NAN, NAN, NAN, 0, 0, 0};
    double before = -INFINITY, highest = 0, contact = NAN;
    int phase = 0; /* 0 falling, 1 rising after the first minimum, 2 over */
    while (!(rheo_world_time(world) >= contact + time_after_contact)) {
        rheo_body ball;
        rheo_error why;
        if (rheo_world_step(world, &why) != RHEO_OK) {
            f.max_speed = INFINITY;
            break;
        }
        OK(rheo_world_body(world, 0, &ball));
        const double depth = (surface - (ball.position[1] - ball.radius)) / ball.radius,
                     time = rheo_world_time(world);
        const double since = time - contact;
        if (depth > 0 && isnan(contact)) {
            contact = isinf(before) ? time : crossing(0, before, depth, time, def->step);
            f.contact_speed = fabs(ball.velocity[1]);
        } else if (!isnan(contact)) {
            if (phase == 0 && depth < before) {
                phase = 1;
                f.dip = highest = before;
            }
            if (phase == 1) {
                highest = fmin(highest, depth);
                f.rise = f.dip - highest;
                phase = depth > highest + 0.03 ? 2 : 1;
            }
            if (since >= 5 && isnan(f.five))
                f.five = depth + (before - depth) * (since - 5) / def->step;
            if (since >= 10 && isnan(f.ten))
                f.ten = depth + (before - depth) * (since - 10) / def->step;
            if (depth > 1.5 && isnan(f.one_half))
                f.one_half = crossing(1.5, before, depth, since, def->step);
            if (depth > 2 && isnan(f.two))
                f.two = crossing(2, before, depth, since, def->step);
            f.last_speed = metric(world, "max_speed");
            f.max_speed = fmax(f.max_speed, f.last_speed);
        }
        before = depth;
    }
    rheo_world_destroy(world);
    return f;
}

/* ---- A drop ---- */

/* Height of the centre of mass. */
static inline double centre_height(const rheo_world *world)
{
    const uint32_t n = rheo_world_particle_count(world);
    double sum = 0;
    for (uint32_t i = 0; i < n; i++)
        sum += (double)rheo_world_positions(world)[3 * (size_t)i + 1];
    return sum / n;
}

/* Angular velocity of a rigid body with the particles' places and angular momentum, about their centre of mass. */
static inline double spin_of(const rheo_world *world)
{
    const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
    const uint32_t n = rheo_world_particle_count(world);
    double c[3] = {0}, u[3] = {0}, moment[3] = {0}, inertia = 0;
    for (size_t i = 0; i < 3 * (size_t)n; i++) {
        c[i % 3] += (double)x[i] / n;
        u[i % 3] += (double)v[i] / n;
    }
    for (size_t i = 0; i < n; i++) {
        double d[3], w[3];
        for (size_t a = 0; a < 3; a++) {
            d[a] = (double)x[3 * i + a] - c[a];
            w[a] = (double)v[3 * i + a] - u[a];
            inertia += d[a] * d[a] * 2 / 3; /* of a body that is nearly a ball: the same about every axis */
        }
        for (size_t a = 0; a < 3; a++)
            moment[a] += d[(a + 1) % 3] * w[(a + 2) % 3] - d[(a + 2) % 3] * w[(a + 1) % 3];
    }
    return sqrt(moment[0] * moment[0] + moment[1] * moment[1] + moment[2] * moment[2]) / inertia;
}

static inline double rms_speed(const rheo_world *world)
{
    const size_t n = 3 * (size_t)rheo_world_particle_count(world);
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += (double)rheo_world_velocities(world)[i] * (double)rheo_world_velocities(world)[i];
    return sqrt(3 * sum / (double)n);
}

/* Largest stiffness K of a spring. */
static inline double largest_stiffness(const rheo_world *world)
{
    uint64_t substeps = 1;
    rheo_field_info info;
    for (uint32_t i = 0; rheo_world_field(world, i, &info) == RHEO_OK; i++)
        if (strcmp(info.name, "substeps") == 0)
            OK(rheo_world_field_read(world, i, &substeps, sizeof substeps));
    return metric(world, "stiffness_number") * pow((double)substeps / rheo_world_definition(world)->step, 2);
}

/* ---- The balance of forces ---- */

/*
 * The force across the plane y = height by the law of docs/model.md at the present positions, divided by the weight
 * above the plane: pressures, and springs of stiffness k_min, as history adds nothing at rest.
 */
static inline double weight_carried(const rheo_world *world, double height)
{
    const rheo_world_def *def = rheo_world_definition(world);
    const rheo_real *x = rheo_world_positions(world);
    const uint32_t n = rheo_world_particle_count(world);
    const double h = def->fluid.support, least = -def->fluid.cohesion * def->fluid.stiffness;
    double *density = malloc(n * sizeof *density), *near_density = malloc(n * sizeof *near_density);
    assert_true(density && near_density);
    OK(rheo_world_densities(world, density, near_density, &error));
    const size_t springs = rheo_world_spring_count(world);
    rheo_spring *spring = malloc((springs + 1) * sizeof *spring);
    assert_non_null(spring);
    OK(rheo_world_springs(world, spring, springs));
    double force = 0, weight = 0;
    for (uint32_t i = 0; i < n; i++) {
        const double yi = (double)x[3 * (size_t)i + 1];
        weight += yi > height ? -def->gravity[1] : 0;
        if (yi <= height || yi > height + h)
            continue;
        for (uint32_t j = 0; j < n; j++) {
            const double dy = yi - (double)x[3 * (size_t)j + 1];
            if (!(dy < h) || (double)x[3 * (size_t)j + 1] > height)
                continue;
            const double dx = (double)x[3 * (size_t)i] - (double)x[3 * (size_t)j],
                         dz = (double)x[3 * (size_t)i + 2] - (double)x[3 * (size_t)j + 2],
                         r = sqrt(dx * dx + dy * dy + dz * dz), w = 1 - r / h;
            if (!(w > 0))
                continue;
            const double pi = fmax(def->fluid.stiffness * (density[i] - def->fluid.rest_density), least),
                         pj = fmax(def->fluid.stiffness * (density[j] - def->fluid.rest_density), least);
            force += 0.5 * (w * (pi + pj) + w * w * def->fluid.near_stiffness * (near_density[i] + near_density[j])) *
                     dy / r;
        }
    }
    for (size_t k = 0; k < springs; k++) {
        const rheo_real *a = x + 3 * (size_t)spring[k].a, *b = x + 3 * (size_t)spring[k].b;
        if (((double)a[1] > height) == ((double)b[1] > height))
            continue;
        const double dx = (double)(a[0] - b[0]), dy = (double)(a[1] - b[1]), dz = (double)(a[2] - b[2]),
                     r = sqrt(dx * dx + dy * dy + dz * dz);
        force -= 0.5 * def->springs.stiffness * (r - (double)spring[k].rest_length) * fabs(dy) / r;
    }
    free(density);
    free(near_density);
    free(spring);
    return force / weight;
}

/* A pool of nx x ny x nz particles with the walls of the built-in scenes. */
static inline rheo_scene pool_scene(int nx, int ny, int nz)
{
    rheo_scene scene = builtin_scene("bowling-ball-small");
    const double spacing = scene.world.fluid.spacing;
    fills_of(&scene)[0].max[0] = walls_of(&scene.world)[2].point[0] = nx * spacing;
    fills_of(&scene)[0].max[1] = ny * spacing;
    fills_of(&scene)[0].max[2] = walls_of(&scene.world)[4].point[2] = nz * spacing;
    scene.world.ball.position[0] = 0.5 * nx * spacing;
    scene.world.ball.position[2] = 0.5 * nz * spacing;
    return scene;
}

/* The drop of parameter set S of the documentation, at rest: a ball of radius 5 h, 4 h above the floor. */
static inline rheo_scene drop_scene(void)
{
    rheo_scene scene = rheo_default_scene();
    static const char *const set[][2] = {
        {"step", "0.0165"},
        {"fluid.support", "1"},
        {"fluid.spacing", "0.5"},
        {"springs.stiffness", "150"},
        {"history.stiffness", "1500"},
        {"springs.plasticity", "3"},
        {"springs.yield_ratio", "0.03"},
        {"fluid.linear_viscosity", "1"},
        {"fluid.quadratic_viscosity", "0.3"},
        {"history.onset", "0.0125"},
    };
    for (size_t i = 0; i < sizeof set / sizeof *set; i++)
        OK(rheo_scene_set(&scene, set[i][0], set[i][1], &error));
    scene.fill = some_fills();
    scene.fill_count = 1;
    rheo_fill *fill = fills_of(&scene);
    fill->kind = RHEO_FILL_SPHERE;
    fill->radius = 5;
    fill->centre[1] = 9;
    fill->jitter = 0.1;
    memset(scene.world.gravity, 0, sizeof scene.world.gravity);
    scene.settle.time = 2;
    return scene;
}

/* Centre of mass of the drop: first minimum, rise to the maximum after it, height at time 9. NaN: not reached. */
typedef struct bounce {
    double lowest, rebound, nine;
} bounce;

static inline bounce drop_drop(const rheo_world_def *def, double time)
{
    rheo_world *world = start(def);
    bounce b = {NAN, NAN, NAN};
    double before = centre_height(world);
    while (rheo_world_time(world) < time) {
        step(world, 1);
        const double y = centre_height(world), now = rheo_world_time(world);
        if (isnan(b.lowest) && y > before)
            b.lowest = before;
        if (!isnan(b.lowest) && isnan(b.rebound) && y < before)
            b.rebound = before - b.lowest;
        if (now >= 9 && isnan(b.nine))
            b.nine = y + (before - y) * (now - 9) / def->step;
        before = y;
    }
    rheo_world_destroy(world);
    return b;
}

/* The definition of the falling drop, which starts from its state without gravity. */
static inline rheo_world_def falling_drop(const settled *s)
{
    rheo_world_def def = s->def;
    def.gravity[1] = -9.81;
    def.walls.plane = some_walls();
    def.walls.count = 1;
    walls_of(&def)[0].normal[1] = 1;
    def.history.window_seconds = 2.475;
    return def;
}

#endif
