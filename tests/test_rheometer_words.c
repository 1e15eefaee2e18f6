/* Tables of `rheolog rheometer`, and what it says of a fluid: the sentences that follow from known rows and figures. */
#include "support.h"

#include "cli/rheometer_block.h"

#include <math.h>

/* ---- What the file needs of others ---- */

static char refusal[256];
static int checks[2]; /* calls of the checks of rates and frequencies */

int cli_fail(int code, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(refusal, sizeof refusal, format, arguments);
    va_end(arguments);
    return code;
}

int cli_block_check_rates(const cli_measurement *m)
{
    checks[0]++;
    return m->rates.count ? CLI_BAD : CLI_DONE;
}

int cli_block_check_omegas(const cli_measurement *m)
{
    checks[1]++;
    return m->omegas.count ? CLI_BAD : CLI_DONE;
}

#define NEVER(name)              \
    int name(cli_measurement *m) \
    {                            \
        (void)m;                 \
        return CLI_BAD;          \
    }
NEVER(cli_block_flow)
NEVER(cli_block_startup)
NEVER(cli_block_stop)
NEVER(cli_block_amplitude)
NEVER(cli_block_creep)

/* ---- Tables ---- */

static cli_measurement measured;

static void begin(void)
{
    for (uint32_t i = 0; i < measured.tables; i++)
        cli_table_release(&measured.table[i]);
    measured = (cli_measurement){.scene_name = "some"};
    measured.scene.world.springs.stiffness = 1;
}

static cli_protocol_table *add(const char *name, uint32_t columns)
{
    cli_protocol_table *t = cli_rheometer_table(&measured, name);
    t->columns = columns;
    return t;
}

/* Asserts a line of the summary. "" : there is none. */
static void assert_said(uint32_t line, const char *expected)
{
    memset(measured.summary, 0, sizeof measured.summary);
    cli_block_instrument.sum_up(&measured);
    if (strcmp(measured.summary[line], expected) != 0)
        fail_msg("\"%s\" is not \"%s\"", measured.summary[line], expected);
}

/* ---- What tables do ---- */

static void a_table_grows_and_finds_its_names(void **unused)
{
    (void)unused;
    enum { ROWS = 100 };
    static const cli_table_column columns[] = {{"time", "T", NULL}, {"stress", "1", NULL}};
    begin();
    cli_protocol_table *t = cli_rheometer_table(&measured, "one");
    cli_table_set_columns(t, columns, 2);
    for (int i = 0; i < ROWS; i++)
        cli_table_add(t, (double[]){i, -2 * i});
    assert_int_equal(t->rows, ROWS);
    assert_true(t->capacity >= ROWS && t->capacity < 2 * ROWS && !t->failed);
    for (int i = 0; i < ROWS; i++)
        assert_true(t->value[2 * i] == i && t->value[2 * i + 1] == -2 * i);
    assert_int_equal(cli_table_column_of(t, "time"), 0);
    assert_int_equal(cli_table_column_of(t, "stress"), 1);
    assert_int_equal(cli_table_column_of(t, "strain"), 2); /* none */
    for (uint32_t i = 0; i < CLI_TABLE_FIGURES + 2; i++) {
        static char name[CLI_TABLE_FIGURES + 2][8];
        snprintf(name[i], sizeof name[i], "f%u", (unsigned)i);
        cli_table_figure_is(t, name[i], "1", i + .5);
        assert_true(isnan(cli_table_figure_of(t, "g")));
        const double found = cli_table_figure_of(t, name[i]);
        assert_true(i < CLI_TABLE_FIGURES ? found == i + .5 && isnan(t->figure[i].spread) : isnan(found));
    }
    cli_table_note(t, "The rate %d is unsteady.", 3);
    cli_table_note(t, "No law.");
    cli_table_note(t, "The rate %d is unsteady.", 3);
    assert_string_equal(t->note, "The rate 3 is unsteady. No law.");
    assert_ptr_equal(cli_table_of(&measured, "one"), t);
    assert_null(cli_table_of(&measured, "two"));
    const cli_values none = {0, {1}}, some = {1, {2}};
    assert_ptr_equal(cli_values_or(&none, &some), &some);
    assert_ptr_equal(cli_values_or(&some, &none), &some);
}

