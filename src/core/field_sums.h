/* Sums of hashes (core/hash.h) over all values of a field, compiled for each SIMD variant. */
#ifndef RHEO__CORE_FIELD_SUMS_H
#define RHEO__CORE_FIELD_SUMS_H

#include "core/hash.h"
#include "core/simd.h"
#include "core/springs.h"

/* Sum over consecutive words of a row; `first` is the index of the first one. */
typedef uint64_t rheo__sum_words(const char *bytes, size_t count, size_t element, uint64_t row, uint64_t first);
RHEO__DECLARE_VARIANTS(rheo__sum_words, sum_words)

/*
 * Marks: one bit for each entry of springs in blocks, set if the entry is a spring. A row has a word for every
 * RHEO__HASH_MARKS entries. They tell which springs have come and gone since they were made.
 */
enum { RHEO__HASH_MARKS = 8 * sizeof(rheo__real_bits) };

/* Number of words before those of a block, for one row. */
static inline size_t rheo__hash_marks(const rheo__pairs *pairs, uint32_t block)
{
    return pairs->start[block] / RHEO__HASH_MARKS + block;
}

/*
 * Sum of the rest lengths of springs in blocks. Makes `marks`, unless NULL, and with them brings up to date the sum
 * of ends, *ends, unless NULL, which belongs to the marks before.
 */
typedef uint64_t rheo__sum_rest_lengths(const rheo__springs *springs, rheo__real_bits *marks, uint64_t *ends);
RHEO__DECLARE_VARIANTS(rheo__sum_rest_lengths, sum_rest_lengths)

/* Adds one vector of rows of a block to sums whose marks are those of the same list. `first`: its first row. */
typedef void rheo__add_rest_lengths(rheo__spring_sums *sums, const rheo__springs *springs, uint32_t block,
                                    uint32_t first);
RHEO__DECLARE_VARIANTS(rheo__add_rest_lengths, add_rest_lengths)

#endif
