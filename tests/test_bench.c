/*
 * `rheolog bench` in one program with a library whose stages can be made faulty. A benchmark must fail if its runs
 * end with different bits. Its output without faults is tested in test_cli_bench.c.
 */
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "cli/bench_results.h"
#include "world/world.h"

enum { WINDOW = 3, LEAD = WINDOW + 1, KERNEL_STEPS = 4, WARM_UP = 8 };

static enum { NOTHING, ONE_REPETITION, ONE_TARGET } plan;
static int passed; /* how often a run has reached the planned step */

/* Changes a value by more than rounding can hide. */
static void change(rheo_world *world)
{
    world->state.velocity[0] += (rheo_real)0.125;
}

static void sabotage(rheo_world *world, uint32_t stage)
{
    rheo_stage_info info;
    if (rheo_world_stage(world, stage, &info) != RHEO_OK || strcmp(info.name, "gravity") != 0 ||
        rheo_world_history_window(world) != WINDOW) /* a settling fluid has no history */
        return;
    /* Only timed repetitions reach this step. */
    if (plan == ONE_REPETITION && *world->state.step == LEAD + WARM_UP && ++passed == 2)
        change(world);
    if (plan == ONE_TARGET && *world->state.step == LEAD + KERNEL_STEPS - 1 &&
        strcmp(rheo_simd(), rheo_simd_available(1)) == 0)
        change(world);
}

/* Runs the command and saves its output in a file; returns the exit code and the output. */
static int bench(const char *arguments, char *text, size_t size)
{
    char words[256], *argv[16], name[] = "/tmp/rheolog-bench-XXXXXX";
    int argc = 0;
    snprintf(words, sizeof words, "%s", arguments);
    for (char *word = strtok(words, " "); word; word = strtok(NULL, " "))
        argv[argc++] = word;
    const int file = mkstemp(name), out = dup(1), err = dup(2);
    assert_true(file >= 0 && out >= 0 && err >= 0);
    fflush(stdout);
    assert_true(dup2(file, 1) == 1 && dup2(file, 2) == 2);
    passed = 0;
    const int code = cli_bench.run(argc, argv);
    fflush(stdout);
    assert_true(dup2(out, 1) == 1 && dup2(err, 2) == 2);
    assert_int_equal(lseek(file, 0, SEEK_SET), 0);
    const ssize_t length = read(file, text, size - 1);
    text[length > 0 ? length : 0] = 0;
    close(file);
    close(out);
    close(err);
    unlink(name);
    return code;
}

static const char RUN[] =
    "table1 --windows 3 --scheme summed --particles 500 --settle 5 --steps 2 --repetitions 2 --csv --quiet";
static char text[1 << 16];

static void equal_hashes_pass(void **state)
{
    (void)state;
    plan = NOTHING;
    assert_int_equal(bench(RUN, text, sizeof text), CLI_DONE);
    assert_non_null(strstr(text, "\nbowling-ball,"));
    assert_non_null(strstr(text, "\nvibration,"));
}

static void a_repetition_with_another_hash_fails(void **state)
{
    (void)state;
    plan = ONE_REPETITION;
    assert_int_equal(bench(RUN, text, sizeof text), CLI_DIFFERS);
    assert_non_null(strstr(text, "the first repetition ended with hash "));
    assert_non_null(strstr(text, "repetition 2 with "));
    assert_null(strstr(text, "case,particles")); /* no results */
}

static void simd_variants_with_another_hash_fail(void **state)
{
    (void)state;
    if (!rheo_simd_available(1))
        skip();
    char in_use[32];
    snprintf(in_use, sizeof in_use, "%s", rheo_simd());
    plan = ONE_TARGET;
    assert_int_equal(bench(RUN, text, sizeof text), CLI_DIFFERS);
    assert_non_null(strstr(text, "simd scalar ended with hash "));
    assert_non_null(strstr(text, rheo_simd_available(1)));
    assert_string_equal(rheo_simd(), in_use);
    assert_null(strstr(text, "case,particles"));
}

/* The melting scenes and their substeps. */
static void melting_scenes_are_measured_by_substeps(void **state)
{
    (void)state;
    plan = NOTHING;
    assert_int_equal(bench("table2 --particles 300 --steps 1 --repetitions 1 --csv --quiet", text, sizeof text),
                     CLI_DONE);
    assert_non_null(strstr(text, "ns_substep_median"));
    assert_non_null(strstr(text, "\nmelting-bunny,"));
    assert_non_null(strstr(text, "\nmelting-logo,"));
    double particles, neighbours, substeps;
    assert_int_equal(
        sscanf(strstr(text, "\nmelting-all,"), "\nmelting-all,%lf,%lf,%lf", &particles, &neighbours, &substeps), 3);
    assert_true(particles > 250 && particles < 350 && neighbours > 30 && substeps >= 5 && substeps < 30);
}

static void medians_are_in_the_middle(void **state)
{
    (void)state;
    static const double values[] = {5, 1, 4, 100, 2};
    assert_true(cli_bench_median(values, 5) == 4);
    assert_true(cli_bench_median(values, 4) == 4.5);
    assert_true(cli_bench_median(values, 1) == 5);
    assert_true(cli_bench_least(values, 5) == 1);
    assert_true(cli_bench_largest(values, 5) == 100);
}

