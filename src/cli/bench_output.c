/* Results of a benchmark for programs: a line of CSV or a JSON object for each case, with the same names. */
#include "cli/bench.h"

#include <string.h>

#include "cli/scene_json.h"

static void add(bench_table *table, const char *name, const char *value, bool text)
{
    if (table->cells == BENCH_MAX_CELLS)
        return;
    snprintf(table->cell[table->cells].name, sizeof table->cell[0].name, "%s", name);
    snprintf(table->cell[table->cells].value, sizeof table->cell[0].value, "%s", value);
    table->cell[table->cells++].text = text;
}

void bench_cell_text(bench_table *table, const char *name, const char *value)
{
    add(table, name, value, true);
}

void bench_cell(bench_table *table, const char *name, int decimals, double value)
{
    char text[96] = "";
    if (value == value)
        snprintf(text, sizeof text, decimals < 0 ? "%.*e" : "%.*f", decimals < 0 ? -decimals : decimals, value);
    add(table, name, text, false);
}

void bench_cell_whole(bench_table *table, const char *name, uint64_t value)
{
    char text[32];
    snprintf(text, sizeof text, "%llu", (unsigned long long)value);
    add(table, name, text, false);
}

static void print_csv_value(const char *value)
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

static void print_json_value(const char *value, bool text)
{
    if (text)
        cli_json_string(stdout, value);
    else
        fputs(*value ? value : "null", stdout);
}

void bench_end_row(bench_table *table)
{
    if (!table->json && !table->begun)
        for (uint32_t i = 0; i < table->cells; i++)
            printf("%s%s", table->cell[i].name, i + 1 < table->cells ? "," : "\n");
    table->begun = true;
    for (uint32_t i = 0; i < table->cells; i++) {
        if (table->json) {
            printf("%s\"%s\": ", i ? ", " : "{", table->cell[i].name);
            print_json_value(table->cell[i].value, table->cell[i].text);
        } else {
            fputs(i ? "," : "", stdout);
            print_csv_value(table->cell[i].value);
        }
    }
    puts(table->json ? "}" : "");
    fflush(stdout);
    table->cells = 0;
}
