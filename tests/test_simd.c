/*
 * Every SIMD variant that this machine can run against the scalar one. State and metrics are the same after every
 * step, to the last bit, in scenes with each kind of physics and in cases with idle lanes.
 */
#include "support.h"

#include "space/near.h"
#include "thickening/margins.h"
#include "world/world.h"

static bool has_several_kernels(void)
{
    return rheo_simd_available(1) != NULL;
}

/* Names the first step in which two worlds differ, and the metric if one differs. */
static void assert_alike(const rheo_world *world, const rheo_world *reference, const char *kernels, const char *scene)
{
    unsigned long long at = rheo_world_step_count(world);
    if (rheo_world_hash(world) != rheo_world_hash(reference))
        fail_msg("%s, step %llu: SIMD variant %s has another state than the scalar one", scene, at, kernels);
    for (uint32_t i = 0; i < rheo_world_metric_count(world); i++) {
        double a = rheo_world_metric(world, i), b = rheo_world_metric(reference, i);
        if (memcmp(&a, &b, sizeof a) != 0)
            fail_msg("%s, step %llu: %s is %.17g with SIMD variant %s, %.17g with the scalar one", scene, at,
                     rheo_world_metric_name(world, i), a, kernels, b);
    }
}

/* Runs two worlds made by the same call side by side, and destroys them. */
static void compare(rheo_world *(*make)(int variant), int variant, int steps, const char *scene)
{
    const char *kernels;
    for (uint32_t i = 0; (kernels = rheo_simd_available(i)); i++) {
        OK(rheo_use_simd("scalar", &error));
        rheo_world *reference = make(variant);
        OK(rheo_use_simd(kernels, &error));
        rheo_world *world = make(variant);
        assert_alike(world, reference, kernels, scene);
        for (int s = 0; s < steps; s++) {
            OK(rheo_use_simd("scalar", &error));
            step(reference, 1);
            OK(rheo_use_simd(kernels, &error));
            step(world, 1);
            assert_alike(world, reference, kernels, scene);
        }
        rheo_world_destroy(world);
        rheo_world_destroy(reference);
    }
}

enum {
    LIVELY,
    FORCE,
    NO_HISTORY,
    IMPLICIT,
    IMPLICIT_NO_HISTORY,
    NO_SPRINGS,
    STICKING_OFF,
    SHUT_OFF_VISCOSITY,
    WINDOW_FAST,
    WINDOW_FAST_OF_ONE,
    FULL,
    FULL_L1,
    TEMPERED,
    POSITIONS,
    POSITIONS_NO_HISTORY,
    VARIANTS
};

static rheo_world *make_lively(int variant)
{
    rheo_scene scene = lively_scene();
    if (variant == FORCE)
        scene.world.vibrators.kind = RHEO_VIBRATOR_FORCE;
    if (variant == POSITIONS || variant == POSITIONS_NO_HISTORY)
        scene.world.scheme = RHEO_SCHEME_POSITIONS;
    if (variant == NO_HISTORY || variant == IMPLICIT_NO_HISTORY || variant == POSITIONS_NO_HISTORY)
        scene.world.history.stiffness = 0;
    if (variant == IMPLICIT || variant == IMPLICIT_NO_HISTORY)
        scene.world.springs.solver = RHEO_SOLVER_IMPLICIT;
    if (variant == NO_SPRINGS)
        scene.world.springs.stiffness = scene.world.history.stiffness = 0;
    if (variant == STICKING_OFF)
        scene.world.walls.sticking = 0;
    if (variant == SHUT_OFF_VISCOSITY)
        scene.world.fluid.linear_viscosity = scene.world.fluid.quadratic_viscosity = 0;
    if (variant == WINDOW_FAST || variant == WINDOW_FAST_OF_ONE)
        scene.world.history.kind = RHEO_HISTORY_WINDOW_FAST;
    if (variant == WINDOW_FAST_OF_ONE)
        scene.world.history.window = 1;
    if (variant == FULL || variant == FULL_L1)
        scene.world.history.kind = RHEO_HISTORY_FULL;
    if (variant == FULL_L1)
        scene.world.history.weights = RHEO_WEIGHTS_L1;
    if (variant == TEMPERED)
        scene.world.history.kind = RHEO_HISTORY_TEMPERED;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    return world;
}

static void all_kinds_of_scenes(void **unused)
{
    (void)unused;
    for (int variant = LIVELY; variant < VARIANTS; variant++)
        compare(make_lively, variant, 25, "a lively scene");
}

static uint64_t seed;
static double random_unit(void)
{
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(seed >> 11) / 9007199254740992.0;
}

/*
 * Clouds of `variant` particles, starting at 0: rows without partners, lines of one particle, fewer lines than lanes.
 * Some particles coincide, some are far away, some have a velocity of -0.
 */
