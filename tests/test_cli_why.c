/* `rheolog why` and `rheolog why-not` from outside, and what debug and doctor say by them. */
#include <math.h>

#include "cli_support.h"

static void why_has_its_keys(void **state)
{
    (void)state;
    static const char *const keys[] = {"step",    "stage",   "field",  "id",     "before",  "after",
                                       "exact",   "count",   "source", "item",   "item_id", "contributions",
                                       "sum",     "value",   "factor", "change", "sets",    "file",
                                       "outcome", "changes", "reason", NULL};
    static const char *const chain[] = {"chain", "largest", "not_finite", "end", "end_step", "why", NULL};
    record("a.rlog");
    assert_code(0, run("why a.rlog --step 6 --particle 20 --json"));
    assert_keys(out, keys);
    assert_null(strstr(out, "\"chain\""));
    assert_string_equal(err, "");
    assert_in("{\"step\": 6, \"stage\": \"prediction@1\", \"field\": \"position\", \"id\": 20, \"before\": [", out);
    assert_in("\"source\": \"velocity\", \"item\": null, \"item_id\": null, \"sum\": null, ", out);
    assert_in("\n{\"file\": \"a.rlog\", \"outcome\": \"found\", \"changes\": ", out);
    assert_null(strstr(out, "\"exact\": false"));
    assert_code(0, run("why a.rlog --step 6 --particle 20 --json --depth 3"));
    assert_keys(out, chain);
    assert_code(2, run("why a.rlog --step 60 --particle 20 --json"));
    assert_in("\"outcome\": \"refused\", \"changes\": 0, \"steps_simulated\": 0, \"states_read\": 1, "
              "\"reason\": \"a.rlog: there is no step 60 to look into",
              out);
}

/* The number of lines that begin so. */
static size_t lines_with(const char *begin)
{
    size_t count = 0;
    for (const char *line = out; line && *line; line = strchr(line, '\n'), line = line ? line + 1 : NULL)
        count += strncmp(line, begin, strlen(begin)) == 0;
    return count;
}

static void the_largest_is_marked_and_the_rest_counted(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("why a.rlog --step 6 --particle 20 --stage forces@1 --top 2"));
    assert_in("step 6, position of particle 20 (unit L):\nforces@1: (", out);
    assert_in(") -> (", out);
    assert_int_equal(lines_with("  * "), 1);
    assert_int_equal(lines_with("    "), 2);
    assert_in("\n    and ", out);
    assert_in(" more, together ", out);
    assert_code(0, run("why a.rlog --step 6 --particle 20 --stage forces@1 --all"));
    assert_int_equal(lines_with("  * "), 1);
    assert_true(lines_with("    ") > 5);
    assert_null(strstr(out, " more, together "));
    assert_in("pressure of ", out);
    assert_in("spring ", out);
    assert_code(0, run("why a.rlog --step 6 --particle 20 --field velocity --stage gravity@1"));
    assert_in("\n  * ", out);
    assert_in(" gravity ", out);
    assert_in("(unit L/T):\n", out);
}

/* What is left out of the lines is not left out of the sums: those of --all and of the rest agree. */
static void the_contributions_give_the_change(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("why a.rlog --step 6 --particle 20 --stage forces@1 --all --json"));
    const char *at = out;
    double before[3], after[3], sum[3] = {0};
    at = strstr(at, "\"before\": [") + 11;
    for (int i = 0; i < 3; i++, at++)
        before[i] = strtod(at, (char **)&at);
    at = strstr(at, "\"after\": [") + 10;
    for (int i = 0; i < 3; i++, at++)
        after[i] = strtod(at, (char **)&at);
    size_t count = 0;
    while ((at = strstr(at, "\"change\": [")) != NULL) {
        at += 11;
        for (int i = 0; i < 3; i++, at++)
            sum[i] += strtod(at, (char **)&at);
        count++;
    }
    assert_true(count > 5);
    for (int i = 0; i < 3; i++)
        assert_true(fabs(after[i] - before[i] - sum[i]) < 1e-5);
}

