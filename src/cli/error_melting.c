/* Runs the settings of a case of the melting model in turn, for the studies of `rheolog bench error`. */
#include "cli/error_melting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

uint32_t cli_melt_layers(const cli_melt_case *c, const cli_melt_setting *s)
{
    return s->layers ? s->layers : c->layers;
}

int cli_melt_set(const cli_melt_setting *s, rheo_world_def *def)
{
    for (int i = 0; i < CLI_MELT_SETS && s->set[i]; i++) {
        char key[64];
        const char *value = NULL;
        rheo_error error = {""};
        const int status = cli_split_setting(&cli_bench, s->set[i], key, sizeof key, &value);
        if (status != CLI_DONE)
            return status;
        const rheo_result result = rheo_world_def_set(def, key, value, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
    }
    return CLI_DONE;
}

uint64_t cli_melt_steps_until(const cli_bench_arguments *a, double time, double step)
{
    const uint64_t steps = (uint64_t)floor(time / step + 0.5);
    return a->steps && a->steps < steps ? a->steps : steps;
}

int cli_melt_step(cli_melt_run *r, rheo_world *world, uint64_t steps)
{
    rheo_error error = {""};
    rheo_result result = RHEO_OK;
    for (uint64_t step = 0; step < steps && !r->failed && result == RHEO_OK; step++) {
        const double start = cli_processor_time();
        result = rheo_world_step(world, &error);
        r->seconds += cli_processor_time() - start;
        r->time += rheo_world_definition(world)->step;
        r->substeps += cli_metric(world, "substeps");
        r->iterations += cli_metric(world, "iterations");
        r->timed++;
    }
    if (result == RHEO_ERROR_STATE)
        r->failed = true;
    return result == RHEO_OK || result == RHEO_ERROR_STATE ? CLI_DONE : cli_error(result, &error);
}

void cli_melt_finish(cli_melt_run *r, const rheo_world *world)
{
    r->particles = rheo_world_particle_count(world);
    r->steps = rheo_world_step_count(world);
    r->hash = r->failed ? 0 : rheo_world_hash(world);
}

void cli_melt_value(cli_melt_run *r, int quantity, double value, double reference)
{
    r->value[quantity] = value;
    r->reference[quantity] = reference;
    r->error[quantity] = value / reference - 1;
}

/* ---- Particles ---- */

/* Uniform from -1 to 1. */
static double random_number(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return 2 * ((double)(*state >> 11) / 9007199254740992.0) - 1;
}

bool cli_melt_block(cli_melt_body *b, double spacing, const uint32_t size[3], double jitter, uint32_t copies)
{
    const uint32_t count = size[0] * size[1] * size[2];
    const size_t room = (size_t)count * copies;
    *b = (cli_melt_body){count, calloc(3 * room, sizeof *b->position), calloc(3 * room, sizeof *b->velocity),
                         malloc(room * sizeof *b->density), calloc(room, sizeof *b->temperature)};
    if (!b->position || !b->velocity || !b->density || !b->temperature) {
        cli_melt_release(b);
        return false;
    }
    uint64_t random = 1;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t place[3] = {i % size[0], i / size[0] % size[1], i / size[0] / size[1]};
        for (int axis = 0; axis < 3; axis++)
            b->position[3 * i + (uint32_t)axis] =
                (rheo_real)(spacing * (place[axis] + 0.5 + (jitter > 0 ? jitter * random_number(&random) : 0)));
    }
    for (size_t i = 0; i < room; i++)
        b->density[i] = 1;
    return true;
}

void cli_melt_release(cli_melt_body *b)
{
    free(b->position);
    free(b->velocity);
    free(b->density);
    free(b->temperature);
    *b = (cli_melt_body){0};
}

void cli_melt_use(const cli_melt_body *b, rheo_world_def *def)
{
    def->particles.count = b->count;
    def->particles.position = b->position;
    def->particles.velocity = b->velocity;
    def->particles.density = b->density;
    def->particles.temperature = NULL;
}

