/* Obstacles in scene files, their warnings, and their views. */
#include "obstacles.h"

#include "rheolog/scene_json.h"
#include "view/facets.h"

static const char SCENE[] =
    "{\"scene\": \"obstacles\", \"fluid\": {\"shapes\": [{\"block\": {\"min\": [-4, 8, -4], \"max\": [4, 16, 4]}}]},\n"
    " \"walls\": {\"planes\": [{\"point\": [0, 0, 0], \"normal\": [0, 1, 0]}]},\n"
    " \"obstacles\": [{\"box\": {\"size\": [9, 2, 3], \"position\": [0, 5, 0], \"rotation\": [0, 30, 0], \"spin\": [0, 2, 0]}},\n"
    "  {\"mesh\": {\"file\": \"bunny\", \"height\": 4, \"position\": [8, 0, 0], \"amplitude\": [1, 0, 0], \"frequency\": 2}},\n"
    "  {\"cylinder\": {\"radius\": 40, \"length\": 80, \"inside\": true}}]}\n";

/* A program without jansson refuses all scene files. */
static bool json_scenes(void)
{
    rheo_scene scene;
    rheo_error ignored;
    const rheo_result result = rheo_scene_from_json("{}", 2, "s.json", &scene, &ignored);
    if (result == RHEO_OK)
        rheo_scene_release(&scene);
    return result != RHEO_ERROR_UNSUPPORTED;
}

static rheo_scene scene_of(const char *text)
{
    rheo_scene scene;
    OK(rheo_scene_from_json(text, strlen(text), "s.json", &scene, &error));
    return scene;
}

static void a_scene_file_has_obstacles(void **unused)
{
    (void)unused;
    if (!json_scenes())
        skip();
    rheo_scene scene = scene_of(SCENE);
    assert_int_equal(scene.world.obstacles.count, 3);
    const rheo_obstacle *o = scene.world.obstacles.list;
    assert_int_equal(o[0].shape, RHEO_OBSTACLE_BOX);
    assert_true(o[0].size[0] == 9 && o[0].rotation[1] == 30 && o[0].spin[1] == 2);
    assert_string_equal(o[1].file, "bunny");
    assert_true(o[2].inside == RHEO_OBSTACLE_INSIDE && o[2].length == 80);
    /* What is written reads back. */
    char *text = rheo_scene_to_json(&scene);
    assert_non_null(text);
    rheo_scene again = scene_of(text);
    assert_memory_equal(&again.world.obstacles, &scene.world.obstacles, sizeof scene.world.obstacles);
    free(text);
    rheo_scene_release(&again);
    OK(rheo_scene_set(&scene, "obstacles.0.spin", "[0, 3, 0]", &error));
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    assert_true(state_of(world, 0).spin[1] == 3);
    NEAR(state_of(world, 1).position[1], 2, 1e-12);
    step(world, 5);
    rheo_world_destroy(world);
    rheo_scene_release(&scene);
}

static void bad_scene_files_have_one_message(void **unused)
{
    (void)unused;
    if (!json_scenes())
        skip();
    static const struct {
        const char *obstacle, *says;
    } BAD[] = {{"{\"ball\": {}}", "must be {\"sphere\": {...}}, {\"box\""},
               {"{\"sphere\": {\"radios\": 1}}", "radius"},
               {"{\"sphere\": {\"size\": [1, 1, 1]}}", "size"},
               {"{\"sphere\": {\"shape\": \"box\"}}", "shape"},
               {"{\"box\": {\"size\": [1, 1]}}", "size"},
               {"{\"box\": {\"inside\": \"yes\"}}", "must be true or false; got"},
               {"{\"mesh\": {\"height\": 1}}", "must have a \"file\""},
               {"{\"sphere\": {\"radius\": -1}}", "obstacles.0.radius"},
               {"{\"sphere\": 3}", "must be an object"}};
    for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++) {
        char text[256];
        rheo_scene scene;
        snprintf(text, sizeof text, "{\"obstacles\": [%s]}", BAD[i].obstacle);
        REFUSED(RHEO_ERROR_ARGUMENT, BAD[i].says, rheo_scene_from_json(text, strlen(text), "s.json", &scene, &error));
    }
    rheo_scene scene;
    const char melting[] = "{\"model\": \"melting\", \"obstacles\": [{\"sphere\": {}}]}";
    REFUSED(RHEO_ERROR_ARGUMENT, "the model melting has no obstacles",
            rheo_scene_from_json(melting, strlen(melting), "s.json", &scene, &error));
}

/* ---- Meshes of scenes ---- */

static rheo_scene block_scene(void)
{
    rheo_scene scene = rheo_default_scene();
    rheo_fill fill = {.kind = RHEO_FILL_BLOCK, .min = {-4, 0, -4}, .max = {4, 8, 4}};
    const rheo_wall wall = {{0, -20, 0}, {0, 1, 0}};
    OK(rheo_scene_add_fill(&scene, &fill, &error));
    OK(rheo_scene_add_wall(&scene, &wall, &error));
    return scene;
}

