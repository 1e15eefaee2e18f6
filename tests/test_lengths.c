/*
 * The history of the length of springs (history.of length): a body that turns has none, a stretch has that of the
 * vector, and no step or file depends on how it is stored.
 */
#include "support.h"

#include <math.h>

#include "record/head.h"
#include "thickening/thickening.h"
#include "world/model_thickening.h"

#define PATH "test_lengths.rlog"
#define STEP 0.033

/* ---- Samples ---- */

static void samples_ascend_to_the_end_of_the_window(void **unused)
{
    (void)unused;
    static const uint32_t FIRST[] = {0, 1, 2, 3, 4, 6, 8, 11, 14, 18, 23};
    for (size_t i = 0; i + 1 < sizeof FIRST / sizeof *FIRST; i++)
        assert_int_equal(rheo_history_next_sample(FIRST[i], 1000), FIRST[i + 1]);
    assert_int_equal(rheo_history_next_sample(4, 5), 5);
    assert_int_equal(rheo_history_next_sample(5, 5), 5);
    assert_int_equal(rheo_history_next_sample(7, 5), 5);
    assert_int_equal(rheo_history_next_sample(UINT32_MAX - 1, UINT32_MAX), UINT32_MAX);
    for (uint32_t window = 1; window <= 1000000; window = window < 200 ? window + 1 : 5 * window)
        assert_in_range(rheo__sample_count(window), 3, RHEO__MOST_SAMPLES);
    assert_in_range(rheo__sample_count(1000000), 3, RHEO__MOST_SAMPLES);
    assert_int_equal(rheo__sample_count(1), 3);
    assert_int_equal(rheo__sample_count(150), 20);
}

/* ---- Springs whose ends move as prescribed ---- */

enum { ENDS = 18 };

static rheo_world_def spring_def(rheo_history_of of, uint32_t window, uint32_t lag)
{
    rheo_world_def def = inert_def();
    def.step = STEP;
    def.springs.stiffness = 15;
    def.history.stiffness = 150;
    def.history.window = window;
    def.history.lag = lag;
    def.history.of = of;
    return def;
}

/* A spring between each even particle and the next one. */
static rheo_world *springs_of(rheo_world_def def, const rheo_real *position)
{
    static uint32_t ends[ENDS];
    static rheo_real length[ENDS / 2];
    for (uint32_t i = 0; i < ENDS; i++)
        ends[i] = i;
    for (uint32_t i = 0; i < ENDS / 2; i++)
        length[i] = 1;
    def.particles.spring_count = ENDS / 2;
    def.particles.spring_ends = ends;
    def.particles.spring_rest_length = length;
    return world_of(def, ENDS, position, NULL);
}

static void move_to(rheo_world *world, const rheo_real *position, const rheo_real *velocity)
{
    memcpy(world->state.position, position, 3 * ENDS * sizeof *position);
    memcpy(world->state.velocity, velocity, 3 * ENDS * sizeof *velocity);
    OK(rheo__stage_history(&world->state, rheo__thickening_of(world)));
}

static rheo_spring_state spring_state(const rheo_world *world, uint32_t a)
{
    rheo_spring_state state;
    OK(rheo_world_spring(world, a, a + 1, &state, &error));
    const rheo_world_def *def = rheo_world_definition(world);
    const double n = state.history_rate, onset = def->history.onset;
    NEAR(state.stiffness, 15 + def->history.stiffness * (n > 0 ? n * n / (n + onset) : 0), 1e-5 * state.stiffness);
    return state;
}

/* A body with springs of length 1 in several directions, turned by this angle about an axis through (1, 2, 3). */
static void turned(double angle, double speed, rheo_real *position, rheo_real *velocity)
{
    for (int i = 0; i < ENDS; i++) {
        const double along = 0.3 * (i / 2), x = cos(along) * (i % 2) + 0.4 * (i / 2),
                     y = sin(along) * (i % 2) - 0.2 * (i / 2);
        const double px = cos(angle) * x - sin(angle) * y, py = sin(angle) * x + cos(angle) * y;
        position[3 * i] = (rheo_real)(1 + px);
        position[3 * i + 1] = (rheo_real)(2 + py);
        position[3 * i + 2] = (rheo_real)(3 + 0.4 * (i / 2));
        velocity[3 * i] = (rheo_real)(-speed * py);
        velocity[3 * i + 1] = (rheo_real)(speed * px);
        velocity[3 * i + 2] = 0;
    }
}

