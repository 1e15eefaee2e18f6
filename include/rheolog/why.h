/*
 * Who changed a particle: for each stage of a step, what was added to a value of it, in order, and by whom.
 */
#ifndef RHEOLOG_WHY_H
#define RHEOLOG_WHY_H

#include "rheolog/record.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * What changes a value. The item, if there is one, is said in parentheses. A pair without another particle has the particle
 * itself as its item: farther than about 1e19 L from the origin (float), squared distances overflow, and entries of its row
 * that have no partner add NaN instead of 0.
 */
typedef enum rheo_source {
    /** Nothing: the field is summed anew, so its old value is dropped. It is the largest contribution only if there is no other. */
    RHEO_SOURCE_NONE = 0,
    /** Gravity. */
    RHEO_SOURCE_GRAVITY = 1,
    /** The velocity of the particle, which moves it. */
    RHEO_SOURCE_VELOCITY = 2,
    /** Pressure of a pair (the other particle). */
    RHEO_SOURCE_PRESSURE = 3,
    /** A spring (its other particle). */
    RHEO_SOURCE_SPRING = 4,
    /** Viscosity of a pair (the other particle). */
    RHEO_SOURCE_VISCOSITY = 5,
    /** A wall (its number; that of the nearest for the share that several walls have together in a summed density). */
    RHEO_SOURCE_WALL = 6,
    /** A ball (its index, 0 for the first). */
    RHEO_SOURCE_BALL = 7,
    /** A plate (0 the lower, 1 the upper one). */
    RHEO_SOURCE_PLATE = 8,
    /** Coinciding particles are parted (the other particle). */
    RHEO_SOURCE_PARTING = 9,
    /** XSPH, which moves a particle with its neighbours (the other particle). */
    RHEO_SOURCE_DRIFT = 10,
    /** Flow towards a neighbour or away from it changes the density (the other particle). */
    RHEO_SOURCE_FLOW = 11,
    /** Heat from a neighbour (the other particle). */
    RHEO_SOURCE_HEAT = 12,
    /** A past velocity (how many steps before the newest that is remembered). */
    RHEO_SOURCE_PAST = 13,
    /** The solver of the viscosity: what its tolerance and its rounding leave. */
    RHEO_SOURCE_SOLVER = 14,
    /** Periodic space: the particle is put back into the period. */
    RHEO_SOURCE_PERIOD = 15,
    /** Sums over pairs, walls and ball that the stage applies, such as an acceleration. */
    RHEO_SOURCE_SUM = 16,
    /** A density that is summed anew (the other particle; its own share: the particle itself). */
    RHEO_SOURCE_SHARE = 17,
    /** The particle's displacement in the step sets its velocity. */
    RHEO_SOURCE_DISPLACEMENT = 18,
    /** A vibrator that pushes particles (its number). */
    RHEO_SOURCE_VIBRATOR = 19,
    /** A mode of the past, a sum over its velocities (its number, the slowest first). */
    RHEO_SOURCE_MODE = 20,
    /** An obstacle (its number). */
    RHEO_SOURCE_OBSTACLE = 21,
    /** Number of sources. */
    RHEO_SOURCE_COUNT = 22,
} rheo_source;

/** Short name of a source, such as "spring"; NULL if there is none of this number. */
RHEO_API const char *rheo_source_name(rheo_source source);
/**
 * What its item is: "particle", "wall", "plate", "lag", "vibrator", "mode" or "obstacle"; "" if it has none; NULL if there is
 * no source of this number.
 */
RHEO_API const char *rheo_source_item(rheo_source source);

/** Something that was added to a value, or put in its place. */
typedef struct rheo_contribution {
    /** Where it came from. */
    rheo_source source;
    /** As rheo_source says; 0 if the source has none. */
    uint64_t item;
    /** The sum that `value` was added to, such as "pressure", an acceleration; "" if it was added to the field itself. */
    const char *sum;
    /** What was added, exactly. In 1 component for a scalar. For RHEO_SOURCE_VELOCITY the velocity. */
    double value[3];
    /** The field changed by so much of the sum: 1 without one. For RHEO_SOURCE_VELOCITY the duration of the substep. */
    double factor;
    /** factor x value: the change of the field, in its units. For a value that was put in place of another, their difference. */
    double change[3];
    /** Whether the value was put in the place of the field's. */
    bool sets;
} rheo_contribution;

