/* `rheolog track` from outside: its values are those of inspect. */
#include "cli_support.h"

#include <math.h>

/* The cell of a column in a line of CSV; "" if it is empty. */
static const char *cell(const char *csv, int line, const char *column)
{
    static char text[64];
    int index = 0;
    const char *at = csv;
    for (;; index++) { /* in the header */
        const size_t length = strcspn(at, ",\n");
        if (strlen(column) == length && strncmp(at, column, length) == 0)
            break;
        if (at[length] != ',')
            fail_msg("no column %s", column);
        at += length + 1;
    }
    at = csv;
    for (int i = 0; i < line; i++) {
        at = strchr(at, '\n');
        assert_non_null(at);
        at++;
    }
    for (int i = 0; i < index; i++) {
        at += strcspn(at, ",\n");
        assert_int_equal(*at, ',');
        at++;
    }
    snprintf(text, sizeof text, "%.*s", (int)strcspn(at, ",\n"), at);
    return text;
}

static int lines(const char *text)
{
    int count = 0;
    for (; *text; text++)
        count += *text == '\n';
    return count;
}

static char csv[sizeof out];

static void follow(const char *options)
{
    assert_code(0, run("track a.rlog %s", options));
    memcpy(csv, out, sizeof csv);
}

static void a_particle_has_the_values_of_inspect(void **state)
{
    (void)state;
    record("a.rlog");
    follow("--particle 4");
    assert_int_equal(lines(csv), 10); /* the header, and steps 0 to 8 */
    assert_memory_equal(csv, "step,time,x,y,z,vx,vy,vz,speed,density,", 39);
    assert_code(0, run("inspect a.rlog --step 6 --particle 4 --json"));
    const char *particle = strstr(out, "\"particle\": {");
    assert_non_null(particle);
    static const char *const names[] = {"speed", "density", "near_density", "pressure", "near_pressure"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char key[40];
        snprintf(key, sizeof key, "\"%s\": ", names[i]);
        const char *at = strstr(particle, key);
        assert_non_null(at);
        assert_true(strtod(cell(csv, 7, names[i]), NULL) == strtod(at + strlen(key), NULL));
    }
    assert_true(strtod(cell(csv, 7, "y"), NULL) ==
                strtod(strchr(strstr(particle, "\"position\": ["), ',') + 1, NULL));
    assert_string_equal(cell(csv, 7, "step"), "6");
    assert_string_equal(cell(csv, 7, "time"), "0.198");
}

static void columns_and_steps_are_chosen(void **state)
{
    (void)state;
    record("a.rlog");
    follow("--particle 4 --field vy,derivative.x --from 2 --to 6 --every 2");
    assert_int_equal(lines(csv), 4);
    assert_memory_equal(csv, "step,time,vy,derivative.x\n2,", 28);
    assert_string_equal(cell(csv, 3, "step"), "6");
    assert_code(0, run("track a.rlog --particle 4 --field vy --to 0 --json"));
    assert_memory_equal(out, "{\"step\": 0, \"time\": 0, \"vy\": ", 29);
    assert_int_equal(lines(out), 1);
}

static void a_spring_has_its_history(void **state)
{
    (void)state;
    char ends[40];
    unsigned a, b;
    record("a.rlog");
    assert_code(0, run("inspect a.rlog --step 6 --top 1 --json"));
    const char *stiffest = strstr(out, "\"stiffest\": [{\"id\": ");
    assert_non_null(stiffest);
    assert_int_equal(sscanf(stiffest, "\"stiffest\": [{\"id\": %u, \"other_id\": %u", &a, &b), 2);
    snprintf(ends, sizeof ends, "--spring %u:%u --history", b, a); /* in any order */
    follow(ends);
    assert_code(0, run("inspect a.rlog --step 6 --spring %u:%u --json", a, b));
    static const char *const names[] = {"rest_length", "length", "stretch", "history_rate", "stiffness", "kappa"};
    const char *spring = strstr(out, "\"spring\": {");
    assert_non_null(spring);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char key[40];
        snprintf(key, sizeof key, "\"%s\": ", names[i]);
        assert_true(strtod(cell(csv, 7, names[i]), NULL) == strtod(strstr(spring, key) + strlen(key), NULL));
    }
    assert_string_equal(cell(csv, 7, "exists"), "1");
    const char *history = strstr(spring, "\"history\": [");
    double d[3];
    for (int lag = 0; lag < 3; lag++) {
        char column[16];
        history = strstr(history + 1, "\"difference\": [");
        assert_non_null(history);
        assert_int_equal(sscanf(history, "\"difference\": [%lf, %lf, %lf]", d, d + 1, d + 2), 3);
        snprintf(column, sizeof column, "lag.%d", lag);
        const double expected = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        assert_true(fabs(strtod(cell(csv, 7, column), NULL) - expected) <= 1e-6 * expected);
    }
    /* A spring that is not there has empty cells. */
    follow("--spring 0:63");
    assert_string_equal(cell(csv, 2, "exists"), "0");
    assert_string_equal(cell(csv, 2, "length"), "");
}

