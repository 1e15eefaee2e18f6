/*
 * Settling before step 0, without ball, vibrators, emitters and history, and with plates and obstacles at rest. Its steps are examined like those of a run, because the
 * state that it leaves is the first that a recording has: what went wrong before shows there no more.
 */
#include <stdio.h>
#include <string.h>

#include "core/progress.h"
#include "core/strict.h"
#include "core/text.h"
#include "scenes/making.h"
#include "world/examination.h"

/* The advice of a measure for the settling that it says blew up. */
static void advise_as_measured(const rheo__examination *x, const rheo_world_def *def, rheo_diagnosis *diagnosis)
{
    const uint32_t first = rheo__measure_index(x->measures, x->first.measure);
    const rheo__measure *row = &x->measures->row[first];
    double episode[RHEO_MAX_FINDINGS] = {0};
    episode[first] = x->first.value;
    diagnosis->cause = x->first;
    rheo__case c = {.diagnosis = diagnosis,
                    .def = def,
                    .names = x->names,
                    .largest = x->observation.now,
                    .count = x->observation.count,
                    .measures = x->measures,
                    .episode = episode};
    if (row->advise)
        row->advise(&c);
    else
        x->measures->advise(&c);
}

/* What is likely to help: the advice for a condition out of range, or else for the first severe measure. */
static void advise(const rheo__examination *x, const rheo_scene *scene, const rheo_world_def *def, char *text,
                   size_t size)
{
    rheo__condition condition;
    for (uint32_t row = 0; row < x->measures->count; row++)
        if (rheo__condition_of_scene(scene, def, (rheo__known_speeds){0}, row, &condition) &&
            condition.advice_count) {
            snprintf(text, size, "%s (%.150s)", condition.advice[0].set, condition.advice[0].text);
            return;
        }
    rheo_diagnosis diagnosis;
    memset(&diagnosis, 0, sizeof diagnosis);
    advise_as_measured(x, def, &diagnosis);
    for (uint32_t i = 0; i < diagnosis.advice_count; i++)
        if (rheo__scene_bears(scene, diagnosis.advice[i].set)) {
            snprintf(text, size, "%s (%.150s)", diagnosis.advice[i].set, diagnosis.advice[i].text);
            return;
        }
    snprintf(text, size, "other parameters");
}

static void warn(const rheo__examination *x, const rheo_scene *scene, const rheo_world_def *def, rheo_world *world,
                 rheo__warnings *warnings)
{
    rheo__world_measure_commands(world); /* the damping of the last step is a change from outside */
    const uint32_t row = rheo__measure_index(x->measures, "courant_number");
    const double limit = row < x->measures->count ? x->measures->row[row].limit : 0.5,
                 speed = world->metrics.max_speed, way = speed * def->step / rheo__def_support(def);
    rheo_warning warning = rheo__warning_of(RHEO_WARNING_SETTLING);
    warning.value = way;
    warning.limit = limit;
    if (!x->severe && !(way > limit))
        return; /* what was thrown about has come to rest */
    char text[256], finding[256], time[32], fastest[32], moved[32], neighbours[32];
    rheo__text_brief(speed, 3, false, fastest);
    rheo__text_brief(way, 3, false, moved);
    if (!x->unhealthy) {
        rheo__text_brief(2 * scene->settle.time, 2, false, time);
        rheo__warn(
            warnings, warning,
            "the fluid has not settled before step 0: its largest speed is %s, %s supports per step; let it settle "
            "longer, settle.time=%s, or with more damping",
            fastest, moved, time);
        return;
    }
    advise(x, scene, def, text, sizeof text);
    rheo_finding_text(&x->first, finding, sizeof finding);
    rheo__warn(
        warnings, warning,
        "settling blew up before step 0, from its step %llu on (%s is %s): the largest speed is now %s, %s supports "
        "per step, with %s neighbours; make the scene again with %s",
        (unsigned long long)x->first.step, x->first.measure, finding, fastest, moved,
        rheo__text_brief(rheo_world_mean_neighbours(world), 3, false, neighbours), text);
}

static rheo_result run(const rheo_scene *scene, const rheo_world_def *def, rheo_world *world, rheo__examination *x,
                       rheo_error *error)
{
    const uint64_t steps = (uint64_t)(scene->settle.time / def->step + 0.5),
                   damped = (uint64_t)(scene->settle.fraction * (double)steps + 0.5);
    const rheo_real damping = 1 / (1 + (rheo_real)(scene->settle.damping * def->step));
    if (def->log.message && steps) {
        char text[96];
        snprintf(text, sizeof text, "settling %u particle%s for %llu step%s", def->particles.count,
                 rheo__plural(def->particles.count), (unsigned long long)steps, rheo__plural(steps));
        def->log.message(text, def->log.user);
    }
    for (uint64_t i = 0; i < steps; i++) {
        rheo_error inner;
        const rheo_result result = rheo_world_step(world, &inner);
        if (result != RHEO_OK)
            return rheo__fail(error, result, "while settling: %.480s", inner.message);
        rheo__examine_world(x, world);
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
    still.balls.count = 0;
    still.vibrators.count = 0;
    still.emitters.count = 0;
    still.plates.control = RHEO_PLATES_VELOCITY; /* the plates rest */
    still.plates.velocity[0] = still.plates.velocity[1] = still.plates.velocity[2] = 0;
    still.plates.amplitude = still.plates.frequency = 0;
    for (uint32_t k = 0; k < still.obstacles.count; k++) {
        rheo_obstacle *o = &still.obstacles.list[k];
        for (int axis = 0; axis < 3; axis++)
            o->velocity[axis] = o->spin[axis] = o->amplitude[axis] = 0;
    }
    still.history.stiffness = 0;
    still.springs.yield_ratio = 0; /* springs at rest carry no stress */
    for (uint32_t k = 0; k < still.materials.count; k++)
        still.materials.list[k].history.stiffness = still.materials.list[k].springs.yield_ratio =
            -1; /* as the main one */
    still.log = (rheo_log){NULL, NULL};
    rheo__examination x;
    RHEO__TRY(rheo__def_check_particles(&still, error)); /* all else was checked earlier, before filling */
    RHEO__TRY(rheo__world_make(&still, rheo__world_features(&still), settled, error));
    const rheo_allocator *allocator = &(*settled)->def.allocator;
    rheo_result result = rheo__examination_begin_world(&x, allocator, *settled)
                             ? run(scene, def, *settled, &x, error)
                             : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to examine the settling");
    if (result == RHEO_OK)
        warn(&x, scene, &still, *settled, warnings);
    rheo__examination_end(&x);
    return result;
}
