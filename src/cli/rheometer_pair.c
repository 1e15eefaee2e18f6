/*
 * The pair of `rheolog rheometer --pair`: one spring of the main material, between an end that rests and one that is driven along
 * their line. Nothing is simulated: the functions of rheolog/history.h act on the driven velocities as stage fractional_derivative
 * acts on those of a world, in double.
 *
 * The length is L0 (1 + strain) with L0 = fluid.spacing, and the spring was made at the length L0. A step reads the velocities at
 * the ends of the steps before it, less the lag; its force acts at the length at its end. stress = K strain, with K of docs/model.md
 * (3): the force of Eq. 6 over L0, unit 1/T^2. Rest lengths flow in protocol `stop` only.
 */
#include "cli/rheometer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TURN = 6.28318530717958647692;

/* Steps of a window: as many phases of the oscillation, which bound the error of its harmonics by about 1/steps^2. */
enum { WINDOW_STEPS = 4000, LEAST_WINDOWS = 3 };
static const double MOST_PRODUCTS = 4e9; /* of one sum over a window: some seconds */

static const char *const KIND[] = {"window", "window-fast", "full", "tempered"};

static const rheo_world_def *def_of(const cli_measurement *r)
{
    return &r->scene.world;
}

/* The frequency nearest to a wanted one at which whole periods are whole steps; no phase comes twice. */
static double choose_window(double wanted, double step, cli_oscillation *o)
{
    const double periods = floor(WINDOW_STEPS * wanted * step / TURN + .5);
    o->periods = periods < 1 ? 1 : (size_t)periods;
    o->samples = cli_coprime((size_t)(TURN * (double)o->periods / (wanted * step) + .5), o->periods);
    o->first = 0;
    return TURN * (double)o->periods / ((double)o->samples * step);
}

/* Turns of the oscillation at a step, exactly for whole windows. */
static double turns_at(const cli_oscillation *o, size_t n)
{
    return (double)(n % o->samples * o->periods % o->samples) / (double)o->samples;
}

typedef struct drive {
    double omega;
    cli_oscillation window;
    size_t count;       /* of samples: two windows after the memory has forgotten the start */
    double *derivative; /* D^q of the strain, for the amplitude 1 */
    double response[2]; /* H(w) */
} drive;

static int no_memory(void)
{
    return cli_fail(CLI_SYSTEM, "no memory for the signals of the pair");
}

/* Drives the pair at a frequency. `cure` is for a window that is too long. Release `derivative` in any case. */
static int make_drive(const cli_memory *memory, double wanted, const char *cure, drive *d)
{
    *d = (drive){0};
    d->omega = choose_window(wanted, memory->step, &d->window);
    const size_t reach = cli_memory_reach(memory);
    /* Whole windows, so that the phase of a sample is exact. */
    d->count = (reach / d->window.samples + LEAST_WINDOWS) * d->window.samples;
    if (memory->kind == RHEO_HISTORY_WINDOW && (double)d->count * memory->window > MOST_PRODUCTS) {
        char steps[32];
        return cli_fail(CLI_BAD, "a window of %lu steps takes too long to sum over %s steps; %s",
                        (unsigned long)memory->window, rheo_number_brief((double)d->count, 3, steps), cure);
    }
    double *velocity = malloc(d->count * sizeof *velocity);
    d->derivative = malloc(d->count * sizeof *d->derivative);
    if (!velocity || !d->derivative) {
        free(velocity);
        return no_memory();
    }
    for (size_t n = 0; n < d->count; n++)
        velocity[n] = d->omega * cos(TURN * turns_at(&d->window, n));
    const rheo_result result = cli_memory_apply(memory, velocity, d->count, d->derivative);
    cli_memory_response(memory, d->omega, d->response);
    free(velocity);
    return result == RHEO_OK ? CLI_DONE : cli_error(result, &(rheo_error){"the memory of the pair cannot be summed"});
}

/* Whether the pair has a history. A scene without one still has k_min. */
static double history_of(const rheo_world_def *def)
{
    return def->springs.stiffness > 0 ? def->history.stiffness : 0;
}

