/*
 * Comparing recordings. The first difference is reported with step, stage, field and item, and with values where
 * possible. Golden recordings change only by blessing.
 */
#define _XOPEN_SOURCE 700
#include <sys/stat.h>
#include <locale.h>
#include <math.h>
#include <unistd.h>

#include "record/recording.h"
#include "forge.h"
#include "support.h"

static const char *const A = "test_diff_a.rlog", *const B = "test_diff_b.rlog", *const C = "test_diff_c.rlog";
static rheo_error why; /* error of calls that may be refused */

typedef struct run_options {
    uint64_t steps, change_at; /* a command sets the parameter before step change_at + 1; 0: it is set at the start */
    const char *path, *value;  /* may be NULL */
    bool full, settled;        /* settled: the scene settles with the parameter */
    uint64_t spacing;
} run_options;

static void record(const char *path, run_options o)
{
    rheo_scene scene = lively_scene();
    rheo_world *world;
    rheo_recorder *recorder;
    if (o.settled)
        OK(rheo_world_def_set(&scene.world, o.path, o.value, &error));
    OK(rheo_scene_create_world(&scene, &world, &error));
    OK(rheo_recorder_open(
        world, path,
        &(rheo_record_options){
            .scene = "diff", .keyframe_spacing = o.spacing ? o.spacing : 1000, .full = o.full, .force = true},
        &recorder, &error));
    for (uint64_t i = 0; i < o.steps; i++) {
        if (o.path && !o.settled && i == o.change_at)
            OK(rheo_world_set(world, o.path, o.value, &error));
        OK(rheo_recorder_step(recorder, &error));
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
}

static rheo_verification diff(const char *a, const char *b)
{
    rheo_verification v;
    OK(rheo_diff(a, b, &v, &error));
    return v;
}

/* ---- Differences ---- */

static void the_same_runs_are_the_same(void **unused)
{
    (void)unused;
    record(A, (run_options){.steps = 20});
    record(B, (run_options){.steps = 20, .full = true, .spacing = 6});
    rheo_verification v = diff(A, B);
    if (v.verdict != RHEO_SAME)
        fail_msg("%s", v.message);
    assert_int_equal(v.steps, 20);
}

/* A run that stopped early must not pass for the whole. */
static void a_shorter_recording_is_not_the_same(void **unused)
{
    (void)unused;
    record(A, (run_options){.steps = 20});
    record(B, (run_options){.steps = 13});
    rheo_verification v = diff(A, B);
    assert_true(v.verdict == RHEO_DIFFERS && v.lengths_differ && v.steps == 13 && v.first.step == 14);
    assert_true(v.first_step[0] == 0 && v.last_step[0] == 20 && v.first_step[1] == 0 && v.last_step[1] == 13);
    assert_non_null(
        strstr(v.message, "the first has steps 0 to 20, the second 0 to 13; the 13 steps that both have"));
    v = diff(B, A);
    assert_true(v.verdict == RHEO_DIFFERS && v.lengths_differ && v.first.step == 14);
    /* A difference in a common step counts more than the length. */
    record(B, (run_options){13, 4, "fluid.stiffness", "310", false, false, 0});
    v = diff(A, B);
    assert_true(v.verdict == RHEO_DIFFERS && !v.lengths_differ && v.first.step == 5);
}

static void a_check_demands_the_same_and_enough_steps(void **unused)
{
    (void)unused;
    rheo_verification v = {0};
    REFUSED(RHEO_ERROR_DIFFERS, "not compared", rheo_verification_check(&v, 0, &error));
    (void)rheo_verify("none.rlog", &v, NULL);
    REFUSED(RHEO_ERROR_DIFFERS, "none.rlog", rheo_verification_check(&v, 0, &error));
    record(A, (run_options){.steps = 4});
    record(B, (run_options){.steps = 5});
    OK(rheo_verify(A, &v, &error));
    OK(rheo_verification_check(&v, 4, &error));
    REFUSED(RHEO_ERROR_DIFFERS, "4 steps are the same, but at least 5", rheo_verification_check(&v, 5, &error));
    v = diff(A, B);
    REFUSED(RHEO_ERROR_DIFFERS, "differs in length", rheo_verification_check(&v, 4, &error));
    write_file(B, "no recording", 12);
    v = diff(A, B);
    REFUSED(RHEO_ERROR_DIFFERS, "unreadable", rheo_verification_check(&v, 0, &error));
    remove(B);
}

/* Commands that differ only in their value, in a step that may be the last, differ. */
static void other_commands_in_the_same_step_differ(void **unused)
{
    (void)unused;
    static const char *const other[] = {"320", "310.5", "310"};
    for (uint64_t at = 4; at < 12; at += 7)
        for (int i = 0; i < 3; i++) {
            record(A, (run_options){12, at, "fluid.stiffness", "310", false, false, 0});
            record(B, (run_options){12, at, "fluid.stiffness", other[i], false, false, 0});
            const rheo_verification v = diff(A, B);
            assert_int_equal(v.verdict, i < 2 ? RHEO_DIFFERS : RHEO_SAME);
            assert_true(v.commands_differ == (i < 2) && v.commands_step == (i < 2 ? at + 1 : 0));
        }
}

/* The values are those right after the stage, as in two worlds that run side by side. */
static void a_changed_constant_is_named_with_values(void **unused)
{
    (void)unused;
    for (int full = 0; full < 2; full++) {
        record(A, (run_options){.steps = 40, .full = full});
        record(B, (run_options){40, 9, "fluid.near_stiffness", "500.0005", full, false, 7});
        rheo_verification v = diff(A, B);
        assert_int_equal(v.verdict, RHEO_DIFFERS);
        assert_true(v.first.step == 10 && v.steps == 9 && v.first.origin == RHEO_VALUES_SIMULATED);
        assert_string_equal(v.first.stage, "forces@1");
        assert_string_equal(v.first.field, "position");
        assert_true(v.commands_differ && v.commands_step == 10 && !v.has_cause);

        rheo_world *a, *b;
        rheo_recording *r;
        OK(rheo_recording_open(A, &r, &error));
        OK(rheo_recording_world(r, 9, NULL, &a, &error));
        OK(rheo_recording_world(r, 9, NULL, &b, &error));
        rheo_recording_close(r);
        OK(rheo_world_set(b, "fluid.near_stiffness", "500.0005", &error));
        uint32_t stage = 0;
        rheo_stage_info info = {.name = ""};
        while (strcmp(info.name, "forces") != 0) {
            OK(rheo_world_step_stage(a, &stage, &error));
            OK(rheo_world_step_stage(b, &stage, &error));
            OK(rheo_world_stage(a, stage, &info));
        }
        const rheo_real *xa = rheo_world_positions(a), *xb = rheo_world_positions(b);
        uint64_t first = UINT64_MAX, count = 0;
        double largest = 0, scale = 0;
        for (uint32_t i = 0; i < 3 * rheo_world_particle_count(a); i++) {
            largest = fmax(largest, fabs((double)xa[i] - (double)xb[i]));
            scale = fmax(scale, fmax(fabs((double)xa[i]), fabs((double)xb[i])));
        }
        assert_true(v.first.largest == largest && largest > 0 && v.first.scale == scale);
        for (uint32_t i = 0; i < rheo_world_particle_count(a); i++)
            if (memcmp(xa + 3 * i, xb + 3 * i, 3 * sizeof *xa) != 0 && ++count == 1) {
                first = 3 * i; /* the component that differs most */
                for (uint32_t k = 3 * i + 1; k < 3 * i + 3; k++)
                    if (fabs((double)xa[k] - (double)xb[k]) > fabs((double)xa[first] - (double)xb[first]))
                        first = k;
            }
        assert_true(v.first.id == first / 3 && v.first.component == first % 3 && v.first.count == count && count > 9);
        assert_true(v.first.expected == (double)xa[first] && v.first.actual == (double)xb[first]);
        assert_true(v.first.ulps > 0 && v.first.expected - v.first.actual < 1e-4 &&
                    v.first.actual - v.first.expected < 1e-4);
        rheo_world_destroy(a);
        rheo_world_destroy(b);

        /* One step, then 1, 2, 4, ... steps later. */
        uint64_t expected = 10, on = 0;
        for (uint32_t i = 0; i < v.growth_count; i++)
            if (i == 0 || v.growth[i].step != v.growth[i - 1].step) {
                assert_int_equal(v.growth[i].step, expected);
                on = on ? 2 * on : 1;
                expected = 10 + on;
            }
        assert_true(v.growth_count > 10 && expected == 10 + 32);
    }
}

/* Records every state of 12 steps, with a change without a command before step 5, and falsifies a hash of step 2. */
static file rounded_away(const char *stiffness)
{
    enum { ROOM = 1 << 23 };
    rheo_world *world = lively_world();
    rheo_recorder *recorder;
    file f = {malloc(ROOM), 0};
    forged g;
    void *bytes;
    size_t size;
    OK(rheo_recorder_open_memory(world, &(rheo_record_options){.full = true}, &recorder, &error));
    for (int i = 0; i < 12; i++) {
        if (i == 4)
            OK(rheo_world_set(world, "fluid.stiffness", stiffness, &error));
        rheo__world_forget_commands(world);
        OK(rheo_recorder_step(recorder, &error));
    }
    OK(rheo_recorder_close_memory(recorder, &bytes, &size, &error));
    rheo_world_destroy(world);
    forge_open(&g, bytes, size, ROOM);
    forge_find(&g, RHEO__STEP, 1)->data[8] ^= 1;
    f.size = forge_write(&g, true, f.bytes, ROOM);
    forge_release(&g);
    free(bytes);
    return f;
}

/* A hash differs, but the change is rounded away at the end of the step: a full recording still has values, later. */
static void values_come_from_the_first_stored_states_that_differ(void **unused)
{
    (void)unused;
    rheo_verification v;
    file one = rounded_away("301"), other = rounded_away("302"), none = rounded_away("300");
    OK(rheo_verify_memory(one.bytes, one.size, &v, &error));
    assert_true(v.verdict == RHEO_DIFFERS && v.first.step == 2 && v.first.value_step == 5);
    assert_true(v.first.origin == RHEO_VALUES_STORED && v.first.count > 0);
    assert_non_null(strstr(v.message, "; the values agree again at its end; at the end of step 5 "));
    OK(rheo_verify_memory(none.bytes, none.size, &v, &error));
    assert_true(v.verdict == RHEO_DIFFERS && v.first.step == 2 && v.first.origin == RHEO_VALUES_NONE);
    assert_non_null(strstr(v.message, "; all values agree again at the end of the step, and up to step 12"));
    forged g;
    forge_open(&g, other.bytes, other.size, 1 << 23);
    forge_find(&g, RHEO__STEP, 1)->data[8] ^= 2;
    other.size = forge_write(&g, true, other.bytes, 1 << 23);
    forge_release(&g);
    OK(rheo_diff_memory(one.bytes, one.size, other.bytes, other.size, &v, &error));
    assert_true(v.verdict == RHEO_DIFFERS && v.first.step == 2 && v.first.value_step == 5);
    assert_non_null(strstr(v.message, "; the values agree again at its end; at the end of step 5 "));
    free(one.bytes);
    free(other.bytes);
    free(none.bytes);
}

/* Millions of ulps between 1e-9 and 2e-9 say nothing where other values are of size 1. */
static void sizes_say_what_ulps_cannot(void **unused)
{
    (void)unused;
    static const struct {
        double a, b;
        bool has_ulps;
    } CASES[] = {
        {1, 1.0000002, true}, {1e-9, 2e-9, false}, {-1e-3, 1e-3, false}, {0, 1e-9, false}, {1e-3, 1.1e-3, true}};
    const rheo_real position[] = {0, 0, 0, 9, 0, 0};
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        void *bytes[2];
        size_t size[2];
        for (int side = 0; side < 2; side++) {
            const rheo_real velocity[] = {(rheo_real)(side ? CASES[i].b : CASES[i].a), 0, 0, -2, 0, 0};
            rheo_world *world = world_of(inert_def(), 2, position, velocity);
            OK(rheo_world_save_memory(world, "", &bytes[side], &size[side], &error));
            rheo_world_destroy(world);
        }
        rheo_verification v;
        OK(rheo_diff_memory(bytes[0], size[0], bytes[1], size[1], &v, &error));
        assert_true(v.verdict == RHEO_DIFFERS && v.first.scale == 2);
        assert_string_equal(v.first.field, "velocity");
        NEAR(v.first.largest, CASES[i].b - CASES[i].a, 1e-7 * CASES[i].b);
        assert_int_equal(strstr(v.message, "apart") != NULL, CASES[i].has_ulps);
        assert_non_null(strstr(v.message, "of the field's largest value"));
        free(bytes[0]);
        free(bytes[1]);
    }
}

