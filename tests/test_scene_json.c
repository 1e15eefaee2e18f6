/* Scenes as JSON. Writing and reading preserve all bits, and every error names its line and the correction. */
#define _POSIX_C_SOURCE 200809L
#include <locale.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "arrays.h"
#include "rheolog/scene_json.h"

static rheo_result read_text(const char *text, rheo_scene *scene, rheo_error *error)
{
    error->message[0] = 0;
    const rheo_result result = rheo_scene_from_json(text, strlen(text), "dir/t.json", scene, error);
    if (result != RHEO_OK)
        return result;
    const rheo_result checked = rheo_scene_check(scene, error);
    if (checked != RHEO_OK)
        rheo_scene_release(scene);
    return checked;
}

/* The second next call releases the scene. */
static rheo_scene read_good(const char *text)
{
    static rheo_scene last[2];
    static size_t calls;
    rheo_scene scene;
    rheo_error error;
    if (read_text(text, &scene, &error) != RHEO_OK)
        fail_msg("%s\nin %s", error.message, text);
    rheo_scene_release(&last[calls % 2]);
    last[calls++ % 2] = scene;
    return scene;
}

static bool json_is_built_in(void)
{
    rheo_scene scene;
    rheo_error error;
    return read_text("{}", &scene, &error) != RHEO_ERROR_UNSUPPORTED;
}

static void assert_same_scene(const rheo_scene *a, const rheo_scene *b)
{
    assert_string_equal(a->name, b->name);
    assert_string_equal(a->about, b->about);
    assert_int_equal(a->world.model, b->world.model);
    const rheo_parameter *p = NULL;
    for (size_t i = 0; (p = rheo_scene_parameter_at(i)) != NULL; i++) {
        char of_a[128] = "", of_b[128] = "";
        assert_int_equal(rheo_scene_get(a, p->path, of_a, sizeof of_a), RHEO_OK);
        assert_int_equal(rheo_scene_get(b, p->path, of_b, sizeof of_b), RHEO_OK);
        assert_string_equal(of_a, of_b);
    }
    assert_int_equal(a->fill_count, b->fill_count);
    for (uint32_t i = 0; i < a->fill_count; i++) {
        const rheo_fill *f = &a->fill[i], *g = &b->fill[i];
        assert_int_equal(f->kind, g->kind);
        assert_memory_equal(f->min, g->min, sizeof f->min);
        assert_memory_equal(f->max, g->max, sizeof f->max);
        assert_memory_equal(f->centre, g->centre, sizeof f->centre);
        assert_memory_equal(&f->radius, &g->radius, sizeof f->radius);
        assert_string_equal(f->name, g->name);
        assert_memory_equal(&f->height, &g->height, sizeof f->height);
        assert_memory_equal(&f->depth, &g->depth, sizeof f->depth);
        assert_memory_equal(f->position, g->position, sizeof f->position);
        assert_int_equal(f->has_temperature, g->has_temperature);
        assert_memory_equal(f->temperature, g->temperature, sizeof f->temperature);
        assert_int_equal(f->not_hydrostatic, g->not_hydrostatic);
        assert_memory_equal(f->velocity, g->velocity, sizeof f->velocity);
        assert_memory_equal(&f->jitter, &g->jitter, sizeof f->jitter);
    }
    assert_int_equal(a->world.walls.count, b->world.walls.count);
    for (uint32_t i = 0; i < a->world.walls.count; i++) {
        assert_memory_equal(a->world.walls.plane[i].point, b->world.walls.plane[i].point, 3 * sizeof(double));
        assert_memory_equal(a->world.walls.plane[i].normal, b->world.walls.plane[i].normal, 3 * sizeof(double));
    }
    assert_int_equal(a->world.vibrators.count, b->world.vibrators.count);
    if (a->world.vibrators.count > 0)
        assert_memory_equal(a->world.vibrators.position, b->world.vibrators.position,
                            a->world.vibrators.count * 2 * sizeof(double));
}

static void assert_round_trip(const rheo_scene *scene)
{
    char *text = rheo_scene_to_json(scene);
    assert_non_null(text);
    const rheo_scene read = read_good(text);
    assert_same_scene(scene, &read);
    char *again = rheo_scene_to_json(&read);
    assert_string_equal(text, again);
    free(again);
    free(text);
}

static void builtin_scenes_are_read_back_to_the_bit(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    assert_true(rheo_scene_builtin_count() > 0);
    for (size_t i = 0; i < rheo_scene_builtin_count(); i++) {
        rheo_scene scene;
        assert_int_equal(rheo_scene_builtin_at(i, &scene), RHEO_OK);
        assert_round_trip(&scene);
        rheo_scene_release(&scene);
    }
}

static void awkward_numbers_and_names_are_read_back(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    rheo_scene scene = rheo_default_scene();
    strcpy(scene.name, "a \"b\" \\ \xc3\xbc");
    strcpy(scene.about, "/ {[,:]}");
    scene.seed = (UINT64_C(1) << 53) - 1;
    scene.steps = 1;
    scene.world.gravity[0] = -0.0;
    scene.world.gravity[1] = 5e-324;
    scene.world.gravity[2] = 0.1 + 0.2;
    scene.world.ball.spin[1] = -1e29;
    scene.world.history.window_seconds = 2.5000000000000004;
    scene.world.springs.solver = RHEO_SOLVER_IMPLICIT;
    scene.ball.clearance = 0.30000000000000004;
    scene.fill = some_fills();
    scene.fill_count = 3; /* mixed kinds keep their order, which is the order of ids */
    fills_of(&scene)[0] = (rheo_fill){
        .kind = RHEO_FILL_SPHERE, .centre = {0, 9, -0.0}, .radius = 4.1, .velocity = {1e-300, 0, 0}, .jitter = .1};
    fills_of(&scene)[1] =
        (rheo_fill){.kind = RHEO_FILL_BLOCK, .min = {-4, -0.0, -4}, .max = {4, 8.1, 4}, .velocity = {0, -3, 0}};
    fills_of(&scene)[2] = (rheo_fill){.kind = RHEO_FILL_SPHERE, .centre = {0, 30, 0}, .radius = 3, .jitter = .5};
    assert_round_trip(&scene);
    const rheo_scene empty = rheo_default_scene();
    char *text = rheo_scene_to_json(&empty);
    const rheo_scene read = read_good(text);
    assert_int_equal(read.fill_count, 0);
    free(text);
}

