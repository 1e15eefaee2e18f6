/* Numbers of the thickening model that follow from a definition (world/model_thickening.h). */
#include "core/math.h"
#include "thickening/continuum.h"
#include "world/model_thickening.h"

/* Duration of a substep of fluid at rest. */
static double substep(const rheo_world_def *def)
{
    return def->step / (double)rheo__thickening_least_substeps(def);
}

/* A number of forces that scheme positions does not have. */
static double of_forces(const rheo_world_def *def, double value)
{
    return def->scheme == RHEO_SCHEME_POSITIONS ? __builtin_nan("") : value;
}

static double kappa(const rheo_world_def *def)
{
    return of_forces(def, rheo__largest_of_materials(def).springs.stiffness * substep(def) * substep(def));
}

static double gravity(const rheo_world_def *def)
{
    const double *g = def->gravity;
    return __builtin_sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
}

/* How much history thickens, for order 1/2. */
static double history_number(const rheo_world_def *def)
{
    const double root = __builtin_sqrt(def->fluid.support);
    if (!(def->springs.stiffness > 0 && def->history.order == .5) || def->history.curve_count)
        return __builtin_nan("");
    return def->history.stiffness / def->springs.stiffness * root * __builtin_sqrt(root) *
           __builtin_sqrt(__builtin_sqrt(gravity(def)));
}

static double pressure_number(const rheo_world_def *def)
{
    return of_forces(def, def->fluid.stiffness * substep(def) * substep(def) / def->fluid.support);
}

/* Fluid at rest; if there is none, its values are NaN. */
static rheo__continuum fluid_of(const rheo_world_def *def)
{
    rheo__continuum fluid;
    if (!rheo__continuum_at_rest(def, &fluid)) {
        const double no = __builtin_nan("");
        fluid = (rheo__continuum){no, no, no, no, no, no, no, no, no};
    }
    return fluid;
}

#define OF_FLUID(name, value)                        \
    static double name(const rheo_world_def *def)    \
    {                                                \
        const rheo__continuum fluid = fluid_of(def); \
        return value;                                \
    }
OF_FLUID(number_density, fluid.number_density)
OF_FLUID(sound_speed, __builtin_sqrt(fluid.bulk_modulus))
OF_FLUID(shear_modulus, fluid.shear_modulus)
OF_FLUID(history_modulus, fluid.history_modulus)
OF_FLUID(yield_stress, fluid.yield_stress)
OF_FLUID(viscosity, fluid.viscosity)
OF_FLUID(plastic_viscosity, fluid.plastic_viscosity)
OF_FLUID(numerical_viscosity, substep(def) * fluid.bulk_modulus)

static double relaxation_time(const rheo_world_def *def)
{
    return def->springs.plasticity > 0 ? of_forces(def, 1 / def->springs.plasticity) : __builtin_nan("");
}

/* Numbers of the ball; NaN without ball or gravity. */
static double yield_number(const rheo_world_def *def)
{
    return def->ball.radius > 0 && gravity(def) > 0 ? yield_stress(def) / (gravity(def) * def->ball.radius)
                                                    : __builtin_nan("");
}

/* The derivative of order q of a deformation of size 1 in the time sqrt(R/g) is about (g/R)^(q/2). A curve has no q. */
static double hardening_number(const rheo_world_def *def)
{
    return def->ball.radius > 0 && gravity(def) > 0 && def->springs.stiffness > 0 && !def->history.curve_count
               ? history_modulus(def) / shear_modulus(def) *
                     rheo__pow(gravity(def) / def->ball.radius, def->history.order / 2)
               : __builtin_nan("");
}

/* Substeps of scheme summed that fluid at rest needs. */
static double substeps_at_rest(const rheo_world_def *def)
{
    return def->scheme == RHEO_SCHEME_SUMMED ? (double)rheo__substeps_for(def, rheo__stiffness_sum_at_rest(def, 1), 0)
                                             : __builtin_nan("");
}

/* The limits of the doctor's pressure_number. */
#define TEXT(number) TEXT_OF(number)
#define TEXT_OF(number) #number
#define STABLE TEXT(RHEO__STABLE_PRESSURE)
#define UNSTABLE TEXT(RHEO__UNSTABLE_PRESSURE)
#define SEQUENTIAL TEXT(RHEO__SEQUENTIAL_STABLE_PRESSURE) ", " TEXT(RHEO__SEQUENTIAL_UNSTABLE_PRESSURE)

const rheo__derived_number rheo__thickening_derived[RHEO__THICKENING_DERIVED] = {
    {"kappa", "1", "springs.stiffness substep^2, with the substeps of fluid at rest", kappa},
    {"G", "1", "(history.stiffness/springs.stiffness) support^(3/4) |gravity|^(1/4)", history_number},
    {"pressure", "1",
     "fluid.stiffness substep^2/support, with the substeps of fluid at rest; above " STABLE
     " a run may go bad, above " UNSTABLE " expect it to (scheme sequential: " SEQUENTIAL ")",
     pressure_number},
    {"substeps", "1", "substeps of fluid at rest, if the state sets their number", substeps_at_rest},
    {"number_density", "1/L^3", "particles per volume at rest; a particle has mass 1, so this is the density",
     number_density},
    {"sound_speed", "L/T", "root of bulk modulus/density", sound_speed},
    {"shear_modulus", "L^2/T^2", "of springs without history, divided by the density", shear_modulus},
    {"history_modulus", "L^2/T^(2-q)", "shear modulus/density that history adds for each |D^q grad x|",
     history_modulus},
    {"yield_stress", "L^2/T^2", "of springs without history, divided by the density", yield_stress},
    {"viscosity", "L^2/T", "kinematic, from fluid.linear_viscosity", viscosity},
    {"plastic_viscosity", "L^2/T", "kinematic, of yielding springs: shear_modulus relaxation_time",
     plastic_viscosity},
    {"relaxation_time", "T", "of stress above the yield stress: 1/springs.plasticity", relaxation_time},
    {"numerical_viscosity", "L^2/T", "of sound, an error of the step: substep sound_speed^2", numerical_viscosity},
    {"yield_number", "1", "yield_stress/(|gravity| ball.radius)", yield_number},
    {"hardening_number", "1", "(history_modulus/shear_modulus) (|gravity|/ball.radius)^(q/2)", hardening_number},
};
