/* The plane walls of a world, made once from its definition. Solids and models read them. */
#ifndef RHEO__SPACE_PLANES_H
#define RHEO__SPACE_PLANES_H

#include "core/real.h"
#include "rheolog/world.h"

typedef struct rheo__plane {
    rheo_real normal[3]; /* unit vector into the fluid */
    rheo_real offset;    /* normal . x on the plane */
} rheo__plane;

typedef struct rheo__planes {
    rheo__plane plane[RHEO_MAX_WALLS];
    uint32_t count;
} rheo__planes;

void rheo__planes_make(rheo__planes *planes, const rheo_world_def *def);

/* Distance of the point (x, y, z) from a plane; negative behind it. */
static inline rheo_real rheo__plane_distance(const rheo__plane *plane, rheo_real x, rheo_real y, rheo_real z)
{
    const rheo_real *n = plane->normal;
    return n[0] * x + n[1] * y + n[2] * z - plane->offset;
}

#endif
