/* Protocols of the block under a given shear rate: the flow curve up and down, the start of a flow, and its stop. */
#include "cli/rheometer_block.h"

#include <math.h>
#include <stdlib.h>

/* Steps that a memory needs to fill, as far as its window goes. */
static size_t memory_steps(const cli_block *b)
{
    return rheo_world_history_window(b->rest) + (size_t)rheo_world_history_lag(b->rest);
}

/* ---- Flow curve ---- */

static const char *const WAY[] = {"up", "down"};
static const double STEADY = .05, BALANCED = .1;
enum { LEAST_WINDOW = 30, MOST_WINDOWS = 6 };
#define WINDOW_STRAIN .5

/* Why the stress is no steady one: it still changes, or the momentum of one plate has not reached the other. */
static const char *unsteady(const cli_shear *s, size_t first, size_t window, double tolerance, double *mean)
{
    const size_t count = s->samples - first;
    double unbalance;
    const char *why = cli_steady_mean(s->stress + first, count, window, tolerance, 0, mean);
    if (why)
        return why;
    cli_steady_mean(s->unbalance + first, count, window, 1, 0, &unbalance);
    return fabs(unbalance) <= BALANCED * fabs(*mean) ? NULL : "not steady: the forces on the plates differ";
}

/* Goes from one rate to another, and holds it until the stress is steady; adds a row. */
static int hold(cli_shear *s, cli_protocol_table *t, double before, double rate, bool down)
{
    const cli_block *b = s->block;
    const size_t least[] = {memory_steps(b) / 2, LEAST_WINDOW, cli_block_steps(b, b->diffusion_time)};
    size_t window = cli_block_steps(b, WINDOW_STRAIN / rate);
    for (int i = 0; i < 3; i++)
        window = window > least[i] ? window : least[i];
    double mean = NAN;
    const char *why = "";
    int status = before == rate ? CLI_DONE : cli_shear_ramp(s, before, rate, window);
    const size_t first = s->samples;
    for (int i = 0; i < MOST_WINDOWS && why && status == CLI_DONE; i++) {
        status = cli_shear_run(s, window);
        why = unsteady(s, first, window, STEADY, &mean);
    }
    if (status != CLI_DONE)
        return status;
    if (why)
        cli_table_note(t,
                       "Not steady after %d windows: the rows with steady = 0. The fit (yield_stress, exponent, "
                       "consistency) leaves them out, the loop (loop_area, loop_share) their rates on both ways.",
                       MOST_WINDOWS);
    cli_table_add(t, (double[]){rate, mean, mean / rate, down, !why, (double)(s->samples - first) * b->step * rate});
    return CLI_DONE;
}

/* Rates at even distances on a logarithmic axis. */
static cli_values rates_of(const cli_block *b, bool small)
{
    const double top = fmin(10 * cli_block_rate(b), cli_block_most_rate(b)), decades = small ? 1 : 2;
    cli_values rates = {small ? 4 : 7, {0}};
    for (size_t i = 0; i < rates.count; i++)
        rates.value[i] = top * pow(10, decades * ((double)i / (double)(rates.count - 1) - 1));
    return rates;
}

static int check_rates(const cli_block *b, const cli_values *rates)
{
    char most[32], got[32];
    for (size_t i = 0; i < rates->count; i++)
        if (rates->value[i] > 4 * cli_block_most_rate(b))
            return cli_fail(
                CLI_BAD,
                "--rate %s moves the plate by more than a support in a step; with this step it must be below %s 1/T",
                rheo_number_brief(rates->value[i], 4, got), rheo_number_brief(4 * cli_block_most_rate(b), 3, most));
    return CLI_DONE;
}

void cli_put_flow_law(cli_protocol_table *t, const char *of, const double *rate, const double *stress, size_t count,
                      const cli_flow_names *name)
{
    cli_flow_law law = {NAN, NAN, NAN, NAN};
    if (!cli_flow_fit(rate, stress, count, &law)) {
        cli_table_note(t, "No flow law%s: it needs four rates, and stresses above 0.", of);
        law = (cli_flow_law){NAN, NAN, NAN, NAN};
    } else if (law.error > CLI_FLOW_ERROR) {
        cli_table_note(t, "No flow law%s: yield stress + consistency x rate^n is off by %.0f %%.", of,
                       100 * law.error);
        law = (cli_flow_law){NAN, NAN, NAN, law.error};
    }
    cli_table_figure_is(t, name->yield, name->stress_unit, law.yield);
    cli_table_figure_is(t, name->exponent, "1", law.exponent);
    cli_table_figure_is(t, name->consistency, name->consistency_unit, law.consistency);
    cli_table_figure_is(t, name->error, "1", law.error < 1e-9 ? 1e-9 : law.error);
}

