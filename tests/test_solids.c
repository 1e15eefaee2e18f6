/* Walls, ball and vibrators, each alone. */
#include "support.h"

#include <math.h>

static rheo_world_def walled(void)
{
    rheo_world_def def = inert_def();
    def.walls.plane = some_walls();
    def.walls.count = 1;
    walls_of(&def)[0] = (rheo_wall){{5, 0, 5}, {0, 3, 0}};
    return def;
}

/*
 * A particle past the wall is moved onto it, at most 1024 tiny lengths deep, and its velocity into the wall is
 * cancelled.
 */
static void a_particle_stops_at_a_wall(void **unused)
{
    (void)unused;
    const rheo_real position[] = {0, 0.01F, 0}, velocity[] = {2, -3, 0};
    rheo_world *world = world_of(walled(), 1, position, velocity);
    step(world, 1);
    const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
    assert_true(x[1] >= 0 && x[1] < 1e-3F);
    NEAR((double)v[1], 0, 0);
    NEAR((double)v[0], 2, 1e-5); /* no springs, hence no sticking */
    rheo_world_destroy(world);
}

/* A particle within half a spacing is at the wall; one farther out or moving away is not. */
static void walls_act_within_half_a_spacing(void **unused)
{
    (void)unused;
    const rheo_real position[] = {0, 0.45F, 0, 9, 0.6F, 0, 18, 0.3F, 0};
    const rheo_real velocity[] = {0, -0.1F, 0, 0, -0.1F, 0, 0, 0.1F, 0};
    rheo_world *world = world_of(walled(), 3, position, velocity);
    step(world, 1);
    const rheo_real *v = rheo_world_velocities(world);
    NEAR((double)v[1], 0, 0);
    NEAR((double)v[4], -0.1, 1e-5);
    NEAR((double)v[7], 0.1, 1e-5);
    rheo_world_destroy(world);
}

/* f = max(0, 1 - c_b mean(k_hist |D^q|)/(10 k_min)), over the springs of the particle. */
static void stiff_fluid_sticks(void **unused)
{
    (void)unused;
    double kept[3];
    for (int i = 0; i < 3; i++) {
        rheo_world_def def = walled();
        def.springs.stiffness = 1e-6;
        def.history.stiffness = 5e-6;
        def.walls.sticking = i == 0 ? 0 : i == 1 ? 1 : 1000;
        const rheo_real position[] = {0, 0.1F, 0, 1, 0.1F, 0}, velocity[] = {1, 0, 0, 0.5F, 0, 0};
        rheo_world *world = world_of(def, 2, position, velocity);
        step(world, 1); /* no history yet */
        NEAR((double)rheo_world_velocities(world)[0], 1, 1e-4);
        rheo_spring_state spring;
        OK(rheo_world_spring(world, 0, 1, &spring, &error));
        double v = (double)rheo_world_velocities(world)[0];
        step(world, 1);
        kept[i] = (double)rheo_world_velocities(world)[0] / v;
        double factor = 1 - def.walls.sticking * 5e-6 * spring.history_rate / (10 * 1e-6);
        NEAR(kept[i], factor > 0 ? factor : 0, 1e-4);
        NEAR((double)rheo_world_velocities(world)[3], 0.5 * kept[i], 1e-4); /* the other end as well */
        rheo_world_destroy(world);
    }
    assert_true(kept[0] > kept[1] && kept[1] > 0.5 && kept[1] < 0.99 && kept[2] == 0);
}

static rheo_world_def ball_def(void)
{
    rheo_world_def def = inert_def();
    def.ball.radius = 2;
    def.ball.density_ratio = 1;
    def.ball.friction = 0;
    def.ball.position[1] = 2.1;
    def.step = 0.0625;
    return def;
}

