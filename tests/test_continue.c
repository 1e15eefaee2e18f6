/*
 * Recordings that are continued. A run that was closed early, killed or cut anywhere ends with the same bytes as one
 * that never stopped; a recording of another run is refused and remains as it is.
 */
#define PATH "test_continue.rlog"
#include "recorded_runs.h"

enum { STEPS = 13, SPACING = 4 };

/* ---- Runs ---- */

typedef rheo_world *world_maker(void);

/* Becomes infinite in step 10. */
static void overflow(rheo_world *world, uint64_t step)
{
    if (step == 9)
        make_infinite(world);
}

typedef struct run_kind {
    const char *name;
    world_maker *make;
    void (*command)(rheo_world *world, uint64_t step);
    bool full;
} run_kind;

/* Goes on to the end, or until a step fails. */
static void finish(const run_kind *k, rheo_world *world, rheo_recorder *recorder, uint64_t end)
{
    bool good = true;
    for (uint64_t step = rheo_world_step_count(world); step < end && good; step++) {
        if (k->command)
            k->command(world, step);
        good = rheo_recorder_step(recorder, &why) == RHEO_OK;
    }
    OK(rheo_recorder_close(recorder, &error));
}

static rheo_record_options options_of(const run_kind *k)
{
    return (rheo_record_options){.scene = "small", .keyframe_spacing = SPACING, .full = k->full};
}

static file run_whole(const run_kind *k, uint64_t end)
{
    rheo_world *world = k->make();
    rheo_recorder *recorder;
    const rheo_record_options options = options_of(k);
    remove(PATH);
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    finish(k, world, recorder, end);
    rheo_world_destroy(world);
    return read_and_remove(PATH);
}

/* Continues the file at PATH, which must become `whole`. Returns the step from which it went on. */
static uint64_t continue_to(const run_kind *k, const file *whole, size_t cut)
{
    rheo_world *world = k->make();
    rheo_recorder *recorder;
    const rheo_record_options options = options_of(k);
    if (rheo_recorder_continue(&world, PATH, &options, &recorder, &why) != RHEO_OK)
        fail_msg("%s, byte %zu: %s", k->name, cut, why.message);
    const uint64_t from = rheo_world_step_count(world);
    finish(k, world, recorder, STEPS);
    rheo_world_destroy(world);
    file now;
    now.bytes = read_file(PATH, &now.size);
    if (now.size != whole->size || memcmp(now.bytes, whole->bytes, now.size) != 0)
        fail_msg("%s, byte %zu: %zu bytes instead of %zu, or other ones", k->name, cut, now.size, whole->size);
    free(now.bytes);
    return from;
}

static const run_kind kinds[] = {
    {"window", small, command, false},   {"full", small, command, true},
    {"melting", melt, NULL, false},      {"melting, full", melt, NULL, true},
    {"failing", small, overflow, false}, {"failing, full", small, overflow, true},
};

static void a_run_killed_at_any_byte_ends_with_the_same_bytes(void **state)
{
    (void)state;
    for (size_t n = 0; n < sizeof kinds / sizeof *kinds; n++) {
        const file whole = run_whole(&kinds[n], STEPS);
        const size_t stride = whole.size / 500 + 1;
        uint64_t least = UINT64_MAX, most = 0;
        for (size_t cut = 0; cut <= whole.size; cut += stride * every()) {
            write_file(PATH, whole.bytes, cut);
            const uint64_t from = continue_to(&kinds[n], &whole, cut);
            least = from < least ? from : least;
            most = from > most ? from : most;
        }
        for (size_t cut = whole.size - 70; cut <= whole.size; cut++) { /* in and before the end mark */
            write_file(PATH, whole.bytes, cut);
            const uint64_t from = continue_to(&kinds[n], &whole, cut);
            most = from > most ? from : most; /* however few cuts every() takes */
        }
        assert_int_equal(least, 0);
        assert_true(most > 8);
        /* Between two chunks, where only the order of the file says what is missing. */
        for (size_t at = 8; at < whole.size;) {
            write_file(PATH, whole.bytes, at);
            continue_to(&kinds[n], &whole, at);
            uint64_t stored;
            memcpy(&stored, whole.bytes + at + 16, sizeof stored);
            at += 36 + (size_t)stored;
        }
        free(whole.bytes);
    }
    remove(PATH);
}

