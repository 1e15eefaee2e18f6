/*
 * Moving through a recording. The player's world is at the end of a step or between two stages of the next one. A
 * recording can only be played forwards, from the present state or from a keyframe. So that stepping back need not
 * start from the keyframe every time, states on the way are kept in memory. A search keeps some, too.
 */
#include <stdlib.h>
#include <string.h>

#include "core/account.h"
#include "core/progress.h"
#include "record/recording.h"

/*
 * States that steps back keep; those of a search: the newest, and the newest before the last place that it found; those on the
 * way to steps that are explained.
 */
enum {
    MOST_KEPT = 16,
    KEPT_NEWEST = MOST_KEPT,
    KEPT_FOUND,
    KEPT_EXPLAIN,
    MOST_EXPLAIN = 16,
    KEPT_SLOTS = KEPT_EXPLAIN + MOST_EXPLAIN
};

/* A checkpoint in memory. */
typedef struct kept_state {
    uint64_t step;
    void *bytes; /* NULL: none */
    size_t size;
} kept_state;

struct rheo_player {
    rheo_recording *r;
    rheo_allocator allocator;
    rheo_world *world;
    uint64_t step;  /* the last step that is complete; stages of the next may have run */
    bool commanded; /* the commands of the next step have been given */
    bool foreign;   /* a stage did not reproduce the recorded hashes: the world is not the recorded one */
    kept_state kept[KEPT_SLOTS];
    size_t kept_count; /* by steps back */
};

/* ---- States that are kept ---- */

static void forget(kept_state *kept)
{
    free(kept->bytes);
    kept->bytes = NULL;
}

static void forget_kept(rheo_player *p)
{
    for (size_t i = 0; i < KEPT_SLOTS; i++)
        forget(&p->kept[i]);
    p->kept_count = 0;
}

/* Keeps the present state. */
static rheo_result keep(const rheo_player *p, kept_state *kept, rheo_error *error)
{
    forget(kept);
    kept->step = p->step;
    return rheo_world_save_memory(p->world, "", &kept->bytes, &kept->size, error);
}

static rheo_result load_kept(const rheo_player *p, const kept_state *kept, rheo_world **world, rheo_error *error)
{
    rheo_recording *checkpoint;
    RHEO__TRY(rheo_recording_open_memory(kept->bytes, kept->size, &checkpoint, error));
    rheo_result result = rheo_recording_world(checkpoint, kept->step, &p->allocator, world, error);
    rheo_recording_close(checkpoint);
    return result;
}

/* ---- Steps ---- */

static bool is_between_steps(const rheo_player *p)
{
    return p->world && p->world->stage_runs_done == 0 && !p->commanded && !p->foreign;
}

/* Loads the latest state at or before `step`, from memory or the nearest keyframe. */
static rheo_result load_before(rheo_player *p, uint64_t step, rheo_error *error)
{
    const rheo__keyframe *keyframe = &p->r->keyframes[rheo__recording_nearest(p->r, step)];
    const kept_state *best = NULL;
    for (size_t i = 0; i < KEPT_SLOTS; i++)
        if (p->kept[i].bytes && p->kept[i].step <= step && p->kept[i].step > (best ? best->step : keyframe->step))
            best = &p->kept[i];
    rheo_world *world;
    RHEO__TRY(best ? load_kept(p, best, &world, error)
                   : rheo__keyframe_world(p->r, keyframe, &p->allocator, &world, error));
    rheo_world_destroy(p->world);
    p->world = world;
    p->step = rheo_world_step_count(world);
    p->commanded = p->foreign = false;
    return RHEO_OK;
}

/* Runs the remaining stages of a step that was begun. */
static rheo_result finish_step(rheo_player *p, rheo_error *error)
{
    uint32_t stage;
    do
        RHEO__TRY(rheo_player_stage(p, &stage, error));
    while (p->world->stage_runs_done > 0);
    return RHEO_OK;
}

/* Whether a step was begun that leads to `step`, and no keyframe is nearer. */
static bool is_on_the_way(const rheo_player *p, uint64_t step)
{
    return p->world->stage_runs_done > 0 && !p->foreign && p->step < step &&
           p->step >= p->r->keyframes[rheo__recording_nearest(p->r, step)].step;
}

/* Instead of a stride: states for explanations are kept. */
static const uint64_t EXPLAIN = UINT64_MAX;

/*
 * Keeps the present state, `left` steps before the one to explain, if it will be wanted: the same step is explained for several
 * particles, and then the steps before it. So states are kept 0, 8, 24, 56 ... steps before it: few, for a state takes longer to
 * keep than a step to make, and the way from one of them is no longer than the way back has been, or 8 steps.
 */
