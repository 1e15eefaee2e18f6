/*
 * The 64-bit hash of a field: a sum (mod 2^64) over its items of a strong mix of every word of the item with the
 * item's identity, so that items may be visited in any order; then a final mix with the number of items.
 *
 * An item's components are packed little-endian into 64-bit words: two 32-bit components a word (the last word of an
 * odd number is filled with 0), or one 64-bit component a word. Identity is the id of a particle, body or source, 0
 * for the world, and (smaller id << 32 | larger id) for a spring. In a ring, lag l of an item with w words uses the
 * word numbers l w, l w + 1, ...
 *
 * The mix is a bijection of the word, so one changed word always changes the sum; two or more changed words keep it
 * with probability 2^-64. docs/format.md states all of it with test vectors.
 */
#ifndef RHEO_CORE_HASH_H
#define RHEO_CORE_HASH_H

#include <stdint.h>

static inline uint64_t rheo_hash_finish(uint64_t x)
{
    x ^= x >> 32;
    x *= UINT64_C(0xD6E8FEB86659FD93);
    x ^= x >> 32;
    x *= UINT64_C(0xD6E8FEB86659FD93);
    x ^= x >> 32;
    return x;
}

/* The part of the identity that all words of an item share. */
static inline uint64_t rheo_hash_item(uint64_t identity)
{
    return (identity + 1) * UINT64_C(0x9E3779B97F4A7C15);
}

static inline uint64_t rheo_hash_word(uint64_t item, uint64_t number, uint64_t word)
{
    return rheo_hash_finish(word ^ (item + number * UINT64_C(0xD1B54A32D192ED03)));
}

/* The hash of a field from its sum. */
static inline uint64_t rheo_hash_field(uint64_t sum, uint64_t rows, uint64_t items)
{
    return rheo_hash_finish(sum + rheo_hash_word(rheo_hash_item(rows), 0, items));
}

#endif
