/* Materials in scene files: written and read back to the same bits; every error names its line and the correction. */
#define _XOPEN_SOURCE 700 /* symlink() */
#include <locale.h>

#include "support.h"

#include <sys/stat.h>
#include <unistd.h>

#include "rheolog/scene_json.h"

static rheo_result read_text(const char *text, rheo_scene *scene, rheo_error *error)
{
    const rheo_result result = rheo_scene_from_json(text, strlen(text), "t.json", scene, error);
    if (result != RHEO_OK)
        return result;
    const rheo_result checked = rheo_scene_check(scene, error);
    if (checked != RHEO_OK)
        rheo_scene_release(scene);
    return checked;
}

static bool json_is_built_in(void)
{
    rheo_scene scene;
    rheo_error ignored;
    return read_text("{}", &scene, &ignored) != RHEO_ERROR_UNSUPPORTED;
}

static void materials_are_read(void **unused)
{
    (void)unused;
    if (!json_is_built_in())
        skip();
    rheo_scene scene;
    OK(read_text(
        "{\"fluid\": {\"shapes\": [{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 3, \"material\": \"b\"}},\n"
        "{\"sphere\": {\"centre\": [9, 0, 0], \"radius\": 3}}]},\n"
        "\"materials\": [{\"history\": {\"onset\": 0.1, \"comment\": 1}, \"name\": \"a\"},\n"
        "{\"name\": \"b\", \"springs\": {\"stiffness\": 0, \"plasticity\": 2.5, \"yield_ratio\": -1}}]}",
        &scene, &error));
    assert_int_equal(scene.world.materials.count, 2);
    const rheo_material *m = scene.world.materials.list;
    assert_string_equal(m[0].name, "a");
    assert_true(m[0].history.onset == 0.1 && m[0].history.stiffness == -1 && m[0].springs.stiffness == -1);
    assert_string_equal(m[1].name, "b");
    assert_true(m[1].springs.stiffness == 0 && m[1].springs.plasticity == 2.5 && m[1].springs.yield_ratio == -1);
    assert_string_equal(scene.fill[0].material, "b");
    assert_string_equal(scene.fill[1].material, "");
    rheo_scene_release(&scene);
}

/* Regression: the message was that of the parser, which names its own options. */
static void an_escaped_zero_is_refused_in_plain_words(void **unused)
{
    (void)unused;
    static const char *const texts[] = {
        "{\"about\": \"a\\u0000b\"}",
        "{\"a\\u0000b\": 1}",
        "{\"materials\":\n[{\"name\": \"\\u0000\"}]}",
    };
    if (!json_is_built_in())
        skip();
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        rheo_scene scene;
        REFUSED(RHEO_ERROR_ARGUMENT, i < 2 ? "t.json:1:" : "t.json:2:", read_text(texts[i], &scene, &error));
        REFUSED(RHEO_ERROR_ARGUMENT, ": a text has the character \\u0000, which nothing in a scene can have",
                read_text(texts[i], &scene, &error));
    }
}

