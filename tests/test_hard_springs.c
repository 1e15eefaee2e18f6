/* Hard cases of springs and memory: necks that tear, springs that last for few steps, memories that never fade or hardly exist. */
#include "hard.h"

/* ---- Springs that break ---- */

/* Number of parts that springs hold together, by joining the ends of all. */
static uint32_t parts(const rheo_world *world)
{
    const uint32_t n = rheo_world_particle_count(world);
    const size_t count = rheo_world_spring_count(world);
    uint32_t *of = malloc(n * sizeof *of), sum = n;
    rheo_spring *spring = malloc((count + 1) * sizeof *spring);
    assert_true(of && spring);
    OK(rheo_world_springs(world, spring, count));
    for (uint32_t i = 0; i < n; i++)
        of[i] = i;
    for (size_t k = 0; k < count; k++) {
        uint32_t a = spring[k].a, b = spring[k].b;
        while (of[a] != a)
            a = of[a] = of[of[a]];
        while (of[b] != b)
            b = of[b] = of[of[b]];
        sum -= a != b;
        of[a > b ? a : b] = a > b ? b : a;
    }
    free(of);
    free(spring);
    return sum;
}

/*
 * A bar is pulled apart at a rate that its ends keep: it necks and tears. No force acts from outside, so momentum stays to rounding,
 * and energy is at most that of the start: of motion, and of the pressure of the lattice, whose particles are too close.
 */
static void a_neck_tears(void **unused)
{
    (void)unused;
    enum { LENGTH = 40, N = 16 * LENGTH };
    for (int scheme = 0; scheme < SCHEMES - 1; scheme++)
        for (int stiff = 0; stiff < 2; stiff++) {
            rheo_world_def def = rheo_default_world_def();
            memset(def.gravity, 0, sizeof def.gravity);
            set(&def, "scheme", scheme_name(scheme));
            set(&def, "history.stiffness", stiff && scheme == RHEO_SCHEME_SUMMED ? "1500" : "0");
            rheo_real x[3 * N], v[3 * N] = {0};
            lattice(&def, LENGTH, 4, 4, (double[]){-LENGTH, -4, -4}, x);
            const double rate = stiff || scheme ? 4 : 1, fast = rate * LENGTH;
            for (int i = 0; i < N; i++)
                v[3 * i] = (rheo_real)rate * x[3 * i];
            rheo_world *world = world_of(def, N, x, v);
            const double stored = pressure_energy(world);
            step(world, 1);
            assert_int_equal(parts(world), 1);
            course c = {.result = RHEO_OK};
            uint32_t torn = 1;
            for (int t = 0; t < 10; t++) {
                const course next = drive_all(world, 15);
                c.most = fmax(c.most, next.most);
                c.fastest = fmax(c.fastest, next.fastest);
                torn = parts(world) > torn ? parts(world) : torn;
            }
            const double begin = 0.5 * fast * fast / 3 * N;
            print_message("%s, stiff %d: %u parts, energy %g, at first %g + %g, fastest %g, momentum %g\n",
                          scheme_name(scheme), stiff, torn, c.most, begin, stored, c.fastest, momentum(world, 0));
            assert_true(torn > 1 && metric(world, "springs") > 100);
            assert_true(c.most <= begin + stored && c.fastest < fast + 57);
            for (int axis = 0; axis < 3; axis++)
                NEAR(momentum(world, axis), 0, (scheme ? 50 : 2) * N * fast * ULP);
            rheo_world_destroy(world);
        }
}

static int compare_springs(const rheo_spring *a, const rheo_spring *b)
{
    return a->a != b->a ? (a->a < b->a ? -1 : 1) : a->b != b->b ? (a->b < b->b ? -1 : 1) : 0;
}

/*
 * Two combs pass each other by 2 L in a step: a spring lasts for two or three steps, and some are made and broken in every step. A new
 * spring is as long as its pair is apart, so it stores nothing; momentum stays to rounding, energy does not grow. Springs are the
 * pairs within the support at the positions before the forces.
 */
