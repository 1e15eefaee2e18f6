/*
 * Curves of the history (history.curve): weights by age in seconds. Exact integrals, the power law as a curve,
 * convergence in the step, worlds, scene files, recordings, and everything that is refused.
 */
#include "resume.h"

#include <float.h>
#include <math.h>

#include "rheolog/scene_json.h"

#include "record/chunk.h"
#include "record/head.h"
#include "thickening/thickening.h"
#include "world/model_thickening.h"

#define STEP 0.033
#define PATH "test_curve.rlog"

static const rheo_curve_point CURVE[] = {{0, 3}, {.066, 1.5}, {.08, 2}, {.085, -1}, {.17, .5}, {.231, 0}};
enum { POINTS = sizeof CURVE / sizeof *CURVE };

/* w at an age. */
static double at(const rheo_curve_point *curve, size_t points, double age)
{
    for (size_t i = 0; i + 1 < points; i++)
        if (age >= curve[i].age && age <= curve[i + 1].age)
            return curve[i].weight +
                   (curve[i + 1].weight - curve[i].weight) * (age - curve[i].age) / (curve[i + 1].age - curve[i].age);
    return 0;
}

/* Gauss's rule of three points, exact for products of w, hat functions and squares, between two ages. */
static double gauss(const rheo_curve_point *curve, size_t points, double from, double to, double (*f)(double, double),
                    double parameter)
{
    const double half = (to - from) / 2, middle = (to + from) / 2, x = half * sqrt(.6);
    const double ages[] = {middle - x, middle, middle + x}, shares[] = {5, 8, 5};
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += shares[i] / 9 * half * at(curve, points, ages[i]) * f(ages[i], parameter);
    return sum;
}

/* Integral over all pieces between points of the curve and multiples of the step. */
static double integral(const rheo_curve_point *curve, size_t points, double step, double (*f)(double, double),
                       double parameter)
{
    double sum = 0;
    for (size_t i = 0; i + 1 < points; i++)
        for (double from = curve[i].age, to = 0; from < curve[i + 1].age; from = to) {
            to = fmin((floor(from / step + 1e-9) + 1) * step, curve[i + 1].age);
            sum += gauss(curve, points, from, to, f, parameter);
        }
    return sum;
}

static double one(double age, double unused)
{
    return 1 + 0 * (age + unused);
}
static double age_itself(double age, double unused)
{
    return age + 0 * unused;
}
static double hat_step;
static double hat(double age, double lag)
{
    return fmax(1 - fabs(age / hat_step - lag), 0);
}
static double older_half(double age, double lag)
{
    return age <= lag * hat_step ? hat(age, lag) : 0;
}

static uint64_t seed = 5;
static double random_unit(void)
{
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(seed >> 11) / 9007199254740992.0;
}

static void weights_are_integrals_of_the_curve(void **unused)
{
    (void)unused;
    enum { MOST = 700 };
    static double weight[MOST], first[MOST];
    for (int round = 0; round < 40; round++) {
        rheo_curve_point curve[20];
        const size_t points = 2 + (size_t)(18 * random_unit());
        double age = round % 3 ? 0 : random_unit();
        for (size_t i = 0; i < points; i++) {
            curve[i] = (rheo_curve_point){age, 4 * random_unit() - 1};
            age += round % 2 ? .01 + .3 * random_unit() : .033 * (1 + floor(4 * random_unit()));
        }
        const double step = hat_step = round % 4 == 1 ? .5 : .033;
        const uint32_t window = rheo_history_curve_window(curve, points, step);
        assert_true(window >= 1 && window < MOST - 3);
        assert_true(window * step >= curve[points - 1].age * (1 - 1e-8));
        assert_true(window == 1 || (window - 1) * step < curve[points - 1].age);
        OK(rheo_history_curve_weights(curve, points, step, window + 3, weight, first));
        double sum = 0, moment = 0, size = 0;
        for (uint32_t m = 0; m < window + 3; m++) {
            NEAR(weight[m], integral(curve, points, step, hat, m), 1e-12);
            if (m)
                NEAR(first[m], integral(curve, points, step, older_half, m), 1e-12);
            sum += weight[m];
            moment += m * step * weight[m];
            size += fabs(weight[m]);
        }
        assert_true(first[0] == weight[0] && weight[window + 1] == 0 && weight[window + 2] == 0);
        /* Constant and linear velocities are integrated exactly. */
        NEAR(sum, integral(curve, points, step, one, 0), 1e-12 * (1 + size));
        NEAR(moment, integral(curve, points, step, age_itself, 0), 1e-11 * (1 + size * age));
        /* Fewer weights are the same. */
        double few[3] = {7, 7, 7};
        OK(rheo_history_curve_weights(curve, points, step, 2, few, NULL));
        assert_true(few[0] == weight[0] && few[1] == weight[1] && few[2] == 7);
    }
}

