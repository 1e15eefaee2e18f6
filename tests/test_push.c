/* The periodic push of the ball (ball.push): its impulse in every step, its phase, and what is refused. */
#include "support.h"

#include <math.h>

#include "world/world.h"

#define PATH "test_push.rlog"

/* A ball in free space, without gravity. */
static rheo_world_def free_ball(void)
{
    rheo_world_def def = rheo_default_world_def();
    def.gravity[1] = 0;
    def.step = 0.0625;
    def.ball.radius = 2;
    def.ball.push[0] = 3;
    def.ball.push[1] = -20;
    return def;
}

static rheo_body ball_of(const rheo_world *world)
{
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    return ball;
}

/* The acceleration at a time, as docs/model.md has it, for a mean of 1. */
static double acceleration(double time, double frequency, double duty)
{
    const double phase = time * frequency - floor(time * frequency), pi = 3.14159265358979323846;
    return phase < duty ? pi / (2 * duty) * sin(pi * phase / duty) : 0;
}

/* Its integral from 0 on, by the midpoint rule. */
static double impulse(double time, double frequency, double duty)
{
    enum { POINTS = 200000 };
    double sum = 0;
    for (int i = 0; i < POINTS; i++)
        sum += acceleration((i + 0.5) * time / POINTS, frequency, duty) * time / POINTS;
    return sum;
}

/* Pushes shorter than a step, over several steps, and several in one step. */
static void the_ball_gets_the_integral_of_half_a_sine(void **unused)
{
    (void)unused;
    const double cases[][2] = {{1, 0.3}, {2, 0.5}, {0.25, 1}, {7, 0.1}, {40, 0.6}};
    for (size_t k = 0; k < 2 * (sizeof cases / sizeof *cases); k++) {
        rheo_world_def def = free_ball();
        def.scheme = k % 2 ? RHEO_SCHEME_SEQUENTIAL : RHEO_SCHEME_SUMMED;
        def.ball.push_frequency = cases[k / 2][0];
        def.ball.push_duty = cases[k / 2][1];
        rheo_world *world = world_of(def, 0, NULL, NULL);
        double most = 0;
        for (int n = 1; n <= 20; n++) {
            step(world, 1);
            const double wanted = impulse(n * def.step, cases[k / 2][0], cases[k / 2][1]);
            const rheo_body ball = ball_of(world);
            NEAR(ball.velocity[0], 3 * wanted, 1e-4);
            NEAR(ball.velocity[1], -20 * wanted, 1e-4);
            assert_true(ball.velocity[2] == 0 && ball.spin[2] == 0);
            most = fmax(most, wanted);
        }
        assert_true(most > 0.5);
        rheo_world_destroy(world);
    }
}

/* With a step of 1/16 and f = 1, 2, 4 a period is a whole number of steps: its mean acceleration is `push`. */
static void a_period_has_the_given_mean(void **unused)
{
    (void)unused;
    for (double duty = 0.1; duty < 1.05; duty += 0.3)
        for (int frequency = 1; frequency <= 4; frequency *= 2) {
            rheo_world_def def = free_ball();
            def.ball.push_frequency = frequency;
            def.ball.push_duty = duty;
            rheo_world *world = world_of(def, 0, NULL, NULL);
            step(world, 160); /* 10 units of time */
            NEAR(ball_of(world).velocity[0], 30, 1e-4);
            NEAR(ball_of(world).velocity[1], -200, 1e-3);
            rheo_world_destroy(world);
        }
}

static double phase_of(const rheo_world *world)
{
    return *world->state.ball_push_phase;
}