static void bad_meshes_are_refused(void **unused)
{
    (void)unused;
    rheo_scene scene = block_scene();
    rheo_world *world;
    rheo_obstacle o = rheo_default_obstacle(RHEO_OBSTACLE_MESH);
    add_obstacle(&scene.world, o);
    REFUSED(RHEO_ERROR_ARGUMENT, "obstacle 0: no mesh is named", rheo_scene_check(&scene, &error));
    static const char OPEN[] = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\n";
    write_file("obstacle_open.obj", OPEN, strlen(OPEN));
    snprintf(scene.world.obstacles.list[0].file, sizeof o.file, "obstacle_open.obj");
    REFUSED(RHEO_ERROR_FORMAT, "not closed", rheo_scene_check(&scene, &error));
    REFUSED(RHEO_ERROR_FORMAT, "obstacle 0", rheo_scene_create_world(&scene, &world, &error));
    remove("obstacle_open.obj");
    REFUSED(RHEO_ERROR_ARGUMENT, "cannot read the mesh", rheo_scene_check(&scene, &error));
    rheo_scene_release(&scene);
}

/* ---- Warnings ---- */

static rheo_warning warning_of(const rheo_scene *scene, rheo_warning_kind kind, uint64_t *found)
{
    rheo_warning list[64], first = {.kind = RHEO_WARNING_EMPTY};
    size_t count;
    *found = 0;
    OK(rheo_scene_warnings(scene, list, 64, &count, &error));
    for (size_t i = 0; i < count; i++)
        if (list[i].kind == kind && !(*found)++)
            first = list[i];
    return first;
}

static void fluid_in_an_obstacle_is_warned_of(void **unused)
{
    (void)unused;
    rheo_scene scene = block_scene();
    rheo_obstacle o = rheo_default_obstacle(RHEO_OBSTACLE_BOX);
    uint64_t found;
    o.size[0] = o.size[1] = o.size[2] = 4;
    add_obstacle(&scene.world, o); /* its corners are at +-2: a layer of 2 x 1 x 2 particles is inside */
    rheo_warning w = warning_of(&scene, RHEO_WARNING_IN_OBSTACLE, &found);
    assert_int_equal(found, 1);
    assert_int_equal(w.count, 4);
    assert_int_equal(w.obstacle, 0);
    assert_int_equal(w.shape, 0);
    assert_false(w.refused);
    NEAR(w.value, 1, 1e-6);
    scene.world.obstacles.list[0].position[1] = -2; /* its top is at y = 0 */
    warning_of(&scene, RHEO_WARNING_IN_OBSTACLE, &found);
    assert_int_equal(found, 0);
    scene.world.obstacles.list[0].size[0] = scene.world.obstacles.list[0].size[1] =
        scene.world.obstacles.list[0].size[2] = 50;
    w = warning_of(&scene, RHEO_WARNING_IN_OBSTACLE, &found);
    assert_true(found == 1 && w.refused && says(w.text, "set its \"inside\" to true"));
    scene.world.obstacles.list[0].inside = RHEO_OBSTACLE_INSIDE;
    warning_of(&scene, RHEO_WARNING_IN_OBSTACLE, &found);
    assert_int_equal(found, 0);
    rheo_scene_release(&scene);
}

static void a_fast_obstacle_is_warned_of(void **unused)
{
    (void)unused;
    rheo_scene scene = block_scene();
    rheo_obstacle o = rheo_default_obstacle(RHEO_OBSTACLE_SPHERE);
    rheo_preflight preflight;
    uint64_t found;
    o.position[1] = -8;
    o.radius = 2;
    o.spin[0] = 3;
    o.velocity[2] = 4;
    add_obstacle(&scene.world, o);
    OK(rheo_scene_preflight(&scene, &preflight, &error));
    NEAR(preflight.obstacle_speed, 10, 1e-12);
    NEAR(preflight.obstacle_way, 10 * 0.033 / 4, 1e-12);
    warning_of(&scene, RHEO_WARNING_SPEED, &found);
    assert_int_equal(found, 0);
    scene.world.obstacles.list[0].velocity[2] = 400;
    const rheo_warning w = warning_of(&scene, RHEO_WARNING_SPEED, &found);
    assert_true(found == 1 && w.obstacle == 0 && w.value > 3);
    scene.world.obstacles.count = 0;
    OK(rheo_scene_preflight(&scene, &preflight, &error));
    assert_true(isnan(preflight.obstacle_speed));
    rheo_scene_release(&scene);
}

