/*
 * The health of a run while it is made: the severe measures of the doctor (world/measure.h), from the metrics of the
 * present step and the one before.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/error.h"
#include "rheolog/record.h"
#include "world/measure.h"

struct rheo_health {
    const rheo_world *world;
    const rheo__measures *measures;
    rheo__metric_name *names;
    double *now, *before;
    uint32_t count, particles;
    bool started; /* a state was examined: `now` is that of the last one */
    bool ill_start, unhealthy;
    rheo_finding start, first;
};

static int64_t id_at(const rheo__observation *o, const char *metric)
{
    const int index = metric ? rheo__metric_index(o->names, o->count, metric) : -1;
    return index >= 0 && o->now[index] >= 0 && o->now[index] <= (double)UINT32_MAX ? (int64_t)o->now[index] : -1;
}

/* Whether a measure has a value in this step that is out of range. NaN is. */
static bool out_of_range(const rheo__observation *o, const rheo__measure *row, double *value)
{
    const int column = rheo__metric_index(o->names, o->count, row->name);
    if (column < 0 && !row->value)
        return false;
    if (column >= 0)
        *value = o->now[column];
    return (!row->value || row->value(o, value)) && !(*value <= row->limit);
}

static rheo_finding finding_of(const rheo__observation *o, const rheo__measure *row, uint64_t step, double value)
{
    return (rheo_finding){.measure = row->name,
                          .stage = row->stage,
                          .meaning = row->meaning,
                          .limit = row->limit,
                          .step = step,
                          .value = value,
                          .id = id_at(o, row->id),
                          .other_id = id_at(o, row->other_id),
                          .peak_step = step,
                          .peak = value,
                          .steps = 1,
                          .severe = row->kind == RHEO__SEVERE};
}

/* The first state has no step that led to it. What counts there occurs in steps that lead up to a failure, too. */
static bool makes_start_ill(const rheo__measure *row)
{
    return row->kind == RHEO__SEVERE || row->kind == RHEO__PRECURSOR || strcmp(row->name, "courant_number") == 0;
}

bool rheo_health_step(rheo_health *h, rheo_finding *finding)
{
    const rheo_world *world = h->world;
    const uint32_t particles = rheo_world_particle_count(world);
    double *now = h->before;
    h->before = h->now;
    h->now = now;
    for (uint32_t i = 0; i < h->count; i++)
        now[i] = rheo_world_metric(world, i);
    const rheo__observation o = {.def = &world->def,
                                 .features = world->features,
                                 .names = h->names,
                                 .now = now,
                                 .before = h->started ? h->before : NULL,
                                 .count = h->count,
                                 .added = h->started && particles != h->particles};
    for (uint32_t m = 0; m < h->measures->count; m++) {
        const rheo__measure *row = &h->measures->row[m];
        double value = 0;
        const bool begins = !h->started && !h->ill_start && makes_start_ill(row),
                   ends = !h->unhealthy && row->kind == RHEO__SEVERE;
        if ((!begins && !ends) || !out_of_range(&o, row, &value))
            continue;
        const rheo_finding f = finding_of(&o, row, rheo_world_step_count(world), value);
        if (begins) {
            h->ill_start = true;
            h->start = f;
        }
        if (ends) {
            h->unhealthy = true;
            h->first = f;
        }
    }
    h->started = true;
    h->particles = particles;
    if (h->unhealthy && finding)
        *finding = h->first;
    return h->unhealthy;
}

bool rheo_health_start(const rheo_health *h, rheo_finding *finding)
{
    if (h->ill_start && finding)
        *finding = h->start;
    return h->ill_start;
}

rheo_result rheo_health_open(const rheo_world *world, rheo_health **health, rheo_error *error)
{
    rheo_health *h = calloc(1, sizeof *h);
    *health = h;
    if (h) {
        h->world = world;
        h->measures = rheo__measures_of(&world->def);
        h->count = rheo_world_metric_count(world);
        h->names = calloc(h->count + (size_t)1, sizeof *h->names);
        h->now = calloc(h->count + (size_t)1, sizeof *h->now);
        h->before = calloc(h->count + (size_t)1, sizeof *h->before);
    }
    if (!h || !h->names || !h->now || !h->before) {
        rheo_health_close(h);
        *health = NULL;
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to examine the steps of a run");
    }
    for (uint32_t i = 0; i < h->count; i++)
        snprintf(h->names[i].text, sizeof h->names[i].text, "%s", rheo_world_metric_name(world, i));
    rheo_health_step(h, NULL);
    return RHEO_OK;
}

void rheo_health_close(rheo_health *h)
{
    if (!h)
        return;
    free(h->names);
    free(h->now);
    free(h->before);
    free(h);
}
