/*
 * Memory that runs out: whichever allocation of a task fails, the task fails with the error for it or does without,
 * releases everything, and succeeds when it is tried again. The linker redirects all memory calls of the test and its
 * copy of the library (--wrap=malloc, ...).
 */
#include "support.h"

#define PATH "test_no_memory.rlog"

void *__real_malloc(size_t bytes);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t bytes);
void __real_free(void *memory);
void *__wrap_malloc(size_t bytes);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t bytes);
void __wrap_free(void *memory);

static bool counting;
static size_t calls, refused_call, live; /* refused_call: from 1; 0: none */

static bool refused(void)
{
    return counting && ++calls == refused_call;
}

void *__wrap_malloc(size_t bytes)
{
    void *memory = refused() ? NULL : __real_malloc(bytes);
    live += counting && memory;
    return memory;
}

void *__wrap_calloc(size_t count, size_t size)
{
    void *memory = refused() ? NULL : __real_calloc(count, size);
    live += counting && memory;
    return memory;
}

void *__wrap_realloc(void *old, size_t bytes)
{
    void *memory = refused() ? NULL : __real_realloc(old, bytes);
    live += counting && memory && !old;
    return memory;
}

void __wrap_free(void *memory)
{
    live -= counting && memory;
    __real_free(memory);
}

/* ---- Tasks ---- */

static uint8_t *recorded[2], *other; /* recordings of one run: the second is full; another run */
static size_t recorded_size[2], other_size;
static rheo_world *world;

/* Releases even after a failure, so the result is kept. */
#define TRY(call)              \
    do {                       \
        if (result == RHEO_OK) \
            result = (call);   \
    } while (0)

static rheo_result record_run(bool full, const char *stiffness, uint8_t **bytes, size_t *size, rheo_error *error)
{
    rheo_scene scene = {0};
    rheo_world *w = NULL;
    rheo_recorder *recorder = NULL;
    void *taken = NULL;
    const rheo_wall wall = {.normal = {0, 1, 0}};
    const rheo_record_options options = {.scene = "small", .full = full, .keyframe_spacing = 2};
    rheo_result result = rheo_scene_builtin("bowling-ball-small", &scene, error);
    if (result == RHEO_OK) {
        rheo_fill *fill = (rheo_fill *)(uintptr_t)scene.fill;
        for (int a = 0; a < 3; a++)
            fill[0].max[a] = fill[0].min[a] + 6;
        scene.world.history.window = 5;
        scene.settle.time = 0;
    }
    TRY(rheo_scene_add_wall(&scene, &wall, error));
    TRY(rheo_scene_add_vibrator(&scene, 1, 2, error));
    TRY(rheo_scene_create_world(&scene, &w, error));
    TRY(rheo_recorder_open_memory(w, &options, &recorder, error));
    for (int i = 0; i < 5; i++) {
        const double push[3] = {1, 0, 0};
        const rheo_real position[6] = {0, 30, 0, 0, 35, 0};
        if (i == 2) {
            TRY(rheo_world_set(w, "springs.stiffness", stiffness, error));
            TRY(rheo_world_push_body(w, 0, push, NULL, error));
            TRY(rheo_world_add_particles(w, 2, position, NULL, error));
        }
        TRY(rheo_recorder_step(recorder, error));
    }
    if (recorder) {
        const rheo_result closed =
            rheo_recorder_close_memory(recorder, &taken, size, result == RHEO_OK ? error : NULL);
        TRY(closed);
    }
    *bytes = taken;
    rheo_world_destroy(w);
    rheo_scene_release(&scene);
    return result;
}

static rheo_result make(bool full, rheo_error *error)
{
    uint8_t *bytes = NULL;
    size_t size;
    const rheo_result result = record_run(full, "20", &bytes, &size, error);
    if (result == RHEO_OK)
        assert_memory_equal(bytes, recorded[full], recorded_size[full]);
    free(bytes);
    return result;
}

static rheo_result verify(bool full, rheo_error *error)
{
    rheo_verification v;
    const rheo_result result = rheo_verify_memory(recorded[full], recorded_size[full], &v, error);
    assert_int_equal(v.verdict, result == RHEO_OK ? RHEO_SAME : RHEO_NOT_COMPARED);
    return result;
}

