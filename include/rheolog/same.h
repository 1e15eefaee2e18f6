/*
 * Whether a recording that this build does not reproduce to the bit still shows the same physics. A ladder of verdicts,
 * from the same bits down to other statistics; each rung is a measurement with a limit, and all are seeded, so that equal
 * programs always give equal verdicts.
 */
#ifndef RHEOLOG_SAME_H
#define RHEOLOG_SAME_H

#include "rheolog/record.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Limits of rung statistics. */
enum {
    /** Fewest members of a side. */
    RHEO_LEAST_SAME_MEMBERS = 8,
    /** Most members of a side. */
    RHEO_MOST_SAME_MEMBERS = 64,
    /** Most values in a result. */
    RHEO_MOST_SAME_METRICS = 48,
};

/** Options of a comparison. Start from rheo_default_same_options(). */
typedef struct rheo_same_options {
    /**
     * The weakest verdict that passes; weaker rungs are not tried. DIFFERS tries all and passes any verdict. Default
     * STATISTICS.
     */
    rheo_sameness at_least;
    /** Seeds the signs of all +-1 ulp, and the members. Any number. Default 1. */
    uint64_t seed;
    /** Rung rounding: largest ratio of the difference to that of +-1 ulp, 1 to 1e6. Default 16. */
    double limit;
    /** Rung statistics: runs on each side, RHEO_LEAST_SAME_MEMBERS to RHEO_MOST_SAME_MEMBERS. Default 20. */
    uint32_t members;
    /**
     * Parameters that the new side has with another value, "NAME=VALUE" as rheo_world_set() takes them; recorded commands
     * that set them are not given. So a change of a parameter is judged like a change of the program. Default none.
     */
    const char *const *set;
    /** Number of these parameters. Default 0. */
    uint32_t set_count;
    /** Rung statistics: also measures the false alarm rate (rheo_same_statistics). Default false. */
    bool self_check;
} rheo_same_options;

/** Options with their defaults. */
RHEO_API rheo_same_options rheo_default_same_options(void);

/** How far a field of the state is from the recorded one after one step. All texts are constant. */
typedef struct rheo_same_ratio {
    /** The field; "" if nothing was compared. */
    char field[32];
    /** The step. */
    uint64_t step;
    /** The first stage of it whose hashes are not the recorded ones; "" if all are. */
    char stage[32];
    /** Root mean square of the differences, in the field's unit. */
    double rms;
    /** Largest difference, in the field's unit. */
    double largest;
    /** Root mean square of the yardstick's differences: of +-1 ulp, or of halving the step. */
    double rms_yardstick;
    /** Largest difference of the yardstick. */
    double largest_yardstick;
    /** The larger of the two quotients; 0 if nothing differs. */
    double ratio;
} rheo_same_ratio;

/** Rungs bits and rounding, or step. */
typedef struct rheo_same_steps {
    /** The rung was tried. */
    bool tried;
    /** It holds. */
    bool passed;
    /**
     * Steps from one compared state to the next: 1 in a full recording; in others the rung rounding goes from keyframe to
     * keyframe, and compares where 1 ulp has not grown too much on the way.
     */
    uint64_t interval;
    /** Such intervals in the recording. */
    uint64_t available;
    /** Intervals that were compared. */
    uint64_t compared;
    /** Steps in which a decision fell otherwise (a spring, the number of substeps), so that values are not comparable. */
    uint64_t decisions;
    /** The largest ratio of all. */
    rheo_same_ratio worst;
    /** The first ratio beyond the limit. Only if !passed. */
    rheo_same_ratio first;
} rheo_same_steps;

/** A value over the members of both sides: the mean of a metric over some steps, or the time of an event. */
typedef struct rheo_same_metric {
    /** Name: "energy, mean of steps 61 to 80", "centre_y passes -3.2", "ball_y is least". */
    char name[96];
    /** Its unit; that of times is steps. */
    char unit[24];
    /** Means of the recorded side and of this one. */
    double mean[2];
    /** Standard deviations of both sides. */
    double deviation[2];
    /** The p value of the rank test. */
    double p;
    /** Distance of the means in standard deviations: the larger one of the two sides; infinite if both are 0. */
    double shift;
    /** Rejected by Benjamini and Yekutieli at 1 %. */
    bool rejected;
} rheo_same_metric;