static void stages_have_lines_of_their_own(void **state)
{
    (void)state;
    record("a.rlog");
    follow("--particle 4 --field y,vy --stages --from 5 --to 6");
    assert_memory_equal(csv, "step,stage,time,y,vy\n5,neighbours,0.132,", 40);
    int at = 1;
    for (; strcmp(cell(csv, at, "stage"), "prediction@2") != 0 || strcmp(cell(csv, at, "step"), "6") != 0; at++)
        ;
    char y[64];
    snprintf(y, sizeof y, "%s", cell(csv, at, "y"));
    assert_code(0, run("inspect a.rlog --step 6 --stage prediction@2 --particle 4 --json"));
    assert_true(strtod(y, NULL) ==
                strtod(strchr(strstr(strstr(out, "\"particle\": {"), "\"position\": ["), ',') + 1, NULL));
    /* The last stage of a step is the state at its end. */
    snprintf(y, sizeof y, "%s", cell(csv, lines(csv) - 1, "y"));
    assert_string_equal(cell(csv, lines(csv) - 1, "stage"), "history");
    follow("--particle 4 --field y --from 6 --to 6");
    assert_string_equal(cell(csv, 1, "y"), y);
}

/* In a melting world, it runs in each substep. */
static void the_last_stage_of_a_step_has_its_number(void **state)
{
    (void)state;
    record_melting("m.rlog", "--set melting.substeps=3");
    assert_code(0, run("track m.rlog --particle 4 --field y --stages --from 2 --to 2 --json"));
    assert_in("\"stage\": \"integration@1\"", out);
    assert_in("\"stage\": \"integration@3\"", out);
    assert_null(strstr(out, "\"stage\": \"integration\""));
}

static void a_probe_has_means(void **state)
{
    (void)state;
    record("a.rlog");
    follow("--ball --every 8");
    assert_memory_equal(csv, "step,time,x,y,z,vx,vy,vz,speed,spin.x,spin.y,spin.z\n0,", 54);
    assert_string_equal(cell(csv, 2, "step"), "8");
    follow("--probe 1e6,0,0 --to 0");
    assert_string_equal(cell(csv, 1, "particles"), "0");
    assert_string_equal(cell(csv, 1, "speed"), "");
    /* At the place of a particle there are its neighbours and itself, with the weight 1. */
    char point[128], particles[32];
    follow("--particle 4 --to 0");
    snprintf(point, sizeof point, "--to 0 --probe %s", cell(csv, 1, "x"));
    snprintf(point + strlen(point), sizeof point - strlen(point), ",%s", cell(csv, 1, "y"));
    snprintf(point + strlen(point), sizeof point - strlen(point), ",%s", cell(csv, 1, "z"));
    snprintf(particles, sizeof particles, "%ld", strtol(cell(csv, 1, "neighbours"), NULL, 10) + 1);
    follow(point);
    assert_string_equal(cell(csv, 1, "particles"), particles);
    assert_code(0, run("inspect a.rlog --step 0 --particle 4 --json"));
    double weight = 1;
    for (const char *at = strstr(out, "\"neighbours\": ["); (at = strstr(at, "\"weight\": ")) != NULL; at++)
        if (at < strstr(out, "\"springs\": ["))
            weight += strtod(at + 10, NULL);
    assert_true(fabs(strtod(cell(csv, 1, "weight"), NULL) - weight) < 1e-5);
}

