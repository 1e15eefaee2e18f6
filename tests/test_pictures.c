/* Scenes for POV-Ray, rendered if povray is installed. */
#define _XOPEN_SOURCE 700 /* mkdtemp() */
#include "view_support.h"
#include "view/camera.h"
#include "view/vectors.h"

#include <sys/wait.h>

/* ---- Pictures ---- */

static bool can_render(void)
{
    return system("povray --version >povray.txt 2>&1") == 0;
}

/* Counts the colours of a picture of 80 x 60 pixels, with 8 levels per channel. */
static int render(const char *scene, bool colours[512])
{
    enum { WIDTH = 80, HEIGHT = 60 };
    char command[256];
    snprintf(command, sizeof command, "povray +I%s +Opicture.ppm +FP +W%d +H%d -D >povray.txt 2>&1", scene, WIDTH,
             HEIGHT);
    size_t size;
    remove("picture.ppm");
    const int status = system(command);
    if (status != 0) {
        char *text = (char *)read_file("povray.txt", &size);
        fail_msg("povray ended with %d:\n%s", status, text);
    }
    char *text = (char *)read_file("picture.ppm", &size);
    assert_int_equal(strncmp(text, "P6", 2), 0);
    const unsigned char *pixel = (const unsigned char *)text + size - 3 * WIDTH * HEIGHT;
    memset(colours, 0, 512 * sizeof *colours);
    int different = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++, pixel += 3) {
        bool *colour = &colours[pixel[0] / 32 * 64 + pixel[1] / 32 * 8 + pixel[2] / 32];
        different += !*colour;
        *colour = true;
    }
    free(text);
    return different;
}

static void pictures_show_something(void **unused)
{
    (void)unused;
    if (!can_render()) {
        print_message("no povray here: nothing is rendered\n");
        skip();
    }
    bool colours[512];
    rheo_world *world = lively_world();
    export_to(world, RHEO_EXPORT_POV, "world.pov");
    const int whole = render("world.pov", colours);
    rheo_world_destroy(world);
    rheo_world *empty = world_of(inert_def(), 0, NULL, NULL);
    export_to(empty, RHEO_EXPORT_POV, "empty.pov");
    assert_true(render("empty.pov", colours) < whole && whole >= 8);
    assert_int_equal(render("empty.pov", colours), 1);
    rheo_world_destroy(empty);
}

/* A ball with cold and hot halves, in files: both colours appear. */
static void temperatures_are_painted(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 4, 0, 0, 0);
    for (uint32_t i = 0; i < c->count; i++)
        c->value[i] = (rheo_real)(c->position[3 * i] < 0 ? 10 : 30);
    const rheo_surface_particles p = {
        .count = c->count, .position = c->position, .value = c->value, .spacing = 1, .smoothing_length = 1};
    const rheo_surface_options options = rheo_default_surface_options();
    rheo_surface s;
    OK(rheo_surface_make(&p, &options, NULL, &s, &error));
    const rheo_extent extent = {{-4.5, -4.5, -4.5}, {4.5, 4.5, 4.5}, 10, 30};
    rheo_world *world = world_of(inert_def(), 0, NULL, NULL);
    static rheo__output out;
    OK(rheo__output_open(&out, "heat.ply", true, &error));
    const rheo__colours heat = {.name = "temperature", .range = {10, 30}, .is_heat = true};
    rheo__write_ply(&out, &s, &heat);
    OK(rheo__output_close(&out, RHEO_OK, &error));
    size_t size;
    char *text = (char *)read_file("heat.ply", &size);
    const char *at = strstr(text, "end_header\n") + 11;
    assert_non_null(strstr(text, "property uchar blue\n"));
    assert_int_equal(size - (size_t)(at - text), 31 * (size_t)s.vertices + 13 * (size_t)s.triangles);
    int blue = 0, red = 0;
    for (size_t i = 0; i < s.vertices; i++, at += 31) {
        const unsigned char *colour = (const unsigned char *)at + 28;
        if (s.position[3 * i] < -2)
            blue += colour[2] > colour[0] + 80;
        if (s.position[3 * i] > 2)
            red += colour[0] > colour[2] + 80;
    }
    assert_true(blue > 20 && red > 20);
    free(text);
    OK(rheo__output_open(&out, "heat.pov", true, &error));
    rheo__write_pov(&out, world, &s, &extent, &heat);
    OK(rheo__output_close(&out, RHEO_OK, &error));
    if (can_render()) {
        bool colours[512], cold = false, hot = false;
        render("heat.pov", colours);
        for (int k = 0; k < 512; k++) {
            cold |= colours[k] && k % 8 >= k / 64 + 2;
            hot |= colours[k] && k / 64 >= k % 8 + 2;
        }
        assert_true(cold && hot);
    }
    rheo_surface_release(&s);
    rheo_world_destroy(world);
    free(c);
}