static rheo_result compare(bool full, rheo_error *error)
{
    rheo_verification v;
    const rheo_result result = rheo_diff_memory(recorded[full], recorded_size[full], other, other_size, &v, error);
    if (result == RHEO_OK)
        assert_true(v.verdict == RHEO_DIFFERS && v.first.step == 3 && v.commands_differ);
    return result;
}

static rheo_result read_all(bool full, rheo_error *error)
{
    rheo_recording *r = NULL;
    rheo_player *player = NULL;
    rheo_world *w = NULL;
    rheo_diagnosis d;
    rheo_command command;
    double metrics[64];
    uint32_t stage;
    rheo_search search;
    const rheo_find_options last = {.which = RHEO_FIND_LAST};
    rheo_result result = rheo_recording_open_memory(recorded[full], recorded_size[full], &r, error);
    TRY(rheo_recording_check(r, error));
    TRY(rheo_recording_world(r, 3, NULL, &w, error));
    TRY(rheo_recording_metrics(r, 4, metrics, error));
    for (uint64_t i = 0; result == RHEO_OK && i < rheo_recording_command_count(r); i++)
        TRY(rheo_recording_command(r, i, &command, error));
    TRY(rheo_player_open(r, NULL, &player, error));
    TRY(rheo_player_seek(player, 5, error));
    TRY(rheo_player_step_back(player, error));
    TRY(rheo_player_stage(player, &stage, error));
    TRY(rheo_player_seek_stage(player, 3, "forces", error));
    TRY(rheo_recording_find(r, "step > 2 or ball: y < 0", NULL, &search, error));
    TRY(rheo_player_find(player, "any particle: density > 0 and any spring: kappa >= 0", &last, &search, error));
    TRY(rheo_diagnose(r, &d, error));
    rheo_player_close(player);
    rheo_world_destroy(w);
    rheo_recording_close(r);
    return result;
}

static rheo_result bless(bool full, rheo_error *error)
{
    rheo_verification v;
    write_file(PATH, recorded[full], recorded_size[full]);
    write_file(PATH ".new", other, other_size);
    rheo_result result = rheo_bless(PATH, PATH ".new", "a test", full, &v, error);
    rheo_recording *r = NULL;
    TRY(rheo_recording_open(PATH, &r, error));
    if (result == RHEO_OK)
        assert_int_equal(rheo_recording_blessing_count(r), 1);
    rheo_recording_close(r);
    TRY(rheo_bless(PATH, PATH ".new", "a second time", full, &v, error));
    remove(PATH);
    remove(PATH ".new");
    return result;
}

static rheo_result make_again(bool full, rheo_error *error)
{
    rheo_verification v;
    write_file(PATH, recorded[full], recorded_size[full]);
    const rheo_result result = rheo_rerecord(PATH, PATH ".new", false, true, &v, error);
    remove(PATH);
    remove(PATH ".new");
    return result;
}

static rheo_result go_on(bool full, rheo_error *error)
{
    rheo_recording *r = NULL;
    rheo_world *w = NULL;
    rheo_recorder *recorder = NULL;
    rheo_golden *golden = NULL;
    rheo_health *health = NULL;
    rheo_finding finding;
    const rheo_record_options options = {.scene = "small", .full = full, .keyframe_spacing = 2};
    write_file(PATH, recorded[full], recorded_size[full]);
    rheo_result result = rheo_recording_open(PATH, &r, error);
    TRY(rheo_recording_world(r, 0, NULL, &w, error));
    rheo_recording_close(r);
    TRY(rheo_golden_open(w, PATH, &golden, error));
    TRY(rheo_golden_step(golden, error));
    if (golden)
        rheo_golden_close(golden, NULL, NULL);
    rheo_world_destroy(w);
    w = NULL;
    TRY(rheo_recording_open(PATH, &r, error));
    if (result == RHEO_OK) {
        result = rheo_recording_world(r, 0, NULL, &w, error);
        rheo_recording_close(r);
    }
    TRY(rheo_recorder_continue(&w, PATH, &options, &recorder, error));
    TRY(rheo_health_open(w, &health, error));
    TRY(rheo_recorder_step(recorder, error));
    if (health)
        rheo_health_step(health, &finding);
    rheo_health_close(health);
    if (recorder) {
        const rheo_result closed = rheo_recorder_close(recorder, result == RHEO_OK ? error : NULL);
        TRY(closed);
    }
    rheo_world_destroy(w);
    remove(PATH);
    return result;
}