/* Of few values the range is all of them; of many, some at both ends are left out. */
static void ranges_hold_the_median(void **state)
{
    (void)state;
    double values[100], range[2];
    for (int i = 0; i < 100; i++)
        values[i] = (i * 37) % 100;
    cli_bench_median_range((const double[]){5, 1, 4, 100, 2}, 5, range);
    assert_true(range[0] == 1 && range[1] == 100);
    cli_bench_median_range((const double[]){7, 1, 2, 3, 4, 5, 6, 8}, 8, range);
    assert_true(range[0] == 1 && range[1] == 8); /* without the ends: 93 % */
    cli_bench_median_range((const double[]){7, 1, 2, 3, 4, 5, 6, 8, 9}, 9, range);
    assert_true(range[0] == 2 && range[1] == 8); /* 96.1 % */
    cli_bench_median_range(values, 100, range);  /* tables: the 40th and the 61st of 100 values */
    assert_true(range[0] == 39 && range[1] == 60);
    cli_bench_median_range((const double[]){3}, 1, range);
    assert_true(range[0] == 3 && range[1] == 3);
    cli_bench_median_range((const double[]){3, 2}, 2, range);
    assert_true(range[0] == 2 && range[1] == 3);
}

/* What bench limits, bench table2 and run print, in this version and in older ones. */
static void results_are_read(void **state)
{
    (void)state;
    cli_bench_results r = {0};
    char wrong[64];
    assert_true(cli_bench_read_results(
        "{\"case\": \"a\", \"stage\": \"walls\", \"ns_median\": 2.5, \"ns_limit\": 9, \"set_by\": \"\"}\n"
        "{\"case\": \"a\", \"stage\": \"rest\", \"ns_median\": 1, \"ns_limit\": null}\n"
        "{\"case\": \"b\\\"c\", \"particles\": 7, \"substeps\": 4, \"ns_substep_median\": 10, \"ns_walls\": 3}\n"
        "{\"scene\": \"d\", \"hash\": \"00ff\", \"ns_per_particle_step\": 8, \"file\": null, \"stages\": [{\"name\": "
        "\"walls\", \"ns_per_particle_step\": 3}, {\"name\": \"ball\", \"ns_per_particle_step\": 1}], "
        "\"ns_per_particle_substep\": 2}\n"
        "{\"setting\": \"courant 0.1\", \"ns_particle_time\": 1e3}\n",
        &r, wrong));
    assert_int_equal(r.count, 4);
    assert_int_equal(r.item[0].stages, 2);
    assert_true(r.item[0].total == 3.5 && cli_bench_result_stage(&r.item[0], "walls") == 2.5);
    assert_string_equal(r.item[1].key[CLI_BENCH_CASE], "b\"c");
    assert_string_equal(r.item[1].particles, "7");
    assert_true(r.item[1].total == 40 && cli_bench_result_stage(&r.item[1], "walls") == 12);
    assert_true(cli_bench_result_stage(&r.item[1], "rest") == 28);
    assert_string_equal(r.item[2].hash, "00ff");
    assert_true(r.item[2].total == 8 && cli_bench_result_stage(&r.item[2], "ball") == 1);
    assert_int_equal(r.item[2].stages, 3);
    assert_true(cli_bench_result_stage(&r.item[2], "springs") != cli_bench_result_stage(&r.item[2], "springs"));
    assert_true(r.item[3].total == 1000 && r.item[3].stages == 0);
    /* A version that does not print the scheme has only one. */
    cli_bench_result like = {.key = {"d", "4", "", "summed"}, .has = {true, true, false, true}};
    assert_ptr_equal(cli_bench_find_result(&r, &like), &r.item[2]);
    snprintf(like.key[CLI_BENCH_CASE], sizeof like.key[0], "e");
    assert_ptr_equal(cli_bench_find_result(&r, &like), &r.item[3]); /* and one without cases is not told apart */
    free(r.item);
    /* bench error: a line for each quantity of a setting, and points without a cost. */
    r = (cli_bench_results){0};
    assert_true(cli_bench_read_results(
        "{\"study\": \"steps\", \"scene\": \"drop\", \"setting\": \"step\", \"quantity\": \"dip\", \"ns_step\": 5, "
        "\"us_time\": 0.5, \"hash\": \"0a\"}\n"
        "{\"study\": \"steps\", \"scene\": \"drop\", \"setting\": \"step\", \"quantity\": \"rise\", \"ns_step\": 5, "
        "\"us_time\": 0.5}\n"
        "{\"study\": \"history\", \"scene\": \"drop\", \"setting\": \"step\", \"ns_step\": 7, \"us_time\": null}\n"
        "{\"study\": \"history\", \"scene\": \"fit\", \"setting\": \"4 lags\", \"ns_step\": null, \"us_time\": null}\n",
        &r, wrong));
    assert_int_equal(r.count, 2);
    assert_true(r.item[0].total == 500 && r.item[1].total == 7);
    assert_string_equal(r.item[0].hash, "0a");
    assert_true(r.item[0].stages == 0 && r.item[1].stages == 0);
    free(r.item);
    static const char *const bad[] = {"",
                                      "\n",
                                      "x",
                                      "{",
                                      "{\"case\"",
                                      "{\"case\":",
                                      "{\"case\": \"a",
                                      "{\"case\": \"a\"",
                                      "{\"case\": \"a\", \"ns_median\": 1} x",
                                      "{\"case\": \"a\", \"ns_median\": null}",
                                      "{\"case\": \"a\", \"ns_median\": 1,}",
                                      "{\"case\": \"a\", \"ns_median\": nan}",
                                      "[{\"case\": \"a\", \"ns_median\": 1}]",
                                      "{\"case\": \"a\" \"ns_median\": 1}"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        r = (cli_bench_results){0};
        if (cli_bench_read_results(bad[i], &r, wrong))
            fail_msg("taken as a result: %s", bad[i]);
        free(r.item);
    }
}

