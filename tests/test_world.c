/* Worlds: creation, refusals, hard cases, failed steps, commands. */
#include "support.h"

#include <math.h>

#include "core/hash.h"
#include "world/world.h"

/* ---- Creation ---- */

static bool has_stage(const rheo_world *world, const char *name)
{
    rheo_stage_info info;
    for (uint32_t i = 0; rheo_world_stage(world, i, &info) == RHEO_OK; i++)
        if (strcmp(info.name, name) == 0)
            return true;
    return false;
}

static bool has_field(const rheo_world *world, const char *name)
{
    rheo_field_info info;
    for (uint32_t i = 0; rheo_world_field(world, i, &info) == RHEO_OK; i++)
        if (strcmp(info.name, name) == 0)
            return true;
    return false;
}

static void a_scene_has_only_its_stages_and_fields(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    rheo_world *bare = world_of(def, 0, NULL, NULL);
    assert_int_equal(rheo_world_stage_count(bare), 3); /* substeps, gravity, prediction */
    assert_int_equal(rheo_world_field_count(bare),
                     6); /* step, origins of step and time, position, velocity, substeps */
    assert_int_equal(rheo_world_history_bytes(bare), 0);
    assert_int_equal(rheo_world_metric_count(bare), 27); /* and 10 of the ball, if there is one */
    rheo_world_destroy(bare);

    rheo_world *all = lively_world();
    const char *const stages[] = {
        "ball_push", "neighbours", "fractional_derivative", "viscosity", "substeps", "vibrators",
        "gravity",   "prediction", "ball_motion",           "densities", "forces",   "ball",
        "walls",     "history"};
    assert_int_equal(rheo_world_stage_count(all), sizeof stages / sizeof *stages);
    for (uint32_t i = 0; i < sizeof stages / sizeof *stages; i++) {
        rheo_stage_info info;
        OK(rheo_world_stage(all, i, &info));
        assert_string_equal(info.name, stages[i]);
    }
    /* Its history is a ring of velocities; it has one material, no plates, obstacles or emitters, and nothing of the other model. */
    const rheo__fields of_melting = RHEO__BIT(density) | RHEO__BIT(temperature) | RHEO__BIT(start_position) |
                                    RHEO__BIT(iterations) | RHEO__BIT(predicted_acceleration),
                       of_others = (RHEO__BIT(emitter_blocked) << 1) - RHEO__BIT(plate);
    assert_int_equal(all->state.present, (RHEO__SET_OF(RHEO__FIELD_COUNT) - 1) &
                                             ~(RHEO__BIT(history_modes) | RHEO__BIT(history_position) |
                                               RHEO__BIT(material) | of_melting | of_others));
    rheo_world_destroy(all);

    /* Removing a feature removes its stages and fields. */
    const struct {
        const char *key, *value, *stage, *field;
    } part[] = {{"history.stiffness", "0", "history", "history_velocity"},
                {"history.stiffness", "0", "fractional_derivative", "history_rows"},
                {"springs.stiffness", "0", "fractional_derivative", "spring_rest_length"},
                {"springs.stiffness", "0", "history", "history_velocity"},
                {"ball.radius", "0", "ball", "ball_position"},
                {"ball.radius", "0", "ball_motion", "ball_spin"},
                {"ball.radius", "0", "ball_push", "ball_push_phase"},
                {"ball.push", "[0, 0, 0]", "ball_push", "ball_push_phase"}};
    for (size_t i = 0; i < sizeof part / sizeof *part; i++) {
        rheo_scene scene = lively_scene();
        OK(rheo_world_def_set(&scene.world, part[i].key, part[i].value, &error));
        rheo_world *world;
        OK(rheo_scene_create_world(&scene, &world, &error));
        assert_false(has_stage(world, part[i].stage));
        assert_false(has_field(world, part[i].field));
        rheo_world_destroy(world);
    }
    rheo_scene scene = lively_scene();
    scene.world.walls.count = scene.world.vibrators.count = 0;
    scene.world.fluid.linear_viscosity = scene.world.fluid.quadratic_viscosity = 0;
    scene.world.fluid.stiffness = scene.world.fluid.near_stiffness = 0;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    assert_false(has_stage(world, "walls") || has_stage(world, "vibrators") || has_stage(world, "viscosity"));
    assert_false(has_field(world, "vibrator_phase") || has_field(world, "random"));
    rheo_world_destroy(world);
}

/* ---- Refusals ---- */

