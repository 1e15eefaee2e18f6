/* Files of particles and surfaces: CSV, VTP, PLY and OBJ. */
#define _XOPEN_SOURCE 700 /* mkdtemp() */
#include "view_support.h"

#include <locale.h>
#include <math.h>

#include "world/world.h"

/* Reads the next number of the text. */
static double next_number(char **text)
{
    *text += strcspn(*text, "+-0123456789");
    return strtod(*text, text);
}

static void csv_reads_back_to_the_same_bits(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    step(world, 3);
    const uint32_t count = rheo_world_particle_count(world);
    assert_int_equal(export_to(world, RHEO_EXPORT_CSV, "a.csv").particles, count);
    size_t size;
    char *text = (char *)read_file("a.csv", &size), *at = text;
    static const char header[] = "id,x,y,z,vx,vy,vz,derivative_x,derivative_y,derivative_z,"
                                 "list_position_x,list_position_y,list_position_z,list_margin,"
                                 "speed,density,near_density,pressure,near_pressure,stiffness,kappa\n";
    assert_int_equal(strncmp(at, header, strlen(header)), 0);
    at = strchr(at, '\n');
    uint32_t stiff = 0;
    const rheo_real *const column[] = {rheo_world_positions(world), rheo_world_velocities(world),
                                       world->state.derivative, world->state.list_position};
    for (uint32_t i = 0; i < count; i++) {
        assert_true(next_number(&at) == i);
        for (size_t a = 0; a < 12; a++) {
            const rheo_real *expected = column[a / 3] + 3 * (size_t)i + a % 3, read = (rheo_real)next_number(&at);
            assert_memory_equal(&read, expected, sizeof read);
        }
        const rheo_real margin = (rheo_real)next_number(&at);
        assert_memory_equal(&margin, &world->state.list_margin[i], sizeof margin);
        rheo_particle_state state;
        OK(rheo_world_particle(world, i, &state, &error));
        const double quantity[] = {state.speed,         state.density,   state.near_density, state.pressure,
                                   state.near_pressure, state.stiffness, state.kappa};
        for (size_t q = 0; q < sizeof quantity / sizeof *quantity; q++) {
            const rheo_real expected = (rheo_real)quantity[q], read = (rheo_real)next_number(&at);
            assert_memory_equal(&read, &expected, sizeof read);
        }
        stiff += state.stiffness > 0 && state.kappa > 0;
        assert_int_equal(*at, '\n');
    }
    assert_string_equal(at, "\n");
    assert_true(stiff > count / 2);
    free(text);
    rheo_world_destroy(world);
}

static void vtp_has_its_arrays(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    step(world, 3);
    const uint32_t count = rheo_world_particle_count(world);
    export_to(world, RHEO_EXPORT_VTP, "a.vtp");
    size_t size;
    char *text = (char *)read_file("a.vtp", &size);
    char points[64];
    snprintf(points, sizeof points, "NumberOfPoints=\"%u\" NumberOfVerts=\"%u\"", count, count);
    assert_non_null(strstr(text, points));
    assert_non_null(strstr(text, "Name=\"TimeValue\""));
    uint64_t bytes;
    const char *id = array_of(text, "id", &bytes);
    assert_int_equal(bytes, 4 * (uint64_t)count);
    assert_int_equal(little(id + 4 * (count - 1), 4), count - 1);
    for (int k = 0; k < 2; k++) {
        const char *values = array_of(text, k ? "velocity" : "position", &bytes);
        const rheo_real *expected = k ? rheo_world_velocities(world) : rheo_world_positions(world);
        assert_int_equal(bytes, 3 * sizeof(rheo_real) * count);
        for (size_t i = 0; i < 3 * (size_t)count; i++) {
            const uint64_t bits = little(values + i * sizeof(rheo_real), sizeof(rheo_real));
            uint64_t wanted = 0;
#if RHEO_DOUBLE
            memcpy(&wanted, &expected[i], 8);
#else
            uint32_t half;
            memcpy(&half, &expected[i], 4);
            wanted = half;
#endif
            assert_int_equal(bits, wanted);
        }
    }
    const char *end = array_of(text, "offsets", &bytes);
    assert_int_equal(bytes, 8 * (uint64_t)count);
    assert_int_equal(little(end + 8 * (count - 1), 8), count);
    assert_string_equal(end + bytes, "\n</AppendedData>\n</VTKFile>\n");
    assert_int_equal((size_t)(end + bytes - text) + strlen("\n</AppendedData>\n</VTKFile>\n"), size);
    free(text);
    rheo_world_destroy(world);
}

