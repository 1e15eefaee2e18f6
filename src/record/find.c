/*
 * Searching a recording for steps at which a condition holds (rheolog/find.h). It always goes forwards, through one interval
 * between keyframes at a time, because a recording can only be played forwards. To find the last place it takes the intervals
 * from the last to the first, and keeps what it finds last in one. Metrics are read first: no step is simulated behind the last
 * one of an interval at which they leave the answer open.
 */
#include "rheolog/find.h"

#include <stdlib.h>
#include <string.h>

#include "core/progress.h"
#include "core/text.h"
#include "record/predicate.h"
#include "record/recording.h"

/* States that a search for the last place keeps in an interval, one after the other. */
enum { MOST_KEPT = 8 };

typedef struct finder {
    rheo_recording *r;
    rheo_player *player; /* NULL: the condition is about metrics only */
    bool keeps;          /* states, so that the last place is reached soon */
    uint64_t apart;      /* the steps between these */
    const rheo_find_options *options;
    rheo_search *search;
    rheo__predicate condition;
    rheo__outcome outcome[RHEO__MOST_TERMS];
    double *metrics;   /* of a step */
    uint64_t from, to; /* steps that are searched */
    bool stopped;      /* by the receiver, or because what was wanted has been found */
} finder;

rheo_find_options rheo_default_find_options(void)
{
    return (rheo_find_options){.which = RHEO_FIND_FIRST};
}

/* ---- What was found ---- */

/* The first comparison that holds. If none does, the condition holds because of a `not`: then the first. */
static uint32_t telling_term(const finder *f)
{
    for (uint32_t i = 0; i < f->condition.terms; i++)
        if (f->outcome[i].truth == RHEO__TRUE)
            return i;
    return 0;
}

static void describe(const finder *f, uint64_t step, const char *stage, rheo_found *found)
{
    const uint32_t term = telling_term(f);
    const rheo__term *t = &f->condition.term[term];
    const rheo__outcome *o = &f->outcome[term];
    *found = (rheo_found){.step = step, .id = o->id, .other_id = o->other, .value = o->value};
    rheo__text_print(found->stage, sizeof found->stage, "%s", stage);
    rheo__text_print(found->quantity, sizeof found->quantity, "%s", t->name);
    if (t->about == RHEO__ABOUT_PARTICLE)
        rheo__text_print(found->item, sizeof found->item, "particle %llu", (unsigned long long)o->id);
    else if (t->about == RHEO__ABOUT_SPRING)
        rheo__text_print(found->item, sizeof found->item, "spring %llu:%llu", (unsigned long long)o->id,
                         (unsigned long long)o->other);
    else if (t->about == RHEO__ABOUT_BALL && t->id)
        rheo__text_print(found->item, sizeof found->item, "ball %llu", 1 + (unsigned long long)t->id);
    else if (t->about == RHEO__ABOUT_BALL)
        rheo__text_print(found->item, sizeof found->item, "ball");
}

static void report(finder *f, uint64_t step, const char *stage)
{
    rheo_found *found = &f->search->found;
    describe(f, step, stage, found);
    if (f->keeps)
        rheo__player_keep_found(f->player);
    f->search->hits = f->options->which == RHEO_FIND_ALL ? f->search->hits + 1 : 1;
    if (f->options->which == RHEO_FIND_LAST)
        return; /* a later one may follow */
    f->stopped = f->options->which == RHEO_FIND_FIRST;
    if (f->options->receiver && !f->options->receiver(f->options->data, found))
        f->stopped = true;
}

/* Notes that steps have been looked at. */
static rheo_result looked(finder *f, uint64_t from, uint64_t to, rheo_error *error)
{
    rheo_search *s = f->search;
    s->first = s->looked && s->first < from ? s->first : from;
    s->last = s->looked && s->last > to ? s->last : to;
    s->looked = true;
    return rheo__progress("searching", s->last - s->first + 1, f->to - f->from + 1, error);
}

/* ---- At the ends of steps ---- */

