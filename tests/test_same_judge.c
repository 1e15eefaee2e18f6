/* Differences in units of a yardstick, of states made by hand: their ratios, and what is judged by them, in closed form. */
#include "support.h"

#include <math.h>

#include "record/same.h"

enum { PARTICLES = 4, VALUES = 3 * PARTICLES };

static const double ULP = RHEO_DOUBLE ? 0x1p-52 : 0x1p-23; /* of 1 */

/* The recorded state, that of this build, and the yardstick: velocities of 1, and three springs. */
typedef struct side {
    rheo_real position[VALUES], velocity[VALUES], rest_length[4];
    uint32_t ends[8];
    uint64_t step, substeps, history_rows;
    rheo__values values;
} side;

typedef struct judged {
    side side[3]; /* recorded, own, other */
    rheo_world world;
    rheo__same_states states;
    rheo_same_steps result;
    rheo__same_judge judge;
} judged;

enum { RECORDED, OWN, OTHER };

static void hold(rheo__values *v, rheo__field_id f, void *data, size_t items)
{
    v->data[f] = data;
    v->items[f] = items;
    v->present |= RHEO__SET_OF(f);
}

static void begin(judged *j, double limit, bool whole)
{
    memset(j, 0, sizeof *j);
    for (int k = 0; k < 3; k++) {
        side *s = &j->side[k];
        for (int i = 0; i < VALUES; i++)
            s->velocity[i] = 1;
        for (uint32_t i = 0; i < 3; i++) {
            s->ends[2 * i] = i;
            s->ends[2 * i + 1] = i + 1;
            s->rest_length[i] = 1;
        }
        s->substeps = 2;
        hold(&s->values, RHEO__FIELD_step, &s->step, 1);
        hold(&s->values, RHEO__FIELD_substeps, &s->substeps, 1);
        hold(&s->values, RHEO__FIELD_history_rows, &s->history_rows, 1);
        hold(&s->values, RHEO__FIELD_position, s->position, PARTICLES);
        hold(&s->values, RHEO__FIELD_velocity, s->velocity, PARTICLES);
        hold(&s->values, RHEO__FIELD_spring_ends, s->ends, 3);
        hold(&s->values, RHEO__FIELD_spring_rest_length, s->rest_length, 3);
    }
    j->states =
        (rheo__same_states){&j->world, &j->side[RECORDED].values, &j->side[OWN].values, &j->side[OTHER].values};
    j->result = (rheo_same_steps){.passed = true};
    j->judge = (rheo__same_judge){.result = &j->result, .limit = limit, .whole = whole};
}

static void judge(judged *j)
{
    rheo__same_judge_states(&j->judge, &j->states, 7, "gravity");
}

static void is_worst(const judged *j, const char *field, double ratio)
{
    assert_string_equal(j->result.worst.field, field);
    assert_int_equal(j->result.worst.step, 7);
    assert_string_equal(j->result.worst.stage, "gravity");
    if (isinf(ratio))
        assert_true(j->result.worst.ratio == ratio);
    else
        NEAR(j->result.worst.ratio, ratio, 1e-9 * ratio);
}

/* d = 3/1024 of one value, against 1/4096 of another and an ulp of all. */
static void ratios_are_of_the_largest_and_of_the_root_mean_square(void **state)
{
    (void)state;
    judged j;
    const double d = 3 * 0x1p-10, y = 0x1p-12;
    begin(&j, 100, false);
    j.side[RECORDED].velocity[5] -= (rheo_real)d;
    j.side[OTHER].velocity[7] += (rheo_real)y;
    judge(&j);
    const rheo_same_ratio *worst = &j.result.worst;
    NEAR(worst->rms, d / sqrt(12), 1e-12);
    NEAR(worst->largest, d, 1e-12);
    NEAR(worst->rms_yardstick, sqrt((11 * ULP * ULP + (y + ULP) * (y + ULP)) / 12), 1e-15);
    NEAR(worst->largest_yardstick, y + ULP, 1e-15);
    is_worst(&j, "velocity", d / (y + ULP)); /* the ulps of the others make that of the mean less */
    assert_true(j.result.passed && j.result.compared == 1 && j.result.decisions == 0);
    /* All values off by the same: the root mean square has the smaller yardstick. */
    begin(&j, 100, false);
    for (int i = 0; i < VALUES; i++)
        j.side[RECORDED].velocity[i] += (rheo_real)d;
    j.side[OTHER].velocity[0] -= (rheo_real)y;
    judge(&j);
    NEAR(j.result.worst.rms, d, 1e-12);
    is_worst(&j, "velocity", d / sqrt((11 * ULP * ULP + (y + ULP) * (y + ULP)) / 12));
}

