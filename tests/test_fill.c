/* Shapes filled with particles: letters, meshes, temperatures and densities. */
#include "mesh_support.h"

#include "scenes/fill.h"
#include "scenes/lattice.h"
#include "scenes/letters.h"

/* ---- Tests: letters ---- */

/* Particles of a scene with one shape. */
typedef struct filled {
    uint64_t count;
    rheo_real *position, *velocity, *density, *temperature;
    double spacing;
} filled;

static filled fill_scene(const rheo_scene *scene)
{
    static rheo__filling filling;
    OK(rheo__filling_open(&filling, scene, &error));
    filled f = {.count = filling.count, .spacing = filling.spacing};
    f.position = calloc(f.count + 1, 3 * sizeof *f.position);
    f.velocity = calloc(f.count + 1, 3 * sizeof *f.velocity);
    f.density = calloc(f.count + 1, sizeof *f.density);
    f.temperature = calloc(f.count + 1, sizeof *f.temperature);
    assert_true(f.position && f.velocity && f.density && f.temperature);
    OK(rheo__filling_make(&filling, f.position, f.velocity, f.density, f.temperature, NULL, &error));
    uint64_t counted;
    OK(rheo_scene_particle_count(scene, &counted, &error));
    assert_int_equal(counted, f.count);
    rheo__filling_close(&filling);
    return f;
}

static void release(filled *f)
{
    free(f->position);
    free(f->velocity);
    free(f->density);
    free(f->temperature);
}

static rheo_scene scene_of(rheo_fill fill)
{
    rheo_scene scene = rheo_default_model_scene(RHEO_MODEL_MELTING);
    scene.fill = some_fills();
    scene.fill_count = 1;
    fills_of(&scene)[0] = fill;
    scene.world.fluid.spacing = 1;
    return scene;
}

/* A block has a particle more along an axis from half a spacing on. */
static void half_a_spacing_is_rounded_up(void **unused)
{
    (void)unused;
    static const double SIZE[][3] = {{2, 3, 4}, {2.5, 3.5, 4.5}, {2.4375, 1.5625, 3}, {.5, .5, .5}};
    static const uint64_t COUNT[][3] = {{2, 3, 4}, {3, 4, 5}, {2, 2, 3}, {1, 1, 1}};
    for (size_t i = 0; i < sizeof SIZE / sizeof *SIZE; i++) {
        rheo_scene scene = scene_of((rheo_fill){.kind = RHEO_FILL_BLOCK, .min = {-1, 0, 2}});
        for (int a = 0; a < 3; a++)
            fills_of(&scene)[0].max[a] = fills_of(&scene)[0].min[a] + SIZE[i][a];
        filled f = fill_scene(&scene);
        assert_int_equal(f.count, COUNT[i][0] * COUNT[i][1] * COUNT[i][2]);
        for (size_t a = 0; a < 3; a++)
            NEAR((double)f.position[3 * (f.count - 1) + a], fills_of(&scene)[0].min[a] + (double)COUNT[i][a] - .5,
                 1e-6);
        release(&f);
    }
}

