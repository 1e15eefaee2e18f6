/* The account of a particle, line by line: what is noted, what its replay gives, and whether it holds. */
#include "support.h"

#include <math.h>

#include "core/account.h"
#include "record/values.h"
#include "world/world.h"

#define POSITION RHEO__FIELD_position
#define VELOCITY RHEO__FIELD_velocity
#define SUM RHEO__SUM_pressure

typedef struct noted {
    rheo_world *world;
    rheo__account account;
    rheo__state *state;
} noted;

static void begin(noted *n, uint32_t id)
{
    static const rheo_real position[6] = {1, 2, 3, 4, 5, 6}, velocity[6] = {-1, -2, -3, -4, -5, -6};
    rheo_world_def def = rheo_default_world_def();
    def.particles.count = 2;
    def.particles.position = position;
    def.particles.velocity = velocity;
    OK(rheo_world_create(&def, &n->world, &error));
    n->state = &n->world->state;
    n->account = (rheo__account){.allocator = n->world->def.allocator, .id = id};
    n->state->account = &n->account;
}

static void end(noted *n)
{
    n->state->account = NULL;
    rheo__account_release(&n->account);
    assert_true(!n->account.line && !n->account.stage && !n->account.count);
    rheo_world_destroy(n->world);
}

static void is(const rheo_real *values, double x, double y, double z)
{
    NEAR((double)values[0], x, 0);
    NEAR((double)values[1], y, 0);
    NEAR((double)values[2], z, 0);
}

static void each_operation_is_replayed(void **state)
{
    (void)state;
    noted n;
    rheo__account_values values = {{0}};
    begin(&n, 1);
    rheo__account_set(n.state, SUM, RHEO_SOURCE_NONE, 0, 8, 16, 32);
    rheo__account_add(n.state, SUM, RHEO_SOURCE_NONE, 7, 1, 2, 4);
    rheo__account_scale(n.state, SUM, RHEO__R(0.5));
    rheo__account_set(n.state, VELOCITY, RHEO_SOURCE_NONE, 0, 100, 200, 300);
    rheo__account_apply(n.state, VELOCITY, RHEO_SOURCE_NONE, 2, SUM);
    assert_int_equal(n.account.count, 5);
    assert_int_equal(n.account.line[1].item, 7);
    rheo__account_replay(&n.account, 0, 5, values);
    is(values[SUM], 4.5, 9, 18);
    is(values[VELOCITY], 109, 218, 336);
    is(values[POSITION], 0, 0, 0);
    memset(values, 0, sizeof values);
    rheo__account_replay(&n.account, 1, 3, values); /* some of the lines */
    is(values[SUM], 0.5, 1, 2);
    is(values[VELOCITY], 0, 0, 0);
    end(&n);
}

/* A sum begins with 0, so it needs no line for zeros. A field may be -0. */
static void zeros_are_left_out_of_sums_only(void **state)
{
    (void)state;
    noted n;
    begin(&n, 0);
    for (int axis = 0; axis < 3; axis++)
        rheo__account_add(n.state, SUM, RHEO_SOURCE_NONE, 0, axis == 0, axis == 1, axis == 2);
    assert_int_equal(n.account.count, 3);
    rheo__account_add(n.state, RHEO__ACCOUNT_FIRST_SUM, RHEO_SOURCE_NONE, 0, 0, 0, 0);
    rheo__account_add(n.state, SUM, RHEO_SOURCE_NONE, 0, 0, -RHEO__R(0.0), 0);
    rheo__account_add(n.state, RHEO__ACCOUNT_ENTRIES - 1, RHEO_SOURCE_NONE, 0, 0, 0, 0);
    assert_int_equal(n.account.count, 3);
    rheo__account_add(n.state, RHEO__ACCOUNT_BEFORE_SUMS, RHEO_SOURCE_NONE, 0, 0, 0, 0);
    rheo__account_add(n.state, POSITION, RHEO_SOURCE_NONE, 0, 0, 0, 0);
    assert_int_equal(n.account.count, 5);
    end(&n);
}

/* Lines and stages move to larger memory as they come. */
static void many_lines_and_stages_are_kept(void **state)
{
    (void)state;
    enum { STAGES = 100, LINES = 7 };
    noted n;
    begin(&n, 1);
    for (int i = 0; i < STAGES; i++) {
        char name[16];
        snprintf(name, sizeof name, "stage %d", i);
        rheo__account_open(n.state, name);
        for (int k = 0; k < LINES; k++)
            rheo__account_add(n.state, SUM, RHEO_SOURCE_NONE, (uint32_t)k, 1, 2, 3);
        rheo__account_close(n.state);
    }
    assert_true(n.account.stages == STAGES && n.account.count == STAGES * LINES && !n.account.no_memory);
    for (size_t i = 0; i < STAGES; i++) {
        const rheo__account_stage *s = &n.account.stage[i];
        assert_true(s->first == i * LINES && s->end == (i + 1) * LINES && s->holds);
        assert_int_equal(atoi(s->name + 6), i);
        is(s->before[POSITION], 4, 5, 6); /* of particle 1 */
        is(s->after[VELOCITY], -4, -5, -6);
        const double sum = (double)i * LINES; /* goes on from stage to stage */
        is(s->before[SUM], sum, 2 * sum, 3 * sum);
        is(s->after[SUM], sum + LINES, 2 * (sum + LINES), 3 * (sum + LINES));
    }
    end(&n);
}

