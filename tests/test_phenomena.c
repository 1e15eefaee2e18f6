/*
 * The purpose of the model, in whole scenes. With history the ball is carried and sinks later; without it sinks at
 * once. A rolling ball rolls, stops, and then sinks. A deep pool stays at rest. Bounds allow other particle orders
 * and number types.
 */
#include "support.h"

#include <math.h>

typedef struct fall {
    double to_one_and_a_half, to_two; /* time from contact to this depth in radii; infinite if not reached */
    double rise;                      /* rise after the first minimum, in radii */
} fall;

static fall drop(const char *key, const char *value, int steps)
{
    rheo_scene scene = builtin_scene("bowling-ball-small");
    if (key)
        OK(rheo_world_def_set(&scene.world, key, value, &error));
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    double surface = ball.position[1] - ball.radius - scene.ball.clearance, contact = -1, before = -INFINITY,
           dip = -1;
    fall result = {INFINITY, INFINITY, 0};
    double highest = INFINITY;
    int phase = 0; /* 0 falling, 1 rising after the first minimum, 2 over */
    for (int i = 0; i < steps; i++) {
        step(world, 1);
        OK(rheo_world_body(world, 0, &ball));
        double depth = (surface - (ball.position[1] - ball.radius)) / ball.radius, time = rheo_world_time(world);
        if (depth > 0 && contact < 0)
            contact = time;
        if (contact >= 0 && phase == 0 && depth < before) {
            phase = 1;
            dip = before;
            highest = depth;
        }
        if (phase == 1) {
            highest = fmin(highest, depth);
            result.rise = dip - highest;
            phase = depth > highest + 0.03 ? 2 : 1;
        }
        before = depth;
        if (depth > 1.5)
            result.to_one_and_a_half = fmin(result.to_one_and_a_half, time - contact);
        if (depth > 2)
            result.to_two = fmin(result.to_two, time - contact);
    }
    rheo_world_destroy(world);
    return result;
}

static void the_ball_is_carried_and_later_sinks(void **unused)
{
    (void)unused;
    fall none = drop("history.stiffness", "0", 150), small = drop("history.window", "50", 820),
         usual = drop(NULL, NULL, 820);
    print_message("to 1.5 R / 2 R, rise: without history %.2f / %.2f s, %.3f R; d = 50 %.2f / %.2f s, %.3f R; "
                  "d = 150 %.2f / %.2f s, %.3f R\n",
                  none.to_one_and_a_half, none.to_two, none.rise, small.to_one_and_a_half, small.to_two, small.rise,
                  usual.to_one_and_a_half, usual.to_two, usual.rise);
    assert_true(none.to_one_and_a_half < 1.5 && none.to_two < 2);
    assert_true(usual.to_one_and_a_half >= 5 * none.to_one_and_a_half);
    assert_true(none.rise < 0.06);
    assert_true(usual.rise >= 0.10 && small.rise >= 0.10);
    assert_true(small.to_two > none.to_two && usual.to_two > small.to_two && usual.to_two < 25);
}

/* The ball is rolled in. It dips about a radius, rises, rolls, stops, and then sinks below the surface. */
static void the_ball_rolls_stops_and_sinks(void **unused)
{
    (void)unused;
    rheo_scene scene = builtin_scene("bowling-ball");
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    assert_int_equal(rheo_world_particle_count(world), 20000);
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    double surface = ball.position[1] - ball.radius - scene.ball.clearance, start = ball.position[0];
    double dip = 0, stop = 0, stop_depth = 0, way = 0, sunk = INFINITY;
    bool rolls = false;
    for (int i = 0; i < 720; i++) {
        step(world, 1);
        OK(rheo_world_body(world, 0, &ball));
        double depth = (surface - (ball.position[1] - ball.radius)) / ball.radius, time = rheo_world_time(world);
        double speed = ball.velocity[0], rolling = -ball.spin[2] * ball.radius;
        if (time < 3)
            dip = fmax(dip, depth);
        rolls = rolls || (depth > 0 && speed > 3 && fabs(rolling - speed) < 0.1 * speed);
        if (stop == 0 && speed < 0) {
            stop = time;
            stop_depth = depth;
        }
        way = fmax(way, ball.position[0] - start);
        if (depth > 2)
            sunk = fmin(sunk, time);
    }
    print_message("dip %.2f R, way %.1f, stops at %.1f s at %.2f R, 2 R at %.1f s\n", dip, way, stop, stop_depth,
                  sunk);
    assert_true(rolls);
    assert_true(dip > 0.7 && dip < 1.3);
    assert_true(way > 25);
    assert_true(stop > 2.5 && stop < 6 && stop_depth > 0.6 && stop_depth < 1.2);
    assert_true(sunk > 10 && sunk < 23.7);
    rheo_world_destroy(world);
}

static void the_vibrated_layer_keeps_together(void **unused)
{
    (void)unused;
    rheo_scene scene = builtin_scene("vibration");
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    assert_int_equal(rheo_world_particle_count(world), 20000);
    assert_int_equal(rheo_world_vibrator_count(world), 25);
    step(world, 60);
    double highest = 0;
    for (uint32_t i = 0; i < 20000; i++)
        highest = fmax(highest, (double)rheo_world_positions(world)[3 * i + 1]);
    assert_true(highest < 100);
    assert_true(metric(world, "max_speed") > 5); /* below 1 without vibration */
    rheo_world_destroy(world);
}

static void a_stack_of_ten_thousand_rests(void **unused)
{
    (void)unused;
    rheo_scene scene = builtin_scene("bowling-ball-small");
    scene.world.ball.radius = 0;
    fills_of(&scene)[0].max[0] = fills_of(&scene)[0].max[2] = 40;
    fills_of(&scene)[0].max[1] = 50;
    walls_of(&scene.world)[2].point[0] = walls_of(&scene.world)[4].point[2] = 40;
    scene.settle.time = 0;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    assert_int_equal(rheo_world_particle_count(world), 10000);
    step(world, 2000);
    const rheo_real *x = rheo_world_positions(world);
    for (uint32_t i = 0; i < 10000; i++)
        assert_true(isfinite((double)x[3 * i + 1]) && x[3 * i] >= 0 && x[3 * i] <= 40 && x[3 * i + 1] >= 0 &&
                    x[3 * i + 2] >= 0 && x[3 * i + 2] <= 40);
    assert_true(metric(world, "max_speed") < 3); /* at rest except for jitter */
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_ball_is_carried_and_later_sinks),
        cmocka_unit_test(the_ball_rolls_stops_and_sinks),
        cmocka_unit_test(the_vibrated_layer_keeps_together),
        cmocka_unit_test(a_stack_of_ten_thousand_rests),
    };
    return cmocka_run_group_tests_name("phenomena", tests, NULL, NULL);
}
