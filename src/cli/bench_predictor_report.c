/* Results of `rheolog bench predictor`: a line for each scene, a line for each measure, and files. */
#include "cli/bench_predictor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/steps.h"

/* ---- Judging ---- */

/* Whether all conditions and precursors but one stayed in range; `but`: that one, or the count for none. */
static bool others_in_range(const cli_predictor_run *run, const cli_predictor_group_measures *g, uint32_t but)
{
    for (uint32_t m = 0; m < g->count; m++)
        if (m != but && (strcmp(g->item[m].kind, "condition") == 0 || strcmp(g->item[m].kind, "precursor") == 0) &&
            !cli_predictor_in_range(&run->measure[m], &g->item[m]))
            return false;
    return true;
}

/* A stated bound is on a number that measures are made of: these do not count as others. */
static bool alone(const cli_predictor_run *run, const cli_predictor_group_measures *g, uint32_t m)
{
    if (strcmp(g->item[m].kind, "bound") != 0)
        return others_in_range(run, g, m);
    for (uint32_t i = 0; i < g->count; i++)
        if (strcmp(g->item[i].kind, "condition") == 0 && !cli_predictor_in_range(&run->measure[i], &g->item[i]))
            return false;
    return true;
}

static void note_lead(cli_predictor_row *row, double *leads, uint32_t *count, const cli_predictor_run *run,
                      uint64_t first)
{
    if (run->reason == CLI_PREDICTOR_WELL || first > run->bad)
        return;
    leads[*count] = (double)(run->bad - first);
    row->least_lead = *count ? fmin(row->least_lead, leads[*count]) : leads[*count];
    ++*count;
}

void cli_predictor_judge(const cli_predictor_results *r, uint32_t group, uint32_t measure, cli_predictor_row *row)
{
    const cli_predictor_group_measures *g = &r->group[group];
    double *leads = malloc((r->count + 1) * sizeof *leads);
    uint32_t count = 0;
    *row = (cli_predictor_row){.measure = &g->item[measure],
                               .group = group,
                               .least_bad = NAN,
                               .most_well = NAN,
                               .lead = NAN,
                               .least_lead = NAN};
    for (uint32_t i = 0; i < r->count; i++) {
        const cli_predictor_run *run = &r->run[i];
        const cli_predictor_value *v = &run->measure[measure];
        if (run->group != group || !v->measured)
            continue;
        const bool bad = run->reason != CLI_PREDICTOR_WELL, in = cli_predictor_in_range(v, row->measure),
                   only = alone(run, g, measure);
        row->below += in;
        row->below_bad += in && bad;
        row->alone += in && only;
        row->alone_bad += in && only && bad;
        row->above += !in;
        row->above_bad += !in && bad;
        if (bad && only)
            row->least_bad = fmin(row->least_bad, v->most);
        if (!bad)
            row->most_well = fmax(row->most_well, v->most);
        if (leads)
            note_lead(row, leads, &count, run, v->first);
    }
    if (count)
        row->lead = cli_bench_median(leads, count);
    free(leads);
}

/* Verdicts of the doctor as a whole, as a row. */
typedef struct summary {
    uint32_t scenes, bad, alarms, false_alarms, misses, quiet, quiet_bad;
    double lead;
} summary;

static summary sum_up(const cli_predictor_results *r, uint32_t group)
{
    summary s = {.lead = NAN};
    double *leads = malloc((r->count + 1) * sizeof *leads);
    uint32_t count = 0;
    for (uint32_t i = 0; i < r->count; i++) {
        const cli_predictor_run *run = &r->run[i];
        if (run->group != group)
            continue;
        const bool bad = run->reason != CLI_PREDICTOR_WELL,
                   alarm = run->unhealthy != UINT64_MAX || run->reason == CLI_PREDICTOR_FAILED,
                   quiet = others_in_range(run, &r->group[group], CLI_PREDICTOR_MEASURES);
        s.scenes++;
        s.bad += bad;
        s.alarms += alarm;
        s.false_alarms += alarm && !bad;
        s.misses += bad && !alarm;
        s.quiet += quiet;
        s.quiet_bad += quiet && bad;
        if (leads && bad && run->sign <= run->bad)
            leads[count++] = (double)(run->bad - run->sign);
    }
    if (count)
        s.lead = cli_bench_median(leads, count);
    free(leads);
    return s;
}

