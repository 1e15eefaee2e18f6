/*
 * The program from outside: exit codes, what it prints where, and the keys of --json. The program is named by
 * the environment variable RHEOLOG; everything happens in a folder of its own.
 */
#define _XOPEN_SOURCE 700 /* realpath() */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "rheolog/rheolog.h"

static char folder[] = "/tmp/rheolog-cli-XXXXXX";
static char program[4096];
static const char *scene; /* SCENE and what makes it small */
static bool json_scenes;

static char out[1 << 20], err[1 << 16]; /* of the last run */

static void read_file(const char *path, char *text, size_t size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    const size_t length = fread(text, 1, size - 1, file);
    text[length] = 0;
    fclose(file);
}

static void write_file(const char *path, const char *text, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static long file_size(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 ? (long)status.st_size : -1;
}

/* Runs `rheolog ARGUMENTS`; returns its exit code; fills out and err. */
static int run(const char *format, ...) __attribute__((format(printf, 1, 2)));

static int run(const char *format, ...)
{
    char arguments[4096], command[8192];
    va_list list;
    va_start(list, format);
    vsnprintf(arguments, sizeof arguments, format, list);
    va_end(list);
    /* A later redirection in the arguments wins over this one. */
    snprintf(command, sizeof command, "\"$RHEOLOG\" >out.txt 2>err.txt %s", arguments);
    const int status = system(command);
    read_file("out.txt", out, sizeof out);
    read_file("err.txt", err, sizeof err);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void assert_code(int expected, int code)
{
    if (expected != code)
        fail_msg("exit code %d instead of %d\nout: %s\nerr: %s", code, expected, out, err);
}

static void assert_in(const char *part, const char *text)
{
    if (!strstr(text, part))
        fail_msg("\"%s\" is missing in:\n%s", part, text);
}

/* One clear message: one line on standard error, nothing on standard output. */
static void assert_one_message(const char *part)
{
    assert_string_equal(out, "");
    assert_in(part, err);
    const char *end = strchr(err, '\n');
    assert_non_null(end);
    if (end[1] != 0)
        fail_msg("more than one line:\n%s", err);
}

static void assert_keys(const char *text, const char *const *keys)
{
    assert_int_equal(text[0], '{');
    for (; *keys; keys++) {
        char quoted[64];
        snprintf(quoted, sizeof quoted, "\"%s\": ", *keys);
        assert_in(quoted, text);
    }
    const char *end = strchr(text, '\n');
    assert_non_null(end);
    assert_int_equal(end[-1], '}');
}

/* The text of a key's value up to the next comma, for comparing. */
static const char *value_of(const char *key)
{
    static char values[8][64];
    static size_t next;
    char quoted[64], *value = values[next++ % 8];
    snprintf(quoted, sizeof quoted, "\"%s\": ", key);
    const char *found = strstr(out, quoted);
    if (!found)
        fail_msg("\"%s\" is missing in:\n%s", key, out);
    found += strlen(quoted);
    snprintf(value, 64, "%.*s", (int)strcspn(found, ",}\n"), found);
    return value;
}

/* ---- Set up ---- */

static const char tiny[] = "{\"scene\": \"tiny\",\n"
                           " \"steps\": 8,\n"
                           " \"history\": {\"window\": 6},\n"
                           " \"fluid\": {\"shapes\": [{\"block\": {\"min\": [0, 0, 0], \"max\": [10, 8, 10], "
                           "\"jitter\": 0.1}}]},\n"
                           " \"walls\": {\"boxes\": [{\"min\": [0, 0, 0], \"max\": [10, 9, 10], \"open\": "
                           "[\"top\"]}]},\n"
                           " \"ball\": {\"radius\": 2, \"position\": [5, 14, 5], \"velocity\": [0, -5, 0]}}\n";

static int set_up(void **state)
{
    (void)state;
    const char *name = getenv("RHEOLOG");
    if (!name || !realpath(name, program) || setenv("RHEOLOG", program, 1) != 0) {
        fprintf(stderr, "the environment variable RHEOLOG must name the program to test\n");
        return 1;
    }
    if (!mkdtemp(folder) || chdir(folder) != 0)
        return 1;
    write_file("tiny.json", tiny, sizeof tiny - 1);
    const int code = run("run tiny.json --steps 0 --quiet");
    json_scenes = !strstr(err, "without JSON");
    scene = json_scenes ? "tiny.json" : "bowling-ball-small --set settle.time=0 --set history.window=6";
    return json_scenes && code != 0;
}

static int tear_down(void **state)
{
    (void)state;
    char command[64];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return chdir("/") != 0 || system(command) != 0;
}

/* A recording of 8 steps under this name. */
static void record(const char *name)
{
    assert_code(0, run("run %s --steps 8 -o %s --force --quiet --json", scene, name));
}

/* ---- Usage ---- */

static const char *const commands[] = {"scenes",     "run",     "verify",  "diff",   "bless",  "info",
                                       "checkpoint", "metrics", "inspect", "doctor", "export", "bench"};

static void every_command_has_help(void **state)
{
    (void)state;
    assert_code(0, run("--help"));
    assert_string_equal(err, "");
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++)
        assert_in(commands[i], out);
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        char usage[64];
        snprintf(usage, sizeof usage, "usage: rheolog %s", commands[i]);
        assert_code(0, run("%s --help", commands[i]));
        assert_in(usage, out);
        assert_in("examples:", out);
        assert_in("exit codes:", out);
        for (const char *line = out; *line; line += strcspn(line, "\n") + 1)
            assert_true(strcspn(line, "\n") <= 112);
        assert_code(0, run("help %s", commands[i]));
        assert_in(usage, out);
    }
    assert_code(0, run("run --help"));
    assert_in("rheolog scenes --parameters", out);
    assert_code(0, run("--version"));
    assert_in("rheolog 0.", out);
}

static void bad_usage_is_told(void **state)
{
    (void)state;
    assert_code(2, run(" "));
    assert_in("usage: rheolog COMMAND", err);
    assert_string_equal(out, "");
    static const char *const cases[][2] = {
        {"verfy", "\"verify\""},
        {"help verfy", "\"verify\""},
        {"run --stpes 3", "--steps"},
        {"run --steps", "needs a value"},
        {"run --steps=1.5 bowling-ball", "whole number"},
        {"run --steps -1 bowling-ball", "whole number"},
        {"run --steps 99999999999999999999 bowling-ball", "whole number"},
        {"run --json=yes bowling-ball", "takes no value"},
        {"run", "needs a scene"},
        {"run bowling-ball vibration", "\"vibration\""},
        {"run bowling-bal", "\"bowling-ball\""},
        {"run no/such.json", "no/such.json"},
        {"run nosuch.json", "nosuch.json"},
        {"run . --steps 1", "folder"},
        {"run some.rlog", "--from some.rlog"},
        {"run bowling-ball --full", "-o"},
        {"run bowling-ball --write-scene -o x.rlog", "--write-scene"},
        {"run bowling-ball --set fluid.suport=3", "fluid.support"},
        {"run bowling-ball --set settle.tim=3", "settle.time"},
        {"run bowling-ball --set fluid.support", "KEY=VALUE"},
        {"run bowling-ball --set fluid.support=", "KEY=VALUE"},
        {"run bowling-ball --set fluid.support=-1", "fluid.support"},
        {"run bowling-ball --set settle.fraction=2", "settle.fraction"},
        {"run bowling-ball -o no/such/folder.rlog", "no/such"},
        {"run bowling-ball -o .", "folder"},
        {"run --from none.rlog", "none.rlog"},
        {"run bowling-ball --from none.rlog", "bowling-ball"},
        {"run --from none.rlog@x", "whole number"},
        {"verify", "no recordings"},
        {"verify --josn x", "--json"},
        {"info", "one recording"},
        {"info a b", "one recording"},
        {"info none.rlog", "none.rlog"},
        {"info .", "folder"},
        {"metrics", "one recording"},
        {"metrics none.rlog", "none.rlog"},
        {"doctor", "one recording"},
        {"doctor a b", "one recording"},
        {"doctor none.rlog", "none.rlog"},
        {"checkpoint none.rlog -o x.rlog", "--step"},
        {"checkpoint none.rlog --step 3", "-o"},
        {"checkpoint none.rlog --step 3 -o x.rlog", "none.rlog"},
        {"inspect", "one recording"},
        {"inspect a b", "one recording"},
        {"inspect none.rlog", "none.rlog"},
        {"inspect none.rlog --particle x", "whole number"},
        {"inspect none.rlog --particle 1 --particle 2", "one --particle at a time"},
        {"inspect none.rlog --spring 1:2 --spring 2:3", "one --spring at a time"},
        {"inspect none.rlog --spring 3", "two different ids"},
        {"inspect none.rlog --spring 3:3", "two different ids"},
        {"inspect none.rlog --spring :3", "two different ids"},
        {"inspect none.rlog --spring 3:4:5", "two different ids"},
        {"inspect none.rlog --step last", "whole number"},
        {"scenes x", "\"x\""},
        {"export", "one recording"},
        {"export a b", "one recording"},
        {"export none.rlog --format vtp", "-o DIR"},
        {"export none.rlog -o x", "--format"},
        {"export none.rlog -o x --format vtk", "\"vtp\""},
        {"export none.rlog -o x --format vtp --every 0", "--every"},
        {"export none.rlog -o x --format vtp --every 2 --step 3", "--step"},
        {"export none.rlog -o x --format vtp --isovalue .5", "vtp has particles"},
        {"export none.rlog -o x --format ply --isovalue 1", "--isovalue"},
        {"export none.rlog -o x --format ply --isovalue half", "--isovalue"},
        {"export none.rlog -o x --format ply --isovalue nan", "--isovalue"},
        {"export none.rlog -o x --format ply --resolution 9", "--resolution"},
        {"export none.rlog -o x --format ply", "none.rlog"},
        {"bench", "needs a measurement"},
        {"bench tables", "\"tables\""},
        {"bench table1 limits", "\"limits\""},
        {"bench table1 --csv --json", "not both"},
        {"bench table1 --steps 0", "--steps"},
        {"bench table1 --repetitions 0", "--repetitions"},
        {"bench table1 --repetitions 1001", "--repetitions"},
        {"bench table1 --particles 999", "--particles"},
        {"bench table1 --windows 1,,2", "\"1,,2\""},
        {"bench table1 --windows 1000001", "1000000"},
        {"bench table1 --windows ''", "--windows"},
        {"bench history --windows 1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17", "more than 16"},
        {"bench scaling --windows 1", "scaling takes no --windows"},
        {"bench limits --simd none", "'none'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const int code = run("%s", cases[i][0]);
        if (code != 2)
            fail_msg("exit code %d: %s", code, cases[i][0]);
        assert_one_message(cases[i][1]);
    }
    assert_int_equal(file_size("x.rlog"), -1);
}

static void what_is_no_recording_is_told(void **state)
{
    (void)state;
    write_file("empty", "", 0);
    record("a.rlog");
    static const char *const cases[] = {"verify",
                                        "diff a.rlog",
                                        "bless x.rlog --because it",
                                        "info",
                                        "metrics",
                                        "checkpoint --step 0 -o x.rlog",
                                        "inspect --top 3",
                                        "doctor",
                                        "run --from"};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_code(2, run("%s tiny.json", cases[i]));
        assert_code(2, run("%s empty", cases[i]));
        assert_int_equal(file_size("x.rlog"), -1);
    }
}

