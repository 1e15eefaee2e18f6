/* The equations of the thickening model against closed forms and the figures of docs/model.md. */
#include "support.h"

#include <math.h>

#include "world/model_thickening.h"

/* Both schemes, each with one displacement by springs in a step, which is the same for a pair. */
enum { SEQUENTIAL, SUMMED, SCHEMES };
static rheo_world_def def_of(int scheme)
{
    rheo_world_def def = inert_def();
    def.scheme = scheme == SEQUENTIAL ? RHEO_SCHEME_SEQUENTIAL : RHEO_SCHEME_SUMMED;
    def.substeps = 1;
    return def;
}

static rheo_world *spring_pair(int scheme, double kappa, double stretch, double gamma, double alpha)
{
    rheo_world_def def = def_of(scheme);
    def.springs.stiffness = kappa / (def.step * def.step);
    def.springs.plasticity = alpha;
    def.springs.yield_ratio = gamma;
    const uint32_t ends[] = {0, 1};
    const rheo_real rest_length[] = {1};
    def.particles.spring_count = 1;
    def.particles.spring_ends = ends;
    def.particles.spring_rest_length = rest_length;
    const rheo_real position[] = {0, 0, 0, (rheo_real)(1 + stretch), 0, 0};
    return world_of(def, 2, position, NULL);
}

static double stretch_of(const rheo_world *world)
{
    rheo_spring_state spring;
    OK(rheo_world_spring(world, 0, 1, &spring, &error));
    return spring.length - (double)spring.spring.rest_length;
}

/* x(n+1) = (1 - kappa)(2 x(n) - x(n-1)): decay sqrt(1 - kappa) a step, frequency acos(sqrt(1 - kappa))/step. */
static void spring_pair_decays_and_rings(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world *world = spring_pair(scheme, 0.2, 0.5, 0, 0);
        double x[4] = {0.5};
        for (int i = 1; i < 4; i++) {
            step(world, 1);
            x[i] = stretch_of(world);
        }
        /* x2 = a x1 - b x0, x3 = a x2 - b x1 */
        double determinant = x[1] * -x[1] + x[0] * x[2];
        double a = (x[2] * -x[1] + x[0] * x[3]) / determinant;
        double b = (x[1] * x[3] - x[2] * x[2]) / determinant;
        NEAR(sqrt(b), sqrt(0.8), 2e-5);
        NEAR(acos(a / (2 * sqrt(b))) / 0.033, 14.0499, 2e-3);
        rheo_world_destroy(world);
    }
}

static void spring_pair_is_stable_up_to_four_thirds(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world *below = spring_pair(scheme, 1.32, 0.01, 0, 0), *above = spring_pair(scheme, 1.35, 0.01, 0, 0);
        step(below, 60);
        step(above, 60);
        assert_true(fabs(stretch_of(below)) < 0.01);
        assert_true(fabs(stretch_of(above)) > 0.02);
        assert_true(metric(above, "stiffness_number") > 1.34);
        rheo_world_destroy(below);
        rheo_world_destroy(above);
    }
}

/* kappa/(1 + kappa) never overshoots: no kappa is unstable. */
static void implicit_solver_is_stable_at_any_stiffness(void **unused)
{
    (void)unused;
    for (double kappa = 1; kappa < 1e7; kappa *= 10) {
        rheo_world *world = spring_pair(SEQUENTIAL, kappa, 0.1, 0, 0);
        OK(rheo_world_set(world, "springs.solver", "implicit", &error));
        step(world, 300);
        assert_true(fabs(stretch_of(world)) < 0.1);
        rheo_world_destroy(world);
    }
}

static void plasticity_of_a_held_spring(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        /* So soft that the ends do not move. */
        rheo_world *world = spring_pair(scheme, 1e-30, 0.5, 0.1, 0.3);
        step(world, 300);
        rheo_spring_state spring;
        OK(rheo_world_spring(world, 0, 1, &spring, &error));
        NEAR(spring.length, 1.5, 0);
        NEAR((double)spring.spring.rest_length, 1.350020503, sizeof(rheo_real) == 4 ? 2e-6 : 2e-9);
        rheo_world_destroy(world);
    }
}

