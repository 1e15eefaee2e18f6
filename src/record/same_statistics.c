/*
 * Rung statistics: members of the recorded side against members of this build. Each value of the members is tested by ranks
 * (record/rank_test.h), all of them together by Benjamini and Yekutieli. Values whose spread still grows from one part of
 * the run to the next show how far rounding has been amplified, and not what the physics is, so they are left out.
 */
#include <stdlib.h>
#include <string.h>

#include "core/progress.h"
#include "core/text.h"
#include "record/members.h"

/* The rate of false rejections, and the growth of a spread from one part to the next from which on it still grows. */
#define RATE 0.01
#define GROWTH 4.0

enum { SPLITS = 1000 };

typedef struct moments {
    double mean, deviation;
} moments;

static moments moments_of(const double *x, uint32_t count)
{
    double sum = 0, squares = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += x[i];
    const double mean = sum / count;
    for (uint32_t i = 0; i < count; i++)
        squares += (x[i] - mean) * (x[i] - mean);
    return (moments){mean, __builtin_sqrt(squares / (count - 1))};
}

static const double *results(const rheo__members *m, uint32_t value)
{
    return m->result + value * (size_t)m->count;
}

/* ---- Which values are tested ---- */

static bool follows(const rheo__member_value *a, const rheo__member_value *b)
{
    return a->kind == RHEO__MEMBER_MEAN && b->kind == RHEO__MEMBER_MEAN && strcmp(a->metric, b->metric) == 0 &&
           a->to == b->from;
}

/* Whether the spread of a metric's means grows neither into this part of the run nor into a later one. */
static bool has_settled(const rheo__members *m, uint32_t value)
{
    bool settled = true;
    for (uint32_t i = value; settled && i < m->values && (i == value || follows(&m->value[i - 1], &m->value[i])); i++)
        settled = moments_of(results(m, i), m->count).deviation <=
                  GROWTH * moments_of(results(m, i - 1), m->count).deviation;
    return settled;
}

/* The mean of an event's metric over the part of the run in which the event is; `values` if there is none. */
static uint32_t part_of(const rheo__members *m, uint32_t event)
{
    const rheo__member_value *e = &m->value[event];
    const double when = moments_of(results(m, event), m->count).mean;
    for (uint32_t i = 0; i < m->values; i++) {
        const rheo__member_value *v = &m->value[i];
        if (v->kind == RHEO__MEMBER_MEAN && strcmp(v->metric, e->metric) == 0 && when > (double)v->from &&
            (when <= (double)v->to || v->to == e->to))
            return i;
    }
    return m->values;
}

/* Whether a value can be tested, by the recorded side alone: so the same values are, whatever the other side is. */
static bool is_tested(const rheo__members *m, uint32_t value)
{
    if (m->value[value].kind != RHEO__MEMBER_MEAN)
        value = part_of(m, value);
    return value < m->values && value > 0 && follows(&m->value[value - 1], &m->value[value]) && has_settled(m, value);
}

/* The first part of a run, whose spread cannot be compared with an earlier one, and its events. */
static bool is_first_part(const rheo__members *m, uint32_t value)
{
    const uint32_t part = m->value[value].kind == RHEO__MEMBER_MEAN ? value : part_of(m, value);
    return part == m->values || part == 0 || !follows(&m->value[part - 1], &m->value[part]);
}

/* ---- Comparing two sides ---- */

/* The values that are tested, for all members of both sides. */
typedef struct table {
    uint32_t count;
    uint32_t value[RHEO__MEMBER_VALUES];
    double p[RHEO__MEMBER_VALUES];
    uint32_t order[RHEO__MEMBER_VALUES];
} table;

static rheo_result no_memory(rheo_error *error)
{
    return rheo__fail(error, RHEO_ERROR_MEMORY, "no memory to compare statistics");
}

