/*
 * `rheolog bench predictor` from outside, in a few scenes of its default seeds; and numbers that `rheolog check` expects,
 * compared with those of runs.
 */
#include "cli_support.h"

#include <sys/stat.h>

/* The value of a column in the first line after the header of a CSV text. */
static void column(const char *text, const char *name, char value[128])
{
    const char *head = text, *row = strchr(text, '\n');
    assert_non_null(row);
    for (row++; *head != '\n';) {
        size_t name_length = strcspn(head, ",\n"), length = 0;
        bool quoted = false;
        while (row[length] && row[length] != '\n' && (quoted || row[length] != ','))
            quoted ^= row[length++] == '"';
        if (strlen(name) == name_length && strncmp(head, name, name_length) == 0) {
            snprintf(value, 128, "%.*s", (int)length, row);
            return;
        }
        head += name_length + (head[name_length] == ',');
        row += length + (row[length] == ',');
    }
    fail_msg("no column %s in: %s", name, text);
}

static void verdict(int seed, const char *blew_up, const char *reason)
{
    char value[128];
    assert_code(0, run("bench predictor --quiet --csv --count 1 --seed %d", seed));
    column(out, "blew_up", value);
    assert_string_equal(value, blew_up);
    column(out, "reason", value);
    assert_string_equal(value, reason);
}

/* Of each group one that stays well, and some that blow up, each for another reason. */
static void scenes_have_the_verdicts_of_their_seeds(void **state)
{
    (void)state;
    static const struct {
        int seed;
        const char *blew_up, *reason;
    } cases[] = {
        {250, "no", ""},        {178, "yes", "speed"}, {245, "no", ""},        {278, "yes", "energy"},
        {161, "yes", "failed"}, {75, "no", ""},        {102, "yes", "energy"}, {162, "yes", "temperature"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        verdict(cases[i].seed, cases[i].blew_up, cases[i].reason);
}

static void the_same_seeds_give_the_same_scenes_and_verdicts(void **state)
{
    (void)state;
    static char first[sizeof out];
    assert_code(0, run("bench predictor --quiet --csv --count 3 --seed 161"));
    snprintf(first, sizeof first, "%s", out);
    assert_code(0, run("bench predictor --quiet --csv --count 3 --seed 161 --simd scalar"));
    assert_string_equal(first, out);
    assert_code(0, run("bench predictor --quiet --csv --count 3 --seed 164"));
    assert_string_not_equal(first, out);
}

/* The number in one JSON object. */
static double number(const char *key)
{
    const char *text = value_of(key);
    assert_non_null(text);
    return strtod(text, NULL);
}

/*
 * The size of a recording is expected within a factor of 2, and the mean number of substeps within 1.5; the doctor's
 * numbers of the first step are those that were expected.
 */
static void runs_are_as_check_expects(void **state)
{
    (void)state;
    static const struct {
        const char *scene;
        int steps;
    } cases[] = {{"bowling-ball-small --set settle.time=0.5", 40},
                 {"bowling-ball-small --set scheme=sequential --set settle.time=0.5", 30},
                 {"bowling-ball-small --set history.window=10 --set settle.time=0.5", 70},
                 {"bowling-ball-small --set settle.time=0", 40},
                 {"bowling-ball-small --set history.kind=full --set settle.time=0", 10},
                 {"melting-box --set fluid.spacing=0.1", 30}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_not_equal(2, run("check %s --set steps=%d --json", cases[i].scene, cases[i].steps));
        const double bytes = number("bytes_recording"), substeps = number("substeps_probe"),
                     seconds = number("seconds");
        assert_true(bytes > 0 && seconds > 0);
        assert_code(
            0, run("run %s --steps %d -o predictor.rlog --force --quiet --json", cases[i].scene, cases[i].steps));
        const double made = number("bytes"), mean = number("substeps") / cases[i].steps;
        if (!(bytes < 2 * made && made < 2 * bytes))
            fail_msg("%s: expected %g bytes, made %g", cases[i].scene, bytes, made);
        if (substeps == substeps && mean > 0 && !(substeps < 1.5 * mean && mean < 1.5 * substeps))
            fail_msg("%s: expected %g substeps, made %g", cases[i].scene, substeps, mean);
    }
    remove("predictor.rlog");
}

static void usage_is_checked(void **state)
{
    (void)state;
    assert_code(2, run("bench predictor --scenes none"));
    assert_code(2, run("bench predictor --count 0"));
    assert_code(2, run("bench predictor --baseline x"));
    assert_code(2, run("bench table1 --seed 1"));
    assert_code(2, run("bench table1 -o folder"));
}

/* Before anything is computed: nothing is printed. */
static void files_that_cannot_be_written_are_found_before_the_runs(void **state)
{
    (void)state;
    mkdir("predictor_taken", 0777);
    mkdir("predictor_taken/predictor.svg", 0777);
    assert_code(2, run("bench predictor --count 1 --csv --quiet -o predictor_taken"));
    assert_one_message("predictor_taken/predictor.svg exists and leads to no regular file");
    remove("predictor_taken/predictor.svg");
    remove("predictor_taken");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_have_the_verdicts_of_their_seeds),
        cmocka_unit_test(the_same_seeds_give_the_same_scenes_and_verdicts),
        cmocka_unit_test(runs_are_as_check_expects),
        cmocka_unit_test(usage_is_checked),
        cmocka_unit_test(files_that_cannot_be_written_are_found_before_the_runs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
