/* Values of `rheolog curves`: all of them come from rheolog/history.h. */
#include "cli/curves.h"

#include <math.h>
#include <stdlib.h>

/* ---- Weights ---- */

static void exact_weights(const cli_curves_request *r, double order, uint32_t window, double *value)
{
    (r->weights == RHEO_WEIGHTS_PAPER ? rheo_history_weights : rheo_history_weights_l1)(order, r->count, value);
    for (size_t lag = window; window && ++lag < r->count;)
        value[lag] = 0;
}

static void fitted_weights(const cli_curves_request *r, const struct cli_curves_memory *memory,
                           const rheo_history_modes *modes, double *value)
{
    for (size_t lag = 0; lag < r->count; lag++)
        value[lag] = memory->kind == RHEO_HISTORY_WINDOW_FAST && lag > memory->window
                         ? 0
                         : rheo_history_modes_weight(modes, lag);
}

double cli_curves_first_weight(const cli_curve_set *curves, const cli_curve *curve, size_t lag)
{
    const struct cli_curves_memory *m = curve->memory;
    const bool known = curves->request->weights == RHEO_WEIGHTS_PAPER && m->kind == RHEO_HISTORY_WINDOW;
    /* From step d on, the oldest sample in the window is an interior one. */
    return known && (m->window == 0 || lag < m->window) ? rheo_history_first_weight(curve->order, lag) : NAN;
}

double cli_curves_sum(const cli_curve_set *curves, const cli_curve *curve, size_t lag)
{
    double sum = 0;
    for (size_t i = lag + 1; i-- > 0;) /* the smallest first */
        sum += curve->value[i];
    return sum * rheo_history_scale(curve->order, curves->request->step, curves->request->weights);
}

/* ---- Signals ---- */

static rheo_result exact_derivative(const cli_curve_set *c, double order, uint32_t window, double *value)
{
    const cli_curves_request *r = c->request;
    return rheo_fractional_derivative(c->velocity, r->count, order, r->step, window, r->weights, value);
}

static rheo_result fitted_derivative(const cli_curve_set *c, double order, const struct cli_curves_memory *memory,
                                     const rheo_history_modes *modes, double *value)
{
    const cli_curves_request *r = c->request;
    return rheo_fractional_derivative_by_modes(c->velocity, r->count, modes, order, r->step,
                                               memory->kind == RHEO_HISTORY_WINDOW_FAST ? memory->window : 0,
                                               r->weights, value);
}

/* ---- Curves ---- */

static rheo_result exact_values(const cli_curve_set *c, double order, uint32_t window, double *value)
{
    if (!c->request->of_weights)
        return exact_derivative(c, order, window, value);
    exact_weights(c->request, order, window, value);
    return RHEO_OK;
}

static rheo_result fitted_values(const cli_curve_set *c, cli_curve *curve)
{
    const struct cli_curves_memory *m = curve->memory;
    rheo_history_modes modes;
    const rheo_result result = rheo_history_fit_kind(m->kind, curve->order, m->window, c->request->weights, &modes);
    if (result != RHEO_OK)
        return result;
    curve->fit_error = modes.error;
    if (!c->request->of_weights)
        return fitted_derivative(c, curve->order, m, &modes, curve->value);
    fitted_weights(c->request, m, &modes, curve->value);
    return RHEO_OK;
}

/* The step from which the values stay at or below a level. */
static size_t settles_at(const cli_curve *curve, size_t count, double level)
{
    while (count && curve->value[count - 1] <= level)
        count--;
    return count;
}

static void find_marks(cli_curve *curve, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (curve->value[i] > curve->value[curve->peak_at])
            curve->peak_at = i;
    curve->peak = curve->value[curve->peak_at];
    curve->half_at = settles_at(curve, count, curve->peak / 2);
    curve->hundredth_at = settles_at(curve, count, curve->peak / 100);
}

/* Compares a curve with kind window of the same length. */
static rheo_result compare(const cli_curve_set *c, cli_curve *curve, double *exact)
{
    const size_t count = c->request->count;
    const rheo_result result = exact_values(c, curve->order, curve->memory->window, exact);
    double peak = 0, largest = 0;
    for (size_t i = 0; i < count && result == RHEO_OK; i++) {
        const double difference = fabs(curve->value[i] - fabs(exact[i]));
        peak = fmax(peak, fabs(exact[i]));
        if (difference > largest) {
            largest = difference;
            curve->difference_at = i;
        }
    }
    curve->difference = largest / peak;
    return result;
}

static rheo_result compute_curve(const cli_curve_set *c, cli_curve *curve, double *scratch)
{
    const size_t count = c->request->count;
    curve->fit_error = curve->difference = NAN;
    curve->value = malloc(count * sizeof *curve->value);
    if (!curve->value)
        return RHEO_ERROR_MEMORY;
    const bool exact = curve->memory->kind == RHEO_HISTORY_WINDOW;
    rheo_result result =
        exact ? exact_values(c, curve->order, curve->memory->window, curve->value) : fitted_values(c, curve);
    for (size_t i = 0; i < count && result == RHEO_OK; i++)
        curve->value[i] = fabs(curve->value[i]);
    if (result == RHEO_OK)
        find_marks(curve, count);
    return result == RHEO_OK && !exact ? compare(c, curve, scratch) : result;
}

int cli_curves_compute(const cli_curves_request *r, cli_curve_set *c)
{
    const size_t count = r->orders * r->memories;
    *c = (cli_curve_set){.request = r, .curve = calloc(count, sizeof *c->curve)};
    double *scratch = malloc(r->count * sizeof *scratch);
    if (!r->of_weights)
        c->velocity = malloc(r->count * sizeof *c->velocity);
    rheo_result result = c->curve && scratch && (r->of_weights || c->velocity) ? RHEO_OK : RHEO_ERROR_MEMORY;
    if (result == RHEO_OK && !r->of_weights)
        result = rheo_signal_velocities(r->signal, r->step, r->count, c->velocity);
    for (size_t i = 0; i < count && result == RHEO_OK; i++) {
        cli_curve *curve = &c->curve[c->count++];
        curve->order = r->order[i / r->memories];
        curve->memory = &r->memory[i % r->memories];
        result = compute_curve(c, curve, scratch);
    }
    free(scratch);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &(rheo_error){""});
}

void cli_curves_release(cli_curve_set *c)
{
    for (size_t i = 0; i < c->count; i++)
        free(c->curve[i].value);
    free(c->curve);
    free(c->velocity);
}

const char *cli_curves_word(const char *parameter, uint32_t choice)
{
    return rheo_scene_parameter_find(parameter)->choices[choice];
}
