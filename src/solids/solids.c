/* Memory of solids and constants that take more than a cast (solids/solids.h). */
#include "solids/solids.h"

#include <string.h>

void rheo__solids_configure(rheo__solids *solids, const rheo_world_def *def, const rheo__planes *planes)
{
    solids->def = def;
    solids->planes = planes;
    solids->vibrating_wall = UINT32_MAX;
    for (uint32_t w = planes->count; w-- > 0;)
        if (def->vibrators.count && def->vibrators.kind == RHEO_VIBRATOR_FLOOR && planes->plane[w].normal[1] == 1)
            solids->vibrating_wall = w;
}

void rheo__solids_vibrators_moved(rheo__solids *solids, const rheo__state *s)
{
    /* Vibrators that raise the same point are within two radii of each other. */
    const rheo_real radius = (rheo_real)solids->def->vibrators.radius, limit = 4 * radius * radius;
    uint32_t max_overlap = 0;
    for (uint32_t a = 0; a < s->vibrators; a++) {
        uint32_t overlap = 0;
        for (uint32_t b = 0; b < s->vibrators; b++) {
            const rheo_real dx = s->vibrator_position[2 * a] - s->vibrator_position[2 * b];
            const rheo_real dz = s->vibrator_position[2 * a + 1] - s->vibrator_position[2 * b + 1];
            overlap += dx * dx + dz * dz <= limit;
        }
        max_overlap = overlap > max_overlap ? overlap : max_overlap;
    }
    solids->max_bump = (rheo_real)solids->def->vibrators.amplitude * (rheo_real)max_overlap;
}

rheo_result rheo__solids_make_obstacles(rheo__solids *solids, const rheo_world_def *def, rheo_error *error)
{
    if (!def->obstacles.count)
        return RHEO_OK;
    solids->obstacle = rheo__allocate(&solids->allocator, def->obstacles.count, sizeof *solids->obstacle);
    if (!solids->obstacle)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for %u obstacles", def->obstacles.count);
    for (uint32_t i = 0; i < def->obstacles.count; i++, solids->obstacles++) {
        rheo_error why;
        const rheo_result result =
            rheo__rigid_make(&solids->obstacle[i], &def->obstacles.list[i], &solids->allocator, &why);
        if (result == RHEO_ERROR_MEMORY)
            return rheo__fail(error, result, "%s", why.message);
        if (result != RHEO_OK)
            return rheo__fail(error, result, "the mesh of obstacle %u %s", i, why.message);
    }
    return RHEO_OK;
}

void rheo__solids_release(rheo__solids *solids)
{
    rheo__release(&solids->allocator, solids->touch);
    for (uint32_t i = 0; i < solids->obstacles; i++)
        rheo__rigid_release(&solids->obstacle[i], &solids->allocator);
    rheo__release(&solids->allocator, solids->obstacle);
}

RHEO__DEFINE_SIMD_STAGE(walls)
