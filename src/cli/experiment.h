/*
 * Experiments of `rheolog experiments`: a scene in several variants, what is measured in every step, the figures that
 * come from it, and what these must show. An experiment is a table; experiment_NAME.c has those of one kind.
 */
#ifndef CLI_EXPERIMENT_H
#define CLI_EXPERIMENT_H

#include "cli/cli.h"

enum {
    CLI_MOST_VARIANTS = 16,
    CLI_MOST_SETTINGS = 8,
    CLI_MOST_COLUMNS = 8,
    CLI_MOST_FIGURES = 16, /* also of figures of all variants */
    CLI_MOST_CLAIMS = 24,
    CLI_MOST_SEEDS = 99,
};

/* A quantity: of a step (column of the CSV file) or of a whole run (figure). The first one without a name ends a table. */
typedef struct cli_quantity {
    const char *name, *unit, *about;
} cli_quantity;

/* The settings of a variant, as of --set. */
typedef struct cli_variant {
    const char *name;
    const char *set[CLI_MOST_SETTINGS];
    const char *scene; /* NULL: that of the experiment */
} cli_variant;

/*
 * What a figure must be in every seed: at least, or at most, factor x another figure + plus. Without `of` it is `plus`
 * alone. The figure of an event that never came is infinite.
 */
typedef struct cli_claim {
    const char *figure, *variant; /* variant NULL: a figure of all variants */
    enum { CLI_AT_LEAST = 1, CLI_AT_MOST } relation;
    double plus, factor;
    const char *of, *of_variant;
    bool not_small; /* the small version need not show it */
    bool or_never;  /* an event that does not come is late enough */
} cli_claim;

/* The columns of every step of a run, from its first state on. */
typedef struct cli_series {
    size_t rows;
    uint32_t columns;
    double *value; /* [row][column] */
    double *time;  /* [row] */
} cli_series;

enum { CLI_CELLS = 128 };

/* What a run begins from, and what a column remembers of earlier steps. */
typedef struct cli_trial {
    double surface; /* level of the fluid: the lowest point of the ball less its clearance; NaN without a ball */
    double up[3];   /* unit normal of the first wall; (0, 1, 0) without one */
    double down[3]; /* unit vector of gravity along this wall; (1, 0, 0) if there is none */
    /* Square cells of the floor, as wide as the spacing: those that no fluid is near. */
    double cell, corner[2];
    bool bare[CLI_CELLS][CLI_CELLS];
    uint32_t bare_cells;
    double *memory; /* cli_experiment.memory values, 0 at first */
    void *scratch;  /* cli_experiment.scratch bytes for each particle at the start */
} cli_trial;

struct cli_result;

typedef struct cli_experiment {
    const char *name;      /* of the experiment and of its scene */
    const char *reference; /* the figure of a paper */
    const char *about;
    const char *scene;                  /* built-in */
    const char *set[CLI_MOST_SETTINGS]; /* of all variants */
    uint64_t steps;
    /* The small version, which shows the same in seconds. */
    const char *small_set[CLI_MOST_SETTINGS];
    uint64_t small_steps;
    /* Every seed but the first moves the particles of a scene that has no random part: its jitter, in spacings. */
    double jitter;
    cli_variant variant[CLI_MOST_VARIANTS];
    cli_quantity column[CLI_MOST_COLUMNS], figure[CLI_MOST_FIGURES];
    uint32_t panels;    /* the first columns, which are plotted against time; 0: no plot */
    bool against_first; /* the columns after the first are plotted against it */
    /*
     * Instead, the figures after the first one against it, on logarithmic axes: a curve for so many variants each, named
     * behind ", ". 0: the columns.
     */
    uint32_t curve_variants;
    size_t memory;  /* values that `observe` keeps from step to step */
    size_t scratch; /* bytes that it needs for each particle; none are added */
    void (*observe)(const rheo_world *world, const cli_trial *run, double *columns);
    void (*measure)(const cli_series *series, double *figures);
    /* Figures of all variants together, such as an exponent. */
    cli_quantity whole[CLI_MOST_FIGURES];
    void (*sum_up)(const struct cli_result *result, uint32_t seed, double *whole);
    cli_claim claim[CLI_MOST_CLAIMS];
} cli_experiment;

