/* Obstacles and closed meshes, for their tests. */
#ifndef RHEO__TESTS_OBSTACLES_H
#define RHEO__TESTS_OBSTACLES_H

#include <math.h>

#include "support.h"

static uint32_t obstacle_seed = 1;

/* A number from -1 to 1. */
static inline double random_signed(void)
{
    obstacle_seed = obstacle_seed * 1664525u + 1013904223u;
    return (double)(obstacle_seed >> 8) / (1 << 23) - 1;
}

/* A closed mesh. */
typedef struct test_mesh {
    double vertex[8000][3];
    uint32_t triangle[16000][3];
    uint32_t vertices, triangles;
} test_mesh;

/* A box about the origin, with `cuts` squares along each edge. */
static inline void box_mesh(test_mesh *m, const double size[3], uint32_t cuts)
{
    m->vertices = m->triangles = 0;
    for (int face = 0; face < 6; face++) {
        const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3, side = face % 2;
        uint32_t corner[32][32];
        for (uint32_t i = 0; i <= cuts; i++)
            for (uint32_t j = 0; j <= cuts; j++) {
                double x[3];
                x[axis] = (side - 0.5) * size[axis];
                x[u] = ((double)i / cuts - 0.5) * size[u];
                x[v] = ((double)j / cuts - 0.5) * size[v];
                uint32_t found = 0;
                while (found < m->vertices &&
                       (m->vertex[found][0] != x[0] || m->vertex[found][1] != x[1] || m->vertex[found][2] != x[2]))
                    found++;
                if (found == m->vertices)
                    memcpy(m->vertex[m->vertices++], x, sizeof x);
                corner[i][j] = found;
            }
        for (uint32_t i = 0; i < cuts; i++)
            for (uint32_t j = 0; j < cuts; j++) {
                const uint32_t a = corner[i][j], b = corner[i + 1][j], c = corner[i + 1][j + 1], d = corner[i][j + 1];
                const uint32_t out[2][3] = {{a, b, c}, {a, c, d}}, in[2][3] = {{a, c, b}, {a, d, c}};
                memcpy(m->triangle[m->triangles], side ? out : in, sizeof out);
                m->triangles += 2;
            }
    }
}

/* Puts the vertices of a box of cubes on a sphere. */
static inline void sphere_mesh(test_mesh *m, double radius, uint32_t cuts)
{
    const double size[3] = {2, 2, 2};
    box_mesh(m, size, cuts);
    for (uint32_t i = 0; i < m->vertices; i++) {
        double *x = m->vertex[i];
        const double length = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        for (int axis = 0; axis < 3; axis++)
            x[axis] *= radius / length;
    }
}

static inline rheo_obstacle mesh_obstacle(const test_mesh *m)
{
    rheo_obstacle o = rheo_default_obstacle(RHEO_OBSTACLE_MESH);
    o.mesh.vertex = m->vertex;
    o.mesh.triangle = m->triangle;
    o.mesh.vertex_count = m->vertices;
    o.mesh.triangle_count = m->triangles;
    return o;
}

static inline rheo_obstacle box_obstacle(double x, double y, double z)
{
    rheo_obstacle o = rheo_default_obstacle(RHEO_OBSTACLE_BOX);
    o.size[0] = x;
    o.size[1] = y;
    o.size[2] = z;
    return o;
}

static inline void add_obstacle(rheo_world_def *def, rheo_obstacle o)
{
    OK(rheo_world_def_add_obstacle(def, &o, &error));
}

static inline rheo_obstacle_state state_of(const rheo_world *world, uint32_t index)
{
    rheo_obstacle_state state;
    assert_int_equal(rheo_world_obstacle(world, index, &state), RHEO_OK);
    return state;
}

/* Distance of a particle from obstacle 0. */
static inline double distance_of(const rheo_world *world, uint32_t id)
{
    const rheo_real *x = rheo_world_positions(world) + 3 * (size_t)id;
    const double at[3] = {(double)x[0], (double)x[1], (double)x[2]};
    return rheo_world_obstacle_distance(world, 0, at, NULL);
}

#endif
