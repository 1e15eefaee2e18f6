/*
 * Experiments with a drop of fluid: on a floor and down a slope (Ozgen et al., Figs. 9 and 11, and section 4.1). Heights
 * are those of the centre of mass above the first wall, ways are along it.
 */
#include "cli/experiment.h"

#include <math.h>

enum { HEIGHT, WAY, FRONT };

static double along(const double direction[3], const rheo_real *position)
{
    return direction[0] * (double)position[0] + direction[1] * (double)position[1] +
           direction[2] * (double)position[2];
}

static void observe(const rheo_world *world, const cli_trial *run, double *column)
{
    const uint32_t count = rheo_world_particle_count(world);
    const rheo_real *position = rheo_world_positions(world);
    double front = -INFINITY;
    column[HEIGHT] = column[WAY] = 0;
    for (uint32_t i = 0; i < count; i++) {
        const double way = along(run->down, position + 3 * (size_t)i);
        column[HEIGHT] += along(run->up, position + 3 * (size_t)i) / count;
        column[WAY] += way / count;
        front = fmax(front, way);
    }
    column[FRONT] = front;
}

#define COLUMNS                                                                                                    \
    {                                                                                                              \
        {"height", "L", "height of the centre of mass"}, {"way", "L", "way of the centre of mass down the slope"}, \
            {"front", "L", "the particle that is farthest down"},                                                  \
    }

enum { LOWEST, REBOUND, LEFT, FRONT_WAY, CENTRE_WAY };

static void measure(const cli_series *s, double *figure)
{
    const size_t low = cli_first_minimum(s, HEIGHT, 0), last = s->rows - 1;
    const double *value = s->value;
    double top = value[low * s->columns + HEIGHT];
    for (size_t row = low; row < s->rows; row++)
        top = fmax(top, value[row * s->columns + HEIGHT]);
    figure[LOWEST] = value[low * s->columns + HEIGHT];
    figure[REBOUND] = top - figure[LOWEST];
    figure[LEFT] = value[last * s->columns + HEIGHT];
    figure[FRONT_WAY] = value[last * s->columns + FRONT] - value[FRONT];
}

static void measure_incline(const cli_series *s, double *figure)
{
    measure(s, figure);
    figure[CENTRE_WAY] = s->value[(s->rows - 1) * s->columns + WAY] - s->value[WAY];
}

#define FIGURES                                                                                                   \
    {"lowest", "L", "height at the first minimum"}, {"rebound", "L", "highest height after it, less the lowest"}, \
        {"height", "L", "height at the end"},                                                                     \
    {                                                                                                             \
        "front", "L", "way of the front at the end"                                                               \
    }

#define VARIANTS                                                                                                 \
    {"none", {"history.stiffness=0"}, NULL}, {"d = 50", {"history.window=50"}, NULL}, {"d = 150", {NULL}, NULL}, \
    {                                                                                                            \
        "d = 250", {"history.window=250"}, NULL                                                                  \
    }

const cli_experiment cli_experiment_drop = {
    .name = "drop",
    .reference = "Ozgen et al., Figs. 9 and 11",
    .about = "a drop of the fluid falls on a floor. It bounces and keeps its shape the longer, the longer its memory",
    .scene = "drop",
    .steps = 600,
    .small_set = {"resolution=0.6"},
    .small_steps = 600,
    .variant = {VARIANTS},
    .column = COLUMNS,
    .figure = {FIGURES},
    .panels = 1,
    .observe = observe,
    .measure = measure,
    .claim =
        {
            {"rebound", "d = 50", CLI_AT_LEAST, .plus = 0.5},
            {"rebound", "d = 150", CLI_AT_LEAST, .plus = 0.5},
            {"rebound", "d = 250", CLI_AT_LEAST, .plus = 0.5},
            {"rebound", "none", CLI_AT_MOST, .plus = 0.1},
            {"height", "d = 50", CLI_AT_LEAST, .factor = 1, .of = "height", .of_variant = "none"},
            {"height", "d = 150", CLI_AT_LEAST, .factor = 1, .of = "height", .of_variant = "d = 50"},
            {"height", "d = 250", CLI_AT_LEAST, .factor = 1, .of = "height", .of_variant = "d = 150"},
        },
};

