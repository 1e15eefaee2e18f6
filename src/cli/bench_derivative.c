/*
 * Error of the fractional derivative D^q: compares the stage with the plain sum in double over the same velocities.
 * The velocities of some particles are stored at every step.
 */
#include "cli/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 32 };

bool cli_bench_begin_signals(cli_bench_signals *s, const rheo_world *world, size_t steps)
{
    const uint32_t particles = rheo_world_particle_count(world);
    *s = (cli_bench_signals){.particles = particles < SAMPLES ? particles : SAMPLES, .room = steps};
    s->velocity = calloc(steps * 3 * SAMPLES, sizeof *s->velocity);
    return s->velocity != NULL;
}

static uint32_t sample_id(const cli_bench_signals *s, const rheo_world *world, uint32_t sample)
{
    return (uint32_t)((uint64_t)sample * rheo_world_particle_count(world) / s->particles);
}

void cli_bench_take_signals(cli_bench_signals *s, const rheo_world *world)
{
    const rheo_real *velocity = rheo_world_velocities(world);
    for (uint32_t sample = 0; sample < s->particles; sample++)
        for (size_t axis = 0; axis < 3; axis++)
            s->velocity[(sample * (size_t)3 + axis) * s->room + s->steps] =
                (double)velocity[3 * (size_t)sample_id(s, world, sample) + axis];
    s->steps++;
}

/*
 * Computes the weights of lags 0 .. steps - 1 in the plain sum of a history kind, times the factor of the sum. They
 * follow the paper's rule, which all built-in scenes use. False: no such sum is known.
 */
static bool exact_weights(const rheo_world_def *def, const char *kind, size_t all, double *weights)
{
    const size_t waiting = all > def->history.lag ? def->history.lag : all, steps = all - waiting;
    double *weight = weights + waiting;
    memset(weights, 0, waiting * sizeof *weights);

    const double q = def->history.order, scale = rheo_history_scale(q, def->step, RHEO_WEIGHTS_PAPER);
    const bool windowed = strncmp(kind, "window", 6) == 0, tempered = strcmp(kind, "tempered") == 0;
    if ((!windowed && !tempered && strcmp(kind, "full") != 0) || def->history.curve_count)
        return false;
    const double tau = rheo_history_tempering(q, def->history.window);
    rheo_history_weights(q, steps, weight);
    if (steps && (!windowed || steps <= def->history.window)) /* the window contains the very first sample */
        weight[steps - 1] = rheo_history_first_weight(q, steps - 1);
    for (size_t lag = 0; lag < steps; lag++) {
        weight[lag] *= scale;
        if (windowed && lag > def->history.window)
            weight[lag] = 0;
        if (tempered)
            weight[lag] *= exp(-(double)lag / tau);
    }
    return true;
}

double cli_bench_derivative_error(const cli_bench_signals *s, const rheo_world *world, const char *kind)
{
    double *weight = malloc(s->steps * sizeof *weight + 1);
    double largest = 0, error = 0;
    if (!weight || !exact_weights(rheo_world_definition(world), kind, s->steps, weight)) {
        free(weight);
        return NAN;
    }
    for (uint32_t sample = 0; sample < s->particles; sample++) {
        rheo_particle_state state;
        if (rheo_world_particle(world, sample_id(s, world, sample), &state, NULL) != RHEO_OK)
            continue;
        for (size_t axis = 0; axis < 3; axis++) {
            const double *velocity = s->velocity + (sample * (size_t)3 + axis) * s->room;
            double exact = 0;
            for (size_t step = 0; step < s->steps; step++)
                exact += weight[s->steps - 1 - step] * velocity[step];
            largest = fmax(largest, fabs(exact));
            error = fmax(error, fabs(state.derivative[axis] - exact));
        }
    }
    free(weight);
    return largest > 0 ? error / largest : NAN;
}
