/* Progress of long tasks: what a receiver is told, that it can stop every task, and that it changes no result. */
#include <sys/stat.h>

#include "support.h"

enum { STEPS = 12 };

static const char *const A = "test_progress_a.rlog", *const B = "test_progress_b.rlog";

/* A receiver that writes down what it is told, and stops after `stop_after` reports of one task. */
typedef struct notes {
    const char *task;                     /* the one that is noted; NULL: any */
    uint64_t reports, last_done, last_of; /* of that task */
    uint64_t stop_after;                  /* 0: never */
    bool stopped, in_order;
} notes;

static bool note(const char *task, uint64_t done, uint64_t total, void *user)
{
    notes *n = user;
    if (n->stopped)
        return false;
    if (n->task && strcmp(task, n->task) != 0)
        return true;
    n->in_order = n->in_order && done >= 1 && done <= total && (n->reports == 0 || done == n->last_done + 1);
    n->last_done = done;
    n->last_of = total;
    n->stopped = ++n->reports == n->stop_after;
    return !n->stopped;
}

static notes watching(const char *task, uint64_t stop_after)
{
    return (notes){.task = task, .stop_after = stop_after, .in_order = true};
}

#define WATCHED(n, call)                                                  \
    do {                                                                  \
        rheo_use_progress((rheo_progress){note, &(n)});                   \
        call;                                                             \
        const rheo_progress used = rheo_use_progress((rheo_progress){0}); \
        assert_ptr_equal(used.user, &(n));                                \
    } while (0)

