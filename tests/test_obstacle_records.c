/* Obstacles in recordings, commands, accounts and checks of definitions. */
#include "obstacles.h"
#include "resume.h"
#include "why.h"

#include "record/bytes.h"

#define PATH "obstacle_records.rlog"
enum { MOST = 500, SIDE = 5 };

static test_mesh mesh;

/* A block of fluid that falls on a turning box, a swinging mesh and a wall, with a ball. */
static rheo_world_def lively_def(rheo_real *position, bool with_mesh)
{
    rheo_world_def def = rheo_default_world_def();
    static const rheo_wall wall = {{0, -9, 0}, {0, 1, 0}};
    const double size[3] = {4, 4, 4};
    def.history.window = 4;
    def.walls.count = 1;
    def.walls.plane = &wall;
    def.ball.radius = 2;
    def.ball.position[1] = 12;
    def.ball.velocity[1] = -20;
    rheo_obstacle box = box_obstacle(9, 3, 2);
    box.position[1] = -3;
    box.rotation[0] = 10;
    box.spin[1] = 3;
    add_obstacle(&def, box);
    if (with_mesh) {
        box_mesh(&mesh, size, 1);
        rheo_obstacle o = mesh_obstacle(&mesh);
        o.position[1] = -8;
        o.position[0] = 5;
        o.amplitude[0] = 1;
        o.frequency = 2;
        add_obstacle(&def, o);
    }
    uint32_t n = 0;
    obstacle_seed = 5;
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++, n++) {
        position[3 * n] = (rheo_real)(2.0 * (i % SIDE) - 4 + 0.1 * random_signed());
        position[3 * n + 1] = (rheo_real)(2.0 * (i / SIDE % SIDE) + 0.1 * random_signed());
        position[3 * n + 2] = (rheo_real)(2.0 * (i / SIDE / SIDE) - 4 + 0.1 * random_signed());
    }
    def.particles.count = n;
    def.particles.position = position;
    return def;
}

static rheo_world *make(const rheo_world_def *def)
{
    rheo_world *world;
    OK(rheo_world_create(def, &world, &error));
    return world;
}

/* ---- Recordings ---- */

static void a_run_goes_on_from_any_step(void **unused)
{
    (void)unused;
    rheo_real x[3 * MOST];
    static const char *const names[] = {"summed", "sequential", "positions"};
    for (int k = 0; k < 6; k++) {
        rheo_world_def def = lively_def(x, k % 2);
        def.scheme = (rheo_scheme)(k / 2);
        resume_every_step(make(&def), 12, PATH, names[k / 2]);
        rheo_verification v;
        OK(rheo_verify(PATH, &v, &error));
        assert_int_equal(v.verdict, RHEO_SAME);
        remove(PATH);
    }
}

/* Files without meshes stay those that older programs read, or refuse because of a parameter. */
static void only_meshes_need_a_new_version_of_the_format(void **unused)
{
    (void)unused;
    rheo_real x[3 * MOST];
    for (int with_mesh = 0; with_mesh < 2; with_mesh++) {
        const rheo_world_def def = lively_def(x, with_mesh);
        rheo_world *world = make(&def);
        void *bytes;
        size_t size;
        OK(rheo_world_save_memory(world, "", &bytes, &size, &error));
        rheo_recording *r;
        OK(rheo_recording_open_memory(bytes, size, &r, &error));
        rheo_world *again;
        OK(rheo_recording_world(r, 0, NULL, &again, &error));
        assert_true(rheo_world_hash(again) == rheo_world_hash(world));
        const rheo_world_def *read = rheo_world_definition(again);
        assert_int_equal(read->obstacles.count, 1 + with_mesh);
        if (with_mesh) {
            assert_int_equal(read->obstacles.list[1].mesh.triangle_count, mesh.triangles);
            assert_memory_equal(read->obstacles.list[1].mesh.vertex, mesh.vertex,
                                mesh.vertices * sizeof *mesh.vertex);
        }
        rheo_world_destroy(again);
        rheo_recording_close(r);
        rheo_world_destroy(world);
        free(bytes);
    }
}