static void an_item_of_one_side_is_said_to_be_there_only(void **unused)
{
    (void)unused;
    const rheo_real position[] = {8, 30, 8};
    record(A, (run_options){.steps = 3});
    rheo_world *world = lively_world();
    rheo_recorder *recorder;
    OK(rheo_recorder_open(world, B, &(rheo_record_options){.scene = "diff", .force = true}, &recorder, &error));
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_world_add_particles(world, 1, position, NULL, &error));
    for (int i = 0; i < 2; i++)
        OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    const uint32_t last = rheo_world_particle_count(world) - 1;
    rheo_world_destroy(world);
    rheo_verification v = diff(A, B);
    assert_true(v.verdict == RHEO_DIFFERS && v.first.step == 2 && v.first.only_actual && !v.first.only_expected);
    assert_true(v.first.id == last && v.first.ulps == UINT64_MAX);
    assert_non_null(strstr(v.message, "in the second, which alone has this item"));
    assert_null(strstr(v.message, "in the first,"));
}

/* The first question to a difference: which build recorded it, and which is this? */
static void a_difference_names_the_builds(void **unused)
{
    (void)unused;
    record(A, (run_options){.steps = 12});
    record(B, (run_options){12, 4, "fluid.stiffness", "310", false, false, 0});
    rheo_verification v = diff(A, B);
    assert_string_equal(v.build[0], rheo_build());
    assert_string_equal(v.build[1], rheo_build());
    assert_null(strstr(v.message, rheo_build())); /* they are the same */
    rheo_recording *a, *b;
    rheo_world *world;
    char named[512];
    OK(rheo_recording_open(A, &a, &error));
    OK(rheo_recording_open(B, &b, &error));
    memcpy(strstr(a->head.build, "rheolog"), "RHEOLOG", 7);
    OK(rheo__diff_recordings(a, b, (const char *const[]){"the first", "the second"}, &v, &error));
    snprintf(named, sizeof named, "; builds: %s (the first), %s (the second)", a->head.build, rheo_build());
    assert_non_null(strstr(v.message, named));
    OK(rheo_recording_world(a, 0, NULL, &world, &error));
    OK(rheo_world_set(world, "fluid.stiffness", "310", &error));
    rheo__world_forget_commands(world);
    OK(rheo__verify_world(a, world, &v, &error));
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    snprintf(named, sizeof named, "; builds: %s (the recording), %s (this build)", a->head.build, rheo_build());
    assert_non_null(strstr(v.message, named));
    rheo_world_destroy(world);
    rheo_recording_close(a);
    rheo_recording_close(b);
}

