/*
 * Where, when and why a run became unhealthy, from the metrics and parameters that a recording holds. The model lists
 * the measures (world/measure.h) and world/examination.h examines the steps; this file finds the cause and describes it.
 *
 * A run is unhealthy if a severe measure left its range or a step failed. The cause is the first of the precursors
 * that lead up to that without a gap; but a condition beyond its second limit is the cause, even if another measure
 * leaves its range first.
 */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "record/recording.h"
#include "world/examination.h"

/* Precursors that are more steps apart do not belong together. */
enum { GAP = 10, MEASURES = RHEO_MAX_FINDINGS };

typedef struct inquiry {
    rheo_recording *recording;
    rheo_diagnosis *diagnosis;
    rheo__examination x;
    rheo_world_def def;    /* definition in force in the step that is examined */
    uint64_t next_command; /* the first command that is not applied to `def` yet */

    rheo_finding shown[MEASURES];     /* conditions: the last time that they were certain, and where it showed */
    bool certain[MEASURES];           /* conditions: beyond the second limit, last in shown.step */
    uint64_t certain_since[MEASURES]; /* first of the steps without a gap that end with shown.step */

    bool in_episode;    /* precursors follow each other without a gap */
    uint32_t beginning; /* the measure that the episode began with */
    rheo_finding begin; /* its finding then */
    uint64_t last_precursor;
    double episode[MEASURES];     /* largest values in it, up to the unhealthy step */
    double *largest;              /* of every metric, up to the unhealthy step */
    rheo_world_def unhealthy_def; /* definition in force in the unhealthy step, or else in the last one */
} inquiry;

static const rheo__measure *row_of(const inquiry *q, uint32_t m)
{
    return &q->x.measures->row[m];
}

/* ---- A step ---- */

static void note_condition(inquiry *q, uint32_t m)
{
    if (!q->certain[m] || q->shown[m].step + 1 < q->x.step)
        q->certain_since[m] = q->x.step;
    q->certain[m] = true;
    q->shown[m] = rheo__examination_finding(&q->x, m, row_of(q, m)->certain);
}

/* A precursor or a severe measure is out of range in a run that is still healthy. */
static void note_precursor(inquiry *q, uint32_t m)
{
    if (!q->in_episode || q->x.step > q->last_precursor + GAP) {
        q->in_episode = true;
        q->begin = rheo__examination_finding(&q->x, m, row_of(q, m)->limit);
        q->beginning = m;
        memset(q->episode, 0, sizeof q->episode);
    }
    q->last_precursor = q->x.step;
}

/* Examines the step whose metrics and definition are set. */
static void examine_step(inquiry *q, uint64_t step)
{
    rheo__examination *x = &q->x;
    const bool was_unhealthy = x->unhealthy;
    rheo__examine(x, step);
    if (was_unhealthy)
        return;
    for (uint32_t m = 0; m < x->measures->count; m++) {
        const rheo__measure *row = row_of(q, m);
        if (!x->measured[m] || x->value[m] <= row->limit)
            continue;
        if (row->kind == RHEO__CONDITION && !(x->value[m] <= row->certain))
            note_condition(q, m);
        if (row->kind == RHEO__PRECURSOR || row->kind == RHEO__SEVERE)
            note_precursor(q, m);
    }
    for (uint32_t m = 0; q->in_episode && m < x->measures->count; m++)
        if (x->measured[m])
            q->episode[m] = fmax(q->episode[m], x->value[m]);
    for (uint32_t i = 0; i < x->observation.count; i++)
        q->largest[i] = fmax(q->largest[i], x->observation.now[i]);
    if (x->unhealthy) {
        q->diagnosis->unhealthy_step = step;
        q->unhealthy_def = q->def;
    }
}

/*
 * Notes where conditions show: at the particle of the severe measure that makes the run unhealthy, or else at that of
 * their measure `seen`.
 */
static void show_conditions(inquiry *q)
{
    const rheo_finding *severe = &q->x.first;
    for (uint32_t m = 0; m < q->x.measures->count; m++) {
        if (q->certain[m] && q->x.unhealthy && severe->id >= 0)
            rheo__finding_place(&q->shown[m], severe);
        else if (q->certain[m])
            rheo__examination_show(&q->x, m, &q->shown[m]);
    }
}

