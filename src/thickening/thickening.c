/* Weights and memory of the thickening model (thickening/thickening.h). */
#include "thickening/thickening.h"

#include <string.h>

#include "core/math.h"
#include "thickening/continuum.h"

static bool has_weights(const rheo__thickening *t, const rheo_world_def *def, uint32_t window, uint32_t rows)
{
    return t->weight && t->window == window && rows <= t->weight_rows && t->weight_kind == def->history.weights &&
           t->weight_order == def->history.order;
}

/* The exact weights of lags 0 to count - 1, and those of the very first sample. */
static void compute_weights(const rheo_world_def *def, size_t count, double *weight, double *first)
{
    const double order = def->history.order;
    if (def->history.curve_count) {
        rheo_history_curve_weights(def->history.curve, def->history.curve_count, def->step, count, weight, first);
        return;
    }
    if (def->history.weights == RHEO_WEIGHTS_PAPER)
        rheo_history_weights(order, count, weight);
    else
        rheo_history_weights_l1(order, count, weight);
    for (size_t lag = 0; lag < count; lag++)
        first[lag] = def->history.weights == RHEO_WEIGHTS_PAPER ? rheo_history_first_weight(order, lag) : weight[lag];
}

/*
 * Makes the weights of `rows` lags and of the steps that are summed ahead. Beyond the window they are 0, so adding a
 * row that has left it has no effect. Curve and step of a curve are fixed.
 */
static bool make_weights(rheo__thickening *t, const rheo_world_def *def, uint32_t window, uint32_t rows)
{
    if (has_weights(t, def, window, rows))
        return true;
    size_t all = (size_t)window + 1, wanted = (size_t)rows + RHEO__STEPS_AHEAD, count = wanted < all ? wanted : all;
    double *exact = rheo__allocate(&t->allocator, count, 2 * sizeof *exact), *exact_first = exact + count;
    rheo_real *weight = rheo__allocate(&t->allocator, count + 2 * RHEO__STEPS_AHEAD, sizeof *weight);
    rheo_real *first = rheo__allocate(&t->allocator, count + 2 * RHEO__STEPS_AHEAD, sizeof *first);
    if (!exact || !weight || !first) {
        rheo__release(&t->allocator, exact);
        rheo__release(&t->allocator, weight);
        rheo__release(&t->allocator, first);
        return false;
    }
    compute_weights(def, count, exact, exact_first);
    for (size_t lag = 0; lag < count; lag++) {
        weight[lag] = (rheo_real)exact[lag];
        first[lag] = (rheo_real)exact_first[lag];
    }
    /* The oldest row of a full window is an interior one. */
    if (count > window)
        first[window] = weight[window];
    rheo__release(&t->allocator, exact);
    rheo__release(&t->allocator, t->weight);
    rheo__release(&t->allocator, t->first_weight);
    t->weight = weight;
    t->first_weight = first;
    t->window = window;
    t->weight_rows = rows;
    t->weight_order = def->history.order;
    t->weight_kind = def->history.weights;
    t->ahead.valid = false;
    return true;
}

/* ---- Memories of modes ---- */

/* Modes that lose less than this in a step also store their rounding errors. Double has enough digits. */
static const double SLOW = RHEO_DOUBLE ? 0 : 2.5e-4;

/* Fits the modes of a definition. Returns the number of slow ones. */
static uint32_t fit(const rheo_world_def *def, uint32_t window, rheo_history_modes *modes)
{
    /* The arguments are in range: it cannot fail. */
    rheo_history_fit_kind(def->history.kind, def->history.order, window, def->history.weights, modes);
    uint32_t slow = 0;
    while (slow < modes->count && 1 - rheo__exp(-modes->rate[slow]) < SLOW)
        slow++;
    return slow;
}

/*
 * Without a window, velocities wait in the ring until they are old enough. One more row tells that a velocity has
 * entered the modes, so the next one is not the very first.
 */
uint32_t rheo__ring_rows(const rheo_world_def *def)
{
    const bool window = def->history.kind == RHEO_HISTORY_WINDOW || def->history.kind == RHEO_HISTORY_WINDOW_FAST;
    const bool lengths = rheo__history_of_lengths(def); /* one more position than steps between them */
    return def->history.lag + (window ? def->history.window + 1 : 2) + lengths;
}

uint32_t rheo__mode_rows(const rheo_world_def *def)
{
    rheo_history_modes modes;
    if (def->history.kind == RHEO_HISTORY_WINDOW)
        return 0;
    uint32_t slow = fit(def, def->history.window, &modes);
    return (def->history.kind != RHEO_HISTORY_WINDOW_FAST && !def->history.lag) + modes.count + slow;
}

