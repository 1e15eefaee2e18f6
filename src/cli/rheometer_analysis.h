/*
 * What `rheolog rheometer` makes of measured signals: harmonics, loops, steadiness, fits of lines and of flow curves. No
 * function here knows where a signal comes from. Each says why it gives no number, instead of giving a wrong one.
 */
#ifndef CLI_RHEOMETER_ANALYSIS_H
#define CLI_RHEOMETER_ANALYSIS_H

#include <stdbool.h>
#include <stddef.h>

/*
 * A strain amplitude sin(2 pi phase) that is sampled in windows of whole periods. If `periods` and `samples` have no common
 * divisor, no two samples of a window have the same phase.
 */
typedef struct cli_oscillation {
    double amplitude;
    size_t samples, periods; /* of one window */
    double first;            /* phase of the first sample, in turns */
} cli_oscillation;

/* Stress at that strain, in the unit of the stress. */
typedef struct cli_harmonics {
    double storage, loss; /* G', G'' of the first harmonic */
    double first, third;  /* amplitudes I1, I3 of the stress */
    double drift;         /* change of the first harmonic from the window before, as a part of it */
    double area;          /* of the loop of stress over strain: work of one period */
} cli_harmonics;

/*
 * Harmonics of the last window, by projection on sines and cosines. NULL, or why there are none: fewer than two windows, fewer
 * than 8 samples in a period, a value that is not finite, or a drift above the tolerance.
 */
const char *cli_harmonics_of(const double *stress, size_t count, const cli_oscillation *oscillation, double tolerance,
                             cli_harmonics *harmonics);

/* Number of samples near `wanted` that has no common divisor with the number of periods. */
size_t cli_coprime(size_t wanted, size_t periods);

/*
 * Mean of the last window if it differs from the mean of the window before it by at most the tolerance times the larger of its
 * size and `scale`. NULL, or why it is not steady. The mean is set in any case in which there is one.
 */
const char *cli_steady_mean(const double *value, size_t count, size_t window, double tolerance, double scale,
                            double *mean);

/* Area between the two ways of a closed loop, integral of y dx along it. 0 for fewer than 3 points. */
double cli_loop_area(const double *x, const double *y, size_t count);

/* y = intercept + slope x by least squares. False: fewer than two different x, or a value that is not finite. */
bool cli_line_fit(const double *x, const double *y, size_t count, double *slope, double *intercept);

/*
 * Time after the first sample at which a falling value has covered all but `left` of the way from its first value to `rest`, by
 * linear interpolation. NaN if it has not.
 */
double cli_decay_time(const double *time, const double *value, size_t count, double rest, double left);

/*
 * stress = yield + consistency rate^exponent (Herschel and Bulkley) by least squares of relative differences, with a yield stress
 * of at least 0. False: fewer than four points, or values that are not positive.
 */
typedef struct cli_flow_law {
    double yield, consistency, exponent;
    double error; /* root mean square of relative differences */
} cli_flow_law;
bool cli_flow_fit(const double *rate, const double *stress, size_t count, cli_flow_law *law);

/* Argument in [low, high] of the least value of a function with one minimum there or several: by a scan, then golden sections. */
double cli_least(double (*value)(double at, const void *data), const void *data, double low, double high);

#endif
