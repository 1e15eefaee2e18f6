/*
 * Recordings: the only kind of file. A recording holds whole states (keyframes) and, for every step, the commands
 * applied, the hash of every field after every stage that wrote it, and the metrics. A checkpoint is a recording with
 * one keyframe and no steps. docs/format.md describes the file to the byte.
 */
#ifndef RHEOLOG_RECORD_H
#define RHEOLOG_RECORD_H

#include "rheolog/world.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Checkpoints ---- */

/** Saves the whole state, beside `path` and renamed. `scene` names what is being run; `force`: replace a file. */
RHEO_API rheo_result rheo_world_save(const rheo_world *world, const char *scene, const char *path, bool force,
                                     rheo_error *error);
/** The same bytes in memory from malloc; release them with free(). */
RHEO_API rheo_result rheo_world_save_memory(const rheo_world *world, const char *scene, void **bytes, size_t *size,
                                            rheo_error *error);

/* ---- Recording a run ---- */

typedef struct rheo_recorder rheo_recorder;

typedef struct rheo_record_options {
    const char *scene;         /**< name kept in the file; NULL: "" */
    uint64_t keyframe_spacing; /**< a keyframe every so many steps; 0: chosen so that they cost about 3 % of a run */
    bool full;                 /**< keep the state of every step */
    bool force;                /**< replace an existing file, unless it is a blessed one */
} rheo_record_options;

/** Starts a recording of a world at its present state, which becomes the first keyframe. */
RHEO_API rheo_result rheo_recorder_open(rheo_world *world, const char *path, const rheo_record_options *options,
                                        rheo_recorder **recorder, rheo_error *error);
/**
 * Steps the world and records the step with the commands given since the last one. A step that goes bad is not in the
 * recording; if it is the last that was tried, the recording ends with the last good state and where the step went
 * bad.
 */
RHEO_API rheo_result rheo_recorder_step(rheo_recorder *recorder, rheo_error *error);
/** Writes index and end mark, closes, releases; the world stays. NULL is allowed. The file is whole only after this.
 */
RHEO_API rheo_result rheo_recorder_close(rheo_recorder *recorder, rheo_error *error);

/* ---- Reading ---- */

typedef struct rheo_recording rheo_recording;

typedef struct rheo_recording_info {
    const char *scene;
    const char *build;   /**< compiler, flags, number type and machine that wrote it */
    uint32_t format;     /**< version of the file format */
    uint32_t real_bytes; /**< 4 or 8 */
    uint64_t first_step; /**< step of the first keyframe */
    uint64_t last_step;  /**< last step that is whole in the file */
    uint64_t particles;  /**< at the first keyframe */
    uint64_t keyframes;
    uint64_t keyframe_spacing;
    double keyframe_share; /**< part of a run's time that keyframes take once the window is full, an estimate */
    uint64_t keyframe_bytes, step_bytes; /**< of the file: all keyframes, all step records */
    uint64_t bytes;                      /**< of the file */
    bool full;
    bool complete; /**< false: truncated, no end mark; what is before the tear can be used */
} rheo_recording_info;

/** Opens a recording. A truncated file opens with whole = false as long as its first keyframe is whole. */
RHEO_API rheo_result rheo_recording_open(const char *path, rheo_recording **recording, rheo_error *error);
/** The same from memory, which must stay as it is until the recording is closed. */
RHEO_API rheo_result rheo_recording_open_memory(const void *bytes, size_t size, rheo_recording **recording,
                                                rheo_error *error);
RHEO_API void rheo_recording_close(rheo_recording *recording); /* NULL is allowed */
RHEO_API rheo_recording_info rheo_recording_get_info(const rheo_recording *recording);
/** The definition the recording started from; no particles in it. Valid until the recording is closed. */
RHEO_API const rheo_world_def *rheo_recording_definition(const rheo_recording *recording);
RHEO_API uint64_t rheo_recording_keyframe_step(const rheo_recording *recording, uint64_t index);

/** Metrics of a step, stored, never simulated. Names as rheo_world_metric_name(). */
RHEO_API uint32_t rheo_recording_metric_count(const rheo_recording *recording);
RHEO_API const char *rheo_recording_metric_name(const rheo_recording *recording, uint32_t index);
/** Index of a metric; rheo_recording_metric_count() if the recording does not have it. */
RHEO_API uint32_t rheo_recording_metric_by_name(const rheo_recording *recording, const char *name);
/**
 * metric_count values of a step in first_step .. last_step; or of the one behind that could not be made
 * (rheo_recording_failure()): what its stages had found before it went bad, all else as before it.
 */
RHEO_API rheo_result rheo_recording_metrics(rheo_recording *recording, uint64_t step, double *values,
                                            rheo_error *error);

/* ---- Health ---- */

/**
 * A measure that left its range. Measures are metrics, or computed from metrics and parameters in force;
 * docs/debugging.md has the table of their ranges and how they were found. All texts are constant.
 */
