/*
 * The ladder between the same bits and other physics: the rungs bits, rounding and step, and what a blessing keeps of it.
 *
 * A hook after each stage makes the library another program: it records a golden file, and the library without the hook is
 * what that program became.
 */
#define PATH "test_same.rlog"
#define OTHER "test_same_other.rlog"
#include "recorded_runs.h"

#include "record/same.h"

/* ---- Another program ---- */

typedef enum change_kind {
    NONE,
    ULP,    /* velocities are one ulp larger after the last stage that writes them */
    LARGER, /* they are larger by a part in a thousand */
    ONE, /* what is added to a field that only some particles have: the largest velocity is 1.0001 times as large */
} change_kind;

static struct program {
    change_kind change;
    uint64_t first; /* step from which the program differs */
} program;

static uint32_t last_that_writes(const rheo_world *w, rheo__fields field)
{
    uint32_t stage = w->stage_count - 1;
    while (stage > 0 && !(w->stage[stage].writes & field))
        stage--;
    return stage;
}

static rheo_real next_up(rheo_real x)
{
    return x == 0 ? x : rheo__unorder((rheo__real_bits)(rheo__order(x) + (x > 0 ? 1 : (rheo__real_bits)-1)));
}

static void sabotage(rheo_world *w, uint32_t stage)
{
    rheo_real *v = w->state.velocity;
    const size_t count = 3 * (size_t)w->state.particles;
    if (program.change == NONE || *w->state.step + 1 < program.first ||
        stage != last_that_writes(w, RHEO__BIT(velocity)))
        return;
    size_t largest = 0;
    for (size_t i = 0; i < count; i++) {
        if (program.change == ULP)
            v[i] = next_up(v[i]);
        if (program.change == LARGER)
            v[i] *= (rheo_real)1.001;
        largest = v[i] * v[i] > v[largest] * v[largest] ? i : largest;
    }
    if (program.change == ONE)
        v[largest] *= (rheo_real)(RHEO_DOUBLE ? 1 + 2e-11 : 1.01);
}

static void change_program(change_kind change, uint64_t first)
{
    program = (struct program){change, first};
}

/* ---- Recordings ---- */

typedef struct kind_of_world {
    const char *name;
    rheo_world *(*make)(void);
    rheo_history_kind kind;
    rheo_scheme scheme;
} kind_of_world;

static rheo_world *thickening(void)
{
    return make_world(5);
}

static const kind_of_world KINDS[] = {
    {"window", thickening, RHEO_HISTORY_WINDOW, RHEO_SCHEME_SUMMED},
    {"full", thickening, RHEO_HISTORY_FULL, RHEO_SCHEME_SUMMED},
    {"sequential", thickening, RHEO_HISTORY_WINDOW, RHEO_SCHEME_SEQUENTIAL},
    {"positions", thickening, RHEO_HISTORY_WINDOW, RHEO_SCHEME_POSITIONS},
    {"melting", melt, RHEO_HISTORY_WINDOW, RHEO_SCHEME_SUMMED},
};
enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS, STEPS = 12 };

static rheo_world *world_of_kind(const kind_of_world *k)
{
    kind = k->kind;
    scheme = k->scheme;
    rheo_world *world = k->make();
    kind = RHEO_HISTORY_WINDOW;
    scheme = RHEO_SCHEME_SUMMED;
    return world;
}