/* ---- Lines ---- */

static void number(FILE *file, double value)
{
    char text[32] = "";
    if (value == value)
        rheo_number_text(value, text);
    fprintf(file, ",%s", text);
}

/* Rounded to four digits, since these numbers are no results to be repeated to the last bit. */
static double brief(double value)
{
    char text[32];
    snprintf(text, sizeof text, "%.3e", value);
    return value == value && isfinite(value) ? strtod(text, NULL) : value;
}

static void put_step(FILE *file, uint64_t step)
{
    if (step == UINT64_MAX)
        fputs(",", file);
    else
        fprintf(file, ",%llu", (unsigned long long)step);
}

/* Names of the measures of all groups, each once. */
static uint32_t all_names(const cli_predictor_results *r,
                          const char *name[CLI_PREDICTOR_GROUPS * CLI_PREDICTOR_MEASURES])
{
    uint32_t count = 0;
    for (uint32_t g = 0; g < CLI_PREDICTOR_GROUPS; g++)
        for (uint32_t m = 0; m < r->group[g].count; m++) {
            uint32_t i = 0;
            while (i < count && strcmp(name[i], r->group[g].item[m].name) != 0)
                i++;
            if (i == count)
                name[count++] = r->group[g].item[m].name;
        }
    return count;
}

static double value_of(const cli_predictor_results *r, const cli_predictor_run *run, const char *name)
{
    const cli_predictor_group_measures *g = &r->group[run->group];
    for (uint32_t m = 0; m < g->count; m++)
        if (strcmp(g->item[m].name, name) == 0)
            return run->measure[m].measured ? run->measure[m].most : NAN;
    return NAN;
}

static void put_scenes(FILE *file, const void *data)
{
    const cli_predictor_results *r = data;
    const char *name[CLI_PREDICTOR_GROUPS * CLI_PREDICTOR_MEASURES], *path;
    const uint32_t names = all_names(r, name);
    fputs("scene,seed,model,scheme,particles,steps", file);
    for (size_t i = 0; (path = cli_predictor_parameter(i)) != NULL; i++)
        fprintf(file, ",%s", path);
    for (uint32_t i = 0; i < names; i++)
        fprintf(file, ",%s", name[i]);
    fputs(",energy,speed,blew_up,reason,bad_step,sign_step,unhealthy_step,hash\n", file);
    for (uint32_t i = 0; i < r->count; i++) {
        const cli_predictor_run *run = &r->run[i];
        const bool melting = run->group == CLI_PREDICTOR_MELTING, bad = run->reason != CLI_PREDICTOR_WELL;
        fprintf(file, "%u,%llu,%s,%s,%u,%llu", i, (unsigned long long)run->seed, melting ? "melting" : "thickening",
                melting ? "" : cli_predictor_group_name[run->group], run->particles, (unsigned long long)run->steps);
        for (size_t p = 0; cli_predictor_parameter(p); p++)
            fprintf(file, strchr(run->value[p], ',') ? ",\"%s\"" : ",%s", run->value[p]);
        for (uint32_t m = 0; m < names; m++)
            number(file, brief(value_of(r, run, name[m])));
        number(file, brief(run->energy));
        number(file, brief(run->speed));
        fprintf(file, ",%s,%s", bad ? "yes" : "no", cli_predictor_reason_name[run->reason]);
        put_step(file, bad ? run->bad : UINT64_MAX);
        put_step(file, run->sign);
        put_step(file, run->unhealthy);
        fprintf(file, ",%016llx\n", (unsigned long long)run->hash);
    }
}

static double share(uint32_t part, uint32_t whole)
{
    return whole ? (double)part / whole : NAN;
}

