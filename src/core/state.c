/* The table of fields, and the functions that loop over it (core/state.h). */
#include "core/state.h"

#include <string.h>

#include "core/scans.h"

const rheo__field rheo__field_table[RHEO__FIELD_COUNT] = {
#define X(name, type, element, components, per, storage) \
    {#name, offsetof(rheo__state, name), element, components, per, storage},
    RHEO__FIELDS(X)
#undef X
};

size_t rheo__element_size(rheo_element element)
{
    return element == RHEO_ELEMENT_F32 || element == RHEO_ELEMENT_U32 ? 4 : 8;
}

uint64_t rheo__element_bits(rheo_element element, const void *values, size_t index)
{
    uint32_t small;
    uint64_t large;
    if (rheo__element_size(element) == 4) {
        memcpy(&small, (const char *)values + 4 * index, sizeof small);
        return small;
    }
    memcpy(&large, (const char *)values + 8 * index, sizeof large);
    return large;
}

double rheo__element_number(rheo_element element, uint64_t bits)
{
    float small;
    double large;
    uint32_t low = (uint32_t)bits;
    memcpy(&small, &low, sizeof small);
    memcpy(&large, &bits, sizeof large);
    return element == RHEO_ELEMENT_F32 ? (double)small : element == RHEO_ELEMENT_F64 ? large : (double)bits;
}

uint64_t rheo__element_distance(rheo_element element, uint64_t a, uint64_t b)
{
    if (element == RHEO_ELEMENT_F32 || element == RHEO_ELEMENT_F64) {
        double x = rheo__element_number(element, a), y = rheo__element_number(element, b);
        if (x != x || y != y)
            return UINT64_MAX;
        uint64_t sign = element == RHEO_ELEMENT_F32 ? UINT64_C(1) << 31 : UINT64_C(1) << 63, all = sign | (sign - 1);
        a = a & sign ? ~a & all : a | sign;
        b = b & sign ? ~b & all : b | sign;
    }
    return a > b ? a - b : b - a;
}

static size_t item_bytes(rheo__field_id field)
{
    return rheo__element_size(rheo__field_table[field].element) * rheo__field_table[field].components;
}

static void set_values(rheo__state *s, rheo__field_id field, void *values)
{
    memcpy((char *)s + rheo__field_table[field].offset, &values, sizeof values);
}

static bool is_flat(const rheo__state *s, rheo__field_id field)
{
    return rheo__state_has(s, field) && rheo__field_table[field].storage == RHEO__FLAT;
}

void rheo__state_init(rheo__state *s, const rheo_allocator *allocator, rheo__fields present, uint32_t ring,
                      uint32_t modes)
{
    memset(s, 0, sizeof *s);
    s->allocator = *allocator;
    s->present = present;
    rheo__ring_init(&s->ring, present & RHEO__RING_FIELDS ? ring : 0);
    rheo__ring_init(&s->modes, rheo__state_has(s, RHEO__FIELD_history_modes) ? modes : 0);
}

void rheo__state_release(rheo__state *s)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        rheo__release(&s->allocator, rheo__state_values(s, f));
        rheo__release(&s->allocator, s->before[f]);
    }
    rheo__springs_release(&s->springs, &s->allocator);
    rheo__springs_release(&s->springs_next, &s->allocator);
    rheo__release(&s->allocator, s->ring.values);
    rheo__release(&s->allocator, s->modes.values);
    memset(s, 0, sizeof *s);
}

uint64_t rheo__state_items(const rheo__state *s, rheo__field_id field)
{
    switch (rheo__field_table[field].location) {
    case RHEO_LOCATION_WORLD:
        return 1;
    case RHEO_LOCATION_PARTICLE:
        return s->particles;
    case RHEO_LOCATION_SPRING:
        return s->springs.count;
    case RHEO_LOCATION_BODY:
        return s->bodies;
    case RHEO_LOCATION_VIBRATOR:
        return s->vibrators;
    case RHEO_LOCATION_OBSTACLE:
        return s->obstacles;
    }
    return 0;
}

uint64_t rheo__state_rows(const rheo__state *s, rheo__field_id field)
{
    switch (rheo__field_table[field].storage) {
    case RHEO__RING:
        return *s->history_rows;
    case RHEO__MODES:
        return s->modes.length;
    default:
        return 1;
    }
}

size_t rheo__state_row_bytes(const rheo__state *s, rheo__field_id field)
{
    return (size_t)rheo__state_items(s, field) * item_bytes(field);
}

/* Capacity of a field in items; particle fields grow in larger steps. */
static size_t room(const rheo__state *s, rheo__field_id field)
{
    return rheo__field_table[field].location == RHEO_LOCATION_PARTICLE ? s->capacity
                                                                       : (size_t)rheo__state_items(s, field);
}