static void parameters_of_settling_are_the_cause(void **unused)
{
    (void)unused;
    record(A, (run_options){.steps = 5});
    record(B, (run_options){.steps = 5, .path = "fluid.near_stiffness", .value = "500.0005", .settled = true});
    rheo_verification v = diff(A, B);
    assert_true(v.verdict == RHEO_DIFFERS && v.first.step == 0 && v.first.origin == RHEO_VALUES_STORED);
    assert_string_equal(v.first.stage, "");
    assert_string_equal(v.first.field, "position");
    assert_true(v.has_cause && v.cause.step == 1 && v.cause.origin == RHEO_VALUES_SIMULATED && v.cause.count > 9);
    assert_string_equal(v.cause.stage, "forces@1");
    assert_string_equal(v.cause.field, "position");
}

/* Two particles, one of which comes within the support of the other in step `meets`. */
static void record_pair(const char *path, uint64_t meets, uint64_t steps, double stiffness, double aside)
{
    rheo_world_def def = inert_def();
    def.step = 0x1p-6;
    def.substeps = 1;
    def.fluid.near_stiffness = stiffness;
    const rheo_real position[6] = {0, 0, 0, (rheo_real)(2 + ((double)meets - 0.5) * def.step), (rheo_real)aside, 0};
    static const rheo_real velocity[6] = {0, 0, 0, -1, 0, 0};
    rheo_world *world = world_of(def, 2, position, velocity);
    rheo_recorder *recorder;
    OK(rheo_recorder_open(world, path, &(rheo_record_options){.scene = "pair", .full = true, .force = true},
                          &recorder, &error));
    for (uint64_t i = 0; i < steps; i++)
        OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
}

