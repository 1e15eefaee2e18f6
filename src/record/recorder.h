/*
 * The recorder of a run. record/recorder.c writes recordings, record/continue.c goes on with one, record/limit.c keeps
 * one within a limit of bytes.
 */
#ifndef RHEO__RECORD_RECORDER_H
#define RHEO__RECORD_RECORDER_H

#include "record/recording.h"

struct rheo_recorder {
    rheo_world *world;
    rheo__writer writer;
    rheo__bytes memory,
        *keep;               /* bytes of a recording without a file, and who receives them at the end; may be NULL */
    rheo__bytes step_chunks; /* chunks of a step that may still fail */
    uint64_t first_step, step;
    uint64_t spacing, asked_spacing; /* thinning makes the first larger than the second */
    uint64_t limit;                  /* of the bytes; 0: none */
    char *path, *beside;             /* with a limit: names of the file, and of a thinned one beside it */
    bool unthinned;                  /* thinning has failed, which leaves the file as it was */
    bool full;
    uint64_t last_keyframe;
    uint64_t step_bytes, steps; /* written by this recorder: bytes of steps, and their number */
    rheo_failure failure;       /* failure of the last step tried; its commands are in step_chunks */
    uint32_t failure_commands;
    double *failure_metrics;
    bool failed;
    size_t commands_before;   /* commands given before the recording began, which are part of the first keyframe */
    rheo__values before, now; /* full only */
    rheo__known_order order;  /* full only */
    rheo__bytes index;
    rheo_result broken; /* a write failed with this result: nothing more is added to the file */
    bool unresumed;     /* continues a file that has not been touched yet */
    uint64_t resume;    /* its bytes that remain */
};

/* The default spacing: keyframes should cost about 2 % of a run. From sizes only, so that equal runs have equal files. */
uint64_t rheo__recorder_spacing(const rheo_world *world);
/* A recorder without a file, for a recording that begins with the state of the world. NULL: no memory. */
rheo_recorder *rheo__recorder_new(rheo_world *world, const rheo_record_options *options);
/* Writes what precedes the first step. */
rheo_result rheo__recorder_begin(rheo_recorder *recorder, const rheo_record_options *options, rheo_error *error);
/* Writes the keyframe of the present step if the spacing asks for one and there is none. */
rheo_result rheo__recorder_keyframe(rheo_recorder *recorder, rheo_error *error);
/* Cuts off the end of the file that is continued, and whatever was not complete. */
rheo_result rheo__recorder_resume(rheo_recorder *recorder, rheo_error *error);

/* ---- The limit of the bytes (record/limit.c) ---- */

/*
 * RHEO_ERROR_ARGUMENT if the limit is too low for the first keyframe, or a file that is no rest of thinning has the
 * name of a thinned one. `path` may be NULL.
 */
rheo_result rheo__limit_check_options(rheo_world *world, const char *path, const rheo_record_options *options,
                                      rheo_error *error);
/* RHEO_ERROR_ARGUMENT if the limit is too low for the file that is continued, even with the fewest keyframes. */
rheo_result rheo__limit_check_continued(const rheo_recorder *recorder, rheo_error *error);
/* Whether this run may have written a recording with this spacing: its own, or one that thinning has doubled. */
bool rheo__limit_allows_spacing(const rheo_recorder *recorder, uint64_t recorded);
/* Bytes of all keyframes but the first. */
uint64_t rheo__limit_removable_bytes(const rheo_recorder *recorder);
/* Keeps the name of the file, which was opened and locked. */
rheo_result rheo__limit_keep_path(rheo_recorder *recorder, const char *path, rheo_error *error);

/* With a limit only: thins keyframes until so many bytes and the end fit. RHEO_ERROR_LIMIT: they never do. */
rheo_result rheo__limit_make_room(rheo_recorder *recorder, uint64_t bytes, rheo_error *error);
/* Does that for the step that is being made; a rheo__step_check. */
rheo_result rheo__limit_check_step(void *recorder, rheo_error *error);
/*
 * Writes a keyframe of the present step if it fits. If it is due, others are thinned for it; it is left out, too, where
 * the spacing becomes so large that it is not due any more.
 */
rheo_result rheo__limit_keyframe(rheo_recorder *recorder, bool due, rheo_error *error);

#endif
