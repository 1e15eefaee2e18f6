/*
 * A ball hits a pool at speeds over a decade (Pradipto and Hayakawa, "Impact-induced hardening in dense frictional
 * suspensions", 2021: F_max grows as u^1.5 and its time falls as u^-.5 when fast; both do not depend on the depth, the
 * rebound does).
 */
#include "cli/experiment.h"

#include <math.h>

enum { FORCE, FALL, SPEEDS = 8, FITTED = 4 };

/* The force of the fluid in weights of the ball, from the change of its velocity since the last step. */
static void observe_impact(const rheo_world *world, const cli_trial *run, double *column)
{
    const rheo_world_def *def = rheo_world_definition(world);
    rheo_body ball;
    rheo_world_body(world, 0, &ball);
    const double v = ball.velocity[1], g = -def->gravity[1];
    column[FORCE] = rheo_world_step_count(world) ? (v - run->memory[0]) / (def->step * g) + 1 : 0;
    column[FALL] = -v;
    run->memory[0] = v;
}

static double smoothed(const cli_series *s, size_t row)
{
    double sum = 0;
    for (size_t k = row - 2; k <= row + 2; k++)
        sum += s->value[k * s->columns + FORCE];
    return sum / 5;
}

enum { SPEED, F_MAX, T_MAX, REBOUND };

static void measure_impact(const cli_series *s, double *figure)
{
    size_t at = 2;
    figure[SPEED] = s->value[FALL];
    figure[REBOUND] = 0;
    for (size_t row = 2; row + 2 < s->rows; row++) {
        at = smoothed(s, row) > smoothed(s, at) ? row : at;
        figure[REBOUND] = fmax(figure[REBOUND], -s->value[row * s->columns + FALL]);
    }
    /* The vertex of the parabola through the largest value and its neighbours. */
    const double here = smoothed(s, at), before = at > 2 ? smoothed(s, at - 1) : here,
                 after = at + 3 < s->rows ? smoothed(s, at + 1) : here, bend = before - 2 * here + after;
    const double share = bend < 0 ? 0.5 * (before - after) / bend : 0;
    figure[F_MAX] = here;
    figure[T_MAX] = s->time[at] + share * (s->time[1] - s->time[0]);
}

/* The exponent of a figure of speed, by least squares over the last of some variants. */
static double exponent(const cli_result *r, uint32_t seed, uint32_t last, uint32_t figure)
{
    double x = 0, y = 0, xx = 0, xy = 0;
    for (uint32_t v = last - FITTED; v < last; v++) {
        const double a = log(cli_figure_of(r, v, SPEED, seed)), b = log(cli_figure_of(r, v, figure, seed));
        x += a / FITTED;
        y += b / FITTED;
        xx += a * a / FITTED;
        xy += a * b / FITTED;
    }
    return (xy - x * y) / (xx - x * x);
}

static void sum_up(const cli_result *r, uint32_t seed, double *whole)
{
    whole[0] = exponent(r, seed, SPEEDS, F_MAX);
    whole[1] = exponent(r, seed, SPEEDS, T_MAX);
    whole[2] = exponent(r, seed, 2 * SPEEDS, F_MAX);
    whole[3] = exponent(r, seed, 2 * SPEEDS, T_MAX);
}

#define AT(speed, depth, scene)                                                    \
    {                                                                              \
        "u = " speed ", " depth, {"ball.velocity=[0, -" speed ", 0]", NULL}, scene \
    }
#define ALL(depth, scene)                                                                                   \
    AT("4.17", depth, scene), AT("5.79", depth, scene), AT("8.05", depth, scene), AT("11.2", depth, scene), \
        AT("15.5", depth, scene), AT("21.6", depth, scene), AT("30", depth, scene), AT("41.7", depth, scene)

const cli_experiment cli_experiment_impact = {
    .name = "impact",
    .reference = "Pradipto and Hayakawa 2021",
    .about =
        "a ball hits a shallow and a deep pool at eight speeds. The largest force grows as u^1.5, and comes as u^-.5",
    .scene = "impact",
    .steps = 145,
    .small_set = {"resolution=0.7"},
    .small_steps = 145,
    .variant = {ALL("shallow", NULL), ALL("deep", "impact-deep")},
    .column = {{"force", "M g", "force of the fluid on the ball, in weights of the ball"},
               {"speed", "L/T", "velocity of the ball, downwards"}},
    .figure = {{"speed", "L/T", "velocity of the ball at contact"},
               {"F_max", "M g", "largest force on the ball, mean of five steps"},
               {"t_max", "T", "time of the largest force since contact"},
               {"rebound", "L/T", "largest velocity of the ball upwards"}},
    .panels = 3,
    .curve_variants = SPEEDS,
    .memory = 1,
    .observe = observe_impact,
    .measure = measure_impact,
    .whole = {{"F_shallow", "1", "exponent of F_max against speed, of the four fastest in the shallow pool"},
              {"t_shallow", "1", "exponent of t_max there"},
              {"F_deep", "1", "exponent of F_max in the deep pool"},
              {"t_deep", "1", "exponent of t_max there"}},
    .sum_up = sum_up,
    .claim =
        {
            {"F_shallow", NULL, CLI_AT_LEAST, .plus = 1.3},
            {"F_shallow", NULL, CLI_AT_MOST, .plus = 1.7},
            {"t_shallow", NULL, CLI_AT_LEAST, .plus = -0.7},
            {"t_shallow", NULL, CLI_AT_MOST, .plus = -0.3},
            {"rebound", "u = 41.7, deep", CLI_AT_MOST, .factor = 0.9, .of = "rebound",
             .of_variant = "u = 41.7, shallow"},
        },
};
