/* Options of files: axes with z up, and surfaces with the values and colours of any quantity. */
#define _XOPEN_SOURCE 700 /* mkdtemp() */
#include "view_support.h"

#include "melting.h"
#include "view/picture.h"

static void export_with(const rheo_world *world, rheo_export_format format, const char *path,
                        rheo_export_options options)
{
    options.surface = rheo_default_surface_options();
    options.force = true;
    OK(rheo_world_export(world, format, path, &options, NULL, &error));
}

/* ---- Axes ---- */

/* A text of 3 numbers, or the same with z up. */
static void turn(const double v[3], bool z_up, double turned[3])
{
    turned[0] = v[0];
    turned[1] = z_up ? -v[2] : v[1];
    turned[2] = z_up ? v[1] : v[2];
}

static double real_at(const char *values, size_t index, size_t size)
{
    const uint64_t bits = little(values + size * index, size);
    const uint32_t half = (uint32_t)bits;
    float single;
    double twice;
    memcpy(&single, &half, sizeof single);
    memcpy(&twice, &bits, sizeof twice);
    return size == 4 ? (double)single : twice;
}

/* Every vector of two VTP files, of which the second has z up. Returns how many arrays of vectors there are. */
static int compare_vtp(const char *y_up, const char *z_up)
{
    size_t size[2];
    int arrays = 0;
    char *text[2] = {(char *)read_file(y_up, &size[0]), (char *)read_file(z_up, &size[1])};
    assert_int_equal(size[0], size[1]);
    const char *data = strstr(text[0], "encoding=\"raw\">\n_");
    for (const char *line = text[0]; line < data; line = strchr(line, '\n') + 1) {
        char name[32];
        uint64_t bytes[2];
        const char *at = strstr(line, "Name=\"");
        if (strncmp(line, "<DataArray", 10) != 0 || strstr(line, "format=\"ascii\"") == strstr(line, "format"))
            continue;
        assert_int_equal(sscanf(at, "Name=\"%31[^\"]", name), 1);
        const char *first = array_of(at, name, &bytes[0]), *second = array_of(text[1], name, &bytes[1]);
        const char *end = strchr(line, '\n');
        if (strcmp(name, "connectivity") == 0 || strcmp(name, "offsets") == 0)
            continue;
        assert_int_equal(bytes[0], bytes[1]);
        const char *three = strstr(line, "NumberOfComponents=\"3\"");
        if (!three || three > end) {
            assert_memory_equal(first, second, bytes[0]);
            continue;
        }
        const size_t width = strstr(line, "Float64") && strstr(line, "Float64") < end ? 8 : 4;
        for (size_t i = 0; i < bytes[0] / width; i += 3) {
            double v[3], w[3], turned[3];
            for (size_t a = 0; a < 3; a++) {
                v[a] = real_at(first, i + a, width);
                w[a] = real_at(second, i + a, width);
            }
            turn(v, true, turned);
            for (int a = 0; a < 3; a++)
                assert_true(turned[a] == w[a] && !(w[a] == 0 && signbit(w[a]) && !signbit(v[a ? 3 - a : 0])));
        }
        arrays++;
    }
    free(text[0]);
    free(text[1]);
    return arrays;
}

