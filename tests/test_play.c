/* Steps stage by stage, and moving through recordings. A step has the same state, wherever the player came from. */
#define _POSIX_C_SOURCE 200809L /* clock_gettime() */
#include <float.h>
#include <time.h>

#include "core/state.h"
#include "forge.h"
#include "record/recording.h"
#include "support.h"
#include "world/stage_runs.h"

enum { STEPS = 60 };

/*
 * One sweep of such springs overflows a float in scheme sequential: each spring of a row multiplies the displacement of
 * the previous one. Scheme summed softens them.
 */
static const char *const TOO_STIFF = "1e30";

/* Doubles survive a few such sweeps, so the failing step and stage are not known in advance. */
static void needs_float(void)
{
    if (sizeof(rheo_real) != 4)
        skip();
}
static const char *const PATH = "test_play.rlog";
static rheo_error why; /* error of calls that may be refused */

/* Commands in between, which every seek must repeat. */
static void command(rheo_world *world, uint64_t step)
{
    const double impulse[3] = {300, 0, 100};
    const rheo_real position[6] = {3, 18, 3, 12, 18, 12}, velocity[6] = {0, -9, 0, 1, -8, 0};
    if (step == 11)
        OK(rheo_world_push_body(world, 0, impulse, NULL, &error));
    if (step == 23)
        OK(rheo_world_add_particles(world, 2, position, velocity, &error));
    if (step == 37)
        OK(rheo_world_set(world, "fluid.linear_viscosity", "0.7", &error));
    if (step == 41)
        OK(rheo_world_set(world, "step", "0.02", &error));
}

/* hashes has STEPS + 1 elements. */
static void record(bool full, uint64_t spacing, uint64_t *hashes)
{
    rheo_world *world = lively_world();
    rheo_recorder *recorder;
    rheo_record_options options = {.scene = "play", .keyframe_spacing = spacing, .full = full, .force = true};
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    for (uint64_t step = 0; step < STEPS; step++) {
        hashes[step] = rheo_world_hash(world);
        command(world, step);
        OK(rheo_recorder_step(recorder, &error));
    }
    hashes[STEPS] = rheo_world_hash(world);
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
}

/* Opens a player of such a recording; keyframes are 17 steps apart. */
static rheo_player *play(bool full, uint64_t *hashes, rheo_recording **recording)
{
    rheo_player *player;
    record(full, 17, hashes);
    OK(rheo_recording_open(PATH, recording, &error));
    OK(rheo_player_open(*recording, NULL, &player, &error));
    return player;
}

static void stands_at(const rheo_player *player, uint64_t step, const uint64_t *hashes)
{
    const rheo_world *world = rheo_player_world(player);
    assert_int_equal(rheo_world_step_count(world), step);
    assert_int_equal(rheo_world_stages_done(world), 0);
    if (rheo_world_hash(world) != hashes[step])
        fail_msg("step %u does not have its hash", (unsigned)step);
}

/* ---- Stage by stage ---- */

static void stages_one_by_one_make_the_same_step(void **unused)
{
    (void)unused;
    rheo_world *whole = lively_world(), *parts = lively_world();
    uint32_t stage, made = 0;
    for (int n = 0; n < 5; n++) {
        step(whole, 1);
        made = 0;
        do {
            assert_int_equal(rheo_world_stages_done(parts), made++);
            OK(rheo_world_step_stage(parts, &stage, &error));
        } while (rheo_world_stages_done(parts));
        const uint64_t substeps = *parts->state.substeps;
        assert_true(substeps >= 2 && made == rheo__world_stage_runs(parts, substeps));
        assert_int_equal(stage, rheo_world_stage_count(parts) - 1);
        assert_true(rheo_world_hash(parts) == rheo_world_hash(whole));
        for (uint32_t m = 0; m < rheo_world_metric_count(whole); m++)
            assert_true(rheo_world_metric(parts, m) == rheo_world_metric(whole, m));
    }
    /* Half a step, then the rest at once. */
    for (uint32_t i = 0; i < made / 2; i++)
        OK(rheo_world_step_stage(parts, &stage, &error));
    step(parts, 1);
    step(whole, 1);
    assert_true(rheo_world_hash(parts) == rheo_world_hash(whole));
    rheo_world_destroy(whole);
    rheo_world_destroy(parts);
}

