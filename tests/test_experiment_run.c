/* How experiments are run: what a run begins from, found again cell by cell, and where seeds, variants and settings go. */
#include "support.h"

#include <math.h>

#include "cli/experiment.h"

static struct {
    uint32_t bare_cells, measured, summed;
    bool checked;
} seen;

/* The cell along an axis of the floor; the fluid's outermost particles are half a spacing from the wall. */
static int cell_along(const rheo_world *world, uint32_t id, int axis)
{
    const rheo_real *x = rheo_world_positions(world);
    const double spacing = rheo_world_definition(world)->fluid.spacing;
    double least = INFINITY;
    for (uint32_t k = 0; k < rheo_world_particle_count(world); k++)
        least = fmin(least, (double)x[3 * k + (uint32_t)axis]);
    return (int)floor(((double)x[3 * id + (uint32_t)axis] - (least - spacing / 2)) / spacing);
}

static void check_cells(const rheo_world *world, const cli_trial *run)
{
    static bool fluid[CLI_CELLS][CLI_CELLS];
    int most[2] = {0, 0};
    memset(fluid, 0, sizeof fluid);
    for (uint32_t k = 0; k < rheo_world_particle_count(world); k++) {
        const int i = cell_along(world, k, 0), j = cell_along(world, k, 2);
        assert_true(i >= 0 && j >= 0 && i < CLI_CELLS && j < CLI_CELLS);
        fluid[i][j] = true;
        most[0] = i > most[0] ? i : most[0];
        most[1] = j > most[1] ? j : most[1];
    }
    seen.bare_cells = 0;
    for (int i = 0; i < CLI_CELLS; i++)
        for (int j = 0; j < CLI_CELLS; j++) {
            bool bare = i > 0 && j > 0 && i < most[0] && j < most[1];
            for (int di = -1; bare && di <= 1; di++)
                for (int dj = -1; bare && dj <= 1; dj++)
                    bare = !fluid[i + di][j + dj];
            if (run->bare[i][j] != bare)
                fail_msg("cell %d, %d is %s", i, j, bare ? "bare" : "not bare");
            seen.bare_cells += bare;
        }
    assert_int_equal(run->bare_cells, seen.bare_cells);
    for (uint32_t k = 0; k < rheo_world_particle_count(world); k++) {
        uint32_t cell[2];
        assert_true(cli_cell_of(run, rheo_world_positions(world) + 3 * k, cell));
        assert_int_equal(cell[0], cell_along(world, k, 0));
        assert_int_equal(cell[1], cell_along(world, k, 2));
    }
    /* The border belongs to the first cell, and not to the last. */
    uint32_t cell[2];
    const double end = CLI_CELLS * run->cell;
    const rheo_real inside[3] = {(rheo_real)(run->corner[0] + 0.01), 0, (rheo_real)(run->corner[1] + end - 0.01)},
                    below[3] = {(rheo_real)(run->corner[0] - 0.01), 0, (rheo_real)run->corner[1] + 1},
                    above[3] = {(rheo_real)(run->corner[0] + 1), 0, (rheo_real)(run->corner[1] + end + 0.01)};
    assert_true(cli_cell_of(run, inside, cell) && cell[0] == 0 && cell[1] == CLI_CELLS - 1);
    assert_false(cli_cell_of(run, below, cell));
    assert_false(cli_cell_of(run, above, cell));
}

static void check_directions(const rheo_world *world, const cli_trial *run)
{
    const rheo_world_def *def = rheo_world_definition(world);
    double square[2] = {0, 0}, across = 0, weight = 0, down = 0;
    for (int i = 0; i < 3; i++) {
        square[0] += run->up[i] * run->up[i];
        square[1] += run->down[i] * run->down[i];
        across += run->up[i] * run->down[i];
        weight += def->gravity[i] * run->up[i];
        down += def->gravity[i] * run->down[i];
    }
    NEAR(square[0], 1, 1e-12);
    NEAR(square[1], 1, 1e-12);
    NEAR(across, 0, 1e-6);
    assert_true(weight < 0 && down >= -1e-9);
    for (int i = 0; i < 3; i++) /* gravity has no other component */
        NEAR(weight * run->up[i] + (down > 1e-6 ? down * run->down[i] : 0), def->gravity[i], 1e-9);
    if (down <= 1e-6)
        assert_true(run->down[0] == 1 && run->down[1] == 0 && run->down[2] == 0);
    const double *normal = def->walls.plane[0].normal;
    for (int i = 0; i < 3; i++)
        assert_true(normal[i] * run->up[i] >= 0);
}

