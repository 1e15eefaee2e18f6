/* The melting model: kernel W, apparent viscosity and shear rate against closed forms. */
#define RHEO__LANES 1 /* the kernel's polynomials, one number at a time */
#include "melting_support.h"

#include "core/math.h"
#include "core/quintic.h"

/* ---- Kernel ---- */

/* 4 pi int W r^2 dr of a world's kernel by Simpson's rule. */
static double kernel_integral(const rheo__melting *m)
{
    enum { CELLS = 3000 };
    const double h = m->smoothing_length;
    double sum = 0;
    for (int i = 0; i <= CELLS; i++) {
        const double q = 3.0 * i / CELLS;
        rheo_real slope;
        const double w = (double)rheo__lanes_quintic((rheo_real)q, &slope);
        sum += (i == 0 || i == CELLS ? 1 : i % 2 ? 4 : 2) * w * q * q;
    }
    return 4 * PI * (double)m->kernel_scale * sum * (3.0 / CELLS) / 3 * h * h * h;
}

static void kernel_has_its_integral(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.25);
    for (int printed = 0; printed < 2; printed++) {
        def.paper.kernel = (rheo_as_printed)printed;
        rheo_world *world = melt_of(def, (fluid){0});
        const rheo__melting *m = rheo__melting_of(world);
        rheo_real slope;
        NEAR(kernel_integral(m), printed ? 1.0027855 : 1, 1e-6);
        NEAR((double)(m->kernel_scale * rheo__lanes_quintic(0, &slope)) * 0.25 * 0.25 * 0.25,
             printed ? 0.1750704 * 1.0027855 : 0.1750704, 1e-6);
        rheo_world_destroy(world);
    }
}

/* w'(q)/q and w''(q) against finite differences of w, across the joints of the pieces. */
static void kernel_derivatives(void **unused)
{
    (void)unused;
    const double step = IS_FLOAT ? 1.0 / 64 : 1.0 / 1024, allowed = IS_FLOAT ? 0.05 : 2e-4;
    for (double q = 0.125; q < 3.25; q += 0.125) {
        rheo_real slope, unused_slope;
        const double low = (double)rheo__lanes_quintic((rheo_real)(q - step), &unused_slope),
                     high = (double)rheo__lanes_quintic((rheo_real)(q + step), &unused_slope),
                     middle = (double)rheo__lanes_quintic((rheo_real)q, &slope);
        NEAR((double)slope, (high - low) / (2 * step) / q, allowed);
        NEAR((double)rheo__lanes_quintic_second((rheo_real)q), (high - 2 * middle + low) / (step * step),
             2 * allowed);
    }
    rheo_real slope;
    rheo__lanes_quintic(0, &slope);
    assert_true(slope == -120);
}

/* ---- Rheology ---- */

static void apparent_viscosity_has_known_values(void **unused)
{
    (void)unused;
    static const struct {
        double jump, rate, eta;
    } KNOWN[] = {
        {0, 1e-6, 1.0009995},    {0, 1e-3, 1.0311071},    {0, 0.1, 1.2525563},    {0, 1, 1.2642411},
        {0, 10, 0.41620887},     {0, 100, 0.11},          {10, 1e-6, 11.010939},  {10, 1e-3, 11.285666},
        {10, 0.1, 8.7809360},    {10, 1, 1.9999666},      {10, 10, 0.41622777},   {10, 100, 0.11},
        {1000, 1e-6, 1001.4997}, {1000, 1e-3, 652.48929}, {1000, 0.1, 13.162278}, {1000, 1, 2},
        {1000, 10, 0.41622777},  {1000, 100, 0.11},       {1e6, 1e-6, 632753.05}, {1e6, 1e-3, 1031.6228},
        {1e6, 0.01, 110},
    };
    rheo_world_def def = melt_def(0.05);
    def.melting.viscosity = def.melting.time_scale = 1;
    for (size_t i = 0; i < sizeof KNOWN / sizeof *KNOWN; i++)
        NEAR(rheo__melting_viscosity(&def, KNOWN[i].jump, KNOWN[i].rate) / KNOWN[i].eta, 1, 1e-6);
    /* Units restored: eta = mu eta*(D t0); the yield stress is mu/t0. */
    def.melting.viscosity = 0.05;
    def.melting.time_scale = 0.02;
    NEAR(rheo__melting_viscosity(&def, 10, 50), 0.05 * 1.9999666, 1e-7);
    NEAR(rheo__melting_viscosity(&def, 1e9, 1e-3) * 1e-3, 0.05 / 0.02, 0.02);
    /* eta = mu (J + 1) at rest. */
    NEAR(rheo__melting_viscosity(&def, 10, 0), 0.05 * 11, 1e-6);
    def.melting.rheology = RHEO_RHEOLOGY_NEWTONIAN;
    assert_true(rheo__melting_viscosity(&def, 10, 50) == 0.05);
}

