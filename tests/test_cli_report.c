/* `rheolog report` from outside: what the page holds is compared with the library. */
#define _XOPEN_SOURCE 700 /* setenv() */
#include "report_support.h"

#include <unistd.h>

/* ---- States ---- */

static void a_page_has_the_states_of_the_recording(void **state)
{
    (void)state;
    if (!json_scenes) /* the scene would be a larger one */
        skip();
    static const char *const keys[] = {"file",      "other", "output", "outcome", "reason",  "verdict", "bytes",
                                       "max_bytes", "exact", "steps",  "stages",  "details", NULL};
    record("a.rlog");
    assert_code(0, run("report a.rlog -o a.html --force --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("outcome"), "\"done\"");
    assert_string_equal(value_of("exact"), "true");
    assert_string_equal(value_of("steps"), "9");
    assert_int_equal(atol(value_of("bytes")), file_size("a.html"));
    const int stages = atoi(value_of("stages"));
    read_page("a.html");
    assert_int_equal(assert_all_frames("a.rlog"), 9 + stages);
    assert_non_null(frame_of(8, "null"));
    assert_in("\"version\": 1, \"name\": \"a.rlog\", \"other\": null, \"model\": \"thickening\"", meta);
    assert_in("\"stages\": [\"neighbours\"", meta);
}

/* A small page has fewer states, and fewer bits. */
static void rounded_states_are_as_near_as_their_bits_allow(void **state)
{
    (void)state;
    if (!json_scenes) /* the scene would be a larger one */
        skip();
    record("a.rlog");
    assert_code(0, run("report a.rlog -o a.html --force --max-size 300K --json"));
    assert_string_equal(value_of("exact"), "false");
    const int frames = atoi(value_of("steps")) + atoi(value_of("stages"));
    read_page("a.html");
    assert_int_equal(assert_all_frames("a.rlog"), frames);
}

static void a_melting_world_has_its_own_quantities(void **state)
{
    (void)state;
    record_melting("m.rlog", "--steps 4");
    assert_code(0, run("report m.rlog -o m.html --force --json"));
    const int frames = atoi(value_of("steps")) + atoi(value_of("stages"));
    read_page("m.html");
    assert_int_equal(assert_all_frames("m.rlog"), frames);
    assert_true(quantity_of("temperature") >= 0 && quantity_of("viscosity") >= 0 && quantity_of("springs") < 0);
    assert_in("\"model\": \"melting\"", meta);
}

/* ---- Exact values ---- */

/* Compares the numbers of an object "key": {...} with those of the same names in what inspect printed. */
static void assert_numbers(const char *object, const char *printed)
{
    const char *at = strchr(object, '{') + 1;
    while (*at == '"') {
        char name[64];
        snprintf(name, sizeof name, "%.*s", (int)strcspn(at + 1, "\""), at + 1);
        char *component = strchr(name, '.');
        const int skipped = component ? component[1] - 'x' : 0;
        if (component)
            *component = 0;
        at = strchr(at, ':') + 2;
        const double value = number_at(&at);
        char key[80];
        snprintf(key, sizeof key, "\"%s\": ", name);
        const char *expected = strstr(printed, key);
        if (expected && expected[strlen(key)] != '[') {
            expected += strlen(key);
        } else if (expected) {
            expected += strlen(key) + 1;
            for (int i = 0; i < skipped; i++)
                expected = strchr(expected, ',') + 2;
        }
        if (expected && *expected != '{') { /* neighbours and springs are lists there */
            const double number = number_at(&expected);
            if (!(fabs(value - number) <= 6e-8 * fabs(number)))
                fail_msg("%s is %.17g instead of %.17g", name, value, number);
        }
        at += strspn(at, ", ");
    }
    assert_int_equal(*at, '}');
}

static void details_are_those_of_inspect(void **state)
{
    (void)state;
    if (!json_scenes) /* the scene would be a larger one */
        skip();
    int springs_seen = 0, rows_seen = 0, seen = 0;
    record("a.rlog");
    assert_code(0, run("report a.rlog -o a.html --force"));
    read_page("a.html");
    const char *frames = strstr(meta, "\"frames\": [");
    for (const char *at = strstr(meta, "\"details\": ["); (at = strstr(at, "{\"frame\": ")) != NULL; at++) {
        const char *detail = at, *f = frames;
        const int frame = (int)number_after(&detail, "frame"), particle = (int)number_after(&detail, "particle");
        for (int i = 0; i <= frame; i++)
            f = strstr(f + 1, "{\"step\": ");
        const int step = (int)number_after(&f, "step");
        char stage[64] = "";
        f = strstr(f, "\"stage\": ") + strlen("\"stage\": ");
        if (*f == '"')
            snprintf(stage, sizeof stage, "--stage %.*s", (int)strcspn(f + 1, "\""), f + 1);
        if (seen++ > 30 && seen % 16 != 0)
            continue;
        assert_code(0, run("inspect a.rlog --step %d %s --particle %d --json", step, stage, particle));
        const char *printed = strstr(out, "\"particle\": {\"id\"");
        assert_non_null(printed);
        assert_numbers(strstr(detail, "\"values\": {"), printed);
        /* Springs, in the same order. */
        detail = strstr(detail, "\"springs\": [") + strlen("\"springs\": [");
        const char *spring = strstr(printed, "\"springs\": [") + strlen("\"springs\": [");
        for (; *detail == '{'; springs_seen++) {
            const char *other = detail;
            assert_true(number_after(&other, "other") == number_after(&spring, "partner"));
            char numbers[512] = "{";
            snprintf(numbers + 1, sizeof numbers - 1, "%s", other + 2);
            assert_numbers(numbers, spring);
            detail += strcspn(detail, "}") + 1;
            detail += strspn(detail, ", ");
        }
        /* The past, at the end of a step. */
        const char *past = strstr(detail, "\"past\": "), *history = strstr(printed, "\"history\": [");
        const bool whole = !*stage || strcmp(stage, "--stage history") == 0,
                   rows = history[strlen("\"history\": [")] == '{';
        if ((past[strlen("\"past\": ")] == '{') != (whole && rows))
            fail_msg("step %d %s, particle %d: %.40s", step, stage, particle, past);
        if (!whole || !rows)
            continue;
        const char *age = strstr(past, "\"age\": [") + strlen("\"age\": [");
        const char *velocity = strstr(past, "\"velocity\": [[") + strlen("\"velocity\": [");
        double now = NAN;
        for (; *velocity == '['; rows_seen++) {
            const double time = number_after(&history, "time");
            now = isnan(now) ? time : now;
            assert_true(fabs(number_at(&age) - (now - time)) <= 1e-5);
            age += strspn(age, ", ");
            history = strstr(history, "\"velocity\": [") + strlen("\"velocity\": [");
            velocity++;
            for (int axis = 0; axis < 3; axis++) {
                const double v = number_at(&history), shown = number_at(&velocity);
                assert_true(fabs(shown - v) <= 6e-8 * fabs(v));
                history += strspn(history, ", ");
                velocity += strspn(velocity, ", ");
            }
            velocity += strspn(velocity, "], ");
        }
    }
    if (seen < 30 || springs_seen < 100 || rows_seen < 10)
        fail_msg("only %d particles, %d springs, %d rows", seen, springs_seen, rows_seen);
}

/* ---- Size ---- */

static void the_limit_of_the_size_is_kept(void **state)
{
    (void)state;
    if (!json_scenes) /* the scene would be a larger one */
        skip();
    long last = 0;
    record("a.rlog");
    remove("a.html");
    /* What is too small is refused, and the size that the message names is enough. */
    assert_code(2, run("report a.rlog -o a.html --force --max-size 2000"));
    assert_one_message("too small for one state of");
    assert_int_equal(file_size("a.html"), -1);
    const char *named = strstr(err, "particles; ");
    assert_non_null(named);
    const long enough = atol(named + strlen("particles; "));
    for (long most = enough; most < 3000000; most = most * 5 / 4 + 977) {
        assert_code(0, run("report a.rlog -o a.html --force --max-size %ld --force --json", most));
        const long made = file_size("a.html");
        if (made > most)
            fail_msg("%ld bytes with --max-size %ld", made, most);
        assert_true(atoi(value_of("steps")) >= 1);
        read_page("a.html");
        assert_true(assert_all_frames("a.rlog") >= 1);
        last = made;
    }
    assert_true(last > 500000); /* what there is room for is used */
}

static void states_are_denser_near_the_first_sign(void **state)
{
    (void)state;
    if (!json_scenes) /* the scene would be a larger one */
        skip();
    assert_code(0, run("run %s --steps 60 -o long.rlog --quiet --force", scene));
    assert_code(0, run("report long.rlog -o long.html --force --max-size 260K --json"));
    const int steps = atoi(value_of("steps"));
    if (steps <= 6 || steps >= 50)
        fail_msg("%d steps", steps);
    read_page("long.html");
    const char *at = strstr(meta, "\"frames\": ["), *text = strstr(page, "The view begins at <a href=\"#step=");
    assert_non_null(text);
    const int focus = atoi(text + strlen("The view begins at <a href=\"#step="));
    int near = 0, far = 0, last = -1;
    while ((at = strstr(at, "{\"step\": ")) != NULL && at < strstr(meta, "\"marks\": [")) {
        const int step = atoi(at++ + strlen("{\"step\": "));
        if (step == last)
            continue;
        last = step;
        near += abs(step - focus) <= 3;
        far += abs(step - focus) > 15;
    }
    assert_true(near >= 4);                  /* of at most 7 */
    assert_true(7 * far < near * (61 - 31)); /* fewer of those that there are */
    assert_non_null(frame_of(0, "null"));
    assert_non_null(frame_of(60, "null"));
}

/* ---- The same bytes ---- */

static void equal_recordings_give_equal_pages(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("report a.rlog -o a.html --force"));
    assert_string_equal(out, "a.html\n");
    assert_int_equal(system("mkdir -p else/where && cp a.rlog else/where/a.rlog"), 0);
    assert_code(0, run("report else/where/a.rlog -o b.html --force --simd scalar"));
    assert_files_same("a.html", "b.html");
    read_page("a.html");
    char here[4096];
    assert_non_null(getcwd(here, sizeof here));
    assert_null(strstr(page, here));
    assert_null(strstr(page, "where/"));
    setenv("LC_ALL", "de_DE.UTF-8", 1);
    setenv("TZ", "Asia/Tokyo", 1);
    assert_code(0, run("report a.rlog -o c.html --force"));
    unsetenv("LC_ALL");
    unsetenv("TZ");
    assert_files_same("a.html", "c.html");
    assert_int_equal(system("rm -r else"), 0);
}