/* Momentum passes from the ball to a particle in a head-on impact; a frictionless ball does not turn. */
static void the_ball_and_a_particle_exchange_momentum(void **unused)
{
    (void)unused;
    rheo_world_def def = ball_def();
    def.ball.velocity[1] = -8;
    const rheo_real position[] = {0, 0, 0};
    rheo_world *world = world_of(def, 1, position, NULL);
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    double mass = ball.mass;
    NEAR(mass, 4.0 / 3 * 3.14159265 * 8, 1e-4);
    step(world, 1);
    OK(rheo_world_body(world, 0, &ball));
    const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
    NEAR(mass * ball.velocity[1] + (double)v[1], -8 * mass, 1e-4);
    NEAR((double)v[1], ball.velocity[1], 1e-5);     /* inelastic impact */
    NEAR(ball.position[1] - (double)x[1], 2, 1e-5); /* on the surface */
    NEAR(ball.spin[0] + ball.spin[1] + ball.spin[2], 0, 0);
    rheo_world_destroy(world);
}

/* A particle that slides along the surface turns the ball. Linear and angular momentum are conserved. */
static void friction_turns_the_ball(void **unused)
{
    (void)unused;
    rheo_world_def def = ball_def();
    def.ball.position[1] = 1.95;
    def.ball.friction = 0.5;
    const rheo_real position[] = {-0.1F, 0, 0}, velocity[] = {1.6F, 0, 0};
    rheo_world *world = world_of(def, 1, position, velocity);
    step(world, 1);
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    const rheo_real *v = rheo_world_velocities(world);
    NEAR((double)v[0] + ball.mass * ball.velocity[0], 1.6, 1e-4);
    assert_true(ball.spin[2] > 0); /* below the centre, pushed towards +x */
    double friction = ball.mass * ball.velocity[0];
    NEAR(friction, 0.5 * 1.6 / (1 + 3.5 / ball.mass), 1e-3);
    NEAR(ball.spin[2], friction * 2 / (0.4 * ball.mass * 4), 1e-3);
    rheo_world_destroy(world);
}

static void a_particle_in_the_centre_of_the_ball(void **unused)
{
    (void)unused;
    rheo_world_def def = ball_def();
    const rheo_real position[] = {0, (rheo_real)2.1, 0};
    rheo_world *world = world_of(def, 1, position, NULL);
    step(world, 1);
    NEAR((double)rheo_world_positions(world)[1], 4.1, 1e-5);
    rheo_world_destroy(world);
}

/* The ball starts to roll on an incline: after a while the contact point hardly slides. */
static void the_ball_rolls_along_a_wall(void **unused)
{
    (void)unused;
    rheo_world_def def = ball_def();
    def.gravity[1] = -9.81;
    def.step = 0.01;
    def.ball.friction = 0.5;
    def.walls.plane = some_walls();
    def.walls.count = 1;
    walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    def.ball.position[1] = 2;
    def.ball.velocity[0] = 5;
    rheo_world *world = world_of(def, 0, NULL, NULL);
    step(world, 200);
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    NEAR(ball.velocity[0], 5 * 5.0 / 7, 1e-2); /* rolling keeps 5/7 of the sliding speed */
    NEAR(-ball.spin[2] * 2, ball.velocity[0], 1e-3);
    NEAR(ball.position[1], 2, 1e-4);
    double q = 0;
    for (int i = 0; i < 4; i++)
        q += ball.orientation[i] * ball.orientation[i];
    NEAR(q, 1, 1e-6);
    assert_true(fabs(ball.orientation[3]) > 1e-3 || fabs(ball.orientation[0]) < 0.999);
    rheo_world_destroy(world);
}

static rheo_world_def vibrated(rheo_vibrator_kind kind)
{
    rheo_world_def def = walled();
    def.vibrators.kind = kind;
    def.vibrators.position = some_vibrators();
    def.vibrators.count = 2;
    vibrators_of(&def)[0][0] = 3;
    vibrators_of(&def)[1][0] = 50;
    def.vibrators.radius = 4;
    def.vibrators.amplitude = 0.25;
    def.vibrators.height = 10;
    def.step = 0.01;
    return def;
}