/* `set`: a command before step 4, or NULL. */
static void record_world(rheo_world *world, const char *path, uint64_t spacing, bool full, const char *set)
{
    rheo_recorder *recorder;
    const rheo_record_options options = {.scene = "same", .keyframe_spacing = spacing, .full = full, .force = true};
    remove(path); /* it may be blessed */
    OK(rheo_recorder_open(world, path, &options, &recorder, &error));
    for (int i = 0; i < STEPS; i++) {
        if (set && i == 3)
            OK(rheo_world_set(world, "gravity", set, &error));
        OK(rheo_recorder_step(recorder, &error));
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
}

static rheo_same_result result;

static rheo_sameness verdict(rheo_sameness at_least, const char *set)
{
    rheo_same_options options = rheo_default_same_options();
    options.at_least = at_least;
    options.set = &set;
    options.set_count = set != NULL;
    memset(&result, 0xA5, sizeof result);
    OK(rheo_same(PATH, &options, &result, &error));
    assert_int_equal(strncmp(result.message, rheo_sameness_name(result.verdict), 4), 0);
    return result.verdict;
}

#define VERDICT(expected, at_least, set)                                                              \
    do {                                                                                              \
        const rheo_sameness found = verdict(at_least, set);                                           \
        if (found != (expected))                                                                      \
            fail_msg("%s instead of %s: %s", rheo_sameness_name(found), rheo_sameness_name(expected), \
                     result.message);                                                                 \
    } while (0)

/* ---- Moving numbers by 1 ulp ---- */

static void a_move_is_one_ulp_and_undoes_itself(void **state)
{
    (void)state;
    rheo_real values[200], moved[200];
    int up = 0, changed = 0, other_seed = 0;
    for (int i = 0; i < 200; i++)
        moved[i] = values[i] = i < 4 ? (rheo_real)0 : (rheo_real)(i - 100) * (rheo_real)0.37;
    values[0] = moved[0] = -(rheo_real)0;
    rheo__same_move(moved, 200, 7, 1);
    for (int i = 0; i < 200; i++) {
        const uint64_t ulps = rheo__order(moved[i]) > rheo__order(values[i])
                                  ? (uint64_t)(rheo__order(moved[i]) - rheo__order(values[i]))
                                  : (uint64_t)(rheo__order(values[i]) - rheo__order(moved[i]));
        assert_int_equal(ulps, i < 4 || i == 100 ? 0 : 1);
        changed += ulps != 0;
        up += moved[i] > values[i];
    }
    assert_in_range((uintmax_t)up, 60, 135); /* a fair coin */
    rheo_real again[200];
    memcpy(again, values, sizeof values);
    rheo__same_move(again, 200, 8, 1);
    for (int i = 0; i < 200; i++)
        other_seed += again[i] != moved[i];
    assert_in_range((uintmax_t)other_seed, 60, 135);
    rheo__same_move(moved, 200, 7, 1);
    assert_memory_equal(moved, values, sizeof values); /* also the sign of zero */
    assert_int_equal(changed, 195);
}

static void a_moved_state_moves_back_to_the_bit(void **state)
{
    (void)state;
    for (int k = 0; k < KIND_COUNT; k++) {
        rheo_world *world = world_of_kind(&KINDS[k]);
        step(world, 6);
        const uint64_t before = rheo_world_hash(world);
        OK(rheo__same_move_state(world, 3, &error));
        for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
            if (rheo__state_has(&world->state, f) && (f == RHEO__FIELD_position || f == RHEO__FIELD_history_velocity))
                assert_int_not_equal(rheo_world_hash(world), before);
        OK(rheo__same_move_state(world, 3, &error));
        assert_int_equal(rheo_world_hash(world), before);
        rheo_world_destroy(world);
    }
}

/* ---- Rungs ---- */

static void the_same_program_gives_the_same_bits(void **state)
{
    (void)state;
    for (int k = 0; k < KIND_COUNT; k++) {
        record_world(world_of_kind(&KINDS[k]), PATH, 100, k % 2, NULL);
        VERDICT(RHEO_SAMENESS_BITS, RHEO_SAMENESS_BITS, NULL);
        assert_int_equal(result.bits_steps, STEPS);
        assert_true(result.bits_passed && !result.rounding.tried && !result.step.tried && !result.statistics.tried);
    }
}

static void a_program_that_rounds_otherwise_is_the_same_to_rounding(void **state)
{
    (void)state;
    for (int k = 0; k < KIND_COUNT; k++) {
        change_program(ULP, 3);
        record_world(world_of_kind(&KINDS[k]), PATH, 100, true, NULL);
        change_program(NONE, 0);
        VERDICT(RHEO_SAMENESS_DIFFERS, RHEO_SAMENESS_BITS, NULL);
        assert_int_equal(result.bits_steps, 2);
        VERDICT(RHEO_SAMENESS_ROUNDING, RHEO_SAMENESS_ROUNDING, NULL);
        assert_int_equal(result.rounding.compared, STEPS);
        assert_int_equal(result.rounding.interval, 1);
        if (!(result.rounding.worst.ratio > 0 && result.rounding.worst.ratio < 16))
            fail_msg("%s: %s", KINDS[k].name, result.message);
        assert_true(result.rounding.worst.step >= 3);
        assert_string_equal(result.rounding.first.field, "");
    }
}

/* The other way round: the golden file is of the library, and the program changed. */
static void it_does_not_matter_which_of_the_two_programs_recorded(void **state)
{
    (void)state;
    record_world(world_of_kind(&KINDS[0]), PATH, 100, true, NULL);
    change_program(ULP, 1);
    VERDICT(RHEO_SAMENESS_ROUNDING, RHEO_SAMENESS_ROUNDING, NULL);
    change_program(LARGER, 1);
    VERDICT(RHEO_SAMENESS_DIFFERS, RHEO_SAMENESS_ROUNDING, NULL);
    change_program(NONE, 0);
}

static void what_is_more_than_rounding_has_a_step_a_stage_and_a_field(void **state)
{
    (void)state;
    for (int k = 0; k < KIND_COUNT; k++)
        for (change_kind change = LARGER; change <= ONE; change++) {
            change_program(change, 5);
            rheo_world *world = world_of_kind(&KINDS[k]);
            char stage[32];
            snprintf(stage, sizeof stage, "%s", world->stage[last_that_writes(world, RHEO__BIT(velocity))].name);
            record_world(world, PATH, 100, true, NULL);
            change_program(NONE, 0);
            VERDICT(RHEO_SAMENESS_DIFFERS, RHEO_SAMENESS_ROUNDING, NULL);
            const rheo_same_ratio *first = &result.rounding.first;
            assert_int_equal(first->step, 5);
            assert_int_equal(strncmp(first->stage, stage, strlen(stage)), 0);
            /* A decision that falls otherwise is named, if that is the first. */
            assert_true(strcmp(first->field, "velocity") == 0 || strcmp(first->field, "position") == 0 ||
                        (result.rounding.decisions > 0 && first->field[0]));
            assert_true(first->ratio > 16 || result.rounding.decisions > 0);
            assert_false(result.rounding.passed);
        }
}

/* A larger limit lets it pass: the limit is what decides. */
static void the_limit_decides(void **state)
{
    (void)state;
    change_program(ONE, 1);
    record_world(world_of_kind(&KINDS[0]), PATH, 100, true, NULL);
    change_program(NONE, 0);
    rheo_same_options options = rheo_default_same_options();
    options.at_least = RHEO_SAMENESS_ROUNDING;
    OK(rheo_same(PATH, &options, &result, &error));
    assert_int_equal(result.verdict, RHEO_SAMENESS_DIFFERS);
    options.limit = 1e6;
    OK(rheo_same(PATH, &options, &result, &error));
    assert_int_equal(result.verdict, RHEO_SAMENESS_ROUNDING);
}

static void keyframes_that_are_near_are_enough_for_rounding(void **state)
{
    (void)state;
    for (int k = 0; k < KIND_COUNT; k++) {
        change_program(ULP, 1);
        record_world(world_of_kind(&KINDS[k]), PATH, 3, false, NULL);
        change_program(NONE, 0);
        VERDICT(RHEO_SAMENESS_ROUNDING, RHEO_SAMENESS_ROUNDING, NULL);
        assert_int_equal(result.rounding.interval, 3);
        assert_int_equal(result.rounding.compared, STEPS / 3);
        change_program(LARGER, 5);
        record_world(world_of_kind(&KINDS[k]), PATH, 3, false, NULL);
        change_program(NONE, 0);
        VERDICT(RHEO_SAMENESS_DIFFERS, RHEO_SAMENESS_ROUNDING, NULL);
        assert_int_equal(result.rounding.first.step, 6);
    }
    change_program(ULP, 1);
    record_world(world_of_kind(&KINDS[0]), PATH, 100, false, NULL); /* one keyframe is not */
    change_program(NONE, 0);
    VERDICT(RHEO_SAMENESS_DIFFERS, RHEO_SAMENESS_ROUNDING, NULL);
    assert_false(result.rounding.tried);
}

/* ---- Halving the step ---- */

/* Free fall: v += g dt, x += v dt. In two halves, x falls by 3/4 of g dt^2 instead of g dt^2. */
static void halves_of_free_fall_are_known(void **state)
{
    (void)state;
    const rheo_real position[3] = {0, 0, 0};
    rheo_world_def def = inert_def();
    def.step = 0.125;
    def.substeps = 1;
    def.gravity[1] = -8;
    rheo_world *world = world_of(def, 1, position, NULL);
    rheo__values values = {0};
    bool failed;
    OK(rheo__same_halves(world, &values, &failed, &error));
    assert_false(failed);
    NEAR(((rheo_real *)values.data[RHEO__FIELD_position])[1], -0.75 * 8 * 0.125 * 0.125, 1e-7);
    NEAR(((rheo_real *)values.data[RHEO__FIELD_velocity])[1], -1, 1e-7);
    assert_int_equal(rheo_world_step_count(world), 0);
    rheo__values_release(&values);
    rheo_world_destroy(world);
}

static void small_changes_are_below_the_error_of_a_step(void **state)
{
    (void)state;
    rheo_same_steps found;
    rheo_recording *r;
    rheo_same_options options = rheo_default_same_options();
    const char *small_change = "fluid.stiffness=300.01", *large_change = "fluid.stiffness=900";
    record_world(world_of_kind(&KINDS[0]), PATH, 100, true, NULL);
    OK(rheo_recording_open(PATH, &r, &error));
    options.set = &small_change;
    options.set_count = 1;
    OK(rheo__same_steps(r, &options, true, &found, &error));
    assert_true(found.tried && found.passed && found.compared == STEPS);
    assert_true(found.worst.ratio < 1);
    options.set = &large_change;
    OK(rheo__same_steps(r, &options, true, &found, &error));
    assert_true(found.tried && !found.passed && found.first.ratio > 1);
    rheo_recording_close(r);
}

/* Modes of a memory belong to the step, so this world has no halves. */
static void a_memory_of_modes_has_no_halves(void **state)
{
    (void)state;
    rheo_same_steps found;
    rheo_recording *r;
    const rheo_same_options options = rheo_default_same_options();
    record_world(world_of_kind(&KINDS[1]), PATH, 100, true, NULL);
    OK(rheo_recording_open(PATH, &r, &error));
    OK(rheo__same_steps(r, &options, true, &found, &error));
    assert_true(!found.tried && !found.passed);
    rheo_recording_close(r);
}

/* ---- Parameters of the new side ---- */

static void a_parameter_is_judged_like_a_program(void **state)
{
    (void)state;
    record_world(world_of_kind(&KINDS[0]), PATH, 100, true, NULL);
    VERDICT(RHEO_SAMENESS_BITS, RHEO_SAMENESS_ROUNDING, "gravity=[0, -9.81, 0]");
    VERDICT(RHEO_SAMENESS_ROUNDING, RHEO_SAMENESS_ROUNDING,
            RHEO_DOUBLE ? "gravity=[0, -9.810000000000002, 0]" : "gravity=[0, -9.810001, 0]");
    VERDICT(RHEO_SAMENESS_DIFFERS, RHEO_SAMENESS_ROUNDING, "gravity=[0, -9.9, 0]");
    assert_int_equal(result.rounding.first.step, 1);
}

/* A recorded command that sets the parameter would take the change back. */
static void recorded_commands_do_not_take_the_parameter_back(void **state)
{
    (void)state;
    record_world(world_of_kind(&KINDS[0]), PATH, 100, true, "[0, -5, 0]");
    VERDICT(RHEO_SAMENESS_BITS, RHEO_SAMENESS_ROUNDING, NULL);
    VERDICT(RHEO_SAMENESS_DIFFERS, RHEO_SAMENESS_BITS, "gravity=[0, -9.81, 0]"); /* as at the start */
    assert_int_equal(result.bits_steps, 3);
    VERDICT(RHEO_SAMENESS_DIFFERS, RHEO_SAMENESS_ROUNDING, "gravity=[0, -9.81, 0]");
    assert_int_equal(result.rounding.first.step, 4);
}

/* ---- A run that fails ---- */

static void a_failure_must_be_the_same(void **state)
{
    (void)state;
    rheo_world *world = thickening();
    rheo_recorder *recorder;
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.full = true, .force = true}, &recorder, &error));
    for (int i = 0; i < 4; i++)
        OK(rheo_recorder_step(recorder, &error));
    make_infinite(world);
    assert_int_equal(rheo_recorder_step(recorder, &why), RHEO_ERROR_STATE);
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    VERDICT(RHEO_SAMENESS_BITS, RHEO_SAMENESS_BITS, NULL);
    change_program(ULP, 1);
    VERDICT(RHEO_SAMENESS_ROUNDING, RHEO_SAMENESS_ROUNDING, NULL);
    change_program(NONE, 0);
    VERDICT(RHEO_SAMENESS_DIFFERS, RHEO_SAMENESS_ROUNDING, "step=1e-9"); /* then nothing becomes infinite */
}