static int check(const cli_measurement *r)
{
    if (!(def_of(r)->springs.stiffness > 0))
        return cli_fail(CLI_BAD, "%s has no springs, so there is no pair to drive: springs.stiffness is 0",
                        r->scene_name);
    if (def_of(r)->scheme == RHEO_SCHEME_POSITIONS)
        return cli_fail(CLI_BAD, "%s has no springs, so there is no pair to drive: scheme is positions",
                        r->scene_name);
    if (def_of(r)->history.of == RHEO_HISTORY_OF_LENGTH)
        return cli_fail(CLI_BAD, "the pair needs history.of vector; %s has length", r->scene_name);
    return cli_check_slowest(r, "--omega", &r->omegas, LEAST_WINDOWS * TURN);
}

/* Refuses a frequency of which a step would see too little. */
static int check_omega(const rheo_world_def *def, double omega)
{
    char most[32], got[32];
    const double limit = TURN / (8 * def->step);
    if (omega < limit)
        return CLI_DONE;
    return cli_fail(CLI_BAD, "omega %s has less than 8 steps in a period; with this step it must be below %s 1/T",
                    rheo_number_brief(omega, 4, got), rheo_number_brief(limit, 4, most));
}

/* ---- Amplitude sweep ---- */

typedef struct sweep {
    double *stress;
    cli_sweep_point point[CLI_RHEOMETER_VALUES * CLI_RHEOMETER_VALUES];
    size_t points;
} sweep;

static void measure_amplitude(cli_protocol_table *t, sweep *s, const cli_spring_law *law, double amplitude,
                              const drive *d, double delay)
{
    const size_t shown = 2 * d->window.samples, first = d->count - shown;
    for (size_t i = 0; i < shown; i++) {
        const double n = law->length * amplitude * fabs(d->derivative[first + i]);
        const double k = law->k_min + (n > 0 ? law->k_hist * n * n / (n + law->onset) : 0);
        s->stress[i] = k * amplitude * sin(TURN * turns_at(&d->window, first + i));
    }
    cli_oscillation o = d->window;
    o.amplitude = amplitude;
    cli_harmonics h, exact;
    const char *why = cli_harmonics_of(s->stress, shown, &o, 1e-6, &h);
    if (why)
        cli_table_note(t, "omega %.4g: %s.", d->omega, why);
    cli_spring_moduli(law, amplitude, d->omega, d->response, delay, &exact);
    s->point[s->points++] = (cli_sweep_point){amplitude, d->omega, h.storage, h.loss};
    const double ratio = h.loss / h.storage;
    cli_table_add(t, (double[]){d->omega, amplitude, h.storage, h.loss, ratio, h.third / h.first, exact.storage,
                                exact.loss, exact.third / exact.first, h.area});
}