static rheo_result read_metrics(finder *f, uint64_t step, rheo_error *error)
{
    RHEO__TRY(rheo_recording_metrics(f->r, step, f->metrics, error));
    rheo__predicate_metrics(&f->condition, f->metrics, f->outcome);
    return RHEO_OK;
}

/* The last step of an interval that metrics do not exclude, if there is *any. */
static rheo_result last_open_step(finder *f, uint64_t from, uint64_t to, uint64_t *last, bool *any, rheo_error *error)
{
    *any = false;
    for (uint64_t step = from; step <= to; step++) {
        RHEO__TRY(read_metrics(f, step, error));
        if (rheo__predicate_truth(&f->condition, f->outcome) == RHEO__FALSE)
            continue;
        *last = step;
        *any = true;
    }
    return RHEO_OK;
}

static rheo_result look_at_step(finder *f, uint64_t step, rheo_error *error)
{
    RHEO__TRY(read_metrics(f, step, error));
    if (rheo__predicate_truth(&f->condition, f->outcome) == RHEO__UNKNOWN) {
        RHEO__TRY(rheo_player_seek(f->player, step, error));
        if (f->keeps)
            rheo__player_keep(f->player, f->apart);
        RHEO__TRY(rheo__predicate_items(&f->condition, rheo_player_world(f->player), f->outcome, error));
    }
    if (rheo__predicate_truth(&f->condition, f->outcome) == RHEO__TRUE)
        report(f, step, "");
    return looked(f, step, step, error);
}

/* ---- After stages ---- */

/* Whether a stage run "forces@2" is the wanted one: the same name, or the same stage without its number. */
static bool is_wanted(const char *run, const char *wanted)
{
    const size_t length = strcspn(run, "@");
    return strcmp(run, wanted) == 0 || (strlen(wanted) == length && strncmp(run, wanted, length) == 0);
}

/* Ends with the step, or with the stage that fails. */
static rheo_result look_into_step(finder *f, uint64_t step, rheo_error *error)
{
    const bool fails = f->r->has_failure && step == f->r->failure.step;
    RHEO__TRY(rheo_player_seek(f->player, step - 1, error));
    if (f->keeps)
        rheo__player_keep(f->player, f->apart);
    uint32_t stage;
    const rheo_world *world = rheo_player_world(f->player);
    do {
        char name[32];
        const uint64_t run = world->stage_runs_done;
        const rheo_result result = rheo_player_stage(f->player, &stage, error);
        if (result == RHEO_ERROR_STATE && fails)
            break;
        RHEO__TRY(result);
        rheo__world_stage_run_name(world, run, name);
        if (!is_wanted(name, f->options->stage))
            continue;
        rheo__predicate_metrics(&f->condition, NULL, f->outcome);
        RHEO__TRY(rheo__predicate_items(&f->condition, world, f->outcome, error));
        if (rheo__predicate_truth(&f->condition, f->outcome) == RHEO__TRUE)
            report(f, step, name);
    } while (!f->stopped && rheo_world_stages_done(world) > 0);
    return looked(f, step, step, error);
}

/* ---- The search ---- */

/* Searches steps between two keyframes. */
static rheo_result search_interval(finder *f, uint64_t from, uint64_t to, rheo_error *error)
{
    uint64_t last = to;
    bool any = true;
    f->apart = (to - from) / MOST_KEPT + 1;
    if (!f->options->stage)
        RHEO__TRY(last_open_step(f, from, to, &last, &any, error));
    for (uint64_t step = from; any && step <= last && !f->stopped; step++)
        RHEO__TRY(f->options->stage ? look_into_step(f, step, error) : look_at_step(f, step, error));
    return f->stopped ? RHEO_OK : looked(f, from, to, error);
}

/* The steps of keyframe interval k that are searched; false: none. */
static bool interval_of(const finder *f, size_t k, uint64_t *from, uint64_t *to)
{
    const rheo__keyframe *keyframe = f->r->keyframes;
    *from = keyframe[k].step + (f->options->stage ? 1 : 0); /* a keyframe is the end of a step */
    *to = k + 1 < f->r->keyframe_count ? keyframe[k + 1].step - (f->options->stage ? 0 : 1) : f->to;
    *from = *from > f->from ? *from : f->from;
    *to = *to < f->to ? *to : f->to;
    return *from <= *to;
}

