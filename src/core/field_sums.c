/*
 * The sums of hashes (core/field_sums.h) that run over all values of a field: the words of flat fields and rings, and the
 * rest lengths of springs in blocks. All variants compute modulo 2^64, so they give the same sums.
 */
#include <string.h>

#include "core/field_sums.h"
#include "core/lanes.h"

/* ---- Words ---- */

uint64_t RHEO__VARIANT(sum_words)(const char *bytes, size_t count, size_t element, uint64_t row, uint64_t first)
{
    uint64_t sum = 0;
    size_t n = 0;
#if defined(__AVX2__) && RHEO__VECTOR_BYTES >= 32 /* others have no product that beats the scalar one */
    /* Two vectors at a time, so that neither waits for its own products. */
    enum { WORDS = RHEO__VECTOR_BYTES / 8 };
    rheo__words place[2], sums[2] = {{0}, {0}};
    for (int lane = 0; lane < 2 * WORDS; lane++)
        place[lane / WORDS][lane % WORDS] = rheo__hash_place(row, first + (uint64_t)lane);
    for (; n + 2 * WORDS <= count; n += 2 * WORDS)
        for (int k = 0; k < 2; k++) {
            rheo__words x;
            memcpy(&x, bytes + 8 * n + k * sizeof x, sizeof x);
            x ^= place[k];
            x ^= x >> 32;
            x *= RHEO__HASH_MULTIPLIER;
            x ^= x >> 32;
            x *= RHEO__HASH_MULTIPLIER;
            x ^= x >> 32;
            sums[k] += x;
            place[k] += 2 * WORDS * RHEO__HASH_PLACE;
        }
    for (int lane = 0; lane < WORDS; lane++)
        sum += sums[0][lane] + sums[1][lane];
#endif
    for (; n < count; n++)
        sum += rheo__hash_word(row, first + n, rheo__hash_get_word(bytes + 8 * n, element));
    return sum;
}

/* ---- Rest lengths ---- */

/* Sums of the terms of the rest lengths of each row. */
typedef struct row_sums {
#if RHEO__LANES == 1
    uint64_t sum;
#elif RHEO_DOUBLE
    rheo__words sum;
#else
    rheo__words even, odd;
#endif
} row_sums;

/* Adds the terms of lengths with these bits where `spring` is filled. */
static inline void add(row_sums *sums, rheo__mask bits, rheo__mask spring)
{
#if RHEO__LANES == 1
    sums->sum += rheo__hash_length((rheo__real_bits)bits) & (uint64_t)(int64_t)spring;
#elif RHEO_DOUBLE
    rheo__words x = (rheo__words)bits;
    x ^= x >> 32;
    x *= RHEO__HASH_MULTIPLIER;
    x ^= x >> 32;
    x *= RHEO__HASH_MULTIPLIER;
    sums->sum += (x ^ x >> 32) & (rheo__words)spring;
#else
    const rheo__words x = (rheo__words)(((rheo__ranks)bits + RHEO__HASH_LENGTH) & (rheo__ranks)spring);
    sums->even += rheo__words_square(x);
    sums->odd += rheo__words_square(x >> 32);
#endif
}

/* These sums by row. */
static inline void get_sums(const row_sums *sums, uint64_t of_row[RHEO__LANES])
{
#if RHEO__LANES == 1
    of_row[0] = sums->sum;
#elif RHEO_DOUBLE
    memcpy(of_row, &sums->sum, sizeof sums->sum);
#else
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    enum { EVEN = 1, ODD = 0 };
#else
    enum { EVEN = 0, ODD = 1 };
#endif
    for (int pair = 0; pair < RHEO__LANES / 2; pair++) {
        of_row[2 * pair + EVEN] = sums->even[pair];
        of_row[2 * pair + ODD] = sums->odd[pair];
    }
#endif
}

/*
 * Marks the springs among consecutive entries of a vector of rows, one bit each, and compares with the marks before.
 * A pair that has become or ceased to be a spring changes the sum of ends; it is counted in the row of lower rank.
 */
static void note_changes(const rheo__springs *s, uint32_t row, size_t last, rheo__bits now, rheo__bits before,
                         uint64_t *ends)
{
    rheo__real_bits is[RHEO__LANES], was[RHEO__LANES];
    memcpy(is, &now, sizeof is);
    memcpy(was, &before, sizeof was);
    for (uint32_t lanes = rheo__lanes_true((rheo__mask)(now != before)); lanes; lanes &= lanes - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(lanes);
        for (uint64_t changed = is[lane] ^ was[lane]; changed; changed &= changed - 1) {
            const int bit = __builtin_ctzll(changed);
            const uint32_t partner = rheo__pairs_partner(&s->pairs, last - (size_t)bit * RHEO__BLOCK_ROWS + lane);
            if (partner <= row + lane)
                continue;
            const uint64_t key = s->key[row + lane] * s->key[partner];
            *ends += is[lane] >> bit & 1 ? key : -key;
        }
    }
}

/* Sum of a vector of rows of a block. */
static inline uint64_t sum_rows(const rheo__springs *s, uint32_t block, uint32_t first, rheo__real_bits *marks,
                                uint64_t *ends)
{
    enum { MARKS = RHEO__HASH_MARKS };
    const rheo__pairs *p = &s->pairs;
    const uint32_t row = block * RHEO__BLOCK_ROWS + first;
    row_sums sums = {0};
    rheo__real_bits *mark = marks ? marks + rheo__hash_marks(p, block) * RHEO__BLOCK_ROWS + first : NULL;
    for (size_t k = p->start[block], end = k; k < p->start[block + 1]; k = end) {
        rheo__bits now = {0};
        end = k + MARKS < p->start[block + 1] ? k + MARKS : p->start[block + 1];
        for (; k < end; k++) {
            rheo__lanes length;
            rheo__mask bits;
            memcpy(&length, s->rest_length + k * RHEO__BLOCK_ROWS + first, sizeof length);
            memcpy(&bits, &length, sizeof bits);
            const rheo__mask spring = rheo__mask_filled(length >= 0);
            add(&sums, bits, spring);
            now = now + now - (rheo__bits)spring;
        }
        if (!mark)
            continue;
        rheo__bits before;
        memcpy(&before, mark, sizeof before);
        if (ends && rheo__lanes_any((rheo__mask)(now != before)))
            note_changes(s, row, (end - 1) * RHEO__BLOCK_ROWS + first, now, before, ends);
        memcpy(mark, &now, sizeof now);
        mark += RHEO__BLOCK_ROWS;
    }
    uint64_t of_row[RHEO__LANES], sum = 0;
    get_sums(&sums, of_row);
    for (uint32_t lane = 0; lane < RHEO__LANES; lane++) /* 0 in idle rows */
        sum += s->key[row + lane] * of_row[lane];
    return sum;
}

uint64_t RHEO__VARIANT(sum_rest_lengths)(const rheo__springs *s, rheo__real_bits *marks, uint64_t *ends)
{
    uint64_t sum = 0;
    for (uint32_t block = 0; block < s->pairs.blocks; block++)
        for (uint32_t first = 0; first < RHEO__BLOCK_ROWS; first += RHEO__LANES)
            sum += sum_rows(s, block, first, marks, ends);
    return sum;
}

void RHEO__VARIANT(add_rest_lengths)(rheo__spring_sums *sums, const rheo__springs *s, uint32_t block, uint32_t first)
{
    sums->lengths += sum_rows(s, block, first, sums->marks, sums->ends);
}