static int amplitude(cli_measurement *r)
{
    static const cli_values amplitudes = {3, {.01, .03, .1}}, omegas = {4, {.3, 1, 3, 10}};
    const cli_values *gamma = cli_values_or(&r->amplitudes, &amplitudes), *omega = cli_values_or(&r->omegas, &omegas);
    const rheo_world_def *def = def_of(r);
    const cli_spring_law law = {def->springs.stiffness, history_of(def), def->history.onset, def->fluid.spacing};
    cli_protocol_table *t = cli_rheometer_table(r, "amplitude");
    snprintf(t->about, sizeof t->about,
             "one spring, strain gamma0 sin(omega t) along its line, plasticity off; harmonics of %d steps of whole "
             "periods after the memory has forgotten the start; exact: closed forms with H(omega)",
             WINDOW_STEPS);
    const cli_table_column columns[] = {{"omega", "1/T", NULL},           {"gamma0", "1", NULL},
                                        {"G_prime", "1/T^2", NULL},       {"G_double_prime", "1/T^2", NULL},
                                        {"tan_delta", "1", NULL},         {"I3_I1", "1", NULL},
                                        {"G_prime_exact", "1/T^2", NULL}, {"G_double_prime_exact", "1/T^2", NULL},
                                        {"I3_I1_exact", "1", NULL},       {"loop_area", "1/T^2", NULL}};
    cli_table_set_columns(t, columns, sizeof columns / sizeof *columns);
    t->panel[t->panels++] = (struct cli_table_panel){"gamma0", "G_prime", "omega", true, false};
    t->panel[t->panels++] = (struct cli_table_panel){"gamma0", "G_double_prime", "omega", true, false};
    t->panel[t->panels++] = (struct cli_table_panel){"gamma0", "I3_I1", "omega", true, false};
    cli_memory memory;
    const rheo_result made = cli_memory_make(def, def->history.kind, def->history.order, &memory);
    int status = made == RHEO_OK ? CLI_DONE : cli_error(made, &(rheo_error){"the memory of the pair cannot be made"});
    sweep *s = calloc(1, sizeof *s);
    if (status == CLI_DONE && !s)
        status = no_memory();
    for (size_t k = 0; k < omega->count && status == CLI_DONE; k++) {
        drive d = {0};
        status = check_omega(def, omega->value[k]);
        if (status == CLI_DONE)
            status = make_drive(&memory, omega->value[k], "use --set history.kind=window-fast", &d);
        s->stress = status == CLI_DONE ? malloc(2 * d.window.samples * sizeof *s->stress) : NULL;
        if (status == CLI_DONE && !s->stress)
            status = no_memory();
        for (size_t i = 0; i < gamma->count && status == CLI_DONE; i++) {
            measure_amplitude(t, s, &law, gamma->value[i], &d, (memory.lag + 1) * memory.step);
            status = cli_rheometer_go_on(r, "amplitude");
        }
        free(s->stress);
        free(d.derivative);
    }
    double worst = 0;
    for (size_t i = 0; i < t->rows; i++) {
        const double *row = t->value + i * t->columns, size = hypot(row[6], row[7]);
        worst = fmax(worst, fmax(fabs(row[2] - row[6]), fabs(row[3] - row[7])) / size);
    }
    cli_table_figure_is(t, "difference_below", "1", cli_bound(worst));
    if (status == CLI_DONE && r->fit) {
        cli_put_fit(t, def, def->fluid.spacing, s->point, s->points);
        status = cli_rheometer_go_on(r, "amplitude");
    }
    free(s);
    cli_memory_release(&memory);
    return status;
}

