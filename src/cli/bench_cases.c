/*
 * The cases of `rheolog bench`. Each case is created once and kept as a checkpoint in memory. The repetitions of all
 * cases are interleaved, so that disturbances of the machine affect all cases alike. Every repetition starts from the
 * same state and must end with the same hash, or the measurement fails.
 *
 * A few steps run before the clock starts, because the first step from a checkpoint does extra work.
 */
#include "cli/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WARM_UP = 8, VARIANT_STEPS = 4 };

/* ---- Scenes ---- */

/*
 * Makes a pool wider or narrower, so that it holds about `particles` particles. Walls, ball, vibrators and periods are
 * scaled too.
 */
static void resize_pool(rheo_scene *scene, uint64_t particles)
{
    rheo_fill *fill = &scene->owned.fill[0];
    const double spacing = scene->world.fluid.spacing;
    const double nx = fill->max[0] / spacing, ny = fill->max[1] / spacing, nz = fill->max[2] / spacing;
    const double wide = floor(nx * sqrt((double)particles / (nx * ny * nz)) + .5);
    const double deep = floor((double)particles / (wide * ny) + .5);
    const double scale[3] = {wide / nx, 1, deep / nz};
    for (int axis = 0; axis < 3; axis++) {
        fill->max[axis] *= scale[axis];
        for (uint32_t i = 0; i < scene->world.walls.count; i++)
            scene->owned.plane[i].point[axis] *= scale[axis];
        scene->world.ball.position[axis] *= scale[axis];
        scene->world.space.period[axis] *= scale[axis];
    }
    for (uint32_t i = 0; i < scene->world.vibrators.count; i++) {
        scene->owned.position[i][0] *= scale[0];
        scene->owned.position[i][1] *= scale[2];
    }
}

cli_bench_case *cli_bench_add(cli_bench_cases *cases, const char *scene, uint64_t particles)
{
    if (!cases->item)
        cases->item = calloc(CLI_BENCH_MAX_CASES, sizeof *cases->item);
    if (!cases->item || cases->count == CLI_BENCH_MAX_CASES)
        return NULL;
    cli_bench_case *c = &cases->item[cases->count++];
    snprintf(c->name, sizeof c->name, "%s", scene);
    c->error = NAN;
    c->warm_up = WARM_UP;
    if (rheo_scene_builtin(scene, &c->scene, NULL) != RHEO_OK) {
        cases->count--;
        return NULL;
    }
    uint64_t made;
    if (particles && rheo_scene_particle_count(&c->scene, &made, NULL) == RHEO_OK && particles != made)
        resize_pool(&c->scene, particles);
    cli_bench_set_window(c, c->scene.world.history.window);
    return c;
}

void cli_bench_set_window(cli_bench_case *c, uint32_t window)
{
    if (window)
        c->scene.world.history.window = window;
    else
        c->scene.world.history.stiffness = 0;
    c->window = window;
    c->lead = window + UINT64_C(1);
}

void cli_bench_release(cli_bench_cases *cases)
{
    for (uint32_t i = 0; i < cases->count; i++) {
        cli_bench_case *c = &cases->item[i];
        rheo_scene_release(&c->scene);
        free(c->state);
        free(c->total);
        free(c->rest);
        for (uint32_t s = 0; s < c->stages; s++)
            free(c->stage_ns[s]);
    }
    free(cases->item);
    *cases = (cli_bench_cases){0};
}

int cli_bench_no_memory(cli_bench_cases *cases)
{
    cli_bench_release(cases);
    return cli_fail(CLI_SYSTEM, "no memory for the cases");
}

/* ---- Initial states ---- */

static void describe(cli_bench_case *c, const rheo_world *world)
{
    char kind[96];
    c->particles = rheo_world_particle_count(world);
    if (c->window && rheo_world_def_get(rheo_world_definition(world), "history.kind", kind, sizeof kind) != RHEO_OK)
        snprintf(kind, sizeof kind, "window");
    snprintf(c->kind, sizeof c->kind, "%.31s", c->window ? kind : "");
    c->scheme[0] = 0;
    if (rheo_world_definition(world)->model == RHEO_MODEL_THICKENING)
        rheo_world_def_get(rheo_world_definition(world), "scheme", c->scheme, sizeof c->scheme);
    c->history_bytes = rheo_world_history_bytes(world);
    rheo_field_info info;
    for (uint32_t f = 0; rheo_world_field(world, f, &info) == RHEO_OK; f++) {
        c->field_bytes += (size_t)info.bytes;
        if (f < CLI_BENCH_MAX_FIELDS)
            snprintf(c->field[c->fields++], sizeof c->field[f], "%s", info.name);
    }
    rheo_stage_info stage;
    for (uint32_t s = 0; s < CLI_BENCH_MAX_STAGES && rheo_world_stage(world, s, &stage) == RHEO_OK; s++) {
        snprintf(c->stage[s], sizeof c->stage[s], "%s", stage.name);
        c->stages = s + 1;
    }
}

