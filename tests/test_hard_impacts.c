/* Hard cases with a ball, and with walls that press: impacts, masses, deep stacks, jammed boxes, fast plates and vibrators. */
#include "hard.h"

/* ---- A ball ---- */

/* The ball falls from a height of 2 L into a settled pool of 12 x 8 x 12 particles. */
static settled settled_pool(void)
{
    rheo_scene scene = pool_scene(12, 8, 12);
    scene.settle.time = 1;
    return settle(&scene);
}

static rheo_world_def in_scheme(const settled *s, int scheme)
{
    rheo_world_def def = s->def;
    def.scheme = (rheo_scheme)scheme;
    if (scheme == RHEO_SCHEME_POSITIONS)
        def.particles.spring_count = 0;
    return def;
}

/*
 * Speed of the ball at the floor if nothing slows it. A light particle leaves a heavy ball with at most twice its speed (elastic);
 * contact gives it less.
 */
static double most_speed(const rheo_world_def *def)
{
    return sqrt(square(def->ball.velocity[1]) + 2 * 9.81 * def->ball.position[1]);
}

/*
 * Energy that the pool can give back: it is pressed by its own weight. Per mass this is (g z)^2/(2 c^2) at the depth z, a third of
 * that at the floor in the mean, with the speed of sound c of docs/model.md.
 */
static double pressed_energy(const settled *s)
{
    const double c = 57;
    return s->def.particles.count * square(9.81 * s->surface) / (6 * c * c);
}

static rheo_body ball_of(const rheo_world *world)
{
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    return ball;
}

/* Usual are 17 L/T. At 100 times that the ball crosses the pool in one step. */
static void an_impact_at_10_and_100_times_the_speed_is_bounded(void **unused)
{
    (void)unused;
    settled s = settled_pool();
    static const double speed[] = {170, 1700};
    for (int scheme = 0; scheme < SCHEMES; scheme++)
        for (int k = 0; k < 2; k++) {
            rheo_world_def def = in_scheme(&s, scheme);
            def.ball.velocity[1] = -speed[k];
            rheo_world *world = start(&def);
            const course c = drive(world, 200);
            print_message("%s, %g L/T: %d steps, fastest %g, energy %g of %g, %g substeps\n", scheme_name(scheme),
                          speed[k], c.steps, c.fastest, c.most, c.begin, c.substeps);
            if (c.result != RHEO_OK) { /* Algorithm 1 has springs that are too stiff for one step */
                assert_int_equal(scheme, RHEO_SCHEME_SEQUENTIAL);
                assert_says_where(world, &c);
                assert_true(says(c.error.message, "A smaller step may help, or softer springs"));
            } else {
                assert_true(c.fastest <= 2 * most_speed(&def));
                const rheo_body ball = ball_of(world);
                assert_true(ball.position[1] >= ball.radius * (1 - 1e-5) && fabs(ball.velocity[1]) < 10);
                if (scheme == RHEO_SCHEME_SUMMED)
                    assert_true(c.most <= c.begin + pressed_energy(&s) && metric(world, "max_speed") < 10);
            }
            rheo_world_destroy(world);
        }
    release(&s);
}

/* The implicit solver of springs takes what the explicit one does not, and no energy is made. */
static void the_implicit_solver_takes_the_fast_impact(void **unused)
{
    (void)unused;
    settled s = settled_pool();
    rheo_world_def def = in_scheme(&s, RHEO_SCHEME_SEQUENTIAL);
    set(&def, "springs.solver", "implicit");
    def.ball.velocity[1] = -170;
    rheo_world *world = start(&def);
    const course c = drive_all(world, 200);
    print_message("implicit: fastest %g, at the end %g, energy %g of %g\n", c.fastest, metric(world, "max_speed"),
                  c.most, c.begin);
    assert_true(c.most <= 1.01 * c.begin && metric(world, "max_speed") < 170);
    rheo_world_destroy(world);
    release(&s);
}