/* The ball with a number, as metrics, inspect, when and debug show it. */
static void a_ball_has_a_number(void **state)
{
    (void)state;
    char y[2][40], line[128];
    record("a.rlog"); /* with one ball */
    assert_code(0, run("run bowling-balls --set resolution=0.4 --set settle.time=1 --steps 8 -o a.rlog --force"));
    for (int ball = 1; ball <= 2; ball++) {
        snprintf(line, sizeof line, ball == 1 ? "--ball --to 8 --every 8" : "--to 8 --every 8 --ball %d", ball);
        follow(line);
        snprintf(y[ball - 1], sizeof y[0], "%s", cell(csv, 2, "y"));
        assert_string_equal(cell(csv, 2, "step"), "8");
    }
    assert_string_not_equal(y[0], y[1]);
    follow("--ball=2 --from 8");
    assert_string_equal(cell(csv, 1, "y"), y[1]);
    assert_code(0, run("metrics a.rlog --columns ball2_y"));
    assert_non_null(strstr(out, y[1]));
    assert_code(0, run("inspect a.rlog --step 8"));
    assert_in("\nball 2        ", out);
    assert_code(0, run("when a.rlog 'ball 2: y <= %s and step == 8'", y[1]));
    assert_in("step 8: ball 2: y is ", out);
    assert_code(0, run("when a.rlog 'ball 2: y <= %s and step == 8' --json", y[1]));
    assert_in("\"item\": \"ball\", \"id\": 1, ", out);
    assert_code(0, run("when a.rlog 'ball: y <= %s and step == 8' --json", y[0]));
    assert_in("\"item\": \"ball\", \"id\": null, ", out);
    assert_code(2, run("track a.rlog --ball 3"));
    assert_one_message("a.rlog has no ball 3; it has 2");
    assert_code(2, run("track a.rlog --ball 0"));
    assert_one_message("balls are numbered from 1");
    assert_code(
        0,
        run("debug a.rlog <<'END'\nprint ball 2\ntrack ball 2 vy 2\nset ball2.velocity [0, 7, 0]\nprint ball 2\nEND"));
    assert_in("velocity    0, 7, 0 L/T", out);
    assert_code(0, run("debug a.rlog <<'END'\nprint ball 3\nEND"));
    assert_in("has no ball 3; it has 2", err);
}

static void bad_usage_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *options, *text;
    } cases[] = {
        {"", "needs one of --particle ID"},
        {"--ball --particle 3", "needs one of --particle ID"},
        {"--spring 3", "needs two different ids"},
        {"--spring 3:3", "needs two different ids"},
        {"--spring 3:x", "needs two different ids"},
        {"--probe 1,2", "needs three coordinates"},
        {"--probe 1,2,3,4", "needs three coordinates"},
        {"--probe 1,2,x", "--probe needs a number"},
        {"--particle 4294967296", "ids are at most"},
        {"--particle 100000", "has no particle 100000"},
        {"--particle 4 --field sped", "did you mean \"speed\""},
        {"--ball --history", "goes with --particle and --spring"},
        {"--particle 4 --from 9", "--from"},
        {"--particle 4 --every 0", "--every needs 1 or more"},
    };
    record("a.rlog");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_code(2, run("track a.rlog %s", cases[i].options));
        assert_one_message(cases[i].text);
    }
    assert_code(2, run("track none.rlog --ball"));
    assert_one_message("none.rlog");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_particle_has_the_values_of_inspect),
        cmocka_unit_test(columns_and_steps_are_chosen),
        cmocka_unit_test(a_spring_has_its_history),
        cmocka_unit_test(stages_have_lines_of_their_own),
        cmocka_unit_test(the_last_stage_of_a_step_has_its_number),
        cmocka_unit_test(a_probe_has_means),
        cmocka_unit_test(a_ball_has_a_number),
        cmocka_unit_test(bad_usage_is_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
