/*
 * The floating-point environment. Everything that calculates refuses every thread setting that would change bits. The
 * message names the setting, and the world stays usable: after restoring the setting, the run continues with the same
 * bits. This thread, a loaded library and another thread make the settings.
 */
#define _POSIX_C_SOURCE 200809L

#include <dlfcn.h>
#include <fenv.h>
#include <pthread.h>

#include "core/environment.h"
#include "control_word.h"
#include "support.h"

enum { STEPS = 24 };

static const char *const PATH = "test_environment.rlog";

static const char *const TO_NEAREST = "rounding mode is not to nearest; restore it with fesetround(FE_TONEAREST)",
                         *const FLUSHED = "denormal numbers are flushed to zero in this thread";

/* ---- Settings ---- */

typedef struct setting {
    const char *name, *message;
    int rounding;     /* for fesetround(), or -1 */
    uint64_t control; /* bits set in the control word only */
} setting;

static const setting settings[] = {
    {"upward", NULL, FE_UPWARD, 0},
    {"downward", NULL, FE_DOWNWARD, 0},
    {"towards zero", NULL, FE_TOWARDZERO, 0},
#ifdef CONTROL_WORD
    {"rounding down in the control word alone", NULL, -1, CONTROL_ROUND_DOWN},
    {"rounding up in the control word alone", NULL, -1, CONTROL_ROUND_UP},
    {"truncating in the control word alone", NULL, -1, CONTROL_ROUND_DOWN | CONTROL_ROUND_UP},
    {"results flushed", "clear the FTZ and DAZ bits", -1, CONTROL_FLUSH_RESULTS},
#if CONTROL_FLUSH_OPERANDS
    {"operands flushed", "clear the FTZ and DAZ bits", -1, CONTROL_FLUSH_OPERANDS},
    {"results and operands flushed", "clear the FTZ and DAZ bits", -1,
     CONTROL_FLUSH_RESULTS | CONTROL_FLUSH_OPERANDS},
    {"flushed and rounded down", NULL, -1,
     CONTROL_FLUSH_RESULTS | CONTROL_FLUSH_OPERANDS | CONTROL_ROUND_DOWN}, /* rounding is reported first */
#endif
#endif
};

/* State that fesetenv() does not restore. */
typedef struct environment {
    fenv_t fenv;
    uint64_t control;
} environment;

static void keep(environment *e)
{
    fegetenv(&e->fenv);
#ifdef CONTROL_WORD
    e->control = control_get();
#endif
}

static void restore(const environment *e)
{
    fesetenv(&e->fenv);
#ifdef CONTROL_WORD
    control_set(e->control);
#endif
}

static void make(const setting *s)
{
    if (s->rounding >= 0)
        assert_int_equal(fesetround(s->rounding), 0);
#ifdef CONTROL_WORD
    control_set(control_get() | s->control);
#endif
}

/* ---- Environments that must be refused ---- */

typedef struct refusal {
    rheo_result result;
    rheo_error error;
} refusal;

/* Calls everything that calculates in the current environment. Nothing is asserted there. */
enum { CREATE, CREATE_SCENE, STEP, STEP_STAGE, PUSH, SET, ADD, MOVE, RECORD_STEP, VERIFY, CALLS };
static const char *const call_names[CALLS] = {"create", "create a scene", "step",   "step a stage", "push", "set",
                                              "add",    "move",           "record", "verify"};

typedef struct run {
    rheo_world *world;
    rheo_recorder *recorder;
    const void *bytes; /* a recording to verify */
    size_t size;
} run;

static void try_all(const run *r, refusal refused[CALLS])
{
    const rheo_real position[3] = {1, 20, 1};
    const double impulse[3] = {1, 2, 3};
    rheo_world_def def = rheo_default_world_def();
    rheo_scene scene = lively_scene();
    rheo_world *other = NULL;
    rheo_verification verification;
    uint32_t stage;
    refused[CREATE].result = rheo_world_create(&def, &other, &refused[CREATE].error);
    rheo_world_destroy(other);
    refused[CREATE_SCENE].result = rheo_scene_create_world(&scene, &other, &refused[CREATE_SCENE].error);
    rheo_world_destroy(other);
    refused[STEP].result = rheo_world_step(r->world, &refused[STEP].error);
    refused[STEP_STAGE].result = rheo_world_step_stage(r->world, &stage, &refused[STEP_STAGE].error);
    refused[PUSH].result = rheo_world_push_body(r->world, 0, impulse, NULL, &refused[PUSH].error);
    refused[SET].result = rheo_world_set(r->world, "history.order", "0.4", &refused[SET].error);
    refused[ADD].result = rheo_world_add_particles(r->world, 1, position, NULL, &refused[ADD].error);
    refused[MOVE].result = rheo_world_move_vibrator(r->world, 0, 0.1, 0.2, &refused[MOVE].error);
    refused[RECORD_STEP].result = rheo_recorder_step(r->recorder, &refused[RECORD_STEP].error);
    refused[VERIFY].result = rheo_verify_memory(r->bytes, r->size, &verification, &refused[VERIFY].error);
}