static void letters_have_a_particle_per_dot(void **unused)
{
    (void)unused;
    rheo_scene scene = scene_of(
        (rheo_fill){.kind = RHEO_FILL_LETTERS, .name = "LT", .height = 7, .depth = 2, .position = {1, 2, 3}});
    filled f = fill_scene(&scene);
    assert_int_equal(f.count, 2 * (7 + 4 + 5 + 6));
    /* Eleven dots wide: -4.5 to 6.5. Two dots deep: 2 to 4. The foot of the L is in the lowest row. */
    uint64_t i = 0;
    for (int z = 0; z < 2; z++)
        for (int y = 0; y < 7; y++)
            for (int x = 0; x < 11; x++) {
                bool foot = y == 0, top = y == 6;
                bool set = x < 5 ? x == 0 || foot : x > 5 && (x == 8 || top);
                if (!set)
                    continue;
                const double expected[3] = {-4 + x, 2.5 + y, 2.5 + z};
                for (int axis = 0; axis < 3; axis++)
                    NEAR((double)f.position[3 * i + axis], expected[axis], 1e-6);
                i++;
            }
    assert_int_equal(i, f.count);
    release(&f);
    /* Three particles per dot along each axis. */
    scene.world.fluid.spacing = 1. / 3;
    uint64_t count;
    OK(rheo_scene_particle_count(&scene, &count, &error));
    assert_int_equal(count, 2 * 27 * (7 + 4 + 5 + 6));
    /* All letters exist and all differ. */
    static const char all[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.,!?-+=:/";
    uint8_t dots[sizeof all][RHEO__LETTER_ROWS][RHEO__LETTER_ADVANCE];
    for (size_t a = 0; a + 1 < sizeof all; a++) {
        const char text[2] = {all[a], 0};
        int set = 0;
        OK(rheo__letters_check(text, &error));
        for (size_t row = 0; row < RHEO__LETTER_ROWS; row++) {
            rheo__letters_row(text, row, dots[a][row]);
            for (int k = 0; k < RHEO__LETTER_ADVANCE; k++)
                set += dots[a][row][k];
            assert_int_equal(dots[a][row][RHEO__LETTER_COLUMNS], 0);
        }
        assert_true(set >= 4 && set < 25);
        for (size_t b = 0; b < a; b++)
            assert_true(memcmp(dots[a], dots[b], sizeof dots[a]) != 0);
        /* Two dots that touch only at a corner would separate, so a third one joins them. */
        for (size_t row = 1; row < RHEO__LETTER_ROWS; row++)
            for (size_t k = 1; k < RHEO__LETTER_COLUMNS; k++) {
                uint8_t(*d)[RHEO__LETTER_ADVANCE] = dots[a];
                assert_true(!d[row][k] || !d[row - 1][k - 1] || d[row][k - 1] || d[row - 1][k]);
                assert_true(!d[row][k - 1] || !d[row - 1][k] || d[row][k] || d[row - 1][k - 1]);
            }
    }
    strcpy(fills_of(&scene)[0].name, "A B");
    OK(rheo_scene_check(&scene, &error));
    static const char *const bad[][2] = {{"Ab#a#", "for: b#a; there are"},
                                         {"A\xc3\xbc", "for: \xc3\xbc; there are"},
                                         {"\033", "for: ?;"},
                                         {"", "the text is empty"}};
    for (size_t i2 = 0; i2 < sizeof bad / sizeof *bad; i2++) {
        strcpy(fills_of(&scene)[0].name, bad[i2][0]);
        REFUSED(RHEO_ERROR_ARGUMENT, bad[i2][1], rheo_scene_check(&scene, &error));
    }
    memset(fills_of(&scene)[0].name, 'W', sizeof fills_of(&scene)[0].name - 1);
    fills_of(&scene)[0].name[sizeof fills_of(&scene)[0].name - 1] = 0;
    OK(rheo_scene_check(&scene, &error));
    memset(fills_of(&scene)[0].name, 'W', sizeof fills_of(&scene)[0].name);
    REFUSED(RHEO_ERROR_ARGUMENT, "shape 0", rheo_scene_check(&scene, &error));
}

/* Each missing letter is listed once, and none by halves: a letter of several bytes was repeated, and cut. */
static void missing_letters_are_listed_once_and_whole(void **unused)
{
    (void)unused;
#define TEN(text) text text text text text text text text text text
    static const char *const LISTED[][2] = {
        {"ab#ba#b#", "ab#"},
        {"\xe2\x82\xac"
         "A"
         "\xe2\x82\xac",
         "\xe2\x82\xac"},
        {"\xc3\xa9\xc3\xa8\xc3\xa9", "\xc3\xa9\xc3\xa8"},
        {"\1\1\2\x7f", "???"},
        {"abcdefghijklmnopqrstuvwxyz", "abcdefghijklmnopqrstuvw"}, /* room for 23 */
        {"abcdefghijklmnopqrst\xe2\x82\xac", "abcdefghijklmnopqrst\xe2\x82\xac"},
        {"abcdefghijklmnopqrstu\xe2\x82\xac"
         "z",
         "abcdefghijklmnopqrstuz"}, /* no half of a letter */
        {"\xe2" TEN("\x82") TEN("\x82") TEN("\x82"), ""}};
#undef TEN
    for (size_t i = 0; i < sizeof LISTED / sizeof *LISTED; i++) {
        rheo_error why;
        char expected[128];
        assert_int_equal(rheo__letters_check(LISTED[i][0], &why), RHEO_ERROR_ARGUMENT);
        snprintf(expected, sizeof expected, "there is no letter for: %s; there are (with a blank):", LISTED[i][1]);
        if (strncmp(why.message, expected, strlen(expected)) != 0)
            fail_msg("\"%s\" does not begin with \"%s\"", why.message, expected);
        for (const char *c = strchr(why.message, ':') + 1; *c; c++)
            if (*c >= 'A' && *c <= 'Z')
                assert_true(c[1] == *c + 1 || *c == 'Z');
    }
    OK(rheo__letters_check("THE 0123456789", &error));
}

/* A box from a file has the same particles as a block of its size. */
static void a_mesh_from_a_file_is_placed_and_scaled(void **unused)
{
    (void)unused;
    char name[64];
    snprintf(name, sizeof name, "test_mesh_%d.obj", RHEO_DOUBLE);
    write_text(name, cube_text);
    for (int height = 0; height <= 6; height += 3) {
        double side = height ? height : 2;
        rheo_scene mesh = scene_of((rheo_fill){.kind = RHEO_FILL_MESH,
                                               .height = height,
                                               .position = {10, -5, 3},
                                               .velocity = {1, 2, 3},
                                               .jitter = 0.25});
        rheo_scene block = scene_of((rheo_fill){.kind = RHEO_FILL_BLOCK,
                                                .min = {10 - side / 2, -5, 3 - side / 2},
                                                .max = {10 + side / 2, -5 + side, 3 + side / 2},
                                                .velocity = {1, 2, 3},
                                                .jitter = 0.25});
        snprintf(fills_of(&mesh)[0].name, sizeof fills_of(&mesh)[0].name, "%s", name);
        mesh.fill_count = block.fill_count = 2; /* both from the same file */
        fills_of(&mesh)[1] = fills_of(&mesh)[0];
        fills_of(&block)[1] = fills_of(&block)[0];
        filled a = fill_scene(&mesh), b = fill_scene(&block);
        assert_int_equal(a.count, 2 * (int)(side * side * side));
        assert_int_equal(b.count, a.count);
        for (size_t i = 0; i < 3 * a.count; i++)
            NEAR((double)a.position[i], (double)b.position[i], 1e-5);
        assert_memory_equal(a.velocity, b.velocity, 3 * a.count * sizeof *a.velocity);
        release(&a);
        release(&b);
    }
    /* Checking and counting report faults of a file. */
    rheo_scene scene = scene_of((rheo_fill){.kind = RHEO_FILL_MESH});
    uint64_t count;
    double spacing;
    rheo_world *world;
    snprintf(fills_of(&scene)[0].name, sizeof fills_of(&scene)[0].name, "%s", name);
    write_text(name, CUBE_VERTICES "f 1 2 3\n");
    REFUSED(RHEO_ERROR_FORMAT, "shape 0: test_mesh_", rheo_scene_check(&scene, &error));
    REFUSED(RHEO_ERROR_FORMAT, "3 open edges", rheo_scene_particle_count(&scene, &count, &error));
    REFUSED(RHEO_ERROR_FORMAT, "3 open edges", rheo_scene_spacing(&scene, &spacing, &error));
    REFUSED(RHEO_ERROR_FORMAT, "3 open edges", rheo_scene_create_world(&scene, &world, &error));
    remove(name);
    REFUSED(RHEO_ERROR_ARGUMENT, name, rheo_scene_check(&scene, &error));
    fills_of(&scene)[0].name[0] = 0;
    REFUSED(RHEO_ERROR_ARGUMENT, "no mesh is named", rheo_scene_check(&scene, &error));
    fills_of(&scene)[0] = (rheo_fill){.kind = RHEO_FILL_MESH, .name = "bunny", .height = 1e6};
    REFUSED(RHEO_ERROR_ARGUMENT, "a mesh has at most 65536 along an axis", rheo_scene_check(&scene, &error));
    fills_of(&scene)[0].height = 2000;
    REFUSED(RHEO_ERROR_ARGUMENT, "2^30", rheo_scene_check(&scene, &error));
    fills_of(&scene)[0].height = -1;
    REFUSED(RHEO_ERROR_ARGUMENT, "height", rheo_scene_check(&scene, &error));
    fills_of(&scene)[0].height = 1;
    fills_of(&scene)[0].position[1] = __builtin_nan("");
    REFUSED(RHEO_ERROR_ARGUMENT, "position", rheo_scene_check(&scene, &error));
    fills_of(&scene)[0].kind = (rheo_fill_kind)9;
    REFUSED(RHEO_ERROR_ARGUMENT, "kind 9", rheo_scene_check(&scene, &error));
}

static void the_bunny_is_placed_at_its_position(void **unused)
{
    (void)unused;
    rheo_scene scene =
        scene_of((rheo_fill){.kind = RHEO_FILL_MESH, .name = "bunny", .height = 1, .position = {4, 2, -3}});
    scene.world.fluid.spacing = 0.02;
    filled f = fill_scene(&scene);
    double low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9};
    for (size_t i = 0; i < 3 * f.count; i++) {
        double x = (double)f.position[i];
        low[i % 3] = x < low[i % 3] ? x : low[i % 3];
        high[i % 3] = x > high[i % 3] ? x : high[i % 3];
    }
    NEAR(low[1], 2.01, 1e-5);
    NEAR(high[1], 3, 0.03);
    NEAR((low[0] + high[0]) / 2, 4, 0.02);
    NEAR((low[2] + high[2]) / 2, -3, 0.02);
    release(&f);
}

