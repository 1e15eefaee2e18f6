/* Closed triangle meshes: reading them, proving that they are closed, and which points of a lattice are inside. */
#ifndef RHEO__SCENES_MESH_H
#define RHEO__SCENES_MESH_H

#include "core/memory.h"
#include "scenes/lattice.h"

/* The largest mesh file that is read, bytes. */
#define RHEO__MAX_MESH_BYTES ((size_t)64 << 20)
/* Coordinates are at most so large, so that no volume overflows. */
#define RHEO__MAX_MESH_COORDINATE 1e30

typedef struct rheo__mesh {
    rheo_allocator allocator;
    double *vertex;     /* vertices x 3 */
    uint32_t *triangle; /* triangles x 3 vertices; seen from outside they turn to the left */
    size_t vertices, triangles;
    size_t vertex_room, triangle_room;
    uint32_t first_number;  /* of the file's first vertex: 1 in OBJ, 0 in PLY */
    double low[3], high[3]; /* bounds of the triangles */
    double volume;          /* enclosed, > 0 but for rounding; a cavity counts against its surroundings */
} rheo__mesh;

/*
 * "bunny" (the Stanford bunny, which is built in) or a file, which ends in .obj or .ply. The mesh is checked. On
 * failure nothing is to be released. RHEO_ERROR_FORMAT: damaged or not closed; RHEO_ERROR_FILE: cannot be read to its
 * end; RHEO_ERROR_ARGUMENT: a name that is neither, or of no file.
 */
rheo_result rheo__mesh_open(rheo__mesh *mesh, const rheo_allocator *allocator, const char *name, rheo_error *error);
/* The same of a file that is in memory; the name's ending says which format it has. */
rheo_result rheo__mesh_read(rheo__mesh *mesh, const rheo_allocator *allocator, const char *bytes, size_t size,
                            const char *name, rheo_error *error);
void rheo__mesh_release(rheo__mesh *mesh);

/* ---- Making a mesh by hand ---- */

void rheo__mesh_init(rheo__mesh *mesh, const rheo_allocator *allocator, uint32_t first_number);
/* False: no memory. */
bool rheo__mesh_add_vertex(rheo__mesh *mesh, const double position[3]);
/* A triangle that has a vertex twice is left out: it bounds nothing. */
bool rheo__mesh_add_triangle(rheo__mesh *mesh, uint32_t a, uint32_t b, uint32_t c);
/*
 * Finds bounds and volume, turns a mesh that is inside out, and refuses one that is not closed (the message names its
 * largest hole), has an edge of more than two triangles or neighbours that are not oriented alike. Several pieces are
 * allowed.
 */
rheo_result rheo__mesh_check(rheo__mesh *mesh, const char *name, rheo_error *error);

/* ---- Inside ---- */

/* How the mesh lies over the lattice of whole numbers: (vertex - base) scale + shift. */
typedef struct rheo__mesh_frame {
    double base[3], scale, shift[3];
} rheo__mesh_frame;

/*
 * The points of the lattice of whole numbers that are inside (the winding number is not 0), z slowest, x fastest. A
 * point on the surface is inside if one a little farther along x, and much less along y, and much less again along z
 * is; so meshes that share a face share no point. RHEO_ERROR_ARGUMENT: the mesh reaches farther than 1e9 points or is
 * cut too often; RHEO_ERROR_MEMORY.
 */
rheo_result rheo__mesh_scan(const rheo__mesh *mesh, const rheo__mesh_frame *frame, rheo__run *run, void *user,
                            rheo_error *error);

#endif