/* Other starts hide what a parameter does, so the first one is continued: for 32 steps, or to its end. */
static void a_cause_is_looked_for_in_the_first_steps(void **unused)
{
    (void)unused;
    static const struct {
        uint64_t meets, steps;
        bool found;
    } cases[] = {{1, 5, true},   {2, 5, true},   {5, 5, true},   {6, 5, false},
                 {31, 40, true}, {32, 40, true}, {33, 40, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        record_pair(A, cases[i].meets, cases[i].steps, 1, 0);
        record_pair(B, cases[i].meets, cases[i].steps, 2, 1e-3);
        const rheo_verification v = diff(A, B);
        assert_true(v.verdict == RHEO_DIFFERS && v.first.step == 0);
        assert_int_equal(v.has_cause, cases[i].found);
        if (v.has_cause)
            assert_int_equal(v.cause.step, cases[i].meets);
        /* The same parameters have no cause. */
        record_pair(B, cases[i].meets, cases[i].steps, 1, 1e-3);
        assert_false(diff(A, B).has_cause);
    }
}

/* Neither recording replays with this build, so values exist only in stored states. */
static void recordings_of_other_builds_need_stored_states(void **unused)
{
    (void)unused;
    for (int full = 0; full < 2; full++) {
        rheo_scene scene = lively_scene();
        rheo_world *world;
        rheo_recorder *recorder;
        const char *const path[] = {A, B};
        for (int side = 0; side < 2; side++) {
            OK(rheo_scene_create_world(&scene, &world, &error));
            OK(rheo_recorder_open(
                world, path[side],
                &(rheo_record_options){.scene = "other", .keyframe_spacing = 1000, .full = full, .force = true},
                &recorder, &error));
            for (int i = 0; i < 12; i++) {
                /* A change without a command looks like another build. */
                if (i == 4) {
                    OK(rheo_world_set(world, "fluid.stiffness", side ? "301" : "302", &error));
                    rheo__world_forget_commands(world);
                }
                OK(rheo_recorder_step(recorder, &error));
            }
            OK(rheo_recorder_close(recorder, &error));
            rheo_world_destroy(world);
        }
        rheo_verification v = diff(A, B);
        assert_true(v.verdict == RHEO_DIFFERS && v.first.step == 5 && !v.commands_differ);
        assert_string_equal(v.first.stage, "forces@1");
        assert_string_equal(v.first.field, "position");
        assert_int_equal(v.first.origin, full ? RHEO_VALUES_STORED : RHEO_VALUES_NONE);
        assert_non_null(strstr(v.message, full ? "from stored states" : "--full"));
        assert_true(full ? v.first.count > 0 && v.growth_count > 5 : v.growth_count == 0);
        /* A stored state needs no simulation. */
        rheo_recording *r;
        OK(rheo_recording_open(A, &r, &error));
        rheo_result result = rheo_recording_world(r, 12, NULL, &world, &why);
        assert_int_equal(result, full ? RHEO_OK : RHEO_ERROR_DIFFERS);
        rheo_world_destroy(world);
        rheo_player *player;
        OK(rheo_player_open(r, NULL, &player, &error));
        if (full) {
            OK(rheo_player_seek(player, 9, &error));
            assert_int_equal(rheo_player_seek_stage(player, 5, "forces", &why), RHEO_ERROR_DIFFERS);
            OK(rheo_player_seek(player, 5, &error));
        } else {
            assert_int_equal(rheo_player_seek(player, 9, &why), RHEO_ERROR_DIFFERS);
            assert_int_equal(rheo_world_step_count(rheo_player_world(player)), 4);
            assert_int_equal(rheo_world_stages_done(rheo_player_world(player)), 0);
        }
        rheo_player_close(player);
        rheo_recording_close(r);
    }
}

static void recordings_are_compared_over_common_steps(void **unused)
{
    (void)unused;
    record(A, (run_options){.steps = 20, .spacing = 6});
    rheo_recording *r;
    rheo_world *world;
    rheo_recorder *recorder;
    OK(rheo_recording_open(A, &r, &error));
    OK(rheo_recording_world(r, 9, NULL, &world, &error));
    OK(rheo_recorder_open(world, B, &(rheo_record_options){.scene = "diff", .keyframe_spacing = 1000, .force = true},
                          &recorder, &error));
    for (int i = 0; i < 8; i++)
        OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    rheo_verification v = diff(A, B);
    assert_true(v.lengths_differ && v.steps == 8 && v.first.step == 0);
    v = diff(B, A);
    assert_true(v.lengths_differ && v.steps == 8 && v.first.step == 0);
    /* The recordings have no common step. */
    OK(rheo_world_save(world, "diff", C, true, &error));
    record(A, (run_options){.steps = 5});
    v = diff(A, C);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "no step in common"));
    rheo_world_destroy(world);
    rheo_recording_close(r);
}

