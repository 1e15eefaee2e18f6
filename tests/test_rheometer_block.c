/*
 * The block of `rheolog rheometer`: a fluid with viscosity only has the stress of its own pairs, and nearly that of the formula; a
 * spring between two plates, in a world, feels the force of the pair's closed form.
 */
#include "support.h"

#include <math.h>

#include "cli/rheometer_block.h"

/* Fluid with impulses between approaching pairs, without springs and pressure. */
static void begin(cli_measurement *m, cli_progress *progress)
{
    *progress = (cli_progress){.quiet = true};
    *m = (cli_measurement){.scene_name = "test", .small = true, .progress = progress};
    m->scene = rheo_default_scene();
    m->scene.world.step = .001;
    m->scene.world.springs.stiffness = 0;
    m->scene.world.fluid.linear_viscosity = 100;
    m->scene.world.fluid.quadratic_viscosity = 0;
}

/* Stress/n of the viscous impulses in a state: minus the sum of (sigma w u/2) x y/r over approaching pairs, over the particles. */
static double stress_of_pairs(const rheo_world *world, const cli_block *b)
{
    const rheo_world_def *def = rheo_world_definition(world);
    const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
    const uint32_t count = rheo_world_particle_count(world);
    const double h = def->fluid.support;
    double sum = 0;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = 0; j < i; j++) {
            double d[3], rr = 0, approach = 0;
            for (int axis = 0; axis < 3; axis++) {
                const double period = def->space.period[axis];
                d[axis] = (double)x[3 * j + axis] - (double)x[3 * i + axis];
                if (period > 0)
                    d[axis] -= period * floor(d[axis] / period + .5);
                rr += d[axis] * d[axis];
                approach += ((double)v[3 * i + axis] - (double)v[3 * j + axis]) * d[axis];
            }
            const double r = sqrt(rr);
            if (r >= h)
                continue;
            const double w = 1 - r / h, u = fmax(approach / r, 0);
            const double force = def->fluid.linear_viscosity * w * u / 2;
            /* Only the part of the pair between the cuts: the fluid there carries the stress. */
            const double low = fmin((double)x[3 * i + 1], (double)x[3 * j + 1]),
                         high = fmax((double)x[3 * i + 1], (double)x[3 * j + 1]);
            const double inside = fmax(0, fmin(high, b->upper) - fmax(low, b->lower)) / (high - low);
            sum -= inside * force * d[0] * d[1] / r;
        }
    return sum / (b->area * b->gap * b->density);
}

static void a_viscous_block_has_the_stress_of_its_pairs(void **unused)
{
    (void)unused;
    enum { PARTS = 24, STEPS = 5 };
    const double rate = 5;
    cli_progress progress;
    cli_measurement m;
    cli_block b;
    cli_shear s;
    begin(&m, &progress);
    assert_int_equal(cli_block_make(&m, &b), CLI_DONE);
    assert_int_equal(cli_shear_begin(&s, &b, &m, "test", "velocity", rate), CLI_DONE);
    assert_int_equal(cli_shear_set(&s, "fluid.stiffness", false, 0), CLI_DONE);
    assert_int_equal(cli_shear_set(&s, "fluid.near_stiffness", false, 0), CLI_DONE);
    const double uniform = stress_of_pairs(s.world, &b); /* the directions of pairs are still isotropic */
    /* The first passage of momentum through the gap, then means of both stresses. */
    assert_int_equal(cli_shear_run(&s, 60), CLI_DONE);
    double pairs = 0, plates = 0;
    for (int part = 0; part < PARTS; part++) {
        const double before = stress_of_pairs(s.world, &b);
        assert_int_equal(cli_shear_run(&s, STEPS), CLI_DONE);
        pairs += (before + stress_of_pairs(s.world, &b)) / 2 / PARTS;
        for (int i = 1; i <= STEPS; i++)
            plates += s.stress[s.samples - i] / (PARTS * STEPS);
    }
    print_message("viscosity %g by plates, %g by pairs, %g of uniform shear, %g by the formula\n", plates / rate,
                  pairs / rate, uniform / rate, b.viscosity);
    NEAR(s.strain[s.samples - 1], 181 * .001 * rate, 1e-6);
    NEAR(plates / pairs, 1, .03);
    NEAR(uniform / rate / b.viscosity, 1, .06);
    cli_shear_release(&s);
    cli_block_release(&b);
    rheo_scene_release(&m.scene);
}

