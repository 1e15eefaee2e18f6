/* A verdict of the ladder in one line (record/same.h). */
#include "record/same.h"

#include "core/text.h"

typedef unsigned long long number;
enum { PART = 448 };

static void tell_place(const rheo_same_ratio *r, const char *unit, char text[320])
{
    char ratio[32];
    rheo_number_brief(r->ratio, 3, ratio);
    snprintf(text, 320, "%s is off by %s times what %s does at step %llu%s%s", r->field, ratio, unit, (number)r->step,
             r->stage[0] ? ", whose first other hash is that of stage " : "", r->stage);
}

static void tell_rounding(const rheo_same_steps *s, char text[PART])
{
    char place[320];
    if (!s->tried) {
        snprintf(text, PART,
                 "rounding was not tried, since the recording has no states near enough (--full has all)");
        return;
    }
    tell_place(s->passed ? &s->worst : &s->first, "1 ulp", place);
    if (s->passed && s->interval == 1)
        snprintf(text, PART, "%llu step%s, each from the recorded state; at most %s", (number)s->compared,
                 rheo__plural(s->compared), place);
    else if (s->passed)
        snprintf(text, PART, "%llu keyframe%s, each from the one before, %llu steps earlier; at most %s",
                 (number)s->compared, rheo__plural(s->compared), (number)s->interval, place);
    else if (s->first.field[0])
        snprintf(text, PART, "it is not rounding: %s", place);
    else
        snprintf(text, PART, "rounding is not certain: in %llu of %llu intervals, 1 ulp grows too much",
                 (number)(s->available - s->compared), (number)s->available);
}

/* Values of members that differ, or that none does. */
static void tell_statistics(const rheo_same_statistics *s, char text[PART])
{
    const rheo_same_metric *m = &s->metrics[0];
    char shift[32], p[32];
    rheo_number_brief(m->shift, 3, shift);
    rheo_number_brief(m->p, 2, p);
    if (s->went_bad)
        snprintf(text, PART, "a run of this build went bad: %.320s", s->why);
    else if (s->too_early)
        snprintf(text, PART, "too early for statistics: the spread of the runs still grows at the end");
    else if (s->rejected)
        snprintf(text, PART, "%u of %u values of %u + %u runs differ; %s by %s standard deviations, p = %s",
                 s->rejected, s->metric_count, s->members[0], s->members[1], m->name, shift, p);
    else
        snprintf(text, PART, "none of %u values of %u + %u runs differs", s->metric_count, s->members[0],
                 s->members[1]);
}

void rheo__same_describe(rheo_same_result *r, const rheo_same_options *o, const rheo_error *why)
{
    const char *verdict = rheo_sameness_name(r->verdict);
    char rounding[PART], statistics[PART], step[320];
    tell_rounding(&r->rounding, rounding);
    tell_statistics(&r->statistics, statistics);
    tell_place(&r->step.worst, "halving the step", step);
    if (why)
        snprintf(r->message, sizeof r->message, "%s: %.600s", verdict, why->message);
    else if (r->verdict == RHEO_SAMENESS_BITS)
        snprintf(r->message, sizeof r->message, "%s: %llu step%s with the recorded hashes", verdict,
                 (number)r->bits_steps, rheo__plural(r->bits_steps));
    else if (r->verdict == RHEO_SAMENESS_STEP)
        snprintf(r->message, sizeof r->message, "%s: at most %s; %.300s", verdict, step, statistics);
    else if (r->statistics.tried && r->verdict != RHEO_SAMENESS_ROUNDING && o->at_least <= RHEO_SAMENESS_STEP)
        snprintf(r->message, sizeof r->message, "%s: %s; %.280s", verdict, statistics, rounding);
    else if (o->at_least <= RHEO_SAMENESS_ROUNDING)
        snprintf(r->message, sizeof r->message, "%s: %s", verdict, rounding);
    else
        snprintf(r->message, sizeof r->message, "%s: only %llu step%s with the recorded hashes", verdict,
                 (number)r->bits_steps, rheo__plural(r->bits_steps));
}
