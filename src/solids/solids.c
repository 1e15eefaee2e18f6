/* What walls, ball and vibrators share: constants and memory (solids/solids.h). */
#include "solids/solids.h"

#include <string.h>

/* The ball's mass in particles: density ratio x volume x particles per volume. */
static double ball_mass(const rheo_world_def *def)
{
    const double pi = 3.14159265358979323846;
    double spacing = def->fluid.spacing, radius = def->ball.radius;
    double particles_per_volume =
        def->fluid.number_density > 0 ? def->fluid.number_density : 1 / (spacing * spacing * spacing);
    return def->ball.density_ratio * (4.0 / 3.0 * pi * radius * radius * radius) * particles_per_volume;
}

void rheo__solids_configure(rheo__solids *solids, const rheo_world_def *def)
{
    solids->step = (rheo_real)def->step;
    for (int axis = 0; axis < 3; axis++)
        solids->gravity[axis] = (rheo_real)def->gravity[axis];

    solids->planes = def->walls.count;
    for (uint32_t w = 0; w < def->walls.count; w++) {
        const rheo_wall *wall = &def->walls.plane[w];
        rheo__plane *plane = &solids->plane[w];
        const double *n = wall->normal;
        double scale = 1 / __builtin_sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), offset = 0;
        for (int axis = 0; axis < 3; axis++) {
            plane->normal[axis] = (rheo_real)(n[axis] * scale);
            offset += n[axis] * scale * wall->point[axis];
        }
        plane->offset = (rheo_real)offset;
        /* Vibrators raise the first wall that is a level floor. */
        plane->vibrates = def->vibrators.count && def->vibrators.kind == RHEO_VIBRATOR_FLOOR && plane->normal[1] == 1;
        for (uint32_t before = 0; before < w; before++)
            if (solids->plane[before].vibrates)
                plane->vibrates = false;
    }
    /* Melting fluid is held off walls by its pressure: what reaches them has passed through. */
    solids->reach = (rheo_real)(def->model == RHEO_MODEL_MELTING ? 0 : def->fluid.spacing / 2);
    solids->tiny = (rheo_real)(def->fluid.spacing / (1 << 20));
    solids->sticking = (rheo_real)def->walls.sticking;

    solids->radius = (rheo_real)def->ball.radius;
    solids->mass = (rheo_real)ball_mass(def);
    solids->friction = (rheo_real)def->ball.friction;

    solids->kind = def->vibrators.kind;
    solids->amplitude = (rheo_real)def->vibrators.amplitude;
    solids->frequency = (rheo_real)def->vibrators.frequency;
    solids->spread = (rheo_real)def->vibrators.spread;
    solids->wander = (rheo_real)def->vibrators.wander;
    solids->vibrator_radius = (rheo_real)def->vibrators.radius;
    solids->height = (rheo_real)def->vibrators.height;
}

void rheo__solids_vibrators_moved(rheo__solids *solids, const rheo__state *s)
{
    /* The vibrators over one point are all within two radii of each of them. */
    uint32_t most = 0;
    rheo_real limit = 4 * solids->vibrator_radius * solids->vibrator_radius;
    for (uint32_t a = 0; a < s->vibrators; a++) {
        uint32_t near = 0;
        for (uint32_t b = 0; b < s->vibrators; b++) {
            rheo_real dx = s->vibrator_position[2 * a] - s->vibrator_position[2 * b];
            rheo_real dz = s->vibrator_position[2 * a + 1] - s->vibrator_position[2 * b + 1];
            near += dx * dx + dz * dz <= limit;
        }
        most = near > most ? near : most;
    }
    solids->largest_bump = solids->amplitude * (rheo_real)most;
}

bool rheo__solids_reserve(rheo__solids *solids, uint32_t particles)
{
    void *touching = solids->touching;
    if (solids->radius > 0 && !rheo__grow(&solids->allocator, &touching, &solids->touching_capacity,
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
