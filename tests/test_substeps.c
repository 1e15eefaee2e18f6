/*
 * Stages before, in and after substeps: the model of third_model.c, whose steps have 1, 2 and 3 substeps in turn, in
 * steps, recordings, reports and failures.
 */
#include "forge.h"
#include "support.h"
#include "world/stage_runs.h"

enum { STEPS = 7, MOST_RUNS = 10, ROOM = 1 << 20 };

static const char *const PATH = "test_substeps.rlog", *const OTHER = "test_substeps_other.rlog";
static rheo_error why; /* error of calls that may be refused */

extern unsigned drag_stage_runs;

/* The names of the stage runs of a step with 1, 2 and 3 substeps, and the fields that they write. */
static const char *const NAMES[3][MOST_RUNS + 1] = {
    {"gravity", "substeps", "drag@1", "flight@1", "floor", "history"},
    {"gravity", "substeps", "drag@1", "flight@1", "drag@2", "flight@2", "floor", "history"},
    {"gravity", "substeps", "drag@1", "flight@1", "drag@2", "flight@2", "drag@3", "flight@3", "floor", "history"}};

static const char *written(const char *name, int which)
{
    static const char *const FIELDS[][3] = {
        {"gravity", "velocity"}, {"substeps", "substeps"},          {"drag", "velocity"},
        {"flight", "position"},  {"floor", "position", "velocity"}, {"history", "history_rows", "history_velocity"}};
    for (size_t i = 0; i < sizeof FIELDS / sizeof *FIELDS; i++)
        if (strncmp(FIELDS[i][0], name, strlen(FIELDS[i][0])) == 0)
            return which < 2 ? FIELDS[i][1 + which] : NULL;
    return NULL;
}

/*
 * Two particles that bounce off the floor in steps 3 and 4. scale: of lengths and speeds.
 */
static rheo_world *falling_world(double scale)
{
    rheo_world_def def = rheo_default_model_def((rheo_model)2);
    const rheo_real one = (rheo_real)scale, position[6] = {0, one * (rheo_real)0.45, 0, 3, one * (rheo_real)0.62, 3},
                    velocity[6] = {one, -2 * one, 0, one, -2 * one, one};
    def.step = 0.1;
    def.particles.count = 2;
    def.particles.position = position;
    def.particles.velocity = velocity;
    rheo_world *world;
    OK(rheo_world_create(&def, &world, &error));
    return world;
}

