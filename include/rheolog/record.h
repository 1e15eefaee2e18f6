/*
 * Recordings: the only kind of file. A recording holds complete states (keyframes) and, for every step, the commands,
 * the hash of every field after every stage that wrote it, and the metrics. A checkpoint is a recording with one
 * keyframe and no steps. docs/format.md describes the file to the byte.
 *
 * Unless stated otherwise, functions that return rheo_result leave the file and their results unchanged on failure
 * and return RHEO_ERROR_FILE (the system refused), RHEO_ERROR_FORMAT (no recording, or damaged),
 * RHEO_ERROR_UNSUPPORTED (this build cannot read it) or RHEO_ERROR_MEMORY. Those that simulate also return
 * RHEO_ERROR_ENVIRONMENT, as rheo_world_step(), and RHEO_ERROR_STOPPED (rheo_use_progress()). `error` may be NULL.
 */
#ifndef RHEOLOG_RECORD_H
#define RHEOLOG_RECORD_H

#include "rheolog/world.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Which files are replaced ---- */

/** What a file will be written for. */
typedef enum rheo_output_use {
    /** A new recording: RHEO_ERROR_ARGUMENT if there is a file. */
    RHEO_OUTPUT_NEW = 0,
    /** With `force`: a new recording in the place of another one. */
    RHEO_OUTPUT_REPLACE,
    /** A recording that goes on: rheo_recorder_continue(). */
    RHEO_OUTPUT_CONTINUE
} rheo_output_use;

/**
 * Whether a recording can be written to `path`, as every function that writes one asks first; ask before a long
 * calculation. RHEO_ERROR_ARGUMENT for a folder, a link that leads to no file, and a file that is no recording
 * (RHEO_OUTPUT_CONTINUE: RHEO_ERROR_FORMAT), is blessed or is being written. An empty file counts as a recording, and
 * so does one that was cut off anywhere, but one of zeros only with RHEO_OUTPUT_CONTINUE; a device is written to with
 * `force`. A link stays: the file that it leads to is replaced.
 */
RHEO_API rheo_result rheo_output_check(const char *path, rheo_output_use use, rheo_error *error);

/* ---- Checkpoints ---- */

/**
 * Saves the state of a world, which must be between two steps, as a checkpoint. Writes a new file beside `path` and
 * renames it, so that `path` never holds a part of a state. `scene`: name to store, at most 65535 bytes, or NULL
 * (RHEO_ERROR_ARGUMENT in the middle of a step, or for a longer name).
 * RHEO_ERROR_ARGUMENT if rheo_output_check() refuses the file: without `force` if it exists, with `force` unless it is a
 * recording that may be replaced.
 */
RHEO_API rheo_result rheo_world_save(const rheo_world *world, const char *scene, const char *path, bool force,
                                     rheo_error *error);

/** Saves the same bytes to memory: *bytes, *size. Release *bytes with free(). */
RHEO_API rheo_result rheo_world_save_memory(const rheo_world *world, const char *scene, void **bytes, size_t *size,
                                            rheo_error *error);

/* ---- Recording a run ---- */

/** A recorder steps a world and writes the recording of its run. */
typedef struct rheo_recorder rheo_recorder;

/** Longest text of `made_by` and `scene_text`, bytes. */
enum { RHEO_MAX_MADE_TEXT = 8000000 };

/** Options of a recording. Members that are 0 have their defaults. */
typedef struct rheo_record_options {
    /** Name to store in the file, at most 65535 bytes. NULL: "". */
    const char *scene;
    /** Steps from one keyframe to the next. Default 0: chosen so that keyframes cost about 2 % of a run. */
    uint64_t keyframe_spacing;
    /** Store the state of every step. Default false. */
    bool full;
    /**
     * Replace an existing recording (rheo_output_check()). The old file stays until the new one holds its first
     * keyframe. Default false.
     */
    bool force;
    /**
     * How the recording was made, to store in the file: a command line, or the name of the program and its arguments.
     * Equal runs have equal files only if this text has no dates and no names of folders or machines. NULL: not
     * stored. RHEO_ERROR_ARGUMENT if it is longer than RHEO_MAX_MADE_TEXT, not UTF-8, or has control characters, as for
     * `scene_text`.
     */
    const char *made_by;
    /**
     * The scene as text, to store in the file so that it can be made again; `rheolog` stores JSON. Line feeds and tabs
     * are allowed. NULL: not stored.
     */
    const char *scene_text;
    /**
     * Limit of the recording, bytes, at least rheo_recorder_least_bytes(). Default 0: none. What would exceed it makes
     * room first: the spacing of keyframes is doubled, and those in between are left out. The first keyframe, the
     * newest one and all steps remain, so verifying and comparing see the whole run, and only seeking takes longer.
     * The file is thinned beside the old one (its name and ".thinning") and renamed, so that it is complete at any
     * time; for that moment the disk needs room for both. A step that does not fit even then is undone
     * (RHEO_ERROR_LIMIT).
     *
     * With the same limit, equal runs have equal files, even if they were interrupted. A rheo_recorder_continue()
     * may set another limit. RHEO_ERROR_ARGUMENT if `path` is no regular file.
     */
    uint64_t max_bytes;
} rheo_record_options;