/* Positions, velocities, derivatives, normals and the spin of the ball are turned alike; ids, lines and triangles stay. */
static void z_up_turns_every_vector(void **unused)
{
    (void)unused;
    static const struct {
        rheo_export_format format;
        int vectors;
    } FILES[] = {{RHEO_EXPORT_VTP, 4}, {RHEO_EXPORT_SPRINGS, 1}, {RHEO_EXPORT_SOLIDS, 3}, {RHEO_EXPORT_SURFACE, 2}};
    rheo_world *world = lively_world();
    step(world, 3);
    for (size_t f = 0; f < sizeof FILES / sizeof *FILES; f++) {
        export_with(world, FILES[f].format, "y.vtp", (rheo_export_options){.z_up = false});
        export_with(world, FILES[f].format, "z.vtp", (rheo_export_options){.z_up = true});
        assert_int_equal(compare_vtp("y.vtp", "z.vtp"), FILES[f].vectors);
    }
    /* Text: the numbers are those of the other columns, with one sign changed. */
    size_t size;
    export_with(world, RHEO_EXPORT_CSV, "z.csv", (rheo_export_options){.z_up = true});
    char *text = (char *)read_file("z.csv", &size), *at = strchr(text, '\n');
    for (uint32_t i = 0; i < rheo_world_particle_count(world); i++) {
        assert_true(strtod(at, &at) == i);
        for (int vector = 0; vector < 2; vector++) {
            const rheo_real *from =
                (vector ? rheo_world_velocities(world) : rheo_world_positions(world)) + 3 * (size_t)i;
            double turned[3];
            turn((const double[3]){(double)from[0], (double)from[1], (double)from[2]}, true, turned);
            for (int a = 0; a < 3; a++)
                assert_true((double)(rheo_real)strtod(at + 1, &at) == turned[a]);
        }
        at = strchr(at, '\n');
    }
    free(text);
    /* A mesh encloses the same volume: right-handed, the triangles still face outwards. */
    static float position[3 << 16];
    export_with(world, RHEO_EXPORT_PLY, "z.ply", (rheo_export_options){.z_up = true});
    const rheo_surface_options options = rheo_default_surface_options();
    rheo_surface s;
    OK(rheo_world_surface(world, &options, NULL, &s, &error));
    text = (char *)read_file("z.ply", &size);
    const char *vertex = strstr(text, "end_header\n") + 11;
    assert_true(s.vertices < 1 << 16);
    for (size_t i = 0; i < s.vertices; i++)
        for (size_t a = 0; a < 3; a++)
            position[3 * i + a] = (float)real_at(vertex + 24 * i, a, 4);
    rheo_surface turned = s;
    turned.position = position;
    NEAR(volume_of(&turned), volume_of(&s), 1e-3 * volume_of(&s));
    free(text);
    rheo_surface_release(&s);
    rheo_world_destroy(world);
}

/* A picture of the scene with z up is the picture of the scene with y up: camera, lights, floors, ball and its spin turn. */
static void a_scene_with_z_up_has_the_same_picture(void **unused)
{
    (void)unused;
    enum { SIDE = 60 };
    if (system("povray --version >povray.txt 2>&1") != 0) {
        print_message("no povray here: nothing is rendered\n");
        skip();
    }
    rheo_wall slope = {{0, -3, 0}, {.3, 1, .1}};
    rheo_world_def def = inert_def();
    cloud *c = new_cloud();
    add_ball(c, 3, 0, 1, 0);
    def.walls.plane = &slope;
    def.walls.count = 1;
    def.ball.radius = 2;
    def.ball.position[0] = 5;
    def.ball.spin[0] = .7, def.ball.spin[1] = 2, def.ball.spin[2] = -1.1;
    rheo_world *world = world_of(def, c->count, c->position, NULL);
    step(world, 9); /* the ball turns */
    unsigned char *pixels[2];
    for (int up = 0; up < 2; up++) {
        size_t size;
        export_with(world, RHEO_EXPORT_POV, "up.pov", (rheo_export_options){.z_up = up, .colour = "position"});
        assert_int_equal(system("povray +Iup.pov +Oup.ppm +FP +W60 +H60 -D >povray.txt 2>&1"), 0);
        pixels[up] = read_file("up.ppm", &size);
        assert_true(size > 3 * SIDE * SIDE);
        memmove(pixels[up], pixels[up] + size - 3 * SIDE * SIDE, 3 * SIDE * SIDE);
    }
    int away = 0, colours = 0;
    for (int i = 0; i < 3 * SIDE * SIDE; i++) {
        away += abs(pixels[0][i] - pixels[1][i]) > 24;
        colours += abs(pixels[0][i] - pixels[0][0]) > 40;
    }
    assert_true(colours > 1000);
    if (away > 3 * SIDE * SIDE / 100) /* soft shadows are sampled at other places */
        fail_msg("%d of %d values differ", away, 3 * SIDE * SIDE);
    free(pixels[0]);
    free(pixels[1]);
    free(c);
    rheo_world_destroy(world);
}

