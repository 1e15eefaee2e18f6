/* Diagnoses. An unhealthy run is explained by measure, step, stage and particle; a healthy run has no findings. */
#define _POSIX_C_SOURCE 200809L
#ifndef PATH
#define PATH "test_doctor.rlog"
#endif
#include "doctor_support.h"
#include "record/recording.h"

#include <float.h>

static void springs_that_are_too_stiff_are_named(void **state)
{
    (void)state;
    file f = record_stiff();
    rheo_diagnosis d = diagnose(&f);
    assert_cause(&d, "stiffness_number", "spring_displacement");
    assert_true(d.failed && d.complete);
    assert_int_equal(d.failure.step, d.last_step + 1);
    assert_true(d.unhealthy_step <= d.failure.step && d.cause.step <= d.unhealthy_step);
    assert_true(d.cause.value > 2.4 && d.cause.limit == 2.4);
    assert_in("went bad: after stage spring_displacement", d.why);
    assert_int_equal(!strstr(d.why, "went bad"), REWORDED);

    /* The named item is a spring, with the stated stiffness in the stated step. */
    rheo_recording *recording;
    rheo_world *world;
    rheo_spring_state spring;
    OK(rheo_recording_open_memory(f.bytes, f.size, &recording, &error));
    OK(rheo_recording_world(recording, d.cause.step - 1, NULL, &world, &error));
    assert_true(d.cause.id >= 0 && d.cause.other_id > d.cause.id);
    uint32_t a = (uint32_t)d.cause.id, b = (uint32_t)d.cause.other_id;
    if (rheo_world_spring(world, a, b, &spring, NULL) == RHEO_OK)
        NEAR(spring.stiffness * 0.033 * 0.033, d.cause.value, 1e-4 * d.cause.value);
    OK(rheo_world_step(world, &error));
    NEAR(metric(world, "stiffness_number"), d.cause.value, 0);
    OK(rheo_world_spring(world, a, b, &spring, &error));
    rheo_world_destroy(world);

    /* Measures count up to the failed stage. The failed step does not repeat values that it did not measure. */
    assert_int_equal(finding(&d, "stiffness_number")->peak_step, d.failure.step);
    double values[64];
    uint64_t fast = 0;
    uint32_t courant = 0;
    while (strcmp(rheo_recording_metric_name(recording, courant), "courant_number") != 0)
        courant++;
    for (uint64_t step = 0; step <= d.last_step; step++) {
        OK(rheo_recording_metrics(recording, step, values, &error));
        fast += values[courant] > 0.5;
    }
    assert_true(fast > 0 && values[courant] > 0.5);
    assert_int_equal(finding(&d, "courant_number")->steps, fast);

    /* Each piece of advice, applied before the first unhealthy step, makes the run healthy. */
    assert_true(d.advice_count >= 3);
    assert_string_equal(d.advice[0].set, "springs.solver=implicit");
    assert_in("step=0.0", d.advice[1].set);
    assert_in("history.stiffness=", d.advice[2].set);
    for (uint32_t i = 0; i < d.advice_count; i++) {
        char path[64];
        snprintf(path, sizeof path, "%s", d.advice[i].set);
        char *value = strchr(path, '=');
        *value++ = 0;
        OK(rheo_recording_world(recording, d.cause.step - 1, NULL, &world, &error));
        OK(rheo_world_set(world, path, value, &error));
        step(world, 60);
        rheo_world_destroy(world);
    }
    rheo_recording_close(recording);
    free(f.bytes);
}

/* The pressure stage beyond its stability limit, with springs that break first and without springs. */
static void pressure_that_is_too_stiff_is_named(void **state)
{
    (void)state;
    for (int springs = 0; springs < 2; springs++) {
        rheo_scene scene = lively_scene();
        scene.world.scheme = RHEO_SCHEME_SEQUENTIAL;
        scene.settle.time = 0;
        scene.world.vibrators.count = 0;
        scene.world.ball.radius = 0;
        scene.world.fluid.stiffness = 0.3 * scene.world.fluid.support / (0.033 * 0.033);
        scene.world.fluid.near_stiffness = scene.world.fluid.stiffness * 2 / 3;
        if (!springs)
            scene.world.springs.stiffness = scene.world.history.stiffness = 0;
        rheo_world *world;
        rheo_result result;
        OK(rheo_scene_create_world(&scene, &world, &error));
        file f = record(world, 300, NULL, &result);
        rheo_diagnosis d = diagnose(&f);
        assert_cause(&d, "pressure_number", "density");
        NEAR(d.cause.value, 0.3, 1e-6);
        assert_true(d.cause.id >= 0 && d.advice_count == 2);
        assert_true(d.cause.step > 0 && d.cause.step <= d.last_step);
        assert_string_equal(d.advice[1].set, "fluid.stiffness=290");
        free(f.bytes);
    }
}

