/*
 * Recordings: what is saved comes back to the bit, at every step; what was recorded replays; what differs is
 * named; what is truncated or damaged in any byte is found, and never crashes.
 */
#define _POSIX_C_SOURCE 200809L
#define _XOPEN_SOURCE 700 /* SIGXFSZ */

#include <locale.h>
#include <signal.h>
#include <sys/resource.h>
#include <zlib.h>

#include "core/hash.h"
#include "record/recording.h"
#include "support.h"

static rheo_error why; /* of calls that may be refused */

/* ---- A small scene with everything in it ---- */

enum { MOST = 1000 };

static rheo_world_def scene_def(uint32_t side, rheo_real *position)
{
    rheo_world_def def = rheo_default_world_def();
    def.step = 0.02;
    def.history.window = 7;
    def.walls.count = 3;
    def.walls.plane[0] = (rheo_wall){{0, 0, 0}, {0, 1, 0}};
    def.walls.plane[1] = (rheo_wall){{-1, 0, 0}, {1, 0, 0}};
    def.walls.plane[2] = (rheo_wall){{0, 0, -1}, {0, 0.1, 1}};
    def.ball.radius = 2;
    def.ball.position[0] = def.ball.position[2] = 3;
    def.ball.position[1] = 2.0 * side + 3;
    def.ball.velocity[1] = -20;
    def.ball.spin[2] = 1;
    def.vibrators.count = 2;
    def.vibrators.position[0][0] = 1;
    def.vibrators.position[1][1] = 4;
    def.vibrators.amplitude = 0.8;
    uint32_t count = 0;
    for (uint32_t x = 0; x < side; x++)
        for (uint32_t y = 0; y < side; y++)
            for (uint32_t z = 0; z < side; z++, count++) {
                position[3 * count] = (rheo_real)(2 * x) + (rheo_real)0.125 * (rheo_real)(y % 3);
                position[3 * count + 1] = (rheo_real)(2 * y + 1) + (rheo_real)0.0625 * (rheo_real)(x % 2);
                position[3 * count + 2] = (rheo_real)(2 * z) + (rheo_real)0.25 * (rheo_real)(x % 2);
            }
    def.particles.count = count;
    def.particles.position = position;
    return def;
}

/* Of the worlds that make_world() makes. */
static rheo_history_kind kind = RHEO_HISTORY_WINDOW;

static rheo_world *make_world(uint32_t side)
{
    rheo_real position[3 * MOST];
    rheo_world_def def = scene_def(side, position);
    def.history.kind = kind;
    rheo_world *world;
    OK(rheo_world_create(&def, &world, &error));
    return world;
}

/* Every kind of command, before the steps that it names. */
static void command(rheo_world *world, uint64_t step)
{
    const double impulse[3] = {3, 1, -2}, point[3] = {3, 6, 4};
    const rheo_real position[6] = {0, 20, 0, 1, 23, 1}, velocity[6] = {0, -9, 0, 1, -8, 0};
    if (step == 2)
        OK(rheo_world_push_body(world, 0, impulse, NULL, &error));
    if (step == 3) {
        OK(rheo_world_push_body(world, 0, impulse, point, &error));
        OK(rheo_world_set(world, "fluid.linear_viscosity", "0.7", &error));
    }
    if (step == 4)
        OK(rheo_world_add_particles(world, 2, position, velocity, &error));
    if (step == 5) {
        OK(rheo_world_move_vibrator(world, 1, 0.5, 1.5, &error));
        OK(rheo_world_set(world, "ball.spin", "[1, 2, 3]", &error));
        OK(rheo_world_set(world, "step", "0.019", &error));
    }
    if (step == 6) /* what the world was made with can be set to nothing, and must come back all the same */
        OK(rheo_world_set(world, "history.stiffness", "0", &error));
    if (step == 8) {
        OK(rheo_world_set(world, "history.stiffness", "200", &error));
        OK(rheo_world_set(world, "springs.stiffness", "0", &error));
        OK(rheo_world_set(world, "walls.sticking", "0", &error));
    }
    if (step == 10)
        OK(rheo_world_set(world, "springs.stiffness", "15", &error));
}

