/* What `rheolog experiments` prints of results that are made up: every word and digit, as text and as JSON. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "cli/experiment.h"

/* ---- In place of the program ---- */

void cli_print(FILE *file, size_t indent, const char *format, ...)
{
    va_list list;
    (void)indent; /* lines are not wrapped here */
    va_start(list, format);
    vfprintf(file, format, list);
    va_end(list);
}

const char *cli_status_name(int status)
{
    return status == CLI_DONE ? "done" : "interrupted";
}

const char *cli_said(void)
{
    return "a signal";
}

/* ---- Results ---- */

enum { FIGURES = 2, MOST = 6, SEEDS = 3 };

static const cli_experiment made_up = {
    .name = "made-up",
    .reference = "nobody",
    .about = "it shows nothing",
    .variant = {{.name = "a", .set = {"x=1", "y=2"}},
                {.name = "longer"},
                {.name = "c"},
                {.name = "d"},
                {.name = "e"},
                {.name = "f"}},
    .figure = {{"low", "L", "how low"}, {"much longer name", "", "how long"}},
    .whole = {{"exponent", "1", "of all"}},
    .claim = {{.figure = "low", .variant = "a", .relation = CLI_AT_MOST, .plus = 2},
              {.figure = "low",
               .variant = "longer",
               .relation = CLI_AT_LEAST,
               .plus = .5,
               .factor = 3,
               .of = "low",
               .of_variant = "a"},
              {.figure = "exponent", .relation = CLI_AT_LEAST, .plus = -1},
              {.figure = "low", .variant = "a", .relation = CLI_AT_LEAST, .plus = 9, .not_small = true}}};

static double figure[MOST * SEEDS * FIGURES], whole[SEEDS];

/* Figure 0 of variant v is 1 + v, of the second and third seed .5 more and .25 less. */
static cli_result result_of(uint32_t variants, uint32_t seeds, bool small)
{
    static const double AWAY[SEEDS] = {0, .5, -.25};
    cli_result r = {.experiment = &made_up,
                    .small = small,
                    .variants = variants,
                    .figures = FIGURES,
                    .wholes = 1,
                    .claims = 4,
                    .seeds = seeds,
                    .steps = 70,
                    .finished = (size_t)variants * seeds,
                    .figure = figure,
                    .whole = whole};
    for (uint32_t v = 0; v < variants; v++)
        for (uint32_t s = 0; s < seeds; s++) {
            double *f = figure + ((size_t)v * seeds + s) * FIGURES;
            f[0] = 1 + v + AWAY[s];
            f[1] = v == 0 ? INFINITY : v == 1 ? 1234.5 : v == 2 && s == 1 ? INFINITY : 1e-3;
        }
    for (uint32_t s = 0; s < seeds; s++)
        whole[s] = -.5 + AWAY[s];
    return r;
}

static void assert_prints(const cli_result *r, bool json, int status, const char *expected)
{
    static char text[1 << 14];
    char name[] = "/tmp/rheolog-output-XXXXXX";
    const int file = mkstemp(name), kept = dup(STDOUT_FILENO);
    assert_true(file >= 0 && kept >= 0);
    fflush(stdout);
    assert_true(dup2(file, STDOUT_FILENO) >= 0);
    (json ? cli_experiment_json : cli_experiment_print)(r, status);
    fflush(stdout);
    const bool back = dup2(kept, STDOUT_FILENO) >= 0;
    close(kept);
    assert_true(back);
    const ssize_t length = pread(file, text, sizeof text - 1, 0);
    close(file);
    remove(name);
    assert_true(length >= 0);
    text[length] = 0;
    assert_string_equal(text, expected);
}

/* Up to five variants are columns, more are rows. */
static void variants_are_columns_or_rows(void **state)
{
    (void)state;
    cli_result r = result_of(5, 1, true);
    assert_false(cli_experiment_judge(&r)); /* 2 >= .5 + 3 x 1 fails */
    assert_prints(&r, false, CLI_DONE,
                  "made-up, small (nobody): it shows nothing\n"
                  "                          a     longer          c          d          e\n"
                  "low, L                    1          2          3          4          5\n"
                  "much longer name      never   1.23e+03      0.001      0.001      0.001\n"
                  "exponent, 1: -0.5\n"
                  "holds: low of a <= 2\n"
                  "FAILS: low of longer >= 3 x low of a + 0.5\n"
                  "holds: exponent >= -1\n");
    r = result_of(6, 1, false);
    cli_experiment_judge(&r);
    assert_prints(&r, false, CLI_DONE,
                  "made-up (nobody): it shows nothing\n"
                  "                  low, L  much longer name\n"
                  "a                      1             never\n"
                  "longer                 2          1.23e+03\n"
                  "c                      3             0.001\n"
                  "d                      4             0.001\n"
                  "e                      5             0.001\n"
                  "f                      6             0.001\n"
                  "exponent, 1: -0.5\n"
                  "holds: low of a <= 2\n"
                  "FAILS: low of longer >= 3 x low of a + 0.5\n"
                  "holds: exponent >= -1\n"
                  "FAILS: low of a >= 9\n");
}