static void shapes_have_temperatures_and_densities(void **unused)
{
    (void)unused;
    rheo_scene scene = scene_of((rheo_fill){.kind = RHEO_FILL_BLOCK, .max = {2, 5, 3}, .jitter = 0.2});
    scene.world.melting.temperature = 0.25;
    scene.world.melting.rest_density = 2;
    scene.world.gravity[0] = 0.5;
    scene.world.gravity[1] = -3;
    scene.fill_count = 3;
    fills_of(&scene)[1] = fills_of(&scene)[2] = fills_of(&scene)[0];
    fills_of(&scene)[1].has_temperature = true;
    fills_of(&scene)[1].temperature[0] = 0.1;
    fills_of(&scene)[1].temperature[1] = 0.9;
    fills_of(&scene)[1].max[0] = 4;
    fills_of(&scene)[2].not_hydrostatic = true;
    fills_of(&scene)[2].has_temperature = true;
    fills_of(&scene)[2].temperature[0] = fills_of(&scene)[2].temperature[1] = 0.3;
    filled f = fill_scene(&scene);
    assert_int_equal(f.count, 30 + 60 + 30);
    double low = 1e9, high = -1e9, top[2] = {1e9, 1e9}, least[2] = {1e9, 1e9};
    for (size_t i = 0; i < 90; i++) {
        const rheo_real *x = f.position + 3 * i;
        double along = 0.5 * (double)x[0] - 3 * (double)x[1], y = (double)x[1];
        size_t shape = i >= 30;
        top[shape] = along < top[shape] ? along : top[shape];
        least[shape] = (double)f.density[i] < least[shape] ? (double)f.density[i] : least[shape];
        low = shape && y < low ? y : low;
        high = shape && y > high ? y : high;
    }
    assert_true(least[0] == 2 && least[1] == 2);
    double coldest = 1, hottest = 0;
    for (size_t i = 0; i < 120; i++) {
        const rheo_real *x = f.position + 3 * i;
        double along = 0.5 * (double)x[0] - 3 * (double)x[1], t = (double)f.temperature[i];
        double temperature = i < 30 ? 0.25 : i >= 90 ? 0.3 : 0.1 + 0.8 * ((double)x[1] - low) / (high - low);
        NEAR((double)f.density[i], i >= 90 ? 2 : 2 + 2 * (along - top[i >= 30]) / 100, 1e-6);
        NEAR(t, temperature, 1e-6);
        assert_true(i < 90 || f.temperature[i] == (rheo_real)0.3);
        coldest = t < coldest ? t : coldest;
        hottest = t > hottest ? t : hottest;
    }
    assert_true(coldest == (double)(rheo_real)0.1 && hottest == (double)(rheo_real)0.9);
    release(&f);
    fills_of(&scene)[1].temperature[1] = __builtin_inf();
    REFUSED(RHEO_ERROR_ARGUMENT, "shape 1: temperature must be finite; got inf", rheo_scene_check(&scene, &error));
    /* No shape has a temperature, so the world is isothermal. */
    static rheo__filling filling;
    fills_of(&scene)[1].has_temperature = false;
    OK(rheo__filling_open(&filling, &scene, &error));
    assert_true(filling.has_temperatures);
    rheo__filling_close(&filling);
    fills_of(&scene)[2].has_temperature = false;
    OK(rheo__filling_open(&filling, &scene, &error));
    assert_false(filling.has_temperatures);
    rheo__filling_close(&filling);
    /* Members of the other model are refused. */
    rheo_scene other = rheo_default_scene();
    other.fill = some_fills();
    other.fill_count = 1;
    fills_of(&other)[0] = (rheo_fill){.kind = RHEO_FILL_SPHERE, .radius = 4, .has_temperature = true};
    REFUSED(RHEO_ERROR_ARGUMENT, "shape 0: temperature is for the model melting", rheo_scene_check(&other, &error));
    fills_of(&other)[0].has_temperature = false;
    fills_of(&other)[0].not_hydrostatic = true;
    REFUSED(RHEO_ERROR_ARGUMENT, "hydrostatic is for the model melting", rheo_scene_check(&other, &error));
    fills_of(&scene)[2].not_hydrostatic = false;
    scene.settle.time = 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "settle.time", rheo_scene_check(&scene, &error));
    scene.settle.time = 0;
    scene.ball.clearance = 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "ball.clearance", rheo_scene_check(&scene, &error));
}

