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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_scene_is_named_after_its_file)};
    return cmocka_run_group_tests_name("scene_json_names", tests, NULL, NULL);
}
