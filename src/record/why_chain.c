/*
 * Chains of causes (rheolog/why.h): from a change of a particle to the largest contribution, and from there to the change that
 * it came from. Every step that is looked at is made again with an account (record/why.c).
 */
#include <string.h>

#include "core/text.h"
#include "record/recording.h"
#include "rheolog/why.h"

static const char *const FIELDS[] = {"position", "velocity", "density", "temperature", "derivative"};
enum { FIELD_COUNT = sizeof FIELDS / sizeof *FIELDS };

const char *rheo_not_finite_name(rheo_not_finite what)
{
    static const char *const names[] = {"", "born", "passed on", "swallowed"};
    return (unsigned)what < sizeof names / sizeof *names ? names[what] : "";
}

typedef struct chase {
    rheo_player *player;
    rheo_recording *r;
    bool sick; /* rheo_diagnose() found a first sign at sign_step, in words */
    uint64_t sign_step;
    char sign[256];
    rheo_chain *chain;
} chase;

/* What is looked for: the largest change of a field in a step, of the runs before `before`. */
typedef struct wanted {
    uint64_t step, before, id;
    const char *stage, *field;
} wanted;

/* ---- Sizes ---- */

static bool is_finite(const double *value)
{
    return value[0] - value[0] == 0 && value[1] - value[1] == 0 && value[2] - value[2] == 0;
}

static double square(const double *value)
{
    return value[0] * value[0] + value[1] * value[1] + value[2] * value[2];
}

static double square_of_change(const rheo_link *link)
{
    double change[3];
    for (int axis = 0; axis < 3; axis++)
        change[axis] = link->after[axis] - link->before[axis];
    return square(change);
}

/* ---- The largest change of a step ---- */

typedef struct search {
    const wanted *wanted;
    rheo_link best;
    bool found;
} search;

/* Chooses the largest contribution, or the first that is not finite. */
static void choose_largest(rheo_link *link, const rheo_change *change)
{
    double most = -1;
    link->contributions = change->count;
    for (size_t i = 0; i < change->count; i++) {
        const rheo_contribution *c = &change->contribution[i];
        if (!is_finite(c->value) || !is_finite(c->change)) {
            link->largest = *c;
            return;
        }
        if (square(c->change) > most && (c->source != RHEO_SOURCE_NONE || change->count == 1)) {
            most = square(c->change);
            link->largest = *c;
        }
    }
}

/* Takes a change if it is larger than the ones before. Nothing is larger than the first that is not finite. */
static bool receive(void *data, const rheo_change *change)
{
    search *s = data;
    if (change->run >= s->wanted->before)
        return false;
    rheo_link link = {
        .step = change->step, .run = change->run, .id = s->wanted->id, .components = change->components};
    memcpy(link.stage, change->stage, sizeof link.stage);
    memcpy(link.field, change->field, sizeof link.field);
    memcpy(link.before, change->before, sizeof link.before);
    memcpy(link.after, change->after, sizeof link.after);
    choose_largest(&link, change);
    const bool swallows = !is_finite(link.before) || (change->count && !is_finite(link.largest.value));
    if (!is_finite(link.after))
        link.not_finite = change->was_finite ? RHEO_NOT_FINITE_BORN : RHEO_NOT_FINITE_PASSED_ON;
    else if (swallows)
        link.not_finite = RHEO_NOT_FINITE_SWALLOWED;
    if (!is_finite(link.after) ||
        (change->count && (!s->found || square_of_change(&link) > square_of_change(&s->best)))) {
        s->best = link;
        s->found = true;
    }
    return is_finite(link.after);
}

/* Finds the largest change. A field that the world does not have has none. */
static rheo_result find_largest(chase *c, const wanted *w, rheo_link *link, bool *found, rheo_error *error)
{
    search s = {.wanted = w};
    *found = false;
    RHEO__TRY(rheo_player_why(c->player, w->step, w->stage, w->id, w->field, receive, &s, error));
    *found = s.found;
    if (s.found)
        *link = s.best;
    return RHEO_OK;
}

static bool has_field(const chase *c, const char *name)
{
    rheo_field_info field;
    const rheo_world *world = rheo_player_world(c->player);
    for (uint32_t i = 0; i < rheo_world_field_count(world); i++)
        if (rheo_world_field(world, i, &field) == RHEO_OK && strcmp(field.name, name) == 0)
            return true;
    return false;
}

/* ---- The next link ---- */

