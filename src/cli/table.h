/* Shared by the files of `rheolog table`: one row a recording, of its settings and of its metrics at events. */
#ifndef CLI_TABLE_H
#define CLI_TABLE_H

#include "cli/cli.h"

enum { CLI_TABLE_EVENTS = 16 };

/* ---- Columns: settings and metrics, in the order in which recordings first have them ---- */

typedef struct cli_column {
    char *name;
    const rheo_parameter *parameter; /* of a setting; NULL: the scene */
    const char *first;               /* value of the first recording that has the setting */
    bool differs, changed;           /* between recordings; from the default */
} cli_column;

typedef struct cli_columns {
    cli_column *column;
    size_t count, capacity;
} cli_columns;

/* Finds or adds a column; it is probably number `hint`. SIZE_MAX: no memory. */
size_t cli_columns_add(cli_columns *columns, size_t hint, const char *name);
/* Number of a column; `count` if there is none. */
size_t cli_columns_find(const cli_columns *columns, const char *name);
void cli_columns_release(cli_columns *columns);

/* ---- Events ---- */

typedef enum cli_event_kind { CLI_AT_END, CLI_AT_STEP, CLI_AT_TIME, CLI_AT_CONDITION } cli_event_kind;

typedef struct cli_event {
    cli_event_kind kind;
    const char *text; /* as it was given */
    uint64_t step;
    double time;
} cli_event;

/* ---- Rows ---- */

typedef struct cli_cell {
    bool known; /* the recording has the metric */
    double value;
} cli_cell;

typedef struct cli_happening {
    bool happened;
    uint64_t step;
    cli_cell *cell; /* by column; `metrics` of the row */
} cli_happening;

typedef struct cli_row {
    const char *file, *outcome;
    char *reason; /* why it cannot be read, or NULL */
    uint64_t steps;
    size_t settings, metrics; /* columns that this row may have */
    char **setting;           /* by column; NULL: it has none */
    cli_happening at[CLI_TABLE_EVENTS];
} cli_row;

typedef struct cli_sweep {
    cli_row *row;
    size_t rows, events;
    cli_event event[CLI_TABLE_EVENTS];
    cli_columns settings, metrics;
    size_t *setting, *metric; /* columns that are printed */
    size_t setting_count, metric_count;
} cli_sweep;

/* Reads a recording (table_read.c). Returns an exit code; CLI_BAD also for one that is not complete. */
int cli_read_row(cli_sweep *sweep, cli_row *row);
/* The condition of --at is not understood: no table can be made. */
bool cli_refused_condition(void);

/* Print the table (table_output.c). `sweep` is a cli_sweep. */
void cli_put_table_csv(FILE *file, const void *sweep);
void cli_put_table_json(FILE *file, const void *sweep);

#endif
