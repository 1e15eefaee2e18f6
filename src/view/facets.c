/*
 * Obstacles as triangles (view/facets.h): a sphere is a cube whose points are put on it, a cylinder has flat sides that are
 * lit as round ones.
 */
#include "view/facets.h"

#include <string.h>

#include "core/math.h"
#include "solids/solids.h"
#include "space/surface.h"
#include "view/vectors.h"
#include "world/world.h"

enum { CUTS = 10, SIDES = 48 }; /* of a face of the cube; of a cylinder */

/* Where triangles go, and what moves them there. */
typedef struct sink {
    rheo__take_facet *take;
    void *user;
    uint32_t count;
    const rheo__rigid *solid;
    double centre[3];
    rheo__matrix matrix;
} sink;

/* Adds a triangle of the frame of the shape that is anticlockwise from outside. normal: NULL: that of the triangle. */
static void add(sink *s, double corner[3][3], double normal[3][3])
{
    rheo__facet facet;
    s->count++;
    if (!s->take)
        return;
    for (int k = 0; k < 3; k++) {
        /* Fluid inside sees the triangle from the other side. */
        const int from = s->solid->inside ? 2 - k : k;
        double flat[3], ab[3], ac[3], turned[3];
        for (int a = 0; a < 3; a++) {
            ab[a] = corner[1][a] - corner[0][a];
            ac[a] = corner[2][a] - corner[0][a];
        }
        rheo__view_cross(ab, ac, flat);
        rheo__view_normalise(flat);
        rheo__out_of_frame(&s->matrix, corner[from], turned);
        rheo__out_of_frame(&s->matrix, normal ? normal[from] : flat, facet.normal[k]);
        for (int a = 0; a < 3; a++) {
            facet.corner[k][a] = s->centre[a] + turned[a];
            facet.normal[k][a] = s->solid->inside ? -facet.normal[k][a] : facet.normal[k][a];
        }
    }
    s->take(s->user, &facet);
}

static void add_four(sink *s, double corner[4][3], double normal[4][3])
{
    static const int PART[2][3] = {{0, 1, 2}, {0, 2, 3}};
    for (int t = 0; t < 2; t++) {
        double c[3][3], n[3][3];
        for (int k = 0; k < 3; k++) {
            memcpy(c[k], corner[PART[t][k]], sizeof c[k]);
            if (normal)
                memcpy(n[k], normal[PART[t][k]], sizeof n[k]);
        }
        add(s, c, normal ? n : NULL);
    }
}

/* Each face of a cube in cuts x cuts squares; on a sphere of this radius if it is above 0, else of these half edges. */
static void add_cube(sink *s, int cuts, const double half[3], double radius)
{
    static const int CORNER[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (int face = 0; face < 6; face++)
        for (int square = 0; square < cuts * cuts; square++) {
            const int axis = face / 2, side = face % 2 ? 1 : -1;
            double corner[4][3], normal[4][3];
            for (int k = 0; k < 4; k++) {
                const int *at = CORNER[side > 0 ? k : 3 - k];
                double *c = corner[k];
                c[axis] = side;
                c[(axis + 1) % 3] = 2.0 * (square / cuts + at[0]) / cuts - 1;
                c[(axis + 2) % 3] = 2.0 * (square % cuts + at[1]) / cuts - 1;
                memcpy(normal[k], c, sizeof normal[k]);
                rheo__view_normalise(normal[k]);
                for (int a = 0; a < 3; a++)
                    c[a] = radius > 0 ? radius * normal[k][a] : half[a] * c[a];
            }
            add_four(s, corner, radius > 0 ? normal : NULL);
        }
}

static void add_cylinder(sink *s, const rheo__rigid *solid)
{
    const double *axis = solid->axis;
    double u[3], v[3], other[3] = {0, 0, 0};
    int least = 0;
    for (int a = 1; a < 3; a++)
        least = axis[a] * axis[a] < axis[least] * axis[least] ? a : least;
    other[least] = 1;
    rheo__view_cross(axis, other, u);
    rheo__view_normalise(u);
    rheo__view_cross(axis, u, v);
    for (int i = 0; i < SIDES; i++) {
        double rim[4][3], normal[4][3], low[3][3], high[3][3];
        for (int k = 0; k < 4; k++) {
            const double angle /* in turns */ = (double)(i + (k == 1 || k == 2)) / SIDES, along = k < 2 ? -1 : 1;
            for (int a = 0; a < 3; a++) {
                normal[k][a] = rheo__cos_turns(angle) * u[a] + rheo__sin_turns(angle) * v[a];
                rim[k][a] = solid->radius * normal[k][a] + along * solid->half[1] * axis[a];
            }
        }
        add_four(s, rim, normal);
        for (int a = 0; a < 3; a++) {
            low[0][a] = -solid->half[1] * axis[a];
            low[1][a] = rim[1][a];
            low[2][a] = rim[0][a];
            high[0][a] = solid->half[1] * axis[a];
            high[1][a] = rim[3][a];
            high[2][a] = rim[2][a];
        }
        add(s, low, NULL);
        add(s, high, NULL);
    }
}

static void add_mesh(sink *s, const rheo__surface *surface)
{
    for (size_t t = 0; t < surface->triangles; t++) {
        double corner[3][3];
        for (int k = 0; k < 3; k++)
            memcpy(corner[k], surface->vertex[surface->triangle[t][k]], sizeof corner[k]);
        add(s, corner, NULL);
    }
}

uint32_t rheo__obstacle_facets(const rheo_world *world, uint32_t index, rheo__take_facet *take, void *user)
{
    const rheo__rigid *solid = &world->solids->obstacle[index];
    sink s = {.take = take, .user = user, .solid = solid};
    memcpy(s.centre, world->state.obstacle_position + 3 * (size_t)index, sizeof s.centre);
    s.matrix = rheo__rotation_matrix(world->state.obstacle_rotation + 4 * (size_t)index);
    switch (solid->shape) {
    case RHEO_OBSTACLE_SPHERE:
        add_cube(&s, CUTS, solid->half, solid->radius);
        break;
    case RHEO_OBSTACLE_BOX:
        add_cube(&s, 1, solid->half, 0);
        break;
    case RHEO_OBSTACLE_CYLINDER:
        add_cylinder(&s, solid);
        break;
    case RHEO_OBSTACLE_MESH:
        add_mesh(&s, solid->surface);
        break;
    }
    return s.count;
}