/* Records STEPS steps; the parameter, unless NULL, is set ahead of step `at`. */
static void record(const char *path, bool full, double scale, const char *parameter, const char *value, uint64_t at)
{
    rheo_world *world = falling_world(scale);
    rheo_recorder *recorder;
    OK(rheo_recorder_open(world, path, &(rheo_record_options){.full = full, .force = true}, &recorder, &error));
    rheo_result result = RHEO_OK;
    for (uint64_t n = 1; n <= STEPS && result == RHEO_OK; n++) {
        if (parameter && n == at)
            OK(rheo_world_set(world, parameter, value, &error));
        result = rheo_recorder_step(recorder, &why);
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
}

static rheo_player *play(rheo_recording **recording)
{
    rheo_player *player;
    OK(rheo_recording_open(PATH, recording, &error));
    OK(rheo_player_open(*recording, NULL, &player, &error));
    return player;
}

/* ---- Steps ---- */

static void the_stages_run_in_three_phases(void **unused)
{
    (void)unused;
    rheo_world *parts = falling_world(1), *whole = falling_world(1);
    char name[32];
    uint32_t stage;
    for (int n = 0; n < STEPS; n++) {
        OK(rheo_world_step(whole, &error));
        const char *const *expected = NAMES[n % 3];
        for (int run = 0; expected[run]; run++) {
            OK(rheo_world_step_stage(parts, &stage, &error));
            rheo_world_last_stage(parts, name);
            assert_string_equal(name, expected[run + 1] ? expected[run] : "");
            rheo_stage_info info;
            OK(rheo_world_stage(parts, stage, &info));
            assert_memory_equal(info.name, expected[run], strlen(info.name));
            if (run == 0 || !expected[run + 1])
                continue;
            assert_int_equal(rheo_world_stages_in_step(parts), 4 + 2 * (1 + n % 3));
            for (int k = 0; expected[k]; k++) /* the state is checked there */
                assert_int_equal(rheo__world_begins_later_substep(parts, (uint64_t)k),
                                 strncmp(expected[k], "drag@", 5) == 0 && expected[k][5] > '1');
        }
        assert_true(rheo_world_hash(parts) == rheo_world_hash(whole));
    }
    /* Calls, from which costs follow: steps 1 to 7 have 1 + 2 + 3 + 1 + 2 + 3 + 1 substeps. */
    static const uint64_t CALLS[] = {7, 7, 13, 13, 7, 7};
    for (uint32_t i = 0; i < 6; i++) {
        rheo_stage_info info;
        OK(rheo_world_stage(whole, i, &info));
        assert_int_equal(info.calls, CALLS[i]);
        assert_int_equal(info.in_substeps, CALLS[i] == 13);
    }
    rheo_world_destroy(parts);
    rheo_world_destroy(whole);
}

/* ---- Recordings ---- */

static void every_stage_run_is_reached(void **unused)
{
    (void)unused;
    for (int full = 0; full < 2; full++) {
        record(PATH, full, 1, NULL, NULL, 0);
        rheo_verification v;
        OK(rheo_verify(PATH, &v, &error));
        assert_true(v.verdict == RHEO_SAME && v.steps == STEPS);
        uint64_t hash[STEPS][MOST_RUNS];
        rheo_world *world = falling_world(1);
        uint32_t stage;
        for (int n = 0; n < STEPS; n++)
            for (int run = 0; NAMES[n % 3][run]; run++) {
                OK(rheo_world_step_stage(world, &stage, &error));
                hash[n][run] = rheo_world_hash(world);
            }
        rheo_world_destroy(world);
        rheo_recording *recording;
        rheo_player *player = play(&recording);
        for (int from = 0; from < STEPS * MOST_RUNS; from += 3) /* forwards and backwards from different places */
            for (int n = STEPS; n-- > 0;)
                for (int k = 0; k < MOST_RUNS; k++) {
                    const int run = (from + 7 * k) % MOST_RUNS;
                    if (run >= 4 + 2 * (1 + n % 3))
                        continue;
                    OK(rheo_player_seek_stage(player, (uint64_t)n + 1, NAMES[n % 3][run], &error));
                    const rheo_world *there = rheo_player_world(player);
                    assert_true(rheo_world_hash(there) == hash[n][run]);
                    assert_int_equal(rheo_world_stages_done(there), NAMES[n % 3][run + 1] ? run + 1 : 0);
                }
        REFUSED(RHEO_ERROR_ARGUMENT, "step 5 has only 2 substeps; there is no drag@3 in it",
                rheo_player_seek_stage(player, 5, "drag@3", &error));
        REFUSED(RHEO_ERROR_ARGUMENT, "step 4 has only 1 substeps; there is no flight@2 in it",
                rheo_player_seek_stage(player, 4, "flight@2", &error));
        REFUSED(RHEO_ERROR_ARGUMENT, "stage floor is made once in a step",
                rheo_player_seek_stage(player, 6, "floor@2", &error));
        OK(rheo_player_seek_stage(player, 5, "drag@2", &error));
        OK(rheo_player_step(player, &error));
        assert_int_equal(rheo_world_step_count(rheo_player_world(player)), 5);
        rheo_player_close(player);
        rheo_recording_close(recording);
    }
    remove(PATH);
}

static forged_chunk *chunk_of(forged *f, uint32_t type, uint64_t step)
{
    for (size_t i = 0; i < f->count; i++)
        if (f->chunk[i].type == type && f->chunk[i].step == step)
            return &f->chunk[i];
    fail_msg("no such chunk");
    return NULL;
}

/* Writes the chunks to the file OTHER. */
static void write_forged(forged *f)
{
    uint8_t *bytes = malloc(ROOM);
    const size_t size = forge_write(f, true, bytes, ROOM);
    assert_true(size > 0);
    write_file(OTHER, bytes, size);
    free(bytes);
    forge_release(f);
}

/* Each hash of a step is that of one stage run and field: a wrong one is reported as such by all readers. */
static void a_wrong_hash_is_named(void **unused)
{
    (void)unused;
    record(PATH, false, 1, NULL, NULL, 0);
    size_t size;
    uint8_t *bytes = read_file(PATH, &size);
    for (uint64_t n = 1; n <= 6; n++) {
        const char *const *names = NAMES[(n - 1) % 3];
        size_t index = 0;
        for (int run = 0; names[run]; run++)
            for (int which = 0; written(names[run], which); which++, index++) {
                static forged f;
                forge_open(&f, bytes, size, ROOM);
                chunk_of(&f, RHEO__STEP, n)->data[8 + 8 * index] ^= 1;
                write_forged(&f);
                rheo_verification v;
                for (int reader = 0; reader < 3; reader++) {
                    if (reader == 0)
                        OK(rheo_verify(OTHER, &v, &error));
                    else
                        OK(rheo_diff(reader == 1 ? OTHER : PATH, reader == 1 ? PATH : OTHER, &v, &error));
                    assert_true(v.verdict == RHEO_DIFFERS && v.first.step == n);
                    assert_string_equal(v.first.stage, names[run]);
                    assert_string_equal(v.first.field, written(names[run], which));
                }
                rheo_recording *r;
                rheo_player *player;
                char message[80];
                snprintf(message, sizeof message, "stage %s gives another %s", names[run],
                         written(names[run], which));
                OK(rheo_recording_open(OTHER, &r, &error));
                OK(rheo_player_open(r, NULL, &player, &error));
                REFUSED(RHEO_ERROR_DIFFERS, message, rheo_player_seek_stage(player, n, names[run], &error));
                REFUSED(RHEO_ERROR_DIFFERS, message, rheo_player_seek(player, n, &error));
                rheo_player_close(player);
                rheo_recording_close(r);
            }
        assert_int_equal(index, 6 + 2 * (1 + (n - 1) % 3));
    }
    free(bytes);
    remove(PATH);
    remove(OTHER);
}

/* Of 3 + 3 hashes of stages that run once and 2 of each substep. */
static void a_wrong_number_of_hashes_is_refused(void **unused)
{
    (void)unused;
    record(PATH, false, 1, NULL, NULL, 0);
    size_t size;
    uint8_t *bytes = read_file(PATH, &size);
    static const int CHANGES[] = {-6, -5, -4, -3, -1, 1, 3, -2, 2, 200};
    for (size_t i = 0; i < sizeof CHANGES / sizeof *CHANGES; i++) {
        static forged f;
        forge_open(&f, bytes, size, ROOM);
        forged_chunk *c = chunk_of(&f, RHEO__STEP, 5);
        const size_t hashes = 10, metrics = c->size - 8 - 8 * hashes, kept = hashes + (size_t)CHANGES[i];
        uint8_t *data = calloc(8 + 8 * kept + metrics, 1);
        memcpy(data, c->data, 8 + 8 * (kept < hashes ? kept : hashes));
        memcpy(data + 8 + 8 * kept, c->data + 8 + 8 * hashes, metrics);
        free(c->data);
        c->data = data;
        c->size = 8 + 8 * kept + metrics;
        write_forged(&f);
        rheo_verification v;
        OK(rheo_verify(OTHER, &v, &error));
        /* The hashes of another number of substeps differ where the first is missing, or are too many. */
        assert_int_equal(v.verdict, CHANGES[i] == -2 ? RHEO_DIFFERS : RHEO_UNREADABLE);
        assert_int_equal(v.steps, 4);
        assert_string_equal(v.first.stage, CHANGES[i] == -2 ? "history" : "");
        OK(rheo_diff(PATH, OTHER, &v, &error));
        assert_int_equal(v.verdict, RHEO_UNREADABLE);
    }
    free(bytes);
    remove(PATH);
    remove(OTHER);
}

/* HEAD says for every stage whether it runs before, in or after the substeps. */
static void the_head_has_the_phases(void **unused)
{
    (void)unused;
    static const struct {
        const char *stage;
        uint32_t phase, wrong;
        const char *message;
    } CASES[] = {
        {"gravity", 0, 2, "damaged"},     {"substeps", 0, 1, "other stages"}, {"drag", 1, 0, "other stages"},
        {"flight", 1, 2, "other stages"}, {"floor", 2, 1, "other stages"},    {"floor", 2, 3, "damaged"},
        {"history", 2, 1, "damaged"},     {"history", 2, 0, "damaged"},       {"drag", 1, 1u << 31, "damaged"},
    };
    record(PATH, false, 1, NULL, NULL, 0);
    size_t size;
    uint8_t *bytes = read_file(PATH, &size);
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        static forged f;
        forge_open(&f, bytes, size, ROOM);
        forged_chunk *head = chunk_of(&f, RHEO__HEAD, 0);
        char text[34] = {(char)strlen(CASES[i].stage)};
        const size_t length = 2 + strlen(CASES[i].stage);
        memcpy(text + 2, CASES[i].stage, length - 2);
        size_t at =
            head->size - length; /* the list of stages follows that of the fields, one of which is `substeps` */
        while (memcmp(head->data + at, text, length) != 0)
            at--;
        assert_int_equal(forge_get(head->data + at + length, 4), CASES[i].phase);
        forge_put(head->data + at + length, CASES[i].wrong, 4);
        write_forged(&f);
        rheo_recording *r;
        rheo_world *world;
        rheo_result result = rheo_recording_open(OTHER, &r, &why);
        if (result == RHEO_OK) {
            result = rheo_recording_world(r, 0, NULL, &world, &why);
            rheo_recording_close(r);
        }
        if (result == RHEO_OK || !says(why.message, CASES[i].message))
            fail_msg("%s in phase %u: %s", CASES[i].stage, (unsigned)CASES[i].wrong, why.message);
    }
    free(bytes);
    remove(PATH);
    remove(OTHER);
}

