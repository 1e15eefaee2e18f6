/* What fluid the block of `rheolog rheometer` is, in words. */
#include "cli/rheometer_block.h"

#include <math.h>
#include <string.h>

enum { LINE = sizeof(((cli_measurement *)0)->summary[0]) };

/* The next row of the way up whose stress is steady and has a logarithm, or the count of rows. */
static size_t next_up(const cli_protocol_table *t, size_t i)
{
    for (; i < t->rows; i++) {
        const double *row = t->value + i * t->columns;
        if (row[3] != 0)
            return t->rows;
        if (row[4] != 0 && row[1] > 0)
            return i;
    }
    return i;
}

/* A flow curve that no law fits: where it is steepest, and where it falls. */
static void say_curve(const cli_protocol_table *t, char line[LINE])
{
    char a[32], b[32], c[32];
    double steepest = -INFINITY, from = NAN, to = NAN, fall = 1, fall_at = NAN;
    const size_t begin = next_up(t, 0);
    const double *before = t->value + begin * t->columns;
    if (begin == t->rows) {
        snprintf(line, LINE, "flow: no steady stress above 0 on the way up");
        return;
    }
    for (size_t i = next_up(t, begin + 1); i < t->rows; i = next_up(t, i + 1)) {
        const double *row = t->value + i * t->columns;
        const double slope = log(row[1] / before[1]) / log(row[0] / before[0]);
        if (slope > steepest) {
            steepest = slope;
            from = before[0];
            to = row[0];
        }
        if (row[1] / before[1] < fall) {
            fall = row[1] / before[1];
            fall_at = before[0];
        }
        before = row;
    }
    if (isnan(from)) {
        snprintf(line, LINE, "flow: stress %s L^2/T^2 at %s 1/T; its law needs more rates",
                 rheo_number_brief(before[1], 3, a), rheo_number_brief(before[0], 3, b));
        return;
    }
    snprintf(line, LINE, "flow: %s, stress up to rate^%s between %s and %s 1/T",
             steepest > 1.05 ? "shear thickening" : "shear thinning", rheo_number_brief(steepest, 3, a),
             rheo_number_brief(from, 3, b), rheo_number_brief(to, 3, c));
    if (fall < .8)
        snprintf(line + strlen(line), LINE - strlen(line), "; above %s 1/T it breaks, and the stress falls to %s %%",
                 rheo_number_brief(fall_at, 3, a), rheo_number_brief(100 * fall, 2, b));
}

/* Flow: Newtonian, or with a yield stress, thinning or thickening. */
static void say_flow(const cli_protocol_table *t, char line[LINE])
{
    char a[32], b[32];
    const double yield = cli_table_figure_of(t, "yield_stress"), n = cli_table_figure_of(t, "exponent"),
                 consistency = cli_table_figure_of(t, "consistency");
    double low = INFINITY; /* stress at the lowest rate, by the law */
    for (size_t i = 0; i < t->rows; i++)
        low = fmin(low, yield + consistency * pow(t->value[i * t->columns], n));
    const char *bends = n < .95 ? "shear thinning" : n > 1.05 ? "shear thickening" : "of constant viscosity";
    if (isnan(yield))
        say_curve(t, line);
    else if (yield < .05 * low && n >= .95 && n <= 1.05)
        snprintf(line, LINE, "flow: Newtonian, viscosity %s L^2/T", rheo_number_brief(consistency, 3, a));
    else if (yield > .05 * low)
        snprintf(line, LINE, "flow: yield stress %s L^2/T^2; beyond it %s, stress - yield stress grows as rate^%s",
                 rheo_number_brief(yield, 3, a), bends, rheo_number_brief(n, 3, b));
    else
        snprintf(line, LINE, "flow: no yield stress; %s, stress grows as rate^%s", bends, rheo_number_brief(n, 3, a));
}

/* Oscillation: elastic or viscous, and what the amplitude changes. */
static void say_oscillation(const cli_protocol_table *t, char line[LINE])
{
    char a[32], b[32], c[32];
    const double *first = NULL, *last = NULL;
    for (size_t i = 0; i < t->rows; i++) {
        const double *row = t->value + i * t->columns;
        if (row[8] == 0 || !(row[2] > 0))
            continue;
        first = first ? first : row;
        if (row[0] == first[0] && row[1] >= first[1]) /* rows of several seeds begin again */
            last = row;
    }
    if (!first) {
        snprintf(line, LINE, "oscillation: inertia or unsteadiness hides whether it is elastic or viscous");
        return;
    }
    const double ratio = last[2] / first[2];
    snprintf(line, LINE, "oscillation at %s 1/T: %s, tan delta %s at gamma0 %s", rheo_number_brief(first[0], 3, a),
             first[4] < .5  ? "elastic"
             : first[4] > 2 ? "viscous"
                            : "viscoelastic",
             rheo_number_brief(first[4], 3, b), rheo_number_brief(first[1], 3, c));
    if (last[1] > first[1])
        snprintf(line + strlen(line), LINE - strlen(line), "; it %s with the amplitude: G' x %s at %s",
                 ratio > 1.1  ? "stiffens"
                 : ratio < .9 ? "softens"
                              : "hardly changes",
                 rheo_number_brief(ratio, 3, a), rheo_number_brief(last[1], 3, b));
}

