/*
 * Reads the text of a condition (rheolog/find.h):
 *
 *     condition   = conjunction { "or" conjunction }
 *     conjunction = factor { "and" factor }
 *     factor      = "not" factor | "(" condition ")" | comparison
 *     comparison  = [item ":"] NAME OP NUMBER | item "exists"
 *     item        = ("particle" | "any particle") ... | ("spring" | "any spring") ... | "ball"
 */
#include "record/predicate.h"

#include <ctype.h>
#include <string.h>

#include "core/error.h"
#include "core/text.h"

enum { MOST_DEPTH = 16 };

typedef struct parser {
    const char *text, *at;           /* `at`: the word that is next */
    size_t length;                   /* of it; 0 at the end */
    const rheo_recording *recording; /* NULL: metrics are those of the world */
    const rheo_world *world;         /* NULL: there may be metrics only */
    rheo__predicate *condition;
    int depth;
    rheo_error *error;
} parser;

/* ---- Words ---- */

static bool belongs_to_word(char c)
{
    return isalnum((unsigned char)c) || c == '_' || c == '.' || c == '+' || c == '-';
}

/* Finds the word that follows: a name or number, or one of < <= > >= == != ( ) : */
static void find_word(parser *p)
{
    while (*p->at == ' ' || *p->at == '\t')
        p->at++;
    p->length = 0;
    while (belongs_to_word(p->at[p->length]))
        p->length++;
    if (!p->length && *p->at)
        p->length = strchr("<>=!", *p->at) && p->at[1] == '=' ? 2 : 1;
}

static void next(parser *p)
{
    p->at += p->length;
    find_word(p);
}

static bool is_word(const parser *p, const char *word)
{
    return p->length == strlen(word) && strncmp(p->at, word, p->length) == 0;
}

/* Goes past a word, if it is the next. */
static bool take(parser *p, const char *word)
{
    const bool is = is_word(p, word);
    if (is)
        next(p);
    return is;
}

/* "in the condition, at `> x`: it needs a number". */
static rheo_result refuse(const parser *p, const char *needs)
{
    if (!p->length)
        return rheo__fail(p->error, RHEO_ERROR_ARGUMENT, "the condition \"%.60s\" ends too early: %s", p->text,
                          needs);
    return rheo__fail(p->error, RHEO_ERROR_ARGUMENT, "in the condition \"%.60s\", at \"%.20s\": %s", p->text, p->at,
                      needs);
}

/* ---- Terms ---- */

static rheo_result add_node(parser *p, rheo__node_kind kind)
{
    rheo__predicate *c = p->condition;
    if (c->nodes == RHEO__MOST_NODES || (kind == RHEO__TERM && c->terms == RHEO__MOST_TERMS))
        return rheo__fail(p->error, RHEO_ERROR_ARGUMENT, "a condition has at most %d comparisons", RHEO__MOST_TERMS);
    c->node[c->nodes++] = (rheo__node){kind, kind == RHEO__TERM ? c->terms++ : 0};
    return RHEO_OK;
}

static rheo_result read_id(parser *p, uint32_t *id)
{
    uint64_t value = 0;
    size_t i = 0;
    for (; i < p->length && p->at[i] >= '0' && p->at[i] <= '9' && value <= UINT32_MAX; i++)
        value = 10 * value + (uint64_t)(p->at[i] - '0');
    if (!i || i < p->length || value > UINT32_MAX)
        return refuse(p, "the id of a particle is a whole number, as in \"particle 17: speed > 5\" and "
                         "\"spring 17:21 exists\"");
    *id = (uint32_t)value;
    next(p);
    return RHEO_OK;
}

