/* `rheolog table` from outside. */
#define _POSIX_C_SOURCE 200809L /* strdup(), strndup() */
#include "cli_support.h"

/* A recording of these many steps. */
static void record_steps(const char *name, int steps, const char *settings)
{
    assert_code(0, run("run %s --steps %d %s -o %s --force --quiet --json", scene, steps, settings, name));
}

/* The step of the scene is 0.033, so step 8 is at 0.264, and the step nearest to 0.1 is 3, at 0.099. */
static void a_row_has_the_differing_settings_and_the_metrics_of_the_last_step(void **state)
{
    (void)state;
    record_steps("a.rlog", 8, "--set history.order=0.25 --set springs.plasticity=2");
    record_steps("b.rlog", 5, "--set history.order=0.5 --set springs.plasticity=3");
    assert_code(0, run("table a.rlog b.rlog --metrics step,time"));
    assert_string_equal(out, "file,outcome,steps,springs.plasticity,history.order,step,time\n"
                             "a.rlog,complete,8,2,0.25,8,0.264\n"
                             "b.rlog,complete,5,3,0.5,5,0.165\n");
    assert_string_equal(err, "");
    assert_code(0, run("table b.rlog --metrics time,step")); /* nothing differs; the order is that of the list */
    assert_string_equal(out, "file,outcome,steps,time,step\nb.rlog,complete,5,0.165,5\n");
}

static void the_length_of_a_step_is_told_from_its_number(void **state)
{
    (void)state;
    record_steps("a.rlog", 4, "--set step=0.025");
    record_steps("b.rlog", 2, "");
    assert_code(0, run("table a.rlog b.rlog --metrics step,time"));
    assert_string_equal(out, "file,outcome,steps,set.step,step,time\n"
                             "a.rlog,complete,4,0.025,4,0.1\n"
                             "b.rlog,complete,2,0.033,2,0.066\n");
}

static void settings_are_chosen(void **state)
{
    (void)state;
    record_steps("a.rlog", 1, "--set history.order=0.25");
    record_steps("b.rlog", 1, "--set history.order=0.75");
    assert_code(0, run("table a.rlog b.rlog --metrics step --set-columns none"));
    assert_string_equal(out, "file,outcome,steps,step\na.rlog,complete,1,1\nb.rlog,complete,1,1\n");
    assert_code(0,
                run("table a.rlog b.rlog --metrics step --set-columns history.window,history.order,history.window"));
    assert_string_equal(out, "file,outcome,steps,history.window,history.order,step\n"
                             "a.rlog,complete,1,6,0.25,1\nb.rlog,complete,1,6,0.75,1\n");
    /* 150 is the default of history.window, and 0.5 that of history.order. */
    assert_code(0, run("table a.rlog b.rlog --metrics step --set-columns changed"));
    char *header = strndup(out, strcspn(out, "\n"));
    assert_in(",history.window,", header);
    assert_in(",history.order,", header);
    assert_in(",scene,", header);
    assert_null(strstr(header, "springs.stiffness"));
    free(header);
}

/* What only makes scenes is in the scene that the recording stores. */
static void the_seed_is_a_setting(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    record_steps("a.rlog", 1, "--set seed=3");
    record_steps("b.rlog", 1, "--set seed=4");
    assert_code(0, run("table a.rlog b.rlog --metrics step"));
    assert_string_equal(out, "file,outcome,steps,seed,step\na.rlog,complete,1,3,1\nb.rlog,complete,1,4,1\n");
}