/* Volumes are mass/density, values are temperatures, and tables have both. */
static void melting_worlds_have_density_and_temperature(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 6, 0, 0, 0);
    rheo_real *density = c->volume; /* half the density: twice the volume, chi twice as large */
    for (uint32_t i = 0; i < c->count; i++) {
        density[i] = (rheo_real)1.5;
        c->value[i] = (rheo_real)(c->position[3 * i] < 0 ? .25 : .75);
    }
    rheo_world_def def = rheo_default_model_def(RHEO_MODEL_MELTING);
    def.fluid.spacing = 1;
    def.melting.rest_density = 3;
    def.particles.count = c->count;
    def.particles.position = c->position;
    def.particles.density = density;
    def.particles.temperature = c->value;
    rheo_world *world;
    rheo_surface s, plain;
    OK(rheo_world_create(&def, &world, &error));
    const rheo_surface_options options = rheo_default_surface_options();
    OK(rheo_world_surface(world, &options, NULL, &s, &error));
    plain = surface_of(c, (rheo_surface_options){.25, 2});
    assert_int_equal(s.vertices, plain.vertices);
    assert_memory_equal(s.triangle, plain.triangle, 3 * sizeof *s.triangle * s.triangles);
    for (size_t i = 0; i < s.vertices; i++) {
        NEAR((double)s.position[3 * i], (double)plain.position[3 * i], 1e-5);
        if (s.position[3 * i] < -3 || s.position[3 * i] > 3)
            NEAR((double)s.value[i], s.position[3 * i] < 0 ? .25 : .75, 1e-3);
    }
    const rheo_extent e = rheo_world_extent(world);
    assert_true(e.coldest == .25 && e.hottest == .75);
    export_to(world, RHEO_EXPORT_CSV, "melting.csv");
    export_to(world, RHEO_EXPORT_PLY, "melting.ply");
    export_to(world, RHEO_EXPORT_VTP, "melting.vtp");
    size_t size;
    char *text = (char *)read_file("melting.csv", &size);
    assert_int_equal(strncmp(text, "id,x,y,z,vx,vy,vz,density,temperature", 37), 0);
    assert_int_equal(strncmp(strchr(text, '\n') + 1, "0,0,0,-6,0,0,0,1.5,0.75", 23), 0);
    free(text);
    text = (char *)read_file("melting.ply", &size);
    assert_non_null(strstr(text, "property float temperature\n"));
    free(text);
    text = (char *)read_file("melting.vtp", &size);
    uint64_t bytes;
    array_of(text, "temperature", &bytes);
    assert_int_equal(bytes, sizeof(rheo_real) * c->count);
    free(text);
    rheo_surface_release(&s);
    rheo_surface_release(&plain);
    rheo_world_destroy(world);
    free(c);
}

/* ---- Scenes for POV-Ray, as text ---- */

/* Writes a scene and returns its text. */
static char *pov_of(const rheo_world *world, const rheo_surface *surface, const rheo_extent *extent)
{
    static rheo__output out;
    size_t size;
    OK(rheo__output_open(&out, "text.pov", true, &error));
    const rheo__colours heat = {.name = "temperature", .range = {extent->coldest, extent->hottest}, .is_heat = true};
    rheo__write_pov(&out, world, surface, extent, &heat);
    OK(rheo__output_close(&out, RHEO_OK, &error));
    return (char *)read_file("text.pov", &size);
}

/* Reads the vector behind the words; returns what follows it. */
static const char *vector_after(const char *text, const char *words, double v[3])
{
    const char *at = strstr(text, words);
    assert_non_null(at);
    int length = 0;
    assert_int_equal(sscanf(at + strlen(words), " <%lf, %lf, %lf>%n", &v[0], &v[1], &v[2], &length), 3);
    return at + strlen(words) + length;
}

