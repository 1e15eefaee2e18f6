/* Meshes: closedness, and which points are inside. */
#include "mesh_support.h"

/* ---- Points inside ---- */

enum { SIDE = 64, HALF = SIDE / 2 };

/* Points of -HALF..HALF-1 along each axis that a scan reported, each at most once and in order. */
typedef struct points {
    uint8_t inside[SIDE][SIDE][SIDE]; /* z, y, x */
    int64_t count, last[3];
} points;

static bool mark(void *user, int64_t x, int64_t end, int64_t y, int64_t z)
{
    points *p = user;
    assert_true(x < end && x >= -HALF && end <= HALF && y >= -HALF && y < HALF && z >= -HALF && z < HALF);
    assert_true(p->count == 0 || z > p->last[2] ||
                (z == p->last[2] && (y > p->last[1] || (y == p->last[1] && x >= p->last[0]))));
    for (; x < end; x++) {
        assert_false(p->inside[z + HALF][y + HALF][x + HALF]);
        p->inside[z + HALF][y + HALF][x + HALF] = 1;
        p->count++;
    }
    p->last[0] = end;
    p->last[1] = y;
    p->last[2] = z;
    return true;
}

static points *scan(const rheo__mesh *mesh, double scale, double shift)
{
    const rheo__mesh_frame frame = {{0, 0, 0}, scale, {shift, shift, shift}};
    points *p = calloc(1, sizeof *p);
    assert_non_null(p);
    OK(rheo__mesh_scan(mesh, &frame, mark, p, &error));
    return p;
}

static bool is_inside(const points *p, int x, int y, int z)
{
    return p->inside[z + HALF][y + HALF][x + HALF];
}

#define EACH_POINT(x, y, z)                \
    for (int z = -HALF; z < HALF; z++)     \
        for (int y = -HALF; y < HALF; y++) \
            for (int x = -HALF; x < HALF; x++)

/* ---- Tests: closedness ---- */

