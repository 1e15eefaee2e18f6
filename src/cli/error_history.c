/*
 * Study history: D^q of signals whose Caputo derivative
 *
 *     D^q x(t) = 1/Gamma(1-q) integral from 0 to t of v(t-u) u^(-q) du,    v = x',
 *
 * is known, for every kind of memory, and what its storage costs. Closed forms follow from that of a power,
 * D^q t^p = Gamma(p+1)/Gamma(p+1-q) t^(p-q): a polynomial is one power, exp a series of positive ones, constant velocity from
 * time a on (t-a)^(1-q)/Gamma(2-q). A series of a sine loses its digits after a few periods, and the impact has none: there
 * the integral is computed by cli_caputo(), which the tests compare with the closed forms.
 *
 * Particles have velocities that are differences of their positions over the last substep, so the memories get these.
 * The error is the largest difference in all steps as a fraction of the largest D^q. It includes what a memory forgets; that
 * of "D^q of kind window" is the difference of kind window-fast from kind window, which forget the same.
 */
#include "cli/error_signals.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/error.h"
#include "cli/error_start.h"
#include "cli/error_trials.h"

static const double STEP = .033; /* of the built-in scenes */
static const double ORDER[] = {.2, .5, .8};
static const uint32_t WINDOW[] = {15, 50, 150, 500};
enum { ORDERS = 3, WINDOWS = 4, STEPS = 500, HALVINGS = 4, PARTICLES = 10000, TIMED = 96, TURN = 8 };
enum { SUBSTEPS = 2 }; /* the default of scheme summed; scheme sequential has one */

/* ---- Cost ---- */

/* Cost of a memory: D^q and storing. Kind full has no window. */
typedef struct cost {
    rheo_history_kind kind;
    uint32_t window;
    double ns, bytes;
    uint64_t hash;
    uint32_t particles;
} cost;

enum { KINDS = RHEO_HISTORY_TEMPERED + 1, MEMORIES = (KINDS - 1) * WINDOWS + 1 };

static void list_memories(cost memory[MEMORIES])
{
    size_t n = 0;
    for (int kind = 0; kind < KINDS; kind++)
        for (size_t w = 0; w < (kind == RHEO_HISTORY_FULL ? 1 : WINDOWS); w++)
            memory[n++] =
                (cost){.kind = (rheo_history_kind)kind, .window = kind == RHEO_HISTORY_FULL ? 0 : WINDOW[w]};
}

/* Computing time of the memory in the last step, s. */
static double memory_seconds(const rheo_world *world)
{
    rheo_stage_info stage;
    double seconds = 0;
    for (uint32_t i = 0; rheo_world_stage(world, i, &stage) == RHEO_OK; i++)
        if (strcmp(stage.name, "fractional_derivative") == 0 || strcmp(stage.name, "history") == 0)
            seconds += stage.seconds;
    return seconds;
}

/* Makes a world for each memory from one settled pool, and fills the windows. */
static rheo_result make_worlds(cost memory[MEMORIES], rheo_world *world[MEMORIES], const cli_start *start,
                               cli_bench_arguments *a, rheo_error *error)
{
    rheo_result result = RHEO_OK;
    for (size_t m = 0; m < MEMORIES && result == RHEO_OK; m++) {
        rheo_world_def def = start->def;
        def.history.kind = memory[m].kind;
        def.history.window = memory[m].window ? memory[m].window : WINDOW[0];
        result = rheo_world_create(&def, &world[m], error);
        for (uint32_t step = 0; step <= def.history.window && result == RHEO_OK; step++)
            result = rheo_world_step(world[m], error);
        if (cli_progress_due(&a->progress, cli_now()))
            cli_progress_say(&a->progress, cli_now(), "filling memories (%zu of %d)", m + 1, MEMORIES);
    }
    return result;
}

/*
 * Steps the worlds in turn, some steps at a time; the first of these, which finds the caches full of another world, does not
 * count. A step is short, so that few are disturbed by other work of the machine, and the median leaves these out.
 */
