/*
 * Prints the comparison of two programs: ratios of medians, and whether other rounds could have shown the opposite.
 */
#include "cli/bench_compare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FEWEST_ROUNDS = 5 };

/* ---- Statistics ---- */

/* A stage in both programs; NaN where a program does not have it. */
typedef struct row {
    char stage[32]; /* "all": the whole step */
    double here, here_least, here_most, baseline, baseline_least, baseline_most;
    double ratio, ratio_range[2];
    const char *change;
} row;

static void times_of(const cli_bench_side *s, uint32_t rounds, uint32_t item, const char *stage, double *ns)
{
    for (uint32_t r = 0; r < rounds; r++) {
        const cli_bench_result *result = &s->round[r].item[item];
        ns[r] = strcmp(stage, "all") == 0 ? result->total : cli_bench_result_stage(result, stage);
    }
}

static void summarise(const double *ns, uint32_t rounds, double *median, double *least, double *most)
{
    *median = *least = *most = NAN;
    for (uint32_t r = 0; r < rounds; r++)
        if (isnan(ns[r]))
            return;
    *median = cli_bench_median(ns, rounds);
    *least = cli_bench_least(ns, rounds);
    *most = cli_bench_largest(ns, rounds);
}

static row compare_stage(const cli_bench_comparison *c, uint32_t here, uint32_t baseline, const char *stage)
{
    const uint32_t rounds = c->a->rounds;
    double a[CLI_BENCH_MAX_REPETITIONS], b[CLI_BENCH_MAX_REPETITIONS], ratio[CLI_BENCH_MAX_REPETITIONS];
    row r = {.ratio = NAN, .ratio_range = {NAN, NAN}, .change = ""};
    snprintf(r.stage, sizeof r.stage, "%s", stage);
    times_of(&c->here, rounds, here, stage, a);
    times_of(&c->baseline, rounds, baseline, stage, b);
    summarise(a, rounds, &r.here, &r.here_least, &r.here_most);
    summarise(b, rounds, &r.baseline, &r.baseline_least, &r.baseline_most);
    if (!(r.here >= 0 && r.baseline_least > 0))
        return r;
    for (uint32_t i = 0; i < rounds; i++)
        ratio[i] = a[i] / b[i];
    r.ratio = r.here / r.baseline;
    cli_bench_median_range(ratio, rounds, r.ratio_range);
    r.change = rounds < FEWEST_ROUNDS ? "too few rounds"
               : r.ratio_range[1] < 1 ? "faster"
               : r.ratio_range[0] > 1 ? "slower"
                                      : "within the noise";
    return r;
}

/* Fills the rows of a case: its stages in the order of a step, and all of it. Returns their number. */
static uint32_t compare_case(const cli_bench_comparison *c, uint32_t here, uint32_t baseline,
                             row rows[2 * CLI_BENCH_MAX_STAGES])
{
    const cli_bench_result *results[2] = {&c->here.round[0].item[here], &c->baseline.round[0].item[baseline]};
    char stage[CLI_BENCH_MAX_STAGES][32];
    cli_bench_case *cases = calloc(2, sizeof *cases);
    uint32_t stages = 0;
    for (int i = 0; cases && i < 2; i++) {
        cases[i].stages = results[i]->stages;
        memcpy(cases[i].stage, results[i]->stage, sizeof cases[i].stage);
    }
    if (cases)
        stages = cli_bench_all_stages(&(cli_bench_cases){2, cases}, stage);
    free(cases);
    for (uint32_t s = 0; s < stages; s++)
        rows[s] = compare_stage(c, here, baseline, stage[s]);
    rows[stages] = compare_stage(c, here, baseline, "all");
    return stages + 1;
}

/* "same", "other", or "unknown" if a program prints no hash. */
static const char *compare_results(const cli_bench_result *here, const cli_bench_result *baseline)
{
    if (!here->hash[0] || !baseline->hash[0])
        return "unknown";
    return strcmp(here->hash, baseline->hash) == 0 ? "same" : "other";
}

/* ---- Output ---- */