/* ---- scenes ---- */

static void scenes_are_listed(void **state)
{
    (void)state;
    assert_code(0, run("scenes"));
    assert_in("bowling-ball", out);
    assert_code(0, run("scenes --json"));
    static const char *const keys[] = {"name", "model", "particles", "about", NULL};
    for (const char *line = out; *line; line = strchr(line, '\n') + 1)
        assert_keys(line, keys);
    assert_code(0, run("scenes --parameters"));
    static const char *const words[] = {"fluid.support = 4",
                                        "springs.solver",
                                        "explicit implicit",
                                        "settle.time",
                                        "(live)",
                                        "step = 0.033, of melting 0.02",
                                        "melting.viscosity = 0.05",
                                        "(melting)"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        assert_in(words[i], out);
    assert_code(0, run("scenes --parameters --json"));
    static const char *const parameter_keys[] = {"path", "unit", "default", "models", "live", NULL};
    for (const char *line = out; *line; line = strchr(line, '\n') + 1)
        assert_keys(line, parameter_keys);
}

/* ---- run ---- */

static void run_has_its_keys(void **state)
{
    (void)state;
    static const char *const keys[] = {"scene",
                                       "model",
                                       "particles",
                                       "steps",
                                       "time",
                                       "hash",
                                       "ns_per_particle_step",
                                       "neighbours",
                                       "springs",
                                       "history_bytes",
                                       "stages",
                                       "name",
                                       "creation_seconds",
                                       NULL};
    assert_code(0, run("run %s --steps 3 --json", scene));
    assert_keys(out, keys);
    assert_string_equal(value_of("steps"), "3");
    assert_string_equal(value_of("model"), "\"thickening\"");
    assert_int_equal(strlen(value_of("hash")), 18);
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_code(0, run("run %s --steps=3 --quiet", scene));
    assert_string_equal(err, "");
    hash[17] = 0;
    assert_in(hash + 1, out);
    assert_in("viscosity", out);
    assert_code(0, run("run %s --steps 0 --json", scene));
    assert_string_equal(value_of("ns_per_particle_step"), "0.000");
}

static void an_empty_scene_runs(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    write_file("empty.json", "{}", 2);
    assert_code(0, run("run ./empty.json --steps 2 --json -o nothing.rlog"));
    assert_string_equal(value_of("scene"), "\"empty\"");
    assert_string_equal(value_of("particles"), "0");
    assert_string_equal(value_of("ns_per_particle_step"), "0.000");
    assert_string_equal(value_of("neighbours"), "0");
    assert_null(strstr(out, "nan"));
    assert_code(0, run("run empty.json --steps 2"));
    assert_null(strstr(out, "nan"));
    assert_code(0, run("verify nothing.rlog"));
    assert_code(0, run("info nothing.rlog"));
    assert_null(strstr(out, "nan"));
}

static void a_bad_scene_file_is_told(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    write_file("bad.json", "{\n\"fluid\": {\n\"suport\": 3}}", 26);
    assert_code(2, run("run bad.json"));
    assert_one_message("bad.json:3: fluid.suport: ");
    write_file("cut.json", tiny, 40);
    assert_code(2, run("run cut.json"));
    assert_one_message("cut.json:");
}

/* Found from the folder of the scene, wherever the program runs; what is wrong with it is bad input. */
static void a_mesh_is_found_beside_its_scene(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    static const char mesh_scene[] =
        "{\"fluid\": {\"shapes\": [{\"mesh\": {\"file\": \"box.obj\", \"height\": 8}}]}}";
    static const char box[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                              "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";
    mkdir("folder", 0777);
    write_file("folder/mesh.json", mesh_scene, sizeof mesh_scene - 1);
    remove("folder/box.obj");
    assert_code(2, run("run folder/mesh.json"));
    assert_one_message("folder/mesh.json: shape 0: cannot read the mesh folder/box.obj: ");
    write_file("folder/box.obj", box, sizeof box - 1);
    assert_code(0, run("run folder/mesh.json --steps 2 --json"));
    assert_string_equal(value_of("particles"), "64");
    assert_code(0, run("run folder/mesh.json --steps 2 --json --set particles=1000"));
    assert_string_equal(value_of("particles"), "1000");
    write_file("folder/box.obj", box, sizeof box - 1 - 10);
    assert_code(2, run("run folder/mesh.json"));
    assert_one_message("folder/box.obj: the mesh is not closed: 4 open edges around 1 hole");
    assert_code(2, run("run bowling-ball-small --set model=melting"));
    assert_one_message("model cannot be set");
    assert_code(2, run("run bowling-ball-small --set melting.viscosity=1"));
    assert_one_message("of the model melting");
}

static void written_scenes_run_the_same(void **state)
{
    (void)state;
    if (!json_scenes)
        skip();
    assert_code(0, run("run tiny.json --set fluid.stiffness=250 --set seed=5 --set ball.position=[4,15,5] "
                       "--steps 6 --write-scene >again.json"));
    char hash[32];
    assert_code(0, run("run again.json --json"));
    assert_string_equal(value_of("steps"), "6");
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_code(0, run("run tiny.json --set=fluid.stiffness=250 --set seed=5 --set ball.position=[4,15,5] --steps 6 "
                       "--json"));
    assert_string_equal(value_of("hash"), hash);
    assert_code(0, run("run tiny.json --steps 6 --json"));
    assert_string_not_equal(value_of("hash"), hash);
    /* Where a built-in scene would put the ball above the surface, a given position counts. */
    assert_code(0, run("run bowling-ball-small --set ball.position=[1,2,3] --write-scene"));
    assert_string_equal(value_of("clearance"), "-1");
    assert_code(0, run("run bowling-ball-small --write-scene"));
    assert_string_not_equal(value_of("clearance"), "-1");
}

static void recording_changes_nothing(void **state)
{
    (void)state;
    record("a.rlog");
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_string_equal(value_of("file"), "\"a.rlog\"");
    assert_code(0, run("run %s --steps 8 --json", scene));
    assert_string_equal(value_of("hash"), hash);
    assert_code(0, run("run %s --steps 8 --json --full --keyframes 3 -oc.rlog", scene));
    assert_string_equal(value_of("hash"), hash);
    assert_code(0, run("verify a.rlog c.rlog"));
    assert_in("a.rlog: same", out);
    assert_in("c.rlog: same", out);
}

static void files_are_not_replaced_without_force(void **state)
{
    (void)state;
    write_file("mine.rlog", "mine", 4);
    assert_code(2, run("run %s --steps 1 -o mine.rlog", scene));
    assert_one_message("--force");
    record("a.rlog");
    assert_code(2, run("checkpoint a.rlog --step 1 -o mine.rlog"));
    assert_one_message("--force");
    assert_int_equal(file_size("mine.rlog"), 4);
    assert_code(0, run("checkpoint a.rlog --step 1 -o mine.rlog --force"));
    assert_code(0, run("verify mine.rlog"));
    assert_code(0, run("run %s --steps 1 -o mine.rlog --force", scene));
    assert_code(0, run("verify mine.rlog"));
    /* A recording that is being read must not be written. */
    const long size = file_size("a.rlog");
    assert_code(2, run("run --from a.rlog@2 --steps 1 -o ./a.rlog --force"));
    assert_int_equal(file_size("a.rlog"), size);
}

static void runs_go_on_from_any_step(void **state)
{
    (void)state;
    record("a.rlog");
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_code(0, run("checkpoint a.rlog --step 3 -o c3.rlog --force"));
    assert_code(0, run("run --from c3.rlog --steps 5 --json"));
    assert_string_equal(value_of("hash"), hash);
    assert_string_equal(value_of("step"), "8");
    assert_string_equal(value_of("steps"), "5");
    assert_code(0, run("run --from a.rlog@6 --steps 2 --json -o rest.rlog --force"));
    assert_string_equal(value_of("hash"), hash);
    assert_code(0, run("verify rest.rlog"));
    assert_code(0, run("run --from a.rlog --steps 0 --json"));
    assert_string_equal(value_of("hash"), hash);
    assert_code(2, run("run --from a.rlog@9 --steps 1"));
    assert_one_message("0 to 8");
    assert_code(2, run("checkpoint a.rlog --step 9 -o c9.rlog"));
    assert_one_message("0 to 8");
}

static void changes_after_from_are_recorded(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("run --from a.rlog@4 --steps 4 --json"));
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_code(0, run("run --from a.rlog@4 --steps 4 --json --set gravity=[0,-20,0] -o changed.rlog --force"));
    assert_string_not_equal(value_of("hash"), hash);
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_code(0, run("verify changed.rlog"));
    assert_code(0, run("run --from changed.rlog --steps 0 --json"));
    assert_string_equal(value_of("hash"), hash);
    /* What cannot be changed is told before a file is made. */
    static const char *const cases[] = {"ball.radius=3", "settle.time=1", "fluid.suport=3", "gravity=down",
                                        "gravity"};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_code(2, run("run --from a.rlog@4 --steps 4 --set %s -o never.rlog", cases[i]));
        assert_one_message("");
        assert_int_equal(file_size("never.rlog"), -1);
    }
}

