/* Finds rows of the series that an experiment measured. */
#include "cli/experiment.h"

#include <math.h>

size_t cli_first_above(const cli_series *series, uint32_t column, double level, size_t from)
{
    size_t row = from;
    while (row < series->rows && !(series->value[row * series->columns + column] > level))
        row++;
    return row;
}

/* The first row after which the column, times `sign`, falls. */
static size_t first_turn(const cli_series *series, uint32_t column, size_t from, double sign)
{
    const double *value = series->value + column;
    size_t row = from;
    while (row + 1 < series->rows &&
           !(sign * value[(row + 1) * series->columns] < sign * value[row * series->columns]))
        row++;
    return row;
}

size_t cli_first_minimum(const cli_series *series, uint32_t column, size_t from)
{
    return first_turn(series, column, from, -1);
}

size_t cli_first_maximum(const cli_series *series, uint32_t column, size_t from)
{
    return first_turn(series, column, from, 1);
}

double cli_time_of(const cli_series *series, size_t row)
{
    return row < series->rows ? series->time[row] : INFINITY;
}
