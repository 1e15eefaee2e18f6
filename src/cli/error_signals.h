/* Signals with known fractional derivatives, for the study history of `rheolog bench error`. */
#ifndef CLI_ERROR_SIGNALS_H
#define CLI_ERROR_SIGNALS_H

typedef struct cli_signal {
    const char *name;
    double (*position)(double t), (*velocity)(double t);
    double (*derivative)(double q, double t); /* closed form of D^q; NULL: none */
    double kink[3];                           /* times after 0 at which the velocity is not smooth; 0: none */
} cli_signal;

enum { CLI_SIGNALS = 6 };
extern const cli_signal cli_signal_list[CLI_SIGNALS];

/* Caputo derivative of order q at time t with an error of some 1e-13 of the integral of its size, by quadrature. */
double cli_caputo(const cli_signal *signal, double q, double t);

#endif
