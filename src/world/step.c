/*
 * The loop that runs the list of stages: the only place that knows about timing, hashing stage by stage, and failing.
 *
 * A step either happens or does not: the flat fields are remembered when it begins, springs are built beside the old
 * ones, and the memory of velocities, which cannot be undone, goes on last, after the state has been looked through.
 * Looking through it after every stage would cost too much; a step that fails is made again to find the stage.
 */
#define _POSIX_C_SOURCE 199309L
#include "world/world.h"

#include <stdio.h>
#include <string.h>
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
    return rheo_world_trace_start(w, w->stage_count);
}

uint32_t rheo_world_trace_start(const rheo_world *w, uint32_t stage)
{
    uint32_t start = 0;
    for (uint32_t before = 0; before < stage; before++)
        start += (uint32_t)__builtin_popcount(w->stage[before].writes);
    return start;
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

rheo_result rheo_world_check_between_steps(const rheo_world *w, const char *cannot, rheo_error *error)
{
    if (w->stages_done == 0)
        return RHEO_OK;
    return rheo_fail(error, RHEO_ERROR_ARGUMENT,
                     "in the middle of step %llu, after stage %s, a world %s; finish the step",
                     (unsigned long long)*w->state.step + 1, w->stage[w->stages_done - 1].name, cannot);
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

/* Looks for a number that is not one; *failure says where it is, without the stage. */
static bool is_finite(const rheo_world *w, rheo_failure *failure)
{
    rheo_field_id field;
    if (rheo_state_finite(&w->state, &field, &failure->id, &failure->component))
        return true;
    failure->step = *w->state.step + 1;
    failure->stage[0] = 0;
    failure->per = rheo_field_table[field].per;
    snprintf(failure->field, sizeof failure->field, "%s", rheo_field_table[field].name);
    return false;
}

#ifdef RHEO_SABOTAGE
void (*rheo_sabotage)(rheo_world *world, uint32_t stage);
#endif

static rheo_result run_stage(rheo_world *w, uint32_t index, rheo_error *error)
{
    const rheo_stage *stage = &w->stage[index];
    if (stage->run(&w->state, stage->context) != RHEO_OK)
        return rheo_fail(error, RHEO_ERROR_MEMORY, "no memory in stage %s of step %llu; the world stays as it was",
                         stage->name, (unsigned long long)*w->state.step + 1);
#ifdef RHEO_SABOTAGE
    if (rheo_sabotage)
        rheo_sabotage(w, index);
#endif
    return RHEO_OK;
}

static void begin(rheo_world *w)
{
    if (w->command_count)
        rheo_world_measure_commands(w);
    w->failed = false;
    w->failure = (rheo_failure){0};
    w->thickening->found_before = w->thickening->found;
    rheo_state_begin(&w->state);
}

static void undo(rheo_world *w)
{
    rheo_state_undo(&w->state);
    w->stages_done = 0;
}

static void finish(rheo_world *w)
{
    ++*w->state.step;
    w->stages_done = 0;
    w->steps_timed++;
    rheo_world_measure_step(w);
    rheo_world_forget_commands(w);
}

/* Gives up a step that went bad; w->failure says where. */
static rheo_result fail(rheo_world *w, rheo_error *error)
{
    static const char *const ITEM[] = {"the world", "particle", "spring", "body", "source"};
    const rheo_failure *f = &w->failure;
    const rheo_metrics *m = &w->failed_metrics;
    char signs[160] = "";
    undo(w);
    w->failed = true;
    rheo_world_measure_failure(w);
    int length = 0;
    if (m->stiffness_a >= 0)
        length = snprintf(signs, sizeof signs, " The stiffness number was %.3g (spring %.0f:%.0f).",
                          m->stiffness_number, m->stiffness_a, m->stiffness_b);
    if (m->max_density_id >= 0)
        snprintf(signs + length, sizeof signs - (size_t)length,
                 " The largest density was %.3g times that at rest (particle %.0f).", m->max_density,
                 m->max_density_id);
    return rheo_fail(
        error, RHEO_ERROR_STATE,
        "step %llu went bad: after stage %s %s of %s %llu is not finite (component %u); the world stays at "
        "step %llu.%s A smaller step may help%s",
        (unsigned long long)f->step, f->stage[0] ? f->stage : "(none)", f->field, ITEM[f->per],
        (unsigned long long)f->id, f->component, (unsigned long long)*w->state.step, signs,
        m->stiffness_number > 1 ? ", or softer springs, or springs.solver implicit" : "");
}

/* Makes a step that went bad again, looking after every stage, to find the one that did it. */
static void find_bad_stage(rheo_world *w)
{
    rheo_state_undo(&w->state);
    rheo_state_begin(&w->state);
    w->thickening->found = w->thickening->found_before; /* stages that are not reached have found nothing new */
    rheo_failure failure;
    bool finite = is_finite(w, &failure);
    for (uint32_t i = 0; finite && i < w->stage_count; i++) {
        if (run_stage(w, i, NULL) != RHEO_OK)
            return;
        finite = is_finite(w, &failure);
        if (!finite)
            snprintf(failure.stage, sizeof failure.stage, "%s", w->stage[i].name);
    }
    if (!finite)
        w->failure = failure;
}

/*
 * Runs the stages that are left. With hashes they are written there; with expected as well, the stage after which one
 * is not as expected is the last that runs.
 */
static rheo_result run_stages(rheo_world *w, uint64_t *hashes, const uint64_t *expected, rheo_error *error)
{
    bool looked = false, differs = false;
#ifdef RHEO_CHECK_WRITES
    uint64_t before[RHEO_FIELD_COUNT];
    check_writes(w, w->stage_count, before, NULL);
#endif
    double start = now();
    for (; w->stages_done < w->stage_count && !differs; w->stages_done++) {
        const rheo_stage *stage = &w->stage[w->stages_done];
        if (stage->writes & (RHEO_BIT(history_velocity) | RHEO_BIT(history_modes))) {
            if (!is_finite(w, &w->failure))
                return RHEO_ERROR_STATE;
            looked = true;
        }
        RHEO_TRY(run_stage(w, w->stages_done, error));
        double end = now();
        w->stage_seconds[w->stages_done] += end - start;
        if (hashes) {
            size_t count = (size_t)__builtin_popcount(stage->writes);
            rheo_state_hash_newest(&w->state, stage->writes, hashes);
            if (expected) {
                differs = memcmp(hashes, expected, count * sizeof *hashes) != 0;
                expected += count;
            }
            hashes += count;
        }
#ifdef RHEO_CHECK_WRITES
        RHEO_TRY(check_writes(w, w->stages_done, before, error));
#endif
        start = hashes ? now() : end;
    }
    return looked || differs || is_finite(w, &w->failure) ? RHEO_OK : RHEO_ERROR_STATE;
}

rheo_result rheo_world_step_traced(rheo_world *w, uint64_t *hashes, const uint64_t *expected, rheo_error *error)
{
    RHEO_TRY(rheo_check_environment(error));
    if (w->stages_done == 0)
        begin(w);
    rheo_result result = run_stages(w, hashes, expected, error);
    if (result == RHEO_OK) {
        if (w->stages_done == w->stage_count)
            finish(w);
    } else if (result == RHEO_ERROR_STATE && w->failure.step) {
        find_bad_stage(w);
        return fail(w, error);
    } else {
        undo(w);
    }
    return result;
}

rheo_result rheo_world_step(rheo_world *world, rheo_error *error)
{
    return rheo_world_step_traced(world, NULL, NULL, error);
}

rheo_result rheo_world_step_stage(rheo_world *w, uint32_t *stage, rheo_error *error)
{
    RHEO_TRY(rheo_check_environment(error));
    if (w->stages_done == 0)
        begin(w);
    *stage = w->stages_done;
    rheo_result result = run_stage(w, *stage, error);
    if (result != RHEO_OK) {
        undo(w);
        return result;
    }
    if (!is_finite(w, &w->failure)) {
        snprintf(w->failure.stage, sizeof w->failure.stage, "%s", w->stage[*stage].name);
        return fail(w, error);
    }
    if (++w->stages_done == w->stage_count)
        finish(w);
    return RHEO_OK;
}
