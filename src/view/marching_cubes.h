/* The surface of a grid. */
#ifndef RHEO__VIEW_MARCHING_CUBES_H
#define RHEO__VIEW_MARCHING_CUBES_H

#include "view/grid.h"

/*
 * Makes vertices, normals, values and triangles. s->allocator is set, all else is zero; after a failure `s` holds
 * what was made so far. RHEO_ERROR_MEMORY; RHEO_ERROR_UNSUPPORTED: more than 2^31 - 1 vertices or triangles.
 */
rheo_result rheo__march(const rheo__grid *grid, double isovalue, rheo_surface *s, rheo_error *error);

#endif
