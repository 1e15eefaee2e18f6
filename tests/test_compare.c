/* Two sets of values: how many items differ, which is the first, how large the difference is, and what messages say. */
#include <math.h>

#include "record/recording.h"
#include "support.h"

/* Values of one field from an array that is longer than the field: what is behind it does not count. */
static rheo__values values_of(rheo__field_id field, void *data, size_t items)
{
    rheo__values v = {.present = UINT32_C(1) << field};
    v.data[field] = data;
    v.items[field] = items;
    return v;
}

static rheo__sizes sizes;
static rheo_difference first;

static uint64_t compare(rheo__field_id field, void *a, size_t a_items, void *b, size_t b_items)
{
    const rheo__values x = values_of(field, a, a_items), y = values_of(field, b, b_items);
    memset(&first, 0x55, sizeof first); /* every member must be set */
    memset(&sizes, 0x55, sizeof sizes);
    const uint64_t count = rheo__compare_field(field, &x, &y, RHEO_VALUES_SIMULATED, NULL, &sizes);
    assert_int_equal(rheo__compare_field(field, &x, &y, RHEO_VALUES_SIMULATED, &first, NULL), count);
    return count;
}

/* The values 1, 2, ..., -9 of three particles, and a fourth behind them; each single value may differ. */
static void each_value_that_differs_is_found(void **unused)
{
    (void)unused;
    for (uint32_t changed = 0; changed < 9; changed++)
        for (int sign = -1; sign <= 1; sign += 2) {
            rheo_real a[12] = {1, 2, 3, 4, 5, 6, 7, 8, -9, 1e9, 0, 0}, b[12];
            memcpy(b, a, sizeof a);
            b[changed] += (rheo_real)(sign * 0.25);
            b[9] = -1e9;
            assert_int_equal(compare(RHEO__FIELD_position, a, 3, b, 3), 1);
            assert_true(first.id == changed / 3 && first.component == changed % 3 && first.other_id == 0);
            assert_true(first.expected == (double)a[changed] && first.actual == (double)b[changed]);
            assert_true(!first.only_expected && !first.only_actual && first.count == 1);
            assert_true(first.origin == RHEO_VALUES_SIMULATED && first.largest == 0.25 && sizes.largest == 0.25);
            const double scale = changed == 8 && sign < 0 ? 9.25 : 9; /* of either side */
            assert_true(sizes.scale == scale && first.scale == scale);
            assert_true(sizes.ulps == first.ulps && first.ulps > 0);
            assert_string_equal(first.value_field, "position");
            /* The other way round. */
            assert_int_equal(compare(RHEO__FIELD_position, b, 3, a, 3), 1);
            assert_true(first.expected == (double)b[changed] && first.actual == (double)a[changed]);
            assert_true(sizes.largest == 0.25 && sizes.scale == scale);
        }
}

/* Of several differences the first item is named, by what differs most in it, and the largest difference is given. */
static void the_largest_difference_may_be_any(void **unused)
{
    (void)unused;
    rheo_real a[6] = {-8, 1, 1, 1, 1, 1}, b[6];
    memcpy(b, a, sizeof a);
    assert_int_equal(compare(RHEO__FIELD_velocity, a, 2, b, 2), 0);
    assert_true(sizes.ulps == 0 && sizes.largest == 0 && sizes.scale == 0);
    b[1] = 1.5;
    b[2] = -1;
    b[4] = nextafterf(1, 2);
    assert_int_equal(compare(RHEO__FIELD_velocity, a, 2, b, 2), 2);
    assert_true(first.id == 0 && first.component == 2 && first.count == 2 && first.largest == 2 && first.scale == 8);
    assert_true(first.expected == 1 && first.actual == -1 && first.location == RHEO_LOCATION_PARTICLE);
    b[0] = b[1] = NAN; /* differs more than any number */
    assert_int_equal(compare(RHEO__FIELD_velocity, a, 2, b, 2), 2);
    assert_true(first.id == 0 && first.component == 0 && first.largest == 2);
    rheo_real c[6] = {0, 0, 0, 0, 0, 0}, d[6] = {0, 0, 0, 0, 1, 0};
    assert_int_equal(compare(RHEO__FIELD_velocity, c, 2, d, 2), 1);
    assert_true(first.scale == 1 && first.largest == 1 && first.id == 1 && first.component == 1);
    assert_int_equal(compare(RHEO__FIELD_velocity, d, 2, c, 2), 1);
    assert_true(first.scale == 1 && first.largest == 1);
    uint64_t m = 7, n = 4;
    assert_int_equal(compare(RHEO__FIELD_history_rows, &m, 1, &n, 1), 1);
    assert_true(first.expected == 7 && first.actual == 4 && first.largest == 3 && first.scale == 7 &&
                first.ulps == 3);
    assert_true(first.expected_bits == 7 && first.actual_bits == 4);
}

