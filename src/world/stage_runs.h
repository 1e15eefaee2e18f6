/*
 * A step runs the stages of the list once each; those after stage `substeps`, if there is one, run in every substep.
 * Each run of a stage has a number in the step, from 0: its stage_run. Hashes of every field are taken after every
 * stage run that wrote it, in the order of the runs, then of the fields.
 */
#ifndef RHEO__WORLD_STAGE_RUNS_H
#define RHEO__WORLD_STAGE_RUNS_H

#include "world/world.h"

/* Index of the stage of a stage run. */
uint32_t rheo__world_stage_of(const rheo_world *world, uint64_t stage_run);
/* Name of a stage run: that of its stage; in substeps with their number from 1, as in "viscosity@3". */
void rheo__world_stage_run_name(const rheo_world *world, uint64_t stage_run, char name[32]);
/* Stage runs of a step with this many substeps. */
uint64_t rheo__world_stage_runs(const rheo_world *world, uint64_t substeps);
/* Stage runs of the current step; exact only after stage `substeps` has run. */
uint64_t rheo__world_stage_runs_in_step(const rheo_world *world);

/* Numbers of hashes: of the stages that run once, and of one substep (0 if there are no substeps). */
uint32_t rheo__world_trace_once(const rheo_world *world);
uint32_t rheo__world_trace_repeated(const rheo_world *world);
/* Stage run and field of a hash. */
void rheo__world_trace_entry(const rheo_world *world, size_t index, uint64_t *stage_run, rheo__field_id *field);
/* Index of the first hash of a stage run. */
size_t rheo__world_trace_start(const rheo_world *world, uint64_t stage_run);

#endif
