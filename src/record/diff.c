/*
 * Comparing two recordings. Their hashes name the first step, stage and field that differ; nothing is simulated for
 * that. For the values, each recording is played up to that stage with this build; a side that reproduces its own
 * hashes has the recorded values. If only one does, the value of the other is solved from its hash. If none does, or
 * more than one component differs, the stored states of full recordings are compared at the end of the step.
 */
#include <stdlib.h>
#include <string.h>

#include "core/progress.h"
#include "core/text.h"
#include "record/recording.h"

typedef struct side {
    rheo_recording *r;
    rheo_player *player;
    rheo__values values;
} side;

typedef struct comparison {
    side a, b;
    rheo_verification *v;
    const char *const *name; /* two */
    uint64_t agreed;         /* last step at whose end the values agree in spite of the difference; 0: none */
} comparison;

/* Steps after a difference in which it is followed. */
enum { FARTHEST = 128 };

/* ---- Values ---- */

/* Moves the player to right after a stage. False: this build does not reproduce the recorded hashes up to there. */
static bool play_to_stage(side *s, uint64_t step, const char *stage)
{
    rheo_error ignored;
    return rheo_player_seek_stage(s->player, step, stage, &ignored) == RHEO_OK;
}

static bool play_to_step(side *s, uint64_t step)
{
    rheo_error ignored;
    return rheo_player_seek(s->player, step, &ignored) == RHEO_OK;
}

static rheo_result take(side *s, rheo_error *error)
{
    return rheo__values_take(&s->values, &rheo_player_world(s->player)->state, true, error);
}

/* Takes both states at the end of a step, if both can be reached. */
static rheo_result states_at(comparison *c, uint64_t step, bool *both, rheo_error *error)
{
    *both = play_to_step(&c->a, step) && play_to_step(&c->b, step);
    if (!*both)
        return RHEO_OK;
    RHEO__TRY(take(&c->a, error));
    return take(&c->b, error);
}

/* Finds the values right after the stage that differs. */
static rheo_result find_values(comparison *c, uint64_t hash_a, uint64_t hash_b, rheo__field_id field, uint64_t last,
                               rheo_error *error)
{
    rheo_difference *d = &c->v->first;
    bool has_a = play_to_stage(&c->a, d->step, d->stage), has_b = play_to_stage(&c->b, d->step, d->stage);
    if (has_a && has_b) {
        RHEO__TRY(take(&c->a, error));
        RHEO__TRY(take(&c->b, error));
        if (rheo__compare_field(field, &c->a.values, &c->b.values, RHEO_VALUES_SIMULATED, d, NULL))
            return RHEO_OK;
    }
    if (has_a && rheo__difference_solve(d, &rheo_player_world(c->a.player)->state, field, hash_b, false))
        return RHEO_OK;
    if (has_b && rheo__difference_solve(d, &rheo_player_world(c->b.player)->state, field, hash_a, true))
        return RHEO_OK;
    /* The values may agree again at the end of the step: then those of the first step at whose end they do not. */
    bool both = true, found = false;
    for (uint64_t step = d->step; !found && step <= last && step <= d->step + FARTHEST; step++) {
        RHEO__TRY(states_at(c, step, &both, error));
        if (!both)
            break;
        found = rheo__compare_values(field, &c->a.values, &c->b.values, RHEO_VALUES_STORED, d);
        *(found ? &d->value_step : &c->agreed) = step;
    }
    return RHEO_OK;
}

static rheo_result follow_growth(comparison *c, uint64_t first, uint64_t last, rheo_error *error)
{
    bool both = true;
    for (uint64_t on = 0; both && on <= FARTHEST && first + on <= last; on = on ? 2 * on : 1) {
        RHEO__TRY(states_at(c, first + on, &both, error));
        if (both)
            rheo__compare_growth(c->v, first + on, &c->a.values, &c->b.values);
    }
    return RHEO_OK;
}

