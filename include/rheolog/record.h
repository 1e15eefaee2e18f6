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
    uint64_t keyframe_spacing; /**< a keyframe every so many steps; 0: chosen so that they cost < 10 % of a run */
    bool full;                 /**< keep the state of every step */
    bool force;                /**< replace an existing file */
} rheo_record_options;

/** Starts a recording of a world at its present state, which becomes the first keyframe. */
RHEO_API rheo_result rheo_recorder_open(rheo_world *world, const char *path, const rheo_record_options *options,
                                        rheo_recorder **recorder, rheo_error *error);
/** Steps the world and records the step with the commands given since the last one. */
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
    uint64_t keyframe_bytes, step_bytes; /**< of the file: all keyframes, all step records */
    uint64_t bytes;                      /**< of the file */
    bool full;
    bool whole; /**< false: torn, no end mark; what is before the tear can be used */
} rheo_recording_info;

/** Opens a recording. A torn file opens with whole = false as long as its first keyframe is whole. */
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
/** metric_count values of a step in first_step .. last_step. */
RHEO_API rheo_result rheo_recording_metrics(rheo_recording *recording, uint64_t step, double *values,
                                            rheo_error *error);

/**
 * The world at a step: the nearest keyframe before it, stepped on with the recorded commands, each step held against
 * the recorded hashes (RHEO_ERROR_DIFFERS if one does not agree). allocator may be NULL.
 */
RHEO_API rheo_result rheo_recording_world(rheo_recording *recording, uint64_t step, const rheo_allocator *allocator,
                                          rheo_world **world, rheo_error *error);

/* ---- Verifying ---- */

typedef enum rheo_verdict { RHEO_SAME, RHEO_DIFFERS, RHEO_UNREADABLE } rheo_verdict;

/** The first difference between a recording and a replay. */
typedef struct rheo_difference {
    uint64_t step;
    char stage[32]; /**< "" if the keyframe itself does not have its recorded hash */
    char field[32];
    bool has_values;   /**< the rest is known only where the recording holds the state (a --full recording) */
    uint64_t id;       /**< particle, body, source, or the smaller id of a spring */
    uint64_t other_id; /**< larger id of a spring, else 0 */
    uint32_t component;
    double expected, actual;
    uint64_t expected_bits, actual_bits;
    uint64_t ulps;
    uint64_t count; /**< items of the field that differ at the end of this step */
} rheo_difference;

typedef struct rheo_verification {
    rheo_verdict verdict;
    uint64_t steps;        /**< steps that were compared and held */
    rheo_difference first; /**< RHEO_DIFFERS only */
    char message[512];     /**< one line for people */
} rheo_verification;

/**
 * Simulates again from the first keyframe and compares every step; checks every chunk. Damage is the verdict
 * RHEO_UNREADABLE with how many steps held. Returns other than RHEO_OK only if the system failed (file, memory).
 */
RHEO_API rheo_result rheo_verify(const char *path, rheo_verification *verification, rheo_error *error);
RHEO_API rheo_result rheo_verify_memory(const void *bytes, size_t size, rheo_verification *verification,
                                        rheo_error *error);

#ifdef __cplusplus
}
#endif
#endif
