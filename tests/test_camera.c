/* The camera of pictures, what else they show, and the axes and colours of files. */
#define _XOPEN_SOURCE 700 /* mkdtemp() */
#include "view_support.h"

#include "melting.h"
#include "view/canvas.h"
#include "view/picture.h"
#include "view/vectors.h"

enum { WIDTH = 160, HEIGHT = 90, PIXELS = WIDTH * HEIGHT };

static const rheo_extent box = {{-3, 1, 5}, {5, 4, 6}, 0, 1};

/* The place of a point in the picture: from -1, left or below, to 1. */
static void place_of(const rheo__canvas *c, const double point[3], double place[2])
{
    double seen[3];
    rheo__canvas_point(c, point, seen);
    assert_true(seen[2] > 0);
    place[0] = seen[0] / seen[2] / (-c->left + .5 * c->step);
    place[1] = seen[1] / seen[2] / (c->top + .5 * c->step);
}

static rheo__canvas canvas_of(const rheo_camera *camera)
{
    rheo__canvas c;
    OK(rheo__canvas_make(&c, WIDTH, HEIGHT, &box, camera, false, &error));
    return c;
}

static double corner_of(int corner, int axis)
{
    return (corner >> axis & 1 ? box.max : box.min)[axis];
}

static void a_camera_sees_the_whole_region_from_anywhere(void **unused)
{
    (void)unused;
    const double target[3] = {2, 9, 5};
    for (int i = 0; i < 27; i++)
        for (int how = 0; how < 4; how++) {
            rheo_camera camera = rheo_default_camera();
            const double direction[3] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
            if (i == 13) /* no direction */
                continue;
            memcpy(camera.direction, direction, sizeof direction);
            camera.target = how & 1 ? target : NULL;
            camera.parallel = how & 2;
            rheo__canvas c = canvas_of(&camera);
            double nearest = 0, place[2];
            for (int corner = 0; corner < 8; corner++) {
                place_of(&c, (const double[3]){corner_of(corner, 0), corner_of(corner, 1), corner_of(corner, 2)},
                         place);
                for (int a = 0; a < 2; a++)
                    nearest = fmax(nearest, fabs(place[a]));
            }
            if (!(nearest < 1 && nearest > .5))
                fail_msg("direction %d, %d: the outermost corner is at %g", i, how, nearest);
            /* The middle of the picture, and y is up or, from above and below, x to the right. */
            const double middle[3] = {1, 2.5, 5.5}, *at = camera.target ? target : middle;
            place_of(&c, at, place);
            NEAR(place[0], 0, 1e-9);
            NEAR(place[1], 0, 1e-9);
            const bool steep = direction[0] == 0 && direction[2] == 0;
            place_of(&c, (const double[3]){at[0] + (steep ? .1 : 0), at[1] + (steep ? 0 : .1), at[2]}, place);
            NEAR(place[steep ? 1 : 0], 0, 1e-9);
            assert_true(place[steep ? 0 : 1] > 0);
            rheo__canvas_release(&c);
        }
}

static void zoom_enlarges_around_the_target(void **unused)
{
    (void)unused;
    const double point[3] = {1.5, 2.8, 5.2}, target[3] = {2, 3, 5};
    for (int parallel = 0; parallel < 2; parallel++) {
        rheo_camera camera = rheo_default_camera();
        double place[2][2];
        camera.target = target;
        camera.parallel = parallel;
        for (int k = 0; k < 2; k++) {
            camera.zoom = k ? 2.5 : 1;
            rheo__canvas c = canvas_of(&camera);
            place_of(&c, point, place[k]);
            rheo__canvas_release(&c);
        }
        for (int a = 0; a < 2; a++) {
            assert_true(fabs(place[0][a]) > .01);
            NEAR(place[1][a], 2.5 * place[0][a], 1e-9);
        }
    }
}

