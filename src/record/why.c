/*
 * Who changed a particle (rheolog/why.h): a step is made again with an account of the particle (core/account.h), whose lines
 * become contributions to the field.
 */
#include "rheolog/why.h"

#include <string.h>

#include "core/account.h"
#include "core/text.h"
#include "record/recording.h"
#include "world/world.h"

/* ---- Names ---- */

static const struct {
    const char *name, *item;
} SOURCES[RHEO_SOURCE_COUNT] = {
    [RHEO_SOURCE_NONE] = {"none", ""},
    [RHEO_SOURCE_GRAVITY] = {"gravity", ""},
    [RHEO_SOURCE_VELOCITY] = {"velocity", ""},
    [RHEO_SOURCE_PRESSURE] = {"pressure", "particle"},
    [RHEO_SOURCE_SPRING] = {"spring", "particle"},
    [RHEO_SOURCE_VISCOSITY] = {"viscosity", "particle"},
    [RHEO_SOURCE_WALL] = {"wall", "wall"},
    [RHEO_SOURCE_BALL] = {"ball", ""},
    [RHEO_SOURCE_PLATE] = {"plate", "plate"},
    [RHEO_SOURCE_PARTING] = {"parting", "particle"},
    [RHEO_SOURCE_DRIFT] = {"drift", "particle"},
    [RHEO_SOURCE_FLOW] = {"flow", "particle"},
    [RHEO_SOURCE_HEAT] = {"heat", "particle"},
    [RHEO_SOURCE_PAST] = {"past", "lag"},
    [RHEO_SOURCE_SOLVER] = {"solver", ""},
    [RHEO_SOURCE_PERIOD] = {"period", ""},
    [RHEO_SOURCE_SUM] = {"sum", ""},
    [RHEO_SOURCE_SHARE] = {"share", "particle"},
    [RHEO_SOURCE_DISPLACEMENT] = {"displacement", ""},
    [RHEO_SOURCE_VIBRATOR] = {"vibrator", "vibrator"},
    [RHEO_SOURCE_MODE] = {"mode", "mode"},
    [RHEO_SOURCE_OBSTACLE] = {"obstacle", "obstacle"},
};

const char *rheo_source_name(rheo_source source)
{
    return (unsigned)source < RHEO_SOURCE_COUNT ? SOURCES[source].name : NULL;
}

const char *rheo_source_item(rheo_source source)
{
    return (unsigned)source < RHEO_SOURCE_COUNT ? SOURCES[source].item : NULL;
}

static const char *sum_name(uint32_t entry)
{
    static const char *const names[] = {
#define X(name, meaning) #name,
        RHEO__ACCOUNT_SUMS(X)
#undef X
    };
    return entry < RHEO__ACCOUNT_FIRST_SUM ? "" : names[entry - RHEO__ACCOUNT_FIRST_SUM];
}

/* ---- Contributions ---- */

typedef struct contributions {
    rheo_allocator allocator;
    rheo_contribution *of;
    size_t count, capacity;
    bool no_memory;
} contributions;

/* Puts a contribution. Those with factor 0 add nothing, such as all of XSPH when it is off. */
static void put(contributions *all, const rheo_contribution *one)
{
    if (!one->sets && one->factor == 0)
        return;
    void *memory = all->of;
    if (!rheo__grow(&all->allocator, &memory, &all->capacity, all->count + 1, all->count, sizeof *all->of)) {
        all->no_memory = true;
        return;
    }
    all->of = memory;
    all->of[all->count] = *one;
    for (int axis = 0; axis < 3; axis++)
        all->of[all->count].change[axis] = one->sets ? one->change[axis] : one->factor * one->value[axis];
    all->count++;
}

/* What a line adds to its entry, of which the field takes `factor`. */
static rheo_contribution contribution_of(const rheo__account_line *line, double factor)
{
    rheo_contribution c = {
        .source = (rheo_source)line->source, .item = line->item, .sum = sum_name(line->entry), .factor = factor};
    for (int axis = 0; axis < 3; axis++)
        c.value[axis] = (double)line->value[axis];
    return c;
}

/* The product of the factors that lines [first, end) scale a sum by. */
static double scale_of(const rheo__account *a, uint32_t sum, size_t first, size_t end)
{
    double scale = 1;
    for (size_t i = first; i < end; i++)
        if (a->line[i].entry == sum && a->line[i].operation == RHEO__ACCOUNT_SCALE)
            scale *= (double)a->line[i].value[0];
    return scale;
}

/* Puts what made a sum before line `end`, which the field takes `factor` of. */
static void put_sum(contributions *all, const rheo__account *a, uint32_t sum, size_t end, double factor)
{
    size_t first = end;
    while (first > 0) {
        first--;
        if (a->line[first].entry == sum && a->line[first].operation == RHEO__ACCOUNT_SET)
            break;
    }
    double scale = scale_of(a, sum, first, end); /* by the lines that follow */
    for (size_t i = first; i < end; i++) {
        const rheo__account_line *line = &a->line[i];
        if (line->entry != sum)
            continue;
        const rheo_contribution c = contribution_of(line, factor * scale);
        switch ((rheo__account_operation)line->operation) {
        case RHEO__ACCOUNT_SET: /* a sum begins, with 0 or with a value */
            if (c.source != RHEO_SOURCE_NONE)
                put(all, &c);
            break;
        case RHEO__ACCOUNT_ADD:
            put(all, &c);
            break;
        case RHEO__ACCOUNT_APPLY:
            put_sum(all, a, line->other, i, factor * scale * (double)line->value[0]);
            break;
        case RHEO__ACCOUNT_SCALE:
            scale = scale_of(a, sum, i + 1, end); /* not a quotient: the factor may be 0 */
            break;
        }
    }
}

