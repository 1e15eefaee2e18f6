/* Analysis of the signals of `rheolog rheometer`. */
#include "cli/rheometer_analysis.h"

#include <math.h>

static const double TURN = 6.28318530717958647692; /* 2 pi */

enum { LEAST_SAMPLES = 8 };

/* ---- Oscillations ---- */

/* Amplitudes of the sine and the cosine of a harmonic in a window. */
static void project(const double *stress, const cli_oscillation *o, size_t begin, unsigned harmonic, double part[2])
{
    double sine = 0, cosine = 0;
    for (size_t i = 0; i < o->samples; i++) {
        /* whole turns are taken away exactly, before the sine rounds */
        const double turns = (double)(harmonic * o->periods * (begin + i) % o->samples) / (double)o->samples,
                     angle = TURN * (turns + harmonic * o->first);
        sine += stress[begin + i] * sin(angle);
        cosine += stress[begin + i] * cos(angle);
    }
    part[0] = 2 * sine / (double)o->samples;
    part[1] = 2 * cosine / (double)o->samples;
}

/* The sums round to less than 1e-12 of the modulus. What is below that is 0, so that no digit depends on libm. */
static void drop_rounding(double part[2], double modulus)
{
    for (int i = 0; i < 2; i++)
        if (fabs(part[i]) <= 1e-12 * modulus)
            part[i] = 0;
}

const char *cli_harmonics_of(const double *stress, size_t count, const cli_oscillation *o, double tolerance,
                             cli_harmonics *h)
{
    *h = (cli_harmonics){NAN, NAN, NAN, NAN, NAN, NAN};
    if (o->periods < 1 || o->samples < LEAST_SAMPLES * o->periods)
        return "too few samples: a period needs at least 8";
    if (count < 2 * o->samples)
        return "too few periods: two windows of whole periods are compared";
    for (size_t i = 0; i < count; i++)
        if (!isfinite(stress[i]))
            return "a stress is not finite";
    double before[2], one[2], three[2];
    const size_t last = count - o->samples;
    project(stress, o, last - o->samples, 1, before);
    project(stress, o, last, 1, one);
    project(stress, o, last, 3, three);
    h->first = hypot(one[0], one[1]);
    drop_rounding(one, h->first);
    drop_rounding(three, h->first);
    h->storage = one[0] / o->amplitude;
    h->loss = one[1] / o->amplitude;
    h->third = hypot(three[0], three[1]);
    h->area = TURN / 2 * o->amplitude * one[1];
    h->drift = hypot(one[0] - before[0], one[1] - before[1]) / h->first;
    return h->drift <= tolerance ? NULL : "not steady: the first harmonic still changes from window to window";
}