/* The list of all stages keeps the order of a step, whichever case is first. */
static void stages_are_listed_in_the_order_of_a_step(void **state)
{
    (void)state;
    cli_bench_case both[2] = {{.stages = 3, .stage = {"gravity", "density", "walls"}},
                              {.stages = 4, .stage = {"vibrators", "gravity", "springs", "density"}}};
    const cli_bench_cases cases = {2, both};
    static const char *const expected[] = {"vibrators", "gravity", "springs", "density", "walls"};
    char stage[CLI_BENCH_MAX_STAGES][32];
    assert_int_equal(cli_bench_all_stages(&cases, stage), 5);
    for (size_t i = 0; i < 5; i++)
        assert_string_equal(stage[i], expected[i]);
}

/* The needs of a stage grow with its input; the slowest resource sets the limit. */
static void the_slowest_resource_sets_the_limit(void **state)
{
    (void)state;
    const cli_bench_limits limits = {.arithmetic = 100, .root = 5, .division = 10, .memory = 20, .cache = 80};
    const char *bound;
    assert_true(cli_bench_limit(&limits, &(cli_bench_needs){.operations = 500, .bytes = 80}, &bound) == 5);
    assert_string_equal(bound, "arithmetic");
    assert_true(
        cli_bench_limit(&limits, &(cli_bench_needs){.operations = 500, .roots = 25, .divisions = 10}, &bound) == 6);
    assert_string_equal(bound, "roots, divisions");
    assert_true(cli_bench_limit(&limits, &(cli_bench_needs){.operations = 1, .bytes = 160}, &bound) == 2);
    assert_string_equal(bound, "caches");
    assert_true(cli_bench_limit(&limits, &(cli_bench_needs){.operations = 1, .bytes = 160, .memory = true}, &bound) ==
                8);
    assert_string_equal(bound, "memory");
    cli_bench_needs few, many;
    cli_bench_case c = {.kind = "window", .window = 50, .neighbours = 20};
    assert_true(cli_bench_stage_needs(&c, "viscosity", &few));
    c.neighbours = 40;
    assert_true(cli_bench_stage_needs(&c, "viscosity", &many));
    assert_true(many.operations - few.operations == 63 * 20 && many.roots == 80 && few.roots == 40);
    cli_bench_needs once, thrice;
    assert_true(cli_bench_stage_needs(&c, "forces", &once));
    c.substeps = 3;
    assert_true(cli_bench_stage_needs(&c, "forces", &thrice));
    assert_true(thrice.operations == 3 * once.operations && thrice.roots == 3 * once.roots);
    assert_true(cli_bench_stage_needs(&c, "viscosity", &once));
    assert_true(once.operations == many.operations);
    snprintf(c.scheme, sizeof c.scheme, "sequential"); /* pairs, not both ends of them */
    assert_true(cli_bench_stage_needs(&c, "viscosity", &few));
    assert_true(few.roots == 20 && once.roots == 80);
    assert_true(cli_bench_stage_needs(&c, "spring_displacement", &few) && few.roots == 40);
    assert_true(cli_bench_stage_needs(&c, "walls", &few));
    assert_true(cli_bench_stage_needs(&c, "fractional_derivative", &few));
    assert_true(few.operations == 6 * 51 + 3);
    assert_false(cli_bench_stage_needs(&c, "no such stage", &few));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_hashes_pass),
        cmocka_unit_test(a_repetition_with_another_hash_fails),
        cmocka_unit_test(simd_variants_with_another_hash_fail),
        cmocka_unit_test(melting_scenes_are_measured_by_substeps),
        cmocka_unit_test(medians_are_in_the_middle),
        cmocka_unit_test(ranges_hold_the_median),
        cmocka_unit_test(results_are_read),
        cmocka_unit_test(stages_are_listed_in_the_order_of_a_step),
        cmocka_unit_test(the_slowest_resource_sets_the_limit),
    };
    rheo__sabotage = sabotage;
    return cmocka_run_group_tests_name("bench", tests, NULL, NULL);
}