/* The block has eight times the rest density, so pressure throws it apart in its first step. */
static void a_start_that_is_too_dense_is_unhealthy_at_once(void **state)
{
    (void)state;
    rheo_real position[3 * 216];
    for (uint32_t i = 0; i < 216; i++) {
        position[3 * i] = (rheo_real)(i % 6);
        position[3 * i + 1] = (rheo_real)(i / 6 % 6) + (rheo_real)0.01 * (rheo_real)(i % 5);
        position[3 * i + 2] = (rheo_real)(i / 36);
    }
    for (int sequential = 0; sequential < 2; sequential++) {
        rheo_world_def def = rheo_default_world_def();
        def.scheme = sequential ? RHEO_SCHEME_SEQUENTIAL : RHEO_SCHEME_SUMMED;
        rheo_result result;
        file f = record(world_of(def, 216, position, NULL), 10, NULL, &result);
        rheo_diagnosis d = diagnose(&f);
        assert_cause(&d, "max_pressure_displacement", sequential ? "density" : "forces");
        assert_int_equal(d.cause.step, 1);
        assert_in("too close", d.advice[0].text);
        assert_string_equal(d.advice[0].set, "");
        free(f.bytes);
    }
}

/* The recording begins with an unhealthy state, because a checkpoint stores the metrics of its last step. */
static void an_unhealthy_start_is_unhealthy_at_its_first_step(void **state)
{
    (void)state;
    file f = record_stiff();
    rheo_diagnosis d = diagnose(&f);
    rheo_recording *recording;
    rheo_world *world;
    OK(rheo_recording_open_memory(f.bytes, f.size, &recording, &error));
    OK(rheo_recording_world(recording, d.last_step, NULL, &world, &error));
    void *bytes;
    size_t size;
    OK(rheo_world_save_memory(world, "ill", &bytes, &size, &error));
    rheo_world_destroy(world);
    rheo_recording_close(recording);
    file checkpoint = {bytes, size};
    rheo_diagnosis later = diagnose(&checkpoint);
    assert_cause(&later, "stiffness_number", "spring_displacement");
    assert_int_equal(later.cause.step, d.last_step);
    assert_int_equal(later.first_step, d.last_step);
    free(f.bytes);
    free(bytes);
}

static void healthy_runs_are_healthy(void **state)
{
    (void)state;
    for (int sequential = 0; sequential < 2; sequential++)
        for (int springs = 0; springs < 3; springs++) { /* usual ones, stiff ones, none */
            rheo_scene scene = lively_scene();
            scene.world.scheme = sequential ? RHEO_SCHEME_SEQUENTIAL : RHEO_SCHEME_SUMMED;
            if (springs == 1) {
                scene.world.history.stiffness = sequential ? 15000 : 1500; /* kappa above 50, for implicit springs */
                scene.world.springs.solver = RHEO_SOLVER_IMPLICIT;
            }
            if (springs == 2)
                scene.world.springs.stiffness = scene.world.history.stiffness = 0;
            rheo_world *world;
            OK(rheo_scene_create_world(&scene, &world, &error));
            file f = record_well(world, springs == 0 ? 150 : 100, NULL);
            rheo_diagnosis d = diagnose(&f);
            assert_healthy(&d, 0);
            assert_int_equal(d.last_step, springs == 0 ? 150 : 100);
            free(f.bytes);
        }
}

static void add_fast_ones(rheo_world *world, int step)
{
    const rheo_real position[6] = {0, 50, 0, 40, 50, 0}, velocity[6] = {0, 0, 300, 0, 0, 300};
    if (step == 4)
        OK(rheo_world_add_particles(world, 2, position, velocity, &error));
}