static void keep_to_explain(rheo_player *p, uint64_t left)
{
    enum { APART = 8 };
    const uint64_t distances = left / APART + 1;
    rheo_error ignored; /* without it, explanations only take longer */
    kept_state *free_slot = NULL;
    if (left % APART != 0 || (distances & (distances - 1)) != 0 ||
        p->r->keyframes[rheo__recording_nearest(p->r, p->step)].step == p->step)
        return;
    for (size_t i = 0; i < KEPT_SLOTS; i++) {
        if (p->kept[i].bytes && p->kept[i].step == p->step)
            return;
        if (i >= KEPT_EXPLAIN && !p->kept[i].bytes)
            free_slot = &p->kept[i];
    }
    if (free_slot && keep(p, free_slot, &ignored) != RHEO_OK)
        forget(free_slot);
}

static void keep_on_the_way(rheo_player *p, uint64_t left, uint64_t stride)
{
    if (stride == EXPLAIN) {
        keep_to_explain(p, left);
    } else if (left && stride && left % stride == 0 && p->kept_count < MOST_KEPT) {
        rheo_error ignored; /* without it, later steps back only take longer */
        p->kept_count += keep(p, &p->kept[p->kept_count], &ignored) == RHEO_OK;
    }
}

/* `stride`: number of steps from one state that is kept to the next; 0: keep none. */
static rheo_result go(rheo_player *p, uint64_t step, uint64_t stride, rheo_error *error)
{
    RHEO__TRY(rheo__recording_check_step(p->r, step, error));
    if (is_on_the_way(p, step))
        RHEO__TRY(finish_step(p, error));
    if (!is_between_steps(p) || p->step > step || p->step < p->r->keyframes[rheo__recording_nearest(p->r, step)].step)
        RHEO__TRY(load_before(p, step, error));
    if (stride && stride != EXPLAIN)
        forget_kept(p);
    const uint64_t from = p->step;
    while (p->step < step) {
        keep_on_the_way(p, step - p->step, stride);
        rheo_result result = rheo__recording_forward(p->r, (size_t)(p->step - p->r->first_step), p->world, error);
        if (result != RHEO_OK) {
            /* The world is in the middle of a step that is not the recorded one. */
            rheo_error ignored;
            uint64_t reached = p->step;
            p->foreign = true;
            if (load_before(p, reached, &ignored) == RHEO_OK)
                while (p->step < reached && rheo__recording_forward(p->r, (size_t)(p->step - p->r->first_step),
                                                                    p->world, &ignored) == RHEO_OK)
                    p->step++;
            return result;
        }
        p->step++;
        RHEO__TRY(rheo__progress("simulating", p->step - from, step - from, error));
    }
    keep_on_the_way(p, 0, stride);
    return RHEO_OK;
}

rheo_result rheo_player_open(rheo_recording *recording, const rheo_allocator *allocator, rheo_player **player,
                             rheo_error *error)
{
    *player = NULL;
    rheo_player *p = calloc(1, sizeof *p);
    if (!p)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a player");
    p->r = recording;
    p->allocator = rheo__allocator_or_default(allocator ? *allocator : (rheo_allocator){0});
    rheo_result result = load_before(p, recording->first_step, error);
    if (result == RHEO_OK)
        *player = p;
    else
        rheo_player_close(p);
    return result;
}

void rheo_player_close(rheo_player *p)
{
    if (!p)
        return;
    forget_kept(p);
    rheo_world_destroy(p->world);
    free(p);
}

const rheo_world *rheo_player_world(const rheo_player *p)
{
    return p->world;
}

rheo_recording *rheo__player_recording(const rheo_player *p)
{
    return p->r;
}

rheo_result rheo_player_seek(rheo_player *p, uint64_t step, rheo_error *error)
{
    return go(p, step, 0, error);
}

rheo_result rheo_player_step(rheo_player *p, rheo_error *error)
{
    if (p->world->stage_runs_done > 0 && !p->foreign)
        return finish_step(p, error);
    return go(p, p->step + 1, 0, error);
}

/*
 * Goes to a step, and keeps states on the way for further steps back: starts from the keyframe the first time, and keeps states
 * at equal distances; later starts from the nearest of these.
 */
static rheo_result go_back(rheo_player *p, uint64_t step, rheo_error *error)
{
    const uint64_t keyframe = p->r->keyframes[rheo__recording_nearest(p->r, step)].step;
    bool near = false;
    for (size_t i = 0; i < p->kept_count; i++)
        near = near || (p->kept[i].step > keyframe && p->kept[i].step <= step);
    const uint64_t distance = step - keyframe;
    return go(p, step, near || distance < MOST_KEPT ? 0 : distance / MOST_KEPT + 1, error);
}