static void the_window_ends_with_the_curve(void **unused)
{
    (void)unused;
    rheo_curve_point curve[] = {{0, 1}, {.33, 1}};
    assert_int_equal(rheo_history_curve_window(curve, 2, .033), 10); /* .33/.033 is rounded up to more than 10 */
    curve[1].age = .3301;
    assert_int_equal(rheo_history_curve_window(curve, 2, .033), 11);
    curve[1].age = .001;
    assert_int_equal(rheo_history_curve_window(curve, 2, .033), 1);
    curve[1].age = 33000;
    assert_int_equal(rheo_history_curve_window(curve, 2, .033), 1000000);
    curve[1].age = 33001;
    assert_int_equal(rheo_history_curve_window(curve, 2, .033), 0);
    curve[1].age = NAN;
    assert_int_equal(rheo_history_curve_window(curve, 2, .033), 0);
    assert_int_equal(rheo_history_curve_window(curve, 1, .033), 0);
    assert_int_equal(rheo_history_curve_window(NULL, 2, .033), 0);
    curve[1].age = 1;
    assert_int_equal(rheo_history_curve_window(curve, 2, 0), 0);
    assert_int_equal(rheo_history_curve_window(curve, 2, NAN), 0);
}

/* ---- Worlds fed with a signal ---- */

enum { PARTICLES = 200 };

static rheo_world_def def_of(const rheo_curve_point *curve, size_t points, double step)
{
    static rheo_real position[3 * PARTICLES];
    for (int i = 0; i < PARTICLES; i++)
        position[3 * i] = (rheo_real)(9 * i);
    rheo_world_def def = rheo_default_world_def();
    def.step = step;
    def.history.curve = curve;
    def.history.curve_count = (uint32_t)points;
    def.particles.count = PARTICLES;
    def.particles.position = position;
    return def;
}

static rheo_world *world_from(const rheo_world_def *def)
{
    rheo_world *world;
    OK(rheo_world_create(def, &world, &error));
    return world;
}

static void feed(rheo_world *world, double v)
{
    for (int i = 0; i < PARTICLES; i++)
        world->state.velocity[3 * i + 1] = (rheo_real)(v * (1 + i % 7));
    OK(rheo__stage_history(&world->state, rheo__thickening_of(world)));
}

/* D x of particle 0 by the stage; queries have the same bits. */
static double derivative(rheo_world *world)
{
    rheo__thickening *t = rheo__thickening_of(world);
    rheo_real queried[3 * PARTICLES];
    OK(rheo__stage_fractional_derivative(&world->state, t));
    rheo__derivatives(&world->state, t, queried);
    assert_memory_equal(queried, world->state.derivative, sizeof queried);
    return (double)world->state.derivative[1];
}

/*
 * The curve whose weights are those of the power law: W_m = step (w_(m-1) + 4 w_m + w_(m+1))/6 with the outer halves
 * missing at both ends, solved by elimination. With a full window the two are the same material.
 */