/* Explicit substeps are limited by the largest viscosity over all shear rates. */
static void apparent_viscosity_has_its_maximum(void **unused)
{
    (void)unused;
    static const struct {
        double jump, most;
    } KNOWN[] = {{0, 1.346}, {10, 1.043}, {1000, 1.0005}};
    rheo_world_def def = melt_def(0.05);
    def.melting.viscosity = def.melting.time_scale = 1;
    for (size_t i = 0; i < 3; i++) {
        double most = 0;
        for (double rate = 1e-9; rate < 100; rate *= 1.01)
            most = fmax(most, rheo__melting_viscosity(&def, KNOWN[i].jump, rate) / (KNOWN[i].jump + 1));
        NEAR(most, KNOWN[i].most, 6e-4);
        assert_true(most < 1.35);
    }
}

static void jump_number_follows_temperature(void **unused)
{
    (void)unused;
    rheo_world_def def = melt_def(0.05);
    def.melting.jump_number_min = 10;
    def.melting.jump_number_max = 2000;
    static const double T[] = {-3, 0.45, 0.475, 0.5, 0.55, 7}, J[] = {2000, 2000, 1502.5, 1005, 10, 10};
    for (int i = 0; i < 6; i++)
        NEAR(rheo__melting_jump(&def, T[i]), J[i], 1e-9);
    /* The printed formula has the wrong sign, and beyond the band only the limit J >= 0 bounds it. */
    static const double PRINTED[] = {2000 + 34.5 * 2010, 2000, 1497.5, 995, 0, 0};
    def.paper.jump = RHEO_AS_PRINTED_ON;
    for (int i = 0; i < 6; i++)
        NEAR(rheo__melting_jump(&def, T[i]), PRINTED[i], 1e-9);
}

/* A cloud of all temperatures, with shear rates from 1e-4 to 1e3. */
static void apparent_viscosity_of_a_vector(void **unused)
{
    (void)unused;
    static const double EXPONENTS[] = {0.5, 0.3, 1, 0};
    for (int e = 0; e < 8; e++) {
        rheo_world_def def = melt_def(0.05);
        def.melting.substeps = 1;
        def.melting.jump_number_max = 2000;
        def.step = 1e-4;
        def.melting.power_law_index = EXPONENTS[e % 4];
        def.paper.jump = (rheo_as_printed)(e / 4);
        fluid f = lattice(0.05, 10, 10, 10, 0.2);
        f.warm = true;
        for (uint32_t i = 0; i < f.count; i++) {
            f.temperature[i] = (rheo_real)(0.4 + 0.2 * random_unit());
            const double scale = pow(10, 7 * floor(10.0 * i / f.count) / 10 - 5);
            for (int axis = 0; axis < 3; axis++)
                f.v[3 * i + axis] = (rheo_real)(scale * (random_unit() - 0.5));
        }
        rheo_world *world = melt_of(def, f);
        step(world, 1);
        const rheo__melting *m = rheo__melting_of(world);
        const rheo_real *temperature = world->state.before[RHEO__FIELD_temperature];
        double low = 1e9, high = 0;
        for (uint32_t rank = 0; rank < m->pairs.rows; rank++) {
            const double rate = (double)m->shear_rate[rank];
            const double jump = rheo__melting_jump(&def, (double)temperature[m->pairs.id_of[rank]]);
            /* One ulp of temperature in float (1e-7 of u) changes J by 2e-4. */
            const double of_jump =
                fabs(rheo__melting_viscosity(&def, jump + 1e-3, rate) - rheo__melting_viscosity(&def, jump, rate));
            const double exact = rheo__melting_viscosity(&def, jump, rate);
            NEAR((double)m->viscosity[rank] / exact, 1, IS_FLOAT ? 1e-5 + of_jump / exact : 1e-12);
            low = fmin(low, rate);
            high = fmax(high, rate);
        }
        assert_true(low < 1e-3 && high > 10);
        rheo_world_destroy(world);
    }
}

