/* The program's JSON writer: escapes, numbers, nesting, layout. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <math.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "json/json_writer.h"

static char text[4096];
static rheo__json json;

static void begin(unsigned lines)
{
    FILE *file = tmpfile();
    assert_non_null(file);
    json = (rheo__json){.file = file, .lines = lines};
}

static void assert_written(const char *expected)
{
    rewind(json.file);
    text[fread(text, 1, sizeof text - 1, json.file)] = 0;
    fclose(json.file);
    assert_string_equal(text, expected);
}

static void brackets_without_members(void **state)
{
    (void)state;
    begin(0);
    rheo__json_begin_object(&json, NULL);
    rheo__json_end_object(&json);
    rheo__json_begin_object(&json, NULL);
    rheo__json_begin_list(&json, "list");
    rheo__json_end_list(&json);
    rheo__json_begin_object(&json, "object");
    rheo__json_end_object(&json);
    rheo__json_vector(&json, "vector", NULL, 0);
    rheo__json_end_object(&json);
    assert_written("{}\n{\"list\": [], \"object\": {}, \"vector\": []}\n");
}

static void every_value_and_nesting(void **state)
{
    (void)state;
    const double v[] = {0, -1.5, 1e300};
    begin(0);
    rheo__json_begin_object(&json, NULL);
    rheo__json_integer(&json, "integer", UINT64_MAX);
    rheo__json_bool(&json, "yes", true);
    rheo__json_bool(&json, "no", false);
    rheo__json_null(&json, "null");
    rheo__json_known_integer(&json, "known", true, 7);
    rheo__json_known_integer(&json, "unknown", false, 7);
    rheo__json_index(&json, "first", 0);
    rheo__json_index(&json, "none", -1);
    rheo__json_text(&json, "text", NULL);
    rheo__json_hash(&json, "hash", 0xabc);
    rheo__json_begin_list(&json, "list");
    rheo__json_number(&json, NULL, 1);
    rheo__json_begin_list(&json, NULL);
    rheo__json_begin_object(&json, NULL);
    rheo__json_vector(&json, "v", v, 3);
    rheo__json_end_object(&json);
    rheo__json_end_list(&json);
    rheo__json_text(&json, NULL, "end");
    rheo__json_end_list(&json);
    rheo__json_text(&json, "after", "");
    rheo__json_end_object(&json);
    assert_written(
        "{\"integer\": 18446744073709551615, \"yes\": true, \"no\": false, \"null\": null, \"known\": 7, \"unknown\": null, \"first\": 0, \"none\": null, \"text\": null, "
        "\"hash\": \"0000000000000abc\", \"list\": [1, [{\"v\": [0, -1.5, 1e+300]}], \"end\"], "
        "\"after\": \"\"}\n");
}

static void numbers_are_short_and_read_back(void **state)
{
    (void)state;
    begin(0);
    rheo__json_begin_list(&json, NULL);
    rheo__json_number(&json, NULL, 0.1);
    rheo__json_number(&json, NULL, 1. / 3);
    rheo__json_number(&json, NULL, -0.);
    rheo__json_number(&json, NULL, (double)NAN);
    rheo__json_number(&json, NULL, (double)-INFINITY);
    rheo__json_decimals(&json, NULL, 3, 2.5);
    rheo__json_decimals(&json, NULL, 0, 2e9);
    rheo__json_decimals(&json, NULL, -2, 0.00123);
    rheo__json_decimals(&json, NULL, 1, (double)NAN);
    rheo__json_end_list(&json);
    assert_written("[0.1, 0.3333333333333333, -0.0, null, null, 2.500, 2000000000, 1.23e-03, null]\n");
}

static void any_double_reads_back(void **state)
{
    (void)state;
    static const double values[] = {1. / 3, 0.1 + 0.2, DBL_MAX, DBL_MIN, 4.9406564584124654e-324, 1e23, -7.0 / 11};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        rheo__number_text(values[i], text, 32);
        assert_true(strtod(text, NULL) == values[i]);
    }
    rheo__number_text((double)NAN, text, 32);
    assert_string_equal(text, "nan");
    rheo__number_text(-(double)INFINITY, text, 32);
    assert_string_equal(text, "-inf");
}

static void text_is_escaped(void **state)
{
    (void)state;
    begin(0);
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "a\"b", "\\ \" \n \t \x7f");
    rheo__json_text(&json, "utf-8", "gr\xc3\xbc\xc3\x9f \xf0\x9f\x90\x87");
    /* A lone continuation byte, an overlong slash, a surrogate, and a character cut off by the end. */
    rheo__json_text(&json, "broken", "\x80 \xc0\xaf \xed\xa0\x80 \xe2\x82");
    rheo__json_end_object(&json);
    assert_written("{\"a\\\"b\": \"\\\\ \\\" \\u000a \\u0009 \\u007f\", "
                   "\"utf-8\": \"gr\xc3\xbc\xc3\x9f \xf0\x9f\x90\x87\", "
                   "\"broken\": \"\\ufffd \\ufffd\\ufffd \\ufffd\\ufffd\\ufffd \\ufffd\\ufffd\"}\n");
}

static void members_down_to_a_depth_have_lines(void **state)
{
    (void)state;
    const double v[] = {1, 2};
    begin(2);
    rheo__json_begin_object(&json, NULL);
    rheo__json_number(&json, "a", 1);
    rheo__json_begin_object(&json, "group");
    rheo__json_vector(&json, "v", v, 2);
    rheo__json_begin_list(&json, "list");
    rheo__json_number(&json, NULL, 1);
    rheo__json_number(&json, NULL, 2);
    rheo__json_end_list(&json);
    rheo__json_end_object(&json);
    rheo__json_begin_list(&json, "empty");
    rheo__json_end_list(&json);
    rheo__json_end_object(&json);
    assert_written("{\n"
                   "    \"a\": 1,\n"
                   "    \"group\": {\n"
                   "        \"v\": [1, 2],\n"
                   "        \"list\": [1, 2]\n"
                   "    },\n"
                   "    \"empty\": []\n"
                   "}\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brackets_without_members),
        cmocka_unit_test(every_value_and_nesting),
        cmocka_unit_test(numbers_are_short_and_read_back),
        cmocka_unit_test(any_double_reads_back),
        cmocka_unit_test(text_is_escaped),
        cmocka_unit_test(members_down_to_a_depth_have_lines),
    };
    return cmocka_run_group_tests_name("json_writer", tests, NULL, NULL);
}
