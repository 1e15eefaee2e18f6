/* What was done is told: the commands of a recording, and how it was made. */
#define PATH "test_told.rlog"
#include "record_support.h"

#include "forge.h"

enum { ROOM = 1 << 22 };

static rheo_recording *opened(const uint8_t *bytes, size_t size)
{
    rheo_recording *r;
    OK(rheo_recording_open_memory(bytes, size, &r, &error));
    return r;
}

/* ---- Commands ---- */

/* The commands of record_support.h, in the order in which command() gives them. command(n) precedes step n + 1. */
static const struct {
    uint64_t step;
    rheo_command_kind kind;
    const char *text;
} GIVEN[] = {
    {3, RHEO_COMMAND_PUSH_BODY, "the ball was pushed by impulse [3, 1, -2]"},
    {4, RHEO_COMMAND_PUSH_BODY, "the ball was pushed by impulse [3, 1, -2] at [3, 6, 4]"},
    {4, RHEO_COMMAND_SET, "fluid.linear_viscosity was set to 0.7"},
    {5, RHEO_COMMAND_ADD_PARTICLES, "2 particles were added between [0, 20, 0] and [1, 23, 1]"},
    {6, RHEO_COMMAND_MOVE_VIBRATOR, "vibrator 1 was moved to x 0.5, z 1.5"},
    {6, RHEO_COMMAND_SET, "ball.spin was set to [1, 2, 3]"},
    {6, RHEO_COMMAND_SET, "step was set to 0.019"},
    {7, RHEO_COMMAND_SET, "history.stiffness was set to 0"},
};
enum { GIVEN_COUNT = sizeof GIVEN / sizeof *GIVEN };

static void assert_given(rheo_recording *r, uint64_t index)
{
    rheo_command c;
    OK(rheo_recording_command(r, index, &c, &error));
    assert_int_equal(c.step, GIVEN[index].step);
    assert_int_equal(c.kind, GIVEN[index].kind);
    assert_string_equal(c.text, GIVEN[index].text);
}

static void every_command_is_told_with_its_step_and_numbers(void **state)
{
    (void)state;
    size_t size;
    for (int full = 0; full < 2; full++) {
        uint8_t *bytes = record(3, 8, 3, full, NULL, &size);
        rheo_recording *r = opened(bytes, size);
        rheo_command c;
        assert_int_equal(rheo_recording_command_count(r), GIVEN_COUNT);
        for (uint64_t i = 0; i < GIVEN_COUNT; i++)
            assert_given(r, i);
        for (uint64_t i = GIVEN_COUNT; i-- > 0;) /* in any order */
            assert_given(r, i);
        assert_given(r, 6);
        assert_given(r, 5);
        assert_given(r, 6);
        OK(rheo_recording_command(r, 1, &c, &error));
        assert_true(c.index == 0 && c.has_point && c.vector[2] == -2 && c.point[1] == 6);
        OK(rheo_recording_command(r, 2, &c, &error));
        assert_string_equal(c.path, "fluid.linear_viscosity");
        assert_string_equal(c.value, "0.7");
        OK(rheo_recording_command(r, 3, &c, &error));
        assert_true(c.count == 2 && c.min[1] == 20 && c.max[1] == 23 && c.max[0] == 1);
        OK(rheo_recording_command(r, 4, &c, &error));
        assert_true(c.index == 1 && c.vector[0] == 0.5 && c.vector[1] == 1.5);
        assert_int_equal(rheo_recording_command(r, GIVEN_COUNT, &c, &why), RHEO_ERROR_ARGUMENT);
        assert_non_null(strstr(why.message, "there is no command 8 in the recording; it has 8"));
        rheo_recording_close(r);
        free(bytes);
    }
}