static void a_run_gone_bad_leaves_a_good_recording(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("info a.rlog --json"));
    if (strcmp(value_of("real_bytes"), "4") != 0)
        skip(); /* no parameters are large enough to make doubles overflow */
    assert_code(
        1,
        run("run %s --steps 50 --set step=1e5 --set fluid.stiffness=1e29 -o bad.rlog --force --json --quiet", scene));
    assert_in("rheolog: ", err);
    assert_string_equal(value_of("outcome"), "\"failed\"");
    assert_code(0, run("verify bad.rlog"));
    assert_code(0, run("info bad.rlog --json"));
    assert_string_equal(value_of("complete"), "true");
}

static void an_interrupted_run_leaves_a_good_recording(void **state)
{
    (void)state;
    char command[4096];
    snprintf(command, sizeof command,
             "exec \"$RHEOLOG\" run %s --steps 100000000 -o long.rlog --quiet --json >out.txt 2>err.txt", scene);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(127);
    }
    /* It records steps as soon as the file has more than its first state: signals are caught by then. */
    const struct timespec pause = {0, 20000000};
    for (int i = 0; i < 1500 && file_size("long.rlog") <= 0; i++)
        nanosleep(&pause, NULL);
    for (int i = 0; i < 10; i++)
        nanosleep(&pause, NULL);
    kill(child, SIGINT);
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 1);
    read_file("out.txt", out, sizeof out);
    read_file("err.txt", err, sizeof err);
    assert_string_equal(value_of("outcome"), "\"interrupted\"");
    assert_in("interrupted after", err);
    assert_code(0, run("info long.rlog --json"));
    assert_string_equal(value_of("complete"), "true");
}

/* A limit on the size of files stands in for a disk that fills up. */
static void a_full_disk_leaves_a_readable_recording(void **state)
{
    (void)state;
    char command[4096];
    long before = 0;
    assert_code(0, run("run %s --steps 2 --full -o whole.rlog --force --quiet", scene));
    for (int more = 1; more <= 5; more++) { /* within the first keyframe, and at several places behind it */
        snprintf(command, sizeof command,
                 "trap '' XFSZ; ulimit -f %ld; exec \"$RHEOLOG\" run %s --steps 1000 --full -o full.rlog --force "
                 "--quiet >out.txt 2>err.txt",
                 file_size("whole.rlog") / 512 * more / 3 + 1, scene);
        const int status = system(command);
        read_file("out.txt", out, sizeof out);
        read_file("err.txt", err, sizeof err);
        assert_true(WIFEXITED(status));
        assert_code(3, WEXITSTATUS(status));
        assert_in("cannot write", err);
        assert_code(2, run("verify full.rlog --json"));
        assert_string_equal(value_of("verdict"), "\"unreadable\"");
        const long steps = strtol(value_of("steps"), NULL, 10);
        assert_true(steps >= before && (more < 5 || steps >= 2));
        before = steps;
        assert_code(2, run("verify full.rlog"));
        assert_in("truncated", out);
        if (steps >= 2) /* what is there can be gone on from */
            assert_code(0, run("run --from full.rlog@%ld --steps 1 --quiet", steps));
    }
    if (access("/dev/full", W_OK) != 0)
        return;
    assert_code(3, run("run %s --steps 2 -o /dev/full --force --quiet", scene));
    assert_in("cannot write", err);
}

/* ---- export ---- */

static void assert_files_same(const char *a, const char *b)
{
    static char first[1 << 20], second[1 << 20];
    assert_int_equal(file_size(a), file_size(b));
    read_file(a, first, sizeof first);
    read_file(b, second, sizeof second);
    assert_memory_equal(first, second, sizeof first < (size_t)file_size(a) ? sizeof first : (size_t)file_size(a));
}

static void export_has_its_keys(void **state)
{
    (void)state;
    static const char *const keys[] = {"file",      "folder",     "format",          "files",
                                       "steps",     "first_step", "last_step",       "vertices",
                                       "triangles", "left_out",   "without_surface", NULL};
    record("a.rlog");
    assert_code(0, run("export a.rlog -o made --format ply --json --quiet"));
    assert_keys(out, keys);
    assert_string_equal(value_of("files"), "1");
    assert_string_equal(value_of("first_step"), "8");
    assert_true(strtol(value_of("triangles"), NULL, 10) > 100);
    assert_string_equal(value_of("without_surface"), "0");
    assert_true(file_size("made/a_000008.ply") > 1000);
    assert_code(0, run("export a.rlog -o made --format vtp --every 3 --json"));
    assert_string_equal(value_of("files"), "4");
    assert_string_equal(value_of("steps"), "3");
    assert_string_equal(value_of("last_step"), "6");
    assert_true(file_size("made/a_000000.vtp") > 1000 && file_size("made/a_000003.vtp") > 1000);
    read_file("made/a.pvd", out, sizeof out);
    assert_in("timestep=\"0.099\" part=\"0\" file=\"a_000003.vtp\"", out);
    assert_code(0, run("export a.rlog -o made/ --format csv --from 2 --to 4"));
    assert_in("a_000002.csv\n", out);
    assert_in("a_000004.csv\n", out);
    assert_int_equal(file_size("made/a_000005.csv"), -1);
    assert_code(0, run("export a.rlog -o made --format obj --step 5"));
    assert_string_equal(out, "made/a_000005.obj\n");
    assert_code(0, run("export a.rlog -o made --format pov --isovalue 0.4 --resolution 1"));
    /* Where nothing is dense enough it says so. */
    assert_code(0, run("export a.rlog -o made --format obj --isovalue 0.99999 --resolution .5 --step 1 --json"));
    if (strcmp(value_of("triangles"), "0") == 0)
        assert_in("no surface", err);
}

static void exports_are_the_same_whenever_made(void **state)
{
    (void)state;
    record("a.rlog");
    static const char *const formats[] = {"vtp", "ply", "obj", "csv", "pov"};
    for (int f = 0; f < 5; f++) {
        char one[32], other[32];
        assert_code(0, run("export a.rlog -o one --format %s --every 4 --force", formats[f]));
        assert_code(0, run("export a.rlog -o other --format %s --from %d --to 8 --every 4 --force --simd scalar",
                           formats[f], f == 4 ? 0 : 4)); /* cameras hold what all steps show */
        snprintf(one, sizeof one, "one/a_000004.%s", formats[f]);
        snprintf(other, sizeof other, "other/a_000004.%s", formats[f]);
        assert_files_same(one, other);
    }
}

static void export_refuses_and_tells(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("export a.rlog -o kept --format vtp --step 3 --quiet"));
    assert_code(2, run("export a.rlog -o kept --format vtp --every 1"));
    assert_one_message("a_000003.vtp exists; give --force");
    assert_int_equal(file_size("kept/a_000000.vtp"), -1); /* looked at before anything is written */
    assert_int_equal(remove("kept/a_000003.vtp"), 0);
    assert_code(2, run("export a.rlog -o kept --format vtp --step 3"));
    assert_one_message("a.pvd exists; give --force");
    assert_code(0, run("export a.rlog -o kept --format vtp --step 3 --force"));
    assert_code(2, run("export a.rlog -o kept --format csv --step 9"));
    assert_one_message("steps 0 to 8; --step 9");
    assert_code(2, run("export a.rlog -o kept --format csv --from 9"));
    assert_one_message("--from 9");
    assert_code(2, run("export a.rlog -o kept --format csv --from 5 --to 4"));
    assert_one_message("--from 5");
    assert_code(2, run("export a.rlog -o no/such --format csv"));
    assert_one_message("cannot make the folder no/such");
    assert_code(2, run("export a.rlog -o a.rlog --format csv"));
    assert_one_message("no folder");
    /* A disk that is full leaves no file behind, not even one half written. */
    const int status =
        system("trap '' XFSZ; ulimit -f 4; exec \"$RHEOLOG\" export a.rlog -o full --format csv --quiet "
               ">/dev/null 2>err.txt");
    read_file("err.txt", err, sizeof err);
    assert_true(WIFEXITED(status));
    assert_code(3, WEXITSTATUS(status));
    assert_in("cannot write", err);
    assert_int_equal(rmdir("full"), 0);
}

/* ---- verify, info, metrics ---- */

static void verify_has_its_keys(void **state)
{
    (void)state;
    record("a.rlog");
    static const char *const keys[] = {"file", "hash", "verdict", "steps", "first", NULL};
    assert_code(0, run("verify a.rlog --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"same\"");
    assert_string_equal(value_of("steps"), "8");
    assert_string_equal(value_of("first"), "null");
    assert_code(2, run("verify --json none.rlog a.rlog"));
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"unreadable\"");
    assert_in("\"verdict\": \"same\"", out); /* the others are verified all the same */
}

static void torn_and_damaged_files_are_unreadable(void **state)
{
    (void)state;
    record("a.rlog");
    static char bytes[1 << 22];
    const size_t size = (size_t)file_size("a.rlog");
    assert_true(size < sizeof bytes);
    FILE *file = fopen("a.rlog", "rb");
    assert_non_null(file);
    assert_int_equal(fread(bytes, 1, size, file), size);
    fclose(file);
    write_file("truncated.rlog", bytes, size - 5);
    assert_code(2, run("verify truncated.rlog a.rlog"));
    assert_in("truncated.rlog: unreadable", out);
    assert_in("a.rlog: same", out);
    assert_code(2, run("metrics truncated.rlog"));
    assert_in("step,time,", out);
    assert_in("truncated", err);
    assert_code(0, run("info truncated.rlog --json"));
    assert_string_equal(value_of("complete"), "false");
    for (size_t i = 1; i < 8; i++) {
        const size_t at = size * i / 8;
        bytes[at] ^= 0x10;
        write_file("damaged.rlog", bytes, size);
        assert_code(2, run("verify damaged.rlog"));
        bytes[at] ^= 0x10;
        write_file("cut.rlog", bytes, at);
        assert_code(2, run("verify cut.rlog"));
    }
}