static void make_modes(rheo__thickening *t, const rheo_world_def *def, uint32_t window)
{
    rheo_history_modes fitted;
    t->modes.slow = fit(def, window, &fitted);
    t->modes.count = fitted.count;
    t->modes.window = def->history.kind == RHEO_HISTORY_WINDOW_FAST ? window : 0;
    for (uint32_t k = 0; k < fitted.count; k++) {
        const double rate = fitted.rate[k];
        t->modes.decay[k] = (rheo_real)(1 - rheo__exp(-rate));
        t->modes.weight[k] = (rheo_real)fitted.weight[k];
        t->modes.first[k] = (rheo_real)fitted.first[k];
        t->modes.leaving[k] = (rheo_real)-rheo__exp(-rate * window);
        t->modes.filling[k] = (rheo_real)((1 - fitted.first[k]) * rheo__exp(-rate * (window - 1.0)));
    }
}

void rheo__modes_remake(rheo__state *s, const rheo__thickening *t)
{
    const uint32_t rows = (uint32_t)rheo__old_rows(t, *s->history_rows), first = t->def->history.lag;
    const bool full = rows == t->modes.window + 1;
    for (size_t value = 0; value < 3 * (size_t)s->particles; value++)
        for (uint32_t k = 0; k < t->modes.count; k++) {
            /*
             * Summed in double. Rounding to rheo_real comes last, and the error of it goes to the second row of slow
             * modes.
             */
            double y = 0;
            for (uint32_t lag = rows; lag-- > 1;) {
                double enters = lag == rows - 1 && !full ? (double)t->modes.first[k] : 1;
                y += -(double)t->modes.decay[k] * y + enters * (double)rheo__ring_value(&s->ring, first + lag, value);
            }
            const size_t block = value / RHEO__RING_BLOCK, inside = value % RHEO__RING_BLOCK;
            const rheo_real sum = (rheo_real)y;
            rheo__ring_block(&s->modes, block, rheo__mode_slot(s, k))[inside] = sum;
            if (k < t->modes.slow)
                rheo__ring_block(&s->modes, block, rheo__mode_slot(s, t->modes.count + k))[inside] =
                    (rheo_real)(y - (double)sum);
        }
}

/* ---- Configuration and memory ---- */

bool rheo__thickening_remember(rheo__thickening *t, rheo__state *s, uint64_t rows)
{
    if (s->ring.length == 0)
        return true;
    return rheo__ring_reserve_rows(&s->ring, &s->allocator, (uint32_t)rows) &&
           (t->def->history.kind != RHEO_HISTORY_WINDOW || rheo__history_of_lengths(t->def) ||
            make_weights(t, t->def, t->window, s->ring.rows));
}

bool rheo__thickening_configure(rheo__thickening *t, const rheo_world_def *def, uint32_t window, uint32_t rows)
{
    const bool lengths = rheo__history_of_lengths(def);
    if (window && lengths && !rheo__samples_make(&t->samples, &t->allocator, def, window))
        return false;
    if (window && !lengths && def->history.kind == RHEO_HISTORY_WINDOW && !make_weights(t, def, window, rows))
        return false;
    t->def = def;
    rheo__materials_make(t->material, def);
    t->substep = (rheo_real)def->step;
    for (uint32_t ball = 0; ball <= def->balls.count; ball++)
        t->ball_mass[ball] = (rheo_real)rheo__ball_mass(def, ball);
    rheo__wetting_make(t);
    if (window && def->history.kind != RHEO_HISTORY_WINDOW)
        make_modes(t, def, window);
    if (window)
        t->derivative_scale = def->history.curve_count ? 1
                                                       : (rheo_real)rheo_history_scale(def->history.order, def->step,
                                                                                       def->history.weights);
    return true;
}

