/* Prints the table of `rheolog table` as CSV or as JSON lines. */
#include "cli/table.h"

#include "json/json_parameter.h"

/* The setting of a row; NULL: it has none. */
static const char *setting_of(const cli_row *row, size_t column)
{
    return column < row->settings ? row->setting[column] : NULL;
}

/* The metric of a row at an event; NULL: it has none. */
static const cli_cell *cell_of(const cli_row *row, size_t event, size_t column)
{
    const cli_happening *at = &row->at[event];
    return at->happened && column < row->metrics && at->cell[column].known ? &at->cell[column] : NULL;
}

/* A setting that has the name of a metric is told from it: the length of a step, and its number. */
static void put_setting_name(FILE *file, const cli_sweep *s, const char *name)
{
    fputs(cli_columns_find(&s->metrics, name) < s->metrics.count ? ",set." : ",", file);
    cli_put_csv(file, name);
}

static void put_header(FILE *file, const cli_sweep *s)
{
    fputs("file,outcome,steps", file);
    for (size_t i = 0; i < s->setting_count; i++)
        put_setting_name(file, s, s->settings.column[s->setting[i]].name);
    for (size_t e = 0; e < s->events; e++)
        for (size_t i = 0; i < s->metric_count; i++) {
            char name[512];
            const char *metric = s->metrics.column[s->metric[i]].name;
            snprintf(name, sizeof name, s->events > 1 ? "%s@%s" : "%s", metric, s->event[e].text);
            fputc(',', file);
            cli_put_csv(file, name);
        }
    fputc('\n', file);
}

static void put_row(FILE *file, const cli_sweep *s, const cli_row *row)
{
    cli_put_csv(file, row->file);
    fprintf(file, ",%s,", row->outcome);
    if (!row->reason)
        fprintf(file, "%llu", (unsigned long long)row->steps);
    for (size_t i = 0; i < s->setting_count; i++) {
        const char *value = setting_of(row, s->setting[i]);
        fputc(',', file);
        cli_put_csv(file, value ? value : "");
    }
    for (size_t e = 0; e < s->events; e++)
        for (size_t i = 0; i < s->metric_count; i++) {
            const cli_cell *cell = cell_of(row, e, s->metric[i]);
            char text[32] = "";
            if (cell)
                rheo__number_text(cell->value, text, sizeof text);
            fprintf(file, ",%s", text);
        }
    fputc('\n', file);
}

void cli_put_table_csv(FILE *file, const void *sweep)
{
    const cli_sweep *s = sweep;
    put_header(file, s);
    for (size_t i = 0; i < s->rows; i++)
        put_row(file, s, &s->row[i]);
}

static void write_settings(rheo__json *json, const cli_sweep *s, const cli_row *row)
{
    rheo__json_begin_object(json, "settings");
    for (size_t i = 0; i < s->setting_count; i++) {
        const cli_column *column = &s->settings.column[s->setting[i]];
        const char *value = setting_of(row, s->setting[i]);
        if (value && column->parameter)
            rheo__json_parameter(json, column->name, column->parameter, value);
        else
            rheo__json_text(json, column->name, value);
    }
    rheo__json_end_object(json);
}

static void write_events(rheo__json *json, const cli_sweep *s, const cli_row *row)
{
    rheo__json_begin_list(json, "at");
    for (size_t e = 0; e < s->events; e++) {
        rheo__json_begin_object(json, NULL);
        rheo__json_text(json, "event", s->event[e].text);
        rheo__json_known_integer(json, "step", row->at[e].happened, row->at[e].step);
        rheo__json_begin_object(json, "metrics");
        for (size_t i = 0; i < s->metric_count; i++) {
            const cli_cell *cell = cell_of(row, e, s->metric[i]);
            const char *name = s->metrics.column[s->metric[i]].name;
            if (cell)
                rheo__json_number(json, name, cell->value);
            else
                rheo__json_null(json, name);
        }
        rheo__json_end_object(json);
        rheo__json_end_object(json);
    }
    rheo__json_end_list(json);
}

void cli_put_table_json(FILE *file, const void *sweep)
{
    const cli_sweep *s = sweep;
    for (size_t i = 0; i < s->rows; i++) {
        const cli_row *row = &s->row[i];
        rheo__json json = {.file = file};
        rheo__json_begin_object(&json, NULL);
        rheo__json_text(&json, "file", row->file);
        rheo__json_text(&json, "outcome", row->outcome);
        rheo__json_known_integer(&json, "steps", !row->reason, row->steps);
        write_settings(&json, s, row);
        write_events(&json, s, row);
        rheo__json_text(&json, "reason", row->reason);
        rheo__json_end_object(&json);
    }
}
