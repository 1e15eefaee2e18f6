/* Signals with which Ozgen, Kallmann and Brown show what a memory does: Figs. 3 and 4 of their paper. */
#include "rheolog/history.h"

#include <float.h>

#include "core/math.h"

/* Times of the signals in T, and the largest speed of the impact in L/T. */
static const double BEGIN = 1, PULSE = 0.33, PEAK = 5, STOP = 6;

static double impact(double t)
{
    const double u = (t - BEGIN) / PULSE;
    if (!(u > 0 && u < 1))
        return 0;
    const double sine = rheo__sin_turns(u / 2);
    return PEAK * (sine * sine);
}

rheo_result rheo_signal_velocities(rheo_signal signal, double step, size_t count, double *velocity)
{
    if ((signal != RHEO_SIGNAL_IMPACT && signal != RHEO_SIGNAL_STEADY) || !(step > 0 && step <= DBL_MAX) || !velocity)
        return RHEO_ERROR_ARGUMENT;
    for (size_t n = 0; n < count; n++) {
        const double t = (double)n * step;
        velocity[n] = signal == RHEO_SIGNAL_IMPACT ? impact(t) : t > BEGIN && t < STOP;
    }
    return RHEO_OK;
}
