/* Numbers and texts for people. */
#include "support.h"

#include <float.h>
#include <locale.h>
#include <math.h>

#include "core/error.h"
#include "core/math.h"
#include "core/text.h"

static void assert_brief(double value, int digits, bool down, const char *expected)
{
    char text[32];
    assert_string_equal(rheo__text_brief(value, digits, down, text), expected);
}

static void brief_numbers_have_few_digits_at_any_size(void **state)
{
    (void)state;
    assert_brief(0, 3, false, "0");
    assert_brief(1234.5, 3, false, "1230");
    assert_brief(-0.012345, 2, false, "-0.012");
    assert_brief(0.0199, 2, true, "0.019");
    assert_brief(0.0199, 2, false, "0.02");
    assert_brief(9.999, 2, false, "10");
    assert_brief(NAN, 2, false, "not a number");
    assert_brief(-INFINITY, 2, false, "infinite");
    /* All other powers of ten, those beyond 2^53 and near the largest number included. */
    for (int power = 16; power <= 308; power++) {
        char number[32], expected[32];
        const char *end;
        snprintf(number, sizeof number, "1.2345678e%d", power);
        snprintf(expected, sizeof expected, "1.23457e+%d", power);
        assert_brief(rheo__text_to_double(number, &end), 6, false, expected);
        snprintf(expected, sizeof expected, "-1.2e+%d", power);
        assert_brief(-rheo__text_to_double(number, &end), 2, true, expected);
    }
    for (int power = 6; power <= 290; power++) {
        char number[32], expected[32];
        const char *end;
        snprintf(number, sizeof number, "1.2345678e-%d", power);
        snprintf(expected, sizeof expected, "1.235e-%02d", power);
        assert_brief(rheo__text_to_double(number, &end), 4, false, expected);
    }
    assert_brief(DBL_MAX, 1, false, "1.7976931348623157e+308");
}

/* A number is 24600000 nowhere and 1.75e+03 nowhere: the exponent begins at a million for any number of digits. */
static void brief_numbers_have_an_exponent_from_a_million_on(void **state)
{
    (void)state;
    assert_brief(1750, 3, false, "1750");
    assert_brief(118234, 3, false, "118000");
    assert_brief(999499, 3, false, "999000");
    assert_brief(999500, 3, false, "1e+06");
    assert_brief(-24612345, 3, false, "-2.46e+07");
    assert_brief(160000000000, 2, true, "1.6e+11");
    assert_brief(1234567, 3, false, "1.23e+06");
    assert_brief(999999.6, 6, false, "1e+06");
    assert_brief(1234567, 7, false, "1234567"); /* nothing is rounded */
    assert_brief(0.0001, 3, false, "0.0001");
    assert_brief(0.0000671, 2, false, "6.7e-05");
    char text[32], other[32];
    assert_string_equal(rheo_number_brief(24612345, 3, text), "2.46e+07");
    rheo__text_two(24612345, 24612399, text, other);
    assert_string_equal(text, "2.46123e+07");
    assert_string_equal(other, "2.46124e+07");
}

static void a_number_has_at_most_63_characters(void **state)
{
    (void)state;
    char text[128];
    const char *end;
    for (size_t length = 1; length < sizeof text; length++) {
        memset(text, '0', length);
        text[length - 1] = '7';
        text[length] = 0;
        const bool fits = length <= 63;
        assert_true(rheo_text_number(text, &end) == (fits ? 7 : 0));
        assert_ptr_equal(end, fits ? text + length : text);
    }
}

static void ceil_is_right_at_any_size(void **state)
{
    (void)state;
    assert_true(rheo__ceil(0) == 0 && rheo__ceil(0.25) == 1 && rheo__ceil(7) == 7 && rheo__ceil(7.5) == 8);
    assert_true(rheo__ceil(0x1p51 + 0.5) == 0x1p51 + 1);
    for (double x = 0x1p53; x < DBL_MAX; x *= 2)
        assert_true(rheo__ceil(x) == x);
    assert_true(rheo__ceil(INFINITY) == INFINITY && isnan(rheo__ceil(NAN)));
}

static void only_printable_text_is_printable(void **state)
{
    (void)state;
    static const struct {
        const char *text, *printable;
    } cases[] = {
        {"", ""},
        {"K\xc3\xb6ln \xe2\x9c\x93 \xf0\x9f\x98\x80", NULL},
        {"\xc2\xa0\xdf\xbf\xe0\xa0\x80\xed\x9f\xbf\xee\x80\x80\xf0\x90\x80\x80\xf4\x8f\xbf\xbf", NULL}, /* borders */
        {"\x1b[2J", "?[2J"},
        {"a\nb\tc\rd\x7f", "a b c?d?"},
        {"\xc2\x80\xc2\x9f\xc2\xa0", "????\xc2\xa0"},
        {"\xff\xc3", "??"},
        {"\xc0\xaf\xed\xa0\x80\xe0\x80\x80\xf4\x90\x80\x80\xf5", "?????????????"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[64];
        snprintf(text, sizeof text, "%s", cases[i].text);
        const char *expected = cases[i].printable ? cases[i].printable : cases[i].text;
        assert_int_equal(rheo__text_is_printable(text, ""), strcmp(text, expected) == 0);
        rheo__text_make_printable(text);
        assert_string_equal(text, expected);
    }
    assert_true(rheo__text_is_printable("a\n\tb", "\n\t") && !rheo__text_is_printable("a\n\tb", "\n"));
}

static void errors_are_one_printable_line(void **state)
{
    (void)state;
    rheo_world_def def = rheo_default_world_def();
    rheo_error why;
    assert_int_equal(rheo_world_def_set(&def, "st\x1b[2J\nep", "1", &why), RHEO_ERROR_ARGUMENT);
    assert_non_null(strstr(why.message, "st?[2J ep"));
}

static void texts_have_a_point_in_every_locale(void **state)
{
    (void)state;
    if (!setlocale(LC_ALL, "de_DE.UTF-8"))
        skip();
    char text[64], comma[8];
    snprintf(comma, sizeof comma, "%.1f", 0.5);
    assert_string_equal(comma, "0,5");
    assert_int_equal(rheo__text_print(text, sizeof text, "%g of %d, %s", 0.25, 3, "1,5"), 14);
    assert_string_equal(text, "0.25 of 3, 1,5");
    assert_brief(0.0125, 2, true, "0.012");
    rheo_error why;
    assert_int_equal(rheo__fail(&why, RHEO_ERROR_ARGUMENT, "%.3g", 1.5), RHEO_ERROR_ARGUMENT);
    assert_string_equal(why.message, "1.5");
    snprintf(comma, sizeof comma, "%.1f", 0.5); /* the locale is as it was */
    assert_string_equal(comma, "0,5");
    setlocale(LC_ALL, "C");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brief_numbers_have_few_digits_at_any_size),
        cmocka_unit_test(brief_numbers_have_an_exponent_from_a_million_on),
        cmocka_unit_test(a_number_has_at_most_63_characters),
        cmocka_unit_test(ceil_is_right_at_any_size),
        cmocka_unit_test(only_printable_text_is_printable),
        cmocka_unit_test(texts_have_a_point_in_every_locale),
        cmocka_unit_test(errors_are_one_printable_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
