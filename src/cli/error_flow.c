/*
 * Study flow: several settings of the melting model, against a fine reference. Errors: root mean square distance between the
 * particles and those of the reference, and mean height of the hot particles, in heights of the object. Another sound speed
 * makes another fluid: its compressibility differs.
 */
#include "cli/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Settings that exchange speed for accuracy. The first one is the reference. */
static const struct {
    const char *name, *set[3]; /* KEY=VALUE */
} SETTINGS[] = {
    {"reference", {"melting.courant_number=0.05", "melting.tolerance=1e-6"}},
    {"courant 0.1", {"melting.courant_number=0.1"}},
    {"courant 0.2", {"melting.courant_number=0.2"}},
    {"courant 0.4", {NULL}},
    {"courant 0.8", {"melting.courant_number=0.8"}},
    {"courant 1.6", {"melting.courant_number=1.6"}},
    {"tolerance 1e-1", {"melting.tolerance=1e-1"}},
    {"tolerance 1e-2", {"melting.tolerance=1e-2"}},
    {"tolerance 1e-4", {"melting.tolerance=1e-4"}},
    {"sound speed 5", {"melting.sound_speed=5"}},
    {"sound speed 20", {"melting.sound_speed=20"}},
    {"nested stress", {"melting.stress=nested"}},
};
enum { TRIALS = sizeof SETTINGS / sizeof *SETTINGS, STEPS = 60 };

/* Result of a setting. */
typedef struct trial {
    double ns, step, substeps, iterations, error, hot_height, hot_error;
    rheo_real *position;
    uint32_t particles;
    uint64_t hash;
} trial;

static int set_all(rheo_scene *scene, const char *const *set)
{
    for (int i = 0; i < 3 && set[i]; i++) {
        char key[64];
        const char *value = NULL;
        rheo_error error = {""};
        const int status = cli_split_setting(&cli_bench, set[i], key, sizeof key, &value);
        if (status != CLI_DONE)
            return status;
        const rheo_result result = rheo_world_def_set(&scene->world, key, value, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
    }
    return CLI_DONE;
}

/* Runs the scene from its start. The fastest repetition determines the time. */
static int run_setting(trial *t, size_t setting, const rheo_scene *scene, cli_bench_arguments *a, uint64_t steps)
{
    rheo_error error = {""};
    for (uint32_t r = 0; r < a->repetitions; r++) {
        rheo_world *world;
        rheo_result result = rheo_scene_create_world(scene, &world, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
        t->substeps = t->iterations = 0;
        const double start = cli_now();
        for (uint64_t step = 0; step < steps && result == RHEO_OK; step++) {
            result = rheo_world_step(world, &error);
            t->substeps += cli_metric(world, "substeps");
            t->iterations += cli_metric(world, "iterations");
        }
        const double ns = 1e9 * (cli_now() - start);
        t->particles = rheo_world_particle_count(world);
        if (result == RHEO_OK && !t->position)
            t->position = malloc(3 * (size_t)t->particles * sizeof *t->position);
        if (result == RHEO_OK && t->position) {
            memcpy(t->position, rheo_world_positions(world), 3 * (size_t)t->particles * sizeof *t->position);
            t->hash = rheo_world_hash(world);
            t->step = rheo_world_definition(world)->step;
            t->hot_height = cli_metric(world, "hot_height");
            /* Converts a time per step to a time per unit of time of the scene, which is 50 steps. */
            const double cost = ns / t->particles / ((double)steps * t->step);
            t->ns = r == 0 || cost < t->ns ? cost : t->ns;
        }
        rheo_world_destroy(world);
        if (result != RHEO_OK)
            return cli_error(result, &error);
        if (!t->position)
            return cli_fail(CLI_SYSTEM, "no memory for the positions of %s", SETTINGS[setting].name);
        if (cli_progress_due(&a->progress, cli_now()))
            cli_progress_say(&a->progress, cli_now(), "%s (%zu of %d)", SETTINGS[setting].name, setting + 1, TRIALS);
    }
    return CLI_DONE;
}

static int try_setting(trial *t, size_t setting, cli_bench_arguments *a, uint64_t steps)
{
    rheo_scene scene;
    rheo_error error = {""};
    const rheo_result result = rheo_scene_builtin("melting-bunny-small", &scene, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    if (a->particles)
        scene.particles = a->particles;
    int status = set_all(&scene, SETTINGS[setting].set);
    if (status == CLI_DONE)
        status = run_setting(t, setting, &scene, a, steps);
    rheo_scene_release(&scene);
    return status;
}

/* Root mean square distance between particles of the trial and of the reference. */
static double distance_of(const trial *t, const trial *reference)
{
    double sum = 0;
    for (size_t i = 0; i < 3 * (size_t)t->particles; i++) {
        const double d = (double)t->position[i] - (double)reference->position[i];
        sum += d * d;
    }
    return t->particles ? sqrt(sum / t->particles) : 0;
}

/* Settings of one series differ in one number. */
static void name_series(const char *setting, cli_error_point *p)
{
    const size_t word = strcspn(setting, "0123456789");
    if (setting[word]) {
        snprintf(p->series, sizeof p->series, "%.*s", (int)word - 1, setting);
        p->refinement = strtod(setting + word, NULL);
    }
    if (strncmp(setting, "sound speed", 11) == 0)
        p->refinement = 0; /* another fluid, not a finer one */
}

static int add_points(const trial *trials, uint64_t steps, cli_error_points *points)
{
    for (size_t i = 0; i < TRIALS; i++) {
        const trial *t = &trials[i];
        cli_error_point p = cli_error_no_point();
        snprintf(p.scene, sizeof p.scene, "melting-bunny-small");
        snprintf(p.setting, sizeof p.setting, "%s", SETTINGS[i].name);
        name_series(SETTINGS[i].name, &p);
        p.particles = t->particles;
        p.steps = steps;
        p.hash = t->hash;
        p.substeps = t->substeps;
        p.iterations = t->iterations / t->substeps;
        p.ns_step = t->ns * t->step;
        p.us_time = 1e-3 * t->ns;
        snprintf(p.quantity, sizeof p.quantity, "distance");
        p.value = p.error = t->error;
        if (!cli_error_add(points, &p))
            return CLI_SYSTEM;
        snprintf(p.quantity, sizeof p.quantity, "hot height");
        p.value = t->hot_height;
        p.reference = trials->hot_height;
        p.error = t->hot_error;
        if (!cli_error_add(points, &p))
            return CLI_SYSTEM;
    }
    return CLI_DONE;
}

int cli_error_flow(cli_bench_arguments *a, cli_error_points *points)
{
    const uint64_t steps = a->steps ? a->steps : STEPS;
    trial trials[TRIALS] = {{0}};
    int status = CLI_DONE;
    for (size_t i = 0; i < TRIALS && status == CLI_DONE; i++) {
        status = try_setting(&trials[i], i, a, steps);
        if (status == CLI_DONE) {
            trials[i].error = distance_of(&trials[i], &trials[0]);
            trials[i].hot_error = trials[i].hot_height - trials[0].hot_height;
        }
    }
    if (status == CLI_DONE)
        status = add_points(trials, steps, points);
    for (size_t i = 0; i < TRIALS; i++)
        free(trials[i].position);
    return status;
}