static void bad_definitions_are_refused(void **unused)
{
    (void)unused;
    rheo_world *world;
    rheo_world_def def = rheo_default_world_def();
    def.fluid.support = -1;
    REFUSED(RHEO_ERROR_ARGUMENT, "fluid.support is -1; it must be a number of at least 1e-12",
            rheo_world_create(&def, &world, &error));
    def = rheo_default_world_def();
    def.step = NAN;
    REFUSED(RHEO_ERROR_ARGUMENT, "step is", rheo_world_create(&def, &world, &error));
    def = rheo_default_world_def();
    def.history.order = 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "history.order is 1; it must be a number above 0 and below 1",
            rheo_world_create(&def, &world, &error));
    def = rheo_default_world_def();
    def.history.window = 0;
    REFUSED(RHEO_ERROR_ARGUMENT, "history.window is 0", rheo_world_create(&def, &world, &error));
    def = rheo_default_world_def();
    def.history.window_seconds = 1e9;
    REFUSED(RHEO_ERROR_ARGUMENT, "history.window", rheo_world_create(&def, &world, &error));
    def = rheo_default_world_def();
    def.walls.plane = some_walls();
    def.walls.count = 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "normal of wall 0", rheo_world_create(&def, &world, &error));
    def = rheo_default_world_def();
    def.vibrators.position = some_vibrators();
    def.vibrators.count = 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "level floor", rheo_world_create(&def, &world, &error));
    memset(&def, 0, sizeof def);
    REFUSED(RHEO_ERROR_ARGUMENT, "rheo_default_world_def", rheo_world_create(&def, &world, &error));
    def = rheo_default_world_def();
    const rheo_real position[] = {0, 0, 0, 1, INFINITY, 0};
    def.particles.count = 2;
    REFUSED(RHEO_ERROR_ARGUMENT, "particles.position is NULL", rheo_world_create(&def, &world, &error));
    def.particles.position = position;
    REFUSED(RHEO_ERROR_ARGUMENT, "position of particle 1", rheo_world_create(&def, &world, &error));
    const rheo_real good[] = {0, 0, 0, 1, 0, 0}, rest_length[] = {1, 1};
    const uint32_t ends[] = {1, 0}, twice[] = {0, 1, 0, 1};
    def.particles.position = good;
    def.particles.spring_count = 1;
    def.particles.spring_ends = ends;
    def.particles.spring_rest_length = rest_length;
    REFUSED(RHEO_ERROR_ARGUMENT, "smaller id first", rheo_world_create(&def, &world, &error));
    def.particles.spring_count = 2;
    def.particles.spring_ends = twice;
    REFUSED(RHEO_ERROR_ARGUMENT, "without repeats", rheo_world_create(&def, &world, &error));
    assert_null(world);
}