/* ---- Values and colours of surfaces ---- */

/* Means of the particles, weighted by the kernel, as rheo_surface_make() has them. */
static void surfaces_have_the_values_of_any_quantity(void **unused)
{
    (void)unused;
    static const double range[2] = {-1, 3};
    rheo_world *world = lively_world();
    step(world, 3);
    for (int which = 0; which < 2; which++) {
        const char *colour = which ? "derivative" : "pressure"; /* of the vector the length */
        const uint32_t count = rheo_world_particle_count(world);
        rheo_particle_state *states = calloc(count, sizeof *states);
        rheo_real *value = calloc(count, sizeof *value);
        OK(rheo_world_particles(world, states, &error));
        for (uint32_t i = 0; i < count; i++) {
            const double *d = states[i].derivative;
            value[i] = (rheo_real)(which ? sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) : states[i].pressure);
        }
        const rheo_surface_particles particles = {.count = count,
                                                  .position = rheo_world_positions(world),
                                                  .value = value,
                                                  .spacing = rheo_world_definition(world)->fluid.spacing,
                                                  .smoothing_length = rheo_world_definition(world)->fluid.spacing};
        const rheo_surface_options usual = rheo_default_surface_options();
        const rheo_export_options options = {.colour = colour, .range = range};
        rheo_surface s;
        OK(rheo_surface_make(&particles, &usual, NULL, &s, &error));
        size_t size;
        uint64_t bytes;
        export_with(world, RHEO_EXPORT_SURFACE, "s.vtp", options);
        char *text = (char *)read_file("s.vtp", &size);
        const char *own = array_of(text, colour, &bytes);
        assert_int_equal(bytes, 4 * (uint64_t)s.vertices);
        const double tolerance = which ? 1e-5 * (double)s.value[0] : 1e-6;
        double least = 1e30, most = -1e30;
        for (size_t i = 0; i < s.vertices; i++) {
            NEAR(real_at(own, i, 4), (double)s.value[i], tolerance);
            least = fmin(least, (double)s.value[i]);
            most = fmax(most, (double)s.value[i]);
        }
        assert_true(most > least);
        const char *corner = array_of(text, "connectivity", &bytes);
        assert_int_equal(bytes, 24 * (uint64_t)s.triangles);
        for (size_t i = 0; i < 3 * (size_t)s.triangles; i++)
            assert_int_equal(little(corner + 8 * i, 8), s.triangle[i]);
        free(text);
        /* PLY: the value and the colour of the scale at its place in the range; OBJ: that colour. */
        char property[64];
        export_with(world, RHEO_EXPORT_PLY, "s.ply", options);
        export_with(world, RHEO_EXPORT_OBJ, "s.obj", options);
        text = (char *)read_file("s.ply", &size);
        char *obj = (char *)read_file("s.obj", &size), *at = strstr(obj, "\nv ");
        snprintf(property, sizeof property, "property float %s\nproperty uchar red", colour);
        assert_non_null(strstr(text, property));
        const char *vertex = strstr(text, "end_header\n") + 11;
        for (size_t i = 0; i < s.vertices; i++, vertex += 31) {
            double rgb[3];
            rheo__scale_colour(((double)s.value[i] - range[0]) / (range[1] - range[0]), rgb);
            NEAR(real_at(vertex, 6, 4), (double)s.value[i], tolerance);
            at = strchr(at + 1, 'v') + 1;
            for (int k = 0; k < 3; k++)
                NEAR(strtod(at, &at), (double)s.position[3 * i + (size_t)k],
                     1e-6 * fabs((double)s.position[3 * i + (size_t)k]) + 1e-9);
            for (int k = 0; k < 3; k++) {
                NEAR((unsigned char)vertex[28 + k], 255 * rgb[k], 1);
                NEAR(strtod(at, &at), rgb[k], 1e-3);
            }
            assert_int_equal(*at, '\n');
        }
        free(obj);
        free(text);
        rheo_surface_release(&s);
        free(states);
        free(value);
    }
    rheo_world_destroy(world);
}