/* Runs the untimed steps that fill the window. */
static int lead_on(cli_bench_case *c, rheo_world *world, cli_bench_arguments *a, cli_bench_signals *s)
{
    rheo_error error = {""};
    for (uint64_t step = 0; step < c->lead; step++) {
        const rheo_result result = rheo_world_step(world, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
        if (c->with_error)
            cli_bench_take_signals(s, world);
        const double time = cli_now();
        if (cli_progress_due(&a->progress, time))
            cli_progress_say(&a->progress, time, "making %s, d = %u: step %llu of %llu", c->name, c->window,
                             (unsigned long long)step + 1, (unsigned long long)c->lead);
    }
    return CLI_DONE;
}

static int make_state(cli_bench_case *c, cli_bench_arguments *a)
{
    rheo_error error = {""};
    rheo_world *world;
    const size_t before = cli_bench_allocated(), memory = cli_bench_reset_peak_memory();
    c->scene.world.allocator = cli_bench_allocator();
    rheo_result result = rheo_scene_create_world(&c->scene, &world, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    cli_bench_signals s = {0};
    if (c->with_error && !cli_bench_begin_signals(&s, world, (size_t)c->lead)) {
        rheo_world_destroy(world);
        return cli_fail(CLI_SYSTEM, "no memory for the sampled velocities of %s", c->name);
    }
    int status = lead_on(c, world, a, &s);
    if (status == CLI_DONE) {
        const size_t peak = cli_bench_peak_memory();
        c->process_bytes = peak > memory ? peak - memory : 0;
        c->world_bytes = cli_bench_allocated() - before;
        describe(c, world);
        if (c->with_error)
            c->error = cli_bench_derivative_error(&s, world, c->kind);
        result = rheo_world_save_memory(world, c->name, &c->state, &c->state_size, &error);
        if (result != RHEO_OK)
            status = cli_error(result, &error);
    }
    free(s.velocity);
    rheo_world_destroy(world);
    return status;
}

/* ---- Timed runs ---- */

void cli_bench_end_run(cli_bench_run *run)
{
    rheo_recorder_close(run->recorder, NULL);
    rheo_world_destroy(run->world);
    rheo_recording_close(run->recording);
    *run = (cli_bench_run){0};
}

int cli_bench_begin_run(const cli_bench_case *c, uint64_t steps, cli_bench_run *run)
{
    *run = (cli_bench_run){0};
    rheo_error error = {""};
    rheo_result result = rheo_recording_open_memory(c->state, c->state_size, &run->recording, &error);
    if (result == RHEO_OK)
        result = rheo_recording_world(run->recording, rheo_recording_get_info(run->recording).first_step, NULL,
                                      &run->world, &error);
    for (uint64_t step = 0; result == RHEO_OK && step < steps; step++)
        result = rheo_world_step(run->world, &error);
    if (result == RHEO_OK)
        return CLI_DONE;
    cli_bench_end_run(run);
    return cli_error(result, &error);
}

static int same_hash(const cli_bench_case *c, const char *first, uint64_t expected, const char *other, uint64_t hash)
{
    if (hash == expected)
        return CLI_DONE;
    return cli_fail(CLI_DIFFERS,
                    "bench: %s with d = %u: %s ended with hash %016llx, %s with %016llx; both started from the same "
                    "state and must end with the same bits, so these times cannot be compared",
                    c->name, c->window, first, (unsigned long long)expected, other, (unsigned long long)hash);
}

/*
 * Runs a few steps with each SIMD variant of this machine. Uses the case with the most stages; if there are several,
 * the one with the smallest state.
 */
static int check_variants(const cli_bench_cases *cases)
{
    const cli_bench_case *c = &cases->item[0];
    for (uint32_t i = 1; i < cases->count; i++) {
        const cli_bench_case *other = &cases->item[i];
        if (other->stages > c->stages || (other->stages == c->stages && other->state_size < c->state_size))
            c = other;
    }
    char in_use[32];
    snprintf(in_use, sizeof in_use, "%s", rheo_simd());
    int status = CLI_DONE;
    uint64_t expected = 0;
    const char *first = rheo_simd_available(0), *name;
    for (uint32_t k = 0; status == CLI_DONE && (name = rheo_simd_available(k)) != NULL; k++) {
        cli_bench_run run;
        if ((status = cli_use_simd(name)) != CLI_DONE ||
            (status = cli_bench_begin_run(c, VARIANT_STEPS, &run)) != CLI_DONE)
            break;
        const uint64_t hash = rheo_world_hash(run.world);
        cli_bench_end_run(&run);
        expected = k ? expected : hash;
        char label[2][48];
        snprintf(label[0], sizeof label[0], "simd %s", first);
        snprintf(label[1], sizeof label[1], "simd %s", name);
        status = same_hash(c, label[0], expected, label[1], hash);
    }
    const int restored = cli_use_simd(in_use);
    return status == CLI_DONE ? restored : status;
}

double cli_bench_substeps(const rheo_world *world)
{
    rheo_field_info info;
    uint64_t count = 0;
    for (uint32_t i = 0; rheo_world_field(world, i, &info) == RHEO_OK; i++)
        if (strcmp(info.name, "substeps") == 0 && info.bytes == sizeof count)
            rheo_world_field_read(world, i, &count, sizeof count);
    return count ? (double)count : cli_metric(world, "substeps");
}

static int repeat(cli_bench_case *c, uint32_t repetition)
{
    cli_bench_run run;
    rheo_error error = {""};
    int status = cli_bench_begin_run(c, c->warm_up, &run);
    if (status != CLI_DONE)
        return status;
    rheo_world_reset_times(run.world);
    rheo_result result = c->recorded ? rheo_recorder_open_memory(run.world, NULL, &run.recorder, &error) : RHEO_OK;
    const uint64_t begun = run.recorder ? rheo_recorder_bytes(run.recorder) : 0;
    double substeps = 0, iterations = 0;
    const double start = cli_now();
    for (uint64_t step = 0; step < c->steps; step++) {
        if (result == RHEO_OK)
            result = run.recorder ? rheo_recorder_step(run.recorder, &error) : rheo_world_step(run.world, &error);
        if (result != RHEO_OK) {
            cli_bench_end_run(&run);
            return cli_error(result, &error);
        }
        substeps += cli_bench_substeps(run.world);
        iterations += cli_metric(run.world, "iterations");
    }
    const double seconds = cli_now() - start;
    const double scale = 1e9 / ((double)c->steps * (c->particles ? (double)c->particles : 1));
    c->total[repetition] = c->rest[repetition] = scale * seconds;
    for (uint32_t s = 0; s < c->stages; s++) {
        rheo_stage_info stage = {0};
        rheo_world_stage(run.world, s, &stage);
        c->stage_ns[s][repetition] = scale * stage.seconds;
        c->rest[repetition] -= scale * stage.seconds;
    }
    const uint64_t hash = rheo_world_hash(run.world);
    c->substeps = substeps / (double)c->steps;
    c->iterations = substeps > 0 ? iterations / substeps : 0;
    c->neighbours = rheo_world_mean_neighbours(run.world);
    if (run.recorder)
        c->recorded_bytes = (double)(rheo_recorder_bytes(run.recorder) - begun) / (double)c->steps;
    cli_bench_end_run(&run);
    c->hash = repetition ? c->hash : hash;
    char which[48];
    snprintf(which, sizeof which, "repetition %u", repetition + 1);
    c->repetitions = repetition + 1;
    return same_hash(c, "the first repetition", c->hash, which, hash);
}

static bool reserve(cli_bench_case *c, uint32_t repetitions)
{
    c->total = calloc(repetitions, sizeof *c->total);
    c->rest = calloc(repetitions, sizeof *c->rest);
    bool enough = c->total && c->rest;
    for (uint32_t s = 0; s < c->stages; s++) {
        c->stage_ns[s] = calloc(repetitions, sizeof *c->stage_ns[s]);
        enough = enough && c->stage_ns[s];
    }
    return enough;
}

int cli_bench_measure(cli_bench_cases *cases, cli_bench_arguments *a)
{
    int status = CLI_DONE;
    (void)cli_bench_pin();
    a->progress.last = cli_now();
    for (uint32_t i = 0; status == CLI_DONE && i < cases->count; i++) {
        cli_bench_case *c = &cases->item[i];
        c->steps = c->steps ? c->steps : a->steps;
        if (c->scene.world.model == RHEO_MODEL_THICKENING) {
            if (a->scheme)
                rheo_world_def_set(&c->scene.world, "scheme", a->scheme, NULL);
            if (a->settle.given)
                c->scene.settle.time = (double)a->settle.value * c->scene.world.step;
        }
        if (cli_progress_due(&a->progress, cli_now()))
            cli_progress_say(&a->progress, cli_now(), "making %s, d = %u (%u of %u)", c->name, c->window, i + 1,
                             cases->count);
        status = make_state(c, a);
        if (status == CLI_DONE && !reserve(c, a->repetitions))
            status = cli_fail(CLI_SYSTEM, "no memory for %u repetitions", a->repetitions);
    }
    if (status == CLI_DONE)
        status = check_variants(cases);
    for (uint32_t r = 0; status == CLI_DONE && r < a->repetitions; r++)
        for (uint32_t i = 0; status == CLI_DONE && i < cases->count; i++) {
            if (cli_progress_due(&a->progress, cli_now()))
                cli_progress_say(&a->progress, cli_now(), "repetition %u of %u: %s, d = %u (%u of %u)", r + 1,
                                 a->repetitions, cases->item[i].name, cases->item[i].window, i + 1, cases->count);
            status = repeat(&cases->item[i], r);
        }
    cli_progress_end(&a->progress);
    return status == CLI_DONE && a->trace ? cli_bench_trace(cases, a) : status;
}