/* Of the displacements by pressure, the largest has a metric, and its particle. */
static void the_largest_displacement_by_pressure_is_reported(void **unused)
{
    (void)unused;
    rheo_world_def def = def_of(SUMMED);
    def.fluid.near_stiffness = 100;
    /* The ends of a row of three are pushed most, and of these the one that has the nearer neighbour. */
    const rheo_real position[] = {9, 9, 9, 0, 0, 0, 1.5F, 0, 0, 2.5F, 0, 0};
    rheo_world *world = world_of(def, 4, position, NULL);
    step(world, 1);
    const double moved = ((double)rheo_world_positions(world)[9] - (double)position[9]) / def.fluid.support;
    assert_true(moved > 0 && (double)rheo_world_positions(world)[3] / def.fluid.support > -moved);
    NEAR(metric(world, "max_pressure_displacement") / moved, 1, 1e-3);
    assert_true(metric(world, "max_pressure_displacement_id") == 3);
    rheo_world_destroy(world);
}

/* The largest density has a metric, in rest densities, and so has the mean of what is above these. */
static void densities_are_reported_in_rest_densities(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world_def def = def_of(scheme);
        def.fluid.stiffness = 1e-6; /* so soft that the particles do not move */
        def.fluid.rest_density = 0.125;
        const rheo_real position[] = {0, 0, 0, 1, 0, 0, 9, 9, 9};
        rheo_world *world = world_of(def, 3, position, NULL);
        step(world, 1);
        NEAR(metric(world, "max_density"), 0.25 / 0.125, 1e-5); /* (1 - r/h)^2 */
        NEAR(metric(world, "density_error"), (0.125 + 0.125) / 0.125 / 3, 1e-5);
        rheo_world_destroy(world);
    }
}

/* A rest length does not change within the yield ratio. */
static void no_plasticity_below_yield(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world *world = spring_pair(scheme, 1e-30, 0.0625, 0.1, 0.3);
        step(world, 50);
        rheo_spring_state spring;
        OK(rheo_world_spring(world, 0, 1, &spring, &error));
        assert_true(spring.spring.rest_length == 1);
        rheo_world_destroy(world);
    }
}

static void springs_form_at_their_distance_and_end_beyond_the_support(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world_def def = def_of(scheme);
        def.springs.stiffness = 1e-20;
        def.step = 0.25;
        const rheo_real position[] = {0, 0, 0, 1.25F, 0, 0}, velocity[] = {0, 0, 0, 1, 0, 0};
        rheo_world *world = world_of(def, 2, position, velocity);
        assert_int_equal(rheo_world_spring_count(world), 0);
        step(world, 1);
        rheo_spring spring;
        assert_int_equal(rheo_world_spring_count(world), 1);
        OK(rheo_world_springs(world, &spring, 1));
        assert_true(spring.a == 0 && spring.b == 1 && spring.rest_length == 1.5F);
        step(world, 1); /* r = 1.75 < 2 */
        assert_int_equal(rheo_world_spring_count(world), 1);
        step(world, 1); /* r = 2: no longer closer than the support */
        assert_int_equal(rheo_world_spring_count(world), 0);
        rheo_world_destroy(world);
        OK(rheo_world_def_set(&def, "springs.rest_length", "support", &error));
        world = world_of(def, 2, position, velocity);
        step(world, 1);
        OK(rheo_world_springs(world, &spring, 1));
        assert_true(spring.rest_length == 2);
        rheo_world_destroy(world);
    }
}

static void viscosity_of_a_pair(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    def.fluid.linear_viscosity = 3;
    def.fluid.quadratic_viscosity = 2;
    const rheo_real position[] = {0, 0, 0, 1, 0, 0}, towards[] = {0.5F, 7, 0, -0.25F, 0, 0},
                    apart[] = {-0.5F, 7, 0, 0.25F, 0, 0}, fast[] = {40, 0, 0, -40, 0, 0};
    /* r/h = 1/2, u = 3/4 */
    double impulse = 0.033 * 0.5 * (3 * 0.75 + 2 * 0.75 * 0.75);
    rheo_world *world = world_of(def, 2, position, towards);
    step(world, 1);
    const rheo_real *v = rheo_world_velocities(world);
    NEAR((double)v[0], 0.5 - impulse / 2, 1e-5);
    NEAR((double)v[3], -0.25 + impulse / 2, 1e-5);
    NEAR((double)v[1], 7, 1e-4);
    rheo_world_destroy(world);
    world = world_of(def, 2, position, apart);
    step(world, 1);
    NEAR((double)rheo_world_velocities(world)[0], -0.5, 1e-5);
    rheo_world_destroy(world);
    /* The impulse stops the particles at most. */
    world = world_of(def, 2, position, fast);
    step(world, 1);
    NEAR((double)rheo_world_velocities(world)[0], 0, 1e-5);
    NEAR((double)rheo_world_velocities(world)[3], 0, 1e-5);
    rheo_world_destroy(world);
}