static void a_bound_is_the_next_power_of_ten(void **unused)
{
    (void)unused;
    static const double bounds[][2] = {{0, 1e-9}, {1e-12, 1e-9}, {2e-9, 1e-8}, {9e-8, 1e-7}, {.002, .01}, {3, 10}};
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++)
        assert_true(fabs(cli_bound(bounds[i][0]) / bounds[i][1] - 1) < 1e-9);
    assert_true(cli_bound(1e-9) == 1e-9);
}

/* Rows of all seeds with their number; of figures the middle one, or the lower one of two, and how far the others are. */
static void tables_of_seeds_are_joined(void **unused)
{
    (void)unused;
    enum { SEEDS = 4, FIGURES = 4 };
    static const double figure[SEEDS][FIGURES] = {
        {5, 5, NAN, NAN}, {1, 1, NAN, NAN}, {9, 4, 3, NAN}, {4, NAN, NAN, NAN}};
    static const double middle[SEEDS + 1][FIGURES][2] = {
        {{0, 0}},
        {{5, NAN}, {5, NAN}, {NAN, NAN}, {NAN, NAN}},
        {{1, 4}, {1, 4}, {NAN, NAN}, {NAN, NAN}},
        {{5, 4}, {4, 3}, {3, NAN}, {NAN, NAN}},
        {{4, 5}, {4, 3}, {3, NAN}, {NAN, NAN}},
    };
    static const char *const names[FIGURES] = {"a", "b", "c", "d"};
    static const uint64_t seeds[SEEDS] = {1, 2, 3, 7};
    for (size_t count = 1; count <= SEEDS; count++) {
        static const cli_table_column columns[] = {{"time", "T", NULL}, {"stress", "1", NULL}};
        cli_protocol_table *tables[SEEDS];
        begin();
        for (size_t k = 0; k < count; k++) {
            tables[k] = cli_rheometer_table(&measured, "one");
            cli_table_set_columns(tables[k], columns, 2);
            for (size_t row = 0; row <= k; row++)
                cli_table_add(tables[k], (double[]){(double)row, (double)(10 * k)});
            for (int i = 0; i < FIGURES; i++)
                cli_table_figure_is(tables[k], names[i], "1", figure[k][i]);
        }
        if (count > 2) {
            cli_table_note(tables[1], "Second.");
            cli_table_note(tables[2], "Second.");
            tables[2]->failed = true;
        }
        cli_table_join(tables, seeds, count);
        const cli_protocol_table *t = tables[0];
        assert_true(t->columns == 3 && t->rows == count * (count + 1) / 2);
        assert_string_equal(t->column[2].name, "seed");
        size_t at = 0;
        for (size_t k = 0; k < count; k++)
            for (size_t row = 0; row <= k; row++, at += 3)
                assert_true(t->value[at] == (double)row && t->value[at + 1] == (double)(10 * k) &&
                            t->value[at + 2] == (double)seeds[k]);
        for (int i = 0; i < FIGURES; i++) {
            const double *expected = middle[count][i], got[2] = {t->figure[i].value, t->figure[i].spread};
            for (int k = 0; k < 2; k++)
                if (!(got[k] == expected[k] || (isnan(got[k]) && isnan(expected[k]))))
                    fail_msg("%zu seeds, %s: %g is not %g", count, names[i], got[k], expected[k]);
        }
        assert_string_equal(t->note, count > 2 ? "Second." : "");
        assert_true(t->failed == (count > 2));
    }
}

/* ---- Flow ---- */

/* Rates fall, so that the lowest one is the last. */
static void add_law(double yield, double exponent, double consistency)
{
    begin();
    cli_protocol_table *t = add("flow", 6);
    for (double rate = 4; rate > .4; rate /= 2)
        cli_table_add(t, (double[]){rate, 1, 1, 0, 1, 1});
    cli_table_figure_is(t, "yield_stress", "", yield);
    cli_table_figure_is(t, "exponent", "", exponent);
    cli_table_figure_is(t, "consistency", "", consistency);
}