/* ---- What never passes ---- */

static void nothing_reads_as_same_by_chance(void **state)
{
    (void)state;
    const rheo_same_result zero = {0};
    rheo_same_options options = rheo_default_same_options();
    for (rheo_sameness at_least = RHEO_SAMENESS_DIFFERS; at_least <= RHEO_SAMENESS_BITS; at_least++) {
        assert_true(zero.verdict < at_least);
        assert_int_equal(rheo_sameness_by_name(rheo_sameness_name(at_least)), at_least);
    }
    assert_int_equal(rheo_sameness_by_name("unknown"), RHEO_SAMENESS_UNKNOWN);
    assert_int_equal(rheo_sameness_by_name("bit"), RHEO_SAMENESS_UNKNOWN);
    assert_string_equal(rheo_sameness_name((rheo_sameness)77), "unknown");

    remove(PATH);
    REFUSED(RHEO_ERROR_FILE, PATH, rheo_same(PATH, NULL, &result, &error));
    assert_int_equal(result.verdict, RHEO_SAMENESS_UNKNOWN);
    record_world(world_of_kind(&KINDS[0]), PATH, 100, true, NULL);
    options.at_least = RHEO_SAMENESS_UNKNOWN;
    REFUSED(RHEO_ERROR_ARGUMENT, "at_least", rheo_same(PATH, &options, &result, &error));
    options = rheo_default_same_options();
    options.limit = 0.5;
    REFUSED(RHEO_ERROR_ARGUMENT, "limit", rheo_same(PATH, &options, &result, &error));
    options = rheo_default_same_options();
    options.members = 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "members", rheo_same(PATH, &options, &result, &error));
    options = rheo_default_same_options();
    options.set_count = 1;
    options.set = (const char *const[]){"gravity"};
    REFUSED(RHEO_ERROR_ARGUMENT, "NAME=VALUE", rheo_same(PATH, &options, &result, &error));
    options.set = (const char *const[]){"gravitation=3"};
    REFUSED(RHEO_ERROR_ARGUMENT, "gravitation", rheo_same(PATH, &options, &result, &error));
    options.set = (const char *const[]){"scheme=sequential"};
    REFUSED(RHEO_ERROR_ARGUMENT, "fixed", rheo_same(PATH, &options, &result, &error));
    assert_int_equal(result.verdict, RHEO_SAMENESS_UNKNOWN);

    size_t size;
    uint8_t *bytes = read_file(PATH, &size);
    write_file(PATH, bytes, size - 10);
    REFUSED(RHEO_ERROR_FORMAT, "truncated", rheo_same(PATH, NULL, &result, &error));
    assert_int_equal(result.verdict, RHEO_SAMENESS_UNKNOWN);
    free(bytes);
}

