/* `rheolog experiments` from outside. The small versions of the experiments show what they must. */
#define _XOPEN_SOURCE 700 /* kill(), nanosleep() */
#include "cli_support.h"

#include <sys/stat.h>
#include <unistd.h>

static void all_claims_hold(void **state)
{
    (void)state;
    const char *every = getenv("RHEOLOG_TEST_EVERY"); /* set in all builds but one */
    const int code = run("experiments %s --small --quiet", every && atoi(every) > 1 ? "drop" : "");
    if (code != 0)
        print_message("%s\n%s\n", out, err);
    assert_int_equal(code, 0);
    assert_null(strstr(out, "FAILS"));
    assert_in("holds: ", out);
}

static void it_has_its_keys(void **state)
{
    (void)state;
    static const char *const keys[] = {"experiment", "reference", "small", "steps",    "seeds", "figures", "name",
                                       "outcome",    "reason",    "runs",  "finished", "unit",  "about",   "set",
                                       "variants",   "claims",    "text",  "holds",    NULL};
    assert_code(0, run("experiments drop --small --seeds 2 --json --quiet"));
    for (int i = 0; keys[i]; i++) {
        char key[32];
        snprintf(key, sizeof key, "\"%s\": ", keys[i]);
        assert_in(key, out);
    }
    assert_in("{\"experiment\": \"drop\", \"reference\": ", out);
    assert_in("\"seeds\": 2", out);
    assert_in("{\"name\": \"none\", \"set\": [\"history.stiffness=0\"], \"figures\": {\"lowest\": [", out);
    assert_in("], \"holds\": true}\n", out);
    assert_in("\"claims\": [{\"text\": \"rebound of d = 50 >= 0.5\", \"holds\": true}, {", out); /* the first one */
}

static void the_kernel_has_one_shape_at_every_smoothing_length(void **state)
{
    (void)state;
    assert_code(0, run("experiments kernel --quiet --set melting.smoothing_length=0.25"));
    assert_null(strstr(out, "FAILS"));
    assert_in("holds: W(1) of exact <= 26.01", out);
}

static void it_lists_them(void **state)
{
    (void)state;
    assert_code(0, run("experiments --list"));
    assert_in("bowling-ball", out);
    assert_in("Deegan 2010", out);
    assert_code(0, run("experiments --list --json"));
    assert_in("{\"experiment\": \"hole\", \"reference\": \"Deegan 2010\"", out);
}

static void it_writes_what_was_measured(void **state)
{
    (void)state;
    size_t size;
    assert_code(0, run("experiments drop --small --quiet -o drops"));
    const char *csv = read_bytes("drops/drop-small.csv", &size);
    const char begin[] = "variant,seed,step,time,height,way,front\n\"none\",1,0,0,";
    assert_memory_equal(csv, begin, strlen(begin));
    const char *svg = read_bytes("drops/drop-small.svg", &size);
    assert_memory_equal(svg, "<svg ", 5);
    /* Again, in place of the first files. */
    assert_code(0, run("experiments drop --small --quiet -o drops"));
}

/* Reads the neighbours of the first variant that was printed, of some seeds. */
static void read_neighbours(double *value, int seeds)
{
    const char *at = strstr(out, "\"neighbours\": [");
    assert_non_null(at);
    at += strlen("\"neighbours\": [");
    for (int i = 0; i < seeds; i++, at += strspn(at, ", ")) {
        const char *end;
        value[i] = rheo_text_number(at, &end);
        assert_true(end != at);
        at = end;
    }
    assert_int_equal(*at, ']');
}

/* The melting scenes have no random part: all seeds but the first move their particles a little. */
static void a_seed_moves_the_particles_of_a_lattice(void **state)
{
    (void)state;
    double neighbours[3], first;
    assert_code(0, run("experiments melting-cost --small --seeds 3 --json --quiet"));
    read_neighbours(neighbours, 3);
    assert_true(neighbours[0] != neighbours[1] && neighbours[1] != neighbours[2]);
    assert_code(0, run("experiments melting-cost --small --json --quiet"));
    read_neighbours(&first, 1);
    assert_true(first == neighbours[0]);
}