static void files_that_cannot_be_compared_are_reported(void **unused)
{
    (void)unused;
    record(A, (run_options){.steps = 5});
    rheo_scene scene = lively_scene();
    rheo_world *world;
    scene.world.history.stiffness = 0;
    OK(rheo_scene_create_world(&scene, &world, &error));
    OK(rheo_world_save(world, "bare", B, true, &error));
    rheo_world_destroy(world);
    rheo_verification v = diff(A, B);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "other stages or fields"));
    record(B, (run_options){.steps = 5});
    struct stat status;
    assert_int_equal(stat(B, &status), 0);
    assert_int_equal(truncate(B, status.st_size - 7), 0);
    v = diff(A, B);
    assert_true(v.verdict == RHEO_UNREADABLE && v.steps == 5);
    assert_non_null(strstr(v.message, "the second recording: truncated"));
    assert_null(strstr(v.message, "the next one differs")); /* it is missing */
    rheo_verification ignored;
    REFUSED(RHEO_ERROR_FILE, "none.rlog", rheo_diff("none.rlog", A, &ignored, &error));
}

/* A test that ignores results, or never calls the function, must not pass. */
static void nothing_compared_is_never_the_same(void **unused)
{
    (void)unused;
    record(A, (run_options){.steps = 3});
    rheo_verification v = {0};
    assert_true(v.verdict == RHEO_NOT_COMPARED && v.verdict != RHEO_SAME);
    for (int i = 0; i < 3; i++) {
        v = diff(A, A); /* left over from a success */
        assert_int_equal(v.verdict, RHEO_SAME);
        rheo_result result = i == 0   ? rheo_verify("none.rlog", &v, NULL)
                             : i == 1 ? rheo_diff("none.rlog", A, &v, NULL)
                                      : rheo_diff(A, "none.rlog", &v, NULL);
        assert_int_equal(result, RHEO_ERROR_FILE);
        assert_int_equal(v.verdict, RHEO_NOT_COMPARED);
        assert_int_equal(v.steps, 0);
        assert_true(strncmp(v.message, "not compared: none.rlog", 23) == 0);
    }
    remove(C);
    v.verdict = RHEO_SAME;
    REFUSED(RHEO_ERROR_FILE, "none.rlog", rheo_bless(C, "none.rlog", "why", false, &v, &error));
    assert_int_equal(v.verdict, RHEO_NOT_COMPARED);
}

