/* Protocols of the block under oscillations and under constant stress: amplitude sweep and creep. */
#include "cli/rheometer_block.h"

#include <math.h>
#include <stdlib.h>

static const double TURN = 6.28318530717958647692;
static const double STEADY = .03;
enum { MOST_WINDOWS = 12 };

/* ---- Amplitude sweep ---- */

typedef struct sweep {
    cli_protocol_table *table;
    const cli_block *block;
    const cli_memory *memory;
    cli_spring_law law; /* of a spring that stands for the affine network: K in units of its shear modulus */
    cli_sweep_point point[CLI_RHEOMETER_VALUES * CLI_RHEOMETER_VALUES];
    size_t points;
} sweep;

/* The affine network: moduli of docs/model.md with the response of the memory; NaN where unknown. */
static void affine(const sweep *s, double amplitude, double omega, cli_harmonics *h)
{
    double response[2] = {0, 0};
    if (s->law.k_hist > 0)
        cli_memory_response(s->memory, omega, response);
    cli_spring_moduli(&s->law, amplitude, omega, response, (s->memory->lag + 1) * s->memory->step, h);
}

static int oscillate(cli_measurement *m, sweep *s, double amplitude, double wanted)
{
    const cli_block *b = s->block;
    cli_oscillation o = {amplitude, cli_block_steps(b, TURN / wanted), 1, 0};
    const double omega = TURN / ((double)o.samples * b->step);
    /* The force of a step is a mean over it, so it belongs to the middle of the step. */
    o.first = .5 / (double)o.samples;
    cli_shear shear;
    cli_harmonics h, exact;
    const char *why = "";
    int status = cli_shear_begin(&shear, b, m, "amplitude", "velocity", 0);
    if (status == CLI_DONE)
        status = cli_shear_set(&shear, "plates.frequency", false, 1 / ((double)o.samples * b->step));
    if (status == CLI_DONE)
        status = cli_shear_set(&shear, "plates.amplitude", false, amplitude * b->gap);
    for (int i = 0; i < MOST_WINDOWS && why && status == CLI_DONE; i++) {
        status = cli_shear_run(&shear, o.samples);
        if (status == CLI_DONE)
            why = cli_harmonics_of(shear.stress, shear.samples, &o, STEADY, &h);
        if (!why && shear.samples < (size_t)s->memory->window + s->memory->lag + 2 * o.samples)
            why = "the memory is not full";
    }
    const size_t periods = shear.samples / o.samples;
    cli_shear_release(&shear);
    if (status != CLI_DONE)
        return status;
    if (b->shear_modulus > 0 && omega > 2.1 * cli_block_omega(b))
        cli_table_note(s->table,
                       "At omega %.3g the inertia of the fluid counts: a shear wave crosses the gap in %.2g periods.",
                       omega, .5 * omega / cli_block_omega(b) / TURN);
    if (why)
        cli_table_note(s->table, "Not steady after %d periods: the rows with steady = 0.", MOST_WINDOWS);
    affine(s, amplitude, omega, &exact);
    /* The fit is of springs, so of K instead of its modulus. */
    const double to_spring = rheo_world_definition(b->rest)->springs.stiffness / b->shear_modulus;
    s->point[s->points++] = (cli_sweep_point){amplitude, omega, h.storage * to_spring, h.loss * to_spring};
    cli_table_add(s->table,
                  (double[]){omega, amplitude, h.storage, h.loss, h.loss / h.storage, h.third / h.first, h.area,
                             exact.storage > 0 ? h.storage / exact.storage : NAN, !why, (double)periods});
    return CLI_DONE;
}

static void begin_sweep(const cli_block *b, cli_protocol_table *t, const cli_memory *memory, sweep *s)
{
    const rheo_world_def *def = rheo_world_definition(b->rest);
    const bool history = def->springs.stiffness > 0 && def->history.stiffness > 0;
    *s = (sweep){.table = t, .block = b, .memory = memory};
    /* k_hist length per k_min is history modulus per shear modulus. */
    const double length =
        history ? b->history_modulus / def->history.stiffness / (b->shear_modulus / def->springs.stiffness)
                : def->fluid.spacing;
    const double unit = b->shear_modulus / def->springs.stiffness;
    s->law =
        (cli_spring_law){b->shear_modulus, history ? def->history.stiffness * unit : 0, def->history.onset, length};
}

