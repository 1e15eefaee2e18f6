/*
 * A cubic cell of the grid: corners, edges and faces by bits, x is bit 0. Corner c is at side (c >> a & 1) of axis
 * a. Edge 4 a + u + 2 v lies along axis a, at side u of the next axis and side v of the one after. Face 2 a + s is
 * at side s of axis a.
 */
#ifndef RHEO__VIEW_CELL_H
#define RHEO__VIEW_CELL_H

#include <stdint.h>

enum { RHEO__CELL_CORNERS = 8, RHEO__CELL_EDGES = 12, RHEO__CELL_FACES = 6, RHEO__CELL_NO_EDGE = -1 };

/* Corner at the low end of an edge. */
int rheo__cell_edge_low(int edge);
/* The two faces of an edge, as bits. */
uint32_t rheo__cell_edge_faces(int edge);
/*
 * Adds the segments of the surface on a face. v: chi - isovalue at the corners of the cell. next[e] becomes the
 * edge at which the segment from edge e ends. Going anticlockwise around the face, a segment starts where one
 * enters the fluid and ends where one leaves it, so the fluid is to its right.
 */
void rheo__cell_add_segments(int face, const double v[RHEO__CELL_CORNERS], int next[RHEO__CELL_EDGES]);

#endif
