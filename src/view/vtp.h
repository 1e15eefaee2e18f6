/*
 * VTP: VTK XML PolyData with raw appended arrays, which ParaView reads. A file declares its arrays first; their values
 * follow in the same order.
 */
#ifndef RHEO__VIEW_VTP_H
#define RHEO__VIEW_VTP_H

#include "view/output.h"

typedef struct rheo__vtp {
    rheo__output *out;
    uint64_t offset; /* of the next array in the appended data */
} rheo__vtp;

/* Begins a file with the time of the world. */
rheo__vtp rheo__vtp_begin(rheo__output *out, const rheo_world *world, uint32_t points, uint32_t vertices,
                          size_t lines, uint32_t polygons);
/* Begins and ends an element: "PointData", "CellData", "Points", "Verts", "Lines" or "Polys". */
void rheo__vtp_open(const rheo__vtp *vtp, const char *element, const char *attributes);
void rheo__vtp_close(const rheo__vtp *vtp, const char *element);
void rheo__vtp_declare(rheo__vtp *vtp, rheo_element element, const char *name, uint32_t components, uint64_t bytes);
/* Declares the two arrays of an element with cells: the points of all cells, and where each cell ends among them. */
void rheo__vtp_declare_cells(rheo__vtp *vtp, const char *element, uint64_t points, uint64_t cells);

/* After the last declaration: begins the values. */
void rheo__vtp_begin_values(const rheo__vtp *vtp);
/* Each array is preceded by its size. */
void rheo__vtp_begin_array(const rheo__vtp *vtp, uint64_t bytes);
/* first, first + each, first + 2 each, ... as so many bytes. */
void rheo__vtp_progression(const rheo__vtp *vtp, uint64_t first, uint64_t each, uint64_t count, size_t bytes);
void rheo__vtp_end(const rheo__vtp *vtp);

#endif