/**
 * The least `max_bytes` with which a recording of this world can begin, in *bytes: with its first keyframe and without
 * any step. Depends on `scene`, `made_by` and `scene_text`; `options` may be NULL for defaults. Errors as of
 * rheo_recorder_open_memory().
 */
RHEO_API rheo_result rheo_recorder_least_bytes(rheo_world *world, const rheo_record_options *options, uint64_t *bytes,
                                               rheo_error *error);

/**
 * Starts a recording of a world, which must be between two steps; its present state becomes the first keyframe.
 * `options` may be NULL for defaults. Errors as of rheo_world_save(). The file is locked until it is closed, where
 * the system has locks: other recorders refuse it, and readers see that it is being written.
 */
RHEO_API rheo_result rheo_recorder_open(rheo_world *world, const char *path, const rheo_record_options *options,
                                        rheo_recorder **recorder, rheo_error *error);

/**
 * Starts a recording in memory, of the same bytes as in a file. It grows by some bytes per particle and keyframe, and per
 * stage and step. Finish it with rheo_recorder_close_memory(); rheo_recorder_close() discards it. `force` has no meaning.
 */
RHEO_API rheo_result rheo_recorder_open_memory(rheo_world *world, const rheo_record_options *options,
                                               rheo_recorder **recorder, rheo_error *error);

/**
 * Goes on with a recording of the same run in place, whether it was closed early, killed, or truncated by a full disk,
 * so that it ends with the same bytes as if it had never stopped. Begins the recording if there is no file, or if the
 * file was left before its first keyframe was complete.
 *
 * *world must have the state and the definition with which the recording begins, and the options must be those of the
 * recording (`force`, `made_by` and `scene_text` are ignored). RHEO_ERROR_ARGUMENT if not, or if the file is blessed,
 * being written, or of another build; RHEO_ERROR_UNSUPPORTED if it is of another number type, version of the format or
 * list of stages; RHEO_ERROR_FORMAT if it is damaged; RHEO_ERROR_DIFFERS if its last step is not reproduced. Nothing
 * has changed then.
 *
 * `max_bytes` may be another one than before, and the file keeps to it from the next step on; RHEO_ERROR_ARGUMENT if
 * it is too large even with the fewest keyframes. A recording whose keyframes were thinned needs some `max_bytes`.
 *
 * On success *world is destroyed and replaced by a world with the last state that the file holds. The caller gives the
 * commands from then on. A complete file remains untouched until the next step.
 */
RHEO_API rheo_result rheo_recorder_continue(rheo_world **world, const char *path, const rheo_record_options *options,
                                            rheo_recorder **recorder, rheo_error *error);

/**
 * Makes one step of the world, as rheo_world_step(), and records it with the commands since the last step. A step
 * that fails is not recorded and may be tried again. RHEO_ERROR_ARGUMENT if the world was stepped without its
 * recorder. RHEO_ERROR_LIMIT if the step does not fit into `max_bytes`: the world and the recording stay as they were,
 * and closing completes the recording. The same holds after an error when keyframes are thinned for the step.
 */
RHEO_API rheo_result rheo_recorder_step(rheo_recorder *recorder, rheo_error *error);

/** Bytes of the file so far. */
RHEO_API uint64_t rheo_recorder_bytes(const rheo_recorder *recorder);

/**
 * Estimated bytes of the file after so many more steps, from the numbers of particles, springs and rows of history.
 * The bytes of a step are those of the steps so far; before the first one, steps of few substeps are assumed.
 * `max_bytes` is not regarded: if it is less, keyframes will be thinned.
 */
RHEO_API double rheo_recorder_expected_bytes(const rheo_recorder *recorder, uint64_t steps);
/**
 * The same for a recording of so many steps of a world that is like this one, but has so many particles and makes so many
 * substeps in a step on average; 0: two. settled: the fluid has settled before, so that the first state has springs and
 * velocities. Nothing is recorded.
 */
RHEO_API double rheo_recording_expected_bytes(const rheo_world *world, uint64_t steps, bool settled, double particles,
                                              double substeps);

/** Estimates the same with the fewest keyframes. If `max_bytes` is less, the last steps will not fit. */
RHEO_API double rheo_recorder_expected_fewest_bytes(const rheo_recorder *recorder, uint64_t steps);

/** Steps from one keyframe to the next at present: those of the options, unless keyframes were thinned. */
RHEO_API uint64_t rheo_recorder_keyframe_spacing(const rheo_recorder *recorder);

/** Number of keyframes that the recording would have without `max_bytes`, but does not have. */
RHEO_API uint64_t rheo_recorder_keyframes_left_out(const rheo_recorder *recorder);

/**
 * Writes the end of the file, closes it and releases the recorder, but not the world. If the last step that was tried
 * failed, the recording ends with that failure. Only now is the file complete. NULL is allowed.
 */
RHEO_API rheo_result rheo_recorder_close(rheo_recorder *recorder, rheo_error *error);

/**
 * Closes a recording in memory, as rheo_recorder_close(), and hands over its bytes: *bytes, *size. Release *bytes with
 * free(). After an error they are NULL and 0, and the recorder is released all the same. RHEO_ERROR_ARGUMENT for a
 * recorder that writes a file.
 */
