/* Distances from the shapes of obstacles (space/rigid_shapes.c, space/surface.c) against brute force and closed forms. */
#include "obstacles.h"

#include "core/memory.h"
#include "space/rigid_shapes.h"

static rheo_allocator allocator;

static rheo__rigid make(const rheo_obstacle *o)
{
    rheo__rigid solid;
    const rheo_allocator own = rheo__allocator_or_default(allocator);
    OK(rheo__rigid_make(&solid, o, &own, &error));
    return solid;
}

static void discard(rheo__rigid *solid)
{
    const rheo_allocator own = rheo__allocator_or_default(allocator);
    rheo__rigid_release(solid, &own);
}

static double distance(const rheo__rigid *solid, const double x[3], double n[3])
{
    return rheo__rigid_distance(solid, x, __builtin_inf(), n);
}

/* The normal has length 1, and along it the distance grows as fast as the point moves. */
static void grows_along_normal(const rheo__rigid *solid, const double x[3], double tolerance)
{
    double n[3], again[3];
    const double d = distance(solid, x, n), way = 1e-5;
    NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-12);
    /* Away from the surface on its side the nearest point stays the same. */
    const double out = d > 0 ? way : -way, y[3] = {x[0] + out * n[0], x[1] + out * n[1], x[2] + out * n[2]};
    if (d > 0)
        NEAR(distance(solid, y, again), d + out, tolerance);
    /* The nearest point is on the surface. */
    const double on[3] = {x[0] - d * n[0], x[1] - d * n[1], x[2] - d * n[2]};
    NEAR(distance(solid, on, again), 0, tolerance);
}

/* ---- Sphere, box, cylinder ---- */

static bool in_box(const double x[3], const double half[3])
{
    return fabs(x[0]) <= half[0] && fabs(x[1]) <= half[1] && fabs(x[2]) <= half[2];
}

/* Least distance from many points of the surface, which are `apart` from their neighbours. */
static double brute_box(const double x[3], const double half[3], double apart)
{
    double least2 = 1e300;
    for (int axis = 0; axis < 3; axis++)
        for (int side = -1; side <= 1; side += 2) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3, nu = (int)(2 * half[u] / apart) + 1,
                      nv = (int)(2 * half[v] / apart) + 1;
            for (int i = 0; i <= nu; i++)
                for (int j = 0; j <= nv; j++) {
                    const double du = half[u] * (2.0 * i / nu - 1) - x[u], dv = half[v] * (2.0 * j / nv - 1) - x[v],
                                 dw = side * half[axis] - x[axis], d2 = du * du + dv * dv + dw * dw;
                    least2 = d2 < least2 ? d2 : least2;
                }
        }
    return sqrt(least2);
}

static void a_box_is_where_its_faces_are(void **unused)
{
    (void)unused;
    const rheo_obstacle o = box_obstacle(2, 1, 3);
    const double half[3] = {1, 0.5, 1.5}, apart = 0.02;
    rheo__rigid solid = make(&o);
    assert_true(solid.reach >= sqrt(1 + 0.25 + 2.25) - 1e-15);
    for (size_t i = 0; i < 400; i += every()) {
        const double x[3] = {2 * random_signed(), 1.5 * random_signed(), 3 * random_signed()};
        double n[3];
        const double d = distance(&solid, x, n), brute = brute_box(x, half, apart);
        assert_true((d < 0) == in_box(x, half) || fabs(d) < 1e-12);
        assert_true(fabs(d) <= brute + 1e-12 && brute <= fabs(d) + apart);
        grows_along_normal(&solid, x, 1e-12);
    }
    discard(&solid);
}

static void a_sphere_is_where_its_radius_ends(void **unused)
{
    (void)unused;
    rheo_obstacle o = rheo_default_obstacle(RHEO_OBSTACLE_SPHERE);
    o.radius = 2.5;
    rheo__rigid outside = make(&o);
    o.inside = RHEO_OBSTACLE_INSIDE;
    rheo__rigid inside = make(&o);
    double n[3], m[3];
    for (int i = 0; i < 100; i++) {
        const double x[3] = {4 * random_signed(), 4 * random_signed(), 4 * random_signed()},
                     length = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        NEAR(distance(&outside, x, n), length - 2.5, 1e-14);
        NEAR(distance(&inside, x, m), 2.5 - length, 1e-14);
        for (int axis = 0; axis < 3; axis++) {
            NEAR(n[axis], x[axis] / length, 1e-15);
            assert_true(m[axis] == -n[axis]);
        }
    }
    const double centre[3] = {0, 0, 0};
    assert_true(distance(&outside, centre, n) == -2.5 && n[1] == 1);
}