static void save(const rheo_world *world, void **bytes, size_t *size)
{
    OK(rheo_world_save_memory(world, "test", bytes, size, &error));
}

static rheo_world *load(const void *bytes, size_t size, uint64_t step)
{
    rheo_recording *r;
    rheo_world *world;
    OK(rheo_recording_open_memory(bytes, size, &r, &error));
    OK(rheo_recording_world(r, step, NULL, &world, &error));
    rheo_recording_close(r);
    return world;
}

/* ---- Files ---- */

static const char *const PATH = "test_record.rlog";

static uint8_t *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    uint8_t *bytes = malloc(*size + 1);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

/* Records a run of the small scene; hashes (steps + 1 of them) may be NULL. */
static uint8_t *record(uint32_t side, uint64_t steps, uint64_t spacing, bool full, uint64_t *hashes, size_t *size)
{
    rheo_world *world = make_world(side);
    rheo_recorder *recorder;
    rheo_record_options options = {.scene = "small", .keyframe_spacing = spacing, .full = full, .force = true};
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    for (uint64_t step = 0;; step++) {
        if (hashes)
            hashes[step] = rheo_world_hash(world);
        if (step == steps)
            break;
        command(world, step);
        OK(rheo_recorder_step(recorder, &error));
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    uint8_t *bytes = read_file(PATH, size);
    remove(PATH);
    return bytes;
}

/* ---- Checkpoints ---- */

static void check_saving(void)
{
    rheo_world *world = make_world(5);
    bool made = false, broken = false;
    for (uint64_t step = 0; step < 24; step++) {
        /* Before and after the commands; what is loaded must give the same bytes, and go on the same way. */
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

static void what_is_saved_comes_back(void **state)
{
    (void)state;
    for (; kind <= RHEO_HISTORY_TEMPERED; kind++)
        check_saving();
    kind = RHEO_HISTORY_WINDOW;
}

static void worlds_without_this_or_that_come_back(void **state)
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
        if (n == 1 || n == 2) /* a world keeps the parts it was made with */
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
    assert_int_equal(rheo_world_save(world, "b", PATH, false, &why), RHEO_ERROR_FILE);
    assert_non_null(strstr(why.message, "exists already"));
    assert_int_equal(rheo_recorder_open(world, PATH, NULL, &recorder, &why), RHEO_ERROR_FILE);
    assert_non_null(strstr(why.message, "exists already"));
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

/* A limit on the size of files stands in for a disk that fills up in the middle of a run. */
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
        assert_true(info.complete && info.full == full && info.format == 3 && info.real_bytes == sizeof(rheo_real));
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

static void what_was_recorded_replays(void **state)
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
    /* Given before the recording: in its first keyframe, and not to be given again. */
    OK(rheo_world_push_body(world, 0, push, NULL, &error));
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true}, &recorder, &error));
    OK(rheo_world_push_body(world, 0, push, NULL, &error));
    for (uint64_t step = 0; step < 4; step++)
        OK(rheo_recorder_step(recorder, &error));
    /* Not recorded: the end mark then has no hash. */
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
    save(world, &bytes, &size); /* pieces are cut inside of rows */
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
    rheo_world *world = make_world(3);
    rheo_recorder *recorder;
    rheo_verification v;
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true, .full = true}, &recorder, &error));
    OK(rheo_recorder_step(recorder, &error));
    char stiffness[96];
    OK(rheo_world_def_get(rheo_world_definition(world), "springs.stiffness", stiffness, sizeof stiffness));
    /* Each spring of a row multiplies the move of the one before. */
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