void cli_put_fit(cli_protocol_table *t, const rheo_world_def *def, double length, const cli_sweep_point *point,
                 size_t count)
{
    cli_model_fit fit;
    const char *why = cli_fit_model(def, length, point, count, cli_interrupted, &fit);
    if (why) {
        cli_table_note(t, "No fit: %s.", why);
        fit = (cli_model_fit){NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    }
    const double most = fmax(fit.order, fmax(fit.order_by_omega, fit.order_by_loss)),
                 least = fmin(fit.order, fmin(fit.order_by_omega, fit.order_by_loss));
    if (!why && most - least > .03 * most)
        cli_table_note(t, "The three ways to the order q differ by more than 3 %%: this is no such fluid.");
    cli_table_figure_is(t, "fit_q", "1", fit.order);
    cli_table_figure_is(t, "fit_q_by_omega", "1", fit.order_by_omega);
    cli_table_figure_is(t, "fit_q_by_loss", "1", fit.order_by_loss);
    cli_table_figure_is(t, "fit_k_min", "1/T^2", fit.k_min);
    cli_table_figure_is(t, "fit_k_hist", "T^(q-2)/L", fit.k_hist);
    cli_table_figure_is(t, "fit_amplitude_slope", "1", fit.amplitude_slope);
    cli_table_figure_is(t, "fit_error", "1", fit.error < 1e-9 ? 1e-9 : fit.error);
}

/* ---- Response of memories ---- */

/* Measures D^q of an oscillation, and compares it with H(w) v. */
static void measure_response(cli_protocol_table *t, const cli_memory *memory, const drive *d)
{
    double part[2] = {0, 0};
    const size_t samples = d->window.samples, first = d->count - samples, late = (size_t)memory->lag + 1;
    for (size_t i = 0; i < samples; i++) { /* against the phase of the newest velocity that counts */
        const double angle = TURN * turns_at(&d->window, first + i + samples - late % samples);
        part[0] += d->derivative[first + i] * cos(angle) * 2 / (double)samples / d->omega;
        part[1] -= d->derivative[first + i] * sin(angle) * 2 / (double)samples / d->omega;
    }
    const double size = hypot(part[0], part[1]), q = memory->order;
    const double off = hypot(part[0] - d->response[0], part[1] - d->response[1]) / size;
    /* of the springpot: (i w)^(q-1) */
    const double ratio = memory->curve ? NAN : size * pow(d->omega, 1 - q),
                 phase = memory->curve ? NAN : atan2(part[1], part[0]) / TURN * 360 + 90 * (1 - q);
    cli_table_add(t, (double[]){(double)memory->kind, d->omega, size, atan2(part[1], part[0]) / TURN * 360, ratio,
                                phase, cli_bound(off)});
}

static int response(cli_measurement *r)
{
    static const cli_values omegas = {4, {.3, 1, 3, 10}};
    const cli_values *omega = cli_values_or(&r->omegas, &omegas);
    const rheo_world_def *def = def_of(r);
    cli_protocol_table *t = cli_rheometer_table(r, "response");
    snprintf(
        t->about, sizeof t->about,
        "D^q x of an oscillation over its velocity, for each kind of memory with this order, window and weights; "
        "ratio and phase to those of (i omega)^(q-1); error_below: bound of the distance from the closed form H(omega)");
    const cli_table_column columns[] = {
        {"kind", "", KIND},   {"omega", "1/T", NULL},           {"size", "T^(1-q)", NULL}, {"phase", "degrees", NULL},
        {"ratio", "1", NULL}, {"ratio_phase", "degrees", NULL}, {"error_below", "1", NULL}};
    cli_table_set_columns(t, columns, sizeof columns / sizeof *columns);
    t->panel[t->panels++] = (struct cli_table_panel){"omega", "size", "kind", true, false};
    t->panel[t->panels++] = (struct cli_table_panel){"omega", "phase", "kind", false, false};
    const int kinds = def->history.curve_count ? 1 : 4;
    double worst = 0;
    int status = CLI_DONE;
    for (int kind = 0; kind < kinds && status == CLI_DONE; kind++) {
        cli_memory memory;
        const rheo_result made = cli_memory_make(def, (rheo_history_kind)kind, def->history.order, &memory);
        if (made != RHEO_OK)
            status = cli_error(made, &(rheo_error){"a memory of the pair cannot be made"});
        for (size_t k = 0; k < omega->count && status == CLI_DONE; k++) {
            drive d = {0};
            status = check_omega(def, omega->value[k]);
            if (status == CLI_DONE)
                status = make_drive(&memory, omega->value[k],
                                    "response compares every kind with this sum: name amplitude and stop instead, or "
                                    "use a higher --omega, a larger step or a shorter history.window",
                                    &d);
            if (status == CLI_DONE) {
                measure_response(t, &memory, &d);
                worst = fmax(worst, t->value[t->rows * t->columns - 1]);
            }
            free(d.derivative);
            if (status == CLI_DONE)
                status = cli_rheometer_go_on(r, "response");
        }
        cli_memory_release(&memory);
    }
    cli_table_figure_is(t, "difference_below", "1", cli_bound(worst));
    return status;
}

/* ---- Relaxation ---- */

static double substeps_of(const rheo_world_def *def)
{
    rheo_derived derived;
    for (uint32_t i = 0; rheo_world_def_derived(def, i, &derived); i++)
        if (strcmp(derived.name, "substeps") == 0 && derived.value >= 1)
            return derived.value;
    return 1;
}

static int stop(cli_measurement *r)
{
    enum { TIMES = 8 }; /* Maxwell times */
    const rheo_world_def *def = def_of(r);
    const double alpha = def->springs.plasticity, gamma = def->springs.yield_ratio, k = def->springs.stiffness;
    const double strain = r->amplitudes.count ? r->amplitudes.value[0] : fmax(.5, 3 * gamma);
    const double substeps = substeps_of(def), tau = def->step / substeps, maxwell = 1 / (alpha * (1 + gamma));
    cli_protocol_table *t = cli_rheometer_table(r, "stop");
    snprintf(
        t->about, sizeof t->about,
        "one spring, stretched at once by the strain %.4g and held: its rest length flows as stage densities lets "
        "it, in %.0f substeps a step; no history; exact: (1 - alpha tau (1 + gamma))^k",
        strain, substeps);
    const cli_table_column columns[] = {
        {"time", "T", NULL}, {"stress", "1/T^2", NULL}, {"stress_exact", "1/T^2", NULL}, {"rest_length", "L", NULL}};
    cli_table_set_columns(t, columns, sizeof columns / sizeof *columns);
    t->panel[t->panels++] = (struct cli_table_panel){"time", "stress", NULL, false, false};
    t->brief = true;
    if (!(alpha > 0)) {
        cli_table_note(t, "springs.plasticity is 0: the stress stays.");
        return CLI_DONE;
    }
    const double length = def->fluid.spacing * (1 + strain), rest_of_all = length / (1 + gamma);
    const size_t count = (size_t)fmin(1e5, TIMES * maxwell / def->step + 2);
    double rest = def->fluid.spacing, factor = 1, worst = 0;
    double *series = malloc(2 * count * sizeof *series);
    if (!series)
        return no_memory();
    for (size_t n = 0; n < count; n++) {
        const double exact = rest_of_all + (def->fluid.spacing - rest_of_all) * factor;
        const double stress = k * (length - rest) / def->fluid.spacing,
                     of_exact = k * (length - exact) / def->fluid.spacing;
        cli_table_add(t, (double[]){(double)n * def->step, stress, of_exact, rest});
        series[n] = (double)n * def->step;
        series[count + n] = stress;
        worst = fmax(worst, fabs(stress / of_exact - 1));
        for (double i = 0; i < substeps; i++) {
            if (length > rest + gamma * rest)
                rest += alpha * tau * (length - rest - gamma * rest);
            factor *= 1 - alpha * tau * (1 + gamma);
        }
    }
    const double left = k * (length - rest_of_all) / def->fluid.spacing;
    cli_table_figure_is(t, "time_to_1_e", "T", cli_decay_time(series, series + count, count, left, exp(-1)));
    cli_table_figure_is(t, "maxwell_time", "T", maxwell);
    cli_table_figure_is(t, "stress_left", "1/T^2", left);
    cli_table_figure_is(t, "difference_below", "1", cli_bound(worst));
    free(series);
    return CLI_DONE;
}

/* ---- What it is ---- */

static void sum_up(cli_measurement *r)
{
    const rheo_world_def *def = def_of(r);
    char a[32], b[32];
    size_t line = 0;
    const cli_protocol_table *sweep_of = cli_table_of(r, "amplitude"), *stop_of = cli_table_of(r, "stop");
    if (sweep_of && sweep_of->rows) {
        const uint32_t columns = sweep_of->columns;
        double least = INFINITY, most = 0, third = 0, stiff = 0;
        for (size_t i = 0; i < sweep_of->rows; i++) {
            const double *row = sweep_of->value + i * columns;
            least = fmin(least, row[4]);
            most = fmax(most, row[4]);
            third = fmax(third, row[5]);
            stiff = fmax(stiff, row[2] / def->springs.stiffness);
        }
        snprintf(r->summary[line++], sizeof r->summary[0], "elastic: tan delta is %s%s%s",
                 rheo_number_brief(least, 3, a), most > least ? " to " : "",
                 most > least ? rheo_number_brief(most, 3, b) : "");
        if (stiff > 1.001)
            snprintf(r->summary[line++], sizeof r->summary[0],
                     "stiffens with the strain: up to %s k_min, I3/I1 up to %s", rheo_number_brief(stiff, 3, a),
                     rheo_number_brief(third, 3, b));
        else
            snprintf(r->summary[line++], sizeof r->summary[0], "linear: no history at these strains");
    }
    if (stop_of && !isnan(cli_table_figure_of(stop_of, "maxwell_time")))
        snprintf(r->summary[line++], sizeof r->summary[0],
                 "flows beyond a strain of %s: the stress falls to 1/e in %s T",
                 rheo_number_brief(def->springs.yield_ratio, 3, a),
                 rheo_number_brief(cli_table_figure_of(stop_of, "time_to_1_e"), 3, b));
}

static const cli_protocol PROTOCOLS[] = {
    {"amplitude", "G', G'' and the third harmonic at several amplitudes and frequencies", amplitude,
     "--gamma --omega --fit"},
    {"response", "D^q of an oscillation, for every kind of memory", response, "--omega"},
    {"stop", "relaxation at a fixed stretch", stop, "--gamma"},
    {NULL, NULL, NULL, NULL},
};

const cli_instrument cli_pair_instrument = {
    "pair", "one spring, driven along its line by the functions of rheolog/history.h", PROTOCOLS, sum_up, "pair-",
    check};