rheo_result rheo_player_step_back(rheo_player *p, rheo_error *error)
{
    if (p->step == p->r->first_step)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no step before %llu, with which the recording begins",
                          (unsigned long long)p->step);
    return go_back(p, p->step - 1, error);
}

/* ---- Stages ---- */

/* Gives the next step its commands; the recorded hashes of its stages are in r->expected. */
static rheo_result begin_step(rheo_player *p, rheo_error *error)
{
    rheo_recording *r = p->r;
    const uint64_t next = p->step + 1;
    const bool failed = r->has_failure && next == r->failure.step;
    if (next > r->last_step && !failed)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no step after %llu, with which the recording ends",
                          (unsigned long long)p->step);
    if (p->commanded)
        return RHEO_OK;
    const rheo__step_chunks *chunks = failed ? &r->failed : &r->steps[next - r->first_step - 1];
    p->commanded = true;
    return rheo__recording_command(r, chunks, next, p->world, error);
}

rheo_result rheo_player_stage(rheo_player *p, uint32_t *stage, rheo_error *error)
{
    rheo_recording *r = p->r;
    if (p->world->stage_runs_done == 0)
        RHEO__TRY(begin_step(p, error));
    const uint64_t next = p->step + 1, stage_run = p->world->stage_runs_done;
    RHEO__TRY(rheo_world_step_stage(p->world, stage, error));
    if (p->world->stage_runs_done == 0) {
        p->step++;
        p->commanded = false;
    }
    if (next > r->last_step) /* the failed step has no recorded hashes */
        return RHEO_OK;
    uint64_t hashes[RHEO__FIELD_COUNT];
    const rheo__fields writes = p->world->stage[*stage].writes;
    const size_t first = rheo__world_trace_start(p->world, stage_run);
    RHEO__TRY(rheo__recording_read_step(r, (size_t)(next - r->first_step - 1), error));
    rheo__state_hash_newest(&p->world->state, writes, hashes);
    for (size_t i = 0; i < (size_t)__builtin_popcountll(writes); i++)
        if (first + i >= r->expected_count || hashes[i] != r->expected[first + i]) {
            p->foreign = true;
            return rheo__recording_differs(p->world, next, first + i, error);
        }
    if (p->world->stage_runs_done == 0 && first + (size_t)__builtin_popcountll(writes) != r->expected_count) {
        p->foreign = true;
        return rheo__recording_too_many(r, next, error);
    }
    return RHEO_OK;
}

static rheo_result no_such_step(const rheo_recording *r, uint64_t step, rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "there is no step %llu to look into; the recording has %llu to %llu", (unsigned long long)step,
                      (unsigned long long)r->first_step + 1, (unsigned long long)r->last_step + r->has_failure);
}

/* Goes to the step before one that is explained. Those before it are explained after it. */
static rheo_result go_to_explain(rheo_player *p, uint64_t step, rheo_error *error)
{
    for (size_t i = KEPT_EXPLAIN; i < KEPT_SLOTS; i++)
        if (p->kept[i].bytes && p->kept[i].step > step)
            forget(&p->kept[i]);
    return go(p, step, EXPLAIN, error);
}

rheo_result rheo__player_step_account(rheo_player *p, uint64_t step, rheo__account *account, rheo_error *error)
{
    rheo_recording *r = p->r;
    const uint64_t last = r->last_step + r->has_failure;
    if (step <= r->first_step || step > last)
        return no_such_step(r, step, error);
    RHEO__TRY(go_to_explain(p, step - 1, error));
    rheo_result result;
    if (step > r->last_step) {
        RHEO__TRY(begin_step(p, error));
        p->world->state.account = account;
        result = rheo_world_step(p->world, error);
        result = result == RHEO_ERROR_STATE ? RHEO_OK : result;
    } else {
        size_t different;
        p->foreign = true; /* until it has been reproduced */
        p->world->state.account = account;
        result = rheo__recording_replay(r, (size_t)(step - r->first_step - 1), p->world, &different, error);
        if (result == RHEO_OK && different != RHEO__NO_HASH)
            result = rheo__recording_differs(p->world, step, different, error);
        if (result == RHEO_OK) {
            p->step = step;
            p->foreign = false;
        }
    }
    p->world->state.account = NULL;
    if (result == RHEO_OK && account->stages == 0)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no particle %u in step %llu; it has %u, from 0",
                          (unsigned)account->id, (unsigned long long)step, (unsigned)p->world->state.particles);
    if (result == RHEO_OK && account->no_memory)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for what was added to particle %u",
                          (unsigned)account->id);
    return result;
}

