/* The program from outside: help, usage, scenes and lost output. */
#include "cli_support.h"

#include <unistd.h>
#include <zlib.h>

/* ---- Usage ---- */

static const char *const commands[] = {"bench",   "bless",       "check",  "checkpoint", "curves",    "diff",
                                       "doctor",  "experiments", "export", "info",       "inspect",   "log",
                                       "metrics", "render",      "report", "rerecord",   "rheometer", "run",
                                       "same",    "scenes",      "schema", "table",      "verify"};

static void assert_fits_80_columns(void)
{
    for (const char *line = out; *line; line += strcspn(line, "\n") + 1)
        assert_true(strcspn(line, "\n") <= 80);
}

static void every_command_has_help(void **state)
{
    (void)state;
    assert_code(0, run("--help"));
    assert_string_equal(err, "");
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++)
        assert_in(commands[i], out);
    assert_fits_80_columns();
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        char usage[64];
        snprintf(usage, sizeof usage, "usage: rheolog %s", commands[i]);
        assert_code(0, run("%s --help", commands[i]));
        assert_in(usage, out);
        assert_in("examples:", out);
        assert_in("exit codes:", out);
        assert_fits_80_columns();
        assert_code(0, run("help %s", commands[i]));
        assert_in(usage, out);
    }
    assert_code(0, run("run --help"));
    assert_in("rheolog scenes --parameters", out);
    assert_code(0, run("--version"));
    assert_in("rheolog 0.", out);
}

/* Both forms say the same, and JSON also the flags without which bits differ. No path of the build is in it. */
static void the_version_has_two_forms(void **state)
{
    (void)state;
    char text[sizeof out], line[256];
    assert_code(0, run("--version"));
    memcpy(text, out, sizeof text);
    assert_code(0, run("--version --json"));
    assert_string_equal(err, "");
    static const char *const keys[] = {"version",     "build", "compiler", "flags",  "real",    "machine", "simd",
                                       "simd_in_use", "zlib",  "jansson",  "libpng", "libedit", NULL};
    assert_keys(out, keys);
    snprintf(line, sizeof line, "rheolog %.*s\n", (int)strlen(value_of("version")) - 2, value_of("version") + 1);
    assert_in(line, text);
    snprintf(line, sizeof line, ", %.*s, ", (int)strlen(value_of("compiler")) - 2, value_of("compiler") + 1);
    assert_in(line, text);
    snprintf(line, sizeof line, ", %.*s, %.*s\n", (int)strlen(value_of("real")) - 2, value_of("real") + 1,
             (int)strlen(value_of("machine")) - 2, value_of("machine") + 1);
    assert_in(line, text);
    snprintf(line, sizeof line, "(in use: %.*s)", (int)strlen(value_of("simd_in_use")) - 2,
             value_of("simd_in_use") + 1);
    assert_in(line, text);
    assert_string_equal(value_of("zlib"), "\"" ZLIB_VERSION "\"");
    assert_in("-ffp-contract=off", out);
    assert_null(strstr(out, "prefix-map"));
    assert_code(2, run("--version --jsn"));
    assert_one_message("--version takes no argument but --json; got \"--jsn\"");
    assert_code(2, run("--version --json x"));
    assert_one_message("got \"x\"");
}