typedef struct rheo_finding {
    const char *measure; /**< e.g. "stiffness_number" */
    const char *stage;   /**< that it belongs to */
    const char *meaning; /**< what it measures, one line */
    double limit;        /**< the largest value in range */
    uint64_t step;       /**< that it was first out of range */
    double value;        /**< there; NaN if what is recorded is no number */
    int64_t id;          /**< particle or smaller id of a spring there; -1: none */
    int64_t other_id;    /**< larger id of a spring; -1: none */
    uint64_t peak_step;
    double peak;    /**< the largest value of the recording */
    uint64_t steps; /**< how many were out of range */
    bool severe;    /**< makes a run unhealthy; else it is a notice */
} rheo_finding;

/** What would bring a measure back into its range; an estimate from the values when it left it. */
typedef struct rheo_advice {
    char set[64];   /**< "step=0.0135": for rheo_world_set(), or --set; "" if a parameter would not help */
    char text[192]; /**< for people */
} rheo_advice;

enum { RHEO_MAX_FINDINGS = 24, RHEO_MAX_ADVICE = 4 };

typedef struct rheo_diagnosis {
    bool healthy;
    bool failed;          /**< the run ended because a step could not be made */
    rheo_failure failure; /**< that step, if failed */
    bool complete;        /**< false: truncated; diagnosed as far as it goes */
    uint64_t first_step, last_step;
    /**
     * Unhealthy only: what came first, in an unbroken run of measures out of range up to the step that makes the run
     * unhealthy; or the parameter that must lead there. measure "" if the run failed with no measure out of range.
     */
    rheo_finding cause;
    uint64_t unhealthy_step; /**< that makes it unhealthy: a grave measure left its range, or the step failed */
    uint32_t finding_count;
    rheo_finding findings[RHEO_MAX_FINDINGS]; /**< every measure out of range, in the order in which they left it */
    uint32_t advice_count;
    rheo_advice advice[RHEO_MAX_ADVICE]; /**< best first */
    char why[768];                       /**< one line for people, begins with "healthy" or "unhealthy" */
} rheo_diagnosis;

/**
 * Where, when and why a run went bad, from the recorded metrics and parameters alone: nothing is simulated and no
 * state loaded. A truncated recording is diagnosed as far as it goes. RHEO_ERROR_FORMAT if a step is damaged.
 */
RHEO_API rheo_result rheo_diagnose(rheo_recording *recording, rheo_diagnosis *diagnosis, rheo_error *error);

/**
 * The world at a step: the nearest keyframe before it, and from there the stored states of a full recording; of any
 * other stepped on with the recorded commands, each step held against the recorded hashes (RHEO_ERROR_DIFFERS if one
 * does not agree). allocator may be NULL.
 */
RHEO_API rheo_result rheo_recording_world(rheo_recording *recording, uint64_t step, const rheo_allocator *allocator,
                                          rheo_world **world, rheo_error *error);

/* ---- How a run ended, and who stands for it ---- */

/** Whether the run ended because a step failed; where and why, as rheo_world_failure() said. */
RHEO_API bool rheo_recording_failure(const rheo_recording *recording, rheo_failure *failure);

/** Why a golden recording was made anew, and the build that it was blessed with. Valid while the recording is open.
 */
typedef struct rheo_blessing {
    const char *because, *build;
} rheo_blessing;

RHEO_API uint32_t rheo_recording_blessing_count(const rheo_recording *recording);
/** Oldest first; RHEO_ERROR_ARGUMENT past the end. */
RHEO_API rheo_result rheo_recording_blessing(const rheo_recording *recording, uint32_t index,
                                             rheo_blessing *blessing);

/* ---- Playing ---- */

/**
 * Moves through a recording: forwards, backwards, into the middle of a step. A step of a full recording is taken from
 * the stored states; any other is simulated from the nearest keyframe, with the recorded commands, and held against
 * the recorded hashes (RHEO_ERROR_DIFFERS if one does not agree: the player then stands at the step before).
 */
typedef struct rheo_player rheo_player;

/** Stands at the first step. The recording must stay open; allocator may be NULL. */
RHEO_API rheo_result rheo_player_open(rheo_recording *recording, const rheo_allocator *allocator,
                                      rheo_player **player, rheo_error *error);
RHEO_API void rheo_player_close(rheo_player *player); /* NULL is allowed */
/** The world where the player stands, to be looked at. Valid until the player moves. */
RHEO_API const rheo_world *rheo_player_world(const rheo_player *player);
/** To any step of the recording, in time bounded by the distance of keyframes. */
RHEO_API rheo_result rheo_player_seek(rheo_player *player, uint64_t step, rheo_error *error);
/** One step on, or back. RHEO_ERROR_ARGUMENT at the ends. */
RHEO_API rheo_result rheo_player_step(rheo_player *player, rheo_error *error);
RHEO_API rheo_result rheo_player_step_back(rheo_player *player, rheo_error *error);
/**
 * The next stage of the next step alone, simulated; *stage is its index in rheo_world_stage(). Behind the last step
 * there may be one more that could not be made (rheo_recording_failure()): its stages can be played up to the bad
 * one.
 */
RHEO_API rheo_result rheo_player_stage(rheo_player *player, uint32_t *stage, rheo_error *error);
/** Into the middle of the step that leads to `step`, right after a stage. The last stage is the end of the step. */
RHEO_API rheo_result rheo_player_seek_stage(rheo_player *player, uint64_t step, const char *stage, rheo_error *error);

