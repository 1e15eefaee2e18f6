/* `rheolog check` from outside, and the same warnings of `rheolog run`. */
#include "cli_support.h"

#include <sys/wait.h>

static const char *const keys[] = {"scene", "verdict", "particles", "why", "warnings", "preflight", NULL};

static void a_good_scene_has_nothing_to_warn_of(void **state)
{
    (void)state;
    assert_code(0, run("check bowling-ball-small"));
    assert_in("bowling-ball-small: 5760 particles, nothing to warn of\nexpected of a run:\n", out);
    assert_in("  kappa              0.00408 at rest, 0.0549 when the ball arrives\n", out);
    assert_in("  k substep^2/h      0.0204, limit 0.06\n", out);
    assert_in("  k_near substep^2/h 0.034, limit 0.1\n", out);
    assert_in("  substeps           2 in the beginning, 3 when the ball arrives, ", out);
    assert_in("  memory of history  150 steps, 4.95 T\n", out);
    assert_in("  computing          ", out);
    assert_string_equal(err, "");
    assert_code(0, run("check bowling-ball-small --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"good\"");
    assert_string_equal(value_of("particles"), "5760");
    assert_in("\"why\": null, \"warnings\": []", out);
}

static void a_parameter_without_effect_is_named(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"positions.iterations=6", "positions.iterations is 6, without effect: only scheme positions has it"},
        {"springs.solver=implicit", "springs.solver is implicit, without effect: only scheme sequential has it"},
        {"ball.push_duty=0.2 --set ball.radius=0", "ball.push_duty is 0.2, without effect: there is no ball"},
        {"plates.stress=4", "plates.stress is 4, without effect: plates.control is velocity; set it to stress"},
        {"plates.control=stress --set plates.amplitude=1",
         "plates.amplitude is 1, without effect: plates.control is stress; set it to velocity"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_code(1, run("check bowling-ball-small --json --set %s", cases[i][0]));
        assert_in(cases[i][1], out);
    }
    assert_code(0, run("check bowling-ball-small --set scheme=sequential --set springs.solver=implicit"));
    assert_null(strstr(out, "without effect"));
}

/* melt.json is soft on purpose: its own weight compresses it by 3.6 %. */
static void scenes_of_golden_recordings_have_no_warnings(void **state)
{
    (void)state;
    static const char *const names[] = {"ball",           "floor",     "force",      "frozen",     "full",
                                        "incline",        "lag",       "melt",       "no-history", "melt-printed",
                                        "melt-summation", "positions", "sequential", "spheres",    "tempered",
                                        "window-fast"};
    const char *folder = getenv("SCENES");
    assert_non_null(folder);
    if (!json_scenes)
        skip();
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const bool soft = strcmp(names[i], "melt") == 0;
        const int code = run("check %s/%s.json", folder, names[i]);
        if (code != soft)
            fail_msg("%s: exit code %d: %s", names[i], code, out);
        if (soft)
            assert_in("melting.sound_speed is too small", out);
    }
}