static void a_law_is_called_by_its_figures(void **unused)
{
    (void)unused;
    static const struct {
        double yield, exponent, consistency;
        const char *said;
    } laws[] = {
        {0, 1, 2, "Newtonian, viscosity 2 L^2/T"},
        {0, .95, 2, "Newtonian, viscosity 2 L^2/T"},
        {0, 1.05, 3, "Newtonian, viscosity 3 L^2/T"},
        {0, .94, 2, "no yield stress; shear thinning, stress grows as rate^0.94"},
        {0, 1.06, 2, "no yield stress; shear thickening, stress grows as rate^1.06"},
        /* At the lowest rate, .5, the stress is 1 and the yield stress. A twentieth of it counts. */
        {.05, 1, 2, "Newtonian, viscosity 2 L^2/T"},
        {.055, 1, 2,
         "yield stress 0.055 L^2/T^2; beyond it of constant viscosity, stress - yield stress grows as rate^1"},
        {3, .5, 2, "yield stress 3 L^2/T^2; beyond it shear thinning, stress - yield stress grows as rate^0.5"},
        {3, 2, 2, "yield stress 3 L^2/T^2; beyond it shear thickening, stress - yield stress grows as rate^2"},
    };
    for (size_t i = 0; i < sizeof laws / sizeof *laws; i++) {
        char line[320];
        add_law(laws[i].yield, laws[i].exponent, laws[i].consistency);
        snprintf(line, sizeof line, "flow: %s", laws[i].said);
        assert_said(0, line);
    }
}

static void a_curve_without_a_law_is_told_by_its_slopes(void **unused)
{
    (void)unused;
    enum { MOST = 6 };
    static const struct {
        double row[MOST][4]; /* rate, stress, way down, steady */
        const char *said;
    } curves[] = {
        {{{1, 5, 0, 0}, {2, 0, 0, 1}, {4, -1, 0, 1}, {1, 1, 1, 1}}, "no steady stress above 0 on the way up"},
        {{{1, 5, 0, 0}, {2, 0, 0, 1}}, "no steady stress above 0 on the way up"},
        {{{2, 3, 0, 1}, {4, 9, 0, 0}, {8, 0, 0, 1}, {4, 1, 1, 1}},
         "stress 3 L^2/T^2 at 2 1/T; its law needs more rates"},
        {{{1, 1, 0, 1}, {2, 4, 0, 1}, {4, 8, 0, 1}}, "shear thickening, stress up to rate^2 between 1 and 2 1/T"},
        {{{1, 1, 0, 1}, {2, 2, 0, 1}, {4, 8, 0, 1}}, "shear thickening, stress up to rate^2 between 2 and 4 1/T"},
        {{{1, 2, 0, 1}, {4, 4, 0, 1}, {16, 4, 0, 1}}, "shear thinning, stress up to rate^0.5 between 1 and 4 1/T"},
        {{{1, 1, 0, 1}, {2, 2, 0, 1}}, "shear thinning, stress up to rate^1 between 1 and 2 1/T"},
        /* An unsteady row between, and the way down, do not count. */
        {{{1, 1, 0, 1}, {2, 9, 0, 0}, {4, 16, 0, 1}, {2, 1e9, 1, 1}, {1, 1, 1, 1}},
         "shear thickening, stress up to rate^2 between 1 and 4 1/T"},
        /* A fall is told with where it begins, if it is by a fifth. */
        {{{1, 1, 0, 1}, {2, 4, 0, 1}, {4, 2, 0, 1}, {8, 1.5, 0, 1}},
         "shear thickening, stress up to rate^2 between 1 and 2 1/T; above 2 1/T it breaks, and the stress falls to 50 %"},
        {{{1, 1, 0, 1}, {2, 4, 0, 1}, {4, 3.16, 0, 1}},
         "shear thickening, stress up to rate^2 between 1 and 2 1/T; above 2 1/T it breaks, and the stress falls to 79 %"},
        {{{1, 1, 0, 1}, {2, 4, 0, 1}, {4, 3.24, 0, 1}}, "shear thickening, stress up to rate^2 between 1 and 2 1/T"},
    };
    for (size_t i = 0; i < sizeof curves / sizeof *curves; i++) {
        char line[320];
        begin();
        cli_protocol_table *t = add("flow", 6);
        for (int k = 0; k < MOST && curves[i].row[k][0] > 0; k++) {
            const double *row = curves[i].row[k];
            cli_table_add(t, (double[]){row[0], row[1], row[1] / row[0], row[2], row[3], 1});
        }
        snprintf(line, sizeof line, "flow: %s", curves[i].said);
        assert_said(0, line);
    }
}

