/*
 * Space has no direction, no place and no first particle: a mirrored, turned, moved or renumbered body moves as the image of
 * the body. To rounding in a step; later the differences grow, as chaos makes all differences grow. In scheme sequential the
 * order of pairs is part of the result. docs/hard-cases.md lists the figures.
 */
#include "support.h"

#include <math.h>

/* Half of the last bit of 1. */
static const double ROUNDING = RHEO_DOUBLE ? 0x1p-53 : 0x1p-24;

enum { SIDE = 6, COUNT = SIDE * SIDE * SIDE };

/* A change of space: x -> matrix x + shift, and of numbers. */
typedef struct change {
    const char *name;
    double matrix[9], shift; /* matrix: 0 if rotation() makes it; shift: in spacings, along all axes */
    bool exact;              /* images are not rounded */
    bool renumbers;
} change;

static const change CHANGES[] = {
    {"mirrored", {-1, 0, 0, 0, 1, 0, 0, 0, 1}, 0, true, false},
    {"turned by 90 degrees", {0, -1, 0, 1, 0, 0, 0, 0, 1}, 0, true, false},
    {"turned by 30 degrees", {0}, 0, false, false},
    {"moved", {1, 0, 0, 0, 1, 0, 0, 0, 1}, 37.3, false, false},
    {"renumbered", {1, 0, 0, 0, 1, 0, 0, 0, 1}, 0, true, true},
};
enum { KINDS = sizeof CHANGES / sizeof *CHANGES };

static uint64_t random_state = 1;
static double random_unit(void)
{
    random_state = random_state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(random_state >> 11) / 9007199254740992.0;
}

/* By 30 degrees about (1, 2, 2)/3. */
static void rotation(double matrix[9])
{
    const double axis[3] = {1.0 / 3, 2.0 / 3, 2.0 / 3}, cosine = sqrt(0.75), sine = 0.5;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) {
            const int other = 3 - row - column;
            const double across = row == column ? 0 : ((column - row + 3) % 3 == 1 ? -1 : 1) * axis[other] * sine;
            matrix[3 * row + column] =
                (row == column ? cosine : 0) + (1 - cosine) * axis[row] * axis[column] + across;
        }
}

static void image_of(const change *c, double spacing, bool place, const double from[3], double to[3])
{
    double matrix[9];
    memcpy(matrix, c->matrix, sizeof matrix);
    if (!c->exact && c->shift == 0)
        rotation(matrix);
    for (int row = 0; row < 3; row++)
        to[row] = matrix[3 * row] * from[0] + matrix[3 * row + 1] * from[1] + matrix[3 * row + 2] * from[2] +
                  (place ? c->shift * spacing : 0);
}

/* ---- Bodies ---- */

static const char *const BODIES[] = {"summed", "sequential", "positions", "melting pairwise", "melting nested"};
enum { SUMMED, SEQUENTIAL, POSITIONS, PAIRWISE, NESTED, KINDS_OF_BODIES };

