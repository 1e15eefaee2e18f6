/* A verdict of the ladder in one line (record/same.h). */
#include "record/same.h"

#include "core/text.h"

typedef unsigned long long number;

static void tell_place(const rheo_same_ratio *r, const char *unit, char text[320])
{
    char ratio[32];
    rheo_number_brief(r->ratio, 3, ratio);
    snprintf(text, 320, "%s is off by %s %s at step %llu%s%s", r->field, ratio, unit, (number)r->step,
             r->stage[0] ? ", whose first other hash is that of stage " : "", r->stage);
}

static void tell_rounding(const rheo_same_steps *s, char text[448])
{
    char place[320];
    if (!s->tried) {
        snprintf(text, 448, "rounding was not tried, since the recording has no states near enough (--full has all)");
        return;
    }
    tell_place(s->passed ? &s->worst : &s->first, "times what 1 ulp does", place);
    if (s->passed && s->interval == 1)
        snprintf(text, 448, "%llu step%s, each from the recorded state; at most %s", (number)s->compared,
                 rheo__plural(s->compared), place);
    else if (s->passed)
        snprintf(text, 448, "%llu keyframe%s, each from the one before, %llu steps earlier; at most %s",
                 (number)s->compared, rheo__plural(s->compared), (number)s->interval, place);
    else if (s->first.field[0])
        snprintf(text, 448, "it is not rounding: %s", place);
    else if (s->decisions == 0)
        snprintf(text, 448, "rounding is not certain: 1 ulp grows too much from keyframe to keyframe in %llu of %llu",
                 (number)(s->available - s->compared), (number)s->available);
    else
        snprintf(text, 448, "it is not rounding: decisions fall otherwise in %llu of %llu steps",
                 (number)s->decisions, (number)s->compared);
}

void rheo__same_describe(rheo_same_result *r, const rheo_same_options *o, const rheo_error *why)
{
    const char *verdict = rheo_sameness_name(r->verdict);
    char text[448] = "";
    if (why) {
        snprintf(r->message, sizeof r->message, "%s: %.600s", verdict, why->message);
        return;
    }
    if (r->verdict == RHEO_SAMENESS_BITS)
        snprintf(text, sizeof text, "%llu step%s with the recorded hashes", (number)r->bits_steps,
                 rheo__plural(r->bits_steps));
    else
        tell_rounding(&r->rounding, text);
    snprintf(r->message, sizeof r->message, "%s: %s", verdict, text);
    (void)o;
}
