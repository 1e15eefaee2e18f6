/*
 * Verifying: simulate a recording again and find the first place where it is not the same.
 *
 * Hashes say at which step, after which stage and in which field; a full recording has the values, so that
 * the particle and the number of units in the last place can be named too. A difference spreads within a
 * step: values are compared at its end, when the field that differed first may agree again; then the first
 * field that does not is named.
 */
#include <stdlib.h>
#include <string.h>

#include "record/recording.h"

typedef struct verifier {
    rheo_recording *r;
    rheo_world *world;
    rheo_verification *v;
    rheo_values before, stored,
        own; /* full only: state before and after the step, as recorded; after it, simulated */
} verifier;

/* ---- Values that differ ---- */

static uint64_t bits_of(const void *values, size_t index, size_t element_size)
{
    uint32_t small = 0;
    uint64_t large = 0;
    const char *from = (const char *)values + index * element_size;
    if (element_size == 4)
        memcpy(&small, from, sizeof small);
    else
        memcpy(&large, from, sizeof large);
    return large | small;
}

static double number_of(rheo_element element, uint64_t bits)
{
    float small;
    double large;
    uint32_t low = (uint32_t)bits;
    memcpy(&small, &low, sizeof small);
    memcpy(&large, &bits, sizeof large);
    return element == RHEO_ELEMENT_F32 ? (double)small : element == RHEO_ELEMENT_F64 ? large : (double)bits;
}

/* How many numbers of the type lie between; no number of them for a NaN. */
static uint64_t distance(rheo_element element, uint64_t a, uint64_t b)
{
    bool real = element == RHEO_ELEMENT_F32 || element == RHEO_ELEMENT_F64;
    double x = number_of(element, a), y = number_of(element, b);
    if (real && (x != x || y != y))
        return UINT64_MAX;
    uint64_t sign = element == RHEO_ELEMENT_F32 ? UINT64_C(1) << 31 : UINT64_C(1) << 63, all = sign | (sign - 1);
    if (real) {
        a = a & sign ? ~a & all : a | sign;
        b = b & sign ? ~b & all : b | sign;
    }
    return a > b ? a - b : b - a;
}

static void set_values(rheo_difference *d, rheo_element element, uint64_t expected, uint64_t actual)
{
    d->known = RHEO_KNOWN_STORED;
    d->expected_bits = expected;
    d->actual_bits = actual;
    d->expected = number_of(element, expected);
    d->actual = number_of(element, actual);
    d->ulps = distance(element, expected, actual);
}

static uint64_t compare_items(rheo_field_id f, const rheo_values *stored, const rheo_values *own, rheo_difference *d)
{
    const rheo_field *field = &rheo_field_table[f];
    size_t element = rheo_element_size(field->element), item = element * field->components;
    uint64_t more = stored->items[f] > own->items[f] ? stored->items[f] : own->items[f];
    uint64_t both = stored->items[f] + own->items[f] - more, count = more - both;
    for (uint64_t i = both; i-- > 0;) {
        const char *a = (const char *)stored->data[f] + i * item, *b = (const char *)own->data[f] + i * item;
        if (memcmp(a, b, item) == 0)
            continue;
        count++;
        d->id = i; /* the lowest is the last one found */
    }
    if (count > more - both) {
        size_t first = (size_t)d->id * field->components, c = 0;
        while (bits_of(stored->data[f], first + c, element) == bits_of(own->data[f], first + c, element))
            c++;
        d->component = (uint32_t)c;
        set_values(d, field->element, bits_of(stored->data[f], first + c, element),
                   bits_of(own->data[f], first + c, element));
    }
    return count;
}

/* A spring that is on one side only differs; of spring_ends the values are then 1 and 0, of rest lengths the
 * one and 0. */