/*
 * The ends of a spring along a unit vector have the relative velocity (-w sin wt, w cos wt), so n is that of D^q of it:
 * by vector. By length it is 0 but for the rounding of positions up to 8: each of two lengths is wrong by at most
 * 2 x 8 units of 2^-24, and the weights of all differences of length add up to 12.
 */
static void a_body_that_turns_has_no_history_of_length(void **unused)
{
    (void)unused;
    enum { STEPS = 120, WINDOW = 60 };
    static double of_x[STEPS], of_y[STEPS], x[STEPS], y[STEPS];
    const double unit = RHEO_DOUBLE ? 0x1p-53 : 0x1p-24, speeds[] = {0.1, 1, 7, 60, 1000};
    for (size_t s = 0; s < sizeof speeds / sizeof *speeds; s++) {
        const double speed = speeds[s];
        rheo_real position[3 * ENDS], velocity[3 * ENDS];
        turned(0, speed, position, velocity);
        rheo_world *vector = springs_of(spring_def(RHEO_HISTORY_OF_VECTOR, WINDOW, 0), position),
                   *length = springs_of(spring_def(RHEO_HISTORY_OF_LENGTH, WINDOW, 0), position);
        for (int n = 0; n < STEPS; n++) {
            const double angle = speed * STEP * (n + 1);
            turned(angle, speed, position, velocity);
            move_to(vector, position, velocity);
            move_to(length, position, velocity);
            x[n] = -speed * sin(angle);
            y[n] = speed * cos(angle);
        }
        OK(rheo_fractional_derivative(x, STEPS, .5, STEP, WINDOW, RHEO_WEIGHTS_PAPER, of_x));
        OK(rheo_fractional_derivative(y, STEPS, .5, STEP, WINDOW, RHEO_WEIGHTS_PAPER, of_y));
        const double n = hypot(of_x[STEPS - 1], of_y[STEPS - 1]);
        for (uint32_t a = 0; a < ENDS; a += 2) {
            NEAR(spring_state(vector, a).history_rate, n, 1e-4 * speed);
            assert_true(n > 0.1 * sqrt(speed));
            assert_true(spring_state(length, a).history_rate <= 2 * 16 * unit * 12);
        }
        rheo_world_destroy(vector);
        rheo_world_destroy(length);
    }
}

/* Lengths l of the springs; both ends also drift. */
static void stretched(double l, double drift, rheo_real *position)
{
    for (int i = 0; i < ENDS; i++) {
        const double along = 0.7 * (i / 2), by = (1 + 0.1 * (i / 2)) * l * (i % 2);
        position[3 * i] = (rheo_real)(cos(along) * by + drift);
        position[3 * i + 1] = (rheo_real)(sin(along) * by);
        position[3 * i + 2] = (rheo_real)(3 * (i / 2));
    }
}

/* While a window is filled with one speed, D^q of a length is that of the vector. */
static void a_steady_stretch_has_the_history_of_the_vector(void **unused)
{
    (void)unused;
    enum { WINDOW = 37, LAG = 3, STEPS = WINDOW + LAG + 2 };
    for (int weights = RHEO_WEIGHTS_PAPER; weights <= RHEO_WEIGHTS_L1; weights++) {
        const double speed = 0.5;
        rheo_world *world[2];
        rheo_real position[3 * ENDS], velocity[3 * ENDS] = {0};
        double expected = 0, weight[WINDOW + 1];
        for (int i = 0; i < ENDS; i += 2) {
            velocity[3 * i + 3] = (rheo_real)((1 + 0.1 * (i / 2)) * speed * cos(0.7 * (i / 2)));
            velocity[3 * i + 4] = (rheo_real)((1 + 0.1 * (i / 2)) * speed * sin(0.7 * (i / 2)));
        }
        stretched(1, 0, position);
        for (int of = 0; of < 2; of++) {
            rheo_world_def def = spring_def((rheo_history_of)of, WINDOW, LAG);
            def.history.weights = (rheo_weights)weights;
            world[of] = springs_of(def, position);
        }
        for (int n = 1; n <= STEPS; n++) {
            stretched(1 + speed * STEP * n, 0, position);
            move_to(world[0], position, velocity);
            move_to(world[1], position, velocity);
        }
        if (weights == RHEO_WEIGHTS_PAPER)
            rheo_history_weights(.5, WINDOW + 1, weight);
        else
            rheo_history_weights_l1(.5, WINDOW + 1, weight);
        for (int m = 0; m <= WINDOW; m++)
            expected += weight[m] * speed * rheo_history_scale(.5, STEP, (rheo_weights)weights);
        for (uint32_t a = 0; a < ENDS; a += 2) {
            const double rate = (1 + 0.1 * (a / 2)) * expected;
            NEAR(spring_state(world[0], a).history_rate, rate, 1e-5 * rate);
            NEAR(spring_state(world[1], a).history_rate, rate, 1e-4 * rate);
        }
        rheo_world_destroy(world[0]);
        rheo_world_destroy(world[1]);
    }
}