static rheo_result time_worlds(cost memory[MEMORIES], rheo_world *world[MEMORIES], uint32_t steps, double *seconds,
                               rheo_error *error)
{
    rheo_result result = RHEO_OK;
    for (uint32_t first = 0; first < steps; first += TURN)
        for (size_t m = 0; m < MEMORIES && result == RHEO_OK; m++) {
            result = rheo_world_step(world[m], error);
            for (uint32_t step = first; step < first + TURN && step < steps && result == RHEO_OK; step++) {
                rheo_world_reset_times(world[m]);
                result = rheo_world_step(world[m], error);
                seconds[m * steps + step] = memory_seconds(world[m]);
            }
        }
    for (size_t m = 0; m < MEMORIES && result == RHEO_OK; m++) {
        const double particles = rheo_world_particle_count(world[m]);
        memory[m].ns = 1e9 * cli_bench_median(seconds + m * steps, steps) / particles;
        memory[m].bytes = (double)rheo_world_history_bytes(world[m]) / particles;
        memory[m].hash = rheo_world_hash(world[m]);
        memory[m].particles = rheo_world_particle_count(world[m]);
    }
    return result;
}

/* Measures the stages of the memories in a pool with a ball. */
static int measure_costs(cost memory[MEMORIES], cli_bench_arguments *a)
{
    const uint32_t steps =
        a->steps ? (uint32_t)(a->steps < CLI_BENCH_MAX_REPETITIONS ? a->steps : CLI_BENCH_MAX_REPETITIONS) : TIMED;
    cli_bench_cases cases = {0};
    rheo_world *pool = NULL, *world[MEMORIES] = {NULL};
    cli_start start = {.position = NULL};
    rheo_error error = {"no memory for the times of the memories"};
    cli_bench_case *c = cli_bench_add(&cases, "bowling-ball", a->particles ? a->particles : PARTICLES);
    double *seconds = malloc(MEMORIES * steps * sizeof *seconds);
    rheo_result result = c && seconds ? RHEO_OK : RHEO_ERROR_MEMORY;
    if (result == RHEO_OK) {
        if (a->settle.given)
            c->scene.settle.time = (double)a->settle.value * c->scene.world.step;
        result = rheo_scene_create_world(&c->scene, &pool, &error);
    }
    if (result == RHEO_OK)
        result = cli_start_copy(&start, pool, &error);
    if (result == RHEO_OK)
        result = make_worlds(memory, world, &start, a, &error);
    if (result == RHEO_OK)
        result = time_worlds(memory, world, steps, seconds, &error);
    for (size_t m = 0; m < MEMORIES; m++)
        rheo_world_destroy(world[m]);
    cli_start_release(&start);
    rheo_world_destroy(pool);
    cli_bench_release(&cases);
    free(seconds);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &error);
}

/* ---- Errors ---- */

/* A signal that is sampled at steps of STEP / divisor, and its derivative at the steps of STEP. */
typedef struct sampled {
    const cli_signal *signal;
    double order;
    size_t steps; /* of STEP */
    double *velocity, *result, *exact, *spare, largest;
} sampled;

/* Differences of positions over the last substep, or the velocities of the signal if `substeps` is 0; first v(0). */
static void sample(sampled *s, size_t divisor, double substeps)
{
    const double step = STEP / (double)divisor, back = step / substeps;
    for (size_t n = 0; n <= s->steps * divisor; n++) {
        const double t = (double)n * step;
        s->velocity[n] = substeps > 0 && n ? (s->signal->position(t) - s->signal->position(t - back)) / back
                                           : s->signal->velocity(t);
    }
}

static void find_exact(sampled *s)
{
    s->largest = 0;
    for (size_t n = 0; n <= s->steps; n++) {
        const double t = (double)n * STEP;
        s->exact[n] = s->signal->derivative ? s->signal->derivative(s->order, t) : cli_caputo(s->signal, s->order, t);
        s->largest = fmax(s->largest, fabs(s->exact[n]));
    }
}

/* The largest error, and the value of the last step. */
static double error_of(const sampled *s, size_t divisor, double *value)
{
    double error = 0;
    for (size_t n = 0; n <= s->steps; n++)
        error = fmax(error, fabs(s->result[n * divisor] - s->exact[n]));
    *value = s->result[s->steps * divisor];
    return error / s->largest;
}

