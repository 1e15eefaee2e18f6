/*
 * Helpers for the tests of the melting model: bodies of fluid, their worlds, a periodic cell, and measures of a
 * state. Tests print the figures that docs/melting.md quotes.
 */
#ifndef RHEO__TESTS_MELTING_SUPPORT_H
#define RHEO__TESTS_MELTING_SUPPORT_H

#include "support.h"

#include <math.h>

#include "melting/rheology.h"
#include "world/model_melting.h"

#define IS_FLOAT (sizeof(rheo_real) == 4)
static const double PI = 3.14159265358979323846;

static inline rheo_world_def melt_def(double spacing)
{
    rheo_world_def def = rheo_default_model_def(RHEO_MODEL_MELTING);
    def.fluid.spacing = spacing;
    return def;
}

static inline void set(rheo_world_def *def, const char *path, const char *value)
{
    OK(rheo_world_def_set(def, path, value, &error));
}

/* A fluid of constant viscosity. */
static inline rheo_world_def newtonian_def(double spacing, double viscosity)
{
    rheo_world_def def = melt_def(spacing);
    def.melting.rheology = RHEO_RHEOLOGY_NEWTONIAN;
    def.melting.viscosity = viscosity;
    return def;
}

static inline void add_wall(rheo_world_def *def, double x, double y, double z, double nx, double ny, double nz)
{
    if (!def->walls.count)
        def->walls.plane = some_walls();
    walls_of(def)[def->walls.count++] = (rheo_wall){{x, y, z}, {nx, ny, nz}};
}

/* Floor and four sides of a box with a corner at the origin. */
static inline void add_box(rheo_world_def *def, double width, double depth)
{
    add_wall(def, 0, 0, 0, 0, 1, 0);
    add_wall(def, 0, 0, 0, 1, 0, 0);
    add_wall(def, width, 0, 0, -1, 0, 0);
    add_wall(def, 0, 0, 0, 0, 0, 1);
    add_wall(def, 0, 0, depth, 0, 0, -1);
}

/* ---- Bodies of fluid ---- */

typedef struct fluid {
    uint32_t count, capacity;
    rheo_real *x, *v, *density, *temperature; /* temperature: used if `warm` */
    bool warm;
} fluid;

static uint64_t random_state = 1;
static inline double random_unit(void)
{
    random_state = random_state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(random_state >> 11) / 9007199254740992.0;
}

static inline void add_particle(fluid *f, double x, double y, double z)
{
    if (f->count == f->capacity) {
        f->capacity = 2 * f->capacity + 64;
        f->x = realloc(f->x, 3 * f->capacity * sizeof *f->x);
        f->v = realloc(f->v, 3 * f->capacity * sizeof *f->v);
        f->density = realloc(f->density, f->capacity * sizeof *f->density);
        f->temperature = realloc(f->temperature, f->capacity * sizeof *f->temperature);
        assert_true(f->x && f->v && f->density && f->temperature);
    }
    const uint32_t i = f->count++;
    f->x[3 * i] = (rheo_real)x;
    f->x[3 * i + 1] = (rheo_real)y;
    f->x[3 * i + 2] = (rheo_real)z;
    f->v[3 * i] = f->v[3 * i + 1] = f->v[3 * i + 2] = 0;
    f->density[i] = 1;
    f->temperature[i] = 0;
}

/*
 * A cubic lattice of nx x ny x nz. Its outer faces are half a spacing beyond the particles, which are moved by up to
 * `jitter` spacings.
 */
static inline void add_lattice(fluid *f, double spacing, const double corner[3], int nx, int ny, int nz,
                               double jitter)
{
    for (int k = 0; k < nz; k++)
        for (int j = 0; j < ny; j++)
            for (int i = 0; i < nx; i++) {
                const double place[3] = {i + 0.5, j + 0.5, k + 0.5};
                double x[3];
                for (int axis = 0; axis < 3; axis++)
                    x[axis] = corner[axis] + spacing * (place[axis] + jitter * (2 * random_unit() - 1));
                add_particle(f, x[0], x[1], x[2]);
            }
}

static inline fluid lattice(double spacing, int nx, int ny, int nz, double jitter)
{
    fluid f = {0};
    add_lattice(&f, spacing, (double[3]){0, 0, 0}, nx, ny, nz, jitter);
    return f;
}