extern const cli_experiment cli_experiment_ball, cli_experiment_ball_long, cli_experiment_ball_si,
    cli_experiment_drop, cli_experiment_incline, cli_experiment_pair, cli_experiment_hole, cli_experiment_lumps,
    cli_experiment_settling, cli_experiment_impact, cli_experiment_gentle, cli_experiment_melting_bunny,
    cli_experiment_chair, cli_experiment_kernel, cli_experiment_melting_all, cli_experiment_melting_logo,
    cli_experiment_melting_cost, cli_experiment_melting_drop, cli_experiment_runner, cli_experiment_fingers,
    cli_experiment_positions, cli_experiment_positions_drop;

/* ---- Parts of experiments ---- */

/* First row, from a row on, in which a column is above a level; `rows` if there is none. */
size_t cli_first_above(const cli_series *series, uint32_t column, double level, size_t from);
/* Row of the first minimum of a column from a row on, or of its last value if it falls to the end. */
size_t cli_first_minimum(const cli_series *series, uint32_t column, size_t from);
/* The same of a maximum. */
size_t cli_first_maximum(const cli_series *series, uint32_t column, size_t from);
/* Time of a row; infinite for `rows`. */
double cli_time_of(const cli_series *series, size_t row);

/* The cell of the floor in which a position is. False: it is outside. */
bool cli_cell_of(const cli_trial *run, const rheo_real position[3], uint32_t cell[2]);

/* ---- Results ---- */

/* One experiment with its results. */
typedef struct cli_result {
    const cli_experiment *experiment;
    const cli_list *set;
    bool small;
    uint32_t variants, columns, figures, wholes, claims, seeds;
    uint64_t steps;
    size_t finished;    /* runs: all variants with the first seed, then with the second ... */
    cli_series *series; /* [variant][seed] */
    double *figure;     /* [variant][seed][figure] */
    double *whole;      /* [seed][figure of all variants] */
    bool holds[CLI_MOST_CLAIMS];
} cli_result;

/* How experiments are run. */
typedef struct cli_experiment_options {
    bool small;
    uint32_t seeds;      /* from that of the scene on */
    const cli_list *set; /* settings of all variants, which those of a variant may replace */
} cli_experiment_options;

/* Runs all variants. Returns an exit code; unless it is CLI_DONE, the result has the runs that are finished. */
int cli_experiment_run(const cli_experiment *experiment, const cli_experiment_options *options,
                       cli_progress *progress, cli_result *result);
void cli_experiment_release(cli_result *result);
bool cli_experiment_is_finished(const cli_result *result);
/* Number of seeds with which a variant is finished; variant = result->variants: with which all are. */
uint32_t cli_finished_seeds(const cli_result *result, uint32_t variant);

/* A figure of a variant, or for variant = result->variants of all variants. */
double cli_figure_of(const cli_result *result, uint32_t variant, uint32_t figure, uint32_t seed);
const cli_series *cli_series_of(const cli_result *result, uint32_t variant, uint32_t seed);
/* Sets result->holds. Returns whether all claims hold. */
bool cli_experiment_judge(cli_result *result);
/* Whether this version must show a claim. */
bool cli_claim_counts(const cli_result *result, uint32_t claim);
/* Writes a claim in words, as "rebound of d = 50 >= 0.5". */
void cli_claim_text(const cli_claim *claim, char *text, size_t size);

/*
 * Least, middle and largest value of a figure over the seeds that are finished, NaN without one; variant =
 * result->variants: of all variants.
 */
void cli_figure_range(const cli_result *result, uint32_t variant, uint32_t figure, double range[3]);

/* Both print what is finished. `status`: of cli_experiment_run(). */
void cli_experiment_print(const cli_result *result, int status);
void cli_experiment_json(const cli_result *result, int status);
/* Refuses, before any work, files that cannot be written. */
int cli_experiment_check_files(const cli_experiment *experiment, bool small, const char *folder);
/* Writes NAME.csv and NAME.svg into a folder. Returns an exit code. */
int cli_experiment_write(const cli_result *result, const char *folder);

#endif