/* Rates of a measure: alarms in scenes that stayed well, and scenes that blew up without one. */
static double false_alarms(const cli_predictor_row *row)
{
    const uint32_t well = row->above - row->above_bad + row->below - row->below_bad;
    return share(row->above - row->above_bad, well);
}

static double misses(const cli_predictor_row *row)
{
    return share(row->below_bad, row->above_bad + row->below_bad);
}

static void put_row(cli_bench_table *table, const cli_predictor_row *row)
{
    cli_bench_cell_text(table, "group", cli_predictor_group_name[row->group]);
    cli_bench_cell_text(table, "measure", row->measure->name);
    cli_bench_cell_text(table, "kind", row->measure->kind);
    cli_bench_cell_number(table, "bound", -3, row->measure->limit);
    cli_bench_cell_number(table, "certain", -3, row->measure->certain);
    cli_bench_cell_whole(table, "below", row->below);
    cli_bench_cell_whole(table, "below_blew_up", row->below_bad);
    cli_bench_cell_whole(table, "alone", row->alone);
    cli_bench_cell_whole(table, "alone_blew_up", row->alone_bad);
    cli_bench_cell_whole(table, "above", row->above);
    cli_bench_cell_whole(table, "above_blew_up", row->above_bad);
    cli_bench_cell_number(table, "false_alarms", 3, false_alarms(row));
    cli_bench_cell_number(table, "misses", 3, misses(row));
    cli_bench_cell_number(table, "least_blew_up", -3, row->least_bad);
    cli_bench_cell_number(table, "most_well", -3, row->most_well);
    cli_bench_cell_number(table, "lead", 1, row->lead);
    cli_bench_cell_number(table, "least_lead", 0, row->least_lead);
    cli_bench_end_row(table);
}

static void put_summary(cli_bench_table *table, uint32_t group, const summary *s, bool doctor)
{
    const cli_predictor_measure measure = {doctor ? "unhealthy" : "any_sign", "", doctor ? "doctor" : "signs", NAN,
                                           NAN};
    const cli_predictor_row row = {
        .measure = &measure,
        .group = group,
        .below = doctor ? s->scenes - s->alarms : s->quiet,
        .below_bad = doctor ? s->misses : s->quiet_bad,
        .alone = doctor ? s->scenes - s->alarms : s->quiet,
        .alone_bad = doctor ? s->misses : s->quiet_bad,
        .above = doctor ? s->alarms : s->scenes - s->quiet,
        .above_bad = doctor ? s->alarms - s->false_alarms : s->bad - s->quiet_bad,
        .least_bad = NAN,
        .most_well = NAN,
        .lead = doctor ? NAN : s->lead,
        .least_lead = NAN,
    };
    put_row(table, &row);
}

static void put_measures(const cli_predictor_results *r, bool json)
{
    cli_bench_table table = {.json = json};
    for (uint32_t g = 0; g < CLI_PREDICTOR_GROUPS; g++) {
        const summary s = sum_up(r, g);
        if (!s.scenes)
            continue;
        for (uint32_t m = 0; m < r->group[g].count; m++) {
            cli_predictor_row row;
            cli_predictor_judge(r, g, m, &row);
            put_row(&table, &row);
        }
        put_summary(&table, g, &s, false);
        put_summary(&table, g, &s, true);
    }
}

int cli_predictor_check_files(const char *folder)
{
    return cli_check_results(folder, "predictor", true);
}

static int write_files(const cli_predictor_results *r, const char *folder)
{
    char path[CLI_FILE_PATH];
    int status = cli_results_path(folder, "predictor", ".csv", path);
    if (status == CLI_DONE)
        status = cli_write_file(path, put_scenes, r);
    if (status == CLI_DONE)
        status = cli_results_path(folder, "predictor", ".svg", path);
    return status == CLI_DONE ? cli_predictor_plot(r, path) : status;
}

int cli_predictor_report(const cli_predictor_results *r, const cli_bench_arguments *a)
{
    if (a->csv)
        put_scenes(stdout, r);
    else
        put_measures(r, a->json);
    return a->folder ? write_files(r, a->folder) : CLI_DONE;
}
