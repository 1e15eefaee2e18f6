/*
 * Walks the lines of one group side by side, one in each lane of several vectors. They share no particle, so any
 * number of walkers gives the result of the plain loop
 *
 *     for each line, for each row i of it, for each partner j of i, ascending
 *
 * and the work of other rows fills the latencies of one row (sums, square roots). Each round takes one row of
 * each walker's line; a walker whose line has ended takes the group's next one. Rows of a round differ in length: as
 * long as all of them go on (k < shortest) nothing is masked.
 */
#ifndef RHEO__SPACE_WALK_H
#define RHEO__SPACE_WALK_H

#include "core/lane_points.h"
#include "space/neighbours.h"

#ifndef RHEO__VECTORS
#error "RHEO__VECTORS is set for each SIMD variant"
#endif
enum { RHEO__WALKERS = RHEO__LANES * RHEO__VECTORS };

/* Loop over the vectors of a round. Unrolled, so that the values of a vector stay in registers. */
#define RHEO__EACH_VECTOR(n) _Pragma("GCC unroll 8") for (int n = 0; n < RHEO__VECTORS; n++)

typedef struct rheo__walk {
    const rheo__line *next, *end;
    uint32_t row[RHEO__WALKERS]; /* the row of each walker in this round; `idle` if it has none */
    uint32_t last[RHEO__WALKERS];
    uint32_t idle; /* a rank that no particle has: see rheo__gather() */
    /* The rows of this round. */
    uint32_t first[RHEO__WALKERS]; /* index of the first partner */
    uint32_t reach[RHEO__WALKERS]; /* number of partners after the first */
    rheo__lane_index length[RHEO__WALKERS];
    uint32_t shortest;               /* length of the shortest row */
    uint32_t longest[RHEO__VECTORS]; /* length of the longest row of each vector */
} rheo__walk;

static inline rheo__walk rheo__walk_group(const rheo__neighbours *list, uint32_t group, uint32_t rows)
{
    rheo__walk walk = {.next = list->line + list->group_start[group],
                       .end = list->line + list->group_start[group + 1],
                       .idle = rows};
    for (int walker = 0; walker < RHEO__WALKERS; walker++)
        walk.row[walker] = rows;
    return walk;
}

/* Starts the next round. start: index of the first partner of each row, rows + 1 values. False: the group is done. */
static inline bool rheo__walk_on(rheo__walk *walk, const uint32_t *start)
{
    bool any = false;
    walk->shortest = UINT32_MAX;
    RHEO__EACH_VECTOR (n)
        walk->longest[n] = 0;
    for (int walker = 0; walker < RHEO__WALKERS; walker++) {
        uint32_t row = walk->row[walker] + 1;
        if (walk->row[walker] == walk->idle || row >= walk->last[walker]) {
            row = walk->idle;
            if (walk->next < walk->end) {
                row = walk->next->first;
                walk->last[walker] = walk->next->end;
                walk->next++;
            }
        }
        walk->row[walker] = row;
        uint32_t length = row != walk->idle ? start[row + 1] - start[row] : 0;
        walk->length[walker] = (rheo__lane_index)length;
        walk->first[walker] = length ? start[row] : start[walk->idle]; /* index after all partners */
        walk->reach[walker] = length ? length - 1 : 0;
        uint32_t *longest = &walk->longest[walker / RHEO__LANES];
        *longest = length > *longest ? length : *longest;
        walk->shortest = length < walk->shortest ? length : walk->shortest;
        any = any || row != walk->idle;
    }
    return any;
}

/*
 * The k-th partners of the rows in one vector. A lane whose row has ended gets the row's last partner again; no other
 * lane can touch that partner, so it may be written back unchanged. A row without partners gets `idle`, which the
 * lists contain after their last row.
 */
typedef struct rheo__walk_pairs {
    uint32_t place[RHEO__LANES];
    uint32_t partner[RHEO__LANES];
    rheo__mask active; /* used only if some lanes are not */
} rheo__walk_pairs;

/* all: every walker has a k-th partner. */
static inline void rheo__walk_take(const rheo__walk *walk, int vector, uint32_t k, const uint32_t *partner, bool all,
                                   rheo__walk_pairs *pairs)
{
    rheo__ranks first, reach;
    memcpy(&first, walk->first + vector * RHEO__LANES, sizeof first);
    if (all) {
        first += k;
    } else {
        memcpy(&reach, walk->reach + vector * RHEO__LANES, sizeof reach);
        first += rheo__ranks_min(reach, k);
        rheo__mask lengths;
        memcpy(&lengths, walk->length + vector * RHEO__LANES, sizeof lengths);
        pairs->active = lengths > (rheo__lane_index)k;
    }
    memcpy(pairs->place, &first, sizeof pairs->place);
    for (int lane = 0; lane < RHEO__LANES; lane++)
        pairs->partner[lane] = partner[pairs->place[lane]];
}

/* Largest number of partners of a row in this round. */
static inline uint32_t rheo__walk_longest(const rheo__walk *walk)
{
    uint32_t longest = 0;
    RHEO__EACH_VECTOR (n)
        longest = walk->longest[n] > longest ? walk->longest[n] : longest;
    return longest;
}

/* Prefetches the values of the next rows. In a large space a processor cannot follow this many streams by itself. */
static inline void rheo__walk_prefetch(const rheo__walk *walk, const void *values, size_t size)
{
    enum { PLACES_AHEAD = 48 };
    for (int walker = 0; walker < RHEO__WALKERS; walker++)
        __builtin_prefetch((const char *)values + (walk->first[walker] + (size_t)PLACES_AHEAD) * size);
}

/* Rows of one vector. */
static inline const uint32_t *rheo__walk_rows(const rheo__walk *walk, int vector)
{
    return walk->row + vector * RHEO__LANES;
}

#endif
