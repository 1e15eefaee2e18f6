/* `rheolog same` and the verdict of `rheolog bless`, from outside. */
#include "cli_support.h"

/* A full recording of 20 steps. */
static void record_full(const char *path, const char *more)
{
    assert_code(0, run("run %s --steps 20 --full -o %s --force --quiet %s", scene, path, more));
}

/* Gravity larger by about 1 ulp, and by more than that, but by less than a million. */
#define ULP_MORE (sizeof(rheo_real) == 8 ? "-9.810000000000002" : "-9.810001")
#define SLIGHTLY_MORE (sizeof(rheo_real) == 8 ? "-9.810000001" : "-9.811")

static void each_rung_has_its_exit_code(void **state)
{
    (void)state;
    char gravity[64], slightly[64];
    snprintf(gravity, sizeof gravity, "--set 'gravity=[0, %s, 0]'", ULP_MORE);
    snprintf(slightly, sizeof slightly, "--set 'gravity=[0, %s, 0]'", SLIGHTLY_MORE);
    record_full("a.rlog", "");
    assert_code(0, run("same a.rlog --at-least bits"));
    assert_in("a.rlog: bits: 20 steps with the recorded hashes\n  bits        yes, 20 steps", out);
    assert_code(1, run("same a.rlog --at-least bits %s", gravity));
    assert_in("a.rlog: differs: only 0 steps with the recorded hashes\n  bits        no, 0 steps", out);
    assert_code(0, run("same a.rlog --at-least rounding %s", gravity));
    assert_in("a.rlog: rounding: 20 steps, each from the recorded state; at most ", out);
    assert_in("\n  rounding    yes, 20 of 20 steps; largest ratio ", out);
    assert_code(1, run("same a.rlog --at-least rounding --set 'gravity=[0, -9.9, 0]'"));
    assert_in("a.rlog: differs: it is not rounding: ", out);
    assert_in(" at step 1, whose first other hash is that of stage ", out);
    assert_code(1, run("same a.rlog --at-least rounding --limit 1 %s", slightly));
    assert_code(0, run("same a.rlog --at-least rounding --limit 1e6 %s", slightly));
    assert_string_equal(err, "");
}

static void the_verdict_has_its_keys(void **state)
{
    (void)state;
    static const char *const keys[] = {"file",
                                       "verdict",
                                       "at_least",
                                       "passed",
                                       "message",
                                       "bits",
                                       "tried",
                                       "steps",
                                       "rounding",
                                       "interval",
                                       "available",
                                       "compared",
                                       "decisions",
                                       "worst",
                                       "first",
                                       "field",
                                       "step",
                                       "stage",
                                       "ratio",
                                       "rms",
                                       "largest",
                                       "rms_yardstick",
                                       "largest_yardstick",
                                       "statistics",
                                       "stored",
                                       "members_recorded",
                                       "members",
                                       "values",
                                       "left_out",
                                       "rejected",
                                       "too_early",
                                       "went_bad",
                                       "metrics",
                                       "self_checks",
                                       "false_alarms",
                                       NULL};
    record_full("a.rlog", "");
    assert_code(0, run("same a.rlog --at-least rounding --json --set 'gravity=[0, %s, 0]'", ULP_MORE));
    assert_keys(out, keys);
    assert_in("{\"file\": \"a.rlog\", \"verdict\": \"rounding\", \"at_least\": \"rounding\", \"passed\": true, ",
              out);
    assert_in(
        "\"rounding\": {\"tried\": true, \"passed\": true, \"interval\": 1, \"available\": 20, \"compared\": 20, ",
        out);
    assert_in("\"step\": {\"tried\": false, \"passed\": false, ", out);
    assert_code(2, run("same none.rlog --json"));
    assert_in("{\"file\": \"none.rlog\", \"verdict\": \"unknown\", \"at_least\": \"statistics\", \"passed\": false, ",
              out);
    assert_code(2, run("same a.rlog --json --set gravitation=3"));
    assert_in("\"verdict\": \"unknown\"", out);
    assert_in("gravitation", err);
}

static void a_recording_without_states_is_told_so(void **state)
{
    (void)state;
    assert_code(0, run("run %s --steps 6 -o b.rlog --force --quiet", scene));
    assert_code(1, run("same b.rlog --at-least rounding --set 'gravity=[0, -9.9, 0]'"));
    assert_in("rounding was not tried, since the recording has no states near enough (--full has all)", out);
    assert_in("\n  rounding    not tried", out);
}

/* The same program has nothing to bless but the first time; what bless stores, info and log print. */
static void bless_reaches_what_is_asked_for(void **state)
{
    (void)state;
    record_full("old.rlog", "");
    record_full("new.rlog", "");
    remove("golden.rlog");
    assert_code(
        1, run("bless golden.rlog new.rlog --because first --at-least bits")); /* there is none to be the same as */
    assert_in("at least bits is asked for", err);
    assert_code(0, run("bless golden.rlog new.rlog --because first"));
    assert_code(0, run("info golden.rlog --json"));
    assert_in("\"verdict\": null, \"at_least\": null, \"same\": null", out);
    /* A longer recording of the same program has the same bits in the steps that both have. */
    assert_code(0, run("run %s --steps 25 --full -o longer.rlog --force --quiet", scene));
    assert_code(0, run("bless golden.rlog longer.rlog --because longer --at-least bits"));
    assert_in("bits: 20 steps with the recorded hashes", out);
    assert_code(0, run("info golden.rlog --json"));
    assert_in("\"verdict\": \"bits\", \"at_least\": \"bits\", \"same\": \"bits: 20 steps with the recorded hashes\"",
              out);
    assert_code(0, run("info golden.rlog"));
    assert_in("bits: 20 steps with the recorded hashes (down to bits tried)", out);
    assert_code(0, run("log golden.rlog"));
    assert_in("bits: 20 steps with the recorded hashes (down to bits tried)", out);
    /* Another scene is not another program. */
    record_full("other.rlog", "--set 'gravity=[0, -9.9, 0]'");
    assert_code(1, run("bless golden.rlog other.rlog --because other --shrink --at-least differs --quiet"));
    assert_in("not of the same run", err);
    assert_code(0, run("verify golden.rlog"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_rung_has_its_exit_code),
        cmocka_unit_test(the_verdict_has_its_keys),
        cmocka_unit_test(a_recording_without_states_is_told_so),
        cmocka_unit_test(bless_reaches_what_is_asked_for),
    };
    return cmocka_run_group_tests_name("cli_same", tests, set_up, tear_down);
}
