/* Obstacles as triangles, for pictures and files. */
#ifndef RHEO__VIEW_FACETS_H
#define RHEO__VIEW_FACETS_H

#include "rheolog/world.h"

/* A triangle, anticlockwise seen from the side of the fluid, with normals towards it. */
typedef struct rheo__facet {
    double corner[3][3], normal[3][3];
} rheo__facet;

typedef void rheo__take_facet(void *user, const rheo__facet *facet);

/* Passes the triangles of an obstacle to `take`, in a fixed order. Returns their number. take: NULL, only counts. */
uint32_t rheo__obstacle_facets(const rheo_world *world, uint32_t index, rheo__take_facet *take, void *user);

#endif
