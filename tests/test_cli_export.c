/* `rheolog export` from outside. */
#include "cli_support.h"

#include <sys/wait.h>
#include <unistd.h>

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
    assert_string_equal(value_of("collection"), "null");
    assert_string_equal(value_of("first_step"), "8");
    assert_true(strtol(value_of("triangles"), NULL, 10) > 100);
    assert_string_equal(value_of("without_surface"), "0");
    assert_true(file_size("made/a_000008.ply") > 1000);
    assert_code(0, run("export a.rlog -o made --format vtp --every 3 --json"));
    assert_string_equal(value_of("files"), "4"); /* three steps, and their collection */
    assert_string_equal(value_of("collection"), "\"made/a.pvd\"");
    assert_string_equal(value_of("steps"), "3");
    assert_string_equal(value_of("last_step"), "6");
    assert_true(file_size("made/a_000000.vtp") > 1000 && file_size("made/a_000003.vtp") > 1000);
    read_file("made/a.pvd", out, sizeof out);
    assert_in("timestep=\"0.099\" part=\"0\" file=\"a_000003.vtp\"", out);
    assert_code(0, run("export a.rlog -o made/ --format csv --from 2 --to 4"));
    assert_in("a_000002.csv\n", out);
    assert_in("a_000004.csv\n", out);
    assert_int_equal(file_size("made/a_000005.csv"), -1);
    assert_code(0, run("export a.rlog -o made --format springs --step 5"));
    assert_string_equal(out, "made/a_springs_000005.vtp\nmade/a_springs.pvd\n");
    assert_code(0, run("export a.rlog -o made --format solids --step 5"));
    assert_string_equal(out, "made/a_solids_000005.vtp\nmade/a_solids.pvd\n");
    assert_code(0, run("export a.rlog -o made --format obj --step 5"));
    assert_string_equal(out, "made/a_000005.obj\n");
    assert_code(0, run("export a.rlog -o made --format pov --isovalue 0.4 --resolution 1"));
    /* An empty surface is reported. */
    assert_code(0, run("export a.rlog -o made --format obj --isovalue 0.99999 --resolution .5 --step 1 --json"));
    if (strcmp(value_of("triangles"), "0") == 0)
        assert_in("no surface", err);
}

/* Regression: a refused export printed nothing with --json. */
static void a_refused_export_prints_its_reason_as_json(void **state)
{
    (void)state;
    assert_code(2, run("export none.rlog -o made --format ply --json"));
    assert_in("{\"file\": \"none.rlog\", \"folder\": \"made\", \"outcome\": \"refused\", \"reason\": \"", out);
    record("a.rlog");
    assert_code(0, run("export a.rlog -o made --format ply --json --force"));
    assert_in("\"outcome\": \"done\", \"reason\": null, ", out);
    assert_code(2, run("export a.rlog -o made --format ply --json"));
    assert_in("\"outcome\": \"refused\", \"reason\": \"made/a_000008.ply exists", out);
    assert_code(2, run("export --json"));
    assert_in("{\"file\": null, \"folder\": null, \"outcome\": \"refused\", ", out);
}

static void several_formats_are_written_in_one_pass(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("export a.rlog -o single --format ply --every 4"));
    assert_code(0, run("export a.rlog -o single --format solids --every 4"));
    assert_code(0, run("export a.rlog -o together --format solids,ply,csv --every 4"));
    static const char *const files[] = {"a_000000.ply", "a_000008.ply", "a_solids_000004.vtp", "a_solids.pvd"};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char one[64], other[64];
        snprintf(one, sizeof one, "single/%s", files[i]);
        snprintf(other, sizeof other, "together/%s", files[i]);
        assert_files_same(one, other);
    }
    /* One line of JSON for each format, each with its own counts. */
    assert_code(0, run("export a.rlog -o together --format solids,ply,csv --every 4 --json --force"));
    assert_string_equal(value_of("format"), "\"solids\"");
    assert_string_equal(value_of("files"), "4");
    const char *second = strchr(out, '\n') + 1;
    assert_in("\"format\": \"ply\", \"files\": 3, \"steps\": 3", second);
    assert_true(number_after(&second, "triangles") > 100);
    const char *third = strchr(second, '\n') + 1;
    assert_in("\"format\": \"csv\", \"files\": 3", third);
    assert_true(number_after(&third, "triangles") == 0);
    assert_string_equal(strchr(third, '\n'), "\n");
    /* One file in the way, and none is written. */
    assert_code(0, run("export a.rlog -o half --format csv --step 4"));
    assert_code(2, run("export a.rlog -o half --format ply,csv --step 4"));
    assert_int_equal(file_size("half/a_000004.ply"), -1);
    assert_code(2, run("export a.rlog -o half --format ply,ply"));
    assert_one_message("twice");
    assert_code(2, run("export a.rlog -o half --format ply,"));
    assert_one_message("unknown format \"\"");
}

