/*
 * Where, when and why a run became unhealthy, from the metrics and parameters that a recording holds. The model lists
 * the measures (world/measure.h); this file examines them in every step, finds the cause and describes it.
 *
 * A run is unhealthy if a severe measure left its range or a step failed. The cause is the first of the precursors
 * that lead up to that without a gap; but a condition beyond its second limit is the cause, even if another measure
 * leaves its range first.
 */
#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "record/recording.h"
#include "world/measure.h"

/* Precursors that are more steps apart do not belong together. */
enum { GAP = 10, MEASURES = RHEO_MAX_FINDINGS };

typedef struct examination {
    rheo_recording *recording;
    rheo_diagnosis *diagnosis;
    const rheo__measures *measures;
    int column[MEASURES], id_column[MEASURES], other_column[MEASURES]; /* metrics; -1: not recorded */
    rheo_world_def def;                                                /* definition in force in that step */
    rheo__observation observation;
    uint64_t step;
    uint64_t next_command; /* the first command that is not applied to `def` yet */

    rheo_finding finding[MEASURES]; /* finding.steps is 0: never out of range */
    rheo_finding shown[MEASURES];   /* conditions: the last time that they were certain, and where it showed */
    bool certain[MEASURES];         /* conditions: beyond the second limit, last in certain_step */
    uint64_t certain_step[MEASURES];
    uint64_t certain_since[MEASURES]; /* first of the steps without a gap that end with certain_step */

    bool in_episode;    /* precursors follow each other without a gap */
    uint32_t beginning; /* the measure that the episode began with */
    rheo_finding begin; /* its finding then */
    uint64_t last_precursor;
    double episode[MEASURES]; /* largest values in it, up to the unhealthy step */
    double *largest;          /* of every metric, up to the unhealthy step */
    bool ill_start;           /* the first state has such a measure or a particle that moves too far in a step */
    bool unhealthy;
    rheo_world_def unhealthy_def; /* definition in force in the unhealthy step, or else in the last one */
} examination;

/* ---- Values ---- */

static const rheo__measure *row_of(const examination *e, uint32_t m)
{
    return &e->measures->row[m];
}

/* False: the measure is not recorded, or has no meaning in this step. */
static bool value_of(const examination *e, uint32_t m, double *value)
{
    const rheo__measure *row = row_of(e, m);
    const rheo__observation *o = &e->observation;
    const int column = e->column[m];
    if (column < 0)
        return row->value && row->value(o, value);
    *value = o->now[column];
    if (o->unfinished && memcmp(value, &o->before[column], sizeof *value) == 0) /* not reached by the failed step */
        return false;
    return !row->value || row->value(o, value);
}

static int64_t id_of(const examination *e, int column)
{
    const double id = column >= 0 ? e->observation.now[column] : -1;
    return id >= 0 && id <= (double)UINT32_MAX ? (int64_t)id : -1;
}

static rheo_finding finding_of(const examination *e, uint32_t m, double value, double limit)
{
    const rheo__measure *row = row_of(e, m);
    return (rheo_finding){.measure = row->name,
                          .stage = row->stage,
                          .meaning = row->meaning,
                          .limit = limit,
                          .step = e->step,
                          .value = value,
                          .id = id_of(e, e->id_column[m]),
                          .other_id = id_of(e, e->other_column[m]),
                          .peak_step = e->step,
                          .peak = value,
                          .severe = row->kind == RHEO__SEVERE};
}

/* ---- A step ---- */

static void note(examination *e, uint32_t m, double value)
{
    const rheo__measure *row = row_of(e, m);
    rheo_finding *f = &e->finding[m];
    if (f->steps == 0)
        *f = finding_of(e, m, value, row->limit);
    f->steps++;
    if (value > f->peak || isnan(f->peak)) {
        f->peak = value;
        f->peak_step = e->step;
    }
    if (row->kind == RHEO__CONDITION && !e->unhealthy && !(value <= row->certain)) {
        if (!e->certain[m] || e->certain_step[m] + 1 < e->step)
            e->certain_since[m] = e->step;
        e->certain[m] = true;
        e->certain_step[m] = e->step;
        e->shown[m] = finding_of(e, m, value, row->certain);
    }
}

/* A precursor or a severe measure is out of range in a run that is still healthy. */
static void note_precursor(examination *e, uint32_t m, double value)
{
    if (!e->in_episode || e->step > e->last_precursor + GAP) {
        e->in_episode = true;
        e->begin = finding_of(e, m, value, row_of(e, m)->limit);
        e->beginning = m;
        memset(e->episode, 0, sizeof e->episode);
    }
    e->last_precursor = e->step;
}

