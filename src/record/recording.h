/* Private declarations of an open recording, and the functions that the files of this folder share. */
#ifndef RHEO__RECORD_RECORDING_H
#define RHEO__RECORD_RECORDING_H

#include "rheolog/record.h"
#include "record/chunk.h"
#include "record/head.h"
#include "record/made.h"
#include "record/pieces.h"
#include "record/values.h"
#include "world/stage_runs.h"

/* ---- Keyframes (record/keyframe.c) ---- */

/* The numbers in a KEYF chunk, and the offsets of it and its pieces. */
typedef struct rheo__keyframe {
    uint64_t step, start, offset, end;
    uint64_t particles, bodies, vibrators, springs, rows, chunks;
    uint64_t raw; /* bytes of its pieces: no more is allocated for it */
} rheo__keyframe;

/* Writes the state of a world: pieces, then KEYF. */
rheo_result rheo__keyframe_write(rheo__writer *writer, const rheo_world *world, rheo_error *error);
/* Reads the counts of a KEYF chunk. */
void rheo__keyframe_get(rheo__cursor *cursor, rheo__keyframe *keyframe);
/* Reads field hashes (field_count), metrics (metric_count) and the parameters in force; any may be NULL. */
rheo_result rheo__keyframe_read(rheo_recording *r, const rheo__keyframe *k, uint64_t *hashes, double *metrics,
                                rheo_world_def *def, rheo_error *error);
/* Creates the world of a keyframe. */
rheo_result rheo__keyframe_world(rheo_recording *r, const rheo__keyframe *k, const rheo_allocator *allocator,
                                 rheo_world **world, rheo_error *error);
/*
 * Compares a world, which has the recorded fields, with a keyframe: *field is the first field with another hash, or
 * RHEO__FIELD_COUNT if all hashes and all stored values agree.
 */
rheo_result rheo__keyframe_compare(rheo_recording *r, const rheo__keyframe *k, const rheo_world *world,
                                   rheo__field_id *field, rheo_error *error);

/* Reads the values of a keyframe, without rings; `world` has the recorded fields. */
rheo_result rheo__keyframe_values(rheo_recording *r, const rheo__keyframe *k, const rheo_world *world,
                                  rheo__values *values, rheo_error *error);

/*
 * Estimated cost of a keyframe and of a step, ns per particle. Measured: 2 ns per byte of history (writing it, and
 * the cache misses that this causes in the next step) and 8 ns per byte of other fields (zlib, sorting), with 16
 * springs per particle.
 */
enum { RHEO__STEP_COST = 400 };
uint64_t rheo__keyframe_cost(uint64_t real_bytes, uint64_t rows, bool springs);

/* ---- The state of every step (record/fullstate.c) ---- */

/* Writes the changes from one state to the next, without rings. `present`: the fields of the world. */
rheo_result rheo__full_write(rheo__pieces_writer *pieces, rheo__fields present, const rheo__values *before,
                             const rheo__values *now, double step, rheo_error *error);
/* Reads them. `raw`: bytes of the pieces; no more is allocated for them. */
rheo_result rheo__full_read(rheo__pieces_reader *pieces, rheo__fields present, uint64_t raw,
                            const rheo__values *before, rheo__values *now, rheo_error *error);

/*
 * Puts a stored state into a world that is at the step before and was given the commands of the step. `own`: fields that
 * the world makes itself, of the history, and that need not have the recorded hashes.
 */
rheo_result rheo__full_restore(rheo_recording *r, uint64_t step, const rheo__values *now, rheo__fields own,
                               rheo_world *world, rheo_error *error);

/* ---- How a recording ends (record/ending.c) ---- */

rheo_result rheo__failure_write(rheo__writer *writer, const rheo_failure *failure, uint32_t inputs,
                                const double *metrics, uint32_t metric_count, rheo_error *error);
/* False: damaged. */
bool rheo__failure_get(rheo__cursor *cursor, rheo_failure *failure, uint32_t *inputs, double *metrics,
                       uint32_t metric_count);
/* With its verdict, if that is known. */
rheo_result rheo__blessing_write(rheo__writer *writer, uint64_t step, const rheo_blessing *blessing,
                                 rheo_error *error);