/* With --from, --set are commands before the first step. A command later is none of the settings. */
static void commands_before_the_first_step_are_settings(void **state)
{
    (void)state;
    record("base.rlog");
    assert_code(0, run("run --from base.rlog --set history.stiffness=2 --steps 3 -o a.rlog --force --quiet"));
    assert_code(0, run("run --from base.rlog --set history.stiffness=7 --steps 3 -o b.rlog --force --quiet"));
    assert_code(0, run("table a.rlog b.rlog --metrics step"));
    assert_string_equal(out, "file,outcome,steps,history.stiffness,step\n"
                             "a.rlog,complete,3,2,11\nb.rlog,complete,3,7,11\n");
    /* The seed is not known. */
    assert_code(0, run("table a.rlog b.rlog --metrics step --set-columns seed"));
    assert_string_equal(out, "file,outcome,steps,seed,step\na.rlog,complete,3,,11\nb.rlog,complete,3,,11\n");
}

static void events_choose_the_step(void **state)
{
    (void)state;
    record_steps("a.rlog", 8, "");
    record_steps("b.rlog", 5, "");
    static const struct {
        const char *event, *of_a, *of_b;
    } cases[] = {
        {"end", "8,0.264", "5,0.165"},
        {"step 6", "6,0.198", ","},
        {"step 0", "0,0", "0,0"},
        {"time 0.1", "3,0.099", "3,0.099"},
        {"time 0.25", "8,0.264", ","}, /* 0.2475 is in the middle of steps 7 and 8; b ends at 0.165 */
        {"time 0.2474", "7,0.231", ","},
        {"time 0.2476", "8,0.264", ","},
        {"time 0.28", "8,0.264", ","}, /* half a step behind the end is 0.2805 */
        {"time 0.281", ",", ","},
        {"time 0", "0,0", "0,0"},
        {"step > 2", "3,0.099", "3,0.099"},
        {"time >= 0.19", "6,0.198", ","},
        {"step > 2 and not time < 0.15", "5,0.165", "5,0.165"},
        {"any particle: speed >= 0", "0,0", "0,0"},
        {"step > 8", ",", ","},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char expected[256];
        snprintf(expected, sizeof expected,
                 "file,outcome,steps,step,time\na.rlog,complete,8,%s\nb.rlog,complete,5,%s\n", cases[i].of_a,
                 cases[i].of_b);
        assert_code(0, run("table a.rlog b.rlog --metrics step,time --at '%s'", cases[i].event));
        assert_string_equal(out, expected);
    }
}

/* A table is what `metrics` prints of these steps. */
static void metrics_are_those_that_are_recorded(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("metrics a.rlog"));
    char *metrics = strdup(out), *header = strtok(metrics, "\n"), *row = strtok(NULL, "\n");
    for (int step = 0; step < 6; step++)
        row = strtok(NULL, "\n");
    char expected[8192];
    snprintf(expected, sizeof expected, "file,outcome,steps,%s\na.rlog,complete,8,%s\n", header, row);
    assert_code(0, run("table a.rlog --at 'step 6'"));
    assert_string_equal(out, expected);
    free(metrics);
}

static void several_events_have_their_columns(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("table a.rlog --metrics step,time --at 'step 2' --at 'step > 100' --at end"));
    assert_string_equal(
        out, "file,outcome,steps,step@step 2,time@step 2,step@step > 100,time@step > 100,step@end,time@end\n"
             "a.rlog,complete,8,2,0.066,,,8,0.264\n");
}

static void json_has_its_keys(void **state)
{
    (void)state;
    record_steps("a.rlog", 8, "--set history.order=0.25");
    record_steps("b.rlog", 5, "--set history.order=0.75");
    assert_code(0, run("table a.rlog b.rlog --metrics step,time --at end --at 'step 6' --json"));
    assert_string_equal(
        out,
        "{\"file\": \"a.rlog\", \"outcome\": \"complete\", \"steps\": 8, \"settings\": {\"history.order\": 0.25}, "
        "\"at\": [{\"event\": \"end\", \"step\": 8, \"metrics\": {\"step\": 8, \"time\": 0.264}}, "
        "{\"event\": \"step 6\", \"step\": 6, \"metrics\": {\"step\": 6, \"time\": 0.198}}], \"reason\": null}\n"
        "{\"file\": \"b.rlog\", \"outcome\": \"complete\", \"steps\": 5, \"settings\": {\"history.order\": 0.75}, "
        "\"at\": [{\"event\": \"end\", \"step\": 5, \"metrics\": {\"step\": 5, \"time\": 0.165}}, "
        "{\"event\": \"step 6\", \"step\": null, \"metrics\": {\"step\": null, \"time\": null}}], \"reason\": null}\n");
}