/* Length of the springs after step n, which jumps once. */
static double uneven(int n)
{
    return 1.2 + 0.1 * sin(0.4 * n) + (n > 20 ? 0.3 : 0);
}

/*
 * D^q of any length in double: each step has the mean weight of the steps between two samples. The stage has the bits of
 * the query for all pairs, also those without a spring, with any SIMD variant.
 */
static void a_length_is_linear_between_samples(void **unused)
{
    (void)unused;
    enum { WINDOW = 29, STEPS = 70 };
    static const rheo_curve_point CURVE[] = {{0, 1}, {0.3, 2}, {0.95, 0}}; /* 29 steps */
    for (int lag = 0; lag <= 2; lag += 2)
        for (int curve = 0; curve < 2; curve++) {
            rheo_world_def def = spring_def(RHEO_HISTORY_OF_LENGTH, WINDOW, (uint32_t)lag);
            def.history.curve = curve ? CURVE : NULL;
            def.history.curve_count = curve ? 3 : 0;
            def.fluid.support = 4;
            rheo_real position[3 * ENDS], velocity[3 * ENDS] = {0};
            double exact[WINDOW + 1], first[WINDOW + 1], scale = curve ? 1 : rheo_history_scale(.5, STEP, 0);
            stretched(uneven(0), 5, position);
            rheo_world *world = springs_of(def, position);
            rheo__thickening *t = rheo__thickening_of(world);
            assert_int_equal(rheo_world_history_window(world), WINDOW);
            if (curve)
                OK(rheo_history_curve_weights(CURVE, 3, STEP, WINDOW + 1, exact, first));
            else
                rheo_history_weights(.5, WINDOW + 1, exact);
            for (int n = 0; n < STEPS; n++) {
                double sum = 0;
                for (uint32_t m = 0, next; m < WINDOW + 1; m = next) {
                    double mean = 0;
                    next = rheo_history_next_sample(m, WINDOW + 1);
                    for (uint32_t k = m; k < next; k++)
                        mean += exact[k] / (next - m);
                    for (int k = (int)m; k < (int)next; k++)
                        if (n - lag - k >= 1)
                            sum += scale * mean * (uneven(n - lag - k) - uneven(n - lag - k - 1)) / STEP;
                }
                for (uint32_t a = 0; a < ENDS; a += 2)
                    NEAR(spring_state(world, a).history_rate, (1 + 0.1 * (a / 2)) * fabs(sum), 2e-4);
                OK(rheo__stage_neighbours(&world->state, t));
                for (uint32_t v = 0; rheo_simd_available(v); v++) {
                    OK(rheo_use_simd(rheo_simd_available(v), &error));
                    OK(rheo__stage_fractional_derivative_lengths(&world->state, t));
                    for (uint32_t i = 0; i < t->pairs->rows; i++)
                        for (size_t k = rheo__pairs_first(t->pairs, i); k < rheo__pairs_end(t->pairs, i);
                             k += t->pairs->width) {
                            const uint32_t j = rheo__pairs_partner(t->pairs, k);
                            if (j < t->pairs->rows)
                                assert_true(rheo__length_derivative(&world->state, t, t->pairs->id_of[i],
                                                                    t->pairs->id_of[j]) == t->pair_derivative[k]);
                        }
                }
                stretched(uneven(n + 1), 5 + 0.1 * n, position);
                move_to(world, position, velocity);
            }
            rheo_world_destroy(world);
        }
}