/* Walls that rise more steeply than 60 degrees and ceilings would hide the fluid; every other wall is there. */
static void each_floor_is_drawn_and_no_other_wall(void **unused)
{
    (void)unused;
    const rheo_wall plane[] = {{.point = {5, 2, 7}, .normal = {0, 3, 0}},
                               {.point = {0, 0, 0}, .normal = {1, 0, 0}},
                               {.point = {0, 9, 0}, .normal = {0, -1, 0}},
                               {.point = {1, 1, 0}, .normal = {0, 1, sqrt(3.1)}},
                               {.point = {1, 1, 0}, .normal = {1.2, 1.6, 0}}};
    rheo_world_def def = inert_def();
    def.walls.plane = plane;
    def.walls.count = 5;
    rheo_world *world = world_of(def, 0, NULL, NULL);
    const rheo_surface none = {0};
    const rheo_extent extent = {{0, 0, 0}, {1, 1, 1}, 0, 0};
    char *text = pov_of(world, &none, &extent);
    const double expected[2][4] = {{0, 1, 0, 2}, {.6, .8, 0, 1.4}}; /* unit normal, distance from the origin */
    const char *at = text;
    double lower[2];
    for (int f = 0; f < 2; f++) {
        double normal[3], distance;
        at = vector_after(at, "plane {", normal);
        assert_int_equal(sscanf(at, ", %lf", &distance), 1);
        for (int axis = 0; axis < 3; axis++)
            NEAR(normal[axis], expected[f][axis], 1e-12);
        lower[f] = expected[f][3] - distance;
    }
    assert_null(strstr(at, "plane {"));
    /* The surface of the fluid is less than a spacing behind the centres of the particles. */
    assert_true(lower[0] >= 0 && lower[0] < 1);
    NEAR(lower[1], lower[0], 1e-12);
    rheo_world_destroy(world);
    free(text);
}

/* Nothing else in a picture shows that a floor is tilted. */
static void only_tilted_floors_have_lines_of_equal_height(void **unused)
{
    (void)unused;
    const rheo_wall planes[] = {{.normal = {0, .7, 0}}, {.normal = {.1, 1, 0}}, {.normal = {0, 1, -.02}}};
    const rheo_surface none = {0};
    const rheo_extent extent = {{-1, 0, -1}, {1, 2, 1}, 0, 0};
    int colours_of_level = 0;
    for (int i = 0; i < 3; i++) {
        rheo_world_def def = inert_def();
        def.walls.plane = &planes[i];
        def.walls.count = 1;
        rheo_world *world = world_of(def, 0, NULL, NULL);
        char *text = pov_of(world, &none, &extent);
        assert_true((strstr(text, "gradient y color_map") != NULL) == (i > 0));
        if (can_render()) {
            bool colours[512];
            const int found = render("text.pov", colours);
            colours_of_level = i == 0 ? found : colours_of_level;
            assert_true(i != 1 || found > colours_of_level);
        }
        rheo_world_destroy(world);
        free(text);
    }
}