/* A field that is summed anew loses its old value, which is no cause. */
static void an_old_value_that_goes_is_not_the_largest(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("why a.rlog --step 6 --particle 20 --field derivative --all --depth 2"));
    assert_int_equal(lines_with("fractional_derivative: "), 1);
    assert_in(" its old value goes ", out);
    assert_int_equal(lines_with("  * "), 1);
    assert_null(strstr(out, ", most by its old value"));
    const char *marked = strstr(out, "\n  * ");
    assert_non_null(marked);
    const char *past = strstr(marked, "the past, lag "), *end = strchr(marked + 1, '\n');
    assert_true(past && past < end);
    assert_in("derivative of particle 20 changed by ", out);
    assert_in(", most by the past, lag ", out);
}

static void a_chain_says_why_it_ends(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("why a.rlog --step 6 --particle 20 --depth 2"));
    assert_in("\ncauses, each from the largest contribution to the one before:\n  step 6, ", out);
    assert_int_equal(lines_with("  step "), 2);
    assert_in("\n  ends: after 2 links, as asked\n", out);
    assert_code(0, run("why a.rlog --step 1 --particle 20 --depth 100"));
    assert_in("\n  ends: the recording begins with the state of step 0\n", out);
    assert_code(0, run("run --from a.rlog@3 --steps 3 --set gravity=[0,-50,0] -o b.rlog --force --quiet"));
    assert_code(0, run("why b.rlog --step 6 --particle 20 --depth 100"));
    assert_in("\n  ends: before step 4, gravity was set to [0,-50,0]\n", out);
}

/* Pressures are so large that distances overflow: the step fails, and NaN is born in the forces. */
static void not_a_number_is_followed_to_its_birth(void **state)
{
    (void)state;
    if (sizeof(rheo_real) != sizeof(float))
        skip(); /* a double holds such distances */
    record("a.rlog");
    assert_code(1, run("run --from a.rlog@4 --steps 2 --set fluid.stiffness=1e30 -o bad.rlog --force --quiet"));
    assert_code(1, run("doctor bad.rlog --json"));
    assert_in("\"reason\": \"not-finite\"", out);
    assert_code(0, run("why bad.rlog --step 5 --particle 0"));
    assert_in("not finite from here on\n", out);
    assert_in(": position of particle 0 not finite, born, with pressure of ", out);
    assert_in("\n  ends: born here: the values that ", out);
    assert_code(0, run("why bad.rlog --step 5 --particle 0 --json"));
    assert_in("\"not_finite\": \"born\", ", out);
    assert_in("\"end\": \"born\", ", out);
}

/* The step fails, but a plate has put its particle back in place before. */
static void what_a_plate_swallows_is_followed_to_its_birth(void **state)
{
    (void)state;
    if (sizeof(rheo_real) != sizeof(float))
        skip(); /* a double holds such positions */
    assert_code(0, run("run plates --set resolution=0.5 --steps 1 -o plates.rlog --force --quiet"));
    assert_code(1, run("run --from plates.rlog --steps 1 --set gravity=[0,-1e30,0] --set step=1e5 --set substeps=1 "
                       "-o bad.rlog --force --quiet"));
    assert_code(0, run("why bad.rlog --step 2 --particle 0 --stage plates"));
    assert_in(", plates@1: position of particle 0 finite again, swallowed, with lower plate\n", out);
    assert_in(", prediction@1: position of particle 0 not finite, born, with velocity: ", out);
    assert_in("\n  ends: born here: the values that prediction@1 ", out);
}

static void bad_usage_is_refused(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(2, run("why a.rlog --step 3"));
    assert_one_message("needs --step S and --particle ID");
    assert_code(2, run("why --step 3 --particle 4"));
    assert_one_message("needs one recording");
    assert_code(2, run("why a.rlog --step 3 --particle 4 --top 3 --all"));
    assert_one_message("one of --top and --all");
    assert_code(2, run("why a.rlog --step 3 --particle 4 --depth 0"));
    assert_one_message("a number from 1 to 1000");
    assert_code(2, run("why a.rlog --step 0 --particle 4"));
    assert_one_message("there is no step 0 to look into; the recording has 1 to 8");
    assert_code(2, run("why a.rlog --step 3 --particle 400000"));
    assert_one_message("there is no particle 400000");
    assert_code(2, run("why a.rlog --step 3 --particle 4 --stage heat"));
    assert_one_message("there is no stage \"heat\"");
    assert_code(2, run("why a.rlog --step 3 --particle 4 --field heat"));
    assert_one_message("is no field of a particle that stages add to");
}

