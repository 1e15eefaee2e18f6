/*
 * What the melting model costs: Table 2 of its paper, and speed against error. Times are of a substep, which is what
 * the paper calls an iteration.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/bench.h"

/* ---- table2 ---- */

/*
 * Table 2 of A. Paiva, F. Petronetto, T. Lewiner, G. Tavares, "Particle-based non-Newtonian fluid animation for
 * melting objects": average time per iteration on a Pentium 4 of 2.4 GHz. Its gargoyle is all fluid; its scene here
 * is a bunny of as many particles.
 */
static const struct {
    const char *scene, *paper;
    uint32_t particles;
    double seconds;
} PAPER[] = {{"melting-bunny", "bunny", 9727, 0.94},
             {"chair", "chair", 10000, 0.75},
             {"melting-all", "gargoyle", 6976, 1.06},
             {"melting-logo", "Sibgrapi", 12900, 0.92}};
enum { SCENES = sizeof PAPER / sizeof *PAPER, LEAD = 25 };

static double paper_ns(size_t scene)
{
    return 1e9 * PAPER[scene].seconds / PAPER[scene].particles;
}

/* Of a substep, where c has times of a step. */
static double per_substep(const bench_case *c, double ns)
{
    return c->substeps > 0 ? ns / c->substeps : 0;
}

static void print_table2(const bench_cases *cases, const bench_arguments *a)
{
    char stage[BENCH_MAX_STAGES][32];
    const uint32_t stages = bench_all_stages(cases, stage);
    printf("%s, %s, %s, simd %s; %u repetition%s of %llu steps from step %d on, medians; ns a particle and "
           "substep\n\n",
           bench_machine(), bench_compiler(), sizeof(rheo_real) == 8 ? "double" : "float", rheo_simd(),
           a->repetitions, a->repetitions == 1 ? "" : "s", (unsigned long long)a->steps, LEAD);
    printf("%-15s %6s %6s %8s %8s %8s %13s %9s | %-9s %7s %9s %8s\n", "scene", "n", "neigh.", "substeps", "solver",
           "ns", "least-most", "substep", "paper", "n", "iteration", "times");
    for (uint32_t i = 0; i < cases->count; i++) {
        const bench_case *c = &cases->at[i];
        const double ns = per_substep(c, bench_median(c->total, c->repetitions));
        char spread[48];
        snprintf(spread, sizeof spread, "%.0f-%.0f", per_substep(c, bench_least(c->total, c->repetitions)),
                 per_substep(c, bench_largest(c->total, c->repetitions)));
        printf("%-15s %6u %6.1f %8.1f %8.2f %8.1f %13s %6.2f ms | %-9s %7u %7.0f ms %8.0f\n", c->name, c->particles,
               c->neighbours, c->substeps, c->iterations, ns, spread, 1e-6 * ns * c->particles, PAPER[i].paper,
               PAPER[i].particles, 1e3 * PAPER[i].seconds, paper_ns(i) / ns);
    }
    printf("\n%-15s", "stage");
    for (uint32_t i = 0; i < cases->count; i++)
        printf(" %15s", cases->at[i].name);
    putchar('\n');
    for (uint32_t s = 0; s < stages; s++) {
        printf("%-15s", stage[s]);
        for (uint32_t i = 0; i < cases->count; i++)
            printf(" %15.1f", per_substep(&cases->at[i], bench_stage(&cases->at[i], stage[s])));
        putchar('\n');
    }
    puts("\nsubsteps: in a step; solver: iterations of conjugate gradients in a substep. The paper: Paiva, "
         "Petronetto,\n"
         "Lewiner, Tavares, \"Particle-based non-Newtonian fluid animation for melting objects\", Table 2, a Pentium "
         "4 of\n"
         "2.4 GHz; times: how much longer its iteration took for a particle.");
}