static bool stop(const char *task, uint64_t done, uint64_t total, void *user)
{
    (void)total;
    return strcmp(task, user) != 0 || done < 3;
}

static void a_comparison_that_is_stopped_has_no_verdict(void **state)
{
    (void)state;
    change_program(ULP, 4);
    record_world(world_of_kind(&KINDS[0]), PATH, 100, true, NULL);
    change_program(NONE, 0);
    char tasks[][16] = {"verifying", "comparing"};
    for (int i = 0; i < 2; i++) {
        const rheo_progress before = rheo_use_progress((rheo_progress){stop, tasks[i]});
        REFUSED(RHEO_ERROR_STOPPED, "stopped", rheo_same(PATH, NULL, &result, &error));
        rheo_use_progress(before);
        assert_int_equal(result.verdict, RHEO_SAMENESS_UNKNOWN);
    }
}

/* ---- Blessings ---- */

static rheo_blessing last_blessing(rheo_recording **r)
{
    rheo_blessing blessing = {0};
    OK(rheo_recording_open(PATH, r, &error));
    OK(rheo_recording_blessing(*r, rheo_recording_blessing_count(*r) - 1, &blessing));
    return blessing;
}

static rheo_result bless(rheo_sameness at_least, bool required, rheo_error *why_not)
{
    rheo_verification v;
    rheo_same_options options = rheo_default_same_options();
    options.at_least = at_least;
    return rheo_bless_same(PATH, OTHER, "a test", false, &options, required, &result, &v, why_not);
}

