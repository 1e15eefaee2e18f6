/*
 * Hashes of fields (core/hash.h), and their inversion: finding the one component that, with another value, would give
 * another hash. The mix is a bijection and can be inverted. So a recording does not need the values to tell what they
 * were, as long as only one differs.
 */
#include <string.h>

#include "core/field_sums.h"
#include "core/state.h"

/* ---- Forward ---- */

/* Last word of a row that ends with half a word. */
static inline uint64_t get_half_word(const char *bytes)
{
    uint32_t half;
    memcpy(&half, bytes, sizeof half);
    return half;
}

/* Sum over consecutive words of a row; `first` is the index of the first one. */
static uint64_t sum_words(const void *values, size_t size, size_t element, uint64_t row, uint64_t first)
{
    static rheo__sum_words *const variants[] = RHEO__ALL_VARIANTS(sum_words);
    const char *bytes = values;
    const size_t whole = size / 8;
    uint64_t sum = variants[rheo__simd_in_use()](bytes, whole, element, row, first);
    if (size % 8)
        sum += rheo__hash_word(row, first + whole, get_half_word(bytes + 8 * whole));
    return sum;
}

/* Sums block by block, in the order of memory. */
static uint64_t sum_ring(const rheo__state *s, const rheo__ring *ring, uint64_t rows)
{
    const size_t values = 3 * (size_t)s->particles, block_words = RHEO__RING_BLOCK * sizeof(rheo_real) / 8;
    uint64_t sum = 0;
    for (size_t first = 0, block = 0; first < values; first += RHEO__RING_BLOCK, block++) {
        size_t count = values - first < RHEO__RING_BLOCK ? values - first : RHEO__RING_BLOCK;
        for (uint64_t lag = rows; lag-- > 0;) /* slots ascend with time */
            sum += sum_words(rheo__ring_block(ring, block, rheo__ring_slot(ring, (uint32_t)lag)),
                             count * sizeof(rheo_real), sizeof(rheo_real), lag, block * block_words);
    }
    return sum;
}

static inline rheo__real_bits bits_of(rheo_real value)
{
    rheo__real_bits bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* The keys of the springs of a row whose other end has a higher rank. */
static uint64_t sum_ends(const rheo__springs *s)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < s->pairs.rows; i++) {
        uint64_t keys = 0;
        RHEO__EACH_SPRING(s, i, k)
        keys += s->key[rheo__pairs_partner(&s->pairs, k)];
        sum += s->key[i] * keys;
    }
    return sum;
}

static uint64_t sum_rest_lengths(const rheo__springs *s)
{
    static rheo__sum_rest_lengths *const variants[] = RHEO__ALL_VARIANTS(sum_rest_lengths);
    if (s->pairs.width == RHEO__BLOCK_ROWS)
        return variants[rheo__simd_in_use()](s, NULL, NULL);
    uint64_t sum = 0;
    for (uint32_t i = 0; i < s->pairs.rows; i++)
        RHEO__EACH_SPRING(s, i, k)
    sum += (s->key[i] + s->key[rheo__pairs_partner(&s->pairs, k)]) * rheo__hash_length(bits_of(s->rest_length[k]));
    return sum;
}

static uint64_t hash_rows(const rheo__state *s, rheo__field_id field, uint64_t rows)
{
    const rheo__field *f = &rheo__field_table[field];
    uint64_t sum = 0;
    switch (f->storage) {
    case RHEO__FLAT:
        sum = sum_words(rheo__state_values(s, field), rheo__state_row_bytes(s, field), rheo__element_size(f->element),
                        0, 0);
        break;
    case RHEO__SPRING:
        sum = field == RHEO__FIELD_spring_ends ? sum_ends(&s->springs) : sum_rest_lengths(&s->springs);
        break;
    case RHEO__RING:
    case RHEO__MODES:
        sum = sum_ring(s, rheo__state_ring(s, field), rows);
        break;
    }
    return rheo__hash_field(sum, rows, rheo__state_items(s, field));
}

/* Rows that a step's hash of a field covers. */
static uint64_t rows_of_step(const rheo__state *s, rheo__field_id field)
{
    return rheo__field_table[field].storage == RHEO__RING ? 1 : rheo__state_rows(s, field);
}

uint64_t rheo__state_hash_field(const rheo__state *s, rheo__field_id field)
{
    return hash_rows(s, field, rheo__state_rows(s, field));
}

void rheo__state_hash_newest(const rheo__state *s, rheo__fields fields, uint64_t *hashes)
{
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (fields >> f & 1)
            *hashes++ = hash_rows(s, f, rows_of_step(s, f));
}

uint64_t rheo__state_hash(const rheo__state *s)
{
    uint64_t sum = 0;
    for (rheo__field_id f = 0; f < RHEO__FIELD_COUNT; f++)
        if (rheo__state_has(s, f))
            sum += rheo__hash_word(0, f, rheo__state_hash_field(s, f));
    return rheo__hash_finish(sum);
}

