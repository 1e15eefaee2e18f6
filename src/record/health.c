/* The health of a run while it is made: the examination of its steps (world/examination.h). */
#include <stdlib.h>

#include "rheolog/record.h"
#include "world/examination.h"

struct rheo_health {
    const rheo_world *world;
    rheo__examination examination;
};

bool rheo_health_step(rheo_health *h, rheo_finding *finding)
{
    rheo__examination *x = &h->examination;
    x->observation.begins = !x->started;
    rheo__examine_world(x, h->world);
    if (x->unhealthy && finding)
        *finding = x->first;
    return x->unhealthy;
}

bool rheo_health_start(const rheo_health *h, rheo_finding *finding)
{
    if (h->examination.ill_start && finding)
        *finding = h->examination.start;
    return h->examination.ill_start;
}

rheo_result rheo_health_open(const rheo_world *world, rheo_health **health, rheo_error *error)
{
    const rheo_allocator allocator = rheo__allocator_or_default((rheo_allocator){0});
    rheo_health *h = calloc(1, sizeof *h);
    *health = NULL;
    if (h && rheo__examination_begin_world(&h->examination, &allocator, world)) {
        h->world = world;
        rheo_health_step(h, NULL);
        *health = h;
        return RHEO_OK;
    }
    rheo_health_close(h);
    return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to examine the steps of a run");
}

void rheo_health_close(rheo_health *h)
{
    if (!h)
        return;
    if (h->examination.measures)
        rheo__examination_end(&h->examination);
    free(h);
}
