/*
 * Hard cases: scenes far from those that the models are made for. Each has a stated outcome, either finite values within a
 * derived bound or a refusal with a reason. docs/hard-cases.md has the table.
 */
#ifndef RHEO__TESTS_HARD_H
#define RHEO__TESTS_HARD_H

#include "truth.h"

/* Distance of the numbers next to 1. */
#if RHEO_DOUBLE
#define ULP 0x1p-52
#else
#define ULP 0x1p-23
#endif

enum { SCHEMES = 3 };

static inline const char *scheme_name(int scheme)
{
    static const char *const NAME[SCHEMES] = {"summed", "sequential", "positions"};
    return NAME[scheme];
}

/* The extremes of a run, and why it ended early. */
typedef struct course {
    rheo_result result;
    int steps; /* made */
    rheo_error error;
    double fastest; /* particle of any step */
    double begin,
        most; /* energy of motion and gravity, of particles and ball: before the first step, largest of any step */
    double substeps; /* most in a step */
    double softened; /* most springs in a step */
} course;

static inline double square(double x)
{
    return x * x;
}

/* Energy of motion and gravity, of particles and ball; the metric of the same name has no value before the first step. */
static inline double energy_of(const rheo_world *world)
{
    const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
    const double *g = rheo_world_definition(world)->gravity;
    double sum = 0;
    for (size_t i = 0; i < 3 * (size_t)rheo_world_particle_count(world); i++)
        sum += 0.5 * square((double)v[i]) - g[i % 3] * (double)x[i];
    rheo_body b;
    if (!rheo_world_body_count(world))
        return sum;
    OK(rheo_world_body(world, 0, &b));
    for (int k = 0; k < 3; k++)
        sum += b.mass * (0.5 * square(b.velocity[k]) + 0.2 * square(b.radius * b.spin[k]) - g[k] * b.position[k]);
    return sum;
}

/* Asserts that all values of positions and velocities are finite, whatever the library says. */
static inline void assert_finite(const rheo_world *world)
{
    const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
    for (size_t i = 0; i < 3 * (size_t)rheo_world_particle_count(world); i++)
        if (!isfinite((double)x[i]) || !isfinite((double)v[i]))
            fail_msg("step %g: particle %zu is not finite", (double)rheo_world_step_count(world), i / 3);
    for (uint32_t b = 0; b < rheo_world_body_count(world); b++) {
        rheo_body ball;
        OK(rheo_world_body(world, b, &ball));
        for (int k = 0; k < 3; k++)
            assert_true(isfinite(ball.position[k]) && isfinite(ball.velocity[k]) && isfinite(ball.spin[k]));
    }
}

/* Makes steps until one fails. Every state on the way is finite, also the last one before a failure. */
static inline course drive(rheo_world *world, int steps)
{
    course c = {.begin = energy_of(world), .most = -INFINITY};
    const bool summed = rheo_world_definition(world)->scheme == RHEO_SCHEME_SUMMED;
    for (; c.steps < steps; c.steps++) {
        c.result = rheo_world_step(world, &c.error);
        assert_finite(world);
        if (c.result != RHEO_OK)
            break;
        c.fastest = fmax(c.fastest, metric(world, "max_speed"));
        c.most = fmax(c.most, metric(world, "energy"));
        if (summed) {
            c.substeps = fmax(c.substeps, metric(world, "substeps"));
            c.softened = fmax(c.softened, metric(world, "softened_springs"));
        }
    }
    return c;
}

/* A run that went on to its end. */
static inline course drive_all(rheo_world *world, int steps)
{
    const course c = drive(world, steps);
    if (c.result != RHEO_OK)
        fail_msg("step %d: %s", c.steps + 1, c.error.message);
    return c;
}

/* A run that ended early must say where: step, stage or field, and item. */
static inline void assert_says_where(const rheo_world *world, const course *c)
{
    rheo_failure f;
    assert_int_equal(c->result, RHEO_ERROR_STATE);
    assert_true(rheo_world_failure(world, &f));
    assert_true(f.step == rheo_world_step_count(world) + 1 && f.stage[0] && f.field[0]);
    assert_true(says(c->error.message, "went bad") && says(c->error.message, f.stage));
}

/* A box of fluid with nx x ny x nz particles at the spacing of the definition, its corner at half a spacing. */
static inline uint32_t lattice(const rheo_world_def *def, int nx, int ny, int nz, const double corner[3],
                               rheo_real *x)
{
    uint32_t n = 0;
    for (int j = 0; j < ny; j++)
        for (int k = 0; k < nz; k++)
            for (int i = 0; i < nx; i++, n++) {
                const int at[3] = {i, j, k};
                for (int a = 0; a < 3; a++)
                    x[3 * (size_t)n + (size_t)a] = (rheo_real)(corner[a] + (at[a] + 0.5) * def->fluid.spacing);
            }
    return n;
}

static inline rheo_real *reals(size_t count)
{
    rheo_real *x = calloc(count, sizeof *x);
    assert_non_null(x);
    return x;
}

static inline void set(rheo_world_def *def, const char *path, const char *value)
{
    OK(rheo_world_def_set(def, path, value, &error));
}

/* A closed box: floor, lid at this height and four sides. */
static inline void box_walls(rheo_world_def *def, double width, double height, double depth)
{
    const double far[3] = {width, height, depth};
    def->walls.plane = some_walls();
    def->walls.count = 6;
    for (int a = 0; a < 3; a++) {
        walls_of(def)[2 * a].normal[a] = 1;
        walls_of(def)[2 * a + 1].normal[a] = -1;
        walls_of(def)[2 * a + 1].point[a] = far[a];
    }
}

/*
 * The force law without its limit of tension has the potential sum h k/8 (rho - rho0)^2 + h k_near/12 rho_near^2, whose gradient is
 * the acceleration of docs/model.md, 7.
 */
static inline double pressure_energy(const rheo_world *world)
{
    const rheo_world_def *def = rheo_world_definition(world);
    const uint32_t n = rheo_world_particle_count(world);
    double *density = malloc(n * sizeof *density), *near = malloc(n * sizeof *near), sum = 0;
    assert_true(density && near);
    OK(rheo_world_densities(world, density, near, &error));
    for (uint32_t i = 0; i < n; i++)
        sum += def->fluid.support * (def->fluid.stiffness / 8 * square(density[i] - def->fluid.rest_density) +
                                     def->fluid.near_stiffness / 12 * square(near[i]));
    free(density);
    free(near);
    return sum;
}

/* Momentum along an axis. */
static inline double momentum(const rheo_world *world, int axis)
{
    double sum = 0;
    for (size_t i = 0; i < rheo_world_particle_count(world); i++)
        sum += (double)rheo_world_velocities(world)[3 * i + (size_t)axis];
    return sum;
}

#endif
