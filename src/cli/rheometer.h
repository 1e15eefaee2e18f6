/*
 * Shared by the parts of `rheolog rheometer`: what is asked for, tables of results, the instruments that fill them, and output. A
 * table is all that output knows: text, JSON, CSV and plots are made from it.
 */
#ifndef CLI_RHEOMETER_H
#define CLI_RHEOMETER_H

#include "cli/cli.h"
#include "cli/rheometry.h"

/* ---- Tables ---- */

enum {
    CLI_TABLE_COLUMNS = 14,
    CLI_TABLE_FIGURES = 16,
    CLI_TABLE_PANELS = 3,
};

typedef struct cli_table_column {
    const char *name, *unit;
    const char *const *words; /* values are indices of these; NULL: numbers */
} cli_table_column;

/* A number about a whole table. */
typedef struct cli_table_figure {
    const char *name, *unit;
    double value;  /* with several seeds the middle one */
    double spread; /* largest distance of the others from it; NaN with one seed */
} cli_table_figure;

typedef struct cli_protocol_table {
    const char *name; /* of the protocol, and of its files */
    char about[640];  /* how it was measured */
    uint32_t columns, figures, panels;
    cli_table_column column[CLI_TABLE_COLUMNS];
    cli_table_figure figure[CLI_TABLE_FIGURES];
    /* Of the plot: y against x, as names of columns; curves of different values of the column `by` (NULL: one curve). */
    struct cli_table_panel {
        const char *x, *y, *by;
        bool logarithmic, points;
    } panel[CLI_TABLE_PANELS];
    bool brief; /* text has the figures only, since the rows are many */
    size_t rows, capacity;
    double *value;  /* [row][column] */
    bool failed;    /* no memory for a row */
    char note[512]; /* why numbers are missing; "" : none is */
} cli_protocol_table;

void cli_table_set_columns(cli_protocol_table *table, const cli_table_column *column, size_t count);
/* Adds a row, in the order of the columns. */
void cli_table_add(cli_protocol_table *table, const double *row);
void cli_table_figure_is(cli_protocol_table *table, const char *name, const char *unit, double value);
/* The power of ten above a difference from a closed form, but at least 1e-9: rounding differs from machine to machine. */
double cli_bound(double difference);
/* The value of a figure; NaN if there is none. */
double cli_table_figure_of(const cli_protocol_table *table, const char *name);
uint32_t cli_table_column_of(const cli_protocol_table *table, const char *name);
/* Adds a sentence to the note, unless it is there. */
void cli_table_note(cli_protocol_table *table, const char *format, ...) __attribute__((format(printf, 2, 3)));
void cli_table_release(cli_protocol_table *table);
/*
 * Joins the tables of several seeds into the first: rows one after the other, with the column `seed`; of each figure the middle
 * one. The tables have the same columns and figures.
 */
void cli_table_join(cli_protocol_table *const *tables, const uint64_t *seeds, size_t count);

/* ---- What is asked for ---- */

enum { CLI_RHEOMETER_VALUES = 32, CLI_RHEOMETER_TABLES = 8 };

typedef struct cli_values {
    size_t count; /* 0: the default */
    double value[CLI_RHEOMETER_VALUES];
} cli_values;

typedef struct cli_measurement {
    const char *scene_name;
    rheo_scene scene;
    bool small, fit;
    uint32_t seeds;
    cli_values rates, amplitudes, omegas, stresses; /* 1/T, 1, 1/T, L^2/T^2 */
    cli_progress *progress;
    const char *prefix; /* of the names of files */
    uint32_t tables;
    cli_protocol_table table[CLI_RHEOMETER_TABLES];
    char summary[3][320]; /* what fluid this is */
} cli_measurement;

/* Begins a table of the report. */
cli_protocol_table *cli_rheometer_table(cli_measurement *measurement, const char *name);
/* The table of a protocol; NULL: it was not measured. */
const cli_protocol_table *cli_table_of(const cli_measurement *measurement, const char *name);
/* Values that were asked for, or else these. */
const cli_values *cli_values_or(const cli_values *asked, const cli_values *otherwise);

/* The most steps at one shear rate or frequency: a block makes them in minutes, a large one in an hour. */
enum { CLI_RHEOMETER_STEPS = 1000000 };
/* Refuses values of an option that need more. `time` is how long the value 1 takes; others take `time` over the value. */
int cli_check_slowest(const cli_measurement *measurement, const char *option, const cli_values *values, double time);

/* ---- Instruments ---- */

/* A protocol. Returns an exit code; it has printed the message. */
typedef struct cli_protocol {
    const char *name, *about;
    int (*run)(cli_measurement *measurement);
    const char *takes; /* the options, beside --set, --small and those of output, that change what it measures */
} cli_protocol;

/* A way to measure. `sum_up` says in three lines what fluid this is. */
typedef struct cli_instrument {
    const char *name, *about;
    const cli_protocol *protocol; /* a name NULL ends them */
    void (*sum_up)(cli_measurement *measurement);
    const char *prefix;                               /* of the names of its files */
    int (*check)(const cli_measurement *measurement); /* refuses a scene that it cannot measure */
} cli_instrument;

/* A block of fluid between plates. */
extern const cli_instrument cli_block_instrument;
/* One spring between two ends, one of which is driven along their line. */
extern const cli_instrument cli_pair_instrument;
/* The law of the melting model, read from particles in a uniform shear. */
extern const cli_instrument cli_law_instrument;

/* Adds figures of cli_fit_model() to a table. A signal ends it, without them. */
void cli_put_fit(cli_protocol_table *table, const rheo_world_def *def, double length, const cli_sweep_point *point,
                 size_t count);
/* CLI_DONE, or after a signal CLI_INTERRUPTED with a message. */
int cli_rheometer_go_on(const cli_measurement *measurement, const char *protocol);

/* Names and units of the figures of a flow law. */
typedef struct cli_flow_names {
    const char *yield, *exponent, *consistency, *error, *stress_unit, *consistency_unit;
} cli_flow_names;

/* A flow law that is off by more than this is none. */
#define CLI_FLOW_ERROR .2
/* Adds figures of cli_flow_fit() to a table; a note begins with "No flow law" and `of`. */
void cli_put_flow_law(cli_protocol_table *table, const char *of, const double *rate, const double *stress,
                      size_t count, const cli_flow_names *name);

/* ---- Output ---- */

/* Each says what is finished; the status is CLI_DONE or CLI_INTERRUPTED. */
void cli_rheometer_print(const cli_measurement *measurement, const cli_instrument *instrument, int status);
void cli_rheometer_json(const cli_measurement *measurement, const cli_instrument *instrument, int status);
/* Writes PREFIX-NAME.csv and .svg of each table into a folder. Returns an exit code. */
/* Refuses a folder in which the files of a protocol cannot be written. */
int cli_rheometer_check_files(const cli_measurement *measurement, const char *protocol, const char *folder);
int cli_rheometer_write(const cli_measurement *measurement, const char *folder);

#endif