static uint64_t compare_springs(rheo_field_id f, const rheo_values *stored, const rheo_values *own,
                                rheo_difference *d)
{
    const uint32_t *a = stored->data[RHEO_FIELD_spring_ends], *b = own->data[RHEO_FIELD_spring_ends];
    const void *rest_a = stored->data[RHEO_FIELD_spring_rest_length];
    const void *rest_b = own->data[RHEO_FIELD_spring_rest_length];
    uint64_t i = 0, j = 0, count = 0;
    while (i < stored->items[RHEO_FIELD_spring_ends] || j < own->items[RHEO_FIELD_spring_ends]) {
        bool has_a = i < stored->items[RHEO_FIELD_spring_ends], has_b = j < own->items[RHEO_FIELD_spring_ends];
        uint64_t left = has_a ? (uint64_t)a[2 * i] << 32 | a[2 * i + 1] : UINT64_MAX;
        uint64_t right = has_b ? (uint64_t)b[2 * j] << 32 | b[2 * j + 1] : UINT64_MAX;
        uint64_t ends = left < right ? left : right;
        bool rest = f == RHEO_FIELD_spring_rest_length;
        has_a = left == ends;
        has_b = right == ends;
        uint64_t expected = !has_a ? 0 : rest ? bits_of(rest_a, i, sizeof(rheo_real)) : 1;
        uint64_t actual = !has_b ? 0 : rest ? bits_of(rest_b, j, sizeof(rheo_real)) : 1;
        if ((expected != actual || has_a != has_b) && count++ == 0) {
            d->id = ends >> 32;
            d->other_id = (uint32_t)ends;
            d->component = 0;
            set_values(d, rheo_field_table[f].element, expected, actual);
            if (has_a != has_b)
                d->ulps = UINT64_MAX;
        }
        i += has_a;
        j += has_b;
    }
    return count;
}

/* How many items of a field differ; if any, *d names the first. */
static uint64_t compare_field(rheo_field_id f, const rheo_values *stored, const rheo_values *own, rheo_difference *d)
{
    if (!(stored->present >> f & 1))
        return 0;
    uint64_t count = rheo_field_table[f].storage == RHEO_SPRING ? compare_springs(f, stored, own, d)
                                                                : compare_items(f, stored, own, d);
    if (count) {
        d->count = count;
        snprintf(d->value_field, sizeof d->value_field, "%s", rheo_field_table[f].name);
    }
    return count;
}

/* The first of all fields that differs, `first` before the others. */
static bool compare_values(rheo_field_id first, const rheo_values *stored, const rheo_values *own, rheo_difference *d)
{
    if (first < RHEO_FIELD_COUNT && compare_field(first, stored, own, d))
        return true;
    for (rheo_field_id f = 0; f < RHEO_FIELD_COUNT; f++)
        if (compare_field(f, stored, own, d))
            return true;
    return false;
}

/* ---- Verdicts ---- */

static rheo_result unreadable(rheo_verification *v, rheo_result result, const rheo_error *why, rheo_error *error)
{
    bool file = result == RHEO_ERROR_FORMAT || result == RHEO_ERROR_UNSUPPORTED || result == RHEO_ERROR_ARGUMENT;
    if (!file)
        return rheo_fail(error, result, "%s", why->message);
    snprintf(v->message, sizeof v->message, "unreadable: %.380s; %llu steps before it hold%s", why->message,
             (unsigned long long)v->steps, v->verdict == RHEO_DIFFERS ? ", the next one differs" : "");
    memset(&v->first, 0, sizeof v->first);
    v->verdict = RHEO_UNREADABLE;
    return RHEO_OK;
}

static void describe_values(const rheo_difference *d, char *text, size_t size)
{
    char item[80], value[160], ulps[40] = "";
    if (d->other_id)
        snprintf(item, sizeof item, "spring %llu:%llu", (unsigned long long)d->id, (unsigned long long)d->other_id);
    else
        snprintf(item, sizeof item, "%s %llu, component %u", d->value_field, (unsigned long long)d->id, d->component);
    if (d->ulps != UINT64_MAX)
        snprintf(ulps, sizeof ulps, ", %llu ulps apart", (unsigned long long)d->ulps);
    if (strcmp(d->value_field, "spring_ends") == 0)
        snprintf(value, sizeof value, "is only in the %s", d->expected_bits ? "recording" : "replay");
    else
        snprintf(value, sizeof value, "is %.9g, recorded %.9g%s", d->actual, d->expected, ulps);
    snprintf(text, size, "; at the end of the step %s %s; %llu differ", item, value, (unsigned long long)d->count);
}