static void the_power_law_is_a_curve(void **unused)
{
    (void)unused;
    enum { WINDOW = 60, COUNT = WINDOW + 1 };
    const double scale = rheo_history_scale(.5, STEP, RHEO_WEIGHTS_PAPER);
    double wanted[COUNT], diagonal[COUNT];
    rheo_curve_point curve[COUNT];
    rheo_history_weights(.5, COUNT, wanted);
    for (int m = 0; m < COUNT; m++) {
        wanted[m] *= 6 * scale / STEP;
        diagonal[m] = m == 0 || m == WINDOW ? 2 : 4;
        if (m) {
            diagonal[m] -= 1 / diagonal[m - 1];
            wanted[m] -= wanted[m - 1] / diagonal[m - 1];
        }
    }
    for (int m = COUNT; m-- > 0;)
        curve[m] = (rheo_curve_point){m * STEP, (wanted[m] - (m < WINDOW ? curve[m + 1].weight : 0)) / diagonal[m]};
    rheo_world_def def = def_of(curve, COUNT, STEP), law = def_of(NULL, 0, STEP);
    law.history.window = WINDOW;
    rheo_world *world = world_from(&def), *other = world_from(&law);
    assert_int_equal(rheo_world_history_window(world), WINDOW);
    double largest = 0;
    for (int n = 0; n < 3 * WINDOW; n++) {
        const double v = sin(.11 * n) + (n > 70 && n < 90 ? 6 : 0);
        feed(world, v);
        feed(other, v);
        largest = fmax(largest, fabs(derivative(other)));
        if (n >= WINDOW)
            NEAR(derivative(world), derivative(other), (sizeof(rheo_real) == 4 ? 2e-6 : 1e-13) * largest);
    }
    rheo_world_destroy(world);
    rheo_world_destroy(other);
}

/* v = t^2 at time 1, also where the curve reaches back to before the first sample. */
static double squared(double age, double time)
{
    return age < time ? (time - age) * (time - age) : 0;
}

static void halving_the_step_converges(void **unused)
{
    (void)unused;
    static const rheo_curve_point shape[] = {{0, 2}, {.13, 5}, {.31, 1}, {.77, .25}, {1.3, 0}};
    for (size_t points = 4; points <= 5; points++) { /* the second reaches back to before the first sample */
        double before = 0, exact = 0;
        for (size_t i = 0; i + 1 < points; i++) {
            const double end = fmin(shape[i + 1].age, 1), from = shape[i].age, middle = (from + end) / 2;
            exact += gauss(shape, points, from, middle, squared, 1) + gauss(shape, points, middle, end, squared, 1);
        }
        for (int steps = 16; steps <= 256; steps *= 2) {
            const rheo_world_def def = def_of(shape, points, 1.0 / steps);
            rheo_world *world = world_from(&def);
            for (int n = 0; n <= steps; n++)
                feed(world, (double)n / steps * n / steps);
            const double error = fabs(derivative(world) / exact - 1);
            print_message("%zu points, step 1/%d: error %.3g\n", points, steps, error);
            assert_true(error < .5 / steps / steps + (sizeof(rheo_real) == 4 ? 2e-7 : 0));
            if (before > 1e-5)
                assert_true(before / error > 3.5);
            before = error;
            rheo_world_destroy(world);
        }
    }
}

static void a_lag_shifts_the_curve(void **unused)
{
    (void)unused;
    enum { LAG = 5 };
    rheo_world_def def = def_of(CURVE, POINTS, STEP), late = def;
    late.history.lag = LAG;
    rheo_world *world = world_from(&def), *other = world_from(&late);
    for (int n = 0; n < LAG; n++) {
        feed(other, sin(.3 * n));
        assert_true(derivative(other) == 0);
    }
    for (int n = 0; n < 40; n++) {
        feed(world, sin(.3 * n));
        feed(other, sin(.3 * (n + LAG)));
        assert_true(derivative(other) == derivative(world));
    }
    rheo_world_destroy(world);
    rheo_world_destroy(other);
}

/* ---- Running worlds and recordings ---- */

static rheo_scene lively(const rheo_curve_point *curve, size_t points)
{
    rheo_scene scene = lively_scene();
    scene.settle.time = 0;
    scene.world.history.curve = curve;
    scene.world.history.curve_count = (uint32_t)points;
    return scene;
}

static rheo_world *lively_with(const rheo_curve_point *curve, size_t points)
{
    const rheo_scene scene = lively(curve, points);
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    return world;
}

