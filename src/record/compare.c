/*
 * Comparing states and describing differences. Hashes name step, stage and field. Values name the item; they are
 * known if both sides can be simulated up to the stage, or if states are stored. If one side is known and a single
 * component differs, the other value is solved from the hash (core/field_hash.c).
 */
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "record/recording.h"

/* ---- Fields ---- */

static void set_values(rheo_difference *d, rheo__field_id field, uint64_t expected, uint64_t actual)
{
    rheo_element element = rheo__field_table[field].element;
    snprintf(d->value_field, sizeof d->value_field, "%s", rheo__field_table[field].name);
    d->location = rheo__field_table[field].location;
    d->expected_bits = expected;
    d->actual_bits = actual;
    d->expected = rheo__element_number(element, expected);
    d->actual = rheo__element_number(element, actual);
    d->ulps = field == RHEO__FIELD_spring_ends ? UINT64_MAX : rheo__element_distance(element, expected, actual);
}

/* NaN if one of them is NaN. */
static double difference_of(rheo_element element, uint64_t a, uint64_t b)
{
    const double x = rheo__element_number(element, a), y = rheo__element_number(element, b);
    return x > y ? x - y : y - x;
}

/* Notes the size of a difference of two values. */
static void note_size(rheo__sizes *sizes, rheo_element element, uint64_t a, uint64_t b)
{
    const uint64_t ulps = rheo__element_distance(element, a, b);
    const double difference = difference_of(element, a, b);
    sizes->ulps = ulps > sizes->ulps ? ulps : sizes->ulps;
    sizes->largest = difference > sizes->largest ? difference : sizes->largest;
}

/* Largest magnitude of a field. */
static double scale_of(rheo__field_id f, const rheo__values *values)
{
    const rheo__field *field = &rheo__field_table[f];
    double scale = 0;
    for (size_t i = 0; i < values->items[f] * field->components; i++) {
        const double value =
            rheo__element_number(field->element, rheo__element_bits(field->element, values->data[f], i));
        const double magnitude = value < 0 ? -value : value;
        scale = magnitude > scale ? magnitude : scale;
    }
    return scale;
}

static uint64_t compare_items(rheo__field_id f, const rheo__values *expected, const rheo__values *actual,
                              rheo_difference *first, rheo__sizes *sizes)
{
    const rheo__field *field = &rheo__field_table[f];
    size_t element = rheo__element_size(field->element), item = element * field->components;
    size_t a_items = expected->items[f], b_items = actual->items[f];
    size_t both = a_items < b_items ? a_items : b_items;
    uint64_t count = a_items + b_items - 2 * both;
    bool named = false;
    size_t at = 0;   /* the named item, the first that differs */
    double most = 0; /* the largest difference of its components, which is the one named */
    /* Rows of modes follow each other. */
    size_t row_items = field->storage == RHEO__MODES ? expected->items[RHEO__FIELD_position] : a_items + b_items;
    for (size_t i = 0; i < both; i++) {
        const char *a = (const char *)expected->data[f] + i * item, *b = (const char *)actual->data[f] + i * item;
        if (memcmp(a, b, item) == 0)
            continue;
        count++;
        for (uint32_t c = 0; c < field->components; c++) {
            uint64_t a_bits = rheo__element_bits(field->element, a, c),
                     b_bits = rheo__element_bits(field->element, b, c);
            if (a_bits == b_bits)
                continue;
            note_size(sizes, field->element, a_bits, b_bits);
            if (!first || (named && i != at))
                continue;
            const double apart = difference_of(field->element, a_bits, b_bits);
            const bool first_nan = apart != apart && most == most;
            if (named && !(apart > most || first_nan))
                continue;
            named = true;
            at = i;
            most = apart;
            first->id = i % row_items;
            first->other_id = 0;
            first->only_expected = first->only_actual = false;
            first->component = (uint32_t)(i / row_items) * field->components + c;
            set_values(first, f, a_bits, b_bits);
        }
    }
    if (first && count && !named) { /* only one side has the item */
        bool more = a_items > b_items;
        first->id = both;
        first->other_id = first->component = 0;
        set_values(first, f,
                   more ? rheo__element_bits(field->element, (char *)expected->data[f] + both * item, 0) : 0,
                   more ? 0 : rheo__element_bits(field->element, (char *)actual->data[f] + both * item, 0));
        first->ulps = UINT64_MAX;
        first->only_expected = more;
        first->only_actual = !more;
    }
    return count;
}