/* Diff names the stage, before, in or after the substeps, in which a parameter acts. */
static void diff_finds_the_stage(void **unused)
{
    (void)unused;
    static const struct {
        const char *parameter, *value;
        uint64_t at;
        const char *stage, *field;
    } CASES[] = {
        {"drag.restitution", "0.5", 3, "floor", "velocity"},
        {"drag.restitution", "0.5", 4, "floor", "velocity"},
        {"drag.rate", "0.6", 5, "drag@1", "velocity"},
        {"gravity", "[0, -1, 0]", 6, "gravity", "velocity"},
    };
    for (int full = 0; full < 2; full++)
        for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
            rheo_verification v;
            record(PATH, full, 1, NULL, NULL, 0);
            record(OTHER, full, 1, CASES[i].parameter, CASES[i].value, CASES[i].at);
            OK(rheo_diff(PATH, OTHER, &v, &error));
            assert_true(v.verdict == RHEO_DIFFERS && v.first.step == CASES[i].at);
            assert_string_equal(v.first.stage, CASES[i].stage);
            assert_string_equal(v.first.field, CASES[i].field);
            assert_true(strcmp(v.first.stage, "floor") != 0 || v.first.id == CASES[i].at - 3);
        }
    remove(PATH);
    remove(OTHER);
}

