/*
 * Experiments with a ball on a pool (Ozgen et al., Figs. 1, 7, 8, 9 and 13). Depths are those of the lowest point of the
 * ball below the surface, in radii; times of figures are since contact.
 */
#include "cli/experiment.h"

#include <math.h>

#include "cli/fall.h"

enum { DEPTH, X, SPEED, ROLLING };

static void observe(const rheo_world *world, const cli_trial *run, double *column)
{
    rheo_body ball;
    rheo_world_body(world, 0, &ball);
    column[DEPTH] = (run->surface - (ball.position[1] - ball.radius)) / ball.radius;
    column[X] = ball.position[0];
    column[SPEED] = ball.velocity[0];
    column[ROLLING] = -ball.spin[2] * ball.radius;
}

#define COLUMNS                                                                                      \
    {                                                                                                \
        {"depth", "R", "depth of the lowest point of the ball"}, {"x", "L", "position of the ball"}, \
            {"speed", "L/T", "velocity of the ball along x"},                                        \
            {"rolling", "L/T", "speed at which its spin would roll it"},                             \
    }

enum {
    CONTACT,
    DIP_AT,
    DIP,
    TOP_AT,
    RISE,
    ROLLS_AT,
    ROLLS_UNTIL,
    STOPS_AT,
    STOPS_DEPTH,
    WAY,
    HALF_AT,
    SUNK_AT,
    LEFT
};

#define FIGURES                                                                                                \
    {                                                                                                          \
        {"contact", "T", "time of contact since step 0"}, {"dip_at", "T", "time of the first dip"},            \
            {"dip", "R", "depth of the first dip"}, {"top_at", "T", "time at which it is highest after that"}, \
            {"rise", "R", "rise from the first dip until then"},                                               \
            {"rolls_at", "T", "time from which it rolls: its spin is within a tenth of that"},                 \
            {"rolls_until", "T", "time until which it rolls"},                                                 \
            {"stops_at", "T", "time at which the ball stands still"},                                          \
            {"stops_depth", "R", "depth at which it stands still"},                                            \
            {"way", "L", "way from the start to its farthest position"},                                       \
            {"t_1.5R", "T", "time at which 1.5 R is reached"}, {"t_2R", "T", "time at 2 R"},                   \
            {"depth", "R", "depth at the end"},                                                                \
    }

static double at(const cli_series *s, size_t row, uint32_t column)
{
    return row < s->rows ? s->value[row * s->columns + column] : NAN;
}

static void measure(const cli_series *s, double *figure)
{
    const cli_depths depths = {s->rows, s->columns, s->value + DEPTH, s->time};
    const cli_fall f = cli_fall_of(&depths);
    const size_t contact = f.contact;
    const double since = f.contact_at, start = at(s, 0, SPEED);
    figure[CONTACT] = since;
    figure[DIP_AT] = f.sinks ? INFINITY : s->time[f.dip] - since;
    figure[DIP] = at(s, f.dip, DEPTH);
    figure[TOP_AT] = f.sinks ? INFINITY : s->time[f.top] - since;
    figure[RISE] = f.rise;
    figure[ROLLS_AT] = figure[ROLLS_UNTIL] = figure[STOPS_AT] = INFINITY;
    figure[STOPS_DEPTH] = NAN;
    figure[WAY] = 0;
    for (size_t row = contact; row < s->rows; row++) {
        const double speed = at(s, row, SPEED), rolling = at(s, row, ROLLING);
        if (isinf(figure[STOPS_AT]) && speed > 0.05 * start && fabs(rolling - speed) < 0.1 * speed) {
            figure[ROLLS_UNTIL] = s->time[row] - since;
            figure[ROLLS_AT] = fmin(figure[ROLLS_AT], figure[ROLLS_UNTIL]);
        }
        if (isinf(figure[STOPS_AT]) && !(speed > 0)) {
            figure[STOPS_AT] = s->time[row] - since;
            figure[STOPS_DEPTH] = at(s, row, DEPTH);
        }
        figure[WAY] = fmax(figure[WAY], at(s, row, X) - at(s, 0, X));
    }
    figure[HALF_AT] = cli_depth_reached(&depths, 1.5, contact) - since;
    figure[LEFT] = at(s, s->rows - 1, DEPTH);
    figure[SUNK_AT] = cli_depth_reached(&depths, 2, contact) - since;
}