static void a_ball_1000_times_as_heavy_lies_on_the_floor(void **unused)
{
    (void)unused;
    settled s = settled_pool();
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world_def def = in_scheme(&s, scheme);
        def.ball.density_ratio *= 1000;
        rheo_world *world = start(&def);
        const course c = drive(world, 300);
        print_message("%s, ratio %g: %d steps, fastest %g, %g substeps\n", scheme_name(scheme),
                      def.ball.density_ratio, c.steps, c.fastest, c.substeps);
        if (c.result != RHEO_OK) {
            assert_int_equal(scheme, RHEO_SCHEME_SEQUENTIAL);
            assert_says_where(world, &c);
        } else {
            const rheo_body ball = ball_of(world);
            NEAR(ball.position[1], ball.radius, 1e-4);
            NEAR(ball.velocity[1], 0, 0.1);
            assert_true(c.fastest <= 2 * most_speed(&def));
            if (scheme == RHEO_SCHEME_SUMMED) /* 1 % of the reserve of the pool is far below that of the ball */
                assert_true(c.most <= c.begin + pressed_energy(&s));
        }
        rheo_world_destroy(world);
    }
    release(&s);
}

/*
 * A ball of 1/100 of the density rises from the floor. Without drag and without the mass of the fluid that it moves, buoyancy gives
 * it v^2 = 2 g H (1/ratio - 1) on its way H to the surface. The fluid, which it overlaps at first, gets no faster either.
 */
static void a_ball_of_a_hundredth_of_the_mass_floats_up(void **unused)
{
    (void)unused;
    settled s = settled_pool();
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world_def def = in_scheme(&s, scheme);
        def.ball.density_ratio /= 100;
        def.ball.position[1] = def.ball.radius + 0.5;
        memset(def.ball.velocity, 0, sizeof def.ball.velocity);
        const double most = sqrt(2 * 9.81 * s.surface * (1 / def.ball.density_ratio - 1));
        rheo_world *world = start(&def);
        double fastest_ball = 0, fastest = 0;
        for (int i = 0; i < 400; i++) {
            step(world, 1);
            assert_finite(world);
            fastest_ball = fmax(fastest_ball, fabs(ball_of(world).velocity[1]));
            fastest = fmax(fastest, metric(world, "max_speed"));
        }
        print_message("%s: ball at %g of %g, fastest %g, ball %g, at most %g\n", scheme_name(scheme),
                      ball_of(world).position[1], s.surface, fastest, fastest_ball, most);
        assert_true(fastest_ball <= most && fastest <= most);
        assert_true(ball_of(world).position[1] > def.ball.radius + (scheme == RHEO_SCHEME_SUMMED ? 4 : 1));
        NEAR(ball_of(world).velocity[1], 0, 2);
        rheo_world_destroy(world);
    }
    release(&s);
}

/* ---- Walls ---- */

/* A cube of particles on a simple cubic lattice of this distance in a box that it fills: walls keep centres half a spacing away. */
static rheo_world *boxed(rheo_world_def def, int n, double distance)
{
    const double inner = (n - 1) * distance, outer = inner + def.fluid.spacing;
    rheo_real *x = reals(3 * (size_t)(n * n * n));
    box_walls(&def, outer, outer, outer);
    const double corner = 0.5 * (def.fluid.spacing - distance);
    rheo_world_def at = def;
    at.fluid.spacing = distance;
    const uint32_t count = lattice(&at, n, n, n, (double[]){corner, corner, corner}, x);
    rheo_world *world = world_of(def, count, x, NULL);
    free(x);
    return world;
}

/*
 * A cube in half of the volume that it takes at rest: it begins with the energy of its pressure, and never has more; then it comes
 * to rest, inside.
 */
static void a_cube_in_half_of_its_volume_jams(void **unused)
{
    (void)unused;
    const int n = 8;
    const double distance = 2 * cbrt(0.5), outer = (n - 1) * distance + 2;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world_def def = rheo_default_world_def();
        set(&def, "scheme", scheme_name(scheme));
        rheo_world *world = boxed(def, n, distance);
        const double stored = pressure_energy(world);
        const course c = drive(world, 300);
        print_message("%s: %d steps, fastest %g, at the end %g, energy %g + %g, most %g\n", scheme_name(scheme),
                      c.steps, c.fastest, metric(world, "max_speed"), c.begin, stored, c.most);
        if (c.result != RHEO_OK) {
            assert_int_equal(scheme, RHEO_SCHEME_SEQUENTIAL);
            assert_says_where(world, &c);
        } else {
            for (size_t i = 0; i < 3 * (size_t)(n * n * n); i++) {
                const double x = (double)rheo_world_positions(world)[i];
                assert_true(x >= 1 - 1e-4 && x <= outer - 1 + 1e-4);
            }
            assert_true(metric(world, "max_speed") < 2);
            if (scheme == RHEO_SCHEME_SUMMED)
                assert_true(c.most <= c.begin + stored);
        }
        rheo_world_destroy(world);
    }
}

