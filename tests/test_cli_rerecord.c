/* `rheolog rerecord` from outside: a recording is made again from itself, with its commands and options. */
#define _XOPEN_SOURCE 700
#include "cli_support.h"

#include <unistd.h>

/* Commands of every kind that the library has, recorded by a program of its own. */
static void record_with_commands(const char *path, bool full)
{
    rheo_scene s;
    rheo_world *world;
    rheo_recorder *recorder;
    rheo_error error = {""};
    assert_int_equal(rheo_scene_builtin("bowling-ball-small", &s, &error), RHEO_OK);
    s.settle.time = 0;
    s.world.history.window = 6;
    assert_int_equal(rheo_scene_create_world(&s, &world, &error), RHEO_OK);
    rheo_scene_release(&s);
    const rheo_record_options options = {.scene = "game", .keyframe_spacing = 4, .full = full, .force = true};
    assert_int_equal(rheo_recorder_open(world, path, &options, &recorder, &error), RHEO_OK);
    for (int step = 0; step < 10; step++) {
        if (step == 2)
            assert_int_equal(rheo_world_push_body(world, 0, (double[]){30, 100, 0}, NULL, &error), RHEO_OK);
        if (step == 5)
            assert_int_equal(rheo_world_set(world, "gravity", "[1, -5, 0]", &error), RHEO_OK);
        if (step == 7)
            assert_int_equal(
                rheo_world_add_particles(world, 1, (rheo_real[]){20, 60, 20}, (rheo_real[]){0, -9, 0}, &error),
                RHEO_OK);
        assert_int_equal(rheo_recorder_step(recorder, &error), RHEO_OK);
    }
    assert_int_equal(rheo_recorder_close(recorder, &error), RHEO_OK);
    rheo_world_destroy(world);
}

/* The same build makes the same bytes, from any kind of recording. */
static void a_recording_is_made_again_from_itself(void **state)
{
    (void)state;
    for (int full = 0; full < 2; full++) {
        record_with_commands("old.rlog", full);
        assert_code(0, run("rerecord old.rlog -o new.rlog --force"));
        assert_in("old.rlog, new.rlog: same: 10 steps", out);
        assert_files_same("old.rlog", "new.rlog");
    }
    assert_code(0, run("checkpoint old.rlog --step 6 -o six.rlog --force"));
    assert_code(0, run("rerecord six.rlog -o new.rlog --force --json"));
    assert_string_equal(value_of("verdict"), "\"same\"");
    assert_files_same("six.rlog", "new.rlog");
    /* A part of a run, which begins later; and a melting world. */
    assert_code(0, run("run --from old.rlog@5 --set gravity=[0,-9,0] --steps 4 -o part.rlog --force --quiet"));
    assert_code(0, run("rerecord part.rlog -o new.rlog --force"));
    assert_files_same("part.rlog", "new.rlog");
    record_melting("melt.rlog", "--full");
    assert_code(0, run("rerecord melt.rlog -o new.rlog --force"));
    assert_files_same("melt.rlog", "new.rlog");
}

/* Hashes alone do not say which of several values differ. So a run can be recorded again with its states. */
static void a_recording_is_made_again_with_its_states(void **state)
{
    (void)state;
    record_with_commands("old.rlog", false);
    record_with_commands("full.rlog", true);
    assert_code(0, run("rerecord old.rlog --full -o new.rlog --force"));
    assert_in("old.rlog, new.rlog: same: 10 steps", out);
    assert_files_same("full.rlog", "new.rlog");
    assert_code(0, run("rerecord full.rlog --full -o new.rlog --force"));
    assert_files_same("full.rlog", "new.rlog");
}

static void a_golden_recording_is_made_again_and_blessed(void **state)
{
    (void)state;
    record("a.rlog");
    falsify_step("a.rlog", "changed.rlog", 5); /* as if this build had changed */
    assert_code(1, run("rerecord changed.rlog -o new.rlog --force"));
    assert_in("differs at step 5", out);
    assert_code(0, run("verify new.rlog"));
    assert_files_same("a.rlog", "new.rlog");
    assert_code(1, run("rerecord changed.rlog -o new.rlog --force --json"));
    assert_string_equal(value_of("verdict"), "\"differs\"");
    assert_code(0, run("bless golden.rlog a.rlog --because \"a test\""));
    assert_code(0, run("rerecord golden.rlog -o new.rlog --force"));
    assert_files_same("a.rlog", "new.rlog"); /* reasons are of the golden recording, which bless keeps */
    assert_code(2, run("rerecord golden.rlog -o golden.rlog --force"));
    assert_one_message("onto itself");
    assert_code(2, run("rerecord a.rlog -o golden.rlog --force"));
    assert_one_message("blessed");
}

static void a_failed_run_is_made_again_with_its_failure(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("info a.rlog --json"));
    if (strcmp(value_of("real_bytes"), "4") != 0)
        skip(); /* no parameter value is large enough to overflow doubles */
    assert_code(
        1, run("run %s --steps 50 --set step=1e5 --set fluid.stiffness=1e29 -o bad.rlog --force --quiet", scene));
    assert_code(0, run("rerecord bad.rlog -o new.rlog --force"));
    assert_files_same("bad.rlog", "new.rlog");
}

static void nothing_is_written_in_vain(void **state)
{
    (void)state;
    record("a.rlog");
    size_t size;
    const char *bytes = read_bytes("a.rlog", &size);
    write_file("torn.rlog", bytes, size - 10);
    remove("never.rlog");
    assert_code(2, run("rerecord torn.rlog -o never.rlog"));
    assert_one_message("truncated");
    assert_code(2, run("rerecord a.rlog"));
    assert_one_message("-o NEW.rlog");
    assert_code(2, run("rerecord missing.rlog -o never.rlog"));
    assert_one_message("missing.rlog");
    assert_int_equal(file_size("never.rlog"), -1);
    assert_int_equal(file_size("never.rlog.tmp-0"), -1);
    assert_code(2, run("rerecord a.rlog -o torn.rlog"));
    assert_one_message("--force");
}

static void a_damaged_recording_is_not_made_again(void **state)
{
    (void)state;
    record("a.rlog");
    size_t size, at;
    char *bytes = read_bytes("a.rlog", &size);
    for (at = size - 200; memcmp(bytes + at, "STEP", 4) != 0; at--)
        ;
    bytes[at + 50] ^= 0x10;
    write_file("damaged.rlog", bytes, size);
    remove("again.rlog");
    assert_code(2, run("rerecord damaged.rlog -o again.rlog"));
    assert_in("damaged", err);
    assert_int_equal(access("again.rlog", F_OK), -1);
    remove("damaged.rlog");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_damaged_recording_is_not_made_again),
        cmocka_unit_test(a_recording_is_made_again_from_itself),
        cmocka_unit_test(a_recording_is_made_again_with_its_states),
        cmocka_unit_test(a_golden_recording_is_made_again_and_blessed),
        cmocka_unit_test(a_failed_run_is_made_again_with_its_failure),
        cmocka_unit_test(nothing_is_written_in_vain),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