/* The stages of a world take part of the time that passes, each some of it, until the times are reset. */
static void stages_are_timed(void **unused)
{
    (void)unused;
    struct timespec begin, end;
    rheo_world *world = lively_world();
    rheo_stage_info info;
    for (int round = 0; round < 2; round++) {
        rheo_world_reset_times(world);
        clock_gettime(CLOCK_MONOTONIC, &begin);
        step(world, 5);
        clock_gettime(CLOCK_MONOTONIC, &end);
        double seconds = 0;
        for (uint32_t i = 0; i < rheo_world_stage_count(world); i++) {
            OK(rheo_world_stage(world, i, &info));
            assert_true(info.calls >= 5 && info.seconds > 0);
            seconds += info.seconds;
        }
        const double passed = (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
        assert_true(seconds <= passed);
    }
    rheo_world_reset_times(world);
    for (uint32_t i = 0; i < rheo_world_stage_count(world); i++) {
        OK(rheo_world_stage(world, i, &info));
        assert_true(info.calls == 0 && info.seconds == 0);
    }
    assert_int_equal(rheo_world_stage(world, rheo_world_stage_count(world), &info), RHEO_ERROR_ARGUMENT);
    rheo_world_destroy(world);
}

static void the_middle_of_a_step_takes_no_command_and_is_not_saved(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    rheo_recorder *recorder;
    uint32_t stage;
    void *bytes;
    size_t size;
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true}, &recorder, &error));
    OK(rheo_world_step_stage(world, &stage, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "middle of step 1, after stage ball_push",
            rheo_world_set(world, "gravity", "[0, 0, 0]", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "cannot be saved", rheo_world_save_memory(world, "", &bytes, &size, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "cannot be recorded", rheo_recorder_step(recorder, &error));
    rheo_recorder *other;
    REFUSED(RHEO_ERROR_ARGUMENT, "cannot begin a recording",
            rheo_recorder_open(world, "x.rlog", NULL, &other, &error));
    step(world, 1);
    OK(rheo_world_set(world, "gravity", "[0, 0, 0]", &error));
    rheo_recorder_close(recorder, NULL);
    rheo_world_destroy(world);
}

/*
 * The springs are so stiff that one sweep overflows. The stage is reported whether the step is made at once or in
 * parts.
 */
static void the_failed_stage_is_named(void **unused)
{
    (void)unused;
    needs_float();
    rheo_world *world = sequential_world();
    rheo_failure failure;
    step(world, 3);
    assert_false(rheo_world_failure(world, &failure));
    uint64_t hash = rheo_world_hash(world);
    char stiffness[96];
    OK(rheo_world_def_get(rheo_world_definition(world), "springs.stiffness", stiffness, sizeof stiffness));
    OK(rheo_world_set(world, "springs.stiffness", TOO_STIFF, &error));
    REFUSED(RHEO_ERROR_STATE, "step 4 went bad: after stage spring_displacement position of particle",
            rheo_world_step(world, &error));
    assert_true(rheo_world_failure(world, &failure) && failure.step == 4 &&
                failure.location == RHEO_LOCATION_PARTICLE);
    assert_string_equal(failure.stage, "spring_displacement");
    assert_string_equal(failure.field, "position");
    assert_true(rheo_world_hash(world) == hash);

    rheo_result result = RHEO_OK;
    uint32_t stage = 0;
    while (result == RHEO_OK)
        result = rheo_world_step_stage(world, &stage, &why);
    rheo_failure again;
    assert_true(result == RHEO_ERROR_STATE && rheo_world_failure(world, &again));
    assert_string_equal(again.stage, failure.stage);
    assert_true(again.id == failure.id && again.component == failure.component && again.step == 4);
    assert_true(rheo_world_stages_done(world) == 0 && rheo_world_hash(world) == hash);
    OK(rheo_world_set(world, "springs.stiffness", stiffness, &error));
    step(world, 1);
    assert_false(rheo_world_failure(world, &failure));
    rheo_world_destroy(world);
}

/* In scheme summed the failure names the substep, whether the step is made at once or in parts. */
static void the_failed_substep_is_named(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    def.substeps = 4;
    /* Its position is 0.4, 0.8, 1.2 times the largest number after 1, 2, 3 substeps. */
    const rheo_real fast = (rheo_real)0.8 * (sizeof(rheo_real) == 4 ? (rheo_real)FLT_MAX : (rheo_real)DBL_MAX);
    rheo_world *world = world_of(def, 2, (rheo_real[]){0, 0, 0, 1, 0, 0}, (rheo_real[]){0, 0, 0, 0, fast, 0});
    OK(rheo_world_set(world, "step", "2", &error));
    const uint64_t hash = rheo_world_hash(world);
    assert_int_equal(rheo_world_step(world, &why), RHEO_ERROR_STATE);
    assert_non_null(strstr(why.message, "step 1 went bad: after stage prediction@3 position of particle 1"));
    rheo_failure failure;
    assert_true(rheo_world_failure(world, &failure) && failure.step == 1);
    rheo_error again;
    rheo_result result = RHEO_OK;
    uint32_t stage, made = 0;
    for (; result == RHEO_OK; made++)
        result = rheo_world_step_stage(world, &stage, &again);
    assert_true(result == RHEO_ERROR_STATE && made == 1 + 3 * 2); /* substeps; gravity and prediction of each */
    assert_string_equal(why.message, again.message);
    assert_true(rheo_world_hash(world) == hash);
    OK(rheo_world_set(world, "step", "0.5", &error));
    step(world, 1);
    assert_false(rheo_world_failure(world, &failure));
    rheo_world_destroy(world);
}

/* ---- Players ---- */

static void every_step_is_reached_from_every_other(void **unused)
{
    (void)unused;
    for (int full = 0; full < 2; full++) {
        uint64_t hashes[STEPS + 1];
        rheo_recording *recording;
        rheo_player *player = play(full, hashes, &recording);
        stands_at(player, 0, hashes);
        for (uint64_t n = 1; n <= STEPS; n++) {
            OK(rheo_player_step(player, &error));
            stands_at(player, n, hashes);
        }
        REFUSED(RHEO_ERROR_ARGUMENT, "no step 61", rheo_player_step(player, &error));
        for (uint64_t n = STEPS; n-- > 0;) {
            OK(rheo_player_step_back(player, &error));
            stands_at(player, n, hashes);
        }
        REFUSED(RHEO_ERROR_ARGUMENT, "no step before 0", rheo_player_step_back(player, &error));
        uint64_t at = 0;
        for (int n = 0; n < 100; n++) {
            at = (at * 37 + 11) % (STEPS + 1);
            OK(rheo_player_seek(player, at, &error));
            stands_at(player, at, hashes);
        }
        REFUSED(RHEO_ERROR_ARGUMENT, "it has 0 to 60", rheo_player_seek(player, STEPS + 1, &error));
        stands_at(player, at, hashes);
        rheo_player_close(player);
        rheo_recording_close(recording);
    }
    remove(PATH);
}

/* Sums that a step makes ahead for the next ones are of no use if these are loaded, not made. */
static void a_step_is_the_same_after_steps_that_are_loaded(void **unused)
{
    (void)unused;
    uint64_t hashes[STEPS + 1];
    rheo_recording *recording;
    rheo_player *player;
    record(true, 1000, hashes);
    OK(rheo_recording_open(PATH, &recording, &error));
    OK(rheo_player_open(recording, NULL, &player, &error));
    for (uint64_t first = 25; first < 33; first++)
        for (uint64_t loaded = 0; loaded < 20; loaded++) {
            const uint64_t next = first + loaded + 1;
            OK(rheo_player_seek_stage(player, first, "history", &error));
            OK(rheo_player_seek(player, next - 1, &error));
            OK(rheo_player_seek_stage(player, next, "history", &error));
            stands_at(player, next, hashes);
        }
    rheo_player_close(player);
    rheo_recording_close(recording);
    remove(PATH);
}

/* ---- The cost of moves ---- */

static bool count_steps(const char *task, uint64_t done, uint64_t total, void *user)
{
    (void)done;
    (void)total;
    *(uint64_t *)user += strcmp(task, "simulating") == 0;
    return true;
}

#define COSTS(steps, call)                                                                        \
    do {                                                                                          \
        uint64_t made = 0;                                                                        \
        rheo_use_progress((rheo_progress){count_steps, &made});                                   \
        OK(call);                                                                                 \
        rheo_use_progress((rheo_progress){0});                                                    \
        if (made != (uint64_t)(steps))                                                            \
            fail_msg("%s: simulates %u steps, not %u", #call, (unsigned)made, (unsigned)(steps)); \
    } while (0)

/* A player goes on from where it stands or from the nearest keyframe before its aim, and makes no other step. */
static void a_seek_makes_only_the_steps_in_between(void **unused)
{
    (void)unused;
    uint64_t hashes[STEPS + 1], at = 0;
    rheo_recording *recording;
    rheo_player *player = play(false, hashes, &recording);
    for (int n = 0; n < 100; n++) {
        const uint64_t aim = n % 3 ? (at * 37 + 11) % (STEPS + 1) : at + (at < STEPS), keyframe = aim / 17 * 17;
        COSTS(aim - (at > aim || at < keyframe ? keyframe : at), rheo_player_seek(player, aim, &error));
        stands_at(player, at = aim, hashes);
    }
    COSTS(22 - 17, (rheo_player_seek(player, 0, &error), rheo_player_seek(player, 22, &error)));
    COSTS(1, rheo_player_step(player, &error));
    /* Steps that are made stage by stage are not counted. */
    COSTS(0, rheo_player_seek_stage(player, 24, "viscosity", &error));
    COSTS(0, rheo_player_seek_stage(player, 24, "densities@2", &error));
    COSTS(0, rheo_player_seek_stage(player, 24, "forces@2", &error));
    COSTS(0, rheo_player_seek_stage(player, 24, "forces@2", &error));
    COSTS(23 - 17, rheo_player_seek_stage(player, 24, "densities@2", &error));
    COSTS(23 - 17, rheo_player_seek_stage(player, 24, "forces", &error));
    COSTS(22 - 17, rheo_player_seek_stage(player, 23, "forces", &error));
    COSTS(0, rheo_player_step(player, &error));
    stands_at(player, 23, hashes);
    rheo_player_close(player);
    rheo_recording_close(recording);
    remove(PATH);
}

/*
 * The first step back behind a keyframe keeps states at equal distances, at most 16, for those that follow. `spacing` is
 * that of the keyframes.
 */
static void check_steps_back(uint64_t spacing, uint64_t from)
{
    enum { KEPT = 16 };
    uint64_t hashes[STEPS + 1], first = 0, stride = 0; /* first that is kept behind a keyframe; 0: none is kept */
    rheo_recording *recording;
    rheo_player *player;
    record(false, spacing, hashes);
    OK(rheo_recording_open(PATH, &recording, &error));
    OK(rheo_player_open(recording, NULL, &player, &error));
    OK(rheo_player_seek(player, from, &error));
    for (uint64_t n = from; n-- > 0;) {
        const uint64_t way = n % spacing;
        const bool begins = n + 1 == from || (n + 1) % spacing == 0;
        if (begins) {
            stride = way < KEPT ? 0 : way / KEPT + 1;
            first = stride && way % stride ? way % stride : stride; /* a keyframe itself needs no copy */
        }
        const uint64_t cost = begins || !stride || way < first ? way : (way - first) % stride;
        COSTS(cost, rheo_player_step_back(player, &error));
        stands_at(player, n, hashes);
    }
    rheo_player_close(player);
    rheo_recording_close(recording);
    remove(PATH);
}

static void steps_back_make_few_steps(void **unused)
{
    (void)unused;
    check_steps_back(1000, STEPS);
    check_steps_back(29, STEPS);
    check_steps_back(1000, 17); /* a way of 16 steps is the shortest for which states are kept */
    check_steps_back(1000, 16);
}

/* A metric that only simulation measures is read from the recording along with a stored state. */
static void metrics_come_with_the_state(void **unused)
{
    (void)unused;
    for (int full = 0; full < 2; full++) {
        uint64_t hashes[STEPS + 1];
        rheo_recording *recording;
        rheo_player *player = play(full, hashes, &recording);
        for (uint64_t n = 1; n <= STEPS; n += 3) {
            double metrics[64];
            OK(rheo_player_seek(player, n, &error));
            OK(rheo_recording_metrics(recording, n, metrics, &error));
            for (uint32_t i = 0; i < rheo_recording_metric_count(recording); i++)
                if (rheo_world_metric(rheo_player_world(player), i) != metrics[i])
                    fail_msg("step %u: %s", (unsigned)n, rheo_recording_metric_name(recording, i));
        }
        rheo_player_close(player);
        rheo_recording_close(recording);
    }
    remove(PATH);
}

static void stages_are_played_inside_a_step(void **unused)
{
    (void)unused;
    uint64_t hashes[STEPS + 1];
    rheo_recording *recording;
    rheo_player *player = play(false, hashes, &recording);
    /* A separate world for comparison: step 24 has commands. */
    rheo_world *own;
    uint32_t stage;
    OK(rheo_recording_world(recording, 23, NULL, &own, &error));
    command(own, 23);
    char name[32] = "";
    do {
        const uint64_t stage_run = own->stage_runs_done;
        OK(rheo_world_step_stage(own, &stage, &error));
        rheo__world_stage_run_name(own, stage_run, name);
        OK(rheo_player_seek_stage(player, 24, name, &error));
        const rheo_world *there = rheo_player_world(player);
        assert_true(rheo_world_hash(there) == rheo_world_hash(own));
        assert_int_equal(rheo_world_stages_done(there), rheo_world_stages_done(own));
    } while (rheo_world_stages_done(own));
    assert_string_equal(name, "history"); /* the end of the step */
    stands_at(player, 24, hashes);
    /* Seeks back into the middle, on to the end, and from the middle to another step. */
    OK(rheo_player_seek_stage(player, 24, "densities@2", &error));
    OK(rheo_player_seek_stage(player, 24, "viscosity", &error));
    assert_int_equal(rheo_world_stages_done(rheo_player_world(player)), 4);
    OK(rheo_player_seek_stage(player, 24, "history", &error)); /* the end of the step again */
    stands_at(player, 24, hashes);
    OK(rheo_player_seek_stage(player, 24, "forces", &error)); /* of the first substep */
    assert_int_equal(rheo_world_stages_done(rheo_player_world(player)), 5 + 6);
    OK(rheo_player_seek_stage(player, 24, "viscosity", &error));
    OK(rheo_player_step(player, &error));
    stands_at(player, 24, hashes);
    OK(rheo_player_stage(player, &stage, &error));
    assert_int_equal(stage, 0);
    OK(rheo_player_step_back(player, &error));
    stands_at(player, 23, hashes);
    OK(rheo_player_seek_stage(player, 24, "densities@2", &error));
    OK(rheo_player_seek(player, 24, &error));
    stands_at(player, 24, hashes);
    REFUSED(RHEO_ERROR_ARGUMENT, "no stage \"densty\"; the stages of this world are ball_push, neighbours",
            rheo_player_seek_stage(player, 24, "densty", &error));
    /* A number of a substep is one of 64 bits; a larger one must not wrap round to a small one. */
    static const char *const none[] = {
        "densities@0",          "densities@", "densities@1x", "densities@-1", "densities@18446744073709551617",
        "densities@42949672960"};
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        REFUSED(RHEO_ERROR_ARGUMENT, "is not a stage; after the @ give the number of a substep",
                rheo_player_seek_stage(player, 24, none[i], &error));
    assert_int_equal(rheo_player_seek_stage(player, 24, "densities@42949672950", &why), RHEO_ERROR_ARGUMENT);
    assert_false(says(why.message, "is not a stage"));
    REFUSED(RHEO_ERROR_ARGUMENT, "no step 0 to look into", rheo_player_seek_stage(player, 0, "densities@2", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "no step 61 to look into",
            rheo_player_seek_stage(player, STEPS + 1, "densities@2", &error));
    OK(rheo_player_seek(player, STEPS, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "no step after 60", rheo_player_stage(player, &stage, &error));
    rheo_world_destroy(own);
    rheo_player_close(player);
    rheo_recording_close(recording);
    remove(PATH);
}

/* A stage that does not reproduce one of its hashes is named with the field, whichever it is; so is a missing hash. */
/*
 * Stored states are taken without simulating, so the sums that a stage made for the next steps may be of long before: it
 * used to read past its rows.
 */
static void steps_are_played_after_others_that_were_not_simulated(void **unused)
{
    (void)unused;
    uint64_t hashes[STEPS + 1];
    rheo_recording *r;
    rheo_player *player;
    record(true, 100, hashes);
    OK(rheo_recording_open(PATH, &r, &error));
    for (uint64_t gap = 1; gap < STEPS - 1; gap++) {
        OK(rheo_player_open(r, NULL, &player, &error));
        for (uint64_t step = 1; step <= STEPS; step += gap) {
            uint32_t stage;
            OK(rheo_player_seek(player, step - 1, &error));
            do
                OK(rheo_player_stage(player, &stage, &error));
            while (rheo_world_stages_done(rheo_player_world(player)) > 0);
            stands_at(player, step, hashes);
        }
        rheo_player_close(player);
    }
    rheo_recording_close(r);
    remove(PATH);
}

static void the_stage_with_another_hash_is_named(void **unused)
{
    (void)unused;
    enum { ROOM = 1 << 22 };
    rheo_world *world = lively_world();
    rheo_recorder *recorder;
    void *bytes;
    size_t size, hashes = 1, named = 0;
    uint8_t *other = malloc(ROOM);
    step(world, 2); /* the recording does not begin with step 0 */
    OK(rheo_recorder_open_memory(world, NULL, &recorder, &error));
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close_memory(recorder, &bytes, &size, &error));
    for (size_t k = 0; k < 2 * hashes; k++) {
        forged f;
        rheo_recording *r;
        rheo_player *player;
        uint32_t stage;
        char name[32], expected[128];
        rheo__field_id field;
        forge_open(&f, bytes, size, ROOM);
        forged_chunk *c = forge_find(&f, RHEO__STEP, 0);
        OK(rheo_recording_open_memory(bytes, size, &r, &error));
        OK(rheo__recording_read_step(r, 0, &error));
        hashes = r->expected_count;
        const size_t wrong = k % hashes;
        rheo__world_trace_entry(world, rheo__world_trace_substeps(world, hashes), wrong, name, &field);
        rheo_recording_close(r);
        assert_true(hashes > 10 && c->size >= 8 + 8 * hashes);
        if (k < hashes) {
            c->data[8 + 8 * wrong] ^= 1;
        } else {
            forge_put(c->data + 4, wrong, 4);
            memmove(c->data + 8 + 8 * wrong, c->data + 8 + 8 * hashes, c->size - 8 - 8 * hashes);
            c->size -= 8 * (hashes - wrong);
        }
        const size_t length = forge_write(&f, true, other, ROOM);
        forge_release(&f);
        if (rheo_recording_open_memory(other, length, &r, &why) != RHEO_OK || !rheo_recording_get_info(r).complete) {
            assert_true(k >= hashes); /* a count of hashes that no number of substeps has */
            rheo_recording_close(r);
            continue;
        }
        OK(rheo_player_open(r, NULL, &player, &error));
        rheo_result result = RHEO_OK;
        do
            result = rheo_player_stage(player, &stage, &why);
        while (result == RHEO_OK && rheo_world_stages_done(rheo_player_world(player)));
        if (result == RHEO_ERROR_FORMAT && k >= hashes) { /* the reader noticed it */
            rheo_player_close(player);
            rheo_recording_close(r);
            continue;
        }
        assert_int_equal(result, RHEO_ERROR_DIFFERS);
        named++;
        snprintf(expected, sizeof expected, "step 3 is not as it was recorded: stage %s gives another %s", name,
                 rheo__field_table[field].name);
        if (strcmp(why.message, expected) != 0)
            fail_msg("hash %zu: \"%s\" is not \"%s\"", k, why.message, expected);
        rheo_player_close(player);
        rheo_recording_close(r);
    }
    assert_true(named >= hashes);
    free(bytes);
    free(other);
    rheo_world_destroy(world);
}

/* ---- Failed runs ---- */

/*
 * Records until the springs, made too stiff ahead of step 8, end the run. Returns the hash of the last valid state.
 */
static uint64_t record_failure(bool full, bool command_first)
{
    rheo_world *world = sequential_world();
    rheo_recorder *recorder;
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.full = full, .force = true}, &recorder, &error));
    for (int i = 0; i < 7; i++)
        OK(rheo_recorder_step(recorder, &error));
    uint64_t hash = rheo_world_hash(world);
    if (command_first) {
        OK(rheo_world_set(world, "springs.stiffness", TOO_STIFF, &error));
    } else {
        /* The run lasts a few more steps without a command. */
        OK(rheo_world_set(world, "history.stiffness", "1e3", &error));
        rheo_result result = RHEO_OK;
        for (int i = 0; i < 500 && result == RHEO_OK; i++) {
            hash = rheo_world_hash(world);
            result = rheo_recorder_step(recorder, &why);
        }
        assert_int_equal(result, RHEO_ERROR_STATE);
    }
    assert_int_equal(rheo_recorder_step(recorder, &why), RHEO_ERROR_STATE);
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    return hash;
}

static void a_failed_run_names_its_step_and_stage(void **unused)
{
    (void)unused;
    needs_float();
    for (int variant = 0; variant < 4; variant++) {
        bool commanded = variant & 1;
        uint64_t hash = record_failure(variant & 2, commanded);
        rheo_recording *recording;
        rheo_player *player;
        rheo_verification v;
        rheo_failure failure;
        char message[512];
        OK(rheo_recording_open(PATH, &recording, &error));
        rheo_recording_info info = rheo_recording_get_info(recording);
        assert_true(info.complete && rheo_recording_failure(recording, &failure));
        assert_int_equal(failure.step, info.last_step + 1);
        assert_int_equal(failure.reason, RHEO_FAILURE_NOT_FINITE);
        rheo_failure_message(&failure, message, sizeof message);
        assert_non_null(strstr(message, "went bad: after stage"));
        assert_non_null(strstr(message, failure.stage));
        /* The last valid state is stored as a keyframe if no command has changed it. */
        assert_int_equal(info.keyframes, commanded ? 1 : 2);
        assert_int_equal(rheo_recording_keyframe_step(recording, info.keyframes - 1), commanded ? 0 : info.last_step);
        OK(rheo_verify(PATH, &v, &error));
        if (v.verdict != RHEO_SAME)
            fail_msg("%s", v.message);
        assert_non_null(strstr(v.message, "and the failure of the next"));
        /* The failed step can be played up to the failed stage. */
        OK(rheo_player_open(recording, NULL, &player, &error));
        OK(rheo_player_seek(player, info.last_step, &error));
        assert_true(rheo_world_hash(rheo_player_world(player)) == hash);
        OK(rheo_player_seek_stage(player, failure.step, "neighbours", &error));
        assert_int_equal(rheo_player_seek_stage(player, failure.step, failure.stage, &why), RHEO_ERROR_STATE);
        assert_non_null(strstr(why.message, failure.stage));
        OK(rheo_player_step_back(player, &error));
        assert_int_equal(rheo_world_step_count(rheo_player_world(player)), info.last_step - 1);
        rheo_player_close(player);
        rheo_recording_close(recording);
    }
    remove(PATH);
}

/* A run has not failed if its last step succeeded. */
static void a_rescued_run_has_not_failed(void **unused)
{
    (void)unused;
    needs_float();
    rheo_world *world = sequential_world();
    rheo_recorder *recorder;
    rheo_recording *recording;
    rheo_failure failure;
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true}, &recorder, &error));
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_world_set(world, "springs.stiffness", TOO_STIFF, &error));
    assert_int_equal(rheo_recorder_step(recorder, &why), RHEO_ERROR_STATE);
    OK(rheo_world_set(world, "springs.stiffness", "15", &error));
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    OK(rheo_recording_open(PATH, &recording, &error));
    assert_false(rheo_recording_failure(recording, &failure));
    rheo_recording_close(recording);
    rheo_world_destroy(world);
    remove(PATH);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stages_one_by_one_make_the_same_step),
        cmocka_unit_test(stages_are_timed),
        cmocka_unit_test(the_middle_of_a_step_takes_no_command_and_is_not_saved),
        cmocka_unit_test(the_failed_stage_is_named),
        cmocka_unit_test(the_failed_substep_is_named),
        cmocka_unit_test(every_step_is_reached_from_every_other),
        cmocka_unit_test(a_step_is_the_same_after_steps_that_are_loaded),
        cmocka_unit_test(a_seek_makes_only_the_steps_in_between),
        cmocka_unit_test(steps_back_make_few_steps),
        cmocka_unit_test(metrics_come_with_the_state),
        cmocka_unit_test(stages_are_played_inside_a_step),
        cmocka_unit_test(steps_are_played_after_others_that_were_not_simulated),
        cmocka_unit_test(the_stage_with_another_hash_is_named),
        cmocka_unit_test(a_failed_run_names_its_step_and_stage),
        cmocka_unit_test(a_rescued_run_has_not_failed),
    };
    return cmocka_run_group_tests_name("play", tests, NULL, NULL);
}