RHEO_API rheo_result rheo_recorder_close_memory(rheo_recorder *recorder, void **bytes, size_t *size,
                                                rheo_error *error);

/**
 * The bytes that rheo_recorder_close_memory() would hand over now; the recorder goes on. So a recording in memory can be
 * played while it is made. Release *bytes with free(). Errors as of rheo_recorder_close_memory(), after which the recorder
 * goes on, too.
 */
RHEO_API rheo_result rheo_recorder_copy_memory(rheo_recorder *recorder, void **bytes, size_t *size,
                                               rheo_error *error);

/* ---- Reading ---- */

/** A recording that is open for reading. */
typedef struct rheo_recording rheo_recording;

/** What a recording has, and how it was made. */
typedef struct rheo_recording_info {
    /** Name of the scene; may be "". Valid until the recording is closed, as is `build`. */
    const char *scene;
    /** Compiler, optimisation, number type and machine of the build that wrote the file. */
    const char *build;
    /** How it was made, as of rheo_record_options; "" if that was not stored. Valid until the recording is closed. */
    const char *made_by;
    /** The scene as text, as of rheo_record_options; "" if that was not stored. Valid until the recording is closed. */
    const char *scene_text;
    /** Version of the file format. */
    uint32_t format;
    /** Bytes of a rheo_real in the file: 4 or 8. */
    uint32_t real_bytes;
    /** Step of the first keyframe. */
    uint64_t first_step;
    /** Last step that the file holds completely. */
    uint64_t last_step;
    /** Number of particles at the first keyframe. */
    uint64_t particles;
    /** Number of keyframes, at least 1. */
    uint64_t keyframes;
    /** Steps from one keyframe to the next; 0 in a checkpoint. */
    uint64_t keyframe_spacing;
    /** Estimated share of a run's time that keyframes take once the history window is full, from 0 to 1. */
    double keyframe_share;
    /** Bytes of all keyframes in the file. */
    uint64_t keyframe_bytes;
    /** Bytes of all steps in the file. */
    uint64_t step_bytes;
    /** Bytes of the file. */
    uint64_t bytes;
    /** The file holds the state of every step. */
    bool full;
    /** The world has a history. It has none if history.stiffness or springs.stiffness was 0 when it was made. */
    bool history;
    /** False: truncated, or being written. There is no end mark; everything up to last_step can be used. */
    bool complete;
    /** Not complete because a recorder is writing the file: it had these steps when it was opened. */
    bool being_written;
    /** A golden recording that was blessed; if it is not complete, its blessings may be lost. */
    bool blessed;
    /** `made_by` and `scene_text` are "" because one in the file is too long, not UTF-8 or has control characters. */
    bool made_refused;
} rheo_recording_info;

/**
 * Opens a recording for reading. A truncated file opens if its first keyframe is complete; a damaged one does not.
 * Messages begin with the path.
 */
RHEO_API rheo_result rheo_recording_open(const char *path, rheo_recording **recording, rheo_error *error);

/** Opens a recording in memory. The bytes must stay valid and unchanged until the recording is closed. */
RHEO_API rheo_result rheo_recording_open_memory(const void *bytes, size_t size, rheo_recording **recording,
                                                rheo_error *error);

/** Closes a recording. NULL is allowed. */
RHEO_API void rheo_recording_close(rheo_recording *recording);

/** Describes a recording. */
RHEO_API rheo_recording_info rheo_recording_get_info(const rheo_recording *recording);

/** The definition in force at the first keyframe, without particles. Valid until the recording is closed. */
RHEO_API const rheo_world_def *rheo_recording_definition(const rheo_recording *recording);

/** Step of keyframe `index`; of the last keyframe past the end. */
RHEO_API uint64_t rheo_recording_keyframe_step(const rheo_recording *recording, uint64_t index);

/** Number of metrics that are recorded for every step. */
RHEO_API uint32_t rheo_recording_metric_count(const rheo_recording *recording);

/** Name of a metric, as of rheo_world_metric_name(); NULL past the end. */
RHEO_API const char *rheo_recording_metric_name(const rheo_recording *recording, uint32_t index);

/** Index of a metric; rheo_recording_metric_count() if the recording does not have it. */
RHEO_API uint32_t rheo_recording_metric_by_name(const rheo_recording *recording, const char *name);

/**
 * Reads the metrics of a step from first_step to last_step: rheo_recording_metric_count() values. Nothing is
 * simulated. Also takes the step that failed (rheo_recording_failure()): metrics that its stages did not reach have
 * the values of the step before. RHEO_ERROR_ARGUMENT for any other step.
 */
RHEO_API rheo_result rheo_recording_metrics(rheo_recording *recording, uint64_t step, double *values,
                                            rheo_error *error);

/**
 * Whether the run ended because a step failed; if so, sets *failure as rheo_world_failure() did then.
 * rheo_failure_message() puts it in words.
 */
RHEO_API bool rheo_recording_failure(const rheo_recording *recording, rheo_failure *failure);

/**
 * Creates the world at a step from first_step to last_step (RHEO_ERROR_ARGUMENT for others). Starts from the nearest
 * keyframe before; from there a full recording has the stored states, any other is simulated with the recorded
 * commands. RHEO_ERROR_DIFFERS if the simulation does not reproduce the recorded hashes. `allocator` may be NULL.
 */