/* After a copy that failed, the recorder goes on: a second copy, further steps, and the end are those of any recording. */
static rheo_result copy(bool full, rheo_error *error)
{
    rheo_recording *r = NULL;
    rheo_world *w = NULL;
    rheo_recorder *recorder = NULL;
    void *bytes = NULL, *taken = NULL;
    size_t size = 0;
    rheo_verification v;
    const rheo_record_options options = {.scene = "small", .full = full, .keyframe_spacing = 2};
    rheo_result result = rheo_recording_open_memory(recorded[0], recorded_size[0], &r, error);
    TRY(rheo_recording_world(r, 2, NULL, &w, error));
    TRY(rheo_recorder_open_memory(w, &options, &recorder, error));
    TRY(rheo_recorder_step(recorder, error));
    if (result == RHEO_OK) {
        result = rheo_recorder_copy_memory(recorder, &bytes, &size, error);
        assert_true(result == RHEO_OK ? bytes && size : !bytes && !size);
        const bool failed = result != RHEO_OK; /* only one allocation is refused: all that follows succeeds */
        for (int i = 0; failed && i < 3; i++)
            assert_int_equal(rheo_recorder_step(recorder, NULL), RHEO_OK);
        if (failed)
            assert_int_equal(rheo_recorder_copy_memory(recorder, &bytes, &size, NULL), RHEO_OK);
        if (failed) {
            assert_int_equal(rheo_verify_memory(bytes, size, &v, NULL), RHEO_OK);
            assert_true(v.verdict == RHEO_SAME && v.steps == 4);
            assert_int_equal(rheo_recorder_close_memory(recorder, &taken, &size, NULL), RHEO_OK);
            assert_memory_equal(taken, bytes, size);
            recorder = NULL;
        }
    }
    if (recorder) {
        const rheo_result closed =
            rheo_recorder_close_memory(recorder, &taken, &size, result == RHEO_OK ? error : NULL);
        TRY(closed);
        if (result == RHEO_OK)
            assert_memory_equal(taken, bytes, size);
    }
    free(bytes);
    free(taken);
    rheo_world_destroy(w);
    rheo_recording_close(r);
    return result;
}

static rheo_result draw(bool full, rheo_error *error)
{
    static unsigned char rgb[3 * 64 * 48];
    rheo_picture_options options = rheo_default_picture_options();
    double range[2];
    options.width = 64;
    options.height = 48;
    options.colour = full ? "density" : options.colour;
    rheo_result result = full ? rheo_world_colour_range(world, &options, range, error) : RHEO_OK;
    TRY(rheo_world_render(world, &options, rgb, error));
    return result;
}

static rheo_result export_all(bool surfaces, rheo_error *error)
{
    rheo_result result = RHEO_OK;
    for (uint32_t f = 0; rheo_export_format_name(f) && result == RHEO_OK; f++) {
        const char *path = "test_no_memory.out";
        const rheo_export_options options = {.surface = rheo_default_surface_options(), .force = true};
        if (rheo_export_has_surface((rheo_export_format)f) == surfaces)
            result = rheo_world_export(world, (rheo_export_format)f, path, &options, NULL, error);
        remove(path);
    }
    return result;
}

/* With points, its text takes more than one buffer. */
static rheo_result plot(bool points, rheo_error *error)
{
    enum { COUNT = 3000 };
    static double x[COUNT], y[COUNT];
    for (int i = 0; i < COUNT; i++) {
        x[i] = i;
        y[i] = i % 97;
    }
    const rheo_plot_curve curve = {"y", COUNT, x, y, points ? RHEO_PLOT_POINTS : RHEO_PLOT_LINE, 0};
    const rheo_plot_panel panel = {NULL, {0}, {0}, 1, &curve};
    char *text;
    size_t size;
    rheo_result result = rheo_plot_text(&(rheo_plot){"y", NULL, 1, &panel, 1}, &text, &size, error);
    free(text);
    return result;
}

