/* `rheolog doctor` from outside. */
#include "cli_support.h"
#include <math.h>

/* ---- doctor ---- */

static const char *const doctor_keys[] = {
    "file",           "verdict",   "step",     "stage",          "id",         "other_id",
    "measure",        "value",     "limit",    "unhealthy_step", "why",        "failure",
    "first_step",     "last_step", "complete", "findings",       "advice",     "sign_step",
    "ill_from_start", "suspects",  "seen",     "seen_step",      "seen_value", NULL};

static void doctor_finds_healthy_runs_healthy(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("doctor a.rlog --json"));
    assert_keys(out, doctor_keys);
    assert_string_equal(err, "");
    assert_string_equal(value_of("verdict"), "\"healthy\"");
    assert_string_equal(value_of("step"), "null");
    assert_string_equal(value_of("stage"), "null");
    assert_string_equal(value_of("id"), "null");
    assert_string_equal(value_of("failure"), "null");
    assert_string_equal(value_of("last_step"), "8");
    assert_in("\"findings\": [], \"advice\": []", out);
    assert_code(0, run("doctor a.rlog"));
    assert_string_equal(out, "a.rlog: healthy: every measure is in range in step 0 to 8\n");
    /* A checkpoint has one state and no steps. */
    assert_code(0, run("checkpoint a.rlog --step 3 -o c.rlog --force"));
    assert_code(0, run("doctor c.rlog"));
}

/* What follows a key, at or behind `at`. */
static const char *behind(const char *at, const char *key)
{
    char quoted[40];
    snprintf(quoted, sizeof quoted, "\"%s\": ", key);
    at = strstr(at, quoted);
    assert_non_null(at);
    return at + strlen(quoted);
}

static void assert_begins(const char *line, const char *expected)
{
    if (strncmp(line, expected, strlen(expected)) != 0)
        fail_msg("\"%.90s\" should begin with \"%s\"", line, expected);
}

/* What follows a number of three digits or more. */
static const char *behind_number(const char *line, double expected)
{
    char *end;
    const double value = strtod(line, &end);
    if (!(fabs(value - expected) <= 0.005 * fabs(expected)) || end == line)
        fail_msg("\"%.90s\" should begin with %.4g", line, expected);
    return end;
}

/* The text has a line for each finding of --json, in the same order, and no other. */
static void assert_findings_listed(const char *json, const char *text)
{
    const char *at = behind(json, "findings"), *end = behind(json, "advice"), *line = strstr(text, "  step ");
    int count = 0, springs = 0, several = 0;
    for (at = strstr(at, "{\"step\""); at && at < end; at = strstr(at + 1, "{\"step\""), count++) {
        char expected[128];
        const char *measure = behind(at, "measure") + 1, *id = behind(at, "id"), *other = behind(at, "other_id"),
                   *seen = behind(at, "seen") + 1;
        const int length = (int)strcspn(measure, "\"");
        snprintf(expected, sizeof expected, "  step %-6ld %-25.*s ", atol(behind(at, "step")), length, measure);
        assert_begins(line, expected);
        line = behind_number(line + strlen(expected), atof(behind(at, "value")));
        assert_begins(line, ", more than ");
        line = behind_number(line + strlen(", more than "), atof(behind(at, "limit")));
        /* Its own place, or that of the measure that shows it. */
        if (*id == 'n')
            expected[0] = 0;
        else if (strncmp(seen, measure, (size_t)length + 1) == 0)
            snprintf(expected, sizeof expected, ", ");
        else
            snprintf(expected, sizeof expected, "; %.*s is ", (int)strcspn(seen, "\""), seen);
        assert_begins(line, expected);
        line += strlen(expected);
        if (expected[0] == ';') {
            line = behind_number(line, atof(behind(at, "seen_value")));
            assert_begins(line, " at ");
            line += strlen(" at ");
        }
        if (*other != 'n')
            springs += snprintf(expected, sizeof expected, "spring %ld:%ld", atol(id), atol(other)) > 0;
        else if (*id != 'n')
            snprintf(expected, sizeof expected, "particle %ld", atol(id));
        assert_begins(line, expected);
        line += strlen(expected);
        if (atol(behind(at, "steps")) > 1) {
            snprintf(expected, sizeof expected, "  (%ld steps, up to %.3g in step %ld)", atol(behind(at, "steps")),
                     atof(behind(at, "peak")), atol(behind(at, "peak_step")));
            assert_begins(line, expected);
            line += strlen(expected);
            several++;
        }
        assert_true(*line++ == '\n');
    }
    assert_int_not_equal(strncmp(line, "  step ", 7), 0);
    assert_true(count > 1 && springs > 0 && several > 0);
}

