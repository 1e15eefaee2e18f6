/* Signals of the study history: positions, velocities, and their fractional derivatives. */
#include "cli/error_signals.h"

#include <math.h>
#include <stddef.h>

/* ---- Signals ---- */

static const double PI = 3.14159265358979323846;
static const double PERIOD = 3.3, TAU = 3.3;          /* of the sine; of the exponential */
static const double BEGIN = 1, PULSE = .33, PEAK = 5; /* of the impact, Fig. 3 of the paper: rheolog/history.h */
static const double STOP = 6;                         /* of the steady motion, Fig. 4, from BEGIN on */

static double square(double t)
{
    return t * t;
}

static double square_velocity(double t)
{
    return 2 * t;
}

static double square_derivative(double q, double t)
{
    return 2 * pow(t, 2 - q) / tgamma(3 - q);
}

static double cube(double t)
{
    return t * t * t;
}

static double cube_velocity(double t)
{
    return 3 * t * t;
}

static double cube_derivative(double q, double t)
{
    return 6 * pow(t, 3 - q) / tgamma(4 - q);
}

/* From rest: the rules take the first sample for the end of a rest. */
static double sine(double t)
{
    return 1 - cos(2 * PI * t / PERIOD);
}

static double sine_velocity(double t)
{
    return 2 * PI / PERIOD * sin(2 * PI * t / PERIOD);
}

/* From rest as well: exp without its first two powers, which are summed for small t. */
static double exponential(double t)
{
    const double u = t / TAU;
    return u < .01 ? u * u / 2 * (1 + u / 3 * (1 + u / 4 * (1 + u / 5))) : exp(u) - 1 - u;
}

static double exponential_velocity(double t)
{
    return expm1(t / TAU) / TAU;
}

/* Sum over k >= 2 of (t/tau)^k / Gamma(k+1-q), times t^(-q). */
static double exponential_derivative(double q, double t)
{
    if (t == 0)
        return 0;
    double term = t / TAU * (t / TAU) / tgamma(3 - q), sum = 0;
    for (int k = 2; term > 1e-18 * sum; k++) {
        sum += term;
        term *= t / TAU / (k + 1 - q);
    }
    return pow(t, -q) * sum;
}

static double impact_share(double t)
{
    return fmin(fmax((t - BEGIN) / PULSE, 0), 1);
}

static double impact(double t)
{
    const double u = impact_share(t);
    return PEAK * PULSE * (u / 2 - sin(2 * PI * u) / (4 * PI));
}

static double impact_velocity(double t)
{
    const double s = sin(PI * impact_share(t));
    return PEAK * s * s;
}

static double steady(double t)
{
    return fmin(fmax(t - BEGIN, 0), STOP - BEGIN);
}

static double steady_velocity(double t)
{
    return t > BEGIN && t < STOP;
}

static double steady_derivative(double q, double t)
{
    return (pow(fmax(t - BEGIN, 0), 1 - q) - pow(fmax(t - STOP, 0), 1 - q)) / tgamma(2 - q);
}

const cli_signal cli_signal_list[CLI_SIGNALS] = {
    {"t^2", square, square_velocity, square_derivative, {0}},
    {"t^3", cube, cube_velocity, cube_derivative, {0}},
    {"sine", sine, sine_velocity, NULL, {0}},
    {"exp", exponential, exponential_velocity, exponential_derivative, {0}},
    {"impact", impact, impact_velocity, NULL, {1, 1.33, 0}},
    {"steady", steady, steady_velocity, steady_derivative, {1, 6, 0}},
};

/* ---- Quadrature ---- */

/*
 * Integral of v(t-u) u^(-q) from u = a to b. With y = u^(1-q) it is that of v(t - y^(1/(1-q)))/(1-q), whose integrand is finite.
 * The double exponential rule y = A + (B-A) / (1 + exp(-pi sinh s)) has a derivative that falls so fast at both ends that
 * the sum over equal steps of s converges exponentially, even where a power of y begins.
 */
static double integrate(const cli_signal *signal, double q, double t, double a, double b)
{
    const double step = 1. / 24, most = 3.5, power = 1 / (1 - q);
    const double begin = pow(a, 1 - q), length = pow(b, 1 - q) - begin;
    double sum = 0;
    for (int k = -(int)(most / step); k <= (int)(most / step); k++) {
        const double s = k * step, e = exp(-PI * sinh(s)), part = 1 / (1 + e);
        sum += PI * cosh(s) * part * (e * part) * signal->velocity(t - pow(begin + length * part, power));
    }
    return step * length * sum * power;
}

double cli_caputo(const cli_signal *signal, double q, double t)
{
    double sum = 0, end = t; /* of the age u; from the oldest to the newest */
    while (end > 0) {
        /* Pieces end at kinks, and are at most a unit of time long. */
        double begin = end > 1 ? end - 1 : 0;
        for (int k = 0; k < 3; k++)
            if (signal->kink[k] > 0 && t - signal->kink[k] > begin && t - signal->kink[k] < end)
                begin = t - signal->kink[k];
        sum += integrate(signal, q, t, begin, end);
        end = begin;
    }
    return sum / tgamma(1 - q);
}