static void equal_states_have_a_ratio_of_0(void **state)
{
    (void)state;
    judged j;
    begin(&j, 1, true);
    judge(&j);
    assert_true(j.result.passed && j.result.worst.ratio == 0 && j.result.worst.field[0]);
    /* So are the number of the step and the length of the history, which are not compared. */
    begin(&j, 1, false);
    j.side[OWN].step = 9;
    j.side[OWN].history_rows = 9;
    judge(&j);
    assert_true(j.result.passed && j.result.worst.ratio == 0 && j.result.decisions == 0);
}

static void the_first_ratio_above_the_limit_is_kept(void **state)
{
    (void)state;
    judged j;
    for (int k = 0; k < 3; k++) { /* below, at and above the ratio of 8 */
        begin(&j, k == 0 ? 7.9 : k == 1 ? 8 : 8.1, false);
        j.side[RECORDED].velocity[0] += (rheo_real)(8 * ULP);
        judge(&j);
        is_worst(&j, "velocity", 8);
        assert_int_equal(j.result.passed, k > 0);
        assert_string_equal(j.result.first.field, k ? "" : "velocity");
    }
    begin(&j, 1, false);
    j.side[RECORDED].velocity[0] += (rheo_real)(8 * ULP);
    judge(&j);
    j.side[RECORDED].velocity[0] += (rheo_real)(8 * ULP);
    judge(&j);
    NEAR(j.result.first.ratio, 8, 1e-12);
    NEAR(j.result.worst.ratio, 16, 1e-12);
    j.side[RECORDED].velocity[0] = 1;
    judge(&j);
    NEAR(j.result.worst.ratio, 16, 1e-12);
    assert_int_equal(j.result.compared, 3);
}

/* Of -1 as of 1; none of what is not finite, and the least number of 0. */
static void an_ulp_is_that_of_the_own_value(void **state)
{
    (void)state;
    judged j;
    begin(&j, 100, false);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < VALUES; i++)
            j.side[k].velocity[i] = -2;
    j.side[RECORDED].velocity[0] -= (rheo_real)(6 * ULP);
    judge(&j);
    is_worst(&j, "velocity", 3);
    begin(&j, 100, false);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < VALUES; i++)
            j.side[k].velocity[i] = 0;
    j.side[RECORDED].velocity[3] = 5 * (RHEO_DOUBLE ? (rheo_real)0x1p-1074 : (rheo_real)0x1p-149F);
    judge(&j);
    NEAR(j.result.worst.largest_yardstick, 0.2 * j.result.worst.largest, 0);
    const rheo_real largest = (rheo_real)0x1.fffffep127F;
    if (!RHEO_DOUBLE) { /* the next number is infinite; squares of double numbers of this size are, too */
        begin(&j, 100, false);
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < VALUES; i++)
                j.side[k].velocity[i] = largest;
        j.side[RECORDED].velocity[0] = largest / 2;
        judge(&j);
        is_worst(&j, "velocity", INFINITY);
        assert_true(j.result.worst.largest_yardstick == 0);
    }
    for (int bad = 0; bad < 2; bad++) {
        begin(&j, 100, false);
        j.side[RECORDED].velocity[0] = bad ? (rheo_real)NAN : (rheo_real)INFINITY;
        judge(&j);
        is_worst(&j, "velocity", INFINITY);
        assert_false(j.result.passed);
    }
}

/* Along x the space has a period. */
static void positions_are_compared_with_the_nearest_image(void **state)
{
    (void)state;
    judged j;
    static const double FAR[] = {7, 1, 3, 5, 4}, NEAREST[] = {1, 1, 3, 3, 4};
    for (double unit = 0x1p-5; unit <= 1; unit *= 0x1p5)
        for (int k = 0; k < 5; k++)
            for (int axis = 0; axis < 2; axis++) {
                begin(&j, 1e30, false);
                j.world.period.length[0] = (rheo_real)(8 * unit);
                j.side[RECORDED].position[3 + axis] = (rheo_real)(FAR[k] * unit);
                judge(&j);
                assert_string_equal(j.result.worst.field, "position");
                NEAR(j.result.worst.largest, (axis ? FAR[k] : NEAREST[k]) * unit, 0);
            }
    /* Velocities have no images. */
    begin(&j, 1e30, false);
    j.world.period.length[0] = 8;
    j.side[RECORDED].velocity[0] = 8;
    judge(&j);
    NEAR(j.result.worst.largest, 7, 0);
}