static void commands_are_recorded(void **unused)
{
    (void)unused;
    static const struct {
        int before;
        const char *path, *value;
    } SET[] = {{2, "obstacles.0.velocity", "[1, 2, 3]"},
               {3, "obstacles.0.spin", "[0, 0, 5]"},
               {3, "obstacles.1.frequency", "3.5"},
               {5, "obstacles.1.amplitude", "[0, 1, 0]"},
               {6, "obstacles.0.position", "[0, -4, 0]"},
               {6, "obstacles.0.rotation", "[0, 45, 0]"},
               {7, "walls.sticking", "10"}};
    rheo_real x[3 * MOST];
    rheo_world_def def = lively_def(x, true);
    def.walls.count = 0; /* obstacles have sticking, too */
    rheo_world *world = make(&def);
    rheo_recorder *recorder;
    const rheo_record_options options = {.scene = "commands", .keyframe_spacing = 4};
    OK(rheo_recorder_open_memory(world, &options, &recorder, &error));
    const rheo_real more[3] = {0, 15, 0};
    for (int s = 1; s <= 10; s++) {
        for (size_t i = 0; i < sizeof SET / sizeof *SET; i++)
            if (SET[i].before == s)
                OK(rheo_world_set(world, SET[i].path, SET[i].value, &error));
        if (s == 4)
            OK(rheo_world_add_particles(world, 1, more, NULL, &error));
        OK(rheo_recorder_step(recorder, &error));
    }
    const uint64_t hash = rheo_world_hash(world);
    recorded r = reopen(recorder, world);
    rheo_world *last;
    OK(rheo_recording_world(r.recording, 10, NULL, &last, &error));
    assert_true(rheo_world_hash(last) == hash);
    NEAR(state_of(last, 0).velocity[1], 2, 0);
    rheo_world_destroy(last);
    assert_int_equal(rheo_recording_command_count(r.recording), 8);
    discard(&r);
}

/* A step that fails leaves the obstacles where they were. */
static void a_failed_step_is_undone(void **unused)
{
    (void)unused;
    rheo_real x[3 * MOST];
    rheo_world_def def = lively_def(x, true);
    def.scheme = RHEO_SCHEME_SEQUENTIAL;
    rheo_world *world = make(&def);
    step(world, 3);
    OK(rheo_world_set(world, "springs.stiffness", "1e30", &error));
    rheo_error error;
    int steps = 0;
    rheo_obstacle_state before[2], after;
    uint64_t hash;
    do {
        hash = rheo_world_hash(world);
        before[0] = state_of(world, 0);
        before[1] = state_of(world, 1);
    } while (rheo_world_step(world, &error) == RHEO_OK && ++steps < 20);
    assert_true(steps < 20);
    assert_true(rheo_world_hash(world) == hash);
    for (uint32_t k = 0; k < 2; k++) {
        after = state_of(world, k);
        assert_memory_equal(after.position, before[k].position, sizeof after.position);
        assert_memory_equal(after.rotation, before[k].rotation, sizeof after.rotation);
        assert_true(after.phase == before[k].phase);
    }
    rheo_world_destroy(world);
}

/* ---- Accounts ---- */

static void accounts_of_obstacles_are_exact(void **unused)
{
    (void)unused;
    rheo_real x[3 * MOST];
    for (rheo_scheme scheme = RHEO_SCHEME_SUMMED; scheme <= RHEO_SCHEME_POSITIONS; scheme++) {
        rheo_world_def def = lively_def(x, true);
        def.scheme = scheme;
        rheo_world *world = make(&def);
        rheo_recorder *recorder = record_in_memory(world);
        for (int s = 0; s < 14; s++)
            OK(rheo_recorder_step(recorder, &error));
        uint32_t touching[16], count = 0; /* particles at an obstacle */
        for (uint32_t id = 0; id < def.particles.count && count < 16; id++)
            if (distance_of(world, id) < 1.01)
                touching[count++] = id;
        recorded r = reopen(recorder, world);
        told t = {.of = "obstacles"};
        for (uint32_t i = 0; i < count; i++)
            check_particle(r.player, 14, touching[i], &t);
        assert_true(count > 0 && t.by[RHEO_SOURCE_OBSTACLE] >= count);
        discard(&r);
    }
    assert_string_equal(rheo_source_name(RHEO_SOURCE_OBSTACLE), "obstacle");
    assert_string_equal(rheo_source_item(RHEO_SOURCE_OBSTACLE), "obstacle");
}

/* ---- Bad input ---- */