/* Applies the commands before a step to the definition in force. */
static rheo_result apply_commands(inquiry *q, uint64_t step, rheo_error *error)
{
    rheo__observation *o = &q->x.observation;
    const uint64_t count = rheo_recording_command_count(q->recording);
    for (; q->next_command < count; q->next_command++) {
        rheo_command c;
        RHEO__TRY(rheo_recording_command(q->recording, q->next_command, &c, error));
        if (c.step > step)
            return RHEO_OK;
        o->added = o->added || c.kind == RHEO_COMMAND_ADD_PARTICLES;
        if (c.kind == RHEO_COMMAND_SET && rheo_world_def_set(&q->def, c.path, c.value, NULL) != RHEO_OK)
            return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: a command before step %llu sets %s to %.60s",
                              (unsigned long long)step, c.path, c.value);
    }
    return RHEO_OK;
}

/*
 * Examines all steps, and the failed one with its commands and the metrics that its stages reached. The parameters of
 * the first state are those in force in the first step, since no step was recorded with those that a command replaced.
 */
static rheo_result examine_steps(inquiry *q, rheo_error *error)
{
    rheo_diagnosis *d = q->diagnosis;
    rheo__observation *o = &q->x.observation;
    const uint64_t end = d->last_step + d->failed;
    RHEO__TRY(apply_commands(q, d->first_step + 1, error));
    for (uint64_t step = d->first_step; step <= end; step++) {
        o->begins = step == d->first_step;
        o->unfinished = step > d->last_step;
        RHEO__TRY(rheo_recording_metrics(q->recording, step, rheo__examination_next(&q->x), error));
        if (step > d->first_step + 1) {
            o->added = false;
            RHEO__TRY(apply_commands(q, step, error));
        }
        const bool was_unhealthy = q->x.unhealthy;
        examine_step(q, step);
        if (!was_unhealthy && (q->x.unhealthy || step == end))
            show_conditions(q);
    }
    if (!q->x.unhealthy)
        q->unhealthy_def = q->def;
    return RHEO_OK;
}

/* ---- The cause ---- */

/* A condition that was certain at or shortly before `begin`: a ball is slow again after its impact. */
static bool certain_condition(const inquiry *q, uint64_t begin, uint32_t *cause)
{
    for (uint32_t m = 0; m < q->x.measures->count; m++)
        if (q->certain[m] && q->shown[m].step + GAP >= begin) {
            *cause = m;
            return true;
        }
    return false;
}

/* Makes a cause of a failure that no measure announced. */
static rheo_finding cause_of_failure(const rheo_failure *f)
{
    return (rheo_finding){.measure = "",
                          .stage = f->stage,
                          .meaning = "",
                          .limit = NAN,
                          .seen = "",
                          .step = f->step,
                          .value = NAN,
                          .id = f->location == RHEO_LOCATION_PARTICLE ? (int64_t)f->id : -1,
                          .other_id = -1,
                          .peak = NAN,
                          .severe = true};
}

/* Sets the cause; returns its index, or the number of measures if the failure is all that is known. */
static uint32_t find_cause(inquiry *q)
{
    rheo_diagnosis *d = q->diagnosis;
    if (d->failed && !q->x.unhealthy) {
        d->unhealthy_step = d->failure.step;
        q->in_episode = q->in_episode && q->last_precursor + GAP >= d->unhealthy_step;
    }
    uint32_t cause;
    if (certain_condition(q, q->in_episode ? q->begin.step : d->unhealthy_step, &cause)) {
        d->cause = q->shown[cause];
    } else if (q->in_episode) {
        cause = q->beginning;
        d->cause = q->begin;
    } else {
        d->cause = cause_of_failure(&d->failure);
        return q->x.measures->count;
    }
    d->cause.peak = q->x.finding[cause].peak;
    d->cause.peak_step = q->x.finding[cause].peak_step;
    d->cause.steps = q->x.finding[cause].steps;
    d->cause.severe = true;
    return cause;
}

/* The step of the first sign: where the cause showed first, or where the condition became certain. */
static uint64_t sign_of(const inquiry *q, uint32_t cause)
{
    const rheo_diagnosis *d = q->diagnosis;
    if (cause < q->x.measures->count && q->certain[cause])
        return q->certain_since[cause] > d->first_step ? q->certain_since[cause] : d->first_step + 1;
    return d->cause.step;
}

/* Finds the commands before the last commanded step that is at most GAP steps before the first sign. */
static rheo_result find_suspects(inquiry *q, rheo_error *error)
{
    rheo_diagnosis *d = q->diagnosis;
    const uint64_t count = rheo_recording_command_count(q->recording);
    for (uint64_t i = 0; i < count; i++) {
        rheo_command c;
        RHEO__TRY(rheo_recording_command(q->recording, i, &c, error));
        if (c.step > d->sign_step)
            break;
        if (c.step + GAP < d->sign_step)
            continue;
        if (d->suspect_count && d->suspects[0].step != c.step)
            d->suspect_count = 0;
        if (d->suspect_count < RHEO_MAX_SUSPECTS)
            d->suspects[d->suspect_count] = c;
        d->suspect_count++;
    }
    return RHEO_OK;
}