static rheo_result test_value(const rheo__members *a, const rheo__members *b, uint32_t value, rheo__rank_sums *sums,
                              double *p, rheo_error *error)
{
    double all[2 * RHEO__RANK_MOST];
    rheo__ranks_of ranks;
    memcpy(all, results(a, value), a->count * sizeof *all);
    memcpy(all + a->count, results(b, value), b->count * sizeof *all);
    rheo__rank(&ranks, all, a->count, a->count + b->count);
    if (!rheo__rank_sums_take(sums, &ranks))
        return no_memory(error);
    uint32_t sum = 0;
    for (uint32_t i = 0; i < a->count; i++)
        sum += ranks.rank[i];
    const double apart = __builtin_fabs(moments_of(all, a->count).mean - moments_of(all + a->count, b->count).mean);
    *p = apart <= a->value[value].counts ? 1 : rheo__rank_probability(sums, sum);
    return RHEO_OK;
}

static void describe(const rheo__member_value *v, char name[96])
{
    char level[32];
    switch (v->kind) {
    case RHEO__MEMBER_MEAN:
        snprintf(name, 96, "%.47s, mean of steps %llu to %llu", v->metric, (unsigned long long)v->from + 1,
                 (unsigned long long)v->to);
        break;
    case RHEO__MEMBER_PASSES:
        snprintf(name, 96, "%.47s passes %s", v->metric, rheo__text_brief(v->level, 4, false, level));
        break;
    case RHEO__MEMBER_LEAST:
    case RHEO__MEMBER_LARGEST:
    default:
        snprintf(name, 96, "%.47s is %s", v->metric, v->kind == RHEO__MEMBER_LEAST ? "least" : "largest");
    }
}

static void report(const rheo__members *a, const rheo__members *b, const rheo_world *world, uint32_t value, double p,
                   rheo_same_metric *to)
{
    const moments old = moments_of(results(a, value), a->count), new = moments_of(results(b, value), b->count);
    const double spread = old.deviation > new.deviation ? old.deviation : new.deviation;
    const rheo__member_value *v = &a->value[value];
    *to = (rheo_same_metric){.mean = {old.mean, new.mean}, .deviation = {old.deviation, new.deviation}, .p = p};
    to->shift = new.mean == old.mean ? 0 : __builtin_fabs(new.mean - old.mean) / spread;
    describe(v, to->name);
    snprintf(to->unit, sizeof to->unit, "%s", v->kind == RHEO__MEMBER_MEAN ? "" : "steps");
    for (uint32_t i = 0; v->kind == RHEO__MEMBER_MEAN && i < rheo_world_metric_count(world); i++)
        if (strcmp(rheo_world_metric_name(world, i), v->metric) == 0)
            snprintf(to->unit, sizeof to->unit, "%s", rheo_world_metric_info(world, i)->unit);
}

static void choose(const rheo__members *a, table *t, uint32_t *left_out)
{
    for (uint32_t i = 0; i < a->values; i++) {
        if (is_first_part(a, i))
            continue;
        if (is_tested(a, i))
            t->value[t->count++] = i;
        else
            ++*left_out;
    }
}

static rheo_result compare(const rheo__members *a, const rheo__members *b, const rheo_world *world, table *t,
                           rheo_same_statistics *s, rheo_error *error)
{
    rheo__rank_sums sums = {0};
    choose(a, t, &s->left_out);
    rheo_result result = RHEO_OK;
    for (uint32_t i = 0; result == RHEO_OK && i < t->count; i++)
        result = test_value(a, b, t->value[i], &sums, &t->p[i], error);
    rheo__rank_sums_release(&sums);
    if (result != RHEO_OK)
        return result;
    s->metric_count = t->count;
    s->too_early = t->count == 0;
    s->rejected = rheo__reject(t->p, t->order, t->count, RATE);
    for (uint32_t i = 0; i < t->count && i < RHEO_MOST_SAME_METRICS; i++) {
        report(a, b, world, t->value[t->order[i]], t->p[t->order[i]], &s->metrics[i]);
        s->metrics[i].rejected = i < s->rejected;
    }
    s->passed = t->count > 0 && s->rejected == 0;
    return RHEO_OK;
}

