/*
 * The built-in melting scenes, run as a user runs them. They must show their effect: hot material flows, cold
 * material stays, a hot drop on a cold block solidifies, densities follow the particles.
 */
#include "melting_support.h"

static rheo_world *scene_world(const char *name)
{
    rheo_scene scene = builtin_scene(name);
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    return world;
}

/* Extreme values of a run. */
typedef struct extremes {
    double substeps, iterations, density_error, max_density_error, max_speed;
} extremes;

static extremes run(rheo_world *world, uint64_t steps)
{
    extremes worst = {0, 0, 0, 0, 0};
    for (uint64_t n = 0; n < steps; n++) {
        OK(rheo_world_step(world, &error));
        worst.substeps += metric(world, "substeps");
        worst.iterations += metric(world, "iterations");
        worst.density_error = fmax(worst.density_error, metric(world, "density_error"));
        worst.max_density_error = fmax(worst.max_density_error, metric(world, "max_density_error"));
        worst.max_speed = fmax(worst.max_speed, metric(world, "max_speed"));
    }
    return worst;
}

static double distance(const rheo_real *a, const rheo_real *b)
{
    const double x = (double)(a[0] - b[0]), y = (double)(a[1] - b[1]), z = (double)(a[2] - b[2]);
    return sqrt(x * x + y * y + z * z);
}

/* Smallest distance of two particles, in spacings. */
static double closest_pair(const rheo_world *world)
{
    const rheo_real *x = rheo_world_positions(world);
    const uint32_t count = rheo_world_particle_count(world);
    double least = INFINITY;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = 0; j < i; j++)
            if (fabs((double)(x[3 * i] - x[3 * j])) < least)
                least = fmin(least, distance(x + 3 * i, x + 3 * j));
    return least / rheo_world_definition(world)->fluid.spacing;
}

static double lowest_height(const rheo_world *world)
{
    const rheo_real *x = rheo_world_positions(world);
    double low = INFINITY;
    for (uint32_t i = 0; i < rheo_world_particle_count(world); i++)
        low = fmin(low, (double)x[3 * i + 1]);
    return low;
}

static void the_bunny_melts_from_its_ears_down(void **unused)
{
    (void)unused;
    rheo_world *world = scene_world("melting-bunny-small");
    assert_in_range(rheo_world_particle_count(world), 2300, 2500);
    const double heat = metric(world, "heat"), hot = metric(world, "hot_height"), cold = metric(world, "cold_height");
    extremes first = run(world, 125), last;
    assert_true(fabs(rheo_world_time(world) - 2.5) < 1e-9);
    assert_true(metric(world, "hot_height") < hot - 0.3);
    last = run(world, 125);
    assert_true(first.substeps + last.substeps > 3000);
    assert_true(fmax(first.max_density_error, last.max_density_error) < 8e-2);
    assert_true(fmax(first.density_error, last.density_error) < 1e-2);
    assert_true(metric(world, "cold_displacement") < 0.01);
    assert_true(fabs(metric(world, "cold_height") - cold) < 0.01);
    assert_true(metric(world, "hot_height") < 0.25);
    assert_true(fabs(metric(world, "heat") / heat - 1) < (RHEO_DOUBLE ? 1e-12 : 1e-5));
    assert_true(closest_pair(world) > 0.5);
    assert_true(lowest_height(world) >= 0);
    rheo_world_destroy(world);
}

/* The same test with the large bunny. It ends when the ears bend, to save time. */
static void the_large_bunny_begins_as_the_small_one(void **unused)
{
    (void)unused;
    rheo_world *world = scene_world("melting-bunny");
    assert_in_range(rheo_world_particle_count(world), 9700, 9900);
    const double hot = metric(world, "hot_height");
    const extremes worst = run(world, 40);
    assert_true(worst.max_density_error < 8e-2 && worst.density_error < 1e-2);
    assert_true(metric(world, "hot_height") < hot - 0.1);
    assert_true(metric(world, "cold_displacement") < 0.002);
    assert_true(lowest_height(world) >= 0);
    rheo_world_destroy(world);
}

/*
 * Mean displacement of particles that began below 0.7, in an object of uniform temperature. The bunny's ears are
 * higher. They are three particles thick, and the load at their roots exceeds the yield stress, so they bend even
 * when cold.
 */
static double mean_displacement(const char *name, double temperature)
{
    rheo_scene scene = builtin_scene(name);
    rheo_world *world;
    fills_of(&scene)[0].has_temperature = false;
    scene.world.melting.temperature = temperature;
    OK(rheo_scene_create_world(&scene, &world, &error));
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) /* isothermal: no temperatures are stored */
        assert_true(f != RHEO__FIELD_temperature || !rheo__state_has(&world->state, f));
    run(world, 125);
    double sum = 0;
    uint32_t count = 0;
    for (size_t i = 0; i < rheo_world_particle_count(world); i++)
        if (world->state.start_position[3 * i + 1] < (rheo_real)0.7) {
            sum += distance(world->state.position + 3 * i, world->state.start_position + 3 * i);
            count++;
        }
    rheo_world_destroy(world);
    return sum / count;
}

static void hot_flows_and_cold_stays(void **unused)
{
    (void)unused;
    const char *const names[] = {"melting-box", "melting-bunny-small"};
    for (size_t i = 0; i < 2; i++) {
        const double hot = mean_displacement(names[i], 1), cold = mean_displacement(names[i], 0);
        print_message("%s, displacement, all hot against all cold: %.3g and %.3g, %.0f times\n", names[i], hot, cold,
                      hot / cold);
        assert_true(hot > 50 * cold && hot > 0.2);
    }
}