/* ---- Oscillation ---- */

static void an_oscillation_is_told_by_its_first_frequency(void **unused)
{
    (void)unused;
    enum { MOST = 5 };
    static const struct {
        double row[MOST][5]; /* omega, gamma0, G', tan delta, steady */
        const char *said;
    } sweeps[] = {
        {{{1, .1, 5, .1, 0}, {1, .2, 0, .1, 1}, {2, .1, -1, .1, 1}},
         ": inertia or unsteadiness hides whether it is elastic or viscous"},
        {{{3, .1, 5, .49, 1}}, " at 3 1/T: elastic, tan delta 0.49 at gamma0 0.1"},
        {{{3, .1, 5, .5, 1}}, " at 3 1/T: viscoelastic, tan delta 0.5 at gamma0 0.1"},
        {{{3, .1, 5, 2, 1}}, " at 3 1/T: viscoelastic, tan delta 2 at gamma0 0.1"},
        {{{3, .1, 5, 2.1, 1}}, " at 3 1/T: viscous, tan delta 2.1 at gamma0 0.1"},
        {{{3, .1, 100, .1, 1}, {3, .2, 200, .1, 1}, {3, .4, 111, .1, 1}, {4, .8, 900, 3, 1}},
         " at 3 1/T: elastic, tan delta 0.1 at gamma0 0.1; it stiffens with the amplitude: G' x 1.11 at 0.4"},
        {{{3, .1, 100, .1, 1}, {3, .2, 109, .1, 1}, {3, .4, 900, .1, 0}},
         " at 3 1/T: elastic, tan delta 0.1 at gamma0 0.1; it hardly changes with the amplitude: G' x 1.09 at 0.2"},
        {{{3, .1, 100, .1, 1}, {3, .2, 91, .1, 1}},
         " at 3 1/T: elastic, tan delta 0.1 at gamma0 0.1; it hardly changes with the amplitude: G' x 0.91 at 0.2"},
        {{{3, .1, 100, .1, 1}, {3, .2, 89, .1, 1}},
         " at 3 1/T: elastic, tan delta 0.1 at gamma0 0.1; it softens with the amplitude: G' x 0.89 at 0.2"},
        /* The first steady row is not the lowest one; the rows of a second seed begin again below it. */
        {{{3, .1, 50, .1, 0}, {3, .2, 100, .1, 1}, {3, .4, 200, .1, 1}, {3, .1, 50, .1, 1}},
         " at 3 1/T: elastic, tan delta 0.1 at gamma0 0.2; it stiffens with the amplitude: G' x 2 at 0.4"},
    };
    for (size_t i = 0; i < sizeof sweeps / sizeof *sweeps; i++) {
        char line[320];
        begin();
        cli_protocol_table *t = add("amplitude", 9);
        for (int k = 0; k < MOST && sweeps[i].row[k][0] > 0; k++) {
            const double *row = sweeps[i].row[k];
            cli_table_add(t, (double[]){row[0], row[1], row[2], row[2] * row[3], row[3], 0, 0, 0, row[4]});
        }
        snprintf(line, sizeof line, "oscillation%s", sweeps[i].said);
        assert_said(0, line);
    }
}

/* ---- Memory ---- */

