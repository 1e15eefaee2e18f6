/* `rheolog log` from outside, and what `info` says about the origin of a recording. */
#include "cli_support.h"

#include <sys/stat.h>

#include "forge.h"

static void log_tells_what_was_done(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("run --from ./a.rlog@3 --steps 4 --set 'gravity=[0, -300, 0]' --set fluid.linear_viscosity=1 "
                       "-o b.rlog --force --quiet"));
    assert_code(0, run("log b.rlog"));
    assert_string_equal(err, "");
    assert_in("b.rlog\nscene       ", out);
    assert_in(
        "\nmade by     rheolog run --from a.rlog@3 --set 'gravity=[0, -300, 0]' --set fluid.linear_viscosity=1\n",
        out);
    assert_in("\nbuild       rheolog 0.", out);
    assert_in("\nbegins      with step 3\n"
              "step 4      gravity was set to [0, -300, 0]; before, it was [0, -9.81, 0]\n"
              "step 4      fluid.linear_viscosity was set to 1; before, it was 4\n"
              "ends        complete, after step 7\n",
              out);
    assert_code(0, run("log a.rlog"));
    assert_in("\ngeometry    5 walls, 0 vibrators\n", out);
    assert_in("ball.radius = ", out);
    assert_in(" (default: 0)\n", out);
    assert_null(strstr(out, "fluid.support = "));
    assert_in("begins      with step 0\nends        complete, after step 8\n", out);
}

/* Materials have their names in commands, and are listed with what differs from the main one. */
static void log_and_info_name_materials(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    const char *scenes = getenv("SCENES");
    assert_code(0, run("run %s/materials.json --steps 3 -o m.rlog --force --quiet", scenes));
    assert_code(
        0, run("run --from m.rlog --steps 2 --set materials.soft.springs.stiffness=5 -o n.rlog --force --quiet"));
    assert_code(0, run("log n.rlog"));
    assert_in("materials.1.name = cornstarch (default: none)", out);
    assert_in("materials.1.springs.stiffness = 40 (default: -1)", out);
    assert_in("materials.2.springs.stiffness = 4 (default: -1)", out);
    assert_null(strstr(out, "materials.2.history"));
    assert_in("\nstep 4      materials.soft.springs.stiffness was set to 5; before, it was 4\n", out);
    assert_code(0, run("log n.rlog --json"));
    assert_in("\"materials.1.springs.stiffness\": 40", out);
    assert_in("\"materials.1.springs.stiffness\": -1", out); /* its default */
    assert_in("\"path\": \"materials.soft.springs.stiffness\", \"value\": 5, \"before\": 4", out);
    assert_code(0, run("info m.rlog"));
    assert_in("materials.1.name", out);
    assert_in("materials.2.history.onset", out);
    /* Regression: the longer names of materials moved the values of their lines. */
    int values = 0;
    for (const char *at = strstr(out, "\n\nmodel "), *line, *sign; at && (line = strchr(at, '\n')) != NULL;
         at = line + 1)
        if ((sign = strstr(at, " = ")) != NULL && sign < line && strncmp(at, "differs", 7) != 0 && *at > ' ') {
            assert_int_equal(sign - at, strlen("materials.1.springs.yield_ratio"));
            values++;
        }
    assert_true(values > 40);
    assert_code(0, run("info m.rlog --json"));
    assert_in("\"materials.1.name\": \"cornstarch\", \"materials.1.springs.stiffness\": 40", out);
    assert_code(0, run("inspect m.rlog --particle 150"));
    assert_in("\nmaterial        2, soft\n", out);
    assert_code(0, run("inspect m.rlog --particle 150 --json"));
    assert_in("\"material\": 2, \"material_name\": \"soft\"", out);
    assert_code(0, run("export m.rlog -o m_files --format csv,vtp --quiet"));
    size_t size;
    assert_in(",list_margin,material,speed,", read_bytes("m_files/m_000003.csv", &size));
    assert_in("Name=\"material\"", read_bytes("m_files/m_000003.vtp", &size));
    assert_code(
        0, run("run %s/materials.json --steps 3 --set materials.cornstarch.history.stiffness=901 -o o.rlog --force "
               "--quiet",
               scenes));
    assert_code(1, run("diff m.rlog o.rlog"));
    assert_in("materials.1.history.stiffness = 900 in the first, 901 in the second", out);
    assert_code(2, run("run %s/materials.json --set materials.corn.history.stiffness=1", scenes));
    assert_in("there is no material \"corn\"; the materials are: \"cornstarch\", \"soft\"", err);
    assert_code(2,
                run("run --from m.rlog --steps 2 --set materials.soft.history.order=0.4 -o n.rlog --force --quiet"));
    assert_in("a material has no such parameter of its own", err);
}