/* ---- Recordings that are not whole ---- */

static void torn_and_unreadable_files_are_told(void **state)
{
    (void)state;
    record("a.rlog");
    size_t size;
    char *bytes = read_bytes("a.rlog", &size);
    write_file("torn.rlog", bytes, size - 5);
    write_file("stub.rlog", bytes, 100);
    assert_code(2, run("table a.rlog torn.rlog stub.rlog none.rlog --metrics step"));
    assert_string_equal(out, "file,outcome,steps,step\n"
                             "a.rlog,complete,8,8\n"
                             "torn.rlog,truncated,8,8\n"
                             "stub.rlog,unreadable,,\n"
                             "none.rlog,unreadable,,\n");
    assert_in("torn.rlog is truncated after step 8", err);
    assert_in("stub.rlog", err);
    assert_in("cannot read none.rlog", err);
    assert_code(2, run("table none.rlog --json"));
    assert_string_equal(out,
                        "{\"file\": \"none.rlog\", \"outcome\": \"unreadable\", \"steps\": null, \"settings\": {}, "
                        "\"at\": [{\"event\": \"end\", \"step\": null, \"metrics\": {}}], "
                        "\"reason\": \"cannot read none.rlog: No such file or directory\"}\n");
}

static void a_failed_run_is_a_result(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("info a.rlog --json"));
    if (strcmp(value_of("real_bytes"), "4") != 0)
        skip(); /* no parameter value is large enough to overflow doubles */
    assert_code(1, run("run %s --steps 50 --set step=1e5 --set fluid.stiffness=1e29 -o failed.rlog --quiet", scene));
    assert_code(0, run("table failed.rlog --metrics step"));
    assert_in("\nfailed.rlog,failed,", out);
}

/* Metrics are read: a step that does not repeat matters only to a condition that needs its state. */
static void nothing_is_simulated_for_metrics(void **state)
{
    (void)state;
    record("a.rlog");
    falsify_step("a.rlog", "other.rlog", 5);
    assert_code(0, run("table other.rlog --metrics step --at 'step > 5' --at 'time 0.2' --at end"));
    assert_in("\nother.rlog,complete,8,6,6,8\n", out);
    assert_code(1, run("table other.rlog a.rlog --metrics step --at 'any particle: speed > 1e9' --at end"));
    assert_in("\nother.rlog,complete,8,,8\na.rlog,complete,8,,8\n", out);
    assert_in("step 5", err);
}

/* ---- Usage and files ---- */

static void bad_usage_is_refused(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(2, run("table"));
    assert_one_message("at least one recording");
    assert_code(2, run("table a.rlog --metrics stepp"));
    assert_one_message("no metric \"stepp\"; did you mean \"step\"?");
    assert_code(2, run("table a.rlog --set-columns history.ordr"));
    assert_one_message("no parameter \"history.ordr\"; did you mean \"history.order\"?");
    assert_code(2, run("table a.rlog --metrics step,"));
    assert_one_message("no metric \"\"");
    assert_code(2, run("table a.rlog --at ''"));
    assert_one_message("end, step N, time T or a condition");
    assert_code(2, run("table a.rlog a.rlog --at 'stepp > 3'"));
    assert_one_message("no metric \"stepp\"");
    assert_code(2, run("table a.rlog --at 'step x'"));
    assert_one_message("a.rlog: ");
    assert_code(2, run("table a.rlog --force"));
    assert_one_message("--force goes with -o");
}