/* ---- Causes ---- */

/* A table is no parameter with one value. It is named as one, with its length and the first point that differs. */
static const rheo_parameter CURVE_AS_A_PARAMETER = {
    .path = "history.curve", .unit = "1", .about = "weights by age", .type = RHEO_PARAMETER_NAME};

static void describe_curve(const rheo_world_def *def, uint32_t point, char *text, size_t size)
{
    const uint32_t count = def->history.curve_count;
    char age[32], weight[32];
    if (point >= count) {
        snprintf(text, size, count ? "%u points" : "none", count);
        return;
    }
    rheo__text_from_double(def->history.curve[point].age, age);
    rheo__text_from_double(def->history.curve[point].weight, weight);
    snprintf(text, size, "%u points, point %u: [%.24s, %.24s]", count, point, age, weight);
}

static void compare_curves(const rheo_world_def *a, const rheo_world_def *b, rheo_verification *v)
{
    const uint32_t of_a = a->history.curve_count, of_b = b->history.curve_count, few = of_a < of_b ? of_a : of_b;
    uint32_t point = 0;
    while (point < few && a->history.curve[point].age == b->history.curve[point].age &&
           a->history.curve[point].weight == b->history.curve[point].weight)
        point++;
    if ((point == of_a && point == of_b) || v->parameter_count == RHEO_MAX_PARAMETER_DIFFERENCES)
        return;
    rheo_parameter_difference *d = &v->parameters[v->parameter_count++];
    d->parameter = &CURVE_AS_A_PARAMETER;
    describe_curve(a, point, d->a, sizeof d->a);
    describe_curve(b, point, d->b, sizeof d->b);
}

static void compare_parameters(const rheo_world_def *a, const rheo_world_def *b, rheo_verification *v)
{
    compare_curves(a, b, v);
    for (size_t i = 0; v->parameter_count < RHEO_MAX_PARAMETER_DIFFERENCES;) {
        rheo_parameter_difference *d = &v->parameters[v->parameter_count];
        d->parameter = rheo_world_def_differing(a, b, &i, d->a, d->b);
        if (!d->parameter)
            break;
        v->parameter_count++;
    }
}

static rheo_result same_commands(comparison *c, uint64_t step, bool *same, rheo_error *error)
{
    rheo_recording *a = c->a.r, *b = c->b.r;
    const rheo__step_chunks *in_a = &a->steps[step - a->first_step - 1], *in_b = &b->steps[step - b->first_step - 1];
    uint64_t offset_a = in_a->start, offset_b = in_b->start;
    *same = in_a->inputs == in_b->inputs;
    for (uint32_t i = 0; i < in_a->inputs && *same; i++) {
        bool found_a, found_b;
        RHEO__TRY(rheo__recording_next_command(a, in_a, step, &offset_a, &found_a, error));
        RHEO__TRY(rheo__recording_next_command(b, in_b, step, &offset_b, &found_b, error));
        *same = found_a && found_b && a->payload.size == b->payload.size &&
                memcmp(a->payload.data, b->payload.data, a->payload.size) == 0;
    }
    return RHEO_OK;
}

static rheo_result compare_commands(comparison *c, uint64_t first, uint64_t last, rheo_error *error)
{
    for (uint64_t step = first; step <= last; step++) {
        bool same;
        RHEO__TRY(same_commands(c, step, &same, error));
        if (same)
            continue;
        c->v->commands_differ = true;
        c->v->commands_step = step;
        break;
    }
    return RHEO_OK;
}

