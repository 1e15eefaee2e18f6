/* The estimate of the memory that a scene needs, compared with what the allocator was asked for. */
#include "support.h"

#include "world/world.h"

typedef struct counter {
    size_t now, most;
} counter;

static void *count_up(size_t bytes, void *user)
{
    counter *c = user;
    size_t *block = malloc(bytes + 64);
    if (!block)
        return NULL;
    *block = bytes;
    c->now += bytes;
    c->most = c->now > c->most ? c->now : c->most;
    return (char *)block + 64;
}

static void count_down(void *memory, void *user)
{
    size_t *block = (size_t *)(void *)((char *)memory - 64);
    ((counter *)user)->now -= *block;
    free(block);
}

static void the_estimate_is_near_the_memory_that_is_taken(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *set[4];
        uint64_t steps;
    } cases[] = {
        {"bowling-ball-small", {"particles", "6000"}, 3},
        {"bowling-ball-small", {"particles", "20000"}, 3},
        {"bowling-ball-small", {"history.window", "1000"}, 300},
        {"bowling-ball-small", {"history.window", "100000"}, 3}, /* the ring grows while it is filled */
        {"bowling-ball-small", {"history.kind", "full"}, 3},
        {"bowling-ball-small", {"history.kind", "window-fast"}, 3},
        {"bowling-ball-small", {"history.stiffness", "0"}, 3},
        {"bowling-ball-small", {"springs.stiffness", "0"}, 3},
        {"bowling-ball-small", {"scheme", "sequential"}, 3},
        {"vibration", {"particles", "8000"}, 3},
        {"melting-box", {"melting.substeps", "1"}, 1},
        {"melting-bunny-small", {"melting.substeps", "1"}, 1},
        {"chair", {"melting.substeps", "1", "particles", "4000"}, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rheo_scene scene;
        rheo_world *world;
        rheo_memory memory;
        counter c = {0};
        OK(rheo_scene_builtin(cases[i].scene, &scene, &error));
        for (int k = 0; k < 4 && cases[i].set[k]; k += 2)
            OK(rheo_scene_set(&scene, cases[i].set[k], cases[i].set[k + 1], &error));
        if (scene.settle.time > 0)
            scene.settle.time = 2 * scene.world.step;
        OK(rheo_scene_memory(&scene, cases[i].steps, &memory, &error));
        scene.world.allocator = (rheo_allocator){count_up, count_down, &c};
        OK(rheo_scene_create_world(&scene, &world, &error));
        assert_int_equal(rheo_world_particle_count(world), memory.particles);
        for (uint64_t k = 0; k < cases[i].steps; k++)
            OK(rheo_world_step(world, &error));
        rheo_world_destroy(world);
        const double ratio = memory.all / (double)c.most;
        if (getenv("SHOW"))
            print_message("%s %s=%s: %.3g\n", cases[i].scene, cases[i].set[0], cases[i].set[1], ratio);
        if (!(ratio > 0.7 && ratio < 1.4))
            fail_msg("%s, %s=%s: %.4g bytes were expected, %zu taken", cases[i].scene, cases[i].set[0],
                     cases[i].set[1], memory.all, c.most);
        assert_true(memory.history >= 0 && memory.neighbours > 0 && memory.history + memory.neighbours < memory.all);
        rheo_scene_release(&scene);
    }
}

/* What a memory takes is that of its rows, as a world has them when they are full. */
static void the_rows_of_each_memory_are_counted(void **state)
{
    (void)state;
    static const struct {
        const char *set[4];
        uint64_t rows; /* 0: as many as the world has */
    } cases[] = {
        {{"history.stiffness", "0"}, 0},
        {{"history.kind", "window", "history.window", "9"}, 10},
        {{"history.kind", "window", "history.window", "1"}, 2},
        {{"history.kind", "window-fast", "history.window", "20"}, 0},
        {{"history.kind", "tempered", "history.window", "20"}, 0},
        {{"history.kind", "full", "history.window", "20"}, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rheo_scene scene = lively_scene();
        rheo_world *world;
        scene.settle.time = 0;
        for (int k = 0; k < 4 && cases[i].set[k]; k += 2)
            OK(rheo_scene_set(&scene, cases[i].set[k], cases[i].set[k + 1], &error));
        OK(rheo_scene_create_world(&scene, &world, &error));
        for (int k = 0; k < 30; k++)
            OK(rheo_world_step(world, &error));
        uint64_t ring = 0, modes = 0;
        for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
            if (rheo__state_has(&world->state, f)) {
                ring += rheo__field_table[f].storage == RHEO__RING ? rheo__state_rows(&world->state, f) : 0;
                modes += rheo__field_table[f].storage == RHEO__MODES ? rheo__state_rows(&world->state, f) : 0;
            }
        assert_true(i > 0 ? ring + modes > 0 : ring + modes == 0);
        assert_int_equal(rheo__world_ring_rows(&world->def, world->features), ring);
        assert_int_equal(rheo__world_memory_rows(&world->def, world->features), ring + modes);
        if (cases[i].rows)
            assert_int_equal(ring + modes, cases[i].rows);
        rheo_world_destroy(world);
    }
}

static void a_scene_too_large_for_any_machine_is_estimated_at_once(void **state)
{
    (void)state;
    rheo_scene scene;
    rheo_memory memory;
    OK(rheo_scene_builtin("bowling-ball-small", &scene, &error));
    OK(rheo_scene_set(&scene, "particles", "1e9", &error));
    OK(rheo_scene_memory(&scene, scene.steps, &memory, &error));
    assert_true(memory.particles > 990000000 && memory.all > 1e15 && memory.neighbours > 0.9 * memory.all);
    rheo_scene_release(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_estimate_is_near_the_memory_that_is_taken),
        cmocka_unit_test(the_rows_of_each_memory_are_counted),
        cmocka_unit_test(a_scene_too_large_for_any_machine_is_estimated_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