/* ---- Backward ---- */

/* Whether one value may be a corruption of the other: a flipped bit, or a near number. A random value is not. */
static bool plausible(rheo_element element, uint64_t own, uint64_t other)
{
    uint64_t flipped = own ^ other;
    return flipped && ((flipped & (flipped - 1)) == 0 || rheo__element_distance(element, own, other) <= 1 << 24);
}

/* Finds the component whose change increases the term of one word in the sum by `more`. */
static bool solve_word(const rheo__field *field, uint64_t row, uint64_t n, uint64_t word, uint64_t more, bool half,
                       rheo__solution *found)
{
    uint64_t other = rheo__hash_unfinish(rheo__hash_word(row, n, word) + more) ^ rheo__hash_place(row, n);
    uint64_t value = n;
    if (rheo__element_size(field->element) == 4) {
        bool low_same = (uint32_t)word == (uint32_t)other, high_same = word >> 32 == other >> 32;
        if (low_same == high_same || (half && !high_same))
            return false;
        value = 2 * n + low_same;
        word = low_same ? word >> 32 : (uint32_t)word;
        other = low_same ? other >> 32 : (uint32_t)other;
    }
    /* A field with a single number has no other component that could explain the hash. */
    bool alone = field->location == RHEO_LOCATION_WORLD && field->components == 1;
    if (!alone && !plausible(field->element, word, other))
        return false;
    uint32_t component = (uint32_t)(row * field->components + value % field->components);
    *found = (rheo__solution){value / field->components, 0, component, word, other, 1};
    return true;
}

static bool solve_values(const rheo__field *field, const void *values, size_t size, uint64_t row, uint64_t first,
                         uint64_t more, rheo__solution *found)
{
    const char *bytes = values;
    size_t element = rheo__element_size(field->element), whole = size / 8;
    for (size_t n = 0; n < whole; n++)
        if (solve_word(field, row, first + n, rheo__hash_get_word(bytes + 8 * n, element), more, false, found))
            return true;
    return size % 8 && solve_word(field, row, first + whole, get_half_word(bytes + 8 * whole), more, true, found);
}

static bool solve_ring_row(const rheo__state *s, const rheo__field *field, const rheo__ring *ring, uint32_t row,
                           uint64_t more, rheo__solution *found)
{
    size_t values = 3 * (size_t)s->particles, block_words = RHEO__RING_BLOCK * sizeof(rheo_real) / 8;
    for (size_t first = 0, block = 0; first < values; first += RHEO__RING_BLOCK, block++) {
        size_t count = values - first < RHEO__RING_BLOCK ? values - first : RHEO__RING_BLOCK;
        if (solve_values(field, rheo__ring_block(ring, block, rheo__ring_slot(ring, row)), count * sizeof(rheo_real),
                         row, block * block_words, more, found))
            return true;
    }
    return false;
}

/* Inverse of an odd number mod 2^64. Each iteration doubles the number of correct bits, which is 3 at first. */
static uint64_t inverse(uint64_t odd)
{
    uint64_t x = odd;
    for (int bits = 3; bits < 64; bits *= 2)
        x *= 2 - odd * x;
    return x;
}

static rheo__solution solved_spring(uint32_t a, uint32_t b, uint64_t own, uint64_t other, uint64_t count)
{
    return (rheo__solution){a < b ? a : b, a < b ? b : a, 0, own, other, count};
}

/* The length with this term. False: there is none. */
static bool length_of(uint64_t term, rheo__real_bits *length)
{
    if (sizeof *length == 8) {
        *length = (rheo__real_bits)rheo__hash_unfinish(term);
        return true;
    }
    *length = (rheo__real_bits)(uint64_t)__builtin_sqrt((double)term) - RHEO__HASH_LENGTH;
    for (int tried = 0; tried < 3; tried++, --*length) /* the root was rounded */
        if (rheo__hash_length(*length + 1) == term) {
            ++*length;
            return true;
        }
    return false;
}

static bool solve_rest_length(const rheo__state *s, uint64_t more, rheo__solution *found)
{
    const rheo__pairs *p = &s->springs.pairs;
    for (uint32_t i = 0; i < p->rows && more % 2 == 0; i++)
        RHEO__EACH_SPRING(&s->springs, i, k)
        {
            const uint32_t a = p->id_of[i], b = p->id_of[rheo__pairs_partner(p, k)];
            /* Both keys are 1 mod 4, so half of their sum is odd. */
            const uint64_t half = (rheo__hash_key(a) >> 1) + (rheo__hash_key(b) >> 1) + 1;
            const rheo__real_bits own = bits_of(s->springs.rest_length[k]);
            rheo__real_bits other;
            /* The factor 2 hides the highest bit of the term. */
            for (uint64_t bit = 0, term = rheo__hash_length(own) + more / 2 * inverse(half); bit < 2; bit++)
                if (length_of(term ^ bit << 63, &other) && plausible(RHEO__ELEMENT_REAL, own, other)) {
                    *found = solved_spring(a, b, own, other, 1);
                    return true;
                }
        }
    return false;
}

