/*
 * Settling before step 0, without ball, vibrators and history. Its steps are examined like those of a run, because the
 * state that it leaves is the first that a recording has: what went wrong before shows there no more.
 */
#include <stdio.h>
#include <string.h>

#include "core/progress.h"
#include "core/strict.h"
#include "core/text.h"
#include "scenes/making.h"
#include "world/measure.h"

/* The severe measures of the steps so far. */
typedef struct watch {
    const rheo__measures *measures;
    rheo__metric_name *names;
    double *now, *before;
    uint32_t count;
    const rheo__measure *first; /* the first that left its range, or NULL */
    double value;
    uint64_t step;
    bool ill; /* one is out of range in the last step */
} watch;

static bool watch_begin(watch *w, const rheo_world *world)
{
    const rheo_allocator *allocator = &world->def.allocator;
    *w = (watch){.measures = rheo__measures_of(&world->def), .count = rheo_world_metric_count(world)};
    w->names = rheo__allocate(allocator, w->count, sizeof *w->names);
    w->now = rheo__allocate(allocator, 2 * (size_t)w->count, sizeof *w->now);
    w->before = w->now ? w->now + w->count : NULL;
    for (uint32_t i = 0; w->names && i < w->count; i++)
        snprintf(w->names[i].text, sizeof w->names[i].text, "%s", rheo_world_metric_name(world, i));
    return w->names && w->now;
}

static void watch_end(watch *w, const rheo_world *world)
{
    rheo__release(&world->def.allocator, w->names);
    rheo__release(&world->def.allocator, w->now < w->before ? w->now : w->before);
}

static void watch_step(watch *w, const rheo_world *world, uint64_t step)
{
    double *last = w->before;
    w->before = w->now;
    w->now = last;
    for (uint32_t i = 0; i < w->count; i++)
        w->now[i] = rheo_world_metric(world, i);
    const rheo__observation o = {.def = &world->def,
                                 .features = world->features,
                                 .names = w->names,
                                 .now = w->now,
                                 .before = step > 1 ? w->before : NULL,
                                 .count = w->count};
    w->ill = false;
    for (uint32_t m = 0; m < w->measures->count; m++) {
        const rheo__measure *row = &w->measures->row[m];
        double value;
        if (row->kind != RHEO__SEVERE ||
            !(row->value ? row->value(&o, &value) : rheo__observed(&o, row->name, &value)) || value <= row->limit)
            continue;
        w->ill = true;
        if (!w->first) {
            w->first = row;
            w->value = value;
            w->step = step;
        }
    }
}

/* Parameters of which one is likely to help: the advice for a condition out of range, or else half the step. */
static void advise(const rheo_world_def *def, char *text, size_t size)
{
    char number[32];
    rheo__condition condition;
    for (uint32_t row = 0; row < rheo__measures_of(def)->count; row++)
        if (rheo__condition_of(def, 0, row, &condition) && condition.advice.set[0]) {
            snprintf(text, size, "%s (%.150s)", condition.advice.set, condition.advice.text);
            return;
        }
    snprintf(text, size, "step=%s, or a softer fluid.stiffness", rheo__text_brief(def->step / 2, 2, true, number));
}

static void warn(const watch *w, const rheo_scene *scene, const rheo_world_def *def, rheo_world *world,
                 rheo__warnings *warnings)
{
    rheo__world_measure_commands(world); /* the damping of the last step is a change from outside */
    const uint32_t row = rheo__measure_index(w->measures, "courant_number");
    const double limit = row < w->measures->count ? w->measures->row[row].limit : 0.5,
                 speed = world->metrics.max_speed, way = speed * def->step / rheo__def_support(def);
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_SETTLING);
    warning.value = way;
    warning.limit = limit;
    if (!w->ill && !(way > limit))
        return; /* what was thrown about has come to rest */
    char text[256], value[32], time[32];
    if (!w->first) {
        rheo__text_brief(2 * scene->settle.time, 2, false, time);
        rheo__warn(warnings, warning,
                   "the fluid has not settled before step 0: its largest speed is %.3g, %.3g supports a step; let it "
                   "settle longer, settle.time=%s, or with more damping",
                   speed, way, time);
        return;
    }
    advise(def, text, sizeof text);
    rheo__warn(
        warnings, warning,
        "settling blew up before step 0, from its step %llu on (%s is %s, more than %g): the largest speed is now "
        "%.3g, %.3g supports a step, with %.3g neighbours; make the scene again with %s",
        (unsigned long long)w->step, w->first->name, rheo__text_brief(w->value, 3, false, value), w->first->limit,
        speed, way, rheo_world_mean_neighbours(world), text);
}

static rheo_result run(const rheo_scene *scene, const rheo_world_def *def, rheo_world *world, watch *w,
                       rheo_error *error)
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
        watch_step(w, world, i + 1);
        RHEO__TRY(rheo__progress("settling", i + 1, steps, error));
        for (size_t k = 0; i < damped && k < 3 * (size_t)def->particles.count; k++)
            world->state.velocity[k] *= damping;
    }
    return RHEO_OK;
}

rheo_result rheo__settle(const rheo_scene *scene, const rheo_world_def *def, rheo__warnings *warnings,
                         rheo_world **settled, rheo_error *error)
{
    rheo_world_def still = *def;
    still.ball.radius = 0;
    still.vibrators.count = 0;
    still.history.stiffness = 0;
    still.springs.yield_ratio = 0; /* springs at rest carry no stress */
    still.log = (rheo_log){NULL, NULL};
    watch w = {0};
    RHEO__TRY(rheo__def_check_particles(&still, error)); /* all else was checked earlier, before filling */
    RHEO__TRY(rheo__world_make(&still, rheo__world_features(&still), settled, error));
    rheo_result result = watch_begin(&w, *settled)
                             ? run(scene, def, *settled, &w, error)
                             : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to examine the settling");
    if (result == RHEO_OK)
        warn(&w, scene, &still, *settled, warnings);
    watch_end(&w, *settled);
    return result;
}
