/*
 * Recordings: a saved state is restored to the bit at every step, a recording replays, and a difference is reported.
 */
#define _POSIX_C_SOURCE 200809L
#define _XOPEN_SOURCE 700 /* SIGXFSZ */
#define PATH "test_record.rlog"
#include "record_support.h"

#include <math.h>
#include <signal.h>
#include <sys/resource.h>

#include "record/recorder.h"

/* ---- Checkpoints ---- */

static void check_saving(void)
{
    rheo_world *world = make_world(5);
    bool made = false, broken = false;
    for (uint64_t step = 0; step < 24; step++) {
        /* Checkpoints surround the commands. A loaded world must save the same bytes and continue alike. */
        for (int commanded = 0; commanded < 2; commanded++) {
            void *first, *second;
            size_t first_size, second_size;
            if (commanded)
                command(world, step);
            save(world, &first, &first_size);
            rheo_world *copy = load(first, first_size, step);
            save(copy, &second, &second_size);
            assert_int_equal(first_size, second_size);
            assert_memory_equal(first, second, first_size);
            assert_true(rheo_world_hash(copy) == rheo_world_hash(world));
            for (uint32_t i = 0; i < rheo_world_metric_count(world); i++)
                assert_true(rheo_world_metric(copy, i) == rheo_world_metric(world, i));
            if (commanded) {
                size_t springs = rheo_world_spring_count(world);
                for (int ahead = 0; ahead < 3; ahead++) {
                    if (ahead == 0)
                        OK(rheo_world_step(world, &error));
                    OK(rheo_world_step(copy, &error));
                    if (ahead == 0)
                        assert_true(rheo_world_hash(copy) == rheo_world_hash(world));
                }
                made = made || rheo_world_spring_count(world) > springs;
                broken = broken || rheo_world_spring_count(world) < springs;
            }
            rheo_world_destroy(copy);
            free(first);
            free(second);
        }
    }
    assert_true(made && broken);
    assert_int_equal(rheo_world_history_rows(world), kind <= RHEO_HISTORY_WINDOW_FAST ? 8 : 1);
    rheo_world_destroy(world);
}

static void a_saved_state_is_restored(void **state)
{
    (void)state;
    for (; kind <= RHEO_HISTORY_TEMPERED; kind++)
        check_saving();
    kind = RHEO_HISTORY_WINDOW;
}

static void worlds_without_some_features_are_restored(void **state)
{
    (void)state;
    static const char *const NOTHING[][4] = {
        {"springs.stiffness"},
        {"history.stiffness"},
        {"fluid.linear_viscosity", "fluid.quadratic_viscosity"},
        {"fluid.stiffness", "fluid.near_stiffness"},
        {"ball.radius"},
        {"walls.sticking"},
        {"springs.stiffness", "fluid.stiffness", "fluid.near_stiffness", "ball.radius"},
    };
    for (size_t n = 0; n < sizeof NOTHING / sizeof *NOTHING; n++) {
        rheo_real position[3 * MOST];
        rheo_world_def def = scene_def(3, position);
        rheo_world *world;
        for (size_t k = 0; k < 4 && NOTHING[n][k]; k++)
            OK(rheo_world_def_set(&def, NOTHING[n][k], "0", &error));
        def.particles.count = n == 6 ? 0 : def.particles.count;
        def.history.window_seconds = 0.1;
        OK(rheo_world_create(&def, &world, &error));
        OK(rheo_world_step(world, &error));
        if (n == 1 || n == 2) /* a world keeps the features it was made with */
            OK(rheo_world_set(world, "springs.stiffness", "0", &error));
        if (n == 2)
            OK(rheo_world_set(world, "walls.sticking", "0", &error));
        void *first, *second;
        size_t first_size, second_size;
        save(world, &first, &first_size);
        rheo_world *copy = load(first, first_size, 1);
        save(copy, &second, &second_size);
        assert_int_equal(first_size, second_size);
        assert_memory_equal(first, second, first_size);
        OK(rheo_world_step(world, &error));
        OK(rheo_world_step(copy, &error));
        assert_true(rheo_world_hash(copy) == rheo_world_hash(world));
        rheo_world_destroy(copy);
        rheo_world_destroy(world);
        free(first);
        free(second);
    }
}