RHEO_API rheo_result rheo_recording_world(rheo_recording *recording, uint64_t step, const rheo_allocator *allocator,
                                          rheo_world **world, rheo_error *error);

/* ---- What was done ---- */

/** A recorded command. Members of other kinds are 0. */
typedef struct rheo_command {
    /** The command was given before this step. */
    uint64_t step;
    /** Kind of the command. */
    rheo_command_kind kind;
    /** SET: parameter, as it was given. */
    char path[48];
    /** SET: value, as it was given. */
    char value[96];
    /** PUSH_BODY, MOVE_VIBRATOR: index of the body or vibrator. ADD_PARTICLES: material, 0 for the main one. */
    uint32_t index;
    /** ADD_PARTICLES: number of particles. */
    uint32_t count;
    /** PUSH_BODY: impulse, M L/T. MOVE_VIBRATOR: new x and z, L. */
    double vector[3];
    /** PUSH_BODY: the impulse acts at `point`; else it acts at the centre. */
    bool has_point;
    /** PUSH_BODY: where the impulse acts, L. */
    double point[3];
    /** ADD_PARTICLES: lower corner of the box around their positions, L. */
    double min[3];
    /** ADD_PARTICLES: upper corner of this box, L. */
    double max[3];
    /** What was done, in words: "gravity was set to [0, -300, 0]". */
    char text[320];
} rheo_command;

/**
 * Number of recorded commands, those before the step that failed included. Adding more particles than fit into a
 * chunk of the file (43 690 in float) counts as several commands.
 */
RHEO_API uint64_t rheo_recording_command_count(const rheo_recording *recording);

/**
 * Reads command `index`, in the order in which they were given. RHEO_ERROR_ARGUMENT past the end, RHEO_ERROR_FORMAT if
 * it is damaged. Also works for recordings of the other number type.
 */
RHEO_API rheo_result rheo_recording_command(rheo_recording *recording, uint64_t index, rheo_command *command,
                                            rheo_error *error);

/**
 * Reads every chunk of a recording, up to the last complete step, and compares its check sum. Opening a recording reads
 * only what says where states and steps are. RHEO_ERROR_FORMAT if a chunk is damaged, RHEO_ERROR_FILE.
 */
RHEO_API rheo_result rheo_recording_check(rheo_recording *recording, rheo_error *error);

/* ---- Health ---- */

/**
 * A measure that left its range. A measure is a metric, or computed from metrics and parameters in force;
 * docs/debugging.md lists the ranges and how they were found. All texts are constant.
 */
typedef struct rheo_finding {
    /** Name, for example "stiffness_number". */
    const char *measure;
    /** Stage that the measure belongs to; "" if it belongs to none. */
    const char *stage;
    /** Meaning in one line. */
    const char *meaning;
    /** Largest value in range. */
    double limit;
    /** First step out of range. */
    uint64_t step;
    /** Value in that step; NaN if the recorded value is NaN. */
    double value;
    /** Particle, or smaller id of the spring, that `seen` says; -1: none. */
    int64_t id;
    /** Larger id of the spring; -1: none. */
    int64_t other_id;
    /** Step with the largest value. */
    uint64_t peak_step;
    /** Largest value in the recording. */
    double peak;
    /** Number of steps out of range. */
    uint64_t steps;
    /** The measure makes a run unhealthy; else it is a notice. */
    bool severe;
    /**
     * The measure that has seen_value at the particle or spring, in seen_step: this one, in `step`; or, since a mean or
     * a number of the parameters has no particle, another one in which it shows. "": there is no particle.
     */
    const char *seen;
    /** Step of `seen`. */
    uint64_t seen_step;
    /** Value of `seen` in that step. */
    double seen_value;
} rheo_finding;

/**
 * Describes a finding after its name: "0.42, more than 0.4, particle 17", or "0.0919, more than 0.085;
 * max_pressure_displacement is 0.35 at particle 17". Numbers have as many digits as show the difference, and a point in
 * every locale. Cut off after `size` bytes.
 */
RHEO_API void rheo_finding_text(const rheo_finding *finding, char *text, size_t size);

/**
 * A cure, estimated from the values when a measure left its range. Continue from the state at step `from`: with `set`,
 * and with the commands of step from + 1 that set other parameters; or, if `set` is "", without the commands.
 */
typedef struct rheo_advice {
    /** Assignment for rheo_world_set() or `--set`: "step=0.0135". "" if no parameter helps. */
    char set[64];
    /** Explanation. */
    char text[192];
    /** Step to continue from. Only if `can_continue`. */
    uint64_t from;
    /**
     * False: the world must be made again with `set`, because the recorded states are ill from the start or because
     * a running world cannot change the parameter; or the scene itself must change, if `set` is "". If there are
     * suspects: set it before giving these commands again, since they do not only set parameters.
     */
    bool can_continue;
} rheo_advice;

/** Most entries of a rheo_diagnosis. */
enum {
    /** Most findings. */
    RHEO_MAX_FINDINGS = 24,
    /** Most pieces of advice. */
    RHEO_MAX_ADVICE = 5,
    /** Most suspects. */
    RHEO_MAX_SUSPECTS = 4
};

