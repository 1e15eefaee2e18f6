/*
 * Recordings with a limit of bytes. They never exceed it, hold all steps, and are the same whether the run was
 * interrupted or not. A step that does not fit is not made.
 */
#define _XOPEN_SOURCE 700 /* symlink(), realpath() */
#define PATH "test_recorder_size.rlog"
#include "recorded_runs.h"

#include <sys/stat.h>
#include <unistd.h>

enum { STEPS = 40, SPACING = 2 };

#define BESIDE PATH ".thinning"

/* ---- Runs ---- */

static bool exists(const char *path)
{
    return access(path, F_OK) == 0;
}

/* Becomes infinite in step 31. */
static void overflow(rheo_world *world, uint64_t step)
{
    if (step == 30)
        make_infinite(world);
}

typedef struct run_kind {
    const char *name;
    rheo_world *(*make)(void);
    void (*command)(rheo_world *world, uint64_t step);
    bool full;
    rheo_history_kind history;
} run_kind;

static const run_kind kinds[] = {
    {"window", small, command, false, RHEO_HISTORY_WINDOW},
    {"full", small, command, true, RHEO_HISTORY_WINDOW},
    {"fast, full", small, command, true, RHEO_HISTORY_WINDOW_FAST},
    {"tempered, full", small, command, true, RHEO_HISTORY_TEMPERED},
    {"whole history, full", small, command, true, RHEO_HISTORY_FULL},
    {"melting", melt, NULL, false, RHEO_HISTORY_WINDOW},
    {"melting, full", melt, NULL, true, RHEO_HISTORY_WINDOW},
    {"failing", small, overflow, false, RHEO_HISTORY_WINDOW},
    {"failing, full", small, overflow, true, RHEO_HISTORY_WINDOW},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static rheo_record_options options_of(const run_kind *k, uint64_t limit)
{
    return (rheo_record_options){
        .scene = "small", .keyframe_spacing = SPACING, .full = k->full, .made_by = "a test", .max_bytes = limit};
}

static rheo_world *make(const run_kind *k)
{
    kind = k->history;
    rheo_world *world = k->make();
    kind = RHEO_HISTORY_WINDOW;
    return world;
}

/* Goes on to `end`, until a step fails or does not fit. Returns the result of the last step. */
static rheo_result go_on(const run_kind *k, rheo_world *world, rheo_recorder *recorder, uint64_t end)
{
    rheo_result result = RHEO_OK;
    for (uint64_t step = rheo_world_step_count(world); step < end && result == RHEO_OK; step++) {
        if (k->command)
            k->command(world, step);
        const uint64_t hash = rheo_world_hash(world);
        result = rheo_recorder_step(recorder, &why);
        assert_true(result == RHEO_OK || result == RHEO_ERROR_STATE || result == RHEO_ERROR_LIMIT);
        assert_int_equal(rheo_world_step_count(world), step + (result == RHEO_OK));
        if (result != RHEO_OK)
            assert_true(rheo_world_hash(world) == hash); /* as it was before the step */
    }
    return result;
}

/* Records `end` steps, or as many as fit. */
static file run_to(const run_kind *k, uint64_t limit, uint64_t end, rheo_result *result)
{
    rheo_world *world = make(k);
    rheo_recorder *recorder;
    const rheo_record_options options = options_of(k, limit);
    remove(PATH);
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    *result = go_on(k, world, recorder, end);
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    assert_false(exists(BESIDE));
    return read_and_remove(PATH);
}

/* The smallest limit with which a run begins. */
static uint64_t least_of(const run_kind *k)
{
    rheo_world *world = make(k);
    const rheo_record_options options = options_of(k, 0);
    uint64_t least = 0;
    OK(rheo_recorder_least_bytes(world, &options, &least, &error));
    rheo_world_destroy(world);
    return least;
}

/* Opens a recording, which verifies. */
static rheo_recording *opened(const file *f, rheo_recording_info *info)
{
    rheo_recording *r;
    rheo_verification v;
    OK(rheo_verify_memory(f->bytes, f->size, &v, &error));
    assert_int_equal(v.verdict, RHEO_SAME);
    OK(rheo_recording_open_memory(f->bytes, f->size, &r, &error));
    *info = rheo_recording_get_info(r);
    assert_true(info->complete);
    return r;
}

/* ---- The limit ---- */

/*
 * With any limit, the file is not larger, it verifies, has the state of an unlimited run at each of its steps, and its
 * keyframes are a power of two times as far apart, but for the newest. Only the limit ends it.
 */
static void a_recording_keeps_to_its_limit_and_has_all_steps(void **state)
{
    (void)state;
    for (size_t n = 0; n < KINDS; n++) {
        rheo_result result, ended;
        rheo_recording_info all, info;
        const file whole = run_to(&kinds[n], 0, STEPS, &ended);
        rheo_recording *unlimited = opened(&whole, &all);
        const uint64_t least = least_of(&kinds[n]), stride = (whole.size - least) / 40 + 1;
        uint64_t last_step = 0;
        bool thinned = false;
        for (uint64_t limit = least; limit < whole.size + 3 * stride; limit += stride * every()) {
            const file now = run_to(&kinds[n], limit, STEPS, &result);
            if (now.size > limit)
                fail_msg("%s: %zu bytes with a limit of %llu", kinds[n].name, now.size, (unsigned long long)limit);
            rheo_recording *r = opened(&now, &info);
            assert_true(result == RHEO_ERROR_LIMIT ? info.last_step < all.last_step || ended == RHEO_ERROR_STATE
                                                   : result == ended && info.last_step == all.last_step);
            assert_true(rheo_recording_failure(r, &(rheo_failure){0}) == (result == RHEO_ERROR_STATE));
            assert_true(info.last_step + 4 * SPACING >= last_step); /* more room, hardly fewer steps */
            last_step = info.last_step;
            rheo_world *a, *b;
            OK(rheo_recording_world(r, info.last_step, NULL, &a, &error));
            OK(rheo_recording_world(unlimited, info.last_step, NULL, &b, &error));
            assert_true(rheo_world_hash(a) == rheo_world_hash(b));
            rheo_world_destroy(a);
            rheo_world_destroy(b);
            assert_int_equal(info.keyframe_spacing / SPACING & (info.keyframe_spacing / SPACING - 1), 0);
            uint64_t odd = 0;
            for (uint64_t i = 0; i < info.keyframes; i++)
                odd += rheo_recording_keyframe_step(r, i) % info.keyframe_spacing != 0;
            assert_true(odd <= 1);
            assert_true(info.last_step < SPACING || info.keyframes > 1 ||
                        limit < least + 4 * all.keyframe_bytes / all.keyframes);
            thinned = thinned || info.keyframe_spacing > SPACING;
            rheo_recording_close(r);
            free(now.bytes);
        }
        assert_true(thinned);
        rheo_recording_close(unlimited);
        free(whole.bytes);
    }
}

/* A limit that is not reached changes nothing. */
static void a_large_limit_changes_no_byte(void **state)
{
    (void)state;
    for (size_t n = 0; n < KINDS; n++) {
        rheo_result result;
        const file whole = run_to(&kinds[n], 0, STEPS, &result), same = run_to(&kinds[n], UINT64_MAX, STEPS, &result);
        assert_int_equal(same.size, whole.size);
        assert_memory_equal(same.bytes, whole.bytes, whole.size);
        free(whole.bytes);
        free(same.bytes);
    }
}

static void a_recording_in_memory_has_the_bytes_of_the_file(void **state)
{
    (void)state;
    for (size_t n = 0; n < KINDS; n++) {
        rheo_result result;
        const uint64_t limit = 3 * least_of(&kinds[n]);
        const file there = run_to(&kinds[n], limit, STEPS, &result);
        const rheo_record_options options = options_of(&kinds[n], limit);
        rheo_world *world = make(&kinds[n]);
        rheo_recorder *recorder;
        void *bytes;
        size_t size;
        OK(rheo_recorder_open_memory(world, &options, &recorder, &error));
        go_on(&kinds[n], world, recorder, STEPS);
        OK(rheo_recorder_close_memory(recorder, &bytes, &size, &error));
        rheo_world_destroy(world);
        assert_int_equal(size, there.size);
        assert_memory_equal(bytes, there.bytes, size);
        free(bytes);
        free(there.bytes);
    }
}

/* The least limit is that of the first keyframe; one byte less is refused and makes no file. */
static void the_least_limit_is_exact(void **state)
{
    (void)state;
    for (size_t n = 0; n < KINDS; n++) {
        const uint64_t least = least_of(&kinds[n]);
        const rheo_record_options less = options_of(&kinds[n], least - 1);
        char text[32];
        snprintf(text, sizeof text, "of %llu or more", (unsigned long long)least);
        rheo_world *world = make(&kinds[n]);
        rheo_recorder *recorder;
        remove(PATH);
        REFUSED(RHEO_ERROR_ARGUMENT, text, rheo_recorder_open(world, PATH, &less, &recorder, &error));
        assert_null(recorder);
        REFUSED(RHEO_ERROR_ARGUMENT, text, rheo_recorder_open_memory(world, &less, &recorder, &error));
        REFUSED(RHEO_ERROR_ARGUMENT, text, rheo_recorder_continue(&world, PATH, &less, &recorder, &error));
        assert_false(exists(PATH));
        rheo_world_destroy(world);
        rheo_result result;
        const file there = run_to(&kinds[n], least, 0, &result);
        assert_true(there.size <= least);
        free(there.bytes);
    }
}

/*
 * Keyframes twice as far apart are enough if they need exactly the limit. Their sizes are known from a run that has
 * them so from the beginning, and the room that is kept for a failure from a recording without steps.
 */
static void a_spacing_that_needs_the_whole_limit_is_taken(void **state)
{
    (void)state;
    rheo_result result;
    rheo_recording_info info;
    const run_kind *k = &kinds[0];
    rheo_record_options far = options_of(k, 0);
    far.keyframe_spacing = 2 * SPACING;
    rheo_world *world = make(k);
    rheo_recorder *recorder;
    remove(PATH);
    OK(rheo_recorder_open(world, PATH, &far, &recorder, &error));
    assert_int_equal(go_on(k, world, recorder, 2 * SPACING), RHEO_OK);
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    const file whole = read_and_remove(PATH), none = run_to(k, 0, 0, &result);
    const uint64_t limit = whole.size + least_of(k) - none.size;
    for (uint64_t less = 0; less < 2; less++) {
        const file now = run_to(k, limit - less, 2 * SPACING, &result);
        assert_int_equal(result, RHEO_OK);
        rheo_recording_close(opened(&now, &info));
        assert_int_equal(info.keyframe_spacing, less ? SPACING : 2 * SPACING);
        assert_true(less || now.size == whole.size);
        free(now.bytes);
    }
    free(whole.bytes);
    free(none.bytes);
}

/*
 * Keyframes of which only the first and another fit: the second one is always at least half as far as the last step.
 */
static void of_large_keyframes_the_first_and_a_late_one_remain(void **state)
{
    (void)state;
    rheo_result result;
    rheo_recording_info info;
    const run_kind *k = &kinds[0];
    const file whole = run_to(k, 0, STEPS, &result);
    rheo_recording *r = opened(&whole, &info);
    const uint64_t limit = least_of(k) + info.step_bytes + 13 * (info.keyframe_bytes / info.keyframes) / 10;
    rheo_recording_close(r);
    free(whole.bytes);
    for (uint64_t steps = 8 * SPACING; steps <= STEPS; steps += every()) {
        const file now = run_to(k, limit, steps, &result);
        assert_int_equal(result, RHEO_OK);
        r = opened(&now, &info);
        assert_true(info.keyframes >= 2);
        assert_true(rheo_recording_keyframe_step(r, info.keyframes - 1) >= steps / 2);
        rheo_recording_close(r);
        free(now.bytes);
    }
}

/* The newest keyframe is never left out: the last one that a reader finds never becomes an older one. */
static void the_newest_keyframe_is_never_left_out(void **state)
{
    (void)state;
    const run_kind *k = &kinds[0];
    rheo_result result;
    const file whole = run_to(k, 0, STEPS, &result);
    const uint64_t least = least_of(k), stride = (whole.size - least) / 50 + 1;
    free(whole.bytes);
    for (uint64_t limit = least; limit < whole.size; limit += stride * (1 + every() / 4)) {
        const rheo_record_options options = options_of(k, limit);
        rheo_world *world = make(k);
        rheo_recorder *recorder;
        uint64_t newest = 0;
        OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
        for (uint64_t step = 1; step <= STEPS && go_on(k, world, recorder, step) == RHEO_OK; step++) {
            rheo_recording *r;
            OK(rheo_recording_open(PATH, &r, &error));
            const uint64_t last = rheo_recording_keyframe_step(r, UINT64_MAX);
            assert_true(last >= newest);
            newest = last;
            rheo_recording_close(r);
        }
        OK(rheo_recorder_close(recorder, &error));
        rheo_world_destroy(world);
        remove(PATH);
    }
}

/* The size that a refusal names is that of the file with the step, and of a failure, which may follow at any time. */
static void the_size_of_a_step_is_known_exactly(void **state)
{
    (void)state;
    for (size_t n = 0; n < KINDS; n++)
        for (size_t part = 1; part < 12; part += 1 + every() / 11) {
            rheo_record_options options = options_of(&kinds[n], 0);
            options.keyframe_spacing = 1000; /* the first keyframe is the only one */
            rheo_world *world = make(&kinds[n]);
            rheo_recorder *recorder;
            const uint64_t failure = 36 + 40 + sizeof(rheo_failure){0}.stage + sizeof(rheo_failure){0}.field +
                                     8 * (uint64_t)rheo_world_metric_count(world);
            OK(rheo_recorder_least_bytes(world, &options, &options.max_bytes, &error));
            options.max_bytes += part * (kinds[n].full ? 800 : 400);
            uint64_t before = UINT64_MAX;
            bool advanced = false;
            for (int again = 0; again < 3; again++) { /* commands may be refused before their step */
                void *bytes;
                size_t size;
                OK(rheo_recorder_open_memory(world, &options, &recorder, &error));
                assert_int_equal(go_on(&kinds[n], world, recorder, STEPS), RHEO_ERROR_LIMIT);
                const char *named = strstr(why.message, "needs a limit of ");
                assert_non_null(named);
                OK(rheo_recorder_close_memory(recorder, &bytes, &size, &error));
                free(bytes);
                const uint64_t steps = rheo_world_step_count(world);
                advanced = advanced || steps > before;
                if (steps > before) /* the step that was refused before is the last one */
                    assert_int_equal(size + failure, options.max_bytes);
                before = steps;
                options.max_bytes = strtoull(named + strlen("needs a limit of "), NULL, 10);
                rheo_world_destroy(world);
                world = make(&kinds[n]);
            }
            assert_true(advanced);
            rheo_world_destroy(world);
        }
}

/* A failure, the commands before it and its keyframe keep to the limit, whatever is left. */
static void a_failure_keeps_to_the_limit(void **state)
{
    (void)state;
    rheo_result result;
    for (size_t n = 7; n < KINDS; n++) {
        const file whole = run_to(&kinds[n], 0, STEPS, &result);
        for (uint64_t limit = whole.size - 400; limit < whole.size + 400; limit += 1 + 2 * every()) {
            const file now = run_to(&kinds[n], limit, STEPS, &result);
            assert_int_equal(result, RHEO_ERROR_STATE);
            assert_true(now.size <= limit);
            free(now.bytes);
        }
        free(whole.bytes);
    }
}

/* ---- Interrupted runs ---- */

/* Continues the file at PATH; it becomes `whole`. */
static void continue_to(const run_kind *k, uint64_t limit, const file *whole, uint64_t from, size_t cut)
{
    rheo_world *world = make(k);
    rheo_recorder *recorder;
    const rheo_record_options options = options_of(k, limit);
    if (rheo_recorder_continue(&world, PATH, &options, &recorder, &why) != RHEO_OK)
        fail_msg("%s, step %llu, byte %zu: %s", k->name, (unsigned long long)from, cut, why.message);
    go_on(k, world, recorder, STEPS);
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    const file now = read_and_remove(PATH);
    if (now.size != whole->size || memcmp(now.bytes, whole->bytes, now.size) != 0)
        fail_msg("%s, limit %llu, step %llu, byte %zu: %zu bytes instead of %zu, or other ones", k->name,
                 (unsigned long long)limit, (unsigned long long)from, cut, now.size, whole->size);
    free(now.bytes);
}

/* Limits with which a run is thinned: few keyframes, and most. */
static uint64_t limit_of(const run_kind *k, unsigned part)
{
    rheo_result result;
    const file whole = run_to(k, 0, STEPS, &result);
    free(whole.bytes);
    return least_of(k) + (whole.size - least_of(k)) * part / 8;
}

static void an_interrupted_run_ends_with_the_same_bytes(void **state)
{
    (void)state;
    for (size_t n = 0; n < KINDS; n++)
        for (unsigned part = 3; part < 8; part += 3) {
            rheo_result result;
            const uint64_t limit = limit_of(&kinds[n], part);
            const file whole = run_to(&kinds[n], limit, STEPS, &result);
            for (uint64_t end = 0; end <= STEPS; end += every()) {
                const file early = run_to(&kinds[n], limit, end, &result);
                write_file(PATH, early.bytes, early.size);
                continue_to(&kinds[n], limit, &whole, end, early.size);
                free(early.bytes);
            }
            free(whole.bytes);
        }
}

/* Where the last step and its keyframe begin. */
static size_t begin_of_last_step(const file *f)
{
    size_t committed = 0, begin = 0;
    for (size_t at = 8; at < f->size;) {
        uint64_t stored;
        memcpy(&stored, f->bytes + at + 16, sizeof stored);
        begin = memcmp(f->bytes + at, "STEP", 4) == 0 ? committed : begin;
        const bool commits = memcmp(f->bytes + at, "STEP", 4) == 0 || memcmp(f->bytes + at, "KEYF", 4) == 0;
        at += 36 + (size_t)stored;
        committed = commits ? at : committed;
    }
    return begin;
}

/* The file of a run that is killed after each step, or anywhere while it writes the step. */
static void a_killed_run_ends_with_the_same_bytes(void **state)
{
    (void)state;
    for (size_t n = 0; n < KINDS; n++) {
        rheo_result result;
        const uint64_t limit = limit_of(&kinds[n], 4);
        const file whole = run_to(&kinds[n], limit, STEPS, &result);
        const rheo_record_options options = options_of(&kinds[n], limit);
        for (uint64_t step = 1; step < STEPS; step += 3 * every()) {
            rheo_world *world = make(&kinds[n]);
            rheo_recorder *recorder;
            OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
            if (go_on(&kinds[n], world, recorder, step) != RHEO_OK)
                step = STEPS;
            file torn;
            torn.bytes = read_file(PATH, &torn.size); /* as a killed program leaves it */
            OK(rheo_recorder_close(recorder, &error));
            rheo_world_destroy(world);
            const size_t most = torn.size - begin_of_last_step(&torn);
            for (size_t cut = 0; cut <= most; cut += most / 5 + 1) {
                write_file(PATH, torn.bytes, torn.size - cut);
                write_file(BESIDE, torn.bytes, torn.size / 2); /* and one that was being thinned */
                continue_to(&kinds[n], limit, &whole, step, torn.size - cut);
                assert_false(exists(BESIDE));
            }
            free(torn.bytes);
        }
        free(whole.bytes);
    }
}

/* A recording that was ended by its limit goes on with a larger one, one without a limit takes one. */
static void a_continued_run_may_change_the_limit(void **state)
{
    (void)state;
    const run_kind *k = &kinds[0];
    rheo_result result;
    rheo_recording_info info;
    rheo_recorder *recorder;
    const file whole = run_to(k, 0, STEPS, &result);
    rheo_recording *r = opened(&whole, &info);
    const uint64_t keyframe = info.keyframe_bytes / info.keyframes;
    rheo_recording_close(r);
    const uint64_t limits[][2] = {{least_of(k) + keyframe + info.step_bytes / 2, 0},
                                  {least_of(k) + keyframe + info.step_bytes / 2, whole.size / 2},
                                  {0, whole.size / 2}};
    for (size_t i = 0; i < 3; i++) {
        const file first = run_to(k, limits[i][0], STEPS / 2 + (limits[i][0] ? STEPS : 0), &result);
        assert_int_equal(result, limits[i][0] ? RHEO_ERROR_LIMIT : RHEO_OK);
        write_file(PATH, first.bytes, first.size);
        rheo_world *world = make(k);
        rheo_record_options options = options_of(k, limits[i][1]);
        if (limits[i][1] == 0) {
            REFUSED(RHEO_ERROR_ARGUMENT, "needs a limit, too",
                    rheo_recorder_continue(&world, PATH, &options, &recorder, &error));
            options.max_bytes = least_of(k);
            REFUSED(RHEO_ERROR_ARGUMENT, "even with the fewest keyframes",
                    rheo_recorder_continue(&world, PATH, &options, &recorder, &error));
            assert_int_equal(rheo_world_step_count(world), 0);
        } else {
            OK(rheo_recorder_continue(&world, PATH, &options, &recorder, &error));
            assert_int_equal(go_on(k, world, recorder, STEPS), RHEO_OK);
            assert_true(rheo_recorder_keyframe_spacing(recorder) > SPACING);
            const uint64_t left_out = rheo_recorder_keyframes_left_out(recorder);
            OK(rheo_recorder_close(recorder, &error));
            const file now = read_and_remove(PATH);
            assert_true(now.size <= limits[i][1]);
            r = opened(&now, &info);
            assert_int_equal(info.last_step, STEPS);
            assert_in_range(left_out, STEPS / SPACING + 1 - info.keyframes, STEPS / SPACING + 2 - info.keyframes);
            rheo_recording_close(r);
            free(now.bytes);
        }
        rheo_world_destroy(world);
        remove(PATH);
        free(first.bytes);
    }
    free(whole.bytes);
}

/* ---- The file ---- */

/* A reader of the old file is not disturbed, the mode and a link to the file stay, and the writer keeps its lock. */
static void thinning_keeps_readers_links_mode_and_lock(void **state)
{
    (void)state;
    const run_kind *k = &kinds[0];
    const uint64_t limit = limit_of(k, 3);
    const rheo_record_options options = options_of(k, limit);
    rheo_recorder *recorder, *second;
    rheo_recording *reader;
    rheo_world *world = make(k), *other = make(k), *old;
    struct stat status = {0};
    char target[4096];
    remove(PATH);
    remove("test_recorder_size_link.rlog");
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    go_on(k, world, recorder, 3);
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    world = make(k);
    assert_int_equal(chmod(PATH, 0640), 0);
    assert_int_equal(symlink(PATH, "test_recorder_size_link.rlog"), 0);
    OK(rheo_recorder_continue(&world, "test_recorder_size_link.rlog", &options, &recorder, &error));
    OK(rheo_recording_open(PATH, &reader, &error));
    go_on(k, world, recorder, STEPS);
    assert_true(rheo_recorder_keyframe_spacing(recorder) > SPACING);
    REFUSED(RHEO_ERROR_ARGUMENT, "is being written", rheo_recorder_continue(&other, PATH, &options, &second, &error));
    OK(rheo_recording_world(reader, 3, NULL, &old, &error));
    assert_int_equal(rheo_world_step_count(old), 3);
    rheo_recording_close(reader);
    OK(rheo_recorder_close(recorder, &error));
    assert_true(readlink("test_recorder_size_link.rlog", target, sizeof target) > 0);
    assert_int_equal(stat(PATH, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0640);
    assert_true((uint64_t)status.st_size <= limit);
    rheo_world_destroy(world);
    rheo_world_destroy(other);
    rheo_world_destroy(old);
    remove("test_recorder_size_link.rlog");
    remove(PATH);
}

/* Fails to thin before a step, or before a keyframe after a step. The recording is complete up to the last step. */
static bool thinning_fails(const rheo_record_options *options)
{
    const run_kind *k = &kinds[5];
    rheo_world *world = make(k);
    rheo_recorder *recorder;
    remove(PATH);
    OK(rheo_recorder_open(world, PATH, options, &recorder, &error));
    assert_int_equal(mkdir(BESIDE, 0700), 0);
    write_file(BESIDE "/x", "x", 1);
    rheo_result result = RHEO_OK;
    while (result == RHEO_OK && rheo_world_step_count(world) < 1000)
        result = rheo_recorder_step(recorder, &why);
    OK(rheo_recorder_close(recorder, &error));
    assert_true(result == RHEO_ERROR_FILE || result == RHEO_ERROR_LIMIT); /* no keyframe could be left out */
    if (result == RHEO_ERROR_FILE) {
        assert_non_null(strstr(why.message, "cannot be thinned"));
        assert_non_null(strstr(why.message, BESIDE));
    }
    rheo_verification v;
    OK(rheo_verify(PATH, &v, &error));
    OK(rheo_verification_check(&v, rheo_world_step_count(world), &error));
    const file there = read_and_remove(PATH);
    assert_true(there.size <= options->max_bytes);
    write_file(PATH, there.bytes, there.size);
    free(there.bytes);
    remove(BESIDE "/x");
    remove(BESIDE);
    rheo_world_destroy(world);
    world = make(k);
    OK(rheo_recorder_continue(&world, PATH, options, &recorder, &error));
    if (result == RHEO_ERROR_FILE)
        OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    OK(rheo_verify(PATH, &v, &error));
    OK(rheo_verification_check(&v, rheo_world_step_count(world), &error));
    rheo_world_destroy(world);
    remove(PATH);
    return result == RHEO_ERROR_FILE;
}

static void where_thinning_fails_the_recording_remains(void **state)
{
    (void)state;
    int failed = 0;
    for (uint32_t spacing = 1; spacing <= 4; spacing++)
        for (uint32_t keyframes = 2; keyframes <= 4; keyframes++) {
            rheo_record_options options = options_of(&kinds[5], 0);
            rheo_world *world = make(&kinds[5]);
            options.keyframe_spacing = spacing;
            OK(rheo_recorder_least_bytes(world, &options, &options.max_bytes, &error));
            rheo_world_destroy(world);
            options.max_bytes = keyframes * options.max_bytes + 2000;
            failed += thinning_fails(&options);
        }
    assert_true(failed >= 6);
}

/* The name of a thinned file may be someone else's. */
static void a_file_that_is_no_recording_is_not_removed(void **state)
{
    (void)state;
    const rheo_record_options options = options_of(&kinds[0], 1 << 20);
    rheo_world *world = make(&kinds[0]);
    rheo_recorder *recorder, *second;
    remove(PATH);
    write_file(BESIDE, "a letter", 8);
    REFUSED(RHEO_ERROR_ARGUMENT, BESIDE " is no recording",
            rheo_recorder_open(world, PATH, &options, &recorder, &error));
    assert_false(exists(PATH));
    assert_true(exists(BESIDE));
    remove(BESIDE);
    OK(rheo_recorder_open(world, BESIDE, NULL, &second, &error)); /* nor one that is being written */
    REFUSED(RHEO_ERROR_ARGUMENT, "is being written", rheo_recorder_open(world, PATH, &options, &recorder, &error));
    OK(rheo_recorder_close(second, &error));
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error)); /* what was left is removed */
    assert_false(exists(BESIDE));
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    remove(PATH);
}