static void a_file_is_replaced_only_with_force(void **state)
{
    (void)state;
    rheo_world *world = make_world(2);
    rheo_recorder *recorder;
    rheo_recording *r;
    remove(PATH);
    OK(rheo_world_save(world, "a", PATH, false, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, PATH " exists; give --force", rheo_world_save(world, "b", PATH, false, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, PATH " exists; give --force",
            rheo_recorder_open(world, PATH, NULL, &recorder, &error));
    assert_null(recorder);
    OK(rheo_recording_open(PATH, &r, &error));
    assert_string_equal(rheo_recording_get_info(r).scene, "a");
    assert_string_equal(rheo_recording_get_info(r).build, rheo_build());
    rheo_recording_close(r);
    OK(rheo_world_save(world, "b", PATH, true, &error));
    OK(rheo_recording_open(PATH, &r, &error));
    assert_string_equal(rheo_recording_get_info(r).scene, "b");
    rheo_recording_close(r);
    char beside[64];
    snprintf(beside, sizeof beside, "%s.tmp-0", PATH);
    assert_null(fopen(beside, "rb"));
    remove(PATH);
    assert_int_equal(rheo_world_save(world, "c", "no/such/folder/c.rlog", false, &why), RHEO_ERROR_FILE);
    assert_int_equal(rheo_recording_open("no such file", &r, &why), RHEO_ERROR_FILE);
    assert_null(r);
    rheo_world_destroy(world);
}

static void a_full_disk_is_an_error(void **state)
{
    (void)state;
    FILE *full = fopen("/dev/full", "wb");
    if (!full)
        skip();
    fclose(full);
    rheo_world *world = make_world(2);
    rheo_recorder *recorder;
    rheo_record_options options = {.force = true};
    assert_int_equal(rheo_recorder_open(world, "/dev/full", &options, &recorder, &why), RHEO_ERROR_FILE);
    assert_null(recorder);
    assert_true(rheo_world_step_count(world) == 0);
    rheo_world_destroy(world);
}

/* A limit on file size replaces a disk that fills up during a run. */
static void a_disk_that_fills_up_leaves_a_readable_file(void **state)
{
    (void)state;
    rheo_world *world = make_world(3);
    rheo_recorder *recorder;
    rheo_record_options options = {.force = true, .full = true};
    struct rlimit old, small;
    getrlimit(RLIMIT_FSIZE, &old);
    small = old;
    small.rlim_cur = 20000;
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &small);
    rheo_result opened = rheo_recorder_open(world, PATH, &options, &recorder, &why), result = RHEO_OK;
    uint64_t steps = 0;
    while (opened == RHEO_OK && steps < 100 && (result = rheo_recorder_step(recorder, &why)) == RHEO_OK)
        steps++;
    rheo_result again = opened == RHEO_OK ? rheo_recorder_step(recorder, NULL) : RHEO_OK;
    rheo_result closed = opened == RHEO_OK ? rheo_recorder_close(recorder, NULL) : RHEO_OK;
    setrlimit(RLIMIT_FSIZE, &old);
    signal(SIGXFSZ, handler);
    assert_int_equal(opened, RHEO_OK);
    assert_int_equal(result, RHEO_ERROR_FILE);
    assert_non_null(strstr(why.message, "cannot write"));
    assert_int_equal(again, RHEO_ERROR_FILE);
    assert_int_equal(closed, RHEO_ERROR_FILE);
    rheo_verification v;
    OK(rheo_verify(PATH, &v, &error));
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "truncated"));
    assert_int_equal(v.steps, steps);
    remove(PATH);
    rheo_world_destroy(world);
}