static void a_table_replaces_no_recording(void **state)
{
    (void)state;
    record("a.rlog");
    record("b.rlog");
    size_t size;
    const char *read = read_bytes("a.rlog", &size);
    char *bytes = malloc(size);
    assert_non_null(bytes);
    memcpy(bytes, read, size);
    assert_code(2, run("table -o a.rlog b.rlog --force"));
    assert_one_message("a table is no recording");
    assert_int_equal(rename("a.rlog", "a"), 0);
    assert_code(2, run("table a b.rlog -o a --force"));
    assert_one_message("cannot be written by -o too");
    size_t after;
    read = read_bytes("a", &after);
    assert_int_equal(after, size);
    assert_memory_equal(read, bytes, size);
    free(bytes);
}

static void a_file_has_the_bytes_of_standard_output(void **state)
{
    (void)state;
    remove("t.csv");
    record("a.rlog");
    assert_code(0, run("table a.rlog"));
    char *table = strdup(out), file[1 << 14];
    assert_code(0, run("table a.rlog -o t.csv"));
    assert_string_equal(out, "");
    read_file("t.csv", file, sizeof file);
    assert_string_equal(file, table);
    assert_code(2, run("table a.rlog -o t.csv --metrics step"));
    assert_one_message("t.csv exists; give --force");
    assert_code(0, run("table a.rlog -o t.csv --metrics step --force"));
    read_file("t.csv", file, sizeof file);
    assert_string_equal(file, "file,outcome,steps,step\na.rlog,complete,8,8\n");
    assert_code(2, run("table a.rlog -o none/t.csv"));
    assert_one_message("there is no folder none");
    free(table);
}

static void names_with_commas_are_quoted(void **state)
{
    (void)state;
    record("a.rlog");
    assert_int_equal(rename("a.rlog", "x=1,\"y\".rlog"), 0);
    assert_code(0, run("table 'x=1,\"y\".rlog' --metrics step"));
    assert_string_equal(out, "file,outcome,steps,step\n\"x=1,\"\"y\"\".rlog\",complete,8,8\n");
}

/* Recordings of two models: a column is empty where a recording does not have it. */
static void models_are_mixed(void **state)
{
    (void)state;
    record_steps("a.rlog", 2, "--set history.order=0.25");
    record_steps("b.rlog", 2, "--set history.order=0.75");
    record_melting("m.rlog", "--steps 1");
    assert_code(0, run("table a.rlog m.rlog b.rlog --metrics step,springs,heat --set-columns history.order"));
    const char *row = strstr(out, "\nm.rlog,complete,1,,1,,");
    assert_non_null(row);
    assert_true(row[strlen("\nm.rlog,complete,1,,1,,")] != '\n'); /* it has heat */
    assert_in("\na.rlog,complete,2,0.25,2,", out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_row_has_the_differing_settings_and_the_metrics_of_the_last_step),
        cmocka_unit_test(the_length_of_a_step_is_told_from_its_number),
        cmocka_unit_test(settings_are_chosen),
        cmocka_unit_test(the_seed_is_a_setting),
        cmocka_unit_test(commands_before_the_first_step_are_settings),
        cmocka_unit_test(events_choose_the_step),
        cmocka_unit_test(metrics_are_those_that_are_recorded),
        cmocka_unit_test(several_events_have_their_columns),
        cmocka_unit_test(json_has_its_keys),
        cmocka_unit_test(torn_and_unreadable_files_are_told),
        cmocka_unit_test(a_failed_run_is_a_result),
        cmocka_unit_test(nothing_is_simulated_for_metrics),
        cmocka_unit_test(bad_usage_is_refused),
        cmocka_unit_test(a_table_replaces_no_recording),
        cmocka_unit_test(a_file_has_the_bytes_of_standard_output),
        cmocka_unit_test(names_with_commas_are_quoted),
        cmocka_unit_test(models_are_mixed),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
