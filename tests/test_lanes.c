/*
 * The operations on lanes against what their comments say, for each SIMD variant that this machine can run: also where a
 * number is NaN, infinite, -0 or denormal. Built once for each variant.
 */
#include "support.h"

#include <math.h>

#include "core/scans.h"
#include "space/row_blocks.h"

#define NAME_(variant) #variant
#define NAME(variant) NAME_(variant)

static const rheo_real VALUES[] = {
    0,       -0.0,     1,        -1,        0.5, -3,  RHEO__R(0x1p-140), -RHEO__R(0x1p-140),
    0x1p127, -0x1p127, INFINITY, -INFINITY, NAN, -NAN};
enum { SKIPPED = 77 }; /* to meson */
enum { COUNT = sizeof VALUES / sizeof *VALUES };

static bool can_run(void)
{
    const char *name;
    for (uint32_t i = 0; (name = rheo_simd_available(i)); i++)
        if (strcmp(name, NAME(RHEO__SIMD_VARIANT)) == 0)
            return true;
    return false;
}

/* The same bits, or both NaN where `computed`: the bits of a NaN that was computed are not specified. */
static void assert_lanes(rheo__lanes lanes, const rheo_real *expected, bool computed, const char *what)
{
    for (int lane = 0; lane < RHEO__LANES; lane++) {
        const rheo_real value = RHEO__LANE(lanes, lane);
        const bool both_nan = computed && value != value && expected[lane] != expected[lane];
        if (!both_nan && memcmp(&value, &expected[lane], sizeof value) != 0)
            fail_msg("%s, lane %d of %d: %g, expected %g", what, lane, RHEO__LANES, (double)value,
                     (double)expected[lane]);
    }
}

/* Computes what is expected of each lane from its numbers A and B. */
#define EACH_LANE(expression)                        \
    for (int lane = 0; lane < RHEO__LANES; lane++) { \
        const rheo_real A = as[lane], B = bs[lane];  \
        (void)A, (void)B;                            \
        expected[lane] = (expression);               \
    }

/* All pairs of values meet in each lane. */
static void selections_treat_special_values_as_documented(void **state)
{
    (void)state;
    for (int first = 0; first < COUNT * COUNT; first++) {
        rheo_real as[RHEO__LANES], bs[RHEO__LANES], fives[RHEO__LANES], expected[RHEO__LANES];
        for (int lane = 0; lane < RHEO__LANES; lane++) {
            const int pair = (first + lane) % (COUNT * COUNT);
            as[lane] = VALUES[pair / COUNT];
            bs[lane] = VALUES[pair % COUNT];
            fives[lane] = 5;
        }
        const rheo__lanes a = rheo__lanes_at(as, 0), b = rheo__lanes_at(bs, 0), five = rheo__lanes_all(5),
                          nan = rheo__lanes_all(NAN), seven = rheo__lanes_all(7);
        EACH_LANE(A > B ? A : B)
        assert_lanes(rheo__lanes_max(a, b), expected, false, "max");
        EACH_LANE(A < B ? A : B)
        assert_lanes(rheo__lanes_min(a, b), expected, false, "min");
        EACH_LANE(A < B ? 5 : 7)
        assert_lanes(rheo__lanes_if_less(a, b, five, seven), expected, false, "if_less");
        EACH_LANE(A < B ? 5 : RHEO__R(NAN))
        assert_lanes(rheo__lanes_if_less(a, b, five, nan), expected, false, "if_less with NaN");
        EACH_LANE(A < B ? 5 : 0)
        assert_lanes(rheo__lanes_keep_less(a, b, five), expected, false, "keep_less");
        EACH_LANE(A < B ? 12 : 7)
        assert_lanes(rheo__lanes_add_if_less(a, b, seven, five), expected, false, "add_if_less");
        const rheo__mask counts = rheo__lanes_count_if_less(a, b, rheo__mask_filled(five < seven) * -3);
        for (int lane = 0; lane < RHEO__LANES; lane++)
            assert_true(RHEO__LANE(counts, lane) == (as[lane] < bs[lane] ? 4 : 3));
        EACH_LANE(A < B ? 7 : 5)
        assert_lanes(rheo__lanes_max_if_less(a, b, five, seven), expected, false, "max_if_less");
        assert_lanes(rheo__lanes_max_if_less(a, b, five, nan), fives, false, "max_if_less of NaN");
        EACH_LANE(rheo__sqrt(A))
        assert_lanes(rheo__lanes_sqrt(a), expected, true, "sqrt");
        bool any = false;
        EACH_LANE((any |= A < B, A))
        assert_true(rheo__lanes_any(a < b) == any);
    }
}

/* A mask with a single lane is not missed, whichever lane it is. */
static void any_sees_each_lane(void **state)
{
    (void)state;
    const rheo__lanes zero = rheo__lanes_all(0);
    assert_false(rheo__lanes_any(zero < zero));
    for (int lane = 0; lane < RHEO__LANES; lane++) {
        rheo__lanes one = zero;
        RHEO__LANE(one, lane) = 1;
        assert_true(rheo__lanes_any(zero < one));
    }
}