/* A file that took the place of the recording is not thinned. */
static void a_file_in_the_place_of_the_recording_is_kept(void **state)
{
    (void)state;
    const run_kind *k = &kinds[0];
    const rheo_record_options options = options_of(k, limit_of(k, 3));
    rheo_world *world = make(k);
    rheo_recorder *recorder;
    remove(PATH);
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    remove(PATH);
    write_file(PATH, "a letter", 8);
    rheo_result result = RHEO_OK;
    while (result == RHEO_OK && rheo_world_step_count(world) < 1000)
        result = rheo_recorder_step(recorder, &why);
    assert_int_equal(result, RHEO_ERROR_FILE);
    assert_non_null(strstr(why.message, "was renamed, removed or replaced during the run"));
    rheo_recorder_close(recorder, NULL);
    const file there = read_and_remove(PATH);
    assert_true(there.size == 8 && memcmp(there.bytes, "a letter", 8) == 0);
    free(there.bytes);
    assert_false(exists(BESIDE));
    rheo_world_destroy(world);
}

static void a_device_has_no_limit(void **state)
{
    (void)state;
    rheo_record_options options = options_of(&kinds[0], UINT64_MAX);
    options.force = true;
    rheo_world *world = make(&kinds[0]);
    rheo_recorder *recorder;
    REFUSED(RHEO_ERROR_ARGUMENT, "no regular file",
            rheo_recorder_open(world, "/dev/null", &options, &recorder, &error));
    rheo_world_destroy(world);
}

