/*
 * `rheolog bench predictor` in one program: a planted instability is found and announced, and a bound that is wrong is
 * noticed. Its output is tested in test_cli_predictor.c.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "cli/bench_predictor.h"

enum { SEED = 161 }; /* springs of scheme sequential that are far too stiff for the step */

static cli_predictor_run one;

static uint32_t index_of(const cli_predictor_results *r, uint32_t group, const char *name)
{
    for (uint32_t m = 0; m < r->group[group].count; m++)
        if (strcmp(r->group[group].item[m].name, name) == 0)
            return m;
    fail_msg("no measure %s", name);
    return 0;
}

static void examine(const rheo_scene *scene, uint32_t group, cli_predictor_results *r)
{
    one = (cli_predictor_run){.group = group};
    *r = (cli_predictor_results){.count = 1, .run = &one};
    assert_int_equal(cli_predictor_examine(scene, &one, &r->group[group]), CLI_DONE);
}

/* A block in a box. Its pressure number is `number`. */
static void press(double number, cli_predictor_results *r)
{
    rheo_scene scene = rheo_default_scene();
    rheo_error error = {""};
    const rheo_fill block = {.kind = RHEO_FILL_BLOCK, .max = {10, 10, 10}, .jitter = 0.1};
    const rheo_wall wall[] = {{{0, 0, 0}, {0, 1, 0}},
                              {{0, 0, 0}, {1, 0, 0}},
                              {{0, 0, 0}, {0, 0, 1}},
                              {{10, 0, 0}, {-1, 0, 0}},
                              {{0, 0, 10}, {0, 0, -1}}};
    scene.world.scheme = RHEO_SCHEME_SEQUENTIAL;
    scene.world.history.stiffness = 0;
    scene.world.fluid.stiffness = number * scene.world.fluid.support / (scene.world.step * scene.world.step);
    scene.steps = 40;
    for (size_t w = 0; w < sizeof wall / sizeof *wall; w++)
        assert_int_equal(rheo_scene_add_wall(&scene, &wall[w], &error), RHEO_OK);
    assert_int_equal(rheo_scene_add_fill(&scene, &block, &error), RHEO_OK);
    examine(&scene, CLI_PREDICTOR_SEQUENTIAL, r);
    rheo_scene_release(&scene);
}

static void a_planted_instability_is_found_and_announced(void **state)
{
    (void)state;
    cli_predictor_results r;
    cli_predictor_row row;
    press(0.08, &r);
    assert_int_equal(one.reason, CLI_PREDICTOR_WELL);
    assert_true(one.unhealthy == UINT64_MAX && one.sign == UINT64_MAX);
    press(8, &r);
    assert_int_not_equal(one.reason, CLI_PREDICTOR_WELL);
    assert_true(one.sign <= one.bad && one.unhealthy <= one.bad);
    cli_predictor_judge(&r, CLI_PREDICTOR_SEQUENTIAL, index_of(&r, CLI_PREDICTOR_SEQUENTIAL, "pressure_number"),
                        &row);
    assert_int_equal(row.above_bad, 1);
    assert_int_equal(row.below + row.below_bad, 0);
    assert_true(row.lead >= 0);
}

static void a_bound_that_is_too_large_is_noticed(void **state)
{
    (void)state;
    cli_predictor_results r;
    rheo_scene scene;
    rheo_error error = {""};
    assert_int_equal(cli_predictor_group(SEED), CLI_PREDICTOR_SEQUENTIAL);
    assert_int_equal(cli_predictor_scene(CLI_PREDICTOR_SEQUENTIAL, SEED, &scene, &error), RHEO_OK);
    examine(&scene, CLI_PREDICTOR_SEQUENTIAL, &r);
    rheo_scene_release(&scene);
    assert_int_not_equal(one.reason, CLI_PREDICTOR_WELL);
    assert_int_equal(cli_predictor_check(&r), CLI_DONE);
    r.group[CLI_PREDICTOR_SEQUENTIAL].item[index_of(&r, CLI_PREDICTOR_SEQUENTIAL, "kappa")].limit = 1e9;
    assert_int_equal(cli_predictor_check(&r), CLI_DIFFERS);
}

static void seeds_give_scenes(void **state)
{
    (void)state;
    rheo_scene a, b;
    rheo_error error = {""};
    for (uint64_t seed = 1; seed < 60; seed++) {
        const uint32_t group = cli_predictor_group(seed);
        assert_int_equal(cli_predictor_scene(group, seed, &a, &error), RHEO_OK);
        assert_int_equal(cli_predictor_scene(group, seed, &b, &error), RHEO_OK);
        char of_a[96], of_b[96];
        assert_null(rheo_world_def_differing(&a.world, &b.world, &(size_t){0}, of_a, of_b));
        assert_int_equal(a.steps, b.steps);
        rheo_scene_release(&a);
        rheo_scene_release(&b);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_planted_instability_is_found_and_announced),
        cmocka_unit_test(a_bound_that_is_too_large_is_noticed),
        cmocka_unit_test(seeds_give_scenes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