/** What rheo_diagnose() found: whether a run is healthy, and if not where, when and why it went bad. */
typedef struct rheo_diagnosis {
    /** No severe measure left its range, and no step failed. */
    bool healthy;
    /** The run ended because a step failed. */
    bool failed;
    /** Where and why the step failed. Only if `failed`. */
    rheo_failure failure;
    /** False: the recording is truncated, or is being written, and was diagnosed up to last_step. */
    bool complete;
    /** Not complete because a recorder is writing it. */
    bool being_written;
    /** First step that was examined. */
    uint64_t first_step;
    /** Last step that was examined. */
    uint64_t last_step;
    /**
     * Unhealthy only: the first measure in an uninterrupted series out of range that leads up to unhealthy_step, or
     * the parameter that made it inevitable. `measure` is "" if a step failed with all measures in range.
     */
    rheo_finding cause;
    /** Unhealthy only: the step in which a severe measure left its range, or that failed. */
    uint64_t unhealthy_step;
    /** Unhealthy only: the step of the first sign, which the cause showed or, for a condition, began to be certain in. */
    uint64_t sign_step;
    /**
     * Unhealthy only: the state at first_step was already ill or about to be, so nothing that was recorded is the
     * cause. At step 0 the scene went bad while it was made, as by settling.
     */
    bool ill_from_start;
    /** Unhealthy only: number of commands before the step that commands preceded last, at most 10 before sign_step. */
    uint32_t suspect_count;
    /** The first of those commands: they may be what made the run unhealthy. */
    rheo_command suspects[RHEO_MAX_SUSPECTS];
    /** Number of findings. */
    uint32_t finding_count;
    /** All measures out of range, first step first. */
    rheo_finding findings[RHEO_MAX_FINDINGS];
    /** Number of pieces of advice. */
    uint32_t advice_count;
    /** Most effective first. */
    rheo_advice advice[RHEO_MAX_ADVICE];
    /** Summary in one line; begins with "healthy" or "unhealthy". */
    char why[2048];
} rheo_diagnosis;

/**
 * Finds where, when and why a run became unhealthy, from the recorded metrics and parameters. Nothing is simulated
 * and no state is loaded. A truncated recording is diagnosed up to its last step. RHEO_ERROR_FORMAT if a step is
 * damaged; rheo_recording_check() finds other damage.
 */
RHEO_API rheo_result rheo_diagnose(rheo_recording *recording, rheo_diagnosis *diagnosis, rheo_error *error);

/** Examines the steps of a run while they are made, by the measures that rheo_diagnose() examines in a recording. */
typedef struct rheo_health rheo_health;

/** Begins with the present state of a world, which must live longer. RHEO_ERROR_MEMORY. */
RHEO_API rheo_result rheo_health_open(const rheo_world *world, rheo_health **health, rheo_error *error);

/** Releases it. NULL is allowed. */
RHEO_API void rheo_health_close(rheo_health *health);

/**
 * Examines the last step; call it after each. True if the run is unhealthy, since this step or an earlier one; then
 * sets *finding, unless NULL, to the first severe measure that left its range. Of a step that failed, it examines what its
 * stages measured.
 */
RHEO_API bool rheo_health_step(rheo_health *health, rheo_finding *finding);

/**
 * Whether the state in which rheo_health_open() found the world may go bad: a measure that leads up to failures was out
 * of range, or a particle moves more than half a support in a step. Sets *finding, unless NULL, to a severe measure,
 * which makes the run unhealthy from there on, or else to the first one.
 */
RHEO_API bool rheo_health_start(const rheo_health *health, rheo_finding *finding);

/** A measure that the doctor examines, in the step that was examined last. All texts are constant. */
typedef struct rheo_measure {
    /** Name, for example "stiffness_number". */
    const char *name;
    /** Its meaning in one line. */
    const char *meaning;
    /** "severe", "precursor", "condition" or "notice"; docs/debugging.md says what they mean. */
    const char *kind;
    /** Largest value in range. */
    double limit;
    /** Second limit of a condition, beyond which a run is expected to go bad; NaN for other kinds. */
    double certain;
    /** The measure has a value in this step. */
    bool measured;
    /** The value, which may be NaN. Only if `measured`. */
    double value;
} rheo_measure;

/** A metric by the index of rheo_world_metric_info(), in the step that was examined last; NaN past the last. */
RHEO_API double rheo_health_metric(const rheo_health *health, uint32_t index);
/** Reads a measure by index, in or out of its range. False past the last. The model decides which there are. */
RHEO_API bool rheo_health_measure(const rheo_health *health, uint32_t index, rheo_measure *measure);

/* ---- Blessings ---- */

/** How much of a recording another program shows again (same.h). A larger number says more, so `verdict >= at_least` passes. 0 never passes. */
typedef enum rheo_sameness {
    /** Nothing was found out: the function failed, was stopped, or was not called. */
    RHEO_SAMENESS_UNKNOWN = 0,
    /** A rung was tried and failed, and none above it held. */
    RHEO_SAMENESS_DIFFERS = 1,
    /** Runs whose positions differ by rounding have the same distributions of metrics and event times. */
    RHEO_SAMENESS_STATISTICS = 2,
    /** One step differs by less than that step made in two halves does. */
    RHEO_SAMENESS_STEP = 3,
    /** One step differs by as much as rounding the state does. */
    RHEO_SAMENESS_ROUNDING = 4,
    /** Every hash is the recorded one. */
    RHEO_SAMENESS_BITS = 5
} rheo_sameness;