/* Sets the parameters of a world that differ from a definition. False: none could be set. */
static bool take_parameters(rheo_world *world, const rheo_world_def *other)
{
    bool any = false;
    char own[96], wanted[96];
    const rheo_parameter *p;
    for (size_t i = 0; (p = rheo_world_def_differing(&world->def, other, &i, own, wanted));) {
        rheo_error fixed;
        const char *member = strchr(p->path, '.');
        const bool is_state =
            strncmp(p->path, "ball", 4) == 0 && member &&
            (strcmp(member, ".position") == 0 || strcmp(member, ".velocity") == 0 || strcmp(member, ".spin") == 0);
        if (!is_state)
            any = rheo_world_set(world, p->path, wanted, &fixed) == RHEO_OK || any;
    }
    rheo__world_forget_commands(world);
    return any;
}

/*
 * Scenes settle with their parameters, so a parameter that differs changes the whole state at the start. In a run
 * from the same state, it shows first in the stage in which it acts.
 */
static rheo_result find_cause(comparison *c, uint64_t first, rheo_error *error)
{
    enum { FARTHEST_CAUSE = 32 };
    rheo_recording *a = c->a.r;
    rheo_difference *d = &c->v->cause;
    rheo_world *world;
    rheo_error ignored;
    RHEO__TRY(rheo_recording_world(a, first, NULL, &world, error));
    const rheo_world_def *other = rheo_world_definition(rheo_player_world(c->b.player));
    rheo_result result = RHEO_OK;
    bool going = take_parameters(world, other);
    for (uint64_t step = first + 1; going && step <= a->last_step && step <= first + FARTHEST_CAUSE; step++) {
        size_t different;
        rheo__field_id field;
        char name[32];
        going = rheo__recording_replay(a, (size_t)(step - a->first_step - 1), world, &different, &ignored) == RHEO_OK;
        if (!going || different == RHEO__NO_HASH)
            continue;
        going = false;
        rheo__world_trace_entry(world, rheo__world_substeps(world), different, name, &field);
        rheo__difference_locate(d, step, name, field);
        c->v->has_cause = true;
        if (!play_to_stage(&c->a, step, d->stage))
            break;
        result = take(&c->a, error);
        if (result == RHEO_OK)
            result = rheo__values_take(&c->b.values, &world->state, true, error);
        if (result == RHEO_OK)
            rheo__compare_field(field, &c->a.values, &c->b.values, RHEO_VALUES_SIMULATED, d, NULL);
    }
    rheo_world_destroy(world);
    return result;
}

/* ---- Hashes ---- */

static rheo_result check_alike(const comparison *c, rheo_error *error)
{
    const rheo__head *a = &c->a.r->head, *b = &c->b.r->head;
    if (a->real_bytes != b->real_bytes)
        return rheo__fail(error, RHEO_ERROR_UNSUPPORTED, "one recording is of float numbers, the other of double");
    if (a->layout.size != b->layout.size || memcmp(a->layout.data, b->layout.data, a->layout.size) != 0)
        return rheo__fail(
            error, RHEO_ERROR_UNSUPPORTED,
            "the recordings are of worlds with other stages or fields (%s; %s): their steps cannot be compared",
            a->scene, b->scene);
    return RHEO_OK;
}

/*
 * One recording cannot be played up to the first step of the other, since this build does not reproduce it: only the
 * hashes of its state there are known.
 */
static rheo_result compare_start_by_hashes(comparison *c, const side *played, const side *other, uint64_t step,
                                           rheo_error *error)
{
    uint64_t hash;
    const rheo_world *world = rheo_player_world(played->player);
    RHEO__TRY(rheo__recording_read_step(other->r, (size_t)(step - other->r->first_step - 1), error));
    const rheo__field_id field = rheo__recording_wrong_field(other->r, world, 0, &hash);
    if (field == RHEO__FIELD_COUNT)
        return RHEO_OK;
    c->v->verdict = RHEO_DIFFERS;
    rheo__difference_locate(&c->v->first, step, "", field);
    rheo__difference_solve(&c->v->first, &world->state, field, hash, other == &c->a);
    return RHEO_OK;
}