static void list_table2(const bench_cases *cases, const bench_arguments *a)
{
    bench_table table = {.json = a->json};
    for (uint32_t i = 0; i < cases->count; i++) {
        const bench_case *c = &cases->at[i];
        char stage[BENCH_MAX_STAGES][32], name[48], hash[17];
        const uint32_t stages = bench_all_stages(cases, stage);
        bench_cell_text(&table, "case", c->name);
        bench_cell_whole(&table, "particles", c->particles);
        bench_cell_number(&table, "neighbours", 2, c->neighbours);
        bench_cell_number(&table, "substeps", 2, c->substeps);
        bench_cell_number(&table, "iterations", 2, c->iterations);
        bench_cell_number(&table, "ns_substep_median", 2, per_substep(c, bench_median(c->total, c->repetitions)));
        bench_cell_number(&table, "ns_substep_least", 2, per_substep(c, bench_least(c->total, c->repetitions)));
        bench_cell_number(&table, "ns_substep_largest", 2, per_substep(c, bench_largest(c->total, c->repetitions)));
        bench_cell_number(&table, "paper_ns_iteration", 0, paper_ns(i));
        for (uint32_t s = 0; s < stages; s++) {
            snprintf(name, sizeof name, "ns_%.31s", stage[s]);
            bench_cell_number(&table, name, 2,
                              bench_has_stage(c, stage[s]) ? per_substep(c, bench_stage(c, stage[s])) : NAN);
        }
        bench_cell_number(&table, "bytes_state", 1, c->particles ? (double)c->field_bytes / c->particles : 0);
        bench_cell_number(&table, "bytes_world", 1, c->particles ? (double)c->world_bytes / c->particles : 0);
        snprintf(hash, sizeof hash, "%016llx", (unsigned long long)c->hash);
        bench_cell_text(&table, "hash", hash);
        bench_cell_whole(&table, "steps", a->steps);
        bench_cell_whole(&table, "repetitions", a->repetitions);
        bench_cell_text(&table, "machine", bench_machine());
        bench_cell_text(&table, "compiler", bench_compiler());
        bench_cell_text(&table, "real", sizeof(rheo_real) == 8 ? "double" : "float");
        bench_cell_text(&table, "simd", rheo_simd());
        bench_end_row(&table);
    }
}

int bench_run_table2(bench_arguments *a)
{
    bench_cases cases = {0};
    for (size_t s = 0; s < SCENES; s++) {
        bench_case *c = bench_add(&cases, PAPER[s].scene, 0);
        if (!c) {
            bench_release(&cases);
            return cli_fail(CLI_SYSTEM, "no memory for the cases");
        }
        c->window = 0;
        c->lead = LEAD;
        if (a->particles)
            c->scene.particles = a->particles;
    }
    const int status = bench_measure(&cases, a);
    if (status == CLI_DONE)
        (a->csv || a->json ? list_table2 : print_table2)(&cases, a);
    bench_release(&cases);
    return status;
}

/* ---- error ---- */

/* Settings that trade speed for error; the first of all is what the others are held against. */
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
enum { TRIALS = sizeof SETTINGS / sizeof *SETTINGS };

/* What came of one. */
typedef struct trial {
    double ns, substeps, iterations, error, hot_height, hot_error;
    rheo_real *position;
    uint32_t particles;
} trial;

static double metric_of(const rheo_world *world, const char *name)
{
    for (uint32_t i = 0; i < rheo_world_metric_count(world); i++)
        if (strcmp(rheo_world_metric_name(world, i), name) == 0)
            return rheo_world_metric(world, i);
    return NAN;
}