static void print_time(double median, double least, double most)
{
    char spread[48] = "";
    if (isnan(median)) {
        printf(" %9s %15s", "-", "");
        return;
    }
    snprintf(spread, sizeof spread, "%.1f-%.1f", least, most);
    printf(" %9.2f %15s", median, spread);
}

static void name_case(const cli_bench_result *r, char *name, size_t size)
{
    size_t n = (size_t)snprintf(name, size, "%s", r->key[CLI_BENCH_CASE]);
    static const char *const before[CLI_BENCH_KEYS] = {"", "d = ", "", "scheme ", "", "study "};
    for (int k = 1; k < CLI_BENCH_KEYS && n < size; k++)
        if (r->key[k][0])
            n += (size_t)snprintf(name + n, size - n, "%s%s%s", n ? ", " : "", before[k], r->key[k]);
}

static void print_case(const cli_bench_comparison *c, uint32_t item, uint32_t other)
{
    const cli_bench_result *here = &c->here.round[0].item[item], *baseline = &c->baseline.round[0].item[other];
    row rows[2 * CLI_BENCH_MAX_STAGES];
    char name[256];
    const uint32_t count = compare_case(c, item, other, rows);
    name_case(here, name, sizeof name);
    printf("%s, %s particles", name, here->particles);
    if (strcmp(here->particles, baseline->particles) != 0)
        printf(" (baseline %s: another problem)", baseline->particles);
    const char *results = compare_results(here, baseline);
    if (strcmp(results, "same") == 0)
        printf(": same results, hash %s\n", here->hash);
    else if (strcmp(results, "other") == 0)
        printf(": OTHER RESULTS, hash %s, baseline %s\n", here->hash, baseline->hash);
    else
        printf(": results not compared, %s prints no hash\n", here->hash[0] ? "the baseline" : "this measurement");
    printf("  %-22s %9s %15s %9s %15s %7s %13s\n", "stage", "ns", "least-most", "baseline", "least-most", "ratio",
           "range");
    for (uint32_t i = 0; i < count; i++) {
        const row *r = &rows[i];
        printf("  %-22s", r->stage);
        print_time(r->here, r->here_least, r->here_most);
        print_time(r->baseline, r->baseline_least, r->baseline_most);
        if (!isnan(r->ratio)) {
            char range[48];
            snprintf(range, sizeof range, "%.3f-%.3f", r->ratio_range[0], r->ratio_range[1]);
            printf(" %7.3f %13s  %s", r->ratio, range, r->change);
        } else if (isnan(r->here) != isnan(r->baseline)) {
            printf(" %7s %13s  only %s", "", "", isnan(r->here) ? "baseline" : "here");
        }
        putchar('\n');
    }
    putchar('\n');
}

/* Adds a number that is kept as text, and may be missing. */
static void cell_count(cli_bench_table *table, const char *name, const char *text)
{
    cli_bench_cell_number(table, name, 0, *text ? strtod(text, NULL) : NAN);
}

