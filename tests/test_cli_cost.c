/*
 * What answers about a recording take, as --cost counts it. Keyframes are 20 steps apart, and the counts follow from that: an
 * answer begins at the keyframe before what is asked about, or at the place, and needs no step twice.
 */
#include "cli_support.h"

enum { APART = 20, STEPS = 70 };

static const char *const COST = "cost: ";

static void record_long(void)
{
    assert_code(0, run("run %s --steps %d --keyframes %d -o cost.rlog --force --quiet", scene, STEPS, APART));
}

/* The numbers of a line of --cost; the line after it. */
static const char *read_cost(const char *at, unsigned *steps, unsigned *states)
{
    assert_non_null(at = strstr(at, COST));
    const char *number = at + strlen(COST);
    *steps = (unsigned)number_at(&number);
    assert_non_null(number = strstr(number, "simulated, "));
    number += strlen("simulated, ");
    *states = (unsigned)number_at(&number);
    assert_in(" read, ", number);
    return strchr(number, '\n') + 1;
}

static void costs(unsigned expected, unsigned expected_states, const char *command)
{
    unsigned steps, states;
    const int code = run("%s --cost", command);
    if (code != 0 && code != 1)
        fail_msg("%s: %s", command, err);
    read_cost(err, &steps, &states);
    if (steps != expected || states != expected_states)
        fail_msg("%s: simulates %u steps and reads %u states, not %u and %u", command, steps, states, expected,
                 expected_states);
}

static void metrics_are_answered_at_once(void **state)
{
    (void)state;
    record_long();
    costs(0, 0, "when cost.rlog 'step > 65'");
    costs(0, 0, "when cost.rlog 'step > 65 or max_speed > 1e9' --last");
    costs(0, 0, "when cost.rlog 'not step > 65' --all");
    costs(0, 0, "when cost.rlog 'time > 1e9'");
    assert_code(1, run("when cost.rlog 'time > 1e9' --json"));
    assert_in("\"steps_simulated\": 0, \"states_read\": 0, ", out);
}

/* Two states: the first one, with which a player opens, and the keyframe. */
static void items_are_answered_from_the_keyframe_before(void **state)
{
    (void)state;
    record_long();
    costs(0, 1, "when cost.rlog 'ball: y < 1e9'");
    costs(3 * 19 + 10, 4, "when cost.rlog 'ball: y > 1e9'"); /* nothing holds: every step, from every keyframe */
    costs(14, 2, "when cost.rlog 'ball: y < 1e9' --after 33");
    costs(10, 2, "when cost.rlog 'ball: y < 1e9' --last");
    costs(19, 2, "when cost.rlog 'ball: y < 1e9' --last --before 60");
    costs(3, 2, "when cost.rlog 'step == 43 and any particle: speed >= 0'");
    costs(14, 2, "when cost.rlog 'ball: y < 1e9' --after 33 --stage gravity");
    costs(19, 2, "inspect cost.rlog --step 59");
    costs(19, 2, "inspect cost.rlog --step 59 --stage forces@1");
    costs(10, 2, "inspect cost.rlog");
    costs(0, 2, "inspect cost.rlog --step 60");
    costs(19, 2, "track cost.rlog --ball --from 51 --to 59");
    costs(15 + 4 + 5, 3, "track cost.rlog --ball --from 35 --to 45");
    costs(0, 4, "track cost.rlog --ball --every 20");
    costs(19, 2, "track cost.rlog --ball --stages --from 58 --to 59");
}

/* Commands of `rheolog debug` and the steps and states that they take. */
typedef struct session {
    const char *command;
    unsigned steps, states;
} session;

static void debug_costs(const session *s, size_t count)
{
    static char look[4096];
    *look = 0;
    for (size_t i = 0; i < count; i++) {
        strcat(look, s[i].command);
        strcat(look, "\n");
    }
    write_file("look.txt", look, strlen(look));
    assert_code(0, run("debug cost.rlog -x look.txt --cost --quiet"));
    const char *at = err;
    for (size_t i = 0; i < count; i++) {
        unsigned steps, states;
        at = read_cost(at, &steps, &states);
        if (steps != s[i].steps || states != s[i].states)
            fail_msg("%s: simulates %u steps and reads %u states, not %u and %u", s[i].command, steps, states,
                     s[i].steps, s[i].states);
    }
}

#define DEBUG(...) \
    debug_costs((const session[]){__VA_ARGS__}, sizeof((const session[]){__VA_ARGS__}) / sizeof(session))

static void moves_take_the_way_from_the_place_or_a_keyframe(void **state)
{
    (void)state;
    record_long();
    DEBUG({"goto 39", 19, 1}, {"step", 0, 1}, {"step 3", 3, 0}, {"stage", 1, 0}, {"stage", 0, 0}, {"step", 0, 0},
          {"goto 59 gravity@1", 14 + 1, 0}, {"goto 59", 0, 0}, {"goto 21", 1, 1}, {"goto last", 10, 1},
          {"goto 59", 19, 1}, {"back", 18, 1}, {"back", 1, 1}, {"back", 0, 1}, {"back 3", 1, 1}, {"print", 0, 0},
          {"track ball y -5", 13, 2}, {"goto first", 0, 1});
}