/* The field of the particle, or of the pair, that a contribution comes from. NULL: it comes from outside. */
static const char *field_of(rheo_source source)
{
    switch (source) {
    case RHEO_SOURCE_VELOCITY:
    case RHEO_SOURCE_VISCOSITY:
    case RHEO_SOURCE_DRIFT:
    case RHEO_SOURCE_FLOW:
    case RHEO_SOURCE_PAST:
    case RHEO_SOURCE_MODE:
        return "velocity";
    case RHEO_SOURCE_PRESSURE:
    case RHEO_SOURCE_SPRING:
    case RHEO_SOURCE_WALL:
    case RHEO_SOURCE_OBSTACLE:
    case RHEO_SOURCE_PARTING:
    case RHEO_SOURCE_PERIOD:
    case RHEO_SOURCE_SHARE:
    case RHEO_SOURCE_DISPLACEMENT:
        return "position";
    case RHEO_SOURCE_HEAT:
        return "temperature";
    case RHEO_SOURCE_NONE:
    case RHEO_SOURCE_GRAVITY:
    case RHEO_SOURCE_BALL:
    case RHEO_SOURCE_PLATE:
    case RHEO_SOURCE_VIBRATOR:
    case RHEO_SOURCE_SOLVER:
    case RHEO_SOURCE_SUM:
    case RHEO_SOURCE_COUNT:
        break;
    }
    return NULL;
}

static bool is_pair(const rheo_link *link)
{
    return strcmp(rheo_source_item(link->largest.source), "particle") == 0 && link->largest.item != link->id;
}

/* The earliest run before `before` in which a value of a particle stopped being finite. */
static rheo_result find_not_finite(chase *c, const rheo_link *link, uint64_t id, rheo_link *next, bool *found,
                                   rheo_error *error)
{
    *found = false;
    for (size_t f = 0; f < FIELD_COUNT; f++) {
        const wanted w = {.step = link->step, .before = link->run, .id = id, .field = FIELDS[f]};
        rheo_link one;
        bool any;
        if (!has_field(c, FIELDS[f]))
            continue;
        RHEO__TRY(find_largest(c, &w, &one, &any, error));
        if (any && !is_finite(one.after) && (!*found || one.run < next->run)) {
            *next = one;
            *found = true;
        }
    }
    return RHEO_OK;
}

/* Says whether a value that is not finite came from a partner, in *next. */
static rheo_result trace_not_finite(chase *c, rheo_link *link, rheo_link *next, bool *found, rheo_error *error)
{
    *found = false;
    if (link->not_finite != RHEO_NOT_FINITE_BORN)
        RHEO__TRY(find_not_finite(c, link, link->id, next, found, error));
    if (!*found && is_pair(link))
        RHEO__TRY(find_not_finite(c, link, link->largest.item, next, found, error));
    if (*found && link->not_finite == RHEO_NOT_FINITE_BORN)
        link->not_finite = RHEO_NOT_FINITE_PASSED_ON;
    return RHEO_OK;
}

static void end_chain(chase *c, rheo_chain_end end, uint64_t step)
{
    c->chain->end = end;
    c->chain->step = step;
}

/* Whether the chain may go on in the step before `step`. If not, sets why. */
static rheo_result may_leave(chase *c, uint64_t step, bool *may, rheo_error *error)
{
    rheo_chain *chain = c->chain;
    *may = false;
    const uint64_t count = rheo_recording_command_count(c->r);
    for (uint64_t i = 0; i < count; i++) {
        rheo_command command;
        RHEO__TRY(rheo_recording_command(c->r, i, &command, error));
        if (command.step != step)
            continue;
        end_chain(c, RHEO_CHAIN_COMMAND, step);
        rheo__text_print(chain->why, sizeof chain->why, "before step %llu, %s", (unsigned long long)step,
                         command.text);
        return RHEO_OK;
    }
    if (c->sick && step == c->sign_step) {
        end_chain(c, RHEO_CHAIN_SIGN, step);
        rheo__text_print(chain->why, sizeof chain->why, "step %llu has the first sign: %s", (unsigned long long)step,
                         c->sign);
    } else if (step <= c->r->first_step + 1) {
        end_chain(c, RHEO_CHAIN_START, step);
        rheo__text_print(chain->why, sizeof chain->why, "the recording begins with the state of step %llu",
                         (unsigned long long)c->r->first_step);
    } else {
        *may = true;
    }
    return RHEO_OK;
}

/* Finds the change of a field of one or two particles that was larger in a step, of the runs before `before`. */
static rheo_result find_larger(chase *c, const rheo_link *link, const wanted *of, rheo_link *next, bool *found,
                               rheo_error *error)
{
    const uint64_t ids[2] = {link->id, link->largest.item};
    *found = false;
    for (int i = 0; i < 1 + is_pair(link) && of->before > 0; i++) {
        wanted w = *of;
        rheo_link one;
        bool any;
        w.id = ids[i];
        if (of->step != link->step && w.id >= rheo_world_particle_count(rheo_player_world(c->player)))
            continue; /* it is added later */
        RHEO__TRY(find_largest(c, &w, &one, &any, error));
        if (any && (!*found || square_of_change(&one) > square_of_change(next))) {
            *next = one;
            *found = true;
        }
    }
    return RHEO_OK;
}

/*
 * Finds the change of a field of one or two particles, in this step before the run, or else in the steps before. What falls
 * freely got its velocity earlier: gravity is taken only if there is nothing else in FALL steps. No more steps are looked at.
 */