static void any_step_of_a_recording_is_resumed(void **unused)
{
    (void)unused;
    enum { STEPS = 12 };
    const rheo_record_options options = {.scene = "curve", .full = true, .keyframe_spacing = 5, .force = true};
    rheo_world *world;
    rheo_recorder *recorder;
    rheo_recording *recording;
    const uint64_t last = resume_every_step(lively_with(CURVE, POINTS), STEPS, PATH, "curve");
    OK(rheo_recording_open(PATH, &recording, &error));
    const rheo_world_def *def = rheo_recording_definition(recording);
    assert_int_equal(def->history.curve_count, POINTS);
    assert_memory_equal(def->history.curve, CURVE, sizeof CURVE);
    for (int from = 0; from <= STEPS; from++) {
        OK(rheo_recording_world(recording, (uint64_t)from, NULL, &world, &error));
        assert_int_equal(rheo_world_history_window(world), 7);
        assert_memory_equal(rheo_world_definition(world)->history.curve, CURVE, sizeof CURVE);
        rheo_world_destroy(world);
    }
    rheo_recording_close(recording);
    /* A run with the same curve continues the file; one with another is refused. */
    rheo_curve_point other[POINTS];
    memcpy(other, CURVE, sizeof CURVE);
    other[2].weight *= 1.0000001;
    world = lively_with(other, POINTS);
    REFUSED(RHEO_ERROR_ARGUMENT, "it has another history.curve than this run",
            rheo_recorder_continue(&world, PATH, &options, &recorder, &error));
    rheo_world_destroy(world);
    world = lively_with(CURVE, POINTS);
    OK(rheo_recorder_continue(&world, PATH, &options, &recorder, &error));
    assert_true(rheo_world_hash(world) == last);
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    remove(PATH);
}

/* Reads the parameters of one definition over those of another, as from the second keyframe on. */
static rheo_result reread(rheo_world_def *into, const rheo_world_def *from, rheo_error *error)
{
    rheo__bytes bytes = {0};
    rheo__parameters_put(&bytes, from);
    rheo__cursor cursor = rheo__cursor_over(&bytes);
    const rheo_result result = rheo__parameters_get(&cursor, into, error);
    rheo__bytes_release(&bytes);
    return result;
}

static void curves_of_keyframes_are_the_same(void **unused)
{
    (void)unused;
    rheo_curve_point other[POINTS], many[RHEO_MAX_CURVE_POINTS + 1];
    rheo_world_def def = rheo_default_world_def(), read = def, next = def;
    def.history.curve = CURVE;
    def.history.curve_count = POINTS;
    OK(reread(&read, &def, &error));
    assert_int_equal(read.history.curve_count, POINTS);
    assert_memory_equal(read.history.curve, CURVE, sizeof CURVE);
    OK(reread(&read, &def, &error));
    next.history.curve = other;
    for (size_t i = 0; i < 2 * POINTS; i++) {
        memcpy(other, CURVE, sizeof CURVE);
        *(i % 2 ? &other[i / 2].age : &other[i / 2].weight) += .001;
        next.history.curve_count = POINTS;
        REFUSED(RHEO_ERROR_FORMAT, "two different curves", reread(&read, &next, &error));
    }
    /* A number that is none does not equal itself, so it was said to be another curve. */
    for (size_t i = 0; i < 4; i++) {
        rheo_world_def first = rheo_default_world_def();
        memcpy(other, CURVE, sizeof CURVE);
        *(i % 2 ? &other[2].age : &other[2].weight) = i < 2 ? (double)NAN : -(double)INFINITY;
        REFUSED(RHEO_ERROR_FORMAT, "damaged: point 2 of the recording's history.curve is not finite",
                reread(&read, &next, &error));
        REFUSED(RHEO_ERROR_FORMAT, "damaged: point 2 of the recording's history.curve is not finite",
                reread(&first, &next, &error));
        rheo__geometry_release(&first);
    }
    memcpy(other, CURVE, sizeof CURVE);
    for (next.history.curve_count = 0; next.history.curve_count < POINTS; next.history.curve_count++)
        REFUSED(RHEO_ERROR_FORMAT, "two different curves", reread(&read, &next, &error));
    rheo__geometry_release(&read);
    for (size_t i = 0; i <= RHEO_MAX_CURVE_POINTS; i++)
        many[i] = (rheo_curve_point){.001 * (double)i, 1};
    read = rheo_default_world_def();
    def.history.curve = many;
    def.history.curve_count = RHEO_MAX_CURVE_POINTS + 1;
    REFUSED(RHEO_ERROR_FORMAT, "a history.curve of more than 1000 points", reread(&read, &def, &error));
    rheo__geometry_release(&read);
    read = rheo_default_world_def();
    def.history.curve_count = RHEO_MAX_CURVE_POINTS;
    OK(reread(&read, &def, &error));
    assert_int_equal(read.history.curve_count, RHEO_MAX_CURVE_POINTS);
    rheo__geometry_release(&read);
}