static int set_all(rheo_scene *scene, const char *const *set)
{
    for (int i = 0; i < 3 && set[i]; i++) {
        char key[64];
        const char *equals = strchr(set[i], '=');
        rheo_error error = {""};
        snprintf(key, sizeof key, "%.*s", (int)(equals - set[i]), set[i]);
        const rheo_result result = rheo_world_def_set(&scene->world, key, equals + 1, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
    }
    return CLI_DONE;
}

/* The scene from its start on; of several repetitions the fastest counts. */
static int try_setting(trial *t, size_t setting, bench_arguments *a)
{
    rheo_scene scene;
    rheo_error error = {""};
    rheo_scene_builtin("melting-bunny-small", &scene, NULL);
    const int status = set_all(&scene, SETTINGS[setting].set);
    if (status != CLI_DONE)
        return status;
    for (uint32_t r = 0; r < a->repetitions; r++) {
        rheo_world *world;
        rheo_result result = rheo_scene_create_world(&scene, &world, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
        t->substeps = t->iterations = 0;
        const double start = cli_now();
        for (uint64_t step = 0; step < a->steps && result == RHEO_OK; step++) {
            result = rheo_world_step(world, &error);
            t->substeps += metric_of(world, "substeps");
            t->iterations += metric_of(world, "iterations");
        }
        const double ns = 1e9 * (cli_now() - start);
        t->particles = rheo_world_particle_count(world);
        if (result == RHEO_OK && !t->position)
            t->position = malloc(3 * (size_t)t->particles * sizeof *t->position);
        if (result == RHEO_OK && t->position) {
            memcpy(t->position, rheo_world_positions(world), 3 * (size_t)t->particles * sizeof *t->position);
            t->hot_height = metric_of(world, "hot_height");
            /* A unit of time of the scene is 50 of its steps. */
            const double cost = ns / t->particles / ((double)a->steps * rheo_world_definition(world)->step);
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

/* Root of the mean square of how far the particles are from where the reference has them. */
static double distance_of(const trial *t, const trial *reference)
{
    double sum = 0;
    for (size_t i = 0; i < 3 * (size_t)t->particles; i++) {
        const double d = (double)t->position[i] - (double)reference->position[i];
        sum += d * d;
    }
    return t->particles ? sqrt(sum / t->particles) : 0;
}

static void print_errors(const trial *trials, const bench_arguments *a)
{
    bench_table table = {.json = a->json};
    const bool text = !a->csv && !a->json;
    if (text)
        printf("melting-bunny-small, %u particles, %llu steps; %s, %s, simd %s; least of %u repetition%s\n\n%-16s "
               "%9s "
               "%9s %14s %12s %12s\n",
               trials->particles, (unsigned long long)a->steps, bench_machine(), bench_compiler(), rheo_simd(),
               a->repetitions, a->repetitions == 1 ? "" : "s", "setting", "substeps", "solver", "us a particle",
               "error", "hot height");
    for (size_t i = 0; i < TRIALS; i++) {
        const trial *t = &trials[i];
        if (text) {
            printf("%-16s %9.0f %9.2f %14.1f %12.2e %+12.2e\n", SETTINGS[i].name, t->substeps,
                   t->iterations / t->substeps, 1e-3 * t->ns, t->error, t->hot_error);
            continue;
        }
        bench_cell_text(&table, "setting", SETTINGS[i].name);
        bench_cell_whole(&table, "particles", t->particles);
        bench_cell_whole(&table, "steps", a->steps);
        bench_cell_number(&table, "substeps", 0, t->substeps);
        bench_cell_number(&table, "iterations", 2, t->iterations / t->substeps);
        bench_cell_number(&table, "ns_particle_time", 0, t->ns);
        bench_cell_number(&table, "error", -3, t->error);
        bench_cell_number(&table, "hot_height_error", -3, t->hot_error);
        bench_cell_text(&table, "machine", bench_machine());
        bench_cell_text(&table, "compiler", bench_compiler());
        bench_cell_text(&table, "real", sizeof(rheo_real) == 8 ? "double" : "float");
        bench_cell_text(&table, "simd", rheo_simd());
        bench_end_row(&table);
    }
    if (text)
        puts(
            "\nsubsteps: of all steps; solver: iterations in a substep; us a particle: and unit of time, sqrt(H/g).\n"
            "error: root mean square distance of the particles from where the reference has them, and how the mean\n"
            "height of the hot ones differs, in heights of the object. courant 0.4 with tolerance 1e-3 and sound "
            "speed\n"
            "10 is the default; another sound speed is another fluid, as compressible as that makes it.");
}

int bench_run_error(bench_arguments *a)
{
    trial trials[TRIALS] = {{0}};
    int status = CLI_DONE;
    for (size_t i = 0; i < TRIALS && status == CLI_DONE; i++) {
        status = try_setting(&trials[i], i, a);
        if (status == CLI_DONE) {
            trials[i].error = distance_of(&trials[i], &trials[0]);
            trials[i].hot_error = trials[i].hot_height - trials[0].hot_height;
        }
    }
    cli_progress_end(&a->progress);
    if (status == CLI_DONE)
        print_errors(trials, a);
    for (size_t i = 0; i < TRIALS; i++)
        free(trials[i].position);
    return status;
}