/* ---- Recording, verifying, seeking ---- */

static void check_replaying(void)
{
    enum { STEPS = 23 };
    for (int full = 0; full < 2; full++) {
        uint64_t hashes[STEPS + 1];
        size_t size, again_size;
        uint8_t *bytes = record(4, STEPS, 5, full, hashes, &size);
        uint8_t *again = record(4, STEPS, 5, full, NULL, &again_size);
        assert_int_equal(size, again_size);
        assert_memory_equal(bytes, again, size);
        free(again);

        rheo_verification v;
        OK(rheo_verify_memory(bytes, size, &v, &error));
        if (v.verdict != RHEO_SAME)
            fail_msg("%s", v.message);
        assert_int_equal(v.steps, STEPS);

        rheo_recording *r;
        OK(rheo_recording_open_memory(bytes, size, &r, &error));
        rheo_recording_info info = rheo_recording_get_info(r);
        assert_true(info.complete && info.full == full && info.format == 5 && info.real_bytes == sizeof(rheo_real));
        assert_int_equal(info.first_step, 0);
        assert_int_equal(info.last_step, STEPS);
        assert_int_equal(info.particles, 64);
        assert_int_equal(info.keyframes, 5);
        assert_int_equal(info.keyframe_spacing, 5);
        assert_int_equal(info.bytes, size);
        assert_int_equal(rheo_recording_keyframe_step(r, 4), 20);
        assert_true(rheo_recording_definition(r)->ball.radius == 2);
        assert_true(rheo_recording_definition(r)->walls.plane[2].normal[1] == 0.1);
        assert_string_equal(rheo_recording_metric_name(r, 0), "step");
        for (uint32_t i = 0; i < rheo_recording_metric_count(r); i++)
            assert_int_equal(rheo_recording_metric_by_name(r, rheo_recording_metric_name(r, i)), i);
        assert_int_equal(rheo_recording_metric_by_name(r, "none"), rheo_recording_metric_count(r));
        rheo_world *world;
        for (uint64_t step = 0; step <= STEPS; step++) {
            double metrics[64];
            OK(rheo_recording_world(r, step, NULL, &world, &error));
            assert_true(rheo_world_hash(world) == hashes[step]);
            OK(rheo_recording_metrics(r, step, metrics, &error));
            for (uint32_t i = 0; i < rheo_recording_metric_count(r); i++)
                assert_true(metrics[i] == rheo_world_metric(world, i));
            rheo_world_destroy(world);
        }
        assert_int_equal(rheo_recording_world(r, STEPS + 1, NULL, &world, &why), RHEO_ERROR_ARGUMENT);
        assert_null(world);
        rheo_recording_close(r);
        free(bytes);
    }
}

static void a_recording_replays(void **state)
{
    (void)state;
    for (; kind <= RHEO_HISTORY_TEMPERED; kind++)
        check_replaying();
    kind = RHEO_HISTORY_WINDOW;
}

static void a_recording_can_begin_in_the_middle(void **state)
{
    (void)state;
    rheo_world *world = make_world(3);
    rheo_recorder *recorder;
    rheo_verification v;
    const double push[3] = {0, 5, 0};
    for (uint64_t step = 0; step < 4; step++)
        OK(rheo_world_step(world, &error));
    /* Commands given earlier than the recording are part of its first keyframe, and are not repeated. */
    OK(rheo_world_push_body(world, 0, push, NULL, &error));
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true}, &recorder, &error));
    OK(rheo_world_push_body(world, 0, push, NULL, &error));
    for (uint64_t step = 0; step < 4; step++)
        OK(rheo_recorder_step(recorder, &error));
    /* The command is not recorded, so the end mark has no hash. */
    OK(rheo_world_push_body(world, 0, push, NULL, &error));
    OK(rheo_recorder_close(recorder, &error));
    OK(rheo_verify(PATH, &v, &error));
    assert_int_equal(v.verdict, RHEO_SAME);
    assert_int_equal(v.steps, 4);
    remove(PATH);
    rheo_world_destroy(world);
}

