/* The recorder of a run. record/recorder.c writes recordings, record/continue.c goes on with one. */
#ifndef RHEO__RECORD_RECORDER_H
#define RHEO__RECORD_RECORDER_H

#include "record/recording.h"

struct rheo_recorder {
    rheo_world *world;
    rheo__writer writer;
    rheo__bytes memory,
        *keep;               /* bytes of a recording without a file, and who receives them at the end; may be NULL */
    rheo__bytes step_chunks; /* chunks of a step that may still fail */
    uint64_t first_step, step, spacing;
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

/* A recorder without a file, for a recording that begins with the state of the world. NULL: no memory. */
rheo_recorder *rheo__recorder_new(rheo_world *world, const rheo_record_options *options);
/* Writes what precedes the first step. */
rheo_result rheo__recorder_begin(rheo_recorder *recorder, const rheo_record_options *options, rheo_error *error);
/* Writes the keyframe of the present step if the spacing asks for one and there is none. */
rheo_result rheo__recorder_keyframe(rheo_recorder *recorder, rheo_error *error);
/* Cuts off the end of the file that is continued, and whatever was not complete. */
rheo_result rheo__recorder_resume(rheo_recorder *recorder, rheo_error *error);

#endif
