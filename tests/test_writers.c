/* Several programs and one recording: a second writer is refused, and a reader sees that a file is being written. */
#define _POSIX_C_SOURCE 200809L
#define PATH "test_writers.rlog"
#include "record_support.h"

#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static rheo_recorder *recorder_of(rheo_world *world, bool force)
{
    rheo_recorder *recorder;
    rheo_record_options options = {.scene = "mine", .keyframe_spacing = 2, .force = force};
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    return recorder;
}

static void a_second_writer_is_refused(void **state)
{
    (void)state;
    remove(PATH);
    rheo_world *world = make_world(2), *other = make_world(2);
    rheo_record_options options = {.force = true};
    rheo_recorder *recorder = NULL, *second;
    for (int replaces = 0; replaces < 2; replaces++) { /* a new file, and one that replaces an old one */
        recorder = recorder_of(world, replaces);
        OK(rheo_recorder_step(recorder, &error));
        REFUSED(RHEO_ERROR_ARGUMENT, "is being written", rheo_recorder_open(other, PATH, &options, &second, &error));
        assert_null(second);
        REFUSED(RHEO_ERROR_ARGUMENT, "is being written", rheo_world_save(other, "", PATH, true, &error));
        OK(rheo_recorder_step(recorder, &error)); /* the first one goes on in the same file */
        OK(rheo_recorder_close(recorder, &error));
        rheo_verification v;
        OK(rheo_verify(PATH, &v, &error));
        assert_int_equal(v.verdict, RHEO_SAME);
        assert_int_equal(v.steps, 2);
    }
    recorder = recorder_of(other, true); /* the lock has ended with the recorder */
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    rheo_world_destroy(other);
    remove(PATH);
}

static void a_file_that_is_written_cannot_be_blessed_over(void **state)
{
    (void)state;
    rheo_world *world = make_world(2);
    rheo_verification v;
    OK(rheo_world_save(world, "", "test_writers_new.rlog", true, &error));
    rheo_recorder *recorder = recorder_of(world, true);
    REFUSED(RHEO_ERROR_ARGUMENT, "is being written",
            rheo_bless(PATH, "test_writers_new.rlog", "why", false, &v, &error));
    assert_int_not_equal(access("test_writers.rlog.tmp-0", F_OK), 0);
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    OK(rheo_verify(PATH, &v, &error));
    assert_int_equal(v.steps, 1);
    rheo_world_destroy(world);
    remove("test_writers_new.rlog");
    remove(PATH);
}

/* ---- Two blessings at once ---- */

/* Blesses, when a task of the outer blessing first reports, whatever that wanted to replace. */
static bool bless_in_between(const char *task, uint64_t done, uint64_t total, void *user)
{
    (void)done, (void)total;
    const char **wanted = user;
    if (!*wanted || strcmp(task, *wanted) != 0)
        return true;
    *wanted = NULL;
    rheo_verification v;
    OK(rheo_bless(PATH, "test_writers_other.rlog", "the first reason", false, &v, &error));
    return true;
}

static void of_two_blessings_at_once_the_second_is_refused(void **state)
{
    (void)state;
    static const char *const TASKS[] = {"verifying", "comparing"};
    for (int k = 0; k < 4; k++) {
        const bool there = k % 2;
        const char *task = TASKS[k / 2], *wanted = task;
        rheo_verification v;
        remove(PATH);
        const char *const names[] = {"test_writers_new.rlog", "test_writers_other.rlog", PATH};
        for (int i = 0; i < 2 + there; i++) {
            rheo_world *world = make_world(2);
            rheo_recorder *recorder;
            const rheo_record_options options = {.scene = "mine", .force = true};
            OK(rheo_recorder_open(world, names[i], &options, &recorder, &error));
            for (int n = 0; n < 3 + (i == 0); n++) /* of two that are the same, the second would change nothing */
                OK(rheo_recorder_step(recorder, &error));
            OK(rheo_recorder_close(recorder, &error));
            rheo_world_destroy(world);
        }
        rheo_use_progress((rheo_progress){bless_in_between, &wanted});
        REFUSED(RHEO_ERROR_ARGUMENT, "another program has written test_writers.rlog meanwhile",
                rheo_bless(PATH, "test_writers_new.rlog", "the second reason", false, &v, &error));
        rheo_use_progress((rheo_progress){NULL, NULL});
        assert_null(wanted);
        assert_int_not_equal(access("test_writers.rlog.tmp-0", F_OK), 0);
        rheo_recording *r;
        rheo_blessing blessing;
        OK(rheo_recording_open(PATH, &r, &error));
        assert_int_equal(rheo_recording_blessing_count(r), 1);
        OK(rheo_recording_blessing(r, 0, &blessing));
        assert_true(says(blessing.because, "the first reason"));
        rheo_recording_close(r);
        /* Again, one after the other: both reasons are kept. */
        OK(rheo_bless(PATH, "test_writers_new.rlog", "the second reason", false, &v, &error));
        OK(rheo_recording_open(PATH, &r, &error));
        assert_int_equal(rheo_recording_blessing_count(r), 2);
        rheo_recording_close(r);
        for (int i = 0; i < 3; i++)
            remove(names[i]);
    }
}