static void bad_obstacles_are_refused(void **unused)
{
    (void)unused;
    const struct {
        const char *path, *value, *says;
    } BAD[] = {
        {"obstacles.0.radius", "0", "obstacle 0: its radius must be above 0"},
        {"obstacles.1.size", "[1, 0, 1]", "obstacle 1: each component of size must be above 0"},
        {"obstacles.2.length", "0", "obstacle 2: radius and length must be above 0"},
        {"obstacles.2.axis", "[0, 0, 0]", "obstacles.2.axis is [0, 0, 0]; it must be a vector other than zero"},
        {"obstacles.0.inside", "true", "obstacle 0 has the fluid inside, where it must leave room"},
        {"space.period", "[90, 0, 0]", "which an obstacle does not support"},
        {"model", "", ""}};
    for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++) {
        rheo_world_def def = rheo_default_world_def();
        for (rheo_obstacle_shape shape = RHEO_OBSTACLE_SPHERE; shape < RHEO_OBSTACLE_MESH; shape++)
            add_obstacle(&def, rheo_default_obstacle(shape));
        OK(rheo_world_def_check(&def, &error));
        if (strcmp(BAD[i].path, "model") == 0) {
            rheo_world_def other = rheo_default_model_def(RHEO_MODEL_MELTING);
            other.obstacles = def.obstacles;
            other.obstacles.count = 1;
            REFUSED(RHEO_ERROR_ARGUMENT, "the model melting has no obstacles", rheo_world_def_check(&other, &error));
            continue;
        }
        OK(rheo_world_def_set(&def, BAD[i].path, BAD[i].value, &error));
        REFUSED(RHEO_ERROR_ARGUMENT, BAD[i].says, rheo_world_def_check(&def, &error));
    }
    rheo_world_def def = rheo_default_world_def();
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no such obstacle; 0 are given",
            rheo_world_def_set(&def, "obstacles.0.radius", "1", &error));
    add_obstacle(&def, rheo_default_obstacle(RHEO_OBSTACLE_SPHERE));
    REFUSED(RHEO_ERROR_ARGUMENT, "an obstacle of shape sphere has no such parameter; it has: shape, position, radius",
            rheo_world_def_set(&def, "obstacles.0.size", "[1, 1, 1]", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no such obstacle; 1 are given",
            rheo_world_def_set(&def, "obstacles.1.radius", "1", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no such obstacle",
            rheo_world_def_set(&def, "obstacles.00.radius", "1", &error));
    for (uint32_t i = 1; i < RHEO_MAX_OBSTACLES; i++)
        add_obstacle(&def, rheo_default_obstacle(RHEO_OBSTACLE_SPHERE));
    REFUSED(RHEO_ERROR_ARGUMENT, "a world has at most 16 obstacles",
            rheo_world_def_add_obstacle(&def, &def.obstacles.list[0], &error));
    rheo_world *world = make(&def);
    REFUSED(RHEO_ERROR_ARGUMENT, "obstacles.15.radius is fixed when a world is made",
            rheo_world_set(world, "obstacles.15.radius", "2", &error));
    rheo_world_destroy(world);
    def.obstacles.count = 1;
    def.obstacles.list[0] = rheo_default_obstacle(RHEO_OBSTACLE_MESH);
    REFUSED(RHEO_ERROR_ARGUMENT, "the mesh of obstacle 0 has no triangles", rheo_world_create(&def, &world, &error));
    const double size[3] = {1, 1, 1};
    box_mesh(&mesh, size, 1);
    def.obstacles.list[0] = mesh_obstacle(&mesh);
    def.obstacles.list[0].mesh.triangle_count--;
    REFUSED(RHEO_ERROR_ARGUMENT, "the mesh of obstacle 0 is not closed", rheo_world_create(&def, &world, &error));
    def.obstacles.list[0].mesh.triangle_count = RHEO_MAX_OBSTACLE_TRIANGLES + 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "at most 200000 and 200000 are possible", rheo_world_def_check(&def, &error));
}

/* Every parameter of an obstacle is set from text, and reads back. */
static void parameters_have_paths(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def();
    const size_t without = rheo_world_def_parameter_count(&def);
    for (rheo_obstacle_shape shape = RHEO_OBSTACLE_SPHERE; shape <= RHEO_OBSTACLE_MESH; shape++)
        add_obstacle(&def, rheo_default_obstacle(shape));
    const size_t count = rheo_world_def_parameter_count(&def);
    const rheo_parameter *p;
    size_t listed = 0;
    for (uint32_t k = 0; k < 4; k++)
        for (size_t i = 0; (p = rheo_obstacle_parameter_at(i)); i++)
            listed += rheo_obstacle_has_parameter((rheo_obstacle_shape)k, p);
    assert_int_equal(count - without, listed);
    for (size_t i = without; i < count; i++) {
        char value[96];
        p = rheo_world_def_parameter_at(&def, i);
        assert_ptr_equal(rheo_world_def_parameter_find(&def, p->path), p);
        assert_int_equal(rheo_world_def_get(&def, p->path, value, sizeof value), RHEO_OK);
        OK(rheo_world_def_set(&def, p->path, value, &error));
    }
    assert_null(rheo_world_def_parameter_at(&def, count));
    size_t index = 0;
    char a[96], b[96];
    rheo_world_def other = def;
    assert_null(rheo_world_def_differing(&def, &other, &index, a, b));
    index = 0;
    other.obstacles.list[2].length = 3;
    p = rheo_world_def_differing(&def, &other, &index, a, b);
    assert_string_equal(p->path, "obstacles.2.length");
    assert_string_equal(b, "3");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_goes_on_from_any_step),
        cmocka_unit_test(only_meshes_need_a_new_version_of_the_format),
        cmocka_unit_test(commands_are_recorded),
        cmocka_unit_test(a_failed_step_is_undone),
        cmocka_unit_test(accounts_of_obstacles_are_exact),
        cmocka_unit_test(bad_obstacles_are_refused),
        cmocka_unit_test(parameters_have_paths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