static void assert_refused(const refusal refused[CALLS], const char *message, const char *name)
{
    for (int c = 0; c < CALLS; c++)
        if (refused[c].result != RHEO_ERROR_ENVIRONMENT || !strstr(refused[c].error.message, message))
            fail_msg("%s, %s: %s, \"%s\" instead of \"%s\"", name, call_names[c], rheo_result_name(refused[c].result),
                     refused[c].error.message, message);
}

/* ---- Runs with and without disturbance ---- */

/* Returns the bytes of a recording and the hashes of STEPS + 1 states. Calls `disturb` before every step. */
static void *record(uint64_t hashes[STEPS + 1], size_t *size, void (*disturb)(const run *, int, void *),
                    void *context)
{
    run r = {.world = lively_world()};
    void *saved;
    OK(rheo_world_save_memory(r.world, "saved", &saved, &r.size, &error));
    r.bytes = saved;
    rheo_record_options options = {.scene = "environment", .keyframe_spacing = 5, .full = true, .force = true};
    OK(rheo_recorder_open(r.world, PATH, &options, &r.recorder, &error));
    for (int step = 0; step < STEPS; step++) {
        hashes[step] = rheo_world_hash(r.world);
        const double impulse[3] = {40, 0, 10};
        if (step == 7)
            OK(rheo_world_push_body(r.world, 0, impulse, NULL, &error));
        if (disturb)
            disturb(&r, step, context);
        OK(rheo_recorder_step(r.recorder, &error));
    }
    hashes[STEPS] = rheo_world_hash(r.world);
    OK(rheo_recorder_close(r.recorder, &error));
    rheo_world_destroy(r.world);
    free(saved);
    void *bytes = read_file(PATH, size);
    remove(PATH);
    return bytes;
}

static void disturb(const run *r, int step, void *context)
{
    int *disturbed = context;
    const setting *s = &settings[(size_t)step % (sizeof settings / sizeof *settings)];
    const uint64_t hash = rheo_world_hash(r->world), count = rheo_world_step_count(r->world);
    refusal refused[CALLS];
    environment saved;
    keep(&saved);
    make(s);
    try_all(r, refused);
    restore(&saved);
    assert_refused(refused, s->message ? s->message : TO_NEAREST, s->name);
    rheo_failure failure;
    assert_false(rheo_world_failure(r->world, &failure)); /* the world itself has not failed */
    assert_true(rheo_world_hash(r->world) == hash && rheo_world_step_count(r->world) == count);
    ++*disturbed;
}

static void a_disturbed_run_continues_with_the_same_bits(void **unused)
{
    (void)unused;
    uint64_t undisturbed[STEPS + 1], disturbed[STEPS + 1];
    size_t size[2];
    int times = 0;
    assert_true(sizeof settings / sizeof *settings <= STEPS);
#ifndef CONTROL_WORD
    print_message("the control word of this machine is unknown: flushing denormals is not tested\n");
#endif
    void *a = record(undisturbed, &size[0], NULL, NULL), *b = record(disturbed, &size[1], disturb, &times);
    assert_int_equal(times, STEPS);
    assert_memory_equal(undisturbed, disturbed, sizeof undisturbed);
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(a, b, size[0]);
    rheo_verification v;
    OK(rheo_verify_memory(b, size[1], &v, &error));
    assert_int_equal(v.verdict, RHEO_SAME);
    free(a);
    free(b);
}

static void the_middle_of_a_step_is_kept_too(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world(), *straight = lively_world();
    uint32_t stage;
    uint32_t stages = 0;
    do {
        const setting *s = &settings[stages % (sizeof settings / sizeof *settings)];
        rheo_error errors[2];
        environment saved;
        keep(&saved);
        make(s);
        rheo_result one = rheo_world_step_stage(world, &stage, &errors[0]), all = rheo_world_step(world, &errors[1]);
        restore(&saved);
        assert_int_equal(one, RHEO_ERROR_ENVIRONMENT);
        assert_int_equal(all, RHEO_ERROR_ENVIRONMENT);
        assert_int_equal(rheo_world_stages_done(world), stages);
        OK(rheo_world_step_stage(world, &stage, &error));
        stages++;
    } while (rheo_world_stages_done(world));
    assert_true(stages > rheo_world_stage_count(world)); /* some ran in two substeps */
    step(straight, 1);
    assert_true(rheo_world_hash(world) == rheo_world_hash(straight));
    rheo_world_destroy(world);
    rheo_world_destroy(straight);
}

/* ---- Flags set by others ---- */