/* Of many writers that begin at the same time, with force, one wins and all others are refused. */
static void of_many_writers_at_once_one_wins(void **state)
{
    (void)state;
    enum { WRITERS = 6, ROUNDS = 8 };
    rheo_world *world = make_world(2);
    const struct timespec pause = {0, 300000000};
    for (int round = 0; round < ROUNDS; round++) {
        pid_t child[WRITERS];
        if (round % 2)
            OK(rheo_world_save(world, "old", PATH, true, &error));
        else
            remove(PATH);
        for (int i = 0; i < WRITERS; i++) {
            child[i] = fork();
            assert_true(child[i] >= 0);
            if (child[i] != 0)
                continue;
            rheo_recorder *recorder;
            rheo_record_options options = {.force = true};
            const rheo_result result = rheo_recorder_open(world, PATH, &options, &recorder, &why);
            if (result != RHEO_OK)
                _exit(result == RHEO_ERROR_ARGUMENT ? 2 : 3);
            nanosleep(&pause, NULL);
            nanosleep(&pause, NULL); /* longer than the others try */
            for (int n = 0; n <= i; n++)
                if (rheo_recorder_step(recorder, &why) != RHEO_OK)
                    _exit(4);
            _exit(rheo_recorder_close(recorder, &why) != RHEO_OK);
        }
        int winners = 0, steps = 0;
        for (int i = 0; i < WRITERS; i++) {
            int status;
            assert_int_equal(waitpid(child[i], &status, 0), child[i]);
            assert_true(WIFEXITED(status));
            if (WEXITSTATUS(status) == 0) {
                winners++;
                steps = i + 1;
            } else {
                assert_int_equal(WEXITSTATUS(status), 2);
            }
        }
        assert_int_equal(winners, 1);
        rheo_verification v;
        OK(rheo_verify(PATH, &v, &error));
        assert_int_equal(v.verdict, RHEO_SAME);
        assert_int_equal(v.steps, steps);
    }
    rheo_world_destroy(world);
    remove(PATH);
}

static void a_file_being_written_is_told_from_a_truncated_one(void **state)
{
    (void)state;
    rheo_world *world = make_world(2);
    rheo_recorder *recorder = recorder_of(world, true);
    rheo_recording *r;
    rheo_verification v;
    for (int n = 0; n < 5; n++)
        OK(rheo_recorder_step(recorder, &error));
    OK(rheo_verify(PATH, &v, &error));
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_true(says(v.message, "still being written: 5 steps so far"));
    OK(rheo_recording_open(PATH, &r, &error)); /* and it can be read */
    assert_true(rheo_recording_get_info(r).being_written);
    assert_false(rheo_recording_get_info(r).complete);
    rheo_world *there;
    OK(rheo_recording_world(r, 5, NULL, &there, &error));
    assert_int_equal(rheo_world_hash(there), rheo_world_hash(world));
    rheo_world_destroy(there);
    rheo_diagnosis d;
    OK(rheo_diagnose(r, &d, &error));
    assert_true(d.being_written);
    assert_true(says(d.why, "being written"));
    REFUSED(RHEO_ERROR_ARGUMENT, "so far", rheo_recording_world(r, 6, NULL, &there, &error));
    rheo_recording_close(r);
    /* Readers do not disturb the writer, and what it has written without an end is a truncated recording. */
    OK(rheo_recorder_step(recorder, &error));
    size_t size;
    uint8_t *bytes = read_file(PATH, &size);
    OK(rheo_recorder_close(recorder, &error));
    OK(rheo_recording_open(PATH, &r, &error));
    assert_true(rheo_recording_get_info(r).complete);
    assert_false(rheo_recording_get_info(r).being_written);
    rheo_recording_close(r);
    write_file(PATH, bytes, size);
    OK(rheo_recording_open(PATH, &r, &error));
    assert_false(rheo_recording_get_info(r).complete);
    assert_false(rheo_recording_get_info(r).being_written);
    OK(rheo_diagnose(r, &d, &error));
    assert_false(d.being_written);
    assert_true(says(d.why, "truncated"));
    rheo_recording_close(r);
    free(bytes);
    rheo_world_destroy(world);
    remove(PATH);
}

