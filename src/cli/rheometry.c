/* Closed forms for `rheolog rheometer` (rheometry.h). */
#include "cli/rheometry.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* ---- Memory ---- */

static uint32_t steps_of(double seconds, uint32_t steps, double step)
{
    return seconds > 0 ? (uint32_t)(seconds / step + .5) : steps;
}

static rheo_result make_weights(const rheo_world_def *def, cli_memory *m)
{
    m->weights = (size_t)m->window + 1;
    m->weight = malloc(m->weights * sizeof *m->weight);
    if (!m->weight)
        return RHEO_ERROR_MEMORY;
    if (m->curve)
        return rheo_history_curve_weights(def->history.curve, def->history.curve_count, m->step, m->weights,
                                          m->weight, NULL);
    (m->rule == RHEO_WEIGHTS_PAPER ? rheo_history_weights : rheo_history_weights_l1)(m->order, m->weights, m->weight);
    return RHEO_OK;
}

rheo_result cli_memory_make(const rheo_world_def *def, rheo_history_kind kind, double order, cli_memory *m)
{
    *m = (cli_memory){.kind = kind, .rule = def->history.weights, .order = order, .step = def->step, .scale = 1};
    m->lag = steps_of(def->history.lag_seconds, def->history.lag, m->step);
    m->curve = def->history.curve_count > 0 && kind == RHEO_HISTORY_WINDOW;
    m->window = m->curve ? rheo_history_curve_window(def->history.curve, def->history.curve_count, m->step)
                         : steps_of(def->history.window_seconds, def->history.window, m->step);
    if (m->window < 1)
        m->window = 1;
    if (!m->curve)
        m->scale = rheo_history_scale(order, m->step, m->rule);
    if (kind == RHEO_HISTORY_WINDOW)
        return make_weights(def, m);
    const rheo_result result = rheo_history_fit_kind(kind, order, m->window, m->rule, &m->modes);
    if (kind != RHEO_HISTORY_WINDOW_FAST)
        m->window = 0;
    return result;
}

void cli_memory_release(cli_memory *m)
{
    free(m->weight);
    m->weight = NULL;
}

typedef struct complex_number {
    double re, im;
} complex_number;

