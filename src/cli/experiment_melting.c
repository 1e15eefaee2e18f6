/*
 * Experiments with objects that melt (Paiva et al., Figs. 1 to 3, 5 and 6). The objects have the height 1 and stand on the
 * floor. An iteration of the paper is a substep; figures "at iteration N" are those of the first step that ends behind it.
 */
#include "cli/experiment_melting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- What is measured in every object ---- */

/* Reads a field of particles. NULL: there is no such field, or no memory. */
static rheo_real *read_field(const rheo_world *world, const char *name)
{
    rheo_field_info info;
    uint32_t i = 0;
    while (rheo_world_field(world, i, &info) == RHEO_OK && strcmp(info.name, name) != 0)
        i++;
    if (i >= rheo_world_field_count(world))
        return NULL;
    rheo_real *values = malloc((size_t)info.bytes + 1);
    if (values && rheo_world_field_read(world, i, values, (size_t)info.bytes) != RHEO_OK) {
        free(values);
        return NULL;
    }
    return values;
}

void cli_melting_release(cli_melting *m)
{
    free(m->start);
    free(m->temperature);
}

double cli_melting_began_at(const cli_melting *m, uint32_t id, int axis)
{
    return (double)m->start[3 * (size_t)id + (size_t)axis];
}

double cli_melting_is_at(const cli_melting *m, uint32_t id, int axis)
{
    return (double)m->position[3 * (size_t)id + (size_t)axis];
}

double cli_melting_temperature(const cli_melting *m, uint32_t id)
{
    return m->temperature ? (double)m->temperature[id] : m->common;
}

static double way_of(const cli_melting *m, uint32_t id)
{
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        const double way = cli_melting_is_at(m, id, axis) - cli_melting_began_at(m, id, axis);
        square += way * way;
    }
    return sqrt(square);
}

bool cli_melting_observe(const rheo_world *world, const cli_trial *run, cli_melting *m, double *column)
{
    const rheo_world_def *def = rheo_world_definition(world);
    double top = 0, base = 0;
    run->memory[0] += rheo_world_step_count(world) ? cli_metric(world, "substeps") : 0;
    column[CLI_ITERATIONS] = run->memory[0];
    *m = (cli_melting){.count = rheo_world_particle_count(world),
                       .spacing = def->fluid.spacing,
                       .melts_at = (def->melting.temperature_min + def->melting.temperature_max) / 2,
                       .common = def->melting.temperature,
                       .position = rheo_world_positions(world),
                       .start = read_field(world, "start_position"),
                       .temperature = read_field(world, "temperature")};
    column[CLI_MELTED] = column[CLI_TOP] = column[CLI_BASE] = m->start ? 0 : NAN;
    for (uint32_t i = 0; m->start && i < m->count; i++) {
        const double height = cli_melting_began_at(m, i, 1);
        column[CLI_MELTED] += cli_melting_temperature(m, i) > m->melts_at;
        column[CLI_TOP] += height > 0.7 ? cli_melting_is_at(m, i, 1) : 0;
        column[CLI_BASE] += height < 0.35 ? way_of(m, i) : 0;
        top += height > 0.7;
        base += height < 0.35;
    }
    column[CLI_MELTED] /= m->count;
    column[CLI_TOP] /= top;
    column[CLI_BASE] /= base;
    return m->start;
}

double cli_at_iteration(const cli_series *s, double iteration, uint32_t column)
{
    const size_t row = cli_first_above(s, CLI_ITERATIONS, iteration - 0.5, 0);
    return row < s->rows ? s->value[row * s->columns + column] : NAN;
}

double cli_at_end(const cli_series *s, uint32_t column)
{
    return s->value[(s->rows - 1) * s->columns + column];
}

/* ---- Figs. 1 and 2: the bunny ---- */

/* The ears are what began above 0.8: one falls onto the back, the other one beside the head. */
enum { BACK_HEAT = CLI_MELTING_COLUMNS, FREE_HEAT, BACK_TOUCH, FREE_TOUCH };