static void bad_usage_is_reported(void **state)
{
    (void)state;
    assert_code(2, run(" "));
    assert_in("usage: rheolog COMMAND", err);
    assert_string_equal(out, "");
    static const char *const cases[][2] = {
        {"verfy", "\"verify\""},
        {"help verfy", "\"verify\""},
        {"run --stpes 3", "--steps"},
        {"compare", "unknown command \"compare\" (rheolog"}, /* no suggestion: none is near */
        {"-v", "--version"},
        {"--quiet", "a command comes first"},
        {"run -v", "unknown option -v ("},
        {"run bowling-ball --colour", "unknown option --colour ("},
        {"run bowling-ball --setp=3", "did you mean --set"},
        {"run bowling-ball --set fluid.shapes=3", "only a scene file can"},
        {"run bowling-ball --set walls.planes=3", "only a scene file can"},
        {"run bowling-ball --steps 1 -o -", "not to standard output"},
        {"export none.rlog -o - --format vtp", "not to standard output"},
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
        {"run bowling-ball --kernels avx2", "--kernels is now called --simd"},
        {"run bowling-ball --set sources.amplitude=1", "vibrators.amplitude"},
        {"run bowling-ball --set fluid.support", "KEY=VALUE"},
        {"run bowling-ball --set fluid.support=", "KEY=VALUE"},
        {"run bowling-ball --set fluid.support=-1", "fluid.support"},
        {"run bowling-ball --set settle.fraction=2", "settle.fraction"},
        {"run bowling-ball -o no/such/folder.rlog", "no/such"},
        {"run bowling-ball -o .", "folder"},
        {"check", "one scene"},
        {"check a b", "one scene"},
        {"check none.json", "none.json"},
        {"check none.rlog", "a recording, not a scene"},
        {"check bowling-bal", "did you mean \"bowling-ball\"?"},
        {"check bowling-ball --set step", "--set needs KEY=VALUE"},
        {"check bowling-ball --set step=-1", "step"},
        {"run --from none.rlog", "none.rlog"},
        {"run bowling-ball --from none.rlog", "bowling-ball"},
        {"run --from none.rlog@x", "whole number"},
        {"verify", "no recordings"},
        {"verify --josn x", "--json"},
        {"rerecord", "one recording"},
        {"same", "one golden recording"},
        {"same none.rlog", "none.rlog"},
        {"same none.rlog --at-least bit", "--at-least needs"},
        {"same none.rlog --members 2", "--members needs"},
        {"same none.rlog --limit 0.5", "--limit needs"},
        {"same none.rlog --set gravity", "KEY=VALUE"},
        {"bless a b --because x --at-least bit", "--at-least needs"},
        {"rerecord a b", "one recording"},
        {"rerecord none.rlog", "-o NEW.rlog"},
        {"rerecord none.rlog -o x.rlog", "none.rlog"},
        {"rerecord . -o x.rlog", "it is a folder, not a file"},
        {"rerecord /dev/null -o x.rlog", "not from a pipe or device"},
        {"rerecord none.rlog -o no/such/folder.rlog", "none.rlog"},
        {"check .", "it is a folder, not a file"},
        {"check bowling-ball --set particles=99999999999999999999", "particles is 1e+20"},
        {"check bowling-ball --set step=1e999", "step is inf"},
        {"log", "one recording"},
        {"log a b", "one recording"},
        {"log .", "it is a folder, not a file"},
        {"log /dev/null", "not from a pipe or device"},
        {"log none.rlog", "none.rlog"},
        {"info", "at least one recording"},
        {"info none.rlog", "none.rlog"},
        {"info .", "folder"},
        {"metrics", "at least one recording"},
        {"metrics --list a b", "at most one"},
        {"metrics a --list --columns step", "--columns"},
        {"metrics none.rlog", "none.rlog"},
        {"doctor", "at least one recording"},
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
        {"scenes --parameters meltin.", "no parameter begins with \"meltin.\""},
        {"scenes --markdown --parameters step", "leave \"step\" out"},
        {"schema x", "takes no operand"},
        {"schema --markdown x", "\"x\""},
        {"export", "one recording"},
        {"export a b", "one recording"},
        {"export none.rlog --format vtp", "-o DIR"},
        {"export none.rlog -o x", "--format"},
        {"export none.rlog -o x --format vtk", "\"vtp\""},
        {"export none.rlog -o x --format vtp --every 0", "--every"},
        {"export none.rlog -o x --format vtp --every 2 --step 3", "--step"},
        {"export none.rlog -o x --format vtp --isovalue .5", "vtp exports none"},
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
        {"bench table1 --particles 199", "--particles"},
        {"bench table1 --windows 1,,2", "\"1,,2\""},
        {"bench table1 --windows 1000001", "1000000"},
        {"bench table1 --windows ''", "--windows"},
        {"bench history --windows 1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17", "more than 16"},
        {"bench scaling --windows 1", "scaling takes no --windows"},
        {"bench limits --simd none", "\"none\""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const int code = run("%s", cases[i][0]);
        if (code != 2)
            fail_msg("exit code %d: %s", code, cases[i][0]);
        assert_one_message(cases[i][1]);
    }
    assert_int_equal(file_size("x.rlog"), -1);
}

static void a_file_that_is_no_recording_is_reported(void **state)
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
    /* With prefixes, the parameters that begin so. */
    assert_code(0, run("scenes --parameters ball.r settle."));
    size_t listed = 0;
    for (const char *line = out; *line; line = strchr(line, '\n') + 1) {
        const bool wanted = strncmp(line, "ball.r", 6) == 0 || strncmp(line, "settle.", 7) == 0;
        assert_true(wanted || *line == ' ');
        listed += wanted;
    }
    assert_int_equal(listed, 4);
    assert_code(0, run("scenes --parameters settle.time --json"));
    assert_string_equal(value_of("path"), "\"settle.time\"");
    assert_string_equal(strchr(out, '\n'), "\n");
    assert_code(0, run("scenes --parameters --json"));
    static const char *const parameter_keys[] = {"path", "unit", "default", "models", "live", NULL};
    for (const char *line = out; *line; line = strchr(line, '\n') + 1)
        assert_keys(line, parameter_keys);
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
        cmocka_unit_test(every_command_has_help), cmocka_unit_test(the_version_has_two_forms),
        cmocka_unit_test(bad_usage_is_reported),  cmocka_unit_test(a_file_that_is_no_recording_is_reported),
        cmocka_unit_test(scenes_are_listed),      cmocka_unit_test(lost_output_is_a_failure),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
