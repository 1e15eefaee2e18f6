/* Experiments with a layer over vibrators (Deegan 2010; Ozgen et al., Figs. 5 and 6). */
#include "cli/experiment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FILLED, TOP };

/* The share of the cells that were bare at the start and now hold the centre of a particle. */
static void observe_hole(const rheo_world *world, const cli_trial *run, double *column)
{
    static bool fluid[CLI_CELLS][CLI_CELLS];
    const uint32_t count = rheo_world_particle_count(world);
    const rheo_real *position = rheo_world_positions(world);
    uint32_t filled = 0, cell[2];
    for (uint32_t i = 0; i < CLI_CELLS; i++)
        for (uint32_t j = 0; j < CLI_CELLS; j++)
            fluid[i][j] = false;
    column[TOP] = 0;
    for (uint32_t k = 0; k < count; k++) {
        column[TOP] = fmax(column[TOP], (double)position[3 * (size_t)k + 1]);
        if (!cli_cell_of(run, position + 3 * (size_t)k, cell))
            continue;
        filled += run->bare[cell[0]][cell[1]] && !fluid[cell[0]][cell[1]];
        fluid[cell[0]][cell[1]] = true;
    }
    column[FILLED] = run->bare_cells ? (double)filled / run->bare_cells : NAN;
}

static double filled_at(const cli_series *s, double time)
{
    size_t row = 0;
    while (row + 1 < s->rows && s->time[row] < time)
        row++;
    return s->value[row * s->columns + FILLED];
}

static void measure_hole(const cli_series *s, double *figure)
{
    const size_t half = cli_first_above(s, FILLED, 0.5, 0);
    figure[0] = filled_at(s, 1);
    figure[1] = filled_at(s, 5);
    figure[2] = filled_at(s, 10);
    figure[3] = cli_time_of(s, half);
}

const cli_experiment cli_experiment_hole = {
    .name = "hole",
    .reference = "Deegan 2010",
    .about =
        "a vibrated layer of cornstarch and water keeps a hole open. At rest it fills, and at once without history",
    .scene = "hole",
    .steps = 303,
    .small_steps = 303,
    .variant =
        {
            {"vibrated", {NULL}, NULL},
            {"still", {"vibrators.amplitude=0"}, NULL},
            {"vibrated, none", {"history.stiffness=0"}, NULL},
            {"still, none", {"history.stiffness=0", "vibrators.amplitude=0"}, NULL},
        },
    .column = {{"filled", "1", "share of the hole that is filled"}, {"top", "L", "highest particle"}},
    .figure =
        {
            {"filled_1", "1", "share of the hole that is filled at 1 T"},
            {"filled_5", "1", "share at 5 T"},
            {"filled_10", "1", "share at 10 T"},
            {"half_at", "T", "time at which half is filled"},
        },
    .panels = 1,
    .observe = observe_hole,
    .measure = measure_hole,
    .claim =
        {
            {"filled_5", "vibrated", CLI_AT_MOST, .plus = 0.1},
            {"filled_5", "vibrated, none", CLI_AT_LEAST, .plus = 0.5},
            {"filled_5", "still", CLI_AT_LEAST, .plus = 0.02, .factor = 1, .of = "filled_5",
             .of_variant = "vibrated"},
            {"filled_5", "still", CLI_AT_MOST, .factor = 0.9, .of = "filled_5", .of_variant = "vibrated, none"},
        },
};

/* ---- A slow swell ---- */

static void observe_gentle(const rheo_world *world, const cli_trial *run, double *column)
{
    (void)run;
    const uint32_t count = rheo_world_particle_count(world);
    column[0] = 0;
    for (uint32_t i = 0; i < count; i++)
        column[0] += (double)rheo_world_positions(world)[3 * (size_t)i + 1] / count;
}

static double motion_of(const cli_series *s)
{
    double least = INFINITY, most = -INFINITY;
    for (size_t row = 0; row < s->rows; row++) {
        least = fmin(least, s->value[row]);
        most = fmax(most, s->value[row]);
    }
    return most - least;
}

static void measure_gentle(const cli_series *s, double *figure)
{
    figure[0] = motion_of(s);
}