/* Records steps; then, if wanted, one more that fails. */
static void record_failing(const char *path, int steps, bool fails)
{
    rheo_world *world = sequential_world();
    rheo_recorder *recorder;
    OK(rheo_recorder_open(world, path, &(rheo_record_options){.force = true}, &recorder, &error));
    for (int i = 0; i < steps; i++)
        OK(rheo_recorder_step(recorder, &error));
    if (fails) {
        OK(rheo_world_set(world, "springs.stiffness", "1e30", &error));
        assert_int_equal(rheo_recorder_step(recorder, &why), RHEO_ERROR_STATE);
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
}

/* One run failed at a step that the other completed. */
static void a_failure_on_one_side_differs(void **unused)
{
    (void)unused;
    record_failing(A, 4, false);
    record_failing(B, 3, true);
    rheo_verification v = diff(A, B);
    assert_true(v.verdict == RHEO_DIFFERS && v.steps == 3 && v.first.step == 4);
    assert_non_null(strstr(v.message, "failed in the second"));
    /* Both have the same steps, but one then tried another. */
    record_failing(A, 3, false);
    v = diff(A, B);
    assert_true(v.verdict == RHEO_DIFFERS && v.lengths_differ && v.steps == 3 && v.first.step == 4);
    assert_non_null(strstr(v.message, "the second 0 to 3 and a step that failed"));
    record_failing(A, 3, true);
    v = diff(A, B);
    assert_int_equal(v.verdict, RHEO_SAME);
    assert_non_null(strstr(v.message, "and the failure of the next"));
    /* Both failed in the same step, at different places. */
    rheo_recording *a, *b;
    OK(rheo_recording_open(A, &a, &error));
    OK(rheo_recording_open(B, &b, &error));
    b->failure.component ^= 1;
    OK(rheo__diff_recordings(a, b, (const char *const[]){"the first", "the second"}, &v, &error));
    assert_true(v.verdict == RHEO_DIFFERS && !v.lengths_differ && v.first.step == 4);
    assert_non_null(strstr(v.message, "for another reason in the second"));
    rheo_recording_close(a);
    rheo_recording_close(b);
}

/* ---- Blessing ---- */

static uint32_t blessings(const char *path, rheo_blessing *last, char because[256])
{
    rheo_recording *r;
    OK(rheo_recording_open(path, &r, &error));
    uint32_t count = rheo_recording_blessing_count(r);
    assert_int_equal(rheo_recording_blessing(r, count, last), RHEO_ERROR_ARGUMENT);
    if (count) {
        OK(rheo_recording_blessing(r, count - 1, last));
        snprintf(because, 256, "%s", last->because);
        assert_string_equal(last->build, rheo_build());
    }
    rheo_recording_close(r);
    return count;
}

static void golden_recordings_change_only_by_blessing(void **unused)
{
    (void)unused;
    rheo_verification v;
    rheo_blessing last;
    char because[256];
    remove(C);
    record(A, (run_options){.steps = 12, .full = true});
    OK(rheo_bless(C, A, "the first one", false, &v, &error));
    assert_non_null(strstr(v.message, "yet"));
    assert_int_equal(blessings(C, &last, because), 1);
    assert_string_equal(because, "the first one [not compared, there was no recording; steps 0 to 12 with states]");
    assert_int_equal(blessings(A, &last, because), 0); /* the new recording is unchanged */
    OK(rheo_verify(C, &v, &error));
    assert_true(v.verdict == RHEO_SAME && v.steps == 12);
    assert_int_equal(diff(A, C).verdict, RHEO_SAME);

    /* There is nothing to bless. */
    OK(rheo_bless(C, A, "again", false, &v, &error));
    assert_int_equal(v.verdict, RHEO_SAME);
    assert_int_equal(blessings(C, &last, because), 1);

    record(B, (run_options){12, 4, "fluid.stiffness", "310", true, false, 0});
    OK(rheo_bless(C, B, "a stiffer fluid", false, &v, &error));
    assert_true(v.verdict == RHEO_DIFFERS && v.first.step == 5);
    assert_string_equal(v.first.stage, "forces@1");
    assert_int_equal(blessings(C, &last, because), 2);
    assert_string_equal(because,
                        "a stiffer fluid [compared, differs at step 5: position after stage forces@1; steps 0 to "
                        "12 with states, before 0 to 12 with states]");
    assert_int_equal(diff(B, C).verdict, RHEO_SAME);

    /* A reason has from 1 to 4096 bytes. */
    char reason[4098] = "";
    memset(reason, 'r', 4097);
    REFUSED(RHEO_ERROR_ARGUMENT, "1 to 4096 bytes", rheo_bless(C, A, reason, false, &v, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "1 to 4096 bytes", rheo_bless(C, A, " \t\n", false, &v, &error));
    assert_int_equal(blessings(C, &last, because), 2);
    reason[4096] = 0;
    OK(rheo_bless(C, A, reason, false, &v, &error));
    OK(rheo_bless(C, B, "r", false, &v, &error));

    /* No other command replaces a golden recording, even with --force. */
    rheo_world *world = lively_world();
    rheo_recorder *recorder;
    REFUSED(RHEO_ERROR_ARGUMENT, "blessed",
            rheo_recorder_open(world, C, &(rheo_record_options){.force = true}, &recorder, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "blessed", rheo_world_save(world, "", C, true, &error));
    assert_int_equal(blessings(C, &last, because), 4);
    rheo_world_destroy(world);
}

/* Otherwise a golden recording could come to guard nothing without a word. */
static void a_golden_recording_shrinks_only_when_told_to(void **unused)
{
    (void)unused;
    static const struct {
        run_options golden, smaller;
        const char *message;
    } CASES[] = {
        {{.steps = 12}, {.steps = 1}, "it has steps 0 to 12, the new one 0 to 1"},
        {{.steps = 12, .full = true}, {.steps = 12}, "it has the state of every step"},
    };
    rheo_verification v;
    rheo_blessing last;
    char because[256];
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        remove(C);
        record(A, CASES[i].golden);
        record(B, CASES[i].smaller);
        OK(rheo_bless(C, A, "whole", false, &v, &error));
        REFUSED(RHEO_ERROR_ARGUMENT, CASES[i].message, rheo_bless(C, B, "oops", false, &v, &error));
        assert_true(v.lengths_differ == (i == 0));
        assert_int_equal(blessings(C, &last, because), 1);
        OK(rheo_bless(C, B, "smaller", true, &v, &error));
        assert_int_equal(blessings(C, &last, because), 2);
        assert_non_null(
            strstr(because, i ? "compared, 12 steps are the same; steps 0 to 12, before 0 to 12 with states"
                              : "compared, 1 step is the same; steps 0 to 1, before 0 to 12"));
        OK(rheo_bless(C, A, "whole again", false, &v, &error));
    }
    /* A world with fewer fields. */
    rheo_scene scene = lively_scene();
    rheo_world *world;
    scene.world.history.stiffness = 0;
    OK(rheo_scene_create_world(&scene, &world, &error));
    OK(rheo_world_save(world, "bare", B, true, &error));
    rheo_world_destroy(world);
    world = lively_world();
    remove(C);
    OK(rheo_world_save(world, "", A, true, &error));
    rheo_world_destroy(world);
    OK(rheo_bless(C, A, "whole", false, &v, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "its worlds have", rheo_bless(C, B, "bare", false, &v, &error));
}

static void blessing_keeps_modes_and_links(void **unused)
{
    (void)unused;
    static const char *const LINK = "test_diff_link.rlog";
    rheo_verification v;
    struct stat status;
    remove(C);
    remove(LINK);
    record(A, (run_options){.steps = 2});
    record(B, (run_options){.steps = 3});
    OK(rheo_bless(C, A, "the first", false, &v, &error));
    assert_int_equal(chmod(C, 0444), 0);
    assert_int_equal(symlink(C, LINK), 0);
    OK(rheo_bless(LINK, B, "longer", false, &v, &error));
    assert_int_equal(lstat(LINK, &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    assert_int_equal(stat(C, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0444);
    OK(rheo_verify(C, &v, &error));
    assert_int_equal(v.steps, 3);
    remove(C);
    REFUSED(RHEO_ERROR_ARGUMENT, "leads to no file", rheo_bless(LINK, B, "nowhere", false, &v, &error));
    remove(LINK);
}

static void recordings_that_do_not_replay_are_not_blessed(void **unused)
{
    (void)unused;
    rheo_verification v;
    rheo_blessing last;
    char because[256];
    remove(C); /* no command may replace a blessed recording */
    record(C, (run_options){.steps = 6});
    REFUSED(RHEO_ERROR_ARGUMENT, "reason", rheo_bless(C, C, " \n", false, &v, &error));
    OK(rheo_bless(C, C, "in its own place", false, &v, &error));
    assert_int_equal(blessings(C, &last, because), 1);
    /* The state changes without a command. */
    rheo_world *world = lively_world();
    rheo_recorder *recorder;
    OK(rheo_recorder_open(world, A, &(rheo_record_options){.force = true}, &recorder, &error));
    OK(rheo_world_set(world, "fluid.stiffness", "301", &error));
    rheo__world_forget_commands(world);
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    REFUSED(RHEO_ERROR_DIFFERS, "does not verify", rheo_bless(C, A, "why not", false, &v, &error));
    struct stat status;
    assert_int_equal(stat(A, &status), 0);
    assert_int_equal(truncate(A, status.st_size - 9), 0);
    REFUSED(RHEO_ERROR_FORMAT, "does not verify", rheo_bless(C, A, "why not", false, &v, &error));
    assert_int_equal(blessings(C, &last, because), 1);
    rheo_world_destroy(world);
    /* What is no recording is not replaced; a recording that cannot be read only if that is meant. */
    write_file(B, "no recording", 12);
    for (int shrink = 0; shrink < 2; shrink++)
        REFUSED(RHEO_ERROR_ARGUMENT, "is not a recording", rheo_bless(B, C, "repaired", shrink, &v, &error));
    write_file(B, "\x89RLOG\r\n\x1A", 8);
    REFUSED(RHEO_ERROR_ARGUMENT, "cannot be replaced unread", rheo_bless(B, C, "repaired", false, &v, &error));
    OK(rheo_bless(B, C, "repaired", true, &v, &error));
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_int_equal(blessings(B, &last, because), 2);
    remove(B);
}

/* The new recording may have been blessed at another place, or be a copy of the old one. */
static void blessings_of_the_new_recording_are_kept(void **unused)
{
    (void)unused;
    rheo_verification v;
    rheo_blessing last;
    char because[256];
    remove(B);
    remove(C);
    record(A, (run_options){.steps = 6});
    OK(rheo_bless(B, A, "elsewhere", false, &v, &error));
    record(A, (run_options){.steps = 4});
    OK(rheo_bless(C, A, "the old one", false, &v, &error));
    OK(rheo_bless(C, B, "longer", false, &v, &error));
    assert_int_equal(blessings(C, &last, because), 3);
    assert_int_equal(strncmp(because, "longer [", 8), 0);
    rheo_recording *r;
    OK(rheo_recording_open(C, &r, &error));
    OK(rheo_recording_blessing(r, 0, &last));
    assert_int_equal(strncmp(last.because, "the old one [", 13), 0);
    OK(rheo_recording_blessing(r, 1, &last));
    assert_int_equal(strncmp(last.because, "elsewhere [", 11), 0);
    rheo_recording_close(r);
    /* Those that both have are there once. */
    remove(A);
    rename(C, A);
    record(C, (run_options){.steps = 4});
    OK(rheo_bless(C, A, "again", false, &v, &error));
    assert_int_equal(blessings(C, &last, because), 4);
    OK(rheo_bless(B, B, "nothing new", false, &v, &error));
    assert_int_equal(blessings(B, &last, because), 1);
}

static int remove_files(void **unused)
{
    (void)unused;
    remove(A);
    remove(B);
    remove(C);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_runs_are_the_same),
        cmocka_unit_test(a_shorter_recording_is_not_the_same),
        cmocka_unit_test(a_check_demands_the_same_and_enough_steps),
        cmocka_unit_test(other_commands_in_the_same_step_differ),
        cmocka_unit_test(a_changed_constant_is_named_with_values),
        cmocka_unit_test(values_come_from_the_first_stored_states_that_differ),
        cmocka_unit_test(a_difference_names_the_builds),
        cmocka_unit_test(sizes_say_what_ulps_cannot),
        cmocka_unit_test(an_item_of_one_side_is_said_to_be_there_only),
        cmocka_unit_test(parameters_of_settling_are_the_cause),
        cmocka_unit_test(a_cause_is_looked_for_in_the_first_steps),
        cmocka_unit_test(recordings_of_other_builds_need_stored_states),
        cmocka_unit_test(recordings_are_compared_over_common_steps),
        cmocka_unit_test(files_that_cannot_be_compared_are_reported),
        cmocka_unit_test(nothing_compared_is_never_the_same),
        cmocka_unit_test(a_failure_on_one_side_differs),
        cmocka_unit_test(golden_recordings_change_only_by_blessing),
        cmocka_unit_test(a_golden_recording_shrinks_only_when_told_to),
        cmocka_unit_test(blessing_keeps_modes_and_links),
        cmocka_unit_test(recordings_that_do_not_replay_are_not_blessed),
        cmocka_unit_test(blessings_of_the_new_recording_are_kept),
    };
    setlocale(LC_ALL, "de_DE.UTF-8"); /* where there is one: messages have a point all the same */
    return cmocka_run_group_tests_name("diff", tests, NULL, remove_files);
}