/* Lattice points closer to the origin than a radius. */
static inline fluid sphere(double spacing, double radius)
{
    fluid f = {0};
    const int n = (int)(radius / spacing) + 1;
    for (int k = -n; k < n; k++)
        for (int j = -n; j < n; j++)
            for (int i = -n; i < n; i++) {
                const double x = (i + 0.5) * spacing, y = (j + 0.5) * spacing, z = (k + 0.5) * spacing;
                if (x * x + y * y + z * z < radius * radius)
                    add_particle(&f, x, y, z);
            }
    return f;
}

/* Sets hydrostatic densities. */
static inline void start_hydrostatically(fluid *f, const rheo_world_def *def, double top)
{
    for (uint32_t i = 0; i < f->count; i++)
        f->density[i] = (rheo_real)(1 - def->gravity[1] * (top - (double)f->x[3 * i + 1]) /
                                            (def->melting.sound_speed * def->melting.sound_speed));
}

/* The temperature is the height divided by `top`. */
static inline void warm_by_height(fluid *f, double top)
{
    f->warm = true;
    for (uint32_t i = 0; i < f->count; i++)
        f->temperature[i] = (rheo_real)((double)f->x[3 * i + 1] / top);
}

static inline void release_fluid(fluid *f)
{
    free(f->x);
    free(f->v);
    free(f->density);
    free(f->temperature);
    *f = (fluid){0};
}

/* Makes a world and releases the fluid. */
static inline rheo_world *melt_of(rheo_world_def def, fluid f)
{
    rheo_world *world = NULL;
    def.particles.count = f.count;
    def.particles.position = f.x;
    def.particles.velocity = f.v;
    def.particles.density = f.density;
    def.particles.temperature = f.warm ? f.temperature : NULL;
    OK(rheo_world_create(&def, &world, &error));
    release_fluid(&f);
    return world;
}

/* A box of nx x ny x nz particles on the floor, cold below and hot above. */
static inline rheo_world *melting_box(rheo_world_def def, int nx, int ny, int nz)
{
    const double dx = def.fluid.spacing;
    fluid f = lattice(dx, nx, ny, nz, 0);
    start_hydrostatically(&f, &def, ny * dx);
    warm_by_height(&f, ny * dx);
    if (def.walls.count == 0)
        add_wall(&def, 0, 0, 0, 0, 1, 0);
    return melt_of(def, f);
}

/* ---- A periodic cell ---- */

/*
 * The cell's own particles come first, then its eight images in x and z, updated between substeps. The cell must be
 * at least two supports wide, so that errors at the rim of the images do not reach it within a substep. A step is one
 * substep.
 */
typedef struct periodic {
    rheo_world *world;
    uint32_t own;
    double width, depth;
} periodic;

static inline void update_images(periodic *p)
{
    rheo__state *s = &p->world->state;
    for (uint32_t i = 0; i < p->own; i++) {
        const double turns[2] = {floor((double)s->position[3 * i] / p->width),
                                 floor((double)s->position[3 * i + 2] / p->depth)};
        s->position[3 * i] -= (rheo_real)(turns[0] * p->width);
        s->position[3 * i + 2] -= (rheo_real)(turns[1] * p->depth);
    }
    uint32_t image = p->own;
    for (int k = -1; k <= 1; k++)
        for (int l = -1; l <= 1; l++) {
            if (k == 0 && l == 0)
                continue;
            for (uint32_t i = 0; i < p->own; i++, image++) {
                s->position[3 * image] = s->position[3 * i] + (rheo_real)(k * p->width);
                s->position[3 * image + 1] = s->position[3 * i + 1];
                s->position[3 * image + 2] = s->position[3 * i + 2] + (rheo_real)(l * p->depth);
                memcpy(s->velocity + 3 * image, s->velocity + 3 * i, 3 * sizeof *s->velocity);
                s->density[image] = s->density[i];
                if (s->temperature)
                    s->temperature[image] = s->temperature[i];
            }
        }
}

static inline periodic periodic_of(rheo_world_def def, fluid cell, double width, double depth)
{
    const uint32_t own = cell.count;
    for (uint32_t copy = 1; copy < 9; copy++)
        for (uint32_t i = 0; i < own; i++)
            add_particle(&cell, (double)cell.x[3 * i], (double)cell.x[3 * i + 1], (double)cell.x[3 * i + 2]);
    def.melting.substeps = 1;
    periodic p = {melt_of(def, cell), own, width, depth};
    update_images(&p);
    return p;
}