static void melting_scenes_are_read_back_to_the_bit(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    rheo_scene scene = rheo_default_model_scene(RHEO_MODEL_MELTING);
    strcpy(scene.name, "melts");
    assert_round_trip(&scene);
    scene.particles = 300;
    scene.world.melting.viscosity = 0.1 + 0.2;
    scene.world.melting.substeps = 7;
    scene.world.melting.flow = RHEO_FLOW_FROZEN;
    scene.world.paper.heat = RHEO_AS_PRINTED_ON;
    scene.world.walls.plane = some_walls();
    scene.world.walls.count = 1;
    walls_of(&scene.world)[0].normal[1] = 1. / 3;
    scene.fill = some_fills();
    scene.fill_count = 4;
    fills_of(&scene)[0] = (rheo_fill){.kind = RHEO_FILL_MESH,
                                      .name = "bunny",
                                      .height = 1. / 3,
                                      .position = {1e-300, -0.0, 3},
                                      .velocity = {0, 0.1, 0},
                                      .jitter = 0.125,
                                      .has_temperature = true,
                                      .temperature = {-0.0, 0.7000000000000001}};
    fills_of(&scene)[1] = (rheo_fill){.kind = RHEO_FILL_LETTERS,
                                      .name = "MELT 1:2/3!",
                                      .height = 0.7000000000000001,
                                      .depth = 0.25,
                                      .position = {0, 2, 0.1},
                                      .not_hydrostatic = true};
    fills_of(&scene)[2] = (rheo_fill){.kind = RHEO_FILL_BLOCK, .max = {1, 1, 1}, .has_temperature = true};
    fills_of(&scene)[3] = (rheo_fill){.kind = RHEO_FILL_SPHERE, .radius = 0.5, .temperature = {0}};
    assert_round_trip(&scene);
    /* Nothing of the other model is written. */
    char *text = rheo_scene_to_json(&scene);
    static const char *const others[] = {"springs", "history", "ball", "vibrators", "settle", "support", "sticking"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        assert_null(strstr(text, others[i]));
    assert_non_null(strstr(text, "\"planes\""));
    free(text);
    const rheo_scene plain = rheo_default_scene();
    text = rheo_scene_to_json(&plain);
    assert_null(strstr(text, "melting"));
    assert_null(strstr(text, "paper.")); /* "paper" is also a choice of history.weights */
    assert_null(strstr(text, "\"paper\": {"));
    free(text);
}

/* The model may be anywhere in the file: earlier members get the model's defaults too. */
static void the_model_is_read_first(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    const rheo_scene s = read_good("{\"gravity\": [0, -2, 0], \"melting\": {\"viscosity\": 0.5, \"rheology\": "
                                   "\"newtonian\"},\n \"paper\": {\"xsph\": \"on\"}, \"fluid\": {\"shapes\": ["
                                   "{\"block\": {\"min\": [0, 0, 0], \"max\": [1, 1, 1], \"temperature\": 0.5}}]},"
                                   "\"model\": \"melting\"}");
    assert_int_equal(s.world.model, RHEO_MODEL_MELTING);
    assert_string_equal(s.name, "t");
    assert_true(s.world.step == 0.02 && s.world.fluid.spacing == 0.045 && s.world.gravity[1] == -2);
    assert_true(s.world.melting.viscosity == 0.5 && s.world.melting.rheology == RHEO_RHEOLOGY_NEWTONIAN);
    assert_true(s.world.paper.xsph == RHEO_AS_PRINTED_ON);
    assert_true(s.fill[0].has_temperature && s.fill[0].temperature[0] == 0.5 && s.fill[0].temperature[1] == 0.5);
    assert_false(s.fill[0].not_hydrostatic);
}

static void meshes_and_letters_are_read(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    const rheo_scene s = read_good(
        "{\"model\": \"melting\", \"particles\": 100, \"fluid\": {\"shapes\": [\n"
        " {\"mesh\": {\"file\": \"bunny\", \"height\": 2, \"position\": [1, 2, 3], \"velocity\": [0, -1, 0],\n"
        "  \"jitter\": 0.1, \"temperature\": [0.1, 0.9], \"hydrostatic\": true}},\n"
        " {\"letters\": {\"text\": \"HI\", \"height\": 3, \"depth\": 0.5, \"position\": [4, 5, 6], "
        "\"hydrostatic\": false}}]}}");
    assert_int_equal(s.fill_count, 2);
    assert_int_equal(s.particles, 100);
    const rheo_fill *mesh = &s.fill[0], *letters = &s.fill[1];
    assert_int_equal(mesh->kind, RHEO_FILL_MESH);
    assert_string_equal(mesh->name, "bunny");
    assert_true(mesh->height == 2 && mesh->position[0] == 1 && mesh->position[2] == 3 && mesh->velocity[1] == -1);
    assert_true(mesh->jitter == 0.1 && mesh->has_temperature && mesh->temperature[0] == 0.1);
    assert_true(mesh->temperature[1] == 0.9 && !mesh->not_hydrostatic);
    assert_int_equal(letters->kind, RHEO_FILL_LETTERS);
    assert_string_equal(letters->name, "HI");
    assert_true(letters->height == 3 && letters->depth == 0.5 && letters->position[1] == 5);
    assert_true(!letters->has_temperature && letters->not_hydrostatic);
    /* A relative path starts at the folder of the scene. Faults of the mesh file are reported. */
    static const struct {
        const char *file, *message;
        rheo_result result;
    } cases[] = {{"a/none.obj", "shape 0: cannot read the mesh dir/a/none.obj: ", RHEO_ERROR_ARGUMENT},
                 {"/no/none.ply", "shape 0: cannot read the mesh /no/none.ply: ", RHEO_ERROR_ARGUMENT},
                 {"rabbit", "there is no mesh \"rabbit\"", RHEO_ERROR_ARGUMENT},
                 {"", "dir/t.json:1: fluid.shapes[0].mesh: no mesh is named", RHEO_ERROR_ARGUMENT}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        rheo_scene scene = rheo_default_scene();
        rheo_error error;
        snprintf(text, sizeof text, "{\"fluid\": {\"shapes\": [{\"mesh\": {\"file\": \"%s\"}}]}}", cases[i].file);
        assert_int_equal(read_text(text, &scene, &error), cases[i].result);
        if (!strstr(error.message, cases[i].message))
            fail_msg("\"%s\" is missing in \"%s\"", cases[i].message, error.message);
    }
}

static void everything_is_optional(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    rheo_scene plain = rheo_default_scene();
    strcpy(plain.name, "t"); /* after the file */
    const rheo_scene read = read_good("{}");
    assert_same_scene(&plain, &read);
    const rheo_scene groups = read_good("{\"fluid\": {}, \"settle\": {}, \"walls\": {\"planes\": [], \"boxes\": []},"
                                        "\"vibrators\": {\"positions\": []}, \"model\": \"thickening\"}");
    assert_same_scene(&plain, &groups);
}

static void parameters_are_read(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    const rheo_scene s = read_good("{\"scene\": \"x\", \"about\": \"y\", \"step\": 0.01, \"gravity\": [1, -2, 3],"
                                   "\"seed\": 7, \"steps\": 12, \"settle\": {\"time\": 1.5, \"damping\": 0.5,"
                                   "\"fraction\": 0.25}, \"fluid\": {\"support\": 2}, \"springs\": {\"solver\":"
                                   "\"implicit\"}, \"history\": {\"window\": \"2.5 s\"},"
                                   "\"ball\": {\"clearance\": 2, \"radius\": 3, \"position\": [1, 2, 3]}}");
    assert_string_equal(s.name, "x");
    assert_string_equal(s.about, "y");
    assert_true(s.world.step == .01);
    assert_true(s.world.gravity[0] == 1 && s.world.gravity[1] == -2 && s.world.gravity[2] == 3);
    assert_int_equal(s.seed, 7);
    assert_int_equal(s.steps, 12);
    assert_true(s.settle.time == 1.5 && s.settle.damping == .5 && s.settle.fraction == .25);
    assert_true(s.world.fluid.support == 2);
    assert_int_equal(s.world.springs.solver, RHEO_SOLVER_IMPLICIT);
    assert_true(s.world.history.window_seconds == 2.5);
    assert_true(s.ball.clearance == 2 && s.world.ball.radius == 3 && s.world.ball.position[2] == 3);
    assert_int_equal(read_good("{\"history\": {\"window\": 40}}").world.history.window, 40);
}

static void shapes_boxes_and_grids_are_read(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    const rheo_scene s =
        read_good("{\"fluid\": {\"shapes\": [{\"sphere\": {\"centre\": [1, 2, 3], \"radius\": 4}},\n"
                  " {\"block\": {\"min\": [0, 1, 2], \"max\": [10, 11, 12], \"velocity\": [0, -1, 0], "
                  "\"jitter\": 0.1}}]},\n"
                  " \"walls\": {\"boxes\": [{\"min\": [-1, -2, -3], \"max\": [4, 5, 6], \"open\": [\"top\", "
                  "\"front\"]}],\n"
                  "  \"planes\": [{\"point\": [0, 1, 0], \"normal\": [1, 1, 0]}]},\n"
                  " \"vibrators\": {\"grid\": {\"min\": [0, 10], \"max\": [6, 14], \"spacing\": 2}, "
                  "\"positions\": [[8, 9]]}}");
    assert_int_equal(s.fill_count, 2);
    assert_int_equal(s.fill[0].kind, RHEO_FILL_SPHERE);
    assert_true(s.fill[0].centre[2] == 3 && s.fill[0].radius == 4 && s.fill[0].jitter == 0);
    assert_int_equal(s.fill[1].kind, RHEO_FILL_BLOCK);
    assert_true(s.fill[1].min[1] == 1 && s.fill[1].max[2] == 12 && s.fill[1].velocity[1] == -1);
    assert_true(s.fill[1].jitter == .1);
    /* the order of the file: bottom, left, right and back of the box, then the plane */
    static const double normals[5][3] = {{0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {1, 1, 0}};
    static const double points[5][3] = {{-1, -2, -3}, {-1, -2, -3}, {4, 5, 6}, {-1, -2, -3}, {0, 1, 0}};
    assert_int_equal(s.world.walls.count, 5);
    for (size_t i = 0; i < 5; i++)
        for (size_t k = 0; k < 3; k++) {
            assert_true(s.world.walls.plane[i].normal[k] == normals[i][k]);
            assert_true(s.world.walls.plane[i].point[k] == points[i][k]);
        }
    static const double vibrators[7][2] = {{1, 11}, {3, 11}, {5, 11}, {1, 13}, {3, 13}, {5, 13}, {8, 9}};
    assert_int_equal(s.world.vibrators.count, 7);
    for (size_t i = 0; i < 7; i++)
        assert_memory_equal(s.world.vibrators.position[i], vibrators[i], sizeof vibrators[i]);
}

static void errors_name_line_path_and_correction(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    static const struct {
        const char *text, *parts[3];
    } cases[] = {
        {"{\n\"step\": }", {"dir/t.json:2:"}},
        {"", {"dir/t.json:"}},
        {"[1]", {"dir/t.json:1: ", "must be an object", "a list"}},
        {"3", {"dir/t.json:1"}},
        {"{} x", {"dir/t.json:1:", "end of file expected"}},
        {"{\n\n\"stp\": 1}", {"dir/t.json:3: stp: ", "unknown key", "\"step\""}},
        {"{\"step\": 1,\n \"fluid\": {\n  \"suport\": 1}}", {"dir/t.json:3: fluid.suport: ", "\"fluid.support\""}},
        {"{\n\"sources\": {\"kind\": \"floor\"}}",
         {"dir/t.json:2: sources: ", "\"sources\" is now called \"vibrators\""}},
        {"{\"melting\": {\n\"courant\": 1}}", {"dir/t.json:2: ", "is now called \"melting.courant_number\""}},
        {"{\"shapes\": []}", {"shapes: ", "\"fluid.shapes\""}},
        {"{\"support\": 1}", {"dir/t.json:1: support: ", "\"fluid.support\""}},
        {"{\"settle\": {\"tiem\": 1}}", {"settle.tiem", "\"settle.time\""}},
        {"{\"fluid.support\": 1}", {"dir/t.json:1: fluid.support: ", "dot"}},
        {"{\"fluid\":\n 3}", {"dir/t.json:1: fluid", "must be an object", "a number"}},
        {"{\"step\": 1,\n\"step\": 2}", {"dir/t.json:2:", "duplicate"}},
        {"{\n\"step\": -1}", {"dir/t.json:2: step", "-1", "at least 1e-12"}},
        {"{\n\"step\": 0}", {"dir/t.json:2: step"}},
        {"{\n\"step\": \"1\"}", {"dir/t.json:2: step: ", "must be a number", "a string"}},
        {"{\n\"step\": NaN}", {"dir/t.json:2:"}},
        {"{\n\"step\": null}", {"dir/t.json:2: step: ", "null"}},
        {"{\n\"step\": 1e999}", {"dir/t.json:2:", "overflow"}},
        {"{\n\"seed\": 1.5}", {"dir/t.json:2: seed", "whole number", "1.5"}},
        {"{\n\"seed\": 99999999999999999999999}", {"dir/t.json:2: seed", "whole number"}},
        {"{\n\"steps\": 0}", {"dir/t.json:2: steps", "at least 1"}},
        {"{\n\"settle\": {\"damping\": -1}}", {"dir/t.json:2: settle.damping", "at least 0"}},
        {"{\n\"gravity\": [1, 2]}", {"dir/t.json:2: gravity: ", "3 numbers, e.g. [0, 2.5, 0]; got a list of 2"}},
        {"{\n\"gravity\": 9.81}", {"dir/t.json:2: gravity: ", "list of 3 numbers", "a number"}},
        {"{\"gravity\": [1,\n true, 3]}", {"dir/t.json:2: gravity[1]: ", "must be a number"}},
        {"{\"springs\": {\n\"solver\": \"quick\"}}", {"dir/t.json:2: springs.solver", "explicit implicit"}},
        {"{\"springs\": {\n\"solver\": 1}}", {"dir/t.json:2: springs.solver: ", "explicit implicit"}},
        {"{\"history\": {\n\"window\": \"2.5 d\"}}", {"dir/t.json:2: history.window", "2.5 s"}},
        {"{\"history\": {\n\"window\": true}}", {"dir/t.json:2: history.window: ", "2.5 s"}},
        {"{\"history\": {\n\"window\": 1.5}}", {"dir/t.json:2: history.window"}},
        {"{\"history\": {\n\"order\": 1}}", {"dir/t.json:2: history.order", "below 1"}},
        {"{\"model\": \"water\"}", {"dir/t.json:1: model: ", "\"thickening\"", "\"melting\""}},
        {"{\n\"model\": 3}", {"dir/t.json:2: model: ", "\"melting\""}},
        {"{\"model\": \"melting\",\n\"springs\": {\"stiffness\": 1}}",
         {"dir/t.json:2: springs.stiffness", "of the model thickening", "is melting"}},
        {"{\"settle\": {\"time\": 1},\n\"model\": \"melting\"}",
         {"dir/t.json:1: settle.time", "of the model thickening", "is melting"}},
        {"{\"model\": \"melting\", \"vibrators\": {\n\"positions\": []}}",
         {"dir/t.json:2: vibrators.positions", "of the model thickening"}},
        {"{\"melting\": {\n\"viscosity\": \"x\"}}",
         {"dir/t.json:2: melting.viscosity", "of the model melting", "is thickening"}},
        {"{\"paper\": {\"xsph\": \"on\"}}", {"paper.xsph", "of the model melting"}},
        {"{\"fluid\": {\"shapes\": [\n{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 9, \"temperature\": 1}}]}}",
         {"dir/t.json:2: fluid.shapes[0].sphere: ", "temperature is no member of shapes in the model thickening"}},
        {"{\"fluid\": {\"shapes\": [{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 9, \"hydrostatic\": true}}]}}",
         {"fluid.shapes[0].sphere: ", "hydrostatic is no member of shapes in the model thickening"}},
        {"{\"model\": \"melting\", \"fluid\": {\"shapes\": [{\"mesh\": {\"file\": \"bunny\", \"height\": 1,\n"
         "\"temperature\": [1, 2, 3]}}]}}",
         {"dir/t.json:2: fluid.shapes[0].mesh.temperature: ", "2 numbers", "a list of 3"}},
        {"{\"model\": \"melting\", \"fluid\": {\"shapes\": [{\"mesh\": {\"file\": \"bunny\",\n"
         "\"temperature\": \"hot\"}}]}}",
         {"dir/t.json:2: fluid.shapes[0].mesh.temperature: ", "a number or a list", "a string"}},
        {"{\"model\": \"melting\", \"fluid\": {\"shapes\": [{\"mesh\": {\"file\": \"bunny\", \"hydrostatic\": 1}}]}}",
         {"mesh.hydrostatic: ", "true or false", "a number"}},
        {"{\"fluid\": {\"shapes\": [{\"mesh\": {\"height\": 1}}]}}", {"mesh: ", "\"file\" is missing"}},
        {"{\"fluid\": {\"shapes\": [{\"letters\": {\"height\": 1, \"depth\": 1}}]}}",
         {"letters: ", "\"text\" is missing"}},
        {"{\"fluid\": {\"shapes\": [{\"letters\": {\"text\": \"a b\", \"height\": 9, \"depth\": 9}}]}}",
         {"dir/t.json:1: fluid.shapes[0].letters: ", "there is no letter for: ab;"}},
        {"{\"fluid\": {\"shapes\": [{\"letters\": {\"txet\": \"A\"}}]}}", {"letters.txet: ", "\"text\""}},
        {"{\"particles\": 10}", {"particles is 10", "empty"}},
        {"{\n\"particles\": 1.5}", {"dir/t.json:2: particles", "whole number"}},
        {"{\"scene\": 3}", {"dir/t.json:1: scene: ", "must be a string"}},
        {"{\"scene\": \"a\\u001b[2Jb\"}", {"dir/t.json:1: scene: ", "control characters"}},
        {"{\"a\\u001b[2Jb\": 1}", {"dir/t.json:1: a?[2Jb: ", "unknown key"}},
        {"{\"fluid\": {\"shapes\": 1}}", {"fluid.shapes: ", "must be a list"}},
        {"{\"fluid\": {\"shapes\": [\n{}]}}", {"dir/t.json:2: fluid.shapes[0]: ", "\"block\""}},
        {"{\"fluid\": {\"shapes\": [\n{\"cube\": {}}]}}", {"dir/t.json:2: fluid.shapes[0].cube: ", "\"sphere\""}},
        {"{\"fluid\": {\"shapes\": [\n{\"block\": {\"min\": [0, 0, 0]}}]}}",
         {"dir/t.json:2: fluid.shapes[0].block: ", "\"max\" is missing"}},
        {"{\"fluid\": {\"shapes\": [{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 9}},\n"
         "{\"block\": {\"min\": [0, 0, 0], \"max\": [1, -1, 1]}}]}}",
         {"dir/t.json:2: fluid.shapes[1].block: ", "may be above"}},
        {"{\"fluid\": {\"shapes\": [{\"sphere\": {\"centre\": [0, 0, 0],\n\"radius\": -1}}]}}",
         {"fluid.shapes[0].sphere: ", "radius must be 0 or more"}},
        {"{\"fluid\": {\"shapes\": [{\"sphere\": {\"center\": [0, 0, 0]}}]}}",
         {"fluid.shapes[0].sphere.center: ", "\"centre\""}},
        {"{\"fluid\": {\"shapes\": [{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 9, \"jitter\": 0.6}}]}}",
         {"fluid.shapes[0].sphere: ", "from 0 to 0.5"}},
        {"{\"walls\": {\"planes\": [\n\n{\"point\": [0, 0, 0], \"normal\": [0, 0, 0]}]}}",
         {"dir/t.json:3: walls.planes[0]: ", "normal"}},
        {"{\"walls\": {\"planes\": [\n{\"point\": [0, 0, 0]}]}}", {"dir/t.json:2: walls.planes[0]: ", "\"normal\""}},
        {"{\"walls\": {\"boxes\": [{\"min\": [0, 0, 0], \"max\": [1, 1, 1],\n\"open\": "
         "[\"left\",\n\"up\"]}]}}",
         {"dir/t.json:3: walls.boxes[0].open[1]: ", "\"top\""}},
        {"{\"vibrators\": {\"positions\": [[0, 0],\n[0]]}}",
         {"t.json:2: vibrators.positions[1]: ", "2 numbers, e.g. [0, 2.5];"}},
        {"{\"vibrators\": {\"grid\": {\"min\": [0, 0], \"max\": [1000, 1000], \"spacing\": 1}}}",
         {"dir/t.json:1: vibrators.grid: ", "1024"}},
        {"{\"vibrators\": {\"grid\": {\"min\": [0, 0], \"max\": [1, 1], \"spacing\": 0}}}",
         {"dir/t.json:1: vibrators.grid: ", "spacing must be more than 0"}},
        {"{\"vibrators\": {\"grid\": {\"min\": [0, 0], \"max\": [1e300, 1], \"spacing\": 1e-300}}}",
         {"dir/t.json:1: vibrators.grid: ", "1024"}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        rheo_scene scene = rheo_default_scene();
        rheo_error error;
        const rheo_result result = read_text(cases[i].text, &scene, &error);
        if (result != RHEO_ERROR_ARGUMENT)
            fail_msg("%d instead of an argument error: %s", (int)result, cases[i].text);
        for (size_t k = 0; k < 3 && cases[i].parts[k]; k++)
            if (!strstr(error.message, cases[i].parts[k]))
                fail_msg("\"%s\" is missing in \"%s\" for %s", cases[i].parts[k], error.message, cases[i].text);
        assert_null(strchr(error.message, '\n'));
    }
}

#define PLANE "{\"point\":[0,0,0],\"normal\":[0,1,0]}"

static void limits_have_messages(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    static const struct {
        const char *head, *item, *tail, *message;
        int count;
    } cases[] = {
        {"{\"fluid\":{\"shapes\":[", "{\"sphere\":{\"centre\":[0,0,0],\"radius\":3}}", "]}}", "at most 64 shapes",
         65},
        {"{\"walls\":{\"planes\":[" PLANE "," PLANE "," PLANE "," PLANE "],\"boxes\":[",
         "{\"min\":[0,0,0],\"max\":[1,1,1]}", "]}}", "at most 64 walls", 11},
        {"{\"vibrators\":{\"positions\":[", "[0,0]", "]},\"walls\":{\"planes\":[" PLANE "]}}",
         "at most 1024 vibrators", 1025},
    };
    for (size_t c = 0; c < 3; c++) {
        for (int beyond = 0; beyond < 2; beyond++) { /* the last number that is allowed, and the next one */
            char text[16384];
            size_t length = (size_t)sprintf(text, "%s", cases[c].head);
            for (int i = 0; i < cases[c].count - 1 + beyond; i++)
                length += (size_t)sprintf(text + length, "%s%s", i ? "," : "", cases[c].item);
            sprintf(text + length, "%s", cases[c].tail);
            rheo_scene limited;
            rheo_error wrong;
            assert_int_equal(read_text(text, &limited, &wrong), beyond ? RHEO_ERROR_ARGUMENT : RHEO_OK);
            if (beyond)
                assert_non_null(strstr(wrong.message, cases[c].message));
            else
                rheo_scene_release(&limited);
        }
    }
    /* A grid may have as many in a row, too. */
    assert_int_equal(read_good("{\"vibrators\":{\"grid\":{\"min\":[0,0],\"max\":[1024,1],\"spacing\":1}},"
                               "\"walls\":{\"planes\":[" PLANE "]}}")
                         .world.vibrators.count,
                     1024);
    rheo_scene scene;
    rheo_error error;
    assert_int_equal(
        read_text("{\"vibrators\":{\"grid\":{\"min\":[0,0],\"max\":[1,1025],\"spacing\":1}}}", &scene, &error),
        RHEO_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "make \"spacing\" larger"));
}

static void hostile_input_is_safe(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    rheo_scene scene = rheo_default_scene();
    const rheo_scene before = scene;
    rheo_error error;
    const size_t size = 10u << 20;
    char *text = malloc(size + 1);
    assert_non_null(text);
    memset(text, '[', size);
    assert_int_equal(rheo_scene_from_json(text, size, "t", &scene, &error), RHEO_ERROR_ARGUMENT);
    memset(text, ' ', size);
    assert_int_equal(rheo_scene_from_json(text, size, "t", &scene, &error), RHEO_ERROR_ARGUMENT);
    memcpy(text + size - 13, "{\"stiff\": [1]}", 14); /* a key at the end of a long file */
    assert_int_equal(rheo_scene_from_json(text, size + 1, "t", &scene, &error), RHEO_ERROR_ARGUMENT);
    memset(text, '\n', size - 20);
    assert_int_equal(rheo_scene_from_json(text, size + 1, "t", &scene, &error), RHEO_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "t:10485741: stiff"));
    memset(text, '0', size);
    assert_int_equal(rheo_scene_from_json(text, size, "t", &scene, &error), RHEO_ERROR_ARGUMENT);
    memset(text, 'x', size); /* a key of many megabytes */
    memcpy(text, "{\"", 2);
    memcpy(text + size - 5, "\": 1}", 5);
    assert_int_equal(rheo_scene_from_json(text, size, "t", &scene, &error), RHEO_ERROR_ARGUMENT);
    free(text);
    static const char nul[] = "{\"step\": 1\0}";
    assert_int_equal(rheo_scene_from_json(nul, sizeof nul - 1, "t", &scene, &error), RHEO_ERROR_ARGUMENT);
    static const char nul_after[] = "{\"step\": 1}\0";
    assert_int_equal(rheo_scene_from_json(nul_after, sizeof nul_after - 1, "t", &scene, &error), RHEO_ERROR_ARGUMENT);
    assert_int_equal(rheo_scene_from_json("{\"a\\u0000b\": 1}", 14, "t", &scene, &error), RHEO_ERROR_ARGUMENT);
    assert_same_scene(&before, &scene); /* an error changes nothing */
}

static void every_cut_and_many_mutations_are_safe(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    rheo_scene scene;
    rheo_error error;
    assert_int_equal(rheo_scene_builtin_at(0, &scene), RHEO_OK);
    char *text = rheo_scene_to_json(&scene);
    const size_t size = strlen(text);
    rheo_scene_release(&scene);
    for (size_t cut = 0; cut + 2 < size; cut++)
        assert_int_equal(rheo_scene_from_json(text, cut, "t", &scene, &error), RHEO_ERROR_ARGUMENT);
    uint32_t random = 1;
    char *changed = malloc(size);
    assert_non_null(changed);
    for (int round = 0; round < 5000; round++) {
        memcpy(changed, text, size);
        for (int i = 0; i < 1 + round % 3; i++) {
            random = random * 1664525u + 1013904223u;
            const size_t at = (random >> 8) % size;
            random = random * 1664525u + 1013904223u;
            changed[at] = round % 2 ? "{}[],:\"0-e.n"[(random >> 8) % 12] : (char)(random >> 24);
        }
        error.message[0] = 0;
        if (rheo_scene_from_json(changed, size, "t", &scene, &error) != RHEO_OK)
            assert_memory_equal(error.message, "t:", 2);
        else
            rheo_scene_release(&scene);
    }
    free(changed);
    free(text);
}

static const char commented[] = "{\"$schema\": \"scene.schema.json\", \"comment\": [\"two\", \"lines\"],\n"
                                " \"step\": 0.01, \"settle\": {\"comment\": 1, \"time\": 0},\n"
                                " \"fluid\": {\"comment\": null, \"shapes\": [\n"
                                "  {\"comment\": \"a drop\", \"sphere\": {\"comment\": {}, \"centre\": [0, 4, 0],\n"
                                "   \"radius\": 2}}]},\n"
                                " \"walls\": {\"planes\": [{\"comment\": \"floor\", \"point\": [0, 0, 0],\n"
                                "   \"normal\": [0, 1, 0]}], \"boxes\": [{\"$schema\": \"\", \"min\": [-9, 0, -9],\n"
                                "   \"max\": [9, 9, 9], \"open\": [\"top\"]}]},\n"
                                " \"vibrators\": {\"grid\": {\"comment\": \"\", \"min\": [0, 0], \"max\": [4, 4],\n"
                                "   \"spacing\": 2}}}";

static void comments_are_ignored_in_every_object(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    const rheo_scene scene = read_good(commented);
    assert_true(scene.world.step == 0.01);
    assert_int_equal(scene.fill_count, 1);
    assert_true(scene.fill[0].radius == 2);
    assert_int_equal(scene.world.walls.count, 6);
    assert_int_equal(scene.world.vibrators.count, 4);
}

static void a_comment_hides_no_mistake_and_no_line(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    static const char *const cases[][2] = {
        {"{\"comments\": 1}", "dir/t.json:1: comments: unknown key"},
        {"{\"comment\": 1,\n\"stp\": 1}", "dir/t.json:2: stp: unknown key"},
        {"{\"fluid\": {\"shapes\": [{\"comment\": 1}]}}", "must be {\"block\": {...}}"},
        {"{\"fluid\": {\"shapes\": [{\"comment\": 1,\n\"cube\": {}}]}}",
         "dir/t.json:2: fluid.shapes[0].cube: unknown shape"},
        {"{\"fluid\": {\"shapes\": [{\"comment\": 1, \"sphere\": {\n\"comment\": 1,\n\"radius\": \"\"}}]}}",
         "dir/t.json:3: fluid.shapes[0].sphere.radius: must be a number"},
        {"{\"fluid\": {\"shapes\": [{\"block\": {}, \"comment\": 1, \"sphere\": {}}]}}",
         "must be {\"block\": {...}}"},
        {"{\"fluid\": {\"shapes\": [[1]]}}", "must be {\"block\": {...}}"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rheo_scene scene;
        rheo_error error;
        assert_int_equal(read_text(cases[i][0], &scene, &error), RHEO_ERROR_ARGUMENT);
        if (!strstr(error.message, cases[i][1]))
            fail_msg("%s\nfor %s", error.message, cases[i][0]);
    }
}

/* ---- Files, and programs that use the library ---- */

static void files_are_written_read_and_kept_without_force(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    rheo_scene scene, read;
    rheo_error error = {""};
    const char *path = "test_scene_json_written.json";
    remove(path);
    assert_int_equal(rheo_scene_builtin("vibration", &scene, &error), RHEO_OK);
    assert_int_equal(rheo_scene_write_json(&scene, path, false, &error), RHEO_OK);
    assert_int_equal(rheo_scene_read_json(path, &read, &error), RHEO_OK);
    assert_same_scene(&scene, &read);
    rheo_scene_release(&read);

    scene.world.step *= 2;
    assert_int_equal(rheo_scene_write_json(&scene, path, false, &error), RHEO_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "test_scene_json_written.json exists already"));
    assert_int_equal(rheo_scene_write_json(&scene, path, true, &error), RHEO_OK);
    assert_int_equal(rheo_scene_read_json(path, &read, &error), RHEO_OK);
    assert_true(read.world.step == scene.world.step);
    rheo_scene_release(&read);
    assert_int_equal(rheo_scene_write_json(&scene, "no-folder/a.json", false, &error), RHEO_ERROR_FILE);
    assert_string_equal(error.message, "cannot write no-folder/a.json: No such file or directory");
    rheo_scene_release(&scene);
    remove(path);
}

/* A mesh as the scene in memory names it, the file to write to, and how the file names the mesh. */
static void meshes_of_a_written_file_are_found_again(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    char here[4096], whole[4096 + 64];
    assert_non_null(getcwd(here, sizeof here));
    snprintf(whole, sizeof whole, "%s/test_scene_json_dir/m.obj", here);
    const struct {
        const char *mesh, *file, *written;
    } cases[] = {
        {"test_scene_json_dir/m.obj", "test_scene_json_dir/a.json", "\"m.obj\""},
        {"test_scene_json_dir/m.obj", "test_scene_json_a.json", "\"test_scene_json_dir/m.obj\""},
        {"test_scene_json_dir/m.obj", "test_scene_json_other/a.json", whole},
        {whole, "test_scene_json_other/a.json", whole},
        {whole, "test_scene_json_a.json", whole},
        {"bunny", "test_scene_json_other/a.json", "\"bunny\""},
    };
    static const char *const folders[] = {"test_scene_json_dir", "test_scene_json_other"};
    static const char tetrahedron[] = "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    rheo_error error = {""};
    for (size_t i = 0; i < 2; i++)
        assert_int_equal(mkdir(folders[i], 0700), 0);
    FILE *file = fopen("test_scene_json_dir/m.obj", "wb");
    assert_true(file && fputs(tetrahedron, file) >= 0 && fclose(file) == 0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rheo_fill fill = {.kind = RHEO_FILL_MESH, .height = 9};
        rheo_scene scene = rheo_default_scene(), read;
        snprintf(fill.name, sizeof fill.name, "%s", cases[i].mesh);
        scene.fill = &fill;
        scene.fill_count = 1;
        uint64_t count = 0, again = 0;
        assert_int_equal(rheo_scene_particle_count(&scene, &count, &error), RHEO_OK);
        assert_int_equal(rheo_scene_write_json(&scene, cases[i].file, true, &error), RHEO_OK);
        assert_string_equal(fill.name, cases[i].mesh);
        char text[1 << 16] = "";
        file = fopen(cases[i].file, "rb");
        assert_true(file && fread(text, 1, sizeof text - 1, file) > 0 && fclose(file) == 0);
        assert_non_null(strstr(text, cases[i].written));
        assert_int_equal(rheo_scene_read_json(cases[i].file, &read, &error), RHEO_OK);
        assert_int_equal(rheo_scene_particle_count(&read, &again, &error), RHEO_OK);
        assert_true(count > 0 && again == count);
        rheo_scene_release(&read);
        remove(cases[i].file);
    }
    remove("test_scene_json_dir/m.obj");
    for (size_t i = 0; i < 2; i++)
        assert_int_equal(rmdir(folders[i]), 0);
}

static void unreadable_files_are_named_and_change_nothing(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    rheo_scene scene = rheo_default_scene();
    const rheo_scene before = scene;
    rheo_error error = {""};
    assert_int_equal(rheo_scene_read_json("no-such.json", &scene, &error), RHEO_ERROR_FILE);
    assert_string_equal(error.message, "cannot read no-such.json: No such file or directory");
    assert_int_equal(rheo_scene_read_json(".", &scene, &error), RHEO_ERROR_FILE);
    assert_string_equal(error.message, "cannot read . to its end: Is a directory");
    assert_int_equal(rheo_scene_read_json(".", &scene, NULL), RHEO_ERROR_FILE);
    assert_same_scene(&before, &scene);
}

/* A program may have set a locale with a decimal comma. */
static void scenes_are_the_same_in_every_locale(void **state)
{
    (void)state;
    if (!json_is_built_in())
        skip();
    rheo_scene scene;
    rheo_error error = {""};
    for (size_t i = 0; rheo_scene_builtin_at(i, &scene) == RHEO_OK; i++) {
        scene.world.gravity[0] = -0.1;
        assert_int_equal(rheo_scene_set(&scene, "step", "0.015625", &error), RHEO_OK);
        char *plain = rheo_scene_to_json(&scene);
        if (!setlocale(LC_ALL, "de_DE.UTF-8")) {
            free(plain);
            rheo_scene_release(&scene);
            skip();
        }
        char *german = rheo_scene_to_json(&scene);
        assert_string_equal(plain, german);
        assert_round_trip(&scene);
        setlocale(LC_ALL, "C");
        free(german);
        free(plain);
        rheo_scene_release(&scene);
    }
}

/* Spheres are counted row by row. Counting point by point took minutes for 64 large spheres in a file of 5 KB. */
static void spheres_are_counted_by_rows(void **state)
{
    (void)state;
    rheo_scene scene = rheo_default_scene();
    static rheo_fill fills[RHEO_MAX_FILLS];
    scene.fill = fills;
    scene.fill_count = 1;
    fills_of(&scene)[0].kind = RHEO_FILL_SPHERE;
    scene.world.fluid.spacing = 1;
    for (int n = 0; n <= 400; n++) {
        double radius = fills_of(&scene)[0].radius = n < 200 ? 0.05 * n : __builtin_sqrt(n - 200);
        uint64_t count = 0;
        int most = (int)radius + 1;
        for (int z = -most; z <= most; z++)
            for (int y = -most; y <= most; y++)
                for (int x = -most; x <= most; x++)
                    count += x * x + y * y + z * z <= radius * (1 + 1e-9) * (radius * (1 + 1e-9));
        uint64_t counted = 0;
        assert_int_equal(rheo_scene_particle_count(&scene, &counted, NULL), RHEO_OK);
        assert_int_equal(counted, count);
    }
    scene.fill_count = RHEO_MAX_FILLS;
    for (int f = 0; f < RHEO_MAX_FILLS; f++) {
        fills_of(&scene)[f] = fills_of(&scene)[0];
        fills_of(&scene)[f].radius = 780;
    }
    rheo_error error;
    assert_int_equal(rheo_scene_check(&scene, &error), RHEO_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "2^30"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(builtin_scenes_are_read_back_to_the_bit),
        cmocka_unit_test(awkward_numbers_and_names_are_read_back),
        cmocka_unit_test(melting_scenes_are_read_back_to_the_bit),
        cmocka_unit_test(the_model_is_read_first),
        cmocka_unit_test(meshes_and_letters_are_read),
        cmocka_unit_test(everything_is_optional),
        cmocka_unit_test(parameters_are_read),
        cmocka_unit_test(shapes_boxes_and_grids_are_read),
        cmocka_unit_test(errors_name_line_path_and_correction),
        cmocka_unit_test(limits_have_messages),
        cmocka_unit_test(hostile_input_is_safe),
        cmocka_unit_test(every_cut_and_many_mutations_are_safe),
        cmocka_unit_test(comments_are_ignored_in_every_object),
        cmocka_unit_test(a_comment_hides_no_mistake_and_no_line),
        cmocka_unit_test(files_are_written_read_and_kept_without_force),
        cmocka_unit_test(meshes_of_a_written_file_are_found_again),
        cmocka_unit_test(unreadable_files_are_named_and_change_nothing),
        cmocka_unit_test(scenes_are_the_same_in_every_locale),
        cmocka_unit_test(spheres_are_counted_by_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