/*
 * A spring that only one side has counts as different. Its values of spring_ends are 1 and 0; those of rest lengths
 * are the length and 0.
 */
static uint64_t compare_springs(rheo__field_id f, const rheo__values *expected, const rheo__values *actual,
                                rheo_difference *first, rheo__sizes *sizes)
{
    const uint32_t *a = expected->data[RHEO__FIELD_spring_ends], *b = actual->data[RHEO__FIELD_spring_ends];
    const void *a_rest = expected->data[RHEO__FIELD_spring_rest_length];
    const void *b_rest = actual->data[RHEO__FIELD_spring_rest_length];
    const size_t as = expected->items[RHEO__FIELD_spring_ends], bs = actual->items[RHEO__FIELD_spring_ends];
    const bool rest = f == RHEO__FIELD_spring_rest_length;
    uint64_t count = 0;
    for (size_t i = 0, j = 0; i < as || j < bs;) {
        uint64_t left = i < as ? (uint64_t)a[2 * i] << 32 | a[2 * i + 1] : UINT64_MAX;
        uint64_t right = j < bs ? (uint64_t)b[2 * j] << 32 | b[2 * j + 1] : UINT64_MAX;
        uint64_t ends = left < right ? left : right;
        bool has_a = left == ends, has_b = right == ends;
        uint64_t a_bits = !has_a ? 0 : rest ? rheo__element_bits(RHEO__ELEMENT_REAL, a_rest, i) : 1;
        uint64_t b_bits = !has_b ? 0 : rest ? rheo__element_bits(RHEO__ELEMENT_REAL, b_rest, j) : 1;
        i += has_a;
        j += has_b;
        if (has_a == has_b && a_bits == b_bits)
            continue;
        if (has_a && has_b)
            note_size(sizes, RHEO__ELEMENT_REAL, a_bits, b_bits);
        if (count++ || !first)
            continue;
        first->id = ends >> 32;
        first->other_id = (uint32_t)ends;
        first->component = 0;
        set_values(first, f, a_bits, b_bits);
        first->only_expected = !has_b;
        first->only_actual = !has_a;
        if (has_a != has_b)
            first->ulps = UINT64_MAX;
    }
    return count;
}

uint64_t rheo__compare_field(rheo__field_id f, const rheo__values *expected, const rheo__values *actual,
                             rheo_value_origin known, rheo_difference *first, rheo__sizes *sizes)
{
    rheo__sizes own;
    sizes = sizes ? sizes : &own;
    *sizes = (rheo__sizes){0};
    if (!((expected->present & actual->present) >> f & 1))
        return 0;
    uint64_t count = rheo__field_table[f].storage == RHEO__SPRING ? compare_springs(f, expected, actual, first, sizes)
                                                                  : compare_items(f, expected, actual, first, sizes);
    if (count && f != RHEO__FIELD_spring_ends) {
        const double scale[] = {scale_of(f, expected), scale_of(f, actual)};
        sizes->scale = scale[scale[1] > scale[0]];
    }
    if (count && first) {
        first->count = count;
        first->origin = known;
        first->largest = sizes->largest;
        first->scale = sizes->scale;
    }
    return count;
}

bool rheo__compare_values(rheo__field_id field, const rheo__values *expected, const rheo__values *actual,
                          rheo_value_origin known, rheo_difference *first)
{
    if (field < RHEO__FIELD_COUNT && rheo__compare_field(field, expected, actual, known, first, NULL))
        return true;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (rheo__compare_field(f, expected, actual, known, first, NULL))
            return true;
    return false;
}