static void the_spacing_follows_from_a_number_of_particles(void **unused)
{
    (void)unused;
    rheo_scene scene = scene_of((rheo_fill){.kind = RHEO_FILL_MESH, .name = "bunny", .height = 1});
    double first = 0, second = 0;
    uint64_t count;
    static const uint64_t wanted[] = {10, 100, 2381, 9836, 100000};
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        for (int begin = 0; begin < 2; begin++) {
            scene.world.fluid.spacing = begin ? 1e-3 : 5; /* starts too fine, and too coarse */
            scene.particles = wanted[i];
            OK(rheo_scene_spacing(&scene, begin ? &second : &first, &error));
            OK(rheo_scene_particle_count(&scene, &count, &error));
            NEAR((double)count, (double)wanted[i], 1 + 2e-3 * (double)wanted[i]);
            /* The number of particles is the requested one. */
            rheo_scene plain = scene;
            uint64_t filled_by_it;
            plain.particles = 0;
            plain.world.fluid.spacing = begin ? second : first;
            OK(rheo_scene_particle_count(&plain, &filled_by_it, &error));
            assert_int_equal(filled_by_it, count);
            double again;
            OK(rheo_scene_spacing(&scene, &again, &error));
            assert_true(again == (begin ? second : first));
        }
    NEAR(first, second, 1e-2 * first);
    /* The block has exactly the requested number, and the world has the matching spacing. */
    rheo_scene pool = rheo_default_scene();
    pool.fill = some_fills();
    pool.fill_count = 1;
    fills_of(&pool)[0] = (rheo_fill){.kind = RHEO_FILL_BLOCK, .max = {10, 10, 10}};
    pool.particles = 125;
    rheo_world *world;
    OK(rheo_scene_create_world(&pool, &world, &error));
    assert_int_equal(rheo_world_particle_count(world), 125);
    assert_true(rheo_world_definition(world)->fluid.spacing > 10 / 5.5);
    assert_true(rheo_world_definition(world)->fluid.spacing < 10 / 4.5);
    rheo_world_destroy(world);
    /* The block holds 64 or 125 particles; the nearer number is chosen wherever the bisection ends. */
    for (pool.particles = 64; pool.particles <= 125; pool.particles++) {
        OK(rheo_scene_particle_count(&pool, &count, &error));
        assert_int_equal(count, pool.particles < 95 ? 64 : 125);
    }
    pool.particles = 0;
    OK(rheo_scene_spacing(&pool, &first, &error));
    assert_true(first == 2);
    /* There is nothing to fill. */
    pool.particles = 10;
    fills_of(&pool)[0].max[1] = 0;
    REFUSED(RHEO_ERROR_ARGUMENT, "empty", rheo_scene_spacing(&pool, &first, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "empty", rheo_scene_check(&pool, &error));
    pool.fill_count = 0;
    REFUSED(RHEO_ERROR_ARGUMENT, "empty", rheo_scene_check(&pool, &error));
    pool.particles = (UINT64_C(1) << 30) + 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "at most 1073741824", rheo_scene_check(&pool, &error));
}