/* Table from the keys of particles to their ids. */
typedef struct key_table {
    uint32_t *id; /* id + 1, or 0 */
    uint64_t mask;
} key_table;

static bool make_keys(key_table *table, const rheo__state *s)
{
    uint64_t size = 16;
    while (size < 2 * (uint64_t)s->particles)
        size *= 2;
    table->mask = size - 1;
    table->id = size <= SIZE_MAX ? rheo__allocate(&s->allocator, (size_t)size, sizeof *table->id) : NULL;
    for (uint32_t id = 0; table->id && id < s->particles; id++) {
        uint64_t at = rheo__hash_key(id) >> 1 & table->mask;
        while (table->id[at])
            at = (at + 1) & table->mask;
        table->id[at] = id + 1;
    }
    return table->id;
}

/* UINT32_MAX: no particle has this key. */
static uint32_t find_key(const key_table *table, uint64_t key)
{
    for (uint64_t at = key >> 1 & table->mask; (key & 1) && table->id[at]; at = (at + 1) & table->mask)
        if (rheo__hash_key(table->id[at] - 1) == key)
            return table->id[at] - 1;
    return UINT32_MAX;
}

/*
 * Two particles are connected (1) or not (0). A spring with another end is one less and one more; the first is named.
 */
static bool solve_ends(const rheo__state *s, const key_table *keys, int more_springs, uint64_t more,
                       rheo__solution *found)
{
    const rheo__pairs *p = &s->springs.pairs;
    if (more_springs > 0)
        for (uint32_t a = 0; a < s->particles; a++) {
            uint32_t b = find_key(keys, more * inverse(rheo__hash_key(a)));
            if (b != UINT32_MAX && b != a && rheo__springs_find(&s->springs, a, b) == SIZE_MAX) {
                *found = solved_spring(a, b, 0, 1, 1);
                return true;
            }
        }
    for (uint32_t i = 0; i < p->rows && more_springs <= 0; i++)
        RHEO__EACH_SPRING(&s->springs, i, k)
        {
            uint32_t end[2] = {p->id_of[i], p->id_of[rheo__pairs_partner(p, k)]};
            uint64_t key[2] = {rheo__hash_key(end[0]), rheo__hash_key(end[1])};
            if (more_springs < 0 && key[0] * key[1] + more == 0) {
                *found = solved_spring(end[0], end[1], 1, 0, 1);
                return true;
            }
            for (int moved = 0; moved < 2 && more_springs == 0; moved++) {
                uint32_t to = find_key(keys, key[moved] + more * inverse(key[!moved]));
                if (to == UINT32_MAX || to == end[moved])
                    continue;
                rheo__solution own = solved_spring(end[0], end[1], 1, 0, 2);
                rheo__solution other = solved_spring(end[!moved], to, 0, 1, 2);
                bool own_first = own.id < other.id || (own.id == other.id && own.other_id < other.other_id);
                *found = own_first ? own : other;
                return true;
            }
        }
    return false;
}

bool rheo__state_solve(const rheo__state *s, rheo__field_id field, uint64_t other_hash, rheo__solution *found)
{
    const rheo__field *f = &rheo__field_table[field];
    uint64_t items = rheo__state_items(s, field), own;
    rheo__state_hash_newest(s, RHEO__SET_OF(field), &own);
    uint64_t rows = rows_of_step(s, field);
    uint64_t sum = rheo__hash_sum(own, rows, items), more = rheo__hash_sum(other_hash, rows, items) - sum;
    if (f->storage == RHEO__FLAT)
        return solve_values(f, rheo__state_values(s, field), rheo__state_row_bytes(s, field), 0, 0, more, found);
    if (rheo__in_rows(field)) {
        for (uint32_t row = 0; row < rows; row++)
            if (solve_ring_row(s, f, rheo__state_ring(s, field), row, more, found))
                return true;
        return false;
    }
    if (field == RHEO__FIELD_spring_rest_length)
        return solve_rest_length(s, more, found);
    key_table keys;
    if (!make_keys(&keys, s))
        return false;
    bool solved = solve_ends(s, &keys, 0, more, found) ||
                  solve_ends(s, &keys, 1, rheo__hash_sum(other_hash, 1, items + 1) - sum, found) ||
                  (items && solve_ends(s, &keys, -1, rheo__hash_sum(other_hash, 1, items - 1) - sum, found));
    rheo__release(&s->allocator, keys.id);
    return solved;
}