static void commands_before_a_failed_step_are_told(void **state)
{
    (void)state;
    const rheo_real fastest = sizeof(rheo_real) == 4 ? (rheo_real)3e38 : (rheo_real)1e308;
    const rheo_real position[3] = {9, 9, 9}, velocity[3] = {fastest, 0, 0};
    rheo_world *world = make_world(2);
    rheo_recorder *recorder;
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true}, &recorder, &error));
    OK(rheo_world_set(world, "gravity", "[0, -1, 0]", &error));
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_world_add_particles(world, 1, position, velocity, &error));
    OK(rheo_world_set(world, "step", "1e6", &error));
    assert_int_equal(rheo_recorder_step(recorder, &why), RHEO_ERROR_STATE);
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    size_t size;
    uint8_t *bytes = read_file(PATH, &size);
    remove(PATH);
    rheo_recording *r = opened(bytes, size);
    rheo_command c;
    assert_int_equal(rheo_recording_command_count(r), 3);
    OK(rheo_recording_command(r, 2, &c, &error));
    assert_int_equal(c.step, 2);
    assert_string_equal(c.text, "step was set to 1e6");
    OK(rheo_recording_command(r, 1, &c, &error));
    assert_int_equal(c.step, 2);
    assert_string_equal(c.text, "1 particle was added at [9, 9, 9]");
    OK(rheo_recording_command(r, 0, &c, &error));
    assert_int_equal(c.step, 1);
    rheo_recording_close(r);
    free(bytes);
}

static void damaged_commands_are_found(void **state)
{
    (void)state;
    size_t size;
    uint8_t *bytes = record(3, 8, 100, false, NULL, &size), *other = malloc(ROOM);
    for (size_t n = 0; n < GIVEN_COUNT; n++) {
        forged f;
        forge_open(&f, bytes, size, ROOM);
        forge_find(&f, RHEO__INPT, n)->size -= 1;
        const size_t forged_size = forge_write(&f, true, other, ROOM);
        forge_release(&f);
        rheo_recording *r = opened(other, forged_size);
        rheo_command c;
        for (uint64_t i = 0; i < GIVEN_COUNT; i++)
            assert_int_equal(rheo_recording_command(r, i, &c, &why), i == n ? RHEO_ERROR_FORMAT : RHEO_OK);
        rheo_recording_close(r);
    }
    free(other);
    free(bytes);
}

/* A recording of the other number type cannot be simulated, but what was done to it can be told. */
static void commands_of_the_other_number_type_are_told(void **state)
{
    (void)state;
    rheo__bytes bytes = {0};
    const double position[6] = {1, 2, 3, 4, -5, 6};
    float small[6];
    for (int i = 0; i < 6; i++)
        small[i] = (float)position[i];
    const void *values[2] = {small, position};
    for (size_t k = 0; k < 2; k++) {
        rheo_command c;
        bytes.size = 0;
        rheo__put_u32(&bytes, RHEO_COMMAND_ADD_PARTICLES);
        rheo__put_u32(&bytes, 2);
        rheo__put_planes(&bytes, values[k], 6, 4 + 4 * k);
        rheo__put_planes(&bytes, values[k], 6, 4 + 4 * k);
        rheo__cursor cursor = rheo__cursor_over(&bytes);
        OK(rheo__command_describe(&cursor, 9, 4 + 4 * k, &c, &error));
        assert_string_equal(c.text, "2 particles were added between [1, -5, 3] and [4, 2, 6]");
        cursor.offset = 0;
        assert_int_equal(rheo__command_describe(&cursor, 9, 8 - 4 * k, &c, &why), RHEO_ERROR_FORMAT);
    }
    rheo__bytes_release(&bytes);
}

/* ---- How it was made ---- */

static rheo_result record_made(const char *made_by, const char *scene_text, uint8_t **bytes, size_t *size)
{
    rheo_world *world = make_world(2);
    rheo_recorder *recorder;
    const rheo_record_options options = {.force = true, .made_by = made_by, .scene_text = scene_text};
    const rheo_result result = rheo_recorder_open(world, PATH, &options, &recorder, &why);
    if (result == RHEO_OK) {
        OK(rheo_recorder_step(recorder, &error));
        OK(rheo_recorder_close(recorder, &error));
        *bytes = read_file(PATH, size);
    }
    rheo_world_destroy(world);
    remove(PATH);
    return result;
}