/* ---- Shear rate ---- */

/* A ball of fluid with v = G x. Returns the range of shear rates farther than the support from its surface. */
static void shear_rates(const double g[9], double jitter, double *least, double *most, double *surface)
{
    rheo_world_def def = melt_def(0.05);
    def.gravity[1] = 0;
    def.melting.substeps = 1;
    def.step = 1e-5;
    fluid f = lattice(0.05, 12, 12, 12, jitter);
    for (uint32_t i = 0; i < f.count; i++)
        for (int row = 0; row < 3; row++) {
            double sum = 0;
            for (int column = 0; column < 3; column++)
                sum += g[3 * row + column] * ((double)f.x[3 * i + column] - 0.3);
            f.v[3 * i + row] = (rheo_real)sum;
        }
    rheo_world *world = melt_of(def, f);
    step(world, 1);
    *least = 1e9;
    *most = *surface = 0;
    for (uint32_t rank = 0; rank < rheo__melting_of(world)->pairs.rows; rank++) {
        const rheo_real *x = world->state.position + 3 * id_at(world, rank);
        const double rate = (double)rheo__melting_of(world)->shear_rate[rank];
        bool inside = true;
        for (int axis = 0; axis < 3; axis++)
            inside = inside && fabs((double)x[axis] - 0.3) < 0.3 - 0.155;
        if (inside) {
            *least = fmin(*least, rate);
            *most = fmax(*most, rate);
        }
        *surface = fmax(*surface, rate);
    }
    rheo_world_destroy(world);
}

static void shear_rate_of_simple_motions(void **unused)
{
    (void)unused;
    double least, most, surface;
    /* Gradients are exact for linear fields, everywhere and for any positions. */
    const double rounding = IS_FLOAT ? 2e-5 : 1e-12;
    for (int moved = 0; moved < 2; moved++) {
        const double jitter = 0.1 * moved;
        shear_rates((double[]){0, 0, 3, 0, 0, 0, -3, 0, 0}, jitter, &least, &most, &surface);
        print_message(
            "rigid rotation by 3, positions moved by %.1f dx: shear rate <= %.2g inside, %.2g at surfaces\n", jitter,
            most, surface);
        assert_true(surface < rounding);
        assert_true(most < rounding);
        shear_rates((double[]){0, 2, 0, 0, 0, 0, 0, 0, 0}, jitter, &least, &most, &surface);
        print_message("simple shear by 2, positions moved by %.1f dx: %.7f to %.7f\n", jitter, least, most);
        NEAR(least, 2, rounding);
        NEAR(most, 2, rounding);
    }
    /* Stretching along x, shrinking along y: D = diag(2, -2), so the rate is 2. */
    shear_rates((double[]){1, 0, 0, 0, -1, 0, 0, 0, 0}, 0, &least, &most, &surface);
    NEAR(least, 2, rounding);
    NEAR(most, 2, rounding);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernel_has_its_integral),
        cmocka_unit_test(kernel_derivatives),
        cmocka_unit_test(apparent_viscosity_has_known_values),
        cmocka_unit_test(apparent_viscosity_has_its_maximum),
        cmocka_unit_test(jump_number_follows_temperature),
        cmocka_unit_test(apparent_viscosity_of_a_vector),
        cmocka_unit_test(shear_rate_of_simple_motions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
