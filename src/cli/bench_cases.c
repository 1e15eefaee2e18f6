/*
 * The cases of `rheolog bench`: made once each, kept as checkpoints in memory, and timed in turn, so that whatever
 * the machine does meanwhile falls on all of them alike. Every repetition starts from the same state, hence must end
 * with the same hash: a measurement of something else than was asked for is none.
 *
 * One core, where the system lets a program choose. A few steps are made before the clock starts: a world that comes
 * from a checkpoint makes in its first step what later ones share among them.
 */
#ifdef __linux__
#define _GNU_SOURCE /* sched_setaffinity() */
#else
#define _POSIX_C_SOURCE 200809L
#endif
#include "cli/bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#ifdef __linux__
#include <sched.h>
#endif
#if !defined(__wasi__)
#include <sys/resource.h>
#endif

enum { WARM_UP = 8, KERNEL_STEPS = 4, SAMPLES = 32 };

/* ---- The machine ---- */

static void pin(void)
{
#ifdef __linux__
    /* The core that this runs on already, which the system has chosen as a free one. */
    const int cpu = sched_getcpu();
    cpu_set_t set;
    if (cpu < 0 || cpu >= CPU_SETSIZE)
        return;
    CPU_ZERO(&set);
    CPU_SET(cpu, &set);
    (void)sched_setaffinity(0, sizeof set, &set); /* a measurement that may move is one too */
#endif
}

const char *bench_machine(void)
{
    static char name[96];
    if (name[0])
        return name;
    FILE *file = fopen("/proc/cpuinfo", "r");
    char line[256];
    while (file && !name[0] && fgets(line, sizeof line, file)) {
        const char *value = strchr(line, ':');
        if (strncmp(line, "model name", 10) == 0 && value && value[1] && value[2] != '\n')
            snprintf(name, sizeof name, "%.*s", (int)strcspn(value + 2, "\n"), value + 2);
    }
    if (file)
        fclose(file);
    if (!name[0])
        snprintf(name, sizeof name, "%s", strrchr(rheo_build(), ',') + 2);
    return name;
}

const char *bench_compiler(void)
{
    static char name[96];
    const char *build = strchr(rheo_build(), ',') + 2;
    size_t length = strcspn(build, ",");
    while (length > 0 && build[length - 1] == ' ') /* as clang ends its version */
        length--;
    snprintf(name, sizeof name, "%.*s", (int)length, build);
    return name;
}

#ifdef __linux__
static size_t status_bytes(const char *key)
{
    FILE *file = fopen("/proc/self/status", "r");
    char line[256];
    size_t bytes = 0;
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, key, strlen(key)) == 0)
            bytes = (size_t)strtoull(line + strlen(key), NULL, 10) * 1024;
    if (file)
        fclose(file);
    return bytes;
}
#endif

/* From here on peak_memory() is about what comes; returns what is there now. */
static size_t reset_peak_memory(void);

/* The most memory that the process has had; 0: the system does not say. */
static size_t peak_memory(void)
{
#ifdef __linux__
    const size_t peak = status_bytes("VmHWM:");
    if (peak)
        return peak;
#endif
#ifndef __wasi__
    struct rusage usage;
    const size_t unit =
#ifdef __APPLE__
        1;
#else
        1024;
#endif
    if (getrusage(RUSAGE_SELF, &usage) == 0)
        return (size_t)usage.ru_maxrss * unit;
#endif
    return 0;
}

static size_t reset_peak_memory(void)
{
#ifdef __linux__
    FILE *file = fopen("/proc/self/clear_refs", "w");
    if (file) {
        fputs("5", file);
        fclose(file);
    }
    const size_t now = status_bytes("VmRSS:");
    if (now)
        return now;
#endif
    return peak_memory();
}

/* ---- Memory of the library, counted ---- */

enum { COUNT_HEAD = 64 }; /* the size in front of each block; as wide as any alignment */

static size_t counted;

static void *count_allocate(size_t bytes, void *user)
{
    (void)user;
    char *memory = bytes <= SIZE_MAX - COUNT_HEAD ? malloc(bytes + COUNT_HEAD) : NULL;
    if (!memory)
        return NULL;
    memcpy(memory, &bytes, sizeof bytes);
    counted += bytes;
    return memory + COUNT_HEAD;
}

