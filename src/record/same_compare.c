/*
 * The difference of two states in units of a yardstick (record/same.h): the recorded state and that of this build, against
 * the states of two steps of this build that differ by rounding, or by halving the step.
 *
 * For a field, of all values or of the largest: |recorded - own| / (|other - own| + 1 ulp of own). The ulp stands for the
 * rounding of the result, so that a field that does not respond at all has a yardstick, too.
 */
#include "record/same.h"

#include <math.h>
#include <string.h>

typedef struct sums {
    double difference2, yardstick2; /* sums of squares */
    double difference, yardstick;   /* the largest */
} sums;

static double ulp_of(rheo_element element, const void *values, size_t index)
{
    const uint64_t bits = rheo__element_bits(element, values, index);
    const double value = rheo__element_number(element, bits);
    if (element != RHEO_ELEMENT_F32 && element != RHEO_ELEMENT_F64)
        return 0;
    const double up = rheo__element_number(element, bits + 1); /* away from zero */
    return value - value != 0 || up - up != 0 ? 0 : fabs(up - value);
}

static void add(sums *s, double difference, double yardstick)
{
    if (!(difference == difference)) /* NaN: no value is comparable */
        difference = INFINITY;
    s->difference2 += difference * difference;
    s->yardstick2 += yardstick * yardstick;
    s->difference = difference > s->difference ? difference : s->difference;
    s->yardstick = yardstick > s->yardstick ? yardstick : s->yardstick;
}

/* The distance of two values; in periodic space that to the nearest image. */
static double distance(double a, double b, double period)
{
    double d = fabs(a - b);
    return period > 0 && d > period / 2 ? fabs(d - period) : d;
}

static void add_values(sums *s, rheo__field_id f, const rheo__same_states *states, size_t i, size_t j, size_t k,
                       double period)
{
    const rheo_element element = rheo__field_table[f].element;
    const void *recorded = states->recorded->data[f], *own = states->own->data[f], *other = states->other->data[f];
    const double r = rheo__element_number(element, rheo__element_bits(element, recorded, i));
    const double o = rheo__element_number(element, rheo__element_bits(element, own, j));
    const double m = rheo__element_number(element, rheo__element_bits(element, other, k));
    add(s, distance(r, o, period), distance(m, o, period) + ulp_of(element, own, j));
}

static uint64_t ends_at(const rheo__values *v, size_t k)
{
    const uint32_t *ends = v->data[RHEO__FIELD_spring_ends];
    return (uint64_t)ends[2 * k] << 32 | ends[2 * k + 1];
}

/* The number of springs that only one of two states has. */
static uint64_t other_springs(const rheo__values *a, const rheo__values *b)
{
    const size_t as = a->items[RHEO__FIELD_spring_ends], bs = b->items[RHEO__FIELD_spring_ends];
    uint64_t different = 0;
    for (size_t i = 0, j = 0; i < as || j < bs;) {
        const bool only_a = j >= bs || (i < as && ends_at(a, i) < ends_at(b, j));
        const bool only_b = i >= as || (j < bs && ends_at(b, j) < ends_at(a, i));
        different += only_a || only_b;
        i += !only_b;
        j += !only_a;
    }
    return different;
}

/* Rest lengths of the springs that all three states have. */
static void add_springs(sums *s, const rheo__same_states *t)
{
    const rheo__field_id f = RHEO__FIELD_spring_ends;
    size_t i = 0, j = 0, k = 0;
    while (i < t->recorded->items[f] && j < t->own->items[f] && k < t->other->items[f]) {
        const uint64_t a = ends_at(t->recorded, i), b = ends_at(t->own, j), c = ends_at(t->other, k);
        const uint64_t least = a < b ? (a < c ? a : c) : (b < c ? b : c);
        if (a == b && b == c)
            add_values(s, RHEO__FIELD_spring_rest_length, t, i, j, k, 0);
        i += a == least;
        j += b == least;
        k += c == least;
    }
}

static double quotient(double difference, double yardstick)
{
    return difference == 0 ? 0 : yardstick > 0 ? difference / yardstick : INFINITY;
}

/* Whether the numbers of a field count: neither integers, nor the history, nor those of the neighbour list. */
static bool is_compared(rheo__field_id f)
{
    const rheo__field *field = &rheo__field_table[f];
    return (field->storage == RHEO__FLAT || f == RHEO__FIELD_spring_rest_length) &&
           (field->element == RHEO_ELEMENT_F32 || field->element == RHEO_ELEMENT_F64) &&
           f != RHEO__FIELD_list_position && f != RHEO__FIELD_list_margin;
}

