/* Pictures that the library draws: geometry, colours, captions, and the same bytes everywhere. */
#define _XOPEN_SOURCE 700 /* mkdtemp() */
#include "view_support.h"

#include "melting.h"
#include "view/canvas.h"
#include "view/picture.h"
#include "view/vectors.h"

enum { WIDTH = 160, HEIGHT = 90, PIXELS = WIDTH * HEIGHT };

static const rheo_extent cube = {{-1, -1, -1}, {1, 1, 1}, 0, 1};

static rheo__canvas new_canvas(void)
{
    rheo__canvas c;
    OK(rheo__canvas_make(&c, WIDTH, HEIGHT, &cube, NULL, false, &error));
    return c;
}

static const rheo__sample *sample_at(const rheo__canvas *c, uint32_t column, uint32_t row)
{
    return &c->sample[(size_t)row * c->width + column];
}

/* ---- Which thing a sample shows ---- */

/* A ray meets a sphere if |ray x centre| <= radius |ray|. Samples nearer to the edge than rounding may be either. */
static void check_silhouette(const double centre[3], double radius)
{
    rheo__canvas c = new_canvas();
    const rheo__ball ball = {{centre[0], centre[1], centre[2]}, radius, 7, NULL};
    rheo__draw_sphere(&c, &ball);
    int hits = 0, misses = 0;
    for (uint32_t row = 0; row < c.height; row++)
        for (uint32_t column = 0; column < c.width; column++) {
            const rheo__sample *s = sample_at(&c, column, row);
            double ray[3], cross[3];
            rheo__canvas_ray(&c, column, row, ray);
            rheo__view_cross(ray, centre, cross);
            const double away = rheo__view_length(cross) / rheo__view_length(ray) - radius;
            if (away < -1e-9) {
                assert_int_equal(s->paint, 7);
                hits++;
            } else if (away > 1e-9) {
                assert_int_equal(s->paint, RHEO__PAINT_NONE);
                misses++;
            }
            if (s->paint != 7)
                continue;
            double square = 0, towards = 0;
            for (int a = 0; a < 3; a++) {
                const double from = (double)s->depth * ray[a] - centre[a];
                NEAR(s->normal[a], from / radius * RHEO__NORMAL, 40); /* of a depth of 24 bits */
                square += from * from;
                towards += from * ray[a];
            }
            NEAR(square, radius * radius, 1e-4 * radius * radius);
            assert_true(towards < 1e-3 * radius); /* the near side */
        }
    assert_true(hits > 50 && misses > 50);
    rheo__canvas_release(&c);
}

static void a_sphere_has_the_silhouette_of_its_tangent_cone(void **unused)
{
    (void)unused;
    check_silhouette((const double[]){0, 0, 8}, 1);
    check_silhouette((const double[]){1.5, -.8, 6}, .7);
    check_silhouette((const double[]){-3.1, 1.6, 8}, 1); /* partly outside the picture */
    check_silhouette((const double[]){.1, .1, 1.2}, .3);
    /* Nothing is seen of a sphere around or behind the eye. */
    rheo__canvas c = new_canvas();
    const rheo__ball around = {{0, 0, .5}, 1, 7, NULL}, behind = {{0, 0, -5}, 1, 7, NULL};
    rheo__draw_sphere(&c, &around);
    rheo__draw_sphere(&c, &behind);
    for (uint32_t i = 0; i < c.width * c.height; i++)
        assert_int_equal(c.sample[i].paint, RHEO__PAINT_NONE);
    rheo__canvas_release(&c);
}

/*
 * The rays of the samples are equally far apart, and those of the picture without its colour bar, which takes 0.13 of the
 * width at the right, lie alike around the middle. The camera sees the extent there.
 */
