/* Examines the steps of a run by the measures of its world (world/examination.h). */
#include "world/examination.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

/* ---- Beginning ---- */

bool rheo__examination_begin(rheo__examination *x, const rheo_allocator *allocator, const rheo_world_def *def,
                             uint32_t features, uint32_t count)
{
    *x = (rheo__examination){.allocator = *allocator, .measures = rheo__measures_of(def)};
    assert(x->measures->count <= RHEO_MAX_FINDINGS);
    x->names = rheo__allocate(allocator, (size_t)count + 1, sizeof *x->names);
    x->values = rheo__allocate(allocator, 2 * (size_t)count + 1, sizeof *x->values);
    x->observation = (rheo__observation){.def = def, .features = features, .names = x->names, .count = count};
    return x->names && x->values;
}

void rheo__examination_end(rheo__examination *x)
{
    rheo__release(&x->allocator, x->names);
    rheo__release(&x->allocator, x->values);
}

static int column_of(const rheo__examination *x, const char *metric)
{
    return metric ? rheo__metric_index(x->names, x->observation.count, metric) : -1;
}

void rheo__examination_find_columns(rheo__examination *x)
{
    for (uint32_t m = 0; m < x->measures->count; m++) {
        const rheo__measure *row = &x->measures->row[m];
        x->column[m] = column_of(x, row->name);
        x->id_column[m] = column_of(x, row->id);
        x->other_column[m] = column_of(x, row->other_id);
    }
}

bool rheo__examination_begin_world(rheo__examination *x, const rheo_allocator *allocator, const rheo_world *world)
{
    const uint32_t count = rheo_world_metric_count(world);
    if (!rheo__examination_begin(x, allocator, &world->def, world->features, count))
        return false;
    for (uint32_t i = 0; i < count; i++)
        snprintf(x->names[i].text, sizeof x->names[i].text, "%s", rheo_world_metric_name(world, i));
    rheo__examination_find_columns(x);
    return true;
}

/* ---- Findings ---- */

static int64_t id_at(const rheo__examination *x, int column)
{
    const double id = column >= 0 ? x->observation.now[column] : -1;
    return id >= 0 && id <= (double)UINT32_MAX ? (int64_t)id : -1;
}

void rheo__finding_place(rheo_finding *finding, const rheo_finding *from)
{
    finding->id = from->id;
    finding->other_id = from->other_id;
    finding->seen = from->seen;
    finding->seen_step = from->seen_step;
    finding->seen_value = from->seen_value;
}

void rheo__examination_show(const rheo__examination *x, uint32_t measure, rheo_finding *finding)
{
    const rheo__measure *row = &x->measures->row[measure];
    const uint32_t seen = row->seen && !row->id ? rheo__measure_index(x->measures, row->seen) : measure;
    assert(seen < x->measures->count);
    const rheo_finding *last = &x->last[seen];
    if (last->steps > 0 && last->id >= 0)
        rheo__finding_place(finding, last);
}

rheo_finding rheo__examination_finding(const rheo__examination *x, uint32_t measure, double limit)
{
    const rheo__measure *row = &x->measures->row[measure];
    rheo_finding f = {.measure = row->name,
                      .stage = row->stage,
                      .meaning = row->meaning,
                      .limit = limit,
                      .step = x->step,
                      .value = x->value[measure],
                      .id = -1,
                      .other_id = -1,
                      .peak_step = x->step,
                      .peak = x->value[measure],
                      .steps = 1,
                      .severe = row->kind == RHEO__SEVERE,
                      .seen = ""};
    if (row->kind != RHEO__CONDITION) /* of a condition, only the cause is worth a particle */
        rheo__examination_show(x, measure, &f);
    return f;
}

/* ---- A step ---- */

/* False: the measure is not recorded, or has no meaning in this step. */
static bool measure(const rheo__examination *x, uint32_t m, double *value)
{
    const rheo__measure *row = &x->measures->row[m];
    const rheo__observation *o = &x->observation;
    const int column = x->column[m];
    if (column < 0)
        return row->value && row->value(o, value);
    *value = o->now[column];
    if (o->unfinished && memcmp(value, &o->before[column], sizeof *value) == 0) /* not reached by the failed step */
        return false;
    return !row->value || row->value(o, value);
}

static void note_last(rheo__examination *x, uint32_t m)
{
    const rheo__measure *row = &x->measures->row[m];
    rheo_finding *last = &x->last[m];
    const int seen = row->id && row->seen ? column_of(x, row->seen) : -1;
    *last = (rheo_finding){.measure = row->name,
                           .step = x->step,
                           .value = x->value[m],
                           .id = id_at(x, x->id_column[m]),
                           .other_id = id_at(x, x->other_column[m]),
                           .steps = 1,
                           .seen = seen < 0 ? row->name : row->seen,
                           .seen_step = x->step,
                           .seen_value = seen < 0 ? x->value[m] : x->observation.now[seen]};
}

static void note_finding(rheo__examination *x, uint32_t m)
{
    rheo_finding *f = &x->finding[m];
    const double value = x->value[m];
    if (f->steps == 0) {
        *f = rheo__examination_finding(x, m, x->measures->row[m].limit);
        return;
    }
    f->steps++;
    if (value > f->peak || f->peak != f->peak) {
        f->peak = value;
        f->peak_step = x->step;
    }
}

/* The first state has no step that led to it. What counts there occurs in steps that lead up to a failure, too. */
static void note_start(rheo__examination *x, uint32_t m)
{
    const rheo__measure *row = &x->measures->row[m];
    const bool severe = row->kind == RHEO__SEVERE;
    if (!severe && row->kind != RHEO__PRECURSOR && strcmp(row->name, "courant_number") != 0)
        return;
    if (!x->ill_start || (severe && !x->start.severe))
        x->start = x->finding[m];
    x->ill_start = true;
}

double *rheo__examination_next(rheo__examination *x)
{
    rheo__observation *o = &x->observation;
    double *other = o->now == x->values ? x->values + o->count : x->values;
    o->before = x->started ? o->now : NULL;
    o->now = other;
    return other;
}

void rheo__examine(rheo__examination *x, uint64_t step)
{
    x->step = step;
    x->severe = false;
    for (uint32_t m = 0; m < x->measures->count; m++) {
        x->measured[m] = measure(x, m, &x->value[m]);
        if (x->measured[m])
            note_last(x, m);
    }
    for (uint32_t m = 0; m < x->measures->count; m++) {
        const rheo__measure *row = &x->measures->row[m];
        if (!x->measured[m] || x->value[m] <= row->limit) /* NaN is out of range */
            continue;
        note_finding(x, m);
        if (!x->started)
            note_start(x, m);
        if (row->kind != RHEO__SEVERE)
            continue;
        if (!x->unhealthy)
            x->first = x->finding[m];
        x->severe = x->unhealthy = true;
    }
    x->started = true;
}

void rheo__examine_world(rheo__examination *x, const rheo_world *world)
{
    const uint32_t particles = rheo_world_particle_count(world);
    double *now = rheo__examination_next(x);
    for (uint32_t i = 0; i < x->observation.count; i++)
        now[i] = x->observation.unfinished ? rheo__world_failed_metric(world, i) : rheo_world_metric(world, i);
    x->observation.added = x->started && particles != x->particles;
    x->particles = particles;
    rheo__examine(x, rheo_world_step_count(world) + x->observation.unfinished);
}
