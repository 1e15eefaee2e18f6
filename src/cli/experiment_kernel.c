/* The kernel of the melting model, and the cost of its scenes (Paiva et al., Fig. 4 and Table 2). */
#include "cli/experiment.h"

#include <math.h>

/* ---- Fig. 4: the kernel, at one distance in every step ---- */

enum { Q, WEIGHT, INSIDE, SAMPLES = 120 };
static const double PI = 3.14159265358979323846;

static void observe_kernel(const rheo_world *world, const cli_trial *run, double *column)
{
    const rheo_world_def *def = rheo_world_definition(world);
    const double h = def->melting.smoothing_length > 0 ? def->melting.smoothing_length : def->fluid.spacing;
    const double apart = 3.0 / SAMPLES, q = apart * (double)rheo_world_step_count(world);
    double *shell = &run->memory[0], *sum = &run->memory[1];
    column[Q] = q;
    column[WEIGHT] = rheo_world_weight(world, q * h) * h * h * h;
    const double now = 4 * PI * q * q * column[WEIGHT];
    *sum += apart * (*shell + now) / 2;
    *shell = now;
    column[INSIDE] = *sum;
}

static void measure_kernel(const cli_series *s, double *figure)
{
    const size_t unit = SAMPLES / 3;
    for (size_t q = 0; q < 4; q++)
        figure[q] = 120 * PI * s->value[q * unit * s->columns + WEIGHT];
    figure[4] = 100 * (s->value[(s->rows - 1) * s->columns + INSIDE] - 1);
    figure[5] = 3.0 / SAMPLES * (double)cli_first_above(s, INSIDE, 0.99, 0);
}

const cli_experiment cli_experiment_kernel = {
    .name = "kernel",
    .reference = "Paiva et al., Fig. 4",
    .about = "the kernel of the melting model. With the constant that is printed its integral is too large by 0.28 %",
    .scene = "melting-box",
    .set = {"resolution=0.4", "melting.flow=frozen"},
    .steps = SAMPLES,
    .small_steps = SAMPLES,
    .variant = {{"exact", {NULL}, NULL}, {"as printed", {"paper.kernel=on"}, NULL}},
    .column = {{"r/h", "1", "distance"},
               {"W h^3", "1", "weight"},
               {"inside", "1", "integral of W up to that distance"}},
    .figure =
        {
            {"W(0)", "1/(120 pi h^3)", "weight at the distance 0"},
            {"W(1)", "1/(120 pi h^3)", "at the distance h"},
            {"W(2)", "1/(120 pi h^3)", "at 2 h"},
            {"W(3)", "1/(120 pi h^3)", "at 3 h"},
            {"excess", "%", "integral of W over space, less 1"},
            {"r_99", "h", "distance within which 99 % of it are"},
        },
    .panels = 2,
    .against_first = true,
    .memory = 2,
    .observe = observe_kernel,
    .measure = measure_kernel,
    .claim =
        {
            {"excess", "exact", CLI_AT_LEAST, .plus = -0.001},
            {"excess", "exact", CLI_AT_MOST, .plus = 0.001},
            {"excess", "as printed", CLI_AT_LEAST, .plus = 0.278},
            {"excess", "as printed", CLI_AT_MOST, .plus = 0.279},
            {"W(0)", "exact", CLI_AT_LEAST, .plus = 65.99},
            {"W(0)", "exact", CLI_AT_MOST, .plus = 66.01},
            {"W(1)", "exact", CLI_AT_LEAST, .plus = 25.99},
            {"W(1)", "exact", CLI_AT_MOST, .plus = 26.01},
        },
};

/* ---- Table 2: what an iteration costs, in counts that do not depend on the machine ---- */

enum { PARTICLES, NEIGHBOURS, ITERATIONS, SOLVER };

static void observe_cost(const rheo_world *world, const cli_trial *run, double *column)
{
    (void)run;
    column[PARTICLES] = rheo_world_particle_count(world);
    column[NEIGHBOURS] = rheo_world_mean_neighbours(world);
    column[ITERATIONS] = rheo_world_step_count(world) ? cli_metric(world, "substeps") : 0;
    column[SOLVER] = rheo_world_step_count(world) ? cli_metric(world, "iterations") : 0;
}

static void measure_cost(const cli_series *s, double *figure)
{
    double sum[SOLVER + 1] = {0};
    for (size_t row = 1; row < s->rows; row++)
        for (uint32_t c = 0; c < s->columns; c++)
            sum[c] += s->value[row * s->columns + c];
    figure[0] = 1e-3 * s->value[PARTICLES];
    figure[1] = sum[NEIGHBOURS] / (double)(s->rows - 1);
    figure[2] = 1e3 * s->time[s->rows - 1] / sum[ITERATIONS];
    figure[3] = sum[SOLVER] / sum[ITERATIONS];
    figure[4] = 1e-3 * figure[0] * figure[1] / 2;
    figure[5] = figure[4] * sum[ITERATIONS] / s->time[s->rows - 1];
}

const cli_experiment cli_experiment_melting_cost = {
    .name = "melting-cost",
    .reference = "Paiva et al., Table 2",
    .about =
        "what an iteration costs in the four scenes of the paper, in counts. Letters have fewer neighbours and longer "
        "iterations than a bunny",
    .scene = "melting-bunny",
    .steps = 10,
    .small_set = {"particles=600"},
    .small_steps = 10,
    .jitter = 0.01,
    .variant = {{"bunny", {NULL}, NULL},
                {"chair", {NULL}, "chair"},
                {"all molten", {NULL}, "melting-all"},
                {"letters", {NULL}, "melting-logo"}},
    .column = {{"particles", "1", "number of particles"},
               {"neighbours", "1", "mean number of neighbours"},
               {"iterations", "1", "substeps of the step"},
               {"solver", "1", "iterations of the solver of viscosity in them"}},
    .figure =
        {
            {"particles", "1e3", "number of particles"},
            {"neighbours", "1", "mean number of neighbours"},
            {"iteration", "T/1000", "mean time of an iteration"},
            {"solver", "1", "iterations of the solver of viscosity in each"},
            {"pairs", "1e6", "pairs of neighbours in an iteration"},
            {"pairs/T", "1e6", "pairs of neighbours in a unit of time"},
        },
    .observe = observe_cost,
    .measure = measure_cost,
    .claim =
        {
            {"neighbours", "letters", CLI_AT_MOST, .factor = 0.9, .of = "neighbours", .of_variant = "bunny"},
            {"neighbours", "all molten", CLI_AT_LEAST, .factor = 1, .of = "neighbours", .of_variant = "letters"},
            {"iteration", "letters", CLI_AT_LEAST, .factor = 1.2, .of = "iteration", .of_variant = "bunny",
             .not_small = true},
            {"pairs/T", "letters", CLI_AT_MOST, .factor = 0.9, .of = "pairs/T", .of_variant = "bunny",
             .not_small = true},
            {"solver", "all molten", CLI_AT_MOST, .factor = 1, .of = "solver", .of_variant = "bunny",
             .not_small = true},
        },
};