static void springs_are_made_and_broken_in_every_step(void **unused)
{
    (void)unused;
    enum { N = 300, MOST = 40 * N, STEPS = 60 };
    rheo_spring *before = calloc(MOST, sizeof *before), *now = calloc(MOST, sizeof *now);
    assert_true(before && now);
    for (int scheme = 0; scheme < SCHEMES - 1; scheme++) {
        rheo_world_def def = rheo_default_world_def();
        memset(def.gravity, 0, sizeof def.gravity);
        set(&def, "scheme", scheme_name(scheme));
        def.fluid.stiffness = def.fluid.near_stiffness = 0;
        def.fluid.linear_viscosity = def.fluid.quadratic_viscosity = def.history.stiffness = 0;
        def.springs.stiffness = 0.5; /* so that broken springs, whose energy is lost, hardly slow the combs */
        rheo_real x[3 * N], v[3 * N] = {0};
        for (int i = 0; i < N; i++) {
            x[3 * i] = (rheo_real)(i / 2 * 6 + 0.03 * (i * i * 37 % 101));
            x[3 * i + 1] = (rheo_real)(i % 2 * 3);
            x[3 * i + 2] = 0;
            v[3 * i] = (rheo_real)((i % 2 ? 1 : -1) / def.step);
        }
        rheo_world *world = world_of(def, N, x, v);
        const double begin = energy_of(world);
        size_t count = 0, least_made = N, least_broken = N;
        for (int t = 0; t < STEPS; t++) {
            const size_t old = count;
            memcpy(before, now, old * sizeof *now);
            step(world, 1);
            assert_finite(world);
            count = rheo_world_spring_count(world);
            assert_true(count <= MOST);
            OK(rheo_world_springs(world, now, count));
            size_t same = 0;
            for (size_t i = 0, j = 0; i < count && j < old;) {
                const int order = compare_springs(&now[i], &before[j]);
                same += order == 0;
                i += order <= 0;
                j += order >= 0;
            }
            if (t > 0) {
                least_made = count - same < least_made ? count - same : least_made;
                least_broken = old - same < least_broken ? old - same : least_broken;
            }
            assert_true(energy_of(world) <= begin * (1 + 100 * ULP));
            NEAR(momentum(world, 0), 0, (scheme ? 50 : 2) * N * 31 * ULP * (t + 1));
        }
        print_message("%s: at least %zu springs made and %zu broken in a step, of %zu; energy %g of %g\n",
                      scheme_name(scheme), least_made, least_broken, count, energy_of(world), begin);
        assert_true(least_made > 5 && least_broken > 5);
        rheo_world_destroy(world);
    }
    free(before);
    free(now);
}

/* ---- Memory ---- */

/*
 * Two particles part at the constant speed v. D^q of the way v t is v t^(1-q)/Gamma(2-q); for q = 1/2, 2 v sqrt(t/pi). With a full
 * memory it grows for ever, with a window it falls to the far smaller part that a straight way keeps: it has a plateau.
 */
static void full_memory_of_steady_motion_has_no_plateau(void **unused)
{
    (void)unused;
    static const char *const kind[] = {"window", "window-fast", "full", "tempered"};
    const double v = 1e-4;
    for (int k = 0; k < 4; k++) {
        rheo_world_def def = inert_def();
        set(&def, "history.kind", kind[k]);
        def.springs.stiffness = 1e-12; /* no force to speak of in this time */
        def.history.stiffness = 1e-9;
        def.history.onset = 0;
        const rheo_real x[6] = {0, 0, 0, 1, 0, 0}, speed[6] = {0, 0, 0, (rheo_real)v, 0, 0};
        rheo_world *world = world_of(def, 2, x, speed);
        rheo_spring_state early, late;
        step(world, 1000);
        OK(rheo_world_spring(world, 0, 1, &early, &error));
        step(world, 3000);
        OK(rheo_world_spring(world, 0, 1, &late, &error));
        const double expected = 2 * v * sqrt(4000 * def.step / 3.14159265358979);
        print_message("%s: %g after 33 T, %g after 132 T; without end %g\n", kind[k], early.history_rate,
                      late.history_rate, expected);
        if (k == RHEO_HISTORY_FULL)
            NEAR(late.history_rate / expected, 1, 0.01);
        else
            assert_true(late.history_rate < 1.01 * early.history_rate && late.history_rate < expected / 2);
        NEAR(late.stiffness, def.springs.stiffness + def.history.stiffness * late.history_rate,
             1e-6 * late.stiffness);
        rheo_world_destroy(world);
    }
}

/*
 * What limits the stiffness then is the number of substeps: where max_substeps do not bear the sum of K, springs are softened to
 * tau^2 sum K = 2. Plates shear a fluid steadily with full memory and a large k_hist: the sum grows beyond 2, the displacements by
 * springs do not, and no particle is much faster than the plate.
 */
