/*
 * The fluid as a continuum (docs/model.md, Spacing). The stress of a fluid is a sum over pairs. In settled fluid the
 * directions of pairs are isotropic, so a sum over the neighbours of a particle is a function of nu = n h^3 alone:
 *
 *     p/n = h/6 [k (rho - rho0) sum w r/h + k_near rho_near sum w^2 r/h],  rho = sum w^2, rho_near = sum w^3
 *     G/n = K h^2/60 sum (r/h)^2 + Gamma k_hist h^3/96 sum (r/h)^3,        Gamma = |D^q grad x|
 *     tau_y/n = K gamma h^2/(6 pi) sum (r/h)^2
 *     nu = sigma h^2/120 sum w (r/h)^2 + rate beta h^3/(105 pi) sum w (r/h)^3
 */
#include "thickening/continuum.h"

#include "core/state.h"

#include "core/strict.h"

static const double PI = 3.14159265358979323846;

/* Straight lines through sums measured in settled periodic fluid; nu - 7, because the fluid of pools has about 7. */
rheo__pair_sums rheo__pair_sums_at(double nu)
{
    const double u = nu - 7;
    return (rheo__pair_sums){.ww = 2.248 + 0.381 * u,
                             .www = 0.8761 + 0.1917 * u,
                             .wr = 4.3 + 0.596 * u,
                             .wwr = 1.372 + 0.1894 * u,
                             .wrr = 2.929 + 0.407 * u,
                             .wrrr = 2.065 + 0.312 * u,
                             .rr = 13.95 + 5.34 * u,
                             .rrr = 11.02 + 4.93 * u};
}

double rheo__continuum_pressure(const rheo_world_def *def, double nu)
{
    const rheo__pair_sums sum = rheo__pair_sums_at(nu);
    return def->fluid.support / 6 *
           (def->fluid.stiffness * (sum.ww - def->fluid.rest_density) * sum.wr +
            def->fluid.near_stiffness * sum.www * sum.wwr);
}

/* The derivative of the pressure by nu. */
static double pressure_slope(const rheo_world_def *def, double nu)
{
    const rheo__pair_sums sum = rheo__pair_sums_at(nu), zero = rheo__pair_sums_at(0), one = rheo__pair_sums_at(1);
    const double ww = one.ww - zero.ww, www = one.www - zero.www, wr = one.wr - zero.wr, wwr = one.wwr - zero.wwr;
    return def->fluid.support / 6 *
           (def->fluid.stiffness * (ww * sum.wr + (sum.ww - def->fluid.rest_density) * wr) +
            def->fluid.near_stiffness * (www * sum.wwr + sum.www * wwr));
}

/* nu of fluid without pressure. False: there is none in the range of the sums. */
static bool find_rest(const rheo_world_def *def, double *nu)
{
    enum { HALVINGS = 60 };
    double low = RHEO__LEAST_NU, high = RHEO__MOST_NU;
    if (!(def->fluid.stiffness > 0 && def->fluid.near_stiffness > 0 && def->fluid.rest_density > 0) ||
        !(rheo__continuum_pressure(def, low) < 0 && rheo__continuum_pressure(def, high) > 0))
        return false;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        if (rheo__continuum_pressure(def, middle) < 0)
            low = middle;
        else
            high = middle;
    }
    *nu = high;
    return true;
}

bool rheo__continuum_at_rest(const rheo_world_def *def, rheo__continuum *fluid)
{
    double nu;
    if (def->scheme == RHEO_SCHEME_POSITIONS || !find_rest(def, &nu)) /* these pressures are not its own */
        return false;
    const rheo__pair_sums sum = rheo__pair_sums_at(nu);
    const double h = def->fluid.support, known = nu < RHEO__LEAST_NU_OF_MODULI ? __builtin_nan("") : 1,
                 stiffness = known * def->springs.stiffness * h * h * sum.rr,
                 history = known * def->history.stiffness * h * h * h * sum.rrr;
    *fluid = (rheo__continuum){
        .nu = nu,
        .number_density = nu / (h * h * h),
        .bulk_modulus = nu * pressure_slope(def, nu), /* n d(p)/dn; the pressure itself is 0 */
        .shear_modulus = stiffness / 60,
        .history_modulus = history / (def->history.of == RHEO_HISTORY_OF_LENGTH ? 105 * PI / 2 : 96),
        .yield_stress = stiffness * def->springs.yield_ratio / (6 * PI),
        .viscosity = def->fluid.linear_viscosity * h * h * sum.wrr / 120,
        .quadratic_viscosity = def->fluid.quadratic_viscosity * h * h * h * sum.wrrr / (105 * PI),
        .plastic_viscosity = stiffness / 60 / def->springs.plasticity};
    return fluid->bulk_modulus > 0 && fluid->bulk_modulus - fluid->bulk_modulus == 0 && fluid->number_density > 0 &&
           fluid->number_density - fluid->number_density == 0;
}

double rheo__number_density(const rheo_world_def *def)
{
    rheo__continuum fluid;
    const double spacing = def->fluid.spacing;
    return def->fluid.number_density > 0          ? def->fluid.number_density
           : rheo__continuum_at_rest(def, &fluid) ? fluid.number_density
                                                  : 1 / (spacing * spacing * spacing);
}

double rheo__ball_mass(const rheo_world_def *def, uint32_t index)
{
    const rheo_ball *ball = rheo__ball_of(def, index);
    const double radius = ball->radius;
    return ball->density_ratio * (4.0 / 3.0 * PI * radius * radius * radius) * rheo__number_density(def);
}

/* At least 1 unless it is 0; rounded up. */
static uint64_t times(uint64_t count, double factor)
{
    enum { MOST = 1000 }; /* range of the parameters */
    const double exact = (double)count * factor;
    const uint64_t whole = exact < MOST ? (uint64_t)exact : MOST;
    return whole < MOST && (double)whole < exact ? whole + 1 : whole;
}

/*
 * Each parameter follows from the formulas above with h -> h/f: the pressure k h, the modulus K h^2, the history's
 * k_hist h^3 and so on stay, as do rates of the fluid. A contact acts on a layer of particles, whose thickness falls
 * by f, so its rates grow by f. The speed of sound per spacing grows by f, so the number of substeps does.
 */
void rheo__thickening_refine(rheo_world_def *def, double f)
{
    def->fluid.spacing /= f;
    def->fluid.support /= f;
    def->fluid.stiffness *= f;
    def->fluid.near_stiffness *= f;
    def->ball.friction *= f;
    for (uint32_t i = 0; i < def->balls.count; i++)
        def->balls.list[i].friction *= f;
    def->walls.sticking *= f;
    if (def->scheme == RHEO_SCHEME_POSITIONS) {
        def->positions.iterations = times(def->positions.iterations, f * f);
        def->positions.viscosity *= f * f;
    }
    def->substeps = times(def->substeps, f);
    def->max_substeps = times(def->max_substeps, f);
    def->springs.stiffness *= f * f;
    def->fluid.linear_viscosity *= f * f;
    def->history.stiffness *= f * f * f;
    def->history.onset /= f;
    for (uint32_t k = 0; k < def->materials.count; k++) {
        rheo_material *m = &def->materials.list[k]; /* what is below 0 stays so */
        m->springs.stiffness *= m->springs.stiffness < 0 ? 1 : f * f;
        m->history.stiffness *= m->history.stiffness < 0 ? 1 : f * f * f;
        m->history.onset /= m->history.onset < 0 ? 1 : f;
    }
    def->fluid.quadratic_viscosity *= f * f * f;
    def->fluid.number_density *= f * f * f;
}
