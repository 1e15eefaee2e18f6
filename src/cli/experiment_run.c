/* Runs the variants of an experiment and keeps what they measure. */
#include "cli/experiment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- One run ---- */

bool cli_cell_of(const cli_trial *b, const rheo_real position[3], uint32_t cell[2])
{
    for (int i = 0; i < 2; i++) {
        const double at = ((double)position[2 * i] - b->corner[i]) / b->cell;
        if (!(at >= 0 && at < CLI_CELLS))
            return false;
        cell[i] = (uint32_t)at;
    }
    return true;
}

/* Marks the cells between those of the fluid that are bare, as are their neighbours. */
static void find_bare_cells(const rheo_world *world, cli_trial *b)
{
    static bool fluid[CLI_CELLS][CLI_CELLS];
    const rheo_real *position = rheo_world_positions(world);
    const uint32_t count = rheo_world_particle_count(world);
    uint32_t cell[2], most[2] = {0, 0};
    b->cell = rheo_world_definition(world)->fluid.spacing;
    for (int i = 0; i < 2; i++) {
        b->corner[i] = INFINITY;
        for (uint32_t k = 0; k < count; k++)
            b->corner[i] = fmin(b->corner[i], (double)position[3 * (size_t)k + 2 * i]);
        b->corner[i] -= b->cell / 2; /* the wall */
    }
    memset(fluid, 0, sizeof fluid);
    for (uint32_t k = 0; k < count; k++)
        if (cli_cell_of(b, position + 3 * (size_t)k, cell)) {
            fluid[cell[0]][cell[1]] = true;
            most[0] = cell[0] > most[0] ? cell[0] : most[0];
            most[1] = cell[1] > most[1] ? cell[1] : most[1];
        }
    for (uint32_t i = 1; i < most[0]; i++)
        for (uint32_t j = 1; j < most[1]; j++) {
            b->bare[i][j] = true;
            for (uint32_t k = 0; k < 9; k++)
                b->bare[i][j] = b->bare[i][j] && !fluid[i + k / 3 - 1][j + k % 3 - 1];
            b->bare_cells += b->bare[i][j];
        }
}

static void begin_at(const rheo_scene *scene, const rheo_world *world, cli_trial *run)
{
    const rheo_world_def *def = rheo_world_definition(world);
    rheo_body ball;
    *run = (cli_trial){.surface = NAN, .up = {0, 1, 0}};
    if (rheo_world_body(world, 0, &ball) == RHEO_OK)
        run->surface = ball.position[1] - ball.radius - scene->ball.clearance;
    if (def->walls.count)
        memcpy(run->up, def->walls.plane[0].normal, sizeof run->up);
    double *up = run->up, *down = run->down, length = 0, along = 0;
    for (int i = 0; i < 3; i++) {
        length += up[i] * up[i];
        along += up[i] * def->gravity[i];
    }
    for (int i = 0; i < 3; i++) {
        down[i] = def->gravity[i] - along / length * up[i];
        up[i] /= sqrt(length);
    }
    length = sqrt(down[0] * down[0] + down[1] * down[1] + down[2] * down[2]);
    for (int i = 0; i < 3; i++)
        down[i] = length > 1e-6 ? down[i] / length : i == 0;
    find_bare_cells(world, run);
}

static rheo_result record_steps(const cli_result *r, rheo_world *world, const cli_trial *run, const char *name,
                                cli_series *series, cli_progress *progress, rheo_error *error)
{
    rheo_result result = RHEO_OK;
    for (uint64_t i = 0; i <= r->steps; i++) {
        if (i > 0 && (result = rheo_world_step(world, error)) != RHEO_OK)
            break;
        if (cli_interrupted()) {
            snprintf(error->message, sizeof error->message, "interrupted in step %llu", (unsigned long long)i);
            result = RHEO_ERROR_STOPPED;
            break;
        }
        const double now = cli_now();
        if (cli_progress_due(progress, now))
            cli_progress_say(progress, now, "%s: step %llu of %llu", name, (unsigned long long)i,
                             (unsigned long long)r->steps);
        series->time[series->rows] = rheo_world_time(world);
        r->experiment->observe(world, run, series->value + series->rows++ * series->columns);
    }
    cli_progress_end(progress);
    return result;
}

static rheo_result record(const cli_result *r, const rheo_scene *scene, const char *name, cli_series *series,
                          cli_progress *progress, rheo_error *error)
{
    rheo_world *world;
    rheo_result result = rheo_scene_create_world(scene, &world, error);
    if (result != RHEO_OK)
        return result;
    cli_trial *run = calloc(1, sizeof *run);
    double *memory = calloc(r->experiment->memory + 1, sizeof *memory);
    void *scratch = calloc((size_t)rheo_world_particle_count(world) + 1, r->experiment->scratch + 1);
    if (run && memory && scratch) {
        begin_at(scene, world, run);
        run->memory = memory;
        run->scratch = scratch;
        result = record_steps(r, world, run, name, series, progress, error);
    } else {
        snprintf(error->message, sizeof error->message, "no memory for what is measured");
        result = RHEO_ERROR_MEMORY;
    }
    free(scratch);
    free(memory);
    free(run);
    rheo_world_destroy(world);
    return result;
}

