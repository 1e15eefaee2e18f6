/* Meshes and letters: what is read, what is refused and how it is named, and which points are inside. */
#include <math.h>

#include "support.h"

#include "scenes/fill.h"
#include "scenes/letters.h"
#include "scenes/mesh.h"

static const rheo_allocator defaults = {NULL, NULL, NULL};

/* ---- Meshes to test with ---- */

static rheo__mesh read_good(const char *text, const char *name)
{
    rheo__mesh mesh;
    OK(rheo__mesh_read(&mesh, &defaults, text, strlen(text), name, &error));
    return mesh;
}

#define CUBE_VERTICES "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\n"

static const char cube_text[] = CUBE_VERTICES "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";

static void add_vertex(rheo__mesh *mesh, double x, double y, double z)
{
    const double position[3] = {x, y, z};
    assert_true(rheo__mesh_add_vertex(mesh, position));
}

static void add_triangle(rheo__mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    assert_true(rheo__mesh_add_triangle(mesh, a, b, c));
}

/* A cube of this side with one corner at the origin, as the next piece of a mesh; -1: seen from inside. */
static void add_cube(rheo__mesh *mesh, double x, double side, int orientation)
{
    static const uint32_t corner[12][3] = {{0, 3, 2}, {0, 2, 1}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                           {2, 3, 7}, {2, 7, 6}, {1, 2, 6}, {1, 6, 5}, {3, 0, 4}, {3, 4, 7}};
    uint32_t first = (uint32_t)mesh->vertices;
    for (int i = 0; i < 8; i++)
        add_vertex(mesh, x + (i % 4 == 1 || i % 4 == 2 ? side : 0), x + (i % 4 > 1 ? side : 0),
                   x + (i > 3 ? side : 0));
    for (int t = 0; t < 12; t++)
        if (orientation > 0)
            add_triangle(mesh, first + corner[t][0], first + corner[t][1], first + corner[t][2]);
        else
            add_triangle(mesh, first + corner[t][1], first + corner[t][0], first + corner[t][2]);
}

static rheo__mesh octahedron(double radius)
{
    rheo__mesh mesh;
    rheo__mesh_init(&mesh, &defaults, 0);
    for (int axis = 0; axis < 3; axis++)
        for (int side = -1; side <= 1; side += 2)
            add_vertex(&mesh, axis == 0 ? side * radius : 0, axis == 1 ? side * radius : 0,
                       axis == 2 ? side * radius : 0);
    for (uint32_t i = 0; i < 8; i++) {
        uint32_t x = i & 1, y = 2 + (i >> 1 & 1), z = 4 + (i >> 2 & 1);
        bool turned = ((i & 1) + (i >> 1 & 1) + (i >> 2 & 1)) % 2 == 0;
        add_triangle(&mesh, x, turned ? z : y, turned ? y : z);
    }
    OK(rheo__mesh_check(&mesh, "octahedron", &error));
    return mesh;
}

/* A grid of n x m quads that closes in both directions: a torus around y. */
static rheo__mesh torus(double large, double small, uint32_t n, uint32_t m)
{
    rheo__mesh mesh;
    rheo__mesh_init(&mesh, &defaults, 0);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < m; k++) {
            double u = 2 * 3.14159265358979 * i / n, v = 2 * 3.14159265358979 * k / m;
            double c = large + small * __builtin_cos(v);
            add_vertex(&mesh, c * __builtin_cos(u), small * __builtin_sin(v), c * __builtin_sin(u));
        }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < m; k++) {
            uint32_t a = i * m + k, b = (i + 1) % n * m + k, c = (i + 1) % n * m + (k + 1) % m,
                     d = i * m + (k + 1) % m;
            add_triangle(&mesh, a, c, b);
            add_triangle(&mesh, a, d, c);
        }
    OK(rheo__mesh_check(&mesh, "torus", &error));
    return mesh;
}

/* ---- Points inside ---- */

enum { SIDE = 64, HALF = SIDE / 2 };

/* Which points of -HALF..HALF-1 along each axis a scan reported; each at most once, in order. */
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

/* ---- Tests: reading ---- */

static void assert_same_mesh(const rheo__mesh *a, const rheo__mesh *b)
{
    assert_int_equal(a->vertices, b->vertices);
    assert_int_equal(a->triangles, b->triangles);
    assert_memory_equal(a->vertex, b->vertex, a->vertices * 3 * sizeof(double));
    assert_memory_equal(a->triangle, b->triangle, a->triangles * 3 * sizeof(uint32_t));
}

static void the_bunny_is_built_in(void **unused)
{
    (void)unused;
    rheo__mesh mesh;
    OK(rheo__mesh_open(&mesh, &defaults, "bunny", &error));
    assert_int_equal(mesh.vertices, 1839);
    assert_int_equal(mesh.triangles, 3674);
    double height = mesh.high[1] - mesh.low[1];
    NEAR(height, 9.658, 1e-3);
    NEAR(mesh.volume / (height * height * height), 0.2157, 1e-4);
    uint64_t hash = UINT64_C(0xcbf29ce484222325); /* FNV-1a of every number: results depend on each */
    for (size_t i = 0; i < 3 * mesh.vertices; i++)
        hash = (hash ^ (uint64_t)(int64_t)floor(1e6 * mesh.vertex[i] + 0.5)) * UINT64_C(0x100000001b3);
    for (size_t i = 0; i < 3 * mesh.triangles; i++)
        hash = (hash ^ mesh.triangle[i]) * UINT64_C(0x100000001b3);
    assert_true(hash == UINT64_C(0x5e6fb99da365139));
    rheo__mesh_release(&mesh);
    static const double spacing[2] = {0.045, 0.028}, expected[2] = {2381, 9836};
    for (int i = 0; i < 2; i++) {
        rheo_scene scene = rheo_default_model_scene(RHEO_MODEL_MELTING);
        uint64_t count;
        scene.world.fluid.spacing = spacing[i];
        scene.fill_count = 1;
        scene.fill[0] = (rheo_fill){.kind = RHEO_FILL_MESH, .name = "bunny", .height = 1};
        OK(rheo_scene_particle_count(&scene, &count, &error));
        NEAR((double)count, expected[i], 0.01 * expected[i]);
    }
}