static void small_worlds_are_healthy(void **state)
{
    (void)state;
    const rheo_real one[3] = {0, 5, 0}, same[6] = {1, 1, 1, 1, 1, 1}, fast[3] = {1e5f, 0, 0};
    rheo_world_def def = rheo_default_world_def();
    file f = record_well(world_of(def, 0, NULL, NULL), 5, NULL);
    rheo_diagnosis d = diagnose(&f);
    assert_healthy(&d, 0);
    free(f.bytes);
    f = record_well(world_of(def, 1, one, NULL), 50, NULL);
    d = diagnose(&f);
    assert_healthy(&d, 0);
    free(f.bytes);
    f = record_well(world_of(def, 2, same, NULL), 50, NULL);
    d = diagnose(&f);
    assert_healthy(&d, 0);
    free(f.bytes);
    /* High speed alone is at most a notice, and so is the effect of a command. */
    f = record_well(world_of(def, 1, one, fast), 5, NULL);
    d = diagnose(&f);
    assert_healthy(&d, 1);
    assert_string_equal(d.findings[0].measure, "courant_number");
    assert_int_equal(d.findings[0].step, 0);
    assert_int_equal(d.findings[0].id, 0);
    free(f.bytes);
    f = record_well(world_of(def, 1, one, NULL), 8, add_fast_ones);
    d = diagnose(&f);
    assert_healthy(&d, 1);
    assert_string_equal(d.findings[0].measure, "courant_number");
    assert_int_equal(d.findings[0].step, 5);
    free(f.bytes);
    /* A recording without steps. */
    f = record_well(world_of(def, 1, one, NULL), 0, NULL);
    d = diagnose(&f);
    assert_healthy(&d, 0);
    free(f.bytes);
}

/* ---- Incomplete and damaged recordings ---- */

static void absurd_metrics_are_harmless(void **state)
{
    (void)state;
    static const double absurd[] = {NAN, INFINITY, -INFINITY, 1e308, -1e308, 4294967296.0, -1, 0.5};
    static const char *const metrics[] = {"stiffness_number",
                                          "stiffness_a",
                                          "stiffness_b",
                                          "max_spring_displacement",
                                          "max_spring_displacement_id",
                                          "max_speed",
                                          "courant_number",
                                          "max_density_id",
                                          "energy_jump",
                                          "ball_vx",
                                          "max_density",
                                          "step"};
    for (size_t i = 0; i < sizeof absurd / sizeof *absurd; i++) {
        file f = quiet(NULL);
        for (size_t k = 0; k < sizeof metrics / sizeof *metrics; k++)
            for (uint64_t step = 5; step < 9; step++)
                forge(&f, step, metrics[k], absurd[(i + (k + step) % 2) % 8]);
        rheo_diagnosis d = diagnose(&f);
        assert_true(d.finding_count <= RHEO_MAX_FINDINGS);
        for (uint32_t k = 0; k < d.finding_count; k++)
            assert_true(d.findings[k].id >= -1 && d.findings[k].id <= UINT32_MAX && d.findings[k].steps > 0);
        free(f.bytes);
    }
    file f = quiet(NULL);
    forge(&f, 5, "max_spring_displacement", NAN);
    rheo_diagnosis d = diagnose(&f);
    assert_cause(&d, "max_spring_displacement", "spring_displacement");
    assert_true(isnan(d.cause.value));
    assert_in("not a number", d.why);
    free(f.bytes);
}

/* An older recording lacks newer metrics. */
static void missing_metrics_are_skipped(void **state)
{
    (void)state;
    file f = quiet(NULL);
    forge(&f, 5, "max_spring_displacement", 2);
    forge(&f, 9, "stiffness_number", 3);
    uint8_t *head = chunk_of(&f, "HEAD", 0);
    size_t stored = (size_t)number(head + 16, 8);
    assert_int_equal(number(head + 4, 4), 0);
    for (size_t at = 32; at + 11 < 32 + stored; at++)
        if (memcmp(head + at, "max_spring_displacement", 11) == 0)
            head[at] = 'S';
    seal(head);
    rheo_diagnosis d = diagnose(&f);
    assert_healthy(&d, 1);
    assert_string_equal(d.findings[0].measure, "stiffness_number");
    free(f.bytes);
}

static void truncated_recordings_are_diagnosed_up_to_the_cut(void **state)
{
    (void)state;
    file f = quiet(NULL);
    forge(&f, 30, "max_spring_displacement", 2);
    size_t whole = f.size;
    f.size = (size_t)(chunk_of(&f, "STEP", 30) - f.bytes) + 40;
    rheo_diagnosis d = diagnose(&f);
    assert_healthy(&d, 0);
    assert_false(d.complete);
    assert_int_equal(d.last_step, 29);
    assert_in("truncated after step 29", d.why);
    f.size = whole;
    uint8_t *after = chunk_of(&f, "STEP", 31);
    f.size = (size_t)(after - f.bytes) + 3;
    d = diagnose(&f);
    assert_cause(&d, "max_spring_displacement", "spring_displacement");
    assert_int_equal(d.last_step, 30);
    /* A step with a damaged payload is an error. */
    f.size = whole;
    after[32]++;
    rheo_recording *recording;
    OK(rheo_recording_open_memory(f.bytes, f.size, &recording, &error));
    REFUSED(RHEO_ERROR_FORMAT, "damaged", rheo_diagnose(recording, &d, &error));
    rheo_recording_close(recording);
    free(f.bytes);
}