static void count_release(void *memory, void *user)
{
    (void)user;
    char *start = (char *)memory - COUNT_HEAD;
    size_t bytes;
    memcpy(&bytes, start, sizeof bytes);
    counted -= bytes;
    free(start);
}

/* ---- Scenes ---- */

/* A pool of about so many particles: as deep, wider or narrower, what is in it at the same places of it. */
static void resize_pool(rheo_scene *scene, uint64_t particles)
{
    rheo_fill *fill = &scene->fill[0];
    const double spacing = scene->world.fluid.spacing;
    const double nx = fill->max[0] / spacing, ny = fill->max[1] / spacing, nz = fill->max[2] / spacing;
    const double wide = floor(nx * sqrt((double)particles / (nx * ny * nz)) + .5);
    const double deep = floor((double)particles / (wide * ny) + .5);
    const double scale[3] = {wide / nx, 1, deep / nz};
    for (int axis = 0; axis < 3; axis++) {
        fill->max[axis] *= scale[axis];
        for (uint32_t i = 0; i < scene->world.walls.count; i++)
            scene->world.walls.plane[i].point[axis] *= scale[axis];
        scene->world.ball.position[axis] *= scale[axis];
    }
    for (uint32_t i = 0; i < scene->world.vibrators.count; i++) {
        scene->world.vibrators.position[i][0] *= scale[0];
        scene->world.vibrators.position[i][1] *= scale[2];
    }
}

bench_case *bench_add(bench_cases *cases, const char *scene, uint64_t particles)
{
    if (!cases->at)
        cases->at = calloc(BENCH_MAX_CASES, sizeof *cases->at);
    if (!cases->at || cases->count == BENCH_MAX_CASES)
        return NULL;
    bench_case *c = &cases->at[cases->count++];
    snprintf(c->name, sizeof c->name, "%s", scene);
    c->error = NAN;
    rheo_scene_builtin(scene, &c->scene, NULL);
    uint64_t made;
    if (particles && rheo_scene_particle_count(&c->scene, &made, NULL) == RHEO_OK && particles != made)
        resize_pool(&c->scene, particles);
    bench_set_window(c, c->scene.world.history.window);
    return c;
}

void bench_set_window(bench_case *c, uint32_t window)
{
    if (window)
        c->scene.world.history.window = window;
    else
        c->scene.world.history.stiffness = 0;
    c->window = window;
    c->lead = window + UINT64_C(1);
}

void bench_release(bench_cases *cases)
{
    for (uint32_t i = 0; i < cases->count; i++) {
        bench_case *c = &cases->at[i];
        free(c->state);
        free(c->total);
        free(c->rest);
        for (uint32_t s = 0; s < c->stages; s++)
            free(c->stage_ns[s]);
    }
    free(cases->at);
    *cases = (bench_cases){0};
}

/* ---- The error of D^q ---- */

/*
 * What some particles did, from the first step on. D^q of it by the plain sum in double is what the world's D^q is
 * held against. What a kind remembers of the past sets which sum: that over the window, over all, or over all with
 * weights that fade; a kind that is not known here has none.
 */
typedef struct signals {
    uint32_t particles;
    size_t steps, room;
    double *velocity; /* [particle][axis][step] */
} signals;

static bool signals_of(signals *s, const rheo_world *world, size_t steps)
{
    const uint32_t particles = rheo_world_particle_count(world);
    *s = (signals){.particles = particles < SAMPLES ? particles : SAMPLES, .room = steps};
    s->velocity = calloc(steps * 3 * SAMPLES, sizeof *s->velocity);
    return s->velocity != NULL;
}

static uint32_t sample_id(const signals *s, const rheo_world *world, uint32_t sample)
{
    return (uint32_t)((uint64_t)sample * rheo_world_particle_count(world) / s->particles);
}

static void take_signals(signals *s, const rheo_world *world)
{
    const rheo_real *velocity = rheo_world_velocities(world);
    for (uint32_t sample = 0; sample < s->particles; sample++)
        for (size_t axis = 0; axis < 3; axis++)
            s->velocity[(sample * (size_t)3 + axis) * s->room + s->steps] =
                (double)velocity[3 * (size_t)sample_id(s, world, sample) + axis];
    s->steps++;
}

