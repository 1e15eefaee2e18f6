/* Plane walls (space/planes.h). Normals are scaled to unit length in double, then rounded. */
#include "space/planes.h"

void rheo__planes_make(rheo__planes *planes, const rheo_world_def *def)
{
    planes->count = def->walls.count;
    for (uint32_t w = 0; w < def->walls.count; w++) {
        const double *n = def->walls.plane[w].normal, *point = def->walls.plane[w].point;
        const double scale = 1 / __builtin_sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        double offset = 0;
        for (int axis = 0; axis < 3; axis++) {
            planes->plane[w].normal[axis] = (rheo_real)(n[axis] * scale);
            offset += n[axis] * scale * point[axis];
        }
        planes->plane[w].offset = (rheo_real)offset;
    }
}