/* Verifies against a world of the scene that `change` has changed. */
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
    assert_false(v.first.origin);
    assert_non_null(strstr(v.message, "full"));
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
    /* The first particle that differs, as two runs side by side have it. */
    rheo_world *a = make_world(4), *b = make_world(4);
    OK(rheo_world_set(b, "fluid.quadratic_viscosity", "0.11", &error));
    for (uint64_t n = 0; n < step; n++) {
        command(a, n);
        command(b, n);
        OK(rheo_world_step(a, &error));
        OK(rheo_world_step(b, &error));
    }
    uint64_t first = 0;
    while (rheo_world_velocities(a)[first] == rheo_world_velocities(b)[first])
        first++;
    assert_int_equal(v.first.id, first / 3);
    assert_int_equal(v.first.component, first % 3);
    assert_true(v.first.expected == (double)rheo_world_velocities(a)[first]);
    assert_true(v.first.actual == (double)rheo_world_velocities(b)[first]);
    rheo_world_destroy(a);
    rheo_world_destroy(b);

    v = verify_changed(bytes, size, "springs.rest_length", "support", NULL);
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_string_equal(v.first.stage, "springs");
    assert_string_equal(v.first.field, "spring_rest_length");
    assert_true(v.first.origin && v.first.id < v.first.other_id);
    v = verify_changed(bytes, size, "history.stiffness", "150.001", NULL);
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_string_equal(v.first.stage, "spring_displacement");
    v = verify_changed(bytes, size, "gravity", "[0, -1e30, 0]", NULL);
    assert_int_equal(v.verdict, RHEO_DIFFERS);
    assert_int_equal(v.first.step, 1);
    assert_string_equal(v.first.stage, "gravity");
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

/* ---- Torn and damaged files ---- */

static void put(uint8_t *to, uint64_t value, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++)
        to[i] = (uint8_t)(value >> (8 * i));
}

static uint64_t get(const uint8_t *from, size_t bytes)
{
    uint64_t value = 0;
    for (size_t i = 0; i < bytes; i++)
        value |= (uint64_t)from[i] << (8 * i);
    return value;
}

static size_t chunk_size(const uint8_t *chunk)
{
    return 36 + (size_t)get(chunk + 16, 8);
}

/* Where the n-th chunk of a type is; `type` NULL: any. */
static size_t find(const uint8_t *bytes, size_t size, const char *type, int n)
{
    for (size_t at = 8; at < size; at += chunk_size(bytes + at))
        if ((!type || memcmp(bytes + at, type, 4) == 0) && n-- == 0)
            return at;
    fail();
    return 0;
}

static void seal(uint8_t *chunk)
{
    size_t size = chunk_size(chunk) - 4;
    put(chunk + size, crc32(0, chunk, (uInt)size), 4);
}

static rheo_verification verify_bytes(const uint8_t *bytes, size_t size)
{
    /* A copy of exact size, so that reading past the end is found. */
    uint8_t *exact = malloc(size ? size : 1);
    memcpy(exact, bytes, size);
    rheo_verification v;
    OK(rheo_verify_memory(exact, size, &v, &error));
    free(exact);
    return v;
}

static void a_torn_file_holds_up_to_the_tear(void **state)
{
    (void)state;
    enum { STEPS = 6 };
    for (int full = 0; full < 2; full++) {
        uint64_t hashes[STEPS + 1];
        size_t size, steps = 0;
        uint8_t *bytes = record(2, STEPS, 2, full, hashes, &size);
        assert_true(size <= 4096 * sizeof(rheo_real)); /* every length is tried */
        size_t first_keyframe = find(bytes, size, "KEYF", 0);
        first_keyframe += chunk_size(bytes + first_keyframe);
        size_t next = find(bytes, size, "STEP", 0);
        next += chunk_size(bytes + next);
        for (size_t cut = 0; cut < size; cut++) {
            if (cut == next && ++steps < STEPS) {
                next = find(bytes, size, "STEP", (int)steps);
                next += chunk_size(bytes + next);
            }
            rheo_verification v = verify_bytes(bytes, cut);
            assert_int_equal(v.verdict, RHEO_UNREADABLE);
            assert_int_equal(v.steps, steps);
            rheo_recording *r;
            rheo_result result = rheo_recording_open_memory(bytes, cut, &r, &why);
            assert_int_equal(result, cut < first_keyframe ? RHEO_ERROR_FORMAT : RHEO_OK);
            if (result != RHEO_OK)
                continue;
            assert_false(rheo_recording_get_info(r).complete);
            assert_int_equal(rheo_recording_get_info(r).last_step, steps);
            rheo_recording_close(r);
        }
        assert_int_equal(steps, STEPS);
        /* What is before the tear can be used. */
        rheo_recording *r;
        rheo_world *world;
        OK(rheo_recording_open_memory(bytes, size - 1, &r, &error));
        OK(rheo_recording_world(r, STEPS, NULL, &world, &error));
        assert_true(rheo_world_hash(world) == hashes[STEPS]);
        rheo_world_destroy(world);
        rheo_recording_close(r);
        free(bytes);
    }
}