/* Prints a row for each stage of a case, and for all of it. */
static void list_case(const cli_bench_comparison *c, uint32_t item, uint32_t other, cli_bench_table *table)
{
    static const char *const keys[CLI_BENCH_KEYS] = {"case", "window", "kind", "scheme", "setting", "study"};
    const cli_bench_result *here = &c->here.round[0].item[item], *baseline = &c->baseline.round[0].item[other];
    row rows[2 * CLI_BENCH_MAX_STAGES];
    const uint32_t count = compare_case(c, item, other, rows);
    for (uint32_t i = 0; i < count; i++) {
        const row *r = &rows[i];
        cli_bench_cell_text(table, "measurement", c->a->measurement);
        for (int k = 0; k < CLI_BENCH_KEYS; k++)
            (k == CLI_BENCH_WINDOW ? cell_count : cli_bench_cell_text)(table, keys[k], here->key[k]);
        cell_count(table, "particles", here->particles);
        cell_count(table, "baseline_particles", baseline->particles);
        cli_bench_cell_text(table, "stage", r->stage);
        cli_bench_cell_number(table, "ns_median", 3, r->here);
        cli_bench_cell_number(table, "ns_least", 3, r->here_least);
        cli_bench_cell_number(table, "ns_largest", 3, r->here_most);
        cli_bench_cell_number(table, "baseline_ns_median", 3, r->baseline);
        cli_bench_cell_number(table, "baseline_ns_least", 3, r->baseline_least);
        cli_bench_cell_number(table, "baseline_ns_largest", 3, r->baseline_most);
        cli_bench_cell_number(table, "ratio", 4, r->ratio);
        cli_bench_cell_number(table, "ratio_low", 4, r->ratio_range[0]);
        cli_bench_cell_number(table, "ratio_high", 4, r->ratio_range[1]);
        cli_bench_cell_text(table, "change", r->change);
        cli_bench_cell_text(table, "results", compare_results(here, baseline));
        cli_bench_cell_text(table, "hash", here->hash);
        cli_bench_cell_text(table, "baseline_hash", baseline->hash);
        cli_bench_cell_whole(table, "rounds", c->a->rounds);
        cli_bench_cell_whole(table, "repetitions", c->a->repetitions);
        cli_bench_cell_text(table, "machine", cli_bench_machine());
        cli_bench_cell_text(table, "version", c->here.version);
        cli_bench_cell_text(table, "baseline", c->baseline.program);
        cli_bench_cell_text(table, "baseline_version", c->baseline.version);
        cli_bench_end_row(table);
    }
}

static void print_head(const cli_bench_comparison *c)
{
    char core[24] = "";
    if (c->core >= 0)
        snprintf(core, sizeof core, ", core %d", c->core);
    printf("bench %s on %s%s; %u round%s of %u repetition%s with each program in turn\nhere      %s\nbaseline  %s\n"
           "          %s\n\n",
           c->a->measurement, cli_bench_machine(), core, c->a->rounds, cli_plural(c->a->rounds), c->a->repetitions,
           cli_plural(c->a->repetitions), c->here.version, c->baseline.version, c->baseline.program);
}

/* Lists the cases that only one program has. */
static void print_others(const cli_bench_results *all, const cli_bench_results *others, const char *where)
{
    bool any = false;
    for (uint32_t i = 0; i < all->count; i++) {
        char name[256];
        if (cli_bench_find_result(others, &all->item[i]))
            continue;
        name_case(&all->item[i], name, sizeof name);
        printf("%s%s", any ? "; " : where, name);
        any = true;
    }
    fputs(any ? "\n\n" : "", stdout);
}

int cli_bench_print_comparison(const cli_bench_comparison *c)
{
    const cli_bench_results *here = &c->here.round[0], *baseline = &c->baseline.round[0];
    const bool text = !c->a->csv && !c->a->json;
    cli_bench_table table = {.json = c->a->json};
    uint32_t compared = 0;
    for (uint32_t i = 0; i < here->count; i++) {
        const cli_bench_result *other = cli_bench_find_result(baseline, &here->item[i]);
        if (!other)
            continue;
        if (text && compared == 0)
            print_head(c);
        compared++;
        if (text)
            print_case(c, i, (uint32_t)(other - baseline->item));
        else
            list_case(c, i, (uint32_t)(other - baseline->item), &table);
    }
    if (!compared)
        return cli_fail(CLI_BAD, "the baseline %s has none of the cases of bench %s, so there is nothing to compare",
                        c->baseline.program, c->a->measurement);
    if (!text)
        return CLI_DONE;
    print_others(here, baseline, "cases only here: ");
    print_others(baseline, here, "cases only in the baseline: ");
    puts(
        "ns: median of the rounds, per particle and step (error: and unit of simulated time). ratio: of the medians;\n"
        "below 1 this program is faster. range: of the rounds' ratios, without so many at both ends that it still holds\n"
        "their median in 95 of 100 such comparisons (5 rounds: 94). A range that holds 1 shows no difference. Fewer\n"
        "than 5 rounds cannot show one.");
    return CLI_DONE;
}
