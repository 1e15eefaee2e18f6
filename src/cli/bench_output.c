/* Results of a benchmark for programs: a line of CSV or a JSON object for each case, with the same names. */
#include "cli/bench.h"

#include <string.h>

static bench_cell *add(bench_table *table, const char *name)
{
    if (table->cells < BENCH_MAX_CELLS)
        table->cells++;
    bench_cell *cell = &table->cell[table->cells - 1];
    *cell = (bench_cell){.kind = BENCH_TEXT};
    snprintf(cell->name, sizeof cell->name, "%s", name);
    return cell;
}

void bench_cell_text(bench_table *table, const char *name, const char *value)
{
    bench_cell *cell = add(table, name);
    snprintf(cell->text, sizeof cell->text, "%s", value);
}

void bench_cell_number(bench_table *table, const char *name, int decimals, double value)
{
    bench_cell *cell = add(table, name);
    cell->kind = BENCH_NUMBER;
    cell->decimals = decimals;
    cell->number = value;
}

void bench_cell_whole(bench_table *table, const char *name, uint64_t value)
{
    bench_cell *cell = add(table, name);
    cell->kind = BENCH_WHOLE;
    cell->whole = value;
}

static void print_csv_text(const char *value)
{
    if (!strpbrk(value, ",\"\n")) {
        fputs(value, stdout);
        return;
    }
    putchar('"');
    for (; *value; value++) {
        if (*value == '"')
            putchar('"');
        putchar(*value);
    }
    putchar('"');
}

static void print_csv_value(const bench_cell *cell)
{
    const int decimals = cell->decimals;
    if (cell->kind == BENCH_TEXT)
        print_csv_text(cell->text);
    else if (cell->kind == BENCH_WHOLE)
        printf("%llu", (unsigned long long)cell->whole);
    else if (cell->number == cell->number)
        printf(decimals < 0 ? "%.*e" : "%.*f", decimals < 0 ? -decimals : decimals, cell->number);
}

static void print_csv(const bench_table *table)
{
    if (!table->begun)
        for (uint32_t i = 0; i < table->cells; i++)
            printf("%s%s", table->cell[i].name, i + 1 < table->cells ? "," : "\n");
    for (uint32_t i = 0; i < table->cells; i++) {
        fputs(i ? "," : "", stdout);
        print_csv_value(&table->cell[i]);
    }
    putchar('\n');
}

static void print_json(const bench_table *table)
{
    cli_json json = {.file = stdout};
    cli_json_begin_object(&json, NULL);
    for (uint32_t i = 0; i < table->cells; i++) {
        const bench_cell *cell = &table->cell[i];
        if (cell->kind == BENCH_TEXT)
            cli_json_text(&json, cell->name, cell->text);
        else if (cell->kind == BENCH_WHOLE)
            cli_json_integer(&json, cell->name, cell->whole);
        else
            cli_json_decimals(&json, cell->name, cell->decimals, cell->number);
    }
    cli_json_end_object(&json);
}

void bench_end_row(bench_table *table)
{
    (table->json ? print_json : print_csv)(table);
    fflush(stdout);
    table->begun = true;
    table->cells = 0;
}
