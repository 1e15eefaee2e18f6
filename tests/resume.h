/* Resumes a run from every step of its recording. */
#ifndef RHEO__TESTS_RESUME_H
#define RHEO__TESTS_RESUME_H

#include "support.h"

enum { RESUME_MOST = 64 };

/* Steps a world to the end. Every state must be that of the run. Destroys the world. */
static inline void resume_world(rheo_world *world, int from, int steps, const uint64_t *hash, const char *what)
{
    for (int n = from;; n++) {
        if (rheo_world_hash(world) != hash[n])
            fail_msg("%s, from step %d: another state at step %d", what, from, n);
        if (n == steps)
            break;
        OK(rheo_world_step(world, &error));
    }
    rheo_world_destroy(world);
}

/*
 * Records so many steps of a world, which it destroys, into the file `path`, and leaves that there. A state then goes on
 * from the stored state of any step of the recording, and from a checkpoint of it. Returns the last hash.
 */
static inline uint64_t resume_every_step(rheo_world *world, int steps, const char *path, const char *what)
{
    const rheo_record_options options = {.scene = what, .full = true, .keyframe_spacing = 5, .force = true};
    rheo_recorder *recorder;
    rheo_recording *recording, *checkpoint;
    uint64_t hash[RESUME_MOST];
    assert_true(steps < RESUME_MOST);
    OK(rheo_recorder_open(world, path, &options, &recorder, &error));
    hash[0] = rheo_world_hash(world);
    for (int n = 1; n <= steps; n++) {
        OK(rheo_recorder_step(recorder, &error));
        hash[n] = rheo_world_hash(world);
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    OK(rheo_recording_open(path, &recording, &error));
    for (int from = 0; from <= steps; from++) {
        rheo_world *again, *copy;
        void *bytes;
        size_t size;
        OK(rheo_recording_world(recording, (uint64_t)from, NULL, &again, &error));
        OK(rheo_world_save_memory(again, what, &bytes, &size, &error));
        OK(rheo_recording_open_memory(bytes, size, &checkpoint, &error));
        OK(rheo_recording_world(checkpoint, (uint64_t)from, NULL, &copy, &error));
        resume_world(again, from, steps, hash, what);
        resume_world(copy, from, steps, hash, what);
        rheo_recording_close(checkpoint);
        free(bytes);
    }
    rheo_recording_close(recording);
    return hash[steps];
}

#endif