static void holes_are_named(void **unused)
{
    (void)unused;
    static const struct {
        const char *faces, *parts[4];
    } cases[] = {
        /* the top, y = 2, is missing */
        {"f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 4 1 5 8\n",
         {"4 open edges around 1 hole,", "with 4 edges around (1, 2, 1)", "counted from 1", "a.obj: "}},
        /* a triangle of the bottom and the whole top are missing */
        {"f 4 3 2 1\nf 5 6 7 8\nf 1 2 6\nf 2 3 7 6\nf 4 1 5 8\n",
         {"7 open edges around 2 holes", "with 4 edges around (1, 2, 1)"}},
        {"f 1 2 3\n", {"3 open edges around 1 hole", "3 edges around (1.33333, 0.666667, 0)"}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[512];
        rheo__mesh mesh;
        rheo_error error = {""};
        snprintf(text, sizeof text, "%s%s", CUBE_VERTICES, cases[i].faces);
        assert_int_equal(rheo__mesh_read(&mesh, &defaults, text, strlen(text), "a.obj", &error), RHEO_ERROR_FORMAT);
        for (size_t k = 0; k < 4 && cases[i].parts[k]; k++)
            if (!strstr(error.message, cases[i].parts[k]))
                fail_msg("\"%s\" is missing in \"%s\"", cases[i].parts[k], error.message);
    }
    /* The named edge is one of the hole, with the direction of the missing triangle. */
    rheo__mesh mesh;
    rheo__mesh_init(&mesh, &defaults, 0);
    add_cube(&mesh, 0, 1, 1);
    mesh.triangles--; /* 3, 4, 7 */
    rheo_error named = {""};
    assert_int_equal(rheo__mesh_check(&mesh, "cube", &named), RHEO_ERROR_FORMAT);
    assert_true(strstr(named.message, "from vertex 3 to 4,") || strstr(named.message, "from vertex 4 to 7,") ||
                strstr(named.message, "from vertex 7 to 3,"));
    rheo__mesh_release(&mesh);
    /* Every missing triangle of the bunny is noticed, with its three edges. */
    for (size_t missing = 0; missing < 3674; missing += 97) {
        OK(rheo__mesh_open(&mesh, &defaults, "bunny", &error));
        memmove(mesh.triangle + 3 * missing, mesh.triangle + 3 * missing + 3,
                (mesh.triangles - missing - 1) * 3 * sizeof *mesh.triangle);
        mesh.triangles--;
        REFUSED(RHEO_ERROR_FORMAT, "3 open edges around 1 hole", rheo__mesh_check(&mesh, "b", &error));
        rheo__mesh_release(&mesh);
    }
}

/* Holes that meet in a vertex are followed one by one, and each isolated triangle is a hole. */
static void many_holes_are_counted(void **unused)
{
    (void)unused;
    rheo__mesh mesh;
    rheo__mesh_init(&mesh, &defaults, 0);
    for (uint32_t i = 0; i < 3000; i++) {
        add_vertex(&mesh, i, 0, 0);
        add_vertex(&mesh, i, 1, 0);
        if (i == 0)
            add_vertex(&mesh, 0, 0, 5);
        add_triangle(&mesh, 2, i ? 2 * i + 1 : 0, i ? 2 * i + 2 : 1); /* all around one vertex */
    }
    REFUSED(RHEO_ERROR_FORMAT, "9000 open edges around 3000 holes, the largest with 3 edges",
            rheo__mesh_check(&mesh, "fans", &error));
    rheo__mesh_release(&mesh);
}

static void other_faults_of_edges_are_named(void **unused)
{
    (void)unused;
    static const char turned[] = CUBE_VERTICES "f 4 3 2 1\nf 8 7 6 5\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";
    rheo__mesh mesh;
    REFUSED(RHEO_ERROR_FORMAT, "between vertices 5 and 6, counted from 1, are oriented differently",
            rheo__mesh_read(&mesh, &defaults, turned, strlen(turned), "a.obj", &error));
    char text[512];
    snprintf(text, sizeof text, "%sf 1 2 8\n", cube_text);
    REFUSED(RHEO_ERROR_FORMAT, "3 triangles share the edge between vertices 1 and 2",
            rheo__mesh_read(&mesh, &defaults, text, strlen(text), "a.obj", &error));
}

static void a_mesh_inside_out_is_turned_and_degenerate_triangles_do_no_harm(void **unused)
{
    (void)unused;
    rheo__mesh good, bad;
    rheo__mesh_init(&good, &defaults, 0);
    rheo__mesh_init(&bad, &defaults, 0);
    add_cube(&good, -3, 7, 1);
    add_cube(&bad, -3, 7, -1);
    add_triangle(&bad, 1, 1, 2);
    add_triangle(&bad, 5, 3, 5);
    OK(rheo__mesh_check(&good, "a", &error));
    OK(rheo__mesh_check(&bad, "a", &error));
    assert_true(good.volume == 343 && bad.volume == 343);
    assert_same_mesh(&good, &bad);
    rheo__mesh_release(&bad);
    /* A degenerate triangle between two others: its corners lie on a line, so every row sees its edge. */
    static const char text[] = CUBE_VERTICES "v 1 0 0\nf 1 4 3\nf 3 2 1\nf 1 2 9\nf 5 6 7 8\nf 5 1 9 2 6\n"
                                             "f 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";
    bad = read_good(text, "a.obj");
    assert_true(bad.volume == 8);
    points *p = scan(&bad, 4, -3);
    assert_int_equal(p->count, 512);
    free(p);
    rheo__mesh_release(&bad);
    rheo__mesh_release(&good);
}

/* ---- Tests: inside ---- */

/* Rows through faces, edges and vertices: half of the boundary points are inside. */
static void a_cube_on_the_lattice_is_half_open(void **unused)
{
    (void)unused;
    for (int turned = 0; turned < 2; turned++) {
        rheo__mesh mesh;
        rheo__mesh_init(&mesh, &defaults, 0);
        add_cube(&mesh, -3, 7, turned ? -1 : 1);
        OK(rheo__mesh_check(&mesh, "cube", &error));
        points *p = scan(&mesh, 1, 0);
        EACH_POINT(x, y, z)
        assert_int_equal(is_inside(p, x, y, z), x >= -3 && x < 4 && y >= -3 && y < 4 && z >= -3 && z < 4);
        free(p);
        rheo__mesh_release(&mesh);
    }
}

static double magnitude(double x)
{
    return x < 0 ? -x : x;
}

/* All six vertices and twelve edges are on rows. The tie rule is the one in mesh.h. */
static void an_octahedron_on_the_lattice_follows_the_rule(void **unused)
{
    (void)unused;
    for (int radius = 1; radius <= 16; radius++) {
        rheo__mesh mesh = octahedron(radius);
        points *p = scan(&mesh, 1, 0);
        EACH_POINT(x, y, z)
        assert_int_equal(is_inside(p, x, y, z),
                         magnitude(x + 1e-3) + magnitude(y + 1e-6) + magnitude(z + 1e-9) < radius);
        free(p);
        rheo__mesh_release(&mesh);
    }
}

/* Six tetrahedra form a cube. Each of its points is in exactly one, including faces, edges and the diagonal. */
static void meshes_that_share_faces_share_no_point(void **unused)
{
    (void)unused;
    static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    int *times = calloc(SIDE * SIDE * SIDE, sizeof *times);
    assert_non_null(times);
    for (int t = 0; t < 6; t++) {
        rheo__mesh mesh;
        double corner[3] = {-8, -8, -8};
        rheo__mesh_init(&mesh, &defaults, 0);
        add_vertex(&mesh, corner[0], corner[1], corner[2]);
        for (int k = 0; k < 3; k++) {
            corner[order[t][k]] = 8;
            add_vertex(&mesh, corner[0], corner[1], corner[2]);
        }
        add_triangle(&mesh, 0, 2, 1);
        add_triangle(&mesh, 0, 1, 3);
        add_triangle(&mesh, 1, 2, 3);
        add_triangle(&mesh, 2, 0, 3);
        OK(rheo__mesh_check(&mesh, "tetrahedron", &error));
        points *p = scan(&mesh, 1, 0);
        int *at = times;
        EACH_POINT(x, y, z)
        *at++ += is_inside(p, x, y, z);
        free(p);
        rheo__mesh_release(&mesh);
    }
    const int *at = times;
    EACH_POINT(x, y, z)
    assert_int_equal(*at++, x >= -8 && x < 8 && y >= -8 && y < 8 && z >= -8 && z < 8);
    free(times);
}

/* Rotation and mirroring do not change whether points away from the surface are inside. */
static void turned_and_mirrored_copies_have_the_same_points(void **unused)
{
    (void)unused;
    for (int turn = 0; turn < 12; turn++) {
        double a = 0.3 * turn, b = 0.7 * turn, ca = __builtin_cos(a), sa = __builtin_sin(a), cb = __builtin_cos(b),
               sb = __builtin_sin(b), mirror = turn % 2 ? -1 : 1;
        rheo__mesh mesh = octahedron(20);
        for (size_t v = 0; v < mesh.vertices; v++) {
            double *at = mesh.vertex + 3 * v, x = mirror * at[0], y = at[1], z = at[2];
            double u = ca * x - sa * y, w = sa * x + ca * y;
            at[0] = u;
            at[1] = cb * w - sb * z;
            at[2] = sb * w + cb * z;
        }
        OK(rheo__mesh_check(&mesh, "turned", &error));
        NEAR(mesh.volume, 4 / 3. * 8000, 1e-8);
        points *p = scan(&mesh, 1, 0);
        EACH_POINT(x, y, z)
        {
            double w = cb * y + sb * z, depth = cb * z - sb * y, u = ca * x + sa * w, v = ca * w - sa * x;
            double sum = magnitude(u) + magnitude(v) + magnitude(depth);
            if (magnitude(sum - 20) > 1e-9)
                assert_int_equal(is_inside(p, x, y, z), sum < 20);
        }
        free(p);
        rheo__mesh_release(&mesh);
    }
}

static void a_torus_has_a_hole_through_it(void **unused)
{
    (void)unused;
    rheo__mesh mesh = torus(20, 8, 200, 100);
    assert_int_equal(mesh.triangles, 40000);
    NEAR(mesh.volume, 2 * 3.14159265 * 3.14159265 * 20 * 64, 30);
    points *p = scan(&mesh, 1, 0);
    EACH_POINT(x, y, z)
    {
        double ring = __builtin_sqrt((double)(x * x + z * z)) - 20, away = __builtin_sqrt(ring * ring + y * y);
        if (magnitude(away - 8) > 0.02)
            assert_int_equal(is_inside(p, x, y, z), away < 8);
    }
    assert_false(is_inside(p, 0, 0, 0));
    NEAR((double)p->count, mesh.volume, 0.03 * mesh.volume); /* a disc of radius 8 has 197 points, not 201 */
    free(p);
    rheo__mesh_release(&mesh);
}

static void pieces_and_cavities_count(void **unused)
{
    (void)unused;
    rheo__mesh mesh;
    rheo__mesh_init(&mesh, &defaults, 0);
    add_cube(&mesh, -10, 12, 1);
    add_cube(&mesh, -8, 4, -1); /* a cavity */
    add_cube(&mesh, 20, 5, 1);  /* separate */
    add_cube(&mesh, 0, 4, 1);   /* overlaps the first */
    OK(rheo__mesh_check(&mesh, "pieces", &error));
    points *p = scan(&mesh, 1, 0);
    assert_int_equal(p->count, 12 * 12 * 12 - 4 * 4 * 4 + 5 * 5 * 5 + 4 * 4 * 4 - 2 * 2 * 2);
    assert_false(is_inside(p, -6, -6, -6));
    assert_true(is_inside(p, 1, 1, 1) && is_inside(p, 3, 3, 3) && is_inside(p, 22, 22, 22));
    free(p);
    rheo__mesh_release(&mesh);
}

static bool add_run(void *user, int64_t x, int64_t end, int64_t y, int64_t z)
{
    (void)y, (void)z;
    *(int64_t *)user += end - x;
    return true;
}

static bool stop(void *user, int64_t x, int64_t end, int64_t y, int64_t z)
{
    (void)x, (void)end, (void)y, (void)z;
    ++*(int *)user;
    return false;
}

/* A hundred thousand triangles and a million points: not every triangle is tried for every row. */
static void large_meshes_are_fast(void **unused)
{
    (void)unused;
    rheo__mesh mesh = torus(2, 1, 400, 125);
    const rheo__mesh_frame frame = {{0, 0, 0}, 30, {0, 0, 0}};
    int64_t count = 0;
    int calls = 0;
    assert_int_equal(mesh.triangles, 100000);
    OK(rheo__mesh_scan(&mesh, &frame, add_run, &count, &error));
    assert_true(count > 1000000);
    NEAR((double)count, mesh.volume * 27000, 5e-3 * (double)count);
    OK(rheo__mesh_scan(&mesh, &frame, stop, &calls, &error));
    assert_int_equal(calls, 1);
    const rheo__mesh_frame huge = {{0, 0, 0}, 1e10, {0, 0, 0}};
    REFUSED(RHEO_ERROR_ARGUMENT, "1e9", rheo__mesh_scan(&mesh, &huge, add_run, &count, &error));
    rheo__mesh_release(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(holes_are_named),
        cmocka_unit_test(many_holes_are_counted),
        cmocka_unit_test(other_faults_of_edges_are_named),
        cmocka_unit_test(a_mesh_inside_out_is_turned_and_degenerate_triangles_do_no_harm),
        cmocka_unit_test(a_cube_on_the_lattice_is_half_open),
        cmocka_unit_test(an_octahedron_on_the_lattice_follows_the_rule),
        cmocka_unit_test(meshes_that_share_faces_share_no_point),
        cmocka_unit_test(turned_and_mirrored_copies_have_the_same_points),
        cmocka_unit_test(a_torus_has_a_hole_through_it),
        cmocka_unit_test(pieces_and_cavities_count),
        cmocka_unit_test(large_meshes_are_fast),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