/** What a run of a stage did to a field of a particle. */
typedef struct rheo_change {
    /** The step. */
    uint64_t step;
    /** The stage run, as of rheo_player_seek_stage(). */
    char stage[48];
    /** Name of the field. */
    char field[32];
    /** Number of the stage run in the step, from 0: runs with smaller numbers were made before. */
    uint64_t run;
    /** Components of the field: 1 or 3. */
    uint32_t components;
    /** The field of the particle before the run, in the units of the field. Components that it lacks are 0. */
    double before[3];
    /** The same after the run. */
    double after[3];
    /** Before the run, all values of the particle that stages add to were finite. */
    bool was_finite;
    /**
     * Added in their order, in the numbers of the library, the contributions to each sum, and the sums times their factors
     * to `before`, give `after`, bit for bit. It is true unless rheolog has a bug.
     */
    bool exact;
    /** Contributions in the order in which they were added; valid until the receiver returns. */
    const rheo_contribution *contribution;
    /** Number of contributions. */
    size_t count;
} rheo_change;

/** Is called for each change; returns whether more are wanted. */
typedef bool rheo_change_receiver(void *data, const rheo_change *change);

/**
 * Tells who changed a field of a particle in a step: makes the step again and calls `receiver` for each stage run that changes or
 * writes the field, in order. Then the player is at the end of the step; if the step failed, at that of the step before.
 *
 * step: from the first step of the recording + 1; also that of a step that failed. stage: only the runs of this stage, or one of
 * them, as of rheo_player_seek_stage(); NULL: all. field: "position", "velocity", "density", "temperature" or "derivative", if
 * the world has it.
 *
 * RHEO_ERROR_ARGUMENT for another step, stage or field, and for a particle that does not exist; RHEO_ERROR_DIFFERS if this
 * build does not reproduce the recorded step.
 */
RHEO_API rheo_result rheo_player_why(rheo_player *player, uint64_t step, const char *stage, uint64_t id,
                                     const char *field, rheo_change_receiver *receiver, void *data,
                                     rheo_error *error);

/* ---- Chains of causes ---- */

/** What happened to NaN and infinity in a stage run. */
typedef enum rheo_not_finite {
    /** All values were and are finite. */
    RHEO_FINITE = 0,
    /** The values before were finite, the result is not. */
    RHEO_NOT_FINITE_BORN = 1,
    /** A value of the particle or of a partner was not finite, and so is the result. */
    RHEO_NOT_FINITE_PASSED_ON = 2,
    /** A value or a contribution was not finite, but the result is. */
    RHEO_NOT_FINITE_SWALLOWED = 3,
} rheo_not_finite;

/** "born", "passed on", "swallowed"; "" for RHEO_FINITE. */
RHEO_API const char *rheo_not_finite_name(rheo_not_finite what);

/** A cause: a stage run that changed a value of a particle, and the largest contribution in it. */
typedef struct rheo_link {
    /** The step. */
    uint64_t step;
    /** Number of the stage run in the step, from 0. */
    uint64_t run;
    /** The stage run, as of rheo_player_seek_stage(). */
    char stage[48];
    /** Name of the field. */
    char field[32];
    /** The particle. */
    uint64_t id;
    /** Components of the field, as in rheo_change. */
    uint32_t components;
    /** The field before the run, as in rheo_change. */
    double before[3];
    /** The field after the run, as in rheo_change. */
    double after[3];
    /** What happened to NaN and infinity. */
    rheo_not_finite not_finite;
    /** Number of contributions. */
    uint64_t contributions;
    /** The largest contribution; of a value that is not finite, the first that is not. */
    rheo_contribution largest;
} rheo_link;

/** Is called for each link, from effect to cause; returns whether more are wanted. */
typedef bool rheo_link_receiver(void *data, const rheo_link *link);

