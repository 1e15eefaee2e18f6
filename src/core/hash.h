/*
 * The 64-bit hash of a field: a sum (mod 2^64) over its words or springs, then a final mix with the numbers of rows
 * and items. It is a sum so that springs, which have no fixed order in memory, need no sorting.
 *
 * Values: a row has the values of all items one after another. It is cut into little-endian 64-bit words, the last
 * one padded with 0. Each word is mixed with its position by a bijection, so one changed word always changes the sum;
 * several changed words keep it with probability 2^-64.
 *
 * Springs: with a key(id) = 1 mod 4 for every particle, spring_ends is the sum of key(a) key(b) over the springs of a
 * and b. spring_rest_length is the sum of (key(a) + key(b)) t(length), so that the terms t of a row can be added before
 * they are multiplied by the key of its particle. Adding, removing, moving or resizing one spring changes the sum.
 * docs/format.md has the probabilities for several, and test vectors.
 */
#ifndef RHEO__CORE_HASH_H
#define RHEO__CORE_HASH_H

#include <string.h>

#include "core/real.h"

#define RHEO__HASH_MULTIPLIER UINT64_C(0xD6E8FEB86659FD93)
#define RHEO__HASH_INVERSE UINT64_C(0xCFEE444D8B59A89B) /* of the multiplier, mod 2^64 */

static inline uint64_t rheo__hash_finish(uint64_t x)
{
    x ^= x >> 32;
    x *= RHEO__HASH_MULTIPLIER;
    x ^= x >> 32;
    x *= RHEO__HASH_MULTIPLIER;
    x ^= x >> 32;
    return x;
}
static inline uint64_t rheo__hash_unfinish(uint64_t x)
{
    x ^= x >> 32;
    x *= RHEO__HASH_INVERSE;
    x ^= x >> 32;
    x *= RHEO__HASH_INVERSE;
    x ^= x >> 32;
    return x;
}

#define RHEO__HASH_PLACE UINT64_C(0x9E3779B97F4A7C15)

/* Position of a word: its index n in a row. row: the lag in a ring, else 0. */
static inline uint64_t rheo__hash_place(uint64_t row, uint64_t n)
{
    return (n + 1) * RHEO__HASH_PLACE + row * UINT64_C(0xD1B54A32D192ED03);
}
static inline uint64_t rheo__hash_word(uint64_t row, uint64_t n, uint64_t word)
{
    return rheo__hash_finish(word ^ rheo__hash_place(row, n));
}

/* The key of a particle: both halves of a 128-bit product. */
static inline uint64_t rheo__hash_key(uint32_t id)
{
    const uint64_t x = UINT64_C(0xA0761D6478BD642F) ^ id, m = UINT64_C(0xE7037ED1A0B428DB);
#ifdef __SIZEOF_INT128__
    __extension__ typedef unsigned __int128 wide;
    wide product = (wide)x * m;
    uint64_t low = x * m, high = (uint64_t)(product >> 64);
#else
    const uint64_t x0 = (uint32_t)x, x1 = x >> 32, m0 = (uint32_t)m, m1 = m >> 32;
    const uint64_t middle = x1 * m0 + (x0 * m0 >> 32), other = x0 * m1 + (uint32_t)middle;
    uint64_t low = x * m, high = x1 * m1 + (middle >> 32) + (other >> 32);
#endif
    return ((low ^ high) & ~UINT64_C(3)) | 1;
}

/*
 * The term of a rest length with these bits. It is not linear, and the same for no two lengths. In float it is a
 * square, the only product of which all machines compute several at once. Without the odd number added, the squares of
 * lengths like 0.5 would differ in few bits.
 */
#define RHEO__HASH_LENGTH UINT32_C(0x2545F491)
static inline uint64_t rheo__hash_length(rheo__real_bits bits)
{
    const uint64_t root = (uint64_t)bits + RHEO__HASH_LENGTH;
    return sizeof bits == 4 ? root * root : rheo__hash_finish(bits);
}

/* The hash of a field from its sum, and back. */
static inline uint64_t rheo__hash_field(uint64_t sum, uint64_t rows, uint64_t items)
{
    return rheo__hash_finish(sum + rheo__hash_word(rows, items, 0));
}
static inline uint64_t rheo__hash_sum(uint64_t hash, uint64_t rows, uint64_t items)
{
    return rheo__hash_unfinish(hash) - rheo__hash_word(rows, items, 0);
}

/* Eight bytes as a word; of two values of four bytes the first is the lower half. */
static inline uint64_t rheo__hash_get_word(const char *bytes, size_t element)
{
    uint64_t word;
    memcpy(&word, bytes, sizeof word);
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    return element == 4 ? word >> 32 | word << 32 : word;
#else
    (void)element;
    return word;
#endif
}

#endif