static void another_number_of_items_is_no_rounding(void **state)
{
    (void)state;
    for (int k = OWN; k <= OTHER; k++) {
        judged j;
        begin(&j, 1e30, false);
        j.side[k].values.items[RHEO__FIELD_velocity] = PARTICLES - 1;
        judge(&j);
        is_worst(&j, "velocity", INFINITY);
    }
}

/* ---- Springs and other decisions ---- */

/* Gives a side other springs: the first of them is replaced by 0-2, and of a second kind the last by none. */
static void change_springs(side *s, int replaced, int left_out)
{
    if (replaced)
        s->ends[1] = 2;
    s->values.items[RHEO__FIELD_spring_ends] -= (size_t)left_out;
    s->values.items[RHEO__FIELD_spring_rest_length] -= (size_t)left_out;
}

static void springs_of_one_side_are_counted(void **state)
{
    (void)state;
    static const struct {
        int recorded[2], own[2], other[2];
        double ratio, difference;
    } cases[] = {
        {{1, 0}, {0, 0}, {0, 0}, 2, 2}, {{0, 1}, {0, 0}, {0, 0}, 1, 1},   {{1, 1}, {0, 0}, {0, 0}, 3, 3},
        {{0, 0}, {1, 1}, {0, 0}, 1, 3}, {{1, 0}, {0, 0}, {0, 1}, 2, 2},   {{0, 1}, {0, 0}, {1, 0}, 0.5, 1},
        {{0, 0}, {0, 0}, {1, 1}, 0, 0}, {{0, 3}, {0, 0}, {0, 0}, 3, 3},   {{0, 0}, {0, 3}, {0, 0}, 1, 3},
        {{1, 0}, {0, 1}, {0, 0}, 3, 3}, {{0, 1}, {1, 0}, {0, 0}, 1.5, 3},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        judged j;
        begin(&j, 1e30, true);
        change_springs(&j.side[RECORDED], cases[i].recorded[0], cases[i].recorded[1]);
        change_springs(&j.side[OWN], cases[i].own[0], cases[i].own[1]);
        change_springs(&j.side[OTHER], cases[i].other[0], cases[i].other[1]);
        judge(&j);
        if (cases[i].ratio > 0)
            is_worst(&j, "spring_ends", cases[i].ratio);
        NEAR(j.result.worst.ratio, cases[i].ratio, 0);
        NEAR(j.result.worst.largest, cases[i].difference, 0);
        assert_true(j.result.decisions == 0 && j.judge.decisions == 0);
    }
}

/* One of the springs 1-2 and 2-3, which all sides have, is longer in the recording; a side may lack 0-1. */
static void lengths_are_those_of_the_springs_that_all_have(void **state)
{
    (void)state;
    const double longer = 0x1p-6;
    for (int lacks = RECORDED; lacks <= OTHER + 1; lacks++)
        for (int changed = 1; changed < 3; changed++) {
            judged j;
            begin(&j, 1e30, true);
            for (int k = 0; k < 3; k++) {
                side *s = &j.side[k];
                const int out = k == lacks;
                for (int i = 0; i < 3 - out; i++) {
                    s->rest_length[i] = (rheo_real)(i + out + 1 + (k == RECORDED && i + out == changed ? longer : 0));
                    s->ends[2 * i] = (uint32_t)(i + out);
                    s->ends[2 * i + 1] = (uint32_t)(i + out + 1);
                }
                s->values.items[RHEO__FIELD_spring_ends] -= (size_t)out;
                s->values.items[RHEO__FIELD_spring_rest_length] -= (size_t)out;
            }
            judge(&j);
            is_worst(&j, "spring_rest_length", longer / (2 * ULP)); /* an ulp of 2 or 3 */
            NEAR(j.result.worst.largest, longer, 0);
        }
}

