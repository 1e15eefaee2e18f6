/* Small runs of both models, and one that fails, for tests of recordings that are continued or limited. */
#ifndef RHEO__TESTS_RECORDED_RUNS_H
#define RHEO__TESTS_RECORDED_RUNS_H

#include "melting_support.h"
#include "record_support.h"

static inline rheo_world *small(void)
{
    return make_world(2);
}

static inline rheo_world *melt(void)
{
    rheo_world_def def = melt_def(0.25);
    fluid f = lattice(0.25, 3, 3, 3, 0);
    warm_by_height(&f, 0.75);
    return melt_of(def, f);
}

/* Makes the world infinite in the next step: a particle is added that is too fast. */
static inline void make_infinite(rheo_world *world)
{
    const rheo_real fastest = sizeof(rheo_real) == 4 ? (rheo_real)3e38 : (rheo_real)1e308;
    OK(rheo_world_add_particles(world, 1, (rheo_real[]){9, 9, 9}, (rheo_real[]){fastest, 0, 0}, &error));
    OK(rheo_world_set(world, "step", "1e6", &error));
}

#endif
