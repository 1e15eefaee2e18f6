/* The melting model: walls, inclines and free fall. */
#define RHEO__LANES 1 /* the kernel's polynomials, one number at a time */
#include "melting_support.h"

#include "core/quintic.h"

/* ---- Walls ---- */

/* Kernel w in double, with h = 1. */
static double kernel(double q)
{
    static const double FACTOR[] = {15, -6, 1};
    double sum = 0;
    for (int a = 1; a <= 3; a++)
        sum += q < a ? FACTOR[a - 1] * pow(a - q, 5) : 0;
    return sum / (120 * PI);
}
static double kernel_slope(double q)
{
    static const double FACTOR[] = {15, -6, 1};
    double sum = 0;
    for (int a = 1; a <= 3; a++)
        sum -= q < a ? 5 * FACTOR[a - 1] * pow(a - q, 4) : 0;
    return sum / (120 * PI);
}

/*
 * Sums over a plane at depth z, ring by ring, without h: W, -dW/dz, and the viscous coefficient along and across the
 * plane.
 */
static void sum_rings(double z, double sum[4])
{
    enum { RINGS = 400 };
    memset(sum, 0, 4 * sizeof *sum);
    const double widest = sqrt(fmax(9 - z * z, 0));
    for (int i = 0; i < RINGS; i++) {
        const double r = (i + 0.5) * widest / RINGS, q = sqrt(r * r + z * z), area = 2 * PI * r * widest / RINGS;
        const double bond = -10 * kernel_slope(q) / (q * (q * q + 0.01));
        sum[0] += area * kernel(q);
        sum[1] += area * -kernel_slope(q) * z / q;
        sum[2] += area * bond * r * r / 2 * z; /* half of r^2 is along one of two axes */
        sum[3] += area * bond * z * z * z;
    }
}

static void wall_table_is_that_of_a_wall(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    add_wall(&def, 0, 0, 0, 0, 1, 0);
    for (int ratio = 0; ratio < 2; ratio++) {
        const double h = ratio ? 0.12 : 0.1, s = 0.1 / h;
        def.melting.smoothing_length = h;
        rheo_world *world = melt_of(def, (fluid){0});
        for (double d = 0; d < 3; d += 0.37) {
            const rheo__wall_integrals got = rheo__wall_look_up(rheo__melting_of(world), (rheo_real)(d * h));
            double sum[4], layers[3] = {0, 0, 0}, half_space[3] = {0, 0, 0};
            for (double z = d + s / 2; z < 3; z += s) {
                sum_rings(z, sum);
                layers[0] += s * sum[0];
                layers[1] += s * sum[1];
                layers[2] += s * z * sum[1];
            }
            enum { SLICES = 300 };
            for (int i = 0; i < SLICES; i++) {
                const double z = d + (3 - d) * (i + 0.5) / SLICES, thickness = (3 - d) / SLICES;
                sum_rings(z, sum);
                half_space[0] += thickness * z * sum[1];
                half_space[1] += thickness * sum[2];
                half_space[2] += thickness * sum[3];
            }
            NEAR((double)got.weight, layers[0], 2e-5);
            NEAR((double)got.gradient * h, layers[1], 2e-5);
            NEAR((double)got.moment, layers[2], 2e-5);
            NEAR((double)got.shear, half_space[0], 2e-5);
            NEAR((double)got.along * h, half_space[1], 2e-4);
            NEAR((double)got.normal * h, half_space[2], 2e-4);
        }
        /*
         * A particle behind the wall has the integrals of one on it. The integrals vanish at the edge of the support.
         */
        const rheo__wall_integrals behind = rheo__wall_look_up(rheo__melting_of(world), -1),
                                   on = rheo__wall_look_up(rheo__melting_of(world), 0),
                                   away = rheo__wall_look_up(rheo__melting_of(world), (rheo_real)(2.9999 * h));
        assert_memory_equal(&behind, &on, sizeof on);
        assert_true(away.weight < 1e-6 && away.gradient < 1e-6 && away.along < 1e-6 && away.normal < 1e-6);
        rheo_world_destroy(world);
    }
}

/* A lattice ends half a spacing from a wall, which completes the sums of the first layers. */
static void wall_completes_the_lattice(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.1);
    def.gravity[1] = 0;
    def.melting.density = RHEO_DENSITY_SUMMATION;
    def.melting.substeps = 1;
    def.step = 1e-6;
    add_wall(&def, 0, 0, 0, 0, 1, 0);
    rheo_world *world = melt_of(def, lattice(0.1, 9, 8, 9, 0));
    step(world, 1);
    for (uint32_t i = 0; i < world->state.particles; i++) {
        const rheo_real *x = world->state.position + 3 * i;
        if (fabs((double)x[0] - 0.45) < 0.06 && fabs((double)x[2] - 0.45) < 0.06 && x[1] < 0.5)
            NEAR((double)world->state.density[i], 1, 2e-3);
    }
    rheo_world_destroy(world);
}