static cli_error_point point_of(const sampled *s, const char *quantity)
{
    cli_error_point p = cli_error_no_point();
    snprintf(p.scene, sizeof p.scene, "%s, q = .%.0f", s->signal->name, 10 * s->order);
    snprintf(p.quantity, sizeof p.quantity, "%s", quantity);
    p.reference = s->exact[s->steps];
    p.steps = s->steps;
    return p;
}

/* D^q of the sampled velocities by a memory. */
static int derive(sampled *s, const cost *memory, rheo_weights rule)
{
    rheo_history_modes modes;
    const size_t count = s->steps + 1;
    rheo_result result;
    if (memory->kind == RHEO_HISTORY_WINDOW) {
        result = rheo_fractional_derivative(s->velocity, count, s->order, STEP, memory->window, rule, s->result);
    } else {
        result = rheo_history_fit_kind(memory->kind, s->order, memory->window ? memory->window : 1, rule, &modes);
        const uint32_t window = memory->kind == RHEO_HISTORY_WINDOW_FAST ? memory->window : 0;
        if (result == RHEO_OK)
            result = rheo_fractional_derivative_by_modes(s->velocity, count, &modes, s->order, STEP, window, rule,
                                                         s->result);
    }
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &(rheo_error){"cannot compute D^q of a signal"});
}

static void name_memory(const cost *memory, rheo_weights rule, cli_error_point *p)
{
    const char *kind = rheo_scene_parameter_find("history.kind")->choices[memory->kind],
               *weights = rule == RHEO_WEIGHTS_L1 ? "l1" : "paper";
    snprintf(p->series, sizeof p->series, "%s, %s", kind, weights);
    if (memory->window)
        snprintf(p->setting, sizeof p->setting, "%s, d = %u, %s", kind, memory->window, weights);
    else
        snprintf(p->setting, sizeof p->setting, "%s, %s", kind, weights);
    p->ns_step = memory->ns;
    p->bytes = memory->bytes;
    p->particles = memory->particles;
    p->hash = memory->hash;
}

/* The largest difference of kind window-fast from kind window, as a fraction of the largest D^q of the latter. */
static int add_fast(sampled *s, const cost *memory, rheo_weights rule, cli_error_points *points)
{
    cli_error_point p = point_of(s, "D^q of kind window");
    const cost slow = {.kind = RHEO_HISTORY_WINDOW, .window = memory->window};
    double *fast = s->spare, largest = 0, error = 0;
    memcpy(fast, s->result, (s->steps + 1) * sizeof *fast);
    const int status = derive(s, &slow, rule);
    if (status != CLI_DONE)
        return status;
    for (size_t n = 0; n <= s->steps; n++) {
        largest = fmax(largest, fabs(s->result[n]));
        error = fmax(error, fabs(fast[n] - s->result[n]));
    }
    name_memory(memory, rule, &p);
    p.value = fast[s->steps];
    p.reference = s->result[s->steps];
    p.error = error / largest;
    return cli_error_add(points, &p) ? CLI_DONE : CLI_SYSTEM;
}

static int add_memories(sampled *s, const cost memory[MEMORIES], cli_error_points *points)
{
    int status = CLI_DONE;
    sample(s, 1, SUBSTEPS);
    for (int rule = RHEO_WEIGHTS_PAPER; rule <= RHEO_WEIGHTS_L1; rule++)
        for (size_t m = 0; m < MEMORIES && status == CLI_DONE; m++) {
            if ((status = derive(s, &memory[m], (rheo_weights)rule)) != CLI_DONE)
                break;
            cli_error_point p = point_of(s, "D^q");
            name_memory(&memory[m], (rheo_weights)rule, &p);
            p.error = error_of(s, 1, &p.value);
            if (!cli_error_add(points, &p))
                return CLI_SYSTEM;
            if (memory[m].kind == RHEO_HISTORY_WINDOW_FAST)
                status = add_fast(s, &memory[m], (rheo_weights)rule, points);
        }
    return status;
}