/* A small scene of plates; the upper one rests. */
static rheo_world *plates(void)
{
    rheo_scene scene = builtin_scene("plates");
    fills_of(&scene)[0].max[0] = fills_of(&scene)[0].max[2] = scene.world.space.period[0] =
        scene.world.space.period[2] = 6 * scene.world.fluid.spacing;
    memset(scene.world.plates.velocity, 0, sizeof scene.world.plates.velocity);
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    return world;
}

/*
 * The upper plate comes down by half of the gap, slowly, and at the speed of sound. Fluid that is pressed harder than the particles
 * of a plate hold it passes between them, so it does not become twice as dense.
 */
static void a_plate_comes_down_by_half_of_the_gap(void **unused)
{
    (void)unused;
    static const double speed[] = {2, 57};
    for (int k = 0; k < 2; k++) {
        rheo_world *world = plates();
        const rheo_world_def *def = rheo_world_definition(world);
        const double gap = def->plates.upper - def->plates.lower;
        const int steps = (int)ceil(gap / 2 / speed[k] / def->step);
        char text[64];
        snprintf(text, sizeof text, "[0, %.17g, 0]", -gap / 2 / (steps * def->step));
        OK(rheo_world_set(world, "plates.velocity", text, &error));
        const course down = drive_all(world, steps);
        OK(rheo_world_set(world, "plates.velocity", "[0, 0, 0]", &error));
        const course after = drive_all(world, 150);
        rheo_plate plate;
        assert_true(rheo_world_plate(world, RHEO_PLATE_UPPER, &plate));
        uint32_t out = 0;
        for (uint32_t i = 0; i < rheo_world_particle_count(world); i++)
            out += (double)rheo_world_positions(world)[3 * (size_t)i + 1] > def->plates.upper - gap / 2;
        print_message(
            "%g L/T: fastest %g, after it %g, at the end %g, %g times the density, %u above of a plate of %u\n",
            speed[k], down.fastest, after.fastest, metric(world, "max_speed"), metric(world, "max_density"), out,
            plate.particles);
        NEAR(plate.displacement[1], -gap / 2, 1e-6 * gap);
        /* A plate sets fluid at rest in motion at no more than twice its speed, and pressed fluid expands at the speed of sound. */
        assert_true(fmax(down.fastest, after.fastest) <= 2 * speed[k] + 57);
        assert_true(metric(world, "max_speed") < 5 && metric(world, "max_density") < 2);
        rheo_world_destroy(world);
    }
}

/* Faster than a support in a step (121 L/T): fluid follows, or the step is refused where it leaves periodic space. */
static void a_plate_faster_than_a_support_in_a_step(void **unused)
{
    (void)unused;
    for (int k = 0; k < 2; k++) {
        rheo_world *world = plates();
        const double most = rheo_world_definition(world)->space.period[0] / 4 / rheo_world_definition(world)->step;
        const double speed = k ? 1e4 : 0.9 * most;
        char text[64];
        snprintf(text, sizeof text, "[%.17g, 0, 0]", speed);
        OK(rheo_world_set(world, "plates.velocity", text, &error));
        const course c = drive(world, 100);
        print_message("%g of %g L/T: %d steps, fastest %g: %s\n", speed, most, c.steps, c.fastest, c.error.message);
        if (k) {
            assert_says_where(world, &c);
            assert_int_equal(c.steps, 0);
        } else {
            assert_int_equal(c.result, RHEO_OK);
            assert_true(c.fastest <= 1.5 * speed);
        }
        rheo_world_destroy(world);
    }
}

/*
 * Vibrators that move by more than a support in a step. The floor gives a particle at most its own speed, 2 pi f a with f up to f0
 * (1 + spread). The pushes of kind force are accelerations up to a (2 pi f)^2, whose phases differ in every step; all in one
 * direction give the bound.
 */