const cli_experiment cli_experiment_ball = {
    .name = "bowling-ball",
    .reference = "Ozgen et al., Figs. 1, 7, 9 and 13",
    .about =
        "a bowling ball is rolled onto a pool of cornstarch and water. It dips in, rises, rolls, stands still and sinks",
    .scene = "bowling-ball",
    .set = {"ball.clearance=16", "ball.velocity=[20, 0, 0]"}, /* it bounces, as in Fig. 13 */
    .steps = 780,
    .small_set = {"resolution=0.6"},
    .small_steps = 780,
    .variant = {{"history", {NULL}, NULL},
                {"none", {"history.stiffness=0"}, NULL},
                {"no sticking", {"walls.sticking=0"}, NULL}},
    .column = COLUMNS,
    .figure = FIGURES,
    .panels = 2,
    .observe = observe,
    .measure = measure,
    .claim =
        {
            {"rise", "history", CLI_AT_LEAST, .plus = 0.1},
            {"top_at", "history", CLI_AT_LEAST, .factor = 1, .of = "dip_at", .of_variant = "history"},
            {"rolls_until", "history", CLI_AT_LEAST, .factor = 1, .of = "dip_at", .of_variant = "history"},
            {"stops_at", "history", CLI_AT_LEAST, .factor = 1, .of = "rolls_until", .of_variant = "history"},
            {"t_1.5R", "history", CLI_AT_LEAST, .factor = 1, .of = "stops_at", .of_variant = "history",
             .or_never = true},
            {"t_2R", "history", CLI_AT_LEAST, .factor = 1, .of = "t_1.5R", .of_variant = "history", .or_never = true},
            {"t_2R", "history", CLI_AT_MOST, .plus = 25, .not_small = true},
            {"rise", "none", CLI_AT_MOST, .plus = 0.06},
            {"t_2R", "none", CLI_AT_MOST, .factor = 0.2, .of = "t_2R", .of_variant = "history"},
        },
};

const cli_experiment cli_experiment_ball_long = {
    .name = "bowling-ball-long",
    .reference = "Ozgen et al., Fig. 8",
    .about = "with q = .2 and a memory of all the past, the fluid carries the ball longer than with d = 250",
    .scene = "bowling-ball-long",
    .steps = 780,
    .small_set = {"resolution=0.6"},
    .small_steps = 780,
    .variant = {{"all, q = .2", {NULL}, NULL}, {"d = 250", {"history.window=250"}, "bowling-ball"}},
    .column = COLUMNS,
    .figure = FIGURES,
    .panels = 1,
    .observe = observe,
    .measure = measure,
    .claim = {{"t_1.5R", "all, q = .2", CLI_AT_LEAST, .factor = 1.5, .of = "t_1.5R", .of_variant = "d = 250",
               .or_never = true},
              {"depth", "all, q = .2", CLI_AT_MOST, .factor = 0.8, .of = "depth", .of_variant = "d = 250"}},
};

/* Times in SI units are 0.11726 = sqrt(.11/8) of those of the other scene, ways 0.01375. */
#define SAME(quantity, factor)                                                            \
    {quantity, "SI", CLI_AT_LEAST, 0, 0.99 * (factor), quantity, "scaled", false, false}, \
    {                                                                                     \
        quantity, "SI", CLI_AT_MOST, 0, 1.01 * (factor), quantity, "scaled", false, false \
    }

const cli_experiment cli_experiment_ball_si = {
    .name = "bowling-ball-si",
    .reference = "beyond the papers",
    .about = "in SI units, with a ball of 11 cm radius, the ball behaves as in the units of the paper",
    .scene = "bowling-ball-si",
    .steps = 660,
    .small_set = {"resolution=0.6"},
    .small_steps = 400,
    .variant = {{"SI", {NULL}, NULL}, {"scaled", {NULL}, "bowling-ball"}},
    .column = COLUMNS,
    .figure = FIGURES,
    .observe = observe,
    .measure = measure,
    .claim = {SAME("dip", 1), SAME("stops_depth", 1), SAME("depth", 1), SAME("stops_at", 0.11726),
              SAME("way", 0.01375)},
};

/* ---- Scheme positions ---- */

static void measure_positions(const cli_series *s, double *figure)
{
    double all[LEFT + 1];
    measure(s, all);
    figure[0] = all[DIP];
    figure[1] = all[RISE];
    figure[2] = all[HALF_AT];
    figure[3] = all[SUNK_AT];
}