static rheo_result find_cause(chase *c, const rheo_link *link, const char *field, rheo_link *next, bool *found,
                              rheo_error *error)
{
    enum { FALL = 16 };
    wanted w = {.step = link->step, .before = link->run, .field = field};
    *found = false;
    for (;;) {
        rheo_link one;
        bool any, may;
        RHEO__TRY(find_larger(c, link, &w, &one, &any, error));
        if (any && !*found)
            *next = one;
        *found = *found || any;
        if (any && one.largest.source != RHEO_SOURCE_GRAVITY) {
            *next = one;
            return RHEO_OK;
        }
        RHEO__TRY(may_leave(c, w.step, &may, error));
        if (!may || (*found && link->step - w.step >= FALL))
            return RHEO_OK;
        if (link->step - w.step >= FALL) {
            end_chain(c, RHEO_CHAIN_UNCHANGED, w.step);
            rheo__text_print(c->chain->why, sizeof c->chain->why, "the %s did not change in steps %llu to %llu",
                             field, (unsigned long long)w.step, (unsigned long long)link->step);
            return RHEO_OK;
        }
        w.step--;
        w.before = UINT64_MAX;
    }
}

/* What a link came from. If nothing, says why the chain ends. May correct the link's not_finite. */
static rheo_result follow(chase *c, rheo_link *link, rheo_link *next, bool *found, rheo_error *error)
{
    rheo_chain *chain = c->chain;
    *found = false;
    if (link->not_finite != RHEO_FINITE) {
        RHEO__TRY(trace_not_finite(c, link, next, found, error));
        if (*found)
            return RHEO_OK;
    }
    if (!is_finite(link->after)) {
        end_chain(c, RHEO_CHAIN_BORN, link->step);
        link->not_finite = RHEO_NOT_FINITE_BORN;
        rheo__text_print(chain->why, sizeof chain->why,
                         "born here: the values that %s of step %llu started from were finite", link->stage,
                         (unsigned long long)link->step);
        return RHEO_OK;
    }
    const char *field = field_of(link->largest.source);
    if (!field || !has_field(c, field)) {
        if (chain->why[0])
            return RHEO_OK; /* the search for something else than gravity ended there */
        end_chain(c, RHEO_CHAIN_SOURCE, link->step);
        rheo__text_print(chain->why, sizeof chain->why, "%s acts from outside of the particles",
                         rheo_source_name(link->largest.source));
        return RHEO_OK;
    }
    return find_cause(c, link, field, next, found, error);
}

/* ---- The chain ---- */

/* Finds the first sign. `step`: where the chain begins; a later sign does not matter. */
static rheo_result find_sign(chase *c, uint64_t step, rheo_error *error)
{
    rheo_diagnosis d;
    RHEO__TRY(rheo_diagnose(c->r, &d, error));
    c->sick = !d.healthy && d.sign_step <= step;
    c->sign_step = d.sign_step;
    char value[160];
    if (d.cause.measure && d.cause.measure[0]) {
        rheo_finding_text(&d.cause, value, sizeof value);
        rheo__text_print(c->sign, sizeof c->sign, "%s is %s", d.cause.measure, value);
    } else {
        rheo__text_print(c->sign, sizeof c->sign, "it failed");
    }
    return RHEO_OK;
}

static rheo_result pursue(chase *c, rheo_link *link, uint32_t depth, rheo_link_receiver *receiver, void *data,
                          rheo_error *error)
{
    for (;;) {
        rheo_link next;
        bool found = false;
        const bool last = c->chain->links + 1 >= depth;
        if (!last || !is_finite(link->after))
            RHEO__TRY(follow(c, link, &next, &found, error));
        c->chain->links++;
        if (!receiver(data, link))
            return rheo__fail(error, RHEO_ERROR_STOPPED, "the receiver wanted no more");
        if (last && (is_finite(link->after) || found)) {
            end_chain(c, RHEO_CHAIN_DEPTH, link->step);
            rheo__text_print(c->chain->why, sizeof c->chain->why, "after %u link%s, as asked", (unsigned)depth,
                             depth == 1 ? "" : "s");
            return RHEO_OK;
        }
        if (!found)
            return RHEO_OK;
        *link = next;
    }
}

rheo_result rheo_player_why_chain(rheo_player *player, uint64_t step, const char *stage, uint64_t id,
                                  const char *field, uint32_t depth, rheo_link_receiver *receiver, void *data,
                                  rheo_chain *chain, rheo_error *error)
{
    chase c = {.player = player, .r = rheo__player_recording(player), .chain = chain};
    const wanted w = {.step = step, .before = UINT64_MAX, .id = id, .stage = stage, .field = field};
    rheo_link link;
    bool found;
    *chain = (rheo_chain){.step = step};
    if (depth == 0)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "a chain has at least 1 link; 0 were wanted");
    RHEO__TRY(find_largest(&c, &w, &link, &found, error));
    if (!found) {
        end_chain(&c, RHEO_CHAIN_UNCHANGED, step);
        rheo__text_print(chain->why, sizeof chain->why, "nothing changed its %s in step %llu", field,
                         (unsigned long long)step);
        return RHEO_OK;
    }
    if (depth > 1)
        RHEO__TRY(find_sign(&c, step, error));
    return pursue(&c, &link, depth, receiver, data, error);
}