/* ---- The pair, in a world ---- */

enum { PAIR_STEPS = 400 };

/* Two particles, each a plate; the upper one oscillates along their line. The force gives K, step by step. */
static void assert_pair(rheo_history_kind kind, uint32_t lag)
{
    rheo_world_def def = rheo_default_world_def();
    const double apart = .002; /* heights, so small that the pair is along x */
    const rheo_real pair[] = {0, (rheo_real)-apart, 0, 2, (rheo_real)apart, 0};
    memset(def.gravity, 0, sizeof def.gravity);
    def.fluid.stiffness = def.fluid.near_stiffness = 0;
    def.fluid.linear_viscosity = def.fluid.quadratic_viscosity = 0;
    def.springs.plasticity = 0;
    def.history.kind = kind;
    def.history.window = 50;
    def.history.lag = lag;
    def.substeps = 1;
    def.space.period[0] = def.space.period[2] = 32;
    def.plates.lower = -apart / 2;
    def.plates.upper = apart / 2;
    def.plates.amplitude = .2;
    def.plates.frequency = .3;
    rheo_world *world = world_of(def, 2, pair, NULL);
    static double velocity[PAIR_STEPS], derivative[PAIR_STEPS], stiffness[PAIR_STEPS];
    rheo_spring spring;
    for (int n = 0; n < PAIR_STEPS; n++) {
        const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
        const double length = (double)x[3] - (double)x[0] + def.step * ((double)v[3] - (double)v[0]);
        rheo_plate upper;
        OK(rheo_world_step(world, &error));
        OK(rheo_world_springs(world, &spring, 1));
        assert_true(rheo_world_plate(world, 1, &upper));
        const double stretch = length - (double)spring.rest_length;
        stiffness[n] = fabs(stretch) > .02 ? -2 * upper.force[0] / stretch : NAN;
        velocity[n] = upper.velocity[0];
    }
    cli_memory memory;
    OK(cli_memory_make(&def, kind, def.history.order, &memory));
    OK(cli_memory_apply(&memory, velocity, PAIR_STEPS, derivative));
    int compared = 0;
    double stiffest = 0;
    for (int n = 0; n < PAIR_STEPS; n++) {
        const double d = fabs(derivative[n]);
        const double k =
            def.springs.stiffness + (d > 0 ? def.history.stiffness * d * d / (d + def.history.onset) : 0);
        if (isnan(stiffness[n]))
            continue;
        NEAR(stiffness[n], k, 1e-3 * k);
        stiffest = fmax(stiffest, k);
        compared++;
    }
    assert_true(compared > PAIR_STEPS / 2 && stiffest > 3 * def.springs.stiffness);
    cli_memory_release(&memory);
    rheo_world_destroy(world);
}

static void a_pair_in_a_world_has_the_stiffness_of_the_instrument(void **unused)
{
    (void)unused;
    assert_pair(RHEO_HISTORY_WINDOW, 0);
    assert_pair(RHEO_HISTORY_WINDOW, 7);
    assert_pair(RHEO_HISTORY_WINDOW_FAST, 0);
    assert_pair(RHEO_HISTORY_FULL, 0);
    assert_pair(RHEO_HISTORY_TEMPERED, 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_viscous_block_has_the_stress_of_its_pairs),
                                       cmocka_unit_test(a_pair_in_a_world_has_the_stiffness_of_the_instrument)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