static void a_colour_bar_takes_its_part_of_the_width(void **unused)
{
    (void)unused;
    for (int bar = 0; bar < 2; bar++) {
        rheo__canvas c;
        OK(rheo__canvas_make(&c, WIDTH, HEIGHT, &cube, NULL, bar, &error));
        assert_true(c.width == RHEO__SAMPLES * WIDTH && c.height == RHEO__SAMPLES * HEIGHT);
        const double up = .23, aside = .23 * WIDTH / HEIGHT, part = bar ? .13 : 0, step = 2 * up / c.height;
        for (uint32_t row = 0; row < c.height; row += c.height - 1)
            for (uint32_t column = 0; column < c.width; column += c.width - 1) {
                double ray[3];
                rheo__canvas_ray(&c, column, row, ray);
                NEAR(ray[0] / ray[2], (column + .5) * step - aside * (1 - part), 1e-12);
                NEAR(ray[1] / ray[2], up - (row + .5) * step, 1e-12);
            }
        const rheo__camera camera = rheo__camera_for(&cube, NULL, aside * (1 - part), up);
        for (int a = 0; a < 3; a++)
            NEAR(c.camera.eye[a], camera.eye[a], 1e-9);
        /* Corners of the extent are in that part of the picture, and one touches its edge. */
        double nearest = 1;
        for (int corner = 0; corner < 8; corner++) {
            const double point[3] = {corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1};
            double seen[3];
            rheo__canvas_point(&c, point, seen);
            const double x = 1 - fabs(seen[0] / seen[2]) / (aside * (1 - part)), y = 1 - fabs(seen[1] / seen[2]) / up;
            assert_true(x > -1e-9 && y > -1e-9);
            nearest = fmin(nearest, fmin(x, y));
        }
        assert_true(nearest < .3);
        rheo__canvas_release(&c);
    }
}

static void the_nearest_thing_is_seen_in_any_order(void **unused)
{
    (void)unused;
    enum { COUNT = 40 };
    rheo__ball ball[COUNT];
    uint64_t seed = 1;
    for (int i = 0; i < COUNT; i++) {
        ball[i] = (rheo__ball){.radius = .2 + .4 * random_number(&seed), .paint = (uint16_t)i};
        for (int a = 0; a < 3; a++)
            ball[i].centre[a] = (a == 2 ? 7 : 0) + 3 * random_number(&seed) - 1.5;
    }
    rheo__canvas forwards = new_canvas(), backwards = new_canvas();
    for (int i = 0; i < COUNT; i++) {
        rheo__draw_sphere(&forwards, &ball[i]);
        rheo__draw_sphere(&backwards, &ball[COUNT - 1 - i]);
    }
    int seen = 0;
    for (uint32_t k = 0; k < forwards.width * forwards.height; k++) {
        const rheo__sample *s = &forwards.sample[k], *t = &backwards.sample[k];
        assert_true(s->depth == t->depth && s->paint == t->paint);
        /* Of all spheres on the ray, none is nearer. */
        double ray[3];
        rheo__canvas_ray(&forwards, k % forwards.width, k / forwards.width, ray);
        for (int i = 0; i < COUNT; i++) {
            const double square = rheo__view_dot(ray, ray), middle = rheo__view_dot(ray, ball[i].centre);
            const double root = middle * middle - square * (rheo__view_dot(ball[i].centre, ball[i].centre) -
                                                            ball[i].radius * ball[i].radius);
            if (root > 1e-9)
                assert_true((double)s->depth <= (middle - sqrt(root)) / square + 1e-5);
        }
        seen += s->paint != RHEO__PAINT_NONE;
    }
    assert_true(seen > 1000);
    rheo__canvas_release(&forwards);
    rheo__canvas_release(&backwards);
}

/* Draws the triangle 0, 1, 2 of corners of a square that is tilted in depth; its plane is z = 6 + x / 2. */
static void draw_half(rheo__canvas *c, const int which[3])
{
    static const double SQUARE[4][2] = {{-1.1, -.9}, {1.3, -1}, {1.2, 1}, {-1, 1.1}};
    double corner[3][3], normal[3][3] = {{0, 0, -1}, {0, 0, -1}, {0, 0, -1}};
    const double shade[3] = {0, .5, 1};
    for (int k = 0; k < 3; k++) {
        corner[k][0] = SQUARE[which[k]][0];
        corner[k][1] = SQUARE[which[k]][1];
        corner[k][2] = 6 + .5 * corner[k][0];
    }
    rheo__draw_triangle(c, (const double(*)[3])corner, (const double(*)[3])normal, shade, 0);
}

/* Two triangles cover a square without a gap, and only from the front. */
static void triangles_fit_together(void **unused)
{
    (void)unused;
    rheo__canvas one = new_canvas(), both = new_canvas(), back = new_canvas();
    draw_half(&one, (const int[]){0, 1, 2});
    draw_half(&both, (const int[]){0, 1, 2});
    draw_half(&both, (const int[]){0, 2, 3});
    draw_half(&back, (const int[]){0, 2, 1});
    int halves = 0, covered = 0;
    for (uint32_t row = 0; row < both.height; row++) {
        int first = -1, last = -1, count = 0;
        for (uint32_t column = 0; column < both.width; column++) {
            const rheo__sample *s = sample_at(&both, column, row);
            assert_int_equal(sample_at(&back, column, row)->paint, RHEO__PAINT_NONE);
            halves += sample_at(&one, column, row)->paint != RHEO__PAINT_NONE;
            if (s->paint == RHEO__PAINT_NONE)
                continue;
            double ray[3];
            rheo__canvas_ray(&both, column, row, ray);
            NEAR(s->depth, 6 / (1 - .5 * ray[0]), 1e-5);
            first = first < 0 ? (int)column : first;
            last = (int)column;
            count++;
        }
        assert_int_equal(count, first < 0 ? 0 : last - first + 1);
        covered += count;
    }
    assert_true(halves > covered / 3 && halves < 2 * covered / 3 && covered > 1000);
    rheo__canvas_release(&one);
    rheo__canvas_release(&both);
    rheo__canvas_release(&back);
}