#define NO_RISE(variant)                           \
    {                                              \
        "rise", variant, CLI_AT_MOST, .plus = 0.06 \
    }

const cli_experiment cli_experiment_positions = {
    .name = "positions",
    .reference = "Ozgen et al., section 4.5",
    .about = "a bowling ball on position based fluids, whose density constraint or viscosity the history multiplies",
    .scene = "bowling-ball-small",
    .set = {"scheme=positions"},
    .steps = 300,
    .small_set = {"resolution=0.6"},
    .small_steps = 300,
    .variant = {{"summed", {"scheme=summed"}, NULL},
                {"none", {"history.stiffness=0"}, NULL},
                {"none, hard", {"history.stiffness=0", "positions.relaxation=0"}, NULL},
                {"constraint", {"positions.history=constraint"}, NULL},
                {"c. x 100", {"positions.history=constraint", "history.stiffness=15000"}, NULL},
                {"c. 16 times", {"positions.history=constraint", "positions.iterations=16"}, NULL},
                {"viscosity", {"positions.history=viscosity"}, NULL},
                {"v. x 100", {"positions.history=viscosity", "history.stiffness=15000"}, NULL}},
    .column = COLUMNS,
    .figure = {{"dip", "R", "depth of the first dip"},
               {"rise", "R", "rise from the first dip"},
               {"t_1.5R", "T", "time from contact until 1.5 R is reached"},
               {"t_2R", "T", "the same for 2 R"}},
    .panels = 1,
    .observe = observe,
    .measure = measure_positions,
    .claim =
        {
            {"rise", "summed", CLI_AT_LEAST, .plus = 0.1},
            NO_RISE("none"),
            NO_RISE("none, hard"),
            NO_RISE("constraint"),
            NO_RISE("c. x 100"),
            NO_RISE("c. 16 times"),
            NO_RISE("viscosity"),
            NO_RISE("v. x 100"),
            {"t_2R", "c. x 100", CLI_AT_MOST, .factor = 1.2, .of = "t_2R", .of_variant = "none", .not_small = true},
            {"t_2R", "viscosity", CLI_AT_LEAST, .factor = 1.2, .of = "t_2R", .of_variant = "none", .not_small = true},
            {"t_2R", "v. x 100", CLI_AT_LEAST, .factor = 1.05, .of = "t_2R", .of_variant = "viscosity",
             .not_small = true, .or_never = true},
        },
};
#undef NO_RISE

/* ---- A ball that sinks in a deep pool ---- */

enum { SINKING, ABOVE_FLOOR, FALL };

static void observe_settling(const rheo_world *world, const cli_trial *run, double *column)
{
    rheo_body ball;
    rheo_world_body(world, 0, &ball);
    const double g = -rheo_world_definition(world)->gravity[1];
    column[SINKING] = -ball.velocity[1] / sqrt(g * ball.radius);
    column[ABOVE_FLOOR] = (ball.position[1] - ball.radius) / ball.radius;
    column[FALL] = (run->surface - (ball.position[1] - ball.radius)) / ball.radius;
}

/* The mean of five steps. */
static double smoothed(const cli_series *s, size_t row)
{
    double sum = 0;
    for (size_t k = row - 2; k <= row + 2; k++)
        sum += at(s, k, SINKING);
    return sum / 5;
}

/*
 * Counts the turns of the velocity, each a reversal of the acceleration, until the ball is half a radius above the floor. A
 * turn counts when the velocity has come away from it by .05 sqrt(g R).
 */
static void measure_settling(const cli_series *s, double *figure)
{
    const double away = 0.05;
    double turns = 0, extreme = s->rows > 4 ? smoothed(s, 2) : 0, fastest = 0;
    int direction = 1; /* it is set down at rest */
    size_t row = 2;
    for (; row + 2 < s->rows && at(s, row, ABOVE_FLOOR) > 0.5; row++) {
        const double v = smoothed(s, row);
        fastest = fmax(fastest, v);
        if (direction * (v - extreme) > 0) {
            extreme = v;
        } else if (direction * (extreme - v) > away) {
            turns++;
            direction = -direction;
            extreme = v;
        }
    }
    figure[0] = turns;
    figure[1] = fastest;
    figure[2] = row + 2 < s->rows ? s->time[row] : INFINITY;
}

