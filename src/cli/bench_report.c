/* Results of a benchmark: rows of CSV or JSON with the same names, and the common parts of the text reports. */
#include "cli/bench.h"

#include <math.h>
#include <string.h>

/* ---- Tables ---- */

static cli_bench_cell *add(cli_bench_table *table, const char *name)
{
    if (table->cells < CLI_BENCH_MAX_CELLS)
        table->cells++;
    cli_bench_cell *cell = &table->cell[table->cells - 1];
    *cell = (cli_bench_cell){.kind = CLI_BENCH_TEXT};
    snprintf(cell->name, sizeof cell->name, "%s", name);
    return cell;
}

void cli_bench_cell_text(cli_bench_table *table, const char *name, const char *value)
{
    cli_bench_cell *cell = add(table, name);
    snprintf(cell->text, sizeof cell->text, "%s", value);
}

void cli_bench_cell_number(cli_bench_table *table, const char *name, int decimals, double value)
{
    cli_bench_cell *cell = add(table, name);
    cell->kind = CLI_BENCH_NUMBER;
    cell->decimals = decimals;
    cell->number = value;
}

void cli_bench_cell_whole(cli_bench_table *table, const char *name, uint64_t value)
{
    cli_bench_cell *cell = add(table, name);
    cell->kind = CLI_BENCH_WHOLE;
    cell->whole = value;
}

static void print_csv_text(FILE *file, const char *value)
{
    if (!strpbrk(value, ",\"\n")) {
        fputs(value, file);
        return;
    }
    fputc('"', file);
    for (; *value; value++) {
        if (*value == '"')
            fputc('"', file);
        fputc(*value, file);
    }
    fputc('"', file);
}

static void print_csv_value(FILE *file, const cli_bench_cell *cell)
{
    const int decimals = cell->decimals;
    if (cell->kind == CLI_BENCH_TEXT)
        print_csv_text(file, cell->text);
    else if (cell->kind == CLI_BENCH_WHOLE)
        fprintf(file, "%llu", (unsigned long long)cell->whole);
    else if (cell->number == cell->number)
        fprintf(file, decimals < 0 ? "%.*e" : "%.*f", decimals < 0 ? -decimals : decimals, cell->number);
}

static void print_csv(const cli_bench_table *table, FILE *file)
{
    if (!table->begun)
        for (uint32_t i = 0; i < table->cells; i++)
            fprintf(file, "%s%s", table->cell[i].name, i + 1 < table->cells ? "," : "\n");
    for (uint32_t i = 0; i < table->cells; i++) {
        fputs(i ? "," : "", file);
        print_csv_value(file, &table->cell[i]);
    }
    fputc('\n', file);
}

static void print_json(const cli_bench_table *table, FILE *file)
{
    rheo__json json = {.file = file};
    rheo__json_begin_object(&json, NULL);
    for (uint32_t i = 0; i < table->cells; i++) {
        const cli_bench_cell *cell = &table->cell[i];
        if (cell->kind == CLI_BENCH_TEXT)
            rheo__json_text(&json, cell->name, cell->text);
        else if (cell->kind == CLI_BENCH_WHOLE)
            rheo__json_integer(&json, cell->name, cell->whole);
        else
            rheo__json_decimals(&json, cell->name, cell->decimals, cell->number);
    }
    rheo__json_end_object(&json);
}

void cli_bench_end_row(cli_bench_table *table)
{
    FILE *file = table->file ? table->file : stdout;
    (table->json ? print_json : print_csv)(table, file);
    fflush(file);
    table->begun = true;
    table->cells = 0;
}

/* ---- Cells of several measurements ---- */