/* The files of a stage are those of the library in the middle of the step, and say so in their names. */
static void a_stage_of_a_step_is_exported(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("export a.rlog -o stage --format csv,springs --step 5 --stage forces@1"));
    assert_string_equal(out,
                        "stage/a_000005_forces@1.csv\nstage/a_springs_000005_forces@1.vtp\nstage/a_springs.pvd\n");
    rheo_recording *recording;
    rheo_player *player;
    assert_int_equal(rheo_recording_open("a.rlog", &recording, NULL), RHEO_OK);
    assert_int_equal(rheo_player_open(recording, NULL, &player, NULL), RHEO_OK);
    assert_int_equal(rheo_player_seek_stage(player, 5, "forces@1", NULL), RHEO_OK);
    const rheo_export_options options = {.surface = rheo_default_surface_options()};
    assert_int_equal(
        rheo_world_export(rheo_player_world(player), RHEO_EXPORT_CSV, "stage/own.csv", &options, NULL, NULL),
        RHEO_OK);
    assert_files_same("stage/own.csv", "stage/a_000005_forces@1.csv");
    rheo_player_close(player);
    rheo_recording_close(recording);
    assert_code(0, run("export a.rlog -o stage --format csv --step 5"));
    assert_code(1, WEXITSTATUS(system("cmp -s stage/a_000005.csv stage/own.csv")));
    assert_code(2, run("export a.rlog -o stage --format csv --step 5 --stage nothing"));
    assert_one_message("nothing");
    assert_code(2, run("export a.rlog -o stage --format csv --every 2 --stage forces"));
    assert_one_message("--stage needs --step");
}

/* The colours of all steps have the range of the first, a middle and the last one, or the given one. */
static void surfaces_of_a_call_have_one_range_of_colours(void **state)
{
    (void)state;
    record("a.rlog");
    double range[2] = {0, 0};
    for (int step = 0; step <= 8; step += 4) {
        double own[2];
        rheo_world *world = checkpoint_at("a.rlog", step);
        assert_int_equal(rheo_world_colour_range(world, &(rheo_picture_options){.colour = "density"}, own, NULL),
                         RHEO_OK);
        range[0] = step == 0 || own[0] < range[0] ? own[0] : range[0];
        range[1] = step == 0 || own[1] > range[1] ? own[1] : range[1];
        rheo_world_destroy(world);
    }
    assert_code(0, run("export a.rlog -o colours --format ply,obj,surface --every 4 --color density"));
    assert_in("colours/a_surface_000004.vtp\n", out);
    assert_in("colours/a_surface.pvd\n", out);
    rheo_world *world = checkpoint_at("a.rlog", 4);
    rheo_export_options options = {.surface = rheo_default_surface_options(), .colour = "density", .range = range};
    assert_int_equal(rheo_world_export(world, RHEO_EXPORT_PLY, "colours/own.ply", &options, NULL, NULL), RHEO_OK);
    assert_files_same("colours/own.ply", "colours/a_000004.ply");
    options.range = (const double[2]){1, 3.5};
    options.z_up = true;
    options.force = true;
    assert_int_equal(rheo_world_export(world, RHEO_EXPORT_OBJ, "colours/own.obj", &options, NULL, NULL), RHEO_OK);
    assert_code(0, run("export a.rlog -o given --format obj --step 4 --color density --range 1,3.5 --up z"));
    assert_files_same("colours/own.obj", "given/a_000004.obj");
    rheo_world_destroy(world);
    assert_code(0, run("export a.rlog -o up --format csv --step 4"));
    assert_code(0, run("export a.rlog -o up --format csv --step 4 --up y --force"));
}