/* ---- Checking the check ---- */

/* xorshift64; never 0. */
static uint64_t draw(uint64_t *random)
{
    *random ^= *random << 13;
    *random ^= *random >> 7;
    *random ^= *random << 17;
    return *random;
}

/* Draws which half of the runs comes first. */
static void shuffle(uint32_t *place, uint32_t count, uint64_t *random)
{
    for (uint32_t i = 0; i < count; i++)
        place[i] = i;
    for (uint32_t i = count - 1; i > 0; i--) {
        const uint32_t j = (uint32_t)(draw(random) % (i + 1)), kept = place[i];
        place[i] = place[j];
        place[j] = kept;
    }
}

/* A value of all runs: their ranks, which no split changes, and how the sum of those of a half is distributed. */
typedef struct pooled {
    rheo__ranks_of ranks;
    rheo__rank_sums sums;
} pooled;

static rheo_result pool(const rheo__members *runs, pooled *values, rheo_error *error)
{
    for (uint32_t i = 0; i < runs->values; i++) {
        rheo__rank(&values[i].ranks, results(runs, i), runs->count / 2, runs->count);
        if (!rheo__rank_sums_take(&values[i].sums, &values[i].ranks))
            return no_memory(error);
    }
    return RHEO_OK;
}

/* The probability of a value of two halves: `place` is even for the runs of the first one. */
static double test_split(const rheo__members *runs, const pooled *values, uint32_t value, const uint32_t *place)
{
    double sum[2] = {0, 0};
    uint32_t ranks = 0;
    for (uint32_t k = 0; k < runs->count; k++) {
        sum[place[k] & 1] += results(runs, value)[k];
        ranks += place[k] & 1 ? 0 : values[value].ranks.rank[k];
    }
    const double apart = __builtin_fabs(sum[0] - sum[1]) / (runs->count / 2);
    return apart <= runs->value[value].counts ? 1 : rheo__rank_probability(&values[value].sums, ranks);
}

/* Splits the runs of one program in two halves, and counts how often the halves differ. */
static rheo_result check_splits(const rheo__members *runs, const pooled *values, table *t, rheo_same_statistics *s,
                                rheo_error *error)
{
    uint64_t random = UINT64_C(88172645463325252);
    rheo__members half = {0};
    RHEO__TRY(rheo__members_like(runs, runs->count / 2, 0, &half, error));
    rheo_result result = RHEO_OK;
    for (uint64_t n = 0; result == RHEO_OK && n < SPLITS; n++) {
        uint32_t place[2 * RHEO__RANK_MOST], grown = 0;
        shuffle(place, runs->count, &random);
        for (uint32_t i = 0; i < runs->values; i++)
            for (uint32_t k = 0; k < runs->count; k++)
                if (!(place[k] & 1))
                    half.result[i * (size_t)half.count + place[k] / 2] = results(runs, i)[k];
        t->count = 0;
        choose(&half, t, &grown);
        for (uint32_t i = 0; i < t->count; i++)
            t->p[i] = test_split(runs, values, t->value[i], place);
        s->self_checks++;
        s->false_alarms += rheo__reject(t->p, t->order, t->count, RATE) > 0;
        result = rheo__progress("checking", n + 1, SPLITS, error);
    }
    rheo__members_release(&half);
    return result;
}

static rheo_result check_runs(const rheo__members *runs, table *t, rheo_same_statistics *s, rheo_error *error)
{
    pooled *values = calloc(runs->values + (size_t)1, sizeof *values);
    rheo_result result = values ? pool(runs, values, error) : no_memory(error);
    if (result == RHEO_OK)
        result = check_splits(runs, values, t, s, error);
    for (uint32_t i = 0; values && i < runs->values; i++)
        rheo__rank_sums_release(&values[i].sums);
    free(values);
    return result;
}