static void an_item_more_is_a_difference(void **unused)
{
    (void)unused;
    rheo_real a[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    assert_int_equal(compare(RHEO__FIELD_position, a, 3, a, 1), 2);
    assert_true(first.id == 1 && first.other_id == 0 && first.component == 0 && first.count == 2);
    assert_true(first.only_expected && !first.only_actual && first.ulps == UINT64_MAX);
    assert_true(first.expected == 4 && first.actual == 0 && first.actual_bits == 0);
    assert_int_equal(compare(RHEO__FIELD_position, a, 2, a, 3), 1);
    assert_true(first.id == 2 && !first.only_expected && first.only_actual && first.ulps == UINT64_MAX);
    assert_true(first.expected == 0 && first.expected_bits == 0 && first.actual == 7);
    /* A value of both is named before an item of one. */
    rheo_real b[9] = {1, 2, 3, 4, 5, 0, 7, 8, 9};
    assert_int_equal(compare(RHEO__FIELD_position, a, 2, b, 3), 2);
    assert_true(first.id == 1 && first.component == 2 && !first.only_actual && first.expected == 6);
    assert_int_equal(compare(RHEO__FIELD_position, a, 0, b, 0), 0);
}

/* ---- Springs ---- */

static uint64_t compare_springs(rheo__field_id field, size_t a, uint32_t *a_ends, rheo_real *a_rest, size_t b,
                                uint32_t *b_ends, rheo_real *b_rest)
{
    rheo__values x = values_of(field, NULL, 0), y = values_of(field, NULL, 0);
    x.data[RHEO__FIELD_spring_ends] = a_ends;
    y.data[RHEO__FIELD_spring_ends] = b_ends;
    x.data[RHEO__FIELD_spring_rest_length] = a_rest;
    y.data[RHEO__FIELD_spring_rest_length] = b_rest;
    x.items[RHEO__FIELD_spring_ends] = x.items[RHEO__FIELD_spring_rest_length] = a;
    y.items[RHEO__FIELD_spring_ends] = y.items[RHEO__FIELD_spring_rest_length] = b;
    memset(&first, 0x55, sizeof first);
    memset(&sizes, 0x55, sizeof sizes);
    const uint64_t count = rheo__compare_field(field, &x, &y, RHEO_VALUES_STORED, NULL, &sizes);
    assert_int_equal(rheo__compare_field(field, &x, &y, RHEO_VALUES_STORED, &first, NULL), count);
    return count;
}

static void springs_are_matched_by_their_ends(void **unused)
{
    (void)unused;
    const rheo__field_id ENDS = RHEO__FIELD_spring_ends, REST = RHEO__FIELD_spring_rest_length;
    uint32_t a[] = {0, 1, 0, 3, 2, 3}, b[] = {0, 1, 1, 2, 2, 3, 4, 5};
    rheo_real a_rest[] = {1, 2, 3}, b_rest[] = {1, 8, 3.5, 0.5};
    assert_int_equal(compare_springs(ENDS, 3, a, a_rest, 3, a, b_rest), 0);
    assert_int_equal(compare_springs(ENDS, 3, a, a_rest, 4, b, b_rest), 3);
    assert_true(first.id == 0 && first.other_id == 3 && first.only_expected && !first.only_actual);
    assert_true(first.expected == 1 && first.actual == 0 && first.ulps == UINT64_MAX && first.count == 3);
    assert_int_equal(compare_springs(ENDS, 4, b, b_rest, 3, a, a_rest), 3);
    assert_true(first.id == 0 && first.other_id == 3 && !first.only_expected && first.only_actual);
    assert_int_equal(compare_springs(ENDS, 3, b, b_rest, 4, b, b_rest), 1);
    assert_true(first.id == 4 && first.other_id == 5 && first.only_actual && first.component == 0);
    /* Rest lengths: those of 0:3, 1:2, 4:5 are on one side only, that of 2:3 differs. */
    assert_int_equal(compare_springs(REST, 3, a, a_rest, 4, b, b_rest), 4);
    assert_true(first.id == 0 && first.other_id == 3 && first.only_expected && first.expected == 2);
    assert_true(first.actual == 0 && first.actual_bits == 0 && first.ulps == UINT64_MAX);
    assert_true(sizes.largest == 0.5 && sizes.ulps > 0 && sizes.ulps < UINT64_MAX && sizes.scale == 8);
    assert_int_equal(compare_springs(REST, 1, a + 4, a_rest + 2, 1, b + 4, b_rest + 2), 1);
    assert_true(first.id == 2 && first.other_id == 3 && !first.only_expected && !first.only_actual);
    assert_true(first.expected == 3 && first.actual == 3.5 && first.ulps == sizes.ulps && first.scale == 3.5);
}

static void a_field_of_one_side_is_not_compared(void **unused)
{
    (void)unused;
    rheo_real a[3] = {1, 2, 3}, b[3] = {1, 2, 4};
    rheo__values x = values_of(RHEO__FIELD_position, a, 1), y = values_of(RHEO__FIELD_position, b, 1);
    assert_true(rheo__compare_values(RHEO__FIELD_COUNT, &x, &y, RHEO_VALUES_STORED, &first));
    assert_true(rheo__compare_values(RHEO__FIELD_velocity, &x, &y, RHEO_VALUES_STORED, &first));
    assert_string_equal(first.value_field, "position");
    y.present = 0;
    assert_false(rheo__compare_values(RHEO__FIELD_COUNT, &x, &y, RHEO_VALUES_STORED, &first));
    assert_false(rheo__compare_values(RHEO__FIELD_position, &x, &y, RHEO_VALUES_STORED, &first));
}

/* Only the fields that differ grow, in their order, and no more than there is room for. */
static void growth_has_the_fields_that_differ(void **unused)
{
    (void)unused;
    rheo_real a[3] = {1, 2, 3}, b[3] = {1, 2, 4}, c[3] = {5, 6, 7}, d[3] = {5.5, 6, 8};
    rheo__values x = values_of(RHEO__FIELD_velocity, c, 1), y = values_of(RHEO__FIELD_velocity, d, 1);
    x.present = y.present |= UINT32_C(1) << RHEO__FIELD_position | UINT32_C(1) << RHEO__FIELD_density;
    x.data[RHEO__FIELD_position] = a;
    y.data[RHEO__FIELD_position] = b;
    x.items[RHEO__FIELD_position] = y.items[RHEO__FIELD_position] = 1;
    rheo_verification v = {0};
    for (uint64_t step = 1; step <= RHEO_MAX_GROWTH; step++)
        rheo__compare_growth(&v, step, &x, &y);
    assert_int_equal(v.growth_count, RHEO_MAX_GROWTH);
    for (uint32_t i = 0; i < RHEO_MAX_GROWTH; i++) {
        const rheo_growth *g = &v.growth[i];
        assert_int_equal(g->step, 1 + i / 2);
        assert_string_equal(g->field, i % 2 ? "velocity" : "position");
        assert_true(g->count == 1 && g->largest == 1 && g->scale == (i % 2 ? 8 : 4) && g->ulps > 0);
    }
}

/* ---- Words ---- */

static void says_exactly(const rheo_difference *d, uint64_t agreed, bool full, const char *text)
{
    static const char *const names[2] = {"the first", "the second"};
    static rheo_verification v;
    v = (rheo_verification){.first = *d};
    rheo__difference_describe(&v, names, agreed, full);
    if (strcmp(v.message, text) != 0)
        fail_msg("\"%s\" is not \"%s\"", v.message, text);
}

static void every_kind_of_difference_has_its_words(void **unused)
{
    (void)unused;
    rheo_difference d = {.step = 3, .stage = "forces@2", .field = "velocity", .value_step = 3};
#define AHEAD "differs at step 3: velocity after stage forces@2"
    says_exactly(&d, 0, true,
                 AHEAD "; more than one value, and the step does not reach its end, where they are stored");
    says_exactly(&d, 0, false, AHEAD "; more than one value, and only full recordings (--full) would have them");
    says_exactly(&d, 3, true, AHEAD "; all values agree again at the end of the step");
    says_exactly(&d, 4, false, AHEAD "; all values agree again at the end of the step, and up to step 4");
    d.origin = RHEO_VALUES_SOLVED;
    strcpy(d.value_field, "velocity");
    d.id = 17;
    d.component = 1;
    d.count = 1;
    d.expected = 1;
    d.actual = 1.5;
    d.expected_bits = 0x3f800000;
    d.actual_bits = 0x3fc00000;
    d.ulps = 1;
    d.largest = 0.5;
    d.scale = 2;
#define VALUES "velocity of particle 17, component 1 is 1 (0x3f800000) in the first, 1.5 (0x3fc00000) in the second"
#define SIZE " by 0.5, 0.25 of the field's largest value"
    says_exactly(&d, 0, true, AHEAD "; " VALUES ", 1 ulp apart; 1 item differs" SIZE " (solved from the hash)");
    d.ulps = 2;
    d.origin = RHEO_VALUES_SIMULATED;
    says_exactly(&d, 0, true, AHEAD "; " VALUES ", 2 ulps apart; 1 item differs" SIZE " (simulated with this build)");
    d.origin = RHEO_VALUES_STORED;
    d.count = 2;
    d.scale = 0;
    says_exactly(&d, 0, true,
                 AHEAD "; at the end of the step " VALUES
                       ", 2 ulps apart; 2 items differ by at most 0.5 (from stored states)");
    d.value_step = 5;
    d.largest = 0;
    says_exactly(&d, 0, true,
                 AHEAD "; its values are not stored; at the end of step 5 " VALUES
                       ", 2 ulps apart; 2 items differ (from stored states)");
    says_exactly(&d, 4, true,
                 AHEAD "; the values agree again at its end; at the end of step 5 " VALUES
                       ", 2 ulps apart; 2 items differ (from stored states)");
    d.value_step = 3;
    *d.stage = 0;
    d.only_actual = true;
    says_exactly(&d, 0, true,
                 "differs at step 3: velocity of the state at the start; velocity of particle 17, component 1 is 1.5 "
                 "(0x3fc00000) in the second, which alone has this item; 2 items differ (from stored states)");
    d.only_actual = false;
    d.only_expected = true;
    strcpy(d.value_field, "density"); /* of one component */
    says_exactly(&d, 0, true,
                 "differs at step 3: velocity of the state at the start; density of particle 17 is 1 (0x3f800000) in "
                 "the first, which alone has this item; 2 items differ (from stored states)");
    strcpy(d.value_field, "spring_rest_length");
    d.other_id = 20;
    says_exactly(&d, 0, true,
                 "differs at step 3: velocity of the state at the start; spring_rest_length of spring 17:20 is 1 "
                 "(0x3f800000) in the first, which alone has this item; 2 springs differ (from stored states)");
    strcpy(d.value_field, "spring_ends");
    d.actual_bits = d.count = 1;
    d.expected_bits = 0;
    says_exactly(
        &d, 0, true,
        "differs at step 3: velocity of the state at the start; spring 17:20 is only in the second; 1 spring "
        "differs (from stored states)");
    d.expected_bits = 1;
    d.actual_bits = 0;
    d.only_expected = false;
    says_exactly(&d, 0, true,
                 "differs at step 3: velocity of the state at the start; spring 17:20 is only in the first; 1 spring "
                 "differs (from stored states)");
    strcpy(d.value_field, "history_rows");
    d.expected_bits = 7;
    d.actual_bits = 4;
    d.expected = 7;
    d.actual = 4;
    d.ulps = 3;
    says_exactly(
        &d, 0, true,
        "differs at step 3: velocity of the state at the start; history_rows is 7 (0x00000007) in the first, 4 "
        "(0x00000004) in the second, 3 ulps apart; 1 item differs (from stored states)");
#undef AHEAD
#undef VALUES
#undef SIZE
}

/* Distances in ulps are left out across 0, at 0, below a millionth of the scale, and where there is none. */
static void ulps_are_given_only_where_they_say_something(void **unused)
{
    (void)unused;
    static const struct {
        double a, b, scale;
        bool given;
    } CASES[] = {{1, 2, 1, true},         {-1, -2, 1, true},         {1, -2, 1, false}, {-1, 2, 1, false},
                 {0, 1, 1, false},        {1, 0, 1, false},          {1, 2, 1e6, true}, {1, 2, 1.0001e6, false},
                 {2, 1, 1.0001e6, false}, {-1, -2, 1.0001e6, false}, {1, 2, 0, true},   {0, -1, 1, false}};
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++)
        for (int has = 0; has < 2; has++) {
            static const char *const names[2] = {"a", "b"};
            rheo_verification v = {.first = {.origin = RHEO_VALUES_STORED,
                                             .value_field = "density",
                                             .count = 1,
                                             .expected = CASES[i].a,
                                             .actual = CASES[i].b,
                                             .scale = CASES[i].scale,
                                             .ulps = has ? 9 : UINT64_MAX}};
            rheo__difference_describe(&v, names, 0, true);
            if ((strstr(v.message, "9 ulps apart") != NULL) != (has && CASES[i].given))
                fail_msg("case %zu: %s", i, v.message);
        }
}