/* A block that jostles, turns and falls in free space. */
static rheo_world *body(int kind, const change *c)
{
    static rheo_real x[3 * COUNT], v[3 * COUNT], temperature[COUNT];
    const bool melts = kind >= PAIRWISE;
    rheo_world_def def = rheo_default_model_def(melts ? RHEO_MODEL_MELTING : RHEO_MODEL_THICKENING);
    if (melts) {
        def.fluid.spacing = 0.1;
        def.melting.jump_number_max = 50;
        def.melting.stress = kind == NESTED ? RHEO_STRESS_NESTED : RHEO_STRESS_PAIRWISE;
        def.particles.temperature = temperature;
    } else {
        def.scheme = (rheo_scheme)kind;
    }
    const double s = def.fluid.spacing, speed = melts ? 0.4 : 4;
    random_state = 3;
    for (int i = 0; i < COUNT; i++) {
        const int place[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        const int id = c && c->renumbers ? (i * 125 + 7) % COUNT : i;
        double at[3], moves[3];
        for (int axis = 0; axis < 3; axis++) { /* rounded, so that exact images have the same bits */
            at[axis] = (double)(rheo_real)(s * (place[axis] - SIDE / 2 + 0.5 + 0.2 * (random_unit() - 0.5)));
            moves[axis] = (double)(rheo_real)(speed * (random_unit() - 0.5));
        }
        moves[0] = (double)(rheo_real)(moves[0] + at[2]);
        moves[2] = (double)(rheo_real)(moves[2] - at[0]);
        temperature[id] = (rheo_real)random_unit();
        double to[3], velocity[3];
        memcpy(to, at, sizeof to);
        memcpy(velocity, moves, sizeof velocity);
        if (c) {
            image_of(c, s, true, at, to);
            image_of(c, s, false, moves, velocity);
        }
        for (int axis = 0; axis < 3; axis++) {
            x[3 * id + axis] = (rheo_real)to[axis];
            v[3 * id + axis] = (rheo_real)velocity[axis];
        }
    }
    if (c) {
        double gravity[3];
        image_of(c, s, false, def.gravity, gravity);
        memcpy(def.gravity, gravity, sizeof gravity);
    }
    return world_of(def, COUNT, x, v);
}

/* Largest distance of a particle of the image from the image of the particle, in spacings. */
static double distance(const rheo_world *world, const rheo_world *image, const change *c)
{
    const double s = rheo_world_definition(world)->fluid.spacing;
    double most = 0;
    for (int i = 0; i < COUNT; i++) {
        const rheo_real *from = rheo_world_positions(world) + 3 * i,
                        *to = rheo_world_positions(image) + 3 * (c->renumbers ? (i * 125 + 7) % COUNT : i);
        double expected[3], r2 = 0;
        image_of(c, s, true, (double[]){(double)from[0], (double)from[1], (double)from[2]}, expected);
        for (int axis = 0; axis < 3; axis++)
            r2 += pow((double)to[axis] - expected[axis], 2);
        most = fmax(most, sqrt(r2) / s);
    }
    return most;
}

/* The largest coordinate of any particle, in spacings. */
static double reach(const rheo_world *world)
{
    double most = 0;
    for (int i = 0; i < 3 * COUNT; i++)
        most = fmax(most, fabs((double)rheo_world_positions(world)[i]));
    return most / rheo_world_definition(world)->fluid.spacing;
}

/*
 * A step rounds coordinates of up to `reach` spacings, and sums over so many pairs in another order. Such differences add up.
 * They do not multiply in these bodies, which are cohesive and come to rest, so after n steps they are n times as large at
 * most.
 */
static void images_move_as_images(void **unused)
{
    (void)unused;
    static const int steps[] = {1, 10, 50, 100};
    enum { TIMES = sizeof steps / sizeof *steps };
    for (int kind = 0; kind < KINDS_OF_BODIES; kind++)
        for (int k = 0; k < KINDS; k++) {
            const change *c = &CHANGES[k];
            double apart[TIMES], rounding[TIMES];
            rheo_world *world = body(kind, NULL), *image = body(kind, c);
            const double first = distance(world, image, c);
            assert_true(c->exact ? first == 0 : first < 4 * ROUNDING * reach(image));
            for (int n = 0; n < TIMES; n++) {
                step(world, steps[n] - (n ? steps[n - 1] : 0));
                step(image, steps[n] - (n ? steps[n - 1] : 0));
                apart[n] = distance(world, image, c);
                rounding[n] = steps[n] * (rheo_world_mean_neighbours(world) + 1) * ROUNDING * reach(image);
            }
            print_message("%s, %s: apart by %.2g, %.2g, %.2g, %.2g spacings after 1, 10, 50, 100 steps\n",
                          BODIES[kind], c->name, apart[0], apart[1], apart[2], apart[3]);
            for (int n = 0; n < TIMES; n++)
                if (kind != SEQUENTIAL)
                    assert_true(apart[n] <= rounding[n]);
                else /* another order of pairs */
                    assert_true(apart[n] > 1e-3 && apart[n] < 1);
            rheo_world_destroy(world);
            rheo_world_destroy(image);
        }
}

/* What is no image moves differently: the comparison finds a force with a direction. */
static void a_direction_is_found(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < KINDS_OF_BODIES; kind++) {
        const change *c = &CHANGES[1];
        rheo_world *world = body(kind, NULL), *image = body(kind, c);
        OK(rheo_world_set(image, "gravity", "[0, -1, 0.01]", &error));
        OK(rheo_world_set(world, "gravity", "[-1, 0, 0]", &error));
        step(world, 10);
        step(image, 10);
        assert_true(distance(world, image, c) >
                    10 * (rheo_world_mean_neighbours(world) + 1) * ROUNDING * reach(image));
        rheo_world_destroy(world);
        rheo_world_destroy(image);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(images_move_as_images),
        cmocka_unit_test(a_direction_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