static rheo_result search_all(finder *f, rheo_error *error)
{
    const size_t count = f->r->keyframe_count;
    const bool backwards = f->options->which == RHEO_FIND_LAST;
    for (size_t i = 0; i < count && !f->stopped; i++) {
        uint64_t from, to;
        if (!interval_of(f, backwards ? count - 1 - i : i, &from, &to))
            continue;
        RHEO__TRY(search_interval(f, from, to, error));
        if (backwards && f->search->hits)
            break;
    }
    if (backwards && f->search->hits && f->options->receiver)
        f->options->receiver(f->options->data, &f->search->found);
    return RHEO_OK;
}

/* The steps that are searched. */
static rheo_result set_range(finder *f, rheo_error *error)
{
    const rheo_find_options *o = f->options;
    const rheo_recording *r = f->r;
    const uint64_t first = r->first_step + (o->stage ? 1 : 0),
                   last = r->last_step + (o->stage && r->has_failure ? 1 : 0);
    f->from = o->has_after && o->after >= first ? o->after + 1 : first;
    f->to = o->has_before && o->before <= last ? o->before - (o->before > 0) : last;
    if ((o->has_after && o->after >= last) || (o->has_before && o->before <= f->from) || f->from > f->to)
        return rheo__fail(
            error, RHEO_ERROR_ARGUMENT,
            "there is no step to look at: the recording has %llu to %llu, and the steps after and before the "
            "given ones leave none",
            (unsigned long long)first, (unsigned long long)last);
    return RHEO_OK;
}

/* Number of particles that the recording has in the end. */
static rheo_result count_particles(rheo_recording *r, uint64_t *count, rheo_error *error)
{
    rheo_command command;
    *count = r->keyframes[0].particles;
    for (uint64_t i = 0; i < rheo_recording_command_count(r); i++) {
        RHEO__TRY(rheo_recording_command(r, i, &command, error));
        *count += command.kind == RHEO_COMMAND_ADD_PARTICLES ? command.count : 0;
    }
    return RHEO_OK;
}

/* Refuses a metric with a stage, and things that there never are. */
static rheo_result check(const rheo__predicate *condition, const rheo_world *world, uint64_t particles,
                         const char *stage, rheo_error *error)
{
    for (uint32_t i = 0; i < condition->terms; i++) {
        const rheo__term *t = &condition->term[i];
        if (stage && t->about == RHEO__ABOUT_METRIC)
            return rheo__fail(
                error, RHEO_ERROR_ARGUMENT,
                "%s is a metric, which belongs to the end of a step; with a stage ask about particles, springs or "
                "the ball",
                t->name);
        if (t->about == RHEO__ABOUT_BALL && rheo_world_body_count(world) == 0)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the recording has no ball");
        if (t->about == RHEO__ABOUT_BALL && t->id >= rheo_world_body_count(world))
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the recording has no ball %llu; it has %u",
                              1 + (unsigned long long)t->id, rheo_world_body_count(world));
        if (t->about == RHEO__ABOUT_SPRING && !rheo__state_has(&world->state, RHEO__FIELD_spring_ends))
            return rheo__fail(error, RHEO_ERROR_ARGUMENT, "the recording has no springs");
        const uint64_t id = t->other > t->id ? t->other : t->id;
        if ((t->about == RHEO__ABOUT_PARTICLE || t->about == RHEO__ABOUT_SPRING) && !t->any && id >= particles)
            return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                              "the recording has no particle %llu; its particles are 0 to %llu",
                              (unsigned long long)id, (unsigned long long)(particles - (particles > 0)));
    }
    return RHEO_OK;
}

/* Whether a condition is about metrics only, so that a search needs no world. */
static bool is_of_metrics(const char *condition, const rheo_recording *r, const rheo_find_options *options)
{
    rheo__predicate ignored;
    return !options->stage && rheo__predicate_parse(condition, r, NULL, &ignored, NULL) == RHEO_OK;
}