/* ---- Whole worlds ---- */

/* Largest K of a free block of fluid that turns, in k_min. */
static double stiffest_of_turning(rheo_history_of of)
{
    enum { SIDE = 4, N = SIDE * SIDE * SIDE };
    static rheo_real position[3 * N], velocity[3 * N];
    rheo_world_def def = spring_def(of, 30, 0);
    def.substeps = 4;
    for (int i = 0; i < N; i++) {
        const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        for (int axis = 0; axis < 3; axis++)
            position[3 * i + axis] = (rheo_real)(at[axis] - 0.5 * (SIDE - 1));
        velocity[3 * i] = -position[3 * i + 2];
        velocity[3 * i + 1] = 0;
        velocity[3 * i + 2] = position[3 * i];
    }
    rheo_world *world = world_of(def, N, position, velocity);
    step(world, 40);
    double most = 0;
    for (uint32_t id = 0; id < N; id++) {
        rheo_particle_state state;
        OK(rheo_world_particle(world, id, &state, &error));
        most = state.stiffness > most ? state.stiffness : most;
        if (of == RHEO_HISTORY_OF_LENGTH)
            assert_true(state.derivative[0] == 0 && state.derivative[1] == 0 && state.derivative[2] == 0);
    }
    const double substep = def.step / 4;
    assert_true(metric(world, "stiffness_number") > 0.5 * substep * substep * most);
    rheo_world_destroy(world);
    return most / 15;
}

/* The springs hold the block together, so they stretch at first: that alone is left. */
static void a_turning_block_hardly_stiffens_by_length(void **unused)
{
    (void)unused;
    const double vector = stiffest_of_turning(RHEO_HISTORY_OF_VECTOR),
                 length = stiffest_of_turning(RHEO_HISTORY_OF_LENGTH);
    if (!(vector > 15 && length < 1 + 0.2 * (vector - 1)))
        fail_msg("a turning block has the stiffness %g by vector, %g by length", vector, length);
}

static rheo_world *lively_lengths(uint32_t lag)
{
    rheo_scene scene = lively_scene();
    scene.world.history.of = RHEO_HISTORY_OF_LENGTH;
    scene.world.history.lag = lag;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    return world;
}

static void every_simd_variant_has_the_same_bits(void **unused)
{
    (void)unused;
    uint64_t hash = 0;
    for (uint32_t v = 0; rheo_simd_available(v); v++) {
        OK(rheo_use_simd(rheo_simd_available(v), &error));
        rheo_world *world = lively_lengths(2);
        step(world, 25);
        assert_true(v == 0 || rheo_world_hash(world) == hash);
        hash = rheo_world_hash(world);
        assert_true(metric(world, "stiffness_number") > 0);
        rheo_world_destroy(world);
    }
}

/* Recorded with and without all states, read at any step, saved again, and run on. */
static void any_step_is_resumed(void **unused)
{
    (void)unused;
    enum { STEPS = 22 };
    const rheo_real position[6] = {8, 20, 8, 9, 20, 8}, velocity[6] = {0, -9, 0, 0, -8, 0};
    for (int full = 0; full < 2; full++) {
        uint64_t hash[STEPS + 1];
        rheo_world *world = lively_lengths((uint32_t)full);
        rheo_recorder *recorder;
        rheo_recording *recording;
        const rheo_record_options options = {.scene = "lengths", .keyframe_spacing = 7, .full = full, .force = true};
        OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
        hash[0] = rheo_world_hash(world);
        for (int n = 1; n <= STEPS; n++) {
            if (n == 5)
                OK(rheo_world_add_particles(world, 2, position, velocity, &error));
            if (n == 9)
                OK(rheo_world_set(world, "history.order", "0.3", &error));
            OK(rheo_recorder_step(recorder, &error));
            hash[n] = rheo_world_hash(world);
        }
        OK(rheo_recorder_close(recorder, &error));
        rheo_world_destroy(world);
        OK(rheo_recording_open(PATH, &recording, &error));
        for (int from = 0; from <= STEPS; from += from < 8 ? 1 : 3) {
            rheo_world *copy;
            OK(rheo_recording_world(recording, (uint64_t)from, NULL, &world, &error));
            assert_true(rheo_world_hash(world) == hash[from]);
            void *bytes;
            size_t size;
            rheo_recording *checkpoint;
            OK(rheo_world_save_memory(world, "lengths", &bytes, &size, &error));
            OK(rheo_recording_open_memory(bytes, size, &checkpoint, &error));
            OK(rheo_recording_world(checkpoint, (uint64_t)from, NULL, &copy, &error));
            assert_true(rheo_world_hash(copy) == hash[from]);
            for (int n = from + 1; n <= STEPS && from >= 9; n++) {
                step(world, 1);
                step(copy, 1);
                assert_true(rheo_world_hash(world) == hash[n] && rheo_world_hash(copy) == hash[n]);
            }
            rheo_world_destroy(world);
            rheo_world_destroy(copy);
            rheo_recording_close(checkpoint);
            free(bytes);
        }
        rheo_recording_close(recording);
        rheo_verification verification;
        OK(rheo_verify(PATH, &verification, &error));
        remove(PATH);
    }
}