/* A recording that cannot be begun, here because its scene has too long a name, leaves the old file. */
static void a_file_is_replaced_only_when_the_new_one_has_begun(void **state)
{
    (void)state;
    static char name[70000];
    memset(name, 'x', sizeof name - 1);
    rheo_world *world = make_world(2);
    rheo_recorder *recorder;
    rheo_record_options options = {.scene = name, .force = true};
    OK(rheo_world_save(world, "old", PATH, true, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "name", rheo_recorder_open(world, PATH, &options, &recorder, &error));
    options.force = false; /* nor is a part of a file left */
    REFUSED(RHEO_ERROR_ARGUMENT, "name",
            rheo_recorder_open(world, "test_writers_new.rlog", &options, &recorder, &error));
    assert_int_not_equal(access("test_writers_new.rlog", F_OK), 0);
    rheo_recording *r;
    OK(rheo_recording_open(PATH, &r, &error));
    assert_string_equal(rheo_recording_get_info(r).scene, "old");
    rheo_recording_close(r);
    assert_int_not_equal(access("test_writers.rlog.tmp-0", F_OK), 0);
    rheo_world_destroy(world);
    remove(PATH);
}

/* A process that is forked, or a program that is started, while a file is written, has the file too. */
static void a_child_does_not_keep_the_lock(void **state)
{
    (void)state;
    rheo_world *world = make_world(2);
    remove(PATH);
    for (int starts = 0; starts < 2; starts++) {
        rheo_recorder *recorder = recorder_of(world, true);
        const pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0 && starts)
            execlp("sleep", "sleep", "60", (char *)NULL);
        if (child == 0) {
            pause();
            _exit(0);
        }
        OK(rheo_recorder_close(recorder, &error));
        recorder = recorder_of(world, true);
        OK(rheo_recorder_close(recorder, &error));
        kill(child, SIGKILL);
        waitpid(child, NULL, 0);
    }
    rheo_world_destroy(world);
    remove(PATH);
}

static void a_device_is_not_replaced(void **state)
{
    (void)state;
    rheo_world *world = make_world(2);
    remove("test_writers.pipe");
    assert_int_equal(mkfifo("test_writers.pipe", 0600), 0);
    rheo_error why_not = {""};
    const rheo_export_options options = {.surface = rheo_default_surface_options(), .force = true};
    assert_int_equal(rheo_world_export(world, RHEO_EXPORT_CSV, "test_writers.pipe", &options, NULL, &why_not),
                     RHEO_ERROR_ARGUMENT);
    assert_non_null(strstr(why_not.message, "no regular file"));
    struct stat status = {0};
    assert_true(stat("test_writers.pipe", &status) == 0 && S_ISFIFO(status.st_mode));
    assert_int_not_equal(access("test_writers.pipe.tmp-0", F_OK), 0);
    rheo_world_destroy(world);
    remove("test_writers.pipe");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_second_writer_is_refused),
        cmocka_unit_test(a_file_that_is_written_cannot_be_blessed_over),
        cmocka_unit_test(of_two_blessings_at_once_the_second_is_refused),
        cmocka_unit_test(of_many_writers_at_once_one_wins),
        cmocka_unit_test(a_file_being_written_is_told_from_a_truncated_one),
        cmocka_unit_test(a_file_is_replaced_only_when_the_new_one_has_begun),
        cmocka_unit_test(a_child_does_not_keep_the_lock),
        cmocka_unit_test(a_device_is_not_replaced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