/* The diagnosis reads no states; the check does. */
static void a_flipped_byte_of_a_keyframe_is_found(void **state)
{
    (void)state;
    rheo_world_def def = rheo_default_world_def();
    const rheo_real position[6] = {0, 5, 0, 1, 5, 0};
    file f = record_well(world_of(def, 2, position, NULL), 3, NULL);
    rheo_recording *recording;
    OK(rheo_recording_open_memory(f.bytes, f.size, &recording, &error));
    OK(rheo_recording_check(recording, &error));
    const uint64_t begin = recording->keyframes[0].start, end = recording->keyframes[0].end;
    rheo_recording_close(recording);
    uint32_t unnoticed = 0;
    for (uint64_t at = begin; at < end; at += every()) {
        rheo_diagnosis d;
        f.bytes[at] ^= 1 << at % 8;
        rheo_error why;
        const rheo_result result = rheo_recording_open_memory(f.bytes, f.size, &recording, &why);
        if (result == RHEO_OK) {
            unnoticed += rheo_diagnose(recording, &d, &why) == RHEO_OK;
            REFUSED(RHEO_ERROR_FORMAT, "damaged: the chunk ", rheo_recording_check(recording, &error));
            rheo_recording_close(recording);
        } else if (result != RHEO_ERROR_FORMAT && result != RHEO_ERROR_UNSUPPORTED) {
            fail_msg("byte %llu: %s", (unsigned long long)at, why.message);
        }
        f.bytes[at] ^= 1 << at % 8;
    }
    assert_true(unnoticed > 0);
    /* What follows the last complete step of a truncated recording is no part of it. */
    f.size -= 70;
    OK(rheo_recording_open_memory(f.bytes, f.size, &recording, &error));
    assert_false(rheo_recording_get_info(recording).complete);
    OK(rheo_recording_check(recording, &error));
    rheo_recording_close(recording);
    free(f.bytes);
}

/* A step failed without any measure out of range earlier. Only the place is known. */
/* A particle at the end of all floats overflows in a long step. It moves no support before that. */
static rheo_world_def falling_def(void)
{
    rheo_world_def def = inert_def();
    def.scheme = RHEO_SCHEME_SEQUENTIAL;
    def.gravity[0] = 1e30;
    def.fluid.support = 1e12;
    return def;
}

static void a_failure_without_precursors_is_still_named(void **state)
{
    (void)state;
    if (sizeof(rheo_real) == 8)
        skip(); /* nothing falls so far */
    const rheo_real position[3] = {(rheo_real)FLT_MAX, 0, 0};
    rheo_world_def def = falling_def();
    def.step = 1e6;
    rheo_result result;
    file f = record(world_of(def, 1, position, NULL), 3, NULL, &result);
    assert_int_equal(result, RHEO_ERROR_STATE);
    rheo_diagnosis d = diagnose(&f);
    assert_cause(&d, "", "prediction");
    assert_int_equal(d.cause.step, 1);
    assert_int_equal(d.cause.id, 0);
    assert_true(d.advice_count == 1 && strncmp(d.advice[0].set, "step=5", 6) == 0);
    free(f.bytes);
}

static void make_fail(rheo_world *world, int step)
{
    if (step == 20)
        OK(rheo_world_set(world, "step", "1e6", &error));
}

static void make_stiff(rheo_world *world, int step)
{
    if (step == 3)
        OK(rheo_world_set(world, "history.stiffness", "3000", &error));
}

/* To leave out a command is advised first, and the advice for the state without a command follows, all of it. */
static void leaving_out_a_command_is_advised_first(void **state)
{
    (void)state;
    rheo_result result;
    file f = record(stiff_world(1), 200, make_stiff, &result);
    const rheo_diagnosis d = diagnose(&f);
    assert_true(!d.healthy && d.suspect_count == 1 && d.suspects[0].step == 4);
    assert_in("without the command before step 4", d.advice[0].text);
    assert_true(!d.advice[0].set[0] && d.advice[0].from == 3 && d.advice[0].can_continue);
    assert_int_equal(d.advice_count, 2);
    assert_string_equal(d.advice[1].set, "springs.solver=implicit");
    assert_true(d.advice[1].text[0] != 0);
    free(f.bytes);
}

