/*
 * Rung statistics: members of a recording, what they find, and their chunk. A hook turns the order of the sweeps of scheme
 * sequential: an order as good as any other, but other bits and another step.
 */
#define PATH "test_same_statistics.rlog"
#define OTHER "test_same_statistics_other.rlog"

#include "forge.h"
#include "record_support.h"
#include "record/members.h"
#include "thickening/thickening.h"
#include "world/model_thickening.h"

enum { MEMBERS = 12, STEPS = 160 };

/* ---- Another order of sweeps ---- */

static bool turned;

/* Begins each round of colours with the second one. Lines of one colour share no particle, so their order does not count. */
static void turn_sweeps(rheo_world *world, uint32_t stage)
{
    const char *name = world->stage[stage].name;
    if (!turned || (strcmp(name, "neighbours") != 0 && strcmp(name, "neighbours_start") != 0))
        return;
    rheo__neighbours *list = &rheo__thickening_of(world)->list;
    rheo__line *lines = calloc(list->line_count + (size_t)1, sizeof *lines);
    uint32_t *start = calloc(list->group_count + (size_t)1, sizeof *start), place = 0;
    for (uint32_t group = 0; group < list->group_count; group++) {
        const uint32_t from = group / RHEO__COLOURS * RHEO__COLOURS + (group + 1) % RHEO__COLOURS;
        start[group] = place;
        for (uint32_t line = list->group_start[from]; line < list->group_start[from + 1]; line++)
            lines[place++] = list->line[line];
    }
    start[list->group_count] = place;
    memcpy(list->line, lines, place * sizeof *lines);
    memcpy(list->group_start, start, (list->group_count + (size_t)1) * sizeof *start);
    free(lines);
    free(start);
}

/* ---- Recordings ---- */

static void record_scene(const char *name, const char *scheme_name, const char *resolution, uint64_t steps)
{
    rheo_scene scene;
    rheo_world *world;
    rheo_recorder *recorder;
    OK(rheo_scene_builtin(name, &scene, &error));
    if (scheme_name)
        OK(rheo_scene_set(&scene, "scheme", scheme_name, &error));
    OK(rheo_scene_set(&scene, "resolution", resolution, &error));
    OK(rheo_scene_create_world(&scene, &world, &error));
    remove(PATH);
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.keyframe_spacing = 1000}, &recorder, &error));
    for (uint64_t n = 0; n < steps; n++)
        OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    rheo_scene_release(&scene);
}

static int make_ball(void **state)
{
    (void)state;
    rheo__sabotage = turn_sweeps;
    turned = false;
    record_scene("bowling-ball-small", "sequential", "0.4", STEPS);
    OK(rheo_same_keep_members(PATH, MEMBERS, 1, &error));
    return 0;
}

static int remove_files(void **state)
{
    (void)state;
    remove(PATH);
    remove(OTHER);
    return 0;
}

static rheo_same_result compare(const char *assignment, uint32_t members)
{
    rheo_same_options options = rheo_default_same_options();
    rheo_same_result result;
    options.members = members;
    options.set = &assignment;
    options.set_count = assignment != NULL;
    OK(rheo_same(PATH, &options, &result, &error));
    return result;
}

static rheo_recording *open_it(const char *path)
{
    rheo_recording *r;
    OK(rheo_recording_open(path, &r, &error));
    return r;
}

/* ---- What it finds ---- */

static void another_order_of_sweeps_is_statistics(void **state)
{
    (void)state;
    turned = true;
    const rheo_same_result result = compare(NULL, MEMBERS), again = compare(NULL, MEMBERS);
    turned = false;
    if (result.verdict != RHEO_SAMENESS_STATISTICS)
        fail_msg("%s: %s, p = %g", result.message, result.statistics.metrics[0].name, result.statistics.metrics[0].p);
    assert_false(result.bits_passed);
    assert_true(result.bits_steps < 2); /* it is another order from the first step on */
    assert_true(result.statistics.stored);
    assert_true(result.statistics.metric_count >= 20);
    assert_true(result.statistics.metrics[0].p < 1); /* the members are not the recorded ones */
    /* It is seeded, so it never flakes: not a bit of the statistics changes. */
    assert_memory_equal(&result.statistics, &again.statistics, sizeof result.statistics);
}