static void examine_step(examination *e)
{
    bool severe = false, measured[MEASURES];
    double value[MEASURES];
    const bool was_unhealthy = e->unhealthy;
    for (uint32_t m = 0; m < e->measures->count; m++) {
        const rheo__measure *row = row_of(e, m);
        measured[m] = value_of(e, m, &value[m]);
        if (!measured[m] || value[m] <= row->limit) /* NaN is out of range */
            continue;
        note(e, m, value[m]);
        severe = severe || row->kind == RHEO__SEVERE;
        if (!e->observation.before &&
            (row->kind == RHEO__SEVERE || row->kind == RHEO__PRECURSOR || strcmp(row->name, "courant_number") == 0))
            e->ill_start = true;
        if (!was_unhealthy && (row->kind == RHEO__PRECURSOR || row->kind == RHEO__SEVERE))
            note_precursor(e, m, value[m]);
    }
    if (was_unhealthy)
        return;
    for (uint32_t m = 0; e->in_episode && m < e->measures->count; m++)
        if (measured[m])
            e->episode[m] = fmax(e->episode[m], value[m]);
    for (uint32_t i = 0; i < e->observation.count; i++)
        e->largest[i] = fmax(e->largest[i], e->observation.now[i]);
    if (severe) {
        e->unhealthy = true;
        e->diagnosis->unhealthy_step = e->step;
        e->unhealthy_def = e->def;
    }
}

/* Notes where conditions show: the particle or spring of their measure `seen`, in the step that is examined. */
static void show_conditions(examination *e)
{
    for (uint32_t m = 0; m < e->measures->count; m++) {
        if (!e->certain[m])
            continue;
        const uint32_t seen = rheo__measure_index(e->measures, row_of(e, m)->seen);
        assert(seen < e->measures->count);
        e->shown[m].step = e->step;
        e->shown[m].id = id_of(e, e->id_column[seen]);
        e->shown[m].other_id = id_of(e, e->other_column[seen]);
    }
}

/* Applies the commands before a step to the definition in force. */
static rheo_result apply_commands(examination *e, uint64_t step, rheo_error *error)
{
    rheo__observation *o = &e->observation;
    const uint64_t count = rheo_recording_command_count(e->recording);
    for (; e->next_command < count; e->next_command++) {
        rheo_command c;
        RHEO__TRY(rheo_recording_command(e->recording, e->next_command, &c, error));
        if (c.step > step)
            return RHEO_OK;
        o->added = o->added || c.kind == RHEO_COMMAND_ADD_PARTICLES;
        if (c.kind == RHEO_COMMAND_SET && rheo_world_def_set(&e->def, c.path, c.value, NULL) != RHEO_OK)
            return rheo__fail(error, RHEO_ERROR_FORMAT, "damaged: a command before step %llu sets %s to %.60s",
                              (unsigned long long)step, c.path, c.value);
    }
    return RHEO_OK;
}

/*
 * Examines all steps, and the failed one with its commands and the metrics that its stages reached. The parameters of
 * the first state are those in force in the first step, since no step was recorded with those that a command replaced.
 */
static rheo_result examine_steps(examination *e, double *values, rheo_error *error)
{
    rheo_diagnosis *d = e->diagnosis;
    rheo_recording *r = e->recording;
    rheo__observation *o = &e->observation;
    double *now = values, *before = values + o->count;
    const uint64_t end = d->last_step + d->failed;
    RHEO__TRY(apply_commands(e, d->first_step + 1, error));
    for (e->step = d->first_step; e->step <= end; e->step++) {
        o->begins = e->step == d->first_step;
        o->before = o->begins ? NULL : before;
        o->unfinished = e->step > d->last_step;
        RHEO__TRY(rheo_recording_metrics(r, e->step, now, error));
        if (e->step > d->first_step + 1) {
            o->added = false;
            RHEO__TRY(apply_commands(e, e->step, error));
        }
        o->now = now;
        const bool was_unhealthy = e->unhealthy;
        examine_step(e);
        if (!was_unhealthy && (e->unhealthy || e->step == end))
            show_conditions(e);
        double *other = now;
        now = before;
        before = other;
    }
    if (!e->unhealthy)
        e->unhealthy_def = e->def;
    return RHEO_OK;
}

/* ---- The cause ---- */

