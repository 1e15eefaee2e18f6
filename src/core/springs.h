/*
 * Pairs of particles in the rank order of a step, and springs: pairs with a rest length.
 *
 * The rank of a particle is its index in cell order. Row i holds partners of rank i, ascending, in one of two layouts:
 *
 *   width 1: the partners that have a higher rank; row after row
 *   width RHEO__BLOCK_ROWS: all partners; the rows of a block lie side by side, as the lanes of vectors read them.
 *       Entries after the last partner of a row hold the row's own rank.
 *
 * Loading a state sets rank = id. No result depends on the order: a spring is found by its two particles, and springs
 * are written in the order of ids.
 */
#ifndef RHEO__CORE_SPRINGS_H
#define RHEO__CORE_SPRINGS_H

#include "core/memory.h"
#include "core/strict.h"

/* Rows side by side in a block: the largest number of lanes of any SIMD variant. */
enum { RHEO__BLOCK_ROWS = 16 };

typedef struct rheo__pairs {
    uint32_t rows;     /* particles when the list was made */
    uint32_t width;    /* rows of a block */
    uint32_t blocks;   /* rows/width, rounded up */
    uint32_t *id_of;   /* rows: rank -> id */
    uint32_t *rank_of; /* rows: id -> rank */
    uint32_t *start;   /* blocks + 1: block b is partner[start[b] width] .. partner[start[b+1] width - 1] */
    uint32_t *partner; /* ranks; one more value, `rows`, follows the last pair of width 1: see space/walk.h */
    size_t row_capacity, capacity;
} rheo__pairs;

/* Springs are those of the pairs that have a rest length >= 0. */
typedef struct rheo__springs {
    rheo__pairs pairs;
    rheo_real *rest_length; /* parallel to pairs.partner; negative: no spring */
    size_t capacity;
    size_t count;  /* number of springs */
    uint64_t *key; /* by rank: keys of the particles, for hashes */
    size_t key_capacity;
} rheo__springs;

/* Indices of the first entry of row i, and after its last one; entries are `width` apart. */
static inline size_t rheo__pairs_first(const rheo__pairs *pairs, uint32_t i)
{
    return (size_t)pairs->start[i / pairs->width] * pairs->width + i % pairs->width;
}
static inline size_t rheo__pairs_end(const rheo__pairs *pairs, uint32_t i)
{
    return (size_t)pairs->start[i / pairs->width + 1] * pairs->width;
}
/* Sets the layout of a list of this many rows. */
static inline void rheo__pairs_shape(rheo__pairs *pairs, uint32_t rows, uint32_t width)
{
    pairs->rows = rows;
    pairs->width = width;
    pairs->blocks = rows / width + (rows % width != 0);
}

/* Number of entries of all rows. */
static inline size_t rheo__pairs_entries(const rheo__pairs *pairs)
{
    return pairs->blocks ? (size_t)pairs->start[pairs->blocks] * pairs->width : 0;
}

/* Number of pairs in a list of width 1. */
static inline size_t rheo__pairs_count(const rheo__pairs *pairs)
{
    return pairs->rows ? pairs->start[pairs->rows] : 0;
}

/* Loop over the springs of row i whose other end has a higher rank: k is the index of the entry. */
#define RHEO__EACH_SPRING(springs, i, k)                                                                      \
    for (size_t k = rheo__pairs_first(&(springs)->pairs, i), k##_end = rheo__pairs_end(&(springs)->pairs, i); \
         k < k##_end; k += (springs)->pairs.width)                                                            \
        if ((springs)->pairs.partner[k] > (i) && (springs)->rest_length[k] >= 0)

bool rheo__pairs_reserve_rows(rheo__pairs *pairs, const rheo_allocator *allocator, uint32_t rows);
/* Makes room for `count` partners and keeps the first `kept`. False: no memory. */
bool rheo__pairs_reserve(rheo__pairs *pairs, const rheo_allocator *allocator, size_t count, size_t kept);
void rheo__pairs_release(rheo__pairs *pairs, const rheo_allocator *allocator);

bool rheo__springs_reserve(rheo__springs *springs, const rheo_allocator *allocator, size_t count);
void rheo__springs_release(rheo__springs *springs, const rheo_allocator *allocator);

/*
 * Sets the springs, with rank = id. ends: count x 2 ids, the smaller first, ascending; the caller has checked them.
 * False: no memory, nothing changed.
 */
bool rheo__springs_set(rheo__springs *springs, const rheo_allocator *allocator, uint32_t particles, size_t count,
                       const uint32_t *ends, const rheo_real *rest_length);

/* Sets the keys, which every change of the ranks puts out of date. False: no memory. */
bool rheo__springs_make_keys(rheo__springs *springs, const rheo_allocator *allocator);

/* Whether the ends of springs are valid: two different particles each, ascending, no spring twice. */
bool rheo__springs_ordered(uint32_t particles, size_t count, const uint32_t *ends);

/* Reads the springs by smaller, then larger id; either array may be NULL. False: no memory. */
bool rheo__springs_read(const rheo__springs *springs, const rheo_allocator *allocator, uint32_t *ends,
                        rheo_real *rest_length);

/* Index of an entry of the spring between two ids; SIZE_MAX if there is none. */
size_t rheo__springs_find(const rheo__springs *springs, uint32_t a, uint32_t b);

#endif