/*
 * Says for each advice where to continue from: before the commands that precede the first sign, if all of them can be
 * given again, or else before the sign. The commands are the first thing to leave out.
 */
static void complete_advice(rheo_diagnosis *d)
{
    const uint64_t before_sign = d->sign_step > d->first_step ? d->sign_step - 1 : d->first_step;
    bool before_commands = d->suspect_count > 0 && d->suspect_count <= RHEO_MAX_SUSPECTS;
    for (uint32_t i = 0; before_commands && i < d->suspect_count; i++)
        before_commands = d->suspects[i].kind == RHEO_COMMAND_SET;
    for (uint32_t i = 0; i < d->advice_count; i++) {
        rheo_advice *a = &d->advice[i];
        char path[64];
        snprintf(path, sizeof path, "%.*s", (int)strcspn(a->set, "="), a->set);
        const rheo_parameter *p = rheo__parameter_find(path);
        a->from = before_commands ? d->suspects[0].step - 1 : before_sign;
        /* Commands of the next step are given again only if they set parameters. */
        const bool lost = d->suspect_count && !before_commands && d->suspects[0].step == a->from + 1;
        a->can_continue = a->can_continue && a->set[0] && p && p->live && !d->ill_from_start && !lost;
    }
    if (!d->suspect_count || d->advice_count == RHEO_MAX_ADVICE)
        return;
    memmove(d->advice + 1, d->advice, d->advice_count * sizeof *d->advice);
    d->advice_count++;
    d->advice[0] = (rheo_advice){.from = d->suspects[0].step - 1, .can_continue = true};
    snprintf(d->advice[0].text, sizeof d->advice[0].text, "without the command%s before step %llu",
             d->suspect_count > 1 ? "s" : "", (unsigned long long)d->suspects[0].step);
}

static void advise(const inquiry *q, uint32_t cause)
{
    rheo__case c = {.diagnosis = q->diagnosis,
                    .def = &q->unhealthy_def,
                    .names = q->x.observation.names,
                    .largest = q->largest,
                    .count = q->x.observation.count,
                    .measures = q->x.measures,
                    .episode = q->episode};
    if (cause < q->x.measures->count && row_of(q, cause)->advise)
        row_of(q, cause)->advise(&c);
    else
        q->x.measures->advise(&c);
}

/* ---- In words ---- */

/* What was done right before the first sign, or that the run was ill from its start. */
static void tell_history(const rheo_diagnosis *d, char *text, size_t size)
{
    if (d->ill_from_start && d->first_step == 0)
        rheo__text_add(text, size,
                       "it was ill from the start, so the scene blew up while it was made, before step 0; ");
    else if (d->ill_from_start)
        rheo__text_add(text, size, "the state at step %llu that it started from was ill; ",
                       (unsigned long long)d->first_step);
    if (d->suspect_count == 0)
        return;
    const uint64_t steps = d->sign_step - d->suspects[0].step;
    for (uint32_t i = 0; i < d->suspect_count && i < RHEO_MAX_SUSPECTS; i++)
        rheo__text_add(text, size, "%s%s", i ? ", " : "", d->suspects[i].text);
    if (d->suspect_count > RHEO_MAX_SUSPECTS)
        rheo__text_add(text, size, " and %u more", (unsigned)(d->suspect_count - RHEO_MAX_SUSPECTS));
    rheo__text_add(text, size, " before step %llu, ", (unsigned long long)d->suspects[0].step);
    if (steps == 0)
        rheo__text_add(text, size, "which has the first sign; ");
    else
        rheo__text_add(text, size, "%llu step%s before the first sign; ", (unsigned long long)steps,
                       steps > 1 ? "s" : "");
}

static void tell_cause(const rheo_diagnosis *d, char *text, size_t size)
{
    const rheo_finding *c = &d->cause;
    char finding[256];
    if (!c->measure[0] && d->finding_count == 0) {
        rheo__text_add(text, size, "every measure was in range up to the end");
        return;
    }
    if (!c->measure[0]) {
        rheo_finding_text(&d->findings[0], finding, sizeof finding);
        rheo__text_add(text, size, "nothing severe up to the end, but %s is %s", d->findings[0].measure, finding);
        return;
    }
    rheo_finding_text(c, finding, sizeof finding);
    rheo__text_add(text, size, "step %llu%s%s: %s (%s) is %s", (unsigned long long)c->step,
                   c->stage[0] ? ", stage " : "", c->stage, c->measure, c->meaning, finding);
}