/* Reads a blessing and adds it to the recording. */
rheo_result rheo__blessing_get(rheo__cursor *cursor, rheo_recording *recording, rheo_error *error);
/* Reads the verdict of the last blessing. */
rheo_result rheo__same_get(rheo__cursor *cursor, rheo_recording *recording, rheo_error *error);
void rheo__blessings_release(rheo_recording *recording);
/* Writes GOLD. */
rheo_result rheo__golden_write(rheo__writer *writer, rheo_error *error);
/* Whether a file is a blessed recording, however much of it is lost: it has GOLD or BLES, or the start of one. */
bool rheo__reader_is_blessed(rheo__reader *reader);

/* ---- Members (record/members_file.c) ---- */

struct rheo__members;
/* Reads MEMB and makes them with malloc. Nothing needs to be released after a failure. */
rheo_result rheo__members_get(rheo__cursor *cursor, struct rheo__members **members, rheo_error *error);
/* Releases them and their contents. NULL is allowed. */
void rheo__members_destroy(struct rheo__members *members);

/* ---- An open recording ---- */

typedef struct rheo__step_chunks {
    uint64_t start, offset; /* offsets of its first chunk, and of STEP */
    uint64_t raw;           /* bytes of its STAT chunks */
    uint32_t inputs, states;
} rheo__step_chunks;

/* steps[step] is preceded by commands, the first of which is number `first`. */
typedef struct rheo__commanded {
    size_t step;
    uint64_t first;
} rheo__commanded;

struct rheo_recording {
    rheo__reader reader;
    rheo__head head;
    rheo__made made;
    rheo_world_def def; /* definition in force at the first keyframe */
    rheo__keyframe *keyframes;
    rheo__step_chunks *steps; /* steps[n] is step first_step + 1 + n */
    size_t keyframe_count, keyframe_capacity, step_count, step_capacity;
    rheo__commanded *commanded; /* steps that commands precede */
    size_t commanded_count, commanded_capacity;
    uint64_t command_count;             /* without those of the failed step */
    uint64_t next_command, next_offset; /* the command after the one that was read last */
    uint64_t first_step, last_step;
    uint64_t keyframe_bytes, step_bytes;
    uint64_t end;             /* offset past the last step, keyframe or failure */
    rheo_failure failure;     /* failure of the step after last_step */
    rheo__step_chunks failed; /* its commands */
    rheo_blessing *blessings;
    uint32_t blessing_count;
    bool golden;                   /* GOLD: it was blessed, even if the blessings at its end are lost */
    struct rheo__members *members; /* MEMB: runs that show what is chance; NULL: none */
    uint64_t members_start, members_end;
    uint64_t head_end; /* offset past HEAD */
    uint64_t last_hash;
    bool has_failure, has_last_hash;
    bool complete;
    rheo_error fault; /* reason why the recording is not complete, and its code */
    rheo_result fault_result;
    rheo__bytes payload;
    uint64_t *expected; /* hashes of a step */
    size_t expected_count, expected_capacity;
    double *metrics;          /* metric_count */
    rheo__values before, now; /* full only: the state before a step and after it */
};

/* Copies an error with the name of the file in front. Returns `result`; does nothing for RHEO_OK. */
rheo_result rheo__in_file(const char *path, rheo_result result, const rheo_error *why, rheo_error *error);
/* RHEO_ERROR_ARGUMENT if the recording does not have the step. */
rheo_result rheo__recording_check_step(const rheo_recording *r, uint64_t step, rheo_error *error);

/* ---- Scanning (record/scan.c) ---- */

/*
 * Scans a recording whose reader is open. `thorough`: checks every chunk. A fault after the first keyframe is no
 * error here: the recording is incomplete and ends before the fault, r->fault has the message, and *damaged is
 * false if the file is only cut off.
 */
rheo_result rheo__recording_scan(rheo_recording *r, bool thorough, bool *damaged, rheo_error *error);
/* Reads the STEP of steps[index] into r->expected and r->metrics. */
rheo_result rheo__recording_read_step(rheo_recording *r, size_t index, rheo_error *error);
/* "damaged: the chunk STEP at byte 17 <fault>"; returns RHEO_ERROR_FORMAT. */
rheo_result rheo__chunk_damaged(const rheo__chunk *chunk, const char *fault, rheo_error *error);

