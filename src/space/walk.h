/*
 * Walking the lines of one group side by side, one in each lane of several vectors. They share no particle, so any
 * number of walkers gives the result of the plain loop
 *
 *     for each line, for each row i of it, for each partner j of i, ascending
 *
 * and what one row waits for (sums, square roots) is filled with the work of the others. Each round takes one row of
 * each walker's line; a walker whose line has ended takes the group's next one. Rows of a round differ in length: as
 * long as all of them go on (k < shortest) nothing is masked.
 */
#ifndef RHEO_SPACE_WALK_H
#define RHEO_SPACE_WALK_H

#include "core/lanes.h"
#include "space/neighbours.h"

#ifndef RHEO_VECTORS
#error "RHEO_VECTORS is set for each target that kernels are built for"
#endif
enum { RHEO_WALKERS = RHEO_LANES * RHEO_VECTORS };

/* For each vector of a round. Unrolled, or what belongs to a vector would lie in memory instead of registers. */
#define RHEO_EACH_VECTOR(n) _Pragma("GCC unroll 8") for (int n = 0; n < RHEO_VECTORS; n++)

typedef struct rheo_walk {
    const rheo_line *next, *end;
    uint32_t row[RHEO_WALKERS]; /* the row of each walker in this round; `idle` if it has none */
    uint32_t last[RHEO_WALKERS];
    uint32_t idle; /* a rank that no particle has: see rheo_gather() */
    /* The rows of this round. */
    uint32_t first[RHEO_WALKERS]; /* place of the first partner */
    uint32_t reach[RHEO_WALKERS]; /* from it to the last */
    rheo_lane_index length[RHEO_WALKERS];
    uint32_t shortest;              /* of all */
    uint32_t longest[RHEO_VECTORS]; /* of each vector */
} rheo_walk;

static inline rheo_walk rheo_walk_group(const rheo_neighbours *list, uint32_t group, uint32_t rows)
{
    rheo_walk walk = {.next = list->line + list->group_start[group],
                      .end = list->line + list->group_start[group + 1],
                      .idle = rows};
    for (int walker = 0; walker < RHEO_WALKERS; walker++)
        walk.row[walker] = rows;
    return walk;
}

/* The next round, over rows that start at these places (rows + 1 of them); false when the group is done. */
static inline bool rheo_walk_on(rheo_walk *walk, const uint32_t *start)
{
    bool any = false;
    walk->shortest = UINT32_MAX;
    RHEO_EACH_VECTOR (n)
        walk->longest[n] = 0;
    for (int walker = 0; walker < RHEO_WALKERS; walker++) {
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
        walk->length[walker] = (rheo_lane_index)length;
        walk->first[walker] = length ? start[row] : start[walk->idle]; /* behind all rows */
        walk->reach[walker] = length ? length - 1 : 0;
        uint32_t *longest = &walk->longest[walker / RHEO_LANES];
        *longest = length > *longest ? length : *longest;
        walk->shortest = length < walk->shortest ? length : walk->shortest;
        any = any || row != walk->idle;
    }
    return any;
}

/*
 * The k-th partners of the rows in one vector. A lane whose row has ended gets its row's last partner once more,
 * which no other lane can touch: it may be written back as it is. A row without any gets `idle`, which the lists hold
 * behind their last row.
 */
typedef struct rheo_walk_pairs {
    uint32_t place[RHEO_LANES];
    uint32_t partner[RHEO_LANES];
    rheo_mask active; /* looked at only where not all are */
} rheo_walk_pairs;

/* all: every walker has a k-th partner. */
static inline void rheo_walk_take(const rheo_walk *walk, int vector, uint32_t k, const uint32_t *partner, bool all,
                                  rheo_walk_pairs *pairs)
{
    rheo_ranks first, reach;
    memcpy(&first, walk->first + vector * RHEO_LANES, sizeof first);
    if (all) {
        first += k;
    } else {
        memcpy(&reach, walk->reach + vector * RHEO_LANES, sizeof reach);
        first += rheo_ranks_min(reach, k);
        rheo_mask lengths;
        memcpy(&lengths, walk->length + vector * RHEO_LANES, sizeof lengths);
        pairs->active = lengths > (rheo_lane_index)k;
    }
    memcpy(pairs->place, &first, sizeof pairs->place);
    for (int lane = 0; lane < RHEO_LANES; lane++)
        pairs->partner[lane] = partner[pairs->place[lane]];
}

/* The most partners that a row of this round has. */
static inline uint32_t rheo_walk_longest(const rheo_walk *walk)
{
    uint32_t longest = 0;
    RHEO_EACH_VECTOR (n)
        longest = walk->longest[n] > longest ? walk->longest[n] : longest;
    return longest;
}

/*
 * Asks for what lies at the places of the rows to come: in a large space so many lines at once are more streams than
 * a processor follows by itself.
 */
static inline void rheo_walk_prefetch(const rheo_walk *walk, const void *values, size_t size)
{
    enum { PLACES_AHEAD = 48 };
    for (int walker = 0; walker < RHEO_WALKERS; walker++)
        __builtin_prefetch((const char *)values + (walk->first[walker] + (size_t)PLACES_AHEAD) * size);
}

/* The rows of one vector. */
static inline const uint32_t *rheo_walk_rows(const rheo_walk *walk, int vector)
{
    return walk->row + vector * RHEO_LANES;
}

#endif
