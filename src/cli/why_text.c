/* The texts and the JSON of what changed a particle. */
#include "cli/why.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Words ---- */

const char *cli_why_source(const rheo_contribution *c, uint64_t id, char text[CLI_WHY_TEXT])
{
    const char *name = rheo_source_name(c->source), *item = rheo_source_item(c->source);
    const unsigned long long it = c->item, low = it < id ? it : id, high = it < id ? id : it;
    if (strcmp(item, "particle") == 0 && it == id)
        snprintf(text, CLI_WHY_TEXT, "its own %s", name);
    else if (c->source == RHEO_SOURCE_NONE)
        snprintf(text, CLI_WHY_TEXT, "its old value goes");
    else if (c->source == RHEO_SOURCE_SPRING)
        snprintf(text, CLI_WHY_TEXT, "spring %llu:%llu", low, high);
    else if (c->source == RHEO_SOURCE_BALL && it)
        snprintf(text, CLI_WHY_TEXT, "%s %llu", name, it + 1);
    else if (c->source == RHEO_SOURCE_PLATE)
        snprintf(text, CLI_WHY_TEXT, "%s plate", it ? "upper" : "lower");
    else if (strcmp(item, "particle") == 0)
        snprintf(text, CLI_WHY_TEXT, "%s %s %llu", name,
                 c->source == RHEO_SOURCE_PARTING ? "from"
                 : c->source == RHEO_SOURCE_DRIFT ? "with"
                                                  : "of",
                 it);
    else if (strcmp(item, "lag") == 0)
        snprintf(text, CLI_WHY_TEXT, "the past, lag %llu", it);
    else if (*item)
        snprintf(text, CLI_WHY_TEXT, "%s %llu", name, it);
    else
        snprintf(text, CLI_WHY_TEXT, "%s", name);
    return text;
}

const char *cli_why_end_name(rheo_chain_end end)
{
    static const char *const names[] = {"depth", "command", "start", "sign", "source", "unchanged", "born"};
    return (unsigned)end < sizeof names / sizeof *names ? names[end] : NULL;
}

const char *cli_why_unit(const rheo_world *world, const char *field)
{
    const rheo_quantity *q;
    for (uint32_t i = 0; (q = rheo_world_quantity(world, i)) != NULL; i++)
        if (strcmp(q->name, field) == 0)
            return q->unit;
    return "1";
}

/* Short also for what is no number, since three of them stand on a line. */
static const char *number_text(double value, int digits, char text[32])
{
    if (isfinite(value))
        return rheo_number_brief(value, digits, text);
    snprintf(text, 32, "%s", isnan(value) ? "NaN" : value < 0 ? "-inf" : "inf");
    return text;
}

/* "(1, 2, 3)", or the number of a scalar. */
static const char *vector_text(const double *value, uint32_t components, char text[128])
{
    char number[3][32];
    for (uint32_t axis = 0; axis < components; axis++)
        number_text(value[axis], 6, number[axis]);
    if (components == 1)
        snprintf(text, 128, "%s", number[0]);
    else
        snprintf(text, 128, "(%s, %s, %s)", number[0], number[1], number[2]);
    return text;
}

static double size_of(const double *value, uint32_t components)
{
    return components == 1 ? fabs(value[0]) : hypot(hypot(value[0], value[1]), value[2]);
}

static bool is_finite(const double *value, uint32_t components)
{
    return isfinite(size_of(value, components));
}

static void difference(const double *before, const double *after, double change[3])
{
    for (int axis = 0; axis < 3; axis++)
        change[axis] = after[axis] - before[axis];
}

/* ---- The contributions that are shown ---- */

typedef struct order {
    size_t index;
    double size;
} order;

/* Largest first, and those that are not finite before; equal ones in their order. */
static int compare(const void *a, const void *b)
{
    const order *x = a, *y = b;
    const bool finite_x = isfinite(x->size), finite_y = isfinite(y->size);
    if (finite_x != finite_y)
        return finite_x ? 1 : -1;
    if (finite_x && x->size != y->size)
        return x->size < y->size ? 1 : -1;
    return x->index < y->index ? -1 : 1;
}

/* The contributions by size. NULL: no memory, or none. */
static order *sort(const rheo_change *change)
{
    order *all = calloc(change->count + 1, sizeof *all);
    for (size_t i = 0; all && i < change->count; i++)
        all[i] = (order){i, size_of(change->contribution[i].change, change->components)};
    if (all)
        qsort(all, change->count, sizeof *all, compare);
    return all;
}

static size_t shown_of(const cli_why_request *r, const rheo_change *change)
{
    /* One more line is no longer than the line that says so. */
    return change->count <= r->top || change->count - r->top == 1 ? change->count : (size_t)r->top;
}

/* ---- Text ---- */

static void print_contribution(const rheo_change *change, const rheo_contribution *c, uint64_t id, bool largest)
{
    char source[CLI_WHY_TEXT], vector[128], size[32];
    number_text(size_of(c->change, change->components), 4, size);
    printf("  %c %-11s %-20s %s%s\n", largest ? '*' : ' ', size, cli_why_source(c, id, source),
           vector_text(c->change, change->components, vector), c->sets ? ", set" : "");
}

static void print_rest(const rheo_change *change, const order *all, size_t shown)
{
    double sum[3] = {0};
    char vector[128], size[32];
    for (size_t i = shown; i < change->count; i++)
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += change->contribution[all[i].index].change[axis];
    number_text(size_of(sum, change->components), 4, size);
    printf("    and %zu more, together %s %s\n", change->count - shown, size,
           vector_text(sum, change->components, vector));
}

