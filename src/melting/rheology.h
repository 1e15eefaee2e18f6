/*
 * Rheology, docs/melting.md (4). The jump number J depends on the temperature T; the apparent viscosity eta depends
 * on J and on the shear rate D:
 *
 *     u = (T - T_min)/(T_max - T_min), from 0 to 1;   J = (1 - u) J_max + u J_min
 *     eta = mu eta*(D t0),   eta*(D) = -expm1(-(J+1) D) (D^(n-1) + 1/D)
 *
 * The forms in double are used between steps and for the number of substeps, those in lanes by stage viscosity. Each
 * rounds in its own way; results depend on both.
 */
#ifndef RHEO__MELTING_RHEOLOGY_H
#define RHEO__MELTING_RHEOLOGY_H

#include "rheolog/world.h"
#include "core/math.h"

/* J(T) */
static inline double rheo__melting_jump(const rheo_world_def *def, double temperature)
{
    const double low = def->melting.temperature_min, high = def->melting.temperature_max;
    const double cold = def->melting.jump_number_max, hot = def->melting.jump_number_min;
    double u = (temperature - low) / (high - low);
    if (def->paper.jump) {
        const double jump = (1 - u) * cold - u * hot;
        return jump > 0 ? jump : 0;
    }
    u = u < 0 ? 0 : u > 1 ? 1 : u;
    return (1 - u) * cold + u * hot;
}

/* Smaller values of D t0 are raised to this one. */
#define RHEO__MIN_SHEAR 1e-14

/* eta(J, D) */
static inline double rheo__melting_viscosity(const rheo_world_def *def, double jump, double shear_rate)
{
    if (def->melting.rheology == RHEO_RHEOLOGY_NEWTONIAN)
        return def->melting.viscosity;
    const double scaled = shear_rate * def->melting.time_scale,
                 shear = scaled > RHEO__MIN_SHEAR ? scaled : RHEO__MIN_SHEAR;
    return def->melting.viscosity * -rheo__expm1(-(jump + 1) * shear) *
           (rheo__pow(shear, def->melting.power_law_index - 1) + 1 / shear);
}

/* Upper bound of eta at any shear rate: eta* < 1.35 (J + 1), attained for J = 0; lower for larger J. */
static inline double rheo__melting_max_viscosity(const rheo_world_def *def, double jump)
{
    if (def->melting.rheology == RHEO_RHEOLOGY_NEWTONIAN)
        return def->melting.viscosity;
    return 1.35 * def->melting.viscosity * (jump + 1);
}

#ifdef RHEO__LANES

#include "core/lanes.h"

/* J(T) */
static inline rheo__lanes rheo__lanes_jump(const rheo_world_def *def, rheo__lanes temperature)
{
    const double low = def->melting.temperature_min, high = def->melting.temperature_max;
    const rheo__lanes cold = rheo__lanes_all((rheo_real)def->melting.jump_number_max),
                      hot = rheo__lanes_all((rheo_real)def->melting.jump_number_min);
    rheo__lanes u = (temperature - (rheo_real)low) * (rheo_real)(1 / (high - low));
    if (def->paper.jump)
        return rheo__lanes_max((1 - u) * cold - u * hot, rheo__lanes_all(0));
    u = rheo__lanes_min(rheo__lanes_max(u, rheo__lanes_all(0)), rheo__lanes_all(1));
    return (1 - u) * cold + u * hot;
}

/*
 * expm1(x) for x from -40 to 0: a series at x/64, then six doublings p <- 2p + p^2. Tests bound the relative error by
 * 1e-5 in float.
 */
static inline rheo__lanes rheo__lanes_expm1_negative(rheo__lanes x)
{
    const rheo__lanes u = x * RHEO__R(0.015625);
    static const double INVERSE[] = {1.0 / 15, 1.0 / 14, 1.0 / 13, 1.0 / 12, 1.0 / 11, 1.0 / 10, 1.0 / 9,
                                     1.0 / 8,  1.0 / 7,  1.0 / 6,  1.0 / 5,  1.0 / 4,  1.0 / 3,  1.0 / 2};
    enum { TERMS = sizeof INVERSE / sizeof *INVERSE };
    rheo__lanes p = rheo__lanes_all(1);
    for (int i = RHEO_DOUBLE ? 0 : TERMS - 8; i < TERMS; i++)
        p = 1 + p * (u * (rheo_real)INVERSE[i]);
    p *= u;
    for (int i = 0; i < 6; i++)
        p += p + p * p;
    return p;
}

/* eta(J, D) of rheology `jump` */
static inline rheo__lanes rheo__lanes_viscosity(const rheo_world_def *def, rheo__lanes jump, rheo__lanes shear_rate)
{
    const double exponent = def->melting.power_law_index - 1;
    const rheo__lanes shear =
        rheo__lanes_max(shear_rate * (rheo_real)def->melting.time_scale, rheo__lanes_all(RHEO__R(RHEO__MIN_SHEAR)));
    rheo__lanes power = 1 / rheo__lanes_sqrt(shear);
    for (int lane = 0; lane < RHEO__LANES && exponent != -0.5; lane++)
        RHEO__LANE(power, lane) = (rheo_real)rheo__pow((double)RHEO__LANE(shear, lane), exponent);
    return rheo__lanes_all((rheo_real)def->melting.viscosity) *
           (-rheo__lanes_expm1_negative(rheo__lanes_max(-(jump + 1) * shear, rheo__lanes_all(-40))) *
            (power + 1 / shear));
}

#endif
#endif