/* The surface of a ball of fluid is drawn without a hole. */
static void a_surface_has_no_holes(void **unused)
{
    (void)unused;
    cloud *fluid = new_cloud();
    add_ball(fluid, 5, 0, 0, 0);
    const rheo_surface s = surface_of(fluid, rheo_default_surface_options());
    rheo__canvas c = new_canvas();
    for (size_t t = 0; t < s.triangles; t++) {
        double corner[3][3], normal[3][3];
        for (int k = 0; k < 3; k++) {
            const float *x = s.position + 3 * (size_t)s.triangle[3 * t + (size_t)k],
                        *n = s.normal + 3 * (size_t)s.triangle[3 * t + (size_t)k];
            rheo__canvas_point(&c, (const double[]){.2 * (double)x[0], .2 * (double)x[1], .2 * (double)x[2]},
                               corner[k]);
            rheo__canvas_direction(&c, (const double[]){(double)n[0], (double)n[1], (double)n[2]}, normal[k]);
        }
        rheo__draw_triangle(&c, (const double(*)[3])corner, (const double(*)[3])normal, NULL, RHEO__PAINT_PLAIN);
    }
    double centre[3];
    rheo__canvas_point(&c, (const double[]){0, 0, 0}, centre);
    int inside = 0;
    for (uint32_t row = 0; row < c.height; row++)
        for (uint32_t column = 0; column < c.width; column++) {
            double ray[3], cross[3];
            rheo__canvas_ray(&c, column, row, ray);
            rheo__view_cross(ray, centre, cross);
            const double away = rheo__view_length(cross) / rheo__view_length(ray);
            const rheo__sample *sample = sample_at(&c, column, row);
            if (away < .95) {
                assert_int_equal(sample->paint, RHEO__PAINT_PLAIN);
                assert_true((double)sample->depth < centre[2]); /* the front */
                inside++;
            } else if (away > 1.25) {
                assert_int_equal(sample->paint, RHEO__PAINT_NONE);
            }
        }
    assert_true(inside > 5000);
    rheo__canvas_release(&c);
    rheo_surface_release((rheo_surface *)&s);
    free(fluid);
}

static void floors_lie_in_their_planes(void **unused)
{
    (void)unused;
    const double level[3] = {0, 1, 0}, tilted[3] = {.6, .8, 0}, below[3] = {0, 1, 0};
    for (int i = 0; i < 3; i++) {
        const double *normal = i == 0 ? level : i == 1 ? tilted : below, offset = i == 2 ? 100 : -1;
        rheo__canvas c = new_canvas();
        int floors = 0, lines = 0;
        rheo__draw_floor(&c, normal, offset);
        for (uint32_t row = 0; row < c.height; row++)
            for (uint32_t column = 0; column < c.width; column++) {
                const rheo__sample *s = sample_at(&c, column, row);
                double ray[3], along = 0, eye = 0;
                rheo__canvas_ray(&c, column, row, ray);
                for (int a = 0; a < 3; a++) {
                    const double direction =
                        ray[0] * c.camera.aside[a] + ray[1] * c.camera.up[a] + c.camera.forward[a];
                    along += normal[a] * direction;
                    eye += normal[a] * c.camera.eye[a];
                }
                floors += s->paint == RHEO__PAINT_FLOOR;
                lines += s->paint == RHEO__PAINT_LINE;
                if (s->paint != RHEO__PAINT_NONE)
                    NEAR(eye + (double)s->depth * along, offset, 1e-5 * (double)s->depth);
                else if (eye > offset)
                    assert_true(along > -1e-6); /* above the horizon */
            }
        assert_true(i == 2 ? floors + lines == 0 : floors > 1000);
        assert_true(i == 1 ? lines > 100 && lines < floors : lines == 0);
        rheo__canvas_release(&c);
    }
}

/* ---- Colours ---- */

