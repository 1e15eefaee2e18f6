/* Checks of what rheo_player_why() tells, for its tests. */
#ifndef RHEO__TESTS_WHY_H
#define RHEO__TESTS_WHY_H

#include "support.h"

/* ---- Recordings in memory ---- */

typedef struct recorded {
    void *bytes;
    rheo_recording *recording;
    rheo_player *player;
} recorded;

static inline rheo_recorder *record_in_memory(rheo_world *world)
{
    rheo_recorder *recorder;
    const rheo_record_options options = {.scene = "why", .keyframe_spacing = 1};
    OK(rheo_recorder_open_memory(world, &options, &recorder, &error));
    return recorder;
}

/* Ends the recording, destroys its world and opens what was recorded. */
static inline recorded reopen(rheo_recorder *recorder, rheo_world *world)
{
    recorded r;
    size_t size;
    OK(rheo_recorder_close_memory(recorder, &r.bytes, &size, &error));
    rheo_world_destroy(world);
    OK(rheo_recording_open_memory(r.bytes, size, &r.recording, &error));
    OK(rheo_player_open(r.recording, NULL, &r.player, &error));
    return r;
}

static inline void discard(recorded *r)
{
    rheo_player_close(r->player);
    rheo_recording_close(r->recording);
    free(r->bytes);
}

/* ---- Checks ---- */

/* What was told of particles so far. */
typedef struct told {
    const char *of; /* recording or scene */
    uint64_t id;
    uint64_t changes, contributions, by[RHEO_SOURCE_COUNT];
} told;

static inline double magnitude(double x)
{
    return x < 0 ? -x : x;
}

/* The changes lead from the value before to that after, up to the rounding of each addition. */
static inline void adds_up(const told *t, const rheo_change *change)
{
    for (uint32_t axis = 0; axis < change->components; axis++) {
        const double before = change->before[axis], after = change->after[axis];
        double sum = before, size = magnitude(before);
        for (size_t i = 0; i < change->count; i++) {
            sum += change->contribution[i].change[axis];
            size += magnitude(change->contribution[i].change[axis]);
        }
        const double rounding = (RHEO_DOUBLE ? 0x1p-52 : 0x1p-23) * (double)(change->count + 4) * size + 1e-40;
        if (size < 1e30 && after - after == 0 && !(magnitude(sum - after) <= rounding))
            fail_msg("%s: step %llu, %s, particle %llu: the changes of the %s along %u make %.9g of %.9g, not %.9g",
                     t->of, (unsigned long long)change->step, change->stage, (unsigned long long)t->id, change->field,
                     (unsigned)axis, sum, before, after);
    }
}

static inline bool check_change(void *data, const rheo_change *change)
{
    told *t = data;
    if (!change->exact)
        fail_msg("%s: step %llu, %s, particle %llu: the contributions do not give the %s", t->of,
                 (unsigned long long)change->step, change->stage, (unsigned long long)t->id, change->field);
    if (change->count == 0)
        fail_msg("%s: %s changed the %s of particle %llu, but has no contributions", t->of, change->stage,
                 change->field, (unsigned long long)t->id);
    adds_up(t, change);
    t->changes++;
    t->contributions += change->count;
    for (size_t i = 0; i < change->count; i++) {
        assert_non_null(rheo_source_name(change->contribution[i].source));
        t->by[change->contribution[i].source]++;
    }
    return true;
}

static const char *const FIELDS[] = {"position", "velocity", "density", "temperature", "derivative"};

/* Checks all fields of a particle in a step. */
static inline void check_particle(rheo_player *player, uint64_t step, uint64_t id, told *t)
{
    t->id = id;
    for (size_t f = 0; f < sizeof FIELDS / sizeof *FIELDS; f++) {
        rheo_error error;
        const rheo_result result = rheo_player_why(player, step, NULL, id, FIELDS[f], check_change, t, &error);
        if (result != RHEO_OK && !(result == RHEO_ERROR_ARGUMENT && says(error.message, "no field")))
            fail_msg("%s: %s", t->of, error.message);
    }
}

enum { INTERESTING = 10 };

/* The first, the middle and the last particle, the fastest, and the outermost of each side. Returns their number. */
static inline size_t interesting(const rheo_world *world, uint64_t id[INTERESTING])
{
    const uint64_t count = rheo_world_particle_count(world);
    const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
    uint64_t fastest = 0, least[3] = {0}, most[3] = {0};
    double speed2 = 0;
    for (uint64_t i = 0; i < count; i++) {
        const rheo_real *at = v + 3 * i;
        const double own = (double)(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
        if (own > speed2) {
            speed2 = own;
            fastest = i;
        }
        for (size_t axis = 0; axis < 3; axis++) {
            least[axis] = x[3 * i + axis] < x[3 * least[axis] + axis] ? i : least[axis];
            most[axis] = x[3 * i + axis] > x[3 * most[axis] + axis] ? i : most[axis];
        }
    }
    const uint64_t all[INTERESTING] = {least[1],  fastest,  most[0], count / 2, 0,
                                       count - 1, least[0], most[1], least[2],  most[2]};
    memcpy(id, all, sizeof all);
    return count == 0 ? 0 : every() > 1 ? 4 : INTERESTING;
}

#endif
