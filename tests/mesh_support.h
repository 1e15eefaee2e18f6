/* Meshes for the tests of meshes and fills. */
#ifndef RHEO__TESTS_MESH_SUPPORT_H
#define RHEO__TESTS_MESH_SUPPORT_H

#include "support.h"

#include "scenes/mesh.h"

static const rheo_allocator defaults = {NULL, NULL, NULL};

/* ---- Meshes to test with ---- */

static inline rheo__mesh read_good(const char *text, const char *name)
{
    rheo__mesh mesh;
    OK(rheo__mesh_read(&mesh, &defaults, text, strlen(text), name, &error));
    return mesh;
}

#define CUBE_VERTICES "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\n"

static const char cube_text[] = CUBE_VERTICES "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";

static inline void add_vertex(rheo__mesh *mesh, double x, double y, double z)
{
    const double position[3] = {x, y, z};
    assert_true(rheo__mesh_add_vertex(mesh, position));
}

static inline void add_triangle(rheo__mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    assert_true(rheo__mesh_add_triangle(mesh, a, b, c));
}

/* Adds a cube of this side with one corner at the origin to a mesh; -1: seen from inside. */
static inline void add_cube(rheo__mesh *mesh, double x, double side, int orientation)
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

static inline rheo__mesh octahedron(double radius)
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
static inline rheo__mesh torus(double large, double small, uint32_t n, uint32_t m)
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

static const char ply_text[] =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nelement face 4\nproperty list uchar int vertex_index\nelement edge 1\nproperty int a\n"
    "end_header\n0 0 0 1\n1 0 0 2\n0 1 0 3 0 0\n1 4\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n9\n";

/* ---- Tests: memory ---- */

typedef struct failing {
    int left, held;
} failing;

static inline void *failing_allocate(size_t bytes, void *user)
{
    failing *f = user;
    if (f->left-- <= 0)
        return NULL;
    f->held++;
    return malloc(bytes);
}

static inline void failing_release(void *memory, void *user)
{
    failing *f = user;
    f->held--;
    free(memory);
}

/* ---- Tests: fills ---- */

static inline void write_text(const char *name, const char *text)
{
    write_file(name, text, strlen(text));
}

/* ---- Tests: reading ---- */

static inline void assert_same_mesh(const rheo__mesh *a, const rheo__mesh *b)
{
    assert_int_equal(a->vertices, b->vertices);
    assert_int_equal(a->triangles, b->triangles);
    assert_memory_equal(a->vertex, b->vertex, a->vertices * 3 * sizeof(double));
    assert_memory_equal(a->triangle, b->triangle, a->triangles * 3 * sizeof(uint32_t));
}

#endif