/*
 * The weights of the lags 0 .. steps - 1 of a kind as a whole sum has them, with the factor in front: those of the
 * paper's rule, as all built-in scenes have it. False: no such sum, or no memory.
 */
static bool exact_weights(const rheo_world_def *def, const char *kind, size_t steps, double *weight)
{
    const double q = def->history.order, scale = rheo_history_scale(q, def->step, RHEO_WEIGHTS_PAPER);
    const bool windowed = strncmp(kind, "window", 6) == 0, tempered = strcmp(kind, "tempered") == 0;
    if (!windowed && !tempered && strcmp(kind, "full") != 0)
        return false;
    const double tau = rheo_history_tempering(q, def->history.window);
    rheo_history_weights(q, steps, weight);
    if (!windowed || steps <= def->history.window) /* the first sample of all is in sight */
        weight[steps - 1] = rheo_history_first_weight(q, steps - 1);
    for (size_t lag = 0; lag < steps; lag++) {
        weight[lag] *= scale;
        if (windowed && lag > def->history.window)
            weight[lag] = 0;
        if (tempered)
            weight[lag] *= exp(-(double)lag / tau);
    }
    return true;
}

static double error_of(const signals *s, const rheo_world *world, const char *kind)
{
    double *weight = malloc(s->steps * sizeof *weight + 1);
    double largest = 0, error = 0;
    if (!weight || !exact_weights(rheo_world_definition(world), kind, s->steps, weight)) {
        free(weight);
        return NAN;
    }
    for (uint32_t sample = 0; sample < s->particles; sample++) {
        rheo_particle_state state;
        if (rheo_world_particle(world, sample_id(s, world, sample), &state, NULL) != RHEO_OK)
            continue;
        for (size_t axis = 0; axis < 3; axis++) {
            const double *velocity = s->velocity + (sample * (size_t)3 + axis) * s->room;
            double exact = 0;
            for (size_t step = 0; step < s->steps; step++)
                exact += weight[s->steps - 1 - step] * velocity[step];
            largest = fmax(largest, fabs(exact));
            error = fmax(error, fabs(state.derivative[axis] - exact));
        }
    }
    free(weight);
    return largest > 0 ? error / largest : NAN;
}

/* ---- Making the states ---- */

static void describe(bench_case *c, const rheo_world *world)
{
    char kind[96];
    c->particles = rheo_world_particle_count(world);
    if (c->window && rheo_world_def_get(rheo_world_definition(world), "history.kind", kind, sizeof kind) != RHEO_OK)
        snprintf(kind, sizeof kind, "window"); /* a build that knows no other */
    snprintf(c->kind, sizeof c->kind, "%.31s", c->window ? kind : "");
    c->history_bytes = rheo_world_history_bytes(world);
    rheo_field_info info;
    for (uint32_t f = 0; rheo_world_field(world, f, &info) == RHEO_OK; f++)
        c->field_bytes += (size_t)info.bytes;
    rheo_stage_info stage;
    for (uint32_t s = 0; s < BENCH_MAX_STAGES && rheo_world_stage(world, s, &stage) == RHEO_OK; s++) {
        snprintf(c->stage[s], sizeof c->stage[s], "%s", stage.name);
        c->stages = s + 1;
    }
}

/* The steps before the state: they fill the window. */
static int lead_on(bench_case *c, rheo_world *world, bench_arguments *a, signals *s)
{
    rheo_error error = {""};
    for (uint64_t step = 0; step < c->lead; step++) {
        const rheo_result result = rheo_world_step(world, &error);
        if (result != RHEO_OK)
            return cli_error(result, &error);
        if (c->with_error)
            take_signals(s, world);
        const double time = cli_now();
        if (cli_progress_due(&a->progress, time))
            cli_progress_say(&a->progress, time, "making %s, d = %u: step %llu of %llu", c->name, c->window,
                             (unsigned long long)step + 1, (unsigned long long)c->lead);
    }
    return CLI_DONE;
}