static void vibrators_faster_than_a_support_in_a_step(void **unused)
{
    (void)unused;
    enum { STEPS = 100 };
    static const double amplitude[] = {0.3, 4, 4}, frequency[] = {1000, 10, 1000};
    for (int scheme = 0; scheme < SCHEMES; scheme++)
        for (int kind = 0; kind < 2; kind++)
            for (int k = 0; k < 3; k++) {
                rheo_scene scene = pool_scene(8, 4, 8);
                scene.world.ball.radius = scene.settle.time = 0;
                scene.world.scheme = (rheo_scheme)scheme;
                scene.world.vibrators.kind = (rheo_vibrator_kind)kind;
                scene.world.vibrators.position = some_vibrators();
                scene.world.vibrators.count = 1;
                vibrators_of(&scene.world)[0][0] = vibrators_of(&scene.world)[0][1] = 8;
                scene.world.vibrators.amplitude = amplitude[k];
                scene.world.vibrators.frequency = frequency[k];
                scene.world.vibrators.radius = 20;
                scene.world.vibrators.height = 4;
                rheo_world *world;
                OK(rheo_scene_create_world(&scene, &world, &error));
                const course c = drive(world, STEPS);
                const double omega = 2 * 3.14159265358979 * 1.5 * frequency[k], wall = omega * amplitude[k],
                             most = kind == RHEO_VIBRATOR_FLOOR ? wall : wall * omega * STEPS * scene.world.step;
                if (c.result != RHEO_OK || !(c.fastest <= most))
                    print_message("%s, kind %d, %g L, %g/T: %d steps, fastest %g of %g\n", scheme_name(scheme), kind,
                                  amplitude[k], frequency[k], c.steps, c.fastest, most);
                if (scheme == RHEO_SCHEME_SEQUENTIAL && c.result != RHEO_OK) /* nor does a bound hold in it */
                    assert_says_where(world, &c);
                else if (scheme != RHEO_SCHEME_SEQUENTIAL)
                    assert_true(c.result == RHEO_OK && c.fastest <= most);
                rheo_world_destroy(world);
            }
}

/*
 * A stack of 100 layers falls together by its own weight. Nothing falls by more than its height, and what expands does so at the
 * speed of sound; no layer is denser than the whole weight makes the lowest one: rho0 (1 + g H/c^2), and half of that again while
 * it swings.
 */
static void a_stack_of_100_layers_stands(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world_def def = rheo_default_world_def();
        set(&def, "scheme", scheme_name(scheme));
        box_walls(&def, 8, 1000, 8);
        rheo_real *x = reals(3 * 1600);
        lattice(&def, 4, 100, 4, (double[]){0, 0, 0}, x);
        rheo_world *world = world_of(def, 1600, x, NULL);
        const double stored = pressure_energy(world);
        const course c = drive_all(world, 150);
        const double most = 1 + 1.5 * 9.81 * 200 / square(57);
        print_message("%s: fastest %g, at the end %g, density %g of %g, centre at %g\n", scheme_name(scheme),
                      c.fastest, metric(world, "max_speed"), metric(world, "max_density"), most,
                      metric(world, "centre_y"));
        assert_true(c.fastest < 57 && metric(world, "max_density") < most);
        if (scheme == RHEO_SCHEME_SUMMED)
            assert_true(c.most <= c.begin + stored);
        assert_true(metric(world, "centre_y") > 60);
        rheo_world_destroy(world);
        free(x);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_impact_at_10_and_100_times_the_speed_is_bounded),
        cmocka_unit_test(the_implicit_solver_takes_the_fast_impact),
        cmocka_unit_test(a_ball_1000_times_as_heavy_lies_on_the_floor),
        cmocka_unit_test(a_ball_of_a_hundredth_of_the_mass_floats_up),
        cmocka_unit_test(a_cube_in_half_of_its_volume_jams),
        cmocka_unit_test(a_plate_comes_down_by_half_of_the_gap),
        cmocka_unit_test(a_plate_faster_than_a_support_in_a_step),
        cmocka_unit_test(vibrators_faster_than_a_support_in_a_step),
        cmocka_unit_test(a_stack_of_100_layers_stands),
    };
    return cmocka_run_group_tests_name("hard_impacts", tests, NULL, NULL);
}