/* ---- Texts of a stranger ---- */

/* Writes a recording of a small world with these texts. */
static void record_with(const char *path, const rheo_world_def *def, const char *name, const char *made_by, int steps)
{
    rheo_world *world;
    rheo_recorder *recorder;
    rheo_error error = {""};
    const rheo_record_options options = {.scene = name, .made_by = made_by, .force = true};
    assert_int_equal(rheo_world_create(def, &world, &error), RHEO_OK);
    assert_int_equal(rheo_recorder_open(world, path, &options, &recorder, &error), RHEO_OK);
    for (int i = 0; i < steps; i++)
        assert_int_equal(rheo_recorder_step(recorder, &error), RHEO_OK);
    assert_int_equal(rheo_recorder_close(recorder, &error), RHEO_OK);
    rheo_world_destroy(world);
}

static const rheo_real TWO[6] = {0, 1, 0, 1.5, 1, 0};

static rheo_world_def two_particles(void)
{
    rheo_world_def def = rheo_default_world_def();
    def.particles.count = 2;
    def.particles.position = TWO;
    return def;
}

static void texts_of_a_recording_are_only_text(void **state)
{
    (void)state;
    static const char file[] = "<img src=x onerror=alert(1)>&\"'`$(true) \xc3\xa4\xff.rlog";
    const rheo_world_def def = two_particles();
    record_with(file, &def, "</script><script>alert(2)</script><!--@data--> \xe2\x80\xa8\"&\xff",
                "rheolog run '<b onclick=alert(3)>'", 2);
    write_file("name.txt", file, strlen(file));
    assert_code(0, run("report \"$(cat name.txt)\" -o a.html --force --json"));
    read_page("a.html");
    assert_int_equal(times("<img"), 0);
    assert_int_equal(times("<b onclick"), 0);
    assert_int_equal(times("<script>alert"), 0);
    assert_int_equal(times("\xff"), 0);
    assert_int_equal(times("<script"), 3); /* description, data, program */
    assert_int_equal(times("</script"), 3);
    assert_in("&lt;/script&gt;&lt;script&gt;alert(2)", page);
    assert_in("\"name\": \"\\u003cimg src=x onerror=alert(1)>&\\\"'`$(true) \xc3\xa4\\ufffd.rlog\"", meta);
    assert_in("<title>&lt;img src=x onerror=alert(1)&gt;&amp;&quot;&#39;`$(true) \xc3\xa4\xef\xbf\xbd.rlog", page);
}