/* ---- Replaying (record/replay.c) ---- */

/* No hash of a step differs. */
#define RHEO__NO_HASH SIZE_MAX
/*
 * Reads the next command of a step into r->payload, from offset *offset on, which starts as chunks->start and is
 * moved past the command. *more: there is one.
 */
rheo_result rheo__recording_next_command(rheo_recording *r, const rheo__step_chunks *chunks, uint64_t step,
                                         uint64_t *offset, bool *more, rheo_error *error);
/* Gives the world the commands of a step. */
rheo_result rheo__recording_command(rheo_recording *r, const rheo__step_chunks *chunks, uint64_t step,
                                    rheo_world *world, rheo_error *error);
/*
 * Full only: the stored state after steps[index] into *now, from the state before it. `present`: the world's
 * fields.
 */
rheo_result rheo__recording_read_state(rheo_recording *r, size_t index, rheo__fields present,
                                       const rheo__values *before, rheo__values *now, rheo_error *error);
/*
 * Gives the commands of steps[index] and steps the world. *different: the first hash of the trace that is not the
 * recorded one, and the world is right after that stage run; or RHEO__NO_HASH, and the step is done.
 */
rheo_result rheo__recording_replay(rheo_recording *r, size_t index, rheo_world *world, size_t *different,
                                   rheo_error *error);
/*
 * Moves the world one step forward: to the stored state, if there is one, else by simulation (RHEO_ERROR_DIFFERS if
 * it does not reproduce the recorded hashes). After an error the world must not be used.
 */
rheo_result rheo__recording_forward(rheo_recording *r, size_t index, rheo_world *world, rheo_error *error);
/* "step 7 is not as it was recorded: ..."; returns RHEO_ERROR_DIFFERS. */
rheo_result rheo__recording_differs(const rheo_world *world, uint64_t step, size_t different, rheo_error *error);
/* "damaged: step 7 has ... hashes": the step has more hashes than its substeps make; returns RHEO_ERROR_FORMAT. */
rheo_result rheo__recording_too_many(const rheo_recording *r, uint64_t step, rheo_error *error);
/* The nearest keyframe at or before a step of the recording. */
size_t rheo__recording_nearest(const rheo_recording *r, uint64_t step);

/* ---- Playing (record/player.c) ---- */

rheo_recording *rheo__player_recording(const rheo_player *player);
/* Refuses a name that is no stage, as of rheo_player_seek_stage(). */
rheo_result rheo__player_check_stage(const rheo_player *player, const char *name, rheo_error *error);
struct rheo__account;
/*
 * Makes a step again, or a step that failed, and keeps the account of its particle (core/account.h). Then the player is at the
 * end of the step, or at that of the step before.
 */
rheo_result rheo__player_step_account(rheo_player *player, uint64_t step, struct rheo__account *account,
                                      rheo_error *error);
/* Makes another player at the same step; if the first is in the middle of one, at the keyframe before it. */
rheo_result rheo__player_copy(const rheo_player *player, rheo_player **copy, rheo_error *error);
/* The player becomes the other one, which is released. */
void rheo__player_take_over(rheo_player *player, rheo_player *from);
/* For a search that wants the last place: keeps the present state, unless one was kept less than `apart` steps before it. */
void rheo__player_keep(rheo_player *player, uint64_t apart);
/* The search has found a place: what was kept last leads to it, and stays until there is another place. */
void rheo__player_keep_found(rheo_player *player);

/* ---- Commands in a file (record/commands.c) ---- */

rheo_result rheo__command_write(rheo__writer *writer, uint64_t step, const rheo__command *command, uint32_t *chunks,
                                rheo_error *error);
rheo_result rheo__command_apply(rheo__cursor *cursor, rheo_world *world, rheo_error *error);
/* Reads a command of a recording with reals of this size, and puts it in words. */
rheo_result rheo__command_describe(rheo__cursor *cursor, uint64_t step, size_t real_bytes, rheo_command *command,
                                   rheo_error *error);

/* ---- Comparing (record/compare.c) ---- */

/* Largest difference of two values of a field, in ulps and as a number, and the field's largest magnitude. */
typedef struct rheo__sizes {
    uint64_t ulps;
    double largest, scale;
} rheo__sizes;

