/*
 * Hashes of fields (core/hash.h), and the way back: which one component, had it another value, would give another
 * hash. A mix that is a bijection can be undone, so a recording needs no values to say what they were, as long as a
 * single one differs.
 */
#include <string.h>

#include "core/hash.h"
#include "core/state.h"

/* ---- Forward ---- */

/* Eight bytes as a word, and a word as eight bytes; of two values of four bytes the first is the lower half. */
static inline uint64_t swap_halves(uint64_t word, size_t element)
{
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    return element == 4 ? word >> 32 | word << 32 : word;
#else
    (void)element;
    return word;
#endif
}

static inline uint64_t get_word(const char *bytes, size_t element)
{
    uint64_t word;
    memcpy(&word, bytes, sizeof word);
    return swap_halves(word, element);
}

/* The last word of a row that ends with half of one. */
static inline uint64_t get_half_word(const char *bytes)
{
    uint32_t half;
    memcpy(&half, bytes, sizeof half);
    return half;
}

/* The sum over consecutive words of a row, `first` being the number of the first one. */
static inline uint64_t sum_words(const void *values, size_t size, size_t element, uint64_t row, uint64_t first)
{
    const char *bytes = values;
    size_t whole = size / 8;
    uint64_t sum = 0;
    for (size_t n = 0; n < whole; n++)
        sum += rheo_hash_word(row, first + n, get_word(bytes + 8 * n, element));
    if (size % 8)
        sum += rheo_hash_word(row, first + whole, get_half_word(bytes + 8 * whole));
    return sum;
}

/* Block by block, since that is how the rows lie in memory. */
static uint64_t sum_ring(const rheo_state *s, uint64_t rows)
{
    const size_t values = 3 * (size_t)s->particles, block_words = RHEO_RING_BLOCK * sizeof(rheo_real) / 8;
    uint64_t sum = 0;
    for (size_t first = 0, block = 0; first < values; first += RHEO_RING_BLOCK, block++) {
        size_t count = values - first < RHEO_RING_BLOCK ? values - first : RHEO_RING_BLOCK;
        for (uint64_t lag = rows; lag-- > 0;) /* slots ascend with time */
            sum += sum_words(rheo_ring_block(&s->ring, block, rheo_ring_slot(&s->ring, (uint32_t)lag)),
                             count * sizeof(rheo_real), sizeof(rheo_real), lag, block * block_words);
    }
    return sum;
}

static inline uint64_t bits_of(rheo_real value)
{
    rheo_real_bits bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Sums of both fields of springs, which need the same keys. */
static void sum_springs(const rheo_state *s, uint64_t *ends, uint64_t *rest_lengths)
{
    const rheo_pairs *p = &s->springs.pairs;
    *ends = *rest_lengths = 0;
    for (uint32_t i = 0; i < p->rows; i++) {
        uint64_t keys = 0, lengths = 0;
        for (uint32_t k = p->start[i]; k < p->start[i + 1]; k++) {
            uint64_t key = rheo_hash_key(p->id_of[p->partner[k]]);
            keys += key;
            lengths += key * bits_of(s->springs.rest_length[k]);
        }
        uint64_t own = rheo_hash_key(p->id_of[i]);
        *ends += own * keys;
        *rest_lengths += own * lengths;
    }
}

static uint64_t hash_rows(const rheo_state *s, rheo_field_id field, uint64_t rows)
{
    const rheo_field *f = &rheo_field_table[field];
    uint64_t sum = 0, other;
    switch (f->storage) {
    case RHEO_FLAT:
        sum = sum_words(rheo_state_values(s, field), rheo_state_row_bytes(s, field), rheo_element_size(f->element), 0,
                        0);
        break;
    case RHEO_SPRING:
        if (field == RHEO_FIELD_spring_ends)
            sum_springs(s, &sum, &other);
        else
            sum_springs(s, &other, &sum);
        break;
    case RHEO_RING:
        sum = sum_ring(s, rows);
        break;
    }
    return rheo_hash_field(sum, rows, rheo_state_items(s, field));
}

uint64_t rheo_state_hash_field(const rheo_state *s, rheo_field_id field)
{
    return hash_rows(s, field, rheo_state_rows(s, field));
}

void rheo_state_hash_newest(const rheo_state *s, uint32_t fields, uint64_t *hashes)
{
    const uint32_t springs = RHEO_BIT(spring_ends) | RHEO_BIT(spring_rest_length);
    for (rheo_field_id f = 0; f < RHEO_FIELD_COUNT; f++) {
        if (!(fields >> f & 1))
            continue;
        if (f == RHEO_FIELD_spring_ends && (fields & springs) == springs) {
            uint64_t ends, rest_lengths, items = rheo_state_items(s, f);
            sum_springs(s, &ends, &rest_lengths);
            *hashes++ = rheo_hash_field(ends, 1, items);
            *hashes++ = rheo_hash_field(rest_lengths, 1, items);
            f = RHEO_FIELD_spring_rest_length;
        } else {
            *hashes++ = hash_rows(s, f, 1);
        }
    }
}
_Static_assert(RHEO_FIELD_spring_rest_length == RHEO_FIELD_spring_ends + 1, "hashed together, in this order");

uint64_t rheo_state_hash(const rheo_state *s)
{
    uint64_t sum = 0;
    for (rheo_field_id f = 0; f < RHEO_FIELD_COUNT; f++)
        if (rheo_state_has(s, f))
            sum += rheo_hash_word(0, f, rheo_state_hash_field(s, f));
    return rheo_hash_finish(sum);
}