static uint32_t crc32_of(const unsigned char *bytes, size_t size)
{
    uint32_t crc = 0xffffffff;
    for (size_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
    }
    return ~crc;
}

/*
 * A recording whose STEP chunk says another hash, with the right CRC: what a change of the code looks like
 * from outside. A chunk is a header of 32 bytes (type, flags, step, length of the payload), payload, CRC-32.
 */
static void falsify_step(const char *from, const char *to, unsigned step)
{
    static unsigned char bytes[1 << 22];
    FILE *file = fopen(from, "rb");
    assert_non_null(file);
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    bool found = false;
    for (size_t at = 8; at + 36 < size && !found;) {
        const size_t stored = bytes[at + 16] | (size_t)bytes[at + 17] << 8 | (size_t)bytes[at + 18] << 16;
        found = memcmp(bytes + at, "STEP", 4) == 0 && bytes[at + 8] == step;
        if (found) {
            bytes[at + 32 + 24] ^= 1;
            const uint32_t crc = crc32_of(bytes + at, 32 + stored);
            for (size_t i = 0; i < 4; i++)
                bytes[at + 32 + stored + i] = (unsigned char)(crc >> 8 * i);
        }
        at += 36 + stored;
    }
    assert_true(found);
    write_file(to, (const char *)bytes, size);
}

/* The state that this build comes to, as `run` says it. */
static void verify_says_the_hash_of_the_last_step(void **state)
{
    (void)state;
    char last[32], fifth[32];
    assert_code(0, run("run %s --steps 5 --quiet --json", scene));
    snprintf(fifth, sizeof fifth, "%s", value_of("hash"));
    record("a.rlog");
    snprintf(last, sizeof last, "%s", value_of("hash"));
    assert_int_equal(strlen(last), 18);
    assert_string_not_equal(fifth, last);
    assert_code(0, run("verify a.rlog --json"));
    assert_string_equal(value_of("hash"), last);
    falsify_step("a.rlog", "other.rlog", 5);
    assert_code(1, run("verify other.rlog --json"));
    assert_string_equal(value_of("hash"), fifth);
    assert_code(2, run("verify none.rlog --json"));
    assert_string_equal(value_of("hash"), "null");
}

static void a_difference_is_named(void **state)
{
    (void)state;
    record("a.rlog");
    falsify_step("a.rlog", "other.rlog", 5);
    assert_code(1, run("verify a.rlog other.rlog"));
    assert_in("a.rlog: same", out);
    assert_in("other.rlog: differs", out);
    assert_in("next:", out);
    assert_in("--step 4", out);
    assert_code(1, run("verify --json other.rlog"));
    static const char *const keys[] = {"first",     "step",     "stage",  "field", "id",    "other_id",
                                       "component", "expected", "actual", "ulps",  "count", NULL};
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"differs\"");
    assert_string_equal(value_of("step"), "5");
    assert_string_equal(value_of("steps"), "4");
    assert_string_equal(value_of("ulps"), "null"); /* the recording holds hashes only */
    assert_code(2, run("verify other.rlog none.rlog"));
    assert_code(0, run("checkpoint other.rlog --step 4 -o before.rlog --force"));
    assert_code(1, run("checkpoint other.rlog --step 6 -o never.rlog"));
    assert_int_equal(file_size("never.rlog"), -1);
    assert_code(1, run("run --from other.rlog --steps 1"));
}