/* The item that a comparison is about; without one it is a metric. */
static rheo_result read_item(parser *p, rheo__term *t)
{
    if (!p->world && (is_word(p, "any") || is_word(p, "particle") || is_word(p, "spring") || is_word(p, "ball")))
        return refuse(p, "there may be metrics only");
    t->any = take(p, "any");
    if (take(p, "particle")) {
        t->about = RHEO__ABOUT_PARTICLE;
        return t->any ? RHEO_OK : read_id(p, &t->id);
    }
    if (take(p, "spring")) {
        t->about = RHEO__ABOUT_SPRING;
        if (t->any)
            return RHEO_OK;
        RHEO__TRY(read_id(p, &t->id));
        if (!take(p, ":"))
            return refuse(p, "a spring is named by its ends, as in \"spring 17:21 exists\"");
        RHEO__TRY(read_id(p, &t->other));
        if (t->id == t->other)
            return rheo__fail(p->error, RHEO_ERROR_ARGUMENT,
                              "spring %u:%u: a spring connects two particles, and these are one", t->id, t->other);
        if (t->id > t->other) {
            const uint32_t larger = t->id;
            t->id = t->other;
            t->other = larger;
        }
        return RHEO_OK;
    }
    if (t->any)
        return refuse(p, "\"any\" is followed by particle or spring");
    if (!take(p, "ball"))
        return RHEO_OK;
    t->about = RHEO__ABOUT_BALL;
    if (p->length && *p->at >= '0' && *p->at <= '9') {
        RHEO__TRY(read_id(p, &t->id));
        if (!t->id)
            return rheo__fail(p->error, RHEO_ERROR_ARGUMENT, "ball 0: balls are numbered from 1 on");
        t->id--;
    }
    return RHEO_OK;
}

static const char *metric_name(const parser *p, uint32_t index)
{
    return p->recording ? rheo_recording_metric_name(p->recording, index) : rheo_world_metric_name(p->world, index);
}

static rheo_result resolve_metric(const parser *p, rheo__term *t)
{
    const char *name;
    for (t->quantity = 0; (name = metric_name(p, t->quantity)) != NULL; t->quantity++)
        if (strcmp(name, t->name) == 0)
            return RHEO_OK;
    if (!p->world)
        return refuse(p, "it is no metric");
    rheo__term particle = *t, ball = *t;
    particle.about = RHEO__ABOUT_PARTICLE;
    ball.about = RHEO__ABOUT_BALL;
    if (rheo__term_resolve(&particle, p->world) || rheo__term_resolve(&ball, p->world))
        return rheo__fail(
            p->error, RHEO_ERROR_ARGUMENT,
            "%s is no metric; say of what it is, as in \"any particle: %s ...\", \"particle 17: %s ...\" or "
            "\"ball: %s ...\"",
            t->name, t->name, t->name, t->name);
    const char *names[256];
    uint32_t known = 0;
    for (; known < 256 && (name = metric_name(p, known)) != NULL; known++)
        names[known] = name;
    const char *nearest = rheo_nearest_word(t->name, names, known);
    return rheo__fail(p->error, RHEO_ERROR_ARGUMENT,
                      "the recording has no metric \"%s\"%s%s%s; `rheolog metrics --list` lists them", t->name,
                      nearest ? "; did you mean \"" : "", nearest ? nearest : "", nearest ? "\"" : "");
}

static rheo_result read_name(parser *p, rheo__term *t)
{
    if (!p->length || !(isalpha((unsigned char)*p->at) || *p->at == '_'))
        return refuse(p, t->about == RHEO__ABOUT_METRIC
                             ? "it needs the name of a metric, or an item, as in \"stiffness_number > 2.4\" or "
                               "\"any particle: speed > 5\""
                             : "it needs a quantity, as in \"particle 17: speed > 5\"");
    rheo__text_print(t->name, sizeof t->name, "%.*s", (int)(p->length < 63 ? p->length : 63), p->at);
    if (t->about == RHEO__ABOUT_METRIC) {
        RHEO__TRY(resolve_metric(p, t));
    } else if (!rheo__term_resolve(t, p->world)) {
        char names[384] = "";
        rheo__term_names(t->about, p->world, names, sizeof names);
        return rheo__fail(p->error, RHEO_ERROR_ARGUMENT, "%s has no quantity \"%s\"; there are %s",
                          t->about == RHEO__ABOUT_PARTICLE ? "a particle"
                          : t->about == RHEO__ABOUT_SPRING ? "a spring"
                                                           : "the ball",
                          t->name, names);
    }
    next(p);
    return RHEO_OK;
}