/* Precursors count only in an uninterrupted sequence up to the failed step or severe finding. */
static void precursors_long_before_a_failure_are_not_its_cause(void **state)
{
    (void)state;
    if (sizeof(rheo_real) == 8)
        skip();
    const rheo_real position[3] = {(rheo_real)FLT_MAX, 0, 0};
    for (uint64_t gap = 10; gap <= 11; gap++) {
        rheo_world_def def = falling_def();
        def.step = 1e-12;
        rheo_result result;
        file f = record(world_of(def, 1, position, NULL), 30, make_fail, &result);
        assert_int_equal(result, RHEO_ERROR_STATE);
        forge(&f, 21 - gap, "stiffness_number", 3);
        rheo_diagnosis d = diagnose(&f);
        assert_cause(&d, gap == 10 ? "stiffness_number" : "", gap == 10 ? "spring_displacement" : "prediction");
        assert_int_equal(d.unhealthy_step, 21);
        assert_int_equal(d.cause.step, gap == 10 ? 11 : 21);
        free(f.bytes);
    }
}

/*
 * The fragments of a scene that blew up while it settled meet nothing any more, so no measure but their speed shows it.
 * A state that only moves, or is restless, is healthy, and the diagnosis says so.
 */
static void a_scene_that_flew_apart_before_step_0_is_unhealthy(void **state)
{
    (void)state;
    const rheo_scheme schemes[2] = {RHEO_SCHEME_SUMMED, RHEO_SCHEME_SEQUENTIAL};
    for (int i = 0; i < 4; i++) {
        rheo_world_def def = inert_def();
        def.scheme = schemes[i / 2];
        const rheo_real position[3] = {0, 0, 0},
                        velocity[3] = {(rheo_real)((i % 2 ? 1010 : 990) * def.fluid.support / def.step), 0, 0};
        file f = record_well(world_of(def, 1, position, velocity), 3, NULL);
        rheo_diagnosis d = diagnose(&f);
        if (i % 2) {
            assert_cause(&d, "runaway_speed", i / 2 ? "velocity" : "forces");
            assert_true(d.ill_from_start && d.unhealthy_step == 0 && d.cause.id == 0);
            assert_in("it was ill from the start, so the scene blew up while it was made", d.why);
            assert_in("runaway_speed (how far the fastest particle moves in a step, in supports) is 1010, more than "
                      "1000, particle 0",
                      d.why);
        } else {
            assert_healthy(&d, 1);
            assert_in("healthy: nothing severe in step 0 to 3; but in the first state courant_number is 990, more "
                      "than 0.5, particle 0: the scene had not settled, or was made to move",
                      d.why);
        }
        free(f.bytes);
    }
}

static void damaged_commands_are_reported(void **state)
{
    (void)state;
    file f = quiet(make_implicit_then_explicit);
    uint8_t *command = chunk_of(&f, "INPT", 4);
    assert_int_equal(number(command + 4, 4), 0);
    command[32 + 4 + 2] ^= 0x20; /* gravity becomes Gravity */
    seal(command);
    rheo_recording *recording;
    rheo_diagnosis d;
    OK(rheo_recording_open_memory(f.bytes, f.size, &recording, &error));
    REFUSED(RHEO_ERROR_FORMAT, "a command before step 4", rheo_diagnose(recording, &d, &error));
    rheo_recording_close(recording);
    free(f.bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(springs_that_are_too_stiff_are_named),
        cmocka_unit_test(pressure_that_is_too_stiff_is_named),
        cmocka_unit_test(a_start_that_is_too_dense_is_unhealthy_at_once),
        cmocka_unit_test(an_unhealthy_start_is_unhealthy_at_its_first_step),
        cmocka_unit_test(healthy_runs_are_healthy),
        cmocka_unit_test(small_worlds_are_healthy),
        cmocka_unit_test(absurd_metrics_are_harmless),
        cmocka_unit_test(missing_metrics_are_skipped),
        cmocka_unit_test(truncated_recordings_are_diagnosed_up_to_the_cut),
        cmocka_unit_test(a_flipped_byte_of_a_keyframe_is_found),
        cmocka_unit_test(a_failure_without_precursors_is_still_named),
        cmocka_unit_test(precursors_long_before_a_failure_are_not_its_cause),
        cmocka_unit_test(leaving_out_a_command_is_advised_first),
        cmocka_unit_test(a_scene_that_flew_apart_before_step_0_is_unhealthy),
        cmocka_unit_test(damaged_commands_are_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