static void a_step_that_does_not_repeat_is_named(void **state)
{
    (void)state;
    record("a.rlog");
    falsify_step("a.rlog", "other.rlog", 5);
    assert_code(1, run("why other.rlog --step 6 --particle 4"));
    assert_in("step 5", err);
}

/* ---- why-not ---- */

/* The distance of two particles. */
static double distance_of(const rheo_world *world, uint32_t a, uint32_t b)
{
    rheo_particle_state x, y;
    double r2 = 0;
    assert_int_equal(rheo_world_particle(world, a, &x, NULL), RHEO_OK);
    assert_int_equal(rheo_world_particle(world, b, &y, NULL), RHEO_OK);
    for (int axis = 0; axis < 3; axis++)
        r2 += (x.position[axis] - y.position[axis]) * (x.position[axis] - y.position[axis]);
    return sqrt(r2);
}

/* Particles that are far from particle 20 and near it at the end of step 5; *distance: of the far one. */
static void find_pairs(uint32_t *far, uint32_t *near, double *distance)
{
    rheo_world *world = checkpoint_at("a.rlog", 5);
    const uint32_t count = rheo_world_particle_count(world);
    double least = 4;
    *distance = 0;
    for (uint32_t id = 0; id < count; id++) {
        const double r = id == 20 ? 4 : distance_of(world, 20, id);
        if (r > *distance) {
            *distance = r;
            *far = id;
        }
        if (r < least) {
            least = r;
            *near = id;
        }
    }
    rheo_world_destroy(world);
    assert_true(*distance > 5 && least < 3);
}

static void why_not_tells_distances(void **state)
{
    (void)state;
    static const char *const keys[] = {
        "file",    "outcome",   "id",     "other_id",      "support",    "distance",     "nearest_step",
        "nearest", "held_last", "across", "nearest_stage", "held_first", "first_looked", "last_looked",
        "why",     "reason",    NULL};
    uint32_t far = 0, near = 0;
    double distance;
    record("a.rlog");
    find_pairs(&far, &near, &distance);
    assert_code(0, run("why-not a.rlog --step 5 --spring 20:%u --json", (unsigned)far));
    assert_keys(out, keys);
    assert_true(fabs(strtod(value_of("distance"), NULL) - distance) < 1e-6);
    assert_code(0, run("why-not a.rlog --step 5 --spring 20:%u", (unsigned)far));
    assert_in(" supports apart at the end of step 5, nearest in step ", out);
    assert_in(", after densities@", out);
    assert_in("; springs form below 1\n", out);
    assert_code(0, run("why-not a.rlog --step 5 --pair %u:20 --list", (unsigned)far));
    assert_int_equal(lines_with("       "), 9); /* steps 0 to 8 */
    assert_in("; particles are neighbours below 1\n", out);
    assert_code(1, run("why-not a.rlog --step 5 --spring 20:%u", (unsigned)near));
    assert_in(", and have a spring\n", out);
    assert_code(1, run("why-not a.rlog --step 5 --pair 20:%u", (unsigned)near));
    assert_in(", and so are neighbours\n", out);
}

static void why_not_refuses_bad_usage(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(2, run("why-not a.rlog --step 5"));
    assert_one_message("needs --step S, and --spring A:B or --pair A:B");
    assert_code(2, run("why-not a.rlog --step 5 --spring 3"));
    assert_one_message("needs two different ids");
    assert_code(2, run("why-not a.rlog --step 9 --spring 3:4"));
    assert_one_message("step");
    assert_code(2, run("why-not a.rlog --step 5 --spring 3:400000"));
    assert_one_message("there is no particle 400000 in step 5");
}

/* ---- The page ---- */