bool cli_melt_read(const rheo_world *world, const char *field, rheo_real *values, size_t bytes)
{
    rheo_field_info info;
    for (uint32_t i = 0; rheo_world_field(world, i, &info) == RHEO_OK; i++)
        if (strcmp(info.name, field) == 0)
            return rheo_world_field_read(world, i, values, bytes) == RHEO_OK;
    return false;
}

/* ---- All settings ---- */

static void forget(cli_melt_run *run, size_t count)
{
    for (size_t i = 0; run && i < count; i++)
        free(run[i].position);
    free(run);
}

static cli_melt_run no_run(void)
{
    cli_melt_run r = {.failed = false};
    for (int q = 0; q < CLI_MELT_QUANTITIES; q++)
        r.value[q] = r.reference[q] = r.error[q] = NAN;
    return r;
}

/* Particles of the default spacing, or of the first run. */
static uint32_t default_particles(const cli_melt_case *c, const cli_melt_run *run)
{
    for (size_t i = 0; i < c->settings; i++)
        if (cli_melt_layers(c, &c->setting[i]) == c->layers)
            return run[i].particles;
    return run[0].particles;
}

static int add_points(const cli_melt_case *c, const cli_melt_run *run, const double *seconds,
                      cli_error_points *points)
{
    const uint32_t particles = default_particles(c, run);
    for (size_t i = 0; i < c->settings; i++) {
        const cli_melt_run *r = &run[i];
        const cli_melt_setting *s = &c->setting[i];
        cli_error_point p = cli_error_no_point();
        snprintf(p.scene, sizeof p.scene, "%s", c->scene);
        snprintf(p.setting, sizeof p.setting, "%s", s->name);
        if (s->series)
            snprintf(p.series, sizeof p.series, "%s", s->series);
        p.refinement = s->refinement;
        if (!r->failed && r->timed) {
            p.ns_step = 1e9 * seconds[i] / ((double)r->timed * r->particles);
            p.us_time = 1e6 * seconds[i] / (r->time * particles);
            p.iterations = r->iterations / r->substeps;
            p.substeps = r->substeps * (double)r->steps / (double)r->timed;
        }
        p.particles = r->particles;
        p.steps = r->steps;
        p.hash = r->hash;
        for (int q = 0; q < CLI_MELT_QUANTITIES && c->quantity[q]; q++) {
            snprintf(p.quantity, sizeof p.quantity, "%s", c->quantity[q]);
            p.value = r->failed ? NAN : r->value[q];
            p.reference = r->reference[q];
            p.error = r->failed ? NAN : r->error[q];
            if (!cli_error_add(points, &p))
                return CLI_SYSTEM;
        }
    }
    return CLI_DONE;
}

int cli_melt_measure(const cli_melt_case *c, cli_bench_arguments *a, cli_error_points *points)
{
    int status = CLI_DONE;
    if (!cli_case_wanted(a, c->scene))
        return status;
    cli_melt_run *run = calloc(c->settings, sizeof *run);
    double *seconds = calloc(c->settings * a->repetitions, sizeof *seconds),
           *median = calloc(c->settings, sizeof *median);
    if (!run || !seconds || !median)
        status = cli_fail(CLI_SYSTEM, "no memory for %zu settings of %s", c->settings, c->scene);
    for (uint32_t repetition = 0; repetition < a->repetitions; repetition++)
        for (size_t i = 0; i < c->settings && status == CLI_DONE; i++) {
            if (cli_progress_due(&a->progress, cli_now()))
                cli_progress_say(&a->progress, cli_now(), "%s, %s (%zu of %zu)", c->scene, c->setting[i].name, i + 1,
                                 c->settings);
            free(run[i].position);
            run[i] = no_run();
            status = c->run(c, &c->setting[i], a, &run[i]);
            seconds[i * a->repetitions + repetition] = run[i].seconds;
        }
    for (size_t i = 0; i < c->settings && status == CLI_DONE; i++) {
        median[i] = cli_bench_median(seconds + i * a->repetitions, a->repetitions);
        if (c->compare && !run[i].failed && !run[0].failed)
            c->compare(&run[i], &run[0]);
    }
    if (status == CLI_DONE)
        status = add_points(c, run, median, points);
    forget(run, c->settings);
    free(seconds);
    free(median);
    return status;
}