/* The middle of the seeds, and how far the farthest one is from it. */
static void seeds_have_a_middle_and_a_distance(void **state)
{
    (void)state;
    cli_result r = result_of(3, 3, true);
    cli_experiment_judge(&r);
    assert_prints(&r, false, CLI_DONE,
                  "made-up, small (nobody): it shows nothing\n"
                  "                               a          longer               c\n"
                  "low, L                   1 +-0.5         2 +-0.5         3 +-0.5\n"
                  "much longer name           never    1.23e+03 +-0  0.001 or never\n"
                  "exponent, 1: -0.5 +-0.5\n"
                  "holds: low of a <= 2\n"
                  "FAILS: low of longer >= 3 x low of a + 0.5\n"
                  "holds: exponent >= -1\n");
}

/* Of a run that was interrupted, only what is finished is told, and no claim. */
static void an_interrupted_run_tells_what_is_finished(void **state)
{
    (void)state;
    cli_result r = result_of(3, 2, true);
    r.finished = 1;
    assert_prints(&r, false, CLI_INTERRUPTED,
                  "made-up, small (nobody): it shows nothing\n"
                  "interrupted after 1 of 6 runs: the figures are of these, and nothing is said of the claims\n"
                  "                               a          longer               c\n"
                  "low, L                         1               -               -\n"
                  "much longer name           never               -               -\n"
                  "exponent, 1: -\n");
}

static void json_has_every_number(void **state)
{
    (void)state;
    cli_result r = result_of(2, 2, true);
    cli_experiment_judge(&r);
    assert_prints(
        &r, true, CLI_DONE,
        "{\"experiment\": \"made-up\", \"reference\": \"nobody\", \"small\": true, \"steps\": 70, \"seeds\": 2, "
        "\"outcome\": \"done\", \"reason\": null, \"runs\": 4, \"finished\": 4, "
        "\"figures\": [{\"name\": \"low\", \"unit\": \"L\", \"about\": \"how low\"}, {\"name\": \"much longer name\", \"unit\": \"\", "
        "\"about\": \"how long\"}], "
        "\"variants\": [{\"name\": \"a\", \"set\": [\"x=1\", \"y=2\"], \"figures\": {\"low\": [1, 1.5], \"much longer name\": [null, null]}}, "
        "{\"name\": \"longer\", \"set\": [], \"figures\": {\"low\": [2, 2.5], \"much longer name\": [1234.5, 1234.5]}}], "
        "\"whole\": {\"exponent\": [-0.5, 0]}, "
        "\"claims\": [{\"text\": \"low of a <= 2\", \"holds\": true}, {\"text\": \"low of longer >= 3 x low of a + 0.5\", "
        "\"holds\": false}, {\"text\": \"exponent >= -1\", \"holds\": true}], \"holds\": false}\n");
    r.finished = 3;
    assert_prints(
        &r, true, CLI_INTERRUPTED,
        "{\"experiment\": \"made-up\", \"reference\": \"nobody\", \"small\": true, \"steps\": 70, \"seeds\": 2, "
        "\"outcome\": \"interrupted\", \"reason\": \"a signal\", \"runs\": 4, \"finished\": 3, "
        "\"figures\": [{\"name\": \"low\", \"unit\": \"L\", \"about\": \"how low\"}, {\"name\": \"much longer name\", \"unit\": \"\", "
        "\"about\": \"how long\"}], "
        "\"variants\": [{\"name\": \"a\", \"set\": [\"x=1\", \"y=2\"], \"figures\": {\"low\": [1, 1.5], \"much longer name\": [null, null]}}, "
        "{\"name\": \"longer\", \"set\": [], \"figures\": {\"low\": [2], \"much longer name\": [1234.5]}}], "
        "\"whole\": {\"exponent\": [-0.5]}, \"claims\": [], \"holds\": null}\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(variants_are_columns_or_rows),
        cmocka_unit_test(seeds_have_a_middle_and_a_distance),
        cmocka_unit_test(an_interrupted_run_tells_what_is_finished),
        cmocka_unit_test(json_has_every_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