/* The largest difference between two variants, relative to the motion of the second. */
static double difference_of(const cli_series *a, const cli_series *b)
{
    double most = 0;
    for (size_t row = 0; row < a->rows; row++)
        most = fmax(most, fabs(a->value[row] - b->value[row]));
    return most / motion_of(b);
}

static void sum_up_gentle(const cli_result *r, uint32_t seed, double *whole)
{
    whole[0] = difference_of(cli_series_of(r, 0, seed), cli_series_of(r, 1, seed));
    whole[1] = difference_of(cli_series_of(r, 2, seed), cli_series_of(r, 3, seed));
}

const cli_experiment cli_experiment_gentle = {
    .name = "gentle",
    .reference = "Ozgen et al., Fig. 12",
    .about = "the floor of a pool rises by 4 L and sinks again. When it does so slowly, history hardly counts",
    .scene = "gentle",
    .steps = 758,
    .small_set = {"resolution=0.7"},
    .small_steps = 758,
    .variant = {{"slow", {NULL}, NULL},
                {"slow, none", {"history.stiffness=0"}, NULL},
                {"fast", {"vibrators.frequency=0.5"}, NULL},
                {"fast, none", {"vibrators.frequency=0.5", "history.stiffness=0"}, NULL}},
    .column = {{"height", "L", "height of the centre of mass"}},
    .figure = {{"motion", "L", "range of the height"}},
    .panels = 1,
    .observe = observe_gentle,
    .measure = measure_gentle,
    .whole = {{"slow_difference", "motion", "largest difference of the heights with and without history, slow"},
              {"fast_difference", "motion", "the same, fast"}},
    .sum_up = sum_up_gentle,
    .claim = {{"slow_difference", NULL, CLI_AT_MOST, .plus = 0.05},
              {"fast_difference", NULL, CLI_AT_LEAST, .plus = 0.1}},
};

/* ---- Lumps ---- */

/*
 * Columns of two spacings in square. The top of a column is its highest particle below which no gap is wider than 1.5
 * spacings. What stands is the least top in the last samples: a splash does not stay.
 */
enum { COLUMNS = 32, EVERY = 6, SAMPLES = 8, WHERE = COLUMNS * COLUMNS };

enum { LUMP, STANDING, SPLASH, SLENDERNESS, QUANTITIES };

/* The memory of a run: samples of the tops, the newest first; the thickness of the layer; the last values of the columns. */
enum { LAYER = SAMPLES * WHERE, SEEN, MEMORY = SEEN + QUANTITIES };

typedef struct particle {
    uint32_t column;
    double height;
} particle;