static size_t common_divisor(size_t a, size_t b)
{
    while (b) {
        const size_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

size_t cli_coprime(size_t wanted, size_t periods)
{
    size_t samples = wanted > 1 ? wanted : 1;
    while (common_divisor(samples, periods) > 1)
        samples++;
    return samples;
}

/* ---- Steady values ---- */

static double mean_of(const double *value, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += value[i];
    return sum / (double)count;
}

const char *cli_steady_mean(const double *value, size_t count, size_t window, double tolerance, double scale,
                            double *mean)
{
    *mean = NAN;
    if (window < 1 || count < window)
        return "too short: less than one window";
    *mean = mean_of(value + count - window, window);
    if (!isfinite(*mean))
        return "a value is not finite";
    if (count < 2 * window)
        return "too short: two windows are compared";
    const double before = mean_of(value + count - 2 * window, window);
    return fabs(*mean - before) <= tolerance * fmax(fabs(*mean), scale) ? NULL : "not steady: the mean still changes";
}

/* ---- Curves ---- */

double cli_loop_area(const double *x, const double *y, size_t count)
{
    double area = 0;
    for (size_t i = 0; count > 2 && i < count; i++) {
        const size_t next = i + 1 < count ? i + 1 : 0;
        area += (x[next] - x[i]) * (y[next] + y[i]) / 2;
    }
    return area;
}

bool cli_line_fit(const double *x, const double *y, size_t count, double *slope, double *intercept)
{
    *slope = *intercept = NAN;
    if (count < 2)
        return false;
    const double middle = mean_of(x, count), level = mean_of(y, count);
    double xx = 0, xy = 0;
    for (size_t i = 0; i < count; i++) {
        xx += (x[i] - middle) * (x[i] - middle);
        xy += (x[i] - middle) * (y[i] - level);
    }
    if (!(xx > 0) || !isfinite(xx) || !isfinite(xy))
        return false;
    *slope = xy / xx;
    *intercept = level - *slope * middle;
    return true;
}

double cli_decay_time(const double *time, const double *value, size_t count, double rest, double left)
{
    const double level = count ? rest + left * (value[0] - rest) : NAN;
    for (size_t i = 1; i < count; i++) {
        const double way = value[i - 1] - value[i];
        if ((value[0] > rest && value[i] <= level) || (value[0] < rest && value[i] >= level))
            return time[i - 1] + (time[i] - time[i - 1]) * (value[i - 1] - level) / way - time[0];
    }
    return NAN;
}

/* ---- Flow curves ---- */

typedef struct flow_data {
    const double *rate, *stress;
    size_t count;
} flow_data;

/* The best yield stress and consistency for an exponent: least squares of relative differences. */
static cli_flow_law with_exponent(double exponent, const flow_data *d)
{
    double aa = 0, ab = 0, bb = 0, a1 = 0, b1 = 0;
    for (size_t i = 0; i < d->count; i++) {
        const double a = 1 / d->stress[i], b = pow(d->rate[i], exponent) / d->stress[i];
        aa += a * a;
        ab += a * b;
        bb += b * b;
        a1 += a;
        b1 += b;
    }
    const double all = aa * bb - ab * ab;
    cli_flow_law law = {(a1 * bb - b1 * ab) / all, (b1 * aa - a1 * ab) / all, exponent, 0};
    if (!(law.yield > 0) || !(all > 1e-12 * aa * bb))
        law = (cli_flow_law){0, b1 / bb, exponent, 0};
    for (size_t i = 0; i < d->count; i++) {
        const double off = (law.yield + law.consistency * pow(d->rate[i], exponent)) / d->stress[i] - 1;
        law.error += off * off;
    }
    law.error = sqrt(law.error / (double)d->count);
    return law;
}

static double error_of_exponent(double exponent, const void *data)
{
    return with_exponent(exponent, data).error;
}

bool cli_flow_fit(const double *rate, const double *stress, size_t count, cli_flow_law *law)
{
    const flow_data data = {rate, stress, count};
    *law = (cli_flow_law){NAN, NAN, NAN, NAN};
    for (size_t i = 0; i < count; i++)
        if (!(rate[i] > 0 && stress[i] > 0 && isfinite(rate[i]) && isfinite(stress[i])))
            return false;
    if (count < 4)
        return false;
    *law = with_exponent(cli_least(error_of_exponent, &data, .05, 4), &data);
    return true;
}

/* ---- Minima ---- */

double cli_least(double (*value)(double at, const void *data), const void *data, double low, double high)
{
    enum { SCAN = 40 };
    const double golden = .6180339887498949, step = (high - low) / SCAN;
    double best = low, least = INFINITY;
    for (int i = 0; i <= SCAN; i++) {
        const double at = low + i * step, found = value(at, data);
        if (found < least) {
            least = found;
            best = at;
        }
    }
    double a = fmax(best - step, low), b = fmin(best + step, high);
    double x = b - golden * (b - a), y = a + golden * (b - a), of_x = value(x, data), of_y = value(y, data);
    for (int i = 0; i < 60 && b - a > 1e-12 * (high - low); i++)
        if (of_x < of_y) {
            b = y;
            y = x;
            of_y = of_x;
            x = b - golden * (b - a);
            of_x = value(x, data);
        } else {
            a = x;
            x = y;
            of_x = of_y;
            y = a + golden * (b - a);
            of_y = value(y, data);
        }
    return (a + b) / 2;
}