/* PATH is of a program that rounds otherwise, OTHER of this one. */
static void record_both(change_kind change)
{
    change_program(change, 3);
    record_world(world_of_kind(&KINDS[0]), PATH, 100, true, NULL);
    change_program(NONE, 0);
    record_world(world_of_kind(&KINDS[0]), OTHER, 100, true, NULL);
}

static void a_blessing_keeps_the_verdict(void **state)
{
    (void)state;
    rheo_recording *r;
    record_both(ULP);
    OK(bless(RHEO_SAMENESS_ROUNDING, true, &error));
    assert_int_equal(result.verdict, RHEO_SAMENESS_ROUNDING);
    rheo_blessing blessing = last_blessing(&r);
    assert_int_equal(blessing.verdict, RHEO_SAMENESS_ROUNDING);
    assert_int_equal(blessing.at_least, RHEO_SAMENESS_ROUNDING);
    assert_string_equal(blessing.same, result.message);
    rheo_recording_close(r);

    /* The next blessing keeps it, too; a plain one has none. */
    rheo_verification v;
    change_program(LARGER, 1);
    record_world(world_of_kind(&KINDS[0]), OTHER, 100, true, NULL);
    OK(rheo_bless(PATH, OTHER, "another", false, &v, &error));
    change_program(NONE, 0);
    blessing = last_blessing(&r);
    assert_int_equal(blessing.verdict, RHEO_SAMENESS_UNKNOWN);
    assert_string_equal(blessing.same, "");
    OK(rheo_recording_blessing(r, 0, &blessing));
    assert_int_equal(blessing.verdict, RHEO_SAMENESS_ROUNDING);
    rheo_recording_close(r);
}

