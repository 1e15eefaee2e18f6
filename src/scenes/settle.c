/* Settling before step 0, without ball, vibrators and history. */
#include <stdio.h>

#include "core/strict.h"
#include "scenes/making.h"

static rheo_result run(const rheo_scene *scene, const rheo_world_def *def, rheo_world *world, rheo_error *error)
{
    const uint64_t steps = (uint64_t)(scene->settle.time / def->step + 0.5),
                   damped = (uint64_t)(scene->settle.fraction * (double)steps + 0.5);
    const rheo_real damping = 1 / (1 + (rheo_real)(scene->settle.damping * def->step));
    if (def->log.message && steps) {
        char text[96];
        snprintf(text, sizeof text, "settling %u particles for %llu steps", def->particles.count,
                 (unsigned long long)steps);
        def->log.message(text, def->log.user);
    }
    for (uint64_t i = 0; i < steps; i++) {
        rheo_error inner;
        const rheo_result result = rheo_world_step(world, &inner);
        if (result != RHEO_OK)
            return rheo__fail(error, result, "while settling: %.480s", inner.message);
        for (size_t k = 0; i < damped && k < 3 * (size_t)def->particles.count; k++)
            world->state.velocity[k] *= damping;
    }
    return RHEO_OK;
}

rheo_result rheo__settle(const rheo_scene *scene, const rheo_world_def *def, rheo_world **settled, rheo_error *error)
{
    rheo_world_def still = *def;
    still.ball.radius = 0;
    still.vibrators.count = 0;
    still.history.stiffness = 0;
    still.springs.yield_ratio = 0; /* springs at rest carry no stress */
    still.log = (rheo_log){NULL, NULL};
    RHEO__TRY(rheo__def_check_particles(&still, error)); /* all else was checked earlier, before filling */
    RHEO__TRY(rheo__world_make(&still, rheo__world_features(&still), settled, error));
    return run(scene, def, *settled, error);
}