static void a_recording_tells_how_it_was_made(void **state)
{
    (void)state;
    uint8_t *bytes, *same, *none;
    size_t size, same_size, none_size;
    OK(record_made("my game --level 3", "{\"scene\": \"mine\"}", &bytes, &size));
    OK(record_made("my game --level 3", "{\"scene\": \"mine\"}", &same, &same_size));
    OK(record_made(NULL, NULL, &none, &none_size));
    assert_int_equal(size, same_size);
    assert_memory_equal(bytes, same, size);
    rheo_recording *r = opened(bytes, size);
    assert_string_equal(rheo_recording_get_info(r).made_by, "my game --level 3");
    assert_string_equal(rheo_recording_get_info(r).scene_text, "{\"scene\": \"mine\"}");
    rheo_recording_close(r);
    r = opened(none, none_size);
    assert_string_equal(rheo_recording_get_info(r).made_by, "");
    assert_string_equal(rheo_recording_get_info(r).scene_text, "");
    rheo_recording_close(r);

    /* It is an optional chunk after HEAD and nothing else is different, so the format is the same. */
    const size_t head = 8 + 36 + (size_t)forge_get(bytes + 24, 8),
                 made = 36 + (size_t)forge_get(bytes + head + 16, 8);
    assert_memory_equal(bytes, none, head);
    assert_memory_equal(bytes + head, "MADE", 4);
    assert_int_equal(forge_get(bytes + head + 4, 4) & 1, RHEO__CHUNK_OPTIONAL);
    assert_int_equal(size - none_size, made);
    rheo_verification v;
    OK(rheo_verify_memory(bytes, size, &v, &error));
    assert_int_equal(v.verdict, RHEO_SAME);
    OK(rheo_diff_memory(bytes, size, none, none_size, &v, &error));
    assert_int_equal(v.verdict, RHEO_SAME);
    free(bytes);
    free(same);
    free(none);
}

static void texts_that_are_too_long_are_refused(void **state)
{
    (void)state;
    uint8_t *bytes;
    size_t size;
    char *text = malloc(RHEO_MAX_MADE_TEXT + 2);
    memset(text, 'a', RHEO_MAX_MADE_TEXT + 1);
    text[RHEO_MAX_MADE_TEXT + 1] = 0;
    assert_int_equal(record_made(text, NULL, &bytes, &size), RHEO_ERROR_ARGUMENT);
    assert_non_null(strstr(why.message, "made_by has 8000001 bytes; at most 8000000 are possible"));
    assert_int_equal(record_made(NULL, text, &bytes, &size), RHEO_ERROR_ARGUMENT);
    assert_non_null(strstr(why.message, "scene_text has 8000001 bytes"));
    text[RHEO_MAX_MADE_TEXT] = 0;
    OK(record_made(text, text, &bytes, &size));
    rheo_recording *r = opened(bytes, size);
    assert_int_equal(strlen(rheo_recording_get_info(r).scene_text), RHEO_MAX_MADE_TEXT);
    rheo_recording_close(r);
    free(bytes);
    free(text);
}

static void assert_damaged(forged *f, const char *part)
{
    uint8_t *other = malloc(ROOM);
    const size_t size = forge_write(f, true, other, ROOM);
    rheo_recording *r;
    assert_int_equal(rheo_recording_open_memory(other, size, &r, &why), RHEO_ERROR_FORMAT);
    if (!strstr(why.message, part))
        fail_msg("\"%s\" is missing in: %s", part, why.message);
    free(other);
}