/* Compares the states at the first step that both have. */
static rheo_result compare_start(comparison *c, uint64_t step, rheo_error *error)
{
    side *late = c->a.r->first_step == step ? &c->a : &c->b, *early = late == &c->a ? &c->b : &c->a;
    rheo_error why;
    RHEO__TRY(rheo_player_seek(late->player, step, error));
    rheo_result result = rheo_player_seek(early->player, step, &why);
    if (result == RHEO_ERROR_DIFFERS || result == RHEO_ERROR_STATE)
        return compare_start_by_hashes(c, late, early, step, error);
    if (result != RHEO_OK)
        return rheo__fail(error, result, "%s", why.message);
    const rheo__state *a = &rheo_player_world(c->a.player)->state, *b = &rheo_player_world(c->b.player)->state;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        if (!rheo__state_has(a, f) || rheo__state_hash_field(a, f) == rheo__state_hash_field(b, f))
            continue;
        c->v->verdict = RHEO_DIFFERS;
        rheo__difference_locate(&c->v->first, step, "", f);
        RHEO__TRY(take(&c->a, error));
        RHEO__TRY(take(&c->b, error));
        rheo__compare_values(f, &c->a.values, &c->b.values, RHEO_VALUES_STORED, &c->v->first);
        rheo__compare_growth(c->v, step, &c->a.values, &c->b.values);
        return find_cause(c, step, error);
    }
    return RHEO_OK;
}

/* The first hash of a step that differs, or RHEO__NO_HASH. Different numbers of substeps differ as hashes, too. */
static rheo_result first_different(comparison *c, uint64_t step, size_t *entry, rheo_error *error)
{
    rheo_recording *a = c->a.r, *b = c->b.r;
    RHEO__TRY(rheo__recording_read_step(a, (size_t)(step - a->first_step - 1), error));
    RHEO__TRY(rheo__recording_read_step(b, (size_t)(step - b->first_step - 1), error));
    const size_t count = a->expected_count < b->expected_count ? a->expected_count : b->expected_count;
    for (*entry = 0; *entry < count; ++*entry)
        if (a->expected[*entry] != b->expected[*entry])
            return RHEO_OK;
    if (a->expected_count != b->expected_count)
        return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: step %llu has hashes of more substeps than it says",
                          (unsigned long long)step);
    *entry = RHEO__NO_HASH;
    return RHEO_OK;
}

static rheo_result compare_step(comparison *c, uint64_t step, uint64_t last, rheo_error *error)
{
    size_t entry;
    RHEO__TRY(first_different(c, step, &entry, error));
    if (entry == RHEO__NO_HASH)
        return RHEO_OK;
    const rheo_world *world = rheo_player_world(c->a.player);
    rheo__field_id field;
    char name[32];
    /* Up to this hash, both have the same number of substeps. */
    rheo__world_trace_entry(world, rheo__world_trace_substeps(world, c->a.r->expected_count), entry, name, &field);
    c->v->verdict = RHEO_DIFFERS;
    rheo__difference_locate(&c->v->first, step, name, field);
    RHEO__TRY(find_values(c, c->a.r->expected[entry], c->b.r->expected[entry], field, last, error));
    return follow_growth(c, step, last, error);
}

/* "0 to 20 and a step that failed" */
static void describe_steps(const rheo_recording *r, char *text, size_t size)
{
    snprintf(text, size, "%llu to %llu%s", (unsigned long long)r->first_step, (unsigned long long)r->last_step,
             r->has_failure ? " and a step that failed" : "");
}