/* A length that leads past the end was called a tear even where the end mark was there. */
static void a_wrong_length_is_damage_and_no_tear(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = record(2, 4, 100, false, NULL, &size);
    uint8_t *chunk = bytes + find(bytes, size, "STEP", 1);
    for (size_t at = 16; at <= 24; at += 8) /* stored, raw */
        put(chunk + at, get(chunk + at, 8) + (1 << 20), 8);
    rheo_recording *r;
    assert_int_equal(rheo_recording_open_memory(bytes, size, &r, &why), RHEO_ERROR_FORMAT);
    rheo_verification v = verify_bytes(bytes, size);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "damaged"));
    free(bytes);
}

/* Two recorders of one name wrote into each other's file. */
static void a_replaced_file_is_left_to_its_writer(void **state)
{
    (void)state;
    rheo_world *world[2] = {make_world(2), make_world(3)};
    rheo_recorder *recorder[2];
    rheo_verification v;
    for (int i = 0; i < 2; i++)
        OK(rheo_recorder_open(world[i], PATH, &(rheo_record_options){.force = true}, &recorder[i], &error));
    for (int i = 0; i < 6; i++)
        OK(rheo_recorder_step(recorder[i % 2], &error));
    for (int i = 1; i >= 0; i--) {
        OK(rheo_recorder_close(recorder[i], &error));
        OK(rheo_verify(PATH, &v, &error));
        assert_int_equal(v.verdict, RHEO_SAME);
        assert_int_equal(v.steps, 3);
        rheo_world_destroy(world[i]);
    }
    remove(PATH);
}

static void any_changed_byte_is_found(void **state)
{
    (void)state;
    size_t size;
    for (int full = 0; full < 2; full++) {
        uint8_t *bytes = record(2, 4, 2, full, NULL, &size);
        assert_int_equal(verify_bytes(bytes, size).verdict, RHEO_SAME);
        for (size_t at = 0; at < size; at++) {
            uint8_t bit = (uint8_t)(1u << (at * 2654435761u >> 7 & 7));
            bytes[at] ^= bit;
            rheo_verification v = verify_bytes(bytes, size);
            if (v.verdict != RHEO_UNREADABLE || v.steps > 4)
                fail_msg("byte %zu: %d %s", at, (int)v.verdict, v.message);
            bytes[at] ^= bit;
        }
        free(bytes);
    }
    rheo_world *world = make_world(2);
    void *saved;
    save(world, &saved, &size);
    uint8_t *bytes = saved;
    for (size_t at = 0; at < size; at++) {
        uint8_t bit = (uint8_t)(1u << (at * 2654435761u >> 7 & 7));
        bytes[at] ^= bit;
        rheo_recording *r;
        rheo_world *loaded = NULL;
        if (rheo_recording_open_memory(bytes, size, &r, &why) == RHEO_OK) {
            assert_int_not_equal(rheo_recording_world(r, 0, NULL, &loaded, &why), RHEO_OK);
            assert_null(loaded);
            rheo_recording_close(r);
        }
        bytes[at] ^= bit;
    }
    free(saved);
    rheo_world_destroy(world);
}