/* A file system that lost power keeps the size of a file, but not all of its bytes. */
static void a_run_whose_end_became_zeros_ends_with_the_same_bytes(void **state)
{
    (void)state;
    for (size_t n = 0; n < sizeof kinds / sizeof *kinds; n++) {
        const file whole = run_whole(&kinds[n], STEPS);
        const size_t stride = whole.size / 100 + 1;
        char *zeroed = calloc(2, whole.size);
        assert_non_null(zeroed);
        for (size_t kept = 0; kept + 16 < whole.size; kept += stride * every()) {
            memcpy(zeroed, whole.bytes, kept);
            write_file(PATH, zeroed, whole.size);
            continue_to(&kinds[n], &whole, kept);
            write_file(PATH, zeroed, 2 * whole.size); /* room that was reserved, over many blocks */
            continue_to(&kinds[n], &whole, kept);
        }
        /* The last bytes of a chunk, where the rest of it filled the block before. */
        size_t chunks = 0;
        for (size_t at = 8; at < whole.size; chunks++) {
            uint64_t stored;
            memcpy(&stored, whole.bytes + at + 16, sizeof stored);
            at += 36 + (size_t)stored;
            memcpy(zeroed, whole.bytes, at);
            for (size_t lost = 1; lost <= 20 && chunks % every() == 0; lost++) {
                zeroed[at - lost] = 0;
                write_file(PATH, zeroed, at);
                continue_to(&kinds[n], &whole, at - lost);
            }
            memset(zeroed, 0, at);
        }
        /* A complete one is no such file. */
        memcpy(zeroed, whole.bytes, whole.size);
        write_file(PATH, zeroed, 2 * whole.size);
        rheo_recording *recording;
        REFUSED(RHEO_ERROR_FORMAT, "is the end mark, but more bytes follow",
                rheo_recording_open(PATH, &recording, &error));
        free(zeroed);
        free(whole.bytes);
    }
    remove(PATH);
}

static void a_run_closed_early_ends_with_the_same_bytes(void **state)
{
    (void)state;
    static const rheo_history_kind histories[] = {RHEO_HISTORY_WINDOW, RHEO_HISTORY_WINDOW_FAST,
                                                  RHEO_HISTORY_TEMPERED, RHEO_HISTORY_FULL};
    for (size_t n = 0; n < sizeof kinds / sizeof *kinds; n++)
        for (size_t h = 0; h < (kinds[n].make == small ? 4u : 1u); h++) {
            kind = histories[h];
            const file whole = run_whole(&kinds[n], STEPS);
            for (uint64_t end = 0; end <= STEPS; end++) {
                const file early = run_whole(&kinds[n], end);
                write_file(PATH, early.bytes, early.size);
                continue_to(&kinds[n], &whole, early.size);
                continue_to(&kinds[n], &whole, whole.size); /* again: nothing is left to do */
                free(early.bytes);
            }
            remove(PATH);
            continue_to(&kinds[n], &whole, 0); /* no file: it is begun */
            free(whole.bytes);
        }
    kind = RHEO_HISTORY_WINDOW;
    remove(PATH);
}

/* ---- Refusals ---- */

static rheo_world *other_particle(void)
{
    rheo_real position[3 * MOST];
    rheo_world_def def = scene_def(2, position);
    def.history.kind = kind;
    position[4] = position[4] * (rheo_real)1.0001;
    rheo_world *world;
    OK(rheo_world_create(&def, &world, &error));
    return world;
}

static rheo_world *other_wall(void)
{
    rheo_real position[3 * MOST];
    rheo_world_def def = scene_def(2, position);
    def.history.kind = kind;
    walls_of(&def)[1].point[0] = -2;
    rheo_world *world;
    OK(rheo_world_create(&def, &world, &error));
    return world;
}

static rheo_world *other_parameter(void)
{
    rheo_real position[3 * MOST];
    rheo_world_def def = scene_def(2, position);
    def.history.kind = kind;
    def.fluid.stiffness = 123;
    rheo_world *world;
    OK(rheo_world_create(&def, &world, &error));
    return world;
}

static rheo_world *later(void)
{
    rheo_world *world = small();
    step(world, 1);
    return world;
}

/* Refuses to continue the file with this world and these options; nothing changes. */
static void refuse(rheo_result result, const char *text, const file *there, world_maker *make,
                   rheo_record_options options)
{
    rheo_world *world = make();
    const rheo_world *same = world;
    rheo_recorder *recorder;
    write_file(PATH, there->bytes, there->size);
    REFUSED(result, text, rheo_recorder_continue(&world, PATH, &options, &recorder, &error));
    assert_null(recorder);
    assert_ptr_equal(world, same);
    OK(rheo_world_step(world, &error));
    rheo_world_destroy(world);
    const file now = read_and_remove(PATH);
    assert_int_equal(now.size, there->size);
    assert_memory_equal(now.bytes, there->bytes, now.size);
    free(now.bytes);
}