static void obj_is_read_in_all_its_forms(void **unused)
{
    (void)unused;
    rheo__mesh cube = read_good(cube_text, "a.obj");
    assert_int_equal(cube.vertices, 8);
    assert_int_equal(cube.triangles, 12);
    assert_true(cube.volume == 8 && cube.low[0] == 0 && cube.high[2] == 2);
    static const char *const forms[] = {
        "# a cube\r\nmtllib x.mtl\r\no cube\r\nv 0 0 0 1\r\nv 2 0.0 0 # here\r\nv +2 2e0 -0.0\r\nv 0 2 0 .5 .5 .5\r\n"
        "v 0 0 2\r\nv 2 0 2\r\nv 2 2 2\r\n\tv  0 2   2 \r\nvn 0 0 1\r\nvt 0 0\r\ng a\r\ns off\r\nusemtl m\r\n"
        "f 4/1 3/1 2/1 1/1\r\nf 5//1 6//1 7//1 8//1\r\nf 1/1/1 2/1/1 6/1/1 5/1/1\r\nf 3 4 8 7\r\nl 1 2\r\n"
        "f -7/-1 -6/-1 -2/-1 -3/-1\r\nf 4 1 5 8\r\n",
        "v 0 0 0\nv 2 \\\n0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\nf 4 \\\r\n3 2 \\\n1\n"
        "f 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\n# f 1 2 3 \\\n f 1 2 3\n\nf 2 3 7 6\nf 4 1 5 8",
    };
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        rheo__mesh mesh = read_good(forms[i], "b.OBJ");
        for (size_t k = 0; k < 24; k++)
            assert_true(mesh.vertex[k] == cube.vertex[k]);
        assert_int_equal(mesh.triangles, 12);
        assert_memory_equal(mesh.triangle, cube.triangle, 36 * sizeof(uint32_t));
        rheo__mesh_release(&mesh);
    }
    rheo__mesh_release(&cube);
}

/* Bytes of a PLY file that is made number by number. */
typedef struct ply_bytes {
    char at[4096];
    size_t size;
    bool big;
} ply_bytes;

static void put(ply_bytes *b, uint64_t bits, size_t size)
{
    for (size_t i = 0; i < size; i++)
        b->at[b->size++] = (char)(bits >> 8 * (b->big ? size - 1 - i : i));
}

static ply_bytes ply_cube(bool big)
{
    static const uint32_t quad[6][4] = {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                        {2, 3, 7, 6}, {1, 2, 6, 5}, {3, 0, 4, 7}};
    ply_bytes b = {.big = big};
    b.size = (size_t)sprintf(b.at,
                             "ply\r\nformat binary_%s_endian 1.0\r\ncomment a cube\r\nobj_info none\r\n"
                             "element camera 2\r\nproperty list ushort double view\r\nproperty short z\r\n"
                             "element vertex 8\r\nproperty uchar red\r\nproperty float64 z\r\nproperty float x\r\n"
                             "property int y\r\nelement face 6\r\nproperty list uint8 float weights\r\n"
                             "property list uchar uint vertex_indices\r\nproperty int8 flag\r\nelement none 3\r\n"
                             "end_header\r\n",
                             big ? "big" : "little");
    put(&b, 1, 2), put(&b, 7, 8), put(&b, 5, 2);
    put(&b, 0, 2), put(&b, 5, 2);
    for (int i = 0; i < 8; i++) {
        double z = i > 3 ? 2 : 0;
        float x = i % 4 == 1 || i % 4 == 2 ? 2 : 0;
        uint64_t z_bits;
        uint32_t x_bits;
        memcpy(&z_bits, &z, sizeof z);
        memcpy(&x_bits, &x, sizeof x);
        put(&b, 255, 1), put(&b, z_bits, 8), put(&b, x_bits, 4), put(&b, i % 4 > 1 ? 2 : 0, 4);
    }
    for (int f = 0; f < 6; f++) {
        put(&b, 1, 1), put(&b, 0, 4), put(&b, 4, 1);
        for (int k = 0; k < 4; k++)
            put(&b, quad[f][k], 4);
        put(&b, 200, 1);
    }
    return b;
}

static const char ply_text[] =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nelement face 4\nproperty list uchar int vertex_index\nelement edge 1\nproperty int a\n"
    "end_header\n0 0 0 1\n1 0 0 2\n0 1 0 3 0 0\n1 4\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n9\n";