/* Without a range it is that of the particles, without the outermost hundredths. */
static void colours_of_a_file_have_the_range_of_pictures(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    step(world, 3);
    double range[2];
    size_t size[2];
    OK(rheo_world_colour_range(world, &(rheo_picture_options){.colour = "density"}, range, &error));
    static const rheo_export_format formats[] = {RHEO_EXPORT_PLY, RHEO_EXPORT_OBJ, RHEO_EXPORT_POV};
    for (int f = 0; f < 3; f++) {
        export_with(world, formats[f], "own", (rheo_export_options){.colour = "density"});
        export_with(world, formats[f], "given", (rheo_export_options){.colour = "density", .range = range});
        unsigned char *own = read_file("own", &size[0]), *given = read_file("given", &size[1]);
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(own, given, size[0]);
        free(given);
        export_with(world, formats[f], "given",
                    (rheo_export_options){.colour = "density", .range = (const double[2]){range[0], range[1] + 1}});
        given = read_file("given", &size[1]);
        assert_true(size[0] != size[1] || memcmp(own, given, size[0]) != 0);
        free(own);
        free(given);
    }
    rheo_world_destroy(world);
}

/* A world with temperatures is painted with them, from blue to red, unless another quantity or none is wanted. */
static void temperatures_are_the_default_and_can_be_replaced(void **unused)
{
    (void)unused;
    rheo_world *world = melting_world(5, NULL);
    const struct {
        const char *colour, *property;
    } cases[] = {{NULL, "temperature"}, {"none", NULL}, {"viscosity", "viscosity"}, {"temperature", "temperature"}};
    unsigned char *first = NULL;
    for (size_t i = 0; i < 4; i++) {
        size_t size;
        char property[64];
        export_with(world, RHEO_EXPORT_PLY, "t.ply", (rheo_export_options){.colour = cases[i].colour});
        char *text = (char *)read_file("t.ply", &size);
        snprintf(property, sizeof property, "property float %s\n", cases[i].property ? cases[i].property : "");
        assert_true((strstr(text, "uchar red") != NULL) == (cases[i].property != NULL));
        if (cases[i].property)
            assert_non_null(strstr(text, property));
        if (i == 3) /* the named quantity has the scale of pictures */
            assert_true(memcmp(first, text, size) != 0);
        if (i == 0)
            first = (unsigned char *)text;
        else
            free(text);
    }
    free(first);
    REFUSED(RHEO_ERROR_ARGUMENT, "\"hue\"",
            rheo_world_export(world, RHEO_EXPORT_SURFACE, "no.vtp",
                              &(rheo_export_options){.surface = rheo_default_surface_options(), .colour = "hue"},
                              NULL, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "must ascend",
            rheo_world_export(world, RHEO_EXPORT_SURFACE, "no.vtp",
                              &(rheo_export_options){.surface = rheo_default_surface_options(),
                                                     .colour = "speed",
                                                     .range = (const double[2]){2, 1}},
                              NULL, &error));
    rheo_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(z_up_turns_every_vector),
        cmocka_unit_test(a_scene_with_z_up_has_the_same_picture),
        cmocka_unit_test(surfaces_have_the_values_of_any_quantity),
        cmocka_unit_test(colours_of_a_file_have_the_range_of_pictures),
        cmocka_unit_test(temperatures_are_the_default_and_can_be_replaced),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
