/*
 * The loop that runs the list of stages: the only place that knows about timing, hashing stage by stage, and failing.
 *
 * A step either happens or does not: the flat fields are remembered when it begins, springs are built beside the old
 * ones, and the ring of histories, which cannot be undone, turns last, after the state has been looked through.
 */
#define _POSIX_C_SOURCE 199309L
#include "world/world.h"

#include <time.h>

#include "core/environment.h"
#include "thickening/thickening.h"

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

uint32_t rheo_world_trace_count(const rheo_world *w)
{
    uint32_t count = 0;
    for (uint32_t stage = 0; stage < w->stage_count; stage++)
        for (uint32_t left = w->stage[stage].writes; left; left &= left - 1)
            count++;
    return count;
}

void rheo_world_trace_entry(const rheo_world *w, uint32_t index, uint32_t *stage, rheo_field_id *field)
{
    for (*stage = 0; *stage < w->stage_count; ++*stage)
        for (*field = 0; *field < RHEO_FIELD_COUNT; ++*field)
            if ((w->stage[*stage].writes >> *field & 1) && index-- == 0)
                return;
    *stage = 0;
    *field = 0;
}

#ifdef RHEO_CHECK_WRITES
/* The checking build: a stage that writes a field it does not declare is a bug of the library. */
static rheo_result check_writes(const rheo_world *w, uint32_t stage, uint64_t before[RHEO_FIELD_COUNT],
                                rheo_error *error)
{
    for (rheo_field_id f = 0; f < RHEO_FIELD_COUNT; f++) {
        if (!rheo_state_has(&w->state, f))
            continue;
        uint64_t hash = rheo_state_hash_field(&w->state, f);
        if (stage < w->stage_count && hash != before[f] && !(w->stage[stage].writes >> f & 1))
            return rheo_fail(error, RHEO_ERROR_STATE, "stage %s wrote the field %s, which it does not declare",
                             w->stage[stage].name, rheo_field_table[f].name);
        before[f] = hash;
    }
    return RHEO_OK;
}
#endif

static rheo_result check_finite(const rheo_world *w, rheo_error *error)
{
    static const char *const ITEM[] = {"the world", "particle", "spring", "body", "source"};
    rheo_field_id field;
    uint64_t item;
    uint32_t component;
    if (rheo_state_finite(&w->state, &field, &item, &component))
        return RHEO_OK;
    return rheo_fail(error, RHEO_ERROR_STATE,
                     "step %llu went bad: %s of %s %llu is not finite (component %u); the world stays at step %llu. "
                     "A smaller step or softer springs (stiffness_number was %g) may help",
                     (unsigned long long)*w->state.step + 1, rheo_field_table[field].name,
                     ITEM[rheo_field_table[field].per], (unsigned long long)item, component,
                     (unsigned long long)*w->state.step, w->metrics.stiffness_number);
}

static rheo_result run_stages(rheo_world *w, uint64_t *hashes, rheo_error *error)
{
    rheo_state *s = &w->state;
    bool looked = false;
#ifdef RHEO_CHECK_WRITES
    uint64_t before[RHEO_FIELD_COUNT];
    check_writes(w, w->stage_count, before, NULL);
#endif
    double start = now();
    for (uint32_t i = 0; i < w->stage_count; i++) {
        const rheo_stage *stage = &w->stage[i];
        if (stage->writes & RHEO_BIT(history_velocity)) {
            RHEO_TRY(check_finite(w, error));
            looked = true;
        }
        if (stage->run(s, stage->context) != RHEO_OK)
            return rheo_fail(error, RHEO_ERROR_MEMORY,
                             "no memory in stage %s of step %llu; the world stays as it was", stage->name,
                             (unsigned long long)*s->step + 1);
        double end = now();
        w->stage_seconds[i] += end - start;
        if (hashes)
            for (rheo_field_id f = 0; f < RHEO_FIELD_COUNT; f++)
                if (stage->writes >> f & 1)
                    *hashes++ = rheo_state_hash_newest(s, f);
#ifdef RHEO_CHECK_WRITES
        RHEO_TRY(check_writes(w, i, before, error));
#endif
        start = hashes ? now() : end;
    }
    return looked ? RHEO_OK : check_finite(w, error);
}

rheo_result rheo_world_step_traced(rheo_world *w, uint64_t *hashes, rheo_error *error)
{
    RHEO_TRY(rheo_check_environment(error));
    rheo_state *s = &w->state;
    rheo_state_begin(s);
    rheo_result result = run_stages(w, hashes, error);
    if (result != RHEO_OK) {
        rheo_state_undo(s);
        return result;
    }
    ++*s->step;
    w->steps_timed++;
    rheo_world_measure(w);
    rheo_world_forget_commands(w);
    return RHEO_OK;
}

rheo_result rheo_world_step(rheo_world *world, rheo_error *error)
{
    return rheo_world_step_traced(world, NULL, error);
}

void rheo_world_measure(rheo_world *w)
{
    const rheo_state *s = &w->state;
    double energy = 0, fastest = 0, centre[3] = {0, 0, 0};
    for (uint32_t i = 0; i < s->particles; i++) {
        const rheo_real *v = s->velocity + 3 * (size_t)i, *x = s->position + 3 * (size_t)i;
        double vx = (double)v[0], vy = (double)v[1], vz = (double)v[2];
        double speed2 = vx * vx + vy * vy + vz * vz;
        energy += speed2;
        fastest = speed2 > fastest ? speed2 : fastest;
        centre[0] += (double)x[0];
        centre[1] += (double)x[1];
        centre[2] += (double)x[2];
    }
    w->metrics.kinetic_energy = 0.5 * energy;
    w->metrics.max_speed = __builtin_sqrt(fastest);
    for (int axis = 0; axis < 3; axis++)
        w->metrics.centre[axis] = s->particles ? centre[axis] / s->particles : 0;
    w->metrics.stiffness_number = w->thickening->stiffness_number;
    w->metrics.stiffness_sum = w->thickening->largest_stiffness_sum;
    w->metrics.neighbours = w->thickening->mean_neighbours;
}
