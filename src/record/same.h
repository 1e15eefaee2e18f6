/* Private declarations of the ladder between the same bits and other physics (include/rheolog/same.h). */
#ifndef RHEO__RECORD_SAME_H
#define RHEO__RECORD_SAME_H

#include "rheolog/same.h"
#include "record/recording.h"

/* ---- Moving numbers by +-1 ulp (record/same_ulp.c) ---- */

/*
 * Moves `count` numbers by +1 or -1 ulp, by signs that follow from seed, stream (a field, a step) and index; undoes it if
 * `back`. Moving and undoing gives the same bits, also of zeros.
 */
void rheo__same_move(rheo_real *values, size_t count, uint64_t seed, uint64_t stream, bool back);

/* ---- Parameters of the new side (record/same.c) ---- */

/* Gives a world the parameters of the options, as commands that are not recorded. */
rheo_result rheo__same_set(const rheo_same_options *options, rheo_world *world, rheo_error *error);
/*
 * Gives the commands of steps[index], as rheo__recording_command(), but those that set a parameter of the options: these
 * keep the value of the options.
 */
rheo_result rheo__same_command(rheo_recording *golden, size_t index, const rheo_same_options *options,
                               rheo_world *world, rheo_error *error);

/* ---- The rungs ---- */

/* Rungs rounding and step, for a recording that is complete and whose world this build can make (record/same_steps.c). */
rheo_result rheo__same_steps(rheo_recording *golden, const rheo_same_options *options, bool halved,
                             rheo_same_steps *result, rheo_error *error);

/*
 * Rung statistics: compares members of the recorded side, from the golden file if it has them, with members made by this
 * build and the parameters of the options. Sets tried and all other members of *result (record/same_statistics.c).
 */
rheo_result rheo__same_statistics(rheo_recording *golden, const rheo_same_options *options,
                                  rheo_same_statistics *result, rheo_error *error);

#endif
