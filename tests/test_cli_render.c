/* `rheolog render` from outside. */
#include "cli_support.h"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#ifdef WITH_PNG
#include <png.h>

/* Reads a picture with libpng, which checks its check sums. */
static unsigned char *read_png(const char *path, uint32_t width, uint32_t height)
{
    png_image image = {.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_file(&image, path))
        fail_msg("%s: %s", path, image.message);
    assert_int_equal(image.width, width);
    assert_int_equal(image.height, height);
    assert_int_equal(image.format, PNG_FORMAT_RGB);
    unsigned char *rgb = malloc((size_t)3 * width * height);
    assert_non_null(rgb);
    assert_true(png_image_finish_read(&image, NULL, rgb, 0, NULL));
    return rgb;
}

/* The range that a call chooses for its pictures. */
static void printed_range(double range[2])
{
    const char *at = out;
    range[0] = number_after(&at, "range_min");
    range[1] = number_after(&at, "range_max");
}

static void a_picture_has_the_pixels_of_the_library(void **state)
{
    (void)state;
    static const char *const keys[] = {"file",  "output", "files",     "first_step", "last_step",
                                       "width", "height", "range_min", "range_max",  NULL};
    record("a.rlog");
    assert_code(0, run("render a.rlog -o a.png --step 5 --size 320x200 --json"));
    assert_keys(out, keys);
    assert_string_equal(value_of("output"), "\"a.png\"");
    assert_string_equal(value_of("files"), "1");
    assert_string_equal(value_of("first_step"), "5");
    assert_string_equal(value_of("last_step"), "5");
    assert_string_equal(value_of("width"), "320");
    assert_string_equal(value_of("height"), "200");
    double range[2];
    printed_range(range);
    unsigned char *read = read_png("a.png", 320, 200), *made = malloc(3 * 320 * 200);
    rheo_world *world = checkpoint_at("a.rlog", 5);
    rheo_picture_options options = rheo_default_picture_options();
    options.width = 320;
    options.height = 200;
    assert_int_equal(rheo_world_render(world, &options, made, NULL), RHEO_OK);
    assert_memory_equal(made, read, 3 * 320 * 200);
    free(read);
    /* All options that change pixels. */
    assert_code(0, run("render a.rlog -o b.png --step 5 --size 320x200 --color density --range -1.5,2.5 --surface "
                       "--isovalue .4 --resolution 1 --bare --json"));
    assert_string_equal(value_of("range_min"), "-1.5");
    assert_string_equal(value_of("range_max"), "2.5");
    const rheo_surface_options surface = {.isovalue = .4, .resolution = 1};
    options.colour = "density";
    options.range = (const double[]){-1.5, 2.5};
    options.surface = &surface;
    options.without_captions = true;
    assert_int_equal(rheo_world_render(world, &options, made, NULL), RHEO_OK);
    read = read_png("b.png", 320, 200);
    assert_memory_equal(made, read, 3 * 320 * 200);
    free(read);
    free(made);
    rheo_world_destroy(world);
    /* Without --size and --step: the last step in the usual size. */
    assert_code(0, run("render a.rlog -o c.png"));
    assert_string_equal(out, "c.png\n");
    free(read_png("c.png", 1280, 720));
}