void rheo__compare_growth(rheo_verification *v, uint64_t step, const rheo__values *expected,
                          const rheo__values *actual)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        rheo__sizes sizes;
        uint64_t count = rheo__compare_field(f, expected, actual, RHEO_VALUES_STORED, NULL, &sizes);
        if (count == 0 || v->growth_count == RHEO_MAX_GROWTH)
            continue;
        rheo_growth *growth = &v->growth[v->growth_count++];
        *growth = (rheo_growth){
            .step = step, .count = count, .ulps = sizes.ulps, .largest = sizes.largest, .scale = sizes.scale};
        snprintf(growth->field, sizeof growth->field, "%s", rheo__field_table[f].name);
    }
}

rheo__field_id rheo__recording_wrong_field(const rheo_recording *r, const rheo_world *world, rheo__fields except,
                                           uint64_t *expected)
{
    uint64_t hash[RHEO__FIELD_COUNT];
    rheo__fields written = 0;
    char name[32];
    rheo__field_id field;
    const uint64_t substeps = rheo__world_trace_substeps(world, r->expected_count);
    for (size_t i = 0; i < r->expected_count; i++) {
        rheo__world_trace_entry(world, substeps, i, name, &field);
        hash[field] = r->expected[i];
        written |= RHEO__SET_OF(field);
    }
    for (field = 0; field < RHEO__FIELD_COUNT; field++) {
        uint64_t own;
        if (!((written & ~except) >> field & 1))
            continue;
        rheo__state_hash_newest(&world->state, RHEO__SET_OF(field), &own);
        *expected = hash[field];
        if (own != hash[field])
            break;
    }
    return field;
}

/* ---- Differences in words ---- */

void rheo__difference_locate(rheo_difference *d, uint64_t step, const char *stage, rheo__field_id field)
{
    d->step = d->value_step = step;
    snprintf(d->stage, sizeof d->stage, "%s", stage);
    snprintf(d->field, sizeof d->field, "%s", field < RHEO__FIELD_COUNT ? rheo__field_table[field].name : "");
}

bool rheo__difference_solve(rheo_difference *d, const rheo__state *state, rheo__field_id field, uint64_t hash,
                            bool hash_is_expected)
{
    rheo__solution s;
    if (!rheo__state_solve(state, field, hash, &s))
        return false;
    d->origin = RHEO_VALUES_SOLVED;
    d->id = s.id;
    d->other_id = s.other_id;
    d->component = s.component;
    d->count = s.count;
    set_values(d, field, hash_is_expected ? s.other : s.own, hash_is_expected ? s.own : s.other);
    d->only_expected = d->only_actual = false;
    d->largest = d->expected > d->actual ? d->expected - d->actual : d->actual - d->expected;
    d->scale = 0;
    rheo__values values = {0};
    rheo_error ignored;
    /* In the middle of a step, only the field itself is sure to be complete. */
    if (rheo__field_table[field].storage != RHEO__SPRING && !rheo__in_rows(field) &&
        rheo__values_resize(&values, field, rheo__state_items(state, field), &ignored) == RHEO_OK &&
        values.items[field]) {
        rheo__state_read_row(state, field, 0, values.data[field]);
        d->scale = scale_of(field, &values);
    }
    rheo__values_release(&values);
    return true;
}

static void describe_item(const rheo_difference *d, char *text, size_t size)
{
    rheo__field_id f = 0;
    while (f + 1 < RHEO__FIELD_COUNT && strcmp(rheo__field_table[f].name, d->value_field) != 0)
        f++;
    const rheo__field *field = &rheo__field_table[f];
    if (field->location == RHEO_LOCATION_SPRING)
        snprintf(text, size, "%s of spring %llu:%llu", field->name, (unsigned long long)d->id,
                 (unsigned long long)d->other_id);
    else if (field->location == RHEO_LOCATION_WORLD)
        snprintf(text, size, "%s", field->name);
    else if (field->components == 1)
        snprintf(text, size, "%s of %s %llu", field->name, rheo_item_name(field->location),
                 (unsigned long long)d->id);
    else
        snprintf(text, size, "%s of %s %llu, component %u", field->name, rheo_item_name(field->location),
                 (unsigned long long)d->id, d->component);
}