static void log_has_its_keys(void **state)
{
    (void)state;
    static const char *const keys[] = {
        "file",       "event",      "scene",    "model", "particles", "made_by",   "build",    "format", "real_bytes",
        "first_step", "parameters", "defaults", "walls", "vibrators", "blessings", "commands", "step",   "kind",
        "path",       "value",      "before",   "text",  "ending",    "last_step", NULL};
    record("a.rlog");
    assert_code(0, run("run --from a.rlog --steps 2 --set 'gravity=[0, -300, 0]' -o b.rlog --force --quiet"));
    assert_code(0, run("log b.rlog --json"));
    assert_keys(out, keys);
    int lines = 0;
    for (const char *c = out; *c; c++)
        lines += *c == '\n';
    assert_int_equal(lines, 3);
    assert_in(
        "\"event\": \"command\", \"step\": 9, \"kind\": \"set\", \"path\": \"gravity\", \"value\": [0, -300, 0], "
        "\"before\": [0, -9.81, 0], \"text\": \"gravity was set to [0, -300, 0]\"}",
        out);
    assert_in("\"event\": \"end\", \"ending\": \"complete\", \"last_step\": 10", out);
}

static void log_says_how_a_recording_ends(void **state)
{
    (void)state;
    record("a.rlog");
    size_t size;
    char *bytes = read_bytes("a.rlog", &size);
    write_file("cut.rlog", bytes, size - 5);
    assert_code(0, run("log cut.rlog"));
    assert_in(
        "ends        truncated after step 8: it has no end mark; the command that made it, with --continue, goes on from "
        "there\n",
        out);
    assert_code(0, run("log cut.rlog --json"));
    assert_in("\"ending\": \"truncated\"", out);
    record_melting("melting.rlog", "");
    assert_code(1, run("run --from melting.rlog --steps 2 --set melting.max_substeps=1 -o bad.rlog --force --quiet"));
    assert_code(0, run("log bad.rlog"));
    assert_in("ends        step ", out);
    assert_in(" went bad: ", out);
    assert_code(0, run("log bad.rlog --json"));
    assert_in("\"ending\": \"failed\"", out);
}

/* Folders, outputs and the SIMD variant are no part of what was done: the same run gives the same bytes. */
static void the_same_run_gives_the_same_bytes(void **state)
{
    (void)state;
    assert_true(mkdir("folder", 0700) == 0);
    write_file("folder/tiny.json", tiny, strlen(tiny));
    const char *here = json_scenes ? "./tiny.json" : scene, *there = json_scenes ? "folder/tiny.json" : scene;
    assert_code(0, run("run %s --steps 3 --set fluid.stiffness=6 -o a.rlog --force --quiet", here));
    assert_code(0, run("run %s --steps 3 --set fluid.stiffness=6 --simd scalar -o folder/c.rlog --json", there));
    assert_files_same("a.rlog", "folder/c.rlog");
    assert_code(0, run("log a.rlog"));
    assert_null(strstr(out, "/"));
    assert_in(" --set fluid.stiffness=6\n", out);
    /* The name of the built-in mesh is no path: nothing of it is taken away with the folder. */
    static const char bunny[] = "{\"fluid\": {\"shapes\": [{\"mesh\": {\"file\": \"bunny\", \"height\": 12}}]}}";
    for (int i = 0; i < 2 && json_scenes; i++) {
        const char *name = i ? "folder/bunny.json" : "./bunny.json";
        write_file(name, bunny, strlen(bunny));
        assert_code(0, run("run %s --steps 1 -o %s --force --quiet", name, i ? "folder/c.rlog" : "a.rlog"));
        remove(name);
    }
    assert_files_same("a.rlog", json_scenes ? "folder/c.rlog" : "a.rlog");
    remove("folder/tiny.json");
    remove("folder/c.rlog");
    remove("folder");
}