static inline void step_periodic(periodic *p, int steps)
{
    for (int i = 0; i < steps; i++) {
        step(p->world, 1);
        update_images(p);
    }
}

/* ---- Measurements ---- */

static inline void momentum_of(const rheo_world *world, double sum[3])
{
    sum[0] = sum[1] = sum[2] = 0;
    for (uint32_t i = 0; i < world->state.particles; i++)
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += (double)world->state.velocity[3 * i + axis];
}

/* Angular momentum about the y axis, for particles of mass 1. */
static inline double spin_of(const rheo_world *world)
{
    double sum = 0;
    for (uint32_t i = 0; i < world->state.particles; i++) {
        const rheo_real *x = world->state.position + 3 * i, *v = world->state.velocity + 3 * i;
        sum += (double)x[2] * (double)v[0] - (double)x[0] * (double)v[2];
    }
    return sum;
}

static inline double heat_of(const rheo_world *world)
{
    double sum = 0;
    for (uint32_t i = 0; i < world->state.particles; i++)
        sum += (double)world->state.temperature[i];
    return sum;
}

static inline double lowest(const rheo_world *world, int axis)
{
    double least = 1e300;
    for (uint32_t i = 0; i < world->state.particles; i++)
        least = fmin(least, (double)world->state.position[3 * i + axis]);
    return least;
}
static inline double highest(const rheo_world *world, int axis)
{
    double most = -1e300;
    for (uint32_t i = 0; i < world->state.particles; i++)
        most = fmax(most, (double)world->state.position[3 * i + axis]);
    return most;
}
static inline double fastest(const rheo_world *world)
{
    double most = 0;
    for (uint32_t i = 0; i < world->state.particles; i++) {
        const rheo_real *v = world->state.velocity + 3 * i;
        most = fmax(most, sqrt((double)rheo__length2(v[0], v[1], v[2])));
    }
    return most;
}

/* Sums over a particle and its neighbours, without walls: gradient of the density, and the density itself. */
typedef struct density_sums {
    double gradient[3], density, nearest; /* nearest: distance of the closest particle, in spacings */
} density_sums;

static inline density_sums sums_at(const rheo_world *world, uint32_t i)
{
    const rheo__melting *m = rheo__melting_of(world);
    const rheo_real *position = world->state.position, *x = position + 3 * i;
    const double h = m->smoothing_length, scale = rheo__melting_mass(m->def) * (double)m->kernel_scale;
    density_sums sums = {.density = 66 * scale, .nearest = 1e9};
    for (uint32_t j = 0; j < world->state.particles; j++) {
        double offset[3], r2 = 0;
        for (int axis = 0; axis < 3; axis++) {
            offset[axis] = (double)x[axis] - (double)position[3 * j + axis];
            r2 += offset[axis] * offset[axis];
        }
        if (i == j || r2 >= 9 * h * h)
            continue;
        const double q = sqrt(r2) / h;
        sums.nearest = fmin(sums.nearest, q * h / world->def.fluid.spacing);
        static const double FACTOR[] = {15, -6, 1};
        double w = 0, slope = 0;
        for (int a = 1; a <= 3; a++) {
            w += q < a ? FACTOR[a - 1] * pow(a - q, 5) : 0;
            slope -= q < a ? 5 * FACTOR[a - 1] * pow(a - q, 4) : 0;
        }
        sums.density += scale * w;
        for (int axis = 0; axis < 3 && q > 0; axis++)
            sums.gradient[axis] += scale * slope / h * offset[axis] / (q * h);
    }
    return sums;
}

/*
 * Density from positions, sum m W with walls, minus the density of the state. Counts particles farther than the
 * support from any free surface.
 */
typedef struct density_drift {
    uint32_t inside;
    double rms, largest, mean; /* relative to the rest density */
    double closest;            /* closest pair, in spacings */
    double clumped;            /* fraction of particles closer than half a spacing to another */
} density_drift;