static void every_failed_allocation_is_an_error(void **unused)
{
    (void)unused;
    failing f = {0, 0};
    const rheo_allocator allocator = {failing_allocate, failing_release, &f};
    int most = 0;
    rheo_result result = RHEO_ERROR_MEMORY;
    for (; result != RHEO_OK; most++) {
        rheo__mesh mesh;
        rheo_error error = {""};
        f.left = most;
        result = rheo__mesh_read(&mesh, &allocator, cube_text, strlen(cube_text), "a.obj", &error);
        if (result == RHEO_OK)
            rheo__mesh_release(&mesh);
        else
            assert_true(result == RHEO_ERROR_MEMORY && strstr(error.message, "no memory"));
        assert_int_equal(f.held, 0);
    }
    assert_true(most > 3);
    write_text("test_mesh_memory.ply", ply_text);
    rheo_scene scene = scene_of((rheo_fill){.kind = RHEO_FILL_MESH, .name = "test_mesh_memory.ply", .height = 4});
    scene.world.allocator = allocator;
    scene.fill_count = 2;
    fills_of(&scene)[1] = (rheo_fill){.kind = RHEO_FILL_MESH, .name = "bunny", .height = 5};
    result = RHEO_ERROR_MEMORY;
    for (most = 0; result != RHEO_OK; most++) {
        uint64_t count;
        rheo_error error = {""};
        f.left = most;
        result = rheo_scene_particle_count(&scene, &count, &error);
        assert_true(result == RHEO_OK || (result == RHEO_ERROR_MEMORY && strstr(error.message, "no memory")));
        assert_true((count > 0) == (result == RHEO_OK));
        assert_int_equal(f.held, 0);
    }
    assert_true(most > 12);
    remove("test_mesh_memory.ply");
}