/* Worlds and scenes copy their arrays, so the caller may change or release them. */
static void arrays_are_copied_and_released(void **unused)
{
    (void)unused;
    _Static_assert(sizeof(rheo_world_def) < 16384, "definitions are small enough to be passed by value");
    rheo_world_def def = rheo_default_world_def();
    rheo_wall wall = {{0, 0, 0}, {0, 2, 0}};
    double position[1][2] = {{3, 4}};
    def.walls.plane = &wall;
    def.vibrators.position = (const double(*)[2])position;
    def.walls.count = def.vibrators.count = 1;
    rheo_world *world = world_of(def, 0, NULL, NULL);
    wall.normal[1] = -1;
    position[0][0] = 5;
    assert_true(rheo_world_definition(world)->walls.plane[0].normal[1] == 2);
    assert_true(rheo_world_definition(world)->vibrators.position[0][0] == 3);
    rheo_world_destroy(world);
    def.walls.plane = NULL;
    REFUSED(RHEO_ERROR_ARGUMENT, "walls.plane is NULL", rheo_world_create(&def, &world, &error));

    rheo_scene scene = rheo_default_scene();
    scene.world.walls.plane = &wall; /* the caller's array is copied when the scene grows */
    scene.world.walls.count = 1;
    for (uint32_t i = 1; i < RHEO_MAX_WALLS; i++)
        OK(rheo_scene_add_wall(&scene, &(rheo_wall){{i, 0, 0}, {0, 1, 0}}, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "at most 64 walls", rheo_scene_add_wall(&scene, &wall, &error));
    for (uint32_t i = 0; i < RHEO_MAX_VIBRATORS; i++)
        OK(rheo_scene_add_vibrator(&scene, i, -1.0 * i, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "at most 1024 vibrators", rheo_scene_add_vibrator(&scene, 0, 0, &error));
    for (uint32_t i = 0; i < RHEO_MAX_FILLS; i++)
        OK(rheo_scene_add_fill(&scene, &(rheo_fill){.kind = RHEO_FILL_SPHERE, .radius = i}, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "at most 64 shapes", rheo_scene_add_fill(&scene, &scene.fill[0], &error));
    assert_true(scene.world.walls.plane != &wall && scene.world.walls.plane[0].normal[1] == -1);
    assert_true(scene.world.walls.plane[63].point[0] == 63 && scene.fill[63].radius == 63);
    assert_true(scene.world.vibrators.position[1023][0] == 1023 && scene.world.vibrators.position[1023][1] == -1023);
    rheo_scene_release(&scene);
    assert_true(scene.fill_count == 0 && scene.world.walls.count == 0 && !scene.world.vibrators.position);
    rheo_scene_release(&scene);
}

/* ---- Hard cases ---- */

static void check_finite(const rheo_world *world)
{
    for (uint32_t i = 0; i < 3 * rheo_world_particle_count(world); i++)
        assert_true(isfinite((double)rheo_world_positions(world)[i]) &&
                    isfinite((double)rheo_world_velocities(world)[i]));
}

/* A scene without springs, pressure, viscosity or ball has only the stages that it needs, and runs. */
static void scenes_with_parts_missing_run(void **unused)
{
    (void)unused;
    enum { SPRINGS = 1, PRESSURE = 2, VISCOSITY = 4, BALL = 8, ALL = 16 };
    for (int missing = 0; missing < ALL; missing++)
        for (int scheme = 0; scheme < 2; scheme++) {
            rheo_scene scene = lively_scene();
            scene.world.scheme = scheme ? RHEO_SCHEME_SEQUENTIAL : RHEO_SCHEME_SUMMED;
            if (missing & SPRINGS)
                scene.world.springs.stiffness = 0;
            if (missing & PRESSURE)
                scene.world.fluid.stiffness = scene.world.fluid.near_stiffness = 0;
            if (missing & VISCOSITY)
                scene.world.fluid.linear_viscosity = scene.world.fluid.quadratic_viscosity = 0;
            if (missing & BALL)
                scene.world.ball.radius = 0;
            scene.settle.time = 0.1;
            rheo_world *world;
            OK(rheo_scene_create_world(&scene, &world, &error));
            const bool springs = !(missing & SPRINGS), pressure = !(missing & PRESSURE),
                       viscosity = !(missing & VISCOSITY), ball = !(missing & BALL), summed = !scheme;
            assert_true(has_stage(world, "neighbours") == (springs || pressure || (summed && viscosity)));
            assert_true(has_stage(world, "neighbours_start") == (!summed && viscosity));
            assert_true(has_stage(world, "viscosity") == viscosity);
            assert_true(has_stage(world, "stiffness") == (summed && springs && !viscosity));
            assert_true(has_stage(world, "history") == springs);
            assert_true(has_stage(world, "forces") == (summed && (springs || pressure)));
            assert_true(has_stage(world, "densities") == (summed && (springs || pressure)));
            assert_true(has_stage(world, "springs") == (!summed && springs));
            assert_true(has_stage(world, "density") == (!summed && pressure));
            assert_true(has_stage(world, "velocity") == !summed && has_stage(world, "substeps") == summed);
            assert_true(has_stage(world, "ball") == ball && has_stage(world, "ball_motion") == ball);
            assert_true(has_field(world, "derivative") == springs && has_field(world, "substeps") == summed);
            step(world, 10);
            check_finite(world);
            assert_true(springs == (rheo_world_spring_count(world) > 0));
            rheo_world_destroy(world);
        }
}

static void empty_world(void **unused)
{
    (void)unused;
    rheo_world *world = world_of(rheo_default_world_def(), 0, NULL, NULL);
    step(world, 5);
    assert_int_equal(rheo_world_step_count(world), 5);
    NEAR(rheo_world_time(world), 5 * 0.033, 1e-15);
    OK(rheo_world_set(world, "step", "0.25", &error));
    step(world, 3);
    NEAR(rheo_world_time(world), 5 * 0.033 + 3 * 0.25, 1e-15);
    rheo_world_destroy(world);
    rheo_scene scene = lively_scene();
    scene.fill_count = 0;
    OK(rheo_scene_create_world(&scene, &world, &error));
    step(world, 50); /* the ball alone falls onto the floor and stays */
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    NEAR(ball.position[1], 4 + 0.15, 0.5);
    rheo_world_destroy(world);
}

static void one_particle_falls(void **unused)
{
    (void)unused;
    const rheo_real position[] = {1, 2, 3};
    for (int substeps = 0; substeps < 3; substeps++) {
        rheo_world_def def = rheo_default_world_def();
        def.substeps = (uint32_t)substeps;
        rheo_world *world = world_of(def, 1, position, NULL);
        step(world, 10);
        const int count = substeps == 1 ? 10 : 20; /* two substeps, if the state sets their number */
        const double tau = 0.33 / count;
        NEAR((double)rheo_world_velocities(world)[1], -9.81 * 0.33, 1e-5);
        NEAR((double)rheo_world_positions(world)[1], 2 - 9.81 * tau * tau * count * (count + 1) / 2, 1e-5);
        assert_true(rheo_world_positions(world)[0] == 1 && rheo_world_positions(world)[2] == 3);
        rheo_world_destroy(world);
    }
}

static void coinciding_particles_separate(void **unused)
{
    (void)unused;
    rheo_real position[3 * 20] = {0};
    rheo_world_def def = rheo_default_world_def();
    memset(def.gravity, 0, sizeof def.gravity);
    rheo_world *world = world_of(def, 20, position, NULL);
    step(world, 30);
    check_finite(world);
    const rheo_real *x = rheo_world_positions(world);
    for (int a = 0; a < 20; a++)
        for (int b = 0; b < a; b++)
            assert_true(hypot((double)(x[3 * a] - x[3 * b]), hypot((double)(x[3 * a + 1] - x[3 * b + 1]),
                                                                   (double)(x[3 * a + 2] - x[3 * b + 2]))) > 0.01);
    rheo_world_destroy(world);
}

static void particles_on_a_wall_and_past_it(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def();
    def.walls.plane = some_walls();
    def.walls.count = 1;
    walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0, 2, 0}};
    rheo_real position[] = {0, 0, 0, 1, 0, 0, 0.5F, -50, 1, 10, 0, 0};
    rheo_world *world = world_of(def, 4, position, NULL);
    step(world, 100);
    check_finite(world);
    for (int i = 0; i < 4; i++)
        assert_true(rheo_world_positions(world)[3 * i + 1] >= 0);
    rheo_world_destroy(world);
}

static void count_allocation(size_t bytes, size_t *most)
{
    *most = bytes > *most ? bytes : *most;
}
static void *measuring_allocate(size_t bytes, void *user)
{
    count_allocation(bytes, user);
    return malloc(bytes);
}
static void measuring_release(void *memory, void *user)
{
    (void)user;
    free(memory);
}

static void a_particle_a_million_supports_away_costs_nothing(void **unused)
{
    (void)unused;
    size_t most[2] = {0, 0};
    for (int far = 0; far < 2; far++) {
        rheo_scene scene = lively_scene();
        scene.world.allocator = (rheo_allocator){measuring_allocate, measuring_release, &most[far]};
        rheo_world *world;
        OK(rheo_scene_create_world(&scene, &world, &error));
        rheo_real away = far ? 4e6F : 0;
        const rheo_real position[] = {8 + away, 12 + away, 8 - away};
        OK(rheo_world_add_particles(world, 1, position, NULL, &error));
        step(world, 20);
        check_finite(world);
        rheo_world_destroy(world);
    }
    assert_true(most[1] <= most[0] + most[0] / 4);
}

static void zero_gravity_and_short_and_long_windows(void **unused)
{
    (void)unused;
    for (int i = 0; i < 3; i++) {
        rheo_scene scene = lively_scene();
        if (i == 0)
            scene.world.gravity[1] = 0;
        scene.world.history.window = i == 1 ? 1 : 100000;
        fills_of(&scene)[0].max[1] = 4;
        rheo_world *world;
        OK(rheo_scene_create_world(&scene, &world, &error));
        step(world, 20);
        check_finite(world);
        assert_int_equal(rheo_world_history_rows(world), i == 1 ? 2 : 20);
        rheo_world_destroy(world);
    }
}

/* ---- Failed steps ---- */

static void a_failed_step_leaves_the_world_unchanged(void **unused)
{
    (void)unused;
    rheo_scene scene = lively_scene();
    scene.world.springs.stiffness = 37.5;
    scene.world.history.stiffness = 37.5 * 3000;
    scene.settle.time = 0;
    scene.world.scheme = RHEO_SCHEME_SEQUENTIAL; /* scheme summed softens springs */
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    rheo_result result = RHEO_OK;
    rheo_error reason;
    uint64_t hash = 0, steps = 0;
    for (int i = 0; i < 500 && result == RHEO_OK; i++) {
        hash = rheo_world_hash(world);
        steps = rheo_world_step_count(world);
        result = rheo_world_step(world, &reason);
    }
    assert_int_equal(result, RHEO_ERROR_STATE);
    assert_non_null(strstr(reason.message, "is not finite"));
    assert_non_null(strstr(reason.message, "particle"));
    assert_true(rheo_world_step_count(world) == steps && rheo_world_hash(world) == hash);
    check_finite(world);
    /* The failure repeats, and one remedy works: the world is usable. */
    assert_int_equal(rheo_world_step(world, &reason), RHEO_ERROR_STATE);
    assert_true(rheo_world_hash(world) == hash);
    OK(rheo_world_set(world, "history.stiffness", "0", &error));
    OK(rheo_world_set(world, "springs.stiffness", "1", &error));
    step(world, 1);
    rheo_world_destroy(world);
}

typedef struct failing {
    int allowed;
} failing;
static void *failing_allocate(size_t bytes, void *user)
{
    failing *f = user;
    return f->allowed-- > 0 ? malloc(bytes) : NULL;
}

/*
 * Whichever allocation fails, the call returns an error, leaks nothing (the sanitizer checks) and leaves the state
 * unchanged.
 */
static void run_out_of_memory(rheo_history_kind kind)
{
    failing f;
    int refused = 0;
    rheo_scene scene = lively_scene();
    scene.world.history.kind = kind;
    scene.world.allocator = (rheo_allocator){failing_allocate, measuring_release, &f};
    for (int allowed = 0;; allowed++) {
        f.allowed = allowed;
        rheo_world *world;
        rheo_error error;
        rheo_result result = rheo_scene_create_world(&scene, &world, &error);
        if (result == RHEO_OK) {
            rheo_world_destroy(world);
            break;
        }
        assert_int_equal(result, RHEO_ERROR_MEMORY);
        assert_null(world);
        refused++;
    }
    assert_true(refused > 50);

    f.allowed = 1 << 30;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    step(world, 2);
    rheo_real position[3 * 4000];
    for (int i = 0; i < 4000; i++) {
        position[3 * i] = (rheo_real)(i % 20);
        position[3 * i + 1] = (rheo_real)(30 + i / 400);
        position[3 * i + 2] = (rheo_real)(i / 20 % 20);
    }
    refused = 0;
    for (int allowed = 0;; allowed++) {
        uint64_t hash = rheo_world_hash(world);
        rheo_error error;
        f.allowed = allowed;
        rheo_result result = rheo_world_add_particles(world, 4000, position, NULL, &error);
        if (result == RHEO_OK)
            break;
        assert_int_equal(result, RHEO_ERROR_MEMORY);
        assert_true(rheo_world_hash(world) == hash);
        refused++;
    }
    assert_true(refused > 5);
    refused = 0;
    for (int allowed = 0;; allowed++) { /* the lists of the larger world have not grown yet */
        uint64_t hash = rheo_world_hash(world);
        rheo_error error;
        f.allowed = allowed;
        rheo_result result = rheo_world_step(world, &error);
        if (result == RHEO_OK)
            break;
        assert_int_equal(result, RHEO_ERROR_MEMORY);
        f.allowed = 1 << 30;
        assert_true(rheo_world_hash(world) == hash);
        refused++;
    }
    assert_true(refused > 3);
    rheo_world_destroy(world);
}

static void running_out_of_memory_is_an_error(void **unused)
{
    (void)unused;
    for (int kind = RHEO_HISTORY_WINDOW; kind <= RHEO_HISTORY_FULL; kind++)
        run_out_of_memory((rheo_history_kind)kind);
}

/* ---- Repeated runs ---- */

static void the_same_definition_gives_the_same_hashes(void **unused)
{
    (void)unused;
    rheo_world *a = lively_world(), *b = lively_world();
    for (int i = 0; i < 30; i++) {
        assert_true(rheo_world_hash(a) == rheo_world_hash(b));
        step(a, 1);
        step(b, 1);
    }
    rheo_world_destroy(a);
    rheo_world_destroy(b);
}

/* Every bit of every field is in the hash. */
static void the_hash_sees_every_field(void **unused)
{
    (void)unused;
    rheo_scene scene = lively_scene();
    scene.world.history.kind = RHEO_HISTORY_WINDOW_FAST;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    step(world, 3);
    uint64_t hash = rheo_world_hash(world);
    for (rheo__field_id f = 0; f <= RHEO__FIELD_history_modes; f++) { /* later fields belong to the other model */
        assert_true(rheo__state_has(&world->state, f));
        uint8_t *byte = rheo__state_values(&world->state, f);
        if (f == RHEO__FIELD_spring_rest_length)
            for (byte = (uint8_t *)world->state.springs.rest_length; *(rheo_real *)(void *)byte < 0;)
                byte += sizeof(rheo_real); /* on to a spring */
        if (f == RHEO__FIELD_history_velocity)
            byte = (uint8_t *)rheo__ring_block(&world->state.ring, 0, rheo__ring_slot(&world->state.ring, 2));
        if (f == RHEO__FIELD_history_modes)
            byte = (uint8_t *)rheo__ring_block(&world->state.modes, 0, world->state.modes.length - 1);
        if (f == RHEO__FIELD_spring_ends || f == RHEO__FIELD_history_rows)
            continue; /* random changes of these leave no valid state; tested below */
        for (int bit = 0; bit < 32; bit++) {
            byte[bit / 8] ^= (uint8_t)(1 << bit % 8);
            if (rheo_world_hash(world) == hash)
                fail_msg("no hash sees bit %d of %s", bit, rheo__field_table[f].name);
            byte[bit / 8] ^= (uint8_t)(1 << bit % 8);
        }
    }
    assert_true(rheo_world_hash(world) == hash);
    --*world->state.history_rows;
    assert_true(rheo_world_hash(world) != hash);
    ++*world->state.history_rows;
    uint32_t *id_of = world->state.springs.pairs.id_of, swap = id_of[0];
    id_of[0] = id_of[1];
    id_of[1] = swap;
    assert_true(rheo__springs_make_keys(&world->state.springs, &world->state.allocator));
    assert_true(rheo_world_hash(world) != hash);
    rheo_world_destroy(world);
}

static void hash_test_vectors(void **unused)
{
    (void)unused;
    assert_true(rheo__hash_finish(0) == 0);
    const rheo_real position[] = {1, 2, 3, -1, 0.5F, 0};
    rheo_world *world = world_of(inert_def(), 2, position, NULL);
    const uint64_t words[] = {UINT64_C(0x400000003F800000), UINT64_C(0xBF80000040400000),
                              UINT64_C(0x000000003F000000)};
    uint64_t sum = 0;
    for (uint64_t n = 0; n < 3; n++)
        sum += rheo__hash_word(0, n, words[n]);
    if (sizeof(rheo_real) == 4)
        assert_true(rheo__state_hash_field(&world->state, RHEO__FIELD_position) == rheo__hash_field(sum, 1, 2));
    rheo_world_destroy(world);
}

/* ---- Reading a world ---- */

static void fields_are_read_in_the_order_of_ids(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    step(world, 5);
    uint32_t n = rheo_world_particle_count(world), window = rheo_world_history_rows(world);
    size_t springs = rheo_world_spring_count(world);
    rheo_spring *spring = malloc(springs * sizeof *spring);
    assert_non_null(spring);
    OK(rheo_world_springs(world, spring, springs));
    assert_int_equal(rheo_world_body_count(world), 1);
    assert_int_equal(window, 5);
    rheo_field_info info;
    int seen = 0;
    for (uint32_t f = 0; rheo_world_field(world, f, &info) == RHEO_OK; f++) {
        uint8_t *values = malloc(info.bytes + 1);
        assert_non_null(values);
        OK(rheo_world_field_read(world, f, values, info.bytes));
        assert_int_equal(rheo_world_field_read(world, f, values, info.bytes - 1), RHEO_ERROR_ARGUMENT);
        if (strcmp(info.name, "position") == 0) {
            assert_true(info.items == n && info.components == 3 && info.location == RHEO_LOCATION_PARTICLE &&
                        !info.ring);
            assert_memory_equal(values, rheo_world_positions(world), info.bytes);
            seen++;
        } else if (strcmp(info.name, "spring_ends") == 0) {
            assert_int_equal(info.items, springs);
            for (size_t k = 0; k < springs; k++)
                assert_memory_equal(values + 8 * k, &spring[k], 8);
            for (size_t k = 1; k < springs; k++)
                assert_true(spring[k - 1].a < spring[k].a ||
                            (spring[k - 1].a == spring[k].a && spring[k - 1].b < spring[k].b));
            seen++;
        } else if (strcmp(info.name, "history_velocity") == 0) {
            assert_true(info.ring && info.rows == window);
            const rheo_real *ring = (const rheo_real *)(const void *)values;
            assert_memory_equal(ring, rheo_world_velocities(world), 3 * n * sizeof *ring); /* lag 0 */
            rheo_real own[3 * 11];
            OK(rheo_world_particle_history(world, n - 1, own));
            for (uint32_t lag = 0; lag < window; lag++)
                assert_memory_equal(own + 3 * lag, ring + 3 * ((size_t)lag * n + n - 1), 3 * sizeof *ring);
            seen++;
        }
        free(values);
    }
    assert_int_equal(seen, 3);
    free(spring);
    rheo_real unused_history[3 * 11];
    assert_int_equal(rheo_world_particle_history(world, n, unused_history), RHEO_ERROR_ARGUMENT);
    rheo_world_destroy(world);
}

/* ---- Commands ---- */

static void commands_change_the_world(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    rheo_body before, after;
    OK(rheo_world_body(world, 0, &before));
    const double impulse[3] = {before.mass, 0, 0},
                 top[3] = {before.position[0], before.position[1] + 4, before.position[2]};
    OK(rheo_world_push_body(world, 0, impulse, top, &error));
    OK(rheo_world_body(world, 0, &after));
    NEAR(after.velocity[0], before.velocity[0] + 1, 1e-5);
    NEAR(after.spin[2], -2.5 / 4, 1e-5); /* J x R / (2/5 M R^2) */
    OK(rheo_world_push_body(world, 0, impulse, NULL, &error));
    OK(rheo_world_body(world, 0, &after));
    NEAR(after.velocity[0], before.velocity[0] + 2, 1e-5);
    OK(rheo_world_set(world, "ball.velocity", "[0, 5, 0]", &error));
    OK(rheo_world_body(world, 0, &after));
    assert_true(after.velocity[1] == 5 && after.velocity[0] == 0);
    OK(rheo_world_set(world, "fluid.stiffness", "301", &error));
    assert_true(rheo_world_definition(world)->fluid.stiffness == 301);
    OK(rheo_world_move_vibrator(world, 1, 3, 4, &error));
    rheo_vibrator vibrator;
    OK(rheo_world_vibrator(world, 1, &vibrator));
    assert_true(vibrator.x == 3 && vibrator.z == 4);
    uint32_t n = rheo_world_particle_count(world);
    const rheo_real position[] = {8, 30, 8, 8, 32, 8};
    OK(rheo_world_add_particles(world, 2, position, NULL, &error));
    assert_int_equal(rheo_world_particle_count(world), n + 2);
    assert_true(rheo_world_positions(world)[3 * n + 4] == 32);
    size_t pending;
    rheo__world_commands(world, &pending);
    assert_int_equal(pending, 6);
    step(world, 1);
    rheo__world_commands(world, &pending);
    assert_int_equal(pending, 0);
    assert_true(rheo_world_positions(world)[3 * n + 1] + rheo_world_positions(world)[3 * n + 4] < 62);

    REFUSED(RHEO_ERROR_ARGUMENT, "no body 1", rheo_world_push_body(world, 1, impulse, NULL, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "no vibrator 2", rheo_world_move_vibrator(world, 2, 0, 0, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "cannot change", rheo_world_set(world, "history.window", "20", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "at least 1e-12", rheo_world_set(world, "fluid.support", "0", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "did you mean \"fluid.support\"?",
            rheo_world_set(world, "fluid.suport", "1", &error));
    const double endless[3] = {0, 1e300, 0}, nowhere[3] = {NAN, 0, 0};
    REFUSED(RHEO_ERROR_ARGUMENT, "finite", rheo_world_push_body(world, 0, endless, NULL, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "finite", rheo_world_push_body(world, 0, impulse, nowhere, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "1e30", rheo_world_move_vibrator(world, 0, 0, 1e300, &error));
    const rheo_real bad[] = {NAN, 0, 0};
    REFUSED(RHEO_ERROR_ARGUMENT, "not finite", rheo_world_add_particles(world, 1, bad, NULL, &error));
    rheo__world_commands(world, &pending);
    assert_int_equal(pending, 0);
    rheo_world_destroy(world);

    world = world_of(inert_def(), 0, NULL, NULL);
    REFUSED(RHEO_ERROR_ARGUMENT, "was 0 when this world was made",
            rheo_world_set(world, "fluid.stiffness", "1", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "without springs", rheo_world_set(world, "springs.stiffness", "1", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "without history", rheo_world_set(world, "history.order", "0.4", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "without a ball", rheo_world_set(world, "ball.position", "[0, 0, 0]", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "without vibrators", rheo_world_set(world, "vibrators.amplitude", "1", &error));
    rheo_world_destroy(world);
}

/* ---- Fixed bugs ---- */

/* Rest lengths that flowed too fast became negative, and files with them could not be loaded. */
static void rest_lengths_are_never_negative(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    def.springs.stiffness = 1e-20;
    def.springs.plasticity = 60;
    def.springs.rest_length = RHEO_REST_SUPPORT;
    const rheo_real position[] = {0, 0, 0, 0.5F, 0, 0};
    rheo_world *world = world_of(def, 2, position, NULL);
    for (int i = 0; i < 10; i++) {
        step(world, 1);
        rheo_spring spring;
        OK(rheo_world_springs(world, &spring, 1));
        assert_true(spring.rest_length >= 0);
    }
    rheo_world_destroy(world);
}

/*
 * No stage of a world reads an array before a stage derives it. A list without its first deriving stage violates
 * this.
 */
static void stages_read_derived_arrays_after_they_are_derived(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    rheo__stage stage[RHEO__MAX_STAGES];
    uint32_t count = 0, first = RHEO__MAX_STAGES;
    for (uint32_t i = 0; i < world->stage_count; i++) {
        if (first == RHEO__MAX_STAGES && (world->stage[i].derives & RHEO__DERIVED(pairs)))
            first = i;
        else
            stage[count++] = world->stage[i];
    }
    assert_int_equal(rheo__stages_first_premature(world->stage, world->stage_count), world->stage_count);
    assert_true(first < count);
    const uint32_t premature = rheo__stages_first_premature(stage, count);
    assert_true(premature < count && (stage[premature].reads & RHEO__DERIVED(pairs)));
    rheo_world_destroy(world);
}

/* wall_friction was 0/0 after a command set k_min to 0, and fluid froze at walls even with sticking 0. */
static void soft_springs_do_not_freeze_fluid_at_walls(void **unused)
{
    (void)unused;
    for (int i = 0; i < 2; i++) {
        rheo_world_def def = inert_def();
        def.springs.stiffness = 15;
        def.history.stiffness = 150;
        def.walls.plane = some_walls();
        def.walls.count = 1;
        walls_of(&def)[0] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
        const rheo_real position[] = {0, 0.1F, 0, 1, 0.1F, 0}, velocity[] = {1, 0, 0, 1, 0, 0};
        rheo_world *world = world_of(def, 2, position, velocity);
        step(world, 2);
        OK(rheo_world_set(world, "springs.stiffness", i ? "-0" : "0", &error));
        OK(rheo_world_set(world, "walls.sticking", "0", &error));
        step(world, 3);
        NEAR((double)rheo_world_velocities(world)[0], 1, 1e-3);
        rheo_world_destroy(world);
    }
}

static void a_huge_spin_keeps_the_orientation_a_unit_quaternion(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    def.ball.radius = 1;
    def.ball.spin[0] = 1e25;
    rheo_world *world = world_of(def, 0, NULL, NULL);
    step(world, 5);
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    double length2 = 0;
    for (int i = 0; i < 4; i++)
        length2 += ball.orientation[i] * ball.orientation[i];
    NEAR(length2, 1, 1e-5);
    rheo_world_destroy(world);
}

/* Two distant shapes made a table of columns for the whole area between them. */
static void shapes_far_apart_cost_no_memory(void **unused)
{
    (void)unused;
    size_t most = 0;
    rheo_scene scene = rheo_default_scene();
    scene.world.allocator = (rheo_allocator){measuring_allocate, measuring_release, &most};
    scene.world.ball.radius = 1;
    scene.ball.clearance = 1;
    scene.fill = some_fills();
    scene.fill_count = 2;
    for (int f = 0; f < 2; f++) {
        fills_of(&scene)[f].kind = RHEO_FILL_SPHERE;
        fills_of(&scene)[f].radius = 2;
        fills_of(&scene)[f].centre[0] = fills_of(&scene)[f].centre[2] = 39000.0 * f;
    }
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    assert_true(most < 1 << 20);
    rheo_world_destroy(world);
    fills_of(&scene)[0] = (rheo_fill){.kind = RHEO_FILL_BLOCK, .max = {1e300, 1, 1}};
    uint64_t count;
    REFUSED(RHEO_ERROR_ARGUMENT, "shape 0", rheo_scene_particle_count(&scene, &count, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "shape 0", rheo_scene_create_world(&scene, &world, &error));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scene_has_only_its_stages_and_fields),
        cmocka_unit_test(scenes_with_parts_missing_run),
        cmocka_unit_test(bad_definitions_are_refused),
        cmocka_unit_test(arrays_are_copied_and_released),
        cmocka_unit_test(empty_world),
        cmocka_unit_test(one_particle_falls),
        cmocka_unit_test(coinciding_particles_separate),
        cmocka_unit_test(particles_on_a_wall_and_past_it),
        cmocka_unit_test(a_particle_a_million_supports_away_costs_nothing),
        cmocka_unit_test(zero_gravity_and_short_and_long_windows),
        cmocka_unit_test(a_failed_step_leaves_the_world_unchanged),
        cmocka_unit_test(running_out_of_memory_is_an_error),
        cmocka_unit_test(the_same_definition_gives_the_same_hashes),
        cmocka_unit_test(the_hash_sees_every_field),
        cmocka_unit_test(hash_test_vectors),
        cmocka_unit_test(fields_are_read_in_the_order_of_ids),
        cmocka_unit_test(commands_change_the_world),
        cmocka_unit_test(rest_lengths_are_never_negative),
        cmocka_unit_test(stages_read_derived_arrays_after_they_are_derived),
        cmocka_unit_test(soft_springs_do_not_freeze_fluid_at_walls),
        cmocka_unit_test(a_huge_spin_keeps_the_orientation_a_unit_quaternion),
        cmocka_unit_test(shapes_far_apart_cost_no_memory),
    };
    return cmocka_run_group_tests_name("world", tests, NULL, NULL);
}