static void many_particles_are_added_in_portions(void **state)
{
    (void)state;
    enum { MANY = 100000 };
    rheo_real position[3] = {0}, *more = calloc(3 * MANY, sizeof *more);
    rheo_world_def def = rheo_default_world_def();
    def.gravity[1] = 0;
    def.particles.count = 1;
    def.particles.position = position;
    def.history.window = 1;
    for (size_t i = 0; i < MANY; i++)
        more[3 * i] = (rheo_real)(10 * i + 10);
    rheo_world *world;
    rheo_recorder *recorder;
    rheo_verification v;
    OK(rheo_world_create(&def, &world, &error));
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true, .full = true}, &recorder, &error));
    OK(rheo_world_add_particles(world, MANY, more, NULL, &error));
    for (int i = 0; i < 3; i++)
        OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    OK(rheo_verify(PATH, &v, &error));
    assert_int_equal(v.verdict, RHEO_SAME);
    void *bytes;
    size_t size;
    save(world, &bytes, &size); /* pieces are cut within rows */
    rheo_world *copy = load(bytes, size, 3);
    assert_true(rheo_world_hash(copy) == rheo_world_hash(world));
    free(bytes);
    free(more);
    rheo_world_destroy(copy);
    rheo_world_destroy(world);
    remove(PATH);
}

static void only_its_recorder_steps_a_world(void **state)
{
    (void)state;
    rheo_world *world = make_world(2);
    rheo_recorder *recorder;
    rheo_verification v;
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true}, &recorder, &error));
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_world_step(world, &error));
    assert_int_equal(rheo_recorder_step(recorder, &why), RHEO_ERROR_ARGUMENT);
    OK(rheo_recorder_close(recorder, &error));
    OK(rheo_verify(PATH, &v, &error));
    assert_int_equal(v.verdict, RHEO_SAME);
    assert_int_equal(v.steps, 1);
    remove(PATH);
    rheo_world_destroy(world);
}

static void a_failed_step_is_not_recorded(void **state)
{
    (void)state;
    scheme = RHEO_SCHEME_SEQUENTIAL;
    rheo_world *world = make_world(3);
    scheme = RHEO_SCHEME_SUMMED;
    rheo_recorder *recorder;
    rheo_verification v;
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true, .full = true}, &recorder, &error));
    OK(rheo_recorder_step(recorder, &error));
    char stiffness[96];
    OK(rheo_world_def_get(rheo_world_definition(world), "springs.stiffness", stiffness, sizeof stiffness));
    /* Each spring of a row multiplies the displacement of the previous one. */
    OK(rheo_world_set(world, "springs.stiffness", "1e30", &error));
    assert_int_equal(rheo_recorder_step(recorder, &why), RHEO_ERROR_STATE);
    OK(rheo_world_set(world, "springs.stiffness", stiffness, &error));
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    OK(rheo_verify(PATH, &v, &error));
    if (v.verdict != RHEO_SAME)
        fail_msg("%s", v.message);
    assert_int_equal(v.steps, 2);
    remove(PATH);
    rheo_world_destroy(world);
}

/* ---- Differences ---- */

/* Verifies with a world of the scene that `change` has changed. */
static rheo_verification verify_changed(const uint8_t *bytes, size_t size, const char *path, const char *value,
                                        void (*change)(rheo_world *))
{
    rheo_recording *r;
    rheo_verification v;
    rheo_world *world = make_world(4);
    if (path) {
        OK(rheo_world_set(world, path, value, &error));
        rheo__world_forget_commands(world);
    }
    if (change)
        change(world);
    OK(rheo_recording_open_memory(bytes, size, &r, &error));
    OK(rheo__verify_world(r, world, &v, &error));
    rheo_recording_close(r);
    rheo_world_destroy(world);
    return v;
}

