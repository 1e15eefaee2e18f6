/* Mesh files: the accepted forms, and the errors for all others. */
#include "mesh_support.h"

#include <math.h>

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
    uint64_t hash = UINT64_C(0xcbf29ce484222325); /* FNV-1a of every number, so that the result depends on each */
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
        scene.fill = some_fills();
        scene.fill_count = 1;
        fills_of(&scene)[0] = (rheo_fill){.kind = RHEO_FILL_MESH, .name = "bunny", .height = 1};
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

/* Bytes of a PLY file, composed number by number. */
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
    /* Signed integers of every width, in both byte orders. */
    for (int big = 0; big < 2; big++) {
        ply_bytes b = {.big = big};
        rheo__mesh mesh;
        b.size = (size_t)sprintf(b.at,
                                 "ply\nformat binary_%s_endian 1.0\nelement vertex 4\nproperty char x\n"
                                 "property int16 y\nproperty int z\nelement face 4\n"
                                 "property list char short vertex_index\nend_header\n",
                                 big ? "big" : "little");
        static const int at[4][3] = {
            {-128, -32768, INT32_MIN}, {127, -32768, INT32_MIN}, {-128, 32767, INT32_MIN}, {-128, -32768, INT32_MAX}};
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
    /* Signed indices, with faces ahead of vertices. */
    static const char text[] =
        "ply\nformat ascii 1.0\nelement face 4\nproperty list int short vertex_indices\n"
        "element vertex 4\nproperty double x\nproperty double y\nproperty double z\nend_header\n"
        "3 0 2 1 3 0 1 3 3 1 2 3 3 2 0 3 0 0 0 1 0 0 0 1 0 0 0 1";
    rheo__mesh other = read_good(text, "b.ply");
    assert_same_mesh(&other, &pyramid);
    rheo__mesh_release(&other);
    /* An element may have no items. */
    char empty[1024];
    const char *rest = strstr(text, "element face");
    assert_non_null(rest);
    snprintf(empty, sizeof empty, "ply\nformat ascii 1.0\nelement edge 0\nproperty int vertex1\n%s", rest);
    other = read_good(empty, "e.ply");
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
        {"a.obj", "v 1 2 1.0000000001e30", {"\"1.0000000001e30\""}},
        {"a.obj", "v 1e30 -1e30 0", {"no triangle"}},
        {"a.obj", "v 1 2 3,5", {"\"3,5\""}},
        {"a.obj", "v 1 2 0000000000000000000000000000000000000000000000000000000000000000000000001", {"a.obj:1: "}},
        {"a.obj", CUBE_VERTICES "f 1 2", {"a.obj:9: ", "2 corners"}},
        {"a.obj", CUBE_VERTICES "f 1 2 9", {"a.obj:9: ", "the vertex 9; so far there are 8"}},
        {"a.obj", CUBE_VERTICES "f 1 2 0", {"vertex 0;"}},
        {"a.obj", CUBE_VERTICES "f 1 2 -9", {"vertex -9;"}},
        {"a.obj", CUBE_VERTICES "f 1 2 99999999999999999999", {"a.obj:9: ", "no corner"}},
        {"a.obj", CUBE_VERTICES "f 1 2 00000000003", {"no corner"}},
        {"a.obj", CUBE_VERTICES "f 1 2 9999999999", {"the vertex 9999999999;"}},
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
        {"a.ply", PLY("element vertex\n"), {"element name count"}},
        {"a.ply", PLY("element vertex three\n"), {"element name count"}},
        {"a.ply", PLY("element vertex 1e300\n"), {"element name count"}},
        {"a.ply", PLY("element vertex 0\nproperty float x\nend_header\n"), {"with x, y and z"}},
        {"a.ply", PLY("element vertex 4294967296\n"), {"element name count"}},
        {"a.ply", PLY("element vertex 4294967295\n"), {"a.ply:4: ", "end_header"}},
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
        {"a.ply", PLY(PLY_3 PLY_FACE "0 0 0\n1 0 0\n0 1 0\n2 0 1\n"), {"fewer than three corners"}},
        {"a.ply", PLY(PLY_3 PLY_FACE "0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n"), {"longer than the rest"}},
        {"a.ply", PLY(PLY_3 PLY_FACE "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n"), {"longer than the rest"}},
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

/* Files fill the memory that is read into exactly, or by a byte less or more. */
static void files_are_read_to_their_end(void **unused)
{
    (void)unused;
    static const char name[] = "test_mesh_file.obj";
    rheo__mesh cube = read_good(cube_text, "a.obj"), mesh;
    static char text[131074];
    for (size_t room = 65536; room <= 131072; room *= 2)
        for (size_t size = room - 1; size <= room + 1; size++) {
            memset(text, ' ', size);
            memcpy(text + size - strlen(cube_text), cube_text, strlen(cube_text));
            write_file(name, text, size);
            OK(rheo__mesh_open(&mesh, &defaults, name, &error));
            assert_same_mesh(&mesh, &cube);
            rheo__mesh_release(&mesh);
        }
    /* The largest file, of which only the last bytes are stored; then one that is larger. */
    FILE *large = fopen(name, "wb");
    assert_non_null(large);
    assert_int_equal(fseek(large, (64L << 20) - 1, SEEK_SET), 0);
    fputc(' ', large);
    fflush(large);
    REFUSED(RHEO_ERROR_FORMAT, "no triangle", rheo__mesh_open(&mesh, &defaults, name, &error));
    fputc(' ', large);
    fclose(large);
    REFUSED(RHEO_ERROR_FORMAT, "more than 64 MiB", rheo__mesh_open(&mesh, &defaults, name, &error));
    remove(name);
    rheo__mesh_release(&cube);
}

static void every_truncation_is_safe(void **unused)
{
    (void)unused;
    read_every_cut(cube_text, strlen(cube_text), strlen(cube_text) - 1, "a.obj"); /* omits the last line's end */
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_bunny_is_built_in),        cmocka_unit_test(obj_is_read_in_all_its_forms),
        cmocka_unit_test(ply_is_read_in_all_its_forms), cmocka_unit_test(damaged_files_are_refused_with_their_line),
        cmocka_unit_test(files_are_read_to_their_end),  cmocka_unit_test(every_truncation_is_safe),
        cmocka_unit_test(every_changed_byte_is_safe),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
