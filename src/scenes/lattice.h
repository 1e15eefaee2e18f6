/* The cubic lattice of particles in a shape: points with integer coordinates, one spacing apart. */
#ifndef RHEO__SCENES_LATTICE_H
#define RHEO__SCENES_LATTICE_H

#include <stdbool.h>
#include <stdint.h>

/* Points of the lattice around a shape. */
typedef struct rheo__lattice {
    int64_t low[3], high[3]; /* first and last point along each axis; empty if high < low */
    double origin[3];        /* position of the point (0, 0, 0), L */
} rheo__lattice;

/* Receives the points x, x + 1, ..., end - 1 of the row y, z. Returns false to stop. */
typedef bool rheo__run(void *user, int64_t x, int64_t end, int64_t y, int64_t z);

/* Rounds by conversion to an integer. Exact for numbers far below 2^52. */
static inline int64_t rheo__round_half_up(double x)
{
    const int64_t whole = (int64_t)(x + 0.5);
    return whole - ((double)whole > x + 0.5);
}

static inline int64_t rheo__round_up(double x)
{
    const int64_t whole = (int64_t)x;
    return whole + ((double)whole < x);
}

#endif
