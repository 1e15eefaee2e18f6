/* The melting model against closed forms of flow and heat. These tests take longer than a minute together. */
#include "melting_support.h"

/* ---- Heat ---- */

/* A frozen slab of 20 layers between 0 and 1, insulated at both ends. */
static periodic frozen_slab(rheo_world_def def, double jitter, double (*temperature)(double y))
{
    const double dx = 0.05, width = 6 * dx;
    def.melting.flow = RHEO_FLOW_FROZEN;
    fluid f = lattice(dx, 6, 20, 6, jitter);
    f.warm = true;
    for (uint32_t i = 0; i < f.count; i++)
        f.temperature[i] = (rheo_real)temperature((double)f.x[3 * i + 1]);
    return periodic_of(def, f, width, width);
}

static double cosine(double y)
{
    return cos(PI * y);
}
static double half_spaces(double y)
{
    return y < 0.5 ? -1 : 3;
}

static double mode_of(const periodic *p)
{
    double sum = 0;
    for (uint32_t i = 0; i < p->own; i++)
        sum += (double)p->world->state.temperature[i] * cosine((double)p->world->state.position[3 * i + 1]);
    return sum;
}

/* Ratio of the decay rate of the cosine mode to k pi^2. */
static double effective_diffusivity(rheo_world_def def, double jitter)
{
    def.step = 0.2;
    periodic p = frozen_slab(def, jitter, cosine);
    const double before = mode_of(&p);
    step_periodic(&p, 500);
    const double rate = log(before / mode_of(&p)) / (500 * def.step);
    rheo_world_destroy(p.world);
    return rate / (PI * PI * def.melting.diffusivity);
}

static void heat_flows_as_in_closed_form(void **unused)
{
    (void)unused;
    const double regular = effective_diffusivity(melt_def(0.05), 0),
                 jittered = effective_diffusivity(melt_def(0.05), 0.2);
    print_message("heat, cosine mode: k_eff/k %.4f, jittered by 0.2 dx %.4f\n", regular, jittered);
    NEAR(regular, 1, 0.01);
    NEAR(jittered, 1, 0.02);
}

static double error_function(double x)
{
    /* 2/sqrt(pi) sum (-1)^k x^(2k+1)/(k! (2k+1)) */
    if (fabs(x) > 5)
        return x > 0 ? 1 : -1;
    double term = x, sum = x;
    for (int k = 1; k < 200; k++) {
        term *= -x * x / k;
        sum += term / (2 * k + 1);
    }
    return 2 / sqrt(PI) * sum;
}

static void half_spaces_even_out(void **unused)
{
    (void)unused;
    NEAR(error_function(0.5), 0.5204998778, 1e-9);
    rheo_world_def def = melt_def(0.05);
    def.step = 0.2;
    periodic p = frozen_slab(def, 0, half_spaces);
    double worst = 0;
    for (int s = 0; s < 100; s++) {
        step_periodic(&p, 1);
        const double t = rheo_world_time(p.world), width = sqrt(4 * def.melting.diffusivity * t);
        for (uint32_t i = 0; i < p.own; i++) {
            const double T = (double)p.world->state.temperature[i];
            assert_true(T >= -1 - 1e-6 && T <= 3 + 1e-6); /* no new extrema */
            if (t < 5)                                    /* a front about three layers wide */
                continue;
            const double exact = 1 + 2 * error_function(((double)p.world->state.position[3 * i + 1] - 0.5) / width);
            worst = fmax(worst, fabs(T - exact));
        }
    }
    print_message("heat, half spaces: largest error %.2f %% of the step\n", 100 * worst / 4);
    assert_true(worst / 4 < 0.01);
    rheo_world_destroy(p.world);
}

/* ---- Channels ---- */

static double couette_profile(double y, const void *context)
{
    (void)context;
    return y;
}

static void couette(void **unused)
{
    (void)unused;
    rheo_world_def def = newtonian_def(0.05, 0.5);
    def.step = 0.4 / 12 / 10;
    periodic p = channel(def, 12, NULL, NULL);
    rheo__melting_of(p.world)->wall_velocity[1][0] = 1;
    step_periodic(&p, (int)(1.5 / def.step));
    const profile found = compare_profile(&p, couette_profile, NULL);
    print_message("Couette: rms %.2f %%, largest %.2f %% of the wall's velocity\n", 100 * found.error,
                  100 * found.worst);
    assert_true(found.worst < 0.01);
    rheo_world_destroy(p.world);
}

static void newtonian_poiseuille(void **unused)
{
    (void)unused;
    const profile pairwise = poiseuille(newtonian_def(0.05, 0.5), 16, 4, 1);
    print_message("Poiseuille, Newtonian, pairwise: mean velocity %+.1f %%, rms %.1f %%\n",
                  100 * (pairwise.ratio - 1), 100 * pairwise.error);
    NEAR(pairwise.ratio, 1, 0.01);
}

/* ---- Pressure ---- */

