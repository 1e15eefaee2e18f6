/* Hard cases that take long: 1e5 steps at rest, a deep stack that comes to rest, many coinciding particles, large pools poured in. */
#include "counting.h"
#include "hard.h"

/* ---- 1e5 steps at rest ---- */

/* Means over a block of steps. */
typedef struct means {
    double energy, kinetic, centre[3], springs;
} means;

static means mean_of(rheo_world *world, rheo_recorder *recorder, int steps)
{
    means m = {0};
    static const char *const axis[] = {"centre_x", "centre_y", "centre_z"};
    for (int t = 0; t < steps; t++) {
        OK(rheo_recorder_step(recorder, &error));
        m.energy += metric(world, "energy") / steps;
        m.kinetic += metric(world, "kinetic_energy") / steps;
        for (int a = 0; a < 3; a++)
            m.centre[a] += metric(world, axis[a]) / steps;
        m.springs += metric(world, "springs") / steps;
    }
    assert_finite(world);
    return m;
}

/*
 * A pool with history rests for 1e5 steps, 55 minutes of its time, and is recorded within a limit of bytes. It does not heat, wander,
 * compact or lose springs, the memory of the world does not grow, and the file keeps to its limit.
 */
static void rest_for_100000_steps(void **unused)
{
    (void)unused;
    enum { BLOCK = 5000, BLOCKS = 20 };
    rheo_scene scene = pool_scene(5, 4, 5);
    scene.world.ball.radius = 0;
    scene.settle.time = 20;
    scene.world.allocator = (rheo_allocator){count_allocate, count_release, NULL};
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    const double n = rheo_world_particle_count(world);
    const rheo_record_options options = {.max_bytes = UINT64_C(200) << 20};
    rheo_recorder *recorder;
    OK(rheo_recorder_open(world, "test_hard_rest.rlog", &options, &recorder, &error));
    means first = {0}, last = {0};
    double hottest = 0;
    size_t bytes = 0, most_bytes = 0;
    for (int k = 0; k < BLOCKS; k++) {
        last = mean_of(world, recorder, BLOCK);
        if (k == 0) {
            first = last;
            bytes = bytes_in_use;
        }
        most_bytes = bytes_in_use > most_bytes ? bytes_in_use : most_bytes;
        hottest = fmax(hottest, last.kinetic / n);
    }
    OK(rheo_recorder_close(recorder, &error));
    size_t size;
    free(read_file("test_hard_rest.rlog", &size));
    remove("test_hard_rest.rlog");
    const double moved = sqrt(square(last.centre[0] - first.centre[0]) + square(last.centre[1] - first.centre[1]) +
                              square(last.centre[2] - first.centre[2]));
    print_message(
        "energy %g to %g a particle, of motion %g to %g (most %g), centre moved by %g, springs %g to %g, bytes %zu to %zu, "
        "file %zu\n",
        first.energy / n, last.energy / n, first.kinetic / n, last.kinetic / n, hottest, moved, first.springs,
        last.springs, bytes, most_bytes, size);
    const double spacing = scene.world.fluid.spacing;
    NEAR(last.energy, first.energy, 1e-4 * n * 9.81 * spacing); /* the fall of all by 1e-4 spacings */
    assert_true(hottest < 0.5 * square(1e-3));                  /* rms 0.001 L/T; sound has 57 L/T */
    assert_true(moved < 1e-4 * spacing);
    NEAR(last.springs, first.springs, 0.001 * first.springs);
    assert_true(most_bytes <= bytes + 4096); /* lists of other lengths */
    assert_true(size <= options.max_bytes);
    rheo_world_destroy(world);
    assert_true(bytes_in_use == 0);
}

/* ---- A stack of 100 layers at rest ---- */

/*
 * Without friction at the walls the pressure at each height carries the weight above it; the fluid is denser towards the floor, and
 * the top comes to rest at most where it was made.
 */
