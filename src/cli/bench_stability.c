/*
 * rheolog bench stability: a map of stable and unstable runs over the step, the ratio k_hist/k_min and the solver. A ball
 * falls into a small pool; all runs start from one settled state. A run is unstable if
 *
 *     a step fails, a severe measure of the doctor leaves its range, or the ball rises above the height from which it fell.
 *
 * The last is for springs that do no harm to the step and yet make energy from nothing. A run ends with its first sign.
 */
#include "cli/bench_stability.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/fall.h"
#include "cli/steps.h"

/* Fall from the settled surface, L, as far as the ball's radius; window of the history, T. */
static const double CLEARANCE = 8, WINDOW = 4.95;
/* How far the ball may rise above its start, in radii: rounding. */
static const double MARGIN = 0.01;

static const cli_stability_solver SOLVERS[] = {
    {"default", {{"scheme", "summed"}}},
    {"passive", {{"scheme", "summed"}, {"history.hardening", "passive"}, {"max_substeps", "128"}}},
    {"unsoftened", {{"scheme", "summed"}, {"max_substeps", "1000"}}},
    {"substeps-2", {{"scheme", "summed"}, {"substeps", "2"}}},
    {"algorithm-1", {{"scheme", "sequential"}, {"history.onset", "0"}}},
    {"implicit", {{"scheme", "sequential"}, {"springs.solver", "implicit"}, {"history.onset", "0"}}},
    {"positions", {{"scheme", "positions"}}},
};
enum { ALL = sizeof SOLVERS / sizeof *SOLVERS };

static const char STEP_SIZES[] = "0.00825,0.0165,0.033,0.066", RATIOS[] = "1,5,10,20,50,100,1000,10000",
                  STIFFNESS[] = "37.5"; /* of the limit that the paper states */

void cli_stability_settings(const cli_stability_solver *solver, char *text, size_t size)
{
    size_t n = 0;
    text[0] = 0;
    for (int k = 0; k < 3 && solver->set[k][0] && n < size; k++)
        n += (size_t)snprintf(text + n, size - n, "%s%s=%s", k ? " " : "", solver->set[k][0], solver->set[k][1]);
}

/* ---- Arguments ---- */

/* Reads the next word of a list; false at its end. A word that is too long is "", which is no number and no name. */
static bool next_word(const char **at, char word[32])
{
    const size_t length = strcspn(*at, ",");
    if (!**at)
        return false;
    snprintf(word, 32, "%.*s", length < 32 ? (int)length : 0, *at);
    *at += length + ((*at)[length] == ',' && (*at)[length + 1]);
    return true;
}

static int read_numbers(const char *option, const char *text, double most, double *number, uint32_t *count)
{
    char word[32];
    if (!*text)
        return cli_usage(&cli_bench, "%s needs numbers with commas between", option);
    for (*count = 0; next_word(&text, word); ++*count) {
        if (*count == CLI_STABILITY_MOST)
            return cli_usage(&cli_bench, "%s has more than %d numbers", option, CLI_STABILITY_MOST);
        const int status = cli_read_number(&cli_bench, option, word, 0, most, true, &number[*count]);
        if (status != CLI_DONE)
            return status;
    }
    return CLI_DONE;
}

static int read_solvers(const char *text, cli_stability_map *map)
{
    char word[32];
    for (uint32_t k = 0; !text && k < ALL; k++)
        map->solver[map->solvers++] = &SOLVERS[k];
    while (text && next_word(&text, word)) {
        uint32_t k = 0;
        while (k < ALL && strcmp(SOLVERS[k].name, word) != 0)
            k++;
        if (k == ALL)
            return cli_usage(
                &cli_bench,
                "there is no solver \"%s\"; there are default, passive, unsoftened, substeps-2, algorithm-1, "
                "implicit and positions",
                word);
        if (map->solvers == CLI_STABILITY_MOST)
            return cli_usage(&cli_bench, "--solvers has more than %d names", CLI_STABILITY_MOST);
        map->solver[map->solvers++] = &SOLVERS[k];
    }
    return map->solvers ? CLI_DONE : cli_usage(&cli_bench, "--solvers needs names of solvers with commas between");
}

static int read_arguments(const cli_bench_arguments *a, cli_stability_map *map)
{
    int status = cli_read_number(&cli_bench, "--stiffness", a->stiffness ? a->stiffness : STIFFNESS, 0, 1e12, true,
                                 &map->stiffness);
    if (status == CLI_DONE)
        status = read_numbers("--step-sizes", a->step_sizes ? a->step_sizes : STEP_SIZES, 10, map->step, &map->steps);
    if (status == CLI_DONE)
        status = read_numbers("--ratios", a->ratios ? a->ratios : RATIOS, 1e12, map->ratio, &map->ratios);
    return status == CLI_DONE ? read_solvers(a->solvers, map) : status;
}