/* `traced`: the field whose hash differs. If values were found, *first has them, maybe of another field. */
static void differs(verifier *w, uint64_t step, const char *stage, rheo_field_id traced)
{
    rheo_difference *d = &w->v->first;
    const char *field = traced < RHEO_FIELD_COUNT ? rheo_field_table[traced].name : "";
    char values[300] = "; a full recording would have the values";
    w->v->verdict = RHEO_DIFFERS;
    d->step = step;
    snprintf(d->stage, sizeof d->stage, "%s", stage);
    if (d->known)
        describe_values(d, values, sizeof values);
    snprintf(d->field, sizeof d->field, "%s", field);
    if (!d->known && w->r->head.full)
        snprintf(values, sizeof values, "; at the end of the step all values agree");
    snprintf(w->v->message, sizeof w->v->message, "differs at step %llu: %s %s%s%s", (unsigned long long)step, field,
             *stage ? "after stage " : "of the keyframe", stage, values);
}

/* ---- Steps ---- */

static rheo_result read_states(verifier *w, size_t index, rheo_error *error)
{
    const rheo_step_place *place = &w->r->steps[index];
    rheo_pieces_reader pieces = {.reader = &w->r->reader,
                                 .type = RHEO_STAT,
                                 .step = w->r->first_step + 1 + index,
                                 .at = place->start,
                                 .end = place->at};
    rheo_result result = rheo_full_read(&pieces, w->world->state.present, place->raw, &w->before, &w->stored, error);
    rheo_bytes_release(&pieces.bytes);
    return result;
}

/* RHEO_OK also if a difference was found: the verdict says so. */
static rheo_result verify_step(verifier *w, size_t index, rheo_error *error)
{
    rheo_recording *r = w->r;
    rheo_verification *v = w->v;
    uint64_t step = r->first_step + 1 + index;
    uint32_t different, stage = 0;
    rheo_field_id field = RHEO_FIELD_COUNT;
    rheo_error why;
    rheo_result result = rheo_recording_replay(r, index, w->world, &different, &why);
    bool failed = result == RHEO_ERROR_STATE;
    if (result != RHEO_OK && !failed)
        return rheo_fail(error, result, "%s", why.message);
    if (different < r->head.trace_count)
        rheo_world_trace_entry(w->world, different, &stage, &field);
    const char *name = field < RHEO_FIELD_COUNT ? w->world->stage[stage].name : "";
    if (failed) {
        differs(w, step, name, field);
        snprintf(v->message, sizeof v->message, "differs at step %llu: it was recorded, but fails here: %.400s",
                 (unsigned long long)step, why.message);
        return RHEO_OK;
    }
    bool values = false;
    if (r->head.full) {
        RHEO_TRY(read_states(w, index, error));
        RHEO_TRY(rheo_values_take(&w->own, &w->world->state, error));
        values = compare_values(field, &w->stored, &w->own, &v->first);
        rheo_values_swap(&w->before, &w->stored);
    }
    if (field < RHEO_FIELD_COUNT) {
        differs(w, step, name, field);
    } else if (values) {
        return rheo_fail(error, RHEO_ERROR_FORMAT, "damaged: the stored state of step %llu does not have its hashes",
                         (unsigned long long)step);
    }
    return RHEO_OK;
}

static rheo_result verify_keyframe(verifier *w, size_t index, rheo_error *error)
{
    rheo_field_id field;
    RHEO_TRY(rheo_keyframe_compare(w->r, &w->r->keyframes[index], w->world, &field, error));
    if (field < RHEO_FIELD_COUNT)
        differs(w, w->r->keyframes[index].step, "", field);
    return RHEO_OK;
}