/* Splits "viscosity@3"; *substep is 0 if the name has none. False: not a number of a substep. */
static bool split_name(const char *name, char stage[32], uint64_t *substep)
{
    const char *offset = strchr(name, '@');
    *substep = 0;
    snprintf(stage, 32, "%.*s", offset ? (int)(offset - name < 31 ? offset - name : 31) : 31, name);
    if (!offset)
        return true;
    for (const char *digit = offset + 1; *digit; digit++) {
        if (*digit < '0' || *digit > '9' || *substep > UINT32_MAX)
            return false;
        *substep = 10 * *substep + (uint64_t)(*digit - '0');
    }
    return *substep > 0;
}

/*
 * The stage and substep that a name means; without a number, the first substep. *substep is 0 for a stage that runs
 * once.
 */
static rheo_result find_stage(const rheo_world *world, const char *name, uint32_t *index, uint64_t *substep,
                              rheo_error *error)
{
    char names[384] = "", stage[32];
    if (!split_name(name, stage, substep))
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "\"%.60s\" is not a stage; after the @ give the number of a substep, from 1", name);
    for (*index = 0; *index < world->stage_count; ++*index) {
        const char *own = world->stage[*index].name;
        if (strcmp(own, stage) == 0) {
            const bool repeated = rheo__world_phase(world, *index) == RHEO__IN_SUBSTEPS;
            if (!repeated && *substep > 1)
                return rheo__fail(error, RHEO_ERROR_ARGUMENT, "stage %s is made once in a step, not in substeps",
                                  own);
            *substep = !repeated ? 0 : *substep ? *substep : 1;
            return RHEO_OK;
        }
        size_t length = strlen(names);
        snprintf(names + length, sizeof names - length, "%s%s", length ? ", " : "", own);
    }
    return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no stage \"%.60s\"; the stages of this world are %s",
                      name, names);
}

rheo_result rheo__player_check_stage(const rheo_player *p, const char *name, rheo_error *error)
{
    uint64_t substep;
    uint32_t stage;
    return find_stage(p->world, name, &stage, &substep, error);
}

rheo_result rheo_player_seek_stage(rheo_player *p, uint64_t step, const char *name, rheo_error *error)
{
    const rheo_recording *r = p->r;
    uint64_t substep;
    uint32_t wanted, stage;
    RHEO__TRY(find_stage(p->world, name, &wanted, &substep, error));
    const uint64_t last = r->last_step + r->has_failure;
    if (step <= r->first_step || step > last)
        return no_such_step(r, step, error);
    uint64_t done = p->world->stage_runs_done;
    if (p->step + 1 != step || p->foreign ||
        (done > 0 && rheo__world_compare_run(p->world, done - 1, wanted, substep) > 0)) {
        RHEO__TRY(go(p, step - 1, 0, error));
        done = 0;
    }
    /* How many substeps the step has, and so the number of a later stage run, is known only on the way. */
    while (done == 0 || rheo__world_compare_run(p->world, done - 1, wanted, substep) != 0) {
        if (p->step == step)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "step %llu has only %llu substeps; there is no %s in it",
                              (unsigned long long)step, (unsigned long long)rheo__world_substeps(p->world), name);
        RHEO__TRY(rheo_player_stage(p, &stage, error));
        done++;
    }
    return RHEO_OK;
}

/* ---- For searches (record/find.c) ---- */

rheo_result rheo__player_copy(const rheo_player *p, rheo_player **copy, rheo_error *error)
{
    rheo_player *c = calloc(1, sizeof *c);
    *copy = NULL;
    if (!c)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for a player");
    c->r = p->r;
    c->allocator = p->allocator;
    rheo_result result = is_between_steps(p) ? keep(p, &c->kept[KEPT_NEWEST], error) : RHEO_OK;
    if (result == RHEO_OK)
        result = load_before(c, p->step, error);
    forget_kept(c);
    if (result == RHEO_OK)
        *copy = c;
    else
        rheo_player_close(c);
    return result;
}

void rheo__player_take_over(rheo_player *p, rheo_player *from)
{
    const rheo_player before = *p;
    *p = *from;
    *from = before;
    rheo_player_close(from);
}

void rheo__player_keep(rheo_player *p, uint64_t apart)
{
    kept_state *newest = &p->kept[KEPT_NEWEST];
    rheo_error ignored; /* without it, the way to the place only takes longer */
    if (is_between_steps(p) && (p->step < newest->step || p->step - newest->step >= apart) &&
        keep(p, newest, &ignored) != RHEO_OK)
        forget(newest);
}

void rheo__player_keep_found(rheo_player *p)
{
    kept_state *newest = &p->kept[KEPT_NEWEST], *found = &p->kept[KEPT_FOUND];
    if (!newest->bytes)
        return;
    forget(found);
    *found = *newest;
    newest->bytes = NULL; /* its step stays, so that the next is kept as far from it */
}
