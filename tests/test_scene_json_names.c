/* A scene without a name is named after its file: the last part of the path, without .json, in printable ASCII. */
#include "support.h"

#include "rheolog/scene_json.h"

static void a_scene_is_named_after_its_file(void **unused)
{
    (void)unused;
    enum { ROOM = sizeof(((rheo_scene *)0)->name) };
    static const char *const CASES[][2] = {{"splash.json", "splash"},
                                           {"a/b/splash.json", "splash"},
                                           {"splash", "splash"},
                                           {"a.json/splash", "splash"},
                                           {"x.y", "x.y"},
                                           {"x.json.json", "x.json"},
                                           {"json", "json"},
                                           {"s", "s"},
                                           {"a~ b", "a~ b"},
                                           {"a\x7f\x1f"
                                            "b\xc3\xbc.json",
                                            "a__b__"}};
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        rheo_scene scene;
        rheo_error why = {""};
        const rheo_result result = rheo_scene_from_json("{}", 2, CASES[i][0], &scene, &why);
        if (result == RHEO_ERROR_UNSUPPORTED)
            skip();
        assert_int_equal(result, RHEO_OK);
        assert_string_equal(scene.name, CASES[i][1]);
        rheo_scene_release(&scene);
        OK(rheo_scene_from_json("{\"scene\": \"its own\"}", 20, CASES[i][0], &scene, &error));
        assert_string_equal(scene.name, "its own");
        rheo_scene_release(&scene);
    }
    /* A long name is cut. */
    for (size_t length = ROOM - 2; length <= ROOM + 1; length++) {
        char path[2 * ROOM];
        rheo_scene scene;
        memset(path, 'n', length);
        strcpy(path + length, ".json");
        OK(rheo_scene_from_json("{}", 2, path, &scene, &error));
        assert_int_equal(strlen(scene.name), length < ROOM ? length : ROOM - 1);
        assert_int_equal(strspn(scene.name, "n"), strlen(scene.name));
        rheo_scene_release(&scene);
    }
}

/* The path of a mesh begins at the folder of the scene, and the whole path has to fit. */
static void a_path_of_a_mesh_fits_or_is_refused(void **unused)
{
    (void)unused;
    enum { ROOM = sizeof(((rheo_fill *)0)->name), FOLDER = 4 };
    char text[ROOM + 128], most[64];
    snprintf(most, sizeof most, "after the folder of the scene, must have at most %d bytes", ROOM - 1);
    for (int length = ROOM - 8; length < ROOM; length++) {
        rheo_scene scene;
        rheo_error why = {""};
        snprintf(text, sizeof text, "{\"fluid\": {\"shapes\": [{\"mesh\": {\"file\": \"%0*d.obj\"}}]}}", length - 4,
                 7);
        const rheo_result result = rheo_scene_from_json(text, strlen(text), "dir/t.json", &scene, &why);
        if (result == RHEO_ERROR_UNSUPPORTED)
            skip();
        const bool fits = FOLDER + length < ROOM;
        assert_true((result == RHEO_OK) == fits);
        if (fits) {
            assert_int_equal(strlen(scene.fill[0].name), FOLDER + length);
            assert_memory_equal(scene.fill[0].name, "dir/000", 7);
            rheo_scene_release(&scene);
        } else if (!strstr(why.message, most)) {
            fail_msg("\"%s\" is missing in \"%s\"", most, why.message);
        }
    }
}

static void scene_files_have_further_balls(void **unused)
{
    (void)unused;
    static const char text[] =
        "{\"ball\": {\"radius\": 2}, \"ball2\": {\"radius\": 1, \"density_ratio\": 0.3, \"clearance\": 2, "
        "\"position\": [1, 2, 3]}, \"ball3\": {\"radius\": 4}}";
    rheo_scene scene, again;
    rheo_error why = {""};
    const rheo_result result = rheo_scene_from_json(text, strlen(text), "t.json", &scene, &why);
    if (result == RHEO_ERROR_UNSUPPORTED)
        skip();
    OK(result);
    assert_int_equal(scene.world.balls.count, 2);
    NEAR(scene.world.balls.list[0].density_ratio, 0.3, 0);
    NEAR(scene.world.balls.list[0].position[2], 3, 0);
    NEAR(scene.balls.clearance[0], 2, 0);
    NEAR(scene.balls.clearance[1], -1, 0);
    NEAR(scene.world.balls.list[1].friction, 25, 0);
    char *written = rheo_scene_to_json(&scene);
    assert_non_null(written);
    OK(rheo_scene_from_json(written, strlen(written), "t.json", &again, &error));
    assert_memory_equal(&scene.world.balls, &again.world.balls, sizeof scene.world.balls);
    assert_memory_equal(&scene.balls, &again.balls, sizeof scene.balls);
    free(written);
    rheo_scene_release(&scene);
    rheo_scene_release(&again);
    static const char *const BAD[][2] = {
        {"{\"ball3\": {\"radius\": 1}}", "there is no ball 2"},
        {"{\"ball1\": {\"radius\": 1}}", "the first ball has no number"},
        {"{\"ball17\": {\"radius\": 1}}", "at most 16 balls"},
        {"{\"ball2\": {\"radios\": 1}}", "a ball has no such parameter; it has: radius"},
        {"{\"ball2\": 3}", "ball2 must be an object"},
        {"{\"ball2\": {\"radius\": \"1\"}}", "ball2.radius"},
        {"{\"model\": \"melting\", \"ball2\": {\"radius\": 1}}", "parameter of the model thickening"},
    };
    for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++)
        REFUSED(RHEO_ERROR_ARGUMENT, BAD[i][1],
                rheo_scene_from_json(BAD[i][0], strlen(BAD[i][0]), "t.json", &scene, &error));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_scene_is_named_after_its_file),
                                       cmocka_unit_test(a_path_of_a_mesh_fits_or_is_refused),
                                       cmocka_unit_test(scene_files_have_further_balls)};
    return cmocka_run_group_tests_name("scene_json_names", tests, NULL, NULL);
}