/* Near 0 and across it, values that are close to each other are millions of ulps apart. */
static bool ulps_mean_something(const rheo_difference *d)
{
    const double a = d->expected < 0 ? -d->expected : d->expected, b = d->actual < 0 ? -d->actual : d->actual;
    const double smaller = a < b ? a : b;
    return d->ulps != UINT64_MAX && (d->expected < 0) == (d->actual < 0) && smaller > 0 && smaller >= 1e-6 * d->scale;
}

/* ", by at most 1e-05, 2e-07 of the field's largest value" */
static void describe_size(const rheo_difference *d, char *text, size_t size)
{
    const char *at_most = d->count == 1 ? "" : "at most ";
    text[0] = 0;
    if (d->largest > 0 && d->scale > 0)
        rheo__text_print(text, size, " by %s%.3g, %.2g of the field's largest value", at_most, d->largest,
                         d->largest / d->scale);
    else if (d->largest > 0)
        rheo__text_print(text, size, " by %s%.3g", at_most, d->largest);
}

/* "position of particle 17, component 1 is 3.25 (0x40500000) in the recording, ..." */
static void describe_values(const rheo_difference *d, const char *expected_name, const char *actual_name, char *text,
                            size_t size)
{
    char item[128], ulps[64] = "";
    describe_item(d, item, sizeof item);
    if (strcmp(d->value_field, "spring_ends") == 0 &&
        (d->only_expected || d->only_actual || d->expected_bits != d->actual_bits)) {
        snprintf(text, size, "spring %llu:%llu is only in %s", (unsigned long long)d->id,
                 (unsigned long long)d->other_id, d->expected_bits ? expected_name : actual_name);
        return;
    }
    if (d->only_expected || d->only_actual) {
        rheo__text_print(text, size, "%s is %.9g (0x%08llx) in %s, which alone has this item", item,
                         d->only_expected ? d->expected : d->actual,
                         (unsigned long long)(d->only_expected ? d->expected_bits : d->actual_bits),
                         d->only_expected ? expected_name : actual_name);
        return;
    }
    if (ulps_mean_something(d))
        snprintf(ulps, sizeof ulps, ", %llu ulp%s apart", (unsigned long long)d->ulps, rheo__plural(d->ulps));
    rheo__text_print(text, size, "%s is %.9g (0x%08llx) in %s, %.9g (0x%08llx) in %s%s", item, d->expected,
                     (unsigned long long)d->expected_bits, expected_name, d->actual,
                     (unsigned long long)d->actual_bits, actual_name, ulps);
}

/* Why a difference has no values. */
static void describe_no_values(const rheo_difference *d, uint64_t agreed, bool full, char *text, size_t size)
{
    if (agreed > d->step)
        snprintf(text, size, "; all values agree again at the end of the step, and up to step %llu",
                 (unsigned long long)agreed);
    else if (agreed)
        snprintf(text, size, "; all values agree again at the end of the step");
    else if (full)
        snprintf(text, size, "; more than one value, and the step does not reach its end, where they are stored");
    else
        snprintf(text, size, "; more than one value, and only full recordings (--full) would have them");
}