static uint64_t hash_after(rheo_world *world, int steps)
{
    step(world, steps);
    return rheo_world_hash(world);
}

/*
 * Loads a library linked with -ffast-math, or one that runs the same start-up code by hand, since newer compilers
 * omit that code from libraries.
 */
static void loading_a_library_is_noticed(const char *variable, bool surely)
{
    const char *path = getenv(variable);
    if (!path)
        fail_msg("%s is not set; run this test with meson test", variable);
#ifndef CONTROL_WORD
    (void)surely;
    print_message("the control word of this machine is unknown\n");
    skip();
#else
    rheo_world *world = lively_world(), *straight = lively_world(), *other;
    step(world, 2);
    const uint64_t before = control_get();
    void *library = dlopen(path, RTLD_NOW);
    const uint64_t after = control_get();
    rheo_world_def def = rheo_default_world_def();
    rheo_error errors[2] = {{""}, {""}};
    const rheo_result create = rheo_world_create(&def, &other, &errors[0]),
                      stepped = after == before ? RHEO_OK : rheo_world_step(world, &errors[1]);
    control_set(before);
    if (!library)
        fail_msg("%s", dlerror());
    if (after == before) {
        assert_false(surely);
        assert_int_equal(create, RHEO_OK);
        rheo_world_destroy(other);
        print_message("libraries of this compiler, linked with -ffast-math, change no flags when they are loaded\n");
    } else {
        assert_true((after & ~before) == (CONTROL_FLUSH_RESULTS | CONTROL_FLUSH_OPERANDS));
        assert_int_equal(create, RHEO_ERROR_ENVIRONMENT);
        assert_int_equal(stepped, RHEO_ERROR_ENVIRONMENT);
        assert_non_null(strstr(errors[0].message, FLUSHED));
        assert_non_null(strstr(errors[1].message, FLUSHED));
        print_message("loading set %#llx, and was noticed\n", (unsigned long long)(after & ~before));
    }
    assert_true(hash_after(world, 3) == hash_after(straight, 5));
    dlclose(library);
    rheo_world_destroy(world);
    rheo_world_destroy(straight);
    if (after == before)
        skip();
#endif
}

static void a_library_linked_with_fast_math_is_noticed(void **unused)
{
    (void)unused;
    loading_a_library_is_noticed("FAST_MATH_LIBRARY", false);
}

static void a_library_that_sets_the_flags_is_noticed(void **unused)
{
    (void)unused;
    loading_a_library_is_noticed("FLUSHING_LIBRARY", true);
}

#ifdef CONTROL_WORD
typedef struct visit {
    rheo_world *world;
    uint64_t set, clear; /* in the thread's control word */
    rheo_result result;
    rheo_error error;
} visit;

static void *visit_thread(void *context)
{
    visit *v = context;
    control_set((control_get() | v->set) & ~v->clear);
    v->result = rheo_world_step(v->world, &v->error);
    return NULL;
}

static void in_a_thread(visit *v)
{
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, visit_thread, v), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
}
#endif

static void flags_belong_to_the_thread(void **unused)
{
    (void)unused;
#ifndef CONTROL_WORD
    skip();
#else
    rheo_world *world = lively_world(), *straight = lively_world();
    const uint64_t before = control_get(), flush = CONTROL_FLUSH_RESULTS | CONTROL_FLUSH_OPERANDS;
    /* Set in another thread: refused there and not here. */
    visit v = {.world = world, .set = flush};
    in_a_thread(&v);
    assert_int_equal(v.result, RHEO_ERROR_ENVIRONMENT);
    assert_non_null(strstr(v.error.message, FLUSHED));
    assert_true(control_get() == before);
    step(world, 1);
    v = (visit){.world = world, .set = CONTROL_ROUND_UP};
    in_a_thread(&v);
    assert_int_equal(v.result, RHEO_ERROR_ENVIRONMENT);
    assert_non_null(strstr(v.error.message, TO_NEAREST));
    /* Set here: another thread without the flags continues the world meanwhile. */
    rheo_error why = {""};
    control_set(before | flush);
    const rheo_result here = rheo_world_step(world, &why);
    v = (visit){.world = world, .clear = flush};
    in_a_thread(&v);
    control_set(before);
    assert_int_equal(here, RHEO_ERROR_ENVIRONMENT);
    assert_int_equal(v.result, RHEO_OK);
    assert_true(hash_after(world, 2) == hash_after(straight, 4));
    rheo_world_destroy(world);
    rheo_world_destroy(straight);
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_disturbed_run_continues_with_the_same_bits),
        cmocka_unit_test(the_middle_of_a_step_is_kept_too),
        cmocka_unit_test(a_library_linked_with_fast_math_is_noticed),
        cmocka_unit_test(a_library_that_sets_the_flags_is_noticed),
        cmocka_unit_test(flags_belong_to_the_thread),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