static rheo_result fill_mesh(bool warn, rheo_error *error)
{
    rheo_scene scene = {0};
    rheo_warning warnings[8];
    uint64_t count;
    size_t warned;
    rheo_result result = rheo_scene_builtin("bowling-ball-small", &scene, error);
    rheo_fill mesh = {.kind = RHEO_FILL_MESH, .height = 6, .position = {0, 50, 0}, .name = "bunny"};
    TRY(rheo_scene_add_fill(&scene, &mesh, error));
    TRY(rheo_scene_particle_count(&scene, &count, error));
    if (warn)
        TRY(rheo_scene_warnings(&scene, warnings, 8, &warned, error));
    rheo_scene_release(&scene);
    return result;
}

/* ---- Every allocation of each ---- */

static void runs_out(rheo_result (*task)(bool, rheo_error *), bool variant)
{
    rheo_error error = {""};
    size_t failed = 0;
    counting = true;
    calls = refused_call = live = 0;
    const rheo_result first = task(variant, &error);
    counting = false;
    if (first != RHEO_OK)
        fail_msg("%s", error.message);
    const size_t all = calls;
    assert_true(all > 0 && live == 0);
    const size_t every_nth = all > 400 ? every() : 1;
    for (size_t n = 1; n <= all; n += every_nth) {
        error = (rheo_error){""};
        counting = true;
        calls = live = 0;
        refused_call = n;
        const rheo_result result = task(variant, &error);
        counting = false;
        if (live != 0)
            fail_msg("call %zu of %zu: %zu blocks are not released", n, all, live);
        if (result != RHEO_OK && !(result == RHEO_ERROR_MEMORY && says(error.message, "memory")))
            fail_msg("call %zu of %zu: %s: %s", n, all, rheo_result_name(result), error.message);
        failed += result != RHEO_OK;
    }
    assert_true(failed > 0);
    refused_call = 0;
    if (task(variant, &error) != RHEO_OK)
        fail_msg("%s", error.message);
}

#define TASK(name)                                   \
    static void name##_without_memory(void **unused) \
    {                                                \
        (void)unused;                                \
        runs_out(name, false);                       \
        runs_out(name, true);                        \
    }
TASK(make)
TASK(verify)
TASK(compare)
TASK(read_all)
TASK(bless)
TASK(make_again)
TASK(go_on)
TASK(copy)
TASK(draw)
TASK(export_all)
TASK(plot)
TASK(fill_mesh)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(make_without_memory),      cmocka_unit_test(verify_without_memory),
        cmocka_unit_test(compare_without_memory),   cmocka_unit_test(read_all_without_memory),
        cmocka_unit_test(bless_without_memory),     cmocka_unit_test(make_again_without_memory),
        cmocka_unit_test(go_on_without_memory),     cmocka_unit_test(draw_without_memory),
        cmocka_unit_test(copy_without_memory),      cmocka_unit_test(export_all_without_memory),
        cmocka_unit_test(fill_mesh_without_memory), cmocka_unit_test(plot_without_memory),
    };
    rheo_error error;
    rheo_recording *r;
    if (record_run(false, "20", &recorded[0], &recorded_size[0], &error) != RHEO_OK ||
        record_run(true, "20", &recorded[1], &recorded_size[1], &error) != RHEO_OK ||
        record_run(false, "21", &other, &other_size, &error) != RHEO_OK ||
        rheo_recording_open_memory(recorded[0], recorded_size[0], &r, &error) != RHEO_OK ||
        rheo_recording_world(r, 5, NULL, &world, &error) != RHEO_OK) {
        fprintf(stderr, "%s\n", error.message);
        return 1;
    }
    const int failed = cmocka_run_group_tests_name("no_memory", tests, NULL, NULL);
    rheo_recording_close(r);
    rheo_world_destroy(world);
    free(recorded[0]);
    free(recorded[1]);
    free(other);
    return failed;
}