/* A reader that does not know the chunk skips it: it is optional, and the rest of the file is as without it. */
static void the_verdict_is_an_optional_chunk(void **state)
{
    (void)state;
    rheo_recording *r;
    record_both(ULP);
    OK(bless(RHEO_SAMENESS_ROUNDING, true, &error));
    OK(rheo_recording_open(PATH, &r, &error));
    int found = 0;
    rheo__chunk chunk;
    bool truncated;
    for (uint64_t offset = RHEO__MAGIC_SIZE; offset < r->reader.size; offset = chunk.end) {
        OK(rheo__chunk_at(&r->reader, offset, &chunk, &truncated, &error));
        if (chunk.type == RHEO__SAME) {
            assert_int_equal(chunk.flags & RHEO__CHUNK_OPTIONAL, RHEO__CHUNK_OPTIONAL);
            found++;
        }
    }
    assert_int_equal(found, 1);
    rheo_recording_close(r);
}

static void a_blessing_refuses_less_than_what_is_asked_for(void **state)
{
    (void)state;
    record_both(LARGER);
    file before = {0}, after = {0};
    before.bytes = read_file(PATH, &before.size);
    REFUSED(RHEO_ERROR_DIFFERS, "at least rounding", bless(RHEO_SAMENESS_ROUNDING, true, &error));
    after.bytes = read_file(PATH, &after.size);
    assert_int_equal(before.size, after.size);
    assert_memory_equal(before.bytes, after.bytes, before.size);
    free(before.bytes);
    free(after.bytes);
    OK(bless(RHEO_SAMENESS_ROUNDING, false, &error)); /* only told */
    rheo_recording *r;
    const rheo_blessing blessing = last_blessing(&r);
    assert_int_equal(blessing.verdict, RHEO_SAMENESS_DIFFERS);
    rheo_recording_close(r);
}