/* Edges of the region that are parallel stay so, within a hundredth; with perspective they do not. */
static void a_parallel_projection_keeps_parallel_lines(void **unused)
{
    (void)unused;
    for (int parallel = 0; parallel < 2; parallel++) {
        rheo_camera camera = rheo_default_camera();
        camera.parallel = parallel;
        rheo__canvas c = canvas_of(&camera);
        double away = 0;
        for (int axis = 0; axis < 3; axis++) {
            double first[2];
            for (int edge = 0; edge < 4; edge++) {
                double end[2][2], point[3];
                for (int k = 0; k < 2; k++) {
                    for (int a = 0; a < 3; a++)
                        point[a] = a == axis             ? corner_of(7 * k, a)
                                   : a == (axis + 1) % 3 ? corner_of(7 * (edge & 1), a)
                                                         : corner_of(7 * (edge >> 1), a);
                    place_of(&c, point, end[k]);
                }
                for (int k = 0; k < 2; k++) {
                    const double along = end[1][k] - end[0][k];
                    first[k] = edge == 0 ? along : first[k];
                    away = fmax(away, fabs(along - first[k]));
                }
            }
        }
        assert_true(parallel ? away < .02 : away > .1);
        rheo__canvas_release(&c);
    }
}

static void cameras_out_of_range_are_refused(void **unused)
{
    (void)unused;
    static unsigned char rgb[3 * PIXELS];
    static const double far[3] = {0, 2e30, 0};
    const struct {
        rheo_camera camera;
        const char *message;
    } cases[] = {{{.direction = {0, 0, 0}, .zoom = 1}, "direction"},
                 {{.direction = {NAN, 0, 1}, .zoom = 1}, "direction"},
                 {{.direction = {0, 0, 1e31}, .zoom = 1}, "direction"},
                 {{.direction = {0, 0, 1}, .zoom = 1, .target = far}, "target"},
                 {{.direction = {0, 0, 1}, .zoom = 0}, "zoom"},
                 {{.direction = {0, 0, 1}, .zoom = 1001}, "zoom"},
                 {{.direction = {0, 0, 1}, .zoom = NAN}, "zoom"}};
    rheo_world *world = world_of(inert_def(), 0, NULL, NULL);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rheo_picture_options options = rheo_default_picture_options();
        options.width = WIDTH;
        options.height = HEIGHT;
        options.camera = &cases[i].camera;
        REFUSED(RHEO_ERROR_ARGUMENT, cases[i].message, rheo_world_render(world, &options, rgb, &error));
    }
    rheo_world_destroy(world);
}

static void draw(const rheo_world *world, const rheo_camera *camera, const rheo_extent *extent, const char *colour,
                 unsigned char rgb[3 * PIXELS])
{
    const rheo_picture_options options = {.width = WIDTH,
                                          .height = HEIGHT,
                                          .extent = extent,
                                          .colour = colour,
                                          .without_captions = true,
                                          .camera = camera};
    OK(rheo_world_render(world, &options, rgb, &error));
}

/* A ball of fluid, seen from the front, the back, a side and below, is as light as from the front: the light moves. */
static void the_light_moves_around_with_the_camera(void **unused)
{
    (void)unused;
    static unsigned char rgb[3 * PIXELS];
    static const double directions[][3] = {{0, -.4, -1}, {0, -.4, 1}, {1, -.4, 0},
                                           {-1, -.4, 0}, {0, .5, -1}, {0, 1, 0}};
    cloud *c = new_cloud();
    add_ball(c, 5, 0, 0, 0);
    rheo_world *world = world_of(inert_def(), c->count, c->position, NULL);
    double first = 0;
    for (size_t i = 0; i < sizeof directions / sizeof *directions; i++) {
        rheo_camera camera = rheo_default_camera();
        memcpy(camera.direction, directions[i], sizeof camera.direction);
        draw(world, &camera, NULL, "none", rgb);
        double sum = 0;
        for (int row = HEIGHT / 2 - 15; row < HEIGHT / 2 + 15; row++)
            for (int column = WIDTH / 2 - 15; column < WIDTH / 2 + 15; column++)
                sum += rgb[3 * (row * WIDTH + column)];
        first = i == 0 ? sum : first;
        if (!(sum > .85 * first && sum < 1.15 * first))
            fail_msg("direction %zu is %g times as light as the first", i, sum / first);
    }
    rheo_world_destroy(world);
    free(c);
}