static void a_recording_can_be_turned_back_into_its_scene(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    assert_code(0, run("run %s --steps 3 --set fluid.stiffness=6 -o a.rlog --force --quiet", scene));
    assert_code(0, run("log a.rlog --scene"));
    write_file("again.json", out, strlen(out));
    assert_code(0, run("run again.json --steps 3 -o again.rlog --force --quiet"));
    assert_code(0, run("diff a.rlog again.rlog"));
    assert_in("same", out);
    assert_code(0, run("log again.rlog --scene"));
    char *text = read_bytes("again.json", &(size_t){0});
    assert_int_equal(strncmp(text, out, strlen(out)), 0);
    /* One that was continued has no scene of its own. */
    assert_code(0, run("run --from a.rlog --steps 1 -o b.rlog --force --quiet"));
    assert_code(2, run("log b.rlog --scene"));
    assert_one_message("b.rlog holds no scene");
}

static void info_tells_the_origin(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("run --from a.rlog@3 --steps 1 --set fluid.linear_viscosity=1 -o b.rlog --force --quiet"));
    assert_code(0, run("info b.rlog"));
    assert_in("\nbuild       rheolog 0.", out);
    assert_in("\nmade by     rheolog run --from a.rlog@3 --set fluid.linear_viscosity=1\n", out);
    assert_in("\ncommands    1: rheolog log lists them\n", out);
    assert_in(json_scenes ? "ball.radius = 2 (default: 0)\n" : "ball.radius = 8 (default: 0)\n", out);
    assert_code(0, run("info b.rlog --json"));
    assert_in("\"made_by\": \"rheolog run --from a.rlog@3 --set fluid.linear_viscosity=1\", \"commands\": 1, "
              "\"made_refused\": false, \"differing\": {",
              out);
    assert_code(0, run("info a.rlog"));
    assert_in("\ncommands    0\n", out);
}

static void diff_names_the_commands_that_differ(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("run --from a.rlog@3 --steps 2 --set fluid.linear_viscosity=1 -o b.rlog --force --quiet"));
    assert_code(0, run("run --from a.rlog@3 --steps 2 -o c.rlog --force --quiet"));
    assert_code(1, run("diff b.rlog c.rlog"));
    assert_in("  the commands given before step 4 differ:\n"
              "    in the first, fluid.linear_viscosity was set to 1\n"
              "    in the second, none was given\n",
              out);
    assert_code(1, run("diff c.rlog b.rlog --json"));
    assert_in("\"commands_step\": 4, \"commands_a\": [], "
              "\"commands_b\": [\"fluid.linear_viscosity was set to 1\"]",
              out);
}

/* ---- Recordings from anyone ---- */

/* Copies a recording with another text of how it was made. */
static void forge_made(const char *from, const char *to, const char *made_by)
{
    enum { ROOM = 1 << 20 };
    size_t size;
    const char *bytes = read_bytes(from, &size);
    uint8_t *other = malloc(ROOM);
    forged f;
    forge_open(&f, (const uint8_t *)bytes, size, ROOM);
    forged_chunk *made = forge_find(&f, RHEO__MADE, 0);
    assert_non_null(made);
    const size_t length = strlen(made_by);
    made->data = realloc(made->data, length + 8);
    made->size = length + 8;
    forge_put(made->data, length, 4);
    memcpy(made->data + 4, made_by, length);
    forge_put(made->data + 4 + length, 0, 4);
    size = forge_write(&f, true, other, ROOM);
    write_file(to, (const char *)other, size);
    forge_release(&f);
    free(other);
}