/* ---- Damage ---- */

static void a_cut_recording_is_shown_up_to_its_last_whole_step(void **state)
{
    (void)state;
    if (!json_scenes) /* the first state would be more than three quarters of the file */
        skip();
    size_t length;
    record("a.rlog");
    const char *all = read_bytes("a.rlog", &length);
    write_file("cut.rlog", all, length * 3 / 4);
    rheo_recording *recording;
    assert_int_equal(rheo_recording_open("cut.rlog", &recording, NULL), RHEO_OK);
    const unsigned last = (unsigned)rheo_recording_get_info(recording).last_step;
    rheo_recording_close(recording);
    assert_true(last > 0 && last < 8);
    assert_code(0, run("report cut.rlog -o cut.html --force"));
    assert_in("truncated", err);
    read_page("cut.html");
    assert_non_null(frame_of(last, "null"));
    assert_null(frame_of(last + 1, "null"));
    assert_true(assert_all_frames("cut.rlog") > (int)last);
    assert_in("truncated", page);
}

static void a_damaged_recording_is_refused(void **state)
{
    (void)state;
    size_t length;
    record("a.rlog");
    char *all = read_bytes("a.rlog", &length);
    all[length / 2] ^= 1;
    write_file("bad.rlog", all, length);
    assert_code(2, run("report bad.rlog -o bad.html --force --json"));
    assert_string_equal(value_of("outcome"), "\"refused\"");
    assert_in("bad.rlog", err);
    assert_int_equal(file_size("bad.html"), -1);
    assert_code(2, run("report tiny.json -o bad.html --force"));
    assert_one_message("tiny.json");
    assert_code(2, run("report absent.rlog -o bad.html --force"));
    assert_one_message("absent.rlog");
    assert_int_equal(file_size("bad.html"), -1);
}