static void nudge(rheo_world *world)
{
    uint32_t bits;
    memcpy(&bits, &world->state.position[3 * 17 + 1], sizeof bits);
    bits ^= 1;
    memcpy(&world->state.position[3 * 17 + 1], &bits, sizeof bits);
}

static void a_difference_is_named(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = record(4, 12, 5, false, NULL, &size);
    rheo_verification v = verify_changed(bytes, size, "fluid.quadratic_viscosity", "0.11", NULL);
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_string_equal(v.first.stage, "viscosity");
    assert_string_equal(v.first.field, "velocity");
    assert_int_equal(v.first.origin, RHEO_VALUES_STORED); /* of the next keyframe */
    assert_int_equal(v.first.value_step, 5);
    assert_non_null(strstr(v.message, "its values are not stored"));
    assert_int_equal(v.first.step, v.steps + 1);
    uint64_t step = v.first.step;
    v = verify_changed(bytes, size, NULL, NULL, nudge);
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_string_equal(v.first.stage, "");
    assert_string_equal(v.first.field, "position");
    assert_true(v.first.step == 0 && v.steps == 0);
    free(bytes);

    bytes = record(4, 12, 5, true, NULL, &size);
    v = verify_changed(bytes, size, NULL, NULL, NULL);
    if (v.verdict != RHEO_SAME)
        fail_msg("%s", v.message);
    v = verify_changed(bytes, size, "fluid.quadratic_viscosity", "0.11", NULL);
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_true(v.first.step == step && v.first.origin);
    assert_string_equal(v.first.stage, "viscosity");
    assert_string_equal(v.first.field, "velocity");
    assert_true(v.first.count > 0 && v.first.ulps > 0 && v.first.expected != v.first.actual);
    /* The first differing particle, from two runs side by side. */
    rheo_world *a = make_world(4), *b = make_world(4);
    OK(rheo_world_set(b, "fluid.quadratic_viscosity", "0.11", &error));
    for (uint64_t n = 0; n < step; n++) {
        command(a, n);
        command(b, n);
        OK(rheo_world_step(a, &error));
        OK(rheo_world_step(b, &error));
    }
    const rheo_real *x = rheo_world_velocities(a), *y = rheo_world_velocities(b);
    uint64_t first = 0;
    while (x[first] == y[first])
        first++;
    assert_int_equal(v.first.id, first / 3);
    x += 3 * v.first.id;
    y += 3 * v.first.id;
    uint32_t most = 0; /* the component that differs most */
    for (uint32_t axis = 1; axis < 3; axis++)
        if (fabs((double)x[axis] - (double)y[axis]) > fabs((double)x[most] - (double)y[most]))
            most = axis;
    assert_int_equal(v.first.component, most);
    assert_true(v.first.expected == (double)x[most] && v.first.actual == (double)y[most]);
    rheo_world_destroy(a);
    rheo_world_destroy(b);

    v = verify_changed(bytes, size, "springs.rest_length", "support", NULL);
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_string_equal(v.first.stage, "densities@1"); /* where pairs get springs */
    assert_string_equal(v.first.field, "spring_rest_length");
    assert_true(v.first.origin && v.first.id < v.first.other_id);
    v = verify_changed(bytes, size, "history.stiffness", "150.001", NULL);
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_string_equal(v.first.stage, "forces@1");
    v = verify_changed(bytes, size, "gravity", "[0, -1e30, 0]", NULL);
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_int_equal(v.first.step, 1);
    assert_string_equal(v.first.stage, "neighbours"); /* margins depend on gravity */
    assert_string_equal(v.first.field, "list_margin");
    free(bytes);
}