/* Particles that are added have been at rest. */
static void a_new_particle_has_been_at_rest(void **unused)
{
    (void)unused;
    rheo_world_def def = spring_def(RHEO_HISTORY_OF_LENGTH, 6, 0);
    def.history.onset = 0;
    const rheo_real old[3] = {0, 0, 0}, new[6] = {1.5, 0, 0, 1.5, 1, 0}, speed[3] = {(rheo_real)0.5, 0, 0};
    rheo_world *world = world_of(def, 1, old, speed);
    step(world, 4);
    OK(rheo_world_add_particles(world, 2, new, NULL, &error));
    const rheo__thickening *t = rheo__thickening_of(world);
    assert_true(rheo__length_derivative(&world->state, t, 1, 2) == 0);
    double weight[4], expected = 0;
    rheo_history_weights(.5, 4, weight);
    for (int m = 0; m < 4; m++) /* the old one has come nearer at its speed */
        expected += rheo_history_scale(.5, STEP, RHEO_WEIGHTS_PAPER) * weight[m] * 0.5;
    NEAR(rheo__length_derivative(&world->state, t, 0, 1), expected, 1e-5);
    rheo_world_destroy(world);
}

static void a_world_may_begin_without_particles(void **unused)
{
    (void)unused;
    const rheo_real position[6] = {0, 0, 0, 1, 0, 0}, velocity[6] = {0, 0, 0, (rheo_real)0.5, 0, 0};
    rheo_world *world = world_of(spring_def(RHEO_HISTORY_OF_LENGTH, 6, 0), 0, NULL, NULL);
    step(world, 3);
    OK(rheo_world_add_particles(world, 2, position, velocity, &error));
    assert_true(rheo__length_derivative(&world->state, rheo__thickening_of(world), 0, 1) == 0);
    step(world, 3);
    assert_true(rheo__length_derivative(&world->state, rheo__thickening_of(world), 0, 1) > 0.1);
    rheo_world_destroy(world);
}

/* ---- What is stored ---- */

static bool has_field(const rheo_world *world, const char *name, uint64_t *rows)
{
    rheo_field_info info;
    for (uint32_t i = 0; rheo_world_field(world, i, &info) == RHEO_OK; i++)
        if (strcmp(info.name, name) == 0) {
            *rows = info.rows;
            return true;
        }
    return false;
}