/* The options of the camera are those of the library; a picture from above differs from the usual one. */
static void the_camera_can_be_placed(void **state)
{
    (void)state;
    record("a.rlog");
    const double target[3] = {3, 2.5, -1};
    const struct {
        const char *options;
        rheo_camera camera;
    } cases[] = {{"", {.direction = {-.42, -.5, -1}, .zoom = 1}},
                 {"--look 0,-1,0", {.direction = {0, -1, 0}, .zoom = 1}},
                 {"--look -1,-.5,.25 --target 3,2.5,-1 --zoom 1.5 --parallel",
                  {.direction = {-1, -.5, .25}, .target = target, .zoom = 1.5, .parallel = true}}};
    rheo_world *world = checkpoint_at("a.rlog", 5);
    unsigned char *made = malloc(3 * 160 * 90), *first = malloc(3 * 160 * 90);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rheo_picture_options options = rheo_default_picture_options();
        options.width = 160;
        options.height = 90;
        options.camera = &cases[i].camera;
        assert_code(0, run("render a.rlog -o view.png --force --step 5 --size 160x90 %s", cases[i].options));
        assert_int_equal(rheo_world_render(world, &options, made, NULL), RHEO_OK);
        unsigned char *read = read_png("view.png", 160, 90);
        assert_memory_equal(made, read, 3 * 160 * 90);
        free(read);
        assert_true(i == 0 || memcmp(made, first, 3 * 160 * 90) != 0);
        memcpy(first, made, 3 * 160 * 90);
    }
    free(made);
    free(first);
    rheo_world_destroy(world);
}

/* The least and the largest value may be in any of the pictures that the range is chosen from. */
static void a_range_of_a_film_has_the_extremes_of_its_pictures(void **state)
{
    (void)state;
    static const char *const COLOURS[] = {"speed", "density", "pressure", "near_density", "velocity", "position"};
    unsigned least_in = 0, most_in = 0; /* sets of pictures */
    record("a.rlog");
    for (size_t c = 0; c < sizeof COLOURS / sizeof *COLOURS; c++) {
        double range[2], least = 0, most = 0;
        int least_step = 0, most_step = 0;
        assert_code(0, run("render a.rlog -o film%zu --every 4 --size 64x64 --color %s --json", c, COLOURS[c]));
        printed_range(range);
        for (int step = 0; step <= 8; step += 4) {
            double own[2];
            rheo_world *world = checkpoint_at("a.rlog", step);
            const rheo_picture_options options = {.width = 64, .height = 64, .colour = COLOURS[c]};
            assert_int_equal(rheo_world_colour_range(world, &options, own, NULL), RHEO_OK);
            if (step == 0 || own[0] < least) {
                least = own[0];
                least_step = step;
            }
            if (step == 0 || own[1] > most) {
                most = own[1];
                most_step = step;
            }
            rheo_world_destroy(world);
        }
        assert_true(range[0] == least && range[1] == most);
        least_in |= 1u << least_step;
        most_in |= 1u << most_step;
    }
    assert_true((least_in & (least_in - 1)) != 0 && (most_in & (most_in - 1)) != 0); /* not always the same picture */
}

/* The camera and the colours fit the first and the last step, so one step alone looks different from the same in a film. */
static void pictures_of_a_film_have_one_camera_and_one_range(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("render a.rlog -o film --every 4 --size 160x90 --json"));
    assert_string_equal(value_of("files"), "3");
    assert_string_equal(value_of("first_step"), "0");
    assert_string_equal(value_of("last_step"), "8");
    double range[2];
    printed_range(range);
    unsigned char *made = malloc(3 * 160 * 90);
    rheo_extent extent;
    double least = 0, most = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int step = 0; step <= 8; step += 4) {
            char path[32];
            double own[2];
            rheo_world *world = checkpoint_at("a.rlog", step);
            const rheo_extent its = rheo_world_extent(world);
            assert_int_equal(rheo_world_colour_range(world, &(rheo_picture_options){.width = 16}, own, NULL),
                             RHEO_OK);
            if (pass == 0) {
                least = step == 0 || own[0] < least ? own[0] : least;
                most = step == 0 || own[1] > most ? own[1] : most;
                extent = step == 0 ? its : step == 8 ? rheo_extent_of_both(&extent, &its) : extent;
            } else {
                rheo_picture_options options = rheo_default_picture_options();
                options.width = 160;
                options.height = 90;
                options.extent = &extent;
                options.range = range;
                assert_int_equal(rheo_world_render(world, &options, made, NULL), RHEO_OK);
                snprintf(path, sizeof path, "film/a_%06d.png", step);
                unsigned char *read = read_png(path, 160, 90);
                assert_memory_equal(made, read, 3 * 160 * 90);
                free(read);
            }
            rheo_world_destroy(world);
        }
    assert_true(range[0] == least && range[1] == most);
    free(made);
    /* The same bytes again, with other loops and in another order. */
    assert_code(0, run("render a.rlog -o again --from 0 --to 8 --every 4 --size 160x90 --simd scalar --quiet"));
    assert_string_equal(out, "again/a_000000.png\nagain/a_000004.png\nagain/a_000008.png\n");
    assert_files_same("film/a_000004.png", "again/a_000004.png");
    assert_files_same("film/a_000008.png", "again/a_000008.png");
    /* A list of steps has the camera of its first and its last one. */
    assert_code(0, run("render a.rlog -o list --steps 0,3,4,8 --size 160x90 --quiet"));
    assert_string_equal(out, "list/a_000000.png\nlist/a_000003.png\nlist/a_000004.png\nlist/a_000008.png\n");
    assert_files_same("film/a_000000.png", "list/a_000000.png");
    assert_files_same("film/a_000008.png", "list/a_000008.png");
}