/* ---- The settled state ---- */

typedef struct settled {
    rheo_world_def def;
    double surface;
    rheo_real *position, *velocity;
} settled;

/* Springs begin in the first step, at their lengths, as those of a settled fluid are. */
static rheo_result settle(settled *s, rheo_scene *scene, const cli_bench_arguments *a, rheo_error *error)
{
    rheo_world *world;
    scene->ball.clearance = CLEARANCE;
    if (a->settle.given)
        scene->settle.time = (double)a->settle.value * scene->world.step;
    const rheo_result result = rheo_scene_create_world(scene, &world, error);
    if (result != RHEO_OK)
        return result;
    const rheo_world_def *def = rheo_world_definition(world);
    const uint32_t particles = rheo_world_particle_count(world);
    const size_t bytes = 3 * (size_t)particles * sizeof *s->position;
    s->def = scene->world;
    s->def.fluid.number_density = def->fluid.number_density;
    memcpy(s->def.ball.position, def->ball.position, sizeof s->def.ball.position);
    s->surface = def->ball.position[1] - def->ball.radius - CLEARANCE;
    s->position = malloc(bytes + 1);
    s->velocity = malloc(bytes + 1);
    const bool enough = s->position && s->velocity;
    if (enough) {
        memcpy(s->position, rheo_world_positions(world), bytes);
        memcpy(s->velocity, rheo_world_velocities(world), bytes);
    } else {
        snprintf(error->message, sizeof error->message, "no memory for %u settled particles", particles);
    }
    s->def.particles.count = particles;
    s->def.particles.position = s->position;
    s->def.particles.velocity = s->velocity;
    rheo_world_destroy(world);
    return enough ? RHEO_OK : RHEO_ERROR_MEMORY;
}

/* ---- Runs ---- */

/* A metric of springs; NaN in a scheme without springs. */
static double metric_of_springs(const rheo_world *world, const char *name)
{
    return rheo_world_definition(world)->scheme == RHEO_SCHEME_POSITIONS ? (double)NAN : cli_metric(world, name);
}

/* Steps a world until its time is over or its first sign comes. depth has room for the steps and the first state. */
static rheo_result watch(rheo_world *world, rheo_health *health, const settled *from, uint64_t steps, double *depth,
                         double *time, cli_stability_cell *c, rheo_error *error)
{
    const double radius = from->def.ball.radius;
    double seconds = 0;
    for (c->steps = 0;; c->steps++) {
        rheo_body ball;
        rheo_finding finding;
        rheo_failure failure;
        rheo_world_body(world, 0, &ball);
        depth[c->steps] = (from->surface - ball.position[1] + radius) / radius;
        time[c->steps] = rheo_world_time(world);
        if (c->steps && rheo_health_step(health, &finding))
            snprintf(c->sign, sizeof c->sign, "%s", finding.measure);
        else if (ball.position[1] > from->def.ball.position[1] + MARGIN * radius)
            snprintf(c->sign, sizeof c->sign, "ball_height");
        if (c->sign[0] || c->steps == steps) {
            c->bad_step = c->sign[0] ? c->steps : 0;
            break;
        }
        const double start = cli_processor_time();
        const rheo_result result = rheo_world_step(world, error);
        seconds += cli_processor_time() - start;
        if (result != RHEO_OK && !rheo_world_failure(world, &failure))
            return result;
        if (result != RHEO_OK) {
            c->bad_step = c->steps + 1;
            snprintf(c->sign, sizeof c->sign, "failed step");
            break;
        }
        c->kappa = fmax(c->kappa, metric_of_springs(world, "stiffness_number"));
        c->kappa_sum = fmax(c->kappa_sum, metric_of_springs(world, "stiffness_sum"));
        c->softened = fmax(c->softened, metric_of_springs(world, "softened_springs"));
        c->substeps += fmax(1, cli_bench_substeps(world));
    }
    c->stable = !c->sign[0];
    c->ns = c->steps ? 1e9 * seconds / ((double)c->steps * rheo_world_particle_count(world)) : (double)NAN;
    c->substeps /= (double)c->steps;
    c->hash = rheo_world_hash(world);
    return RHEO_OK;
}

