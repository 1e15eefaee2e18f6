/* Experiments with molten objects: all of it, letters, and a drop that solidifies (Paiva et al., Figs. 5 and 6). */
#include "cli/experiment_melting.h"

#include <math.h>

/* ---- Fig. 5: all of it is molten ---- */

enum { HEAD = CLI_MELTING_COLUMNS, BODY, FASTEST };

/* Thickness of what began between two heights, relative to that at the start: rms distance of heights from their mean. */
static double thickness(const cli_melting *m, double low, double high)
{
    double sum[2] = {0, 0}, square[2] = {0, 0}, count = 0;
    for (uint32_t i = 0; i < m->count; i++) {
        const double height[2] = {cli_melting_began_at(m, i, 1), cli_melting_is_at(m, i, 1)};
        if (!(height[0] > low && height[0] < high))
            continue;
        for (int k = 0; k < 2; k++) {
            sum[k] += height[k];
            square[k] += height[k] * height[k];
        }
        count++;
    }
    for (int k = 0; k < 2; k++)
        square[k] = square[k] / count - sum[k] * sum[k] / (count * count);
    return sqrt(square[1] / square[0]);
}

static void observe_all(const rheo_world *world, const cli_trial *run, double *column)
{
    cli_melting m;
    const bool read = cli_melting_observe(world, run, &m, column);
    column[HEAD] = read ? thickness(&m, 0.5, 0.8) : NAN;
    column[BODY] = read ? thickness(&m, 0, 0.5) : NAN;
    column[FASTEST] = cli_metric(world, "max_speed");
    cli_melting_release(&m);
}

static void measure_all(const cli_series *s, double *figure)
{
    figure[0] = cli_at_iteration(s, 20, CLI_TOP);
    figure[1] = cli_at_iteration(s, 550, CLI_TOP);
    figure[2] = cli_at_iteration(s, 780, CLI_TOP);
    figure[3] = cli_at_iteration(s, 1320, CLI_TOP);
    figure[4] = cli_at_iteration(s, 780, HEAD);
    figure[5] = cli_at_iteration(s, 780, BODY);
    figure[6] = cli_at_iteration(s, 1320, BODY);
    figure[7] = 0;
    for (size_t row = 0; row < s->rows; row++)
        figure[7] = fmax(figure[7], s->value[row * s->columns + FASTEST]);
}

const cli_experiment cli_experiment_melting_all = {
    .name = "melting-all",
    .reference = "Paiva et al., Fig. 5",
    .about =
        "a bunny that is all molten sinks from below, so its head keeps its shape longest. A solid one stands if its "
        "yield stress is large enough",
    .scene = "melting-all",
    .set = {"particles=1600"},
    .steps = 150,
    .small_set = {"particles=1000"},
    .small_steps = 170,
    .jitter = 0.01,
    .variant = {{"molten", {NULL}, NULL},
                {"solid, 2.5", {"melting.temperature=0", "melting.time_scale=0.02"}, NULL},
                {"solid, 0.1", {"melting.temperature=0", "melting.time_scale=0.5"}, NULL}},
    .column = {CLI_MELTING_COLUMN,
               {"head", "1", "rms height of what began between 0.5 and 0.8 about its mean, relative to the start"},
               {"body", "1", "the same of what began below 0.5"},
               {"fastest", "L/T", "largest speed of a particle"}},
    .figure =
        {
            {"top_20", "L", "mean height of what began above 0.7, at iteration 20"},
            {"top_550", "L", "at iteration 550"},
            {"top_780", "L", "at iteration 780"},
            {"top_1320", "L", "at iteration 1320"},
            {"head_780", "1", "thickness of what began between 0.5 and 0.8, relative to the start, at iteration 780"},
            {"body_780", "1", "thickness of what began below 0.5"},
            {"body_1320", "1", "the same at iteration 1320"},
            {"fastest", "L/T", "largest speed of a particle in the run"},
        },
    .panels = 6,
    .against_first = true,
    .memory = 1,
    .observe = observe_all,
    .measure = measure_all,
    .claim =
        {
            {"head_780", "molten", CLI_AT_LEAST, .factor = 1.2, .of = "body_780", .of_variant = "molten"},
            {"top_1320", "molten", CLI_AT_MOST, .factor = 0.4, .of = "top_20", .of_variant = "molten"},
            {"top_1320", "solid, 2.5", CLI_AT_LEAST, .factor = 0.95, .of = "top_20", .of_variant = "solid, 2.5"},
            {"top_1320", "solid, 0.1", CLI_AT_MOST, .factor = 0.7, .of = "top_1320", .of_variant = "solid, 2.5"},
            {"fastest", "molten", CLI_AT_MOST, .plus = 2},
        },
};

/* ---- Fig. 6: letters ---- */

enum { ITERATION = CLI_MELTING_COLUMNS, SOLVER };

static void observe_logo(const rheo_world *world, const cli_trial *run, double *column)
{
    cli_melting m;
    cli_melting_observe(world, run, &m, column);
    const double substeps = rheo_world_step_count(world) ? cli_metric(world, "substeps") : NAN;
    column[ITERATION] = rheo_world_definition(world)->step / substeps;
    column[SOLVER] = cli_metric(world, "iterations") / substeps;
    cli_melting_release(&m);
}

static double at_time(const cli_series *s, double time, uint32_t column)
{
    size_t row = 0;
    while (row + 1 < s->rows && s->time[row] < time)
        row++;
    return s->value[row * s->columns + column];
}