static void a_stage_of_a_step_is_drawn(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("render a.rlog -o before.png --step 4 --size 160x90"));
    assert_code(0, run("render a.rlog -o in.png --step 5 --stage forces --size 160x90"));
    assert_code(0, run("render a.rlog -o after.png --step 5 --size 160x90"));
    size_t size[2];
    static char first[1 << 20];
    memcpy(first, read_bytes("in.png", &size[0]), sizeof first);
    const char *second = read_bytes("after.png", &size[1]);
    assert_true(size[0] != size[1] || memcmp(first, second, size[0]) != 0);
    assert_code(2, run("render a.rlog -o no.png --step 5 --stage nothing"));
    assert_one_message("nothing");
    assert_code(2, run("render a.rlog -o no.png --stage forces"));
    assert_one_message("--stage needs --step");
    assert_int_equal(file_size("no.png"), -1);
}

/* A recording that begins with another velocity of the ball differs more and more; one compared with itself not at all. */
static void the_difference_of_two_recordings_is_drawn(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(0, run("run --from a.rlog@2 --steps 6 --set ball.velocity=[0,-60,0] -o b.rlog"));
    assert_code(0, run("render a.rlog -o same.png --compare a.rlog --size 64x64 --json"));
    double range[2], later[2];
    printed_range(range);
    assert_true(range[0] == 0 && range[1] == 0);
    assert_code(0, run("render b.rlog -o d.png --step 4 --compare a.rlog --size 64x64 --json"));
    printed_range(range);
    assert_code(0, run("render b.rlog -o d.png --step 8 --compare a.rlog --size 64x64 --json --force"));
    printed_range(later);
    assert_true(range[1] > 0 && later[1] > range[1]);
    assert_code(0, run("render b.rlog -o d --from 4 --every 2 --compare a.rlog --color speed --size 64x64"));
    assert_code(2, run("render a.rlog -o e.png --compare b.rlog --step 1"));
    assert_one_message("b.rlog holds steps 2 to 8; step 1");
    assert_code(2, run("render a.rlog -o e.png --compare none.rlog"));
    assert_one_message("none.rlog");
    assert_int_equal(file_size("e.png"), -1);
}

static void temperatures_are_the_colours_of_a_melting_world(void **state)
{
    (void)state;
    record_melting("melting.rlog", "--steps 2");
    assert_code(0, run("render melting.rlog -o m.png --size 160x90 --json"));
    double range[2], temperatures[2];
    printed_range(range);
    assert_code(0, run("render melting.rlog -o m.png --size 160x90 --json --force --color temperature"));
    printed_range(temperatures);
    assert_true(range[0] == temperatures[0] && range[1] == temperatures[1] && range[0] < range[1]);
    assert_code(2, run("render melting.rlog -o n.png --color stiffness"));
    assert_one_message("temperature");
}