static int make_state(bench_case *c, bench_arguments *a)
{
    rheo_error error = {""};
    rheo_world *world;
    const size_t before = counted, memory = reset_peak_memory();
    c->scene.world.allocator = (rheo_allocator){count_allocate, count_release, NULL};
    rheo_result result = rheo_scene_create_world(&c->scene, &world, &error);
    if (result != RHEO_OK)
        return cli_error(result, &error);
    signals s = {0};
    if (c->with_error && !signals_of(&s, world, (size_t)c->lead)) {
        rheo_world_destroy(world);
        return cli_fail(CLI_SYSTEM, "no memory for the signals of %s", c->name);
    }
    int status = lead_on(c, world, a, &s);
    if (status == CLI_DONE) {
        const size_t peak = peak_memory();
        c->process_bytes = peak > memory ? peak - memory : 0;
        c->world_bytes = counted - before;
        describe(c, world);
        if (c->with_error)
            c->error = error_of(&s, world, c->kind);
        result = rheo_world_save_memory(world, c->name, &c->state, &c->state_size, &error);
        if (result != RHEO_OK)
            status = cli_error(result, &error);
    }
    free(s.velocity);
    rheo_world_destroy(world);
    return status;
}

/* ---- Running from them ---- */

typedef struct bench_run {
    rheo_recording *recording;
    rheo_world *world;
} bench_run;

static void end_run(bench_run *run)
{
    rheo_world_destroy(run->world);
    rheo_recording_close(run->recording);
    *run = (bench_run){0};
}

/* The world of a case, so many steps on. */
static int begin_run(const bench_case *c, uint64_t steps, bench_run *run)
{
    *run = (bench_run){0};
    rheo_error error = {""};
    rheo_result result = rheo_recording_open_memory(c->state, c->state_size, &run->recording, &error);
    if (result == RHEO_OK)
        result = rheo_recording_world(run->recording, rheo_recording_get_info(run->recording).first_step, NULL,
                                      &run->world, &error);
    for (uint64_t step = 0; result == RHEO_OK && step < steps; step++)
        result = rheo_world_step(run->world, &error);
    if (result == RHEO_OK)
        return CLI_DONE;
    end_run(run);
    return cli_error(result, &error);
}

static int same_hash(const bench_case *c, const char *first, uint64_t expected, const char *other, uint64_t hash)
{
    if (hash == expected)
        return CLI_DONE;
    return cli_fail(CLI_DIFFERS,
                    "bench: %s with d = %u: %s ended with hash %016llx, %s with %016llx; both began with the same "
                    "state and must give the same bits, so nothing of this can be compared",
                    c->name, c->window, first, (unsigned long long)expected, other, (unsigned long long)hash);
}

/* All SIMD variants that this machine runs, a few steps each, of the case with the most stages (and the smallest state). */
static int check_variants(const bench_cases *cases)
{
    const bench_case *c = &cases->at[0];
    for (uint32_t i = 1; i < cases->count; i++) {
        const bench_case *other = &cases->at[i];
        if (other->stages > c->stages || (other->stages == c->stages && other->state_size < c->state_size))
            c = other;
    }
    char in_use[32];
    snprintf(in_use, sizeof in_use, "%s", rheo_simd());
    int status = CLI_DONE;
    uint64_t expected = 0;
    const char *first = rheo_simd_available(0), *name;
    for (uint32_t k = 0; status == CLI_DONE && (name = rheo_simd_available(k)) != NULL; k++) {
        bench_run run;
        if ((status = cli_use_simd(name)) != CLI_DONE || (status = begin_run(c, KERNEL_STEPS, &run)) != CLI_DONE)
            break;
        const uint64_t hash = rheo_world_hash(run.world);
        end_run(&run);
        expected = k ? expected : hash;
        char told[2][48];
        snprintf(told[0], sizeof told[0], "simd %s", first);
        snprintf(told[1], sizeof told[1], "simd %s", name);
        status = same_hash(c, told[0], expected, told[1], hash);
    }
    const int restored = cli_use_simd(in_use);
    return status == CLI_DONE ? restored : status;
}

/* The place of a metric, or UINT32_MAX. */
static uint32_t metric_place(const rheo_world *world, const char *name)
{
    for (uint32_t i = 0; i < rheo_world_metric_count(world); i++)
        if (strcmp(rheo_world_metric_name(world, i), name) == 0)
            return i;
    return UINT32_MAX;
}