static complex_number times(complex_number a, complex_number b)
{
    return (complex_number){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

static complex_number over(complex_number a, complex_number b)
{
    const double size = b.re * b.re + b.im * b.im;
    return (complex_number){(a.re * b.re + a.im * b.im) / size, (a.im * b.re - a.re * b.im) / size};
}

static complex_number turned(double size, double angle)
{
    return (complex_number){size * cos(angle), size * sin(angle)};
}

void cli_memory_response(const cli_memory *m, double omega, double response[2])
{
    const double angle = -omega * m->step; /* of e^(-i w step) */
    complex_number sum = {0, 0};
    if (m->kind == RHEO_HISTORY_WINDOW)
        for (size_t lag = m->weights; lag-- > 0;) {
            const complex_number one = turned(m->weight[lag], angle * (double)lag);
            sum = (complex_number){sum.re + one.re, sum.im + one.im};
        }
    else {
        sum.re = 1; /* lag 0 */
        for (uint32_t k = 0; k < m->modes.count; k++) {
            /* the sum of e^(-rate (m - 1)) e^(i angle m) from m = 1 to the window, or for ever */
            const complex_number factor = turned(exp(-m->modes.rate[k]), angle),
                                 left = turned(exp(-m->modes.rate[k] * m->window), angle * m->window);
            complex_number from = turned(m->modes.weight[k], angle);
            if (m->window)
                from = times(from, (complex_number){1 - left.re, -left.im});
            const complex_number series = over(from, (complex_number){1 - factor.re, -factor.im});
            sum = (complex_number){sum.re + series.re, sum.im + series.im};
        }
    }
    response[0] = m->scale * sum.re;
    response[1] = m->scale * sum.im;
}

/* A curve has no function of its own in history.h: its weights are summed from the oldest velocity to the newest. */
static void apply_curve(const cli_memory *m, const double *velocity, size_t count, double *derivative)
{
    for (size_t n = 0; n < count; n++) {
        double sum = 0;
        for (size_t lag = n < m->window ? n : m->window; lag > 0; lag--)
            sum += m->weight[lag] * velocity[n - lag];
        derivative[n] = sum + m->weight[0] * velocity[n];
    }
}

rheo_result cli_memory_apply(const cli_memory *m, const double *velocity, size_t count, double *derivative)
{
    rheo_result result = RHEO_OK;
    if (m->curve)
        apply_curve(m, velocity, count, derivative);
    else if (m->kind == RHEO_HISTORY_WINDOW)
        result = rheo_fractional_derivative(velocity, count, m->order, m->step, m->window, m->rule, derivative);
    else
        result = rheo_fractional_derivative_by_modes(velocity, count, &m->modes, m->order, m->step, m->window,
                                                     m->rule, derivative);
    /* A step begins with the velocities up to the end of the step before, less the lag. */
    const size_t late = (size_t)m->lag + 1;
    for (size_t n = count; n-- > 0 && result == RHEO_OK;)
        derivative[n] = n < late ? 0 : derivative[n - late];
    return result;
}

size_t cli_memory_reach(const cli_memory *m)
{
    if (m->window)
        return (size_t)m->window + m->lag + 2;
    return (size_t)(24 / m->modes.rate[0]) + m->lag + 2;
}

/* ---- Springs ---- */

/* Size and phase, against the strain's sine, of n = |size sin(w t + phase)|. */
static void derivative_of(const cli_spring_law *law, double amplitude, double omega, const double response[2],
                          double delay, double *size, double *phase)
{
    *size = law->length * amplitude * omega * hypot(response[0], response[1]);
    *phase = PI / 2 + atan2(response[1], response[0]) - omega * delay;
}

static void finish(double amplitude, double storage, double loss, double third, cli_harmonics *h)
{
    *h =
        (cli_harmonics){storage, loss, amplitude * hypot(storage, loss), third, 0, PI * amplitude * amplitude * loss};
}

void cli_spring_moduli_by_quadrature(const cli_spring_law *law, double amplitude, double omega,
                                     const double response[2], double delay, cli_harmonics *h)
{
    enum { INTERVALS = 1024 }; /* of Simpson's rule over half a period; the integrands are smooth inside it */
    double size, phase, sum[4] = {0, 0, 0, 0};
    derivative_of(law, amplitude, omega, response, delay, &size, &phase);
    for (int i = 0; i <= INTERVALS; i++) {
        /* Smoothstep: the onset bends the stiffness near both ends, so nodes are denser there. */
        const double u = (double)i / INTERVALS, psi = PI * u * u * u * (10 + u * (6 * u - 15)),
                     width = PI * 30 * u * u * (1 - u) * (1 - u);
        const double n = size * fabs(sin(psi)), theta = psi - phase;
        const double stiffness = n > 0 ? law->k_hist * n * n / (n + law->onset) : 0;
        const double weight = (i == 0 || i == INTERVALS ? 1 : i % 2 ? 4 : 2) / 3. / INTERVALS * width;
        const double stress = weight * stiffness * sin(theta) * 2 / PI;
        sum[0] += stress * sin(theta);
        sum[1] += stress * cos(theta);
        sum[2] += stress * sin(3 * theta);
        sum[3] += stress * cos(3 * theta);
    }
    finish(amplitude, law->k_min + sum[0], sum[1], amplitude * hypot(sum[2], sum[3]), h);
}

void cli_spring_moduli(const cli_spring_law *law, double amplitude, double omega, const double response[2],
                       double delay, cli_harmonics *h)
{
    double size, phase;
    if (law->onset > 0) {
        cli_spring_moduli_by_quadrature(law, amplitude, omega, response, delay, h);
        return;
    }
    derivative_of(law, amplitude, omega, response, delay, &size, &phase);
    const double by = law->k_hist * size;
    const complex_number three = {-2 / (3 * PI) * cos(2 * phase) + 2 / (15 * PI) * cos(4 * phase),
                                  -2 / (3 * PI) * sin(2 * phase) + 2 / (15 * PI) * sin(4 * phase)};
    finish(amplitude, law->k_min + by * (2 / PI + 2 / (3 * PI) * cos(2 * phase)), by * 2 / (3 * PI) * sin(2 * phase),
           by * amplitude * hypot(three.re, three.im), h);
}

/* ---- Fit of the parameters ---- */

enum { MOST_POINTS = 256 };

typedef struct fit_data {
    const rheo_world_def *def;
    double length;
    const cli_sweep_point *point;
    size_t count;
    bool (*stop)(void);
    double k_min;                                   /* of the parts of a fit that take it as known */
    double storage[MOST_POINTS], loss[MOST_POINTS]; /* for k_min = 0, k_hist = 1 */
} fit_data;

/* The moduli of all points for an order. */
static void make_moduli(fit_data *d, double order)
{
    cli_memory memory = {0};
    const bool made =
        !(d->stop && d->stop()) && cli_memory_make(d->def, d->def->history.kind, order, &memory) == RHEO_OK;
    const cli_spring_law law = {0, 1, d->def->history.onset, d->length};
    for (size_t i = 0; i < d->count; i++) {
        double response[2] = {NAN, NAN};
        cli_harmonics h;
        if (made && !(d->stop && d->stop()))
            cli_memory_response(&memory, d->point[i].omega, response);
        cli_spring_moduli(&law, d->point[i].amplitude, d->point[i].omega, response, (memory.lag + 1.) * memory.step,
                          &h);
        d->storage[i] = h.storage;
        d->loss[i] = h.loss;
    }
    cli_memory_release(&memory);
}

/* k_min and k_hist by least squares of relative differences of all moduli. Each difference is relative to |G*|. */
static double fit_stiffness(const fit_data *d, double *k_min, double *k_hist)
{
    double aa = 0, ab = 0, bb = 0, a1 = 0, b1 = 0, error = 0;
    for (size_t i = 0; i < d->count; i++) {
        const double size = hypot(d->point[i].storage, d->point[i].loss);
        const double a = 1 / size, b = d->storage[i] / size, c = d->loss[i] / size;
        aa += a * a;
        ab += a * b;
        bb += b * b + c * c;
        a1 += a * d->point[i].storage / size;
        b1 += (b * d->point[i].storage + c * d->point[i].loss) / size;
    }
    const double all = aa * bb - ab * ab;
    *k_min = (a1 * bb - b1 * ab) / all;
    *k_hist = (b1 * aa - a1 * ab) / all;
    for (size_t i = 0; i < d->count; i++) {
        const double size = hypot(d->point[i].storage, d->point[i].loss);
        error += pow((*k_min + *k_hist * d->storage[i] - d->point[i].storage) / size, 2) +
                 pow((*k_hist * d->loss[i] - d->point[i].loss) / size, 2);
    }
    return sqrt(error / (2. * (double)d->count));
}

static double error_of_order(double order, const void *data)
{
    fit_data d = *(const fit_data *)data;
    double k_min, k_hist;
    make_moduli(&d, order);
    return fit_stiffness(&d, &k_min, &k_hist);
}

/* How much k_hist, from G' of each point alone, would differ from frequency to frequency: its relative spread. */
static double spread_of_order(double order, const void *data)
{
    fit_data d = *(const fit_data *)data;
    double sum = 0, squares = 0;
    make_moduli(&d, order);
    for (size_t i = 0; i < d.count; i++) {
        const double k_hist = (d.point[i].storage - d.k_min) / d.storage[i];
        sum += k_hist;
        squares += k_hist * k_hist;
    }
    return squares * (double)d.count / (sum * sum) - 1;
}

static double error_of_loss(double order, const void *data)
{
    fit_data d = *(const fit_data *)data;
    double error = 0;
    make_moduli(&d, order);
    for (size_t i = 0; i < d.count; i++)
        error += pow(d.loss[i] / d.storage[i] - d.point[i].loss / (d.point[i].storage - d.k_min), 2);
    return error;
}

/* Mean slope of ln(G' - k_min) against ln(amplitude) at one frequency each. */
static double amplitude_slope(const fit_data *d)
{
    double sum = 0, x[MOST_POINTS], y[MOST_POINTS];
    size_t lines = 0;
    for (size_t i = 0; i < d->count; i++) {
        size_t count = 0;
        bool seen = false;
        for (size_t k = 0; k < i; k++)
            seen = seen || d->point[k].omega == d->point[i].omega;
        for (size_t k = i; k < d->count && !seen; k++)
            if (d->point[k].omega == d->point[i].omega) {
                x[count] = log(d->point[k].amplitude);
                y[count++] = log(d->point[k].storage - d->k_min);
            }
        double slope, intercept;
        if (!seen && cli_line_fit(x, y, count, &slope, &intercept)) {
            sum += slope;
            lines++;
        }
    }
    return lines ? sum / (double)lines : NAN;
}

static const char *refusal(const cli_sweep_point *point, size_t count)
{
    bool amplitudes = false, frequencies = false;
    if (count < 1 || count > MOST_POINTS)
        return "there are no points, or too many";
    for (size_t i = 0; i < count; i++) {
        if (!(point[i].amplitude > 0 && point[i].omega > 0 && point[i].storage > 0 && isfinite(point[i].storage) &&
              isfinite(point[i].loss)))
            return "a modulus is not known, or not positive";
        amplitudes = amplitudes || point[i].amplitude > 1.01 * point[0].amplitude ||
                     point[i].amplitude < .99 * point[0].amplitude;
        frequencies = frequencies || point[i].omega > 1.01 * point[0].omega || point[i].omega < .99 * point[0].omega;
    }
    if (!amplitudes)
        return "it needs two amplitudes or more: k_min and k_hist differ in how they depend on the amplitude";
    return frequencies ? NULL
                       : "it needs two frequencies or more: the order is in how moduli depend on the frequency";
}

const char *cli_fit_model(const rheo_world_def *def, double length, const cli_sweep_point *point, size_t count,
                          bool (*stop)(void), cli_model_fit *fit)
{
    const double low = .02, high = .98;
    *fit = (cli_model_fit){NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    const char *why = refusal(point, count);
    if (why)
        return why;
    if (def->history.curve_count)
        return "a memory with a curve has no order";
    fit_data d = {.def = def, .length = length, .point = point, .count = count, .stop = stop};
    fit->order = cli_least(error_of_order, &d, low, high);
    make_moduli(&d, fit->order);
    fit->error = fit_stiffness(&d, &fit->k_min, &fit->k_hist);
    double most = 0;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, fit->k_hist * d.storage[i]);
    if (!(most > 1e-3 * fit->k_min) || !isfinite(fit->error))
        return "the moduli do not grow with the amplitude: there is no history in them";
    d.k_min = fit->k_min;
    for (size_t i = 0; i < count; i++)
        if (!(point[i].storage > fit->k_min))
            return "a modulus is below k_min: the points are too noisy";
    fit->amplitude_slope = amplitude_slope(&d);
    fit->order_by_omega = cli_least(spread_of_order, &d, low, high);
    /* G''/(G' - k_min) is largest near q = 0.6 and has each value twice: the search stays on one side. */
    fit->order_by_loss =
        cli_least(error_of_loss, &d, fmax(low, fit->order_by_omega - .15), fmin(high, fit->order_by_omega + .15));
    if (stop && stop())
        return "it was stopped";
    return NULL;
}