/* Relative luminance of a colour. */
static double luminance(const double colour[3])
{
    return .2126 * colour[0] * colour[0] + .7152 * colour[1] * colour[1] + .0722 * colour[2] * colour[2];
}

static void colours_become_lighter_evenly(void **unused)
{
    (void)unused;
    enum { STEPS = 64 };
    double least = 1, most = 0, before = 0;
    for (int i = 0; i <= STEPS; i++) {
        double colour[3];
        rheo__scale_colour((double)i / STEPS, colour);
        const double lightness = cbrt(luminance(colour));
        if (i > 0) {
            least = fmin(least, lightness - before);
            most = fmax(most, lightness - before);
        }
        before = lightness;
    }
    assert_true(least > .3 * most); /* so a difference of values is seen in grey, too */
    double first[3], last[3], beyond[3];
    rheo__scale_colour(0, first);
    rheo__scale_colour(-3, beyond);
    assert_memory_equal(first, beyond, sizeof first);
    rheo__scale_colour(1, last);
    rheo__scale_colour(7, beyond);
    assert_memory_equal(last, beyond, sizeof last);
    assert_int_equal(rheo__paint_of(0), 0);
    assert_int_equal(rheo__paint_of(1), RHEO__SHADES - 1);
    assert_int_equal(rheo__paint_of(-1e300), 0);
    assert_int_equal(rheo__paint_of(1e300), RHEO__SHADES - 1);
    assert_int_equal(rheo__paint_of(NAN), 0);
    assert_int_equal(rheo__paint_of(.5 + 1e-9), RHEO__SHADES / 2);
}

