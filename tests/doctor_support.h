/*
 * Recordings for the tests of the doctor: made, forged and diagnosed. The test program defines PATH, the name of its
 * file, because test programs run at the same time.
 */
#ifndef RHEO__TESTS_DOCTOR_SUPPORT_H
#define RHEO__TESTS_DOCTOR_SUPPORT_H

#include <math.h>
#include <unistd.h>
#include <zlib.h>

#include "melting.h"

/* ---- Recordings ---- */

typedef void give(rheo_world *world, int step);

/* Records a world and destroys it. Calls `commands`, unless NULL, before every step. Stops at a failed step. */
static inline file record(rheo_world *world, int steps, give *commands, rheo_result *result)
{
    rheo_recorder *recorder;
    rheo_error why = {""};
    rheo_record_options options = {.scene = "doctor", .keyframe_spacing = 100000, .force = true};
    *result = RHEO_OK;
    OK(rheo_recorder_open(world, PATH, &options, &recorder, &error));
    for (int step = 0; step < steps && *result == RHEO_OK; step++) {
        if (commands)
            commands(world, step);
        *result = rheo_recorder_step(recorder, &why);
    }
    OK(rheo_recorder_close(recorder, &error));
    rheo_world_destroy(world);
    return read_and_remove(PATH);
}

static inline file record_well(rheo_world *world, int steps, give *commands)
{
    rheo_result result;
    file f = record(world, steps, commands, &result);
    assert_int_equal(result, RHEO_OK);
    return f;
}

static inline rheo_diagnosis diagnose(const file *f)
{
    static rheo_diagnosis d;
    rheo_recording *recording;
    OK(rheo_recording_open_memory(f->bytes, f->size, &recording, &error));
    OK(rheo_diagnose(recording, &d, &error));
    rheo_recording_close(recording);
    return d;
}

static inline const rheo_finding *finding(const rheo_diagnosis *d, const char *measure)
{
    for (uint32_t i = 0; i < d->finding_count; i++)
        if (strcmp(d->findings[i].measure, measure) == 0)
            return &d->findings[i];
    return NULL;
}

static inline void assert_in(const char *part, const char *text)
{
    if (!says(text, part))
        fail_msg("\"%s\" is missing in: %s", part, text);
}

static inline void assert_healthy(const rheo_diagnosis *d, uint32_t notices)
{
    if (!d->healthy || d->finding_count != notices)
        fail_msg("%u out of range: %s", d->finding_count, d->why);
    assert_int_equal(d->advice_count, 0);
    assert_int_equal(strncmp(d->why, "healthy", 7), 0);
}

static inline void assert_cause(const rheo_diagnosis *d, const char *measure, const char *stage)
{
    if (d->healthy || strcmp(d->cause.measure, measure) != 0 || strcmp(d->cause.stage, stage) != 0)
        fail_msg("%s, %s is not: %s", measure, stage, d->why);
    assert_int_equal(strncmp(d->why, "unhealthy", 9), 0);
}

/* ---- Unhealthy runs ---- */

/*
 * A ball on a pool whose history stiffness exceeds the limit of a step of .033 in scheme sequential: k_hist = ratio
 * k_min.
 */
static inline rheo_world *stiff_world(double ratio)
{
    rheo_scene scene = lively_scene();
    scene.world.scheme = RHEO_SCHEME_SEQUENTIAL;
    scene.world.vibrators.count = 0;
    scene.world.springs.stiffness = 37.5;
    scene.world.history.stiffness = ratio * 37.5;
    scene.ball.clearance = 4;
    scene.world.history.window = 150;
    rheo_world *world;
    OK(rheo_scene_create_world(&scene, &world, &error));
    return world;
}

/*
 * A run that such springs end, after they have thrown particles for some steps. The failing ratio is found by trial,
 * because doubles can hold thrown particles for a long time.
 */
static inline file record_stiff(void)
{
    for (double ratio = 30; ratio < 200; ratio += 5) {
        rheo_result result;
        file f = record(stiff_world(ratio), 200, NULL, &result);
        rheo_recording *recording;
        OK(rheo_recording_open_memory(f.bytes, f.size, &recording, &error));
        uint64_t last = rheo_recording_get_info(recording).last_step;
        rheo_recording_close(recording);
        if (result == RHEO_ERROR_STATE && last >= 5)
            return f;
        free(f.bytes);
    }
    fail_msg("no spring stiffness ends the run");
    return (file){NULL, 0};
}

/* ---- Forged metrics ---- */

static inline uint64_t number(const uint8_t *at, size_t bytes)
{
    uint64_t value = 0;
    for (size_t i = bytes; i-- > 0;)
        value = value << 8 | at[i];
    return value;
}

static inline void put(uint8_t *at, uint64_t value, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++)
        at[i] = (uint8_t)(value >> 8 * i);
}

static inline void seal(uint8_t *chunk)
{
    size_t stored = (size_t)number(chunk + 16, 8);
    put(chunk + 32 + stored, crc32(0, chunk, (uInt)(32 + stored)), 4);
}

/* Finds the chunk of this type and step. */
static inline uint8_t *chunk_of(const file *f, const char *type, uint64_t step)
{
    for (size_t at = 8; at < f->size; at += 36 + (size_t)number(f->bytes + at + 16, 8))
        if (memcmp(f->bytes + at, type, 4) == 0 && number(f->bytes + at + 8, 8) == step)
            return f->bytes + at;
    fail_msg("no chunk %s of step %llu", type, (unsigned long long)step);
    return NULL;
}

/* Changes a metric. Metrics are the last part of a STEP, which is not compressed. */
static inline void forge(const file *f, uint64_t step, const char *name, double value)
{
    rheo_recording *recording;
    OK(rheo_recording_open_memory(f->bytes, f->size, &recording, &error));
    uint32_t count = rheo_recording_metric_count(recording), index = 0;
    while (index < count && strcmp(rheo_recording_metric_name(recording, index), name) != 0)
        index++;
    rheo_recording_close(recording);
    assert_true(index < count);
    uint8_t *chunk = chunk_of(f, "STEP", step);
    assert_int_equal(number(chunk + 4, 4), 0);
    size_t stored = (size_t)number(chunk + 16, 8);
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(chunk + 32 + stored - 8 * (size_t)(count - index), bits, 8);
    seal(chunk);
}

static inline rheo_world_def quiet_def(rheo_scheme scheme)
{
    rheo_world_def def = inert_def();
    def.scheme = scheme;
    def.springs.stiffness = 1;
    return def;
}

/* Makes a world for forty uneventful steps, with a ball at rest in space. */
static inline rheo_world *quiet_world(rheo_world_def def)
{
    const rheo_real position[6] = {0, 0, 0, 50, 0, 0};
    def.ball.radius = 1;
    def.ball.position[1] = 100;
    return world_of(def, 2, position, NULL);
}

/* In scheme sequential, which has precursors. */
static inline file quiet(give *commands)
{
    return record_well(quiet_world(quiet_def(RHEO_SCHEME_SEQUENTIAL)), 40, commands);
}

/* ---- Healthy runs ---- */

static inline void make_implicit_then_explicit(rheo_world *world, int step)
{
    if (step == 3)
        OK(rheo_world_set(world, "gravity", "[0, -1, 0]", &error)); /* changes no limit */
    if (step == 6)
        OK(rheo_world_set(world, "springs.solver", "explicit", &error));
}

#endif