static int repeat(bench_case *c, uint32_t repetition, bench_arguments *a)
{
    bench_run run;
    rheo_error error = {""};
    int status = begin_run(c, WARM_UP, &run);
    if (status != CLI_DONE)
        return status;
    rheo_world_reset_times(run.world);
    const uint32_t at_substeps = metric_place(run.world, "substeps"),
                   at_iterations = metric_place(run.world, "iterations");
    double substeps = 0, iterations = 0;
    const double start = cli_now();
    for (uint64_t step = 0; step < a->steps; step++) {
        const rheo_result result = rheo_world_step(run.world, &error);
        if (result != RHEO_OK) {
            end_run(&run);
            return cli_error(result, &error);
        }
        substeps += rheo_world_metric(run.world, at_substeps);
        iterations += rheo_world_metric(run.world, at_iterations);
    }
    const double seconds = cli_now() - start;
    const double scale = 1e9 / ((double)a->steps * (c->particles ? (double)c->particles : 1));
    c->total[repetition] = c->rest[repetition] = scale * seconds;
    for (uint32_t s = 0; s < c->stages; s++) {
        rheo_stage_info stage = {0};
        rheo_world_stage(run.world, s, &stage);
        c->stage_ns[s][repetition] = scale * stage.seconds;
        c->rest[repetition] -= scale * stage.seconds;
    }
    const uint64_t hash = rheo_world_hash(run.world);
    c->substeps = substeps / (double)a->steps;
    c->iterations = substeps > 0 ? iterations / substeps : 0;
    c->neighbours = rheo_world_mean_neighbours(run.world);
    end_run(&run);
    c->hash = repetition ? c->hash : hash;
    char which[48];
    snprintf(which, sizeof which, "repetition %u", repetition + 1);
    c->repetitions = repetition + 1;
    return same_hash(c, "the first repetition", c->hash, which, hash);
}

static bool reserve(bench_case *c, uint32_t repetitions)
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

int bench_measure(bench_cases *cases, bench_arguments *a)
{
    int status = CLI_DONE;
    pin();
    a->progress.last = cli_now();
    for (uint32_t i = 0; status == CLI_DONE && i < cases->count; i++) {
        bench_case *c = &cases->at[i];
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
                                 a->repetitions, cases->at[i].name, cases->at[i].window, i + 1, cases->count);
            status = repeat(&cases->at[i], r, a);
        }
    cli_progress_end(&a->progress);
    return status;
}

/* ---- Of what was measured ---- */

static int compare(const void *a, const void *b)
{
    double x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

double bench_median(const double *values, uint32_t count)
{
    double sorted[BENCH_MAX_REPETITIONS];
    if (count == 0)
        return 0;
    memcpy(sorted, values, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare);
    return count % 2 ? sorted[count / 2] : (sorted[count / 2 - 1] + sorted[count / 2]) / 2;
}

double bench_least(const double *values, uint32_t count)
{
    double least = count ? values[0] : 0;
    for (uint32_t i = 1; i < count; i++)
        least = values[i] < least ? values[i] : least;
    return least;
}

double bench_largest(const double *values, uint32_t count)
{
    double largest = count ? values[0] : 0;
    for (uint32_t i = 1; i < count; i++)
        largest = values[i] > largest ? values[i] : largest;
    return largest;
}

bool bench_has_stage(const bench_case *c, const char *stage)
{
    for (uint32_t s = 0; s < c->stages; s++)
        if (strcmp(c->stage[s], stage) == 0)
            return true;
    return false;
}

double bench_stage(const bench_case *c, const char *stage)
{
    for (uint32_t s = 0; s < c->stages; s++)
        if (strcmp(c->stage[s], stage) == 0)
            return bench_median(c->stage_ns[s], c->repetitions);
    return 0;
}

uint32_t bench_all_stages(const bench_cases *cases, char stage[BENCH_MAX_STAGES][32])
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < cases->count; i++) {
        uint32_t at = 0; /* behind the last stage of this case that is in the list */
        for (uint32_t s = 0; s < cases->at[i].stages; s++) {
            const char *name = cases->at[i].stage[s];
            uint32_t found = 0;
            while (found < count && strcmp(stage[found], name) != 0)
                found++;
            if (found == count) {
                if (count == BENCH_MAX_STAGES)
                    continue;
                memmove(stage[at + 1], stage[at], (count - at) * sizeof stage[0]);
                snprintf(stage[at], sizeof stage[0], "%s", name);
                count++;
                found = at;
            }
            at = found + 1;
        }
    }
    return count;
}