/* Other parameters act from the phase at which the push is; one of 0 pushes no more, and its phase goes on. */
static void commands_change_a_push(void **unused)
{
    (void)unused;
    rheo_world_def def = free_ball();
    def.ball.push_frequency = 2; /* 1/8 of a period a step */
    rheo_world *world = world_of(def, 0, NULL, NULL);
    assert_true(phase_of(world) == 0);
    step(world, 2);
    assert_true(phase_of(world) == 0.25);
    NEAR(ball_of(world).velocity[1], -20 / 2.0 * 0.5, 1e-5); /* half of the first push */
    OK(rheo_world_set(world, "ball.push_frequency", "4", &error));
    step(world, 1);
    assert_true(phase_of(world) == 0.5);
    NEAR(ball_of(world).velocity[1], -20 / 2.0 * 0.5 - 20 / 4.0 * 0.5, 1e-5);
    OK(rheo_world_set(world, "ball.push", "[0, 0, 0]", &error));
    const rheo_body before = ball_of(world);
    step(world, 3);
    assert_true(ball_of(world).velocity[1] == before.velocity[1] && phase_of(world) == 0.25);
    OK(rheo_world_set(world, "ball.push", "[0, 8, 0]", &error));
    OK(rheo_world_set(world, "ball.push_duty", "0.25", &error));
    step(world, 1); /* the push of this period is over */
    assert_true(ball_of(world).velocity[1] == before.velocity[1]);
    step(world, 3);
    NEAR(ball_of(world).velocity[1], before.velocity[1] + 8 / 4.0, 1e-5);
    rheo_world_destroy(world);
}

/* A run that goes on from a keyframe in the middle of a push has the same bits as one that went through. */
static void a_push_goes_on_after_a_restart(void **unused)
{
    (void)unused;
    for (int sequential = 0; sequential < 2; sequential++) {
        rheo_scene scene = lively_scene();
        scene.world.scheme = sequential ? RHEO_SCHEME_SEQUENTIAL : RHEO_SCHEME_SUMMED;
        scene.world.ball.push_frequency = 3.7;
        scene.world.ball.push[1] = -60;
        rheo_world *world, *again;
        rheo_recording *recording;
        OK(rheo_scene_create_world(&scene, &world, &error));
        step(world, 11);
        assert_true(phase_of(world) > 0.1 && phase_of(world) < 0.5);
        OK(rheo_world_save(world, "push", PATH, true, &error));
        OK(rheo_recording_open(PATH, &recording, &error));
        OK(rheo_recording_world(recording, 11, NULL, &again, &error));
        rheo_recording_close(recording);
        step(world, 9);
        step(again, 9);
        assert_true(rheo_world_hash(world) == rheo_world_hash(again));
        rheo_world_destroy(again);
        rheo_world_destroy(world);
        remove(PATH);
    }
}

static void a_push_needs_a_world_that_has_one(void **unused)
{
    (void)unused;
    rheo_world_def def = free_ball();
    def.ball.push[0] = def.ball.push[1] = 0;
    rheo_world *world = world_of(def, 0, NULL, NULL);
    assert_int_equal(world->features & RHEO__FEATURE_PUSH, 0);
    REFUSED(RHEO_ERROR_ARGUMENT, "ball.push: this world was made without pushes of the ball",
            rheo_world_set(world, "ball.push", "[0, -1, 0]", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "ball.push_duty: this world was made without pushes of the ball",
            rheo_world_set(world, "ball.push_duty", "0.2", &error));
    OK(rheo_world_set(world, "ball.friction", "9", &error));
    rheo_world_destroy(world);

    def = free_ball();
    def.ball.radius = 0; /* what is not there is not pushed */
    world = world_of(def, 0, NULL, NULL);
    assert_int_equal(world->features & (RHEO__FEATURE_BALL | RHEO__FEATURE_PUSH), 0);
    REFUSED(RHEO_ERROR_ARGUMENT, "without a ball", rheo_world_set(world, "ball.push", "[0, -1, 0]", &error));
    rheo_world_destroy(world);

    rheo_world_def melting = rheo_default_model_def(RHEO_MODEL_MELTING);
    REFUSED(RHEO_ERROR_ARGUMENT, "ball.push", rheo_world_def_set(&melting, "ball.push", "[0, -1, 0]", &error));
}

static void bad_pushes_are_refused(void **unused)
{
    (void)unused;
    rheo_world *world;
    const struct {
        double frequency, duty, push;
        const char *text;
    } bad[] = {{0, 0.5, 1, "ball.push_frequency is 0"},
               {1, 0, 1, "ball.push_duty is 0"},
               {1, 1.5, 1, "ball.push_duty is 1.5"},
               {1, 0.5, NAN, "ball.push"}};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        rheo_world_def def = free_ball();
        def.ball.push_frequency = bad[k].frequency;
        def.ball.push_duty = bad[k].duty;
        def.ball.push[2] = bad[k].push;
        REFUSED(RHEO_ERROR_ARGUMENT, bad[k].text, rheo_world_create(&def, &world, &error));
    }
    /* A phase of a damaged recording. */
    world = world_of(free_ball(), 0, NULL, NULL);
    const double phase[] = {-0.25, 1, 1e300};
    for (size_t k = 0; k < 3; k++) {
        *world->state.ball_push_phase = phase[k];
        REFUSED(RHEO_ERROR_FORMAT, "the push of ball 0 has no phase", rheo__world_check_state(world, true, &error));
    }
    *world->state.ball_push_phase = 0.5;
    OK(rheo__world_check_state(world, true, &error));
    rheo_world_destroy(world);
}