static bool is_ear(const cli_melting *m, uint32_t i, int back)
{
    return cli_melting_began_at(m, i, 1) > 0.8 && (cli_melting_began_at(m, i, 0) > -0.28) == back;
}

/* Whether a particle is near one that began below the head. */
static bool touches_body(const cli_melting *m, uint32_t i)
{
    const double near = 1.5 * m->spacing;
    for (uint32_t k = 0; k < m->count; k++) {
        if (cli_melting_began_at(m, k, 1) > 0.65)
            continue;
        double square = 0;
        for (int axis = 0; axis < 3; axis++) {
            const double away = cli_melting_is_at(m, i, axis) - cli_melting_is_at(m, k, axis);
            square += away * away;
        }
        if (square < near * near)
            return true;
    }
    return false;
}

static void observe_bunny(const rheo_world *world, const cli_trial *run, double *column)
{
    cli_melting m;
    const bool read = cli_melting_observe(world, run, &m, column);
    for (int ear = 0; ear < 2; ear++) {
        double heat = 0, touch = 0, count = 0;
        for (uint32_t i = 0; read && i < m.count; i++)
            if (is_ear(&m, i, ear == 0)) {
                heat += cli_melting_temperature(&m, i);
                touch += touches_body(&m, i);
                count++;
            }
        column[BACK_HEAT + ear] = heat / count;
        column[BACK_TOUCH + ear] = touch / count;
    }
    cli_melting_release(&m);
}

/* Time at which a column has fallen by an amount from its first value. */
static double fallen_at(const cli_series *s, uint32_t column, double by)
{
    size_t row = 0;
    while (row < s->rows && s->value[row * s->columns + column] > s->value[column] - by)
        row++;
    return cli_time_of(s, row);
}

static double largest(const cli_series *s, uint32_t column)
{
    double most = 0;
    for (size_t row = 0; row < s->rows; row++)
        most = fmax(most, s->value[row * s->columns + column]);
    return most;
}

static void measure_bunny(const cli_series *s, double *figure)
{
    const double last = 3000;
    figure[0] = cli_time_of(s, cli_first_above(s, CLI_ITERATIONS, last - 0.5, 0));
    figure[1] = s->value[CLI_MELTED];
    figure[2] = cli_at_iteration(s, last, CLI_MELTED);
    figure[3] = cli_at_iteration(s, 500, CLI_TOP);
    figure[4] = cli_at_iteration(s, 1060, CLI_TOP);
    figure[5] = cli_at_iteration(s, last, CLI_TOP);
    figure[6] = cli_at_iteration(s, last, CLI_BASE);
    figure[7] = cli_time_of(s, cli_first_above(s, BACK_TOUCH, 0, 0));
    figure[8] = fallen_at(s, BACK_HEAT, 0.05);
    figure[9] = largest(s, BACK_TOUCH);
    figure[10] = largest(s, FREE_TOUCH);
    figure[11] = s->value[BACK_HEAT] - cli_at_iteration(s, last, BACK_HEAT);
    figure[12] = s->value[FREE_HEAT] - cli_at_iteration(s, last, FREE_HEAT);
}