const cli_experiment cli_experiment_incline = {
    .name = "incline",
    .reference = "Ozgen et al., section 4.1",
    .about = "a drop falls on a slope of 20 degrees and flows down it the slower, the longer its memory",
    .scene = "incline",
    .steps = 485,
    .small_set = {"resolution=0.6"},
    .small_steps = 485,
    .variant = {VARIANTS, {"no sticking", {"walls.sticking=0"}, NULL}},
    .column = COLUMNS,
    .figure = {FIGURES, {"way", "L", "way of the centre at the end"}},
    .panels = 3,
    .observe = observe,
    .measure = measure_incline,
    .claim =
        {
            {"front", "none", CLI_AT_LEAST, .factor = 2, .of = "front", .of_variant = "d = 50"},
            {"front", "d = 50", CLI_AT_LEAST, .factor = 1, .of = "front", .of_variant = "d = 150"},
            {"front", "d = 150", CLI_AT_LEAST, .factor = 1, .of = "front", .of_variant = "d = 250"},
            {"front", "no sticking", CLI_AT_LEAST, .factor = 2, .of = "front", .of_variant = "d = 150"},
        },
};

const cli_experiment cli_experiment_positions_drop = {
    .name = "positions-drop",
    .reference = "Ozgen et al., section 4.5",
    .about = "a drop of position based fluid falls on a floor",
    .scene = "drop",
    .set = {"scheme=positions"},
    .steps = 300,
    .small_set = {"resolution=0.6"},
    .small_steps = 300,
    .variant = {{"summed", {"scheme=summed"}, NULL},
                {"none", {"history.stiffness=0"}, NULL},
                {"constraint", {"positions.history=constraint"}, NULL},
                {"c. x 100", {"positions.history=constraint", "history.stiffness=150000"}, NULL},
                {"viscosity", {"positions.history=viscosity"}, NULL},
                {"both x 100", {"history.stiffness=150000"}, NULL}},
    .column = COLUMNS,
    .figure = {FIGURES},
    .panels = 1,
    .observe = observe,
    .measure = measure,
    .claim =
        {
            {"rebound", "summed", CLI_AT_LEAST, .plus = 0.5},
            {"rebound", "none", CLI_AT_MOST, .plus = 0.1},
            {"rebound", "constraint", CLI_AT_MOST, .plus = 0.1},
            {"rebound", "c. x 100", CLI_AT_MOST, .plus = 0.1},
            {"rebound", "viscosity", CLI_AT_MOST, .plus = 0.1},
            {"rebound", "both x 100", CLI_AT_MOST, .plus = 0.1},
            {"height", "viscosity", CLI_AT_LEAST, .factor = 1.2, .of = "height", .of_variant = "none",
             .not_small = true},
            {"height", "both x 100", CLI_AT_LEAST, .factor = 1.2, .of = "height", .of_variant = "viscosity"},
        },
};

/* ---- Two drops of different materials, left and right of x = 0 ---- */

static void observe_pair(const rheo_world *world, const cli_trial *run, double *column)
{
    (void)run;
    const uint32_t count = rheo_world_particle_count(world);
    const rheo_real *position = rheo_world_positions(world);
    double members[2] = {0, 0};
    column[0] = column[1] = 0;
    for (uint32_t i = 0; i < count; i++) {
        const int side = position[3 * (size_t)i] > 0;
        column[side] += (double)position[3 * (size_t)i + 1];
        members[side]++;
    }
    column[0] /= members[0];
    column[1] /= members[1];
}

static void measure_pair(const cli_series *s, double *figure)
{
    for (uint32_t side = 0; side < 2; side++) {
        const size_t low = cli_first_minimum(s, side, 0);
        double top = s->value[low * s->columns + side];
        for (size_t row = low; row < s->rows; row++)
            top = fmax(top, s->value[row * s->columns + side]);
        figure[2 * side] = s->value[low * s->columns + side];
        figure[2 * side + 1] = top - figure[2 * side];
    }
}

const cli_experiment cli_experiment_pair = {
    .name = "drop-pair",
    .reference = "Ozgen et al., Fig. 10",
    .about = "two drops fall side by side. The viscoelastic one spreads, the one of cornstarch and water bounces",
    .scene = "drop-pair",
    .steps = 180,
    .small_set = {"resolution=0.6"},
    .small_steps = 180,
    .variant = {{"both", {NULL}, NULL}, {"alike", {"materials.cornstarch.history.stiffness=0"}, NULL}},
    .column = {{"viscoelastic", "L", "height of the centre of mass of the viscoelastic drop"},
               {"cornstarch", "L", "height of the centre of mass of the other one"}},
    .figure = {{"low_viscoelastic", "L", "lowest height of the viscoelastic drop"},
               {"rise_viscoelastic", "L", "its rise after that"},
               {"low_cornstarch", "L", "lowest height of the other one"},
               {"rise_cornstarch", "L", "its rise after that"}},
    .panels = 2,
    .observe = observe_pair,
    .measure = measure_pair,
    .claim =
        {
            {"rise_cornstarch", "both", CLI_AT_LEAST, .plus = 0.5},
            {"rise_viscoelastic", "both", CLI_AT_MOST, .plus = 0.1},
            {"rise_cornstarch", "alike", CLI_AT_MOST, .plus = 0.1},
        },
};