/* A run that is healthy, although its first state was none to begin with: it may have blown up before and calmed down. */
static void tell_start(const inquiry *q, char *text, size_t size)
{
    const rheo_finding *f = &q->x.start;
    char finding[256];
    if (!q->x.ill_start)
        return;
    rheo_finding_text(f, finding, sizeof finding);
    rheo__text_add(text, size, "; but in the first state %s is %s%s", f->measure, finding,
                   f->step == 0 ? ": the scene had not settled, or was made to move" : "");
}

static void tell(const inquiry *q, rheo_diagnosis *d)
{
    const size_t size = sizeof d->why;
    snprintf(d->why, size, "%s: ", d->healthy ? "healthy" : "unhealthy");
    if (d->healthy) {
        rheo__text_add(d->why, size, "%s in step %llu to %llu",
                       d->finding_count ? "nothing severe" : "every measure is in range",
                       (unsigned long long)d->first_step, (unsigned long long)d->last_step);
        tell_start(q, d->why, size);
    } else {
        tell_history(d, d->why, size);
        tell_cause(d, d->why, size);
    }
    if (d->failed) {
        char message[512];
        rheo_failure_message(&d->failure, message, sizeof message);
        rheo__text_add(d->why, size, "; %s", message);
    }
    if (!d->complete)
        rheo__text_add(d->why, size, "; the recording is %s step %llu",
                       d->being_written ? "being written and has got to" : "truncated after",
                       (unsigned long long)d->last_step);
}

/* Lists the measures that left their ranges, first step first; within a step in the order of the rows. */
static void list_findings(const inquiry *q, rheo_diagnosis *d)
{
    for (uint32_t m = 0; m < q->x.measures->count; m++) {
        if (q->x.finding[m].steps == 0)
            continue;
        uint32_t index = d->finding_count++;
        for (; index > 0 && d->findings[index - 1].step > q->x.finding[m].step; index--)
            d->findings[index] = d->findings[index - 1];
        d->findings[index] = q->x.finding[m];
    }
}

static rheo_result diagnose(inquiry *q, rheo_error *error)
{
    rheo_diagnosis *d = q->diagnosis;
    RHEO__TRY(examine_steps(q, error));
    d->healthy = !q->x.unhealthy && !d->failed;
    list_findings(q, d); /* before the advice, which reads them */
    if (!d->healthy) {
        const uint32_t cause = find_cause(q);
        d->sign_step = sign_of(q, cause);
        d->ill_from_start = q->x.ill_start && d->sign_step <= d->first_step + GAP;
        if (!d->ill_from_start)
            RHEO__TRY(find_suspects(q, error));
        advise(q, cause);
        complete_advice(d);
    }
    tell(q, d);
    return RHEO_OK;
}

/* Begins with the definition and the names of the metrics of a recording. False: no memory. */
static bool begin(inquiry *q)
{
    const rheo__head *head = &q->recording->head;
    const rheo_allocator allocator = rheo__allocator_or_default((rheo_allocator){0});
    q->def = q->recording->def;
    q->largest = rheo__allocate(&allocator, (size_t)head->metric_count + 1, sizeof *q->largest);
    if (!rheo__examination_begin(&q->x, &allocator, &q->def, head->features, head->metric_count) || !q->largest)
        return false;
    memcpy(q->x.names, head->metrics, head->metric_count * sizeof *q->x.names);
    rheo__examination_find_columns(&q->x);
    return true;
}

rheo_result rheo_diagnose(rheo_recording *recording, rheo_diagnosis *diagnosis, rheo_error *error)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    *diagnosis =
        (rheo_diagnosis){.complete = info.complete, .first_step = info.first_step, .last_step = info.last_step};
    diagnosis->being_written = info.being_written;
    diagnosis->failed = rheo_recording_failure(recording, &diagnosis->failure);
    inquiry *q = calloc(1, sizeof *q); /* two definitions are large for a stack */
    if (!q)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to examine a recording");
    q->recording = recording;
    q->diagnosis = diagnosis;
    const rheo_result result =
        begin(q) ? diagnose(q, error) : rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to examine a recording");
    rheo__release(&q->x.allocator, q->largest);
    rheo__examination_end(&q->x);
    free(q);
    return result;
}