static void a_cylinder_is_a_capped_tube_about_any_axis(void **unused)
{
    (void)unused;
    rheo_obstacle o = rheo_default_obstacle(RHEO_OBSTACLE_CYLINDER);
    o.radius = 1.5;
    o.length = 4;
    for (size_t i = 0; i < 500; i++) {
        double a[3], n[3];
        for (int axis = 0; axis < 3; axis++)
            a[axis] = o.axis[axis] = random_signed();
        const double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]),
                     x[3] = {3 * random_signed(), 3 * random_signed(), 3 * random_signed()};
        rheo__rigid solid = make(&o);
        const double along = (a[0] * x[0] + a[1] * x[1] + a[2] * x[2]) / length,
                     aside = sqrt(fmax(x[0] * x[0] + x[1] * x[1] + x[2] * x[2] - along * along, 0)) - 1.5,
                     above = fabs(along) - 2,
                     expected = aside > 0 && above > 0 ? sqrt(aside * aside + above * above) : fmax(aside, above);
        NEAR(distance(&solid, x, n), expected, 1e-12);
        NEAR(solid.reach, 2.5, 1e-15);
        grows_along_normal(&solid, x, 1e-12);
        /* On the axis any direction across it is right. */
        const double on[3] = {0.4 * a[0], 0.4 * a[1], 0.4 * a[2]};
        NEAR(distance(&solid, on, n), fmax(-1.5, 0.4 * length - 2), 1e-12);
        NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-12);
    }
}

/* ---- Meshes ---- */

/* Points near faces, edges and corners, and far away. The mesh of a box has the distance and the normal of the box. */
static void a_mesh_of_a_box_is_a_box(void **unused)
{
    (void)unused;
    static test_mesh m;
    const double size[3] = {2, 1, 3};
    for (uint32_t cuts = 1; cuts <= 16; cuts *= 4) {
        box_mesh(&m, size, cuts);
        const rheo_obstacle o = mesh_obstacle(&m), box = box_obstacle(2, 1, 3);
        rheo__rigid mesh = make(&o), exact = make(&box);
        NEAR(mesh.centre[1], 0.5, 1e-15);
        for (int i = 0; i < 2000; i++) {
            double x[3], n[3], e[3];
            for (int axis = 0; axis < 3; axis++) {
                const double far = i % 3 ? 1e-3 : 2, where = random_signed();
                /* Of the coordinates, some are at a corner, some anywhere. */
                x[axis] = i >> (axis + 2) & 1 ? (where < 0 ? -0.5 : 0.5) * size[axis] + far * random_signed()
                                              : size[axis] * where;
            }
            const double of_mesh = distance(&mesh, x, n), of_box = distance(&exact, x, e);
            NEAR(of_mesh, of_box, 1e-12);
            if (of_box > 1e-6)
                for (int axis = 0; axis < 3; axis++)
                    NEAR(n[axis], e[axis], 1e-6);
        }
        discard(&mesh);
    }
}

/* Exactly above, on and below corners and edges, where the nearest triangle is one of several. */
static void signs_at_edges_and_vertices_are_right(void **unused)
{
    (void)unused;
    static test_mesh m;
    const double size[3] = {2, 2, 2};
    box_mesh(&m, size, 2);
    const rheo_obstacle o = mesh_obstacle(&m);
    rheo__rigid solid = make(&o);
    for (int x = -2; x <= 2; x++)
        for (int y = -2; y <= 2; y++)
            for (int z = -2; z <= 2; z++) {
                const double at[3] = {0.75 * x, 0.75 * y, 0.75 * z},
                             over[3] = {fmax(fabs(at[0]) - 1, 0), fmax(fabs(at[1]) - 1, 0), fmax(fabs(at[2]) - 1, 0)};
                const double beyond = sqrt(over[0] * over[0] + over[1] * over[1] + over[2] * over[2]),
                             most = fmax(fabs(at[0]), fmax(fabs(at[1]), fabs(at[2])));
                double n[3];
                NEAR(distance(&solid, at, n), beyond > 0 ? beyond : most - 1, 1e-14);
                const double corner[3] = {x < 0 ? -1 : 1, y < 0 ? -1 : 1, z < 0 ? -1 : 1};
                NEAR(distance(&solid, corner, n), 0, 1e-14); /* the normal of a corner is that between its faces */
                for (int axis = 0; axis < 3; axis++)
                    NEAR(n[axis], corner[axis] / sqrt(3), 1e-9);
            }
    discard(&solid);
}