static void render_refuses_with_a_message(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"a.rlog -o kept.png", "kept.png exists; give --force"},
        {"a.rlog -o kept --every 1", "a_000003.png exists; give --force"},
        {"a.rlog -o new.png --step 9", "steps 0 to 8; --step 9"},
        {"a.rlog -o film --from 5 --to 4", "--from 5"},
        {"a.rlog -o film --from 9", "--from 9"},
        {"a.rlog -o new --steps 3,9", "--steps 9"},
        {"b.rlog -o new --steps 1,9", "b.rlog holds steps 2 to 8; --steps 1"},
        {"a.rlog -o no/such/a.png", "there is no folder no/such"},
        {"a.rlog -o no/such --every 2", "cannot make the folder no/such"},
        {"a.rlog -o new.png --color hue", "\"hue\""},
        {"a.rlog -o new.png --color temperature", "none, position, velocity, speed"},
        {"a.rlog -o new.png --color hue --range 1,2", "\"hue\""},
        {"a.rlog -o new.png --simd none", "\"none\""},
        {"none.rlog -o new.png", "none.rlog"},
        {"tiny.json -o new.png", "tiny.json"},
    };
    record("a.rlog");
    assert_code(0, run("render a.rlog -o kept.png --size 16x16"));
    assert_code(0, run("render a.rlog -o kept --from 3 --to 3 --size 16x16"));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_code(2, run("render %s", cases[i][0]));
        assert_one_message(cases[i][1]);
    }
    assert_int_equal(file_size("new.png"), -1);
    assert_int_equal(file_size("kept/a_000000.png"), -1); /* refused before anything is written */
    assert_code(0, run("render a.rlog -o kept.png --size 32x32 --force"));
    free(read_png("kept.png", 32, 32));
    /* A full disk leaves no file and no part of one. */
    assert_int_equal(mkdir("full", 0777), 0);
    const int status = system("trap '' XFSZ; ulimit -f 4; exec \"$RHEOLOG\" render a.rlog -o full/a.png --quiet "
                              ">/dev/null 2>err.txt");
    read_file("err.txt", err, sizeof err);
    assert_true(WIFEXITED(status));
    assert_code(3, WEXITSTATUS(status));
    assert_in("cannot write", err);
    assert_int_equal(rmdir("full"), 0);
}
#else
static void without_libpng_the_command_says_so(void **state)
{
    (void)state;
    record("a.rlog");
    assert_code(2, run("render a.rlog -o new.png"));
    assert_one_message("built without pictures; build it with libpng");
    assert_int_equal(file_size("new.png"), -1);
}
#endif

