/* `rheolog bench stability` from outside: cells of the map, its columns and files. */
#define _POSIX_C_SOURCE 200809L
#include "cli_support.h"

/* A pool in which runs take half a second. */
#define SMALL "--settle 60 --particles 1000 --quiet"

static void runs_end_as_the_map_says(void **state)
{
    (void)state;
    /* The limit of the paper: Algorithm 1 bears a ratio of 10, and not 20. */
    assert_code(
        0, run("bench stability " SMALL " --steps 110 --solvers algorithm-1 --step-sizes 0.033 --ratios 10 --json"));
    assert_string_equal(err, "");
    assert_string_equal(value_of("stable"), "\"yes\"");
    assert_string_equal(value_of("sign"), "\"\"");
    assert_true(strtod(value_of("dip"), NULL) > 0.3 && strtod(value_of("steps"), NULL) == 110);
    assert_code(
        0, run("bench stability " SMALL " --steps 110 --solvers algorithm-1 --step-sizes 0.033 --ratios 20 --json"));
    assert_string_equal(value_of("stable"), "\"no\"");
    assert_string_equal(value_of("sign"), "\"max_spring_displacement\"");
    assert_true(strtod(value_of("kappa"), NULL) > 2);
    assert_string_equal(value_of("dip"), "null");
    /* Softened springs bear any ratio; without softening the ball is thrown higher than it was. */
    assert_code(
        0, run("bench stability " SMALL " --steps 110 --solvers default --step-sizes 0.033 --ratios 1e4 --json"));
    assert_string_equal(value_of("stable"), "\"yes\"");
    assert_true(strtod(value_of("softened_springs"), NULL) > 100);
    assert_code(
        0, run("bench stability " SMALL " --steps 110 --solvers unsoftened --step-sizes 0.033 --ratios 1e4 --json"));
    assert_string_equal(value_of("stable"), "\"no\"");
    assert_string_equal(value_of("sign"), "\"ball_height\"");
    assert_string_equal(value_of("softened_springs"), "0");
}

static void the_map_has_its_columns_and_files(void **state)
{
    (void)state;
    static char text[1 << 17];
    assert_code(0, run("bench stability " SMALL
                       " --steps 3 --step-sizes 0.033,0.01 --ratios 1,20 --stiffness 15 -o map --csv"));
    assert_int_equal(
        strncmp(out,
                "solver,settings,step,k_min,ratio,stable,bad_step,sign,kappa,kappa_sum,substeps,softened_springs,dip,"
                "rise,ns_step,particles,steps,hash,machine,compiler,real,simd\n",
                strcspn(out, "\n") + 1),
        0);
    size_t lines = 0;
    for (const char *at = out; *at; at++)
        lines += *at == '\n';
    assert_int_equal(lines, 1 + 7 * 2 * 2);
    assert_in("\ndefault,scheme=summed,0.03300,15.000,1.000,yes,,,", out);
    assert_in("\nimplicit,scheme=sequential springs.solver=implicit history.onset=0,0.01000,15.000,20.000,", out);
    read_file("map/stability.csv", text, sizeof text);
    assert_int_equal(strlen(text), strlen(out));
    read_file("map/stability.svg", text, sizeof text);
    assert_in("algorithm-1", text);
    assert_in(">stable<", text);
    assert_code(
        0, run("bench stability " SMALL " --steps 3 --solvers default,positions --step-sizes 0.033 --ratios 1,20"));
    assert_in("positions (scheme=positions)", out);
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    assert_code(2, run("bench stability --solvers default,fast"));
    assert_one_message("there is no solver \"fast\"; there are default, passive,");
    assert_code(2, run("bench stability --ratios 1,,2"));
    assert_one_message("--ratios needs a number strictly between 0 and 1e+12; got \"\"");
    assert_code(2, run("bench stability --ratios ''"));
    assert_one_message("--ratios needs numbers with commas between");
    assert_code(2, run("bench stability --solvers ''"));
    assert_one_message("--solvers needs names of solvers");
    assert_code(2, run("bench stability --ratios 1.00000000000000000000000000000001e4")); /* was taken for 1 */
    assert_one_message("--ratios needs a number strictly between 0 and 1e+12; got \"\"");
    assert_code(2, run("bench stability --step-sizes 0.033,0"));
    assert_code(2, run("bench stability " SMALL " --steps 3 --solvers default --ratios 1 --step-sizes 1e-12"));
    assert_one_message("history.window is 4.95 s"); /* before it asks for memory of as many steps */
    assert_code(2, run("bench stability --stiffness -1"));
    assert_code(2, run("bench stability --scheme summed"));
    assert_one_message("stability takes no --scheme; table1, history");
    assert_code(2, run("bench stability --repetitions 2"));
    assert_one_message("stability takes no --repetitions");
    assert_code(2, run("bench stability --baseline ./old"));
    assert_one_message("stability takes no --baseline");
    assert_code(2, run("bench scaling --ratios 1"));
    assert_one_message("scaling takes no --ratios; stability does");
    assert_code(2, run("bench scaling -o map"));
    assert_one_message("scaling takes no --output; error, stability and predictor do");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(runs_end_as_the_map_says),
        cmocka_unit_test(the_map_has_its_columns_and_files),
        cmocka_unit_test(bad_arguments_are_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
