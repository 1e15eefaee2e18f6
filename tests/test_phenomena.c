/*
 * What the model is for: with history the ball is carried and later sinks, without it sinks at once. Bounds leave room
 * for what another order or seed changes (docs/model.md).
 */
#include "support.h"

#include <math.h>

typedef struct fall {
    double to_one_and_a_half, to_two; /* time from contact until so many radii deep; infinite if not reached */
    double rise;                      /* after the first minimum, in radii */
} fall;

static fall drop(const char *key, const char *value, int steps)
{
    rheo_scene scene;
    OK(rheo_scene_builtin("bowling-ball-small", &scene, &error));
    if (key)
        OK(rheo_world_def_set(&scene.world, key, value, &error));
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    double surface = ball.position[1] - ball.radius - scene.clearance, contact = -1, before = -INFINITY, dip = -1;
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
    fall none = drop("history.stiffness", "0", 150), small = drop("history.window", "50", 820), usual = drop(NULL, NULL, 820);
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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_ball_is_carried_and_later_sinks)};
    return cmocka_run_group_tests_name("phenomena", tests, NULL, NULL);
}
