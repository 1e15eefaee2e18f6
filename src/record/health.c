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
    x->observation.unfinished = x->started && h->world->failed;
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

double rheo_health_metric(const rheo_health *h, uint32_t index)
{
    const rheo__observation *o = &h->examination.observation;
    return index < o->count ? o->now[index] : __builtin_nan("");
}

bool rheo_health_measure(const rheo_health *h, uint32_t index, rheo_measure *measure)
{
    static const char *const KINDS[] = {[RHEO__NOTICE] = "notice",
                                        [RHEO__PRECURSOR] = "precursor",
                                        [RHEO__SEVERE] = "severe",
                                        [RHEO__CONDITION] = "condition"};
    const rheo__examination *x = &h->examination;
    if (index >= x->measures->count)
        return false;
    const rheo__measure *row = &x->measures->row[index];
    *measure = (rheo_measure){.name = row->name,
                              .meaning = row->meaning,
                              .kind = KINDS[row->kind],
                              .limit = row->limit,
                              .certain = row->kind == RHEO__CONDITION ? row->certain : __builtin_nan(""),
                              .measured = x->measured[index],
                              .value = x->value[index]};
    return true;
}

void rheo_health_close(rheo_health *h)
{
    if (!h)
        return;
    if (h->examination.measures)
        rheo__examination_end(&h->examination);
    free(h);
}