static void ply_is_read_in_all_its_forms(void **unused)
{
    (void)unused;
    rheo__mesh cube = read_good(cube_text, "a.obj"), pyramid = read_good(ply_text, "a.ply");
    for (int big = 0; big < 2; big++) {
        ply_bytes b = ply_cube(big);
        rheo__mesh mesh;
        OK(rheo__mesh_read(&mesh, &defaults, b.at, b.size, "c.ply", &error));
        assert_same_mesh(&mesh, &cube);
        rheo__mesh_release(&mesh);
    }
    /* Signed integers of every width, both ways round. */
    for (int big = 0; big < 2; big++) {
        ply_bytes b = {.big = big};
        rheo__mesh mesh;
        b.size = (size_t)sprintf(b.at,
                                 "ply\nformat binary_%s_endian 1.0\nelement vertex 4\nproperty char x\n"
                                 "property int16 y\nproperty int z\nelement face 4\n"
                                 "property list char short vertex_index\nend_header\n",
                                 big ? "big" : "little");
        static const int at[4][3] = {{-3, -300, -70000}, {1, -300, -70000}, {-3, 2, -70000}, {-3, -300, 5}};
        static const uint32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
        for (int i = 0; i < 4; i++)
            put(&b, (uint64_t)at[i][0], 1), put(&b, (uint64_t)at[i][1], 2), put(&b, (uint64_t)at[i][2], 4);
        for (int i = 0; i < 4; i++)
            put(&b, 3, 1), put(&b, faces[i][0], 2), put(&b, faces[i][1], 2), put(&b, faces[i][2], 2);
        OK(rheo__mesh_read(&mesh, &defaults, b.at, b.size, "d.ply", &error));
        for (size_t i = 0; i < 12; i++)
            assert_true(mesh.vertex[i] == at[i / 3][i % 3]);
        rheo__mesh_release(&mesh);
    }
    assert_int_equal(pyramid.triangles, 4);
    NEAR(pyramid.volume, 1 / 6., 1e-15);
    /* Signed indices and faces before vertices. */
    static const char text[] =
        "ply\nformat ascii 1.0\nelement face 4\nproperty list int short vertex_indices\n"
        "element vertex 4\nproperty double x\nproperty double y\nproperty double z\nend_header\n"
        "3 0 2 1 3 0 1 3 3 1 2 3 3 2 0 3 0 0 0 1 0 0 0 1 0 0 0 1";
    rheo__mesh other = read_good(text, "b.ply");
    assert_same_mesh(&other, &pyramid);
    rheo__mesh_release(&other);
    rheo__mesh_release(&pyramid);
    rheo__mesh_release(&cube);
}

#define PLY(body) "ply\nformat ascii 1.0\n" body
#define PLY_3 "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
#define PLY_FACE "element face 1\nproperty list uchar int vertex_indices\nend_header\n"

