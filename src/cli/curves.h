/* Shared by the parts of `rheolog curves`: options (curves.c), values (curves_values.c), output (curves_output.c). */
#ifndef CLI_CURVES_H
#define CLI_CURVES_H

#include "cli/cli.h"

enum { CLI_CURVES_MOST = 8, CLI_CURVES_MOST_AT = 16, CLI_CURVES_MOST_COUNT = 100000 };

/* What to compute: a curve for each order and each memory. */
typedef struct cli_curves_request {
    const char *name; /* weights, impact or steady */
    bool of_weights;  /* else of a signal */
    rheo_signal signal;
    rheo_weights weights;
    double step;
    size_t count; /* steps or lags of a curve */
    size_t orders, memories, at_count;
    double order[CLI_CURVES_MOST];
    struct cli_curves_memory {
        rheo_history_kind kind;
        uint32_t window; /* 0: all steps */
    } memory[4 * CLI_CURVES_MOST];
    uint64_t at[CLI_CURVES_MOST_AT]; /* steps or lags whose values are printed */
} cli_curves_request;

typedef struct cli_curve {
    double order;
    const struct cli_curves_memory *memory;
    double *value; /* |D^q x| of each step, or the weight of each lag */
    double peak;
    size_t peak_at, half_at,
        hundredth_at;  /* half_at: step from which half of the peak is not exceeded; count: none */
    double difference; /* largest one to kind window, as a fraction of its peak; NaN for that kind itself */
    size_t difference_at;
    double fit_error; /* largest relative error of a fitted weight; NaN if none is fitted */
} cli_curve;

typedef struct cli_curve_set {
    const cli_curves_request *request;
    double *velocity; /* of the signal; NULL for weights */
    size_t count;
    cli_curve *curve; /* order by order */
} cli_curve_set;

/* Computes all curves. Returns CLI_DONE, or another code after a message. Release them in any case. */
int cli_curves_compute(const cli_curves_request *request, cli_curve_set *curves);
void cli_curves_release(cli_curve_set *curves);
/* Values of a curve of weights that follow from them, at a lag: NaN where there are none. */
double cli_curves_first_weight(const cli_curve_set *curves, const cli_curve *curve, size_t lag);
double cli_curves_sum(const cli_curve_set *curves, const cli_curve *curve, size_t lag);

/* Names of a kind and of a rule for weights, as in parameters. */
const char *cli_curves_word(const char *parameter, uint32_t choice);

void cli_curves_print(const cli_curve_set *curves);
void cli_curves_print_json(const cli_curve_set *curves);
void cli_curves_put_csv(FILE *file, const void *curves);
int cli_curves_plot(const cli_curve_set *curves, const char *path, bool force);

#endif
