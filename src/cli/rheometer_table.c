/* Tables of `rheolog rheometer`. */
#include "cli/rheometer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void cli_table_set_columns(cli_protocol_table *t, const cli_table_column *column, size_t count)
{
    memcpy(t->column, column, count * sizeof *column);
    t->columns = (uint32_t)count;
}

void cli_table_add(cli_protocol_table *t, const double *row)
{
    if (t->rows == t->capacity) {
        const size_t capacity = t->capacity ? 2 * t->capacity : 16;
        double *value = realloc(t->value, capacity * t->columns * sizeof *value);
        if (!value) {
            t->failed = true;
            return;
        }
        t->value = value;
        t->capacity = capacity;
    }
    memcpy(t->value + t->rows++ * t->columns, row, t->columns * sizeof *row);
}

void cli_table_figure_is(cli_protocol_table *t, const char *name, const char *unit, double value)
{
    if (t->figures < CLI_TABLE_FIGURES)
        t->figure[t->figures++] = (cli_table_figure){name, unit, value, NAN};
}

double cli_bound(double difference)
{
    double bound = 1e-9;
    while (bound < difference)
        bound *= 10;
    return bound;
}

double cli_table_figure_of(const cli_protocol_table *t, const char *name)
{
    for (uint32_t i = 0; i < t->figures; i++)
        if (strcmp(t->figure[i].name, name) == 0)
            return t->figure[i].value;
    return NAN;
}

uint32_t cli_table_column_of(const cli_protocol_table *t, const char *name)
{
    uint32_t i = 0;
    while (i < t->columns && strcmp(t->column[i].name, name) != 0)
        i++;
    return i;
}

void cli_table_note(cli_protocol_table *t, const char *format, ...)
{
    char text[sizeof t->note];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    const size_t length = strlen(t->note);
    if (!strstr(t->note, text))
        snprintf(t->note + length, sizeof t->note - length, "%s%s", length ? " " : "", text);
}

void cli_table_release(cli_protocol_table *t)
{
    free(t->value);
    t->value = NULL;
}

/* The middle of some values, or the lower one of two, and the largest distance of the others from it. */
static void middle_of(double *value, size_t count, double *middle, double *spread)
{
    size_t known = 0;
    for (size_t i = 0; i < count; i++) /* sorted by insertion, without what is not known */
        if (!isnan(value[i])) {
            const double one = value[i];
            size_t at = known++;
            for (; at > 0 && value[at - 1] > one; at--)
                value[at] = value[at - 1];
            value[at] = one;
        }
    *middle = known ? value[(known - 1) / 2] : NAN;
    *spread = known > 1 ? fmax(*middle - value[0], value[known - 1] - *middle) : NAN;
}

void cli_table_join(cli_protocol_table *const *tables, const uint64_t *seeds, size_t count)
{
    cli_protocol_table *first = tables[0], joined = *first;
    double *values = malloc((count + CLI_TABLE_COLUMNS) * sizeof *values);
    joined.rows = joined.capacity = 0;
    joined.value = NULL;
    joined.column[joined.columns++] = (cli_table_column){"seed", "1", NULL};
    first->failed = first->failed || !values;
    for (size_t k = 0; k < count && values; k++) {
        const cli_protocol_table *t = tables[k];
        for (size_t row = 0; row < t->rows; row++) {
            memcpy(values, t->value + row * t->columns, t->columns * sizeof *values);
            values[t->columns] = (double)seeds[k];
            cli_table_add(&joined, values);
        }
        joined.failed = joined.failed || t->failed;
        if (*t->note)
            cli_table_note(&joined, "%s", t->note);
    }
    for (uint32_t i = 0; i < joined.figures && values; i++) {
        for (size_t k = 0; k < count; k++)
            values[k] = tables[k]->figure[i].value;
        middle_of(values, count, &joined.figure[i].value, &joined.figure[i].spread);
    }
    free(values);
    free(first->value);
    *first = joined;
}

cli_protocol_table *cli_rheometer_table(cli_measurement *r, const char *name)
{
    cli_protocol_table *t = &r->table[r->tables++];
    *t = (cli_protocol_table){.name = name};
    return t;
}

const cli_values *cli_values_or(const cli_values *asked, const cli_values *otherwise)
{
    return asked->count ? asked : otherwise;
}

const cli_protocol_table *cli_table_of(const cli_measurement *m, const char *name)
{
    for (uint32_t i = 0; i < m->tables; i++)
        if (strcmp(m->table[i].name, name) == 0)
            return &m->table[i];
    return NULL;
}