static void damaged_files_are_refused_with_their_line(void **unused)
{
    (void)unused;
    static const struct {
        const char *name, *text, *parts[2];
    } cases[] = {
        {"a.obj", "", {"a.obj: ", "no triangle"}},
        {"a.obj", "v 1 2 3\n", {"no triangle"}},
        {"a.obj", "\nv 1 2\n", {"a.obj:2: ", "v x y z"}},
        {"a.obj", "v 1 2 x3", {"a.obj:1: \"x3\""}},
        {"a.obj", "v 1 nan 3", {"\"nan\" is no finite"}},
        {"a.obj", "v inf 1 3", {"\"inf\""}},
        {"a.obj", "v 1 2 1e999", {"\"1e999\""}},
        {"a.obj", "v 1 2 1e31", {"\"1e31\""}},
        {"a.obj", "v 1 2 3,5", {"\"3,5\""}},
        {"a.obj", "v 1 2 0000000000000000000000000000000000000000000000000000000000000000000000001", {"a.obj:1: "}},
        {"a.obj", CUBE_VERTICES "f 1 2", {"a.obj:9: ", "2 corners"}},
        {"a.obj", CUBE_VERTICES "f 1 2 9", {"a.obj:9: ", "the vertex 9; so far there are 8"}},
        {"a.obj", CUBE_VERTICES "f 1 2 0", {"vertex 0;"}},
        {"a.obj", CUBE_VERTICES "f 1 2 -9", {"vertex -9;"}},
        {"a.obj", CUBE_VERTICES "f 1 2 99999999999999999999", {"a.obj:9: ", "no corner"}},
        {"a.obj", CUBE_VERTICES "\\\n\nf 1 2 3x", {"a.obj:11: \"3x\" is no corner"}},
        {"a.obj", CUBE_VERTICES "f 1/ 2 3", {"\"1/\""}},
        {"a.obj", CUBE_VERTICES "f 1/2/ 2 3", {"\"1/2/\""}},
        {"a.obj", CUBE_VERTICES "f 1/2/3/4 2 3", {"\"1/2/3/4\""}},
        {"a.obj", CUBE_VERTICES "f /2 2 3", {"\"/2\""}},
        {"a.obj", CUBE_VERTICES "f 1.5 2 3", {"\"1.5\""}},
        {"a.obj", CUBE_VERTICES "f \033[2J 2 3", {"\"?[2J\""}},
        {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3 2 1\n", {"a.obj: ", "flat along z"}},
        {"a.ply", "", {"a.ply:1: ", "no PLY file"}},
        {"a.ply", "ply\nformat ascii 1.0\n", {"a.ply:3: ", "end_header"}},
        {"a.ply", "ply\nend_header\n", {"a.ply:2: ", "no format"}},
        {"a.ply", "ply\nformat ascii 2.0\n", {"a.ply:2: ", "1.0"}},
        {"a.ply", "ply\nformat text 1.0\n", {"binary_little_endian"}},
        {"a.ply", PLY("property int x\n"), {"a.ply:3: ", "before the first element"}},
        {"a.ply", PLY("element vertex -1\n"), {"element name count"}},
        {"a.ply", PLY("element vertex 1.5\n"), {"element name count"}},
        {"a.ply", PLY("element vertex 1e10\n"), {"element name count"}},
        {"a.ply", PLY("element vertex 3\nelement vertex 3\n"), {"given twice"}},
        {"a.ply", PLY("element vertex 3\nproperty real x\n"), {"a.ply:4: \"real\" is no type"}},
        {"a.ply", PLY("element vertex 3\nproperty float x\nproperty int x\n"), {"given twice"}},
        {"a.ply", PLY("element vertex 3\nproperty list int int x\n"), {"must not be lists"}},
        {"a.ply", PLY("elements\n"), {"\"elements\" is no line"}},
        {"a.ply", PLY("element vertex 3\nproperty float x\nend_header\n"), {"with x, y and z"}},
        {"a.ply", PLY(PLY_3 "end_header\n"), {"vertex_indices"}},
        {"a.ply", PLY(PLY_3 PLY_FACE "0 0 0\n1 0 nan\n"), {"a.ply:11: \"nan\" is no number"}},
        {"a.ply", PLY(PLY_3 PLY_FACE "0 0 0\n1 0 1e39\n"), {"a.ply:11: ", "not finite"}},
        {"a.ply", PLY(PLY_3 PLY_FACE "0 0 0\n1 0 0\n0 1 0\n"), {"a.ply:13: ", "ends before"}},
        {"a.ply", PLY(PLY_3 PLY_FACE "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), {"a.ply:13: ", "vertex 3; there are 3"}},
        {"a.ply", PLY(PLY_3 PLY_FACE "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), {"vertex -1;"}},
        {"a.ply", PLY(PLY_3 PLY_FACE "0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n"), {"vertex 1.5;"}},
        {"a.ply", PLY(PLY_3 PLY_FACE "0 0 0\n1 0 0\n0 1 0\n2 0 1\n"), {"less than three corners"}},
        {"a.ply", PLY(PLY_3 PLY_FACE "0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n"), {"longer than what is left"}},
        {"a.ply", PLY(PLY_3 PLY_FACE "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n"), {"longer than what is left"}},
        {"a.ply",
         "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
         "property float z\n" PLY_FACE "0123456789ab01",
         {"a.ply: byte 190: ", "ends before"}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        rheo__mesh mesh;
        rheo_error error = {""};
        size_t size = strlen(cases[i].text);
        char *exact = malloc(size ? size : 1);
        assert_non_null(exact);
        memcpy(exact, cases[i].text, size);
        rheo_result result = rheo__mesh_read(&mesh, &defaults, exact, size, cases[i].name, &error);
        free(exact);
        if (result != RHEO_ERROR_FORMAT)
            fail_msg("%d instead of a format error: %s", (int)result, cases[i].text);
        for (size_t k = 0; k < 2 && cases[i].parts[k]; k++)
            if (!strstr(error.message, cases[i].parts[k]))
                fail_msg("\"%s\" is missing in \"%s\" for %s", cases[i].parts[k], error.message, cases[i].text);
    }
    rheo__mesh mesh;
    REFUSED(RHEO_ERROR_FORMAT, "64 MiB", rheo__mesh_read(&mesh, &defaults, "", (64u << 20) + 1, "a.obj", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, ".obj or .ply", rheo__mesh_open(&mesh, &defaults, "rabbit", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, ".obj or .ply", rheo__mesh_open(&mesh, &defaults, ".obj", &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "none.obj", rheo__mesh_open(&mesh, &defaults, "no/such/none.obj", &error));
}

static void read_every_cut(const char *bytes, size_t size, size_t good_from, const char *name)
{
    for (size_t cut = 0; cut < size; cut++) {
        rheo__mesh mesh;
        rheo_error error = {""};
        char *exact = malloc(cut ? cut : 1);
        assert_non_null(exact);
        memcpy(exact, bytes, cut);
        rheo_result result = rheo__mesh_read(&mesh, &defaults, exact, cut, name, &error);
        free(exact);
        if ((result == RHEO_OK) != (cut >= good_from))
            fail_msg("%s cut to %zu bytes: %d %s", name, cut, (int)result, error.message);
        if (result == RHEO_OK)
            rheo__mesh_release(&mesh);
        else
            assert_true(result == RHEO_ERROR_FORMAT && strncmp(error.message, name, strlen(name)) == 0);
    }
}

static void every_truncation_is_safe(void **unused)
{
    (void)unused;
    read_every_cut(cube_text, strlen(cube_text), strlen(cube_text) - 1, "a.obj"); /* without its last line's end */
    read_every_cut(ply_text, strlen(ply_text), strlen(ply_text) - 1, "a.ply");
    for (int big = 0; big < 2; big++) {
        ply_bytes b = ply_cube(big);
        read_every_cut(b.at, b.size, b.size, "b.ply");
    }
}

static void every_changed_byte_is_safe(void **unused)
{
    (void)unused;
    uint32_t random = 1;
    for (int round = 0; round < 20000; round++) {
        ply_bytes b = ply_cube(round & 1);
        if (round % 4 > 1) {
            const char *text = round % 8 > 3 ? cube_text : ply_text;
            b.size = strlen(text);
            memcpy(b.at, text, b.size);
        }
        for (int i = 0; i < 1 + round % 3; i++) {
            random = random * 1664525u + 1013904223u;
            size_t at = (random >> 8) % b.size;
            random = random * 1664525u + 1013904223u;
            b.at[at] = (char)(random >> 24);
        }
        rheo__mesh mesh;
        rheo_error error;
        if (rheo__mesh_read(&mesh, &defaults, b.at, b.size, round % 8 > 5 ? "a.obj" : "a.ply", &error) == RHEO_OK)
            rheo__mesh_release(&mesh);
    }
}

/* ---- Tests: closed or not ---- */

static void holes_are_named(void **unused)
{
    (void)unused;
    static const struct {
        const char *faces, *parts[4];
    } cases[] = {
        /* without its top, y = 2 */
        {"f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 4 1 5 8\n",
         {"4 open edges around 1 hole,", "with 4 edges around (1, 2, 1)", "counted from 1", "a.obj: "}},
        /* without a triangle of the bottom and the whole top */
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
    /* The named edge is one of the hole, as the missing triangle would have it. */
    rheo__mesh mesh;
    rheo__mesh_init(&mesh, &defaults, 0);
    add_cube(&mesh, 0, 1, 1);
    mesh.triangles--; /* 3, 4, 7 */
    rheo_error named = {""};
    assert_int_equal(rheo__mesh_check(&mesh, "cube", &named), RHEO_ERROR_FORMAT);
    assert_true(strstr(named.message, "from vertex 3 to 4,") || strstr(named.message, "from vertex 4 to 7,") ||
                strstr(named.message, "from vertex 7 to 3,"));
    rheo__mesh_release(&mesh);
    /* Every triangle that is missing from the bunny is noticed, with its three edges. */
    for (size_t missing = 0; missing < 3674; missing += 97) {
        OK(rheo__mesh_open(&mesh, &defaults, "bunny", &error));
        memmove(mesh.triangle + 3 * missing, mesh.triangle + 3 * missing + 3,
                (mesh.triangles - missing - 1) * 3 * sizeof *mesh.triangle);
        mesh.triangles--;
        REFUSED(RHEO_ERROR_FORMAT, "3 open edges around 1 hole", rheo__mesh_check(&mesh, "b", &error));
        rheo__mesh_release(&mesh);
    }
}

/* Holes that meet in a vertex are walked one by one, and scattered triangles are a hole each. */
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
    /* One whose corners lie on a line, between two others: edge-on to every row. */
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

/* Rows through faces, edges and vertices: half of them are inside. */
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

/* All six vertices and twelve edges are on rows; the rule of ties is the one that mesh.h states. */
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

/* Six tetrahedra make a cube; every point of it, on faces, edges and its diagonal, is in one of them. */
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

/* Turned by any angle and mirrored, points well inside and outside stay what they are. */
static void turned_and_mirrored_copies_hold_the_same(void **unused)
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
    add_cube(&mesh, 20, 5, 1);  /* apart */
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

/* A hundred thousand triangles and a million points: triangles are not tried against every row. */
static void large_meshes_are_no_burden(void **unused)
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

/* ---- Tests: letters ---- */

/* The particles of a scene with one shape. */
typedef struct filled {
    uint64_t count;
    rheo_real *position, *velocity, *density, *temperature;
    double spacing;
} filled;

static filled fill_scene(const rheo_scene *scene)
{
    static rheo__filling filling;
    OK(rheo__filling_open(&filling, scene, &error));
    filled f = {.count = filling.count, .spacing = filling.spacing};
    f.position = calloc(f.count + 1, 3 * sizeof *f.position);
    f.velocity = calloc(f.count + 1, 3 * sizeof *f.velocity);
    f.density = calloc(f.count + 1, sizeof *f.density);
    f.temperature = calloc(f.count + 1, sizeof *f.temperature);
    assert_true(f.position && f.velocity && f.density && f.temperature);
    OK(rheo__filling_make(&filling, f.position, f.velocity, f.density, f.temperature, &error));
    uint64_t counted;
    OK(rheo_scene_particle_count(scene, &counted, &error));
    assert_int_equal(counted, f.count);
    rheo__filling_close(&filling);
    return f;
}

static void release(filled *f)
{
    free(f->position);
    free(f->velocity);
    free(f->density);
    free(f->temperature);
}

static rheo_scene scene_of(rheo_fill fill)
{
    rheo_scene scene = rheo_default_model_scene(RHEO_MODEL_MELTING);
    scene.fill_count = 1;
    scene.fill[0] = fill;
    scene.world.fluid.spacing = 1;
    return scene;
}

static void letters_are_their_dots(void **unused)
{
    (void)unused;
    rheo_scene scene = scene_of(
        (rheo_fill){.kind = RHEO_FILL_LETTERS, .name = "LT", .height = 7, .depth = 2, .position = {1, 2, 3}});
    filled f = fill_scene(&scene);
    assert_int_equal(f.count, 2 * (7 + 4 + 5 + 6));
    /* Eleven dots wide: from -4.5 to 6.5; two deep: from 2 to 4; the foot of the L is in the lowest row. */
    uint64_t i = 0;
    for (int z = 0; z < 2; z++)
        for (int y = 0; y < 7; y++)
            for (int x = 0; x < 11; x++) {
                bool foot = y == 0, top = y == 6;
                bool set = x < 5 ? x == 0 || foot : x > 5 && (x == 8 || top);
                if (!set)
                    continue;
                const double expected[3] = {-4 + x, 2.5 + y, 2.5 + z};
                for (int axis = 0; axis < 3; axis++)
                    NEAR((double)f.position[3 * i + axis], expected[axis], 1e-6);
                i++;
            }
    assert_int_equal(i, f.count);
    release(&f);
    /* Three particles a dot along each axis. */
    scene.world.fluid.spacing = 1. / 3;
    uint64_t count;
    OK(rheo_scene_particle_count(&scene, &count, &error));
    assert_int_equal(count, 2 * 27 * (7 + 4 + 5 + 6));
    /* All there are, and each of them is another. */
    static const char all[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.,!?-+=:/";
    uint8_t dots[sizeof all][RHEO__LETTER_ROWS][RHEO__LETTER_ADVANCE];
    for (size_t a = 0; a + 1 < sizeof all; a++) {
        const char text[2] = {all[a], 0};
        int set = 0;
        OK(rheo__letters_check(text, &error));
        for (size_t row = 0; row < RHEO__LETTER_ROWS; row++) {
            rheo__letters_row(text, row, dots[a][row]);
            for (int k = 0; k < RHEO__LETTER_ADVANCE; k++)
                set += dots[a][row][k];
            assert_int_equal(dots[a][row][RHEO__LETTER_COLUMNS], 0);
        }
        assert_true(set >= 4 && set < 25);
        for (size_t b = 0; b < a; b++)
            assert_true(memcmp(dots[a], dots[b], sizeof dots[a]) != 0);
        /* Two dots that touch at a corner alone would fall apart: a third joins them. */
        for (size_t row = 1; row < RHEO__LETTER_ROWS; row++)
            for (size_t k = 1; k < RHEO__LETTER_COLUMNS; k++) {
                uint8_t(*d)[RHEO__LETTER_ADVANCE] = dots[a];
                assert_true(!d[row][k] || !d[row - 1][k - 1] || d[row][k - 1] || d[row - 1][k]);
                assert_true(!d[row][k - 1] || !d[row - 1][k] || d[row][k] || d[row - 1][k - 1]);
            }
    }
    strcpy(scene.fill[0].name, "A B");
    OK(rheo_scene_check(&scene, &error));
    static const char *const bad[][2] = {{"Ab#a#", "for: b#a; there are"},
                                         {"A\xc3\xbc", "for: \xc3\xbc; there are"},
                                         {"\033", "for: ?;"},
                                         {"", "the text is empty"}};
    for (size_t i2 = 0; i2 < sizeof bad / sizeof *bad; i2++) {
        strcpy(scene.fill[0].name, bad[i2][0]);
        REFUSED(RHEO_ERROR_ARGUMENT, bad[i2][1], rheo_scene_check(&scene, &error));
    }
    memset(scene.fill[0].name, 'W', sizeof scene.fill[0].name - 1);
    scene.fill[0].name[sizeof scene.fill[0].name - 1] = 0;
    OK(rheo_scene_check(&scene, &error));
    memset(scene.fill[0].name, 'W', sizeof scene.fill[0].name);
    REFUSED(RHEO_ERROR_ARGUMENT, "shape 0", rheo_scene_check(&scene, &error));
}

/* ---- Tests: fills ---- */

static void write_text(const char *name, const char *text)
{
    FILE *file = fopen(name, "wb");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

/* A box from a file fills as a block of its size does. */
static void a_mesh_from_a_file_is_placed_and_scaled(void **unused)
{
    (void)unused;
    char name[64];
    snprintf(name, sizeof name, "test_mesh_%d.obj", RHEO_DOUBLE);
    write_text(name, cube_text);
    for (int height = 0; height <= 6; height += 3) {
        double side = height ? height : 2;
        rheo_scene mesh = scene_of((rheo_fill){.kind = RHEO_FILL_MESH,
                                               .height = height,
                                               .position = {10, -5, 3},
                                               .velocity = {1, 2, 3},
                                               .jitter = 0.25});
        rheo_scene block = scene_of((rheo_fill){.kind = RHEO_FILL_BLOCK,
                                                .min = {10 - side / 2, -5, 3 - side / 2},
                                                .max = {10 + side / 2, -5 + side, 3 + side / 2},
                                                .velocity = {1, 2, 3},
                                                .jitter = 0.25});
        snprintf(mesh.fill[0].name, sizeof mesh.fill[0].name, "%s", name);
        mesh.fill_count = block.fill_count = 2; /* of the same file */
        mesh.fill[1] = mesh.fill[0];
        block.fill[1] = block.fill[0];
        filled a = fill_scene(&mesh), b = fill_scene(&block);
        assert_int_equal(a.count, 2 * (int)(side * side * side));
        assert_int_equal(b.count, a.count);
        for (size_t i = 0; i < 3 * a.count; i++)
            NEAR((double)a.position[i], (double)b.position[i], 1e-5);
        assert_memory_equal(a.velocity, b.velocity, 3 * a.count * sizeof *a.velocity);
        release(&a);
        release(&b);
    }
    /* What is wrong with a file reaches those who check or count. */
    rheo_scene scene = scene_of((rheo_fill){.kind = RHEO_FILL_MESH});
    uint64_t count;
    double spacing;
    rheo_world *world;
    snprintf(scene.fill[0].name, sizeof scene.fill[0].name, "%s", name);
    write_text(name, CUBE_VERTICES "f 1 2 3\n");
    REFUSED(RHEO_ERROR_FORMAT, "shape 0: test_mesh_", rheo_scene_check(&scene, &error));
    REFUSED(RHEO_ERROR_FORMAT, "3 open edges", rheo_scene_particle_count(&scene, &count, &error));
    REFUSED(RHEO_ERROR_FORMAT, "3 open edges", rheo_scene_spacing(&scene, &spacing, &error));
    REFUSED(RHEO_ERROR_FORMAT, "3 open edges", rheo_scene_create_world(&scene, &world, &error));
    remove(name);
    REFUSED(RHEO_ERROR_ARGUMENT, name, rheo_scene_check(&scene, &error));
    scene.fill[0].name[0] = 0;
    REFUSED(RHEO_ERROR_ARGUMENT, "no mesh is named", rheo_scene_check(&scene, &error));
    scene.fill[0] = (rheo_fill){.kind = RHEO_FILL_MESH, .name = "bunny", .height = 1e6};
    REFUSED(RHEO_ERROR_ARGUMENT, "a mesh has at most 65536 along an axis", rheo_scene_check(&scene, &error));
    scene.fill[0].height = 2000;
    REFUSED(RHEO_ERROR_ARGUMENT, "2^30", rheo_scene_check(&scene, &error));
    scene.fill[0].height = -1;
    REFUSED(RHEO_ERROR_ARGUMENT, "height", rheo_scene_check(&scene, &error));
    scene.fill[0].height = 1;
    scene.fill[0].position[1] = __builtin_nan("");
    REFUSED(RHEO_ERROR_ARGUMENT, "position", rheo_scene_check(&scene, &error));
    scene.fill[0].kind = (rheo_fill_kind)9;
    REFUSED(RHEO_ERROR_ARGUMENT, "kind 9", rheo_scene_check(&scene, &error));
}

static void the_bunny_stands_where_it_is_put(void **unused)
{
    (void)unused;
    rheo_scene scene =
        scene_of((rheo_fill){.kind = RHEO_FILL_MESH, .name = "bunny", .height = 1, .position = {4, 2, -3}});
    scene.world.fluid.spacing = 0.02;
    filled f = fill_scene(&scene);
    double low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9};
    for (size_t i = 0; i < 3 * f.count; i++) {
        double x = (double)f.position[i];
        low[i % 3] = x < low[i % 3] ? x : low[i % 3];
        high[i % 3] = x > high[i % 3] ? x : high[i % 3];
    }
    NEAR(low[1], 2.01, 1e-5);
    NEAR(high[1], 3, 0.03);
    NEAR((low[0] + high[0]) / 2, 4, 0.02);
    NEAR((low[2] + high[2]) / 2, -3, 0.02);
    release(&f);
}

static void shapes_have_temperatures_and_densities(void **unused)
{
    (void)unused;
    rheo_scene scene = scene_of((rheo_fill){.kind = RHEO_FILL_BLOCK, .max = {2, 5, 3}, .jitter = 0.2});
    scene.world.melting.temperature = 0.25;
    scene.world.melting.rest_density = 2;
    scene.world.gravity[0] = 0.5;
    scene.world.gravity[1] = -3;
    scene.fill_count = 3;
    scene.fill[1] = scene.fill[2] = scene.fill[0];
    scene.fill[1].has_temperature = true;
    scene.fill[1].temperature[0] = 0.1;
    scene.fill[1].temperature[1] = 0.9;
    scene.fill[1].max[0] = 4;
    scene.fill[2].not_hydrostatic = true;
    scene.fill[2].has_temperature = true;
    scene.fill[2].temperature[0] = scene.fill[2].temperature[1] = 0.3;
    filled f = fill_scene(&scene);
    assert_int_equal(f.count, 30 + 60 + 30);
    double low = 1e9, high = -1e9, top[2] = {1e9, 1e9}, least[2] = {1e9, 1e9};
    for (size_t i = 0; i < 90; i++) {
        const rheo_real *x = f.position + 3 * i;
        double along = 0.5 * (double)x[0] - 3 * (double)x[1], y = (double)x[1];
        size_t shape = i >= 30;
        top[shape] = along < top[shape] ? along : top[shape];
        least[shape] = (double)f.density[i] < least[shape] ? (double)f.density[i] : least[shape];
        low = shape && y < low ? y : low;
        high = shape && y > high ? y : high;
    }
    assert_true(least[0] == 2 && least[1] == 2);
    double coldest = 1, hottest = 0;
    for (size_t i = 0; i < 120; i++) {
        const rheo_real *x = f.position + 3 * i;
        double along = 0.5 * (double)x[0] - 3 * (double)x[1], t = (double)f.temperature[i];
        double temperature = i < 30 ? 0.25 : i >= 90 ? 0.3 : 0.1 + 0.8 * ((double)x[1] - low) / (high - low);
        NEAR((double)f.density[i], i >= 90 ? 2 : 2 + 2 * (along - top[i >= 30]) / 100, 1e-6);
        NEAR(t, temperature, 1e-6);
        assert_true(i < 90 || f.temperature[i] == (rheo_real)0.3);
        coldest = t < coldest ? t : coldest;
        hottest = t > hottest ? t : hottest;
    }
    assert_true(coldest == (double)(rheo_real)0.1 && hottest == (double)(rheo_real)0.9);
    release(&f);
    scene.fill[1].temperature[1] = __builtin_inf();
    REFUSED(RHEO_ERROR_ARGUMENT, "shape 1: temperature must be a finite number; got inf", rheo_scene_check(&scene, &error));
    /* None has one: the world is isothermal. */
    static rheo__filling filling;
    scene.fill[1].has_temperature = false;
    OK(rheo__filling_open(&filling, &scene, &error));
    assert_true(filling.has_temperatures);
    rheo__filling_close(&filling);
    scene.fill[2].has_temperature = false;
    OK(rheo__filling_open(&filling, &scene, &error));
    assert_false(filling.has_temperatures);
    rheo__filling_close(&filling);
    /* What is of the other model. */
    rheo_scene other = rheo_default_scene();
    other.fill_count = 1;
    other.fill[0] = (rheo_fill){.kind = RHEO_FILL_SPHERE, .radius = 4, .has_temperature = true};
    REFUSED(RHEO_ERROR_ARGUMENT, "shape 0: temperature is for the model melting", rheo_scene_check(&other, &error));
    other.fill[0].has_temperature = false;
    other.fill[0].not_hydrostatic = true;
    REFUSED(RHEO_ERROR_ARGUMENT, "hydrostatic is for the model melting", rheo_scene_check(&other, &error));
    scene.fill[2].not_hydrostatic = false;
    scene.settle.time = 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "settle.time", rheo_scene_check(&scene, &error));
    scene.settle.time = 0;
    scene.clearance = 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "ball.clearance", rheo_scene_check(&scene, &error));
}

static void the_spacing_follows_from_a_number_of_particles(void **unused)
{
    (void)unused;
    rheo_scene scene = scene_of((rheo_fill){.kind = RHEO_FILL_MESH, .name = "bunny", .height = 1});
    double first = 0, second = 0;
    uint64_t count;
    static const uint64_t wanted[] = {10, 100, 2381, 9836, 100000};
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        for (int begin = 0; begin < 2; begin++) {
            scene.world.fluid.spacing = begin ? 1e-3 : 5; /* from too fine, and from too coarse */
            scene.particles = wanted[i];
            OK(rheo_scene_spacing(&scene, begin ? &second : &first, &error));
            OK(rheo_scene_particle_count(&scene, &count, &error));
            NEAR((double)count, (double)wanted[i], 1 + 2e-3 * (double)wanted[i]);
            /* What it was chosen by is what is filled. */
            rheo_scene plain = scene;
            uint64_t filled_by_it;
            plain.particles = 0;
            plain.world.fluid.spacing = begin ? second : first;
            OK(rheo_scene_particle_count(&plain, &filled_by_it, &error));
            assert_int_equal(filled_by_it, count);
            double again;
            OK(rheo_scene_spacing(&scene, &again, &error));
            assert_true(again == (begin ? second : first));
        }
    NEAR(first, second, 1e-2 * first);
    /* An exact number of a block, and the world has that spacing. */
    rheo_scene pool = rheo_default_scene();
    pool.fill_count = 1;
    pool.fill[0] = (rheo_fill){.kind = RHEO_FILL_BLOCK, .max = {10, 10, 10}};
    pool.particles = 125;
    rheo_world *world;
    OK(rheo_scene_create_world(&pool, &world, &error));
    assert_int_equal(rheo_world_particle_count(world), 125);
    assert_true(rheo_world_definition(world)->fluid.spacing > 10 / 5.5);
    assert_true(rheo_world_definition(world)->fluid.spacing < 10 / 4.5);
    rheo_world_destroy(world);
    /* It holds 64 or 125 and nothing between: the nearer one, wherever the bisection ends. */
    for (pool.particles = 64; pool.particles <= 125; pool.particles++) {
        OK(rheo_scene_particle_count(&pool, &count, &error));
        assert_int_equal(count, pool.particles < 95 ? 64 : 125);
    }
    pool.particles = 0;
    OK(rheo_scene_spacing(&pool, &first, &error));
    assert_true(first == 2);
    /* Nothing to fill. */
    pool.particles = 10;
    pool.fill[0].max[1] = 0;
    REFUSED(RHEO_ERROR_ARGUMENT, "empty", rheo_scene_spacing(&pool, &first, &error));
    REFUSED(RHEO_ERROR_ARGUMENT, "empty", rheo_scene_check(&pool, &error));
    pool.fill_count = 0;
    REFUSED(RHEO_ERROR_ARGUMENT, "empty", rheo_scene_check(&pool, &error));
    pool.particles = (UINT64_C(1) << 30) + 1;
    REFUSED(RHEO_ERROR_ARGUMENT, "2^30", rheo_scene_check(&pool, &error));
}

/* ---- Tests: memory ---- */

typedef struct failing {
    int left, held;
} failing;

static void *failing_allocate(size_t bytes, void *user)
{
    failing *f = user;
    if (f->left-- <= 0)
        return NULL;
    f->held++;
    return malloc(bytes);
}

static void failing_release(void *memory, void *user)
{
    failing *f = user;
    f->held--;
    free(memory);
}

static void every_failed_allocation_is_an_error(void **unused)
{
    (void)unused;
    failing f = {0, 0};
    const rheo_allocator allocator = {failing_allocate, failing_release, &f};
    int most = 0;
    rheo_result result = RHEO_ERROR_MEMORY;
    for (; result != RHEO_OK; most++) {
        rheo__mesh mesh;
        rheo_error error = {""};
        f.left = most;
        result = rheo__mesh_read(&mesh, &allocator, cube_text, strlen(cube_text), "a.obj", &error);
        if (result == RHEO_OK)
            rheo__mesh_release(&mesh);
        else
            assert_true(result == RHEO_ERROR_MEMORY && strstr(error.message, "no memory"));
        assert_int_equal(f.held, 0);
    }
    assert_true(most > 3);
    write_text("test_mesh_memory.ply", ply_text);
    rheo_scene scene = scene_of((rheo_fill){.kind = RHEO_FILL_MESH, .name = "test_mesh_memory.ply", .height = 4});
    scene.world.allocator = allocator;
    scene.fill_count = 2;
    scene.fill[1] = (rheo_fill){.kind = RHEO_FILL_MESH, .name = "bunny", .height = 5};
    result = RHEO_ERROR_MEMORY;
    for (most = 0; result != RHEO_OK; most++) {
        uint64_t count;
        rheo_error error = {""};
        f.left = most;
        result = rheo_scene_particle_count(&scene, &count, &error);
        assert_true(result == RHEO_OK || (result == RHEO_ERROR_MEMORY && strstr(error.message, "no memory")));
        assert_true((count > 0) == (result == RHEO_OK));
        assert_int_equal(f.held, 0);
    }
    assert_true(most > 12);
    remove("test_mesh_memory.ply");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_bunny_is_built_in),
        cmocka_unit_test(obj_is_read_in_all_its_forms),
        cmocka_unit_test(ply_is_read_in_all_its_forms),
        cmocka_unit_test(damaged_files_are_refused_with_their_line),
        cmocka_unit_test(every_truncation_is_safe),
        cmocka_unit_test(every_changed_byte_is_safe),
        cmocka_unit_test(holes_are_named),
        cmocka_unit_test(many_holes_are_counted),
        cmocka_unit_test(other_faults_of_edges_are_named),
        cmocka_unit_test(a_mesh_inside_out_is_turned_and_degenerate_triangles_do_no_harm),
        cmocka_unit_test(a_cube_on_the_lattice_is_half_open),
        cmocka_unit_test(an_octahedron_on_the_lattice_follows_the_rule),
        cmocka_unit_test(meshes_that_share_faces_share_no_point),
        cmocka_unit_test(turned_and_mirrored_copies_hold_the_same),
        cmocka_unit_test(a_torus_has_a_hole_through_it),
        cmocka_unit_test(pieces_and_cavities_count),
        cmocka_unit_test(large_meshes_are_no_burden),
        cmocka_unit_test(letters_are_their_dots),
        cmocka_unit_test(a_mesh_from_a_file_is_placed_and_scaled),
        cmocka_unit_test(the_bunny_stands_where_it_is_put),
        cmocka_unit_test(shapes_have_temperatures_and_densities),
        cmocka_unit_test(the_spacing_follows_from_a_number_of_particles),
        cmocka_unit_test(every_failed_allocation_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