static void a_recording_of_another_run_is_refused_and_unchanged(void **state)
{
    (void)state;
    const run_kind *k = &kinds[0];
    const file whole = run_whole(k, STEPS);
    const rheo_record_options right = options_of(k);
    rheo_record_options options = right;
    for (int torn = 0; torn < 2; torn++) {
        const file there = {whole.bytes, whole.size - (torn ? 100 : 0)};
        refuse(RHEO_ERROR_ARGUMENT, "first state has another position", &there, other_particle, right);
        refuse(RHEO_ERROR_ARGUMENT, "other walls", &there, other_wall, right);
        refuse(RHEO_ERROR_ARGUMENT, "fluid.stiffness", &there, other_parameter, right);
        refuse(RHEO_ERROR_ARGUMENT, "begins with step 0", &there, later, right);
        options.scene = "large";
        refuse(RHEO_ERROR_ARGUMENT, "scene \"small\", this run of \"large\"", &there, small, options);
        options = right;
        options.full = true;
        refuse(RHEO_ERROR_ARGUMENT, "state of every step", &there, small, options);
        options = right;
        options.keyframe_spacing = 5;
        refuse(RHEO_ERROR_ARGUMENT, "every 4 steps, this run every 5", &there, small, options);
        options = right;
    }
    refuse(RHEO_ERROR_ARGUMENT, "model", &whole, melt, right);
    const file letter = {(uint8_t *)(uintptr_t) "a letter", 8}, short_letter = {letter.bytes, 3},
               head = {whole.bytes, 700};
    refuse(RHEO_ERROR_FORMAT, "not a recording", &letter, small, right);
    refuse(RHEO_ERROR_FORMAT, "not a recording", &short_letter, small, right);
    options.scene = "large"; /* even where only the head is there */
    refuse(RHEO_ERROR_FORMAT, "it would be begun again, but it does not begin as this run", &head, small, options);
    whole.bytes[whole.size / 2 + 20] ^=
        1; /* in the head of some chunk, or in its contents: never accepted as whole */
    rheo_verification v;
    OK(rheo_verify_memory(whole.bytes, whole.size, &v, &error));
    assert_int_equal(v.verdict, RHEO_UNREADABLE);
    free(whole.bytes);
}

static void a_damaged_or_blessed_recording_is_not_continued(void **state)
{
    (void)state;
    const run_kind *k = &kinds[0];
    const rheo_record_options options = options_of(k);
    const file whole = run_whole(k, STEPS);
    write_file(PATH, whole.bytes, whole.size);
    rheo_verification v;
    remove("test_continue_golden.rlog");
    OK(rheo_bless("test_continue_golden.rlog", PATH, "a test", false, &v, &error));
    const file blessed = read_and_remove("test_continue_golden.rlog");
    refuse(RHEO_ERROR_ARGUMENT, "blessed", &blessed, small, options);
    free(blessed.bytes);
    size_t at = 8; /* the type of the chunk in the middle */
    while (at < whole.size / 2) {
        uint64_t stored;
        memcpy(&stored, whole.bytes + at + 16, sizeof stored);
        at += 36 + (size_t)stored;
    }
    whole.bytes[at] ^= 1;
    refuse(RHEO_ERROR_FORMAT, "damaged", &whole, small, options);
    free(whole.bytes);
}

static void a_recording_that_is_being_written_is_not_continued(void **state)
{
    (void)state;
    rheo_world *world = small(), *other = small();
    rheo_recorder *recorder, *second;
    const rheo_record_options options = options_of(&kinds[0]);
    remove(PATH);
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "is being written", rheo_recorder_continue(&other, PATH, &options, &second, &error));
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    OK(rheo_recorder_continue(&other, PATH, &options, &second, &error)); /* the world has not changed */
    assert_int_equal(rheo_world_step_count(other), 1);
    /* While it is continued, it is being written. */
    rheo_world *third = small();
    REFUSED(RHEO_ERROR_ARGUMENT, "is being written",
            rheo_recorder_continue(&third, PATH, &options, &recorder, &error));
    OK(rheo_recorder_close(second, &error));
    rheo_world_destroy(world);
    rheo_world_destroy(other);
    rheo_world_destroy(third);
    remove(PATH);
}

/* A command to the world that is replaced does not make the recorder lose one to the world that replaces it. */
static void all_commands_after_continuing_are_recorded(void **state)
{
    (void)state;
    const rheo_record_options options = options_of(&kinds[0]);
    rheo_world *world = small();
    rheo_recorder *recorder;
    remove(PATH);
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    for (int i = 0; i < 3; i++)
        OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    world = small();
    OK(rheo_world_set(world, "fluid.stiffness", "400", &error));
    OK(rheo_world_set(world, "fluid.stiffness", "300", &error)); /* as it was */
    OK(rheo_recorder_continue(&world, PATH, &options, &recorder, &error));
    OK(rheo_world_set(world, "fluid.stiffness", "440", &error));
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    rheo_recording *r;
    rheo_verification v;
    OK(rheo_recording_open(PATH, &r, &error));
    assert_int_equal(rheo_recording_command_count(r), 1);
    rheo_recording_close(r);
    OK(rheo_verify(PATH, &v, &error));
    OK(rheo_verification_check(&v, 4, &error));
    remove(PATH);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_killed_at_any_byte_ends_with_the_same_bytes),
        cmocka_unit_test(a_run_whose_end_became_zeros_ends_with_the_same_bytes),
        cmocka_unit_test(a_run_closed_early_ends_with_the_same_bytes),
        cmocka_unit_test(a_recording_of_another_run_is_refused_and_unchanged),
        cmocka_unit_test(a_damaged_or_blessed_recording_is_not_continued),
        cmocka_unit_test(a_recording_that_is_being_written_is_not_continued),
        cmocka_unit_test(all_commands_after_continuing_are_recorded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
