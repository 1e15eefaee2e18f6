/* Inside a recording that is read, and what the files of this folder share. */
#ifndef RHEO_RECORD_RECORDING_H
#define RHEO_RECORD_RECORDING_H

#include "rheolog/record.h"
#include "record/chunk.h"
#include "record/head.h"
#include "record/pieces.h"
#include "record/values.h"

/* ---- Keyframes (record/keyframe.c) ---- */

/* The KEYF chunk, and where it and its pieces are. */
typedef struct rheo_keyframe {
    uint64_t step, start, at, end;
    uint64_t particles, bodies, sources, springs, rows, chunks;
    uint64_t raw; /* bytes of its pieces: nothing larger is allocated for it */
} rheo_keyframe;

/* Writes the state of a world: pieces, then KEYF. */
rheo_result rheo_keyframe_write(rheo_writer *writer, const rheo_world *world, rheo_error *error);
/* The counts from a KEYF chunk's payload. */
void rheo_keyframe_get(rheo_cursor *cursor, rheo_keyframe *keyframe);
/* Field hashes (field_count), metrics (metric_count) and the parameters in force; any may be NULL. */
rheo_result rheo_keyframe_read(rheo_recording *r, const rheo_keyframe *k, uint64_t *hashes, double *metrics,
                               rheo_world_def *def, rheo_error *error);
/* The world of a keyframe. */
rheo_result rheo_keyframe_world(rheo_recording *r, const rheo_keyframe *k, const rheo_allocator *allocator,
                                rheo_world **world, rheo_error *error);
/*
 * Compares a world, which has the recorded fields, with a keyframe: *field is the first field with another
 * hash, or RHEO_FIELD_COUNT; the pieces have been compared as well then.
 */
rheo_result rheo_keyframe_compare(rheo_recording *r, const rheo_keyframe *k, const rheo_world *world,
                                  rheo_field_id *field, rheo_error *error);

/* ---- The state of every step (record/fullstate.c) ---- */

/* Writes what has changed from one state to the next, without rings. `present`: the fields of the world. */
rheo_result rheo_full_write(rheo_pieces_writer *pieces, uint32_t present, const rheo_values *before,
                            const rheo_values *now, double step, rheo_error *error);
/* The reverse; `raw`: bytes of the pieces, nothing larger is allocated for them. */
rheo_result rheo_full_read(rheo_pieces_reader *pieces, uint32_t present, uint64_t raw, const rheo_values *before,
                           rheo_values *now, rheo_error *error);

/* ---- Recordings (record/recording.c) ---- */

typedef struct rheo_step_place {
    uint64_t start, at; /* of its first chunk, and of STEP */
    uint64_t raw;       /* bytes of its STAT chunks */
    uint32_t inputs, states;
} rheo_step_place;

struct rheo_recording {
    rheo_reader reader;
    rheo_head head;
    rheo_world_def def; /* in force at the first keyframe */
    rheo_keyframe *keyframes;
    rheo_step_place *steps; /* steps[n] is step first_step + 1 + n */
    size_t keyframe_count, keyframe_capacity, step_count, step_capacity;
    uint64_t first_step, last_step;
    uint64_t keyframe_bytes, step_bytes;
    uint64_t last_hash;
    bool has_last_hash;
    bool whole;
    rheo_error fault; /* why it is not whole */
    rheo_bytes payload;
    uint64_t *expected, *actual; /* trace_count hashes */
    double *metrics;             /* metric_count */
};

/*
 * Opens a recording that the caller has filled the reader of. `thorough`: checks every chunk. A fault after
 * the first keyframe is no error here: the recording is not whole then and ends before it; *damaged tells
 * damage from a tear.
 */
rheo_result rheo_recording_scan(rheo_recording *r, bool thorough, bool *damaged, rheo_error *error);
/* Reads the STEP of steps[index] into r->expected and r->metrics. */
rheo_result rheo_recording_read_step(rheo_recording *r, size_t index, rheo_error *error);
/* Changes a definition as the commands of steps[index] do; *moves: they can throw particles by themselves. */
rheo_result rheo_recording_define(rheo_recording *r, size_t index, rheo_world_def *def, bool *moves, rheo_error *error);
/*
 * Applies the commands of steps[index] and steps the world. *different: the first hash of the trace that is
 * not the recorded one, or trace_count. If the step itself fails, *different is set as far as it came.
 */
rheo_result rheo_recording_replay(rheo_recording *r, size_t index, rheo_world *world, uint32_t *different,
                                  rheo_error *error);

/* ---- Commands in a file (record/commands.c) ---- */

rheo_result rheo_command_write(rheo_writer *writer, uint64_t step, const rheo_command *command, uint32_t *chunks,
                               rheo_error *error);
rheo_result rheo_command_apply(rheo_cursor *cursor, rheo_world *world, rheo_error *error);
/* What a command does to a definition: a parameter that it sets. *moves: it can throw particles by itself. */
rheo_result rheo_command_define(rheo_cursor *cursor, uint64_t step, rheo_world_def *def, bool *moves, rheo_error *error);

/* ---- Verifying (record/verify.c) ---- */

/* Steps `world`, which stands at the first keyframe, through the recording; destroys nothing. */
rheo_result rheo_verify_world(rheo_recording *r, rheo_world *world, rheo_verification *v, rheo_error *error);

#endif