/* A condition that was certain at or shortly before `begin`: a ball is slow again after its impact. */
static bool certain_condition(const examination *e, uint64_t begin, uint32_t *cause)
{
    for (uint32_t m = 0; m < e->measures->count; m++)
        if (e->certain[m] && e->certain_step[m] + GAP >= begin) {
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
                          .step = f->step,
                          .value = NAN,
                          .id = f->location == RHEO_LOCATION_PARTICLE ? (int64_t)f->id : -1,
                          .other_id = -1,
                          .peak = NAN,
                          .severe = true};
}

/* Sets the cause; returns its index, or the number of measures if the failure is all that is known. */
static uint32_t find_cause(examination *e)
{
    rheo_diagnosis *d = e->diagnosis;
    if (d->failed && !e->unhealthy) {
        d->unhealthy_step = d->failure.step;
        e->in_episode = e->in_episode && e->last_precursor + GAP >= d->unhealthy_step;
    }
    uint32_t cause;
    if (certain_condition(e, e->in_episode ? e->begin.step : d->unhealthy_step, &cause)) {
        d->cause = e->shown[cause];
    } else if (e->in_episode) {
        cause = e->beginning;
        d->cause = e->begin;
    } else {
        d->cause = cause_of_failure(&d->failure);
        return e->measures->count;
    }
    d->cause.peak = e->finding[cause].peak;
    d->cause.peak_step = e->finding[cause].peak_step;
    d->cause.steps = e->finding[cause].steps;
    d->cause.severe = true;
    return cause;
}

/* The step of the first sign: where the cause showed first, or where the condition became certain. */
static uint64_t sign_of(const examination *e, uint32_t cause)
{
    const rheo_diagnosis *d = e->diagnosis;
    if (cause < e->measures->count && row_of(e, cause)->kind == RHEO__CONDITION && e->certain[cause])
        return e->certain_since[cause] > d->first_step ? e->certain_since[cause] : d->first_step + 1;
    return d->cause.step;
}