static void diff_has_its_keys(void **state)
{
    (void)state;
    record("a.rlog");
    static const char *const keys[] = {
        "a", "b", "verdict", "steps", "first", "growth", "message", "commands_step", "cause", "parameters", NULL};
    assert_code(0, run("diff a.rlog a.rlog --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"same\"");
    assert_string_equal(value_of("steps"), "8");
    assert_string_equal(value_of("first"), "null");
    assert_code(0, run("run --from a.rlog@0 --steps 8 -o b.rlog --force --set fluid.near_stiffness=501"));
    assert_code(1, run("diff a.rlog b.rlog --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("verdict"), "\"differs\"");
    assert_string_equal(value_of("step"), "1");
    assert_string_equal(value_of("stage"), "\"density\"");
    assert_string_equal(value_of("field"), "\"position\"");
    assert_string_equal(value_of("origin"), "\"simulated\"");
    assert_string_equal(value_of("commands_step"), "1");
    assert_code(1, run("diff a.rlog b.rlog"));
    assert_in("differs at step 1: position after stage density", out);
    assert_in("in the first", out);
    assert_in("how it grows", out);
    assert_in("the commands given before step 1 differ", out);
    assert_in("next: `rheolog inspect a.rlog --step 1 --stage density`", out);
    assert_code(2, run("diff a.rlog none.rlog"));
    assert_in("unreadable", out);
    assert_code(2, run("diff a.rlog"));
    assert_in("needs two recordings", err);
}

static void bless_is_the_way_of_golden_recordings(void **state)
{
    (void)state;
    record("a.rlog");
    remove("golden.rlog");
    assert_code(2, run("bless golden.rlog a.rlog"));
    assert_in("--because", err);
    assert_code(2, run("bless golden.rlog none.rlog --because why"));
    assert_int_equal(file_size("golden.rlog"), -1);
    assert_code(0, run("bless golden.rlog a.rlog --because \"the first\""));
    assert_in("there is no 'golden.rlog' yet", out);
    assert_code(0, run("verify golden.rlog"));
    assert_code(0, run("info golden.rlog --json"));
    assert_string_equal(value_of("because"), "\"the first\"");
    assert_code(0, run("bless golden.rlog a.rlog --because again"));
    assert_in("nothing to bless", out);
    const long long size = (long long)file_size("golden.rlog");
    assert_code(2, run("run --from a.rlog --steps 1 -o golden.rlog --force"));
    assert_in("blessed", err);
    assert_code(2, run("checkpoint a.rlog --step 1 -o golden.rlog --force"));
    assert_int_equal(file_size("golden.rlog"), size);
    assert_code(0, run("run --from a.rlog@0 --steps 8 -o b.rlog --force --set fluid.near_stiffness=501"));
    assert_code(0, run("bless golden.rlog b.rlog --because \"stiffer\""));
    assert_in("differs at step 1: position after stage density", out);
    assert_in("its reasons so far: 2", out);
    assert_code(0, run("info golden.rlog"));
    assert_in("the first", out);
    assert_in("stiffer", out);
    falsify_step("a.rlog", "other.rlog", 5);
    assert_code(1, run("bless golden.rlog other.rlog --because wrong"));
    assert_in("does not verify", err);
    assert_code(0, run("diff golden.rlog b.rlog"));
}

static void info_has_its_keys(void **state)
{
    (void)state;
    record("a.rlog");
    static const char *const keys[] = {"scene",   "steps",      "particles",
                                       "format",  "keyframes",  "bytes",
                                       "build",   "real_bytes", "keyframe_spacing",
                                       "complete",   "parameters", "fluid.support",
                                       "gravity", "kappa",      NULL};
    assert_code(0, run("info a.rlog --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("steps"), "8");
    assert_string_equal(value_of("fluid.support"), "4");
    char size[32];
    snprintf(size, sizeof size, "%ld", file_size("a.rlog"));
    assert_string_equal(value_of("bytes"), size);
    assert_string_equal(value_of("failure"), "null");
    assert_string_equal(value_of("blessings"), "[]");
    /* The spacing that is chosen makes keyframes cost about 3 % of a run. */
    const double share = strtod(value_of("keyframe_share"), NULL);
    assert_true(share > .015 && share < .035);
    assert_code(0, run("info a.rlog"));
    assert_in("of the run's time", out);
    assert_in("history.window", out);
    assert_in("kappa", out);
}

static void metrics_are_csv(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("metrics a.rlog"));
    assert_string_equal(err, "");
    assert_memory_equal(out, "step,time,", 10);
    size_t columns = 1, rows = 0;
    for (const char *c = out; *c != '\n'; c++)
        columns += *c == ',';
    char last[64] = "";
    for (const char *line = strchr(out, '\n') + 1; *line; line += strcspn(line, "\n") + 1) {
        size_t here = 1;
        for (const char *c = line; *c != '\n'; c++)
            here += *c == ',';
        assert_int_equal(here, columns);
        snprintf(last, sizeof last, "%.*s", (int)strcspn(line, ","), line);
        rows++;
    }
    assert_string_equal(last, "8");
    assert_int_equal(rows, 9); /* the first state and 8 steps */
}

/* ---- inspect ---- */

static void inspect_has_its_keys(void **state)
{
    (void)state;
    record("a.rlog");
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    static const char *const keys[] = {"file",    "scene",    "step",      "stage", "time",    "hash",   "springs",
                                       "failure", "bodies",   "particles", "spin",  "metrics", "energy", "densest",
                                       "fastest", "stiffest", "density",   "kappa", "speed",   "mass",   NULL};
    assert_code(0, run("inspect a.rlog --json"));
    assert_string_equal(err, "");
    assert_keys(out, keys);
    assert_string_equal(value_of("step"), "8"); /* the last one */
    assert_string_equal(value_of("stage"), "null");
    assert_string_equal(value_of("failure"), "null");
    assert_string_equal(value_of("time"), "0.264");
    assert_string_equal(value_of("hash"), hash);
    assert_null(strstr(out, "\"particle\""));
    assert_null(strstr(out, "\"spring\""));
    size_t entries = 0;
    for (const char *c = strstr(out, "densest"); (c = strstr(c, "\"id\"")) != NULL; c++)
        entries++;
    assert_int_equal(entries, 15);
    assert_string_equal(value_of("speed"), value_of("max_speed")); /* of the fastest, which stands first */
    assert_code(
        0, run("inspect a.rlog --json --top 18446744073709551615")); /* all of them, however many are asked for */
    entries = 0;
    for (const char *c = out, *end = strstr(out, "\"fastest\""); (c = strstr(c, "\"density\"")) != NULL && c < end;
         c++)
        entries++;
    assert_int_equal(entries, atoi(value_of("particles")));
    assert_code(0, run("inspect a.rlog --json --top 2 --particle 4"));
    static const char *const particle[] = {"particle",    "position",      "velocity",   "speed",     "near_density",
                                           "pressure",    "near_pressure", "derivative", "distance",  "partner",
                                           "rest_length", "length",        "stretch",    "stiffness", "history",
                                           "lag",         "weight",        NULL};
    assert_keys(out, particle);
    entries = 0;
    for (const char *c = strstr(out, "densest"); (c = strstr(c, "\"density\"")) != NULL; c++)
        entries++;
    assert_int_equal(entries, 3); /* two in the list, one of the particle */
    assert_code(0, run("inspect a.rlog --json --particle 4"));
    assert_null(strstr(out, "densest"));

    /* The state at a step is that of a checkpoint there. */
    assert_code(0, run("inspect a.rlog --json --step 3"));
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    assert_string_equal(value_of("step"), "3");
    assert_code(0, run("checkpoint a.rlog --step 3 -o c3.rlog --force"));
    hash[17] = 0;
    assert_in(hash + 1, out);
    assert_code(0, run("inspect c3.rlog --json"));
    assert_in(hash + 1, value_of("hash"));
    assert_string_equal(value_of("step"), "3");

    assert_code(0, run("inspect a.rlog --step 3"));
    static const char *const words[] = {"after stage", "stiffest", "metrics of step 3", "max_speed", "ball", NULL};
    assert_in(hash + 1, out);
    assert_null(strstr(out, words[0]));
    for (size_t i = 1; words[i]; i++)
        assert_in(words[i], out);
    assert_null(strstr(out, " \n"));
    assert_code(0, run("inspect a.rlog --step 3 --particle 4"));
    assert_in("neighbours:", out);
    assert_null(strstr(out, "stiffest"));
}

static void inspect_looks_between_stages(void **state)
{
    (void)state;
    record("a.rlog");
    char before[32], after[32];
    assert_code(0, run("inspect a.rlog --json --step 4"));
    snprintf(before, sizeof before, "%s", value_of("hash"));
    assert_code(0, run("inspect a.rlog --json --step 5"));
    snprintf(after, sizeof after, "%s", value_of("hash"));
    assert_code(0, run("inspect a.rlog --json --step 5 --stage density --particle 7"));
    assert_string_equal(value_of("step"), "5");
    assert_string_equal(value_of("stage"), "\"density\"");
    assert_string_equal(value_of("time"), "0.132");
    assert_string_not_equal(value_of("hash"), before);
    assert_string_not_equal(value_of("hash"), after);
    assert_in("\"metrics\": {\"step\": 4, ", out);
    assert_in("\"lag\": 0, \"step\": 4, ", out);
    assert_code(0, run("inspect a.rlog --json --step 5 --stage history"));
    assert_string_equal(value_of("hash"), after); /* the last stage is the end of the step */
    assert_string_equal(value_of("stage"), "null");
    assert_code(0, run("inspect a.rlog --step 5 --stage density"));
    assert_in("5, after stage density, ", out);

    static const char *const cases[][2] = {
        {"--step 5 --stage densty", "did you mean \"density\"? Its stages: gravity, neighbours_start, viscosity, "},
        {"--step 0 --stage density", "steps 1 to 8; --step 0"},
        {"--step 9 --stage density", "steps 1 to 8; --step 9"},
        {"--step 9", "steps 0 to 8; --step 9"},
        {"--particle 4294967296", "no particle 4294967296 at step 8; ids go from 0 to "},
        {"--particle 99999999", "no particle 99999999"},
        {"--spring 1:99999999", "no particle 99999999"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_code(2, run("inspect a.rlog %s", cases[i][0]));
        assert_one_message(cases[i][1]);
    }
    assert_code(0, run("checkpoint a.rlog --step 3 -o c3.rlog --force"));
    assert_code(2, run("inspect c3.rlog --stage density"));
    assert_one_message("no steps");
}

/* The library's view of the state at a step, through a checkpoint that the program has written. */
static rheo_world *checkpoint_at(const char *from, int step)
{
    rheo_recording *recording;
    rheo_world *world;
    assert_code(0, run("checkpoint %s --step %d -o at.rlog --force", from, step));
    assert_int_equal(rheo_recording_open("at.rlog", &recording, NULL), RHEO_OK);
    assert_int_equal(rheo_recording_world(recording, (uint64_t)step, NULL, &world, NULL), RHEO_OK);
    rheo_recording_close(recording);
    return world;
}

/* The number at *at, which moves on behind it. */
static double number_at(const char **at)
{
    const double value = strtod(*at, NULL);
    *at += strspn(*at, "+-.0123456789e");
    return value;
}

/* The next number, or the first of a list, after "key":. */
static double number_after(const char **at, const char *key)
{
    char quoted[64];
    snprintf(quoted, sizeof quoted, "\"%s\": ", key);
    const char *found = strstr(*at, quoted);
    if (!found)
        fail_msg("\"%s\" is missing in:\n%s", key, *at);
    *at = found + strlen(quoted);
    *at += **at == '[';
    return number_at(at);
}

static void assert_vector(const char **at, const char *key, const double value[3])
{
    assert_true(number_after(at, key) == value[0]);
    for (int axis = 1; axis < 3; axis++) {
        *at += 2; /* a comma and a blank */
        assert_true(number_at(at) == value[axis]);
    }
}

static void assert_row(const char **at, const char *key, const rheo_real *row)
{
    assert_vector(at, key, (const double[]){(double)row[0], (double)row[1], (double)row[2]});
}

/* ---- Worlds that melt ---- */

/* A small box of them, which is recorded with these options too. */
static void record_melting(const char *name, const char *options)
{
    assert_code(0, run("run melting-box --set fluid.spacing=0.12 --steps 4 -o %s --json --force %s", name, options));
}

static void melting_runs_are_shown(void **state)
{
    (void)state;
    static const char *const keys[] = {"scene",
                                       "model",
                                       "outcome",
                                       "particles",
                                       "steps",
                                       "step",
                                       "time",
                                       "hash",
                                       "ns_per_particle_step",
                                       "neighbours",
                                       "springs",
                                       "history_bytes",
                                       "creation_seconds",
                                       "loop_seconds",
                                       "simd",
                                       "file",
                                       "stages",
                                       "substeps",
                                       "iterations",
                                       "ns_per_particle_substep",
                                       NULL};
    record_melting("m.rlog", "");
    assert_keys(out, keys);
    assert_string_equal(value_of("model"), "\"melting\"");
    char hash[32];
    snprintf(hash, sizeof hash, "%s", value_of("hash"));
    const double substeps = atof(value_of("substeps")), iterations = atof(value_of("iterations"));
    assert_true(substeps >= 8 && iterations >= substeps);
    assert_true(atof(value_of("ns_per_particle_substep")) < atof(value_of("ns_per_particle_step")));

    assert_code(0, run("run melting-box --set fluid.spacing=0.12 --steps 4"));
    assert_in("substeps    ", out);
    assert_in("iterations of the solver in each", out);
    assert_null(strstr(out, "springs"));
    assert_null(strstr(out, "history"));

    assert_code(0, run("metrics m.rlog"));
    static const char *const columns[] = {"heat",       "hot_height",        "cold_height",
                                          "hot_spread", "cold_displacement", "max_density_error",
                                          "substeps",   "iterations"};
    assert_memory_equal(out, "step,time,", 10);
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++) {
        char column[32];
        snprintf(column, sizeof column, ",%s", columns[i]);
        assert_in(column, out);
    }
    /* What metrics say adds up to what run says. */
    double sum = 0;
    size_t column = 0;
    for (const char *c = out; strncmp(c, "substeps", 8) != 0; c++)
        column += *c == ',';
    for (const char *line = strchr(out, '\n') + 1; *line; line += strcspn(line, "\n") + 1) {
        const char *at = line;
        for (size_t n = 0; n < column; n++)
            at += strcspn(at, ",") + 1;
        sum += atof(at);
    }
    assert_true(sum == substeps);

    assert_code(0, run("info m.rlog"));
    assert_in("melting.viscosity", out);
    assert_in("yield", out);
    assert_code(0, run("doctor m.rlog"));
    assert_in("healthy", out);
    assert_code(0, run("verify m.rlog --json"));
    assert_string_equal(value_of("verdict"), "\"same\"");
    assert_string_equal(value_of("hash"), hash);
}

static void melting_states_are_inspected(void **state)
{
    (void)state;
    record_melting("m.rlog", "");
    assert_code(0, run("inspect m.rlog --json --particle 7 --top 2"));
    static const char *const keys[] = {
        "file",        "scene",    "model",      "hash",      "metrics",        "densest",
        "fastest",     "hottest",  "furthest",   "particle",  "summed_density", "pressure",
        "temperature", "jump_number",     "shear_rate", "viscosity", "start_position", "displacement",
        "neighbours",  "distance", "weight",     NULL};
    assert_keys(out, keys);
    static const char *const absent[] = {"stiffest", "near_density", "derivative", "history\"", "modes", "kappa"};
    for (size_t i = 0; i < sizeof absent / sizeof absent[0]; i++)
        assert_null(strstr(out, absent[i]));
    char before[32], after[32], middle[32];
    snprintf(after, sizeof after, "%s", value_of("hash"));
    assert_code(0, run("inspect m.rlog --json --step 3"));
    snprintf(before, sizeof before, "%s", value_of("hash"));
    assert_code(0, run("inspect m.rlog --json --step 4 --stage momentum@2"));
    assert_string_equal(value_of("stage"), "\"momentum@2\"");
    snprintf(middle, sizeof middle, "%s", value_of("hash"));
    assert_string_not_equal(middle, before);
    assert_string_not_equal(middle, after);
    assert_code(0, run("inspect m.rlog --json --step 4 --stage momentum"));
    assert_string_equal(value_of("stage"), "\"momentum@1\"");
    assert_string_not_equal(value_of("hash"), middle);
    assert_code(0, run("inspect m.rlog --step 4 --stage momentum@2 --particle 7"));
    static const char *const words[] = {
        "after stage momentum@2, ", "jump number", "shear rate", "apparent", "temperature", "began at",
        "metrics of step 3",        "iterations",  "W, 1/L^3"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        assert_in(words[i], out);
    static const char *const not_there[] = {"springs", "history", "derivative", "stiffness"};
    for (size_t i = 0; i < sizeof not_there / sizeof not_there[0]; i++)
        assert_null(strstr(out, not_there[i]));
    assert_null(strstr(out, " \n"));
    static const char *const cases[][2] = {
        {"--spring 1:2", "the model melting has no springs"},
        {"--step 4 --stage momentun@2", "did you mean \"momentum\"? Its stages: substeps, "},
        {"--step 4 --stage momentum@99", "there is no momentum@99 in it"},
        {"--step 4 --stage momentum@0", "number of a substep"},
        {"--step 4 --stage momentum@two", "number of a substep"},
        {"--step 4 --stage substeps@2", "made once in a step"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_code(2, run("inspect m.rlog %s", cases[i][0]));
        assert_one_message(cases[i][1]);
    }
}

/* A difference is named with its substep, and a refused step with its reason, in text and as JSON. */
static void melting_differences_and_failures_are_told(void **state)
{
    (void)state;
    record_melting("m.rlog", "");
    record_melting("n.rlog", "--set melting.xsph=0.4");
    assert_code(1, run("diff m.rlog n.rlog --json"));
    assert_string_equal(value_of("stage"), "\"integration@1\"");
    assert_string_equal(value_of("field"), "\"position\"");
    assert_code(1, run("diff m.rlog n.rlog"));
    assert_in("integration@1", out);
    assert_code(0, run("run --from m.rlog@2 --steps 2 --json -o later.rlog --force"));
    assert_code(0, run("diff m.rlog later.rlog"));
    assert_code(0, run("checkpoint m.rlog --step 2 -o c.rlog --force"));
    assert_code(0, run("run --from c.rlog --steps 2 --json -o later.rlog --force"));
    assert_code(0, run("diff m.rlog later.rlog"));
    assert_code(2, run("run --from m.rlog --steps 1 --set fluid.stiffness=3"));
    assert_one_message("no parameter of the model melting");
    assert_code(1, run("run --from m.rlog --steps 1 --set melting.max_substeps=1 -o bad.rlog --force"));
    assert_in("melting.max_substeps is 1", err);
    assert_code(0, run("verify bad.rlog"));
    assert_code(1, run("doctor bad.rlog"));
    assert_in("stage substeps cannot go on because of velocity", out);
    assert_in("--set melting.max_substeps=", out);
    assert_code(1, run("doctor bad.rlog --json"));
    assert_string_equal(value_of("stage"), "\"substeps\"");
    assert_code(0, run("inspect bad.rlog --json"));
    assert_in("melting.max_substeps is 1", out);
}

static void histories_are_those_of_the_library(void **state)
{
    (void)state;
    record("a.rlog");
    static const int steps[] = {0, 5, 8}; /* no history, some, a full window of 6 */
    for (size_t s = 0; s < 3; s++) {
        rheo_world *world = checkpoint_at("a.rlog", steps[s]);
        const uint32_t rows = rheo_world_history_rows(world);
        assert_int_equal(rows, steps[s] < 7 ? steps[s] : 7);
        rheo_spring spring[100];
        if (rheo_world_spring_count(world) == 0) { /* not settled: the first step makes the springs */
            rheo_world_destroy(world);
            continue;
        }
        assert_true(rheo_world_spring_count(world) > 100);
        assert_int_equal(rheo_world_springs(world, spring, 100), RHEO_OK);
        const rheo_spring *which = &spring[99];
        rheo_real own[7 * 3], difference[7 * 3];
        assert_int_equal(rheo_world_particle_history(world, which->b, own), RHEO_OK);
        assert_int_equal(rheo_world_spring_history(world, which->a, which->b, difference), RHEO_OK);
        rheo_spring_state expected;
        assert_int_equal(rheo_world_spring(world, which->a, which->b, &expected, NULL), RHEO_OK);
        rheo_particle_state particle;
        assert_int_equal(rheo_world_particle(world, which->b, &particle, NULL), RHEO_OK);
        assert_code(0, run("inspect a.rlog --step %d --json --particle %u --spring %u:%u", steps[s], which->b,
                           which->b, which->a));
        double weight[7];
        rheo_history_weights(.5, 7, weight);
        if (rows < 7)
            weight[rows - 1] = rheo_history_first_weight(.5, rows - 1);

        rheo_body ball;
        assert_int_equal(rheo_world_body(world, 0, &ball), RHEO_OK);
        const char *at = strstr(out, "\"bodies\": [");
        assert_non_null(at);
        assert_vector(&at, "position", ball.position);
        assert_vector(&at, "velocity", ball.velocity);
        assert_vector(&at, "spin", ball.spin);
        assert_true(number_after(&at, "mass") == ball.mass);
        at = strstr(out, "\"particle\": {");
        assert_non_null(at);
        assert_true(number_after(&at, "id") == which->b);
        assert_true(number_after(&at, "speed") == particle.speed);
        assert_true(number_after(&at, "density") == particle.density);
        assert_true(number_after(&at, "near_pressure") == particle.near_pressure);
        assert_true(number_after(&at, "derivative") == particle.derivative[0]);
        const char *list = at, *springs = strstr(at, "\"springs\": [");
        const double w = 1 - number_after(&list, "distance") / 4;
        assert_true(number_after(&list, "weight") == w);
        list = at;
        size_t neighbours = 0, partners = 0;
        for (; (list = strstr(list, "\"id\"")) != NULL && list < springs; list++)
            neighbours++;
        for (list = springs; (list = strstr(list, "\"partner\"")) != NULL; list++)
            partners++;
        assert_true(neighbours == particle.neighbours && partners == particle.springs && partners > 3);
        list = springs;
        for (double last = -1, id; (id = number_after(&list, "partner")) != which->a; last = id)
            assert_true(id > last);
        assert_true(number_after(&list, "kappa") == expected.kappa);
        at = strstr(at, "\"history\": [");
        for (uint32_t m = 0; m < rows; m++) {
            assert_true(number_after(&at, "lag") == m && number_after(&at, "step") == steps[s] - (int)m);
            assert_row(&at, "velocity", own + 3 * m);
        }

        at = strstr(out, "\"spring\": {");
        assert_non_null(at);
        assert_true(number_after(&at, "a") == which->a && number_after(&at, "b") == which->b);
        assert_true(number_after(&at, "rest_length") == (double)expected.spring.rest_length);
        assert_true(number_after(&at, "length") == expected.length);
        assert_true(number_after(&at, "stretch") == expected.length / (double)expected.spring.rest_length - 1);
        assert_true(number_after(&at, "history_rate") == expected.history_rate);
        assert_true(number_after(&at, "stiffness") == expected.stiffness);
        assert_true(number_after(&at, "kappa") == expected.kappa);
        for (uint32_t m = 0; m < rows; m++) {
            assert_true(number_after(&at, "lag") == m && number_after(&at, "step") == steps[s] - (int)m);
            const double off = number_after(&at, "time") - .033 * (steps[s] - (int)m);
            assert_true(off < 1e-12 && off > -1e-12);
            assert_true(number_after(&at, "weight") == weight[m]);
            assert_row(&at, "difference", difference + 3 * m);
        }
        assert_null(strstr(at, "\"lag\""));
        assert_code(0, run("inspect a.rlog --step %d --spring %u:%u", steps[s], which->a, which->b));
        assert_in("rest length", out);
        assert_in("weight", out);
        rheo_world_destroy(world);
    }
}

/* Where the time step has changed, every lag has the time that it had, also before the recording began. */
static void lags_have_the_times_that_they_had(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("run --from a.rlog@4 --steps 2 --set step=0.01 --quiet -o slow.rlog --force"));
    assert_code(0, run("inspect slow.rlog --json --particle 3"));
    static const double times[] = {.152, .142, .132, .099, .066, .033};
    const char *at = strstr(out, "\"history\"");
    assert_non_null(at);
    for (int m = 0; m < 6; m++) {
        assert_true(number_after(&at, "step") == 6 - m);
        const double off = number_after(&at, "time") - times[m];
        assert_true(off < 1e-9 && off > -1e-9);
    }
}

/* Adds a vector times a factor. */
static void take_vector(const char **at, const char *key, double factor, double sum[3])
{
    sum[0] += factor * number_after(at, key);
    for (int axis = 1; axis < 3; axis++) {
        *at += 2; /* a comma and a blank */
        sum[axis] += factor * number_at(at);
    }
}

/* A memory of modes shows them beside the newest velocity, and D^q x is their sum. */
static void modes_are_shown(void **state)
{
    (void)state;
    static const struct {
        const char *kind, *info;
        int modes, rows;
    } kinds[] = {
        {"window", "history     6 steps = 0.198 T\n", 0, 7},
        {"window-fast", "history     6 steps = 0.198 T, as decaying sums", 6, 7},
        {"full", "history     full: all of it", 13, 1},
        {"tempered", "history     tempered: a window of 6 steps = 0.198 T that fades with tau = 0.252", 8, 1}};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        assert_code(
            0, run("run %s --steps 9 --set history.kind=%s --quiet -o modes.rlog --force", scene, kinds[i].kind));
        assert_code(0, run("verify modes.rlog"));
        assert_code(0, run("info modes.rlog"));
        assert_in(kinds[i].info, out);
        assert_in(kinds[i].kind, out);
        assert_code(0, run("info modes.rlog --json"));
        assert_in(strcmp(kinds[i].kind, "full") ? "\"window_steps\": 6" : "\"window_steps\": null", out);
        for (int pair = 0; pair < 2; pair++) {
            rheo_world *world = checkpoint_at("modes.rlog", 9);
            rheo_spring *springs = malloc((rheo_world_spring_count(world) + 1) * sizeof *springs);
            assert_non_null(springs);
            assert_int_equal(rheo_world_springs(world, springs, 1), RHEO_OK);
            char what[64];
            snprintf(what, sizeof what, pair ? "--spring %u:%u" : "--particle %u", springs[0].a, springs[0].b);
            free(springs);
            rheo_world_destroy(world);
            assert_code(0, run("inspect modes.rlog %s", what));
            char text[32];
            snprintf(text, sizeof text, "modes: %d,", kinds[i].modes);
            assert_true((strstr(out, text) != NULL) == (kinds[i].modes > 0));
            snprintf(text, sizeof text, "history: %d rows", kinds[i].rows);
            assert_in(text, out);
            assert_code(0, run("inspect modes.rlog --json %s", what));
            const char *at = strstr(out, pair ? "\"spring\": {" : "\"particle\": {");
            assert_non_null(at);
            const char *found = at;
            const double rate = number_after(&found, pair ? "history_rate" : "derivative");
            int rows = 0, modes = 0;
            for (const char *list = at; (list = strstr(list, "\"lag\"")) != NULL; list++)
                rows++;
            assert_int_equal(rows, kinds[i].rows);
            const char *list = strstr(at, "\"history\": [");
            double sum[3] = {0}, size = 0;
            assert_non_null(list);
            char key[16];
            snprintf(key, sizeof key, "%s", pair ? "difference" : "velocity");
            take_vector(&list, key, 1, sum);
            list = strstr(at, "\"modes\": [");
            assert_non_null(list);
            for (; (list = strstr(list, "\"decay\"")) != NULL; modes++) {
                const double weight = number_after(&list, "weight");
                take_vector(&list, "sum", weight, sum);
            }
            assert_int_equal(modes, kinds[i].modes);
            const double scale = rheo_history_scale(.5, .033, RHEO_WEIGHTS_PAPER);
            for (int axis = 0; axis < 3; axis++)
                size += sum[axis] * sum[axis];
            const double mine = pair ? size : sum[0] * sum[0], difference = scale * scale * mine - rate * rate;
            if (modes)
                assert_true(difference <= 1e-4 * scale * scale * size && -difference <= 1e-4 * scale * scale * size);
        }
    }
}

static void particles_without_a_spring_are_told_their_partners(void **state)
{
    (void)state;
    record("a.rlog");
    rheo_world *world = checkpoint_at("a.rlog", 8);
    const uint32_t last = rheo_world_particle_count(world) - 1;
    rheo_world_destroy(world);
    assert_code(0, run("inspect a.rlog --json --particle 0"));
    char partners[64];
    const char *at = out;
    const unsigned first = (unsigned)number_after(&at, "partner"), second = (unsigned)number_after(&at, "partner");
    snprintf(partners, sizeof partners, "particle 0 has springs to %u, %u, ", first, second);
    size_t count = 2;
    for (; (at = strstr(at, "\"partner\"")) != NULL; at++)
        count++;
    assert_code(2, run("inspect a.rlog --spring 0:%u", last));
    assert_one_message(partners);
    assert_in("not connected", err);
    const char *more = strstr(strstr(err, "springs to"), " and ");
    assert_int_equal(count > 8, more != NULL);
    if (more)
        assert_int_equal(strtoul(more + 5, NULL, 10), count - 8);
    assert_code(0, run("inspect a.rlog --spring %u:0 --json", first));

    /* A fluid without springs, without history, without anything. */
    assert_code(
        0,
        run("run %s --steps 2 --set springs.stiffness=0 --set history.stiffness=0 -o b.rlog --force --quiet", scene));
    assert_code(2, run("inspect b.rlog --spring 0:1"));
    assert_one_message("springs to none");
    assert_code(0, run("inspect b.rlog --json --particle 0 --top 3"));
    assert_in("\"stiffest\": []", out);
    assert_in("\"springs\": []", out);
    assert_in("\"history\": []", out);
    assert_code(0, run("inspect b.rlog --particle 0 --top 3"));
    assert_in("  none", out);
    if (!json_scenes)
        return;
    write_file("empty.json", "{}", 2);
    assert_code(0, run("run ./empty.json --steps 2 -o nothing.rlog --force --quiet"));
    assert_code(0, run("inspect nothing.rlog --json"));
    assert_string_equal(value_of("particles"), "0");
    assert_in("\"densest\": []", out);
    assert_in("\"bodies\": []", out);
    assert_code(0, run("inspect nothing.rlog"));
    assert_null(strstr(out, "nan"));
    assert_code(2, run("inspect nothing.rlog --particle 0"));
    assert_one_message("no particles");
}

/* Too stiff a history: the springs tear the fluid apart in one of the first steps. */
static void a_step_that_failed_is_looked_into(void **state)
{
    (void)state;
    assert_code(1, run("run %s --steps 50 --set history.stiffness=1e6 -o bad.rlog --force --json --quiet", scene));
    assert_code(0, run("inspect bad.rlog --json"));
    assert_in("went bad", err);
    const char *at = strstr(out, "\"failure\": {");
    assert_non_null(at);
    const unsigned bad = (unsigned)number_after(&at, "step");
    assert_in("\"stage\": \"spring_displacement\", \"field\": \"position\", \"item\": \"particle\"", at);
    number_after(&at, "id");
    assert_in("went bad", at);
    char last[16], hash[32], text[64];
    snprintf(last, sizeof last, "%u", bad - 1);
    assert_string_equal(value_of("step"), last);
    snprintf(hash, sizeof hash, "%s", value_of("hash"));

    assert_code(0, run("inspect bad.rlog --json --step %u --stage springs --particle 3", bad));
    at = out;
    assert_true(number_after(&at, "step") == bad);
    assert_string_equal(value_of("stage"), "\"springs\"");
    assert_string_not_equal(value_of("hash"), hash);
    snprintf(text, sizeof text, "\"metrics\": {\"step\": %s, ", last);
    assert_in(text, out);
    assert_code(1, run("inspect bad.rlog --step %u --stage spring_displacement", bad));
    assert_one_message("went bad");
    assert_code(1, run("inspect bad.rlog --step %u --stage history", bad));
    assert_one_message("went bad");
    assert_code(2, run("inspect bad.rlog --step %u", bad));
    assert_one_message("before stage spring_displacement");
    assert_code(2, run("inspect bad.rlog --step %u --stage springs", bad + 1));
    snprintf(text, sizeof text, "steps 1 to %u; --step %u", bad, bad + 1);
    assert_one_message(text);
    assert_code(2, run("inspect bad.rlog --step %u", bad + 1));
    assert_one_message("is none of them");
}

static void inspect_holds_what_it_shows_against_the_hashes(void **state)
{
    (void)state;
    record("a.rlog");
    falsify_step("a.rlog", "other.rlog", 5);
    assert_code(0, run("inspect other.rlog --step 4"));
    assert_code(1, run("inspect other.rlog --step 6"));
    assert_one_message("step 5");
    static char bytes[1 << 22];
    const size_t size = (size_t)file_size("a.rlog");
    FILE *file = fopen("a.rlog", "rb");
    assert_non_null(file);
    assert_int_equal(fread(bytes, 1, size, file), size);
    fclose(file);
    write_file("truncated.rlog", bytes, size - 5);
    assert_code(0, run("inspect truncated.rlog --json"));
    assert_string_equal(value_of("step"), "8");
    assert_in("truncated", err);
}

/* ---- doctor ---- */

static const char *const doctor_keys[] = {"file",       "verdict",   "step",  "stage",          "id",     "other_id",
                                          "measure",    "value",     "limit", "unhealthy_step", "why",    "failure",
                                          "first_step", "last_step", "complete", "findings",          "advice", NULL};

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

static void doctor_names_what_went_bad(void **state)
{
    (void)state;
    /* In float it ends with a step that fails; in double it may be thrown apart, and go on. */
    const int ended = run("run %s --steps 400 --set springs.stiffness=37.5 --set history.stiffness=1125 -o bad.rlog "
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

    /* The text ends with commands; the one that runs on, with what is advised, does what it says. */
    char words[128];
    assert_code(1, run("doctor bad.rlog"));
    assert_in("bad.rlog: unhealthy: step ", out);
    snprintf(words, sizeof words, "rheolog inspect bad.rlog --step %ld --spring %ld:%ld\n", step, a, b);
    assert_in(words, out);
    char looked[1 << 12];
    snprintf(looked, sizeof looked, "%.4000s", out);
    assert_code(0, run("%.*s", (int)strcspn(strstr(looked, "inspect bad"), "\n"), strstr(looked, "inspect bad")));
    assert_code(1, run("doctor bad.rlog"));
    snprintf(words, sizeof words, "rheolog checkpoint bad.rlog --step %ld -o before.rlog\n", step - 1);
    assert_in(words, out);
    snprintf(words, sizeof words, "rheolog run --from bad.rlog@%ld --steps 100 --set springs.solver=implicit\n",
             step - 1);
    assert_in(words, out);
    assert_code(0,
                run("run --from bad.rlog@%ld --steps 100 --set springs.solver=implicit -o good.rlog --force --quiet",
                    step - 1));
    assert_code(0, run("doctor good.rlog"));
    run("run --from bad.rlog@%ld --steps 100 -o again.rlog --force --quiet", step - 1);
    assert_code(1, run("doctor again.rlog"));
}

static void doctor_goes_as_far_as_a_file_does(void **state)
{
    (void)state;
    record("a.rlog");
    static char bytes[1 << 22];
    const size_t size = (size_t)file_size("a.rlog");
    assert_true(size < sizeof bytes);
    FILE *file = fopen("a.rlog", "rb");
    assert_non_null(file);
    assert_int_equal(fread(bytes, 1, size, file), size);
    fclose(file);
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

/* ---- bench ---- */

/* Small enough to take no time; the numbers mean nothing then. */
#define SMALL "--particles 1000 --steps 2 --repetitions 2 --quiet"

static size_t lines_of(const char *text)
{
    size_t lines = 0;
    for (; *text; text++)
        lines += *text == '\n';
    return lines;
}

/* The words of line `line` between commas; returns how many. */
static size_t split_line(size_t line, char cell[][64], size_t most)
{
    const char *at = out;
    while (line-- > 0)
        at = strchr(at, '\n') + 1;
    for (size_t n = 1;; n++) {
        const size_t length = strcspn(at, ",\n");
        assert_true(n <= most);
        snprintf(cell[n - 1], 64, "%.*s", (int)length, at);
        if (at[length] == '\n')
            return n;
        at += length + 1;
    }
}

/* A cell of the CSV in `out`. */
static const char *cell_of(size_t line, const char *name)
{
    static char names[96][64], cells[96][64];
    const size_t count = split_line(0, names, 96);
    assert_int_equal(split_line(line, cells, 96), count);
    for (size_t i = 0; i < count; i++)
        if (strcmp(names[i], name) == 0)
            return cells[i];
    fail_msg("no column %s", name);
    return NULL;
}

static double number_of(size_t line, const char *name)
{
    const char *text = cell_of(line, name);
    assert_true(*text != 0);
    return strtod(text, NULL);
}

static void bench_has_its_columns(void **state)
{
    (void)state;
    assert_code(0, run("bench table1 --windows 0,5 " SMALL " --csv"));
    assert_string_equal(err, "");
    assert_int_equal(lines_of(out), 1 + 4);
    static const char *const scenes[] = {"bowling-ball", "bowling-ball", "vibration", "vibration"};
    for (size_t line = 1; line <= 4; line++) {
        const bool history = line % 2 == 0;
        assert_string_equal(cell_of(line, "case"), scenes[line - 1]);
        assert_in(history ? "5" : "0", cell_of(line, "window"));
        assert_string_equal(cell_of(line, "kind"), history ? "window" : "");
        assert_true(number_of(line, "particles") > 900 && number_of(line, "particles") < 1100);
        assert_true(number_of(line, "ns_least") > 0);
        assert_true(number_of(line, "ns_least") <= number_of(line, "ns_median"));
        assert_true(number_of(line, "ns_median") <= number_of(line, "ns_largest"));
        assert_true(number_of(line, "ns_density") > 0);
        assert_true((*cell_of(line, "ns_fractional_derivative") != 0) == history);
        assert_true((*cell_of(line, "ns_vibrators") != 0) == (line > 2));
        assert_true((*cell_of(line, "ns_ball") != 0) == (line <= 2));
        assert_true((*cell_of(line, "paper_ns_step") != 0) == !history); /* there is no d = 5 in the paper */
        assert_true(number_of(line, "bytes_history") == (history ? 6. * 3 * sizeof(rheo_real) : 0));
        assert_true(number_of(line, "bytes_world") > number_of(line, "bytes_state"));
        assert_int_equal(strlen(cell_of(line, "hash")), 16);
        assert_true(number_of(line, "steps") == 2 && number_of(line, "repetitions") == 2);
        assert_in(cell_of(line, "compiler"), rheo_build());
        assert_string_equal(cell_of(line, "simd"), rheo_simd());
    }
    assert_true(number_of(1, "paper_ns_step") == 61300);
    /* Another run gives the same hashes, on any kernels. */
    char hash[32];
    snprintf(hash, sizeof hash, "%s", cell_of(2, "hash"));
    assert_code(0, run("bench table1 --windows 5 --simd scalar " SMALL " --csv"));
    assert_string_equal(cell_of(1, "simd"), "scalar");
    assert_string_equal(cell_of(1, "hash"), hash);
}

static void bench_json_has_the_names_of_csv(void **state)
{
    (void)state;
    static char names[96][64];
    assert_code(0, run("bench history --windows 5 " SMALL " --csv"));
    const size_t count = split_line(0, names, 96), lines = lines_of(out);
    /* Every kind of memory is there, the exact window with the error of rounding alone, the others with that of a
     * fit. */
    static const char *const kinds[] = {"window", "window-fast", "full", "tempered"};
    assert_int_equal(lines, 1 + sizeof kinds / sizeof *kinds);
    for (size_t line = 1; line < lines; line++) {
        const double error = number_of(line, "error");
        assert_string_equal(cell_of(line, "kind"), kinds[line - 1]);
        assert_true(error >= 0 && error < (line == 1 ? 1e-5 : 5e-3));
        assert_true(number_of(line, "bytes_history") > 0);
    }
    assert_code(0, run("bench history --windows 5 " SMALL " --json"));
    assert_int_equal(lines_of(out), lines - 1);
    for (size_t i = 0; i < count; i++) {
        const char *const keys[] = {names[i], NULL};
        for (const char *line = out; *line; line = strchr(line, '\n') + 1)
            assert_keys(line, keys);
    }
    assert_string_equal(value_of("case"), "\"bowling-ball\"");
    assert_string_equal(value_of("kind"), "\"window\"");
    assert_string_equal(value_of("window"), "5");
}

static void bench_tells_people(void **state)
{
    (void)state;
    assert_code(0, run("bench table1 --windows 0,5 " SMALL));
    assert_in("scene", out);
    assert_in("vibration ", out);
    assert_in("this machine at best", out);
    assert_in("fractional_derivative ", out);
    assert_in("set by", out);
    assert_code(0, run("bench history --windows 5 " SMALL));
    assert_in("bytes/part.", out);
    assert_code(0, run("bench scaling " SMALL));
    assert_in("ratio", out);
    assert_in(" 1.00 ", out);
    assert_code(0, run("bench features --particles 1000 --steps 2 --repetitions 1"));
    assert_in("springs, walls", out);
    assert_in("neighbours_start viscosity prediction neighbours density velocity.", out);
}

static void bench_limits_are_lines_of_stages(void **state)
{
    (void)state;
    assert_code(0, run("bench limits " SMALL " --csv"));
    assert_string_equal(cell_of(1, "stage"), "gravity");
    assert_true(number_of(1, "machine_operations") > 0 && number_of(1, "machine_roots") > 0);
    assert_true(number_of(1, "machine_divisions") > 0 && number_of(1, "machine_memory_read") > 0);
    assert_true(number_of(3, "ns_limit") > 0);
    assert_string_equal(cell_of(lines_of(out) - 1, "stage"), "rest");
}

static void bench_features_have_their_stages(void **state)
{
    (void)state;
    assert_code(0, run("bench features --particles 1000 --steps 2 --repetitions 1 --csv --quiet"));
    assert_string_equal(cell_of(1, "case"), "fluid");
    assert_true(number_of(1, "ns_own") == 0);
    assert_true(number_of(1, "bytes_history") == 0);
    assert_string_equal(cell_of(1, "ns_springs"), "");
    const size_t last = lines_of(out) - 1;
    assert_string_equal(cell_of(last, "case"), "all");
    assert_true(number_of(last, "ns_own") > 0);
    static const char *const own[] = {"ns_springs", "ns_fractional_derivative", "ns_ball", "ns_walls",
                                      "ns_vibrators"};
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        assert_true(number_of(last, own[i]) > 0);
    /* What the columns are of adds up. */
    const double sum = number_of(last, "ns_common") + number_of(last, "ns_own") + number_of(last, "ns_rest");
    assert_true(sum > .999 * number_of(last, "ns_median") - .1 && sum < 1.001 * number_of(last, "ns_median") + .1);
    assert_code(0, run("bench scaling " SMALL " --csv"));
    assert_int_equal(lines_of(out), 2);
    assert_true(number_of(1, "ratio") == 1);
    assert_true(number_of(1, "window") == 4);
}

static void lost_output_is_a_failure(void **state)
{
    (void)state;
    if (access("/dev/full", W_OK) != 0)
        skip();
    record("a.rlog");
    static const char *const cases[] = {"--help",
                                        "--version",
                                        "scenes",
                                        "run --help",
                                        "info a.rlog",
                                        "metrics a.rlog",
                                        "verify a.rlog",
                                        "run --from a.rlog --steps 1 --json",
                                        "inspect a.rlog --json"};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_code(3, run("%s >/dev/full", cases[i]));
        assert_in("standard output", err);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_command_has_help),
        cmocka_unit_test(bad_usage_is_told),
        cmocka_unit_test(what_is_no_recording_is_told),
        cmocka_unit_test(scenes_are_listed),
        cmocka_unit_test(run_has_its_keys),
        cmocka_unit_test(an_empty_scene_runs),
        cmocka_unit_test(a_bad_scene_file_is_told),
        cmocka_unit_test(a_mesh_is_found_beside_its_scene),
        cmocka_unit_test(written_scenes_run_the_same),
        cmocka_unit_test(recording_changes_nothing),
        cmocka_unit_test(files_are_not_replaced_without_force),
        cmocka_unit_test(runs_go_on_from_any_step),
        cmocka_unit_test(changes_after_from_are_recorded),
        cmocka_unit_test(a_run_gone_bad_leaves_a_good_recording),
        cmocka_unit_test(an_interrupted_run_leaves_a_good_recording),
        cmocka_unit_test(a_full_disk_leaves_a_readable_recording),
        cmocka_unit_test(verify_has_its_keys),
        cmocka_unit_test(verify_says_the_hash_of_the_last_step),
        cmocka_unit_test(torn_and_damaged_files_are_unreadable),
        cmocka_unit_test(a_difference_is_named),
        cmocka_unit_test(diff_has_its_keys),
        cmocka_unit_test(bless_is_the_way_of_golden_recordings),
        cmocka_unit_test(info_has_its_keys),
        cmocka_unit_test(metrics_are_csv),
        cmocka_unit_test(inspect_has_its_keys),
        cmocka_unit_test(inspect_looks_between_stages),
        cmocka_unit_test(melting_runs_are_shown),
        cmocka_unit_test(melting_states_are_inspected),
        cmocka_unit_test(melting_differences_and_failures_are_told),
        cmocka_unit_test(histories_are_those_of_the_library),
        cmocka_unit_test(lags_have_the_times_that_they_had),
        cmocka_unit_test(modes_are_shown),
        cmocka_unit_test(particles_without_a_spring_are_told_their_partners),
        cmocka_unit_test(a_step_that_failed_is_looked_into),
        cmocka_unit_test(inspect_holds_what_it_shows_against_the_hashes),
        cmocka_unit_test(doctor_finds_healthy_runs_healthy),
        cmocka_unit_test(doctor_names_what_went_bad),
        cmocka_unit_test(doctor_goes_as_far_as_a_file_does),
        cmocka_unit_test(export_has_its_keys),
        cmocka_unit_test(exports_are_the_same_whenever_made),
        cmocka_unit_test(export_refuses_and_tells),
        cmocka_unit_test(bench_has_its_columns),
        cmocka_unit_test(bench_json_has_the_names_of_csv),
        cmocka_unit_test(bench_tells_people),
        cmocka_unit_test(bench_limits_are_lines_of_stages),
        cmocka_unit_test(bench_features_have_their_stages),
        cmocka_unit_test(lost_output_is_a_failure),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