static void a_recording_that_is_not_reproduced_is_refused(void **state)
{
    (void)state;
    record("a.rlog");
    falsify_step("a.rlog", "b.rlog", 6);
    remove("b.html");
    assert_code(1, run("report b.rlog -o b.html --force --json"));
    assert_string_equal(value_of("outcome"), "\"differs\"");
    assert_int_equal(file_size("b.html"), -1);
    /* As the second one it is shown as far as it is reproduced. */
    assert_code(0, run("report a.rlog b.rlog -o b.html --force --json"));
    read_page("b.html");
    array divergence;
    assert_true(values_of(frame_of(5, "null"), "divergence", &divergence));
    assert_false(values_of(frame_of(7, "null"), "divergence", &divergence));
}

/* ---- Two recordings ---- */

static void the_divergence_is_the_distance_of_the_positions(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("run %s --set fluid.linear_viscosity=9 --steps 6 -o b.rlog --quiet --force", scene));
    assert_code(0, run("report a.rlog b.rlog -o b.html --force --json"));
    assert_string_equal(value_of("other"), "\"b.rlog\"");
    read_page("b.html");
    for (int step = 0; step <= 6; step += 3) {
        rheo_world *a = checkpoint_at("a.rlog", step), *b = checkpoint_at("b.rlog", step);
        array divergence;
        double most = 0;
        assert_true(values_of(frame_of((unsigned)step, "null"), "divergence", &divergence));
        for (uint32_t i = 0; i < rheo_world_particle_count(a); i++) {
            double sum = 0;
            for (int axis = 0; axis < 3; axis++) {
                const double way = (double)rheo_world_positions(a)[3 * i + (uint32_t)axis] -
                                   (double)rheo_world_positions(b)[3 * i + (uint32_t)axis];
                sum += way * way;
            }
            most = sum > most ? sum : most;
            assert_value(&divergence, i, 1, 0, sqrt(sum));
        }
        assert_true(step == 0 ? most == 0 : most > 0);
        rheo_world_destroy(a);
        rheo_world_destroy(b);
    }
    array divergence; /* the second one has no step 7 */
    assert_false(values_of(frame_of(7, "null"), "divergence", &divergence));
    assert_in("\"other\": \"b.rlog\"", meta);
    assert_in("\"kind\": \"difference\"", meta);
    assert_in("<td>9</td>", page); /* the parameter that differs */
    assert_in("fluid.linear_viscosity", page);
    assert_in("growth of the difference", page);
    /* The page looks first at the first difference, which diff names. */
    assert_code(1, run("diff a.rlog b.rlog --json"));
    const char *first = strstr(out, "\"first\": {");
    char link[64];
    snprintf(link, sizeof link, "The view begins at <a href=\"#step=%.0f\"", number_after(&first, "step"));
    assert_in(link, page);
}