/* The floor lifts particles on it by a (1 - rho^2)^2 sin(phase), and no others. */
static void vibrators_raise_the_floor(void **unused)
{
    (void)unused;
    rheo_world_def def = vibrated(RHEO_VIBRATOR_FLOOR);
    const rheo_real position[] = {3, 0, 0, 5, 0, 0, 20, 0, 0};
    def.gravity[1] = -0.5;
    rheo_world *world = world_of(def, 3, position, NULL);
    double highest[3] = {0};
    for (int i = 0; i < 100; i++) {
        step(world, 1);
        rheo_vibrator vibrator;
        OK(rheo_world_vibrator(world, 0, &vibrator));
        assert_true(vibrator.phase >= 0 && vibrator.phase < 1 && vibrator.frequency >= 2.499 &&
                    vibrator.frequency <= 7.501);
        double bump = 0.25 * sin(2 * 3.14159265358979 * vibrator.phase);
        const rheo_real *x = rheo_world_positions(world);
        assert_true((double)x[1] > bump - 1e-5);
        assert_true((double)x[4] > bump * 0.5625 - 1e-5); /* (1 - 1/4)^2 */
        for (int p = 0; p < 3; p++)
            highest[p] = fmax(highest[p], (double)x[3 * p + 1]);
    }
    assert_true(highest[0] > 0.25 && highest[1] > 0.14 && highest[2] < 1e-2);
    rheo_world_destroy(world);
}

static void sources_push_what_is_low(void **unused)
{
    (void)unused;
    rheo_world_def def = vibrated(RHEO_VIBRATOR_FORCE);
    def.walls.count = 0;
    const rheo_real position[] = {3, 1, 0, 5, 1, 0, 3, 11, 0, 20, 1, 0};
    rheo_world *world = world_of(def, 4, position, NULL);
    step(world, 1);
    rheo_vibrator vibrator;
    OK(rheo_world_vibrator(world, 0, &vibrator));
    double omega = 2 * 3.14159265358979 * vibrator.frequency;
    double push = 0.01 * 0.25 * omega * omega * sin(2 * 3.14159265358979 * vibrator.phase);
    const rheo_real *v = rheo_world_velocities(world);
    assert_true(fabs(push) > 1e-3);
    NEAR((double)v[1], push, fabs(push) * 1e-3);
    NEAR((double)v[4], push * 0.75, fabs(push) * 1e-3);
    NEAR((double)v[7], 0, 0);
    NEAR((double)v[10], 0, 0);
    rheo_world_destroy(world);
}

/* The frequencies vary independently. The random numbers are part of the state, so another seed makes another run. */
static void frequencies_wander(void **unused)
{
    (void)unused;
    double frequency[2][2];
    for (int run = 0; run < 2; run++) {
        rheo_world_def def = vibrated(RHEO_VIBRATOR_FLOOR);
        def.vibrators.seed = (uint64_t)run + 1;
        rheo_world *world = world_of(def, 0, NULL, NULL);
        rheo_vibrator first, later;
        OK(rheo_world_vibrator(world, 0, &first));
        step(world, 50);
        for (uint32_t i = 0; i < 2; i++) {
            OK(rheo_world_vibrator(world, i, &later));
            frequency[run][i] = later.frequency;
        }
        assert_true(frequency[run][0] != first.frequency);
        rheo_world_destroy(world);
    }
    assert_true(frequency[0][0] != frequency[0][1] && frequency[0][0] != frequency[1][0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_particle_stops_at_a_wall),  cmocka_unit_test(walls_act_within_half_a_spacing),
        cmocka_unit_test(stiff_fluid_sticks),          cmocka_unit_test(the_ball_and_a_particle_exchange_momentum),
        cmocka_unit_test(friction_turns_the_ball),     cmocka_unit_test(a_particle_in_the_centre_of_the_ball),
        cmocka_unit_test(the_ball_rolls_along_a_wall), cmocka_unit_test(vibrators_raise_the_floor),
        cmocka_unit_test(sources_push_what_is_low),    cmocka_unit_test(frequencies_wander),
    };
    return cmocka_run_group_tests_name("solids", tests, NULL, NULL);
}
