/*
 * The signed distance from a closed surface of triangles: that of the nearest triangle, found through a uniform grid. Its
 * sign is that of the angle-weighted pseudonormal of the nearest face, edge or vertex, which is right everywhere
 * [Baerentzen, Aanaes 2005].
 */
#ifndef RHEO__SPACE_SURFACE_H
#define RHEO__SPACE_SURFACE_H

#include "core/error.h"
#include "core/memory.h"

typedef struct rheo__surface_mesh {
    const double (*vertex)[3];
    const uint32_t (*triangle)[3];
    uint32_t vertices, triangles;
    double height; /* to which it is scaled; 0: as it is */
} rheo__surface_mesh;

typedef struct rheo__surface {
    uint32_t vertices, triangles;
    double (*vertex)[3]; /* scaled; the middle of the bounding box is the origin */
    uint32_t (*triangle)[3];
    double (*vertex_normal)[3]; /* pseudonormals, not of unit length */
    double (*face_normal)[3];   /* of unit length */
    double (*edge_normal)[3];   /* of the edges from corner 0, 1 and 2 of each triangle */
    double half_height, reach;  /* reach: largest distance of a vertex from the origin */

    double low[3], cell;
    uint32_t cells[3];
    uint32_t *first,
        *member;           /* triangles whose box meets a cell: member[first[cell]] to member[first[cell + 1] - 1] */
    double *cell_distance; /* signed distance of the middle of each cell */
} rheo__surface;

/*
 * Makes a surface. RHEO_ERROR_MEMORY; RHEO_ERROR_ARGUMENT: it is not closed, it is inside out, a triangle has no area, or
 * a number is out of range. The message has no subject: "is not closed: ...".
 */
rheo_result rheo__surface_make(const rheo__surface_mesh *mesh, const rheo_allocator *allocator,
                               rheo__surface **surface, rheo_error *error);
/* NULL is allowed. */
void rheo__surface_release(rheo__surface *surface, const rheo_allocator *allocator);

/*
 * Signed distance of x, negative inside, and the unit vector along which it grows. below: any distance below `limit` is
 * as good as another one; otherwise any distance of at least `limit`.
 */
double rheo__surface_distance(const rheo__surface *surface, const double x[3], double limit, bool below,
                              double normal[3]);

/* ---- For both files ---- */

static inline double rheo__dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void rheo__minus3(const double a[3], const double b[3], double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = a[axis] - b[axis];
}

static inline void rheo__cross3(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline const double *rheo__corner(const rheo__surface *s, size_t triangle, int k)
{
    return s->vertex[s->triangle[triangle][k % 3]];
}

/* The cell of a coordinate; the nearest one for points outside of the grid. */
static inline uint32_t rheo__cell_along(const rheo__surface *s, double x, int axis)
{
    const double place = (x - s->low[axis]) / s->cell;
    return place >= 1 ? place < s->cells[axis] ? (uint32_t)place : s->cells[axis] - 1 : 0;
}

static inline size_t rheo__cell_at(const rheo__surface *s, const uint32_t at[3])
{
    return ((size_t)at[2] * s->cells[1] + at[1]) * s->cells[0] + at[0];
}

#endif