/* A tetrahedron with a needle as its top: the normal of any one face has the wrong sign beside the top. */
static void a_needle_has_no_wrong_signs(void **unused)
{
    (void)unused;
    static const double vertex[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0.1, 20, 0.1}};
    static const uint32_t triangle[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    rheo_obstacle o = rheo_default_obstacle(RHEO_OBSTACLE_MESH);
    o.mesh.vertex = vertex;
    o.mesh.triangle = triangle;
    o.mesh.vertex_count = o.mesh.triangle_count = 4;
    rheo__rigid solid = make(&o);
    const double middle[3] = {0.5, 10, 0.5};
    for (int i = 0; i < 3000; i++) {
        double x[3], n[3], p[3];
        const double size = i % 2 ? 1 : 0.01;
        for (int axis = 0; axis < 3; axis++)
            p[axis] = vertex[3][axis] + size * random_signed(), x[axis] = p[axis] - middle[axis];
        /* Inside: on the inner side of all faces. */
        bool inside = true;
        for (int t = 0; t < 4; t++) {
            const double *a = vertex[triangle[t][0]], *b = vertex[triangle[t][1]], *c = vertex[triangle[t][2]];
            const double ab[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]},
                         ac[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
            inside = inside && (ab[1] * ac[2] - ab[2] * ac[1]) * (p[0] - a[0]) +
                                       (ab[2] * ac[0] - ab[0] * ac[2]) * (p[1] - a[1]) +
                                       (ab[0] * ac[1] - ab[1] * ac[0]) * (p[2] - a[2]) <
                                   0;
        }
        const double d = distance(&solid, x, n);
        assert_true((d < 0) == inside);
    }
    discard(&solid);
}

/* The nearest of all triangles, by brute force over points of them, and the limit that saves time. */
static void the_grid_finds_the_nearest_triangle(void **unused)
{
    (void)unused;
    static test_mesh m;
    sphere_mesh(&m, 2, 24);
    const rheo_obstacle o = mesh_obstacle(&m);
    rheo__rigid solid = make(&o);
    const double sag = 2 * (1 - cos(1.0 / 12)); /* triangles are chords */
    for (int i = 0; i < 4000; i++) {
        const double x[3] = {3 * random_signed(), 3 * random_signed(), 3 * random_signed()},
                     length = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        double n[3], quick[3];
        const double d = distance(&solid, x, n), limit = 0.3;
        assert_true(d >= length - 2 - 1e-12 && d <= length - 2 + sag);
        const double limited = rheo__rigid_distance(&solid, x, limit, quick);
        if (d < limit) {
            assert_true(limited == d);
            assert_memory_equal(n, quick, sizeof n);
        } else {
            assert_true(limited >= limit && limited <= d);
        }
    }
    discard(&solid);
}

static void the_inside_of_a_mesh_is_its_outside_turned_round(void **unused)
{
    (void)unused;
    static test_mesh m;
    sphere_mesh(&m, 2, 8);
    rheo_obstacle o = mesh_obstacle(&m);
    rheo__rigid outside = make(&o);
    o.inside = RHEO_OBSTACLE_INSIDE;
    rheo__rigid inside = make(&o);
    for (int i = 0; i < 2000; i++) {
        const double x[3] = {3 * random_signed(), 3 * random_signed(), 3 * random_signed()};
        double a[3], b[3];
        const double d = distance(&outside, x, a), turned = distance(&inside, x, b),
                     limited = rheo__rigid_distance(&inside, x, 0.2, b);
        assert_true(d == -turned);
        assert_true(turned < 0.2 ? limited == turned : limited >= 0.2);
    }
    discard(&outside);
    discard(&inside);
}