static void column_stays_hydrostatic(void **unused)
{
    (void)unused;
    for (int slip = 0; slip < 2; slip++) {
        rheo_world_def def = newtonian_def(0.05, 0.05);
        def.melting.wall = (rheo_wall_slip)slip;
        add_box(&def, 0.4, 0.4);
        fluid f = lattice(0.05, 8, 20, 8, 0);
        start_hydrostatically(&f, &def, 1);
        rheo_world *world = melt_of(def, f);
        step(world, 150);
        double square = 0;
        for (uint32_t i = 0; i < world->state.particles; i++) {
            const double p = 100 * ((double)world->state.density[i] - 1);
            const double exact = 1 - (double)world->state.position[3 * i + 1];
            square += (p - exact) * (p - exact);
        }
        const double rms = sqrt(square / world->state.particles);
        print_message("hydrostatic column, %s: pressure rms %.2f %% of rho g H; fastest %.3g, top %.3f\n",
                      slip ? "free slip" : "no slip", 100 * rms, fastest(world), highest(world, 1));
        assert_true(rms < 0.03);
        rheo_world_destroy(world);
    }
}

/* ---- Conservation ---- */

static double spin_lost(const char *stress, double viscosity)
{
    rheo_world_def def = newtonian_def(0.0625, viscosity);
    set(&def, "melting.stress", stress);
    def.gravity[1] = 0;
    fluid f = sphere(0.0625, 0.5);
    for (uint32_t i = 0; i < f.count; i++) {
        f.v[3 * i] = f.x[3 * i + 2];
        f.v[3 * i + 2] = -f.x[3 * i];
    }
    rheo_world *world = melt_of(def, f);
    const double before = spin_of(world);
    step(world, 25);
    const double lost = spin_of(world) / before - 1;
    print_message("spinning sphere, %s, viscosity %g: angular momentum %+.3f %% in 0.5\n", stress, viscosity,
                  100 * lost);
    rheo_world_destroy(world);
    return lost;
}

static void sphere_keeps_spinning(void **unused)
{
    (void)unused;
    assert_true(fabs(spin_lost("pairwise", 5)) < 0.005);
    assert_true(fabs(spin_lost("nested", 5)) < 0.005); /* corrected gradients do not see rotations */
}

static void dropped_melt_lands(void **unused)
{
    (void)unused;
    for (int hot = 0; hot < 2; hot++) {
        rheo_world_def def = melt_def(0.05);
        def.melting.temperature = hot;
        add_wall(&def, 0, 0, 0, 0, 1, 0);
        fluid f = {0};
        add_lattice(&f, 0.05, (double[]){0, 0.75, 0}, 6, 6, 6, 0);
        rheo_world *world = melt_of(def, f);
        double worst = 0, error = 0;
        for (int s = 0; s < 150; s++) {
            step(world, 1);
            worst = fmax(worst, fastest(world));
            error = fmax(error, metric(world, "max_density_error"));
        }
        print_message(
            "dropped from 0.75, %s: fastest %.2f, largest density error %.3g; after 3: centre %.3f, top %.3f, "
            "fastest %.2g\n",
            hot ? "hot" : "cold", worst, error, metric(world, "centre_y"), highest(world, 1), fastest(world));
        assert_true(lowest(world, 1) >= 0);
        assert_true(worst < 2.5);
        assert_true(error < 0.25);
        assert_true(hot ? highest(world, 1) < 0.2 : fabs(highest(world, 1) - 0.275) < 0.06);
        rheo_world_destroy(world);
    }
}

/* Second derivatives of the kernel change sign, so a temperature step overshoots on disordered particles. */
static void second_derivatives_overshoot(void **unused)
{
    (void)unused;
    double beyond[2];
    for (int laplacian = 0; laplacian < 2; laplacian++) {
        rheo_world_def def = melt_def(0.05);
        def.melting.laplacian = (rheo_laplacian)laplacian;
        def.step = 0.2;
        random_state = 7;
        periodic p = frozen_slab(def, 0.2, half_spaces);
        beyond[laplacian] = 0;
        for (int s = 0; s < 40; s++) {
            step_periodic(&p, 1);
            for (uint32_t i = 0; i < p.own; i++) {
                const double T = (double)p.world->state.temperature[i];
                beyond[laplacian] = fmax(beyond[laplacian], fmax(-1 - T, T - 3) / 4);
            }
        }
        rheo_world_destroy(p.world);
    }
    rheo_world_def def = melt_def(0.05);
    def.melting.laplacian = RHEO_LAPLACIAN_SECOND;
    print_message("Laplacian by second derivatives: overshoots a step by %.2g of it (by first %.2g); k_eff/k %.3f\n",
                  beyond[1], beyond[0], effective_diffusivity(def, 0));
    assert_true(beyond[0] <= 1e-6);
    assert_true(beyond[1] > 1e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heat_flows_as_in_closed_form),
        cmocka_unit_test(half_spaces_even_out),
        cmocka_unit_test(couette),
        cmocka_unit_test(newtonian_poiseuille),
        cmocka_unit_test(column_stays_hydrostatic),
        cmocka_unit_test(sphere_keeps_spinning),
        cmocka_unit_test(second_derivatives_overshoot),
        cmocka_unit_test(dropped_melt_lands),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
