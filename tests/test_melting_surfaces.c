/* The melting model in thin parts, which are mostly surface: heat, viscosity, and creep below the yield stress. */
#include "melting_support.h"

/* ---- Heat ---- */

/*
 * A bar or plate of lattice particles, in spacings, with its long axis along u. Lattice points are turned by an angle
 * about z; the shape is cut from them, or turned with them.
 */
typedef struct thin {
    const char *name;
    double length, width, depth;
    double u[3]; /* unit vector */
    bool cut;
    double jitter;
    double allowed;
} thin;

/* Offset along the axis of the shape. */
static double along(const thin *shape, const rheo_real *x)
{
    return shape->u[0] * (double)x[0] + shape->u[1] * (double)x[1] + shape->u[2] * (double)x[2];
}

/* Particles of a shape, around the origin. */
static fluid thin_fluid(const thin *shape, double dx)
{
    fluid f = {0};
    const double size[3] = {shape->width, shape->length, shape->depth};
    if (!shape->cut) {
        /* Turns the axis y into u by reflecting at the plane between them. */
        const double corner[3] = {-size[0] * dx / 2, -size[1] * dx / 2, -size[2] * dx / 2};
        add_lattice(&f, dx, corner, (int)size[0], (int)size[1], (int)size[2], shape->jitter);
        const double n[3] = {-shape->u[0], 1 - shape->u[1], -shape->u[2]},
                     n2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        for (uint32_t i = 0; n2 > 1e-9 && i < f.count; i++) {
            rheo_real *x = f.x + 3 * i;
            const double by = 2 * (n[0] * (double)x[0] + n[1] * (double)x[1] + n[2] * (double)x[2]) / n2;
            for (int axis = 0; axis < 3; axis++)
                x[axis] -= (rheo_real)(by * n[axis]);
        }
        return f;
    }
    const int half = (int)shape->length;
    for (int k = 0; k < (int)shape->depth; k++)
        for (int j = -half; j < half; j++)
            for (int i = -half; i < half; i++) {
                const double x = i + 0.5, y = j + 0.5, l = shape->u[0] * x + shape->u[1] * y,
                             across = shape->u[1] * x - shape->u[0] * y;
                if (fabs(l) <= shape->length / 2 && fabs(across) <= shape->width / 2)
                    add_particle(&f, x * dx, y * dx, (k + 0.5) * dx);
            }
    return f;
}

/* Sum of T sin(pi l/length), the slowest mode. */
static double slowest_mode(const rheo_world *world, const thin *shape)
{
    const double length = shape->length * world->def.fluid.spacing;
    double sum = 0;
    for (uint32_t i = 0; i < world->state.particles; i++)
        sum += (double)world->state.temperature[i] * sin(PI * along(shape, world->state.position + 3 * i) / length);
    return sum;
}

/* Decay rate of the slowest mode over k (pi/length)^2. */
static double conductivity(const thin *shape)
{
    rheo_world_def def = melt_def(0.05);
    def.melting.flow = RHEO_FLOW_FROZEN;
    def.step = 0.2;
    fluid f = thin_fluid(shape, def.fluid.spacing);
    const double wave = PI / (shape->length * def.fluid.spacing);
    f.warm = true;
    for (uint32_t i = 0; i < f.count; i++)
        f.temperature[i] = (rheo_real)sin(wave * along(shape, f.x + 3 * i));
    rheo_world *world = melt_of(def, f);
    step(world, 25);
    const double before = slowest_mode(world, shape), heat = heat_of(world);
    step(world, 100);
    const double rate = log(before / slowest_mode(world, shape)) / (100 * def.step);
    assert_true(fabs(heat_of(world) - heat) < (IS_FLOAT ? 1e-5 : 1e-12) * world->state.particles);
    rheo_world_destroy(world);
    return rate / (def.melting.diffusivity * wave * wave);
}