bool rheo__state_resize(rheo__state *s, uint32_t particles, uint32_t bodies, uint32_t vibrators)
{
    s->rewritten++;
    rheo__state old = *s, grown = *s;
    grown.particles = particles;
    grown.bodies = bodies;
    grown.vibrators = vibrators;
    if (particles > s->capacity || !s->step)
        grown.capacity = s->step ? particles + particles / 4 : particles;
    bool enough = rheo__ring_reserve(&s->ring, &s->allocator, grown.capacity) &&
                  rheo__ring_reserve(&s->modes, &s->allocator, grown.capacity);
    old.ring = grown.ring = s->ring;
    old.modes = grown.modes = s->modes;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        if (!is_flat(s, f) || (s->step && room(&grown, f) == room(&old, f)))
            continue;
        void *values = rheo__allocate(&s->allocator, room(&grown, f) + 1, item_bytes(f));
        void *before = rheo__allocate(&s->allocator, room(&grown, f) + 1, item_bytes(f));
        enough = enough && values && before;
        if (values && rheo__state_values(&old, f))
            memcpy(values, rheo__state_values(&old, f), rheo__state_row_bytes(&old, f));
        set_values(&grown, f, values);
        grown.before[f] = before;
    }
    /* Release the arrays that are not kept: the old ones, or on failure the new ones. */
    rheo__state *kept = enough ? &grown : &old, *dropped = enough ? &old : &grown;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        if (!is_flat(s, f))
            continue;
        if (rheo__state_values(dropped, f) != rheo__state_values(kept, f))
            rheo__release(&s->allocator, rheo__state_values(dropped, f));
        if (dropped->before[f] != kept->before[f])
            rheo__release(&s->allocator, dropped->before[f]);
    }
    *s = *kept;
    return enough;
}

/* Sets the rows of particles from this one on to 0. */
static void clear_rows(rheo__ring *ring, uint32_t first, uint32_t end)
{
    for (size_t value = 3 * (size_t)first; ring->length && value < 3 * (size_t)end; value++)
        for (uint32_t slot = 0; slot < ring->rows; slot++)
            rheo__ring_block(ring, value / RHEO__RING_BLOCK, slot)[value % RHEO__RING_BLOCK] = 0;
    ring->rewritten++;
}

/* The memory of particles that are gone is 0, as that of particles that never were. */
void rheo__state_drop_particles(rheo__state *s, uint32_t particles)
{
    const uint32_t gone = s->particles - particles;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (gone && is_flat(s, f) && rheo__field_table[f].location == RHEO_LOCATION_PARTICLE)
            memset((char *)rheo__state_values(s, f) + particles * item_bytes(f), 0, gone * item_bytes(f));
    clear_rows(&s->ring, particles, s->particles);
    clear_rows(&s->modes, particles, s->particles);
    s->particles = particles;
    s->rewritten++;
}

bool rheo__state_read_row(const rheo__state *s, rheo__field_id field, uint64_t row, void *values)
{
    switch (rheo__field_table[field].storage) {
    case RHEO__FLAT:
        if (rheo__state_row_bytes(s, field))
            memcpy(values, rheo__state_values(s, field), rheo__state_row_bytes(s, field));
        return true;
    case RHEO__SPRING:
        return field == RHEO__FIELD_spring_ends ? rheo__springs_read(&s->springs, &s->allocator, values, NULL)
                                                : rheo__springs_read(&s->springs, &s->allocator, NULL, values);
    case RHEO__RING:
    case RHEO__MODES:
        rheo__ring_read(rheo__state_ring(s, field), s->particles, (uint32_t)row, values);
        return true;
    }
    return false;
}

void rheo__state_write_row(rheo__state *s, rheo__field_id field, uint64_t row, const void *values)
{
    s->rewritten++;
    if (rheo__in_rows(field))
        rheo__ring_write(rheo__field_table[field].storage == RHEO__RING ? &s->ring : &s->modes, s->particles,
                         (uint32_t)row, values);
    else if (rheo__field_table[field].storage == RHEO__FLAT && rheo__state_row_bytes(s, field))
        memcpy(rheo__state_values(s, field), values, rheo__state_row_bytes(s, field));
}

void rheo__state_begin(rheo__state *s)
{
    s->changed = 0;
    s->springs_backup = RHEO__NO_BACKUP;
    s->spring_sums = (rheo__spring_sums){.wanted = false};
}