/* Fluid settles on an obstacle at rest; its motion begins at step 0, at its place. */
static void obstacles_rest_while_fluid_settles(void **unused)
{
    (void)unused;
    rheo_scene scene = block_scene();
    rheo_obstacle o = rheo_default_obstacle(RHEO_OBSTACLE_BOX);
    o.size[0] = o.size[1] = o.size[2] = 10;
    o.position[1] = -6;
    o.velocity[1] = 3;
    scene.settle.time = 1;
    add_obstacle(&scene.world, o);
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    assert_true(state_of(world, 0).position[1] == -6 && state_of(world, 0).velocity[1] == 3);
    double least = 1e9;
    for (uint32_t i = 0; i < rheo_world_particle_count(world); i++)
        least = fmin(least, distance_of(world, i));
    NEAR(least, 1, 0.01); /* half a spacing */
    rheo_world_destroy(world);
    rheo_scene_release(&scene);
}

/* ---- Views ---- */

typedef struct sum {
    const rheo_world *world;
    uint32_t index;
    double volume, farthest;
} sum;

static void add_facet(void *user, const rheo__facet *f)
{
    sum *s = user;
    const double *a = f->corner[0], *b = f->corner[1], *c = f->corner[2];
    s->volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                  a[2] * (b[0] * c[1] - b[1] * c[0])) /
                 6;
    for (int k = 0; k < 3; k++) {
        double n[3];
        const double d = rheo_world_obstacle_distance(s->world, s->index, f->corner[k], n);
        s->farthest = fmax(s->farthest, fabs(d));
    }
}

/* The corners of the triangles are on the surface, and the triangles enclose the volume of the shape. */
static void triangles_of_obstacles_are_their_surface(void **unused)
{
    (void)unused;
    static test_mesh mesh;
    const double size[3] = {2, 3, 4}, pi = 3.14159265358979;
    box_mesh(&mesh, size, 2);
    const double volume[] = {4 * pi / 3 * 8, 24, pi * 4 * 5, 24};
    for (int inside = 0; inside < 2; inside++)
        for (rheo_obstacle_shape shape = RHEO_OBSTACLE_SPHERE; shape <= RHEO_OBSTACLE_MESH; shape++) {
            rheo_world_def def = inert_def();
            rheo_obstacle o = shape == RHEO_OBSTACLE_MESH ? mesh_obstacle(&mesh) : rheo_default_obstacle(shape);
            o.inside = inside ? RHEO_OBSTACLE_INSIDE : RHEO_OBSTACLE_OUTSIDE;
            o.radius = 2;
            o.length = 5;
            memcpy(o.size, size, sizeof size);
            o.axis[0] = 1;
            o.rotation[1] = 50;
            o.position[0] = 3;
            add_obstacle(&def, o);
            rheo_world *world = world_of(def, 0, NULL, NULL);
            sum s = {.world = world};
            const uint32_t count = rheo__obstacle_facets(world, 0, add_facet, &s);
            assert_true(count > 0 && count == rheo__obstacle_facets(world, 0, NULL, NULL));
            NEAR(s.farthest, 0, 1e-12);
            const double share = (inside ? -s.volume : s.volume) / volume[shape];
            assert_true(share > 0.97 && share < 1 + 1e-12);
            rheo_world_destroy(world);
        }
}

static void pictures_show_obstacles(void **unused)
{
    (void)unused;
    const rheo_real x[3] = {0, 0, 0};
    enum { WIDTH = 64, HEIGHT = 48 };
    static unsigned char with[3 * WIDTH * HEIGHT], without[3 * WIDTH * HEIGHT];
    rheo_picture_options options = rheo_default_picture_options();
    options.width = WIDTH;
    options.height = HEIGHT;
    options.without_captions = true;
    rheo_extent extent = {{-3, -3, -3}, {3, 3, 3}, 0, 1};
    options.extent = &extent;
    for (int k = 0; k < 2; k++) {
        rheo_world_def def = inert_def();
        rheo_obstacle o = rheo_default_obstacle(RHEO_OBSTACLE_SPHERE);
        o.position[0] = 2;
        if (k)
            add_obstacle(&def, o);
        rheo_world *world = world_of(def, 1, x, NULL);
        OK(rheo_world_render(world, &options, k ? with : without, &error));
        const rheo_extent seen = rheo_world_extent(world);
        NEAR(seen.max[0], k ? 3 : 0.5, 1e-6);
        rheo_world_destroy(world);
    }
    int changed = 0;
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i += 3)
        changed += with[i] != without[i];
    assert_true(changed > WIDTH * HEIGHT / 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scene_file_has_obstacles),
        cmocka_unit_test(bad_scene_files_have_one_message),
        cmocka_unit_test(bad_meshes_are_refused),
        cmocka_unit_test(fluid_in_an_obstacle_is_warned_of),
        cmocka_unit_test(a_fast_obstacle_is_warned_of),
        cmocka_unit_test(obstacles_rest_while_fluid_settles),
        cmocka_unit_test(triangles_of_obstacles_are_their_surface),
        cmocka_unit_test(pictures_show_obstacles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