static void no_recording_commands_the_terminal(void **state)
{
    (void)state;
    static const char *const commands[] = {"log", "log --json", "info", "info --json", "doctor", "diff a.rlog"};
    record("a.rlog");
    forge_made("a.rlog", "b.rlog",
               "rheolog run \x1b]0;owned\a\x1b[2J\xc2\x9b"
               "31m");
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        assert_code(0, run("%s b.rlog", commands[i]));
        for (const char *c = out; *c; c++)
            assert_true(*c == '\n' || (unsigned char)*c >= 0x20);
        assert_null(strstr(out, "owned"));
    }
    assert_code(0, run("log b.rlog"));
    assert_in("made by     not shown: it is too long, not UTF-8 or has control characters\n", out);
    assert_code(0, run("info b.rlog --json"));
    assert_in("\"made_by\": null, \"commands\": 0, \"made_refused\": true", out);
    assert_code(2, run("log b.rlog --scene"));
    assert_one_message("the scene that b.rlog holds is not shown: ");
    assert_code(0, run("verify b.rlog"));
}

/* People give the lines of the doctor to a shell. */
static void cures_repeat_no_forged_command(void **state)
{
    (void)state;
    static const char begin[] = "rheolog run bowling-ball-small";
    static const char options[] = " --set settle.time=0 --set scheme=sequential --set 'gravity=[0, -9.8, 0]' "
                                  "--set fluid.stiffness=1500 --set particles=700 --keyframes 9 --full";
    static const char *const ends[] = {
        "; touch owned",        " $(touch owned)", " -o x.rlog", " --set 'a",        " --set",
        " --set `touch owned`", " | sh",           "\\ x",       " --set a --force", ";"};
    char made[512], line[600];
    run("run bowling-ball-small%s --steps 12 -o sick.rlog --force --quiet", options);
    assert_code(1, run("doctor sick.rlog"));
    snprintf(line, sizeof line, "\n    %s%s --steps ", begin, options);
    assert_in(line, out);
    /* Without a command that it trusts, the doctor makes the scene again from its text, which is not there. */
    for (size_t i = 0; i <= sizeof ends / sizeof *ends; i++) {
        const bool last = i == sizeof ends / sizeof *ends;
        snprintf(made, sizeof made, "%s%s%s", last ? "touch owned; " : "", begin, last ? options : ends[i]);
        forge_made("sick.rlog", "b.rlog", made);
        assert_code(1, run("doctor b.rlog"));
        assert_null(strstr(out, "\n    rheolog run"));
        assert_null(strstr(out, "owned"));
    }
    rename("sick.rlog", "it's $HOME.rlog");
    assert_code(1, run("doctor \"it's \\$HOME.rlog\""));
    assert_in(line, out);
    remove("it's $HOME.rlog");
    /* And the program itself stores what it can read back. */
    assert_code(0, run("run %s --steps 1 --set \"gravity=[0,\t-9, 0]\" -o a.rlog --force --quiet", scene));
    assert_code(0, run("log a.rlog"));
    assert_in(" --set 'gravity=[0,?-9, 0]'\n", out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(log_tells_what_was_done),
        cmocka_unit_test(log_and_info_name_materials),
        cmocka_unit_test(log_has_its_keys),
        cmocka_unit_test(log_says_how_a_recording_ends),
        cmocka_unit_test(the_same_run_gives_the_same_bytes),
        cmocka_unit_test(a_recording_can_be_turned_back_into_its_scene),
        cmocka_unit_test(info_tells_the_origin),
        cmocka_unit_test(diff_names_the_commands_that_differ),
        cmocka_unit_test(no_recording_commands_the_terminal),
        cmocka_unit_test(cures_repeat_no_forged_command),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
