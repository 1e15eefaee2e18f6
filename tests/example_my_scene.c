/*
 * A golden test of your own scene and code, with cmocka: the run is compared with a golden recording step by step. To
 * use it, copy it, and replace my_scene.h by your code. example_plain.c records the golden recording, and is the same test
 * without cmocka.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include <rheolog/rheolog.h>

#include "my_scene.h"

static void my_scene_is_the_same_as_ever(void **state)
{
    (void)state;
    const char *path = getenv("GOLDEN");
    rheo_error error = {""};
    rheo_world *world = NULL;
    rheo_golden *golden = NULL;
    if (my_scene_create(&world, &error) != RHEO_OK)
        fail_msg("%s", error.message);
    if (rheo_golden_open(world, path ? path : "golden/my_scene.rlog", &golden, &error) != RHEO_OK)
        fail_msg("%s", error.message);
    rheo_result result = RHEO_OK;
    while (result == RHEO_OK && rheo_world_step_count(world) < MY_SCENE_STEPS) {
        result = my_scene_act(world, &error);
        if (result == RHEO_OK)
            result = rheo_golden_step(golden, &error); /* in place of rheo_world_step() */
    }
    if (result != RHEO_OK)
        fail_msg("%s", error.message);
    if (rheo_golden_close(golden, NULL, &error) !=
        RHEO_OK) /* also fails if a step of the golden recording is missing */
        fail_msg("%s", error.message);
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(my_scene_is_the_same_as_ever)};
    return cmocka_run_group_tests_name("example of my scene", tests, NULL, NULL);
}
