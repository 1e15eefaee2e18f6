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

static const char *const commands[] = {"scenes", "run", "verify", "info", "checkpoint", "metrics"};

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
        {"checkpoint none.rlog -o x.rlog", "--step"},
        {"checkpoint none.rlog --step 3", "-o"},
        {"checkpoint none.rlog --step 3 -o x.rlog", "none.rlog"},
        {"scenes x", "\"x\""},
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
    for (size_t i = 2; i < 6; i++) {
        static const char *const rest[] = {"", "", "", "", "--step 0 -o x.rlog", ""};
        assert_code(2, run("%s tiny.json %s", commands[i], rest[i]));
        assert_code(2, run("%s empty %s", commands[i], rest[i]));
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
    static const char *const words[] = {"fluid.support = 4", "springs.solver", "explicit implicit", "settle.time",
                                        "(live)"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        assert_in(words[i], out);
    assert_code(0, run("scenes --parameters --json"));
    static const char *const parameter_keys[] = {"path", "unit", "default", "live", NULL};
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
    assert_string_equal(value_of("whole"), "true");
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
    assert_string_equal(value_of("whole"), "true");
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
        assert_in("torn", out);
        if (steps >= 2) /* what is there can be gone on from */
            assert_code(0, run("run --from full.rlog@%ld --steps 1 --quiet", steps));
    }
    if (access("/dev/full", W_OK) != 0)
        return;
    assert_code(3, run("run %s --steps 2 -o /dev/full --force --quiet", scene));
    assert_in("cannot write", err);
}

/* ---- verify, info, metrics ---- */

static void verify_has_its_keys(void **state)
{
    (void)state;
    record("a.rlog");
    static const char *const keys[] = {"file", "verdict", "steps", "first", NULL};
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
    write_file("torn.rlog", bytes, size - 5);
    assert_code(2, run("verify torn.rlog a.rlog"));
    assert_in("torn.rlog: unreadable", out);
    assert_in("a.rlog: same", out);
    assert_code(2, run("metrics torn.rlog"));
    assert_in("step,time,", out);
    assert_in("torn", err);
    assert_code(0, run("info torn.rlog --json"));
    assert_string_equal(value_of("whole"), "false");
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

static void info_has_its_keys(void **state)
{
    (void)state;
    record("a.rlog");
    static const char *const keys[] = {"scene",   "steps",      "particles",
                                       "format",  "keyframes",  "bytes",
                                       "build",   "real_bytes", "keyframe_spacing",
                                       "whole",   "parameters", "fluid.support",
                                       "gravity", "kappa",      NULL};
    assert_code(0, run("info a.rlog --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("steps"), "8");
    assert_string_equal(value_of("fluid.support"), "4");
    char size[32];
    snprintf(size, sizeof size, "%ld", file_size("a.rlog"));
    assert_string_equal(value_of("bytes"), size);
    assert_code(0, run("info a.rlog"));
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

static void lost_output_is_a_failure(void **state)
{
    (void)state;
    if (access("/dev/full", W_OK) != 0)
        skip();
    record("a.rlog");
    static const char *const cases[] = {
        "--help",      "--version",      "scenes",        "run --help",
        "info a.rlog", "metrics a.rlog", "verify a.rlog", "run --from a.rlog --steps 1 --json"};
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
        cmocka_unit_test(written_scenes_run_the_same),
        cmocka_unit_test(recording_changes_nothing),
        cmocka_unit_test(files_are_not_replaced_without_force),
        cmocka_unit_test(runs_go_on_from_any_step),
        cmocka_unit_test(changes_after_from_are_recorded),
        cmocka_unit_test(a_run_gone_bad_leaves_a_good_recording),
        cmocka_unit_test(an_interrupted_run_leaves_a_good_recording),
        cmocka_unit_test(a_full_disk_leaves_a_readable_recording),
        cmocka_unit_test(verify_has_its_keys),
        cmocka_unit_test(torn_and_damaged_files_are_unreadable),
        cmocka_unit_test(a_difference_is_named),
        cmocka_unit_test(info_has_its_keys),
        cmocka_unit_test(metrics_are_csv),
        cmocka_unit_test(lost_output_is_a_failure),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