static void a_mesh_is_scaled_to_its_height(void **unused)
{
    (void)unused;
    static test_mesh m;
    const double size[3] = {2, 1, 3};
    box_mesh(&m, size, 2);
    for (uint32_t v = 0; v < m.vertices; v++)
        m.vertex[v][0] += 100;
    rheo_obstacle o = mesh_obstacle(&m);
    o.height = 4;
    rheo__rigid solid = make(&o);
    double n[3];
    const double above[3] = {0, 3, 0}, beside[3] = {5, 0, 0};
    NEAR(distance(&solid, above, n), 1, 1e-12);
    NEAR(distance(&solid, beside, n), 1, 1e-12);
    NEAR(solid.centre[1], 2, 1e-12);
    discard(&solid);
}

static void bad_meshes_have_one_message(void **unused)
{
    (void)unused;
    static test_mesh m;
    const rheo_allocator own = rheo__allocator_or_default(allocator);
    const double size[3] = {1, 1, 1};
    rheo__rigid solid;
    rheo_obstacle o = rheo_default_obstacle(RHEO_OBSTACLE_MESH);
    REFUSED(RHEO_ERROR_ARGUMENT, "has no triangles", rheo__rigid_make(&solid, &o, &own, &error));
    box_mesh(&m, size, 2);
    o = mesh_obstacle(&m);
    o.mesh.triangle_count--;
    REFUSED(RHEO_ERROR_ARGUMENT, "is not closed", rheo__rigid_make(&solid, &o, &own, &error));
    o.mesh.triangle_count++;
    const uint32_t swap = m.triangle[3][0];
    m.triangle[3][0] = m.triangle[3][1];
    m.triangle[3][1] = swap;
    REFUSED(RHEO_ERROR_ARGUMENT, "is not closed", rheo__rigid_make(&solid, &o, &own, &error));
    for (uint32_t t = 0; t < m.triangles; t++)
        if (t != 3) {
            const uint32_t first = m.triangle[t][0];
            m.triangle[t][0] = m.triangle[t][1];
            m.triangle[t][1] = first;
        }
    REFUSED(RHEO_ERROR_ARGUMENT, "is inside out", rheo__rigid_make(&solid, &o, &own, &error));
    m.triangle[5][1] = m.vertices;
    REFUSED(RHEO_ERROR_ARGUMENT, "but triangle 5 has vertex", rheo__rigid_make(&solid, &o, &own, &error));
    box_mesh(&m, size, 1);
    memcpy(m.vertex[m.triangle[0][0]], m.vertex[m.triangle[0][1]], sizeof *m.vertex);
    REFUSED(RHEO_ERROR_ARGUMENT, "has a triangle without area", rheo__rigid_make(&solid, &o, &own, &error));
    m.vertex[2][1] = NAN;
    REFUSED(RHEO_ERROR_ARGUMENT, "not finite, 2", rheo__rigid_make(&solid, &o, &own, &error));
    /* Two cubes that share an edge. */
    box_mesh(&m, size, 1);
    const uint32_t vertices = m.vertices, triangles = m.triangles;
    for (uint32_t v = 0; v < vertices; v++)
        for (int axis = 0; axis < 3; axis++)
            m.vertex[vertices + v][axis] = m.vertex[v][axis] + (axis < 2);
    for (uint32_t t = 0; t < triangles; t++)
        for (int k = 0; k < 3; k++) {
            uint32_t v = vertices + m.triangle[t][k];
            for (uint32_t same = 0; same < vertices; same++)
                if (memcmp(m.vertex[same], m.vertex[v], sizeof *m.vertex) == 0)
                    v = same;
            m.triangle[triangles + t][k] = v;
        }
    m.vertices *= 2;
    m.triangles *= 2;
    o = mesh_obstacle(&m);
    REFUSED(RHEO_ERROR_ARGUMENT, "edge", rheo__rigid_make(&solid, &o, &own, &error));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_is_where_its_faces_are),
        cmocka_unit_test(a_sphere_is_where_its_radius_ends),
        cmocka_unit_test(a_cylinder_is_a_capped_tube_about_any_axis),
        cmocka_unit_test(a_mesh_of_a_box_is_a_box),
        cmocka_unit_test(signs_at_edges_and_vertices_are_right),
        cmocka_unit_test(a_needle_has_no_wrong_signs),
        cmocka_unit_test(the_grid_finds_the_nearest_triangle),
        cmocka_unit_test(the_inside_of_a_mesh_is_its_outside_turned_round),
        cmocka_unit_test(a_mesh_is_scaled_to_its_height),
        cmocka_unit_test(bad_meshes_have_one_message),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