/* Labels are round numbers, at their places. */
static void labels_are_round_numbers_at_their_places(void **unused)
{
    (void)unused;
    static const struct {
        double range[2];
        const char *labels;
    } cases[] = {
        {{0, 1}, "0 0.2 0.4 0.6 0.8 1"},
        {{.0297, 1.24}, "0.2 0.4 0.6 0.8 1 1.2"},
        {{-3, 9}, "-2 0 2 4 6 8"},
        {{100, 417}, "100 150 200 250 300 350 400"},
        {{16.2, 417}, "100 200 300 400"},
        {{1.001, 1.0017}, "1.001 1.0011 1.0012 1.0013 1.0014 1.0015 1.0016 1.0017"},
        {{1e9, 6e9}, "1e+09 2e+09 3e+09 4e+09 5e+09 6e+09"},
        {{0, 7e-8}, "0 1e-08 2e-08 3e-08 4e-08 5e-08 6e-08 7e-08"},
        {{7, 7}, "7"},
        {{0, 0}, "0"},
        {{1e30, 1e30}, "1e+30"},
        {{1, 1 + 1e-15}, "1"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rheo__label label[RHEO__LABELS];
        char all[300] = "";
        const double *range = cases[i].range;
        const uint32_t count = rheo__scale_labels(range, label);
        for (uint32_t k = 0; k < count; k++) {
            strcat(strcat(all, k ? " " : ""), label[k].text);
            if (count > 1)
                NEAR(range[0] + label[k].place * (range[1] - range[0]), strtod(label[k].text, NULL),
                     1e-9 * (range[1] - range[0]));
        }
        assert_string_equal(all, cases[i].labels);
    }
    const double wide[2] = {-1e30, 1e30}, tiny[2] = {0, 1e-300}, narrow[2] = {1e15, 1e15 + 3};
    rheo__label label[RHEO__LABELS];
    assert_true(rheo__scale_labels(wide, label) >= 3);
    assert_true(rheo__scale_labels(tiny, label) >= 1);
    assert_true(rheo__scale_labels(narrow, label) >= 1);
}

/* 1000 particles at rest in a row but for their speeds: i, and 1e6 for the last. */
static rheo_world *row_of_speeds(void)
{
    enum { COUNT = 1000 };
    static rheo_real position[3 * COUNT], velocity[3 * COUNT];
    for (int i = 0; i < COUNT; i++) {
        position[3 * i] = (rheo_real)(10 * i);
        velocity[3 * i + 1] = (rheo_real)(i == COUNT - 1 ? 1e6 : i);
    }
    return world_of(inert_def(), COUNT, position, velocity);
}

static rheo_result range_of(const rheo_world *world, const char *colour, double range[2], rheo_error *why)
{
    const rheo_picture_options options = {.colour = colour};
    return rheo_world_colour_range(world, &options, range, why);
}

static void a_range_leaves_out_a_hundredth_at_each_end(void **unused)
{
    (void)unused;
    double range[2];
    rheo_world *world = row_of_speeds();
    OK(range_of(world, "speed", range, &error));
    assert_true(range[0] == 10 && range[1] == 989);
    OK(range_of(world, NULL, range, &error)); /* the default is the speed */
    assert_true(range[0] == 10 && range[1] == 989);
    OK(range_of(world, "velocity", range, &error)); /* its length */
    assert_true(range[0] == 10 && range[1] == 989);
    OK(range_of(world, "none", range, &error));
    assert_true(range[0] == 0 && range[1] == 1);
    REFUSED(RHEO_ERROR_ARGUMENT, "none, position", range_of(world, "temperature", range, &error));
    rheo_world_destroy(world);
    /* If only an outlier differs, it is in the range. */
    rheo_real position[300] = {0}, velocity[300] = {0};
    for (int i = 0; i < 100; i++)
        position[3 * i] = (rheo_real)(10 * i);
    velocity[33] = 4;
    world = world_of(inert_def(), 100, position, velocity);
    OK(range_of(world, "speed", range, &error));
    assert_true(range[0] == 0 && range[1] == 4);
    rheo_world_destroy(world);
    world = world_of(inert_def(), 0, NULL, NULL);
    OK(range_of(world, "speed", range, &error));
    assert_true(range[0] == 0 && range[1] == 1);
    rheo_world_destroy(world);
}

static void every_quantity_can_be_painted(void **unused)
{
    (void)unused;
    for (int model = 0; model < 2; model++) {
        rheo_world *world = model ? melting_world(5, NULL) : lively_world();
        step(world, 2);
        const uint32_t count = rheo_world_particle_count(world);
        rheo_particle_state *states = calloc(count, sizeof *states);
        assert_non_null(states);
        OK(rheo_world_particles(world, states, &error));
        const rheo_quantity *q;
        for (uint32_t i = 0; (q = rheo_world_quantity(world, i)) != NULL; i++) {
            rheo__painted painted;
            const rheo_picture_options options = {.colour = q->name};
            OK(rheo__painted_read(world, &options, &painted, &error));
            assert_int_equal(painted.name[0] == '|', q->components == 3);
            assert_string_equal(painted.unit, strcmp(q->unit, "1") ? q->unit : "");
            for (uint32_t id = 0; id < count; id++) {
                const double *value = (const double *)(const void *)((const char *)&states[id] + q->offset);
                const double expected = q->components == 3 ? rheo__view_length(value) : *value;
                NEAR(painted.value[id], expected, 1e-6 * fabs(expected));
            }
            rheo__painted_release(&painted);
        }
        free(states);
        rheo_world_destroy(world);
    }
}

/* Two worlds of 3 particles: the distances of their positions are 5, 0 and 0, and of their speeds 0, 2 and 1. */
static void differences_of_worlds_are_painted(void **unused)
{
    (void)unused;
    static const struct {
        const char *colour, *caption;
        double expected[3];
    } cases[] = {{NULL, "|difference of position|", {5, 0, 0}},
                 {"velocity", "|difference of velocity|", {0, 8, 1}},
                 {"speed", "|difference of speed|", {0, 2, 1}}};
    const rheo_real position[2][9] = {{0, 0, 0, 10, 0, 0, 20, 0, 0}, {3, 0, -4, 10, 0, 0, 20, 0, 0}},
                    velocity[2][9] = {{1, 0, 0, 0, 5, 0, 0, 0, 1}, {1, 0, 0, 0, -3, 0, 0, 0, 2}};
    rheo_world *a = world_of(inert_def(), 3, position[0], velocity[0]),
               *b = world_of(inert_def(), 3, position[1], velocity[1]),
               *fewer = world_of(inert_def(), 2, position[1], velocity[1]);
    for (int i = 0; i < 6; i++) {
        rheo__painted painted;
        const rheo_picture_options options = {.colour = cases[i / 2].colour, .other = i % 2 ? a : b};
        OK(rheo__painted_read(i % 2 ? b : a, &options, &painted, &error));
        assert_string_equal(painted.name, cases[i / 2].caption);
        for (int id = 0; id < 3; id++)
            assert_true((double)painted.value[id] == cases[i / 2].expected[id]);
        rheo__painted_release(&painted);
    }
    double range[2];
    const rheo_picture_options options = {.other = fewer};
    REFUSED(RHEO_ERROR_ARGUMENT, "3 and 2", rheo_world_colour_range(a, &options, range, &error));
    rheo_world_destroy(a);
    rheo_world_destroy(b);
    rheo_world_destroy(fewer);
}

/* ---- Pictures ---- */

static unsigned char *picture_of(const rheo_world *world, rheo_picture_options options)
{
    unsigned char *rgb = malloc((size_t)3 * options.width * options.height);
    assert_non_null(rgb);
    OK(rheo_world_render(world, &options, rgb, &error));
    return rgb;
}

static rheo_picture_options small_picture(void)
{
    rheo_picture_options options = rheo_default_picture_options();
    assert_true(options.width == 1280 && options.height == 720);
    options.width = WIDTH;
    options.height = HEIGHT;
    return options;
}

static uint64_t hash_of(const unsigned char *rgb)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325); /* FNV-1a */
    for (size_t i = 0; i < 3 * PIXELS; i++)
        hash = (hash ^ rgb[i]) * UINT64_C(0x100000001b3);
    return hash;
}