/* All steps that both have agree. Compares which steps these are, and how the recordings end. */
static void compare_ends(comparison *c, uint64_t first, uint64_t last)
{
    const rheo_recording *a = c->a.r, *b = c->b.r;
    rheo_verification *v = c->v;
    const bool a_fails = a->has_failure && a->last_step == last, b_fails = b->has_failure && b->last_step == last;
    const bool other_failure = a_fails && b_fails && !rheo__same_failure(&a->failure, &b->failure);
    const bool one_fails = a_fails != b_fails && (a_fails ? b : a)->last_step > last;
    if (one_fails || other_failure) {
        const rheo_failure *failure = a_fails ? &a->failure : &b->failure;
        v->verdict = RHEO_DIFFERS;
        rheo__difference_locate(&v->first, last + 1, failure->stage, RHEO__FIELD_COUNT);
        snprintf(v->first.field, sizeof v->first.field, "%s", failure->field);
        snprintf(v->message, sizeof v->message, "differs at step %llu: it failed in %s, %s in %s",
                 (unsigned long long)last + 1, c->name[!a_fails],
                 other_failure ? "and at another place or for another reason" : "but not", c->name[a_fails]);
        return;
    }
    if (a->first_step == b->first_step && a->last_step == b->last_step && a_fails == b_fails) {
        snprintf(v->message, sizeof v->message, "same: %llu step%s%s", (unsigned long long)v->steps,
                 rheo__plural(v->steps), a_fails ? ", and the failure of the next" : "");
        return;
    }
    char steps[2][80];
    describe_steps(a, steps[0], sizeof steps[0]);
    describe_steps(b, steps[1], sizeof steps[1]);
    v->verdict = RHEO_DIFFERS;
    v->lengths_differ = true;
    const uint64_t earlier = a->first_step < b->first_step ? a->first_step : b->first_step;
    rheo__difference_locate(&v->first, earlier < first ? earlier : last + 1, "", RHEO__FIELD_COUNT);
    snprintf(v->message, sizeof v->message,
             "differs in length: %s has steps %s, %s %s; the %llu step%s that both have agree%s", c->name[0],
             steps[0], c->name[1], steps[1], (unsigned long long)v->steps, rheo__plural(v->steps),
             v->steps == 1 ? "s" : "");
}

static rheo_result compare_all(comparison *c, rheo_error *error)
{
    rheo_recording *a = c->a.r, *b = c->b.r;
    const uint64_t first = a->first_step > b->first_step ? a->first_step : b->first_step;
    const uint64_t last = a->last_step < b->last_step ? a->last_step : b->last_step;
    RHEO__TRY(check_alike(c, error));
    if (first > last)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                          "the recordings have no step in common: one has %llu to %llu, the other %llu to %llu",
                          (unsigned long long)a->first_step, (unsigned long long)a->last_step,
                          (unsigned long long)b->first_step, (unsigned long long)b->last_step);
    RHEO__TRY(rheo_player_open(a, NULL, &c->a.player, error));
    RHEO__TRY(rheo_player_open(b, NULL, &c->b.player, error));
    RHEO__TRY(compare_start(c, first, error));
    for (uint64_t step = first + 1; step <= last && c->v->verdict == RHEO_SAME; step++) {
        RHEO__TRY(compare_step(c, step, last, error));
        c->v->steps += c->v->verdict == RHEO_SAME;
        RHEO__TRY(rheo__progress("comparing", step - first, last - first, error));
    }
    if (c->v->verdict == RHEO_DIFFERS && c->v->first.stage[0])
        RHEO__TRY(compare_commands(c, first + 1, c->v->first.step, error));
    if (c->v->verdict == RHEO_DIFFERS)
        rheo__difference_describe(c->v, c->name, c->agreed, a->head.full && b->head.full);
    else
        compare_ends(c, first, last);
    return RHEO_OK;
}