/* ---- Expected sizes ---- */

/*
 * What is expected grows by one amount a step, and at each keyframe by its bytes, which the rows of the window make more
 * until it is full: 3 reals a row and particle. A window of 7 lags has 8 rows.
 */
static void each_step_and_keyframe_is_expected(void **unused)
{
    (void)unused;
    enum { MOST_AHEAD = 60, EVERY = 5, WINDOW = 8, MADE = 3, PARTICLES = 8 };
    for (int full = 0; full < 2; full++)
        for (int made = 0; made <= MADE; made += MADE) {
            rheo_world *world = small();
            rheo_recorder *recorder;
            const rheo_record_options options = {.keyframe_spacing = EVERY, .full = full};
            OK(rheo_recorder_open_memory(world, &options, &recorder, &error));
            const uint64_t begin = rheo_recorder_bytes(recorder);
            for (int i = 0; i < made; i++)
                OK(rheo_recorder_step(recorder, &error));
            const uint64_t bytes = rheo_recorder_bytes(recorder);
            NEAR(rheo_recorder_expected_bytes(recorder, 0), (double)bytes + 100, 0);
            const double one = rheo_recorder_expected_bytes(recorder, 1) - (double)bytes - 100;
            if (made)
                NEAR(one, (double)(bytes - begin) / made, 1e-6);
            double keyframe = 0, keyframes = 0;
            uint64_t rows = 0;
            for (uint64_t n = 1; n <= MOST_AHEAD; n++) {
                const double more =
                    rheo_recorder_expected_bytes(recorder, n) - rheo_recorder_expected_bytes(recorder, n - 1) - one;
                const uint64_t step = (uint64_t)made + n, now = step < WINDOW ? step : WINDOW;
                if (step % EVERY == 0) {
                    if (keyframe > 0)
                        NEAR(more - keyframe, 3. * sizeof(rheo_real) * PARTICLES * (double)(now - rows), 1e-6);
                    /* Flat fields shrink by about a quarter: position and velocity alone are 6 reals. */
                    assert_true(more > 0.75 * PARTICLES * (6 + 3. * (double)now) * sizeof(rheo_real));
                    assert_true(more < 2000. * sizeof(rheo_real));
                    keyframe = more;
                    keyframes += more;
                    rows = now;
                } else {
                    NEAR(more, 0, 1e-6);
                }
                /* With the fewest keyframes, the newest of them is there. */
                const double fewest = rheo_recorder_expected_fewest_bytes(recorder, n);
                const double left_out = rheo_recorder_expected_bytes(recorder, n) - fewest;
                if (keyframe == 0)
                    NEAR(left_out, 0, 1e-6);
                else if (rows == WINDOW)
                    NEAR(left_out, keyframes - keyframe, 1e-6);
            }
            assert_int_equal(rows, WINDOW);
            /* An estimate ahead of the first step is near what steps take. */
            for (int i = 0; i < 20; i++)
                OK(rheo_recorder_step(recorder, &error));
            const double real = (double)(rheo_recorder_bytes(recorder) - bytes);
            assert_true(20 * one < 1.5 * real && 20 * one > 0.5 * (real - 4 * keyframe));
            rheo_recorder_close(recorder, NULL);
            rheo_world_destroy(world);
        }
}