/* Twice as many runs of this side as a comparison has, the first ones being those that were compared. */
static rheo_result self_check(rheo_recording *r, const rheo_same_options *options, const rheo__members *b, table *t,
                              rheo_same_statistics *s, rheo_error *error)
{
    rheo__members more = {0}, all = {0};
    rheo_result result = rheo__members_like(b, b->count, b->seed + b->count, &more, error);
    if (result == RHEO_OK)
        result = rheo__members_run(r, options, &more, error);
    if (result == RHEO_OK)
        result = rheo__members_like(b, 2 * b->count, b->seed, &all, error);
    for (uint32_t i = 0; result == RHEO_OK && i < b->values; i++) {
        memcpy(all.result + i * (size_t)all.count, results(b, i), b->count * sizeof(double));
        memcpy(all.result + i * (size_t)all.count + b->count, results(&more, i), b->count * sizeof(double));
    }
    if (result == RHEO_OK)
        result = check_runs(&all, t, s, error);
    rheo__members_release(&more);
    rheo__members_release(&all);
    return result;
}

/* ---- The two sides ---- */

/* Runs the recorded side with this build, which must be the program that recorded. */
static rheo_result make_recorded(rheo_recording *r, const rheo_same_options *options, rheo__members *a,
                                 rheo_error *error)
{
    rheo_world *world;
    rheo_verification v = {0};
    RHEO__TRY(rheo__keyframe_world(r, &r->keyframes[0], NULL, &world, error));
    rheo_result result = rheo__verify_world(r, world, &v, error);
    rheo_world_destroy(world);
    RHEO__TRY(result);
    if (v.verdict != RHEO_SAME)
        return rheo__fail(error, RHEO_ERROR_UNSUPPORTED,
                          "it has no members, and this build does not reproduce it; make them with the program that "
                          "made it: rheolog same GOLDEN --keep-members");
    return rheo__members_make(r, options->members, options->seed, a, error);
}

/* This build without other parameters may be the one that was recorded: then its members are the recorded ones. */
static rheo_result make_sides(rheo_recording *r, const rheo_same_options *options, rheo__members *made,
                              rheo__members *b, rheo_same_statistics *s, rheo_error *error)
{
    s->stored = r->members != NULL;
    if (!r->members)
        RHEO__TRY(make_recorded(r, options, made, error));
    const rheo__members *a = r->members ? r->members : made;
    const uint32_t count = r->members && options->members < a->count ? options->members : a->count;
    RHEO__TRY(rheo__members_like(a, count, a->seed, b, error));
    s->members[0] = a->count;
    s->moved = a->moved;
    s->members[1] = b->count;
    rheo_error why;
    const rheo_result result = rheo__members_run(r, options, b, &why);
    if (result == RHEO_ERROR_STATE) {
        s->went_bad = true;
        snprintf(s->why, sizeof s->why, "%.300s", why.message);
        return RHEO_OK;
    }
    return result == RHEO_OK ? RHEO_OK : rheo__fail(error, result, "%s", why.message);
}

rheo_result rheo__same_statistics(rheo_recording *r, const rheo_same_options *options, rheo_same_statistics *s,
                                  rheo_error *error)
{
    rheo__members made = {0}, b = {0};
    rheo_world *world = NULL;
    table *t = calloc(1, sizeof *t);
    memset(s, 0, sizeof *s);
    s->tried = true;
    rheo_result result = t ? make_sides(r, options, &made, &b, s, error) : no_memory(error);
    const rheo__members *a = r->members ? r->members : &made;
    if (result == RHEO_OK && !s->went_bad)
        result = rheo__keyframe_world(r, &r->keyframes[0], NULL, &world, error);
    if (result == RHEO_OK && !s->went_bad)
        result = compare(a, &b, world, t, s, error);
    if (result == RHEO_OK && !s->went_bad && options->self_check)
        result = self_check(r, options, &b, t, s, error);
    rheo_world_destroy(world);
    rheo__members_release(&made);
    rheo__members_release(&b);
    free(t);
    return result;
}
