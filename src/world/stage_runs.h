/*
 * A step runs the stages of the list in three phases: those up to stage `substeps` once, the following ones in every
 * substep, and those after rheo__world_end_substeps() once. A world without stage `substeps` has only the first.
 * Each run of a stage has a number in the step, from 0: its stage_run. Hashes of every field are taken after every
 * stage run that wrote it, in the order of the runs, then of the fields.
 */
#ifndef RHEO__WORLD_STAGE_RUNS_H
#define RHEO__WORLD_STAGE_RUNS_H

#include "world/world.h"

/* Recordings store the numbers. */
typedef enum rheo__phase { RHEO__BEFORE_SUBSTEPS, RHEO__IN_SUBSTEPS, RHEO__AFTER_SUBSTEPS } rheo__phase;

/* Phase of a stage of the list. */
rheo__phase rheo__world_phase(const rheo_world *world, uint32_t stage);

/* Substeps of the current step, once stage `substeps` has run in it; until then those of the last step. */
uint64_t rheo__world_substeps(const rheo_world *world);
/* Stage runs of a step with this many substeps. */
uint64_t rheo__world_stage_runs(const rheo_world *world, uint64_t substeps);
/* Stage runs of the current step; exact only after stage `substeps` has run. */
uint64_t rheo__world_stage_runs_in_step(const rheo_world *world);

/* Of a stage run of the current step: index of its stage, and its substep from 1; 0 if the stage runs once. */
uint32_t rheo__world_stage_of(const rheo_world *world, uint64_t stage_run);
uint64_t rheo__world_substep_of(const rheo_world *world, uint64_t stage_run);
/* Name of a stage run of the current step: that of its stage, in a substep with its number as in "viscosity@3". */
void rheo__world_stage_run_name(const rheo_world *world, uint64_t stage_run, char name[32]);
/* Whether it is the first of a substep other than the first substep. */
bool rheo__world_begins_later_substep(const rheo_world *world, uint64_t stage_run);
/* Position relative to the run of a stage in a substep, 0 if that runs once: < 0 earlier, 0 the same, > 0 later. */
int rheo__world_compare_run(const rheo_world *world, uint64_t stage_run, uint32_t stage, uint64_t substep);

/* Numbers of hashes: of the stages that run once, and of one substep (0 if there are no substeps). */
uint32_t rheo__world_trace_once(const rheo_world *world);
uint32_t rheo__world_trace_repeated(const rheo_world *world);
/* Substeps of a step with this many hashes. */
uint64_t rheo__world_trace_substeps(const rheo_world *world, size_t hashes);
/* Name of the stage run, and field, of a hash of a step with this many substeps. */
void rheo__world_trace_entry(const rheo_world *world, uint64_t substeps, size_t index, char name[32],
                             rheo__field_id *field);
/* Index of the first hash of a stage run of the current step. */
size_t rheo__world_trace_start(const rheo_world *world, uint64_t stage_run);

#endif