static void an_unreadable_file_says_how_many_steps_hold(void **unused)
{
    (void)unused;
    static const struct {
        uint64_t steps;
        rheo_verdict verdict;
        bool lengths_differ;
        rheo_result result;
        const char *says;
    } CASES[] = {
        {0, RHEO_SAME, false, RHEO_ERROR_FORMAT,
         "unreadable: bad; restore it from version control, or record it again"},
        {1, RHEO_SAME, false, RHEO_ERROR_UNSUPPORTED, "unreadable: bad; 1 step before it holds"},
        {2, RHEO_SAME, false, RHEO_ERROR_ARGUMENT, "unreadable: bad; 2 steps before it hold"},
        {2, RHEO_DIFFERS, false, RHEO_ERROR_ARGUMENT,
         "unreadable: bad; 2 steps before it hold, the next one differs"},
        {2, RHEO_DIFFERS, true, RHEO_ERROR_ARGUMENT, "unreadable: bad; 2 steps before it hold"},
    };
    const rheo_error why_bad = {"bad"};
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        rheo_verification v = {.verdict = CASES[i].verdict,
                               .steps = CASES[i].steps,
                               .lengths_differ = CASES[i].lengths_differ,
                               .growth_count = 3,
                               .first = {.step = 4}};
        OK(rheo__unreadable(&v, CASES[i].result, &why_bad, &error));
        assert_string_equal(v.message, CASES[i].says);
        assert_true(v.verdict == RHEO_UNREADABLE && v.growth_count == 0 && v.first.step == 0);
    }
    for (int i = 0; i < 2; i++) {
        rheo_verification v = {.verdict = RHEO_SAME, .steps = 5};
        const rheo_result result = i ? RHEO_ERROR_MEMORY : RHEO_ERROR_FILE;
        REFUSED(result, "bad", rheo__unreadable(&v, result, &why_bad, &error));
        assert_int_equal(v.verdict, RHEO_SAME);
    }
}