static void a_damaged_origin_is_found(void **state)
{
    (void)state;
    uint8_t *bytes;
    size_t size;
    OK(record_made("program", "scene", &bytes, &size));
    forged f;
    forge_open(&f, bytes, size, ROOM);
    forged_chunk *made = forge_find(&f, RHEO__MADE, 0);
    const size_t place = (size_t)(made - f.chunk);
    for (made->size = 0; made->size < 20; made->size++)
        assert_damaged(&f, "how the recording was made cannot be read");
    uint8_t *longer = realloc(made->data, 21); /* a byte behind the texts */
    assert_non_null(longer);
    made->data = longer;
    made->data[20] = 'x';
    made->size = 21;
    assert_damaged(&f, "how the recording was made cannot be read");
    made->size = 20;
    made->data[5] = 0; /* inside of the text */
    assert_damaged(&f, "how the recording was made cannot be read");
    made->data[5] = 'r';
    made->data[3] = 0xFF; /* a length beyond the end */
    assert_damaged(&f, "how the recording was made cannot be read");
    made->data[3] = 0;
    made->flags = 0;
    assert_damaged(&f, "damaged");
    made->flags = RHEO__CHUNK_OPTIONAL;
    forge_insert(&f, place, RHEO__MADE, RHEO__CHUNK_OPTIONAL, 0, made->data, made->size);
    assert_damaged(&f, "MADE");
    forge_remove(&f, place);
    forge_insert(&f, f.count - 2, RHEO__MADE, RHEO__CHUNK_OPTIONAL, 0, f.chunk[place].data, f.chunk[place].size);
    forge_remove(&f, place);
    assert_damaged(&f, "does not follow HEAD");
    forge_release(&f);
    free(bytes);
}

/* ---- Texts from anyone ---- */

static const char *const HOSTILE[] = {"a\x1b[2J", "a\nb", "a\rb", "a\tb", "a\x7f", "a\xc2\x9b[2J", "a\xff", "a\xc3"};

static void an_origin_with_control_characters_is_not_written(void **state)
{
    (void)state;
    uint8_t *bytes;
    size_t size;
    for (size_t i = 0; i < sizeof HOSTILE / sizeof *HOSTILE; i++) {
        const bool is_scene = strpbrk(HOSTILE[i], "\n\t") != NULL; /* a scene has lines */
        assert_int_equal(record_made(HOSTILE[i], NULL, &bytes, &size), RHEO_ERROR_ARGUMENT);
        assert_non_null(strstr(why.message, "made_by has control characters or is not UTF-8"));
        assert_int_equal(record_made(NULL, HOSTILE[i], &bytes, &size), is_scene ? RHEO_OK : RHEO_ERROR_ARGUMENT);
        if (is_scene)
            free(bytes);
    }
    OK(record_made("K\xc3\xb6ln \xe2\x9c\x93", NULL, &bytes, &size));
    free(bytes);
}

/* The recording itself is as good as any. */
static void an_origin_with_control_characters_is_not_told(void **state)
{
    (void)state;
    uint8_t *bytes, *other = malloc(ROOM);
    size_t size;
    OK(record_made("program", "scene", &bytes, &size));
    for (size_t i = 0; i < sizeof HOSTILE / sizeof *HOSTILE; i++) {
        forged f;
        forge_open(&f, bytes, size, ROOM);
        forged_chunk *made = forge_find(&f, RHEO__MADE, 0);
        const size_t length = strlen(HOSTILE[i]);
        made->data = realloc(made->data, length + 8);
        made->size = length + 8;
        forge_put(made->data, length, 4);
        memcpy(made->data + 4, HOSTILE[i], length);
        forge_put(made->data + 4 + length, 0, 4);
        const size_t forged_size = forge_write(&f, true, other, ROOM);
        forge_release(&f);
        rheo_recording *r = opened(other, forged_size);
        const rheo_recording_info info = rheo_recording_get_info(r);
        assert_true(info.made_refused);
        assert_string_equal(info.made_by, "");
        rheo_recording_close(r);
        rheo_verification v;
        OK(rheo_verify_memory(other, forged_size, &v, &error));
        assert_int_equal(v.verdict, RHEO_SAME);
    }
    rheo_recording *r = opened(bytes, size);
    assert_false(rheo_recording_get_info(r).made_refused);
    rheo_recording_close(r);
    free(other);
    free(bytes);
}