static void decisions_are_judged_at_the_end(void **state)
{
    (void)state;
    static const struct {
        int same, own, both; /* steps without a decision; with one of this side; with one of the yardstick, too */
        bool passed;
    } cases[] = {{48, 1, 0, false}, {49, 1, 0, true}, {50, 1, 0, true}, {97, 2, 0, false},
                 {98, 2, 0, true},  {0, 0, 1, true},  {0, 1, 1, false}, {0, 1, 0, false}};
    for (int springs = 0; springs < 2; springs++)
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
            judged j;
            begin(&j, 1, false);
            for (int k = 0; k < cases[i].same; k++)
                judge(&j);
            if (springs)
                change_springs(&j.side[RECORDED], 1, 0);
            else
                j.side[RECORDED].substeps = 3;
            j.side[RECORDED].velocity[0] = 2; /* is not compared in such a step */
            for (int k = 0; k < cases[i].own; k++)
                judge(&j);
            if (springs)
                change_springs(&j.side[OTHER], 1, 0);
            else
                j.side[OTHER].substeps = 4;
            for (int k = 0; k < cases[i].both; k++)
                judge(&j);
            rheo__same_judge_end(&j.judge);
            assert_int_equal(j.result.decisions, cases[i].own + cases[i].both);
            assert_int_equal(j.result.passed, cases[i].passed);
            assert_string_equal(j.result.first.field, cases[i].passed ? "" : springs ? "spring_ends" : "substeps");
            if (!cases[i].passed && springs)
                NEAR(j.result.first.ratio, 2, 0);
        }
}

static void an_earlier_ratio_stays_the_first(void **state)
{
    (void)state;
    judged j;
    begin(&j, 1, false);
    j.side[RECORDED].velocity[0] = 2;
    judge(&j);
    j.side[RECORDED].substeps = 3;
    judge(&j);
    rheo__same_judge_end(&j.judge);
    assert_string_equal(j.result.first.field, "velocity");
    begin(&j, 1, false);
    rheo__same_refuse(&j.judge, 7, "gravity", "velocity");
    is_worst(&j, "velocity", INFINITY);
    assert_true(!j.result.passed && j.result.first.ratio == INFINITY);
}

/* ---- Moves and halves ---- */

/* At the border of what is moved, a number whose partner is beyond it stays. Bits of a word are used up after 64 numbers. */
static void moves_leave_what_is_small_or_not_finite(void **state)
{
    (void)state;
    enum { COUNT = 256 };
    const rheo_real least = RHEO_DOUBLE ? (rheo_real)0x1p-1000 : (rheo_real)0x1p-120F;
    rheo_real all[COUNT], moved[COUNT];
    uint64_t up[COUNT / 64] = {0};
    int above = 0, below = 0;
    for (uint64_t seed = 0; seed < 32; seed++) {
        rheo_real value[] = {least,          -least,    (rheo_real)INFINITY, -(rheo_real)INFINITY,
                             (rheo_real)NAN, least / 2, -least / 2,          0};
        rheo_real was[8];
        memcpy(was, value, sizeof was);
        rheo__same_move(value, 8, seed, 1);
        assert_memory_equal(value + 2, was + 2, 6 * sizeof *was);
        assert_true(value[0] >= least && value[1] <= -least);
        above += value[0] > least;
        below += value[1] < -least;
        rheo__same_move(value, 8, seed, 1);
        assert_memory_equal(value, was, sizeof was);
    }
    assert_true(above > 4 && above < 28 && below > 4 && below < 28);
    for (int i = 0; i < COUNT; i++)
        all[i] = moved[i] = 1.5;
    rheo__same_move(moved, COUNT, 5, 2);
    for (int i = 0; i < COUNT; i++)
        up[i / 64] |= (uint64_t)(moved[i] > all[i]) << i % 64;
    for (int i = 0; i < 3; i++)
        assert_true(up[i] != up[i + 1] && up[i] != 0 && ~up[i] != 0);
}

static void a_memory_of_half_a_million_steps_is_halved(void **state)
{
    (void)state;
    rheo_world world = {0};
    world.def.history.window = world.def.history.lag = 500000;
    assert_true(rheo__same_can_halve(&world));
    world.def.history.window++;
    assert_false(rheo__same_can_halve(&world));
    world.def.history.window--;
    world.def.history.lag++;
    assert_false(rheo__same_can_halve(&world));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ratios_are_of_the_largest_and_of_the_root_mean_square),
        cmocka_unit_test(equal_states_have_a_ratio_of_0),
        cmocka_unit_test(the_first_ratio_above_the_limit_is_kept),
        cmocka_unit_test(an_ulp_is_that_of_the_own_value),
        cmocka_unit_test(positions_are_compared_with_the_nearest_image),
        cmocka_unit_test(another_number_of_items_is_no_rounding),
        cmocka_unit_test(springs_of_one_side_are_counted),
        cmocka_unit_test(lengths_are_those_of_the_springs_that_all_have),
        cmocka_unit_test(decisions_are_judged_at_the_end),
        cmocka_unit_test(an_earlier_ratio_stays_the_first),
        cmocka_unit_test(moves_leave_what_is_small_or_not_finite),
        cmocka_unit_test(a_memory_of_half_a_million_steps_is_halved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