static void measure_logo(const cli_series *s, double *figure)
{
    double least = INFINITY, most = 0;
    for (size_t row = 1; row < s->rows; row++) {
        least = fmin(least, s->value[row * s->columns + ITERATION]);
        most = fmax(most, s->value[row * s->columns + ITERATION]);
    }
    figure[0] = s->value[CLI_MELTED];
    figure[1] = cli_at_end(s, CLI_MELTED);
    figure[2] = at_time(s, 0.6, CLI_TOP);
    figure[3] = at_time(s, 1.2, CLI_TOP);
    figure[4] = cli_at_end(s, CLI_TOP);
    figure[5] = cli_at_end(s, CLI_BASE);
    figure[6] = 1e-3 * cli_at_end(s, CLI_ITERATIONS);
    figure[7] = least;
    figure[8] = most;
}

const cli_experiment cli_experiment_melting_logo = {
    .name = "melting-logo",
    .reference = "Paiva et al., Fig. 6",
    .about = "letters that are hot at the top melt onto their cold feet. Shorter time steps show the same",
    .scene = "melting-logo",
    .set = {"particles=1600"},
    .steps = 144,
    .small_set = {"particles=800"},
    .small_steps = 144,
    .jitter = 0.01,
    .variant = {{"adaptive", {NULL}, NULL}, {"half as long", {"melting.courant_number=0.2"}, NULL}},
    .column = {CLI_MELTING_COLUMN,
               {"iteration", "T", "time of an iteration"},
               {"solver", "1", "iterations of the solver of viscosity in it"}},
    .figure =
        {
            {"melted_0", "1", "share that is molten at the start"},
            {"melted", "1", "share at the end"},
            {"top_0.6", "L", "mean height of what began above 0.7, after 0.6 T"},
            {"top_1.2", "L", "after 1.2 T"},
            {"top", "L", "at the end"},
            {"base", "L", "mean way of what began below 0.35"},
            {"iterations", "1e3", "iterations in all"},
            {"shortest", "T", "time of the shortest iteration"},
            {"longest", "T", "time of the longest iteration"},
        },
    .panels = 6,
    .memory = 1,
    .observe = observe_logo,
    .measure = measure_logo,
    .claim =
        {
            {"top_1.2", "adaptive", CLI_AT_MOST, .factor = 0.9, .of = "top_0.6", .of_variant = "adaptive"},
            {"top", "adaptive", CLI_AT_MOST, .plus = 0.5},
            {"base", "adaptive", CLI_AT_MOST, .plus = 0.03},
            {"top", "adaptive", CLI_AT_LEAST, .factor = 0.95, .of = "top", .of_variant = "half as long"},
            {"top", "adaptive", CLI_AT_MOST, .factor = 1.05, .of = "top", .of_variant = "half as long"},
            {"iterations", "half as long", CLI_AT_LEAST, .factor = 1.8, .of = "iterations", .of_variant = "adaptive"},
        },
};

/* ---- A drop that solidifies ---- */

enum { SOLID = CLI_MELTING_COLUMNS, HEIGHT, WIDTH };

/* The drop is what began above 0.4. */
static void observe_drop(const rheo_world *world, const cli_trial *run, double *column)
{
    cli_melting m;
    const bool read = cli_melting_observe(world, run, &m, column);
    double solid = 0, height = 0, square = 0, count = 0;
    for (uint32_t i = 0; read && i < m.count; i++) {
        if (!(cli_melting_began_at(&m, i, 1) > 0.4))
            continue;
        const double x = cli_melting_is_at(&m, i, 0), z = cli_melting_is_at(&m, i, 2);
        solid += cli_melting_temperature(&m, i) <= m.melts_at;
        height += cli_melting_is_at(&m, i, 1);
        square += x * x + z * z;
        count++;
    }
    column[SOLID] = solid / count;
    column[HEIGHT] = height / count;
    column[WIDTH] = sqrt(square / count);
    cli_melting_release(&m);
}

static void measure_drop(const cli_series *s, double *figure)
{
    figure[0] = cli_time_of(s, cli_first_above(s, SOLID, 0.01, 0));
    figure[1] = cli_time_of(s, cli_first_above(s, SOLID, 0.5, 0));
    figure[2] = cli_at_end(s, SOLID);
    figure[3] = cli_at_end(s, HEIGHT);
    figure[4] = cli_at_end(s, WIDTH);
}

const cli_experiment cli_experiment_melting_drop = {
    .name = "melting-drop",
    .reference = "beyond the papers",
    .about =
        "a hot drop falls on a cold block. It cools, solidifies and stays up; without a flow of heat it runs off",
    .scene = "melting-drop",
    .set = {"resolution=0.8"},
    .steps = 400,
    .small_set = {"resolution=0.6"},
    .small_steps = 400,
    .jitter = 0.01,
    .variant = {{"heat flows", {NULL}, NULL}, {"none flows", {"melting.diffusivity=0"}, NULL}},
    .column = {CLI_MELTING_COLUMN,
               {"solid", "1", "share of the drop that is solid"},
               {"height", "L", "mean height of the drop"},
               {"width", "L", "rms distance of the drop from its axis"}},
    .figure =
        {
            {"begins_at", "T", "time at which a hundredth of the drop is solid"},
            {"half_at", "T", "time at which half of it is solid"},
            {"solid", "1", "share that is solid at the end"},
            {"height", "L", "mean height of the drop at the end"},
            {"width", "L", "rms distance of the drop from its axis"},
        },
    .panels = 6,
    .against_first = true,
    .memory = 1,
    .observe = observe_drop,
    .measure = measure_drop,
    .claim =
        {
            {"half_at", "heat flows", CLI_AT_LEAST, .factor = 1, .of = "begins_at", .of_variant = "heat flows"},
            {"solid", "heat flows", CLI_AT_LEAST, .plus = 0.9},
            {"solid", "none flows", CLI_AT_MOST, .plus = 0},
            {"width", "none flows", CLI_AT_LEAST, .factor = 1.2, .of = "width", .of_variant = "heat flows"},
        },
};