static void usage_is_checked(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"-o new.png", "one recording; got 0"},
        {"a b -o new.png", "one recording; got 2"},
        {"none.rlog", "needs -o"},
        {"none.rlog -o -", "standard output"},
        {"none.rlog -o a.jpg", "ends with .png; got \"a.jpg\""},
        {"none.rlog -o new.png --every 2", "needs a folder"},
        {"none.rlog -o a --every 0", "--every needs 1"},
        {"none.rlog -o new.png --step 2 --to 3", "--step N is one step"},
        {"none.rlog -o new.png --steps 2,4", "needs a folder"},
        {"none.rlog -o a --steps 2,4 --step 3", "--step N is one step"},
        {"none.rlog -o a --steps 2,4 --every 3", "--steps lists all steps"},
        {"none.rlog -o a --steps 2,2", "that ascend, such as 0,20,50; got \"2,2\""},
        {"none.rlog -o a --steps 2,,4", "that ascend"},
        {"none.rlog -o a --steps 2,4x", "that ascend"},
        {"none.rlog -o new.png --size 1280", "--size needs WxH"},
        {"none.rlog -o new.png --size 15x90", "--size needs WxH"},
        {"none.rlog -o new.png --size 160x4097", "16 to 4096"},
        {"none.rlog -o new.png --size 160x90x3", "--size needs WxH"},
        {"none.rlog -o new.png --size x90", "--size needs WxH"},
        {"none.rlog -o new.png --range 3", "--range needs MIN,MAX"},
        {"none.rlog -o new.png --range 3,", "--range needs a number"},
        {"none.rlog -o new.png --range 3,nan", "--range needs a number"},
        {"none.rlog -o new.png --range 3,2", "MIN below MAX"},
        {"none.rlog -o new.png --range 2,2", "MIN below MAX"},
        {"none.rlog -o new.png --range 1,2 --color none", "--color none"},
        {"none.rlog -o new.png --look 0,1", "--look needs 3 numbers"},
        {"none.rlog -o new.png --look 0,0,0", "--look needs a direction, such as 0,-1,0 from above; got \"0,0,0\""},
        {"none.rlog -o new.png --look 0,0,x", "--look needs a number"},
        {"none.rlog -o new.png --target 1,2,3,4", "--target needs 3 numbers"},
        {"none.rlog -o new.png --zoom 0", "--zoom needs a number between 0.01 and 1000"},
        {"none.rlog -o new.png --isovalue .5", "--surface"},
        {"none.rlog -o new.png --resolution 2", "--surface"},
        {"none.rlog -o new.png --surface --isovalue 1", "--isovalue"},
        {"none.rlog -o new.png --surface --resolution 9", "--resolution"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_code(2, run("render %s", cases[i][0]));
        assert_one_message(cases[i][1]);
    }
    assert_int_equal(file_size("new.png"), -1);
}

/* Regression: it printed nothing. */
static void json_says_why_nothing_is_drawn(void **state)
{
    (void)state;
    assert_code(2, run("render none.rlog -o new.png --json"));
    assert_in("{\"file\": \"none.rlog\", \"output\": \"new.png\", \"outcome\": \"refused\", \"reason\": \"", out);
    assert_in("\"files\": 0}\n", out);
    assert_code(2, run("render -o new.png --json"));
    assert_in("{\"file\": null, ", out);
    assert_in("one recording; got 0", out);
#ifdef WITH_PNG
    record("a.rlog");
    assert_code(0, run("render a.rlog -o new.png --size 16x16 --json"));
    assert_in("\"outcome\": \"done\", \"reason\": null, \"files\": 1, \"first_step\": 8, ", out);
    assert_code(2, run("render a.rlog -o new.png --size 16x16 --json"));
    assert_in("\"outcome\": \"refused\", \"reason\": \"new.png exists; give --force", out);
    /* A film of which some pictures are drawn: the last steps are not as they were recorded. */
    falsify_step("a.rlog", "b.rlog", 6);
    assert_code(1, run("render b.rlog -o film --every 1 --size 16x16 --range 0,1 --json"));
    assert_in("\"outcome\": \"differs\", \"reason\": \"", out);
    assert_in("\"files\": 0}", out); /* all steps are looked at first */
    remove("new.png");
#endif
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#ifdef WITH_PNG
        cmocka_unit_test(a_picture_has_the_pixels_of_the_library),
        cmocka_unit_test(the_camera_can_be_placed),
        cmocka_unit_test(a_range_of_a_film_has_the_extremes_of_its_pictures),
        cmocka_unit_test(pictures_of_a_film_have_one_camera_and_one_range),
        cmocka_unit_test(a_stage_of_a_step_is_drawn),
        cmocka_unit_test(the_difference_of_two_recordings_is_drawn),
        cmocka_unit_test(temperatures_are_the_colours_of_a_melting_world),
        cmocka_unit_test(render_refuses_with_a_message),
#else
        cmocka_unit_test(without_libpng_the_command_says_so),
#endif
        cmocka_unit_test(usage_is_checked),
        cmocka_unit_test(json_says_why_nothing_is_drawn),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