static void flow_figures(cli_protocol_table *t, double ramp_time)
{
    static const cli_flow_names NAMES = {"yield_stress", "exponent", "consistency",
                                         "fit_error",    "L^2/T^2",  "L^2/T^(2-n)"};
    double rate[CLI_RHEOMETER_VALUES], stress[CLI_RHEOMETER_VALUES]; /* steady ones of the way up */
    double loop_rate[2 * CLI_RHEOMETER_VALUES], loop_stress[2 * CLI_RHEOMETER_VALUES], up = 0;
    size_t ups = 0, loops = 0;
    for (size_t i = 0; i < t->rows; i++) {
        /* The same rate on the other way. */
        const double *row = t->value + i * t->columns, *other = t->value + (t->rows - 1 - i) * t->columns;
        const bool down = row[3] != 0, both = row[4] != 0 && other[4] != 0;
        if (row[4] != 0 && !down) {
            rate[ups] = row[0];
            stress[ups++] = row[1];
        }
        if (!both)
            continue;
        loop_rate[loops] = row[0];
        loop_stress[loops++] = row[1];
        if (!down && loops > 1)
            up += (row[0] - loop_rate[loops - 2]) * (row[1] + loop_stress[loops - 2]) / 2;
    }
    /* The loop runs up, and down again: the area is positive if the stress is lower on the way down. */
    const double area = loops < 4 ? NAN : cli_loop_area(loop_rate, loop_stress, loops);
    cli_table_figure_is(t, "loop_area", "L^2/T^3", area);
    cli_table_figure_is(t, "loop_share", "1", area / up);
    cli_table_figure_is(t, "ramp_time", "T", ramp_time);
    cli_put_flow_law(t, "", rate, stress, ups, &NAMES);
}

static int measure_flow(cli_measurement *m, const cli_block *b)
{
    const cli_values otherwise = rates_of(b, m->small), *rates = cli_values_or(&m->rates, &otherwise);
    cli_protocol_table *t = cli_rheometer_table(m, "flow");
    snprintf(
        t->about, sizeof t->about,
        "each shear rate, up and down, is held until the means of two successive windows differ by at most %.0f %% and the "
        "forces on both plates by at most %.0f %%: windows of strain %.1f, at least %d steps, half of the memory and the time "
        "in which momentum crosses the gap, at most %d of them, after a ramp of one; fit: yield stress + consistency x "
        "rate^n of the way up",
        100 * STEADY, 100 * BALANCED, WINDOW_STRAIN, LEAST_WINDOW, MOST_WINDOWS);
    cli_table_set_columns(t,
                          (const cli_table_column[]){{"shear_rate", "1/T", NULL},
                                                     {"stress", "L^2/T^2", NULL},
                                                     {"viscosity", "L^2/T", NULL},
                                                     {"way", "", WAY},
                                                     {"steady", "1", NULL},
                                                     {"strain", "1", NULL}},
                          6);
    t->panel[t->panels++] = (struct cli_table_panel){"shear_rate", "stress", "way", true, false};
    t->panel[t->panels++] = (struct cli_table_panel){"shear_rate", "viscosity", "way", true, false};
    cli_shear s = {0};
    double before = rates->value[0];
    int status = check_rates(b, rates);
    if (status == CLI_DONE)
        status = cli_shear_begin(&s, b, m, "flow", "velocity", rates->value[0]);
    for (size_t i = 0; i < 2 * rates->count && status == CLI_DONE; i++) {
        const bool down = i >= rates->count;
        const double rate = rates->value[down ? 2 * rates->count - 1 - i : i];
        status = hold(&s, t, before, rate, down);
        before = rate;
    }
    if (status == CLI_DONE)
        flow_figures(t, (double)s.samples * b->step);
    cli_shear_release(&s);
    return status;
}

/* ---- Start and stop ---- */

/* Strain of a start, and the last part of it whose mean is the steady stress. */
static const double START_STRAIN = 3, LAST_STRAIN = 1;

static double start_rate(const cli_measurement *m, const cli_block *b)
{
    return m->rates.count ? m->rates.value[m->rates.count / 2] : fmin(cli_block_rate(b), cli_block_most_rate(b)) / 2;
}

/* Shears a block at rest. The samples stay in the shear. */
static int start(cli_measurement *m, const cli_block *b, cli_shear *s, const char *name, double rate, double *steady,
                 const char **why)
{
    const cli_values one = {1, {rate}};
    int status = check_rates(b, &one);
    if (status == CLI_DONE)
        status = cli_shear_begin(s, b, m, name, "velocity", rate);
    if (status == CLI_DONE)
        status = cli_shear_run(s, cli_block_steps(b, START_STRAIN / rate));
    if (status == CLI_DONE)
        *why = unsteady(s, 0, cli_block_steps(b, LAST_STRAIN / rate), STEADY, steady);
    return status;
}