static float float_at(const char *values, size_t index)
{
    const uint32_t bits = (uint32_t)little(values + 4 * index, 4);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static rheo_real real_at(const char *values, size_t index)
{
#if RHEO_DOUBLE
    const uint64_t bits = little(values + 8 * index, 8);
#else
    const uint32_t bits = (uint32_t)little(values + 4 * index, 4);
#endif
    rheo_real value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void lines_are_the_springs(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    step(world, 3);
    export_to(world, RHEO_EXPORT_SPRINGS, "springs.vtp");
    size_t size;
    uint64_t bytes;
    char *text = (char *)read_file("springs.vtp", &size);
    const size_t count = rheo_world_spring_count(world);
    const char *ends = array_of(text, "connectivity", &bytes), *stretch = array_of(text, "stretch", &bytes),
               *stiffness = array_of(text, "stiffness", &bytes), *kappa = array_of(text, "kappa", &bytes);
    assert_int_equal(bytes, count * sizeof(rheo_real));
    assert_true(count > 100);
    for (size_t i = 0; i < count; i++) {
        const uint32_t a = (uint32_t)little(ends + 16 * i, 8), b = (uint32_t)little(ends + 16 * i + 8, 8);
        rheo_spring_state spring;
        OK(rheo_world_spring(world, a, b, &spring, &error));
        assert_true(real_at(stretch, i) == (rheo_real)(spring.length - (double)spring.spring.rest_length));
        assert_true(real_at(stiffness, i) == (rheo_real)spring.stiffness);
        assert_true(real_at(kappa, i) == (rheo_real)spring.kappa);
    }
    const char *position = array_of(text, "position", &bytes);
    for (size_t i = 0; i < 3 * (size_t)rheo_world_particle_count(world); i++)
        assert_true(real_at(position, i) == rheo_world_positions(world)[i]);
    free(text);
    rheo_world_destroy(world);
}

/* The points of vibrators, walls and balls lie where these are; every edge of a ball belongs to two triangles. */
static void solids_are_ball_walls_and_vibrators(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    step(world, 3);
    rheo_body ball;
    OK(rheo_world_body(world, 0, &ball));
    export_to(world, RHEO_EXPORT_SOLIDS, "solids.vtp");
    size_t size, front = 0;
    uint64_t bytes, cells;
    char *text = (char *)read_file("solids.vtp", &size);
    assert_non_null(strstr(text, "NumberOfLines=\"0\""));
    const uint32_t walls = rheo_world_definition(world)->walls.count, vibrators = rheo_world_vibrator_count(world);
    const char *points = array_of(text, "position", &bytes), *kind = array_of(text, "kind", &cells),
               *panel = array_of(text, "panel", &cells);
    for (uint32_t i = 0; i < vibrators + 4 * walls; i++) {
        if (i < vibrators) {
            rheo_vibrator vibrator;
            OK(rheo_world_vibrator(world, i, &vibrator));
            NEAR((double)float_at(points, 3 * i), vibrator.x, 1e-5);
            continue;
        }
        const rheo_wall *wall = &rheo_world_definition(world)->walls.plane[(i - vibrators) / 4];
        double off = 0;
        for (size_t k = 0; k < 3; k++)
            off += wall->normal[k] * ((double)float_at(points, 3 * i + k) - wall->point[k]);
        NEAR(off, 0, 1e-3);
    }
    /* Each vibrator is its own point; walls have four corners and triangles three, in the order of the points. */
    assert_true(vibrators > 1 && walls > 1);
    const char *verts = strstr(text, "<Verts>"), *polys = strstr(text, "<Polys>");
    const char *own = array_of(verts, "connectivity", &bytes), *own_end = array_of(verts, "offsets", &bytes);
    assert_int_equal(bytes, 8 * (uint64_t)vibrators);
    for (uint32_t i = 0; i < vibrators; i++)
        assert_true(little(own + 8 * i, 8) == i && little(own_end + 8 * i, 8) == i + 1);
    const char *corners = array_of(polys, "connectivity", &bytes), *ends = array_of(polys, "offsets", &bytes);
    for (uint32_t i = 0; i < 4 * walls; i++)
        assert_int_equal(little(corners + 8 * i, 8), vibrators + i);
    for (uint32_t i = 0; i < bytes / 8; i++)
        assert_int_equal(little(ends + 8 * i, 8), i < walls ? 4 * (i + 1) : 4 * walls + 3 * (i - walls + 1));
    uint32_t of_kind[3] = {0};
    for (size_t i = 0; i < cells / 4; i++)
        of_kind[little(kind + 4 * i, 4)]++;
    assert_int_equal(of_kind[0], walls);
    assert_int_equal(of_kind[2], vibrators);
    /* Of each triangle: corners on the sphere, normal outwards, panel by the octant in the ball's own axes. */
    const char *polygons = strstr(text, "<Polys>"), *corner = array_of(polygons, "connectivity", &bytes);
    for (uint32_t t = 0; t < of_kind[1]; t++) {
        double x[3][3], n[3], mean[3] = {0, 0, 0}, outwards = 0;
        for (int c = 0; c < 3; c++)
            for (size_t k = 0; k < 3; k++) {
                const size_t point = (size_t)little(corner + 8 * (4 * (size_t)walls + 3 * t + (size_t)c), 8);
                x[c][k] = (double)float_at(points, 3 * point + k) - ball.position[k];
                mean[k] += x[c][k] / 3;
            }
        for (int c = 0; c < 3; c++)
            NEAR(x[c][0] * x[c][0] + x[c][1] * x[c][1] + x[c][2] * x[c][2], ball.radius * ball.radius, 1e-3);
        for (int k = 0; k < 3; k++) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            n[k] = (x[1][a] - x[0][a]) * (x[2][b] - x[0][b]) - (x[1][b] - x[0][b]) * (x[2][a] - x[0][a]);
            outwards += n[k] * mean[k];
        }
        assert_true(outwards > 0);
        front += little(panel + 4 * (vibrators + walls + t), 4);
    }
    assert_int_equal(2 * front, of_kind[1]);
    free(text);
    rheo_world_destroy(world);
}

static uint64_t attribute(const char *at, const char *name)
{
    char head[40];
    snprintf(head, sizeof head, "%s=\"", name);
    at = strstr(at, head);
    assert_non_null(at);
    return strtoull(at + strlen(head), NULL, 10);
}

/* The cells of an element: each ends later than the one before it, by `least` to `most` points, and has points of the file. */
static void check_cells(const char *text, const char *element, uint64_t cells, uint64_t points, size_t least,
                        size_t most)
{
    uint64_t bytes, ends_bytes, from = 0;
    const char *at = strstr(text, element);
    assert_non_null(at);
    const char *corners = array_of(at, "connectivity", &bytes), *ends = array_of(at, "offsets", &ends_bytes);
    assert_int_equal(ends_bytes, 8 * cells);
    for (uint64_t i = 0; i < cells; i++) {
        const uint64_t end = little(ends + 8 * i, 8);
        assert_true(end >= from + least && end <= from + most);
        for (uint64_t k = from; k < end; k++) {
            const uint64_t corner = little(corners + 8 * k, 8);
            assert_true(corner < points);
            for (uint64_t other = from; other < k; other++)
                assert_true(little(corners + 8 * other, 8) != corner);
        }
        from = end;
    }
    assert_int_equal(bytes, 8 * from);
}

/*
 * As a reader of VTP sees a file: each array begins where the one before it ends, and has as many bytes as its type, its
 * components and the points or cells say; cells name points of the file; nothing follows the last array.
 */
static void vtp_files_are_whole(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    static const struct {
        rheo_export_format format;
        size_t arrays;
    } FILES[] = {{RHEO_EXPORT_VTP, 6}, {RHEO_EXPORT_SPRINGS, 5}, {RHEO_EXPORT_SOLIDS, 6}};
    step(world, 3);
    for (size_t f = 0; f < 3; f++) {
        size_t size, arrays = 0;
        export_to(world, FILES[f].format, "whole.vtp");
        char *text = (char *)read_file("whole.vtp", &size);
        const uint64_t points = attribute(text, "NumberOfPoints"), verts = attribute(text, "NumberOfVerts"),
                       lines = attribute(text, "NumberOfLines"), polys = attribute(text, "NumberOfPolys");
        const char *data = strstr(text, "encoding=\"raw\">\n_"), *section = "";
        assert_non_null(data);
        const size_t begin = (size_t)(data - text) + strlen("encoding=\"raw\">\n_");
        uint64_t offset = 0;
        const char *line = text;
        for (; line < data; line = strchr(line, '\n') + 1) {
            static const char *const SECTIONS[] = {"<PointData", "<CellData", "<Points>",
                                                   "<Verts>",    "<Lines>",   "<Polys>"};
            for (size_t s = 0; s < 6; s++)
                section = strncmp(line, SECTIONS[s], strlen(SECTIONS[s])) == 0 ? SECTIONS[s] : section;
            if (strncmp(line, "<DataArray", 10) != 0 || !strstr(line, "offset") ||
                strstr(line, "offset") > strchr(line, '\n'))
                continue;
            const uint64_t bytes = little(text + begin + offset, 8);
            const size_t width = strncmp(strstr(line, "type=\"") + 6, "Float64", 7) == 0 ||
                                         strncmp(strstr(line, "type=\"") + 6, "UInt64", 6) == 0 ||
                                         strncmp(strstr(line, "type=\"") + 6, "Int64", 5) == 0
                                     ? 8
                                     : 4;
            assert_int_equal(attribute(line, "offset"), offset);
            if (strncmp(section, "<Point", 6) == 0)
                assert_int_equal(bytes, points * attribute(line, "NumberOfComponents") * width);
            if (strcmp(section, "<CellData") == 0)
                assert_int_equal(bytes, (verts + lines + polys) * attribute(line, "NumberOfComponents") * width);
            offset += 8 + bytes;
            arrays++;
        }
        if (arrays < FILES[f].arrays)
            fail_msg("file %zu has only %zu arrays", f, arrays);
        static const char end[] = "\n</AppendedData>\n</VTKFile>\n";
        assert_int_equal(begin + offset + strlen(end), size);
        assert_string_equal(text + begin + offset, end);
        if (verts)
            check_cells(text, "<Verts>", verts, points, 1, 1);
        if (lines)
            check_cells(text, "<Lines>", lines, points, 2, 2);
        if (polys)
            check_cells(text, "<Polys>", polys, points, 3, 4);
        assert_true(verts + lines + polys > 2);
        if (f == 0) { /* particles are numbered from 0 */
            uint64_t bytes;
            const char *id = array_of(text, "id", &bytes);
            for (uint64_t i = 0; i < points; i++)
                assert_int_equal(little(id + 4 * i, 4), i);
        }
        free(text);
    }
    rheo_world_destroy(world);
}

/* The square of a wall that is normal to an axis has its edges along the other two, and its middle nearest to the centre. */
static void squares_of_walls_are_parallel_to_the_axes(void **unused)
{
    (void)unused;
    for (int axis = 0; axis < 3; axis++) {
        rheo_world_def def = inert_def();
        const rheo_real position[6] = {1, 2, 3, 5, 8, 4}; /* the centre is (3, 5, 3.5) */
        def.walls.plane = some_walls();
        def.walls.count = 1;
        walls_of(&def)[0] = (rheo_wall){{-7, -7, -7}, {0, 0, 0}};
        walls_of(&def)[0].normal[axis] = 2;
        rheo_world *world = world_of(def, 2, position, NULL);
        export_to(world, RHEO_EXPORT_SOLIDS, "wall.vtp");
        size_t size;
        uint64_t bytes;
        char *text = (char *)read_file("wall.vtp", &size);
        const char *points = array_of(text, "position", &bytes);
        const rheo_extent extent = rheo_world_extent(world);
        assert_int_equal(bytes, 4 * 3 * sizeof(float));
        double side = 0;
        for (size_t k = 0; k < 3; k++) {
            double sum = 0;
            for (size_t corner = 0; corner < 4; corner++) {
                const double at = (double)float_at(points, 3 * corner + k),
                             to = (double)float_at(points, 3 * ((corner + 1) % 4) + k);
                sum += at;
                side = fmax(side, fabs(to - at));
            }
            NEAR(sum / 4, k == (size_t)axis ? -7 : (extent.min[k] + extent.max[k]) / 2, 1e-5);
        }
        assert_true(side > 5);
        for (size_t corner = 0; corner < 4; corner++) {
            int along = 0;
            for (size_t k = 0; k < 3; k++) {
                const double way = fabs((double)float_at(points, 3 * corner + k) -
                                        (double)float_at(points, 3 * ((corner + 1) % 4) + k));
                along += way > .5 * side;
                assert_true(way < 1e-5 * side || way > (1 - 1e-5) * side);
            }
            assert_int_equal(along, 1);
        }
        free(text);
        rheo_world_destroy(world);
    }
}

static void meshes_are_the_surface(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    rheo_surface s;
    const rheo_surface_options options = rheo_default_surface_options();
    OK(rheo_world_surface(world, &options, NULL, &s, &error));
    assert_closed(&s);
    NEAR(volume_of(&s) / (rheo_world_particle_count(world) * 8), 1, .25); /* compressed by gravity */
    assert_int_equal(export_to(world, RHEO_EXPORT_PLY, "a.ply").triangles, s.triangles);
    size_t size;
    char *text = (char *)read_file("a.ply", &size);
    const char *at = strstr(text, "end_header\n") + 11;
    assert_int_equal(size - (size_t)(at - text), 24 * (size_t)s.vertices + 13 * (size_t)s.triangles);
    for (size_t i = 0; i < s.vertices; i++, at += 24)
        for (int a = 0; a < 3; a++) {
            uint32_t bits[2];
            memcpy(&bits[0], &s.position[3 * i + a], 4);
            memcpy(&bits[1], &s.normal[3 * i + a], 4);
            assert_int_equal(little(at + 4 * a, 4), bits[0]);
            assert_int_equal(little(at + 12 + 4 * a, 4), bits[1]);
        }
    for (size_t t = 0; t < s.triangles; t++, at += 13) {
        assert_int_equal(at[0], 3);
        assert_int_equal(little(at + 5, 4), s.triangle[3 * t + 1]);
    }
    free(text);
    assert_int_equal(export_to(world, RHEO_EXPORT_OBJ, "a.obj").vertices, s.vertices);
    char *obj = (char *)read_file("a.obj", &size), *o = strchr(obj, '\n');
    for (int part = 0; part < 2; part++)
        for (size_t i = 0; i < 3 * (size_t)s.vertices; i++) {
            const float read = (float)next_number(&o);
            assert_memory_equal(&read, &(part ? s.normal : s.position)[i], sizeof read);
        }
    for (size_t i = 0; i < 3 * (size_t)s.triangles; i++) {
        assert_true(next_number(&o) == s.triangle[i] + 1);
        assert_true(next_number(&o) == s.triangle[i] + 1);
    }
    assert_string_equal(o, "\n");
    free(obj);
    rheo_surface_release(&s);
    rheo_world_destroy(world);
}

static void numbers_are_the_same_in_every_locale(void **unused)
{
    (void)unused;
    rheo_world *world = lively_world();
    for (uint32_t f = 0; rheo_export_format_name(f); f++)
        export_to(world, (rheo_export_format)f, rheo_export_format_name(f));
    if (!setlocale(LC_ALL, "de_DE.UTF-8")) {
        rheo_world_destroy(world);
        print_message("no German locale here: nothing to compare\n");
        skip();
    }
    for (uint32_t f = 0; rheo_export_format_name(f); f++) {
        size_t size[2];
        export_to(world, (rheo_export_format)f, "german");
        char *plain = (char *)read_file(rheo_export_format_name(f), &size[0]),
             *german = (char *)read_file("german", &size[1]);
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(plain, german, size[0]);
        free(plain);
        free(german);
    }
    setlocale(LC_ALL, "C");
    rheo_world_destroy(world);
}

static void files_are_kept_without_force(void **unused)
{
    (void)unused;
    rheo_world_def def = inert_def();
    rheo_world *world = world_of(def, 0, NULL, NULL);
    const rheo_export_options options = {.surface = rheo_default_surface_options(), .force = false};
    for (uint32_t f = 0; rheo_export_format_name(f); f++) { /* a world without particles has valid files */
        char path[16];
        snprintf(path, sizeof path, "none.%s", rheo_export_format_name(f));
        OK(rheo_world_export(world, (rheo_export_format)f, path, &options, NULL, &error));
        REFUSED(RHEO_ERROR_ARGUMENT, path,
                rheo_world_export(world, (rheo_export_format)f, path, &options, NULL, &error));
    }
    size_t size;
    char *text = (char *)read_file("none.csv", &size);
    assert_int_equal(strncmp(text, "id,x,y,z,vx,vy,vz,speed,density,", 32), 0);
    assert_ptr_equal(strchr(text, '\n'), text + size - 1);
    free(text);
    text = (char *)read_file("none.ply", &size);
    assert_non_null(strstr(text, "element vertex 0\n"));
    free(text);
    REFUSED(RHEO_ERROR_FILE, "no/such", rheo_world_export(world, 0, "no/such/file", &options, NULL, &error));
    rheo_exported none = {1, 1, 1, 1};
    REFUSED(RHEO_ERROR_ARGUMENT, "format", rheo_world_export(world, 99, "x", &options, &none, &error));
    assert_int_equal(none.particles + none.vertices + none.triangles + none.left_out, 0);
    assert_null(rheo_export_format_name(99));
    rheo_world_destroy(world);
}

static void *allocate_zeros(size_t bytes, void *user)
{
    (void)user;
    return calloc(1, bytes);
}

static void release_zeros(void *memory, void *user)
{
    (void)user;
    free(memory);
}

static void an_empty_world_has_the_extent_of_a_unit_cube(void **unused)
{
    (void)unused;
    rheo_world *world = world_of(inert_def(), 0, NULL, NULL);
    const rheo_extent e = rheo_world_extent(world);
    for (int a = 0; a < 3; a++)
        assert_true(e.min[a] == 0 && e.max[a] == 1);
    rheo_world_destroy(world);
}

static void an_outlier_does_not_widen_pictures(void **unused)
{
    (void)unused;
    cloud *c = new_cloud();
    add_ball(c, 5, 2, 3, 4);
    add(c, 1e6, 0, 0);
    add(c, 0, 1e20, 0);
    rheo_world *world = world_of(inert_def(), c->count, c->position, NULL);
    const rheo_extent e = rheo_world_extent(world);
    for (int a = 0; a < 3; a++) {
        NEAR(e.min[a], a - 3 - .5, 1e-6);
        NEAR(e.max[a], a + 7 + .5, 1e-6);
    }
    rheo_world_destroy(world);
    /* The memory behind the last particle, which would be a second outlier at the origin, counts as little. */
    c->count = 0;
    add_ball(c, 2.3, 100, 0, 0);
    add(c, 200, 0, 0);
    rheo_world_def def = inert_def();
    def.allocator = (rheo_allocator){allocate_zeros, release_zeros, NULL};
    world = world_of(def, c->count, c->position, NULL);
    NEAR(rheo_world_extent(world).max[0], 102.5, 1e-6);
    rheo_world_destroy(world);
    /* Two particles are too few to have an outlier. */
    world = world_of(inert_def(), 2, (const rheo_real[6]){0, 0, 0, 1000, 0, 0}, NULL);
    NEAR(rheo_world_extent(world).max[0], 1000.5, 1e-6);
    rheo_world_destroy(world);
    free(c);
}

/* A ball is in the picture from end to end, unless it is far away. */
static void a_ball_near_the_fluid_widens_pictures(void **unused)
{
    (void)unused;
    const rheo_real corners[6] = {0, 0, 0, 9, 9, 9}; /* the fluid reaches from -.5 to 9.5 */
    rheo_world_def def = inert_def();
    def.ball.radius = 2;
    for (int side = 0; side < 2; side++)
        for (int along = 0; along < 3; along++) {
            const double middle[3] = {4, 5, 6}, place = side ? 13 : -4;
            for (int a = 0; a < 3; a++)
                def.ball.position[a] = a == along ? place : middle[a];
            rheo_world *world = world_of(def, 2, corners, NULL);
            rheo_extent e = rheo_world_extent(world);
            for (int a = 0; a < 3; a++) {
                NEAR(e.min[a], a == along && !side ? place - 2 : -.5, 1e-6);
                NEAR(e.max[a], a == along && side ? place + 2 : 9.5, 1e-6);
            }
            rheo_world_destroy(world);
            def.ball.position[along] *= 1000;
            world = world_of(def, 2, corners, NULL);
            e = rheo_world_extent(world);
            for (int a = 0; a < 3; a++) {
                NEAR(e.min[a], -.5, 1e-6);
                NEAR(e.max[a], 9.5, 1e-6);
            }
            rheo_world_destroy(world);
        }
}

static void collections_name_files(void **unused)
{
    (void)unused;
    static const char *const files[] = {"a_000000.vtp", "b&\"<.vtp"};
    OK(rheo_export_collection("c.pvd", 2, files, (const double[2]){0, .1}, false, &error));
    size_t size;
    char *text = (char *)read_file("c.pvd", &size);
    assert_non_null(strstr(text, "<DataSet timestep=\"0.1\" part=\"0\" file=\"b&amp;&quot;&lt;.vtp\"/>"));
    free(text);
    REFUSED(RHEO_ERROR_ARGUMENT, "c.pvd", rheo_export_collection("c.pvd", 0, NULL, NULL, false, &error));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(csv_reads_back_to_the_same_bits),
        cmocka_unit_test(vtp_has_its_arrays),
        cmocka_unit_test(vtp_files_are_whole),
        cmocka_unit_test(squares_of_walls_are_parallel_to_the_axes),
        cmocka_unit_test(meshes_are_the_surface),
        cmocka_unit_test(numbers_are_the_same_in_every_locale),
        cmocka_unit_test(files_are_kept_without_force),
        cmocka_unit_test(an_empty_world_has_the_extent_of_a_unit_cube),
        cmocka_unit_test(an_outlier_does_not_widen_pictures),
        cmocka_unit_test(a_ball_near_the_fluid_widens_pictures),
        cmocka_unit_test(collections_name_files),
        cmocka_unit_test(lines_are_the_springs),
        cmocka_unit_test(solids_are_ball_walls_and_vibrators),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