static void warnings_have_an_exit_code_of_their_own(void **state)
{
    (void)state;
    assert_code(1, run("check bowling-ball-small --set ball.radius=27"));
    assert_in("warning: the ball does not fit between walls 1 and 2: they are 48 apart", out);
    assert_string_equal(err, "");
    assert_code(1, run("check bowling-ball-small --set ball.radius=27 --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"warnings\"");
    assert_in("{\"kind\": \"ball-too-large\", \"refused\": false, \"text\": \"the ball does not fit", out);
    assert_in(
        "\"shape\": null, \"other_shape\": null, \"wall\": 1, \"obstacle\": null, \"count\": 0, \"value\": 54, \"limit\": 48}",
        out);
}

/* Regression: a radius in another unit was not noticed, and the ball fell between the particles. */
static void a_ball_smaller_than_the_distance_of_particles_is_told(void **state)
{
    (void)state;
    assert_code(0, run("check bowling-ball-small --set ball.radius=1.01")); /* particles are 2 apart */
    assert_code(1, run("check bowling-ball-small --set ball.radius=0.99"));
    assert_in("warning: the ball falls between the particles: ball.radius is 0.99, and they are 2 apart", out);
    assert_code(1, run("check bowling-ball-small --set ball.radius=0.99 --json"));
    assert_in("{\"kind\": \"ball-too-small\", \"refused\": false, ", out);
    assert_in("\"value\": 1.98, \"limit\": 2}", out);
}

/* Regression: a ball that became too fast in its fall was not told, only one that begins so. */
static void a_ball_that_arrives_too_fast_is_told(void **state)
{
    (void)state;
    assert_code(1, run("check bowling-ball-small --set ball.clearance=4000"));
    assert_in("warning: ball_speed (how far the ball moves in a step, in supports) is 2.31, more than 1", out);
    assert_in("arrives with 280 L/T, 2.31 supports a step", out);
    assert_code(0, run("check bowling-ball-small --set ball.clearance=180")); /* 0.49 */
}

static void a_refused_scene_is_bad_input(void **state)
{
    (void)state;
    static const char behind[] = "bowling-ball-small --set \"ball.position=[24, -4, 24]\"";
    assert_code(2, run("check %s", behind));
    assert_in("refused: the ball, of radius 8", out);
    assert_code(2, run("check %s --json", behind));
    assert_string_equal(value_of("verdict"), "\"refused\"");
    assert_in("\"refused\": true", out);
    assert_code(2, run("run %s -o x.rlog", behind));
    assert_one_message("has its centre behind wall 0");
    assert_int_equal(file_size("x.rlog"), -1);
    /* One that cannot be examined says why. */
    assert_code(2, run("check bowling-ball-small --set settle.time=1e9 --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"refused\"");
    assert_string_equal(value_of("particles"), "null");
    assert_in("\"why\": \"settle.time is 1e+09", out);
    assert_code(2, run("check none.json --json"));
    assert_in("\"verdict\": \"refused\"", out);
    assert_in("none.json", err);
}

static void run_gives_the_same_warnings_even_if_quiet(void **state)
{
    (void)state;
    static const char scene_with[] = "bowling-ball-small --set settle.time=0 --set ball.radius=27";
    char first[4096];
    assert_code(1, run("check %s", scene_with));
    snprintf(first, sizeof first, "%.*s", (int)strcspn(out, "\n"), out);
    assert_code(0, run("run %s --steps 0 --quiet", scene_with));
    assert_in(first, err);
    assert_code(0, run("run bowling-ball-small --set settle.time=0 --steps 0 --quiet"));
    assert_string_equal(err, "");
}

/* It is said before anything is made, by `run` too; the kernel would end the program without a word. */
static void a_scene_that_does_not_fit_into_memory_is_refused(void **state)
{
    (void)state;
    static const char *const cases[] = {
        "check bowling-ball-small --set particles=1000000000",
        "run bowling-ball-small --set particles=1000000000 -o large.rlog",
        "run melting-bunny --set particles=1000000000 --steps 1",
        "run vibration --set history.window=1000000 --steps 100000000",
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_code(3, run("%s", cases[i]));
        assert_one_message(" of memory for ");
        assert_in(i < 2   ? "lower particles, or fluid.support"
                  : i < 3 ? "lower particles"
                          : "or history.window and history.lag",
                  err);
    }
    assert_null(fopen("large.rlog", "r"));
    /* The steps of the run count, not those of the scene. */
    assert_code(0, run("run bowling-ball-small --set settle.time=0 --set history.window=1000000 --steps 2 --quiet"));
    /* A limit of the process, unless the program needs more than that to begin, as with sanitizers. */
    char line[1024];
    snprintf(line, sizeof line, "ulimit -v 150000; '%s' --version >limit.txt 2>&1", getenv("RHEOLOG"));
    if (system(line) != 0)
        return;
    snprintf(line, sizeof line,
             "ulimit -v 150000; '%s' run bowling-ball-small --set particles=50000 --steps 1 2>limit.txt",
             getenv("RHEOLOG"));
    assert_int_equal(WEXITSTATUS(system(line)), 3);
    read_file("limit.txt", line, sizeof line);
    assert_in("; the limit of the process is 153.6 MB: ", line);
    assert_int_equal(strchr(line, '\n') - line, strlen(line) - 1);
}

/* Regression: check made the steps, saw the first go bad, and had nothing to warn of. */
static void a_probe_that_goes_bad_is_told(void **state)
{
    (void)state;
    if (sizeof(rheo_real) == 8) /* doubles hold these velocities */
        skip();
    static const char viscous[] = "melting-box --set particles=200 --set melting.viscosity=1e30";
    assert_code(1, run("check %s", viscous));
    assert_in("warning: a probe of ", out);
    assert_in("viscosity takes the velocities beyond the range of numbers", out);
    assert_null(strstr(out, "nothing to warn of"));
    assert_code(1, run("check %s --json", viscous));
    assert_in("\"verdict\": \"warnings\"", out);
    assert_in("\"probe_failed\": \"step 1 went bad: stage viscosity", out);
}

/* Regression: the advice was less jitter than 0. */
static void a_shape_far_away_is_not_advised_to_have_less_jitter(void **state)
{
    (void)state;
    if (!json_scenes || sizeof(rheo_real) == 8) /* doubles are exact enough there */
        skip();
    FILE *file = fopen("far.json", "w");
    assert_non_null(file);
    fputs("{\"model\": \"thickening\", \"gravity\": [0, 0, 0], \"fluid\": {\"shapes\": [{\"block\": "
          "{\"min\": [1e9, 0, 0], \"max\": [1000000032, 8, 8]}}]}}",
          file);
    fclose(file);
    assert_code(1, run("check far.json"));
    remove("far.json");
    assert_in("warning: particles of shape 0: ", out);
    assert_in("; move the scene to the origin, where", out);
    assert_null(strstr(out, "jitter"));
    assert_null(strstr(out, "fluid.rest_density"));
}

/* Regression: nothing was printed, so a reader of the JSON had no object to read. */
static void json_says_that_the_memory_does_not_do(void **state)
{
    (void)state;
    assert_code(3, run("check bowling-ball-small --set particles=1000000000 --json"));
    assert_in("{\"scene\": \"bowling-ball-small\", \"verdict\": \"failed\", \"particles\": null, \"why\": \"", out);
    assert_in(" of memory for ", out);
    assert_in("\"warnings\": [], \"preflight\": null}\n", out);
    assert_in(" of memory for ", err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_good_scene_has_nothing_to_warn_of),
        cmocka_unit_test(a_parameter_without_effect_is_named),
        cmocka_unit_test(scenes_of_golden_recordings_have_no_warnings),
        cmocka_unit_test(warnings_have_an_exit_code_of_their_own),
        cmocka_unit_test(a_ball_smaller_than_the_distance_of_particles_is_told),
        cmocka_unit_test(a_ball_that_arrives_too_fast_is_told),
        cmocka_unit_test(a_refused_scene_is_bad_input),
        cmocka_unit_test(run_gives_the_same_warnings_even_if_quiet),
        cmocka_unit_test(a_scene_that_does_not_fit_into_memory_is_refused),
        cmocka_unit_test(a_probe_that_goes_bad_is_told),
        cmocka_unit_test(a_shape_far_away_is_not_advised_to_have_less_jitter),
        cmocka_unit_test(json_says_that_the_memory_does_not_do),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
