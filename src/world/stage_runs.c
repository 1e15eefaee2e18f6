/* Stage runs of a step, their names, and the hashes that are taken after each (world/stage_runs.h). */
#include "world/stage_runs.h"

#include <assert.h>
#include <stdio.h>

/* ---- Stage runs ---- */

rheo__phase rheo__world_phase(const rheo_world *w, uint32_t stage)
{
    return stage < w->substeps_begin ? RHEO__BEFORE_SUBSTEPS
           : stage < w->substeps_end ? RHEO__IN_SUBSTEPS
                                     : RHEO__AFTER_SUBSTEPS;
}

uint64_t rheo__world_substeps(const rheo_world *w)
{
    return w->substeps_begin < w->substeps_end ? *w->state.substeps : 1;
}

uint64_t rheo__world_stage_runs(const rheo_world *w, uint64_t substeps)
{
    return w->substeps_begin + (w->substeps_end - w->substeps_begin) * substeps + (w->stage_count - w->substeps_end);
}

uint64_t rheo__world_stage_runs_in_step(const rheo_world *w)
{
    return rheo__world_stage_runs(w, w->stage_runs_done < w->substeps_begin ? 1 : rheo__world_substeps(w));
}

/* Stage of a stage run; its substep from 1, or 0. */
static uint32_t locate(const rheo_world *w, uint64_t stage_run, uint64_t *substep)
{
    *substep = 0;
    if (stage_run < w->substeps_begin)
        return (uint32_t)stage_run;
    const uint64_t stages = w->substeps_end - w->substeps_begin, in_substeps = stages * rheo__world_substeps(w),
                   run = stage_run - w->substeps_begin;
    if (run >= in_substeps)
        return w->substeps_end + (uint32_t)(run - in_substeps);
    *substep = run / stages + 1;
    return w->substeps_begin + (uint32_t)(run % stages);
}

uint32_t rheo__world_stage_of(const rheo_world *w, uint64_t stage_run)
{
    uint64_t substep;
    return locate(w, stage_run, &substep);
}

uint64_t rheo__world_substep_of(const rheo_world *w, uint64_t stage_run)
{
    uint64_t substep;
    locate(w, stage_run, &substep);
    return substep;
}

static void put_name(const rheo_world *w, uint32_t stage, uint64_t substep, char name[32])
{
    assert(stage < w->stage_count);
    if (substep)
        snprintf(name, 32, "%s@%llu", w->stage[stage].name, (unsigned long long)substep);
    else
        snprintf(name, 32, "%s", w->stage[stage].name);
}

void rheo__world_stage_run_name(const rheo_world *w, uint64_t stage_run, char name[32])
{
    uint64_t substep;
    const uint32_t stage = locate(w, stage_run, &substep);
    put_name(w, stage, substep, name);
}

bool rheo__world_begins_later_substep(const rheo_world *w, uint64_t stage_run)
{
    uint64_t substep;
    return locate(w, stage_run, &substep) == w->substeps_begin && substep > 1;
}

int rheo__world_compare_run(const rheo_world *w, uint64_t stage_run, uint32_t stage, uint64_t substep)
{
    uint64_t own_substep;
    const uint32_t own = locate(w, stage_run, &own_substep);
    if (own_substep && substep && own_substep != substep)
        return own_substep < substep ? -1 : 1;
    return (own > stage) - (own < stage);
}

/* ---- Hashes ---- */

/* Number of hashes of the stages from first to end - 1. */
static uint32_t traced(const rheo_world *w, uint32_t first, uint32_t end)
{
    uint32_t count = 0;
    for (uint32_t stage = first; stage < end; stage++)
        count += (uint32_t)__builtin_popcountll(w->stage[stage].writes);
    return count;
}

uint32_t rheo__world_trace_once(const rheo_world *w)
{
    return traced(w, 0, w->substeps_begin) + traced(w, w->substeps_end, w->stage_count);
}

uint32_t rheo__world_trace_repeated(const rheo_world *w)
{
    return traced(w, w->substeps_begin, w->substeps_end);
}

uint64_t rheo__world_trace_substeps(const rheo_world *w, size_t hashes)
{
    const uint32_t once = rheo__world_trace_once(w), repeated = rheo__world_trace_repeated(w);
    return repeated && hashes > once ? (hashes - once) / repeated : 1;
}

size_t rheo__world_trace_start(const rheo_world *w, uint64_t stage_run)
{
    uint64_t substep;
    const uint32_t stage = locate(w, stage_run, &substep);
    const rheo__phase phase = rheo__world_phase(w, stage);
    if (phase == RHEO__BEFORE_SUBSTEPS)
        return traced(w, 0, stage);
    const uint64_t substeps = phase == RHEO__IN_SUBSTEPS ? substep - 1 : rheo__world_substeps(w);
    return traced(w, 0, w->substeps_begin) + (size_t)substeps * rheo__world_trace_repeated(w) +
           traced(w, phase == RHEO__IN_SUBSTEPS ? w->substeps_begin : w->substeps_end, stage);
}

void rheo__world_trace_entry(const rheo_world *w, uint64_t substeps, size_t index, char name[32],
                             rheo__field_id *field)
{
    const uint32_t before = traced(w, 0, w->substeps_begin), repeated = rheo__world_trace_repeated(w);
    uint64_t substep = 0;
    uint32_t stage = 0;
    if (index >= before && repeated && (index - before) / repeated < substeps) {
        stage = w->substeps_begin;
        substep = (index - before) / repeated + 1;
        index = (index - before) % repeated;
    } else if (index >= before) {
        stage = w->substeps_end;
        index -= before + (size_t)substeps * repeated;
    }
    for (;; stage++)
        for (*field = 0; *field < RHEO__FIELD_COUNT; ++*field)
            if ((w->stage[stage].writes >> *field & 1) && index-- == 0) {
                put_name(w, stage, substep, name);
                return;
            }
}