static void density_relaxation_of_a_pair(void **unused)
{
    (void)unused;
    rheo_world_def def = def_of(SEQUENTIAL);
    def.fluid.stiffness = 30;
    def.fluid.near_stiffness = 50;
    def.fluid.rest_density = 0.1;
    const rheo_real position[] = {0, 0, 0, 1, 0, 0};
    rheo_world *world = world_of(def, 2, position, NULL);
    step(world, 1);
    /* The first particle's row moves both; the second row uses the new distance. */
    double r = 1;
    for (int row = 0; row < 2; row++) {
        double w = 1 - r / 2, pressure = 30 * (w * w - 0.1), near_pressure = 50 * w * w * w;
        r += 0.033 * 0.033 * (pressure * w + near_pressure * w * w);
    }
    const rheo_real *x = rheo_world_positions(world);
    NEAR((double)(x[3] - x[0]), r, 1e-6);
    NEAR((double)(x[0] + x[3]), 1, 1e-6);
    rheo_world_destroy(world);
}

/* A jittered block with everything except gravity: momentum is conserved to rounding. */
static void momentum_is_conserved_in_free_space(void **unused)
{
    (void)unused;
    rheo_scene scene = rheo_default_scene();
    memset(scene.world.gravity, 0, sizeof scene.world.gravity);
    scene.fill = some_fills();
    scene.fill_count = 1;
    fills_of(&scene)[0].kind = RHEO_FILL_BLOCK;
    for (int axis = 0; axis < 3; axis++)
        fills_of(&scene)[0].max[axis] = 16;
    fills_of(&scene)[0].jitter = 0.3;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    step(world, 60);
    double sum[3] = {0}, size = 0;
    uint32_t n = rheo_world_particle_count(world);
    assert_int_equal(n, 512);
    for (uint32_t i = 0; i < 3 * n; i++) {
        sum[i % 3] += (double)rheo_world_velocities(world)[i];
        size += fabs((double)rheo_world_velocities(world)[i]);
    }
    assert_true(size > 10);
    for (int axis = 0; axis < 3; axis++)
        NEAR(sum[axis] / size, 0,
             sizeof(rheo_real) == 4 ? 5e-4 : 1e-12); /* rounding: 1e-6/0.033 per position and step */
    rheo_world_destroy(world);
}

/*
 * A pair on a circle, stretched by 10 %. A displacement along the predicted line loses angular momentum: 0.980 of it
 * remains after one step. Later steps follow the recurrence of the step.
 */
static void angular_momentum_of_a_rotating_pair_is_not_conserved(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        const double kappa = 0.2, dt = 0.033, stiffness = kappa / (dt * dt);
        const double speed = sqrt(stiffness * 0.1 * 0.55 / 2);
        rheo_world_def def = def_of(scheme);
        def.springs.stiffness = stiffness;
        const uint32_t ends[] = {0, 1};
        const rheo_real rest_length[] = {1};
        def.particles.spring_count = 1;
        def.particles.spring_ends = ends;
        def.particles.spring_rest_length = rest_length;
        const rheo_real position[] = {-0.55F, 0, 0, 0.55F, 0, 0};
        const rheo_real velocity[] = {0, (rheo_real)-speed, 0, 0, (rheo_real)speed, 0};
        rheo_world *world = world_of(def, 2, position, velocity);
        double x = 0.55, y = 0, u = 0, v = speed;
        for (int i = 0; i < 300; i++) {
            double x_star = x + dt * u, y_star = y + dt * v, r = 2 * sqrt(x_star * x_star + y_star * y_star);
            double kept = 1 - kappa * (r - 1) / r;
            u = (kept * x_star - x) / dt;
            v = (kept * y_star - y) / dt;
            x = kept * x_star;
            y = kept * y_star;
            step(world, 1);
            const rheo_real *p = rheo_world_positions(world), *w = rheo_world_velocities(world);
            double momentum = (double)(p[3] * w[4] - p[4] * w[3] + p[0] * w[1] - p[1] * w[0]) / (1.1 * speed);
            NEAR(momentum, 2 * (x * v - y * u) / (1.1 * speed), 5e-4);
            if (i == 0)
                NEAR(momentum, 0.980, 5e-4);
        }
        rheo_world_destroy(world);
    }
}