static void what_is_not_compared_keeps_the_steps_before_a_stop(void **unused)
{
    (void)unused;
    const rheo_error reason = {"bad"};
    for (int stopped = 0; stopped < 2; stopped++) {
        const rheo_result result = stopped ? RHEO_ERROR_STOPPED : RHEO_ERROR_FILE;
        rheo_verification v = {.verdict = RHEO_SAME, .steps = 5, .has_hash = true, .hash = 9};
        REFUSED(result, "bad", rheo__not_compared(&v, result, &reason, &error));
        assert_true(v.verdict == RHEO_NOT_COMPARED && v.steps == (stopped ? 5 : 0) && !v.has_hash && v.hash == 0);
        assert_string_equal(v.message, "not compared: bad");
    }
    rheo_verification v = {.verdict = RHEO_SAME, .steps = 1};
    OK(rheo__not_compared(&v, RHEO_OK, &reason, &error));
    assert_true(v.verdict == RHEO_SAME && v.steps == 1);
    OK(rheo_verification_check(&v, 1, &error));
    REFUSED(RHEO_ERROR_DIFFERS, "1 step is the same, but at least 2 must be compared",
            rheo_verification_check(&v, 2, &error));
    v.steps = 2;
    REFUSED(RHEO_ERROR_DIFFERS, "2 steps are the same, but at least 3 must be compared",
            rheo_verification_check(&v, 3, &error));
}