static inline density_drift drift_of(const rheo_world *world)
{
    const rheo__melting *m = rheo__melting_of(world);
    const rheo__state *s = &world->state;
    const uint32_t count = s->particles;
    const double h = m->smoothing_length;
    double *density = calloc(count + 1, sizeof *density), closest = 1e9;
    bool *surface = calloc(count + 1, sizeof *surface);
    uint32_t clumped = 0;
    assert_true(density && surface);
    for (uint32_t i = 0; i < count; i++) {
        const rheo_real *x = s->position + 3 * i;
        density_sums sums = sums_at(world, i);
        double *gradient = sums.gradient, free_of_walls = 1;
        for (uint32_t wall = 0; wall < m->planes->count; wall++) {
            const rheo_real *n = m->planes->plane[wall].normal;
            const double distance = (double)rheo__plane_distance(&m->planes->plane[wall], x[0], x[1], x[2]);
            if (distance >= 3 * h)
                continue;
            const rheo__wall_integrals of = rheo__wall_look_up(m, (rheo_real)distance);
            free_of_walls *= 1 - (double)of.weight; /* union of the half spaces */
            for (int axis = 0; axis < 3; axis++)
                gradient[axis] -= (double)(of.gradient * n[axis]);
        }
        density[i] = sums.density + 1 - free_of_walls;
        surface[i] =
            h * sqrt(gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2]) > 0.25;
        closest = fmin(closest, sums.nearest);
        clumped += sums.nearest < 0.5;
    }
    density_drift drift = {.closest = closest, .clumped = count ? (double)clumped / count : 0};
    double square = 0, mean = 0;
    for (uint32_t i = 0; i < count; i++) {
        const rheo_real *x = s->position + 3 * i;
        bool inside = true;
        for (uint32_t j = 0; j < count && inside; j++) {
            double r2 = 0;
            for (int axis = 0; axis < 3; axis++)
                r2 += pow((double)x[axis] - (double)s->position[3 * j + axis], 2);
            inside = !(surface[j] && r2 < 9 * h * h);
        }
        if (!inside)
            continue;
        const double difference = (density[i] - (double)s->density[i]) / world->def.melting.rest_density;
        drift.inside++;
        square += difference * difference;
        mean += difference;
        drift.largest = fmax(drift.largest, fabs(difference));
    }
    drift.rms = drift.inside ? sqrt(square / drift.inside) : 0;
    drift.mean = drift.inside ? mean / drift.inside : 0;
    free(density);
    free(surface);
    return drift;
}

/* Id of a rank in the last substep. */
static inline uint32_t id_at(const rheo_world *world, uint32_t rank)
{
    return rheo__melting_of(world)->pairs.id_of[rank];
}

/* ---- Channels ---- */

typedef struct profile {
    double error; /* rms error relative to the largest exact velocity */
    double ratio; /* mean velocity relative to the exact one */
    double worst;
} profile;

static inline profile compare_profile(const periodic *p, double (*exact)(double y, const void *context),
                                      const void *context)
{
    double square = 0, largest = 0, sum = 0, exact_sum = 0, worst = 0;
    for (uint32_t i = 0; i < p->own; i++) {
        const double u = (double)p->world->state.velocity[3 * i],
                     e = exact((double)p->world->state.position[3 * i + 1], context);
        square += (u - e) * (u - e);
        largest = fmax(largest, fabs(e));
        worst = fmax(worst, fabs(u - e));
        sum += u;
        exact_sum += e;
    }
    return (profile){sqrt(square / p->own) / largest, sum / exact_sum, worst / largest};
}

/* A channel between walls at y = 0 and 1; the upper one moves along x. The fluid starts with the given profile. */
static inline periodic channel(rheo_world_def def, int layers, double (*exact)(double y, const void *context),
                               const void *context)
{
    const double dx = 1.0 / layers;
    def.fluid.spacing = dx;
    def.gravity[1] = 0;
    add_wall(&def, 0, 0, 0, 0, 1, 0);
    add_wall(&def, 0, 1, 0, 0, -1, 0);
    fluid f = lattice(dx, 6, layers, 6, 0);
    for (uint32_t i = 0; i < f.count; i++)
        f.v[3 * i] = exact ? (rheo_real)exact((double)f.x[3 * i + 1], context) : 0;
    return periodic_of(def, f, 6 * dx, 6 * dx);
}

static inline double poiseuille_profile(double y, const void *context)
{
    const double *force_by_viscosity = context;
    return *force_by_viscosity / 2 * y * (1 - y);
}

static inline profile poiseuille(rheo_world_def def, int layers, double force, double time)
{
    const double by = force / def.melting.viscosity;
    def.gravity[0] = force;
    def.step = 0.4 / layers / def.melting.sound_speed;
    periodic p = channel(def, layers, poiseuille_profile, &by);
    step_periodic(&p, (int)(time / def.step));
    const profile found = compare_profile(&p, poiseuille_profile, &by);
    rheo_world_destroy(p.world);
    return found;
}

#endif