/* D^q of a spring is the fractional derivative of the recorded velocity difference. */
static void history_rate_is_the_fractional_derivative(void **unused)
{
    (void)unused;
    enum { STEPS = 40, WINDOW = 25 };
    rheo_world_def def = inert_def();
    def.fluid.stiffness = 20;
    def.fluid.near_stiffness = 30;
    def.springs.stiffness = 30;
    def.history.stiffness = 100;
    def.history.window = WINDOW;
    const rheo_real position[] = {0, 0, 0, 1, 0.25F, 0}, velocity[] = {0, 2, 1, 0, -2, 0};
    for (int kind = 0; kind < 2; kind++) {
        OK(rheo_world_def_set(&def, "history.weights", kind ? "l1" : "paper", &error));
        rheo_world *world = world_of(def, 2, position, velocity);
        double v[3][STEPS + 1] = {{0}};
        for (int n = 0; n < STEPS; n++) {
            step(world, 1);
            double rate = 0;
            for (int axis = 0; axis < 3; axis++) {
                /* The L1 scheme does not use the sample ahead of the first backward difference. */
                double *signal = v[axis], result[STEPS + 1];
                signal[n + kind] =
                    (double)(rheo_world_velocities(world)[axis] - rheo_world_velocities(world)[3 + axis]);
                OK(rheo_fractional_derivative(signal, (size_t)(n + 1 + kind), 0.5, 0.033, WINDOW,
                                              kind ? RHEO_WEIGHTS_L1 : RHEO_WEIGHTS_PAPER, result));
                rate += result[n + kind] * result[n + kind];
            }
            rheo_spring_state spring;
            OK(rheo_world_spring(world, 0, 1, &spring, &error));
            NEAR(spring.history_rate / sqrt(rate), 1, 2e-5);
            const double d = spring.history_rate;
            NEAR(spring.stiffness, 30 + 100 * d * d / (d + def.history.onset), 1e-3);
        }
        rheo_world_destroy(world);
    }
}

/* Steps once and compares the result of the stage with the plain sum of every particle, bit for bit. */
static void step_and_compare_sums(rheo_world *world, const char *what)
{
    uint32_t n = rheo_world_particle_count(world);
    rheo_real *plain = malloc((size_t)n * 3 * sizeof *plain);
    assert_non_null(plain);
    rheo__derivatives(&world->state, rheo__thickening_of(world), plain);
    step(world, 1);
    for (uint32_t i = 0; i < 3 * n; i++)
        if (memcmp(&plain[i], &world->state.derivative[i], sizeof *plain) != 0)
            fail_msg("%s, window %u, step %llu, particle %u: the sum made ahead is %.9g, the plain one %.9g", what,
                     rheo_world_history_window(world), (unsigned long long)rheo_world_step_count(world), i / 3,
                     (double)world->state.derivative[i], (double)plain[i]);
    free(plain);
}

/* Sums are computed several steps ahead. No change in between may leave a stale sum. */
static void sums_made_ahead_are_the_plain_sums(void **unused)
{
    (void)unused;
    static const uint32_t windows[] = {1, 2, 3, 6, 7, 8, 9, 15, 16, 17, 40};
    static const uint32_t lags[] = {1, 5, 8, 19};
    for (size_t k = 0; k < 2 * sizeof windows / sizeof *windows; k++) {
        rheo_scene scene = lively_scene();
        scene.world.history.window = windows[k / 2];
        scene.world.history.lag = k % 2 ? lags[k / 2 % 4] : 0;
        scene.world.springs.solver = RHEO_SOLVER_IMPLICIT; /* stable whatever falls in */
        rheo_world *world, *loaded;
        OK(rheo_scene_create_world(&scene, &world, &error));
        for (int s = 0; s < 23; s++)
            step_and_compare_sums(world, "from the start");
        const rheo_real position[] = {8, 30, 8, 9, 31, 8};
        OK(rheo_world_add_particles(world, 2, position, NULL, &error));
        for (int s = 0; s < 11; s++)
            step_and_compare_sums(world, "with new particles");
        rheo_real many[3 * 40];
        for (int i = 0; i < 3 * 40; i++)
            many[i] = (rheo_real)(2 * (i / 3) % 16 + (i % 3 == 1 ? 12 + i / 24 * 2 : 0));
        OK(rheo_world_add_particles(world, 40, many, NULL, &error));
        for (int s = 0; s < 11; s++)
            step_and_compare_sums(world, "with many new particles");
        OK(rheo_world_set(world, "history.order", "0.7", &error));
        for (int s = 0; s < 11; s++)
            step_and_compare_sums(world, "with another order");
        const char *kernels;
        for (uint32_t i = 0; (kernels = rheo_simd_available(i)); i++) {
            OK(rheo_use_simd(kernels, &error));
            for (int s = 0; s < 5; s++)
                step_and_compare_sums(world, kernels);
        }
        void *bytes;
        size_t size;
        rheo_recording *checkpoint;
        OK(rheo_world_save_memory(world, "sums", &bytes, &size, &error));
        OK(rheo_recording_open_memory(bytes, size, &checkpoint, &error));
        OK(rheo_recording_world(checkpoint, rheo_world_step_count(world), NULL, &loaded, &error));
        for (int s = 0; s < 11; s++) {
            step_and_compare_sums(world, "after saving");
            step_and_compare_sums(loaded, "after loading");
            assert_true(rheo_world_hash(world) == rheo_world_hash(loaded));
        }
        rheo_recording_close(checkpoint);
        free(bytes);
        rheo_world_destroy(loaded);
        rheo_world_destroy(world);
    }
}

