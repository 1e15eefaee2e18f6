/* The isosurface of chi on a grid. */
#ifndef RHEO__VIEW_MARCHING_CUBES_H
#define RHEO__VIEW_MARCHING_CUBES_H

#include "view/grid.h"

/*
 * Makes vertices, normals, values and triangles. The caller sets s->allocator and zeroes all else, and releases `s`
 * also after a failure. RHEO_ERROR_MEMORY: no memory. RHEO_ERROR_UNSUPPORTED: more than 2^31 - 1 vertices or
 * triangles.
 */
rheo_result rheo__march(const rheo__grid *grid, double isovalue, rheo_surface *s, rheo_error *error);

#endif