static void equal_recordings_have_no_difference(void **state)
{
    (void)state;
    record("a.rlog");
    record("b.rlog");
    assert_code(0, run("report a.rlog b.rlog -o b.html --force"));
    read_page("b.html");
    assert_null(strstr(meta, "\"kind\": \"difference\""));
    assert_in("same: 8 steps", page);
    record_melting("m.rlog", "--steps 2");
    assert_code(2, run("report a.rlog m.rlog -o m.html --force")); /* they have nothing in common */
    assert_in("cannot be compared", err);
}

/* ---- Runs of all kinds ---- */

static void a_step_that_failed_is_shown_up_to_the_stage_that_failed(void **state)
{
    (void)state;
    rheo_error error = {""};
    rheo_world *world;
    rheo_recorder *recorder;
    rheo_failure failure;
    const rheo_world_def def = two_particles();
    const rheo_real fastest = sizeof(rheo_real) == 4 ? (rheo_real)3e38 : (rheo_real)1e308;
    assert_int_equal(rheo_world_create(&def, &world, &error), RHEO_OK);
    assert_int_equal(rheo_recorder_open(world, "ill.rlog", &(rheo_record_options){.force = true}, &recorder, &error),
                     RHEO_OK);
    for (int i = 0; i < 3; i++)
        assert_int_equal(rheo_recorder_step(recorder, &error), RHEO_OK);
    assert_int_equal(rheo_world_add_particles(world, 1, (rheo_real[]){9, 9, 9}, (rheo_real[]){fastest, 0, 0}, &error),
                     RHEO_OK);
    assert_int_equal(rheo_world_set(world, "step", "1e6", &error), RHEO_OK);
    assert_int_equal(rheo_recorder_step(recorder, &error), RHEO_ERROR_STATE);
    assert_true(rheo_world_failure(world, &failure));
    assert_int_equal(rheo_recorder_close(recorder, &error), RHEO_OK);
    rheo_world_destroy(world);
    assert_code(0, run("report ill.rlog -o ill.html --force --json"));
    assert_string_equal(value_of("verdict"), "\"unhealthy\"");
    read_page("ill.html");
    assert_non_null(frame_of(3, "null"));
    assert_null(frame_of(4, "null"));
    char named[64];
    snprintf(named, sizeof named, "\"%s\"", failure.stage);
    assert_null(frame_of(4, named));
    assert_true(frame_of(4, "\"neighbours\"") != NULL || strcmp(failure.stage, "neighbours") == 0);
    assert_in("\"kind\": \"failure\"", meta);
    assert_in("step was set to 1", page);
}