rheo_result rheo__diff_recordings(rheo_recording *a, rheo_recording *b, const char *const names[2],
                                  rheo_verification *v, rheo_error *error)
{
    memset(v, 0, sizeof *v);
    v->verdict = RHEO_SAME;
    v->first_step[0] = a->first_step, v->last_step[0] = a->last_step;
    v->first_step[1] = b->first_step, v->last_step[1] = b->last_step;
    comparison c = {.a.r = a, .b.r = b, .v = v, .name = names};
    rheo_error why;
    compare_parameters(&a->def, &b->def, v);
    rheo_result result = compare_all(&c, &why);
    rheo_player_close(c.a.player);
    rheo_player_close(c.b.player);
    rheo__name_builds(v, names, a->head.build, b->head.build);
    rheo__values_release(&c.a.values);
    rheo__values_release(&c.b.values);
    return result == RHEO_OK ? RHEO_OK : rheo__unreadable(v, result, &why, error);
}

/* ---- Opening ---- */

/* A truncated recording is compared up to its last step, a damaged one not at all. */
static rheo_result open_side(rheo_recording *r, const char *which, rheo_verification *v, rheo_error *error)
{
    bool damaged = false;
    rheo_error why, named;
    rheo_result result = rheo__recording_scan(r, true, &damaged, &why);
    if (result == RHEO_OK && damaged)
        result = rheo__fail(&why, r->fault_result, "%s", r->fault.message);
    if (result == RHEO_OK)
        return RHEO_OK;
    rheo__fail(&named, result, "%s recording: %s", which, why.message);
    return rheo__unreadable(v, result, &named, error);
}

static const char *const NAMES[] = {"the first", "the second"};

static rheo_result diff_opened(rheo_recording *a, rheo_recording *b, rheo_verification *v, rheo_error *error)
{
    memset(v, 0, sizeof *v);
    RHEO__TRY(open_side(a, "the first", v, error));
    if (v->verdict != RHEO_UNREADABLE)
        RHEO__TRY(open_side(b, "the second", v, error));
    if (v->verdict == RHEO_UNREADABLE)
        return RHEO_OK;
    RHEO__TRY(rheo__diff_recordings(a, b, NAMES, v, error));
    if ((v->verdict == RHEO_SAME || v->lengths_differ) && !(a->complete && b->complete)) {
        rheo_error why;
        const rheo_recording *faulty = a->complete ? b : a;
        rheo__fail(&why, faulty->fault_result, "%s recording: %s", NAMES[a->complete], faulty->fault.message);
        return rheo__unreadable(v, faulty->fault_result, &why, error);
    }
    return RHEO_OK;
}

rheo_result rheo_diff(const char *path_a, const char *path_b, rheo_verification *v, rheo_error *error)
{
    rheo_error why, named;
    rheo_recording *a = calloc(1, sizeof *a), *b = calloc(1, sizeof *b);
    rheo_result result = a && b ? RHEO_OK : rheo__fail(&named, RHEO_ERROR_MEMORY, "no memory to compare recordings");
    if (result == RHEO_OK)
        result = rheo__in_file(path_a, rheo__reader_open(&a->reader, path_a, &why), &why, &named);
    if (result == RHEO_OK)
        result = rheo__in_file(path_b, rheo__reader_open(&b->reader, path_b, &why), &why, &named);
    if (result == RHEO_OK)
        result = diff_opened(a, b, v, &named);
    rheo_recording_close(a);
    rheo_recording_close(b);
    return rheo__not_compared(v, result, &named, error);
}

rheo_result rheo_diff_memory(const void *bytes_a, size_t size_a, const void *bytes_b, size_t size_b,
                             rheo_verification *v, rheo_error *error)
{
    rheo_error why;
    rheo_recording *a = calloc(1, sizeof *a), *b = calloc(1, sizeof *b);
    rheo_result result = a && b ? RHEO_OK : rheo__fail(&why, RHEO_ERROR_MEMORY, "no memory to compare recordings");
    if (result == RHEO_OK) {
        a->reader = (rheo__reader){.memory = bytes_a, .size = size_a};
        b->reader = (rheo__reader){.memory = bytes_b, .size = size_b};
        result = diff_opened(a, b, v, &why);
    }
    rheo_recording_close(a);
    rheo_recording_close(b);
    return rheo__not_compared(v, result, &why, error);
}