static void a_stiffness_of_the_history_times_1_02_differs(void **state)
{
    (void)state;
    const rheo_same_result result = compare("history.stiffness=19.125", MEMBERS);
    const rheo_same_statistics *s = &result.statistics;
    assert_int_equal(result.verdict, RHEO_SAMENESS_DIFFERS);
    assert_true(s->tried && !s->passed && s->rejected >= 3 && s->metrics[0].rejected);
    assert_true(s->metrics[0].shift > 2);
    for (uint32_t i = 1; i < s->metric_count && i < RHEO_MOST_SAME_METRICS; i++)
        assert_true(s->metrics[i - 1].p <= s->metrics[i].p);
}

static void the_same_stiffness_is_the_same(void **state)
{
    (void)state;
    rheo_same_options options = rheo_default_same_options();
    rheo_same_result result;
    options.members = MEMBERS;
    options.self_check = true;
    OK(rheo_same(PATH, &options, &result, &error));
    assert_int_equal(result.verdict, RHEO_SAMENESS_BITS);
    assert_true(result.statistics.passed);
    assert_true(result.statistics.metrics[0].p == 1);
    assert_int_equal(result.statistics.self_checks, 1000);
    assert_true(result.statistics.false_alarms <= 10);
}

static void a_run_that_goes_bad_differs(void **state)
{
    (void)state;
    const rheo_same_result result = compare("history.stiffness=1e9", 8);
    assert_int_equal(result.verdict, RHEO_SAMENESS_DIFFERS);
    assert_true(result.statistics.went_bad);
    assert_true(says(result.statistics.why, "member 1 of 8"));
}

/* ---- Where rounding is amplified ---- */

static void rounding_moves_members_only_where_it_is_amplified(void **state)
{
    (void)state;
    rheo_recording *r = open_it(PATH);
    assert_true(r->members->moved > 0);
    assert_int_equal(rheo_recording_member_count(r), MEMBERS);
    rheo_recording_close(r);
    record_scene("melting-box", NULL, "0.4", 160);
    OK(rheo_same_keep_members(PATH, 8, 1, &error));
    r = open_it(PATH);
    /* 1 ulp of double is half a billionth of that of float, and stays small in these steps. */
    assert_true(sizeof(rheo_real) == 4 ? r->members->moved == 0 : r->members->moved > 0);
    if (sizeof(rheo_real) != 4) {
        rheo_recording_close(r);
        make_ball(NULL);
        return;
    }
    /* The early means are known to the rounding of the positions, the late ones are not. */
    double spread[2] = {0, 0};
    uint32_t parts = 0;
    for (uint32_t i = 0; i < r->members->values; i++) {
        const rheo__member_value *v = &r->members->value[i];
        const double *x = r->members->result + i * (size_t)8;
        if (strcmp(v->metric, "kinetic_energy") != 0 || v->kind != RHEO__MEMBER_MEAN)
            continue;
        double least = x[0], largest = x[0];
        for (int k = 1; k < 8; k++) {
            least = x[k] < least ? x[k] : least;
            largest = x[k] > largest ? x[k] : largest;
        }
        spread[parts++ / 2] += (largest - least) / least;
    }
    assert_int_equal(parts, RHEO__MEMBER_PARTS);
    assert_true(spread[0] < 1e-3 && spread[1] > 1e-2);
    rheo_recording_close(r);
    /* So no value of the early ones is tested, and of the late ones some are. */
    const rheo_same_result result = compare("melting.viscosity=100", 8);
    assert_true(result.statistics.left_out > 0);
    for (uint32_t i = 0; i < result.statistics.metric_count && i < RHEO_MOST_SAME_METRICS; i++)
        assert_false(says(result.statistics.metrics[i].name, "kinetic_energy, mean of steps 41"));
    make_ball(NULL);
}

/* ---- The chunk ---- */