/* Independent of how the camera is chosen: its picture has all corners of the extent, and they fill most of it. */
static void the_camera_sees_the_whole_extent(void **unused)
{
    (void)unused;
    static const rheo_extent extents[] = {{{-1, -1, -1}, {1, 1, 1}, 0, 0},   {{5, 0, 0}, {45, 2, 3}, 0, 0},
                                          {{0, -60, 0}, {2, -20, 3}, 0, 0},  {{0, 0, 10}, {2, 3, 50}, 0, 0},
                                          {{-8, 0, -8}, {8, 1e-3, 8}, 0, 0}, {{1e6, 2, 3}, {1.5e6, 3e5, 4e5}, 0, 0}};
    rheo_world *world = world_of(inert_def(), 0, NULL, NULL);
    const rheo_surface none = {0};
    for (size_t e = 0; e < sizeof extents / sizeof *extents; e++) {
        char *text = pov_of(world, &none, &extents[e]);
        double eye[3], target[3], direction, forward[3], aside[3], up[3], length = 0, most = 0;
        vector_after(text, "location ", eye);
        vector_after(text, "look_at ", target);
        assert_int_equal(sscanf(strstr(text, "direction z*"), "direction z*%lf", &direction), 1);
        for (int k = 0; k < 3; k++) {
            NEAR(target[k], (extents[e].min[k] + extents[e].max[k]) / 2, 1e-9 * fabs(target[k]) + 1e-12);
            forward[k] = target[k] - eye[k];
            length += forward[k] * forward[k];
        }
        for (int k = 0; k < 3; k++)
            forward[k] /= sqrt(length);
        assert_true(forward[1] < -.1 && forward[2] < 0); /* from above and in front */
        const double level = sqrt(forward[0] * forward[0] + forward[2] * forward[2]);
        aside[0] = -forward[2] / level, aside[1] = 0, aside[2] = forward[0] / level;
        up[0] = aside[1] * forward[2] - aside[2] * forward[1];
        up[1] = aside[2] * forward[0] - aside[0] * forward[2];
        up[2] = aside[0] * forward[1] - aside[1] * forward[0];
        for (int c = 0; c < 8; c++) {
            double depth = 0, x = 0, y = 0;
            for (int k = 0; k < 3; k++) {
                const double from = (c >> k & 1 ? extents[e].max : extents[e].min)[k] - eye[k];
                depth += from * forward[k], x += from * aside[k], y += from * up[k];
            }
            /* Half the height of the picture at this depth is depth/(2 direction), half the width 4/3 of it. */
            const double high = fabs(y) / depth * 2 * direction, wide = fabs(x) / depth * 2 * direction * 3 / 4;
            assert_true(depth > 0 && high < 1 && wide < 1);
            most = fmax(most, fmax(high, wide));
        }
        if (most < .85)
            fail_msg("extent %zu fills only %g of the picture", e, most);
        free(text);
    }
    rheo_world_destroy(world);
}

/* Two lights from above and in front, one from each side, and as far away as the extent is large. */
static void lights_move_with_the_extent(void **unused)
{
    (void)unused;
    rheo_world *world = world_of(inert_def(), 0, NULL, NULL);
    const rheo_surface none = {0};
    double first[2][3];
    for (int scale = 1; scale <= 4; scale *= 2) {
        const double centre[3] = {7 * scale, -5 * scale, 3};
        rheo_extent extent = {{0, 0, 0}, {0, 0, 0}, 0, 0};
        for (int k = 0; k < 3; k++) {
            extent.min[k] = centre[k] - (k + 1) * scale;
            extent.max[k] = centre[k] + (k + 1) * scale;
        }
        char *text = pov_of(world, &none, &extent);
        const char *at = text;
        for (int light = 0; light < 2; light++) {
            double from[3];
            at = vector_after(at, "light_source {", from);
            for (int k = 0; k < 3; k++) {
                from[k] = (from[k] - centre[k]) / scale;
                if (scale > 1)
                    NEAR(from[k], first[light][k], 1e-9);
                first[light][k] = from[k];
            }
            assert_true(from[1] > 2 && from[2] > 3 && fabs(from[0]) > 1); /* outside the extent */
        }
        assert_null(strstr(at, "light_source {"));
        assert_true((first[0][0] > 0) != (first[1][0] > 0));
        /* The lamps form a square that grows with the extent. */
        double edge[3], across[3], dot = 0, edge2 = 0, across2 = 0;
        vector_after(vector_after(at, "area_light", edge), ",", across);
        for (int k = 0; k < 3; k++) {
            dot += edge[k] * across[k];
            edge2 += edge[k] * edge[k];
            across2 += across[k] * across[k];
        }
        NEAR(dot, 0, 1e-9 * edge2);
        NEAR(across2, edge2, 1e-9 * edge2);
        NEAR(edge2, (double)scale * scale * (1 + 4 + 9) * 4, 1e-9 * edge2);
        free(text);
    }
    rheo_world_destroy(world);
}