/* Bytes in use, and the most so far. */
typedef struct use {
    size_t now, most;
} use;

enum { USE_HEAD = 64 };

static void *counting_allocate(size_t bytes, void *user)
{
    use *u = user;
    char *memory = malloc(bytes + USE_HEAD);
    assert_non_null(memory);
    memcpy(memory, &bytes, sizeof bytes);
    u->now += bytes;
    u->most = u->now > u->most ? u->now : u->most;
    return memory + USE_HEAD;
}

static void counting_release(void *memory, void *user)
{
    size_t bytes;
    memcpy(&bytes, (char *)memory - USE_HEAD, sizeof bytes);
    ((use *)user)->now -= bytes;
    free((char *)memory - USE_HEAD);
}

/* Large scenes need the memory of one world, also while they are made. */
static void a_settled_scene_is_not_in_memory_twice(void **unused)
{
    (void)unused;
    use u = {0, 0};
    rheo_error error;
    rheo_scene scene;
    rheo_world *world;
    assert_int_equal(rheo_scene_builtin("bowling-ball-small", &scene, &error), RHEO_OK);
    scene.world.allocator = (rheo_allocator){counting_allocate, counting_release, &u};
    scene.world.history.window = 4;
    scene.settle.time = .2;
    assert_int_equal(rheo_scene_create_world(&scene, &world, &error), RHEO_OK);
    const size_t while_made = u.most;
    for (int step = 0; step < 8; step++)
        assert_int_equal(rheo_world_step(world, &error), RHEO_OK);
    if (while_made > u.now + u.now / 8)
        fail_msg("%zu bytes while the scene is made, %zu after a few steps", while_made, u.now);
    rheo_world_destroy(world);
    rheo_scene_release(&scene);
    assert_int_equal(u.now, 0);
}

/* Quarters below and above zero against integers that are counted. */
static void numbers_are_rounded_to_integers(void **unused)
{
    (void)unused;
    static const int HALF_UP[] = {-2, -2, -1, -1, -1, -1, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2},
                     UP[] = {-2, -1, -1, -1, -1, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2};
    for (int i = 0; i < 17; i++) {
        assert_int_equal(rheo__round_half_up(0.25 * i - 2), HALF_UP[i]);
        assert_int_equal(rheo__round_up(0.25 * i - 2), UP[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(letters_have_a_particle_per_dot),
        cmocka_unit_test(half_a_spacing_is_rounded_up),
        cmocka_unit_test(numbers_are_rounded_to_integers),
        cmocka_unit_test(missing_letters_are_listed_once_and_whole),
        cmocka_unit_test(a_mesh_from_a_file_is_placed_and_scaled),
        cmocka_unit_test(the_bunny_is_placed_at_its_position),
        cmocka_unit_test(shapes_have_temperatures_and_densities),
        cmocka_unit_test(the_spacing_follows_from_a_number_of_particles),
        cmocka_unit_test(every_failed_allocation_is_an_error),
        cmocka_unit_test(a_settled_scene_is_not_in_memory_twice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
