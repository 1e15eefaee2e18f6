/* Memory of solids and constants that take more than a cast (solids/solids.h). */
#include "solids/solids.h"

#include <string.h>

rheo_real rheo__ball_mass(const rheo_world_def *def)
{
    const double pi = 3.14159265358979323846;
    const double spacing = def->fluid.spacing, radius = def->ball.radius;
    const double particles_per_volume =
        def->fluid.number_density > 0 ? def->fluid.number_density : 1 / (spacing * spacing * spacing);
    return (rheo_real)(def->ball.density_ratio * (4.0 / 3.0 * pi * radius * radius * radius) * particles_per_volume);
}

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

bool rheo__solids_reserve(rheo__solids *solids, uint32_t particles)
{
    void *touching = solids->touching;
    if (solids->def->ball.radius > 0 && !rheo__grow(&solids->allocator, &touching, &solids->touching_capacity,
                                                    (size_t)particles + 1, 0, sizeof *solids->touching))
        return false;
    solids->touching = touching;
    return true;
}

void rheo__solids_release(rheo__solids *solids)
{
    rheo__release(&solids->allocator, solids->touching);
    memset(solids, 0, sizeof *solids);
}