/* Values that pass the check sum, since it is made anew: a reader must not believe them. */
static void hostile_bytes_do_no_harm(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = record(2, 4, 2, true, NULL, &size);
    uint32_t random = 1;
    for (int n = 0; n < 4000; n++) {
        uint8_t *copy = malloc(size);
        memcpy(copy, bytes, size);
        random = random * 1664525 + 1013904223;
        size_t chunk = find(copy, size, NULL, (int)(random >> 8) % 20);
        random = random * 1664525 + 1013904223;
        size_t length = (size_t)get(copy + chunk + 16, 8);
        if (length) {
            uint8_t *at = copy + chunk + 32 + (random >> 8) % length;
            *at = (uint8_t)(random >> 29 == 0 ? 0xFFu : *at ^ 1u << (random >> 29));
            seal(copy + chunk);
            verify_bytes(copy, size);
            rheo_recording *r;
            rheo_world *world;
            if (rheo_recording_open_memory(copy, size, &r, &why) == RHEO_OK) {
                rheo_recording_world(r, 4, NULL, &world, &why);
                rheo_world_destroy(world);
                rheo_recording_close(r);
            }
        }
        free(copy);
    }
    free(bytes);
}

/* The recording with a chunk put in before the n-th STEP. */
static uint8_t *with_chunk(const uint8_t *bytes, size_t size, uint32_t flags, size_t *new_size)
{
    size_t at = find(bytes, size, "STEP", 1), length = 5;
    uint8_t *with = calloc(1, size + 36 + length);
    memcpy(with, bytes, at);
    memcpy(with + at, "NOTE", 4);
    put(with + at + 4, flags, 4);
    put(with + at + 16, length, 8);
    put(with + at + 24, length, 8);
    memcpy(with + at + 32, "hello", length);
    seal(with + at);
    memcpy(with + at + 36 + length, bytes + at, size - at);
    *new_size = size + 36 + length;
    return with;
}

static void unknown_chunks_and_versions(void **state)
{
    (void)state;
    size_t size, other_size;
    uint8_t *bytes = record(2, 4, 0, true, NULL, &size); /* one keyframe: the index stays right */
    uint8_t *other = with_chunk(bytes, size, 1, &other_size);
    rheo_verification v = verify_bytes(other, other_size);
    if (v.verdict != RHEO_SAME)
        fail_msg("%s", v.message);
    other[find(other, other_size, "NOTE", 0) + 33] ^= 1;
    v = verify_bytes(other, other_size);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_int_equal(v.steps, 1);
    free(other);

    other = with_chunk(bytes, size, 0, &other_size);
    v = verify_bytes(other, other_size);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "NOTE"));
    assert_non_null(strstr(v.message, "newer"));
    rheo_recording *r;
    assert_int_equal(rheo_recording_open_memory(other, other_size, &r, &why), RHEO_ERROR_FORMAT);
    free(other);

    other = calloc(1, size + 1);
    memcpy(other, bytes, size);
    v = verify_bytes(other, size + 1);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "follow"));
    put(other + 8 + 32, 4, 4);
    seal(other + 8);
    v = verify_bytes(other, size);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "newer rheolog"));
    put(other + 8 + 32, 1, 4);
    seal(other + 8);
    v = verify_bytes(other, size);
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_non_null(strstr(v.message, "older rheolog"));

    /* A step that is missing. */
    memcpy(other, bytes, size);
    size_t second = find(other, size, "STEP", 0);
    second += chunk_size(other + second);
    size_t third = find(other, size, "STEP", 1);
    third += chunk_size(other + third);
    memmove(other + second, other + third, size - third);
    v = verify_bytes(other, size - (third - second));
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    assert_int_equal(v.steps, 1);
    free(other);
    free(bytes);
}

static void the_other_number_type_is_refused(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = record(2, 4, 0, false, NULL, &size);
    put(bytes + 8 + 32 + 4, 12 - sizeof(rheo_real), 4);
    seal(bytes + 8);
    rheo_recording *r;
    rheo_world *world;
    double metrics[64];
    OK(rheo_recording_open_memory(bytes, size, &r, &error));
    assert_int_equal(rheo_recording_get_info(r).real_bytes, 12 - sizeof(rheo_real));
    OK(rheo_recording_metrics(r, 3, metrics, &error));
    assert_true(metrics[0] == 3);
    assert_int_equal(rheo_recording_world(r, 1, NULL, &world, &why), RHEO_ERROR_UNSUPPORTED);
    assert_non_null(strstr(why.message, "this build uses"));
    rheo_recording_close(r);
    assert_int_equal(verify_bytes(bytes, size).verdict, RHEO_UNREADABLE);
    free(bytes);
}