/*
 * Returns the number of items of a field that differ. Sets *first, unless NULL or none differs, to the first of them
 * with the origin `known`, and *sizes, unless NULL.
 */
uint64_t rheo__compare_field(rheo__field_id field, const rheo__values *expected, const rheo__values *actual,
                             rheo_value_origin known, rheo_difference *first, rheo__sizes *sizes);
/* Finds the first field that differs, beginning with `field`; false if none does. */
bool rheo__compare_values(rheo__field_id field, const rheo__values *expected, const rheo__values *actual,
                          rheo_value_origin known, rheo_difference *first);
/* Appends the fields that differ at the end of a step to the growth. */
void rheo__compare_growth(rheo_verification *v, uint64_t step, const rheo__values *expected,
                          const rheo__values *actual);
/*
 * Finds the first field of a world but for `except`, at the end of the step of r->expected, whose hash differs from the
 * recorded hash after the last stage that wrote it. *expected becomes the recorded hash. RHEO__FIELD_COUNT: none differs.
 */
rheo__field_id rheo__recording_wrong_field(const rheo_recording *r, const rheo_world *world, rheo__fields except,
                                           uint64_t *expected);
/* Sets the members of a difference that hashes determine. */
void rheo__difference_locate(rheo_difference *d, uint64_t step, const char *stage, rheo__field_id field);
/* Solves for the one component that explains another hash, expected or actual, of a field. False: none does. */
bool rheo__difference_solve(rheo_difference *d, const rheo__state *state, rheo__field_id field, uint64_t hash,
                            bool hash_is_expected);
/*
 * Writes the message of a difference. The names are those of the two sides: "the recording". `agreed`: last step at
 * whose end the values agree again, or 0; `full`: both sides have the state of every step.
 */
void rheo__difference_describe(rheo_verification *v, const char *const names[2], uint64_t agreed, bool full);
/* Stores the builds of the two sides, and names them in the message of a difference if they are not the same. */
void rheo__name_builds(rheo_verification *v, const char *const names[2], const char *a, const char *b);
/* Makes an error the verdict RHEO_NOT_COMPARED, with its message, and returns it. Does nothing for RHEO_OK. */
rheo_result rheo__not_compared(rheo_verification *v, rheo_result result, const rheo_error *why, rheo_error *error);
/* Makes an error in a file the verdict RHEO_UNREADABLE; returns the error if the system failed. */
rheo_result rheo__unreadable(rheo_verification *v, rheo_result result, const rheo_error *why, rheo_error *error);

/* ---- Verifying (record/verify.c) ---- */

/* Whether two steps failed at the same place for the same reason. */
bool rheo__same_failure(const rheo_failure *a, const rheo_failure *b);
/* Verifies a recording with `world`, which is at the first keyframe and is not destroyed. */
rheo_result rheo__verify_world(rheo_recording *r, rheo_world *world, rheo_verification *v, rheo_error *error);

/* ---- Writing (record/recorder.c) ---- */

/* Appends a keyframe to the index. */
void rheo__index_put(rheo__bytes *index, uint64_t step, uint64_t start, uint64_t end);
/* Writes the index and the end mark. `hash` of the last state: NULL if it is not known. */
rheo_result rheo__recording_write_end(rheo__writer *writer, const rheo__bytes *index, uint64_t first_step,
                                      uint64_t last_step, const uint64_t *hash, rheo_error *error);

/* ---- Writing one again with other chunks (record/rewrite.c) ---- */

rheo_result rheo__recording_copy(rheo_recording *from, uint64_t offset, uint64_t end, rheo__writer *to,
                                 rheo_error *error);
/* Writes the index and the end mark; the bytes of the keyframes were moved by so much (modulo 2^64). */
rheo_result rheo__recording_copy_end(const rheo_recording *r, uint64_t moved, rheo__writer *to, rheo_error *error);
/* A file that was read-only stays so when it is written again. */
void rheo__keep_mode(const char *path, rheo__writer *to);

/* ---- Comparing two (record/diff.c) ---- */

/* The names are those of the two sides in the message: "the first", "the second". */
rheo_result rheo__diff_recordings(rheo_recording *a, rheo_recording *b, const char *const names[2],
                                  rheo_verification *v, rheo_error *error);

#endif
