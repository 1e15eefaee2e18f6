/*
 * Stage substeps of scheme summed (docs/model.md, 5): divides the step into equal substeps. Their number is given, or
 * follows from the state at the start of the step: the explicit sum of forces is stable while, for each particle,
 *
 *     substep^2 sum K <= bound,   k substep^2/h <= bound,   k_near substep^2/h <= bound,   speed substep/h <= bound
 *
 * Where the largest number of substeps does not suffice, springs are softened: K of a spring becomes
 * K min(1, bound/(substep^2 sum K)) of its stiffer end.
 */
#include <string.h>

#include "core/scans.h"
#include "thickening/thickening.h"

static const double MOST_KAPPA = RHEO__STABLE_STIFFNESS_SUM;
/* Largest k substep^2/h: fluid begins to boil between RHEO__STABLE_PRESSURE and 0.09. */
static const double MOST_PRESSURE = 0.75 * RHEO__STABLE_PRESSURE;
/* Largest k_near substep^2/h. */
static const double MOST_NEAR_PRESSURE = 0.75 * RHEO__STABLE_NEAR_PRESSURE;
/* Largest way of a particle in a substep, in supports. */
static const double MOST_WAY = 0.25;
enum { FEWEST = 2 }; /* with one, even a gentle impact blows up */

static double largest(double a, double b)
{
    return a > b ? a : b;
}

uint64_t rheo__substeps_for(const rheo_world_def *def, double stiffness_sum, double speed2)
{
    const double h = def->fluid.support, step2 = def->step * def->step;
    const double springs = step2 * stiffness_sum / MOST_KAPPA,
                 pressure = step2 * def->fluid.stiffness / (h * MOST_PRESSURE),
                 near = step2 * def->fluid.near_stiffness / (h * MOST_NEAR_PRESSURE),
                 way = step2 * speed2 / (MOST_WAY * MOST_WAY * h * h);
    const double squared = largest(largest(springs, way), largest(pressure, near));
    uint64_t count = FEWEST;
    while (count < def->max_substeps && (double)(count * count) < squared)
        count++;
    return count < def->max_substeps ? count : def->max_substeps;
}

uint64_t rheo__thickening_least_substeps(const rheo_world_def *def)
{
    if (def->scheme != RHEO_SCHEME_SUMMED)
        return 1;
    return def->substeps ? def->substeps : rheo__substeps_for(def, 0, 0);
}

/* The fastest particle, ball or obstacle: they drive the fluid before them. */
static double largest_speed2(const rheo__state *s, double obstacle_speed)
{
    static rheo__largest_length2_function *const variants[] = RHEO__ALL_VARIANTS(largest_length2);
    rheo_real speed2 = variants[rheo__simd_in_use()](s->velocity, s->particles);
    for (uint32_t i = 0; i < s->bodies; i++) {
        const rheo_real *v = s->ball_velocity + 3 * (size_t)i;
        speed2 = rheo__max(speed2, rheo__length2(v[0], v[1], v[2]));
    }
    return largest((double)speed2, obstacle_speed * obstacle_speed);
}

/* Softens the springs of particles whose sum of kappa is too large. Returns their number. */
static size_t soften(const rheo__state *s, rheo__thickening *t, rheo_real bound)
{
    const rheo__pairs *p = t->pairs;
    size_t ends = 0;
    for (uint32_t i = 0; i < p->rows; i++)
        for (size_t k = rheo__pairs_first(p, i); k < rheo__pairs_end(p, i); k += p->width) {
            /* A pair without springs may get one in this step. */
            const rheo_real sums = rheo__max(t->stiffness_sum[i], t->stiffness_sum[rheo__pairs_partner(p, k)]),
                            sum = rheo__max(sums, t->pair_stiffness[k]);
            if (!(sum > bound))
                continue;
            t->pair_stiffness[k] *= bound / sum;
            ends += s->springs.rest_length[k] >= 0;
        }
    return ends / 2;
}

rheo_result rheo__stage_thickening_substeps(rheo__state *s, void *context)
{
    rheo__thickening *t = context;
    const rheo_world_def *def = t->def;
    const uint64_t count =
        def->substeps ? def->substeps
                      : rheo__substeps_for(def, (double)t->max_stiffness_sum, largest_speed2(s, t->obstacle_speed));
    *s->substeps = count;
    t->substep = (rheo_real)(def->step / (double)count);
    t->diagnostics.max_spring_displacement = t->diagnostics.max_pressure_displacement = (rheo__moved){0, -1};
    t->diagnostics.substeps = (double)count;
    t->diagnostics.softened_springs = 0;
    memset(t->diagnostics.plate_force, 0, sizeof t->diagnostics.plate_force);
    if (!rheo__state_has(s, RHEO__FIELD_spring_ends))
        return RHEO_OK;
    const rheo_real step2 = t->substep * t->substep;
    if (step2 * rheo__max(t->max_stiffness_sum, (rheo_real)rheo__largest_of_materials(def).springs.stiffness) >
        (rheo_real)MOST_KAPPA)
        t->diagnostics.softened_springs = (double)soften(s, t, (rheo_real)MOST_KAPPA / step2);
    t->diagnostics.stiffness_number = (double)(step2 * t->max_stiffness);
    t->diagnostics.largest_stiffness_sum = (double)(step2 * t->max_stiffness_sum);
    return RHEO_OK;
}