/** "unknown", "differs", "statistics", "step", "rounding", "bits". Never NULL. */
RHEO_API const char *rheo_sameness_name(rheo_sameness sameness);
/** The rung of that name, without "unknown"; RHEO_SAMENESS_UNKNOWN if there is none. */
RHEO_API rheo_sameness rheo_sameness_by_name(const char *name);

/** Why a golden recording was accepted. */
typedef struct rheo_blessing {
    /**
     * The reason that was given, and in brackets what was compared: the steps of both recordings and the first
     * difference. Valid until the recording is closed, as is `build`.
     */
    const char *because;
    /** The build that blessed it, as rheo_build() describes it. */
    const char *build;
    /**
     * How the build that blessed it stood to the recording before (same.h). RHEO_SAMENESS_UNKNOWN: that was not found out,
     * since there was no such recording or it was of another run.
     */
    rheo_sameness verdict;
    /** The weakest rung that it tried; RHEO_SAMENESS_UNKNOWN as for `verdict`. */
    rheo_sameness at_least;
    /** The verdict in words; "" if it is not known. */
    const char *same;
} rheo_blessing;

/** Number of blessings of a recording; 0: it is not blessed. */
RHEO_API uint32_t rheo_recording_blessing_count(const rheo_recording *recording);

/** Blessing `index`, oldest first. RHEO_ERROR_ARGUMENT past the end. */
RHEO_API rheo_result rheo_recording_blessing(const rheo_recording *recording, uint32_t index,
                                             rheo_blessing *blessing);

/* ---- Playing ---- */

/**
 * A player moves through a recording: forwards, backwards, and into a step. Steps of a full recording come from the
 * stored states. Others are simulated from the nearest keyframe with the recorded commands and compared with the
 * recorded hashes; RHEO_ERROR_DIFFERS if one differs, and the player is then at the step before.
 */
typedef struct rheo_player rheo_player;

/** Opens a player at the first step. The recording must stay open. `allocator` may be NULL. */
RHEO_API rheo_result rheo_player_open(rheo_recording *recording, const rheo_allocator *allocator,
                                      rheo_player **player, rheo_error *error);

/** Closes a player. NULL is allowed. */
RHEO_API void rheo_player_close(rheo_player *player);

/** The world at the player's position, to be queried only. Valid until the player moves. */
RHEO_API const rheo_world *rheo_player_world(const rheo_player *player);

/**
 * Moves to a step from first_step to last_step (RHEO_ERROR_ARGUMENT for others). Takes at most the time of the steps
 * between two keyframes.
 */
RHEO_API rheo_result rheo_player_seek(rheo_player *player, uint64_t step, rheo_error *error);

/** Moves one step forward; finishes a step that was begun stage by stage. RHEO_ERROR_ARGUMENT at the last step. */
RHEO_API rheo_result rheo_player_step(rheo_player *player, rheo_error *error);

/** Moves one step back. RHEO_ERROR_ARGUMENT at the first step. */
RHEO_API rheo_result rheo_player_step_back(rheo_player *player, rheo_error *error);

/**
 * Simulates the next stage of the next step; *stage is its index in rheo_world_stage(). After the last step, this
 * also plays the step that failed (rheo_recording_failure()), until a stage fails with RHEO_ERROR_STATE.
 */
RHEO_API rheo_result rheo_player_stage(rheo_player *player, uint32_t *stage, rheo_error *error);

/**
 * Moves into step `step`, right after a stage: its name, in a substep followed by @ and a number from 1
 * ("viscosity@3"; without a number the first). After the last stage the player is at the end of the step.
 * RHEO_ERROR_ARGUMENT if there is no such step, stage or substep.
 */
RHEO_API rheo_result rheo_player_seek_stage(rheo_player *player, uint64_t step, const char *stage, rheo_error *error);

/* ---- Verifying and comparing ---- */

/** Result of a comparison. */
typedef enum rheo_verdict {
    /** Nothing was compared, since the function failed or was not called. Never a success. */
    RHEO_NOT_COMPARED = 0,
    /** Every step that was compared is the same. */
    RHEO_SAME,
    /** A step differs. */
    RHEO_DIFFERS,
    /** A file is damaged, truncated or of another kind. */
    RHEO_UNREADABLE
} rheo_verdict;

/** Where the two values of a difference come from. */
typedef enum rheo_value_origin {
    /** Nowhere: only step, stage and field are known, from the hashes. */
    RHEO_VALUES_NONE = 0,
    /** Both simulated from the nearest keyframe with this build, right after the stage. */
    RHEO_VALUES_SIMULATED,
    /** One simulated; the other solved from its hash, which is possible if a single component differs. */
    RHEO_VALUES_SOLVED,
    /** Both from states that recordings hold: at the end of the step, or of a keyframe. */
    RHEO_VALUES_STORED,
} rheo_value_origin;