/* A vibrator that no fluid hides is a brown stud at its place in the floor. */
static void vibrators_are_studs_in_the_floor(void **unused)
{
    (void)unused;
    static unsigned char rgb[3 * PIXELS], without[3 * PIXELS];
    const rheo_wall floor = {{0, 2, 0}, {0, 1, 0}};
    static const double at[1][2] = {{3, -2}};
    rheo_world_def def = inert_def();
    def.walls.count = 1;
    def.walls.plane = &floor;
    const rheo_extent extent = {{-5, 0, -5}, {5, 5, 5}, 0, 1};
    rheo_world *world = world_of(def, 0, NULL, NULL);
    draw(world, NULL, &extent, NULL, without);
    rheo_world_destroy(world);
    def.vibrators.position = at;
    def.vibrators.count = 1;
    world = world_of(def, 0, NULL, NULL);
    draw(world, NULL, &extent, NULL, rgb);
    rheo__canvas c;
    OK(rheo__canvas_make(&c, WIDTH, HEIGHT, &extent, NULL, false, &error));
    double place[2];
    place_of(&c, (const double[3]){3, 2, -2}, place);
    int brown = 0;
    for (int row = 0; row < HEIGHT; row++)
        for (int column = 0; column < WIDTH; column++) {
            const unsigned char *p = rgb + 3 * (row * WIDTH + column);
            if (memcmp(p, without + 3 * (row * WIDTH + column), 3) == 0 || p[0] < p[2] + 40)
                continue;
            brown++;
            const double x = (2. * column + 1) / WIDTH - 1 - place[0], y = 1 - (2. * row + 1) / HEIGHT - place[1];
            assert_true(fabs(x) < .1 && fabs(y) < .2);
        }
    assert_true(brown > 3);
    rheo__canvas_release(&c);
    rheo_world_destroy(world);
}

/* ---- Materials ---- */

/* Each of four materials has its name and a quarter of the bar, in the colour of its particles. */
static void a_bar_of_materials_has_their_names_and_colours(void **unused)
{
    (void)unused;
    static const char *const NAMES[] = {"main", "oil", "starch", "clay"};
    const rheo_real position[12] = {0, 0, 0, 3, 0, 0, 6, 0, 0, 9, 0, 0};
    const uint32_t material[4] = {3, 0, 2, 1};
    rheo_world_def def = inert_def();
    def.particles.material = material;
    for (int k = 1; k < 4; k++) {
        const rheo_material other = rheo_default_material(NAMES[k]);
        OK(rheo_world_def_add_material(&def, &other, &error));
    }
    rheo_world *world = world_of(def, 4, position, NULL);
    rheo_picture_options options = {.width = 640, .height = 360, .colour = "material"};
    double range[2];
    OK(rheo_world_colour_range(world, &options, range, &error));
    assert_true(range[0] == 0 && range[1] == 3);
    rheo__label label[RHEO__LABELS];
    assert_int_equal(rheo__material_labels(rheo_world_definition(world), range, label), 4);
    for (int k = 0; k < 4; k++) {
        assert_string_equal(label[k].text, NAMES[k]);
        NEAR(label[k].place, k / 3., 1e-12);
    }
    /* A range that leaves some out. */
    assert_int_equal(rheo__material_labels(rheo_world_definition(world), (const double[2]){.5, 2}, label), 2);
    assert_string_equal(label[1].text, "starch");
    assert_int_equal(rheo__material_labels(rheo_world_definition(world), (const double[2]){.2, .8}, label), 0);
    unsigned char *rgb = malloc(3 * 640 * 360);
    OK(rheo_world_render(world, &options, rgb, &error));
    const double bottom = .84 * 360, length = .62 * 360;
    for (int row = (int)(bottom - length) + 2; row < (int)bottom - 2; row++) {
        const double place = (bottom - row - .5) / length;
        const int part = (int)(4 * place);
        double colour[3];
        rheo__scale_colour(part / 3., colour);
        int found = 0;
        for (int column = 560; column < 640; column++) {
            const unsigned char *p = rgb + 3 * (row * 640 + column);
            found += fabs(p[0] - 255 * colour[0]) < 1 && fabs(p[1] - 255 * colour[1]) < 1 &&
                     fabs(p[2] - 255 * colour[2]) < 1;
        }
        if (found < 8 && fabs(4 * place - part - .5) < .45)
            fail_msg("row %d does not have the colour of %s", row, NAMES[part]);
    }
    options.range = (const double[2]){.2, .8};
    OK(rheo_world_render(world, &options, rgb, &error));
    free(rgb);
    rheo_world_destroy(world);
}