/* ---- Hashes ---- */

static void check_solution(const rheo_world *world, rheo__field_id f, uint64_t hash, rheo__real_bits was,
                           rheo__real_bits is, double scale)
{
    for (int expected = 0; expected < 2; expected++) {
        rheo_difference d;
        memset(&d, 0x55, sizeof d);
        assert_true(rheo__difference_solve(&d, &world->state, f, hash, expected));
        rheo_real x, y;
        memcpy(&x, expected ? &was : &is, sizeof x);
        memcpy(&y, expected ? &is : &was, sizeof y);
        assert_true(d.origin == RHEO_VALUES_SOLVED && d.count == 1 && !d.only_expected && !d.only_actual);
        assert_true(d.expected == (double)x && d.actual == (double)y);
        assert_true(d.largest == fabs((double)x - (double)y) && d.scale == scale && d.ulps == 1);
        assert_true(d.expected_bits == (expected ? was : is) && d.actual_bits == (expected ? is : was));
        assert_string_equal(d.value_field, rheo__field_table[f].name);
    }
}

/* The lowest bit of a value is solved from the hash. Of a flat array the largest value is told as the scale, of others none. */
static void a_changed_bit_is_solved_with_its_size(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    step(world, 2);
    size_t solved = 0;
    rheo__real_bits was, is;
    for (rheo__field_id f = 1; f < RHEO__FIELD_COUNT; f++) {
        if (!rheo__state_has(&world->state, f) || rheo__field_table[f].element != RHEO__ELEMENT_REAL ||
            rheo__field_table[f].storage != RHEO__FLAT)
            continue;
        rheo_real *value;
        memcpy(&value, (const char *)&world->state + rheo__field_table[f].offset, sizeof value);
        const size_t count = rheo__state_items(&world->state, f) * rheo__field_table[f].components;
        const size_t at = count / 2;
        uint64_t hash;
        rheo__state_hash_newest(&world->state, RHEO__SET_OF(f), &hash);
        memcpy(&was, &value[at], sizeof was);
        is = was ^ 1;
        memcpy(&value[at], &is, sizeof is);
        double scale = 0;
        for (size_t i = 0; i < count; i++)
            scale = fmax(scale, fabs((double)value[i]));
        if (value[at] != 0)
            check_solution(world, f, hash, was, is, scale);
        memcpy(&value[at], &was, sizeof was);
        solved++;
    }
    assert_true(solved > 5);
    rheo__springs *springs = &world->state.springs;
    const rheo__pairs *p = &springs->pairs;
    size_t rests = 0;
    for (uint32_t i = 0; i < p->rows && !rests; i++)
        RHEO__EACH_SPRING(springs, i, k)
        {
            size_t other = rheo__pairs_first(p, rheo__pairs_partner(p, k));
            while (rheo__pairs_partner(p, other) != i)
                other += p->width;
            uint64_t hash;
            rheo__state_hash_newest(&world->state, RHEO__SET_OF(RHEO__FIELD_spring_rest_length), &hash);
            memcpy(&was, &springs->rest_length[k], sizeof was);
            is = was ^ 1;
            memcpy(&springs->rest_length[k], &is, sizeof is);
            springs->rest_length[other] = springs->rest_length[k];
            check_solution(world, RHEO__FIELD_spring_rest_length, hash, was, is, 0);
            rests++;
            break;
        }
    assert_int_equal(rests, 1);
    rheo_world_destroy(world);
}