void cli_why_change_text(const cli_why_request *r, const rheo_change *change)
{
    char before[128], after[128], size[32];
    double total[3];
    difference(change->before, change->after, total);
    const bool was = is_finite(change->before, change->components), is = is_finite(change->after, change->components);
    printf("%s: %s -> %s", change->stage, vector_text(change->before, change->components, before),
           vector_text(change->after, change->components, after));
    if (was && is)
        printf(", by %s", number_text(size_of(total, change->components), 4, size));
    else
        fputs(is    ? ", finite again: what was not is swallowed"
              : was ? ", not finite from here on"
                    : ", not finite",
              stdout);
    puts(change->exact ? "" : " (the contributions do not give it: a bug of rheolog)");
    order *all = sort(change);
    if (!all)
        return;
    const size_t shown = shown_of(r, change);
    size_t largest = 0;
    while (largest + 1 < change->count && change->contribution[all[largest].index].source == RHEO_SOURCE_NONE)
        largest++;
    for (size_t i = 0; i < shown; i++) {
        const size_t index = r->top == UINT64_MAX ? i : all[i].index;
        print_contribution(change, &change->contribution[index], r->id, index == all[largest].index);
    }
    if (shown < change->count)
        print_rest(change, all, shown);
    free(all);
}

const char *cli_why_link_text(const rheo_link *link, char text[CLI_WHY_TEXT])
{
    char source[CLI_WHY_TEXT], size[32], part[32];
    double total[3];
    difference(link->before, link->after, total);
    number_text(size_of(total, link->components), 3, size);
    number_text(size_of(link->largest.change, link->components), 3, part);
    cli_why_source(&link->largest, link->id, source);
    const int end = snprintf(text, CLI_WHY_TEXT, "step %llu, %s: %s of particle %llu ",
                             (unsigned long long)link->step, link->stage, link->field, (unsigned long long)link->id);
    const size_t left = CLI_WHY_TEXT - (size_t)end;
    if (link->not_finite == RHEO_NOT_FINITE_SWALLOWED)
        snprintf(text + end, left, "finite again, swallowed, with %.60s", source);
    else if (link->not_finite)
        snprintf(text + end, left, "not finite, %s, with %.60s: %s", rheo_not_finite_name(link->not_finite), source,
                 part);
    else
        snprintf(text + end, left, "changed by %s, most by %.60s: %s", size, source, part);
    return text;
}

void cli_why_print_end(const rheo_chain *chain)
{
    cli_print(stdout, 4, "  ends: %s\n", chain->why);
}

/* ---- JSON ---- */

static void write_contribution(rheo__json *json, const char *key, const rheo_contribution *c, uint32_t components)
{
    const bool is_ball = c->source == RHEO_SOURCE_BALL && c->item,
               has_item = is_ball || *rheo_source_item(c->source) != 0;
    rheo__json_begin_object(json, key);
    rheo__json_text(json, "source", rheo_source_name(c->source));
    rheo__json_text(json, "item", is_ball ? "ball" : has_item ? rheo_source_item(c->source) : NULL);
    rheo__json_known_integer(json, "item_id", has_item, c->item);
    rheo__json_text(json, "sum", *c->sum ? c->sum : NULL);
    rheo__json_vector(json, "value", c->value, components);
    rheo__json_number(json, "factor", c->factor);
    rheo__json_vector(json, "change", c->change, components);
    rheo__json_bool(json, "sets", c->sets);
    rheo__json_end_object(json);
}

void cli_why_link_json(rheo__json *json, const rheo_link *link)
{
    rheo__json_begin_object(json, NULL);
    rheo__json_integer(json, "step", link->step);
    rheo__json_text(json, "stage", link->stage);
    rheo__json_text(json, "field", link->field);
    rheo__json_integer(json, "id", link->id);
    rheo__json_vector(json, "before", link->before, link->components);
    rheo__json_vector(json, "after", link->after, link->components);
    rheo__json_text(json, "not_finite", link->not_finite ? rheo_not_finite_name(link->not_finite) : NULL);
    rheo__json_integer(json, "count", link->contributions);
    if (link->contributions)
        write_contribution(json, "largest", &link->largest, link->components);
    else
        rheo__json_null(json, "largest");
    rheo__json_end_object(json);
}

void cli_why_change_json(const cli_why_request *r, const rheo_change *change)
{
    rheo__json json = {.file = stdout};
    order *all = sort(change);
    const size_t shown = all ? shown_of(r, change) : 0;
    rheo__json_begin_object(&json, NULL);
    rheo__json_integer(&json, "step", change->step);
    rheo__json_text(&json, "stage", change->stage);
    rheo__json_text(&json, "field", change->field);
    rheo__json_integer(&json, "id", r->id);
    rheo__json_vector(&json, "before", change->before, change->components);
    rheo__json_vector(&json, "after", change->after, change->components);
    rheo__json_bool(&json, "exact", change->exact);
    rheo__json_integer(&json, "count", change->count);
    rheo__json_begin_list(&json, "contributions");
    for (size_t i = 0; i < shown; i++)
        write_contribution(&json, NULL, &change->contribution[r->top == UINT64_MAX ? i : all[i].index],
                           change->components);
    rheo__json_end_list(&json);
    rheo__json_end_object(&json);
    free(all);
}