/** The first difference between a recording and its replay, or between two recordings. */
typedef struct rheo_difference {
    /** The step. */
    uint64_t step;
    /** Stage after which the hashes differ; "" if the states at the start differ. */
    char stage[32];
    /** Field whose hashes differ; or parameter that a later keyframe has with another value. */
    char field[64];
    /** Where the values below come from. The members below are valid unless it is RHEO_VALUES_NONE. */
    rheo_value_origin origin;
    /** Step of the values: `step`, or a later one if all stored values agree again at the end of `step`. */
    uint64_t value_step;
    /** Field of the values. Not always `field`, which may agree again at the end of the step. */
    char value_field[32];
    /** Particle, body, vibrator, or smaller id of a spring. */
    uint64_t id;
    /** Larger id of a spring, else 0. */
    uint64_t other_id;
    /** Component of the field, from 0: of the values of the item, the one that differs most. */
    uint32_t component;
    /** Value in the recording, or in the first recording. */
    double expected;
    /** Value in the replay, or in the second recording. */
    double actual;
    /** `expected` as bits. */
    uint64_t expected_bits;
    /** `actual` as bits. */
    uint64_t actual_bits;
    /** Only the recording, or the first recording, has the item; `actual` is 0. */
    bool only_expected;
    /** Only the replay, or the second recording, has the item; `expected` is 0. */
    bool only_actual;
    /**
     * Distance in units of the last place; UINT64_MAX where there is none (NaN, an item on one side only). It means
     * little near 0 and across it.
     */
    uint64_t ulps;
    /** Number of items of the field that differ. */
    uint64_t count;
    /** Largest difference of two values of the field, in its unit. */
    double largest;
    /** Largest magnitude of the field's values at that place of either side, in its unit; 0: not known. */
    double scale;
    /** What `id` is an id of. */
    rheo_location location;
} rheo_difference;

/** How much of a field differs at the end of a step. */
typedef struct rheo_growth {
    /** The step. */
    uint64_t step;
    /** Name of the field. */
    char field[32];
    /** Number of items that differ. */
    uint64_t count;
    /** Largest difference in units of the last place. */
    uint64_t ulps;
    /** Largest difference, in the field's unit. */
    double largest;
    /** Largest magnitude of the field's values of either side, in its unit; 0: not known. */
    double scale;
} rheo_growth;

/** A parameter with which two recordings begin differently. */
typedef struct rheo_parameter_difference {
    /** The parameter. */
    const rheo_parameter *parameter;
    /** Value in the first recording, as rheo_world_def_get() writes it. */
    char a[96];
    /** Value in the second recording. */
    char b[96];
} rheo_parameter_difference;

/** Most entries of a rheo_verification. */
enum {
    /** Most entries of `growth`. */
    RHEO_MAX_GROWTH = 96,
    /** Most entries of `parameters`. */
    RHEO_MAX_PARAMETER_DIFFERENCES = 64
};

/**
 * Result of rheo_verify() and rheo_diff(). If they return an error: RHEO_NOT_COMPARED, with the error in `message`.
 * After RHEO_ERROR_STOPPED, `steps` were the same until then.
 */
typedef struct rheo_verification {
    /** The result. */
    rheo_verdict verdict;
    /** Number of steps that were compared and agree. */
    uint64_t steps;
    /** rheo_verify() only: `hash` is valid; false if the last step failed or none was compared. */
    bool has_hash;
    /** Hash of this build's state after the last step that was compared, equal or not. */
    uint64_t hash;
    /** The first difference. RHEO_DIFFERS only. */
    rheo_difference first;
    /**
     * rheo_diff() only: RHEO_DIFFERS only because one recording has steps that the other lacks. Those that both have
     * agree. `first.step` is the first that only one has.
     */
    bool lengths_differ;
    /** rheo_diff() only: first steps of the first and of the second recording. */
    uint64_t first_step[2];
    /** rheo_diff() only: their last steps. */
    uint64_t last_step[2];
    /** Number of entries of `growth`. */
    uint32_t growth_count;
    /** Growth of the difference: in its step and 1, 2, 4, 8 ... steps later, where both states are known. */
    rheo_growth growth[RHEO_MAX_GROWTH];
    /** rheo_diff() only: the recordings were given different commands up to the first difference. */
    bool commands_differ;
    /** First step whose commands differ. */
    uint64_t commands_step;
    /** rheo_diff() only: number of entries of `parameters`. */
    uint32_t parameter_count;
    /** Parameters that differ at the start, for any verdict. */
    rheo_parameter_difference parameters[RHEO_MAX_PARAMETER_DIFFERENCES];
    /** rheo_diff() only: `cause` is valid, since states and parameters at the start differ. */
    bool has_cause;
    /** Where the different parameters show first if both runs start from the first recording's state. */
    rheo_difference cause;
    /**
     * Build that wrote the recording, and this build; or of rheo_diff(), those that wrote the two. As of rheo_build().
     * "" if the verdict is RHEO_NOT_COMPARED, or a file could not be read so far.
     */
    char build[2][160];
    /** Summary in one line; begins: "same", "differs", "unreadable" or "not compared". */
    char message[768];
} rheo_verification;

