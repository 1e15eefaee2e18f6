/*
 * A cubic cell of the grid. Corners, edges and faces are numbered by bits; x is bit 0. Corner c is at side
 * (c >> a & 1) of axis a. Edge 4 a + u + 2 v lies along axis a, at side u of axis a + 1 and side v of axis a + 2
 * (modulo 3). Face 2 a + s is at side s of axis a.
 */
#ifndef RHEO__VIEW_CELL_H
#define RHEO__VIEW_CELL_H

#include <stdint.h>

enum { RHEO__CELL_CORNERS = 8, RHEO__CELL_EDGES = 12, RHEO__CELL_FACES = 6, RHEO__CELL_NO_EDGE = -1 };

/* Corner at the lower end of an edge. */
int rheo__cell_edge_low(int edge);
/* Bit mask of the two faces of an edge. */
uint32_t rheo__cell_edge_faces(int edge);
/*
 * Adds the segments of the surface on a face. `v` is chi - isovalue at the corners of the cell. next[e] becomes the
 * edge at which the segment from edge e ends. On an anticlockwise path around the face, a segment starts where the
 * path enters the fluid and ends where it leaves the fluid. So the fluid is to the right of the segment.
 */
void rheo__cell_add_segments(int face, const double v[RHEO__CELL_CORNERS], int next[RHEO__CELL_EDGES]);

#endif
