/* Stage runs of a step, their names, and the hashes that are taken after each (world/stage_runs.h). */
#include "world/stage_runs.h"

#include <assert.h>
#include <stdio.h>

uint32_t rheo__world_stage_of(const rheo_world *w, uint64_t stage_run)
{
    assert(stage_run < w->stages_before_substeps || w->stages_before_substeps < w->stage_count);
    if (stage_run < w->stages_before_substeps)
        return (uint32_t)stage_run;
    return w->stages_before_substeps +
           (uint32_t)((stage_run - w->stages_before_substeps) % (w->stage_count - w->stages_before_substeps));
}

uint64_t rheo__world_stage_runs(const rheo_world *w, uint64_t substeps)
{
    return w->stages_before_substeps + (w->stage_count - w->stages_before_substeps) * substeps;
}

void rheo__world_stage_run_name(const rheo_world *w, uint64_t stage_run, char name[32])
{
    const char *stage = w->stage[rheo__world_stage_of(w, stage_run)].name;
    if (stage_run < w->stages_before_substeps)
        snprintf(name, 32, "%s", stage);
    else
        snprintf(name, 32, "%s@%llu", stage,
                 (unsigned long long)((stage_run - w->stages_before_substeps) /
                                      (w->stage_count - w->stages_before_substeps)) +
                     1);
}

/* Number of hashes of the stages from first to end - 1. */
static uint32_t traced(const rheo_world *w, uint32_t first, uint32_t end)
{
    uint32_t count = 0;
    for (uint32_t stage = first; stage < end; stage++)
        count += (uint32_t)__builtin_popcount(w->stage[stage].writes);
    return count;
}

uint32_t rheo__world_trace_once(const rheo_world *w)
{
    return traced(w, 0, w->stages_before_substeps);
}

uint32_t rheo__world_trace_repeated(const rheo_world *w)
{
    return traced(w, w->stages_before_substeps, w->stage_count);
}

size_t rheo__world_trace_start(const rheo_world *w, uint64_t stage_run)
{
    if (stage_run <= w->stages_before_substeps)
        return traced(w, 0, (uint32_t)stage_run);
    const uint64_t substep = (stage_run - w->stages_before_substeps) / (w->stage_count - w->stages_before_substeps);
    return traced(w, 0, w->stages_before_substeps) + (size_t)substep * rheo__world_trace_repeated(w) +
           traced(w, w->stages_before_substeps, rheo__world_stage_of(w, stage_run));
}

void rheo__world_trace_entry(const rheo_world *w, size_t index, uint64_t *stage_run, rheo__field_id *field)
{
    const uint32_t once = rheo__world_trace_once(w), repeated = rheo__world_trace_repeated(w);
    *stage_run = 0;
    if (index >= once && repeated) {
        *stage_run =
            w->stages_before_substeps + (index - once) / repeated * (w->stage_count - w->stages_before_substeps);
        index = (index - once) % repeated;
    }
    for (;; ++*stage_run)
        for (*field = 0; *field < RHEO__FIELD_COUNT; ++*field)
            if ((w->stage[rheo__world_stage_of(w, *stage_run)].writes >> *field & 1) && index-- == 0)
                return;
}

uint64_t rheo__world_stage_runs_in_step(const rheo_world *w)
{
    return w->stages_before_substeps == w->stage_count
               ? w->stages_before_substeps
               : rheo__world_stage_runs(w, w->stage_runs_done < w->stages_before_substeps ? 1 : *w->state.substeps);
}
