/*
 * A run of `rheolog bench predictor`: its verdict, and the measures of the doctor in every step. The verdict follows
 * from positions, velocities and temperatures alone. With the mass 1 of a particle, what was put in is
 *
 *   E = sum over the particles of (v^2/2 + g height + u) + M (V^2/2 + g height) of the ball + vibrators
 *   u = h k (rho - rho0)^2/8 + h k_near rho_near^2/12 (thickening), c^2 (rho/rho0 - 1)^2/2 (melting)
 *
 * in the first state: u is the energy of the pressures. Vibrators add as much as if each particle had twice their
 * speed. The fastest that anything can be is sqrt(2 e) of the particle with the most energy e, and twice the speed with
 * which the ball reaches the floor, and twice that of the vibrators.
 */
#include "cli/bench_predictor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const cli_predictor_reason_name[CLI_PREDICTOR_REASONS] = {"",      "failed", "energy",
                                                                      "speed", "left",   "temperature"};

static const double MOST_ENERGY = 10, MOST_SPEED = 3, MOST_TEMPERATURE = 0.1;

/* What the first state allows. */
typedef struct budget {
    double energy, speed;
    double coldest, hottest; /* NaN: no temperatures */
    double margin;           /* a support */
} budget;

static double length_of(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static bool has_temperatures(const rheo_world *world)
{
    return rheo_world_definition(world)->model == RHEO_MODEL_MELTING &&
           rheo_world_definition(world)->melting.diffusivity > 0;
}

/* Energy of the pressures of a particle, per mass. */
static double pressure_energy(const rheo_world_def *def, const rheo_particle_state *p)
{
    if (def->model == RHEO_MODEL_MELTING) {
        const double error = p->density / def->melting.rest_density - 1;
        return def->melting.sound_speed * def->melting.sound_speed * error * error / 2;
    }
    const double error = p->density - def->fluid.rest_density;
    return def->fluid.support * (def->fluid.stiffness * error * error / 8 +
                                 def->fluid.near_stiffness * p->near_density * p->near_density / 12);
}

static void find_budget(const rheo_world *world, const rheo_particle_state *particles, budget *b)
{
    const rheo_world_def *def = rheo_world_definition(world);
    const uint32_t count = rheo_world_particle_count(world);
    const double g = length_of(def->gravity);
    double most = 0;
    *b = (budget){.coldest = INFINITY, .hottest = -INFINITY};
    b->margin = def->model == RHEO_MODEL_MELTING ? 3 * def->fluid.spacing : def->fluid.support;
    for (uint32_t i = 0; i < count; i++) {
        const rheo_particle_state *p = &particles[i];
        const double energy = p->speed * p->speed / 2 + g * p->position[1] + pressure_energy(def, p);
        b->energy += energy;
        most = fmax(most, energy);
        b->coldest = fmin(b->coldest, p->temperature);
        b->hottest = fmax(b->hottest, p->temperature);
    }
    b->speed = sqrt(2 * most);
    rheo_body ball;
    if (rheo_world_body_count(world) && rheo_world_body(world, 0, &ball) == RHEO_OK) {
        const double speed = length_of(ball.velocity), energy = speed * speed / 2 + g * ball.position[1];
        b->energy += ball.mass * energy;
        b->speed += 2 * sqrt(2 * energy);
    }
    if (rheo_world_vibrator_count(world)) {
        const double speed =
            2 * 6.283185307179586 * def->vibrators.frequency * (1 + def->vibrators.spread) * def->vibrators.amplitude;
        b->energy += count * speed * speed / 2;
        b->speed += speed;
    }
}

static bool behind_wall(const rheo_world_def *def, const double position[3], double margin)
{
    for (uint32_t w = 0; w < def->walls.count; w++) {
        const rheo_wall *wall = &def->walls.plane[w];
        double distance = 0;
        for (int c = 0; c < 3; c++)
            distance += (position[c] - wall->point[c]) * wall->normal[c];
        if (distance / length_of(wall->normal) < -margin)
            return true;
    }
    return false;
}

/* The verdict on the present state. */
static cli_predictor_reason judge(const rheo_world *world, const budget *b, cli_predictor_run *run)
{
    const uint32_t count = rheo_world_particle_count(world);
    const rheo_real *x = rheo_world_positions(world), *v = rheo_world_velocities(world);
    double energy = 0, fastest = 0;
    bool left = false;
    for (uint32_t i = 0; i < count; i++) {
        const double at[3] = {(double)x[3 * (size_t)i], (double)x[3 * (size_t)i + 1], (double)x[3 * (size_t)i + 2]},
                     velocity[3] = {(double)v[3 * (size_t)i], (double)v[3 * (size_t)i + 1],
                                    (double)v[3 * (size_t)i + 2]},
                     speed = length_of(velocity);
        energy += speed * speed / 2;
        fastest = fmax(fastest, speed);
        left = left || behind_wall(rheo_world_definition(world), at, b->margin);
    }
    rheo_body ball;
    if (rheo_world_body_count(world) && rheo_world_body(world, 0, &ball) == RHEO_OK) {
        const double speed = length_of(ball.velocity);
        energy += ball.mass * speed * speed / 2;
        fastest = fmax(fastest, speed);
    }
    run->energy = fmax(run->energy, energy / b->energy);
    run->speed = fmax(run->speed, fastest / b->speed);
    if (energy > MOST_ENERGY * b->energy)
        return CLI_PREDICTOR_ENERGY;
    if (fastest > MOST_SPEED * b->speed)
        return CLI_PREDICTOR_SPEED;
    return left ? CLI_PREDICTOR_LEFT : CLI_PREDICTOR_WELL;
}

static bool too_hot(const rheo_particle_state *particles, uint32_t count, const budget *b)
{
    const double most = MOST_TEMPERATURE * (b->hottest - b->coldest) + 1e-5;
    for (uint32_t i = 0; i < count; i++)
        if (!(particles[i].temperature <= b->hottest + most && particles[i].temperature >= b->coldest - most))
            return true;
    return false;
}

/* ---- Measures ---- */

/* Numbers that are no measures of the doctor, with the bound that docs/stability.md states. */
static const struct {
    uint32_t group;
    const char *name, *metric, *meaning;
    double bound;
} STATED[] = {
    {CLI_PREDICTOR_SUMMED, "kappa_sum", "stiffness_sum", "substep^2 sum K: springs above it are softened", 2},
    {CLI_PREDICTOR_SEQUENTIAL, "kappa", "stiffness_number", "step^2 K of the stiffest spring, any solver", 4. / 3},
};

bool cli_predictor_in_range(const cli_predictor_value *value, const cli_predictor_measure *measure)
{
    return !value->measured || value->most <= measure->limit;
}

static void note(cli_predictor_run *run, cli_predictor_group_measures *all, uint32_t m,
                 const cli_predictor_measure *measure, double value, uint64_t step)
{
    cli_predictor_value *v = &run->measure[m];
    if (m == all->count) {
        all->item[m] = *measure;
        all->count++;
    }
    v->most = !v->measured || !(value <= v->most) ? value : v->most;
    v->measured = true;
    if (!(value <= measure->limit) && step < v->first)
        v->first = step;
}

/* A metric of the step that was examined last, which may be one that failed. */
static double metric_of(const rheo_world *world, const rheo_health *health, const char *name)
{
    for (uint32_t i = 0; i < rheo_world_metric_count(world); i++)
        if (strcmp(rheo_world_metric_name(world, i), name) == 0)
            return rheo_health_metric(health, i);
    return NAN;
}

static void note_measures(const rheo_world *world, const rheo_health *health, cli_predictor_run *run,
                          cli_predictor_group_measures *all, uint64_t step)
{
    rheo_measure m;
    uint32_t index = 0;
    for (; rheo_health_measure(health, index, &m); index++) {
        const cli_predictor_measure measure = {m.name, m.meaning, m.kind, m.limit, m.certain};
        if (index == all->count)
            all->item[all->count++] = measure;
        if (!m.measured)
            continue;
        note(run, all, index, &measure, m.value, step);
        if (!(m.value <= m.limit) && strcmp(m.kind, "notice") != 0 && step < run->sign)
            run->sign = step;
    }
    for (size_t i = 0; i < sizeof STATED / sizeof *STATED; i++)
        if (STATED[i].group == run->group && step > 0) {
            const cli_predictor_measure measure = {STATED[i].name, STATED[i].meaning, "bound", STATED[i].bound, NAN};
            note(run, all, index++, &measure, metric_of(world, health, STATED[i].metric), step);
        }
}

/* ---- The run ---- */

static bool has_parameter(const rheo_world_def *def, const char *path)
{
    const rheo_parameter *p;
    for (size_t i = 0; (p = rheo_world_def_parameter_at(def, i)) != NULL; i++)
        if (strcmp(p->path, path) == 0)
            return true;
    return false;
}

static void describe(const rheo_scene *scene, cli_predictor_run *run)
{
    const char *path;
    for (size_t i = 0; (path = cli_predictor_parameter(i)) != NULL; i++) {
        char text[96] = "";
        if (has_parameter(&scene->world, path) &&
            rheo_world_def_get(&scene->world, path, text, sizeof text) == RHEO_OK)
            snprintf(run->value[i], sizeof run->value[i], "%.31s", text);
    }
}

static int examine_world(rheo_world *world, cli_predictor_run *run, cli_predictor_group_measures *measures,
                         rheo_health *health, rheo_particle_state *particles)
{
    budget b;
    rheo_error error = {""};
    const uint32_t count = run->particles = rheo_world_particle_count(world);
    rheo_result result = rheo_world_particles(world, particles, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    find_budget(world, particles, &b);
    note_measures(world, health, run, measures, 0);
    for (uint64_t step = 1; step <= run->steps && run->reason == CLI_PREDICTOR_WELL; step++) {
        result = rheo_world_step(world, &error);
        if (result != RHEO_OK && result != RHEO_ERROR_STATE)
            return cli_error(result, &error);
        run->bad = step;
        if (rheo_health_step(health, NULL) && run->unhealthy == UINT64_MAX)
            run->unhealthy = step;
        note_measures(world, health, run, measures, step);
        if (result == RHEO_ERROR_STATE) {
            run->reason = CLI_PREDICTOR_FAILED;
            break;
        }
        run->reason = judge(world, &b, run);
        if (run->reason == CLI_PREDICTOR_WELL && has_temperatures(world)) {
            if ((result = rheo_world_particles(world, particles, &error)) != RHEO_OK)
                return cli_error(result, &error);
            if (too_hot(particles, count, &b))
                run->reason = CLI_PREDICTOR_TEMPERATURE;
        }
    }
    run->hash = rheo_world_hash(world);
    return CLI_DONE;
}

int cli_predictor_examine(const rheo_scene *scene, cli_predictor_run *run, cli_predictor_group_measures *measures)
{
    rheo_world *world = NULL;
    rheo_health *health = NULL;
    rheo_error error = {""};
    run->steps = scene->steps;
    run->unhealthy = run->sign = UINT64_MAX;
    for (size_t m = 0; m < CLI_PREDICTOR_MEASURES; m++)
        run->measure[m].first = UINT64_MAX;
    describe(scene, run);
    rheo_result result = rheo_scene_create_world(scene, &world, &error);
    if (result == RHEO_OK)
        result = rheo_health_open(world, &health, &error);
    int status = result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
    if (status == CLI_DONE) {
        rheo_particle_state *particles = malloc(((size_t)rheo_world_particle_count(world) + 1) * sizeof *particles);
        status = particles ? examine_world(world, run, measures, health, particles)
                           : cli_fail(CLI_SYSTEM, "no memory for the particles of a scene");
        free(particles);
    }
    rheo_health_close(health);
    rheo_world_destroy(world);
    return status;
}