static int measure_amplitude(cli_measurement *m, const cli_block *b)
{
    const double base = cli_block_omega(b);
    const cli_values strains = {m->small ? 3 : 4, {.003, .01, .03, .1}}, turns = {m->small ? 1 : 2, {base, base / 3}};
    const cli_values *gamma = cli_values_or(&m->amplitudes, &strains), *omega = cli_values_or(&m->omegas, &turns);
    cli_protocol_table *t = cli_rheometer_table(m, "amplitude");
    snprintf(
        t->about, sizeof t->about,
        "strain gamma0 sin(omega t) from rest; harmonics of the last period, once the window of the memory, if it has one, is full and the first "
        "harmonic changes by at most %.0f %% from period to period, at most %d periods; network_factor: G' over that "
        "of an affine network of springs (closed form)",
        100 * STEADY, MOST_WINDOWS);
    const cli_table_column columns[] = {{"omega", "1/T", NULL},         {"gamma0", "1", NULL},
                                        {"G_prime", "L^2/T^2", NULL},   {"G_double_prime", "L^2/T^2", NULL},
                                        {"tan_delta", "1", NULL},       {"I3_I1", "1", NULL},
                                        {"loop_area", "L^2/T^2", NULL}, {"network_factor", "1", NULL},
                                        {"steady", "1", NULL},          {"periods", "1", NULL}};
    cli_table_set_columns(t, columns, sizeof columns / sizeof *columns);
    t->panel[t->panels++] = (struct cli_table_panel){"gamma0", "G_prime", "omega", true, false};
    t->panel[t->panels++] = (struct cli_table_panel){"gamma0", "G_double_prime", "omega", true, false};
    t->panel[t->panels++] = (struct cli_table_panel){"gamma0", "I3_I1", "omega", true, false};
    const rheo_world_def *def = rheo_world_definition(b->rest);
    cli_memory memory;
    const rheo_result made = cli_memory_make(def, def->history.kind, def->history.order, &memory);
    int status =
        made == RHEO_OK ? CLI_DONE : cli_error(made, &(rheo_error){"the memory of the block cannot be made"});
    sweep *s = calloc(1, sizeof *s);
    if (status == CLI_DONE && !s)
        status = cli_fail(CLI_SYSTEM, "no memory for the amplitude sweep");
    if (status == CLI_DONE)
        begin_sweep(b, t, &memory, s);
    for (size_t k = 0; k < omega->count && status == CLI_DONE; k++)
        for (size_t i = 0; i < gamma->count && status == CLI_DONE; i++)
            status = oscillate(m, s, gamma->value[i], omega->value[k]);
    if (status == CLI_DONE && m->fit) {
        cli_put_fit(t, def, s->law.length, s->point, s->points);
        status = cli_rheometer_go_on(m, "amplitude");
    }
    free(s);
    cli_memory_release(&memory);
    return status;
}

/* ---- Creep ---- */

static int creep(cli_measurement *m, const cli_block *b, cli_protocol_table *t, double stress, size_t steps)
{
    cli_shear s;
    int status = cli_shear_begin(&s, b, m, "creep", "stress", 0);
    if (status == CLI_DONE)
        status = cli_shear_set(&s, "plates.stress", false, stress);
    if (status == CLI_DONE)
        status = cli_shear_run(&s, steps);
    if (status == CLI_DONE) {
        double slope, intercept;
        const size_t half = steps / 2;
        cli_line_fit(s.time + half, s.strain + half, steps - half, &slope, &intercept);
        for (size_t i = 0; i < s.samples; i++)
            cli_table_add(t, (double[]){s.time[i], s.strain[i], stress, s.strain[i] / stress, slope});
    }
    cli_shear_release(&s);
    return status;
}

static int measure_creep(cli_measurement *m, const cli_block *b)
{
    enum { MOST_FIGURES = 5 }; /* stresses with figures of their own: CLI_TABLE_FIGURES / 3 */
    const double unit = b->yield_stress > 0 ? b->yield_stress : 4;
    const cli_values few = {2, {.5 * unit, 4 * unit}}, more = {4, {.5 * unit, unit, 2 * unit, 4 * unit}};
    const cli_values *stress = cli_values_or(&m->stresses, m->small ? &few : &more);
    const size_t steps = cli_block_steps(b, (m->small ? 10 : 20) / cli_block_rate(b));
    cli_protocol_table *t = cli_rheometer_table(m, "creep");
    snprintf(t->about, sizeof t->about,
             "strain under constant stress from rest, %zu steps; creep_rate: slope of the second half", steps);
    const cli_table_column columns[] = {{"time", "T", NULL},
                                        {"strain", "1", NULL},
                                        {"stress", "L^2/T^2", NULL},
                                        {"compliance", "T^2/L^2", NULL},
                                        {"creep_rate", "1/T", NULL}};
    cli_table_set_columns(t, columns, sizeof columns / sizeof *columns);
    t->panel[t->panels++] = (struct cli_table_panel){"time", "strain", "stress", false, false};
    t->brief = true;
    int status = CLI_DONE;
    for (size_t i = 0; i < stress->count && status == CLI_DONE; i++) {
        status = creep(m, b, t, stress->value[i], steps);
        if (status == CLI_DONE && t->rows) {
            static const char *const NAME[MOST_FIGURES][3] = {{"stress_1", "strain_1", "creep_rate_1"},
                                                              {"stress_2", "strain_2", "creep_rate_2"},
                                                              {"stress_3", "strain_3", "creep_rate_3"},
                                                              {"stress_4", "strain_4", "creep_rate_4"},
                                                              {"stress_5", "strain_5", "creep_rate_5"}};
            const double *last = t->value + (t->rows - 1) * t->columns;
            if (i < MOST_FIGURES) {
                cli_table_figure_is(t, NAME[i][0], "L^2/T^2", stress->value[i]);
                cli_table_figure_is(t, NAME[i][1], "1", last[1]);
                cli_table_figure_is(t, NAME[i][2], "1/T", last[4]);
            }
        }
    }
    if (stress->count > MOST_FIGURES)
        cli_table_note(t, "The figures are of the first %d stresses; the rows are of all.", MOST_FIGURES);
    return status;
}

int cli_block_check_omegas(const cli_measurement *m)
{
    return cli_check_slowest(m, "--omega", &m->omegas, MOST_WINDOWS * TURN);
}

int cli_block_amplitude(cli_measurement *m)
{
    return cli_block_measure(m, measure_amplitude);
}

int cli_block_creep(cli_measurement *m)
{
    return cli_block_measure(m, measure_creep);
}
