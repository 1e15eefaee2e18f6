/*
 * Closed forms of the thickening model for `rheolog rheometer`: the response of a memory to oscillations, the moduli of a spring
 * whose stiffness follows from it, and the parameters of the model from measured moduli.
 *
 * For velocities V e^(i w t) sampled every step, a memory that has seen them for ever gives D^q x = H(w) V e^(i w t), with
 *
 *     H(w) = C0 (c_0 + c_1 e^(-i w step) + c_2 e^(-2 i w step) + ...)
 *
 * which tends to (i w)^(q-1) if w step is small and the memory is long. These sums are finite (window) or geometric (modes).
 */
#ifndef CLI_RHEOMETRY_H
#define CLI_RHEOMETRY_H

#include "cli/rheometer_analysis.h"
#include "rheolog/rheolog.h"

/* A memory as a world has it. */
typedef struct cli_memory {
    rheo_history_kind kind;
    rheo_weights rule;
    double order, step, scale; /* C0; 1 with a curve */
    uint32_t window, lag;      /* steps; window 0: all steps */
    bool curve;
    size_t weights; /* kind window: lags 0 to d */
    double *weight;
    rheo_history_modes modes; /* other kinds */
} cli_memory;

/* Makes the memory of a definition with this kind and order; kind window with a curve has neither. Release it in any case. */
rheo_result cli_memory_make(const rheo_world_def *def, rheo_history_kind kind, double order, cli_memory *memory);
void cli_memory_release(cli_memory *memory);
/* H(w), real and imaginary part, without the lag. Unit T^(1-q). */
void cli_memory_response(const cli_memory *memory, double omega, double response[2]);
/* D^q x at each step from one component of the velocities, as stage fractional_derivative computes it, but in double. */
rheo_result cli_memory_apply(const cli_memory *memory, const double *velocity, size_t count, double *derivative);
/* Steps after which the start of an oscillation no longer shows: by 1e-10 of it. */
size_t cli_memory_reach(const cli_memory *memory);

/* A spring of stiffness k_min + k_hist n^2/(n + onset), n = |D^q| of its ends' distance. */
typedef struct cli_spring_law {
    double k_min, k_hist, onset;
    double length; /* at rest; strains are multiples of it */
} cli_spring_law;

/*
 * Moduli of the stress k strain, with the strain amplitude sin(w t). `response` is H(w), `delay` the steps between the newest
 * velocity that counts and the force: 1 + lag. By closed forms without an onset, else by quadrature. drift and area are those of a
 * steady oscillation.
 */
void cli_spring_moduli(const cli_spring_law *law, double amplitude, double omega, const double response[2],
                       double delay_time, cli_harmonics *harmonics);
/* The same by quadrature, also without an onset. */
void cli_spring_moduli_by_quadrature(const cli_spring_law *law, double amplitude, double omega,
                                     const double response[2], double delay_time, cli_harmonics *harmonics);

/* A point of an amplitude sweep. */
typedef struct cli_sweep_point {
    double amplitude, omega, storage, loss;
} cli_sweep_point;

/* Parameters from an amplitude sweep. */
typedef struct cli_model_fit {
    double k_min, k_hist, order; /* by all moduli together */
    double amplitude_slope;      /* of G' - k_min against the amplitude, on logarithmic axes: 1 without onset */
    double order_by_omega;       /* from how G' - k_min depends on w */
    double order_by_loss;        /* from G''/(G' - k_min) */
    double error;                /* root mean square of relative differences */
} cli_model_fit;

/*
 * Fits an amplitude sweep with the memory of a definition, whose order it does not read, and its onset. NULL, or why there is no
 * fit: fewer than two amplitudes or two frequencies, values that are not positive, or no history in the moduli. A long memory takes
 * a minute; `stop` says whether to end before (NULL: never).
 */
const char *cli_fit_model(const rheo_world_def *def, double length, const cli_sweep_point *point, size_t count,
                          bool (*stop)(void), cli_model_fit *fit);

#endif