static void everything_liquid_runs_out(void **unused)
{
    (void)unused;
    rheo_world *world = scene_world("melting-all");
    const extremes worst = run(world, 50);
    assert_true(metric(world, "hot_height") < 0.6);
    assert_true(worst.max_density_error < 0.2);
    assert_true(lowest_height(world) >= 0);
    rheo_world_destroy(world);
}

/*
 * Fig. 2 of Paiva et al., where an ear touches the body: hot material that falls on cold material cools and
 * solidifies.
 */
static void a_hot_drop_on_a_cold_block_solidifies(void **unused)
{
    (void)unused;
    rheo_world *world = scene_world("melting-drop");
    const uint32_t count = rheo_world_particle_count(world);
    const rheo__state *s = &world->state;
    const double melts = world->def.melting.temperature_min;
    double heat = metric(world, "heat"), hottest = 0;
    uint32_t drop = 0, solid = 0;
    run(world, 250);
    double speed = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (!(s->start_position[3 * i + 1] > (rheo_real)0.4))
            continue;
        drop++;
        hottest = fmax(hottest, (double)s->temperature[i]);
        if ((double)s->temperature[i] < melts) {
            solid++;
            speed =
                fmax(speed,
                     sqrt((double)rheo__length2(s->velocity[3 * i], s->velocity[3 * i + 1], s->velocity[3 * i + 2])));
        }
    }
    print_message("%u of %u particles of the drop are solid, and move at %.3g at most; the hottest has %.3g\n", solid,
                  drop, speed, hottest);
    assert_true(drop > 200);
    assert_true(solid > drop / 3);
    assert_true(speed < 0.02);
    assert_true(fabs(metric(world, "heat") / heat - 1) < (RHEO_DOUBLE ? 1e-12 : 1e-5));
    rheo_world_destroy(world);
}

/*
 * Root mean square difference of the density from positions and the integrated density. Counts particles whose
 * support is full of fluid: the gradient of the density is small, and no wall is near.
 */
static double drift(const rheo_world *world)
{
    const rheo__state *s = &world->state;
    const double h = rheo__melting_of(world)->smoothing_length;
    double squares = 0;
    uint32_t inside = 0;
    for (uint32_t i = 0; i < s->particles; i++) {
        const density_sums sums = sums_at(world, i);
        const double *edge = sums.gradient;
        bool near_wall = false;
        for (uint32_t w = 0; w < world->planes.count; w++) {
            const rheo_real *x = s->position + 3 * i;
            near_wall = near_wall || (double)rheo__plane_distance(&world->planes.plane[w], x[0], x[1], x[2]) < 3 * h;
        }
        if (near_wall || h * sqrt(edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2]) > 0.05 ||
            sums.density < 0.8)
            continue;
        inside++;
        squares += pow(sums.density / (double)s->density[i] - 1, 2);
    }
    assert_true(inside > 50);
    return sqrt(squares / inside);
}

/* A column of liquid collapses in a box, 5000 substeps long. */
static void densities_follow_the_particles(void **unused)
{
    (void)unused;
    rheo_scene scene = rheo_default_model_scene(RHEO_MODEL_MELTING);
    rheo_world_def *def = &scene.world;
    scene.fill = some_fills();
    scene.fill_count = 1;
    fills_of(&scene)[0].kind = RHEO_FILL_BLOCK;
    memcpy(fills_of(&scene)[0].max, (const double[]){0.6, 1.2, 0.6}, sizeof fills_of(&scene)[0].max);
    def->fluid.spacing = 0.05;
    def->melting.temperature = 1;
    const rheo_wall walls[] = {{{0, 0, 0}, {0, 1, 0}},
                               {{0, 0, 0}, {1, 0, 0}},
                               {{0.9, 0, 0}, {-1, 0, 0}},
                               {{0, 0, 0}, {0, 0, 1}},
                               {{0, 0, 0.6}, {0, 0, -1}}};
    def->walls.plane = some_walls();
    def->walls.count = 5;
    memcpy(walls_of(def), walls, sizeof walls);
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    double substeps = 0;
    while (substeps < 5000)
        substeps += run(world, 25).substeps;
    const double found = drift(world);
    print_message("summed against integrated density: %.2f %% rms after %.0f substeps\n", 100 * found, substeps);
    assert_true(found < 0.015);
    for (uint32_t i = 0; i < world->state.particles; i++) /* a change is noticed */
        world->state.density[i] *= (rheo_real)1.05;
    assert_true(drift(world) > 0.04);
    rheo_world_destroy(world);
}

static void letters_and_the_chair_run(void **unused)
{
    (void)unused;
    const char *const names[] = {"melting-logo", "chair"};
    for (size_t i = 0; i < 2; i++) {
        rheo_world *world = scene_world(names[i]);
        const double hot = metric(world, "hot_height");
        const extremes worst = run(world, 20);
        assert_true(worst.max_density_error < 8e-2);
        assert_true(metric(world, "hot_height") < hot - 0.02);
        assert_true(metric(world, "cold_displacement") < 0.005);
        rheo_world_destroy(world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_bunny_melts_from_its_ears_down),
        cmocka_unit_test(the_large_bunny_begins_as_the_small_one),
        cmocka_unit_test(hot_flows_and_cold_stays),
        cmocka_unit_test(everything_liquid_runs_out),
        cmocka_unit_test(a_hot_drop_on_a_cold_block_solidifies),
        cmocka_unit_test(densities_follow_the_particles),
        cmocka_unit_test(letters_and_the_chair_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