static void columns_can_be_plotted_against_the_first_one(void **state)
{
    (void)state;
    size_t size;
    assert_code(0, run("experiments kernel --quiet -o kernel"));
    char *svg = read_bytes("kernel/kernel.svg", &size);
    svg[size] = 0;
    assert_in("r/h, 1", svg);
    assert_null(strstr(svg, "time, T"));
}

static void a_parameter_can_be_changed(void **state)
{
    (void)state;
    assert_code(1, run("experiments drop --small --quiet --set history.lag=24"));
    assert_in("FAILS: rebound of d = 150 >= 0.5\n", out);
    assert_in("holds: rebound of none <= 0.1\n", out);
    assert_code(2, run("experiments drop --set history.leg=2"));
    assert_in("drop, none: unknown parameter \"history.leg\"", err);
    assert_code(2, run("experiments drop --set history.lag"));
    assert_in("--set needs KEY=VALUE", err);
}

static void bad_usage_is_refused(void **state)
{
    (void)state;
    assert_code(2, run("experiments drip"));
    assert_in("there is no experiment \"drip\"; did you mean \"drop\"?", err);
    assert_code(2, run("experiments drop --seeds 0"));
    assert_in("--seeds is 1 to 99; got 0", err);
    assert_code(2, run("experiments drop --small -o no/such/folder"));
    assert_in("cannot make the folder no/such/folder", err);
    assert_string_equal(out, "");
}

static void files_that_cannot_be_written_are_refused_at_once(void **state)
{
    (void)state;
    static const char *const names[] = {"drop-small.csv", "drop-small.svg", "hole-small.csv"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char path[64];
        snprintf(path, sizeof path, "taken/%s", names[i]);
        assert_true(mkdir("taken", 0777) == 0 && mkdir(path, 0777) == 0);
        assert_code(2, run("experiments drop hole --small -o taken"));
        assert_one_message("exists and leads to no regular file"); /* and no result */
        assert_true(rmdir(path) == 0 && rmdir("taken") == 0);
    }
}

/* Regression: what was finished was lost, and --json printed nothing. */
static void an_interrupted_experiment_prints_what_is_finished(void **state)
{
    (void)state;
    assert_code(4, interrupt_until("experiments drop hole --small --seeds 99 --json --quiet -o half",
                                   "\"figures\": {\"lowest\": [0."));
    assert_in("{\"experiment\": \"drop\", \"reference\": ", out);
    assert_in("\"outcome\": \"interrupted\", \"reason\": \"drop, ", out);
    assert_in("\"runs\": 396, \"finished\": ", out);
    const int finished = atoi(value_of("finished"));
    assert_true(finished > 0 && finished < 396);
    assert_in("\"claims\": [], \"holds\": null}\n", out);
    /* The variants have a value for each run. */
    int values = 0;
    for (const char *at = strstr(out, "\"variants\""); (at = strstr(at, "\"lowest\": [")) != NULL;)
        for (at += strlen("\"lowest\": ["); *at != ']'; at++)
            values += at[-1] == '[' || *at == ',';
    assert_int_equal(values, finished);
    assert_int_equal(file_size("half/drop-small.csv"), -1);
    assert_null(strstr(out, "\"hole\""));

    assert_code(4, interrupt_until("experiments drop --small --seeds 99 --quiet", "interrupted after "));
    assert_in(" of 396 runs: the figures are of these", out);
    assert_null(strstr(out, "holds"));
    assert_null(strstr(out, "FAILS"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_claims_hold),
        cmocka_unit_test(it_has_its_keys),
        cmocka_unit_test(the_kernel_has_one_shape_at_every_smoothing_length),
        cmocka_unit_test(it_lists_them),
        cmocka_unit_test(it_writes_what_was_measured),
        cmocka_unit_test(a_seed_moves_the_particles_of_a_lattice),
        cmocka_unit_test(columns_can_be_plotted_against_the_first_one),
        cmocka_unit_test(a_parameter_can_be_changed),
        cmocka_unit_test(bad_usage_is_refused),
        cmocka_unit_test(files_that_cannot_be_written_are_refused_at_once),
        cmocka_unit_test(an_interrupted_experiment_prints_what_is_finished),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