static rheo_result run_cell(const cli_stability_map *map, const settled *from, cli_stability_cell *c,
                            rheo_error *error)
{
    rheo_world_def def = from->def;
    def.step = c->step;
    def.history.window_seconds = WINDOW;
    def.springs.stiffness = map->stiffness;
    def.history.stiffness = c->ratio * map->stiffness;
    for (int k = 0; k < 3 && c->solver->set[k][0]; k++) {
        const rheo_result result = rheo_world_def_set(&def, c->solver->set[k][0], c->solver->set[k][1], error);
        if (result != RHEO_OK)
            return result;
    }
    const double needed = ceil(map->time / c->step);
    const bool fits = needed < (double)(SIZE_MAX / (4 * sizeof(double)));
    const uint64_t steps = fits ? (uint64_t)needed : 0;
    double *depth = NULL;
    rheo_world *world = NULL;
    rheo_health *health = NULL;
    rheo_result result = rheo_world_create(&def, &world, error);
    if (result == RHEO_OK)
        result = rheo_health_open(world, &health, error);
    if (result == RHEO_OK && fits)
        depth = malloc(2 * (size_t)(steps + 1) * sizeof *depth);
    if (result == RHEO_OK && !depth) {
        snprintf(error->message, sizeof error->message, "no memory for the depths of %.0f steps", needed);
        result = RHEO_ERROR_MEMORY;
    }
    if (result == RHEO_OK)
        result = watch(world, health, from, steps, depth, depth + steps + 1, c, error);
    if (result == RHEO_OK && c->stable) {
        const cli_depths depths = {(size_t)c->steps + 1, 1, depth, depth + steps + 1};
        const cli_fall fall = cli_fall_of(&depths);
        c->dip = fall.sinks ? (double)NAN : depth[fall.dip];
        c->rise = fall.rise;
    }
    rheo_health_close(health);
    if (world)
        rheo_world_destroy(world);
    free(depth);
    return result;
}

static int run_all(cli_stability_map *map, const settled *from, cli_bench_arguments *a)
{
    rheo_error error = {""};
    const size_t count = (size_t)map->solvers * map->steps * map->ratios;
    for (size_t i = 0; i < count; i++) {
        cli_stability_cell *c = &map->cell[i];
        *c = (cli_stability_cell){.solver = map->solver[i / map->ratios / map->steps],
                                  .step = map->step[i / map->ratios % map->steps],
                                  .ratio = map->ratio[i % map->ratios],
                                  .kappa = NAN,
                                  .kappa_sum = NAN,
                                  .softened = NAN,
                                  .dip = NAN,
                                  .rise = NAN};
        if (cli_progress_due(&a->progress, cli_now()))
            cli_progress_say(&a->progress, cli_now(), "%s, step %g, ratio %g (run %zu of %zu)", c->solver->name,
                             c->step, c->ratio, i + 1, count);
        const rheo_result result = run_cell(map, from, c, &error);
        if (result != RHEO_OK) {
            cli_progress_end(&a->progress);
            return cli_error(result, &error);
        }
    }
    cli_progress_end(&a->progress);
    return CLI_DONE;
}

static int settle_and_run(cli_stability_map *map, cli_bench_arguments *a)
{
    cli_bench_cases cases = {0};
    cli_bench_case *pool = cli_bench_add(&cases, "bowling-ball-small", a->particles);
    if (!pool)
        return cli_bench_no_memory(&cases);
    rheo_error error = {""};
    settled from = {.surface = 0};
    pool->scene.world.springs.stiffness = map->stiffness;
    map->time = (double)a->steps * pool->scene.world.step;
    const rheo_result result = settle(&from, &pool->scene, a, &error);
    map->particles = from.def.particles.count;
    const int status = result == RHEO_OK ? run_all(map, &from, a) : cli_error(result, &error);
    free(from.position);
    free(from.velocity);
    cli_bench_release(&cases);
    return status;
}

int cli_bench_run_stability(cli_bench_arguments *a)
{
    cli_stability_map map = {0};
    int status = read_arguments(a, &map);
    if (status == CLI_DONE && a->folder && (status = cli_make_folder(a->folder)) == CLI_DONE)
        status = cli_stability_check_files(a->folder);
    if (status != CLI_DONE)
        return status;
    map.cell = malloc((size_t)map.solvers * map.steps * map.ratios * sizeof *map.cell);
    if (!map.cell)
        return cli_fail(CLI_SYSTEM, "no memory for the map");
    status = settle_and_run(&map, a);
    if (status == CLI_DONE && (a->csv || a->json))
        cli_stability_rows(&map, &(cli_bench_table){.json = a->json});
    else if (status == CLI_DONE)
        cli_stability_print(&map);
    if (status == CLI_DONE && a->folder)
        status = cli_stability_write(&map, a->folder);
    free(map.cell);
    return status;
}