/* Regression: the table is no row of the table of parameters, so nothing named it as the cause. */
static void a_curve_that_differs_is_named(void **unused)
{
    (void)unused;
    static const struct {
        uint32_t points, changed; /* of the second recording; POINTS: none */
        const char *a, *b;
    } cases[] = {
        {POINTS, POINTS, NULL, NULL},
        {POINTS, 2, "6 points, point 2: [0.08, 2]", "6 points, point 2: [0.08, 3]"},
        {POINTS - 1, POINTS, "6 points, point 5: [0.231, 0]", "5 points"},
        {0, POINTS, "6 points, point 0: [0, 3]", "none"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rheo_verification v;
        rheo_curve_point other[POINTS + 1];
        void *bytes[2];
        size_t size[2];
        memcpy(other, CURVE, sizeof CURVE);
        other[cases[i].changed].weight = 3;
        rheo_world *world[] = {lively_with(CURVE, POINTS), lively_with(other, cases[i].points)};
        for (size_t k = 0; k < 2; k++) {
            OK(rheo_world_save_memory(world[k], "curve", &bytes[k], &size[k], &error));
            rheo_world_destroy(world[k]);
        }
        OK(rheo_diff_memory(bytes[0], size[0], bytes[1], size[1], &v, &error));
        bool named = false;
        for (size_t k = 0; k < v.parameter_count; k++)
            if (strcmp(v.parameters[k].parameter->path, "history.curve") == 0) {
                named = true;
                assert_string_equal(v.parameters[k].a, cases[i].a);
                assert_string_equal(v.parameters[k].b, cases[i].b);
            }
        assert_int_equal(named, cases[i].a != NULL);
        free(bytes[0]);
        free(bytes[1]);
    }
}

static void a_curve_fixes_what_it_replaces(void **unused)
{
    (void)unused;
    rheo_world *world = lively_with(CURVE, POINTS);
    step(world, 3);
    const uint64_t hash = rheo_world_hash(world);
    REFUSED(RHEO_ERROR_ARGUMENT, "step: this world has a history.curve",
            rheo_world_set(world, "step", "0.02", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "history.order: this world has a history.curve",
            rheo_world_set(world, "history.order", "0.4", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "history.weights: this world has a history.curve",
            rheo_world_set(world, "history.weights", "l1", &error));
    OK(rheo_world_set(world, "history.stiffness", "120", &error));
    assert_true(rheo_world_hash(world) == hash);
    step(world, 3);
    rheo_world_destroy(world);
    /* Window, order and weights of the definition do not matter. */
    rheo_scene scene = lively(CURVE, POINTS), same = scene;
    same.world.history.window_seconds = 9;
    same.world.history.order = .2;
    same.world.history.weights = RHEO_WEIGHTS_L1;
    rheo_world *other;
    OK(rheo_scene_create_world(&scene, &world, &error));
    OK(rheo_scene_create_world(&same, &other, &error));
    step(world, 12);
    step(other, 12);
    assert_true(rheo_world_hash(world) == rheo_world_hash(other));
    rheo_world_destroy(world);
    rheo_world_destroy(other);
}

static char warnings[1024];
static void take_warning(const char *message, void *unused)
{
    (void)unused;
    strncat(warnings, message, sizeof warnings - strlen(warnings) - 2);
    strcat(warnings, "\n");
}

static const char *warnings_of(rheo_scene *scene)
{
    rheo_world *world;
    warnings[0] = 0;
    scene->world.log = (rheo_log){take_warning, NULL};
    OK(rheo_world_create(&scene->world, &world, &error));
    rheo_world_destroy(world);
    return warnings;
}

/* Regression: a parameter that a curve replaces was ignored without a word, and a curve of zeros was a history. */
static void what_has_no_effect_is_warned_of(void **unused)
{
    (void)unused;
    rheo_scene scene = lively(CURVE, POINTS);
    const rheo_world_def usual = rheo_default_world_def();
    scene.world.history.order = usual.history.order;
    scene.world.history.weights = usual.history.weights;
    scene.world.history.window = usual.history.window;
    scene.world.history.window_seconds = 0;
    assert_string_equal(warnings_of(&scene), "");
    scene.world.history.window = 7; /* that of the curve, as a recording has it */
    assert_string_equal(warnings_of(&scene), "");
    scene.world.history.window = 8;
    assert_true(says(warnings_of(&scene), "history.window without effect: history.curve gives the weights"));
    scene.world.history.window = 7;
    scene.world.history.window_seconds = .2;
    assert_true(says(warnings_of(&scene), "history.window without effect"));
    scene.world.history.order = .25;
    scene.world.history.weights = RHEO_WEIGHTS_L1;
    assert_true(says(warnings_of(&scene), "history.order, history.weights, history.window without effect"));
    scene.world.history.curve_count = 0;
    assert_string_equal(warnings_of(&scene), "");

    const rheo_curve_point zeros[] = {{0, 0}, {.1, -0.}, {.2, 0}}, nearly[] = {{0, 0}, {.1, -.001}, {.2, 0}};
    scene = lively(zeros, 3);
    assert_true(says(warnings_of(&scene), "history.curve has the weight 0 at all ages"));
    scene = lively(nearly, 3);
    assert_null(strstr(warnings_of(&scene), "weight 0"));
}

/* ---- Refusals ---- */

static void bad_curves_are_refused(void **unused)
{
    (void)unused;
    static const struct {
        rheo_curve_point point[3];
        uint32_t count;
        const char *says;
    } bad[] = {
        {{{0, 1}}, 1, "history.curve has 1 point; it must have from 2 to 1000"},
        {{{0, 1}, {0, 1}}, 2, "the ages of points 0 and 1 of history.curve are 0 and 0; ages must ascend"},
        {{{0, 1}, {2, 1}, {1.5, 1}},
         3,
         "the ages of points 1 and 2 of history.curve are 2 and 1.5; ages must ascend"},
        {{{-1, 1}, {2, 1}}, 2, "the age of point 0 of history.curve is -1; it must be a number from 0 to 1e12"},
        {{{0, 1}, {(double)NAN, 1}}, 2, "the age of point 1 of history.curve is nan"},
        {{{0, 1}, {(double)INFINITY, 1}}, 2, "the age of point 1 of history.curve is inf"},
        {{{0, (double)NAN}, {1, 1}},
         2,
         "the weight of point 0 of history.curve is nan; it must be a number from -1e12 to 1e12"},
        {{{0, 1}, {1, -1e300}}, 2, "the weight of point 1 of history.curve is -1e+300"},
        {{{0, 1}, {33001, 1}}, 2, "history.curve ends at the age 33001; it must end within 1000000 steps of 0.033"},
    };
    rheo_world_def def = rheo_default_world_def();
    rheo_world *world;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        double weight[2] = {8, 8};
        def.history.curve = bad[i].point;
        def.history.curve_count = bad[i].count;
        REFUSED(RHEO_ERROR_ARGUMENT, bad[i].says, rheo_world_create(&def, &world, &error));
        assert_int_equal(rheo_history_curve_weights(bad[i].point, bad[i].count, STEP, 2, weight, NULL),
                         RHEO_ERROR_ARGUMENT);
        assert_true(weight[0] == 8 && weight[1] == 8);
    }
    rheo_curve_point many[RHEO_MAX_CURVE_POINTS + 1];
    for (size_t i = 0; i <= RHEO_MAX_CURVE_POINTS; i++)
        many[i] = (rheo_curve_point){.001 * (double)i, 1};
    def.history.curve = many;
    def.history.curve_count = RHEO_MAX_CURVE_POINTS;
    OK(rheo_world_create(&def, &world, &error));
    rheo_world_destroy(world);
    def.history.curve_count++;
    REFUSED(RHEO_ERROR_ARGUMENT, "history.curve has 1001 points", rheo_world_create(&def, &world, &error));
    def.history.curve = NULL;
    def.history.curve_count = 2;
    REFUSED(RHEO_ERROR_ARGUMENT, "history.curve is NULL", rheo_world_create(&def, &world, &error));
    def.history.curve = CURVE;
    def.history.curve_count = POINTS;
    for (int kind = RHEO_HISTORY_WINDOW_FAST; kind <= RHEO_HISTORY_TEMPERED; kind++) {
        def.history.kind = (rheo_history_kind)kind;
        REFUSED(RHEO_ERROR_ARGUMENT, "history.curve needs history.kind window",
                rheo_world_create(&def, &world, &error));
    }
    def = rheo_default_model_def(RHEO_MODEL_MELTING);
    def.history.curve = CURVE;
    def.history.curve_count = POINTS;
    REFUSED(RHEO_ERROR_ARGUMENT, "the model melting has no history.curve", rheo_world_create(&def, &world, &error));
}

static void points_take_their_limits_and_nothing_beyond(void **unused)
{
    (void)unused;
    const double beyond = nextafter(1e12, INFINITY);
    const struct {
        double from, to, weight, step;
        bool taken;
    } CASES[] = {
        {0, 1e12, 1, 1e7, true},
        {-DBL_TRUE_MIN, 1e12, 1, 1e7, false},
        {0, beyond, 1, 1e7, false},
        {0, 1e12, 1e12, 1e7, true},
        {0, 1e12, beyond, 1e7, false},
        {0, 1e12, -1e12, 1e7, true},
        {0, 1e12, -beyond, 1e7, false},
        {0, 1e12, 1, 1e6, true},
        {0, beyond, 1, nextafter(1e6, 0), false},
        {0, 1e12, 1, DBL_MAX, true},
        {0, 1e12, 1, INFINITY, false},
        {0, DBL_TRUE_MIN, 1, DBL_TRUE_MIN, true},
        {0, DBL_TRUE_MIN, 1, 0, false},
        {1, 1, 1, 1e7, false},
        {1, nextafter(1, 2), 1, 1e7, true},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++)
        for (int point = 0; point < 2; point++) {
            rheo_curve_point curve[] = {{CASES[i].from, 1}, {CASES[i].to, 1}};
            curve[point].weight = CASES[i].weight;
            double weight[1];
            if ((rheo_history_curve_weights(curve, 2, CASES[i].step, 1, weight, NULL) == RHEO_OK) != CASES[i].taken)
                fail_msg("case %zu is %s", i, CASES[i].taken ? "refused" : "taken");
        }
}

/* ---- Scenes ---- */

static void points_are_added_to_a_scene(void **unused)
{
    (void)unused;
    rheo_scene scene = lively(CURVE, POINTS);
    OK(rheo_scene_add_curve_point(&scene, .3, .25, &error));
    assert_int_equal(scene.world.history.curve_count, POINTS + 1);
    assert_memory_equal(scene.world.history.curve, CURVE, sizeof CURVE); /* a copy */
    assert_true(scene.world.history.curve != CURVE && scene.world.history.curve[POINTS].weight == .25);
    REFUSED(RHEO_ERROR_ARGUMENT, "ages must ascend", rheo_scene_add_curve_point(&scene, .3, 1, &error));
    assert_int_equal(scene.world.history.curve_count, POINTS + 1);
    for (uint32_t i = POINTS + 1; i < RHEO_MAX_CURVE_POINTS; i++)
        OK(rheo_scene_add_curve_point(&scene, i, 0, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "at most 1000 points of history.curve",
            rheo_scene_add_curve_point(&scene, 1e6, 0, &error));
    rheo_scene_release(&scene);
    assert_true(!scene.world.history.curve && !scene.world.history.curve_count && !scene.owned.curve);
}

static rheo_result read_text(const char *text, rheo_scene *scene, rheo_error *error)
{
    return rheo_scene_from_json(text, strlen(text), "dir/t.json", scene, error);
}

static bool json_is_built_in(void)
{
    rheo_scene scene;
    rheo_error error;
    return read_text("{}", &scene, &error) != RHEO_ERROR_UNSUPPORTED;
}

static void a_curve_is_read_back_to_the_bit(void **unused)
{
    (void)unused;
    if (!json_is_built_in())
        skip();
    rheo_scene scene, again;
    OK(read_text("{\"history\": {\"curve\": [[0.1, 3], [0.30000000000000004, -0.25], [1e5, 1e-300]]}}", &scene,
                 &error));
    assert_int_equal(scene.world.history.curve_count, 3);
    assert_true(scene.world.history.curve[0].age == .1 && scene.world.history.curve[0].weight == 3);
    assert_true(scene.world.history.curve[1].age == .1 + .2 && scene.world.history.curve[1].weight == -.25);
    char *text = rheo_scene_to_json(&scene);
    assert_non_null(text);
    OK(read_text(text, &again, &error));
    assert_int_equal(again.world.history.curve_count, 3);
    assert_memory_equal(again.world.history.curve, scene.world.history.curve, 3 * sizeof *scene.world.history.curve);
    free(text);
    rheo_scene_release(&again);
    rheo_scene_release(&scene);
    text = rheo_scene_to_json(&again); /* a scene without a curve does not name it */
    assert_true(text && !strstr(text, "curve"));
    free(text);
}

static void bad_curves_of_scene_files_are_refused(void **unused)
{
    (void)unused;
    if (!json_is_built_in())
        skip();
    static const char *const bad[][2] = {
        {"[]", "dir/t.json:2: history.curve: must have at least 2 points [age, weight]; got 0"},
        {"[[0, 1]]", "dir/t.json:2: history.curve: must have at least 2 points [age, weight]; got 1"},
        {"[[0, 1],\n[0, 1]]", "dir/t.json:3: history.curve[1]: "},
        {"[[0, 1], [0, 1]]", "the ages of points 0 and 1 of history.curve are 0 and 0; ages must ascend"},
        {"[[-0.5, 1], [1, 1]]", "the age of point 0 of history.curve is -0.5; it must be a number from 0 to 1e12"},
        {"[[0, 1], [1, 1e13]]", "history.curve[1]: the weight of point 1 of history.curve is 1"},
        {"[[0, 1], [1]]", "history.curve[1]: must be a list of 2 numbers, e.g. [0, 2.5]; got a list of 1"},
        {"[[0, 1], [1, null]]", "history.curve[1][1]: must be a number"},
        {"[[0, 1], 2]", "history.curve[1]: must be a list of 2 numbers"},
        {"0.5", "history.curve: must be a list [...]; got a number"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[128];
        rheo_scene scene;
        snprintf(text, sizeof text, "{\"history\": {\n\"curve\": %s}}", bad[i][0]);
        REFUSED(RHEO_ERROR_ARGUMENT, bad[i][1], read_text(text, &scene, &error));
    }
    char many[32 * (RHEO_MAX_CURVE_POINTS + 1)] = "{\"history\": {\"curve\": [[0, 1]";
    rheo_scene scene;
    for (int i = 1; i <= RHEO_MAX_CURVE_POINTS; i++)
        snprintf(many + strlen(many), sizeof many - strlen(many), ", [%d, 1]", i);
    strcat(many, "]}}");
    REFUSED(RHEO_ERROR_ARGUMENT, "a scene has at most 1000 points of history.curve", read_text(many, &scene, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "of the model thickening",
            read_text("{\"model\": \"melting\", \"history\": {\"curve\": [[0, 1], [1, 1]]}}", &scene, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "did you mean \"history.curve\"?",
            read_text("{\"history\": {\"curv\": [[0, 1], [1, 1]]}}", &scene, &error));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_are_integrals_of_the_curve),
        cmocka_unit_test(the_window_ends_with_the_curve),
        cmocka_unit_test(the_power_law_is_a_curve),
        cmocka_unit_test(halving_the_step_converges),
        cmocka_unit_test(a_lag_shifts_the_curve),
        cmocka_unit_test(any_step_of_a_recording_is_resumed),
        cmocka_unit_test(curves_of_keyframes_are_the_same),
        cmocka_unit_test(a_curve_that_differs_is_named),
        cmocka_unit_test(a_curve_fixes_what_it_replaces),
        cmocka_unit_test(what_has_no_effect_is_warned_of),
        cmocka_unit_test(bad_curves_are_refused),
        cmocka_unit_test(points_take_their_limits_and_nothing_beyond),
        cmocka_unit_test(points_are_added_to_a_scene),
        cmocka_unit_test(a_curve_is_read_back_to_the_bit),
        cmocka_unit_test(bad_curves_of_scene_files_are_refused),
    };
    return cmocka_run_group_tests_name("curve", tests, NULL, NULL);
}