/* A stage changes a number of the state by 1 ulp, and notes it or not. */
static void a_number_that_is_not_noted_is_noticed(void **state)
{
    (void)state;
    for (int field = 0; field < 2; field++)
        for (uint32_t axis = 0; axis < 3; axis++)
            for (int noticed = 0; noticed < 2; noticed++) {
                noted n;
                begin(&n, 1);
                rheo_real *own = (field ? n.state->velocity : n.state->position) + 3 + axis;
                rheo__account_open(n.state, "stage");
                const rheo_real to = rheo__unorder(rheo__order(*own) + 1);
                if (noticed)
                    rheo__account_add(n.state, field ? VELOCITY : POSITION, RHEO_SOURCE_NONE, 0,
                                      axis == 0 ? to - *own : 0, axis == 1 ? to - *own : 0,
                                      axis == 2 ? to - *own : 0);
                *own = to;
                rheo__account_close(n.state);
                assert_int_equal(n.account.stage[0].holds, noticed);
                assert_true((field ? n.account.stage[0].after[VELOCITY] : n.account.stage[0].after[POSITION])[axis] ==
                            to);
                end(&n);
            }
}

/* Any NaN is as good as another, but no number is; -0 is not 0. */
static void bits_count_except_those_of_nan(void **state)
{
    (void)state;
    static const struct {
        double noted, is;
        bool holds;
    } cases[] = {{NAN, -NAN, true}, {NAN, 1, false}, {1, NAN, false}, {0, -0.0, false}, {-0.0, -0.0, true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        noted n;
        begin(&n, 0);
        rheo__account_open(n.state, "stage");
        rheo__account_set(n.state, POSITION, RHEO_SOURCE_NONE, 0, 1, (rheo_real)cases[i].noted, 3);
        n.state->position[1] = (rheo_real)cases[i].is;
        rheo__account_close(n.state);
        assert_int_equal(n.account.stage[0].holds, cases[i].holds);
        end(&n);
    }
}

/* Without the particle there is no account, and nothing is noted. */
static void a_particle_that_is_not_there_has_no_stages(void **state)
{
    (void)state;
    noted n;
    for (uint32_t id = 1; id < 3; id++) {
        begin(&n, id);
        rheo__account_open(n.state, "stage");
        rheo__account_close(n.state);
        assert_int_equal(n.account.stages, id == 1);
        end(&n);
    }
}

/* A rest is one addition if it is exact, two if it was rounded, and set if additions do not lead there. */
static void rests_are_added_to_the_bit(void **state)
{
    (void)state;
    const double large = RHEO_DOUBLE ? 0x1p60 : 0x1p30, third = (double)(RHEO__R(1.0) / 3);
    const struct {
        double from, to;
        int additions, sets;
    } cases[] = {{2, 2, 0, 0},    {2, 3, 1, 0},        {0, 0.5, 1, 0},      {large, third, 2, 0}, {-3, third, 2, 0},
                 {0, -0.0, 0, 1}, {1, INFINITY, 1, 0}, {INFINITY, 1, 2, 1}, {5, 0, 1, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (int axis = 0; axis < 3; axis++) {
            noted n;
            begin(&n, 0);
            rheo_real to[3] = {1, 2, 3};
            n.state->position[axis] = (rheo_real)cases[i].from;
            to[axis] = (rheo_real)cases[i].to;
            rheo__account_open(n.state, "before");
            rheo__account_add(n.state, SUM, RHEO_SOURCE_NONE, 0, 1, 1, 1);
            rheo__account_close(n.state);
            rheo__account_open(n.state, "stage");
            rheo__account_add_rest(n.state, POSITION, RHEO_SOURCE_NONE, to);
            memcpy(n.state->position, to, sizeof to);
            rheo__account_close(n.state);
            assert_true(n.account.stage[1].holds);
            int count[4] = {0};
            for (size_t k = 1; k < n.account.count; k++) {
                assert_int_equal(n.account.line[k].entry, POSITION);
                count[n.account.line[k].operation]++;
            }
            if (count[RHEO__ACCOUNT_ADD] != cases[i].additions || count[RHEO__ACCOUNT_SET] != cases[i].sets)
                fail_msg("case %zu: %d additions, %d sets", i, count[RHEO__ACCOUNT_ADD], count[RHEO__ACCOUNT_SET]);
            end(&n);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_operation_is_replayed),
        cmocka_unit_test(zeros_are_left_out_of_sums_only),
        cmocka_unit_test(many_lines_and_stages_are_kept),
        cmocka_unit_test(a_number_that_is_not_noted_is_noticed),
        cmocka_unit_test(bits_count_except_those_of_nan),
        cmocka_unit_test(a_particle_that_is_not_there_has_no_stages),
        cmocka_unit_test(rests_are_added_to_the_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
