/* `rheolog check` from outside, and the same warnings of `rheolog run`. */
#include "cli_support.h"

static const char *const keys[] = {"scene", "verdict", "particles", "why", "warnings", NULL};

static void a_good_scene_has_nothing_to_warn_of(void **state)
{
    (void)state;
    assert_code(0, run("check bowling-ball-small"));
    assert_string_equal(out, "bowling-ball-small: 5760 particles, nothing to warn of\n");
    assert_string_equal(err, "");
    assert_code(0, run("check bowling-ball-small --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"good\"");
    assert_string_equal(value_of("particles"), "5760");
    assert_in("\"why\": null, \"warnings\": []", out);
}

/* melt.json is soft on purpose: its own weight compresses it by 3.6 %. */
static void scenes_of_golden_recordings_have_no_warnings(void **state)
{
    (void)state;
    static const char *const names[] = {"ball",       "floor",   "force",      "frozen",       "full",
                                        "incline",    "melt",    "no-history", "melt-printed", "melt-summation",
                                        "sequential", "spheres", "tempered",   "window-fast"};
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
    assert_in("\"shape\": null, \"other_shape\": null, \"wall\": 1, \"count\": 0, \"value\": 54, \"limit\": 48}",
              out);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_good_scene_has_nothing_to_warn_of),
        cmocka_unit_test(scenes_of_golden_recordings_have_no_warnings),
        cmocka_unit_test(warnings_have_an_exit_code_of_their_own),
        cmocka_unit_test(a_refused_scene_is_bad_input),
        cmocka_unit_test(run_gives_the_same_warnings_even_if_quiet),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