static void memory_is_told_as_far_as_it_is_known(void **unused)
{
    (void)unused;
    static const struct {
        double share, overshoot, time, before, left; /* NaN: not known */
        const char *said;
    } known[] = {
        {NAN, NAN, NAN, NAN, NAN, ""},
        {.049, NAN, NAN, NAN, NAN, "no hysteresis, loop 4.9 % of the way up"},
        {-.049, NAN, NAN, NAN, NAN, "no hysteresis, loop -4.9 % of the way up"},
        {.05, NAN, NAN, NAN, NAN, "hysteresis, loop 5 % of the way up"},
        {NAN, .5, NAN, NAN, NAN, "a start overshoots by 50 %"},
        {NAN, NAN, 2, NAN, NAN, "after a stop 1/e in 2 T"},
        {NAN, NAN, NAN, 4, 1, "after a stop 25 % of the stress stays"},
        {NAN, NAN, 2, 4, 1, "after a stop 1/e in 2 T, 25 % of the stress stays"},
        {.5, .25, 2, 4, 1,
         "hysteresis, loop 50 % of the way up; a start overshoots by 25 %; after a stop 1/e in 2 T, 25 % of the stress stays"},
        {NAN, .25, NAN, 4, 1, "a start overshoots by 25 %; after a stop 25 % of the stress stays"},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        for (int springs = 0; springs < 2; springs++) {
            char line[320];
            begin();
            measured.scene.world.springs.stiffness = springs;
            cli_table_figure_is(add("flow", 6), "loop_share", "", known[i].share);
            cli_table_figure_is(add("startup", 2), "overshoot", "", known[i].overshoot);
            cli_protocol_table *stop = add("stop", 2);
            cli_table_figure_is(stop, "time_to_1_e", "", known[i].time);
            cli_table_figure_is(stop, "stress_before", "", known[i].before);
            cli_table_figure_is(stop, "stress_left", "", known[i].left);
            snprintf(line, sizeof line, "%s%s", springs && *known[i].said ? "memory: " : "", known[i].said);
            assert_said(0, line);
        }
}

/* ---- Creep ---- */

/* Rows of one stress: its strain at the times 1 to 8, and the rate at the end, as the protocol has it. */
static void add_creep(cli_protocol_table *t, double stress, const double strain[8], double rate)
{
    for (int i = 0; i < 8; i++)
        cli_table_add(t, (double[]){i + 1, strain[i], stress, 0, rate});
}

static void creep_is_told_below_and_above_the_stress_that_flows(void **unused)
{
    (void)unused;
    static const double even[8] = {1, 2, 3, 4, 5, 6, 7, 8}, held[8] = {4, 4, 4, 4, 4, 4, 4, 4},
                        slower[8] = {1, 2, 3, 4, 5, 6, 7, 7.79}, slow[8] = {1, 2, 3, 4, 5, 6, 7, 7.81},
                        faster[8] = {1, 2, 3, 4, 5, 6, 7, 8.26}, fast[8] = {1, 2, 3, 4, 5, 6, 7, 8.24};
    begin();
    cli_protocol_table *t = add("creep", 5);
    add_creep(t, 1, held, 0);
    assert_said(0, "creep: comes to rest under 1 L^2/T^2");
    add_creep(t, 3, held, .04); /* less than a tenth of the strain in this time */
    assert_said(0, "creep: comes to rest under 3 L^2/T^2");
    add_creep(t, 2, held, 0);
    assert_said(0, "creep: comes to rest under 3 L^2/T^2");
    add_creep(t, 8, even, 1);
    assert_said(0, "creep: comes to rest under 3 L^2/T^2; under 8 it flows at 1 1/T");
    add_creep(t, 9, slower, 7); /* a larger stress that flows does not count */
    assert_said(0, "creep: comes to rest under 3 L^2/T^2; under 8 it flows at 1 1/T");
    add_creep(t, 5, slower, .7);
    assert_said(0, "creep: comes to rest under 3 L^2/T^2; under 5 it creeps on, at no steady rate (0.7 1/T)");
    add_creep(t, 4.5, slow, .9);
    assert_said(0, "creep: comes to rest under 3 L^2/T^2; under 4.5 it flows at 0.9 1/T");
    add_creep(t, 4.2, faster, 1.2);
    assert_said(0, "creep: comes to rest under 3 L^2/T^2; under 4.2 it creeps on, at no steady rate (1.2 1/T)");
    add_creep(t, 4, fast, 1.2);
    assert_said(0, "creep: comes to rest under 3 L^2/T^2; under 4 it flows at 1.2 1/T");
    begin();
    t = add("creep", 5);
    add_creep(t, 8, even, 1);
    assert_said(0, "creep: under 8 L^2/T^2 it flows at 1 1/T");
    begin();
    t = add("creep", 5);
    add_creep(t, 8, slower, 1);
    assert_said(0, "creep: under 8 L^2/T^2 it creeps on, at no steady rate (1 1/T)");
}

/* ---- All together ---- */

/* The three lines are flow, oscillation, and memory or else creep. */
static void the_lines_have_an_order(void **unused)
{
    (void)unused;
    static const double even[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    add_law(0, 1, 2);
    cli_table_add(add("amplitude", 9), (double[]){3, .1, 5, .5, .1, 0, 0, 0, 1});
    add_creep(add("creep", 5), 8, even, 1);
    assert_said(0, "flow: Newtonian, viscosity 2 L^2/T");
    assert_said(1, "oscillation at 3 1/T: elastic, tan delta 0.1 at gamma0 0.1");
    assert_said(2, "creep: under 8 L^2/T^2 it flows at 1 1/T");
    cli_table_figure_is(&measured.table[0], "loop_share", "", .5);
    assert_said(2, "memory: hysteresis, loop 50 % of the way up");
    measured.table[1].rows = 0; /* nothing is said of an empty table */
    assert_said(1, "memory: hysteresis, loop 50 % of the way up");
    assert_said(2, "creep: under 8 L^2/T^2 it flows at 1 1/T");
    measured.table[0].rows = measured.table[2].rows = 0;
    assert_said(0, "memory: hysteresis, loop 50 % of the way up");
    assert_said(1, "");
}

static void a_scene_that_the_block_cannot_measure_is_refused(void **unused)
{
    (void)unused;
    begin();
    rheo_world_def *def = &measured.scene.world;
    *def = rheo_default_world_def();
    assert_int_equal(cli_block_instrument.check(&measured), CLI_DONE);
    assert_true(checks[0] == 1 && checks[1] == 1);
    measured.rates.count = 1;
    assert_int_equal(cli_block_instrument.check(&measured), CLI_BAD);
    assert_true(checks[0] == 2 && checks[1] == 1);
    measured.rates.count = 0;
    measured.omegas.count = 1;
    assert_int_equal(cli_block_instrument.check(&measured), CLI_BAD);
    measured.omegas.count = 0;
    static const struct {
        rheo_scheme scheme;
        bool lengths;
        const char *has;
    } refused[] = {{RHEO_SCHEME_SEQUENTIAL, false, "scheme sequential"},
                   {RHEO_SCHEME_POSITIONS, false, "scheme positions"},
                   {RHEO_SCHEME_SUMMED, true, "history.of length"},
                   {RHEO_SCHEME_SEQUENTIAL, true, "scheme sequential"}};
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        char text[256];
        def->scheme = refused[i].scheme;
        def->history.of = refused[i].lengths ? RHEO_HISTORY_OF_LENGTH : RHEO_HISTORY_OF_VECTOR;
        snprintf(text, sizeof text, "the block needs scheme summed and history.of vector; some has %s",
                 refused[i].has);
        assert_int_equal(cli_block_instrument.check(&measured), CLI_BAD);
        assert_string_equal(refusal, text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_table_grows_and_finds_its_names),
        cmocka_unit_test(a_bound_is_the_next_power_of_ten),
        cmocka_unit_test(tables_of_seeds_are_joined),
        cmocka_unit_test(a_law_is_called_by_its_figures),
        cmocka_unit_test(a_curve_without_a_law_is_told_by_its_slopes),
        cmocka_unit_test(an_oscillation_is_told_by_its_first_frequency),
        cmocka_unit_test(memory_is_told_as_far_as_it_is_known),
        cmocka_unit_test(creep_is_told_below_and_above_the_stress_that_flows),
        cmocka_unit_test(the_lines_have_an_order),
        cmocka_unit_test(a_scene_that_the_block_cannot_measure_is_refused),
    };
    return cmocka_run_group_tests_name("rheometer_words", tests, NULL, NULL);
}