/* ---- Comparing ---- */

typedef enum rheo_verdict { RHEO_SAME, RHEO_DIFFERS, RHEO_UNREADABLE } rheo_verdict;

/** How the values of a difference are known. */
typedef enum rheo_value_origin {
    RHEO_VALUES_NONE = 0,  /**< step, stage and field from the hashes, nothing else */
    RHEO_VALUES_SIMULATED, /**< simulated from the nearest keyframe with this build, right after the stage */
    RHEO_VALUES_SOLVED,    /**< one side simulated; the other solved from its hash, which leaves one component only */
    RHEO_VALUES_STORED,    /**< from states that the recordings hold: at the end of the step, or of a keyframe */
} rheo_value_origin;

/** The first difference between a recording and a replay, or another recording. */
typedef struct rheo_difference {
    uint64_t step;
    char stage[32]; /**< "" if the states that both begin with differ already */
    char field[32]; /**< that the hashes name */
    rheo_value_origin origin;
    char value_field[32]; /**< that the rest is about; at the end of a step the first field may agree again */
    uint64_t id;          /**< particle, body, vibrator, or the smaller id of a spring */
    uint64_t other_id;    /**< larger id of a spring, else 0 */
    uint32_t component;
    double expected, actual; /**< recorded and replayed; or of the first and the second recording */
    uint64_t expected_bits, actual_bits;
    uint64_t ulps;  /**< UINT64_MAX where it means nothing (NaN; a spring that only one side has) */
    uint64_t count; /**< items of the field that differ there */
} rheo_difference;

/** How much of a field differs at the end of a step. */
typedef struct rheo_growth {
    uint64_t step;
    char field[32];
    uint64_t count; /**< items that differ */
    uint64_t ulps;  /**< the largest difference */
} rheo_growth;

/** A parameter with which two recordings begin differently; the values as rheo_world_def_get() writes them. */
typedef struct rheo_parameter_difference {
    const rheo_parameter *parameter;
    char a[96], b[96];
} rheo_parameter_difference;

enum { RHEO_MAX_GROWTH = 96, RHEO_MAX_PARAMETER_DIFFERENCES = 64 };

typedef struct rheo_verification {
    rheo_verdict verdict;
    uint64_t steps; /**< steps that were compared and held */
    /**
     * rheo_verify(): the hash of this build's state after the last step that was compared, which is the one that
     * differs, if one does. has_hash false: there is none, since that step could not be made, or nothing was
     * compared.
     */
    bool has_hash;
    uint64_t hash;
    rheo_difference first; /**< RHEO_DIFFERS only */
    /** After the first difference: at its step and 1, 2, 4, 8, ... steps on, where both states can be had. */
    uint32_t growth_count;
    rheo_growth growth[RHEO_MAX_GROWTH];
    /** Of two recordings: the first step before which they were given other commands, if there is one up to there. */
    bool commands_differ;
    uint64_t commands_step;
    uint32_t parameter_count;
    rheo_parameter_difference parameters[RHEO_MAX_PARAMETER_DIFFERENCES];
    /**
     * Of two recordings that begin with other states and other parameters: where the parameters alone would first
     * show, from the state that the first begins with.
     */
    bool has_cause;
    rheo_difference cause;
    char message[768]; /**< one line for people */
} rheo_verification;

/**
 * Simulates again from the first keyframe and compares every step; checks every chunk. Damage is the verdict
 * RHEO_UNREADABLE with how many steps held. Returns other than RHEO_OK only if the system failed (file, memory).
 */
RHEO_API rheo_result rheo_verify(const char *path, rheo_verification *verification, rheo_error *error);
RHEO_API rheo_result rheo_verify_memory(const void *bytes, size_t size, rheo_verification *verification,
                                        rheo_error *error);

/**
 * Compares two recordings step by step, where both have steps: `expected` is of a, `actual` of b. Recordings of which
 * one goes on longer are the same if they are the same as far as both go. Values are simulated with this build where
 * it reproduces the hashes of both, else taken from the stored states of full recordings. Results as of
 * rheo_verify().
 */
RHEO_API rheo_result rheo_diff(const char *path_a, const char *path_b, rheo_verification *verification,
                               rheo_error *error);
RHEO_API rheo_result rheo_diff_memory(const void *a, size_t size_a, const void *b, size_t size_b,
                                      rheo_verification *verification, rheo_error *error);

/* ---- Golden recordings ---- */

/**
 * Puts the recording new_path in the place of old_path (which need not exist), with the reason and this build written
 * into it, after those of earlier blessings. new_path must be whole and verify as the same with this build
 * (RHEO_ERROR_DIFFERS else); it is left as it is. Nothing else replaces a blessed recording: not even force.
 * If the two do not differ, nothing is written. *difference: what differs between old and new.
 */
RHEO_API rheo_result rheo_bless(const char *old_path, const char *new_path, const char *because,
                                rheo_verification *difference, rheo_error *error);

#ifdef __cplusplus
}
#endif
#endif
