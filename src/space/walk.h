/*
 * Walking the lines of one colour side by side, one in each lane. They share no particle, so any number of walkers
 * gives the result of the plain loop
 *
 *     for each line, for each row i of it, for each partner j of i, ascending
 *
 * and what one row waits for (sums, square roots) is filled with the work of the others. Each round takes one row of
 * each walker's line; a walker whose line has ended takes the colour's next one.
 */
#ifndef RHEO_SPACE_WALK_H
#define RHEO_SPACE_WALK_H

#include "core/lanes.h"
#include "space/neighbours.h"

typedef struct rheo_walk {
    const rheo_line *next, *end;
    uint32_t row[RHEO_LANES]; /* the row of each walker in this round; `idle` if it has none */
    uint32_t last[RHEO_LANES];
    uint32_t idle; /* a rank that no particle has: see rheo_gather() */
    /* The rows of this round. */
    uint32_t first[RHEO_LANES]; /* place of the first partner */
    rheo_lane_index length[RHEO_LANES];
    uint32_t longest;
} rheo_walk;

static inline rheo_walk rheo_walk_colour(const rheo_neighbours *list, int colour, uint32_t rows)
{
    rheo_walk walk = {.next = list->line + list->colour_start[colour],
                      .end = list->line + list->colour_start[colour + 1],
                      .idle = rows};
    for (int lane = 0; lane < RHEO_LANES; lane++)
        walk.row[lane] = rows;
    return walk;
}

/* The next round, over rows that start at these places (rows + 1 of them); false when the colour is done. */
static inline bool rheo_walk_on(rheo_walk *walk, const uint32_t *start)
{
    bool any = false;
    walk->longest = 0;
    for (int lane = 0; lane < RHEO_LANES; lane++) {
        uint32_t row = walk->row[lane] + 1;
        if (walk->row[lane] == walk->idle || row >= walk->last[lane]) {
            row = walk->idle;
            if (walk->next < walk->end) {
                row = walk->next->first;
                walk->last[lane] = walk->next->end;
                walk->next++;
            }
        }
        walk->row[lane] = row;
        walk->first[lane] = row != walk->idle ? start[row] : 0;
        uint32_t length = row != walk->idle ? start[row + 1] - start[row] : 0;
        walk->length[lane] = (rheo_lane_index)length;
        walk->longest = length > walk->longest ? length : walk->longest;
        any = any || row != walk->idle;
    }
    return any;
}

/* Which lanes have a k-th partner. */
static inline rheo_mask rheo_walk_active(const rheo_walk *walk, uint32_t k)
{
    rheo_mask lengths;
    memcpy(&lengths, walk->length, sizeof lengths);
    return lengths > (rheo_lane_index)k;
}

/* Places of the k-th partners; a lane without one gets some place of its own, to read but not to use. */
static inline void rheo_walk_places(const rheo_walk *walk, uint32_t k, uint32_t place[RHEO_LANES])
{
    for (int lane = 0; lane < RHEO_LANES; lane++)
        place[lane] = walk->first[lane] + ((rheo_lane_index)k < walk->length[lane] ? k : 0);
}

/* The partners at these places; a lane without one gets `idle`. */
static inline void rheo_walk_partners(const rheo_walk *walk, const uint32_t *partner, uint32_t k,
                                      const uint32_t place[RHEO_LANES], uint32_t index[RHEO_LANES])
{
    for (int lane = 0; lane < RHEO_LANES; lane++) {
        uint32_t j = partner[place[lane]];
        index[lane] = (rheo_lane_index)k < walk->length[lane] ? j : walk->idle;
    }
}

static inline rheo_lanes rheo_walk_values(const rheo_real *values, const uint32_t place[RHEO_LANES])
{
    return (rheo_lanes){values[place[0]], values[place[1]], values[place[2]], values[place[3]]};
}

#endif
