/* Hard cases of the thickening model through the program: what users see, with exit codes. */
#include "cli_support.h"

static const char SMALL[] = "bowling-ball-small --set particles=800 --set settle.time=0.3 --steps 40 --quiet";

/* The run ends, the warning came first, and the last line says that it was not healthy. */
static void a_fast_impact_runs_with_a_warning(void **state)
{
    (void)state;
    assert_code(0, run("run %s --set 'ball.velocity=[0,-1700,0]'", SMALL));
    assert_in("steps       40", out);
    assert_in("warning: ball_speed (how far the ball moves in a step, in supports) is 14", err);
    assert_in("unhealthy since step 1", err);
}

/* Scheme sequential, as printed by the paper, stops: with the step, the stage, the particle, and what helps. */
static void a_run_that_goes_bad_stops_and_says_where(void **state)
{
    (void)state;
    assert_code(1, run("run %s --set scheme=sequential --set 'ball.velocity=[0,-170,0]' -o bad.rlog", SMALL));
    assert_in("went bad: after stage spring_displacement position of particle ", err);
    assert_in("the world stays at step ", err);
    assert_in("A smaller step may help, or softer springs, or springs.solver implicit", err);
    assert_code(1, run("doctor bad.rlog")); /* the recording is whole up to there */
    assert_in("spring_displacement", out);
    assert_code(
        0,
        run("run %s --set scheme=sequential --set 'ball.velocity=[0,-170,0]' --set springs.solver=implicit", SMALL));
}

/* What cannot be computed is refused before the first step, with what would be right. */
static void impossible_scenes_are_refused(void **state)
{
    (void)state;
    static const char *const CASES[][2] = {
        {"history.window='1e-9 s'",
         "history.window is 1e-09 s, 3.0303e-08 steps of 0.033; it must be from 1 to 1000000 steps"},
        {"step=1e-12", "settling has at most a million"},
        {"fluid.number_density=1e-300", "the ball has the mass of"},
        {"fluid.support=1e-12", "the ball has the mass of"},
        {"step=0", "step"},
    };
    for (size_t k = 0; k < sizeof CASES / sizeof *CASES; k++) {
        assert_code(2, run("run %s --set %s -o none.rlog", SMALL, CASES[k][0]));
        assert_one_message(CASES[k][1]);
        assert_int_equal(file_size("none.rlog"), -1);
    }
}

/* Two blocks in the same place: all particles coincide in pairs. */
static void coinciding_particles_run_with_a_warning(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    const char text[] =
        "{\"steps\": 30, \"gravity\": [0, 0, 0], \"fluid\": {\"shapes\": [{\"block\": {\"max\": [6, 6, 6], \"min\": "
        "[0, 0, 0]}}, {\"block\": {\"max\": [6, 6, 6], \"min\": [0, 0, 0]}}]}}";
    write_file("coin.json", text, sizeof text - 1);
    assert_code(1, run("check coin.json"));
    assert_in("27 pairs of particles are closer than half the spacing, the nearest at 0; they will be thrown apart",
              out);
    assert_code(0, run("run coin.json --quiet -o coin.rlog"));
    assert_in("they will be thrown apart", err);
    assert_code(0, run("verify coin.rlog"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fast_impact_runs_with_a_warning),
        cmocka_unit_test(a_run_that_goes_bad_stops_and_says_where),
        cmocka_unit_test(impossible_scenes_are_refused),
        cmocka_unit_test(coinciding_particles_run_with_a_warning),
    };
    return cmocka_run_group_tests_name("cli_hard", tests, set_up, tear_down);
}
