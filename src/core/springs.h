/*
 * Pairs of particles in the rank order of a step, and springs: pairs with a rest length.
 *
 * The rank of a particle is its index in cell order. Row i holds the partners of rank i that have a higher rank,
 * ascending; a pair belongs to its lower rank. Loading a state sets rank = id. No result depends on the order: a
 * spring is found by its two particles, and springs are written in the order of ids.
 */
#ifndef RHEO__CORE_SPRINGS_H
#define RHEO__CORE_SPRINGS_H

#include "core/memory.h"
#include "core/strict.h"

typedef struct rheo__pairs {
    uint32_t rows;     /* particles when the list was made */
    uint32_t *id_of;   /* rows: rank -> id */
    uint32_t *rank_of; /* rows: id -> rank */
    uint32_t *start;   /* rows + 1: row i is partner[start[i]] .. partner[start[i+1] - 1] */
    uint32_t *partner; /* ranks; one more value, `rows`, follows the last pair: see space/walk.h */
    size_t row_capacity, capacity;
} rheo__pairs;

typedef struct rheo__springs {
    rheo__pairs pairs;
    rheo_real *rest_length; /* parallel to pairs.partner */
    size_t capacity;
} rheo__springs;

static inline size_t rheo__pairs_count(const rheo__pairs *pairs)
{
    return pairs->rows ? pairs->start[pairs->rows] : 0;
}

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

/* Whether the ends of springs are valid: two different particles each, ascending, no spring twice. */
bool rheo__springs_ordered(uint32_t particles, size_t count, const uint32_t *ends);

/* Reads the springs by smaller, then larger id; either array may be NULL. False: no memory. */
bool rheo__springs_read(const rheo__springs *springs, const rheo_allocator *allocator, uint32_t *ends,
                        rheo_real *rest_length);

/* Index of the spring between two ids; SIZE_MAX if there is none. */
size_t rheo__springs_find(const rheo__springs *springs, uint32_t a, uint32_t b);

#endif