/* Points are loaded from where they are, and each value goes to its lane. */
static void points_go_to_their_lanes(void **state)
{
    (void)state;
    enum { POINTS = 64 };
    static rheo__wide_point wide[POINTS];
    static rheo__point point[POINTS], copy[POINTS];
    for (uint32_t i = 0; i < POINTS; i++) {
        const rheo_real n = (rheo_real)(8 * i);
        wide[i] = (rheo__wide_point){{n, n + 1, n + 2, n + 3}, {n + 4, n + 5, n + 6, n + 7}};
        point[i] = wide[i].at;
    }
    uint32_t at[RHEO__LANES], index[RHEO__LANES];
    rheo_real expected[8][RHEO__LANES];
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
        index[lane] = (17 * lane + 5) % POINTS;
        at[lane] = RHEO__POINT_VALUES * index[lane];
        for (uint32_t k = 0; k < 8; k++)
            expected[k][lane] = (rheo_real)(8 * index[lane] + k);
    }
    const rheo__wide_lanes w = rheo__lanes_load_wide_at(wide, at);
    const rheo__lanes loaded[] = {w.at.x, w.at.y, w.at.z, w.w, w.more.x, w.more.y, w.more.z, w.more_w};
    for (int k = 0; k < 8; k++)
        assert_lanes(loaded[k], expected[k], false, "wide points");
    const rheo__wide_lanes own = rheo__lanes_load_wide_row(wide + 3),
                           less = rheo__lanes_minus_wide_at(&own, wide, at);
    for (int lane = 0; lane < RHEO__LANES; lane++) {
        const rheo__wide_point *i = &wide[3 + lane], *j = &wide[index[lane]];
        assert_true(RHEO__LANE(less.at.x, lane) == i->at.x - j->at.x &&
                    RHEO__LANE(less.at.z, lane) == i->at.z - j->at.z);
        assert_true(RHEO__LANE(less.more.y, lane) == i->more.y - j->more.y && RHEO__LANE(less.w, lane) == j->at.w);
        assert_true(RHEO__LANE(less.more_w, lane) == j->more.w);
    }
    rheo__lanes last;
    const rheo__lanes3 narrow = rheo__lanes_load_narrow_at(wide, at),
                       by_number = rheo__lanes_load_w(point, index, &last), by_value = rheo__lanes_load_at(point, at);
    const rheo__lanes others[] = {narrow.x,    narrow.y,   narrow.z,   by_number.x, by_number.y,
                                  by_number.z, by_value.x, by_value.y, by_value.z};
    for (int k = 0; k < 9; k++)
        assert_lanes(others[k], expected[k % 3], false, "points");
    assert_lanes(last, expected[3], false, "w");
    for (uint32_t first = 0; first + RHEO__LANES <= POINTS; first += RHEO__LANES) {
        const rheo__lanes3 row = rheo__lanes_load_row(point + first),
                           of_wide = rheo__lanes_load_wide_row(wide + first).more;
        for (uint32_t lane = 0; lane < RHEO__LANES; lane++) {
            assert_true(RHEO__LANE(row.y, lane) == point[first + lane].y);
            assert_true(RHEO__LANE(of_wide.z, lane) == wide[first + lane].more.z);
        }
        rheo__lanes_store_row(copy + first, row);
    }
    for (uint32_t i = 0; i < POINTS; i++)
        assert_true(copy[i].x == point[i].x && copy[i].y == point[i].y && copy[i].z == point[i].z && copy[i].w == 0);
}

/* A single NaN or infinity is found wherever it is, and large finite numbers are none. */
static void scans_find_what_is_anywhere(void **state)
{
    (void)state;
    enum { MOST = 70 };
    for (size_t count = 0; count < MOST; count++) {
        rheo_real values[3 * MOST] = {0};
        for (size_t i = 0; i < 3 * count; i++)
            values[i] = i % 2 ? RHEO__R(0x1p127) : -RHEO__R(0x1p-140);
        assert_false(RHEO__VARIANT(any_not_finite)(values, 3 * count));
        for (size_t i = 0; i < 3 * count; i++) {
            const rheo_real bad[] = {NAN, INFINITY, -INFINITY}, before = values[i];
            values[i] = bad[i % 3];
            assert_true(RHEO__VARIANT(any_not_finite)(values, 3 * count));
            values[i] = before;
        }
        for (size_t i = 0; i < 3 * count; i++)
            values[i] = (rheo_real)(i % 3);
        assert_true(RHEO__VARIANT(largest_length2)(values, count) == (count ? 5 : 0));
        for (size_t i = 0; i < count; i++) {
            values[3 * i] = -4;
            assert_true(RHEO__VARIANT(largest_length2)(values, count) == 21);
            values[3 * i] = NAN; /* does not count */
            assert_true(RHEO__VARIANT(largest_length2)(values, count) == (count > 1 ? 5 : 0));
            values[3 * i] = 0;
        }
    }
}

int main(void)
{
    /* Not in the tests: all their code may use the instructions of the variant. */
    if (!can_run())
        return SKIPPED;
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(selections_treat_special_values_as_documented),
        cmocka_unit_test(any_sees_each_lane),
        cmocka_unit_test(points_go_to_their_lanes),
        cmocka_unit_test(scans_find_what_is_anywhere),
    };
    return cmocka_run_group_tests_name("lanes of " NAME(RHEO__SIMD_VARIANT), tests, NULL, NULL);
}