static rheo_result search_for(finder *f, const char *condition, rheo_error *error)
{
    const rheo_world *world = f->player ? rheo_player_world(f->player) : NULL;
    uint64_t particles;
    RHEO__TRY(rheo__predicate_parse(condition, f->r, world, &f->condition, error));
    RHEO__TRY(count_particles(f->r, &particles, error));
    RHEO__TRY(check(&f->condition, world, particles, f->options->stage, error));
    if (f->options->stage)
        RHEO__TRY(rheo__player_check_stage(f->player, f->options->stage, error));
    RHEO__TRY(set_range(f, error));
    f->metrics = malloc((f->r->head.metric_count + 1) * sizeof *f->metrics);
    if (!f->metrics)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the metrics of a step");
    const rheo_result result = search_all(f, error);
    free(f->metrics);
    return result;
}

rheo_result rheo_recording_find(rheo_recording *r, const char *condition, const rheo_find_options *options,
                                rheo_search *search, rheo_error *error)
{
    const rheo_find_options usual = rheo_default_find_options();
    finder f = {.r = r, .options = options ? options : &usual, .search = search};
    *search = (rheo_search){0};
    if (!is_of_metrics(condition, r, f.options))
        RHEO__TRY(rheo_player_open(r, NULL, &f.player, error));
    const rheo_result result = search_for(&f, condition, error);
    rheo_player_close(f.player);
    return result;
}

static rheo_result go_to(rheo_player *player, const rheo_found *found, rheo_error *error)
{
    return *found->stage ? rheo_player_seek_stage(player, found->step, found->stage, error)
                         : rheo_player_seek(player, found->step, error);
}

/* The search goes with another player, so that this one stays where it is if nothing is found. */
rheo_result rheo_player_find(rheo_player *player, const char *condition, const rheo_find_options *options,
                             rheo_search *search, rheo_error *error)
{
    const rheo_find_options usual = rheo_default_find_options();
    rheo_recording *r = rheo__player_recording(player);
    finder f = {.r = r, .options = options ? options : &usual, .search = search};
    *search = (rheo_search){0};
    if (!is_of_metrics(condition, r, f.options))
        RHEO__TRY(rheo__player_copy(player, &f.player, error));
    f.keeps = f.player && f.options->which == RHEO_FIND_LAST;
    rheo_result result = search_for(&f, condition, error);
    const bool goes = result == RHEO_OK && search->hits && f.options->which != RHEO_FIND_ALL;
    if (goes)
        result = go_to(f.player ? f.player : player, &search->found, error);
    if (goes && f.player && result == RHEO_OK)
        rheo__player_take_over(player, f.player);
    else
        rheo_player_close(f.player);
    return result;
}

rheo_result rheo_world_holds(const rheo_world *world, const char *condition, bool *holds, rheo_found *found,
                             rheo_error *error)
{
    finder f = {.player = NULL};
    *holds = false;
    RHEO__TRY(rheo__predicate_parse(condition, NULL, world, &f.condition, error));
    RHEO__TRY(check(&f.condition, world, rheo_world_particle_count(world), NULL, error));
    const uint32_t count = rheo_world_metric_count(world);
    f.metrics = malloc((count + 1) * sizeof *f.metrics);
    if (!f.metrics)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the metrics of a step");
    for (uint32_t i = 0; i < count; i++)
        f.metrics[i] = rheo_world_metric(world, i);
    rheo__predicate_metrics(&f.condition, f.metrics, f.outcome);
    free(f.metrics);
    if (rheo__predicate_truth(&f.condition, f.outcome) == RHEO__UNKNOWN)
        RHEO__TRY(rheo__predicate_items(&f.condition, world, f.outcome, error));
    *holds = rheo__predicate_truth(&f.condition, f.outcome) == RHEO__TRUE;
    if (*holds)
        describe(&f, rheo_world_step_count(world), "", found);
    return RHEO_OK;
}