static void locales_do_not_matter(void **state)
{
    (void)state;
    size_t size, german_size;
    uint8_t *bytes = record(2, 4, 2, true, NULL, &size);
    if (!setlocale(LC_ALL, "de_DE.UTF-8")) {
        free(bytes);
        skip();
    }
    uint8_t *german = record(2, 4, 2, true, NULL, &german_size);
    assert_int_equal(size, german_size);
    assert_memory_equal(bytes, german, size);
    assert_int_equal(verify_bytes(german, size).verdict, RHEO_SAME);
    setlocale(LC_ALL, "C");
    free(bytes);
    free(german);
}

/* ---- docs/format.md ---- */

static void the_hash_is_as_documented(void **state)
{
    (void)state;
    /* A particle at (1, 2, 3) in a world of that particle alone; step = 7; the spring 3:7 of length 1.5; no items. */
    uint64_t sum =
        rheo__hash_word(0, 0, UINT64_C(0x400000003F800000)) + rheo__hash_word(0, 1, UINT64_C(0x0000000040400000));
    assert_true(rheo__hash_word(0, 0, 0) == UINT64_C(0x4E17CF67001B3979));
    assert_true(sum == UINT64_C(0xBFACCCA5F447B49F));
    assert_true(rheo__hash_field(sum, 1, 1) == UINT64_C(0x8952EA0C6417AB75));
    assert_true(rheo__hash_field(rheo__hash_word(0, 0, 7), 1, 1) == UINT64_C(0x6178FA89EAFC543B));
    uint64_t key = rheo__hash_key(3) * rheo__hash_key(7);
    assert_true(rheo__hash_key(3) == UINT64_C(0x4AE24EE7585B10B3) && key == UINT64_C(0xD37954CEB9876B11));
    assert_true(rheo__hash_field(key, 1, 1) == UINT64_C(0x45706511B9A205AB));
    assert_true(rheo__hash_field(key * 0x3FC00000, 1, 1) == UINT64_C(0xE430C23ECE0F0721));
    assert_true(rheo__hash_field(0, 1, 0) == UINT64_C(0xCDC98B6BA68426C4));
    for (uint64_t x = 1; x < UINT64_MAX / 3; x *= 3)
        assert_true(rheo__hash_unfinish(rheo__hash_finish(x)) == x);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_saved_comes_back),
        cmocka_unit_test(worlds_without_this_or_that_come_back),
        cmocka_unit_test(a_file_is_replaced_only_with_force),
        cmocka_unit_test(a_full_disk_is_an_error),
        cmocka_unit_test(a_disk_that_fills_up_leaves_a_readable_file),
        cmocka_unit_test(what_was_recorded_replays),
        cmocka_unit_test(a_recording_can_begin_in_the_middle),
        cmocka_unit_test(many_particles_are_added_in_portions),
        cmocka_unit_test(only_its_recorder_steps_a_world),
        cmocka_unit_test(a_failed_step_is_not_recorded),
        cmocka_unit_test(a_difference_is_named),
        cmocka_unit_test(another_list_of_stages_is_unreadable),
        cmocka_unit_test(a_torn_file_holds_up_to_the_tear),
        cmocka_unit_test(a_wrong_length_is_damage_and_no_tear),
        cmocka_unit_test(a_replaced_file_is_left_to_its_writer),
        cmocka_unit_test(any_changed_byte_is_found),
        cmocka_unit_test(hostile_bytes_do_no_harm),
        cmocka_unit_test(unknown_chunks_and_versions),
        cmocka_unit_test(the_other_number_type_is_refused),
        cmocka_unit_test(locales_do_not_matter),
        cmocka_unit_test(the_hash_is_as_documented),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
