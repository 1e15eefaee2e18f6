/* Functions for the measures of all models, and the measures of a model that lists none. */
#include <stdio.h>
#include <string.h>

#include "core/text.h"
#include "world/measure.h"
#include "world/model.h"

static const rheo__measure GENERAL_ROWS[] = {
    RHEO__MEASURE_SPEED_JUMP(""),
    RHEO__MEASURE_RUNAWAY_SPEED(""),
    RHEO__MEASURE_COURANT_NUMBER(""),
};
static const rheo__measures GENERAL = {GENERAL_ROWS, sizeof GENERAL_ROWS / sizeof *GENERAL_ROWS,
                                       rheo__advise_half_step};

const rheo__measures *rheo__measures_of(const rheo_world_def *def)
{
    const rheo__model_type *type = rheo__model(def->model);
    return type->measures ? type->measures(def) : &GENERAL;
}

uint32_t rheo__measure_index(const rheo__measures *measures, const char *name)
{
    uint32_t index = 0;
    while (index < measures->count && strcmp(measures->row[index].name, name) != 0)
        index++;
    return index;
}

int rheo__metric_index(const rheo__metric_name *names, uint32_t count, const char *name)
{
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(names[i].text, name) == 0)
            return (int)i;
    return -1;
}

/* ---- Values ---- */

bool rheo__observed(const rheo__observation *o, const char *metric, double *value)
{
    const int index = rheo__metric_index(o->names, o->count, metric);
    if (index < 0)
        return false;
    *value = o->now[index];
    return true;
}

bool rheo__observed_speed_rise(const rheo__observation *o, double *rise)
{
    const double grown = 1.5;
    const int index = rheo__metric_index(o->names, o->count, "max_speed");
    if (index < 0 || !o->before || o->unfinished || o->added || o->now[index] <= grown * o->before[index])
        return false;
    *rise = o->now[index] - o->before[index];
    return true;
}

bool rheo__measure_speed_jump(const rheo__observation *o, double *value)
{
    double rise;
    if (!rheo__observed_speed_rise(o, &rise))
        return false;
    *value = rise * (o->def->step / rheo__def_support(o->def));
    return true;
}

bool rheo__measure_runaway_speed(const rheo__observation *o, double *value)
{
    return rheo__observed(o, "courant_number", value);
}

/* ---- Advice ---- */

double rheo__case_metric(const rheo__case *c, const char *metric)
{
    const int index = rheo__metric_index(c->names, c->count, metric);
    return index < 0 ? 0 : c->largest[index];
}

double rheo__case_measure(const rheo__case *c, const char *measure)
{
    const uint32_t index = rheo__measure_index(c->measures, measure);
    return index < c->measures->count ? c->episode[index] : 0;
}

void rheo__advise_words(rheo__case *c, const char *set, const char *text)
{
    rheo_diagnosis *d = c->diagnosis;
    if (d->advice_count == RHEO_MAX_ADVICE)
        return;
    rheo_advice *a = &d->advice[d->advice_count++];
    a->can_continue = true;
    snprintf(a->set, sizeof a->set, "%s", set);
    snprintf(a->text, sizeof a->text, "%s", text);
}

void rheo__advise(rheo__case *c, const char *path, double value, const char *text)
{
    const rheo_parameter *p = rheo__parameter_find(path);
    const char *end;
    char number[32], set[64];
    if (!(value > 0 && value < 1e300))
        return;
    const double rounded = rheo__text_to_double(rheo__text_brief(value, 2, true, number), &end);
    if (!(rounded >= p->minimum && rounded <= p->maximum))
        return;
    snprintf(set, sizeof set, "%s=%s", path, number);
    rheo__advise_words(c, set, text);
}

void rheo__advise_making(rheo__case *c)
{
    const rheo_diagnosis *d = c->diagnosis;
    for (uint32_t i = 0; i < d->advice_count && d->first_step == 0 && d->sign_step <= 1; i++)
        c->diagnosis->advice[i].can_continue = false;
}

void rheo__advise_half_step(rheo__case *c)
{
    rheo__advise(c, "step", c->def->step / 2, "a smaller step is what helps most often");
}

void rheo__advise_runaway(rheo__case *c)
{
    rheo__advise(c, "step", c->def->step * 0.25 / c->diagnosis->cause.value,
                 "the fastest particle then moves a quarter of a support a step; or let it be slower");
}

/* ---- In words ---- */

static void where(const rheo_finding *f, char text[64])
{
    if (f->other_id >= 0)
        snprintf(text, 64, "spring %lld:%lld", (long long)f->id, (long long)f->other_id);
    else
        snprintf(text, 64, "particle %lld", (long long)f->id);
}

void rheo_finding_text(const rheo_finding *f, char *text, size_t size)
{
    char value[32], limit[32], place[64], seen[32];
    rheo__text_two(f->value, f->limit, value, limit);
    snprintf(text, size, "%s, more than %s", value, limit);
    if (f->id < 0)
        return;
    where(f, place);
    if (strcmp(f->seen, f->measure) == 0) {
        rheo__text_add(text, size, ", %s", place);
        return;
    }
    rheo__text_add(text, size, "; %s is %s at %s", f->seen, rheo__text_brief(f->seen_value, 3, false, seen), place);
    if (f->seen_step != f->step)
        rheo__text_add(text, size, " in step %llu", (unsigned long long)f->seen_step);
}