/* The most periods that a step can have, and the shortest push, leave numbers finite. */
static void limits_give_finite_numbers(void **unused)
{
    (void)unused;
    rheo_world_def def = free_ball();
    def.ball.push_frequency = 1e12;
    def.ball.push_duty = 1e-6;
    def.step = 1e6;
    def.ball.push[1] = 1e-9;
    def.ball.push[0] = 0;
    rheo_world *world = world_of(def, 0, NULL, NULL);
    step(world, 3);
    NEAR(ball_of(world).velocity[1], 3e-3, 1e-8);
    assert_true(phase_of(world) >= 0 && phase_of(world) < 1);
    rheo_world_destroy(world);
}

/* Largest depth in five units of time of the lowest point of the foot of a coarse scene `runner`, in radii. */
static double depth_of_foot(const char *frequency, const char *history, int scheme)
{
    rheo_scene scene;
    rheo_world *world;
    OK(rheo_scene_builtin("runner", &scene, &error));
    OK(rheo_scene_set(&scene, "resolution", "0.6", &error));
    OK(rheo_scene_set(&scene, "ball.push_frequency", frequency, &error));
    OK(rheo_scene_set(&scene, "history.stiffness", history, &error));
    scene.world.scheme = (rheo_scheme)scheme;
    OK(rheo_scene_create_world(&scene, &world, &error));
    rheo_scene_release(&scene);
    const double start = ball_of(world).position[1];
    double lowest = start;
    for (int n = 0; n < 152; n++) {
        step(world, 1);
        lowest = fmin(lowest, ball_of(world).position[1]);
    }
    rheo_world_destroy(world);
    return (start - lowest) / 8;
}

/* Mukhopadhyay, Allen, Brown 2018; docs/experiments.md has the whole experiment. */
static void a_foot_stays_up_above_a_cadence(void **unused)
{
    (void)unused;
    const double often = depth_of_foot("1", "150", RHEO_SCHEME_SUMMED),
                 seldom = depth_of_foot("0.25", "150", RHEO_SCHEME_SUMMED),
                 without = depth_of_foot("1", "0", RHEO_SCHEME_SUMMED);
    print_message("depth of the foot: %.2f at f = 1, %.2f at f = .25, %.2f without history\n", often, seldom,
                  without);
    assert_true(often < 1.3 && seldom > often + 0.3 && without > 2);
    /* In the other scheme, too. */
    const double often_sequential = depth_of_foot("1", "150", RHEO_SCHEME_SEQUENTIAL),
                 without_sequential = depth_of_foot("1", "0", RHEO_SCHEME_SEQUENTIAL);
    print_message("in scheme sequential: %.2f, %.2f\n", often_sequential, without_sequential);
    assert_true(often_sequential < 1.3 && without_sequential > 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_ball_gets_the_integral_of_half_a_sine),
        cmocka_unit_test(a_period_has_the_given_mean),
        cmocka_unit_test(commands_change_a_push),
        cmocka_unit_test(a_push_goes_on_after_a_restart),
        cmocka_unit_test(a_push_needs_a_world_that_has_one),
        cmocka_unit_test(bad_pushes_are_refused),
        cmocka_unit_test(limits_give_finite_numbers),
        cmocka_unit_test(a_foot_stays_up_above_a_cadence),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