/* Keyframes are 5 steps apart. `push` makes the step 7 differ. */
static void record(const char *path, bool push)
{
    rheo_world *world = lively_world();
    rheo_recorder *recorder;
    const rheo_record_options options = {.keyframe_spacing = 5, .force = true};
    const double impulse[3] = {1, 0, 0};
    OK(rheo_recorder_open(world, path, &options, &recorder, &error));
    for (int step = 1; step <= STEPS; step++) {
        if (push && step == 7)
            OK(rheo_world_push_body(world, 0, impulse, NULL, &error));
        OK(rheo_recorder_step(recorder, &error));
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
}

static void verifying_tells_every_step_and_stops_at_each(void **state)
{
    (void)state;
    record(A, false);
    rheo_verification v, unwatched;
    OK(rheo_verify(A, &unwatched, &error));
    notes all = watching("verifying", 0);
    WATCHED(all, OK(rheo_verify(A, &v, &error)));
    assert_true(all.in_order);
    assert_int_equal(all.reports, STEPS);
    assert_int_equal(all.last_of, STEPS);
    assert_int_equal(v.verdict, RHEO_SAME);
    assert_true(v.hash == unwatched.hash);
    for (uint64_t step = 1; step <= STEPS; step++) {
        notes some = watching("verifying", step);
        WATCHED(some, REFUSED(RHEO_ERROR_STOPPED, "stopped", rheo_verify(A, &v, &error)));
        assert_int_equal(v.steps, step); /* a partial result */
    }
    OK(rheo_verify(A, &v, &error)); /* without a receiver again */
}

static void a_difference_is_told_even_if_its_growth_is_not_wanted(void **state)
{
    (void)state;
    record(A, false);
    record(B, true);
    rheo_verification v;
    notes all = watching("comparing", 0);
    WATCHED(all, OK(rheo_diff(A, B, &v, &error)));
    assert_true(all.in_order && all.reports == 7);
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_int_equal(v.first.step, 7);
    notes some = watching("comparing", 4);
    WATCHED(some, REFUSED(RHEO_ERROR_STOPPED, "comparing", rheo_diff(A, B, &v, &error)));
    assert_int_equal(v.steps, 4);
    /* In the search for values, a stop must not become a difference without values. */
    notes seeking = watching("simulating", 1);
    WATCHED(seeking, REFUSED(RHEO_ERROR_STOPPED, "comparing", rheo_diff(A, B, &v, &error)));
}

static void seeking_stops_at_a_whole_step(void **state)
{
    (void)state;
    record(A, false);
    rheo_recording *recording;
    rheo_player *player;
    rheo_world *world;
    OK(rheo_recording_open(A, &recording, &error));
    notes all = watching("simulating", 0);
    WATCHED(all, OK(rheo_recording_world(recording, 9, NULL, &world, &error)));
    assert_true(all.in_order && all.reports == 4 && all.last_of == 4); /* from the keyframe at 5 */
    const uint64_t hash = rheo_world_hash(world);
    rheo_world_destroy(world);
    notes some = watching("simulating", 3);
    WATCHED(some,
            REFUSED(RHEO_ERROR_STOPPED, "simulating", rheo_recording_world(recording, 9, NULL, &world, &error)));
    assert_null(world);
    OK(rheo_player_open(recording, NULL, &player, &error));
    some = watching("simulating", 2);
    WATCHED(some, REFUSED(RHEO_ERROR_STOPPED, "simulating", rheo_player_seek(player, 9, &error)));
    assert_int_equal(rheo_world_step_count(rheo_player_world(player)), 7);
    OK(rheo_player_seek(player, 9, &error));
    assert_true(rheo_world_hash(rheo_player_world(player)) == hash);
    rheo_player_close(player);
    rheo_recording_close(recording);
}

/* Also if the stop comes when the two have been compared. */
static void blessing_that_is_stopped_replaces_nothing(void **state)
{
    (void)state;
    static const char *const tasks[] = {"verifying", "comparing", "simulating"};
    struct stat before, after;
    rheo_verification v;
    record(A, false);
    record(B, true);
    assert_int_equal(stat(A, &before), 0);
    for (size_t i = 0; i < 3; i++)
        for (uint64_t report = 1; report <= 3; report++) {
            notes some = watching(tasks[i], report);
            WATCHED(some, REFUSED(RHEO_ERROR_STOPPED, "stopped", rheo_bless(A, B, "a push", false, &v, &error)));
            assert_true(some.stopped);
            assert_int_equal(stat(A, &after), 0);
            assert_true(before.st_ino == after.st_ino && before.st_size == after.st_size);
        }
    OK(rheo_bless(A, B, "a push", false, &v, &error));
    remove(A);
}

static void recording_again_tells_its_steps_and_leaves_nothing(void **state)
{
    (void)state;
    static const char *const tasks[] = {"recording", "comparing"};
    static const char beside[] = "test_progress_b.rlog.tmp-0";
    rheo_verification v;
    struct stat status;
    record(A, true);
    remove(B);
    notes all = watching("recording", 0);
    WATCHED(all, OK(rheo_rerecord(A, B, false, false, &v, &error)));
    assert_true(all.in_order && all.reports == STEPS && all.last_done == all.last_of);
    assert_int_equal(v.verdict, RHEO_SAME);
    remove(B);
    for (size_t i = 0; i < 2; i++)
        for (uint64_t report = 1; report <= STEPS; report++) {
            notes some = watching(tasks[i], report);
            WATCHED(some, REFUSED(RHEO_ERROR_STOPPED, "stopped", rheo_rerecord(A, B, false, false, &v, &error)));
            assert_true(some.stopped);
            assert_true(stat(B, &status) != 0 && stat(beside, &status) != 0);
        }
}

static void settling_tells_its_steps_and_stops(void **state)
{
    (void)state;
    rheo_scene scene;
    rheo_world *world;
    OK(rheo_scene_builtin("bowling-ball-small", &scene, &error));
    OK(rheo_scene_set(&scene, "settle.time", "0.264", &error));
    notes all = watching("settling", 0);
    WATCHED(all, OK(rheo_scene_create_world(&scene, &world, &error)));
    assert_true(all.in_order && all.reports > 2 && all.last_done == all.last_of);
    rheo_world_destroy(world);
    notes some = watching("settling", 2);
    WATCHED(some, REFUSED(RHEO_ERROR_STOPPED, "settling", rheo_scene_create_world(&scene, &world, &error)));
    assert_null(world);
    rheo_scene_release(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(verifying_tells_every_step_and_stops_at_each),
        cmocka_unit_test(a_difference_is_told_even_if_its_growth_is_not_wanted),
        cmocka_unit_test(seeking_stops_at_a_whole_step),
        cmocka_unit_test(blessing_that_is_stopped_replaces_nothing),
        cmocka_unit_test(recording_again_tells_its_steps_and_leaves_nothing),
        cmocka_unit_test(settling_tells_its_steps_and_stops),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    remove(A);
    remove(B);
    return failed;
}