int main(void)
{
    remove(BESIDE "/x"); /* of a test that failed */
    remove(BESIDE);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_step_and_keyframe_is_expected),
        cmocka_unit_test(a_recording_keeps_to_its_limit_and_has_all_steps),
        cmocka_unit_test(a_large_limit_changes_no_byte),
        cmocka_unit_test(a_recording_in_memory_has_the_bytes_of_the_file),
        cmocka_unit_test(the_least_limit_is_exact),
        cmocka_unit_test(a_spacing_that_needs_the_whole_limit_is_taken),
        cmocka_unit_test(of_large_keyframes_the_first_and_a_late_one_remain),
        cmocka_unit_test(the_newest_keyframe_is_never_left_out),
        cmocka_unit_test(the_size_of_a_step_is_known_exactly),
        cmocka_unit_test(a_failure_keeps_to_the_limit),
        cmocka_unit_test(an_interrupted_run_ends_with_the_same_bytes),
        cmocka_unit_test(a_killed_run_ends_with_the_same_bytes),
        cmocka_unit_test(a_continued_run_may_change_the_limit),
        cmocka_unit_test(thinning_keeps_readers_links_mode_and_lock),
        cmocka_unit_test(where_thinning_fails_the_recording_remains),
        cmocka_unit_test(a_file_that_is_no_recording_is_not_removed),
        cmocka_unit_test(a_file_in_the_place_of_the_recording_is_kept),
        cmocka_unit_test(a_device_has_no_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
