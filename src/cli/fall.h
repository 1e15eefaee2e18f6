/* What a ball does that falls on a pool. Depths are those of its lowest point below the surface, in radii. */
#ifndef CLI_FALL_H
#define CLI_FALL_H

#include <stdbool.h>
#include <stddef.h>

/* The depths of a run, from its first state on. */
typedef struct cli_depths {
    size_t rows, stride; /* stride: from one depth to the next */
    const double *depth; /* [row x stride] */
    const double *time;  /* [row] */
} cli_depths;

typedef struct cli_fall {
    size_t contact;    /* first row below the surface; `rows` if there is none */
    double contact_at; /* time of contact, between two steps; infinite without one */
    size_t dip, top;   /* rows of the first dip, and of the least depth before the ball sinks again */
    bool sinks;        /* it has not turned */
    bool again;        /* it has turned, and sinks again */
    double rise;       /* from the dip to the top; 0 if it has not turned */
} cli_fall;

double cli_depth_at(const cli_depths *d, size_t row);
/* Time at which a depth is exceeded for the first time from a row on, between two steps; infinite if it is not. */
double cli_depth_reached(const cli_depths *d, double depth, size_t from);
cli_fall cli_fall_of(const cli_depths *d);

#endif