const cli_experiment cli_experiment_melting_bunny = {
    .name = "melting-bunny",
    .reference = "Paiva et al., Figs. 1 and 2",
    .about =
        "a bunny that is hot at the top melts there. The ear that falls onto its back cools, the other one stays hot",
    .scene = "melting-bunny-small",
    .steps = 252,
    .small_set = {"particles=1200"},
    .small_steps = 320,
    .jitter = 0.01,
    .variant = {{"heat flows", {NULL}, NULL}, {"none flows", {"melting.diffusivity=0"}, NULL}},
    .column = {CLI_MELTING_COLUMN,
               {"back_ear", "K", "mean temperature of the ear that falls onto the back"},
               {"free_ear", "K", "mean temperature of the other ear"},
               {"back_touch", "1", "share of the former that touches the body"},
               {"free_touch", "1", "share of the latter that touches the body"}},
    .figure =
        {
            {"t_3000", "T", "time of iteration 3000"},
            {"melted_0", "1", "share that is molten at the start"},
            {"melted_3000", "1", "share at iteration 3000"},
            {"top_500", "L", "mean height of what began above 0.7, at iteration 500"},
            {"top_1060", "L", "at iteration 1060"},
            {"top_3000", "L", "at iteration 3000"},
            {"base_3000", "L", "mean way of what began below 0.35, until iteration 3000"},
            {"touches_at", "T", "time at which one ear touches the back"},
            {"cools_at", "T", "time at which that ear is colder by 0.05 K"},
            {"back_touch", "1", "largest share of that ear that touches"},
            {"free_touch", "1", "the same of the other ear"},
            {"back_cooling", "K", "by how much that ear is colder at iteration 3000"},
            {"free_cooling", "K", "by how much the other ear is colder then"},
        },
    .panels = 7,
    .against_first = true,
    .memory = 1,
    .observe = observe_bunny,
    .measure = measure_bunny,
    .claim =
        {
            {"top_1060", "heat flows", CLI_AT_MOST, .factor = 0.9, .of = "top_500", .of_variant = "heat flows"},
            {"top_3000", "heat flows", CLI_AT_MOST, .plus = 0.35},
            {"base_3000", "heat flows", CLI_AT_MOST, .plus = 0.002},
            {"cools_at", "heat flows", CLI_AT_LEAST, .factor = 1, .of = "touches_at", .of_variant = "heat flows"},
            {"back_touch", "heat flows", CLI_AT_LEAST, .factor = 2, .of = "free_touch", .of_variant = "heat flows"},
            {"back_cooling", "heat flows", CLI_AT_LEAST, .factor = 2, .of = "free_cooling",
             .of_variant = "heat flows"},
            {"back_cooling", "none flows", CLI_AT_MOST, .plus = 0.001},
        },
};

/* ---- Fig. 3: holes of a chair ---- */

enum { HOLES = CLI_MELTING_COLUMNS, OPEN };

/* Cells half a spacing wide of the view along z: covered by a particle, or open to the outside. */
typedef struct cover {
    double cell, corner[2];
    unsigned char at[2 * CLI_CELLS][2 * CLI_CELLS];
} cover;
enum { BARE, COVERED, OUTSIDE, MOST_CELLS = 2 * CLI_CELLS };

static void cover_by(cover *c, double x, double y, double radius)
{
    const int reach = (int)(radius / c->cell) + 1, column = (int)((x - c->corner[0]) / c->cell),
              row = (int)((y - c->corner[1]) / c->cell);
    for (int i = column - reach; i <= column + reach; i++)
        for (int k = row - reach; k <= row + reach; k++) {
            const double dx = c->corner[0] + (i + 0.5) * c->cell - x, dy = c->corner[1] + (k + 0.5) * c->cell - y;
            if (i >= 0 && k >= 0 && i < MOST_CELLS && k < MOST_CELLS && dx * dx + dy * dy < radius * radius)
                c->at[i][k] = COVERED;
        }
}

/* Marks the bare cells that are joined to one. Returns their number. */
static uint32_t flood(cover *c, uint32_t i, uint32_t k)
{
    static uint32_t waiting[MOST_CELLS * MOST_CELLS];
    uint32_t count = 0, found = 1;
    waiting[0] = i * MOST_CELLS + k;
    c->at[i][k] = OUTSIDE;
    while (count < found) {
        const uint32_t cell = waiting[count++], row = cell / MOST_CELLS, column = cell % MOST_CELLS;
        const uint32_t next[4][2] = {{row - 1, column}, {row + 1, column}, {row, column - 1}, {row, column + 1}};
        for (int n = 0; n < 4; n++) {
            const uint32_t a = next[n][0], b = next[n][1]; /* below 0: very large */
            if (a < MOST_CELLS && b < MOST_CELLS && c->at[a][b] == BARE) {
                c->at[a][b] = OUTSIDE;
                waiting[found++] = a * MOST_CELLS + b;
            }
        }
    }
    return count;
}

