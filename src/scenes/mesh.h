/* Closed triangle meshes: reads them, checks that they are closed, and finds the lattice points inside. */
#ifndef RHEO__SCENES_MESH_H
#define RHEO__SCENES_MESH_H

#include "core/memory.h"
#include "scenes/lattice.h"

/* Largest mesh file, bytes. */
#define RHEO__MAX_MESH_BYTES ((size_t)64 << 20)
/* Largest coordinate; volumes of larger meshes could overflow. */
#define RHEO__MAX_MESH_COORDINATE 1e30

typedef struct rheo__mesh {
    rheo_allocator allocator;
    double *vertex;     /* vertices x 3 */
    uint32_t *triangle; /* triangles x 3 vertices, anticlockwise seen from outside */
    size_t vertices, triangles;
    size_t vertex_room, triangle_room;
    uint32_t first_number;  /* number of the first vertex in messages: 1 in OBJ, 0 in PLY */
    double low[3], high[3]; /* bounds of the triangles */
    double volume;          /* enclosed volume without cavities; > 0 apart from rounding */
} rheo__mesh;

/*
 * Opens and checks "bunny", the built-in Stanford bunny, or a file whose name ends in .obj or .ply. After a failure
 * there is nothing to release. RHEO_ERROR_FORMAT: damaged or not closed. RHEO_ERROR_FILE: cannot be read to its end.
 * RHEO_ERROR_ARGUMENT: any other name, or no such file.
 */
rheo_result rheo__mesh_open(rheo__mesh *mesh, const rheo_allocator *allocator, const char *name, rheo_error *error);
/* Does the same for a file in memory. The ending of the name tells its format. */
rheo_result rheo__mesh_read(rheo__mesh *mesh, const rheo_allocator *allocator, const char *bytes, size_t size,
                            const char *name, rheo_error *error);
void rheo__mesh_release(rheo__mesh *mesh);

/* ---- Making a mesh ---- */

void rheo__mesh_init(rheo__mesh *mesh, const rheo_allocator *allocator, uint32_t first_number);
/* False: no memory. */
bool rheo__mesh_add_vertex(rheo__mesh *mesh, const double position[3]);
/* Adds a triangle. Ignores one that has a vertex twice, because it has no area. False: no memory. */
bool rheo__mesh_add_triangle(rheo__mesh *mesh, uint32_t a, uint32_t b, uint32_t c);
/*
 * Computes bounds and volume, and reverses a mesh that is inside out. Refuses a mesh that is not closed (the message
 * names its largest hole), an edge with more than two triangles, and neighbours with different orientations. A mesh
 * may have several pieces.
 */
rheo_result rheo__mesh_check(rheo__mesh *mesh, const char *name, rheo_error *error);

/* ---- Inside ---- */

/* Transforms coordinates of the mesh to coordinates of the lattice: (vertex - base) scale + shift. */
typedef struct rheo__mesh_frame {
    double base[3], scale, shift[3];
} rheo__mesh_frame;

/*
 * Passes the lattice points inside the mesh (winding number not 0) to `run`, z slowest, x fastest. A point on the
 * surface counts as if it were moved by a very small distance along x, a much smaller one along y and a still smaller
 * one along z. So meshes that share a face share no point. RHEO_ERROR_ARGUMENT: the mesh reaches farther than 1e9
 * points, or rows cross it too often. RHEO_ERROR_MEMORY: no memory.
 */
rheo_result rheo__mesh_scan(const rheo__mesh *mesh, const rheo__mesh_frame *frame, rheo__run *run, void *user,
                            rheo_error *error);

#endif
