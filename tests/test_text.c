/* Numbers for people. */
#include "support.h"

#include <float.h>
#include <math.h>

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

static void ceil_is_right_at_any_size(void **state)
{
    (void)state;
    assert_true(rheo__ceil(0) == 0 && rheo__ceil(0.25) == 1 && rheo__ceil(7) == 7 && rheo__ceil(7.5) == 8);
    assert_true(rheo__ceil(0x1p51 + 0.5) == 0x1p51 + 1);
    for (double x = 0x1p53; x < DBL_MAX; x *= 2)
        assert_true(rheo__ceil(x) == x);
    assert_true(rheo__ceil(INFINITY) == INFINITY && isnan(rheo__ceil(NAN)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brief_numbers_have_few_digits_at_any_size),
        cmocka_unit_test(ceil_is_right_at_any_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