bool rheo__thickening_reserve(rheo__thickening *t, uint32_t particles)
{
    /* Along a periodic axis a particle is near one of the borders at most: see check_space() in world/check_thickening.c. */
    const size_t images = ((size_t)particles << t->period->axes) - particles;
    /* Room for one more block: its idle rows, and the idle point of rheo__gather(). */
    if (particles + images + (size_t)RHEO__BLOCK_ROWS <= t->particle_capacity)
        return true;
    const bool rows = t->def->scheme != RHEO_SCHEME_SEQUENTIAL, hard = t->springs || t->history;
    const struct {
        rheo__point **at;
        bool needed;
    } points[] = {{&t->derivative, t->history}, {&t->derivative_before, rows}, {&t->pressure_acceleration, rows}};
    const struct {
        rheo_real **at;
        bool needed;
    } reals[] = {{&t->density, true}, {&t->stiffness_sum, rows && hard}, {&t->wall_friction, t->sticking}};
    enum { POINTS = sizeof points / sizeof *points, REALS = sizeof reals / sizeof *reals };
    size_t numbers = 8; /* of t->point, or of position and velocity */
    for (int i = 0; i < POINTS; i++)
        numbers += points[i].needed ? 4 : 0;
    for (int i = 0; i < REALS; i++)
        numbers += reals[i].needed;
    const size_t more = t->workspace ? particles / 4 : 0, blocks = (particles + images + more) / RHEO__BLOCK_ROWS + 2,
                 wanted = blocks * RHEO__BLOCK_ROWS;
    rheo_real *workspace = rheo__allocate(&t->allocator, wanted, numbers * sizeof *workspace);
    rheo__place *place = t->springs ? rheo__allocate(&t->allocator, wanted, sizeof *place) : NULL;
    rheo_real *carried = t->springs ? rheo__allocate(&t->allocator, wanted, sizeof *carried) : NULL;
    const bool enough = workspace && (!t->springs || (place && carried));
    rheo__release(&t->allocator, enough ? t->workspace : workspace);
    rheo__release(&t->allocator, enough ? t->place : place);
    rheo__release(&t->allocator, enough ? t->carried : carried);
    if (!enough)
        return false;
    t->workspace = workspace;
    t->place = place;
    t->rank_before = (uint32_t *)(void *)place; /* a scheme uses one of them */
    t->carried = carried;
    t->particle_capacity = wanted;
    /* No scheme has use for both. */
    t->point = (rheo__wide_point *)(void *)workspace;
    t->position = (rheo__point *)(void *)workspace;
    t->velocity = t->position + wanted;
    workspace += 8 * wanted;
    for (int i = 0; i < POINTS; i++)
        if (points[i].needed) {
            *points[i].at = (rheo__point *)(void *)workspace;
            workspace += 4 * wanted;
        }
    t->spring_acceleration = t->derivative_before; /* after the last use of the latter */
    for (int i = 0; i < REALS; i++)
        if (reals[i].needed) {
            *reals[i].at = workspace;
            workspace += wanted;
        }
    t->multiplier = t->stiffness_sum; /* no scheme has both */
    return true;
}

void rheo__thickening_release(rheo__thickening *t)
{
    void *arrays[] = {t->weight,    t->first_weight,   t->workspace,     t->place,
                      t->carried,   t->pair_stiffness, t->wet,           t->round,
                      t->ahead.sum, t->ahead.pushed,   t->samples.point, t->pair_derivative};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        rheo__release(&t->allocator, arrays[i]);
    rheo__neighbours_release(&t->list, &t->allocator);
    rheo__pairs_release(&t->found_pairs, &t->allocator);
}

void rheo__derivatives(const rheo__state *s, const rheo__thickening *t, rheo_real *derivative)
{
    for (uint32_t id = 0; id < s->particles; id++)
        rheo__particle_derivative(s, t, id, derivative + 3 * (size_t)id);
}

/* Sums in the order of fractional_derivative_modes.c. */
static void derivative_of_modes(const rheo__state *s, const rheo__thickening *t, uint32_t id, rheo_real d[3])
{
    for (size_t axis = 0; axis < 3; axis++) {
        const size_t value = 3 * (size_t)id + axis, block = value / RHEO__RING_BLOCK,
                     inside = value % RHEO__RING_BLOCK;
        rheo_real sum = 0;
        for (uint32_t k = 0; k < t->modes.count; k++)
            sum += t->modes.weight[k] * rheo__ring_block(&s->modes, block, rheo__mode_slot(s, k))[inside];
        const bool any = rheo__old_rows(t, *s->history_rows) > 0;
        d[axis] = any ? t->derivative_scale * (rheo__newest_velocities(s, t, block)[inside] + sum) : 0;
    }
}

void rheo__particle_derivative(const rheo__state *s, const rheo__thickening *t, uint32_t id, rheo_real d[3])
{
    if (t->def->history.kind != RHEO_HISTORY_WINDOW) {
        derivative_of_modes(s, t, id, d);
        return;
    }
    const uint32_t rows = (uint32_t)rheo__old_rows(t, *s->history_rows), first = t->def->history.lag;
    for (size_t axis = 0; axis < 3; axis++) {
        rheo_real sum = 0;
        for (uint32_t lag = rows; lag-- > 0;)
            sum += (lag == rows - 1 ? t->first_weight : t->weight)[lag] *
                   rheo__ring_value(&s->ring, first + lag, 3 * (size_t)id + axis);
        d[axis] = t->derivative_scale * sum;
    }
}