static void positions_are_stored_instead_of_velocities(void **unused)
{
    (void)unused;
    uint64_t rows;
    rheo_world *vector = lively_world(), *length = lively_lengths(3);
    const uint32_t n = rheo_world_particle_count(length);
    assert_false(has_field(vector, "history_position", &rows));
    assert_false(has_field(length, "history_velocity", &rows) || has_field(length, "derivative", &rows));
    for (uint32_t s = 0; s <= 20; s++) {
        assert_true(has_field(length, "history_position", &rows));
        assert_int_equal(rows, s < 14 ? s + 1 : 15); /* lag + window + 2 */
        assert_int_equal(rheo_world_history_rows(length), s < 14 ? s : 14);
        step(length, 1);
    }
    assert_int_equal(rheo_world_history_bytes(length), (size_t)15 * n * 3 * sizeof(rheo_real));
    rheo_real before[3], mean[3 * 14], other[3 * 14], difference[3 * 14];
    memcpy(before, rheo_world_positions(length) + 3 * 5, sizeof before);
    step(length, 1);
    OK(rheo_world_particle_history(length, 5, mean));
    for (size_t axis = 0; axis < 3; axis++)
        assert_true(mean[axis] == (rheo_world_positions(length)[3 * 5 + axis] - before[axis]) / (rheo_real)STEP);
    OK(rheo_world_particle_history(length, 6, other));
    OK(rheo_world_spring_history(length, 5, 6, difference));
    for (int i = 0; i < 3 * 14; i++)
        assert_true(difference[i] == mean[i] - other[i]);
    rheo__ring_block(&length->state.ring, 0, rheo__ring_slot(&length->state.ring, 2))[4] = (rheo_real)INFINITY;
    REFUSED(RHEO_ERROR_FORMAT, "history_position of particle 1 at lag 2 is not finite",
            rheo__world_check_state(length, true, &error));
    rheo_world_destroy(vector);
    rheo_world_destroy(length);
}

/* A list of materials that all have the parameters of the main one changes no bit; others have means. */
static void springs_between_materials_have_means(void **unused)
{
    (void)unused;
    rheo_real position[6] = {0, 0, 0, 1, 0, 0}, velocity[6] = {0, 0, 0, (rheo_real)0.5, 0, 0};
    rheo_world_def def = spring_def(RHEO_HISTORY_OF_LENGTH, 8, 0);
    rheo_material same = rheo_default_material("same"), other = rheo_default_material("other");
    other.springs.stiffness = 45;
    other.history.stiffness = 750;
    other.history.onset = 0.15;
    rheo_world *plain = world_of(def, 2, position, velocity);
    OK(rheo_world_def_add_material(&def, &same, &error));
    OK(rheo_world_def_add_material(&def, &other, &error));
    const uint32_t of_same[2] = {0, 1}, of_both[2] = {0, 2};
    def.particles.material = of_same;
    rheo_world *alike = world_of(def, 2, position, velocity);
    def.particles.material = of_both;
    rheo_world *mixed = world_of(def, 2, position, velocity);
    for (int n = 0; n < 6; n++) {
        rheo_spring_state a, b;
        step(plain, 1);
        step(alike, 1);
        assert_memory_equal(plain->state.position, alike->state.position, sizeof position);
        if (n) /* the spring comes with the first step */
            OK(rheo_world_spring(mixed, 0, 1, &a, &error));
        step(mixed, 1);
        OK(rheo_world_spring(mixed, 0, 1, &b, &error));
        NEAR(b.stiffness, 30 + 450 * b.history_rate * b.history_rate / (b.history_rate + 0.1), 1e-4 * b.stiffness);
        const double substep = STEP / metric(mixed, "substeps");
        if (n) /* that of the step is from the history before it */
            NEAR(metric(mixed, "stiffness_number"), substep * substep * a.stiffness,
                 1e-5 * substep * substep * a.stiffness);
    }
    rheo_world_destroy(plain);
    rheo_world_destroy(alike);
    rheo_world_destroy(mixed);
}

/* Programs that do not know the parameter read a file of a world with histories of vectors. */
static bool names_it(const rheo_world_def *def)
{
    rheo__bytes bytes = {0};
    bool found = false;
    rheo__parameters_put(&bytes, def);
    assert_true(!bytes.failed);
    for (size_t i = 0; i + 10 <= bytes.size; i++)
        found = found || memcmp((const char *)bytes.data + i, "history.of", 10) == 0;
    rheo__bytes_release(&bytes);
    return found;
}

static void a_file_names_only_histories_of_length(void **unused)
{
    (void)unused;
    rheo_world_def def = rheo_default_world_def();
    assert_true(def.history.of == RHEO_HISTORY_OF_VECTOR && !names_it(&def));
    def.history.of = RHEO_HISTORY_OF_LENGTH;
    assert_true(names_it(&def));
}

/* ---- The parameter ---- */