/* Every lag of a spring's ring is the exact difference of recorded velocities; a new spring has all lags. */
static void rings_are_recorded_velocities(void **unused)
{
    (void)unused;
    enum { STEPS = 30 };
    rheo_world *world = lively_world();
    uint32_t n = rheo_world_particle_count(world), window = rheo_world_history_window(world);
    assert_int_equal(window, 10);
    rheo_real *recorded = malloc((size_t)STEPS * n * 3 * sizeof *recorded);
    assert_non_null(recorded);
    size_t compared = 0, born = 0;
    for (uint32_t s = 0; s < STEPS; s++) {
        step(world, 1);
        memcpy(recorded + (size_t)s * n * 3, rheo_world_velocities(world), (size_t)n * 3 * sizeof *recorded);
        size_t count = rheo_world_spring_count(world);
        rheo_spring *springs = malloc(count * sizeof *springs);
        assert_non_null(springs);
        OK(rheo_world_springs(world, springs, count));
        uint32_t rows = rheo_world_history_rows(world);
        assert_int_equal(rows, s + 1 < window + 1 ? s + 1 : window + 1);
        for (size_t k = 0; k < count; k++) {
            rheo_real difference[3 * 11];
            OK(rheo_world_spring_history(world, springs[k].a, springs[k].b, difference));
            for (uint32_t lag = 0; lag < rows; lag++)
                for (size_t axis = 0; axis < 3; axis++) {
                    const rheo_real *row = recorded + (size_t)(s - lag) * n * 3;
                    rheo_real expected = row[3 * (size_t)springs[k].a + axis] - row[3 * (size_t)springs[k].b + axis];
                    if (difference[3 * lag + axis] != expected)
                        fail_msg("step %u, spring %u:%u, lag %u: %g is not %g", s + 1, springs[k].a, springs[k].b,
                                 lag, (double)difference[3 * lag + axis], (double)expected);
                }
            compared++;
        }
        static size_t before;
        born += s > 0 && count > before;
        before = count;
        free(springs);
    }
    assert_true(compared > 10000 && born > 0);
    free(recorded);

    /* A loaded checkpoint has the same rings. */
    void *bytes;
    size_t size, count = rheo_world_spring_count(world);
    rheo_recording *checkpoint;
    rheo_world *loaded;
    rheo_spring *springs = malloc(count * sizeof *springs);
    assert_non_null(springs);
    OK(rheo_world_save_memory(world, "rings", &bytes, &size, &error));
    OK(rheo_recording_open_memory(bytes, size, &checkpoint, &error));
    OK(rheo_recording_world(checkpoint, STEPS, NULL, &loaded, &error));
    OK(rheo_world_springs(loaded, springs, count));
    for (size_t k = 0; k < count; k++) {
        rheo_real saved[3 * 11], original[3 * 11];
        OK(rheo_world_spring_history(loaded, springs[k].a, springs[k].b, saved));
        OK(rheo_world_spring_history(world, springs[k].a, springs[k].b, original));
        assert_memory_equal(saved, original, sizeof saved);
    }
    free(springs);
    rheo_world_destroy(loaded);
    rheo_recording_close(checkpoint);
    free(bytes);
    rheo_world_destroy(world);
}