static void options_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"--format csv --color speed", "--color and --range apply to surfaces; csv exports none"},
        {"--format ply --range 1,2", "--range needs --color NAME"},
        {"--format ply --range 1,2 --color none", "--range needs --color NAME"},
        {"--format ply --color speed --range 2,1", "MIN below MAX; got \"2,1\""},
        {"--format ply --color speed --range 2", "--range needs MIN,MAX"},
        {"--format ply --color speed --range 1,2,3", "--range needs 2 numbers"},
        {"--format ply --up x", "--up needs y or z; got \"x\""},
        {"--format ply --color hue", "\"hue\""},
    };
    record("a.rlog");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_code(2, run("export a.rlog -o bad %s", cases[i][0]));
        assert_one_message(cases[i][1]);
    }
    assert_int_equal(file_size("bad/a_000008.ply"), -1);
}

/* File names begin with at most 200 characters of the recording's. */
static void a_long_name_is_refused(void **state)
{
    (void)state;
    char name[256];
    record("a.rlog");
    for (int length = 200; length <= 201; length++) {
        snprintf(name, sizeof name, "%0*d.rlog", length, 0);
        assert_int_equal(link("a.rlog", name), 0);
        assert_code(length > 200 ? 2 : 0, run("export %s -o long --format csv --step 4", name));
        if (length > 200)
            assert_one_message("are too long to be those of files together");
        assert_int_equal(unlink(name), 0);
    }
}

static void exports_are_the_same_whenever_made(void **state)
{
    (void)state;
    record("a.rlog");
    static const char *const formats[] = {"vtp", "ply", "obj", "csv", "pov", "springs", "solids", "surface"};
    for (size_t f = 0; f < sizeof formats / sizeof *formats; f++) {
        const bool own_ending = f < 5;
        char one[64], other[64];
        assert_code(0, run("export a.rlog -o one --format %s --every 4 --force", formats[f]));
        assert_code(0, run("export a.rlog -o other --format %s --from %d --to 8 --every 4 --force --simd scalar",
                           formats[f], f == 4 || f == 6 ? 0 : 4)); /* one camera for all steps */
        char file[32];
        snprintf(file, sizeof file, "a_%s%s000004.%s", own_ending ? "" : formats[f], own_ending ? "" : "_",
                 own_ending ? formats[f] : "vtp");
        snprintf(one, sizeof one, "one/%s", file);
        snprintf(other, sizeof other, "other/%s", file);
        assert_files_same(one, other);
    }
}

static void export_refuses_with_a_message(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("export a.rlog -o kept --format vtp --step 3 --quiet"));
    assert_code(2, run("export a.rlog -o kept --format vtp --every 1"));
    assert_one_message("a_000003.vtp exists; give --force");
    assert_int_equal(file_size("kept/a_000000.vtp"), -1); /* refused before anything is written */
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
    assert_one_message("not a folder");
    /* A full disk leaves no file and no part of one. */
    const int status =
        system("trap '' XFSZ; ulimit -f 4; exec \"$RHEOLOG\" export a.rlog -o full --format csv --quiet "
               ">/dev/null 2>err.txt");
    read_file("err.txt", err, sizeof err);
    assert_true(WIFEXITED(status));
    assert_code(3, WEXITSTATUS(status));
    assert_in("cannot write", err);
    assert_int_equal(rmdir("full"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(export_has_its_keys),
        cmocka_unit_test(a_refused_export_prints_its_reason_as_json),
        cmocka_unit_test(several_formats_are_written_in_one_pass),
        cmocka_unit_test(a_stage_of_a_step_is_exported),
        cmocka_unit_test(surfaces_of_a_call_have_one_range_of_colours),
        cmocka_unit_test(options_that_do_not_fit_are_refused),
        cmocka_unit_test(a_long_name_is_refused),
        cmocka_unit_test(exports_are_the_same_whenever_made),
        cmocka_unit_test(export_refuses_with_a_message),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