static void what_a_history_of_length_cannot_be_is_refused(void **unused)
{
    (void)unused;
    static const char *const CASE[][3] = {
        {"scheme", "sequential", "history.of length needs scheme summed"},
        {"history.kind", "window-fast", "history.of length needs history.kind window"},
        {"history.kind", "full", "history.of length needs history.kind window"},
        {"history.kind", "tempered", "history.of length needs history.kind window"},
        {"history.hardening", "passive", "history.of length needs history.hardening active"},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof *CASE; i++) {
        rheo_world_def def = rheo_default_world_def();
        rheo_world *world;
        OK(rheo_world_def_set(&def, CASE[i][0], CASE[i][1], &error));
        OK(rheo_world_def_check(&def, &error));
        OK(rheo_world_def_set(&def, "history.of", "length", &error));
        REFUSED(RHEO_ERROR_ARGUMENT, CASE[i][2], rheo_world_create(&def, &world, &error));
    }
    rheo_world *world = lively_lengths(0);
    step(world, 2);
    REFUSED(RHEO_ERROR_ARGUMENT, "history.of is fixed", rheo_world_set(world, "history.of", "vector", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "history.of length needs history.hardening active",
            rheo_world_set(world, "history.hardening", "passive", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "remembers positions that are the present step apart",
            rheo_world_set(world, "step", "0.02", &error));
    OK(rheo_world_set(world, "step", "0.033", &error));
    OK(rheo_world_set(world, "history.weights", "l1", &error));
    const double scale = rheo_history_scale(.5, STEP, RHEO_WEIGHTS_L1) / STEP; /* the weight of lag 0 is 1 */
    NEAR(rheo__thickening_of(world)->samples.weight[0], scale, 1e-6 * scale);
    step(world, 1);
    const uint64_t rows = *world->state.history_rows;
    *world->state.history_rows = 0;
    REFUSED(RHEO_ERROR_FORMAT, "the history has no position", rheo__world_check_state(world, false, &error));
    *world->state.history_rows = rows;
    OK(rheo__world_check_state(world, true, &error));
    rheo_world_destroy(world);
}

/* All scenes that remember a window, of the thickening model, have a valid definition. */
static void built_in_scenes_take_it(void **unused)
{
    (void)unused;
    int taken = 0, refused = 0;
    for (size_t i = 0; i < rheo_scene_builtin_count(); i++) {
        rheo_scene scene;
        OK(rheo_scene_builtin_at(i, &scene));
        if (scene.world.model == RHEO_MODEL_THICKENING) {
            const bool window = scene.world.history.kind == RHEO_HISTORY_WINDOW,
                       periodic = scene.world.space.period[0] > 0;
            OK(rheo_scene_set(&scene, "history.of", "length", &error));
            if (window && !periodic)
                OK(rheo_world_def_check(&scene.world, &error));
            else
                REFUSED(RHEO_ERROR_ARGUMENT, periodic ? "space.period" : "history.kind window",
                        rheo_world_def_check(&scene.world, &error));
            taken += window && !periodic;
            refused += !window || periodic;
        }
        rheo_scene_release(&scene);
    }
    assert_true(taken > 10 && refused == 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_ascend_to_the_end_of_the_window),
        cmocka_unit_test(a_body_that_turns_has_no_history_of_length),
        cmocka_unit_test(a_steady_stretch_has_the_history_of_the_vector),
        cmocka_unit_test(a_length_is_linear_between_samples),
        cmocka_unit_test(a_turning_block_hardly_stiffens_by_length),
        cmocka_unit_test(every_simd_variant_has_the_same_bits),
        cmocka_unit_test(any_step_is_resumed),
        cmocka_unit_test(a_new_particle_has_been_at_rest),
        cmocka_unit_test(a_world_may_begin_without_particles),
        cmocka_unit_test(positions_are_stored_instead_of_velocities),
        cmocka_unit_test(springs_between_materials_have_means),
        cmocka_unit_test(a_file_names_only_histories_of_length),
        cmocka_unit_test(what_a_history_of_length_cannot_be_is_refused),
        cmocka_unit_test(built_in_scenes_take_it),
    };
    return cmocka_run_group_tests_name("lengths", tests, NULL, NULL);
}