/**
 * Simulates a recording from its first keyframe, compares every step and checks every chunk. A damaged or truncated
 * file has the verdict RHEO_UNREADABLE, with the number of steps that agree before the fault. Returns an error only
 * if the system failed, RHEO_ERROR_FILE, RHEO_ERROR_MEMORY or RHEO_ERROR_ENVIRONMENT, or RHEO_ERROR_STOPPED.
 */
RHEO_API rheo_result rheo_verify(const char *path, rheo_verification *verification, rheo_error *error);

/** Verifies a recording in memory, with the errors of rheo_verify(). */
RHEO_API rheo_result rheo_verify_memory(const void *bytes, size_t size, rheo_verification *verification,
                                        rheo_error *error);

/**
 * Compares two recordings. `expected` values are those of the first, `actual` those of the second. Recordings of
 * different lengths differ; where steps that only one has do not matter, accept `lengths_differ`. Values are simulated
 * where this build reproduces the hashes, else solved from a hash, else read from the stored states of full recordings.
 * Errors as of rheo_verify().
 */
RHEO_API rheo_result rheo_diff(const char *path_a, const char *path_b, rheo_verification *verification,
                               rheo_error *error);

/** Compares two recordings in memory, with the errors of rheo_verify(). */
RHEO_API rheo_result rheo_diff_memory(const void *a, size_t size_a, const void *b, size_t size_b,
                                      rheo_verification *verification, rheo_error *error);

/**
 * For tests: RHEO_OK if the verdict is RHEO_SAME and at least `steps` steps were compared; else RHEO_ERROR_DIFFERS with
 * the reason. So a test also fails if a file is missing or damaged, or has become shorter, and needs no other check.
 */
RHEO_API rheo_result rheo_verification_check(const rheo_verification *verification, uint64_t steps,
                                             rheo_error *error);

/* ---- Golden recordings ---- */

/** A run that is compared with a golden recording while it goes on: a test of your scene and your code. */
typedef struct rheo_golden rheo_golden;

/**
 * Begins to compare a world, which must be between two steps (else RHEO_ERROR_ARGUMENT), with the golden recording at
 * `path`. RHEO_ERROR_DIFFERS if the world is not in the state with which the recording begins, RHEO_ERROR_FORMAT if the
 * file is damaged or truncated, RHEO_ERROR_UNSUPPORTED if it is of another number type or of a world with other stages.
 */
RHEO_API rheo_result rheo_golden_open(rheo_world *world, const char *path, rheo_golden **golden, rheo_error *error);

/**
 * Makes one step of the world, as rheo_world_step(), with the commands since the last step, and compares every stage
 * with the recording. RHEO_ERROR_DIFFERS at the first difference, with the message of rheo_diff(): step, stage, field,
 * item and both values; the recording is "the golden recording", the world "this run". Then every further call returns
 * the same and makes no step. A step past the end of the recording differs, too. Other errors as of
 * rheo_recorder_step(): a step that fails, and RHEO_ERROR_ARGUMENT if the world was stepped otherwise.
 */
RHEO_API rheo_result rheo_golden_step(rheo_golden *golden, rheo_error *error);

/**
 * Ends the comparison and releases it, but not the world. RHEO_OK only if the run has made every step of the recording
 * and nothing differs; else RHEO_ERROR_DIFFERS with the reason. *verification, unless NULL: as of rheo_diff(); `steps`
 * were compared. NULL instead of a comparison, after rheo_golden_open() has failed, is RHEO_ERROR_ARGUMENT.
 */
RHEO_API rheo_result rheo_golden_close(rheo_golden *golden, rheo_verification *verification, rheo_error *error);

/**
 * Makes a recording again with this build, from the first state, the commands before each step, and the options of
 * old_path, which must be complete. `full`: with the state of every step, even if old_path has none. If a step fails
 * in this build, new_path ends with that failure. *difference: how new_path differs from old_path. Writes beside and renames. `force` and errors as of rheo_world_save() and
 * rheo_diff(); RHEO_ERROR_FORMAT if a command cannot be given again.
 */
RHEO_API rheo_result rheo_rerecord(const char *old_path, const char *new_path, bool full, bool force,
                                   rheo_verification *difference, rheo_error *error);

/**
 * Replaces the recording old_path, which need not exist, by new_path with the reason and this build written into it,
 * after the blessings that old_path and new_path have. This is the only way to replace a blessed recording.
 *
 * new_path must be complete and this build must verify it as the same (else RHEO_ERROR_DIFFERS or RHEO_ERROR_FORMAT);
 * it is left unchanged. RHEO_ERROR_ARGUMENT if `because` does not have 1 to 4096 bytes, if old_path is being written
 * or was replaced meanwhile, or, without `shrink`, if old_path cannot be read to its end or would come to hold less: fewer steps or fields, or no
 * state of every step; with `shrink`, too, if it is no recording. Writes nothing if old_path is blessed already and has
 * the same steps, in the same form. A link at old_path stays, and so does the file's mode. *difference: how new_path differs from old_path; RHEO_NOT_COMPARED if there is no old_path.
 */
RHEO_API rheo_result rheo_bless(const char *old_path, const char *new_path, const char *because, bool shrink,
                                rheo_verification *difference, rheo_error *error);

#ifdef __cplusplus
}
#endif
#endif