/* Sets all members of *ratio but step and stage. */
static void compare_field(rheo__field_id f, const rheo__same_states *t, rheo_same_ratio *ratio)
{
    sums s = {0};
    const size_t items = t->recorded->items[f];
    double count = (double)items * rheo__field_table[f].components;
    if (f == RHEO__FIELD_spring_rest_length) {
        add_springs(&s, t);
    } else if (t->own->items[f] != items || t->other->items[f] != items) {
        add(&s, INFINITY, 0);
    } else {
        const uint32_t components = rheo__field_table[f].components;
        for (size_t i = 0; i < items * components; i++)
            add_values(&s, f, t, i, i, i,
                       f == RHEO__FIELD_position ? (double)t->world->period.length[i % components] : 0);
    }
    count = count > 0 ? count : 1;
    *ratio = (rheo_same_ratio){.rms = sqrt(s.difference2 / count),
                               .largest = s.difference,
                               .rms_yardstick = sqrt(s.yardstick2 / count),
                               .largest_yardstick = s.yardstick};
    snprintf(ratio->field, sizeof ratio->field, "%s", rheo__field_table[f].name);
    const double rms = quotient(ratio->rms, ratio->rms_yardstick), largest = quotient(s.difference, s.yardstick);
    ratio->ratio = rms > largest ? rms : largest;
}

/* ---- Judging a step ---- */

/* One step of so many in which a decision falls otherwise may still be rounding. */
enum { STEPS_PER_DECISION = 50 };

static void note(rheo__same_judge *judge, rheo_same_ratio *ratio, uint64_t step, const char *stage)
{
    rheo_same_steps *result = judge->result;
    ratio->step = step;
    snprintf(ratio->stage, sizeof ratio->stage, "%s", stage);
    if (ratio->ratio > result->worst.ratio || !result->worst.field[0])
        result->worst = *ratio;
    if (ratio->ratio > judge->limit && result->passed) {
        result->passed = false;
        result->first = *ratio;
    }
}

/* The first field whose integers differ; RHEO__FIELD_COUNT: none. */
static rheo__field_id other_integer(const rheo__values *a, const rheo__values *b)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        const rheo__field *field = &rheo__field_table[f];
        if (!(a->present >> f & 1) || field->storage != RHEO__FLAT || f == RHEO__FIELD_step ||
            f == RHEO__FIELD_history_rows ||
            (field->element != RHEO_ELEMENT_U64 && field->element != RHEO_ELEMENT_U32))
            continue;
        if (a->items[f] != b->items[f] ||
            memcmp(a->data[f], b->data[f], a->items[f] * field->components * rheo__element_size(field->element)) != 0)
            return f;
    }
    return RHEO__FIELD_COUNT;
}

static bool has_springs(const rheo__values *v)
{
    return v->present >> RHEO__FIELD_spring_ends & 1;
}

/* Springs that only one side has, as a ratio of their numbers. */
static void compare_springs(const rheo__same_states *s, rheo_same_ratio *ratio)
{
    const double d = (double)other_springs(s->recorded, s->own), y = (double)other_springs(s->other, s->own);
    *ratio = (rheo_same_ratio){.rms = d, .largest = d, .rms_yardstick = y, .largest_yardstick = y};
    snprintf(ratio->field, sizeof ratio->field, "%s", rheo__field_table[RHEO__FIELD_spring_ends].name);
    ratio->ratio = d == 0 ? 0 : d / (y > 0 ? y : 1);
}

/* Whether a decision fell otherwise: a spring was made or broke, or a number of substeps or iterations differs. */
static bool other_decision(const rheo__values *a, const rheo__values *b)
{
    return other_integer(a, b) != RHEO__FIELD_COUNT || (has_springs(a) && other_springs(a, b));
}

static void note_decision(rheo__same_judge *judge, const rheo__same_states *s, uint64_t step, const char *stage)
{
    rheo_same_ratio *first = &judge->first_decision;
    const rheo__field_id integer = other_integer(s->recorded, s->own);
    judge->result->decisions++;
    if (first->field[0])
        return;
    if (integer == RHEO__FIELD_COUNT) {
        compare_springs(s, first);
    } else {
        first->ratio = INFINITY;
        snprintf(first->field, sizeof first->field, "%s", rheo__field_table[integer].name);
    }
    first->step = step;
    snprintf(first->stage, sizeof first->stage, "%s", stage);
}

void rheo__same_judge_states(rheo__same_judge *judge, const rheo__same_states *s, uint64_t step, const char *stage)
{
    rheo_same_ratio ratio;
    const bool decided = !judge->whole && other_decision(s->recorded, s->own);
    judge->decisions += !judge->whole && other_decision(s->other, s->own);
    judge->result->compared++;
    if (decided)
        note_decision(judge, s, step, stage);
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT && !decided; f++) {
        if (!(s->recorded->present >> f & 1) || !is_compared(f))
            continue;
        compare_field(f, s, &ratio);
        note(judge, &ratio, step, stage);
    }
    if (judge->whole && has_springs(s->recorded)) {
        compare_springs(s, &ratio);
        note(judge, &ratio, step, stage);
    }
}

void rheo__same_refuse(rheo__same_judge *judge, uint64_t step, const char *stage, const char *field)
{
    rheo_same_ratio ratio = {.ratio = INFINITY};
    snprintf(ratio.field, sizeof ratio.field, "%s", field);
    note(judge, &ratio, step, stage);
}

void rheo__same_judge_end(rheo__same_judge *judge)
{
    rheo_same_steps *result = judge->result;
    if (result->decisions <= result->compared / STEPS_PER_DECISION + judge->decisions)
        return;
    if (result->passed)
        result->first = judge->first_decision;
    result->passed = false;
}