/* Memory: hysteresis of the flow curve, overshoot of a start, stress after a stop; each only if it is known. */
static void say_memory(const cli_measurement *m, char line[LINE])
{
    char a[32];
    /* History and rest lengths are of springs. Fluid without any has no memory. */
    const char *memory = m->scene.world.springs.stiffness > 0 ? "memory: " : "";
    const cli_protocol_table *flow = cli_table_of(m, "flow"), *start = cli_table_of(m, "startup"),
                             *stop = cli_table_of(m, "stop");
    const double share = flow ? cli_table_figure_of(flow, "loop_share") : NAN,
                 overshoot = start ? cli_table_figure_of(start, "overshoot") : NAN,
                 time = stop ? cli_table_figure_of(stop, "time_to_1_e") : NAN,
                 left = stop ? cli_table_figure_of(stop, "stress_left") / cli_table_figure_of(stop, "stress_before")
                             : NAN;
    if (isfinite(share))
        snprintf(line, LINE, "%s%s, loop %s %% of the way up", memory,
                 fabs(share) < .05 ? "no hysteresis" : "hysteresis", rheo_number_brief(100 * share, 2, a));
    if (isfinite(overshoot))
        snprintf(line + strlen(line), LINE - strlen(line), "%sa start overshoots by %s %%", *line ? "; " : memory,
                 rheo_number_brief(100 * overshoot, 2, a));
    if (isfinite(time) || isfinite(left))
        snprintf(line + strlen(line), LINE - strlen(line), "%safter a stop", *line ? "; " : memory);
    if (isfinite(time))
        snprintf(line + strlen(line), LINE - strlen(line), " 1/e in %s T", rheo_number_brief(time, 3, a));
    if (isfinite(left))
        snprintf(line + strlen(line), LINE - strlen(line), "%s %s %% of the stress stays", isfinite(time) ? "," : "",
                 rheo_number_brief(100 * left, 2, a));
}

/* Whether the strain of these rows grows as fast in their last quarter as in the one before, by a fifth. */
static bool flows_steadily(const cli_protocol_table *t, size_t first, size_t count)
{
    const double *half = t->value + (first + count / 2) * t->columns,
                 *quarter = t->value + (first + count * 3 / 4) * t->columns,
                 *end = t->value + (first + count - 1) * t->columns;
    const double before = (quarter[1] - half[1]) / (quarter[0] - half[0]),
                 after = (end[1] - quarter[1]) / (end[0] - quarter[0]);
    return fabs(after - before) <= .2 * fmax(fabs(after), fabs(before));
}

/* Creep: the largest stress at which the strain comes to rest, and the smallest one at which it goes on. */
static void say_creep(const cli_protocol_table *t, char line[LINE])
{
    char a[32], b[32], c[32];
    double rests = -INFINITY, flows = INFINITY, rate = NAN;
    bool steady = false;
    size_t first = 0; /* row of a stress */
    for (size_t i = 0; i < t->rows; i++) {
        const double *row = t->value + i * t->columns;
        if (i + 1 < t->rows && row[t->columns] > row[0])
            continue; /* the last row is where the time begins again */
        if (row[4] * row[0] < .1 * row[1])
            rests = fmax(rests, row[2]);
        else if (row[2] < flows) {
            flows = row[2];
            rate = row[4];
            steady = flows_steadily(t, first, i + 1 - first);
        }
        first = i + 1;
    }
    if (rests > 0)
        snprintf(line, LINE, "creep: comes to rest under %s L^2/T^2", rheo_number_brief(rests, 3, a));
    if (flows < INFINITY)
        snprintf(line + strlen(line), LINE - strlen(line),
                 steady ? "%s under %s%s it flows at %s 1/T"
                        : "%s under %s%s it creeps on, at no steady rate (%s 1/T)",
                 *line ? ";" : "creep:", rheo_number_brief(flows, 3, b), *line ? "" : " L^2/T^2",
                 rheo_number_brief(rate, 3, c));
}

static void sum_up(cli_measurement *m)
{
    size_t line = 0;
    const cli_protocol_table *flow = cli_table_of(m, "flow"), *amplitude = cli_table_of(m, "amplitude");
    if (flow && flow->rows)
        say_flow(flow, m->summary[line++]);
    if (amplitude && amplitude->rows)
        say_oscillation(amplitude, m->summary[line++]);
    say_memory(m, m->summary[line]);
    const cli_protocol_table *creep = cli_table_of(m, "creep");
    line += *m->summary[line] != 0;
    if (creep && creep->rows && line < 3)
        say_creep(creep, m->summary[line]);
}

/* Other schemes and history.of length have no periodic space, which the block needs. Slow flows take hours. */
static int check(const cli_measurement *m)
{
    const rheo_world_def *def = &m->scene.world;
    if (def->scheme == RHEO_SCHEME_SUMMED && def->history.of == RHEO_HISTORY_OF_VECTOR) {
        const int status = cli_block_check_rates(m);
        return status == CLI_DONE ? cli_block_check_omegas(m) : status;
    }
    return cli_fail(CLI_BAD, "the block needs scheme summed and history.of vector; %s has %s", m->scene_name,
                    def->scheme == RHEO_SCHEME_SEQUENTIAL  ? "scheme sequential"
                    : def->scheme == RHEO_SCHEME_POSITIONS ? "scheme positions"
                                                           : "history.of length");
}

static const cli_protocol PROTOCOLS[] = {
    {"flow", "stress and viscosity at shear rates that rise and fall", cli_block_flow, "--rate --seeds"},
    {"startup", "stress from rest to one shear rate", cli_block_startup, "--rate --seeds"},
    {"stop", "stress after the plate stops", cli_block_stop, "--rate --seeds"},
    {"amplitude", "G', G'' and the third harmonic at several amplitudes and frequencies", cli_block_amplitude,
     "--gamma --omega --fit --seeds"},
    {"creep", "strain under constant stress", cli_block_creep, "--stress --seeds"},
    {NULL, NULL, NULL, NULL},
};

const cli_instrument cli_block_instrument = {
    "block",
    "fluid between two plates; stress is divided by the number density, times kg/m^3 it is in Pa (L in m, T in s)",
    PROTOCOLS,
    sum_up,
    "",
    check};
