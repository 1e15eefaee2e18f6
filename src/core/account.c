#include "core/account.h"

#include <string.h>

#include "core/text.h"

static void add_line(const rheo__state *s, rheo__account_line line)
{
    rheo__account *a = s->account;
    void *lines = a->line;
    if (!rheo__grow(&a->allocator, &lines, &a->capacity, a->count + 1, a->count, sizeof *a->line)) {
        a->no_memory = true;
        return;
    }
    a->line = lines;
    a->line[a->count++] = line;
}

void rheo__account_set(const rheo__state *s, uint32_t entry, rheo_source source, uint32_t item, rheo_real x,
                       rheo_real y, rheo_real z)
{
    add_line(s, (rheo__account_line){.operation = RHEO__ACCOUNT_SET,
                                     .entry = (uint8_t)entry,
                                     .source = (uint8_t)source,
                                     .item = item,
                                     .value = {x, y, z}});
}

void rheo__account_add(const rheo__state *s, uint32_t entry, rheo_source source, uint32_t item, rheo_real x,
                       rheo_real y, rheo_real z)
{
    /* A sum begins with 0, to which 0 and -0 change nothing. A field may be -0. */
    if (entry >= RHEO__ACCOUNT_FIRST_SUM && x == 0 && y == 0 && z == 0)
        return;
    add_line(s, (rheo__account_line){.operation = RHEO__ACCOUNT_ADD,
                                     .entry = (uint8_t)entry,
                                     .source = (uint8_t)source,
                                     .item = item,
                                     .value = {x, y, z}});
}

void rheo__account_apply(const rheo__state *s, uint32_t entry, rheo_source source, rheo_real by, uint32_t other)
{
    add_line(s, (rheo__account_line){.operation = RHEO__ACCOUNT_APPLY,
                                     .entry = (uint8_t)entry,
                                     .other = (uint8_t)other,
                                     .source = (uint8_t)source,
                                     .value = {by}});
}

void rheo__account_scale(const rheo__state *s, uint32_t entry, rheo_real by)
{
    add_line(s, (rheo__account_line){.operation = RHEO__ACCOUNT_SCALE, .entry = (uint8_t)entry, .value = {by}});
}

/*
 * The sum of a value and the rounded rest is `to`, or as near to it as the rounding of the rest. A second rest is exact
 * then [Sterbenz 1974]. Only -0 or a sum that is not finite cannot be reached by additions.
 */
void rheo__account_add_rest(const rheo__state *s, rheo__field_id field, rheo_source source, const rheo_real to[3])
{
    enum { ADDITIONS = 2 };
    const rheo__account *a = s->account;
    for (int i = 0; i <= ADDITIONS; i++) {
        const rheo__account_stage *stage = &a->stage[a->stages - 1];
        rheo__account_values values;
        memcpy(values, stage->before, sizeof values);
        rheo__account_replay(a, stage->first, a->count, values);
        if (memcmp(values[field], to, sizeof values[field]) == 0)
            return;
        const rheo_real *is = values[field];
        const rheo_real rest[3] = {to[0] - is[0], to[1] - is[1], to[2] - is[2]};
        if (i < ADDITIONS && (rest[0] != 0 || rest[1] != 0 || rest[2] != 0))
            rheo__account_add(s, field, source, 0, rest[0], rest[1], rest[2]);
        else
            rheo__account_set(s, field, source, 0, to[0], to[1], to[2]);
    }
}

/* The values of the fields; those of sums stay. */
static void get_fields(const rheo__state *s, rheo__account_values values)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (RHEO__ACCOUNT_FIELDS & s->present & RHEO__SET_OF(f)) {
            const uint32_t components = rheo__field_table[f].components;
            const rheo_real *from = rheo__state_values(s, f);
            memcpy(values[f], from + components * (size_t)s->account->id, components * sizeof **values);
        }
}

void rheo__account_open(const rheo__state *s, const char *name)
{
    rheo__account *a = s->account;
    if (a->id >= s->particles)
        return;
    void *stages = a->stage;
    if (!rheo__grow(&a->allocator, &stages, &a->stage_capacity, a->stages + 1, a->stages, sizeof *a->stage)) {
        a->no_memory = true;
        return;
    }
    a->stage = stages;
    rheo__account_stage *stage = &a->stage[a->stages++];
    *stage = (rheo__account_stage){.first = a->count, .end = a->count};
    rheo__text_print(stage->name, sizeof stage->name, "%s", name);
    if (a->stages > 1)
        memcpy(stage->before, stage[-1].after, sizeof stage->before);
    get_fields(s, stage->before);
}

/* The fields of the particle have these values, to the last bit; any two NaN are the same. */
static bool holds(const rheo__state *s, rheo__account_values values)
{
    rheo__account_values own = {{0}};
    get_fields(s, own);
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        for (uint32_t axis = 0;
             RHEO__ACCOUNT_FIELDS & s->present & RHEO__SET_OF(f) && axis < rheo__field_table[f].components; axis++) {
            const rheo_real a = own[f][axis], b = values[f][axis];
            if (memcmp(&a, &b, sizeof a) != 0 && (a == a || b == b))
                return false;
        }
    return true;
}

void rheo__account_close(const rheo__state *s)
{
    rheo__account *a = s->account;
    if (a->no_memory || a->id >= s->particles)
        return;
    rheo__account_stage *stage = &a->stage[a->stages - 1];
    stage->end = a->count;
    memcpy(stage->after, stage->before, sizeof stage->after);
    rheo__account_replay(a, stage->first, stage->end, stage->after);
    stage->holds = holds(s, stage->after);
    get_fields(s, stage->after);
}

void rheo__account_replay(const rheo__account *account, size_t from, size_t to, rheo__account_values values)
{
    for (const rheo__account_line *line = account->line + from; line < account->line + to; line++)
        for (int axis = 0; axis < 3; axis++) {
            rheo_real *value = &values[line->entry][axis];
            switch ((rheo__account_operation)line->operation) {
            case RHEO__ACCOUNT_SET:
                *value = line->value[axis];
                break;
            case RHEO__ACCOUNT_ADD:
                *value += line->value[axis];
                break;
            case RHEO__ACCOUNT_APPLY:
                *value += line->value[0] * values[line->other][axis];
                break;
            case RHEO__ACCOUNT_SCALE:
                *value *= line->value[0];
                break;
            }
        }
}

void rheo__account_release(rheo__account *account)
{
    rheo__release(&account->allocator, account->line);
    rheo__release(&account->allocator, account->stage);
    *account = (rheo__account){.allocator = account->allocator};
}