static rheo_result verify_all(verifier *w, rheo_error *error)
{
    rheo_recording *r = w->r;
    rheo_verification *v = w->v;
    RHEO_TRY(rheo_head_check_numbers(&r->head, error));
    RHEO_TRY(rheo_head_check_world(&r->head, w->world, error));
    if (r->head.full)
        RHEO_TRY(rheo_values_take(&w->before, &w->world->state, error));
    size_t keyframe = 0;
    RHEO_TRY(verify_keyframe(w, keyframe++, error));
    for (size_t i = 0; i < r->step_count && v->verdict == RHEO_SAME; i++) {
        RHEO_TRY(verify_step(w, i, error));
        if (v->verdict == RHEO_SAME && keyframe < r->keyframe_count &&
            r->keyframes[keyframe].step == r->first_step + 1 + i)
            RHEO_TRY(verify_keyframe(w, keyframe++, error));
        v->steps += v->verdict == RHEO_SAME;
    }
    if (v->verdict == RHEO_SAME && r->whole && r->has_last_hash && rheo_world_hash(w->world) != r->last_hash) {
        differs(w, r->last_step, "", RHEO_FIELD_COUNT);
        snprintf(v->message, sizeof v->message, "differs at step %llu: the hash of the whole state at the end",
                 (unsigned long long)r->last_step);
    }
    return RHEO_OK;
}

rheo_result rheo_verify_world(rheo_recording *r, rheo_world *world, rheo_verification *v, rheo_error *error)
{
    memset(v, 0, sizeof *v);
    verifier w = {.r = r, .world = world, .v = v};
    rheo_error why;
    rheo_result result = verify_all(&w, &why);
    rheo_values_release(&w.before);
    rheo_values_release(&w.stored);
    rheo_values_release(&w.own);
    if (result == RHEO_OK && v->verdict == RHEO_SAME && r->whole)
        snprintf(v->message, sizeof v->message, "same: %llu steps from step %llu on", (unsigned long long)v->steps,
                 (unsigned long long)r->first_step);
    /* What is wrong further on in the file outweighs a difference before it. */
    if (result == RHEO_OK && !r->whole)
        return unreadable(v, RHEO_ERROR_FORMAT, &r->fault, error);
    return result == RHEO_OK ? RHEO_OK : unreadable(v, result, &why, error);
}

static rheo_result verify_opened(rheo_recording *r, rheo_verification *v, rheo_error *error)
{
    memset(v, 0, sizeof *v);
    bool damaged;
    rheo_error why;
    rheo_world *world = NULL;
    rheo_result result = rheo_recording_scan(r, true, &damaged, &why);
    if (result == RHEO_OK)
        result = rheo_keyframe_world(r, &r->keyframes[0], NULL, &world, &why);
    result = result == RHEO_OK ? rheo_verify_world(r, world, v, error) : unreadable(v, result, &why, error);
    rheo_world_destroy(world);
    return result;
}

rheo_result rheo_verify(const char *path, rheo_verification *v, rheo_error *error)
{
    rheo_recording *r = calloc(1, sizeof *r);
    if (!r)
        return rheo_fail(error, RHEO_ERROR_MEMORY, "no memory to verify '%.300s'", path);
    rheo_result result = rheo_reader_open(&r->reader, path, error);
    if (result == RHEO_OK)
        result = verify_opened(r, v, error);
    rheo_recording_close(r);
    return result;
}

rheo_result rheo_verify_memory(const void *bytes, size_t size, rheo_verification *v, rheo_error *error)
{
    rheo_recording *r = calloc(1, sizeof *r);
    if (!r)
        return rheo_fail(error, RHEO_ERROR_MEMORY, "no memory to verify a recording");
    r->reader = (rheo_reader){.memory = bytes, .size = size};
    rheo_result result = verify_opened(r, v, error);
    rheo_recording_close(r);
    return result;
}
