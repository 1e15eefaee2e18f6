/* Measures a ball that falls on a pool, for `rheolog experiments` and `rheolog bench error`. */
#include "cli/fall.h"

#include <math.h>

/* A ball that sinks again by this much has ended its rise; it trembles by less. */
static const double AGAIN = 0.03;

double cli_depth_at(const cli_depths *d, size_t row)
{
    return row < d->rows ? d->depth[row * d->stride] : (double)NAN;
}

static size_t first_deeper(const cli_depths *d, double depth, size_t from)
{
    size_t row = from;
    while (row < d->rows && !(cli_depth_at(d, row) > depth))
        row++;
    return row;
}

double cli_depth_reached(const cli_depths *d, double depth, size_t from)
{
    const size_t row = first_deeper(d, depth, from);
    if (row >= d->rows)
        return (double)INFINITY;
    if (row == 0)
        return 0;
    const double before = cli_depth_at(d, row - 1), share = (depth - before) / (cli_depth_at(d, row) - before);
    return d->time[row - 1] + share * (d->time[row] - d->time[row - 1]);
}

cli_fall cli_fall_of(const cli_depths *d)
{
    cli_fall f = {.contact = first_deeper(d, 0, 0), .contact_at = cli_depth_reached(d, 0, 0)};
    f.dip = f.contact;
    while (f.dip + 1 < d->rows && !(cli_depth_at(d, f.dip + 1) < cli_depth_at(d, f.dip)))
        f.dip++;
    f.sinks = f.dip + 1 >= d->rows; /* to the end, or onto the floor */
    f.top = f.dip;
    size_t row = f.dip;
    for (; row < d->rows && cli_depth_at(d, row) <= cli_depth_at(d, f.top) + AGAIN; row++)
        f.top = cli_depth_at(d, row) < cli_depth_at(d, f.top) ? row : f.top;
    f.again = row < d->rows;
    f.rise = f.sinks ? 0 : cli_depth_at(d, f.dip) - cli_depth_at(d, f.top);
    return f;
}