static rheo_result read_comparison(parser *p, rheo__term *t)
{
    static const char *const OPERATORS[] = {
        [RHEO__LESS] = "<",      [RHEO__AT_MOST] = "<=", [RHEO__MORE] = ">",
        [RHEO__AT_LEAST] = ">=", [RHEO__EQUAL] = "==",   [RHEO__UNEQUAL] = "!=",
    };
    for (int op = RHEO__LESS; op <= RHEO__UNEQUAL; op++)
        if (take(p, OPERATORS[op])) {
            const char *end;
            t->op = (rheo__operator)op;
            t->number = rheo__text_to_double(p->at, &end);
            if (!p->length || end != p->at + p->length)
                return refuse(p, "it needs a number, as in \"stiffness_number > 2.4\"");
            next(p);
            return RHEO_OK;
        }
    return refuse(p, is_word(p, "=") ? "equality is written ==" : "it needs one of < <= > >= == != and a number");
}

static rheo_result read_term(parser *p)
{
    RHEO__TRY(add_node(p, RHEO__TERM));
    rheo__term *t = &p->condition->term[p->condition->terms - 1];
    *t = (rheo__term){.component = -1};
    RHEO__TRY(read_item(p, t));
    if (t->about == RHEO__ABOUT_METRIC) {
        RHEO__TRY(read_name(p, t));
        return read_comparison(p, t);
    }
    if (!t->any && t->about != RHEO__ABOUT_BALL && take(p, "exists")) {
        t->op = RHEO__EXISTS;
        rheo__text_print(t->name, sizeof t->name, "exists");
        return RHEO_OK;
    }
    if (!take(p, ":"))
        return refuse(p, "an item is followed by : and a quantity, as in \"ball: y < 8\", or by exists");
    RHEO__TRY(read_name(p, t));
    return read_comparison(p, t);
}

/* ---- Combinations ---- */

static rheo_result read_condition(parser *p);

static rheo_result read_factor(parser *p)
{
    if (p->depth == MOST_DEPTH)
        return rheo__fail(p->error, RHEO_ERROR_ARGUMENT,
                          "the condition has more than %d levels of parentheses or not", MOST_DEPTH);
    p->depth++;
    if (take(p, "not")) {
        RHEO__TRY(read_factor(p));
        RHEO__TRY(add_node(p, RHEO__NOT));
    } else if (take(p, "(")) {
        RHEO__TRY(read_condition(p));
        if (!take(p, ")"))
            return refuse(p, "a parenthesis is not closed");
    } else {
        RHEO__TRY(read_term(p));
    }
    p->depth--;
    return RHEO_OK;
}

static rheo_result read_conjunction(parser *p)
{
    RHEO__TRY(read_factor(p));
    while (take(p, "and")) {
        RHEO__TRY(read_factor(p));
        RHEO__TRY(add_node(p, RHEO__AND));
    }
    return RHEO_OK;
}

static rheo_result read_condition(parser *p)
{
    RHEO__TRY(read_conjunction(p));
    while (take(p, "or")) {
        RHEO__TRY(read_conjunction(p));
        RHEO__TRY(add_node(p, RHEO__OR));
    }
    return RHEO_OK;
}

rheo_result rheo__predicate_parse(const char *text, const rheo_recording *recording, const rheo_world *world,
                                  rheo__predicate *condition, rheo_error *error)
{
    parser p = {
        .text = text, .at = text, .recording = recording, .world = world, .condition = condition, .error = error};
    condition->terms = condition->nodes = 0;
    find_word(&p);
    RHEO__TRY(read_condition(&p));
    return p.length ? refuse(&p, "comparisons are combined with and, or") : RHEO_OK;
}