/* A free-slip wall does not slow fluid down. */
static void free_slip_does_not_brake(void **unused)
{
    (void)unused;
    double kept[2];
    for (int slip = 0; slip < 2; slip++) {
        rheo_world_def def = newtonian_def(0.1, 0.5);
        def.gravity[1] = 0;
        def.melting.wall = (rheo_wall_slip)slip;
        add_wall(&def, 0, 0, 0, 0, 1, 0);
        fluid f = lattice(0.1, 6, 4, 6, 0);
        for (uint32_t i = 0; i < f.count; i++)
            f.v[3 * i] = 1;
        rheo_world *world = melt_of(def, f);
        double before[3], after[3];
        momentum_of(world, before);
        step(world, 25);
        momentum_of(world, after);
        kept[slip] = after[0] / before[0];
        rheo_world_destroy(world);
    }
    NEAR(kept[1], 1, 1e-5);
    assert_true(kept[0] < 0.5);
}

/* Distance that the centre slides down a plane at 45 degrees in a time of 1, cold or hot. */
static double slid(double temperature)
{
    rheo_world_def def = melt_def(0.05);
    def.melting.temperature = temperature;
    const double half = sqrt(0.5);
    add_wall(&def, 0, 0, 0, half, half, 0);
    fluid f = {0};
    for (int k = 0; k < 8; k++)
        for (int j = 0; j < 5; j++)
            for (int i = 0; i < 12; i++) {
                const double along = (i + 0.5) * 0.05, away = (j + 0.5) * 0.05;
                add_particle(&f, half * (along + away), half * (away - along), (k + 0.5) * 0.05);
            }
    rheo_world *world = melt_of(def, f);
    const double x = metric(world, "centre_x"), y = metric(world, "centre_y");
    step(world, 50);
    for (uint32_t i = 0; i < world->state.particles; i++) {
        const rheo_real *at = world->state.position + 3 * i;
        assert_true(half * ((double)at[0] + (double)at[1]) > -1e-3);
    }
    const double gone = half * (metric(world, "centre_x") - x) - half * (metric(world, "centre_y") - y);
    rheo_world_destroy(world);
    return gone;
}

static void inclines_hold_solids_and_shed_liquids(void **unused)
{
    (void)unused;
    const double cold = slid(0), hot = slid(1);
    print_message("incline of 45 degrees: in a time of 1 cold slides %.2g, hot %.2g\n", cold, hot);
    assert_true(cold >= 0 && cold < 0.005);
    assert_true(hot > 0.05);
}

/* A body falls off a ceiling, liquid or solid. */
static void nothing_sticks_to_a_ceiling(void **unused)
{
    (void)unused;
    for (int hot = 0; hot < 2; hot++) {
        rheo_world_def def = melt_def(0.05);
        def.melting.temperature = hot;
        add_wall(&def, 0, 1, 0, 0, -1, 0);
        fluid f = {0};
        add_lattice(&f, 0.05, (double[]){0, 0.75, 0}, 6, 5, 6, 0);
        rheo_world *world = melt_of(def, f);
        const double from = metric(world, "centre_y");
        step(world, 50);
        print_message("ceiling, %s: fell by %.3g of 0.5 g t^2, top %.3f\n", hot ? "hot" : "cold",
                      (from - metric(world, "centre_y")) / 0.5, highest(world, 1));
        assert_true(highest(world, 1) < 1);
        assert_true(from - metric(world, "centre_y") > 0.4);
        rheo_world_destroy(world);
    }
}

/* ---- Falling ---- */

/* Gravity alone acts on a falling body, for any viscosity and speed. */
static void falls_are_free(void **unused)
{
    (void)unused;
    for (int hot = 0; hot < 2; hot++) {
        rheo_world_def def = melt_def(0.1);
        def.melting.temperature = hot;
        rheo_world *world = melt_of(def, lattice(0.1, 4, 4, 4, 0.1));
        step(world, 250);
        double sum[3];
        momentum_of(world, sum);
        NEAR(sum[1] / world->state.particles, -5, 1e-3);
        NEAR(sum[0] / world->state.particles, 0, 1e-6);
        rheo_world_destroy(world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wall_table_is_that_of_a_wall), cmocka_unit_test(wall_completes_the_lattice),
        cmocka_unit_test(free_slip_does_not_brake),     cmocka_unit_test(inclines_hold_solids_and_shed_liquids),
        cmocka_unit_test(nothing_sticks_to_a_ceiling),  cmocka_unit_test(falls_are_free),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
