/* `rheolog when` from outside. */
#include "cli_support.h"

static void when_has_its_keys(void **state)
{
    (void)state;
    static const char *const keys[] = {
        "step",        "stage",     "item",    "id",   "other_id",     "quantity",    "value",
        "file",        "condition", "outcome", "hits", "first_looked", "last_looked", "steps_simulated",
        "states_read", "reason",    NULL};
    record("a.rlog");
    assert_code(0, run("when a.rlog 'any particle: speed >= 0' --after 2 --before 5 --all --json"));
    assert_keys(out, keys);
    assert_string_equal(err, "");
    const char *const begin = "{\"step\": 3, \"stage\": null, \"item\": \"particle\", \"id\": ";
    assert_memory_equal(out, begin, strlen(begin));
    assert_in("\n{\"step\": 4, \"stage\": null, \"item\": \"particle\", ", out);
    assert_in(
        "\n{\"file\": \"a.rlog\", \"condition\": \"any particle: speed >= 0\", \"outcome\": \"found\", \"hits\": 2, "
        "\"first_looked\": 3, \"last_looked\": 4, \"steps_simulated\": 4, \"states_read\": 1, \"reason\": null}\n",
        out);
    assert_code(0, run("when a.rlog 'any particle: speed >= 0' --stage gravity@1 --last --json"));
    assert_in("{\"step\": 8, \"stage\": \"gravity@1\", \"item\": \"particle\", ", out);
    assert_code(1, run("when a.rlog 'step > 1000' --json"));
    assert_in("{\"step\": null}\n{\"file\": \"a.rlog\", ", out);
    assert_in("\"outcome\": \"none\", \"hits\": 0, ", out);
    assert_code(2, run("when a.rlog 'stepp > 1000' --json"));
    assert_in(
        "\"outcome\": \"refused\", \"hits\": 0, \"first_looked\": null, \"last_looked\": null, \"steps_simulated\": 0, \"states_read\": 1, \"reason\": \"a.rlog: the "
        "recording has no metric \\\"stepp\\\"; did you mean \\\"step\\\"",
        out);
}

static void the_text_names_step_and_value(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("when a.rlog 'step >= 5'"));
    assert_string_equal(out, "step 5: step is 5\n");
    assert_code(0, run("when a.rlog 'step <= 5' --last"));
    assert_string_equal(out, "step 5: step is 5\n");
    assert_code(0, run("when a.rlog 'step > 3 and step < 6' --all"));
    assert_string_equal(out, "step 4: step is 4\nstep 5: step is 5\n");
    assert_code(0, run("when a.rlog 'particle 4 exists'"));
    assert_string_equal(out, "step 0: particle 4 exists\n");
    assert_code(1, run("when a.rlog 'ball: y < -1000' --after 3"));
    assert_string_equal(out, "a.rlog: does not hold in steps 4 to 8\n");
    assert_code(0, run("when a.rlog 'any particle: speed >= 0' --stage gravity --after 7"));
    assert_in("step 8, after gravity@1: particle ", out);
}

/* inspect shows the value that was found. */
static void what_is_found_is_what_inspect_shows(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("inspect a.rlog --step 6 --top 1 --json"));
    char speed[40];
    const char *fastest = strstr(out, "\"fastest\": [");
    assert_non_null(fastest);
    const char *at = strstr(fastest, "\"speed\": ");
    assert_non_null(at);
    snprintf(speed, sizeof speed, "%.*s", (int)strcspn(at + 9, "}"), at + 9);
    assert_code(0, run("when a.rlog 'any particle: speed > 0' --after 5 --before 7 --json"));
    assert_string_equal(value_of("value"), speed);
}

static void bad_usage_is_refused(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(2, run("when a.rlog"));
    assert_one_message("a condition in quotes");
    assert_code(2, run("when a.rlog ball: y"));
    assert_one_message("put the condition in quotes");
    assert_code(2, run("when a.rlog 'step > 3' --first --last"));
    assert_one_message("one of --first, --last and --all");
    assert_code(2, run("when a.rlog 'step > 3' --stage gravity"));
    assert_one_message("belongs to the end of a step");
    assert_code(2, run("when a.rlog 'step > 3' --after 8"));
    assert_one_message("no step to look at");
    assert_code(2, run("when none.rlog 'step > 3'"));
    assert_one_message("none.rlog");
}

/* A damaged step is named; what was found before it is printed. */
static void a_step_that_does_not_repeat_ends_the_search(void **state)
{
    (void)state;
    record("a.rlog");
    falsify_step("a.rlog", "other.rlog", 5);
    assert_code(0, run("when other.rlog 'any particle: speed >= 0' --before 5"));
    assert_code(1, run("when other.rlog 'any particle: speed >= 0' --all"));
    assert_in("step 4: particle ", out);
    assert_null(strstr(out, "step 5"));
    assert_in("step 5", err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(when_has_its_keys),
        cmocka_unit_test(the_text_names_step_and_value),
        cmocka_unit_test(what_is_found_is_what_inspect_shows),
        cmocka_unit_test(bad_usage_is_refused),
        cmocka_unit_test(a_step_that_does_not_repeat_ends_the_search),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
