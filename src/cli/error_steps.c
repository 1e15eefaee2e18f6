/*
 * rheolog bench error, study steps: time step, substeps, and the order in which forces act. A ball falls into a pool, a
 * drop on a floor, and pools and lattices have closed forms. All settings of a case start from one state.
 *
 * Each law has its own limit step -> 0: in scheme sequential the ball does not count as fluid and pressures have no lower
 * bound, and the paper has no onset of the history.
 */
#include "cli/error_trials.h"

#include <math.h>
#include <stdlib.h>

#define SEQUENTIAL             \
    {                          \
        "scheme", "sequential" \
    }
#define PRINTED              \
    SEQUENTIAL,              \
    {                        \
        "history.onset", "0" \
    }
#define IMPLICIT                     \
    SEQUENTIAL,                      \
    {                                \
        "springs.solver", "implicit" \
    }
#define POSITIONS             \
    {                         \
        "scheme", "positions" \
    }

static const cli_setting SETTINGS[] = {
    {"summed, step/16", "", "summed", 16, true, {{NULL}}},
    {"summed, step/8", "summed", "summed", 8, false, {{NULL}}},
    {"summed, step/4", "summed", "summed", 4, false, {{NULL}}},
    {"summed, step/2", "summed", "summed", 2, false, {{NULL}}},
    {"summed, step", "summed", "summed", 1, false, {{NULL}}},
    {"summed, step x 2", "summed", "summed", 0.5, false, {{NULL}}},
    {"summed, substeps 2", "substeps", "summed", 1, false, {{"substeps", "2"}}},
    {"summed, substeps 3", "", "summed", 1, false, {{"substeps", "3"}}},
    {"summed, substeps 4", "substeps", "summed", 1, false, {{"substeps", "4"}}},
    {"summed, substeps 8", "substeps", "summed", 1, false, {{"substeps", "8"}}},
    {"sequential, step/8", "", "sequential", 8, true, {SEQUENTIAL}},
    {"sequential, step/4", "sequential", "sequential", 4, false, {SEQUENTIAL}},
    {"sequential, step/2", "sequential", "sequential", 2, false, {SEQUENTIAL}},
    {"sequential, step", "sequential", "sequential", 1, false, {SEQUENTIAL}},
    {"sequential, step x 2", "sequential", "sequential", 0.5, false, {SEQUENTIAL}},
    {"paper, step/4", "", "paper", 4, true, {PRINTED}},
    {"paper, step/2", "paper", "paper", 2, false, {PRINTED}},
    {"paper, step", "paper", "paper", 1, false, {PRINTED}},
    {"paper, step x 2", "paper", "paper", 0.5, false, {PRINTED}},
    {"implicit, step/2", "implicit", "sequential", 2, false, {IMPLICIT}},
    {"implicit, step", "implicit", "sequential", 1, false, {IMPLICIT}},
    {"implicit, step x 2", "implicit", "sequential", 0.5, false, {IMPLICIT}},
};
enum { SETTING_COUNT = sizeof SETTINGS / sizeof *SETTINGS };

/* Another fluid, which does not thicken: it has cases, and so fronts, of its own. */
static const cli_setting POSITION_SETTINGS[] = {
    {"positions, step/4", "", "positions", 4, true, {POSITIONS}},
    {"positions, step/2", "positions", "positions", 2, false, {POSITIONS}},
    {"positions, step", "positions", "positions", 1, false, {POSITIONS}},
    {"positions, step x 2", "positions", "positions", 0.5, false, {POSITIONS}},
};
enum { POSITION_COUNT = sizeof POSITION_SETTINGS / sizeof *POSITION_SETTINGS };

/* With `positions`, the name of the case in scheme positions, which is run as well. */
static int try_case(const cli_case *c, const char *positions, cli_bench_arguments *a, cli_error_points *points)
{
    cli_case other = *c;
    other.name = positions;
    const int status = cli_try(c, SETTINGS, SETTING_COUNT, a, points);
    return status == CLI_DONE && positions ? cli_try(&other, POSITION_SETTINGS, POSITION_COUNT, a, points) : status;
}

/* ---- A ball ---- */