static void a_stack_of_100_layers_carries_its_weight(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def();
    set(&def, "walls.sticking", "0");
    box_walls(&def, 12, 1000, 12);
    rheo_real *x = reals(3 * 3600);
    lattice(&def, 6, 100, 6, (double[]){0, 0, 0}, x);
    rheo_world *world = world_of(def, 3600, x, NULL);
    free(x);
    drive_all(world, 2500);
    double carried = 0;
    for (int t = 0; t < 20; t++) { /* over a swing */
        step(world, 25);
        carried += weight_carried(world, 50) / 20;
    }
    print_message("carries %g of the weight, density %g, speed %g, centre at %g\n", carried,
                  metric(world, "max_density"), metric(world, "max_speed"), metric(world, "centre_y"));
    NEAR(carried, 1, 0.05);
    assert_true(metric(world, "max_speed") < 3 && metric(world, "max_density") < 1.6);
    rheo_world_destroy(world);
}

/* ---- More of what the short tests have ---- */

static void four_thousand_coinciding_particles_part(void **unused)
{
    (void)unused;
    enum { N = 4000 };
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world_def def = rheo_default_world_def();
        memset(def.gravity, 0, sizeof def.gravity);
        set(&def, "scheme", scheme_name(scheme));
        rheo_real *x = reals(3 * N);
        rheo_world *world = world_of(def, N, x, NULL);
        const course c = drive_all(world, 100);
        print_message("%s: fastest %g\n", scheme_name(scheme), c.fastest);
        assert_true(c.fastest > 0 && c.fastest < def.step * (N - 1.0) * (N - 1) * 800);
        rheo_world_destroy(world);
        free(x);
    }
}

/* A built-in scene: a ball at 10 and 100 times its speed. */
static void the_built_in_ball_at_100_times_its_speed(void **unused)
{
    (void)unused;
    rheo_scene scene = builtin_scene("bowling-ball-small");
    settled s = settle(&scene);
    for (int k = 0; k < 2; k++) {
        rheo_world_def def = s.def;
        def.ball.velocity[1] = k ? -1700 : -170;
        rheo_world *world = start(&def);
        const course c = drive_all(world, 300);
        print_message("%g L/T: fastest %g, energy %g of %g, %g substeps, at the end %g\n", def.ball.velocity[1],
                      c.fastest, c.most, c.begin, c.substeps, metric(world, "max_speed"));
        assert_true(c.fastest <= 2 * fabs(def.ball.velocity[1]) && c.most <= c.begin * 1.001);
        assert_true(metric(world, "max_speed") < 10);
        rheo_world_destroy(world);
    }
    release(&s);
}

/* Full memory under steady shear for 10000 steps: see test_hard_springs.c. */
static void a_full_memory_under_long_shear(void **unused)
{
    (void)unused;
    rheo_scene scene = builtin_scene("plates");
    fills_of(&scene)[0].max[0] = fills_of(&scene)[0].max[2] = scene.world.space.period[0] =
        scene.world.space.period[2] = 6 * scene.world.fluid.spacing;
    set(&scene.world, "history.kind", "full");
    set(&scene.world, "history.stiffness", "15000");
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    double fastest = 0, moved = 0;
    for (int k = 0; k < 10; k++) {
        const course c = drive_all(world, 1000);
        fastest = fmax(fastest, c.fastest);
        moved = fmax(moved, metric(world, "max_spring_displacement"));
    }
    print_message("fastest %g, displacement by springs %g, sum of kappa before softening %g\n", fastest, moved,
                  metric(world, "stiffness_sum"));
    assert_true(metric(world, "stiffness_sum") > 2 && moved < 0.1 && fastest < 57);
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rest_for_100000_steps),
        cmocka_unit_test(a_stack_of_100_layers_carries_its_weight),
        cmocka_unit_test(four_thousand_coinciding_particles_part),
        cmocka_unit_test(the_built_in_ball_at_100_times_its_speed),
        cmocka_unit_test(a_full_memory_under_long_shear),
    };
    return cmocka_run_group_tests_name("hard_long", tests, NULL, NULL);
}