void rheo__state_remember(rheo__state *s, rheo__fields fields)
{
    for (rheo__fields left = fields & ~s->changed; left; left &= left - 1) {
        const rheo__field_id f = (rheo__field_id)__builtin_ctzll(left);
        if (is_flat(s, f) && rheo__state_row_bytes(s, f))
            memcpy(s->before[f], rheo__state_values(s, f), rheo__state_row_bytes(s, f));
    }
    s->changed |= fields;
}

void rheo__state_renew(rheo__state *s, rheo__field_id field)
{
    if (s->changed >> field & 1)
        return;
    void *values = s->before[field];
    s->before[field] = rheo__state_values(s, field);
    set_values(s, field, values);
    s->changed |= RHEO__SET_OF(field);
}

void rheo__state_exchange_springs(rheo__state *s)
{
    /* Exchanged instead of copied, which would cost 1.5 % of a step. */
    const rheo__springs swap = s->springs;
    s->springs = s->springs_next;
    s->springs_next = swap;
    s->springs_exchanged++;
    s->springs_backup = RHEO__ALL_SPRINGS;
}

static void exchange_rest_lengths(rheo__springs *a, rheo__springs *b)
{
    const rheo__springs swap = *a;
    a->rest_length = b->rest_length;
    a->capacity = b->capacity;
    a->count = b->count;
    b->rest_length = swap.rest_length;
    b->capacity = swap.capacity;
    b->count = swap.count;
}

const rheo_real *rheo__state_renew_rest_lengths(rheo__state *s)
{
    if (s->springs_backup != RHEO__NO_BACKUP)
        return s->springs.rest_length;
    if (!rheo__springs_reserve(&s->springs_next, &s->allocator, rheo__pairs_entries(&s->springs.pairs) + 1))
        return NULL;
    s->springs_next.count = s->springs.count;
    exchange_rest_lengths(&s->springs, &s->springs_next);
    s->springs_backup = RHEO__REST_LENGTHS;
    return s->springs_next.rest_length;
}

void rheo__state_undo(rheo__state *s)
{
    s->rewritten++;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (s->changed >> f & 1 && is_flat(s, f) && rheo__state_row_bytes(s, f))
            memcpy(rheo__state_values(s, f), s->before[f], rheo__state_row_bytes(s, f));
    s->changed = 0;
    if (s->springs_backup == RHEO__ALL_SPRINGS)
        rheo__state_exchange_springs(s);
    else if (s->springs_backup == RHEO__REST_LENGTHS)
        exchange_rest_lengths(&s->springs, &s->springs_next);
    s->springs_backup = RHEO__NO_BACKUP;
}

/* Sums of modes cannot be undone, so they must not overflow: checks that no speed is too large for them. */
static bool speeds_are_bearable(const rheo__state *s, rheo__field_id *field, uint64_t *item, uint32_t *component)
{
    size_t values = s->modes.length ? 3 * (size_t)s->particles : 0;
    int any = 0;
    for (size_t i = 0; i < values; i++)
        any |= (s->velocity[i] > RHEO__LARGEST_SPEED) | (s->velocity[i] < -RHEO__LARGEST_SPEED);
    for (size_t i = 0; any && i < values; i++)
        if (s->velocity[i] > RHEO__LARGEST_SPEED || s->velocity[i] < -RHEO__LARGEST_SPEED) {
            *field = RHEO__FIELD_velocity;
            *item = i / 3;
            *component = (uint32_t)(i % 3);
            return false;
        }
    return true;
}

bool rheo__state_finite(const rheo__state *s, rheo__fields fields, rheo__field_id *field, uint64_t *item,
                        uint32_t *component)
{
    static rheo__any_not_finite_function *const any_not_finite[] = RHEO__ALL_VARIANTS(any_not_finite);
    const rheo_element real = RHEO_DOUBLE ? RHEO_ELEMENT_F64 : RHEO_ELEMENT_F32;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++) {
        const rheo__field *entry = &rheo__field_table[f];
        if (!(fields >> f & 1) || !is_flat(s, f) || entry->element == RHEO_ELEMENT_U32 ||
            entry->element == RHEO_ELEMENT_U64)
            continue;
        const size_t values = (size_t)rheo__state_items(s, f) * entry->components;
        if (entry->element == real && !any_not_finite[rheo__simd_in_use()](rheo__state_values(s, f), values))
            continue;
        for (size_t i = 0; i < values; i++) {
            double value = entry->element == RHEO_ELEMENT_F32 ? (double)((const float *)rheo__state_values(s, f))[i]
                                                              : ((const double *)rheo__state_values(s, f))[i];
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

const char *rheo_item_name(rheo_location location)
{
    static const char *const NAME[] = {"world", "particle", "spring", "body", "vibrator", "obstacle"};
    return (size_t)location < sizeof NAME / sizeof *NAME ? NAME[location] : "item";
}