static void another_list_of_stages_is_unreadable(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = record(2, 2, 0, false, NULL, &size);
    rheo_recording *r;
    rheo_verification v;
    rheo_real position[3 * MOST];
    rheo_world_def def = scene_def(2, position);
    rheo_world *world;
    def.ball.radius = 0;
    OK(rheo_world_create(&def, &world, &error));
    OK(rheo_recording_open_memory(bytes, size, &r, &error));
    OK(rheo__verify_world(r, world, &v, &error));
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "other stages"));
    rheo_recording_close(r);
    rheo_world_destroy(world);
    free(bytes);
}

/* Not that the system failed: no file is concerned. */
static void a_recording_in_memory_without_memory_says_so(void **state)
{
    (void)state;
    rheo_world *world = make_world(2);
    rheo_recorder *recorder;
    OK(rheo_recorder_open_memory(world, NULL, &recorder, &error));
    OK(rheo_recorder_step(recorder, &error));
    recorder->memory.failed = true; /* as if realloc() had failed */
    assert_int_equal(rheo_recorder_step(recorder, &why), RHEO_ERROR_MEMORY);
    assert_int_equal(rheo_recorder_step(recorder, &why), RHEO_ERROR_MEMORY);
    assert_non_null(strstr(why.message, "the recording ended at step 2"));
    void *bytes;
    size_t size;
    assert_int_equal(rheo_recorder_close_memory(recorder, &bytes, &size, &why), RHEO_ERROR_MEMORY);
    assert_non_null(strstr(why.message, "is not complete"));
    assert_true(bytes == NULL && size == 0);
    rheo_world_destroy(world);
}

/* A copy is what closing hands over at that moment; the recorder goes on as if there were none. */
static void a_recording_in_memory_can_be_copied(void **state)
{
    (void)state;
    for (int failing = 0; failing < 2; failing++) {
        void *bytes[4];
        size_t size[4];
        for (int copies = 0; copies < 2; copies++) {
            scheme = RHEO_SCHEME_SEQUENTIAL;
            rheo_world *world = make_world(3);
            scheme = RHEO_SCHEME_SUMMED;
            rheo_recorder *recorder = NULL;
            const rheo_record_options options = {.keyframe_spacing = 3};
            OK(rheo_recorder_open_memory(world, &options, &recorder, &error));
            for (int step = 0; step < 5; step++) {
                OK(rheo_recorder_step(recorder, &error));
                if (copies && step < 4) {
                    OK(rheo_recorder_copy_memory(recorder, &bytes[2], &size[2], &error));
                    free(bytes[2]);
                }
            }
            if (failing) {
                OK(rheo_world_set(world, "springs.stiffness", "1e30", &error));
                assert_int_equal(rheo_recorder_step(recorder, &why), RHEO_ERROR_STATE);
            }
            for (int i = 2; copies && i < 4; i++)
                OK(rheo_recorder_copy_memory(recorder, &bytes[i], &size[i], &error));
            OK(rheo_recorder_close_memory(recorder, &bytes[copies], &size[copies], &error));
            rheo_world_destroy(world);
        }
        for (int i = 3; i >= 0; i--) {
            assert_int_equal(size[i], size[0]);
            assert_memory_equal(bytes[i], bytes[0], size[0]);
            free(bytes[i]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_saved_state_is_restored),
        cmocka_unit_test(worlds_without_some_features_are_restored),
        cmocka_unit_test(a_file_is_replaced_only_with_force),
        cmocka_unit_test(a_full_disk_is_an_error),
        cmocka_unit_test(a_disk_that_fills_up_leaves_a_readable_file),
        cmocka_unit_test(a_recording_replays),
        cmocka_unit_test(a_recording_can_begin_in_the_middle),
        cmocka_unit_test(many_particles_are_added_in_portions),
        cmocka_unit_test(only_its_recorder_steps_a_world),
        cmocka_unit_test(a_failed_step_is_not_recorded),
        cmocka_unit_test(a_difference_is_named),
        cmocka_unit_test(another_list_of_stages_is_unreadable),
        cmocka_unit_test(a_recording_in_memory_without_memory_says_so),
        cmocka_unit_test(a_recording_in_memory_can_be_copied),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
