/*
 * Searching a recording for the steps at which a condition holds: conditions on recorded metrics, which are read, and on
 * particles, springs and balls.
 */
#ifndef RHEOLOG_FIND_H
#define RHEOLOG_FIND_H

#include "rheolog/record.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Which of the steps at which a condition holds. */
typedef enum rheo_find_which {
    /** The first. */
    RHEO_FIND_FIRST = 0,
    /** The last. Takes as long as the steps between two keyframes if it is in the last of these intervals. */
    RHEO_FIND_LAST = 1,
    /** All, in order. */
    RHEO_FIND_ALL = 2,
} rheo_find_which;

/** Where a condition holds. */
typedef struct rheo_found {
    /** The step. */
    uint64_t step;
    /** The stage run after which it holds, as of rheo_player_seek_stage(); "" at the end of the step. */
    char stage[48];
    /** What the first comparison that holds is about: "particle 17", "spring 17:21", "ball", "ball 2"; "" for a metric. */
    char item[48];
    /** Particle, or smaller id of a spring; 0 for others. */
    uint64_t id;
    /** Larger id of a spring, else 0. */
    uint64_t other_id;
    /** Metric or quantity of this comparison; "exists" for `exists`. */
    char quantity[64];
    /** Its value; 1 for `exists`. */
    double value;
} rheo_found;

/** Called for each place that a search finds. Returns whether the search goes on. */
typedef bool rheo_find_receiver(void *data, const rheo_found *found);

/** Options of a search. Start from rheo_default_find_options(). */
typedef struct rheo_find_options {
    /** Which steps are wanted. Default RHEO_FIND_FIRST. */
    rheo_find_which which;
    /** Only steps after `after`. Default false. */
    bool has_after;
    /** Only steps before `before`. Default false. */
    bool has_before;
    /** The step of `has_after`. */
    uint64_t after;
    /** The step of `has_before`. */
    uint64_t before;
    /**
     * Looks after each run of this stage instead of at the ends of steps: a name, which means all substeps, or a name
     * with @ and the number of a substep. NULL: at the ends of steps. Metrics belong to ends of steps.
     */
    const char *stage;
    /** Called for each place; NULL: none. */
    rheo_find_receiver *receiver;
    /** Passed to `receiver`. */
    void *data;
} rheo_find_options;

/** What a search did. */
typedef struct rheo_search {
    /** Number of places that were found: at most 1 unless all are searched. */
    uint64_t hits;
    /** The last of them. */
    rheo_found found;
    /** Steps have been looked at, from `first` to `last`. */
    bool looked;
    /** First step that has been looked at. Only if `looked`. */
    uint64_t first;
    /** Last step that has been looked at. Only if `looked`. */
    uint64_t last;
} rheo_search;

/**
 * Searches for steps at which a condition holds. A condition is a comparison, or comparisons with `and`, `or`, `not` and
 * parentheses; `and` binds before `or`. A comparison is
 *
 *     METRIC OP NUMBER                     of a step: rheo_recording_metric_name()
 *     particle ID: QUANTITY OP NUMBER      x, y, z, vx, vy, vz, neighbours, springs, and each rheo_world_quantity();
 *     any particle: QUANTITY OP NUMBER     a vector stands for its length, and VECTOR.x, .y, .z for a component
 *     spring A:B: QUANTITY OP NUMBER       length, rest_length, stretch (length/rest_length - 1), history_rate, stiffness,
 *     any spring: QUANTITY OP NUMBER       kappa, as in rheo_spring_state
 *     ball: QUANTITY OP NUMBER             x, y, z, vx, vy, vz, speed, spin (its magnitude)
 *     spring A:B exists, particle ID exists
 *
 * with OP one of < <= > >= == !=. A comparison of a thing that does not exist, or with NaN, does not hold, but != with NaN.
 *
 * Metrics are read and not simulated; where they decide, no step is simulated. Other steps are simulated from keyframes,
 * and their hashes are compared (RHEO_ERROR_DIFFERS), or taken from a full recording. With a stage, also the stages of a
 * step that failed are looked at. After an error, *search has the places that were found before it.
 *
 * A search simulates no step before the keyframe at or before the first step that is wanted; for the last place, no
 * interval between keyframes before the one that has it.
 *
 * RHEO_ERROR_ARGUMENT for a condition that is not understood, a metric with a stage, or a particle that no step has;
 * RHEO_ERROR_STOPPED if a progress receiver ended the search.
 */
RHEO_API rheo_result rheo_recording_find(rheo_recording *recording, const char *condition,
                                         const rheo_find_options *options, rheo_search *search, rheo_error *error);

/**
 * Searches the recording of a player, as rheo_recording_find(), and moves the player to the place: the first goes on from
 * the player, the last is reached in at most an eighth of an interval between keyframes after the search. The player stays
 * where it is if nothing is found, if all places are wanted, or after an error.
 */
RHEO_API rheo_result rheo_player_find(rheo_player *player, const char *condition, const rheo_find_options *options,
                                      rheo_search *search, rheo_error *error);

/**
 * Whether a condition holds in a world at the end of its last step: *holds, and then *found says where. Metrics are those of
 * rheo_world_metric(). RHEO_ERROR_ARGUMENT as above.
 */
RHEO_API rheo_result rheo_world_holds(const rheo_world *world, const char *condition, bool *holds, rheo_found *found,
                                      rheo_error *error);

/** The first step at which a condition holds. */
RHEO_API rheo_find_options rheo_default_find_options(void);

#ifdef __cplusplus
}
#endif

#endif
