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

#include "cli/bench.h"
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

static const char RUN[] = "table1 --windows 3 --particles 1000 --steps 2 --repetitions 2 --csv --quiet";
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
    assert_int_equal(bench("table2 --particles 1000 --steps 1 --repetitions 1 --csv --quiet", text, sizeof text),
                     CLI_DONE);
    assert_non_null(strstr(text, "ns_substep_median"));
    assert_non_null(strstr(text, "\nmelting-bunny,"));
    assert_non_null(strstr(text, "\nmelting-logo,"));
    double particles, neighbours, substeps;
    assert_int_equal(
        sscanf(strstr(text, "\nmelting-all,"), "\nmelting-all,%lf,%lf,%lf", &particles, &neighbours, &substeps), 3);
    assert_true(particles > 900 && particles < 1100 && neighbours > 40 && substeps >= 5 && substeps < 30);
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
    assert_true(many.operations == 2 * few.operations && many.roots == 40 && few.roots == 20);
    cli_bench_needs once, thrice;
    assert_true(cli_bench_stage_needs(&c, "forces", &once));
    c.substeps = 3;
    assert_true(cli_bench_stage_needs(&c, "forces", &thrice));
    assert_true(thrice.operations == 3 * once.operations && thrice.roots == 3 * once.roots);
    assert_true(cli_bench_stage_needs(&c, "viscosity", &once));
    assert_true(once.operations == many.operations);
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
        cmocka_unit_test(stages_are_listed_in_the_order_of_a_step),
        cmocka_unit_test(the_slowest_resource_sets_the_limit),
    };
    rheo__sabotage = sabotage;
    return cmocka_run_group_tests_name("bench", tests, NULL, NULL);
}