/* ---- Captions ---- */

/* Letters in front of something dark are on a pale halo. */
static void captions_can_be_read_in_front_of_anything(void **unused)
{
    (void)unused;
    enum { SIDE = 100 };
    static unsigned char rgb[2][3 * SIDE * SIDE];
    for (int dark = 0; dark < 2; dark++) {
        const rheo__sheet sheet = {rgb[dark], SIDE, SIDE};
        memset(rgb[dark], dark ? 20 : 235, sizeof rgb[dark]);
        rheo__sheet_text(&sheet, 20, 60, 20, "88");
    }
    int ink = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        if (rgb[0][3 * i] > 60)
            continue;
        ink++;
        int pale = 0; /* near the ink of the picture on white, that on black is pale */
        for (int k = -6; k <= 6; k++)
            for (int j = -6; j <= 6; j++)
                pale += rgb[1][3 * (i + k * SIDE + j)] > 150;
        assert_true(pale > 5);
    }
    assert_true(ink > 50);
}

/* ---- The same bytes everywhere ---- */

static uint64_t hash_of(const unsigned char *bytes, size_t size)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325); /* FNV-1a */
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
    return hash;
}

/* Two times, and with every SIMD variant: pictures from another camera, and the files of all formats. */
static void everything_has_the_same_bytes_twice_and_in_every_variant(void **unused)
{
    (void)unused;
    enum { OUTPUTS = 32 };
    static unsigned char rgb[3 * PIXELS];
    const char *best = rheo_simd(), *name;
    const double target[3] = {3, 1, 2};
    const rheo_camera camera = {.direction = {1, -.3, .5}, .target = target, .zoom = 1.7, .parallel = true};
    const rheo_surface_options surface = rheo_default_surface_options();
    for (int model = 0; model < 2; model++) {
        uint64_t first[OUTPUTS];
        for (uint32_t variant = 0; (name = rheo_simd_available(variant / 2)) != NULL; variant++) {
            OK(rheo_use_simd(name, &error));
            rheo_world *world = model ? melting_world(6, NULL) : lively_world();
            uint32_t k = 0;
            uint64_t hash[OUTPUTS];
            step(world, 5);
            for (; k < 4; k++) {
                const rheo_picture_options options = {.width = WIDTH,
                                                      .height = HEIGHT,
                                                      .colour = k & 1 ? "pressure" : NULL,
                                                      .camera = &camera,
                                                      .surface = k & 2 ? &surface : NULL};
                OK(rheo_world_render(world, &options, rgb, &error));
                hash[k] = hash_of(rgb, sizeof rgb);
            }
            for (uint32_t f = 0; rheo_export_format_name(f); f++)
                for (int turned = 0; turned < 2; turned++, k++) {
                    size_t size;
                    const rheo_export_options options = {
                        .surface = surface, .force = true, .z_up = turned, .colour = turned ? "velocity" : NULL};
                    OK(rheo_world_export(world, (rheo_export_format)f, "same", &options, NULL, &error));
                    unsigned char *bytes = (unsigned char *)read_file("same", &size);
                    hash[k] = hash_of(bytes, size);
                    free(bytes);
                }
            assert_true(k <= OUTPUTS);
            for (uint32_t i = 0; i < k; i++) {
                if (variant && hash[i] != first[i])
                    fail_msg("%s: output %u of model %d differs", name, i, model);
                first[i] = hash[i];
                for (uint32_t other = 0; other < i;
                     other++) /* each is something else, but for colours that none has */
                    assert_true(hash[other] != hash[i]);
            }
            rheo_world_destroy(world);
        }
    }
    OK(rheo_use_simd(best, &error));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_camera_sees_the_whole_region_from_anywhere),
        cmocka_unit_test(zoom_enlarges_around_the_target),
        cmocka_unit_test(a_parallel_projection_keeps_parallel_lines),
        cmocka_unit_test(cameras_out_of_range_are_refused),
        cmocka_unit_test(the_light_moves_around_with_the_camera),
        cmocka_unit_test(vibrators_are_studs_in_the_floor),
        cmocka_unit_test(a_bar_of_materials_has_their_names_and_colours),
        cmocka_unit_test(captions_can_be_read_in_front_of_anything),
        cmocka_unit_test(everything_has_the_same_bytes_twice_and_in_every_variant),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