static bool is_zero(const rheo__account_line *line)
{
    return line->operation == RHEO__ACCOUNT_ADD && line->value[0] == 0 && line->value[1] == 0 && line->value[2] == 0;
}

/* What the lines of a stage run put into a field. */
static void put_stage(contributions *all, const rheo__account *a, const rheo__account_stage *stage,
                      rheo__field_id field)
{
    rheo__account_values values;
    memcpy(values, stage->before, sizeof values);
    for (size_t i = stage->first; i < stage->end; i++) {
        const rheo__account_line *line = &a->line[i];
        rheo_contribution c = contribution_of(line, 1);
        const rheo_real before[3] = {values[field][0], values[field][1], values[field][2]};
        rheo__account_replay(a, i, i + 1, values);
        if (line->entry != field)
            continue;
        if (is_zero(line) && memcmp(before, values[field], sizeof before) == 0)
            continue; /* a pair that does not act; a -0 that becomes 0 is told */
        for (int axis = 0; axis < 3; axis++)
            c.change[axis] = (double)values[field][axis] - (double)before[axis];
        if (line->operation == RHEO__ACCOUNT_SET) {
            c.sets = true;
            put(all, &c);
        } else if (line->operation == RHEO__ACCOUNT_ADD) {
            put(all, &c);
        } else if (line->other >= RHEO__ACCOUNT_FIRST_SUM) {
            put_sum(all, a, line->other, i, (double)line->value[0]);
        } else { /* a velocity moves a particle */
            c.factor = (double)line->value[0];
            for (int axis = 0; axis < 3; axis++)
                c.value[axis] = (double)values[line->other][axis];
            put(all, &c);
        }
    }
}

/* ---- The step ---- */

/* The field of this name, among those that have accounts. */
static rheo_result find_field(const rheo_world *world, const char *name, rheo__field_id *field, rheo_error *error)
{
    char names[128] = "";
    for (*field = 0; *field < RHEO__FIELD_COUNT; ++*field) {
        const char *own = rheo__field_table[*field].name;
        if (!(RHEO__ACCOUNT_FIELDS & world->state.present & RHEO__SET_OF(*field)))
            continue;
        if (strcmp(own, name) == 0)
            return RHEO_OK;
        const size_t length = strlen(names);
        snprintf(names + length, sizeof names - length, "%s%s", length ? ", " : "", own);
    }
    return rheo__fail(error, RHEO_ERROR_ARGUMENT,
                      "\"%.60s\" is no field of a particle that stages add to; there are %s", name, names);
}

/* Whether all fields of the particle that have accounts are finite before a stage run. */
static bool was_finite(const rheo__account_stage *stage)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        for (int axis = 0; axis < 3; axis++)
            if (!(stage->before[f][axis] - stage->before[f][axis] == 0))
                return false;
    return true;
}

/* Whether a stage name means this stage run. */
static bool is_meant(const char *wanted, const char *run)
{
    const char *offset = strchr(run, '@');
    return !wanted || strcmp(wanted, run) == 0 ||
           (offset && !strchr(wanted, '@') && strncmp(wanted, run, (size_t)(offset - run)) == 0 &&
            wanted[offset - run] == 0);
}

static rheo_result report(const rheo__account *a, uint64_t step, const char *wanted, rheo__field_id field,
                          rheo_change_receiver *receiver, void *data, rheo_error *error)
{
    contributions all = {.allocator = a->allocator};
    bool more = true;
    for (size_t i = 0; i < a->stages && more; i++) {
        const rheo__account_stage *stage = &a->stage[i];
        rheo_change change = {.step = step,
                              .run = i,
                              .was_finite = was_finite(stage),
                              .exact = stage->holds,
                              .components = rheo__field_table[field].components};
        all.count = 0;
        put_stage(&all, a, stage, field);
        if (all.no_memory)
            break;
        for (uint32_t axis = 0; axis < change.components; axis++) {
            change.before[axis] = (double)stage->before[field][axis];
            change.after[axis] = (double)stage->after[field][axis];
        }
        if (!is_meant(wanted, stage->name) ||
            (all.count == 0 && memcmp(change.before, change.after, sizeof change.before) == 0))
            continue;
        rheo__text_print(change.stage, sizeof change.stage, "%s", stage->name);
        rheo__text_print(change.field, sizeof change.field, "%s", rheo__field_table[field].name);
        change.contribution = all.of;
        change.count = all.count;
        more = receiver(data, &change);
    }
    rheo__release(&all.allocator, all.of);
    return all.no_memory ? rheo__fail(error, RHEO_ERROR_MEMORY, "no memory for the contributions of step %llu",
                                      (unsigned long long)step)
                         : RHEO_OK;
}

rheo_result rheo_player_why(rheo_player *player, uint64_t step, const char *stage, uint64_t id, const char *field,
                            rheo_change_receiver *receiver, void *data, rheo_error *error)
{
    rheo__field_id f;
    RHEO__TRY(find_field(rheo_player_world(player), field, &f, error));
    if (stage)
        RHEO__TRY(rheo__player_check_stage(player, stage, error));
    rheo__account account = {.allocator = rheo__allocator_or_default((rheo_allocator){0}), .id = (uint32_t)id};
    if (id >= UINT32_MAX)
        return rheo__fail(error, RHEO_ERROR_ARGUMENT, "there is no particle %llu", (unsigned long long)id);
    rheo_result result = rheo__player_step_account(player, step, &account, error);
    if (result == RHEO_OK)
        result = report(&account, step, stage, f, receiver, data, error);
    rheo__account_release(&account);
    return result;
}
