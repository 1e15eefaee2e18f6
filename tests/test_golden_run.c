/* Runs that are compared with a golden recording while they go on, and recordings in memory. */
#define _POSIX_C_SOURCE 200809L
#include <unistd.h>

#include "support.h"

static const char *const GOLDEN = "test_golden_run.rlog";
enum { STEPS = 12 };
static rheo_error why; /* error of calls that may be refused */

/* The code under test: a command in the middle of the run. */
static void command(rheo_world *world, uint64_t step, const char *stiffness)
{
    if (step == 4)
        OK(rheo_world_set(world, "fluid.stiffness", stiffness, &error));
}

static void record_golden(bool full)
{
    rheo_world *world = lively_world();
    rheo_recorder *recorder;
    const rheo_record_options options = {.scene = "mine", .keyframe_spacing = 5, .full = full, .force = true};
    OK(rheo_recorder_open(world, GOLDEN, &options, &recorder, &error));
    for (uint64_t i = 0; i < STEPS; i++) {
        command(world, i, "310");
        OK(rheo_recorder_step(recorder, &error));
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
}

/* Makes steps until one is refused; returns its result. The message is in `why`. */
static rheo_result play(rheo_golden *golden, rheo_world *world, uint64_t steps, const char *stiffness)
{
    rheo_result result = RHEO_OK;
    for (uint64_t i = 0; i < steps && result == RHEO_OK; i++) {
        command(world, i, stiffness);
        result = rheo_golden_step(golden, &why);
    }
    return result;
}

static rheo_golden *begin(rheo_world *world)
{
    rheo_golden *golden = NULL;
    OK(rheo_golden_open(world, GOLDEN, &golden, &error));
    return golden;
}

/* ---- Memory ---- */

static void a_recording_in_memory_has_the_bytes_of_the_file(void **unused)
{
    (void)unused;
    for (int full = 0; full < 2; full++) {
        record_golden(full);
        rheo_world *world = lively_world();
        rheo_recorder *recorder;
        const rheo_record_options options = {.scene = "mine", .keyframe_spacing = 5, .full = full};
        OK(rheo_recorder_open_memory(world, &options, &recorder, &error));
        for (uint64_t i = 0; i < STEPS; i++) {
            command(world, i, "310");
            OK(rheo_recorder_step(recorder, &error));
        }
        void *bytes;
        size_t size, file_size;
        OK(rheo_recorder_close_memory(recorder, &bytes, &size, &error));
        uint8_t *there = read_file(GOLDEN, &file_size);
        assert_int_equal(size, file_size);
        assert_memory_equal(bytes, there, size);
        free(there);
        free(bytes);
        /* Discarded; and a file has no bytes to hand over. */
        OK(rheo_recorder_open_memory(world, NULL, &recorder, &error));
        OK(rheo_recorder_close(recorder, &error));
        OK(rheo_recorder_open(world, GOLDEN, &(rheo_record_options){.force = true}, &recorder, &error));
        REFUSED(RHEO_ERROR_ARGUMENT, "in its file", rheo_recorder_close_memory(recorder, &bytes, &size, &error));
        assert_true(bytes == NULL && size == 0);
        rheo_world_destroy(world);
    }
}

/* ---- Comparing ---- */

static void the_same_run_passes_with_all_its_steps(void **unused)
{
    (void)unused;
    for (int full = 0; full < 2; full++) {
        record_golden(full);
        rheo_world *world = lively_world();
        rheo_golden *golden = begin(world);
        assert_int_equal(play(golden, world, STEPS, "310"), RHEO_OK);
        rheo_verification v = {0};
        OK(rheo_golden_close(golden, &v, &error));
        assert_true(v.verdict == RHEO_SAME && v.steps == STEPS);
        OK(rheo_verification_check(&v, STEPS, &error));
        rheo_world_destroy(world);
    }
}

static void a_changed_run_fails_at_its_first_difference(void **unused)
{
    (void)unused;
    for (int full = 0; full < 2; full++) {
        record_golden(full);
        rheo_world *world = lively_world();
        rheo_golden *golden = begin(world);
        assert_int_equal(play(golden, world, STEPS, "310.5"), RHEO_ERROR_DIFFERS);
        assert_int_equal(rheo_world_step_count(world), 5);
        assert_non_null(strstr(why.message, "differs at step 5: position after stage forces@1"));
        assert_non_null(strstr(why.message, "position of particle"));
        assert_non_null(strstr(why.message, "in the golden recording"));
        assert_non_null(strstr(why.message, "in this run"));
        /* It goes no further. */
        REFUSED(RHEO_ERROR_DIFFERS, "at step 5", rheo_golden_step(golden, &error));
        assert_int_equal(rheo_world_step_count(world), 5);
        rheo_verification v;
        REFUSED(RHEO_ERROR_DIFFERS, "at step 5", rheo_golden_close(golden, &v, &error));
        assert_true(v.verdict == RHEO_DIFFERS && v.first.step == 5 && v.steps == 4);
        assert_true(v.commands_differ && v.commands_step == 5 && v.first.origin == RHEO_VALUES_SIMULATED);
        rheo_world_destroy(world);
    }
}

static bool stop_comparing(const char *task, uint64_t done, uint64_t total, void *user)
{
    (void)done, (void)total, (void)user;
    return strcmp(task, "comparing") != 0;
}

static void a_comparison_that_was_stopped_is_no_success(void **unused)
{
    (void)unused;
    record_golden(false);
    for (int at_end = 0; at_end < 2; at_end++) {
        rheo_world *world = lively_world();
        rheo_golden *golden = begin(world);
        rheo_use_progress((rheo_progress){stop_comparing, NULL});
        if (!at_end) {
            assert_int_equal(play(golden, world, STEPS, "310.5"), RHEO_ERROR_STOPPED);
            REFUSED(RHEO_ERROR_DIFFERS, "not compared", rheo_golden_step(golden, &error));
        } else {
            assert_int_equal(play(golden, world, STEPS, "310"), RHEO_OK);
        }
        rheo_verification v;
        assert_int_not_equal(rheo_golden_close(golden, &v, &why), RHEO_OK);
        rheo_use_progress((rheo_progress){0});
        assert_int_equal(v.verdict, RHEO_NOT_COMPARED);
        assert_non_null(strstr(v.message, "not compared"));
        rheo_world_destroy(world);
    }
}

static void a_run_of_another_length_fails(void **unused)
{
    (void)unused;
    record_golden(false);
    rheo_verification v;
    for (uint64_t steps = 0; steps < STEPS; steps += STEPS - 1) {
        rheo_world *world = lively_world();
        rheo_golden *golden = begin(world);
        assert_int_equal(play(golden, world, steps, "310"), RHEO_OK);
        REFUSED(RHEO_ERROR_DIFFERS, "differs in length: the golden recording has steps 0 to 12, this run 0 to ",
                rheo_golden_close(golden, &v, &error));
        assert_true(v.verdict == RHEO_DIFFERS && v.lengths_differ && v.steps == steps);
        rheo_world_destroy(world);
    }
    rheo_world *world = lively_world();
    rheo_golden *golden = begin(world);
    assert_int_equal(play(golden, world, STEPS, "310"), RHEO_OK);
    REFUSED(RHEO_ERROR_DIFFERS, "steps 0 to 12, this run 0 to 13", rheo_golden_step(golden, &error));
    REFUSED(RHEO_ERROR_DIFFERS, "differs in length", rheo_golden_close(golden, NULL, &error));
    rheo_world_destroy(world);
}

static void another_start_is_refused(void **unused)
{
    (void)unused;
    record_golden(false);
    rheo_scene scene = lively_scene();
    rheo_golden *golden;
    rheo_world *world;
    OK(rheo_world_def_set(&scene.world, "fluid.near_stiffness", "500.0005", &error));
    OK(rheo_scene_create_world(&scene, &world, &error)); /* it settles otherwise */
    REFUSED(RHEO_ERROR_DIFFERS, "position of particle 0, component 2 is",
            rheo_golden_open(world, GOLDEN, &golden, &error));
    assert_null(golden);
    rheo_world_destroy(world);
    world = lively_world();
    OK(rheo_world_step(world, &error));
    REFUSED(RHEO_ERROR_DIFFERS, "begins at step 0, but the world is at step 1",
            rheo_golden_open(world, GOLDEN, &golden, &error));
    rheo_world_destroy(world);
    world = sequential_world();
    REFUSED(RHEO_ERROR_UNSUPPORTED, "other stages or fields", rheo_golden_open(world, GOLDEN, &golden, &error));
    rheo_world_destroy(world);
}

static void no_golden_recording_is_a_failure(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    rheo_golden *golden = (rheo_golden *)&why;
    rheo_verification v;
    REFUSED(RHEO_ERROR_FILE, "none.rlog", rheo_golden_open(world, "none.rlog", &golden, &error));
    assert_null(golden);
    REFUSED(RHEO_ERROR_ARGUMENT, "no golden recording", rheo_golden_close(golden, &v, &error));
    assert_int_equal(v.verdict, RHEO_NOT_COMPARED);
    record_golden(false);
    size_t size;
    free(read_file(GOLDEN, &size));
    assert_int_equal(truncate(GOLDEN, (off_t)size - 7), 0);
    REFUSED(RHEO_ERROR_FORMAT, "truncated", rheo_golden_open(world, GOLDEN, &golden, &error));
    /* Every step is compared: a world that is stepped otherwise is noticed. */
    record_golden(false);
    golden = begin(world);
    OK(rheo_world_step(world, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "step a world only by its recorder", rheo_golden_step(golden, &error));
    REFUSED(RHEO_ERROR_DIFFERS, "this run 0 to 0", rheo_golden_close(golden, &v, &error));
    rheo_world_destroy(world);
}

/* A golden recording may end with a failure, which then is a part of what is compared. */
static void a_step_that_fails_is_compared(void **unused)
{
    (void)unused;
    for (int side = 0; side < 3; side++) { /* 0: records; 1: fails too; 2: ends before */
        rheo_world *world = sequential_world();
        rheo_recorder *recorder = NULL;
        rheo_golden *golden = NULL;
        if (side == 0)
            OK(rheo_recorder_open(world, GOLDEN, &(rheo_record_options){.force = true}, &recorder, &error));
        else
            OK(rheo_golden_open(world, GOLDEN, &golden, &error));
        for (int i = 0; i < 3; i++)
            OK(side ? rheo_golden_step(golden, &error) : rheo_recorder_step(recorder, &error));
        if (side < 2) {
            OK(rheo_world_set(world, "springs.stiffness", "1e30", &error));
            const rheo_result result = side ? rheo_golden_step(golden, &why) : rheo_recorder_step(recorder, &why);
            assert_int_equal(result, RHEO_ERROR_STATE);
        }
        if (side == 0)
            OK(rheo_recorder_close(recorder, &error));
        else if (side == 1)
            OK(rheo_golden_close(golden, NULL, &error));
        else
            REFUSED(RHEO_ERROR_DIFFERS, "0 to 3 and a step that failed", rheo_golden_close(golden, NULL, &error));
        rheo_world_destroy(world);
    }
}

static int remove_files(void **unused)
{
    (void)unused;
    remove(GOLDEN);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_recording_in_memory_has_the_bytes_of_the_file),
        cmocka_unit_test(the_same_run_passes_with_all_its_steps),
        cmocka_unit_test(a_changed_run_fails_at_its_first_difference),
        cmocka_unit_test(a_comparison_that_was_stopped_is_no_success),
        cmocka_unit_test(a_run_of_another_length_fails),
        cmocka_unit_test(another_start_is_refused),
        cmocka_unit_test(no_golden_recording_is_a_failure),
        cmocka_unit_test(a_step_that_fails_is_compared),
    };
    return cmocka_run_group_tests_name("golden run", tests, NULL, remove_files);
}