/** Rung statistics. */
typedef struct rheo_same_statistics {
    /** The rung was tried. */
    bool tried;
    /** It holds. */
    bool passed;
    /** Members of the recorded side were read from the golden file; else they were simulated. */
    bool stored;
    /** Members of the recorded side and of this one. */
    uint32_t members[2];
    /** How far the members' coordinates were moved at most, in spacings; 0: by one unit in the last place. */
    double moved;
    /** Number of values that were tested. */
    uint32_t metric_count;
    /** Number of values that were not, since their spread still grows. */
    uint32_t left_out;
    /** Number of tested values that were rejected. */
    uint32_t rejected;
    /** The values with the smallest p, smallest first: metric_count, or RHEO_MOST_SAME_METRICS if there are more. */
    rheo_same_metric metrics[RHEO_MOST_SAME_METRICS];
    /** The spread of all values still grows at the end of the recording: nothing can be said, and `passed` is false. */
    bool too_early;
    /** A run of this side went bad; nothing was compared, and `passed` is false. */
    bool went_bad;
    /** Why it went bad. Only if `went_bad`. */
    char why[320];
    /** Only with self_check: splits of runs of one program that were compared with each other. */
    uint64_t self_checks;
    /** Only with self_check: splits that differed. */
    uint64_t false_alarms;
} rheo_same_statistics;

/** Result of rheo_same(), with every rung that was tried. */
typedef struct rheo_same_result {
    /** The strongest rung that holds; RHEO_SAMENESS_DIFFERS if none does. */
    rheo_sameness verdict;
    /** Rung bits was tried. */
    bool bits_tried;
    /** Rung bits holds. */
    bool bits_passed;
    /** Steps with the recorded hashes. */
    uint64_t bits_steps;
    /** Rung rounding. */
    rheo_same_steps rounding;
    /** Rung step. */
    rheo_same_steps step;
    /** Rung statistics. */
    rheo_same_statistics statistics;
    /** The verdict in words, one line; begins with the name of the verdict. */
    char message[768];
} rheo_same_result;

/**
 * Compares this build, with the parameters of `options`, with the program that made a recording. `options` may be NULL for
 * defaults. Rungs are tried from the strongest down to `at_least`; the first that holds is the verdict.
 * RHEO_ERROR_ARGUMENT for options out of range or a parameter that a running world cannot change; RHEO_ERROR_FORMAT for a
 * damaged or truncated recording; RHEO_ERROR_UNSUPPORTED if this build has no such stages or numbers;
 * RHEO_ERROR_STOPPED (rheo_use_progress()). After an error the verdict is RHEO_SAMENESS_UNKNOWN.
 */
RHEO_API rheo_result rheo_same(const char *golden, const rheo_same_options *options, rheo_same_result *result,
                               rheo_error *error);

/**
 * rheo_bless() that also finds out, with the options, how far the change goes from old_path to this build, and stores the
 * verdict beside the reason. *same: the verdict; RHEO_SAMENESS_UNKNOWN if there is no old_path, this build cannot make its
 * world, or the two recordings begin with other states or parameters or have other commands, since then it is not only the
 * program that changed. `required`: RHEO_ERROR_DIFFERS if it is less than options->at_least, and nothing is written.
 */
RHEO_API rheo_result rheo_bless_same(const char *old_path, const char *new_path, const char *because, bool shrink,
                                     const rheo_same_options *options, bool required, rheo_same_result *same,
                                     rheo_verification *difference, rheo_error *error);

/* ---- Members in a golden file ---- */

/**
 * Runs the members of a recording and keeps their results in it, in the place of others that it has, so that neither this
 * program nor these runs are needed when a later program is compared. This build must verify the recording. Blessings stay.
 * RHEO_ERROR_ARGUMENT for a number of members out of range, a recording of fewer than 16 steps, or a file that is no
 * recording or is being written; RHEO_ERROR_DIFFERS if this build does not verify it; RHEO_ERROR_STATE if a member goes bad.
 */
RHEO_API rheo_result rheo_same_keep_members(const char *path, uint32_t members, uint64_t seed, rheo_error *error);

/** Number of members that a recording holds; 0: none. */
RHEO_API uint32_t rheo_recording_member_count(const rheo_recording *recording);

#ifdef __cplusplus
}
#endif

#endif