/* What docs/debugging.md shows of `why` and `why-not` is what the program prints. */
static void the_examples_of_the_page_are_true(void **state)
{
    (void)state;
    static char page[1 << 18];
    char path[4096], arguments[256], expected[4096];
    size_t examples = 0;
    if (sizeof(rheo_real) != sizeof(float))
        skip(); /* the page is of a build for float */
    snprintf(path, sizeof path, "%s/../../docs/debugging.md", getenv("SCENES"));
    read_file(path, page, sizeof page);
    run("run bowling-ball-small --set step=0.07 --set substeps=2 --steps 60 -o bad.rlog --force --quiet");
    for (const char *at = page; (at = strstr(at, "\n$ rheolog why")) != NULL; examples++) {
        at += strlen("\n$ rheolog ");
        snprintf(arguments, sizeof arguments, "%.*s", (int)strcspn(at, "\n"), at);
        at = strchr(at, '\n');
        const char *fence = strstr(at, "\n```"), *next = strstr(at, "\n$ ");
        const char *end = next && next < fence ? next : fence;
        snprintf(expected, sizeof expected, "%.*s\n", (int)(end - at - 1), at + 1);
        assert_code(0, run("%s", arguments));
        assert_string_equal(out, expected);
    }
    assert_int_equal(examples, 4);
    assert_code(1, run("doctor bad.rlog"));
    const char *chain = strstr(page, "\n  rheolog why bad.rlog --step 18 --particle 3987 --depth 6\n");
    assert_non_null(chain);
    snprintf(expected, sizeof expected, "%.*s", (int)(strstr(chain, "```") - chain), chain);
    assert_in(expected, out);
}

/* ---- debug, doctor ---- */

static void debug_explains_the_step_that_led_here(void **state)
{
    (void)state;
    static char why[1 << 16];
    record("a.rlog");
    const char *const commands = "goto 6\nwhy particle 20\ngoto 6 forces@2\nwhy particle 20 velocity 3\n";
    write_file("look.txt", commands, strlen(commands));
    assert_code(0, run("why a.rlog --step 6 --particle 20"));
    snprintf(why, sizeof why, "(a 6) why particle 20\n%.60000s(a 6) goto", out);
    assert_code(0, run("debug a.rlog -x look.txt"));
    assert_in(why, out);
    assert_code(0, run("why a.rlog --step 6 --particle 20 --field velocity --depth 3 --stage forces@2"));
    snprintf(why, sizeof why, "(a 6 forces@2) why particle 20 velocity 3\n%.60000s", out);
    assert_code(0, run("debug a.rlog -x look.txt"));
    assert_in(why, out);
    write_file("look.txt", "why particle 20\n", 16);
    assert_code(2, run("debug a.rlog -x look.txt"));
    assert_in("step 0 is the first: no step led to it", err);
    write_file("look.txt", "step\nwhy 20\n", 12);
    assert_code(2, run("debug a.rlog -x look.txt"));
    assert_in("why needs a particle, as in: why particle 17", err);
}

static void doctor_ends_with_the_chain(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("doctor a.rlog --json"));
    assert_in("\"chain\": null, \"chain_end\": null, \"chain_why\": null}", out);
    if (sizeof(rheo_real) != sizeof(float))
        skip(); /* a double holds such distances */
    assert_code(1, run("run --from a.rlog@4 --steps 2 --set fluid.stiffness=1e30 -o bad.rlog --force --quiet"));
    assert_code(1, run("doctor bad.rlog"));
    assert_in("\n  rheolog why bad.rlog --step 5 --particle ", out);
    assert_in("\n  ends: born here: the values that ", out);
    assert_code(1, run("doctor bad.rlog --json"));
    assert_in("\"chain\": [{\"step\": 5, \"stage\": \"forces@", out);
    assert_in("\"chain_end\": \"born\", \"chain_why\": \"born here: ", out);
    assert_code(1, run("doctor bad.rlog bad.rlog"));
    assert_null(strstr(out, "born here"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(why_has_its_keys),
        cmocka_unit_test(the_largest_is_marked_and_the_rest_counted),
        cmocka_unit_test(the_contributions_give_the_change),
        cmocka_unit_test(an_old_value_that_goes_is_not_the_largest),
        cmocka_unit_test(a_chain_says_why_it_ends),
        cmocka_unit_test(not_a_number_is_followed_to_its_birth),
        cmocka_unit_test(what_a_plate_swallows_is_followed_to_its_birth),
        cmocka_unit_test(bad_usage_is_refused),
        cmocka_unit_test(a_step_that_does_not_repeat_is_named),
        cmocka_unit_test(why_not_tells_distances),
        cmocka_unit_test(why_not_refuses_bad_usage),
        cmocka_unit_test(the_examples_of_the_page_are_true),
        cmocka_unit_test(debug_explains_the_step_that_led_here),
        cmocka_unit_test(doctor_ends_with_the_chain),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