static void an_origin_that_is_too_long_is_not_told(void **state)
{
    (void)state;
    rheo__bytes bytes = {0};
    rheo__made made;
    for (size_t more = 0; more < 2; more++) {
        bytes.size = 0;
        rheo__put_u32(&bytes, 0);
        rheo__put_u32(&bytes, (uint32_t)(RHEO_MAX_MADE_TEXT + more));
        const size_t at = bytes.size;
        assert_true(rheo__bytes_resize(&bytes, at + RHEO_MAX_MADE_TEXT + more));
        memset(bytes.data + at, 'a', RHEO_MAX_MADE_TEXT + more);
        rheo__cursor cursor = rheo__cursor_over(&bytes);
        OK(rheo__made_get(&cursor, &made, &error));
        assert_int_equal(made.refused, more == 1);
        assert_int_equal(strlen(made.scene), more ? 0 : RHEO_MAX_MADE_TEXT);
        rheo__made_release(&made);
    }
    rheo__bytes_release(&bytes);
}

static void texts_of_a_recording_are_made_printable(void **state)
{
    (void)state;
    rheo__bytes bytes = {0};
    rheo_command c;
    rheo__put_u32(&bytes, RHEO_COMMAND_SET);
    rheo__put_text(&bytes, "step\x1b[2J");
    rheo__put_text(&bytes, "1\n2\xff\xc2\x9b\x7f \xc3\xb6");
    rheo__cursor cursor = rheo__cursor_over(&bytes);
    OK(rheo__command_describe(&cursor, 9, sizeof(rheo_real), &c, &error));
    assert_string_equal(c.text, "step?[2J was set to 1 2????"
                                " \xc3\xb6");
    assert_string_equal(c.path, "step?[2J");
    assert_string_equal(c.value, "1 2????"
                                 " \xc3\xb6");
    /* The error that follows from giving it again. */
    rheo_world *world = make_world(2);
    cursor = rheo__cursor_over(&bytes);
    assert_int_equal(rheo__command_apply(&cursor, world, &why), RHEO_ERROR_FORMAT);
    assert_non_null(strstr(why.message, "step?[2J"));
    rheo__bytes_release(&bytes);

    rheo_recorder *recorder;
    OK(rheo_recorder_open(world, PATH, &(rheo_record_options){.force = true, .scene = "a\x1b[2J"}, &recorder,
                          &error));
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    rheo_verification v;
    OK(rheo_bless("blessed_" PATH, PATH, "because\nof \x1b[2J", false, &v, &error));
    rheo_recording *r;
    OK(rheo_recording_open("blessed_" PATH, &r, &error));
    assert_string_equal(rheo_recording_get_info(r).scene, "a?[2J");
    rheo_blessing blessing;
    OK(rheo_recording_blessing(r, 0, &blessing));
    assert_int_equal(strncmp(blessing.because, "because of ?[2J [", 17), 0);
    rheo_recording_close(r);
    remove(PATH);
    remove("blessed_" PATH);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_command_is_told_with_its_step_and_numbers),
        cmocka_unit_test(commands_before_a_failed_step_are_told),
        cmocka_unit_test(damaged_commands_are_found),
        cmocka_unit_test(commands_of_the_other_number_type_are_told),
        cmocka_unit_test(a_recording_tells_how_it_was_made),
        cmocka_unit_test(texts_that_are_too_long_are_refused),
        cmocka_unit_test(a_damaged_origin_is_found),
        cmocka_unit_test(an_origin_with_control_characters_is_not_written),
        cmocka_unit_test(an_origin_with_control_characters_is_not_told),
        cmocka_unit_test(an_origin_that_is_too_long_is_not_told),
        cmocka_unit_test(texts_of_a_recording_are_made_printable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