static void particles_may_be_added_and_there_may_be_none(void **state)
{
    (void)state;
    rheo_error error = {""};
    rheo_world *world;
    rheo_recorder *recorder;
    rheo_world_def def = two_particles();
    assert_int_equal(rheo_world_create(&def, &world, &error), RHEO_OK);
    assert_int_equal(rheo_recorder_open(world, "more.rlog", &(rheo_record_options){.force = true}, &recorder, &error),
                     RHEO_OK);
    for (int i = 0; i < 6; i++) {
        if (i % 2)
            assert_int_equal(
                rheo_world_add_particles(world, 1, (rheo_real[]){(rheo_real)(3 * i), 4, 0}, NULL, &error), RHEO_OK);
        assert_int_equal(rheo_recorder_step(recorder, &error), RHEO_OK);
    }
    assert_int_equal(rheo_recorder_close(recorder, &error), RHEO_OK);
    rheo_world_destroy(world);
    assert_code(0, run("report more.rlog -o more.html --force --json"));
    const int frames = atoi(value_of("steps")) + atoi(value_of("stages"));
    read_page("more.html");
    assert_int_equal(assert_all_frames("more.rlog"), frames);
    const char *first = frame_of(0, "null"), *last = frame_of(6, "null");
    assert_int_equal(number_after(&first, "particles"), 2);
    assert_int_equal(number_after(&last, "particles"), 5);
    assert_in("\"kind\": \"command\"", meta);
    def.particles.count = 0;
    def.ball.radius = 2;
    record_with("none.rlog", &def, "", NULL, 3);
    assert_code(0, run("report none.rlog -o none.html --force"));
    read_page("none.html");
    last = frame_of(3, "null");
    assert_int_equal(number_after(&last, "particles"), 0);
    assert_in("\"balls\": [{\"position\": [0, ", last);
}

static void a_checkpoint_has_one_state(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("checkpoint a.rlog --step 3 -o c.rlog"));
    assert_code(0, run("report c.rlog -o c.html --force --json"));
    assert_string_equal(value_of("steps"), "1");
    assert_string_equal(value_of("stages"), "0");
    read_page("c.html");
    assert_non_null(frame_of(3, "null"));
    assert_in("no step, so no stage ran", page);
}

/* A particle that is far away does not take the bits of the others. */
static void a_particle_far_away_leaves_the_others_their_bits(void **state)
{
    (void)state;
    enum { COUNT = 2000 };
    static rheo_real position[3 * COUNT];
    for (int i = 0; i < COUNT; i++)
        for (int axis = 0; axis < 3; axis++)
            position[3 * i + axis] = (rheo_real)(2 * (i /
                                                      (axis == 0   ? 1
                                                       : axis == 1 ? 10
                                                                   : 100) %
                                                      (axis < 2 ? 10 : 20)));
    position[3 * 777] = (rheo_real)1e12;
    rheo_world_def def = rheo_default_world_def();
    def.particles.count = COUNT;
    def.particles.position = position;
    record_with("far.rlog", &def, "far", NULL, 2);
    assert_code(0, run("report far.rlog -o far.html --force --max-size 700K --json"));
    assert_string_equal(value_of("exact"), "false");
    read_page("far.html");
    const array a = positions_of(frame_of(0, "null"));
    assert_true(a.max[0] - a.min[0] < 30);
    assert_memory_equal(a.far, "[777, ", 6);
    const int frames = assert_all_frames("far.rlog");
    assert_true(frames >= 1);
}

