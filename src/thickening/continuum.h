/* The fluid of the thickening model as a continuum (docs/model.md, Spacing). */
#ifndef RHEO__THICKENING_CONTINUUM_H
#define RHEO__THICKENING_CONTINUUM_H

#include "core/real.h"
#include "rheolog/world.h"

/*
 * Sums over the neighbours of a particle inside settled fluid, with w = 1 - r/h, as functions of nu = n h^3, unit 1.
 * Fitted for nu from RHEO__LEAST_NU to RHEO__MOST_NU; the last two for nu from RHEO__LEAST_NU_OF_MODULI, below which
 * they depend on the other parameters too.
 */
typedef struct rheo__pair_sums {
    double ww, www;   /* sums of w^2, w^3 */
    double wr, wwr;   /* of w r/h, w^2 r/h */
    double wrr, wrrr; /* of w (r/h)^2, w (r/h)^3 */
    double rr, rrr;   /* of (r/h)^2, (r/h)^3 */
} rheo__pair_sums;

#define RHEO__LEAST_NU 4.0
#define RHEO__LEAST_NU_OF_MODULI 6.5
#define RHEO__MOST_NU 10.0

rheo__pair_sums rheo__pair_sums_at(double nu);

/* Pressure of fluid with nu = n h^3, divided by its density. Unit L^2/T^2. */
double rheo__continuum_pressure(const rheo_world_def *def, double nu);

/*
 * Fluid at rest without pressure. A particle has mass 1, so the density is the number density n. The values of
 * springs are NaN for nu below RHEO__LEAST_NU_OF_MODULI.
 */
typedef struct rheo__continuum {
    double nu, number_density; /* unit 1, 1/L^3 */
    /* Divided by the density: */
    double bulk_modulus;        /* L^2/T^2 */
    double shear_modulus;       /* of springs without history, L^2/T^2 */
    double history_modulus;     /* added to it for each |D^q grad x|, L^2/T^(2-q) */
    double yield_stress;        /* of springs without history, L^2/T^2 */
    double viscosity;           /* from fluid.linear_viscosity, L^2/T */
    double quadratic_viscosity; /* from fluid.quadratic_viscosity, for each shear rate, L^2 */
    double plastic_viscosity;   /* of yielding springs without history, L^2/T */
} rheo__continuum;

/* Finds the fluid at rest of a definition. False: it has none with nu in the range of the sums, or has scheme positions. */
bool rheo__continuum_at_rest(const rheo_world_def *def, rheo__continuum *fluid);

/* Particles per volume: given, that of fluid at rest, or 1/spacing^3 if there is none. Unit 1/L^3. */
double rheo__number_density(const rheo_world_def *def);
/* Mass of a ball, in masses of particles. */
double rheo__ball_mass(const rheo_world_def *def, uint32_t index);

/* The same material with particles `resolution` times as close, which is above 0 (docs/model.md, Spacing). */
void rheo__thickening_refine(rheo_world_def *def, double resolution);

#endif