/* A change of these numbers changes all pictures that people made. Float and double have other states. */
static void pictures_have_the_same_bytes_everywhere(void **unused)
{
    (void)unused;
    static const uint64_t expected[2][4] = {{UINT64_C(0x6f8bce54fd798c34), UINT64_C(0x3e6541faa7fbcd61),
                                             UINT64_C(0x8a82844867c02147), UINT64_C(0x2ae4d798f7070b5f)},
                                            {UINT64_C(0x8e833716710d644d), UINT64_C(0xcef91735ec074cc0),
                                             UINT64_C(0xde4d1f1af01e5764), UINT64_C(0x2ae4d798f7070b5f)}};
    const rheo_surface_options surface = rheo_default_surface_options();
    const char *best = rheo_simd(), *name;
    int different = 0;
    for (uint32_t variant = 0; (name = rheo_simd_available(variant)) != NULL; variant++) {
        OK(rheo_use_simd(name, &error));
        for (int model = 0; model < 2; model++) {
            rheo_world *world = model ? melting_world(6, NULL) : lively_world();
            if (!model)
                OK(rheo_world_set(world, "ball.push", "[0, 0, 0]", &error));
            step(world, 5);
            for (int with_surface = 0; with_surface < 2; with_surface++) {
                rheo_picture_options options = small_picture();
                options.surface = with_surface ? &surface : NULL;
                options.colour = model ? NULL : "stiffness";
                unsigned char *rgb = picture_of(world, options);
                const uint64_t hash = hash_of(rgb), wanted = expected[RHEO_DOUBLE][2 * model + with_surface];
                if (hash != wanted)
                    print_error("%s, picture %d: 0x%016llx\n", name, 2 * model + with_surface,
                                (unsigned long long)hash);
                different += hash != wanted;
                free(rgb);
            }
            rheo_world_destroy(world);
        }
    }
    OK(rheo_use_simd(best, &error));
    assert_int_equal(different, 0);
}

static double light_at(const unsigned char *rgb, int column, int row)
{
    const unsigned char *pixel = rgb + 3 * (row * WIDTH + column);
    return luminance((const double[]){pixel[0] / 255., pixel[1] / 255., pixel[2] / 255.});
}

static void the_colour_bar_has_the_colours_of_the_scale(void **unused)
{
    (void)unused;
    rheo_world *world = row_of_speeds();
    rheo_picture_options options = small_picture();
    options.width = 4 * WIDTH;
    options.height = 4 * HEIGHT;
    unsigned char *rgb = picture_of(world, options);
    /* Where letters are 360 / 48 pixels high, the bar begins 8.2 letters from the right. */
    const int column = (int)(4 * WIDTH - 8.2 * 7.5) + 4;
    const double bottom = .84 * 4 * HEIGHT, length = .62 * 4 * HEIGHT;
    for (int row = (int)(bottom - length) + 1; row < (int)bottom - 1; row++) {
        double colour[3];
        rheo__scale_colour((bottom - row - .5) / length, colour);
        for (int a = 0; a < 3; a++)
            NEAR(rgb[3 * (row * 4 * WIDTH + column) + a], 255 * colour[a], .51);
    }
    /* Another range has other labels and the same bar. No captions: neither. */
    const double range[2] = {0, 8};
    options.range = range;
    unsigned char *other = picture_of(world, options);
    int changed = 0;
    for (int row = 0; row < 4 * HEIGHT; row++)
        for (int at = column; at < 4 * WIDTH; at++) {
            const size_t pixel = 3 * (size_t)(row * 4 * WIDTH + at);
            const bool differs = memcmp(rgb + pixel, other + pixel, 3) != 0;
            changed += differs;
            assert_false(at < column + 4 && differs);
        }
    assert_true(changed > 50);
    free(other);
    options.without_captions = true;
    other = picture_of(world, options);
    const size_t pixel = 3 * (size_t)((int)(bottom - 20) * 4 * WIDTH + column);
    assert_true(memcmp(rgb + pixel, other + pixel, 3) != 0);
    free(other);
    free(rgb);
    rheo_world_destroy(world);
}