/* The rows of the matrix are the images of the axes: q v q* of the body's orientation. */
static void a_ball_is_drawn_as_it_lies(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    def.ball.radius = 2.5;
    const double position[3] = {1, -2, 3}, spin[3] = {40, -70, 110};
    memcpy(def.ball.position, position, sizeof position);
    memcpy(def.ball.spin, spin, sizeof spin);
    rheo_world *world = world_of(def, 0, NULL, NULL);
    for (int i = 0; i < 20; i++)
        OK(rheo_world_step(world, &error));
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    const double *q = ball.orientation, *u = q + 1;
    assert_true(fabs(u[0]) > .1 && fabs(u[1]) > .1 && fabs(u[2]) > .1);
    const rheo_surface none = {0};
    const rheo_extent extent = {{-2, -5, 0}, {4, 1, 6}, 0, 0};
    char *text = pov_of(world, &none, &extent);
    const char *at = strstr(text, "matrix <");
    assert_non_null(at);
    at += strlen("matrix <");
    for (int row = 0; row < 4; row++)
        for (int k = 0; k < 3; k++) {
            /* v + 2 w (u x v) + 2 (u (u.v) - v (u.u)); the last row is the shift */
            double image = 0;
            if (row < 3) {
                const double cross = k == row ? 0 : k == (row + 1) % 3 ? u[(row + 2) % 3] : -u[(row + 1) % 3];
                image = (k == row) + 2 * q[0] * cross + 2 * u[k] * u[row] -
                        2 * (k == row) * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
            }
            char *end;
            NEAR(strtod(at, &end), image, 1e-9);
            at = end + strspn(end, ", ");
        }
    double drawn[3], scale;
    assert_int_equal(*at, '>');
    vector_after(at, "translate", drawn);
    for (int k = 0; k < 3; k++)
        NEAR(drawn[k], ball.position[k], 1e-9);
    assert_int_equal(sscanf(at, ">\n scale %lf", &scale), 1);
    NEAR(scale, 2.5, 1e-6);
    assert_null(strstr(at, "sphere {"));
    rheo_world_destroy(world);
    free(text);
}

/* The coldest vertex has the first of 64 colours and the hottest the last, however small the range is. */
static void shades_span_the_range_of_temperatures(void **unused)
{
    (void)unused;
    float position[15] = {0}, normal[15] = {0}, value[5] = {.25F, .5F, .75F, -3, 9};
    uint32_t triangle[6] = {0, 1, 2, 3, 4, 1};
    const rheo_surface surface = {
        .vertices = 5, .triangles = 2, .position = position, .normal = normal, .value = value, .triangle = triangle};
    rheo_extent extent = {{0, 0, 0}, {1, 1, 1}, .25, .75};
    rheo_world *world = world_of(inert_def(), 0, NULL, NULL);
    char *text = pov_of(world, &surface, &extent);
    assert_non_null(strstr(text, "texture_list {\n  64,"));
    assert_non_null(strstr(text, "face_indices {\n2,\n<0,1,2>,0,32,63,\n<3,4,1>,0,63,32\n"));
    free(text);
    extent.hottest = extent.coldest;
    text = pov_of(world, &surface, &extent);
    assert_non_null(strstr(text, "face_indices {\n2,\n<0,1,2>,0,0,0,\n<3,4,1>,0,0,0\n"));
    free(text);
    rheo_world_destroy(world);
}

/* The shades of a texture list are the colours at equal distances from the coldest to the hottest temperature. */
static void shades_are_colours_at_equal_distances(void **unused)
{
    (void)unused;
    enum { SHADES = 64 };
    float position[9] = {0}, normal[9] = {0}, value[3] = {0};
    uint32_t triangle[3] = {0, 1, 2};
    const rheo_surface surface = {
        .vertices = 3, .triangles = 1, .position = position, .normal = normal, .value = value, .triangle = triangle};
    const rheo_extent extent = {{0, 0, 0}, {1, 1, 1}, 280, 310};
    const rheo__colours heat = {.name = "temperature", .range = {280, 310}, .is_heat = true};
    rheo_world *world = world_of(inert_def(), 0, NULL, NULL);
    char *text = pov_of(world, &surface, &extent), *at = strstr(text, "texture_list {");
    assert_non_null(at);
    for (int i = 0; i < SHADES; i++) {
        double colour[3];
        rheo__colour_of(&heat, 280 + 30. * i / (SHADES - 1), colour);
        at = strstr(at, "color srgb <");
        assert_non_null(at);
        at += strlen("color srgb <");
        for (int k = 0; k < 3; k++, at += *at == ',')
            NEAR(strtod(at, &at), colour[k], 1e-6);
    }
    assert_true(!strstr(at, "color srgb <") || strstr(at, "face_indices") < strstr(at, "color srgb <"));
    free(text);
    rheo_world_destroy(world);
}

enum { WIDTH = 160, HEIGHT = 90 };