/* If the scene has changed, too, the verdict would not tell how far the new recording is from the old one. */
static void recordings_of_other_runs_have_no_verdict(void **state)
{
    (void)state;
    record_both(ULP);
    record_world(world_of_kind(&KINDS[0]), OTHER, 100, true, "[0, -5, 0]");
    REFUSED(RHEO_ERROR_DIFFERS, "not of the same run", bless(RHEO_SAMENESS_STATISTICS, true, &error));
    OK(bless(RHEO_SAMENESS_STATISTICS, false, &error));
    assert_int_equal(result.verdict, RHEO_SAMENESS_UNKNOWN);
    rheo_recording *r;
    const rheo_blessing blessing = last_blessing(&r);
    assert_int_equal(blessing.verdict, RHEO_SAMENESS_UNKNOWN);
    rheo_recording_close(r);
}

static int remove_files(void **state)
{
    (void)state;
    remove(PATH);
    remove(OTHER);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_move_is_one_ulp_and_undoes_itself),
        cmocka_unit_test(a_moved_state_moves_back_to_the_bit),
        cmocka_unit_test(the_same_program_gives_the_same_bits),
        cmocka_unit_test(a_program_that_rounds_otherwise_is_the_same_to_rounding),
        cmocka_unit_test(it_does_not_matter_which_of_the_two_programs_recorded),
        cmocka_unit_test(what_is_more_than_rounding_has_a_step_a_stage_and_a_field),
        cmocka_unit_test(the_limit_decides),
        cmocka_unit_test(keyframes_that_are_near_are_enough_for_rounding),
        cmocka_unit_test(halves_of_free_fall_are_known),
        cmocka_unit_test(small_changes_are_below_the_error_of_a_step),
        cmocka_unit_test(a_memory_of_modes_has_no_halves),
        cmocka_unit_test(a_parameter_is_judged_like_a_program),
        cmocka_unit_test(recorded_commands_do_not_take_the_parameter_back),
        cmocka_unit_test(a_failure_must_be_the_same),
        cmocka_unit_test(nothing_reads_as_same_by_chance),
        cmocka_unit_test(a_comparison_that_is_stopped_has_no_verdict),
        cmocka_unit_test(a_blessing_keeps_the_verdict),
        cmocka_unit_test(the_verdict_is_an_optional_chunk),
        cmocka_unit_test(a_blessing_refuses_less_than_what_is_asked_for),
        cmocka_unit_test(recordings_of_other_runs_have_no_verdict),
    };
    rheo__sabotage = sabotage;
    return cmocka_run_group_tests_name("same", tests, NULL, remove_files);
}