static int by_column_and_height(const void *a, const void *b)
{
    const particle *p = a, *q = b;
    if (p->column != q->column)
        return p->column < q->column ? -1 : 1;
    return p->height < q->height ? -1 : p->height > q->height;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double median_of(const double *values, size_t count)
{
    static double sorted[WHERE];
    memcpy(sorted, values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, by_value);
    return count ? sorted[count / 2] : 0;
}

/* The column of a position; WHERE if it is outside of all. */
static uint32_t column_of(const cli_trial *run, const rheo_real *position)
{
    uint32_t cell[2];
    if (!cli_cell_of(run, position, cell) || cell[0] >= 2 * COLUMNS || cell[1] >= 2 * COLUMNS)
        return WHERE;
    return cell[0] / 2 * COLUMNS + cell[1] / 2;
}

static void take_tops(const rheo_world *world, const cli_trial *run, double *top)
{
    const uint32_t count = rheo_world_particle_count(world);
    const rheo_real *position = rheo_world_positions(world);
    particle *sorted = run->scratch;
    for (uint32_t i = 0; i < count; i++)
        sorted[i] = (particle){column_of(run, position + 3 * (size_t)i), (double)position[3 * (size_t)i + 1]};
    qsort(sorted, count, sizeof *sorted, by_column_and_height);
    for (uint32_t k = 0; k < WHERE; k++)
        top[k] = -1; /* no column */
    for (uint32_t i = 0; i < count && sorted[i].column < WHERE; i++) {
        double *own = &top[sorted[i].column];
        if (sorted[i].height - fmax(*own, 0) <= 1.5 * run->cell)
            *own = sorted[i].height;
        else
            *own = fmax(*own, 0);
    }
}

/* The present tops of the columns that exist. */
static size_t present(const double *top, double *values)
{
    size_t count = 0;
    for (uint32_t k = 0; k < WHERE; k++)
        if (top[k] >= 0)
            values[count++] = top[k];
    return count;
}

/* The least top of a column in the last samples: what stands. */
static double stands(const cli_trial *run, uint32_t k, uint32_t samples)
{
    double least = INFINITY;
    for (uint32_t sample = 0; sample < samples; sample++)
        least = fmin(least, run->memory[sample * WHERE + k]);
    return least;
}

/* Whether a column is nearer to a vibrator than half the distance of the nearest other one. */
static bool is_at(const rheo_world_def *def, const cli_trial *run, uint32_t vibrator, uint32_t k)
{
    const double *at = def->vibrators.position[vibrator];
    double reach = INFINITY;
    for (uint32_t other = 0; other < def->vibrators.count; other++) {
        const double x = def->vibrators.position[other][0] - at[0], z = def->vibrators.position[other][1] - at[1];
        reach = other == vibrator ? reach : fmin(reach, 0.5 * sqrt(x * x + z * z));
    }
    const double x = run->corner[0] + (2 * (k / COLUMNS) + 1) * run->cell - at[0],
                 z = run->corner[1] + (2 * (k % COLUMNS) + 1) * run->cell - at[1];
    return x * x + z * z <= reach * reach;
}

/*
 * Height of what stands at a vibrator above the middle of all tops, and this height over the width: the diameter of a circle
 * with the area of the columns that stand half as high.
 */
static double standing_at(const rheo_world_def *def, const cli_trial *run, uint32_t vibrator, uint32_t samples,
                          double middle, double *slenderness)
{
    static double above[WHERE];
    double most = 0, area = 0;
    for (uint32_t k = 0; k < WHERE; k++) {
        above[k] = is_at(def, run, vibrator, k) ? stands(run, k, samples) : 0;
        most = fmax(most, above[k]);
    }
    for (uint32_t k = 0; k < WHERE; k++)
        area += above[k] > 0.5 * (most + middle) ? 4 * run->cell * run->cell : 0;
    *slenderness = most > middle ? (most - middle) / (2 * sqrt(area / 3.14159265358979323846)) : 0;
    return most - middle;
}

/* enough: height in layers from which on something is said to stand. */
static void observe_standing(const rheo_world *world, const cli_trial *run, double enough, double *column)
{
    static double values[WHERE];
    const rheo_world_def *def = rheo_world_definition(world);
    const uint64_t step = rheo_world_step_count(world);
    double *memory = run->memory;
    memcpy(column, memory + SEEN, QUANTITIES * sizeof *column);
    if (step % EVERY != 0)
        return;
    memmove(memory + WHERE, memory, (SAMPLES - 1) * WHERE * sizeof *memory);
    take_tops(world, run, memory);
    const size_t count = present(memory, values);
    const double middle = median_of(values, count);
    if (step == 0)
        memory[LAYER] = middle + run->cell / 2;
    const uint32_t samples = step / EVERY + 1 < SAMPLES ? (uint32_t)(step / EVERY) + 1 : SAMPLES;
    for (uint32_t q = 0; q < QUANTITIES; q++)
        column[q] = 0;
    for (uint32_t v = 0; v < def->vibrators.count; v++) {
        double slenderness;
        const double lump = standing_at(def, run, v, samples, middle, &slenderness) / memory[LAYER];
        column[LUMP] += lump / def->vibrators.count;
        column[STANDING] += lump > enough;
        column[SLENDERNESS] += slenderness / def->vibrators.count;
    }
    for (size_t k = 0; k < count; k++)
        column[SPLASH] = fmax(column[SPLASH], values[k] / memory[LAYER]);
    memcpy(memory + SEEN, column, QUANTITIES * sizeof *column);
}

static void observe_lumps(const rheo_world *world, const cli_trial *run, double *column)
{
    observe_standing(world, run, 0.5, column);
}

static void observe_fingers(const rheo_world *world, const cli_trial *run, double *column)
{
    observe_standing(world, run, 0.6, column);
}

/* The mean of a column over the last three units of time. */
static double late(const cli_series *s, uint32_t column)
{
    double sum = 0;
    size_t count = 0;
    for (size_t row = 0; row < s->rows; row++)
        if (s->time[row] >= s->time[s->rows - 1] - 3) {
            sum += s->value[row * s->columns + column];
            count++;
        }
    return sum / (double)count;
}

static double largest(const cli_series *s, uint32_t column)
{
    double most = 0;
    for (size_t row = 0; row < s->rows; row++)
        most = fmax(most, s->value[row * s->columns + column]);
    return most;
}

static void measure_lumps(const cli_series *s, double *figure)
{
    figure[0] = late(s, LUMP);
    figure[1] = late(s, STANDING);
    figure[2] = largest(s, SPLASH);
}

static void measure_fingers(const cli_series *s, double *figure)
{
    figure[0] = late(s, LUMP);
    figure[1] = late(s, STANDING);
    figure[2] = late(s, SLENDERNESS);
    figure[3] = largest(s, LUMP);
}

const cli_experiment cli_experiment_lumps = {
    .name = "lumps",
    .reference = "Ozgen et al., Figs. 5 and 6",
    .about = "lumps stand up from a vibrated layer of cornstarch and water. Without history it only splashes",
    .scene = "lumps",
    .steps = 424,
    .small_set = {"resolution=0.8"},
    .small_steps = 300,
    .variant = {{"history", {NULL}, NULL}, {"none", {"history.stiffness=0"}, NULL}},
    .column = {{"lump", "layers", "height of what stands at a vibrator above the median, mean over the vibrators"},
               {"standing", "1", "vibrators at which more than half a layer stands"},
               {"splash", "layers", "highest top"},
               {"slenderness", "1", "height of what stands over its width, mean over the vibrators"}},
    .figure = {{"lump", "layers", "mean of `lump` over the last 3 T"},
               {"standing", "1", "mean of `standing` over the last 3 T"},
               {"splash", "layers", "highest top of the run"}},
    .panels = 2,
    .memory = MEMORY,
    .scratch = sizeof(particle),
    .observe = observe_lumps,
    .measure = measure_lumps,
    .claim =
        {
            {"lump", "history", CLI_AT_LEAST, .plus = 0.4, .not_small = true},
            {"lump", "history", CLI_AT_LEAST, .plus = 0.2},
            {"lump", "none", CLI_AT_MOST, .plus = 0.2},
            {"standing", "history", CLI_AT_LEAST, .plus = 5, .not_small = true},
            {"standing", "history", CLI_AT_LEAST, .plus = 2},
            {"standing", "none", CLI_AT_MOST, .plus = 1},
        },
};

const cli_experiment cli_experiment_fingers = {
    .name = "fingers",
    .reference = "Ozgen et al., Fig. 5",
    .about =
        "fingers rise from a vibrated layer that solidifies late. Without this time, or without history, none stands",
    .scene = "fingers",
    .steps = 424,
    .small_set = {"resolution=0.8"},
    .small_steps = 300,
    .variant = {{"lag", {NULL}, NULL}, {"no lag", {"history.lag=0"}, NULL}, {"none", {"history.stiffness=0"}, NULL}},
    .column = {{"finger", "layers", "height of what stands at a vibrator above the median, mean over the vibrators"},
               {"standing", "1", "vibrators at which more than .6 layers stand"},
               {"splash", "layers", "highest top"},
               {"slenderness", "1", "height of what stands over its width, mean over the vibrators"}},
    .figure = {{"finger", "layers", "mean of `finger` over the last 3 T"},
               {"standing", "1", "mean of `standing` over the last 3 T"},
               {"slenderness", "1", "mean of `slenderness` over the last 3 T"},
               {"highest", "layers", "largest `finger` of the run"}},
    .panels = 2,
    .memory = MEMORY,
    .scratch = sizeof(particle),
    .observe = observe_fingers,
    .measure = measure_fingers,
    .claim =
        {
            {"finger", "lag", CLI_AT_LEAST, .plus = 0.6},
            {"standing", "lag", CLI_AT_LEAST, .plus = 6},
            {"slenderness", "lag", CLI_AT_LEAST, .plus = 1, .not_small = true},
            {"slenderness", "lag", CLI_AT_LEAST, .plus = 0.6},
            {"finger", "no lag", CLI_AT_MOST, .plus = 0.2},
            {"finger", "none", CLI_AT_MOST, .plus = 0.2},
        },
};