/** Why a chain of causes ended. */
typedef enum rheo_chain_end {
    /** As many links as were wanted. */
    RHEO_CHAIN_DEPTH = 0,
    /** Before the step, commands were given. */
    RHEO_CHAIN_COMMAND = 1,
    /** The recording begins. */
    RHEO_CHAIN_START = 2,
    /** The step has the first sign that rheo_diagnose() finds. */
    RHEO_CHAIN_SIGN = 3,
    /** The largest contribution comes from outside of the particles: gravity, the ball, a plate, the solver. */
    RHEO_CHAIN_SOURCE = 4,
    /** Nothing changed the value in the step, or in the 16 steps before. */
    RHEO_CHAIN_UNCHANGED = 5,
    /** NaN or infinity was born. */
    RHEO_CHAIN_BORN = 6,
} rheo_chain_end;

/** A chain of causes that was followed to its end. */
typedef struct rheo_chain {
    /** Number of links. */
    uint64_t links;
    /** Why it ended. */
    rheo_chain_end end;
    /** The step at which it ended. */
    uint64_t step;
    /** Why it ended, in words. */
    char why[512];
} rheo_chain;

/**
 * Follows causes backwards. A link is the stage run that changed the field most, and the largest contribution in it. The next
 * link is what this contribution came from: of a velocity that moves the particle, that velocity; of a pair, the position or
 * velocity of that particle of the two which changed more. It is looked for in the runs before, then in up to 16 steps before,
 * where gravity counts only if there is nothing else. NaN and infinity are followed to where they were born, also from a stage
 * that swallows them.
 *
 * depth: the most links, from 1. Others are as for rheo_player_why(). The player keeps states on the way to the step, so the way is
 * made once, and a step that is looked at d steps before it costs at most about d + 8 steps. RHEO_ERROR_STOPPED: the receiver did
 * not want more.
 */
RHEO_API rheo_result rheo_player_why_chain(rheo_player *player, uint64_t step, const char *stage, uint64_t id,
                                           const char *field, uint32_t depth, rheo_link_receiver *receiver,
                                           void *data, rheo_chain *chain, rheo_error *error);

/* ---- What did not happen ---- */

/** Two particles in a step. */
typedef struct rheo_pair_step {
    /** The step. */
    uint64_t step;
    /** Both particles exist. */
    bool exists;
    /** Distance at the end of the step, in periodic space to the nearest image. Unit L. NaN if a particle does not exist. */
    double distance;
    /** Least distance after the stages that decide, in the same way. Unit L. NaN also if nothing decided. */
    double nearest;
    /** The stage with the least distance; "" if nothing decided in this step. */
    char stage[48];
    /** At the end of the step, there is a spring between them. */
    bool spring;
} rheo_pair_step;

/** Is called for each step that is looked at; returns whether more are wanted. */
typedef bool rheo_pair_receiver(void *data, const rheo_pair_step *step);

/** Why two particles have no spring, or did not meet. */
typedef struct rheo_why_not {
    /** First step that was looked at. */
    uint64_t first;
    /** Last step that was looked at. */
    uint64_t last;
    /** What springs and neighbours are closer than. Unit L. */
    double support;
    /** There is a spring in the step that was asked about, or the particles are closer than the support at its end. */
    bool holds;
    /** The step that was asked about. */
    rheo_pair_step at;
    /** The step with the least distance. */
    rheo_pair_step nearest;
    /** In one of the steps it holds. */
    bool held;
    /** The first step in which it holds. Only if `held`. */
    uint64_t held_first;
    /** The last step in which it holds. Only if `held`. */
    uint64_t held_last;
    /** In the step, the nearest image is across a border of periodic space. */
    bool across;
    /** The answer in one sentence. */
    char why[512];
} rheo_why_not;

/**
 * Tells why two particles have no spring in a step (`spring`), or did not come closer than the support. Looks at the steps from
 * the keyframe before the step to the one after it, after each stage that makes springs, or else after each stage.
 *
 * RHEO_ERROR_ARGUMENT: no such step, no such particles in it, the same particle twice, or no springs in the recording.
 * RHEO_ERROR_STOPPED: the receiver wanted no more.
 */
RHEO_API rheo_result rheo_player_why_not(rheo_player *player, uint64_t step, uint64_t a, uint64_t b, bool spring,
                                         rheo_pair_receiver *receiver, void *data, rheo_why_not *answer,
                                         rheo_error *error);

#ifdef __cplusplus
}
#endif

#endif