/* The field that has not the recorded hash is named, whichever it is. */
static void the_field_with_another_hash_is_found(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    rheo_recorder *recorder;
    void *bytes;
    size_t size, named = 0;
    rheo_recording *r;
    OK(rheo_recorder_open_memory(world, NULL, &recorder, &error));
    OK(rheo_recorder_step(recorder, &error));
    OK(rheo_recorder_close_memory(recorder, &bytes, &size, &error));
    OK(rheo_recording_open_memory(bytes, size, &r, &error));
    OK(rheo__recording_read_step(r, 0, &error));
    uint64_t expected;
    assert_int_equal(rheo__recording_wrong_field(r, world, 0, &expected), RHEO__FIELD_COUNT);
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        uint64_t right = 0;
        char name[32];
        rheo__field_id field;
        for (size_t i = 0; i < r->expected_count; i++) {
            rheo__world_trace_entry(world, rheo__world_trace_substeps(world, r->expected_count), i, name, &field);
            if (field == f)
                right = r->expected[i]++; /* only the last one counts */
        }
        if (!right)
            continue;
        named++;
        assert_int_equal(rheo__recording_wrong_field(r, world, 0, &expected), f);
        assert_true(expected == right + 1);
        for (size_t i = 0; i < r->expected_count; i++) {
            rheo__world_trace_entry(world, rheo__world_trace_substeps(world, r->expected_count), i, name, &field);
            r->expected[i] -= field == f;
        }
    }
    assert_true(named > 8);
    rheo_recording_close(r);
    free(bytes);
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_value_that_differs_is_found),
        cmocka_unit_test(the_largest_difference_may_be_any),
        cmocka_unit_test(an_item_more_is_a_difference),
        cmocka_unit_test(springs_are_matched_by_their_ends),
        cmocka_unit_test(a_field_of_one_side_is_not_compared),
        cmocka_unit_test(growth_has_the_fields_that_differ),
        cmocka_unit_test(every_kind_of_difference_has_its_words),
        cmocka_unit_test(ulps_are_given_only_where_they_say_something),
        cmocka_unit_test(an_unreadable_file_says_how_many_steps_hold),
        cmocka_unit_test(what_is_not_compared_keeps_the_steps_before_a_stop),
        cmocka_unit_test(a_changed_bit_is_solved_with_its_size),
        cmocka_unit_test(the_field_with_another_hash_is_found),
    };
    return cmocka_run_group_tests_name("compare", tests, NULL, NULL);
}