static void a_recording_without_members_says_what_to_do(void **state)
{
    (void)state;
    size_t size;
    static uint8_t changed[4000000];
    forged f;
    uint8_t *bytes = read_file(PATH, &size);
    forge_open(&f, bytes, size, sizeof changed);
    forge_remove(&f, (size_t)(forge_find(&f, RHEO__MEMB, 0) - f.chunk));
    const size_t left = forge_write(&f, true, changed, sizeof changed);
    write_file(PATH, changed, left);
    turned = true;
    rheo_same_result result;
    REFUSED(RHEO_ERROR_UNSUPPORTED, "--keep-members", rheo_same(PATH, NULL, &result, &error));
    assert_int_equal(result.verdict, RHEO_SAMENESS_UNKNOWN);
    REFUSED(RHEO_ERROR_DIFFERS, "does not verify", rheo_same_keep_members(PATH, MEMBERS, 1, &error));
    turned = false;
    /* A build that reproduces the recording makes both sides itself; kept or made, the members are the same. */
    const rheo_same_result made = compare("history.stiffness=19.125", MEMBERS);
    assert_false(made.statistics.stored);
    write_file(PATH, bytes, size);
    rheo_same_result stored = compare("history.stiffness=19.125", MEMBERS);
    assert_true(stored.statistics.stored);
    stored.statistics.stored = false;
    assert_memory_equal(&made.statistics, &stored.statistics, sizeof made.statistics);
    free(bytes);
    forge_release(&f);
}

/* A reader that does not know the type skips the chunk: here this one, since the type has another letter. */
static void readers_that_do_not_know_members_skip_them(void **state)
{
    (void)state;
    size_t size;
    static uint8_t changed[4000000];
    forged f;
    rheo_verification v;
    uint8_t *bytes = read_file(PATH, &size);
    forge_open(&f, bytes, size, sizeof changed);
    forge_find(&f, RHEO__MEMB, 0)->type = RHEO__CHUNK('X', 'E', 'M', 'B');
    write_file(OTHER, changed, forge_write(&f, true, changed, sizeof changed));
    OK(rheo_verify(OTHER, &v, &error));
    assert_int_equal(v.verdict, RHEO_SAME);
    assert_int_equal(v.steps, STEPS);
    free(bytes);
    forge_release(&f);
}

static void damaged_members_are_told(void **state)
{
    (void)state;
    size_t size, place = 0;
    static uint8_t changed[4000000];
    uint8_t *bytes = read_file(PATH, &size);
    rheo_same_result result;
    while (memcmp(bytes + place, "MEMB", 4) != 0)
        place++;
    bytes[place + 100] ^= 1;
    write_file(OTHER, bytes, size);
    REFUSED(RHEO_ERROR_FORMAT, "does not have its check sum", rheo_same(OTHER, NULL, &result, &error));
    bytes[place + 100] ^= 1;
    /* Contents that no recorder writes, with the right check sum: each number of the beginning, and a cut. */
    const size_t text = 2 + strlen(rheo_build());
    for (size_t at = text; at < text + 24 + 2; at++) {
        forged f;
        forge_open(&f, bytes, size, sizeof changed);
        forged_chunk *c = forge_find(&f, RHEO__MEMB, 0);
        if (at == text + 24 + 1)
            c->size -= 1;
        else if (at == text + 24)
            memset(c->data + c->size - 8, 0xFF, 8); /* a result that is not a number */
        else if (at >= text + 8)                    /* any seed will do */
            c->data[at] ^= 0xFF;
        else
            memset(c->data + text + 16, 0, 4); /* no members */
        write_file(OTHER, changed, forge_write(&f, true, changed, sizeof changed));
        rheo_recording *r;
        const rheo_result opened = rheo_recording_open(OTHER, &r, &why);
        if (opened == RHEO_OK) /* less than a part in a million of the move */
            assert_true(at < text + 16);
        else
            assert_int_equal(opened, RHEO_ERROR_FORMAT);
        if (opened == RHEO_OK)
            rheo_recording_close(r);
        forge_release(&f);
    }
    free(bytes);
}

/* ---- Keeping and blessing ---- */

