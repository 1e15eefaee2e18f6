/* Text and JSON of `rheolog rheometer`. */
#include "cli/rheometer.h"

#include <math.h>
#include <string.h>

/* ---- Text ---- */

static const char *value_text(const cli_table_column *column, double value, char text[32])
{
    if (column && column->words)
        return column->words[(size_t)value];
    return isnan(value) ? "-" : rheo_number_brief(value, 4, text);
}

static void print_rows(const cli_protocol_table *t)
{
    int width[CLI_TABLE_COLUMNS];
    char text[32];
    for (uint32_t c = 0; c < t->columns; c++) {
        width[c] = (int)strlen(t->column[c].name);
        if ((int)strlen(t->column[c].unit) > width[c])
            width[c] = (int)strlen(t->column[c].unit);
        for (size_t row = 0; row < t->rows; row++) {
            const int length = (int)strlen(value_text(&t->column[c], t->value[row * t->columns + c], text));
            width[c] = length > width[c] ? length : width[c];
        }
    }
    for (uint32_t c = 0; c < t->columns; c++)
        printf("%s%*s", c ? "  " : "", width[c], t->column[c].name);
    putchar('\n');
    for (uint32_t c = 0; c < t->columns; c++)
        printf("%s%*s", c ? "  " : "", width[c], t->column[c].unit);
    putchar('\n');
    for (size_t row = 0; row < t->rows; row++) {
        for (uint32_t c = 0; c < t->columns; c++)
            printf("%s%*s", c ? "  " : "", width[c], value_text(&t->column[c], t->value[row * t->columns + c], text));
        putchar('\n');
    }
}

static void print_table(const cli_protocol_table *t)
{
    char text[32];
    cli_print(stdout, 0, "\n%s: %s\n", t->name, t->about);
    if (t->brief)
        printf("%zu rows; -o FOLDER writes them\n", t->rows);
    else if (t->rows)
        print_rows(t);
    for (uint32_t i = 0; i < t->figures; i++) {
        const cli_table_figure *f = &t->figure[i];
        const bool pure = strcmp(f->unit, "1") == 0;
        printf("%s: %s", f->name, value_text(NULL, f->value, text));
        if (!isnan(f->spread))
            printf(" +-%s", rheo_number_brief(f->spread, 2, text));
        printf("%s%s\n", pure ? "" : " ", pure ? "" : f->unit);
    }
    if (*t->note)
        cli_print(stdout, 0, "note: %s\n", t->note);
}

void cli_rheometer_print(const cli_measurement *r, const cli_instrument *instrument, int status)
{
    cli_print(stdout, 0, "%s, %s%s: %s\n", r->scene_name, instrument->name, r->small ? ", small" : "",
              instrument->about);
    if (status != CLI_DONE)
        cli_print(stdout, 0, "%s: %s\n", cli_status_name(status),
                  r->tables ? "here are the protocols that are finished" : "no protocol is finished");
    for (int i = 0; i < 3; i++)
        if (*r->summary[i])
            cli_print(stdout, 0, "%s\n", r->summary[i]);
    for (uint32_t i = 0; i < r->tables; i++)
        print_table(&r->table[i]);
}

/* ---- JSON ---- */

static void put_table(const cli_measurement *r, const cli_protocol_table *t, const cli_instrument *instrument)
{
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "scene", r->scene_name);
    rheo__json_text(&json, "instrument", instrument->name);
    rheo__json_text(&json, "protocol", t->name);
    rheo__json_bool(&json, "small", r->small);
    rheo__json_integer(&json, "seeds", r->seeds);
    rheo__json_text(&json, "about", t->about);
    rheo__json_begin_object(&json, "figures");
    for (uint32_t i = 0; i < t->figures; i++)
        rheo__json_number(&json, t->figure[i].name, t->figure[i].value);
    rheo__json_end_object(&json);
    rheo__json_begin_object(&json, "spreads");
    for (uint32_t i = 0; i < t->figures && r->seeds > 1; i++)
        rheo__json_number(&json, t->figure[i].name, t->figure[i].spread);
    rheo__json_end_object(&json);
    rheo__json_begin_object(&json, "units");
    for (uint32_t i = 0; i < t->figures; i++)
        rheo__json_text(&json, t->figure[i].name, t->figure[i].unit);
    for (uint32_t c = 0; c < t->columns; c++)
        if (!t->column[c].words)
            rheo__json_text(&json, t->column[c].name, t->column[c].unit);
    rheo__json_end_object(&json);
    rheo__json_begin_list(&json, "rows");
    for (size_t row = 0; row < t->rows; row++) {
        const double *value = t->value + row * t->columns;
        rheo__json_begin_object(&json, NULL);
        for (uint32_t c = 0; c < t->columns; c++)
            if (t->column[c].words)
                rheo__json_text(&json, t->column[c].name, t->column[c].words[(size_t)value[c]]);
            else
                rheo__json_number(&json, t->column[c].name, value[c]);
        rheo__json_end_object(&json);
    }
    rheo__json_end_list(&json);
    rheo__json_text(&json, "note", *t->note ? t->note : NULL);
    rheo__json_end_object(&json);
}

void cli_rheometer_json(const cli_measurement *r, const cli_instrument *instrument, int status)
{
    for (uint32_t i = 0; i < r->tables; i++)
        put_table(r, &r->table[i], instrument);
    rheo__json json = {.file = stdout};
    rheo__json_begin_object(&json, NULL);
    rheo__json_text(&json, "scene", r->scene_name);
    rheo__json_text(&json, "instrument", instrument->name);
    rheo__json_text(&json, "outcome", cli_status_name(status));
    rheo__json_text(&json, "reason", status == CLI_DONE ? NULL : cli_said());
    rheo__json_begin_list(&json, "summary");
    for (int i = 0; i < 3; i++)
        if (*r->summary[i])
            rheo__json_text(&json, NULL, r->summary[i]);
    rheo__json_end_list(&json);
    rheo__json_end_object(&json);
}