static int ball(cli_bench_arguments *a, cli_error_points *points)
{
    rheo_scene scene;
    cli_settled from = {0};
    rheo_error error = {""};
    rheo_result result = rheo_scene_builtin("bowling-ball-small", &scene, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    result = cli_settle(&from, &scene, a, &error);
    const cli_case c = cli_ball_case(&from, "ball");
    rheo_scene_release(&scene);
    const int status = result == RHEO_OK ? try_case(&c, "ball-positions", a, points) : cli_error(result, &error);
    cli_settled_release(&from);
    return status;
}

/* ---- A drop ---- */

enum { LOWEST, REBOUND, HEIGHT_9 };

/* Heights are those of the centre of mass. */
typedef struct bounce {
    double before, highest;
    int phase; /* 0: falling, 1: rising after the first minimum, 2: over */
    bool begun;
} bounce;

static bool measure_drop(cli_trial *t, rheo_world *world)
{
    bounce *b = t->memory;
    const uint32_t n = rheo_world_particle_count(world);
    const double time = rheo_world_time(world);
    double y = 0;
    for (uint32_t i = 0; i < n; i++)
        y += (double)rheo_world_positions(world)[3 * (size_t)i + 1] / n;
    if (b->begun && b->phase == 0 && y > b->before) {
        b->phase = 1;
        b->highest = t->quantity[LOWEST] = b->before;
    }
    if (b->phase == 1 && y < b->before) {
        b->phase = 2;
        t->quantity[REBOUND] = b->before - b->highest;
    }
    if (time >= 9 && isnan(t->quantity[HEIGHT_9]))
        t->quantity[HEIGHT_9] = y + (b->before - y) * (time - 9) / t->def.step;
    b->before = y;
    b->begun = true;
    return isnan(t->quantity[HEIGHT_9]);
}

cli_case cli_drop_case(const rheo_world_def *def)
{
    return (cli_case){.name = "drop",
                      .quantity = {"lowest", "rebound", "height_9"},
                      .reference = {NAN, NAN, NAN},
                      .def = *def,
                      .longest = 9.1,
                      .bytes = sizeof(bounce),
                      .measure = measure_drop};
}

static int drop(cli_bench_arguments *a, cli_error_points *points)
{
    static const rheo_wall floor = {{0, 0, 0}, {0, 1, 0}};
    rheo_scene scene;
    rheo_fill sphere;
    cli_drop_scene(&scene, &sphere, 4);
    const double gravity = rheo_default_world_def().gravity[1];
    cli_settled from = {0};
    rheo_error error = {""};
    const rheo_result result = cli_settle(&from, &scene, a, &error);
    from.def.gravity[1] = gravity;
    from.def.walls.plane = &floor;
    from.def.walls.count = 1;
    const cli_case c = cli_drop_case(&from.def);
    const int status = result == RHEO_OK ? try_case(&c, "drop-positions", a, points) : cli_error(result, &error);
    cli_settled_release(&from);
    return status;
}

/* ---- Closed forms ---- */

static int wave(rheo_result (*make)(cli_case *c, cli_wave *w, cli_settled *lattice, rheo_error *error),
                cli_bench_arguments *a, cli_error_points *points)
{
    cli_case c;
    cli_wave w = {0};
    cli_settled lattice = {0};
    rheo_error error = {""};
    const rheo_result result = make(&c, &w, &lattice, &error);
    const int status = result == RHEO_OK ? try_case(&c, NULL, a, points) : cli_error(result, &error);
    free((void *)w.mode);
    cli_settled_release(&lattice);
    return status;
}

static int block(cli_bench_arguments *a, cli_error_points *points)
{
    return wave(cli_block_case, a, points);
}

static int elastic_wave(cli_bench_arguments *a, cli_error_points *points)
{
    return wave(cli_elastic_wave_case, a, points);
}

static int viscous_wave(cli_bench_arguments *a, cli_error_points *points)
{
    return wave(cli_viscous_wave_case, a, points);
}

static int hydrostatics(cli_bench_arguments *a, cli_error_points *points)
{
    return cli_hydrostatics(SETTINGS, SETTING_COUNT, a, points);
}

int cli_error_steps(cli_bench_arguments *a, cli_error_points *points)
{
    static const cli_named_case cases[] = {{"ball", ball},
                                           {"drop", drop},
                                           {"block", block},
                                           {"elastic-shear-wave", elastic_wave},
                                           {"shear-wave", viscous_wave},
                                           {"hydrostatics", hydrostatics}};
    return cli_try_cases(cases, sizeof cases / sizeof *cases, a, points);
}