static void thin_parts_conduct_as_the_inside_does(void **unused)
{
    (void)unused;
    static const thin SHAPES[] = {
        {"bar of 6 x 6 along x", 40, 6, 6, {1, 0, 0}, false, 0, 0.01},
        {"bar of 6 x 6 along y", 40, 6, 6, {0, 1, 0}, false, 0, 0.01},
        {"bar of 6 x 6 along z", 40, 6, 6, {0, 0, 1}, false, 0, 0.01},
        {"bar of 6 x 6, turned", 40, 6, 6, {2.0 / 3, 2.0 / 3, 1.0 / 3}, false, 0, 0.01},
        {"bar of 6 x 6, 45 degrees to the lattice", 40, 6, 6, {0.70710678, 0.70710678, 0}, true, 0, 0.04},
        {"bar of 6 x 6, positions moved by 0.2", 40, 6, 6, {0, 1, 0}, false, 0.2, 0.03},
        {"bar of 3 x 3", 40, 3, 3, {0, 1, 0}, false, 0, 0.01},
        {"bar of 1 x 1", 40, 1, 1, {0, 1, 0}, false, 0, 0.01},
        {"plate 2 thick", 30, 20, 2, {0, 1, 0}, false, 0, 0.01},
        {"plate 1 thick", 30, 20, 1, {0, 1, 0}, false, 0, 0.01},
        {"cube, 12 wide", 12, 12, 12, {0, 1, 0}, false, 0, 0.01},
    };
    random_state = 3;
    for (size_t i = 0; i < sizeof SHAPES / sizeof *SHAPES; i++) {
        const double ratio = conductivity(&SHAPES[i]);
        print_message("heat, %s: k_eff/k %.4f\n", SHAPES[i].name, ratio);
        NEAR(ratio, 1, SHAPES[i].allowed);
    }
}

/* ---- Viscosity ---- */

/*
 * A viscous column with free sides on a slippery floor sinks under its own weight: its strain rate is rho g (H -
 * y)/(3 eta) (Trouton), so v_y = -rho g (H y - y^2/2)/(3 eta).
 */
static double sinking_speed(int width)
{
    const int height = 16;
    const double dx = 1.0 / height, viscosity = 4;
    rheo_world_def def = newtonian_def(dx, viscosity);
    def.melting.wall = RHEO_WALL_FREE_SLIP;
    def.melting.tolerance = 1e-4;
    add_wall(&def, 0, 0, 0, 0, 1, 0);
    fluid f = lattice(dx, width, height, width, 0);
    start_hydrostatically(&f, &def, 1);
    rheo_world *world = melt_of(def, f);
    step(world, 40);
    const double top = highest(world, 1) + dx / 2;
    double product = 0, square = 0;
    for (uint32_t i = 0; i < world->state.particles; i++) {
        const double y = (double)world->state.position[3 * i + 1], exact = -(top * y - y * y / 2) / (3 * viscosity);
        product += (double)world->state.velocity[3 * i + 1] * exact;
        square += exact * exact;
    }
    rheo_world_destroy(world);
    print_message("free column %d wide, %d high: sinks at %.3f of Trouton's speed\n", width, height,
                  product / square);
    return product / square;
}

static void free_columns_sink_at_their_speed(void **unused)
{
    (void)unused;
    NEAR(sinking_speed(4), 1.1, 0.25);
    NEAR(sinking_speed(8), 1.1, 0.15);
}

/* ---- Creep ---- */

typedef struct creep {
    double sunk; /* of the top, relative to the height */
    double iterations;
} creep;

/* A cold column from t = 1, when it has settled on the floor. */
static creep creep_of(rheo_world_def def, int width, int height, double time)
{
    const double dx = def.fluid.spacing;
    add_wall(&def, 0, 0, 0, 0, 1, 0);
    fluid f = lattice(dx, width, height, width, 0);
    start_hydrostatically(&f, &def, height * dx);
    rheo_world *world = melt_of(def, f);
    step(world, (int)(1 / def.step));
    const double top = highest(world, 1);
    double iterations = 0, substeps = 0;
    for (int s = 0; s < (int)(time / def.step); s++) {
        step(world, 1);
        iterations += metric(world, "iterations");
        substeps += metric(world, "substeps");
    }
    const creep found = {(top - highest(world, 1)) / (height * dx), iterations / substeps};
    rheo_world_destroy(world);
    print_message("cold column %d x %d x %d, J = %g: the top sinks by %.4f %% of the height in %g, %.2f iterations\n",
                  width, height, width, def.melting.jump_number_max, 100 * found.sunk, time, found.iterations);
    return found;
}

static void cold_columns_keep_their_shape(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    const creep solid = creep_of(def, 5, 10, 30);
    assert_true(fabs(solid.sunk) < 2e-3);
    assert_true(solid.iterations < 1);
    /* Below the yield stress it is a fluid of viscosity mu (J + 1). */
    def.melting.jump_number_max = 2000;
    const creep soft = creep_of(def, 5, 10, 10);
    def.melting.jump_number_max = 8000;
    const creep stiff = creep_of(def, 5, 10, 10);
    assert_true(soft.sunk > 0.005);
    assert_true(stiff.sunk < 0.3 * soft.sunk);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thin_parts_conduct_as_the_inside_does),
        cmocka_unit_test(free_columns_sink_at_their_speed),
        cmocka_unit_test(cold_columns_keep_their_shape),
    };
    return cmocka_run_group_tests_name("melting, surfaces", tests, NULL, NULL);
}