void rheo__difference_describe(rheo_verification *v, const char *const names[2], uint64_t agreed, bool full)
{
    static const char *const KNOWN[] = {"", "simulated with this build", "solved from the hash",
                                        "from stored states"};
    const rheo_difference *d = &v->first;
    char values[400] = "", when[96] = "";
    int length = snprintf(v->message, sizeof v->message, "differs at step %llu: %s%s%s", (unsigned long long)d->step,
                          d->field, *d->stage ? " after stage " : " of the state at the start", d->stage);
    char *end = v->message + length;
    size_t room = sizeof v->message - (size_t)length;
    if (d->origin == RHEO_VALUES_NONE) {
        describe_no_values(d, agreed, full, end, room);
        return;
    }
    describe_values(d, names[0], names[1], values, sizeof values);
    if (d->value_step > d->step)
        snprintf(when, sizeof when, "%s; at the end of step %llu ",
                 agreed ? "the values agree again at its end" : "its values are not stored",
                 (unsigned long long)d->value_step);
    else if (d->origin == RHEO_VALUES_STORED && *d->stage)
        snprintf(when, sizeof when, "at the end of the step ");
    char by[96];
    describe_size(d, by, sizeof by);
    snprintf(end, room, "; %s%s; %llu %s%s differ%s%s (%s)", when, values, (unsigned long long)d->count,
             strncmp(d->value_field, "spring", 6) == 0 ? "spring" : "item", rheo__plural(d->count),
             d->count == 1 ? "s" : "", by, KNOWN[d->origin]);
}

void rheo__name_builds(rheo_verification *v, const char *const names[2], const char *a, const char *b)
{
    snprintf(v->build[0], sizeof v->build[0], "%s", a);
    snprintf(v->build[1], sizeof v->build[1], "%s", b);
    const size_t length = strlen(v->message);
    if (v->verdict == RHEO_DIFFERS && !v->lengths_differ && strcmp(a, b) != 0)
        snprintf(v->message + length, sizeof v->message - length, "; builds: %s (%s), %s (%s)", v->build[0], names[0],
                 v->build[1], names[1]);
}

rheo_result rheo__not_compared(rheo_verification *v, rheo_result result, const rheo_error *why, rheo_error *error)
{
    if (result == RHEO_OK)
        return RHEO_OK;
    const uint64_t steps = result == RHEO_ERROR_STOPPED ? v->steps : 0; /* those before the stop */
    memset(v, 0, sizeof *v);
    v->steps = steps;
    snprintf(v->message, sizeof v->message, "not compared: %s", why->message);
    return rheo__fail(error, result, "%s", why->message);
}

rheo_result rheo_verification_check(const rheo_verification *v, uint64_t steps, rheo_error *error)
{
    if (v->verdict != RHEO_SAME)
        return rheo__fail(error, RHEO_ERROR_DIFFERS, "%s",
                          v->message[0] ? v->message : "not compared: nothing has set the verification");
    if (v->steps < steps)
        return rheo__fail(error, RHEO_ERROR_DIFFERS, "%llu step%s the same, but at least %llu must be compared",
                          (unsigned long long)v->steps, v->steps == 1 ? " is" : "s are", (unsigned long long)steps);
    return RHEO_OK;
}

rheo_result rheo__unreadable(rheo_verification *v, rheo_result result, const rheo_error *why, rheo_error *error)
{
    bool file = result == RHEO_ERROR_FORMAT || result == RHEO_ERROR_UNSUPPORTED || result == RHEO_ERROR_ARGUMENT;
    if (!file)
        return rheo__fail(error, result, "%s", why->message);
    char steps[96] = "";
    if (v->steps)
        snprintf(steps, sizeof steps, "; %llu step%s before it %s%s", (unsigned long long)v->steps,
                 rheo__plural(v->steps), v->steps == 1 ? "holds" : "hold",
                 v->verdict == RHEO_DIFFERS && !v->lengths_differ ? ", the next one differs" : "");
    snprintf(v->message, sizeof v->message, "unreadable: %.480s%s%s", why->message, steps,
             result == RHEO_ERROR_FORMAT ? "; restore it from version control, or record it again" : "");
    memset(&v->first, 0, sizeof v->first);
    v->growth_count = 0;
    v->verdict = RHEO_UNREADABLE;
    return RHEO_OK;
}