/* A plate of particles above a floor: the key light comes from the left and above, and the floor is darker on the right. */
static void things_cast_shadows(void **unused)
{
    (void)unused;
    const rheo_wall floor = {{0, 0, 0}, {0, 1, 0}};
    enum { SIDE = 7 };
    rheo_real position[3 * SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++) {
        position[3 * i] = (rheo_real)(i % SIDE - SIDE / 2) * (rheo_real).3;
        position[3 * i + 1] = 2;
        position[3 * i + 2] = (rheo_real)(i / SIDE - SIDE / 2) * (rheo_real).3;
    }
    const rheo_extent extent = {{-2, 0, -2}, {2, 3, 2}, 0, 1};
    rheo_world_def def = inert_def();
    def.walls.count = 1;
    def.walls.plane = &floor;
    def.fluid.spacing = .3;
    rheo_picture_options options = small_picture();
    options.extent = &extent;
    options.colour = "none";
    options.without_captions = true;
    rheo_world *with = world_of(def, SIDE * SIDE, position, NULL), *without = world_of(def, 0, NULL, NULL);
    unsigned char *shaded = picture_of(with, options), *plain = picture_of(without, options);
    rheo__canvas c;
    OK(rheo__canvas_make(&c, WIDTH, HEIGHT, &extent, NULL, false, &error));
    /* The light comes from (-3.5, 7, 3). */
    double normal[3], height, seen[3];
    assert_true(rheo__is_floor(&def, 0, normal, &height));
    const double part = (2 - height) / 7, centre[3] = {3.5 * part, height, -3 * part},
                 beside[3] = {-1.5, height, 1.5};
    for (int k = 0; k < 2; k++) {
        rheo__canvas_point(&c, k ? beside : centre, seen);
        const int column = (int)((seen[0] / seen[2] - c.left) / c.step / 2),
                  row = (int)((c.top - seen[1] / seen[2]) / c.step / 2);
        assert_true(column > 0 && column < WIDTH && row > 0 && row < HEIGHT);
        const double ratio = light_at(shaded, column, row) / light_at(plain, column, row);
        if (!(k ? ratio > .95 : ratio < .6))
            fail_msg("point %d at %d, %d: the light is %g of that without the plate", k, column, row, ratio);
    }
    rheo__canvas_release(&c);
    free(shaded);
    free(plain);
    rheo_world_destroy(with);
    rheo_world_destroy(without);
}

/* Neighbouring octants of the ball have different panels, which turn with it. */
static void panels_turn_with_the_ball(void **unused)
{
    (void)unused;
    const double turned[3][3] = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}, upright[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    rheo__canvas c[2] = {new_canvas(), new_canvas()};
    for (int k = 0; k < 2; k++) {
        const rheo__ball ball = {{0, 0, 6}, 1, 0, k ? turned : upright};
        rheo__draw_sphere(&c[k], &ball);
    }
    int pale = 0, dark = 0;
    for (uint32_t row = 0; row < c[0].height; row++)
        for (uint32_t column = 0; column < c[0].width; column++) {
            const rheo__sample *s = sample_at(&c[0], column, row), *t = sample_at(&c[1], column, row);
            if (s->paint == RHEO__PAINT_NONE || !s->normal[0] || !s->normal[1] || !s->normal[2])
                continue;
            const bool is_dark = ((s->normal[0] < 0) + (s->normal[1] < 0) + (s->normal[2] < 0)) % 2;
            assert_int_equal(s->paint, is_dark ? RHEO__PAINT_DARK : RHEO__PAINT_PALE);
            assert_int_equal(t->paint, is_dark ? RHEO__PAINT_PALE : RHEO__PAINT_DARK); /* a quarter turn */
            pale += !is_dark;
            dark += is_dark;
        }
    assert_true(pale > 500 && dark > 500);
    rheo__canvas_release(&c[0]);
    rheo__canvas_release(&c[1]);
}

/* ---- Captions ---- */

enum { SHEET = 64 };

static void write_letter(char letter, unsigned char rgb[3 * SHEET * SHEET])
{
    const rheo__sheet sheet = {rgb, SHEET, SHEET};
    memset(rgb, 255, 3 * SHEET * SHEET);
    rheo__sheet_text(&sheet, 10, 45, 30, (const char[]){letter, 0});
}

