/*
 * Pairs of particles in the rank order of a step, and springs: pairs with a rest length.
 *
 * The rank of a particle is its place in the order of a list. Row i holds partners of rank i in one of two layouts:
 *
 *   width 1: the partners that have a higher rank, ascending; row after row
 *   width RHEO__BLOCK_ROWS: all partners, in the order of cells; the rows of a block lie side by side, as the lanes of
 *       vectors read them. Entries after the last partner of a row are idle: their partner is the rank after the last
 *       row of all blocks. In periodic space the partner may be an image; the ranks of images follow that of idle
 *       entries. Images have no rows.
 *
 * Loading a state sets rank = id. No result depends on the order: a spring is found by its two particles, and springs
 * are written in the order of ids.
 */
#ifndef RHEO__CORE_SPRINGS_H
#define RHEO__CORE_SPRINGS_H

#include "core/memory.h"
#include "core/real.h"

enum {
    RHEO__BLOCK_ROWS = 16, /* rows side by side in a block: the largest number of lanes of any SIMD variant */
    RHEO__POINT_VALUES = 4,
};

/* An image of a particle in periodic space: `home` is the rank of the particle, `shift` how many periods it is away. */
typedef struct rheo__image {
    uint32_t home;
    int8_t shift[3];
} rheo__image;

typedef struct rheo__pairs {
    uint32_t rows;     /* particles when the list was made */
    uint32_t width;    /* rows of a block */
    uint32_t blocks;   /* rows/width, rounded up */
    uint32_t *id_of;   /* rows: rank -> id */
    uint32_t *rank_of; /* rows: id -> rank */
    uint32_t *start;   /* blocks + 1: block b is partner[start[b] width] .. partner[start[b+1] width - 1] */
    /*
     * Width 1: ranks; one more value, `rows`, follows the last pair (space/walk.h). Blocks: RHEO__POINT_VALUES x rank, the
     * index of the partner's first value in an array of points.
     */
    uint32_t *partner;
    rheo__image *image;
    uint32_t images;
    size_t row_capacity, capacity, image_capacity;
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

/*
 * Sums of the hashes of springs in blocks (core/field_sums.h). A stage that writes all rest lengths makes them while it
 * has these at hand, if they are wanted. Not state.
 */
typedef struct rheo__spring_sums {
    bool wanted, made;
    uint64_t lengths;
    uint64_t *ends; /* brought up to date with the marks */
    rheo__real_bits *marks;
} rheo__spring_sums;

/* Indices of the first entry of row i, and after its last one; entries are `width` apart. */
static inline size_t rheo__pairs_first(const rheo__pairs *pairs, uint32_t i)
{
    return (size_t)pairs->start[i / pairs->width] * pairs->width + i % pairs->width;
}
static inline size_t rheo__pairs_end(const rheo__pairs *pairs, uint32_t i)
{
    return (size_t)pairs->start[i / pairs->width + 1] * pairs->width;
}
/* The rank that idle entries have as their partner. */
static inline uint32_t rheo__pairs_idle(const rheo__pairs *pairs)
{
    return pairs->blocks * pairs->width;
}
/* Rank of the partner of an entry; of an image, its own. */
static inline uint32_t rheo__pairs_place(const rheo__pairs *pairs, size_t entry)
{
    return pairs->width > 1 ? pairs->partner[entry] / RHEO__POINT_VALUES : pairs->partner[entry];
}
/* Rank of the partner of an entry; of an image, that of its particle. */
static inline uint32_t rheo__pairs_partner(const rheo__pairs *pairs, size_t entry)
{
    const uint32_t place = rheo__pairs_place(pairs, entry), idle = rheo__pairs_idle(pairs);
    return place <= idle ? place : pairs->image[place - idle - 1].home;
}
/* Sets the layout of a list of this many rows. */
static inline void rheo__pairs_shape(rheo__pairs *pairs, uint32_t rows, uint32_t width)
{
    pairs->rows = rows;
    pairs->images = 0;
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
        if (rheo__pairs_partner(&(springs)->pairs, k) > (i) && (springs)->rest_length[k] >= 0)

bool rheo__pairs_reserve_rows(rheo__pairs *pairs, const rheo_allocator *allocator, uint32_t rows);
/* Makes room for `count` partners and keeps the first `kept`. False: no memory. */
bool rheo__pairs_reserve(rheo__pairs *pairs, const rheo_allocator *allocator, size_t count, size_t kept);
/* Makes room for this many images and sets their number. False: no memory. */
bool rheo__pairs_reserve_images(rheo__pairs *pairs, const rheo_allocator *allocator, uint32_t images);
/* Replaces partners that are images by their particles: such rows have pairs, but no distances. */
void rheo__pairs_forget_images(rheo__pairs *pairs);
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

/* The pairs of a list, by smaller, then larger id. It holds as long as the list does. */
typedef struct rheo__ordered_pair {
    uint64_t ends; /* the smaller id in the upper half, the larger in the lower */
    uint32_t entry;
} rheo__ordered_pair;

typedef struct rheo__spring_order {
    rheo__ordered_pair *pair;
    size_t count, capacity;
} rheo__spring_order;

bool rheo__spring_order_make(rheo__spring_order *order, const rheo__springs *springs,
                             const rheo_allocator *allocator);
void rheo__spring_order_release(rheo__spring_order *order, const rheo_allocator *allocator);
/* rheo__springs_read() with the order of the present list. */
void rheo__springs_read_in(const rheo__springs *springs, const rheo__spring_order *order, uint32_t *ends,
                           rheo_real *rest_length);

/* Index of an entry of the spring between two ids; SIZE_MAX if there is none. */
size_t rheo__springs_find(const rheo__springs *springs, uint32_t a, uint32_t b);

#endif