/* Step, number of particles, what the run remembers, and the seed of the vibrators. */
static void observe(const rheo_world *world, const cli_trial *run, double *column)
{
    const rheo_world_def *def = rheo_world_definition(world);
    if (rheo_world_step_count(world) == 0) {
        check_cells(world, run);
        check_directions(world, run);
        rheo_body ball;
        if (rheo_world_body(world, 0, &ball) == RHEO_OK)
            NEAR(run->surface, ball.position[1] - ball.radius - 0.75, 1e-6);
        else
            assert_true(isnan(run->surface));
        seen.checked = true;
    }
    run->memory[0] += 1; /* it begins with 0 */
    column[0] = (double)rheo_world_step_count(world);
    column[1] = def->fluid.stiffness;
    column[2] = run->memory[0];
    column[3] = (double)def->vibrators.seed;
    memset(run->scratch, 1, rheo_world_particle_count(world));
}

static void measure(const cli_series *s, double *figure)
{
    figure[0] = s->value[1];
    figure[1] = s->value[3];
    seen.measured++;
}

static void sum_up(const cli_result *r, uint32_t seed, double *whole)
{
    assert_int_equal(r->finished, (seed + 1) * r->variants);
    whole[0] = 100 * seed + cli_figure_of(r, 0, 0, seed) + cli_figure_of(r, 1, 0, seed);
    seen.summed++;
}

double cli_figure_of(const cli_result *r, uint32_t variant, uint32_t figure, uint32_t seed)
{
    return r->figure[((size_t)variant * r->seeds + seed) * r->figures + figure];
}

static const cli_experiment HOLE = {
    .name = "made up",
    .scene = "hole",
    .set = {"settle.time=0", "fluid.stiffness=310"},
    .steps = 1,
    .small_set = {"fluid.stiffness=320"},
    .small_steps = 2,
    .variant = {{"as it is", {NULL}, NULL}, {"stiff", {"fluid.stiffness=330"}, NULL}},
    .column = {{"step", "1", ""}, {"stiffness", "1", ""}, {"memory", "1", ""}, {"seed", "1", ""}},
    .figure = {{"stiffness", "1", ""}, {"seed", "1", ""}},
    .memory = 1,
    .scratch = 1,
    .observe = observe,
    .measure = measure,
    .whole = {{"both", "1", ""}},
    .sum_up = sum_up,
    .claim = {{"stiffness", "stiff", CLI_AT_LEAST, .plus = 1}},
};

static cli_result run(const cli_experiment *e, const cli_list *set, bool small, uint32_t seeds)
{
    cli_result result;
    cli_progress progress = {.quiet = true};
    memset(&seen, 0, sizeof seen);
    assert_int_equal(cli_experiment_run(e, &(cli_experiment_options){.small = small, .seeds = seeds, .set = set},
                                        &progress, &result),
                     0);
    assert_true(seen.checked);
    return result;
}

static void each_run_has_its_settings_seed_and_place(void **state)
{
    (void)state;
    const cli_list none = {.count = 0};
    for (int small = 0; small < 2; small++) {
        cli_result r = run(&HOLE, &none, small, 2);
        const uint64_t steps = small ? 2 : 1;
        assert_true(r.variants == 2 && r.columns == 4 && r.figures == 2 && r.wholes == 1 && r.claims == 1);
        assert_true(r.seeds == 2 && r.steps == steps && r.finished == 4 && seen.measured == 4 && seen.summed == 2);
        for (uint32_t variant = 0; variant < 2; variant++)
            for (uint32_t seed = 0; seed < 2; seed++) {
                const cli_series *s = &r.series[variant * 2 + seed];
                const double stiffness = variant ? 330 : small ? 320 : 310;
                assert_true(s->rows == steps + 1 && s->columns == 4);
                for (uint64_t row = 0; row <= steps; row++) {
                    assert_true(s->value[4 * row] == (double)row && s->value[4 * row + 1] == stiffness);
                    assert_true(s->value[4 * row + 2] == (double)(row + 1));
                    assert_true(s->value[4 * row + 3] == r.series[0].value[3] + seed);
                    NEAR(s->time[row], (double)row * s->time[1], 1e-12);
                    assert_true(s->time[1] > 0);
                }
                assert_true(cli_figure_of(&r, variant, 0, seed) == stiffness);
                assert_true(cli_figure_of(&r, variant, 1, seed) == s->value[3]);
            }
        assert_true(r.whole[0] == (small ? 650 : 640) && r.whole[1] == (small ? 750 : 740));
        cli_experiment_release(&r);
        assert_true(!r.series && !r.figure);
    }
}

/* The layer has a hole; a pool has none. */
static void bare_cells_are_those_of_the_hole(void **state)
{
    (void)state;
    const cli_list none = {.count = 0};
    cli_experiment e = HOLE;
    cli_result r = run(&e, &none, false, 1);
    assert_true(seen.bare_cells > 20);
    cli_experiment_release(&r);
    e.scene = "bowling-ball-small";
    e.set[2] = "ball.clearance=0.75";
    r = run(&e, &none, false, 1);
    assert_int_equal(seen.bare_cells, 0);
    cli_experiment_release(&r);
    e.scene = "incline";
    e.set[2] = NULL;
    r = run(&e, &none, false, 1);
    cli_experiment_release(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_run_has_its_settings_seed_and_place),
        cmocka_unit_test(bare_cells_are_those_of_the_hole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
