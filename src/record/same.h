/* Private declarations of the ladder between the same bits and other physics (include/rheolog/same.h). */
#ifndef RHEO__RECORD_SAME_H
#define RHEO__RECORD_SAME_H

#include "rheolog/same.h"
#include "record/recording.h"

/* ---- Moving numbers by +-1 ulp (record/same_ulp.c) ---- */

/*
 * Moves `count` numbers by +1 or -1 ulp, by signs that follow from seed, stream (a field, a step) and index. Zeros and
 * numbers so small that they could change sign stay. The same move again undoes it, to the bit.
 */
void rheo__same_move(rheo_real *values, size_t count, uint64_t seed, uint64_t stream);
/*
 * Moves all numbers of a state with which the next step computes, also rest lengths and the history. The same move again
 * undoes it. After an error the world must not be used.
 */
rheo_result rheo__same_move_state(rheo_world *world, uint64_t seed, rheo_error *error);

/* ---- Parameters of the new side (record/same.c) ---- */

/* Gives a world the parameters of the options, as commands that are not recorded. */
rheo_result rheo__same_set(const rheo_same_options *options, rheo_world *world, rheo_error *error);
/*
 * Gives the commands of steps[index], as rheo__recording_command(), but those that set a parameter of the options: these
 * keep the value of the options.
 */
rheo_result rheo__same_command(rheo_recording *golden, size_t index, const rheo_same_options *options,
                               rheo_world *world, rheo_error *error);

/* The same for commands that belong to no recorded step: those of the step that failed. */
rheo_result rheo__same_command_of(rheo_recording *golden, const rheo__step_chunks *chunks, uint64_t step,
                                  const rheo_same_options *options, rheo_world *world, rheo_error *error);

/* ---- The verdict in words (record/same_words.c) ---- */

/* Sets result->message. `why`: the error that ended the comparison, or NULL. */
void rheo__same_describe(rheo_same_result *result, const rheo_same_options *options, const rheo_error *why);

/* ---- States in units of a yardstick (record/same_compare.c) ---- */

/* Three states after the same step: the recorded one, that of this build, and that of this build from elsewhere. */
typedef struct rheo__same_states {
    const rheo_world *world;
    const rheo__values *recorded, *own, *other;
} rheo__same_states;

/* What a rung has found so far. */
typedef struct rheo__same_judge {
    rheo_same_steps *result;
    double limit;
    bool whole;         /* a decision that falls otherwise is a difference like others */
    uint64_t decisions; /* steps in which one fell otherwise in the yardstick */
    rheo_same_ratio first_decision;
} rheo__same_judge;

/* Compares all fields of a step. `stage`: the first with another hash. */
void rheo__same_judge_states(rheo__same_judge *judge, const rheo__same_states *states, uint64_t step,
                             const char *stage);
/* A step that this build cannot make, or makes although the recorded one failed. */
void rheo__same_refuse(rheo__same_judge *judge, uint64_t step, const char *stage, const char *field);
/* Judges the decisions that fell otherwise. */
void rheo__same_judge_end(rheo__same_judge *judge);

/* ---- A step in two halves (record/same_halved.c) ---- */

/* False: the modes of the memory belong to the step and cannot be taken over. */
bool rheo__same_can_halve(const rheo_world *world);
/* The state after a step, made in halves from the present state of a world between steps. *failed: a stage failed. */
rheo_result rheo__same_halves(const rheo_world *world, rheo__values *values, bool *failed, rheo_error *error);

/* ---- The rungs ---- */

/* Rungs rounding and step, for a recording that is complete and whose world this build can make (record/same_steps.c). */
rheo_result rheo__same_steps(rheo_recording *golden, const rheo_same_options *options, bool halved,
                             rheo_same_steps *result, rheo_error *error);

/* Rung rounding without the state of every step: from one keyframe to the next (record/same_intervals.c). */
rheo_result rheo__same_intervals(rheo_recording *golden, const rheo_same_options *options, rheo_same_steps *result,
                                 rheo_error *error);

/*
 * Rung statistics: compares members of the recorded side, from the golden file if it has them, with members made by this
 * build and the parameters of the options. Sets tried and all other members of *result (record/same_statistics.c).
 */
rheo_result rheo__same_statistics(rheo_recording *golden, const rheo_same_options *options,
                                  rheo_same_statistics *result, rheo_error *error);

#endif