static void softening_limits_the_stiffness_of_a_full_memory(void **unused)
{
    (void)unused;
    rheo_scene scene = builtin_scene("plates");
    fills_of(&scene)[0].max[0] = fills_of(&scene)[0].max[2] = scene.world.space.period[0] =
        scene.world.space.period[2] = 6 * scene.world.fluid.spacing;
    set(&scene.world, "history.kind", "full");
    set(&scene.world, "history.stiffness", "15000");
    set(&scene.world, "max_substeps", "4");
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    double sum[2], moved[2], softened[2];
    for (int k = 0; k < 2; k++) {
        const course c = drive_all(world, 250);
        sum[k] = metric(world, "stiffness_sum");
        moved[k] = metric(world, "max_spring_displacement");
        softened[k] = c.softened;
        assert_true(c.fastest < 10 * 2); /* the plate moves at 2 L/T */
        assert_true(c.substeps == 4);
    }
    print_message(
        "sum of kappa %g and %g before softening, displacement by springs %g and %g supports, softened %g and %g of %g\n",
        sum[0], sum[1], moved[0], moved[1], softened[0], softened[1], metric(world, "springs"));
    assert_true(sum[0] > 2 && sum[1] > 1.1 * sum[0] && softened[1] > 0);
    assert_true(moved[1] < 0.1 && moved[1] < 2 * moved[0]);
    rheo_world_destroy(world);
}

/* ---- A memory shorter than a step ---- */

static void a_memory_shorter_than_a_step(void **unused)
{
    (void)unused;
    static const struct {
        const char *window, *lag, *step;
        uint32_t steps[2]; /* window and lag as a world has them; 0: refused */
        const char *refusal;
    } CASES[] = {
        {"1", "0", "0.033", {1, 0}, NULL},
        {"1", "1", "0.033", {1, 1}, NULL},
        {"1", "50", "0.033", {1, 50}, NULL},
        {"3", "100", "0.033", {3, 100}, NULL},
        {"1", "0", "1e-6", {1, 0}, NULL},
        {"1", "0", "1e-12", {1, 0}, NULL},
        {"0.033 s", "0", "0.033", {1, 0}, NULL},
        {"0.017 s", "0", "0.033", {1, 0}, NULL},
        {"0.016 s",
         "0",
         "0.033",
         {0, 0},
         "history.window is 0.016 s, 0.484848 steps of 0.033; it must be from 1 to 1000000 steps"},
        {"1e-9 s", "0", "0.033", {0, 0}, "history.window is 1e-09 s"},
        {"1 s",
         "0",
         "1e-12",
         {0, 0},
         "history.window is 1 s, 1e+12 steps of 1e-12; it must be from 1 to 1000000 steps"},
        {"1", "0.01 s", "0.033", {0, 0}, "history.lag is 0.01 s"},
    };
    for (int scheme = 0; scheme < SCHEMES; scheme++)
        for (size_t k = 0; k < sizeof CASES / sizeof *CASES; k++) {
            rheo_world_def def = rheo_default_world_def();
            set(&def, "scheme", scheme_name(scheme));
            set(&def, "history.window", CASES[k].window);
            set(&def, "history.lag", CASES[k].lag);
            set(&def, "step", CASES[k].step);
            rheo_real x[3 * 64];
            def.particles.count = lattice(&def, 4, 4, 4, (double[]){0, 0, 0}, x);
            def.particles.position = x;
            rheo_world *world = NULL;
            if (CASES[k].refusal) {
                REFUSED(RHEO_ERROR_ARGUMENT, CASES[k].refusal, rheo_world_create(&def, &world, &error));
                continue;
            }
            OK(rheo_world_create(&def, &world, &error));
            assert_int_equal(rheo_world_history_window(world), CASES[k].steps[0]);
            assert_int_equal(rheo_world_history_lag(world), CASES[k].steps[1]);
            const course c = drive_all(world, 120);
            assert_int_equal(rheo_world_history_rows(world), CASES[k].steps[0] + CASES[k].steps[1] + 1);
            /* Free fall, and the expansion of the lattice; scheme positions does it in a step, however short that is. */
            const double falls = 9.81 * 120 * def.step;
            if (scheme != RHEO_SCHEME_POSITIONS)
                assert_true(c.fastest < falls + 30);
            else
                assert_true(c.fastest < falls + def.fluid.support / def.step);
            rheo_world_destroy(world);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_neck_tears),
        cmocka_unit_test(springs_are_made_and_broken_in_every_step),
        cmocka_unit_test(full_memory_of_steady_motion_has_no_plateau),
        cmocka_unit_test(softening_limits_the_stiffness_of_a_full_memory),
        cmocka_unit_test(a_memory_shorter_than_a_step),
    };
    return cmocka_run_group_tests_name("hard_springs", tests, NULL, NULL);
}