/* The rules for smaller and smaller steps, with the whole history. */
static int add_rules(sampled *s, cli_error_points *points)
{
    static const struct {
        const char *name;
        rheo_weights weights;
        double substeps;
    } RULE[] = {{"paper, 1 substep", RHEO_WEIGHTS_PAPER, 1},
                {"l1, 1 substep", RHEO_WEIGHTS_L1, 1},
                {"paper, 2 substeps", RHEO_WEIGHTS_PAPER, 2},
                {"l1, 2 substeps", RHEO_WEIGHTS_L1, 2},
                {"paper, velocities of the signal", RHEO_WEIGHTS_PAPER, 0}};
    for (size_t r = 0; r < sizeof RULE / sizeof *RULE; r++)
        for (size_t divisor = 1; divisor < 1 << HALVINGS; divisor *= 2) {
            const double step = STEP / (double)divisor;
            sample(s, divisor, RULE[r].substeps);
            const rheo_result result = rheo_fractional_derivative(s->velocity, s->steps * divisor + 1, s->order, step,
                                                                  0, RULE[r].weights, s->result);
            if (result != RHEO_OK)
                return cli_error(result, &(rheo_error){"cannot compute D^q of a signal"});
            cli_error_point p = point_of(s, "D^q, all steps");
            snprintf(p.series, sizeof p.series, "%s", RULE[r].name);
            if (divisor == 1)
                snprintf(p.setting, sizeof p.setting, "%s, step", RULE[r].name);
            else
                snprintf(p.setting, sizeof p.setting, "%s, step/%zu", RULE[r].name, divisor);
            p.refinement = step;
            p.steps = s->steps * divisor;
            p.error = error_of(s, divisor, &p.value);
            if (!cli_error_add(points, &p))
                return CLI_SYSTEM;
        }
    return CLI_DONE;
}

/* Exponentials and their error for more and more lags. */
static int add_fits(cli_error_points *points)
{
    static const uint32_t LAGS[] = {4, 15, 50, 150, 500, 1000, 4096, 16384};
    for (size_t q = 0; q < ORDERS; q++)
        for (size_t i = 0; i < sizeof LAGS / sizeof *LAGS; i++) {
            rheo_history_modes modes;
            const rheo_result result = rheo_history_fit(ORDER[q], LAGS[i], RHEO_WEIGHTS_PAPER, &modes);
            if (result != RHEO_OK)
                return cli_error(result, &(rheo_error){"cannot fit exponentials to the weights"});
            cli_error_point p = cli_error_no_point();
            snprintf(p.scene, sizeof p.scene, "fit, q = .%.0f", 10 * ORDER[q]);
            snprintf(p.setting, sizeof p.setting, "%u lags", LAGS[i]);
            snprintf(p.quantity, sizeof p.quantity, "exponentials");
            p.value = modes.count;
            p.error = modes.error;
            p.steps = LAGS[i];
            if (!cli_error_add(points, &p))
                return CLI_SYSTEM;
        }
    return CLI_DONE;
}

int cli_error_history(cli_bench_arguments *a, cli_error_points *points)
{
    cost memory[MEMORIES];
    sampled s = {.steps = (size_t)(a->steps ? a->steps : STEPS)};
    bool any = false;
    for (size_t i = 0; i < CLI_SIGNALS; i++)
        any = cli_case_wanted(a, cli_signal_list[i].name) || any;
    if (!any)
        return CLI_DONE;
    const size_t most = (s.steps << (HALVINGS - 1)) + 1;
    s.velocity = malloc(4 * most * sizeof *s.velocity);
    if (!s.velocity)
        return cli_fail(CLI_SYSTEM, "no memory for signals of %zu steps", s.steps);
    s.result = s.velocity + most;
    s.exact = s.result + most;
    s.spare = s.exact + most;
    list_memories(memory);
    int status = measure_costs(memory, a);
    for (size_t i = 0; i < CLI_SIGNALS && status == CLI_DONE; i++)
        for (size_t q = 0; q < ORDERS && status == CLI_DONE; q++) {
            s.signal = &cli_signal_list[i];
            s.order = ORDER[q];
            if (!cli_case_wanted(a, s.signal->name))
                continue;
            find_exact(&s);
            if (!(s.largest > 0))
                continue; /* it has not begun */
            status = add_memories(&s, memory, points);
            if (status == CLI_DONE)
                status = add_rules(&s, points);
            if (cli_progress_due(&a->progress, cli_now()))
                cli_progress_say(&a->progress, cli_now(), "%s, q = %.1f", s.signal->name, s.order);
        }
    free(s.velocity);
    return status == CLI_DONE ? add_fits(points) : status;
}