/* stiffness_number and stiffness_sum against every spring of the step, using the stored velocities. */
static void stiffness_metrics_are_those_of_the_springs(void **unused)
{
    (void)unused;
    enum { STEPS = 8 };
    rheo_world *world = lively_world();
    step(world, STEPS - 1);
    uint32_t stage = 0;
    for (rheo_stage_info info = {.name = ""}; strcmp(info.name, "neighbours") != 0;) {
        OK(rheo_world_step_stage(world, &stage, &error));
        OK(rheo_world_stage(world, stage, &info));
    }
    const rheo_world_def *def = rheo_world_definition(world);
    uint32_t n = rheo_world_particle_count(world), rows = rheo_world_history_rows(world);
    assert_int_equal(rows, STEPS - 1); /* not full */
    double weight[STEPS], scale = rheo_history_scale(def->history.order, def->step, RHEO_WEIGHTS_PAPER);
    rheo_history_weights(def->history.order, STEPS, weight);
    weight[rows - 1] = rheo_history_first_weight(def->history.order, rows - 1);
    size_t count = rheo_world_spring_count(world);
    rheo_spring *springs = malloc(count * sizeof *springs);
    double *sum = calloc(n, sizeof *sum), largest = 0, largest_sum = 0;
    uint32_t stiffest[2] = {0, 0}, busiest = 0;
    assert_true(springs && sum && count > 1000);
    OK(rheo_world_springs(world, springs, count));
    for (size_t k = 0; k < count; k++) {
        rheo_real ring[3 * STEPS];
        OK(rheo_world_spring_history(world, springs[k].a, springs[k].b, ring));
        double rate2 = 0;
        for (uint32_t axis = 0; axis < 3; axis++) {
            double d = 0;
            for (uint32_t lag = 0; lag < rows; lag++)
                d += weight[lag] * (double)ring[3 * lag + axis];
            rate2 += scale * d * (scale * d);
        }
        const double kappa =
            def->springs.stiffness + def->history.stiffness * rate2 / (sqrt(rate2) + def->history.onset);
        if (kappa > largest) {
            largest = kappa;
            stiffest[0] = springs[k].a;
            stiffest[1] = springs[k].b;
        }
        sum[springs[k].a] += kappa;
        sum[springs[k].b] += kappa;
    }
    for (uint32_t i = 0; i < n; i++)
        if (sum[i] > largest_sum) {
            largest_sum = sum[i];
            busiest = i;
        }
    assert_true(largest > 2 * def->springs.stiffness);
    step(world, 1); /* the rest of it */
    const double tau = def->step / (double)*world->state.substeps;
    largest *= tau * tau;
    largest_sum *= tau * tau;
    NEAR(metric(world, "stiffness_number") / largest, 1, 1e-4);
    NEAR(metric(world, "stiffness_sum") / largest_sum, 1, 1e-4);
    assert_true(metric(world, "stiffness_a") == stiffest[0] && metric(world, "stiffness_b") == stiffest[1]);
    assert_true(metric(world, "stiffness_sum_id") == busiest);
    free(springs);
    free(sum);
    rheo_world_destroy(world);
}

/* If only springs or pressure move particles at rest, the metric is the largest displacement of the step. */
static void displacement_metrics_are_the_largest_displacements(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        for (int springs = 0; springs < 2; springs++) {
            const rheo_real start[12] = {0, 0, 0, 1, 0.25f, 0, 0.5f, 1, 0.125f, 1.25f, 1, 1};
            rheo_world_def def = def_of(scheme);
            def.fluid.stiffness = springs ? 0 : 90;
            def.fluid.near_stiffness = springs ? 0 : 150;
            def.fluid.cohesion = 3; /* in scheme summed, which would limit the tension */
            def.springs.stiffness = springs ? 200 : 0;
            def.springs.rest_length = RHEO_REST_SUPPORT;
            rheo_world *world = world_of(def, 4, start, NULL);
            const char *mine = springs ? "max_spring_displacement" : "max_pressure_displacement",
                       *other = springs ? "max_pressure_displacement" : "max_spring_displacement";
            const char *id = springs ? "max_spring_displacement_id" : "max_pressure_displacement_id";
            assert_true(metric(world, mine) == 0 && metric(world, id) == -1);
            step(world, 1);
            double most = 0;
            int furthest = -1;
            for (int i = 0; i < 4; i++) {
                const rheo_real *x = rheo_world_positions(world) + 3 * i;
                double length2 = 0;
                for (int axis = 0; axis < 3; axis++)
                    length2 += (double)(x[axis] - start[3 * i + axis]) * (double)(x[axis] - start[3 * i + axis]);
                if (length2 > most) {
                    most = length2;
                    furthest = i;
                }
            }
            assert_true(most > 1e-3);
            NEAR(metric(world, mine), sqrt(most) / 2, 1e-6);
            assert_int_equal((int)metric(world, id), furthest);
            assert_true(metric(world, other) == 0);
            rheo_world_destroy(world);
        }
    }
}