const cli_experiment cli_experiment_settling = {
    .name = "settling",
    .reference = "Ozgen et al., section 4.4",
    .about =
        "a heavy ball is set down on a deep pool. Its velocity oscillates while it sinks; without history it only falls",
    .scene = "settling",
    .steps = 400,
    .small_set = {"resolution=0.8"},
    .small_steps = 400,
    .variant = {{"history", {NULL}, NULL}, {"none", {"history.stiffness=0"}, NULL}},
    .column = {{"sinking", "sqrt(g R)", "velocity of the ball, downwards"},
               {"above_floor", "R", "lowest point of the ball above y = 0"},
               {"depth", "R", "depth of this point"}},
    .figure = {{"turns", "1", "reversals of the acceleration until .5 R above the floor"},
               {"fastest", "sqrt(g R)", "largest velocity until then"},
               {"floor_at", "T", "time of being .5 R above the floor"}},
    .panels = 1,
    .observe = observe_settling,
    .measure = measure_settling,
    .claim =
        {
            {"turns", "history", CLI_AT_LEAST, .plus = 2},
            {"turns", "none", CLI_AT_MOST, .plus = 0},
        },
};

/* ---- A foot that is pushed down again and again ---- */

enum { FOOT_DEPTH, CADENCE };

static void observe_runner(const rheo_world *world, const cli_trial *run, double *column)
{
    rheo_body foot;
    rheo_world_body(world, 0, &foot);
    column[FOOT_DEPTH] = (run->surface - (foot.position[1] - foot.radius)) / foot.radius;
    column[CADENCE] = rheo_world_definition(world)->ball.push_frequency;
}

static void measure_runner(const cli_series *s, double *figure)
{
    figure[0] = s->value[CADENCE];
    figure[1] = 0;
    for (size_t row = 0; row < s->rows; row++)
        figure[1] = fmax(figure[1], at(s, row, FOOT_DEPTH));
    figure[2] = cli_time_of(s, cli_first_above(s, FOOT_DEPTH, 1.5, 0));
}

#define PUSHED(f, history, set)                                            \
    {                                                                      \
        "f = " f ", " history, {"ball.push_frequency=" f, set, NULL}, NULL \
    }
#define CADENCES(history, set)                                                             \
    PUSHED(".125", history, set), PUSHED(".25", history, set), PUSHED(".5", history, set), \
        PUSHED("1", history, set), PUSHED("2", history, set)

/* Without history the foot goes down at once to the floor, which is 2.76 R deep. */
#define SINKS(f)                                                \
    {"t_1.5R", "f = " f ", none", CLI_AT_MOST, .plus = 2},      \
    {                                                           \
        "deepest", "f = " f ", none", CLI_AT_LEAST, .plus = 2.4 \
    }

const cli_experiment cli_experiment_runner = {
    .name = "runner",
    .reference = "Mukhopadhyay et al. 2018",
    .about = "a foot that is pushed down often enough stays on cornstarch and water. Below a cadence it sinks in",
    .scene = "runner",
    .steps = 303,
    .small_set = {"resolution=0.7"},
    .small_steps = 303,
    .variant = {CADENCES("history", NULL), CADENCES("none", "history.stiffness=0")},
    .column = {{"depth", "R", "depth of the lowest point of the foot"},
               {"cadence", "1/T", "pushes in a unit of time"}},
    .figure = {{"cadence", "1/T", "pushes in a unit of time"},
               {"deepest", "R", "largest depth of the lowest point of the foot"},
               {"t_1.5R", "T", "time at which it is 1.5 R deep"}},
    .panels = 1,
    .curve_variants = 5,
    .observe = observe_runner,
    .measure = measure_runner,
    .claim =
        {
            {"deepest", "f = 2, history", CLI_AT_MOST, .plus = 1.5},
            {"deepest", "f = 1, history", CLI_AT_MOST, .plus = 1.5},
            {"deepest", "f = .25, history", CLI_AT_LEAST, .plus = 0.3, .factor = 1, .of = "deepest",
             .of_variant = "f = 1, history"},
            {"deepest", "f = .125, history", CLI_AT_LEAST, .plus = 0.3, .factor = 1, .of = "deepest",
             .of_variant = "f = .25, history"},
            SINKS(".125"),
            SINKS(".25"),
            SINKS(".5"),
            SINKS("1"),
            SINKS("2"),
        },
};