/* Nothing is simulated that the place has behind it, and nothing again to go to what was found. */
static void until_goes_on_from_the_place(void **state)
{
    (void)state;
    record_long();
    DEBUG({"goto 22", 2, 1}, {"until ball: y < 1e9", 1, 1}, {"until step > 37", 15, 0},
          {"until any particle: speed >= 0 and step > 39", 0, 2}, {"goto 43 gravity@1", 3, 0},
          {"until step > 44", 2, 0}, {"when ball: y < 1e9 and step > 68", 10, 2});
}

/* The way back to what was found is at most an eighth of an interval. */
static void back_until_goes_there_from_a_state_near_it(void **state)
{
    (void)state;
    static char look[] = "goto 58\nback until ball: y < 1e9\nback until ball: y < 1e9 and step < 49\n"
                         "back until step < 29\nback until any particle: speed >= 0 and step < 20\n";
    unsigned steps[5], states;
    record_long();
    write_file("look.txt", look, strlen(look));
    assert_code(0, run("debug cost.rlog -x look.txt --cost --quiet"));
    const char *at = err;
    for (int i = 0; i < 5; i++)
        at = read_cost(at, &steps[i], &states);
    const unsigned near = (APART - 1) / 8 + 1;
    assert_in("(cost 58) back until ball: y < 1e9\nstep 57: ", out);
    assert_in(" and step < 49\nstep 48: ", out);
    assert_in("back until step < 29\nstep 28: ", out);
    assert_in(" and step < 20\nstep 19: ", out);
    assert_in_range(steps[1], 17, 17 + near);
    assert_in_range(steps[2], 8, 8 + near); /* metrics exclude the steps after 48 */
    assert_int_equal(steps[3], 8);
    assert_in_range(steps[4], 19, 19 + near);
}

/* A fork is looked at while it is run, so that no step is made twice. */
static void a_fork_is_run_once(void **state)
{
    (void)state;
    record_long();
    DEBUG({"goto 22", 2, 1}, {"set gravity [0, -20, 0]", 0, 1}, {"until step > 63", 64 - 22, 0},
          {"until ball: y < 1e9 and step > 67", 4, 0}, {"back 3", 68 - 3 - 22, 1}, {"until step > 66", 2, 0});
}

/* A change is printed after the player has read a keyframe, and so has another world. */
static void why_prints_the_unit_after_a_keyframe_is_read(void **state)
{
    (void)state;
    record_long();
    assert_code(0, run("why cost.rlog --step 39 --particle 50"));
    assert_in("step 39, position of particle 50 (unit L):", out);
}

/* One more step than to the state before. */
static void why_makes_the_step_once_more(void **state)
{
    (void)state;
    record_long();
    costs(18, 1, "why cost.rlog --step 18 --particle 50");
    costs(1, 2, "why cost.rlog --step 41 --particle 50");
    costs(20, 2, "why cost.rlog --step 60 --particle 50 --stage forces@1");
    costs(20, 2, "why-not cost.rlog --step 45 --pair 10:90");
    costs(10, 2, "why-not cost.rlog --step 66 --spring 50:51");
    assert_code(0, run("why cost.rlog --step 41 --particle 50 --json"));
    assert_in("\"steps_simulated\": 1, \"states_read\": 2, ", out);
    run("why-not cost.rlog --step 66 --pair 50:51 --json");
    assert_in("\"steps_simulated\": 10, \"states_read\": 2, ", out);
}

/* The way to the step is not made again. A link costs the steps that are looked at, and few before them. */
static void a_chain_takes_half_an_interval_more_than_its_step(void **state)
{
    unsigned steps, states;
    (void)state;
    assert_code(0, run("run %s --steps 70 --keyframes 70 -o cost.rlog --force --quiet", scene));
    run("why cost.rlog --step 68 --particle 50 --depth 6 --cost");
    assert_in("\n  ends: after 6 links, as asked", out);
    read_cost(err, &steps, &states);
    assert_in_range(steps, 68 + 6, 68 + 35);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(metrics_are_answered_at_once),
        cmocka_unit_test(items_are_answered_from_the_keyframe_before),
        cmocka_unit_test(moves_take_the_way_from_the_place_or_a_keyframe),
        cmocka_unit_test(until_goes_on_from_the_place),
        cmocka_unit_test(back_until_goes_there_from_a_state_near_it),
        cmocka_unit_test(a_fork_is_run_once),
        cmocka_unit_test(why_prints_the_unit_after_a_keyframe_is_read),
        cmocka_unit_test(why_makes_the_step_once_more),
        cmocka_unit_test(a_chain_takes_half_an_interval_more_than_its_step),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