/* Finds the commands before the last commanded step that is at most GAP steps before the first sign. */
static rheo_result find_suspects(examination *e, rheo_error *error)
{
    rheo_diagnosis *d = e->diagnosis;
    const uint64_t count = rheo_recording_command_count(e->recording);
    for (uint64_t i = 0; i < count; i++) {
        rheo_command c;
        RHEO__TRY(rheo_recording_command(e->recording, i, &c, error));
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

static void advise(const examination *e, uint32_t cause)
{
    rheo__case c = {.diagnosis = e->diagnosis,
                    .def = &e->unhealthy_def,
                    .names = e->observation.names,
                    .largest = e->largest,
                    .count = e->observation.count,
                    .measures = e->measures,
                    .episode = e->episode};
    if (cause < e->measures->count && row_of(e, cause)->advise)
        row_of(e, cause)->advise(&c);
    else
        e->measures->advise(&c);
}

/* ---- In words ---- */

__attribute__((format(printf, 3, 4))) static void add(char *text, size_t size, const char *format, ...)
{
    const size_t used = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + used, size - used, format, arguments);
    va_end(arguments);
}

/* What was done right before the first sign, or that the run was ill from its start. */
static void tell_history(const rheo_diagnosis *d, char *text, size_t size)
{
    if (d->ill_from_start && d->first_step == 0)
        add(text, size, "it was ill from the start, so the scene blew up while it was made, before step 0; ");
    else if (d->ill_from_start)
        add(text, size, "the state at step %llu that it started from was ill; ", (unsigned long long)d->first_step);
    if (d->suspect_count == 0)
        return;
    const uint64_t steps = d->sign_step - d->suspects[0].step;
    for (uint32_t i = 0; i < d->suspect_count && i < RHEO_MAX_SUSPECTS; i++)
        add(text, size, "%s%s", i ? ", " : "", d->suspects[i].text);
    if (d->suspect_count > RHEO_MAX_SUSPECTS)
        add(text, size, " and %u more", (unsigned)(d->suspect_count - RHEO_MAX_SUSPECTS));
    add(text, size, " before step %llu, ", (unsigned long long)d->suspects[0].step);
    if (steps == 0)
        add(text, size, "which has the first sign; ");
    else
        add(text, size, "%llu step%s before the first sign; ", (unsigned long long)steps, steps > 1 ? "s" : "");
}

static void tell_cause(const rheo_diagnosis *d, char *text, size_t size)
{
    const rheo_finding *c = &d->cause;
    char value[32], limit[32], where[64] = "";
    if (c->other_id >= 0)
        snprintf(where, sizeof where, ", spring %lld:%lld", (long long)c->id, (long long)c->other_id);
    else if (c->id >= 0)
        snprintf(where, sizeof where, ", particle %lld", (long long)c->id);
    if (c->measure[0])
        add(text, size, "step %llu%s%s: %s (%s) is %s, more than %s%s", (unsigned long long)c->step,
            c->stage[0] ? ", stage " : "", c->stage, c->measure, c->meaning,
            rheo__text_brief(c->value, 3, false, value), rheo__text_brief(c->limit, 3, false, limit), where);
    else
        add(text, size, "every measure was in range up to the end");
}

static void tell(rheo_diagnosis *d)
{
    const size_t size = sizeof d->why;
    snprintf(d->why, size, "%s: ", d->healthy ? "healthy" : "unhealthy");
    if (d->healthy) {
        add(d->why, size, "%s in step %llu to %llu",
            d->finding_count ? "nothing severe" : "every measure is in range", (unsigned long long)d->first_step,
            (unsigned long long)d->last_step);
    } else {
        tell_history(d, d->why, size);
        tell_cause(d, d->why, size);
    }
    if (d->failed) {
        char message[512];
        rheo_failure_message(&d->failure, message, sizeof message);
        add(d->why, size, "; %s", message);
    }
    if (!d->complete)
        add(d->why, size, "; the recording is %s step %llu",
            d->being_written ? "being written and has got to" : "truncated after", (unsigned long long)d->last_step);
}

/* Lists the measures that left their ranges, first step first; within a step in the order of the rows. */
static void list_findings(const examination *e, rheo_diagnosis *d)
{
    for (uint32_t m = 0; m < e->measures->count; m++) {
        if (e->finding[m].steps == 0)
            continue;
        uint32_t index = d->finding_count++;
        for (; index > 0 && d->findings[index - 1].step > e->finding[m].step; index--)
            d->findings[index] = d->findings[index - 1];
        d->findings[index] = e->finding[m];
    }
}

static void find_columns(examination *e)
{
    const rheo__observation *o = &e->observation;
    assert(e->measures->count <= MEASURES);
    for (uint32_t m = 0; m < e->measures->count; m++) {
        const rheo__measure *row = row_of(e, m);
        e->column[m] = rheo__metric_index(o->names, o->count, row->name);
        e->id_column[m] = row->id ? rheo__metric_index(o->names, o->count, row->id) : -1;
        e->other_column[m] = row->other_id ? rheo__metric_index(o->names, o->count, row->other_id) : -1;
    }
}

static rheo_result diagnose(examination *e, rheo_error *error)
{
    rheo_diagnosis *d = e->diagnosis;
    double *values = calloc(3 * (size_t)e->observation.count + 1, sizeof *values);
    if (!values)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the metrics of a recording");
    e->largest = values + 2 * (size_t)e->observation.count;
    rheo_result result = examine_steps(e, values, error);
    d->healthy = result == RHEO_OK && !e->unhealthy && !d->failed;
    if (result == RHEO_OK && !d->healthy) {
        const uint32_t cause = find_cause(e);
        d->sign_step = sign_of(e, cause);
        d->ill_from_start = e->ill_start && d->sign_step <= d->first_step + GAP;
        if (!d->ill_from_start)
            result = find_suspects(e, error);
        advise(e, cause);
        complete_advice(d);
    }
    free(values);
    RHEO__TRY(result);
    list_findings(e, d);
    tell(d);
    return RHEO_OK;
}

rheo_result rheo_diagnose(rheo_recording *recording, rheo_diagnosis *diagnosis, rheo_error *error)
{
    const rheo_recording_info info = rheo_recording_get_info(recording);
    *diagnosis =
        (rheo_diagnosis){.complete = info.complete, .first_step = info.first_step, .last_step = info.last_step};
    diagnosis->being_written = info.being_written;
    diagnosis->failed = rheo_recording_failure(recording, &diagnosis->failure);
    examination *e = calloc(1, sizeof *e); /* two definitions are large for a stack */
    if (!e)
        return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to examine a recording");
    e->recording = recording;
    e->diagnosis = diagnosis;
    e->def = *rheo_recording_definition(recording);
    e->measures = rheo__measures_of(&e->def);
    e->observation = (rheo__observation){.def = &e->def,
                                         .features = recording->head.features,
                                         .names = recording->head.metrics,
                                         .count = recording->head.metric_count};
    find_columns(e);
    rheo_result result = diagnose(e, error);
    free(e);
    return result;
}