/* Sets parameters from assignments. */
static rheo_result set_all(rheo_scene *scene, const char *const *set, size_t count, rheo_error *error)
{
    for (size_t k = 0; k < count && set[k]; k++) {
        char path[128];
        const size_t length = strcspn(set[k], "=");
        snprintf(path, sizeof path, "%.*s", (int)length, set[k]);
        const rheo_result result = rheo_scene_set(scene, path, set[k] + length + 1, error);
        if (result != RHEO_OK)
            return result;
    }
    return RHEO_OK;
}

static rheo_result run_one(const cli_result *r, uint32_t variant, uint32_t seed, cli_series *series,
                           cli_progress *progress, rheo_error *error)
{
    const cli_experiment *e = r->experiment;
    rheo_scene scene;
    const char *own = e->variant[variant].scene, *builtin = own ? own : e->scene;
    rheo_result result = rheo_scene_builtin(builtin, &scene, error);
    if (result != RHEO_OK)
        return result;
    if (result == RHEO_OK)
        result = set_all(&scene, e->set, CLI_MOST_SETTINGS, error);
    if (result == RHEO_OK && r->small)
        result = set_all(&scene, e->small_set, CLI_MOST_SETTINGS, error);
    if (result == RHEO_OK)
        result = set_all(&scene, r->set->item, r->set->count, error);
    if (result == RHEO_OK)
        result = set_all(&scene, e->variant[variant].set, CLI_MOST_SETTINGS, error);
    for (size_t i = 0; result == RHEO_OK && seed > 0 && e->jitter > 0 && i < scene.fill_count; i++)
        scene.owned.fill[i].jitter = e->jitter;
    scene.seed += seed;
    scene.world.vibrators.seed += seed;
    *series = (cli_series){.columns = r->columns,
                           .value = malloc(((size_t)r->steps + 1) * r->columns * sizeof(double)),
                           .time = malloc(((size_t)r->steps + 1) * sizeof(double))};
    if (result == RHEO_OK && (!series->value || !series->time)) {
        snprintf(error->message, sizeof error->message, "no memory for the results of %llu steps",
                 (unsigned long long)r->steps);
        result = RHEO_ERROR_MEMORY;
    }
    char name[96];
    snprintf(name, sizeof name, "%s, %s, seed %llu", e->name, e->variant[variant].name,
             (unsigned long long)scene.seed);
    cli_watch_name(name);
    if (result == RHEO_OK)
        result = record(r, &scene, name, series, progress, error);
    cli_watch_name(NULL);
    rheo_scene_release(&scene);
    return result;
}

/* ---- All runs ---- */

static uint32_t count_quantities(const cli_quantity *quantity, uint32_t most)
{
    uint32_t count = 0;
    while (count < most && quantity[count].name)
        count++;
    return count;
}

int cli_experiment_run(const cli_experiment *e, const cli_experiment_options *options, cli_progress *progress,
                       cli_result *result)
{
    const uint32_t seeds = options->seeds;
    *result = (cli_result){.experiment = e,
                           .set = options->set,
                           .small = options->small,
                           .seeds = seeds,
                           .steps = options->small ? e->small_steps : e->steps,
                           .columns = count_quantities(e->column, CLI_MOST_COLUMNS),
                           .figures = count_quantities(e->figure, CLI_MOST_FIGURES),
                           .wholes = count_quantities(e->whole, CLI_MOST_FIGURES)};
    while (result->variants < CLI_MOST_VARIANTS && e->variant[result->variants].name)
        result->variants++;
    while (result->claims < CLI_MOST_CLAIMS && e->claim[result->claims].figure)
        result->claims++;
    const size_t runs = (size_t)result->variants * seeds;
    result->series = calloc(runs, sizeof *result->series);
    result->figure = calloc(runs * result->figures, sizeof *result->figure);
    result->whole = calloc((size_t)seeds * result->wholes + 1, sizeof *result->whole);
    if (!result->series || !result->figure || !result->whole)
        return cli_fail(CLI_SYSTEM, "no memory for the results of %zu runs", runs);
    for (uint32_t seed = 0; seed < seeds; seed++)
        for (uint32_t variant = 0; variant < result->variants; variant++) {
            const size_t run = (size_t)variant * seeds + seed;
            rheo_error error = {""};
            const rheo_result ended = run_one(result, variant, seed, &result->series[run], progress, &error);
            if (ended != RHEO_OK)
                return cli_fail(cli_code(ended), "%s, %s: %s", e->name, e->variant[variant].name, error.message);
            e->measure(&result->series[run], result->figure + run * result->figures);
            result->finished++;
            if (variant + 1 == result->variants && e->sum_up)
                e->sum_up(result, seed, result->whole + (size_t)seed * result->wholes);
        }
    return CLI_DONE;
}

void cli_experiment_release(cli_result *result)
{
    for (size_t i = 0; result->series && i < (size_t)result->variants * result->seeds; i++) {
        free(result->series[i].value);
        free(result->series[i].time);
    }
    free(result->series);
    free(result->figure);
    free(result->whole);
    *result = (cli_result){0};
}