static void doctor_names_the_cause_of_a_failure(void **state)
{
    (void)state;
    /* The run ends with a failed step in float. In double particles may fly apart and the run continue. */
    const int ended =
        run("run %s --steps 400 --set scheme=sequential --set springs.stiffness=37.5 --set history.stiffness=1125 "
            "-o bad.rlog "
            "--force --quiet --json",
            scene);
    assert_true(ended == 0 || ended == 1);
    assert_code(1, run("doctor bad.rlog --json"));
    assert_keys(out, doctor_keys);
    assert_string_equal(value_of("verdict"), "\"unhealthy\"");
    assert_string_equal(value_of("measure"), "\"stiffness_number\"");
    assert_string_equal(value_of("stage"), "\"spring_displacement\"");
    assert_string_equal(value_of("limit"), "2.4");
    assert_in("\"set\": \"springs.solver=implicit\"", out);
    assert_in(ended ? "\"failure\": {\"step\": " : "\"failure\": null", out);
    const long step = atol(value_of("step")), last = atol(value_of("last_step"));
    assert_true(step > 0 && step <= last && atol(value_of("unhealthy_step")) >= step);
    const long a = atol(value_of("id")), b = atol(value_of("other_id"));
    assert_true(a >= 0 && b > a);
    char json[1 << 14];
    snprintf(json, sizeof json, "%.16000s", out);

    /* The text ends with commands. The advised command runs and prevents the failure. */
    char words[128];
    assert_code(1, run("doctor bad.rlog"));
    assert_in("bad.rlog: unhealthy: step ", out);
    assert_findings_listed(json, out);
    snprintf(words, sizeof words, "rheolog inspect bad.rlog --step %ld --spring %ld:%ld\n", step, a, b);
    assert_in(words, out);
    char looked[1 << 12];
    snprintf(looked, sizeof looked, "%.4000s", out);
    assert_code(0, run("%.*s", (int)strcspn(strstr(looked, "inspect bad"), "\n"), strstr(looked, "inspect bad")));
    assert_code(1, run("doctor bad.rlog"));
    snprintf(words, sizeof words, "rheolog checkpoint bad.rlog --step %ld -o before.rlog\n", step - 1);
    assert_in(words, out);
    snprintf(words, sizeof words,
             "    rheolog run --from bad.rlog@%ld --steps 100 --set springs.solver=implicit -o cured.rlog --force\n",
             step - 1);
    assert_in(words, out);
    assert_code(0,
                run("run --from bad.rlog@%ld --steps 100 --set springs.solver=implicit -o good.rlog --force --quiet",
                    step - 1));
    assert_code(0, run("doctor good.rlog"));
    run("run --from bad.rlog@%ld --steps 100 -o again.rlog --force --quiet", step - 1);
    assert_code(1, run("doctor again.rlog"));
}

/* Continues bad.rlog after a step, with a slight push, until a step fails. */
static void push_after(long step)
{
    rheo_error error = {""};
    rheo_recording *recording;
    rheo_recorder *recorder;
    rheo_world *world = NULL;
    if (rheo_recording_open("bad.rlog", &recording, &error) != RHEO_OK ||
        rheo_recording_world(recording, (uint64_t)step, NULL, &world, &error) != RHEO_OK)
        fail_msg("%s", error.message);
    rheo_recording_close(recording);
    remove("pushed.rlog");
    assert_int_equal(rheo_recorder_open(world, "pushed.rlog", NULL, &recorder, &error), RHEO_OK);
    assert_int_equal(rheo_world_push_body(world, 0, (const double[3]){0, 1e-6, 0}, NULL, &error), RHEO_OK);
    for (int i = 0; i < 40 && rheo_recorder_step(recorder, &error) == RHEO_OK; i++)
        continue;
    assert_int_equal(rheo_recorder_close(recorder, &error), RHEO_OK);
    rheo_world_destroy(world);
}