/* Every letter of names and units has a shape of its own; other characters are boxes. */
static void all_letters_differ(void **unused)
{
    (void)unused;
    static const char letters[] = "0123456789+-.,:/^()=|ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
    static unsigned char shape[sizeof letters][3 * SHEET * SHEET];
    for (size_t i = 0; i < sizeof letters; i++) {
        write_letter(letters[i] ? letters[i] : '\x7f', shape[i]); /* the last is the box */
        int ink = 0;
        for (int k = 0; k < SHEET * SHEET; k++)
            ink += shape[i][3 * k] < 128;
        assert_true(ink > 5 && ink < SHEET * SHEET / 4);
        for (size_t other = 0; other < i; other++)
            if (memcmp(shape[i], shape[other], sizeof *shape) == 0)
                assert_true((letters[i] == 'l' && letters[other] == 'I') ||
                            (letters[i] == 'O' && letters[other] == '0'));
    }
    write_letter(' ', shape[0]);
    for (size_t k = 0; k < sizeof *shape; k++)
        assert_int_equal(shape[0][k], 255);
    for (int model = 0; model < 2; model++) {
        rheo_world *world = model ? melting_world(5, NULL) : lively_world();
        const rheo_quantity *q;
        for (uint32_t i = 0; (q = rheo_world_quantity(world, i)) != NULL; i++)
            for (const char *c = q->name; c; c = c == q->name ? q->unit : NULL)
                for (size_t k = 0; c[k]; k++) /* _ is written as a blank */
                    assert_non_null(strchr(c[k] == '_' ? "_" : c[k] == ' ' ? " " : letters, c[k]));
        rheo_world_destroy(world);
    }
    /* Digits have one width, so that a film's step does not tremble. */
    assert_true(rheo__text_length(10, "111") == rheo__text_length(10, "888"));
    assert_true(rheo__text_length(20, "888") == 2 * rheo__text_length(10, "888"));
    assert_true(rheo__text_length(10, "") == 0);
}

static void options_out_of_range_are_refused(void **unused)
{
    (void)unused;
    rheo_world *world = row_of_speeds();
    unsigned char *rgb = malloc(3 * PIXELS);
    static const double ranges[][2] = {{2, 1}, {0, 2e30}, {-2e30, 0}, {0, NAN}, {NAN, 0}};
    static const uint32_t sizes[][2] = {{15, 90}, {160, 15}, {4097, 90}, {160, 4097}, {0, 0}};
    for (size_t i = 0; i < 5; i++) {
        rheo_picture_options options = small_picture();
        options.range = ranges[i];
        REFUSED(RHEO_ERROR_ARGUMENT, "must ascend", rheo_world_render(world, &options, rgb, &error));
        options = small_picture();
        options.width = sizes[i][0];
        options.height = sizes[i][1];
        REFUSED(RHEO_ERROR_ARGUMENT, "16 to 4096", rheo_world_render(world, &options, rgb, &error));
    }
    rheo_picture_options options = small_picture();
    options.colour = "hue";
    REFUSED(RHEO_ERROR_ARGUMENT, "\"hue\"", rheo_world_render(world, &options, rgb, &error));
    options = small_picture();
    const rheo_surface_options fine = {.isovalue = 2, .resolution = 2};
    options.surface = &fine;
    REFUSED(RHEO_ERROR_ARGUMENT, "isovalue", rheo_world_render(world, &options, rgb, &error));
    /* The smallest and narrowest pictures have room for less than their captions. */
    options = small_picture();
    options.width = options.height = RHEO_PICTURE_MIN;
    OK(rheo_world_render(world, &options, rgb, &error));
    free(rgb);
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_has_the_silhouette_of_its_tangent_cone),
        cmocka_unit_test(a_colour_bar_takes_its_part_of_the_width),
        cmocka_unit_test(the_nearest_thing_is_seen_in_any_order),
        cmocka_unit_test(triangles_fit_together),
        cmocka_unit_test(a_surface_has_no_holes),
        cmocka_unit_test(floors_lie_in_their_planes),
        cmocka_unit_test(colours_become_lighter_evenly),
        cmocka_unit_test(labels_are_round_numbers_at_their_places),
        cmocka_unit_test(a_range_leaves_out_a_hundredth_at_each_end),
        cmocka_unit_test(every_quantity_can_be_painted),
        cmocka_unit_test(differences_of_worlds_are_painted),
        cmocka_unit_test(pictures_have_the_same_bytes_everywhere),
        cmocka_unit_test(the_colour_bar_has_the_colours_of_the_scale),
        cmocka_unit_test(things_cast_shadows),
        cmocka_unit_test(panels_turn_with_the_ball),
        cmocka_unit_test(all_letters_differ),
        cmocka_unit_test(options_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