static rheo_world *make_cloud_of(int variant, rheo_scheme scheme)
{
    enum { MOST = 300 };
    static rheo_real position[3 * MOST], velocity[3 * MOST];
    assert_true(variant <= MOST);
    seed = (uint64_t)variant;
    double size = 1 + random_unit() * 4;
    for (int i = 0; i < variant; i++)
        for (int axis = 0; axis < 3; axis++) {
            double place = size * (2 * random_unit() - 1) + (i % 17 == 3 ? 1e5 : 0);
            position[3 * i + axis] = i % 5 == 1 ? position[3 * (i - 1) + axis] : (rheo_real)place;
            velocity[3 * i + axis] = i % 3 ? (rheo_real)(random_unit() - 0.5) : (rheo_real)-0.0;
        }
    rheo_world_def def = rheo_default_world_def();
    def.scheme = scheme;
    def.fluid.support = 1.5;
    def.fluid.spacing = 0.75;
    def.fluid.stiffness = 30;
    def.fluid.near_stiffness = 50;
    def.history.window = 6;
    def.history.kind = (rheo_history_kind)(variant % 4);
    def.history.lag = (uint32_t)(variant % 5);
    return world_of(def, (uint32_t)variant, position, velocity);
}

static rheo_world *make_cloud(int variant)
{
    return make_cloud_of(variant, RHEO_SCHEME_SUMMED);
}

static rheo_world *make_cloud_of_positions(int variant)
{
    return make_cloud_of(variant, RHEO_SCHEME_POSITIONS);
}

static void clouds_of_few_particles(void **unused)
{
    (void)unused;
    for (int particles = 0; particles < 40; particles++)
        compare(make_cloud, particles, 9, "a cloud");
    for (int particles = 296; particles < 300; particles++) /* each history kind */
        compare(make_cloud, particles, 20, "a cloud of 300");
    for (int particles = 0; particles < 300; particles += particles < 40 ? 3 : 64)
        compare(make_cloud_of_positions, particles, 9, "a cloud in scheme positions");
}

/* The SIMD variant leaves no trace, so it may change from step to step. */
static void the_simd_variant_may_change_between_steps(void **unused)
{
    (void)unused;
    OK(rheo_use_simd("scalar", &error));
    rheo_world *reference = make_lively(LIVELY), *world = make_lively(LIVELY);
    uint32_t count = 0;
    while (rheo_simd_available(count))
        count++;
    for (uint32_t s = 0; s < 24; s++) {
        OK(rheo_use_simd("scalar", &error));
        step(reference, 1);
        OK(rheo_use_simd(rheo_simd_available(s % count), &error));
        step(world, 1);
        assert_alike(world, reference, "changing", "a lively scene");
    }
    rheo_world_destroy(world);
    rheo_world_destroy(reference);
}

static void the_best_simd_variant_is_the_default(void **unused)
{
    (void)unused;
    uint32_t last = 0;
    while (rheo_simd_available(last + 1))
        last++;
    assert_string_equal(rheo_simd(), rheo_simd_available(last));
    assert_string_equal(rheo_simd_available(0), "scalar");
    assert_null(rheo_simd_available(last + 2));
}

static void unknown_simd_variants_are_refused(void **unused)
{
    (void)unused;
    const char *before = rheo_simd();
    REFUSED(RHEO_ERROR_ARGUMENT, "there is no SIMD variant \"avx1024\" on this machine; choose one of: scalar",
            rheo_use_simd("avx1024", &error));
    assert_string_equal(rheo_simd(), before);
}

/* The comparison notices a change of one bit. */
/* The set of particles near a point, for every number of them, against the plain comparison. */
static void particles_near_a_point(void **unused)
{
    (void)unused;
    static rheo__near_function *const variants[] = RHEO__ALL_VARIANTS(near);
    const rheo_real centre[3] = {RHEO__R(.5), RHEO__R(.25), RHEO__R(-1)}, reach2 = RHEO__R(.4);
    const char *name;
    rheo_real x[3 * RHEO__NEAR_AT_ONCE];
    uint64_t random = 1, found = 0;
    for (size_t i = 0; i < 3 * RHEO__NEAR_AT_ONCE; i++) {
        random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        x[i] = centre[i % 3] + (rheo_real)(random >> 40) / (1 << 24) - RHEO__R(.5);
    }
    x[15] = centre[0] + rheo__sqrt(reach2); /* about on the border */
    x[16] = centre[1];
    x[17] = centre[2];
    for (uint32_t v = 0; (name = rheo_simd_available(v)); v++) {
        OK(rheo_use_simd(name, &error));
        for (uint32_t count = 0; count <= RHEO__NEAR_AT_ONCE; count++) {
            uint64_t expected = 0;
            for (uint32_t i = 0; i < count; i++)
                expected |= (uint64_t)(rheo__length2(x[3 * i] - centre[0], x[3 * i + 1] - centre[1],
                                                     x[3 * i + 2] - centre[2]) < reach2)
                            << i;
            assert_int_equal(variants[rheo__simd_in_use()](x, count, centre, reach2), expected);
            found |= expected;
        }
    }
    assert_true(found != 0 && found != UINT64_MAX);
}