/* The springs of others are those of the list before, and must not pass their rest lengths on to new particles. */
static void springs_of_new_particles_begin_at_rest(void **unused)
{
    (void)unused;
    enum { OLD = 12, NEW = 12, ALL = OLD + NEW };
    uint64_t seed = 1;
    for (int k = 0; k < 40; k++) {
        rheo_world_def def = def_of(k % SCHEMES);
        def.springs.stiffness = 1e-30; /* so soft that nothing moves */
        rheo_real x[3 * ALL];
        for (int i = 0; i < 3 * ALL; i++) {
            seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            x[i] = (rheo_real)(seed >> 40) * (rheo_real)(4. / (1 << 24));
        }
        rheo_world *world = world_of(def, OLD, x, NULL);
        step(world, 2);
        OK(rheo_world_add_particles(world, NEW, x + 3 * OLD, NULL, &error));
        step(world, 1);
        rheo_spring spring[ALL * ALL / 2];
        const size_t count = rheo_world_spring_count(world);
        OK(rheo_world_springs(world, spring, count));
        size_t new = 0;
        for (size_t s = 0; s < count; s++) {
            rheo_spring_state now;
            OK(rheo_world_spring(world, spring[s].a, spring[s].b, &now, &error));
            NEAR((double)spring[s].rest_length, now.length, 2e-6);
            new += spring[s].b >= OLD;
        }
        assert_true(new > NEW);
        rheo_world_destroy(world);
    }
}

/* Particles with a common velocity have no relative motion, so no history stiffness at any speed. */
static void history_ignores_common_motion(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    def.springs.stiffness = 15;
    def.history.stiffness = 150;
    def.step = 0.03125;
    const rheo_real position[] = {0, 0, 0, 1, 0, 0}, velocity[] = {2, 0, 0, 2, 0, 0};
    rheo_world *world = world_of(def, 2, position, velocity);
    step(world, 40);
    rheo_spring_state spring;
    OK(rheo_world_spring(world, 0, 1, &spring, &error));
    NEAR(spring.history_rate, 0, 0);
    NEAR(metric(world, "stiffness_number"), 15 * 0.03125 * 0.03125 / 4, 1e-8); /* two substeps */
    rheo_world_destroy(world);
}

/* Without fluid forces nothing is derived but the length of a substep, and no stage reads anything else. */
static void bare_worlds_derive_only_the_substep(void **unused)
{
    (void)unused;
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
        rheo_world_def def = def_of(scheme);
        def.gravity[1] = -1;
        def.ball.radius = 1;
        def.ball.position[1] = 9;
        def.vibrators.position = some_vibrators();
        def.vibrators.count = 1;
        def.walls.plane = some_walls();
        def.walls.count = 1;
        def.walls.sticking = 0;
        walls_of(&def)[0] = (rheo_wall){{0, -50, 0}, {0, 1, 0}};
        const rheo_real position[3] = {0, 0, 0};
        rheo_world *world = world_of(def, 1, position, NULL);
        const uint32_t most = scheme == SUMMED ? RHEO__DERIVED(substep) : 0;
        uint32_t derived = 0;
        assert_true(world->stage_count >= 5);
        for (uint32_t i = 0; i < world->stage_count; i++) {
            if (world->stage[i].reads & ~derived)
                fail_msg("%s reads what nothing derives", world->stage[i].name);
            derived |= world->stage[i].derives;
            if (derived & ~most)
                fail_msg("%s derives something else", world->stage[i].name);
        }
        rheo_world_destroy(world);
    }
}

/* A queried spring has the stiffness of its rate, and no rate without history. */
static void the_stiffness_of_a_spring_follows_from_its_rate(void **unused)
{
    (void)unused;
    const rheo_real position[6] = {0, 0, 0, 2, 0, 0}, velocity[6] = {1, 0, 0, -1, 1, 0};
    for (int history = 0; history < 2; history++) {
        rheo_world_def def = rheo_default_world_def();
        def.history.stiffness = history ? 150 : 0;
        rheo_world *world = world_of(def, 2, position, velocity);
        for (int i = 0; i < 3; i++)
            OK(rheo_world_step(world, &error));
        rheo_spring_state spring;
        OK(rheo_world_spring(world, 0, 1, &spring, &error));
        const double rate = spring.history_rate,
                     expected =
                         def.springs.stiffness + def.history.stiffness * rate * rate / (rate + def.history.onset);
        assert_true(history ? rate > 0.1 : rate == 0);
        assert_true(fabs(spring.stiffness / expected - 1) < (sizeof(rheo_real) == 4 ? 1e-5 : 1e-12));
        rheo_world_destroy(world);
    }
}