/* A run that continues between a push and the first sign has the push in its state: the cure gives no command again. */
static void a_push_before_the_sign_is_not_given_again(void **state)
{
    (void)state;
    run("run %s --steps 400 --set scheme=sequential --set springs.stiffness=37.5 --set history.stiffness=1125 "
        "-o bad.rlog --force --quiet",
        scene);
    assert_code(1, run("doctor bad.rlog --json"));
    const long sign = atol(value_of("sign_step"));
    assert_true(sign >= 2);
    push_after(sign - 2);
    assert_code(1, run("doctor pushed.rlog --json"));
    assert_int_equal(atol(value_of("sign_step")), sign);
    char words[128];
    snprintf(words, sizeof words, "rheolog run --from pushed.rlog@%ld --steps 100 --set springs.solver=implicit -o ",
             sign - 1);
    assert_code(1, run("doctor pushed.rlog"));
    assert_in("the ball was pushed by impulse", out);
    assert_in(words, out);
}

/* Regression: a checkpoint of step 0 was advised, which is ill itself. */
static void no_checkpoint_is_made_of_an_ill_start(void **state)
{
    (void)state;
    rheo_error error = {""};
    rheo_world *world;
    rheo_recorder *recorder;
    rheo_world_def def = rheo_default_world_def();
    const rheo_real position[3] = {0, 0, 0}, velocity[3] = {(rheo_real)(1010 * def.fluid.support / def.step), 0, 0};
    def.particles.count = 1;
    def.particles.position = position;
    def.particles.velocity = velocity;
    assert_int_equal(rheo_world_create(&def, &world, &error), RHEO_OK);
    assert_int_equal(rheo_recorder_open(world, "ill.rlog", NULL, &recorder, &error), RHEO_OK);
    for (int i = 0; i < 3; i++)
        assert_int_equal(rheo_recorder_step(recorder, &error), RHEO_OK);
    assert_int_equal(rheo_recorder_close(recorder, &error), RHEO_OK);
    rheo_world_destroy(world);
    assert_code(1, run("doctor ill.rlog"));
    assert_in("it was ill from the start", out);
    assert_in("look closer:\n  rheolog inspect ill.rlog --step 0 --particle 0\n", out);
    assert_null(strstr(out, "checkpoint"));
}

static void doctor_examines_a_file_up_to_its_end(void **state)
{
    (void)state;
    record("a.rlog");
    size_t size;
    char *bytes = read_bytes("a.rlog", &size);
    write_file("truncated.rlog", bytes, size - 5);
    assert_code(2, run("doctor truncated.rlog --json"));
    assert_string_equal(value_of("verdict"), "\"healthy\"");
    assert_string_equal(value_of("complete"), "false");
    assert_in("truncated", err);
    assert_code(2, run("doctor truncated.rlog"));
    assert_in("healthy: every measure is in range in step 0 to 8; the recording is truncated after step 8", out);
    for (size_t at = size - 200;; at--)
        if (memcmp(bytes + at, "STEP", 4) == 0) {
            bytes[at + 50] ^= 0x10;
            break;
        }
    write_file("damaged.rlog", bytes, size);
    write_file("cut.rlog", bytes, 100);
    static const char *const bad[] = {"damaged.rlog", "cut.rlog", "empty.rlog", "none.rlog", "."};
    write_file("empty.rlog", "", 0);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_code(2, run("doctor %s --json", bad[i]));
        assert_string_equal(value_of("verdict"), "\"unreadable\"");
        assert_string_equal(value_of("step"), "null");
        assert_keys(out, (const char *const[]){"file", "verdict", "step", "stage", "id", "why", NULL});
        assert_in("rheolog: ", err);
    }
}

/* `doctor` reads the whole file, and `info` only what says where its parts are, as its help says. */
static void damage_of_a_keyframe_is_found(void **state)
{
    (void)state;
    record("a.rlog");
    size_t size, at = 8;
    char *bytes = read_bytes("a.rlog", &size);
    while (at < size && memcmp(bytes + at, "FILD", 4) != 0)
        at++;
    bytes[at + 40] ^= 1;
    write_file("damaged.rlog", bytes, size);
    assert_code(2, run("doctor damaged.rlog"));
    assert_in("damaged.rlog: damaged: the chunk at byte ", err);
    assert_string_equal(out, "");
    assert_code(2, run("doctor a.rlog damaged.rlog --json"));
    assert_in("\"verdict\": \"healthy\"", out);
    assert_in("\"verdict\": \"unreadable\"", out);
    assert_code(0, run("info damaged.rlog"));
    assert_code(0, run("info --help"));
    assert_in("the states are not read", out);
    assert_code(2, run("verify damaged.rlog"));
}

/* ---- Commands that make a scene again ---- */

#define SICK_BOX "melting-box --set fluid.spacing=0.12 --set melting.sound_speed=0.8"
#define CURE " --steps 100 --set melting.sound_speed="