/* Regression: a link was replaced by a file of its own, and the scene that it led to stayed as it was. */
static void a_scene_is_written_through_a_link(void **unused)
{
    (void)unused;
    static const char FILE_NAME[] = "test_scene_json_materials_file.json",
                      LINK[] = "test_scene_json_materials_link.json";
    rheo_scene scene = rheo_default_scene();
    remove(FILE_NAME);
    remove(LINK);
    assert_int_equal(symlink(FILE_NAME, LINK), 0);
    REFUSED(RHEO_ERROR_ARGUMENT, "is a link that leads to no file",
            rheo_scene_write_json(&scene, LINK, true, &error));
    OK(rheo_scene_write_json(&scene, FILE_NAME, false, &error));
    scene.seed = 77;
    REFUSED(RHEO_ERROR_ARGUMENT, "exists already; replacing it needs force",
            rheo_scene_write_json(&scene, LINK, false, &error));
    OK(rheo_scene_write_json(&scene, LINK, true, &error));
    struct stat status;
    assert_int_equal(lstat(LINK, &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    assert_int_equal(lstat(FILE_NAME, &status), 0);
    assert_true(S_ISREG(status.st_mode));
    size_t size;
    char *text = (char *)read_file(FILE_NAME, &size);
    text[size - 1] = 0;
    assert_non_null(strstr(text, "\"seed\": 77"));
    free(text);
    REFUSED(RHEO_ERROR_FILE, "cannot write", rheo_scene_write_json(&scene, "no/such.json", true, &error));
    remove(FILE_NAME);
    remove(LINK);
}

static void written_materials_are_read_back(void **unused)
{
    (void)unused;
    rheo_scene scene, again;
    OK(rheo_scene_builtin("drop-pair", &scene, &error));
    rheo_material m = rheo_default_material("x");
    m.springs.yield_ratio = 0.1;
    m.springs.plasticity = 1e-300;
    m.history.onset = 1.0 / 3;
    OK(rheo_world_def_add_material(&scene.world, &m, &error));
    char *text = rheo_scene_to_json(&scene);
    assert_non_null(text);
    if (!json_is_built_in()) {
        free(text);
        rheo_scene_release(&scene);
        skip();
    }
    OK(read_text(text, &again, &error));
    assert_memory_equal(&again.world.materials, &scene.world.materials, sizeof scene.world.materials);
    for (uint32_t f = 0; f < 2; f++)
        assert_string_equal(again.fill[f].material, scene.fill[f].material);
    char *second = rheo_scene_to_json(&again);
    assert_string_equal(text, second);
    free(text);
    free(second);
    rheo_scene_release(&again);

    /* A scene of one material says nothing of others. */
    scene.world.materials.count = 0;
    scene.owned.fill[1].material[0] = 0;
    text = rheo_scene_to_json(&scene);
    assert_null(strstr(text, "material"));
    free(text);
    rheo_scene_release(&scene);
}

static void bad_materials_are_refused_with_their_line(void **unused)
{
    (void)unused;
    if (!json_is_built_in())
        skip();
    static const struct {
        const char *text, *says;
    } bad[] = {
        {"{\n\"materials\": 3}", "t.json:2: materials: must be a list"},
        {"{\"materials\": [\n4]}", "t.json:2: materials[0]: must be an object with a name"},
        {"{\"materials\": [\n{}]}", "t.json:2: materials[0]: must be an object with a name"},
        {"{\"materials\": [{\n\"name\": 4}]}", "t.json:2: materials[0].name: must be"},
        {"{\"materials\": [{\n\"name\": \"1st\"}]}", "t.json:2: materials[0].name: material 1 has the name \"1st\""},
        {"{\"materials\": [{\n\"name\": \"aaaaaaaaaaaaaaaa\"}]}", "t.json:2: materials[0].name: "},
        {"{\"materials\": [{\"name\": \"a\"},\n{\"name\": \"a\"}]}", "t.json:2: materials[1].name: two materials"},
        {"{\"materials\": [{\"name\": \"a\",\n\"spring\": {}}]}", "did you mean \"springs\""},
        {"{\"materials\": [{\"name\": \"a\",\n\"springs\": 5}]}",
         "t.json:2: materials[0].springs: must be an object"},
        {"{\"materials\": [{\"name\": \"a\", \"springs\": {\n\"stiffness\": \"5\"}}]}",
         "t.json:2: materials[0].springs.stiffness: must be a number"},
        {"{\"materials\": [{\"name\": \"a\", \"springs\": {\n\"stiffness\": -5}}]}",
         "t.json:2: materials[0].springs.stiffness: materials.1.springs.stiffness is -5"},
        {"{\"materials\": [{\"name\": \"a\", \"history\": {\n\"order\": 0.5}}]}",
         "a material has no such parameter of its own; it has: springs.stiffness, springs.plasticity"},
        {"{\"model\": \"melting\",\n\"materials\": []}",
         "t.json:2: materials: springs.stiffness is a parameter of the model"},
        {"{\"scheme\": \"sequential\", \"materials\": [{\"name\": \"a\"}]}", "scheme sequential knows one material"},
        {"{\"fluid\": {\"shapes\": [{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 3, \"material\": \"b\"}}]}}",
         "shape 0: there is no material \"b\"; no materials are given"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        rheo_scene scene;
        REFUSED(RHEO_ERROR_ARGUMENT, bad[i].says, read_text(bad[i].text, &scene, &error));
    }
    /* 17 of them. */
    char text[1024] = "{\"materials\": [";
    for (int i = 0; i < 17; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "%s{\"name\": \"m%d\"}", i ? "," : "", i);
    strcat(text, "]}");
    rheo_scene scene;
    REFUSED(RHEO_ERROR_ARGUMENT, "materials[16].name: a world has at most 16", read_text(text, &scene, &error));
}

int main(void)
{
    setlocale(LC_ALL, "");
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(materials_are_read),
        cmocka_unit_test(an_escaped_zero_is_refused_in_plain_words),
        cmocka_unit_test(a_scene_is_written_through_a_link),
        cmocka_unit_test(written_materials_are_read_back),
        cmocka_unit_test(bad_materials_are_refused_with_their_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