/* Two particles in one place part along the direction that belongs to their numbers, wherever they are, in every scheme. */
/* Without a rest density there is nothing to measure a density by. */
static void densities_have_no_unit_without_a_rest_density(void **unused)
{
    (void)unused;
    static const rheo_real position[6] = {0, 0, 0, 1, 0, 0};
    static const char *const name[] = {"density_error", "max_density"};
    rheo_world_def def = inert_def();
    def.fluid.rest_density = 0;
    rheo_world *world = world_of(def, 2, position, NULL);
    OK(rheo_world_step(world, &error));
    int found = 0;
    for (uint32_t i = 0; i < rheo_world_metric_count(world); i++)
        for (int k = 0; k < 2; k++)
            if (strcmp(rheo_world_metric_name(world, i), name[k]) == 0) {
                NEAR(rheo_world_metric(world, i), 0, 0);
                found++;
            }
    assert_int_equal(found, 2);
    rheo_world_destroy(world);
}

static void coinciding_particles_part_in_their_direction(void **unused)
{
    (void)unused;
    static const rheo_scheme scheme[] = {RHEO_SCHEME_SUMMED, RHEO_SCHEME_SEQUENTIAL, RHEO_SCHEME_POSITIONS};
    for (size_t s = 0; s < 3; s++)
        for (uint32_t ahead = 0; ahead < 3; ahead++) { /* particles of lower numbers, far away */
            rheo_real x[15], direction[3];
            for (uint32_t i = 0; i < 5; i++)
                for (uint32_t a = 0; a < 3; a++)
                    x[3 * i + a] = (rheo_real)(i < ahead ? 100 * (i + 1) : 1.5 + a);
            rheo_world_def def = rheo_default_world_def();
            memset(def.gravity, 0, sizeof def.gravity);
            def.scheme = scheme[s];
            rheo_world *world = world_of(def, ahead + 2, x, NULL);
            step(world, 1);
            rheo__part_direction(ahead, ahead + 1, direction);
            const rheo_real *now = rheo_world_positions(world) + 3 * (size_t)ahead;
            double apart[3], along = 0, square = 0, norm = 0;
            for (int a = 0; a < 3; a++) {
                apart[a] = (double)now[3 + a] - (double)now[a];
                along += apart[a] * (double)direction[a];
                square += apart[a] * apart[a];
                norm += (double)direction[a] * (double)direction[a];
                NEAR(((double)now[3 + a] + (double)now[a]) / 2, 1.5 + a, 1e-5);
            }
            assert_true(square > 1e-8);
            for (int a = 0; a < 3; a++)
                NEAR(apart[a] / sqrt(square), (along > 0 ? 1 : -1) * (double)direction[a] / sqrt(norm), 1e-3);
            rheo_world_destroy(world);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spring_pair_decays_and_rings),
        cmocka_unit_test(spring_pair_is_stable_up_to_four_thirds),
        cmocka_unit_test(implicit_solver_is_stable_at_any_stiffness),
        cmocka_unit_test(plasticity_of_a_held_spring),
        cmocka_unit_test(the_largest_displacement_by_pressure_is_reported),
        cmocka_unit_test(densities_are_reported_in_rest_densities),
        cmocka_unit_test(no_plasticity_below_yield),
        cmocka_unit_test(springs_form_at_their_distance_and_end_beyond_the_support),
        cmocka_unit_test(viscosity_of_a_pair),
        cmocka_unit_test(density_relaxation_of_a_pair),
        cmocka_unit_test(momentum_is_conserved_in_free_space),
        cmocka_unit_test(angular_momentum_of_a_rotating_pair_is_not_conserved),
        cmocka_unit_test(history_rate_is_the_fractional_derivative),
        cmocka_unit_test(sums_made_ahead_are_the_plain_sums),
        cmocka_unit_test(rings_are_recorded_velocities),
        cmocka_unit_test(stiffness_metrics_are_those_of_the_springs),
        cmocka_unit_test(displacement_metrics_are_the_largest_displacements),
        cmocka_unit_test(springs_of_new_particles_begin_at_rest),
        cmocka_unit_test(history_ignores_common_motion),
        cmocka_unit_test(bare_worlds_derive_only_the_substep),
        cmocka_unit_test(the_stiffness_of_a_spring_follows_from_its_rate),
        cmocka_unit_test(densities_have_no_unit_without_a_rest_density),
        cmocka_unit_test(coinciding_particles_part_in_their_direction),
    };
    return cmocka_run_group_tests_name("model", tests, NULL, NULL);
}