/* Holes that one can look through along z, and their area. A hole has two cells or more. */
static void observe_chair(const rheo_world *world, const cli_trial *run, double *column)
{
    static cover c;
    cli_melting m;
    const bool read = cli_melting_observe(world, run, &m, column);
    column[HOLES] = column[OPEN] = read ? 0 : NAN;
    memset(&c, 0, sizeof c);
    c.cell = m.spacing / 2;
    c.corner[0] = -c.cell * CLI_CELLS;
    c.corner[1] = -4 * c.cell;
    for (uint32_t i = 0; read && i < m.count; i++)
        cover_by(&c, cli_melting_is_at(&m, i, 0), cli_melting_is_at(&m, i, 1), 0.8 * m.spacing);
    if (c.at[0][MOST_CELLS - 1] == BARE)
        flood(&c, 0, MOST_CELLS - 1);
    for (uint32_t i = 0; read && i < MOST_CELLS; i++)
        for (uint32_t k = 0; k < MOST_CELLS; k++) {
            const uint32_t cells = c.at[i][k] == BARE ? flood(&c, i, k) : 0;
            column[HOLES] += cells > 1;
            column[OPEN] += cells > 1 ? cells * c.cell * c.cell : 0;
        }
    cli_melting_release(&m);
}

static void measure_chair(const cli_series *s, double *figure)
{
    size_t closed = 0;
    while (closed < s->rows && s->value[closed * s->columns + OPEN] > 0.05 * s->value[OPEN])
        closed++;
    figure[0] = s->value[HOLES];
    figure[1] = s->value[OPEN];
    figure[2] = cli_time_of(s, closed);
    figure[3] = closed < s->rows ? s->value[closed * s->columns + CLI_ITERATIONS] : INFINITY;
    figure[4] = cli_at_end(s, OPEN);
    figure[5] = cli_at_end(s, CLI_TOP);
    figure[6] = cli_at_end(s, CLI_BASE);
}

const cli_experiment cli_experiment_chair = {
    .name = "chair",
    .reference = "Paiva et al., Fig. 3",
    .about = "the back of a chair melts. Its holes close and its pieces join, without any surface that is kept",
    .scene = "chair",
    .set = {"resolution=0.6",
            "melting.time_scale=0.02"}, /* yield stress 2.5: legs carry more than their own weight */
    .steps = 75,
    .small_set = {"resolution=0.5"},
    .small_steps = 75,
    .jitter = 0.01,
    .variant = {{"hot back", {NULL}, NULL},
                {"all cold", {"melting.temperature_max=3", "melting.temperature_min=2"}, NULL},
                {"yield 1", {"melting.time_scale=0.05"}, NULL}},
    .column = {CLI_MELTING_COLUMN,
               {"holes", "1", "holes that one can look through from the front"},
               {"open", "L^2", "their area"}},
    .figure =
        {
            {"holes", "1", "holes at the start"},
            {"open", "L^2", "their area"},
            {"closed_at", "T", "time at which less than a twentieth of that is open"},
            {"iteration", "1", "iterations until then"},
            {"open_end", "L^2", "area at the end"},
            {"top", "L", "mean height of what began above 0.7, at the end"},
            {"base", "L", "mean way of what began below 0.35"},
        },
    .panels = 5,
    .against_first = true,
    .memory = 1,
    .observe = observe_chair,
    .measure = measure_chair,
    .claim =
        {
            {"holes", "hot back", CLI_AT_LEAST, .plus = 3},
            {"closed_at", "hot back", CLI_AT_MOST, .plus = 1},
            {"base", "hot back", CLI_AT_MOST, .plus = 0.005},
            {"closed_at", "all cold", CLI_AT_LEAST, .plus = 1, .factor = 1, .of = "closed_at",
             .of_variant = "hot back", .or_never = true},
            {"base", "yield 1", CLI_AT_LEAST, .factor = 5, .of = "base", .of_variant = "hot back"},
        },
};