static void members_can_be_kept_in_a_blessed_recording(void **state)
{
    (void)state;
    size_t size, again;
    rheo_verification v;
    free(read_file(PATH, &size));
    remove(OTHER);
    OK(rheo_bless(OTHER, PATH, "the first one", false, &v, &error));
    rheo_recording *r = open_it(OTHER);
    assert_int_equal(rheo_recording_member_count(r), MEMBERS); /* they were copied */
    assert_true(rheo_recording_get_info(r).blessed);
    rheo_recording_close(r);
    OK(rheo_same_keep_members(OTHER, 9, 5, &error));
    r = open_it(OTHER);
    assert_int_equal(rheo_recording_member_count(r), 9); /* in the place of the others */
    assert_int_equal(rheo_recording_blessing_count(r), 1);
    assert_true(rheo_recording_get_info(r).blessed && rheo_recording_get_info(r).complete);
    rheo_recording_close(r);
    OK(rheo_verify(OTHER, &v, &error));
    assert_int_equal(v.verdict, RHEO_SAME);
    /* The same members once more: the same bytes. */
    uint8_t *first = read_file(OTHER, &size);
    OK(rheo_same_keep_members(OTHER, 9, 5, &error));
    uint8_t *second = read_file(OTHER, &again);
    assert_int_equal(size, again);
    assert_memory_equal(first, second, size);
    free(first);
    free(second);
}

static void a_blessing_does_not_lose_members_unsaid(void **state)
{
    (void)state;
    rheo_verification v;
    remove(OTHER);
    OK(rheo_bless(OTHER, PATH, "the first one", false, &v, &error));
    record_scene("bowling-ball-small", "sequential", "0.4", STEPS + 1);
    REFUSED(RHEO_ERROR_ARGUMENT, "--keep-members", rheo_bless(OTHER, PATH, "longer", false, &v, &error));
    OK(rheo_bless(OTHER, PATH, "longer", true, &v, &error));
    make_ball(NULL);
}

static bool stop_at_3(const char *task, uint64_t done, uint64_t total, void *user)
{
    (void)total, (void)user;
    return strcmp(task, "running members") != 0 || done < 3;
}

static void an_interruption_leaves_the_file_as_it_was(void **state)
{
    (void)state;
    size_t size, after;
    uint8_t *before = read_file(PATH, &size);
    const rheo_progress old = rheo_use_progress((rheo_progress){stop_at_3, NULL});
    assert_int_equal(rheo_same_keep_members(PATH, MEMBERS, 7, &why), RHEO_ERROR_STOPPED);
    char stopped[64]; /* members are not steps */
    snprintf(stopped, sizeof stopped, "stopped while running members: 3 of %d done", MEMBERS);
    assert_non_null(strstr(why.message, stopped));
    rheo_use_progress(old);
    uint8_t *now = read_file(PATH, &after);
    assert_int_equal(size, after);
    assert_memory_equal(before, now, size);
    free(before);
    free(now);
}

static void what_cannot_have_members_is_refused(void **state)
{
    (void)state;
    REFUSED(RHEO_ERROR_ARGUMENT, "must be 8 to 64", rheo_same_keep_members(PATH, 7, 1, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "must be 8 to 64", rheo_same_keep_members(PATH, 65, 1, &error));
    REFUSED(RHEO_ERROR_FILE, "cannot read", rheo_same_keep_members("no such file", 8, 1, &error));
    record_scene("drop", NULL, "0.4", 15);
    REFUSED(RHEO_ERROR_ARGUMENT, "at least 16", rheo_same_keep_members(PATH, 8, 1, &error));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(another_order_of_sweeps_is_statistics),
        cmocka_unit_test(a_stiffness_of_the_history_times_1_02_differs),
        cmocka_unit_test(the_same_stiffness_is_the_same),
        cmocka_unit_test(a_run_that_goes_bad_differs),
        cmocka_unit_test(rounding_moves_members_only_where_it_is_amplified),
        cmocka_unit_test(a_recording_without_members_says_what_to_do),
        cmocka_unit_test(readers_that_do_not_know_members_skip_them),
        cmocka_unit_test(damaged_members_are_told),
        cmocka_unit_test(members_can_be_kept_in_a_blessed_recording),
        cmocka_unit_test(a_blessing_does_not_lose_members_unsaid),
        cmocka_unit_test(an_interruption_leaves_the_file_as_it_was),
        cmocka_unit_test(what_cannot_have_members_is_refused),
    };
    return cmocka_run_group_tests(tests, make_ball, remove_files);
}