static void note_start(cli_protocol_table *t, const char *why)
{
    if (why)
        cli_table_note(t, "The last stress of the flow is no steady one: %s.", why);
}

static int measure_startup(cli_measurement *m, const cli_block *b)
{
    const double rate = start_rate(m, b);
    char text[32];
    cli_protocol_table *t = cli_rheometer_table(m, "startup");
    snprintf(t->about, sizeof t->about,
             "from rest to the shear rate %s 1/T, up to strain %.0f; steady: mean of the last strain %.0f",
             rheo_number_brief(rate, 3, text), START_STRAIN, LAST_STRAIN);
    cli_table_set_columns(
        t, (const cli_table_column[]){{"time", "T", NULL}, {"strain", "1", NULL}, {"stress", "L^2/T^2", NULL}}, 3);
    t->panel[t->panels++] = (struct cli_table_panel){"strain", "stress", NULL, false, false};
    t->brief = true;
    cli_shear s = {0};
    double steady = NAN;
    const char *why = NULL;
    const int status = start(m, b, &s, "startup", rate, &steady, &why);
    size_t peak = 0;
    for (size_t i = 0; i < s.samples && status == CLI_DONE; i++) {
        cli_table_add(t, (double[]){s.time[i], s.strain[i], s.stress[i]});
        peak = s.stress[i] > s.stress[peak] ? i : peak;
    }
    if (status == CLI_DONE) {
        note_start(t, why);
        cli_table_figure_is(t, "shear_rate", "1/T", rate);
        cli_table_figure_is(t, "peak_stress", "L^2/T^2", s.stress[peak]);
        cli_table_figure_is(t, "peak_strain", "1", s.strain[peak]);
        cli_table_figure_is(t, "steady_stress", "L^2/T^2", steady);
        cli_table_figure_is(t, "overshoot", "1", s.stress[peak] / steady - 1);
    }
    cli_shear_release(&s);
    return status;
}

static int measure_stop(cli_measurement *m, const cli_block *b)
{
    const double rate = start_rate(m, b), alpha = rheo_world_definition(b->rest)->springs.plasticity;
    char text[32];
    /* Long enough for the springs to flow and for the memory to forget. */
    size_t steps = 2 * memory_steps(b) + 60;
    const size_t flows = alpha > 0 ? cli_block_steps(b, 8 / alpha) : 0;
    steps = steps > flows ? steps : flows;
    cli_protocol_table *t = cli_rheometer_table(m, "stop");
    snprintf(t->about, sizeof t->about,
             "sheared at %s 1/T up to strain %.0f, then the plate stops; left: mean of the last tenth of %zu steps",
             rheo_number_brief(rate, 3, text), START_STRAIN, steps);
    cli_table_set_columns(t, (const cli_table_column[]){{"time", "T", NULL}, {"stress", "L^2/T^2", NULL}}, 2);
    t->panel[t->panels++] = (struct cli_table_panel){"time", "stress", NULL, false, false};
    t->brief = true;
    cli_shear s = {0};
    double steady = NAN, left = NAN;
    const char *why = NULL;
    int status = start(m, b, &s, "stop", rate, &steady, &why);
    const size_t first = s.samples - (status == CLI_DONE); /* the last stress of the flow is at time 0 */
    if (status == CLI_DONE)
        status = cli_shear_set(&s, "plates.velocity", true, 0);
    if (status == CLI_DONE)
        status = cli_shear_run(&s, steps);
    if (status == CLI_DONE) {
        const double stopped = s.time[first];
        for (size_t i = first; i < s.samples; i++) {
            s.time[i] -= stopped;
            cli_table_add(t, (double[]){s.time[i], s.stress[i]});
        }
        cli_steady_mean(s.stress, s.samples, steps / 10, 1, 0, &left);
        s.stress[first] = steady; /* without the noise of one sample */
        const double time = cli_decay_time(s.time + first, s.stress + first, s.samples - first, left, exp(-1));
        note_start(t, why);
        cli_table_figure_is(t, "shear_rate", "1/T", rate);
        cli_table_figure_is(t, "stress_before", "L^2/T^2", steady);
        cli_table_figure_is(t, "stress_left", "L^2/T^2", left);
        cli_table_figure_is(t, "time_to_1_e", "T", time);
    }
    cli_shear_release(&s);
    return status;
}

/* ---- With a block of their own ---- */

int cli_block_check_rates(const cli_measurement *m)
{
    return cli_check_slowest(m, "--rate", &m->rates, fmax((1 + MOST_WINDOWS) * WINDOW_STRAIN, START_STRAIN));
}

int cli_block_flow(cli_measurement *m)
{
    return cli_block_measure(m, measure_flow);
}

int cli_block_startup(cli_measurement *m)
{
    return cli_block_measure(m, measure_startup);
}

int cli_block_stop(cli_measurement *m)
{
    return cli_block_measure(m, measure_stop);
}