/* Records sick.rlog again, up to its end, as by this command line and with this text of the scene. */
static void record_as(const char *path, const char *made_by, const char *scene_text)
{
    rheo_error error = {""};
    rheo_recording *recording;
    rheo_recorder *recorder;
    rheo_world *world = NULL;
    const rheo_record_options options = {.force = true, .made_by = made_by, .scene_text = scene_text};
    if (rheo_recording_open("sick.rlog", &recording, &error) != RHEO_OK ||
        rheo_recording_world(recording, 0, NULL, &world, &error) != RHEO_OK ||
        rheo_recorder_open(world, path, &options, &recorder, &error) != RHEO_OK)
        fail_msg("%s", error.message);
    const uint64_t steps = rheo_recording_get_info(recording).last_step;
    rheo_recording_close(recording);
    for (uint64_t i = 0; i < steps && rheo_recorder_step(recorder, &error) == RHEO_OK; i++)
        continue;
    assert_int_equal(rheo_recorder_close(recorder, &error), RHEO_OK);
    rheo_world_destroy(world);
}

/* A scene that is ill from the start is made again by the words that made it, and the change behind them. */
static void a_cure_has_the_words_that_made_the_scene(void **state)
{
    (void)state;
    static const struct {
        const char *given, *stored;
    } options[] = {{"", ""},
                   {" --full", " --full"},
                   {" --keyframes 7", " --keyframes 7"},
                   {" --max-size 1G", " --max-size 1073741824"},
                   {" --set melting.viscosity=0.2", " --set melting.viscosity=0.2"},
                   {" --full --keyframes 7 --max-size 1G --set 'gravity=[0, -9, 0]'",
                    " --set 'gravity=[0, -9, 0]' --keyframes 7 --max-size 1073741824 --full"}};
    char words[512];
    for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
        run("run " SICK_BOX "%s --steps 60 -o sick.rlog --force --quiet", options[i].given);
        assert_code(1, run("doctor sick.rlog"));
        snprintf(words, sizeof words, "\n    rheolog run " SICK_BOX "%s" CURE, options[i].stored);
        assert_in(words, out);
        assert_in(" -o cured.rlog --force\n", out);
    }
}

/* A text that `rheolog run` does not store may hold anything, and is given to no shell. */
static void a_cure_has_no_words_of_a_foreign_command(void **state)
{
    (void)state;
    static const char *const foreign[] = {"rheolog run " SICK_BOX " --set",
                                          "rheolog run " SICK_BOX " --keyframes",
                                          "rheolog run " SICK_BOX " --force",
                                          "rheolog run " SICK_BOX " -o a.rlog",
                                          "rheolog run " SICK_BOX " --quiet x",
                                          "rheolog run melting-bax",
                                          ("rheolog runs " SICK_BOX),
                                          "rheolog run",
                                          "my game"};
    run("run " SICK_BOX " --steps 60 -o sick.rlog --force --quiet");
    record_as("made.rlog", "rheolog run " SICK_BOX, NULL);
    assert_code(1, run("doctor made.rlog"));
    assert_in("\n    rheolog run " SICK_BOX CURE, out);
    for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++) {
        record_as("made.rlog", foreign[i], NULL);
        assert_code(1, run("doctor made.rlog"));
        if (!strstr(out, "melting.sound_speed=") || strstr(out, "    rheolog run "))
            fail_msg("%s: %s", foreign[i], out);
    }
    /* The stored text of the scene makes it, too. It may be for another version. */
    record_as("made.rlog", "my game", "{\"of\": \"another version\"}");
    assert_code(1, run("doctor made.rlog"));
    assert_in("\n    rheolog log made.rlog --scene > again.json && rheolog run again.json" CURE, out);
    if (json_scenes) { /* no value helps a scene without fluid, so none is advised */
        record_as("made.rlog", "my game", "{\"scene\": \"empty\"}");
        assert_code(1, run("doctor made.rlog"));
        assert_null(strstr(out, "melting.sound_speed="));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(doctor_finds_healthy_runs_healthy),
        cmocka_unit_test(doctor_names_the_cause_of_a_failure),
        cmocka_unit_test(a_push_before_the_sign_is_not_given_again),
        cmocka_unit_test(no_checkpoint_is_made_of_an_ill_start),
        cmocka_unit_test(doctor_examines_a_file_up_to_its_end),
        cmocka_unit_test(damage_of_a_keyframe_is_found),
        cmocka_unit_test(a_cure_has_the_words_that_made_the_scene),
        cmocka_unit_test(a_cure_has_no_words_of_a_foreign_command),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
