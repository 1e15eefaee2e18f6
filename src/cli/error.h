/* `rheolog bench error`: its studies, each of which measures cost and error of some settings. */
#ifndef CLI_ERROR_H
#define CLI_ERROR_H

#include "cli/bench.h"

/* One measured quantity of one setting: a point in the plane of cost and error. */
typedef struct cli_error_point {
    char scene[48];   /* the case, such as "drop" or a signal, "sine" */
    char setting[64]; /* what was chosen, such as "summed, step/2" */
    char series
        [48]; /* settings of one series differ in `refinement` alone: observed orders are computed in a series */
    double refinement; /* step, spacing, tolerance; smaller is finer. 0: not part of a convergence series */
    char quantity[32]; /* what is compared, such as "dip" */
    double value;      /* NaN: not reached */
    double reference;  /* NaN: none */
    double error;      /* relative, with a sign, unless the study says otherwise; NaN: unstable or not reached */
    double ns_step;    /* cost: ns per particle and step; NaN: not measured */
    double us_time;    /* cost: us per particle and unit of simulated time; NaN: not measured */
    double bytes;      /* per particle; NaN: does not differ */
    double substeps;   /* in all steps; NaN: none */
    double iterations; /* per substep; NaN: none */
    uint32_t particles;
    uint64_t steps, hash;
    /* Set by the framework. */
    double order; /* observed order to the next coarser point of the series; NaN: none */
    bool front;   /* no point of this scene and quantity costs at most as much and has an error at most as large */
} cli_error_point;

typedef struct cli_error_points {
    cli_error_point *item;
    size_t count, room;
} cli_error_points;

/* A point all of whose numbers are missing. */
cli_error_point cli_error_no_point(void);
/* Adds a copy, for which order and front are not yet known. NULL: no memory, which it prints. */
cli_error_point *cli_error_add(cli_error_points *points, const cli_error_point *point);

/* ---- Studies ---- */

typedef struct cli_error_study {
    const char *name;
    const char *model; /* NULL: both */
    const char *title; /* one line, for texts and plots */
    int (*run)(cli_bench_arguments *a, cli_error_points *points);
} cli_error_study;

/* Each has its own file error_NAME.c, adds its points, and returns an exit code. */
int cli_error_history(cli_bench_arguments *a, cli_error_points *points);
int cli_error_number(cli_bench_arguments *a, cli_error_points *points);
int cli_error_spacing(cli_bench_arguments *a, cli_error_points *points);
int cli_error_steps(cli_bench_arguments *a, cli_error_points *points);
int cli_error_sweeps(cli_bench_arguments *a, cli_error_points *points);
int cli_error_springs(cli_bench_arguments *a, cli_error_points *points);
int cli_error_heat(cli_bench_arguments *a, cli_error_points *points);
int cli_error_channel(cli_bench_arguments *a, cli_error_points *points);
int cli_error_column(cli_bench_arguments *a, cli_error_points *points);
int cli_error_bunny(cli_bench_arguments *a, cli_error_points *points);

/* ---- The framework ---- */

/* Whether a word is in a list with commas between. */
bool cli_error_list_has(const char *list, const char *word);
/* The cost of a point: us_time, or ns_step if it has none. */
double cli_error_cost(const cli_error_point *point);
/* Computes the observed orders and the fronts of all points. */
void cli_error_judge(cli_error_points *points);

/* Prints the points of a study: one table per scene and quantity, or rows of a table as CSV or JSON. */
void cli_error_print(const cli_error_study *study, const cli_error_points *points);
void cli_error_rows(const cli_error_study *study, const cli_error_points *points, cli_bench_table *table);
/* Refuses a folder in which the files of a study cannot be written. */
int cli_error_check_files(const cli_error_study *study, const char *folder);
/* Writes error-STUDY.csv, and a plot error-STUDY-SCENE-QUANTITY.svg for each scene and quantity with costs and errors. */
int cli_error_write(const cli_error_study *study, const cli_error_points *points, const char *folder);

#endif
