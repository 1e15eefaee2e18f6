/* The table of fields and everything that is a loop over it (core/state.h). */
#include "core/state.h"

#include <string.h>

const rheo_field rheo_field_table[RHEO_FIELD_COUNT] = {
#define X(name, type, element, components, per, storage) \
    {#name, offsetof(rheo_state, name), element, components, per, storage},
    RHEO_FIELDS(X)
#undef X
};

size_t rheo_element_size(rheo_element element)
{
    return element == RHEO_ELEMENT_F32 || element == RHEO_ELEMENT_U32 ? 4 : 8;
}

uint64_t rheo_element_bits(rheo_element element, const void *values, size_t index)
{
    uint32_t small;
    uint64_t large;
    if (rheo_element_size(element) == 4) {
        memcpy(&small, (const char *)values + 4 * index, sizeof small);
        return small;
    }
    memcpy(&large, (const char *)values + 8 * index, sizeof large);
    return large;
}

double rheo_element_number(rheo_element element, uint64_t bits)
{
    float small;
    double large;
    uint32_t low = (uint32_t)bits;
    memcpy(&small, &low, sizeof small);
    memcpy(&large, &bits, sizeof large);
    return element == RHEO_ELEMENT_F32 ? (double)small : element == RHEO_ELEMENT_F64 ? large : (double)bits;
}

uint64_t rheo_element_distance(rheo_element element, uint64_t a, uint64_t b)
{
    if (element == RHEO_ELEMENT_F32 || element == RHEO_ELEMENT_F64) {
        double x = rheo_element_number(element, a), y = rheo_element_number(element, b);
        if (x != x || y != y)
            return UINT64_MAX;
        uint64_t sign = element == RHEO_ELEMENT_F32 ? UINT64_C(1) << 31 : UINT64_C(1) << 63, all = sign | (sign - 1);
        a = a & sign ? ~a & all : a | sign;
        b = b & sign ? ~b & all : b | sign;
    }
    return a > b ? a - b : b - a;
}

static size_t item_bytes(rheo_field_id field)
{
    return rheo_element_size(rheo_field_table[field].element) * rheo_field_table[field].components;
}

static void set_values(rheo_state *s, rheo_field_id field, void *values)
{
    memcpy((char *)s + rheo_field_table[field].offset, &values, sizeof values);
}

static bool is_flat(const rheo_state *s, rheo_field_id field)
{
    return rheo_state_has(s, field) && rheo_field_table[field].storage == RHEO_FLAT;
}

void rheo_state_init(rheo_state *s, const rheo_allocator *allocator, uint32_t present, uint32_t window,
                     uint32_t modes)
{
    memset(s, 0, sizeof *s);
    s->allocator = *allocator;
    s->present = present;
    rheo_ring_init(&s->ring, rheo_state_has(s, RHEO_FIELD_history_velocity) ? window + 1 : 0);
    rheo_ring_init(&s->modes, rheo_state_has(s, RHEO_FIELD_history_modes) ? modes : 0);
}

void rheo_state_release(rheo_state *s)
{
    for (rheo_field_id f = 0; f < RHEO_FIELD_COUNT; f++) {
        rheo_release(&s->allocator, rheo_state_values(s, f));
        rheo_release(&s->allocator, s->before[f]);
    }
    rheo_springs_release(&s->springs, &s->allocator);
    rheo_springs_release(&s->springs_other, &s->allocator);
    rheo_release(&s->allocator, s->ring.values);
    rheo_release(&s->allocator, s->modes.values);
    rheo_release(&s->allocator, s->grip);
    memset(s, 0, sizeof *s);
}

uint64_t rheo_state_items(const rheo_state *s, rheo_field_id field)
{
    switch (rheo_field_table[field].per) {
    case RHEO_PER_WORLD:
        return 1;
    case RHEO_PER_PARTICLE:
        return s->particles;
    case RHEO_PER_SPRING:
        return rheo_pairs_count(&s->springs.pairs);
    case RHEO_PER_BODY:
        return s->bodies;
    case RHEO_PER_SOURCE:
        return s->sources;
    }
    return 0;
}

uint64_t rheo_state_rows(const rheo_state *s, rheo_field_id field)
{
    switch (rheo_field_table[field].storage) {
    case RHEO_RING:
        return *s->history_rows;
    case RHEO_MODES:
        return s->modes.length;
    default:
        return 1;
    }
}

size_t rheo_state_row_bytes(const rheo_state *s, rheo_field_id field)
{
    return (size_t)rheo_state_items(s, field) * item_bytes(field);
}

/* The items there is room for: particle fields grow in larger steps. */
static size_t room(const rheo_state *s, rheo_field_id field)
{
    return rheo_field_table[field].per == RHEO_PER_PARTICLE ? s->capacity : (size_t)rheo_state_items(s, field);
}

bool rheo_state_resize(rheo_state *s, uint32_t particles, uint32_t bodies, uint32_t sources)
{
    rheo_state old = *s, grown = *s;
    grown.particles = particles;
    grown.bodies = bodies;
    grown.sources = sources;
    if (particles > s->capacity || !s->step)
        grown.capacity = s->step ? particles + particles / 4 : particles;
    bool enough = rheo_ring_reserve(&s->ring, &s->allocator, grown.capacity) &&
                  rheo_ring_reserve(&s->modes, &s->allocator, grown.capacity);
    old.ring = grown.ring = s->ring;
    old.modes = grown.modes = s->modes;
    for (rheo_field_id f = 0; f < RHEO_FIELD_COUNT; f++) {
        if (!is_flat(s, f) || (s->step && room(&grown, f) == room(&old, f)))
            continue;
        void *values = rheo_allocate(&s->allocator, room(&grown, f) + 1, item_bytes(f));
        void *before = rheo_allocate(&s->allocator, room(&grown, f) + 1, item_bytes(f));
        enough = enough && values && before;
        if (values && rheo_state_values(&old, f))
            memcpy(values, rheo_state_values(&old, f), rheo_state_row_bytes(&old, f));
        set_values(&grown, f, values);
        grown.before[f] = before;
    }
    if (s->grip && grown.capacity != s->capacity) {
        grown.grip = rheo_allocate(&s->allocator, grown.capacity, sizeof *grown.grip);
        enough = enough && grown.grip;
    }
    /* Release what is not kept: the old arrays, or on failure the new ones. */
    rheo_state *kept = enough ? &grown : &old, *dropped = enough ? &old : &grown;
    for (rheo_field_id f = 0; f < RHEO_FIELD_COUNT; f++) {
        if (!is_flat(s, f))
            continue;
        if (rheo_state_values(dropped, f) != rheo_state_values(kept, f))
            rheo_release(&s->allocator, rheo_state_values(dropped, f));
        if (dropped->before[f] != kept->before[f])
            rheo_release(&s->allocator, dropped->before[f]);
    }
    if (dropped->grip != kept->grip)
        rheo_release(&s->allocator, dropped->grip);
    *s = *kept;
    return enough;
}

bool rheo_state_read_row(const rheo_state *s, rheo_field_id field, uint64_t row, void *values)
{
    switch (rheo_field_table[field].storage) {
    case RHEO_FLAT:
        if (rheo_state_row_bytes(s, field))
            memcpy(values, rheo_state_values(s, field), rheo_state_row_bytes(s, field));
        return true;
    case RHEO_SPRING:
        return field == RHEO_FIELD_spring_ends ? rheo_springs_read(&s->springs, &s->allocator, values, NULL)
                                               : rheo_springs_read(&s->springs, &s->allocator, NULL, values);
    case RHEO_RING:
    case RHEO_MODES:
        rheo_ring_read(rheo_state_ring(s, field), s->particles, (uint32_t)row, values);
        return true;
    }
    return false;
}

void rheo_state_write_row(rheo_state *s, rheo_field_id field, uint64_t row, const void *values)
{
    if (rheo_in_rows(field))
        rheo_ring_write(rheo_field_table[field].storage == RHEO_RING ? &s->ring : &s->modes, s->particles,
                        (uint32_t)row, values);
    else if (rheo_field_table[field].storage == RHEO_FLAT && rheo_state_row_bytes(s, field))
        memcpy(rheo_state_values(s, field), values, rheo_state_row_bytes(s, field));
}

void rheo_state_begin(rheo_state *s)
{
    for (rheo_field_id f = 0; f < RHEO_FIELD_COUNT; f++)
        if (is_flat(s, f) && rheo_state_row_bytes(s, f))
            memcpy(s->before[f], rheo_state_values(s, f), rheo_state_row_bytes(s, f));
    s->springs_stepped = false;
}

void rheo_state_undo(rheo_state *s)
{
    for (rheo_field_id f = 0; f < RHEO_FIELD_COUNT; f++)
        if (is_flat(s, f) && rheo_state_row_bytes(s, f))
            memcpy(rheo_state_values(s, f), s->before[f], rheo_state_row_bytes(s, f));
    if (s->springs_stepped) {
        rheo_springs swap = s->springs;
        s->springs = s->springs_other;
        s->springs_other = swap;
        s->springs_stepped = false;
    }
}

/* The sums of a memory cannot be taken back, so they must not overflow: no speed is larger than they can bear. */
static bool speeds_are_bearable(const rheo_state *s, rheo_field_id *field, uint64_t *item, uint32_t *component)
{
    size_t values = s->modes.length ? 3 * (size_t)s->particles : 0;
    int any = 0;
    for (size_t i = 0; i < values; i++)
        any |= (s->velocity[i] > RHEO_LARGEST_SPEED) | (s->velocity[i] < -RHEO_LARGEST_SPEED);
    for (size_t i = 0; any && i < values; i++)
        if (s->velocity[i] > RHEO_LARGEST_SPEED || s->velocity[i] < -RHEO_LARGEST_SPEED) {
            *field = RHEO_FIELD_velocity;
            *item = i / 3;
            *component = (uint32_t)(i % 3);
            return false;
        }
    return true;
}

bool rheo_state_finite(const rheo_state *s, rheo_field_id *field, uint64_t *item, uint32_t *component)
{
    for (rheo_field_id f = 0; f < RHEO_FIELD_COUNT; f++) {
        const rheo_field *entry = &rheo_field_table[f];
        if (!is_flat(s, f) || entry->element == RHEO_ELEMENT_U32 || entry->element == RHEO_ELEMENT_U64)
            continue;
        uint64_t values = rheo_state_items(s, f) * entry->components, bad = 0;
        /* Or-ing a test of the exponent keeps the loop free of branches. */
        if (entry->element == RHEO_ELEMENT_F32) {
            const float *value = rheo_state_values(s, f);
            uint32_t any = 0;
            for (uint64_t i = 0; i < values; i++) {
                uint32_t bits;
                memcpy(&bits, &value[i], sizeof bits);
                any |= (bits & UINT32_C(0x7F800000)) == UINT32_C(0x7F800000);
            }
            bad = any;
        } else {
            const double *value = rheo_state_values(s, f);
            for (uint64_t i = 0; i < values; i++) {
                uint64_t bits;
                memcpy(&bits, &value[i], sizeof bits);
                bad |= (bits & UINT64_C(0x7FF0000000000000)) == UINT64_C(0x7FF0000000000000);
            }
        }
        if (!bad)
            continue;
        for (uint64_t i = 0; i < values; i++) {
            double value = entry->element == RHEO_ELEMENT_F32 ? (double)((const float *)rheo_state_values(s, f))[i]
                                                              : ((const double *)rheo_state_values(s, f))[i];
            if (value - value != 0) {
                *field = f;
                *item = i / entry->components;
                *component = (uint32_t)(i % entry->components);
                return false;
            }
        }
    }
    return speeds_are_bearable(s, field, item, component);
}