void cli_bench_cell_stages(cli_bench_table *table, const cli_bench_cases *cases, const cli_bench_case *c,
                           int decimals, double scale)
{
    char stage[CLI_BENCH_MAX_STAGES][32], name[48];
    const uint32_t stages = cli_bench_all_stages(cases, stage);
    for (uint32_t s = 0; s < stages; s++) {
        snprintf(name, sizeof name, "ns_%.31s", stage[s]);
        const double ns = cli_bench_has_stage(c, stage[s]) ? scale * cli_bench_stage(c, stage[s]) : NAN;
        cli_bench_cell_number(table, name, decimals, ns);
    }
}

void cli_bench_cell_build(cli_bench_table *table)
{
    cli_bench_cell_text(table, "machine", cli_bench_machine());
    cli_bench_cell_text(table, "compiler", cli_compiler());
    cli_bench_cell_text(table, "real", cli_real());
    cli_bench_cell_text(table, "simd", rheo_simd());
}

void cli_bench_cell_run(cli_bench_table *table, const cli_bench_case *c, const cli_bench_arguments *a)
{
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)c->hash);
    cli_bench_cell_number(table, "bytes_state", 1, cli_bench_per_particle(c, c->field_bytes));
    cli_bench_cell_number(table, "bytes_world", 1, cli_bench_per_particle(c, c->world_bytes));
    cli_bench_cell_text(table, "hash", hash);
    cli_bench_cell_whole(table, "steps", c->steps);
    cli_bench_cell_whole(table, "repetitions", a->repetitions);
    cli_bench_cell_build(table);
}

/* ---- Reports ---- */

void cli_bench_rows(const cli_bench_cases *cases, const cli_bench_arguments *a, cli_bench_own_cells *own)
{
    cli_bench_table table = {.json = a->json};
    for (uint32_t i = 0; i < cases->count; i++) {
        const cli_bench_case *c = &cases->item[i];
        cli_bench_cell_text(&table, "case", c->name);
        cli_bench_cell_whole(&table, "particles", c->particles);
        cli_bench_cell_whole(&table, "window", c->window);
        cli_bench_cell_text(&table, "kind", c->kind);
        cli_bench_cell_text(&table, "scheme", c->scheme);
        cli_bench_cell_number(&table, "neighbours", 2, c->neighbours);
        cli_bench_cell_number(&table, "ns_median", 2, cli_bench_total(c));
        cli_bench_cell_number(&table, "ns_least", 2, cli_bench_least(c->total, c->repetitions));
        cli_bench_cell_number(&table, "ns_largest", 2, cli_bench_largest(c->total, c->repetitions));
        own(&table, cases, c);
        cli_bench_cell_stages(&table, cases, c, 3, 1);
        cli_bench_cell_number(&table, "ns_rest", 3, cli_bench_rest(c));
        cli_bench_cell_number(&table, "bytes_history", 1, cli_bench_per_particle(c, c->history_bytes));
        cli_bench_cell_run(&table, c, a);
        cli_bench_end_row(&table);
    }
}

int cli_bench_report(cli_bench_cases *cases, cli_bench_arguments *a, cli_bench_print *text, cli_bench_own_cells *own)
{
    const int status = cli_bench_measure(cases, a);
    if (status == CLI_DONE && (a->csv || a->json))
        cli_bench_rows(cases, a, own);
    else if (status == CLI_DONE)
        text(cases, a);
    cli_bench_release(cases);
    return status;
}

const char cli_bench_per_step[] = ", medians; ns per particle and step";

void cli_bench_print_head(const cli_bench_arguments *a, const char *rest)
{
    printf("%s, %s, %s, simd %s; %u repetition%s of %llu steps%s\n\n", cli_bench_machine(), cli_compiler(),
           cli_real(), rheo_simd(), a->repetitions, cli_plural(a->repetitions), (unsigned long long)a->steps, rest);
}

void cli_bench_print_spread(const cli_bench_case *c, double scale)
{
    char spread[48];
    snprintf(spread, sizeof spread, "%.0f-%.0f", scale * cli_bench_least(c->total, c->repetitions),
             scale * cli_bench_largest(c->total, c->repetitions));
    printf(" %8.1f %13s", scale * cli_bench_total(c), spread);
}