static void one_bit_is_seen(void **unused)
{
    (void)unused;
    rheo_world *a = make_lively(LIVELY), *b = make_lively(LIVELY);
    uint32_t bits;
    memcpy(&bits, &b->state.position[300], sizeof bits);
    bits ^= 1;
    memcpy(&b->state.position[300], &bits, sizeof bits);
    assert_true(rheo_world_hash(a) != rheo_world_hash(b));
    rheo_world_destroy(a);
    rheo_world_destroy(b);
}

/* Margins of each variant: every particle counts, and nothing behind the last one. Particles are 10 apart. */
static void each_margin_counts_and_nothing_behind_the_last(void **unused)
{
    (void)unused;
    static rheo__list_lasts_function *const list_lasts[] = RHEO__ALL_VARIANTS(list_lasts);
    static rheo__needs_of_step_function *const needs_of_step[] = RHEO__ALL_VARIANTS(needs_of_step);
    enum { MOST = 600, ROOM = MOST + 32 };
    static rheo_real x[3 * ROOM], v[3 * ROOM], from[3 * ROOM], margin[ROOM];
    const char *kernels;
    for (uint32_t variant = 0; (kernels = rheo_simd_available(variant)); variant++) {
        OK(rheo_use_simd(kernels, &error));
        const rheo__simd_variant index = rheo__simd_in_use();
        for (uint32_t n = 1; n <= MOST; n = n < 37 ? n + 1 : n + 563) {
            rheo__state s = {
                .particles = n, .position = x, .velocity = v, .list_position = from, .list_margin = margin};
            const rheo__motion m = {
                .velocity = {1, 2, 3}, .displacement = {3, 2, 1}, .fall = RHEO__R(0.5), .step = 2, .most = 10};
            for (uint32_t i = 0; i < ROOM; i++) {
                margin[i] = i < n ? RHEO__R(1.5) : (rheo_real)__builtin_nan(""); /* more than 2 x 0.5 */
                for (uint32_t k = 3 * i; k < 3 * i + 3; k++) {
                    from[k] = i < n ? (rheo_real)(k % 3 ? 0 : 10 * i) : margin[i];
                    x[k] = from[k] + m.displacement[k % 3];
                    v[k] = i < n ? m.velocity[k % 3] : margin[i];
                }
            }
            assert_true(list_lasts[index](&s, &m));
            for (uint32_t i = 0; i < n; i++) {
                rheo_real *const value[] = {&margin[i], &v[3 * i],     &v[3 * i + 1], &v[3 * i + 2],
                                            &x[3 * i],  &x[3 * i + 1], &x[3 * i + 2]};
                for (size_t k = 0; k < sizeof value / sizeof *value; k++) {
                    const rheo_real before = *value[k];
                    *value[k] -= RHEO__R(0.6);
                    if (list_lasts[index](&s, &m))
                        fail_msg("%s: value %zu of particle %u of %u does not count", kernels, k, i, n);
                    *value[k] = before;
                }
                /* The ball is as fast as its squared speed says, but only near a particle. */
                rheo__motion ball = m;
                ball.balls = 2; /* the first is far away */
                ball.near2[0] = ball.near2[1] = 4, ball.ball2[0] = ball.ball2[1] = RHEO__R(0.36);
                ball.ball[0][0] = RHEO__R(1e6);
                ball.ball[1][0] = x[3 * i], ball.ball[1][1] = x[3 * i + 1],
                ball.ball[1][2] = x[3 * i + 2] + RHEO__R(1.9);
                assert_false(list_lasts[index](&s, &ball));
                ball.ball[1][2] += RHEO__R(0.2);
                assert_true(list_lasts[index](&s, &ball));
            }
            for (uint32_t i = 0; i < n; i++)
                v[3 * i] += (rheo_real)(i % 4);
            assert_true(needs_of_step[index](&s, &m) == (rheo_real)(2 * (n < 4 ? n - 1 : 3) + 1));
            for (uint32_t i = 0; i < ROOM; i++)
                assert_true(i < n ? margin[i] == (rheo_real)(2 * (i % 4) + 1) : margin[i] != margin[i]);
            v[0] = 1000;
            assert_true(needs_of_step[index](&s, &m) == 10);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_best_simd_variant_is_the_default), /* precedes the tests that choose another */
        cmocka_unit_test(unknown_simd_variants_are_refused),
        cmocka_unit_test(all_kinds_of_scenes),
        cmocka_unit_test(clouds_of_few_particles),
        cmocka_unit_test(the_simd_variant_may_change_between_steps),
        cmocka_unit_test(particles_near_a_point),
        cmocka_unit_test(one_bit_is_seen),
        cmocka_unit_test(each_margin_counts_and_nothing_behind_the_last),
    };
    if (!has_several_kernels())
        print_message("this build has only the scalar variant: nothing to compare\n");
    return cmocka_run_group_tests_name("simd", tests, NULL, NULL);
}