/* ---- Files ---- */

static void wrong_usage_is_refused_before_anything_is_read(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(2, run("report"));
    assert_in("needs one recording, or two", err);
    assert_code(2, run("report a.rlog a.rlog a.rlog -o a.html --force"));
    assert_in("needs one recording, or two to compare; got 3", err);
    assert_code(2, run("report a.rlog"));
    assert_in("needs -o FILE.html", err);
    assert_code(2, run("report a.rlog -o a.rlog --force"));
    assert_in("ends with .html", err);
    assert_code(2, run("report a.rlog -o nowhere/a.html"));
    assert_in("nowhere", err);
    write_file("a.html", "mine", 4);
    assert_code(2, run("report a.rlog -o a.html"));
    assert_one_message("a.html");
    assert_int_equal(file_size("a.html"), 4);
    assert_code(0, run("report a.rlog -o a.html --force --quiet"));
    assert_string_equal(err, "");
    assert_true(file_size("a.html") > 1000);
    assert_int_equal(system("ls | grep -v -E '^(a|tiny)[.](html|json|rlog)$|^(out|err)[.]txt$' >left.txt || :"), 0);
    char left[256];
    read_file("left.txt", left, sizeof left);
    assert_null(strstr(left, "a.html")); /* no file under a temporary name */
}

static void an_interrupted_report_writes_nothing(void **state)
{
    (void)state;
    remove("long.html");
    assert_code(0, run("run bowling-ball-small --steps 200 --keyframes 1000 -o long.rlog --quiet --force"));
    const int code = interrupt_until("report long.rlog -o long.html --json --quiet --force", "\"outcome\": \"");
    assert_true(code == 4 || code == 0); /* a fast machine may be ready */
    if (code == 4) {
        assert_string_equal(value_of("outcome"), "\"interrupted\"");
        assert_int_equal(file_size("long.html"), -1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_page_has_the_states_of_the_recording),
        cmocka_unit_test(rounded_states_are_as_near_as_their_bits_allow),
        cmocka_unit_test(a_melting_world_has_its_own_quantities),
        cmocka_unit_test(details_are_those_of_inspect),
        cmocka_unit_test(the_limit_of_the_size_is_kept),
        cmocka_unit_test(states_are_denser_near_the_first_sign),
        cmocka_unit_test(equal_recordings_give_equal_pages),
        cmocka_unit_test(texts_of_a_recording_are_only_text),
        cmocka_unit_test(a_cut_recording_is_shown_up_to_its_last_whole_step),
        cmocka_unit_test(a_damaged_recording_is_refused),
        cmocka_unit_test(a_recording_that_is_not_reproduced_is_refused),
        cmocka_unit_test(the_divergence_is_the_distance_of_the_positions),
        cmocka_unit_test(equal_recordings_have_no_difference),
        cmocka_unit_test(a_step_that_failed_is_shown_up_to_the_stage_that_failed),
        cmocka_unit_test(particles_may_be_added_and_there_may_be_none),
        cmocka_unit_test(a_checkpoint_has_one_state),
        cmocka_unit_test(a_particle_far_away_leaves_the_others_their_bits),
        cmocka_unit_test(wrong_usage_is_refused_before_anything_is_read),
        cmocka_unit_test(an_interrupted_report_writes_nothing),
    };
    return cmocka_run_group_tests_name("cli_report", tests, set_up, tear_down);
}