/* Whether a pixel shows the dark panels, which are blue, of a ball; -1: it does not show the inside of a panel. */
static int is_dark_at(const rheo_body *ball, const rheo__camera *camera, int column, int row)
{
    const double across = (2 * (column + .5) - WIDTH) * .23 / HEIGHT, up = (HEIGHT - 2 * (row + .5)) * .23 / HEIGHT;
    double ray[3], from[3], v[3], inner[3], outer[3];
    for (int a = 0; a < 3; a++) {
        ray[a] = camera->forward[a] + across * camera->aside[a] + up * camera->up[a];
        from[a] = camera->eye[a] - ball->position[a];
    }
    const double square = rheo__view_dot(ray, ray), middle = rheo__view_dot(ray, from) / square,
                 left = middle * middle - (rheo__view_dot(from, from) - ball->radius * ball->radius) / square;
    if (!(left > .1 * ball->radius * ball->radius / square)) /* near the edge or beside the ball */
        return -1;
    for (int a = 0; a < 3; a++)
        v[a] = (from[a] - (middle + sqrt(left)) * ray[a]) / ball->radius;
    /* v + 2 u x (u x v - w v) turns v back. */
    const double w = ball->orientation[0], *u = ball->orientation + 1;
    rheo__view_cross(u, v, inner);
    for (int a = 0; a < 3; a++)
        inner[a] -= w * v[a];
    rheo__view_cross(u, inner, outer);
    int negative = 0;
    for (int a = 0; a < 3; a++) {
        const double own = v[a] + 2 * outer[a];
        if (fabs(own) < .1)
            return -1;
        negative += own < 0;
    }
    return negative % 2;
}

/* Each pixel of a ball in the air shows the panel that its orientation turns there. */
static void the_ball_of_a_world_shows_its_orientation(void **unused)
{
    (void)unused;
    static const char *const spins[] = {"[0, 0, 0]", "[0, 25, 0]", "[0, 0, 25]", "[30, 10, 5]", "[25, -50, 40]"};
    for (size_t i = 0; i < sizeof spins / sizeof *spins; i++) {
        rheo_world *world = lively_world();
        OK(rheo_world_set(world, "ball.position", "[8, 60, 8]", &error));
        OK(rheo_world_set(world, "ball.spin", spins[i], &error));
        step(world, 1);
        rheo_body b;
        OK(rheo_world_body(world, 0, &b));
        const rheo_extent extent = {{b.position[0] - 4, b.position[1] - 4, b.position[2] - 4},
                                    {b.position[0] + 4, b.position[1] + 4, b.position[2] + 4},
                                    0,
                                    1};
        rheo_picture_options options = rheo_default_picture_options();
        options.width = WIDTH;
        options.height = HEIGHT;
        options.colour = "none";
        options.extent = &extent;
        options.without_captions = true;
        static unsigned char rgb[3 * WIDTH * HEIGHT];
        OK(rheo_world_render(world, &options, rgb, &error));
        const rheo__camera camera = rheo__camera_for(&extent, NULL, .23 * WIDTH / HEIGHT, .23);
        int seen[2] = {0, 0};
        for (int row = 0; row < HEIGHT; row++)
            for (int column = 0; column < WIDTH; column++) {
                const unsigned char *pixel = rgb + 3 * (WIDTH * row + column);
                const int dark = is_dark_at(&b, &camera, column, row);
                if (dark >= 0 && dark != (pixel[2] > pixel[0]))
                    fail_msg("spin %zu: pixel %d, %d of the ball shows another panel", i, column, row);
                if (dark >= 0)
                    seen[dark]++;
            }
        assert_true(seen[0] > 100 && seen[1] > 100);
        rheo_world_destroy(world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_show_something),
        cmocka_unit_test(temperatures_are_painted),
        cmocka_unit_test(melting_worlds_have_density_and_temperature),
        cmocka_unit_test(each_floor_is_drawn_and_no_other_wall),
        cmocka_unit_test(only_tilted_floors_have_lines_of_equal_height),
        cmocka_unit_test(the_camera_sees_the_whole_extent),
        cmocka_unit_test(lights_move_with_the_extent),
        cmocka_unit_test(a_ball_is_drawn_as_it_lies),
        cmocka_unit_test(the_ball_of_a_world_shows_its_orientation),
        cmocka_unit_test(shades_span_the_range_of_temperatures),
        cmocka_unit_test(shades_are_colours_at_equal_distances),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