/* ---- Failures ---- */

static void a_failed_step_names_its_stage_run_and_is_undone(void **unused)
{
    (void)unused;
    const double scale = sizeof(rheo_real) == 4 ? 1e10 : 1e285; /* two runs of drag overflow, or one of floor */
    static const struct {
        const char *parameter, *value;
        uint64_t at;
        const char *stage;
        unsigned drags; /* runs of stage drag: once until the state is checked, once more to find the stage */
    } CASES[] = {
        {"drag.rate", "1e22", 3, "drag@2", 2 + 2}, /* checked at the start of substep 3 */
        {"drag.rate", "1e22", 2, "drag@2", 2 + 2}, /* checked before history */
        {"drag.restitution", "1e30", 3, "floor", 3 + 3},
        {"drag.restitution", "1e30", 4, "floor", 1 + 1},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        rheo_world *world = falling_world(scale);
        rheo_failure failure;
        for (uint64_t n = 1; n < CASES[i].at; n++)
            OK(rheo_world_step(world, &error));
        OK(rheo_world_set(world, CASES[i].parameter, CASES[i].value, &error));
        const uint64_t hash = rheo_world_hash(world);
        drag_stage_runs = 0;
        REFUSED(RHEO_ERROR_STATE, CASES[i].stage, rheo_world_step(world, &error));
        assert_int_equal(drag_stage_runs, CASES[i].drags);
        assert_true(rheo_world_failure(world, &failure));
        assert_string_equal(failure.stage, CASES[i].stage);
        assert_string_equal(failure.field, "velocity");
        assert_true(rheo_world_hash(world) == hash && rheo_world_stages_done(world) == 0);
        uint32_t stage;
        rheo_result result = RHEO_OK;
        while (result == RHEO_OK)
            result = rheo_world_step_stage(world, &stage, &why);
        assert_true(result == RHEO_ERROR_STATE && rheo_world_failure(world, &failure));
        assert_string_equal(failure.stage, CASES[i].stage);
        assert_true(rheo_world_hash(world) == hash);
        rheo_world_destroy(world);

        /* The recording names it, too, and a player stops right before it. */
        record(PATH, false, scale, CASES[i].parameter, CASES[i].value, CASES[i].at);
        rheo_verification v;
        OK(rheo_verify(PATH, &v, &error));
        assert_true(v.verdict == RHEO_SAME && v.steps == CASES[i].at - 1);
        rheo_recording *recording;
        rheo_player *player = play(&recording);
        OK(rheo_player_seek_stage(player, CASES[i].at, "flight@1", &error));
        REFUSED(RHEO_ERROR_STATE, CASES[i].stage,
                rheo_player_seek_stage(player, CASES[i].at, CASES[i].stage, &error));
        REFUSED(RHEO_ERROR_STATE, CASES[i].stage, rheo_player_seek_stage(player, CASES[i].at, "history", &error));
        rheo_player_close(player);
        rheo_recording_close(recording);
    }
    remove(PATH);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_stages_run_in_three_phases),
        cmocka_unit_test(every_stage_run_is_reached),
        cmocka_unit_test(a_wrong_hash_is_named),
        cmocka_unit_test(a_wrong_number_of_hashes_is_refused),
        cmocka_unit_test(the_head_has_the_phases),
        cmocka_unit_test(diff_finds_the_stage),
        cmocka_unit_test(a_failed_step_names_its_stage_run_and_is_undone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
